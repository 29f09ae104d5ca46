// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Checks materials, and tells how their surfaces scatter. */
#include "sunfleck/material.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene_internal.h"

#define IOR_LOWEST 0.1f
#define IOR_HIGHEST 10.0f
#define SMOOTH_BELOW 0.01f /* alpha below 1e-4, which mapping_lobe.h does not take */

sf_material sf_material_default(void) { return (sf_material){.kind = SF_MATERIAL_DIFFUSE, .ior = 1.5f}; }

const char *sf_material_kind_name(sf_material_kind kind) {
    switch (kind) {
        case SF_MATERIAL_DIFFUSE: return "diffuse";
        case SF_MATERIAL_MIRROR: return "mirror";
        case SF_MATERIAL_DIELECTRIC: return "dielectric";
        case SF_MATERIAL_CONDUCTOR: return "conductor";
    }
    return NULL;
}

sf_status sf_material_check(const sf_material *material, sf_error *error) {
    if (!sf_material_kind_name(material->kind))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "material kind is %d; it must be one of the enumeration's values", (int)material->kind);
    if (material->kind == SF_MATERIAL_DIELECTRIC && !(material->ior >= IOR_LOWEST && material->ior <= IOR_HIGHEST))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "ior is %g; it must be in [%g, %g]", (double)material->ior,
                       (double)IOR_LOWEST, (double)IOR_HIGHEST);
    bool rough = material->kind == SF_MATERIAL_DIELECTRIC || material->kind == SF_MATERIAL_CONDUCTOR;
    if (rough && !(material->roughness >= 0 && material->roughness <= 1))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "roughness is %g; it must be in [0, 1]",
                       (double)material->roughness);
    return SF_STATUS_OK;
}

sf_scatter sf_scatter_of(const sf_material *material) {
    bool smooth = material->roughness < SMOOTH_BELOW;
    switch (material->kind) {
        case SF_MATERIAL_DIFFUSE: break;
        case SF_MATERIAL_MIRROR: return SF_SCATTER_MIRROR;
        case SF_MATERIAL_CONDUCTOR: return smooth ? SF_SCATTER_SMOOTH_CONDUCTOR : SF_SCATTER_ROUGH_CONDUCTOR;
        case SF_MATERIAL_DIELECTRIC:
            /* Where both sides are alike, light goes straight on whatever the normal. */
            smooth |= fabsf(material->ior - 1) < 1e-3f;
            return smooth ? SF_SCATTER_SMOOTH_DIELECTRIC : SF_SCATTER_ROUGH_DIELECTRIC;
    }
    return SF_SCATTER_DIFFUSE;
}

void sf_material_tabulate(sf_mesh_table *table, size_t row, const sf_mesh *mesh) {
    sf_scatter scatter = sf_scatter_of(&mesh->material);
    bool passes_albedo = scatter == SF_SCATTER_DIFFUSE || scatter == SF_SCATTER_MIRROR;
    for (int c = 0; c < 3; ++c) table->columns[SF_MESH_PASS_R + c][row] = passes_albedo ? mesh->albedo[c] : 1;
    table->columns[SF_MESH_SCATTER][row] = (float)scatter;
    table->columns[SF_MESH_IOR][row] = mesh->material.ior;
    table->columns[SF_MESH_ALPHA][row] = mesh->material.roughness * mesh->material.roughness;
}

uint64_t sf_material_hash(uint64_t hash, const sf_material *material) {
    if (material->kind == SF_MATERIAL_DIFFUSE) return hash;
    float values[2] = {0, 0};
    if (material->kind == SF_MATERIAL_DIELECTRIC) values[0] = material->ior;
    if (material->kind != SF_MATERIAL_MIRROR) values[1] = material->roughness;
    uint64_t word;
    memcpy(&word, values, sizeof word);
    return sf_hash64(sf_hash64(hash, (uint64_t)material->kind), word);
}
