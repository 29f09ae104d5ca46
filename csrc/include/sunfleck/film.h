// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* film: what a render is asked for (its options), and what it leaves: per pixel the mean radiance, how
 * many samples it took, how far it may be off, and why it stopped; channels, attributes, a summary.
 */
#ifndef SUNFLECK_FILM_H
#define SUNFLECK_FILM_H

#include "sunfleck/base.h"
#include "sunfleck/points.h"
#include "sunfleck/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SF_MAX_IMAGE_SIZE 65536u       /* pixels a side */
#define SF_MAX_SPP (UINT32_C(1) << 31) /* samples a pixel */
#define SF_MAX_THREADS 1024u
#define SF_CELL_SIZE 8u /* pixels a side of the cells that rays are packed in */

/* What a pixel averages over: the pixel filters of mapping_pixel.h, whose densities its samples are
 * drawn from (filter importance sampling). Every sample has weight 1 and a constant image stays
 * constant, exactly, for any number of samples. So it does under the last two, which have negative
 * lobes: their samples are drawn by |f| and averaged for either sign by itself; the pixel is
 * (1 + b) m+ - b m-, where b is the integral of the negative part. Pixels may then be negative, and
 * a film takes 104 bytes more for each. */
typedef enum sf_pixel_filter {
    SF_PIXEL_FILTER_BOX = 0,            /* the pixel itself */
    SF_PIXEL_FILTER_TENT,               /* two pixels wide: reaches half a pixel past the border */
    SF_PIXEL_FILTER_GAUSSIAN,           /* sigma 0.4 pixel, unbounded: 38 % of the samples lie outside the pixel */
    SF_PIXEL_FILTER_GAUSSIAN_TRUNCATED, /* the same within 1.5 pixels of the centre, renormalized */
    SF_PIXEL_FILTER_BLACKMAN_HARRIS,    /* the 4-term window, three pixels wide */
    SF_PIXEL_FILTER_MITCHELL,           /* Mitchell-Netravali, B = C = 1/3, four pixels wide; b = 0.0724 */
    SF_PIXEL_FILTER_LANCZOS             /* three lobes, six pixels wide; b = 0.4223 */
} sf_pixel_filter;

/* When a pixel is done. */
typedef enum sf_stop_rule {
    /* The classic rule: z(confidence) s / sqrt(N) <= tolerance after min_spp samples, with the
     * running vector mean and the scalar sum of squares. Kept as the baseline: points of a
     * low-discrepancy pattern are not independent (it then overstates), and a pixel that has
     * seen nothing has variance zero (it then stops, wrongly). */
    SF_STOP_RULE_STANDARD_ERROR = 0,

    /* Eight independent replicates of the pattern a pixel, and Student's t over their means. Looks
     * at 128, 256, 512, … samples. The plainest of arguments, at the price of the pattern's
     * strength at n / 8 points. */
    SF_STOP_RULE_REPLICATES,

    /* The default. Differences between the halves of one sequence, the halves' own halves, … four
     * levels down, whose decay says how variance falls with n; pooled over the pixels around. Looks
     * at 32, 64, 128, … samples, where min_spp allows. Coverage and cost measured: docs/render.md. */
    SF_STOP_RULE_DYADIC
} sf_stop_rule;

/* How threads come by their random numbers. */
typedef enum sf_seed_policy {
    SF_SEEDS_PIXEL = 0, /* keyed by seed, pixel and dimension: the picture depends on no thread */
    SF_SEEDS_THREAD,    /* a stream of its own for each thread */
    SF_SEEDS_SHARED     /* the same stream for every thread, a common fault: N threads
                           repeat one another's noise; for the laboratory */
} sf_seed_policy;

/* Why a pixel stopped. */
typedef enum sf_stop_reason {
    SF_STOP_REASON_FIXED = 0,   /* the fixed count asked for was taken */
    SF_STOP_REASON_MET,         /* half-width within the tolerance; or the goal of the whole picture reached */
    SF_STOP_REASON_MAX_SAMPLES, /* max_spp reached first */
    SF_STOP_REASON_OUT_OF_TIME, /* the time limit came first */
    SF_STOP_REASON_SUSPICIOUS,  /* samples that were not finite were dropped; or, by the rule dyadic, a heavy
                            tail was seen: light is rare around the pixel, which has seen less of it
                            than its neighbours, and was taken to be less certain than it looked; it
                            ended by max_spp, time or budget */
    SF_STOP_REASON_INTERRUPTED, /* the caller asked to stop */
    SF_STOP_REASON_MASKED,      /* the mask leaves the pixel out */
    SF_STOP_REASON_COUNT
} sf_stop_reason;

/* The names of these enumerations, "box", "standard_error", "pixel", "met", …; NULL for a
 * value beyond the last, so that they can be listed. */
SF_API const char *sf_pixel_filter_name(sf_pixel_filter filter);
SF_API const char *sf_stop_rule_name(sf_stop_rule rule);
SF_API const char *sf_seed_policy_name(sf_seed_policy policy);
SF_API const char *sf_stop_reason_name(sf_stop_reason reason);

/* Whether the renderer takes the pattern: not 0 for uniform, random, jittered, halton and sobol. */
SF_API int sf_render_takes_pattern(sf_pattern pattern);

/* What a film can hold beside the colours, where it is asked for: arbitrary output variables.
 *
 * Albedo, normal and depth are of the camera rays' first hits, averaged over every sample of the
 * pixel, also those whose radiance was dropped; a sample that hit nothing has albedo and normal 0,
 * and no depth. Values of the surface alone: a light's albedo is its mesh's, its emission does
 * not count. The channels' names are those that EXR readers know. */
typedef enum sf_aov {
    SF_AOV_ALBEDO = 0, /* albedo.R .G .B, in [0, 1] */
    SF_AOV_NORMAL,     /* normal.X .Y .Z: unit normals in the scene's axes, on the side that is seen;
                          their mean is shorter where they differ */
    SF_AOV_DEPTH,      /* Z: distance along the camera's axis (not along the ray), the mean over the
                          samples that hit; infinity where none did */
    SF_AOV_VARIANCE,   /* variance: of the pixel's mean of (R+G+B)/3, as half_width has it; infinity
                          below 2 samples */
    SF_AOV_HALF_A,     /* half_a.R .G .B: mean radiance of samples 0-15, 32-47, 64-79, … */
    SF_AOV_HALF_B,     /* half_b.R .G .B: of the others; 0 where there were none yet. The two halves
                          have the mean as their mean, weighted by their counts (under a filter with
                          negative lobes but for a part of the half-width) */
    SF_AOV_COUNT
} sf_aov;
SF_API const char *sf_aov_name(sf_aov aov); /* "albedo", …; NULL beyond the last */

/* How far a render is: given to the progress callback. */
typedef struct sf_progress {
    uint32_t round;            /* rounds finished */
    uint64_t samples;          /* paths traced so far */
    uint64_t pixels;           /* pixels of the crop that the mask leaves */
    uint64_t pixels_done;      /* of these, stopped */
    uint64_t expected_samples; /* samples where the count is fixed, else 0 */
    double seconds;            /* since the start */
    double time_limit;         /* the seconds option, 0 where there is none */
    int round_finished;        /* 1 at a round's end, 0 for the calls in between */
    uint64_t pixels_met;       /* of those done, stopped because they met the tolerance */
    double tolerance;          /* in linear radiance; 0 until it is known, or where none was asked */
    double relmse;             /* of a goal: the estimate before the last lap; pixels_done are then those that it
                                  wants no more samples of. 0 where none was asked */
} sf_progress;

/* Called from the thread that called sf_render, at every round's end and at least every 50 ms;
 * a return other than 0 stops the render, which keeps what it has. */
typedef int (*sf_progress_fn)(const sf_progress *progress, void *user);

/* Told what a user should know and no error stops: a checkpoint that can't be written while the
 * render goes on. Called from the thread that called sf_render; the message lives for the call. */
typedef void (*sf_notice_fn)(const char *message, void *user);

typedef struct sf_render_options {
    uint32_t width, height;       /* of the full frame, 1 .. SF_MAX_IMAGE_SIZE; default 512 */
    uint32_t crop[4];             /* x0, y0, x1, y1, half open, in pixels of the full frame; all 0: the
                                     whole frame. Cells that the crop touches are traced whole, so that
                                     its pixels are the full frame's, bit for bit, at fixed spp (and
                                     adaptively with an absolute tolerance) */
    uint32_t spp;                 /* fixed samples a pixel, 0 .. SF_MAX_SPP; default 0: adaptive */
    uint32_t start;               /* index of every pixel's first sample, with spp only; start + spp at
                                     most SF_MAX_SPP; default 0. Renders of [0, a) and [a, b) hold the
                                     samples of one of [0, b), where the pattern has no total to know */
    double relative_tolerance;    /* of the level: the mean over the frame (the crop) of (R+G+B)/3
                                   after min_spp; >= 0; default 0 */
    double absolute_tolerance;    /* linear radiance, >= 0; default 0. A pixel is done when its
                                   half-width is at most max(absolute, relative * level). With spp,
                                   seconds and both tolerances 0, the relative one is 0.01 */
    double relmse;                /* goal of the whole picture in place of a tolerance for each pixel: that the mean
                                     over pixels and channels of (x - r)^2 / (r^2 + 0.01) be at most so much,
                                     by the variances that the stopping rule tells (dyadic: times its safety of
                                     1.38). Samples go where they lower it most; >= 0; default 0: none */
    double confidence;            /* of the half-widths, in (0, 1); default 0.95 */
    uint32_t min_spp;             /* before any decision, 2 .. max_spp; default 32 */
    uint32_t max_spp;             /* 2 .. SF_MAX_SPP; default 4096 */
    uint64_t samples;             /* budget of samples of the traced region, without spp and tolerances:
                                     they go where they lower the largest half-width most; 0: none
                                     (default); at least one a pixel */
    double seconds;               /* time limit, > 0; 0: none (default). Alone it is a budget, spent as
                                     `samples` is */
    sf_pattern pattern;           /* one that sf_render_takes_pattern; default sobol */
    sf_pixel_filter pixel_filter; /* default box */
    sf_stop_rule stop;            /* default dyadic */
    uint32_t unbiased;            /* not 0: two stages (Kirk and Arvo 1991). A pilot decides each pixel's
                                     count by the rule, and gives half-width and stop reason; a second
                                     set of as many samples, independent of it, is averaged.
                                     What the rule stops on is then not what the picture shows, which
                                     a rule that stops on its own samples biases. Costs as much again:
                                     of `samples` and `seconds` the pilot has half. Not with spp, which
                                     is unbiased. Default 0 */
    sf_seed_policy seeds;         /* default pixel */
    uint64_t seed;                /* default 0 */
    uint32_t threads;             /* 1 .. SF_MAX_THREADS; 0: one for each processor (default) */
    uint32_t tile_size;           /* pixels a side of what a thread takes at a time, a multiple of 8,
                                     8 .. 1024; default 16. Changes no bit of the film */
    uint32_t aovs;                /* bit k asks for sf_aov k: 1u << SF_AOV_DEPTH | …; default 0. A render
                                     that asks for none neither keeps nor computes any */
    const uint8_t *mask;          /* which pixels to render, those not 0: height rows of width bytes, in
                                     pixels of the full frame whatever the crop; NULL: all (default).
                                     Read before the first round only. The others have no samples,
                                     half-width infinity and stop reason masked. Cells that the mask
                                     touches are traced whole, as a crop's are, so that its pixels are
                                     the full frame's, bit for bit, at fixed spp (and adaptively with an
                                     absolute tolerance and a rule that looks at each pixel by itself;
                                     the level of a relative one is of the mask's pixels). A mask of
                                     scattered pixels may cost up to 64 times as many as it has. One
                                     that leaves no pixel of the crop is refused */
    size_t mask_stride;           /* bytes from row to row, >= width; 0: width (default) */
    sf_progress_fn progress;      /* default NULL */
    void *progress_user;
    const char *checkpoint_path; /* default NULL: none. Where the file exists the render goes on from
                                it, and is refused where it was made for another picture; see
                                sf_render. Needs seeds = pixel */
    double checkpoint_seconds;   /* between writes while the render runs, 0 .. 1e9; default 30 */
    sf_notice_fn notice;         /* default NULL */
    void *notice_user;
    uint32_t roulette; /* bounce from which on paths end by Russian roulette, 2 .. SF_MAX_BOUNCES; 0: they don't
                          (default). At each such vertex a path goes on with the probability of its throughput's
                          largest channel, 1/32 at least and 1 at most, by which it is divided: the mean stays.
                          Takes a sample dimension at each; costs nothing where it is 0 */
    int profile;       /* default 0; else the summary tells what the threads' time went to, see sf_work. Costs up to
                          1 % of the time; no bit of the film depends on it */
} sf_render_options;

SF_API sf_render_options sf_render_options_default(void);

/* The options that describe a picture, as a table: for bindings, commands and files. What a render is told beside
 * them (mask, progress, checkpoint, notice, profile) is not in it. */
typedef enum sf_option_type {
    SF_OPTION_UINT32 = 0, /* uint32_t */
    SF_OPTION_UINT64,     /* uint64_t */
    SF_OPTION_FLOAT64,    /* double */
    SF_OPTION_FLAG,       /* uint32_t, 0 or not */
    SF_OPTION_CHOICE,     /* an enumeration */
    SF_OPTION_NAMES,      /* uint32_t, bit k for the k-th name */
    SF_OPTION_RECTANGLE   /* uint32_t[4]: x0, y0, x1, y1, half open */
} sf_option_type;

/* How a render may differ in an option from the checkpoint that it goes on from. */
typedef enum sf_option_resume {
    SF_RESUME_EQUAL = 0, /* not at all */
    SF_RESUME_LARGER,    /* larger is more of the same */
    SF_RESUME_TOLERANCE, /* the tolerance that results may be smaller */
    SF_RESUME_FREE       /* it decides no bit of the picture */
} sf_option_resume;

typedef struct sf_option {
    const char *name; /* of the field */
    sf_option_type type;
    sf_option_resume resume;
    size_t offset; /* of the field in sf_render_options */
    double otherwise, lowest,
        highest;         /* default; range of a number, ends included. 0 is allowed where it is the default */
    const char *allowed; /* the range in words; NULL: from lowest to highest */
    const char *(*name_of)(int value); /* of a choice and of names, NULL beyond; NULL for others */
    const char *text;                  /* what it is, in a line */
} sf_option;

/* The option at an index; NULL beyond. Thread-safe. */
SF_API const sf_option *sf_render_option(size_t index);

typedef struct sf_film sf_film;

/* The film that a checkpoint holds: pixels that had not stopped are marked interrupted. Fails with
 * SF_STATUS_IO where the file can't be read, is damaged, or is no checkpoint. Thread-safe. */
SF_API sf_status sf_film_load(const char *path, sf_film **film, sf_error *error);

/* Writes the film whole, some 120 bytes a pixel, beside and renamed: sf_film_load gives it back bit for bit,
 * but for the summary's work_seconds, and it merges as before. A render does not go on from such a file.
 * SF_STATUS_IO where it can't be written; whatever was at `path` is then still there. Thread-safe. */
SF_API sf_status sf_film_save(const sf_film *film, const char *path, sf_error *error);

/* One film of several of the same scene, frame size, pattern, pixel filter, stop rule and confidence:
 * replicates (other seeds over the same pixels), tiles (crops that together fill a rectangle), or
 * both. Works on the accumulators: a pixel's counts and moments merge as if its samples had been
 * added one film after the other, in the order given. Films are independent, so that of n_i samples
 * with half-widths h_i the merged mean has half-width sqrt(sum (n_i h_i)^2) / sum n_i. A pixel is
 * met where that is within the smallest tolerance of the films; else it has the least final of its
 * reasons. Options other than these are described as the first film's.
 *
 * Refuses films that differ in what is named above, that have a seed in common where they overlap
 * (their samples are the same), and crops that leave a gap: SF_STATUS_INVALID_VALUE. The films stay
 * the caller's. Thread-safe. */
SF_API sf_status sf_film_merge(const sf_film *const *films, size_t count, sf_film **merged, sf_error *error);

/* Frees the film; NULL is allowed. Its memory, if at most 64 MiB, is kept for the next film of its size. */
SF_API void sf_film_destroy(sf_film *film);

/* One channel of a film: an array of rows, top first. */
typedef enum sf_channel_type { SF_CHANNEL_FLOAT32 = 0, SF_CHANNEL_UINT32, SF_CHANNEL_UINT8 } sf_channel_type;

typedef struct sf_channel {
    const char *name; /* R G B A samples half_width stop_reason, in this order, then those of
                         the AOVs asked for, in the order of sf_aov */
    sf_channel_type type;
    const void *data;    /* of pixel (0, 0); lives as long as the film */
    size_t pixel_stride; /* bytes */
    size_t row_stride;   /* bytes */
} sf_channel;

/* The film's own size: the crop's. */
SF_API uint32_t sf_film_width(const sf_film *film);
SF_API uint32_t sf_film_height(const sf_film *film);

/* The list that every image writer walks. R, G, B interleave (pixel_stride 12); A is the share
 * of samples that hit a surface; half_width bounds the error of (R+G+B)/3 at the confidence
 * asked for, infinity where fewer than two samples were taken; stop_reason holds sf_stop_reason. */
SF_API size_t sf_film_channel_count(const sf_film *film);
SF_API sf_channel sf_film_channel(const sf_film *film, size_t index);

/* The first channel of an AOV, and how many it has; they interleave, as R, G, B do. 0, and *first
 * as it was, for one that was not asked for. */
SF_API int sf_film_aov(const sf_film *film, sf_aov aov, sf_channel *first);

/* One attribute: every option as it was used (chosen defaults filled in), the seed, version,
 * instruction set, scene hash, and what came of it. */
typedef struct sf_attribute {
    const char *name;
    const char *text; /* as text in every case; numbers round-trip */
} sf_attribute;
SF_API size_t sf_film_attribute_count(const sf_film *film);
SF_API sf_attribute sf_film_attribute(const sf_film *film, size_t index);

/* What a thread does. */
typedef enum sf_work {
    SF_WORK_COORDINATES = 0, /* the pattern's points */
    SF_WORK_CAMERA,          /* making rays from them */
    SF_WORK_CAMERA_RAYS,     /* the three kinds of rays: tracing them, in Embree, and packing them for it */
    SF_WORK_SHADOW_RAYS,
    SF_WORK_SURFACE_RAYS,
    SF_WORK_VERTICES, /* what was hit, and which paths go on */
    SF_WORK_LIGHT,    /* sampling lights, ordering shadow rays, adding what arrives */
    SF_WORK_SURFACE,  /* sampling materials, and the light that surface rays find */
    SF_WORK_SUMS,     /* statistics of blocks of samples */
    SF_WORK_FILM,     /* adding them to the pixels; making up the next batch */
    SF_WORK_COUNT
} sf_work;
/* "coordinates", "camera", "camera rays", "shadow rays", "surface rays", "vertices", "light", "surface",
 * "sums", "film"; NULL for a number beyond. */
SF_API const char *sf_work_name(sf_work work);

/* What a render came to, over the film's pixels; those that a mask leaves out count nowhere. */
typedef struct sf_film_summary {
    uint64_t pixels;
    uint64_t samples;                       /* in the film's pixels */
    uint64_t traced_samples;                /* with those of the crop's and the mask's margin */
    uint64_t reasons[SF_STOP_REASON_COUNT]; /* pixels by stop reason */
    uint64_t nonfinite_samples;             /* dropped, never averaged in */
    double level;                           /* mean of (R+G+B)/3 that a relative tolerance refers to */
    double tolerance;                       /* in linear radiance; 0 where none was asked */
    double confidence;
    double worst_half_width;   /* the largest, and where */
    uint32_t worst_x, worst_y; /* in pixels of the full frame */
    double mean_half_width;
    double relmse;  /* estimate of the mean over pixels and channels of (x - r)^2 / (r^2 + 0.01), from the variances
                       that the half-widths came from (dyadic: times its safety of 1.38); infinity where a pixel has
                       fewer than two samples */
    double seconds; /* of the render call */
    uint32_t threads, rounds;
    double work_seconds[SF_WORK_COUNT]; /* of all threads, by sf_work; 0 unless options.profile. What is left of
                                           threads * seconds is decisions, their barriers, and waiting */
} sf_film_summary;
SF_API sf_film_summary sf_film_summarize(const sf_film *film);

#ifdef __cplusplus
}
#endif
#endif
