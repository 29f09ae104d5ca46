// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "bind.h"
#include "sunfleck/rng.h"

namespace {

using generator = shared<sf_rng>;

sf_rng_kind find(const std::string &name) {
    sf_rng_kind kind;
    sf_error error;
    raise_unless_ok(sf_rng_find(name.c_str(), &kind, &error), error);
    return kind;
}

template <class T, void (*Fill)(sf_rng *, size_t, T *)>
void fill(generator &g, flat_array<T> out) {
    g.use([&](sf_rng *rng, sf_error *) {
        Fill(rng, out.size(), out.data());
        return SF_STATUS_OK;
    });
}

}  // namespace

void bind_rng(nb::module_ &m) {
    m.def("rngs", [] { return listed(sf_rng_name, sf_rng_description); });

    nb::class_<generator>(m, "Rng")
        .def(
            "__init__",
            [](generator *self, const std::string &name, uint64_t seed, uint64_t stream) {
                sf_rng rng;
                sf_error error;
                raise_unless_ok(sf_rng_init(&rng, find(name), seed, stream, &error), error);
                new (self) generator(rng);
            },
            "name"_a, "seed"_a, "stream"_a)
        .def_prop_ro("name", [](generator &g) { return sf_rng_name(g.value.kind); })
        .def_prop_ro("seed", [](generator &g) { return g.value.seed; })
        .def_prop_ro("stream", [](generator &g) { return g.value.stream; })
        .def("fill", &fill<uint32_t, sf_rng_fill_u32>, "out"_a.noconvert())
        .def("fill", &fill<uint64_t, sf_rng_fill_u64>, "out"_a.noconvert())
        .def("fill", &fill<float, sf_rng_fill_f32>, "out"_a.noconvert())
        .def("fill", &fill<double, sf_rng_fill_f64>, "out"_a.noconvert())
        .def("reset",
             [](generator &g) {
                 g.use([](sf_rng *rng, sf_error *error) {
                     return sf_rng_init(rng, rng->kind, rng->seed, rng->stream, error);
                 });
             })
        .def(
            "skip",
            [](generator &g, uint64_t count) {
                g.use([&](sf_rng *rng, sf_error *error) { return sf_rng_skip(rng, count, error); });
            },
            "count"_a)
        .def(
            "spawn",
            [](generator &g, size_t count) {
                std::vector<sf_rng> children(count);
                g.use([&](sf_rng *rng, sf_error *) {
                    sf_rng_spawn(rng, count, children.data());
                    return SF_STATUS_OK;
                });
                nb::typed<nb::list, generator> list;
                for (const sf_rng &child : children)
                    list.append(nb::cast(new generator(child), nb::rv_policy::take_ownership));
                return list;
            },
            "count"_a)
        .def("state", [](generator &g) {
            std::vector<uint64_t> words(sf_rng_state_size(g.value.kind));
            g.use([&](sf_rng *rng, sf_error *) {
                sf_rng_get_state(rng, words.data());
                return SF_STATUS_OK;
            });
            return words;
        });

    m.def(
        "rng_from_state",
        [](const std::string &name, const std::vector<uint64_t> &words) {
            sf_rng rng;
            sf_error error;
            raise_unless_ok(sf_rng_set_state(&rng, find(name), words.data(), words.size(), &error), error);
            return new generator(rng);
        },
        nb::rv_policy::take_ownership, "name"_a, "words"_a);
}
