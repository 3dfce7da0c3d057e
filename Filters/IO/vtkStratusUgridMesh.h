// SPDX-License-Identifier: BSD-3-Clause
// A two-dimensional mesh of nodes and faces from a netCDF file, and its variables: UGRID, FVCOM, MPAS, or cells with bounds as CF has them
// (ICON). Private to the module.
#ifndef vtkStratusUgridMesh_h
#define vtkStratusUgridMesh_h

#include "vtkStratusNetCDFModel.h"
#include "vtkStratusProjection.h"

#include "stratus/layers.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

// The file's nodes or faces of one of the mesh's: one twice, or two between which it is.
struct vtkStratusUgridPlace {
  size_t First, Second;
  double Weight; // of the first
};

// Values of a step over nodes or faces, and over layers or their borders.
struct vtkStratusUgridValues {
  vtkSmartPointer<vtkDataArray> Values;
  size_t Across = 0, Along = 0; // steps from a node or face to the next, and from a layer to the next; 0: there is one
  const std::vector<vtkStratusUgridPlace>* Places = nullptr; // of each of the mesh's nodes or faces, null: they are the file's
  double At(size_t place, size_t layer) const
  {
    if (!this->Places) {
      return this->AtFile(place, layer);
    }
    const vtkStratusUgridPlace& of = (*this->Places)[place];
    const double value = this->AtFile(of.First, layer);
    return of.First == of.Second ? value : of.Weight * value + (1.0 - of.Weight) * this->AtFile(of.Second, layer);
  }
  double AtFile(size_t place, size_t layer) const
  {
    return this->Values->GetComponent(static_cast<vtkIdType>(place * this->Across + layer * this->Along), 0);
  }
};

class vtkStratusUgridMesh
{
public:
  using Variable = vtkStratusNetCDFModel::Variable;

  // Returns the variable that describes a mesh: of cf_role mesh_topology, FVCOM's nv, MPAS' table of corners, or a longitude of cells that
  // has bounds of three or more corners. nullptr if there is none.
  static const Variable* FindTopology(const vtkStratusNetCDFModel& file);
  // on_sphere: nodes stay single where longitudes jump and at poles. Throws vtkStratusReadError.
  explicit vtkStratusUgridMesh(const vtkStratusNetCDFModel& file, bool on_sphere = false);

  size_t GetNodes() const { return this->X.size(); }
  size_t GetFaces() const { return this->Offsets.size() - 1; }
  // Nodes and faces are the file's. Behind these are, on the plane around the Earth, those that stratus_faces_flatten() adds.
  const std::vector<double>& GetX() const { return this->X; }
  const std::vector<double>& GetY() const { return this->Y; }
  // The nodes of a face, counterclockwise from above.
  const int* GetFace(size_t face, int& corners) const
  {
    corners = static_cast<int>(this->Offsets[face + 1] - this->Offsets[face]);
    return &this->Corners[static_cast<size_t>(this->Offsets[face])];
  }
  // Returns whether the file's face lacks corners, as at the border of MPAS' meshes.
  bool IsAbsent(size_t face) const { return this->Absent[face] != 0; }
  // A view of the faces for the core, with one flag for each face that is not there.
  stratus_faces ViewFaces(const std::vector<uint8_t>& absent) const;
  std::string GetAxisName(int axis) const
  {
    const std::string& name = axis == 0 ? this->XName : this->YName;
    return this->Degrees ? (axis == 0 ? "east" : "north") : name.substr(name.rfind('/') + 1);
  }
  const std::string& GetCoordinateName(int axis) const { return axis == 0 ? this->XName : this->YName; } // in the file
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
  // Values of a layer at nodes: values at faces are averaged over those around the node that have one.
  std::vector<double> ToNodes(const vtkStratusUgridValues& values, bool on_faces, size_t layer) const;
  // Reads values without layers, at nodes.
  std::vector<double> ReadAtNodes(const Variable& variable, size_t step) const;
  const vtkStratusNetCDFModel& GetFile() const { return this->File; }

private:
  bool IsTime(int dimension) const;
  bool IsPlace(int dimension) const { return dimension == this->NodeDimension || dimension == this->FaceDimension; }
  std::vector<int> FindOthers(const Variable& variable) const;
  bool Has(const Variable& variable, int dimension) const;
  static const Variable* FindMpas(const vtkStratusNetCDFModel& file);
  static const Variable* FindCells(const vtkStratusNetCDFModel& file);
  const Variable& Named(const std::string& name, const char* what) const;
  void ReadNodes(const Variable& x, const Variable& y, const char* usual_unit);
  void DescribeNodes(const std::string& what);
  void ReadFaces(const Variable& connectivity, int first);
  void ReadMpas();
  void HidePeriodic(const Variable& global);
  void ReadCells();
  void FindFaces(const std::vector<double>& numbers, stratus_face_table table, size_t faces, const std::string& name);
  void Finish();
  void Flatten();
  void TurnFaces();

  const vtkStratusNetCDFModel& File;
  int NodeDimension = -1, FaceDimension = -1;
  std::array<int, 2> Layers = { { -1, -1 } };
  size_t LayerCount = 0; // 0: unknown
  std::string XName, YName;
  const Variable* Topology = nullptr;
  std::vector<double> X, Y; // in the file's units or degrees until faces are read, then in metres if they can be
  std::vector<vtkStratusUgridPlace> NodeOf, FaceOf;
  std::vector<uint8_t> Absent; // of each face
  std::array<double, 2> Factors = { { 1.0, 1.0 } };
  bool Degrees = false, Mpas = false;
  const bool Sphere;
  std::vector<int64_t> Offsets = { 0 }, FileOffsets;
  std::vector<int32_t> Corners, FileCorners; // the file's faces if those on the plane are others, otherwise empty
  std::string Description;
  bool Metres = false;
};

#endif
