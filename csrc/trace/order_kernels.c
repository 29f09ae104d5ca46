// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Lists and sorts a batch's rays, so that those of a packet have much in common. */
#include "trace/order_kernels.h"

#include <string.h>

#include "trace/rays.h"

#define SHADOW_BINS 64   /* 4 quarters of a cell x 4 x 4 cells of the light */
#define SURFACE_BINS 256 /* 8 octants of directions x 8 of the scene x 4 of slopes */

/* In most batches all are: that takes no more than a look. */
static uint32_t list_alive(sf_batch *b, uint32_t count) {
    uint32_t kept = 0, all = 1;
    for (uint32_t i = 0; i < count; ++i) all &= b->alive[i];
    for (uint32_t i = 0; all && i < count; ++i) b->order[i] = i;
    if (all) return count;
    for (uint32_t i = 0; i < count; ++i) {
        b->order[kept] = i;
        kept += b->alive[i];
    }
    return kept;
}

static void move_floats(sf_batch *b, float *SF_RESTRICT array, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) b->gather[i] = array[b->order[i]];
    memcpy(array, b->gather, count * sizeof *array);
}

/* `bin` has been read by then: it is the scratch. */
static void move_integers(sf_batch *b, uint32_t *SF_RESTRICT array, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) b->bin[i] = array[b->order[i]];
    memcpy(array, b->bin, count * sizeof *array);
}

static uint32_t compact(sf_batch *b, uint32_t count) {
    uint32_t kept = list_alive(b, count);
    if (kept == count) return kept;
    for (int c = 0; c < 3; ++c) {
        move_floats(b, b->point[c], kept);
        move_floats(b, b->normal[c], kept);
        move_floats(b, b->throughput[c], kept);
    }
    for (uint32_t i = 0; i < kept; ++i) b->path[i] = b->path[b->order[i]]; /* order[i] >= i */
    b->in_place = false;
    return kept;
}

/* Lists the rays in `order` by their bins, a counting sort without a branch; `place` has bins + 1 zeros.
 * Returns how many are not in the last bin. */
static inline uint32_t list_by_bin(sf_batch *b, uint32_t count, uint32_t bins, uint32_t *SF_RESTRICT place) {
    for (uint32_t i = 0; i < count; ++i) ++place[b->bin[i] + 1];
    for (uint32_t bin = 0; bin < bins; ++bin) place[bin + 1] += place[bin];
    for (uint32_t i = 0; i < count; ++i) b->order[place[b->bin[i]]++] = i;
    return place[bins - 2];
}

/* By the quarter of the cell and the cell of the light: rays of a bin start close to each other and end
 * close to each other. Those that have no contribution get a bin of their own, the last. */
static uint32_t sort_shadow_rays(sf_batch *b, uint32_t count) {
    uint32_t place[SHADOW_BINS + 2] = {0}, shift = 0;
    while (b->width * SF_BLOCKS / 4 >> shift > 1) ++shift; /* paths of a quarter, a power of two */
    float (*u)[SF_PATHS] = b->in_place ? b->coordinate : b->coordinate_by_ray;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t bin = (b->path[i] >> shift) * 16 + (uint32_t)(int)(u[0][i] * 4) * 4 + (uint32_t)(int)(u[1][i] * 4);
        b->bin[i] = b->alive[i] ? bin : SHADOW_BINS;
    }
    return list_by_bin(b, count, SHADOW_BINS + 1, place);
}

/* First by the octant of the direction, as Embree traces the rays of a packet that lie in one together;
 * then by the octant of the scene that they start in; then by which components of the direction are large. */
static void bin_surface_rays(sf_batch *b, const float *middle, uint32_t count) {
    for (uint32_t i = 0; i < sf_whole_packets(count); ++i) {
        float x = b->direction[0][i], y = b->direction[1][i], z = b->direction[2][i];
        uint32_t octant = (uint32_t)(x < 0) << 2 | (uint32_t)(y < 0) << 1 | (uint32_t)(z < 0);
        uint32_t start = (uint32_t)(b->point[0][i] < middle[0]) << 2 | (uint32_t)(b->point[1][i] < middle[1]) << 1 |
                         (uint32_t)(b->point[2][i] < middle[2]);
        uint32_t slope = (uint32_t)(x * x > 1.0f / 3) << 1 | (uint32_t)(y * y > 1.0f / 3);
        b->bin[i] = octant << 5 | start << 2 | slope;
    }
}

/* Moves the vertices that the surface rays leave as these were moved. Only the light tree still reads them: it
 * weighs a light that a ray hits as it would have chosen it from there. What else describes a vertex is of no
 * use from now on until new ones are placed; builds that are tested make it no number, so that a stage that
 * reads it fails. */
static void move_vertices_left(sf_batch *b, const sf_scene *scene, uint32_t count) {
    bool scatter = sf_plan_has(&scene->plan, SF_STAGE_SCATTER);
    if (scene->lights.tree) {
        for (int c = 0; c < 3; ++c) {
            move_floats(b, b->point[c], count);
            move_floats(b, b->normal[c], count);
        }
        if (scatter) move_integers(b, b->surface, count);
    }
#ifdef SUNFLECK_POISON
    for (int c = 0; c < 3 && !scene->lights.tree; ++c) {
        memset(b->point[c], 0xff, sizeof b->point[c]);
        memset(b->normal[c], 0xff, sizeof b->normal[c]);
    }
    for (int c = 0; c < 3; ++c) memset(b->outgoing[c], 0xff, sizeof b->outgoing[c]);
    memset(b->lift, 0xff, sizeof b->lift);
    memset(b->light_pdf, 0xff, sizeof b->light_pdf);
#endif
}

static uint32_t sort_surface_rays(sf_batch *b, const sf_scene *scene, uint32_t count) {
    uint32_t place[SURFACE_BINS + 2] = {0};
    bin_surface_rays(b, scene->middle, count);
    if (sf_plan_has(&scene->plan, SF_STAGE_SCATTER)) /* else `alive` is of the shadow rays */
        for (uint32_t i = 0; i < count; ++i) b->bin[i] = b->alive[i] ? b->bin[i] : SURFACE_BINS;
    count = list_by_bin(b, count, SURFACE_BINS + 1, place);
    for (int c = 0; c < 3; ++c) {
        move_floats(b, b->origin[c], count);
        move_floats(b, b->direction[c], count);
        move_floats(b, b->throughput[c], count);
    }
    move_floats(b, b->pdf, count);
    move_integers(b, b->path, count);
    move_vertices_left(b, scene, count);
    b->in_place = false;
    return count;
}

const sf_order_kernels SF_AT_ISA(sf_order_kernels) = {list_alive, compact, sort_shadow_rays, sort_surface_rays};
