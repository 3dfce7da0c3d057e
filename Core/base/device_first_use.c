/* SPDX-License-Identifier: BSD-3-Clause
 * The lock around what an OpenCL driver does on first use. */
#include "device_state.h"

#include <pthread.h>

/* Serialises what a driver does on first use: finding devices, making a context and its threads, and building a program, for which it loads
 * its compiler. OpenCL lets several threads do so at once. But a thread that asks PoCL (3.1) for devices while it finds them gets none, or
 * crashes, and of some thousand processes whose first eight contexts began at once, one hung in Intel's runtime (2026.2). Contexts draw at
 * the same time. */
static pthread_mutex_t first_uses = PTHREAD_MUTEX_INITIALIZER;

void stratus_device_enter(void)
{
  pthread_mutex_lock(&first_uses);
}

void stratus_device_leave(void)
{
  pthread_mutex_unlock(&first_uses);
}
