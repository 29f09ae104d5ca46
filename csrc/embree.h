// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Every difference between Embree 3.13 and Embree 4, and between packet widths, in one place. */
#ifndef SUNFLECK_EMBREE_H
#define SUNFLECK_EMBREE_H

#if SF_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* How alike the rays of a packet are; Embree picks its traversal by it. */
typedef enum sf_coherence { SF_COHERENT, SF_INCOHERENT } sf_coherence;

/* The nearest hits of 16 rays, of those whose `valid` is -1. */
static inline void sf_embree_intersect16(RTCScene scene, const int *valid, struct RTCRayHit16 *rays,
                                         sf_coherence coherence) {
#if SF_EMBREE_MAJOR >= 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = coherence == SF_COHERENT ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, rays, &arguments);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherence == SF_COHERENT ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, &context, rays);
#endif
}

/* Whether anything lies between the ends of 16 rays: tfar becomes -infinity where it does. */
static inline void sf_embree_occluded16(RTCScene scene, const int *valid, struct RTCRay16 *rays,
                                        sf_coherence coherence) {
#if SF_EMBREE_MAJOR >= 4
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = coherence == SF_COHERENT ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcOccluded16(valid, scene, rays, &arguments);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherence == SF_COHERENT ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccluded16(valid, scene, &context, rays);
#endif
}

#endif
