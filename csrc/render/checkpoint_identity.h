// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a checkpoint is of: the options of a render, its scene, and what computed it. */
#ifndef SUNFLECK_CHECKPOINT_IDENTITY_H
#define SUNFLECK_CHECKPOINT_IDENTITY_H

#include <assert.h>
#include <string.h>

#include "base/container.h"
#include "render/checkpoint.h"

#define SF_CHECKPOINT_TEXT_SIZE 96
#define SF_CHECKPOINT_ARRAYS 112

typedef struct sf_array_list {
    sf_array arrays[SF_CHECKPOINT_ARRAYS];
    size_t count;
    char names[32][48]; /* those made for the list */
    size_t name_count;
} sf_array_list;

/* A copy of the name that lives as long as the list. */
static inline const char *sf_array_list_name(sf_array_list *list, const char name[48]) {
    assert(list->name_count < sizeof list->names / sizeof *list->names);
    return memcpy(list->names[list->name_count++], name, sizeof *list->names);
}

static inline void sf_array_list_add(sf_array_list *list, const char *name, sf_array_type type, uint32_t width,
                                     uint64_t rows, void *data, size_t stride) {
    list->arrays[list->count++] = (sf_array){name, type, width, rows, data, stride};
}

/* Lists what identifies the film's picture, for writing; its mask is among that. */
void sf_checkpoint_list_identity(sf_array_list *list, sf_film *film);
void sf_checkpoint_list_mask(sf_array_list *list, sf_film *film);

/* Read what the file has of that name. SF_STATUS_IO where it has none, or options that no render has. */
sf_status sf_checkpoint_take_text(const sf_container *file, const char *name, char text[SF_CHECKPOINT_TEXT_SIZE],
                                  sf_error *error);
sf_status sf_checkpoint_take_u64(const sf_container *file, const char *name, uint64_t *value, sf_error *error);
sf_status sf_checkpoint_take_u32(const sf_container *file, const char *name, uint32_t *value, sf_error *error);
sf_status sf_checkpoint_take_options(const sf_container *file, sf_render_options *options, sf_error *error);

/* Whether the film's render may go on from the file: SF_STATUS_INVALID_VALUE names every difference. Sets
 * `more` where more is asked for than the file has. Of the state only the level is read. */
sf_status sf_checkpoint_match(const sf_container *file, const sf_film *film, const sf_round_state *state, bool *more,
                              sf_error *error);

#endif
