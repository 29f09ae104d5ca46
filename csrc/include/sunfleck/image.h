// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* image: writes the channels of a film through OpenImageIO. An optional component of its own
 * library, sunfleck::image; sf_image_write exists only there.
 */
#ifndef SUNFLECK_IMAGE_H
#define SUNFLECK_IMAGE_H

#include "sunfleck/render.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the film to `path`, by its ending:
 *
 *   .exr  one part, float32, linear: R G B A, samples, half_width, stop_reason, and every
 *         attribute as "sunfleck:NAME"; samples up to 2^24 are exact
 *   .png  8 bits, R G B, sRGB-encoded, values beyond [0, 1] clipped; nothing else is kept
 *
 * The file is written beside and renamed, so that a failure leaves whatever was there.
 * Errors: SF_STATUS_INVALID_VALUE for another ending, SF_STATUS_IO with OpenImageIO's reason.
 * Thread-safe on distinct paths. */
SF_API sf_status sf_image_write(const sf_film *film, const char *path, sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
