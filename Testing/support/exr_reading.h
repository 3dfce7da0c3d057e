// SPDX-License-Identifier: BSD-3-Clause
// Reads a file of float channels with OpenEXR's own library, to check the files that Stratus writes.
#ifndef exr_reading_h
#define exr_reading_h

#include <openexr.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

struct ExrPicture {
  int Width = 0, Height = 0;
  exr_compression_t Compression = EXR_COMPRESSION_NONE;
  std::map<std::string, std::vector<float>> Channels; // rows from top to bottom
};

inline bool ReadExrChunks(exr_context_t file, ExrPicture& picture)
{
  int32_t lines = 0;
  bool good = exr_get_scanlines_per_chunk(file, 0, &lines) == EXR_ERR_SUCCESS;
  for (int top = 0; good && top < picture.Height; top += lines) {
    exr_chunk_info_t chunk;
    exr_decode_pipeline_t pipeline = {};
    good = exr_read_scanline_chunk_info(file, 0, top, &chunk) == EXR_ERR_SUCCESS &&
      exr_decoding_initialize(file, 0, &chunk, &pipeline) == EXR_ERR_SUCCESS;
    for (int16_t c = 0; good && c < pipeline.channel_count; ++c) {
      exr_coding_channel_info_t& info = pipeline.channels[c];
      good = info.data_type == EXR_PIXEL_FLOAT;
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

inline bool ReadExr(const std::string& path, ExrPicture& picture)
{
  exr_context_t file = nullptr;
  if (exr_start_read(&file, path.c_str(), nullptr) != EXR_ERR_SUCCESS) {
    return false;
  }
  exr_attr_box2i_t window = {};
  bool good = exr_get_data_window(file, 0, &window) == EXR_ERR_SUCCESS && window.min.x == 0 && window.min.y == 0 &&
    exr_get_compression(file, 0, &picture.Compression) == EXR_ERR_SUCCESS;
  picture.Width = window.max.x + 1;
  picture.Height = window.max.y + 1;
  good = good && ReadExrChunks(file, picture);
  exr_finish(&file);
  return good;
}

#endif
