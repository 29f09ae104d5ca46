// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "interrupt.h"

#include <nanobind/nanobind.h>

#include "away.h"

namespace nb = nanobind;

int signal_watch::ask(void *self) noexcept {
    if (interpreter_is_leaving()) return 1;  // what is missing nobody will see
    nb::gil_scoped_acquire acquired;
    try {
        if (PyErr_CheckSignals()) throw nb::python_error();
        return 0;
    } catch (...) {
        static_cast<signal_watch *>(self)->raised = std::current_exception();
    }
    return 1;
}
