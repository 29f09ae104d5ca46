// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A file written beside the one whose place it takes, so that whoever reads, and whatever stops the
 * writing, finds the old file or the new one, whole. POSIX. */
#ifndef SUNFLECK_ATOMIC_FILE_H
#define SUNFLECK_ATOMIC_FILE_H

#include "sunfleck/base.h"

typedef struct sf_atomic_file {
    char *target; /* symbolic links followed: a rename would replace the link */
    char *beside; /* target with ".part" behind it: what a kill leaves, the next writing overwrites */
    int file;
} sf_atomic_file;

/* Opens the file beside, empty, for this process alone: another that is writing the same one is an
 * error. Every failure is SF_STATUS_IO with the system's reason, or SF_STATUS_OUT_OF_MEMORY; the
 * file is then closed and nothing is left behind. */
sf_status sf_atomic_file_open(sf_atomic_file *atomic_file, const char *path, sf_error *error);

/* The same beside a name that nobody else has: any number of writers may be at work, and the last to commit wins. A
 * kill leaves the file beside. */
sf_status sf_atomic_file_open_unique(sf_atomic_file *atomic_file, const char *path, sf_error *error);

/* Appends. After a failure call sf_atomic_file_abandon. */
sf_status sf_atomic_file_write(sf_atomic_file *atomic_file, const void *bytes, size_t count, sf_error *error);

/* Brings the bytes to the disk, renames, and brings the folder's entry to the disk, in this order;
 * closes. A failure leaves the old file. */
sf_status sf_atomic_file_commit(sf_atomic_file *atomic_file, sf_error *error);

/* Removes what was written, and closes. */
void sf_atomic_file_abandon(sf_atomic_file *atomic_file);

#endif
