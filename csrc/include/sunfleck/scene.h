// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* scene: triangle meshes over the caller's arrays, spheres and disks, lights, a camera, a
 * background, and the plan of what rendering them needs.
 *
 * A scene is built by one thread (create, add meshes, set camera and background, commit) and is
 * immutable once committed: any number of threads may then render it. Lengths are in scene
 * units, radiance is linear RGB, scene-referred.
 */
#ifndef SUNFLECK_SCENE_H
#define SUNFLECK_SCENE_H

#include "sunfleck/base.h"
#include "sunfleck/material.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sf_scene sf_scene;

/* A triangle mesh with one material, one reflectance and one emission.
 *
 * The arrays stay the caller's: they must neither change nor go before the scene is destroyed.
 * Embree reads them in place. It may read 4 bytes past the last vertex; where those could lie
 * on another memory page (1 array in 1,000), the scene makes one copy instead, as of the vertices of
 * a scene farther from the origin than 4 times its size, which is traced near it;
 * sf_scene_info.copied_bytes says how much. */
typedef struct sf_mesh {
    const float *vertices;     /* vertex_count * 3, finite, |coordinate| <= 1e12 */
    size_t vertex_count;       /* 3 .. 2^32 - 1 */
    const uint32_t *triangles; /* triangle_count * 3, each < vertex_count */
    size_t triangle_count;     /* 1 .. 2^32 - 1 */
    float albedo[3];           /* reflectance, each in [0, 1]; default 0.5; what it means, the material says */
    float emission[3];         /* radiance, each in [0, 1e18]; default 0; only the side that
                                  (v1 - v0) x (v2 - v0) points to emits */
    sf_material material;      /* default diffuse, which reflects on both sides */
} sf_mesh;

/* A mesh without arrays, diffuse, albedo 0.5, no emission. */
SF_API sf_mesh sf_mesh_default(void);

/* A sphere, exactly. It reflects on both sides and emits outwards: from inside it shows no light. */
typedef struct sf_sphere {
    float centre[3]; /* finite, |coordinate| <= 1e12 */
    float radius;    /* 1e-15 .. 1e12; default 1 */
    float albedo[3]; /* as a mesh's */
    float emission[3];
    sf_material material;
} sf_sphere;

/* A flat disk, exactly. It reflects on both sides and emits on the side of its normal. */
typedef struct sf_disk {
    float centre[3];
    float normal[3]; /* of any length but 0; default (0, 0, 1) */
    float radius;    /* 1e-15 .. 1e12; default 1 */
    float albedo[3];
    float emission[3];
    sf_material material;
} sf_disk;

/* Of radius 1 about the origin, diffuse, albedo 0.5, no emission. */
SF_API sf_sphere sf_sphere_default(void);
SF_API sf_disk sf_disk_default(void);

/* A light at infinity: the same radiance from all directions within an angle of one. */
typedef struct sf_sun {
    float direction[3];   /* from the scene to the sun's middle, of any length but 0; default (0, 1, 0) */
    float angular_radius; /* degrees: 0, or 0.01 .. 89; default 0.265, our sun's. With 0 it has one direction:
                             only light sampling finds it, and no ray sees it */
    float irradiance[3];  /* of a surface that faces it, each in [0, 1e18]: pi sin^2(angular_radius) times
                             its radiance; default 1 */
} sf_sun;
SF_API sf_sun sf_sun_default(void);

/* Radiance from all around, by direction, in addition to the background: a picture in latitude and
 * longitude as OpenEXR lays it out. Row 0 is at the top, where `up` points; column 0 at longitude
 * +180 degrees, falling to -180 degrees in the last. Longitude 0, the picture's middle, is +z, and
 * +90 degrees is up x longitude 0 (+x for the default up). Where up is not at a right angle to +z,
 * longitude 0 is the direction nearest to +z that is; where up is +z or -z, it is +x. Every pixel is
 * a patch of constant radiance.
 *
 * The array stays the caller's: it must neither change nor go before the scene is destroyed. */
typedef struct sf_environment {
    const float *pixels;    /* height * width * 3, each in [0, 1e18], one at least above 0 */
    uint32_t width, height; /* 1 .. 2^16 each */
    float up[3];            /* of any length but 0; default (0, 1, 0) */
    float rotation;         /* degrees, finite: turns it about up, counter-clockwise seen from above; default 0 */
} sf_environment;
SF_API sf_environment sf_environment_default(void);

/* Homogeneous fog, which fills all space, solids too. It takes exp(-(scattering + absorption) distance)
 * of light from a ray's path and scatters its part in other directions, by Henyey and Greenstein's
 * phase function. The same for all colours. A vertex in it counts as a bounce. */
typedef struct sf_fog {
    float scattering; /* per unit of length, 0 .. 1e12; default 0 */
    float absorption; /* the same */
    float g;          /* the mean cosine of scattering, -0.99 .. 0.99: 0 is isotropic (default), positive forwards */
} sf_fog;
SF_API sf_fog sf_fog_default(void); /* none */
#define SF_FOG_LIMIT 1e12f

/* How light that can be sampled is found. All three have the same mean; for tests and study. */
typedef enum sf_light_sampling {
    SF_LIGHT_SAMPLING_BOTH = 0, /* by light and by surface sampling, weighted; the default */
    SF_LIGHT_SAMPLING_LIGHT,    /* by light sampling alone */
    SF_LIGHT_SAMPLING_SURFACE   /* by surface sampling alone, which a sun of angle 0 escapes */
} sf_light_sampling;
SF_API const char *sf_light_sampling_name(sf_light_sampling sampling); /* "both", …; NULL beyond the last */

/* How one light of several is chosen for a vertex. All have the same mean. Meshes count by their
 * triangles, but that two which form a parallelogram are one piece; suns and the environment have half
 * of the samples where there are other lights, whatever the choice among those. */
typedef enum sf_light_choice {
    SF_LIGHT_CHOICE_AUTO = 0, /* the tree where it pays: from 8 pieces on; the default */
    SF_LIGHT_CHOICE_POWER,    /* in proportion to what each sends out; in constant time */
    SF_LIGHT_CHOICE_TREE      /* by a bound of what each may send to the vertex, from a tree over them; time grows
                                 as their logarithm. With fewer than 2 pieces there is nothing to choose, and no tree.
                                 Conty Estevez & Kulla 2018 */
} sf_light_choice;
SF_API const char *sf_light_choice_name(sf_light_choice choice); /* "auto", "power", "tree"; NULL beyond the last */

/* A pinhole camera, or a thin lens where aperture_radius > 0. Row 0 of the image is the top,
 * image right is forward x up. */
typedef struct sf_camera {
    float position[3];
    float target[3];       /* not the position */
    float up[3];           /* not along the line of sight; default (0, 1, 0) */
    float vertical_fov;    /* degrees, in (0, 180); default 40 */
    float aperture_radius; /* >= 0, scene units; default 0, a pinhole */
    float focus_distance;  /* along the axis to the focal plane, > 0; default 0, through the target */
} sf_camera;

/* At (0, 0, 1), looking at the origin. */
SF_API sf_camera sf_camera_default(void);

#define SF_MAX_BOUNCES 64

/* Creates an empty scene: black background, 5 bounces, the default camera.
 * Returns SF_STATUS_BACKEND where Embree refuses a device. */
SF_API sf_status sf_scene_create(sf_scene **scene, sf_error *error);

/* Frees the scene; NULL is allowed. Not while it is being rendered. */
SF_API void sf_scene_destroy(sf_scene *scene);

/* Adds a mesh, after checking every value of it (one pass). Zero-area triangles are counted and
 * left out of the lights; an emissive mesh of nothing else is refused. */
SF_API sf_status sf_scene_add_mesh(sf_scene *scene, const sf_mesh *mesh, sf_error *error);

/* As a mesh, whose number in messages they share. */
SF_API sf_status sf_scene_add_sphere(sf_scene *scene, const sf_sphere *sphere, sf_error *error);
SF_API sf_status sf_scene_add_disk(sf_scene *scene, const sf_disk *disk, sf_error *error);

/* Keeps meshes to be placed together, as often as wanted, by sf_scene_add_instances; `prototype` becomes
 * their number. Each is checked as by sf_scene_add_mesh, and its arrays are kept in the same way. They are
 * no part of the picture until they are placed. */
SF_API sf_status sf_scene_add_prototype(sf_scene *scene, const sf_mesh *meshes, size_t mesh_count, uint32_t *prototype,
                                        sf_error *error);

/* Placements of a prototype. */
typedef struct sf_instances {
    const float *transforms; /* count * 12: each 3 rows of 4. A point x of the prototype is at
                                row[0] x + row[1] y + row[2] z + row[3], by rows: rotation, any scale, mirror,
                                shear. Values finite and at most 1e12 in size; determinant of the 3 x 3 part
                                1e-36 .. 1e36 in size; condition number at most some 10^5 */
    size_t count;            /* 1 .. */
    const float *albedos;    /* count * 3, each in [0, 1], of all meshes of each; NULL: as the meshes have it */
} sf_instances;

/* Whether the values are allowed, as adding them would say; one pass. */
SF_API sf_status sf_instances_check(const sf_instances *instances, sf_error *error);

/* Places the prototype's meshes. Both arrays are read here and not kept. Nothing is added where the
 * transforms are refused, or take the prototype beyond 1e12.
 *
 * Meshes that do not emit are held once, in Embree too; a placement takes some 0.7 KB. Each mesh that
 * emits is copied for each placement, since each of its triangles is a light of its own. The side that
 * emits (and is a dielectric's outside) goes where the transform takes it: a mirror does not turn it. */
SF_API sf_status sf_scene_add_instances(sf_scene *scene, uint32_t prototype, const sf_instances *instances,
                                        sf_error *error);

/* Adds a sun; there may be 64. */
SF_API sf_status sf_scene_add_sun(sf_scene *scene, const sf_sun *sun, sf_error *error);

/* NULL takes it away. One pass over the pixels. */
SF_API sf_status sf_scene_set_environment(sf_scene *scene, const sf_environment *environment, sf_error *error);

SF_API sf_status sf_scene_set_light_sampling(sf_scene *scene, sf_light_sampling sampling, sf_error *error);

/* A tree takes 100 bytes a piece, and when the scene is committed O(pieces log pieces) time. */
SF_API sf_status sf_scene_set_light_choice(sf_scene *scene, sf_light_choice choice, sf_error *error);

/* NULL takes it away; so does a fog of 0. A scene that has both fog and a background, suns or an
 * environment is refused when it is committed: nothing of them would come through. */
SF_API sf_status sf_scene_set_fog(sf_scene *scene, const sf_fog *fog, sf_error *error);

/* Triangle and rectangle lights are sampled by solid angle from points nearer to their middle than
 * `ratio` of their diagonals, and by area from all others. 0 .. infinity; default 1; 0 is always by
 * area. A scene none of whose 16 largest lights has a surface so near has no such stage. */
SF_API sf_status sf_scene_set_solid_angle_ratio(sf_scene *scene, float ratio, sf_error *error);

/* Not 0: no ray passes between triangles that share an edge. Embree intersects by its watertight test
 * (Woop, Benthin, Wald 2013), and hits are moved back along their rays as well as off the surface.
 * Default 0: of rays within a closed box about 1 in 10^7 escapes, and more where triangles are smaller;
 * the price of robust is in docs/scene.md. */
SF_API sf_status sf_scene_set_robust(sf_scene *scene, int robust, sf_error *error);

SF_API sf_status sf_scene_set_camera(sf_scene *scene, const sf_camera *camera, sf_error *error);

/* radiance: each in [0, 1e18]. */
SF_API sf_status sf_scene_set_background(sf_scene *scene, const float radiance[3], sf_error *error);

/* max_bounces: 0 (emission seen directly), 1 (direct light), … SF_MAX_BOUNCES. */
SF_API sf_status sf_scene_set_max_bounces(sf_scene *scene, uint32_t max_bounces, sf_error *error);

/* Builds the acceleration structure, the lights and the plan. Refuses an empty scene. A scene
 * is committed once; after that every setter is refused. */
SF_API sf_status sf_scene_commit(sf_scene *scene, sf_error *error);

/* What a committed scene holds. */
typedef struct sf_scene_info {
    size_t mesh_count; /* those of prototypes once */
    size_t sphere_count;
    size_t disk_count;
    size_t sun_count;
    size_t instance_count;        /* placements of prototypes */
    size_t triangle_count;        /* that rays can meet: those of instances as often as they are placed */
    size_t unique_triangle_count; /* that are held: those of prototypes once, but for placed lights */
    size_t light_count;           /* pieces that light is sampled from: triangles, rectangles, spheres, disks,
                                     suns, the environment */
    size_t rectangle_light_count; /* of these, pairs of triangles sampled as one parallelogram */
    size_t degenerate_count;      /* zero-area triangles */
    size_t copied_bytes;          /* of arrays that could not be read in place */
    float bounds_lower[3];        /* of instances, about their transformed boxes */
    float bounds_upper[3];
    uint64_t hash; /* of every value that decides the picture: equal scenes have equal hashes */
} sf_scene_info;

/* NULL is allowed for `error`; the scene must be committed. */
SF_API sf_status sf_scene_get_info(const sf_scene *scene, sf_scene_info *info, sf_error *error);

/* One use of sample dimensions by a stage: `count` coordinates of each path. */
typedef enum sf_dimension_use {
    SF_DIMENSION_PIXEL = 0, /* 2: position in the pixel */
    SF_DIMENSION_LENS,      /* 2: position on the lens */
    SF_DIMENSION_LIGHT,     /* 2: point on the light, for the vertex `bounce` */
    SF_DIMENSION_CHOICE,    /* 1: which light, for the vertex `bounce` */
    SF_DIMENSION_SURFACE,   /* 2: direction off the surface, at the vertex `bounce` */
    SF_DIMENSION_LOBE,      /* 1: reflection or refraction, at the vertex `bounce` */
    SF_DIMENSION_FOG        /* 1: how far the ray from the vertex `bounce` goes in fog; 0: the camera's */
} sf_dimension_use;

typedef struct sf_plan_dimensions {
    sf_dimension_use use;
    uint32_t bounce; /* 1 = the first surface hit; 0 for pixel and lens */
    uint32_t first;  /* the first of its dimensions among the path's */
    uint32_t count;
} sf_plan_dimensions;

/* The stages a path may pass through, in order. A stage that is not in the plan is not run. */
typedef enum sf_stage {
    SF_STAGE_CAMERA = 0,   /* camera rays: pinhole */
    SF_STAGE_LENS,         /* camera rays: thin lens, instead of the pinhole's */
    SF_STAGE_INTERSECT,    /* nearest hits of camera rays */
    SF_STAGE_INSTANCES,    /* which mesh of which instance was hit, and normals from there to the scene */
    SF_STAGE_QUADRIC,      /* points and normals of spheres and disks */
    SF_STAGE_FOG,          /* how far rays go in fog; what it leaves of sampled light */
    SF_STAGE_MISS,         /* background radiance for rays that hit nothing */
    SF_STAGE_SKY,          /* radiance of suns and the environment for rays that hit nothing */
    SF_STAGE_EMISSION,     /* radiance of emissive surfaces that rays hit */
    SF_STAGE_CHOOSE_LIGHT, /* one light of several */
    SF_STAGE_LIGHT,        /* shadow rays to points on lights */
    SF_STAGE_LIGHT_SHAPES, /* light sampled otherwise than by area of triangles and parallelograms: by solid
                              angle, from spheres, disks, suns, the environment */
    SF_STAGE_LIGHT_TREE,   /* the light chosen by a tree over them; see sf_light_choice */
    SF_STAGE_SCATTER,      /* mirrors, dielectrics, conductors: from them surface-sampled rays start at the
                              last bounce too */
    SF_STAGE_SURFACE,      /* surface-sampled rays between vertices */
    SF_STAGE_LAST_SURFACE, /* surface-sampled rays at the last bounce, for the background,
                              for an environment whose light comes from more than 1/32 of
                              all directions, or where no light is sampled */
    SF_STAGE_WEIGHT,       /* multiple importance sampling between light and surface rays */
    SF_STAGE_COUNT
} sf_stage;

/* "camera", "lens", … ; never NULL. */
SF_API const char *sf_stage_name(sf_stage stage);
SF_API const char *sf_dimension_use_name(sf_dimension_use use);

#define SF_PLAN_MAX_GROUPS (3 + 5 * SF_MAX_BOUNCES)

/* What a scene turned out to need, and what the renderer runs: nothing else. */
typedef struct sf_plan {
    uint32_t stages; /* bit (1 << sf_stage) of each stage that runs */
    uint32_t max_bounces;
    uint32_t dimensions_per_path; /* sum of `count` below */
    uint32_t dimension_group_count;
    sf_plan_dimensions dimensions[SF_PLAN_MAX_GROUPS];
    uint32_t camera_rays;  /* per path: 1 */
    uint32_t shadow_rays;  /* per path, at the most */
    uint32_t surface_rays; /* per path, at the most */
} sf_plan;

/* The plan of a committed scene. */
SF_API sf_status sf_scene_get_plan(const sf_scene *scene, sf_plan *plan, sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
