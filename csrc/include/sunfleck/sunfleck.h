// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The whole library in one include. Each module's header may be included alone. */
#ifndef SUNFLECK_SUNFLECK_H
#define SUNFLECK_SUNFLECK_H

#include "sunfleck/base.h"
#include "sunfleck/discrete.h"
#include "sunfleck/estimate.h"
#include "sunfleck/film.h"
#include "sunfleck/image.h"
#include "sunfleck/integrate.h"
#include "sunfleck/mapping.h"
#include "sunfleck/material.h"
#include "sunfleck/points.h"
#include "sunfleck/render.h"
#include "sunfleck/rng.h"
#include "sunfleck/scene.h"
#include "sunfleck/uniformity.h"

#endif
