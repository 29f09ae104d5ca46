// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The bulk mappings: rows of points are taken apart into blocks of separate coordinates, mapped
 * by a loop over the inline function, and put together again. Blocks are of one fixed size, so
 * that every loop vectorizes whole; the last is filled up by repeating its last point. */

#include "mapping/mapping_kernels.h"

#include "base/platform.h"
#include "mapping/mapping_f64.h"

#define BLOCK 128

/* The mappings in the order of sf_mapping, each with the width of its points, its weight (`one`, or
 * a function) and, behind a comma each, the parameters of its functions: P is a scalar, V a
 * vector, from that row on. */
#define ABC , V(0), V(3), V(6)
#define MAPPINGS(X)                                    \
    X(pixel_box, 2, one, )                             \
    X(pixel_tent, 2, one, )                            \
    X(pixel_gaussian, 2, one, , P(0))                  \
    X(pixel_gaussian_truncated, 2, one, , P(0), P(1))  \
    X(pixel_blackman_harris, 2, one, , P(0))           \
    X(pixel_mitchell, 2, sf_pixel_mitchell_weight, )   \
    X(pixel_lanczos, 2, sf_pixel_lanczos_weight, )     \
    X(triangle, 3, one, ABC)                           \
    X(triangle_low_distortion, 3, one, ABC)            \
    X(parallelogram, 3, one, ABC)                      \
    X(disk_polar, 2, one, )                            \
    X(disk_concentric, 2, one, )                       \
    X(disk_naive, 2, one, )                            \
    X(annulus, 2, one, , P(0))                         \
    X(regular_polygon, 2, one, , P(0))                 \
    X(sphere, 3, one, )                                \
    X(hemisphere, 3, one, )                            \
    X(cosine_hemisphere, 3, one, )                     \
    X(cosine_hemisphere_concentric, 3, one, )          \
    X(cone, 3, one, , P(0))                            \
    X(power_cosine, 3, one, , P(0))                    \
    X(henyey_greenstein, 3, one, , P(0))               \
    X(ggx_visible_normals, 3, one, , V(0), P(3), P(4)) \
    X(spherical_triangle, 3, one, ABC, V(9))           \
    X(spherical_rectangle, 3, one, ABC, V(9))

static inline float one(const float *x) {
    (void)x;
    return 1.0f;
}
static inline double one_f64(const double *x) {
    (void)x;
    return 1.0;
}

#define REAL float
#define F(name) name
#define FN(name) name##_f32
#include "mapping/mapping_blocks.h"
#undef REAL
#undef F
#undef FN

#define REAL double
#define F(name) name##_f64
#define FN(name) name##_f64
#include "mapping/mapping_blocks.h"

const sf_mapping_kernels SF_AT_ISA(sf_mapping_kernels) = {run_f32, run_f64, outside_f32, outside_f64};
