// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a scene holds inside: the tables that shading reads, the lights, the plan. */
#ifndef SUNFLECK_SCENE_INTERNAL_H
#define SUNFLECK_SCENE_INTERNAL_H

#include <stdbool.h>

#include "scene/embree.h"
#include "sunfleck/discrete.h"
#include "sunfleck/scene.h"

/* Per-mesh values by Embree's geometry number, as columns. The row at `mesh_count` is
 * all zero and stands for a miss, so that shading needs no branch; with fog one more stands for it. */
typedef enum sf_mesh_column {
    SF_MESH_ALBEDO_R,
    SF_MESH_ALBEDO_G,
    SF_MESH_ALBEDO_B,
    SF_MESH_EMISSION_R,
    SF_MESH_EMISSION_G,
    SF_MESH_EMISSION_B,
    SF_MESH_LIGHT_PDF, /* density, by area, with which light sampling finds a point of the mesh */
    SF_MESH_PASS_R,    /* what every path takes along from the surface: the albedo of diffuse surfaces and */
    SF_MESH_PASS_G,    /* mirrors, 1 where it depends on directions */
    SF_MESH_PASS_B,
    SF_MESH_SCATTER, /* sf_scatter, as a float */
    SF_MESH_IOR,
    SF_MESH_ALPHA, /* GGX's */
    SF_MESH_LIFT,  /* the least that hits are moved off the surface; see rays.h */
    SF_MESH_COLUMNS
} sf_mesh_column;

/* The ways of scattering that vertices are sorted by. */
typedef enum sf_scatter {
    SF_SCATTER_DIFFUSE,
    SF_SCATTER_MIRROR,
    SF_SCATTER_SMOOTH_CONDUCTOR,
    SF_SCATTER_SMOOTH_DIELECTRIC,
    SF_SCATTER_ROUGH_CONDUCTOR,
    SF_SCATTER_ROUGH_DIELECTRIC,
    SF_SCATTER_FOG,
    SF_SCATTERS
} sf_scatter;

typedef struct sf_mesh_table {
    float *columns[SF_MESH_COLUMNS];
    uint32_t miss; /* the row of a miss */
} sf_mesh_table;

/* What light is sampled from. The last three are not kinds of a piece but ways to sample one. */
typedef enum sf_light_kind {
    SF_LIGHT_IS_TRIANGLE,
    SF_LIGHT_IS_PARALLELOGRAM,
    SF_LIGHT_IS_DISK,
    SF_LIGHT_IS_SPHERE,
    SF_LIGHT_IS_SUN,
    SF_LIGHT_IS_DIRECTION, /* a sun of angle 0 */
    SF_LIGHT_IS_ENVIRONMENT,
    SF_LIGHT_BY_AREA, /* of the first three */
    SF_LIGHT_BY_TRIANGLE_ANGLE,
    SF_LIGHT_BY_RECTANGLE_ANGLE,
    SF_LIGHT_KINDS
} sf_light_kind;

/* What is known of a piece that light is sampled from: a triangle, or a parallelogram
 * origin + s edge1 + t edge2 with unit normal along edge1 x edge2; of a disk, the middle and two
 * radii; of a sphere, the middle and, as edge1, radius 0 0; of a sun, its direction and frame. */
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
    SF_LIGHT_LIFT,                    /* the least that points on it are moved off it; see rays.h */
    SF_LIGHT_SAMPLED,                 /* how many fields a sample needs: those above */
    SF_LIGHT_KEEP = SF_LIGHT_SAMPLED, /* alias table: probability to keep the piece drawn */
    /* What SF_STAGE_LIGHT_SHAPES needs beyond these. */
    SF_LIGHT_KIND,
    SF_LIGHT_AREA,     /* 1 for those that have none: then the density is the probability of the piece */
    SF_LIGHT_HEIGHT,   /* of a sun's cone */
    SF_LIGHT_MIDDLE_X, /* of a triangle or rectangle; */
    SF_LIGHT_MIDDLE_Y,
    SF_LIGHT_MIDDLE_Z,
    SF_LIGHT_NEAR, /* the square of the distance from it within which it is sampled by solid angle */
    SF_LIGHT_DRAWN,
    SF_LIGHT_FIELDS = 32 /* two cache lines a piece, whichever of many is drawn */
} sf_light_field;

typedef struct sf_light_table {
    size_t count;
    size_t rectangle_count;
    float (*pieces)[SF_LIGHT_FIELDS];
    uint32_t *alias; /* alias table: the other piece of each column */
    bool special;    /* some are sampled otherwise than by area of triangles and parallelograms */
    /* Over the pieces that are not of the sky, or NULL; see light_choice.c. Then SF_LIGHT_PDF of those is
     * without the probability that the tree gives, and the alias table is over those of the sky alone. */
    struct sf_light_tree *tree;
    size_t sky_first;  /* pieces from here on are of the sky */
    float scene_share; /* of the samples, which the others have */
    /* With SF_STAGE_LIGHT_SHAPES, the piece of a hit: of_primitive[first_of_mesh[mesh] + primitive],
     * for meshes that emit. */
    uint32_t *of_primitive;
    size_t *first_of_mesh;
} sf_light_table;

/* The light from where rays miss. */
typedef struct sf_sky_sun {
    float direction[3], height; /* of the cone; 0 for one that no ray sees */
    float radiance[3];
    float pdf; /* density by solid angle over all lights together */
} sf_sky_sun;

typedef struct sf_sky {
    sf_sky_sun *suns;
    size_t sun_count;
    sf_environment environment;     /* pixels NULL: none */
    float front[3], left[3], up[3]; /* its frame: longitude 0, 90 degrees, the top */
    double *edges;                  /* cosines from the top, of its rows' edges: height + 1 */
    sf_piecewise *table;            /* draws a pixel in proportion to what comes from it */
    double total;                   /* R + G + B over all solid angles */
    double spread; /* the share of all directions that it comes from: (integral)^2 / (4 pi x that of squares) */
    float pdf;     /* the probability of the environment among the lights, over total */
    float far;     /* farther than any two points of the scene */
} sf_sky;

/* What a sphere or disk is, by geometry number: middle, radius, normal, kind. */
typedef enum sf_quadric_kind { SF_NO_QUADRIC, SF_QUADRIC_SPHERE, SF_QUADRIC_DISK } sf_quadric_kind;
typedef struct sf_quadric {
    float centre[3], radius, normal[3];
    uint32_t kind; /* sf_quadric_kind */
} sf_quadric;

/* Where a mesh of a prototype is placed: its vertex v is at linear v + translation - the scene's shift. */
typedef struct sf_instance_transform {
    bool placed;                /* if not, the rest is 0 */
    uint32_t prototype, member; /* whose mesh it is; Embree's instance has the number of member 0 */
    float linear[9];            /* by rows */
    double translation[3];
} sf_instance_transform;

/* A mesh as the scene keeps it. */
typedef struct sf_scene_mesh {
    sf_mesh mesh;       /* its arrays are the caller's, or the copies below */
    float *vertex_copy; /* NULL where Embree reads the caller's */
    uint32_t *index_copy;
    sf_quadric quadric;          /* where it is no mesh, but a sphere or disk: `mesh` has no arrays then */
    float longest;               /* edge of its triangles, by its largest coordinate */
    sf_instance_transform place; /* where it is placed: `mesh` has the prototype's arrays then */
} sf_scene_mesh;

/* Meshes that are placed together. Those that emit are not in Embree's scene of them, but copied for
 * each placement: each of their triangles is a light of its own anyway. */
typedef struct sf_prototype {
    RTCScene embree;
    sf_scene_mesh *meshes; /* the dark ones first: those that do not emit */
    uint32_t mesh_count, dark_count;
    float offset[3];         /* what was subtracted from the vertices of the dark; see scene_recenter.c */
    sf_scene_info dark, lit; /* bounds, counts and hash, before that */
} sf_prototype;

struct sf_scene {
    RTCDevice device;
    RTCScene embree;
    bool committed;
    sf_scene_mesh *meshes;
    size_t mesh_capacity;
    sf_camera camera;
    float background[3];
    uint32_t max_bounces;
    bool robust;
    float back;         /* 1 where robust, else 0: of the lift, how far a hit is moved back along its ray */
    float shift[3];     /* what was subtracted from all coordinates; see scene_recenter.c */
    size_t moved_count; /* meshes that it was subtracted from */
    bool few;           /* so few primitives that rays are sorted for their packets */
    float middle[3];    /* of the bounds, as rays see them */
    float normal_scale; /* brings Embree's normals, of the length of areas, to the order of 1 */
    sf_scene_info info;
    sf_mesh_table mesh_table;
    sf_light_table lights;
    sf_light_sampling light_sampling;
    sf_light_choice light_choice;
    float solid_angle_ratio;
    sf_sun *suns;
    sf_environment environment;
    sf_fog fog;
    sf_sky sky;
    sf_quadric *quadrics; /* by geometry number, and the row of a miss; NULL without spheres and disks */
    sf_prototype *prototypes;
    size_t prototype_count, prototype_capacity;
    size_t prototype_mesh_count, placed_count; /* meshes of all prototypes; rows that are placements of them */
    float (*turns)[9]; /* by row: brings Embree's normals to the scene and the order of 1; NULL without instances */
    sf_plan plan;
};

/* Cuts the emissive meshes into pieces and builds the table to draw them from, with suns and the
 * environment, each with a probability in proportion to its power; fills the meshes'
 * SF_MESH_LIGHT_PDF. After sf_sky_build. */
sf_status sf_lights_build(sf_scene *scene, sf_error *error);
void sf_lights_free(sf_light_table *lights);

/* light_table.c: a piece among the lights, whose geometry is known, before the probabilities are. */
typedef struct sf_light_source {
    float radiance[3]; /* that its weight is made of */
    double area;       /* or 1 */
    double power;      /* area x (R + G + B), or what is like it */
    bool sky;
    uint32_t mesh; /* where it is not of the sky */
} sf_light_source;
/* Gives each piece its probability and weight. Where there are lights in the scene and in the sky,
 * each kind has half of the samples. */
sf_status sf_light_table_fill(sf_scene *scene, const sf_light_source *sources, sf_error *error);

/* light_choice.c: builds the tree where the scene's choice calls for one. */
sf_status sf_lights_grow_tree(sf_scene *scene, const sf_light_source *sources, sf_error *error);

/* light_proximity.c: whether a surface that reflects lies so near to a light that it is sampled by solid
 * angle: in front of one of the 16 largest of those that can be. */
bool sf_lights_near(const sf_scene *scene);

/* sky.c: the suns and the environment of a scene whose bounds are known. */
sf_status sf_sky_build(sf_scene *scene, sf_error *error);
void sf_sky_free(sf_sky *sky);

static inline bool sf_emits(const sf_mesh *mesh) {
    return mesh->emission[0] > 0 || mesh->emission[1] > 0 || mesh->emission[2] > 0;
}
static inline bool sf_reflects(const sf_mesh *mesh) {
    return mesh->albedo[0] > 0 || mesh->albedo[1] > 0 || mesh->albedo[2] > 0 ||
           mesh->material.kind == SF_MATERIAL_DIELECTRIC || mesh->material.kind == SF_MATERIAL_CONDUCTOR;
}

/* Whether it has surfaces that are not diffuse. */
static inline bool sf_scene_scatters(const sf_scene *scene) {
    for (size_t i = 0; i < scene->info.mesh_count; ++i)
        if (scene->meshes[i].mesh.material.kind != SF_MATERIAL_DIFFUSE) return true;
    return false;
}

/* fog.c */
static inline bool sf_foggy(const sf_scene *scene) { return scene->fog.scattering + scene->fog.absorption > 0; }
sf_status sf_fog_check(const sf_scene *scene, sf_error *error);
void sf_fog_tabulate(const sf_scene *scene, sf_mesh_table *table);

/* scene_recenter.c: moves a scene that lies far from the origin there. */
sf_status sf_scene_recenter(sf_scene *scene, sf_error *error);
/* Whether things of these bounds lie far from the origin, and what to subtract from them then. */
bool sf_scene_far_shift(const sf_scene_info *info, float shift[3]);
/* Subtracts it from the vertices, of which the mesh has a copy then. */
sf_status sf_mesh_move(sf_scene_mesh *kept, const float shift[3], sf_scene_info *info, sf_error *error);

/* instances.c, instance_transform.c */
static inline bool sf_has_instances(const sf_scene *scene) { return scene->info.instance_count > 0; }
void sf_instances_free(sf_scene *scene);
/* Embree's instances of a recentred scene, and the table of their normals. */
sf_status sf_instances_build(sf_scene *scene, sf_error *error);
/* Fills SF_MESH_LIFT of what is placed. */
void sf_instances_tabulate(const sf_scene *scene, sf_mesh_table *table);
/* The determinant and the cofactors (by rows) of a transform's linear part. */
double sf_cofactors(const float linear[9], double out[9]);
/* The product of the Frobenius norms of the linear part and its inverse: 3 of a rotation, infinite if singular. */
double sf_condition(const float linear[9]);
/* Where a mesh's vertex lies in the scene. */
void sf_instance_vertex(const sf_scene *scene, const sf_scene_mesh *shape, const float *vertex, double out[3]);
/* The box about the placed box that is given; about a rotated mesh it is larger than need be. */
void sf_instance_box(const sf_instance_transform *place, const float lower[3], const float upper[3], double low[3],
                     double high[3]);

/* A triangle whose edges have coordinates of at most `longest` is intersected with an error, along its
 * normal, of some 2^-21 of them: Embree computes the distance of its plane from a corner. Measured on
 * tilted triangles 1,000 to 10^6 times as long as the ray: 2^-20 leaves no self-intersection. */
#define SF_LIFT_OF_EDGES 0x1p-20f

/* material.c: how a surface of the material scatters. */
sf_scatter sf_scatter_of(const sf_material *material);
/* Fills what the table's row has of the material. */
void sf_material_tabulate(sf_mesh_table *table, size_t row, const sf_mesh *mesh);
/* Takes what decides the picture into the hash: nothing of a diffuse material. */
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
