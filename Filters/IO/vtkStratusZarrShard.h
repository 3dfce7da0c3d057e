// SPDX-License-Identifier: BSD-3-Clause
// The index of the shard that was read last. Private to the module.
#ifndef vtkStratusZarrShard_h
#define vtkStratusZarrShard_h

#include "vtkStratusZarrArray.h"

#include <mutex>

class vtkStratusZarrArray::ShardIndex
{
public:
  // Pairs of the first byte and the number of bytes of each chunk; both are None for a chunk that is not there.
  using Pairs = std::vector<uint64_t>;
  static constexpr uint64_t None = ~UINT64_C(0);

  // Returns the pairs of a file; null if they are not of the file that was read last.
  std::shared_ptr<const Pairs> Find(const std::string& path)
  {
    const std::lock_guard<std::mutex> lock(this->Lock);
    return this->Path == path ? this->Last : nullptr;
  }
  void Keep(const std::string& path, const std::shared_ptr<const Pairs>& pairs)
  {
    const std::lock_guard<std::mutex> lock(this->Lock);
    this->Path = path;
    this->Last = pairs;
  }

private:
  std::mutex Lock;
  std::string Path;
  std::shared_ptr<const Pairs> Last;
};

#endif
