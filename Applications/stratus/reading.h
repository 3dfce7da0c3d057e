// SPDX-License-Identifier: BSD-3-Clause
// Guards against third-party readers that hang or crash on a file. The program then ends with exit status 1 and one sentence that names the
// file and the reader, and writes no file. One thread reads at a time; others may draw meanwhile.
#pragma once

#include <vtkAlgorithm.h>
#include <vtkSmartPointer.h>

#include <memory>
#include <string>

namespace cli {

constexpr double usual_read_timeout = 60.0;

// Sets the seconds without progress after which the program ends, for all further reading; 0: never.
void set_read_timeout(double seconds);

// Watches the thread that constructs it, while it lives. Progress is a byte that the thread has read, from a file or ahead from its disk,
// or a ProgressEvent of the reader. Systems other than Linux do not count bytes, so there is no timeout there.
class reading
{
public:
  // `by` names the reader in messages until follow() names another.
  reading(const std::string& path, const std::string& by);
  ~reading();
  reading(const reading&) = delete;
  reading& operator=(const reading&) = delete;

  void follow(vtkAlgorithm* reader); // also counts its progress, until this object ends

private:
  class watchdog;
  void catch_crashes();

  std::string Path;
  std::unique_ptr<watchdog> Watchdog;
  vtkSmartPointer<vtkAlgorithm> Followed;
  unsigned long Observer = 0;
};
} // namespace cli
