// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A crew: threads that outlive the work they are given. Waking a thread that sleeps takes as long as
 * filling a first cache some ten times, and starting one longer still; so whoever waits looks for
 * a while before it sleeps. */
#include "crew.h"

#include "error.h"
#include "platform.h"

#define LOOK_SECONDS 50e-6 /* about the time to sleep and wake twice */

typedef struct member {
    sf_crew *crew;
    unsigned number;
    size_t begun;        /* turns that it has taken */
    sf_atomic_size turn; /* counts up as one begins */
    int asleep;
    pthread_cond_t start;
    pthread_t thread;
} member;

struct sf_crew {
    pthread_mutex_t busy;  /* held while someone's work runs */
    pthread_mutex_t mutex; /* of who is asleep */
    pthread_cond_t finish;
    sf_atomic_size working; /* members that have not finished the turn */
    unsigned count;
    int caller_sleeps, ending;
    sf_crew_work_fn work;
    void *user;
    member *members[SF_CREW_MAX];
};

/* Looks until the counter differs from (or, with `until`, is) `value`; 0 when time is up. */
static int look(const sf_atomic_size *counter, size_t value, int until) {
    double end = 0;
    for (unsigned i = 0;; ++i) {
        if ((sf_atomic_load(counter) == value) == until) return 1;
        sf_pause();
        if (i % 64) continue;
        double now = sf_seconds_now();
        if (end == 0) end = now + LOOK_SECONDS;
        if (now > end) return 0;
    }
}

static int wait_for_turn(member *self) {
    sf_crew *crew = self->crew;
    if (!look(&self->turn, self->begun, 0)) {
        pthread_mutex_lock(&crew->mutex);
        self->asleep = 1;
        while (sf_atomic_load(&self->turn) == self->begun) pthread_cond_wait(&self->start, &crew->mutex);
        self->asleep = 0;
        pthread_mutex_unlock(&crew->mutex);
    }
    ++self->begun;
    return !crew->ending;
}

static void *serve(void *argument) {
    member *self = argument;
    sf_crew *crew = self->crew;
    while (wait_for_turn(self)) {
        crew->work(crew->user, self->number);
        if (sf_atomic_subtract(&crew->working, 1) != 1) continue;
        pthread_mutex_lock(&crew->mutex);
        if (crew->caller_sleeps) pthread_cond_signal(&crew->finish);
        pthread_mutex_unlock(&crew->mutex);
    }
    return NULL;
}

static int join_member(sf_crew *crew) {
    member *fresh = calloc(1, sizeof *fresh);
    if (!fresh) return 0;
    fresh->crew = crew;
    fresh->number = crew->count;
    pthread_cond_init(&fresh->start, NULL);
    if (pthread_create(&fresh->thread, NULL, serve, fresh) != 0) {
        pthread_cond_destroy(&fresh->start);
        free(fresh);
        return 0;
    }
    crew->members[crew->count++] = fresh;
    return 1;
}

static void begin_turn(sf_crew *crew, unsigned count) {
    sf_atomic_store(&crew->working, count);
    for (unsigned i = 0; i < count; ++i) {
        member *m = crew->members[i];
        pthread_mutex_lock(&crew->mutex);
        sf_atomic_store(&m->turn, m->turn.value + 1);
        if (m->asleep) pthread_cond_signal(&m->start);
        pthread_mutex_unlock(&crew->mutex);
    }
}

static void wait_for_all(sf_crew *crew) {
    if (look(&crew->working, 0, 1)) return;
    pthread_mutex_lock(&crew->mutex);
    crew->caller_sleeps = 1;
    while (sf_atomic_load(&crew->working)) pthread_cond_wait(&crew->finish, &crew->mutex);
    crew->caller_sleeps = 0;
    pthread_mutex_unlock(&crew->mutex);
}

int sf_crew_run(sf_crew *crew, unsigned shares, sf_crew_work_fn work, void *user) {
    if (pthread_mutex_trylock(&crew->busy) != 0) return 0;
    unsigned helped = shares - 1 < SF_CREW_MAX ? shares - 1 : SF_CREW_MAX;
    while (crew->count < helped && join_member(crew)) continue;
    if (helped > crew->count) helped = crew->count;
    crew->work = work;
    crew->user = user;
    begin_turn(crew, helped);
    for (unsigned share = helped; share < shares; ++share) work(user, share);
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
    begin_turn(crew, crew->count);
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
