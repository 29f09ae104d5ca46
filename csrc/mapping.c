// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The table of mappings, and the bulk calls: they check, then hand the work to the kernels. */

#include "sunfleck/mapping.h"

#include <float.h>
#include <string.h>

#include "error.h"
#include "mapping_kernels.h"

/* The values that an input may take, as a closed interval, and in words. Infinity as a bound
 * stands for the largest finite number of the type. */
typedef struct range {
    double low, high;
    const char *words;
} range;

#define FINITE {-(double)INFINITY, (double)INFINITY, "finite"}

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
    {"pixel_gaussian",
     "normal about the pixel's centre, unbounded",
     2,
     {{"mu", 1, 1, 0.4, {1e-6, 1e6, "in [1e-6, 1e6]"}}}},
    {"triangle",
     "a triangle in space, by the square-root map",
     3,
     {{"a", 3, 0, 0.0, FINITE}, {"b", 3, 0, 0.0, FINITE}, {"c", 3, 0, 0.0, FINITE}}},
    {"disk_polar", "the unit disk, by radius sqrt(t) and angle", 2, {{0}}},
    {"disk_concentric", "the unit disk, by squares to circles (Shirley & Chiu 1997)", 2, {{0}}},
    {"disk_naive", "the unit disk with radius t: wrong on purpose, dense at the centre", 2, {{0}}},
    {"sphere", "directions, uniformly", 3, {{0}}},
    {"hemisphere", "directions about +z, uniformly", 3, {{0}}},
    {"cosine_hemisphere", "directions about +z, in proportion to the cosine", 3, {{0}}},
};

static int is_known(sf_mapping mapping) { return (unsigned)mapping < SF_MAPPING_COUNT; }

const char *sf_mapping_name(sf_mapping mapping) { return is_known(mapping) ? entries[mapping].name : NULL; }

const char *sf_mapping_description(sf_mapping mapping) {
    return is_known(mapping) ? entries[mapping].description : NULL;
}

sf_status sf_mapping_find(const char *name, sf_mapping *mapping, sf_error *error) {
    char names[SF_ERROR_MESSAGE_SIZE] = "";
    for (int m = 0; m < SF_MAPPING_COUNT; ++m) {
        if (name && strcmp(name, entries[m].name) == 0) {
            *mapping = (sf_mapping)m;
            return SF_STATUS_OK;
        }
        strncat(names, m ? ", " : "", sizeof names - strlen(names) - 1);
        strncat(names, entries[m].name, sizeof names - strlen(names) - 1);
    }
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "mapping is \"%.40s\"; it must be one of %s", name ? name : "", names);
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

/* Refuses the first value outside its range. */
static sf_status check(sf_mapping mapping, const values *v, const range *allowed, sf_error *error) {
    size_t i = first_outside(v, allowed);
    if (i == v->rows * v->width) return SF_STATUS_OK;
    const char *name = entries[mapping].name;
    int digits = v->is_double ? 17 : 9;
    if (v->rows == 1 && v->width == 1)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: %s is %.*g; it must be %s", name, v->name, digits,
                       value_at(v, i), allowed->words);
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: %s[%zu][%zu] is %.*g; it must be %s", name, v->name,
                   i / v->width, i % v->width, digits, value_at(v, i), allowed->words);
}

static sf_status check_input(const sf_mapping_job *job, int is_double, sf_error *error) {
    static const range finite = FINITE, unit_f32 = {0.0, SF_UNIT_MAX_F, "in [0,1)"},
                       unit_f64 = {0.0, SF_UNIT_MAX, "in [0,1)"};
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
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: the stride of %s is %zu; it must be 0 or %zu", name, p->name,
                       stride, p->components);
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

static sf_status fill(sf_mapping mapping, sf_mapping_verb verb, size_t count, const void *in,
                      const void *const *parameters, const size_t *strides, void *out, int is_double, sf_error *error) {
    double fallback[SF_MAPPING_MAX_PARAMETERS][3];
    sf_mapping_job job = {mapping, verb, count, 0, 0, in, out, 0, {0}, {0}, {NULL}};
    if (!is_known(mapping))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "mapping is %d; it must be 0 .. %d", (int)mapping,
                       SF_MAPPING_COUNT - 1);
    size_t width = entries[mapping].width;
    job.in_width = verb == SF_MAPPING_SAMPLE ? 2 : width;
    job.out_width = verb == SF_MAPPING_SAMPLE ? width : verb == SF_MAPPING_PDF ? 1 : 2;
    job.parameter_count = sf_mapping_parameter_count(mapping);
    sf_status status = check_input(&job, is_double, error);
    for (size_t k = 0; k < job.parameter_count && status == SF_STATUS_OK; ++k)
        status = take_parameter(&job, k, parameters ? parameters[k] : NULL, strides ? strides[k] : 0, is_double,
                                fallback[k], error);
    if (status != SF_STATUS_OK || count == 0) return status;
    const sf_mapping_kernels *kernels = sf_mapping_kernels_at(sf_isa_active());
    (is_double ? kernels->run_f64 : kernels->run_f32)(&job);
    return SF_STATUS_OK;
}

sf_status sf_mapping_sample_fill_f32(sf_mapping mapping, size_t count, const float *u,
                                     const float *const *parameters, const size_t *strides, float *x,
                                     sf_error *error) {
    return fill(mapping, SF_MAPPING_SAMPLE, count, u, (const void *const *)parameters, strides, x, 0, error);
}

sf_status sf_mapping_sample_fill_f64(sf_mapping mapping, size_t count, const double *u,
                                     const double *const *parameters, const size_t *strides, double *x,
                                     sf_error *error) {
    return fill(mapping, SF_MAPPING_SAMPLE, count, u, (const void *const *)parameters, strides, x, 1, error);
}

sf_status sf_mapping_pdf_fill_f32(sf_mapping mapping, size_t count, const float *x,
                                     const float *const *parameters, const size_t *strides, float *pdf,
                                     sf_error *error) {
    return fill(mapping, SF_MAPPING_PDF, count, x, (const void *const *)parameters, strides, pdf, 0, error);
}

sf_status sf_mapping_pdf_fill_f64(sf_mapping mapping, size_t count, const double *x,
                                     const double *const *parameters, const size_t *strides, double *pdf,
                                     sf_error *error) {
    return fill(mapping, SF_MAPPING_PDF, count, x, (const void *const *)parameters, strides, pdf, 1, error);
}

sf_status sf_mapping_invert_fill_f32(sf_mapping mapping, size_t count, const float *x,
                                     const float *const *parameters, const size_t *strides, float *u,
                                     sf_error *error) {
    return fill(mapping, SF_MAPPING_INVERT, count, x, (const void *const *)parameters, strides, u, 0, error);
}

sf_status sf_mapping_invert_fill_f64(sf_mapping mapping, size_t count, const double *x,
                                     const double *const *parameters, const size_t *strides, double *u,
                                     sf_error *error) {
    return fill(mapping, SF_MAPPING_INVERT, count, x, (const void *const *)parameters, strides, u, 1, error);
}
