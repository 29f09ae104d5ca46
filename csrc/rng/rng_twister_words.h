// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A Mersenne Twister behind sf_rng, for words of 32 and 64 bits alike: included by rng_twister.c
 * once for each, with METHOD, WORD, LENGTH, MIDDLE, SEPARATION and the multipliers of the
 * authors' seeding defined. */

#define TOP (sizeof(WORD) * 8 - 2)

/* The authors' init_genrand. */
static void SF_JOIN(start, METHOD)(SF_JOIN(sf, METHOD) * g, WORD seed) {
    g->words[0] = seed;
    for (WORD i = 1; i < LENGTH; ++i) g->words[i] = SEED_MULTIPLIER * (g->words[i - 1] ^ g->words[i - 1] >> TOP) + i;
    g->used = LENGTH;
}

/* The authors' init_by_array: every word of the key reaches every word of the state. */
static void SF_JOIN(start_by_key, METHOD)(SF_JOIN(sf, METHOD) * g, const WORD *key, WORD key_length) {
    SF_JOIN(start, METHOD)(g, 19650218);
    WORD *x = g->words, i = 1, j = 0;
    for (WORD k = 0; k < LENGTH; ++k) {
        x[i] = (x[i] ^ (x[i - 1] ^ x[i - 1] >> TOP) * KEY_MULTIPLIER) + key[j] + j;
        if (++j == key_length) j = 0;
        if (++i == LENGTH) {
            x[0] = x[LENGTH - 1];
            i = 1;
        }
    }
    for (WORD k = 1; k < LENGTH; ++k) {
        x[i] = (x[i] ^ (x[i - 1] ^ x[i - 1] >> TOP) * LAST_MULTIPLIER) - i;
        if (++i == LENGTH) {
            x[0] = x[LENGTH - 1];
            i = 1;
        }
    }
    x[0] = (WORD)1 << (TOP + 1);
}

static void SF_JOIN(draw, METHOD)(sf_rng *rng, size_t count, void *out, const sf_rng_kernels *kernels) {
    SF_JOIN(sf, METHOD) *g = &rng->as.METHOD;
    WORD *words = out;
    for (size_t n; count; count -= n, words += n) {
        if (g->used == LENGTH) {
            kernels->SF_JOIN(METHOD, refill)(g->words);
            g->used = 0;
        }
        n = LENGTH - g->used < count ? LENGTH - g->used : count;
        kernels->SF_JOIN(METHOD, temper)(n, g->words + g->used, words);
        g->used += (WORD)n;
    }
}

/* ---- skipping ---- */

/* Puts x(1 + first) … x(624 + first) in place of the words x(0) …, where t^first = p modulo the
 * characteristic polynomial: the sum of the windows that p selects (Haramoto et al. 2008). */
static void SF_JOIN(shift_window, METHOD)(WORD *words, const uint64_t *p, const sf_rng_kernels *kernels) {
    WORD generations[2 * LENGTH], sum[LENGTH] = {0};
    memcpy(generations, words, LENGTH * sizeof(WORD));
    memcpy(generations + LENGTH, words, LENGTH * sizeof(WORD));
    kernels->SF_JOIN(METHOD, refill)(generations + LENGTH);
    for (unsigned power = 0, place = 0; power < SF_TWISTER_DEGREE; ++power, ++place) {
        if (place == LENGTH) {
            memcpy(generations, generations + LENGTH, LENGTH * sizeof(WORD));
            kernels->SF_JOIN(METHOD, refill)(generations + LENGTH);
            place = 0;
        }
        if (!(p[power / 64] >> (power % 64) & 1)) continue;
        for (unsigned i = 0; i < LENGTH; ++i) sum[i] ^= generations[1 + place + i];
    }
    memcpy(words, sum, sizeof sum);
}

static void SF_JOIN(skip, METHOD)(sf_rng *rng, uint64_t count, const sf_rng_kernels *kernels) {
    SF_JOIN(sf, METHOD) *g = &rng->as.METHOD;
    if (count <= LENGTH - g->used) {
        g->used += (WORD)count;
        return;
    }
    /* Land in the generation where drawing would, so that the state is the same too. */
    count -= LENGTH - g->used;
    uint64_t generation = (count - 1) / LENGTH + 1;
    g->used = (WORD)((count - 1) % LENGTH + 1);
    if (generation <= WALKED_GENERATIONS) {
        for (; generation; --generation) kernels->SF_JOIN(METHOD, refill)(g->words);
        return;
    }
    /* From x(1), as all bits of the words after x(0) obey the polynomial. */
    static const sf_twister_shape shape = {LENGTH, MIDDLE, sizeof(WORD) * 8, SEPARATION, TWIST};
    uint64_t p[SF_TWISTER_LIMBS];
    sf_twister_power(&shape, generation * LENGTH - 1, p);
    SF_JOIN(shift_window, METHOD)(g->words, p, kernels);
}

static const char *SF_JOIN(fault, METHOD)(const sf_rng *rng) {
    const SF_JOIN(sf, METHOD) *g = &rng->as.METHOD;
    WORD any = g->words[0] >> SEPARATION;
    for (unsigned i = 1; i < LENGTH; ++i) any |= g->words[i];
    if (!any) return "all bits that count are 0, and would stay 0";
    return g->used <= LENGTH ? NULL : "more words are used than there are";
}

#undef TOP
#undef METHOD
#undef WORD
#undef LENGTH
#undef MIDDLE
#undef SEPARATION
#undef TWIST
#undef SEED_MULTIPLIER
#undef KEY_MULTIPLIER
#undef LAST_MULTIPLIER
