// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include <stdio.h>
#include <string.h>
#include <sunfleck/sunfleck.h>

/* The first four points of the plain Sobol' sequence, from the installed core alone. */
int main(void) {
    static const float expected[8] = {0, 0, 0.5f, 0.5f, 0.25f, 0.75f, 0.75f, 0.25f};
    float points[8];
    sf_error error;
    sf_points_options options = sf_points_options_default();
    options.scramble = SF_SCRAMBLE_NONE;
    if (sf_points_fill_f32(&options, 4, points, &error)) {
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    printf("sunfleck %s\n", sf_version());
    return memcmp(points, expected, sizeof points) != 0;
}
