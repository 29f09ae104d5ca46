// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Which pixels the next lap brings on. */
#ifndef SUNFLECK_PIXEL_SELECTION_H
#define SUNFLECK_PIXEL_SELECTION_H

#include "render/lap.h"

struct sf_rounds;

/* Selects the next lap among the open pixels: fills `active` with its pixels, by cell of the film, and returns
 * where it begins and looks. Between laps only; of the rounds nothing changes but what progress reports. */
sf_lap sf_select_lap(const struct sf_rounds *r, uint64_t *active);

#endif
