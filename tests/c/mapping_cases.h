// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The mappings with the parameters that the tests give them, and with a chart each: smooth
 * coordinates in the unit square by which a test may cut the shape into cells and integrate
 * over it, independent of the mapping's own inverse. */
#ifndef SUNFLECK_TESTS_MAPPING_CASES_H
#define SUNFLECK_TESTS_MAPPING_CASES_H

#include <math.h>
#include <stddef.h>

#include "sunfleck/mapping.h"

#define TURN 6.283185307179586476925

typedef enum chart_kind {
    CHART_BOX,      /* x, y over the square centre +- half */
    CHART_DISK,     /* radius, angle */
    CHART_SPHERE,   /* (1 - z) / 2, angle */
    CHART_TRIANGLE, /* of the barycentrics of b and c: (1 - beta)^2 and alpha / (1 - beta) */
} chart_kind;

typedef struct mapping_case {
    sf_mapping mapping;
    double parameters[9]; /* one after another */
    chart_kind chart;
    double centre, half; /* of CHART_BOX; CHART_SPHERE: half = share of the sphere, 0 = all of it */
} mapping_case;

static const mapping_case mapping_cases[] = {
    {SF_MAPPING_PIXEL_BOX, {0}, CHART_BOX, 0.5, 0.5},
    {SF_MAPPING_PIXEL_TENT, {0}, CHART_BOX, 0.5, 1.0},
    {SF_MAPPING_PIXEL_GAUSSIAN, {0.4}, CHART_BOX, 0.5, 2.4},
    {SF_MAPPING_PIXEL_GAUSSIAN, {1.5}, CHART_BOX, 0.5, 9.0},
    {SF_MAPPING_TRIANGLE, {0, 0, 0, 1, 0, 0, 0, 1, 0}, CHART_TRIANGLE, 0, 0},
    {SF_MAPPING_TRIANGLE, {0.3, -1, 2, 1, 0.5, 2.5, -0.25, 1, 0}, CHART_TRIANGLE, 0, 0},
    {SF_MAPPING_DISK_POLAR, {0}, CHART_DISK, 0, 0},
    {SF_MAPPING_DISK_CONCENTRIC, {0}, CHART_DISK, 0, 0},
    {SF_MAPPING_DISK_NAIVE, {0}, CHART_DISK, 0, 0},
    {SF_MAPPING_SPHERE, {0}, CHART_SPHERE, 0, 0},
    {SF_MAPPING_HEMISPHERE, {0}, CHART_SPHERE, 0, 0.5},
    {SF_MAPPING_COSINE_HEMISPHERE, {0}, CHART_SPHERE, 0, 0.5},
};
#define CASE_COUNT (sizeof mapping_cases / sizeof *mapping_cases)

/* Pointers to the parameters of a case, for the bulk calls. */
typedef struct case_parameters {
    float f32[9];
    const float *f32_at[SF_MAPPING_MAX_PARAMETERS];
    const double *f64_at[SF_MAPPING_MAX_PARAMETERS];
} case_parameters;

static inline void case_parameters_init(case_parameters *p, const mapping_case *c) {
    for (size_t i = 0; i < 9; ++i) p->f32[i] = (float)c->parameters[i];
    for (size_t k = 0, at = 0; k < sf_mapping_parameter_count(c->mapping); ++k) {
        p->f32_at[k] = p->f32 + at;
        p->f64_at[k] = c->parameters + at;
        at += sf_mapping_parameter_at(c->mapping, k).components;
    }
}

static inline double turns(double y, double x) {
    double a = atan2(y, x) / TURN;
    return a < 0.0 ? a + 1.0 : a;
}

static inline void triangle_barycentrics(const double *abc, const double *x, double *alpha, double *beta) {
    double ee = 0, ef = 0, ff = 0, de = 0, df = 0;
    for (int k = 0; k < 3; ++k) {
        double e = abc[3 + k] - abc[k], f = abc[6 + k] - abc[k], d = x[k] - abc[k];
        ee += e * e;
        ef += e * f;
        ff += f * f;
        de += d * e;
        df += d * f;
    }
    double scale = ee * ff - ef * ef;
    *alpha = (de * ff - df * ef) / scale;
    *beta = (df * ee - de * ef) / scale;
}

/* The chart's coordinates of the point x. */
static inline void chart_of(const mapping_case *c, const double *x, double cell[2]) {
    double alpha, beta, share = c->half > 0.0 ? c->half : 1.0;
    switch (c->chart) {
        case CHART_BOX:
            for (int k = 0; k < 2; ++k) cell[k] = (x[k] - c->centre + c->half) / (2.0 * c->half);
            break;
        case CHART_DISK:
            cell[0] = sqrt(x[0] * x[0] + x[1] * x[1]);
            cell[1] = turns(x[1], x[0]);
            break;
        case CHART_SPHERE:
            cell[0] = 0.5 * (1.0 - x[2]) / share;
            cell[1] = turns(x[1], x[0]);
            break;
        default:
            triangle_barycentrics(c->parameters, x, &alpha, &beta);
            cell[0] = (1.0 - beta) * (1.0 - beta);
            cell[1] = alpha / (1.0 - beta);
    }
}

/* The point at chart coordinates (p, q), and the measure that a unit of the chart has there. */
static inline double chart_point(const mapping_case *c, double p, double q, double x[3]) {
    const double *abc = c->parameters;
    double alpha, beta, z, ring, share = c->half > 0.0 ? c->half : 1.0, n[3];
    switch (c->chart) {
        case CHART_BOX:
            x[0] = c->centre + c->half * (2.0 * p - 1.0);
            x[1] = c->centre + c->half * (2.0 * q - 1.0);
            return 4.0 * c->half * c->half;
        case CHART_DISK:
            x[0] = p * cos(TURN * q);
            x[1] = p * sin(TURN * q);
            return TURN * p;
        case CHART_SPHERE:
            z = 1.0 - 2.0 * share * p;
            ring = sqrt(1.0 - z * z);
            x[0] = ring * cos(TURN * q);
            x[1] = ring * sin(TURN * q);
            x[2] = z;
            return 2.0 * TURN * share;
        default:
            alpha = q * sqrt(p);
            beta = 1.0 - sqrt(p);
            for (int k = 0; k < 3; ++k) x[k] = abc[k] + alpha * (abc[3 + k] - abc[k]) + beta * (abc[6 + k] - abc[k]);
            for (int k = 0; k < 3; ++k) {
                int i = (k + 1) % 3, j = (k + 2) % 3;
                n[k] = (abc[3 + i] - abc[i]) * (abc[6 + j] - abc[j]) - (abc[3 + j] - abc[j]) * (abc[6 + i] - abc[i]);
            }
            return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
}

#endif
