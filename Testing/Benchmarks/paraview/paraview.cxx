// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench paraview: "Stratus Volume" compared with ParaView's own "Volume" on one and more ranks. ParaView has its own VTK, so
// pvbatch draws the pictures by the script measure.py. This file writes the scenes for it, runs it, and collects its rows.
#include "paraview_bench.h"
#include "tetra_bench.h"

#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace bench {

namespace {

const char* const help = R"(stratus-bench paraview [options]

  --paraview FOLDER     the folder that contains bin/pvbatch (default /usr); mpiexec is the first on the path
  --plugin FILE         Stratus.so of the plugin (default: ParaView loads it by itself)
  --scene NAME|FILE,... cloud, plume, cloud-N and other scenes of stratus-bench volume of one component, bluntfin, post, or an image or a
                        grid of tetrahedra (.vtu); default: cloud, plume, ../shared/data/isabel_02.vti, bluntfin, post
  --ranks N,...         (default 1,2,4)
  --size N              N x N pixels (default 512)
  --pieces N            instead, measure the work of N^3 ranks: one rank draws the N x N x N pieces of each image, one after the other,
                        N within 2..8
  --repeats N           frames of each view (default 3)
  --csv FILE            tidy rows as in stratus-bench volume (default: the standard output)
  --append              rows of other scenes that the file has stay
  --pictures FOLDER     keep each view's picture

Methods: stratus@N and paraview:volume@N on N ranks, one after the other in one process a rank, paraview:empty@N with nothing shown. A view
is black, without FXAA, axes and annotation; a frame is a whole Render() to its end. Ranks come in rising order. A waiting rank spins, which
counts as processor time.
  frame_ms                     median over the 8 views of record, each the median of its repeats
  first_ms                     from the choice of the representation to the first picture
  edit_ms                      from a change of the opacity function to the next picture, median over the views
  frame_cpu_ms, edit_cpu_ms    processor time, user and system, of all ranks together
  rank_cpu_ms/R                processor time of rank R in a frame
  samples, rank_samples/R      a frame's samples (cells: segments) over all ranks, and rank R's; median over the views
  most_rank_samples,
  most_rank_cpu_ms             of the rank with the most in each view
  rank_difference255           the largest difference of any channel in any view to one rank's picture, if 1 is among the ranks
  load                         of the machine in the last minute before, per core

stratus:pieces-N: N pieces, each drawn by itself with a step of one voxel. whole_, sum_ and most_ of samples, cpu_ms and pixels_sent (the
rectangle of the pixels that show something, 8 bytes a pixel over ranks): of the whole, of all pieces together, and of the piece with the
most, medians over the views. pieces_that_show: median.

Functions of grids of tetrahedra are `ramp` of stratus-bench tetra, and half as opaque after the edit. Each rank uses its share of the cores
as threads (OMP_NUM_THREADS, LP_NUM_THREADS of software OpenGL), at least one. A scene whose file is absent is left out with a message. A
method that cannot be measured has a row `failed`, and the exit status is 1.
)";

struct options {
  std::vector<std::string> scenes;
  std::vector<int> ranks = { 1, 2, 4 };
  std::string paraview = "/usr", plugin, csv = "-", pictures;
  int size = 512, repeats = 3, cuts = 0;
  bool append = false;
};

int number_of(const std::string& word, const std::string& value, int least, int most)
{
  char* end = nullptr;
  const long number = std::strtol(value.c_str(), &end, 10);
  if (value.empty() || *end || number < least || number > most) {
    throw failure(word + " takes a number within " + std::to_string(least) + ".." + std::to_string(most) + ", not '" + value + "'");
  }
  return static_cast<int>(number);
}

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--append") {
      o.append = true;
      continue;
    }
    if (i + 1 == argc) {
      throw failure(word + " is unknown or lacks its value; see --help");
    }
    const std::string value = argv[++i];
    if (word == "--scene") {
      o.scenes = split(value);
    } else if (word == "--ranks") {
      o.ranks.clear();
      for (const std::string& part : split(value)) {
        o.ranks.push_back(number_of(word, part, 1, 1024));
      }
    } else if (word == "--size") {
      o.size = number_of(word, value, 16, 4096);
    } else if (word == "--repeats") {
      o.repeats = number_of(word, value, 1, 1000);
    } else if (word == "--pieces") {
      o.cuts = number_of(word, value, 2, 8);
    } else if (word == "--paraview") {
      o.paraview = value;
    } else if (word == "--plugin") {
      o.plugin = value;
    } else if (word == "--csv") {
      o.csv = value;
    } else if (word == "--pictures") {
      o.pictures = value;
    } else {
      throw failure("unknown option " + word + "; see --help");
    }
  }
  if (access((o.paraview + "/bin/pvbatch").c_str(), X_OK) != 0) {
    throw failure("--paraview: there is no program " + o.paraview + "/bin/pvbatch");
  }
  if (!o.plugin.empty() && access(o.plugin.c_str(), R_OK) != 0) {
    throw failure("--plugin: " + o.plugin + " cannot be read");
  }
  if (o.cuts > 0) {
    o.ranks = { 1 };
  }
  if (o.ranks.empty()) {
    throw failure("--ranks names no number");
  }
  std::sort(o.ranks.begin(), o.ranks.end());
  if (o.scenes.empty()) {
    o.scenes = { "cloud", "plume", "../shared/data/isabel_02.vti", "bluntfin", "post" };
  }
  return o;
}

// ---- a scene for the script: its data as a file that ParaView reads, and the rest as Python's words

std::string list_of(const std::vector<double>& values)
{
  std::string text = "[";
  for (const double value : values) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.17g", text.size() > 1 ? ", " : "", value);
    text += number;
  }
  return text + "]";
}

// ParaView 5.11 with Debian's libexpat cannot read appended raw values, so that they stand among the XML.
template <class Writer, class Data> void write_data(const std::string& path, Data* data)
{
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  writer->SetFileName(path.c_str());
  writer->SetDataModeToBinary();
  writer->SetCompressorTypeToNone();
  if (writer->Write() != 1 || writer->GetErrorCode() != 0) {
    throw failure("cannot write " + path);
  }
}

struct written_scene {
  std::string name, path;
};

void describe(const std::string& path, const std::string& data, const std::string& array, const transfer& first,
  const std::vector<double>& edited, const double bounds[6], double voxel, int up_axis)
{
  std::ofstream file(path);
  file << "{\"path\": \"" << data << "\", \"array\": \"" << array << "\", \"up\": " << up_axis
       << ",\n \"bounds\": " << list_of(std::vector<double>(bounds, bounds + 6)) << ", \"step\": " << list_of({ voxel })
       << ", \"unit\": " << list_of({ first.unit_distance }) << ",\n \"opacity\": " << list_of(first.opacity)
       << ",\n \"edited\": " << list_of(edited) << ",\n \"color\": " << list_of(first.color) << "}\n";
  file.close();
  if (!file) {
    throw failure("cannot write " + path);
  }
}

bool ends_with(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Returns false, with the reason on the standard error, if the scene's file is not here.
bool write_scene(stratus_context* context, const std::string& source, const std::string& folder, written_scene& out)
{
  if (source == "bluntfin" || source == "post" || ends_with(source, ".vtu")) {
    if (ends_with(source, ".vtu") && !std::ifstream(source)) {
      std::fprintf(stderr, "%s is LEFT OUT: it is not here\n", source.c_str());
      return false;
    }
    tetra_mesh mesh;
    if (!make_tetra_mesh(context, source, "", mesh)) {
      return false;
    }
    const transfer first = tetra_transfer(mesh, "ramp");
    std::vector<double> edited = first.opacity;
    for (size_t i = 1; i < edited.size(); i += 2) {
      edited[i] *= 0.5;
    }
    const std::string data = folder + '/' + mesh.name + ".vtu";
    write_data<vtkXMLUnstructuredGridWriter>(data, mesh.grid.Get());
    out = { mesh.name, folder + '/' + mesh.name + ".json" };
    describe(out.path, data, mesh.grid->GetPointData()->GetScalars()->GetName(), first, edited, mesh.bounds, 0.0, 2);
    return true;
  }
  if (source.find('/') != std::string::npos && !std::ifstream(source)) {
    std::fprintf(stderr, "%s is LEFT OUT: it is not here\n", source.c_str());
    return false;
  }
  const scene s = make_scene(context, source);
  if (s.shaded || s.grid || !s.others.empty()) {
    throw failure("scene " + source + ": ParaView is measured on images of one component without light");
  }
  const std::string data = folder + '/' + s.name + ".vti";
  write_data<vtkXMLImageDataWriter>(data, s.image.Get());
  out = { s.name, folder + '/' + s.name + ".json" };
  describe(out.path, data, s.image->GetPointData()->GetScalars()->GetName(), s.first, s.edited.opacity, s.bounds, s.voxel, s.up_axis);
  return true;
}

// ---- runs

// Runs a program and returns its exit status, or 128 and the signal that ended it.
int run_program(std::vector<std::string> words, int threads)
{
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(&word[0]);
  }
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) {
    throw failure(std::string("no process: ") + std::strerror(errno));
  }
  if (child == 0) {
    setenv("OMP_NUM_THREADS", std::to_string(threads).c_str(), 1);
    setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 1);
    setenv("OMP_WAIT_POLICY", "passive", 0);
    if (geteuid() == 0) { // Open MPI refuses to start ranks as root, with a page of messages, unless both are set
      setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 0);
      setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 0);
    }
    dup2(STDERR_FILENO, STDOUT_FILENO); // rows may go to the standard output
    execvp(pointers[0], pointers.data());
    std::fprintf(stderr, "%s cannot be started: %s\n", pointers[0], std::strerror(errno));
    _exit(127);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

// Rows that the script wrote: method,metric,value,unit; the last one is `end`.
bool read_rows(const std::string& path, const std::string& scene, std::vector<row>& rows)
{
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line == "end") {
      return true;
    }
    const std::vector<std::string> parts = split(line);
    if (parts.size() == 4) {
      rows.push_back({ scene, parts[0], parts[1], parts[3], std::atof(parts[2].c_str()) });
    }
  }
  return false;
}

void measure(const options& o, const written_scene& s, int ranks, const std::string& pictures, std::vector<row>& rows)
{
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const std::string count = std::to_string(ranks), out = s.path + ".rows-" + count;
  double load = 0.0;
  if (getloadavg(&load, 1) == 1) {
    rows.push_back({ s.name, "paraview:empty@" + count, "load", "1", load / cores });
  }
  std::fprintf(stderr, "%s on %d rank%s\n", s.name.c_str(), ranks, ranks > 1 ? "s" : "");
  // By default, Open MPI binds one or two ranks to a core each.
  const int status = run_program({ "mpiexec", "--bind-to", "none", "--oversubscribe", "-n", count, o.paraview + "/bin/pvbatch", "--sym",
                                   STRATUS_BENCH_PARAVIEW_SCRIPT, o.plugin.empty() ? "-" : std::filesystem::absolute(o.plugin).string(),
                                   s.path, out, pictures, std::to_string(o.size), std::to_string(o.repeats), std::to_string(o.cuts) },
    std::max(1, cores / ranks));
  std::vector<row> found;
  if (!read_rows(out, s.name, found)) {
    add_failure(s.name, "stratus@" + count, ("pvbatch ended with status " + std::to_string(status)).c_str(), rows);
  }
  rows.insert(rows.end(), found.begin(), found.end());
}

struct temporary_folder {
  std::string path = (std::filesystem::temp_directory_path() / "stratus-bench-XXXXXX").string();
  temporary_folder()
  {
    if (!mkdtemp(&this->path[0])) {
      throw failure("cannot make the folder " + this->path + ": " + std::strerror(errno));
    }
  }
  ~temporary_folder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(this->path, ignored);
  }
  temporary_folder(const temporary_folder&) = delete;
  temporary_folder& operator=(const temporary_folder&) = delete;
};
} // namespace

int paraview_main(int argc, char* argv[])
{
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  const options o = parse(argc, argv);
  check_writable(o.csv);
  make_folder(o.pictures);
  ensure_display(argv);
  const temporary_folder folder;
  stratus_context_options host = stratus_context_options_default();
  stratus_context* context = nullptr;
  char message[512];
  host.device = "host";
  if (stratus_context_create(&host, &context, message, sizeof message) != STRATUS_OK) {
    throw failure(message);
  }
  std::vector<row> rows;
  for (const std::string& source : o.scenes) {
    written_scene s;
    if (write_scene(context, source, folder.path, s)) {
      if (o.cuts > 0 && !std::ifstream(folder.path + '/' + s.name + ".vti")) {
        throw failure("--pieces cuts images, and " + s.name + " is none");
      }
      for (const int ranks : o.ranks) {
        measure(o, s, ranks, o.pictures.empty() ? folder.path : std::filesystem::absolute(o.pictures).string(), rows);
      }
      std::filesystem::remove(folder.path + '/' + s.name + ".vti");
    }
  }
  stratus_context_destroy(context);
  save_rows(o.csv, rows, "paraview", o.append);
  return any_failed(rows) || rows.empty() ? 1 : 0;
}
} // namespace bench
