// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Threads that are away from the interpreter, in C, while it may end.
 *
 * A daemon thread that asks for the GIL of an interpreter that is ending is unwound by Python, through frames of
 * C++ that may not be unwound, and the process aborts. So an exit handler first says that the interpreter is
 * leaving: callbacks then stop what runs, and threads stay away for good instead of coming back. It waits
 * until every thread has stayed away or come back, no longer than two seconds: a call that
 * cannot be stopped does not keep the process. Threads that are no daemons have been joined before. */
#ifndef SUNFLECK_AWAY_H
#define SUNFLECK_AWAY_H

#include <nanobind/nanobind.h>

// Gives up the GIL from its beginning to its end, as nb::gil_scoped_release does.
class away {
    PyThreadState *state;

   public:
    away();
    ~away();
    away(const away &) = delete;
    away &operator=(const away &) = delete;
};

// Whether a callback must not ask for the GIL any more, but stop its caller.
bool interpreter_is_leaving();

// Registers the exit handler.
void watch_the_exit();

#endif
