// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/string.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "bind.h"
#include "sunfleck/integrate.h"

namespace {

// The function of Python's, called from C on the thread that asked for the integral.
struct integrand {
    nb::object function;
    size_t components;
    std::exception_ptr failure;

    // The points are a copy of their own, since Python may keep them.
    void evaluate(size_t count, uint32_t dims, const double *points, double *values) {
        if (PyErr_CheckSignals()) throw nb::python_error();
        auto copy = std::make_unique<double[]>(count * dims);
        std::copy(points, points + count * dims, copy.get());
        nb::capsule owner(copy.get(), [](void *p) noexcept { delete[] static_cast<double *>(p); });
        nb::ndarray<nb::numpy, double, nb::ndim<2>> block(copy.release(), {count, dims}, owner);
        auto answer =
            nb::cast<nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>>(function(block), false);
        count *= components;
        if (answer.shape(0) != count) throw nb::value_error("the function's values must be as many as the points");
        std::copy(answer.data(), answer.data() + count, values);
    }

    // Calls what may raise and tells C whether to stop. Ctrl-C stops and is spent: what is known so far is the
    // answer to it.
    template <class Function>
    int stops(Function &&function) noexcept {
        if (interpreter_is_leaving()) return 1;
        nb::gil_scoped_acquire acquired;
        try {
            function();
            return 0;
        } catch (nb::python_error &error) {
            if (!error.matches(PyExc_KeyboardInterrupt)) failure = std::current_exception();
        } catch (...) {
            failure = std::current_exception();
        }
        return 1;
    }
};

int call_integrand(void *user, size_t count, uint32_t dims, const double *points, double *values) {
    integrand *self = static_cast<integrand *>(user);
    return self->stops([&] { self->evaluate(count, dims, points, values); });
}

int ask(void *user) {
    return static_cast<integrand *>(user)->stops([] {
        if (PyErr_CheckSignals()) throw nb::python_error();
    });
}

nb::typed<nb::dict, nb::str, nb::any> as_dict(const sf_integral &result) {
    nb::list history;
    for (uint32_t k = 0; k < result.looks; ++k)
        history.append(
            nb::make_tuple(result.history[k].samples, result.history[k].value, result.history[k].half_width));
    nb::dict d;
    d["value"] = result.value;
    d["half_width"] = result.half_width;
    d["samples"] = result.samples;
    d["nonfinite"] = result.nonfinite;
    d["stop_reason"] = sf_integral_stop_name(result.stop);
    d["replicates"] = result.replicates;
    d["shifted"] = result.shifted != 0;
    d["folded"] = result.folded != 0;
    d["history"] = history;
    return d;
}

using ends = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// A dict for each component. Of no ends, the region is the unit cube.
nb::typed<nb::list, nb::typed<nb::dict, nb::str, nb::any>> integrate(
    nb::object function, uint32_t components, const std::string &pattern, const std::string &scramble, uint32_t dims,
    uint64_t seed, double absolute, double relative, double confidence, uint64_t min_samples, uint64_t max_samples,
    uint32_t replicates, double low, double high, uint32_t threads, const ends &lower, const ends &upper) {
    sf_integrate_options options = sf_integrate_options_default();
    sf_error error;
    raise_unless_ok(sf_pattern_find(pattern.c_str(), &options.pattern, &error), error);
    raise_unless_ok(sf_scramble_find(scramble.c_str(), &options.scramble, &error), error);
    options.dims = dims;
    options.seed = seed;
    options.absolute = absolute;
    options.relative = relative;
    options.confidence = confidence;
    options.min_samples = min_samples;
    options.max_samples = max_samples;
    options.replicates = replicates;
    options.low = low;
    options.high = high;
    options.threads = threads;
    if (lower.shape(0) != upper.shape(0) || (lower.shape(0) != 0 && lower.shape(0) != dims))
        throw nb::value_error("the bounds must be as many as the dimensions");
    if (lower.shape(0) != 0) {
        options.lower = lower.data();
        options.upper = upper.data();
    }
    integrand user{function, components, nullptr};
    const sf_interrupt interrupt{ask, &user};
    options.interrupt = &interrupt;
    std::vector<sf_integral> results(components);
    call([&](sf_error *refused) {
        return sf_integrate_vector(call_integrand, &user, &options, components, results.data(), refused);
    });
    if (user.failure) std::rethrow_exception(user.failure);
    nb::list found;
    for (const sf_integral &result : results) found.append(as_dict(result));
    return found;
}

}  // namespace

void bind_integrate(nb::module_ &m) {
    m.def("integrate", &integrate, "function"_a, "components"_a, "pattern"_a, "scramble"_a, "dims"_a, "seed"_a,
          "absolute"_a, "relative"_a, "confidence"_a, "min_samples"_a, "max_samples"_a, "replicates"_a, "low"_a,
          "high"_a, "threads"_a, "lower"_a, "upper"_a);
}
