// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The mappings' contract: round trips, edges of the unit square, the same bits on every level,
 * refusals. Their densities are tested in test_mapping_density.c. */

#define _POSIX_C_SOURCE 200112L /* setenv */

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "mapping/mapping_kernels.h"
#include "mapping_cases.h"

#define COUNT 1000 /* no multiple of a block */

static void fill_unit(float *u, size_t count, uint64_t seed) {
    for (size_t i = 0; i < count; ++i) u[i] = sf_float_from_bits((uint32_t)(sf_hash64(seed, i) >> 32));
}

/* ---- round trips ---- */

/* The distance from the mirrored w to the normal's cap point in the space of roughness 1, and the
 * distance of that from its axis: what a GGX normal is divided by. */
static void ggx_lengths(const mapping_case *c, const double *u, double *sum, double *ring) {
    const double *p = c->parameters;
    double x = p[0] * p[3], y = p[1] * p[4], z = p[2] / sqrt(x * x + y * y + p[2] * p[2]);
    double depth = u[1] * (1.0 + z), across = sqrt(1.0 - z * z);
    *ring = sqrt(depth * (2.0 - depth));
    double cx = *ring * cos(TURN * u[0]), cy = *ring * sin(TURN * u[0]),
           scale = across > 0.0 ? across / hypot(x, y) : 0.0;
    *sum = sqrt((cx + x * scale) * (cx + x * scale) + (cy + y * scale) * (cy + y * scale) +
                (1.0 - depth + z) * (1.0 - depth + z));
}

/* How far a round trip may move u, in units of the type's epsilon (2^-24, 2^-53): x is rounded by
 * about one unit of its own size, and this is multiplied by how steeply u changes with x. */
static void allowed_error(const mapping_case *c, const double *u, double allowed[2]) {
    double loss = c->loss > 0.0 ? c->loss : 1.0, sum, ring;
    allowed[0] = allowed[1] = 8.0 * loss;
    switch (c->mapping) {
        case SF_MAPPING_PIXEL_GAUSSIAN:
        case SF_MAPPING_PIXEL_GAUSSIAN_TRUNCATED: {
            /* x = 1/2 + a: rounded by 3 units of max(1/2, a); ds = 2 pi r a' da, dt = da / (2 pi a). */
            double share = c->mapping == SF_MAPPING_PIXEL_GAUSSIAN
                               ? 1.0
                               : -expm1(-0.5 * pow(c->parameters[1] / c->parameters[0], 2));
            double r = sqrt(-2.0 * log1p(-u[0] * share)), a = c->parameters[0] * r, rounding = 3.0 * (0.5 + a);
            allowed[0] += rounding / c->parameters[0] / share;
            allowed[1] += rounding / (TURN * a + 1e-30);
            break;
        }
        case SF_MAPPING_TRIANGLE:
            /* The vertices reach 2.5, so that alpha and beta are known to some 20 units; t is
             * alpha / sqrt(s). */
            allowed[0] += 40.0;
            allowed[1] += 40.0 / (sqrt(u[0]) + 1e-30);
            break;
        case SF_MAPPING_TRIANGLE_LOW_DISTORTION:
        case SF_MAPPING_PARALLELOGRAM: allowed[0] = allowed[1] = 80.0; break;
        case SF_MAPPING_REGULAR_POLYGON:
            /* s is the place across, a share of the radius sqrt(t). */
            allowed[0] += 4.0 / (sqrt(u[1]) + 1e-30);
            break;
        case SF_MAPPING_GGX_VISIBLE_NORMALS:
            /* h is the sum of two directions, and known to 4 units over its length; mirroring w
             * about it doubles that; s is an angle about the axis, t the depth. */
            ggx_lengths(c, u, &sum, &ring);
            allowed[0] += 16.0 / (sum * ring + 1e-30);
            allowed[1] += 16.0 / (sum + 1e-30);
            break;
        case SF_MAPPING_SPHERICAL_TRIANGLE:
            /* s is the place of an arc from b, t the share of it: sqrt(t) of its length away. */
            allowed[0] /= sqrt(u[1]) + 1e-30;
            break;
        default: break;
    }
}

/* Whether 0 and 1 are the same place of u[k]. */
static int is_angle(sf_mapping mapping, int k) {
    switch (mapping) {
        case SF_MAPPING_PIXEL_GAUSSIAN:
        case SF_MAPPING_PIXEL_GAUSSIAN_TRUNCATED: return k == 1;
        case SF_MAPPING_DISK_POLAR:
        case SF_MAPPING_DISK_NAIVE:
        case SF_MAPPING_ANNULUS:
        case SF_MAPPING_REGULAR_POLYGON:
        case SF_MAPPING_SPHERE:
        case SF_MAPPING_HEMISPHERE:
        case SF_MAPPING_COSINE_HEMISPHERE:
        case SF_MAPPING_CONE:
        case SF_MAPPING_POWER_COSINE:
        case SF_MAPPING_HENYEY_GREENSTEIN:
        case SF_MAPPING_GGX_VISIBLE_NORMALS: return k == 0;
        default: return 0;
    }
}

static void expect_round_trip(const mapping_case *c, const double *u, const double *back, double epsilon) {
    double allowed[2];
    allowed_error(c, u, allowed);
    for (int k = 0; k < 2; ++k) {
        double error = fabs(back[k] - u[k]);
        if (is_angle(c->mapping, k) && error > 0.5) error = 1.0 - error;
        if (!(error <= allowed[k] * epsilon) || !(back[k] >= 0.0 && back[k] < 1.0))
            fail_msg("%s (case %zu): u = (%.17g, %.17g) comes back as (%.17g, %.17g), %.1f units off, allowed %.1f",
                     sf_mapping_name(c->mapping), (size_t)(c - mapping_cases), u[0], u[1], back[0], back[1],
                     error / epsilon, allowed[k]);
    }
}

static void test_floats_come_back_within_stated_units(void **state) {
    (void)state;
    static float u[2 * 65536], x[3 * 65536], back[2 * 65536];
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        const mapping_case *c = &mapping_cases[i];
        case_parameters p;
        case_parameters_init(&p, c);
        fill_unit(u, 2 * 65536, i);
        assert_int_equal(sf_mapping_sample_fill_f32(c->mapping, 65536, u, p.f32_at, NULL, x, NULL), SF_STATUS_OK);
        assert_int_equal(sf_mapping_invert_fill_f32(c->mapping, 65536, x, p.f32_at, NULL, back, NULL), SF_STATUS_OK);
        for (size_t k = 0; k < 65536; ++k) {
            double given[2] = {(double)u[2 * k], (double)u[2 * k + 1]},
                   got[2] = {(double)back[2 * k], (double)back[2 * k + 1]};
            expect_round_trip(c, given, got, 0x1p-24);
        }
    }
}

static void test_doubles_come_back_within_stated_units(void **state) {
    (void)state;
    static double u[2 * 65536], x[3 * 65536], back[2 * 65536];
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        const mapping_case *c = &mapping_cases[i];
        case_parameters p;
        case_parameters_init(&p, c);
        for (size_t k = 0; k < 2 * 65536; ++k) u[k] = sf_double_from_bits(sf_hash64(i, k));
        assert_int_equal(sf_mapping_sample_fill_f64(c->mapping, 65536, u, p.f64_at, NULL, x, NULL), SF_STATUS_OK);
        assert_int_equal(sf_mapping_invert_fill_f64(c->mapping, 65536, x, p.f64_at, NULL, back, NULL), SF_STATUS_OK);
        for (size_t k = 0; k < 65536; ++k) expect_round_trip(c, u + 2 * k, back + 2 * k, 0x1p-53);
    }
}

static void test_floats_are_the_doubles_rounded(void **state) {
    (void)state;
    static float u[2 * COUNT], x[3 * COUNT];
    static double wide_u[2 * COUNT], wide_x[3][3 * COUNT];
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        const mapping_case *c = &mapping_cases[i];
        size_t width = sf_mapping_output_width(c->mapping);
        case_parameters p;
        case_parameters_init(&p, c);
        fill_unit(u, 2 * COUNT, 77 + i);
        sf_mapping_sample_fill_f32(c->mapping, COUNT, u, p.f32_at, NULL, x, NULL);
        for (int shift = 0; shift < 3; ++shift) {
            for (size_t k = 0; k < 2 * COUNT; ++k)
                wide_u[k] = fmin(fmax((double)u[k] + (shift - 1) * 2.0 * 0x1p-24, 0.0), SF_UNIT_MAX);
            sf_mapping_sample_fill_f64(c->mapping, COUNT, wide_u, p.f64_at, NULL, wide_x[shift], NULL);
        }
        /* Every formula ends within 8 units of the size of the shape, at most 10, and of what two
         * units of u move the sample; a GGX normal is a sum of directions, over its length. */
        for (size_t k = 0; k < width * COUNT; ++k) {
            double error = fabs((double)x[k] - wide_x[1][k]), moved = fabs(wide_x[2][k] - wide_x[0][k]);
            double given[2] = {(double)u[k / width * 2], (double)u[k / width * 2 + 1]}, sum = 1.0, ring;
            if (c->mapping == SF_MAPPING_GGX_VISIBLE_NORMALS) ggx_lengths(c, given, &sum, &ring);
            if (!(error <= 8.0 * 0x1p-24 * fmax(1.0, fabs(wide_x[1][k])) / sum + moved))
                fail_msg("%s (case %zu): %.9g and %.17g", sf_mapping_name(c->mapping), i, (double)x[k], wide_x[1][k]);
        }
    }
}

/* ---- the edges of the unit square ---- */

/* Whether the density at the sample of u is a documented zero or pole. */
static int is_documented(sf_mapping mapping, const float *u, float pdf) {
    switch (mapping) {
        case SF_MAPPING_PIXEL_TENT: return pdf == 0.0f && (u[0] < 0x1p-51f || u[1] < 0x1p-51f);
        case SF_MAPPING_PIXEL_MITCHELL:
        case SF_MAPPING_PIXEL_LANCZOS: return pdf == 0.0f && (u[0] < 0x1p-64f || u[1] < 0x1p-64f);
        case SF_MAPPING_COSINE_HEMISPHERE: return pdf == 0.0f && u[1] == 0.0f;
        case SF_MAPPING_COSINE_HEMISPHERE_CONCENTRIC: return pdf == 0.0f && (u[0] == 0.0f || u[1] == 0.0f);
        case SF_MAPPING_GGX_VISIBLE_NORMALS: return pdf == 0.0f && u[1] == SF_UNIT_MAX_F;
        case SF_MAPPING_DISK_NAIVE: return isinf(pdf) && u[1] < 0x1p-60f;
        default: return 0;
    }
}

static void test_every_u_gives_a_finite_sample_of_positive_density(void **state) {
    (void)state;
    const float edges[] = {0.0f,     0x1p-149f,       0x1p-126f,       0x1p-100f,       0x1p-52f,     0x1p-40f,
                           0x1p-24f, 0x1p-12f,        0.125f,          0.25f,           0.375f,       0.5f,
                           0.75f,    0.5f - 0x1p-25f, 0.5f + 0x1p-24f, 1.0f - 0x1p-12f, SF_UNIT_MAX_F};
    enum { EDGES = sizeof edges / sizeof *edges };
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        const mapping_case *c = &mapping_cases[i];
        size_t width = sf_mapping_output_width(c->mapping);
        case_parameters p;
        case_parameters_init(&p, c);
        for (int a = 0; a < EDGES; ++a)
            for (int b = 0; b < EDGES; ++b) {
                float u[2] = {edges[a], edges[b]}, x[3], pdf, back[2];
                assert_int_equal(sf_mapping_sample_fill_f32(c->mapping, 1, u, p.f32_at, NULL, x, NULL), SF_STATUS_OK);
                for (size_t k = 0; k < width; ++k) assert_true(isfinite(x[k]));
                sf_mapping_pdf_fill_f32(c->mapping, 1, x, p.f32_at, NULL, &pdf, NULL);
                if (!(pdf > 0.0f && pdf < (float)INFINITY) && !is_documented(c->mapping, u, pdf))
                    fail_msg("%s: pdf %g at u = (%a, %a)", sf_mapping_name(c->mapping), (double)pdf, (double)u[0],
                             (double)u[1]);
                sf_mapping_invert_fill_f32(c->mapping, 1, x, p.f32_at, NULL, back, NULL);
                assert_true(back[0] >= 0.0f && back[0] < 1.0f && back[1] >= 0.0f && back[1] < 1.0f);
            }
    }
}

static void test_directions_have_length_one(void **state) {
    (void)state;
    float u[2 * COUNT], x[3 * COUNT];
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        if (!is_direction(&mapping_cases[i])) continue;
        case_parameters p;
        case_parameters_init(&p, &mapping_cases[i]);
        fill_unit(u, 2 * COUNT, i);
        sf_mapping_sample_fill_f32(mapping_cases[i].mapping, COUNT, u, p.f32_at, NULL, x, NULL);
        for (int k = 0; k < COUNT; ++k) {
            double square = 0.0;
            for (int j = 0; j < 3; ++j) square += (double)x[3 * k + j] * (double)x[3 * k + j];
            if (!(fabs(sqrt(square) - 1.0) <= 2.0 * 0x1p-23))
                fail_msg("%s (case %zu): length 1 + %g", sf_mapping_name(mapping_cases[i].mapping), i,
                         sqrt(square) - 1.0);
        }
    }
}

static void test_the_inverse_of_any_point_lies_in_the_unit_square(void **state) {
    (void)state;
    const float values[] = {-1e30f, -3.0f, -1.0f, -0.0f, 0.0f, 1e-30f, 0.5f, 1.0f, 2.0f, 1e30f};
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        case_parameters p;
        case_parameters_init(&p, &mapping_cases[i]);
        for (int k = 0; k < 1000; ++k) {
            float x[3] = {values[k % 10], values[k / 10 % 10], values[k / 100]}, u[2];
            assert_int_equal(sf_mapping_invert_fill_f32(mapping_cases[i].mapping, 1, x, p.f32_at, NULL, u, NULL),
                             SF_STATUS_OK);
            if (!(u[0] >= 0.0f && u[0] < 1.0f && u[1] >= 0.0f && u[1] < 1.0f))
                fail_msg("%s: (%g, %g, %g) gives (%g, %g)", sf_mapping_name(mapping_cases[i].mapping), (double)x[0],
                         (double)x[1], (double)x[2], (double)u[0], (double)u[1]);
        }
    }
}

/* ---- single facts of the lecture ---- */

static void test_the_lectures_formulas_hold(void **state) {
    (void)state;
    float x[3];
    const float a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0};
    sf_pixel_tent_sample(0.125f, 0.875f, x);
    assert_true(x[0] == 0.0f && x[1] == 1.0f); /* -1/2 + sqrt(1/4), 3/2 - sqrt(1/4) */
    sf_pixel_gaussian_sample(0.0f, 0.3f, 0.4f, x);
    assert_true(x[0] == 0.5f && x[1] == 0.5f);
    sf_pixel_gaussian_sample(1.0f - expf(-0.5f), 0.25f, 0.4f, x);
    assert_true(fabsf(x[0] - 0.9f) < 1e-6f && fabsf(x[1] - 0.5f) < 1e-6f); /* one sigma, to the right */
    sf_triangle_sample(0.25f, 0.5f, a, b, c, x);
    assert_true(x[0] == 0.25f && x[1] == 0.5f && x[2] == 0.0f);
    sf_disk_polar_sample(0.25f, 0.25f, x);
    assert_true(x[0] == 0.0f && x[1] == 0.5f);
    sf_sphere_sample(0.0f, 0.5f, x);
    assert_true(x[0] == 1.0f && x[1] == 0.0f && x[2] == 0.0f);
    sf_hemisphere_sample(0.5f, 0.0f, x);
    assert_true(x[0] == -1.0f && x[2] == 0.0f);
    sf_cosine_hemisphere_sample(0.0f, 0.25f, x);
    assert_true(x[2] == 0.5f && fabsf(x[0] - sqrtf(0.75f)) < 1e-7f);
}

static void test_concentric_squares_go_to_concentric_circles(void **state) {
    (void)state;
    for (int i = 0; i < 4096; ++i) {
        float s = (float)(i % 64) / 64.0f, t = (float)(i / 64) / 64.0f, x[2];
        double square = fmax(fabs(2.0 * (double)s - 1.0), fabs(2.0 * (double)t - 1.0));
        sf_disk_concentric_sample(s, t, x);
        assert_true(fabs(sqrt((double)x[0] * (double)x[0] + (double)x[1] * (double)x[1]) - square) < 4.0 * 0x1p-24);
    }
}

static void test_a_frame_is_orthonormal_and_right_handed_at_and_near_both_poles(void **state) {
    (void)state;
    for (int i = 0; i < 20000; ++i) {
        float n[3], t[3], b[3], cross[3];
        float step = ldexpf(1.0f, -(i % 40)), z = i % 2 ? 1.0f : -1.0f;
        if (i < 10000) {
            sf_sphere_sample(sf_float_from_bits((uint32_t)sf_mix64((uint64_t)i + 1)), (float)(i % 100) / 100.0f, n);
        } else {
            /* Beside a pole by 1 .. 2^-39; zeros of both signs. */
            n[0] = i % 3 ? step : 0.0f;
            n[1] = i % 5 ? -0.5f * step : -0.0f;
            float length = sqrtf(n[0] * n[0] + n[1] * n[1] + 1.0f);
            n[0] /= length;
            n[1] /= length;
            n[2] = z / length;
        }
        sf_frame_from_normal(n, t, b);
        sf_cross3(t, b, cross);
        float worst = fabsf(sf_dot3(t, t) - 1.0f) + fabsf(sf_dot3(b, b) - 1.0f) + fabsf(sf_dot3(t, b)) +
                      fabsf(sf_dot3(t, n)) + fabsf(sf_dot3(b, n));
        for (int k = 0; k < 3; ++k) worst = fmaxf(worst, fabsf(cross[k] - n[k]));
        if (!(worst < 3e-6f))
            fail_msg("off by %g at (%g, %g, %g)", (double)worst, (double)n[0], (double)n[1], (double)n[2]);
        float world[3];
        const float pole[3] = {0.0f, 0.0f, 1.0f};
        sf_frame_to_world(t, b, n, pole, world);
        assert_true(world[0] == n[0] && world[1] == n[1] && world[2] == n[2]);
    }
}

/* ---- bulk ---- */

static void test_every_level_gives_the_same_bits(void **state) {
    (void)state;
    float u[2 * COUNT], x[3 * COUNT], expected[3][3 * COUNT], got[3 * COUNT];
    double wu[2 * COUNT], wx[3 * COUNT], wide_expected[3][3 * COUNT], wide_got[3 * COUNT];
    const char *levels[] = {"baseline", "avx2", "avx512"};
    for (size_t i = 0; i < CASE_COUNT; ++i) {
        const mapping_case *c = &mapping_cases[i];
        case_parameters p;
        case_parameters_init(&p, c);
        fill_unit(u, 2 * COUNT, i);
        for (size_t k = 0; k < 2 * COUNT; ++k) wu[k] = sf_double_from_bits(sf_hash64(i, k));
        for (int level = 0; level < 3; ++level) {
            setenv("SUNFLECK_ISA", levels[level], 1);
            memset(got, 0, sizeof got);
            memset(wide_got, 0, sizeof wide_got);
            for (int verb = 0; verb < 3; ++verb) {
                if (verb == 0) {
                    sf_mapping_sample_fill_f32(c->mapping, COUNT, u, p.f32_at, NULL, got, NULL);
                    sf_mapping_sample_fill_f64(c->mapping, COUNT, wu, p.f64_at, NULL, wide_got, NULL);
                } else if (verb == 1) {
                    sf_mapping_pdf_fill_f32(c->mapping, COUNT, x, p.f32_at, NULL, got, NULL);
                    sf_mapping_pdf_fill_f64(c->mapping, COUNT, wx, p.f64_at, NULL, wide_got, NULL);
                } else {
                    sf_mapping_invert_fill_f32(c->mapping, COUNT, x, p.f32_at, NULL, got, NULL);
                    sf_mapping_invert_fill_f64(c->mapping, COUNT, wx, p.f64_at, NULL, wide_got, NULL);
                }
                if (level == 0) {
                    memcpy(expected[verb], got, sizeof got);
                    memcpy(wide_expected[verb], wide_got, sizeof wide_got);
                }
                assert_memory_equal(got, expected[verb], sizeof got);
                assert_memory_equal(wide_got, wide_expected[verb], sizeof wide_got);
                if (verb == 0) {
                    memcpy(x, got, sizeof x);
                    memcpy(wx, wide_got, sizeof wx);
                }
            }
        }
        unsetenv("SUNFLECK_ISA");
    }
}

static void test_bulk_is_the_inline_function_bit_for_bit_at_every_length(void **state) {
    (void)state;
    float u[2 * 300], x[3 * 301];
    fill_unit(u, 600, 5);
    for (size_t count = 0; count <= 300; count += 7) {
        x[3 * count] = -7.0f;
        assert_int_equal(sf_mapping_sample_fill_f32(SF_MAPPING_COSINE_HEMISPHERE, count, u, NULL, NULL, x, NULL),
                         SF_STATUS_OK);
        assert_true(x[3 * count] == -7.0f); /* not a value past the end */
        for (size_t i = 0; i < count; ++i) {
            float w[3];
            sf_cosine_hemisphere_sample(u[2 * i], u[2 * i + 1], w);
            assert_memory_equal(w, x + 3 * i, sizeof w);
        }
    }
}

static void test_parameters_may_differ_from_point_to_point(void **state) {
    (void)state;
    float u[2 * COUNT], a[3 * COUNT], b[3 * COUNT], x[3 * COUNT], pdf[COUNT];
    const float c[3] = {0.0f, 0.0f, 3.0f}, *parameters[3] = {a, b, c};
    const size_t strides[3] = {3, 3, 0};
    fill_unit(u, 2 * COUNT, 1);
    fill_unit(a, 3 * COUNT, 2);
    fill_unit(b, 3 * COUNT, 3);
    assert_int_equal(sf_mapping_sample_fill_f32(SF_MAPPING_TRIANGLE, COUNT, u, parameters, strides, x, NULL),
                     SF_STATUS_OK);
    assert_int_equal(sf_mapping_pdf_fill_f32(SF_MAPPING_TRIANGLE, COUNT, x, parameters, strides, pdf, NULL),
                     SF_STATUS_OK);
    for (size_t i = 0; i < COUNT; ++i) {
        float point[3];
        sf_triangle_sample(u[2 * i], u[2 * i + 1], a + 3 * i, b + 3 * i, c, point);
        assert_memory_equal(point, x + 3 * i, sizeof point);
        assert_true(pdf[i] == sf_triangle_pdf(point, a + 3 * i, b + 3 * i, c));
    }
}

static void test_a_default_is_used_where_no_parameter_is_given(void **state) {
    (void)state;
    const float u[4] = {0.3f, 0.6f, 0.1f, 0.9f}, mu = 0.4f, *parameters[1] = {&mu}, *none[1] = {NULL};
    float given[4], left_out[4], null[4];
    sf_mapping_sample_fill_f32(SF_MAPPING_PIXEL_GAUSSIAN, 2, u, parameters, NULL, given, NULL);
    sf_mapping_sample_fill_f32(SF_MAPPING_PIXEL_GAUSSIAN, 2, u, NULL, NULL, left_out, NULL);
    sf_mapping_sample_fill_f32(SF_MAPPING_PIXEL_GAUSSIAN, 2, u, none, NULL, null, NULL);
    assert_memory_equal(given, left_out, sizeof given);
    assert_memory_equal(given, null, sizeof given);
}

static void test_a_triangle_without_area_has_samples_and_an_infinite_density(void **state) {
    (void)state;
    const float a[3] = {1, 2, 3}, b[3] = {2, 4, 6}, u[2] = {0.3f, 0.6f}, *parameters[3] = {a, b, b};
    float x[3], pdf, back[2];
    assert_int_equal(sf_mapping_sample_fill_f32(SF_MAPPING_TRIANGLE, 1, u, parameters, NULL, x, NULL), SF_STATUS_OK);
    assert_true(isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]));
    assert_int_equal(sf_mapping_pdf_fill_f32(SF_MAPPING_TRIANGLE, 1, x, parameters, NULL, &pdf, NULL), SF_STATUS_OK);
    assert_true(isinf(pdf));
    assert_int_equal(sf_mapping_invert_fill_f32(SF_MAPPING_TRIANGLE, 1, x, parameters, NULL, back, NULL), SF_STATUS_OK);
    assert_true(back[0] >= 0.0f && back[0] < 1.0f && back[1] >= 0.0f && back[1] < 1.0f);
}

/* ---- refusals ---- */

static void expect_refused(sf_status status, const sf_error *error, const char *text) {
    assert_int_equal(status, SF_STATUS_INVALID_VALUE);
    assert_int_equal(error->status, SF_STATUS_INVALID_VALUE);
    if (!strstr(error->message, text)) fail_msg("\"%s\" does not say \"%s\"", error->message, text);
}

static void test_u_outside_the_interval_is_refused_before_anything_is_written(void **state) {
    (void)state;
    const float wrong[] = {1.0f, -1e-30f, 2.0f, (float)NAN, (float)INFINITY};
    const char *shown[] = {"is 1;", "is -1", "is 2;", "nan;", "is inf;"};
    for (int i = 0; i < 5; ++i) {
        float u[2 * COUNT] = {0}, x[3 * COUNT];
        double wide[2 * COUNT] = {0}, wide_x[3 * COUNT];
        sf_error error;
        memset(x, 0x55, sizeof x);
        memset(wide_x, 0x55, sizeof wide_x);
        wide[2 * 637 + 1] = (double)(u[2 * 637 + 1] = wrong[i]);
        expect_refused(sf_mapping_sample_fill_f32(SF_MAPPING_SPHERE, COUNT, u, NULL, NULL, x, &error), &error,
                       "sphere: u[637][1]");
        expect_refused(SF_STATUS_INVALID_VALUE, &error, shown[i]);
        expect_refused(SF_STATUS_INVALID_VALUE, &error, "[0,1)");
        expect_refused(sf_mapping_sample_fill_f64(SF_MAPPING_SPHERE, COUNT, wide, NULL, NULL, wide_x, &error), &error,
                       "u[637][1]");
        for (size_t k = 0; k < sizeof x; ++k) assert_int_equal(((unsigned char *)x)[k], 0x55);
        for (size_t k = 0; k < sizeof wide_x; ++k) assert_int_equal(((unsigned char *)wide_x)[k], 0x55);
    }
}

static void test_points_that_are_not_finite_are_refused(void **state) {
    (void)state;
    float x[6] = {0, 0, 1, 0, (float)NAN, 1}, pdf[2], u[4];
    sf_error error;
    expect_refused(sf_mapping_pdf_fill_f32(SF_MAPPING_SPHERE, 2, x, NULL, NULL, pdf, &error), &error, "x[1][1] is ");
    expect_refused(sf_mapping_invert_fill_f32(SF_MAPPING_SPHERE, 2, x, NULL, NULL, u, &error), &error, "finite");
}

static void test_parameters_out_of_range_are_refused_by_name(void **state) {
    (void)state;
    const float u[4] = {0}, zero = 0.0f, mus[2] = {0.4f, -1.0f}, *mu[1] = {&zero}, *each[1] = {mus};
    const size_t packed[1] = {1}, odd[1] = {2};
    float x[6];
    sf_error error;
    expect_refused(sf_mapping_sample_fill_f32(SF_MAPPING_PIXEL_GAUSSIAN, 2, u, mu, NULL, x, &error), &error,
                   "pixel_gaussian: mu is 0; it must be in [1e-6, 1e6]");
    expect_refused(sf_mapping_sample_fill_f32(SF_MAPPING_PIXEL_GAUSSIAN, 2, u, each, packed, x, &error), &error,
                   "mu[1][0] is -1;");
    expect_refused(sf_mapping_sample_fill_f32(SF_MAPPING_PIXEL_GAUSSIAN, 2, u, each, odd, x, &error), &error,
                   "stride of mu is 2");
    expect_refused(sf_mapping_sample_fill_f32(SF_MAPPING_TRIANGLE, 2, u, NULL, NULL, x, &error), &error,
                   "a is missing");
    expect_refused(sf_mapping_sample_fill_f32(SF_MAPPING_COUNT, 2, u, NULL, NULL, x, &error), &error, "mapping is");
    expect_refused(sf_mapping_sample_fill_f32((sf_mapping)-1, 2, u, NULL, NULL, x, &error), &error, "mapping is -1");
}

static void test_names_lead_back_to_their_mappings(void **state) {
    (void)state;
    sf_error error;
    sf_mapping found = SF_MAPPING_COUNT;
    for (int m = 0; m < SF_MAPPING_COUNT; ++m) {
        assert_int_equal(sf_mapping_find(sf_mapping_name((sf_mapping)m), &found, &error), SF_STATUS_OK);
        assert_int_equal(found, m);
        assert_non_null(sf_mapping_description((sf_mapping)m));
        assert_int_equal(sf_mapping_input_width((sf_mapping)m), 2);
        assert_in_range(sf_mapping_output_width((sf_mapping)m), 2, 3);
        assert_in_range(sf_mapping_parameter_count((sf_mapping)m), 0, SF_MAPPING_MAX_PARAMETERS);
        for (size_t k = 0; k < sf_mapping_parameter_count((sf_mapping)m); ++k)
            assert_non_null(sf_mapping_parameter_at((sf_mapping)m, k).range);
    }
    assert_null(sf_mapping_name(SF_MAPPING_COUNT));
    assert_null(sf_mapping_description(SF_MAPPING_COUNT));
    assert_int_equal(sf_mapping_output_width(SF_MAPPING_COUNT), 0);
    expect_refused(sf_mapping_find("disc", &found, &error), &error, "disk_polar");
    expect_refused(sf_mapping_find(NULL, &found, &error), &error, "choose one of");
}

static void test_every_mapping_has_a_case(void **state) {
    (void)state;
    for (int m = 0; m < SF_MAPPING_COUNT; ++m) {
        int cases = 0;
        for (size_t i = 0; i < CASE_COUNT; ++i) cases += mapping_cases[i].mapping == (sf_mapping)m;
        if (!cases) fail_msg("no case of %s", sf_mapping_name((sf_mapping)m));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_floats_come_back_within_stated_units),
        cmocka_unit_test(test_doubles_come_back_within_stated_units),
        cmocka_unit_test(test_floats_are_the_doubles_rounded),
        cmocka_unit_test(test_every_u_gives_a_finite_sample_of_positive_density),
        cmocka_unit_test(test_directions_have_length_one),
        cmocka_unit_test(test_the_inverse_of_any_point_lies_in_the_unit_square),
        cmocka_unit_test(test_the_lectures_formulas_hold),
        cmocka_unit_test(test_concentric_squares_go_to_concentric_circles),
        cmocka_unit_test(test_a_frame_is_orthonormal_and_right_handed_at_and_near_both_poles),
        cmocka_unit_test(test_every_level_gives_the_same_bits),
        cmocka_unit_test(test_bulk_is_the_inline_function_bit_for_bit_at_every_length),
        cmocka_unit_test(test_parameters_may_differ_from_point_to_point),
        cmocka_unit_test(test_a_default_is_used_where_no_parameter_is_given),
        cmocka_unit_test(test_a_triangle_without_area_has_samples_and_an_infinite_density),
        cmocka_unit_test(test_u_outside_the_interval_is_refused_before_anything_is_written),
        cmocka_unit_test(test_points_that_are_not_finite_are_refused),
        cmocka_unit_test(test_parameters_out_of_range_are_refused_by_name),
        cmocka_unit_test(test_names_lead_back_to_their_mappings),
        cmocka_unit_test(test_every_mapping_has_a_case),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
