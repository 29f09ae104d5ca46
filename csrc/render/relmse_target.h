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

#include "render/lap.h"
#include "sunfleck/film.h"

struct sf_rounds;
typedef struct sf_relmse_target sf_relmse_target;

/* What a pixel had come to when it was looked at last. */
typedef struct sf_relmse_target_note {
    float error;  /* its part in relMSE */
    float around; /* the mean of those around, which its gain is told from */
    uint32_t taken;
} sf_relmse_target_note;

/* Makes the target that the options ask for; NULL where they ask for none. For a film of these options. */
sf_status sf_relmse_target_create(const sf_render_options *options, const sf_film *film, sf_relmse_target **goal,
                                  sf_error *error);
void sf_relmse_target_destroy(sf_relmse_target *goal);

/* Notes what pixel (x, y) of the film has come to. Threads may note pixels that are not the same. */
void sf_relmse_target_take_note(sf_relmse_target *goal, const sf_film *film, uint32_t x, uint32_t y);

/* The notes, by pixel of the film; NULL where there is no goal. */
sf_relmse_target_note *sf_relmse_target_notes(sf_relmse_target *goal);

/* Selects the next lap among the open pixels: fills `active` with its pixels, by cell of the film. No lap begins
 * where the goal is reached, or where no pixel may have more samples. */
sf_lap sf_relmse_target_select(sf_relmse_target *goal, const struct sf_rounds *r, uint64_t *active);

/* As of the last call of the above: whether the goal is reached, the picture's relMSE, and how many pixels were
 * wanted more samples of. */
bool sf_relmse_target_is_reached(const sf_relmse_target *goal);
double sf_relmse_target_estimate(const sf_relmse_target *goal);
uint64_t sf_relmse_target_beyond(const sf_relmse_target *goal);

#endif
