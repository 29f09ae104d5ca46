// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* The one place for what C99 does not have: restrict hints, alignment, atomics, threads,
 * clocks, the processor's features and its floating-point mode. GCC and Clang, POSIX. */
#ifndef SUNFLECK_PLATFORM_H
#define SUNFLECK_PLATFORM_H

#include <pthread.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#define SF_RESTRICT restrict
#define SF_ALIGNMENT 64
#define SF_ALIGNED(T) __attribute__((aligned(SF_ALIGNMENT))) T

/* Tells the compiler that the pointer is aligned to SF_ALIGNMENT bytes. */
#define SF_ASSUME_ALIGNED(p) __builtin_assume_aligned((p), SF_ALIGNMENT)

/* Keeps a short loop a loop, for the vectorizer to take: unrolled first, it is taken apart into
 * scalars. */
#if defined(__clang__)
#define SF_ROLLED _Pragma("clang loop unroll(disable)")
#else
#define SF_ROLLED _Pragma("GCC unroll 1")
#endif

#define SF_PRINTF(text, first) __attribute__((format(printf, text, first)))

/* Aligned heap memory; NULL when there is none. Freed with sf_aligned_free. */
static inline void *sf_aligned_alloc(size_t bytes) {
    void *memory = NULL;
    if (bytes > SIZE_MAX - SF_ALIGNMENT) return NULL;
    size_t rounded = (bytes + SF_ALIGNMENT - 1) / SF_ALIGNMENT * SF_ALIGNMENT;
    return posix_memalign(&memory, SF_ALIGNMENT, rounded ? rounded : SF_ALIGNMENT) == 0 ? memory : NULL;
}
static inline void sf_aligned_free(void *memory) { free(memory); }

/* Large arrays that start as zero bytes, on huge pages where the system has them: an image of
 * 16 million pixels is a gigabyte, and a quarter of a million faults, on small ones. NULL when
 * there is no memory. Freed with sf_pages_free and the same size. */
#define SF_HUGE_PAGE ((size_t)1 << 21)
static inline size_t sf_pages_size(size_t bytes) {
    size_t unit = bytes >= 2 * SF_HUGE_PAGE ? SF_HUGE_PAGE : 1;
    return bytes ? (bytes + unit - 1) / unit * unit : 1;
}
static inline void *sf_pages_alloc(size_t bytes) {
    size_t size = sf_pages_size(bytes), spare = size >= 2 * SF_HUGE_PAGE ? SF_HUGE_PAGE : 0;
    char *memory = mmap(NULL, size + spare, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) return NULL;
    if (spare) { /* from the first border of huge pages on */
        size_t before = (SF_HUGE_PAGE - (uintptr_t)memory % SF_HUGE_PAGE) % SF_HUGE_PAGE;
        if (before) munmap(memory, before);
        munmap(memory + before + size, spare - before);
        memory += before;
    }
#ifdef MADV_HUGEPAGE
    (void)madvise(memory, size, MADV_HUGEPAGE); /* a hint: refused by kernels without them */
#endif
    return memory;
}
static inline void sf_pages_free(void *memory, size_t bytes) {
    if (memory) munmap(memory, sf_pages_size(bytes));
}

/* Copies to memory that will not be read soon, past the caches where the processor can: a store of
 * its own kind then need not fetch the line that it overwrites. After the last of such copies,
 * sf_stream_end makes them visible to other threads. */
static inline void sf_stream_copy(void *to, const void *from, size_t bytes) {
#if defined(__x86_64__)
    char *out = (char *)to;
    const char *in = (const char *)from;
    size_t head = (0 - (uintptr_t)to) % 64; /* whole lines from here on */
    if (head > bytes) head = bytes;
    memcpy(out, in, head);
    for (out += head, in += head, bytes -= head; bytes >= 64; out += 64, in += 64, bytes -= 64)
        for (int i = 0; i < 4; ++i) _mm_stream_si128((__m128i *)out + i, _mm_loadu_si128((const __m128i *)in + i));
    memcpy(out, in, bytes);
#else
    memcpy(to, from, bytes);
#endif
}
static inline void sf_stream_end(void) {
#if defined(__x86_64__)
    _mm_sfence();
#endif
}

/* A counter that threads advance together. */
typedef struct sf_atomic_size {
    size_t value;
} sf_atomic_size;
static inline size_t sf_atomic_fetch_add(sf_atomic_size *a, size_t step) {
    return __atomic_fetch_add(&a->value, step, __ATOMIC_RELAXED);
}
static inline void sf_atomic_store(sf_atomic_size *a, size_t value) {
    __atomic_store_n(&a->value, value, __ATOMIC_RELEASE);
}
static inline size_t sf_atomic_load(const sf_atomic_size *a) { return __atomic_load_n(&a->value, __ATOMIC_ACQUIRE); }

/* Lanes of 64 bits, as many as a register of this translation unit's instruction set has, with the
 * operators of their elements: for kernels whose values must stay in registers from round to
 * round, where loops over arrays would go through memory. */
#if defined(__AVX512F__) && defined(__AVX512DQ__)
enum { SF_LANES64 = 8 };
#elif defined(__AVX2__)
enum { SF_LANES64 = 4 };
#else
enum { SF_LANES64 = 2 };
#endif
typedef uint64_t sf_lanes64 __attribute__((vector_size(8 * SF_LANES64)));

/* The products of the low 32 bits of the lanes. */
static inline sf_lanes64 sf_lanes64_multiply32(sf_lanes64 a, sf_lanes64 b) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    return (sf_lanes64)_mm512_mul_epu32((__m512i)a, (__m512i)b);
#elif defined(__AVX2__)
    return (sf_lanes64)_mm256_mul_epu32((__m256i)a, (__m256i)b);
#elif defined(__x86_64__)
    return (sf_lanes64)_mm_mul_epu32((__m128i)a, (__m128i)b);
#else
    return (a & 0xffffffffu) * (b & 0xffffffffu);
#endif
}

/* The same of 32 bits. */
#if defined(__AVX512BW__)
enum { SF_LANES32 = 16 };
#elif defined(__AVX2__)
enum { SF_LANES32 = 8 };
#else
enum { SF_LANES32 = 4 };
#endif
typedef uint32_t sf_lanes32 __attribute__((vector_size(4 * SF_LANES32)));

/* Of each lane its bits in reverse order. Half bytes are looked up and bytes moved where the instruction
 * set can, which takes half as long as swapping ever larger groups of bits. */
static inline sf_lanes32 sf_lanes32_reverse_bits(sf_lanes32 x) {
    const sf_lanes32 low = x & 0x0f0f0f0fu, high = x >> 4 & 0x0f0f0f0fu;
#if defined(__AVX2__)
    const __m128i halves = _mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15);
    const __m128i bytes = _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
#endif
#if defined(__AVX512BW__)
    const __m512i table = _mm512_broadcast_i32x4(halves), order = _mm512_broadcast_i32x4(bytes);
    const sf_lanes32 first = (sf_lanes32)_mm512_shuffle_epi8(table, (__m512i)low) << 4;
    const sf_lanes32 second = (sf_lanes32)_mm512_shuffle_epi8(table, (__m512i)high);
    return (sf_lanes32)_mm512_shuffle_epi8((__m512i)(first | second), order);
#elif defined(__AVX2__)
    const __m256i table = _mm256_broadcastsi128_si256(halves), order = _mm256_broadcastsi128_si256(bytes);
    const sf_lanes32 first = (sf_lanes32)_mm256_shuffle_epi8(table, (__m256i)low) << 4;
    const sf_lanes32 second = (sf_lanes32)_mm256_shuffle_epi8(table, (__m256i)high);
    return (sf_lanes32)_mm256_shuffle_epi8((__m256i)(first | second), order);
#else
    x = low << 4 | high;
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x00ff00ffu) << 8 | (x >> 8 & 0x00ff00ffu);
    return x << 16 | x >> 16;
#endif
}

/* The same of an array's words. */
static inline void sf_reverse_bits_each(uint32_t *words, size_t count) {
    size_t i = 0;
    for (; i + SF_LANES32 <= count; i += SF_LANES32) {
        sf_lanes32 lanes;
        memcpy(&lanes, words + i, sizeof lanes);
        lanes = sf_lanes32_reverse_bits(lanes);
        memcpy(words + i, &lanes, sizeof lanes);
    }
    if (i == count) return;
    sf_lanes32 rest = {0};
    memcpy(&rest, words + i, (count - i) * sizeof *words);
    rest = sf_lanes32_reverse_bits(rest);
    memcpy(words + i, &rest, (count - i) * sizeof *words);
}

/* The lanes of two or of four registers in turn: x[0][0], x[1][0], …, x[0][1], … */
static inline void sf_lanes64_interleave2(const sf_lanes64 x[2], void *out) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    const __m512i first = _mm512_set_epi64(11, 3, 10, 2, 9, 1, 8, 0);
    const __m512i second = _mm512_set_epi64(15, 7, 14, 6, 13, 5, 12, 4);
    _mm512_storeu_si512(out, _mm512_permutex2var_epi64((__m512i)x[0], first, (__m512i)x[1]));
    _mm512_storeu_si512((char *)out + 64, _mm512_permutex2var_epi64((__m512i)x[0], second, (__m512i)x[1]));
#else
    uint64_t words[2 * SF_LANES64];
    for (int l = 0; l < SF_LANES64; ++l)
        for (int w = 0; w < 2; ++w) words[2 * l + w] = x[w][l];
    memcpy(out, words, sizeof words);
#endif
}
static inline void sf_lanes64_interleave4(const sf_lanes64 x[4], void *out) {
    uint64_t halves[2][2 * SF_LANES64];
    const sf_lanes64 even[2] = {x[0], x[2]}, odd[2] = {x[1], x[3]};
    sf_lanes64_interleave2(even, halves[0]);
    sf_lanes64_interleave2(odd, halves[1]);
    for (int part = 0; part < 2; ++part) {
        sf_lanes64 pair[2];
        memcpy(&pair[0], halves[0] + part * SF_LANES64, sizeof pair[0]);
        memcpy(&pair[1], halves[1] + part * SF_LANES64, sizeof pair[1]);
        sf_lanes64_interleave2(pair, (uint64_t *)out + 2 * part * SF_LANES64);
    }
}
/* What it was before; work done by those that subtracted before is seen by who reads the result. */
static inline size_t sf_atomic_subtract(sf_atomic_size *a, size_t step) {
    return __atomic_fetch_sub(&a->value, step, __ATOMIC_ACQ_REL);
}

/* Sets it to `to` if it is `from`: 1, or 0 where it is something else. Work done before is seen by
 * who reads `to`, and the other way. */
static inline int sf_atomic_replace(sf_atomic_size *a, size_t from, size_t to) {
    return __atomic_compare_exchange_n(&a->value, &from, to, 0, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
}

/* A pointer that threads hand to one another: what it was, and what it pointed to, is seen by who takes it. */
typedef struct sf_atomic_pointer {
    void *value;
} sf_atomic_pointer;
static inline void *sf_atomic_take(sf_atomic_pointer *a, void *in_its_place) {
    return __atomic_exchange_n(&a->value, in_its_place, __ATOMIC_ACQ_REL);
}
static inline void *sf_atomic_pointer_load(const sf_atomic_pointer *a) {
    return __atomic_load_n(&a->value, __ATOMIC_ACQUIRE);
}
static inline int sf_atomic_pointer_replace(sf_atomic_pointer *a, void *from, void *to) {
    return __atomic_compare_exchange_n(&a->value, &from, to, 0, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
}

/* Tells the processor that this is a loop which waits. */
static inline void sf_pause(void) {
#if defined(__x86_64__)
    _mm_pause();
#endif
}

/* Lets another thread have the processor, if one waits for it. */
static inline void sf_yield(void) { (void)sched_yield(); }

/* What the system says of an errno; the thread's own text, where the system keeps one. */
static inline const char *sf_system_message(int number) { return strerror(number); }

/* How many bits of x are 1; the compiler's own is a call where the processor may lack the instruction. */
static inline unsigned sf_count_bits(uint32_t x) {
    x -= x >> 1 & 0x55555555u;
    x = (x & 0x33333333u) + (x >> 2 & 0x33333333u);
    return ((x + (x >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24;
}

/* Seconds on a clock that never steps back. */
static inline double sf_seconds_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Seconds that the calling thread has had a processor. */
static inline double sf_thread_seconds_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Sets flush-to-zero and denormals-are-zero, as Embree asks of threads that trace; returns the
 * mode to restore. A no-op off x86. */
static inline unsigned sf_flush_denormals(void) {
#if defined(__x86_64__)
    unsigned mode = _mm_getcsr();
    _mm_setcsr(mode | 0x8040u);
    return mode;
#else
    return 0;
#endif
}
static inline void sf_restore_denormals(unsigned mode) {
#if defined(__x86_64__)
    _mm_setcsr(mode);
#else
    (void)mode;
#endif
}

/* The processor that the calling thread is on now; -1 where the system does not say. */
static inline int sf_processor_now(void) {
#if defined(__linux__)
    return sched_getcpu();
#else
    return -1;
#endif
}

/* Lets a thread run where the calling one may, but not on this processor; 0, and nothing done, where
 * that leaves none, or the system refuses or can't. */
static inline int sf_thread_avoid(pthread_t thread, int processor) {
#if defined(__linux__)
    cpu_set_t allowed;
    if (processor < 0 || processor >= CPU_SETSIZE || sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 0;
    CPU_CLR(processor, &allowed);
    return CPU_COUNT(&allowed) > 0 && pthread_setaffinity_np(thread, sizeof allowed, &allowed) == 0;
#else
    (void)thread;
    (void)processor;
    return 0;
#endif
}

/* The number of processors this process may run on, at least 1. */
unsigned sf_processor_count(void);

#endif
