// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Writes and reads files of named arrays, and checks their checksum and their layout on the way in. */
#include "base/container.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/platform.h"

#define MAGIC_BYTES "\x89SFCK\r\n\x1a" /* as PNG's: a transfer as text changes it */
#define MAGIC_SIZE 8
#define HEADER_SIZE 24
#define ENTRY_SIZE 64
#define NAME_SIZE 40
#define CHECKSUM_SIZE 8
#define BUFFER_SIZE 65536 /* a multiple of 8 */
#define MAX_ARRAYS 4096u

static size_t value_size(uint32_t type) {
    static const size_t sizes[] = {1, 1, 4, 8, 4, 8};
    return type <= SF_ARRAY_F64 ? sizes[type] : 0;
}

static uint64_t round_up8(uint64_t x) { return (x + 7) / 8 * 8; }

static bool is_little_endian(void) {
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1;
}

/* Copies values of `size` bytes between the machine's order and the file's. */
static void copy_values(unsigned char *to, const unsigned char *from, size_t count, size_t size) {
    if (size == 1 || is_little_endian()) {
        memcpy(to, from, count * size);
        return;
    }
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < size; ++k) to[i * size + k] = from[i * size + size - 1 - k];
}

static uint64_t load64(const unsigned char *bytes) {
    uint64_t value;
    copy_values((unsigned char *)&value, bytes, 1, 8);
    return value;
}
static uint32_t load32(const unsigned char *bytes) {
    uint32_t value;
    copy_values((unsigned char *)&value, bytes, 1, 4);
    return value;
}

/* Continues a checksum over `count` bytes, a multiple of 8. Each step is a bijection of the hash for
 * a given word, and of the word for a given hash: files that differ within one word of 8 bytes never
 * have the same checksum, others with probability 2^-64. */
static uint64_t checksum(uint64_t hash, const unsigned char *bytes, size_t count) {
    for (size_t i = 0; i < count; i += 8) hash = sf_mix64(hash ^ load64(bytes + i)) + UINT64_C(0x9e3779b97f4a7c15);
    return hash;
}

/* ---- writing ---- */

typedef struct writer {
    sf_atomic_file file;
    uint64_t hash;
    size_t used;
    unsigned char *buffer;
    sf_status status; /* of the first write that failed; nothing is written after it */
    sf_error *error;
} writer;

static void flush(writer *w) {
    w->hash = checksum(w->hash, w->buffer, w->used);
    if (!w->status) w->status = sf_atomic_file_write(&w->file, w->buffer, w->used, w->error);
    w->used = 0;
}

/* Appends values of `size` bytes in the file's order. */
static void put(writer *w, const void *values, size_t count, size_t size) {
    const unsigned char *from = values;
    while (count > 0) {
        size_t room = (BUFFER_SIZE - w->used) / size, now = count < room ? count : room;
        copy_values(w->buffer + w->used, from, now, size);
        w->used += now * size;
        from += now * size;
        count -= now;
        if (w->used == BUFFER_SIZE) flush(w); /* never between: values start at multiples of their size */
    }
}
static void put32(writer *w, uint32_t value) { put(w, &value, 1, 4); }
static void put64(writer *w, uint64_t value) { put(w, &value, 1, 8); }
static void pad(writer *w) {
    while (w->used % 8) put(w, "", 1, 1);
}

static uint64_t array_bytes(const sf_array *array) {
    return array->rows * array->width * value_size((uint32_t)array->type);
}

static void put_entries(writer *w, const sf_array *arrays, size_t count) {
    uint64_t offset = HEADER_SIZE + count * ENTRY_SIZE, size = offset + CHECKSUM_SIZE;
    for (size_t i = 0; i < count; ++i) size += round_up8(array_bytes(arrays + i));
    put(w, MAGIC_BYTES, MAGIC_SIZE, 1);
    put32(w, SF_CONTAINER_VERSION);
    put32(w, (uint32_t)count);
    put64(w, size);
    for (size_t i = 0; i < count; ++i) {
        char name[NAME_SIZE] = {0};
        strncpy(name, arrays[i].name, NAME_SIZE - 1);
        put(w, name, NAME_SIZE, 1);
        put32(w, (uint32_t)arrays[i].type);
        put32(w, arrays[i].width);
        put64(w, arrays[i].rows);
        put64(w, offset);
        offset += round_up8(array_bytes(arrays + i));
    }
}

static void put_array(writer *w, const sf_array *array) {
    size_t size = value_size((uint32_t)array->type);
    const char *row = array->data;
    if (array->stride == array->width * size)
        put(w, row, (size_t)array->rows * array->width, size);
    else
        for (uint64_t i = 0; i < array->rows && !w->status; ++i, row += array->stride) put(w, row, array->width, size);
    pad(w);
}

sf_status sf_container_write(const char *path, const sf_array *arrays, size_t count, sf_error *error) {
    writer w = {.error = error, .buffer = malloc(BUFFER_SIZE)};
    if (!w.buffer) return sf_fail_memory(error, "a file's buffer", BUFFER_SIZE);
    w.status = sf_atomic_file_open(&w.file, path, error);
    if (!w.status) {
        put_entries(&w, arrays, count);
        for (size_t i = 0; i < count; ++i) put_array(&w, arrays + i);
        flush(&w);
        put64(&w, w.hash);
        flush(&w);
        if (w.status)
            sf_atomic_file_abandon(&w.file);
        else
            w.status = sf_atomic_file_commit(&w.file, error);
    }
    free(w.buffer);
    return w.status;
}

/* ---- reading ---- */

static sf_status read_failed(const char *path, sf_error *error) {
    return sf_fail(error, SF_STATUS_IO, "can't read '%s': %s", path, sf_system_message(errno));
}

/* Only a regular file is opened: a pipe would wait for its writer. */
static sf_status read_whole(sf_container *c, sf_error *error) {
    struct stat about;
    if (stat(c->path, &about) != 0) return read_failed(c->path, error);
    if (!S_ISREG(about.st_mode)) return sf_fail(error, SF_STATUS_IO, "can't read '%s': it is not a file", c->path);
    FILE *file = fopen(c->path, "rb");
    if (!file) return read_failed(c->path, error);
    c->size = (uint64_t)about.st_size;
    c->bytes = malloc(c->size ? (size_t)c->size : 1);
    bool whole = c->bytes && fread(c->bytes, 1, (size_t)c->size, file) == c->size;
    sf_status status = !c->bytes ? sf_fail_memory(error, "a checkpoint", (size_t)c->size)
                       : whole   ? SF_STATUS_OK
                                 : read_failed(c->path, error);
    fclose(file);
    return status;
}

static const unsigned char *entry_at(const sf_container *c, uint32_t i) {
    return c->bytes + HEADER_SIZE + (size_t)i * ENTRY_SIZE;
}

/* A right checksum proves that nothing changed, not that the writer was honest: no entry may point
 * outside the file. */
static bool entry_fits(const sf_container *c, const unsigned char *entry) {
    uint32_t type = load32(entry + 40), width = load32(entry + 44);
    uint64_t rows = load64(entry + 48), offset = load64(entry + 56);
    if (type > SF_ARRAY_F64 || width == 0 || entry[NAME_SIZE - 1] != 0) return false;
    uint64_t row = (uint64_t)width * value_size(type), end = c->size - CHECKSUM_SIZE;
    return offset % 8 == 0 && offset <= end && rows <= (end - offset) / row;
}

static sf_status check(sf_container *c, sf_error *error) {
    if (c->size < HEADER_SIZE || memcmp(c->bytes, MAGIC_BYTES, MAGIC_SIZE) != 0)
        return sf_fail(error, SF_STATUS_IO, "'%s' is not a checkpoint", c->path);
    uint32_t version = load32(c->bytes + 8);
    uint64_t size = load64(c->bytes + 16);
    if (version != SF_CONTAINER_VERSION)
        return sf_fail(error, SF_STATUS_IO,
                       "checkpoint '%s' has version %u of the format, and this Sunfleck reads version %u", c->path,
                       version, SF_CONTAINER_VERSION);
    c->count = load32(c->bytes + 12);
    uint64_t least = HEADER_SIZE + (uint64_t)c->count * ENTRY_SIZE + CHECKSUM_SIZE;
    if (c->size < size || c->size < least)
        return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' is cut short: %llu of %llu bytes", c->path,
                       (unsigned long long)c->size, (unsigned long long)(size > least ? size : least));
    bool sound = c->size == size && size % 8 == 0 && c->count <= MAX_ARRAYS &&
                 checksum(0, c->bytes, (size_t)size - CHECKSUM_SIZE) == load64(c->bytes + size - CHECKSUM_SIZE);
    for (uint32_t i = 0; sound && i < c->count; ++i) sound = entry_fits(c, entry_at(c, i));
    if (sound) return SF_STATUS_OK;
    return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' is damaged: its bytes have changed since it was written",
                   c->path);
}

sf_status sf_container_open(sf_container *container, const char *path, sf_error *error) {
    *container = (sf_container){.path = path};
    sf_status status = read_whole(container, error);
    if (!status) status = check(container, error);
    if (status) sf_container_close(container);
    return status;
}

void sf_container_close(sf_container *container) {
    free(container->bytes);
    container->bytes = NULL;
}

static const unsigned char *find_entry(const sf_container *c, const char *name) {
    for (uint32_t i = 0; i < c->count; ++i)
        if (strcmp((const char *)entry_at(c, i), name) == 0) return entry_at(c, i);
    return NULL;
}

bool sf_container_find(const sf_container *c, const char *name, sf_array_type type, uint32_t width, uint64_t *rows) {
    const unsigned char *entry = find_entry(c, name);
    if (!entry || load32(entry + 40) != (uint32_t)type || load32(entry + 44) != width) return false;
    *rows = load64(entry + 48);
    return true;
}

sf_status sf_container_take(const sf_container *c, const sf_array *array, sf_error *error) {
    uint64_t rows;
    if (!sf_container_find(c, array->name, array->type, array->width, &rows) || rows != array->rows)
        return sf_fail(error, SF_STATUS_IO, "checkpoint '%s' has no %s of the expected size", c->path, array->name);
    size_t size = value_size((uint32_t)array->type), row_bytes = array->width * size;
    const unsigned char *from = c->bytes + load64(find_entry(c, array->name) + 56);
    unsigned char *to = array->data;
    for (uint64_t i = 0; i < rows; ++i, from += row_bytes, to += array->stride)
        copy_values(to, from, array->width, size);
    return SF_STATUS_OK;
}
