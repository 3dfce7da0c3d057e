// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusEXRReader.h"

#include "vtkErrorCode.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <openexr.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkStratusEXRReader);

namespace {
using Stop = std::runtime_error;

// A file's first bytes (OpenEXR's technical introduction).
const unsigned char Magic[4] = { 0x76, 0x2f, 0x31, 0x01 };

// Arrays that are the active scalars, if they are there.
const char* const Preferred[] = { "RGBA", "RGB", "Y" };

// One component of an array, which a channel of the file fills.
struct Place {
  std::string Array;
  int Component;
};

// A file that is open, and the names, sizes and bytes of its first part.
class File
{
public:
  explicit File(const std::string& path);
  ~File() { exr_finish(&this->Context); }
  File(const File&) = delete;
  void operator=(const File&) = delete;

  int Width = 0, Height = 0;
  std::vector<std::string> Channels;

  // Fills the arrays, each with all rows from the bottom up. `done` gets the fraction that is done, 0..1, and may throw.
  template <typename Function>
  void Read(const std::map<std::string, Place>& places, const std::map<std::string, vtkFloatArray*>& arrays, Function done);

private:
  static void OnError(exr_const_context_t context, exr_result_t, const char* message) noexcept;
  void Check(exr_result_t result) const;
  void CheckChannels();
  void CheckChunk(const exr_decode_pipeline_t& pipeline, int top) const;

  exr_context_t Context = nullptr;
  std::string Path;
  char Message[256] = "";
};

File::File(const std::string& path) : Path(path)
{
  exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
  start.user_data = this;
  start.error_handler_fn = File::OnError;
  this->Check(exr_start_read(&this->Context, path.c_str(), &start));
  try {
    exr_storage_t storage = EXR_STORAGE_TILED;
    this->Check(exr_get_storage(this->Context, 0, &storage));
    if (storage != EXR_STORAGE_SCANLINE) {
      throw Stop(path + " holds " + (storage == EXR_STORAGE_TILED ? "tiles" : "deep pixels") + ", must hold scan lines");
    }
    exr_attr_box2i_t window = {};
    this->Check(exr_get_data_window(this->Context, 0, &window));
    const auto width = static_cast<int64_t>(window.max.x) - window.min.x + 1,
               height = static_cast<int64_t>(window.max.y) - window.min.y + 1;
    // A byte that zlib has compressed holds 1,032 at most: a larger picture than that is not in the file.
    const auto most = 1032 * static_cast<int64_t>(std::filesystem::file_size(path));
    if (width < 1 || height < 1 || width > most || height > most / width) {
      throw Stop(path + " has a header for " + std::to_string(width) + " x " + std::to_string(height) + " pixels, which are not in it");
    }
    this->Width = static_cast<int>(width);
    this->Height = static_cast<int>(height);
    this->CheckChannels();
  } catch (...) {
    exr_finish(&this->Context);
    throw;
  }
}

void File::OnError(exr_const_context_t context, exr_result_t, const char* message) noexcept
{
  void* self = nullptr;
  if (exr_get_user_data(context, &self) == EXR_ERR_SUCCESS && self && message) {
    File* file = static_cast<File*>(self);
    std::strncpy(file->Message, message, sizeof file->Message - 1);
  }
}

void File::Check(exr_result_t result) const
{
  if (result == EXR_ERR_OUT_OF_MEMORY) {
    throw std::bad_alloc();
  }
  if (result != EXR_ERR_SUCCESS) {
    throw Stop("can't read " + this->Path + ": " + (this->Message[0] ? this->Message : exr_get_default_error_message(result)));
  }
}

void File::CheckChannels()
{
  const exr_attr_chlist_t* list = nullptr;
  this->Check(exr_get_channels(this->Context, 0, &list));
  if (list->num_channels < 1) {
    throw Stop(this->Path + " has no channel");
  }
  for (int c = 0; c < list->num_channels; ++c) {
    const exr_attr_chlist_entry_t& entry = list->entries[c];
    const std::string name(entry.name.str, static_cast<size_t>(entry.name.length));
    if (entry.pixel_type == EXR_PIXEL_UINT) {
      throw Stop(this->Path + ": channel '" + name + "' is of integers, floats and halves are read");
    }
    if (entry.x_sampling != 1 || entry.y_sampling != 1) {
      throw Stop(this->Path + ": channel '" + name + "' has a value for " + std::to_string(entry.x_sampling) + " x " +
        std::to_string(entry.y_sampling) + " pixels, there must be one for each");
    }
    this->Channels.push_back(name);
  }
}

// Damaged files may describe chunks that are elsewhere or larger than the buffer.
void File::CheckChunk(const exr_decode_pipeline_t& pipeline, int top) const
{
  exr_attr_box2i_t window = {};
  this->Check(exr_get_data_window(this->Context, 0, &window));
  const exr_chunk_info_t& chunk = pipeline.chunk;
  bool good = chunk.start_x == window.min.x && chunk.start_y == window.min.y + top && chunk.width == this->Width && chunk.height > 0 &&
    chunk.height <= this->Height - top && pipeline.channel_count == static_cast<int>(this->Channels.size());
  for (int16_t c = 0; good && c < pipeline.channel_count; ++c) {
    good = pipeline.channels[c].width == chunk.width && pipeline.channels[c].height == chunk.height;
  }
  if (!good) {
    throw Stop("can't read " + this->Path + ": the rows from " + std::to_string(top) + " on differ from the file's header");
  }
}

template <typename Function>
void File::Read(const std::map<std::string, Place>& places, const std::map<std::string, vtkFloatArray*>& arrays, Function done)
{
  struct Pipeline : exr_decode_pipeline_t {
    Pipeline() : exr_decode_pipeline_t() {}
    ~Pipeline()
    {
      if (this->context) {
        exr_decoding_destroy(this->context, this);
      }
    }
  };
  exr_attr_box2i_t window = {};
  this->Check(exr_get_data_window(this->Context, 0, &window));
  int32_t lines = 0;
  this->Check(exr_get_scanlines_per_chunk(this->Context, 0, &lines));
  if (lines < 1) {
    throw Stop("can't read " + this->Path + ": its chunks have " + std::to_string(lines) + " rows");
  }
  std::vector<float> values(this->Channels.size() * static_cast<size_t>(std::min(lines, this->Height)) * static_cast<size_t>(this->Width));
  for (int top = 0; top < this->Height; top += lines) {
    Pipeline pipeline;
    exr_chunk_info_t chunk;
    this->Check(exr_read_scanline_chunk_info(this->Context, 0, window.min.y + top, &chunk));
    this->Check(exr_decoding_initialize(this->Context, 0, &chunk, &pipeline));
    this->CheckChunk(pipeline, top);
    const size_t size = static_cast<size_t>(pipeline.chunk.height) * static_cast<size_t>(this->Width);
    for (int16_t c = 0; c < pipeline.channel_count; ++c) {
      exr_coding_channel_info_t& info = pipeline.channels[c];
      info.decode_to_ptr = reinterpret_cast<uint8_t*>(values.data() + static_cast<size_t>(c) * size);
      info.user_data_type = EXR_PIXEL_FLOAT;
      info.user_bytes_per_element = sizeof(float);
      info.user_pixel_stride = sizeof(float);
      info.user_line_stride = static_cast<int32_t>(sizeof(float)) * this->Width;
    }
    this->Check(exr_decoding_choose_default_routines(this->Context, 0, &pipeline));
    this->Check(exr_decoding_run(this->Context, 0, &pipeline));
    for (int16_t c = 0; c < pipeline.channel_count; ++c) {
      const Place& place = places.at(pipeline.channels[c].channel_name);
      vtkFloatArray* array = arrays.at(place.Array);
      const float* from = values.data() + static_cast<size_t>(c) * size;
      for (int y = 0; y < pipeline.chunk.height; ++y) {
        const vtkIdType row = static_cast<vtkIdType>(this->Height - 1 - top - y) * this->Width;
        for (int x = 0; x < this->Width; ++x, ++from) {
          array->SetTypedComponent(row + x, place.Component, *from);
        }
      }
    }
    done(static_cast<double>(top + pipeline.chunk.height) / this->Height);
  }
}

// Finds the base of "base.N"; N is the component. Returns false for another name.
bool IsComponent(const std::string& name, std::string& base, int& component)
{
  const size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == name.size() || name.size() > dot + 4 ||
    !std::all_of(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end(), [](unsigned char c) { return std::isdigit(c) != 0; }) ||
    (name[dot + 1] == '0' && name.size() > dot + 2)) {
    return false;
  }
  base = name.substr(0, dot);
  component = std::stoi(name.substr(dot + 1));
  return true;
}

std::map<std::string, Place> PlaceChannels(const std::vector<std::string>& channels)
{
  const auto has = [&channels](const std::string& name) { return std::find(channels.begin(), channels.end(), name) != channels.end(); };
  const bool rgb = has("R") && has("G") && has("B"), rgba = rgb && has("A");
  std::map<std::string, Place> places;
  for (const std::string& name : channels) {
    const size_t color = name.size() == 1 ? std::string("RGBA").find(name) : std::string::npos;
    std::string base;
    int component = 0;
    if (color < (rgba ? 4u : rgb ? 3u : 0u)) {
      places[name] = { rgba ? "RGBA" : "RGB", static_cast<int>(color) };
    } else if (name == "Z" && !has("Depth")) {
      places[name] = { "Depth", 0 };
    } else if (IsComponent(name, base, component) && !has(base) && base != "RGBA" && base != "RGB" && base != "Depth") {
      places[name] = { base, component };
    } else {
      places[name] = { name, 0 };
    }
  }
  // A vector that lacks a component is none: its channels are arrays of their own.
  std::map<std::string, int> counts, highest;
  for (const auto& one : places) {
    ++counts[one.second.Array];
    highest[one.second.Array] = std::max(highest[one.second.Array], one.second.Component);
  }
  for (auto& one : places) {
    if (highest[one.second.Array] + 1 != counts[one.second.Array]) {
      one.second = { one.first, 0 };
    }
  }
  return places;
}
} // namespace

vtkStratusEXRReader::vtkStratusEXRReader()
{
  this->SetNumberOfInputPorts(0);
}

vtkStratusEXRReader::~vtkStratusEXRReader()
{
  this->SetFileName(nullptr);
}

int vtkStratusEXRReader::CanReadFile(const char* path)
{
  std::FILE* file = path ? std::fopen(path, "rb") : nullptr;
  unsigned char start[4] = {};
  const bool whole = file && std::fread(start, 1, sizeof start, file) == sizeof start;
  if (file) {
    std::fclose(file);
  }
  return whole && std::memcmp(start, Magic, sizeof start) == 0 ? 1 : 0;
}

template <typename Function> int vtkStratusEXRReader::Try(Function read)
{
  this->SetErrorCode(vtkErrorCode::NoError);
  try {
    if (!this->FileName || !this->FileName[0]) {
      throw Stop("FileName is not set");
    }
    std::error_code error;
    if (!std::filesystem::is_regular_file(this->FileName, error)) {
      this->SetErrorCode(vtkErrorCode::FileNotFoundError);
      throw Stop(std::string("there is no file ") + this->FileName);
    }
    read(this->FileName);
    return 1;
  } catch (const std::bad_alloc&) {
    vtkErrorMacro(<< "out of memory while reading " << this->FileName);
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
  }
  if (this->GetErrorCode() == vtkErrorCode::NoError) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
  }
  return 0;
}

int vtkStratusEXRReader::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  return this->Try([outputs](const char* path) {
    const File file(path);
    const int extent[6] = { 0, file.Width - 1, 0, file.Height - 1, 0, 0 };
    vtkInformation* info = outputs->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    const double origin[3] = { 0.0, 0.0, 0.0 }, spacing[3] = { 1.0, 1.0, 1.0 };
    info->Set(vtkDataObject::ORIGIN(), origin, 3);
    info->Set(vtkDataObject::SPACING(), spacing, 3);
    vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, -1);
  });
}

int vtkStratusEXRReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkImageData* output = vtkImageData::GetData(outputs);
  output->Initialize();
  vtkNew<vtkImageData> made;
  const int good = this->Try([this, &made](const char* path) {
    File file(path);
    made->SetDimensions(file.Width, file.Height, 1);
    const std::map<std::string, Place> places = PlaceChannels(file.Channels);
    std::map<std::string, int> components;
    for (const auto& one : places) {
      components[one.second.Array] = std::max(components[one.second.Array], one.second.Component + 1);
    }
    std::map<std::string, vtkFloatArray*> arrays;
    for (const auto& one : components) {
      vtkNew<vtkFloatArray> array;
      array->SetName(one.first.c_str());
      array->SetNumberOfComponents(one.second);
      array->SetNumberOfTuples(made->GetNumberOfPoints());
      made->GetPointData()->AddArray(array);
      arrays[one.first] = array;
    }
    file.Read(places, arrays, [this](double fraction) {
      this->UpdateProgress(fraction);
      if (this->GetAbortExecute()) {
        this->SetErrorCode(vtkErrorCode::UserError);
        throw Stop(std::string("reading ") + this->FileName + " was aborted");
      }
    });
    const auto active =
      std::find_if(std::begin(Preferred), std::end(Preferred), [&arrays](const char* name) { return arrays.count(name) > 0; });
    made->GetPointData()->SetActiveScalars(active != std::end(Preferred) ? *active : made->GetPointData()->GetArrayName(0));
  });
  if (good) {
    output->ShallowCopy(made);
  }
  return good;
}

void vtkStratusEXRReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}
