/* SPDX-License-Identifier: BSD-3-Clause
 * What PoCL's processor is called: "pthread-..." until PoCL 4, "cpu-..." since. */
#ifndef STRATUS_TESTING_POCL_H
#define STRATUS_TESTING_POCL_H

#include "stratus.h"

#include <string.h>

/* Returns the part of the name that is there, for stratus_context_options.device. */
static inline const char* pocl_name(void)
{
  char name[192];
  for (int i = 0; i < stratus_device_count(); ++i) {
    if (stratus_device_name(i, name, sizeof name) == STRATUS_OK && strstr(name, "cpu-")) {
      return "cpu-";
    }
  }
  return "pthread";
}

#endif
