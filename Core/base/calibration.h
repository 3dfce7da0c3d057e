/* SPDX-License-Identifier: BSD-3-Clause
 * Costs of operations on this machine. A process measures them when it first needs them, keeps them, and stores them in a file for later
 * processes. */
#ifndef STRATUS_CALIBRATION_H
#define STRATUS_CALIBRATION_H

#include "base.h"

/* Numbers of a calibration, characters of its name with the final zero, and processes that measure it. */
#define STRATUS_CALIBRATION_NUMBERS 8
#define STRATUS_CALIBRATION_NAME 384
#define STRATUS_CALIBRATION_PROCESSES 3

/* Costs that were measured. Numbers are times, or counts that no process has otherwise: of several processes' the least of each is kept,
 * because interruptions only add. */
typedef struct stratus_calibration {
  char name[STRATUS_CALIBRATION_NAME]; /* the quantity measured, and the part of the machine */
  int processes;                       /* how many have measured it; 0: none */
  int count;
  double numbers[STRATUS_CALIBRATION_NUMBERS];
} stratus_calibration;

/* Return a calibration of `count` numbers that are not measured yet. kind: the quantity; part: the part of the machine. Characters that the
 * file cannot contain are replaced. */
stratus_calibration stratus_calibration_of(const char* kind, const char* part, int count);
/* Return a calibration of the host as the context uses it: its processor, instruction set and number of threads. */
stratus_calibration stratus_calibration_of_host(const stratus_context* context, const char* kind, int count);

/* Measures the numbers. It must not use a calibration itself. */
typedef stratus_status stratus_calibration_measure(stratus_context* context, void* job, double* numbers);

/* Fill in the calibration's numbers. They are this process's numbers if it has them, otherwise the file's if three processes have measured
 * them. Otherwise they are measured; the least of these and of the file's are used, and written to the file. One thread at a time does so.
 * Of more than 16 calibrations the process forgets the ones before the last. A file that cannot be read or written is not a failure. */
stratus_status stratus_calibrate(
  stratus_context* context, stratus_calibration* calibration, stratus_calibration_measure* measure, void* job);

/* The file, which no other function touches. Its folder is the environment's STRATUS_CACHE_DIR (empty: there is no file), else
 * $XDG_CACHE_HOME/stratus, else $HOME/.cache/stratus. Its name has the library's version.
 *
 * _read: fills in processes and numbers, if the file has them for this name and count. _add: adds what one process has measured,
 * replaces it by the least of it and of the file's, and writes that. */
void stratus_calibration_read(stratus_calibration* calibration);
void stratus_calibration_add(stratus_calibration* calibration);

/* For tests: makes the process forget what it keeps. */
void stratus_calibration_forget(void);

#endif
