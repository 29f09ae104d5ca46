// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* mapping: the unit square onto the shapes that a renderer samples.
 *
 * A mapping is a triple. `sample` takes (s, t) in [0,1)^2 to a point x of the shape, so that
 * uniform points become points of the mapping's density; `pdf` is that density at x, its measure
 * named (area, solid angle); `invert` takes x back to (s, t) in [0,1)^2. Parameters follow the
 * points. Each function names the source of its formula.
 *
 * Inline, for one's own loops (mapping_pixel.h, mapping_plane.h, mapping_sphere.h, mapping_lobe.h,
 * mapping_light.h): float, no branches, no libm
 * but what compiles to one instruction (sqrtf, fabsf, copysignf), so that loops over them
 * vectorize under -fno-math-errno; the same bits on every instruction set. They cannot
 * fail: their preconditions are u in [0,1) and parameters in their ranges, asserted unless NDEBUG
 * is defined (an assertion keeps a loop from vectorizing).
 *
 * In bulk, float and double: the functions at the end of this header. They check first. What
 * depends on data of any size is in discrete.h: alias tables, piecewise constant densities.
 *
 * What is common: samples are finite, and pdf(sample(u)) is finite and positive for every u in
 * [0,1), subnormals included, except at the zeros and poles that each states. A point that is
 * not of the shape has pdf 0 unless stated otherwise, and invert gives some point of [0,1)^2
 * for it. Every function is thread-safe.
 */
#ifndef SUNFLECK_MAPPING_H
#define SUNFLECK_MAPPING_H

#include "sunfleck/base.h"
#include "sunfleck/mapping_light.h"
#include "sunfleck/mapping_lobe.h"
#include "sunfleck/mapping_pixel.h"
#include "sunfleck/mapping_plane.h"
#include "sunfleck/mapping_sphere.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The mappings by number. The numbers may change between releases, the names do not. */
typedef enum sf_mapping {
    SF_MAPPING_PIXEL_BOX = 0,
    SF_MAPPING_PIXEL_TENT,
    SF_MAPPING_PIXEL_GAUSSIAN,
    SF_MAPPING_PIXEL_GAUSSIAN_TRUNCATED,
    SF_MAPPING_PIXEL_BLACKMAN_HARRIS,
    SF_MAPPING_PIXEL_MITCHELL,
    SF_MAPPING_PIXEL_LANCZOS,
    SF_MAPPING_TRIANGLE,
    SF_MAPPING_TRIANGLE_LOW_DISTORTION,
    SF_MAPPING_PARALLELOGRAM,
    SF_MAPPING_DISK_POLAR,
    SF_MAPPING_DISK_CONCENTRIC,
    SF_MAPPING_DISK_NAIVE,
    SF_MAPPING_ANNULUS,
    SF_MAPPING_REGULAR_POLYGON,
    SF_MAPPING_SPHERE,
    SF_MAPPING_HEMISPHERE,
    SF_MAPPING_COSINE_HEMISPHERE,
    SF_MAPPING_COSINE_HEMISPHERE_CONCENTRIC,
    SF_MAPPING_CONE,
    SF_MAPPING_POWER_COSINE,
    SF_MAPPING_HENYEY_GREENSTEIN,
    SF_MAPPING_GGX_VISIBLE_NORMALS,
    SF_MAPPING_SPHERICAL_TRIANGLE,
    SF_MAPPING_SPHERICAL_RECTANGLE,
    SF_MAPPING_COUNT
} sf_mapping;

/* "pixel_box", …, and a line about each; NULL beyond the last, so that they can be listed. */
SF_API const char *sf_mapping_name(sf_mapping mapping);
SF_API const char *sf_mapping_description(sf_mapping mapping);

/* The mapping called `name`; the error lists the names. */
SF_API sf_status sf_mapping_find(const char *name, sf_mapping *mapping, sf_error *error);

/* Values per point: of u (2 for every mapping so far) and of x (2 or 3); 0 for an unknown
 * mapping. */
SF_API size_t sf_mapping_input_width(sf_mapping mapping);
SF_API size_t sf_mapping_output_width(sf_mapping mapping);

/* A parameter of a mapping, in the order in which they follow the points. */
typedef struct sf_mapping_parameter {
    const char *name;     /* "mu", "a", … */
    size_t components;    /* 1, or 3 for a point or direction */
    int has_default;      /* else it must be given */
    double default_value; /* of every component */
    const char *range;    /* the values allowed, in words: "positive and finite", … */
} sf_mapping_parameter;

SF_API size_t sf_mapping_parameter_count(sf_mapping mapping);
SF_API sf_mapping_parameter sf_mapping_parameter_at(sf_mapping mapping, size_t index); /* below the count */

#define SF_MAPPING_MAX_PARAMETERS 4

/* Maps `count` points.
 *
 * u, x        count * input_width and count * output_width values, row-major; the output may not
 *             overlap an input. pdf writes one value a point
 * parameters  one pointer for each parameter of the mapping; a NULL pointer stands for the
 *             default. NULL: all of them are at their defaults
 * strides     for each parameter the values from one point to the next: 0 = one value for all
 *             points, `components` = one for each point, packed. NULL: all 0
 *
 * u must be in [0,1), x finite, parameters in their ranges: one pass over the inputs, made
 * before anything is written, refuses what is not, naming the point, the value and the range. It
 * costs 0.09 ns a value with AVX-512 (docs/mapping.md).
 * Results are the inline functions' own, bit for bit (float); double has the same formulas. */
SF_API sf_status sf_mapping_sample_fill_f32(sf_mapping mapping, size_t count, const float *u,
                                            const float *const *parameters, const size_t *strides, float *x,
                                            sf_error *error);
SF_API sf_status sf_mapping_sample_fill_f64(sf_mapping mapping, size_t count, const double *u,
                                            const double *const *parameters, const size_t *strides, double *x,
                                            sf_error *error);
SF_API sf_status sf_mapping_pdf_fill_f32(sf_mapping mapping, size_t count, const float *x,
                                         const float *const *parameters, const size_t *strides, float *pdf,
                                         sf_error *error);
SF_API sf_status sf_mapping_pdf_fill_f64(sf_mapping mapping, size_t count, const double *x,
                                         const double *const *parameters, const size_t *strides, double *pdf,
                                         sf_error *error);
/* What each point counts: 1, but for filters with negative lobes, whose |f| is sampled: the sign of
 * f times the integral of |f| over that of f. */
SF_API sf_status sf_mapping_weight_fill_f32(sf_mapping mapping, size_t count, const float *x,
                                            const float *const *parameters, const size_t *strides, float *weight,
                                            sf_error *error);
SF_API sf_status sf_mapping_weight_fill_f64(sf_mapping mapping, size_t count, const double *x,
                                            const double *const *parameters, const size_t *strides, double *weight,
                                            sf_error *error);
SF_API sf_status sf_mapping_invert_fill_f32(sf_mapping mapping, size_t count, const float *x,
                                            const float *const *parameters, const size_t *strides, float *u,
                                            sf_error *error);
SF_API sf_status sf_mapping_invert_fill_f64(sf_mapping mapping, size_t count, const double *x,
                                            const double *const *parameters, const size_t *strides, double *u,
                                            sf_error *error);

/* The terms of a GGX microsurface (mapping_lobe.h) beside its visible normals. */
typedef enum sf_ggx_term {
    SF_GGX_NORMALS = 0,       /* the density of the normals at w = h, per solid angle and unit of surface */
    SF_GGX_MASKING,           /* Smith's G1: the share of what faces w that is seen from it */
    SF_GGX_MASKING_SHADOWING, /* Smith's G2, height-correlated: seen from w and from v */
    SF_GGX_TERM_COUNT
} sf_ggx_term;

/* A term for `count` directions.
 *
 * w, v              directions of length 1 (within 1e-5 of its square), packed; v only for
 *                   MASKING_SHADOWING, else NULL. Below the horizon every term is 0
 * alpha_x, alpha_y  roughness, in [1e-4, 10]
 * strides           of v (0 or 3), alpha_x and alpha_y (0 or 1): 0 = one for all. NULL: all 0
 * values            `count`, apart from the inputs; nothing is written when an input is refused
 *
 * The inline functions' own results, bit for bit (float). Thread-safe. */
SF_API sf_status sf_ggx_fill_f32(sf_ggx_term term, size_t count, const float *w, const float *v, const float *alpha_x,
                                 const float *alpha_y, const size_t *strides, float *values, sf_error *error);
SF_API sf_status sf_ggx_fill_f64(sf_ggx_term term, size_t count, const double *w, const double *v,
                                 const double *alpha_x, const double *alpha_y, const size_t *strides, double *values,
                                 sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
