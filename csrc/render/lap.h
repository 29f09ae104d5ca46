// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A lap: rounds up to a count where the stopping rule looks. */
#ifndef SUNFLECK_LAP_H
#define SUNFLECK_LAP_H

#include <stdbool.h>
#include <stdint.h>

/* What a selection returns beside the lap's pixels. */
typedef struct sf_lap {
    bool begins;   /* false: nothing is left to bring on, and only the target is to be read */
    uint32_t from; /* where it begins: so many samples its pixels have */
    uint32_t look; /* where it looks, unless the render ends before */
    double target; /* of a budget, as far as it has fallen */
} sf_lap;

#endif
