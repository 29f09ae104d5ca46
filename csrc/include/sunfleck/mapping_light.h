// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* mapping, the lights seen from a point: triangle and rectangle by solid angle. Included by
 * mapping.h, whose comment holds what the triples have in common.
 *
 * The triples take the vertices and the origin. A renderer's loop prepares the shape once for
 * each origin (`_init`) and then draws and finds (`_draw`, `_find`) without branches, so that it
 * vectorizes over origins as well as over samples.
 *
 * `share` is the solid angle over 4 pi, which is what sf_angle_2pi gives of half of it. pdf per
 * solid angle is 1 / (4 pi share): infinity if the origin lies in the shape's plane but not in the
 * shape, or the shape has no area; samples are then finite directions along it. From a point of
 * the shape itself, share is 1/2. A direction given to pdf is taken to meet the shape. */
#ifndef SUNFLECK_MAPPING_LIGHT_H
#define SUNFLECK_MAPPING_LIGHT_H

#include "sunfleck/mapping_sphere.h"

#ifdef __cplusplus
extern "C" {
#endif

#include "sunfleck/exact_begin.h"

/* v at length one; the pole if it has none. */
SF_INLINE void sf_unit_direction(const float v[3], float out[3]) {
    float square = sf_dot3(v, v), scale = square > 0.0f ? 1.0f / sqrtf(square) : 0.0f;
    out[0] = v[0] * scale;
    out[1] = v[1] * scale;
    out[2] = square > 0.0f ? v[2] * scale : 1.0f;
}

/* ---- spherical triangle ---- */

/* Arvo 1995, "Stratified Sampling of Spherical Triangles", without the angles of the triangle: as
 * in Peters 2021, "BRDF Importance Sampling for Polygonal Lights", the cut comes from the tangent
 * of half a solid angle (Van Oosterom & Strackee 1983). The terms are arranged so that they only
 * add up, so that neither small triangles nor those around the origin's foot need another
 * method. */
typedef struct sf_spherical_triangle {
    float a[3], b[3];   /* directions to the vertices */
    float tangent[3];   /* of the arc from a to c, at a; as long as the sine of the arc */
    float side[3];      /* c x a, on b's side: the plane on which the sub-triangles end */
    float base[3];      /* a x b, on c's side */
    float volume;       /* |a . (b x c)| */
    float edge, corner; /* 1 + a.b and 1 + a.c */
    float across;       /* volume over the sine of half the solid angle */
    float share, rest;  /* of the sphere; 1/2 - share, accurate where that is small */
} sf_spherical_triangle;

/* 1 + cos of an angle, given its sine as a vector: which does not cancel near pi. */
SF_INLINE float sf_one_plus(float cosine, const float sine[3]) {
    return cosine < 0.0f ? sf_dot3(sine, sine) / (1.0f - cosine) : 1.0f + cosine;
}
/* The vertices seen from the origin. The products are taken of the edges before anything is
 * scaled, so that share is good to some ulp however small the triangle looks. */
SF_INLINE void sf_spherical_triangle_init(sf_spherical_triangle *triangle, const float a[3], const float b[3],
                                          const float c[3], const float origin[3]) {
    float p[3], q[3], r[3], pq[3], pr[3], base[3], side[3], direction_c[3];
    for (int k = 0; k < 3; ++k) {
        p[k] = a[k] - origin[k];
        q[k] = b[k] - origin[k];
        r[k] = c[k] - origin[k];
        pq[k] = b[k] - a[k];
        pr[k] = c[k] - a[k];
    }
    float pp = sf_dot3(p, p), qq = sf_dot3(q, q), rr = sf_dot3(r, r);
    float inv_p = pp > 0.0f ? 1.0f / sqrtf(pp) : 0.0f, inv_q = qq > 0.0f ? 1.0f / sqrtf(qq) : 0.0f;
    float inv_r = rr > 0.0f ? 1.0f / sqrtf(rr) : 0.0f;
    sf_cross3(p, pq, base);
    sf_cross3(pr, p, side);
    float volume = sf_dot3(base, pr) * inv_p * inv_q * inv_r, turn = copysignf(1.0f, volume);
    for (int k = 0; k < 3; ++k) {
        triangle->a[k] = p[k] * inv_p;
        triangle->b[k] = q[k] * inv_q;
        direction_c[k] = r[k] * inv_r;
        triangle->base[k] = base[k] * (turn * inv_p * inv_q);
        side[k] *= inv_p * inv_r;
        triangle->side[k] = side[k] * turn;
    }
    sf_cross3(triangle->a, side, triangle->tangent);
    triangle->volume = fabsf(volume);
    triangle->edge = sf_one_plus(sf_dot3(triangle->a, triangle->b), triangle->base);
    triangle->corner = sf_one_plus(sf_dot3(triangle->a, direction_c), side);
    float level = triangle->edge + (sf_dot3(triangle->a, direction_c) + sf_dot3(triangle->b, direction_c));
    triangle->across = sqrtf(volume * volume + level * level);
    triangle->share = sf_angle_2pi(triangle->volume, level);
    triangle->rest = sf_angle_2pi(triangle->volume, -level);
}
/* sin of 2 pi a turns, given a + b = 1/2. */
SF_INLINE float sf_sine_of_lesser(float a, float b) {
    float sine, cosine;
    sf_sincos_2pi(a < b ? a : b, &sine, &cosine);
    return sine;
}
/* The direction of (s, t): s cuts off a sub-triangle of that share at a, by a point d of the arc
 * from a to c; t goes from b to d. */
SF_INLINE void sf_spherical_triangle_draw(const sf_spherical_triangle *triangle, float s, float t, float w[3]) {
    const float *a = triangle->a, *b = triangle->b, *tangent = triangle->tangent;
    float sum[3], gap[3], cut = s * triangle->share, left = (1.0f - s) * triangle->share;
    float sine_cut = sf_sine_of_lesser(cut, triangle->rest + left),
          sine_left = sf_sine_of_lesser(left, triangle->rest + cut);
    /* Halfway between a and d, as multiples of a and of the tangent; then d at twice the angle. */
    float scale = sine_cut + sine_left, over = 1.0f / (scale > 0.0f ? scale : 1.0f);
    float up = triangle->edge * sine_cut * over, along = triangle->across * (sine_left * over) + triangle->corner * up;
    float rise = up * up * sf_dot3(tangent, tangent), square = along * along + rise,
          inverse = 1.0f / (square > 0.0f ? square : 1.0f);
    float turn_a = square > 0.0f ? (along * along - rise) * inverse : 1.0f, turn_t = 2.0f * along * up * inverse;
    for (int k = 0; k < 3; ++k) {
        float d = turn_a * a[k] + turn_t * tangent[k];
        gap[k] = d - b[k];
        sum[k] = d + b[k];
    }
    /* 1 - b.d and 1 + b.d; 1 - w.b is t of the former. */
    float drop = 0.5f * sf_dot3(gap, gap), rest = 0.5f * sf_dot3(sum, sum);
    float out = sqrtf(t * ((2.0f - t * drop) / (rest > 0.0f ? rest : 1.0f)));
    for (int k = 0; k < 3; ++k) gap[k] = ((1.0f - t * drop) - out * rest) * b[k] + out * sum[k];
    sf_unit_direction(gap, w);
}
/* (s, t) of a direction of the triangle. */
SF_INLINE void sf_spherical_triangle_find(const sf_spherical_triangle *triangle, const float w[3], float u[2]) {
    const float *a = triangle->a, *b = triangle->b;
    float step[3], d[3], gap[3], from_a[3];
    for (int k = 0; k < 3; ++k) step[k] = w[k] - b[k];
    /* d: where the arc from b through w meets the plane of a and c. */
    float fall = -sf_dot3(triangle->side, step);
    for (int k = 0; k < 3; ++k) d[k] = fall * b[k] + triangle->volume * step[k];
    float square = sf_dot3(d, d), scale = square > 0.0f ? 1.0f / sqrtf(square) : 0.0f;
    for (int k = 0; k < 3; ++k) {
        d[k] = square > 0.0f ? d[k] * scale : a[k];
        gap[k] = d[k] - b[k];
        from_a[k] = d[k] - a[k];
    }
    float volume = fabsf(sf_dot3(triangle->base, from_a)), drop = sf_dot3(gap, gap);
    float share = sf_angle_2pi(volume, triangle->edge + (sf_dot3(a, d) + sf_dot3(b, d)));
    u[0] = sf_unit_clamp(share / (triangle->share > 0.0f ? triangle->share : 1.0f));
    u[1] = sf_unit_clamp(sf_dot3(step, step) / (drop > 0.0f ? drop : 1.0f));
}

SF_INLINE void sf_spherical_triangle_sample(float s, float t, const float a[3], const float b[3], const float c[3],
                                            const float origin[3], float w[3]) {
    sf_spherical_triangle triangle;
    SF_ASSERT_UNIT(s, t);
    sf_spherical_triangle_init(&triangle, a, b, c, origin);
    sf_spherical_triangle_draw(&triangle, s, t, w);
}
SF_INLINE float sf_spherical_triangle_pdf(const float w[3], const float a[3], const float b[3], const float c[3],
                                          const float origin[3]) {
    sf_spherical_triangle triangle;
    (void)w;
    sf_spherical_triangle_init(&triangle, a, b, c, origin);
    return 0.25f / (SF_PI_F * triangle.share);
}
SF_INLINE void sf_spherical_triangle_invert(const float w[3], const float a[3], const float b[3], const float c[3],
                                            const float origin[3], float u[2]) {
    sf_spherical_triangle triangle;
    sf_spherical_triangle_init(&triangle, a, b, c, origin);
    sf_spherical_triangle_find(&triangle, w, u);
}

/* ---- spherical rectangle ---- */

/* Urena, Fajardo & King 2013, "An Area-Preserving Parametrization for Spherical Rectangles": a
 * plane that turns about the y axis sweeps the solid angle by s, and t goes along the arc that it
 * cuts. Their formulas are sums of angles near pi and leave nothing of a small or grazing
 * rectangle in single precision; here the same map is written in angles that only add up. Let
 * 2P be the solid angle of the strip from x = -infinity to the plane, 2Q that of the rest of the
 * strip, and g0 and g1 the angles atan(near / -y0) and atan(near / y1) of its edges; then
 * P + Q + g0 + g1 = pi, and the plane stands at
 *
 *     x = near sin(P - Q) / (2 sqrt(sin P sin Q sin(g0 + Q) sin(g1 + Q))),
 *
 * where each sine is taken of its angle or of pi less it, whichever is small. */
typedef struct sf_spherical_rectangle {
    float x[3], y[3], z[3];     /* axes: along the edges, and from the origin to the plane */
    float x0, x1, y0, y1, near; /* the rectangle at distance `near`; its largest coordinate is 1 */
    float g0, g1;               /* in turns */
    float before, after;        /* shares of the strip below x0 and above x1 */
    float share;                /* of the sphere */
} sf_spherical_rectangle;

/* The share of the sphere that the rectangle x0 .. x0 + width = x1, y0 .. y0 + height = y1 at
 * distance `near` takes. With n / det the cotangent of half of each of its two triangles (Van
 * Oosterom & Strackee 1983), the product of (n1 + i det) and (n2 + i det) has the sum of the two as
 * its angle. */
SF_INLINE float sf_rectangle_share(float x0, float x1, float width, float y0, float y1, float height, float near) {
    float yy = y0 * y1, zz = near * near;
    float r00 = sqrtf(x0 * x0 + y0 * y0 + zz), r10 = sqrtf(x1 * x1 + y0 * y0 + zz);
    float r01 = sqrtf(x0 * x0 + y1 * y1 + zz), r11 = sqrtf(x1 * x1 + y1 * y1 + zz);
    float across = x0 * x1 + yy + zz;
    float n1 = r00 * r10 * r11 + (x0 * x1 + y0 * y0 + zz) * r11 + (x1 * x1 + yy + zz) * r00 + across * r10;
    float n2 = r00 * r11 * r01 + across * r01 + (x0 * x1 + y1 * y1 + zz) * r00 + (x0 * x0 + yy + zz) * r11;
    float det = near * (width * height);
    return sf_angle_2pi(det * (n1 + n2), n1 * n2 - det * det);
}
/* The share of the endless strip from x on: a triangle whose third vertex is the x axis. */
SF_INLINE float sf_strip_share(float x, float y0, float y1, float height, float near) {
    float q0 = y0 * y0 + near * near, q1 = y1 * y1 + near * near, ax = fabsf(x);
    float far0 = sqrtf(x * x + q0) + ax, far1 = sqrtf(x * x + q1) + ax;
    /* r + x, which for negative x is q / (r - x). */
    float g0 = x < 0.0f ? q0 / (far0 > 0.0f ? far0 : 1.0f) : far0,
          g1 = x < 0.0f ? q1 / (far1 > 0.0f ? far1 : 1.0f) : far1;
    return sf_angle_2pi(near * height, g0 * g1 + y0 * y1 + near * near);
}
SF_INLINE float sf_clamp_between(float x, float low, float high) {
    x = x > low ? x : low;
    return x < high ? x : high;
}

/* The rectangle of corner a and the corners b and c beside it, (b - a) . (c - a) = 0, seen from
 * the origin. */
SF_INLINE void sf_spherical_rectangle_init(sf_spherical_rectangle *rectangle, const float a[3], const float b[3],
                                           const float c[3], const float origin[3]) {
    float ex[3], ey[3], d[3], normal[3], spare[3], other[3];
    for (int k = 0; k < 3; ++k) {
        ex[k] = b[k] - a[k];
        ey[k] = c[k] - a[k];
        d[k] = a[k] - origin[k];
    }
    sf_unit_direction(ex, rectangle->x);
    sf_cross3(rectangle->x, ey, normal);
    sf_frame_from_normal(rectangle->x, spare, other); /* where there is no area */
    int flat = !(sf_dot3(normal, normal) > 0.0f);
    for (int k = 0; k < 3; ++k) normal[k] = flat ? spare[k] : normal[k];
    sf_unit_direction(normal, rectangle->z);
    sf_cross3(rectangle->z, rectangle->x, rectangle->y); /* at right angles, though the corners are rounded */
    float near = sf_dot3(d, rectangle->z), x0 = sf_dot3(d, rectangle->x), y0 = sf_dot3(d, rectangle->y);
    float width = sf_dot3(ex, rectangle->x), height = sf_dot3(ey, rectangle->y), turn = copysignf(1.0f, near);
    float x1 = x0 + width, y1 = y0 + height;
    float wide = fabsf(x0) > fabsf(x1) ? fabsf(x0) : fabsf(x1), high = fabsf(y0) > fabsf(y1) ? fabsf(y0) : fabsf(y1);
    float largest = wide > high ? wide : high;
    largest = largest > fabsf(near) ? largest : fabsf(near);
    float scale = 1.0f / (largest > 0.0f ? largest : 1.0f);
    for (int k = 0; k < 3; ++k) rectangle->z[k] *= turn;
    rectangle->near = near = fabsf(near) * scale;
    rectangle->x0 = x0 *= scale;
    rectangle->x1 = x1 *= scale;
    rectangle->y0 = y0 *= scale;
    rectangle->y1 = y1 *= scale;
    rectangle->g0 = sf_angle_2pi(near, -y0);
    rectangle->g1 = sf_angle_2pi(near, y1);
    rectangle->before = sf_strip_share(-x0, y0, y1, height * scale, near);
    rectangle->after = sf_strip_share(x1, y0, y1, height * scale, near);
    float share = sf_rectangle_share(x0, x1, width * scale, y0, y1, height * scale, near);
    float within = ((x0 * x1 < 0.0f) & (y0 * y1 < 0.0f)) ? 0.5f : 0.0f;
    rectangle->share = near > 0.0f ? share : within;
}
/* The x at which the turning plane has swept s of the solid angle. */
SF_INLINE float sf_spherical_rectangle_sweep(const sf_spherical_rectangle *r, float s) {
    float p = r->before + s * r->share, q = r->after + (1.0f - s) * r->share, edges = r->g0 + r->g1;
    float lesser = p < q ? p : q, difference = p < q ? q - p : p - q;
    float product = sf_sine_of_lesser(p, edges + q) * sf_sine_of_lesser(q, edges + p) *
                    (sf_sine_of_lesser(r->g0 + q, r->g1 + p) * sf_sine_of_lesser(r->g1 + q, r->g0 + p));
    float across = r->near * sf_sine_of_lesser(difference, edges + 2.0f * lesser);
    float x = across / (product > 0.0f ? 2.0f * sqrtf(product) : 0x1p-60f);
    return sf_clamp_between(copysignf(x, p - q), r->x0, r->x1);
}
SF_INLINE void sf_spherical_rectangle_draw(const sf_spherical_rectangle *r, float s, float t, float w[3]) {
    float x = sf_spherical_rectangle_sweep(r, s), square = x * x + r->near * r->near;
    float d0 = sqrtf(square + r->y0 * r->y0), d1 = sqrtf(square + r->y1 * r->y1);
    /* 1 - |h| and 1 + |h| at both edges, then 1 - h and 1 + h of the sample: nothing cancels. */
    float low0 = square / (d0 * (d0 + fabsf(r->y0)) + 0x1p-120f),
          low1 = square / (d1 * (d1 + fabsf(r->y1)) + 0x1p-120f);
    float less0 = r->y0 > 0.0f ? low0 : 2.0f - low0, less1 = r->y1 > 0.0f ? low1 : 2.0f - low1;
    float more0 = r->y0 > 0.0f ? 2.0f - low0 : low0, more1 = r->y1 > 0.0f ? 2.0f - low1 : low1;
    float less = (1.0f - t) * less0 + t * less1, more = (1.0f - t) * more0 + t * more1;
    float h = more < 1.0f ? more - 1.0f : 1.0f - less, ring = sqrtf(less * more), root = sqrtf(square);
    float along = root > 0.0f ? ring / root : 0.0f, wx = x * along, wz = root > 0.0f ? r->near * along : ring;
    for (int k = 0; k < 3; ++k) w[k] = (wx * r->x[k] + h * r->y[k]) + wz * r->z[k];
}
SF_INLINE void sf_spherical_rectangle_find(const sf_spherical_rectangle *r, const float w[3], float u[2]) {
    float wx = sf_dot3(w, r->x), wy = sf_dot3(w, r->y), wz = sf_dot3(w, r->z);
    float x = sf_clamp_between(r->near * wx / (wz > 0.0f ? wz : 0x1p-60f), r->x0, r->x1),
          square = x * x + r->near * r->near;
    float h0 = r->y0 / sqrtf(square + r->y0 * r->y0 + 0x1p-100f),
          h1 = r->y1 / sqrtf(square + r->y1 * r->y1 + 0x1p-100f);
    float part = sf_rectangle_share(r->x0, x, x - r->x0, r->y0, r->y1, r->y1 - r->y0, r->near);
    u[0] = sf_unit_clamp(part / (r->share > 0.0f ? r->share : 1.0f));
    u[1] = sf_unit_clamp((wy - h0) / (h1 > h0 ? h1 - h0 : 1.0f));
}

SF_INLINE void sf_spherical_rectangle_sample(float s, float t, const float a[3], const float b[3], const float c[3],
                                             const float origin[3], float w[3]) {
    sf_spherical_rectangle rectangle;
    SF_ASSERT_UNIT(s, t);
    sf_spherical_rectangle_init(&rectangle, a, b, c, origin);
    sf_spherical_rectangle_draw(&rectangle, s, t, w);
}
SF_INLINE float sf_spherical_rectangle_pdf(const float w[3], const float a[3], const float b[3], const float c[3],
                                           const float origin[3]) {
    sf_spherical_rectangle rectangle;
    (void)w;
    sf_spherical_rectangle_init(&rectangle, a, b, c, origin);
    return 0.25f / (SF_PI_F * rectangle.share);
}
SF_INLINE void sf_spherical_rectangle_invert(const float w[3], const float a[3], const float b[3], const float c[3],
                                             const float origin[3], float u[2]) {
    sf_spherical_rectangle rectangle;
    sf_spherical_rectangle_init(&rectangle, a, b, c, origin);
    sf_spherical_rectangle_find(&rectangle, w, u);
}

#include "sunfleck/exact_end.h"

#ifdef __cplusplus
}
#endif
#endif
