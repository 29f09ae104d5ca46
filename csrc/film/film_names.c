// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Names of what the options and the film enumerate: filters, rules, reasons, policies, kinds of work. */
#include <stddef.h>

#include "sunfleck/film.h"

const char *sf_pixel_filter_name(sf_pixel_filter filter) {
    static const char *const names[] = {"box",      "tent",   "gaussian", "gaussian_truncated", "blackman_harris",
                                        "mitchell", "lanczos"};
    return (unsigned)filter < sizeof names / sizeof *names ? names[filter] : NULL;
}

const char *sf_work_name(sf_work work) {
    static const char *const names[] = {"coordinates", "camera", "camera rays", "shadow rays", "surface rays",
                                        "vertices",    "light",  "surface",     "sums",        "film"};
    return (unsigned)work < SF_WORK_COUNT ? names[work] : NULL;
}

const char *sf_stop_rule_name(sf_stop_rule rule) {
    static const char *const names[] = {"standard_error", "replicates", "dyadic"};
    return (unsigned)rule < 3 ? names[rule] : NULL;
}

const char *sf_seed_policy_name(sf_seed_policy policy) {
    static const char *const names[] = {"pixel", "thread", "shared"};
    return (unsigned)policy < 3 ? names[policy] : NULL;
}

const char *sf_stop_reason_name(sf_stop_reason reason) {
    static const char *const names[] = {"fixed",      "met",         "max_samples", "out_of_time",
                                        "suspicious", "interrupted", "masked"};
    return (unsigned)reason < SF_STOP_REASON_COUNT ? names[reason] : NULL;
}
