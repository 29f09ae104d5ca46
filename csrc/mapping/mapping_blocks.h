// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The bulk mappings for one type of value: included twice by mapping_kernels.c, with REAL the
 * type, F(name) the inline function of that type and FN(name) the name of what is made here. */

typedef struct FN(block) {
    SF_ALIGNED(REAL) in[3][BLOCK];
    SF_ALIGNED(REAL) parameter[SF_MAPPING_MAX_COMPONENTS][BLOCK];
    SF_ALIGNED(REAL) out[3][BLOCK];
} FN(block);

#define EACH for (int i = 0; i < BLOCK; ++i)
#define P(k) b->parameter[k][i]
#define V(k) ((const REAL[3]){P(k), P((k) + 1), P((k) + 2)})
#define POINT(width) {b->in[0][i], b->in[1][i], (width) > 2 ? b->in[2][i] : 0}

#define TRIPLE(name, width, weight, ...)                                    \
    static void FN(name##_sample)(FN(block) * b) {                          \
        EACH {                                                              \
            REAL x[3];                                                      \
            F(sf_##name##_sample)(b->in[0][i], b->in[1][i] __VA_ARGS__, x); \
            for (int k = 0; k < (width); ++k) b->out[k][i] = x[k];          \
        }                                                                   \
    }                                                                       \
    static void FN(name##_pdf)(FN(block) * b) {                             \
        EACH {                                                              \
            const REAL x[3] = POINT(width);                                 \
            b->out[0][i] = F(sf_##name##_pdf)(x __VA_ARGS__);               \
        }                                                                   \
    }                                                                       \
    static void FN(name##_invert)(FN(block) * b) {                          \
        EACH {                                                              \
            const REAL x[3] = POINT(width);                                 \
            REAL u[2];                                                      \
            F(sf_##name##_invert)(x __VA_ARGS__, u);                        \
            for (int k = 0; k < 2; ++k) b->out[k][i] = u[k];                \
        }                                                                   \
    }                                                                       \
    static void FN(name##_weight)(FN(block) * b) {                          \
        EACH {                                                              \
            const REAL x[3] = POINT(width);                                 \
            b->out[0][i] = F(weight)(x);                                    \
        }                                                                   \
    }
MAPPINGS(TRIPLE)

#define ROW(name, width, weight, ...) {FN(name##_sample), FN(name##_pdf), FN(name##_invert), FN(name##_weight)},
static void (*const FN(functions)[SF_MAPPING_COUNT][SF_MAPPING_VERB_COUNT])(FN(block) *) = {MAPPINGS(ROW)};

/* Rows of `width` values into columns. */
static void FN(take_apart)(size_t width, const REAL *rows, REAL (*columns)[BLOCK]) {
    switch (width) {
        case 1: EACH columns[0][i] = rows[i]; break;
        case 2:
            EACH {
                columns[0][i] = rows[2 * i];
                columns[1][i] = rows[2 * i + 1];
            }
            break;
        default:
            EACH {
                columns[0][i] = rows[3 * i];
                columns[1][i] = rows[3 * i + 1];
                columns[2][i] = rows[3 * i + 2];
            }
    }
}

static void FN(put_together)(size_t width, REAL (*columns)[BLOCK], REAL *rows) {
    switch (width) {
        case 1: EACH rows[i] = columns[0][i]; break;
        case 2:
            EACH {
                rows[2 * i] = columns[0][i];
                rows[2 * i + 1] = columns[1][i];
            }
            break;
        default:
            EACH {
                rows[3 * i] = columns[0][i];
                rows[3 * i + 1] = columns[1][i];
                rows[3 * i + 2] = columns[2][i];
            }
    }
}

/* Points first .. first + n - 1, n <= BLOCK, of rows that lie `stride` apart; the rest of the
 * block repeats the last. */
static void FN(gather)(size_t width, size_t stride, const REAL *rows, size_t first, size_t n, REAL (*columns)[BLOCK]) {
    const REAL *from = rows + first * stride;
    if (n == BLOCK && stride == width) {
        FN(take_apart)(width, from, columns);
        return;
    }
    EACH for (size_t k = 0; k < width; ++k) columns[k][i] = from[((size_t)i < n ? (size_t)i : n - 1) * stride + k];
}

static void FN(run)(const sf_mapping_job *job) {
    FN(block) b;
    size_t row[SF_MAPPING_MAX_PARAMETERS + 1] = {0};
    memset(&b, 0, sizeof b);
    for (size_t k = 0; k < job->parameter_count; ++k) {
        row[k + 1] = row[k] + job->components[k];
        if (job->strides[k] == 0) FN(gather)(job->components[k], 0, job->parameters[k], 0, 1, b.parameter + row[k]);
    }
    for (size_t first = 0; first < job->count; first += BLOCK) {
        size_t n = job->count - first < BLOCK ? job->count - first : BLOCK;
        FN(gather)(job->in_width, job->in_width, job->in, first, n, b.in);
        for (size_t k = 0; k < job->parameter_count; ++k)
            if (job->strides[k] != 0)
                FN(gather)(job->components[k], job->strides[k], job->parameters[k], first, n, b.parameter + row[k]);
        FN(functions)[job->mapping][job->verb](&b);
        REAL *rows = (REAL *)job->out + first * job->out_width;
        if (n == BLOCK)
            FN(put_together)(job->out_width, b.out, rows);
        else
            for (size_t i = 0; i < n; ++i)
                for (size_t k = 0; k < job->out_width; ++k) rows[i * job->out_width + k] = b.out[k][i];
    }
}

static size_t FN(outside)(size_t count, const REAL *values, REAL low, REAL high) {
    size_t i = 0;
    for (; i + BLOCK <= count; i += BLOCK) {
        int bad = 0;
        for (int k = 0; k < BLOCK; ++k) bad |= !(values[i + k] >= low) | !(values[i + k] <= high);
        if (bad) break;
    }
    while (i < count && values[i] >= low && values[i] <= high) ++i;
    return i;
}

#undef EACH
#undef P
#undef V
#undef POINT
#undef TRIPLE
#undef ROW
