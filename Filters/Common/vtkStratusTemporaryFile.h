// SPDX-License-Identifier: BSD-3-Clause
// Files are written under another name first, so that there is the old one or the new one, and no half of it. Private to the modules, never
// installed.
#ifndef vtkStratusTemporaryFile_h
#define vtkStratusTemporaryFile_h

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#ifdef _WIN32
#include <process.h>
#define VTK_STRATUS_PROCESS _getpid()
#else
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#define VTK_STRATUS_PROCESS getpid()
#endif

// What a link leads to, there or not, so that a rename does not replace the link. Any other path as it is.
inline std::string vtkStratusFollowLinks(const std::string& path)
{
  std::filesystem::path target = path;
  for (int links = 0; links < 40; ++links) { // as many as Linux follows
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) {
      break;
    }
    target = target.parent_path() / next; // an absolute one stays what it is
  }
  return target.string();
}

// In the folder of `path`, from where a rename is all or nothing. Short whatever the file is called: names end at 255 bytes.
inline std::string vtkStratusTemporaryName(const std::string& path, int number)
{
  return path.substr(0, path.find_last_of('/') + 1) + "stratus-" + std::to_string(VTK_STRATUS_PROCESS) + "-" + std::to_string(number) +
    ".part";
}

// A new file `name`, to be renamed to `path`: for those who may use the file that is there. nullptr, and errno tells why.
inline std::FILE* vtkStratusCreateTemporary(const std::string& name, const std::string& path)
{
#ifdef _WIN32
  (void)path;
  return std::fopen(name.c_str(), "wbx");
#else
  struct stat old;
  const bool exists = stat(path.c_str(), &old) == 0;
  const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, exists ? 0600 : 0666);
  if (file >= 0 && exists) { // where a file system has no permissions, it stays what it is there; nobody else's file runs as its new owner
    const bool owned = fchown(file, old.st_uid, old.st_gid) == 0;
    (void)!fchmod(file, old.st_mode & (owned ? 07777 : 0777));
  }
  return file >= 0 ? fdopen(file, "wb") : nullptr;
#endif
}

// A new file, whose name is put in `name`. nullptr, and errno tells why.
inline std::FILE* vtkStratusOpenTemporary(const std::string& path, std::string& name)
{
  std::FILE* file = nullptr;
  for (int number = 0; !file && (number == 0 || errno == EEXIST); ++number) {
    name = vtkStratusTemporaryName(path, number);
    file = vtkStratusCreateTemporary(name, path);
  }
  return file;
}

#endif
