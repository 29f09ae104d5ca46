// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "bind.h"
#include "sunfleck/estimate.h"

namespace {

using moments = shared<sf_moments>;
using vector_moments = shared<sf_vector_moments>;

template <class T, void (*Add)(sf_moments *, size_t, const T *)>
void add(moments &m, flat_array<const T> x) {
    m.use([&](sf_moments *now, sf_error *) {
        Add(now, x.size(), x.data());
        return SF_STATUS_OK;
    });
}

template <class T, void (*Add)(sf_vector_moments *, size_t, const T *)>
void add_rows(vector_moments &m, rows_of_three<T> x) {
    m.use([&](sf_vector_moments *now, sf_error *) {
        Add(now, x.shape(0), x.data());
        return SF_STATUS_OK;
    });
}

// Copies the other first, so that no two locks are held at once.
template <class T, void (*Merge)(T *, const T *)>
void merge(shared<T> &m, shared<T> &other) {
    T theirs = other.copy();
    m.use([&](T *now, sf_error *) {
        Merge(now, &theirs);
        return SF_STATUS_OK;
    });
}

template <class T, double (*Value)(const T *)>
double value_of(shared<T> &m) {
    T now = m.copy();
    return Value(&now);
}

// What both kinds have in common.
template <class T>
nb::class_<shared<T>> bind_kind(nb::module_ &m, const char *name) {
    return nb::class_<shared<T>>(m, name)
        .def("__init__", [](shared<T> *self) { new (self) shared<T>(T{}); })
        .def_prop_ro("count", [](shared<T> &s) { return s.copy().count; })
        .def_prop_ro("nonfinite", [](shared<T> &s) { return s.copy().nonfinite; });
}

}  // namespace

void bind_estimate(nb::module_ &m) {
    bind_kind<sf_moments>(m, "Moments")
        .def("add", &add<float, sf_moments_add_f32>, "x"_a.noconvert())
        .def("add", &add<double, sf_moments_add_f64>, "x"_a.noconvert())
        .def("merge", &merge<sf_moments, sf_moments_merge>, "other"_a)
        .def_prop_ro("mean", &value_of<sf_moments, sf_moments_mean>)
        .def_prop_ro("variance", &value_of<sf_moments, sf_moments_variance>)
        .def_prop_ro("sample_deviation", &value_of<sf_moments, sf_moments_sample_deviation>)
        .def_prop_ro("standard_error", &value_of<sf_moments, sf_moments_standard_error>)
        .def(
            "half_width",
            [](moments &self, double confidence) {
                sf_moments now = self.copy();
                return sf_moments_half_width(&now, confidence);
            },
            "confidence"_a)
        .def("state",
             [](moments &self) -> nb::typed<nb::tuple, uint64_t, double, double, uint64_t> {
                 sf_moments now = self.copy();
                 return nb::make_tuple(now.count, now.mean, now.m2, now.nonfinite);
             })
        .def(
            "set_state",
            [](moments &self, uint64_t count, double mean, double m2, uint64_t nonfinite) {
                self.use([&](sf_moments *now, sf_error *) {
                    *now = sf_moments{count, mean, m2, nonfinite};
                    return SF_STATUS_OK;
                });
            },
            "count"_a, "mean"_a, "m2"_a, "nonfinite"_a);

    bind_kind<sf_vector_moments>(m, "VectorMoments")
        .def("add", &add_rows<float, sf_vector_moments_add_f32>, "x"_a.noconvert())
        .def("add", &add_rows<double, sf_vector_moments_add_f64>, "x"_a.noconvert())
        .def("merge", &merge<sf_vector_moments, sf_vector_moments_merge>, "other"_a)
        .def_prop_ro("mean",
                     [](vector_moments &self) {
                         sf_vector_moments now = self.copy();
                         double none = now.count ? 0.0 : static_cast<double>(NAN);
                         return vector3{now.mean[0] + none, now.mean[1] + none, now.mean[2] + none};
                     })
        .def_prop_ro("variance", &value_of<sf_vector_moments, sf_vector_moments_variance>)
        .def_prop_ro("sample_deviation", &value_of<sf_vector_moments, sf_vector_moments_sample_deviation>)
        .def_prop_ro("standard_error", &value_of<sf_vector_moments, sf_vector_moments_standard_error>)
        .def("state",
             [](vector_moments &self) -> nb::typed<nb::tuple, uint64_t, vector3, double, uint64_t> {
                 sf_vector_moments now = self.copy();
                 return nb::make_tuple(now.count, vector3{now.mean[0], now.mean[1], now.mean[2]}, now.m2,
                                       now.nonfinite);
             })
        .def(
            "set_state",
            [](vector_moments &self, uint64_t count, const vector3 &mean, double m2, uint64_t nonfinite) {
                self.use([&](sf_vector_moments *now, sf_error *) {
                    *now = sf_vector_moments{count, {mean[0], mean[1], mean[2]}, m2, nonfinite};
                    return SF_STATUS_OK;
                });
            },
            "count"_a, "mean"_a, "m2"_a, "nonfinite"_a);
}
