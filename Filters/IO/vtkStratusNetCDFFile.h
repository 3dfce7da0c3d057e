// SPDX-License-Identifier: BSD-3-Clause
// A netCDF file by libnetcdf: its dimensions, variables and attributes, and values with fills, scale and offset undone. Private to the
// module.
#ifndef vtkStratusNetCDFFile_h
#define vtkStratusNetCDFFile_h

#include "vtkStratusReadError.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkStratusNetCDFValues;

class vtkStratusNetCDFFile
{
public:
  struct Variable {
    int Id;
    int Type; // nc_type
    std::string Name;
    std::vector<int> Dimensions; // numbers of dimensions, slowest first
  };

  explicit vtkStratusNetCDFFile(const std::string& path); // throws vtkStratusReadError, as all members do
  ~vtkStratusNetCDFFile();
  vtkStratusNetCDFFile(const vtkStratusNetCDFFile&) = delete;
  void operator=(const vtkStratusNetCDFFile&) = delete;

  const std::string& GetPath() const { return this->Path; }
  const std::vector<Variable>& GetVariables() const { return this->Variables; }
  const Variable* Find(const std::string& name) const; // nullptr if there is none
  size_t LengthOf(int dimension) const { return this->Lengths[static_cast<size_t>(dimension)]; }
  const std::string& NameOf(int dimension) const { return this->Names[static_cast<size_t>(dimension)]; }
  int FindDimension(const std::string& name) const; // -1 if there is none
  size_t CountOf(const Variable& variable) const;   // values

  std::string Text(const Variable& variable, const char* attribute) const; // "" if there is none
  bool Number(const Variable& variable, const char* attribute, double& value) const;

  // Reads a block of values; empty start and count: all. Values that are missing are NaN, the others are unpacked, by the rules at
  // vtkStratusNetCDFValues. The array is float if this tells all of the variable's values apart, else double.
  vtkSmartPointer<vtkDataArray> Read(
    const Variable& variable, const std::vector<size_t>& start = {}, const std::vector<size_t>& count = {}) const;
  // Returns "; ..." for attributes of values that are ignored, "" if there is none.
  std::string DescribeValues(const Variable& variable) const;
  // Reads all values of integers or reals, in doubles; one that is missing is an error that names `what`.
  std::vector<double> ReadComplete(const Variable& variable, const std::string& what) const;

  // The variable of times along a dimension, nullptr for a dimension that is no time.
  const Variable* TimeOf(int dimension) const;
  // Times, which must increase.
  std::vector<double> ReadTimes(const Variable& variable) const;

  [[noreturn]] void Fail(const std::string& why) const;

private:
  void Check(int status, const std::string& what) const;
  void CheckLength(int attributes, int unlimited) const;
  vtkStratusNetCDFValues ValuesOf(const Variable& variable) const;

  std::string Path;
  int Id = -1;
  std::vector<std::string> Names;
  std::vector<size_t> Lengths;
  std::vector<Variable> Variables;
};

// Splits at blanks.
std::vector<std::string> vtkStratusWords(const std::string& text);
// "12.5", as short as it can be told.
std::string vtkStratusNumberText(double value);

#endif
