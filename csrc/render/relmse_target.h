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
#ifndef SUNFLECK_GOAL_H
#define SUNFLECK_GOAL_H

#include "film/film_internal.h"

struct sf_rounds;
typedef struct sf_goal sf_goal;

/* What a pixel had come to when it was looked at last. */
typedef struct sf_goal_note {
    float error;  /* its part in relMSE */
    float around; /* the mean of those around, which its gain is told from */
    uint32_t taken;
} sf_goal_note;

/* Sets r->goal, where the options have one. */
sf_status sf_goal_prepare(struct sf_rounds *r, sf_error *error);
void sf_goal_destroy(sf_goal *goal);

/* Notes what pixel (x, y) of the film has come to. */
void sf_goal_take_note(struct sf_rounds *r, uint32_t x, uint32_t y);

/* The notes, by pixel of the film; NULL where there is no goal. */
sf_goal_note *sf_goal_notes(sf_goal *goal);

/* Chooses the pixels of the next lap, and where it begins and looks: r->active,
 * r->from, r->look. False: the goal is
 * reached, or no pixel may have more samples. */
bool sf_goal_choose(struct sf_rounds *r);

/* Whether it is reached, as of the last call of the above. */
bool sf_goal_is_reached(const sf_goal *goal);

#endif
