// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Generators by kind: made, reset, skipped, spawned, and their states read and written. */
#include "sunfleck/rng.h"

#include <assert.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/name.h"
#include "rng/rng_lcg.h"
#include "rng/rng_methods.h"

enum { EXTRA_WORDS = 4 }; /* of a state, beyond the method's own */

/* In the order of sf_rng_kind. */
static const sf_rng_method *const methods[SF_RNG_COUNT] = {
    [SF_RNG_MINSTD] = &sf_rng_minstd,
    [SF_RNG_LCG32] = &sf_rng_lcg32,
    [SF_RNG_LCG64] = &sf_rng_lcg64,
    [SF_RNG_RANDU] = &sf_rng_randu,
    [SF_RNG_RAN1] = &sf_rng_ran1,
    [SF_RNG_RAN2] = &sf_rng_ran2,
    [SF_RNG_XORSHIFT64] = &sf_rng_xorshift64,
    [SF_RNG_XORSHIFT64_LRL] = &sf_rng_xorshift64_lrl,
    [SF_RNG_COMBINED] = &sf_rng_combined,
    [SF_RNG_MT19937] = &sf_rng_mt19937,
    [SF_RNG_MT19937_64] = &sf_rng_mt19937_64,
    [SF_RNG_PCG32] = &sf_rng_pcg32,
    [SF_RNG_PCG64DXSM] = &sf_rng_pcg64dxsm,
    [SF_RNG_XOSHIRO256PP] = &sf_rng_xoshiro256pp,
    [SF_RNG_SFC64] = &sf_rng_sfc64,
    [SF_RNG_PHILOX4X32] = &sf_rng_philox4x32,
    [SF_RNG_PHILOX4X64] = &sf_rng_philox4x64,
    [SF_RNG_SPLITMIX64] = &sf_rng_splitmix64,
};

const sf_rng_method *sf_rng_method_of(const sf_rng *rng) {
    assert((unsigned)rng->kind < SF_RNG_COUNT);
    return methods[rng->kind];
}

/* Copies what is in use: for most methods a hundred bytes of some thousands. */
static void copy_used(sf_rng *to, const sf_rng *from) {
    const sf_rng_method *method = sf_rng_method_of(from);
    memcpy(to, from, offsetof(sf_rng, as) + method->field_count * (method->field_bits / 8));
}

static int is_lcg(sf_rng_kind kind) { return kind == SF_RNG_LCG32 || kind == SF_RNG_LCG64; }

const char *sf_rng_name(sf_rng_kind kind) { return (unsigned)kind < SF_RNG_COUNT ? methods[kind]->name : NULL; }

const char *sf_rng_description(sf_rng_kind kind) {
    return (unsigned)kind < SF_RNG_COUNT ? methods[kind]->description : NULL;
}

unsigned sf_rng_native_bits(sf_rng_kind kind) { return (unsigned)kind < SF_RNG_COUNT ? methods[kind]->native_bits : 0; }

static const char *name_at(int kind) { return sf_rng_name((sf_rng_kind)kind); }

sf_status sf_rng_find(const char *name, sf_rng_kind *kind, sf_error *error) {
    int index = 0;
    sf_status status = sf_name_find("generator", name, name_at, &index, error);
    if (status == SF_STATUS_OK) *kind = (sf_rng_kind)index;
    return status;
}

/* `parameters` are an LCG's, and NULL for all others. */
static sf_status init(sf_rng *rng, sf_rng_kind kind, const sf_lcg_parameters *parameters, uint64_t seed,
                      uint64_t stream, sf_error *error) {
    if (kind == SF_RNG_PCG32 && stream >> 63)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "stream is %" PRIu64 "; pcg32 has streams 0 .. 2^63 - 1",
                       stream);
    sf_rng fresh;
    memset(&fresh, 0, offsetof(sf_rng, as));
    fresh.kind = kind;
    fresh.seed = seed;
    fresh.stream = stream;
    sf_status status = parameters ? sf_lcg_set(&fresh, parameters, error) : SF_STATUS_OK;
    if (status != SF_STATUS_OK) return status;
    if (stream) {
        methods[kind]->seed_stream(&fresh, seed, stream);
    } else {
        status = methods[kind]->seed(&fresh, seed, error);
        if (status != SF_STATUS_OK) return status;
    }
    copy_used(rng, &fresh);
    return SF_STATUS_OK;
}

sf_status sf_rng_init(sf_rng *rng, sf_rng_kind kind, uint64_t seed, uint64_t stream, sf_error *error) {
    if ((unsigned)kind >= SF_RNG_COUNT)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "kind is %d; generators are 0 .. %d", (int)kind,
                       SF_RNG_COUNT - 1);
    sf_lcg_parameters parameters = sf_lcg_parameters_default(kind);
    return init(rng, kind, is_lcg(kind) ? &parameters : NULL, seed, stream, error);
}

sf_status sf_rng_init_lcg(sf_rng *rng, sf_rng_kind kind, const sf_lcg_parameters *parameters, uint64_t seed,
                          uint64_t stream, sf_error *error) {
    if (!is_lcg(kind)) {
        const char *name = sf_rng_name(kind);
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "%s has constants of its own; a, c and m are for lcg32 and lcg64", name ? name : "this kind");
    }
    return init(rng, kind, parameters, seed, stream, error);
}

/* Another generator of the same kind and constants, from a seed that was taken before or a stream
 * above 0, for which every seed is. */
static void init_again(const sf_rng *model, uint64_t seed, uint64_t stream, sf_rng *rng) {
    sf_lcg_parameters parameters = {0, 0, 0};
    if (is_lcg(model->kind)) parameters = sf_lcg_get(model);
    sf_status status = init(rng, model->kind, is_lcg(model->kind) ? &parameters : NULL, seed, stream, NULL);
    assert(status == SF_STATUS_OK);
    (void)status;
}

void sf_rng_reset(sf_rng *rng) { init_again(rng, rng->seed, rng->stream, rng); }

sf_status sf_rng_skip(sf_rng *rng, uint64_t count, sf_error *error) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    if (!method->skip)
        return sf_fail(error, SF_STATUS_UNSUPPORTED, "%s cannot skip: its state has to be walked draw by draw",
                       method->name);
    method->skip(rng, count, sf_rng_kernels_at(sf_isa_active()));
    rng->has_pending = 0;
    rng->pending = 0;
    return SF_STATUS_OK;
}

void sf_rng_spawn(sf_rng *parent, size_t count, sf_rng *children) {
    uint64_t key = sf_hash64(parent->seed, parent->stream);
    for (size_t i = 0; i < count; ++i) {
        uint64_t child = parent->spawned++;
        uint64_t stream = sf_hash64(key, 2 * child + 1) >> 1 | 1;
        init_again(parent, sf_hash64(key, 2 * child), stream, &children[i]);
    }
}

size_t sf_rng_state_size(sf_rng_kind kind) {
    return (unsigned)kind < SF_RNG_COUNT ? methods[kind]->field_count + EXTRA_WORDS : 0;
}

void sf_rng_get_state(const sf_rng *rng, uint64_t *words) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    const unsigned char *fields = (const unsigned char *)&rng->as;
    for (unsigned i = 0; i < method->field_count; ++i) {
        if (method->field_bits == 64) {
            memcpy(&words[i], fields + 8 * i, 8);
        } else {
            uint32_t field;
            memcpy(&field, fields + 4 * i, 4);
            words[i] = field;
        }
    }
    words += method->field_count;
    words[0] = (uint64_t)(rng->has_pending != 0) << 32 | rng->pending;
    words[1] = rng->seed;
    words[2] = rng->stream;
    words[3] = rng->spawned;
}

/* Stores the method's own words; refuses one that its field does not hold. */
static sf_status set_fields(sf_rng *rng, const uint64_t *words, sf_error *error) {
    const sf_rng_method *method = sf_rng_method_of(rng);
    unsigned char *fields = (unsigned char *)&rng->as;
    for (unsigned i = 0; i < method->field_count; ++i) {
        uint32_t field = (uint32_t)words[i];
        if (method->field_bits == 64)
            memcpy(fields + 8 * i, &words[i], 8);
        else if (words[i] > UINT32_MAX)
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "state word %u is %" PRIu64 "; those of %s are below 2^32",
                           i, words[i], method->name);
        else
            memcpy(fields + 4 * i, &field, 4);
    }
    const char *fault = method->fault(rng);
    if (fault) return sf_fail(error, SF_STATUS_INVALID_VALUE, "not a state of %s: %s", method->name, fault);
    return SF_STATUS_OK;
}

sf_status sf_rng_set_state(sf_rng *rng, sf_rng_kind kind, const uint64_t *words, size_t count, sf_error *error) {
    size_t expected = sf_rng_state_size(kind);
    if (!expected)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "kind is %d; generators are 0 .. %d", (int)kind,
                       SF_RNG_COUNT - 1);
    if (count != expected)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "the state has %zu words; that of %s has %zu", count,
                       methods[kind]->name, expected);
    sf_rng fresh;
    memset(&fresh, 0, offsetof(sf_rng, as));
    fresh.kind = kind;
    sf_status status = set_fields(&fresh, words, error);
    if (status != SF_STATUS_OK) return status;
    const uint64_t *extra = words + expected - EXTRA_WORDS;
    if (extra[0] >> 33 || (extra[0] && !(extra[0] >> 32)) || (extra[0] && methods[kind]->native_bits != 64))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "state word %zu is %" PRIu64 "; it is 0, or 2^32 + the waiting half of a 64-bit draw",
                       expected - EXTRA_WORDS, extra[0]);
    fresh.has_pending = (int)(extra[0] >> 32);
    fresh.pending = (uint32_t)extra[0];
    fresh.seed = extra[1];
    fresh.stream = extra[2];
    fresh.spawned = extra[3];
    sf_rng again; /* reset will ask for the same */
    sf_lcg_parameters parameters = is_lcg(kind) ? sf_lcg_get(&fresh) : (sf_lcg_parameters){0, 0, 0};
    status = init(&again, kind, is_lcg(kind) ? &parameters : NULL, fresh.seed, fresh.stream, error);
    if (status != SF_STATUS_OK) return status;
    copy_used(rng, &fresh);
    return SF_STATUS_OK;
}
