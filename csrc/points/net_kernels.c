// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fills rows of digital nets: steps from block to block, scrambles words, and converts them to floats. */
#include "points/net_kernels.h"

#include <string.h>

#include "base/platform.h"

/* ---- one run of words: block ^ state, scrambled, as numbers ---- */

/* Words word .. word + count - 1 of a block, which do not cross a period. */
typedef struct span {
    size_t count;
    const uint32_t *block[2], *state[2], *keys;
    void *out;
} span;

static void xor_u32(const span *s) {
    const uint32_t *SF_RESTRICT a = s->block[0], *SF_RESTRICT b = s->state[0];
    uint32_t *SF_RESTRICT out = s->out;
    for (size_t i = 0; i < s->count; ++i) out[i] = a[i] ^ b[i];
}

static void xor_f32(const span *s) {
    const uint32_t *SF_RESTRICT a = s->block[0], *SF_RESTRICT b = s->state[0];
    float *SF_RESTRICT out = s->out;
    size_t count = s->count;
    for (size_t i = 0; i < count; ++i) out[i] = sf_float_from_bits(a[i] ^ b[i]);
}

static void xor_f64(const span *s) {
    const uint32_t *SF_RESTRICT a = s->block[0], *SF_RESTRICT b = s->state[0];
    const uint32_t *SF_RESTRICT low = s->block[1], *SF_RESTRICT low_state = s->state[1];
    double *SF_RESTRICT out = s->out;
    size_t count = s->count;
    if (low)
        for (size_t i = 0; i < count; ++i) out[i] = sf_double_from_words(a[i] ^ b[i], low[i] ^ low_state[i]);
    else
        for (size_t i = 0; i < count; ++i) out[i] = sf_double_from_words(a[i] ^ b[i], low_state[i]);
}

enum { RUN = 256 }; /* words that are scrambled together */

/* Words i .. i + n - 1 of the span, scrambled. */
static inline void owen_words(const span *s, size_t i, size_t n, uint32_t *SF_RESTRICT out) {
    const uint32_t *SF_RESTRICT a = s->block[0] + i, *SF_RESTRICT b = s->state[0] + i, *SF_RESTRICT keys = s->keys + i;
    for (size_t k = 0; k < n; ++k) out[k] = sf_owen_hash32(a[k] ^ b[k], keys[k]);
    sf_reverse_bits_each(out, n);
}

static inline size_t run_from(size_t i, size_t count) { return count - i < RUN ? count - i : RUN; }

static void owen_u32(const span *s) {
    for (size_t i = 0; i < s->count; i += RUN) owen_words(s, i, run_from(i, s->count), (uint32_t *)s->out + i);
}

static void owen_f32(const span *s) {
    SF_ALIGNED(uint32_t) words[RUN];
    for (size_t i = 0; i < s->count; i += RUN) {
        size_t n = run_from(i, s->count);
        float *SF_RESTRICT out = (float *)s->out + i;
        owen_words(s, i, n, words);
        for (size_t k = 0; k < n; ++k) out[k] = sf_float_from_bits(words[k]);
    }
}

static void owen_f64(const span *s) {
    SF_ALIGNED(uint32_t) words[RUN];
    for (size_t i = 0; i < s->count; i += RUN) {
        size_t n = run_from(i, s->count);
        const uint32_t *SF_RESTRICT keys = s->keys + i;
        double *SF_RESTRICT out = (double *)s->out + i;
        owen_words(s, i, n, words);
        for (size_t k = 0; k < n; ++k) out[k] = sf_double_from_words(words[k], sf_owen_low_word(words[k], keys[k]));
    }
}

/* ---- rows ---- */

static size_t size_of(sf_number_type type) { return type == SF_NUMBER_F64 ? sizeof(double) : sizeof(float); }

/* Rows begin .. end - 1 of the block whose high bits are `state`. */
static void fill_block(const sf_net_tables *t, size_t begin, size_t end, const uint32_t *state, sf_number_type type,
                       int streams, char *out) {
    enum { STREAM_WORDS = 512 }; /* few enough for the processor to send while the next are made */
    SF_ALIGNED(double) numbers[STREAM_WORDS];
    static void (*const fills[2][3])(const span *) = {{xor_f32, xor_f64, xor_u32}, {owen_f32, owen_f64, owen_u32}};
    void (*fill)(const span *) = fills[t->keys != NULL][type];
    size_t word = begin * t->dims, last = end * t->dims;
    while (word < last) {
        size_t offset = word % t->period, count = t->period - offset;
        if (count > last - word) count = last - word;
        if (streams && count > STREAM_WORDS) count = STREAM_WORDS;
        span s = {count,
                  {t->block[0] + word, t->block[1] ? t->block[1] + word : NULL},
                  {state + offset, state + t->period + offset},
                  t->keys + (t->keys ? offset : 0),
                  streams ? (void *)numbers : out};
        fill(&s);
        if (streams) sf_stream_copy(out, numbers, count * size_of(type));
        word += count;
        out += count * size_of(type);
    }
}

static void xor_row(uint32_t *SF_RESTRICT row, const uint32_t *SF_RESTRICT other, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) row[i] ^= other[i];
}

/* Counting up flips the trailing ones of the block's number and the zero above them. */
static void step(const sf_net_tables *t, uint64_t number, uint32_t *state) {
    unsigned carry = 0;
    while (!(number >> carry & 1)) ++carry;
    if (carry >= t->index_bits - t->block_bits) return; /* the last block's end */
    for (int part = 0; part < 2; ++part)
        if (t->steps[part])
            xor_row(state + part * (size_t)t->period, t->steps[part] + (size_t)carry * t->period, t->period);
}

static void rows(const sf_net_tables *t, uint64_t first, size_t count, uint32_t *state, sf_number_type type,
                 int streams, void *out) {
    size_t block = (size_t)1 << t->block_bits;
    char *to = out;
    while (count) {
        size_t begin = (size_t)(first & (block - 1)), some = block - begin < count ? block - begin : count;
        fill_block(t, begin, begin + some, state, type, streams, to);
        first += some;
        count -= some;
        to += some * t->dims * size_of(type);
        if ((first & (block - 1)) == 0) step(t, first >> t->block_bits, state);
    }
}

/* A row of the high bits, in pieces that stay in the first cache while the columns go by. Bit k of
 * index ^ index / 2 is set where bits k and k + 1 of the index differ: the XOR of the columns'
 * sums up to there is that of the columns of the index's ones. */
static void start_part(const sf_net_tables *t, int part, uint64_t index, uint32_t *state) {
    enum { PIECE = 1024 };
    uint64_t changes = index ^ index >> 1;
    for (uint32_t begin = 0; begin < t->dims; begin += PIECE) {
        uint32_t count = t->dims - begin < PIECE ? t->dims - begin : PIECE;
        if (t->shift[part])
            memcpy(state + begin, t->shift[part] + begin, count * sizeof *state);
        else
            memset(state + begin, 0, count * sizeof *state);
        for (unsigned k = 0; t->columns[part] && k < t->index_bits; ++k)
            if (changes >> k & 1) xor_row(state + begin, t->columns[part] + (size_t)k * t->dims + begin, count);
    }
    sf_repeat_row(state, t->dims, t->period);
}

static void start(const sf_net_tables *t, uint64_t index, uint32_t *state) {
    uint64_t high = index >> t->block_bits << t->block_bits;
    start_part(t, 0, high, state);
    start_part(t, 1, high, state + t->period);
}

/* ---- scrambles after the words ---- */

static void owen_low(size_t count, const uint32_t *SF_RESTRICT high, const uint32_t *SF_RESTRICT keys, uint32_t period,
                     uint32_t *SF_RESTRICT low) {
    for (size_t begin = 0; begin < count; begin += period) {
        size_t n = count - begin < period ? count - begin : period;
        for (size_t i = 0; i < n; ++i) low[begin + i] = sf_owen_low_word(high[begin + i], keys[i]);
    }
}

static void nested_run(size_t n, const uint64_t *SF_RESTRICT keys, uint32_t *SF_RESTRICT high,
                       uint32_t *SF_RESTRICT low) {
    uint64_t words[RUN], flips[RUN];
    for (size_t i = 0; i < n; ++i) {
        words[i] = (uint64_t)high[i] << 32;
        flips[i] = 0;
    }
    unsigned depths = low ? SF_NESTED_DEPTH : 36; /* 32 and what the last subtree has beyond */
    for (unsigned depth = 0; depth < depths; depth += SF_NESTED_LEVELS)
        for (size_t i = 0; i < n; ++i) flips[i] |= sf_nested_flips(words[i], depth, keys[i]);
    for (size_t i = 0; i < n; ++i) high[i] ^= (uint32_t)(flips[i] >> 32);
    for (size_t i = 0; low && i < n; ++i) low[i] = (uint32_t)flips[i];
}

static void nested(size_t count, const uint64_t *keys, uint32_t period, uint32_t *high, uint32_t *low) {
    uint64_t repeated[RUN];
    for (size_t i = 0; period == 1 && i < RUN; ++i) repeated[i] = keys[0];
    if (period == 1) {
        keys = repeated;
        period = RUN;
    }
    for (size_t begin = 0, n; begin < count; begin += n) {
        size_t offset = begin % period;
        n = period - offset;
        if (n > RUN) n = RUN;
        if (n > count - begin) n = count - begin;
        nested_run(n, keys + offset, high + begin, low ? low + begin : NULL);
    }
}

/* ---- padded sets ---- */

static void shuffle(uint32_t first, size_t count, uint32_t key, uint32_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_owen_scramble32(first + (uint32_t)i, key);
}

static void look_up(size_t count, const uint32_t *SF_RESTRICT indices, const uint32_t table[256], uint32_t start_word,
                    uint32_t key, uint32_t *SF_RESTRICT out) {
    for (size_t i = 0; i < count; ++i) out[i] = sf_owen_hash32(table[indices[i] & 255u] ^ start_word, key);
    sf_reverse_bits_each(out, count);
}

const sf_net_kernels SF_AT_ISA(sf_net_kernels) = {start, rows, owen_low, nested, shuffle, look_up};
