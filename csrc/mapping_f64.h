// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Made by make_mapping_f64.py from mapping_plane.h and mapping_sphere.h: do not edit.
 * The same formulas in double, for the bulk calls; the comments are there. */
#ifndef SUNFLECK_MAPPING_F64_H
#define SUNFLECK_MAPPING_F64_H

#include "elementary_f64.h"

/* ---- mapping_plane.h ---- */

static inline void sf_pixel_box_sample_f64(double s, double t, double out[2]) {
    out[0] = s;
    out[1] = t;
}
static inline double sf_pixel_box_pdf_f64(const double x[2]) {
    return (x[0] >= 0.0) & (x[0] < 1.0) & (x[1] >= 0.0) & (x[1] < 1.0) ? 1.0 : 0.0;
}
static inline void sf_pixel_box_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_unit_clamp_f64(x[0]);
    u[1] = sf_unit_clamp_f64(x[1]);
}

static inline double sf_tent_sample_f64(double s) {
    double rising = -0.5 + sqrt(2.0 * s), falling = 1.5 - sqrt(2.0 - 2.0 * s);
    return s < 0.5 ? rising : falling;
}
static inline double sf_tent_pdf_f64(double x) {
    double height = 1.0 - fabs(x - 0.5);
    return height > 0.0 ? height : 0.0;
}
static inline double sf_tent_invert_f64(double x) {
    double left = x + 0.5, right = 1.5 - x;
    left = left > 0.0 ? left : 0.0;
    right = right > 0.0 ? right : 0.0;
    return sf_unit_clamp_f64(x < 0.5 ? 0.5 * left * left : 1.0 - 0.5 * right * right);
}
static inline void sf_pixel_tent_sample_f64(double s, double t, double out[2]) {
    out[0] = sf_tent_sample_f64(s);
    out[1] = sf_tent_sample_f64(t);
}
static inline double sf_pixel_tent_pdf_f64(const double x[2]) { return sf_tent_pdf_f64(x[0]) * sf_tent_pdf_f64(x[1]); }
static inline void sf_pixel_tent_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_tent_invert_f64(x[0]);
    u[1] = sf_tent_invert_f64(x[1]);
}

static inline void sf_pixel_gaussian_sample_f64(double s, double t, double mu, double out[2]) {
    double sine, cosine, a = mu * sqrt(-2.0 * sf_log1m_f64(s));
    sf_sincos_2pi_f64(t, &sine, &cosine);
    out[0] = 0.5 + a * sine;
    out[1] = 0.5 + a * cosine;
}
static inline double sf_pixel_gaussian_pdf_f64(const double x[2], double mu) {
    double dx = (x[0] - 0.5) / mu, dy = (x[1] - 0.5) / mu;
    return sf_exp_f64(-0.5 * (dx * dx + dy * dy)) / (2.0 * SF_PI * (mu * mu));
}
static inline void sf_pixel_gaussian_invert_f64(const double x[2], double mu, double u[2]) {
    double dx = (x[0] - 0.5) / mu, dy = (x[1] - 0.5) / mu;
    u[0] = sf_unit_clamp_f64(-sf_expm1_f64(-0.5 * (dx * dx + dy * dy)));
    u[1] = sf_angle_2pi_f64(dx, dy);
}

static inline void sf_cross3_f64(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}
static inline double sf_dot3_f64(const double a[3], const double b[3]) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static inline void sf_triangle_point_f64(double alpha, double beta, const double a[3], const double b[3], const double c[3],
                                     double out[3]) {
    out[0] = a[0] + (alpha * (b[0] - a[0]) + beta * (c[0] - a[0]));
    out[1] = a[1] + (alpha * (b[1] - a[1]) + beta * (c[1] - a[1]));
    out[2] = a[2] + (alpha * (b[2] - a[2]) + beta * (c[2] - a[2]));
}

static inline void sf_triangle_coordinates_f64(const double x[3], const double a[3], const double b[3], const double c[3],
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

static inline void sf_triangle_sample_f64(double s, double t, const double a[3], const double b[3], const double c[3],
                                      double out[3]) {
    double root = sqrt(s);
    sf_triangle_point_f64(root * t, 1.0 - root, a, b, c, out);
}

static inline double sf_triangle_pdf_f64(const double x[3], const double a[3], const double b[3], const double c[3]) {
    double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]}, n[3];
    (void)x;
    sf_cross3_f64(e, f, n);
    return 2.0 / sqrt(sf_dot3_f64(n, n));
}

static inline void sf_triangle_invert_f64(const double x[3], const double a[3], const double b[3], const double c[3],
                                      double u[2]) {
    double alpha, beta;
    sf_triangle_coordinates_f64(x, a, b, c, &alpha, &beta);
    double root = 1.0 - beta;
    u[0] = sf_unit_clamp_f64(root * root);
    u[1] = sf_unit_clamp_f64(alpha / (root > 0.0 ? root : 1.0));
}

static inline double sf_disk_pdf_f64(const double x[2]) {
    return x[0] * x[0] + x[1] * x[1] <= 1.0 + 0x1p-20 ? 1.0 / SF_PI : 0.0;
}

static inline void sf_disk_polar_sample_f64(double s, double t, double out[2]) {
    double sine, cosine, radius = sqrt(t);
    sf_sincos_2pi_f64(s, &sine, &cosine);
    out[0] = radius * cosine;
    out[1] = radius * sine;
}
static inline double sf_disk_polar_pdf_f64(const double x[2]) { return sf_disk_pdf_f64(x); }
static inline void sf_disk_polar_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_angle_2pi_f64(x[1], x[0]);
    u[1] = sf_unit_clamp_f64(x[0] * x[0] + x[1] * x[1]);
}

static inline void sf_disk_concentric_sample_f64(double s, double t, double out[2]) {
    double a = 2.0 * s - 1.0, b = 2.0 * t - 1.0, sine, cosine;
    int upright = fabs(b) > fabs(a);
    double radius = upright ? b : a, other = upright ? a : b;
    sf_sincos_2pi_octant_f64(0.125 * (other / (radius != 0.0 ? radius : 1.0)), &sine, &cosine);
    out[0] = radius * (upright ? sine : cosine);
    out[1] = radius * (upright ? cosine : sine);
}
static inline double sf_disk_concentric_pdf_f64(const double x[2]) { return sf_disk_pdf_f64(x); }
static inline void sf_disk_concentric_invert_f64(const double x[2], double u[2]) {
    int upright = fabs(x[1]) > fabs(x[0]);
    double major = upright ? x[1] : x[0], minor = upright ? x[0] : x[1];
    double length = sqrt(x[0] * x[0] + x[1] * x[1]), angle = sf_atan_turns_f64(fabs(minor), fabs(major));
    double radius = copysign(length, major), other = copysign(length * (8.0 * angle), minor);
    u[0] = sf_unit_clamp_f64(0.5 + 0.5 * (upright ? other : radius));
    u[1] = sf_unit_clamp_f64(0.5 + 0.5 * (upright ? radius : other));
}

static inline void sf_disk_naive_sample_f64(double s, double t, double out[2]) {
    double sine, cosine;
    sf_sincos_2pi_f64(s, &sine, &cosine);
    out[0] = t * cosine;
    out[1] = t * sine;
}
static inline double sf_disk_naive_pdf_f64(const double x[2]) {
    double square = x[0] * x[0] + x[1] * x[1];
    return square <= 1.0 + 0x1p-20 ? 1.0 / (2.0 * SF_PI * sqrt(square)) : 0.0;
}
static inline void sf_disk_naive_invert_f64(const double x[2], double u[2]) {
    u[0] = sf_angle_2pi_f64(x[1], x[0]);
    u[1] = sf_unit_clamp_f64(sqrt(x[0] * x[0] + x[1] * x[1]));
}

/* ---- mapping_sphere.h ---- */

static inline void sf_direction_f64(double s, double ring, double z, double w[3]) {
    double sine, cosine;
    sf_sincos_2pi_f64(s, &sine, &cosine);
    w[0] = ring * cosine;
    w[1] = ring * sine;
    w[2] = z;
}

static inline void sf_sphere_sample_f64(double s, double t, double w[3]) {
    sf_direction_f64(s, 2.0 * sqrt(t * (1.0 - t)), 1.0 - 2.0 * t, w);
}
static inline double sf_sphere_pdf_f64(const double w[3]) {
    (void)w;
    return 0.25 / SF_PI;
}
static inline void sf_sphere_invert_f64(const double w[3], double u[2]) {
    double square = w[0] * w[0] + w[1] * w[1], z = fabs(w[2]), near = 0.5 * square / (1.0 + z);
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(w[2] > 0.0 ? near : 1.0 - near);
}

static inline void sf_hemisphere_sample_f64(double s, double t, double w[3]) {
    sf_direction_f64(s, sqrt((1.0 - t) * (1.0 + t)), t, w);
}
static inline double sf_hemisphere_pdf_f64(const double w[3]) { return w[2] >= 0.0 ? 0.5 / SF_PI : 0.0; }
static inline void sf_hemisphere_invert_f64(const double w[3], double u[2]) {
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(w[2]);
}

static inline void sf_cosine_hemisphere_sample_f64(double s, double t, double w[3]) {
    sf_direction_f64(s, sqrt(1.0 - t), sqrt(t), w);
}
static inline double sf_cosine_hemisphere_pdf_f64(const double w[3]) {
    return w[2] > 0.0 ? w[2] * (1.0 / SF_PI) : 0.0;
}
static inline void sf_cosine_hemisphere_invert_f64(const double w[3], double u[2]) {
    u[0] = sf_angle_2pi_f64(w[1], w[0]);
    u[1] = sf_unit_clamp_f64(w[2] > 0.0 ? w[2] * w[2] : 0.0);
}

static inline void sf_frame_from_normal_f64(const double n[3], double tangent[3], double bitangent[3]) {
    double sign = copysign(1.0, n[2]), a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
    tangent[0] = 1.0 + sign * (n[0] * n[0] * a);
    tangent[1] = sign * b;
    tangent[2] = -sign * n[0];
    bitangent[0] = b;
    bitangent[1] = sign + n[1] * n[1] * a;
    bitangent[2] = -n[1];
}

static inline void sf_frame_to_world_f64(const double tangent[3], const double bitangent[3], const double normal[3],
                                     const double local[3], double world[3]) {
    for (int k = 0; k < 3; ++k)
        world[k] = (local[0] * tangent[k] + local[1] * bitangent[k]) + local[2] * normal[k];
}

#endif
