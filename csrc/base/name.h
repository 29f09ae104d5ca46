// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Looking a name up among those that an enumeration has. Names are written with small letters and "_" between
 * words; in what a caller gives, capital letters are as small ones, and "-" and " " as "_". */
#ifndef SUNFLECK_NAME_H
#define SUNFLECK_NAME_H

#include "sunfleck/base.h"

/* Writes the index of `name` among those that `name_at` lists up to NULL, as sf_name_matches has it.
 * Refuses another, and NULL, by naming `what` and all there are. */
sf_status sf_name_find(const char *what, const char *name, const char *(*name_at)(int), int *index, sf_error *error);

#endif
