// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* elementary: the sines, logarithms and exponentials that samples are made of.
 *
 * They are the library's own so that no libm decides a picture: +, -, *, / and integer
 * operations in a fixed order, without branches, so that a loop over them vectorizes and gives
 * the same bits on every instruction set (see exact_begin.h for the caller's flags). Thread-safe.
 *
 * Angles are in turns, [0,1), as the unit square gives them: the reduction is then exact, where
 * one by pi rounds. float: minimax-like polynomials, interpolated at Chebyshev nodes to less
 * than 0.3 of 2^-24; errors over all floats of the stated domain (2^24 and more) are measured
 * by tests/c/test_elementary.c. double: Taylor series, a few ulp.
 */
#ifndef SUNFLECK_ELEMENTARY_H
#define SUNFLECK_ELEMENTARY_H

#include <assert.h>
#include <math.h>
#include <string.h>

#include "sunfleck/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* Functions that are always inlined, where the compiler can be told so: one call left in a loop keeps
 * the loop from vectorizing, and compilers leave calls once a file has many. */
#if defined(__GNUC__) && !defined(SF_EXACT_BY_CALLS)
#define SF_INLINE static inline __attribute__((always_inline))
#else
#define SF_INLINE static inline
#endif

#define SF_PI 3.14159265358979323846
#define SF_PI_F 3.14159265358979323846f
#define SF_UNIT_MAX 0x1.fffffffffffffp-1 /* the largest double below 1 */
#define SF_UNIT_MAX_F 0x1.fffffep-1f     /* the largest float below 1 */

/* What the inline mappings ask of s and t: asserted unless NDEBUG is defined, as a release build
 * does; an assertion keeps a loop from vectorizing. */
#define SF_ASSERT_UNIT(s, t) assert((s) >= 0 && (s) < 1 && (t) >= 0 && (t) < 1)

/* x brought into [0,1): what lies outside goes to the nearer end, NaN to 0. */
SF_INLINE float sf_unit_clamp(float x) {
    float low = x > 0.0f ? x : 0.0f;
    return low < SF_UNIT_MAX_F ? low : SF_UNIT_MAX_F;
}

/* The sine and cosine of r turns, |r| <= 1/8. 6r is exact for multiples of 2^-24 (21 + 2 bits),
 * so that only the small remainder of the series rounds. */
SF_INLINE void sf_sincos_2pi_octant(float r, float *sine, float *cosine) {
    float t = r * r;
    float p = 0x1.21fb52p-2f + t * (-0x1.4abbbap+5f + t * (0x1.465ec4p+6f + t * -0x1.2d9b4p+6f));
    float q = -0x1.3bd3ccp+4f + t * (0x1.03c1eap+6f + t * (-0x1.55cb98p+6f + t * 0x1.db6492p+5f));
    *sine = r * 6.0f + r * p;
    *cosine = 1.0f + t * q;
}

/* The sine and cosine of 2 pi u, u in [0,1]. Exact at the multiples of 1/4. */
SF_INLINE void sf_sincos_2pi(float u, float *sine, float *cosine) {
    /* Take off the nearest quarter turn, which is exact; turn the result back by it. */
    int32_t quarter = ((int32_t)(u * 8.0f) + 1) >> 1;
    float s, c;
    sf_sincos_2pi_octant(u - (float)quarter * 0.25f, &s, &c);
    float first = quarter & 1 ? c : s, second = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -first : first;
    *cosine = (quarter + 1) & 2 ? -second : second;
}

/* The arctangent of low / high in turns, 0 <= low <= high: [0, 1/8]; 0 for 0 / 0. Past 3/5 it
 * is measured from the diagonal: atan z = pi/4 - atan((1 - z) / (1 + z)). */
SF_INLINE float sf_atan_turns(float low, float high) {
    int diagonal = low > 0.6f * high;
    float numerator = diagonal ? high - low : low, denominator = diagonal ? high + low : high;
    float z = numerator / (denominator > 0.0f ? denominator : 1.0f), t = z * z;
    float p = 0x1.04b784p-5f + t * (-0x1.7315acp-6f + t * (0x1.16072p-6f + t * (-0x1.72c65ap-7f + t * 0x1.27e6aep-8f)));
    p = 0x1.7cc1b4p-9f + t * (-0x1.b2991ep-5f + t * p);
    /* The leading 5/32 as 1/8 + 1/32, whose products are exact. */
    float a = z * 0.125f + (z * 0.03125f + z * p);
    return diagonal ? 0.125f - a : a;
}

/* The inverse of sf_sincos_2pi: the angle of (x, y) in turns, [0,1); 0 for the origin. */
SF_INLINE float sf_angle_2pi(float y, float x) {
    float ax = fabsf(x), ay = fabsf(y);
    int steep = ay > ax;
    float a = sf_atan_turns(steep ? ax : ay, steep ? ay : ax);
    a = steep ? 0.25f - a : a;
    a = x < 0.0f ? 0.5f - a : a;
    a = y < 0.0f ? 1.0f - a : a;
    return a < SF_UNIT_MAX_F ? a : SF_UNIT_MAX_F;
}

/* log x + rest, x positive, finite and normal, rest below an ulp of x. */
SF_INLINE float sf_log_with(float x, float rest) {
    /* x = 2^e (1 + f) with 1 + f in [sqrt(1/2), sqrt 2); 0x3f3504f3 is sqrt(1/2). */
    int32_t bits, mantissa;
    memcpy(&bits, &x, 4);
    bits -= 0x3f3504f3;
    mantissa = (bits & 0x007fffff) + 0x3f3504f3;
    float e = (float)(bits >> 23), f;
    memcpy(&f, &mantissa, 4);
    f -= 1.0f;
    float p = -0x1.fffffep-2f +
              f * (0x1.555554p-2f +
                   f * (-0x1.00020cp-2f +
                        f * (0x1.99a012p-3f +
                             f * (-0x1.548382p-3f +
                                  f * (0x1.22ea5ap-3f +
                                       f * (-0x1.0cda32p-3f + f * (0x1.048f72p-3f + f * -0x1.3a4ff6p-4f)))))));
    /* ln 2 in two parts, the first of 9 bits, so that its product with e is exact. */
    return e * 0x1.63p-1f + (f + (f * f * p + (e * -0x1.bd0106p-13f + rest)));
}

/* log x, x positive, finite and normal. */
SF_INLINE float sf_log(float x) { return sf_log_with(x, 0.0f); }

/* log(1 - s), s in [0,1): finite everywhere, and as accurate for the smallest s. */
SF_INLINE float sf_log1m(float s) {
    /* `lost` is exactly what rounding took from v; log(v + lost) = log v + lost / v, nearly. */
    float v = 1.0f - s, lost = (1.0f - v) - s;
    return sf_log_with(v, lost + lost * s);
}

/* x held within +-87, by its bits: a comparison of floats would be threaded into branches. */
SF_INLINE float sf_exp_clamp(float x) {
    int32_t bits, magnitude;
    memcpy(&bits, &x, 4);
    magnitude = bits & 0x7fffffff;
    magnitude = magnitude < 0x42ae0000 ? magnitude : 0x42ae0000; /* 87.0f */
    bits = (int32_t)((uint32_t)bits & 0x80000000u) | magnitude;
    memcpy(&x, &bits, 4);
    return x;
}

/* exp(x) = 2^k (1 + p): k, 2^k and p = exp(f) - 1 of the remainder, |f| <= log(2) / 2. */
SF_INLINE float sf_exp_split(float x, float *power) {
    float scaled = x * 0x1.715476p+0f;
    int32_t k = (int32_t)(scaled + copysignf(0.5f, scaled));
    float f = (x - (float)k * 0x1.63p-1f) - (float)k * -0x1.bd0106p-13f;
    int32_t bits = (k + 127) << 23;
    memcpy(power, &bits, 4);
    float p = 0.5f + f * (0x1.555556p-3f +
                          f * (0x1.5554eap-5f + f * (0x1.1110ep-7f + f * (0x1.6d4316p-10f + f * 0x1.a124e4p-13f))));
    return f + f * f * p;
}

/* exp x for |x| <= 87; beyond, the value at the nearer end: exp(-87) = 1.6e-38, so that the tail
 * of a density stays positive. */
SF_INLINE float sf_exp(float x) {
    float power, p = sf_exp_split(sf_exp_clamp(x), &power);
    return power + power * p;
}

/* exp(x) - 1 without cancellation near 0, for x <= 87. */
SF_INLINE float sf_expm1(float x) {
    float power, p = sf_exp_split(sf_exp_clamp(x), &power);
    return (power - 1.0f) + power * p;
}

/* The cube root of x >= 0 within 6 %, to start an iteration from: a third of the exponent, by the
 * bits of x (Kahan). 0 gives 7e-14. */
SF_INLINE float sf_cbrt_rough(float x) {
    int32_t bits;
    memcpy(&bits, &x, 4);
    bits = bits / 3 + 0x2a514067;
    memcpy(&x, &bits, 4);
    return x;
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
