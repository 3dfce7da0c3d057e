// SPDX-License-Identifier: BSD-3-Clause
// Codecs of Zarr, which chunks were written by, undone. Private to the module.
#ifndef vtkStratusZarrCodecs_h
#define vtkStratusZarrCodecs_h

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

// Bytes without a first value, so that memory is not written twice.
class vtkStratusZarrBytes
{
public:
  // Makes place for `count` bytes, which are undefined.
  char* Resize(size_t count)
  {
    if (count > this->Capacity) {
      this->Bytes.reset();
      this->Capacity = 0;
      this->Bytes.reset(new char[count]);
      this->Capacity = count;
    }
    this->Count = count;
    return this->Bytes.get();
  }
  // Leaves the first `count` bytes.
  void Shorten(size_t count) { this->Count = count; }
  char* Get() { return this->Bytes.get(); }
  const char* Get() const { return this->Bytes.get(); }
  size_t Size() const { return this->Count; }
  size_t Room() const { return this->Capacity; }

private:
  std::unique_ptr<char[]> Bytes;
  size_t Count = 0, Capacity = 0;
};

struct vtkStratusZarrCodec {
  enum KindType { Deflate, Zstd, Blosc, LZ4, Shuffle, CRC32C } Kind;
  size_t ElementBytes = 1; // of Shuffle
};

// Finds the codec of a name of version 2 or 3, of those that are built in. inner: the compressor inside of blosc, "" if unknown. Throws
// std::string, which names a codec that is not known or not built in. Returns false for a codec that decoding leaves out.
bool vtkStratusFindZarrCodec(const std::string& name, const std::string& inner, size_t element_bytes, vtkStratusZarrCodec& codec);

// Undoes a codec: reads `from`, and writes at most `most` bytes into `to`, which is resized. Several threads may call it. Throws
// std::string, which says what is wrong with the bytes.
void vtkStratusDecodeZarr(const vtkStratusZarrCodec& codec, const vtkStratusZarrBytes& from, size_t most, vtkStratusZarrBytes& to);

// Returns the number of a half's bits.
float vtkStratusHalf(uint16_t bits);

#endif
