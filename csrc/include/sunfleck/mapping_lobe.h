// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* mapping, the lobes by which surfaces and fog scatter: power of the cosine, Henyey-Greenstein,
 * the visible normals of a GGX microsurface. Included by mapping.h, whose comment holds what the
 * triples have in common; directions and densities are as in mapping_sphere.h. */
#ifndef SUNFLECK_MAPPING_LOBE_H
#define SUNFLECK_MAPPING_LOBE_H

#include "sunfleck/mapping_sphere.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* ---- power of the cosine: z^exponent about +z, exponent 0 .. 1e6 ---- */

/* log z, z > 0; near the pole from x and y, which have kept the digits. */
SF_INLINE float sf_log_cosine(const float w[3]) {
    float square = w[0] * w[0] + w[1] * w[1];
    float wide = sf_log(w[2] > 0x1p-126f ? w[2] : 0x1p-126f), narrow = 0.5f * sf_log1m(square < 0.5f ? square : 0.5f);
    return square < 0.5f ? narrow : wide;
}
/* z = (1 - t)^(1 / (exponent + 1)): never 0, since 1 - t is not. exponent = 0 is the uniform
 * hemisphere, 1 the cosine's, both with t turned around. */
SF_INLINE void sf_power_cosine_sample(float s, float t, float exponent, float w[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(exponent >= 0.0f && exponent <= 1e6f);
    float log_z = sf_log1m(t) / (exponent + 1.0f);
    sf_direction(s, sqrtf(-sf_expm1(2.0f * log_z)), sf_exp(log_z), w);
}
/* pdf: (exponent + 1) z^exponent / (2 pi); 0 below and on the horizon. The power is held above
 * 1.6e-38, so that the tail stays positive. */
SF_INLINE float sf_power_cosine_pdf(const float w[3], float exponent) {
    float above = w[2] > 0.0f ? 0.5f / SF_PI_F : 0.0f;
    return above * (exponent + 1.0f) * sf_exp(exponent * sf_log_cosine(w));
}
SF_INLINE void sf_power_cosine_invert(const float w[3], float exponent, float u[2]) {
    u[0] = sf_angle_2pi(w[1], w[0]);
    u[1] = sf_unit_clamp(-sf_expm1((exponent + 1.0f) * sf_log_cosine(w)));
}

/* ---- Henyey & Greenstein 1941: the phase function of fog, about the direction of travel +z ---- */

/* g, the mean cosine, -0.9999 .. 0.9999: positive scatters forwards, 0 is the uniform sphere. The
 * published inverse divides by g; with d = 1 + g - 2 g t it is
 *
 *     1 - z = 2 (1 - g)^2 t (1 + g (1 - t)) / d^2,   1 + z = 2 (1 + g)^2 (1 - t) (1 - g t) / d^2,
 *
 * which has no pole at 0 and does not cancel at either end. */
SF_INLINE void sf_henyey_greenstein_sample(float s, float t, float g, float w[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(g >= -0.9999f && g <= 0.9999f);
    float rest = 1.0f - t, size = fabsf(g), d = (1.0f - size) + 2.0f * size * (g > 0.0f ? rest : t), over = 1.0f / d;
    float below = ((1.0f - g) * over) * ((1.0f - g) * over) * (2.0f * t * (1.0f + g * rest));
    float above = ((1.0f + g) * over) * ((1.0f + g) * over) * (2.0f * rest * (1.0f - g * t));
    float depth = below < above ? below : above, z = 1.0f - depth;
    sf_direction(s, sqrtf(depth * (2.0f - depth)), below < above ? z : -z, w);
}
/* 1 - |cosine to the lobe's axis|, which is +z or, for negative g, -z; and |1 + g^2 - 2 g z|,
 * whose root is the distance that the formulas are made of. */
SF_INLINE float sf_henyey_greenstein_square(const float w[3], float g, float *depth) {
    const float turned[3] = {w[0], w[1], g < 0.0f ? -w[2] : w[2]};
    float size = fabsf(g);
    *depth = sf_depth(turned);
    return (1.0f - size) * (1.0f - size) + 2.0f * size * *depth;
}
/* pdf: (1 - g^2) / (4 pi (1 + g^2 - 2 g z)^(3/2)), never 0. */
SF_INLINE float sf_henyey_greenstein_pdf(const float w[3], float g) {
    float depth, square = sf_henyey_greenstein_square(w, g, &depth);
    return (1.0f - g) * (1.0f + g) * (0.25f / SF_PI_F) / (square * sqrtf(square));
}
SF_INLINE void sf_henyey_greenstein_invert(const float w[3], float g, float u[2]) {
    float depth, root = sqrtf(sf_henyey_greenstein_square(w, g, &depth)), size = fabsf(g);
    float t = (1.0f + size) * depth / (root * (root + (1.0f - size)));
    u[0] = sf_angle_2pi(w[1], w[0]);
    u[1] = sf_unit_clamp(g < 0.0f ? 1.0f - t : t);
}

/* ---- GGX: Walter et al. 2007, with roughness alpha_x, alpha_y, each 1e-4 .. 10 ---- */

/* The density of the microsurface's normals h, per solid angle and unit of surface: its integral
 * times h_z is 1. Trowbridge & Reitz 1975. */
SF_INLINE float sf_ggx_normals(const float h[3], float alpha_x, float alpha_y) {
    float x = h[0] / alpha_x, y = h[1] / alpha_y, k = x * x + y * y + h[2] * h[2];
    return h[2] > 0.0f ? 1.0f / (SF_PI_F * alpha_x * alpha_y * (k * k)) : 0.0f;
}
/* The length of (alpha_x x, alpha_y y, z). */
SF_INLINE float sf_ggx_stretch(const float w[3], float alpha_x, float alpha_y) {
    float x = alpha_x * w[0], y = alpha_y * w[1];
    return sqrtf(x * x + y * y + w[2] * w[2]);
}
/* Smith's masking, the share of the microsurface that faces w and is seen from it:
 * 2 z / (z + stretch), in [0,1]; Heitz 2014, "Understanding the Masking-Shadowing Function". */
SF_INLINE float sf_ggx_masking(const float w[3], float alpha_x, float alpha_y) {
    float z = w[2] > 0.0f ? w[2] : 0.0f;
    return z > 0.0f ? 2.0f * z / (z + sf_ggx_stretch(w, alpha_x, alpha_y)) : 0.0f;
}
/* Masking of w and shadowing of v together, height-correlated (Heitz 2014, eq. 99). */
SF_INLINE float sf_ggx_masking_shadowing(const float w[3], const float v[3], float alpha_x, float alpha_y) {
    float a = v[2] * sf_ggx_stretch(w, alpha_x, alpha_y), b = w[2] * sf_ggx_stretch(v, alpha_x, alpha_y);
    return ((w[2] > 0.0f) & (v[2] > 0.0f)) ? 2.0f * w[2] * v[2] / (a + b) : 0.0f;
}

/* A normal among those that are seen from the unit direction w, w_z >= 0. Dupuy & Benyoub 2023,
 * "Sampling Visible GGX Normals with Spherical Caps": in the space where the roughness is 1, the
 * normal is halfway between w and a direction that is uniform over a cap. The paper's cap reaches
 * down to -w_z; its height over that, (1 - t)(1 + w_z), is used as it is, so that the sum cannot
 * vanish. h is known to 2^-22 / (w.h), w.h between the stretched ones. */
SF_INLINE void sf_ggx_visible_normals_sample(float s, float t, const float w[3], float alpha_x, float alpha_y,
                                             float h[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(alpha_x >= 1e-4f && alpha_x <= 10.0f && alpha_y >= 1e-4f && alpha_y <= 10.0f);
    float over = 1.0f / sf_ggx_stretch(w, alpha_x, alpha_y), z = over * w[2], cap[3];
    float height = 1.0f + z;
    sf_cone_cap_sample(s, t, height, cap);
    h[0] = alpha_x * (cap[0] + over * alpha_x * w[0]);
    h[1] = alpha_y * (cap[1] + over * alpha_y * w[1]);
    h[2] = (1.0f - t) * height;
    float scale = 1.0f / sqrtf((h[0] * h[0] + h[1] * h[1]) + h[2] * h[2]);
    for (int k = 0; k < 3; ++k) h[k] *= scale;
}
/* pdf: masking(w) max(0, w.h) normals(h) / w_z, which is 2 (w.h) normals(h) / (w_z + stretch):
 * finite at w_z = 0 as well. 0 where h does not face w, and on that border. */
SF_INLINE float sf_ggx_visible_normals_pdf(const float h[3], const float w[3], float alpha_x, float alpha_y) {
    float facing = sf_dot3(w, h);
    float over = 2.0f / (w[2] + sf_ggx_stretch(w, alpha_x, alpha_y));
    return facing > 0.0f ? facing * over * sf_ggx_normals(h, alpha_x, alpha_y) : 0.0f;
}
SF_INLINE void sf_ggx_visible_normals_invert(const float h[3], const float w[3], float alpha_x, float alpha_y,
                                             float u[2]) {
    float over = 1.0f / sf_ggx_stretch(w, alpha_x, alpha_y);
    const float from[3] = {over * alpha_x * w[0], over * alpha_y * w[1], over * w[2]};
    const float half[3] = {h[0] / alpha_x, h[1] / alpha_y, h[2]};
    /* Mirror w about the normal; the cap's depth is the rest of its height. */
    float square = sf_dot3(half, half), scale = 2.0f * sf_dot3(from, half) / (square > 0.0f ? square : 1.0f);
    float height = 1.0f + from[2];
    u[0] = sf_angle_2pi(scale * half[1] - from[1], scale * half[0] - from[0]);
    u[1] = sf_unit_clamp(1.0f - scale * half[2] / (height > 0.0f ? height : 1.0f));
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
