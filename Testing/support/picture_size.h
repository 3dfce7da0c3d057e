/* SPDX-License-Identifier: BSD-3-Clause
 * Whether the pictures of cases are small: where few_run(), they are half as wide and as high. Each pixel is judged as in a large picture,
 * and they take a quarter of the time. They are still larger than a tile of rays, which is 16 pixels wide. Files for which the size matters
 * define CASE_FULL_SIZE. */
#ifndef STRATUS_TESTING_PICTURE_SIZE_H
#define STRATUS_TESTING_PICTURE_SIZE_H

#include "testing.h"

#ifdef CASE_FULL_SIZE
#define CASE_SMALL 0
#else
#define CASE_SMALL few_run()
#endif

#endif
