// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The terms of a GGX microsurface in bulk: they check, then loop over the inline functions. */

#include <math.h>

#include "base/error.h"
#include "mapping/mapping_f64.h"
#include "sunfleck/mapping.h"

static const char *const names[SF_GGX_TERM_COUNT] = {"ggx_normals", "ggx_masking", "ggx_masking_shadowing"};

/* An input: directions (3 values) or roughnesses (1), one for all points (stride 0) or one each. */
typedef struct input {
    const char *name;
    const void *data;
    size_t rows, stride;
    int is_double;
} input;

static double value_at(const input *in, size_t i) {
    return in->is_double ? ((const double *)in->data)[i] : (double)((const float *)in->data)[i];
}

/* Refuses the first that has not length 1, within the rounding of floats. */
static sf_status check_directions(sf_ggx_term term, const input *in, sf_error *error) {
    for (size_t i = 0; i < in->rows; ++i) {
        double x = value_at(in, 3 * i), y = value_at(in, 3 * i + 1), z = value_at(in, 3 * i + 2);
        int digits = in->is_double ? 17 : 9;
        if (!(fabs(x * x + y * y + z * z - 1.0) < 1e-5))
            return sf_fail(error, SF_STATUS_INVALID_VALUE,
                           "%s: %s[%zu] is (%.*g, %.*g, %.*g); it must be a direction of length 1", names[term],
                           in->name, i, digits, x, digits, y, digits, z);
    }
    return SF_STATUS_OK;
}

static sf_status check_roughness(sf_ggx_term term, const input *in, sf_error *error) {
    double low = in->is_double ? 1e-4 : (double)1e-4f;
    for (size_t i = 0; i < in->rows; ++i) {
        double alpha = value_at(in, i);
        if (!(alpha >= low && alpha <= 10.0))
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: %s[%zu] is %.*g; it must be in [1e-4, 10]", names[term],
                           in->name, i, in->is_double ? 17 : 9, alpha);
    }
    return SF_STATUS_OK;
}

static sf_status check(sf_ggx_term term, size_t count, const void *w, const void *v, const void *const alpha[2],
                       const size_t strides[3], int is_double, sf_error *error) {
    if ((unsigned)term >= SF_GGX_TERM_COUNT)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "term is %d; it must be 0 .. %d", (int)term,
                       SF_GGX_TERM_COUNT - 1);
    for (int k = 0; k < 3; ++k) {
        size_t width = k == 0 ? 3 : 1;
        if (strides[k] != 0 && strides[k] != width)
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s: strides[%d] is %zu; it must be 0 or %zu", names[term],
                           k, strides[k], width);
    }
    input first = {term == SF_GGX_NORMALS ? "h" : "w", w, count, 3, is_double};
    input second = {"v", v, strides[0] ? count : 1, strides[0], is_double};
    input across = {"alpha_x", alpha[0], strides[1] ? count : 1, strides[1], is_double};
    input along = {"alpha_y", alpha[1], strides[2] ? count : 1, strides[2], is_double};
    sf_status status = check_directions(term, &first, error);
    if (status == SF_STATUS_OK && term == SF_GGX_MASKING_SHADOWING) status = check_directions(term, &second, error);
    if (status == SF_STATUS_OK) status = check_roughness(term, &across, error);
    if (status == SF_STATUS_OK) status = check_roughness(term, &along, error);
    return status;
}

static const size_t all_0[3] = {0, 0, 0};

sf_status sf_ggx_fill_f32(sf_ggx_term term, size_t count, const float *w, const float *v, const float *alpha_x,
                          const float *alpha_y, const size_t *strides, float *values, sf_error *error) {
    const size_t *step = strides ? strides : all_0;
    const void *const alpha[2] = {alpha_x, alpha_y};
    sf_status status = check(term, count, w, v, alpha, step, 0, error);
    if (status != SF_STATUS_OK) return status;
    for (size_t i = 0; i < count; ++i) {
        float a_x = alpha_x[i * step[1]], a_y = alpha_y[i * step[2]];
        if (term == SF_GGX_NORMALS)
            values[i] = sf_ggx_normals(w + 3 * i, a_x, a_y);
        else if (term == SF_GGX_MASKING)
            values[i] = sf_ggx_masking(w + 3 * i, a_x, a_y);
        else
            values[i] = sf_ggx_masking_shadowing(w + 3 * i, v + i * step[0], a_x, a_y);
    }
    return SF_STATUS_OK;
}

sf_status sf_ggx_fill_f64(sf_ggx_term term, size_t count, const double *w, const double *v, const double *alpha_x,
                          const double *alpha_y, const size_t *strides, double *values, sf_error *error) {
    const size_t *step = strides ? strides : all_0;
    const void *const alpha[2] = {alpha_x, alpha_y};
    sf_status status = check(term, count, w, v, alpha, step, 1, error);
    if (status != SF_STATUS_OK) return status;
    for (size_t i = 0; i < count; ++i) {
        double a_x = alpha_x[i * step[1]], a_y = alpha_y[i * step[2]];
        if (term == SF_GGX_NORMALS)
            values[i] = sf_ggx_normals_f64(w + 3 * i, a_x, a_y);
        else if (term == SF_GGX_MASKING)
            values[i] = sf_ggx_masking_f64(w + 3 * i, a_x, a_y);
        else
            values[i] = sf_ggx_masking_shadowing_f64(w + 3 * i, v + i * step[0], a_x, a_y);
    }
    return SF_STATUS_OK;
}
