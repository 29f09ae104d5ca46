# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0
"""Writes include/sunfleck/lanczos_table.h and lanczos_table_f64.h (needs mpmath).

The integral of |sinc(x) sinc(x / 3)| away from each of its zeros, as v^2 times a polynomial in the
distance v from it, interpolated at Chebyshev nodes. Run without arguments; --check compares instead.
"""

import sys
from pathlib import Path

import mpmath as mp

HERE = Path(__file__).parent
mp.mp.dps = 50
PIECES = [(1, -1, 1.0), (1, 1, 0.6), (2, -1, 0.6), (2, 1, 0.6), (3, -1, 0.7)]  # zero, side, reach
HEAD = """// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Made by make_lanczos_table.py: do not edit. Column: the integral of |sinc(x) sinc(x / 3)| over the
 * distance v from the zero at 1 inwards and outwards, 2 inwards and outwards, 3 inwards, over
 * v^2, by powers of v; then the masses of the lobes between the zeros, from the middle outwards. */
#ifndef SUNFLECK_LANCZOS_TABLE{guard}_H
#define SUNFLECK_LANCZOS_TABLE{guard}_H

"""


def density(x: mp.mpf) -> mp.mpf:
    return abs(mp.sincpi(x) * mp.sincpi(x / 3))


def mass(low: mp.mpf, high: mp.mpf) -> mp.mpf:
    return mp.quad(density, mp.linspace(low, high, 5))


def polynomial(zero: int, side: int, reach: float, degree: int) -> list[mp.mpf]:
    """The coefficients from v^0; the double zero at 3 has none of v^0."""
    double = zero == 3
    degree -= double
    nodes = [mp.mpf(reach) * (1 - mp.cos(mp.pi * (k + mp.mpf(1) / 2) / (degree + 1))) / 2 for k in range(degree + 1)]
    values = [mp.quad(lambda v, z=zero, s=side: density(z + s * v), [0, v / 2, v]) / v ** (2 + double) for v in nodes]
    rows = mp.matrix([[v**k for k in range(degree + 1)] for v in nodes])
    return [mp.mpf(0)] * double + list(mp.lu_solve(rows, mp.matrix(values)))


def literal(x: mp.mpf, digits: int, suffix: str) -> str:
    return mp.nstr(x, digits, min_fixed=-10, max_fixed=10) + suffix


def table(real: str, degree: int, digits: int) -> str:
    name, suffix = ("_f64", "") if real == "double" else ("", "f")
    rows = [polynomial(zero, side, reach, degree) for zero, side, reach in PIECES]
    text = HEAD.format(guard=name.upper())
    text += f"#define SF_LANCZOS_TERMS{'' if real == 'double' else '_F'} {degree + 1}\n\n"
    text += f"static const {real} sf_lanczos_table{name}[{degree + 1}][5] = {{\n"
    for row in zip(*rows, strict=True):
        text += "    {" + ",\n     ".join(literal(x, digits, suffix) for x in row) + "},\n"
    lobes = ", ".join(literal(mass(mp.mpf(k), mp.mpf(k + 1)), digits, suffix) for k in range(3))
    return text + f"}};\n\nstatic const {real} sf_lanczos_lobes{name}[3] = {{{lobes}}};\n\n#endif\n"


def main() -> int:
    wrong = 0
    for path, made in [
        (HERE / "../../include/sunfleck/lanczos_table.h", table("float", 9, 12)),
        (HERE / "../lanczos_table_f64.h", table("double", 19, 24)),
    ]:
        if "--check" in sys.argv:
            wrong += path.read_text() != made
        else:
            path.write_text(made)
    return wrong


if __name__ == "__main__":
    sys.exit(main())
