// SPDX-License-Identifier: BSD-3-Clause
// An HDF5 file by libhdf5: attributes, data sets, and values that several threads read at once. Private to the module.
#ifndef vtkStratusHDF5File_h
#define vtkStratusHDF5File_h

#include "vtkStratusPrivate.h"
#include "vtkStratusReadError.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

// The values of a data set, which stays open as long as this does. Sizes, chunks and boxes are along its dimensions, slowest first.
class VTK_STRATUS_PRIVATE vtkStratusHDF5Values
{
public:
  // id: of libhdf5, of an open data set of numbers, which this closes. The caller holds vtkStratusHDF5Lock().
  vtkStratusHDF5Values(int64_t id, int type);
  ~vtkStratusHDF5Values();
  vtkStratusHDF5Values(const vtkStratusHDF5Values&) = delete;
  void operator=(const vtkStratusHDF5Values&) = delete;

  int GetType() const { return this->Type; } // VTK's type of what Read() writes
  const std::vector<size_t>& GetSizes() const { return this->Sizes; }
  const std::vector<size_t>& GetChunks() const { return this->Chunks; } // empty: the values are in one piece
  // Returns the byte of the file at which all values begin as Read() writes them, or -1 if they are chunks, or not stored like that.
  int64_t GetBegin() const { return this->Begin; }
  // Returns whether Read() undoes the filters of chunks itself, so that threads wait for one another only while they fetch stored bytes.
  // Otherwise libhdf5 does all of it, for one thread at a time.
  bool IsDirect() const { return this->Direct; }

  // Writes the values of a box. Returns false if they cannot be read. Threads may call it at once.
  bool Read(const size_t* start, const size_t* count, void* values) const;

private:
  struct Filter {
    int Id;
    size_t ElementBytes; // of shuffled values
  };
  struct Buffers;

  void FindLayout();
  bool ReadByLibrary(const size_t* start, const size_t* count, const size_t* whole, void* values) const;
  bool ReadByChunks(const size_t* start, const size_t* count, char* values) const;
  const char* ReadChunk(const std::vector<size_t>& first, Buffers& buffers) const;
  const char* FillChunk(const std::vector<size_t>& first, Buffers& buffers) const;
  const char* Undo(size_t bytes, uint32_t skipped, Buffers& buffers) const;
  void CopyChunk(const char* chunk, const std::vector<size_t>& first, const size_t* start, const size_t* count, char* values) const;

  int64_t Id;
  int Type;
  std::vector<size_t> Sizes, Chunks;
  std::vector<Filter> Filters; // in the order in which they were applied
  size_t ValueBytes = 0, ChunkBytes = 0;
  int64_t Begin = -1;
  bool Direct = false;
};

// Members throw vtkStratusReadError. Names of objects are paths from the root, such as "/VTKHDF/PointData/rho".
class VTK_STRATUS_PRIVATE vtkStratusHDF5File
{
public:
  explicit vtkStratusHDF5File(const std::string& path);
  ~vtkStratusHDF5File();
  vtkStratusHDF5File(const vtkStratusHDF5File&) = delete;
  void operator=(const vtkStratusHDF5File&) = delete;

  bool Has(const std::string& object) const;
  // Returns the names of the objects of a group, sorted.
  std::vector<std::string> List(const std::string& group) const;
  // Returns the paths of all data sets of the file, sorted in each group.
  std::vector<std::string> ListDataSets() const;
  // Returns a text of an object; "" if there is none.
  std::string Text(const std::string& object, const char* attribute) const;
  // Returns numbers of an object, at most `most`; none if there are none.
  std::vector<double> Numbers(const std::string& object, const char* attribute, size_t most = 16) const;
  // Opens a data set. Null if there is none, or if it has no numbers. It may outlive the file's object.
  std::unique_ptr<vtkStratusHDF5Values> Open(const std::string& name) const;

  [[noreturn]] void Fail(const std::string& why) const;

private:
  std::string Path;
  int64_t Id = -1;
};

#endif
