// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What the inline functions of all headers give for one u and v. Compiled twice, under two sets of flags:
 * test_contraction.c compares. The including file defines COLLECT, the function's name. */
#include <string.h>

#include "sunfleck/discrete.h"
#include "sunfleck/estimate.h"
#include "sunfleck/mapping.h"
#include "sunfleck/material.h"

#define VALUES 128

void COLLECT(float s, float t, float out[VALUES]);
void COLLECT(float s, float t, float out[VALUES]) {
    static const float a[3] = {0.3f, -1, 2}, b[3] = {1, 0.5f, 2.5f}, c[3] = {-0.25f, 1, 0.7f}, from[3] = {0, 0.1f, 0};
    float *at = out, w[3], v[3], h[3];
    memset(out, 0, VALUES * sizeof *out);
#define TAKE(size, call) \
    do {                 \
        float *x = at;   \
        call;            \
        at += (size);    \
    } while (0)
    TAKE(3, sf_sphere_sample(s, t, x));
    TAKE(3, sf_hemisphere_sample(s, t, x));
    TAKE(3, sf_cosine_hemisphere_sample(s, t, x));
    TAKE(3, sf_cosine_hemisphere_concentric_sample(s, t, x));
    TAKE(3, sf_cone_sample(s, t, 0.4f, x));
    TAKE(3, sf_power_cosine_sample(s, t, 7.5f, x));
    TAKE(3, sf_henyey_greenstein_sample(s, t, 0.6f, x));
    TAKE(3, sf_triangle_sample(s, t, a, b, c, x));
    TAKE(3, sf_triangle_low_distortion_sample(s, t, a, b, c, x));
    TAKE(3, sf_parallelogram_sample(s, t, a, b, c, x));
    TAKE(3, sf_spherical_triangle_sample(s, t, a, b, c, from, x));
    TAKE(3, sf_spherical_rectangle_sample(s, t, a, b, c, from, x));
    TAKE(2, sf_disk_polar_sample(s, t, x));
    TAKE(2, sf_disk_concentric_sample(s, t, x));
    TAKE(2, sf_annulus_sample(s, t, 0.3f, x));
    TAKE(2, sf_regular_polygon_sample(s, t, 5, x));
    TAKE(2, sf_pixel_tent_sample(s, t, x));
    TAKE(2, sf_pixel_gaussian_sample(s, t, 0.4f, x));
    TAKE(2, sf_pixel_blackman_harris_sample(s, t, 1.5f, x));
    TAKE(2, sf_pixel_mitchell_sample(s, t, x));
    TAKE(2, sf_pixel_lanczos_sample(s, t, x));
    sf_hemisphere_sample(s, t, w);
    sf_ggx_visible_normals_sample(t, s, w, 0.3f, 0.5f, h);
    TAKE(3, memcpy(x, h, sizeof h));
    sf_reflect(w, h, v);
    TAKE(3, memcpy(x, v, sizeof v));
    TAKE(1, *x = sf_ggx_reflection_value(w, v, h, 0.3f));
    TAKE(1, *x = sf_ggx_visible_normals_pdf(h, w, 0.3f, 0.5f));
    TAKE(1, *x = sf_fresnel_dielectric(w[2], 1.5f));
    TAKE(2, sf_spherical_triangle_invert(w, a, b, c, from, x));
    TAKE(2, sf_henyey_greenstein_invert(w, 0.6f, x));
    TAKE(6, sf_frame_from_normal(w, x, x + 3));
    TAKE(2, sf_sincos_2pi(s, x, x + 1));
    TAKE(1, *x = sf_log(s + 0x1p-30f));
    TAKE(1, *x = sf_exp(t - s));
    sf_vector_moments m = {.count = 0};
    for (int k = 0; k < 6; ++k) sf_vector_moments_add(&m, (double[]){out[k], out[k + 1], out[k + 2]});
    TAKE(2, memcpy(x, &m.m2, sizeof m.m2));
    sf_weighted_moments n = {.count = 0};
    for (int k = 0; k < 6; ++k) sf_weighted_moments_add(&n, (double)out[k], (double)out[k + 1] + 2);
    TAKE(2, memcpy(x, &n.m2, sizeof n.m2));
#undef TAKE
}
