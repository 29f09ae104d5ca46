// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Halton's and Hammersley's sets by rows: a dimension at a time, a block of base^low_digits points
 * at a time, whose indices share all digits but the least. */
#include <assert.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/halton.h"
#include "points/points_set.h"
#include "points/strata.h"

enum {
    MAX_TABLE = 8192,   /* beyond, what belongs to the least digits is computed each time */
    RUN = SF_HALTON_RUN /* coordinates of a dimension at a time */
};

struct sf_halton_tables {
    sf_halton_axis axis;
    uint64_t *first_parts; /* [block + SF_HALTON_ROOM]; NULL: computed, or scrambled */
    sf_owen_node *nodes;   /* [block], of depth low_digits; NULL: computed, or not scrambled */
    uint32_t *digits;      /* [base]: at place low_digits; NULL: computed */
};

/* A thread's place in one dimension: index = (above * base + digit) * block + offset. */
typedef struct axis_cursor {
    uint64_t above;
    uint32_t digit, offset;
    sf_halton_sum tail; /* of the digits of `above`; not of scrambled ones */
    uint64_t second;    /* the second part */
} axis_cursor;

/* ---- tables ---- */

void sf_halton_release(sf_halton_tables *tables, uint32_t dims) {
    for (uint32_t d = 0; tables && d < dims; ++d) {
        sf_aligned_free(tables[d].first_parts);
        sf_aligned_free(tables[d].nodes);
        sf_aligned_free(tables[d].digits);
    }
    sf_aligned_free(tables);
}

static sf_owen_node node_of(const sf_halton_axis *axis, uint32_t number) {
    return sf_halton_owen_descend(axis, sf_halton_owen_root(axis), 0, axis->low_digits, number);
}

/* Tables that a set of `total` points would use up. */
static sf_status tabulate(sf_halton_tables *table, uint64_t total, sf_error *error) {
    const sf_halton_axis *axis = &table->axis;
    uint32_t block = axis->block;
    if (block > MAX_TABLE || block > total) return SF_STATUS_OK;
    int scrambled = axis->scramble == SF_SCRAMBLE_OWEN;
    size_t bytes = scrambled ? block * sizeof *table->nodes : (block + SF_HALTON_ROOM) * sizeof *table->first_parts;
    void *memory = sf_aligned_alloc(bytes);
    if (!memory) return sf_fail_memory(error, "the tables of halton", bytes);
    if (scrambled) {
        table->nodes = memory;
        for (uint32_t i = 0; i < block; ++i) table->nodes[i] = node_of(axis, i);
        return SF_STATUS_OK;
    }
    memset(memory, 0, bytes);
    table->first_parts = memory;
    for (uint32_t i = 0; i < block; ++i) table->first_parts[i] = sf_halton_first_part(axis, i);
    if (total / block < axis->base) return SF_STATUS_OK;
    table->digits = sf_aligned_alloc(axis->base * sizeof *table->digits);
    if (!table->digits) return sf_fail_memory(error, "the tables of halton", axis->base * sizeof *table->digits);
    for (uint32_t i = 0; i < axis->base; ++i) table->digits[i] = sf_halton_digit(axis, axis->low_digits, i);
    return SF_STATUS_OK;
}

static sf_status prepare(sf_point_set *set, uint32_t axes, sf_error *error) {
    uint32_t base = 0;
    uint64_t total = set->options.total ? set->options.total : UINT64_MAX;
    size_t bytes = set->options.dims * sizeof *set->halton;
    set->halton = sf_aligned_alloc(bytes);
    if (!set->halton) return sf_fail_memory(error, "the tables of halton", bytes);
    memset(set->halton, 0, bytes);
    sf_status status = SF_STATUS_OK;
    for (uint32_t d = 0; d < axes && status == SF_STATUS_OK; ++d) {
        base = sf_next_prime(base);
        set->halton[d].axis = sf_halton_axis_make(base, d, set->options.scramble, set->options.seed);
        status = tabulate(set->halton + d, total, error);
    }
    return status;
}

sf_status sf_halton_prepare(sf_point_set *set, sf_error *error) { return prepare(set, set->options.dims, error); }

sf_status sf_hammersley_prepare(sf_point_set *set, sf_error *error) {
    return prepare(set, set->options.dims - 1, error);
}

/* ---- rows ---- */

static void find_second(const sf_halton_tables *table, axis_cursor *at) {
    const sf_halton_axis *axis = &table->axis;
    uint32_t digit = table->digits ? table->digits[at->digit] : sf_halton_digit(axis, axis->low_digits, at->digit);
    at->second = sf_halton_second_part(axis, sf_halton_divide(at->tail, digit, axis->base));
}

static void start(const sf_halton_tables *table, uint64_t index, axis_cursor *at) {
    const sf_halton_axis *axis = &table->axis;
    uint64_t number = index / axis->block;
    at->offset = (uint32_t)(index % axis->block);
    at->above = number / axis->base;
    at->digit = (uint32_t)(number % axis->base);
    if (axis->scramble == SF_SCRAMBLE_OWEN) return;
    at->tail = sf_halton_tail(axis, at->above, axis->low_digits + 1);
    find_second(table, at);
}

static void next_block(const sf_halton_tables *table, axis_cursor *at) {
    const sf_halton_axis *axis = &table->axis;
    at->offset = 0;
    int carried = ++at->digit == axis->base;
    if (carried) {
        at->digit = 0;
        ++at->above;
    }
    if (axis->scramble == SF_SCRAMBLE_OWEN) return;
    if (carried) at->tail = sf_halton_tail(axis, at->above, axis->low_digits + 1);
    find_second(table, at);
}

/* The coordinates of `count` points of a block as fractions, but for at->second. */
static const uint64_t *parts_of(const sf_halton_tables *table, const sf_halton_kernels *kernels, const axis_cursor *at,
                                size_t count, uint64_t *scratch) {
    const sf_halton_axis *axis = &table->axis;
    if (axis->scramble != SF_SCRAMBLE_OWEN) {
        if (table->first_parts) return table->first_parts + at->offset;
        for (size_t i = 0; i < count; ++i) scratch[i] = sf_halton_first_part(axis, at->offset + (uint32_t)i);
        return scratch;
    }
    sf_owen_node computed[RUN];
    sf_owen_digit digits[32];
    uint32_t power;
    const sf_owen_node *nodes = table->nodes ? table->nodes + at->offset : computed;
    for (size_t i = 0; !table->nodes && i < count; ++i) computed[i] = node_of(axis, at->offset + (uint32_t)i);
    uint64_t number = at->above * axis->base + at->digit;
    int steps = sf_halton_owen_digits(axis, axis->low_digits, number, digits, &power);
    if (steps >= 0)
        kernels->owen(count, nodes, &axis->owen, (size_t)steps, digits, power, scratch);
    else
        for (size_t i = 0; i < count; ++i)
            scratch[i] = sf_halton_owen_fraction(axis, nodes[i], axis->low_digits, number);
    return scratch;
}

/* One dimension of up to SF_HALTON_RUN rows. Where the first parts are tabulated whole vectors are
 * made: what is too much the next block, or the room behind the column, takes. */
static void fill_column(const sf_halton_tables *table, const sf_halton_kernels *kernels, axis_cursor *at, size_t rows,
                        uint32_t *high, uint32_t *low) {
    SF_ALIGNED(uint64_t) scratch[RUN];
    const sf_halton_axis *axis = &table->axis;
    for (size_t row = 0, n; row < rows; row += n) {
        n = rows - row < axis->block - at->offset ? rows - row : axis->block - at->offset;
        const uint64_t *parts = parts_of(table, kernels, at, n, scratch);
        uint64_t second = axis->scramble == SF_SCRAMBLE_OWEN ? 0 : at->second;
        size_t made = table->first_parts ? (n + SF_HALTON_ROOM - 1) / SF_HALTON_ROOM * SF_HALTON_ROOM : n;
        if (low)
            kernels->pairs(made, parts, second, axis->finer, high + row, low + row);
        else
            kernels->words(made, parts, second, axis->fine, high + row);
        at->offset += (uint32_t)n;
        if (at->offset == axis->block) next_block(table, at);
    }
}

static void make(sf_points_cursor *cursor, uint32_t axes, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    SF_ALIGNED(uint32_t) columns[2][SF_HALTON_WIDTH * SF_HALTON_COLUMN];
    const sf_halton_tables *tables = cursor->set->halton;
    const sf_halton_kernels *kernels = sf_halton_kernels_at(sf_isa_active());
    axis_cursor *at = (axis_cursor *)(void *)cursor->state;
    size_t dims = cursor->set->options.dims;
    for (uint32_t d = 0; cursor->next != first && d < axes; ++d) start(tables + d, first, at + d);
    for (size_t row = 0, n; row < rows; row += n) {
        n = rows - row < RUN ? rows - row : RUN;
        for (uint32_t d = 0, width; d < axes; d += width) {
            width = axes - d < SF_HALTON_WIDTH ? axes - d : SF_HALTON_WIDTH;
            for (uint32_t k = 0; k < width; ++k)
                fill_column(tables + d + k, kernels, at + d + k, n, columns[0] + k * SF_HALTON_COLUMN,
                            low ? columns[1] + k * SF_HALTON_COLUMN : NULL);
            kernels->weave(n, columns[0], width, high + row * dims + d, dims);
            if (low) kernels->weave(n, columns[1], width, low + row * dims + d, dims);
        }
    }
    cursor->next = first + rows;
}

void sf_halton_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    assert(sizeof(axis_cursor) <= SF_POINTS_STATE_WORDS * sizeof(uint32_t));
    make(cursor, cursor->set->options.dims, first, rows, high, low);
}

/* ---- hammersley ---- */

/* Dimension 0: index / total, rounded up to a float or to a double so that it stays in its
 * stratum; with a scramble at a random place in it. */
static uint64_t hammersley_word(const sf_points_options *options, uint64_t index, int as_double) {
    if (options->scramble != SF_SCRAMBLE_NONE) {
        uint32_t key = (uint32_t)(sf_hash64(options->seed, UINT64_MAX) >> 32);
        return sf_stratum_place((uint32_t)index, key, (uint32_t)index, options->total);
    }
    if (as_double || options->total > SF_FLOAT_STRATA) return sf_stratum_border53(index, options->total) << 11;
    return (uint64_t)sf_cell_border((uint32_t)index, (uint32_t)options->total) << 32;
}

void sf_hammersley_make(sf_points_cursor *cursor, uint64_t first, size_t rows, uint32_t *high, uint32_t *low) {
    uint32_t dims = cursor->set->options.dims;
    for (size_t row = 0; row < rows; ++row) {
        uint64_t word = hammersley_word(&cursor->set->options, first + row, low != NULL);
        high[row * dims] = (uint32_t)(word >> 32);
        if (low) low[row * dims] = (uint32_t)word;
    }
    make(cursor, dims - 1, first, rows, high + 1, low ? low + 1 : NULL);
}

float sf_hammersley_sample(uint64_t index, uint32_t dimension, uint64_t total) {
    assert(index < total && total <= UINT64_C(1) << 32 && dimension <= SF_HALTON_MAX_DIMS);
    if (dimension) return sf_float_from_bits(sf_halton_bits(index, dimension - 1));
    sf_points_options options = {.scramble = SF_SCRAMBLE_NONE, .total = total};
    return sf_float_from_bits((uint32_t)(hammersley_word(&options, index, 0) >> 32));
}
