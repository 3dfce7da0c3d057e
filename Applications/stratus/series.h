// SPDX-License-Identifier: BSD-3-Clause
// A file as a series of steps in time; a file without time has one step. A reader that complains, hangs or crashes ends with a sentence.
#pragma once

#include "formats.h"
#include "options.h"

#include <vtkDataObject.h>

#include <string>
#include <vector>

namespace cli {

class series
{
public:
  // Opens a file and looks up its steps. Throws failure where it cannot be read, and where its time does not increase.
  // `reading`: its variable is of a file that is read by variables (netCDF), and readers of whole files ignore it. Its raw is described at
  // choose_format().
  explicit series(const std::string& path, const reading_options& reading = {});

  size_t steps() const { return this->Times.empty() ? 1 : this->Times.size(); }
  const std::vector<double>& times() const { return this->Times; } // ascending; empty: the file has no time
  const std::string& units() const { return this->Units; }         // as the file has them ("hours since 2001-01-01"), "" if it has none
  std::string calendar() const;                                    // of the units, as the file has it ("noleap"), "" if it has none
  // Reads a step. Any complaint of VTK is a failure, so that a damaged file is never drawn in part. The result may share arrays with the
  // reader: unless it makes new ones for each step, take a deep copy where the next step is read while this one is used.
  vtkSmartPointer<vtkDataObject> read(size_t step);
  bool makes_new_arrays() const { return this->Reader && this->Reader->IsA("vtkStratusVariableReader"); }
  bool reads_ahead() const; // the values are bricks in their file
  // "2001-01-01 01:30", "1.5 hours" of times without a date, "" for a file without time.
  std::string time_of(size_t step) const;
  // The name and unit of an axis of coordinates, and the unit of the variable: "" if the file or the format has none.
  std::string axis_name(int axis) const;
  std::string axis_units(int axis) const;
  std::string value_units() const;
  // The drawn variable's name, standard name and unit, and whether the file is netCDF with coordinates that are lengths.
  data_about about() const;
  double height_factor() const; // of heights on a globe; 0: there is none
  // Returns "step 3 of 24, at 2001-01-01 01:30", or "" for a file without time.
  std::string describe(size_t step) const;
  // The file's variables at a step, none of a file that is not read by variables.
  std::vector<variable_entry> variables(size_t step);
  // The names of the file's variables, none of a file that is not read by variables.
  std::vector<variable_name> names() const;
  // Which of several variables is read, and how to choose another, "" for a file of one or that is not read by variables.
  std::string choice() const;
  // How coordinates became a grid, "" where that is VTK's own affair.
  std::string grid() const;
  // Finds the step for --time: "first", "last", "step:N", a moment ("2001-01-01 01:30"), a time in the file's units, a duration with its
  // unit ("3h", "90min", "2 d") since the file's reference time, or with a plus before it since the first step. Returns the nearest step.
  size_t find(const std::string& time) const;

private:
  vtkSmartPointer<vtkDataObject> read_parts(const collection_step& step);
  static bool is_moment(const std::string& time);
  double value_of_moment(const std::string& time) const;
  double value_of_time(const std::string& text) const;

  void open();

  std::string Path, Variable, Raw, Select;
  bool Globe;
  double HeightFactor;
  vtkSmartPointer<vtkAlgorithm> Reader; // null for a collection
  std::vector<collection_step> Parts;   // of a collection
  std::vector<double> Times;
  std::string Units;
};
} // namespace cli
