// SPDX-License-Identifier: BSD-3-Clause
// Readers of other people's making, on files of other people's: they may hang or crash. Then the program ends with one sentence that names
// file and reader, and exit status 1, having written nothing.
#pragma once

#include <memory>
#include <string>

class vtkAlgorithm;

namespace cli {

constexpr double usual_read_timeout = 60.0;

// Of all reading from now on: seconds without progress after which the program ends; 0: never.
void set_read_timeout(double seconds);

// Watches the thread that makes it, as long as it lives. Progress is a byte that the thread has read, from a file or ahead from its disk,
// or a ProgressEvent of the reader. Where the system does not count bytes (all but Linux) nobody waits in vain: the timeout is none.
class reading
{
public:
  // by: who reads, for people, until follow() tells.
  reading(const std::string& path, const std::string& by);
  ~reading();
  reading(const reading&) = delete;
  reading& operator=(const reading&) = delete;

  void follow(vtkAlgorithm* reader);

private:
  class watchdog;
  void catch_crashes();

  std::string Path;
  std::unique_ptr<watchdog> Watchdog;
};
} // namespace cli
