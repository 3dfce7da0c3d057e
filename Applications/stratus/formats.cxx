// SPDX-License-Identifier: BSD-3-Clause
#include "formats.h"

#include "support.h"
#include "vectors.h"

#include "vtkStratusCFReader.h"
#ifdef STRATUS_HDF5
#include "vtkStratusHDF5Reader.h"
#endif
#include "vtkStratusImageReader.h"
#include "vtkStratusNetCDFReader.h"
#include "vtkStratusTIFFFile.h"
#include "vtkStratusTetGenReader.h"
#ifdef STRATUS_NETCDF
#include "vtkStratusUgridReader.h"
#endif
#ifdef STRATUS_VDB
#include "vtkStratusVDBReader.h"
#endif
#include "vtkStratusVariableReader.h"
#include "vtkStratusXMLImageReader.h"
#include "vtkStratusZarrReader.h"

#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkCellData.h>
#include <vtkCompositeDataSet.h>

#include <vtkDataSetReader.h>
#include <vtkGenericEnSightReader.h>
#include <vtkHDFReader.h>
#include <vtkImageReader2.h>
#include <vtkImageReader2Factory.h>
#include <vtkOpenFOAMReader.h>
#include <vtkPointData.h>
#include <vtkVersionMacros.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLMultiBlockDataReader.h>
#include <vtkXMLPImageDataReader.h>
#include <vtkXMLPRectilinearGridReader.h>
#include <vtkXMLPStructuredGridReader.h>
#include <vtkXMLPUnstructuredGridReader.h>
#include <vtkXMLRectilinearGridReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUniformGridAMRReader.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <system_error>

namespace {

using made = vtkSmartPointer<vtkAlgorithm>;

template <class Reader> made reader_for(const std::string& path)
{
  auto reader = vtkSmartPointer<Reader>::New();
  reader->SetFileName(path.c_str());
  return reader;
}

// Polyhedra are not decomposed, because the mappers divide them conformingly. Readers later than VTK 9.2's do not decompose them either.
made openfoam(const std::string& path)
{
  auto reader = vtkSmartPointer<vtkOpenFOAMReader>::New();
  reader->SetFileName(path.c_str());
#if VTK_VERSION_NUMBER < VTK_VERSION_CHECK(9, 3, 0)
  reader->DecomposePolyhedraOff();
#endif
  return reader;
}

made ensight(const std::string& path)
{
  auto reader = vtkSmartPointer<vtkGenericEnSightReader>::New();
  reader->SetCaseFileName(path.c_str());
  reader->ReadAllVariablesOn();
  return reader;
}

made netcdf(const std::string& path)
{
#ifdef STRATUS_NETCDF
  if (vtkStratusUgridReader::CanReadFile(path.c_str())) {
    return reader_for<vtkStratusUgridReader>(path);
  }
  auto reader = vtkSmartPointer<vtkStratusCFReader>::New();
  reader->SetFileName(path.c_str());
  reader->MapFileOn(); // its values go to nobody but the core
  return reader;
#else
  throw cli::failure(
    "cannot read '" + path + "': this program was built without libnetcdf (Debian: libnetcdf-dev), which reads netCDF files");
#endif
}

made zarr(const std::string& path)
{
  auto reader = vtkSmartPointer<vtkStratusZarrReader>::New();
  reader->SetFileName(path.c_str());
  reader->MapFileOn(); // as of netCDF
  return reader;
}

// Images by our reader, which leaves values in the file; other grids, and files that are damaged, by VTK's.
made hdf(const std::string& path)
{
#ifdef STRATUS_HDF5
  if (vtkStratusHDF5Reader::CanReadFile(path.c_str())) {
    auto reader = vtkSmartPointer<vtkStratusHDF5Reader>::New();
    reader->SetFileName(path.c_str());
    reader->MapFileOn(); // as of netCDF
    return reader;
  }
#endif
  return reader_for<vtkHDFReader>(path);
}

// Values that are raw bytes by our reader, which leaves them in the file; others, and files that are damaged, by VTK's.
made vti(const std::string& path)
{
  if (vtkStratusXMLImageReader::CanReadFile(path.c_str())) {
    auto reader = vtkSmartPointer<vtkStratusXMLImageReader>::New();
    reader->SetFileName(path.c_str());
    reader->MapFileOn(); // as of netCDF
    return reader;
  }
  return reader_for<vtkXMLImageDataReader>(path);
}

made vdb(const std::string& path)
{
#ifdef STRATUS_VDB
  auto reader = vtkSmartPointer<vtkStratusVDBReader>::New();
  reader->SetFileName(path.c_str());
  reader->MapFileOn(); // as of netCDF, but images that it would read at once are quicker so
  reader->SetMappedBytesLeast(reader->GetMemoryLimit() << 20);
  return reader;
#else
  throw cli::failure("cannot read '" + path + "': this program was built without OpenVDB and NanoVDB (Debian: libopenvdb-dev, " +
    "libnanovdb-dev), which read .vdb and .nvdb files");
#endif
}

// A type of --raw, or nullptr.
struct raw_type {
  const char* name;
  int vtk;
  size_t bytes;
};
const raw_type* raw_type_named(const std::string& name)
{
  static constexpr raw_type types[] = { { "int8", VTK_SIGNED_CHAR, 1 }, { "uint8", VTK_UNSIGNED_CHAR, 1 }, { "int16", VTK_SHORT, 2 },
    { "uint16", VTK_UNSIGNED_SHORT, 2 }, { "int32", VTK_INT, 4 }, { "uint32", VTK_UNSIGNED_INT, 4 }, { "float32", VTK_FLOAT, 4 },
    { "float64", VTK_DOUBLE, 8 } };
  const auto found = std::find_if(std::begin(types), std::end(types), [&](const raw_type& one) { return name == one.name; });
  return found == std::end(types) ? nullptr : found;
}

// The three numbers of "A<separator>B<separator>C".
void three(const std::string& text, char separator, double low, double numbers[3])
{
  const std::vector<std::string> words = cli::split(text, separator);
  for (size_t a = 0; a < 3; ++a) {
    numbers[a] = words.size() == 3 ? cli::number(words[a], "--raw") : 0.0;
    if (words.size() != 3 || numbers[a] < low || (low >= 1.0 && (numbers[a] != std::floor(numbers[a]) || numbers[a] > 2147483647.0))) {
      throw cli::usage("--raw: '" + text + "' must be three numbers of at least " + cli::format("%g", low));
    }
  }
}

made raw_reader(const std::string& path, const std::string& raw)
{
  const std::vector<std::string> words = cli::split(raw, ':');
  const raw_type* type = words.size() > 1 ? raw_type_named(words[1]) : nullptr;
  double size[3], spacing[3] = { 1.0, 1.0, 1.0 }, skip = 0.0;
  if (!type) {
    throw cli::usage("--raw: '" + raw + "' is not NXxNYxNZ:TYPE with a type int8, uint8, int16, uint16, int32, uint32, float32 or float64");
  }
  three(words[0], 'x', 1.0, size);
  auto reader = vtkSmartPointer<vtkStratusImageReader>::New();
  bool big = false;
  for (size_t i = 2; i < words.size(); ++i) {
    if (words[i] == "big") {
      big = true;
    } else if (words[i].compare(0, 1, "+") == 0) {
      skip = cli::whole_number(words[i].substr(1), "--raw", 0, 2147483647);
    } else if (words[i] != "little") {
      three(words[i], ',', 1e-300, spacing);
    }
  }
  const double needed = skip + size[0] * size[1] * size[2] * static_cast<double>(type->bytes);
  std::error_code error;
  const std::uintmax_t there = std::filesystem::file_size(path, error);
  if (error || static_cast<double>(there) != needed) {
    throw cli::failure("cannot read '" + path + "': --raw " + raw + cli::format(" needs %.0f bytes, the file has ", needed) +
      (error ? std::string("no length") : std::to_string(there)));
  }
  reader->SetFileName(path.c_str());
  const int sizes[3] = { static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2]) };
  reader->SetRawLayout(sizes, type->vtk, big, spacing, static_cast<vtkTypeInt64>(skip));
  return reader;
}

made refined(const std::string& path)
{
  auto reader = vtkSmartPointer<vtkXMLUniformGridAMRReader>::New();
  reader->SetFileName(path.c_str());
  reader->SetMaximumLevelsToReadByDefault(0); // all of them
  return reader;
}

constexpr struct {
  const char* extension;
  made (*make)(const std::string& path);
} formats[] = {
  { ".vti", vti },
  { ".pvti", reader_for<vtkXMLPImageDataReader> },
  { ".vtr", reader_for<vtkXMLRectilinearGridReader> },
  { ".pvtr", reader_for<vtkXMLPRectilinearGridReader> },
  { ".vts", reader_for<vtkXMLStructuredGridReader> },
  { ".pvts", reader_for<vtkXMLPStructuredGridReader> },
  { ".vtu", reader_for<vtkXMLUnstructuredGridReader> },
  { ".pvtu", reader_for<vtkXMLPUnstructuredGridReader> },
  { ".vtm", reader_for<vtkXMLMultiBlockDataReader> },
  { ".vtmb", reader_for<vtkXMLMultiBlockDataReader> },
  { ".vthb", refined },
  { ".vth", refined },
  { ".vtk", reader_for<vtkDataSetReader> },
  { ".vtkhdf", hdf },
  { ".hdf", hdf },
  { ".h5", hdf },
  { ".hdf5", hdf },
  { ".nc", netcdf },
  { ".nc4", netcdf },
  { ".cdf", netcdf },
  { ".vdb", vdb },
  { ".nvdb", vdb },
  { ".foam", openfoam },
  { "controldict", openfoam },
  { ".case", ensight },
  { ".encas", ensight },
  { ".mha", reader_for<vtkStratusImageReader> },
  { ".mhd", reader_for<vtkStratusImageReader> },
  { ".nrrd", reader_for<vtkStratusImageReader> },
  { ".nhdr", reader_for<vtkStratusImageReader> },
  { ".nii", reader_for<vtkStratusImageReader> },
};

// Refuses what a reader would put elsewhere than the file says.
void check_orientation(vtkImageReader2* reader, const std::string& path)
{
  const int orientation = vtkStratusTIFFOrientation(path);
  if (orientation > 1) {
    throw cli::failure("cannot read '" + path + "': the TIFF tag Orientation is " + std::to_string(orientation) +
      "; only 1 is read, the first row at the top and the first column at the left");
  }
  if (reader->IsA("vtkGESignaReader")) {
    throw cli::failure(
      "cannot read '" + path + "': VTK's reader of GE Signa files leaves their orientation out; convert it to NIfTI or NRRD");
  }
}

// The reader's variable of that name, or the one whose component it names; "" where there is none.
std::string name_in(vtkStratusVariableReader* reader, const std::string& name)
{
  const std::string vectors = cli::vector_part_of(name).array;
  std::string found;
  for (int i = 0; i < reader->GetNumberOfVariables(); ++i) {
    const std::string one = reader->GetNameOfVariable(i);
    if (one == name) {
      return one;
    }
    found = one == vectors ? one : found;
  }
  return found;
}
} // namespace

namespace cli {

std::string extension_of(const std::string& path)
{
  std::string name = path.substr(path.find_last_of('/') + 1);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.size() > 3 && name.compare(name.size() - 3, 3, ".gz") == 0) { // NIfTI's, of which the extension comes before
    const std::string inner = extension_of(name.substr(0, name.size() - 3));
    return inner == ".nii" || inner == ".hdr" || inner == ".img" ? inner : ".gz";
  }
  const size_t dot = name.find_last_of('.');
  return name == "controldict" ? name : dot == std::string::npos ? "" : name.substr(dot);
}

bool is_tetgen(const std::string& path)
{
  const std::string extension = extension_of(path);
  return extension == ".node" || extension == ".ele" || extension == ".face" || extension == ".edge" || extension == ".neigh";
}

bool is_zarr(const std::string& path)
{
  return vtkStratusZarrReader::CanReadFile(path.c_str());
}

bool is_collection(const std::string& path)
{
  return extension_of(path) == ".pvd";
}

file_format choose_format(const std::string& path, const std::string& raw)
{
  const std::string extension = extension_of(path);
  if (!raw.empty()) {
    return { raw_reader(path, raw), "" };
  }
  if (extension == ".raw") {
    throw usage("'" + path + "' does not describe itself: give --raw NXxNYxNZ:TYPE[:big][:DX,DY,DZ][:+BYTES BEFORE]");
  }
  if (is_zarr(path)) {
    return { zarr(path), "" };
  }
  for (const auto& known : formats) {
    if (extension == known.extension) {
      return { known.make(path), known.make == openfoam ? "s" : "" };
    }
  }
  if (is_tetgen(path)) {
    return { reader_for<vtkStratusTetGenReader>(path), "" };
  }
  if (vtkStratusImageReader::CanReadFile(path.c_str())) { // .hdr and .img, or under another name
    return { reader_for<vtkStratusImageReader>(path), "" };
  }
  vtkSmartPointer<vtkImageReader2> other;
  other.TakeReference(vtkImageReader2Factory::CreateImageReader2(path.c_str()));
  if (other) {
    check_orientation(other, path);
    other->SetFileName(path.c_str());
  }
  return { other, "" };
}

std::string time_units_of(vtkAlgorithm* reader)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  return by_name ? by_name->GetTimeUnits() : "";
}

std::string time_calendar_of(vtkAlgorithm* reader)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  return by_name ? by_name->GetTimeCalendar() : "";
}

std::string description_of(vtkAlgorithm* reader)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  return by_name ? by_name->GetDescription() : "";
}

std::string choice_of(vtkAlgorithm* reader)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  if (!by_name || by_name->GetNumberOfVariables() < 2) {
    return "";
  }
  const std::string chosen = by_name->GetVariableName() ? by_name->GetVariableName() : "";
  return "'" + (chosen.empty() ? by_name->GetNameOfVariable(0) : chosen) + "'" +
    format(" of %d%s", by_name->GetNumberOfVariables(), chosen.empty() ? ", --variable NAME for another" : "");
}

std::string axis_name_of(vtkAlgorithm* reader, int axis)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  return by_name ? by_name->GetNameOfAxis(axis) : "";
}

axis_about axis_about_of(vtkAlgorithm* reader, int axis)
{
  static const stratus_axis_kind kinds[] = { STRATUS_AXIS_NUMBER, STRATUS_AXIS_LONGITUDE, STRATUS_AXIS_LATITUDE, STRATUS_AXIS_LEVELS };
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  axis_about result;
  if (by_name) {
    result.kind = kinds[by_name->GetKindOfAxis(axis)];
    result.title = by_name->GetTitleOfAxis(axis);
    result.units = by_name->GetFileUnitsOfAxis(axis);
    result.scale = by_name->GetScaleOfAxis(axis);
    for (int i = 0; i < by_name->GetNumberOfLevelsOfAxis(axis); ++i) {
      result.levels.push_back(by_name->GetCoordinateOfLevel(axis, i));
      result.levels.push_back(by_name->GetNumberOfLevel(axis, i));
    }
  }
  return result;
}

bool is_netcdf(vtkAlgorithm* reader)
{
  return reader->IsA("vtkStratusCFReader") || reader->IsA("vtkStratusUgridReader");
}

std::string axis_units_of(vtkAlgorithm* reader, int axis)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  return by_name ? by_name->GetUnitsOfAxis(axis) : "";
}

std::string value_units_of(vtkAlgorithm* reader)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  const std::string chosen = by_name && by_name->GetVariableName() ? by_name->GetVariableName() : "";
  for (int i = 0; by_name && i < by_name->GetNumberOfVariables(); ++i) {
    if (chosen.empty() || chosen == by_name->GetNameOfVariable(i)) {
      return by_name->GetUnitsOfVariable(i);
    }
  }
  return "";
}

bool has_variable(vtkAlgorithm* reader, const std::string& name)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  return !by_name || !name_in(by_name, name).empty();
}

void choose_variable(vtkAlgorithm* reader, const std::string& name)
{
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  if (by_name) {
    const std::string known = name.empty() ? name : name_in(by_name, name);
    by_name->SetVariableName(known.empty() ? nullptr : known.c_str());
  }
}

void set_memory(double bytes)
{
  if (bytes > 0.0) {
    vtkStratusVariableReader::SetMemoryLimit(static_cast<vtkTypeInt64>(bytes));
  }
}

void select_indices(vtkAlgorithm* reader, const std::string& select)
{
  if (vtkStratusNetCDFReader* const by_name = vtkStratusNetCDFReader::SafeDownCast(reader)) {
    by_name->SetSelection(select.c_str());
    return;
  }
  throw usage("--select " + select + ": only netCDF and Zarr have dimensions with names to select from");
}

void place_on_globe(vtkAlgorithm* reader, double factor)
{
  if (vtkStratusNetCDFReader* const earth = vtkStratusNetCDFReader::SafeDownCast(reader)) {
    earth->SetCoordinatesToSphere();
    earth->SetHeightFactor(factor);
    return;
  }
  throw usage("--globe: only netCDF and Zarr have longitudes and latitudes");
}

std::function<bool(const double degrees[2], double at[2])> place_on_plane(vtkAlgorithm* reader, std::string& why_not)
{
  if (vtkStratusNetCDFReader* const plane = vtkStratusNetCDFReader::SafeDownCast(reader)) {
    why_not = plane->GetReasonWithoutPlaces();
    if (plane->HasPlaces()) {
      const vtkSmartPointer<vtkStratusNetCDFReader> kept = plane;
      return [kept](const double degrees[2], double at[2]) { return kept->FindPlace(degrees[0], degrees[1], at); };
    }
  }
  return nullptr;
}

double height_factor_of(vtkAlgorithm* reader)
{
  vtkStratusNetCDFReader* const earth = vtkStratusNetCDFReader::SafeDownCast(reader);
  return earth ? earth->GetUsedHeightFactor() : 0.0;
}

std::vector<variable_entry> list_variables(vtkAlgorithm* reader, double time)
{
  std::vector<variable_entry> list;
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  for (int i = 0; by_name && i < by_name->GetNumberOfVariables(); ++i) {
    list.push_back({ by_name->GetNameOfVariable(i), by_name->GetUnitsOfVariable(i), by_name->GetLongNameOfVariable(i), 1.0, 0.0 });
  }
  for (variable_entry& one : list) {
    by_name->SetVariableName(one.name.c_str());
    by_name->UpdateTimeStep(time);
    vtkDataObject* const output = by_name->GetOutputDataObject(0);
    vtkCompositeDataSet* const blocks = vtkCompositeDataSet::SafeDownCast(output);
    std::vector<vtkDataSet*> grids;
    if (blocks) {
      grids = vtkCompositeDataSet::GetDataSets(blocks);
    } else if (vtkDataSet* grid = vtkDataSet::SafeDownCast(output)) {
      grids.push_back(grid);
    }
    for (vtkDataSet* grid : grids) {
      vtkDataArray* values = grid->GetPointData()->GetArray(one.name.c_str());
      values = values ? values : grid->GetCellData()->GetArray(one.name.c_str());
      double range[2] = { 1.0, 0.0 };
      if (values) {
        values->GetFiniteRange(range, values->GetNumberOfComponents() == 1 ? 0 : -1); // -1: of lengths
      }
      if (range[0] <= range[1]) {
        const bool first = one.low > one.high;
        one.low = first ? range[0] : std::min(one.low, range[0]);
        one.high = first ? range[1] : std::max(one.high, range[1]);
      }
    }
  }
  choose_variable(reader, "");
  return list;
}

std::vector<variable_name> names_of_variables(vtkAlgorithm* reader)
{
  std::vector<variable_name> names;
  vtkStratusVariableReader* const by_name = vtkStratusVariableReader::SafeDownCast(reader);
  for (int i = 0; by_name && i < by_name->GetNumberOfVariables(); ++i) {
    names.push_back({ by_name->GetNameOfVariable(i), by_name->GetUnitsOfVariable(i), by_name->GetStandardNameOfVariable(i) });
  }
  return names;
}

std::vector<collection_step> read_collection(const std::string& path)
{
  const auto wrong = [&path](const std::string& why) { return failure("cannot read '" + path + "': " + why); };
  vtkSmartPointer<vtkXMLDataElement> root;
  root.TakeReference(vtkXMLUtilities::ReadElementFromFile(path.c_str()));
  vtkXMLDataElement* list = root ? root->FindNestedElementWithName("Collection") : nullptr;
  if (!list) {
    throw wrong("it is no collection (.pvd): no <Collection> in a <VTKFile>");
  }
  const std::string folder = path.substr(0, path.find_last_of('/') + 1);
  std::vector<collection_step> steps;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* entry = list->GetNestedElement(i);
    const char* file = entry->GetAttribute("file");
    double time = 0.0;
    if (!file || !*file) {
      throw wrong(format("entry %d names no file", i));
    }
    if (entry->GetAttribute("timestep") && (entry->GetScalarAttribute("timestep", time) != 1 || !std::isfinite(time))) {
      throw wrong(format("entry %d has the time '%s', which is no number", i, entry->GetAttribute("timestep")));
    }
    if (!steps.empty() && time < steps.back().time) {
      throw wrong(format("its time runs backwards: %.9g (entry %d) comes after %.9g", time, i, steps.back().time));
    }
    if (steps.empty() || time > steps.back().time) {
      steps.push_back({ time, {} });
    }
    steps.back().files.push_back(file[0] == '/' ? file : folder + file);
  }
  if (steps.empty()) {
    throw wrong("the collection names no file");
  }
  return steps;
}
} // namespace cli
