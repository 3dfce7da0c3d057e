// SPDX-License-Identifier: BSD-3-Clause
// The values of vtkStratusZarrArray: chunks are found, decoded and copied to where they belong.
#include "vtkStratusZarrArray.h"

#include "vtkStratusMappedFile.h"
#include "vtkStratusZarrShard.h"

#include "vtkSMPTools.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <system_error>

// Memory in which a thread decodes a chunk. It is kept for the next chunk, unless it is large.
struct vtkStratusZarrArray::Scratch {
  vtkStratusZarrBytes Bytes, Other;

  void Trim()
  {
    constexpr size_t kept = size_t(1) << 24;
    for (vtkStratusZarrBytes* one : { &this->Bytes, &this->Other }) {
      if (one->Room() > kept) {
        *one = vtkStratusZarrBytes();
      }
    }
  }
};

namespace {
namespace files = std::filesystem;

constexpr uint64_t MostIdentity = uint64_t(1) << 20; // files that an identity looks at: a second or two

template <class Value> void CopyRow(const char* from, int64_t from_stride, char* to, int64_t to_stride, size_t count)
{
  for (size_t i = 0; i < count; ++i) {
    Value value;
    std::memcpy(&value, from, sizeof value);
    std::memcpy(to, &value, sizeof value);
    from += from_stride;
    to += to_stride;
  }
}

struct CopyAxis {
  size_t Count;
  int64_t From, To; // bytes between neighbours
};

// Copies a box of values of 1, 2, 4 or 8 bytes.
void CopyBox(const CopyAxis* axes, size_t rank, size_t bytes, const char* from, char* to)
{
  if (rank > 1) {
    for (size_t i = 0; i < axes->Count; ++i) {
      const int64_t at = static_cast<int64_t>(i);
      CopyBox(axes + 1, rank - 1, bytes, from + at * axes->From, to + at * axes->To);
    }
    return;
  }
  const size_t count = rank == 0 ? 1 : axes->Count;
  const int64_t size = static_cast<int64_t>(bytes), from_stride = rank == 0 ? size : axes->From, to_stride = rank == 0 ? size : axes->To;
  if (from_stride == size && to_stride == size) {
    std::memcpy(to, from, count * bytes);
  } else if (bytes == 1) {
    CopyRow<uint8_t>(from, from_stride, to, to_stride, count);
  } else if (bytes == 2) {
    CopyRow<uint16_t>(from, from_stride, to, to_stride, count);
  } else if (bytes == 4) {
    CopyRow<uint32_t>(from, from_stride, to, to_stride, count);
  } else {
    CopyRow<uint64_t>(from, from_stride, to, to_stride, count);
  }
}

template <size_t Bytes> void Swap(char* at, size_t count)
{
  for (size_t i = 0; i < count; ++i, at += Bytes) {
    std::reverse(at, at + Bytes);
  }
}

uint64_t LittleNumber(const char* at)
{
  uint64_t number = 0;
  for (int i = 7; i >= 0; --i) {
    number = number << 8 | static_cast<unsigned char>(at[i]);
  }
  return number;
}

// Returns the length of a regular file, or -1 if there is none. Throws std::string for anything else.
int64_t LengthOf(const std::string& path)
{
  std::error_code error;
  const files::file_status status = files::status(path, error);
  if (status.type() == files::file_type::not_found) {
    if (files::is_symlink(files::symlink_status(path, error))) { // as of data that were not fetched
      throw std::string("it is a link to a file that is not there");
    }
    return -1;
  }
  if (status.type() != files::file_type::regular) {
    throw error ? error.message() : std::string("it is no file");
  }
  const std::uintmax_t length = files::file_size(path, error);
  if (error || length > static_cast<std::uintmax_t>(INT64_MAX)) {
    throw error.message();
  }
  return static_cast<int64_t>(length);
}

void ReadBytes(const std::string& path, uint64_t first, size_t count, vtkStratusZarrBytes& bytes)
{
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  char* const to = bytes.Resize(count);
  errno = 0;
  if (!file || (first > 0 && fseeko(file.get(), static_cast<off_t>(first), SEEK_SET) != 0) ||
    std::fread(to, 1, count, file.get()) != count) {
    throw std::string(errno != 0 ? std::strerror(errno) : "it is cut short");
  }
}
} // namespace

// The name of a file of chunks, of the array's folder.
std::string vtkStratusZarrArray::KeyOf(const size_t* shard) const
{
  std::string key = this->Prefix;
  for (size_t a = 0; a < this->Shape.size(); ++a) {
    key += (key.empty() ? "" : std::string(1, this->Separator)) + std::to_string(shard[a]);
  }
  return key.empty() ? "0" : key;
}

// Returns the file of a chunk, and which one of how many chunks it is there.
std::string vtkStratusZarrArray::PathOf(const size_t* chunk, size_t& number, size_t& count) const
{
  std::vector<size_t> shard(this->Shape.size());
  number = 0;
  count = 1;
  for (size_t a = 0; a < shard.size(); ++a) {
    const size_t inside = this->Shard[a] / this->Chunk[a];
    shard[a] = chunk[a] / inside;
    number = number * inside + chunk[a] % inside;
    count *= inside;
  }
  return this->Folder + this->KeyOf(shard.data());
}

// Loads a whole file. Returns false if there is none.
bool vtkStratusZarrArray::LoadFile(const std::string& path, size_t most, vtkStratusZarrBytes& bytes) const
{
  const int64_t length = LengthOf(path);
  if (length < 0) {
    return false;
  }
  if (static_cast<uint64_t>(length) > most) {
    throw "it has " + std::to_string(length) + " bytes, at most " + std::to_string(most) + " can be of its chunk";
  }
  ReadBytes(path, 0, static_cast<size_t>(length), bytes);
  return true;
}

// Loads a chunk as it is in its file, or in its part of a shard. Returns false if it is not there: it has the fill value then.
bool vtkStratusZarrArray::LoadPart(const size_t* chunk, vtkStratusZarrBytes& bytes) const
{
  const size_t most = this->ChunkBytes + this->ChunkBytes / 4 + 65536; // some codecs add bytes
  size_t number = 0, count = 0;
  const std::string path = this->PathOf(chunk, number, count);
  if (!this->IsSharded) {
    return this->LoadFile(path, most, bytes);
  }
  const int64_t length = LengthOf(path);
  if (length < 0) {
    return false;
  }
  std::shared_ptr<const ShardIndex::Pairs> pairs = this->Index->Find(path);
  if (!pairs) {
    const uint64_t index_bytes = static_cast<uint64_t>(count) * 16 + (this->IndexSum ? 4 : 0);
    if (static_cast<uint64_t>(length) < index_bytes) {
      throw "it has " + std::to_string(length) + " bytes, the index of the shard needs " + std::to_string(index_bytes);
    }
    ReadBytes(path, this->IndexFirst ? 0 : static_cast<uint64_t>(length) - index_bytes, static_cast<size_t>(index_bytes), bytes);
    if (this->IndexSum) {
      const vtkStratusZarrCodec sum = { vtkStratusZarrCodec::CRC32C, 1 };
      vtkStratusZarrBytes checked;
      vtkStratusDecodeZarr(sum, bytes, count * 16, checked);
    }
    const auto read = std::make_shared<ShardIndex::Pairs>(2 * count);
    for (size_t i = 0; i < read->size(); ++i) {
      (*read)[i] = LittleNumber(bytes.Get() + 8 * i);
    }
    this->Index->Keep(path, read);
    pairs = read;
  }
  const uint64_t first = (*pairs)[2 * number], many = (*pairs)[2 * number + 1];
  if (first == ShardIndex::None && many == ShardIndex::None) {
    return false;
  }
  if (many > most || first > static_cast<uint64_t>(length) || many > static_cast<uint64_t>(length) - first) {
    throw "the index of the shard places a chunk of " + std::to_string(many) + " bytes at " + std::to_string(first) + ", the file has " +
      std::to_string(length);
  }
  ReadBytes(path, first, static_cast<size_t>(many), bytes);
  return true;
}

// Loads the values of a chunk into scratch.Bytes, in this machine's order of bytes. Returns false if the chunk is not there.
bool vtkStratusZarrArray::LoadChunk(const size_t* chunk, Scratch& scratch) const
{
  if (!this->LoadPart(chunk, scratch.Bytes)) {
    return false;
  }
  for (const vtkStratusZarrCodec& codec : this->Codecs) {
    const bool last = &codec == &this->Codecs.back();
    vtkStratusDecodeZarr(codec, scratch.Bytes, this->ChunkBytes + (last ? 0 : this->ChunkBytes / 4 + 65536), scratch.Other);
    std::swap(scratch.Bytes, scratch.Other);
  }
  if (scratch.Bytes.Size() != this->ChunkBytes) {
    throw "it has " + std::to_string(scratch.Bytes.Size()) + " bytes of values, its chunk has " + std::to_string(this->ChunkBytes);
  }
  const size_t count = this->ChunkBytes / this->StoredBytes;
  if (this->Swapped) {
    char* const bytes = scratch.Bytes.Get();
    this->StoredBytes == 2 ? Swap<2>(bytes, count) : this->StoredBytes == 4 ? Swap<4>(bytes, count) : Swap<8>(bytes, count);
  }
  if (this->Half) {
    char* const to = scratch.Other.Resize(count * sizeof(float));
    for (size_t i = 0; i < count; ++i) {
      uint16_t bits;
      std::memcpy(&bits, scratch.Bytes.Get() + i * sizeof bits, sizeof bits);
      const float value = vtkStratusHalf(bits);
      std::memcpy(to + i * sizeof value, &value, sizeof value);
    }
    std::swap(scratch.Bytes, scratch.Other);
  }
  return true;
}

// Copies the values that a chunk and the box have in common.
void vtkStratusZarrArray::ReadChunk(const std::vector<size_t>& chunk, const std::vector<size_t>& start, const std::vector<size_t>& count,
  char* to, const std::vector<int64_t>& strides, Scratch& scratch) const
{
  const size_t rank = this->Shape.size();
  bool there = false;
  try {
    there = this->LoadChunk(chunk.data(), scratch);
  } catch (const std::string& why) {
    size_t number = 0, count = 0;
    throw vtkStratusReadError{ "chunk " + this->PathOf(chunk.data(), number, count) + " is damaged: " + why };
  }
  std::vector<int64_t> within(rank);
  int64_t stride = static_cast<int64_t>(this->ValueBytes);
  for (size_t i = rank; i-- > 0;) {
    const size_t a = this->Order[i];
    within[a] = there ? stride : 0;
    stride *= static_cast<int64_t>(this->Chunk[a]);
  }
  const char* from = there ? scratch.Bytes.Get() : this->Fill.data();
  std::vector<CopyAxis> axes;
  for (size_t a = 0; a < rank; ++a) {
    const size_t first = std::max(start[a], chunk[a] * this->Chunk[a]);
    const size_t end = std::min(start[a] + count[a], (chunk[a] + 1) * this->Chunk[a]);
    from += static_cast<int64_t>(first - chunk[a] * this->Chunk[a]) * within[a];
    to += static_cast<int64_t>(first - start[a]) * strides[a];
    if (end - first > 1) {
      axes.push_back({ end - first, within[a], strides[a] });
    }
  }
  std::sort(axes.begin(), axes.end(), [](const CopyAxis& a, const CopyAxis& b) { return std::abs(a.To) > std::abs(b.To); });
  CopyBox(axes.data(), axes.size(), this->ValueBytes, from, to);
}

void vtkStratusZarrArray::Read(
  const std::vector<size_t>& start, const std::vector<size_t>& count, char* to, const std::vector<int64_t>& strides, bool parallel) const
{
  const size_t rank = this->Shape.size();
  if (!this->Fault.empty()) {
    throw vtkStratusReadError{ this->Fault };
  }
  std::vector<size_t> first(rank), many(rank);
  vtkIdType total = 1;
  for (size_t a = 0; a < rank; ++a) {
    if (count[a] > this->Shape[a] || start[a] > this->Shape[a] - count[a]) {
      throw vtkStratusReadError{ "values " + std::to_string(start[a]) + " to " + std::to_string(start[a] + count[a]) +
        " of a dimension of " + std::to_string(this->Shape[a]) + " were requested" };
    }
    if (count[a] == 0) {
      return;
    }
    first[a] = start[a] / this->Chunk[a];
    many[a] = (start[a] + count[a] - 1) / this->Chunk[a] - first[a] + 1;
    total *= static_cast<vtkIdType>(many[a]);
  }
  std::mutex lock;
  std::string fault; // the first one
  std::atomic<bool> failed{ false };
  const auto fail = [&](const std::string& why) {
    const std::lock_guard<std::mutex> guard(lock);
    fault = failed ? fault : why;
    failed = true;
  };
  auto read = [&](vtkIdType begin, vtkIdType end) {
    static thread_local Scratch scratch;
    try {
      std::vector<size_t> chunk(rank);
      for (vtkIdType i = begin; i < end && !failed; ++i) {
        size_t rest = static_cast<size_t>(i);
        for (size_t a = rank; a-- > 0; rest /= many[a]) {
          chunk[a] = first[a] + rest % many[a];
        }
        this->ReadChunk(chunk, start, count, to, strides, scratch);
      }
    } catch (const vtkStratusReadError& why) {
      fail(why.Text);
    } catch (const std::bad_alloc&) {
      fail("out of memory while a chunk was decoded");
    }
    scratch.Trim();
  };
  if (parallel && total > 1) {
    vtkSMPTools::For(0, total, 1, read);
  } else {
    read(0, total);
  }
  if (failed) {
    throw vtkStratusReadError{ fault };
  }
}

uint64_t vtkStratusZarrArray::GetIdentity() const
{
  const size_t rank = this->Shape.size();
  std::vector<size_t> many(rank), chunk(rank);
  uint64_t total = 1, identity = 0;
  const auto mix = [&identity](uint64_t number) { identity = (identity ^ number) * UINT64_C(0x9e3779b97f4a7c15) ^ identity >> 29; };
  for (size_t a = 0; a < rank; ++a) {
    many[a] = (this->Shape[a] + this->Shard[a] - 1) / this->Shard[a];
    if (many[a] > MostIdentity || total * many[a] > MostIdentity) {
      return 0;
    }
    total *= many[a];
  }
  std::error_code error;
  for (const char c : files::absolute(this->Folder, error).string()) {
    mix(static_cast<unsigned char>(c));
  }
  for (const std::string& file : this->MetadataFiles) {
    mix(vtkStratusIdentityOfFile(this->Folder + file, 0, -1)); // 0 for attributes that are not there
  }
  for (uint64_t i = 0; i < total; ++i) {
    uint64_t rest = i;
    for (size_t a = rank; a-- > 0; rest /= many[a]) {
      chunk[a] = static_cast<size_t>(rest % many[a]);
    }
    const std::string path = this->Folder + this->KeyOf(chunk.data());
    mix(static_cast<uint64_t>(files::file_size(path, error))); // of a file that is not there: the greatest number
    mix(static_cast<uint64_t>(files::last_write_time(path, error).time_since_epoch().count()));
  }
  return identity ? identity : 1;
}
