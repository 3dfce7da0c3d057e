// SPDX-License-Identifier: BSD-3-Clause
#include "formats.h"

#include "support.h"

#ifdef STRATUS_NETCDF
#include "vtkStratusCFReader.h"
#include "vtkStratusUgridReader.h"
#endif
#include "vtkStratusTetGenReader.h"

#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkCellData.h>

#include <vtkDataSetReader.h>
#include <vtkGenericEnSightReader.h>
#include <vtkHDFReader.h>
#include <vtkImageReader2.h>
#include <vtkImageReader2Factory.h>
#include <vtkMetaImageReader.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNrrdReader.h>
#include <vtkOpenFOAMReader.h>
#include <vtkPointData.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLMultiBlockDataReader.h>
#include <vtkXMLPImageDataReader.h>
#include <vtkXMLPRectilinearGridReader.h>
#include <vtkXMLPStructuredGridReader.h>
#include <vtkXMLPUnstructuredGridReader.h>
#include <vtkXMLRectilinearGridReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace {

using made = vtkSmartPointer<vtkAlgorithm>;

template <class Reader> made reader_for(const std::string& path)
{
  auto reader = vtkSmartPointer<Reader>::New();
  reader->SetFileName(path.c_str());
  return reader;
}

// Polyhedra stay whole, because the mappers divide them conformingly.
made openfoam(const std::string& path)
{
  auto reader = vtkSmartPointer<vtkOpenFOAMReader>::New();
  reader->SetFileName(path.c_str());
  reader->DecomposePolyhedraOff();
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
  return vtkStratusUgridReader::CanReadFile(path.c_str()) ? reader_for<vtkStratusUgridReader>(path) : reader_for<vtkStratusCFReader>(path);
#else
  throw cli::failure("cannot read '" + path + "': this program was built without libnetcdf, which reads netCDF files");
#endif
}

constexpr struct {
  const char* extension;
  made (*make)(const std::string& path);
} formats[] = {
  { ".vti", reader_for<vtkXMLImageDataReader> },
  { ".pvti", reader_for<vtkXMLPImageDataReader> },
  { ".vtr", reader_for<vtkXMLRectilinearGridReader> },
  { ".pvtr", reader_for<vtkXMLPRectilinearGridReader> },
  { ".vts", reader_for<vtkXMLStructuredGridReader> },
  { ".pvts", reader_for<vtkXMLPStructuredGridReader> },
  { ".vtu", reader_for<vtkXMLUnstructuredGridReader> },
  { ".pvtu", reader_for<vtkXMLPUnstructuredGridReader> },
  { ".vtm", reader_for<vtkXMLMultiBlockDataReader> },
  { ".vtmb", reader_for<vtkXMLMultiBlockDataReader> },
  { ".vtk", reader_for<vtkDataSetReader> },
  { ".vtkhdf", reader_for<vtkHDFReader> },
  { ".hdf", reader_for<vtkHDFReader> },
  { ".nc", netcdf },
  { ".nc4", netcdf },
  { ".cdf", netcdf },
  { ".foam", openfoam },
  { "controldict", openfoam },
  { ".case", ensight },
  { ".encas", ensight },
  { ".mha", reader_for<vtkMetaImageReader> },
  { ".mhd", reader_for<vtkMetaImageReader> },
  { ".nrrd", reader_for<vtkNrrdReader> },
  { ".nhdr", reader_for<vtkNrrdReader> },
  { ".nii", reader_for<vtkNIFTIImageReader> },
};
} // namespace

namespace cli {

std::string extension_of(const std::string& path)
{
  std::string name = path.substr(path.find_last_of('/') + 1);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.size() > 7 && name.compare(name.size() - 7, 7, ".nii.gz") == 0) {
    return ".nii";
  }
  const size_t dot = name.find_last_of('.');
  return name == "controldict" ? name : dot == std::string::npos ? "" : name.substr(dot);
}

bool is_tetgen(const std::string& path)
{
  const std::string extension = extension_of(path);
  return extension == ".node" || extension == ".ele" || extension == ".face" || extension == ".edge" || extension == ".neigh";
}

bool is_collection(const std::string& path)
{
  return extension_of(path) == ".pvd";
}

file_format choose_format(const std::string& path)
{
  const std::string extension = extension_of(path);
  for (const auto& known : formats) {
    if (extension == known.extension) {
      return { known.make(path), known.make == openfoam ? "s" : "" };
    }
  }
  if (is_tetgen(path)) {
    return { reader_for<vtkStratusTetGenReader>(path), "" };
  }
  vtkSmartPointer<vtkImageReader2> other;
  other.TakeReference(vtkImageReader2Factory::CreateImageReader2(path.c_str()));
  if (other) {
    other->SetFileName(path.c_str());
  }
  return { other, "" };
}

#ifdef STRATUS_NETCDF
std::string time_units_of(vtkAlgorithm* reader)
{
  vtkStratusNetCDFReader* const netcdf = vtkStratusNetCDFReader::SafeDownCast(reader);
  return netcdf ? netcdf->GetTimeUnits() : "";
}

std::string description_of(vtkAlgorithm* reader)
{
  vtkStratusNetCDFReader* const netcdf = vtkStratusNetCDFReader::SafeDownCast(reader);
  return netcdf ? netcdf->GetDescription() : "";
}

std::string length_units_of(vtkAlgorithm* reader)
{
  vtkStratusNetCDFReader* const netcdf = vtkStratusNetCDFReader::SafeDownCast(reader);
  return netcdf ? netcdf->GetLengthUnits() : "";
}

std::string value_units_of(vtkAlgorithm* reader)
{
  vtkStratusNetCDFReader* const netcdf = vtkStratusNetCDFReader::SafeDownCast(reader);
  const std::string chosen = netcdf && netcdf->GetVariableName() ? netcdf->GetVariableName() : "";
  for (int i = 0; netcdf && i < netcdf->GetNumberOfVariables(); ++i) {
    if (chosen.empty() || chosen == netcdf->GetNameOfVariable(i)) {
      return netcdf->GetUnitsOfVariable(i);
    }
  }
  return "";
}

bool has_variable(vtkAlgorithm* reader, const std::string& name)
{
  vtkStratusNetCDFReader* const netcdf = vtkStratusNetCDFReader::SafeDownCast(reader);
  for (int i = 0; netcdf && i < netcdf->GetNumberOfVariables(); ++i) {
    if (name == netcdf->GetNameOfVariable(i)) {
      return true;
    }
  }
  return !netcdf;
}

void choose_variable(vtkAlgorithm* reader, const std::string& name)
{
  vtkStratusNetCDFReader* const netcdf = vtkStratusNetCDFReader::SafeDownCast(reader);
  if (netcdf) {
    netcdf->SetVariableName(name.empty() ? nullptr : name.c_str());
  }
}

std::vector<variable_entry> list_variables(vtkAlgorithm* reader, double time)
{
  std::vector<variable_entry> list;
  vtkStratusNetCDFReader* const netcdf = vtkStratusNetCDFReader::SafeDownCast(reader);
  for (int i = 0; netcdf && i < netcdf->GetNumberOfVariables(); ++i) {
    list.push_back({ netcdf->GetNameOfVariable(i), netcdf->GetUnitsOfVariable(i), netcdf->GetLongNameOfVariable(i), 1.0, 0.0 });
  }
  for (variable_entry& one : list) {
    netcdf->SetVariableName(one.name.c_str());
    netcdf->UpdateTimeStep(time);
    vtkDataSet* const data = netcdf->GetOutput();
    vtkDataArray* values = data ? data->GetPointData()->GetArray(one.name.c_str()) : nullptr;
    values = values || !data ? values : data->GetCellData()->GetArray(one.name.c_str());
    if (values) {
      double range[2];
      values->GetFiniteRange(range);
      one.low = range[0];
      one.high = range[1];
    }
  }
  choose_variable(reader, "");
  return list;
}
#else
std::string time_units_of(vtkAlgorithm*)
{
  return "";
}

std::string description_of(vtkAlgorithm*)
{
  return "";
}

std::string length_units_of(vtkAlgorithm*)
{
  return "";
}

std::string value_units_of(vtkAlgorithm*)
{
  return "";
}

bool has_variable(vtkAlgorithm*, const std::string&)
{
  return true;
}

void choose_variable(vtkAlgorithm*, const std::string&) {}

std::vector<variable_entry> list_variables(vtkAlgorithm*, double)
{
  return {};
}
#endif

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
