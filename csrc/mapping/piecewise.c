// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Piecewise constant densities on the unit interval and square: inversion of the distribution
 * function, which a guide table enters near the cell. */

#include <math.h>
#include <stdlib.h>

#include "base/error.h"
#include "mapping/discrete_values.h"
#include "sunfleck/discrete.h"
#include "sunfleck/elementary.h"

/* One row of n cells. Cell i has the values u from cdf[i] to below cdf[i + 1]; guide[k] is the cell
 * of u = k / n. */
typedef struct line {
    size_t n;
    const double *cdf;
    const uint32_t *guide;
} line;

struct sf_piecewise {
    size_t width, columns, rows;
    double *cdf;     /* of the rows' columns, rows * (columns + 1); then of the rows, rows + 1 */
    uint32_t *guide; /* likewise */
};

static line row_of(const sf_piecewise *p, size_t row) {
    line l = {p->columns, p->cdf + row * (p->columns + 1), p->guide + row * (p->columns + 1)};
    return l;
}

static line marginal_of(const sf_piecewise *p) {
    size_t before = p->rows * (p->columns + 1);
    line l = {p->rows, p->cdf + before, p->guide + before};
    return l;
}

/* Fills the distribution and the guide of n weights, scaled by 1 / largest; returns the sum of the
 * scaled. Of a row without weight, whose density is 0 anyway, makes a uniform one. Ends early where the
 * watch says stop. */
static double fill_line(const double *weights, size_t n, double largest, double *cdf, uint32_t *guide,
                        sf_watch *watch) {
    double total = 0.0, sum = 0.0;
    size_t last = n;
    for (size_t i = 0; i < n; ++i) total += weights[i] / largest;
    while (last > 0 && total > 0.0 && !(weights[last - 1] > 0.0)) --last;
    for (size_t i = 0; i < n; ++i) {
        cdf[i] = i < last && sum < total ? (total > 0.0 ? sum / total : (double)i / (double)n) : 1.0;
        sum += total > 0.0 ? weights[i] / largest : 0.0;
        if (sf_watch_item(watch, i)) return 0.0;
    }
    if (!(total > 0.0))
        for (size_t i = 0; i < n; ++i) cdf[i] = (double)i / (double)n;
    cdf[n] = 1.0;
    for (size_t k = 0, cell = 0; k <= n; ++k) {
        while (cell + 1 < n && cdf[cell + 1] <= (double)k / (double)n) ++cell;
        guide[k] = (uint32_t)cell;
        if (sf_watch_item(watch, k)) return 0.0;
    }
    sf_watch_step(watch, 8 * n);
    return total;
}

/* The cell of u, with cdf[cell] <= u < cdf[cell + 1]. */
static size_t find_cell(const line *l, double u) {
    size_t k = (size_t)(u * (double)l->n);
    k = k < l->n ? k : l->n - 1;
    size_t low = l->guide[k], high = l->guide[k + 1];
    if (u < l->cdf[low]) low = 0; /* u * n was rounded over a whole number */
    if (u >= l->cdf[high + 1]) high = l->n - 1;
    while (low < high) {
        size_t middle = low + (high - low + 1) / 2;
        if (l->cdf[middle] <= u)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* The cell that the place x lies in: for floats the product is exact. */
static size_t cell_at(double x, size_t n) {
    size_t cell = (size_t)(x * (double)n);
    return cell < n ? cell : n - 1;
}

static double share_of(const line *l, size_t cell) { return l->cdf[cell + 1] - l->cdf[cell]; }

/* The place of u in its cell, rounded to the type, and never out of the cell. */
static double place_of(const line *l, double u, size_t cell, int is_double) {
    double x = ((double)cell + (u - l->cdf[cell]) / share_of(l, cell)) / (double)l->n;
    if (is_double) {
        while (cell_at(x, l->n) > cell || x >= 1.0) x = nextafter(x, 0.0);
        while (cell_at(x, l->n) < cell) x = nextafter(x, 1.0);
        return x;
    }
    float near = (float)x;
    while (cell_at((double)near, l->n) > cell || near >= 1.0f) near = nextafterf(near, 0.0f);
    while (cell_at((double)near, l->n) < cell) near = nextafterf(near, 1.0f);
    return (double)near;
}

static double value_of(const line *l, double x, size_t cell) {
    double u = l->cdf[cell] + (x * (double)l->n - (double)cell) * share_of(l, cell);
    return u < SF_UNIT_MAX ? u : SF_UNIT_MAX;
}

/* ---- one point of either kind; `width` values in, and out or one density ---- */

typedef void point_function(const sf_piecewise *p, const double *in, double *out, int is_double);

static void sample_point(const sf_piecewise *p, const double *u, double *x, int is_double) {
    line rows = marginal_of(p);
    size_t row = p->width == 2 ? find_cell(&rows, u[1]) : 0;
    line l = row_of(p, row);
    x[0] = place_of(&l, u[0], find_cell(&l, u[0]), is_double);
    if (p->width == 2) x[1] = place_of(&rows, u[1], row, is_double);
}

static void pdf_point(const sf_piecewise *p, const double *x, double *pdf, int is_double) {
    (void)is_double;
    line rows = marginal_of(p);
    size_t row = p->width == 2 ? cell_at(x[1], p->rows) : 0;
    line l = row_of(p, row);
    pdf[0] = share_of(&l, cell_at(x[0], p->columns)) * (double)p->columns;
    if (p->width == 2) pdf[0] *= share_of(&rows, row) * (double)p->rows;
}

static void invert_point(const sf_piecewise *p, const double *x, double *u, int is_double) {
    (void)is_double;
    line rows = marginal_of(p);
    size_t row = p->width == 2 ? cell_at(x[1], p->rows) : 0;
    line l = row_of(p, row);
    u[0] = value_of(&l, x[0], cell_at(x[0], p->columns));
    if (p->width == 2) u[1] = value_of(&rows, x[1], row);
}

static sf_status fill_f32(const sf_piecewise *p, point_function *function, const char *name, size_t count,
                          const float *in, float *out, size_t out_width, sf_error *error) {
    sf_status status = sf_check_unit_f32("piecewise", name, in, count * p->width, error);
    for (size_t i = 0; !status && i < count; ++i) {
        double from[2] = {0.0, 0.0}, to[2] = {0.0, 0.0};
        for (size_t k = 0; k < p->width; ++k) from[k] = (double)in[i * p->width + k];
        function(p, from, to, 0);
        for (size_t k = 0; k < out_width; ++k) out[i * out_width + k] = (float)to[k];
    }
    return status;
}

static sf_status fill_f64(const sf_piecewise *p, point_function *function, const char *name, size_t count,
                          const double *in, double *out, size_t out_width, sf_error *error) {
    sf_status status = sf_check_unit_f64("piecewise", name, in, count * p->width, error);
    for (size_t i = 0; !status && i < count; ++i) function(p, in + i * p->width, out + i * out_width, 1);
    return status;
}

/* ---- the interface ---- */

static sf_status create(const double *weights, size_t columns, size_t rows, size_t width, sf_piecewise **piecewise,
                        const sf_interrupt *interrupt, sf_error *error) {
    const size_t most = (size_t)1 << 24;
    double largest, *sums = NULL;
    *piecewise = NULL;
    if (columns < 1 || columns > most || rows < 1 || rows > most)
        return sf_fail(error, SF_STATUS_INVALID_VALUE, "piecewise: %zu x %zu cells; each must be 1 .. 2^24", columns,
                       rows);
    sf_watch watch;
    sf_watch_begin(&watch, interrupt);
    sf_status status = sf_check_weights("piecewise", weights, columns * rows, &largest, &watch, error);
    if (status) return status;
    size_t size = rows * (columns + 1) + rows + 1;
    sf_piecewise *made = calloc(1, sizeof *made);
    if (!made) return sf_fail_memory(error, "a piecewise density", sizeof *made);
    made->width = width;
    made->columns = columns;
    made->rows = rows;
    made->cdf = malloc(size * sizeof *made->cdf);
    made->guide = malloc(size * sizeof *made->guide);
    sums = malloc(rows * sizeof *sums);
    if (!made->cdf || !made->guide || !sums) {
        status = sf_fail_memory(error, "a piecewise density", size * (sizeof *made->cdf + sizeof *made->guide));
        goto fail;
    }
    double heaviest = 0.0;
    for (size_t r = 0; r < rows && !sf_watch_stopped(&watch); ++r) {
        size_t at = r * (columns + 1);
        sums[r] = fill_line(weights + r * columns, columns, largest, made->cdf + at, made->guide + at, &watch);
        heaviest = sums[r] > heaviest ? sums[r] : heaviest;
    }
    size_t end = rows * (columns + 1);
    if (!sf_watch_stopped(&watch)) fill_line(sums, rows, heaviest, made->cdf + end, made->guide + end, &watch);
    status = sf_watch_status(&watch, error);
    if (status) goto fail;
    free(sums);
    *piecewise = made;
    return SF_STATUS_OK;
fail:
    free(sums);
    sf_piecewise_destroy(made);
    return status;
}

sf_status sf_piecewise_create_1d(const double *weights, size_t count, sf_piecewise **piecewise,
                                 const sf_interrupt *interrupt, sf_error *error) {
    return create(weights, count, 1, 1, piecewise, interrupt, error);
}

sf_status sf_piecewise_create_2d(const double *weights, size_t columns, size_t rows, sf_piecewise **piecewise,
                                 const sf_interrupt *interrupt, sf_error *error) {
    return create(weights, columns, rows, 2, piecewise, interrupt, error);
}

void sf_piecewise_destroy(sf_piecewise *piecewise) {
    if (!piecewise) return;
    free(piecewise->cdf);
    free(piecewise->guide);
    free(piecewise);
}

size_t sf_piecewise_width(const sf_piecewise *piecewise) { return piecewise->width; }

sf_status sf_piecewise_sample_fill_f32(const sf_piecewise *p, size_t count, const float *u, float *x, sf_error *error) {
    return fill_f32(p, sample_point, "u", count, u, x, p->width, error);
}
sf_status sf_piecewise_sample_fill_f64(const sf_piecewise *p, size_t count, const double *u, double *x,
                                       sf_error *error) {
    return fill_f64(p, sample_point, "u", count, u, x, p->width, error);
}
sf_status sf_piecewise_pdf_fill_f32(const sf_piecewise *p, size_t count, const float *x, float *pdf, sf_error *error) {
    return fill_f32(p, pdf_point, "x", count, x, pdf, 1, error);
}
sf_status sf_piecewise_pdf_fill_f64(const sf_piecewise *p, size_t count, const double *x, double *pdf,
                                    sf_error *error) {
    return fill_f64(p, pdf_point, "x", count, x, pdf, 1, error);
}
sf_status sf_piecewise_invert_fill_f32(const sf_piecewise *p, size_t count, const float *x, float *u, sf_error *error) {
    sf_status status = fill_f32(p, invert_point, "x", count, x, u, p->width, error);
    for (size_t i = 0; !status && i < count * p->width; ++i) u[i] = sf_unit_clamp(u[i]); /* rounded up to 1 */
    return status;
}
sf_status sf_piecewise_invert_fill_f64(const sf_piecewise *p, size_t count, const double *x, double *u,
                                       sf_error *error) {
    return fill_f64(p, invert_point, "x", count, x, u, p->width, error);
}
