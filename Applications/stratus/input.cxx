// SPDX-License-Identifier: BSD-3-Clause
#include "input.h"

#include "reading.h"

#include "vtkStratusArrays.h"
#include "vtkStratusTetGenReader.h"

#include <vtkAlgorithmOutput.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSetReader.h>
#include <vtkImageReader2.h>
#include <vtkImageReader2Factory.h>
#include <vtkMatrix3x3.h>
#include <vtkMetaImageReader.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkNrrdReader.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPImageDataReader.h>
#include <vtkXMLPUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <sstream>
#include <sys/stat.h>

namespace {

// Collects all messages of VTK. Readers also report through objects of their own (parsers, decompressors), whose messages pass here, too.
class listener : public vtkOutputWindow
{
public:
  static listener* New();
  vtkTypeMacro(listener, vtkOutputWindow);
  void DisplayText(const char* text) override { this->Heard += text ? text : ""; }
  std::string Heard;

protected:
  listener() = default;
};
vtkStandardNewMacro(listener);

// Collects messages while it lives, also from std::cerr, where VTK's MetaIO alone reports that a file was cut short.
class listening
{
public:
  listening() : Before(vtkOutputWindow::GetInstance()), Stream(std::cerr.rdbuf(this->Text.rdbuf()))
  {
    vtkOutputWindow::SetInstance(this->Now);
  }
  ~listening()
  {
    vtkOutputWindow::SetInstance(this->Before);
    std::cerr.rdbuf(this->Stream);
  }
  listening(const listening&) = delete;
  listening& operator=(const listening&) = delete;
  std::string heard() const { return this->Now->Heard + this->Text.str(); }

private:
  vtkSmartPointer<vtkOutputWindow> Before;
  vtkNew<listener> Now;
  std::ostringstream Text;
  std::streambuf* Stream;
};

// Extracts the message. VTK puts "ERROR: In file, line n\nvtkClass (0x..): " before it.
std::string first_message(const std::string& heard)
{
  size_t at = heard.find("): ");
  std::string text = heard.substr(at == std::string::npos ? 0 : at + 3);
  text = text.substr(0, text.find("\n\n"));
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') {
    text.pop_back();
  }
  return text;
}

std::string extension_of(const std::string& path)
{
  std::string name = path.substr(path.find_last_of('/') + 1);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.size() > 7 && name.compare(name.size() - 7, 7, ".nii.gz") == 0) {
    return ".nii";
  }
  const size_t dot = name.find_last_of('.');
  return dot == std::string::npos ? "" : name.substr(dot);
}

template <class Reader> vtkSmartPointer<vtkAlgorithm> reader_for(const std::string& path)
{
  auto reader = vtkSmartPointer<Reader>::New();
  reader->SetFileName(path.c_str());
  return reader;
}

vtkSmartPointer<vtkAlgorithm> choose_reader(const std::string& path)
{
  const std::string extension = extension_of(path);
  if (extension == ".vti") {
    return reader_for<vtkXMLImageDataReader>(path);
  }
  if (extension == ".pvti") {
    return reader_for<vtkXMLPImageDataReader>(path);
  }
  if (extension == ".vtu") {
    return reader_for<vtkXMLUnstructuredGridReader>(path);
  }
  if (extension == ".pvtu") {
    return reader_for<vtkXMLPUnstructuredGridReader>(path);
  }
  if (cli::is_tetgen(path)) {
    return reader_for<vtkStratusTetGenReader>(path);
  }
  if (extension == ".vtk") {
    return reader_for<vtkDataSetReader>(path);
  }
  if (extension == ".mha" || extension == ".mhd") {
    return reader_for<vtkMetaImageReader>(path);
  }
  if (extension == ".nrrd" || extension == ".nhdr") {
    return reader_for<vtkNrrdReader>(path);
  }
  if (extension == ".nii") {
    return reader_for<vtkNIFTIImageReader>(path);
  }
  vtkSmartPointer<vtkImageReader2> other;
  other.TakeReference(vtkImageReader2Factory::CreateImageReader2(path.c_str()));
  if (other) {
    other->SetFileName(path.c_str());
  }
  return other;
}

void check_file(const std::string& path)
{
  struct stat status;
  FILE* file = std::fopen(path.c_str(), "rb");
  const int reason = errno;
  if (!file) {
    throw cli::failure("cannot read '" + path + "': " + std::strerror(reason));
  }
  const bool folder = fstat(fileno(file), &status) == 0 && S_ISDIR(status.st_mode);
  std::fclose(file);
  if (folder) {
    throw cli::failure("cannot read '" + path + "': it is a folder");
  }
}

vtkDataArray* first_single(vtkDataSetAttributes* data)
{
  vtkDataArray* active = data->GetScalars();
  for (int i = 0; !active && i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = data->GetArray(i);
    if (array && array->GetNumberOfComponents() == 1 && std::strcmp(array->GetName() ? array->GetName() : "", "vtkGhostType") != 0) {
      active = array;
    }
  }
  return active;
}

std::string names_of(vtkDataSet* image)
{
  std::string names;
  for (vtkDataSetAttributes* data :
    { static_cast<vtkDataSetAttributes*>(image->GetPointData()), static_cast<vtkDataSetAttributes*>(image->GetCellData()) }) {
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
      names += std::string(names.empty() ? "" : ", ") + (data->GetArrayName(i) ? data->GetArrayName(i) : "(unnamed)");
    }
  }
  return names.empty() ? "none" : names;
}

bool is_scene(const std::string& name)
{
  for (int i = 0; i < stratus_scene_count(); ++i) {
    if (name == stratus_scene_name(i)) {
      return true;
    }
  }
  return false;
}

std::string scene_names()
{
  std::string names;
  for (int i = 0; i < stratus_scene_count(); ++i) {
    names += std::string(i ? ", " : "") + stratus_scene_name(i);
  }
  return names;
}
} // namespace

namespace cli {

bool is_tetgen(const std::string& path)
{
  const std::string extension = extension_of(path);
  return extension == ".node" || extension == ".ele" || extension == ".face" || extension == ".edge" || extension == ".neigh";
}

vtkSmartPointer<vtkDataObject> read_data(const std::string& path)
{
  reading watched(path, "VTK");
  check_file(path);
  listening listener;
  vtkSmartPointer<vtkAlgorithm> reader = choose_reader(path);
  if (!reader) {
    throw failure("'" + path + "' is no image file that VTK reads (.vti .pvti .vtk .mha .mhd .nrrd .nhdr .nii .tif .png ...) " +
      "and no grid (.vtu .pvtu .vtk .node .ele)");
  }
  watched.follow(reader);
  try {
    reader->Update();
  } catch (const std::bad_alloc&) {
    throw failure("cannot read '" + path + "': " + reader->GetClassName() + " wants more memory than there is");
  } catch (const std::exception& error) {
    throw failure("cannot read '" + path + "': " + reader->GetClassName() + " failed: " + error.what());
  }
  const std::string heard = listener.heard();
  if (!heard.empty()) {
    throw failure("cannot read '" + path + "': " + first_message(heard));
  }
  return reader->GetOutputDataObject(0);
}

vtkSmartPointer<vtkImageData> read_image(const std::string& path)
{
  const vtkSmartPointer<vtkDataObject> output = read_data(path);
  vtkImageData* image = vtkImageData::SafeDownCast(output);
  if (!image) {
    throw failure("'" + path + "' holds " + (output ? output->GetClassName() : "nothing") + ", not an image (vtkImageData)");
  }
  if (image->GetNumberOfPoints() < 1) {
    throw failure("'" + path + "' holds an empty image");
  }
  return image;
}

vtkDataArray* choose_array(vtkDataSet* data_set, const std::string& name, bool& on_cells)
{
  vtkDataArray* array = nullptr;
  for (bool cells : { false, true }) {
    vtkDataSetAttributes* data = cells ? static_cast<vtkDataSetAttributes*>(data_set->GetCellData()) : data_set->GetPointData();
    array = name.empty() ? first_single(data) : data->GetArray(name.c_str());
    if (array) {
      on_cells = cells;
      break;
    }
  }
  if (!array) {
    throw failure((name.empty() ? std::string("no array to draw") : "no array '" + name + "'") + "; the arrays are: " + names_of(data_set));
  }
  const std::string label = array->GetName() ? array->GetName() : "(unnamed)";
  if (array->GetNumberOfComponents() != 1) {
    throw failure("array '" + label + "' has " + std::to_string(array->GetNumberOfComponents()) + " components; one is drawn");
  }
  const vtkIdType expected = on_cells ? data_set->GetNumberOfCells() : data_set->GetNumberOfPoints();
  if (array->GetNumberOfTuples() != expected) {
    throw failure("array '" + label + "' has " + std::to_string(array->GetNumberOfTuples()) + " values for " + std::to_string(expected) +
      (on_cells ? " cells" : " points"));
  }
  return array;
}

bool stratus_type_of(vtkDataArray* array, stratus_type& type)
{
  const int vtk = array->GetDataType();
  if (vtk == VTK_FLOAT || vtk == VTK_DOUBLE) {
    type = vtk == VTK_FLOAT ? STRATUS_FLOAT32 : STRATUS_FLOAT64;
    return true;
  }
  const bool is_signed = array->GetDataTypeMin() < 0.0;
  switch (vtk == VTK_BIT ? 0 : array->GetDataTypeSize()) {
    case 1:
      type = is_signed ? STRATUS_INT8 : STRATUS_UINT8;
      return true;
    case 2:
      type = is_signed ? STRATUS_INT16 : STRATUS_UINT16;
      return true;
    case 4:
      type = is_signed ? STRATUS_INT32 : STRATUS_UINT32;
      return true;
    case 8:
      type = is_signed ? STRATUS_INT64 : STRATUS_UINT64;
      return true;
    default:
      return false;
  }
}

const char* name_of(stratus_type type)
{
  static const char* const names[] = { "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64" };
  return names[type];
}

std::string describe(const stratus_volume& v)
{
  return format("%lld x %lld x %lld %s on %s, spacing %g x %g x %g", static_cast<long long>(v.dimensions[0]),
    static_cast<long long>(v.dimensions[1]), static_cast<long long>(v.dimensions[2]), name_of(v.type), v.cell_centered ? "cells" : "points",
    v.spacing[0], v.spacing[1], v.spacing[2]);
}

stratus_volume view_of(vtkImageData* image, vtkDataArray* array, bool on_cells)
{
  stratus_volume volume = stratus_volume_default();
  int extent[6];
  image->GetExtent(extent);
  if (!stratus_type_of(array, volume.type)) {
    throw failure(std::string("array '") + (array->GetName() ? array->GetName() : "") + "' holds " + array->GetDataTypeAsString() +
      " values; numbers of 8 to 64 bits are drawn");
  }
  bool sheet = false;
  double first[3];
  for (int a = 0; a < 3; ++a) {
    const int64_t points = static_cast<int64_t>(extent[2 * a + 1]) - extent[2 * a] + 1;
    volume.dimensions[a] = on_cells ? std::max<int64_t>(points - 1, 1) : points;
    volume.spacing[a] = image->GetSpacing()[a];
    sheet = sheet || (!on_cells && points == 1);
  }
  volume.cell_centered = on_cells || sheet;
  for (int a = 0; a < 3; ++a) {
    first[a] = volume.spacing[a] * (extent[2 * a] - (sheet ? 0.5 : 0.0));
  }
  const double* direction = image->GetDirectionMatrix()->GetData();
  for (int r = 0; r < 3; ++r) {
    volume.origin[r] = image->GetOrigin()[r];
    for (int c = 0; c < 3; ++c) {
      volume.direction[3 * r + c] = direction[3 * r + c];
      volume.origin[r] += direction[3 * r + c] * first[c];
    }
  }
  const auto ghosts = [](vtkDataSetAttributes* data, vtkIdType count, const char* things) -> const uint8_t* {
    vtkUnsignedCharArray* flags = nullptr;
    std::string error;
    if (!vtkStratusFindGhosts(data, count, things, flags, error)) {
      throw failure(error);
    }
    return flags ? flags->GetPointer(0) : nullptr;
  };
  const uint8_t* point_ghosts = ghosts(image->GetPointData(), image->GetNumberOfPoints(), "points of the image");
  const uint8_t* cell_ghosts = ghosts(image->GetCellData(), image->GetNumberOfCells(), "cells of the image");
  volume.point_ghosts = on_cells || sheet ? nullptr : point_ghosts;
  volume.cell_ghosts = sheet ? nullptr : cell_ghosts;
  volume.values = array->GetVoidPointer(0);
  return volume;
}

input::input(context& core, const std::string& source, const std::string& array) : Core(core)
{
  struct stat status;
  const bool exists = stat(source.c_str(), &status) == 0;
  if (!exists && is_scene(source)) {
    if (!array.empty()) {
      throw usage("--array: the scene '" + source + "' has only one");
    }
    core.check(stratus_scene_create(core, source.c_str(), &this->scene), "scene '" + source + "'");
    this->volume = this->scene->volume;
    this->volume.components = 1; // options describe one transfer function: of two pollutants, the first is drawn
    this->up_axis = this->scene->up_axis;
    this->array_name = source;
    return;
  }
  if (!exists && source.find_first_of("./") == std::string::npos) {
    throw failure("'" + source + "' is neither a file nor a scene (" + scene_names() + ")");
  }
  this->image = read_image(source);
  bool on_cells = false;
  vtkDataArray* values = choose_array(this->image, array, on_cells);
  this->volume = view_of(this->image, values, on_cells);
  this->array_name = values->GetName() ? values->GetName() : "(unnamed)";
  core.check(stratus_volume_check(core, &this->volume), "'" + source + "'");
}

input::~input()
{
  stratus_scene_destroy(this->Core, this->scene);
}
} // namespace cli
