/* SPDX-License-Identifier: BSD-3-Clause
 * The picture that a kernel draws: its sides, and which arrays the caller wants in addition to rgba; and its rays. The same bytes on host
 * and device. */
#ifndef STRATUS_PICTURE_ARGUMENTS_H
#define STRATUS_PICTURE_ARGUMENTS_H

/* The most pieces that crop regions leave of a ray. Six planes cut it into at most seven parts, and neighbouring parts that are shown are
 * one piece. */
#define CROP_PIECES 4

typedef struct stratus_picture_arguments {
  int width, height;
  int want_depth, want_samples, want_bytes;
} stratus_picture_arguments;

#endif
