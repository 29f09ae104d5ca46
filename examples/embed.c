// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Renders a box under a lamp until every pixel is known to within 1 % of the mean, and writes it
 * as EXR. With Sunfleck installed (add --static where its libraries are static):
 *
 *   cc -std=c99 embed.c -o embed $(pkg-config --static --cflags --libs sunfleck-image)
 *   ./embed box.exr
 */
#include <stdio.h>
#include <sunfleck/image.h>
#include <sunfleck/render.h>
#include <sunfleck/scene.h>

/* z up. A floor of 10 x 10; a box of 1 x 1 x 0.8 on it; a lamp of 1 x 1 at height 3 that faces
 * down. Faces wind counter-clockwise seen from outside: the lamp emits to that side. */
static const float floor_vertices[] = {-5, -5, 0, 5, -5, 0, 5, 5, 0, -5, 5, 0};
static const float box_vertices[] = {-.5f, -.5f, 0,   .5f, -.5f, 0,   .5f, .5f, 0,   -.5f, .5f, 0,
                                     -.5f, -.5f, .8f, .5f, -.5f, .8f, .5f, .5f, .8f, -.5f, .5f, .8f};
static const float lamp_vertices[] = {-.5f, -.5f, 3, -.5f, .5f, 3, .5f, .5f, 3, .5f, -.5f, 3};
static const uint32_t quad_triangles[] = {0, 1, 2, 0, 2, 3};
static const uint32_t box_triangles[] = {4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6,
                                         1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

static sf_status add_mesh(sf_scene *scene, const float *vertices, size_t vertex_count, const uint32_t *triangles,
                          size_t triangle_count, float albedo, float emission, sf_error *error) {
    sf_mesh mesh = sf_mesh_default();
    mesh.vertices = vertices;
    mesh.vertex_count = vertex_count;
    mesh.triangles = triangles;
    mesh.triangle_count = triangle_count;
    for (int i = 0; i < 3; ++i) {
        mesh.albedo[i] = albedo;
        mesh.emission[i] = emission;
    }
    return sf_scene_add_mesh(scene, &mesh, error);
}

static sf_status build(sf_scene *scene, sf_error *error) {
    const sf_camera defaults = sf_camera_default();
    sf_camera camera = {{0, -4, 3}, {0, 0, 0.3f}, {0, 0, 1}, 35, defaults.aperture_radius, defaults.focus_distance};
    sf_status status;
    if ((status = add_mesh(scene, floor_vertices, 4, quad_triangles, 2, 0.7f, 0, error)) ||
        (status = add_mesh(scene, box_vertices, 8, box_triangles, 10, 0.7f, 0, error)) ||
        (status = add_mesh(scene, lamp_vertices, 4, quad_triangles, 2, 0, 10, error)) ||
        (status = sf_scene_set_camera(scene, &camera, error)) || (status = sf_scene_set_max_bounces(scene, 1, error)))
        return status;
    return sf_scene_commit(scene, error);
}

int main(int argc, char **argv) {
    const char *path = argc > 1 ? argv[1] : "box.exr";
    sf_render_options options = sf_render_options_default(); /* tolerance 0.01, confidence 0.95 */
    options.width = options.height = 256;

    sf_error error = {SF_STATUS_OK, ""};
    sf_scene *scene = NULL;
    sf_film *film = NULL;
    if (sf_scene_create(&scene, &error) || build(scene, &error) || sf_render(scene, &options, &film, &error) ||
        sf_image_write(film, path, &error)) {
        fprintf(stderr, "embed: %s: %s\n", sf_status_name(error.status), error.message);
    } else {
        const sf_film_summary s = sf_film_summarize(film);
        printf("%s: %.1f %% of pixels within %.3g, %.1f samples a pixel, %.2f s\n", path,
               100.0 * (double)s.reasons[SF_STOP_REASON_MET] / (double)s.pixels, s.tolerance,
               (double)s.samples / (double)s.pixels, s.seconds);
    }
    sf_film_destroy(film);
    sf_scene_destroy(scene);
    return error.status != SF_STATUS_OK;
}
