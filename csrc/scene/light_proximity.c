// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Whether a scene has surfaces so near to its lights that sampling these by solid angle is of use.
 * Distances are to triangles and not to their vertices: under a low ceiling light lies the middle
 * of a floor of two triangles. */

#include <math.h>
#include <string.h>

#include "scene/scene_internal.h"

#define LARGEST 16

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The square of the distance from p to the segment from a along e. */
static double segment_square(const double p[3], const double a[3], const double e[3]) {
    double d[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]}, length = dot(e, e);
    double t = length > 0 ? fmin(fmax(dot(d, e) / length, 0), 1) : 0;
    double off[3] = {d[0] - t * e[0], d[1] - t * e[1], d[2] - t * e[2]};
    return dot(off, off);
}

/* The square of the distance from p to the triangle: to its plane where the foot lies inside, else
 * to the nearest side. */
static double triangle_square(const double p[3], double v[3][3]) {
    double e[3][3], n[3], least = INFINITY;
    bool inside = true;
    for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) e[k][c] = v[(k + 1) % 3][c] - v[k][c];
    for (int c = 0; c < 3; ++c) n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
    for (int k = 0; k < 3; ++k) {
        double d[3] = {p[0] - v[k][0], p[1] - v[k][1], p[2] - v[k][2]}, side[3];
        for (int c = 0; c < 3; ++c) side[c] = n[(c + 1) % 3] * e[k][(c + 2) % 3] - n[(c + 2) % 3] * e[k][(c + 1) % 3];
        inside &= dot(d, side) >= 0;
        least = fmin(least, segment_square(p, v[k], e[k]));
    }
    double d[3] = {p[0] - v[0][0], p[1] - v[0][1], p[2] - v[0][2]}, area = dot(n, n), height = dot(d, n);
    return inside && area > 0 ? height * height / area : least;
}

/* Whether a part of the box about the points is within the square of a distance from p. */
static bool box_within(const double p[3], double v[3][3], double square) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        double low = fmin(v[0][c], fmin(v[1][c], v[2][c])), high = fmax(v[0][c], fmax(v[1][c], v[2][c]));
        double off = fmax(fmax(low - p[c], p[c] - high), 0);
        sum += off * off;
    }
    return sum < square;
}

typedef struct near_light {
    double middle[3], normal[3], square, level; /* level: of its plane along the normal; and of what lies on it */
} near_light;

static near_light light_of(const float *piece) {
    near_light l = {.square = (double)piece[SF_LIGHT_NEAR]};
    double size = 0;
    for (int c = 0; c < 3; ++c) {
        l.middle[c] = (double)piece[SF_LIGHT_MIDDLE_X + c];
        l.normal[c] = (double)piece[SF_LIGHT_NORMAL_X + c];
        size = fmax(size, fmax(fabs((double)piece[SF_LIGHT_EDGE1_X + c]), fabs((double)piece[SF_LIGHT_EDGE2_X + c])));
    }
    l.level = dot(l.middle, l.normal) + 1e-4 * size;
    return l;
}

static bool triangle_is_near(const near_light *l, const sf_scene *scene, const sf_scene_mesh *shape, size_t triangle) {
    const sf_mesh *mesh = &shape->mesh;
    double v[3][3];
    bool front = false;
    for (int k = 0; k < 3; ++k) {
        const float *p = mesh->vertices + 3 * (size_t)mesh->triangles[3 * triangle + (size_t)k];
        sf_instance_vertex(scene, shape, p, v[k]);
        front |= dot(v[k], l->normal) > l->level;
    }
    return front && box_within(l->middle, v, l->square) && triangle_square(l->middle, v) < l->square;
}

static bool quadric_is_near(const near_light *l, const sf_quadric *quadric) {
    double square = 0, level = 0;
    for (int c = 0; c < 3; ++c) {
        double off = (double)quadric->centre[c] - l->middle[c];
        square += off * off;
        level += (double)quadric->centre[c] * l->normal[c];
    }
    return sqrt(square) - (double)quadric->radius < sqrt(l->square) && level + (double)quadric->radius > l->level;
}

/* Whether the box about a placed mesh is: its triangles need be asked only then. */
static bool place_is_near(const near_light *l, const sf_scene *scene, const sf_scene_mesh *shape) {
    const sf_prototype *prototype = scene->prototypes + shape->place.prototype;
    double box[3][3];
    float lower[3], upper[3];
    for (int c = 0; c < 3; ++c) {
        lower[c] = prototype->dark.bounds_lower[c] - prototype->offset[c];
        upper[c] = prototype->dark.bounds_upper[c] - prototype->offset[c];
    }
    sf_instance_box(&shape->place, lower, upper, box[0], box[1]);
    for (int c = 0; c < 3; ++c) {
        box[0][c] -= (double)scene->shift[c];
        box[1][c] -= (double)scene->shift[c];
    }
    memcpy(box[2], box[0], sizeof box[2]);
    return box_within(l->middle, box, l->square);
}

static bool surfaces_are_near(const sf_scene *scene, const near_light *l) {
    for (size_t m = 0; m < scene->info.mesh_count; ++m) {
        const sf_mesh *mesh = &scene->meshes[m].mesh;
        if (!sf_reflects(mesh)) continue;
        if (scene->meshes[m].quadric.kind && quadric_is_near(l, &scene->meshes[m].quadric)) return true;
        if (scene->meshes[m].place.placed && !place_is_near(l, scene, scene->meshes + m)) continue;
        for (size_t t = 0; t < mesh->triangle_count; ++t)
            if (triangle_is_near(l, scene, scene->meshes + m, t)) return true;
    }
    return false;
}

bool sf_lights_near(const sf_scene *scene) {
    size_t largest[LARGEST], count = 0;
    const sf_light_table *lights = &scene->lights;
    for (size_t i = 0; i < lights->count; ++i) {
        float near = lights->pieces[i][SF_LIGHT_NEAR];
        if (!(near > 0)) continue;
        size_t place = count < LARGEST ? count++ : LARGEST;
        while (place > 0 && lights->pieces[largest[place - 1]][SF_LIGHT_NEAR] < near) {
            if (place < LARGEST) largest[place] = largest[place - 1];
            --place;
        }
        if (place < LARGEST) largest[place] = i;
    }
    for (size_t k = 0; k < count; ++k) {
        near_light l = light_of(lights->pieces[largest[k]]);
        if (surfaces_are_near(scene, &l)) return true;
    }
    return false;
}
