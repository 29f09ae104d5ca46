// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_BIND_SCENE_H
#define SUNFLECK_BIND_SCENE_H

#include <vector>

#include "bind.h"
#include "sunfleck/scene.h"

// Owns a scene.
struct scene_handle {
    sf_scene *scene = nullptr;
    std::vector<nb::object> arrays;  // of prototypes, which Embree reads for as long as the scene lives

    scene_handle();
    ~scene_handle();
    scene_handle(const scene_handle &) = delete;
    scene_handle &operator=(const scene_handle &) = delete;
};

#endif
