// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* material: how surfaces scatter light. */
#ifndef SUNFLECK_MATERIAL_H
#define SUNFLECK_MATERIAL_H

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a surface does with the albedo that its mesh has. */
typedef enum sf_material_kind {
    SF_MATERIAL_DIFFUSE = 0, /* reflects it evenly, on both sides */
    SF_MATERIAL_MIRROR,      /* reflects it in the mirror direction, on both sides, at every angle */
    SF_MATERIAL_DIELECTRIC,  /* glass, water: reflects by Fresnel's equations, untinted, and refracts the
                                rest times albedo at each crossing; the side that the geometric normal
                                points to is the outside */
    SF_MATERIAL_CONDUCTOR    /* metal: albedo is its reflectance at normal incidence, which rises to 1 at
                                grazing angles (Schlick 1994), on both sides */
} sf_material_kind;

typedef struct sf_material {
    sf_material_kind kind;
    float ior;       /* dielectric: index of refraction inside over outside, 0.1 .. 10; default 1.5 */
    float roughness; /* dielectric, conductor: 0 smooth .. 1; default 0. The square root of GGX's alpha, which
                        looks even from end to end, as in glTF; below 0.01 the surface is smooth */
} sf_material;

/* Diffuse. */
sf_material sf_material_default(void);

/* Refuses a value out of its range, as adding a mesh does; NULL is allowed for `error`. */
sf_status sf_material_check(const sf_material *material, sf_error *error);

/* "diffuse", "mirror", …; NULL beyond the last. */
const char *sf_material_kind_name(sf_material_kind kind);

#ifdef __cplusplus
}
#endif
#endif
