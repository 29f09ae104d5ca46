// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* mapping, the directions: sphere, hemisphere, cosine hemisphere, cone, and the frame that turns
 * them to a normal. Included by mapping.h, whose comment holds what the triples have in common. */
#ifndef SUNFLECK_MAPPING_SPHERE_H
#define SUNFLECK_MAPPING_SPHERE_H

#include "sunfleck/mapping_plane.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* The pole is +z; of formulas with the pole +y, (x, y, z) are our (x, z, y). Lengths are 1 within
 * 2 ulp. Every pdf is per solid angle; a direction given to pdf or invert has length 1. */

/* The direction of height z and distance `ring` from the axis, at s turns from +x. */
SF_INLINE void sf_direction(float s, float ring, float z, float w[3]) {
    float sine, cosine;
    sf_sincos_2pi(s, &sine, &cosine);
    w[0] = ring * cosine;
    w[1] = ring * sine;
    w[2] = z;
}

/* Uniform over the sphere: z = 1 - 2t, ring 2 sqrt(t (1 - t)). pdf: 1 / (4 pi). */
SF_INLINE void sf_sphere_sample(float s, float t, float w[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_direction(s, 2.0f * sqrtf(t * (1.0f - t)), 1.0f - 2.0f * t, w);
}
SF_INLINE float sf_sphere_pdf(const float w[3]) {
    (void)w;
    return 0.25f / SF_PI_F;
}
SF_INLINE void sf_sphere_invert(const float w[3], float u[2]) {
    /* t = (1 - z) / 2; above the equator as x^2 + y^2 = 4t (1 - t), which does not cancel. */
    float square = w[0] * w[0] + w[1] * w[1], z = fabsf(w[2]), near = 0.5f * square / (1.0f + z);
    u[0] = sf_angle_2pi(w[1], w[0]);
    u[1] = sf_unit_clamp(w[2] > 0.0f ? near : 1.0f - near);
}

/* Uniform over the hemisphere z >= 0: z = t. pdf: 1 / (2 pi). */
SF_INLINE void sf_hemisphere_sample(float s, float t, float w[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_direction(s, sqrtf((1.0f - t) * (1.0f + t)), t, w);
}
SF_INLINE float sf_hemisphere_pdf(const float w[3]) { return w[2] >= 0.0f ? 0.5f / SF_PI_F : 0.0f; }
SF_INLINE void sf_hemisphere_invert(const float w[3], float u[2]) {
    u[0] = sf_angle_2pi(w[1], w[0]);
    u[1] = sf_unit_clamp(w[2]);
}

/* Cosine-weighted hemisphere: z = sqrt(t). pdf: z / pi, 0 on the horizon (t = 0). */
SF_INLINE void sf_cosine_hemisphere_sample(float s, float t, float w[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_direction(s, sqrtf(1.0f - t), sqrtf(t), w);
}
SF_INLINE float sf_cosine_hemisphere_pdf(const float w[3]) { return w[2] > 0.0f ? w[2] * (1.0f / SF_PI_F) : 0.0f; }
SF_INLINE void sf_cosine_hemisphere_invert(const float w[3], float u[2]) {
    u[0] = sf_angle_2pi(w[1], w[0]);
    u[1] = sf_unit_clamp(w[2] > 0.0f ? w[2] * w[2] : 0.0f);
}

/* The same density over the concentric disk, projected up: strata keep their shape. pdf: z / pi,
 * 0 on the horizon (s = 0 or t = 0). */
SF_INLINE void sf_cosine_hemisphere_concentric_sample(float s, float t, float w[3]) {
    sf_disk_concentric_sample(s, t, w);
    /* What the disk's radius lacks of 1 is twice the distance to the square's nearest side: exact. */
    float ds = s < 0.5f ? s : 1.0f - s, dt = t < 0.5f ? t : 1.0f - t, rest = 2.0f * (ds < dt ? ds : dt);
    w[2] = sqrtf(rest * (2.0f - rest));
}
SF_INLINE float sf_cosine_hemisphere_concentric_pdf(const float w[3]) { return sf_cosine_hemisphere_pdf(w); }
SF_INLINE void sf_cosine_hemisphere_concentric_invert(const float w[3], float u[2]) { sf_disk_concentric_invert(w, u); }

/* ---- cone: the directions within an angle of the pole ---- */

/* How far the cone's cap reaches down from the pole, 1 - cos(angle), angle 0 .. pi (radians):
 * within 4 ulp for the smallest too, where 1 - cos has lost all digits. */
SF_INLINE float sf_cone_height(float angle) {
    float sine, cosine;
    sf_sincos_2pi(angle * (0.25f / SF_PI_F), &sine, &cosine);
    return 2.0f * (sine * sine);
}
/* The height of the cone that a sphere fills, seen from a point at that distance from its centre,
 * at least `radius`. */
SF_INLINE float sf_cone_height_of_sphere(float radius, float distance) {
    float sine = radius / distance;
    return sine * sine / (1.0f + sqrtf((1.0f - sine) * (1.0f + sine)));
}
/* Uniform over the cap of that height: 1 - z = t height. For a renderer's loop, which finds the
 * height once. */
SF_INLINE void sf_cone_cap_sample(float s, float t, float height, float w[3]) {
    float depth = t * height;
    sf_direction(s, sqrtf(depth * (2.0f - depth)), 1.0f - depth, w);
}
/* 1 - z of a direction; near the pole from x and y, which have kept the digits. */
SF_INLINE float sf_depth(const float w[3]) {
    float square = w[0] * w[0] + w[1] * w[1];
    return w[2] > 0.0f ? square / (1.0f + w[2]) : 1.0f - w[2];
}

/* angle: half of the cone's opening, 0 .. pi. 0 is the pole alone, pi the whole sphere. */
SF_INLINE void sf_cone_sample(float s, float t, float angle, float w[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(angle >= 0.0f && angle <= 3.1415928f);
    sf_cone_cap_sample(s, t, sf_cone_height(angle), w);
}
/* pdf: 1 / (2 pi height); infinity if the angle is below 2^-63, whose square vanishes; 0 beyond
 * 8 ulp outside. */
SF_INLINE float sf_cone_pdf(const float w[3], float angle) {
    float height = sf_cone_height(angle);
    return sf_depth(w) <= height * (1.0f + 0x1p-20f) ? 0.5f / (SF_PI_F * height) : 0.0f;
}
SF_INLINE void sf_cone_invert(const float w[3], float angle, float u[2]) {
    float height = sf_cone_height(angle);
    u[0] = sf_angle_2pi(w[1], w[0]);
    u[1] = sf_unit_clamp(sf_depth(w) / (height > 0.0f ? height : 1.0f));
}

/* ---- frame ---- */

/* Two directions that make a right-handed orthonormal frame with the unit normal n, so that
 * x tangent + y bitangent + z n turns the pole to n. Duff et al. 2017, "Building an Orthonormal
 * Basis, Revisited", without branches; orthonormal within 4 ulp everywhere, at both poles and
 * beside them. */
SF_INLINE void sf_frame_from_normal(const float n[3], float tangent[3], float bitangent[3]) {
    float sign = copysignf(1.0f, n[2]), a = -1.0f / (sign + n[2]), b = n[0] * n[1] * a;
    tangent[0] = 1.0f + sign * (n[0] * n[0] * a);
    tangent[1] = sign * b;
    tangent[2] = -sign * n[0];
    bitangent[0] = b;
    bitangent[1] = sign + n[1] * n[1] * a;
    bitangent[2] = -n[1];
}

/* x tangent + y bitangent + z normal. */
SF_INLINE void sf_frame_to_world(const float tangent[3], const float bitangent[3], const float normal[3],
                                 const float local[3], float world[3]) {
    for (int k = 0; k < 3; ++k) world[k] = (local[0] * tangent[k] + local[1] * bitangent[k]) + local[2] * normal[k];
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
