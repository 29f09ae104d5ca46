// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#ifndef SUNFLECK_RNG_LCG_H
#define SUNFLECK_RNG_LCG_H

#include "sunfleck/rng.h"

/* Gives `rng`, whose kind is lcg32 or lcg64, its constants, or says what is wrong with them. */
sf_status sf_lcg_set(sf_rng *rng, const sf_lcg_parameters *parameters, sf_error *error);
sf_lcg_parameters sf_lcg_get(const sf_rng *rng);

#endif
