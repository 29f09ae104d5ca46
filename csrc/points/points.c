// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Patterns by name, the checks of their options, and sets. */
#include "sunfleck/points.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/name.h"
#include "base/platform.h"
#include "points/points_set.h"

#define TAKES(scramble) (1u << (scramble))
#define ANY_COUNT UINT64_MAX
#define COUNT_24 (UINT64_C(1) << 24) /* strata that a float holds */
#define COUNT_32 (UINT64_C(1) << 32)
#define NET_SCRAMBLES                                                                                        \
    (TAKES(SF_SCRAMBLE_NONE) | TAKES(SF_SCRAMBLE_SHIFT) | TAKES(SF_SCRAMBLE_LMS) | TAKES(SF_SCRAMBLE_OWEN) | \
     TAKES(SF_SCRAMBLE_NESTED))
#define DIGITS (TAKES(SF_SCRAMBLE_NONE) | TAKES(SF_SCRAMBLE_PERMUTED) | TAKES(SF_SCRAMBLE_OWEN))
#define SHIFTED (TAKES(SF_SCRAMBLE_NONE) | TAKES(SF_SCRAMBLE_SHIFT))

static const sf_pattern_method methods[SF_PATTERN_COUNT] = {
    [SF_PATTERN_UNIFORM] = {"uniform", "centres of a regular grid; aliases, and needs its total ahead",
                            SF_POINTS_MAX_DIMS, COUNT_32, 1, SF_SCRAMBLE_NONE, TAKES(SF_SCRAMBLE_NONE), sf_grid_prepare,
                            sf_uniform_make},
    [SF_PATTERN_RANDOM] = {"random", "independent points: error falls as n^-1/2 whatever the integrand",
                           SF_POINTS_MAX_DIMS, ANY_COUNT, 0, SF_SCRAMBLE_NONE, TAKES(SF_SCRAMBLE_NONE), NULL,
                           sf_random_make},
    [SF_PATTERN_JITTERED] = {"jittered", "a random point in each cell of a grid; needs its total ahead",
                             SF_POINTS_MAX_DIMS, COUNT_32, 1, SF_SCRAMBLE_NONE, TAKES(SF_SCRAMBLE_NONE),
                             sf_grid_prepare, sf_jittered_make},
    [SF_PATTERN_LATIN] = {"latin",
                          "latin hypercube: n strata in each dimension, one point in each; needs its total ahead",
                          SF_POINTS_MAX_DIMS, COUNT_32, 1, SF_SCRAMBLE_NONE, TAKES(SF_SCRAMBLE_NONE), sf_latin_prepare,
                          sf_latin_make},
    [SF_PATTERN_MULTIJITTERED] = {"multijittered",
                                  "jittered and latin at once, correlated (Kensler 2013), by pairs of dimensions; "
                                  "needs its total ahead",
                                  SF_POINTS_MAX_DIMS, COUNT_24, 1, SF_SCRAMBLE_NONE, TAKES(SF_SCRAMBLE_NONE),
                                  sf_multijittered_prepare, sf_multijittered_make},
    [SF_PATTERN_ORTHOGONAL] = {"orthogonal",
                               "latin hypercube on an orthogonal array: every pair of dimensions stratified; "
                               "needs its total ahead",
                               SF_ORTHOGONAL_MAX_DIMS, COUNT_24, 1, SF_SCRAMBLE_NONE, TAKES(SF_SCRAMBLE_NONE),
                               sf_orthogonal_prepare, sf_orthogonal_make},
    [SF_PATTERN_HALTON] = {"halton", "radical inverses in the first d primes, digits permuted (Halton 1960)",
                           SF_HALTON_MAX_DIMS, ANY_COUNT, 0, SF_SCRAMBLE_PERMUTED, DIGITS, sf_halton_prepare,
                           sf_halton_make},
    [SF_PATTERN_HAMMERSLEY] = {"hammersley", "i / n, and Halton's radical inverses beside it; needs its total ahead",
                               SF_HALTON_MAX_DIMS + 1, COUNT_32, 1, SF_SCRAMBLE_NONE, DIGITS, sf_hammersley_prepare,
                               sf_hammersley_make},
    [SF_PATTERN_SOBOL] = {"sobol", "Sobol' sequence with Joe & Kuo's direction numbers, Owen-scrambled (Burley 2020)",
                          SF_SOBOL_MAX_DIMS, COUNT_32, 0, SF_SCRAMBLE_OWEN, NET_SCRAMBLES, sf_net_prepare, sf_net_make},
    [SF_PATTERN_SZ] =
        {"sz", "four dimensions: each half a (0, 2)-sequence in base 2, all a (0, 4)-sequence in base 4 (Ahmed 2024)",
         SF_SZ_MAX_DIMS, COUNT_32, 0, SF_SCRAMBLE_OWEN, NET_SCRAMBLES, sf_net_prepare, sf_net_make},
    [SF_PATTERN_LATTICE] = {"lattice", "rank-1 lattice with Kuo's generating vector; for periodic integrands",
                            SF_LATTICE_MAX_DIMS, ANY_COUNT, 0, SF_SCRAMBLE_NONE, SHIFTED, sf_lattice_prepare,
                            sf_lattice_make},
    [SF_PATTERN_R2] = {"r2", "steps of powers of the generalized golden ratio modulo 1 (Roberts 2018)",
                       SF_POINTS_MAX_DIMS, ANY_COUNT, 0, SF_SCRAMBLE_NONE, SHIFTED, sf_r2_prepare, sf_r2_make},
};

static const struct {
    const char *name, *description;
} scrambles[SF_SCRAMBLE_COUNT] = {
    [SF_SCRAMBLE_DEFAULT] = {"default", "the pattern's own: owen for sobol, sz, permuted for halton, none elsewhere"},
    [SF_SCRAMBLE_NONE] = {"none", "the plain pattern"},
    [SF_SCRAMBLE_PERMUTED] = {"permuted", "each digit by a random permutation of its place"},
    [SF_SCRAMBLE_SHIFT] =
        {"shift", "one random word a dimension: XORed into every point's (sobol, sz), added modulo 1 (lattice, r2)"},
    [SF_SCRAMBLE_LMS] = {"lms", "a random lower triangular matrix a dimension, and a digital shift (Matousek 1998)"},
    [SF_SCRAMBLE_OWEN] = {"owen", "nested uniform scrambling by a hash (Owen 1995, Burley 2020, Vegdahl 2021)"},
    [SF_SCRAMBLE_NESTED] = {"nested", "nested uniform scrambling with a flip of its own at each node (Owen 1995)"},
};

/* ---- names ---- */

const char *sf_pattern_name(sf_pattern pattern) {
    return (unsigned)pattern < SF_PATTERN_COUNT ? methods[pattern].name : NULL;
}
const char *sf_pattern_description(sf_pattern pattern) {
    return (unsigned)pattern < SF_PATTERN_COUNT ? methods[pattern].description : NULL;
}
const char *sf_scramble_name(sf_scramble scramble) {
    return (unsigned)scramble < SF_SCRAMBLE_COUNT ? scrambles[scramble].name : NULL;
}
const char *sf_scramble_description(sf_scramble scramble) {
    return (unsigned)scramble < SF_SCRAMBLE_COUNT ? scrambles[scramble].description : NULL;
}

static const char *pattern_name_at(int i) { return sf_pattern_name((sf_pattern)i); }
static const char *scramble_name_at(int i) { return sf_scramble_name((sf_scramble)i); }

sf_status sf_pattern_find(const char *name, sf_pattern *pattern, sf_error *error) {
    int index = 0;
    sf_status status = sf_name_find("pattern", name, pattern_name_at, &index, error);
    if (status == SF_STATUS_OK) *pattern = (sf_pattern)index;
    return status;
}

sf_status sf_scramble_find(const char *name, sf_scramble *scramble, sf_error *error) {
    int index = 0;
    sf_status status = sf_name_find("scramble", name, scramble_name_at, &index, error);
    if (status == SF_STATUS_OK) *scramble = (sf_scramble)index;
    return status;
}

/* ---- what a pattern can do ---- */

uint32_t sf_pattern_max_dims(sf_pattern pattern) { return methods[pattern].max_dims; }
uint64_t sf_pattern_max_count(sf_pattern pattern) { return methods[pattern].max_count; }
int sf_pattern_needs_total(sf_pattern pattern) { return methods[pattern].needs_total; }
sf_scramble sf_pattern_default_scramble(sf_pattern pattern) { return methods[pattern].default_scramble; }
int sf_pattern_is_random(sf_pattern pattern) {
    switch (pattern) {
        case SF_PATTERN_RANDOM:
        case SF_PATTERN_JITTERED:
        case SF_PATTERN_LATIN:
        case SF_PATTERN_MULTIJITTERED:
        case SF_PATTERN_ORTHOGONAL: return 1;
        default: return 0;
    }
}
sf_scramble sf_pattern_random_scramble(sf_pattern pattern) {
    if (methods[pattern].default_scramble != SF_SCRAMBLE_NONE) return methods[pattern].default_scramble;
    for (int s = SF_SCRAMBLE_NONE + 1; s < SF_SCRAMBLE_COUNT; ++s)
        if (sf_pattern_takes_scramble(pattern, (sf_scramble)s)) return (sf_scramble)s;
    return SF_SCRAMBLE_NONE;
}
int sf_pattern_takes_scramble(sf_pattern pattern, sf_scramble scramble) {
    return scramble == SF_SCRAMBLE_DEFAULT || (methods[pattern].scrambles >> scramble & 1u);
}

sf_status sf_points_check_pattern(sf_pattern pattern, uint32_t dims, sf_error *error) {
    if ((unsigned)pattern >= SF_PATTERN_COUNT || !methods[pattern].name)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "pattern is %d; patterns are 0 .. %d", (int)pattern,
                       SF_PATTERN_COUNT - 1);
    if (pattern == SF_PATTERN_SZ && dims > SF_SZ_MAX_DIMS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "d is %" PRIu32
                       "; sz has 1 .. %u dimensions, beyond which pairs of few points repeat one another: give "
                       "pad=4 (or pad=2) for more, or take sobol",
                       dims, SF_SZ_MAX_DIMS);
    if (dims < 1 || dims > methods[pattern].max_dims)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "d is %" PRIu32 "; %s has 1 .. %" PRIu32 " dimensions", dims,
                       methods[pattern].name, methods[pattern].max_dims);
    return SF_STATUS_OK;
}

sf_status sf_points_check_dims(const sf_points_options *options, sf_error *error) {
    if (options->pad == 0 || options->dims == 0) return sf_points_check_pattern(options->pattern, options->dims, error);
    if (options->dims > SF_POINTS_MAX_DIMS)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "d is %" PRIu32 "; padded sets have 1 .. %u dimensions",
                       options->dims, SF_POINTS_MAX_DIMS);
    return sf_points_check_pattern(options->pattern, 1, error); /* the set's own few dimensions every net has */
}

static sf_status nearest_counts(sf_pattern pattern, uint32_t dims, uint64_t n, uint64_t *below, uint64_t *above) {
    uint64_t most = methods[pattern].max_count, least = methods[pattern].needs_total ? 1 : 0;
    switch (pattern) {
        case SF_PATTERN_UNIFORM:
        case SF_PATTERN_JITTERED: return sf_grid_valid_counts(n, dims, below, above);
        case SF_PATTERN_MULTIJITTERED: return sf_multijittered_valid_counts(n, below, above);
        case SF_PATTERN_ORTHOGONAL: return sf_orthogonal_valid_counts(n, dims, below, above);
        default: break;
    }
    *below = n < least ? 0 : n < most ? n : most;
    *above = n < least ? least : n <= most ? n : 0;
    return SF_STATUS_OK;
}

sf_status sf_pattern_valid_counts(sf_pattern pattern, uint32_t dims, uint64_t n, uint64_t *below, uint64_t *above,
                                  sf_error *error) {
    sf_status status = sf_points_check_pattern(pattern, dims, error);
    if (status != SF_STATUS_OK) return status;
    return nearest_counts(pattern, dims, n, below, above);
}

/* ---- options ---- */

sf_points_options sf_points_options_default(void) {
    sf_points_options options;
    memset(&options, 0, sizeof options);
    options.pattern = SF_PATTERN_SOBOL;
    options.scramble = SF_SCRAMBLE_DEFAULT;
    options.dims = 2;
    options.threads = 1;
    return options;
}

static sf_status check_scramble(sf_pattern pattern, sf_scramble scramble, sf_error *error) {
    const char *name = sf_scramble_name(scramble);
    if (name && sf_pattern_takes_scramble(pattern, scramble)) return SF_STATUS_OK;
    char taken[128] = "";
    for (int s = SF_SCRAMBLE_NONE, length = 0; s < SF_SCRAMBLE_COUNT; ++s)
        if (sf_pattern_takes_scramble(pattern, (sf_scramble)s))
            length +=
                snprintf(taken + length, sizeof taken - (size_t)length, "%s%s", length ? ", " : "", scrambles[s].name);
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "scramble is %s; %s takes: %s", name ? name : "unknown",
                   methods[pattern].name, taken);
}

/* Padded sets need a scramble that gives each set an order and keys of its own. */
static sf_status check_pad(const sf_points_options *options, sf_error *error) {
    if (options->pad == 0) return SF_STATUS_OK;
    if (options->pad != 2 && options->pad != 4)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "pad is %" PRIu32 "; it is 0, 2 or 4", options->pad);
    const sf_pattern_method *method = &methods[options->pattern];
    if (options->pattern != SF_PATTERN_SOBOL && options->pattern != SF_PATTERN_SZ)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "pad is %" PRIu32 ", which sobol and sz take, and %s does not",
                       options->pad, method->name);
    sf_scramble scramble = options->scramble ? options->scramble : method->default_scramble;
    if (scramble == SF_SCRAMBLE_OWEN || scramble == SF_SCRAMBLE_NESTED) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "pad is %" PRIu32 ", which takes scramble owen or nested, not %s",
                   options->pad, sf_scramble_name(scramble));
}

sf_status sf_points_check_range(const sf_points_options *options, uint64_t first, uint64_t count, sf_error *error) {
    const sf_pattern_method *method = &methods[options->pattern];
    uint64_t most = method->max_count;
    if (first > most || count > most - first)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "points %" PRIu64 " and %" PRIu64 " more are asked for; %s has %" PRIu64, first, count,
                       method->name, most);
    if (method->needs_total && options->total == 0 && count)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s needs its total ahead; give `total`", method->name);
    if (options->total && (first > options->total || count > options->total - first))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "points %" PRIu64 " and %" PRIu64 " more are asked for, of a total of %" PRIu64, first, count,
                       options->total);
    return SF_STATUS_OK;
}

sf_status sf_points_complete(sf_points_options *options, uint64_t count, sf_error *error) {
    sf_status status = sf_points_check_dims(options, error);
    if (status != SF_STATUS_OK) return status;
    if (sf_pattern_needs_total(options->pattern) && options->total == 0 && options->first <= UINT64_MAX - count)
        options->total = options->first + count;
    return sf_points_check_range(options, options->first, count, error);
}

/* ---- sets ---- */

void sf_point_set_release(sf_point_set *set) {
    sf_aligned_free(set->sides);
    sf_net_release(set->net);
    sf_pad_release(set->padded);
    sf_aligned_free(set->block);
    sf_halton_release(set->halton, set->options.dims);
}

sf_status sf_point_set_init(sf_point_set *set, const sf_points_options *options, sf_error *error) {
    memset(set, 0, sizeof *set);
    sf_status status = sf_points_check_dims(options, error);
    if (status == SF_STATUS_OK) status = check_scramble(options->pattern, options->scramble, error);
    if (status == SF_STATUS_OK) status = check_pad(options, error);
    if (status != SF_STATUS_OK) return status;
    set->method = &methods[options->pattern];
    if (set->method->needs_total && options->total > set->method->max_count)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "total is %" PRIu64 "; %s has up to %" PRIu64 " points",
                       options->total, set->method->name, set->method->max_count);
    set->options = *options;
    if (options->scramble == SF_SCRAMBLE_DEFAULT) set->options.scramble = set->method->default_scramble;
    if (!set->method->prepare || (set->method->needs_total && !options->total)) return SF_STATUS_OK;
    status = options->pad ? sf_pad_prepare(set, error) : set->method->prepare(set, error);
    if (status != SF_STATUS_OK) sf_point_set_release(set);
    return status;
}

sf_status sf_point_set_create(const sf_points_options *options, sf_point_set **set, sf_error *error) {
    *set = NULL;
    sf_point_set *fresh = sf_aligned_alloc(sizeof *fresh);
    if (!fresh) return sf_fail_memory(error, "a point set", sizeof *fresh);
    sf_status status = sf_point_set_init(fresh, options, error);
    if (status == SF_STATUS_OK)
        *set = fresh;
    else
        sf_aligned_free(fresh);
    return status;
}

void sf_point_set_destroy(sf_point_set *set) {
    if (!set) return;
    sf_point_set_release(set);
    sf_aligned_free(set);
}
