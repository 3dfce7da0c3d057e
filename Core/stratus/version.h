/* SPDX-License-Identifier: BSD-3-Clause
 * The version of the headers and of the library. CMake reads it from here, so that it has one source. */
#ifndef STRATUS_PUBLIC_VERSION_H
#define STRATUS_PUBLIC_VERSION_H

#ifdef __cplusplus
extern "C" {
#endif

#define STRATUS_VERSION_MAJOR 0
#define STRATUS_VERSION_MINOR 1
#define STRATUS_VERSION_PATCH 0

#if defined(_WIN32)
#if defined(STRATUS_BUILDING)
#define STRATUS_API __declspec(dllexport)
#else
#define STRATUS_API
#endif
#else
#define STRATUS_API __attribute__((visibility("default")))
#endif

/* STRATUS_API marks a stable function: it changes with a minor version at the earliest, and CHANGELOG.md says how. STRATUS_EXPERIMENTAL
 * marks a function for studying a method: any minor version may change or remove it. */
#define STRATUS_EXPERIMENTAL STRATUS_API

/* Return the version of the library that runs, as "major.minor.patch". The macros give the version of the headers that the caller was
 * compiled with. */
STRATUS_API const char* stratus_version(void);

#ifdef __cplusplus
}
#endif

#endif
