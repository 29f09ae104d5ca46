// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the tests of generators share. cmocka.h comes first. */
#ifndef SUNFLECK_RNG_CASES_H
#define SUNFLECK_RNG_CASES_H

#include "sunfleck/rng.h"

#define FOR_EACH_KIND(kind) for (sf_rng_kind kind = (sf_rng_kind)0; kind < SF_RNG_COUNT; kind = (sf_rng_kind)(kind + 1))

/* An odd seed below 2^31 is one that every method takes. */
static inline sf_rng seeded(sf_rng_kind kind, uint64_t seed) {
    sf_rng rng;
    assert_int_equal(sf_rng_init(&rng, kind, seed, 0, NULL), SF_STATUS_OK);
    return rng;
}

static inline uint64_t draw_number(sf_rng rng, uint64_t n) {
    uint64_t word = 0;
    for (uint64_t i = 0; i < n; ++i) word = sf_rng_next_raw(&rng);
    return word;
}

#endif
