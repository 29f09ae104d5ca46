// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The bulk mappings: rows of points are taken apart into blocks of separate coordinates, mapped
 * by a loop over the inline function, and put together again. Blocks are of one fixed size, so
 * that every loop vectorizes whole; the last is filled up by repeating its last point. */

#include "mapping_kernels.h"

#include "mapping_f64.h"
#include "platform.h"

#define BLOCK 128

/* The mappings in the order of sf_mapping, each with the width of its points and, behind a comma
 * each, the parameters of its functions: P is a scalar, V a vector, from that row on. */
#define MAPPINGS(X)                         \
    X(pixel_box, 2, )                       \
    X(pixel_tent, 2, )                      \
    X(pixel_gaussian, 2, , P(0))            \
    X(triangle, 3, , V(0), V(3), V(6))      \
    X(disk_polar, 2, )                      \
    X(disk_concentric, 2, )                 \
    X(disk_naive, 2, )                      \
    X(sphere, 3, )                          \
    X(hemisphere, 3, )                      \
    X(cosine_hemisphere, 3, )

#define REAL float
#define F(name) name
#define FN(name) name##_f32
#include "mapping_blocks.h"
#undef REAL
#undef F
#undef FN

#define REAL double
#define F(name) name##_f64
#define FN(name) name##_f64
#include "mapping_blocks.h"

const sf_mapping_kernels SF_AT_LEVEL(sf_mapping_kernels) = {run_f32, run_f64, outside_f32, outside_f64};
