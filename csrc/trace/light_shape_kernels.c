// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Samples light from pieces of every shape and from the sky, and weighs the light that rays find. */
#include "trace/light_shape_kernels.h"

#include <math.h>
#include <string.h>

#include "sunfleck/mapping.h"
#include "trace/light_lanes.h"
#include "trace/light_tree_kernels.h"
#include "trace/rays.h"

/* Lanes and rays are counted by size_t: in 32 bits an index might wrap, and no loop over them be vectorized. */
#define EACH_LANE for (size_t l = 0; l < SF_LANES; ++l)
#define COPY3(columns, l) {(columns)[0][l], (columns)[1][l], (columns)[2][l]}

/* The pieces that the 16 rays of a packet were given, and the points that they are seen from. */
typedef struct shape_lanes {
    SF_ALIGNED(float) field[SF_LIGHT_DRAWN][SF_LANES];
    SF_ALIGNED(float) point[3][SF_LANES];
    SF_ALIGNED(uint32_t) way[SF_LANES]; /* sf_light_kind: how each is sampled */
    uint32_t ways;                      /* bit k: some lane has way k */
} shape_lanes;

/* What was drawn. */
typedef struct drawn_lanes {
    SF_ALIGNED(float) s[SF_LANES];
    SF_ALIGNED(float) t[SF_LANES];
    SF_ALIGNED(float) direction[3][SF_LANES];
    SF_ALIGNED(float) to[3][SF_LANES];       /* to the end of the shadow ray */
    SF_ALIGNED(float) density[SF_LANES];     /* by solid angle, given the piece; 0 where no light comes */
    SF_ALIGNED(float) radiance[3][SF_LANES]; /* over what the weight of the piece has */
} drawn_lanes;

static inline void give_piece(shape_lanes *lanes, size_t l, const float piece[SF_LIGHT_FIELDS]) {
    for (int f = 0; f < SF_LIGHT_DRAWN; ++f) lanes->field[f][l] = piece[f];
}

/* ---- by the tree ---- */

/* The vertices of a packet, those without a bit in `used` as its first. Light from behind is of no use to a
 * surface that lets none through; fog has no surface. */
static void view_from(sf_tree_view *SF_RESTRICT view, const sf_batch *b, const sf_scene *scene, size_t first,
                      uint32_t used) {
    bool kinds = sf_plan_has(&scene->plan, SF_STAGE_SCATTER);
    const float *scatter = scene->mesh_table.columns[SF_MESH_SCATTER];
    EACH_LANE {
        size_t i = used >> l & 1u ? first + l : first;
        sf_scatter kind = kinds ? (sf_scatter)(int)scatter[b->surface[i]] : SF_SCATTER_DIFFUSE;
        view->faces[l] = kind == SF_SCATTER_DIFFUSE || kind == SF_SCATTER_ROUGH_CONDUCTOR ? 1.0f : 0.0f;
        for (int c = 0; c < 3; ++c) {
            view->point[c][l] = b->point[c][i];
            view->normal[c][l] = b->normal[c][i];
        }
    }
}

/* The piece of the tree that was drawn with that probability. */
static inline void take_chance(shape_lanes *lanes, size_t l, float chance) {
    lanes->field[SF_LIGHT_PDF][l] *= chance;
    for (int c = 0; c < 3; ++c) lanes->field[SF_LIGHT_WEIGHT_R + c][l] /= chance;
}

/* u is shared out first between the tree and the sky, if there is one. */
static void choose_by_tree(shape_lanes *SF_RESTRICT lanes, const sf_batch *b, const sf_scene *scene, const float *u,
                           size_t first, uint32_t count) {
    const sf_light_table *lights = &scene->lights;
    uint32_t sky = (uint32_t)lights->sky_first;
    SF_ALIGNED(float) rest[SF_LANES], chance[SF_LANES];
    SF_ALIGNED(uint32_t) piece[SF_LANES];
    float share = lights->scene_share;
    sf_tree_view view;
    view_from(&view, b, scene, first, count - first < SF_LANES ? (1u << (count - first)) - 1 : 0xffffu);
    EACH_LANE {
        float own = u[first + l < count ? first + l : first], within = own / share;
        rest[l] = within < 0x1.fffffep-1f ? within : 0x1.fffffep-1f;
    }
    SF_AT_ISA(sf_light_tree_kernels).draw(lights->tree, &view, rest, piece, chance);
    EACH_LANE {
        float own = u[first + l < count ? first + l : first];
        bool by_tree = own < share;
        uint32_t chosen = by_tree ? piece[l] : sf_choose_piece(lights, sky, (own - share) / (1 - share));
        give_piece(lanes, l, lights->pieces[chosen]);
        if (by_tree) take_chance(lanes, l, chance[l]);
    }
}

/* ---- how each is sampled ---- */

/* Chooses each lane's way: triangles and rectangles by solid angle from nearby. Sampling and
 * weighting come to the same choice, since they see the same point. */
static void choose_ways(shape_lanes *lanes) {
    EACH_LANE {
        uint32_t kind = (uint32_t)(int)lanes->field[SF_LIGHT_KIND][l];
        float square = 0;
        for (int c = 0; c < 3; ++c) {
            float off = lanes->point[c][l] - lanes->field[SF_LIGHT_MIDDLE_X + c][l];
            square += off * off;
        }
        uint32_t flat = kind == SF_LIGHT_IS_TRIANGLE ? SF_LIGHT_BY_TRIANGLE_ANGLE : SF_LIGHT_BY_RECTANGLE_ANGLE;
        uint32_t near = square < lanes->field[SF_LIGHT_NEAR][l] ? flat : SF_LIGHT_BY_AREA;
        lanes->way[l] = kind <= SF_LIGHT_IS_DISK ? near : kind;
    }
    lanes->ways = 0;
    EACH_LANE lanes->ways |= 1u << lanes->way[l];
}

/* ---- flat pieces ---- */

/* How far a light point is moved off its surface: as the vertex was, so that the ray ends before it. */
static inline float lift_of(const float end[3], float distance, float least) {
    float ax = fabsf(end[0]), ay = fabsf(end[1]), az = fabsf(end[2]), largest = ax > ay ? ax : ay;
    float lift = 0x1p-18f * ((largest > az ? largest : az) + distance);
    return lift > least ? lift : least;
}

/* The multiples of the edges: on a triangle the lecture's map, on a parallelogram the unit square
 * itself, on a disk the concentric map. */
static inline void place_flat(float kind, float s, float t, float *alpha, float *beta) {
    float root = sqrtf(s), disk[2];
    sf_disk_concentric_sample(s, t, disk);
    bool triangle = kind == (float)SF_LIGHT_IS_TRIANGLE, is_disk = kind == (float)SF_LIGHT_IS_DISK;
    *alpha = triangle ? root * t : is_disk ? disk[0] : s;
    *beta = triangle ? 1 - root : is_disk ? disk[1] : t;
}

static void draw_by_area(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d) {
    EACH_LANE {
        float alpha, beta, end[3], to[3], along = 0, square = 0;
        place_flat(lanes->field[SF_LIGHT_KIND][l], d->s[l], d->t[l], &alpha, &beta);
        for (int c = 0; c < 3; ++c) {
            end[c] = lanes->field[SF_LIGHT_ORIGIN_X + c][l] + alpha * lanes->field[SF_LIGHT_EDGE1_X + c][l] +
                     beta * lanes->field[SF_LIGHT_EDGE2_X + c][l];
            to[c] = end[c] - lanes->point[c][l];
            along -= to[c] * lanes->field[SF_LIGHT_NORMAL_X + c][l];
            square += to[c] * to[c];
        }
        float distance = sqrtf(square), inverse = 1 / distance;
        float lift = lift_of(end, distance, lanes->field[SF_LIGHT_LIFT][l]);
        /* Density by area to density by solid angle: distance^2 / cosine. */
        float density = square * distance / (along * lanes->field[SF_LIGHT_AREA][l]);
        bool mine = lanes->way[l] == SF_LIGHT_BY_AREA;
        for (int c = 0; c < 3; ++c) {
            d->direction[c][l] = mine ? to[c] * inverse : d->direction[c][l];
            d->to[c][l] = mine ? to[c] + lift * lanes->field[SF_LIGHT_NORMAL_X + c][l] : d->to[c][l];
        }
        d->density[l] = mine ? (along > 0 ? density : 0.0f) : d->density[l];
    }
}

/* Ends a direction to a flat piece on its plane. */
static inline void end_on_plane(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d, size_t l,
                                const float w[3], float share) {
    float height = 0, along = 0, end[3];
    for (int c = 0; c < 3; ++c) {
        float normal = lanes->field[SF_LIGHT_NORMAL_X + c][l];
        height += (lanes->point[c][l] - lanes->field[SF_LIGHT_ORIGIN_X + c][l]) * normal;
        along -= w[c] * normal;
    }
    float distance = height / along;
    for (int c = 0; c < 3; ++c) {
        d->direction[c][l] = w[c];
        end[c] = lanes->point[c][l] + distance * w[c];
    }
    float lift = lift_of(end, distance, lanes->field[SF_LIGHT_LIFT][l]);
    for (int c = 0; c < 3; ++c) d->to[c][l] = distance * w[c] + lift * lanes->field[SF_LIGHT_NORMAL_X + c][l];
    d->density[l] = ((height > 0) & (along > 0) & (share > 0)) ? 0.25f / (SF_PI_F * share) : 0.0f;
}

static inline void corners_of(const shape_lanes *SF_RESTRICT lanes, size_t l, float a[3], float b[3], float c[3]) {
    for (int k = 0; k < 3; ++k) {
        a[k] = lanes->field[SF_LIGHT_ORIGIN_X + k][l];
        b[k] = a[k] + lanes->field[SF_LIGHT_EDGE1_X + k][l];
        c[k] = a[k] + lanes->field[SF_LIGHT_EDGE2_X + k][l];
    }
}

static void draw_triangles(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d) {
    SF_ALIGNED(float) w[3][SF_LANES], share[SF_LANES];
    EACH_LANE {
        float a[3], b[3], c[3], direction[3];
        const float point[3] = COPY3(lanes->point, l);
        sf_spherical_triangle triangle;
        corners_of(lanes, l, a, b, c);
        sf_spherical_triangle_init(&triangle, a, b, c, point);
        sf_spherical_triangle_draw(&triangle, d->s[l], d->t[l], direction);
        for (int k = 0; k < 3; ++k) w[k][l] = direction[k];
        share[l] = triangle.share;
    }
    EACH_LANE {
        const float direction[3] = COPY3(w, l);
        if (lanes->way[l] == SF_LIGHT_BY_TRIANGLE_ANGLE) end_on_plane(lanes, d, l, direction, share[l]);
    }
}

static void draw_rectangles(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d) {
    SF_ALIGNED(float) w[3][SF_LANES], share[SF_LANES];
    EACH_LANE {
        float a[3], b[3], c[3], direction[3];
        const float point[3] = COPY3(lanes->point, l);
        sf_spherical_rectangle rectangle;
        corners_of(lanes, l, a, b, c);
        sf_spherical_rectangle_init(&rectangle, a, b, c, point);
        sf_spherical_rectangle_draw(&rectangle, d->s[l], d->t[l], direction);
        for (int k = 0; k < 3; ++k) w[k][l] = direction[k];
        share[l] = rectangle.share;
    }
    EACH_LANE {
        const float direction[3] = COPY3(w, l);
        if (lanes->way[l] == SF_LIGHT_BY_RECTANGLE_ANGLE) end_on_plane(lanes, d, l, direction, share[l]);
    }
}

/* ---- spheres ---- */

/* What a sphere is from a point: the unit vector to its middle, the distance, and the height of its
 * cone; 0 from inside. */
static inline float see_sphere(const shape_lanes *SF_RESTRICT lanes, size_t l, float axis[3], float *distance) {
    float square = 0, radius = lanes->field[SF_LIGHT_EDGE1_X][l];
    for (int c = 0; c < 3; ++c) {
        axis[c] = lanes->field[SF_LIGHT_ORIGIN_X + c][l] - lanes->point[c][l];
        square += axis[c] * axis[c];
    }
    *distance = sqrtf(square);
    bool outside = *distance > radius;
    float inverse = outside ? 1 / *distance : 0.0f;
    for (int c = 0; c < 3; ++c) axis[c] *= inverse;
    axis[2] = outside ? axis[2] : 1.0f;
    return outside ? sf_cone_height_of_sphere(radius, *distance) : 0.0f;
}

/* A direction of the cone, and where it meets the sphere: by the law of sines, the angle at the
 * middle is asin(D sin theta / r) - theta. */
static inline void draw_sphere(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d, size_t l) {
    float axis[3], tangent[3], bitangent[3], local[3], w[3], distance, radius = lanes->field[SF_LIGHT_EDGE1_X][l];
    float height = see_sphere(lanes, l, axis, &distance);
    sf_frame_from_normal(axis, tangent, bitangent);
    sf_cone_cap_sample(d->s[l], d->t[l], height, local);
    sf_frame_to_world(tangent, bitangent, axis, local, w);
    float ring = sqrtf(local[0] * local[0] + local[1] * local[1]), x = ring * distance / radius;
    x = x < 1 ? x : 1.0f;
    float other = sqrtf((1 - x) * (1 + x)), sine = x * local[2] - ring * other, cosine = x * ring + local[2] * other;
    float across = ring > 0 ? sine / ring : 0.0f;
    float normal[3], end[3];
    const float outwards[3] = {local[0] * across, local[1] * across, -cosine};
    sf_frame_to_world(tangent, bitangent, axis, outwards, normal);
    for (int c = 0; c < 3; ++c) end[c] = lanes->field[SF_LIGHT_ORIGIN_X + c][l] + radius * normal[c];
    float lift = lift_of(end, distance, 0) + 0x1p-18f * radius;
    for (int c = 0; c < 3; ++c) {
        d->direction[c][l] = w[c];
        d->to[c][l] = (end[c] - lanes->point[c][l]) + lift * normal[c];
    }
    d->density[l] = height > 0 ? 0.5f / (SF_PI_F * height) : 0.0f;
}

/* ---- the sky ---- */

/* The shadow ray leaves the scene. */
static inline void leave(drawn_lanes *SF_RESTRICT d, size_t l, const float w[3], float far, float density) {
    for (int c = 0; c < 3; ++c) {
        d->direction[c][l] = w[c];
        d->to[c][l] = far * w[c];
    }
    d->density[l] = density;
}

static inline void draw_sun(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d, size_t l, float far) {
    const float (*field)[SF_LANES] = lanes->field;
    const float tangent[3] = COPY3(field + SF_LIGHT_EDGE1_X, l), bitangent[3] = COPY3(field + SF_LIGHT_EDGE2_X, l);
    const float pole[3] = COPY3(field + SF_LIGHT_NORMAL_X, l);
    float local[3], w[3], height = field[SF_LIGHT_HEIGHT][l];
    sf_cone_cap_sample(d->s[l], d->t[l], height, local);
    sf_frame_to_world(tangent, bitangent, pole, local, w);
    leave(d, l, w, far, 0.5f / (SF_PI_F * height));
}

static inline void draw_direction(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d, size_t l,
                                  float far) {
    const float w[3] = COPY3(lanes->field + SF_LIGHT_NORMAL_X, l);
    leave(d, l, w, far, 1);
}

/* A pixel in proportion to what comes from it, and a direction uniformly over its solid angle:
 * longitude, and the cosine from the top. */
static inline void draw_pixel(const sf_sky *sky, drawn_lanes *SF_RESTRICT d, size_t l, const float x[2]) {
    const sf_environment *e = &sky->environment;
    float right = x[0] * (float)e->width, down = x[1] * (float)e->height;
    uint32_t column = (uint32_t)right, row = (uint32_t)down;
    column = column < e->width ? column : e->width - 1;
    row = row < e->height ? row : e->height - 1;
    double up = sky->edges[row] + (double)(down - (float)row) * (sky->edges[row + 1] - sky->edges[row]);
    float ring = (float)sqrt(fmax((1 - up) * (1 + up), 0)), sine, cosine, w[3];
    sf_sincos_2pi(x[0] > 0.5f ? 1.5f - x[0] : 0.5f - x[0], &sine, &cosine);
    for (int c = 0; c < 3; ++c) w[c] = ring * (cosine * sky->front[c] + sine * sky->left[c]) + (float)up * sky->up[c];
    const float *pixel = e->pixels + 3 * ((size_t)row * e->width + column);
    for (int c = 0; c < 3; ++c) d->radiance[c][l] = pixel[c];
    leave(d, l, w, sky->far, (float)(((double)pixel[0] + pixel[1] + pixel[2]) / sky->total));
}

static void draw_environment(const shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d, const sf_sky *sky) {
    float u[2 * SF_LANES], x[2 * SF_LANES] = {0};
    EACH_LANE {
        bool mine = lanes->way[l] == SF_LIGHT_IS_ENVIRONMENT;
        u[2 * l] = mine ? d->s[l] : 0.0f;
        u[2 * l + 1] = mine ? d->t[l] : 0.0f;
    }
    sf_piecewise_sample_fill_f32(sky->table, SF_LANES, u, x, NULL);
    EACH_LANE
    if (lanes->way[l] == SF_LIGHT_IS_ENVIRONMENT) draw_pixel(sky, d, l, x + 2 * l);
}

/* ---- light sampled ---- */

static void draw(const shape_lanes *SF_RESTRICT lanes, const sf_sky *sky, drawn_lanes *SF_RESTRICT d) {
    for (int c = 0; c < 3; ++c) EACH_LANE d->radiance[c][l] = 1;
    if (lanes->ways >> SF_LIGHT_BY_AREA & 1u) draw_by_area(lanes, d);
    if (lanes->ways >> SF_LIGHT_BY_TRIANGLE_ANGLE & 1u) draw_triangles(lanes, d);
    if (lanes->ways >> SF_LIGHT_BY_RECTANGLE_ANGLE & 1u) draw_rectangles(lanes, d);
    if (lanes->ways >> SF_LIGHT_IS_ENVIRONMENT & 1u) draw_environment(lanes, d, sky);
    if (!(lanes->ways & (1u << SF_LIGHT_IS_SPHERE | 1u << SF_LIGHT_IS_SUN | 1u << SF_LIGHT_IS_DIRECTION))) return;
    EACH_LANE switch (lanes->way[l]) {
        case SF_LIGHT_IS_SPHERE: draw_sphere(lanes, d, l); break;
        case SF_LIGHT_IS_SUN: draw_sun(lanes, d, l, sky->far); break;
        case SF_LIGHT_IS_DIRECTION: draw_direction(lanes, d, l, sky->far); break;
        default: break;
    }
}

/* What arrives if nothing is in between. A direction without width is found by no other ray. */
static inline void connect(sf_batch *SF_RESTRICT b, const shape_lanes *SF_RESTRICT lanes,
                           const drawn_lanes *SF_RESTRICT d, size_t first, size_t l, bool weigh) {
    size_t i = first + l;
    float cosine = d->direction[0][l] * b->normal[0][i] + d->direction[1][l] * b->normal[1][i] +
                   d->direction[2][l] * b->normal[2][i];
    float density = d->density[l], area = lanes->field[SF_LIGHT_AREA][l];
    bool sees = (cosine > 0) & (density > 0);
    float scale = sees ? cosine / (density * area) : 0.0f, sum = 0;
    if (weigh) {
        float light_pdf = lanes->field[SF_LIGHT_PDF][l] * area * density;
        float weight = sf_power_weight(light_pdf, cosine * (1.0f / SF_PI_F));
        weight = lanes->way[l] == SF_LIGHT_IS_DIRECTION ? 1.0f : weight;
        scale = sees ? scale * weight : 0.0f;
    }
    for (int c = 0; c < 3; ++c) {
        float value = b->throughput[c][i] * lanes->field[SF_LIGHT_WEIGHT_R + c][l] * d->radiance[c][l] * scale;
        b->to_light[c][i] = d->to[c][l];
        b->contribution[c][i] = value;
        sum += value;
    }
    b->alive[i] = sum > 0;
}

/* The same, whatever the surface makes of it; with the direction, which the way to the shadow ray's end is
 * not: that end is lifted off the light, by more than it is away where a lamp is lit by itself. */
static inline void connect_bare(sf_batch *SF_RESTRICT b, const shape_lanes *SF_RESTRICT lanes,
                                const drawn_lanes *SF_RESTRICT d, size_t first, size_t l) {
    size_t i = first + l;
    float density = d->density[l], area = lanes->field[SF_LIGHT_AREA][l], sum = 0;
    float scale = density > 0 ? SF_PI_F / (density * area) : 0.0f; /* the weight has a diffuse surface's 1/pi */
    for (int c = 0; c < 3; ++c) {
        float value = b->throughput[c][i] * lanes->field[SF_LIGHT_WEIGHT_R + c][l] * d->radiance[c][l] * scale;
        b->to_light[c][i] = d->to[c][l];
        b->direction[c][i] = d->direction[c][l];
        b->contribution[c][i] = value;
        sum += value;
    }
    bool point = lanes->way[l] == SF_LIGHT_IS_DIRECTION;
    b->light_pdf[i] = point ? INFINITY : lanes->field[SF_LIGHT_PDF][l] * area * density;
    b->alive[i] = sum > 0;
}

/* `weigh` for diffuse surfaces, or any surface. */
typedef enum connection { CONNECT_ALL, CONNECT_WEIGHTED, CONNECT_BARE } connection;

static void connect_packet(sf_batch *SF_RESTRICT b, const shape_lanes *SF_RESTRICT lanes,
                           const drawn_lanes *SF_RESTRICT d, size_t first, connection how) {
    if (how == CONNECT_BARE)
        EACH_LANE connect_bare(b, lanes, d, first, l);
    else if (how == CONNECT_WEIGHTED)
        EACH_LANE connect(b, lanes, d, first, l, true);
    else
        EACH_LANE connect(b, lanes, d, first, l, false);
}

/* Lanes past the end hold nothing: they do as the first does. */
static void take_packet(shape_lanes *SF_RESTRICT lanes, drawn_lanes *SF_RESTRICT d, const sf_batch *b,
                        const sf_scene *scene, float (*u)[SF_PATHS], size_t first, uint32_t count) {
    const sf_light_table *lights = &scene->lights;
    if (lights->tree)
        choose_by_tree(lanes, b, scene, u[2], first, count);
    else if (lights->count > 1)
        EACH_LANE {
            size_t i = first + l < count ? first + l : first;
            give_piece(lanes, l, lights->pieces[sf_choose_piece(lights, 0, u[2][i])]);
        }
    memcpy(d->s, u[0] + first, sizeof d->s);
    memcpy(d->t, u[1] + first, sizeof d->t);
    for (int c = 0; c < 3; ++c) memcpy(lanes->point[c], b->point[c] + first, sizeof lanes->point[c]);
    for (size_t l = 1; l < SF_LANES; ++l) {
        if (first + l < count) continue;
        d->s[l] = d->s[0];
        d->t[l] = d->t[0];
        for (int c = 0; c < 3; ++c) lanes->point[c][l] = lanes->point[c][0];
    }
}

static void connect_all(sf_batch *b, const sf_scene *scene, uint32_t count, connection how) {
    const sf_light_table *lights = &scene->lights;
    bool several = lights->count > 1;
    float (*u)[SF_PATHS] = sf_sample_dimensions_by_ray(b, count, several ? 3 : 2);
    shape_lanes lanes;
    drawn_lanes drawn;
    memset(&drawn, 0, sizeof drawn);
    EACH_LANE give_piece(&lanes, l, lights->pieces[0]);
    for (size_t first = 0; first < count; first += SF_LANES) {
        take_packet(&lanes, &drawn, b, scene, u, first, count);
        choose_ways(&lanes);
        draw(&lanes, &scene->sky, &drawn);
        connect_packet(b, &lanes, &drawn, first, how);
    }
}

static void light(sf_batch *b, const sf_scene *scene, uint32_t count, bool weigh) {
    connect_all(b, scene, count, weigh ? CONNECT_WEIGHTED : CONNECT_ALL);
}
static void bare_light(sf_batch *b, const sf_scene *scene, uint32_t count) {
    connect_all(b, scene, count, CONNECT_BARE);
}

/* ---- light found ---- */

/* The density by solid angle with which light sampling finds the point that ray i hit. */
static void density_of_hits(const sf_batch *b, const shape_lanes *SF_RESTRICT lanes, size_t first,
                            const float cosine[SF_LANES], float *SF_RESTRICT out) {
    EACH_LANE {
        float square = b->distance[first + l] * b->distance[first + l];
        out[l] = lanes->field[SF_LIGHT_PDF][l] * square / cosine[l];
    }
    if (lanes->ways >> SF_LIGHT_BY_TRIANGLE_ANGLE & 1u) EACH_LANE {
            float a[3], p[3], q[3];
            const float point[3] = COPY3(lanes->point, l);
            sf_spherical_triangle triangle;
            corners_of(lanes, l, a, p, q);
            sf_spherical_triangle_init(&triangle, a, p, q, point);
            float pdf = lanes->field[SF_LIGHT_PDF][l] * lanes->field[SF_LIGHT_AREA][l];
            out[l] = lanes->way[l] == SF_LIGHT_BY_TRIANGLE_ANGLE ? pdf * (0.25f / (SF_PI_F * triangle.share)) : out[l];
        }
    if (lanes->ways >> SF_LIGHT_BY_RECTANGLE_ANGLE & 1u) EACH_LANE {
            float a[3], p[3], q[3];
            const float point[3] = COPY3(lanes->point, l);
            sf_spherical_rectangle rectangle;
            corners_of(lanes, l, a, p, q);
            sf_spherical_rectangle_init(&rectangle, a, p, q, point);
            float pdf = lanes->field[SF_LIGHT_PDF][l] * lanes->field[SF_LIGHT_AREA][l];
            out[l] =
                lanes->way[l] == SF_LIGHT_BY_RECTANGLE_ANGLE ? pdf * (0.25f / (SF_PI_F * rectangle.share)) : out[l];
        }
    if (lanes->ways >> SF_LIGHT_IS_SPHERE & 1u) EACH_LANE {
            float axis[3], distance, height = see_sphere(lanes, l, axis, &distance);
            float pdf = height > 0 ? lanes->field[SF_LIGHT_PDF][l] * (0.5f / (SF_PI_F * height)) : 0.0f;
            out[l] = lanes->way[l] == SF_LIGHT_IS_SPHERE ? pdf : out[l];
        }
}

/* The cosine at what ray i hit, on the side that its normal points to. */
static inline float hit_cosine(const sf_batch *b, size_t i) {
    float nx = b->hit_normal[0][i], ny = b->hit_normal[1][i], nz = b->hit_normal[2][i];
    float along = -(b->direction[0][i] * nx + b->direction[1][i] * ny + b->direction[2][i] * nz);
    return along / sqrtf(nx * nx + ny * ny + nz * nz);
}

/* Which of a packet's rays hit the side of a light that emits, and its emission. */
static uint32_t list_emitters(sf_batch *b, const sf_scene *scene, size_t first, float cosine[SF_LANES]) {
    SF_ALIGNED(float) sum[SF_LANES];
    uint32_t emitters = 0;
    EACH_LANE sum[l] = 0;
    for (int c = 0; c < 3; ++c) {
        const float *column = scene->mesh_table.columns[SF_MESH_EMISSION_R + c];
        EACH_LANE sum[l] += b->emission[c][first + l] = column[b->mesh[first + l]];
    }
    EACH_LANE cosine[l] = hit_cosine(b, first + l);
    EACH_LANE emitters |= (uint32_t)((sum[l] > 0) & (cosine[l] > 0)) << l;
    return emitters;
}

/* The densities of what the rays hit, as from where they started: the vertices are what they were, or were
 * moved with the rays (order_kernels.c). */
static void weigh_by_tree(shape_lanes *SF_RESTRICT lanes, const sf_batch *b, const sf_scene *scene, size_t first,
                          uint32_t emitters) {
    const sf_light_table *lights = &scene->lights;
    SF_ALIGNED(float) chance[SF_LANES];
    SF_ALIGNED(uint32_t) piece[SF_LANES];
    sf_tree_view view;
    view_from(&view, b, scene, first, emitters);
    EACH_LANE {
        size_t i = first + l;
        piece[l] = 0;
        if (emitters >> l & 1u) piece[l] = lights->of_primitive[lights->first_of_mesh[b->mesh[i]] + b->primitive[i]];
    }
    SF_AT_ISA(sf_light_tree_kernels).weigh(lights->tree, &view, piece, chance);
    EACH_LANE lanes->field[SF_LIGHT_PDF][l] *= chance[l];
}

static void weigh_packet(sf_batch *b, const sf_scene *scene, size_t first, uint32_t emitters, sf_found_share share,
                         const float cosine[SF_LANES]) {
    const sf_light_table *lights = &scene->lights;
    SF_ALIGNED(float) light_pdf[SF_LANES], weight[SF_LANES];
    EACH_LANE light_pdf[l] = 0;
    if (share == SF_FOUND_WEIGHTED && !lights->special) {
        const float *pdf = scene->mesh_table.columns[SF_MESH_LIGHT_PDF];
        EACH_LANE light_pdf[l] = pdf[b->mesh[first + l]] * b->distance[first + l] * b->distance[first + l] / cosine[l];
    } else if (share == SF_FOUND_WEIGHTED) {
        shape_lanes lanes;
        EACH_LANE {
            size_t i = first + l;
            uint32_t piece = 0;
            if (emitters >> l & 1u) piece = lights->of_primitive[lights->first_of_mesh[b->mesh[i]] + b->primitive[i]];
            give_piece(&lanes, l, lights->pieces[piece]);
            for (int c = 0; c < 3; ++c) lanes.point[c][l] = b->origin[c][i];
        }
        if (lights->tree) weigh_by_tree(&lanes, b, scene, first, emitters);
        choose_ways(&lanes);
        density_of_hits(b, &lanes, first, cosine, light_pdf);
    }
    if (share == SF_FOUND_WEIGHTED)
        EACH_LANE weight[l] = sf_power_weight(b->pdf[first + l], light_pdf[l]);
    else
        EACH_LANE weight[l] = sf_found_weight(share, b->pdf[first + l], 0);
    EACH_LANE weight[l] = emitters >> l & 1u ? weight[l] : 0.0f;
    for (int c = 0; c < 3; ++c) EACH_LANE {
            size_t i = first + l;
            b->emission[c][i] = weight[l] > 0 ? b->throughput[c][i] * b->emission[c][i] * weight[l] : 0.0f;
        }
}

static void found(sf_batch *b, const sf_scene *scene, uint32_t count) {
    sf_found_share share = sf_share_found(&scene->plan);
    SF_ALIGNED(float) cosine[SF_LANES];
    for (size_t first = 0; first < count; first += SF_LANES) {
        uint32_t emitters = list_emitters(b, scene, first, cosine);
        if (emitters)
            weigh_packet(b, scene, first, emitters, share, cosine);
        else
            for (int c = 0; c < 3; ++c) memset(b->emission[c] + first, 0, SF_LANES * sizeof(float));
    }
    if (!sf_plan_has(&scene->plan, SF_STAGE_MISS)) return;
    for (uint32_t i = 0; i < count; ++i)
        if (b->mesh[i] == scene->mesh_table.miss)
            for (int c = 0; c < 3; ++c) b->emission[c][i] = b->throughput[c][i] * scene->background[c];
}

const sf_light_shape_kernels SF_AT_ISA(sf_light_shape_kernels) = {light, bare_light, found};
