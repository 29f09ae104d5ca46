// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A batch: up to 1,024 paths of one cell of the frame, carried through the stages of the plan
 * together as a structure of arrays. One thread owns it; it fits that core's second-level cache.
 *
 * Lane `width` b + l of the arrays by path is sample `first_sample` + l of block b: blocks of which
 * fewer than 16 samples are wanted share packets. Arrays by ray are compact: rays 0 .. count - 1
 * are alive, and `path` says whose they are. They are processed in whole packets of 16; what the
 * lanes past the end hold is not used. */
#ifndef SUNFLECK_BATCH_H
#define SUNFLECK_BATCH_H

#include <stdbool.h>

#include "base/platform.h"
#include "film/block.h"
#include "scene/scene_internal.h"
#include "sunfleck/film.h"
#include "trace/sample_dimensions.h"
#include "trace/work_clock.h"

typedef struct sf_camera_frame {
    float position[3], forward[3], right[3], up[3]; /* an orthonormal frame */
    float pixel;                                    /* size of a pixel on the plane at distance 1 */
    float half_width, half_height;                  /* of the frame, in pixels */
    float aperture_radius, focus_distance;
} sf_camera_frame;

/* camera.c: the frame of a camera whose picture has that many pixels. */
sf_camera_frame sf_camera_frame_of(const sf_camera *camera, uint32_t width, uint32_t height);

/* What the batches of a render have in common; immutable while it runs. */
typedef struct sf_render_context {
    const sf_scene *scene;
    sf_sample_dimensions coordinates;
    sf_camera_frame camera;
    sf_pixel_filter filter;
    bool signed_filter; /* it has negative lobes */
    sf_seed_policy seeds;
    uint32_t roulette; /* bounce from which on; 0: none */
    uint32_t aovs;     /* bit k: sf_aov k is asked for */
    sf_isa isa;
} sf_render_context;

typedef struct sf_batch {
    SF_ALIGNED(float) origin[3][SF_PATHS]; /* of the rays */
    float direction[3][SF_PATHS];          /* unit length; while materials respond to light, towards it */
    float distance[SF_PATHS];              /* to the hit */
    float hit_normal[3][SF_PATHS];         /* Embree's, of any length */
    uint32_t mesh[SF_PATHS];               /* that was hit; the table's `miss` row for none */
    uint32_t path[SF_PATHS];
    float throughput[3][SF_PATHS];
    float pdf[SF_PATHS]; /* solid-angle density with which the surface drew the ray */

    float point[3][SF_PATHS];  /* the vertex, moved off its surface */
    float normal[3][SF_PATHS]; /* facing the side the ray came from */
    float albedo[3][SF_PATHS]; /* of later vertices, or 1: what the surface passes on, whatever the directions */
    float emission[3][SF_PATHS];
    float light_pdf[SF_PATHS];
    uint32_t alive[SF_PATHS]; /* 1 where the path goes on */

    float coordinate[3][SF_PATHS]; /* of the stage at work, by path */
    float coordinate_by_ray[3][SF_PATHS];

    float to_light[3][SF_PATHS];     /* from the vertex, not normalized */
    float contribution[3][SF_PATHS]; /* if nothing is in between */
    uint32_t bin[SF_PATHS];          /* of the ray, to be sorted by; scratch of moving paths */
    uint32_t order[SF_PATHS];        /* a permutation of rays, or a list of some */
    float arrives[SF_PATHS];         /* 1 where nothing is in between */
    float gather[SF_PATHS];          /* scratch of moving */

    float radiance[3][SF_PATHS]; /* by path */
    float covered[SF_PATHS];     /* by path: 1 where the camera ray hit a surface */

    sf_block blocks[SF_BLOCKS];
    sf_block_statistics statistics[SF_BLOCKS];
    uint32_t block_count;
    bool in_place;                                 /* path[i] = i: all paths live, and none was moved */
    uint32_t width, first_sample;                  /* of a block: how many lanes it has, and of which samples */
    uint32_t negative[SF_BLOCKS];                  /* bit l: the filter is negative at lane l of the block */
    sf_vector_moments negative_moments[SF_BLOCKS]; /* of those samples; `statistics` then has the others */
    /* With SF_STAGE_SCATTER alone, of the vertices. */
    float outgoing[3][SF_PATHS]; /* to where the path comes from, unit length */
    float outside[SF_PATHS];     /* 1 on the side that the geometric normal points to */
    float lift[SF_PATHS];        /* how far `point` lies off the surface */
    uint32_t surface[SF_PATHS];  /* the mesh */
    uint32_t by_scatter[SF_PATHS], scatter_first[SF_SCATTERS + 1];

    uint32_t primitive[SF_PATHS]; /* of the mesh that was hit; with SF_STAGE_LIGHT_SHAPES alone */
    struct sf_hit_sums *hit_sums; /* by block; NULL where no AOV asks for the first hits */
    sf_work_clock clock;
} sf_batch;

/* Lanes that the blocks have, in whole packets. */
static inline uint32_t sf_batch_paths(const sf_batch *b) {
    return (b->block_count * b->width + SF_LANES - 1) / SF_LANES * SF_LANES;
}

/* Bit l: whether the sample of the block's lane l is wanted. */
static inline uint32_t sf_batch_wanted(const sf_batch *b, uint32_t block) {
    return b->blocks[block].active >> b->first_sample & ((1u << b->width) - 1);
}

/* Traces the paths of the batch's blocks: fills `statistics`. */
void sf_batch_run(sf_batch *batch, const sf_render_context *context);

#endif
