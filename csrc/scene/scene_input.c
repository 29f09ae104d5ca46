// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Refuses what a scene cannot take, and hashes what it is given. */
#include "scene/scene_input.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "scene/scene_internal.h"

sf_status sf_scene_refuse_committed(const sf_scene *scene, sf_error *error) {
    if (!scene->committed) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE, "the scene is committed; it can't be changed any more");
}

sf_status sf_scene_check_color(const char *what, const float *color, float upper, sf_error *error) {
    for (int c = 0; c < 3; ++c)
        if (!(color[c] >= 0 && color[c] <= upper))
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s[%d] is %g; it must be in [0, %g]", what, c,
                           (double)color[c], (double)upper);
    return SF_STATUS_OK;
}

sf_status sf_scene_check_vector(const char *what, const float *v, sf_error *error) {
    for (int c = 0; c < 3; ++c)
        if (!(fabsf(v[c]) <= SF_LENGTH_LIMIT))
            return sf_fail(error, SF_STATUS_INVALID_VALUE, "%s[%d] is %g; it must be finite and at most %g in size",
                           what, c, (double)v[c], (double)SF_LENGTH_LIMIT);
    return SF_STATUS_OK;
}

uint64_t sf_scene_hash(uint64_t hash, const void *bytes, size_t count) {
    const unsigned char *p = bytes;
    uint64_t word;
    hash = sf_hash64(hash, count);
    for (; count >= 8; count -= 8, p += 8) {
        memcpy(&word, p, 8);
        hash = sf_mix64(hash ^ word) + UINT64_C(0x9e3779b97f4a7c15);
    }
    word = 0;
    memcpy(&word, p, count);
    return sf_hash64(hash, word);
}
