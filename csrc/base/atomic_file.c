// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Writes files beside the ones that they replace, and renames them when they are whole. */
#include "base/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <libgen.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

#define SUFFIX ".part"
#define WRITE_LIMIT ((size_t)1 << 30) /* Linux writes at most 2^31 - 4096 bytes at a time */

static sf_status fail_io(const char *what, const char *path, sf_error *error) {
    return sf_fail(error, SF_STATUS_IO, "can't %s '%s': %s", what, path, sf_system_message(errno));
}

static void close_all(sf_atomic_file *r) {
    if (r->file >= 0) close(r->file);
    free(r->target);
    free(r->beside);
    *r = (sf_atomic_file){.file = -1};
}

/* 1: the file beside is open and ours. 0: somebody renamed it between open and lock; try again.
 * -1: errno says why not. The lock ends with the process, however that ends. */
static int open_and_lock(sf_atomic_file *r) {
    struct stat opened, named;
    r->file = open(r->beside, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (r->file < 0) return -1;
    if (flock(r->file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        errno = EBUSY; /* "device or resource busy": another process is writing it */
        return -1;
    } /* a file system without locks goes without */
    if (fstat(r->file, &opened) != 0) return -1;
    if (stat(r->beside, &named) == 0 && named.st_ino == opened.st_ino && named.st_dev == opened.st_dev)
        return ftruncate(r->file, 0) == 0 ? 1 : -1;
    close(r->file);
    r->file = -1;
    return 0;
}

/* The file that a path stands for, through symbolic links, also those to a file that there is not yet; NULL where
 * there is no memory, or for links in a circle, with errno. */
static char *follow(const char *path) {
    char *found = realpath(path, NULL), link[4096];
    if (found || errno != ENOENT) return found;
    ssize_t length = readlink(path, link, sizeof link - 1);
    if (length < 0) return strdup(path); /* there is none yet, and no link */
    link[length] = 0;
    const char *slash = link[0] == '/' ? NULL : strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0;
    char *next = malloc(folder + (size_t)length + 1);
    if (!next) return NULL;
    memcpy(next, path, folder);
    memcpy(next + folder, link, (size_t)length + 1);
    found = follow(next); /* realpath has refused links in a circle by now */
    free(next);
    return found;
}

/* The mode of the file that is to be replaced, which the new one keeps. */
static void keep_mode(const sf_atomic_file *r) {
    struct stat old;
    if (stat(r->target, &old) == 0) (void)fchmod(r->file, old.st_mode & 07777);
}

/* Finds the target, and has room beside it for a name of `extra` more bytes than the target's. */
static sf_status begin(sf_atomic_file *r, const char *path, size_t extra, sf_error *error) {
    *r = (sf_atomic_file){.file = -1};
    errno = ENOMEM;
    r->target = follow(path);
    if (!r->target && errno != ENOMEM) return fail_io("write", path, error);
    if (r->target) r->beside = malloc(strlen(r->target) + extra);
    if (r->beside) return SF_STATUS_OK;
    close_all(r);
    return sf_fail_memory(error, "a path", strlen(path));
}

/* What both ways of opening end with; where they failed, errno says why. */
static sf_status finish(sf_atomic_file *r, bool opened, const char *path, sf_error *error) {
    if (opened) {
        keep_mode(r);
        return SF_STATUS_OK;
    }
    sf_status status = fail_io("write", path, error);
    close_all(r);
    return status;
}

sf_status sf_atomic_file_open(sf_atomic_file *r, const char *path, sf_error *error) {
    sf_status status = begin(r, path, sizeof SUFFIX, error);
    if (status) return status;
    strcpy(r->beside, r->target);
    strcat(r->beside, SUFFIX);
    int opened = 0;
    while (opened == 0) opened = open_and_lock(r);
    return finish(r, opened > 0, path, error);
}

sf_status sf_atomic_file_open_unique(sf_atomic_file *r, const char *path, sf_error *error) {
    const size_t extra = sizeof ".sunfleck-0123456789abcdef";
    sf_status status = begin(r, path, extra, error);
    if (status) return status;
    const char *slash = strrchr(r->target, '/');
    int folder = slash ? (int)(slash - r->target) + 1 : 0;
    uint64_t key = sf_hash64((uint64_t)(1e9 * sf_seconds_now()), (uint64_t)getpid());
    do {
        snprintf(r->beside, strlen(r->target) + extra, "%.*s.sunfleck-%016" PRIx64, folder, r->target, key);
        r->file = open(r->beside, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        key = sf_mix64(key + 1);
    } while (r->file < 0 && errno == EEXIST);
    return finish(r, r->file >= 0, path, error);
}

sf_status sf_atomic_file_write(sf_atomic_file *r, const void *bytes, size_t count, sf_error *error) {
    const char *next = bytes;
    while (count > 0) {
        ssize_t written = write(r->file, next, count < WRITE_LIMIT ? count : WRITE_LIMIT);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return fail_io("write", r->beside, error);
        next += written;
        count -= (size_t)written;
    }
    return SF_STATUS_OK;
}

static int sync_file(int file) {
    int result;
    do result = fsync(file);
    while (result != 0 && errno == EINTR);
    return result;
}

/* Brings the folder's entry to the disk. The new file is in place by now, and some file systems
 * know no such call, so that its failure is no failure. */
static void sync_folder(char *path) {
    int folder = open(dirname(path), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;
    (void)sync_file(folder);
    close(folder);
}

sf_status sf_atomic_file_commit(sf_atomic_file *r, sf_error *error) {
    if (sync_file(r->file) != 0 || rename(r->beside, r->target) != 0) {
        sf_status status = fail_io("write", r->target, error);
        sf_atomic_file_abandon(r);
        return status;
    }
    sync_folder(r->target);
    close_all(r);
    return SF_STATUS_OK;
}

void sf_atomic_file_abandon(sf_atomic_file *r) {
    if (r->beside && r->file >= 0) unlink(r->beside);
    close_all(r);
}
