/* SPDX-License-Identifier: BSD-3-Clause
 * What VTK looks for in the libraries of VTK_AUTOLOAD_PATH. It links nothing of VTK, so that a program with another VTK loads no second
 * one. Where the mappers cannot be had, one line says why, VTK rejects the library for its version, and its own mappers draw. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <stdio.h>
#include <string.h>

#define ENTRY __attribute__((visibility("default")))

static void* (*make_factory)(void);

/* Keeps the name of a loaded library that is VTK's core, of any version. */
static int find_vtk(struct dl_phdr_info* info, size_t size, void* found)
{
  (void)size;
  const char* slash = strrchr(info->dlpi_name, '/');
  const char* name = slash ? slash + 1 : info->dlpi_name;
  if (strncmp(name, "libvtkCommonCore", 16) == 0 || strncmp(name, "libvtkCommon-", 13) == 0) { /* the latter in a VTK of kits */
    snprintf(found, NAME_MAX, "%s", name);
    return strcmp(name, STRATUS_VTK_LIBRARY) == 0; /* the right one ends the search */
  }
  return 0;
}

/* Loads the mappers' library, two folders above this one. */
static int load(void)
{
  Dl_info self;
  char path[PATH_MAX], vtk[NAME_MAX] = "";
  dl_iterate_phdr(find_vtk, vtk);
  if (strcmp(vtk, STRATUS_VTK_LIBRARY) != 0) {
    fprintf(stderr,
      "Stratus: its mappers are for VTK " STRATUS_VTK_VERSION " (" STRATUS_VTK_LIBRARY "), this program has %s; VTK's own draw\n",
      vtk[0] ? vtk : "a VTK in one piece");
    return 0;
  }
  if (!dladdr(&make_factory, &self) || !strrchr(self.dli_fname, '/')) {
    fprintf(stderr, "Stratus: the folder of its mappers is not known; VTK's own draw\n");
    return 0;
  }
  snprintf(path, sizeof path, "%.*s/../../" STRATUS_FACTORY, (int)(strrchr(self.dli_fname, '/') - self.dli_fname), self.dli_fname);
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library) {
    *(void**)&make_factory = dlsym(library, "stratus_make_factory");
  }
  if (!make_factory) {
    fprintf(stderr, "Stratus: its mappers can't be loaded (%s); VTK's own draw\n", dlerror());
    return 0;
  }
  return 1;
}

/* VTK compares this with its own and goes on only where they are equal. */
ENTRY const char* vtkGetFactoryVersion(void);
const char* vtkGetFactoryVersion(void)
{
  return load() ? "vtk version " STRATUS_VTK_VERSION : "none: see the line of Stratus";
}

ENTRY void* vtkLoad(void);
void* vtkLoad(void)
{
  return make_factory();
}
