// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Inline functions give the library's bits in a program whose flags let the compiler fuse products and sums:
 * this file is compiled with such flags. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define COLLECT collect_here
#include "contraction.h"

void collect_right(float s, float t, float out[VALUES]);

static volatile float one = 1; /* so that nothing is computed while this is compiled */

static float product_and_sum(float a, float b, float c) { return a * b + c; }

static void test_this_file_fuses(void **state) {
    (void)state; /* (1 + e)^2 - 1 - 2 e is e^2 with one rounding, 0 with two: else the other test proves nothing */
    float x = one + 0x1p-20f, rounded = x * x;
    assert_true(product_and_sum(x, x, -1 - 0x1p-19f) != 0);
    (void)rounded;
}

static void test_inline_functions_do_not_depend_on_the_callers_flags(void **state) {
    (void)state;
    float here[VALUES], right[VALUES];
    for (uint32_t i = 0; i < 20000; ++i) {
        float s = sf_float_from_bits((uint32_t)sf_mix64(2 * i + 1)),
              t = sf_float_from_bits((uint32_t)sf_mix64(2 * i + 2));
        collect_here(s, t, here);
        collect_right(s, t, right);
        assert_memory_equal(here, right, sizeof here);
    }
}

int main(void) {
    if (!__builtin_cpu_supports("fma")) return 77; /* skipped: compiled for processors that fuse */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_this_file_fuses),
        cmocka_unit_test(test_inline_functions_do_not_depend_on_the_callers_flags),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
