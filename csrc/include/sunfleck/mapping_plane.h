// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* mapping, the flat shapes: pixel, triangle, disk. Included by mapping.h, whose comment holds
 * what the triples have in common. */
#ifndef SUNFLECK_MAPPING_PLANE_H
#define SUNFLECK_MAPPING_PLANE_H

#include "sunfleck/elementary.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- pixel: the centre is (1/2, 1/2), the pixel itself is the unit square ---- */

/* Box: the unit square as it is. pdf per area: 1 inside. */
static inline void sf_pixel_box_sample(float s, float t, float out[2]) {
    out[0] = s;
    out[1] = t;
}
static inline float sf_pixel_box_pdf(const float x[2]) {
    return (x[0] >= 0.0f) & (x[0] < 1.0f) & (x[1] >= 0.0f) & (x[1] < 1.0f) ? 1.0f : 0.0f;
}
static inline void sf_pixel_box_invert(const float x[2], float u[2]) {
    u[0] = sf_unit_clamp(x[0]);
    u[1] = sf_unit_clamp(x[1]);
}

/* Tent, the lecture's "Shirley": two pixels wide, its range is [-1/2, 3/2] and it leaves the
 * pixel with probability 7/16. pdf per area: (1 - |x - 1/2|) (1 - |y - 1/2|), 0 on the rim,
 * which s or t below 2^-51 reach. */
static inline float sf_tent_sample(float s) {
    float rising = -0.5f + sqrtf(2.0f * s), falling = 1.5f - sqrtf(2.0f - 2.0f * s);
    return s < 0.5f ? rising : falling;
}
static inline float sf_tent_pdf(float x) {
    float height = 1.0f - fabsf(x - 0.5f);
    return height > 0.0f ? height : 0.0f;
}
static inline float sf_tent_invert(float x) {
    float left = x + 0.5f, right = 1.5f - x;
    left = left > 0.0f ? left : 0.0f;
    right = right > 0.0f ? right : 0.0f;
    return sf_unit_clamp(x < 0.5f ? 0.5f * left * left : 1.0f - 0.5f * right * right);
}
static inline void sf_pixel_tent_sample(float s, float t, float out[2]) {
    out[0] = sf_tent_sample(s);
    out[1] = sf_tent_sample(t);
}
static inline float sf_pixel_tent_pdf(const float x[2]) { return sf_tent_pdf(x[0]) * sf_tent_pdf(x[1]); }
static inline void sf_pixel_tent_invert(const float x[2], float u[2]) {
    u[0] = sf_tent_invert(x[0]);
    u[1] = sf_tent_invert(x[1]);
}

/* Gaussian (Box & Muller 1958), standard deviation mu > 0, the lecture's 0.4. It is unbounded,
 * though the lecture has it within the pixel: 38 % of samples leave it at mu = 0.4. log(1 - s)
 * in place of log s, so that s = 0 gives the centre and not infinity; the farthest sample lies
 * 5.77 mu away. pdf per area: exp(-r^2 / 2 mu^2) / (2 pi mu^2). */
static inline void sf_pixel_gaussian_sample(float s, float t, float mu, float out[2]) {
    float sine, cosine, a = mu * sqrtf(-2.0f * sf_log1m(s));
    sf_sincos_2pi(t, &sine, &cosine);
    out[0] = 0.5f + a * sine;
    out[1] = 0.5f + a * cosine;
}
static inline float sf_pixel_gaussian_pdf(const float x[2], float mu) {
    float dx = (x[0] - 0.5f) / mu, dy = (x[1] - 0.5f) / mu;
    return sf_exp(-0.5f * (dx * dx + dy * dy)) / (2.0f * SF_PI_F * (mu * mu));
}
static inline void sf_pixel_gaussian_invert(const float x[2], float mu, float u[2]) {
    float dx = (x[0] - 0.5f) / mu, dy = (x[1] - 0.5f) / mu;
    u[0] = sf_unit_clamp(-sf_expm1(-0.5f * (dx * dx + dy * dy)));
    u[1] = sf_angle_2pi(dx, dy);
}

/* ---- triangle a, b, c in space ---- */

static inline void sf_cross3(const float a[3], const float b[3], float out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}
static inline float sf_dot3(const float a[3], const float b[3]) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* The point a + alpha (b - a) + beta (c - a). */
static inline void sf_triangle_point(float alpha, float beta, const float a[3], const float b[3], const float c[3],
                                     float out[3]) {
    out[0] = a[0] + (alpha * (b[0] - a[0]) + beta * (c[0] - a[0]));
    out[1] = a[1] + (alpha * (b[1] - a[1]) + beta * (c[1] - a[1]));
    out[2] = a[2] + (alpha * (b[2] - a[2]) + beta * (c[2] - a[2]));
}

/* alpha and beta of the point of the triangle's plane nearest to x; 0, 0 if the area is 0. */
static inline void sf_triangle_coordinates(const float x[3], const float a[3], const float b[3], const float c[3],
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

/* The lecture's: alpha = t sqrt(s), beta = 1 - sqrt(s). Stretches strata towards c. */
static inline void sf_triangle_sample(float s, float t, const float a[3], const float b[3], const float c[3],
                                      float out[3]) {
    float root = sqrtf(s);
    sf_triangle_point(root * t, 1.0f - root, a, b, c, out);
}
/* pdf per area: 1 / area, infinity if the area is 0. x is taken to lie on the triangle. */
static inline float sf_triangle_pdf(const float x[3], const float a[3], const float b[3], const float c[3]) {
    float e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]}, n[3];
    (void)x;
    sf_cross3(e, f, n);
    return 2.0f / sqrtf(sf_dot3(n, n));
}
/* t is lost at c itself, where all of them meet: 0 there. */
static inline void sf_triangle_invert(const float x[3], const float a[3], const float b[3], const float c[3],
                                      float u[2]) {
    float alpha, beta;
    sf_triangle_coordinates(x, a, b, c, &alpha, &beta);
    float root = 1.0f - beta;
    u[0] = sf_unit_clamp(root * root);
    u[1] = sf_unit_clamp(alpha / (root > 0.0f ? root : 1.0f));
}

/* ---- disk: radius 1 about the origin ---- */

/* pdf per area of the uniform disk: 1 / pi. What lies within 4 ulp outside the rim still counts
 * as on it, since samples round. */
static inline float sf_disk_pdf(const float x[2]) {
    return x[0] * x[0] + x[1] * x[1] <= 1.0f + 0x1p-20f ? 1.0f / SF_PI_F : 0.0f;
}

/* The lecture's: radius sqrt(t), angle 2 pi s. */
static inline void sf_disk_polar_sample(float s, float t, float out[2]) {
    float sine, cosine, radius = sqrtf(t);
    sf_sincos_2pi(s, &sine, &cosine);
    out[0] = radius * cosine;
    out[1] = radius * sine;
}
static inline float sf_disk_polar_pdf(const float x[2]) { return sf_disk_pdf(x); }
static inline void sf_disk_polar_invert(const float x[2], float u[2]) {
    u[0] = sf_angle_2pi(x[1], x[0]);
    u[1] = sf_unit_clamp(x[0] * x[0] + x[1] * x[1]);
}

/* Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square": concentric squares go to
 * concentric circles, so that strata keep their shape. Without branches: of a = 2s - 1 and
 * b = 2t - 1, the larger is the radius, and the ratio gives the angle from its axis, at most an
 * eighth of a turn. */
static inline void sf_disk_concentric_sample(float s, float t, float out[2]) {
    float a = 2.0f * s - 1.0f, b = 2.0f * t - 1.0f, sine, cosine;
    int upright = fabsf(b) > fabsf(a);
    float radius = upright ? b : a, other = upright ? a : b;
    sf_sincos_2pi_octant(0.125f * (other / (radius != 0.0f ? radius : 1.0f)), &sine, &cosine);
    out[0] = radius * (upright ? sine : cosine);
    out[1] = radius * (upright ? cosine : sine);
}
static inline float sf_disk_concentric_pdf(const float x[2]) { return sf_disk_pdf(x); }
static inline void sf_disk_concentric_invert(const float x[2], float u[2]) {
    int upright = fabsf(x[1]) > fabsf(x[0]);
    float major = upright ? x[1] : x[0], minor = upright ? x[0] : x[1];
    float length = sqrtf(x[0] * x[0] + x[1] * x[1]), angle = sf_atan_turns(fabsf(minor), fabsf(major));
    float radius = copysignf(length, major), other = copysignf(length * (8.0f * angle), minor);
    u[0] = sf_unit_clamp(0.5f + 0.5f * (upright ? other : radius));
    u[1] = sf_unit_clamp(0.5f + 0.5f * (upright ? radius : other));
}

/* The one that the lecture crosses out, kept for the laboratory: radius t, which piles samples
 * up at the centre. Its true pdf per area is 1 / (2 pi r), infinity at the centre. */
static inline void sf_disk_naive_sample(float s, float t, float out[2]) {
    float sine, cosine;
    sf_sincos_2pi(s, &sine, &cosine);
    out[0] = t * cosine;
    out[1] = t * sine;
}
static inline float sf_disk_naive_pdf(const float x[2]) {
    float square = x[0] * x[0] + x[1] * x[1];
    return square <= 1.0f + 0x1p-20f ? 1.0f / (2.0f * SF_PI_F * sqrtf(square)) : 0.0f;
}
static inline void sf_disk_naive_invert(const float x[2], float u[2]) {
    u[0] = sf_angle_2pi(x[1], x[0]);
    u[1] = sf_unit_clamp(sqrtf(x[0] * x[0] + x[1] * x[1]));
}

#ifdef __cplusplus
}
#endif
#endif
