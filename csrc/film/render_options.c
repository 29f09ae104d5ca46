// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* What options of a render mean together, and what is filled in where one is left open. */
#include "film/render_options.h"

#include <inttypes.h>
#include <math.h>

#include "base/error.h"
#include "base/platform.h"
#include "film/block.h"
#include "film/mask.h"
#include "film/option_table.h"
#include "film/stopping.h"

int sf_render_takes_pattern(sf_pattern pattern) {
    return pattern == SF_PATTERN_UNIFORM || pattern == SF_PATTERN_RANDOM || pattern == SF_PATTERN_JITTERED ||
           pattern == SF_PATTERN_HALTON || pattern == SF_PATTERN_SOBOL;
}

sf_render_options sf_render_options_default(void) {
    sf_render_options options = {.checkpoint_seconds = 30};
    sf_options_set_defaults(&options);
    return options;
}

static sf_status check_crop(sf_render_options *o, sf_error *error) {
    uint32_t *c = o->crop;
    if (!c[0] && !c[1] && !c[2] && !c[3]) {
        c[2] = o->width;
        c[3] = o->height;
    }
    if (c[0] < c[2] && c[2] <= o->width && c[1] < c[3] && c[3] <= o->height) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_INVALID_VALUE,
                   "crop is (%u, %u, %u, %u); (x0, y0, x1, y1) must have 0 <= x0 < x1 <= %u and 0 <= y0 < y1 <= %u",
                   c[0], c[1], c[2], c[3], o->width, o->height);
}

static sf_status check_sizes(sf_render_options *o, sf_error *error) {
    sf_status status = check_crop(o, error);
    if (!status && o->tile_size % SF_CELL_SIZE)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "tile_size is %u; it must be a multiple of %u", o->tile_size,
                       SF_CELL_SIZE);
    if (!o->threads) o->threads = sf_processor_count();
    return status;
}

static sf_status check_budget(sf_render_options *o, sf_error *error) {
    if (o->min_spp > o->max_spp)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "min_spp is %u; it must be 2 to %u", o->min_spp, o->max_spp);
    if (o->start && (!o->spp || o->start > SF_MAX_SPP - o->spp))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "start is %u and spp is %u; a start goes with a fixed spp, and start + spp is at most %u",
                       o->start, o->spp, SF_MAX_SPP);
    bool tolerance = sf_has_tolerance(o);
    if (o->relmse > 0 && (o->spp || tolerance || o->samples))
        return sf_fail(
            error, SF_STATUS_INVALID_VALUE,
            "relmse is %g beside spp, samples or a tolerance; give one: an error of the whole picture, one of "
            "each pixel, a fixed count, or a budget",
            o->relmse);
    if (o->spp && tolerance)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "spp is %u and a tolerance is given too; give one: a fixed count, or an accuracy", o->spp);
    if (o->samples && (o->spp || tolerance))
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "samples is %" PRIu64
                       " beside spp or a tolerance; a budget of samples stands alone or with seconds",
                       o->samples);
    if (o->spp && o->unbiased)
        return sf_fail(error, SF_STATUS_INVALID_VALUE,
                       "spp is %u and unbiased is set too; a fixed count is unbiased already: give one", o->spp);
    if (!o->spp && !tolerance && !(o->relmse > 0) && !o->samples && !(o->seconds > 0)) o->relative_tolerance = 0.01;
    return SF_STATUS_OK;
}

static sf_status check_aovs(const sf_render_options *o, sf_error *error) {
    bool halves = o->aovs >> SF_AOV_HALF_A & 1u || o->aovs >> SF_AOV_HALF_B & 1u;
    if (halves && o->spp && o->start / SF_LANES == (o->start + o->spp - 1) / SF_LANES)
        return sf_fail(
            error, SF_STATUS_INVALID_VALUE,
            "aovs half_a and half_b take blocks of %d samples in turn, and spp is %u, in one block; it must be "
            "at least %d",
            SF_LANES, o->spp, SF_LANES + 1);
    return SF_STATUS_OK;
}

static sf_status check_checkpoint(const sf_render_options *o, sf_error *error) {
    if (!(o->checkpoint_seconds >= 0 && o->checkpoint_seconds <= 1e9))
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "checkpoint_seconds is %g; it must be in [0, 1e9]",
                       o->checkpoint_seconds);
    if (o->checkpoint_path && !*o->checkpoint_path)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "checkpoint is an empty path; give a file's");
    if (o->checkpoint_path && o->seeds != SF_SEEDS_PIXEL)
        return sf_fail(
            error, SF_STATUS_INVALID_VALUE,
            "checkpoint needs seeds pixel; with seeds %s the samples depend on which thread takes which tile, "
            "and a render that is resumed would not be the same",
            sf_seed_policy_name(o->seeds));
    return SF_STATUS_OK;
}

sf_status sf_render_options_complete(sf_render_options *options, sf_error *error) {
    sf_status status = sf_options_check_ranges(options, error);
    if (!status) status = check_sizes(options, error);
    if (!status) status = check_budget(options, error);
    if (!status) status = check_aovs(options, error);
    if (!status) status = sf_mask_complete(options, error);
    if (!status) status = check_checkpoint(options, error);
    return status;
}
