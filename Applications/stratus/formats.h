// SPDX-License-Identifier: BSD-3-Clause
// Chooses the reader of a file, one of VTK's or ours: by the extension, and by the content if the extension is ambiguous.
#pragma once

#include "stratus.h"

#include <vtkAlgorithm.h>
#include <vtkSmartPointer.h>

#include <functional>
#include <string>
#include <vector>

namespace cli {

// How to read a file: the values of --array or --variable, --raw and --select. Empty: the first variable, at the first indices.
struct reading_options {
  std::string variable, raw, select;
  bool globe = false;         // longitudes and latitudes are places on a sphere
  double height_factor = 0.0; // on it; 0: automatic
};

// The file's own numbers along an axis of the coordinates that are drawn.
struct axis_about {
  stratus_axis_kind kind = STRATUS_AXIS_NUMBER;
  std::string title, units;   // "": unknown
  double scale = 1.0;         // number = coordinate * scale
  std::vector<double> levels; // of STRATUS_AXIS_LEVELS: pairs of coordinate and number
};

// The extension with its dot, in small letters; ".nii" for .nii.gz (.hdr.gz, .img.gz alike), and "controldict" for OpenFOAM's file of that
// name.
std::string extension_of(const std::string& path);
// Returns whether the name has an extension of TetGen: .node, .ele, .face, .edge, .neigh.
bool is_tetgen(const std::string& path);
// Returns whether the path is a folder of Zarr, or a file of its metadata.
bool is_zarr(const std::string& path);
// Returns whether the name has the extension of a list of files over time: .pvd.
bool is_collection(const std::string& path);

// A reader with its file's name set.
struct file_format {
  vtkSmartPointer<vtkAlgorithm> reader; // null: nothing here reads the file
  std::string time_units;               // what the format itself prescribes, else ""
};
// `raw` is the value of --raw, the layout of a headerless file (.raw): "NXxNYxNZ:TYPE", then in any order little or big (default little),
// the spacing "DX,DY,DZ" and the bytes before the values "+N". Throws usage if `raw` is malformed, and failure if the file's length does
// not match.
file_format choose_format(const std::string& path, const std::string& raw);

// A variable of a file that is read by variables. The range is of one step.
struct variable_entry {
  std::string name, units, long_name;
  double low, high; // low > high: nothing finite
};
// Lists the variables at a step; empty for a reader of whole files. The reader's variable is the first afterwards.
std::vector<variable_entry> list_variables(vtkAlgorithm* reader, double time);
// The names of a file's variables, without reading values; empty for a reader of whole files.
struct variable_name {
  std::string name, units, standard_name;
};
std::vector<variable_name> names_of_variables(vtkAlgorithm* reader);
// Description of time and grid by a reader of variables, "" by other readers.
std::string time_units_of(vtkAlgorithm* reader);
std::string time_calendar_of(vtkAlgorithm* reader);
std::string description_of(vtkAlgorithm* reader);
std::string choice_of(vtkAlgorithm* reader);
// Whether a reader of variables reads netCDF, or Zarr in the same way.
bool is_netcdf(vtkAlgorithm* reader);
std::string axis_name_of(vtkAlgorithm* reader, int axis);
// The file's own numbers along an axis, for labels; those of a reader of whole files are coordinates without a name.
axis_about axis_about_of(vtkAlgorithm* reader, int axis);
std::string axis_units_of(vtkAlgorithm* reader, int axis);
std::string value_units_of(vtkAlgorithm* reader); // of the chosen variable
// True where the reader does not read by variables. "wind.x" is there where "wind" is.
bool has_variable(vtkAlgorithm* reader, const std::string& name);
void choose_variable(vtkAlgorithm* reader, const std::string& name);
// Limits the memory of values that readers leave in their files, in bytes; 0: as it is.
void set_memory(double bytes);
// Sets the indices at which dimensions are read, "NAME=INDEX,NAME=INDEX". Throws usage for a reader of files without named dimensions.
void select_indices(vtkAlgorithm* reader, const std::string& select);
// Places a reader's longitudes and latitudes on a sphere, with heights times `factor`, or 0: automatic. Throws usage for a file that is not
// netCDF.
void place_on_globe(vtkAlgorithm* reader, double factor);
// How a reader's grid on the plane of a projection places longitudes and latitudes, in degrees: x and y, or false. Empty for other grids;
// `why_not` is the reason, "" for grids without a projection.
std::function<bool(const double degrees[2], double at[2])> place_on_plane(vtkAlgorithm* reader, std::string& why_not);
double height_factor_of(vtkAlgorithm* reader); // that was used on a sphere; 0: there is none

// The parts of a step of a .pvd: all files of one time.
struct collection_step {
  double time;
  std::vector<std::string> files;
};
// Reads a .pvd by VTK's XML parser. Throws failure for another content, and where the time runs backwards.
std::vector<collection_step> read_collection(const std::string& path);
} // namespace cli
