// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A file of named arrays with a checksum over every byte, little-endian on every machine.
 *
 *     0   8 bytes       89 53 46 43 4b 0d 0a 1a ("\x89SFCK\r\n\x1a")
 *     8   uint32        version of the format: SF_CONTAINER_VERSION
 *     12  uint32        number of arrays, n
 *     16  uint64        size of the file in bytes, a multiple of 8
 *     24  n * 64 bytes  an array each: name (40 bytes, zeros behind it), uint32 type, uint32 width
 *                       (values a row), uint64 rows, uint64 offset in the file, a multiple of 8
 *     …                 the arrays' values, row after row, zeros up to the next multiple of 8
 *     -8  uint64        checksum of all that is before it */
#ifndef SUNFLECK_CONTAINER_H
#define SUNFLECK_CONTAINER_H

#include <stdbool.h>

#include "sunfleck/base.h"

#define SF_CONTAINER_VERSION 3u

typedef enum sf_array_type {
    SF_ARRAY_TEXT = 0,
    SF_ARRAY_U8,
    SF_ARRAY_U32,
    SF_ARRAY_U64,
    SF_ARRAY_F32,
    SF_ARRAY_F64
} sf_array_type;

/* `rows` rows of `width` values in memory, `stride` bytes apart: a column of structs as well as an
 * array. The same description writes an array and reads it back. */
typedef struct sf_array {
    const char *name; /* 1 .. 39 bytes */
    sf_array_type type;
    uint32_t width;
    uint64_t rows;
    void *data;
    size_t stride;
} sf_array;

/* Writes the arrays beside `path`, then renames: see sf_atomic_file. SF_STATUS_IO where that fails;
 * whatever was at `path` is then still there. Takes one pass over the arrays and 64 KiB. */
sf_status sf_container_write(const char *path, const sf_array *arrays, size_t count, sf_error *error);

/* A file that was read whole, and whose checksum is right. */
typedef struct sf_container {
    const char *path; /* the caller's */
    unsigned char *bytes;
    uint64_t size;
    uint32_t count;
} sf_container;

/* Reads a file. SF_STATUS_IO, with a message that says which, where it can't be read, is not such a
 * file, is of a newer version, is cut short, or has bytes that changed. */
sf_status sf_container_open(sf_container *container, const char *path, sf_error *error);
void sf_container_close(sf_container *container);

/* Copies the array of that name to `array->data`; its type, width and rows must be the same. */
sf_status sf_container_take(const sf_container *container, const sf_array *array, sf_error *error);

/* Whether the file has an array of that name, type and width, and how many rows. */
bool sf_container_find(const sf_container *container, const char *name, sf_array_type type, uint32_t width,
                       uint64_t *rows);

#endif
