// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusZarrCodecs.h"

#include "vtkStratusShuffle.h"

#include "vtk_lz4.h"
#include "vtk_zlib.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <new>

#ifdef STRATUS_BLOSC
#include <blosc.h>
#endif
#ifdef STRATUS_ZSTD
#include <zstd.h>
#endif

namespace {

uint32_t LittleWord(const char* at)
{
  const unsigned char* const byte = reinterpret_cast<const unsigned char*>(at);
  return byte[0] | static_cast<uint32_t>(byte[1]) << 8 | static_cast<uint32_t>(byte[2]) << 16 | static_cast<uint32_t>(byte[3]) << 24;
}

// Castagnoli's polynomial, reflected.
uint32_t CRC32C(const char* bytes, size_t count)
{
  static const std::array<uint32_t, 256> table = [] {
    std::array<uint32_t, 256> made;
    for (uint32_t i = 0; i < made.size(); ++i) {
      made[i] = i;
      for (int bit = 0; bit < 8; ++bit) {
        made[i] = made[i] >> 1 ^ (made[i] & 1 ? UINT32_C(0x82f63b78) : 0);
      }
    }
    return made;
  }();
  uint32_t sum = ~UINT32_C(0);
  for (size_t i = 0; i < count; ++i) {
    sum = sum >> 8 ^ table[(sum ^ static_cast<unsigned char>(bytes[i])) & 255];
  }
  return ~sum;
}

// zlib itself distinguishes its own headers from gzip's headers.
void Inflate(const vtkStratusZarrBytes& from, size_t most, vtkStratusZarrBytes& to)
{
  struct Stream : z_stream {
    Stream() : z_stream() {}
    ~Stream() { inflateEnd(this); }
  } stream;
  if (from.Size() > UINT_MAX || most > UINT_MAX || inflateInit2(&stream, 15 + 32) != Z_OK) {
    throw std::string("zlib does not start");
  }
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(from.Get()));
  stream.avail_in = static_cast<uInt>(from.Size());
  stream.next_out = reinterpret_cast<Bytef*>(to.Resize(most));
  stream.avail_out = static_cast<uInt>(most);
  const int status = inflate(&stream, Z_FINISH);
  if (status != Z_STREAM_END) {
    throw std::string(status == Z_DATA_ERROR ? "its deflated bytes are damaged"
        : stream.avail_in == 0               ? "its deflated bytes end too early"
                                             : "it inflates to more bytes than the chunk has");
  }
  to.Shorten(most - stream.avail_out);
}

void DecodeLZ4(const vtkStratusZarrBytes& from, size_t most, vtkStratusZarrBytes& to)
{
  constexpr size_t header = 4;
  const size_t count = from.Size() > header ? LittleWord(from.Get()) : most + 1;
  if (count > most || most > INT_MAX || from.Size() > INT_MAX) {
    throw std::string("its lz4 header is wrong");
  }
  char* const bytes = to.Resize(count);
  if (LZ4_decompress_safe(from.Get() + header, bytes, static_cast<int>(from.Size() - header), static_cast<int>(count)) !=
    static_cast<int>(count)) {
    throw std::string("its lz4 bytes are damaged");
  }
}

void DecodeZstd(const vtkStratusZarrBytes& from, size_t most, vtkStratusZarrBytes& to)
{
#ifdef STRATUS_ZSTD
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  static thread_local const std::unique_ptr<ZSTD_DCtx, Free> context(ZSTD_createDCtx());
  if (!context) {
    throw std::bad_alloc();
  }
  const size_t count = ZSTD_decompressDCtx(context.get(), to.Resize(most), most, from.Get(), from.Size());
  if (ZSTD_isError(count)) {
    throw std::string("zstd: ") + ZSTD_getErrorName(count);
  }
  to.Shorten(count);
#else
  (void)from;
  (void)most;
  (void)to;
#endif
}

void DecodeBlosc(const vtkStratusZarrBytes& from, size_t most, vtkStratusZarrBytes& to)
{
#ifdef STRATUS_BLOSC
  size_t count = 0;
  if (blosc_cbuffer_validate(from.Get(), from.Size(), &count) != 0 || count > most) {
    throw std::string("its blosc header is wrong");
  }
  char* const bytes = to.Resize(count);
  if (count > 0 && blosc_decompress_ctx(from.Get(), bytes, count, 1) != static_cast<int>(count)) {
    throw std::string("its blosc bytes are damaged");
  }
#else
  (void)from;
  (void)most;
  (void)to;
#endif
}

void Unshuffle(const vtkStratusZarrBytes& from, size_t element, vtkStratusZarrBytes& to)
{
  if (from.Size() % element != 0) {
    throw "its " + std::to_string(from.Size()) + " shuffled bytes are no multiple of " + std::to_string(element);
  }
  vtkStratusUnshuffle(from.Get(), from.Size(), element, to.Resize(from.Size()));
}

void CheckSum(const vtkStratusZarrBytes& from, vtkStratusZarrBytes& to)
{
  constexpr size_t sum = 4;
  if (from.Size() < sum || CRC32C(from.Get(), from.Size() - sum) != LittleWord(from.Get() + from.Size() - sum)) {
    throw std::string("its bytes do not have their checksum crc32c");
  }
  std::memcpy(to.Resize(from.Size() - sum), from.Get(), from.Size() - sum);
}

[[noreturn, maybe_unused]] void FailUnbuilt(const std::string& name, const char* library, const char* package)
{
  throw "the codec '" + name + "' is not built in; it needs " + library + " (Debian: " + package + ")";
}
} // namespace

bool vtkStratusFindZarrCodec(const std::string& full_name, const std::string& inner, size_t element_bytes, vtkStratusZarrCodec& codec)
{
  const std::string prefix = "numcodecs.",
                    name = full_name.compare(0, prefix.size(), prefix) == 0 ? full_name.substr(prefix.size()) : full_name;
  codec.ElementBytes = element_bytes;
  if (name == "zlib" || name == "gzip") {
    codec.Kind = vtkStratusZarrCodec::Deflate;
  } else if (name == "lz4") {
    codec.Kind = vtkStratusZarrCodec::LZ4;
  } else if (name == "crc32c") {
    codec.Kind = vtkStratusZarrCodec::CRC32C;
  } else if (name == "shuffle") {
    codec.Kind = vtkStratusZarrCodec::Shuffle;
    return element_bytes > 1;
  } else if (name == "bitround") { // changed values when they were written
    return false;
  } else if (name == "zstd") {
    codec.Kind = vtkStratusZarrCodec::Zstd;
#ifndef STRATUS_ZSTD
    FailUnbuilt(name, "libzstd", "libzstd-dev");
#endif
  } else if (name == "blosc") {
    codec.Kind = vtkStratusZarrCodec::Blosc;
#ifdef STRATUS_BLOSC
    const std::string built = std::string(",") + blosc_list_compressors() + ",";
    if (!inner.empty() && built.find("," + inner + ",") == std::string::npos) {
      throw "the compressor '" + inner + "' of the codec 'blosc' is not in libblosc; those that are: " + blosc_list_compressors();
    }
#else
    FailUnbuilt(name, "libblosc", "libblosc-dev");
#endif
  } else {
    throw "the codec '" + full_name + "' is not read; those that are: zlib, gzip, zstd, blosc, lz4, shuffle, bitround, crc32c";
  }
  (void)inner;
  return true;
}

void vtkStratusDecodeZarr(const vtkStratusZarrCodec& codec, const vtkStratusZarrBytes& from, size_t most, vtkStratusZarrBytes& to)
{
  switch (codec.Kind) {
    case vtkStratusZarrCodec::Deflate:
      return Inflate(from, most, to);
    case vtkStratusZarrCodec::Zstd:
      return DecodeZstd(from, most, to);
    case vtkStratusZarrCodec::Blosc:
      return DecodeBlosc(from, most, to);
    case vtkStratusZarrCodec::LZ4:
      return DecodeLZ4(from, most, to);
    case vtkStratusZarrCodec::Shuffle:
      return Unshuffle(from, codec.ElementBytes, to);
    case vtkStratusZarrCodec::CRC32C:
      return CheckSum(from, to);
  }
}

float vtkStratusHalf(uint16_t bits)
{
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const float size = exponent == 31 ? (fraction ? NAN : INFINITY)
    : exponent == 0                 ? std::ldexp(static_cast<float>(fraction), -24)
                                    : std::ldexp(static_cast<float>(1024 + fraction), exponent - 25);
  return bits & 0x8000 ? -size : size;
}
