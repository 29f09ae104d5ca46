// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The fields of a checkpoint beside its options, and what each may hold. */
#ifndef SUNFLECK_CHECKPOINT_FIELDS_H
#define SUNFLECK_CHECKPOINT_FIELDS_H

#include "base/container.h"
#include "render/checkpoint.h"

size_t sf_checkpoint_field_count(void);

/* Describes where field `i` is in memory, to write it or to read it; false where this render has none. */
bool sf_checkpoint_field(const sf_checkpoint *checkpoint, size_t i, sf_array *array);

/* Refuses, with SF_STATUS_IO, what was read where a field holds a value outside its range, or where the
 * fields contradict one another so that a render that goes on would not end. `layout` has, by cell,
 * the pixels that there are. */
sf_status sf_checkpoint_check(const sf_checkpoint *checkpoint, const uint64_t *layout, const char *path,
                              sf_error *error);

/* Likewise the mask of a film that is loaded; counts its pixels. */
sf_status sf_checkpoint_check_mask(sf_film *film, const char *path, sf_error *error);

#endif
