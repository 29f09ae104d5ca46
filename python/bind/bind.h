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
#include <string>
#include <vector>

#include "away.h"
#include "interrupt.h"
#include "sunfleck/base.h"
#include "turn.h"

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
        away from_python;
        status = function(&error);
    }
    raise_unless_ok(status, error);
}

// The same for what may run long: function(const sf_interrupt *, sf_error *). What Python's signal handlers raise
// meanwhile (Ctrl-C) ends it and is raised.
template <class Function>
void call_interruptibly(Function &&function) {
    signal_watch watch;
    sf_error error;
    error.message[0] = '\0';
    sf_status status;
    {
        away from_python;
        status = function(&watch.interrupt, &error);
    }
    watch.raise_what_was_raised();
    raise_unless_ok(status, error);
}

// What pieces of work have at the least: rows that cost next to nothing each, or single values that cost still less.
constexpr size_t rows_of_a_piece = size_t(1) << 16, values_of_a_piece = size_t(1) << 18;

// call_interruptibly of in_checked_pieces: work(first, rows, error), over rows that cost next to nothing each.
template <class Work>
void call_in_checked_pieces(size_t rows, Work &&work) {
    call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
        return in_checked_pieces(rows, rows_of_a_piece, interrupt, error, work);
    });
}

// A C struct that threads share, and the lock by which they take turns. No thread waits for the lock while it has the
// GIL, so that neither can wait for the other. A fork waits until no struct is half changed.
template <class T>
struct shared {
    T value;
    turn_lock turn;

    explicit shared(const T &initial) : value(initial) {}

    // Calls function(&value, error), which may refuse.
    template <class Function>
    void use(Function &&function) {
        call([&](sf_error *error) {
            std::lock_guard<turn_lock> lock(turn);
            whole_for_forks whole;
            return function(&value, error);
        });
    }

    // Calls function(&value, first, count) for pieces of `total`; the struct is as before where Ctrl-C ended it.
    template <class Function>
    void use_in_pieces(size_t total, size_t smallest, Function &&function) {
        call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
            std::lock_guard<turn_lock> lock(turn);
            auto work = [&](size_t first, size_t count, sf_error *) {
                whole_for_forks whole;
                function(&value, first, count);
                return SF_STATUS_OK;
            };
            if (total <= smallest) return work(0, total, error);
            const T before = value;
            sf_status status = in_pieces(total, smallest, interrupt, error, work);
            if (status == SF_STATUS_OK) return status;
            whole_for_forks whole;
            value = before;
            return status;
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

// The value of an enumeration whose name is `name`, among those that name_of lists until it has no further; those that
// `allowed` is false of are found too, for C to refuse, but not offered.
template <class NameOf, class Allowed>
int find_name(const char *what, const std::string &name, NameOf &&name_of, Allowed &&allowed) {
    std::vector<std::string> offered;
    for (int k = 0; const char *known = name_of(k); ++k) {
        if (sf_name_matches(name.c_str(), known)) return k;
        if (allowed(k)) offered.emplace_back(known);
    }
    std::string message = std::string(what) + " is '" + name + "'; choose one of ";
    for (size_t k = 0; k < offered.size(); ++k) message += (k ? ", " : "") + offered[k];
    throw nb::value_error(message.c_str());
}
template <class NameOf>
int find_name(const char *what, const std::string &name, NameOf &&name_of) {
    return find_name(what, name, name_of, [](int) { return true; });
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
