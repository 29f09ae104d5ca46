// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Pixel masks: which pixels of the frame a render traces. */
#ifndef SUNFLECK_MASK_H
#define SUNFLECK_MASK_H

#include <stdbool.h>

#include "sunfleck/film.h"

/* Refuses a mask that leaves no pixel of the crop, and a stride below the width; fills in the
 * stride. After the sizes and the crop were checked. */
sf_status sf_mask_complete(sf_render_options *options, sf_error *error);

/* Whether the mask leaves a pixel of the cell whose first pixel is (x, y) of the frame. Such a cell
 * is traced whole: Embree's answer to 1 shadow ray in 10^8 or so depends on its companions. */
bool sf_mask_touches_cell(const sf_render_options *options, uint32_t x, uint32_t y);

/* Copies the crop's part of the mask into the film, and counts its pixels. */
void sf_mask_apply(const sf_render_options *options, sf_film *film);

/* Counts the pixels of the film's mask. */
void sf_mask_count(sf_film *film);

/* Writes "none", or how many pixels of the crop the mask leaves and a hash of it. */
#define SF_MASK_TEXT_SIZE 64
void sf_mask_describe(const sf_film *film, char text[SF_MASK_TEXT_SIZE]);

#endif
