// SPDX-License-Identifier: BSD-3-Clause
// Files are written under a temporary name and renamed when complete, so that a reader finds the old file or the new one, never half of it.
// Private to the modules, never installed.
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

// Follows symbolic links to their target, whether it exists or not, so that a rename does not replace the link. Returns any other path as
// it is.
inline std::string vtkStratusFollowLinks(const std::string& path)
{
  std::filesystem::path target = path;
  for (int links = 0; links < 40; ++links) { // Linux's own limit
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) {
      break;
    }
    target = target.parent_path() / next; // an absolute link replaces the folder
  }
  return target.string();
}

// Returns a name in the folder of `path`, because a rename is atomic only within a file system. The file's own name is not part of it,
// because names are limited to 255 bytes.
inline std::string vtkStratusTemporaryName(const std::string& path, int number)
{
  return path.substr(0, path.find_last_of('/') + 1) + "stratus-" + std::to_string(VTK_STRATUS_PROCESS) + "-" + std::to_string(number) +
    ".part";
}

// Creates the file `name`, later to be renamed to `path`, with the permissions of the file that is at `path`. Returns nullptr on failure,
// with the reason in errno.
inline std::FILE* vtkStratusCreateTemporary(const std::string& name, const std::string& path)
{
#ifdef _WIN32
  (void)path;
  return std::fopen(name.c_str(), "wbx");
#else
  struct stat old;
  const bool exists = stat(path.c_str(), &old) == 0;
  const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, exists ? 0600 : 0666);
  if (file >= 0 && exists) {
    // Errors are ignored, because some file systems have no permissions. If the file's owner cannot be kept, its set-user-ID bits must go.
    const bool owned = fchown(file, old.st_uid, old.st_gid) == 0;
    (void)!fchmod(file, old.st_mode & (owned ? 07777 : 0777));
  }
  return file >= 0 ? fdopen(file, "wb") : nullptr;
#endif
}

// Creates a new file to be renamed to `path` and puts its name in `name`. Returns nullptr on failure, with the reason in errno.
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
