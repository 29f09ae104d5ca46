// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The lights of a scene: emissive meshes cut into triangles and parallelograms, drawn from an
 * alias table (Walker 1977, in Vose's linear-time form, 1991). */

#include <math.h>
#include <string.h>

#include "error.h"
#include "platform.h"
#include "scene_data.h"

#define PI 3.14159265358979323846

/* A triangle of an emissive mesh, and the other half of its parallelogram if it has one. */
typedef struct candidate {
    uint32_t mesh;
    uint32_t triangle;
    uint32_t corner; /* the vertex of the triangle opposite to the shared edge */
    bool rectangle;
    bool absorbed; /* the other half of an earlier one */
} candidate;

/* An edge by the positions of its ends, smaller first, so that meshes whose triangles share no
 * vertex numbers are paired too. */
typedef struct edge {
    float ends[6];
    uint32_t candidate;
    uint32_t corner; /* the vertex (0, 1, 2) opposite to it */
} edge;

static const float *vertex(const sf_mesh *mesh, uint32_t triangle, uint32_t corner) {
    return mesh->vertices + 3 * (size_t)mesh->triangles[3 * (size_t)triangle + corner % 3];
}

static int compare_floats(const float *a, const float *b, int count) {
    for (int i = 0; i < count; ++i)
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return 0;
}

static int compare_edges(const void *pa, const void *pb) {
    const edge *a = pa, *b = pb;
    int order = compare_floats(a->ends, b->ends, 6);
    if (order == 0) order = a->candidate < b->candidate ? -1 : a->candidate > b->candidate;
    return order ? order : (a->corner > b->corner) - (a->corner < b->corner);
}

static bool is_emissive(const sf_mesh *mesh) {
    return mesh->emission[0] > 0 || mesh->emission[1] > 0 || mesh->emission[2] > 0;
}

static double triangle_area(const sf_mesh *mesh, uint32_t triangle) {
    double n[3];
    sf_triangle_cross(vertex(mesh, triangle, 0), vertex(mesh, triangle, 1), vertex(mesh, triangle, 2), n);
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Whether b's corner lies where the parallelogram over a's edges from its own corner closes:
 * corner_b = i + j - corner_a, within 1e-5 of the edges' size, and both face the same way. */
static bool closes_parallelogram(const sf_mesh *mesh, uint32_t ta, uint32_t ca, uint32_t tb, uint32_t cb) {
    const float *k = vertex(mesh, ta, ca), *i = vertex(mesh, ta, ca + 1), *j = vertex(mesh, ta, ca + 2);
    const float *l = vertex(mesh, tb, cb);
    double off = 0, size = 0;
    for (int c = 0; c < 3; ++c) {
        double e1 = (double)i[c] - k[c], e2 = (double)j[c] - k[c];
        off = fmax(off, fabs((double)k[c] + e1 + e2 - l[c]));
        size = fmax(size, fmax(fabs(e1), fabs(e2)));
    }
    return off <= 1e-5 * size && compare_floats(vertex(mesh, tb, cb + 1), j, 3) == 0;
}

static void pair_edges(const sf_scene *scene, candidate *candidates, const edge *edges, size_t edge_count) {
    for (size_t e = 0; e + 1 < edge_count; ++e) {
        const edge *a = edges + e, *b = edges + e + 1;
        candidate *ca = candidates + a->candidate, *cb = candidates + b->candidate;
        if (compare_floats(a->ends, b->ends, 6) != 0 || ca->mesh != cb->mesh || ca == cb) continue;
        if (ca->rectangle || cb->rectangle || ca->absorbed || cb->absorbed) continue;
        const sf_mesh *mesh = &scene->meshes[ca->mesh].mesh;
        if (!closes_parallelogram(mesh, ca->triangle, a->corner, cb->triangle, b->corner)) continue;
        ca->rectangle = true;
        ca->corner = a->corner;
        cb->absorbed = true;
    }
}

/* Finds the pairs of triangles that form a parallelogram, by sorting their edges. */
static sf_status pair_rectangles(const sf_scene *scene, candidate *candidates, size_t count, sf_error *error) {
    edge *edges = malloc(3 * count * sizeof *edges);
    if (!edges) return sf_fail_memory(error, "the edges of the lights", 3 * count * sizeof *edges);
    for (size_t i = 0; i < count; ++i)
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const sf_mesh *mesh = &scene->meshes[candidates[i].mesh].mesh;
            const float *p = vertex(mesh, candidates[i].triangle, corner + 1);
            const float *q = vertex(mesh, candidates[i].triangle, corner + 2);
            bool swap = compare_floats(p, q, 3) > 0;
            edge *e = edges + 3 * i + corner;
            memcpy(e->ends, swap ? q : p, 12);
            memcpy(e->ends + 3, swap ? p : q, 12);
            e->candidate = (uint32_t)i;
            e->corner = corner;
        }
    qsort(edges, 3 * count, sizeof *edges, compare_edges);
    pair_edges(scene, candidates, edges, 3 * count);
    free(edges);
    return SF_STATUS_OK;
}

static size_t list_candidates(const sf_scene *scene, candidate *out) {
    size_t count = 0;
    for (size_t m = 0; m < scene->info.mesh_count; ++m) {
        const sf_mesh *mesh = &scene->meshes[m].mesh;
        if (!is_emissive(mesh)) continue;
        for (size_t t = 0; t < mesh->triangle_count; ++t) {
            if (!(triangle_area(mesh, (uint32_t)t) > 0)) continue;
            if (out) out[count] = (candidate){.mesh = (uint32_t)m, .triangle = (uint32_t)t};
            ++count;
        }
    }
    return count;
}

static sf_status allocate_lights(sf_light_table *lights, size_t count, sf_error *error) {
    lights->pieces = sf_aligned_alloc(count * sizeof *lights->pieces);
    if (!lights->pieces) return sf_fail_memory(error, "the table of lights", count * sizeof *lights->pieces);
    memset(lights->pieces, 0, count * sizeof *lights->pieces);
    lights->alias = sf_aligned_alloc(count * sizeof *lights->alias);
    if (!lights->alias) return sf_fail_memory(error, "the alias table of lights", count * sizeof *lights->alias);
    return SF_STATUS_OK;
}

void sf_lights_free(sf_light_table *lights) {
    sf_aligned_free(lights->pieces);
    sf_aligned_free(lights->alias);
    memset(lights, 0, sizeof *lights);
}

/* Writes the geometry of a piece into row `row`; returns its area. */
static double write_piece(sf_light_table *lights, size_t row, const sf_mesh *mesh, const candidate *piece) {
    const float *k = vertex(mesh, piece->triangle, piece->corner);
    const float *i = vertex(mesh, piece->triangle, piece->corner + 1);
    const float *j = vertex(mesh, piece->triangle, piece->corner + 2);
    double n[3];
    sf_triangle_cross(k, i, j, n);
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; ++c) {
        lights->pieces[row][SF_LIGHT_ORIGIN_X + c] = k[c];
        lights->pieces[row][SF_LIGHT_EDGE1_X + c] = i[c] - k[c];
        lights->pieces[row][SF_LIGHT_EDGE2_X + c] = j[c] - k[c];
        lights->pieces[row][SF_LIGHT_NORMAL_X + c] = (float)(n[c] / length);
    }
    lights->pieces[row][SF_LIGHT_RECTANGLE] = piece->rectangle;
    return piece->rectangle ? length : 0.5 * length;
}

/* Vose's construction: columns with less than the mean share are filled up by those with more. */
static sf_status build_alias(sf_light_table *lights, double *share, sf_error *error) {
    size_t n = lights->count, small = 0, large = n;
    uint32_t *order = malloc(n * sizeof *order); /* small ones from the front, large from the back */
    if (!order) return sf_fail_memory(error, "the alias table of lights", n * sizeof *order);
    for (size_t i = 0; i < n; ++i) order[share[i] < 1 ? small++ : --large] = (uint32_t)i;
    while (small > 0 && large < n) {
        uint32_t s = order[--small], l = order[large];
        lights->pieces[s][SF_LIGHT_KEEP] = (float)share[s];
        lights->alias[s] = l;
        share[l] -= 1 - share[s];
        if (share[l] < 1) {
            ++large;
            order[small++] = l;
        }
    }
    /* What is left differs from 1 by rounding only. */
    for (size_t i = 0; i < n; ++i) {
        if (i >= small && i < large) continue;
        lights->pieces[order[i]][SF_LIGHT_KEEP] = 1;
        lights->alias[order[i]] = order[i];
    }
    free(order);
    return SF_STATUS_OK;
}

/* Fills the table from the candidates that were not absorbed by a neighbour. */
static sf_status fill_lights(sf_scene *scene, const candidate *candidates, size_t count, sf_error *error) {
    sf_light_table *lights = &scene->lights;
    double *power = malloc(lights->count * sizeof *power);
    if (!power) return sf_fail_memory(error, "the powers of the lights", lights->count * sizeof *power);
    double total = 0;
    for (size_t i = 0, row = 0; i < count; ++i) {
        if (candidates[i].absorbed) continue;
        const sf_mesh *mesh = &scene->meshes[candidates[i].mesh].mesh;
        double radiance = (double)mesh->emission[0] + mesh->emission[1] + mesh->emission[2];
        power[row] = write_piece(lights, row, mesh, &candidates[i]) * radiance;
        total += power[row++];
    }
    for (size_t i = 0, row = 0; i < count; ++i) {
        if (candidates[i].absorbed) continue;
        uint32_t m = candidates[i].mesh;
        const float *emission = scene->meshes[m].mesh.emission;
        /* Probability area x radiance / total, over the area: radiance / total. */
        double pdf = ((double)emission[0] + emission[1] + emission[2]) / total;
        for (int c = 0; c < 3; ++c) lights->pieces[row][SF_LIGHT_WEIGHT_R + c] = (float)(emission[c] / (pdf * PI));
        lights->pieces[row][SF_LIGHT_PDF] = (float)pdf;
        scene->mesh_table.columns[SF_MESH_LIGHT_PDF][m] = (float)pdf;
        power[row] *= (double)lights->count / total;
        ++row;
    }
    sf_status status = SF_STATUS_OK;
    if (!(total <= 1e30)) /* beyond it the single-precision weights would overflow */
        status = sf_fail(
            error, SF_STATUS_INVALID_VALUE,
            "area x emission of the lights is %g; it must be at most 1e30: scale the scene or its lights down", total);
    if (!status) status = build_alias(lights, power, error);
    free(power);
    return status;
}

sf_status sf_lights_build(sf_scene *scene, sf_error *error) {
    size_t count = list_candidates(scene, NULL);
    if (count == 0) return SF_STATUS_OK;
    if (count > UINT32_MAX)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%zu emissive triangles; at most 2^32 - 1 are allowed", count);
    candidate *candidates = malloc(count * sizeof *candidates);
    if (!candidates) return sf_fail_memory(error, "the list of lights", count * sizeof *candidates);
    list_candidates(scene, candidates);
    sf_status status = pair_rectangles(scene, candidates, count, error);
    if (!status) {
        scene->lights.count = count;
        for (size_t i = 0; i < count; ++i) {
            scene->lights.count -= candidates[i].absorbed;
            scene->lights.rectangle_count += candidates[i].rectangle;
        }
        status = allocate_lights(&scene->lights, scene->lights.count, error);
    }
    if (!status) status = fill_lights(scene, candidates, count, error);
    free(candidates);
    return status;
}
