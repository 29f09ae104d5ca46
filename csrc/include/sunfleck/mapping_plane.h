// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* mapping, the flat shapes: triangle, parallelogram, disk, annulus, regular polygon. Included by
 * mapping.h, whose comment holds what the triples have in common. */
#ifndef SUNFLECK_MAPPING_PLANE_H
#define SUNFLECK_MAPPING_PLANE_H

#include "sunfleck/elementary.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* ---- triangle a, b, c in space ---- */

SF_INLINE void sf_cross3(const float a[3], const float b[3], float out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}
SF_INLINE float sf_dot3(const float a[3], const float b[3]) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }

/* The point a + alpha (b - a) + beta (c - a). */
SF_INLINE void sf_triangle_point(float alpha, float beta, const float a[3], const float b[3], const float c[3],
                                 float out[3]) {
    out[0] = a[0] + (alpha * (b[0] - a[0]) + beta * (c[0] - a[0]));
    out[1] = a[1] + (alpha * (b[1] - a[1]) + beta * (c[1] - a[1]));
    out[2] = a[2] + (alpha * (b[2] - a[2]) + beta * (c[2] - a[2]));
}

/* alpha and beta of the point of the triangle's plane nearest to x; 0, 0 if the area is 0. */
SF_INLINE void sf_triangle_coordinates(const float x[3], const float a[3], const float b[3], const float c[3],
                                       float *alpha, float *beta) {
    float e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    float d[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]}, n[3], df[3], ed[3];
    sf_cross3(e, f, n);
    sf_cross3(d, f, df);
    sf_cross3(e, d, ed);
    float square = sf_dot3(n, n), scale = square > 0.0f ? square : 1.0f;
    *alpha = sf_dot3(df, n) / scale;
    *beta = sf_dot3(ed, n) / scale;
}

/* By square root (Turk 1990, "Generating Random Points in Triangles"): alpha = t sqrt(s), beta = 1 - sqrt(s). Stretches
 * strata towards c. */
SF_INLINE void sf_triangle_sample(float s, float t, const float a[3], const float b[3], const float c[3],
                                  float out[3]) {
    SF_ASSERT_UNIT(s, t);
    float root = sqrtf(s);
    sf_triangle_point(root * t, 1.0f - root, a, b, c, out);
}
/* pdf per area: 1 / area, infinity if the area is 0. x is taken to lie on the triangle. */
SF_INLINE float sf_triangle_pdf(const float x[3], const float a[3], const float b[3], const float c[3]) {
    float e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]}, n[3];
    (void)x;
    sf_cross3(e, f, n);
    return 2.0f / sqrtf(sf_dot3(n, n));
}
/* t is lost at c itself, where all of them meet: 0 there. */
SF_INLINE void sf_triangle_invert(const float x[3], const float a[3], const float b[3], const float c[3], float u[2]) {
    float alpha, beta;
    sf_triangle_coordinates(x, a, b, c, &alpha, &beta);
    float root = 1.0f - beta;
    u[0] = sf_unit_clamp(root * root);
    u[1] = sf_unit_clamp(alpha / (root > 0.0f ? root : 1.0f));
}

/* Heitz 2019, "A Low-Distortion Map Between Triangle and Square": each half of the square
 * beside the diagonal s = t is sheared onto half of the triangle, and the diagonal becomes the
 * median from a. Continuous; strata stay compact and none is drawn out to a vertex. */
SF_INLINE void sf_triangle_low_distortion_sample(float s, float t, const float a[3], const float b[3], const float c[3],
                                                 float out[3]) {
    SF_ASSERT_UNIT(s, t);
    float alpha = t > s ? 0.5f * s : s - 0.5f * t, beta = t > s ? t - 0.5f * s : 0.5f * t;
    sf_triangle_point(alpha, beta, a, b, c, out);
}
SF_INLINE float sf_triangle_low_distortion_pdf(const float x[3], const float a[3], const float b[3], const float c[3]) {
    return sf_triangle_pdf(x, a, b, c);
}
SF_INLINE void sf_triangle_low_distortion_invert(const float x[3], const float a[3], const float b[3], const float c[3],
                                                 float u[2]) {
    float alpha, beta;
    sf_triangle_coordinates(x, a, b, c, &alpha, &beta);
    u[0] = sf_unit_clamp(beta > alpha ? 2.0f * alpha : alpha + beta);
    u[1] = sf_unit_clamp(beta > alpha ? alpha + beta : 2.0f * beta);
}

/* ---- parallelogram: a, and the corners b and c beside it ---- */

/* The point a + s (b - a) + t (c - a). */
SF_INLINE void sf_parallelogram_sample(float s, float t, const float a[3], const float b[3], const float c[3],
                                       float out[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_triangle_point(s, t, a, b, c, out);
}
/* pdf per area: 1 / area, infinity if the area is 0. x is taken to lie on it. */
SF_INLINE float sf_parallelogram_pdf(const float x[3], const float a[3], const float b[3], const float c[3]) {
    return 0.5f * sf_triangle_pdf(x, a, b, c);
}
SF_INLINE void sf_parallelogram_invert(const float x[3], const float a[3], const float b[3], const float c[3],
                                       float u[2]) {
    sf_triangle_coordinates(x, a, b, c, &u[0], &u[1]);
    u[0] = sf_unit_clamp(u[0]);
    u[1] = sf_unit_clamp(u[1]);
}

/* ---- disk: radius 1 about the origin ---- */

/* pdf per area of the uniform disk: 1 / pi. What lies within 4 ulp outside the rim still counts
 * as on it, since samples round. */
SF_INLINE float sf_disk_pdf(const float x[2]) {
    return x[0] * x[0] + x[1] * x[1] <= 1.0f + 0x1p-20f ? 1.0f / SF_PI_F : 0.0f;
}

/* By polar coordinates: radius sqrt(t), angle 2 pi s. */
SF_INLINE void sf_disk_polar_sample(float s, float t, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    float sine, cosine, radius = sqrtf(t);
    sf_sincos_2pi(s, &sine, &cosine);
    out[0] = radius * cosine;
    out[1] = radius * sine;
}
SF_INLINE float sf_disk_polar_pdf(const float x[2]) { return sf_disk_pdf(x); }
SF_INLINE void sf_disk_polar_invert(const float x[2], float u[2]) {
    u[0] = sf_angle_2pi(x[1], x[0]);
    u[1] = sf_unit_clamp(x[0] * x[0] + x[1] * x[1]);
}

/* Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square": concentric squares go to
 * concentric circles, so that strata keep their shape. Without branches: of a = 2s - 1 and
 * b = 2t - 1, the larger is the radius, and the ratio gives the angle from its axis, at most an
 * eighth of a turn. */
SF_INLINE void sf_disk_concentric_sample(float s, float t, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    float a = 2.0f * s - 1.0f, b = 2.0f * t - 1.0f, sine, cosine;
    int upright = fabsf(b) > fabsf(a);
    float radius = upright ? b : a, other = upright ? a : b;
    sf_sincos_2pi_octant(0.125f * (other / (radius != 0.0f ? radius : 1.0f)), &sine, &cosine);
    out[0] = radius * (upright ? sine : cosine);
    out[1] = radius * (upright ? cosine : sine);
}
SF_INLINE float sf_disk_concentric_pdf(const float x[2]) { return sf_disk_pdf(x); }
SF_INLINE void sf_disk_concentric_invert(const float x[2], float u[2]) {
    int upright = fabsf(x[1]) > fabsf(x[0]);
    float major = upright ? x[1] : x[0], minor = upright ? x[0] : x[1];
    float length = sqrtf(x[0] * x[0] + x[1] * x[1]), angle = sf_atan_turns(fabsf(minor), fabsf(major));
    float radius = copysignf(length, major), other = copysignf(length * (8.0f * angle), minor);
    u[0] = sf_unit_clamp(0.5f + 0.5f * (upright ? other : radius));
    u[1] = sf_unit_clamp(0.5f + 0.5f * (upright ? radius : other));
}

/* A common fault, kept for the laboratory: radius t, which piles samples
 * up at the centre. Its true pdf per area is 1 / (2 pi r), infinity at the centre. */
SF_INLINE void sf_disk_naive_sample(float s, float t, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    float sine, cosine;
    sf_sincos_2pi(s, &sine, &cosine);
    out[0] = t * cosine;
    out[1] = t * sine;
}
SF_INLINE float sf_disk_naive_pdf(const float x[2]) {
    float square = x[0] * x[0] + x[1] * x[1];
    return square <= 1.0f + 0x1p-20f ? 1.0f / (2.0f * SF_PI_F * sqrtf(square)) : 0.0f;
}
SF_INLINE void sf_disk_naive_invert(const float x[2], float u[2]) {
    u[0] = sf_angle_2pi(x[1], x[0]);
    u[1] = sf_unit_clamp(sqrtf(x[0] * x[0] + x[1] * x[1]));
}

/* ---- annulus: radii `inner` to 1 about the origin, 0 <= inner <= 1 ---- */

/* Radius sqrt(inner^2 + t (1 - inner^2)), angle 2 pi s: inner = 0 is the polar disk. inner = 1 is
 * the circle. */
SF_INLINE void sf_annulus_sample(float s, float t, float inner, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    assert(inner >= 0.0f && inner <= 1.0f);
    float sine, cosine, radius = sqrtf(inner * inner + t * ((1.0f - inner) * (1.0f + inner)));
    sf_sincos_2pi(s, &sine, &cosine);
    out[0] = radius * cosine;
    out[1] = radius * sine;
}
/* pdf per area: 1 / (pi (1 - inner^2)), infinity for the circle; 0 beyond 4 ulp off the rims. */
SF_INLINE float sf_annulus_pdf(const float x[2], float inner) {
    float square = x[0] * x[0] + x[1] * x[1], least = inner * inner;
    int within = (square <= 1.0f + 0x1p-20f) & (square >= least - 0x1p-20f * least);
    return within ? 1.0f / (SF_PI_F * ((1.0f - inner) * (1.0f + inner))) : 0.0f;
}
/* t is known to 2^-23 / (1 - inner^2). */
SF_INLINE void sf_annulus_invert(const float x[2], float inner, float u[2]) {
    float width = (1.0f - inner) * (1.0f + inner), square = x[0] * x[0] + x[1] * x[1];
    u[0] = sf_angle_2pi(x[1], x[0]);
    u[1] = sf_unit_clamp((square - inner * inner) / (width > 0.0f ? width : 1.0f));
}

/* ---- regular polygon: inscribed in the unit circle, its first vertex at (1, 0) ---- */

/* Sine and cosine of the middle of a blade, and of half its angle: a blade is the triangle of the
 * centre and a side. */
SF_INLINE void sf_polygon_blade(float blade, float sides, float middle[2], float half[2]) {
    sf_sincos_2pi((blade + 0.5f) / sides, &middle[0], &middle[1]);
    sf_sincos_2pi(0.5f / sides, &half[0], &half[1]);
}
/* `sides` is a whole number from 3 to 1024, as a lens with as many blades has: s chooses the
 * blade and the place along its side, sqrt(t) the distance from the centre. */
SF_INLINE void sf_regular_polygon_sample(float s, float t, float sides, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    assert(sides >= 3.0f && sides <= 1024.0f);
    float scaled = s * sides, blade = (float)(int32_t)scaled, middle[2], half[2], radius = sqrtf(t);
    blade = blade < sides - 1.0f ? blade : sides - 1.0f;
    sf_polygon_blade(blade, sides, middle, half);
    float across = (2.0f * (scaled - blade) - 1.0f) * half[0];
    out[0] = radius * (half[1] * middle[1] - across * middle[0]);
    out[1] = radius * (half[1] * middle[0] + across * middle[1]);
}
/* The blade of the point x, the distance from the centre towards the middle of its side, and
 * across. */
SF_INLINE float sf_polygon_find(const float x[2], float sides, float half[2], float *along, float *across) {
    float blade = (float)(int32_t)(sf_angle_2pi(x[1], x[0]) * sides), middle[2];
    blade = blade < sides - 1.0f ? blade : sides - 1.0f;
    sf_polygon_blade(blade, sides, middle, half);
    *along = x[0] * middle[1] + x[1] * middle[0];
    *across = x[1] * middle[1] - x[0] * middle[0];
    return blade;
}
/* pdf per area: 1 / area = 1 / (sides sin(pi / sides) cos(pi / sides)); 0 beyond 8 ulp outside. */
SF_INLINE float sf_regular_polygon_pdf(const float x[2], float sides) {
    float half[2], along, across;
    (void)sf_polygon_find(x, sides, half, &along, &across);
    return along <= half[1] * (1.0f + 0x1p-20f) ? 1.0f / (sides * (half[0] * half[1])) : 0.0f;
}
/* s is lost at the centre. */
SF_INLINE void sf_regular_polygon_invert(const float x[2], float sides, float u[2]) {
    float half[2], along, across, blade = sf_polygon_find(x, sides, half, &along, &across);
    float radius = along / half[1], width = radius * half[0];
    float place = sf_unit_clamp(0.5f + 0.5f * (across / (width > 0.0f ? width : 1.0f)));
    u[0] = sf_unit_clamp((blade + place) / sides);
    u[1] = sf_unit_clamp(radius > 0.0f ? radius * radius : 0.0f);
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
