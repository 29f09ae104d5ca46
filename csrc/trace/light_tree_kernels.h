// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Pieces of light drawn from the tree, and how likely that was: 16 vertices at a time, all of which go
 * down in step. */
#ifndef SUNFLECK_LIGHT_TREE_KERNELS_H
#define SUNFLECK_LIGHT_TREE_KERNELS_H

#include "base/isa_dispatch.h"
#include "scene/light_tree.h"
#include "trace/batch.h"

/* The vertices that light is chosen for. */
typedef struct sf_tree_view {
    SF_ALIGNED(float) point[3][SF_LANES];
    SF_ALIGNED(float) normal[3][SF_LANES];
    SF_ALIGNED(float) faces[SF_LANES]; /* 1 where light from behind the normal is of no use, else 0 */
} sf_tree_view;

typedef struct sf_light_tree_kernels {
    /* Draws a piece for each vertex by u in [0, 1); `chance` is its probability, above 0. The
     * probabilities of all pieces sum to 1 at any vertex. A piece has probability 0 only where it sends
     * nothing to the vertex. */
    void (*draw)(const sf_light_tree *tree, const sf_tree_view *view, const float u[SF_LANES], uint32_t piece[SF_LANES],
                 float chance[SF_LANES]);

    /* The probability with which `draw` draws the piece, to the bit. */
    void (*weigh)(const sf_light_tree *tree, const sf_tree_view *view, const uint32_t piece[SF_LANES],
                  float chance[SF_LANES]);
} sf_light_tree_kernels;
SF_KERNELS(sf_light_tree_kernels)

#endif
