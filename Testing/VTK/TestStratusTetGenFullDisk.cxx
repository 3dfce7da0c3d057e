// SPDX-License-Identifier: BSD-3-Clause
// TetGen's files on a disk that is full from byte n of a file on, for every n, behind links, and in folders that take no file: an error
// that says which file and why, the old files stay as they were, and no other file is left. Argument: a folder to write to.
#include "tetgen_testing.h"

#include "vtkStratusTetGenReader.h"
#include "vtkStratusTetGenWriter.h"

#include "vtkErrorCode.h"

#include <csignal>
#include <map>
#include <sys/resource.h>

namespace {
using Files = std::map<std::string, std::string>;
std::string Folder;

Files ReadFolder()
{
  Files files;
  for (const auto& entry : std::filesystem::directory_iterator(Folder)) {
    files[entry.path().filename().string()] = ReadText(entry.path().string());
  }
  return files;
}

// A mesh of two tetrahedra with faces and edges; `shift` makes other files of it.
void FillReader(vtkStratusTetGenReader* reader, double shift)
{
  const std::string base = Folder + "/source";
  WriteText(base + ".node", "5 3 1 1\n1 " + std::to_string(shift) + " 0 0 10 1\n2 1 0 0 20 1\n3 0 1 0 30 1\n4 0 0 1 40 0\n5 1 1 1 50 -7\n");
  WriteText(base + ".ele", "2 4 1\n1 1 2 3 4 8\n2 2 3 4 5 9\n");
  WriteText(base + ".neigh", "2 4\n1 2 -1 -1 -1\n2 -1 -1 -1 1\n");
  WriteText(base + ".face", "3 1\n1 1 2 3 5\n2 1 2 4 6\n3 2 3 4 0\n");
  WriteText(base + ".edge", "2 1\n1 1 2 3\n2 2 3 4\n");
  reader->SetFileName(base.c_str());
  reader->Update();
  CHECK(reader->GetErrorCode() == 0 && reader->GetOutput()->GetNumberOfCells() == 2, "the source cannot be read");
  for (const char* extension : { ".node", ".ele", ".neigh", ".face", ".edge" }) {
    std::filesystem::remove(base + extension);
  }
}

// Writes with files of at most so many bytes. Returns the error's text, "" without one.
std::string Write(vtkStratusTetGenReader* reader, const std::string& path, bool surface_alone, rlim_t bytes)
{
  struct rlimit before, few;
  vtkNew<vtkStratusTetGenWriter> writer;
  vtkNew<ErrorObserver> errors;
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  if (surface_alone) {
    writer->SetInputData(reader->GetSurface());
  } else {
    writer->SetInputData(0, reader->GetOutput());
    writer->SetInputData(1, reader->GetSurface());
  }
  writer->SetFileName(path.c_str());
  getrlimit(RLIMIT_FSIZE, &before);
  few = before;
  few.rlim_cur = bytes;
  setrlimit(RLIMIT_FSIZE, &few);
  writer->Write();
  setrlimit(RLIMIT_FSIZE, &before);
  CHECK(errors->Count <= 1, "%d errors", errors->Count);
  CHECK((errors->Count == 0) == (writer->GetErrorCode() == vtkErrorCode::NoError), "code %lu", writer->GetErrorCode());
  return errors->Text;
}

size_t LongestOf(const Files& files)
{
  size_t longest = 0;
  for (const auto& file : files) {
    longest = std::max(longest, file.second.size());
  }
  return longest;
}

// Old files, then the new ones with every limit up to the length of the longest.
void FullFromByte(const std::string& name, bool surface_alone)
{
  vtkNew<vtkStratusTetGenReader> before, after;
  FillReader(before, 0.0);
  FillReader(after, 0.25);
  CHECK(Write(after, Folder + "/" + name, surface_alone, RLIM_INFINITY).empty(), "%s cannot be written", name.c_str());
  const Files written = ReadFolder();
  CHECK(Write(before, Folder + "/" + name, surface_alone, RLIM_INFINITY).empty(), "%s cannot be written", name.c_str());
  const Files old = ReadFolder();
  const size_t longest = LongestOf(written);
  CHECK(old != written && longest > 60 && written.size() == (surface_alone ? 1u : 5u), "%zu files of up to %zu", written.size(), longest);
  for (size_t n = 0; n <= longest; ++n) {
    const std::string text = Write(after, Folder + "/" + name, surface_alone, n);
    CHECK(ReadFolder() == (n < longest ? old : written), "limit %zu: other files", n);
    CHECK(n < longest ? text.find("File too large") != std::string::npos && text.find(Folder + "/" + "out.") != std::string::npos
                      : text.empty(),
      "limit %zu: '%s'", n, text.c_str());
  }
  std::filesystem::remove_all(Folder);
  std::filesystem::create_directories(Folder);
}

// The output is a link to a device that is always full, or is in a folder that accepts no files.
void NoPlace()
{
  vtkNew<vtkStratusTetGenReader> reader;
  FillReader(reader, 0.0);
  for (const char* path : { "/proc/out.smesh", "/proc/self/out.smesh", "/dev/null/out.smesh" }) {
    const std::string text = Write(reader, path, true, RLIM_INFINITY);
    CHECK(text.find(path) != std::string::npos, "%s: '%s'", path, text.c_str());
  }
  CHECK(ReadFolder().empty(), "files were left");
  // A folder where the second file would come: the files are whole, or old.
  std::filesystem::create_directories(Folder + "/out.ele/below");
  const std::string text = Write(reader, Folder + "/out.node", false, RLIM_INFINITY);
  CHECK(text.find(Folder + "/out.ele") != std::string::npos, "'%s'", text.c_str());
  for (const auto& entry : std::filesystem::directory_iterator(Folder)) {
    const std::string name = entry.path().filename().string();
    CHECK(name == "out.ele" || name == "out.node", "%s was left", name.c_str());
  }
}
} // namespace

int main(int argc, char** argv)
{
  Folder = std::string(argc > 1 ? argv[1] : ".") + "/tetgen-full";
  std::filesystem::remove_all(Folder);
  std::filesystem::create_directories(Folder);
  std::signal(SIGXFSZ, SIG_IGN);
  FullFromByte("out.node", false);
  FullFromByte("out.smesh", true);
  FullFromByte("out.poly", true);
  NoPlace();
  std::filesystem::remove_all(Folder);
  return Failures == 0 ? 0 : 1;
}
