// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenReader.h"

#include "vtkStratusTetGenComplex.h"
#include "vtkStratusTetGenMesh.h"

#include "vtkCellData.h"
#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <filesystem>
#include <new>

vtkStandardNewMacro(vtkStratusTetGenReader);

// State of one run of the reader.
class vtkStratusTetGenReader::Internals
{
public:
  explicit Internals(vtkStratusTetGenReader* reader) : Reader(reader) {}
  void Read(vtkUnstructuredGrid* mesh, vtkPolyData* surface);

private:
  std::string PathOf(const char* extension) const { return this->Base + extension; }
  bool IsWanted(const char* extension, bool asked) const;
  void FindFiles();
  void Advance(std::uintmax_t bytes);
  void ReadMesh(vtkUnstructuredGrid* mesh, vtkPolyData* surface);
  int ReadElements(vtkUnstructuredGrid* mesh);
  void ReadPieces(int second_order, vtkPolyData* surface);
  void ReadComplex(vtkUnstructuredGrid* mesh, vtkPolyData* surface);
  void FillPointData(vtkPointData* data) const;

  vtkStratusTetGenReader* Reader;
  const vtkStratusTetGenProgress Progress = [this](std::uintmax_t bytes) { this->Advance(bytes); };
  std::string Base;
  std::string Extension; // of FileName, or of the file that was found
  std::uintmax_t BytesRead = 0, BytesAll = 1;
  vtkStratusTetGenNodes Nodes;
};

namespace {
const char* const Extensions[] = { ".node", ".ele", ".neigh", ".face", ".edge", ".poly", ".smesh" };

bool Exists(const std::string& path)
{
  std::error_code error;
  return std::filesystem::exists(path, error);
}
} // namespace

void vtkStratusTetGenReader::Internals::Advance(std::uintmax_t bytes)
{
  this->BytesRead += bytes;
  this->Reader->UpdateProgress(std::min(1.0, static_cast<double>(this->BytesRead) / static_cast<double>(this->BytesAll)));
  if (this->Reader->GetAbortExecute()) {
    throw vtkStratusTetGenError{ "reading " + this->Base + " was aborted", vtkErrorCode::UserError };
  }
}

// Returns whether to read the mesh's file of this kind.
bool vtkStratusTetGenReader::Internals::IsWanted(const char* extension, bool asked) const
{
  return this->Extension == extension || (asked && Exists(this->PathOf(extension)));
}

void vtkStratusTetGenReader::Internals::FindFiles()
{
  const std::filesystem::path path(this->Reader->FileName ? this->Reader->FileName : "");
  if (path.empty()) {
    throw vtkStratusTetGenError{ "FileName is not set", vtkErrorCode::NoFileNameError };
  }
  this->Extension = path.extension().string();
  this->Base = path.string();
  if (std::find(std::begin(Extensions), std::end(Extensions), this->Extension) != std::end(Extensions)) {
    this->Base.resize(this->Base.size() - this->Extension.size());
  } else {
    const char* const first[] = { ".ele", ".poly", ".smesh", ".face", ".edge", ".node" };
    const auto found = std::find_if(std::begin(first), std::end(first), [this](const char* one) { return Exists(this->PathOf(one)); });
    if (found == std::end(first)) {
      throw vtkStratusTetGenError{ "there is no " + this->Base + " with .node, .ele, .neigh, .face, .edge, .poly or .smesh behind it",
        vtkErrorCode::FileNotFoundError };
    }
    this->Extension = *found;
  }
  this->BytesRead = 0;
  this->BytesAll = 1;
  for (const char* extension : Extensions) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(this->PathOf(extension), error);
    const bool complex = this->Extension == ".poly" || this->Extension == ".smesh";
    const bool read = complex ? this->Extension == extension : extension != std::string(".poly") && extension != std::string(".smesh");
    this->BytesAll += !error && read ? size : 0;
  }
}

void vtkStratusTetGenReader::Internals::FillPointData(vtkPointData* data) const
{
  for (const auto& attribute : this->Nodes.Attributes) {
    data->AddArray(attribute);
  }
  if (!this->Nodes.Attributes.empty()) {
    data->SetActiveScalars(this->Nodes.Attributes[0]->GetName());
  }
  if (this->Nodes.Markers) {
    data->AddArray(this->Nodes.Markers);
  }
}

// Returns whether the tetrahedra are of second order, -1 where there are none.
int vtkStratusTetGenReader::Internals::ReadElements(vtkUnstructuredGrid* mesh)
{
  const bool neighbors = this->IsWanted(".neigh", this->Reader->ReadNeighbors != 0);
  if (!this->IsWanted(".ele", true) && !neighbors) {
    return -1;
  }
  vtkStratusTetGenElements elements;
  {
    vtkStratusTetGenInput input(this->PathOf(".ele"), this->Progress);
    vtkStratusTetGenReadElements(input, this->Nodes, elements);
  }
  vtkSmartPointer<vtkCellArray> cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(elements.Corners, elements.Connectivity);
  mesh->SetCells(elements.Corners == 4 ? VTK_TETRA : VTK_QUADRATIC_TETRA, cells);
  for (const auto& attribute : elements.Attributes) {
    mesh->GetCellData()->AddArray(attribute);
  }
  if (!elements.Attributes.empty()) {
    mesh->GetCellData()->SetActiveScalars(elements.Attributes[0]->GetName());
  }
  if (neighbors) {
    vtkStratusTetGenInput input(this->PathOf(".neigh"), this->Progress);
    mesh->GetCellData()->AddArray(vtkStratusTetGenReadNeighbors(input, this->Nodes.First, elements.Count));
  }
  return elements.Corners == 4 ? 0 : 1;
}

void vtkStratusTetGenReader::Internals::ReadPieces(int second_order, vtkPolyData* surface)
{
  vtkStratusTetGenPieces edges, faces;
  const bool any_faces = this->IsWanted(".face", this->Reader->ReadFaces != 0);
  const bool any_edges = this->IsWanted(".edge", this->Reader->ReadEdges != 0);
  if (any_faces) {
    vtkStratusTetGenInput input(this->PathOf(".face"), this->Progress);
    second_order = vtkStratusTetGenReadPieces(input, this->Nodes, 3, second_order, faces);
    vtkSmartPointer<vtkCellArray> cells = vtkSmartPointer<vtkCellArray>::New();
    cells->SetData(3, faces.Connectivity);
    surface->SetPolys(cells);
  }
  if (any_edges) {
    vtkStratusTetGenInput input(this->PathOf(".edge"), this->Progress);
    vtkStratusTetGenReadPieces(input, this->Nodes, 2, second_order, edges);
    vtkSmartPointer<vtkCellArray> cells = vtkSmartPointer<vtkCellArray>::New();
    cells->SetData(2, edges.Connectivity);
    surface->SetLines(cells);
  }
  if (!edges.Markers && !faces.Markers) {
    return;
  }
  // Lines precede polygons in a vtkPolyData. Cells of a file without markers get 0, as in TetGen.
  const vtkIdType lines = surface->GetNumberOfLines();
  vtkSmartPointer<vtkIntArray> markers = vtkSmartPointer<vtkIntArray>::New();
  markers->SetName("Marker");
  markers->SetNumberOfValues(surface->GetNumberOfCells());
  markers->FillValue(0);
  for (vtkIdType line = 0; edges.Markers && line < lines; ++line) {
    markers->SetValue(line, edges.Markers->GetValue(line));
  }
  for (vtkIdType face = 0; faces.Markers && face < faces.Markers->GetNumberOfValues(); ++face) {
    markers->SetValue(lines + face, faces.Markers->GetValue(face));
  }
  surface->GetCellData()->AddArray(markers);
}

void vtkStratusTetGenReader::Internals::ReadMesh(vtkUnstructuredGrid* mesh, vtkPolyData* surface)
{
  {
    vtkStratusTetGenInput input(this->PathOf(".node"), this->Progress);
    vtkStratusTetGenReadNodes(input, true, this->Nodes);
  }
  mesh->SetPoints(this->Nodes.Points);
  surface->SetPoints(this->Nodes.Points);
  const int second_order = this->ReadElements(mesh);
  this->ReadPieces(second_order, surface);
}

void vtkStratusTetGenReader::Internals::ReadComplex(vtkUnstructuredGrid* mesh, vtkPolyData* surface)
{
  vtkStratusTetGenInput input(this->PathOf(this->Extension.c_str()), this->Progress);
  vtkStratusTetGenReadNodes(input, false, this->Nodes);
  if (this->Nodes.Points->GetNumberOfPoints() == 0) {
    vtkStratusTetGenInput nodes(this->PathOf(".node"), this->Progress);
    vtkStratusTetGenReadNodes(nodes, true, this->Nodes);
  }
  mesh->SetPoints(this->Nodes.Points);
  vtkStratusTetGenReadComplex(input, this->Extension == ".smesh", this->Nodes, surface);
}

void vtkStratusTetGenReader::Internals::Read(vtkUnstructuredGrid* mesh, vtkPolyData* surface)
{
  this->Nodes = vtkStratusTetGenNodes();
  this->FindFiles();
  if (this->Extension == ".poly" || this->Extension == ".smesh") {
    this->ReadComplex(mesh, surface);
  } else {
    this->ReadMesh(mesh, surface);
  }
  this->FillPointData(mesh->GetPointData());
  this->FillPointData(surface->GetPointData());
  this->Nodes = vtkStratusTetGenNodes();
}

vtkStratusTetGenReader::vtkStratusTetGenReader() : Internal(new Internals(this))
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
}

vtkStratusTetGenReader::~vtkStratusTetGenReader()
{
  this->SetFileName(nullptr);
}

vtkPolyData* vtkStratusTetGenReader::GetSurface()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(1));
}

int vtkStratusTetGenReader::FillOutputPortInformation(int port, vtkInformation* info)
{
  if (port == 0) {
    return this->Superclass::FillOutputPortInformation(port, info);
  }
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPolyData");
  return 1;
}

int vtkStratusTetGenReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::GetData(outputs, 0);
  vtkPolyData* surface = vtkPolyData::GetData(outputs, 1);
  this->SetErrorCode(vtkErrorCode::NoError);
  try {
    this->Internal->Read(mesh, surface);
    return 1;
  } catch (const vtkStratusTetGenError& error) {
    this->SetErrorCode(error.Code);
    vtkErrorMacro(<< error.Text);
  } catch (const std::bad_alloc&) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< "out of memory while reading " << this->FileName);
  }
  mesh->Initialize();
  surface->Initialize();
  return 0;
}

void vtkStratusTetGenReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "ReadFaces: " << (this->ReadFaces ? "On" : "Off") << "\n";
  os << indent << "ReadEdges: " << (this->ReadEdges ? "On" : "Off") << "\n";
  os << indent << "ReadNeighbors: " << (this->ReadNeighbors ? "On" : "Off") << "\n";
}
