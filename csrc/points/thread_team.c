// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A crew: threads that outlive the work they are given. Waking a thread that sleeps takes as long as
 * filling a first cache some ten times, and starting one longer still; so whoever waits looks for
 * a while before it sleeps, and short work wakes nobody unless it comes again and again. A share that
 * its thread has not begun when the caller has done its own is the caller's too: on a busy machine
 * a crew costs little more than no threads at all.
 *
 * A system likes to wake a thread where its waker runs, for the sake of that processor's caches; but this
 * waker goes on working there, and the two would take turns. So members keep off the caller's
 * processor. */
#include "points/thread_team.h"

#include "base/error.h"
#include "base/platform.h"

#define LOOK_SECONDS 50e-6  /* about the time to sleep and wake twice */
#define SOON_SECONDS 250e-6 /* work that comes at this pace is worth a member that is awake */

/* A ticket is even where a share waits for its member, odd where someone has taken it. */
typedef struct member {
    sf_crew *crew;
    unsigned number;
    sf_atomic_size ticket;
    int asleep;
    int avoided; /* the processor it keeps off; -1: none */
    pthread_cond_t start;
    pthread_t thread;
} member;

struct sf_crew {
    pthread_mutex_t busy;  /* held while someone's work runs */
    pthread_mutex_t mutex; /* of who is asleep */
    pthread_cond_t finish;
    sf_atomic_size working; /* shares of members that are not done */
    unsigned count;
    int caller_sleeps, ending;
    double last_run; /* when one began */
    sf_crew_work_fn work;
    void *user;
    member *members[SF_CREW_MAX];
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
    pthread_mutex_lock(&self->crew->mutex);
    self->asleep = 1;
    while (!waits(self)) pthread_cond_wait(&self->start, &self->crew->mutex);
    self->asleep = 0;
    pthread_mutex_unlock(&self->crew->mutex);
}

/* While a share is taken and not done the caller does not return, and work and user stay. */
static void *serve(void *argument) {
    member *self = argument;
    sf_crew *crew = self->crew;
    for (;;) {
        wait_for_ticket(self);
        if (!take(self)) continue;
        if (crew->ending) return NULL;
        crew->work(crew->user, self->number);
        if (sf_atomic_subtract(&crew->working, 1) != 1) continue;
        pthread_mutex_lock(&crew->mutex);
        if (crew->caller_sleeps) pthread_cond_signal(&crew->finish);
        pthread_mutex_unlock(&crew->mutex);
    }
}

static int join_member(sf_crew *crew) {
    member *fresh = calloc(1, sizeof *fresh);
    if (!fresh) return 0;
    fresh->crew = crew;
    fresh->number = crew->count;
    fresh->avoided = -1;
    sf_atomic_store(&fresh->ticket, 1);
    pthread_cond_init(&fresh->start, NULL);
    if (pthread_create(&fresh->thread, NULL, serve, fresh) != 0) {
        pthread_cond_destroy(&fresh->start);
        free(fresh);
        return 0;
    }
    crew->members[crew->count++] = fresh;
    return 1;
}

static void give_tickets(sf_crew *crew, unsigned count, int wakes) {
    int here = sf_processor_now();
    sf_atomic_store(&crew->working, count);
    for (unsigned i = 0; i < count; ++i) {
        member *m = crew->members[i];
        if (m->avoided != here && sf_thread_avoid(m->thread, here)) m->avoided = here;
        sf_atomic_store(&m->ticket, sf_atomic_load(&m->ticket) + 1);
        pthread_mutex_lock(&crew->mutex);
        if (m->asleep && wakes) pthread_cond_signal(&m->start);
        pthread_mutex_unlock(&crew->mutex);
    }
}

static void wait_for_all(sf_crew *crew) {
    unsigned looks = 0;
    double end = 0;
    while (sf_atomic_load(&crew->working))
        if (!look_on(&looks, &end)) break;
    if (!sf_atomic_load(&crew->working)) return;
    pthread_mutex_lock(&crew->mutex);
    crew->caller_sleeps = 1;
    while (sf_atomic_load(&crew->working)) pthread_cond_wait(&crew->finish, &crew->mutex);
    crew->caller_sleeps = 0;
    pthread_mutex_unlock(&crew->mutex);
}

static int comes_soon(sf_crew *crew) {
    double before = crew->last_run;
    crew->last_run = sf_seconds_now();
    return crew->last_run - before < SOON_SECONDS;
}

int sf_crew_run(sf_crew *crew, unsigned shares, int is_long, sf_crew_work_fn work, void *user) {
    if (pthread_mutex_trylock(&crew->busy) != 0) return 0;
    unsigned helped = shares - 1 < SF_CREW_MAX ? shares - 1 : SF_CREW_MAX;
    while (crew->count < helped && join_member(crew)) continue;
    if (helped > crew->count) helped = crew->count;
    crew->work = work;
    crew->user = user;
    give_tickets(crew, helped, comes_soon(crew) || is_long);
    for (unsigned share = shares; share-- > 0;) {
        if (share < helped && !take(crew->members[share])) continue;
        work(user, share);
        if (share < helped) sf_atomic_subtract(&crew->working, 1);
    }
    wait_for_all(crew);
    pthread_mutex_unlock(&crew->busy);
    return 1;
}

sf_status sf_crew_create(sf_crew **out, sf_error *error) {
    sf_crew *crew = *out = calloc(1, sizeof *crew);
    if (!crew) return sf_fail_memory(error, "a crew", sizeof *crew);
    pthread_mutex_init(&crew->busy, NULL);
    pthread_mutex_init(&crew->mutex, NULL);
    pthread_cond_init(&crew->finish, NULL);
    return SF_STATUS_OK;
}

void sf_crew_destroy(sf_crew *crew) {
    if (!crew) return;
    crew->ending = 1;
    give_tickets(crew, crew->count, 1);
    for (unsigned i = 0; i < crew->count; ++i) {
        pthread_join(crew->members[i]->thread, NULL);
        pthread_cond_destroy(&crew->members[i]->start);
        free(crew->members[i]);
    }
    pthread_cond_destroy(&crew->finish);
    pthread_mutex_destroy(&crew->busy);
    pthread_mutex_destroy(&crew->mutex);
    free(crew);
}
