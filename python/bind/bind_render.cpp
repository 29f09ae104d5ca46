// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "sunfleck/render.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bind_scene.h"

namespace {

// Owns a film; the arrays that show it hold this object, and so the film, alive.
struct film_handle {
    sf_film *film = nullptr;
    bool signalled = false;  // Ctrl-C arrived while it was rendered
    std::string failure;     // of the last write of its checkpoint

    film_handle() = default;
    ~film_handle() { sf_film_destroy(film); }
    film_handle(const film_handle &) = delete;
    film_handle &operator=(const film_handle &) = delete;
};

using array = nb::ndarray<nb::numpy, nb::ro>;

// Read-only, without a copy: strides are the channel's own.
template <class T>
nb::object view(nb::handle owner, const sf_film *film, const sf_channel &channel, size_t depth) {
    size_t shape[3] = {sf_film_height(film), sf_film_width(film), depth};
    int64_t strides[3] = {static_cast<int64_t>(channel.row_stride / sizeof(T)),
                          static_cast<int64_t>(channel.pixel_stride / sizeof(T)), 1};
    return array(channel.data, depth ? 3 : 2, shape, owner, strides, nb::dtype<T>()).cast();
}

nb::object view_channel(nb::handle owner, const sf_film *film, const sf_channel &channel) {
    switch (channel.type) {
        case SF_CHANNEL_UINT32: return view<uint32_t>(owner, film, channel, 0);
        case SF_CHANNEL_UINT8: return view<uint8_t>(owner, film, channel, 0);
        case SF_CHANNEL_FLOAT32: break;
    }
    return view<float>(owner, film, channel, 0);
}

nb::typed<nb::list, nb::typed<nb::tuple, nb::str, nb::any>> channels_of(nb::handle_t<film_handle> self) {
    const sf_film *film = nb::cast<film_handle &>(self).film;
    nb::list channels;
    for (size_t i = 0; i < sf_film_channel_count(film); ++i) {
        sf_channel channel = sf_film_channel(film, i);
        channels.append(nb::make_tuple(channel.name, view_channel(self, film, channel)));
    }
    return channels;
}

// R, G and B interleave, so that the first channel's address and strides show all three.
nb::typed<nb::object, nb::ndarray<nb::numpy, const float, nb::ndim<3>>> color_of(nb::handle_t<film_handle> self) {
    const sf_film *film = nb::cast<film_handle &>(self).film;
    return view<float>(self, film, sf_film_channel(film, 0), 3);
}

nb::typed<nb::dict, nb::str, nb::any> aovs_of(nb::handle_t<film_handle> self) {
    const sf_film *film = nb::cast<film_handle &>(self).film;
    nb::dict aovs;
    for (int k = 0; k < SF_AOV_COUNT; ++k) {
        sf_channel first;
        int components = sf_film_aov(film, static_cast<sf_aov>(k), &first);
        if (components)
            aovs[sf_aov_name(static_cast<sf_aov>(k))] =
                view<float>(self, film, first, components > 1 ? static_cast<size_t>(components) : 0);
    }
    return aovs;
}

nb::typed<nb::dict, nb::str, nb::str> attributes_of(const film_handle &self) {
    nb::dict attributes;
    for (size_t i = 0; i < sf_film_attribute_count(self.film); ++i) {
        sf_attribute attribute = sf_film_attribute(self.film, i);
        attributes[attribute.name] = attribute.text;
    }
    return attributes;
}

nb::typed<nb::dict, nb::str, nb::any> summary_of(const film_handle &self) {
    sf_film_summary s = sf_film_summarize(self.film);
    nb::dict reasons, work, d;
    for (int k = 0; k < SF_STOP_REASON_COUNT; ++k)
        reasons[sf_stop_reason_name(static_cast<sf_stop_reason>(k))] = s.reasons[k];
    d["pixels"] = s.pixels;
    d["samples"] = s.samples;
    d["traced_samples"] = s.traced_samples;
    d["reasons"] = reasons;
    d["nonfinite_samples"] = s.nonfinite_samples;
    d["level"] = s.level;
    d["tolerance"] = s.tolerance;
    d["confidence"] = s.confidence;
    d["worst_half_width"] = s.worst_half_width;
    d["worst_pixel"] = nb::make_tuple(s.worst_x, s.worst_y);
    d["mean_half_width"] = s.mean_half_width;
    d["relmse"] = s.relmse;
    d["seconds"] = s.seconds;
    d["threads"] = s.threads;
    d["rounds"] = s.rounds;
    for (int k = 0; k < SF_WORK_COUNT; ++k)
        if (s.work_seconds[k] > 0) work[sf_work_name(static_cast<sf_work>(k))] = s.work_seconds[k];
    d["work"] = work;
    return d;
}

// Watches a render from the thread that called it: Ctrl-C, and the caller's own function.
struct watcher {
    nb::object observer;
    nb::object notice;
    bool signalled = false;
    std::exception_ptr failure;

    void tell(const char *message) {
        if (interpreter_is_leaving()) return;
        nb::gil_scoped_acquire acquired;
        try {
            notice(message);
        } catch (...) {
            failure = std::current_exception();
        }
    }

    // Tells C whether to stop. Ctrl-C stops and is spent: the partial picture is the answer to it.
    int look(const sf_progress *progress) {
        if (interpreter_is_leaving()) return 1;
        nb::gil_scoped_acquire acquired;
        try {
            if (PyErr_CheckSignals()) throw nb::python_error();
            if (observer.is_none()) return 0;
            nb::object answer = observer(nb::cast(*progress, nb::rv_policy::copy));
            return answer.ptr() == Py_False;
        } catch (nb::python_error &error) {
            if (error.matches(PyExc_KeyboardInterrupt))
                signalled = true;
            else
                failure = std::current_exception();
        } catch (...) {
            failure = std::current_exception();
        }
        return 1;
    }
};

void on_notice(const char *message, void *user) { static_cast<watcher *>(user)->tell(message); }

int on_progress(const sf_progress *progress, void *user) { return static_cast<watcher *>(user)->look(progress); }

// Whether a render takes the k-th value of a choice: of patterns, not all.
bool is_allowed(const sf_option &option, int k) {
    return std::strcmp(option.name, "pattern") != 0 || sf_render_takes_pattern(static_cast<sf_pattern>(k));
}

int find(const sf_option &option, const std::string &name) {
    return find_name(option.name, name, option.name_of, [&](int k) { return is_allowed(option, k); });
}

uint32_t find_all(const sf_option &option, const std::vector<std::string> &names) {
    uint32_t all = 0;
    for (const std::string &name : names) all |= 1u << find(option, name);
    return all;
}

template <class T>
void store(sf_render_options &options, const sf_option &option, const T &value) {
    std::memcpy(reinterpret_cast<char *>(&options) + option.offset, &value, sizeof value);
}

void set_option(sf_render_options &options, const sf_option &option, nb::handle value) {
    switch (option.type) {
        case SF_OPTION_UINT32: return store(options, option, nb::cast<uint32_t>(value));
        case SF_OPTION_UINT64: return store(options, option, nb::cast<uint64_t>(value));
        case SF_OPTION_FLOAT64: return store(options, option, nb::cast<double>(value));
        case SF_OPTION_FLAG: return store(options, option, uint32_t{nb::cast<bool>(value)});
        case SF_OPTION_CHOICE: return store(options, option, find(option, nb::cast<std::string>(value)));
        case SF_OPTION_NAMES:
            return store(options, option, find_all(option, nb::cast<std::vector<std::string>>(value)));
        case SF_OPTION_RECTANGLE: return store(options, option, nb::cast<std::array<uint32_t, 4>>(value));
    }
}

// Options of the table of options, by their names.
using option_values = nb::typed<nb::dict, nb::str, nb::any>;

const sf_option &option_named(const std::string &name) {
    for (size_t i = 0; const sf_option *option = sf_render_option(i); ++i)
        if (name == option->name) return *option;
    throw nb::type_error(("a render has no option '" + name + "'").c_str());
}

sf_render_options options_of(const option_values &given) {
    sf_render_options options = sf_render_options_default();
    for (auto [name, value] : given) set_option(options, option_named(nb::cast<std::string>(name)), value);
    return options;
}

// Rows of the full frame, one byte a pixel.
using pixel_mask = nb::ndarray<const uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

void set_mask(sf_render_options &options, const pixel_mask &mask) {
    if (mask.shape(0) != options.height || mask.shape(1) != options.width) {
        std::string message = "mask has shape (" + std::to_string(mask.shape(0)) + ", " +
                              std::to_string(mask.shape(1)) + "); it must be that of the full frame, (" +
                              std::to_string(options.height) + ", " + std::to_string(options.width) + ")";
        throw nb::value_error(message.c_str());
    }
    options.mask = mask.data();
    options.mask_stride = mask.shape(1);
}

film_handle *render(const scene_handle &scene, const option_values &given, bool profile, std::optional<pixel_mask> mask,
                    const std::optional<std::string> &checkpoint, double checkpoint_seconds, nb::object notice,
                    nb::object observer) {
    watcher watch{observer, notice, false, nullptr};
    sf_render_options options = options_of(given);
    options.profile = profile;
    if (mask) set_mask(options, *mask);
    options.progress = on_progress;
    options.progress_user = &watch;
    options.checkpoint_path = checkpoint ? checkpoint->c_str() : nullptr;
    options.checkpoint_seconds = checkpoint_seconds;
    options.notice = on_notice;
    options.notice_user = &watch;

    auto film = std::make_unique<film_handle>();
    call([&](sf_error *error) {
        sf_status status = sf_render(scene.scene, &options, &film->film, error);
        if (status && film->film) film->failure = error->message;  // the film is done, its file is not
        return film->film ? SF_STATUS_OK : status;
    });
    if (watch.failure) std::rethrow_exception(watch.failure);
    film->signalled = watch.signalled;
    return film.release();
}

film_handle *load_film(const std::string &path) {
    auto film = std::make_unique<film_handle>();
    call([&](sf_error *error) { return sf_film_load(path.c_str(), &film->film, error); });
    return film.release();
}

void save_film(const film_handle &film, const std::string &path) {
    call([&](sf_error *error) { return sf_film_save(film.film, path.c_str(), error); });
}

film_handle *merge_films(const std::vector<const film_handle *> &parts) {
    auto film = std::make_unique<film_handle>();
    std::vector<const sf_film *> films;
    for (const film_handle *part : parts) films.push_back(part->film);
    call([&](sf_error *error) { return sf_film_merge(films.data(), films.size(), &film->film, error); });
    return film.release();
}

}  // namespace

void bind_render(nb::module_ &m) {
    nb::class_<sf_progress>(m, "Progress")
        .def_ro("round", &sf_progress::round)
        .def_ro("samples", &sf_progress::samples)
        .def_ro("pixels", &sf_progress::pixels)
        .def_ro("pixels_done", &sf_progress::pixels_done)
        .def_ro("expected_samples", &sf_progress::expected_samples)
        .def_ro("seconds", &sf_progress::seconds)
        .def_ro("time_limit", &sf_progress::time_limit)
        .def_ro("pixels_met", &sf_progress::pixels_met)
        .def_ro("tolerance", &sf_progress::tolerance)
        .def_ro("relmse", &sf_progress::relmse)
        .def_prop_ro("round_finished", [](const sf_progress &p) { return p.round_finished != 0; })
        .def("__getstate__",
             [](const sf_progress &p) { return nb::bytes(reinterpret_cast<const char *>(&p), sizeof p); })
        .def("__setstate__", [](sf_progress &p, const nb::bytes &state) {
            if (state.size() != sizeof p) throw nb::value_error("the state is another version's");
            std::memcpy(new (&p) sf_progress, state.c_str(), sizeof p);
        });

    nb::class_<film_handle>(m, "Film")
        .def_prop_ro("width", [](const film_handle &self) { return sf_film_width(self.film); })
        .def_prop_ro("height", [](const film_handle &self) { return sf_film_height(self.film); })
        .def_rw("signalled", &film_handle::signalled)
        .def_ro("failure", &film_handle::failure)
        .def("channels", &channels_of)
        .def("color", &color_of)
        .def("aovs", &aovs_of)
        .def("attributes", &attributes_of)
        .def("summary", &summary_of)
        .def("save", &save_film, "path"_a);

    m.def("aov_names", [] {
        nb::typed<nb::list, nb::str> names;
        for (int k = 0; k < SF_AOV_COUNT; ++k) names.append(sf_aov_name(static_cast<sf_aov>(k)));
        return names;
    });

    m.def("render_patterns", [] {
        nb::typed<nb::list, nb::str> names;
        for (int k = 0; const char *name = sf_pattern_name(static_cast<sf_pattern>(k)); ++k)
            if (sf_render_takes_pattern(static_cast<sf_pattern>(k))) names.append(name);
        return names;
    });

    m.def("pixel_filters", [] {
        nb::typed<nb::list, nb::str> names;
        for (int k = 0; const char *name = sf_pixel_filter_name(static_cast<sf_pixel_filter>(k)); ++k)
            names.append(name);
        return names;
    });

    m.def("stop_reasons", [] {
        nb::typed<nb::list, nb::str> names;
        for (int k = 0; k < SF_STOP_REASON_COUNT; ++k)
            names.append(sf_stop_reason_name(static_cast<sf_stop_reason>(k)));
        return names;
    });

    m.def("render", &render, nb::rv_policy::take_ownership, "scene"_a, "options"_a, nb::kw_only(), "profile"_a,
          "mask"_a.none(), "checkpoint"_a.none(), "checkpoint_seconds"_a, "notice"_a, "progress"_a.none());
    m.def("render_options", [] {
        nb::typed<nb::dict, nb::str, nb::typed<nb::tuple, nb::str, nb::any, nb::typed<nb::list, nb::str>>> options;
        for (size_t i = 0; const sf_option *option = sf_render_option(i); ++i) {
            nb::object otherwise = nb::cast(option->otherwise);
            if (option->type == SF_OPTION_CHOICE)
                otherwise = nb::cast(option->name_of(static_cast<int>(option->otherwise)));
            else if (option->type == SF_OPTION_FLAG)
                otherwise = nb::cast(option->otherwise != 0);
            else if (option->type != SF_OPTION_FLOAT64)
                otherwise = nb::cast(static_cast<uint64_t>(option->otherwise));
            nb::list names;
            for (int k = 0; option->name_of && option->name_of(k); ++k)
                if (is_allowed(*option, k)) names.append(option->name_of(k));
            options[option->name] = nb::make_tuple(option->text, otherwise, names);
        }
        return options;
    });
    m.def("load_film", &load_film, nb::rv_policy::take_ownership, "path"_a);
    m.def("merge_films", &merge_films, nb::rv_policy::take_ownership, "films"_a);
}
