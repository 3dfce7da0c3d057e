// SPDX-License-Identifier: BSD-3-Clause
// A netCDF file by libnetcdf. Private to the module.
#ifndef vtkStratusNetCDFFile_h
#define vtkStratusNetCDFFile_h

#include "vtkStratusNetCDFModel.h"

#include <map>
#include <string>
#include <vector>

class vtkStratusNetCDFFile : public vtkStratusNetCDFModel
{
public:
  // selection: as vtkStratusNetCDFModel::Select(). Throws vtkStratusReadError, as all members do.
  explicit vtkStratusNetCDFFile(const std::string& path, const std::string& selection = "");
  ~vtkStratusNetCDFFile() override;

  // Returns the lengths of the variable's chunks along its dimensions; empty for one that is in one piece, or in a classic file.
  std::vector<size_t> ChunksOf(const Variable& variable) const;
  vtkSmartPointer<vtkDataArray> MakeBricks(const Variable& variable, const vtkStratusNetCDFPart& part) const override;
  using vtkStratusNetCDFModel::ValuesOf;
  void ReadStored(
    const Variable& variable, const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) const override;

protected:
  Attribute ReadAttribute(const Variable& variable, const char* name) const override;
  std::vector<std::string> ReadTexts(const Variable& variable) const override;
  bool HasDefaultFill(const Variable& variable) const override;

private:
  void Check(int status, const std::string& what) const;
  void CheckLength() const;
  void Load(int group, const std::string& path);

  int Id = -1;
  std::map<int, int> Numbers; // of libnetcdf's numbers of dimensions
};

#endif
