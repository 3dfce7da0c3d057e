// SPDX-License-Identifier: BSD-3-Clause
// Wrong TetGen files: each error names the line, the value and the allowed values. Both outputs are empty, nothing crashes, and no false
// count makes the reader allocate. Files are cut short at every byte, and bytes are changed. Argument: a folder to write to.
#include "tetgen_testing.h"

#include "vtkStratusTetGenReader.h"
#include "vtkStratusTetGenWriter.h"

#include "vtkErrorCode.h"
#include "vtkExecutive.h"

#include <limits>

namespace {
using Reader = vtkStratusTetGenReader;
std::string Folder;

// A reader's result: whether it read, its messages and its error code.
struct Outcome {
  bool Read;
  std::string Text;
  unsigned long Code;
};

Outcome ReadAgain(Reader* reader)
{
  vtkNew<ErrorObserver> errors, silence;
  reader->AddObserver(vtkCommand::ErrorEvent, errors);
  reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, silence); // it says that its algorithm has failed, too
  reader->Modified();
  reader->Update();
  const bool empty = reader->GetOutput()->GetNumberOfPoints() + reader->GetOutput()->GetNumberOfCells() == 0 &&
    reader->GetSurface()->GetNumberOfPoints() + reader->GetSurface()->GetNumberOfCells() == 0;
  CHECK(
    errors->Count <= 1 && (errors->Count == 0 || empty), "%d errors, the outputs hold something: %s", errors->Count, errors->Text.c_str());
  CHECK((errors->Count == 0) == (reader->GetErrorCode() == vtkErrorCode::NoError), "no error code for: %s", errors->Text.c_str());
  return { errors->Count == 0, errors->Text, reader->GetErrorCode() };
}

Outcome Read(const std::string& name)
{
  vtkNew<Reader> reader;
  reader->SetFileName((Folder + "/" + name).c_str());
  return ReadAgain(reader);
}

// A mesh of two tetrahedra, all files of it.
const std::pair<std::string, std::string> Good[] = {
  { ".node", "5 3 1 1\n1 0 0 0 10 1\n2 1 0 0 20 1\n3 0 1 0 30 1\n4 0 0 1 40 0\n5 1 1 1 50 -7\n" },
  { ".ele", "2 4 1\n1 1 2 3 4 8\n2 2 3 4 5 9\n" },
  { ".neigh", "2 4\n1 2 -1 -1 -1\n2 -1 -1 -1 1\n" },
  { ".face", "3 1\n1 1 2 3 5\n2 1 2 4 6\n3 2 3 4 0\n" },
  { ".edge", "2 1\n1 1 2 3\n2 2 3 4\n" },
  { ".poly",
    "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n2 1\n1 1 5\n3 0 1 2\n1 .1 .1 0\n1 0 6\n3 0 1 3\n1\n0 5 5 5\n1\n0 .1 .2 .3 4 5\n" },
  { ".smesh", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n2 1\n3 0 1 2 5\n3 0 1 3 6\n1\n0 5 5 5\n1\n0 .1 .2 .3 4 5\n" },
};

void WriteGood()
{
  for (const auto& file : Good) {
    WriteText(Folder + "/mesh" + file.first, file.second);
  }
}

const std::string& GoodText(const std::string& extension)
{
  return std::find_if(std::begin(Good), std::end(Good), [&](const auto& file) { return file.first == extension; })->second;
}

// One file of the mesh is another; error must hold all words.
void Refused(const std::string& extension, const std::string& text, const std::vector<std::string>& words, unsigned long code)
{
  WriteText(Folder + "/mesh" + extension, text);
  const Outcome outcome = Read("mesh" + extension);
  CHECK(!outcome.Read && outcome.Code == code, "%s was read or fails otherwise (%lu): '%s' %s", extension.c_str(), outcome.Code,
    text.c_str(), outcome.Text.c_str());
  CHECK(outcome.Read || outcome.Text.find("mesh" + extension) != std::string::npos, "'%s' names no file", outcome.Text.c_str());
  for (const std::string& word : words) {
    CHECK(outcome.Text.find(word) != std::string::npos, "'%s' says nothing of '%s'", outcome.Text.c_str(), word.c_str());
  }
  WriteText(Folder + "/mesh" + extension, GoodText(extension));
}

void Wrong(const std::string& extension, const std::string& text, const std::vector<std::string>& words)
{
  Refused(extension, text, words, vtkErrorCode::FileFormatError);
}

void Short(const std::string& extension, const std::string& text, const std::vector<std::string>& words)
{
  Refused(extension, text, words, vtkErrorCode::PrematureEndOfFileError);
}

void GoodIsRead()
{
  WriteGood();
  for (const auto& file : Good) {
    const Outcome outcome = Read("mesh" + file.first);
    CHECK(outcome.Read, "%s", outcome.Text.c_str());
  }
}

void WrongFiles()
{
  Short(".node", "", { "after line 0", "0 of 1 headers" });
  Short(".node", "# nothing but this\n", { "after line 1" });
  Wrong(".node", "five 3 0 0\n", { "line 1", "number of points", "'five'" });
  Wrong(".node", "-1 3 0 0\n", { "line 1", "'-1'", "from 0" });
  Wrong(".node", "1000000000000 3 0 0\n1 0 0 0\n", { "line 1", "1000000000000", "no more than 1" });
  Wrong(".node", "99999999999999999999 3 0 0\n", { "line 1", "'99999999999999999999'" });
  Wrong(".node", "1 3 4000000000 0\n1 0 0 0\n", { "line 1", "'4000000000'", "4096" });
  Wrong(".node", "500 3 4000 0\n1 0 0 0\n", { "line 1", "number of points is 500", "can hold no more than 0" });
  Wrong(".node", "1 3 0 1\n1 0 0 0\n", { "line 2", "the line ends where the marker must be" });
  Wrong(".node", "5 2 0 0\n", { "line 1", "dimension is '2'", "it must be 3" });
  Wrong(".node", "5 3 0 2\n", { "line 1", "flag of markers is '2'", "from 0 to 1" });
  Wrong(".node", "5 3 0 0 7\n", { "line 1", "more on the line", "'7'" });
  Wrong(".node", "1 3 0 0\n\n2 0 0 0\n", { "line 3", "number of the first point is '2'", "from 0 to 1" });
  Wrong(".node", "2 3 0 0\n0 0 0 0\n2 0 0 0\n", { "line 3", "point's number is '2'", "it must be 1" });
  Wrong(".node", "2 3 0 0\n0 0 0 0\n1 0 0\n", { "line 3", "the line ends where z must be" });
  Wrong(".node", "1 3 0 0\n0 0 0x10 0\n", { "line 2", "y is '0x10'" });
  Wrong(".node", "1 3 0 0\n0 0 nan 0\n", { "line 2", "y is nan", "finite" });
  Wrong(".node", "1 3 0 0\n0 1e999 0 0\n", { "line 2", "x is '1e999'" });
  Wrong(".node", "1 3 0 1\n0 0 0 0 3000000000\n", { "line 2", "marker is '3000000000'", "2147483647" });
  Wrong(".node", "1 3 0 0\n0 0 0 0 1\n", { "line 2", "more on the line" });
  Wrong(".node", "1 3 0 0\n0 0 0 0\n1 0 0 0\n", { "line 3", "more than the 1 points" });
  Wrong(".node", std::string("1 3 0 0\n0 0 \0\x01 0\n", 17), { "line 2", "y is '", "?" });
  Short(".node", "2 3 0 0\n0 0 0 0\n", { "after line 2", "1 of 2 points" });
  Wrong(".ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 6\n", { "line 3", "corner is '6'", "from 1 to 5" });
  Wrong(".ele", "2 4 0\n1 1 2 3 0\n2 2 3 4 5\n", { "line 2", "corner is '0'", "from 1 to 5" });
  Wrong(".ele", "2 4 0\n0 1 2 3 4\n", { "line 2", "tetrahedron's number is '0'", "it must be 1" });
  Wrong(".ele", "2 5 0\n", { "line 1", "is 5, it must be 4 or 10" });
  Wrong(".ele", "9000000000000000000 4 0\n1 1 2 3 4\n", { "line 1", "9000000000000000000" });
  Wrong(".ele", "2 4 0\n1 1 2 3 4\n2 2 3 4.5 5\n", { "line 3", "corner is '4.5'", "integer" });
  Short(".ele", "2 4 0\n1 1 2 3 4\n", { "1 of 2 tetrahedra" });
  Wrong(".neigh", "3 4\n", { "line 1", "number of tetrahedra is '3'", "it must be 2" });
  Wrong(".neigh", "2 4\n1 3 -1 -1 -1\n", { "line 2", "neighbor is '3'", "from -1 to 2" });
  Wrong(".neigh", "2 4\n1 0 -1 -1 -1\n", { "line 2", "neighbor is '0'" });
  Wrong(".face", "3 1\n1 1 2 3\n", { "line 2", "the line ends where the marker must be" });
  Wrong(".face", "1 0\n1 1 2 9\n", { "line 2", "corner is '9'", "from 1 to 5" });
  Wrong(".edge", "1 0\n1 1 2 1 5\n", { "line 2", "more on the line", "'5'" });
  const std::string points = "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n";
  Wrong(".smesh", points + "1 1\n3 0 1 4 5\n0\n", { "line 7", "corner is '4'", "from 0 to 3" });
  Wrong(".smesh", points + "1 1\n0 5\n0\n", { "line 7", "corners is 0", "at least 1" });
  Wrong(".smesh", points + "1 1\n3 0 1 2 5 6\n0\n", { "line 7", "more on the line", "'6'" });
  Short(".smesh", points + "1 1\n3 0 1\n", { "after line 7", "2 of 3 corners" });
  Short(".poly", points + "1 1\n1 1 1\n3 0 1 2\n", { "after line 8", "0 of 1 holes of a facet" });
  Short(".poly", points + "1 1\n1 0 1\n3 0 1 2\n", { "0 of 1 lists of holes" });
  Wrong(".poly", points + "1 1\n1 0 1\n3 0 1 2\n0\n1\n1 0 0 0\n", { "line 11", "region's attribute" });
  Wrong(".poly", points + "1 1\n7000000 0 1\n3 0 1 2\n", { "line 7", "number of polygons of a facet is 7000000" });
}

void MissingFiles()
{
  Outcome outcome = Read("nothing");
  CHECK(!outcome.Read && outcome.Code == vtkErrorCode::FileNotFoundError && outcome.Text.find("nothing") != std::string::npos, "%s",
    outcome.Text.c_str());
  std::filesystem::remove(Folder + "/mesh.node");
  outcome = Read("mesh.ele");
  CHECK(!outcome.Read && outcome.Text.find("mesh.node") != std::string::npos, "%s", outcome.Text.c_str());
  WriteGood();
  std::filesystem::remove(Folder + "/mesh.ele");
  outcome = Read("mesh.neigh"); // neighbours of what?
  CHECK(!outcome.Read && outcome.Text.find("mesh.ele") != std::string::npos, "%s", outcome.Text.c_str());
  WriteText(Folder + "/mesh.edge", "1 1\n1 1 2 3 4\n");
  std::filesystem::remove(Folder + "/mesh.face");
  std::filesystem::remove(Folder + "/mesh.neigh");
  outcome = Read("mesh.edge"); // a middle, or a tetrahedron?
  CHECK(!outcome.Read && outcome.Text.find("line 2") != std::string::npos, "%s", outcome.Text.c_str());
  std::filesystem::create_directory(Folder + "/folder.node");
  outcome = Read("folder.node");
  CHECK(!outcome.Read && outcome.Text.find("regular") != std::string::npos, "%s", outcome.Text.c_str());
  vtkNew<Reader> reader;
  outcome = ReadAgain(reader);
  CHECK(!outcome.Read && outcome.Code == vtkErrorCode::NoFileNameError, "%s", outcome.Text.c_str());
  WriteGood();
}

// Returns where the last number of a text begins. A file that is cut behind this place lacks only digits, which no reader can notice.
size_t LastNumber(const std::string& text)
{
  return text.find_last_of(" \n", text.find_last_not_of(" \n")) + 1;
}

void CutFiles()
{
  for (const auto& file : Good) {
    size_t end = LastNumber(file.second);
    if (file.first == ".poly" || file.first == ".smesh") {
      end = file.second.find("1\n0 .1"); // the regions may be missing as a whole: a cut right before them is none
    }
    for (size_t bytes = 0; bytes < end; ++bytes) {
      WriteText(Folder + "/mesh" + file.first, file.second.substr(0, bytes));
      CHECK(!Read("mesh" + file.first).Read || bytes + 1 >= end, "%s of %zu bytes of %zu was read", file.first.c_str(), bytes, end);
    }
    WriteText(Folder + "/mesh" + file.first, file.second);
  }
}

// Replaces any byte by any other: the reader reads or refuses, and a mesh that it reads refers only to points that exist.
void ChangedFiles()
{
  const std::string bytes("0123456789-+.e \n#\0\xff", 19);
  unsigned state = 7;
  int read = 0, refused = 0;
  for (const auto& file : Good) {
    for (int turn = 0; turn < 500; ++turn) {
      std::string text = file.second;
      for (int change = 0; change < 1 + turn % 3; ++change) {
        state = state * 1664525u + 1013904223u;
        text[(state >> 8) % text.size()] = bytes[(state >> 3) % bytes.size()];
      }
      WriteText(Folder + "/mesh" + file.first, text);
      vtkNew<Reader> reader;
      reader->SetFileName((Folder + "/mesh" + file.first).c_str());
      const Outcome outcome = ReadAgain(reader);
      ++(outcome.Read ? read : refused);
      CHECK(outcome.Read || outcome.Text.find("mesh.") != std::string::npos, "'%s' names no file", outcome.Text.c_str());
      const vtkIdType points = reader->GetOutput()->GetNumberOfPoints();
      for (vtkCellArray* cells : { reader->GetOutput()->GetCells(), reader->GetSurface()->GetPolys(), reader->GetSurface()->GetLines() }) {
        vtkNew<vtkIdList> ids;
        for (vtkIdType cell = 0; cells && cell < cells->GetNumberOfCells(); ++cell) {
          cells->GetCellAtId(cell, ids);
          CHECK(std::all_of(ids->begin(), ids->end(), [points](vtkIdType id) { return id >= 0 && id < points; }), "%s", text.c_str());
        }
      }
    }
    WriteText(Folder + "/mesh" + file.first, file.second);
  }
  CHECK(read > 100 && refused > 1000, "%d read, %d refused: the changes are too many or too few", read, refused);
}

// Aborts every filter that reports progress.
class Stopper : public vtkCommand
{
public:
  static Stopper* New() { return new Stopper; }
  void Execute(vtkObject* caller, unsigned long, void*) override { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); }
};

void StoppingAndWriting()
{
  vtkNew<Stopper> stopper;
  vtkNew<Reader> reader;
  reader->SetFileName((Folder + "/mesh").c_str());
  reader->AddObserver(vtkCommand::ProgressEvent, stopper);
  const Outcome outcome = ReadAgain(reader);
  CHECK(!outcome.Read && outcome.Text.find("aborted") != std::string::npos, "%s", outcome.Text.c_str());

  vtkNew<Reader> mesh;
  mesh->SetFileName((Folder + "/mesh").c_str());
  mesh->Update();
  const auto refuses = [&](
                         const char* word, const std::function<void(vtkStratusTetGenWriter*, vtkUnstructuredGrid*, vtkPolyData*)>& breaks) {
    vtkNew<vtkUnstructuredGrid> grid;
    grid->DeepCopy(mesh->GetOutput());
    vtkNew<vtkPolyData> surface;
    surface->DeepCopy(mesh->GetSurface());
    vtkNew<vtkStratusTetGenWriter> writer;
    vtkNew<ErrorObserver> errors;
    writer->AddObserver(vtkCommand::ErrorEvent, errors);
    writer->SetInputData(grid);
    writer->SetInputData(1, surface);
    writer->SetFileName((Folder + "/mesh").c_str());
    breaks(writer, grid, surface);
    CHECK(writer->Write() == 0 && errors->Count == 1 && errors->Has(word), "'%s' says nothing of '%s'", errors->Text.c_str(), word);
    for (const auto& file : Good) { // what was there is there
      CHECK(ReadText(Folder + "/mesh" + file.first) == file.second, "%s: %s was overwritten", word, file.first.c_str());
    }
    for (const auto& file : std::filesystem::directory_iterator(Folder)) {
      CHECK(file.path().extension() != ".part", "%s: %s was left", word, file.path().c_str());
    }
  };
  using W = vtkStratusTetGenWriter;
  using G = vtkUnstructuredGrid;
  using P = vtkPolyData;
  refuses("aborted", [&](W* w, G*, P*) { w->AddObserver(vtkCommand::ProgressEvent, stopper); });
  refuses("FileName", [&](W* w, G*, P*) { w->SetFileName(nullptr); });
  refuses("no/such/folder", [&](W* w, G*, P*) { w->SetFileName((Folder + "/no/such/folder/mesh").c_str()); });
  refuses(".node and .ele", [&](W* w, G*, P*) { w->SetFileName((Folder + "/mesh.poly").c_str()); });
  refuses(".poly or .smesh", [&](W* w, G*, P* p) {
    w->SetInputData(p);
    w->SetFileName((Folder + "/mesh.node").c_str());
  });
  {
    vtkNew<vtkStratusTetGenWriter> writer;
    writer->SetInputData(mesh->GetSurface());
    writer->SetFileName((Folder + "/" + std::string(249, 'n') + ".smesh").c_str()); // 255 bytes, which is as long as file systems take
    CHECK(writer->Write() == 1, "a long name is not written");
    std::filesystem::create_symlink("target.smesh", Folder + "/link.smesh");
    writer->SetFileName((Folder + "/link.smesh").c_str());
    CHECK(writer->Write() == 1 && std::filesystem::is_symlink(Folder + "/link.smesh") && !ReadText(Folder + "/target.smesh").empty(),
      "a link was replaced, not the file that it leads to");
  }
  refuses("no points", [&](W*, G* g, P*) { g->Initialize(); });
  refuses("type 5", [&](W*, G* g, P*) {
    g->GetCellData()->Initialize();
    const vtkIdType corners[3] = { 0, 1, 2 };
    g->InsertNextCell(VTK_TRIANGLE, 3, corners);
  });
  refuses("coordinates hold", [&](W*, G* g, P* p) {
    g->GetPoints()->SetPoint(2, 0, std::numeric_limits<double>::quiet_NaN(), 0);
    p->SetPoints(g->GetPoints());
  });
  refuses("'Attribute1' hold", [&](W*, G* g, P*) { g->GetCellData()->GetArray("Attribute1")->SetComponent(1, 0, HUGE_VAL); });
  refuses("'Neighbors' hold", [&](W*, G* g, P*) { g->GetCellData()->GetArray("Neighbors")->SetComponent(1, 0, 2); });
  const auto cut = [](vtkDataSetAttributes* data, const char* name, vtkIdType tuples) { data->GetArray(name)->SetNumberOfTuples(tuples); };
  refuses(
    "'Attribute1' has 1 tuples, it must have one for each of the 2 cells", [&](W*, G* g, P*) { cut(g->GetCellData(), "Attribute1", 1); });
  refuses(
    "'Attribute1' has 3 tuples, it must have one for each of the 5 points", [&](W*, G* g, P*) { cut(g->GetPointData(), "Attribute1", 3); });
  refuses("'Neighbors' has 1 tuples", [&](W*, G* g, P*) { cut(g->GetCellData(), "Neighbors", 1); });
  refuses("'Neighbors' have 3 tuples", [&](W*, G* g, P*) { cut(g->GetCellData(), "Neighbors", 3); });
  refuses("'Marker' has 1 tuples", [&](W*, G*, P* p) { cut(p->GetCellData(), "Marker", 1); });
  refuses("names point 77, outside", [&](W*, G*, P* p) {
    const vtkIdType corners[3] = { 0, 1, 77 };
    p->GetPolys()->InsertNextCell(3, corners);
  });
  refuses("names point 77, outside", [&](W*, G* g, P*) {
    const vtkIdType corners[4] = { 0, 1, 2, 77 };
    g->GetCellData()->Initialize();
    g->InsertNextCell(VTK_TETRA, 4, corners);
  });
  refuses("3 points, a tetrahedron of type 10 has 4", [&](W*, G* g, P*) {
    const vtkIdType corners[3] = { 0, 1, 2 };
    g->GetCellData()->Initialize();
    g->InsertNextCell(VTK_TETRA, 3, corners);
  });
  refuses("point 2 of the surface", [&](W*, G*, P* p) { p->GetPoints()->SetPoint(2, 9, 9, 9); });
  refuses("72", [&](W*, G* g, P*) {
    vtkNew<vtkDoubleArray> wide;
    wide->SetName("wide");
    wide->SetNumberOfComponents(80);
    wide->SetNumberOfTuples(g->GetNumberOfPoints());
    wide->FillValue(1);
    g->GetPointData()->AddArray(wide);
  });
  refuses("strips", [&](W* w, G*, P* p) {
    vtkNew<vtkCellArray> strips;
    const vtkIdType corners[4] = { 0, 1, 2, 3 };
    strips->InsertNextCell(4, corners);
    p->SetStrips(strips);
    p->GetCellData()->Initialize();
    w->SetInputData(p);
  });
}
} // namespace

int main(int argc, char** argv)
{
  Folder = std::string(argc > 1 ? argv[1] : ".") + "/tetgen-bad-files";
  std::filesystem::remove_all(Folder);
  std::filesystem::create_directories(Folder);
  GoodIsRead();
  WrongFiles();
  MissingFiles();
  CutFiles();
  ChangedFiles();
  StoppingAndWriting();
  std::filesystem::remove_all(Folder);
  return Failures == 0 ? 0 : 1;
}
