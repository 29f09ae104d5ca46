// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Scatters paths at mirrors, conductors, dielectrics and in fog, and weighs the light that they reflect. */
#include "trace/material_kernels.h"

#include <math.h>

#include "sunfleck/material.h"
#include "trace/rays.h"

/* ---- what is kept of the rays that arrived ---- */

static void keep(sf_batch *b, const sf_scene *scene, uint32_t count) {
    for (uint32_t k = 0; k < count; ++k) {
        uint32_t i = b->order[k];
        float along = 0;
        for (int c = 0; c < 3; ++c) {
            float direction = b->direction[c][i];
            b->outgoing[c][k] = -direction;
            along += direction * b->hit_normal[c][i];
        }
        b->outside[k] = along < 0 ? 1.0f : 0.0f;
        b->surface[k] = b->mesh[i];
        float lift = sf_lift(b->origin[0][i], b->origin[1][i], b->origin[2][i], b->distance[i]);
        float least = scene->mesh_table.columns[SF_MESH_LIFT][b->mesh[i]];
        b->lift[k] = (lift > least ? lift : least) * (1 + scene->back);
        if (b->mesh[i] == scene->mesh_table.miss + 1) b->lift[k] = 0; /* the fog has no surface to leave */
    }
    if (!scene->quadrics) return;
    for (uint32_t k = 0; k < count; ++k) {
        const sf_quadric *quadric = scene->quadrics + b->surface[k];
        if (quadric->kind == SF_QUADRIC_SPHERE) b->lift[k] = sf_lift_on_sphere(quadric, b->lift[k]) * (1 + scene->back);
    }
}

static void compact(sf_batch *b, uint32_t count) {
    for (uint32_t k = 0; k < count; ++k) { /* order[k] >= k: nothing is overwritten before it is read */
        uint32_t i = b->order[k];
        for (int c = 0; c < 3; ++c) b->outgoing[c][k] = b->outgoing[c][i];
        b->outside[k] = b->outside[i];
        b->lift[k] = b->lift[i];
        b->surface[k] = b->surface[i];
    }
}

/* A counting sort, in the order of the rays. */
static void sort(sf_batch *b, const sf_scene *scene, uint32_t count) {
    const float *scatter = scene->mesh_table.columns[SF_MESH_SCATTER];
    uint32_t place[SF_SCATTERS] = {0};
    for (uint32_t i = 0; i < count; ++i) ++place[(int)scatter[b->surface[i]]];
    for (uint32_t s = 0, first = 0; s < SF_SCATTERS; ++s) {
        b->scatter_first[s] = first;
        first += place[s];
        place[s] = b->scatter_first[s];
    }
    b->scatter_first[SF_SCATTERS] = count;
    for (uint32_t i = 0; i < count; ++i) b->by_scatter[place[(int)scatter[b->surface[i]]]++] = i;
}

/* ---- a vertex in its surface's own frame ---- */

typedef struct vertex {
    float normal[3], tangent[3], bitangent[3];
    float w[3]; /* where the path comes from */
} vertex;

static inline void to_local(const vertex *v, const float world[3], float local[3]) {
    local[0] = sf_dot3(v->tangent, world);
    local[1] = sf_dot3(v->bitangent, world);
    local[2] = sf_dot3(v->normal, world);
}

static inline vertex vertex_at(const sf_batch *b, uint32_t i) {
    vertex v;
    float outgoing[3];
    for (int c = 0; c < 3; ++c) {
        v.normal[c] = b->normal[c][i];
        outgoing[c] = b->outgoing[c][i];
    }
    sf_frame_from_normal(v.normal, v.tangent, v.bitangent);
    to_local(&v, outgoing, v.w);
    v.w[2] = v.w[2] > 0x1p-24f ? v.w[2] : 0x1p-24f; /* rounding may put a grazing one below */
    return v;
}

static inline float column(const sf_batch *b, const sf_scene *scene, sf_mesh_column c, uint32_t i) {
    return scene->mesh_table.columns[c][b->surface[i]];
}

/* The index of refraction beyond the vertex over that on the side the path comes from. */
static inline float eta_at(const sf_batch *b, const sf_scene *scene, uint32_t i) {
    float ior = column(b, scene, SF_MESH_IOR, i);
    return b->outside[i] > 0 ? ior : 1 / ior;
}

/* Schlick's share of a conductor, channel by channel, from the albedo. */
static inline void reflectance(const sf_batch *b, const sf_scene *scene, uint32_t i, float cosine, float out[3]) {
    for (int c = 0; c < 3; ++c)
        out[c] = sf_fresnel_schlick(column(b, scene, (sf_mesh_column)(SF_MESH_ALBEDO_R + c), i), cosine);
}

/* The point that rays to the side of `z` start from: the vertex lies off the surface, on the side
 * that the path comes from. */
static inline void start_ray(sf_batch *b, uint32_t i, float z) {
    float down = z < 0 ? 2 * b->lift[i] : 0.0f;
    for (int c = 0; c < 3; ++c) b->origin[c][i] = b->point[c][i] - down * b->normal[c][i];
}

/* The path goes on from vertex i along `local`, with `factor` of what it carried. */
static inline void leave(sf_batch *b, uint32_t i, const vertex *v, const float local[3], const float factor[3],
                         float pdf) {
    float world[3], sum = 0;
    sf_frame_to_world(v->tangent, v->bitangent, v->normal, local, world);
    start_ray(b, i, local[2]);
    for (int c = 0; c < 3; ++c) {
        b->direction[c][i] = world[c];
        sum += b->throughput[c][i] *= factor[c];
    }
    b->pdf[i] = pdf;
    b->alive[i] = sum > 0;
}

/* ---- light ---- */

/* Vertex i scatters value[c] of the light that arrives at it, and its surface ray would find it
 * with density `pdf`, 0 where there is none. */
static inline void take_light(sf_batch *b, uint32_t i, const float value[3], float pdf, float z) {
    float weight = sf_power_weight(b->light_pdf[i], pdf), sum = 0;
    start_ray(b, i, z);
    for (int c = 0; c < 3; ++c) {
        b->to_light[c][i] += b->point[c][i] - b->origin[c][i];
        sum += b->contribution[c][i] *= value[c] * weight;
    }
    b->alive[i] = (b->alive[i] != 0) & (sum > 0);
}

/* The direction to the light of vertex i. */
static inline void look_at_light(const sf_batch *b, uint32_t i, const vertex *v, float local[3]) {
    const float to[3] = {b->direction[0][i], b->direction[1][i], b->direction[2][i]};
    to_local(v, to, local);
}

static inline void respond_diffuse(sf_batch *b, uint32_t i, bool weigh) {
    float cosine = 0;
    for (int c = 0; c < 3; ++c) cosine += b->direction[c][i] * b->normal[c][i];
    float value = cosine > 0 ? cosine * (1.0f / SF_PI_F) : 0.0f;
    const float values[3] = {value, value, value};
    take_light(b, i, values, weigh ? value : 0.0f, 1);
}

static inline void respond_conductor(sf_batch *b, const sf_scene *scene, uint32_t i, bool weigh) {
    vertex v = vertex_at(b, i);
    float to[3], h[3], alpha = column(b, scene, SF_MESH_ALPHA, i), values[3];
    look_at_light(b, i, &v, to);
    sf_halfway(v.w, to, h);
    float value = sf_ggx_reflection_value(v.w, to, h, alpha);
    reflectance(b, scene, i, sf_dot3(v.w, h), values);
    for (int c = 0; c < 3; ++c) values[c] = value > 0 ? values[c] * value : 0.0f;
    take_light(b, i, values, weigh ? sf_ggx_reflection_pdf(v.w, h, alpha) : 0.0f, to[2]);
}

static inline void respond_dielectric(sf_batch *b, const sf_scene *scene, uint32_t i, bool weigh) {
    vertex v = vertex_at(b, i);
    float to[3], h[3], pdf, alpha = column(b, scene, SF_MESH_ALPHA, i), eta = eta_at(b, scene, i), values[3];
    look_at_light(b, i, &v, to);
    sf_rough_dielectric_normal(v.w, to, eta, h);
    float value = sf_rough_dielectric_value(v.w, to, h, eta, alpha, &pdf);
    for (int c = 0; c < 3; ++c) {
        float tint = to[2] < 0 ? column(b, scene, (sf_mesh_column)(SF_MESH_ALBEDO_R + c), i) : 1.0f;
        values[c] = value > 0 ? tint * value : 0.0f;
    }
    take_light(b, i, values, weigh ? pdf : 0.0f, to[2]);
}

/* Of fog, whose normal is against the direction of travel, from which the phase function counts. */
static inline void turn_around(const float local[3], float travel[3]) {
    travel[0] = local[0];
    travel[1] = local[1];
    travel[2] = -local[2];
}

static inline void respond_fog(sf_batch *b, const sf_scene *scene, uint32_t i, bool weigh) {
    vertex v = vertex_at(b, i);
    float to[3], travel[3];
    look_at_light(b, i, &v, to);
    turn_around(to, travel);
    float value = sf_henyey_greenstein_pdf(travel, scene->fog.g);
    const float values[3] = {value, value, value};
    take_light(b, i, values, weigh ? value : 0.0f, 1);
}

/* The vertices i that scatter in one way. */
#define FOR_EACH(b, scatter, i)                        \
    for (uint32_t k_ = (b)->scatter_first[scatter], i; \
         k_ < (b)->scatter_first[(scatter) + 1] && (i = (b)->by_scatter[k_], true); ++k_)

static void respond(sf_batch *b, const sf_scene *scene, bool diffuse_goes_on) {
    bool weigh = sf_plan_has(&scene->plan, SF_STAGE_WEIGHT);
    FOR_EACH(b, SF_SCATTER_DIFFUSE, i) respond_diffuse(b, i, weigh && diffuse_goes_on);
    FOR_EACH(b, SF_SCATTER_MIRROR, i) b->alive[i] = 0;
    FOR_EACH(b, SF_SCATTER_SMOOTH_CONDUCTOR, i) b->alive[i] = 0;
    FOR_EACH(b, SF_SCATTER_SMOOTH_DIELECTRIC, i) b->alive[i] = 0;
    FOR_EACH(b, SF_SCATTER_ROUGH_CONDUCTOR, i) respond_conductor(b, scene, i, weigh);
    FOR_EACH(b, SF_SCATTER_ROUGH_DIELECTRIC, i) respond_dielectric(b, scene, i, weigh);
    FOR_EACH(b, SF_SCATTER_FOG, i) respond_fog(b, scene, i, weigh);
}

/* ---- surface rays ---- */

/* What a smooth surface sends on is found by nothing else: as if its density were infinite, the
 * power heuristic leaves it the whole of the light that it hits. */
static inline void leave_smooth(sf_batch *b, uint32_t i, const vertex *v, const float local[3], const float factor[3]) {
    leave(b, i, v, local, factor, INFINITY);
}

static inline void mirror(sf_batch *b, uint32_t i) {
    vertex v = vertex_at(b, i);
    const float local[3] = {-v.w[0], -v.w[1], v.w[2]}, whole[3] = {1, 1, 1};
    leave_smooth(b, i, &v, local, whole);
}

static inline void smooth_conductor(sf_batch *b, const sf_scene *scene, uint32_t i) {
    vertex v = vertex_at(b, i);
    const float local[3] = {-v.w[0], -v.w[1], v.w[2]};
    float factor[3];
    reflectance(b, scene, i, v.w[2], factor);
    leave_smooth(b, i, &v, local, factor);
}

static inline void smooth_dielectric(sf_batch *b, const sf_scene *scene, uint32_t i, float choice) {
    vertex v = vertex_at(b, i);
    const float up[3] = {0, 0, 1};
    float eta = eta_at(b, scene, i), local[3], factor[3];
    bool reflects = choice < sf_fresnel_dielectric(v.w[2], eta);
    sf_refract(v.w, up, eta, local);
    if (reflects) sf_reflect(v.w, up, local);
    float grows = 1 / (eta * eta);
    for (int c = 0; c < 3; ++c)
        factor[c] = reflects ? 1.0f : grows * column(b, scene, (sf_mesh_column)(SF_MESH_ALBEDO_R + c), i);
    leave_smooth(b, i, &v, local, factor);
}

static inline void rough_conductor(sf_batch *b, const sf_scene *scene, uint32_t i, float s, float t) {
    vertex v = vertex_at(b, i);
    float h[3], local[3], factor[3], alpha = column(b, scene, SF_MESH_ALPHA, i);
    sf_ggx_visible_normals_sample(s, t, v.w, alpha, alpha, h);
    sf_reflect(v.w, h, local);
    float weight = sf_ggx_reflection_weight(v.w, local, alpha);
    reflectance(b, scene, i, sf_dot3(v.w, h), factor);
    for (int c = 0; c < 3; ++c) factor[c] *= weight;
    leave(b, i, &v, local, factor, sf_ggx_reflection_pdf(v.w, h, alpha));
}

static inline void rough_dielectric(sf_batch *b, const sf_scene *scene, uint32_t i, float s, float t, float choice) {
    vertex v = vertex_at(b, i);
    float local[3], factor[3], pdf, alpha = column(b, scene, SF_MESH_ALPHA, i), eta = eta_at(b, scene, i);
    float weight = sf_rough_dielectric_sample(s, t, choice, v.w, eta, alpha, local, &pdf);
    for (int c = 0; c < 3; ++c)
        factor[c] = local[2] < 0 ? weight * column(b, scene, (sf_mesh_column)(SF_MESH_ALBEDO_R + c), i) : weight;
    leave(b, i, &v, local, factor, pdf);
}

static inline void fog(sf_batch *b, const sf_scene *scene, uint32_t i, float s, float t) {
    vertex v = vertex_at(b, i);
    const float whole[3] = {1, 1, 1};
    float travel[3], local[3];
    sf_henyey_greenstein_sample(s, t, scene->fog.g, travel);
    turn_around(travel, local);
    leave(b, i, &v, local, whole, sf_henyey_greenstein_pdf(travel, scene->fog.g));
}

static void scatter(sf_batch *b, const sf_scene *scene, uint32_t count) {
    float (*u)[SF_PATHS] = sf_sample_dimensions_by_ray(b, count, 3);
    FOR_EACH(b, SF_SCATTER_DIFFUSE, i) b->alive[i] = 1;
    FOR_EACH(b, SF_SCATTER_MIRROR, i) mirror(b, i);
    FOR_EACH(b, SF_SCATTER_SMOOTH_CONDUCTOR, i) smooth_conductor(b, scene, i);
    FOR_EACH(b, SF_SCATTER_SMOOTH_DIELECTRIC, i) smooth_dielectric(b, scene, i, u[2][i]);
    FOR_EACH(b, SF_SCATTER_ROUGH_CONDUCTOR, i) rough_conductor(b, scene, i, u[0][i], u[1][i]);
    FOR_EACH(b, SF_SCATTER_ROUGH_DIELECTRIC, i) rough_dielectric(b, scene, i, u[0][i], u[1][i], u[2][i]);
    FOR_EACH(b, SF_SCATTER_FOG, i) fog(b, scene, i, u[0][i], u[1][i]);
}

static void end_diffuse(sf_batch *b, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) b->alive[i] = 1;
    FOR_EACH(b, SF_SCATTER_DIFFUSE, i) b->alive[i] = 0;
}

const sf_material_kernels SF_AT_ISA(sf_material_kernels) = {keep, compact, sort, respond, end_diffuse, scatter};
