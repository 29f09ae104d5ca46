// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Rays to Embree and back, in packets of 16; those of the camera several packets at a time. The width and
 * the flags of a stage never change while a scene is rendered, so that Embree's answers do not depend on
 * which rays share a packet. */

#include "trace/trace_kernels.h"

#include <math.h>
#include <string.h>

#include "trace/rays.h"

static void take_hits(sf_batch *b, const sf_scene *scene, const struct RTCRayHit16 *rays, size_t first) {
    float scale = scene->normal_scale;
    uint32_t miss = scene->mesh_table.miss;
    memcpy(b->distance + first, rays->ray.tfar, sizeof rays->ray.tfar);
    SF_ROLLED
    for (size_t l = 0; l < SF_LANES; ++l) {
        b->hit_normal[0][first + l] = rays->hit.Ng_x[l] * scale;
        b->hit_normal[1][first + l] = rays->hit.Ng_y[l] * scale;
        b->hit_normal[2][first + l] = rays->hit.Ng_z[l] * scale;
    }
    SF_ROLLED
    for (size_t l = 0; l < SF_LANES; ++l) {
        uint32_t mesh = rays->hit.geomID[l];
        b->mesh[first + l] = mesh < miss ? mesh : miss;
    }
    if (sf_plan_has(&scene->plan, SF_STAGE_LIGHT_SHAPES))
        memcpy(b->primitive + first, rays->hit.primID, sizeof rays->hit.primID);
}

/* The same where there are instances. Embree gives the instance, the number of its first mesh, and the
 * mesh within it; its normals are the prototype's. */
static void take_placed_hits(sf_batch *b, const sf_scene *scene, const struct RTCRayHit16 *rays, size_t first) {
    uint32_t miss = scene->mesh_table.miss;
    memcpy(b->distance + first, rays->ray.tfar, sizeof rays->ray.tfar);
    for (int l = 0; l < SF_LANES; ++l) {
        uint32_t instance = rays->hit.instID[0][l], mesh = rays->hit.geomID[l];
        mesh += instance == RTC_INVALID_GEOMETRY_ID ? 0 : instance;
        b->mesh[first + l] = mesh = mesh < miss ? mesh : miss;
        const float *turn = scene->turns[mesh];
        float x = rays->hit.Ng_x[l], y = rays->hit.Ng_y[l], z = rays->hit.Ng_z[l];
        for (int c = 0; c < 3; ++c)
            b->hit_normal[c][first + l] = turn[3 * c] * x + turn[3 * c + 1] * y + turn[3 * c + 2] * z;
    }
    if (sf_plan_has(&scene->plan, SF_STAGE_LIGHT_SHAPES))
        memcpy(b->primitive + first, rays->hit.primID, sizeof rays->hit.primID);
}

/* The 16 rays from `first` on. */
static inline void copy_rays(float (*from)[SF_PATHS], float (*to)[SF_PATHS], uint32_t first, struct RTCRay16 *rays) {
    memcpy(rays->org_x, from[0] + first, sizeof rays->org_x);
    memcpy(rays->org_y, from[1] + first, sizeof rays->org_y);
    memcpy(rays->org_z, from[2] + first, sizeof rays->org_z);
    memcpy(rays->dir_x, to[0] + first, sizeof rays->dir_x);
    memcpy(rays->dir_y, to[1] + first, sizeof rays->dir_y);
    memcpy(rays->dir_z, to[2] + first, sizeof rays->dir_z);
}

#define STREAM 8 /* packets */

/* The packet's rays, those that are not wanted with an end before their beginning. */
static inline void pack_rays(sf_batch *b, struct RTCRayHit16 *rays, uint32_t first, uint32_t wanted) {
    copy_rays(b->origin, b->direction, first, &rays->ray);
    SF_ROLLED
    for (uint32_t l = 0; l < SF_LANES; ++l) rays->ray.tfar[l] = wanted >> l & 1u ? INFINITY : -1.0f;
    memset(rays->hit.geomID, 0xff, sizeof rays->hit.geomID);
    memset(rays->hit.instID, 0xff, sizeof rays->hit.instID);
}

static void nearest(sf_batch *b, const sf_scene *scene, uint32_t packets, const uint32_t *active,
                    sf_coherence coherence) {
    SF_ALIGNED(struct RTCRayHit16) rays[STREAM];
    bool placed = sf_plan_has(&scene->plan, SF_STAGE_INSTANCES);
    uint32_t most = coherence == SF_STREAM ? STREAM : 1;
    memset(rays, 0, most * sizeof *rays);
    for (uint32_t k = 0; k < most; ++k) memset(rays[k].ray.mask, 0xff, sizeof rays[k].ray.mask);
    for (uint32_t first = 0; first < packets; first += most) {
        uint32_t some = packets - first < most ? packets - first : most;
        for (uint32_t k = 0; k < some; ++k) pack_rays(b, rays + k, (first + k) * SF_LANES, active[first + k]);
        sf_embree_intersect16(scene->embree, rays, some, coherence);
        for (uint32_t k = 0; k < some; ++k)
            if (placed)
                take_placed_hits(b, scene, rays + k, (first + k) * SF_LANES);
            else
                take_hits(b, scene, rays + k, (first + k) * SF_LANES);
    }
}

/* Whether the list names 16 rays that lie one after another. */
static inline bool are_together(const uint32_t *order) {
    uint32_t different = 0;
    SF_ROLLED
    for (uint32_t l = 0; l < SF_LANES; ++l) different |= order[l] ^ (order[0] + l);
    return different == 0;
}

static inline void pick(const float *SF_RESTRICT from, const uint32_t *SF_RESTRICT order, float *SF_RESTRICT to) {
    for (uint32_t l = 0; l < SF_LANES; ++l) to[l] = from[order[l]];
}

static inline void pick_rays(float (*from)[SF_PATHS], float (*to)[SF_PATHS], const uint32_t *order,
                             struct RTCRay16 *rays) {
    pick(from[0], order, rays->org_x);
    pick(from[1], order, rays->org_y);
    pick(from[2], order, rays->org_z);
    pick(to[0], order, rays->dir_x);
    pick(to[1], order, rays->dir_y);
    pick(to[2], order, rays->dir_z);
}

static inline void trace_shadow_packet(sf_batch *b, const sf_scene *scene, float (*from)[SF_PATHS],
                                       struct RTCRay16 *rays, const uint32_t *order, uint32_t lanes) {
    if (are_together(order))
        copy_rays(from, b->to_light, order[0], rays);
    else
        pick_rays(from, b->to_light, order, rays);
    SF_ROLLED
    for (uint32_t l = 0; l < SF_LANES; ++l) rays->tfar[l] = l < lanes ? 1.0f : -1.0f;
    sf_embree_occluded16(scene->embree, rays);
}

static inline void take_arrivals(sf_batch *b, const struct RTCRay16 *rays, const uint32_t *order, uint32_t lanes) {
    if (are_together(order)) { /* then there are 16 */
        float *arrives = b->arrives + order[0];
        SF_ROLLED
        for (uint32_t l = 0; l < SF_LANES; ++l) arrives[l] = rays->tfar[l] > 0 ? 1.0f : 0.0f;
    } else
        for (uint32_t l = 0; l < lanes; ++l) b->arrives[order[l]] = rays->tfar[l] > 0 ? 1.0f : 0.0f;
}

static inline uint32_t lanes_from(uint32_t first, uint32_t count) {
    return count - first < SF_LANES ? count - first : SF_LANES;
}

/* A packet's answers are read after the next is traced: right after Embree's masked stores they would be
 * waited for. */
static void shadow(sf_batch *b, const sf_scene *scene, float (*from)[SF_PATHS], uint32_t count) {
    SF_ALIGNED(struct RTCRay16) rays[2];
    memset(rays, 0, sizeof rays);
    for (int k = 0; k < 2; ++k) memset(rays[k].mask, 0xff, sizeof rays[k].mask);
    for (uint32_t i = count; i < sf_whole_packets(count); ++i) b->order[i] = b->order[0];
    for (uint32_t first = 0, turn = 0; first < count + SF_LANES; first += SF_LANES, turn ^= 1) {
        if (first < count) trace_shadow_packet(b, scene, from, rays + turn, b->order + first, lanes_from(first, count));
        if (first > 0) {
            uint32_t before = first - SF_LANES;
            take_arrivals(b, rays + (turn ^ 1), b->order + before, lanes_from(before, count));
        }
    }
}

const sf_trace_kernels SF_AT_ISA(sf_trace_kernels) = {nearest, shadow};
