// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "turn.h"

#include <new>

namespace {

#if defined(PTHREAD_RWLOCK_WRITER_NONRECURSIVE_INITIALIZER_NP)
// A waiting fork comes before threads that draw without a pause.
#define GATE_INITIALIZER PTHREAD_RWLOCK_WRITER_NONRECURSIVE_INITIALIZER_NP
#else
#define GATE_INITIALIZER PTHREAD_RWLOCK_INITIALIZER
#endif

pthread_rwlock_t gate = GATE_INITIALIZER;  // taken to write by a fork
std::atomic<uint64_t> forks_so_far{0};     // of this process and its ancestors
std::mutex mending;

void before_fork() { pthread_rwlock_wrlock(&gate); }

void in_parent() { pthread_rwlock_unlock(&gate); }

// The child has another thread number, by which it could not release what the parent's thread took.
void in_child() {
    gate = GATE_INITIALIZER;
    new (&mending) std::mutex;
    ++forks_so_far;
}

}  // namespace

void watch_forks() {
    static const int watching = pthread_atfork(before_fork, in_parent, in_child);
    (void)watching;
}

whole_for_forks::whole_for_forks() { pthread_rwlock_rdlock(&gate); }
whole_for_forks::~whole_for_forks() { pthread_rwlock_unlock(&gate); }

void turn_lock::mend_after_fork() {
    if (forks == forks_so_far) return;
    std::lock_guard<std::mutex> alone(mending);
    if (forks == forks_so_far) return;
    // The thread that forked goes on in the child, and keeps what it holds.
    if (holder != pthread_self()) {
        new (&inner) std::mutex;
        holder = pthread_t{};
        depth = 0;
    }
    forks = forks_so_far.load();
}

bool turn_lock::take_again() {
    mend_after_fork();
    if (holder != pthread_self()) return false;
    ++depth;
    return true;
}

void turn_lock::lock() {
    if (take_again()) return;
    inner.lock();
    holder = pthread_self();
    depth = 1;
}

bool turn_lock::try_lock() {
    if (take_again()) return true;
    if (!inner.try_lock()) return false;
    holder = pthread_self();
    depth = 1;
    return true;
}

void turn_lock::unlock() {
    if (--depth) return;
    holder = pthread_t{};
    inner.unlock();
}
