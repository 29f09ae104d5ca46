// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Made by make_mapping_f64.py from mapping_pixel.h, mapping_plane.h, mapping_sphere.h, mapping_lobe.h
 * and mapping_light.h: do not edit.
 * The same formulas in double, for the bulk calls; the comments are there. */
#ifndef SUNFLECK_MAPPING_F64_H
#define SUNFLECK_MAPPING_F64_H

#include "mapping/elementary_f64.h"
#include "mapping/lanczos_table_f64.h"

/* ---- mapping_pixel.h ---- */

SF_INLINE void sf_pixel_box_sample_f64(double s, double t, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = s;
    out[1] = t;
}
SF_INLINE double sf_pixel_box_pdf_f64(const double x[2]) {
    return ((x[0] >= 0.0) & (x[0] < 1.0) & (x[1] >= 0.0) & (x[1] < 1.0)) ? 1.0 : 0.0;
}
SF_INLINE void sf_pixel_box_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_unit_clamp_f64(x[0]);
    u[1] = sf_unit_clamp_f64(x[1]);
}

SF_INLINE double sf_tent_sample_f64(double s) {
    double root = sqrt(s < 0.5 ? 2.0 * s : 2.0 - 2.0 * s);
    return s < 0.5 ? -0.5 + root : 1.5 - root;
}
SF_INLINE double sf_tent_pdf_f64(double x) {
    double height = 1.0 - fabs(x - 0.5);
    return height > 0.0 ? height : 0.0;
}
SF_INLINE double sf_tent_invert_f64(double x) {
    double left = x + 0.5, right = 1.5 - x;
    left = left > 0.0 ? left : 0.0;
    right = right > 0.0 ? right : 0.0;
    return sf_unit_clamp_f64(x < 0.5 ? 0.5 * left * left : 1.0 - 0.5 * right * right);
}
SF_INLINE void sf_pixel_tent_sample_f64(double s, double t, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_tent_sample_f64(s);
    out[1] = sf_tent_sample_f64(t);
}
SF_INLINE double sf_pixel_tent_pdf_f64(const double x[2]) { return sf_tent_pdf_f64(x[0]) * sf_tent_pdf_f64(x[1]); }
SF_INLINE void sf_pixel_tent_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_tent_invert_f64(x[0]);
    u[1] = sf_tent_invert_f64(x[1]);
}

SF_INLINE void sf_pixel_gaussian_sample_f64(double s, double t, double mu, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    double sine, cosine, a = mu * sqrt(-2.0 * sf_log1m_f64(s));
    sf_sincos_2pi_f64(t, &sine, &cosine);
    out[0] = 0.5 + a * sine;
    out[1] = 0.5 + a * cosine;
}
SF_INLINE double sf_pixel_gaussian_pdf_f64(const double x[2], double mu) {
    double dx = (x[0] - 0.5) / mu, dy = (x[1] - 0.5) / mu;
    return sf_exp_f64(-0.5 * (dx * dx + dy * dy)) / (2.0 * SF_PI * (mu * mu));
}
SF_INLINE void sf_pixel_gaussian_invert_f64(const double x[2], double mu, double u[2]) {
    double dx = (x[0] - 0.5) / mu, dy = (x[1] - 0.5) / mu;
    u[0] = sf_unit_clamp_f64(-sf_expm1_f64(-0.5 * (dx * dx + dy * dy)));
    u[1] = sf_angle_2pi_f64(dx, dy);
}

SF_INLINE double sf_gaussian_share_f64(double mu, double radius) {
    double reach = radius / mu;
    return -sf_expm1_f64(-0.5 * (reach * reach));
}
SF_INLINE void sf_pixel_gaussian_truncated_sample_f64(double s, double t, double mu, double radius, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    double sine, cosine, a = mu * sqrt(-2.0 * sf_log1m_f64(s * sf_gaussian_share_f64(mu, radius)));
    a = a < radius ? a : radius;
    sf_sincos_2pi_f64(t, &sine, &cosine);
    out[0] = 0.5 + a * sine;
    out[1] = 0.5 + a * cosine;
}

SF_INLINE double sf_pixel_gaussian_truncated_pdf_f64(const double x[2], double mu, double radius) {
    double dx = x[0] - 0.5, dy = x[1] - 0.5, slack = radius * 0x1p-21 + 0x1p-23, outer = radius + slack;
    double inside = dx * dx + dy * dy <= outer * outer ? 1.0 : 0.0;
    return inside * sf_pixel_gaussian_pdf_f64(x, mu) / sf_gaussian_share_f64(mu, radius);
}
SF_INLINE void sf_pixel_gaussian_truncated_invert_f64(const double x[2], double mu, double radius, double u[2]) {
    sf_pixel_gaussian_invert_f64(x, mu, u);
    u[0] = sf_unit_clamp_f64(u[0] / sf_gaussian_share_f64(mu, radius));
}

SF_INLINE double sf_blackman_harris_f64(double p, double *integral) {
    double sine, cosine;
    sf_sincos_2pi_f64(0.5 * p, &sine, &cosine);
    double y = sine * sine, product = sine * cosine;
    double first = 0.5 * p - product * (0.5 / SF_PI);
    double second = 0.75 * first - product * y * (0.25 / SF_PI);
    double third = (5.0 / 6.0) * second - product * (y * y) * (1.0 / (6.0 * SF_PI));
    *integral = 0.00006 * p + (0.05658 * first + (0.5696 * second + 0.37376 * third));
    return 0.00006 + y * (0.05658 + y * (0.5696 + y * 0.37376));
}
SF_INLINE double sf_blackman_harris_step_f64(double p, double mass) {
    double integral, density = sf_blackman_harris_f64(p, &integral);
    p -= (integral - mass) / density;
    p = p > 0.0 ? p : 0.0;
    return p < 0.5 ? p : 0.5;
}
SF_INLINE double sf_blackman_harris_sample_f64(double s, double radius) {
    double tail = s < 0.5 ? s : 1.0 - s, mass = 0.35875 * tail, p = 0.5 * sqrt(sqrt(2.0 * tail));
    p = sf_blackman_harris_step_f64(p, mass);
    p = sf_blackman_harris_step_f64(p, mass);
    p = sf_blackman_harris_step_f64(p, mass);
    p = sf_blackman_harris_step_f64(p, mass);
    p = sf_blackman_harris_step_f64(p, mass);
    return 0.5 + copysign((1.0 - 2.0 * p) * radius, s - 0.5);
}

SF_INLINE double sf_blackman_harris_place_f64(double x, double radius) { return 0.5 - 0.5 * (fabs(x - 0.5) / radius); }
SF_INLINE double sf_blackman_harris_pdf_f64(double x, double radius) {
    double p = sf_blackman_harris_place_f64(x, radius), integral,
          density = sf_blackman_harris_f64(p > 0.0 ? p : 0.0, &integral);
    return p >= -0x1p-22 - 0x1p-24 / radius ? density * (0.5 / 0.35875) / radius : 0.0;
}
SF_INLINE double sf_blackman_harris_invert_f64(double x, double radius) {
    double p = sf_blackman_harris_place_f64(x, radius), integral;
    (void)sf_blackman_harris_f64(p > 0.0 ? p : 0.0, &integral);
    double tail = integral * (1.0 / 0.35875);
    return sf_unit_clamp_f64(x < 0.5 ? tail : 1.0 - tail);
}

SF_INLINE void sf_pixel_blackman_harris_sample_f64(double s, double t, double radius, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_blackman_harris_sample_f64(s, radius);
    out[1] = sf_blackman_harris_sample_f64(t, radius);
}
SF_INLINE double sf_pixel_blackman_harris_pdf_f64(const double x[2], double radius) {
    return sf_blackman_harris_pdf_f64(x[0], radius) * sf_blackman_harris_pdf_f64(x[1], radius);
}
SF_INLINE void sf_pixel_blackman_harris_invert_f64(const double x[2], double radius, double u[2]) {
    u[0] = sf_blackman_harris_invert_f64(x[0], radius);
    u[1] = sf_blackman_harris_invert_f64(x[1], radius);
}

SF_INLINE double sf_mitchell_integral_f64(int row, double v, double *density) {
    static const double k2[3] = {0.0, 18.0 / 49.0, 18.0 / 49.0};
    static const double k3[3] = {2.0 / 7.0, -4.0 / 7.0, 4.0 / 7.0}, k4[3] = {-0.25, 0.25, 0.25};
    static const double ends[3] = {4.0, 4.0, 1.0 / 7.0};
    double x = 8.0 / 7.0 - v, outer = 7.0 / 18.0 * v * v * (k2[row] + v * (k3[row] + v * k4[row]));
    double slope = 7.0 / 18.0 * v * (2.0 * k2[row] + v * (3.0 * k3[row] + 4.0 * k4[row] * v));
    double middle = 355.0 / 686.0 - x * (8.0 / 9.0 + x * x * (-2.0 / 3.0 + 7.0 / 24.0 * x));
    double height = 8.0 / 9.0 + x * x * (7.0 / 6.0 * x - 2.0);
    *density = v > ends[row] ? height : slope;
    return v > ends[row] ? middle : outer;
}
SF_INLINE double sf_mitchell_step_f64(int row, double v, double mass) {
    static const double top[3] = {6.0 / 7.0, 6.0 / 7.0, 8.0 / 7.0};
    double density, off = sf_mitchell_integral_f64(row, v, &density) - mass;
    v -= off / (density > 0x1p-100 ? density : 0x1p-100);
    v = v > 0.0 ? v : 0.0;
    return v < top[row] ? v : top[row];
}
SF_INLINE double sf_mitchell_sample_f64(double s) {
    static const double start[3] = {0.0, 6.0 / 343.0, -6.0 / 343.0}, turn[3] = {1.0, -1.0, 1.0};
    static const double rough[3] = {9.0, 7.0, 64.0 / 49.0 * 686.0 / 355.0};
    static const double origin[3] = {2.0, 8.0 / 7.0, 8.0 / 7.0}, side[3] = {-1.0, 1.0, -1.0};
    double r = (s < 0.5 ? s : 1.0 - s) * (367.0 / 343.0);
    int row = (r >= 3.0 / 343.0) + (r >= 6.0 / 343.0);
    double mass = start[row] + turn[row] * r, scaled = mass * rough[row];
    double cube = sf_cbrt_rough_f64(scaled), root = sqrt(scaled), v = row == 0 ? cube : root;
    v = sf_mitchell_step_f64(row, v, mass);
    v = sf_mitchell_step_f64(row, v, mass);
    v = sf_mitchell_step_f64(row, v, mass);
    v = sf_mitchell_step_f64(row, v, mass);
    v = sf_mitchell_step_f64(row, v, mass);
    return 0.5 + copysign(origin[row] + side[row] * v, s - 0.5);
}

SF_INLINE double sf_mitchell_f64(double x) {
    double d = fabs(x - 0.5), e = 2.0 - d, outer = 7.0 / 18.0 * (e * e) * (8.0 / 7.0 - d);
    double middle = 8.0 / 9.0 + d * d * (7.0 / 6.0 * d - 2.0);
    return d < 1.0 ? middle : d < 2.0 ? outer : 0.0;
}
SF_INLINE double sf_mitchell_invert_f64(double x) {
    static const double start[3] = {0.0, 6.0 / 343.0, 6.0 / 343.0}, turn[3] = {1.0, -1.0, 1.0};
    static const double origin[3] = {2.0, 8.0 / 7.0, 8.0 / 7.0}, side[3] = {-1.0, 1.0, -1.0};
    double d = fabs(x - 0.5), density;
    int row = (d <= 1.6) + (d < 8.0 / 7.0);
    double v = side[row] * (d - origin[row]), mass = sf_mitchell_integral_f64(row, v > 0.0 ? v : 0.0, &density);
    double tail = (start[row] + turn[row] * mass) * (343.0 / 367.0);
    return sf_unit_clamp_f64(x < 0.5 ? tail : 1.0 - tail);
}
SF_INLINE void sf_pixel_mitchell_sample_f64(double s, double t, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_mitchell_sample_f64(s);
    out[1] = sf_mitchell_sample_f64(t);
}

SF_INLINE double sf_pixel_mitchell_pdf_f64(const double x[2]) {
    return fabs(sf_mitchell_f64(x[0]) * sf_mitchell_f64(x[1])) * (343.0 * 343.0 / (367.0 * 367.0));
}
SF_INLINE void sf_pixel_mitchell_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_mitchell_invert_f64(x[0]);
    u[1] = sf_mitchell_invert_f64(x[1]);
}

SF_INLINE double sf_pixel_mitchell_weight_f64(const double x[2]) {
    return copysign(367.0 * 367.0 / (343.0 * 343.0), sf_mitchell_f64(x[0]) * sf_mitchell_f64(x[1]));
}

SF_INLINE double sf_lanczos_integral_f64(int row, double v, double *density) {
    double p = sf_lanczos_table_f64[SF_LANCZOS_TERMS - 1][row], slope = 0.0;
    for (int i = SF_LANCZOS_TERMS - 2; i >= 0; --i) {
        slope = slope * v + p;
        p = p * v + sf_lanczos_table_f64[i][row];
    }
    *density = v * (2.0 * p + v * slope);
    return v * v * p;
}
SF_INLINE double sf_lanczos_step_f64(int row, double v, double mass) {
    static const double top[5] = {1.0, 0.6, 0.6, 0.6, 0.7};
    double density, off = sf_lanczos_integral_f64(row, v, &density) - mass;
    v -= off / (density > 0x1p-100 ? density : 0x1p-100);
    v = v > 0.0 ? v : 0.0;
    return v < top[row] ? v : top[row];
}
SF_INLINE double sf_lanczos_sample_f64(double s) {
    static const double turn[5] = {1.0, -1.0, 1.0, -1.0, 1.0};
    static const double origin[5] = {1.0, 1.0, 2.0, 2.0, 3.0}, side[5] = {-1.0, 1.0, -1.0, 1.0, -1.0};
    static const double rough[5] = {1.75, 2.42, 9.67, 9.67, 27.0};
    const double *lobe = sf_lanczos_lobes_f64;
    double r = (s < 0.5 ? s : 1.0 - s) * (2.0 * (lobe[0] + lobe[1] + lobe[2]));
    double past = r >= 0.5 * lobe[2] ? 1.0 : 0.0, zero = r >= lobe[2] ? 1.0 : 0.0;
    double next = r >= lobe[2] + 0.5 * lobe[1] ? 1.0 : 0.0, last = r >= lobe[2] + lobe[1] ? 1.0 : 0.0;
    int row = 4 - (int)(past + zero + next + last);
    double mass = turn[row] * ((r - past * lobe[2]) - next * lobe[1]), scaled = mass * rough[row];
    double cube = sf_cbrt_rough_f64(scaled), root = sqrt(scaled), v = cube + past * (root - cube);
    v = sf_lanczos_step_f64(row, v, mass);
    v = sf_lanczos_step_f64(row, v, mass);
    v = sf_lanczos_step_f64(row, v, mass);
    v = sf_lanczos_step_f64(row, v, mass);
    v = sf_lanczos_step_f64(row, v, mass);
    return 0.5 + copysign(origin[row] + side[row] * v, s - 0.5);
}

SF_INLINE double sf_lanczos_f64(double x) {
    double d = fabs(x - 0.5), inside = (d < 3.0 ? d : 3.0) + 0x1p-60, sine, third, cosine;
    int32_t whole = (int32_t)inside;
    double outside = 3.0 - inside, near = inside < outside ? inside : outside, sign = 3.0 - 6.0 * (double)(whole & 1);
    sf_sincos_2pi_f64(0.5 * (inside - (double)whole), &sine, &cosine);
    sf_sincos_2pi_f64(near * (1.0 / 6.0), &third, &cosine);
    return sign * (sine * third) / (SF_PI * SF_PI * (inside * inside));
}
SF_INLINE double sf_lanczos_invert_f64(double x) {
    static const double turn[5] = {1.0, -1.0, 1.0, -1.0, 1.0}, origin[5] = {1.0, 1.0, 2.0, 2.0, 3.0};
    const double *lobe = sf_lanczos_lobes_f64;
    double d = fabs(x - 0.5), density;
    d = d < 3.0 ? d : 3.0;
    double first = d < 1.5 ? 1.0 : 0.0, second = d < 2.5 ? 1.0 : 0.0;
    int row = (int)((d >= 1.0 ? 1.0 : 0.0) + (1.0 - first) + (d >= 2.0 ? 1.0 : 0.0) + (1.0 - second));
    double mass = turn[row] * sf_lanczos_integral_f64(row, fabs(d - origin[row]), &density);
    double tail = ((mass + second * lobe[2]) + first * lobe[1]) / (2.0 * (lobe[0] + lobe[1] + lobe[2]));
    tail = x < 0.5 ? tail : 1.0 - tail;
    return sf_unit_clamp_f64(tail);
}
SF_INLINE void sf_pixel_lanczos_sample_f64(double s, double t, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    out[0] = sf_lanczos_sample_f64(s);
    out[1] = sf_lanczos_sample_f64(t);
}

SF_INLINE double sf_pixel_lanczos_pdf_f64(const double x[2]) {
    const double *lobe = sf_lanczos_lobes_f64;
    double scale = 0.5 / (lobe[0] + lobe[1] + lobe[2]);
    return fabs(sf_lanczos_f64(x[0]) * sf_lanczos_f64(x[1])) * (scale * scale);
}
SF_INLINE void sf_pixel_lanczos_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_lanczos_invert_f64(x[0]);
    u[1] = sf_lanczos_invert_f64(x[1]);
}

SF_INLINE double sf_pixel_lanczos_weight_f64(const double x[2]) {
    const double *lobe = sf_lanczos_lobes_f64;
    double ratio = (lobe[0] + lobe[1] + lobe[2]) / (lobe[0] - lobe[1] + lobe[2]);
    return copysign(ratio * ratio, sf_lanczos_f64(x[0]) * sf_lanczos_f64(x[1]));
}

/* ---- mapping_plane.h ---- */

SF_INLINE void sf_cross3_f64(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}
SF_INLINE double sf_dot3_f64(const double a[3], const double b[3]) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }

SF_INLINE void sf_triangle_point_f64(double alpha, double beta, const double a[3], const double b[3], const double c[3],
                                 double out[3]) {
    out[0] = a[0] + (alpha * (b[0] - a[0]) + beta * (c[0] - a[0]));
    out[1] = a[1] + (alpha * (b[1] - a[1]) + beta * (c[1] - a[1]));
    out[2] = a[2] + (alpha * (b[2] - a[2]) + beta * (c[2] - a[2]));
}

SF_INLINE void sf_triangle_coordinates_f64(const double x[3], const double a[3], const double b[3], const double c[3],
                                       double *alpha, double *beta) {
    double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double d[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]}, n[3], df[3], ed[3];
    sf_cross3_f64(e, f, n);
    sf_cross3_f64(d, f, df);
    sf_cross3_f64(e, d, ed);
    double square = sf_dot3_f64(n, n), scale = square > 0.0 ? square : 1.0;
    *alpha = sf_dot3_f64(df, n) / scale;
    *beta = sf_dot3_f64(ed, n) / scale;
}

SF_INLINE void sf_triangle_sample_f64(double s, double t, const double a[3], const double b[3], const double c[3],
                                  double out[3]) {
    SF_ASSERT_UNIT(s, t);
    double root = sqrt(s);
    sf_triangle_point_f64(root * t, 1.0 - root, a, b, c, out);
}

SF_INLINE double sf_triangle_pdf_f64(const double x[3], const double a[3], const double b[3], const double c[3]) {
    double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]}, n[3];
    (void)x;
    sf_cross3_f64(e, f, n);
    return 2.0 / sqrt(sf_dot3_f64(n, n));
}

SF_INLINE void sf_triangle_invert_f64(const double x[3], const double a[3], const double b[3], const double c[3], double u[2]) {
    double alpha, beta;
    sf_triangle_coordinates_f64(x, a, b, c, &alpha, &beta);
    double root = 1.0 - beta;
    u[0] = sf_unit_clamp_f64(root * root);
    u[1] = sf_unit_clamp_f64(alpha / (root > 0.0 ? root : 1.0));
}

SF_INLINE void sf_triangle_low_distortion_sample_f64(double s, double t, const double a[3], const double b[3], const double c[3],
                                                 double out[3]) {
    SF_ASSERT_UNIT(s, t);
    double alpha = t > s ? 0.5 * s : s - 0.5 * t, beta = t > s ? t - 0.5 * s : 0.5 * t;
    sf_triangle_point_f64(alpha, beta, a, b, c, out);
}
SF_INLINE double sf_triangle_low_distortion_pdf_f64(const double x[3], const double a[3], const double b[3], const double c[3]) {
    return sf_triangle_pdf_f64(x, a, b, c);
}
SF_INLINE void sf_triangle_low_distortion_invert_f64(const double x[3], const double a[3], const double b[3], const double c[3],
                                                 double u[2]) {
    double alpha, beta;
    sf_triangle_coordinates_f64(x, a, b, c, &alpha, &beta);
    u[0] = sf_unit_clamp_f64(beta > alpha ? 2.0 * alpha : alpha + beta);
    u[1] = sf_unit_clamp_f64(beta > alpha ? alpha + beta : 2.0 * beta);
}

SF_INLINE void sf_parallelogram_sample_f64(double s, double t, const double a[3], const double b[3], const double c[3],
                                       double out[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_triangle_point_f64(s, t, a, b, c, out);
}

SF_INLINE double sf_parallelogram_pdf_f64(const double x[3], const double a[3], const double b[3], const double c[3]) {
    return 0.5 * sf_triangle_pdf_f64(x, a, b, c);
}
SF_INLINE void sf_parallelogram_invert_f64(const double x[3], const double a[3], const double b[3], const double c[3],
                                       double u[2]) {
    sf_triangle_coordinates_f64(x, a, b, c, &u[0], &u[1]);
    u[0] = sf_unit_clamp_f64(u[0]);
    u[1] = sf_unit_clamp_f64(u[1]);
}

SF_INLINE double sf_disk_pdf_f64(const double x[2]) {
    return x[0] * x[0] + x[1] * x[1] <= 1.0 + 0x1p-20 ? 1.0 / SF_PI : 0.0;
}

SF_INLINE void sf_disk_polar_sample_f64(double s, double t, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    double sine, cosine, radius = sqrt(t);
    sf_sincos_2pi_f64(s, &sine, &cosine);
    out[0] = radius * cosine;
    out[1] = radius * sine;
}
SF_INLINE double sf_disk_polar_pdf_f64(const double x[2]) { return sf_disk_pdf_f64(x); }
SF_INLINE void sf_disk_polar_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_angle_2pi_f64(x[1], x[0]);
    u[1] = sf_unit_clamp_f64(x[0] * x[0] + x[1] * x[1]);
}

SF_INLINE void sf_disk_concentric_sample_f64(double s, double t, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    double a = 2.0 * s - 1.0, b = 2.0 * t - 1.0, sine, cosine;
    int upright = fabs(b) > fabs(a);
    double radius = upright ? b : a, other = upright ? a : b;
    sf_sincos_2pi_octant_f64(0.125 * (other / (radius != 0.0 ? radius : 1.0)), &sine, &cosine);
    out[0] = radius * (upright ? sine : cosine);
    out[1] = radius * (upright ? cosine : sine);
}
SF_INLINE double sf_disk_concentric_pdf_f64(const double x[2]) { return sf_disk_pdf_f64(x); }
SF_INLINE void sf_disk_concentric_invert_f64(const double x[2], double u[2]) {
    int upright = fabs(x[1]) > fabs(x[0]);
    double major = upright ? x[1] : x[0], minor = upright ? x[0] : x[1];
    double length = sqrt(x[0] * x[0] + x[1] * x[1]), angle = sf_atan_turns_f64(fabs(minor), fabs(major));
    double radius = copysign(length, major), other = copysign(length * (8.0 * angle), minor);
    u[0] = sf_unit_clamp_f64(0.5 + 0.5 * (upright ? other : radius));
    u[1] = sf_unit_clamp_f64(0.5 + 0.5 * (upright ? radius : other));
}

SF_INLINE void sf_disk_naive_sample_f64(double s, double t, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    double sine, cosine;
    sf_sincos_2pi_f64(s, &sine, &cosine);
    out[0] = t * cosine;
    out[1] = t * sine;
}
SF_INLINE double sf_disk_naive_pdf_f64(const double x[2]) {
    double square = x[0] * x[0] + x[1] * x[1];
    return square <= 1.0 + 0x1p-20 ? 1.0 / (2.0 * SF_PI * sqrt(square)) : 0.0;
}
SF_INLINE void sf_disk_naive_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_angle_2pi_f64(x[1], x[0]);
    u[1] = sf_unit_clamp_f64(sqrt(x[0] * x[0] + x[1] * x[1]));
}

SF_INLINE void sf_annulus_sample_f64(double s, double t, double inner, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    assert(inner >= 0.0 && inner <= 1.0);
    double sine, cosine, radius = sqrt(inner * inner + t * ((1.0 - inner) * (1.0 + inner)));
    sf_sincos_2pi_f64(s, &sine, &cosine);
    out[0] = radius * cosine;
    out[1] = radius * sine;
}

SF_INLINE double sf_annulus_pdf_f64(const double x[2], double inner) {
    double square = x[0] * x[0] + x[1] * x[1], least = inner * inner;
    int within = (square <= 1.0 + 0x1p-20) & (square >= least - 0x1p-20 * least);
    return within ? 1.0 / (SF_PI * ((1.0 - inner) * (1.0 + inner))) : 0.0;
}

SF_INLINE void sf_annulus_invert_f64(const double x[2], double inner, double u[2]) {
    double width = (1.0 - inner) * (1.0 + inner), square = x[0] * x[0] + x[1] * x[1];
    u[0] = sf_angle_2pi_f64(x[1], x[0]);
    u[1] = sf_unit_clamp_f64((square - inner * inner) / (width > 0.0 ? width : 1.0));
}

SF_INLINE void sf_polygon_blade_f64(double blade, double sides, double middle[2], double half[2]) {
    sf_sincos_2pi_f64((blade + 0.5) / sides, &middle[0], &middle[1]);
    sf_sincos_2pi_f64(0.5 / sides, &half[0], &half[1]);
}

SF_INLINE void sf_regular_polygon_sample_f64(double s, double t, double sides, double out[2]) {
    SF_ASSERT_UNIT(s, t);
    assert(sides >= 3.0 && sides <= 1024.0);
    double scaled = s * sides, blade = (double)(int32_t)scaled, middle[2], half[2], radius = sqrt(t);
    blade = blade < sides - 1.0 ? blade : sides - 1.0;
    sf_polygon_blade_f64(blade, sides, middle, half);
    double across = (2.0 * (scaled - blade) - 1.0) * half[0];
    out[0] = radius * (half[1] * middle[1] - across * middle[0]);
    out[1] = radius * (half[1] * middle[0] + across * middle[1]);
}

SF_INLINE double sf_polygon_find_f64(const double x[2], double sides, double half[2], double *along, double *across) {
    double blade = (double)(int32_t)(sf_angle_2pi_f64(x[1], x[0]) * sides), middle[2];
    blade = blade < sides - 1.0 ? blade : sides - 1.0;
    sf_polygon_blade_f64(blade, sides, middle, half);
    *along = x[0] * middle[1] + x[1] * middle[0];
    *across = x[1] * middle[1] - x[0] * middle[0];
    return blade;
}

SF_INLINE double sf_regular_polygon_pdf_f64(const double x[2], double sides) {
    double half[2], along, across;
    (void)sf_polygon_find_f64(x, sides, half, &along, &across);
    return along <= half[1] * (1.0 + 0x1p-20) ? 1.0 / (sides * (half[0] * half[1])) : 0.0;
}

SF_INLINE void sf_regular_polygon_invert_f64(const double x[2], double sides, double u[2]) {
    double half[2], along, across, blade = sf_polygon_find_f64(x, sides, half, &along, &across);
    double radius = along / half[1], width = radius * half[0];
    double place = sf_unit_clamp_f64(0.5 + 0.5 * (across / (width > 0.0 ? width : 1.0)));
    u[0] = sf_unit_clamp_f64((blade + place) / sides);
    u[1] = sf_unit_clamp_f64(radius > 0.0 ? radius * radius : 0.0);
}

/* ---- mapping_sphere.h ---- */

SF_INLINE void sf_direction_f64(double s, double ring, double z, double w[3]) {
    double sine, cosine;
    sf_sincos_2pi_f64(s, &sine, &cosine);
    w[0] = ring * cosine;
    w[1] = ring * sine;
    w[2] = z;
}

SF_INLINE void sf_sphere_sample_f64(double s, double t, double w[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_direction_f64(s, 2.0 * sqrt(t * (1.0 - t)), 1.0 - 2.0 * t, w);
}
SF_INLINE double sf_sphere_pdf_f64(const double w[3]) {
    (void)w;
    return 0.25 / SF_PI;
}
SF_INLINE void sf_sphere_invert_f64(const double w[3], double u[2]) {
    double square = w[0] * w[0] + w[1] * w[1], z = fabs(w[2]), near = 0.5 * square / (1.0 + z);
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(w[2] > 0.0 ? near : 1.0 - near);
}

SF_INLINE void sf_hemisphere_sample_f64(double s, double t, double w[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_direction_f64(s, sqrt((1.0 - t) * (1.0 + t)), t, w);
}
SF_INLINE double sf_hemisphere_pdf_f64(const double w[3]) { return w[2] >= 0.0 ? 0.5 / SF_PI : 0.0; }
SF_INLINE void sf_hemisphere_invert_f64(const double w[3], double u[2]) {
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(w[2]);
}

SF_INLINE void sf_cosine_hemisphere_sample_f64(double s, double t, double w[3]) {
    SF_ASSERT_UNIT(s, t);
    sf_direction_f64(s, sqrt(1.0 - t), sqrt(t), w);
}
SF_INLINE double sf_cosine_hemisphere_pdf_f64(const double w[3]) { return w[2] > 0.0 ? w[2] * (1.0 / SF_PI) : 0.0; }
SF_INLINE void sf_cosine_hemisphere_invert_f64(const double w[3], double u[2]) {
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(w[2] > 0.0 ? w[2] * w[2] : 0.0);
}

SF_INLINE void sf_cosine_hemisphere_concentric_sample_f64(double s, double t, double w[3]) {
    sf_disk_concentric_sample_f64(s, t, w);
    double ds = s < 0.5 ? s : 1.0 - s, dt = t < 0.5 ? t : 1.0 - t, rest = 2.0 * (ds < dt ? ds : dt);
    w[2] = sqrt(rest * (2.0 - rest));
}
SF_INLINE double sf_cosine_hemisphere_concentric_pdf_f64(const double w[3]) { return sf_cosine_hemisphere_pdf_f64(w); }
SF_INLINE void sf_cosine_hemisphere_concentric_invert_f64(const double w[3], double u[2]) { sf_disk_concentric_invert_f64(w, u); }

SF_INLINE double sf_cone_height_f64(double angle) {
    double sine, cosine;
    sf_sincos_2pi_f64(angle * (0.25 / SF_PI), &sine, &cosine);
    return 2.0 * (sine * sine);
}

SF_INLINE double sf_cone_height_of_sphere_f64(double radius, double distance) {
    double sine = radius / distance;
    return sine * sine / (1.0 + sqrt((1.0 - sine) * (1.0 + sine)));
}

SF_INLINE void sf_cone_cap_sample_f64(double s, double t, double height, double w[3]) {
    double depth = t * height;
    sf_direction_f64(s, sqrt(depth * (2.0 - depth)), 1.0 - depth, w);
}

SF_INLINE double sf_depth_f64(const double w[3]) {
    double square = w[0] * w[0] + w[1] * w[1];
    return w[2] > 0.0 ? square / (1.0 + w[2]) : 1.0 - w[2];
}

SF_INLINE void sf_cone_sample_f64(double s, double t, double angle, double w[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(angle >= 0.0 && angle <= 3.1415928);
    sf_cone_cap_sample_f64(s, t, sf_cone_height_f64(angle), w);
}

SF_INLINE double sf_cone_pdf_f64(const double w[3], double angle) {
    double height = sf_cone_height_f64(angle);
    return sf_depth_f64(w) <= height * (1.0 + 0x1p-20) ? 0.5 / (SF_PI * height) : 0.0;
}
SF_INLINE void sf_cone_invert_f64(const double w[3], double angle, double u[2]) {
    double height = sf_cone_height_f64(angle);
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(sf_depth_f64(w) / (height > 0.0 ? height : 1.0));
}

SF_INLINE void sf_frame_from_normal_f64(const double n[3], double tangent[3], double bitangent[3]) {
    double sign = copysign(1.0, n[2]), a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
    tangent[0] = 1.0 + sign * (n[0] * n[0] * a);
    tangent[1] = sign * b;
    tangent[2] = -sign * n[0];
    bitangent[0] = b;
    bitangent[1] = sign + n[1] * n[1] * a;
    bitangent[2] = -n[1];
}

SF_INLINE void sf_frame_to_world_f64(const double tangent[3], const double bitangent[3], const double normal[3],
                                 const double local[3], double world[3]) {
    for (int k = 0; k < 3; ++k) world[k] = (local[0] * tangent[k] + local[1] * bitangent[k]) + local[2] * normal[k];
}

/* ---- mapping_lobe.h ---- */

SF_INLINE double sf_log_cosine_f64(const double w[3]) {
    double square = w[0] * w[0] + w[1] * w[1];
    double wide = sf_log_f64(w[2] > 0x1p-126 ? w[2] : 0x1p-126), narrow = 0.5 * sf_log1m_f64(square < 0.5 ? square : 0.5);
    return square < 0.5 ? narrow : wide;
}

SF_INLINE void sf_power_cosine_sample_f64(double s, double t, double exponent, double w[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(exponent >= 0.0 && exponent <= 1e6);
    double log_z = sf_log1m_f64(t) / (exponent + 1.0);
    sf_direction_f64(s, sqrt(-sf_expm1_f64(2.0 * log_z)), sf_exp_f64(log_z), w);
}

SF_INLINE double sf_power_cosine_pdf_f64(const double w[3], double exponent) {
    double above = w[2] > 0.0 ? 0.5 / SF_PI : 0.0;
    return above * (exponent + 1.0) * sf_exp_f64(exponent * sf_log_cosine_f64(w));
}
SF_INLINE void sf_power_cosine_invert_f64(const double w[3], double exponent, double u[2]) {
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(-sf_expm1_f64((exponent + 1.0) * sf_log_cosine_f64(w)));
}

SF_INLINE void sf_henyey_greenstein_sample_f64(double s, double t, double g, double w[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(g >= -0.9999 && g <= 0.9999);
    double rest = 1.0 - t, size = fabs(g), d = (1.0 - size) + 2.0 * size * (g > 0.0 ? rest : t), over = 1.0 / d;
    double below = ((1.0 - g) * over) * ((1.0 - g) * over) * (2.0 * t * (1.0 + g * rest));
    double above = ((1.0 + g) * over) * ((1.0 + g) * over) * (2.0 * rest * (1.0 - g * t));
    double depth = below < above ? below : above, z = 1.0 - depth;
    sf_direction_f64(s, sqrt(depth * (2.0 - depth)), below < above ? z : -z, w);
}

SF_INLINE double sf_henyey_greenstein_square_f64(const double w[3], double g, double *depth) {
    const double turned[3] = {w[0], w[1], g < 0.0 ? -w[2] : w[2]};
    double size = fabs(g);
    *depth = sf_depth_f64(turned);
    return (1.0 - size) * (1.0 - size) + 2.0 * size * *depth;
}

SF_INLINE double sf_henyey_greenstein_pdf_f64(const double w[3], double g) {
    double depth, square = sf_henyey_greenstein_square_f64(w, g, &depth);
    return (1.0 - g) * (1.0 + g) * (0.25 / SF_PI) / (square * sqrt(square));
}
SF_INLINE void sf_henyey_greenstein_invert_f64(const double w[3], double g, double u[2]) {
    double depth, root = sqrt(sf_henyey_greenstein_square_f64(w, g, &depth)), size = fabs(g);
    double t = (1.0 + size) * depth / (root * (root + (1.0 - size)));
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(g < 0.0 ? 1.0 - t : t);
}

SF_INLINE double sf_ggx_normals_f64(const double h[3], double alpha_x, double alpha_y) {
    double x = h[0] / alpha_x, y = h[1] / alpha_y, k = x * x + y * y + h[2] * h[2];
    return h[2] > 0.0 ? 1.0 / (SF_PI * alpha_x * alpha_y * (k * k)) : 0.0;
}

SF_INLINE double sf_ggx_stretch_f64(const double w[3], double alpha_x, double alpha_y) {
    double x = alpha_x * w[0], y = alpha_y * w[1];
    return sqrt(x * x + y * y + w[2] * w[2]);
}

SF_INLINE double sf_ggx_masking_f64(const double w[3], double alpha_x, double alpha_y) {
    double z = w[2] > 0.0 ? w[2] : 0.0;
    return z > 0.0 ? 2.0 * z / (z + sf_ggx_stretch_f64(w, alpha_x, alpha_y)) : 0.0;
}

SF_INLINE double sf_ggx_masking_shadowing_f64(const double w[3], const double v[3], double alpha_x, double alpha_y) {
    double a = v[2] * sf_ggx_stretch_f64(w, alpha_x, alpha_y), b = w[2] * sf_ggx_stretch_f64(v, alpha_x, alpha_y);
    return ((w[2] > 0.0) & (v[2] > 0.0)) ? 2.0 * w[2] * v[2] / (a + b) : 0.0;
}

SF_INLINE void sf_ggx_visible_normals_sample_f64(double s, double t, const double w[3], double alpha_x, double alpha_y,
                                             double h[3]) {
    SF_ASSERT_UNIT(s, t);
    assert(alpha_x >= 1e-4 && alpha_x <= 10.0 && alpha_y >= 1e-4 && alpha_y <= 10.0);
    double over = 1.0 / sf_ggx_stretch_f64(w, alpha_x, alpha_y), z = over * w[2], cap[3];
    double height = 1.0 + z;
    sf_cone_cap_sample_f64(s, t, height, cap);
    h[0] = alpha_x * (cap[0] + over * alpha_x * w[0]);
    h[1] = alpha_y * (cap[1] + over * alpha_y * w[1]);
    h[2] = (1.0 - t) * height;
    double scale = 1.0 / sqrt((h[0] * h[0] + h[1] * h[1]) + h[2] * h[2]);
    for (int k = 0; k < 3; ++k) h[k] *= scale;
}

SF_INLINE double sf_ggx_visible_normals_pdf_f64(const double h[3], const double w[3], double alpha_x, double alpha_y) {
    double facing = sf_dot3_f64(w, h);
    double over = 2.0 / (w[2] + sf_ggx_stretch_f64(w, alpha_x, alpha_y));
    return facing > 0.0 ? facing * over * sf_ggx_normals_f64(h, alpha_x, alpha_y) : 0.0;
}
SF_INLINE void sf_ggx_visible_normals_invert_f64(const double h[3], const double w[3], double alpha_x, double alpha_y,
                                             double u[2]) {
    double over = 1.0 / sf_ggx_stretch_f64(w, alpha_x, alpha_y);
    const double from[3] = {over * alpha_x * w[0], over * alpha_y * w[1], over * w[2]};
    const double half[3] = {h[0] / alpha_x, h[1] / alpha_y, h[2]};
    double square = sf_dot3_f64(half, half), scale = 2.0 * sf_dot3_f64(from, half) / (square > 0.0 ? square : 1.0);
    double height = 1.0 + from[2];
    u[0] = sf_angle_2pi_f64(scale * half[1] - from[1], scale * half[0] - from[0]);
    u[1] = sf_unit_clamp_f64(1.0 - scale * half[2] / (height > 0.0 ? height : 1.0));
}

/* ---- mapping_light.h ---- */

SF_INLINE void sf_unit_direction_f64(const double v[3], double out[3]) {
    double square = sf_dot3_f64(v, v), scale = square > 0.0 ? 1.0 / sqrt(square) : 0.0;
    out[0] = v[0] * scale;
    out[1] = v[1] * scale;
    out[2] = square > 0.0 ? v[2] * scale : 1.0;
}

typedef struct sf_spherical_triangle_f64 {
    double a[3], b[3];
    double tangent[3];
    double side[3];
    double base[3];
    double volume;
    double edge, corner;
    double across;
    double share, rest;
} sf_spherical_triangle_f64;

SF_INLINE double sf_one_plus_f64(double cosine, const double sine[3]) {
    return cosine < 0.0 ? sf_dot3_f64(sine, sine) / (1.0 - cosine) : 1.0 + cosine;
}

SF_INLINE void sf_spherical_triangle_init_f64(sf_spherical_triangle_f64 *triangle, const double a[3], const double b[3],
                                          const double c[3], const double origin[3]) {
    double p[3], q[3], r[3], pq[3], pr[3], base[3], side[3], direction_c[3];
    for (int k = 0; k < 3; ++k) {
        p[k] = a[k] - origin[k];
        q[k] = b[k] - origin[k];
        r[k] = c[k] - origin[k];
        pq[k] = b[k] - a[k];
        pr[k] = c[k] - a[k];
    }
    double pp = sf_dot3_f64(p, p), qq = sf_dot3_f64(q, q), rr = sf_dot3_f64(r, r);
    double inv_p = pp > 0.0 ? 1.0 / sqrt(pp) : 0.0, inv_q = qq > 0.0 ? 1.0 / sqrt(qq) : 0.0;
    double inv_r = rr > 0.0 ? 1.0 / sqrt(rr) : 0.0;
    sf_cross3_f64(p, pq, base);
    sf_cross3_f64(pr, p, side);
    double volume = sf_dot3_f64(base, pr) * inv_p * inv_q * inv_r, turn = copysign(1.0, volume);
    for (int k = 0; k < 3; ++k) {
        triangle->a[k] = p[k] * inv_p;
        triangle->b[k] = q[k] * inv_q;
        direction_c[k] = r[k] * inv_r;
        triangle->base[k] = base[k] * (turn * inv_p * inv_q);
        side[k] *= inv_p * inv_r;
        triangle->side[k] = side[k] * turn;
    }
    sf_cross3_f64(triangle->a, side, triangle->tangent);
    triangle->volume = fabs(volume);
    triangle->edge = sf_one_plus_f64(sf_dot3_f64(triangle->a, triangle->b), triangle->base);
    triangle->corner = sf_one_plus_f64(sf_dot3_f64(triangle->a, direction_c), side);
    double level = triangle->edge + (sf_dot3_f64(triangle->a, direction_c) + sf_dot3_f64(triangle->b, direction_c));
    triangle->across = sqrt(volume * volume + level * level);
    triangle->share = sf_angle_2pi_f64(triangle->volume, level);
    triangle->rest = sf_angle_2pi_f64(triangle->volume, -level);
}

SF_INLINE double sf_sine_of_lesser_f64(double a, double b) {
    double sine, cosine;
    sf_sincos_2pi_f64(a < b ? a : b, &sine, &cosine);
    return sine;
}

SF_INLINE void sf_spherical_triangle_draw_f64(const sf_spherical_triangle_f64 *triangle, double s, double t, double w[3]) {
    const double *a = triangle->a, *b = triangle->b, *tangent = triangle->tangent;
    double sum[3], gap[3], cut = s * triangle->share, left = (1.0 - s) * triangle->share;
    double sine_cut = sf_sine_of_lesser_f64(cut, triangle->rest + left),
          sine_left = sf_sine_of_lesser_f64(left, triangle->rest + cut);
    double scale = sine_cut + sine_left, over = 1.0 / (scale > 0.0 ? scale : 1.0);
    double up = triangle->edge * sine_cut * over, along = triangle->across * (sine_left * over) + triangle->corner * up;
    double rise = up * up * sf_dot3_f64(tangent, tangent), square = along * along + rise,
          inverse = 1.0 / (square > 0.0 ? square : 1.0);
    double turn_a = square > 0.0 ? (along * along - rise) * inverse : 1.0, turn_t = 2.0 * along * up * inverse;
    for (int k = 0; k < 3; ++k) {
        double d = turn_a * a[k] + turn_t * tangent[k];
        gap[k] = d - b[k];
        sum[k] = d + b[k];
    }
    double drop = 0.5 * sf_dot3_f64(gap, gap), rest = 0.5 * sf_dot3_f64(sum, sum);
    double out = sqrt(t * ((2.0 - t * drop) / (rest > 0.0 ? rest : 1.0)));
    for (int k = 0; k < 3; ++k) gap[k] = ((1.0 - t * drop) - out * rest) * b[k] + out * sum[k];
    sf_unit_direction_f64(gap, w);
}

SF_INLINE void sf_spherical_triangle_find_f64(const sf_spherical_triangle_f64 *triangle, const double w[3], double u[2]) {
    const double *a = triangle->a, *b = triangle->b;
    double step[3], d[3], gap[3], from_a[3];
    for (int k = 0; k < 3; ++k) step[k] = w[k] - b[k];
    double fall = -sf_dot3_f64(triangle->side, step);
    for (int k = 0; k < 3; ++k) d[k] = fall * b[k] + triangle->volume * step[k];
    double square = sf_dot3_f64(d, d), scale = square > 0.0 ? 1.0 / sqrt(square) : 0.0;
    for (int k = 0; k < 3; ++k) {
        d[k] = square > 0.0 ? d[k] * scale : a[k];
        gap[k] = d[k] - b[k];
        from_a[k] = d[k] - a[k];
    }
    double volume = fabs(sf_dot3_f64(triangle->base, from_a)), drop = sf_dot3_f64(gap, gap);
    double share = sf_angle_2pi_f64(volume, triangle->edge + (sf_dot3_f64(a, d) + sf_dot3_f64(b, d)));
    u[0] = sf_unit_clamp_f64(share / (triangle->share > 0.0 ? triangle->share : 1.0));
    u[1] = sf_unit_clamp_f64(sf_dot3_f64(step, step) / (drop > 0.0 ? drop : 1.0));
}

SF_INLINE void sf_spherical_triangle_sample_f64(double s, double t, const double a[3], const double b[3], const double c[3],
                                            const double origin[3], double w[3]) {
    sf_spherical_triangle_f64 triangle;
    SF_ASSERT_UNIT(s, t);
    sf_spherical_triangle_init_f64(&triangle, a, b, c, origin);
    sf_spherical_triangle_draw_f64(&triangle, s, t, w);
}
SF_INLINE double sf_spherical_triangle_pdf_f64(const double w[3], const double a[3], const double b[3], const double c[3],
                                          const double origin[3]) {
    sf_spherical_triangle_f64 triangle;
    (void)w;
    sf_spherical_triangle_init_f64(&triangle, a, b, c, origin);
    return 0.25 / (SF_PI * triangle.share);
}
SF_INLINE void sf_spherical_triangle_invert_f64(const double w[3], const double a[3], const double b[3], const double c[3],
                                            const double origin[3], double u[2]) {
    sf_spherical_triangle_f64 triangle;
    sf_spherical_triangle_init_f64(&triangle, a, b, c, origin);
    sf_spherical_triangle_find_f64(&triangle, w, u);
}

typedef struct sf_spherical_rectangle_f64 {
    double x[3], y[3], z[3];
    double x0, x1, y0, y1, near;
    double g0, g1;
    double before, after;
    double share;
} sf_spherical_rectangle_f64;

SF_INLINE double sf_rectangle_share_f64(double x0, double x1, double width, double y0, double y1, double height, double near) {
    double yy = y0 * y1, zz = near * near;
    double r00 = sqrt(x0 * x0 + y0 * y0 + zz), r10 = sqrt(x1 * x1 + y0 * y0 + zz);
    double r01 = sqrt(x0 * x0 + y1 * y1 + zz), r11 = sqrt(x1 * x1 + y1 * y1 + zz);
    double across = x0 * x1 + yy + zz;
    double n1 = r00 * r10 * r11 + (x0 * x1 + y0 * y0 + zz) * r11 + (x1 * x1 + yy + zz) * r00 + across * r10;
    double n2 = r00 * r11 * r01 + across * r01 + (x0 * x1 + y1 * y1 + zz) * r00 + (x0 * x0 + yy + zz) * r11;
    double det = near * (width * height);
    return sf_angle_2pi_f64(det * (n1 + n2), n1 * n2 - det * det);
}

SF_INLINE double sf_strip_share_f64(double x, double y0, double y1, double height, double near) {
    double q0 = y0 * y0 + near * near, q1 = y1 * y1 + near * near, ax = fabs(x);
    double far0 = sqrt(x * x + q0) + ax, far1 = sqrt(x * x + q1) + ax;
    double g0 = x < 0.0 ? q0 / (far0 > 0.0 ? far0 : 1.0) : far0,
          g1 = x < 0.0 ? q1 / (far1 > 0.0 ? far1 : 1.0) : far1;
    return sf_angle_2pi_f64(near * height, g0 * g1 + y0 * y1 + near * near);
}
SF_INLINE double sf_clamp_between_f64(double x, double low, double high) {
    x = x > low ? x : low;
    return x < high ? x : high;
}

SF_INLINE void sf_spherical_rectangle_init_f64(sf_spherical_rectangle_f64 *rectangle, const double a[3], const double b[3],
                                           const double c[3], const double origin[3]) {
    double ex[3], ey[3], d[3], normal[3], spare[3], other[3];
    for (int k = 0; k < 3; ++k) {
        ex[k] = b[k] - a[k];
        ey[k] = c[k] - a[k];
        d[k] = a[k] - origin[k];
    }
    sf_unit_direction_f64(ex, rectangle->x);
    sf_cross3_f64(rectangle->x, ey, normal);
    sf_frame_from_normal_f64(rectangle->x, spare, other);
    int flat = !(sf_dot3_f64(normal, normal) > 0.0);
    for (int k = 0; k < 3; ++k) normal[k] = flat ? spare[k] : normal[k];
    sf_unit_direction_f64(normal, rectangle->z);
    sf_cross3_f64(rectangle->z, rectangle->x, rectangle->y);
    double near = sf_dot3_f64(d, rectangle->z), x0 = sf_dot3_f64(d, rectangle->x), y0 = sf_dot3_f64(d, rectangle->y);
    double width = sf_dot3_f64(ex, rectangle->x), height = sf_dot3_f64(ey, rectangle->y), turn = copysign(1.0, near);
    double x1 = x0 + width, y1 = y0 + height;
    double wide = fabs(x0) > fabs(x1) ? fabs(x0) : fabs(x1), high = fabs(y0) > fabs(y1) ? fabs(y0) : fabs(y1);
    double largest = wide > high ? wide : high;
    largest = largest > fabs(near) ? largest : fabs(near);
    double scale = 1.0 / (largest > 0.0 ? largest : 1.0);
    for (int k = 0; k < 3; ++k) rectangle->z[k] *= turn;
    rectangle->near = near = fabs(near) * scale;
    rectangle->x0 = x0 *= scale;
    rectangle->x1 = x1 *= scale;
    rectangle->y0 = y0 *= scale;
    rectangle->y1 = y1 *= scale;
    rectangle->g0 = sf_angle_2pi_f64(near, -y0);
    rectangle->g1 = sf_angle_2pi_f64(near, y1);
    rectangle->before = sf_strip_share_f64(-x0, y0, y1, height * scale, near);
    rectangle->after = sf_strip_share_f64(x1, y0, y1, height * scale, near);
    double share = sf_rectangle_share_f64(x0, x1, width * scale, y0, y1, height * scale, near);
    double within = ((x0 * x1 < 0.0) & (y0 * y1 < 0.0)) ? 0.5 : 0.0;
    rectangle->share = near > 0.0 ? share : within;
}

SF_INLINE double sf_spherical_rectangle_sweep_f64(const sf_spherical_rectangle_f64 *r, double s) {
    double p = r->before + s * r->share, q = r->after + (1.0 - s) * r->share, edges = r->g0 + r->g1;
    double lesser = p < q ? p : q, difference = p < q ? q - p : p - q;
    double product = sf_sine_of_lesser_f64(p, edges + q) * sf_sine_of_lesser_f64(q, edges + p) *
                    (sf_sine_of_lesser_f64(r->g0 + q, r->g1 + p) * sf_sine_of_lesser_f64(r->g1 + q, r->g0 + p));
    double across = r->near * sf_sine_of_lesser_f64(difference, edges + 2.0 * lesser);
    double x = across / (product > 0.0 ? 2.0 * sqrt(product) : 0x1p-60);
    return sf_clamp_between_f64(copysign(x, p - q), r->x0, r->x1);
}
SF_INLINE void sf_spherical_rectangle_draw_f64(const sf_spherical_rectangle_f64 *r, double s, double t, double w[3]) {
    double x = sf_spherical_rectangle_sweep_f64(r, s), square = x * x + r->near * r->near;
    double d0 = sqrt(square + r->y0 * r->y0), d1 = sqrt(square + r->y1 * r->y1);
    double low0 = square / (d0 * (d0 + fabs(r->y0)) + 0x1p-120),
          low1 = square / (d1 * (d1 + fabs(r->y1)) + 0x1p-120);
    double less0 = r->y0 > 0.0 ? low0 : 2.0 - low0, less1 = r->y1 > 0.0 ? low1 : 2.0 - low1;
    double more0 = r->y0 > 0.0 ? 2.0 - low0 : low0, more1 = r->y1 > 0.0 ? 2.0 - low1 : low1;
    double less = (1.0 - t) * less0 + t * less1, more = (1.0 - t) * more0 + t * more1;
    double h = more < 1.0 ? more - 1.0 : 1.0 - less, ring = sqrt(less * more), root = sqrt(square);
    double along = root > 0.0 ? ring / root : 0.0, wx = x * along, wz = root > 0.0 ? r->near * along : ring;
    for (int k = 0; k < 3; ++k) w[k] = (wx * r->x[k] + h * r->y[k]) + wz * r->z[k];
}
SF_INLINE void sf_spherical_rectangle_find_f64(const sf_spherical_rectangle_f64 *r, const double w[3], double u[2]) {
    double wx = sf_dot3_f64(w, r->x), wy = sf_dot3_f64(w, r->y), wz = sf_dot3_f64(w, r->z);
    double x = sf_clamp_between_f64(r->near * wx / (wz > 0.0 ? wz : 0x1p-60), r->x0, r->x1),
          square = x * x + r->near * r->near;
    double h0 = r->y0 / sqrt(square + r->y0 * r->y0 + 0x1p-100),
          h1 = r->y1 / sqrt(square + r->y1 * r->y1 + 0x1p-100);
    double part = sf_rectangle_share_f64(r->x0, x, x - r->x0, r->y0, r->y1, r->y1 - r->y0, r->near);
    u[0] = sf_unit_clamp_f64(part / (r->share > 0.0 ? r->share : 1.0));
    u[1] = sf_unit_clamp_f64((wy - h0) / (h1 > h0 ? h1 - h0 : 1.0));
}

SF_INLINE void sf_spherical_rectangle_sample_f64(double s, double t, const double a[3], const double b[3], const double c[3],
                                             const double origin[3], double w[3]) {
    sf_spherical_rectangle_f64 rectangle;
    SF_ASSERT_UNIT(s, t);
    sf_spherical_rectangle_init_f64(&rectangle, a, b, c, origin);
    sf_spherical_rectangle_draw_f64(&rectangle, s, t, w);
}
SF_INLINE double sf_spherical_rectangle_pdf_f64(const double w[3], const double a[3], const double b[3], const double c[3],
                                           const double origin[3]) {
    sf_spherical_rectangle_f64 rectangle;
    (void)w;
    sf_spherical_rectangle_init_f64(&rectangle, a, b, c, origin);
    return 0.25 / (SF_PI * rectangle.share);
}
SF_INLINE void sf_spherical_rectangle_invert_f64(const double w[3], const double a[3], const double b[3], const double c[3],
                                             const double origin[3], double u[2]) {
    sf_spherical_rectangle_f64 rectangle;
    sf_spherical_rectangle_init_f64(&rectangle, a, b, c, origin);
    sf_spherical_rectangle_find_f64(&rectangle, w, u);
}

#endif
