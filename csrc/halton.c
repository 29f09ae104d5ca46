// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The Halton sequence: in dimension j the digits of the index in the j-th prime, mirrored at the
 * point, each permuted by its place.
 *
 * A coordinate is made as a fraction of 2^64 in two parts, the `low_digits` least digits of the
 * index and the others: the first part repeats, and is tabulated where that pays; the second
 * changes once in base^low_digits points. Each is rounded up, so that a point which is the lower
 * border of an elementary interval stays in it. */
#include <assert.h>
#include <string.h>

#include "error.h"
#include "platform.h"
#include "points_set.h"

enum { MAX_BLOCK = 1024 };  /* base^low_digits is at most this, or the base itself */
enum { MAX_TABLE = 8192 };  /* beyond, a first part is computed each time */

/* One dimension, and the key of its permutations. */
typedef struct halton_axis {
    uint32_t base, block; /* block = base^low_digits */
    unsigned low_digits, digits; /* digits: base^digits is at least 2^64 */
    uint32_t fine, finer; /* the greatest powers of the base up to 2^24 and below 2^32 */
    int permuted;
    uint64_t key;
} halton_axis;

struct sf_halton_tables {
    halton_axis axis;
    uint64_t *first_parts; /* [block]; NULL: computed */
};

/* ---- primes ---- */

static int is_prime(uint32_t n) {
    for (uint32_t factor = 3; factor * factor <= n; factor += 2)
        if (n % factor == 0) return 0;
    return n == 2 || n % 2;
}

static uint32_t next_prime(uint32_t n) {
    if (n < 2) return 2;
    do n += 1 + n % 2;
    while (!is_prime(n));
    return n;
}

/* The primes of the dimensions that a renderer asks for one at a time. */
static const uint16_t first_primes[] = {2,   3,   5,   7,   11,  13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,
                                        59,  61,  67,  71,  73,  79,  83,  89,  97,  101, 103, 107, 109, 113, 127, 131,
                                        137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193, 197, 199, 211, 223};
enum { FIRST_PRIMES = sizeof first_primes / sizeof *first_primes };

static uint32_t prime(uint32_t dimension) {
    if (dimension < FIRST_PRIMES) return first_primes[dimension];
    uint32_t p = first_primes[FIRST_PRIMES - 1];
    for (uint32_t d = FIRST_PRIMES - 1; d < dimension; ++d) p = next_prime(p);
    return p;
}

/* ---- digits ---- */

static uint32_t power_up_to(uint32_t base, uint64_t limit, unsigned *exponent) {
    uint64_t power = 1;
    *exponent = 0;
    while (power * base <= limit) {
        power *= base;
        ++*exponent;
    }
    return (uint32_t)power;
}

static halton_axis make_axis(uint32_t base, uint32_t dimension, sf_scramble scramble, uint64_t seed) {
    halton_axis axis = {.base = base, .permuted = scramble == SF_SCRAMBLE_PERMUTED, .key = sf_hash64(seed, dimension)};
    unsigned unused;
    axis.block = power_up_to(base, base > MAX_BLOCK ? base : MAX_BLOCK, &axis.low_digits);
    axis.fine = power_up_to(base, UINT64_C(1) << 24, &unused);
    axis.finer = power_up_to(base, UINT32_MAX, &unused);
    uint64_t left = UINT64_MAX;
    for (; left; left /= base) ++axis.digits;
    return axis;
}

/* A mix of 0 .. base - 1 by an invertible hash on the next power of two, walked until it lands
 * inside (Kensler 2013, "Correlated Multi-Jittered Sampling", section 3, takes this way). */
static uint32_t mix_digit(uint32_t digit, uint32_t base, uint64_t key) {
    uint32_t mask = base - 1;
    for (int shift = 1; shift < 32; shift *= 2) mask |= mask >> shift;
    uint32_t a = (uint32_t)key | 1, b = (uint32_t)(key >> 32) | 1;
    do {
        digit = (digit * a + (uint32_t)(key >> 40)) & mask;
        digit ^= digit >> 2 ^ digit >> 5;
        digit = digit * b & mask;
        digit ^= digit >> 1 ^ digit >> 7;
    } while (digit >= base);
    return digit;
}

/* The permutation of a place: a random affine map after a mix. Affine maps of a prime field take
 * every pair of digits to every other pair equally often, as all permutations together do, so
 * that the variance of a mean is that of fully random permutations; the mix removes the lines
 * that affine maps alone would leave among the points of large bases. */
static uint32_t permute_digit(const halton_axis *axis, unsigned place, uint32_t digit) {
    uint64_t key = sf_hash64(axis->key, place);
    uint32_t factor = 1 + (uint32_t)((key & 0xffffffffu) * (axis->base - 1) >> 32);
    uint32_t offset = (uint32_t)((key >> 32) * axis->base >> 32);
    uint64_t mixed = mix_digit(digit, axis->base, sf_mix64(key));
    return (uint32_t)((mixed * factor + offset) % axis->base);
}

/* The sum of permuted digit / base^(place + 1) over the places first .. last - 1, the digits of
 * `number` from its least on; as a fraction of 2^64, rounded up. */
static uint64_t mirrored_digits(const halton_axis *axis, uint64_t number, unsigned first, unsigned last) {
    uint32_t digits[64], base = axis->base;
    for (unsigned place = first; place < last; ++place, number /= base) {
        digits[place] = (uint32_t)(number % base);
        if (axis->permuted) digits[place] = permute_digit(axis, place, digits[place]);
    }
    /* Divide digit.fraction by the base, from the last place up: floor of a floor is exact. */
    uint64_t fraction = 0, inexact = 0;
    for (unsigned place = last; place-- > 0;) {
        uint64_t top = (uint64_t)(place < first ? 0 : digits[place]) << 32 | fraction >> 32;
        uint64_t rest = top % base << 32 | (fraction & 0xffffffffu);
        fraction = top / base << 32 | rest / base;
        inexact |= rest % base;
    }
    return fraction + (inexact != 0);
}

static uint64_t first_part(const halton_axis *axis, uint32_t number) {
    return mirrored_digits(axis, number, 0, axis->low_digits);
}

static uint64_t second_part(const halton_axis *axis, uint64_t number) {
    return number || axis->permuted ? mirrored_digits(axis, number, axis->low_digits, axis->digits) : 0;
}

/* The fraction of 2^64; both parts being rounded up, their sum could reach 1 where every digit is
 * the last. */
static uint64_t join(uint64_t first, uint64_t second) {
    uint64_t sum = first + second;
    return sum < first ? UINT64_MAX : sum;
}

static uint64_t halton_fraction(const halton_axis *axis, uint64_t index) {
    return join(first_part(axis, (uint32_t)(index % axis->block)), second_part(axis, index / axis->block));
}

/* ---- rounding ---- */

/* floor(fraction / 2^64 * cells), exactly. */
static uint32_t cell_of(uint64_t fraction, uint32_t cells) {
    return (uint32_t)(((fraction >> 32) * cells + ((fraction & 0xffffffffu) * cells >> 32)) >> 32);
}

/* The fraction with its last `dropped` bits cleared, or, where that would leave the elementary
 * interval, one of `cells`, the next such number: it lies inside, as intervals are not narrower
 * than the step. */
static uint64_t round_inside(uint64_t fraction, uint32_t cells, unsigned dropped) {
    uint64_t step = UINT64_C(1) << dropped, below = fraction & ~(step - 1);
    return cell_of(below, cells) < cell_of(fraction, cells) ? below + step : below;
}

static uint32_t word_of(const halton_axis *axis, uint64_t fraction) {
    uint64_t rounded = round_inside(fraction, axis->fine, 40);
    return (uint32_t)((rounded > fraction ? rounded : fraction) >> 32);
}

uint32_t sf_halton_bits(uint64_t index, uint32_t dimension) {
    assert(dimension < SF_HALTON_MAX_DIMS);
    halton_axis axis = make_axis(prime(dimension), dimension, SF_SCRAMBLE_NONE, 0);
    return word_of(&axis, halton_fraction(&axis, index));
}

float sf_halton_sample(uint64_t index, uint32_t dimension, uint64_t seed) {
    assert(dimension < SF_HALTON_MAX_DIMS);
    halton_axis axis = make_axis(prime(dimension), dimension, SF_SCRAMBLE_PERMUTED, seed);
    return sf_float_from_bits(word_of(&axis, halton_fraction(&axis, index)));
}

/* ---- rows ---- */

void sf_halton_release(sf_halton_tables *tables, uint32_t dims) {
    for (uint32_t d = 0; tables && d < dims; ++d) sf_aligned_free(tables[d].first_parts);
    sf_aligned_free(tables);
}

static sf_status tabulate(sf_halton_tables *table, uint64_t total, sf_error *error) {
    uint32_t block = table->axis.block;
    if (block > MAX_TABLE || block > total) return SF_STATUS_OK;
    table->first_parts = sf_aligned_alloc(block * sizeof *table->first_parts);
    if (!table->first_parts) return sf_fail_memory(error, "the tables of halton", block * sizeof *table->first_parts);
    for (uint32_t i = 0; i < block; ++i) table->first_parts[i] = first_part(&table->axis, i);
    return SF_STATUS_OK;
}

sf_status sf_halton_prepare(sf_point_set *set, sf_error *error) {
    uint32_t dims = set->options.dims, base = 0;
    uint64_t total = set->options.total ? set->options.total : UINT64_MAX;
    set->halton = sf_aligned_alloc(dims * sizeof *set->halton);
    if (!set->halton) return sf_fail_memory(error, "the tables of halton", dims * sizeof *set->halton);
    memset(set->halton, 0, dims * sizeof *set->halton);
    sf_status status = SF_STATUS_OK;
    for (uint32_t d = 0; d < dims && status == SF_STATUS_OK; ++d) {
        base = next_prime(base);
        set->halton[d].axis = make_axis(base, d, set->options.scramble, set->options.seed);
        status = tabulate(set->halton + d, total, error);
    }
    return status;
}

/* One coordinate of the row's, from fractions to words. */
static void put(const halton_axis *axis, uint64_t fraction, uint32_t *high, uint32_t *low) {
    if (!low) {
        *high = word_of(axis, fraction);
        return;
    }
    uint64_t rounded = round_inside(fraction, axis->finer, 11);
    *high = (uint32_t)(rounded >> 32);
    *low = (uint32_t)rounded;
}

void sf_halton_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    uint32_t dims = cursor->set->options.dims;
    for (uint32_t d = 0; d < dims; ++d) {
        const sf_halton_tables *table = cursor->set->halton + d;
        const halton_axis *axis = &table->axis;
        for (size_t row = 0; row < rows;) {
            uint64_t number = (first + row) / axis->block, second = second_part(axis, number);
            uint32_t begin = (uint32_t)((first + row) % axis->block);
            size_t end = rows - row < axis->block - begin ? begin + (rows - row) : axis->block;
            for (size_t i = begin; i < end; ++i, ++row) {
                uint64_t part = table->first_parts ? table->first_parts[i] : first_part(axis, (uint32_t)i);
                put(axis, join(part, second), high + row * dims + d, low ? low + row * dims + d : NULL);
            }
        }
    }
}
