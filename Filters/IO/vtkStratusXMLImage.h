// SPDX-License-Identifier: BSD-3-Clause
// A .vti file whose values follow its XML as bytes: what its XML says, and its values. Private to the module.
#ifndef vtkStratusXMLImage_h
#define vtkStratusXMLImage_h

#include "vtkStratusOpenFile.h"
#include "vtkStratusPrivate.h"
#include "vtkStratusReadError.h"

#include "vtkDataSetAttributes.h"
#include "vtkType.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

// An array of points or cells. All of its values are in one place of the file.
struct vtkStratusXMLArray {
  std::string Name, Units;
  bool Cells = false;
  int Type = VTK_VOID, Components = 1;
  std::array<int64_t, 3> Sizes = { 1, 1, 1 }; // along x, y, z
  int64_t Offset = 0;                         // in the file, of the numbers before the values
};

struct VTK_STRATUS_PRIVATE vtkStratusXMLImage {
  enum Compressors { NONE, ZLIB, LZ4 };

  std::string Path;
  std::array<int, 6> Extent = { 0, 0, 0, 0, 0, 0 };
  std::array<double, 3> Origin = { 0.0, 0.0, 0.0 }, Spacing = { 1.0, 1.0, 1.0 };
  std::array<double, 9> Direction = { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };
  bool BigEndian = false;
  int HeaderBytes = 4; // of each number before an array's values
  Compressors Compressor = NONE;
  bool HasFieldData = false;
  std::vector<vtkStratusXMLArray> Arrays; // in the file's order, arrays of points before arrays of cells
  // The name of each active attribute, of points and of cells; "": none.
  std::array<std::array<std::string, vtkDataSetAttributes::NUM_ATTRIBUTES>, 2> Active;

  [[noreturn]] void Fail(const std::string& why) const { throw vtkStratusReadError{ this->Path + ": " + why }; }
  bool Swaps() const; // whether this machine has the other order of bytes
};

// Returns why vtkStratusReadXMLImage() does not read the file although it may be a good one, such as "its arrays are text"; "" if it reads
// the file, or says what is wrong with it. Throws vtkStratusReadError if the file's XML can't be read.
VTK_STRATUS_PRIVATE std::string vtkStratusWhyNoXMLImage(const std::string& path);
// Throws vtkStratusReadError for another file, and for a damaged one.
VTK_STRATUS_PRIVATE vtkStratusXMLImage vtkStratusReadXMLImage(const std::string& path);

// The values of an array. Several threads may read them.
class VTK_STRATUS_PRIVATE vtkStratusXMLValues
{
public:
  // Reads the numbers before the values. Throws vtkStratusReadError if they do not fit the array or the file.
  vtkStratusXMLValues(const vtkStratusXMLImage& image, const vtkStratusXMLArray& array);

  // Returns where the values begin in the file; -1 if they are compressed.
  int64_t GetBegin() const { return this->BlockBytes > 0 ? -1 : this->Begin; }
  // Returns how many bytes are compressed at a time, at least 1.
  int64_t GetBlockBytes() const { return this->BlockBytes > 0 ? this->BlockBytes : 1; }

  // Reads the box of `size` values from `lo` on. Returns false for bytes that are missing or damaged.
  bool Read(const int64_t lo[3], const int64_t size[3], void* to) const;
  // Reads all values by several threads. progress gets the part that is done, 0..1, and may throw.
  bool ReadAll(void* to, const std::function<void(double)>& progress) const;

private:
  bool ReadBytes(int64_t at, int64_t count, char* to) const;
  bool Inflate(size_t block, std::vector<char>& to) const;
  void FindBlocks(const vtkStratusXMLImage& image, const vtkStratusXMLArray& array, int64_t length);

  vtkStratusOpenFile File;
  vtkStratusXMLImage::Compressors Compressor;
  bool Swaps;
  std::array<int64_t, 3> Sizes;
  int64_t WordBytes, ValueBytes; // of a number, and of all components
  int64_t Begin = 0, Bytes = 0;  // of all values; compressed ones begin at Blocks[0]
  int64_t BlockBytes = 0;        // inflated, of each block but the last; 0: nothing is compressed
  std::vector<int64_t> Blocks;   // where each block begins in the file, and where the last one ends
  uint64_t Number;               // of this object, no other one has had it
};

#endif
