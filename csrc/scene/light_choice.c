// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Whether a scene chooses among its lights by a tree, and the tree over its pieces. */

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/light_tree.h"
#include "scene/scene_input.h"
#include "scene/scene_internal.h"

/* From so many pieces on the tree has the lower error per second; see docs/scene.md, which has the
 * figures, and bench/render_many_lights.py, which measures them. */
#define LEAST_PIECES 8
#define MOST_PIECES ((size_t)1 << 31)

const char *sf_light_choice_name(sf_light_choice choice) {
    switch (choice) {
        case SF_LIGHT_CHOICE_AUTO: return "auto";
        case SF_LIGHT_CHOICE_POWER: return "power";
        case SF_LIGHT_CHOICE_TREE: return "tree";
    }
    return NULL;
}

sf_status sf_scene_set_light_choice(sf_scene *scene, sf_light_choice choice, sf_error *error) {
    sf_status status = sf_scene_refuse_committed(scene, error);
    if (status) return status;
    if (!sf_light_choice_name(choice))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "light_choice is %d; it must be one of the enumeration's",
                       (int)choice);
    scene->light_choice = choice;
    return SF_STATUS_OK;
}

static bool wants_tree(const sf_scene *scene, size_t count) {
    if (count < 2 || count > MOST_PIECES || scene->light_sampling == SF_LIGHT_SAMPLING_SURFACE) return false;
    if (scene->light_choice == SF_LIGHT_CHOICE_AUTO) return count >= LEAST_PIECES;
    return scene->light_choice == SF_LIGHT_CHOICE_TREE;
}

/* Boxes of triangles and parallelograms by their corners, of disks and spheres by middle and radius. A
 * sphere sends radiance x area / 4 everywhere, what is flat radiance x area along its normal. */
static sf_tree_piece describe(const float *piece, const sf_light_source *source) {
    bool sphere = piece[SF_LIGHT_KIND] == (float)SF_LIGHT_IS_SPHERE;
    bool disk = piece[SF_LIGHT_KIND] == (float)SF_LIGHT_IS_DISK;
    sf_tree_piece out = {.all_ways = sphere, .power = (float)((sphere ? 0.25 : 1) * source->area * source->power)};
    for (int c = 0; c < 3; ++c) {
        float k = piece[SF_LIGHT_ORIGIN_X + c], a = piece[SF_LIGHT_EDGE1_X + c], b = piece[SF_LIGHT_EDGE2_X + c];
        float both = piece[SF_LIGHT_RECTANGLE] > 0 ? a + b : a;
        out.lower[c] = k + fminf(fminf(a, b), fminf(both, 0));
        out.upper[c] = k + fmaxf(fmaxf(a, b), fmaxf(both, 0));
        float reach = sphere ? piece[SF_LIGHT_EDGE1_X] : sqrtf(a * a + b * b);
        if (sphere || disk) out.lower[c] = k - reach;
        if (sphere || disk) out.upper[c] = k + reach;
        out.axis[c] = piece[SF_LIGHT_NORMAL_X + c];
    }
    return out;
}

sf_status sf_lights_grow_tree(sf_scene *scene, const sf_light_source *sources, sf_error *error) {
    sf_light_table *lights = &scene->lights;
    size_t count = 0;
    while (count < lights->count && !sources[count].sky) ++count;
    lights->sky_first = count;
    if (!wants_tree(scene, count)) return SF_STATUS_OK;
    sf_tree_piece *pieces = malloc(count * sizeof *pieces);
    if (!pieces) return sf_fail_memory(error, "the list of lights", count * sizeof *pieces);
    for (size_t i = 0; i < count; ++i) pieces[i] = describe(lights->pieces[i], sources + i);
    sf_status status = sf_light_tree_create(pieces, count, &lights->tree, error);
    free(pieces);
    return status;
}
