/* SPDX-License-Identifier: BSD-3-Clause
 * Built OpenCL programs on disk: one file a program, whose name is a hash of its key. A file that is cut, changed, of another key or
 * another user's counts as none. */
#ifndef STRATUS_PROGRAM_CACHE_H
#define STRATUS_PROGRAM_CACHE_H

#include "device.h"

/* Text that names all that a built program depends on. */
#define STRATUS_PROGRAM_KEY 2048

/* Finds the folder of built programs for a context's options: `folder` itself, NULL: `programs` in the cache's folder. "" in *path: there
 * is none, and nothing is read or written. A folder whose path is too long gives STRATUS_INVALID_ARGUMENT. */
stratus_status stratus_program_folder(stratus_context* context, const char* folder, char* path);

/* Whether the device's OpenCL keeps programs of its own. PoCL does, and it would compile each kernel once more to give its binary. */
bool stratus_programs_are_kept(cl_device_id id);

/* Write the key of a program: platform, device, vendor, driver and their versions, the processor's features if the device is one, build
 * options, and the source by length and hash. Returns false if OpenCL does not report them; then the program is not cached. */
bool stratus_program_key(cl_device_id id, const char* text, const char* options, char key[STRATUS_PROGRAM_KEY]);

/* Gives a copy of the binary that is stored for the key, NULL where there is none. The caller releases it. Fails only where memory does. */
stratus_status stratus_program_read(stratus_context* context, const char* key, void** binary, size_t* size);

/* Stores a binary. Programs that nobody has used for longest go once the folder holds more than the limit. */
void stratus_program_write(const stratus_context* context, const char* key, const void* binary, size_t size);

/* Bytes that a folder holds at most. Tests lower them. */
#define STRATUS_PROGRAMS_MOST ((size_t)128 << 20)
void stratus_program_limit(size_t bytes);

#endif
