// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The tree of lights: its probabilities sum to 1 and are those that it draws by, no piece that sends
 * light is passed over, the same bits at every level; degenerate lights. */

#include "trace/light_tree_kernels.h"

#include <math.h>

#include "scenes.h"

#define MOST 600

static uint64_t state = 1;
static float uniform(void) {
    state = sf_mix64(state + UINT64_C(0x9e3779b97f4a7c15));
    return (float)(state >> 40) * 0x1p-24f;
}
static float within(float low, float high) { return low + (high - low) * uniform(); }

static void unit(float out[3]) {
    float square;
    do {
        square = 0;
        for (int c = 0; c < 3; ++c) {
            out[c] = within(-1, 1);
            square += out[c] * out[c];
        }
    } while (!(square > 0.01f && square < 1));
    for (int c = 0; c < 3; ++c) out[c] /= sqrtf(square);
}

/* A triangle, in its own corners and as the tree takes it. */
typedef struct lamp {
    double corner[3][3];
    sf_tree_piece piece;
} lamp;

static lamp lamp_of(const float middle[3], float size) {
    lamp l = {.piece = {.power = within(0.1f, 3) * size * size}};
    double e[2][3], n[3], length = 0;
    for (int c = 0; c < 3; ++c) {
        l.piece.lower[c] = INFINITY;
        l.piece.upper[c] = -INFINITY;
        for (int k = 0; k < 3; ++k) {
            float x = middle[c] + size * within(-1, 1);
            l.corner[k][c] = (double)x;
            l.piece.lower[c] = fminf(l.piece.lower[c], x);
            l.piece.upper[c] = fmaxf(l.piece.upper[c], x);
        }
        for (int k = 0; k < 2; ++k) e[k][c] = l.corner[k + 1][c] - l.corner[0][c];
    }
    for (int c = 0; c < 3; ++c) {
        n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
        length += n[c] * n[c];
    }
    for (int c = 0; c < 3; ++c) l.piece.axis[c] = length > 0 ? (float)(n[c] / sqrt(length)) : c == 0 ? 1.0f : 0.0f;
    return l;
}

/* Lights of all kinds that trees may meet; returns how many. */
enum { SPREAD, CLUSTERED, ONE_POINT, HUGE_AND_TINY, ON_A_LINE, PAIR, KINDS };

static size_t make_lamps(int kind, lamp *lamps) {
    static const float origin[3] = {0.25f, -0.5f, 0.125f};
    size_t count = kind == PAIR ? 2 : MOST;
    for (size_t i = 0; i < count; ++i) {
        float middle[3], size = 0.05f;
        for (int c = 0; c < 3; ++c) middle[c] = within(-1, 1);
        if (kind == CLUSTERED)
            for (int c = 0; c < 3; ++c) middle[c] = 0.05f * middle[c] + (float)((i + (size_t)c) % 3);
        if (kind == ONE_POINT) memcpy(middle, origin, sizeof middle);
        if (kind == ONE_POINT) size = i % 2 ? 1e-3f : 0; /* some are points themselves */
        if (kind == HUGE_AND_TINY) size = i == 7 ? 30 : 1e-4f;
        if (kind == ON_A_LINE) middle[1] = middle[2] = size = 0;
        lamps[i] = lamp_of(middle, size);
        if (!(lamps[i].piece.power > 0)) lamps[i].piece.power = 1;
        lamps[i].piece.all_ways = kind == SPREAD && i % 50 == 0;
    }
    return count;
}

static sf_light_tree *grow(const lamp *lamps, size_t count) {
    static sf_tree_piece pieces[MOST];
    sf_light_tree *tree;
    for (size_t i = 0; i < count; ++i) pieces[i] = lamps[i].piece;
    assert_ok(sf_light_tree_create(pieces, count, &tree, error));
    assert_int_equal(tree->piece_count, count);
    assert_int_equal(tree->node_count, 2 * count - 1);
    return tree;
}

/* Vertices all over, some right at a light; half of them with surfaces that let no light through. */
static void make_view(sf_tree_view *view, const lamp *lamps, size_t count) {
    for (uint32_t l = 0; l < SF_LANES; ++l) {
        const lamp *at = lamps + (size_t)(uniform() * (float)count);
        float n[3];
        unit(n);
        for (int c = 0; c < 3; ++c) {
            view->point[c][l] = l % 4 == 3 ? (float)at->corner[l % 3][c] : within(-2, 2);
            view->normal[c][l] = n[c];
        }
        view->faces[l] = (float)(l & 1);
    }
}

static void test_probabilities_sum_to_one(void **unused) {
    (void)unused;
    static lamp lamps[MOST];
    for (int kind = 0; kind < KINDS; ++kind) {
        size_t count = make_lamps(kind, lamps);
        sf_light_tree *tree = grow(lamps, count);
        for (int trial = 0; trial < 8; ++trial) {
            sf_tree_view view;
            make_view(&view, lamps, count);
            double sum[SF_LANES] = {0};
            for (uint32_t i = 0; i < count; ++i) {
                SF_ALIGNED(uint32_t) piece[SF_LANES];
                SF_ALIGNED(float) chance[SF_LANES];
                for (uint32_t l = 0; l < SF_LANES; ++l) piece[l] = i;
                sf_light_tree_kernels_at(SF_ISA_BASELINE)->weigh(tree, &view, piece, chance);
                for (uint32_t l = 0; l < SF_LANES; ++l) sum[l] += (double)chance[l];
            }
            /* At each of up to 32 levels the two parts sum to 1 within 2^-25, and a product is rounded
             * by 2^-24 of itself. */
            for (uint32_t l = 0; l < SF_LANES; ++l) assert_true(fabs(sum[l] - 1) < 32 * 1.5 * 0x1p-24);
        }
        sf_light_tree_destroy(tree);
    }
}

/* Draws what it says that it draws, to the bit and as often, and at every level the same. */
static void test_draws_by_the_probability_that_it_states(void **unused) {
    (void)unused;
    static lamp lamps[MOST];
    static uint32_t drawn[SF_LANES][MOST];
    enum { DRAWS = 4096 };
    for (int kind = 0; kind < KINDS; ++kind) {
        size_t count = make_lamps(kind, lamps);
        sf_light_tree *tree = grow(lamps, count);
        sf_tree_view view;
        make_view(&view, lamps, count);
        memset(drawn, 0, sizeof drawn);
        for (uint32_t k = 0; k < DRAWS; ++k) {
            SF_ALIGNED(float) u[SF_LANES], chance[SF_LANES], stated[SF_LANES];
            SF_ALIGNED(uint32_t) piece[SF_LANES], other[SF_LANES];
            for (uint32_t l = 0; l < SF_LANES; ++l) u[l] = ((float)k + 0.5f) / DRAWS;
            sf_light_tree_kernels_at(SF_ISA_BASELINE)->draw(tree, &view, u, piece, chance);
            sf_light_tree_kernels_at(SF_ISA_BASELINE)->weigh(tree, &view, piece, stated);
            assert_memory_equal(chance, stated, sizeof chance);
            for (uint32_t l = 0; l < SF_LANES; ++l) {
                assert_in_range(piece[l], 0, count - 1);
                assert_true(chance[l] > 0);
                ++drawn[l][piece[l]];
            }
            sf_light_tree_kernels_at(sf_isa_active())->draw(tree, &view, u, other, stated);
            assert_memory_equal(chance, stated, sizeof chance);
            assert_memory_equal(piece, other, sizeof piece);
        }
        for (uint32_t i = 0; i < count; ++i) {
            SF_ALIGNED(uint32_t) piece[SF_LANES];
            SF_ALIGNED(float) chance[SF_LANES];
            for (uint32_t l = 0; l < SF_LANES; ++l) piece[l] = i;
            sf_light_tree_kernels_at(SF_ISA_BASELINE)->weigh(tree, &view, piece, chance);
            /* Each piece has one interval of u, which holds the midpoints of its length x 4096 within 1,
             * but for rounding: each of up to 32 levels moves a border by some 2^-24 x 4096. */
            for (uint32_t l = 0; l < SF_LANES; ++l)
                assert_true(fabs((double)drawn[l][i] - DRAWS * (double)chance[l]) < 1.05);
        }
        sf_light_tree_destroy(tree);
    }
}

/* Where a point of the triangle shines on the vertex, by its own corners: the probability is above 0,
 * down to light that comes in by 10^-4 of the cosines' product. */
static void test_what_shines_is_never_passed_over(void **unused) {
    (void)unused;
    static lamp lamps[MOST];
    size_t seen = 0;
    for (int kind = 0; kind < KINDS; ++kind) {
        size_t count = make_lamps(kind, lamps);
        sf_light_tree *tree = grow(lamps, count);
        for (int trial = 0; trial < 20; ++trial) {
            sf_tree_view view;
            make_view(&view, lamps, count);
            for (uint32_t i = 0; i < count; ++i) {
                SF_ALIGNED(uint32_t) piece[SF_LANES];
                SF_ALIGNED(float) chance[SF_LANES];
                for (uint32_t l = 0; l < SF_LANES; ++l) piece[l] = i;
                sf_light_tree_kernels_at(SF_ISA_BASELINE)->weigh(tree, &view, piece, chance);
                for (uint32_t l = 0; l < SF_LANES; ++l) {
                    double s = (double)uniform(), t = (double)uniform() * (1 - s), to[3], square = 0, at = 0, up = 0;
                    for (int c = 0; c < 3; ++c) {
                        const double (*k)[3] = (const double (*)[3])lamps[i].corner;
                        to[c] = (1 - s - t) * k[0][c] + s * k[1][c] + t * k[2][c] - (double)view.point[c][l];
                        square += to[c] * to[c];
                        at -= to[c] * (double)lamps[i].piece.axis[c];
                        up += to[c] * (double)view.normal[c][l];
                    }
                    bool front = lamps[i].piece.all_ways || at > 1e-4 * sqrt(square);
                    if (!front || (view.faces[l] > 0 && !(up > 1e-4 * sqrt(square)))) continue;
                    assert_true(chance[l] > 0);
                    ++seen;
                }
            }
        }
        sf_light_tree_destroy(tree);
    }
    assert_true(seen > 100000);
}

/* A lamp that faces away, and one behind the vertex, are not drawn while another shines. */
static void test_what_faces_away_is_not_drawn(void **unused) {
    (void)unused;
    sf_tree_piece pieces[3] = {{{-1, 2, -1}, {1, 2, 1}, {0, -1, 0}, false, 1},      /* above, facing down */
                               {{-1, 3, -1}, {1, 3, 1}, {0, 1, 0}, false, 1e6f},    /* above, facing up */
                               {{-1, -2, -1}, {1, -2, 1}, {0, 1, 0}, false, 1e6f}}; /* below, facing up */
    sf_light_tree *tree;
    sf_tree_view view = {.point = {{0}}};
    for (uint32_t l = 0; l < SF_LANES; ++l) view.normal[1][l] = view.faces[l] = 1;
    view.faces[1] = 0;
    SF_ALIGNED(float) chance[3][SF_LANES];
    assert_ok(sf_light_tree_create(pieces, 3, &tree, error));
    for (uint32_t i = 0; i < 3; ++i) {
        SF_ALIGNED(uint32_t) piece[SF_LANES];
        for (uint32_t l = 0; l < SF_LANES; ++l) piece[l] = i;
        sf_light_tree_kernels_at(SF_ISA_BASELINE)->weigh(tree, &view, piece, chance[i]);
    }
    assert_true(chance[0][0] > 0 && chance[0][1] > 0);
    assert_true(chance[1][0] == 0 && chance[1][1] == 0);
    assert_true(chance[2][0] == 0 && chance[2][1] > 0); /* fog and glass take it from below */
    sf_light_tree_destroy(tree);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_probabilities_sum_to_one),
        cmocka_unit_test(test_draws_by_the_probability_that_it_states),
        cmocka_unit_test(test_what_shines_is_never_passed_over),
        cmocka_unit_test(test_what_faces_away_is_not_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
