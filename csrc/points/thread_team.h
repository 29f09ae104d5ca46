// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Running shares of one piece of work on the threads of a team. */
#ifndef SUNFLECK_THREAD_TEAM_H
#define SUNFLECK_THREAD_TEAM_H

struct sf_thread_team;

typedef void (*sf_thread_team_fn)(void *user, unsigned share);

/* Works shares 0 .. shares - 1, each once: the last on the calling thread, the others each on a
 * thread of the team, which grows to shares - 1 threads, or on the calling thread where that one
 * could not be had or is late. A member that sleeps is woken where the work `is_long`, some
 * 50 us or more, or follows other work closely. Returns when all are done: 1; or 0 at once, without any work, where the
 * team is at work for another caller. */
int sf_thread_team_run(struct sf_thread_team *team, unsigned shares, int is_long, sf_thread_team_fn work, void *user);

#endif
