// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Fills that share a team of threads and the last pattern's tables, and that their caller may interrupt. */
#include <unistd.h>

#include "base/error.h"
#include "base/platform.h"
#include "points/points_set.h"
#include "sunfleck/points.h"

#define KEPT_DIMS 256 /* the most of a set that is kept */

/* A team, and the process that its threads are in. */
typedef struct local_team {
    sf_thread_team *team;
    pid_t process;
} local_team;

struct sf_point_filler {
    sf_atomic_pointer team; /* a local_team: NULL until one is wanted; replaced in a forked child, never freed there */
    sf_atomic_pointer kept; /* a set; NULL while a fill has it */
};

/* This process's team. NULL where there is no memory for one: threads are then started for the call. */
static sf_thread_team *team_of(sf_point_filler *filler) {
    local_team *now = sf_atomic_pointer_load(&filler->team), *fresh;
    pid_t here = getpid();
    if (now && now->process == here) return now->team;
    fresh = malloc(sizeof *fresh);
    if (!fresh || sf_thread_team_create(&fresh->team, NULL) != SF_STATUS_OK) {
        free(fresh);
        return NULL;
    }
    fresh->process = here;
    /* The one replaced is the parent's: its threads are not here to be joined, its locks may be held. */
    if (sf_atomic_pointer_replace(&filler->team, now, fresh)) return fresh->team;
    sf_thread_team_destroy(fresh->team);
    free(fresh);
    now = sf_atomic_pointer_load(&filler->team);
    return now->team;
}

/* Below it no fill uses two threads, even of a team. */
static int may_share(const sf_points_options *o, size_t count) {
    return o->threads != 1 && count >= SF_TEAM_LEAST_WORDS / o->dims;
}

static int serves(const sf_point_set *set, const sf_points_options *o) {
    const sf_points_options *has = &set->options;
    sf_scramble scramble = o->scramble == SF_SCRAMBLE_DEFAULT ? sf_pattern_default_scramble(o->pattern) : o->scramble;
    return has->pattern == o->pattern && has->scramble == scramble && has->dims == o->dims && has->pad == o->pad &&
           has->seed == o->seed && has->total == o->total;
}

static int worth_keeping(const sf_points_options *o) {
    return o->dims <= KEPT_DIMS && !sf_pattern_needs_total(o->pattern);
}

typedef struct fill_job {
    const sf_point_set *set;
    const sf_points_options *options;
    sf_thread_team *team;
    size_t whole;
    sf_number_type type;
    void *out;
} fill_job;

static sf_status fill_piece(void *user, size_t first, size_t count, sf_error *error) {
    const fill_job *job = user;
    size_t row_bytes = job->options->dims * (job->type == SF_NUMBER_F64 ? sizeof(double) : sizeof(float));
    return sf_point_set_fill(job->set, job->options->threads, job->team, job->options->first + first, count, job->whole,
                             job->type, (char *)job->out + first * row_bytes, error);
}

/* A quarter of a million values, in whole blocks of the nets' kernels where a row is short: the slowest pattern takes
 * some 50 ms for them. */
static size_t smallest_piece(uint32_t dims) {
    enum { BLOCK_ROWS = 16 };
    size_t rows = ((size_t)1 << 18) / dims;
    return rows > BLOCK_ROWS ? rows / BLOCK_ROWS * BLOCK_ROWS : rows ? rows : 1;
}

static sf_status fill(sf_point_filler *filler, const sf_points_options *options, size_t count, sf_number_type type,
                      void *out, const sf_interrupt *interrupt, sf_error *error) {
    sf_points_options o = *options;
    sf_status status = sf_points_complete(&o, count, error);
    if (status != SF_STATUS_OK) return status;
    int keep = worth_keeping(&o);
    sf_point_set *set = keep ? sf_atomic_take(&filler->kept, NULL) : NULL;
    if (!set || !serves(set, &o)) {
        sf_point_set_destroy(set);
        status = sf_point_set_create(&o, &set, error);
        if (status != SF_STATUS_OK) return status;
    }
    fill_job job = {set, &o, o.team, count, type, out};
    if (!job.team && may_share(&o, count)) job.team = team_of(filler);
    status = sf_work_in_pieces(count, smallest_piece(o.dims), fill_piece, &job, interrupt, error);
    sf_point_set_destroy(keep ? sf_atomic_take(&filler->kept, set) : set);
    return status;
}

sf_status sf_point_filler_fill_f32(sf_point_filler *filler, const sf_points_options *options, size_t count, float *out,
                                   const sf_interrupt *interrupt, sf_error *error) {
    return fill(filler, options, count, SF_NUMBER_F32, out, interrupt, error);
}
sf_status sf_point_filler_fill_f64(sf_point_filler *filler, const sf_points_options *options, size_t count, double *out,
                                   const sf_interrupt *interrupt, sf_error *error) {
    return fill(filler, options, count, SF_NUMBER_F64, out, interrupt, error);
}
sf_status sf_point_filler_fill_u32(sf_point_filler *filler, const sf_points_options *options, size_t count,
                                   uint32_t *out, const sf_interrupt *interrupt, sf_error *error) {
    return fill(filler, options, count, SF_NUMBER_U32, out, interrupt, error);
}

sf_status sf_point_filler_create(sf_point_filler **filler, sf_error *error) {
    *filler = calloc(1, sizeof **filler);
    return *filler ? SF_STATUS_OK : sf_fail_memory(error, "a point filler", sizeof **filler);
}

void sf_point_filler_destroy(sf_point_filler *filler) {
    if (!filler) return;
    local_team *last = sf_atomic_take(&filler->team, NULL);
    if (last && last->process == getpid()) sf_thread_team_destroy(last->team); /* else its threads are the parent's */
    free(last);
    sf_point_set_destroy(sf_atomic_take(&filler->kept, NULL));
    free(filler);
}
