// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The stopping rules: when they look, and the variance that they tell from what pixels keep. */
#include "film/stopping.h"

#include <math.h>

#include "sunfleck/elementary.h"

#define LEVELS SF_DYADIC_LEVELS
#define FIRST_LOOK 32u        /* two blocks: one difference */
#define FIRST_REPLICATES 128u /* a block for each of eight */

#define RELMSE_FLOOR 0.01 /* in the denominator of relMSE */

#define LEAST_SHARE 0.25f /* of the mean variance of its pool, that a pixel has where light is rare */

/* ---- looks ---- */

/* The largest is SF_MAX_SPP, itself a power of two. */
static uint32_t power_at_least(uint32_t n) {
    uint32_t power = 1;
    while (power < n && power < SF_MAX_SPP) power *= 2;
    return power;
}

static uint32_t first_look(const sf_render_options *o) {
    uint32_t least = o->stop == SF_STOP_RULE_REPLICATES ? FIRST_REPLICATES : FIRST_LOOK;
    uint32_t asked = o->spp ? least : power_at_least(o->min_spp);
    return asked > least ? asked : least;
}

uint32_t sf_stop_next_look(const sf_render_options *o, uint32_t n) {
    if (o->stop == SF_STOP_RULE_STANDARD_ERROR) {
        if (n < o->min_spp && !o->spp) return o->min_spp;
        return sf_stop_quarter_more(n);
    }
    uint32_t first = first_look(o), power = power_at_least(n + 1);
    return power > first ? power : first;
}

bool sf_stop_is_look(const sf_render_options *o, uint32_t n) {
    if (o->stop == SF_STOP_RULE_STANDARD_ERROR) return n >= 2;
    return o->start == 0 && n >= first_look(o) && (n & (n - 1)) == 0;
}

static unsigned log2_of(uint32_t power) {
    unsigned exponent = 0;
    while (power >>= 1) ++exponent;
    return exponent;
}

sf_pairing sf_stop_pairing(const sf_render_options *o, uint32_t look) {
    if (o->stop != SF_STOP_RULE_DYADIC || o->start) return (sf_pairing){0, 0};
    unsigned depth = log2_of(look / SF_LANES), levels = depth < LEVELS ? depth : LEVELS;
    return (sf_pairing){.levels = levels, .unit_shift = depth - levels};
}

/* ---- differences ---- */

void sf_dyadic_begin(sf_dyadic *d, double mean) {
    for (int j = LEVELS - 1; j > 0; --j) d->squares[j] = d->squares[j - 1];
    d->squares[0] = 0;
    d->pending[0] = mean;
    d->unit = 0;
}

void sf_dyadic_add(sf_dyadic *d, double mean, uint32_t block, sf_pairing pairing) {
    d->unit += mean;
    if (((block + 1) & ((1u << pairing.unit_shift) - 1)) != 0) return;
    double value = d->unit / (double)(1u << pairing.unit_shift);
    d->unit = 0;
    /* A binary counter: level j holds the left half that waits for a right one of its size. */
    unsigned level = pairing.levels;
    for (uint32_t index = block >> pairing.unit_shift; index & 1u && level > 0; index >>= 1) {
        double difference = (d->pending[--level] - value) / 2;
        d->squares[level] += (float)(difference * difference);
        value = (d->pending[level] + value) / 2;
    }
    if (level > 0) d->pending[level - 1] = value;
}

float sf_dyadic_variance(const sf_dyadic *d, sf_pairing pairing, float decay) {
    float sum = 0, fall = 1;
    for (unsigned j = 0; j < pairing.levels; ++j, fall /= decay) sum += d->squares[j] * fall;
    return sum / ((decay - 1) * (float)((1u << pairing.levels) - 1));
}

/* ---- pools ---- */

/* The slope of the logarithms of the pooled squares against their level, each level weighted by its pairs. */
float sf_stop_pool_decay(const sf_stop_pool *pool, sf_pairing pairing) {
    const double *squares = pool->squares;
    unsigned levels = pairing.levels;
    if (levels < 2) return 2;
    float weight = 0, middle = 0, height = 0, logarithm[LEVELS];
    for (unsigned j = 0; j < levels; ++j) {
        double ratio = squares[j] / (double)(1u << j) / squares[0];
        if (!(ratio > 1e-30 && ratio < 1e30)) return 2;
        float w = (float)(1u << j);
        logarithm[j] = sf_log((float)ratio);
        weight += w;
        middle += w * (float)j;
        height += w * logarithm[j];
    }
    middle /= weight;
    height /= weight;
    float rise = 0, run = 0;
    for (unsigned j = 0; j < levels; ++j) {
        float w = (float)(1u << j), off = (float)j - middle;
        rise += w * off * (logarithm[j] - height);
        run += w * off * off;
    }
    float factor = sf_exp(rise / run);
    return factor < 2 ? 2 : factor > 0x1.6a09e6p+2f ? 0x1.6a09e6p+2f : factor; /* a = 1 .. 2.5 */
}

void sf_stop_pool_add(sf_stop_pool *pool, const sf_film_pixel *pixel, uint32_t look, sf_pairing pairing) {
    double level = sf_film_level_of(&pixel->moments);
    if (pixel->moments.count == 0) return;
    pool->variance += sf_vector_moments_variance(&pixel->moments) / 3; /* an upper bound; exact for greys */
    pool->power += level * level;
    if (sf_film_taken(pixel) != look) return;
    for (unsigned j = 0; j < pairing.levels; ++j) pool->squares[j] += (double)pixel->evidence.dyadic.squares[j];
    ++pool->looked_at;
}

float sf_stop_pool_least_variance(const sf_stop_pool *pool, sf_pairing pairing, float decay) {
    if (!(pool->variance > SF_HEAVY_TAIL * pool->power) || pool->looked_at == 0) return 0;
    sf_dyadic mean;
    for (unsigned j = 0; j < pairing.levels; ++j) mean.squares[j] = (float)(pool->squares[j] / pool->looked_at);
    return LEAST_SHARE * sf_dyadic_variance(&mean, pairing, decay);
}

/* ---- half-widths ---- */

double sf_stop_relative_weight(const sf_film_pixel *pixel) {
    double square[3];
    for (int c = 0; c < 3; ++c) square[c] = pixel->moments.mean[c] * pixel->moments.mean[c] + RELMSE_FLOOR;
    double pair = square[0] * square[1];
    return (pair + (square[0] + square[1]) * square[2]) / (3 * pair * square[2]);
}

double sf_stop_replicates_variance(const sf_film_pixel *pixel, double mean) {
    const double *sums = pixel->evidence.replicates;
    double blocks = (double)(sf_film_taken(pixel) / (SF_LANES * SF_REPLICATES));
    double rest = mean * SF_REPLICATES, squares = 0;
    for (int r = 0; r < SF_REPLICATES - 1; ++r) {
        double off = sums[r] / blocks - mean;
        rest -= sums[r] / blocks;
        squares += off * off;
    }
    squares += (rest - mean) * (rest - mean); /* the last, which the mean of all gives */
    return squares / (SF_REPLICATES - 1) / SF_REPLICATES;
}

/* The variance of a pixel is told from the differences of nine: nine for each pair. Student's t of as
 * many degrees of freedom stands for what is not known of it. */
void sf_stop_set_factors(const sf_render_options *o, double factors[LEVELS + 1]) {
    factors[0] = sf_normal_factor(o->confidence);
    if (o->stop == SF_STOP_RULE_REPLICATES) factors[0] = sf_student_t_factor(o->confidence, SF_REPLICATES - 1);
    for (unsigned levels = 1; levels <= LEVELS; ++levels)
        factors[levels] = sf_student_t_factor(o->confidence, 9.0 * ((1u << levels) - 1)) * sqrt(SF_DYADIC_SAFETY);
}

double sf_stop_factor(const double factors[LEVELS + 1], const sf_render_options *o, const sf_film_pixel *pixel) {
    unsigned levels = o->stop == SF_STOP_RULE_DYADIC ? pixel->look : 0;
    return factors[levels < LEVELS ? levels : LEVELS];
}

double sf_stop_unseen(const sf_render_options *o) { return -(double)sf_log((float)(1 - o->confidence)); }
