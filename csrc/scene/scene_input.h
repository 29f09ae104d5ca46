// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What every file that adds to a scene asks of its input: that it may be added, is in range, and enters the hash. */
#ifndef SUNFLECK_SCENE_INPUT_H
#define SUNFLECK_SCENE_INPUT_H

#include "sunfleck/scene.h"

#define SF_LENGTH_LIMIT 1e12f   /* volumes, which Embree computes, stay finite */
#define SF_RADIANCE_LIMIT 1e18f /* sums and products with weights stay finite */

/* Refuses a scene that is committed: it cannot be changed any more. */
sf_status sf_scene_refuse_committed(const sf_scene *scene, sf_error *error);

/* Refuses a value that is not in [0, upper]; NaN is in no interval. */
sf_status sf_scene_check_color(const char *what, const float *color, float upper, sf_error *error);

/* Refuses coordinates that are not finite or beyond SF_LENGTH_LIMIT. */
sf_status sf_scene_check_vector(const char *what, const float *v, sf_error *error);

/* The hash of all that `hash` stands for and of `count` bytes after it. */
uint64_t sf_scene_hash(uint64_t hash, const void *bytes, size_t count);

#endif
