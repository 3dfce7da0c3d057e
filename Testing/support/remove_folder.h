/* SPDX-License-Identifier: BSD-3-Clause
 * Removes a folder that a test has made, with all that is in it. The includer defines _XOPEN_SOURCE 700 first. */
#ifndef STRATUS_TESTING_REMOVE_FOLDER_H
#define STRATUS_TESTING_REMOVE_FOLDER_H

#include <ftw.h>
#include <stdio.h>

static inline int remove_folder_entry(const char* path, const struct stat* status, int type, struct FTW* walk)
{
  (void)status;
  (void)type;
  (void)walk;
  return remove(path);
}

/* Returns 0, or another number where something stays. Links are removed, not followed. */
static inline int remove_folder(const char* path)
{
  return nftw(path, remove_folder_entry, 8, FTW_DEPTH | FTW_PHYS);
}

#endif
