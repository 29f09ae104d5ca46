// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The inline functions under the library's flags. */
#define COLLECT collect_right
#include "contraction.h"
