// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A team: threads that outlive the work they are given. Waking a thread that sleeps takes as long as
 * filling a first cache some ten times, and starting one longer still; so whoever waits looks for
 * a while before it sleeps, and short work wakes nobody unless it comes again and again. A share that
 * its thread has not begun when the caller has done its own is the caller's too: on a busy machine
 * a team costs little more than no threads at all.
 *
 * A system likes to wake a thread where its waker runs, for the sake of that processor's caches; but this
 * waker goes on working there, and the two would take turns. So members keep off the caller's
 * processor. */
#include "points/thread_team.h"

#include "base/error.h"
#include "base/platform.h"
#include "sunfleck/points.h"

#define LOOK_SECONDS 50e-6  /* about the time to sleep and wake twice */
#define SOON_SECONDS 250e-6 /* work that comes at this pace is worth a member that is awake */

/* A ticket is even where a share waits for its member, odd where someone has taken it. */
typedef struct member {
    sf_thread_team *team;
    unsigned number;
    sf_atomic_size ticket;
    int asleep;
    int avoided; /* the processor it keeps off; -1: none */
    pthread_cond_t start;
    pthread_t thread;
} member;

struct sf_thread_team {
    pthread_mutex_t busy;  /* held while someone's work runs */
    pthread_mutex_t mutex; /* of who is asleep */
    pthread_cond_t finish;
    sf_atomic_size working; /* shares of members that are not done */
    unsigned count;
    int caller_sleeps, ending;
    double last_run; /* when one began */
    sf_thread_team_fn work;
    void *user;
    member *members[SF_THREAD_TEAM_MAX];
};

static int waits(const member *m) { return sf_atomic_load(&m->ticket) % 2 == 0; }

static int take(member *m) {
    size_t ticket = sf_atomic_load(&m->ticket);
    return ticket % 2 == 0 && sf_atomic_replace(&m->ticket, ticket, ticket + 1);
}

/* One look; starts the clock at the first, and says 0 when time is up. Now and then the processor is
 * offered to others: on a busy machine the one waited for may need this very one. */
static int look_on(unsigned *looks, double *end) {
    sf_pause();
    if (++*looks % 64) return 1;
    sf_yield();
    double now = sf_seconds_now();
    if (*looks == 64) *end = now + LOOK_SECONDS;
    return now < *end;
}

static void wait_for_ticket(member *self) {
    unsigned looks = 0;
    double end = 0;
    while (!waits(self))
        if (!look_on(&looks, &end)) break;
    if (waits(self)) return;
    pthread_mutex_lock(&self->team->mutex);
    self->asleep = 1;
    while (!waits(self)) pthread_cond_wait(&self->start, &self->team->mutex);
    self->asleep = 0;
    pthread_mutex_unlock(&self->team->mutex);
}

/* While a share is taken and not done the caller does not return, and work and user stay. */
static void *serve(void *argument) {
    member *self = argument;
    sf_thread_team *team = self->team;
    for (;;) {
        wait_for_ticket(self);
        if (!take(self)) continue;
        if (team->ending) return NULL;
        team->work(team->user, self->number);
        if (sf_atomic_subtract(&team->working, 1) != 1) continue;
        pthread_mutex_lock(&team->mutex);
        if (team->caller_sleeps) pthread_cond_signal(&team->finish);
        pthread_mutex_unlock(&team->mutex);
    }
}

static int join_member(sf_thread_team *team) {
    member *fresh = calloc(1, sizeof *fresh);
    if (!fresh) return 0;
    fresh->team = team;
    fresh->number = team->count;
    fresh->avoided = -1;
    sf_atomic_store(&fresh->ticket, 1);
    pthread_cond_init(&fresh->start, NULL);
    if (pthread_create(&fresh->thread, NULL, serve, fresh) != 0) {
        pthread_cond_destroy(&fresh->start);
        free(fresh);
        return 0;
    }
    team->members[team->count++] = fresh;
    return 1;
}

static void give_tickets(sf_thread_team *team, unsigned count, int wakes) {
    int here = sf_processor_now();
    sf_atomic_store(&team->working, count);
    for (unsigned i = 0; i < count; ++i) {
        member *m = team->members[i];
        if (m->avoided != here && sf_thread_avoid(m->thread, here)) m->avoided = here;
        sf_atomic_store(&m->ticket, sf_atomic_load(&m->ticket) + 1);
        pthread_mutex_lock(&team->mutex);
        if (m->asleep && wakes) pthread_cond_signal(&m->start);
        pthread_mutex_unlock(&team->mutex);
    }
}

static void wait_for_all(sf_thread_team *team) {
    unsigned looks = 0;
    double end = 0;
    while (sf_atomic_load(&team->working))
        if (!look_on(&looks, &end)) break;
    if (!sf_atomic_load(&team->working)) return;
    pthread_mutex_lock(&team->mutex);
    team->caller_sleeps = 1;
    while (sf_atomic_load(&team->working)) pthread_cond_wait(&team->finish, &team->mutex);
    team->caller_sleeps = 0;
    pthread_mutex_unlock(&team->mutex);
}

static int comes_soon(sf_thread_team *team) {
    double before = team->last_run;
    team->last_run = sf_seconds_now();
    return team->last_run - before < SOON_SECONDS;
}

int sf_thread_team_run(sf_thread_team *team, unsigned shares, int is_long, sf_thread_team_fn work, void *user) {
    if (pthread_mutex_trylock(&team->busy) != 0) return 0;
    unsigned helped = shares - 1 < SF_THREAD_TEAM_MAX ? shares - 1 : SF_THREAD_TEAM_MAX;
    while (team->count < helped && join_member(team)) continue;
    if (helped > team->count) helped = team->count;
    team->work = work;
    team->user = user;
    give_tickets(team, helped, comes_soon(team) || is_long);
    for (unsigned share = shares; share-- > 0;) {
        if (share < helped && !take(team->members[share])) continue;
        work(user, share);
        if (share < helped) sf_atomic_subtract(&team->working, 1);
    }
    wait_for_all(team);
    pthread_mutex_unlock(&team->busy);
    return 1;
}

sf_status sf_thread_team_create(sf_thread_team **out, sf_error *error) {
    sf_thread_team *team = *out = calloc(1, sizeof *team);
    if (!team) return sf_fail_memory(error, "a team", sizeof *team);
    pthread_mutex_init(&team->busy, NULL);
    pthread_mutex_init(&team->mutex, NULL);
    pthread_cond_init(&team->finish, NULL);
    return SF_STATUS_OK;
}

void sf_thread_team_destroy(sf_thread_team *team) {
    if (!team) return;
    team->ending = 1;
    give_tickets(team, team->count, 1);
    for (unsigned i = 0; i < team->count; ++i) {
        pthread_join(team->members[i]->thread, NULL);
        pthread_cond_destroy(&team->members[i]->start);
        free(team->members[i]);
    }
    pthread_cond_destroy(&team->finish);
    pthread_mutex_destroy(&team->busy);
    pthread_mutex_destroy(&team->mutex);
    free(team);
}
