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
    CHART_BOX,       /* x, y over the square 1/2 +- extent */
    CHART_DISK,      /* radius over extent, angle about (centre, centre) */
    CHART_ANNULUS,   /* square of the radius from extent^2 to 1, angle */
    CHART_POLYGON,   /* distance along the blade's middle, then place along all sides; extent = sides */
    CHART_SPHERE,    /* depth (1 - z) / 2 over extent, to the power 1 / squeeze, and angle */
    CHART_TRIANGLE,  /* of the barycentrics of b and c: 1 - beta and alpha / (1 - beta) */
    CHART_RECTANGLE, /* of a + p (b - a) + q (c - a): p, q */
} chart_kind;

#define MAX_VALUES 12

typedef struct mapping_case {
    sf_mapping mapping;
    double parameters[MAX_VALUES]; /* one after another */
    chart_kind chart;
    double extent, centre;
    double squeeze; /* 0 = 1; negative: from the pole -z */
    double loss;    /* how many times farther than others a round trip may end; 0 = 1 */
} mapping_case;

#define TRIANGLE_CASES(name, chart)                         \
    {name, {0, 0, 0, 1, 0, 0, 0, 1, 0}, chart, 0, 0, 0, 0}, \
        {name, {0.3, -1, 2, 1, 0.5, 2.5, -0.25, 1, 0}, chart, 0, 0, 0, 0}

static const mapping_case mapping_cases[] = {
    {SF_MAPPING_PIXEL_BOX, {0}, CHART_BOX, 0.5, 0, 0, 0},
    {SF_MAPPING_PIXEL_TENT, {0}, CHART_BOX, 1.0, 0, 0, 0},
    {SF_MAPPING_PIXEL_GAUSSIAN, {0.4}, CHART_BOX, 2.4, 0, 0, 0},
    {SF_MAPPING_PIXEL_GAUSSIAN, {1.5}, CHART_BOX, 9.0, 0, 0, 0},
    {SF_MAPPING_PIXEL_GAUSSIAN_TRUNCATED, {0.8, 1.5}, CHART_DISK, 1.5, 0.5, 0, 0},
    {SF_MAPPING_PIXEL_GAUSSIAN_TRUNCATED, {0.4, 0.5}, CHART_DISK, 0.5, 0.5, 0, 0},
    {SF_MAPPING_PIXEL_BLACKMAN_HARRIS, {1.5}, CHART_BOX, 1.5, 0, 0, 0},
    {SF_MAPPING_PIXEL_MITCHELL, {0}, CHART_BOX, 16.0 / 7.0, 0, 0, 0}, /* the zero crossing at 3/4 of the side */
    {SF_MAPPING_PIXEL_LANCZOS, {0}, CHART_BOX, 4.0, 0, 0, 0},         /* those at multiples of 1/8 */
    TRIANGLE_CASES(SF_MAPPING_TRIANGLE, CHART_TRIANGLE),
    TRIANGLE_CASES(SF_MAPPING_TRIANGLE_LOW_DISTORTION, CHART_TRIANGLE),
    TRIANGLE_CASES(SF_MAPPING_PARALLELOGRAM, CHART_RECTANGLE),
    {SF_MAPPING_DISK_POLAR, {0}, CHART_DISK, 1, 0, 0, 0},
    {SF_MAPPING_DISK_CONCENTRIC, {0}, CHART_DISK, 1, 0, 0, 0},
    {SF_MAPPING_DISK_NAIVE, {0}, CHART_DISK, 1, 0, 0, 0},
    {SF_MAPPING_ANNULUS, {0.4}, CHART_ANNULUS, 0.4, 0, 0, 0},
    {SF_MAPPING_ANNULUS, {0.0}, CHART_ANNULUS, 0.0, 0, 0, 0},
    {SF_MAPPING_REGULAR_POLYGON, {5}, CHART_POLYGON, 5, 0, 0, 0},
    {SF_MAPPING_REGULAR_POLYGON, {8}, CHART_POLYGON, 8, 0, 0, 0},
    {SF_MAPPING_SPHERE, {0}, CHART_SPHERE, 1, 0, 0, 0},
    {SF_MAPPING_HEMISPHERE, {0}, CHART_SPHERE, 0.5, 0, 0, 0},
    {SF_MAPPING_COSINE_HEMISPHERE, {0}, CHART_SPHERE, 0.5, 0, 0, 0},
    {SF_MAPPING_COSINE_HEMISPHERE_CONCENTRIC, {0}, CHART_SPHERE, 0.5, 0, 0, 0},
    {SF_MAPPING_CONE, {0.5}, CHART_SPHERE, 0.06120871905481365, 0, 0, 0}, /* sin^2(angle / 2) */
    {SF_MAPPING_CONE, {0.00465}, CHART_SPHERE, 5.4056152597464714e-06, 0, 0, 0},
    {SF_MAPPING_CONE, {2.5}, CHART_SPHERE, 0.9005718077734668, 0, 0, 0},
    {SF_MAPPING_POWER_COSINE, {0}, CHART_SPHERE, 0.5, 0, 0, 0},
    {SF_MAPPING_POWER_COSINE, {12.5}, CHART_SPHERE, 0.5, 0, 2, 0},
    {SF_MAPPING_POWER_COSINE, {3000}, CHART_SPHERE, 0.5, 0, 4, 0},
    {SF_MAPPING_HENYEY_GREENSTEIN, {0}, CHART_SPHERE, 1, 0, 0, 0},
    {SF_MAPPING_HENYEY_GREENSTEIN, {0.8}, CHART_SPHERE, 1, 0, 4, 0},
    {SF_MAPPING_HENYEY_GREENSTEIN, {0.999}, CHART_SPHERE, 1, 0, 8, 0},
    {SF_MAPPING_HENYEY_GREENSTEIN, {-0.999}, CHART_SPHERE, 1, 0, -8, 0},
    {SF_MAPPING_GGX_VISIBLE_NORMALS, {0.6, 0, 0.8, 0.5, 0.5}, CHART_SPHERE, 0.5, 0, 2, 0},
    {SF_MAPPING_GGX_VISIBLE_NORMALS, {0.48, -0.64, 0.6, 0.2, 0.6}, CHART_SPHERE, 0.5, 0, 2, 0},
    {SF_MAPPING_GGX_VISIBLE_NORMALS, {0, 0, 1, 0.05, 0.05}, CHART_SPHERE, 0.5, 0, 4, 0},
    /* An octant; a triangle around the origin's foot; a small one, far away. */
    {SF_MAPPING_SPHERICAL_TRIANGLE, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, CHART_TRIANGLE, 0, 0, 0, 8},
    {SF_MAPPING_SPHERICAL_TRIANGLE, {2, 0, 0.6, -1, 2, 0.6, -1, -2, 0.6, 0, 0, 0}, CHART_TRIANGLE, 0, 0, 0, 16},
    {SF_MAPPING_SPHERICAL_TRIANGLE, {0, 0, 5, 0.01, 0, 5, 0, 0.02, 5, 1, 2, 0}, CHART_TRIANGLE, 0, 0, 0, 4000},
    {SF_MAPPING_SPHERICAL_RECTANGLE, {-1, -0.5, 1, 1, -0.5, 1, -1, 0.9, 1, 0, 0, 0}, CHART_RECTANGLE, 0, 0, 0, 4},
    {SF_MAPPING_SPHERICAL_RECTANGLE, {1, 2, 0.1, 1, 4, 0.1, 3, 2, 0.1, 0, 0, 0}, CHART_RECTANGLE, 0, 0, 0, 200},
    {SF_MAPPING_SPHERICAL_RECTANGLE, {0, 0, 5, 0.01, 0, 5, 0, 0.02, 5, 1, 2, 0}, CHART_RECTANGLE, 0, 0, 0, 4000},
};
#define CASE_COUNT (sizeof mapping_cases / sizeof *mapping_cases)

/* Pointers to the parameters of a case, for the bulk calls. */
typedef struct case_parameters {
    float f32[MAX_VALUES];
    const float *f32_at[SF_MAPPING_MAX_PARAMETERS];
    const double *f64_at[SF_MAPPING_MAX_PARAMETERS];
} case_parameters;

static inline void case_parameters_init(case_parameters *p, const mapping_case *c) {
    for (size_t i = 0; i < MAX_VALUES; ++i) p->f32[i] = (float)c->parameters[i];
    for (size_t k = 0, at = 0; k < sf_mapping_parameter_count(c->mapping); ++k) {
        p->f32_at[k] = p->f32 + at;
        p->f64_at[k] = c->parameters + at;
        at += sf_mapping_parameter_at(c->mapping, k).components;
    }
}

static inline int is_by_solid_angle(const mapping_case *c) {
    return c->mapping == SF_MAPPING_SPHERICAL_TRIANGLE || c->mapping == SF_MAPPING_SPHERICAL_RECTANGLE;
}
static inline int is_direction(const mapping_case *c) { return c->chart == CHART_SPHERE || is_by_solid_angle(c); }

static inline double turns(double y, double x) {
    double a = atan2(y, x) / TURN;
    return a < 0.0 ? a + 1.0 : a;
}

/* The cross product of b - a and c - a. */
static inline void plane_normal(const double *abc, double n[3]) {
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (abc[3 + i] - abc[i]) * (abc[6 + j] - abc[j]) - (abc[3 + j] - abc[j]) * (abc[6 + i] - abc[i]);
    }
}

/* The point of the shape's plane that the direction x meets, for those by solid angle. */
static inline void plane_point(const mapping_case *c, const double *x, double point[3]) {
    const double *origin = c->parameters + 9;
    double n[3], above = 0.0, along = 0.0;
    plane_normal(c->parameters, n);
    for (int k = 0; k < 3; ++k) {
        above += n[k] * (c->parameters[k] - origin[k]);
        along += n[k] * x[k];
    }
    for (int k = 0; k < 3; ++k) point[k] = is_by_solid_angle(c) ? origin[k] + x[k] * above / along : x[k];
}

/* p and q of x = a + p (b - a) + q (c - a). */
static inline void affine_coordinates(const double *abc, const double *x, double *p, double *q) {
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
    *p = (de * ff - df * ef) / scale;
    *q = (df * ee - de * ef) / scale;
}

static inline void polygon_chart(double sides, const double *x, double cell[2]) {
    double blade = floor(turns(x[1], x[0]) * sides), middle = (blade + 0.5) / sides * TURN, half = 0.5 * TURN / sides;
    double along = x[0] * cos(middle) + x[1] * sin(middle), across = x[1] * cos(middle) - x[0] * sin(middle);
    cell[0] = along / cos(half);
    cell[1] = (blade + 0.5 + 0.5 * across / (cell[0] * sin(half))) / sides;
}

/* The chart's coordinates of the point x. */
static inline void chart_of(const mapping_case *c, const double *x, double cell[2]) {
    double alpha, beta, point[3], z = c->squeeze < 0.0 ? -x[2] : x[2], ring = x[0] * x[0] + x[1] * x[1];
    switch (c->chart) {
        case CHART_BOX:
            for (int k = 0; k < 2; ++k) cell[k] = (x[k] - 0.5 + c->extent) / (2.0 * c->extent);
            break;
        case CHART_DISK:
            cell[0] = hypot(x[0] - c->centre, x[1] - c->centre) / c->extent;
            cell[1] = turns(x[1] - c->centre, x[0] - c->centre);
            break;
        case CHART_ANNULUS:
            cell[0] = (ring - c->extent * c->extent) / (1.0 - c->extent * c->extent);
            cell[1] = turns(x[1], x[0]);
            break;
        case CHART_POLYGON: polygon_chart(c->extent, x, cell); break;
        case CHART_SPHERE:
            cell[0] = 0.5 * (z > 0.0 ? ring / (1.0 + z) : 1.0 - z) / c->extent;
            if (c->squeeze != 0.0) cell[0] = pow(cell[0], 1.0 / fabs(c->squeeze));
            cell[1] = turns(x[1], x[0]);
            break;
        case CHART_TRIANGLE:
            plane_point(c, x, point);
            affine_coordinates(c->parameters, point, &alpha, &beta);
            cell[0] = 1.0 - beta;
            cell[1] = alpha / (1.0 - beta);
            break;
        default: plane_point(c, x, point); affine_coordinates(c->parameters, point, &cell[0], &cell[1]);
    }
}

/* The point a + p (b - a) + q (c - a), or its direction from the origin, and the measure that a
 * unit of (p, q) has there: the area of the parallelogram, or what it covers of the sphere. */
static inline double affine_point(const mapping_case *c, double p, double q, double x[3]) {
    const double *abc = c->parameters, *origin = abc + 9;
    double n[3], square = 0.0, distance = 0.0, facing = 0.0;
    plane_normal(abc, n);
    for (int k = 0; k < 3; ++k) x[k] = abc[k] + p * (abc[3 + k] - abc[k]) + q * (abc[6 + k] - abc[k]);
    for (int k = 0; k < 3; ++k) {
        double d = x[k] - origin[k];
        square += n[k] * n[k];
        distance += d * d;
        facing += d * n[k];
    }
    if (!is_by_solid_angle(c)) return sqrt(square);
    distance = sqrt(distance);
    for (int k = 0; k < 3; ++k) x[k] = (x[k] - origin[k]) / distance;
    return fabs(facing) / (distance * distance * distance);
}

static inline double polygon_point(double sides, double p, double q, double x[3]) {
    double blade = floor(q * sides), middle = (blade + 0.5) / sides * TURN, half = 0.5 * TURN / sides;
    double along = p * cos(half), across = p * sin(half) * (2.0 * (q * sides - blade) - 1.0);
    x[0] = along * cos(middle) - across * sin(middle);
    x[1] = along * sin(middle) + across * cos(middle);
    return 2.0 * p * sides * sin(half) * cos(half);
}

static inline double sphere_point(const mapping_case *c, double p, double q, double x[3]) {
    double power = c->squeeze != 0.0 ? fabs(c->squeeze) : 1.0, depth = 2.0 * c->extent * pow(p, power);
    double ring = sqrt(depth * (2.0 - depth));
    x[0] = ring * cos(TURN * q);
    x[1] = ring * sin(TURN * q);
    x[2] = c->squeeze < 0.0 ? depth - 1.0 : 1.0 - depth;
    return 2.0 * TURN * c->extent * power * pow(p, power - 1.0);
}

/* The point at chart coordinates (p, q), and the measure that a unit of the chart has there. */
static inline double chart_point(const mapping_case *c, double p, double q, double x[3]) {
    double radius;
    switch (c->chart) {
        case CHART_BOX:
            x[0] = 0.5 + c->extent * (2.0 * p - 1.0);
            x[1] = 0.5 + c->extent * (2.0 * q - 1.0);
            return 4.0 * c->extent * c->extent;
        case CHART_DISK:
            x[0] = c->centre + c->extent * p * cos(TURN * q);
            x[1] = c->centre + c->extent * p * sin(TURN * q);
            return TURN * p * c->extent * c->extent;
        case CHART_ANNULUS:
            radius = sqrt(c->extent * c->extent + p * (1.0 - c->extent * c->extent));
            x[0] = radius * cos(TURN * q);
            x[1] = radius * sin(TURN * q);
            return 0.5 * TURN * (1.0 - c->extent * c->extent);
        case CHART_POLYGON: return polygon_point(c->extent, p, q, x);
        case CHART_SPHERE: return sphere_point(c, p, q, x);
        case CHART_TRIANGLE: return p * affine_point(c, q * p, 1.0 - p, x);
        default: return affine_point(c, p, q, x);
    }
}

#endif
