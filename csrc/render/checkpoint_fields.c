// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The one table of what a checkpoint holds of a render's progress: each field has its name, its place,
 * its type and its range. What is in the table is written, read and checked; no field has a place
 * without a range.
 *
 * A checksum tells an accident, not an intention: anybody can make a file whose checksum is right. What is
 * read must therefore lead neither outside an array, nor to a shift or a conversion that C leaves
 * undefined, nor into a loop without an end. NaN is allowed where a render can write it and all that reads
 * it can take it. */

#include "render/checkpoint_fields.h"

#include <inttypes.h>
#include <math.h>

#include "base/error.h"
#include "film/aov.h"
#include "film/film_looks.h"
#include "film/mask.h"
#include "film/signed_filter.h"
#include "render/relmse_target.h"

#define MOST_LOOK 27    /* 16 * 2^27 is SF_MAX_SPP */
#define MOST_DECAY 5.7f /* 2^2.5 and a bit: see sf_stop_pool_decay */

/* ---- ranges ---- */

static uint32_t u32(const void *value) { return *(const uint32_t *)value; }
static uint64_t u64(const void *value) { return *(const uint64_t *)value; }
static float f32(const void *value) { return *(const float *)value; }
static double f64(const void *value) { return *(const double *)value; }

/* That every value of the type may stand: each use says why. */
static bool any(const void *value) {
    (void)value;
    return true;
}
static bool flag(const void *value) { return u32(value) <= 1; }
static bool small_flag(const void *value) { return *(const uint8_t *)value <= 1; }
static bool count32(const void *value) { return u32(value) <= SF_MAX_SPP; }
static bool count64(const void *value) { return u64(value) <= SF_MAX_SPP; }
static bool look_ahead(const void *value) { return u32(value) <= SF_MAX_SPP + 256u; }
static bool finite64(const void *value) { return isfinite(f64(value)); }
static bool not_below_0(const void *value) { return f64(value) >= 0 && isfinite(f64(value)); }
static bool not_below_minus_1(const void *value) { return f64(value) >= -1 && isfinite(f64(value)); }
/* Infinite where a square overflows, NaN where infinities meet. */
static bool square64(const void *value) { return !(f64(value) < 0); }
static bool square32(const void *value) { return !(f32(value) < 0); }
static bool gain(const void *value) { return isnan(f32(value)) || !signbit(f32(value)); }
static bool decay(const void *value) { return f32(value) == 0 || (f32(value) >= 2 && f32(value) <= MOST_DECAY); }
static bool look(const void *value) { return *(const uint8_t *)value <= MOST_LOOK; }
static bool reason(const void *value) { return *(const uint8_t *)value < SF_STOP_REASON_COUNT; }

/* ---- the table ---- */

/* What a field is a part of. */
typedef enum holder { OF_STATE, OF_OPEN, OF_ACTIVE, OF_POOLS, OF_PIXELS, OF_SUMS, OF_NOTES, OF_SIGNED } holder;

typedef struct field {
    const char *name;
    holder holder;
    size_t offset;
    sf_array_type type;
    uint32_t width; /* 0: as many as there are AOVs' sums */
    bool (*allows)(const void *value);
} field;

#define STATE(name, type, range) {"state." #name, OF_STATE, offsetof(sf_round_state, name), SF_ARRAY_##type, 1, range}
#define PIXEL(name, member, type, width, range) \
    {"pixel." name, OF_PIXELS, offsetof(sf_film_pixel, member), SF_ARRAY_##type, width, range}
#define GOAL(name, type, range) \
    {"goal." #name, OF_NOTES, offsetof(sf_relmse_target_note, name), SF_ARRAY_##type, 1, range}
#define SIGNED(member, type, width, range) \
    {"signed." #member, OF_SIGNED, offsetof(sf_signed_pixel, member), SF_ARRAY_##type, width, range}

static const field fields[] = {
    STATE(from, U32, count32),
    STATE(to, U32, count32),
    STATE(rounds, U32, any), /* is only counted on */
    STATE(look, U32, look_ahead),
    STATE(in_lap, U32, flag),
    STATE(target, F64, not_below_minus_1),
    STATE(level_fixed, U32, flag),
    STATE(level, F64, finite64), /* below 0 under a filter with negative lobes */
    STATE(tolerance, F64, not_below_minus_1),
    STATE(seconds, F64, not_below_0),
    STATE(traced_samples, U64, any), /* is compared with the pixels' counts */
    STATE(second, U32, flag),
    {"open", OF_OPEN, 0, SF_ARRAY_U64, 1, any}, /* both are compared with the layout */
    {"decay", OF_POOLS, 0, SF_ARRAY_F32, 1, decay},
    {"active", OF_ACTIVE, 0, SF_ARRAY_U64, 1, any},
    PIXEL("count", moments.count, U64, 1, count64),
    PIXEL("mean", moments.mean, F64, 3, finite64),
    PIXEL("m2", moments.m2, F64, 1, square64),
    PIXEL("nonfinite", moments.nonfinite, U64, 1, count64),
    /* The rule replicates keeps seven doubles in the same 56 bytes, which these fields cover, and a
     * second set keeps the first of them. The last two doubles are two floats each: see evidence_is_sound. */
    PIXEL("dyadic.unit", evidence.dyadic.unit, F64, 1, finite64),
    PIXEL("dyadic.pending", evidence.dyadic.pending, F64, 4, finite64),
    PIXEL("dyadic.squares", evidence.dyadic.squares, F32, 4, any),
    PIXEL("variance", variance, F32, 1, square32),
    PIXEL("look", look, U8, 1, look),
    PIXEL("doubt", doubt, U8, 1, small_flag),
    PIXEL("hits", hits, U32, 1, count32),
    PIXEL("half_width", half_width, F32, 1, square32),
    PIXEL("reason", reason, U8, 1, reason),
    {"aov.sums", OF_SUMS, 0, SF_ARRAY_F64, 0, any}, /* are only added to and shown */
    GOAL(error, F32, square32),
    GOAL(around, F32, gain), /* its bits choose a bin */
    GOAL(taken, U32, count32),
    SIGNED(positive.count, U64, 1, count64),
    SIGNED(positive.mean, F64, 3, finite64),
    SIGNED(positive.m2, F64, 1, square64),
    SIGNED(positive.nonfinite, U64, 1, count64),
    SIGNED(negative.count, U64, 1, count64),
    SIGNED(negative.mean, F64, 3, finite64),
    SIGNED(negative.m2, F64, 1, square64),
    SIGNED(negative.nonfinite, U64, 1, count64),
    SIGNED(blocks, F64, 1, finite64),
};

size_t sf_checkpoint_field_count(void) { return sizeof fields / sizeof *fields; }

/* Where the holder's rows are, how many, and how far apart; none where this render has no such. */
static sf_array rows_of(const sf_checkpoint *c, holder of) {
    sf_film *film = c->film;
    size_t cells = sf_film_cell_count(film);
    uint32_t sums = film->aovs ? film->aovs->sums_per_pixel : 0;
    switch (of) {
        case OF_STATE: return (sf_array){.rows = 1, .data = (void *)&c->state, .stride = sizeof c->state};
        case OF_OPEN: return (sf_array){.rows = cells, .data = c->open, .stride = sizeof *c->open};
        case OF_ACTIVE: return (sf_array){.rows = cells, .data = c->active, .stride = sizeof *c->active};
        case OF_POOLS:
            return (sf_array){.rows = sf_film_pool_count(film), .data = film->decay, .stride = sizeof *film->decay};
        case OF_PIXELS: return (sf_array){.rows = film->stored, .data = film->pixels, .stride = sizeof *film->pixels};
        case OF_SUMS:
            return (sf_array){.rows = film->stored,
                              .data = sums ? film->aovs->sums : NULL,
                              .stride = sums * sizeof *film->aovs->sums,
                              .width = sums};
        case OF_NOTES: return (sf_array){.rows = film->stored, .data = c->notes, .stride = sizeof *c->notes};
        case OF_SIGNED:
            return (sf_array){.rows = film->stored, .data = film->signed_pixels, .stride = sizeof *film->signed_pixels};
    }
    return (sf_array){.data = NULL};
}

bool sf_checkpoint_field(const sf_checkpoint *c, size_t i, sf_array *array) {
    const field *f = fields + i;
    *array = rows_of(c, f->holder);
    if (!array->data) return false;
    array->name = f->name;
    array->type = f->type;
    if (f->width) array->width = f->width;
    array->data = (char *)array->data + f->offset;
    return true;
}

static size_t value_size(sf_array_type type) {
    return type == SF_ARRAY_U8 ? 1 : type == SF_ARRAY_U32 || type == SF_ARRAY_F32 ? 4 : 8;
}

/* The first field with a value outside its range; NULL where there is none. */
static const char *find_out_of_range(const sf_checkpoint *c) {
    for (size_t i = 0; i < sf_checkpoint_field_count(); ++i) {
        sf_array array;
        if (fields[i].allows == any || !sf_checkpoint_field(c, i, &array)) continue;
        size_t size = value_size(array.type);
        const char *row = array.data;
        for (uint64_t k = 0; k < array.rows; ++k, row += array.stride)
            for (uint32_t j = 0; j < array.width; ++j)
                if (!fields[i].allows(row + j * size)) return array.name;
    }
    return NULL;
}

/* ---- the fields together ---- */

/* A lap goes from `from` by `to` to `look`, which is not beyond the rule's next. Between laps `from` and
 * `look` are not read. */
static bool state_is_sound(const sf_checkpoint *c) {
    const sf_round_state *s = &c->state;
    const sf_render_options *o = &c->film->options;
    if (s->to > sf_stop_most(o) || s->second > (uint32_t)(o->unbiased != 0)) return false;
    if (!s->second && s->to < o->start) return false;
    if (!s->in_lap) return true;
    if (!(s->from <= s->to && s->to <= s->look && s->from < s->look)) return false;
    if (s->second) return s->look <= SF_MAX_SPP;
    return s->from >= o->start && s->look <= sf_stop_next_look(o, s->from);
}

/* Whether lists of cells speak of pixels that there are. */
static bool cells_are_sound(const sf_checkpoint *c, const uint64_t *layout) {
    for (size_t i = 0; i < sf_film_cell_count(c->film); ++i) {
        if ((c->open[i] | c->active[i]) & ~layout[i]) return false;
        if (c->state.in_lap && c->active[i] & ~c->open[i]) return false;
    }
    return true;
}

/* What the stopping rule keeps: counts of a second set, sums of replicates, or differences. */
static bool evidence_is_sound(const sf_checkpoint *c, const sf_film_pixel *p) {
    const sf_render_options *o = &c->film->options;
    if (c->state.second) {
        double planned = p->evidence.planned;
        return planned >= 0 && planned <= sf_stop_most(o) && planned == floor(planned) &&
               (double)sf_film_taken(p) <= planned;
    }
    if (o->stop == SF_STOP_RULE_REPLICATES) {
        for (int i = 0; i < SF_REPLICATES - 1; ++i)
            if (!isfinite(p->evidence.replicates[i])) return false;
        return true;
    }
    for (int j = 0; j < SF_DYADIC_LEVELS; ++j)
        if (p->evidence.dyadic.squares[j] < 0) return false;
    return true;
}

static bool signed_is_sound(const sf_film *film, size_t i) {
    if (!film->signed_pixels) return true;
    const sf_signed_pixel *s = film->signed_pixels + i;
    const sf_vector_moments *m = &film->pixels[i].moments;
    return s->positive.count + s->negative.count == m->count &&
           s->positive.nonfinite + s->negative.nonfinite == m->nonfinite;
}

/* A goal chooses pixels by their counts at their last decision, and waits for those that have gone
 * beyond the lap that follows it. */
static bool note_is_sound(const sf_checkpoint *c, size_t i) {
    if (!c->notes || c->state.second) return true;
    uint64_t taken = sf_film_taken(c->film->pixels + i);
    uint32_t noted = c->notes[i].taken;
    return noted == taken || (noted < taken && taken <= sf_stop_next_look(&c->film->options, noted));
}

static bool pixels_are_sound(const sf_checkpoint *c) {
    const sf_film *film = c->film;
    if (film->part_count > 1) return true; /* merged: counts of several renders, and none goes on from it */
    uint64_t traced = 0, most = sf_stop_most(&film->options) - film->options.start;
    for (size_t i = 0; i < film->stored; ++i) {
        const sf_film_pixel *p = film->pixels + i;
        uint64_t taken = sf_film_taken(p);
        if (taken > most || p->hits > p->moments.count || !evidence_is_sound(c, p)) return false;
        if (!signed_is_sound(film, i) || !note_is_sound(c, i)) return false;
        traced += taken + (c->state.second ? (uint64_t)p->evidence.planned : 0);
    }
    return traced == c->state.traced_samples && (!film->options.samples || traced <= film->options.samples);
}

/* Whether an open pixel is where the rounds are: one that is behind them would never be brought on. */
static bool pixel_is_in_time(const sf_checkpoint *c, const sf_film_pixel *p, bool active) {
    const sf_round_state *s = &c->state;
    const sf_render_options *o = &c->film->options;
    uint64_t reached = sf_film_taken(p) + o->start;
    if (s->second) return p->evidence.planned >= 1 && reached >= (s->in_lap ? s->from : s->to);
    if (sf_moves_together(o)) return reached >= (s->in_lap ? s->from : s->to);
    return !(s->in_lap && active) || (reached >= s->from && reached <= s->look);
}

static bool pixels_are_in_time(const sf_checkpoint *c) {
    const sf_film *film = c->film;
    for (uint32_t y = 0; y < film->height; ++y)
        for (uint32_t x = 0; x < film->width; ++x)
            if (sf_film_is_in(film, c->open, x, y) &&
                !pixel_is_in_time(c, sf_film_at(film, x, y), sf_film_is_in(film, c->active, x, y)))
                return false;
    return true;
}

sf_status sf_checkpoint_check(const sf_checkpoint *c, const uint64_t *layout, const char *path, sf_error *error) {
    const char *name = find_out_of_range(c);
    if (name)
        return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' holds values that no render writes, in %s", path, name);
    if (c->film->counted > 0 && state_is_sound(c) && cells_are_sound(c, layout) && pixels_are_sound(c) &&
        pixels_are_in_time(c))
        return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_IO,
                   "checkpoint '%s' holds values that no render writes: its counts contradict one another", path);
}

sf_status sf_checkpoint_check_mask(sf_film *film, const char *path, sf_error *error) {
    size_t pixels = (size_t)film->crop_width * film->crop_height;
    for (size_t i = 0; i < pixels; ++i)
        if (!small_flag(film->mask + i))
            return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' holds values that no render writes, in mask", path);
    sf_mask_count(film);
    return SF_STATUS_OK;
}
