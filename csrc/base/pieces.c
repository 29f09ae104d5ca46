// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Cuts work into pieces, between which its caller is asked whether to go on. */
#include "base/interrupt.h"

/* A piece doubles while it is shorter than the one and halves where it is longer than the other, in time that the
 * caller's thread works: that it waits for a busy machine makes no piece too long, and small ones would wait more. */
#define SHORT_PIECE_SECONDS 10e-3
#define LONG_PIECE_SECONDS 30e-3
#define LATE_PIECE_SECONDS 60e-3

static size_t next_piece(size_t piece, size_t smallest, size_t total, double worked, double passed) {
    if (worked < SHORT_PIECE_SECONDS && passed < LONG_PIECE_SECONDS) return piece < total / 2 ? 2 * piece : total;
    if ((worked < LONG_PIECE_SECONDS && passed < LATE_PIECE_SECONDS) || piece / 2 < smallest) return piece;
    return piece / 2 / smallest * smallest;
}

sf_status sf_work_in_pieces(size_t total, size_t smallest, sf_piece_fn work, void *user, const sf_interrupt *interrupt,
                            sf_error *error) {
    if (total <= smallest || smallest == 0 || !interrupt) return work(user, 0, total, error);
    sf_watch watch;
    sf_watch_begin(&watch, interrupt);
    double worked = sf_thread_seconds_now(), passed = sf_seconds_now();
    for (size_t done = 0, piece = smallest; done < total;) {
        size_t count = total - done < piece ? total - done : piece;
        sf_status status = work(user, done, count, error);
        if (status != SF_STATUS_OK) return status;
        done += count;
        piece = next_piece(piece, smallest, total / smallest * smallest, sf_thread_seconds_now() - worked,
                           sf_seconds_now() - passed);
        if (done < total && sf_watch_ask(&watch)) return sf_watch_status(&watch, error);
        worked = sf_thread_seconds_now();
        passed = sf_seconds_now();
    }
    return SF_STATUS_OK;
}
