// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "film/stopping.h"

#include <math.h>

#include "film/signed_filter.h"
#include "sunfleck/elementary.h"

#define LEVELS SF_DYADIC_LEVELS
#define FIRST_LOOK 32u        /* two blocks: one difference */
#define FIRST_REPLICATES 128u /* a block for each of eight */

/* What the averaged variance is multiplied by: pixels whose estimate came out low are the ones
 * that stop. Measured, bench/render_coverage.py: 1.0 leaves 92 % coverage on the Cornell box, 1.38 95 %. */
#define SAFETY 1.38

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

sf_lap sf_stop_lap(const sf_render_options *o, uint32_t look) {
    if (o->stop != SF_STOP_RULE_DYADIC || o->start) return (sf_lap){0, 0};
    unsigned depth = log2_of(look / SF_LANES), levels = depth < LEVELS ? depth : LEVELS;
    return (sf_lap){.levels = levels, .unit_shift = depth - levels};
}

/* ---- differences ---- */

void sf_dyadic_begin(sf_film_pixel *pixel) {
    sf_dyadic *d = &pixel->evidence.dyadic;
    for (int j = LEVELS - 1; j > 0; --j) d->squares[j] = d->squares[j - 1];
    d->squares[0] = 0;
    d->pending[0] = sf_film_level_of(&pixel->moments);
    d->unit = 0;
}

void sf_dyadic_add(sf_dyadic *d, double mean, uint32_t block, sf_lap lap) {
    d->unit += mean;
    if (((block + 1) & ((1u << lap.unit_shift) - 1)) != 0) return;
    double value = d->unit / (double)(1u << lap.unit_shift);
    d->unit = 0;
    /* A binary counter: level j holds the left half that waits for a right one of its size. */
    unsigned level = lap.levels;
    for (uint32_t index = block >> lap.unit_shift; index & 1u && level > 0; index >>= 1) {
        double difference = (d->pending[--level] - value) / 2;
        d->squares[level] += (float)(difference * difference);
        value = (d->pending[level] + value) / 2;
    }
    if (level > 0) d->pending[level - 1] = value;
}

/* ---- pools ---- */

static uint32_t pool_columns(const sf_film *film) {
    return (film->x0 + film->width - 1) / SF_POOL_SIZE - film->x0 / SF_POOL_SIZE + 1;
}

uint32_t sf_stop_pool_count(const sf_film *film) {
    return pool_columns(film) * ((film->y0 + film->height - 1) / SF_POOL_SIZE - film->y0 / SF_POOL_SIZE + 1);
}

static uint32_t pool_of(const sf_film *film, uint32_t x, uint32_t y) {
    uint32_t column = (film->x0 + x) / SF_POOL_SIZE - film->x0 / SF_POOL_SIZE;
    return ((film->y0 + y) / SF_POOL_SIZE - film->y0 / SF_POOL_SIZE) * pool_columns(film) + column;
}

static uint32_t held(uint32_t frame, uint32_t offset, uint32_t size) {
    uint32_t inside = frame > offset ? frame - offset : 0;
    return inside < size ? inside : size;
}

sf_pool_range sf_stop_pool_range(const sf_film *film, uint32_t pool) {
    uint32_t left = (film->x0 / SF_POOL_SIZE + pool % pool_columns(film)) * SF_POOL_SIZE;
    uint32_t top = (film->y0 / SF_POOL_SIZE + pool / pool_columns(film)) * SF_POOL_SIZE;
    return (sf_pool_range){held(left, film->x0, film->width), held(top, film->y0, film->height),
                           held(left + SF_POOL_SIZE, film->x0, film->width),
                           held(top + SF_POOL_SIZE, film->y0, film->height)};
}

/* The factor 2^a by which variance falls as samples double: the slope of the logarithms of the
 * pooled squares against their level, each level weighted by its pairs. */
static float fit_decay(const double squares[LEVELS], unsigned levels) {
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

static float predict_variance(const sf_dyadic *d, unsigned levels, float decay) {
    float sum = 0, fall = 1;
    for (unsigned j = 0; j < levels; ++j, fall /= decay) sum += d->squares[j] * fall;
    return sum / ((decay - 1) * (float)((1u << levels) - 1));
}

/* What a pool comes to at a look. */
typedef struct pool_sums {
    double squares[LEVELS]; /* over the pixels looked at */
    double looked_at;
    double variance, power; /* of a sample of (R+G+B)/3, and squared means: over all pixels */
} pool_sums;

static void add_pixel(pool_sums *sums, const sf_film_pixel *pixel, uint32_t look, unsigned levels) {
    double level = sf_film_level_of(&pixel->moments);
    if (pixel->moments.count == 0) return;
    sums->variance += sf_vector_moments_variance(&pixel->moments) / 3; /* an upper bound; exact for greys */
    sums->power += level * level;
    if (sf_film_taken(pixel) != look) return;
    for (unsigned j = 0; j < levels; ++j) sums->squares[j] += (double)pixel->evidence.dyadic.squares[j];
    ++sums->looked_at;
}

static pool_sums sum_pool(const sf_film *film, sf_pool_range range, uint32_t look, unsigned levels) {
    pool_sums sums = {.looked_at = 0};
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) add_pixel(&sums, sf_film_at(film, x, y), look, levels);
    return sums;
}

/* The least variance that a pixel of the pool is believed to have: a share of their mean where light
 * is rare. */
static float least_variance(const pool_sums *sums, unsigned levels, float decay) {
    if (!(sums->variance > SF_HEAVY_TAIL * sums->power) || sums->looked_at == 0) return 0;
    sf_dyadic mean;
    for (unsigned j = 0; j < levels; ++j) mean.squares[j] = (float)(sums->squares[j] / sums->looked_at);
    return LEAST_SHARE * predict_variance(&mean, levels, decay);
}

void sf_stop_look_at_pool(sf_film *film, uint32_t pool, uint32_t look, sf_lap lap) {
    sf_pool_range range = sf_stop_pool_range(film, pool);
    pool_sums sums = sum_pool(film, range, look, lap.levels);
    float decay = film->decay[pool] = fit_decay(sums.squares, lap.levels);
    float least = least_variance(&sums, lap.levels, decay);
    for (uint32_t y = range.y0; y < range.y1; ++y)
        for (uint32_t x = range.x0; x < range.x1; ++x) {
            sf_film_pixel *pixel = sf_film_at(film, x, y);
            if (sf_film_taken(pixel) != look) continue;
            float variance = predict_variance(&pixel->evidence.dyadic, lap.levels, decay);
            pixel->look = (uint8_t)(lap.levels + lap.unit_shift);
            pixel->doubt = variance < least;
            pixel->variance = pixel->doubt ? least : variance;
        }
}

/* ---- half-widths ---- */

/* decay^power, of a neighbour looked at so many doublings later. */
static float power_of(float decay, int power) {
    float result = 1;
    for (; power > 0; --power) result *= decay;
    for (; power < 0; ++power) result /= decay;
    return result;
}

/* The mean over channels of 1 / (r^2 + 0.01): what makes a variance an error of relMSE. */
static double relative_weight(const sf_film_pixel *pixel) {
    double square[3];
    for (int c = 0; c < 3; ++c) square[c] = pixel->moments.mean[c] * pixel->moments.mean[c] + RELMSE_FLOOR;
    double pair = square[0] * square[1];
    return (pair + (square[0] + square[1]) * square[2]) / (3 * pair * square[2]);
}

/* The mean over the 3 x 3 pixels around of the variance at this pixel's look, or of the relative one;
 * those that stopped at another look are carried there by the decay. */
static inline float pooled_variance(const sf_film *film, uint32_t x, uint32_t y, bool relative) {
    const sf_film_pixel *centre = sf_film_at(film, x, y);
    float decay = film->decay[pool_of(film, x, y)], sum = 0, count = 0;
    for (uint32_t v = y ? y - 1 : 0; v <= y + 1 && v < film->height; ++v)
        for (uint32_t u = x ? x - 1 : 0; u <= x + 1 && u < film->width; ++u) {
            const sf_film_pixel *pixel = sf_film_at(film, u, v);
            if (!pixel->look) continue;
            float variance = pixel->variance * power_of(decay, (int)pixel->look - (int)centre->look);
            sum += relative ? variance * (float)relative_weight(pixel) : variance;
            ++count;
        }
    return sum / count;
}

/* Where 25 n samples around saw no difference, there may still be one that is rarer than that: by
 * the rule of three, its probability is below -log(1 - confidence) / (25 n). It is taken to be
 * of the size of the frame's level. */
static double unseen(const sf_film *film, double n) { return film->unseen * film->summary.level / (25 * n); }

/* Over eight replicates of equal size; `factor` is Student's t with 7 degrees of freedom. */
static float replicates_half_width(const sf_film *film, const sf_film_pixel *pixel, double factor) {
    const double *sums = pixel->evidence.replicates;
    double mean = sf_film_level_of(&pixel->moments),
           blocks = (double)(sf_film_taken(pixel) / (SF_LANES * SF_REPLICATES));
    if (film->signed_pixels) mean = film->signed_pixels[pixel - film->pixels].blocks / (blocks * SF_REPLICATES);
    double rest = mean * SF_REPLICATES, squares = 0;
    for (int r = 0; r < SF_REPLICATES - 1; ++r) {
        double off = sums[r] / blocks - mean;
        rest -= sums[r] / blocks;
        squares += off * off;
    }
    squares += (rest - mean) * (rest - mean); /* the last, which the mean of all gives */
    double variance = squares / (SF_REPLICATES - 1) / SF_REPLICATES;
    return (float)(factor * sqrt(variance));
}

/* The variance of a pixel is told from the differences of nine: nine for each pair. Student's t of as
 * many degrees of freedom stands for what is not known of it. */
void sf_stop_set_factors(sf_film *film, const sf_render_options *o) {
    film->unseen = -(double)sf_log((float)(1 - o->confidence));
    film->factors[0] = sf_normal_factor(o->confidence);
    if (o->stop == SF_STOP_RULE_REPLICATES) film->factors[0] = sf_student_t_factor(o->confidence, SF_REPLICATES - 1);
    for (unsigned levels = 1; levels <= LEVELS; ++levels)
        film->factors[levels] = sf_student_t_factor(o->confidence, 9.0 * ((1u << levels) - 1)) * sqrt(SAFETY);
}

double sf_stop_factor(const sf_film *film, const sf_render_options *o, const sf_film_pixel *pixel) {
    unsigned levels = o->stop == SF_STOP_RULE_DYADIC ? pixel->look : 0;
    return film->factors[levels < LEVELS ? levels : LEVELS];
}

float sf_stop_half_width(const sf_film *film, const sf_render_options *o, uint32_t x, uint32_t y) {
    const sf_film_pixel *pixel = sf_film_at(film, x, y);
    double factor = sf_stop_factor(film, o, pixel);
    if (o->stop == SF_STOP_RULE_REPLICATES && sf_stop_is_look(o, (uint32_t)sf_film_taken(pixel)))
        return replicates_half_width(film, pixel, factor);
    if (o->stop != SF_STOP_RULE_DYADIC || !pixel->look) return sf_film_half_width(pixel, factor);
    double half_width = factor * sqrt((double)pooled_variance(film, x, y, false));
    double least = unseen(film, (double)((uint64_t)SF_LANES << pixel->look));
    return (float)(half_width > least ? half_width : least);
}

double sf_stop_relative_error(const sf_film *film, const sf_film_pixel *pixel) {
    if (sf_film_taken(pixel) == 0) return INFINITY;
    if (film->options.stop == SF_STOP_RULE_DYADIC && pixel->look)
        return SAFETY * (double)pixel->variance * relative_weight(pixel);
    double error = (double)pixel->half_width / sf_stop_factor(film, &film->options, pixel);
    return error * error * relative_weight(pixel);
}

float sf_stop_relative_error_around(const sf_film *film, uint32_t x, uint32_t y) {
    const sf_film_pixel *pixel = sf_film_at(film, x, y);
    if (film->options.stop != SF_STOP_RULE_DYADIC || !pixel->look) return (float)sf_stop_relative_error(film, pixel);
    return (float)SAFETY * pooled_variance(film, x, y, true);
}

float sf_stop_decay(const sf_film *film, uint32_t x, uint32_t y) {
    float decay = film->decay[pool_of(film, x, y)];
    return decay > 2 ? decay : 2;
}
