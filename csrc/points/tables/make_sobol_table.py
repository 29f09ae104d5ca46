#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0
"""Writes sobol_table.c from the direction numbers of Joe & Kuo (new-joe-kuo-6.21201).

The numbers are read from the copy that SciPy ships (scipy/stats/_sobol_direction_numbers.npz):

    python3 csrc/points/tables/make_sobol_table.py > csrc/points/tables/sobol_table.c

Dimension 0 is the van der Corput sequence and needs no data. A dimension whose polynomial has
degree s holds (s - 1)(s + 2) / 2 bits: the s - 1 inner coefficients of the polynomial, the
highest power first, then for i = 2 .. s the i - 1 bits above the lowest of m_i (m_i is odd and
below 2^i, m_1 is 1). Dimensions come in rising degree, so that a dimension's place is a product.
"""

import pathlib

import numpy as np
import scipy.stats

HEADER = """\
// SPDX-FileCopyrightText: 2008 Frances Y. Kuo and Stephen Joe
// SPDX-License-Identifier: BSD-3-Clause

/* Direction numbers of the Sobol' sequence in {dims} dimensions: new-joe-kuo-6.{dims} of
 * Joe & Kuo 2008, "Constructing Sobol sequences with better two-dimensional projections",
 * SIAM J. Sci. Comput. 30, packed by make_sobol_table.py, which says how. Generated: do not edit.
 *
 * Copyright (c) 2008, Frances Y. Kuo and Stephen Joe. All rights reserved.
 *
 * Redistribution and use in source and binary forms, with or without modification, are
 * permitted provided that the following conditions are met:
 *
 *   * Redistributions of source code must retain the above copyright notice, this list of
 *     conditions and the following disclaimer.
 *   * Redistributions in binary form must reproduce the above copyright notice, this list of
 *     conditions and the following disclaimer in the documentation and/or other materials
 *     provided with the distribution.
 *   * Neither the names of the copyright holders nor the names of the University of New South
 *     Wales and the University of Waikato and its contributors may be used to endorse or
 *     promote products derived from this software without specific prior written permission.
 *
 * THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS "AS IS" AND ANY EXPRESS OR IMPLIED
 * WARRANTIES, INCLUDING, BUT NOT LIMITED TO, THE IMPLIED WARRANTIES OF MERCHANTABILITY AND
 * FITNESS FOR A PARTICULAR PURPOSE ARE DISCLAIMED. IN NO EVENT SHALL THE COPYRIGHT HOLDERS BE
 * LIABLE FOR ANY DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR CONSEQUENTIAL DAMAGES
 * (INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF SUBSTITUTE GOODS OR SERVICES; LOSS OF USE,
 * DATA, OR PROFITS; OR BUSINESS INTERRUPTION) HOWEVER CAUSED AND ON ANY THEORY OF LIABILITY,
 * WHETHER IN CONTRACT, STRICT LIABILITY, OR TORT (INCLUDING NEGLIGENCE OR OTHERWISE) ARISING IN
 * ANY WAY OUT OF THE USE OF THIS SOFTWARE, EVEN IF ADVISED OF THE POSSIBILITY OF SUCH DAMAGE. */

#include "points/tables/sobol_table.h"
"""


def dimension_bits(poly: int, initial: list[int]) -> tuple[int, int]:
    """The packed bits of a dimension, lowest first, and how many there are."""
    degree = poly.bit_length() - 1
    value, count = (poly >> 1) & ((1 << (degree - 1)) - 1), degree - 1
    for i in range(2, degree + 1):
        m = initial[i - 1]
        assert m % 2 == 1
        assert m < 1 << i
        value |= (m >> 1) << count
        count += i - 1
    assert count == (degree - 1) * (degree + 2) // 2
    assert poly % 2 == 1
    assert initial[0] == 1
    return value, count


def main() -> None:
    table = np.load(pathlib.Path(scipy.stats.__file__).parent / "_sobol_direction_numbers.npz")
    polys, initials = table["poly"].tolist(), table["vinit"].tolist()
    degrees = [poly.bit_length() - 1 for poly in polys]
    assert degrees[1:] == sorted(degrees[1:])
    assert min(degrees[1:]) == 1

    words, value, count = [], 0, 0
    first_dimension, first_bit, total = [0] * 20, [0] * 20, 0
    for dimension in range(1, len(polys)):
        degree = degrees[dimension]
        if not first_dimension[degree]:
            first_dimension[degree], first_bit[degree] = dimension, total
        bits, width = dimension_bits(polys[dimension], initials[dimension])
        value |= bits << count
        count, total = count + width, total + width
        while count >= 64:
            words.append(value & (2**64 - 1))
            value, count = value >> 64, count - 64
    words.append(value)
    words.append(0)  # so that a read of two words never passes the end
    first_dimension[19] = len(polys)

    print(HEADER.format(dims=len(polys)))
    print("const uint32_t sf_sobol_first_dimension[20] = {" + ", ".join(map(str, first_dimension)) + "};")
    print("const uint32_t sf_sobol_first_bit[20] = {" + ", ".join(map(str, first_bit)) + "};")
    print("const uint64_t sf_sobol_words[SF_SOBOL_WORDS] = {")
    for i in range(0, len(words), 6):
        print("    " + " ".join(f"0x{word:x}," for word in words[i : i + 6]))
    print("};")
    assert len(words) == 49205, len(words)  # SF_SOBOL_WORDS


if __name__ == "__main__":
    main()
