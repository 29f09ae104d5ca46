// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Samples light from triangles and parallelograms by area, and adds what arrives. */
#include "trace/light_kernels.h"

#include <math.h>
#include <string.h>

#include "sunfleck/mapping.h"
#include "trace/light_lanes.h"
#include "trace/rays.h"

/* The pieces that the 16 rays of a packet were given, field by field, and the coordinates of their points. */
typedef struct light_lanes {
    SF_ALIGNED(float) field[SF_LIGHT_SAMPLED][SF_LANES];
    float s[SF_LANES], t[SF_LANES];
} light_lanes;

/* What connects vertex first + l to a point of its light piece. */
static inline void connect(sf_batch *SF_RESTRICT b, const light_lanes *SF_RESTRICT lights, size_t first, size_t l,
                           bool weigh) {
    const float (*field)[SF_LANES] = lights->field;
    float s = lights->s[l], t = lights->t[l];
    size_t i = first + l;
    /* On a triangle the lecture's map, on a parallelogram the unit square itself. */
    float root = sqrtf(s), rectangle = field[SF_LIGHT_RECTANGLE][l];
    float alpha = rectangle > 0 ? s : root * t, beta = rectangle > 0 ? t : 1 - root;
    float to[3], normal[3], lifted[3];
    for (int c = 0; c < 3; ++c) {
        lifted[c] = field[SF_LIGHT_ORIGIN_X + c][l] + alpha * field[SF_LIGHT_EDGE1_X + c][l] +
                    beta * field[SF_LIGHT_EDGE2_X + c][l];
        normal[c] = field[SF_LIGHT_NORMAL_X + c][l];
        to[c] = lifted[c] - b->point[c][i];
    }
    /* Move the light point off its surface too, as the vertex was, so that the ray ends before it. */
    float ax = fabsf(lifted[0]), ay = fabsf(lifted[1]), az = fabsf(lifted[2]);
    float largest = ax > ay ? ax : ay;
    largest = largest > az ? largest : az;
    float square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2], distance = sqrtf(square), inverse = 1 / square;
    float lift = 0x1p-18f * (largest + distance), least = field[SF_LIGHT_LIFT][l];
    lift = lift > least ? lift : least;
    float cos_surface = to[0] * b->normal[0][i] + to[1] * b->normal[1][i] + to[2] * b->normal[2][i];
    float cos_light = -(to[0] * normal[0] + to[1] * normal[1] + to[2] * normal[2]);
    bool sees = (cos_surface > 0) & (cos_light > 0);
    /* cos cos / distance^2, each cosine still times the distance. */
    float geometry = sees ? cos_surface * inverse * (cos_light * inverse) : 0.0f;
    if (weigh) {
        float surface_pdf = cos_surface * (1.0f / SF_PI_F) / distance;
        float light_pdf = field[SF_LIGHT_PDF][l] * square * distance / cos_light;
        geometry = sees ? geometry * sf_power_weight(light_pdf, surface_pdf) : 0.0f;
    }
    float sum = 0;
    for (int c = 0; c < 3; ++c) {
        b->to_light[c][i] = to[c] + lift * normal[c];
        float value = b->throughput[c][i] * field[SF_LIGHT_WEIGHT_R + c][l] * geometry;
        b->contribution[c][i] = value;
        sum += value;
    }
    b->alive[i] = sum > 0;
}

static void connect_packet(sf_batch *SF_RESTRICT b, const light_lanes *SF_RESTRICT lights, uint32_t first, bool weigh) {
    if (weigh)
        for (size_t l = 0; l < SF_LANES; ++l) connect(b, lights, first, l, true);
    else
        for (size_t l = 0; l < SF_LANES; ++l) connect(b, lights, first, l, false);
}

static inline void give_piece(light_lanes *lights, uint32_t l, const float piece[SF_LIGHT_FIELDS]) {
    for (int f = 0; f < SF_LIGHT_SAMPLED; ++f) lights->field[f][l] = piece[f];
}

static void light(sf_batch *b, const sf_scene *scene, uint32_t count, bool weigh) {
    const sf_light_table *lights = &scene->lights;
    bool several = lights->count > 1;
    float (*u)[SF_PATHS] = sf_sample_dimensions_by_ray(b, count, several ? 3 : 2);
    light_lanes lanes;
    for (uint32_t l = 0; l < SF_LANES; ++l) give_piece(&lanes, l, lights->pieces[0]);
    for (uint32_t first = 0; first < count; first += SF_LANES) {
        if (several) /* lanes past the end hold no place in the table: they keep what they have */
            for (uint32_t l = 0; l < SF_LANES && first + l < count; ++l)
                give_piece(&lanes, l, lights->pieces[sf_choose_piece(lights, 0, u[2][first + l])]);
        memcpy(lanes.s, u[0] + first, sizeof lanes.s);
        memcpy(lanes.t, u[1] + first, sizeof lanes.t);
        connect_packet(b, &lanes, first, weigh);
    }
}

/* A ray that was not alive was not traced, and its contribution may be no number. */
static inline float arriving(const sf_batch *b, int c, uint32_t i) {
    return b->alive[i] && b->arrives[i] > 0 ? b->contribution[c][i] : 0.0f;
}

static void add_light(sf_batch *b, uint32_t count) {
    if (b->in_place)
        for (int c = 0; c < 3; ++c)
            for (uint32_t i = 0; i < count; ++i) b->radiance[c][i] += arriving(b, c, i);
    else {
        for (int c = 0; c < 3; ++c)
            for (uint32_t i = 0; i < count; ++i) b->contribution[c][i] = arriving(b, c, i);
        sf_add_by_path(b, b->contribution, count);
    }
}

const sf_light_kernels SF_AT_ISA(sf_light_kernels) = {light, add_light};
