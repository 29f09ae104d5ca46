// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* exact_begin: from here to exact_end.h the compiler fuses no product with a sum, whatever the caller's flags.
 *
 * A fused multiply-add rounds once where C says twice: other bits than the library's own. Compilers fuse by
 * default where the processor can (GCC unless it is told -std=c99, clang within an expression), so that
 * the inline functions would depend on the caller's flags. Their headers stand between these two.
 *
 * - Compile with -ffp-contract=off and -DSF_CONTRACT_OFF, as the CMake and the pkg-config package
 *   have it, and nothing here is needed: functions are inlined into loops that vectorize.
 * - Without them, where the processor fuses, clang heeds its pragma at no cost. GCC knows no such pragma; its functions
 *   get an attribute, by which they are no longer inlined into functions that lack it. The bits are
 *   right, and each call costs what a call does. A caller's functions between the two headers are inlined into.
 * - -ffast-math, and an explicit -ffp-contract=fast under clang, ask for other bits and get them.
 *
 * It has no guard: each header that needs it includes it. */
#if defined(SF_CONTRACT_OFF)
/* The caller's flags see to it. */
#elif defined(__clang__)
#if defined(__x86_64__) || defined(__i386__)
#pragma float_control(push)
#endif
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF)) && \
    (defined(__cplusplus) || !defined(__STRICT_ANSI__))
#ifndef SF_EXACT_BY_CALLS
#define SF_EXACT_BY_CALLS 1 /* SF_INLINE does not force what would fuse */
#endif
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off")
#endif
