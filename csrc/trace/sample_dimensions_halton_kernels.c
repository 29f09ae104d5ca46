// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Halton's permuted coordinates of blocks: 16 consecutive indices under one key.
 *
 * Three things keep the work small, and the bits those of sf_halton_sample:
 * - The indices share their upper digits, and of the lower ones each value of a place is permuted
 *   once. Which digits those are hangs on the indices alone, and is worked out once for all blocks
 *   of a call with the same ones.
 * - A sum of digits times weights floor(2^64 / base^(place + 1)) takes the place of the exact
 *   divisions, and it ends where base^-places is at most 2^-36. The exact fraction is then known
 *   between two bounds less than 2^-35 apart.
 * - The word is a monotone function of the fraction: where both bounds have the same, it is the
 *   word. Where they have not, once in some 3,000 coordinates or less, sf_halton_sample is asked. */
#include "trace/sample_dimensions_halton_kernels.h"

#include <string.h>

#include "base/platform.h"
#include "points/halton_kernels.h"

enum {
    PLACES = 36, /* of base 2 */
    /* Base 2 takes at most two digits a place, 72; base 3 three at places 0 to 2 and two at the 20
     * others; the greater ones fewer: 16 or less at place 0, and less than 3 at most others. */
    ITEMS = 80
};

typedef struct lanes_axis {
    uint32_t base, inverse, mask, fine; /* inverse = floor(2^32 / base); mask: 2^bits - 1, not below base - 1 */
    uint32_t places;
    uint64_t slack; /* the exact fraction is less than this above the sum */
    uint64_t weights[PLACES];
} lanes_axis;

/* The digits of first .. first + 15: item i is `digit` at `place`. */
typedef struct lanes_plan {
    uint32_t first, items; /* a multiple of 16 */
    SF_ALIGNED(uint64_t) place[ITEMS];
    SF_ALIGNED(uint64_t) weight[ITEMS];
    SF_ALIGNED(uint32_t) digit[ITEMS];
    uint32_t shared;   /* the first item of the places at which all indices have the same digit */
    uint32_t end;      /* of the items, without the padding */
    uint32_t branched; /* places below those */
    /* At place p value j of counts[p] is item items_of[p][j] added to value parents[p][j] of p + 1. */
    uint8_t counts[PLACES], items_of[PLACES][SF_LANES], parents[PLACES][SF_LANES];
} lanes_plan;

/* ---- once a call ---- */

static void make_axis(lanes_axis *axis, uint32_t base) {
    uint64_t power = base;
    *axis = (lanes_axis){.base = base, .inverse = (uint32_t)((UINT64_C(1) << 32) / base), .mask = base - 1, .fine = 1};
    for (int shift = 1; shift < 32; shift *= 2) axis->mask |= axis->mask >> shift;
    for (uint64_t fine = base; fine <= UINT64_C(1) << 24; fine *= base) axis->fine = (uint32_t)fine;
    /* Of 2^64 - 1, and for powers of 2 of 2^64: the same quotients but for those. */
    for (;; power *= base) {
        axis->weights[axis->places++] = UINT64_MAX / power + (base == 2);
        if (power >= UINT64_C(1) << 36) break;
    }
    /* The places left out are worth at most 1 / power, less than weight + 1; each weight lacks less
     * than 1; and the reference rounds its two parts up. */
    axis->slack = axis->weights[axis->places - 1] + 1 + (uint64_t)axis->places * (base - 1) + 2;
}

static void add_item(lanes_plan *plan, const lanes_axis *axis, uint32_t place, uint32_t digit) {
    plan->place[plan->end] = place;
    plan->digit[plan->end] = digit;
    plan->weight[plan->end++] = axis->weights[place];
}

static void make_plan(lanes_plan *plan, const lanes_axis *axis, uint32_t first) {
    uint32_t count = SF_LANES, number = first, base = axis->base;
    memset(plan, 0, sizeof *plan);
    plan->first = first;
    for (uint32_t p = 0; p < axis->places; ++p) {
        uint32_t digit = number % base, item = plan->end, distinct = count < base ? count : base;
        for (uint32_t j = 0; j < distinct; ++j) add_item(plan, axis, p, (digit + j) % base);
        plan->counts[p] = (uint8_t)count;
        for (uint32_t j = 0; j < count; ++j) {
            plan->items_of[p][j] = (uint8_t)(item + j % distinct);
            plan->parents[p][j] = (uint8_t)((digit + j) / base);
        }
        if (count > 1) {
            plan->branched = p + 1;
            plan->shared = plan->end;
        }
        number /= base;
        count = (digit + count - 1) / base + 1;
    }
    plan->items = (plan->end + SF_LANES - 1) / SF_LANES * SF_LANES;
}

/* ---- once a block and dimension ---- */

/* Permutes 16 digits, as sf_halton_digit does, and weighs them. */
static void weigh_items(const lanes_axis *axis, uint64_t key, const uint64_t *place, const uint32_t *digit,
                        const uint64_t *weight, uint64_t *SF_RESTRICT part) {
    SF_ALIGNED(uint64_t) keys[SF_LANES];
    SF_ALIGNED(uint64_t) mixes[SF_LANES];
    SF_ALIGNED(uint32_t) mixed[SF_LANES];
    uint32_t base = axis->base, mask = axis->mask, outside = 0;
    SF_ROLLED
    for (int l = 0; l < SF_LANES; ++l) {
        keys[l] = sf_hash64(key, place[l]);
        mixes[l] = sf_mix64(keys[l]);
    }
    SF_ROLLED
    for (int l = 0; l < SF_LANES; ++l) {
        mixed[l] = sf_halton_mix_step(digit[l], mask, mixes[l]);
        outside |= mixed[l] >= base;
    }
    while (outside) {
        outside = 0;
        SF_ROLLED
        for (int l = 0; l < SF_LANES; ++l) {
            uint32_t next = sf_halton_mix_step(mixed[l], mask, mixes[l]);
            mixed[l] = mixed[l] >= base ? next : mixed[l];
            outside |= mixed[l] >= base;
        }
    }
    SF_ROLLED
    for (int l = 0; l < SF_LANES; ++l) {
        uint32_t image = sf_halton_affine(mixed[l], base, keys[l]);
        image -= (uint32_t)((uint64_t)image * axis->inverse >> 32) * base; /* the quotient is at most one short */
        image = image >= base ? image - base : image;
        part[l] = image * weight[l];
    }
}

/* The sums of the 16 indices, from the last place to the first. */
static void add_up(const lanes_plan *plan, const uint64_t *part, uint64_t sums[SF_LANES]) {
    uint64_t shared = 0;
    for (uint32_t i = plan->shared; i < plan->end; ++i) shared += part[i];
    sums[0] = sums[1] = shared;
    for (uint32_t p = plan->branched; p-- > 0;) {
        const uint8_t *items_of = plan->items_of[p], *parents = plan->parents[p];
        /* A parent is never behind its values, so that it is still there. */
        for (uint32_t j = plan->counts[p]; j-- > 0;) sums[j] = sums[parents[j]] + part[items_of[j]];
    }
}

/* Bit l of the result: the bounds of lane l have different words. */
static uint32_t round_sums(const lanes_axis *axis, const uint64_t sums[SF_LANES], float *SF_RESTRICT out) {
    SF_ALIGNED(uint32_t) apart[SF_LANES];
    uint32_t undecided = 0;
    SF_ROLLED
    for (int l = 0; l < SF_LANES; ++l) {
        uint32_t word = sf_halton_word(sums[l], axis->fine);
        uint32_t above = sf_halton_word(sf_halton_join(sums[l], axis->slack), axis->fine);
        out[l] = sf_float_from_bits(word);
        apart[l] = (word ^ above) >> 8;
    }
    for (int l = 0; l < SF_LANES; ++l) undecided |= (uint32_t)(apart[l] != 0) << l;
    return undecided;
}

static void fill_block(const lanes_axis *axis, const lanes_plan *plan, uint32_t dimension, uint64_t key, float *out) {
    SF_ALIGNED(uint64_t) part[ITEMS];
    SF_ALIGNED(uint64_t) sums[SF_LANES];
    uint64_t axis_key = sf_hash64(key, dimension);
    for (uint32_t i = 0; i < plan->items; i += SF_LANES)
        weigh_items(axis, axis_key, plan->place + i, plan->digit + i, plan->weight + i, part + i);
    add_up(plan, part, sums);
    uint32_t undecided = round_sums(axis, sums, out);
    for (uint32_t l = 0; undecided >> l && l < SF_LANES; ++l)
        if (undecided >> l & 1u) out[l] = sf_halton_sample(plan->first + l, dimension, key);
}

static void fill(const sf_coordinate_source *source, const sf_block *blocks, uint32_t block_count,
                 float (*out)[SF_PATHS]) {
    for (uint32_t d = 0; d < source->count; ++d) {
        lanes_axis axis;
        lanes_plan plan;
        make_axis(&axis, source->primes[d]);
        for (uint32_t b = 0; b < block_count; ++b) {
            if (b == 0 || plan.first != blocks[b].base) make_plan(&plan, &axis, blocks[b].base);
            fill_block(&axis, &plan, source->first + d, blocks[b].key, out[d] + SF_LANES * b);
        }
    }
}

const sf_sample_dimensions_halton_kernels SF_AT_ISA(sf_sample_dimensions_halton_kernels) = {fill};
