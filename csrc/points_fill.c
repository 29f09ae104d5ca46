// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Filling arrays with points, by chunks on threads. */
#include "error.h"
#include "platform.h"
#include "points_set.h"
#include "sunfleck/points.h"

typedef enum number_type { F32, F64, U32 } number_type;

/* A thread's share of a fill: its points, and memory of its own. */
typedef struct fill_job {
    const sf_point_set *set;
    const sf_points_kernels *kernels;
    uint64_t first;
    size_t rows;
    number_type type;
    void *out;
    uint32_t *scratch;
    pthread_t thread;
    int started;
} fill_job;

static size_t chunk_rows(uint32_t dims) { return dims < SF_POINTS_CHUNK_WORDS ? SF_POINTS_CHUNK_WORDS / dims : 1; }

/* Of the cursor's state, and of the high and the low words of a chunk. */
static size_t state_words(uint32_t dims) { return 2 * ((size_t)SF_POINTS_CHUNK_WORDS + dims); }
static size_t scratch_words(uint32_t dims) { return state_words(dims) + 2 * chunk_rows(dims) * dims; }

static void *fill_share(void *argument) {
    fill_job *job = argument;
    uint32_t dims = job->set->options.dims;
    size_t step = chunk_rows(dims);
    uint32_t *high = job->scratch + state_words(dims), *low = high + step * dims;
    sf_points_cursor cursor = {job->set, job->kernels, job->scratch, UINT64_MAX};
    for (size_t row = 0, rows; row < job->rows; row += rows) {
        rows = job->rows - row < step ? job->rows - row : step;
        size_t at = row * dims, count = rows * dims;
        if (job->type == U32) high = (uint32_t *)job->out + at;
        job->set->method->make(&cursor, job->first + row, rows, high, job->type == F64 ? low : NULL);
        if (job->type == F32) job->kernels->f32(count, high, (float *)job->out + at);
        if (job->type == F64) job->kernels->f64(count, high, low, (double *)job->out + at);
    }
    return NULL;
}

/* Threads pay from some 2^16 words each: starting one takes as long as making them. */
static unsigned useful_threads(const sf_points_options *options, size_t count) {
    enum { WORDS_PER_THREAD = 1 << 16, MAX_THREADS = 256 };
    unsigned threads = options->threads ? options->threads : sf_processor_count();
    size_t most = count / ((size_t)WORDS_PER_THREAD / options->dims + 1);
    if (threads > MAX_THREADS) threads = MAX_THREADS;
    return most < threads ? (unsigned)most + !most : threads;
}

static size_t size_of(number_type type) { return type == F64 ? sizeof(double) : sizeof(float); }

static void share_out(fill_job *jobs, unsigned threads, const sf_point_set *set, uint64_t first, size_t count,
                      number_type type, void *out) {
    uint32_t dims = set->options.dims;
    size_t done = 0, share = count / threads;
    for (unsigned i = 0; i < threads; ++i, done += share)
        jobs[i] = (fill_job){.set = set,
                             .kernels = sf_points_kernels_at(sf_isa_active()),
                             .first = first + done,
                             .rows = i + 1 == threads ? count - done : share,
                             .type = type,
                             .out = (char *)out + done * dims * size_of(type),
                             .scratch = jobs[0].scratch + i * scratch_words(dims)};
}

static sf_status fill(const sf_point_set *set, uint64_t first, size_t count, number_type type, void *out,
                      sf_error *error) {
    sf_status status = sf_points_check_range(&set->options, first, count, error);
    if (status != SF_STATUS_OK || count == 0) return status;
    uint32_t dims = set->options.dims;
    unsigned threads = useful_threads(&set->options, count);
    size_t bytes = threads * (sizeof(fill_job) + scratch_words(dims) * sizeof(uint32_t)) + SF_ALIGNMENT;
    uint32_t *scratch = sf_aligned_alloc(bytes);
    if (!scratch) return sf_fail_memory(error, "the scratch of a fill", bytes);
    fill_job *jobs = (fill_job *)(void *)(scratch + threads * scratch_words(dims));
    jobs[0].scratch = scratch;
    share_out(jobs, threads, set, first, count, type, out);
    /* The last share is the caller's, and those whose thread could not be had. */
    for (unsigned i = 0; i + 1 < threads; ++i)
        jobs[i].started = pthread_create(&jobs[i].thread, NULL, fill_share, jobs + i) == 0;
    for (unsigned i = threads; i-- > 0;)
        if (!jobs[i].started) fill_share(jobs + i);
    for (unsigned i = 0; i + 1 < threads; ++i)
        if (jobs[i].started) pthread_join(jobs[i].thread, NULL);
    sf_aligned_free(scratch);
    return SF_STATUS_OK;
}

static sf_status fill_once(const sf_points_options *options, size_t count, number_type type, void *out,
                           sf_error *error) {
    sf_points_options complete = *options;
    if (complete.total == 0 && options->first <= UINT64_MAX - count) complete.total = options->first + count;
    sf_point_set set;
    sf_status status = sf_points_check_pattern(options->pattern, options->dims, error);
    if (status == SF_STATUS_OK) status = sf_points_check_range(&complete, options->first, count, error);
    if (status == SF_STATUS_OK) status = sf_point_set_init(&set, &complete, error);
    if (status != SF_STATUS_OK) return status;
    status = fill(&set, options->first, count, type, out, error);
    sf_point_set_release(&set);
    return status;
}

sf_status sf_points_fill_f32(const sf_points_options *options, size_t count, float *out, sf_error *error) {
    return fill_once(options, count, F32, out, error);
}
sf_status sf_points_fill_f64(const sf_points_options *options, size_t count, double *out, sf_error *error) {
    return fill_once(options, count, F64, out, error);
}
sf_status sf_points_fill_u32(const sf_points_options *options, size_t count, uint32_t *out, sf_error *error) {
    return fill_once(options, count, U32, out, error);
}

sf_status sf_point_set_fill_f32(const sf_point_set *set, uint64_t first, size_t count, float *out, sf_error *error) {
    return fill(set, first, count, F32, out, error);
}
sf_status sf_point_set_fill_f64(const sf_point_set *set, uint64_t first, size_t count, double *out, sf_error *error) {
    return fill(set, first, count, F64, out, error);
}
sf_status sf_point_set_fill_u32(const sf_point_set *set, uint64_t first, size_t count, uint32_t *out,
                                sf_error *error) {
    return fill(set, first, count, U32, out, error);
}
