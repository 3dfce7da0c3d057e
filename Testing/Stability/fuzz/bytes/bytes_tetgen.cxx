// SPDX-License-Identifier: BSD-3-Clause
// TetGen's files: the first byte selects the file that the reader opens. Then each file follows: a byte that selects its ending, and its
// text up to a byte 0x1e. A mesh that is read refers only to points that exist, and comes back equal after it is written.
#include "bytes.h"

#include "vtkStratusTetGenReader.h"
#include "vtkStratusTetGenWriter.h"

#include "vtkCellArray.h"
#include "vtkCommand.h"
#include "vtkExecutive.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace {
const char* const Endings[] = { ".node", ".ele", ".neigh", ".face", ".edge", ".poly", ".smesh", "" };
std::string Folder;

class Counter : public vtkCommand
{
public:
  static Counter* New() { return new Counter; }
  void Execute(vtkObject*, unsigned long, void*) override { ++this->Count; }
  int Count = 0;
};

void Clear()
{
  for (const char* name : { "in", "out" }) {
    for (const char* ending : Endings) {
      std::filesystem::remove(Folder + "/" + name + ending);
    }
  }
}

void WriteFiles(const uint8_t* data, size_t size)
{
  const uint8_t* end = data + size;
  while (data < end) {
    const uint8_t* stop = std::find(data, end, uint8_t(0x1e));
    std::ofstream(Folder + "/in" + Endings[*data % 7], std::ios::binary)
      .write(reinterpret_cast<const char*>(data) + 1, std::max<long>(0, stop - data - 1));
    data = stop == end ? end : stop + 1;
  }
}

// Returns whether the mesh was read. A refused one gives one error and an empty output.
bool Read(vtkStratusTetGenReader* reader, const std::string& path)
{
  vtkNew<Counter> errors, silence;
  reader->AddObserver(vtkCommand::ErrorEvent, errors);
  reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, silence);
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkUnstructuredGrid* mesh = reader->GetOutput();
  vtkPolyData* surface = reader->GetSurface();
  const bool read = errors->Count == 0;
  HOLDS(errors->Count <= 1 && read == (reader->GetErrorCode() == 0), "%d errors, code %lu", errors->Count, reader->GetErrorCode());
  HOLDS(read || mesh->GetNumberOfPoints() + mesh->GetNumberOfCells() + surface->GetNumberOfPoints() + surface->GetNumberOfCells() == 0,
    "refused, but the outputs hold something");
  return read;
}

void CheckCells(vtkCellArray* cells, vtkIdType points)
{
  for (vtkIdType cell = 0; cells && cell < cells->GetNumberOfCells(); ++cell) {
    vtkIdType size = 0;
    const vtkIdType* corners = nullptr;
    cells->GetCellAtId(cell, size, corners);
    for (vtkIdType corner = 0; corner < size; ++corner) {
      HOLDS(corners[corner] >= 0 && corners[corner] < points, "cell %lld names point %lld of %lld", static_cast<long long>(cell),
        static_cast<long long>(corners[corner]), static_cast<long long>(points));
    }
  }
}

void WriteAndRead(vtkStratusTetGenReader* first)
{
  vtkUnstructuredGrid* mesh = first->GetOutput();
  vtkNew<vtkStratusTetGenWriter> writer;
  vtkNew<Counter> errors;
  const bool cells = mesh->GetNumberOfCells() > 0;
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  writer->SetInputData(0, cells ? static_cast<vtkDataObject*>(mesh) : first->GetSurface());
  writer->SetFileName((Folder + (cells ? "/out.node" : "/out.poly")).c_str());
  writer->Write();
  if (errors->Count > 0) {
    return; // refused: infinite coordinates, too many columns
  }
  vtkNew<vtkStratusTetGenReader> second;
  HOLDS(Read(second, Folder + (cells ? "/out.ele" : "/out.poly")), "what was written is refused");
  HOLDS(second->GetOutput()->GetNumberOfPoints() == mesh->GetNumberOfPoints() &&
      second->GetOutput()->GetNumberOfCells() == mesh->GetNumberOfCells(),
    "written and read, it has %lld points, not %lld", static_cast<long long>(second->GetOutput()->GetNumberOfPoints()),
    static_cast<long long>(mesh->GetNumberOfPoints()));
  HOLDS(
    cells || second->GetSurface()->GetNumberOfPolys() == first->GetSurface()->GetNumberOfPolys(), "written and read, it has other facets");
}
} // namespace

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  if (Folder.empty()) {
    std::string name = std::string(access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp") + "/stratus-tetgen-XXXXXX";
    HOLDS(mkdtemp(name.data()), "no folder");
    Folder = name;
    std::atexit([] { std::filesystem::remove_all(Folder); });
  }
  if (size < 2) {
    return 0;
  }
  Clear();
  WriteFiles(data + 1, size - 1);
  vtkNew<vtkStratusTetGenReader> reader;
  reader->SetReadFaces(data[0] >> 3 & 1);
  reader->SetReadEdges(data[0] >> 4 & 1);
  reader->SetReadNeighbors(data[0] >> 5 & 1);
  if (Read(reader, Folder + "/in" + Endings[data[0] % 8])) {
    const vtkIdType points = reader->GetOutput()->GetNumberOfPoints();
    CheckCells(reader->GetOutput()->GetCells(), points);
    for (vtkCellArray* cells : { reader->GetSurface()->GetPolys(), reader->GetSurface()->GetLines() }) {
      CheckCells(cells, reader->GetSurface()->GetNumberOfPoints());
    }
    WriteAndRead(reader);
  }
  return 0;
}
