// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Refusals: a status, and a message that says why. */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

sf_status sf_fail(sf_error *error, sf_status status, const char *format, ...) {
    if (!error) return status;
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    return status;
}

sf_status sf_fail_memory(sf_error *error, const char *what, size_t bytes) {
    return sf_fail(error, SF_STATUS_OUT_OF_MEMORY, "out of memory: %zu bytes for %s", bytes, what);
}
