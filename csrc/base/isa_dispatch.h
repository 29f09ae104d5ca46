// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* How kernels are compiled once per instruction set and chosen at run time.
 *
 * A file NAME_kernels.c is compiled three times, with SF_ISA_SUFFIX = baseline, avx2, avx512 (once,
 * as baseline, on processors other than x86-64). It keeps its functions static and exports one
 * table of them:
 *
 *     const sf_points_kernels SF_AT_ISA(sf_points_kernels) = {sobol_fill, ...};
 *
 * The header NAME_kernels.h declares the table's type and, with SF_KERNELS(sf_points_kernels),
 * its accessor `sf_points_kernels_at(isa)`.
 *
 * All levels give the same bits: kernels use +, -, *, /, sqrt and integers only, contraction
 * into fused multiply-adds is off, and reductions are written in a fixed order. */
#ifndef SUNFLECK_ISA_DISPATCH_H
#define SUNFLECK_ISA_DISPATCH_H

#include "sunfleck/base.h"

#define SF_JOIN_(a, b) a##_##b
#define SF_JOIN(a, b) SF_JOIN_(a, b)
#ifdef SF_ISA_SUFFIX
#define SF_AT_ISA(name) SF_JOIN(name, SF_ISA_SUFFIX)
#endif

#ifdef SF_HAVE_ISAS
#define SF_KERNELS(T)                                                                               \
    extern const T T##_baseline, T##_avx2, T##_avx512;                                              \
    static inline const T *T##_at(sf_isa isa) {                                                     \
        return isa == SF_ISA_AVX512 ? &T##_avx512 : isa == SF_ISA_AVX2 ? &T##_avx2 : &T##_baseline; \
    }
#else
#define SF_KERNELS(T)                           \
    extern const T T##_baseline;                \
    static inline const T *T##_at(sf_isa isa) { \
        (void)isa;                              \
        return &T##_baseline;                   \
    }
#endif

#endif
