// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a prepared set of 21,201 dimensions costs: to make, and for a point anywhere in it.
 *
 *     cc -std=c99 -O2 -I csrc/include bench/point_set.c build/csrc/libsunfleck_core.a -lm -pthread -o build/point_set
 */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "sunfleck/points.h"

enum { DIMS = 21201, RUNS = 201 };

static double milliseconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void report(const char *what, double *times, int count) {
    qsort(times, (size_t)count, sizeof *times, ascending);
    printf("%-42s %.4f (%.4f ... %.4f, %d runs) ms\n", what, times[count / 2], times[0], times[count - 1], count);
}

int main(void) {
    static float row[DIMS];
    static double times[RUNS];
    sf_points_options options = sf_points_options_default();
    options.dims = DIMS;
    sf_point_set *set = NULL;
    for (int i = 0; i < 21; ++i) {
        sf_point_set_destroy(set);
        double start = milliseconds();
        if (sf_point_set_create(&options, &set, NULL) != SF_STATUS_OK) return 1;
        times[i] = milliseconds() - start;
    }
    report("sobol, owen, 21,201 dimensions: the set", times, 21);
    for (int worst = 0; worst < 2; ++worst) {
        for (int i = 0; i < RUNS; ++i) {
            uint64_t index = worst ? 0x55555555u : (uint32_t)sf_mix64((uint64_t)i + 1);
            double start = milliseconds();
            if (sf_point_set_fill_f32(set, index, 1, row, NULL) != SF_STATUS_OK) return 1;
            times[i] = milliseconds() - start;
        }
        report(worst ? "the point whose index needs most columns" : "a point of random index", times, RUNS);
    }
    sf_point_set_destroy(set);
    return 0;
}
