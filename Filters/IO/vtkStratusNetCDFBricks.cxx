// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFBricks.h"

#include "vtkStratusBricks.h"
#include "vtkStratusMappedFile.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>

#include <dlfcn.h>

namespace {

// HDF5 writes each thread's errors to the terminal unless the thread switches that off. libnetcdf does so in the thread that opens a file.
void SilenceThread()
{
  using Setter = int (*)(int64_t stack, void* function, void* data);
  static thread_local bool silent = false;
  if (!silent) {
    silent = true;
    if (const auto set = reinterpret_cast<Setter>(dlsym(RTLD_DEFAULT, "H5Eset_auto2"))) {
      set(0, nullptr, nullptr);
    }
  }
}

// A variable of a file of its own, which libnetcdf lets one thread at a time look at.
class Part
{
public:
  Part(const std::string& path, const std::string& name, const vtkStratusNetCDFPart& part)
      : File(std::make_unique<vtkStratusNetCDFFile>(path)), Variable(this->File->Find(name)), Where(part)
  {
  }

  ~Part()
  {
    const std::lock_guard<std::recursive_mutex> lock(vtkStratusNetCDFLock());
    this->File.reset();
  }

  Part(const Part&) = delete;
  void operator=(const Part&) = delete;

  bool IsThere() const { return this->Variable && this->Variable->Dimensions.size() == this->Where.Axes.size(); }

  // Reads the box of the array in the file's order. strides: of the array's axes in it.
  vtkSmartPointer<vtkDataArray> ReadBox(const int64_t lo[3], const int64_t size[3], int64_t strides[3]) const
  {
    std::vector<size_t> start(this->Where.Indices), count(start.size(), 1);
    int64_t stride = 1;
    std::fill_n(strides, 3, 0);
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
    std::unique_lock<std::recursive_mutex> lock(vtkStratusNetCDFLock());
    return this->File->Read(*this->Variable, start, count, { &lock });
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

  bool Read(const int64_t lo[3], const int64_t size[3], void* values) const
  {
    SilenceThread();
    try {
      int64_t strides[3];
      const vtkSmartPointer<vtkDataArray> box = this->ReadBox(lo, size, strides);
      this->Sort(box, size, strides, static_cast<char*>(values));
      return true;
    } catch (const vtkStratusReadError&) {
      return false;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }

  const vtkStratusNetCDFFile& GetFile() const { return *this->File; }
  const vtkStratusNetCDFVariable& GetVariable() const { return *this->Variable; }

private:
  std::unique_ptr<vtkStratusNetCDFFile> File;
  const vtkStratusNetCDFVariable* Variable;
  vtkStratusNetCDFPart Where;
};

// The identity of the array: of the file, the variable and its part. 0 if the file has none.
uint64_t IdentityOf(const std::string& path, const std::string& name, const vtkStratusNetCDFPart& part)
{
  uint64_t identity = vtkStratusIdentityOfFile(path, 0, -1);
  const auto mix = [&identity](uint64_t number) { identity = (identity ^ number) * UINT64_C(0x9e3779b97f4a7c15) ^ identity >> 29; };
  if (identity != 0) {
    for (const char c : name) {
      mix(static_cast<unsigned char>(c));
    }
    for (size_t i = 0; i < part.Axes.size(); ++i) {
      mix(static_cast<uint64_t>(part.Axes[i] + 1));
      mix(part.Axes[i] < 0 ? part.Indices[i] : part.Flipped[static_cast<size_t>(part.Axes[i])]);
    }
    identity = identity ? identity : 1;
  }
  return identity;
}
} // namespace

vtkSmartPointer<vtkDataArray> vtkStratusMakeNetCDFBricks(
  const vtkStratusNetCDFFile& file, const vtkStratusNetCDFVariable& variable, const vtkStratusNetCDFPart& part)
{
  constexpr int64_t one[3] = { 1, 1, 1 }, first[3] = { 0, 0, 0 };
  const auto values = std::make_shared<Part>(file.GetPath(), variable.Name, part);
  if (!values->IsThere()) {
    return nullptr;
  }
  int64_t strides[3];
  vtkStratusBrickSource source;
  source.Name = variable.Name;
  source.Type = values->ReadBox(first, one, strides)->GetDataType();
  source.Identity = IdentityOf(file.GetPath(), variable.Name, part);
  const std::vector<size_t> chunks = values->GetFile().ChunksOf(values->GetVariable());
  std::transform(part.Lengths.begin(), part.Lengths.end(), source.Dimensions.begin(), [](size_t n) { return static_cast<int64_t>(n); });
  source.Brick = { { source.Dimensions[0], 1, 1 } }; // of a file in one piece
  for (size_t i = 0; i < chunks.size(); ++i) {
    if (part.Axes[i] >= 0) {
      const size_t a = static_cast<size_t>(part.Axes[i]);
      source.Brick[a] = std::min(std::max<int64_t>(static_cast<int64_t>(chunks[i]), 1), source.Dimensions[a]);
    }
  }
  source.Read = [values](const int64_t lo[3], const int64_t size[3], void* to) { return values->Read(lo, size, to); };
  return vtkStratusMakeBricks(source);
}
