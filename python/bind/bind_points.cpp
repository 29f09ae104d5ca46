// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/string.h>

#include <nanobind/stl/pair.h>
#include <pthread.h>
#include <algorithm>
#include <atomic>
#include <memory>
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

// The process's team, made when threads are first asked for and never destroyed: its threads sleep
// until the process ends. After a fork they are the parent's, and the child makes a team anew.
sf_thread_team *shared_team() {
    static std::atomic<sf_thread_team *> team{nullptr};
    static const int forks = pthread_atfork(nullptr, nullptr, [] { team = nullptr; });
    sf_thread_team *now = team, *fresh;
    if (now || forks != 0 || sf_thread_team_create(&fresh, nullptr) != SF_STATUS_OK) return now;
    if (team.compare_exchange_strong(now, fresh)) return fresh;
    sf_thread_team_destroy(fresh);
    return now;
}

// A set with its tables, and the options that it was made for.
struct prepared {
    sf_points_options options;
    sf_point_set *set = nullptr;

    ~prepared() { sf_point_set_destroy(set); }

    bool serves(const sf_points_options &o) const {
        return options.pattern == o.pattern && options.scramble == o.scramble && options.dims == o.dims &&
               options.pad == o.pad && options.seed == o.seed && options.total == o.total &&
               options.threads == o.threads && options.team == o.team;
    }
};

// The set that the last call used is kept for the next, which often asks for the same: for a few
// dimensions its tables cost as much as 2^16 values. A call takes it out while it works, so that
// none waits for another; what has many dimensions, or a total to know ahead, is not kept.
std::atomic<prepared *> last_prepared{nullptr};

bool worth_keeping(const sf_points_options &options) {
    return options.dims <= 256 && !sf_pattern_needs_total(options.pattern);
}

template <class T>
using fill_function = sf_status (*)(const sf_point_set *, uint64_t, size_t, T *, sf_error *);

// As many rows as make a quarter of a million values, and whole blocks of the kernels: what Ctrl-C waits for at least.
size_t smallest_piece(uint32_t dims) { return std::max<size_t>(1024, (size_t(1) << 18) / std::max<uint32_t>(dims, 1)); }

template <class T, fill_function<T> FillFrom>
sf_status fill_in_pieces(const prepared &ours, uint64_t first, size_t count, T *out, sf_error *error) {
    size_t dims = ours.options.dims;
    return in_pieces(count, smallest_piece(ours.options.dims), [&](size_t done, size_t rows) {
        return FillFrom(ours.set, first + done, rows, out + done * dims, error);
    });
}

template <class T, sf_status (*Fill)(const sf_points_options *, size_t, T *, sf_error *), fill_function<T> FillFrom>
sf_status fill_with_kept(sf_points_options options, size_t count, T *out, sf_error *error) {
    bool keep = worth_keeping(options);
    // As sf_points_fill does: a set that needs its total is whole unless told otherwise.
    if (!keep && options.total == 0 && options.first <= UINT64_MAX - count) options.total = options.first + count;
    if (!keep && count <= smallest_piece(options.dims)) return Fill(&options, count, out, error);
    std::unique_ptr<prepared> ours{keep ? last_prepared.exchange(nullptr) : nullptr};
    if (!ours || !ours->serves(options)) {
        ours = std::make_unique<prepared>();
        ours->options = options;
        sf_status status = sf_point_set_create(&options, &ours->set, error);
        if (status != SF_STATUS_OK) return status;
    }
    sf_status status = fill_in_pieces<T, FillFrom>(*ours, options.first, count, out, error);
    if (keep) delete last_prepared.exchange(ours.release());
    return status;
}

template <class T, sf_status (*Fill)(const sf_points_options *, size_t, T *, sf_error *), fill_function<T> FillFrom>
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
    options.team = threads == 1 ? nullptr : shared_team();
    if (out.shape(1) != dims) throw nb::value_error("out must have a column for each dimension");
    call([&](sf_error *error) { return fill_with_kept<T, Fill, FillFrom>(options, out.shape(0), out.data(), error); });
}

}  // namespace

void bind_points(nb::module_ &m) {
    m.def("patterns", [] { return listed(sf_pattern_name, sf_pattern_description); });

    m.def("scrambles", [] { return listed(sf_scramble_name, sf_scramble_description); });

    m.def("fill_points", &fill<float, sf_points_fill_f32, sf_point_set_fill_f32>, "out"_a.noconvert(), "pattern"_a,
          "scramble"_a, "dims"_a, "pad"_a, "seed"_a, "first"_a, "total"_a, "threads"_a);
    m.def("fill_points", &fill<double, sf_points_fill_f64, sf_point_set_fill_f64>, "out"_a.noconvert(), "pattern"_a,
          "scramble"_a, "dims"_a, "pad"_a, "seed"_a, "first"_a, "total"_a, "threads"_a);
    m.def("fill_points", &fill<uint32_t, sf_points_fill_u32, sf_point_set_fill_u32>, "out"_a.noconvert(), "pattern"_a,
          "scramble"_a, "dims"_a, "pad"_a, "seed"_a, "first"_a, "total"_a, "threads"_a);

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
