// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Single facts about single shapes: known values, degenerate parameters, how much single precision
 * loses where a formula could, and the assertions of the inline functions. */

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#undef NDEBUG /* the inline functions of this file assert */
#include "mapping/mapping_f64.h"
#include "mapping_cases.h"

static float unit(uint64_t seed, uint64_t i) { return sf_float_from_bits((uint32_t)(sf_hash64(seed, i) >> 32)); }

/* Within +-1. */
static float signed_unit(uint64_t seed, uint64_t i) { return 2.0f * unit(seed, i) - 1.0f; }

static double off_one(const float w[3]) {
    double square = 0.0;
    for (int k = 0; k < 3; ++k) square += (double)w[k] * (double)w[k];
    return fabs(sqrt(square) - 1.0);
}

static double distance(const float *x, const double *y) {
    double square = 0.0;
    for (int k = 0; k < 3; ++k) square += ((double)x[k] - y[k]) * ((double)x[k] - y[k]);
    return sqrt(square);
}

static void expect_below(const char *what, double worst, double limit) {
    if (!(worst <= limit)) fail_msg("%s: %g, allowed %g", what, worst, limit);
}

/* ---- flat shapes ---- */

static void test_low_distortion_sends_the_diagonal_to_the_median(void **state) {
    (void)state;
    const float a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0};
    for (int i = 0; i < 256; ++i) {
        float s = (float)i / 256.0f, x[3];
        sf_triangle_low_distortion_sample(s, s, a, b, c, x);
        assert_true(x[0] == 0.5f * s && x[1] == 0.5f * s);
    }
    float x[3];
    sf_triangle_low_distortion_sample(0.5f, 0.0f, a, b, c, x);
    assert_true(x[0] == 0.5f && x[1] == 0.0f);
    sf_triangle_low_distortion_sample(0.25f, 0.75f, a, b, c, x); /* Heitz: (s/2, t - s/2) */
    assert_true(x[0] == 0.125f && x[1] == 0.625f);
}

static void test_a_polygon_is_filled_to_its_vertices_and_not_beyond(void **state) {
    (void)state;
    for (int sides = 3; sides <= 1024; sides = sides * 3 / 2 + 1)
        for (uint64_t i = 0; i < 1000; ++i) {
            float x[2], s = i == 0 ? SF_UNIT_MAX_F : unit(1, i), t = i < 2 ? SF_UNIT_MAX_F : unit(2, i);
            sf_regular_polygon_sample(s, t, (float)sides, x);
            assert_true(sf_regular_polygon_pdf(x, (float)sides) > 0.0f);
            assert_true(x[0] * x[0] + x[1] * x[1] <= 1.0f + 0x1p-21f);
        }
    const float square[2] = {0.49f, 0.49f}, outside[2] = {0.51f, 0.51f}; /* |x| + |y| < 1 */
    assert_true(fabsf(sf_regular_polygon_pdf(square, 4.0f) - 0.5f) < 1e-6f &&
                sf_regular_polygon_pdf(outside, 4.0f) == 0.0f);
}

static void test_an_annulus_may_be_a_disk_or_a_circle(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 1000; ++i) {
        float s = unit(1, i), t = unit(2, i), x[2], y[2];
        sf_annulus_sample(s, t, 0.0f, x);
        sf_disk_polar_sample(s, t, y);
        assert_true(x[0] == y[0] && x[1] == y[1]);
        sf_annulus_sample(s, t, 1.0f, x);
        assert_true(fabsf(sqrtf(x[0] * x[0] + x[1] * x[1]) - 1.0f) <= 0x1p-22f && isinf(sf_annulus_pdf(x, 1.0f)));
        sf_annulus_invert(x, 1.0f, y);
        assert_true(fabsf(y[0] - s) < 0x1p-20f && y[1] >= 0.0f && y[1] < 1.0f);
    }
}

static void test_flat_shapes_without_area_have_samples_and_an_infinite_density(void **state) {
    (void)state;
    const float a[3] = {1, 2, 3}, b[3] = {2, 4, 6};
    float x[3], u[2];
    sf_triangle_low_distortion_sample(0.3f, 0.6f, a, b, b, x);
    assert_true(isfinite(x[0]) && isinf(sf_triangle_low_distortion_pdf(x, a, b, b)));
    sf_triangle_low_distortion_invert(x, a, b, b, u);
    assert_true(u[0] >= 0.0f && u[0] < 1.0f && u[1] >= 0.0f && u[1] < 1.0f);
    sf_parallelogram_sample(0.3f, 0.6f, a, b, b, x);
    assert_true(isfinite(x[0]) && isinf(sf_parallelogram_pdf(x, a, b, b)));
}

/* ---- pixel filters ---- */

static void test_a_truncated_gaussian_stays_within_its_radius(void **state) {
    (void)state;
    const float radii[] = {0.01f, 0.5f, 1.5f, 100.0f};
    for (int r = 0; r < 4; ++r)
        for (uint64_t i = 0; i < 2000; ++i) {
            float x[2], s = i == 0 ? SF_UNIT_MAX_F : unit(3, i);
            sf_pixel_gaussian_truncated_sample(s, unit(4, i), 0.4f, radii[r], x);
            /* 1/2 + a cos is rounded by half an ulp of 1/2 or of the radius. */
            assert_true(hypot((double)x[0] - 0.5, (double)x[1] - 0.5) <= (double)radii[r] * (1.0 + 0x1p-21) + 0x1p-23);
            assert_true(sf_pixel_gaussian_truncated_pdf(x, 0.4f, radii[r]) > 0.0f);
        }
}

static void test_filters_are_symmetric_and_end_at_their_rim(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 2000; ++i) {
        float s = i == 0 ? 0x1p-24f : unit(5, i), mirrored = 1.0f - s, x[2], y[2];
        if (mirrored >= 1.0f) continue;
        for (int filter = 0; filter < 3; ++filter) {
            void (*sample[2])(float, float, float *) = {sf_pixel_mitchell_sample, sf_pixel_lanczos_sample};
            double radius = filter == 0 ? 2.0 : filter == 1 ? 3.0 : 1.5;
            if (filter < 2) {
                sample[filter](s, 0.5f, x);
                sample[filter](mirrored, 0.5f, y);
            } else {
                sf_pixel_blackman_harris_sample(s, 0.5f, 1.5f, x);
                sf_pixel_blackman_harris_sample(mirrored, 0.5f, 1.5f, y);
            }
            assert_true(fabs((double)x[0] - 0.5) <= radius);
            /* 1 - s rounds where s is small: then the two differ by what 2^-24 moves, at most by the
             * cube root of it near a double zero. */
            assert_true(fabs((double)x[0] + (double)y[0] - 1.0) <= (s > 0x1p-10f ? 1e-3 : 2e-2));
            assert_true(x[1] == 0.5f);
        }
    }
}

static void test_mitchell_and_lanczos_are_their_formulas(void **state) {
    (void)state;
    const double pi = SF_PI;
    for (int i = -400; i <= 400; ++i) {
        double x = i / 100.0, d = fabs(x), m = 0.0, l = 0.0;
        if (d < 1.0)
            m = (7.0 * d * d * d - 12.0 * d * d + 16.0 / 3.0) / 6.0;
        else if (d < 2.0)
            m = (-7.0 / 3.0 * d * d * d + 12.0 * d * d - 20.0 * d + 32.0 / 3.0) / 6.0;
        if (d == 0.0)
            l = 1.0;
        else if (d < 3.0)
            l = 3.0 * sin(pi * x) * sin(pi * x / 3.0) / (pi * pi * x * x);
        assert_true(fabs((double)sf_mitchell((float)x + 0.5f) - m) < 1e-6);
        assert_true(fabs((double)sf_lanczos((float)x + 0.5f) - l) < 1e-6);
        assert_true(fabs(sf_mitchell_f64(x + 0.5) - m) < 1e-14 && fabs(sf_lanczos_f64(x + 0.5) - l) < 1e-14);
    }
}

/* ---- directions ---- */

static void test_a_cone_may_be_a_direction_or_the_sphere(void **state) {
    (void)state;
    const float pi = 3.14159265f;
    for (uint64_t i = 0; i < 1000; ++i) {
        float s = unit(1, i), t = unit(2, i), w[3], v[3], u[2];
        sf_cone_sample(s, t, 0.0f, w);
        assert_true(w[0] == 0.0f && w[1] == 0.0f && w[2] == 1.0f && isinf(sf_cone_pdf(w, 0.0f)));
        sf_cone_invert(w, 0.0f, u);
        assert_true(u[0] == 0.0f && u[1] == 0.0f);
        sf_cone_sample(s, t, pi, w);
        sf_sphere_sample(s, t, v);
        for (int k = 0; k < 3; ++k) assert_true(fabsf(w[k] - v[k]) <= 0x1p-22f);
        assert_true(fabsf(sf_cone_pdf(w, pi) * 4.0f * pi - 1.0f) < 1e-6f);
        /* The sun: 0.0093 across. */
        sf_cone_sample(s, t, 0.00465f, w);
        assert_true(hypotf(w[0], w[1]) <= 0.00465f && off_one(w) < 0x1p-22);
        assert_true(sf_cone_pdf(w, 0.00465f) > 0.0f);
    }
}

static void test_the_height_of_a_cone_is_good_to_4_ulp(void **state) {
    (void)state;
    double worst = 0.0, worst_sphere = 0.0;
    for (uint64_t i = 1; i < 100000; ++i) {
        float angle = (float)SF_PI * ldexpf(unit(9, i) + 0.001f, -(int)(i % 30));
        if (angle > (float)SF_PI) continue;
        double exact = 2.0 * pow(sin(0.5 * (double)angle), 2.0);
        worst = fmax(worst, fabs((double)sf_cone_height(angle) / exact - 1.0));
        float radius = unit(10, i) + 1e-6f, far = radius * (1.0f + 100.0f * unit(11, i));
        double sine = (double)radius / (double)far, height = sine * sine / (1.0 + sqrt(1.0 - sine * sine));
        /* From the side of a sphere sqrt(1 - sine) loses what the quotient was rounded by. */
        if (sine < 0.99)
            worst_sphere = fmax(worst_sphere, fabs((double)sf_cone_height_of_sphere(radius, far) / height - 1.0));
    }
    expect_below("height", worst, 8.0 * 0x1p-24);
    expect_below("height of a sphere", worst_sphere, 16.0 * 0x1p-24);
}

static void test_henyey_greenstein_is_the_sphere_at_0_and_mirrored_for_negative_g(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 2000; ++i) {
        float s = unit(1, i), t = unit(2, i), w[3], v[3];
        sf_henyey_greenstein_sample(s, t, 0.0f, w);
        sf_sphere_sample(s, t, v);
        for (int k = 0; k < 3; ++k) assert_true(fabsf(w[k] - v[k]) <= 0x1p-22f);
        if (t == 0.0f) continue;
        sf_henyey_greenstein_sample(s, t, 0.999f, w);
        sf_henyey_greenstein_sample(s, 1.0f - t, -0.999f, v);
        /* 1 - t rounds by 2^-25, which the narrow lobe's tail stretches. */
        assert_true(fabsf(w[2] + v[2]) <= 2e-4f && off_one(w) <= 0x1p-22 && off_one(v) <= 0x1p-22);
    }
    const float forward[3] = {0, 0, 1}, back[3] = {0, 0, -1};
    /* (1 - g^2) / (4 pi (1 -+ g)^3). */
    assert_true(fabsf(sf_henyey_greenstein_pdf(forward, 0.5f) - 0.75f / (4.0f * SF_PI_F * 0.125f)) < 1e-5f);
    assert_true(fabsf(sf_henyey_greenstein_pdf(back, 0.5f) - 0.75f / (4.0f * SF_PI_F * 3.375f)) < 1e-7f);
}

static void test_the_mean_cosine_of_henyey_greenstein_is_g(void **state) {
    (void)state;
    const double means[] = {-0.999, -0.5, 0.0, 0.3, 0.999};
    for (int m = 0; m < 5; ++m) {
        double sum = 0.0, w[3];
        enum { N = 100000 };
        for (int i = 0; i < N; ++i) {
            sf_henyey_greenstein_sample_f64(0.0, (i + 0.5) / N, means[m], w);
            sum += w[2];
        }
        /* Midpoints: the steepest integrand, that of 0.999, falls by 2 within 10^-3 of t. */
        expect_below("mean cosine", fabs(sum / N - means[m]), 1e-5);
    }
}

static void test_a_power_of_0_is_uniform_and_of_1_the_cosine(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 2000; ++i) {
        float s = unit(1, i), t = unit(2, i), w[3];
        sf_power_cosine_sample(s, t, 0.0f, w);
        assert_true(fabsf(w[2] - (1.0f - t)) <= 0x1p-22f &&
                    fabs((double)sf_power_cosine_pdf(w, 0.0f) * TURN - 1.0) < 1e-6);
        sf_power_cosine_sample(s, t, 1.0f, w);
        assert_true(fabsf(w[2] * w[2] - (1.0f - t)) <= 0x1p-21f);
        assert_true(fabsf(sf_power_cosine_pdf(w, 1.0f) - sf_cosine_hemisphere_pdf(w)) <= 1e-6f);
    }
}

static void test_visible_normals_seen_from_above_are_all_normals(void **state) {
    (void)state;
    const float up[3] = {0, 0, 1};
    for (uint64_t i = 0; i < 2000; ++i) {
        float h[3], alpha = 0.05f + unit(3, i);
        sf_ggx_visible_normals_sample(unit(1, i), unit(2, i), up, alpha, alpha, h);
        float expected = sf_ggx_normals(h, alpha, alpha) * h[2];
        assert_true(fabsf(sf_ggx_visible_normals_pdf(h, up, alpha, alpha) / expected - 1.0f) < 1e-5f);
        assert_true(sf_ggx_masking(up, alpha, alpha) == 1.0f);
    }
}

/* Smith's masking by Heitz 2014, eq. 72: 1 / (1 + lambda), lambda = (sqrt(1 + alpha^2 tan^2) - 1) / 2. */
static void test_masking_is_smiths(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 2000; ++i) {
        float w[3], v[3], alpha = 0.01f + unit(3, i);
        sf_hemisphere_sample(unit(1, i), 0.01f + 0.98f * unit(2, i), w);
        sf_hemisphere_sample(unit(4, i), 0.01f + 0.98f * unit(5, i), v);
        double lambda[2];
        for (int k = 0; k < 2; ++k) {
            double z = (double)(k ? v : w)[2], tan2 = (1.0 - z * z) / (z * z);
            lambda[k] = 0.5 * (sqrt(1.0 + (double)alpha * (double)alpha * tan2) - 1.0);
        }
        assert_true(fabs((double)sf_ggx_masking(w, alpha, alpha) * (1.0 + lambda[0]) - 1.0) < 1e-5);
        assert_true(fabs((double)sf_ggx_masking_shadowing(w, v, alpha, alpha) * (1.0 + lambda[0] + lambda[1]) - 1.0) <
                    1e-5);
    }
    const float horizon[3] = {1, 0, 0};
    assert_true(sf_ggx_masking(horizon, 0.5f, 0.5f) == 0.0f);
}

static void test_ggx_terms_in_bulk_are_the_inline_functions(void **state) {
    (void)state;
    enum { COUNT = 77 };
    float w[3 * COUNT], v[3 * COUNT], alpha[COUNT], masking[COUNT], both[COUNT], normals[COUNT];
    const size_t each[3] = {3, 1, 1};
    for (size_t i = 0; i < COUNT; ++i) {
        sf_sphere_sample(unit(1, i), unit(2, i), w + 3 * i);
        sf_sphere_sample(unit(4, i), unit(5, i), v + 3 * i);
        alpha[i] = 0.01f + unit(3, i);
    }
    const float one_alpha = 0.5f;
    sf_error error;
    assert_int_equal(sf_ggx_fill_f32(SF_GGX_MASKING_SHADOWING, COUNT, w, v, alpha, alpha, each, both, &error),
                     SF_STATUS_OK);
    assert_int_equal(sf_ggx_fill_f32(SF_GGX_MASKING, COUNT, w, NULL, alpha, alpha, each, masking, &error),
                     SF_STATUS_OK);
    assert_int_equal(sf_ggx_fill_f32(SF_GGX_NORMALS, COUNT, w, NULL, &one_alpha, &one_alpha, NULL, normals, &error),
                     SF_STATUS_OK);
    for (size_t i = 0; i < COUNT; ++i) {
        assert_true(both[i] == sf_ggx_masking_shadowing(w + 3 * i, v + 3 * i, alpha[i], alpha[i]));
        assert_true(masking[i] == sf_ggx_masking(w + 3 * i, alpha[i], alpha[i]));
        assert_true(normals[i] == sf_ggx_normals(w + 3 * i, 0.5f, 0.5f));
    }
    w[3 * 5] = NAN;
    masking[0] = -1.0f;
    assert_int_equal(sf_ggx_fill_f32(SF_GGX_MASKING, COUNT, w, NULL, alpha, alpha, each, masking, &error),
                     SF_STATUS_INVALID_VALUE);
    assert_non_null(strstr(error.message, "w[5]"));
    assert_true(masking[0] == -1.0f);
    const size_t odd[3] = {0, 2, 0};
    assert_int_equal(sf_ggx_fill_f32(SF_GGX_MASKING, 5, w, NULL, alpha, alpha, odd, masking, &error),
                     SF_STATUS_INVALID_VALUE);
}

/* ---- lights by solid angle ---- */

static const float nowhere[3] = {0, 0, 0};

static void test_known_solid_angles(void **state) {
    (void)state;
    const float x[3] = {2, 0, 0}, y[3] = {0, 5, 0}, z[3] = {0, 0, 0.5f};
    sf_spherical_triangle octant;
    sf_spherical_triangle_init(&octant, x, y, z, nowhere);
    assert_true(fabsf(octant.share - 0.125f) <= 0x1p-25f);
    const float a[3] = {-1, -1, 1}, b[3] = {1, -1, 1}, c[3] = {-1, 1, 1};
    sf_spherical_rectangle face;
    sf_spherical_rectangle_init(&face, a, b, c, nowhere);
    assert_true(fabsf(face.share - 1.0f / 6.0f) <= 0x1p-24f); /* of a cube */
    /* A small square: its area over the square of the distance, less terms of 1e-10. */
    const float d[3] = {-1e-5f, -1e-5f, 2}, e[3] = {1e-5f, -1e-5f, 2}, f[3] = {-1e-5f, 1e-5f, 2};
    sf_spherical_rectangle_init(&face, d, e, f, nowhere);
    assert_true(fabs((double)face.share * 2.0 * TURN / 1e-10 - 1.0) < 8.0 * 0x1p-24);
    sf_spherical_triangle_init(&octant, d, e, f, nowhere);
    assert_true(fabs((double)octant.share * 2.0 * TURN / 0.5e-10 - 1.0) < 8.0 * 0x1p-24);
}

/* A triangle or rectangle of that size in the plane z = height, with exact edges. */
static void random_light(uint64_t i, float size, float height, float a[3], float b[3], float c[3]) {
    for (int k = 0; k < 2; ++k) a[k] = b[k] = c[k] = signed_unit(20 + (uint64_t)k, i);
    a[2] = b[2] = c[2] = height;
    b[0] += size * (0.2f + unit(22, i));
    c[1] += size * (0.2f + unit(23, i));
}

/* How far single precision ends from double: directions in units of 2^-24, densities relatively. */
static void light_errors(float size, float height, int rectangle, double *place, double *density) {
    *place = *density = 0.0;
    for (uint64_t i = 0; i < 20000; ++i) {
        float a[3], b[3], c[3], s = unit(24, i), t = unit(25, i), w[3];
        double da[3], db[3], dc[3], dw[3], origin[3] = {0, 0, 0};
        random_light(i, size, height * (0.1f + unit(26, i)), a, b, c);
        for (int k = 0; k < 3; ++k) {
            da[k] = (double)a[k];
            db[k] = (double)b[k];
            dc[k] = (double)c[k];
        }
        float pdf;
        double exact;
        if (rectangle) {
            sf_spherical_rectangle_sample(s, t, a, b, c, nowhere, w);
            sf_spherical_rectangle_sample_f64((double)s, (double)t, da, db, dc, origin, dw);
            pdf = sf_spherical_rectangle_pdf(w, a, b, c, nowhere);
            exact = sf_spherical_rectangle_pdf_f64(dw, da, db, dc, origin);
        } else {
            sf_spherical_triangle_sample(s, t, a, b, c, nowhere, w);
            sf_spherical_triangle_sample_f64((double)s, (double)t, da, db, dc, origin, dw);
            pdf = sf_spherical_triangle_pdf(w, a, b, c, nowhere);
            exact = sf_spherical_triangle_pdf_f64(dw, da, db, dc, origin);
        }
        *place = fmax(*place, distance(w, dw) / 0x1p-24);
        *density = fmax(*density, fabs((double)pdf / exact - 1.0) / 0x1p-24);
        assert_true(off_one(w) <= 8.0 * 0x1p-24);
    }
}

static void test_lights_keep_single_precision_at_any_size_and_height(void **state) {
    (void)state;
    const float sizes[] = {1e-4f, 1e-2f, 0.3f}, heights[] = {1.0f, 1e-2f};
    for (int rectangle = 0; rectangle < 2; ++rectangle)
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 2; ++k) {
                double place, density;
                light_errors(sizes[i], heights[k], rectangle, &place, &density);
                /* 8 units, of some ten operations on directions; a light of 1/3 whose plane passes
                 * the origin at 1/1000 loses what its distance from the origin's foot is known to. */
                double limit = sizes[i] > 0.1f && heights[k] < 0.1f ? 4000.0 : sizes[i] > 0.1f ? 16.0 : 8.0;
                expect_below(rectangle ? "rectangle" : "triangle", place, limit);
                expect_below("density", density, sizes[i] > 0.1f ? 400.0 : 20.0);
            }
}

static void expect_degenerate(float share, float pdf, const float w[3], const float u[2]) {
    assert_true(share == 0.0f && isinf(pdf));
    assert_true(off_one(w) < 1e-6);
    assert_true(u[0] >= 0.0f && u[0] < 1.0f && u[1] >= 0.0f && u[1] < 1.0f);
}

static void test_lights_of_no_solid_angle_have_directions_and_an_infinite_density(void **state) {
    (void)state;
    /* No area; in the origin's plane; a vertex at the origin. */
    const float lights[][3][3] = {{{1, 2, 3}, {2, 4, 6}, {1, 2, 3}},
                                  {{1, 0, 0}, {2, 0, 0}, {1, 1, 0}},
                                  {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                  {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
    for (int l = 0; l < 4; ++l)
        for (uint64_t i = 0; i < 100; ++i) {
            const float *a = lights[l][0], *b = lights[l][1], *c = lights[l][2];
            float s = i ? unit(1, i) : 0.0f, t = i ? unit(2, i) : 0.0f, w[3], u[2];
            sf_spherical_triangle triangle;
            sf_spherical_triangle_init(&triangle, a, b, c, nowhere);
            sf_spherical_triangle_draw(&triangle, s, t, w);
            sf_spherical_triangle_find(&triangle, w, u);
            expect_degenerate(triangle.share, sf_spherical_triangle_pdf(w, a, b, c, nowhere), w, u);
            sf_spherical_rectangle rectangle;
            sf_spherical_rectangle_init(&rectangle, a, b, c, nowhere);
            sf_spherical_rectangle_draw(&rectangle, s, t, w);
            sf_spherical_rectangle_find(&rectangle, w, u);
            expect_degenerate(rectangle.share, sf_spherical_rectangle_pdf(w, a, b, c, nowhere), w, u);
        }
}

static void test_a_light_around_the_origin_covers_half_the_sphere(void **state) {
    (void)state;
    const float a[3] = {-1, -1, 0}, b[3] = {2, -1, 0}, c[3] = {-1, 2, 0};
    sf_spherical_triangle triangle;
    sf_spherical_rectangle rectangle;
    sf_spherical_triangle_init(&triangle, a, b, c, nowhere);
    sf_spherical_rectangle_init(&rectangle, a, b, c, nowhere);
    assert_true(triangle.share == 0.5f && rectangle.share == 0.5f);
    for (uint64_t i = 0; i < 100; ++i) {
        float w[3];
        sf_spherical_triangle_draw(&triangle, unit(1, i), unit(2, i), w);
        assert_true(off_one(w) < 1e-6);
        sf_spherical_rectangle_draw(&rectangle, unit(1, i), unit(2, i), w);
        assert_true(off_one(w) < 1e-6);
    }
}

/* ---- assertions ---- */

static void expect_abort(void (*function)(void)) {
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        fclose(stderr);
        signal(SIGABRT, SIG_DFL);
        function();
        _exit(0);
    }
    int status;
    assert_true(waitpid(child, &status, 0) == child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

static volatile float one_value = 1.0f, nan_value;
static void sample_at_one(void) {
    float x[3];
    sf_sphere_sample(one_value, 0.5f, x);
}
static void sample_at_nan(void) {
    float x[3];
    sf_cosine_hemisphere_sample(0.5f, nan_value, x);
}
static void cone_too_wide(void) {
    float x[3];
    sf_cone_sample(0.5f, 0.5f, 3.0f + one_value, x);
}

static void test_inline_functions_assert_what_they_ask_for(void **state) {
    (void)state;
    nan_value = NAN;
    expect_abort(sample_at_one);
    expect_abort(sample_at_nan);
    expect_abort(cone_too_wide);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_low_distortion_sends_the_diagonal_to_the_median),
        cmocka_unit_test(test_a_polygon_is_filled_to_its_vertices_and_not_beyond),
        cmocka_unit_test(test_an_annulus_may_be_a_disk_or_a_circle),
        cmocka_unit_test(test_flat_shapes_without_area_have_samples_and_an_infinite_density),
        cmocka_unit_test(test_a_truncated_gaussian_stays_within_its_radius),
        cmocka_unit_test(test_filters_are_symmetric_and_end_at_their_rim),
        cmocka_unit_test(test_mitchell_and_lanczos_are_their_formulas),
        cmocka_unit_test(test_a_cone_may_be_a_direction_or_the_sphere),
        cmocka_unit_test(test_the_height_of_a_cone_is_good_to_4_ulp),
        cmocka_unit_test(test_henyey_greenstein_is_the_sphere_at_0_and_mirrored_for_negative_g),
        cmocka_unit_test(test_the_mean_cosine_of_henyey_greenstein_is_g),
        cmocka_unit_test(test_a_power_of_0_is_uniform_and_of_1_the_cosine),
        cmocka_unit_test(test_visible_normals_seen_from_above_are_all_normals),
        cmocka_unit_test(test_masking_is_smiths),
        cmocka_unit_test(test_ggx_terms_in_bulk_are_the_inline_functions),
        cmocka_unit_test(test_known_solid_angles),
        cmocka_unit_test(test_lights_keep_single_precision_at_any_size_and_height),
        cmocka_unit_test(test_lights_of_no_solid_angle_have_directions_and_an_infinite_density),
        cmocka_unit_test(test_a_light_around_the_origin_covers_half_the_sphere),
        cmocka_unit_test(test_inline_functions_assert_what_they_ask_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
