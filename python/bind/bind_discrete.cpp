// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/string.h>

#include <memory>
#include <string>

#include "bind.h"
#include "sunfleck/discrete.h"

namespace {

struct alias_table {
    std::unique_ptr<sf_alias_table, decltype(&sf_alias_table_destroy)> table{nullptr, sf_alias_table_destroy};

    explicit alias_table(flat_array<const double> weights) {
        call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
            sf_alias_table *made = nullptr;
            sf_status status = sf_alias_table_create(weights.data(), weights.size(), &made, interrupt, error);
            table.reset(made);
            return status;
        });
    }

    size_t size() const { return sf_alias_table_count(table.get()); }

    template <class In, class Out>
    using fill_function = sf_status (*)(const sf_alias_table *, size_t, const In *, Out *, sf_error *);

    template <class In, class Out, fill_function<In, Out> Fill>
    void run(flat_array<const In> in, flat_array<Out> out) const {
        call_in_checked_pieces(in.size(), [&](size_t first, size_t count, sf_error *error) {
            return Fill(table.get(), count, in.data() + first, out.data() + first, error);
        });
    }
};

template <class T>
using piecewise_function = sf_status (*)(const sf_piecewise *, size_t, const T *, T *, sf_error *);

struct piecewise {
    std::unique_ptr<sf_piecewise, decltype(&sf_piecewise_destroy)> density{nullptr, sf_piecewise_destroy};

    // Rows 0: on the unit interval.
    piecewise(flat_array<const double> weights, size_t columns, size_t rows) {
        call_interruptibly([&](const sf_interrupt *interrupt, sf_error *error) {
            sf_piecewise *made = nullptr;
            sf_status status = rows == 0
                                   ? sf_piecewise_create_1d(weights.data(), columns, &made, interrupt, error)
                                   : sf_piecewise_create_2d(weights.data(), columns, rows, &made, interrupt, error);
            density.reset(made);
            return status;
        });
    }

    template <class T>
    void run(piecewise_function<T> function, flat_array<const T> in, flat_array<T> out, bool to_density) const {
        size_t width = sf_piecewise_width(density.get()), out_width = to_density ? 1 : width;
        auto work = [&](size_t first, size_t rows, sf_error *error) {
            return function(density.get(), rows, in.data() + first * width, out.data() + first * out_width, error);
        };
        call_in_checked_pieces(in.size() / width, work);
    }

    void fill(const std::string &operation, flat_array<const float> in, flat_array<float> out) const {
        run<float>(operation == "sample" ? sf_piecewise_sample_fill_f32
                   : operation == "pdf"  ? sf_piecewise_pdf_fill_f32
                                         : sf_piecewise_invert_fill_f32,
                   in, out, operation == "pdf");
    }
    void fill_wide(const std::string &operation, flat_array<const double> in, flat_array<double> out) const {
        run<double>(operation == "sample" ? sf_piecewise_sample_fill_f64
                    : operation == "pdf"  ? sf_piecewise_pdf_fill_f64
                                          : sf_piecewise_invert_fill_f64,
                    in, out, operation == "pdf");
    }
};

}  // namespace

void bind_discrete(nb::module_ &m) {
    nb::class_<alias_table>(m, "AliasTable")
        .def(nb::init<flat_array<const double>>(), "weights"_a.noconvert())
        .def("__len__", &alias_table::size)
        .def("sample", &alias_table::run<float, uint32_t, sf_alias_table_sample_fill_f32>, "u"_a.noconvert(),
             "out"_a.noconvert())
        .def("sample", &alias_table::run<double, uint32_t, sf_alias_table_sample_fill_f64>, "u"_a.noconvert(),
             "out"_a.noconvert())
        .def("pdf", &alias_table::run<uint32_t, double, sf_alias_table_pdf_fill>, "index"_a.noconvert(),
             "out"_a.noconvert())
        .def("invert", &alias_table::run<uint32_t, double, sf_alias_table_invert_fill>, "index"_a.noconvert(),
             "out"_a.noconvert());
    nb::class_<piecewise>(m, "Piecewise")
        .def(nb::init<flat_array<const double>, size_t, size_t>(), "weights"_a.noconvert(), "columns"_a, "rows"_a)
        .def("fill", &piecewise::fill, "operation"_a, "points"_a.noconvert(), "out"_a.noconvert())
        .def("fill", &piecewise::fill_wide, "operation"_a, "points"_a.noconvert(), "out"_a.noconvert());
}
