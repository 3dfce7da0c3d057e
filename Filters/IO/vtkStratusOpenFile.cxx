// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusOpenFile.h"

#if defined(__unix__) || defined(__APPLE__)
#include <cerrno>
#include <fcntl.h>
#include <unistd.h>

vtkStratusOpenFile::vtkStratusOpenFile(const std::string& path) : Handle(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}

vtkStratusOpenFile::~vtkStratusOpenFile()
{
  if (this->Handle >= 0) {
    close(this->Handle);
  }
}

bool vtkStratusOpenFile::Read(int64_t at, void* to, size_t bytes) const
{
  for (size_t done = 0; done < bytes;) {
    const ssize_t got = pread(this->Handle, static_cast<char*>(to) + done, bytes - done, static_cast<off_t>(at) + static_cast<off_t>(done));
    if (got == 0 || (got < 0 && errno != EINTR)) {
      return false;
    }
    done += got > 0 ? static_cast<size_t>(got) : 0;
  }
  return true;
}

void vtkStratusOpenFile::Expect(int64_t at, int64_t bytes) const
{
#ifdef POSIX_FADV_WILLNEED
  (void)posix_fadvise(this->Handle, static_cast<off_t>(at), static_cast<off_t>(bytes), POSIX_FADV_WILLNEED);
#else
  (void)at;
  (void)bytes;
#endif
}
#else
vtkStratusOpenFile::vtkStratusOpenFile(const std::string&) {}

vtkStratusOpenFile::~vtkStratusOpenFile() = default;

bool vtkStratusOpenFile::Read(int64_t, void*, size_t) const
{
  return false;
}

void vtkStratusOpenFile::Expect(int64_t, int64_t) const {}
#endif
