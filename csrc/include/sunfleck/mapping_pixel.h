// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* mapping, the pixel: where in and around a pixel its samples fall, so that they have the
 * density of a filter. Included by mapping.h, whose comment holds what the triples have in
 * common.
 *
 * A filter with negative lobes is sampled by its absolute value and has a `weight`: the filter's
 * sign times the integral of |f| over that of f. The mean of weight times value is the filtered
 * value; over the mean of the weights, as a film takes it, a constant image stays exact. */
#ifndef SUNFLECK_MAPPING_PIXEL_H
#define SUNFLECK_MAPPING_PIXEL_H

#include "sunfleck/elementary.h"
#include "sunfleck/lanczos_table.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* ---- pixel: the centre is (1/2, 1/2), the pixel itself is the unit square ---- */

/* Box: the unit square as it is. pdf per area: 1 inside. */
SF_INLINE void sf_pixel_box_sample(float s, float t, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = s;
    out[1] = t;
}
SF_INLINE float sf_pixel_box_pdf(const float x[2]) {
    return ((x[0] >= 0.0f) & (x[0] < 1.0f) & (x[1] >= 0.0f) & (x[1] < 1.0f)) ? 1.0f : 0.0f;
}
SF_INLINE void sf_pixel_box_invert(const float x[2], float u[2]) {
    u[0] = sf_unit_clamp(x[0]);
    u[1] = sf_unit_clamp(x[1]);
}

/* Tent, also called Shirley's map: two pixels wide, its range is [-1/2, 3/2] and it leaves the
 * pixel with probability 7/16. pdf per area: (1 - |x - 1/2|) (1 - |y - 1/2|), 0 on the rim,
 * which s or t below 2^-51 reach. */
SF_INLINE float sf_tent_sample(float s) {
    float root = sqrtf(s < 0.5f ? 2.0f * s : 2.0f - 2.0f * s);
    return s < 0.5f ? -0.5f + root : 1.5f - root;
}
SF_INLINE float sf_tent_pdf(float x) {
    float height = 1.0f - fabsf(x - 0.5f);
    return height > 0.0f ? height : 0.0f;
}
SF_INLINE float sf_tent_invert(float x) {
    float left = x + 0.5f, right = 1.5f - x;
    left = left > 0.0f ? left : 0.0f;
    right = right > 0.0f ? right : 0.0f;
    return sf_unit_clamp(x < 0.5f ? 0.5f * left * left : 1.0f - 0.5f * right * right);
}
SF_INLINE void sf_pixel_tent_sample(float s, float t, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_tent_sample(s);
    out[1] = sf_tent_sample(t);
}
SF_INLINE float sf_pixel_tent_pdf(const float x[2]) { return sf_tent_pdf(x[0]) * sf_tent_pdf(x[1]); }
SF_INLINE void sf_pixel_tent_invert(const float x[2], float u[2]) {
    u[0] = sf_tent_invert(x[0]);
    u[1] = sf_tent_invert(x[1]);
}

/* Gaussian (Box & Muller 1958), standard deviation mu > 0, usually 0.4. It is unbounded,
 * though often said to stay within the pixel: 38 % of samples leave it at mu = 0.4. log(1 - s)
 * in place of log s, so that s = 0 gives the centre and not infinity; the farthest sample lies
 * 5.77 mu away. pdf per area: exp(-r^2 / 2 mu^2) / (2 pi mu^2). */
SF_INLINE void sf_pixel_gaussian_sample(float s, float t, float mu, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    float sine, cosine, a = mu * sqrtf(-2.0f * sf_log1m(s));
    sf_sincos_2pi(t, &sine, &cosine);
    out[0] = 0.5f + a * sine;
    out[1] = 0.5f + a * cosine;
}
SF_INLINE float sf_pixel_gaussian_pdf(const float x[2], float mu) {
    float dx = (x[0] - 0.5f) / mu, dy = (x[1] - 0.5f) / mu;
    return sf_exp(-0.5f * (dx * dx + dy * dy)) / (2.0f * SF_PI_F * (mu * mu));
}
SF_INLINE void sf_pixel_gaussian_invert(const float x[2], float mu, float u[2]) {
    float dx = (x[0] - 0.5f) / mu, dy = (x[1] - 0.5f) / mu;
    u[0] = sf_unit_clamp(-sf_expm1(-0.5f * (dx * dx + dy * dy)));
    u[1] = sf_angle_2pi(dx, dy);
}

/* Gaussian, cut at `radius` and renormalized: the same as pixel_gaussian, with s taken of the
 * share that lies within. mu 1e-6 .. 1e6; radius 1e-6 .. 1e6 and at least mu / 1000. */
SF_INLINE float sf_gaussian_share(float mu, float radius) {
    float reach = radius / mu;
    return -sf_expm1(-0.5f * (reach * reach));
}
SF_INLINE void sf_pixel_gaussian_truncated_sample(float s, float t, float mu, float radius, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    float sine, cosine, a = mu * sqrtf(-2.0f * sf_log1m(s * sf_gaussian_share(mu, radius)));
    a = a < radius ? a : radius;
    sf_sincos_2pi(t, &sine, &cosine);
    out[0] = 0.5f + a * sine;
    out[1] = 0.5f + a * cosine;
}
/* pdf per area: exp(-r^2 / 2 mu^2) / (2 pi mu^2 (1 - exp(-radius^2 / 2 mu^2))) within the radius
 * and the rounding of a sample's place. */
SF_INLINE float sf_pixel_gaussian_truncated_pdf(const float x[2], float mu, float radius) {
    float dx = x[0] - 0.5f, dy = x[1] - 0.5f, slack = radius * 0x1p-21f + 0x1p-23f, outer = radius + slack;
    float inside = dx * dx + dy * dy <= outer * outer ? 1.0f : 0.0f;
    return inside * sf_pixel_gaussian_pdf(x, mu) / sf_gaussian_share(mu, radius);
}
SF_INLINE void sf_pixel_gaussian_truncated_invert(const float x[2], float mu, float radius, float u[2]) {
    sf_pixel_gaussian_invert(x, mu, u);
    u[0] = sf_unit_clamp(u[0] / sf_gaussian_share(mu, radius));
}

/* ---- filters of x times y, by Newton's method on the integral of one axis ----
 *
 * The integral is taken from the nearest zero or rim of the filter, where it goes as a power of
 * the distance v; a root of that power starts the iteration, and five steps end it to the
 * last place (doubles) anywhere. `s` comes back within a few 2^-24. */

/* The 4-term Blackman-Harris window (Harris 1978, minimum sidelobes), 0 < radius. Its density at
 * p of the whole width from the rim: a0 - a1 cos(2 pi p) + a2 cos(4 pi p) - a3 cos(6 pi p), here by
 * powers of y = sin^2(pi p), all of whose terms are positive. */
SF_INLINE float sf_blackman_harris(float p, float *integral) {
    float sine, cosine;
    sf_sincos_2pi(0.5f * p, &sine, &cosine);
    float y = sine * sine, product = sine * cosine;
    /* The integrals of y, y^2 and y^3 by their reduction to the next lower power. */
    float first = 0.5f * p - product * (0.5f / SF_PI_F);
    float second = 0.75f * first - product * y * (0.25f / SF_PI_F);
    float third = (5.0f / 6.0f) * second - product * (y * y) * (1.0f / (6.0f * SF_PI_F));
    *integral = 0.00006f * p + (0.05658f * first + (0.5696f * second + 0.37376f * third));
    return 0.00006f + y * (0.05658f + y * (0.5696f + y * 0.37376f));
}
SF_INLINE float sf_blackman_harris_step(float p, float mass) {
    float integral, density = sf_blackman_harris(p, &integral);
    p -= (integral - mass) / density;
    p = p > 0.0f ? p : 0.0f;
    return p < 0.5f ? p : 0.5f;
}
SF_INLINE float sf_blackman_harris_sample(float s, float radius) {
    float tail = s < 0.5f ? s : 1.0f - s, mass = 0.35875f * tail, p = 0.5f * sqrtf(sqrtf(2.0f * tail));
    p = sf_blackman_harris_step(p, mass);
    p = sf_blackman_harris_step(p, mass);
    p = sf_blackman_harris_step(p, mass);
    p = sf_blackman_harris_step(p, mass);
    p = sf_blackman_harris_step(p, mass);
    return 0.5f + copysignf((1.0f - 2.0f * p) * radius, s - 0.5f);
}
/* p of a place; 0 at the rim, negative outside. */
SF_INLINE float sf_blackman_harris_place(float x, float radius) { return 0.5f - 0.5f * (fabsf(x - 0.5f) / radius); }
SF_INLINE float sf_blackman_harris_pdf(float x, float radius) {
    float p = sf_blackman_harris_place(x, radius), integral,
          density = sf_blackman_harris(p > 0.0f ? p : 0.0f, &integral);
    return p >= -0x1p-22f - 0x1p-24f / radius ? density * (0.5f / 0.35875f) / radius : 0.0f;
}
SF_INLINE float sf_blackman_harris_invert(float x, float radius) {
    float p = sf_blackman_harris_place(x, radius), integral;
    (void)sf_blackman_harris(p > 0.0f ? p : 0.0f, &integral);
    float tail = integral * (1.0f / 0.35875f);
    return sf_unit_clamp(x < 0.5f ? tail : 1.0f - tail);
}
/* radius 1e-3 .. 1e3; never 0 within it: the rim has 1.7e-4 of the centre's density. */
SF_INLINE void sf_pixel_blackman_harris_sample(float s, float t, float radius, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_blackman_harris_sample(s, radius);
    out[1] = sf_blackman_harris_sample(t, radius);
}
SF_INLINE float sf_pixel_blackman_harris_pdf(const float x[2], float radius) {
    return sf_blackman_harris_pdf(x[0], radius) * sf_blackman_harris_pdf(x[1], radius);
}
SF_INLINE void sf_pixel_blackman_harris_invert(const float x[2], float radius, float u[2]) {
    u[0] = sf_blackman_harris_invert(x[0], radius);
    u[1] = sf_blackman_harris_invert(x[1], radius);
}

/* Mitchell & Netravali 1988 with B = C = 1/3: radius 2, zero at 8/7, double zero at 2. With
 * w = 6/7 it is (7/18) d^2 (d - w) at d from the rim, and beside the zero (7/18) (w -+ v)^2 v. The
 * half has mass 355/686 before the zero and 6/343 behind it. Its three pieces, by `row`: from the
 * rim, from the zero outwards, from the zero inwards. */
SF_INLINE float sf_mitchell_integral(int row, float v, float *density) {
    static const float k2[3] = {0.0f, 18.0f / 49.0f, 18.0f / 49.0f}; /* (7/18) v^2 (k2 + k3 v + k4 v^2) */
    static const float k3[3] = {2.0f / 7.0f, -4.0f / 7.0f, 4.0f / 7.0f}, k4[3] = {-0.25f, 0.25f, 0.25f};
    static const float ends[3] = {4.0f, 4.0f, 1.0f / 7.0f}; /* from there on the middle polynomial holds */
    float x = 8.0f / 7.0f - v, outer = 7.0f / 18.0f * v * v * (k2[row] + v * (k3[row] + v * k4[row]));
    float slope = 7.0f / 18.0f * v * (2.0f * k2[row] + v * (3.0f * k3[row] + 4.0f * k4[row] * v));
    float middle = 355.0f / 686.0f - x * (8.0f / 9.0f + x * x * (-2.0f / 3.0f + 7.0f / 24.0f * x));
    float height = 8.0f / 9.0f + x * x * (7.0f / 6.0f * x - 2.0f);
    *density = v > ends[row] ? height : slope;
    return v > ends[row] ? middle : outer;
}
SF_INLINE float sf_mitchell_step(int row, float v, float mass) {
    static const float top[3] = {6.0f / 7.0f, 6.0f / 7.0f, 8.0f / 7.0f};
    float density, off = sf_mitchell_integral(row, v, &density) - mass;
    v -= off / (density > 0x1p-100f ? density : 0x1p-100f);
    v = v > 0.0f ? v : 0.0f;
    return v < top[row] ? v : top[row];
}
SF_INLINE float sf_mitchell_sample(float s) {
    static const float start[3] = {0.0f, 6.0f / 343.0f, -6.0f / 343.0f}, turn[3] = {1.0f, -1.0f, 1.0f};
    static const float rough[3] = {9.0f, 7.0f, 64.0f / 49.0f * 686.0f / 355.0f}; /* v^3 or v^2 over mass */
    static const float origin[3] = {2.0f, 8.0f / 7.0f, 8.0f / 7.0f}, side[3] = {-1.0f, 1.0f, -1.0f};
    float r = (s < 0.5f ? s : 1.0f - s) * (367.0f / 343.0f);
    int row = (r >= 3.0f / 343.0f) + (r >= 6.0f / 343.0f);
    float mass = start[row] + turn[row] * r, scaled = mass * rough[row];
    float cube = sf_cbrt_rough(scaled), root = sqrtf(scaled), v = row == 0 ? cube : root;
    v = sf_mitchell_step(row, v, mass);
    v = sf_mitchell_step(row, v, mass);
    v = sf_mitchell_step(row, v, mass);
    v = sf_mitchell_step(row, v, mass);
    v = sf_mitchell_step(row, v, mass);
    return 0.5f + copysignf(origin[row] + side[row] * v, s - 0.5f);
}
/* The filter itself. */
SF_INLINE float sf_mitchell(float x) {
    float d = fabsf(x - 0.5f), e = 2.0f - d, outer = 7.0f / 18.0f * (e * e) * (8.0f / 7.0f - d);
    float middle = 8.0f / 9.0f + d * d * (7.0f / 6.0f * d - 2.0f);
    return d < 1.0f ? middle : d < 2.0f ? outer : 0.0f;
}
SF_INLINE float sf_mitchell_invert(float x) {
    static const float start[3] = {0.0f, 6.0f / 343.0f, 6.0f / 343.0f}, turn[3] = {1.0f, -1.0f, 1.0f};
    static const float origin[3] = {2.0f, 8.0f / 7.0f, 8.0f / 7.0f}, side[3] = {-1.0f, 1.0f, -1.0f};
    float d = fabsf(x - 0.5f), density;
    int row = (d <= 1.6f) + (d < 8.0f / 7.0f);
    float v = side[row] * (d - origin[row]), mass = sf_mitchell_integral(row, v > 0.0f ? v : 0.0f, &density);
    float tail = (start[row] + turn[row] * mass) * (343.0f / 367.0f);
    return sf_unit_clamp(x < 0.5f ? tail : 1.0f - tail);
}
SF_INLINE void sf_pixel_mitchell_sample(float s, float t, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_mitchell_sample(s);
    out[1] = sf_mitchell_sample(t);
}
/* pdf per area: |f(x) f(y)| (343/367)^2; 0 at the filter's zeros: the rim, and 8/7 from the centre. */
SF_INLINE float sf_pixel_mitchell_pdf(const float x[2]) {
    return fabsf(sf_mitchell(x[0]) * sf_mitchell(x[1])) * (343.0f * 343.0f / (367.0f * 367.0f));
}
SF_INLINE void sf_pixel_mitchell_invert(const float x[2], float u[2]) {
    u[0] = sf_mitchell_invert(x[0]);
    u[1] = sf_mitchell_invert(x[1]);
}
/* +-(367/343)^2 = +-1.145. */
SF_INLINE float sf_pixel_mitchell_weight(const float x[2]) {
    return copysignf(367.0f * 367.0f / (343.0f * 343.0f), sf_mitchell(x[0]) * sf_mitchell(x[1]));
}

/* Lanczos with three lobes: sinc(x) sinc(x / 3), radius 3, zeros at 1, 2 and (double) 3. Its pieces
 * are the columns of lanczos_table.h. */
SF_INLINE float sf_lanczos_integral(int row, float v, float *density) {
    float p = sf_lanczos_table[SF_LANCZOS_TERMS_F - 1][row], slope = 0.0f;
    for (int i = SF_LANCZOS_TERMS_F - 2; i >= 0; --i) {
        slope = slope * v + p;
        p = p * v + sf_lanczos_table[i][row];
    }
    *density = v * (2.0f * p + v * slope);
    return v * v * p;
}
SF_INLINE float sf_lanczos_step(int row, float v, float mass) {
    static const float top[5] = {1.0f, 0.6f, 0.6f, 0.6f, 0.7f};
    float density, off = sf_lanczos_integral(row, v, &density) - mass;
    v -= off / (density > 0x1p-100f ? density : 0x1p-100f);
    v = v > 0.0f ? v : 0.0f;
    return v < top[row] ? v : top[row];
}
SF_INLINE float sf_lanczos_sample(float s) {
    static const float turn[5] = {1.0f, -1.0f, 1.0f, -1.0f, 1.0f};
    static const float origin[5] = {1.0f, 1.0f, 2.0f, 2.0f, 3.0f}, side[5] = {-1.0f, 1.0f, -1.0f, 1.0f, -1.0f};
    static const float rough[5] = {1.75f, 2.42f, 9.67f, 9.67f, 27.0f}; /* v^2, at last v^3, over mass */
    const float *lobe = sf_lanczos_lobes;
    float r = (s < 0.5f ? s : 1.0f - s) * (2.0f * (lobe[0] + lobe[1] + lobe[2]));
    float past = r >= 0.5f * lobe[2] ? 1.0f : 0.0f, zero = r >= lobe[2] ? 1.0f : 0.0f;
    float next = r >= lobe[2] + 0.5f * lobe[1] ? 1.0f : 0.0f, last = r >= lobe[2] + lobe[1] ? 1.0f : 0.0f;
    int row = 4 - (int)(past + zero + next + last);
    /* The mass from the row's zero: r less what lies outside of it. */
    float mass = turn[row] * ((r - past * lobe[2]) - next * lobe[1]), scaled = mass * rough[row];
    float cube = sf_cbrt_rough(scaled), root = sqrtf(scaled), v = cube + past * (root - cube);
    v = sf_lanczos_step(row, v, mass);
    v = sf_lanczos_step(row, v, mass);
    v = sf_lanczos_step(row, v, mass);
    v = sf_lanczos_step(row, v, mass);
    v = sf_lanczos_step(row, v, mass);
    return 0.5f + copysignf(origin[row] + side[row] * v, s - 0.5f);
}
/* The filter itself; sin(pi d) from what is left to the nearest zero. */
SF_INLINE float sf_lanczos(float x) {
    float d = fabsf(x - 0.5f), inside = (d < 3.0f ? d : 3.0f) + 0x1p-60f, sine, third, cosine; /* never 0 */
    int32_t whole = (int32_t)inside;
    float outside = 3.0f - inside, near = inside < outside ? inside : outside, sign = 3.0f - 6.0f * (float)(whole & 1);
    sf_sincos_2pi(0.5f * (inside - (float)whole), &sine, &cosine);
    sf_sincos_2pi(near * (1.0f / 6.0f), &third, &cosine);
    return sign * (sine * third) / (SF_PI_F * SF_PI_F * (inside * inside));
}
SF_INLINE float sf_lanczos_invert(float x) {
    static const float turn[5] = {1.0f, -1.0f, 1.0f, -1.0f, 1.0f}, origin[5] = {1.0f, 1.0f, 2.0f, 2.0f, 3.0f};
    const float *lobe = sf_lanczos_lobes;
    float d = fabsf(x - 0.5f), density;
    d = d < 3.0f ? d : 3.0f;
    float first = d < 1.5f ? 1.0f : 0.0f, second = d < 2.5f ? 1.0f : 0.0f;
    int row = (int)((d >= 1.0f ? 1.0f : 0.0f) + (1.0f - first) + (d >= 2.0f ? 1.0f : 0.0f) + (1.0f - second));
    float mass = turn[row] * sf_lanczos_integral(row, fabsf(d - origin[row]), &density);
    float tail = ((mass + second * lobe[2]) + first * lobe[1]) / (2.0f * (lobe[0] + lobe[1] + lobe[2]));
    tail = x < 0.5f ? tail : 1.0f - tail;
    return sf_unit_clamp(tail);
}
SF_INLINE void sf_pixel_lanczos_sample(float s, float t, float out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_lanczos_sample(s);
    out[1] = sf_lanczos_sample(t);
}
/* pdf per area: |f(x) f(y)| over the square of the integral of |f|; 0 at the filter's zeros: 1, 2 and
 * 3 from the centre. */
SF_INLINE float sf_pixel_lanczos_pdf(const float x[2]) {
    const float *lobe = sf_lanczos_lobes;
    float scale = 0.5f / (lobe[0] + lobe[1] + lobe[2]);
    return fabsf(sf_lanczos(x[0]) * sf_lanczos(x[1])) * (scale * scale);
}
SF_INLINE void sf_pixel_lanczos_invert(const float x[2], float u[2]) {
    u[0] = sf_lanczos_invert(x[0]);
    u[1] = sf_lanczos_invert(x[1]);
}
/* +-1.845: the square of the integral of |f| over that of f. */
SF_INLINE float sf_pixel_lanczos_weight(const float x[2]) {
    const float *lobe = sf_lanczos_lobes;
    float ratio = (lobe[0] + lobe[1] + lobe[2]) / (lobe[0] - lobe[1] + lobe[2]);
    return copysignf(ratio * ratio, sf_lanczos(x[0]) * sf_lanczos(x[1]));
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
