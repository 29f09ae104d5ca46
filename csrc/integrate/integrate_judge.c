// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The values of sf_integrate: sums, half-widths, and whether these can be trusted. */

#include <stdlib.h>

#include "integrate/integration.h"

#define HEAVY_SHARE 0.5        /* of the means' variance, by one sample of each: suspicious … */
#define HEAVY_CONFIDENCE 0.999 /* … if the means follow those samples beyond this doubt */
#define FAR 3.0                /* standard deviations from the mean: an extreme sample of no smooth function's */
#define HEAVY_INDEX 0.5        /* the tail's index from which on the variance is infinite */
#define TOP 16                 /* the most extreme samples, which a tail that goes on spreads, too … */
#define TOP_INDEX 0.25         /* … by this: known to a quarter of the index */
#define LOOK_SHARE 0.5         /* of the error probability, for each look: of replicates … */
#define INDEPENDENT_SHARE 0.8  /* … and of independent samples */
#define FADING 0.6             /* of what a look holds back, from one to the next */
#define UNSEEN_STEP_SHARE 0.2  /* of the error probability, for a step that all copies see alike */
#define LARGE 0x1p500          /* beyond: squares and their sums may overflow */
#define SMALL_UNIT 0x1p-540    /* the unit then: sums of 2^64 squares of the largest double fit */

int sf_integration_range_is_known(const integration *in) {
    return isfinite(in->options.low) && isfinite(in->options.high);
}

void sf_integration_forget(integration *in) {
    for (uint32_t k = 0; k < in->components; ++k) {
        component *c = &in->component[k];
        c->unit = 1.0;
        c->up.count = c->down.count = 0;
        c->up.floor = c->down.floor = -(double)INFINITY;
        for (uint32_t r = 0; r < in->options.replicates; ++r)
            c->tallies[r] = (tally){.least = (double)INFINITY, .greatest = -(double)INFINITY};
    }
}

/* ---- sums ---- */

static int is_below(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Sorts the largest to the front and keeps INTEGRATION_TAIL of them. */
static void tail_trim(tail *t) {
    qsort(t->value, t->count, sizeof *t->value, is_below);
    if (t->count < INTEGRATION_TAIL) return;
    t->count = INTEGRATION_TAIL;
    t->floor = t->value[INTEGRATION_TAIL - 1];
}

static void tail_add(tail *t, double x) {
    if (!(x > t->floor)) return;
    t->value[t->count++] = x;
    if (t->count == 2 * (size_t)INTEGRATION_TAIL) tail_trim(t);
}

/* Takes a smaller unit for the sums so far. */
static void shrink(const integration *in, component *c) {
    c->unit = SMALL_UNIT;
    for (uint32_t r = 0; r < in->options.replicates; ++r) {
        tally *t = &c->tallies[r];
        t->moments.mean *= SMALL_UNIT;
        t->moments.m2 *= SMALL_UNIT * SMALL_UNIT;
        t->least *= SMALL_UNIT;
        t->greatest *= SMALL_UNIT;
    }
    for (size_t i = 0; i < c->up.count; ++i) c->up.value[i] *= SMALL_UNIT;
    for (size_t i = 0; i < c->down.count; ++i) c->down.value[i] *= SMALL_UNIT;
    c->up.floor *= SMALL_UNIT;
    c->down.floor *= SMALL_UNIT;
}

static void take_column(integration *in, component *c, uint32_t r, size_t count, double *x) {
    double least = (double)INFINITY, greatest = -least;
    for (size_t i = 0; i < count; ++i) {
        c->result->nonfinite += !isfinite(x[i]);
        if (!isfinite(x[i])) continue;
        least = x[i] < least ? x[i] : least;
        greatest = x[i] > greatest ? x[i] : greatest;
    }
    if (in->independent && sf_integration_range_is_known(in)) sf_confidence_sequence_add_f64(&c->sequence, count, x);
    if (c->unit == 1.0 && fmax(greatest, -least) > LARGE) shrink(in, c);
    for (size_t i = 0; i < count; ++i) {
        x[i] *= c->unit;
        if (!isfinite(x[i])) continue;
        tail_add(&c->up, x[i]);
        tail_add(&c->down, -x[i]);
    }
    tally *t = &c->tallies[r];
    t->least = fmin(t->least, least * c->unit);
    t->greatest = fmax(t->greatest, greatest * c->unit);
    sf_moments_add_f64(&t->moments, count, x);
}

sf_status sf_integration_take_values(integration *in, uint32_t r, size_t count, const double *values,
                                     const double *weights) {
    const sf_integrate_options *o = &in->options;
    for (uint32_t k = 0; k < in->components; ++k) {
        for (size_t i = 0; i < count; ++i) {
            double x = values[i * in->components + k];
            if (isfinite(x) && (x < o->low || x > o->high))
                return sf_fail(in->error, SF_STATUS_INVALID_VALUE,
                               "the function gave %.17g, outside the range of values, [%.17g, %.17g], that it was "
                               "said to have",
                               x, o->low, o->high);
            in->column[i] = weights ? x * weights[i] : x;
        }
        take_column(in, &in->component[k], r, count, in->column);
    }
    return SF_STATUS_OK;
}

/* ---- half-widths ---- */

static sf_moments all_samples(const integration *in, const component *c) {
    sf_moments all = {0};
    for (uint32_t r = 0; r < in->options.replicates; ++r) sf_moments_merge(&all, &c->tallies[r].moments);
    return all;
}

double sf_integration_mean(const integration *in, const component *c) {
    sf_moments all = all_samples(in, c);
    return sf_moments_mean(&all) / c->unit;
}

/* The least and the greatest value of all. */
static void extent(const integration *in, const component *c, double *least, double *greatest) {
    *least = (double)INFINITY;
    *greatest = -(double)INFINITY;
    for (uint32_t r = 0; r < in->options.replicates; ++r) {
        *least = fmin(*least, c->tallies[r].least);
        *greatest = fmax(*greatest, c->tallies[r].greatest);
    }
}

/* What an event may weigh that none of N samples saw: its probability is below log(1 / alpha) / N
 * with confidence 1 - alpha, since (1 - p)^N <= exp(-p N). */
static double unseen(const integration *in, const component *c, double n, double least, double greatest) {
    const sf_integrate_options *o = &in->options;
    double range = greatest - least;
    if (sf_integration_range_is_known(in))
        range = (o->high - o->low) * in->volume * c->unit;
    else if (range == 0.0)
        range = least != 0.0 ? fabs(least) : 1.0;
    return -log(1.0 - o->confidence) / n * range;
}

/* By Student's t, on the means of the replicates or on independent samples. */
static void estimate(const integration *in, const component *c, double *value, double *half_width) {
    sf_moments all = all_samples(in, c), means = {0};
    double alpha = 1.0 - in->options.confidence, least, greatest;
    extent(in, c, &least, &greatest);
    if (in->independent) {
        means = all;
    } else {
        for (uint32_t r = 0; r < in->options.replicates; ++r)
            sf_moments_add(&means, sf_moments_mean(&c->tallies[r].moments));
        if (means.nonfinite) means.count = 0; /* a replicate without a finite sample */
    }
    alpha *= in->independent ? INDEPENDENT_SHARE : LOOK_SHARE;
    *value = means.count ? means.mean : sf_moments_mean(&all);
    *half_width = sf_moments_half_width(&means, 1.0 - alpha);
    if (means.count > 1 && (means.m2 == 0.0 || least == greatest))
        *half_width = unseen(in, c, (double)all.count, least, greatest);
    /* The sum itself is rounded. */
    double rounding = 4.0 * 0x1p-53 * fmax(fabs(least), fabs(greatest));
    if (all.count && *half_width < rounding) *half_width = rounding;
    *value /= c->unit;
    *half_width /= c->unit;
}

/* The part of a stratum to allow for, where no look has gone before: all R copies see the same of a
 * step, p of a stratum from its edge, with probability p^R + (1 - p)^R. With p uniform, p is
 * beyond this part nonetheless with probability 2 (1 - part)^(R + 1) / (R + 1). */
static double part_allowed(const sf_integrate_options *o) {
    double n = (double)o->replicates + 1.0, chance = UNSEEN_STEP_SHARE * (1.0 - o->confidence);
    return 1.0 - fmin(1.0, pow(0.5 * chance * n, 1.0 / n));
}

/* Widens what falls faster than 1 / n, the error of a step that the points of a copy have a common
 * offset to, where the last looks do not bear it out: that all copies see the same of the step is a
 * coincidence, which rarely lasts. Before so many looks, by the range of values. The part that older looks
 * have fades to 0.36, near what the range has: a step's half-width is some 0.3 / n of it. */
static void hold_back(const integration *in, component *c, double *half_width) {
    double n = (double)in->points, least, greatest, held = 0.0, share = 1.0;
    extent(in, c, &least, &greatest);
    if (in->looks < LOOKS_BACK && greatest > least)
        held = (greatest - least) * (part_allowed(&in->options) / n) / c->unit;
    for (uint32_t k = 0; k < LOOKS_BACK && k < in->looks; ++k, share *= FADING)
        if (isfinite(c->past[k].half_width)) held = fmax(held, share * (c->past[k].points / n) * c->past[k].half_width);
    for (uint32_t k = LOOKS_BACK; k-- > 1;) c->past[k] = c->past[k - 1];
    c->past[0] = (past_look){n, *half_width};
    *half_width = fmax(*half_width, held);
}

void sf_integration_estimate(const integration *in, component *c, double *value, double *half_width) {
    if (!in->independent || !sf_integration_range_is_known(in)) {
        estimate(in, c, value, half_width);
        if (in->offset_in_common) hold_back(in, c, half_width);
        return;
    }
    double lower = sf_confidence_sequence_lower(&c->sequence), upper = sf_confidence_sequence_upper(&c->sequence);
    *value = 0.5 * lower + 0.5 * upper;
    *half_width = 0.5 * upper - 0.5 * lower;
}

/* ---- whether to trust them ---- */

/* The most extreme sample of a replicate as a part of its mean, both from the mean of all. */
static double extreme_part(const tally *t, double centre) {
    double up = t->greatest - centre, down = t->least - centre;
    return (up > -down ? up : down) / (double)t->moments.count;
}

/* Whether the means of the replicates follow the most extreme sample of each: a heavy tail, or an
 * event that is seen less than about once in each. Correlation is not enough: a shift moves mean and
 * extreme of a smooth function alike. Of a tail the means are made of those samples: without them
 * the means differ less. And these samples lie far out, if they are a tail. */
static int follows_extremes(const integration *in, const component *c) {
    sf_moments all = all_samples(in, c);
    double R = (double)in->options.replicates, dof = R - 2.0, sum[2] = {0.0, 0.0}, m2[3] = {0.0, 0.0, 0.0};
    double farthest = 0.0;
    for (uint32_t r = 0; r < in->options.replicates; ++r) {
        double extreme = extreme_part(&c->tallies[r], all.mean);
        sum[0] += (c->tallies[r].moments.mean - all.mean) / R;
        sum[1] += extreme / R;
        farthest = fmax(farthest, fabs(extreme) * (double)c->tallies[r].moments.count);
    }
    if (!(farthest > FAR * sf_moments_sample_deviation(&all))) return 0;
    for (uint32_t r = 0; r < in->options.replicates; ++r) {
        double mean = c->tallies[r].moments.mean - all.mean - sum[0];
        double extreme = extreme_part(&c->tallies[r], all.mean) - sum[1];
        m2[0] += mean * mean;
        m2[1] += extreme * extreme;
        m2[2] += mean * extreme;
    }
    double r = m2[2] / sqrt(m2[0] * m2[1]), without = m2[0] + m2[1] - 2.0 * m2[2];
    if (dof < 1.0 || !(r > 0.0) || !(without < (1.0 - HEAVY_SHARE) * m2[0])) return 0;
    /* The test of a correlation: r sqrt(dof / (1 - r^2)) is Student's t where there is none. */
    double t = sf_student_t_quantile(HEAVY_CONFIDENCE, dof);
    return r * r * dof > t * t * (1.0 - r * r);
}

/* Hill's estimator (1975) of the tail's index from the k largest deviations: 1/2 is that of a
 * density that falls as x^-3, whose variance is infinite. */
static double tail_index(const double *largest, size_t k) {
    double sum = 0.0;
    for (size_t i = 0; i < k; ++i) sum += log(largest[i] / largest[k - 1]);
    return sum / (double)(k - 1);
}

/* Whether the samples far from the mean are spread as those of a law without a variance: the
 * sqrt(N) most extreme, and among these the first 16, which of a bounded peak that is resolved are
 * near one another. */
static int has_heavy_tail(const integration *in, const component *c) {
    sf_moments all = all_samples(in, c);
    double largest[4 * INTEGRATION_TAIL];
    size_t count = 0, k = (size_t)fmin((double)INTEGRATION_TAIL, sqrt((double)all.count));
    for (size_t i = 0; i < c->up.count; ++i)
        if (c->up.value[i] > all.mean) largest[count++] = c->up.value[i] - all.mean;
    for (size_t i = 0; i < c->down.count; ++i)
        if (-c->down.value[i] < all.mean) largest[count++] = all.mean + c->down.value[i];
    qsort(largest, count, sizeof *largest, is_below);
    if (k < 2 * TOP || count < k) return 0;
    return tail_index(largest, k) > HEAVY_INDEX && tail_index(largest, TOP) > TOP_INDEX;
}

int sf_integration_is_suspicious(const integration *in, const component *c) {
    double least, greatest;
    extent(in, c, &least, &greatest);
    if (c->result->nonfinite > 0) return 1;
    /* The range, or a confidence sequence over it, allows for what no sample has seen. */
    int bounded = sf_integration_range_is_known(in);
    if (!bounded && least == 0.0 && greatest == 0.0) return 1; /* of what may hide there no scale is known */
    if (in->independent && bounded) return 0;
    return follows_extremes(in, c) || has_heavy_tail(in, c);
}
