/* SPDX-License-Identifier: BSD-3-Clause
 * Calls of libnetcdf that end the program where they fail, for programs that write one file. */
#ifndef NETCDF_WRITING_H
#define NETCDF_WRITING_H

#include <netcdf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline void must(int status)
{
  if (status != NC_NOERR) {
    fprintf(stderr, "netCDF: %s\n", nc_strerror(status));
    exit(1);
  }
}

static inline void text(int file, int variable, const char* name, const char* value)
{
  must(nc_put_att_text(file, variable, name, strlen(value), value));
}

static inline int dimension(int file, const char* name, size_t length)
{
  int id = -1;
  must(nc_def_dim(file, name, length, &id));
  return id;
}

/* A variable with a unit and, unless it is NULL, a long name. */
static inline int variable(
  int file, const char* name, nc_type type, int dimensions, const int* ids, const char* units, const char* long_name)
{
  int id = -1;
  must(nc_def_var(file, name, type, dimensions, ids, &id));
  text(file, id, "units", units);
  if (long_name) {
    text(file, id, "long_name", long_name);
  }
  return id;
}

static inline void* memory(size_t count, size_t size)
{
  void* result = calloc(count, size);
  if (!result) {
    fprintf(stderr, "out of memory\n");
    exit(1);
  }
  return result;
}

#endif
