// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* How Ctrl-C reaches what runs in C: an sf_interrupt that runs Python's signal handlers, and pieces of work between
 * which it is asked. */
#ifndef SUNFLECK_BIND_INTERRUPT_H
#define SUNFLECK_BIND_INTERRUPT_H

#include <exception>
#include <type_traits>

#include "sunfleck/base.h"

// For one call of C, by a thread without the GIL.
class signal_watch {
    std::exception_ptr raised;

    static int ask(void *self) noexcept;

   public:
    const sf_interrupt interrupt{&ask, this};

    signal_watch() = default;
    signal_watch(const signal_watch &) = delete;
    signal_watch &operator=(const signal_watch &) = delete;

    // Needs the GIL.
    void raise_what_was_raised() {
        if (raised) std::rethrow_exception(raised);
    }
};

// sf_work_in_pieces of a function work(first, count, error), which must not throw.
template <class Work>
sf_status in_pieces(size_t total, size_t smallest, const sf_interrupt *interrupt, sf_error *error, Work &&work) {
    using function = std::remove_reference_t<Work>;
    auto piece = [](void *user, size_t first, size_t count, sf_error *refused) {
        return (*static_cast<function *>(user))(first, count, refused);
    };
    return sf_work_in_pieces(total, smallest, piece, &work, interrupt, error);
}

// The same of a C function that refuses by the place in its arrays: work(first, count, error), whose items from
// `first` on do not depend on others. A piece that refuses is told of by the call for all up to its end, which counts
// from the first item as the whole call would.
template <class Work>
sf_status in_checked_pieces(size_t total, size_t smallest, const sf_interrupt *interrupt, sf_error *error,
                            Work &&work) {
    return in_pieces(total, smallest, interrupt, error, [&](size_t first, size_t count, sf_error *refused) {
        sf_status status = work(first, count, refused);
        return status == SF_STATUS_INVALID_VALUE && first > 0 ? work(0, first + count, refused) : status;
    });
}

#endif
