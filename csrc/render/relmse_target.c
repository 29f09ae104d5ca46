// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "render/relmse_target.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "film/film_looks.h"
#include "render/rounds.h"

#define AIM 0.97         /* of the goal, so that estimates of later looks hardly ever pass it */
#define ONE (1u << 24)   /* a pixel whose error is the goal, in the sums */
#define MOST 0x1p62      /* that a pixel adds to them */
#define FALLS 8          /* classes of the factor by which error falls as samples double */
#define FALL_STEP 0.523f /* from 2 to 2^2.5 */
#define GAINS 2048       /* bins of gains: the upper bits of a float, an eighth of an octave each */
#define GAIN_SHIFT 20

/* What the pixels come to, by one thread. */
typedef struct census {
    uint64_t whole;               /* errors of all pixels of the picture */
    uint64_t error[FALLS][GAINS]; /* of those that are open */
    uint64_t count[GAINS];
    uint32_t least[GAINS]; /* samples that an open pixel of the bin has */
} census;

struct sf_relmse_target {
    sf_relmse_target_note *notes; /* as the film's pixels */
    census *censuses;             /* by worker; the first becomes that of all */
    uint32_t threshold;           /* the bin of gains from which on pixels are brought on */
    bool reached;
};

static size_t pixel_count(const sf_rounds *r) { return r->film->stored; }

sf_status sf_relmse_target_prepare(sf_rounds *r, sf_error *error) {
    if (!(r->options.relmse > 0)) return SF_STATUS_OK;
    r->goal = calloc(1, sizeof *r->goal);
    if (!r->goal) return sf_fail_memory(error, "a goal", sizeof *r->goal);
    size_t bytes = pixel_count(r) * sizeof *r->goal->notes;
    r->goal->notes = malloc(bytes);
    if (!r->goal->notes) return sf_fail_memory(error, "the pixels' errors", bytes);
    for (size_t i = 0; i < pixel_count(r); ++i) r->goal->notes[i] = (sf_relmse_target_note){INFINITY, INFINITY, 0};
    bytes = r->options.threads * sizeof *r->goal->censuses;
    r->goal->censuses = malloc(bytes);
    return r->goal->censuses ? SF_STATUS_OK : sf_fail_memory(error, "the threads' sums of errors", bytes);
}

void sf_relmse_target_destroy(sf_relmse_target *goal) {
    if (!goal) return;
    free(goal->notes);
    free(goal->censuses);
    free(goal);
}

void sf_relmse_target_take_note(sf_rounds *r, uint32_t x, uint32_t y) {
    size_t i = sf_film_index(r->film, x, y);
    const sf_film_pixel *pixel = r->film->pixels + i;
    r->goal->notes[i] = (sf_relmse_target_note){.error = (float)sf_film_relative_error(r->film, pixel),
                                                .around = sf_film_relative_error_around(r->film, x, y),
                                                .taken = (uint32_t)sf_film_taken(pixel)};
}

sf_relmse_target_note *sf_relmse_target_notes(sf_relmse_target *goal) { return goal ? goal->notes : NULL; }

bool sf_relmse_target_is_reached(const sf_relmse_target *goal) { return goal->reached; }

/* ---- gains ---- */

/* The bin of what a sample more gains: e (1 - 1/d) / n; what is no number counts as infinite. */
static uint32_t gain_bin(const sf_relmse_target_note *pixel, float fall) {
    float gain = pixel->around * (1 - 1 / fall) / (float)(pixel->taken ? pixel->taken : 1);
    uint32_t bits;
    gain = gain > 0 ? gain : gain == 0 ? 0 : INFINITY; /* -0.0 has the bits of a bin beyond the last */
    memcpy(&bits, &gain, sizeof bits);
    return bits >> GAIN_SHIFT;
}

static float fall_in(const sf_rounds *r, uint32_t cell) {
    return sf_film_decay_at(r->film, sf_rounds_x(r, cell, 0), sf_rounds_y(r, cell, 0));
}

/* The middle of a bin. */
static float gain_of(uint32_t bin) {
    uint32_t bits = bin << GAIN_SHIFT | 1u << (GAIN_SHIFT - 1);
    float gain;
    memcpy(&gain, &bits, sizeof gain);
    return gain < 1e38f ? gain : 1e38f;
}

static uint32_t fall_class(float fall) {
    uint32_t class = (uint32_t)((fall - 2) / FALL_STEP + 0.5f);
    return class < FALLS ? class : FALLS - 1;
}

/* ---- the census ---- */

/* Ends at the largest number, whatever the order. */
static void add_error(uint64_t *sum, uint64_t error) { *sum = error > UINT64_MAX - *sum ? UINT64_MAX : *sum + error; }

static void count_cell(const sf_rounds *r, census *c, uint32_t cell) {
    float fall = fall_in(r, cell);
    uint64_t *errors = c->error[fall_class(fall)];
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
        uint32_t x = sf_rounds_x(r, cell, m), y = sf_rounds_y(r, cell, m);
        if (x >= r->film->width || y >= r->film->height) continue;
        const sf_relmse_target_note *pixel = r->goal->notes + sf_film_index(r->film, x, y);
        double part = (double)pixel->error / r->options.relmse * ONE;
        uint64_t error = sf_rounds_in_picture(r, x, y) ? (uint64_t)(part < MOST ? part : MOST) : 0;
        add_error(&c->whole, error);
        if (!(r->open[cell] >> m & 1u)) continue;
        uint32_t bin = gain_bin(pixel, fall);
        add_error(errors + bin, error);
        ++c->count[bin];
        c->least[bin] = pixel->taken < c->least[bin] ? pixel->taken : c->least[bin];
    }
}

static void count_row(void *user, unsigned worker, size_t row) {
    const sf_rounds *r = user;
    for (uint32_t x = 0; x < r->film->cell_columns; ++x)
        count_cell(r, r->goal->censuses + worker, (uint32_t)row * r->film->cell_columns + x);
}

static void add_census(census *sum, const census *part) {
    add_error(&sum->whole, part->whole);
    for (int f = 0; f < FALLS; ++f)
        for (int g = 0; g < GAINS; ++g) add_error(&sum->error[f][g], part->error[f][g]);
    for (int g = 0; g < GAINS; ++g) {
        sum->count[g] += part->count[g];
        sum->least[g] = part->least[g] < sum->least[g] ? part->least[g] : sum->least[g];
    }
}

static const census *take_census(sf_rounds *r) {
    census *censuses = r->goal->censuses;
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        memset(censuses + i, 0, sizeof *censuses);
        memset(censuses[i].least, 0xff, sizeof censuses[i].least);
    }
    sf_thread_pool_run(r->pool, r->film->cell_rows, count_row, sf_rounds_wake, r);
    for (uint32_t i = 1; i < r->options.threads; ++i) add_census(censuses, censuses + i);
    return censuses;
}

/* ---- the threshold ---- */

/* By how much the errors fall of pixels whose gain is brought below the threshold. */
static double fall_to(uint32_t bin, uint32_t threshold, float fall) {
    double factor = 1;
    for (float gain = gain_of(bin), last = gain_of(threshold); gain >= last; gain /= 2 * fall) factor /= (double)fall;
    return factor;
}

/* The sum of errors once no gain is in the threshold's bin or beyond. */
static double predict(const census *c, uint32_t threshold) {
    double sum = (double)c->whole;
    for (int f = 0; f < FALLS; ++f)
        for (uint32_t bin = threshold; bin < GAINS; ++bin)
            if (c->error[f][bin])
                sum -= (double)c->error[f][bin] * (1 - fall_to(bin, threshold, 2 + FALL_STEP * (float)f));
    return sum;
}

/* The largest threshold that leads to `aim`; bin 0, which brings on all pixels, where none does. */
static uint32_t choose_threshold(const census *c, double aim) {
    uint32_t low = 0, high = GAINS;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (predict(c, middle) <= aim)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* ---- the choice ---- */

static void choose_row(void *user, unsigned worker, size_t row) {
    sf_rounds *r = user;
    (void)worker;
    for (uint32_t x = 0; x < r->film->cell_columns; ++x) {
        uint32_t cell = (uint32_t)row * r->film->cell_columns + x;
        float fall = fall_in(r, cell);
        r->active[cell] = 0;
        for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
            if (!(r->open[cell] >> m & 1u)) continue;
            uint32_t u = sf_rounds_x(r, cell, m), v = sf_rounds_y(r, cell, m);
            const sf_relmse_target_note *pixel = r->goal->notes + sf_film_index(r->film, u, v);
            if (pixel->taken == r->from && gain_bin(pixel, fall) >= r->goal->threshold)
                r->active[cell] |= UINT64_C(1) << m;
        }
    }
}

bool sf_relmse_target_choose(sf_rounds *r) {
    const census *c = take_census(r);
    double goal = (double)r->film->counted * ONE;
    r->progress.relmse = (double)c->whole / goal * r->options.relmse;
    r->goal->reached = c->whole <= r->film->counted * (UINT64_C(1) * ONE - 1); /* parts were rounded down */
    if (r->goal->reached) return false;
    r->goal->threshold = choose_threshold(c, AIM * goal);
    uint32_t least = UINT32_MAX;
    uint64_t beyond = 0;
    for (uint32_t bin = r->goal->threshold; bin < GAINS; ++bin) {
        least = c->least[bin] < least ? c->least[bin] : least;
        beyond += c->count[bin];
    }
    r->beyond = beyond;
    if (!beyond) return false;
    r->from = least;
    r->look = sf_stop_next_look(&r->options, least);
    sf_thread_pool_run(r->pool, r->film->cell_rows, choose_row, sf_rounds_wake, r);
    return true;
}
