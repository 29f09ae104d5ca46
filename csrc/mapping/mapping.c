// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The table of mappings, and the bulk calls: they check, then hand the work to the kernels. */

#include "sunfleck/mapping.h"

#include <float.h>
#include <math.h>

#include "base/error.h"
#include "base/name.h"
#include "mapping/mapping_kernels.h"

/* What a value must be besides in its interval. */
typedef enum kind { ANY = 0, WHOLE, DIRECTION } kind;

/* The values that an input may take, as a closed interval, and in words. Infinity as a bound
 * stands for the largest finite number of the type. */
typedef struct range {
    double low, high;
    const char *words;
    kind kind;
} range;

#define FINITE {-(double)INFINITY, (double)INFINITY, "finite", ANY}
#define VERTEX(name) {name, 3, 0, 0.0, FINITE}
#define ROUGHNESS(name)                                       \
    {                                                         \
        name, 1, 0, 0.0, { 1e-4, 10.0, "in [1e-4, 10]", ANY } \
    }
#define MU                                                    \
    {                                                         \
        "mu", 1, 1, 0.4, { 1e-6, 1e6, "in [1e-6, 1e6]", ANY } \
    }

typedef struct parameter {
    const char *name;
    size_t components;
    int has_default;
    double default_value;
    range allowed;
} parameter;

typedef struct mapping_entry {
    const char *name;
    const char *description;
    size_t width;
    parameter parameters[SF_MAPPING_MAX_PARAMETERS];
} mapping_entry;

static const mapping_entry entries[SF_MAPPING_COUNT] = {
    {"pixel_box", "the pixel, uniformly", 2, {{0}}},
    {"pixel_tent", "two pixels wide, falling linearly from the centre (the lecture's Shirley map)", 2, {{0}}},
    {"pixel_gaussian", "normal about the pixel's centre, unbounded", 2, {MU}},
    {"pixel_gaussian_truncated",
     "normal about the pixel's centre, cut at a radius",
     2,
     {MU, {"radius", 1, 1, 1.5, {1e-6, 1e6, "in [1e-6, 1e6]", ANY}}}},
    {"pixel_blackman_harris",
     "the 4-term Blackman-Harris window (Harris 1978)",
     2,
     {{"radius", 1, 1, 1.5, {1e-3, 1e3, "in [0.001, 1000]", ANY}}}},
    {"pixel_mitchell", "four pixels wide, with negative weights (Mitchell & Netravali 1988, B = C = 1/3)", 2, {{0}}},
    {"pixel_lanczos", "six pixels wide, sinc(x) sinc(x / 3), with negative weights", 2, {{0}}},
    {"triangle", "a triangle in space, by the square-root map", 3, {VERTEX("a"), VERTEX("b"), VERTEX("c")}},
    {"triangle_low_distortion",
     "a triangle in space, by two sheared halves (Heitz 2019)",
     3,
     {VERTEX("a"), VERTEX("b"), VERTEX("c")}},
    {"parallelogram", "a parallelogram in space: a, and b and c beside it", 3, {VERTEX("a"), VERTEX("b"), VERTEX("c")}},
    {"disk_polar", "the unit disk, by radius sqrt(t) and angle", 2, {{0}}},
    {"disk_concentric", "the unit disk, by squares to circles (Shirley & Chiu 1997)", 2, {{0}}},
    {"disk_naive", "the unit disk with radius t: wrong on purpose, dense at the centre", 2, {{0}}},
    {"annulus", "between a circle and the unit circle", 2, {{"inner", 1, 0, 0.0, {0.0, 1.0, "in [0, 1]", ANY}}}},
    {"regular_polygon",
     "inscribed in the unit circle, a vertex at (1, 0)",
     2,
     {{"sides", 1, 0, 0.0, {3.0, 1024.0, "a whole number in [3, 1024]", WHOLE}}}},
    {"sphere", "directions, uniformly", 3, {{0}}},
    {"hemisphere", "directions about +z, uniformly", 3, {{0}}},
    {"cosine_hemisphere", "directions about +z, in proportion to the cosine", 3, {{0}}},
    {"cosine_hemisphere_concentric", "the same density, by the concentric disk projected up", 3, {{0}}},
    {"cone",
     "directions within an angle (radians) of +z, uniformly",
     3,
     {{"angle", 1, 0, 0.0, {0.0, 3.14159274101257324, "in [0, pi]", ANY}}}},
    {"power_cosine",
     "directions about +z, in proportion to a power of the cosine",
     3,
     {{"exponent", 1, 0, 0.0, {0.0, 1e6, "in [0, 1e6]", ANY}}}},
    {"henyey_greenstein",
     "directions about +z, as fog scatters (Henyey & Greenstein 1941)",
     3,
     {{"g", 1, 0, 0.0, {-0.9999, 0.9999, "in [-0.9999, 0.9999]", ANY}}}},
    {"ggx_visible_normals",
     "normals of a rough surface that are seen from w (Dupuy & Benyoub 2023)",
     3,
     {{"w", 3, 0, 0.0, {-1.001, 1.001, "a direction of length 1, not below the horizon", DIRECTION}},
      ROUGHNESS("alpha_x"),
      ROUGHNESS("alpha_y")}},
    {"spherical_triangle",
     "directions to a triangle, uniformly by solid angle (Arvo 1995)",
     3,
     {VERTEX("a"), VERTEX("b"), VERTEX("c"), {"origin", 3, 1, 0.0, FINITE}}},
    {"spherical_rectangle",
     "directions to a rectangle, uniformly by solid angle (Urena et al. 2013)",
     3,
     {VERTEX("a"), VERTEX("b"), VERTEX("c"), {"origin", 3, 1, 0.0, FINITE}}},
};

static int is_known(sf_mapping mapping) { return (unsigned)mapping < SF_MAPPING_COUNT; }

const char *sf_mapping_name(sf_mapping mapping) { return is_known(mapping) ? entries[mapping].name : NULL; }

const char *sf_mapping_description(sf_mapping mapping) {
    return is_known(mapping) ? entries[mapping].description : NULL;
}

static const char *name_at(int mapping) { return sf_mapping_name((sf_mapping)mapping); }

sf_status sf_mapping_find(const char *name, sf_mapping *mapping, sf_error *error) {
    int index = 0;
    sf_status status = sf_name_find("mapping", name, name_at, &index, error);
    if (status == SF_STATUS_OK) *mapping = (sf_mapping)index;
    return status;
}

size_t sf_mapping_input_width(sf_mapping mapping) { return is_known(mapping) ? 2 : 0; }
size_t sf_mapping_output_width(sf_mapping mapping) { return is_known(mapping) ? entries[mapping].width : 0; }

size_t sf_mapping_parameter_count(sf_mapping mapping) {
    size_t count = 0;
    while (is_known(mapping) && count < SF_MAPPING_MAX_PARAMETERS && entries[mapping].parameters[count].name) ++count;
    return count;
}

sf_mapping_parameter sf_mapping_parameter_at(sf_mapping mapping, size_t index) {
    sf_mapping_parameter result = {NULL, 0, 0, 0.0, NULL};
    if (index >= sf_mapping_parameter_count(mapping)) return result;
    const parameter *p = &entries[mapping].parameters[index];
    result.name = p->name;
    result.components = p->components;
    result.has_default = p->has_default;
    result.default_value = p->default_value;
    result.range = p->allowed.words;
    return result;
}

/* ---- the bulk calls ---- */

/* An array of a call, float or double. */
typedef struct values {
    const char *name;
    size_t rows, width;
    const void *data;
    int is_double;
} values;

static double value_at(const values *v, size_t i) {
    return v->is_double ? ((const double *)v->data)[i] : (double)((const float *)v->data)[i];
}

static size_t first_outside(const values *v, const range *allowed) {
    const sf_mapping_kernels *kernels = sf_mapping_kernels_at(sf_isa_active());
    double largest = v->is_double ? DBL_MAX : (double)FLT_MAX;
    double low = allowed->low < -largest ? -largest : allowed->low;
    double high = allowed->high > largest ? largest : allowed->high;
    size_t count = v->rows * v->width;
    return v->is_double ? kernels->outside_f64(count, v->data, low, high)
                        : kernels->outside_f32(count, v->data, (float)low, (float)high);
}

/* Whether the row is a direction of length 1, within the rounding of floats, that is not below
 * the horizon. */
static int is_direction(const values *v, size_t row) {
    double x = value_at(v, 3 * row), y = value_at(v, 3 * row + 1), z = value_at(v, 3 * row + 2);
    return z >= 0.0 && fabs(x * x + y * y + z * z - 1.0) < 1e-5;
}

/* The first value that is not what the range says, or whose row is not; the count if all are. */
static size_t first_wrong(const values *v, const range *allowed) {
    size_t count = v->rows * v->width, i = first_outside(v, allowed), k = 0;
    if (i < count || allowed->kind == ANY) return i;
    if (allowed->kind == WHOLE)
        while (k < count && value_at(v, k) == floor(value_at(v, k))) ++k;
    else
        while (k < count && is_direction(v, k / v->width)) k += v->width;
    return k;
}

/* Refuses the first value outside its range. */
static sf_status check(sf_mapping mapping, const values *v, const range *allowed, sf_error *error) {
    size_t i = first_wrong(v, allowed);
    if (i >= v->rows * v->width) return SF_STATUS_OK;
    const char *name = entries[mapping].name;
    int digits = v->is_double ? 17 : 9;
    if (allowed->kind == DIRECTION)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: %s[%zu] is (%.*g, %.*g, %.*g); it must be %s", name,
                       v->name, i / 3, digits, value_at(v, i / 3 * 3), digits, value_at(v, i / 3 * 3 + 1), digits,
                       value_at(v, i / 3 * 3 + 2), allowed->words);
    if (v->rows == 1 && v->width == 1)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: %s is %.*g; it must be %s", name, v->name, digits,
                       value_at(v, i), allowed->words);
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: %s[%zu][%zu] is %.*g; it must be %s", name, v->name,
                   i / v->width, i % v->width, digits, value_at(v, i), allowed->words);
}

static sf_status check_input(const sf_mapping_job *job, int is_double, sf_error *error) {
    static const range finite = FINITE, unit_f32 = {0.0, SF_UNIT_MAX_F, "in [0,1)", ANY},
                       unit_f64 = {0.0, SF_UNIT_MAX, "in [0,1)", ANY};
    int from_unit = job->verb == SF_MAPPING_SAMPLE;
    values v = {from_unit ? "u" : "x", job->count, job->in_width, job->in, is_double};
    return check(job->mapping, &v, !from_unit ? &finite : is_double ? &unit_f64 : &unit_f32, error);
}

/* Puts parameter k into the job, checked; a default goes to `fallback`, of the type's size. */
static sf_status take_parameter(sf_mapping_job *job, size_t k, const void *data, size_t stride, int is_double,
                                void *fallback, sf_error *error) {
    const parameter *p = &entries[job->mapping].parameters[k];
    const char *name = entries[job->mapping].name;
    if (!data && !p->has_default)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: %s is missing; it has no default", name, p->name);
    if (data && stride != 0 && stride != p->components)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: the stride of %s is %zu; it must be 0 or %zu", name,
                       p->name, stride, p->components);
    if (!data) {
        for (size_t i = 0; i < p->components; ++i)
            if (is_double)
                ((double *)fallback)[i] = p->default_value;
            else
                ((float *)fallback)[i] = (float)p->default_value;
    }
    job->components[k] = p->components;
    job->parameters[k] = data ? data : fallback;
    job->strides[k] = data ? stride : 0;
    values v = {p->name, job->strides[k] ? job->count : 1, p->components, job->parameters[k], is_double};
    return check(job->mapping, &v, &p->allowed, error);
}

/* Refuses the first rectangle whose edges (b - a) and (c - a) are not at right angles, within
 * 1e-3 of their lengths. */
static sf_status check_corners(const sf_mapping_job *job, int is_double, sf_error *error) {
    values v[3];
    size_t rows = 1;
    for (size_t k = 0; k < 3; ++k) {
        v[k] = (values){NULL, 1, 3, job->parameters[k], is_double};
        if (job->strides[k]) rows = job->count;
    }
    for (size_t i = 0; i < rows; ++i) {
        double ee = 0, ff = 0, ef = 0;
        for (size_t c = 0; c < 3; ++c) {
            double a = value_at(&v[0], i * job->strides[0] + c);
            double e = value_at(&v[1], i * job->strides[1] + c) - a, f = value_at(&v[2], i * job->strides[2] + c) - a;
            ee += e * e;
            ff += f * f;
            ef += e * f;
        }
        if (ef * ef > 1e-6 * ee * ff)
            return sf_fail(
                error, SF_STATUS_INVALID_VALUE,
                "spherical_rectangle: the cosine of the angle at a, between b and c, is %.3g (rectangle %zu); "
                "it must be 0 within 0.001",
                ef / sqrt(ee * ff), i);
    }
    return SF_STATUS_OK;
}

static sf_status fill(sf_mapping mapping, sf_mapping_verb verb, size_t count, const void *in,
                      const void *const *parameters, const size_t *strides, void *out, int is_double, sf_error *error) {
    double fallback[SF_MAPPING_MAX_PARAMETERS][3];
    sf_mapping_job job = {mapping, verb, count, 0, 0, in, out, 0, {0}, {0}, {NULL}};
    if (!is_known(mapping))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "mapping is %d; it must be 0 .. %d", (int)mapping,
                       SF_MAPPING_COUNT - 1);
    size_t width = entries[mapping].width;
    job.in_width = verb == SF_MAPPING_SAMPLE ? 2 : width;
    job.out_width = verb == SF_MAPPING_SAMPLE ? width : verb == SF_MAPPING_INVERT ? 2 : 1;
    job.parameter_count = sf_mapping_parameter_count(mapping);
    sf_status status = check_input(&job, is_double, error);
    for (size_t k = 0; k < job.parameter_count && status == SF_STATUS_OK; ++k)
        status = take_parameter(&job, k, parameters ? parameters[k] : NULL, strides ? strides[k] : 0, is_double,
                                fallback[k], error);
    if (status == SF_STATUS_OK && mapping == SF_MAPPING_SPHERICAL_RECTANGLE)
        status = check_corners(&job, is_double, error);
    if (status != SF_STATUS_OK || count == 0) return status;
    const sf_mapping_kernels *kernels = sf_mapping_kernels_at(sf_isa_active());
    (is_double ? kernels->run_f64 : kernels->run_f32)(&job);
    return SF_STATUS_OK;
}

sf_status sf_mapping_sample_fill_f32(sf_mapping mapping, size_t count, const float *u, const float *const *parameters,
                                     const size_t *strides, float *x, sf_error *error) {
    return fill(mapping, SF_MAPPING_SAMPLE, count, u, (const void *const *)parameters, strides, x, 0, error);
}

sf_status sf_mapping_sample_fill_f64(sf_mapping mapping, size_t count, const double *u, const double *const *parameters,
                                     const size_t *strides, double *x, sf_error *error) {
    return fill(mapping, SF_MAPPING_SAMPLE, count, u, (const void *const *)parameters, strides, x, 1, error);
}

sf_status sf_mapping_pdf_fill_f32(sf_mapping mapping, size_t count, const float *x, const float *const *parameters,
                                  const size_t *strides, float *pdf, sf_error *error) {
    return fill(mapping, SF_MAPPING_PDF, count, x, (const void *const *)parameters, strides, pdf, 0, error);
}

sf_status sf_mapping_pdf_fill_f64(sf_mapping mapping, size_t count, const double *x, const double *const *parameters,
                                  const size_t *strides, double *pdf, sf_error *error) {
    return fill(mapping, SF_MAPPING_PDF, count, x, (const void *const *)parameters, strides, pdf, 1, error);
}

sf_status sf_mapping_invert_fill_f32(sf_mapping mapping, size_t count, const float *x, const float *const *parameters,
                                     const size_t *strides, float *u, sf_error *error) {
    return fill(mapping, SF_MAPPING_INVERT, count, x, (const void *const *)parameters, strides, u, 0, error);
}

sf_status sf_mapping_invert_fill_f64(sf_mapping mapping, size_t count, const double *x, const double *const *parameters,
                                     const size_t *strides, double *u, sf_error *error) {
    return fill(mapping, SF_MAPPING_INVERT, count, x, (const void *const *)parameters, strides, u, 1, error);
}

sf_status sf_mapping_weight_fill_f32(sf_mapping mapping, size_t count, const float *x, const float *const *parameters,
                                     const size_t *strides, float *weight, sf_error *error) {
    return fill(mapping, SF_MAPPING_WEIGHT, count, x, (const void *const *)parameters, strides, weight, 0, error);
}

sf_status sf_mapping_weight_fill_f64(sf_mapping mapping, size_t count, const double *x, const double *const *parameters,
                                     const size_t *strides, double *weight, sf_error *error) {
    return fill(mapping, SF_MAPPING_WEIGHT, count, x, (const void *const *)parameters, strides, weight, 1, error);
}
