// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenWriter.h"

#include "vtkStratusArrays.h"
#include "vtkStratusTetGenWriterFiles.h"

#include "vtkCellData.h"
#include "vtkErrorCode.h"
#include "vtkExecutive.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <filesystem>
#include <new>

vtkStandardNewMacro(vtkStratusTetGenWriter);

// State of one run of the writer.
class vtkStratusTetGenWriter::Internals
{
public:
  explicit Internals(vtkStratusTetGenWriter* writer) : Writer(writer) {}
  void Write(vtkDataObject* input, vtkPolyData* surface);

  std::vector<std::unique_ptr<vtkStratusTetGenOutput>> Files;

private:
  void SetBase(bool mesh);
  void Advance(std::uintmax_t bytes);
  void WriteMesh(vtkUnstructuredGrid* mesh, vtkPolyData* surface);
  void WriteSurface(vtkPolyData* surface);
  vtkStratusTetGenOutput& Open(const std::string& extension);

  vtkStratusTetGenWriter* Writer;
  const vtkStratusTetGenProgress Progress = [this](std::uintmax_t bytes) { this->Advance(bytes); };
  std::string Base, Extension;
  double Bytes = 0.0, BytesGuessed = 1.0;
};

namespace {
[[noreturn]] void Fail(const std::string& text, unsigned long code = vtkErrorCode::UnknownError)
{
  throw vtkStratusTetGenError{ text, code };
}

// Throws unless the surface and the mesh have the same points, because their cells refer to points by number.
void CheckSamePoints(vtkUnstructuredGrid* mesh, vtkPolyData* surface)
{
  const vtkIdType points = mesh->GetNumberOfPoints();
  if (surface->GetNumberOfPoints() != points) {
    Fail("the surface has " + std::to_string(surface->GetNumberOfPoints()) + " points, it must have the " + std::to_string(points) +
      " of the mesh");
  }
  for (vtkIdType point = 0; surface->GetPoints() != mesh->GetPoints() && point < points; ++point) {
    double a[3], b[3];
    surface->GetPoint(point, a);
    mesh->GetPoint(point, b);
    if (!std::equal(a, a + 3, b)) {
      Fail("point " + std::to_string(point) + " of the surface is not the mesh's, all must be the same");
    }
  }
}
} // namespace

void vtkStratusTetGenWriter::Internals::Advance(std::uintmax_t bytes)
{
  this->Bytes += static_cast<double>(bytes);
  this->Writer->UpdateProgress(std::min(1.0, this->Bytes / this->BytesGuessed));
  if (this->Writer->GetAbortExecute()) {
    Fail("writing " + this->Base + " was aborted", vtkErrorCode::UserError);
  }
}

void vtkStratusTetGenWriter::Internals::SetBase(bool mesh)
{
  const std::filesystem::path path(this->Writer->FileName ? this->Writer->FileName : "");
  if (path.empty()) {
    Fail("FileName is not set", vtkErrorCode::NoFileNameError);
  }
  this->Base = path.string();
  this->Extension = path.extension().string();
  const char* const of_mesh[] = { ".node", ".ele", ".neigh", ".face", ".edge" };
  const bool is_mesh = std::find(std::begin(of_mesh), std::end(of_mesh), this->Extension) != std::end(of_mesh);
  const bool is_surface = this->Extension == ".poly" || this->Extension == ".smesh";
  if (is_mesh || is_surface) {
    this->Base.resize(this->Base.size() - this->Extension.size());
  } else {
    this->Extension = ".smesh";
  }
  if (mesh ? is_surface : is_mesh) {
    Fail(std::string("FileName is ") + this->Writer->FileName +
      (mesh ? ", a mesh of tetrahedra is written as .node and .ele" : ", a surface is written as .poly or .smesh"));
  }
}

vtkStratusTetGenOutput& vtkStratusTetGenWriter::Internals::Open(const std::string& extension)
{
  this->Files.push_back(std::make_unique<vtkStratusTetGenOutput>(this->Base + extension, this->Progress));
  return *this->Files.back();
}

void vtkStratusTetGenWriter::Internals::WriteMesh(vtkUnstructuredGrid* mesh, vtkPolyData* surface)
{
  const vtkIdType first = this->Writer->FirstNumber;
  std::string error;
  if (!vtkStratusCheckGrid(mesh, error) ||
    !vtkStratusCheckArrays(mesh->GetPointData(), mesh->GetNumberOfPoints(), "points of the mesh", error) ||
    !vtkStratusCheckArrays(mesh->GetCellData(), mesh->GetNumberOfCells(), "cells of the mesh", error) ||
    (surface && !vtkStratusCheckSurface(surface, error))) {
    Fail(error);
  }
  if (surface) {
    CheckSamePoints(mesh, surface);
  }
  vtkStratusTetGenWriteNodes(this->Open(".node"), mesh, first);
  if (mesh->GetNumberOfCells() > 0) {
    vtkStratusTetGenWriteElements(this->Open(".ele"), mesh, first);
    vtkDataArray* neighbors = mesh->GetCellData()->GetArray("Neighbors");
    if (neighbors && neighbors->GetNumberOfTuples() != mesh->GetNumberOfCells()) {
      Fail("cell data 'Neighbors' have " + std::to_string(neighbors->GetNumberOfTuples()) + " tuples, they must have one for each of the " +
        std::to_string(mesh->GetNumberOfCells()) + " cells");
    }
    if (neighbors && neighbors->GetNumberOfComponents() == 4) {
      vtkStratusTetGenWriteNeighbors(this->Open(".neigh"), neighbors, first);
    }
    if (surface && surface->GetNumberOfCells() > 0 && mesh->GetCellType(0) != VTK_TETRA) {
      Fail("the tetrahedra are quadratic, faces and edges are written of linear ones only");
    }
  }
  if (surface && surface->GetNumberOfPolys() > 0) {
    vtkStratusTetGenWritePieces(this->Open(".face"), surface, 3, first);
  }
  if (surface && surface->GetNumberOfLines() > 0) {
    vtkStratusTetGenWritePieces(this->Open(".edge"), surface, 2, first);
  }
}

void vtkStratusTetGenWriter::Internals::WriteSurface(vtkPolyData* surface)
{
  std::string error;
  if (!vtkStratusCheckSurface(surface, error)) {
    Fail(error);
  }
  vtkStratusTetGenOutput& file = this->Open(this->Extension);
  vtkStratusTetGenWriteNodes(file, surface, this->Writer->FirstNumber);
  vtkStratusTetGenWriteComplex(file, surface, this->Extension == ".smesh", this->Writer->FirstNumber);
}

void vtkStratusTetGenWriter::Internals::Write(vtkDataObject* input, vtkPolyData* surface)
{
  this->Files.clear();
  this->Bytes = 0.0;
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::SafeDownCast(input);
  vtkPointSet* points = vtkPointSet::SafeDownCast(input);
  if (!points || points->GetNumberOfPoints() < 1) {
    Fail("the input has no points, it needs at least one");
  }
  this->BytesGuessed = 60.0 * static_cast<double>(points->GetNumberOfPoints()) + 40.0 * static_cast<double>(points->GetNumberOfCells());
  this->SetBase(mesh != nullptr);
  if (mesh) {
    this->WriteMesh(mesh, surface);
  } else {
    this->WriteSurface(vtkPolyData::SafeDownCast(input));
  }
  for (const auto& file : this->Files) {
    file->Close();
  }
  for (const auto& file : this->Files) {
    file->Commit();
  }
}

vtkStratusTetGenWriter::vtkStratusTetGenWriter() : Internal(new Internals(this))
{
  this->SetNumberOfInputPorts(2);
}

vtkStratusTetGenWriter::~vtkStratusTetGenWriter()
{
  this->SetFileName(nullptr);
}

int vtkStratusTetGenWriter::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 0) {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  } else {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

void vtkStratusTetGenWriter::WriteData()
{
  vtkPolyData* surface =
    this->GetNumberOfInputConnections(1) > 0 ? vtkPolyData::SafeDownCast(this->GetExecutive()->GetInputData(1, 0)) : nullptr;
  this->SetErrorCode(vtkErrorCode::NoError);
  try {
    this->Internal->Write(this->GetInput(), surface);
  } catch (const vtkStratusTetGenError& error) {
    this->SetErrorCode(error.Code);
    vtkErrorMacro(<< error.Text);
  } catch (const std::bad_alloc&) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< "out of memory while writing " << (this->FileName ? this->FileName : ""));
  }
  this->Internal->Files.clear(); // removes the files that were not committed
}

void vtkStratusTetGenWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "FirstNumber: " << this->FirstNumber << "\n";
}
