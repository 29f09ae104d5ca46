// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Rays to Embree and back. A packet is written and read at the width at which Embree reads and writes it. */
#ifndef SUNFLECK_TRACE_KERNELS_H
#define SUNFLECK_TRACE_KERNELS_H

#include "base/isa_dispatch.h"
#include "trace/batch.h"

typedef struct sf_trace_kernels {
    /* The nearest hits of the rays, packet by packet: of packet p those whose bit in active[p] is set. Fills
     * distance, hit_normal and mesh, which is the miss row for the others. */
    void (*nearest)(sf_batch *batch, const sf_scene *scene, uint32_t packets, const uint32_t *active,
                    sf_coherence coherence);

    /* Shadow rays order[0 .. count - 1] from `from` along `to_light`; fills `arrives`. */
    void (*shadow)(sf_batch *batch, const sf_scene *scene, float (*from)[SF_PATHS], uint32_t count);
} sf_trace_kernels;
SF_KERNELS(sf_trace_kernels)

#endif
