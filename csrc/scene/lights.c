// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The lights of a scene: emissive meshes cut into triangles and parallelograms, emissive spheres and
 * disks, suns and the environment, as the pieces that light is sampled from. */

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "scene/light_tree.h"
#include "scene/scene_internal.h"
#include "sunfleck/mapping.h"

#define PI 3.14159265358979323846

/* A triangle of an emissive mesh, and the other half of its parallelogram if it has one. */
typedef struct candidate {
    uint32_t mesh;
    uint32_t triangle;
    uint32_t corner; /* the vertex of the triangle opposite to the shared edge */
    bool rectangle;
    bool absorbed;    /* the other half of another one: */
    uint32_t partner; /* of that triangle */
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
        cb->partner = ca->triangle;
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
        if (!sf_emits(mesh)) continue;
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
    free(lights->of_primitive);
    free(lights->first_of_mesh);
    sf_light_tree_destroy(lights->tree);
    memset(lights, 0, sizeof *lights);
}

/* ---- pieces ---- */

/* How near a point must be for the piece to be sampled by solid angle: its square, 0 for never. A
 * parallelogram must have right angles, up to the rounding of its corners. */
static float near_square(const float *piece, float ratio) {
    double e1 = 0, e2 = 0, along = 0;
    for (int c = 0; c < 3; ++c) {
        double a = (double)piece[SF_LIGHT_EDGE1_X + c], b = (double)piece[SF_LIGHT_EDGE2_X + c];
        e1 += a * a;
        e2 += b * b;
        along += a * b;
    }
    bool square = piece[SF_LIGHT_KIND] == (float)SF_LIGHT_IS_TRIANGLE || along * along <= 1e-10 * e1 * e2;
    return square ? (float)((double)ratio * ratio * (e1 + e2)) : 0;
}

/* Writes the geometry of a piece; returns its area. */
static double write_flat(float *piece, const sf_mesh *mesh, const candidate *from, float ratio) {
    const float *k = vertex(mesh, from->triangle, from->corner);
    const float *i = vertex(mesh, from->triangle, from->corner + 1);
    const float *j = vertex(mesh, from->triangle, from->corner + 2);
    double n[3];
    sf_triangle_cross(k, i, j, n);
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), share = from->rectangle ? 0.5 : 1.0 / 3;
    for (int c = 0; c < 3; ++c) {
        piece[SF_LIGHT_ORIGIN_X + c] = k[c];
        piece[SF_LIGHT_EDGE1_X + c] = i[c] - k[c];
        piece[SF_LIGHT_EDGE2_X + c] = j[c] - k[c];
        piece[SF_LIGHT_NORMAL_X + c] = (float)(n[c] / length);
        piece[SF_LIGHT_MIDDLE_X + c] = (float)((double)k[c] + share * ((double)i[c] - k[c] + ((double)j[c] - k[c])));
    }
    float longest = 0;
    for (int f = SF_LIGHT_EDGE1_X; f <= SF_LIGHT_EDGE2_Z; ++f) longest = fmaxf(longest, fabsf(piece[f]));
    piece[SF_LIGHT_LIFT] = SF_LIFT_OF_EDGES * longest;
    piece[SF_LIGHT_RECTANGLE] = from->rectangle;
    piece[SF_LIGHT_KIND] = (float)(from->rectangle ? SF_LIGHT_IS_PARALLELOGRAM : SF_LIGHT_IS_TRIANGLE);
    piece[SF_LIGHT_NEAR] = near_square(piece, ratio);
    return from->rectangle ? length : 0.5 * length;
}

/* A disk is sampled by area, a sphere by the cone that it fills. Returns the area. */
static double write_quadric(float *piece, const sf_quadric *quadric) {
    float radius = quadric->radius, tangent[3], bitangent[3];
    bool disk = quadric->kind == SF_QUADRIC_DISK;
    sf_frame_from_normal(quadric->normal, tangent, bitangent);
    for (int c = 0; c < 3; ++c) {
        piece[SF_LIGHT_ORIGIN_X + c] = quadric->centre[c];
        piece[SF_LIGHT_EDGE1_X + c] = disk ? radius * tangent[c] : c == 0 ? radius : 0;
        piece[SF_LIGHT_EDGE2_X + c] = disk ? radius * bitangent[c] : 0;
        piece[SF_LIGHT_NORMAL_X + c] = quadric->normal[c];
    }
    piece[SF_LIGHT_KIND] = (float)(disk ? SF_LIGHT_IS_DISK : SF_LIGHT_IS_SPHERE);
    return (disk ? PI : 4 * PI) * ((double)radius * radius);
}

/* Flat ones have their area, spheres none: their samples have a density by solid angle. */
static sf_light_source source_of(const sf_mesh *mesh, uint32_t number, double area, bool flat) {
    double radiance = (double)mesh->emission[0] + mesh->emission[1] + mesh->emission[2];
    sf_light_source source = {.area = flat ? area : 1, .power = flat ? radiance : area * radiance, .mesh = number};
    memcpy(source.radiance, mesh->emission, sizeof source.radiance);
    return source;
}

static void write_sun(float *piece, const sf_sky_sun *sun) {
    memcpy(piece + SF_LIGHT_NORMAL_X, sun->direction, 12);
    sf_frame_from_normal(sun->direction, piece + SF_LIGHT_EDGE1_X, piece + SF_LIGHT_EDGE2_X);
    piece[SF_LIGHT_HEIGHT] = sun->height;
    piece[SF_LIGHT_KIND] = (float)(sun->height > 0 ? SF_LIGHT_IS_SUN : SF_LIGHT_IS_DIRECTION);
}

/* The suns, then the environment; their power is what they send through the scene's sphere. */
static void write_sky(const sf_scene *scene, float (*pieces)[SF_LIGHT_FIELDS], sf_light_source *sources) {
    const sf_sky *sky = &scene->sky;
    for (size_t i = 0; i < sky->sun_count; ++i) {
        const float *e = scene->suns[i].irradiance;
        write_sun(pieces[i], sky->suns + i);
        sources[i] = (sf_light_source){.area = 1, .power = (double)e[0] + e[1] + e[2], .sky = true};
        memcpy(sources[i].radiance, sky->suns[i].radiance, sizeof sources[i].radiance);
    }
    if (!sky->environment.pixels) return;
    pieces[sky->sun_count][SF_LIGHT_KIND] = (float)SF_LIGHT_IS_ENVIRONMENT;
    sources[sky->sun_count] = (sf_light_source){.radiance = {1, 1, 1}, .area = 1, .power = sky->total, .sky = true};
}

/* Writes the pieces: those of meshes, of spheres and disks, of the sky. */
static void write_pieces(sf_scene *scene, const candidate *candidates, size_t count, sf_light_source *sources) {
    float (*pieces)[SF_LIGHT_FIELDS] = scene->lights.pieces;
    size_t row = 0;
    for (size_t i = 0; i < count; ++i) {
        if (candidates[i].absorbed) continue;
        const sf_mesh *mesh = &scene->meshes[candidates[i].mesh].mesh;
        double area = write_flat(pieces[row], mesh, &candidates[i], scene->solid_angle_ratio);
        sources[row++] = source_of(mesh, candidates[i].mesh, area, true);
    }
    for (uint32_t m = 0; m < scene->info.mesh_count; ++m) {
        const sf_scene_mesh *shape = scene->meshes + m;
        if (!shape->quadric.kind || !sf_emits(&shape->mesh)) continue;
        double area = write_quadric(pieces[row], &shape->quadric);
        sources[row++] = source_of(&shape->mesh, m, area, shape->quadric.kind == SF_QUADRIC_DISK);
    }
    write_sky(scene, pieces + row, sources + row);
}

/* ---- from a hit to its piece ---- */

/* Whole pieces first, then the halves that go with them. */
static void map_triangles(sf_light_table *lights, const candidate *candidates, size_t count) {
    size_t row = 0;
    for (size_t i = 0; i < count; ++i) {
        if (candidates[i].absorbed) continue;
        lights->of_primitive[lights->first_of_mesh[candidates[i].mesh] + candidates[i].triangle] = (uint32_t)row++;
    }
    for (size_t i = 0; i < count; ++i) {
        if (!candidates[i].absorbed) continue;
        const uint32_t *of_mesh = lights->of_primitive + lights->first_of_mesh[candidates[i].mesh];
        lights->of_primitive[lights->first_of_mesh[candidates[i].mesh] + candidates[i].triangle] =
            of_mesh[candidates[i].partner];
    }
}

static sf_status map_primitives(sf_scene *scene, const candidate *candidates, size_t count, sf_error *error) {
    sf_light_table *lights = &scene->lights;
    size_t meshes = scene->info.mesh_count, primitives = 0, row = 0;
    lights->first_of_mesh = malloc((meshes + 1) * sizeof *lights->first_of_mesh);
    if (!lights->first_of_mesh) return sf_fail_memory(error, "the meshes of the lights", meshes * sizeof(size_t));
    for (size_t m = 0; m < meshes; ++m) {
        const sf_scene_mesh *shape = scene->meshes + m;
        lights->first_of_mesh[m] = primitives;
        if (sf_emits(&shape->mesh)) primitives += shape->quadric.kind ? 1 : shape->mesh.triangle_count;
    }
    lights->of_primitive = calloc(primitives + 1, sizeof *lights->of_primitive);
    if (!lights->of_primitive) return sf_fail_memory(error, "the triangles of the lights", primitives * 4);
    map_triangles(lights, candidates, count);
    for (size_t i = 0; i < count; ++i) row += !candidates[i].absorbed;
    for (size_t m = 0; m < meshes; ++m)
        if (scene->meshes[m].quadric.kind && sf_emits(&scene->meshes[m].mesh))
            lights->of_primitive[lights->first_of_mesh[m]] = (uint32_t)row++;
    return SF_STATUS_OK;
}

/* ---- the table ---- */

static size_t count_others(const sf_scene *scene) {
    size_t count = scene->info.sun_count + (scene->environment.pixels != NULL);
    for (size_t m = 0; m < scene->info.mesh_count; ++m)
        count += scene->meshes[m].quadric.kind && sf_emits(&scene->meshes[m].mesh);
    return count;
}

static sf_status build_table(sf_scene *scene, candidate *candidates, size_t count, sf_error *error) {
    sf_light_table *lights = &scene->lights;
    size_t flat = count;
    for (size_t i = 0; i < count; ++i) {
        flat -= candidates[i].absorbed;
        lights->rectangle_count += candidates[i].rectangle;
    }
    lights->count = flat + count_others(scene);
    sf_light_source *sources = malloc(lights->count * sizeof *sources);
    if (!sources) return sf_fail_memory(error, "the list of lights", lights->count * sizeof *sources);
    sf_status status = allocate_lights(lights, lights->count, error);
    if (!status) write_pieces(scene, candidates, count, sources);
    if (!status) status = sf_lights_grow_tree(scene, sources, error);
    if (!status) status = sf_light_table_fill(scene, sources, error);
    free(sources);
    lights->special = !status && (lights->tree || lights->count > flat || sf_scene_scatters(scene) || sf_foggy(scene) ||
                                  sf_lights_near(scene));
    if (lights->special) status = map_primitives(scene, candidates, count, error);
    return status;
}

sf_status sf_lights_build(sf_scene *scene, sf_error *error) {
    size_t count = list_candidates(scene, NULL);
    if (count + count_others(scene) == 0) return SF_STATUS_OK;
    if (count + count_others(scene) > UINT32_MAX)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%zu emissive triangles; at most 2^32 - 1 are allowed", count);
    candidate *candidates = malloc((count + 1) * sizeof *candidates);
    if (!candidates) return sf_fail_memory(error, "the list of lights", count * sizeof *candidates);
    list_candidates(scene, candidates);
    sf_status status = count ? pair_rectangles(scene, candidates, count, error) : SF_STATUS_OK;
    if (!status) status = build_table(scene, candidates, count, error);
    free(candidates);
    return status;
}
