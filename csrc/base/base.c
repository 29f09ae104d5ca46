// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Version, names of statuses, how names compare, and the instruction set that kernels run at. */
#include "sunfleck/base.h"

#include <stdlib.h>

#define SF_TEXT_(x) #x
#define SF_TEXT(x) SF_TEXT_(x)

const char *sf_version(void) {
    return SF_TEXT(SF_VERSION_MAJOR) "." SF_TEXT(SF_VERSION_MINOR) "." SF_TEXT(SF_VERSION_PATCH);
}

const char *sf_status_name(sf_status status) {
    switch (status) {
        case SF_STATUS_OK: return "ok";
        case SF_STATUS_INVALID_VALUE: return "invalid value";
        case SF_STATUS_OUT_OF_MEMORY: return "out of memory";
        case SF_STATUS_IO: return "input/output error";
        case SF_STATUS_UNSUPPORTED: return "unsupported";
        case SF_STATUS_BACKEND: return "backend error";
        case SF_STATUS_INTERRUPTED: return "interrupted";
    }
    return "unknown status";
}

/* What a character stands for: small letters for capital ones, and one separator of words for all three. Of ASCII
 * alone, in which all names are; the C library's `tolower` depends on the locale. */
static int folded(char c) { return c == '-' || c == ' ' ? '_' : c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; }

int sf_name_matches(const char *name, const char *known) {
    if (!name || !known) return 0;
    while (*name && folded(*name) == folded(*known)) ++name, ++known;
    return *name == *known;
}

const char *sf_isa_name(sf_isa isa) {
    return isa == SF_ISA_AVX512 ? "avx512" : isa == SF_ISA_AVX2 ? "avx2" : "baseline";
}

/* The features of the x86-64-v4 and -v3 levels (System V ABI), which the kernels are built for. */
static sf_isa processor_isa(void) {
#ifdef SF_HAVE_ISAS
    int v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
             __builtin_cpu_supports("bmi2");
    int v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl");
    return v4 ? SF_ISA_AVX512 : v3 ? SF_ISA_AVX2 : SF_ISA_BASELINE;
#else
    return SF_ISA_BASELINE;
#endif
}

sf_isa sf_isa_active(void) {
    sf_isa best = processor_isa();
    const char *asked = getenv("SUNFLECK_ISA");
    if (!asked) return best;
    for (int isa = SF_ISA_BASELINE; isa <= (int)best; ++isa)
        if (sf_name_matches(asked, sf_isa_name((sf_isa)isa))) return (sf_isa)isa;
    return best;
}
