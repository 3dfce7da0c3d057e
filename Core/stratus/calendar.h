/* SPDX-License-Identifier: BSD-3-Clause
 * Moments as text, and the times of files by the CF conventions: a number in a unit such as "hours since 2001-01-01", and a calendar. */
#ifndef STRATUS_PUBLIC_CALENDAR_H
#define STRATUS_PUBLIC_CALENDAR_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Size of a text that stratus_time_write() makes, with its end. */
#define STRATUS_TIME_TEXT 32

/* Read a moment: "2024-06-01", "2024-06-01 09:00", "2024-06-01T09:00:30.5Z", "2024-06-01_09:00:00", "2024-06-01 09:00 +02:00". Without a
 * zone it is in UTC. Seconds are counted from 1970-01-01 00:00 UTC in days of 86400 s, by the Gregorian calendar. Years 1 to 9999. */
STRATUS_API stratus_status stratus_time_parse(stratus_context* context, const char* text, double* seconds);

/* Return the seconds of a unit of time: ms, s, min, h, d or week, or its English name or plural. Only the first word counts, as in "hours
 * since 2001-01-01". Returns 0 for other texts and NULL. Months and years are no units, because their lengths differ. */
STRATUS_API double stratus_time_unit(const char* units);

/* Write the moment of a file's time: "2001-01-01 03:00", or with seconds, "2001-01-01 03:00:30", where they are not 0. Times within
 * half a step of 32-bit floats of a whole minute are that minute, and all others are rounded to seconds.
 * - units: a unit of stratus_time_unit(), "since" and a moment of the calendar, years 1 to 9999
 * - calendar: standard or gregorian (Julian before 1582-10-15), proleptic_gregorian, julian, noleap or 365_day, all_leap or 366_day, or
 *   360_day; NULL or "": standard
 * Fails for other units and calendars, and for moments outside the years 1 to 9999. */
STRATUS_API stratus_status stratus_time_write(
  stratus_context* context, double value, const char* units, const char* calendar, char text[STRATUS_TIME_TEXT]);

/* Find the value of a moment, as stratus_time_parse() reads it but by the file's calendar, in the file's units: the reverse of
 * stratus_time_write(). */
STRATUS_API stratus_status stratus_time_value(
  stratus_context* context, const char* moment, const char* units, const char* calendar, double* value);

#ifdef __cplusplus
}
#endif

#endif
