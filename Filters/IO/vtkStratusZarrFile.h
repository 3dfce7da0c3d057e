// SPDX-License-Identifier: BSD-3-Clause
// A folder of Zarr as a file of netCDF's data model. Private to the module.
#ifndef vtkStratusZarrFile_h
#define vtkStratusZarrFile_h

#include "vtkStratusNetCDFModel.h"
#include "vtkStratusZarrArray.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

// Arrays are variables, and their dimensions are named by _ARRAY_DIMENSIONS (version 2) or dimension_names (version 3), otherwise "dim_0",
// "dim_1" ... Dimensions of one name and length are the same one within a group and the groups below it. Images of OME-Zarr (attribute
// `multiscales`) have coordinates that their scales and translations give, named "ARRAY/AXIS", and their levels come first.
class vtkStratusZarrFile : public vtkStratusNetCDFModel
{
public:
  // path: a folder of a group or an array, or a file of its metadata. Throws vtkStratusReadError, as all members do.
  explicit vtkStratusZarrFile(const std::string& path, const std::string& selection = "");
  ~vtkStratusZarrFile() override;

  // Returns whether the path is of a folder of Zarr.
  static bool IsZarr(const std::string& path);

  // Returns the unit of an axis of an image of OME-Zarr, "" if it has none, or if the variable is of no image.
  std::string ImageUnits(const Variable& variable, const std::string& axis) const;

  vtkSmartPointer<vtkDataArray> MakeBricks(const Variable& variable, const vtkStratusNetCDFPart& part) const override;
  std::string WhyNoNumbers(const Variable& variable) const override;
  void CheckValues(const Variable& variable) const override;

protected:
  Attribute ReadAttribute(const Variable& variable, const char* name) const override;
  void ReadStored(
    const Variable& variable, const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) const override;
  std::vector<std::string> ReadTexts(const Variable& variable) const override;
  bool HasDefaultFill(const Variable&) const override { return false; }
  bool KeepsIntegers() const override { return true; }

private:
  struct Group {
    std::string Path; // with a slash behind; "" of the root
    Json::Value Attributes;
  };
  // An array, or coordinates that an image's scale and offset give.
  struct Source {
    std::shared_ptr<vtkStratusZarrArray> Values; // null for coordinates
    double Scale = 1.0, Offset = 0.0;
    Json::Value Attributes;                   // of coordinates
    std::map<std::string, std::string> Units; // of an image's axes, by their names
  };
  // An axis of a level of an image.
  struct Axis {
    std::string Name, Kind, Units;
    double Scale = 1.0, Offset = 0.0;
  };
  using Axes = std::vector<Axis>;

  bool Document(const std::string& name, Json::Value& value) const;
  std::vector<std::string> ChildrenOf(const std::string& path) const;
  void UseConsolidated(const Json::Value& metadata);
  void Load(const std::string& path, int depth);
  void CheckCount(size_t count) const;
  bool LoadNode(const std::string& path, bool& is_group);
  void AddArray(const std::string& path, const Json::Value& metadata, const Json::Value& attributes);
  void AddDimensions();
  int AddDimension(const std::string& path, const std::string& name, size_t length);
  void FindImages();
  void AddImage(const Group& group, const Json::Value& image);
  static Axes AxesOf(const Json::Value& axes, size_t rank);
  static std::string Transform(const Json::Value& transformations, Axes& axes);
  void AddCoordinates();
  const Source& SourceOf(const Variable& variable) const { return this->Sources[static_cast<size_t>(variable.Id)]; }

  std::string Folder;                           // with a slash behind
  std::map<std::string, Json::Value> Documents; // of consolidated metadata, by their names in the folder
  std::vector<Group> Groups;
  std::vector<Source> Sources;   // of the variables' Ids
  std::map<size_t, Axes> Images; // of levels of images, by the numbers of their sources
  std::vector<size_t> Levels;    // the same sources in the images' order
};

#endif
