// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_ERROR_H
#define SUNFLECK_ERROR_H

#include "base/platform.h"
#include "sunfleck/base.h"

/* Writes status and message into `error` unless it is NULL, and returns the status, so that a
 * refusal is one line: return sf_fail(error, SF_STATUS_INVALID_VALUE, "spp is %u; …", spp); */
sf_status sf_fail(sf_error *error, sf_status status, const char *format, ...) SF_PRINTF(3, 4);

/* sf_fail for `what` bytes that could not be had. */
sf_status sf_fail_memory(sf_error *error, const char *what, size_t bytes);

#endif
