// SPDX-License-Identifier: BSD-3-Clause
// A two-dimensional mesh of nodes and faces from a netCDF file, and its variables. Private to the module.
#ifndef vtkStratusUgridMesh_h
#define vtkStratusUgridMesh_h

#include "vtkStratusNetCDFModel.h"
#include "vtkStratusProjection.h"

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

// Values of a step over nodes or faces, and over layers or their borders.
struct vtkStratusUgridValues {
  vtkSmartPointer<vtkDataArray> Values;
  size_t Across = 0, Along = 0;               // steps from a node or face to the next, and from a layer to the next; 0: there is one
  const std::vector<size_t>* Nodes = nullptr; // of values on nodes: the file's node of each of the mesh's
  double At(size_t place, size_t layer) const
  {
    place = this->Nodes ? (*this->Nodes)[place] : place;
    return this->Values->GetComponent(static_cast<vtkIdType>(place * this->Across + layer * this->Along), 0);
  }
};

class vtkStratusUgridMesh
{
public:
  using Variable = vtkStratusNetCDFModel::Variable;

  static const Variable* FindTopology(const vtkStratusNetCDFModel& file); // or FVCOM's nv; nullptr
  explicit vtkStratusUgridMesh(const vtkStratusNetCDFModel& file);        // throws vtkStratusReadError

  size_t GetNodes() const { return this->X.size(); }
  size_t GetFaces() const { return this->Offsets.size() - 1; }
  // Nodes are the file's, and behind these copies of nodes a turn further on, for faces across the meridian where longitudes jump.
  const std::vector<double>& GetX() const { return this->X; }
  const std::vector<double>& GetY() const { return this->Y; }
  // The nodes of a face, counterclockwise from above.
  const int* GetFace(size_t face, int& corners) const
  {
    corners = static_cast<int>(this->Offsets[face + 1] - this->Offsets[face]);
    return &this->Corners[this->Offsets[face]];
  }
  // Returns whether longitudes around a pole tear the face apart.
  bool IsTorn(size_t face) const { return !this->Sphere && !this->Torn.empty() && this->Torn[face] != 0; }
  std::string GetAxisName(int axis) const
  {
    const std::string& name = axis == 0 ? this->XName : this->YName;
    return this->Degrees ? (axis == 0 ? "east" : "north") : name.substr(name.rfind('/') + 1);
  }
  const std::string& GetCoordinateName(int axis) const { return axis == 0 ? this->XName : this->YName; } // in the file
  void SetOnSphere() { this->Sphere = true; }                                                            // on which no face is torn
  bool IsInDegrees() const { return this->Degrees; }
  // The projection of nodes whose x and y are lengths: the grid mapping that `variable`, the mesh or its coordinates name. nullptr if there
  // is none. Throws vtkStratusReadError as vtkStratusProjection.
  std::shared_ptr<vtkStratusProjection> MakeProjection(const Variable& variable) const;
  double GetFactor(int axis) const { return this->Factors[static_cast<size_t>(axis)]; } // from the file's x and y, or degrees, to metres
  bool IsInMetres() const { return this->Metres; }
  const std::string& Describe() const { return this->Description; }

  // Returns whether a variable is the mesh's own: a coordinate, or a table of corners, edges or neighbours.
  bool IsPart(const Variable& variable) const;
  bool IsOnNodes(const Variable& variable) const { return this->Has(variable, this->NodeDimension); }
  bool IsOnFaces(const Variable& variable) const { return this->Has(variable, this->FaceDimension); }
  // The one dimension besides time, nodes, faces and dimensions that are selected or of length 1: -1 if there is none, -2 if there are
  // several. Of several, the one that SetLayers() names.
  int FindLayers(const Variable& variable) const;
  // dimensions: of layers and of their borders, -1: unknown. Another one of `count` or `count` + 1 values may take their place.
  void SetLayers(const std::array<int, 2>& dimensions, size_t count);
  // Returns "; ..." for each dimension that is read at one of several indices, "" if there is none.
  std::string DescribeOthers(const Variable& variable) const;
  int FindTime(const Variable& variable) const; // a dimension, or -1
  vtkStratusUgridValues Read(const Variable& variable, size_t step) const;
  // Reads values without layers, at nodes: values at faces are averaged over those around the node that have one.
  std::vector<double> ReadAtNodes(const Variable& variable, size_t step) const;
  const vtkStratusNetCDFModel& GetFile() const { return this->File; }

private:
  bool IsTime(int dimension) const;
  bool IsPlace(int dimension) const { return dimension == this->NodeDimension || dimension == this->FaceDimension; }
  std::vector<int> FindOthers(const Variable& variable) const;
  bool Has(const Variable& variable, int dimension) const;
  void ReadNodes(const Variable& x, const Variable& y);
  void ReadFaces(const Variable& connectivity, int first);
  void JoinLongitudes();
  void CopyNodes(size_t face);
  double TurnsAround(size_t face) const;
  void TurnFaces();

  const vtkStratusNetCDFModel& File;
  int NodeDimension = -1, FaceDimension = -1;
  std::array<int, 2> Layers = { { -1, -1 } };
  size_t LayerCount = 0; // 0: unknown
  std::string XName, YName;
  const Variable* Topology = nullptr;
  std::vector<double> X, Y;   // in the file's units or degrees until faces are read, then in metres if they can be
  std::vector<size_t> NodeOf; // the file's node of each node
  std::map<int, int> Copies;  // of nodes, a turn further east
  std::vector<char> Torn;
  std::array<double, 2> Factors = { { 1.0, 1.0 } };
  bool Degrees = false, Sphere = false;
  std::vector<size_t> Offsets = { 0 };
  std::vector<int> Corners;
  std::string Description;
  bool Metres = false;
};

#endif
