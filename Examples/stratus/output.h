// SPDX-License-Identifier: BSD-3-Clause
// A file that is either whole or not there.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace cli {

// Bytes become a file under another name beside it, which then gets the name. What is left of it goes when the program fails, and when a
// signal ends it. What exists and is no regular file (a pipe, a device) is written in place, and so is what a standard stream writes to
// (/dev/stdout).
class output_file
{
public:
  explicit output_file(const std::string& path); // opens nothing; throws failure where the file could not be written
  ~output_file();
  output_file(const output_file&) = delete;
  output_file& operator=(const output_file&) = delete;

  void write(const std::vector<uint8_t>& bytes);

private:
  [[noreturn]] void fail(int reason);
  void open();

  std::string Path;   // as it was given
  std::string Target; // where it leads to
  bool InPlace = false;
  int Stream = -1; // of the standard ones, the one to write to
  bool HasTemporary = false;
  std::FILE* File = nullptr;
};
} // namespace cli
