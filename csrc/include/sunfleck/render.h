// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* render: a committed scene and options in, a film out. The options and the film are in film.h. */
#ifndef SUNFLECK_RENDER_H
#define SUNFLECK_RENDER_H

#include "sunfleck/film.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Renders the scene. On success *film is the caller's, to be freed with sf_film_destroy; a
 * render that was stopped early succeeds with what it has, and the film says so per pixel.
 * On failure *film is NULL.
 *
 * With seeds = pixel: the same scene, options and seed give the same film bit for bit, for any
 * number of threads, tile size and division of the work, on one instruction set.
 *
 * With checkpoint_path the state of the render is written to that file every checkpoint_seconds,
 * when it is stopped, and at its end, beside and renamed, so that the file is whole at every
 * moment. A render that finds the file goes on from it, bit for bit as if it had never stopped;
 * `seconds` counts the time of all calls together. spp and max_spp may be larger than the file's
 * and the tolerance or relmse smaller: the samples taken are kept, more are added. Any other difference that
 * decides the picture (scene, options, seed, instruction set, versions) is refused with
 * SF_STATUS_INVALID_VALUE, a file that is damaged or no checkpoint with SF_STATUS_IO, before any
 * work; the file is then left as it is. A write that fails while the render runs is a notice, and
 * the next is tried in its time. If the last write fails the call returns SF_STATUS_IO, and
 * *film is all the same the finished film, the caller's: the one failure that sets it.
 *
 * Thread-safe: several renders may run at once, of one scene or several. */
SF_API sf_status sf_render(const sf_scene *scene, const sf_render_options *options, sf_film **film, sf_error *error);

#ifdef __cplusplus
}
#endif
#endif
