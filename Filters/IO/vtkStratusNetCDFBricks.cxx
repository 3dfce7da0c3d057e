// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFBricks.h"

#include "vtkStratusBricks.h"
#include "vtkStratusHDF5Lock.h"
#include "vtkStratusIdentity.h"
#include "vtkStratusMappedFile.h"
#include "vtkStratusNetCDFValues.h"
#ifdef STRATUS_HDF5
#include "vtkStratusHDF5File.h"
#endif

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>

namespace {

// Writes the stored values of a box, in the file's order. Throws vtkStratusReadError. Several threads call it.
using StoredReader = std::function<void(const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored)>;

// A variable of a file of its own, which libnetcdf lets one thread at a time look at.
class OwnFile
{
public:
  OwnFile(const std::string& path, const std::string& name)
      : File(std::make_unique<vtkStratusNetCDFFile>(path)), Variable(this->File->Find(name))
  {
  }

  ~OwnFile()
  {
    const vtkStratusHDF5Call call;
    this->File.reset();
  }

  OwnFile(const OwnFile&) = delete;
  void operator=(const OwnFile&) = delete;

  void Read(const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) const
  {
    const vtkStratusHDF5Call call;
    this->File->ReadStored(*this->Variable, start, count, stored);
  }

  bool IsThere(const vtkStratusNetCDFPart& part) const { return this->Variable && this->Variable->Dimensions.size() == part.Axes.size(); }

private:
  std::unique_ptr<vtkStratusNetCDFFile> File;
  const vtkStratusNetCDFVariable* Variable;
};

#ifdef STRATUS_HDF5
// VTK's type of stored numbers.
int TypeOf(int stored)
{
  switch (stored) {
    case vtkStratusNetCDFInt8:
      return VTK_SIGNED_CHAR;
    case vtkStratusNetCDFUInt8:
      return VTK_UNSIGNED_CHAR;
    case vtkStratusNetCDFInt16:
      return VTK_SHORT;
    case vtkStratusNetCDFUInt16:
      return VTK_UNSIGNED_SHORT;
    case vtkStratusNetCDFInt32:
      return VTK_INT;
    case vtkStratusNetCDFUInt32:
      return VTK_UNSIGNED_INT;
    case vtkStratusNetCDFInt64:
      return VTK_TYPE_INT64;
    case vtkStratusNetCDFUInt64:
      return VTK_TYPE_UINT64;
    case vtkStratusNetCDFFloat32:
      return VTK_FLOAT;
    default:
      return VTK_DOUBLE;
  }
}

// Returns the variable's stored values by libhdf5; null if the file is none of HDF5, or if they are not chunks of known filters.
std::shared_ptr<vtkStratusHDF5Values> OpenChunks(const vtkStratusNetCDFFile& file, const vtkStratusNetCDFVariable& variable)
{
  std::vector<size_t> lengths;
  for (const int dimension : variable.Dimensions) {
    lengths.push_back(file.LengthOf(dimension)); // the values may end before: libnetcdf fills the rest
  }
  const std::string base = variable.BaseName(), group = "/" + variable.Name.substr(0, variable.Name.size() - base.size());
  try {
    const vtkStratusHDF5File stored(file.GetPath());
    for (const char* prefix : { "", "_nc4_non_coord_" }) { // libnetcdf's, of a variable that has the name of a dimension of others
      std::shared_ptr<vtkStratusHDF5Values> values = stored.Open(group + prefix + base);
      if (values && values->IsDirect() && values->GetSizes() == lengths && values->GetType() == TypeOf(variable.Type)) {
        return values;
      }
    }
  } catch (const vtkStratusReadError&) { // of another format
  }
  return nullptr;
}
#endif

// Returns what reads the variable's stored values; null if it is not in the file any more.
StoredReader MakeReader(const vtkStratusNetCDFFile& file, const vtkStratusNetCDFVariable& variable, const vtkStratusNetCDFPart& part)
{
#ifdef STRATUS_HDF5
  if (const auto chunks = OpenChunks(file, variable)) {
    return [chunks, path = file.GetPath()](const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) {
      if (!chunks->Read(start.data(), count.data(), stored)) {
        throw vtkStratusReadError{ path + ": a chunk cannot be read" };
      }
    };
  }
#endif
  const auto own = std::make_shared<OwnFile>(file.GetPath(), variable.Name);
  if (!own->IsThere(part)) {
    return nullptr;
  }
  std::vector<char> value(sizeof(double));
  own->Read(part.Indices, std::vector<size_t>(part.Axes.size(), 1), value.data()); // fails if none can be read
  return [own](const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) { own->Read(start, count, stored); };
}

// The values of a part of a variable.
class Part
{
public:
  Part(const vtkStratusNetCDFValues& values, const StoredReader& reader, const vtkStratusNetCDFPart& part)
      : Values(values), Reader(reader), Where(part)
  {
  }

  bool Read(const int64_t lo[3], const int64_t size[3], void* values) const
  {
    try {
      this->ReadBox(lo, size, static_cast<char*>(values));
      return true;
    } catch (const vtkStratusReadError&) {
      return false;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }

private:
  // Reads the box of the array in the file's order, in its place where that is the array's order.
  void ReadBox(const int64_t lo[3], const int64_t size[3], char* to) const
  {
    std::vector<size_t> start(this->Where.Indices), count(start.size(), 1);
    int64_t stride = 1, strides[3] = { 0, 0, 0 }; // of the array's axes in the box
    for (size_t i = start.size(); i-- > 0;) {
      const int axis = this->Where.Axes[i];
      if (axis < 0) {
        continue;
      }
      const size_t a = static_cast<size_t>(axis);
      const int64_t first = this->Where.Flipped[a] ? static_cast<int64_t>(this->Where.Lengths[a]) - lo[a] - size[a] : lo[a];
      start[i] = static_cast<size_t>(first);
      count[i] = static_cast<size_t>(size[a]);
      strides[a] = stride;
      stride *= size[a];
    }
    const size_t total = static_cast<size_t>(stride);
    const auto read = [&](void* stored) { this->Reader(start, count, stored); };
    const bool flipped = this->Where.Flipped[0] || this->Where.Flipped[1] || this->Where.Flipped[2];
    if (!flipped && strides[0] == 1 && strides[1] == size[0] && strides[2] == size[0] * size[1]) {
      this->Values.ReadInto(total, read, to);
      return;
    }
    this->Sort(this->Values.Read(total, read), size, strides, to);
  }

  // Copies a box, x fastest, along the array's axes.
  void Sort(vtkDataArray* box, const int64_t size[3], int64_t strides[3], char* to) const
  {
    const size_t bytes = static_cast<size_t>(box->GetDataTypeSize());
    const char* from = static_cast<const char*>(box->GetVoidPointer(0));
    for (size_t a = 0; a < 3; ++a) {
      if (this->Where.Flipped[a]) {
        from += static_cast<size_t>((size[a] - 1) * strides[a]) * bytes;
        strides[a] = -strides[a];
      }
    }
    for (int64_t k = 0; k < size[2]; ++k) {
      for (int64_t j = 0; j < size[1]; ++j) {
        const char* row = from + (k * strides[2] + j * strides[1]) * static_cast<int64_t>(bytes);
        if (strides[0] == 1) {
          std::memcpy(to, row, static_cast<size_t>(size[0]) * bytes);
          to += static_cast<size_t>(size[0]) * bytes;
          continue;
        }
        for (int64_t i = 0; i < size[0]; ++i, to += bytes) {
          std::memcpy(to, row + i * strides[0] * static_cast<int64_t>(bytes), bytes);
        }
      }
    }
  }

  vtkStratusNetCDFValues Values;
  StoredReader Reader;
  vtkStratusNetCDFPart Where;
};

// The identity of the array: of the file, the variable and its part. 0 if the file has none.
uint64_t IdentityOf(const std::string& path, const std::string& name, const vtkStratusNetCDFPart& part)
{
  std::vector<uint64_t> numbers;
  for (size_t i = 0; i < part.Axes.size(); ++i) {
    numbers.push_back(static_cast<uint64_t>(part.Axes[i] + 1));
    numbers.push_back(part.Axes[i] < 0 ? part.Indices[i] : part.Flipped[static_cast<size_t>(part.Axes[i])]);
  }
  return vtkStratusIdentityOfPart(vtkStratusIdentityOfFile(path, 0, -1), name, numbers);
}
} // namespace

vtkSmartPointer<vtkDataArray> vtkStratusMakeNetCDFBricks(
  const vtkStratusNetCDFFile& file, const vtkStratusNetCDFVariable& variable, const vtkStratusNetCDFPart& part)
{
  const vtkStratusNetCDFValues values = file.ValuesOf(variable);
  const StoredReader reader = MakeReader(file, variable, part);
  if (!reader) {
    return nullptr;
  }
  vtkStratusBrickSource source;
  source.Name = variable.Name;
  source.Type = values.GetResultType();
  source.Identity = IdentityOf(file.GetPath(), variable.Name, part);
  const std::vector<size_t> chunks = file.ChunksOf(variable);
  std::transform(part.Lengths.begin(), part.Lengths.end(), source.Dimensions.begin(), [](size_t n) { return static_cast<int64_t>(n); });
  source.Brick = { { source.Dimensions[0], 1, 1 } }; // of a file in one piece
  for (size_t i = 0; i < chunks.size(); ++i) {
    if (part.Axes[i] >= 0) {
      const size_t a = static_cast<size_t>(part.Axes[i]);
      source.Brick[a] = std::min(std::max<int64_t>(static_cast<int64_t>(chunks[i]), 1), source.Dimensions[a]);
      source.Before[a] = part.BeforeFirst(a, source.Brick[a]);
    }
  }
  const auto bricks = std::make_shared<Part>(values, reader, part);
  source.Read = [bricks](const int64_t lo[3], const int64_t size[3], void* to) { return bricks->Read(lo, size, to); };
  vtkStratusCutSource(source, part.Box.Low, part.Box.Size);
  return vtkStratusMakeBricks(source);
}
