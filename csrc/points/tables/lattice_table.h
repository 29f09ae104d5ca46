// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_LATTICE_TABLE_H
#define SUNFLECK_LATTICE_TABLE_H

#include "sunfleck/points.h"

/* Odd, below 2^20: dimension d of point k of the lattice of n points is k vector[d] / n modulo 1. */
extern const uint32_t sf_lattice_vector[SF_LATTICE_MAX_DIMS];

#endif
