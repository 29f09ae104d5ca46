// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <cstring>

#include "bind.h"

namespace {

nb::object exception_of(sf_status status) {
    switch (status) {
        case SF_STATUS_INVALID_VALUE: return nb::borrow(PyExc_ValueError);
        case SF_STATUS_OUT_OF_MEMORY: return nb::borrow(PyExc_MemoryError);
        case SF_STATUS_IO: return nb::borrow(PyExc_OSError);
        case SF_STATUS_UNSUPPORTED: return nb::borrow(PyExc_NotImplementedError);
        case SF_STATUS_INTERRUPTED: return nb::borrow(PyExc_KeyboardInterrupt);
        case SF_STATUS_OK:
        case SF_STATUS_BACKEND: break;
    }
    return nb::module_::import_("sunfleck.error").attr("Error");
}

}  // namespace

void raise_unless_ok(sf_status status, const sf_error &error) {
    if (status == SF_STATUS_OK) return;
    // What a file held may be in the message, and may be no text.
    const char *said = error.message[0] ? error.message : sf_status_name(status);
    nb::object text = nb::steal(PyUnicode_DecodeUTF8(said, static_cast<Py_ssize_t>(std::strlen(said)), "replace"));
    if (text.is_valid()) PyErr_SetObject(exception_of(status).ptr(), text.ptr());
    throw nb::python_error();
}

NB_MODULE(_core, m) {
    // The GIL is taken and released by PyGILState, which knows the main interpreter alone: a call from another would
    // wait for ever.
    if (PyInterpreterState_Get() != PyInterpreterState_Main())
        throw nb::import_error(
            "sunfleck works in the main interpreter only, not in a sub-interpreter; "
            "use threads or processes");
    watch_forks();
    m.doc() = "The C library, as thin as it can be bound. Private: use the modules of sunfleck.";
    m.def("version", &sf_version);
    m.def("isa", [] { return sf_isa_name(sf_isa_active()); });
    watch_the_exit();
    bind_rng(m);
    bind_points(m);
    bind_mapping(m);
    bind_discrete(m);
    bind_estimate(m);
    bind_integrate(m);
    bind_uniformity(m);
    bind_scene(m);
    bind_render(m);
}
