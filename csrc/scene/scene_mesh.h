// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The steps by which a mesh enters a scene or a prototype. */
#ifndef SUNFLECK_SCENE_MESH_H
#define SUNFLECK_SCENE_MESH_H

#include "scene/scene_internal.h"

/* Counts of nothing, bounds that hold nothing. */
sf_scene_info sf_scene_no_info(void);

/* Checks a mesh and takes its bounds, hash and counts into the scene's. */
sf_status sf_scene_survey_mesh(sf_scene_info *info, const sf_mesh *mesh, size_t number, sf_error *error);

/* Copies arrays that can't be read in place. */
sf_status sf_scene_keep_arrays(sf_scene_mesh *kept, sf_scene_info *info, sf_error *error);
void sf_scene_free_arrays(sf_scene_mesh *kept);

/* Gives Embree's scene the mesh as geometry `number`. */
sf_status sf_scene_attach_mesh(RTCDevice device, RTCScene embree, const sf_mesh *mesh, uint32_t number,
                               sf_error *error);

/* The list, with room for one more than the `count` of `bytes` each that it holds; NULL, the list as it was,
 * where there is no memory, which is SF_STATUS_OUT_OF_MEMORY. */
void *sf_scene_grow(void *list, size_t *capacity, size_t count, size_t bytes, const char *what, sf_error *error);
sf_status sf_scene_reserve_mesh(sf_scene *scene, sf_error *error);

/* Adds a mesh with the copies that it has, which are the scene's from here on. */
sf_status sf_scene_take_mesh(sf_scene *scene, sf_scene_mesh *kept, sf_error *error);

#endif
