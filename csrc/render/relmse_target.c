// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Selects pixels by what a sample of them gains for the relMSE of the whole picture. */
#include "render/relmse_target.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "film/film_looks.h"
#include "render/progress.h"
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
    double estimate; /* of relMSE */
    uint64_t beyond; /* pixels that more samples are wanted of */
};

sf_status sf_relmse_target_create(const sf_render_options *options, const sf_film *film, sf_relmse_target **out,
                                  sf_error *error) {
    *out = NULL;
    if (!(options->relmse > 0)) return SF_STATUS_OK;
    sf_relmse_target *goal = calloc(1, sizeof *goal);
    if (!goal) return sf_fail_memory(error, "a goal", sizeof *goal);
    size_t notes = film->stored * sizeof *goal->notes, sums = options->threads * sizeof *goal->censuses;
    goal->notes = malloc(notes);
    goal->censuses = malloc(sums);
    sf_status status = SF_STATUS_OK;
    if (!goal->notes)
        status = sf_fail_memory(error, "the pixels' errors", notes);
    else if (!goal->censuses)
        status = sf_fail_memory(error, "the threads' sums of errors", sums);
    for (size_t i = 0; !status && i < film->stored; ++i)
        goal->notes[i] = (sf_relmse_target_note){INFINITY, INFINITY, 0};
    if (status)
        sf_relmse_target_destroy(goal);
    else
        *out = goal;
    return status;
}

void sf_relmse_target_destroy(sf_relmse_target *goal) {
    if (!goal) return;
    free(goal->notes);
    free(goal->censuses);
    free(goal);
}

void sf_relmse_target_take_note(sf_relmse_target *goal, const sf_film *film, uint32_t x, uint32_t y) {
    size_t i = sf_film_index(film, x, y);
    const sf_film_pixel *pixel = film->pixels + i;
    goal->notes[i] = (sf_relmse_target_note){.error = (float)sf_film_relative_error(film, pixel),
                                             .around = sf_film_relative_error_around(film, x, y),
                                             .taken = (uint32_t)sf_film_taken(pixel)};
}

sf_relmse_target_note *sf_relmse_target_notes(sf_relmse_target *goal) { return goal ? goal->notes : NULL; }

bool sf_relmse_target_is_reached(const sf_relmse_target *goal) { return goal->reached; }

double sf_relmse_target_estimate(const sf_relmse_target *goal) { return goal->estimate; }

uint64_t sf_relmse_target_beyond(const sf_relmse_target *goal) { return goal->beyond; }

/* A selection at work. */
typedef struct selection {
    const sf_rounds *r;
    sf_relmse_target *goal;
    uint64_t *active;
    uint32_t from; /* pixels that have so many samples */
} selection;

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

static void count_cell(const sf_rounds *r, const sf_relmse_target *goal, census *c, uint32_t cell) {
    float fall = fall_in(r, cell);
    uint64_t *errors = c->error[fall_class(fall)];
    for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
        uint32_t x = sf_rounds_x(r, cell, m), y = sf_rounds_y(r, cell, m);
        if (x >= r->film->width || y >= r->film->height) continue;
        const sf_relmse_target_note *pixel = goal->notes + sf_film_index(r->film, x, y);
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
    const selection *s = user;
    const sf_rounds *r = s->r;
    for (uint32_t x = 0; x < r->film->cell_columns; ++x)
        count_cell(r, s->goal, s->goal->censuses + worker, (uint32_t)row * r->film->cell_columns + x);
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

static const census *take_census(selection *s) {
    const sf_rounds *r = s->r;
    census *censuses = s->goal->censuses;
    for (uint32_t i = 0; i < r->options.threads; ++i) {
        memset(censuses + i, 0, sizeof *censuses);
        memset(censuses[i].least, 0xff, sizeof censuses[i].least);
    }
    sf_rounds_run_phase(r, r->film->cell_rows, count_row, s);
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
    const selection *s = user;
    const sf_rounds *r = s->r;
    (void)worker;
    for (uint32_t x = 0; x < r->film->cell_columns; ++x) {
        uint32_t cell = (uint32_t)row * r->film->cell_columns + x;
        float fall = fall_in(r, cell);
        s->active[cell] = 0;
        for (uint32_t m = 0; m < SF_CELL_PIXELS; ++m) {
            if (!(r->open[cell] >> m & 1u)) continue;
            uint32_t u = sf_rounds_x(r, cell, m), v = sf_rounds_y(r, cell, m);
            const sf_relmse_target_note *pixel = s->goal->notes + sf_film_index(r->film, u, v);
            if (pixel->taken == s->from && gain_bin(pixel, fall) >= s->goal->threshold)
                s->active[cell] |= UINT64_C(1) << m;
        }
    }
}

sf_lap sf_relmse_target_select(sf_relmse_target *goal, const sf_rounds *r, uint64_t *active) {
    selection s = {.r = r, .goal = goal, .active = active, .from = UINT32_MAX};
    sf_lap lap = {.target = r->target};
    const census *c = take_census(&s);
    double allowed = (double)r->film->counted * ONE;
    goal->estimate = (double)c->whole / allowed * r->options.relmse;
    goal->reached = c->whole <= r->film->counted * (UINT64_C(1) * ONE - 1); /* parts were rounded down */
    if (goal->reached) return lap;
    goal->threshold = choose_threshold(c, AIM * allowed);
    goal->beyond = 0;
    for (uint32_t bin = goal->threshold; bin < GAINS; ++bin) {
        s.from = c->least[bin] < s.from ? c->least[bin] : s.from;
        goal->beyond += c->count[bin];
    }
    if (!goal->beyond) return lap;
    sf_rounds_run_phase(r, r->film->cell_rows, choose_row, &s);
    return (sf_lap){
        .begins = true, .from = s.from, .look = sf_stop_next_look(&r->options, s.from), .target = r->target};
}
