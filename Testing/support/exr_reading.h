// SPDX-License-Identifier: BSD-3-Clause
// Reads a file of float channels with OpenEXR's own library, to check the files that Stratus writes. Other files are refused.
#ifndef exr_reading_h
#define exr_reading_h

#include <openexr.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

struct ExrPicture {
  int Width = 0, Height = 0;
  exr_compression_t Compression = EXR_COMPRESSION_NONE;
  std::map<std::string, std::vector<float>> Channels; // rows from top to bottom
};

// Returns whether a chunk has the expected content: the picture's rows from `top` on, all channels of floats, each pixel with a value.
inline bool IsPlainExrChunk(const exr_decode_pipeline_t& pipeline, int top, const ExrPicture& picture)
{
  const exr_chunk_info_t& chunk = pipeline.chunk;
  bool good = chunk.start_x == 0 && chunk.start_y == top && chunk.width == picture.Width && chunk.height > 0 &&
    chunk.height <= picture.Height - top && pipeline.channel_count > 0;
  for (int16_t c = 0; good && c < pipeline.channel_count; ++c) {
    const exr_coding_channel_info_t& info = pipeline.channels[c];
    good = info.data_type == EXR_PIXEL_FLOAT && info.width == chunk.width && info.height == chunk.height;
  }
  return good;
}

inline bool ReadExrChunks(exr_context_t file, ExrPicture& picture)
{
  int32_t lines = 0;
  bool good = exr_get_scanlines_per_chunk(file, 0, &lines) == EXR_ERR_SUCCESS && lines > 0;
  for (int top = 0; good && top < picture.Height; top += lines) {
    exr_chunk_info_t chunk;
    exr_decode_pipeline_t pipeline = {};
    good = exr_read_scanline_chunk_info(file, 0, top, &chunk) == EXR_ERR_SUCCESS &&
      exr_decoding_initialize(file, 0, &chunk, &pipeline) == EXR_ERR_SUCCESS && IsPlainExrChunk(pipeline, top, picture);
    for (int16_t c = 0; good && c < pipeline.channel_count; ++c) {
      exr_coding_channel_info_t& info = pipeline.channels[c];
      std::vector<float>& values = picture.Channels[info.channel_name];
      values.resize(static_cast<size_t>(picture.Width) * static_cast<size_t>(picture.Height));
      info.decode_to_ptr = reinterpret_cast<uint8_t*>(values.data() + static_cast<size_t>(top) * static_cast<size_t>(picture.Width));
      info.user_data_type = EXR_PIXEL_FLOAT;
      info.user_bytes_per_element = 4;
      info.user_pixel_stride = 4;
      info.user_line_stride = 4 * picture.Width;
    }
    good = good && exr_decoding_choose_default_routines(file, 0, &pipeline) == EXR_ERR_SUCCESS &&
      exr_decoding_run(file, 0, &pipeline) == EXR_ERR_SUCCESS;
    exr_decoding_destroy(file, &pipeline);
  }
  return good;
}

struct ExrBytes {
  const unsigned char* Data;
  size_t Size;
};

inline int64_t CopyExrBytes(exr_const_context_t, void* user, void* to, uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t)
{
  const ExrBytes* bytes = static_cast<const ExrBytes*>(user);
  const uint64_t there = offset < bytes->Size ? std::min<uint64_t>(size, bytes->Size - offset) : 0;
  if (there > 0) {
    std::memcpy(to, bytes->Data + offset, static_cast<size_t>(there));
  }
  return static_cast<int64_t>(there);
}

inline int64_t CountExrBytes(exr_const_context_t, void* user)
{
  return static_cast<int64_t>(static_cast<const ExrBytes*>(user)->Size);
}

inline void IgnoreExrError(exr_const_context_t, exr_result_t, const char*) {}

inline bool ReadExr(const ExrBytes& bytes, ExrPicture& picture)
{
  exr_context_t file = nullptr;
  exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
  start.user_data = const_cast<ExrBytes*>(&bytes);
  start.read_fn = CopyExrBytes;
  start.size_fn = CountExrBytes;
  start.error_handler_fn = IgnoreExrError;
  if (exr_start_read(&file, "picture.exr", &start) != EXR_ERR_SUCCESS) {
    return false;
  }
  exr_storage_t storage = EXR_STORAGE_TILED;
  exr_attr_box2i_t window = {};
  bool good = exr_get_storage(file, 0, &storage) == EXR_ERR_SUCCESS && storage == EXR_STORAGE_SCANLINE &&
    exr_get_data_window(file, 0, &window) == EXR_ERR_SUCCESS && window.min.x == 0 && window.min.y == 0 && window.max.x >= 0 &&
    window.max.y >= 0 && exr_get_compression(file, 0, &picture.Compression) == EXR_ERR_SUCCESS;
  // A byte that zlib has compressed holds 1,032 at most: a larger picture than that is not in the file.
  const auto most = 1032 * static_cast<int64_t>(bytes.Size) / 4;
  good = good && window.max.x < most && window.max.y < most / (window.max.x + 1);
  if (good) {
    picture.Width = window.max.x + 1;
    picture.Height = window.max.y + 1;
    good = ReadExrChunks(file, picture);
  }
  exr_finish(&file);
  return good;
}

inline bool ReadExr(const std::string& path, ExrPicture& picture)
{
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return ReadExr({ reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size() }, picture);
}

#endif
