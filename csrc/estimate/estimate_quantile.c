// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The quantiles of the normal and of Student's t, by Newton's method on their distribution
 * functions, in the form (centre or tail) in which no digits cancel. */

#include <float.h>
#include <math.h>

#include "sunfleck/estimate.h"

#define PI 3.14159265358979323846
#define HALF_LOG_PI 0.57236494292470008707
#define MAX_STEPS 200

/* z >= 0 with P(0 < Z < z) = d, d below 1/4: Newton's steps on a concave function, from the left. */
static double normal_centre(double d) {
    double z = d * sqrt(2.0 * PI);
    for (int i = 0; i < MAX_STEPS; ++i) {
        double step = (d - 0.5 * erf(z * sqrt(0.5))) * sqrt(2.0 * PI) * exp(0.5 * z * z);
        z += step;
        if (fabs(step) <= 1e-15 * z) break;
    }
    return z;
}

/* The same where P(Z > z) and the density are near the end of doubles, z > 36: on the asymptotic series of the
 * logarithm (Abramowitz & Stegun 26.2.12), whose next term is below 10^-11 of the probability there. */
static double normal_far_tail(double q) {
    double z = sqrt(-2.0 * log(q));
    for (int i = 0; i < MAX_STEPS; ++i) {
        double w = 1.0 / (z * z), series = 1.0 - w * (1.0 - w * (3.0 - w * (15.0 - w * (105.0 - w * 945.0))));
        double step = (-0.5 * z * z - log(z * sqrt(2.0 * PI)) + log(series) - log(q)) * series / z;
        z += step;
        if (fabs(step) <= 1e-15 * z) break;
    }
    return z;
}

/* z >= 0 with P(Z > z) = q, q at most 1/4: Newton's steps on log P, which is concave. */
static double normal_tail(double q) {
    if (q < 1e-290) return normal_far_tail(q);
    double z = sqrt(-2.0 * log(2.0 * q)); /* P(Z > z) <= exp(-z^2 / 2) / 2, so this is beyond */
    for (int i = 0; i < MAX_STEPS; ++i) {
        double tail = 0.5 * erfc(z * sqrt(0.5));
        double step = log(tail / q) * tail * sqrt(2.0 * PI) * exp(0.5 * z * z);
        z += step;
        if (fabs(step) <= 1e-15 * z) break;
    }
    return z;
}

double sf_normal_quantile(double p) {
    if (!(p >= 0.0 && p <= 1.0)) return (double)NAN;
    if (p == 0.0 || p == 1.0) return p == 0.0 ? -(double)INFINITY : (double)INFINITY;
    if (p > 0.25 && p < 0.75) return p < 0.5 ? -normal_centre(0.5 - p) : normal_centre(p - 0.5);
    return p < 0.5 ? -normal_tail(p) : normal_tail(1.0 - p);
}

/* log of Gamma(a + 1/2) / Gamma(a): the ratio's asymptotic series (Tricomi & Erdelyi 1951) from
 * a = 32 on, where seven terms leave 1e-14; below, by its recurrence. */
static double log_gamma_ratio(double a) {
    double product = 1.0;
    for (; a < 32.0; a += 1.0) product *= a / (a + 0.5);
    double h = 1.0 / a;
    double series =
        1.0 +
        h * (-1.0 / 8 +
             h * (1.0 / 128 + h * (5.0 / 1024 + h * (-21.0 / 32768 + h * (-399.0 / 262144 + h * (869.0 / 4194304))))));
    return 0.5 * log(a) + log(series * product);
}

/* The continued fraction of the incomplete beta function (DLMF 8.17.22) by Lentz's method, in
 * Thompson & Barnett's form; converges fast for x < (a + 1) / (a + b + 2). */
static double beta_fraction(double a, double b, double x) {
    const double tiny = 1e-300;
    double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
    d = 1.0 / (fabs(d) < tiny ? tiny : d);
    double value = d;
    for (int m = 1; m < 100000; ++m) {
        double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double change = 1.0;
        for (int part = 0; part < 2; ++part) {
            double numerator = part ? odd : even;
            d = 1.0 + numerator * d;
            c = 1.0 + numerator / c;
            d = 1.0 / (fabs(d) < tiny ? tiny : d);
            c = fabs(c) < tiny ? tiny : c;
            value *= d * c;
            change = d * c;
        }
        if (fabs(change - 1.0) < 1e-15) break;
    }
    return value;
}

/* Student's t at t = exp(L) > 0: P(0 < T < t), P(T > t) and log of t times the density. With
 * x = dof / (dof + t^2) and y = 1 - x, they are I_y(1/2, dof/2) / 2 and I_x(dof/2, 1/2) / 2. */
typedef struct student {
    double centre, log_tail, log_slope;
} student;

static student student_at(double L, double dof) {
    double a = 0.5 * dof, excess = 2.0 * L - log(dof); /* log(t^2 / dof) */
    double log_x = excess > 0.0 ? -excess - log1p(exp(-excess)) : -log1p(exp(excess));
    double log_y = log_x + excess, x = exp(log_x), y = exp(log_y);
    student s;
    /* x^a sqrt(y) / B(a, 1/2), common to both fractions and to the density. */
    double log_front = a * log_x + 0.5 * log_y + log_gamma_ratio(a) - HALF_LOG_PI;
    s.log_slope = log_front;
    if (x < (a + 1.0) / (a + 2.5)) {
        s.log_tail = log_front + log(beta_fraction(a, 0.5, x) / dof);
        s.centre = 0.5 - exp(s.log_tail);
    } else {
        s.centre = exp(log_front) * beta_fraction(0.5, a, y);
        s.log_tail = log1p(-2.0 * s.centre) - log(2.0);
    }
    return s;
}

/* log t with P(0 < T < t) = d, for t <= 1: Newton's steps in t from the left. */
static double student_centre(double d, double dof) {
    double t = normal_centre(d < 0.25 ? d : 0.25);
    for (int i = 0; i < MAX_STEPS; ++i) {
        student s = student_at(log(t), dof);
        double step = (d - s.centre) * t / exp(s.log_slope);
        t += step;
        if (fabs(step) <= 1e-15 * t) break;
    }
    return t;
}

/* t with P(T > t) = q, for t >= 1: Newton's steps in log t on log P, which is concave. */
static double student_tail(double q, double dof) {
    double z = q < 0.25 ? normal_tail(q) : 1.0, L = log(z > 1.0 ? z : 1.0);
    for (int i = 0; i < MAX_STEPS; ++i) {
        student s = student_at(L, dof);
        double step = (s.log_tail - log(q)) * exp(s.log_tail - s.log_slope);
        L += step;
        if (fabs(step) <= 1e-15 * (1.0 + fabs(L))) break;
    }
    return exp(L);
}

/* The expansion about the normal quantile z (Abramowitz & Stegun 26.7.5); its next term is below
 * 1e-11 of z for dof > 1e5 and every z up to 38, where P(Z > z) leaves the range of doubles. */
static double student_expansion(double z, double dof) {
    double h = 1.0 / dof, w = z * z;
    double g1 = (w + 1.0) / 4.0, g2 = ((5.0 * w + 16.0) * w + 3.0) / 96.0;
    double g3 = (((3.0 * w + 19.0) * w + 17.0) * w - 15.0) / 384.0;
    double g4 = ((((79.0 * w + 776.0) * w + 1482.0) * w - 1920.0) * w - 945.0) / 92160.0;
    return z + z * h * (g1 + h * (g2 + h * (g3 + h * g4)));
}

double sf_student_t_quantile(double p, double dof) {
    if (!(p >= 0.0 && p <= 1.0) || !(dof > 0.0)) return (double)NAN;
    if (p == 0.0 || p == 1.0 || p == 0.5) return sf_normal_quantile(p);
    if (dof > 1e5) return student_expansion(sf_normal_quantile(p), dof);
    double q = p < 0.5 ? p : 1.0 - p, sign = p < 0.5 ? -1.0 : 1.0;
    student one = student_at(0.0, dof);
    double t = log(q) < one.log_tail ? student_tail(q, dof) : student_centre(fabs(p - 0.5), dof);
    return sign * t;
}
