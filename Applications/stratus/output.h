// SPDX-License-Identifier: BSD-3-Clause
// Writes a file that is either complete or absent.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace cli {

// Writes a temporary file in the path's folder and renames it. The temporary file is removed when the program fails or a signal ends it. A
// path that is no regular file (a pipe, a device), or to which a standard stream writes (/dev/stdout), is written in place.
class output_file
{
public:
  explicit output_file(const std::string& path); // opens nothing; throws failure where the file cannot be written
  ~output_file();
  output_file(const output_file&) = delete;
  output_file& operator=(const output_file&) = delete;

  void write(const std::vector<uint8_t>& bytes);

private:
  [[noreturn]] void fail(int reason);
  void open();

  std::string Path;   // as given
  std::string Target; // Path with links followed
  bool InPlace = false;
  int Stream = -1; // standard stream to write to, or -1
  bool HasTemporary = false;
  std::FILE* File = nullptr;
};
} // namespace cli
