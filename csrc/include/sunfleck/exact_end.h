// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* exact_end: the caller's flags hold again; see exact_begin.h. */
#if defined(SF_CONTRACT_OFF)
/* They held all the time. */
#elif defined(__clang__)
#if defined(__x86_64__) || defined(__i386__)
#pragma float_control(pop)
#else
#pragma STDC FP_CONTRACT DEFAULT
#endif
#elif defined(SF_EXACT_BY_CALLS)
#pragma GCC pop_options
#endif
