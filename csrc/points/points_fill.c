// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Filling arrays with points, by chunks on threads. */
#include "base/error.h"
#include "base/parallel.h"
#include "base/platform.h"
#include "points/points_set.h"
#include "points/thread_team.h"
#include "sunfleck/points.h"

/* A thread's share of a fill: its points, and memory of its own. */
typedef struct fill_job {
    const sf_point_set *set;
    sf_isa isa;
    uint64_t first;
    size_t rows;
    sf_number_type type;
    int streams; /* write past the caches */
    char *out;
    uint32_t *scratch;
} fill_job;

static size_t size_of(sf_number_type type) { return type == SF_NUMBER_F64 ? sizeof(double) : sizeof(float); }

/* Points made at a time. Padded sets want a few even where a row is long. */
static size_t chunk_rows(const sf_points_options *o) {
    enum { PADDED_ROWS = 16 };
    size_t rows = o->dims < SF_POINTS_CHUNK_WORDS ? SF_POINTS_CHUNK_WORDS / o->dims : 1;
    return o->pad && rows < PADDED_ROWS ? PADDED_ROWS : rows;
}

/* The scratch holds the cursor's state, the high and the low words of a chunk, and its numbers. */
static size_t state_words(const sf_points_options *o) {
    return 2 * (size_t)SF_POINTS_CHUNK_WORDS + (size_t)SF_POINTS_STATE_WORDS * o->dims;
}
static size_t chunk_words(const sf_points_options *o) {
    return (chunk_rows(o) * o->dims + SF_ALIGNMENT - 1) / SF_ALIGNMENT * SF_ALIGNMENT;
}
static size_t scratch_words(const sf_points_options *o) { return state_words(o) + 4 * chunk_words(o); }

static void make_numbers(sf_points_cursor *cursor, uint64_t first, size_t rows, sf_number_type type, uint32_t *words,
                         void *out) {
    const sf_point_set *set = cursor->set;
    size_t count = rows * set->options.dims;
    uint32_t *high = type == SF_NUMBER_U32 ? out : words, *low = words + chunk_words(&set->options);
    (set->padded ? sf_pad_make : set->method->make)(cursor, first, rows, high, type == SF_NUMBER_F64 ? low : NULL);
    if (type == SF_NUMBER_F32) cursor->kernels->f32(count, high, out);
    if (type == SF_NUMBER_F64) cursor->kernels->f64(count, high, low, out);
}

static void fill_share(void *user, unsigned share) {
    const fill_job *job = (const fill_job *)user + share;
    const sf_points_options *o = &job->set->options;
    size_t step = chunk_rows(o), row_bytes = o->dims * size_of(job->type);
    uint32_t *words = job->scratch + state_words(o), *numbers = words + 2 * chunk_words(o);
    sf_points_cursor cursor = {job->set, sf_points_kernels_at(job->isa), job->scratch, UINT64_MAX,
                               sf_net_kernels_at(job->isa)};
    if (job->set->net && !job->set->net->nested) {
        sf_net_rows(&cursor, job->first, job->rows, job->type, job->streams, job->out);
        if (job->streams) sf_stream_end();
        return;
    }
    /* The first chunk ends where an aligned block does. */
    size_t rows = step - (size_t)(job->first % step);
    for (size_t row = 0; row < job->rows; row += rows, rows = step) {
        if (rows > job->rows - row) rows = job->rows - row;
        char *out = job->out + row * row_bytes;
        make_numbers(&cursor, job->first + row, rows, job->type, words, job->streams ? (void *)numbers : out);
        if (job->streams) sf_stream_copy(out, numbers, rows * row_bytes);
    }
    if (job->streams) sf_stream_end();
}

/* Threads pay from some 2^16 words each, as starting one takes as long as making them; a team's,
 * which need not be started, from half as many. */
static unsigned useful_threads(const sf_point_set *set, size_t count, uint32_t asked, const sf_thread_team *team) {
    size_t least_words = team ? SF_TEAM_LEAST_WORDS : 2 * SF_TEAM_LEAST_WORDS;
    return sf_parallel_threads(asked, count / (least_words / set->options.dims + 1));
}

/* Arrays that the last cache can't hold are written past it, without reading first what is
 * overwritten. A core's part of that cache is smaller than its size: on a shared one of 32 MiB,
 * 8 MiB are still written faster the usual way, 16 MiB half again as fast this way. */
#define STREAM_BYTES ((size_t)12 << 20)

static void share_out(fill_job *jobs, unsigned threads, const sf_point_set *set, uint64_t first, size_t count,
                      size_t whole, sf_number_type type, void *out) {
    size_t done = 0, share = count / threads, row_bytes = set->options.dims * size_of(type);
    for (unsigned i = 0; i < threads; ++i, done += share)
        jobs[i] = (fill_job){.set = set,
                             .isa = sf_isa_active(),
                             .first = first + done,
                             .rows = i + 1 == threads ? count - done : share,
                             .type = type,
                             .streams = whole * row_bytes >= STREAM_BYTES,
                             .out = (char *)out + done * row_bytes,
                             .scratch = jobs[0].scratch + i * scratch_words(&set->options)};
}

static void fill_item(void *user, unsigned worker, size_t share) {
    (void)worker;
    fill_share(user, (unsigned)share);
}

/* What even the quickest pattern takes some 50 us for. */
#define LONG_WORDS ((size_t)1 << 19)

static void work_shares(fill_job *jobs, unsigned threads, sf_thread_team *team) {
    int is_long = jobs[0].rows >= LONG_WORDS / threads / jobs[0].set->options.dims;
    if (threads > 1 && team && sf_thread_team_run(team, threads, is_long, fill_share, jobs)) return;
    sf_parallel_for(threads, threads, fill_item, jobs);
}

sf_status sf_point_set_fill(const sf_point_set *set, uint32_t asked, sf_thread_team *team, uint64_t first, size_t count,
                            size_t whole, sf_number_type type, void *out, sf_error *error) {
    sf_status status = sf_points_check_range(&set->options, first, count, error);
    if (status != SF_STATUS_OK || count == 0) return status;
    unsigned threads = useful_threads(set, count, asked, team);
    size_t bytes = threads * (sizeof(fill_job) + scratch_words(&set->options) * sizeof(uint32_t)) + SF_ALIGNMENT;
    uint32_t *scratch = sf_aligned_alloc(bytes);
    if (!scratch) return sf_fail_memory(error, "the scratch of a fill", bytes);
    fill_job *jobs = (fill_job *)(void *)(scratch + threads * scratch_words(&set->options));
    jobs[0].scratch = scratch;
    share_out(jobs, threads, set, first, count, whole, type, out);
    work_shares(jobs, threads, team);
    sf_aligned_free(scratch);
    return SF_STATUS_OK;
}

static sf_status fill(const sf_point_set *set, uint64_t first, size_t count, sf_number_type type, void *out,
                      sf_error *error) {
    return sf_point_set_fill(set, set->options.threads, set->options.team, first, count, count, type, out, error);
}

static sf_status fill_once(const sf_points_options *options, size_t count, sf_number_type type, void *out,
                           sf_error *error) {
    sf_points_options complete = *options;
    sf_point_set set;
    sf_status status = sf_points_complete(&complete, count, error);
    if (status == SF_STATUS_OK) status = sf_point_set_init(&set, &complete, error);
    if (status != SF_STATUS_OK) return status;
    status = fill(&set, options->first, count, type, out, error);
    sf_point_set_release(&set);
    return status;
}

sf_status sf_points_fill_f32(const sf_points_options *options, size_t count, float *out, sf_error *error) {
    return fill_once(options, count, SF_NUMBER_F32, out, error);
}
sf_status sf_points_fill_f64(const sf_points_options *options, size_t count, double *out, sf_error *error) {
    return fill_once(options, count, SF_NUMBER_F64, out, error);
}
sf_status sf_points_fill_u32(const sf_points_options *options, size_t count, uint32_t *out, sf_error *error) {
    return fill_once(options, count, SF_NUMBER_U32, out, error);
}

sf_status sf_point_set_fill_f32(const sf_point_set *set, uint64_t first, size_t count, float *out, sf_error *error) {
    return fill(set, first, count, SF_NUMBER_F32, out, error);
}
sf_status sf_point_set_fill_f64(const sf_point_set *set, uint64_t first, size_t count, double *out, sf_error *error) {
    return fill(set, first, count, SF_NUMBER_F64, out, error);
}
sf_status sf_point_set_fill_u32(const sf_point_set *set, uint64_t first, size_t count, uint32_t *out, sf_error *error) {
    return fill(set, first, count, SF_NUMBER_U32, out, error);
}
