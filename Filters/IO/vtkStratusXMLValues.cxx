// SPDX-License-Identifier: BSD-3-Clause
// The values of a .vti file's array. Uncompressed values are behind one number, their bytes. Compressed ones are behind the number of
// blocks, the bytes of a block, the bytes of the last block if it is shorter (else 0), and the compressed bytes of each block.
#include "vtkStratusXMLImage.h"

#include "vtkStratusZarrCodecs.h"

#include "vtkByteSwap.h"
#include "vtkDataArray.h"
#include "vtkSMPTools.h"

#include "vtk_lz4.h"

#include <algorithm>
#include <atomic>
#include <climits>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>

namespace {
constexpr int64_t PieceBytes = int64_t(1) << 20; // that a thread reads at a time
constexpr int64_t StepBytes = int64_t(1) << 26;  // between two reports of progress

int64_t CountNumbers()
{
  static std::atomic<int64_t> count{ 0 };
  return ++count;
}

// Returns a number of 4 or 8 bytes in the file's order.
uint64_t NumberAt(const unsigned char* at, int bytes, bool big)
{
  uint64_t number = 0;
  for (int i = 0; i < bytes; ++i) {
    number = number << 8 | at[big ? i : bytes - 1 - i];
  }
  return number;
}

// The inflated block that a thread has read last: boxes of neighbours often begin in the block in which another one ends.
struct LastBlock {
  uint64_t Of = 0; // number of the values
  size_t Block = 0;
  std::vector<char> Bytes;
};
} // namespace

vtkStratusXMLValues::vtkStratusXMLValues(const vtkStratusXMLImage& image, const vtkStratusXMLArray& array)
    : File(image.Path), Compressor(image.Compressor), Swaps(image.Swaps()), Sizes(array.Sizes),
      WordBytes(vtkDataArray::GetDataTypeSize(array.Type)), ValueBytes(WordBytes * array.Components),
      Bytes(ValueBytes * array.Sizes[0] * array.Sizes[1] * array.Sizes[2]), Number(static_cast<uint64_t>(CountNumbers()))
{
  std::error_code error;
  const int64_t length = static_cast<int64_t>(std::filesystem::file_size(image.Path, error));
  if (!this->File.IsOpen() || error) {
    image.Fail("can't be opened");
  }
  if (array.Offset + image.HeaderBytes > length) {
    image.Fail("the values of the array '" + array.Name + "' are at byte " + std::to_string(array.Offset) + ", beyond the file's end at " +
      std::to_string(length));
  }
  if (image.Compressor != vtkStratusXMLImage::NONE) {
    this->FindBlocks(image, array, length);
    return;
  }
  unsigned char header[8];
  const bool read = this->File.Read(array.Offset, header, static_cast<size_t>(image.HeaderBytes));
  const uint64_t bytes = read ? NumberAt(header, image.HeaderBytes, image.BigEndian) : 0;
  if (bytes != static_cast<uint64_t>(this->Bytes)) {
    image.Fail(
      "the array '" + array.Name + "' has " + std::to_string(bytes) + " bytes of values, must have " + std::to_string(this->Bytes));
  }
  this->Begin = array.Offset + image.HeaderBytes;
  if (length - this->Begin < this->Bytes) {
    image.Fail("the array '" + array.Name + "' has " + std::to_string(length - this->Begin) + " of its " + std::to_string(this->Bytes) +
      " bytes before the file's end: the file is cut short");
  }
}

void vtkStratusXMLValues::FindBlocks(const vtkStratusXMLImage& image, const vtkStratusXMLArray& array, int64_t length)
{
  const int64_t number = image.HeaderBytes;
  const std::string of = "the array '" + array.Name + "'";
  const auto look = [&](int64_t at, int64_t count) {
    std::vector<unsigned char> bytes(static_cast<size_t>(count * number));
    if (!this->File.Read(at, bytes.data(), bytes.size())) {
      image.Fail("the sizes of the blocks of " + of + " end at the file's end: the file is cut short");
    }
    std::vector<uint64_t> numbers(static_cast<size_t>(count));
    for (size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = NumberAt(bytes.data() + i * static_cast<size_t>(number), static_cast<int>(number), image.BigEndian);
    }
    return numbers;
  };
  const std::vector<uint64_t> head = look(array.Offset, 3);
  const uint64_t most = static_cast<uint64_t>(length / number), all = static_cast<uint64_t>(this->Bytes);
  const uint64_t blocks = head[0], block = head[1], last = head[2];
  const bool sized = blocks > 0 && blocks <= most && block > 0 && block <= INT_MAX && last <= block;
  const uint64_t inflated = sized ? blocks * block - (last ? block - last : 0) : 0;
  if (inflated != all || (last && last % static_cast<uint64_t>(this->WordBytes)) || block % static_cast<uint64_t>(this->WordBytes)) {
    image.Fail(of + " has " + std::to_string(blocks) + " blocks of " + std::to_string(block) + " bytes, the last of " +
      std::to_string(last) + ", must have " + std::to_string(all) + " bytes of values");
  }
  int64_t at = array.Offset + 3 * number + static_cast<int64_t>(blocks) * number;
  this->Blocks.push_back(at);
  for (const uint64_t size : look(array.Offset + 3 * number, static_cast<int64_t>(blocks))) {
    if (size > static_cast<uint64_t>(std::max<int64_t>(length - at, 0)) || size > INT_MAX) {
      image.Fail("block " + std::to_string(this->Blocks.size() - 1) + " of " + of + " has " + std::to_string(size) +
        " compressed bytes, of which the file has " + std::to_string(std::max<int64_t>(length - at, 0)) + ": it is damaged or cut short");
    }
    at += static_cast<int64_t>(size);
    this->Blocks.push_back(at);
  }
  this->BlockBytes = static_cast<int64_t>(block);
}

// Reads and inflates a block.
bool vtkStratusXMLValues::Inflate(size_t block, std::vector<char>& to) const
{
  static thread_local vtkStratusZarrBytes packed, inflated;
  const int64_t first = static_cast<int64_t>(block) * this->BlockBytes;
  const size_t wanted = static_cast<size_t>(std::min(this->BlockBytes, this->Bytes - first));
  const size_t count = static_cast<size_t>(this->Blocks[block + 1] - this->Blocks[block]);
  if (!this->File.Read(this->Blocks[block], packed.Resize(count), count)) {
    return false;
  }
  to.resize(wanted);
  if (this->Compressor == vtkStratusXMLImage::LZ4) {
    return LZ4_decompress_safe(packed.Get(), to.data(), static_cast<int>(count), static_cast<int>(wanted)) == static_cast<int>(wanted);
  }
  try {
    vtkStratusDecodeZarr({ vtkStratusZarrCodec::Deflate }, packed, wanted, inflated);
  } catch (const std::string&) {
    return false;
  }
  std::copy_n(inflated.Get(), std::min(inflated.Size(), wanted), to.begin());
  return inflated.Size() == wanted;
}

// Reads values as they are in the file, of those that are not compressed, from byte `at` of them on.
bool vtkStratusXMLValues::ReadBytes(int64_t at, int64_t count, char* to) const
{
  static thread_local LastBlock last;
  if (this->BlockBytes == 0) {
    return this->File.Read(this->Begin + at, to, static_cast<size_t>(count));
  }
  while (count > 0) {
    const size_t block = static_cast<size_t>(at / this->BlockBytes);
    if (last.Of != this->Number || last.Block != block) {
      last.Of = 0;
      if (!this->Inflate(block, last.Bytes)) {
        return false;
      }
      last.Of = this->Number;
      last.Block = block;
    }
    const int64_t within = at % this->BlockBytes, part = std::min(count, static_cast<int64_t>(last.Bytes.size()) - within);
    std::copy_n(last.Bytes.begin() + within, part, to);
    at += part;
    to += part;
    count -= part;
  }
  return true;
}

bool vtkStratusXMLValues::Read(const int64_t lo[3], const int64_t size[3], void* to) const
{
  const bool rows = size[0] == this->Sizes[0], layers = rows && size[1] == this->Sizes[1];
  const int64_t run = size[0] * this->ValueBytes * (rows ? size[1] : 1) * (layers ? size[2] : 1); // bytes that follow one another
  char* at = static_cast<char*>(to);
  for (int64_t z = 0; z < (layers ? 1 : size[2]); ++z) {
    for (int64_t y = 0; y < (rows ? 1 : size[1]); ++y, at += run) {
      const int64_t first = ((lo[2] + z) * this->Sizes[1] + lo[1] + y) * this->Sizes[0] + lo[0];
      if (!this->ReadBytes(first * this->ValueBytes, run, at)) {
        return false;
      }
    }
  }
  if (this->Swaps) {
    vtkByteSwap::SwapVoidRange(
      to, static_cast<size_t>((at - static_cast<char*>(to)) / this->WordBytes), static_cast<size_t>(this->WordBytes));
  }
  return true;
}

bool vtkStratusXMLValues::ReadAll(void* to, const std::function<void(double)>& progress) const
{
  const int64_t block = std::max(this->GetBlockBytes(), this->WordBytes), piece = block * std::max<int64_t>(PieceBytes / block, 1);
  const int64_t pieces = (this->Bytes + piece - 1) / piece, step = std::max<int64_t>(StepBytes / piece, 1);
  std::atomic<bool> whole{ true }, memory{ true };
  for (int64_t first = 0; first < pieces; first += step) {
    const int64_t end = std::min(first + step, pieces);
    vtkSMPTools::For(first, end, 1, [&](vtkIdType from, vtkIdType until) {
      for (vtkIdType i = from; i < until; ++i) {
        char* const at = static_cast<char*>(to) + i * piece;
        const int64_t count = std::min<int64_t>(piece, this->Bytes - i * piece);
        try {
          whole = this->ReadBytes(i * piece, count, at) && whole;
        } catch (const std::bad_alloc&) { // must not leave a thread
          memory = false;
        }
        if (this->Swaps) {
          vtkByteSwap::SwapVoidRange(at, static_cast<size_t>(count / this->WordBytes), static_cast<size_t>(this->WordBytes));
        }
      }
    });
    if (!memory) {
      throw std::bad_alloc();
    }
    progress(static_cast<double>(end) / static_cast<double>(pieces));
  }
  return whole;
}
