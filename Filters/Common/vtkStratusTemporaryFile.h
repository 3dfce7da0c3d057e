// SPDX-License-Identifier: BSD-3-Clause
// Files are written under another name first, so that there is the old one or the new one, and no half of it. Private to the modules, never
// installed.
#ifndef vtkStratusTemporaryFile_h
#define vtkStratusTemporaryFile_h

#include <cerrno>
#include <cstdio>
#include <string>
#ifdef _WIN32
#include <process.h>
#define VTK_STRATUS_PROCESS _getpid()
#else
#include <unistd.h>
#define VTK_STRATUS_PROCESS getpid()
#endif

// In the folder of `path`, from where a rename is all or nothing. Short whatever the file is called: names end at 255 bytes.
inline std::string vtkStratusTemporaryName(const std::string& path, int number)
{
  return path.substr(0, path.find_last_of('/') + 1) + "stratus-" + std::to_string(VTK_STRATUS_PROCESS) + "-" + std::to_string(number) +
    ".part";
}

// A new file, whose name is put in `name`. nullptr, and errno tells why.
inline std::FILE* vtkStratusOpenTemporary(const std::string& path, std::string& name)
{
  std::FILE* file = nullptr;
  for (int number = 0; !file && (number == 0 || errno == EEXIST); ++number) {
    name = vtkStratusTemporaryName(path, number);
    file = std::fopen(name.c_str(), "wbx");
  }
  return file;
}

#endif
