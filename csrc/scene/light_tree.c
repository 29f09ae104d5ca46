// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Builds the tree over the pieces of the lights, node by node at the split of least cost. */
#include "scene/light_tree.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/platform.h"

#define PI 3.14159265358979323846
#define BINS 12 /* as Conty Estevez & Kulla */

/* What bounds some pieces. The cone's half angle is `angle`, at least pi where all ways are faced. */
typedef struct bounds {
    double lower[3], upper[3];
    double axis[3], angle;
    double power;
    size_t count; /* 0: bounds nothing */
} bounds;

/* A piece and its number, since pieces change places. */
typedef struct entry {
    sf_tree_piece piece;
    uint32_t number;
} entry;

typedef struct builder {
    entry *entries;
    sf_light_tree *tree;
    double power; /* of all */
} builder;

/* ---- bounds ---- */

/* The smallest cone that holds two others. Gaertner's formula as in Conty Estevez & Kulla, algorithm 1. */
static void merge_cones(bounds *a, const bounds *b) {
    const bounds *wide = a->angle >= b->angle ? a : b, *narrow = wide == a ? b : a;
    double dot = 0, w[3] = {wide->axis[0], wide->axis[1], wide->axis[2]}, across[3], length = 0;
    for (int c = 0; c < 3; ++c) dot += w[c] * narrow->axis[c];
    double between = acos(fmin(fmax(dot, -1), 1)), angle = wide->angle;
    for (int c = 0; c < 3; ++c) {
        across[c] = narrow->axis[c] - dot * w[c];
        length += across[c] * across[c];
    }
    length = sqrt(length);
    if (fmin(between + narrow->angle, PI) > wide->angle) {
        angle = 0.5 * (wide->angle + between + narrow->angle);
        double turn = angle - wide->angle;
        if (angle >= PI || !(length > 1e-12))
            angle = angle > 1e-6 ? PI : angle; /* opposite axes have no middle */
        else
            for (int c = 0; c < 3; ++c) w[c] = cos(turn) * w[c] + sin(turn) * across[c] / length;
    }
    memcpy(a->axis, w, sizeof w);
    a->angle = angle;
}

static void add_bounds(bounds *a, const bounds *b) {
    if (!b->count) return;
    if (!a->count) {
        *a = *b;
        return;
    }
    merge_cones(a, b);
    for (int c = 0; c < 3; ++c) {
        a->lower[c] = fmin(a->lower[c], b->lower[c]);
        a->upper[c] = fmax(a->upper[c], b->upper[c]);
    }
    a->power += b->power;
    a->count += b->count;
}

static bounds bounds_of(const sf_tree_piece *p) {
    bounds b = {.angle = p->all_ways ? PI : 0, .power = (double)p->power, .count = 1};
    for (int c = 0; c < 3; ++c) {
        b.lower[c] = (double)p->lower[c];
        b.upper[c] = (double)p->upper[c];
        b.axis[c] = (double)p->axis[c];
    }
    return b;
}

static bounds bounds_of_all(const entry *entries, size_t count) {
    bounds all = {.count = 0};
    for (size_t i = 0; i < count; ++i) {
        bounds one = bounds_of(&entries[i].piece);
        add_bounds(&all, &one);
    }
    return all;
}

/* ---- where to split: the surface area orientation heuristic ---- */

/* The measure of directions that get light: those of the cone whole, and beside it as the cosine falls
 * (Conty Estevez & Kulla, section 4.2, for pieces that emit up to pi/2 from their normals). */
static double measure_ways(double o) {
    double w = fmin(o + 0.5 * PI, PI);
    return 2 * PI * (1 - cos(o)) + 0.5 * PI * (2 * w * sin(o) - cos(o - 2 * w) - 2 * o * sin(o) + cos(o));
}

static double cost_of(const bounds *b) {
    double d[3];
    if (!b->count) return 0;
    for (int c = 0; c < 3; ++c) d[c] = b->upper[c] - b->lower[c];
    return b->power * measure_ways(b->angle) * (d[0] * d[1] + d[1] * d[2] + d[2] * d[0]);
}

typedef struct split {
    int axis; /* -1: none */
    int bin;  /* the first of the second half */
    double low, scale;
    double cost;
} split;

static double centre_of(const entry *e, int axis) {
    return 0.5 * ((double)e->piece.lower[axis] + e->piece.upper[axis]);
}

static int bin_of(const entry *e, int axis, double low, double scale) {
    int bin = (int)((centre_of(e, axis) - low) * scale);
    return bin < BINS ? bin : BINS - 1;
}

/* Whether `count` pieces fit below a node with `levels` left. */
static bool fits(size_t count, uint32_t levels) { return levels >= 32 || count <= (size_t)1 << levels; }

/* Takes the best border between the bins of one axis into `best`. */
static void try_borders(const bounds bins[BINS], double stretch, uint32_t levels, split *candidate, split *best) {
    bounds after[BINS], before = {.count = 0};
    after[BINS - 1] = bins[BINS - 1];
    for (int k = BINS - 2; k > 0; --k) {
        after[k] = bins[k];
        add_bounds(&after[k], &after[k + 1]);
    }
    for (int k = 1; k < BINS; ++k) {
        add_bounds(&before, &bins[k - 1]);
        if (!before.count || !after[k].count) continue;
        if (!fits(before.count, levels) || !fits(after[k].count, levels)) continue;
        candidate->cost = stretch * (cost_of(&before) + cost_of(&after[k]));
        candidate->bin = k;
        if (candidate->cost > 0 && candidate->cost < best->cost) *best = *candidate;
    }
}

/* The cheapest split of `count` entries whose halves have `levels` below them. Long boxes are split
 * across: their cost is times longest side / side. */
static split choose_split(const entry *entries, size_t count, const bounds *all, uint32_t levels) {
    split best = {.axis = -1, .cost = INFINITY};
    double longest = 0;
    for (int c = 0; c < 3; ++c) longest = fmax(longest, all->upper[c] - all->lower[c]);
    for (int axis = 0; axis < 3; ++axis) {
        bounds bins[BINS];
        double low = INFINITY, high = -INFINITY, side = all->upper[axis] - all->lower[axis];
        for (size_t i = 0; i < count; ++i) {
            low = fmin(low, centre_of(entries + i, axis));
            high = fmax(high, centre_of(entries + i, axis));
        }
        if (!(high > low)) continue;
        split candidate = {.axis = axis, .low = low, .scale = BINS / (high - low)};
        memset(bins, 0, sizeof bins);
        for (size_t i = 0; i < count; ++i) {
            bounds one = bounds_of(&entries[i].piece);
            add_bounds(&bins[bin_of(entries + i, axis, low, candidate.scale)], &one);
        }
        try_borders(bins, longest / side, levels, &candidate, &best);
    }
    return best;
}

/* Moves the entries of the first half to the front; returns how many. Where no border has a cost (all
 * centres are one, or all boxes flat lines), the half by number. */
static size_t divide(entry *entries, size_t count, const bounds *all, uint32_t levels) {
    split s = choose_split(entries, count, all, levels);
    if (s.axis < 0) return count / 2;
    size_t front = 0;
    for (size_t i = 0; i < count; ++i) {
        if (bin_of(entries + i, s.axis, s.low, s.scale) >= s.bin) continue;
        entry e = entries[i];
        entries[i] = entries[front];
        entries[front++] = e;
    }
    return front;
}

/* ---- nodes ---- */

/* The sphere about the box's middle through the farthest corner of any piece's box, rounded outwards by
 * more than the rounding of a vertex's coordinates: 2^-18 of them, by which vertices are moved. */
static void write_sphere(float *node, const entry *entries, size_t count, const bounds *all) {
    double square = 0, size = 0;
    for (int c = 0; c < 3; ++c) node[SF_TREE_MIDDLE_X + c] = (float)(0.5 * (all->lower[c] + all->upper[c]));
    for (size_t i = 0; i < count; ++i) {
        double far = 0;
        for (int c = 0; c < 3; ++c) {
            double middle = (double)node[SF_TREE_MIDDLE_X + c], low = middle - entries[i].piece.lower[c];
            double side = fmax(low, entries[i].piece.upper[c] - middle);
            far += side * side;
            size = fmax(size, fabs(middle));
        }
        square = fmax(square, far);
    }
    node[SF_TREE_RADIUS] = (float)(sqrt(square) * (1 + 0x1p-20) + 0x1p-20 * size);
}

static void write_node(float *node, const entry *entries, size_t count, const bounds *all) {
    write_sphere(node, entries, count, all);
    double angle = fmin(all->angle, PI);
    for (int c = 0; c < 3; ++c) node[SF_TREE_AXIS_X + c] = (float)all->axis[c];
    node[SF_TREE_COSINE] = angle >= PI ? -1 : (float)cos(angle);
    node[SF_TREE_SINE] = angle >= PI ? 0 : (float)sin(angle);
}

/* Builds the node over entries first .. first + count - 1, at `depth`. */
static void build(builder *b, uint32_t node, size_t first, size_t count, uint32_t depth, uint32_t trail) {
    sf_light_tree *tree = b->tree;
    bounds all = bounds_of_all(b->entries + first, count);
    write_node(tree->nodes[node], b->entries + first, count, &all);
    if (node == 0) b->power = all.power;
    tree->nodes[node][SF_TREE_POWER] = (float)(all.power / b->power); /* far from the floats' ends */
    if (count == 1) {
        uint32_t piece = b->entries[first].number;
        tree->child[node] = SF_TREE_LEAF | piece;
        tree->trail[piece] = trail;
        tree->depth[piece] = depth;
        return;
    }
    size_t half = divide(b->entries + first, count, &all, SF_TREE_DEPTH - 1 - depth);
    uint32_t children = tree->node_count;
    tree->node_count += 2;
    tree->child[node] = children;
    build(b, children, first, half, depth + 1, trail);
    build(b, children + 1, first + half, count - half, depth + 1, trail | 1u << depth);
}

void sf_light_tree_destroy(sf_light_tree *tree) {
    if (!tree) return;
    sf_aligned_free(tree->nodes);
    free(tree->child);
    free(tree->trail);
    free(tree->depth);
    free(tree);
}

sf_status sf_light_tree_create(const sf_tree_piece *pieces, size_t count, sf_light_tree **out, sf_error *error) {
    *out = NULL;
    sf_light_tree *tree = calloc(1, sizeof *tree);
    entry *entries = malloc(count * sizeof *entries);
    if (tree) {
        tree->nodes = sf_aligned_alloc((2 * count - 1) * sizeof *tree->nodes);
        tree->child = malloc((2 * count - 1) * sizeof *tree->child);
        tree->trail = malloc(count * sizeof *tree->trail);
        tree->depth = malloc(count * sizeof *tree->depth);
    }
    if (!tree || !entries || !tree->nodes || !tree->child || !tree->trail || !tree->depth) {
        free(entries);
        sf_light_tree_destroy(tree);
        return sf_fail_memory(error, "the tree of lights", count * sizeof *entries);
    }
    for (size_t i = 0; i < count; ++i) entries[i] = (entry){.piece = pieces[i], .number = (uint32_t)i};
    tree->piece_count = (uint32_t)count;
    tree->node_count = 1;
    build(&(builder){.entries = entries, .tree = tree}, 0, 0, count, 0, 0);
    free(entries);
    *out = tree;
    return SF_STATUS_OK;
}
