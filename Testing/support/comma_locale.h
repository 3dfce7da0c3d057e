/* SPDX-License-Identifier: BSD-3-Clause
 * A locale that writes 1.5 as 1,5, made for the test where the machine has none. The includer defines _XOPEN_SOURCE 700 first. */
#ifndef STRATUS_TESTING_COMMA_LOCALE_H
#define STRATUS_TESTING_COMMA_LOCALE_H

#include <locale.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char comma_folder[64];

static inline bool comma_locale_holds(void)
{
  char text[16];
  snprintf(text, sizeof text, "%.1f", 1.5);
  return strcmp(text, "1,5") == 0;
}

/* Sets a locale of decimal commas for the process. Returns false if there is none and localedef cannot make one. */
static inline bool comma_locale_begin(void)
{
  char command[256];
  strcpy(comma_folder, "/tmp/stratus-locale-XXXXXX");
  if (!mkdtemp(comma_folder)) {
    *comma_folder = '\0';
    return false;
  }
  snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 >/dev/null 2>&1", comma_folder);
  if (system(command) == 0) {
    setenv("LOCPATH", comma_folder, 1);
  }
  return setlocale(LC_ALL, "de_DE.UTF-8") && comma_locale_holds();
}

static inline void comma_locale_end(void)
{
  char command[128];
  setlocale(LC_ALL, "C");
  unsetenv("LOCPATH");
  if (*comma_folder) {
    snprintf(command, sizeof command, "rm -rf %s", comma_folder);
    if (system(command) != 0) {
      printf("%s stays behind\n", comma_folder);
    }
  }
}

#endif
