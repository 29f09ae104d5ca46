// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Locks that a process may be forked under: how threads take turns with a C struct, and how a fork waits until
 * none is half changed.
 */
#ifndef SUNFLECK_BIND_TURN_H
#define SUNFLECK_BIND_TURN_H

#include <pthread.h>

#include <atomic>
#include <cstdint>
#include <mutex>

// A lock that its holder may take again. In a forked child a lock that another thread of the parent held is free,
// for that thread is not there to release it.
class turn_lock {
   public:
    void lock();
    bool try_lock();
    void unlock();

   private:
    void mend_after_fork();
    bool take_again();

    std::mutex inner;
    std::atomic<pthread_t> holder{pthread_t{}};
    unsigned depth = 0;
    std::atomic<uint64_t> forks{0};  // before the last use
};

// While one lives a fork waits, so that the child never sees a struct half changed. Nothing that needs the
// interpreter's lock may run meanwhile, and one thread holds at most one.
class whole_for_forks {
   public:
    whole_for_forks();
    ~whole_for_forks();
    whole_for_forks(const whole_for_forks &) = delete;
    whole_for_forks &operator=(const whole_for_forks &) = delete;
};

// Asks the system to keep both promises; called once, when the module is loaded.
void watch_forks();

#endif
