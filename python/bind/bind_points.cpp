// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/string.h>

#include <nanobind/stl/pair.h>
#include <string>
#include <utility>

#include "bind.h"
#include "sunfleck/points.h"

namespace {

sf_pattern find_pattern(const std::string &name) {
    sf_pattern pattern;
    sf_error error;
    raise_unless_ok(sf_pattern_find(name.c_str(), &pattern, &error), error);
    return pattern;
}

sf_scramble find_scramble(const std::string &name) {
    sf_scramble scramble;
    sf_error error;
    raise_unless_ok(sf_scramble_find(name.c_str(), &scramble, &error), error);
    return scramble;
}

// The process's filler, never destroyed: its threads sleep until the process ends, and a forked child goes on with it.
sf_point_filler *shared_filler() {
    static sf_point_filler *const filler = [] {
        sf_point_filler *made = nullptr;
        sf_error error;
        raise_unless_ok(sf_point_filler_create(&made, &error), error);
        return made;
    }();
    return filler;
}

template <class T>
using fill_function = sf_status (*)(sf_point_filler *, const sf_points_options *, size_t, T *, const sf_interrupt *,
                                    sf_error *);

template <class T, fill_function<T> Fill>
void fill(nb::ndarray<T, nb::ndim<2>, nb::c_contig, nb::device::cpu> out, const std::string &pattern,
          const std::string &scramble, uint32_t dims, uint32_t pad, uint64_t seed, uint64_t first, uint64_t total,
          uint32_t threads) {
    sf_points_options options = sf_points_options_default();
    options.pattern = find_pattern(pattern);
    options.scramble = find_scramble(scramble);
    options.dims = dims;
    options.pad = pad;
    options.seed = seed;
    options.first = first;
    options.total = total;
    options.threads = threads;
    if (out.shape(1) != dims) throw nb::value_error("out must have a column for each dimension");
    sf_point_filler *filler = shared_filler();
    call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
        return Fill(filler, &options, out.shape(0), out.data(), interrupt, error);
    });
}

}  // namespace

void bind_points(nb::module_ &m) {
    m.def("patterns", [] { return listed(sf_pattern_name, sf_pattern_description); });

    m.def("scrambles", [] { return listed(sf_scramble_name, sf_scramble_description); });

    m.def("fill_points", &fill<float, sf_point_filler_fill_f32>, "out"_a.noconvert(), "pattern"_a, "scramble"_a,
          "dims"_a, "pad"_a, "seed"_a, "first"_a, "total"_a, "threads"_a);
    m.def("fill_points", &fill<double, sf_point_filler_fill_f64>, "out"_a.noconvert(), "pattern"_a, "scramble"_a,
          "dims"_a, "pad"_a, "seed"_a, "first"_a, "total"_a, "threads"_a);
    m.def("fill_points", &fill<uint32_t, sf_point_filler_fill_u32>, "out"_a.noconvert(), "pattern"_a, "scramble"_a,
          "dims"_a, "pad"_a, "seed"_a, "first"_a, "total"_a, "threads"_a);

    m.def(
        "valid_counts",
        [](const std::string &pattern, uint32_t dims, uint64_t n) {
            std::pair<uint64_t, uint64_t> counts;
            sf_pattern found = find_pattern(pattern);
            call([&](sf_error *error) {
                return sf_pattern_valid_counts(found, dims, n, &counts.first, &counts.second, error);
            });
            return counts;
        },
        "pattern"_a, "dims"_a, "n"_a);

    m.def(
        "pattern_random_scramble",
        [](const std::string &name) { return sf_scramble_name(sf_pattern_random_scramble(find_pattern(name))); },
        "pattern"_a);

    m.def(
        "pattern_is_random", [](const std::string &name) { return sf_pattern_is_random(find_pattern(name)) != 0; },
        "pattern"_a);

    m.def(
        "pattern_needs_total", [](const std::string &name) { return sf_pattern_needs_total(find_pattern(name)) != 0; },
        "pattern"_a);
}
