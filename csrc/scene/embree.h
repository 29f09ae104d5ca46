// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Every difference between Embree 3.13 and Embree 4, and between packet widths, in one place. */
#ifndef SUNFLECK_EMBREE_H
#define SUNFLECK_EMBREE_H

#include <stdbool.h>

#include "base/platform.h"
#include "sunfleck/base.h"

#if SF_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Refuses what Embree could not do, by its error: SF_STATUS_OUT_OF_MEMORY or SF_STATUS_BACKEND. */
sf_status sf_fail_embree(sf_error *error, int code, const char *format, ...) SF_PRINTF(3, 4);

/* How alike rays are; Embree picks its traversal by it. A stream: those of several packets, as all are of
 * one camera. */
typedef enum sf_coherence { SF_STREAM, SF_COHERENT, SF_INCOHERENT } sf_coherence;

/* -1 for the rays that are wanted: those whose end is not below 0. */
static inline void sf_embree_choose(const float tfar[16], int valid[16]) {
    SF_ROLLED
    for (int l = 0; l < 16; ++l) valid[l] = tfar[l] < 0 ? 0 : -1;
}

/* The nearest hits of packets of 16 rays, of those wanted. Embree 3 takes a stream as a
 * whole; Embree 4 has none. */
static inline void sf_embree_intersect16(RTCScene scene, struct RTCRayHit16 *rays, unsigned packets,
                                         sf_coherence coherence) {
    bool alike = coherence != SF_INCOHERENT;
#if SF_EMBREE_MAJOR >= 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = alike ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = alike ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    if (coherence == SF_STREAM) {
        rtcIntersectNM(scene, &context, (struct RTCRayHitN *)rays, 16, packets, sizeof *rays);
        return;
    }
#endif
    for (unsigned p = 0; p < packets; ++p) {
        SF_ALIGNED(int) valid[16];
        sf_embree_choose(rays[p].ray.tfar, valid);
#if SF_EMBREE_MAJOR >= 4
        rtcIntersect16(valid, scene, rays + p, &arguments);
#else
        rtcIntersect16(valid, scene, &context, rays + p);
#endif
    }
}

/* Whether anything lies between the ends of 16 rays, of those wanted: tfar becomes -infinity where it does. */
static inline void sf_embree_occluded16(RTCScene scene, struct RTCRay16 *rays) {
    SF_ALIGNED(int) valid[16];
    sf_embree_choose(rays->tfar, valid);
#if SF_EMBREE_MAJOR >= 4
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcOccluded16(valid, scene, rays, &arguments);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccluded16(valid, scene, &context, rays);
#endif
}

#endif
