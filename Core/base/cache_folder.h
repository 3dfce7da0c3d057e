/* SPDX-License-Identifier: BSD-3-Clause
 * The folder in which the library keeps what later processes can use: measured costs and built OpenCL programs. No failure here is an
 * error: without the folder, costs are measured and programs are built. */
#ifndef STRATUS_CACHE_FOLDER_H
#define STRATUS_CACHE_FOLDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Characters of a path with its final zero. */
#define STRATUS_CACHE_PATH 1024

/* Writes the folder's path: the environment's STRATUS_CACHE_DIR, else $XDG_CACHE_HOME/stratus, else $HOME/.cache/stratus. Returns false
 * if there is no place for it, as where STRATUS_CACHE_DIR is empty. */
bool stratus_cache_find(char path[STRATUS_CACHE_PATH]);

/* Opens a file for reading if it is a regular one of this user's that nobody else can write. Returns its handle and sets *size to its
 * bytes, or returns -1. */
int stratus_cache_open(const char* path, uint64_t* size);
/* Reads the next `size` bytes. Returns false if there are fewer. */
bool stratus_cache_read(int handle, void* to, size_t size);

/* A part of a file's bytes. */
typedef struct stratus_cache_part {
  const void* bytes;
  size_t size;
} stratus_cache_part;

/* Writes `parts` to the file folder/name: to a temporary file in the folder, which is then renamed, so that readers see the old file or the
 * new one. Makes the folder, and up to two above it. Returns false if it could not; then nothing is left. */
bool stratus_cache_write(const char* folder, const char* name, const stratus_cache_part* parts, int count);

#endif
