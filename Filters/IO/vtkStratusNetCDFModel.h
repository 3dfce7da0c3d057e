// SPDX-License-Identifier: BSD-3-Clause
// A file of netCDF's data model, whichever library reads it: dimensions, variables and attributes, and values with fills, scale and offset
// undone. Private to the module.
#ifndef vtkStratusNetCDFModel_h
#define vtkStratusNetCDFModel_h

#include "vtkStratusReadError.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkStratusNetCDFValues;
struct vtkStratusNetCDFPart;

// Types of stored values. The numbers are libnetcdf's; those from Text on are no numbers.
enum vtkStratusNetCDFType {
  vtkStratusNetCDFInt8 = 1,
  vtkStratusNetCDFChar = 2, // no number either
  vtkStratusNetCDFInt16 = 3,
  vtkStratusNetCDFInt32 = 4,
  vtkStratusNetCDFFloat32 = 5,
  vtkStratusNetCDFFloat64 = 6,
  vtkStratusNetCDFUInt8 = 7,
  vtkStratusNetCDFUInt16 = 8,
  vtkStratusNetCDFUInt32 = 9,
  vtkStratusNetCDFInt64 = 10,
  vtkStratusNetCDFUInt64 = 11,
  vtkStratusNetCDFText = 12,
  vtkStratusNetCDFOther = 13
};

struct vtkStratusNetCDFVariable {
  int Group, Id;               // numbers of the library that reads the file
  int Type;                    // vtkStratusNetCDFType, or a greater number for types of the file's own
  std::string Name;            // with the path of its group: "run1/rho", "rho" in the root group
  std::vector<int> Dimensions; // numbers of dimensions, slowest first

  std::string BaseName() const { return this->Name.substr(this->Name.rfind('/') + 1); }
  bool HasNumbers() const { return this->Type != vtkStratusNetCDFChar && this->Type < vtkStratusNetCDFText; }
};

// An attribute, with its numbers or its text. Integers of 64 bits stay exact.
struct vtkStratusNetCDFAttribute {
  bool Exists = false, IsText = false;
  size_t Length = 0; // of numbers or texts; a text of characters has as many
  std::string Text;  // the first one
  std::vector<double> Reals;
  std::vector<std::int64_t> Integers; // empty for reals; an unsigned one above the largest has its bits
};

class vtkStratusNetCDFModel
{
public:
  using Variable = vtkStratusNetCDFVariable;
  using Attribute = vtkStratusNetCDFAttribute;
  struct TimeSteps {
    std::vector<double> Values; // ascending
    std::string Units;          // "hours since 2001-01-01", "" if the file does not say
    std::string Note;           // "; ..." if steps are numbers because the file has no numbers for them, else ""
    std::string Calendar = {};  // "noleap", "" if the file does not say
  };
  static constexpr int Global = -1; // the Id of a variable that stands for its group, whose attributes it has

  virtual ~vtkStratusNetCDFModel() = default;
  vtkStratusNetCDFModel(const vtkStratusNetCDFModel&) = delete;
  void operator=(const vtkStratusNetCDFModel&) = delete;

  const std::string& GetPath() const { return this->Path; }
  const std::vector<Variable>& GetVariables() const { return this->Variables; }
  // Returns the variable of a name, nullptr if there is none. A name without a path is looked up in the group of `from`, then in the groups
  // above it, then in all groups.
  const Variable* Find(const std::string& name, const Variable* from = nullptr) const;
  // Returns the variable that has the dimension's name and this dimension only, nullptr if there is none.
  const Variable* CoordinateOf(int dimension) const;
  size_t LengthOf(int dimension) const { return this->Lengths[static_cast<size_t>(dimension)]; }
  const std::string& NameOf(int dimension) const { return this->Names[static_cast<size_t>(dimension)]; } // without its group
  bool IsUnlimited(int dimension) const { return this->Unlimited[static_cast<size_t>(dimension)] != 0; }
  // Returns whether the selection names the dimension, and at which index it is read; 0 without selection.
  bool IsSelected(int dimension) const { return this->Selected[static_cast<size_t>(dimension)] >= 0; }
  size_t IndexOf(int dimension) const
  {
    return this->IsSelected(dimension) ? static_cast<size_t>(this->Selected[static_cast<size_t>(dimension)]) : 0;
  }
  // Returns whether a variable on the dimension has several values along it.
  bool IsSpread(int dimension) const { return this->LengthOf(dimension) > 1 && !this->IsSelected(dimension); }
  int FindDimension(const std::string& name) const; // -1 if there is none
  size_t CountOf(const Variable& variable) const;   // values

  std::string Text(const Variable& variable, const char* attribute) const; // "" if there is none
  // Returns the name of a coordinate in words: its long_name, unless that is a sentence, or its standard_name, or "".
  std::string Title(const Variable& variable) const;
  bool Has(const Variable& variable, const char* attribute) const;
  // Returns the numbers of an attribute, none if there is none or it is text. Number: sets the first, returns whether there is one.
  std::vector<double> NumbersOf(const Variable& variable, const char* attribute) const;
  bool Number(const Variable& variable, const char* attribute, double& value) const;

  // Reads a block of values; empty start and count: all. Missing values are NaN, the others are unpacked, by the rules at
  // vtkStratusNetCDFValues. The array is float if floats represent all of the variable's values exactly, otherwise double.
  vtkSmartPointer<vtkDataArray> Read(
    const Variable& variable, const std::vector<size_t>& start = {}, const std::vector<size_t>& count = {}) const;
  // Returns "; ..." for attributes of values that are ignored, "" if there is none.
  std::string DescribeValues(const Variable& variable) const;
  // Reads all values of integers or reals, in doubles; one that is missing is an error that names `what`.
  std::vector<double> ReadComplete(const Variable& variable, const std::string& what) const;
  // Returns a part of a variable as bricks of the file, which are read when something looks at them; null where they can't be.
  virtual vtkSmartPointer<vtkDataArray> MakeBricks(const Variable& variable, const vtkStratusNetCDFPart& part) const = 0;

  // "time (12), lat (90), lon (180)"
  std::string DescribeDimensions(const Variable& variable) const;
  // "; 'number' at index 0 of 0..9, select number=INDEX for another"
  std::string DescribeIndex(int dimension) const;

  // Returns whether a dimension is a time: its variable is one, by units, standard_name, axis or name, or its own name is a time's. One
  // that is selected is none.
  bool IsTime(int dimension) const;
  // Reads the steps of a dimension. Numbers must increase. Texts ("2020-06-01_12:00:00") become seconds since the first. Steps without
  // either, and numbers that are no moments and do not increase (months), are counted from 0.
  TimeSteps ReadTimes(int dimension) const;

  [[noreturn]] void Fail(const std::string& why) const;
  // Fails because a variable holds no numbers, or none that are read.
  [[noreturn]] void FailWithoutNumbers(const Variable& variable) const;
  virtual std::string WhyNoNumbers(const Variable&) const { return "holds no numbers"; }
  // Fails if the variable's values cannot be read, whatever is in its dimensions.
  virtual void CheckValues(const Variable&) const {}

protected:
  explicit vtkStratusNetCDFModel(const std::string& path) : Path(path) {}

  // All of these throw vtkStratusReadError.
  virtual Attribute ReadAttribute(const Variable& variable, const char* name) const = 0;
  // Reads a block of stored values, slowest dimension first, in this machine's order of bytes.
  virtual void ReadStored(
    const Variable& variable, const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) const = 0;
  virtual std::vector<std::string> ReadTexts(const Variable& variable) const = 0;
  // Returns whether values without _FillValue are missing if they equal netCDF's default fill value.
  virtual bool HasDefaultFill(const Variable& variable) const = 0;
  // Returns whether integers none of which can be missing, and that are not packed, keep their type.
  virtual bool KeepsIntegers() const { return false; }

  // selection: "NAME=INDEX,NAME=INDEX...", dimensions that are read at one index only; "": none.
  void Select(const std::string& selection);
  vtkStratusNetCDFValues ValuesOf(const Variable& variable) const;

  std::string Path;
  std::vector<std::string> Names;
  std::vector<std::string> Paths; // of the dimensions' groups, with a slash behind
  std::vector<size_t> Lengths;
  std::vector<char> Unlimited;
  std::vector<long long> Selected; // index, or -1
  std::vector<Variable> Variables;

private:
  const Variable* TimeOf(int dimension) const;
  const Variable* TextsOf(int dimension) const;
};

// Splits at blanks.
std::vector<std::string> vtkStratusWords(const std::string& text);
// "12.5", the shortest text of the number.
std::string vtkStratusNumberText(double value);

#endif
