// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/pair.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "bind.h"
#include "sunfleck/estimate.h"

namespace {

using moments = shared<sf_moments>;
using vector_moments = shared<sf_vector_moments>;

// Adds `count` items of `width` values: their moments are found apart and merged at the end, so that the state is
// as before where Ctrl-C ended it.
template <class State, class T, void (*Add)(sf_block_moments *, size_t, const T *),
          void (*Merge)(State *, const sf_block_moments *)>
void add_blocks(shared<State> &to, size_t count, size_t width, const T *x) {
    sf_block_moments blocks;
    sf_block_moments_begin(&blocks);
    call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
        return in_pieces(count, values_of_a_piece, interrupt, error, [&](size_t first, size_t rows, sf_error *) {
            Add(&blocks, rows, x + first * width);
            return SF_STATUS_OK;
        });
    });
    to.use([&](State *now, sf_error *) {
        Merge(now, &blocks);
        return SF_STATUS_OK;
    });
}

template <class T, void (*Add)(sf_block_moments *, size_t, const T *)>
void add(moments &m, flat_array<const T> x) {
    add_blocks<sf_moments, T, Add, sf_moments_merge_blocks>(m, x.size(), 1, x.data());
}

template <class State, class T, void (*Add)(sf_block_moments *, size_t, const T *),
          void (*Merge)(State *, const sf_block_moments *)>
void add_rows(shared<State> &m, rows_of_three<T> x) {
    add_blocks<State, T, Add, Merge>(m, x.shape(0), 3, x.data());
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

template <class T, auto Value>
auto value_of(shared<T> &m) {
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

// Whether a state that is read back is one that samples lead to.
bool is_squares(double m2) { return !(m2 < 0); }
bool is_sound(const sf_moments &m) { return is_squares(m.m2); }
bool is_sound(const sf_vector_moments &m) { return is_squares(m.m2); }
bool is_sound(const sf_channel_moments &m) { return is_squares(m.m2[0]) && is_squares(m.m2[1]) && is_squares(m.m2[2]); }
bool is_sound(const sf_weighted_moments &m) {
    return is_squares(m.m2) && is_squares(m.weight) && is_squares(m.weight_square);
}
bool is_sound(const sf_running_sums &) { return true; }  // sums of anything
bool is_sound(const sf_running_sums_f32 &) { return true; }
bool is_sound(const sf_batch_means &b) {
    return b.size > 0 && b.batch.count < b.size && is_sound(b.batch) && is_sound(b.means);
}
bool is_sound(const sf_confidence_sequence &c) {
    return std::isfinite(c.low) && std::isfinite(c.high) && c.low < c.high && c.confidence > 0 && c.confidence < 1 &&
           c.target >= 0 && std::isfinite(c.target) && is_squares(c.square) && c.bets >= 0 && c.penalty >= 0 &&
           c.log_factor > 0;
}

template <class T>
void set_checked(shared<T> &to, const T &state) {
    if (!is_sound(state)) throw nb::value_error("the state holds values that no samples lead to");
    to.use([&](T *now, sf_error *) {
        *now = state;
        return SF_STATUS_OK;
    });
}

// The further kinds keep their state as the struct's bytes, for copies and pickles of the same build.
template <class T>
nb::class_<shared<T>> bind_state(nb::module_ &m, const char *name) {
    return nb::class_<shared<T>>(m, name)
        .def("state",
             [](shared<T> &self) {
                 T now = self.copy();
                 return nb::bytes(reinterpret_cast<const char *>(&now), sizeof now);
             })
        .def(
            "set_state",
            [](shared<T> &self, nb::bytes state) {
                if (state.size() != sizeof(T)) throw nb::value_error("the state is another version's");
                T then;
                std::memcpy(&then, state.c_str(), sizeof then);
                set_checked(self, then);
            },
            "state"_a);
}

template <class T>
nb::class_<shared<T>> bind_zeroed(nb::module_ &m, const char *name) {
    return bind_state<T>(m, name).def("__init__", [](shared<T> *self) { new (self) shared<T>(T{}); });
}

template <class T, class X, void (*Add)(T *, size_t, const X *)>
void add_all(shared<T> &to, flat_array<const X> x) {
    // One sample after another, so that pieces add up to the same bits.
    to.use_in_pieces(x.size(), values_of_a_piece,
                     [&](T *now, size_t first, size_t count) { Add(now, count, x.data() + first); });
}

template <class T, class Value, Value T::*Field>
Value field_of(shared<T> &m) {
    return m.copy().*Field;
}

void bind_running_sums(nb::module_ &m) {
    using sums = sf_running_sums;
    using sums_f32 = sf_running_sums_f32;
    bind_zeroed<sums>(m, "RunningSums")
        .def("add", &add_all<sums, double, sf_running_sums_add_f64>, "x"_a.noconvert())
        .def_prop_ro("count", &field_of<sums, uint64_t, &sums::count>)
        .def_prop_ro("m", &field_of<sums, double, &sums::m>)
        .def_prop_ro("s", &field_of<sums, double, &sums::s>)
        .def_prop_ro("mean", &value_of<sums, sf_running_sums_mean>)
        .def_prop_ro("variance", &value_of<sums, sf_running_sums_variance>)
        .def_prop_ro("standard_error", &value_of<sums, sf_running_sums_standard_error>);
    bind_zeroed<sums_f32>(m, "RunningSumsF32")
        .def("add", &add_all<sums_f32, float, sf_running_sums_f32_add_f32>, "x"_a.noconvert())
        .def_prop_ro("count", &field_of<sums_f32, uint64_t, &sums_f32::count>)
        .def_prop_ro("m", &field_of<sums_f32, float, &sums_f32::m>)
        .def_prop_ro("s", &field_of<sums_f32, float, &sums_f32::s>)
        .def_prop_ro("mean", &value_of<sums_f32, sf_running_sums_f32_mean>)
        .def_prop_ro("variance", &value_of<sums_f32, sf_running_sums_f32_variance>)
        .def_prop_ro("standard_error", &value_of<sums_f32, sf_running_sums_f32_standard_error>);
}

void bind_weighted(nb::module_ &m) {
    using weighted = sf_weighted_moments;
    bind_zeroed<weighted>(m, "WeightedMoments")
        .def(
            "add",
            [](shared<weighted> &self, flat_array<const double> x, flat_array<const double> weights) {
                if (x.size() != weights.size()) throw nb::value_error("each sample must have a weight");
                self.use_in_pieces(x.size(), values_of_a_piece, [&](weighted *now, size_t first, size_t count) {
                    sf_weighted_moments_add_f64(now, count, x.data() + first, weights.data() + first);
                });
            },
            "x"_a.noconvert(), "weights"_a.noconvert())
        .def("merge", &merge<weighted, sf_weighted_moments_merge>, "other"_a)
        .def_prop_ro("count", &field_of<weighted, uint64_t, &weighted::count>)
        .def_prop_ro("nonfinite", &field_of<weighted, uint64_t, &weighted::nonfinite>)
        .def_prop_ro("weight", &field_of<weighted, double, &weighted::weight>)
        .def_prop_ro("mean",
                     [](shared<weighted> &self) {
                         weighted now = self.copy();
                         return now.weight > 0.0 ? now.mean : static_cast<double>(NAN);
                     })
        .def_prop_ro("variance", &value_of<weighted, sf_weighted_moments_variance>)
        .def_prop_ro("standard_error", &value_of<weighted, sf_weighted_moments_standard_error>);
}

void bind_channels(nb::module_ &m) {
    using channels = sf_channel_moments;
    bind_zeroed<channels>(m, "ChannelMoments")
        .def("add", &add_rows<channels, float, sf_block_moments_add_rows_f32, sf_channel_moments_merge_blocks>,
             "x"_a.noconvert())
        .def("add", &add_rows<channels, double, sf_block_moments_add_rows_f64, sf_channel_moments_merge_blocks>,
             "x"_a.noconvert())
        .def("merge", &merge<channels, sf_channel_moments_merge>, "other"_a)
        .def(
            "at",
            [](shared<channels> &self, int channel) -> nb::typed<nb::tuple, uint64_t, double, double, uint64_t> {
                channels now = self.copy();
                sf_moments one = sf_channel_moments_at(&now, channel);
                return nb::make_tuple(one.count, one.mean, one.m2, one.nonfinite);
            },
            "channel"_a);
}

void bind_batches(nb::module_ &m) {
    using batches = sf_batch_means;
    bind_state<batches>(m, "BatchMeans")
        .def(
            "__init__",
            [](shared<batches> *self, uint64_t size) {
                batches empty{};
                empty.size = size;
                new (self) shared<batches>(empty);
            },
            "size"_a)
        .def("add", &add_all<batches, double, sf_batch_means_add_f64>, "x"_a.noconvert())
        .def_prop_ro("size", &field_of<batches, uint64_t, &batches::size>)
        .def_prop_ro("nonfinite", &field_of<batches, uint64_t, &batches::nonfinite>)
        .def("means", [](shared<batches> &self) -> nb::typed<nb::tuple, uint64_t, double, double, uint64_t> {
            sf_moments now = self.copy().means;
            return nb::make_tuple(now.count, now.mean, now.m2, now.nonfinite);
        });
}

void bind_bounded(nb::module_ &m) {
    using sequence = sf_confidence_sequence;
    bind_state<sequence>(m, "ConfidenceSequence")
        .def(
            "__init__",
            [](shared<sequence> *self, double low, double high, double confidence, double target) {
                sequence empty;
                sf_error error;
                raise_unless_ok(sf_confidence_sequence_init(&empty, low, high, confidence, target, &error), error);
                new (self) shared<sequence>(empty);
            },
            "low"_a, "high"_a, "confidence"_a, "target"_a)
        .def("add", &add_all<sequence, double, sf_confidence_sequence_add_f64>, "x"_a.noconvert())
        .def_prop_ro("count", &field_of<sequence, uint64_t, &sequence::count>)
        .def_prop_ro("nonfinite", &field_of<sequence, uint64_t, &sequence::nonfinite>)
        .def_prop_ro("outside", &field_of<sequence, uint64_t, &sequence::outside>)
        .def_prop_ro("lower", &value_of<sequence, sf_confidence_sequence_lower>)
        .def_prop_ro("upper", &value_of<sequence, sf_confidence_sequence_upper>);
    m.def(
        "betting_interval",
        [](flat_array<const double> x, double low, double high, double confidence) {
            std::pair<double, double> interval;
            call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
                return sf_betting_interval_f64(x.size(), x.data(), low, high, confidence, &interval.first,
                                               &interval.second, interrupt, error);
            });
            return interval;
        },
        "x"_a.noconvert(), "low"_a, "high"_a, "confidence"_a);
    m.def("normal_quantile", &sf_normal_quantile, "p"_a);
    m.def("student_t_quantile", &sf_student_t_quantile, "p"_a, "dof"_a);
}

}  // namespace

void bind_estimate(nb::module_ &m) {
    bind_running_sums(m);
    bind_weighted(m);
    bind_channels(m);
    bind_batches(m);
    bind_bounded(m);
    bind_kind<sf_moments>(m, "Moments")
        .def("add", &add<float, sf_block_moments_add_f32>, "x"_a.noconvert())
        .def("add", &add<double, sf_block_moments_add_f64>, "x"_a.noconvert())
        .def("merge", &merge<sf_moments, sf_moments_merge>, "other"_a)
        .def_prop_ro("mean", &value_of<sf_moments, sf_moments_mean>)
        .def_prop_ro("variance", &value_of<sf_moments, sf_moments_variance>)
        .def_prop_ro("sample_variance", &value_of<sf_moments, sf_moments_sample_variance>)
        .def_prop_ro("sample_deviation", &value_of<sf_moments, sf_moments_sample_deviation>)
        .def_prop_ro("standard_error", &value_of<sf_moments, sf_moments_standard_error>)
        .def(
            "half_width",
            [](moments &self, double confidence) {
                sf_moments now = self.copy();
                return sf_moments_half_width(&now, confidence);
            },
            "confidence"_a)
        .def(
            "bernstein_half_width",
            [](moments &self, double range, double confidence) {
                sf_moments now = self.copy();
                return sf_moments_bernstein_half_width(&now, range, confidence);
            },
            "range"_a, "confidence"_a)
        .def("state",
             [](moments &self) -> nb::typed<nb::tuple, uint64_t, double, double, uint64_t> {
                 sf_moments now = self.copy();
                 return nb::make_tuple(now.count, now.mean, now.m2, now.nonfinite);
             })
        .def(
            "set_state",
            [](moments &self, uint64_t count, double mean, double m2, uint64_t nonfinite) {
                set_checked(self, sf_moments{count, mean, m2, nonfinite});
            },
            "count"_a, "mean"_a, "m2"_a, "nonfinite"_a);

    bind_kind<sf_vector_moments>(m, "VectorMoments")
        .def("add", &add_rows<sf_vector_moments, float, sf_block_moments_add_rows_f32, sf_vector_moments_merge_blocks>,
             "x"_a.noconvert())
        .def("add", &add_rows<sf_vector_moments, double, sf_block_moments_add_rows_f64, sf_vector_moments_merge_blocks>,
             "x"_a.noconvert())
        .def("merge", &merge<sf_vector_moments, sf_vector_moments_merge>, "other"_a)
        .def_prop_ro("mean",
                     [](vector_moments &self) {
                         sf_vector_moments now = self.copy();
                         double none = now.count ? 0.0 : static_cast<double>(NAN);
                         return vector3{now.mean[0] + none, now.mean[1] + none, now.mean[2] + none};
                     })
        .def_prop_ro("variance", &value_of<sf_vector_moments, sf_vector_moments_variance>)
        .def_prop_ro("sample_variance", &value_of<sf_vector_moments, sf_vector_moments_sample_variance>)
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
                set_checked(self, sf_vector_moments{count, {mean[0], mean[1], mean[2]}, m2, nonfinite});
            },
            "count"_a, "mean"_a, "m2"_a, "nonfinite"_a);
}
