// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <optional>
#include <string>
#include <type_traits>

#include "bind.h"
#include "sunfleck/mapping.h"

namespace {

sf_mapping find(const std::string &name) {
    sf_mapping mapping;
    sf_error error;
    raise_unless_ok(sf_mapping_find(name.c_str(), &mapping, &error), error);
    return mapping;
}

// Input and output widths, and for each parameter its name, components, default and range.
nb::typed<nb::tuple, size_t, size_t,
          nb::typed<nb::list, nb::typed<nb::tuple, nb::str, size_t, std::optional<double>, nb::str>>>
signature_of(const std::string &name) {
    sf_mapping mapping = find(name);
    nb::list parameters;
    for (size_t i = 0; i < sf_mapping_parameter_count(mapping); ++i) {
        sf_mapping_parameter p = sf_mapping_parameter_at(mapping, i);
        nb::object initial = p.has_default ? nb::cast(p.default_value) : nb::none();
        parameters.append(nb::make_tuple(p.name, p.components, initial, p.range));
    }
    return nb::make_tuple(sf_mapping_input_width(mapping), sf_mapping_output_width(mapping), parameters);
}

template <class T>
using fill_function = sf_status (*)(sf_mapping, size_t, const T *, const T *const *, const size_t *, T *, sf_error *);

template <class T>
fill_function<T> function_of(const std::string &operation);
template <>
fill_function<float> function_of(const std::string &operation) {
    if (operation == "sample") return sf_mapping_sample_fill_f32;
    if (operation == "invert") return sf_mapping_invert_fill_f32;
    return operation == "pdf" ? sf_mapping_pdf_fill_f32 : sf_mapping_weight_fill_f32;
}
template <>
fill_function<double> function_of(const std::string &operation) {
    if (operation == "sample") return sf_mapping_sample_fill_f64;
    if (operation == "invert") return sf_mapping_invert_fill_f64;
    return operation == "pdf" ? sf_mapping_pdf_fill_f64 : sf_mapping_weight_fill_f64;
}

// A parameter is None (its default), one value, or one value for each point.
template <class T>
void fill(const std::string &operation, const std::string &name, flat_array<const T> input,
          nb::typed<nb::list, nb::any> parameters, flat_array<T> out) {
    sf_mapping mapping = find(name);
    size_t width = operation == "sample" ? sf_mapping_input_width(mapping) : sf_mapping_output_width(mapping);
    size_t count = input.size() / width;
    flat_array<const T> kept[SF_MAPPING_MAX_PARAMETERS];
    const T *pointers[SF_MAPPING_MAX_PARAMETERS] = {};
    size_t strides[SF_MAPPING_MAX_PARAMETERS] = {};
    for (size_t i = 0; i < nb::len(parameters); ++i) {
        if (parameters[i].is_none()) continue;
        size_t components = sf_mapping_parameter_at(mapping, i).components;
        kept[i] = nb::cast<flat_array<const T>>(parameters[i], false);
        pointers[i] = kept[i].data();
        strides[i] = kept[i].ndim() == (components > 1) ? 0 : components;
    }
    fill_function<T> function = function_of<T>(operation);
    size_t out_width = operation == "sample"   ? sf_mapping_output_width(mapping)
                       : operation == "invert" ? sf_mapping_input_width(mapping)
                                               : 1;
    auto work = [&](size_t first, size_t rows, sf_error *error) {
        const T *parts[SF_MAPPING_MAX_PARAMETERS] = {};
        for (size_t i = 0; i < SF_MAPPING_MAX_PARAMETERS; ++i)
            parts[i] = pointers[i] ? pointers[i] + first * strides[i] : nullptr;
        return function(mapping, rows, input.data() + first * width, parts, strides, out.data() + first * out_width,
                        error);
    };
    call_in_checked_pieces(count, work);
}

// A term of a GGX microsurface; v is None but for the third, alphas are one value or one for each point.
template <class T>
void fill_ggx(int term, flat_array<const T> w, std::optional<flat_array<const T>> v, flat_array<const T> alpha_x,
              flat_array<const T> alpha_y, flat_array<T> out) {
    size_t strides[3] = {v && v->ndim() > 1 ? size_t(3) : 0, alpha_x.ndim() > 0, alpha_y.ndim() > 0};
    const T *second = v ? v->data() : nullptr;
    auto work = [&](size_t first, size_t rows, sf_error *error) {
        const T *from = w.data() + 3 * first, *other = second ? second + strides[0] * first : nullptr;
        const T *across = alpha_x.data() + strides[1] * first, *along = alpha_y.data() + strides[2] * first;
        sf_ggx_term which = static_cast<sf_ggx_term>(term);
        if constexpr (std::is_same_v<T, float>)
            return sf_ggx_fill_f32(which, rows, from, other, across, along, strides, out.data() + first, error);
        else
            return sf_ggx_fill_f64(which, rows, from, other, across, along, strides, out.data() + first, error);
    };
    call_in_checked_pieces(w.size() / 3, work);
}

}  // namespace

void bind_mapping(nb::module_ &m) {
    m.def("mappings", [] { return listed(sf_mapping_name, sf_mapping_description); });
    m.def("mapping_signature", &signature_of, "name"_a);
    m.def("mapping_fill", &fill<float>, "operation"_a, "name"_a, "points"_a.noconvert(), "parameters"_a,
          "out"_a.noconvert());
    m.def("mapping_fill", &fill<double>, "operation"_a, "name"_a, "points"_a.noconvert(), "parameters"_a,
          "out"_a.noconvert());
    m.def("ggx_fill", &fill_ggx<float>, "term"_a, "w"_a.noconvert(), "v"_a.noconvert().none(), "alpha_x"_a.noconvert(),
          "alpha_y"_a.noconvert(), "out"_a.noconvert());
    m.def("ggx_fill", &fill_ggx<double>, "term"_a, "w"_a.noconvert(), "v"_a.noconvert().none(), "alpha_x"_a.noconvert(),
          "alpha_y"_a.noconvert(), "out"_a.noconvert());
}
