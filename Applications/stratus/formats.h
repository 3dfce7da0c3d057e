// SPDX-License-Identifier: BSD-3-Clause
// Which of VTK's readers, or ours, reads a file: by its extension, and by its content where the extension does not tell.
#pragma once

#include <vtkAlgorithm.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

namespace cli {

// What to read of a file: the values of --array or --variable, --raw and --select. Empty: the first variable, at the first indices.
struct reading_options {
  std::string variable, raw, select;
};

// The extension with its dot, in small letters; ".nii" for .nii.gz (.hdr.gz, .img.gz alike), and "controldict" for OpenFOAM's file of that
// name.
std::string extension_of(const std::string& path);
// Returns whether the name is that of a TetGen file: .node, .ele, .face, .edge, .neigh.
bool is_tetgen(const std::string& path);
// Returns whether the name is that of a list of files over time: .pvd.
bool is_collection(const std::string& path);

// A reader with its file's name set.
struct file_format {
  vtkSmartPointer<vtkAlgorithm> reader; // null: nothing here reads the file
  std::string time_units;               // what the format itself prescribes, else ""
};
// `raw` is the value of --raw, for files that tell nothing of themselves (.raw): "NXxNYxNZ:TYPE", then in any order little or big (default
// little), the spacing "DX,DY,DZ" and the bytes before the values "+N". Throws usage where it is not that, and failure where the file has
// another length.
file_format choose_format(const std::string& path, const std::string& raw);

// What a file that is read by variables has: the range is of one step.
struct variable_entry {
  std::string name, units, long_name;
  double low, high; // low > high: nothing finite
};
// Lists the variables at a step; empty for a reader of whole files. The reader's variable is the first afterwards.
std::vector<variable_entry> list_variables(vtkAlgorithm* reader, double time);
// What a reader of variables tells of time and grid, "" from others.
std::string time_units_of(vtkAlgorithm* reader);
std::string description_of(vtkAlgorithm* reader);
std::string choice_of(vtkAlgorithm* reader);
std::string length_units_of(vtkAlgorithm* reader);
std::string value_units_of(vtkAlgorithm* reader); // of the chosen variable
// True where the reader does not read by variables. "wind.x" is there where "wind" is.
bool has_variable(vtkAlgorithm* reader, const std::string& name);
void choose_variable(vtkAlgorithm* reader, const std::string& name);
// Sets the indices at which dimensions are read, "NAME=INDEX,NAME=INDEX". Throws usage for a reader of files without named dimensions.
void select_indices(vtkAlgorithm* reader, const std::string& select);

// The parts of a step of a .pvd: all files of one time.
struct collection_step {
  double time;
  std::vector<std::string> files;
};
// Reads a .pvd by VTK's XML parser. Throws failure for another content, and where the time runs backwards.
std::vector<collection_step> read_collection(const std::string& path);
} // namespace cli
