// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What a prepared set of 21,201 dimensions costs, to make, and for a point anywhere in it; and what two
 * threads gain on a prepared set of 16, where a call has nothing to do but fill.
 *
 *     cc -std=c99 -O2 -I csrc/include bench/points_prepared_set.c build/csrc/libsunfleck_core.a -lm -pthread \
 *        -o build/point_set
 */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, posix_memalign */
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

/* Fills of `count` points by one thread and by two, in turns; three of each count for nothing, so
 * that each core finds its part in its cache. */
static void compare_threads(sf_thread_team *team, sf_scramble scramble, size_t count) {
    static double times[2][RUNS];
    sf_points_options options = sf_points_options_default();
    options.dims = 16;
    options.scramble = scramble;
    options.team = team;
    float *out = NULL;
    if (posix_memalign((void **)&out, 64, count * 16 * sizeof *out)) exit(1);
    sf_point_set *sets[2];
    for (unsigned i = 0; i < 2; ++i) {
        options.threads = i + 1;
        if (sf_point_set_create(&options, sets + i, NULL) != SF_STATUS_OK) exit(1);
    }
    for (int run = 0; run < RUNS; ++run)
        for (int i = 0; i < 2; ++i)
            for (int again = 0; again < 4; ++again) {
                double start = milliseconds();
                if (sf_point_set_fill_f32(sets[i], 0, count, out, NULL) != SF_STATUS_OK) exit(1);
                times[i][run] = milliseconds() - start;
            }
    for (int i = 0; i < 2; ++i) qsort(times[i], RUNS, sizeof **times, ascending);
    double one = 1e3 * times[0][RUNS / 2], two = 1e3 * times[1][RUNS / 2];
    printf("%-5s %5.2f MiB: one thread %7.1f us, two %7.1f us, gain %.2f\n",
           scramble == SF_SCRAMBLE_OWEN ? "owen" : "plain", (double)count / 16384, one, two, one / two);
    for (int i = 0; i < 2; ++i) sf_point_set_destroy(sets[i]);
    free(out);
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
    sf_thread_team *team = NULL;
    if (sf_thread_team_create(&team, NULL) != SF_STATUS_OK) return 1;
    for (size_t count = 8192; count <= 131072; count *= 2) {
        compare_threads(team, SF_SCRAMBLE_NONE, count);
        compare_threads(team, SF_SCRAMBLE_OWEN, count);
    }
    sf_thread_team_destroy(team);
    return 0;
}
