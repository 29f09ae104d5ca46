// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "away.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace nb = nanobind;

namespace {

// Plain values: what has a destructor would be destroyed under the threads that stay away.
std::atomic<long> outside{0}, staying{0};
std::atomic<bool> leaving{false};
pthread_t leaver;  // the thread that ends the interpreter comes back, as long as it likes

void forget_threads() {  // in a child of fork, which has none of them
    outside = 0;
    staying = 0;
    leaving = false;
}

[[noreturn]] void stay_away() {
    ++staying;
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

void leave() {
    using clock = std::chrono::steady_clock;
    leaver = pthread_self();
    leaving = true;
    PyThreadState *state = PyEval_SaveThread();
    const clock::time_point latest = clock::now() + std::chrono::seconds(2);
    while (outside > staying && clock::now() < latest) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    PyEval_RestoreThread(state);
    if (staying > 0) nb::set_leak_warnings(false);  // what those threads hold is theirs for good
}

}  // namespace

away::away() {
    ++outside;
    state = PyEval_SaveThread();
}

away::~away() {
    if (interpreter_is_leaving()) stay_away();
    PyEval_RestoreThread(state);
    --outside;
}

bool interpreter_is_leaving() { return leaving && !pthread_equal(pthread_self(), leaver); }

void watch_the_exit() {
    pthread_atfork(nullptr, nullptr, forget_threads);
    nb::module_::import_("atexit").attr("register")(nb::cpp_function(&leave));
}
