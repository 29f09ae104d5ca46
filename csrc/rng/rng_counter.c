// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The methods that count behind sf_rng: how each is seeded, drawn, skipped and checked. */
#include <string.h>

#include "rng/rng_methods.h"

#define GOLDEN UINT64_C(0x9e3779b97f4a7c15)

SF_RNG_DRAW(sfc64, sfc64, uint64_t)

static const char *no_fault(const sf_rng *rng) {
    (void)rng;
    return NULL;
}

/* ---- splitmix64 ---- */

static sf_status seed_splitmix64(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    rng->as.splitmix64.state = seed;
    return SF_STATUS_OK;
}

static void seed_stream_splitmix64(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.splitmix64.state = sf_hash64(seed, stream);
}

static void draw_splitmix64(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) {
    kernels->splitmix64(rng->as.splitmix64.state, count, out);
    rng->as.splitmix64.state += count * GOLDEN;
}

static void skip_splitmix64(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    (void)kernels;
    rng->as.splitmix64.state += count * GOLDEN;
}

const sf_rng_method sf_rng_splitmix64 = {
    .name = "splitmix64",
    .description = "Steele, Lea & Flood's SplitMix64: a mixed counter, each 64-bit word once",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 1,
    .seed = seed_splitmix64,
    .seed_stream = seed_stream_splitmix64,
    .draw = draw_splitmix64,
    .skip = skip_splitmix64,
    .fault = no_fault,
};

/* ---- sfc64 ---- */

static void start_sfc64(sf_sfc64 *g, uint64_t a, uint64_t b, uint64_t c) {
    *g = (sf_sfc64){a, b, c, 1};
    for (int i = 0; i < 12; ++i) sf_sfc64_next(g);
}

static sf_status seed_sfc64(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    start_sfc64(&rng->as.sfc64, seed, seed, seed);
    return SF_STATUS_OK;
}

static void seed_stream_sfc64(sf_rng *rng, uint64_t seed, uint64_t stream) {
    sf_splitmix64 seeder = {sf_hash64(seed, stream)};
    uint64_t a = sf_splitmix64_next(&seeder), b = sf_splitmix64_next(&seeder), c = sf_splitmix64_next(&seeder);
    start_sfc64(&rng->as.sfc64, a, b, c);
}

const sf_rng_method sf_rng_sfc64 = {
    .name = "sfc64",
    .description = "Doty-Humphrey's sfc64, as in NumPy: three chaotic words and a counter, 64 bits; no skip",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 4,
    .seed = seed_sfc64,
    .seed_stream = seed_stream_sfc64,
    .draw = draw_sfc64,
    .fault = no_fault,
};

/* ---- Philox, in words of 32 and 64 bits ---- */

/* The kernels count in the low 64 bits of the counter alone. */
static uint64_t blocks_before_carry(uint64_t low) { return low ? -low : UINT64_MAX; }

static uint64_t blocks_before_carry_philox4x32(const sf_philox4x32 *g) {
    return blocks_before_carry((uint64_t)g->counter[1] << 32 | g->counter[0]);
}

static uint64_t blocks_before_carry_philox4x64(const sf_philox4x64 *g) { return blocks_before_carry(g->counter[0]); }

#define METHOD philox4x32
#define WORD uint32_t
#include "rng/rng_philox.h"

#define METHOD philox4x64
#define WORD uint64_t
#include "rng/rng_philox.h"

static void seed_stream_philox4x32(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.philox4x32 = (sf_philox4x32){.counter = {0, 0, (uint32_t)stream, (uint32_t)(stream >> 32)},
                                         .key = {(uint32_t)seed, (uint32_t)(seed >> 32)},
                                         .used = 4};
}

static sf_status seed_philox4x32(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    seed_stream_philox4x32(rng, seed, 0);
    return SF_STATUS_OK;
}

static void seed_stream_philox4x64(sf_rng *rng, uint64_t seed, uint64_t stream) {
    rng->as.philox4x64 = (sf_philox4x64){.key = {seed, stream}, .used = 4};
}

static sf_status seed_philox4x64(sf_rng *rng, uint64_t seed, sf_error *error) {
    (void)error;
    seed_stream_philox4x64(rng, seed, 0);
    return SF_STATUS_OK;
}

const sf_rng_method sf_rng_philox4x32 = {
    .name = "philox4x32",
    .description = "Salmon et al.'s Philox 4x32-10: a counter through ten keyed rounds, 32 bits, 2^64 streams",
    .native_bits = 32,
    .field_bits = 32,
    .field_count = 11,
    .seed = seed_philox4x32,
    .seed_stream = seed_stream_philox4x32,
    .draw = draw_philox4x32,
    .skip = skip_philox4x32,
    .fault = fault_philox4x32,
};

const sf_rng_method sf_rng_philox4x64 = {
    .name = "philox4x64",
    .description = "Philox 4x64-10, as in NumPy: a counter through ten keyed rounds, 64 bits, 2^64 streams",
    .native_bits = 64,
    .field_bits = 64,
    .field_count = 11,
    .seed = seed_philox4x64,
    .seed_stream = seed_stream_philox4x64,
    .draw = draw_philox4x64,
    .skip = skip_philox4x64,
    .fault = fault_philox4x64,
};
