// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The functions of sunfleck/elementary.h in double, for the bulk mappings of doubles: the same
 * reductions with longer polynomials, interpolated to less than 0.3 of 2^-53; within 2 ulp. */
#ifndef SUNFLECK_ELEMENTARY_F64_H
#define SUNFLECK_ELEMENTARY_F64_H

#include "sunfleck/elementary.h"

SF_INLINE double sf_unit_clamp_f64(double x) {
    double low = x > 0.0 ? x : 0.0;
    return low < SF_UNIT_MAX ? low : SF_UNIT_MAX;
}

SF_INLINE void sf_sincos_2pi_octant_f64(double r, double *sine, double *cosine) {
    double t = r * r;
    double p =
        0x1.50783485cbd83p+5 + t * (-0x1.e3074b4ff3058p+3 + t * (0x1.e8eed12ee00a3p+1 + t * -0x1.6c5b875d4e714p-1));
    p = -0x1.4abbce625be53p+5 + t * (0x1.466bc6775aad9p+6 + t * (-0x1.32d2cce62ac22p+6 + t * p));
    double q =
        -0x1.a6d1f2a086c90p+4 + t * (0x1.f9d3870871194p+2 + t * (-0x1.b6de8b8e9ba08p+0 + t * 0x1.1e745e5e09f53p-2));
    q = 0x1.03c1f081b5ac4p+6 + t * (-0x1.55d3c7e3cbff7p+6 + t * (0x1.e1f506891ae95p+5 + t * q));
    *sine = r * 6.0 + r * (0x1.21fb54442d184p-2 + t * p);
    *cosine = 1.0 + t * (-0x1.3bd3cc9be45dep+4 + t * q);
}

SF_INLINE void sf_sincos_2pi_f64(double u, double *sine, double *cosine) {
    int32_t quarter = ((int32_t)(u * 8.0) + 1) >> 1;
    double s, c;
    sf_sincos_2pi_octant_f64(u - (double)quarter * 0.25, &s, &c);
    double first = quarter & 1 ? c : s, second = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -first : first;
    *cosine = (quarter + 1) & 2 ? -second : second;
}

/* Measured from the diagonal past tan(pi/8), which makes the two ranges equal. */
SF_INLINE double sf_atan_turns_f64(double low, double high) {
    int diagonal = low > 0.41421356237309503 * high;
    double numerator = diagonal ? high - low : low, denominator = diagonal ? high + low : high;
    double z = numerator / (denominator > 0.0 ? denominator : 1.0), t = z * z;
    double p = 0x1.327cee478717dp-7 +
               t * (-0x1.1017bc898b707p-7 +
                    t * (0x1.d550a08ec1b02p-8 + t * (-0x1.5c3f6574c0dcbp-8 + t * 0x1.3b48da01aa9f4p-9)));
    p = 0x1.21bb94470a00bp-6 +
        t * (-0x1.da1ba95cf1637p-7 + t * (0x1.912ac13fdc0f6p-7 + t * (-0x1.5ba7bc2d8c76cp-7 + t * p)));
    p = -0x1.b2995e7b7b601p-5 + t * (0x1.04c26be3b0422p-5 + t * (-0x1.7483758e3eae1p-6 + t * p));
    double a = z * 0.125 + (z * 0.03125 + z * (0x1.7cc1b727220a9p-9 + t * p));
    return diagonal ? 0.125 - a : a;
}

SF_INLINE double sf_angle_2pi_f64(double y, double x) {
    double ax = fabs(x), ay = fabs(y);
    int steep = ay > ax;
    double a = sf_atan_turns_f64(steep ? ax : ay, steep ? ay : ax);
    a = steep ? 0.25 - a : a;
    a = x < 0.0 ? 0.5 - a : a;
    a = y < 0.0 ? 1.0 - a : a;
    return a < SF_UNIT_MAX ? a : SF_UNIT_MAX;
}

/* log(1 + f) = f - s (f - R(s^2)) with s = f / (2 + f), from the series of atanh. */
SF_INLINE double sf_log_with_f64(double x, double rest) {
    int64_t bits;
    memcpy(&bits, &x, 8);
    int32_t k = ((int32_t)((uint64_t)bits >> 32) - 0x3fe6a09e) >> 20;
    bits -= (int64_t)((uint64_t)(int64_t)k << 52);
    double f, e = (double)k;
    memcpy(&f, &bits, 8);
    f -= 1.0;
    double s = f / (2.0 + f), t = s * s;
    double p =
        0x1.c71c62c42db89p-3 + t * (0x1.7462be245eae4p-3 + t * (0x1.39fd25d62ab13p-3 + t * 0x1.2b6776a1bf15dp-3));
    p = t * (0x1.5555555555558p-1 + t * (0x1.99999999951f5p-2 + t * (0x1.2492492e0b70cp-2 + t * p)));
    return e * 0x1.62e42fefap-1 + (f - (s * (f - p) - (e * 0x1.cf79abc9e3b3ap-40 + rest)));
}

SF_INLINE double sf_log_f64(double x) { return sf_log_with_f64(x, 0.0); }

SF_INLINE double sf_log1m_f64(double s) {
    double v = 1.0 - s, lost = (1.0 - v) - s;
    return sf_log_with_f64(v, lost + lost * s);
}

SF_INLINE double sf_exp_clamp_f64(double x) {
    int64_t bits, magnitude, largest = INT64_C(0x4086200000000000); /* 708.0 */
    memcpy(&bits, &x, 8);
    magnitude = bits & INT64_MAX;
    magnitude = magnitude < largest ? magnitude : largest;
    bits = (int64_t)((uint64_t)bits & UINT64_C(0x8000000000000000)) | magnitude;
    memcpy(&x, &bits, 8);
    return x;
}

SF_INLINE double sf_exp_split_f64(double x, double *power) {
    double scaled = x * 0x1.71547652b82fep+0;
    int32_t k = (int32_t)(scaled + copysign(0.5, scaled));
    double f = (x - (double)k * 0x1.62e42fefap-1) - (double)k * 0x1.cf79abc9e3b3ap-40;
    uint64_t bits = (uint64_t)(k + 1023) << 52;
    memcpy(power, &bits, 8);
    /* 1 / (n + 2)!: the Taylor series of (exp f - 1 - f) / f^2, to 2e-17 at |f| = log(2) / 2. */
    double p = 1.0 / 39916800 + f * (1.0 / 479001600 + f * (1.0 / 6227020800.0));
    p = 1.0 / 40320 + f * (1.0 / 362880 + f * (1.0 / 3628800 + f * p));
    p = 1.0 / 120 + f * (1.0 / 720 + f * (1.0 / 5040 + f * p));
    p = 1.0 / 2 + f * (1.0 / 6 + f * (1.0 / 24 + f * p));
    return f + f * f * p;
}

SF_INLINE double sf_exp_f64(double x) {
    double power, p = sf_exp_split_f64(sf_exp_clamp_f64(x), &power);
    return power + power * p;
}

SF_INLINE double sf_expm1_f64(double x) {
    double power, p = sf_exp_split_f64(sf_exp_clamp_f64(x), &power);
    return (power - 1.0) + power * p;
}

SF_INLINE double sf_cbrt_rough_f64(double x) {
    uint64_t bits;
    memcpy(&bits, &x, 8);
    bits = (uint64_t)((uint32_t)(bits >> 32) / 3 + 0x2a9f7893u) << 32;
    memcpy(&x, &bits, 8);
    return x;
}

#endif
