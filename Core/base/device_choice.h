/* SPDX-License-Identifier: BSD-3-Clause
 * Where a context draws. The choice of "auto" between the host and OpenCL devices follows from the time that each takes for the same
 * picture. */
#ifndef STRATUS_DEVICE_CHOICE_H
#define STRATUS_DEVICE_CHOICE_H

#include "device.h"

/* Give a context without a device the device that the selector names (see stratus_context_options::device), and its name. Nothing is
 * measured for a selector other than "auto", or if "auto" has no candidate. A candidate that fails is left out, and the log says so.
 * processors: see stratus_device_candidates(); only tests let "auto" use CPUs, whose cores are the host's. */
stratus_status stratus_device_choose(stratus_context* context, const char* selector, bool processors);

/* Returns the index of the device that takes the least time, or -1 if that is not less than the host's. A device whose time is INFINITY is
 * never taken. */
int stratus_device_fastest(double host_ms, const double* device_ms, int count);

/* Kinds of calibrations: of the host, of a device. Both have one number, milliseconds. */
#define STRATUS_CALIBRATION_HOST "picture by the host"
#define STRATUS_CALIBRATION_DEVICE "picture by a device"

#endif
