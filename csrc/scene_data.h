// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a scene holds inside: the tables that shading reads, the lights, the plan. */
#ifndef SUNFLECK_SCENE_DATA_H
#define SUNFLECK_SCENE_DATA_H

#include <stdbool.h>

#include "embree.h"
#include "sunfleck/scene.h"

/* Per-mesh values by Embree's geometry number, as columns. The last row, at `mesh_count`, is
 * all zero and stands for a miss, so that shading needs no branch. */
typedef enum sf_mesh_column {
    SF_MESH_ALBEDO_R,
    SF_MESH_ALBEDO_G,
    SF_MESH_ALBEDO_B,
    SF_MESH_EMISSION_R,
    SF_MESH_EMISSION_G,
    SF_MESH_EMISSION_B,
    SF_MESH_LIGHT_PDF, /* density, by area, with which light sampling finds a point of the mesh */
    SF_MESH_COLUMNS
} sf_mesh_column;

typedef struct sf_mesh_table {
    float *columns[SF_MESH_COLUMNS];
    uint32_t miss; /* the row of a miss */
} sf_mesh_table;

/* What is known of a piece that light is sampled from: a triangle, or a parallelogram
 * origin + s edge1 + t edge2 with unit normal along edge1 x edge2. */
typedef enum sf_light_field {
    SF_LIGHT_ORIGIN_X,
    SF_LIGHT_ORIGIN_Y,
    SF_LIGHT_ORIGIN_Z,
    SF_LIGHT_EDGE1_X,
    SF_LIGHT_EDGE1_Y,
    SF_LIGHT_EDGE1_Z,
    SF_LIGHT_EDGE2_X,
    SF_LIGHT_EDGE2_Y,
    SF_LIGHT_EDGE2_Z,
    SF_LIGHT_NORMAL_X,
    SF_LIGHT_NORMAL_Y,
    SF_LIGHT_NORMAL_Z,
    SF_LIGHT_WEIGHT_R, /* radiance / (density by area), with the 1/pi of a diffuse surface */
    SF_LIGHT_WEIGHT_G,
    SF_LIGHT_WEIGHT_B,
    SF_LIGHT_PDF,                     /* density by area over all the lights together */
    SF_LIGHT_RECTANGLE,               /* 1 for a parallelogram, 0 for a triangle */
    SF_LIGHT_SAMPLED,                 /* how many fields a sample needs: those above */
    SF_LIGHT_KEEP = SF_LIGHT_SAMPLED, /* alias table: probability to keep the piece drawn */
    SF_LIGHT_FIELDS = 32              /* two cache lines a piece, whichever of many is drawn */
} sf_light_field;

typedef struct sf_light_table {
    size_t count;
    size_t rectangle_count;
    float (*pieces)[SF_LIGHT_FIELDS];
    uint32_t *alias; /* alias table: the other piece of each column */
} sf_light_table;

/* A mesh as the scene keeps it. */
typedef struct sf_scene_mesh {
    sf_mesh mesh;       /* its arrays are the caller's, or the copies below */
    float *vertex_copy; /* NULL where Embree reads the caller's */
    uint32_t *index_copy;
} sf_scene_mesh;

struct sf_scene {
    RTCDevice device;
    RTCScene embree;
    bool committed;
    sf_scene_mesh *meshes;
    size_t mesh_capacity;
    sf_camera camera;
    float background[3];
    uint32_t max_bounces;
    float normal_scale; /* brings Embree's normals, of the length of areas, to the order of 1 */
    sf_scene_info info;
    sf_mesh_table mesh_table;
    sf_light_table lights;
    sf_plan plan;
};

/* Cuts the emissive meshes into pieces and builds the table to draw them from, each with a
 * probability in proportion to area x (R + G + B); fills the meshes' SF_MESH_LIGHT_PDF. */
sf_status sf_lights_build(sf_scene *scene, sf_error *error);
void sf_lights_free(sf_light_table *lights);

/* material.c: takes what decides the picture into the hash: nothing of a diffuse material. */
uint64_t sf_material_hash(uint64_t hash, const sf_material *material);

/* The plan of a scene whose meshes, lights, camera and background are known. */
void sf_plan_derive(const sf_scene *scene, sf_plan *plan);
static inline bool sf_plan_has(const sf_plan *plan, sf_stage stage) { return plan->stages >> stage & 1u; }

/* Twice the area of a triangle as a vector along its normal, (b - a) x (c - a), in double. */
static inline void sf_triangle_cross(const float *a, const float *b, const float *c, double out[3]) {
    double u[3] = {(double)b[0] - a[0], (double)b[1] - a[1], (double)b[2] - a[2]};
    double v[3] = {(double)c[0] - a[0], (double)c[1] - a[1], (double)c[2] - a[2]};
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

#endif
