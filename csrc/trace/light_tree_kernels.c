// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Draws pieces of light by walks down the tree, 16 vertices in step. */
#include "trace/light_tree_kernels.h"

#include <math.h>

#define EACH_LANE for (uint32_t l = 0; l < SF_LANES; ++l)

/* Cosines of bounds are rounded, and so are those of the samples that they bound: what is within this
 * of the edge still counts. */
#define SLACK 0x1p-16f

static inline float within_one(float x) {
    float low = x > -1 ? x : -1.0f;
    return low < 1 ? low : 1.0f;
}
static inline float sine_of(float cosine) { return sqrtf((1 - cosine) * (1 + cosine)); }

/* Fields of a node for each lane. */
typedef struct node_lanes {
    SF_ALIGNED(float) field[SF_TREE_FIELDS][SF_LANES];
} node_lanes;

/* The most that a node may send to a vertex, up to a factor that all have: its power over the square of
 * the distance, times the largest cosine at the light and, with `faces`, at the vertex. The square is
 * at least that of the sphere's radius, since within it the distance says nothing. Angles are
 * subtracted by their sines and cosines, and not beyond 0. */
static void bound_packet(const node_lanes *SF_RESTRICT node, const sf_tree_view *SF_RESTRICT view,
                         float *SF_RESTRICT out) {
    EACH_LANE {
        float square = 0, along = 0, across = 0, radius = node->field[SF_TREE_RADIUS][l];
        for (int c = 0; c < 3; ++c) {
            float to = node->field[SF_TREE_MIDDLE_X + c][l] - view->point[c][l];
            square += to * to;
            along -= to * node->field[SF_TREE_AXIS_X + c][l];
            across += to * view->normal[c][l];
        }
        float inside = radius * radius, inverse = square > 0 ? 1 / sqrtf(square) : 0.0f;
        /* What the sphere fills: the sine of its angle. */
        float sine_b = radius * inverse;
        sine_b = sine_b < 1 ? sine_b : 1.0f;
        float cosine_b = sine_of(sine_b);
        /* Between the axis and the way to the point, less the cone's angle, less the sphere's. */
        float cosine_w = within_one(along * inverse), sine_w = sine_of(cosine_w);
        float cosine_o = node->field[SF_TREE_COSINE][l], sine_o = node->field[SF_TREE_SINE][l];
        float cosine_d = cosine_w * cosine_o + sine_w * sine_o, sine_d = sine_w * cosine_o - cosine_w * sine_o;
        float cosine_x = cosine_w < cosine_o ? cosine_d : 1.0f, sine_x = cosine_w < cosine_o ? sine_d : 0.0f;
        float at_light = cosine_x * cosine_b + sine_x * sine_b;
        at_light = (cosine_x < cosine_b ? at_light : 1.0f) + SLACK;
        /* Between the normal and the way to the node, less the sphere's. */
        float cosine_i = within_one(across * inverse), sine_i = sine_of(cosine_i);
        float at_vertex = cosine_i * cosine_b + sine_i * sine_b;
        at_vertex = (cosine_i < cosine_b ? at_vertex : 1.0f) + SLACK;
        at_vertex = view->faces[l] > 0 ? at_vertex : 1.0f;
        at_light = at_light > 0 ? at_light : 0.0f;
        at_vertex = at_vertex > 0 ? at_vertex : 0.0f;
        float product = square > inside ? at_light * at_vertex : 1.0f, larger = square > inside ? square : inside;
        float bound = node->field[SF_TREE_POWER][l] / larger * product;
        out[l] = bound < 1e37f ? bound : 1e37f;
    }
}

/* The least probability of a child that may send something: a float u in [0, 1) still comes upon it. */
#define LEAST_SHARE 0x1p-20f

/* The probability of the first of each lane's two children, which are nodes first[l] and first[l] + 1; an
 * even choice where neither sends anything. */
static void share_packet(const sf_light_tree *tree, const sf_tree_view *SF_RESTRICT view,
                         const uint32_t *SF_RESTRICT first, float *SF_RESTRICT share) {
    node_lanes one, two;
    SF_ALIGNED(float) bound_one[SF_LANES], bound_two[SF_LANES];
    EACH_LANE {
        const float *node = tree->nodes[first[l]];
        for (int f = 0; f < SF_TREE_FIELDS; ++f) one.field[f][l] = node[f];
        for (int f = 0; f < SF_TREE_FIELDS; ++f) two.field[f][l] = node[SF_TREE_FIELDS + f];
    }
    bound_packet(&one, view, bound_one);
    bound_packet(&two, view, bound_two);
    EACH_LANE {
        float a = bound_one[l], b = bound_two[l], part = a + b > 0 ? a / (a + b) : 0.5f;
        float low = a > 0 ? LEAST_SHARE : 0.0f, high = b > 0 ? 1 - LEAST_SHARE : 1.0f;
        part = part > low ? part : low;
        share[l] = part < high ? part : high;
    }
}

static void draw(const sf_light_tree *tree, const sf_tree_view *view, const float u[SF_LANES], uint32_t piece[SF_LANES],
                 float chance[SF_LANES]) {
    SF_ALIGNED(float) rest[SF_LANES], share[SF_LANES];
    SF_ALIGNED(uint32_t) first[SF_LANES], child[SF_LANES];
    EACH_LANE {
        rest[l] = u[l];
        chance[l] = 1;
        child[l] = tree->child[0];
    }
    for (uint32_t going = 1; going;) {
        EACH_LANE first[l] = child[l] & SF_TREE_LEAF ? 1 : child[l]; /* at its leaf: any */
        share_packet(tree, view, first, share);
        going = 0;
        EACH_LANE {
            bool on = !(child[l] & SF_TREE_LEAF), left = rest[l] < share[l];
            float part = left ? share[l] : 1 - share[l], within = left ? rest[l] : rest[l] - share[l];
            within /= part;
            within = within < 0x1.fffffep-1f ? within : 0x1.fffffep-1f;
            rest[l] = on ? within : rest[l];
            chance[l] = on ? chance[l] * part : chance[l];
            child[l] = on ? tree->child[first[l] + !left] : child[l];
            going |= ~child[l] & SF_TREE_LEAF;
        }
    }
    EACH_LANE piece[l] = child[l] & ~SF_TREE_LEAF;
}

static void weigh(const sf_light_tree *tree, const sf_tree_view *view, const uint32_t piece[SF_LANES],
                  float chance[SF_LANES]) {
    SF_ALIGNED(float) share[SF_LANES];
    SF_ALIGNED(uint32_t) first[SF_LANES], child[SF_LANES];
    uint32_t depth = 0;
    EACH_LANE {
        chance[l] = 1;
        child[l] = tree->child[0];
        depth = depth > tree->depth[piece[l]] ? depth : tree->depth[piece[l]];
    }
    for (uint32_t d = 0; d < depth; ++d) {
        EACH_LANE first[l] = child[l] & SF_TREE_LEAF ? 1 : child[l];
        share_packet(tree, view, first, share);
        EACH_LANE {
            bool on = !(child[l] & SF_TREE_LEAF);
            uint32_t second = tree->trail[piece[l]] >> d & 1u;
            float part = second ? 1 - share[l] : share[l];
            chance[l] = on ? chance[l] * part : chance[l];
            child[l] = on ? tree->child[first[l] + second] : child[l];
        }
    }
}

const sf_light_tree_kernels SF_AT_ISA(sf_light_tree_kernels) = {draw, weigh};
