/* SPDX-License-Identifier: BSD-3-Clause
 * The picture that a kernel draws: its sides, and which arrays the caller wants in addition to rgba. The same bytes on host and device. */
#ifndef STRATUS_PICTURE_ARGUMENTS_H
#define STRATUS_PICTURE_ARGUMENTS_H

typedef struct stratus_picture_arguments {
  int width, height;
  int want_depth, want_samples, want_bytes;
} stratus_picture_arguments;

#endif
