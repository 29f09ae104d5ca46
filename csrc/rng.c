// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "sunfleck/rng.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "rng_methods.h"

enum {
    BLOCK_WORDS = 1024, /* raw draws kept in the first cache between drawing and converting */
    EXTRA_WORDS = 4     /* of a state, beyond the method's own */
};

static const sf_rng_method *method_of(const sf_rng *rng) {
    assert((unsigned)rng->kind < SF_RNG_COUNT);
    return &sf_rng_methods[rng->kind];
}

/* Asking for the level costs as much as dozens of draws. */
static const sf_rng_kernels *kernels_for(size_t count) {
    return sf_rng_kernels_at(count < 64 ? SF_ISA_BASELINE : sf_isa_active());
}

const char *sf_rng_name(sf_rng_kind kind) {
    return (unsigned)kind < SF_RNG_COUNT ? sf_rng_methods[kind].name : NULL;
}

const char *sf_rng_description(sf_rng_kind kind) {
    return (unsigned)kind < SF_RNG_COUNT ? sf_rng_methods[kind].description : NULL;
}

unsigned sf_rng_native_bits(sf_rng_kind kind) {
    return (unsigned)kind < SF_RNG_COUNT ? sf_rng_methods[kind].native_bits : 0;
}

sf_status sf_rng_find(const char *name, sf_rng_kind *kind, sf_error *error) {
    for (unsigned k = 0; k < SF_RNG_COUNT; ++k)
        if (strcmp(name, sf_rng_methods[k].name) == 0) {
            *kind = (sf_rng_kind)k;
            return SF_STATUS_OK;
        }
    char names[384] = "";
    for (unsigned k = 0; k < SF_RNG_COUNT; ++k) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", k ? ", " : "", sf_rng_methods[k].name);
    }
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "no generator is called '%.64s'; there are %s", name, names);
}

sf_status sf_rng_init(sf_rng *rng, sf_rng_kind kind, uint64_t seed, uint64_t stream, sf_error *error) {
    if ((unsigned)kind >= SF_RNG_COUNT)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "kind is %d; generators are 0 .. %d", (int)kind,
                       SF_RNG_COUNT - 1);
    if (kind == SF_RNG_PCG32 && stream >> 63)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "stream is %" PRIu64 "; pcg32 has streams 0 .. 2^63 - 1",
                       stream);
    sf_rng fresh;
    memset(&fresh, 0, sizeof fresh);
    fresh.kind = kind;
    fresh.seed = seed;
    fresh.stream = stream;
    if (stream) {
        sf_rng_methods[kind].seed_stream(&fresh, seed, stream);
    } else {
        sf_status status = sf_rng_methods[kind].seed(&fresh, seed, error);
        if (status != SF_STATUS_OK) return status;
    }
    *rng = fresh;
    return SF_STATUS_OK;
}

uint64_t sf_rng_next_raw(sf_rng *rng) {
    switch (rng->kind) {
        case SF_RNG_MINSTD: return sf_minstd_next(&rng->as.minstd);
        case SF_RNG_XORSHIFT64: return sf_xorshift64_next(&rng->as.xorshift64);
        case SF_RNG_XORSHIFT64_LRL: return sf_xorshift64_lrl_next(&rng->as.xorshift64);
        case SF_RNG_COMBINED: return sf_combined_next(&rng->as.combined);
        case SF_RNG_PCG32: return sf_pcg32_next(&rng->as.pcg32);
        case SF_RNG_XOSHIRO256PP: return sf_xoshiro256pp_next(&rng->as.xoshiro256pp);
        case SF_RNG_SPLITMIX64: return sf_splitmix64_next(&rng->as.splitmix64);
        case SF_RNG_COUNT: break;
    }
    assert(!"rng was initialized");
    return 0;
}

/* The halves of 64-bit draws, low first; an odd one waits in the generator. */
static void draw_halves(sf_rng *rng, size_t count, uint32_t *out, const sf_rng_kernels *kernels) {
    const sf_rng_method *method = method_of(rng);
    uint64_t block[BLOCK_WORDS / 2];
    if (count && rng->has_pending) {
        *out++ = rng->pending;
        rng->has_pending = 0;
        rng->pending = 0;
        --count;
    }
    while (count > 1) {
        size_t pairs = count / 2 < BLOCK_WORDS / 2 ? count / 2 : BLOCK_WORDS / 2;
        method->draw(rng, pairs, block, kernels);
        for (size_t i = 0; i < pairs; ++i) {
            out[2 * i] = (uint32_t)block[i];
            out[2 * i + 1] = (uint32_t)(block[i] >> 32);
        }
        out += 2 * pairs;
        count -= 2 * pairs;
    }
    if (count) {
        method->draw(rng, 1, block, kernels);
        *out = (uint32_t)block[0];
        rng->pending = (uint32_t)(block[0] >> 32);
        rng->has_pending = 1;
    }
}

static void draw_u32(sf_rng *rng, size_t count, uint32_t *out, const sf_rng_kernels *kernels) {
    if (method_of(rng)->native_bits == 64)
        draw_halves(rng, count, out, kernels);
    else
        method_of(rng)->draw(rng, count, out, kernels);
}

void sf_rng_fill_u32(sf_rng *rng, size_t count, uint32_t *out) { draw_u32(rng, count, out, kernels_for(count)); }

void sf_rng_fill_u64(sf_rng *rng, size_t count, uint64_t *out) {
    const sf_rng_method *method = method_of(rng);
    const sf_rng_kernels *kernels = kernels_for(count);
    if (method->native_bits == 64) {
        method->draw(rng, count, out, kernels);
        return;
    }
    uint32_t block[BLOCK_WORDS];
    for (size_t n; count; count -= n, out += n) {
        n = count < BLOCK_WORDS / 2 ? count : BLOCK_WORDS / 2;
        method->draw(rng, 2 * n, block, kernels);
        for (size_t i = 0; i < n; ++i) out[i] = (uint64_t)block[2 * i + 1] << 32 | block[2 * i];
    }
}

void sf_rng_fill_f32(sf_rng *rng, size_t count, float *out) {
    const sf_rng_kernels *kernels = kernels_for(count);
    unsigned shift = method_of(rng)->native_bits == 31;
    uint32_t block[BLOCK_WORDS];
    for (size_t n; count; count -= n, out += n) {
        n = count < BLOCK_WORDS ? count : BLOCK_WORDS;
        draw_u32(rng, n, block, kernels);
        kernels->f32_from_u32(n, shift, block, out);
    }
}

void sf_rng_fill_f64(sf_rng *rng, size_t count, double *out) {
    const sf_rng_method *method = method_of(rng);
    const sf_rng_kernels *kernels = kernels_for(count);
    union {
        uint32_t narrow[BLOCK_WORDS];
        uint64_t wide[BLOCK_WORDS / 2];
    } block;
    for (size_t n; count; count -= n, out += n) {
        n = count < BLOCK_WORDS / 2 ? count : BLOCK_WORDS / 2;
        if (method->native_bits == 64) {
            method->draw(rng, n, block.wide, kernels);
            kernels->f64_from_u64(n, block.wide, out);
        } else {
            method->draw(rng, 2 * n, block.narrow, kernels);
            kernels->f64_from_u32(n, method->native_bits == 31, block.narrow, out);
        }
    }
}

sf_status sf_rng_skip(sf_rng *rng, uint64_t count, sf_error *error) {
    const sf_rng_method *method = method_of(rng);
    if (!method->skip)
        return sf_fail(error, SF_STATUS_UNSUPPORTED, "%s cannot skip: its state has to be walked draw by draw",
                       method->name);
    method->skip(rng, count);
    rng->has_pending = 0;
    rng->pending = 0;
    return SF_STATUS_OK;
}

void sf_rng_spawn(sf_rng *parent, size_t count, sf_rng *children) {
    uint64_t key = sf_hash64(parent->seed, parent->stream);
    for (size_t i = 0; i < count; ++i) {
        uint64_t child = parent->spawned++;
        uint64_t stream = sf_hash64(key, 2 * child + 1) >> 1 | 1;
        sf_status status = sf_rng_init(&children[i], parent->kind, sf_hash64(key, 2 * child), stream, NULL);
        assert(status == SF_STATUS_OK);
        (void)status;
    }
}

size_t sf_rng_state_size(sf_rng_kind kind) {
    return (unsigned)kind < SF_RNG_COUNT ? sf_rng_methods[kind].field_count + EXTRA_WORDS : 0;
}

void sf_rng_get_state(const sf_rng *rng, uint64_t *words) {
    const sf_rng_method *method = method_of(rng);
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
    const sf_rng_method *method = method_of(rng);
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
                       sf_rng_methods[kind].name, expected);
    sf_rng fresh;
    memset(&fresh, 0, sizeof fresh);
    fresh.kind = kind;
    sf_status status = set_fields(&fresh, words, error);
    if (status != SF_STATUS_OK) return status;
    const uint64_t *extra = words + expected - EXTRA_WORDS;
    if (extra[0] >> 33 || (extra[0] && !(extra[0] >> 32)) || (extra[0] && sf_rng_methods[kind].native_bits != 64))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "state word %zu is %" PRIu64 "; it is 0, or 2^32 + the waiting half of a 64-bit draw",
                       expected - EXTRA_WORDS, extra[0]);
    fresh.has_pending = (int)(extra[0] >> 32);
    fresh.pending = (uint32_t)extra[0];
    fresh.seed = extra[1];
    fresh.stream = extra[2];
    fresh.spawned = extra[3];
    *rng = fresh;
    return SF_STATUS_OK;
}
