// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Names of patterns, generators, mappings and the like: one way to compare and to look them up. */
#include "base/name.h"

#include <stdio.h>

#include "base/error.h"

/* What a character stands for: small letters for capital ones, and one separator of words for all three. Of ASCII
 * alone, in which all names are; the C library's `tolower` depends on the locale. */
static int folded(char c) { return c == '-' || c == ' ' ? '_' : c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; }

int sf_name_matches(const char *name, const char *known) {
    if (!name || !known) return 0;
    while (*name && folded(*name) == folded(*known)) ++name, ++known;
    return *name == *known;
}

sf_status sf_name_find(const char *what, const char *name, const char *(*name_at)(unsigned), unsigned *index,
                       sf_error *error) {
    for (unsigned i = 0; name_at(i); ++i)
        if (sf_name_matches(name, name_at(i))) {
            *index = i;
            return SF_STATUS_OK;
        }
    char names[SF_ERROR_MESSAGE_SIZE] = "";
    size_t length = 0;
    for (unsigned i = 0; name_at(i) && length < sizeof names; ++i)
        length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", i ? ", " : "", name_at(i));
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s is \"%.64s\"; choose one of %s", what, name ? name : "", names);
}
