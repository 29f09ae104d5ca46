// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A goal for the whole picture: that its relMSE, the mean over pixels and channels of
 * (x - r)^2 / (r^2 + 0.01) (Rousselle, Knaus & Zwicker 2011, "Adaptive Sampling and Reconstruction using
 * Greedy Error Minimization"), is at most so much, by the variances that the stopping rule tells.
 *
 * Least samples reach it where a sample more lowers the sum of errors by the same everywhere (Neyman
 * 1934): a pixel of n samples with error e, which falls by a factor d as they double, gains
 * e (1 - 1/d) / n by a sample. Pixels whose gain is at least a threshold are brought on, the least sampled
 * first; the threshold is the largest of which it is predicted that the pixels it brings on end at the
 * goal, and is set anew before every lap. No pixel is closed before the whole picture is.
 *
 * Sums are of integers, so that they do not depend on threads. */
#ifndef SUNFLECK_RELMSE_TARGET_H
#define SUNFLECK_RELMSE_TARGET_H

#include "film/film_internal.h"

struct sf_rounds;
typedef struct sf_relmse_target sf_relmse_target;

/* What a pixel had come to when it was looked at last. */
typedef struct sf_relmse_target_note {
    float error;  /* its part in relMSE */
    float around; /* the mean of those around, which its gain is told from */
    uint32_t taken;
} sf_relmse_target_note;

/* Sets r->goal, where the options have one. */
sf_status sf_relmse_target_prepare(struct sf_rounds *r, sf_error *error);
void sf_relmse_target_destroy(sf_relmse_target *goal);

/* Notes what pixel (x, y) of the film has come to. */
void sf_relmse_target_take_note(struct sf_rounds *r, uint32_t x, uint32_t y);

/* The notes, by pixel of the film; NULL where there is no goal. */
sf_relmse_target_note *sf_relmse_target_notes(sf_relmse_target *goal);

/* Chooses the pixels of the next lap, and where it begins and looks: r->active,
 * r->from, r->look. False: the goal is
 * reached, or no pixel may have more samples. */
bool sf_relmse_target_choose(struct sf_rounds *r);

/* Whether it is reached, as of the last call of the above. */
bool sf_relmse_target_is_reached(const sf_relmse_target *goal);

#endif
