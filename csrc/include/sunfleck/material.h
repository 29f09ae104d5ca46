// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* material: how surfaces scatter light.
 *
 * Directions are of unit length in the surface's own frame, whose z is the normal, on the side of
 * the direction w: w[2] > 0. w is where the path comes from (to the camera), v where it goes on (to
 * the light); v[2] < 0 is through the surface. `eta` is the index of refraction beyond the surface
 * over that on w's side. Densities are per solid angle. A `_value` is the scattering function times
 * |v[2]|, of radiance: what goes through carries the factor 1 / eta^2 by which radiance grows in
 * the denser medium, so that it is not symmetric in w and v, but value(w, v) / |v[2]| * eta^2 is.
 */
#ifndef SUNFLECK_MATERIAL_H
#define SUNFLECK_MATERIAL_H

#include "sunfleck/mapping.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

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
SF_API sf_material sf_material_default(void);

/* Refuses a value out of its range, as adding a mesh does; NULL is allowed for `error`. */
SF_API sf_status sf_material_check(const sf_material *material, sf_error *error);

/* "diffuse", "mirror", …; NULL beyond the last. */
SF_API const char *sf_material_kind_name(sf_material_kind kind);

/* ---- Fresnel ---- */

/* The share of unpolarized light that a smooth border reflects, in [0, 1]; `cosine` of the angle
 * of incidence, >= 0. 1 where nothing passes (total internal reflection). Exact: Born & Wolf,
 * "Principles of Optics", section 1.5.2, for two media that do not absorb. */
SF_INLINE float sf_fresnel_dielectric(float cosine, float eta) {
    float passed = 1.0f - (1.0f - cosine * cosine) / (eta * eta), beyond = sqrtf(passed > 0.0f ? passed : 0.0f);
    float across = (cosine - eta * beyond) / (cosine + eta * beyond);
    float along = (eta * cosine - beyond) / (eta * cosine + beyond);
    return passed > 0.0f ? 0.5f * (across * across + along * along) : 1.0f;
}
/* That of a metal which reflects `at_normal` of what falls on it straight: Schlick 1994, "An
 * Inexpensive BRDF Model for Physically-based Rendering", eq. 15. */
SF_INLINE float sf_fresnel_schlick(float at_normal, float cosine) {
    float c = 1.0f - (cosine < 1.0f ? cosine : 1.0f), square = c * c;
    return at_normal + (1.0f - at_normal) * (square * square * c);
}

/* w mirrored about h. */
SF_INLINE void sf_reflect(const float w[3], const float h[3], float v[3]) {
    float twice = 2.0f * sf_dot3(w, h);
    for (int k = 0; k < 3; ++k) v[k] = twice * h[k] - w[k];
}
/* w refracted at a border of normal h, w.h >= 0 (Snell's law). Where nothing passes, v runs along
 * the border. */
SF_INLINE void sf_refract(const float w[3], const float h[3], float eta, float v[3]) {
    float cosine = sf_dot3(w, h), over = 1.0f / eta;
    float passed = 1.0f - (1.0f - cosine * cosine) * (over * over);
    float along = cosine * over - sqrtf(passed > 0.0f ? passed : 0.0f);
    for (int k = 0; k < 3; ++k) v[k] = along * h[k] - over * w[k];
}

/* ---- reflection by a GGX microsurface, to be multiplied with Fresnel's share at w.h ---- */

/* h of w and v, halfway. */
SF_INLINE void sf_halfway(const float w[3], const float v[3], float h[3]) {
    float x = w[0] + v[0], y = w[1] + v[1], z = w[2] + v[2], scale = 1.0f / sqrtf(x * x + y * y + z * z);
    h[0] = scale * x;
    h[1] = scale * y;
    h[2] = scale * z;
}
/* normals(h) masking_shadowing(w, v) / (4 w_z): Walter et al. 2007, "Microfacet Models for
 * Refraction through Rough Surfaces", eq. 20, times v_z. 0 where v is below. */
SF_INLINE float sf_ggx_reflection_value(const float w[3], const float v[3], const float h[3], float alpha) {
    float value = 0.25f * sf_ggx_normals(h, alpha, alpha) * sf_ggx_masking_shadowing(w, v, alpha, alpha) / w[2];
    return v[2] > 0.0f ? value : 0.0f;
}
/* visible_normals_pdf(h) / (4 w.h), as it cancels; also where v is below, which is sampled too and
 * carries nothing. */
SF_INLINE float sf_ggx_reflection_pdf(const float w[3], const float h[3], float alpha) {
    return 0.5f * sf_ggx_normals(h, alpha, alpha) / (w[2] + sf_ggx_stretch(w, alpha, alpha));
}
/* value / pdf of a sample: masking_shadowing(w, v) / masking(w); 0 where v is below. */
SF_INLINE float sf_ggx_reflection_weight(const float w[3], const float v[3], float alpha) {
    float weight = sf_ggx_masking_shadowing(w, v, alpha, alpha) / sf_ggx_masking(w, alpha, alpha);
    return v[2] > 0.0f ? weight : 0.0f;
}

/* ---- a rough dielectric: reflection and refraction at a GGX microsurface; Walter et al. 2007 ---- */

/* h at which w goes on as v, on w's side: halfway, or where v is beyond, along w + eta v (eq. 16,
 * turned). eta not 1. */
SF_INLINE void sf_rough_dielectric_normal(const float w[3], const float v[3], float eta, float h[3]) {
    float scale = v[2] > 0.0f ? 1.0f : eta;
    float x = w[0] + scale * v[0], y = w[1] + scale * v[1], z = w[2] + scale * v[2];
    float length = 1.0f / sqrtf(x * x + y * y + z * z), turn = z < 0.0f ? -length : length;
    h[0] = turn * x;
    h[1] = turn * y;
    h[2] = turn * z;
}
/* |dh / dv| of a refraction: eta^2 |v.h| / (w.h + eta v.h)^2 (eq. 17). */
SF_INLINE float sf_refraction_jacobian(float w_h, float v_h, float eta) {
    float sum = w_h + eta * v_h;
    return eta * eta * fabsf(v_h) / (sum * sum);
}
/* Value and density of v at once, with h of sf_rough_dielectric_normal: eq. 20 and 21 times |v_z|,
 * the latter of radiance; masking of w and v are taken as independent in refraction, where they
 * face apart (Heitz 2014, section 5.3, gives a product that is smaller still). */
SF_INLINE float sf_rough_dielectric_value(const float w[3], const float v[3], const float h[3], float eta, float alpha,
                                          float *pdf) {
    float w_h = sf_dot3(w, h), v_h = sf_dot3(v, h), fresnel = sf_fresnel_dielectric(w_h > 0.0f ? w_h : 0.0f, eta);
    const float beyond[3] = {v[0], v[1], -v[2]};
    float jacobian = sf_refraction_jacobian(w_h, v_h, eta), seen = sf_ggx_visible_normals_pdf(h, w, alpha, alpha);
    float reflected = fresnel * sf_ggx_reflection_value(w, v, h, alpha);
    float through = (1.0f - fresnel) * jacobian * seen * sf_ggx_masking(beyond, alpha, alpha) / (eta * eta);
    int reflects = (v[2] > 0.0f) & (w_h > 0.0f) & (v_h > 0.0f), passes = (v[2] < 0.0f) & (w_h > 0.0f) & (v_h < 0.0f);
    float density = reflects ? fresnel * sf_ggx_reflection_pdf(w, h, alpha) : 0.0f;
    *pdf = passes ? (1.0f - fresnel) * jacobian * seen : density;
    return passes ? through : reflects ? reflected : 0.0f;
}
/* A direction from (s, t), and `choice` between reflection and refraction by Fresnel's share.
 * Returns value / pdf; 0 where v came out on the wrong side. */
SF_INLINE float sf_rough_dielectric_sample(float s, float t, float choice, const float w[3], float eta, float alpha,
                                           float v[3], float *pdf) {
    float h[3], mirrored[3], refracted[3];
    sf_ggx_visible_normals_sample(s, t, w, alpha, alpha, h);
    float w_h = sf_dot3(w, h), fresnel = sf_fresnel_dielectric(w_h > 0.0f ? w_h : 0.0f, eta);
    sf_reflect(w, h, mirrored);
    sf_refract(w, h, eta, refracted);
    int reflects = choice < fresnel;
    for (int k = 0; k < 3; ++k) v[k] = reflects ? mirrored[k] : refracted[k];
    const float beyond[3] = {v[0], v[1], -v[2]};
    float jacobian = sf_refraction_jacobian(w_h, sf_dot3(v, h), eta);
    float density = (1.0f - fresnel) * jacobian * sf_ggx_visible_normals_pdf(h, w, alpha, alpha);
    *pdf = reflects ? fresnel * sf_ggx_reflection_pdf(w, h, alpha) : density;
    float passed = sf_ggx_masking(beyond, alpha, alpha) / (eta * eta);
    return reflects ? sf_ggx_reflection_weight(w, v, alpha) : passed;
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
