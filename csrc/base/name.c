// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Looks names of patterns, generators, mappings, options and the like up. */
#include "base/name.h"

#include <stdio.h>

#include "base/error.h"

sf_status sf_name_find(const char *what, const char *name, const char *(*name_at)(int), int *index, sf_error *error) {
    for (int i = 0; name_at(i); ++i)
        if (sf_name_matches(name, name_at(i))) {
            *index = i;
            return SF_STATUS_OK;
        }
    char names[SF_ERROR_MESSAGE_SIZE] = "";
    size_t length = 0;
    for (int i = 0; name_at(i) && length < sizeof names; ++i)
        length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", i ? ", " : "", name_at(i));
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s is \"%.64s\"; choose one of %s", what, name ? name : "", names);
}
