// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "sunfleck/uniformity.h"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <string>
#include <utility>

#include "bind.h"

namespace {

// Points as rows, read in place.
using rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

uint32_t dims_of(const rows &points) {
    if (points.shape(1) > UINT32_MAX) throw nb::value_error("points have more dimensions than 2^32 - 1");
    return static_cast<uint32_t>(points.shape(1));
}

sf_discrepancy_kind find_kind(const std::string &name) {
    sf_discrepancy_kind kind;
    sf_error error;
    raise_unless_ok(sf_discrepancy_kind_find(name.c_str(), &kind, &error), error);
    return kind;
}

}  // namespace

void bind_uniformity(nb::module_ &m) {
    m.def("discrepancies", [] { return listed(sf_discrepancy_kind_name, sf_discrepancy_kind_description); });

    m.def(
        "discrepancy",
        [](rows points, const std::string &kind, uint32_t threads) {
            double value = 0.0;
            sf_discrepancy_kind found = find_kind(kind);
            uint32_t dims = dims_of(points);
            call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
                return sf_discrepancy(found, points.data(), points.shape(0), dims, threads, &value, interrupt, error);
            });
            return value;
        },
        "points"_a.noconvert(), "kind"_a, "threads"_a);

    m.def(
        "star_discrepancy",
        [](rows points, uint64_t boxes) {
            std::pair<double, double> bounds;
            uint32_t dims = dims_of(points);
            call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
                return sf_star_discrepancy(points.data(), points.shape(0), dims, boxes, &bounds.first, &bounds.second,
                                           interrupt, error);
            });
            return bounds;
        },
        "points"_a.noconvert(), "boxes"_a);

    m.def(
        "t_value",
        [](rows points, uint32_t base, uint32_t effort, uint32_t threads) {
            uint32_t t = 0, dims = dims_of(points);
            call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
                return sf_net_t_value(points.data(), points.shape(0), dims, base, effort, threads, &t, interrupt,
                                      error);
            });
            return t;
        },
        "points"_a.noconvert(), "base"_a, "effort"_a, "threads"_a);

    m.def(
        "minimum_distance",
        [](rows points, bool toroidal, uint32_t threads) {
            double distance = 0.0;
            uint32_t dims = dims_of(points);
            call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
                return sf_minimum_distance(points.data(), points.shape(0), dims, toroidal, threads, &distance,
                                           interrupt, error);
            });
            return distance;
        },
        "points"_a.noconvert(), "toroidal"_a, "threads"_a);
}
