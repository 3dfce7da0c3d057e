// SPDX-License-Identifier: BSD-3-Clause
// Files are written under a temporary name and renamed when complete, so that a reader finds the old file or the new one, never half of it.
// A pipe or a device is written in place, because a rename would replace it by a file.
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

// Sets `target` to the file that `path` names, behind links. Returns whether a rename may replace it: it is a regular file with a name of
// its own, or nothing yet.
inline bool vtkStratusFindTarget(const std::string& path, std::string& target)
{
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  target = vtkStratusFollowLinks(path);
  return !std::filesystem::exists(status) || (std::filesystem::is_regular_file(status) && std::filesystem::equivalent(path, target, error));
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

// A file that replaces another when it is whole. Each call returns 0, or the reason of a failure as errno has it.
class vtkStratusReplacingFile
{
public:
  vtkStratusReplacingFile() = default;
  vtkStratusReplacingFile(const vtkStratusReplacingFile&) = delete;
  vtkStratusReplacingFile& operator=(const vtkStratusReplacingFile&) = delete;
  ~vtkStratusReplacingFile()
  {
    this->Close();
    if (!this->Part.empty()) {
      std::remove(this->Part.c_str());
    }
  }

  int Open(const std::string& path)
  {
    if (!vtkStratusFindTarget(path, this->Target)) {
      this->File = std::fopen(path.c_str(), "wb");
      return this->File ? 0 : errno;
    }
    for (int number = 0; !this->File && (number == 0 || errno == EEXIST); ++number) {
      this->Part = vtkStratusTemporaryName(this->Target, number);
      this->File = vtkStratusCreateTemporary(this->Part, this->Target);
    }
    if (!this->File) {
      this->Part.clear(); // another's file, if any
    }
    return this->File ? 0 : errno;
  }

  std::FILE* Get() const { return this->File; }

  int Close()
  {
    std::FILE* file = this->File;
    this->File = nullptr;
    return file && std::fclose(file) != 0 ? errno : 0;
  }

  int Rename() // after Close()
  {
    std::error_code error;
    if (!this->Part.empty()) {
      std::filesystem::rename(this->Part, this->Target, error);
    }
    if (!error) {
      this->Part.clear();
    }
    return error.value();
  }

  int Finish(const void* bytes, size_t size) // writes all that the file has
  {
    const int writing = std::fwrite(bytes, 1, size, this->File) == size ? 0 : errno, closing = this->Close();
    return writing != 0 ? writing : closing != 0 ? closing : this->Rename();
  }

private:
  std::string Target, Part; // Part is empty where the target is written in place
  std::FILE* File = nullptr;
};

#endif
