// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Makes the frame of a camera, from which its rays start. */
#include <math.h>

#include "trace/batch.h"

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int c = 0; c < 3; ++c) out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double normalize(double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int c = 0; c < 3; ++c) v[c] /= length;
    return length;
}

sf_camera_frame sf_camera_frame_of(const sf_camera *camera, uint32_t width, uint32_t height) {
    double forward[3], up[3], right[3], distance;
    for (int c = 0; c < 3; ++c) {
        forward[c] = (double)camera->target[c] - camera->position[c];
        up[c] = camera->up[c];
    }
    distance = normalize(forward);
    normalize(up);
    cross(forward, up, right);
    normalize(right);
    cross(right, forward, up);
    sf_camera_frame frame = {
        .half_width = 0.5f * (float)width,
        .half_height = 0.5f * (float)height,
        .pixel = (float)(2 * tan((double)camera->vertical_fov * 3.14159265358979323846 / 360) / height),
        .aperture_radius = camera->aperture_radius,
        .focus_distance = camera->focus_distance > 0 ? camera->focus_distance : (float)distance};
    for (int c = 0; c < 3; ++c) {
        frame.position[c] = camera->position[c];
        frame.forward[c] = (float)forward[c];
        frame.right[c] = (float)right[c];
        frame.up[c] = (float)up[c];
    }
    return frame;
}
