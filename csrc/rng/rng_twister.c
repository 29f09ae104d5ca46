// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The Mersenne Twisters behind sf_rng: how each is seeded, drawn, skipped and checked. */
#include "rng/rng_twister.h"

#include <inttypes.h>
#include <string.h>

#include "base/error.h"
#include "rng/rng_methods.h"

enum { WALKED_GENERATIONS = 1 << 13 }; /* as long as half a jump takes */

#define METHOD mt19937
#define WORD uint32_t
#define LENGTH 624
#define MIDDLE 397
#define SEPARATION 31
#define TWIST SF_MT19937_TWIST
#define SEED_MULTIPLIER 1812433253u
#define KEY_MULTIPLIER 1664525u
#define LAST_MULTIPLIER 1566083941u
#include "rng/rng_twister_words.h"

#define METHOD mt19937_64
#define WORD uint64_t
#define LENGTH 312
#define MIDDLE 156
#define SEPARATION 31
#define TWIST SF_MT19937_64_TWIST
#define SEED_MULTIPLIER UINT64_C(6364136223846793005)
#define KEY_MULTIPLIER UINT64_C(3935559000370003845)
#define LAST_MULTIPLIER UINT64_C(2862933555777941757)
#include "rng/rng_twister_words.h"

void sf_mt19937_refill(sf_mt19937 *g) {
    sf_rng_kernels_at(SF_ISA_BASELINE)->mt19937_refill(g->words);
    g->used = 0;
}

void sf_mt19937_64_refill(sf_mt19937_64 *g) {
    sf_rng_kernels_at(SF_ISA_BASELINE)->mt19937_64_refill(g->words);
    g->used = 0;
}

static sf_status seed_mt19937(sf_rng *rng, uint64_t seed, sf_error *error) {
    if (seed >> 32)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "seed is %" PRIu64 "; mt19937 takes 0 .. 4294967295", seed);
    start_mt19937(&rng->as.mt19937, (uint32_t)seed);
    return SF_STATUS_OK;
}

static void seed_stream_mt19937(sf_rng *rng, uint64_t seed, uint64_t stream) {
    const uint32_t key[4] = {(uint32_t)seed, (uint32_t)(seed >> 32), (uint32_t)stream, (uint32_t)(stream >> 32)};
    start_by_key_mt19937(&rng->as.mt19937, key, 4);
}

static sf_status seed_mt19937_64(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    start_mt19937_64(&rng->as.mt19937_64, seed);
    return SF_STATUS_OK;
}

static void seed_stream_mt19937_64(sf_rng *rng, uint64_t seed, uint64_t stream) {
    const uint64_t key[2] = {seed, stream};
    start_by_key_mt19937_64(&rng->as.mt19937_64, key, 2);
}

const sf_rng_method sf_rng_mt19937 = {
    .name = "mt19937",
    .description = "Matsumoto & Nishimura's Mersenne Twister: 32 bits, period 2^19937 - 1, 2.5 KB of state",
    .native_bits = 32,
    .field_bits = 32,
    .field_count = 625,
    .seed = seed_mt19937,
    .seed_stream = seed_stream_mt19937,
    .draw = draw_mt19937,
    .skip = skip_mt19937,
    .fault = fault_mt19937,
};

const sf_rng_method sf_rng_mt19937_64 = {
    .name = "mt19937-64",
    .description = "Nishimura's 64-bit Mersenne Twister: period 2^19937 - 1, 2.5 KB of state",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 313,
    .seed = seed_mt19937_64,
    .seed_stream = seed_stream_mt19937_64,
    .draw = draw_mt19937_64,
    .skip = skip_mt19937_64,
    .fault = fault_mt19937_64,
};
