// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the bindings share: one function for each module, and the way from sf_status to Python's
 * exceptions. A binding checks kinds and shapes, releases the GIL, and calls C; ranges are C's.
 */
#ifndef SUNFLECK_BIND_H
#define SUNFLECK_BIND_H

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>

#include <array>
#include <mutex>

#include "sunfleck/base.h"

namespace nb = nanobind;
using namespace nb::literals;

using vector3 = std::array<double, 3>;

// Arrays that C reads or fills in place: any number of axes, C order, no conversion.
template <class T>
using flat_array = nb::ndarray<T, nb::c_contig, nb::device::cpu>;

// An (n, 3) array that C reads in place.
template <class T>
using rows_of_three = nb::ndarray<const T, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

inline void to_floats(const vector3 &from, float *to) {
    for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(from[c]);
}

// Raises what the status stands for; SF_STATUS_OK raises nothing. Needs the GIL.
void raise_unless_ok(sf_status status, const sf_error &error);

// Calls C without the GIL and raises what it refused. The function gets an sf_error to fill.
template <class Function>
void call(Function &&function) {
    sf_error error;
    error.message[0] = '\0';
    sf_status status;
    {
        nb::gil_scoped_release released;
        status = function(&error);
    }
    raise_unless_ok(status, error);
}

// A C struct that threads share, and the lock by which they take turns. The lock is only ever
// taken without the GIL, so that neither can wait for the other.
template <class T, class Mutex = std::mutex>
struct shared {
    T value;
    Mutex turn;

    explicit shared(const T &initial) : value(initial) {}

    // Calls function(&value, error), which may refuse.
    template <class Function>
    void use(Function &&function) {
        call([&](sf_error *error) {
            std::lock_guard<Mutex> lock(turn);
            return function(&value, error);
        });
    }

    T copy() {
        T now;
        use([&](T *v, sf_error *) {
            now = *v;
            return SF_STATUS_OK;
        });
        return now;
    }
};

// Names and descriptions, listed until C has no further name.
template <class Enum>
nb::typed<nb::dict, nb::str, nb::str> listed(const char *(*name)(Enum), const char *(*description)(Enum)) {
    nb::dict all;
    for (int k = 0; name(static_cast<Enum>(k)); ++k)
        all[name(static_cast<Enum>(k))] = description(static_cast<Enum>(k));
    return all;
}

void bind_rng(nb::module_ &m);
void bind_points(nb::module_ &m);
void bind_mapping(nb::module_ &m);
void bind_discrete(nb::module_ &m);
void bind_estimate(nb::module_ &m);
void bind_integrate(nb::module_ &m);
void bind_uniformity(nb::module_ &m);
void bind_scene(nb::module_ &m);
void bind_render(nb::module_ &m);

#endif
