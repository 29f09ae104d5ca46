// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a render has come to between two moments, as a file (docs/checkpoint.md). */
#ifndef SUNFLECK_CHECKPOINT_H
#define SUNFLECK_CHECKPOINT_H

#include <stdbool.h>

#include "sunfleck/film.h"

struct sf_relmse_target_note;

/* Where the rounds are. */
typedef struct sf_round_state {
    uint32_t from, to;    /* active pixels are on their way from `from` to `to` samples; equal: between rounds */
    uint32_t look;        /* where the lap ends */
    uint32_t in_lap;      /* 1 where it has not ended */
    uint32_t rounds;      /* finished */
    uint32_t level_fixed; /* 0 or 1 */
    double level, tolerance;
    double target;   /* of a budget */
    double seconds;  /* of all calls so far */
    uint32_t second; /* 1 where the pilot is over and the second set is taken */
    uint64_t traced_samples;
} sf_round_state;

typedef struct sf_checkpoint {
    sf_film *film;                       /* its accumulators, and the options and scene that it is of */
    uint64_t *open;                      /* by cell: pixels that are not done */
    uint64_t *active;                    /* of these, the lap's */
    struct sf_relmse_target_note *notes; /* by pixel; NULL without a goal of the whole picture */
    sf_round_state state;
} sf_checkpoint;

/* Writes the file, beside and renamed. SF_STATUS_IO leaves the old one. */
sf_status sf_checkpoint_save(const sf_checkpoint *checkpoint, const char *path, sf_error *error);

typedef enum sf_resume {
    SF_RESUME_NONE,    /* there is no file; one can be written */
    SF_RESUME_SAME,    /* state, accumulators and active pixels are the file's */
    SF_RESUME_EXTENDED /* likewise, but more is asked for than the file was made with */
} sf_resume;

/* Fills film, active and state from the file, where there is one, after comparing it with the
 * film's options and scene: SF_STATUS_INVALID_VALUE names every difference. */
sf_status sf_checkpoint_restore(sf_checkpoint *checkpoint, const char *path, sf_resume *resume, sf_error *error);

#endif
