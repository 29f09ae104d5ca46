// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the table of a render's options says of one option's value. */
#ifndef SUNFLECK_OPTION_TABLE_H
#define SUNFLECK_OPTION_TABLE_H

#include "sunfleck/film.h"

#define SF_OPTION_TEXT_SIZE 96

/* Sets every option of the table to its default. */
void sf_options_set_defaults(sf_render_options *options);

/* Refuses the first option, in the order of the table, that is outside its range or is no name's value. */
sf_status sf_options_check_ranges(const sf_render_options *options, sf_error *error);

/* Writes the value as the film's metadata have it: numbers that read back as the same, names, "true", "false". */
void sf_option_print(const sf_option *option, const sf_render_options *options, char text[SF_OPTION_TEXT_SIZE]);

/* The bytes of its field in the options. */
size_t sf_option_size(const sf_option *option);

/* The value of a number or flag. */
double sf_option_number(const sf_option *option, const sf_render_options *options);

/* The value of an enumeration. */
int sf_option_choice(const sf_option *option, const sf_render_options *options);

#endif
