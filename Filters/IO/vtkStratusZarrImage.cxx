// SPDX-License-Identifier: BSD-3-Clause
// Images of OME-Zarr (versions 0.1 to 0.5) in vtkStratusZarrFile: levels of resolution, and the places of their values.
#include "vtkStratusZarrFile.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace {
std::string TextOf(const Json::Value& object, const char* key)
{
  return object.isObject() && object[key].isString() ? object[key].asString() : "";
}

// Returns the type of an axis that has none, by its name.
std::string KindOf(const std::string& name)
{
  return name == "t" ? "time" : name == "c" ? "channel" : name == "x" || name == "y" || name == "z" ? "space" : "";
}
} // namespace

void vtkStratusZarrFile::FindImages()
{
  for (const Group& group : this->Groups) {
    const Json::Value& attributes = group.Attributes;
    if (!attributes.isObject()) {
      continue;
    }
    const Json::Value& images = attributes["ome"].isObject() ? attributes["ome"]["multiscales"] : attributes["multiscales"];
    for (Json::ArrayIndex i = 0; images.isArray() && i < images.size(); ++i) {
      if (images[i].isObject()) {
        this->AddImage(group, images[i]);
      }
    }
  }
}

void vtkStratusZarrFile::AddImage(const Group& group, const Json::Value& image)
{
  const Json::Value& levels = image["datasets"];
  for (Json::ArrayIndex i = 0; levels.isArray() && i < levels.size(); ++i) {
    const std::string name = group.Path + TextOf(levels[i], "path");
    const auto level =
      std::find_if(this->Variables.begin(), this->Variables.end(), [&name](const Variable& one) { return one.Name == name; });
    const size_t source = level == this->Variables.end() ? 0 : static_cast<size_t>(level->Id);
    if (level == this->Variables.end() || this->Images.count(source) > 0) {
      continue;
    }
    vtkStratusZarrArray& array = *this->Sources[source].Values;
    const size_t rank = array.GetShape().size();
    Axes axes = AxesOf(image["axes"], rank);
    if (axes.size() != rank) {
      array.SetFault("it has " + std::to_string(rank) + " dimensions, and its image has " + std::to_string(axes.size()) + " axes");
      continue;
    }
    array.SetFault(Transform(levels[i]["coordinateTransformations"], axes));
    array.SetFault(Transform(image["coordinateTransformations"], axes));
    for (const Axis& one : axes) {
      this->Sources[source].Units[one.Name] = one.Kind == "space" ? one.Units : "";
    }
    this->Images[source] = axes;
    this->Levels.push_back(source);
  }
}

// Versions up to 0.2 have no list of axes, and 0.3 has only their names.
vtkStratusZarrFile::Axes vtkStratusZarrFile::AxesOf(const Json::Value& axes, size_t rank)
{
  Axes result;
  std::set<std::string> names;
  for (Json::ArrayIndex i = 0; axes.isArray() && i < axes.size(); ++i) {
    Axis axis;
    axis.Name = axes[i].isString() ? axes[i].asString() : TextOf(axes[i], "name");
    axis.Name = names.insert(axis.Name).second ? axis.Name : "";
    axis.Kind = TextOf(axes[i], "type");
    axis.Kind = axis.Kind.empty() ? KindOf(axis.Name) : axis.Kind;
    axis.Units = TextOf(axes[i], "unit");
    result.push_back(axis);
  }
  if (axes.isNull() && rank == 5) {
    for (const char* name : { "t", "c", "z", "y", "x" }) {
      Axis axis;
      axis.Name = name;
      axis.Kind = KindOf(name);
      result.push_back(axis);
    }
  }
  return result;
}

// Applies scales and translations. Returns what is wrong with them, or "".
std::string vtkStratusZarrFile::Transform(const Json::Value& transformations, Axes& axes)
{
  for (Json::ArrayIndex i = 0; transformations.isArray() && i < transformations.size(); ++i) {
    const std::string type = TextOf(transformations[i], "type");
    if (type == "identity") {
      continue;
    }
    if (type != "scale" && type != "translation") {
      return "its coordinate transformation '" + type + "' is not read; scale and translation are";
    }
    const Json::Value& numbers = transformations[i][type];
    for (Json::ArrayIndex a = 0; a < axes.size(); ++a) {
      const bool is_number = numbers.isArray() && numbers.size() == axes.size() && numbers[a].isNumeric();
      const double number = is_number ? numbers[a].asDouble() : NAN;
      if (!std::isfinite(number) || (type == "scale" && number == 0.0)) {
        return "its coordinate transformation '" + type + "' must have " + std::to_string(axes.size()) + " finite numbers" +
          (type == "scale" ? " other than 0" : "");
      }
      axes[a].Scale *= type == "scale" ? number : 1.0;
      axes[a].Offset = type == "scale" ? axes[a].Offset * number : axes[a].Offset + number;
    }
  }
  return "";
}

// Adds the coordinates of images, and sorts variables so that levels come first. Axes in space keep the image's units as they are, so that
// their coordinates have no attribute of it. Channels and other axes are read at an index, as an ensemble.
void vtkStratusZarrFile::AddCoordinates()
{
  std::vector<Variable> sorted;
  for (const size_t source : this->Levels) {
    sorted.push_back(this->Variables[source]); // which are in the order of sources yet
  }
  for (const Variable& one : this->Variables) {
    if (this->Images.count(static_cast<size_t>(one.Id)) == 0) {
      sorted.push_back(one);
    }
  }
  for (const auto& image : this->Images) {
    const Variable level = this->Variables[image.first];
    for (size_t a = 0; a < image.second.size(); ++a) {
      const Axis& axis = image.second[a];
      const bool is_space = axis.Kind == "space", is_time = axis.Kind == "time";
      const std::string letters = "xyz";
      Source coordinates;
      coordinates.Attributes = Json::Value(Json::objectValue);
      if (is_space && axis.Name.size() == 1 && letters.find(axis.Name) != std::string::npos) {
        coordinates.Attributes["axis"] = axis.Name;
      } else if (!is_space) {
        coordinates.Attributes["axis"] = is_time ? "T" : "E";
      }
      if (is_time && !axis.Units.empty()) {
        coordinates.Attributes["units"] = axis.Units;
      }
      if (is_space || is_time) {
        coordinates.Scale = axis.Scale;
        coordinates.Offset = axis.Offset;
      }
      const int dimension = level.Dimensions[a], id = static_cast<int>(this->Sources.size());
      sorted.push_back({ 0, id, vtkStratusNetCDFFloat64, level.Name + "/" + this->NameOf(dimension), { dimension } });
      this->Sources.push_back(coordinates);
    }
  }
  this->Variables = sorted;
}

std::string vtkStratusZarrFile::ImageUnits(const Variable& variable, const std::string& axis) const
{
  const std::map<std::string, std::string>& units = this->SourceOf(variable).Units;
  const auto found = units.find(axis);
  return found == units.end() ? "" : found->second;
}
