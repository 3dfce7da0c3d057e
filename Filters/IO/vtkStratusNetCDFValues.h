// SPDX-License-Identifier: BSD-3-Clause
// How the stored values of a netCDF variable become numbers: signs, missing values, valid ranges, scale and offset, by the netCDF users'
// guide. Private to the module.
#ifndef vtkStratusNetCDFValues_h
#define vtkStratusNetCDFValues_h

#include "vtkStratusNetCDFModel.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

// The rules, which all hold for stored values, before scale_factor and add_offset:
// - _Unsigned "true" or "false" gives an integer's bits the other sign; a byte with a valid limit above 127 has no sign either.
// - A value is missing if it equals _FillValue (or, except for bytes, its default) or any number of missing_value.
// - A value is missing if it is outside of valid_range, or without it below valid_min or above valid_max.
// - Attributes are taken in the variable's type: a double 0.1 is a float variable's 0.1.
// - _FillValue by itself is no limit: the guide's rule that it is one is followed by no program that writes files.
class vtkStratusNetCDFValues
{
public:
  using Attribute = vtkStratusNetCDFAttribute;

  // attributes: returns the variable's attribute of a name; the object keeps none of it. type: vtkStratusNetCDFType of numbers. name: the
  // variable's, for errors. default_fill: whether values without _FillValue are missing if they equal netCDF's default. keeps_integers:
  // whether integers none of which can be missing, and that are not packed, keep their type.
  // Throws std::string, which says what is wrong, for a scale_factor or add_offset that is not one number.
  vtkStratusNetCDFValues(const std::function<Attribute(const char* name)>& attributes, int type, const std::string& name, bool default_fill,
    bool keeps_integers);

  // Returns the type of VTK of unpacked values: float if floats represent all of the variable's values exactly, otherwise double; or the
  // integers' own.
  int GetResultType() const;
  // Lets `read` write `count` stored values, and unpacks them into `results`. Missing values are NaN. `read` may throw.
  using Reader = std::function<void(void* stored)>;
  void ReadInto(size_t count, const Reader& read, void* results) const;
  // Returns the same values as an array.
  vtkSmartPointer<vtkDataArray> Read(size_t count, const Reader& read) const;

  // Returns "; ..." for each attribute that is ignored because it is text, or a limit that the packed type does not hold. "" for none.
  std::string Describe() const;

private:
  template <class Stored> struct Missing;

  template <class Stored, class Result> void ReadAs(size_t count, const Reader& read, Result* results) const;
  template <class Stored> bool IsFloatEnough() const;
  template <class Stored> Missing<Stored> FindMissing() const;
  double NumberOf(const char* name, const Attribute& attribute, double otherwise) const;
  bool IsUsed(const Attribute& limit) const;
  bool IsPacked() const { return this->Scale != 1.0 || this->Offset != 0.0; }

  int FileType, Type; // Type: with the sign that _Unsigned says
  std::string Name;
  double Scale = 1.0, Offset = 0.0;
  Attribute Fill, MissingValue;
  std::array<Attribute, 2> Limits; // the least and the greatest valid value
  std::array<std::string, 2> LimitNames;
  bool DefaultFill, KeepsType = false;
  std::string TextIgnored;
};

#endif
