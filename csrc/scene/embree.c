// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Embree's errors as the library's own. */

#include "scene/embree.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/error.h"

sf_status sf_fail_embree(sf_error *error, int code, const char *format, ...) {
    char what[128];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    if (code == RTC_ERROR_OUT_OF_MEMORY)
        return sf_fail(error, SF_STATUS_OUT_OF_MEMORY, "out of memory: Embree %s", what);
    return sf_fail(error, SF_STATUS_BACKEND, "Embree %s (its error %d)", what, code);
}
