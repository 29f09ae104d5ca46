#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0
"""Writes lattice_table.c from Kuo's generating vector lattice-33002-1024-1048576.9125.

The vector is read from the copy that the package qmcpy ships (2.4 was used), whose source
distribution is given as the argument:

    pip download --no-deps --no-binary :all: qmcpy==2.4
    python3 csrc/points/tables/make_lattice_table.py qmcpy-2.4.tar.gz > csrc/points/tables/lattice_table.c

Of its 9,125 components the first 4,391 are written: component 4,391 is the first that equals an
earlier one, or its negative modulo 2^20, and two such dimensions would hold the same numbers.
"""

import io
import sys
import tarfile

import numpy as np

HEADER = """\
// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A generating vector of embedded rank-1 lattices of 2^10 .. 2^20 points in {dims} dimensions: the
 * first components of lattice-33002-1024-1048576.9125 by F. Y. Kuo, found by the
 * component-by-component construction of Cools, Kuo & Nuyens 2006, "Constructing Embedded Lattice
 * Rules for Multivariate Integration", SIAM J. Sci. Comput. 28. Written by make_lattice_table.py.
 * Generated: do not edit. */

#include "points/tables/lattice_table.h"
"""
DIMS = 4391  # SF_LATTICE_MAX_DIMS
MEMBER = "qmcpy/discrete_distribution/lattice/generating_vectors/kuo.lattice-33002-1024-1048576.9125.npy"


def read_vector(archive: str) -> list[int]:
    """The components, from the source distribution or from the .npy file itself."""
    if archive.endswith(".npy"):
        return np.load(archive).tolist()
    with tarfile.open(archive) as tar:
        [name] = [name for name in tar.getnames() if name.endswith(MEMBER)]
        member = tar.extractfile(name)
        assert member is not None
        return np.load(io.BytesIO(member.read())).tolist()


def main() -> None:
    vector = read_vector(sys.argv[1])
    assert len(vector) == 9125
    assert all(z % 2 == 1 and z < 1 << 20 for z in vector)
    folded = [min(z, (1 << 20) - z) for z in vector]
    assert len(set(folded[:DIMS])) == DIMS
    assert folded[DIMS] in folded[:DIMS]

    print(HEADER.format(dims=f"{DIMS:,}"))
    print("const uint32_t sf_lattice_vector[SF_LATTICE_MAX_DIMS] = {")
    for i in range(0, DIMS, 12):
        print("    " + " ".join(f"{z}," for z in vector[i : min(i + 12, DIMS)]))
    print("};")


if __name__ == "__main__":
    main()
