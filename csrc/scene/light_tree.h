// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A tree over the pieces of the lights that are in the scene: each node bounds where its pieces are and
 * which ways they face, so that a piece is drawn by what it may send to a point.
 *
 * Conty Estevez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", for the
 * tree and how it is split; the bound of a node as in Pharr, Jakob & Humphreys 2023, "Physically Based
 * Rendering", section 12.6.3, over a sphere instead of a box. */
#ifndef SUNFLECK_LIGHT_TREE_H
#define SUNFLECK_LIGHT_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sunfleck/base.h"

#define SF_TREE_DEPTH 32 /* the most levels below the root */
#define SF_TREE_LEAF 0x80000000u

/* A node's 40 bytes: the sphere that holds its pieces, the cone that holds their normals, and the sum
 * of the intensities that they have along them, as a part of that of all. */
typedef enum sf_tree_field {
    SF_TREE_MIDDLE_X,
    SF_TREE_MIDDLE_Y,
    SF_TREE_MIDDLE_Z,
    SF_TREE_RADIUS,
    SF_TREE_AXIS_X,
    SF_TREE_AXIS_Y,
    SF_TREE_AXIS_Z,
    SF_TREE_COSINE, /* of the cone's half angle; -1 where all directions are faced */
    SF_TREE_SINE,
    SF_TREE_POWER,
    SF_TREE_FIELDS
} sf_tree_field;

/* Immutable once built. Node 0 is the root. */
typedef struct sf_light_tree {
    uint32_t piece_count; /* at least 2 */
    uint32_t node_count;  /* 2 piece_count - 1 */
    float (*nodes)[SF_TREE_FIELDS];
    uint32_t *child; /* of a node: its first child, which the second follows, or SF_TREE_LEAF + piece */
    uint32_t *trail; /* of a piece: bit d says which child its way takes at depth d */
    uint32_t *depth; /* of a piece: how many bits */
} sf_light_tree;

/* A piece before the tree is built. */
typedef struct sf_tree_piece {
    float lower[3], upper[3]; /* its box */
    float axis[3];            /* its unit normal */
    bool all_ways;            /* it faces all directions, instead */
    float power;              /* intensity along the normal: area x (R + G + B) */
} sf_tree_piece;

/* Builds the tree over `count` pieces, 2 .. 2^31. O(count log count). */
sf_status sf_light_tree_create(const sf_tree_piece *pieces, size_t count, sf_light_tree **tree, sf_error *error);
void sf_light_tree_destroy(sf_light_tree *tree);

#endif
