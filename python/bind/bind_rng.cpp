// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <vector>

#include "bind.h"
#include "sunfleck/rng.h"

namespace {

// NumPy's bitgen_t, of which a capsule called "BitGenerator" holds a pointer
// (numpy/random/bitgen.h).
struct bitgen {
    void *state;
    uint64_t (*next_uint64)(void *);
    uint32_t (*next_uint32)(void *);
    double (*next_double)(void *);
    uint64_t (*next_raw)(void *);
};

// The lock may be taken again by the thread that has it: NumPy shuffles lists under it, and what a list's items do may
// draw.
struct generator : shared<sf_rng> {
    bitgen functions;

    explicit generator(const sf_rng &rng) : shared(rng) {
        sf_rng_callbacks c = sf_rng_callbacks_of(rng.kind);
        functions = {&value, c.next_full64, c.next_full32, c.next_f64, c.next_raw};
    }
};

sf_rng_kind find(const std::string &name) {
    sf_rng_kind kind;
    sf_error error;
    raise_unless_ok(sf_rng_find(name.c_str(), &kind, &error), error);
    return kind;
}

// An LCG's constants; those not given are the kind's own.
sf_lcg_parameters constants(sf_rng_kind kind, std::optional<uint64_t> a, std::optional<uint64_t> c,
                            std::optional<uint64_t> m) {
    sf_lcg_parameters p = sf_lcg_parameters_default(kind);
    return {a.value_or(p.multiplier), c.value_or(p.increment), m.value_or(p.modulus)};
}

template <class T, void (*Fill)(sf_rng *, size_t, T *)>
void fill(generator &g, flat_array<T> out) {
    g.use_in_pieces(out.size(), values_of_a_piece,
                    [&](sf_rng *rng, size_t first, size_t count) { Fill(rng, count, out.data() + first); });
}

// NumPy takes the lock around every draw, so that it should cost little where no other thread draws.
void lock(turn_lock &turn) {
    if (turn.try_lock()) return;
    away from_python;
    turn.lock();
}

}  // namespace

void bind_rng(nb::module_ &m) {
    m.def("rngs", [] { return listed(sf_rng_name, sf_rng_description); });

    nb::class_<turn_lock>(m, "Turn")
        .def("acquire",
             [](turn_lock &turn) {
                 lock(turn);
                 return true;
             })
        .def("release", [](turn_lock &turn) { turn.unlock(); })
        .def("__enter__",
             [](turn_lock &turn) {
                 lock(turn);
                 return true;
             })
        .def(
            "__exit__",
            [](turn_lock &turn, const nb::object &, const nb::object &, const nb::object &) { turn.unlock(); },
            "kind"_a.none(), "error"_a.none(), "traceback"_a.none());

    nb::class_<generator>(m, "Rng")
        .def(
            "__init__",
            [](generator *self, const std::string &name, uint64_t seed, uint64_t stream, std::optional<uint64_t> a,
               std::optional<uint64_t> c, std::optional<uint64_t> m) {
                sf_rng rng;
                sf_error error;
                sf_rng_kind kind = find(name);
                sf_lcg_parameters p = constants(kind, a, c, m);
                raise_unless_ok(a || c || m ? sf_rng_init_lcg(&rng, kind, &p, seed, stream, &error)
                                            : sf_rng_init(&rng, kind, seed, stream, &error),
                                error);
                new (self) generator(rng);
            },
            "name"_a, "seed"_a, "stream"_a, "a"_a = nb::none(), "c"_a = nb::none(), "m"_a = nb::none())
        .def_prop_ro("name", [](generator &g) { return sf_rng_name(g.value.kind); })
        .def_prop_ro("seed", [](generator &g) { return g.value.seed; })
        .def_prop_ro("stream", [](generator &g) { return g.value.stream; })
        .def_prop_ro("native_bits", [](generator &g) { return sf_rng_native_bits(g.value.kind); })
        .def("fill", &fill<uint32_t, sf_rng_fill_u32>, "out"_a.noconvert())
        .def("fill", &fill<uint64_t, sf_rng_fill_u64>, "out"_a.noconvert())
        .def("fill", &fill<float, sf_rng_fill_f32>, "out"_a.noconvert())
        .def("fill", &fill<double, sf_rng_fill_f64>, "out"_a.noconvert())
        .def("reset",
             [](generator &g) {
                 g.use([](sf_rng *rng, sf_error *) {
                     sf_rng_reset(rng);
                     return SF_STATUS_OK;
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
                nb::typed<nb::list, generator> list;
                for (size_t i = 0; i < count; ++i) {
                    sf_rng child;
                    g.use([&](sf_rng *rng, sf_error *) {
                        sf_rng_spawn(rng, 1, &child);
                        return SF_STATUS_OK;
                    });
                    list.append(nb::cast(new generator(child), nb::rv_policy::take_ownership));
                }
                return list;
            },
            "count"_a)
        .def("state",
             [](generator &g) {
                 std::vector<uint64_t> words(sf_rng_state_size(g.value.kind));
                 g.use([&](sf_rng *rng, sf_error *) {
                     sf_rng_get_state(rng, words.data());
                     return SF_STATUS_OK;
                 });
                 return words;
             })
        .def(
            "set_state",
            [](generator &g, const std::vector<uint64_t> &words) {
                g.use([&](sf_rng *rng, sf_error *error) {
                    return sf_rng_set_state(rng, rng->kind, words.data(), words.size(), error);
                });
            },
            "words"_a)
        .def("next_raw",
             [](generator &g) {
                 uint64_t draw = 0;
                 g.use([&](sf_rng *rng, sf_error *) {
                     draw = sf_rng_next_raw(rng);
                     return SF_STATUS_OK;
                 });
                 return draw;
             })
        .def_prop_ro(
            "turn", [](generator &g) { return &g.turn; }, nb::rv_policy::reference_internal)
        // Of NumPy's bitgen_t, its state and its next_uint64, next_uint32 and next_double; good as the capsule is.
        .def("addresses",
             [](generator &g) -> nb::typed<nb::tuple, size_t, size_t, size_t, size_t, size_t> {
                 const bitgen &f = g.functions;
                 return nb::make_tuple(reinterpret_cast<uintptr_t>(&f), reinterpret_cast<uintptr_t>(f.state),
                                       reinterpret_cast<uintptr_t>(f.next_uint64),
                                       reinterpret_cast<uintptr_t>(f.next_uint32),
                                       reinterpret_cast<uintptr_t>(f.next_double));
             })
        // The pointer is good for as long as the generator is.
        .def("capsule", [](generator &g) { return nb::capsule(&g.functions, "BitGenerator"); });

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
