// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusEXRFile.h"

#include <openexr.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>
#include <stdexcept>

namespace {
const size_t ShortName = 31; // longer names need a flag that OpenEXR before 2.0 does not know

// Collects in memory the bytes that OpenEXR writes. OpenEXR calls the callbacks from C, so they must not throw.
class Encoder
{
public:
  Encoder();
  ~Encoder();
  Encoder(const Encoder&) = delete;
  void operator=(const Encoder&) = delete;

  void WriteHeader(int width, int height, const std::vector<vtkStratusEXRChannel>& channels);
  void WriteRows(int width, int height, const std::vector<vtkStratusEXRChannel>& channels, const vtkStratusEXRProgress& progress);
  void Finish();

  std::vector<unsigned char> Bytes;

private:
  static int64_t Write(
    exr_const_context_t, void* self, const void* buffer, uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t) noexcept;
  static exr_result_t Compress(exr_encode_pipeline_t* pipeline) noexcept;
  static void OnError(exr_const_context_t context, exr_result_t, const char* message) noexcept;
  void Check(exr_result_t result) const;
  void ReleasePipeline();
  void WriteChunk(int top, int width, const std::vector<float>& values, const std::vector<vtkStratusEXRChannel>& channels);

  exr_context_t Context = nullptr;
  exr_encode_pipeline_t Pipeline = {};
  exr_result_t (*OwnCompress)(exr_encode_pipeline_t*) = nullptr; // OpenEXR's
  int Part = 0;
  char Message[256] = "";
  bool OutOfMemory = false;
};

Encoder::Encoder()
{
  exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
  start.user_data = this;
  start.write_fn = Encoder::Write;
  start.error_handler_fn = Encoder::OnError;
  const exr_result_t result = exr_start_write(&this->Context, "picture.exr", EXR_WRITE_FILE_DIRECTLY, &start);
  if (result != EXR_ERR_SUCCESS) {
    throw std::runtime_error(std::string("OpenEXR: ") + exr_get_default_error_message(result));
  }
}

Encoder::~Encoder()
{
  this->ReleasePipeline();
  if (this->Context) {
    exr_finish(&this->Context);
  }
}

// Must run before exr_finish(), because the context's functions free the pipeline's buffers.
void Encoder::ReleasePipeline()
{
  if (this->Pipeline.context) {
    exr_encoding_destroy(this->Context, &this->Pipeline);
    this->Pipeline = {};
  }
}

void Encoder::Finish()
{
  this->ReleasePipeline();
  this->Check(exr_finish(&this->Context));
}

int64_t Encoder::Write(
  exr_const_context_t, void* self, const void* buffer, uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t) noexcept
{
  Encoder* encoder = static_cast<Encoder*>(self);
  try {
    if (encoder->Bytes.size() < offset + size) { // OpenEXR writes the chunk table last, into the space reserved for it at the start
      encoder->Bytes.resize(static_cast<size_t>(offset + size));
    }
  } catch (const std::exception&) {
    encoder->OutOfMemory = true;
    return -1;
  }
  if (size > 0) {
    std::memcpy(encoder->Bytes.data() + offset, buffer, static_cast<size_t>(size));
  }
  return static_cast<int64_t>(size);
}

void Encoder::OnError(exr_const_context_t context, exr_result_t, const char* message) noexcept
{
  void* self = nullptr;
  if (exr_get_user_data(context, &self) == EXR_ERR_SUCCESS && self && message) {
    Encoder* encoder = static_cast<Encoder*>(self);
    std::strncpy(encoder->Message, message, sizeof encoder->Message - 1);
  }
}

// OpenEXR (3.1.5) keeps what it has compressed where that is as long as before, but readers take a chunk of that length for one that is not
// compressed.
exr_result_t Encoder::Compress(exr_encode_pipeline_t* pipeline) noexcept
{
  const exr_result_t result = static_cast<Encoder*>(pipeline->encoding_user_data)->OwnCompress(pipeline);
  if (result == EXR_ERR_SUCCESS && pipeline->compressed_bytes == pipeline->packed_bytes) {
    std::memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
  }
  return result;
}

void Encoder::Check(exr_result_t result) const
{
  if (result == EXR_ERR_OUT_OF_MEMORY || this->OutOfMemory) {
    throw std::bad_alloc();
  }
  if (result != EXR_ERR_SUCCESS) {
    throw std::runtime_error(std::string("OpenEXR: ") + (this->Message[0] ? this->Message : exr_get_default_error_message(result)));
  }
}

void Encoder::WriteHeader(int width, int height, const std::vector<vtkStratusEXRChannel>& channels)
{
  this->Check(exr_add_part(this->Context, "picture", EXR_STORAGE_SCANLINE, &this->Part));
  this->Check(exr_initialize_required_attr_simple(this->Context, this->Part, width, height, EXR_COMPRESSION_ZIP));
  if (std::any_of(channels.begin(), channels.end(),
        [](const vtkStratusEXRChannel& one) { return one.Name.size() + (one.Units.empty() ? 0 : 6) > ShortName; })) {
    this->Check(exr_set_longname_support(this->Context, 1));
  }
  for (const vtkStratusEXRChannel& channel : channels) {
    this->Check(exr_add_channel(this->Context, this->Part, channel.Name.c_str(), EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    if (!channel.Units.empty()) {
      this->Check(exr_attr_set_string(this->Context, this->Part, (channel.Name + ".units").c_str(), channel.Units.c_str()));
    }
  }
  this->Check(exr_write_header(this->Context));
}

// `values` holds one channel after the other, each with the chunk's rows from the top down.
void Encoder::WriteChunk(int top, int width, const std::vector<float>& values, const std::vector<vtkStratusEXRChannel>& channels)
{
  exr_chunk_info_t chunk;
  this->Check(exr_write_scanline_chunk_info(this->Context, this->Part, top, &chunk));
  const bool first = !this->Pipeline.context;
  this->Check(first ? exr_encoding_initialize(this->Context, this->Part, &chunk, &this->Pipeline)
                    : exr_encoding_update(this->Context, this->Part, &chunk, &this->Pipeline));
  for (int16_t c = 0; c < this->Pipeline.channel_count; ++c) { // OpenEXR sorts channels by name
    exr_coding_channel_info_t& info = this->Pipeline.channels[c];
    const auto source =
      std::find_if(channels.begin(), channels.end(), [&info](const vtkStratusEXRChannel& one) { return one.Name == info.channel_name; });
    const size_t at = static_cast<size_t>(source - channels.begin()) * static_cast<size_t>(chunk.height) * static_cast<size_t>(width);
    info.encode_from_ptr = reinterpret_cast<const uint8_t*>(values.data() + at);
    info.user_data_type = EXR_PIXEL_FLOAT;
    info.user_bytes_per_element = sizeof(float);
    info.user_pixel_stride = sizeof(float);
    info.user_line_stride = static_cast<int32_t>(sizeof(float)) * width;
  }
  if (first) {
    this->Check(exr_encoding_choose_default_routines(this->Context, this->Part, &this->Pipeline));
    this->Pipeline.encoding_user_data = this;
    this->OwnCompress = this->Pipeline.compress_fn;
    this->Pipeline.compress_fn = Encoder::Compress;
  }
  this->Check(exr_encoding_run(this->Context, this->Part, &this->Pipeline));
}

void Encoder::WriteRows(int width, int height, const std::vector<vtkStratusEXRChannel>& channels, const vtkStratusEXRProgress& progress)
{
  int32_t lines = 0;
  this->Check(exr_get_scanlines_per_chunk(this->Context, this->Part, &lines));
  std::vector<float> values;
  for (int top = 0; top < height; top += lines) {
    const int rows = std::min<int>(lines, height - top);
    values.resize(channels.size() * static_cast<size_t>(rows) * static_cast<size_t>(width));
    float* row = values.data();
    for (const vtkStratusEXRChannel& channel : channels) {
      for (int y = top; y < top + rows; ++y, row += width) {
        channel.GetRow(height - 1 - y, row);
      }
    }
    this->WriteChunk(top, width, values, channels);
    if (progress) {
      progress(static_cast<double>(top + rows) / height);
    }
  }
}

void CheckNames(const std::vector<vtkStratusEXRChannel>& channels)
{
  if (channels.empty()) {
    throw std::runtime_error("there is no channel to write, there must be at least one");
  }
  for (size_t c = 0; c < channels.size(); ++c) {
    const std::string& name = channels[c].Name;
    if (name.empty() || name.size() > 255) {
      throw std::runtime_error("a channel's name has " + std::to_string(name.size()) + " bytes, it must have 1..255");
    }
    if (std::any_of(channels.begin(), channels.begin() + static_cast<std::ptrdiff_t>(c),
          [&name](const vtkStratusEXRChannel& one) { return one.Name == name; })) {
      throw std::runtime_error("two channels have the name '" + name + "'");
    }
  }
}
} // namespace

std::vector<unsigned char> vtkStratusEncodeEXR(
  int width, int height, const std::vector<vtkStratusEXRChannel>& channels, const vtkStratusEXRProgress& progress)
{
  CheckNames(channels);
  Encoder encoder;
  encoder.WriteHeader(width, height, channels);
  encoder.WriteRows(width, height, channels, progress);
  encoder.Finish();
  return std::move(encoder.Bytes);
}
