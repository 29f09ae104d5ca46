// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Intervals for the mean of bounded values: empirical Bernstein and bets. */

#include <math.h>
#include <stdlib.h>

#include "base/error.h"
#include "base/interrupt.h"
#include "sunfleck/estimate.h"

#define MAX_BET 0.5    /* of the sequence, and … */
#define MAX_STAKE 0.75 /* … of what could ruin the hedged capital; the paper recommends 1/2 or 3/4 */
#define BISECTIONS 52  /* of [0,1]: to the last bit of a double near 1 */

double sf_moments_bernstein_half_width(const sf_moments *m, double range, double confidence) {
    if (m->count < 2) return (double)INFINITY;
    double n = (double)m->count, s = sf_moments_sample_deviation(m), L = log(4.0 / (1.0 - confidence));
    return s * sqrt(2.0 * L / n) + 7.0 * range * L / (3.0 * (n - 1.0));
}

/* ---- bets ---- */

/* What is known before sample t = count + 1: mean and variance with one imagined sample at 1/2 of
 * variance 1/4 (Waudby-Smith & Ramdas 2023). */
typedef struct past {
    double count, sum, square;
} past;

static double past_mean(const past *p) { return (0.5 + p->sum) / (p->count + 1.0); }
static double past_variance(const past *p) { return (0.25 + p->square) / (p->count + 1.0); }

/* The untruncated bet on sample count + 1: sqrt(2 log(2/alpha) / (variance t log(1 + t))). */
static double past_bet(const past *p, double log_factor) {
    double t = p->count + 1.0;
    return sqrt(2.0 * log_factor / (past_variance(p) * t * log(1.0 + t)));
}

static void past_add(past *p, double x) {
    p->count += 1.0;
    p->sum += x;
    double deviation = x - past_mean(p);
    p->square += deviation * deviation;
}

static sf_status check(double low, double high, double confidence, sf_error *error) {
    if (!(isfinite(low) && isfinite(high) && low < high && isfinite(high - low)))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "the samples' interval is [%g, %g]; give finite low < high", low,
                       high);
    if (!(confidence > 0.0 && confidence < 1.0))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "confidence is %g; give one above 0 and below 1", confidence);
    return SF_STATUS_OK;
}

/* ---- the confidence sequence ---- */

sf_status sf_confidence_sequence_init(sf_confidence_sequence *c, double low, double high, double confidence,
                                      double target, sf_error *error) {
    sf_status status = check(low, high, confidence, error);
    if (status != SF_STATUS_OK) return status;
    if (!(target >= 0.0 && isfinite(target)))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "target is %g; give a finite half-width, or 0 for none", target);
    *c = (sf_confidence_sequence){.low = low,
                                  .high = high,
                                  .confidence = confidence,
                                  .target = target,
                                  .log_factor = log(2.0 / (1.0 - confidence)),
                                  .upper = 1.0};
    return SF_STATUS_OK;
}

void sf_confidence_sequence_add(sf_confidence_sequence *c, double sample) {
    if (!isfinite(sample)) {
        ++c->nonfinite;
        return;
    }
    if (sample < c->low || sample > c->high) {
        ++c->outside;
        return;
    }
    double x = (sample - c->low) / (c->high - c->low);
    past before = {(double)c->count, c->sum, c->square};
    double bet =
        c->target > 0.0 ? c->target / (c->high - c->low) / past_variance(&before) : past_bet(&before, c->log_factor);
    bet = fmin(bet, MAX_BET);
    double deviation = x - past_mean(&before);
    c->bets += bet;
    c->winnings += bet * x;
    /* v psi(bet), v = 4 (x - mean)^2, psi(bet) = (-log(1 - bet) - bet) / 4 */
    c->penalty += deviation * deviation * (-log1p(-bet) - bet);
    past_add(&before, x);
    ++c->count;
    c->sum = before.sum;
    c->square = before.square;
    /* Intersect; an empty intersection (an error has happened) keeps the last. */
    double centre = c->winnings / c->bets, half = (c->log_factor + c->penalty) / c->bets;
    double lower = fmax(c->lower, centre - half), upper = fmin(c->upper, centre + half);
    if (lower > upper) return;
    c->lower = lower;
    c->upper = upper;
}

void sf_confidence_sequence_add_f64(sf_confidence_sequence *c, size_t count, const double *x) {
    for (size_t i = 0; i < count; ++i) sf_confidence_sequence_add(c, x[i]);
}

double sf_confidence_sequence_lower(const sf_confidence_sequence *c) {
    return c->outside ? -(double)INFINITY : c->low + (c->high - c->low) * c->lower;
}
double sf_confidence_sequence_upper(const sf_confidence_sequence *c) {
    return c->outside ? (double)INFINITY : c->high - (c->high - c->low) * (1.0 - c->upper);
}

/* ---- the hedged capital ---- */

/* log of the capital of one who bets that the mean is above m; never rises with m. Factors are
 * between 1/4 and some 10, so that products of 16 neither overflow nor vanish. */
static double log_capital(size_t n, const double *x, const double *bets, double m, sf_watch *watch) {
    double log_sum = 0.0, most = m > 0.0 ? MAX_STAKE / m : (double)INFINITY;
    for (size_t first = 0; first < n && !sf_watch_step(watch, 16); first += 16) {
        double product = 1.0;
        size_t end = n - first < 16 ? n : first + 16;
        for (size_t i = first; i < end; ++i) product *= 1.0 + fmin(bets[i], most) * (x[i] - m);
        log_sum += log(product);
    }
    return log_sum;
}

/* The least mean at which that capital stays below exp(limit). */
static double least_mean(size_t n, const double *x, const double *bets, double limit, sf_watch *watch) {
    double below = 0.0, above = 1.0;
    if (log_capital(n, x, bets, 0.0, watch) < limit) return 0.0;
    for (int i = 0; i < BISECTIONS && !sf_watch_stopped(watch); ++i) {
        double m = 0.5 * (below + above);
        if (log_capital(n, x, bets, m, watch) < limit)
            above = m;
        else
            below = m;
    }
    return below;
}

static sf_status scale(size_t n, const double *x, double low, double high, double *scaled, sf_watch *watch,
                       sf_error *error) {
    for (size_t i = 0; i < n; ++i) {
        if (!(x[i] >= low && x[i] <= high))
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "sample %zu is %g, outside [%g, %g]", i, x[i], low, high);
        scaled[i] = (x[i] - low) / (high - low);
        if (sf_watch_item(watch, i)) break;
    }
    return sf_watch_status(watch, error);
}

/* For a count fixed ahead: sqrt(2 log(2/alpha) / (n variance)). */
static void make_bets(size_t n, const double *x, double limit, double *bets, sf_watch *watch) {
    past before = {0};
    for (size_t i = 0; i < n && !sf_watch_item(watch, i); ++i) {
        bets[i] = sqrt(2.0 * limit / ((double)n * past_variance(&before)));
        past_add(&before, x[i]);
    }
}

sf_status sf_betting_interval_f64(size_t count, const double *x, double low, double high, double confidence,
                                  double *lower, double *upper, const sf_interrupt *interrupt, sf_error *error) {
    sf_status status = check(low, high, confidence, error);
    if (status != SF_STATUS_OK) return status;
    double *scaled = sf_aligned_alloc((2 * count + 1) * sizeof *scaled), *bets = scaled ? scaled + count : NULL;
    if (!scaled) return sf_fail_memory(error, "the bets", (2 * count + 1) * sizeof *scaled);
    sf_watch watch;
    sf_watch_begin(&watch, interrupt);
    status = scale(count, x, low, high, scaled, &watch, error);
    if (status == SF_STATUS_OK) {
        double limit = log(2.0 / (1.0 - confidence));
        make_bets(count, scaled, limit, bets, &watch);
        double least = least_mean(count, scaled, bets, limit, &watch);
        for (size_t i = 0; i < count && !sf_watch_item(&watch, i); ++i) scaled[i] = 1.0 - scaled[i];
        double most = least_mean(count, scaled, bets, limit, &watch);
        status = sf_watch_status(&watch, error);
        if (status == SF_STATUS_OK) {
            *lower = low + (high - low) * least;
            *upper = high - (high - low) * most;
        }
    }
    sf_aligned_free(scaled);
    return status;
}
