// SPDX-License-Identifier: BSD-3-Clause
// How the stored values of a netCDF variable become numbers: signs, missing values, valid ranges, scale and offset, by the netCDF users'
// guide. Private to the module.
#ifndef vtkStratusNetCDFValues_h
#define vtkStratusNetCDFValues_h

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <mutex>
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
  // file, variable: numbers of libnetcdf. type: nc_type of numbers. name: the variable's, for errors.
  // Throws std::string, which says what is wrong, for a scale_factor or add_offset that is not one number.
  vtkStratusNetCDFValues(int file, int variable, int type, const std::string& name);

  // Reads a block. Missing values are NaN. Returns floats if floats represent all of the variable's values exactly, otherwise doubles. Sets
  // `status` to libnetcdf's status; unless it is NC_NOERR, nothing is returned.
  // `lock` is released before values are unpacked, for which libnetcdf is not needed.
  vtkSmartPointer<vtkDataArray> Read(const std::vector<size_t>& start, const std::vector<size_t>& count, int& status,
    std::unique_lock<std::recursive_mutex>* lock = nullptr) const;

  // Returns "; ..." for each attribute that is ignored because it is text, or a limit that the packed type does not hold. "" for none.
  std::string Describe() const;

private:
  struct Attribute;
  template <class Stored> struct Missing;

  template <class Stored, class Result>
  vtkSmartPointer<vtkDataArray> ReadAs(
    const std::vector<size_t>& start, const std::vector<size_t>& count, int& status, std::unique_lock<std::recursive_mutex>* lock) const;
  template <class Stored, class Result>
  void Unpack(const Missing<Stored>& missing, const Stored* stored, size_t count, Result* results) const;
  template <class Stored> bool IsFloatEnough() const;
  template <class Stored> Missing<Stored> FindMissing() const;
  double ReadNumber(const char* attribute, double otherwise) const;
  Attribute ReadAttribute(const char* name) const;
  Attribute ReadLimit(size_t index, std::string& name) const;
  bool IsUsed(const Attribute& limit) const;
  bool IsPacked() const { return this->Scale != 1.0 || this->Offset != 0.0; }

  int File, Variable, FileType, Type; // Type: with the sign that _Unsigned says
  std::string Name;
  double Scale = 1.0, Offset = 0.0;
};

#endif
