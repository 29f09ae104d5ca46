// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Shades what a batch's rays hit: adds emission, places vertices, plays roulette, starts the next rays. */
#include "trace/shade_kernels.h"

#include <math.h>
#include <string.h>

#include "sunfleck/mapping.h"
#include "trace/rays.h"

/* ---- what the meshes hold ---- */

/* Whether all rays of a packet hit the same mesh, as most packets' do. */
static inline bool hits_one_mesh(const uint32_t mesh[SF_LANES]) {
    uint32_t different = 0;
    SF_ROLLED
    for (size_t l = 0; l < SF_LANES; ++l) different |= mesh[l] ^ mesh[0];
    return different == 0;
}

/* Reads `columns` columns of the mesh table for the packet from ray `i` on; without gathering where it
 * hit one mesh. */
static inline void look_up_packet(const sf_mesh_table *table, int first, int columns, const uint32_t *mesh, size_t i,
                                  float (*SF_RESTRICT out)[SF_PATHS]) {
    bool one = hits_one_mesh(mesh + i);
    for (int c = 0; c < columns; ++c) {
        const float *column = table->columns[first + c];
        if (one) {
            float value = column[mesh[i]];
            SF_ROLLED
            for (size_t l = 0; l < SF_LANES; ++l) out[c][i + l] = value;
        } else
            for (size_t l = 0; l < SF_LANES; ++l) out[c][i + l] = column[mesh[i + l]];
    }
}

static void look_up(const sf_mesh_table *table, int first, int columns, const uint32_t *mesh, uint32_t count,
                    float (*SF_RESTRICT out)[SF_PATHS]) {
    for (size_t i = 0; i < count; i += SF_LANES) look_up_packet(table, first, columns, mesh, i, out);
}

/* How far the ray goes along the geometric normal: below 0 where it comes from the side that this points to. */
static inline float along_normal(const sf_batch *b, size_t i) {
    return b->direction[0][i] * b->hit_normal[0][i] + b->direction[1][i] * b->hit_normal[1][i] +
           b->direction[2][i] * b->hit_normal[2][i];
}

/* What a packet of camera rays sees of lights: nothing, mostly. */
static inline void see_emission(sf_batch *b, const sf_mesh_table *table, size_t first) {
    const float *red = table->columns[SF_MESH_EMISSION_R], *green = table->columns[SF_MESH_EMISSION_G],
                *blue = table->columns[SF_MESH_EMISSION_B];
    uint32_t mesh = b->mesh[first];
    if (hits_one_mesh(b->mesh + first) && !(red[mesh] + green[mesh] + blue[mesh] > 0)) {
        for (int c = 0; c < 3; ++c) memset(b->radiance[c] + first, 0, SF_LANES * sizeof(float));
        return;
    }
    look_up_packet(table, SF_MESH_EMISSION_R, 3, b->mesh, first, b->radiance);
    for (size_t i = first; i < first + SF_LANES; ++i) {
        float front = along_normal(b, i) < 0 ? 1.0f : 0.0f;
        for (int c = 0; c < 3; ++c) b->radiance[c][i] = b->covered[i] > 0 ? front * b->radiance[c][i] : 0.0f;
    }
}

static void first_radiance(sf_batch *b, const sf_scene *scene) {
    uint32_t n = sf_batch_paths(b), miss = scene->mesh_table.miss;
    for (uint32_t i = 0; i < n; ++i) b->covered[i] = b->mesh[i] == miss ? 0.0f : 1.0f;
    if (sf_plan_has(&scene->plan, SF_STAGE_EMISSION))
        for (size_t first = 0; first < n; first += SF_LANES) see_emission(b, &scene->mesh_table, first);
    else
        for (int c = 0; c < 3; ++c) memset(b->radiance[c], 0, n * sizeof(float));
    if (sf_plan_has(&scene->plan, SF_STAGE_MISS))
        for (uint32_t i = 0; i < n; ++i)
            for (int c = 0; c < 3; ++c) b->radiance[c][i] += b->covered[i] > 0 ? 0.0f : scene->background[c];
}

/* Adds the light that ray i hit, weighted against sampling it. */
static inline void add_hit_light(sf_batch *b, const sf_mesh_table *table, uint32_t i) {
    float nx = b->hit_normal[0][i], ny = b->hit_normal[1][i], nz = b->hit_normal[2][i];
    float along = -along_normal(b, i);
    if (!(along > 0)) return;
    float cosine = along / sqrtf(nx * nx + ny * ny + nz * nz);
    /* Density by area to density by solid angle: times distance^2 / cosine. */
    float weight = sf_power_weight(b->pdf[i], b->light_pdf[i] * b->distance[i] * b->distance[i] / cosine);
    for (int c = 0; c < 3; ++c)
        b->radiance[c][b->path[i]] += b->throughput[c][i] * table->columns[SF_MESH_EMISSION_R + c][b->mesh[i]] * weight;
}

/* The rays that found light are few: they are listed, and taken one by one. */
static void later_radiance(sf_batch *b, const sf_scene *scene, uint32_t count) {
    uint32_t n = sf_whole_packets(count), miss = scene->mesh_table.miss, found = 0;
    bool emission = sf_plan_has(&scene->plan, SF_STAGE_EMISSION), background = sf_plan_has(&scene->plan, SF_STAGE_MISS);
    if (!emission && !background) return;
    if (emission)
        look_up(&scene->mesh_table, SF_MESH_LIGHT_PDF, 1, b->mesh, n, &b->light_pdf);
    else
        memset(b->light_pdf, 0, n * sizeof(float));
    for (uint32_t i = 0; i < count; ++i) {
        b->order[found] = i;
        found += (uint32_t)(b->light_pdf[i] > 0) | ((uint32_t)background & (uint32_t)(b->mesh[i] == miss));
    }
    for (uint32_t k = 0; k < found; ++k) {
        uint32_t i = b->order[k];
        if (b->mesh[i] != miss)
            add_hit_light(b, &scene->mesh_table, i);
        else
            for (int c = 0; c < 3; ++c) b->radiance[c][b->path[i]] += b->throughput[c][i] * scene->background[c];
    }
}

/* ---- vertices ---- */

/* Puts the vertex where the ray hit, with its normal on the ray's side, and moves it off the
 * surface along that normal by 2^-18 of what its coordinates were computed from: |origin| and
 * the distance. Their rounding, and that of Embree's own distance, is some 2^-22 of it. `least` is
 * the same for triangles far larger than these; where the scene is robust, `back` is 1 and the point
 * is moved back along the ray too: what the ray has crossed lies on this side of all surfaces. */
static inline void place_vertex(sf_batch *b, uint32_t i, float least, float back) {
    float nx = b->hit_normal[0][i], ny = b->hit_normal[1][i], nz = b->hit_normal[2][i];
    float dx = b->direction[0][i], dy = b->direction[1][i], dz = b->direction[2][i];
    float ox = b->origin[0][i], oy = b->origin[1][i], oz = b->origin[2][i], t = b->distance[i];
    float along = dx * nx + dy * ny + dz * nz, length = 1 / sqrtf(nx * nx + ny * ny + nz * nz);
    float turn = along > 0 ? -length : length;
    nx *= turn;
    ny *= turn;
    nz *= turn;
    float lift = sf_lift(ox, oy, oz, t);
    lift = lift > least ? lift : least;
    t -= back * lift;
    b->point[0][i] = ox + t * dx + lift * nx;
    b->point[1][i] = oy + t * dy + lift * ny;
    b->point[2][i] = oz + t * dz + lift * nz;
    b->normal[0][i] = nx;
    b->normal[1][i] = ny;
    b->normal[2][i] = nz;
}

/* `pass`: what the surfaces pass on. */
static void place_vertices(sf_batch *b, const sf_scene *scene, uint32_t n, float (*pass)[SF_PATHS]) {
    look_up(&scene->mesh_table, SF_MESH_PASS_R, 3, b->mesh, n, pass);
    look_up(&scene->mesh_table, SF_MESH_LIFT, 1, b->mesh, n, &b->gather);
    for (uint32_t i = 0; i < n; ++i) place_vertex(b, i, b->gather[i], scene->back);
}

static void first_vertex(sf_batch *b, const sf_scene *scene) {
    uint32_t n = sf_batch_paths(b);
    place_vertices(b, scene, n, b->throughput);
    for (uint32_t i = 0; i < n; ++i) {
        b->path[i] = i;
        b->alive[i] = b->throughput[0][i] + b->throughput[1][i] + b->throughput[2][i] > 0;
    }
}

static void later_vertex(sf_batch *b, const sf_scene *scene, uint32_t count) {
    uint32_t n = sf_whole_packets(count);
    place_vertices(b, scene, n, b->albedo);
    for (uint32_t i = 0; i < n; ++i) {
        float r = b->throughput[0][i] *= b->albedo[0][i];
        float g = b->throughput[1][i] *= b->albedo[1][i];
        float blue = b->throughput[2][i] *= b->albedo[2][i];
        b->alive[i] = r + g + blue > 0;
    }
}

/* Arvo & Kirk 1990, "Particle Transport and Image Synthesis". The least probability, 1/32, bounds
 * what the noise of a path can grow by. */
static void roulette(sf_batch *b, uint32_t count) {
    float (*u)[SF_PATHS] = sf_sample_dimensions_by_ray(b, count, 1);
    for (uint32_t i = 0; i < sf_whole_packets(count); ++i) {
        float red = b->throughput[0][i], green = b->throughput[1][i], blue = b->throughput[2][i];
        float q = red > green ? red : green;
        q = q > blue ? q : blue;
        q = q > 0x1p-5f ? q : 0x1p-5f;
        q = q < 1 ? q : 1.0f;
        b->alive[i] &= u[0][i] < q;
        for (int c = 0; c < 3; ++c) b->throughput[c][i] *= 1 / q;
    }
}

/* ---- surface ---- */

static void surface(sf_batch *b, uint32_t count) {
    float (*u)[SF_PATHS] = sf_sample_dimensions_by_ray(b, count, 2);
    for (uint32_t i = 0; i < sf_whole_packets(count); ++i) {
        float normal[3] = {b->normal[0][i], b->normal[1][i], b->normal[2][i]};
        float local[3], tangent[3], bitangent[3], world[3];
        sf_cosine_hemisphere_sample(u[0][i], u[1][i], local);
        sf_frame_from_normal(normal, tangent, bitangent);
        sf_frame_to_world(tangent, bitangent, normal, local, world);
        b->pdf[i] = local[2] * (1.0f / SF_PI_F);
        for (int c = 0; c < 3; ++c) {
            b->direction[c][i] = world[c];
            b->origin[c][i] = b->point[c][i];
        }
    }
}

const sf_shade_kernels SF_AT_ISA(sf_shade_kernels) = {first_radiance, later_radiance, first_vertex,
                                                      later_vertex,   roulette,       surface};
