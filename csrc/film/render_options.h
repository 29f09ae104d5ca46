// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_RENDER_OPTIONS_H
#define SUNFLECK_RENDER_OPTIONS_H

#include <stdbool.h>

#include "sunfleck/film.h"

/* Checks every option, and fills in those left open: crop, threads, the tolerance of 0.01. */
sf_status sf_render_options_complete(sf_render_options *options, sf_error *error);

#endif
