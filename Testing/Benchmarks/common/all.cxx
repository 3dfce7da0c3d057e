// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench all: runs every part of the bench scene by scene, each in a separate process, so that a crash only costs its scene, and
// then writes the page. Ours and its peers share a process, as in the parts.
#include "bench.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/wait.h>
#include <unistd.h>

namespace bench {

namespace {

const char* const help = R"(stratus-bench all --out FOLDER [options]

  --out FOLDER   tables (CSV), charts (PNG, SVG), index.html and the parts' output (log.txt)
  --quick        the same in ten minutes or so: fewer scenes and settings, small windows, one frame a view
  --resume       go on with a run of the same kind and commit that was interrupted, after the last whole scene
  --part P,...   volume, light, tetra, tree, distance, octree (default: all of them)

Each method runs over its own settings: ours over tolerances, peers over steps, trees over sizes of leaves. A method that cannot be measured
and a part that crashes are named at the end and on the page, and the exit status is 1. A table is replaced as a whole after each scene.
stratus-bench compare A B reports the changes between two such folders.
)";

struct options {
  std::string folder;
  std::vector<std::string> parts = parts_of_all();
  bool quick = false, resume = false;
};

// A scene of a part, as its table names it, and the words that measure it.
struct unit {
  std::string part, scene;
  std::vector<std::string> words;
};

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick" || word == "--resume") {
      (word == "--quick" ? o.quick : o.resume) = true;
    } else if (i + 1 < argc && word == "--out") {
      o.folder = argv[++i];
    } else if (i + 1 < argc && word == "--part") {
      const std::vector<std::string> known = o.parts;
      o.parts = split(argv[++i]);
      for (const std::string& part : o.parts) {
        if (std::find(known.begin(), known.end(), part) == known.end()) {
          throw failure("unknown part " + part + "; --help lists them");
        }
      }
    } else {
      throw failure(word + " is unknown or lacks its value; see --help");
    }
  }
  if (o.folder.empty()) {
    throw failure("--out FOLDER is missing");
  }
  return o;
}

void add_volumes(const options& o, std::vector<unit>& units)
{
  const std::string isabel = "../shared/data/isabel_02.vti";
  std::vector<std::string> scenes = { "cloud", "plume", "fog", "peak", "bone", "skin", "stripes", "shell", "plate", "labels" };
  if (!o.quick) {
    scenes.insert(scenes.end(), { "voxel", "plume2", "cloud+shade" });
  }
  if (std::ifstream(isabel)) {
    scenes.push_back(isabel);
  } else {
    std::fprintf(stderr, "%s is not here: isabel_02 is LEFT OUT\n", isabel.c_str());
  }
  for (const std::string& scene : scenes) {
    unit u = { "volume", scene == isabel ? "isabel_02" : scene, { "--scene", scene } };
    const std::vector<std::string> how = o.quick
      ? std::vector<std::string>{ "--quick-curves", "--size", "192", "--repeats", "1", "--no-update" }
      : std::vector<std::string>{ "--curves" };
    u.words.insert(u.words.end(), how.begin(), how.end());
    units.push_back(u);
  }
}

void add_light(const options& o, std::vector<unit>& units)
{
  std::vector<std::string> scenes = { "cloud" };
  if (!o.quick) {
    scenes.insert(scenes.end(), { "cumulus-rectilinear", "bone", "plume" });
    if (std::ifstream("../shared/data/bluntfin.vtk") || std::ifstream("../shared/data/bluntfin.vtu")) {
      scenes.emplace_back("bluntfin/ramp");
    }
  }
  for (const std::string& scene : scenes) {
    unit u = { "light", scene, { "--scene", scene } };
    const std::vector<std::string> how = o.quick ? std::vector<std::string>{ "--light", "local,single", "--tolerance", ".0126,.005",
      "--size", "128", "--error-size", "32", "--seconds", "1" }
                                                 : std::vector<std::string>{ "--seconds", "4" };
    u.words.insert(u.words.end(), how.begin(), how.end());
    units.push_back(u);
  }
}

void add_tetrahedra(const options& o, std::vector<unit>& units)
{
  std::vector<std::string> meshes = { "wavelet" };
  for (const char* mesh : { "bluntfin", "post" }) {
    if (std::ifstream("../shared/data/" + std::string(mesh) + ".vtk") || std::ifstream("../shared/data/" + std::string(mesh) + ".vtu")) {
      meshes.emplace_back(mesh);
    } else {
      std::fprintf(stderr, "the mesh %s is not in ../shared/data: it is LEFT OUT\n", mesh);
    }
  }
  for (const std::string& mesh : meshes) {
    for (const char* function : { "ramp", "peaks", "opaque" }) {
      if (o.quick && (mesh == "post" || function == std::string("ramp"))) {
        continue;
      }
      unit u = { "tetra", mesh + '/' + function, { "--mesh", mesh, "--function", function, "--rays", "0" } };
      const std::vector<std::string> how =
        o.quick ? std::vector<std::string>{ "--quick-curves", "--size", "192", "--repeats", "1" } : std::vector<std::string>{ "--curves" };
      u.words.insert(u.words.end(), how.begin(), how.end());
      if (!o.quick && u.scene == "bluntfin/ramp") { // its frames take half a minute on any mesh, whatever the distance of its rays
        u.words.insert(u.words.end(), { "--method", "vtk:zsweep" });
      }
      units.push_back(u);
    }
  }
}

std::vector<unit> units_of(const options& o)
{
  std::vector<unit> units;
  const auto has = [&](const char* part) { return std::find(o.parts.begin(), o.parts.end(), part) != o.parts.end(); };
  using names = std::vector<std::string>;
  if (has("volume")) {
    add_volumes(o, units);
  }
  if (has("light")) {
    add_light(o, units);
  }
  if (has("tetra")) {
    add_tetrahedra(o, units);
  }
  for (const std::string& scene : !has("tree") ? names()
      : o.quick                                ? names{ "17K", "35K", "u225", "u640" }
                                               : names{ "17K", "24K", "30K", "35K", "u225", "u367", "u571", "u640", "1M", "cloud" }) {
    units.push_back({ "tree", scene, { "--scene", scene, o.quick ? "--quick-curves" : "--curves", "--rounds", o.quick ? "3" : "5" } });
  }
  for (const std::string& name : has("distance") ? names{ "sparse", "clustered", "dense", "single", "plate", "shell" } : names()) {
    const std::string size = o.quick ? "64" : "128";
    units.push_back({ "distance", name + '-' + size, { "--case", name, "--size", size } });
  }
  for (const std::string& scene : !has("octree") ? names()
      : o.quick                                  ? names{ "boxes-9454", "actors-1000" }
                                                 : names{ "boxes-9454", "boxes-100000", "actors-1000", "actors-9454" }) {
    for (const std::string& path : o.quick ? names{ "near", "turn" } : names{ "far", "near", "inside", "turn" }) {
      units.push_back(
        { "octree", scene + '/' + path, { "--scene", scene, "--path", path, "--curves", "--frames", o.quick ? "40" : "120" } });
    }
  }
  return units;
}

std::string table_of(const options& o, const std::string& part)
{
  return o.folder + '/' + part + ".csv";
}

// Whether a whole scene of this machine and commit is in the table.
bool is_done(const options& o, const unit& u)
{
  const origin now = origin_of_this_run();
  for (const origin& known : read_csv(table_of(o, u.part)).origins) {
    if (known.commit == now.commit && known.processor == now.processor && known.cores == now.cores &&
      std::find(known.scenes.begin(), known.scenes.end(), u.scene) != known.scenes.end()) {
      return true;
    }
  }
  return false;
}

// Refuses a folder that holds another run, and marks a new one.
void claim(const options& o)
{
  const std::string path = o.folder + "/run.txt", mine = o.quick ? "quick" : "whole";
  std::ifstream in(path);
  std::string theirs;
  if (in >> theirs) {
    if (!o.resume) {
      throw failure(o.folder + " holds a run: --resume goes on with it, or name another folder");
    }
    if (theirs != mine) {
      throw failure(o.folder + " holds a run of another kind, " + theirs + ", which --resume cannot go on with as " + mine);
    }
  }
  std::ofstream out(path);
  out << mine << '\n';
  out.close();
  if (!out) {
    throw failure("cannot write " + path + ": " + std::strerror(errno));
  }
}

// Measures one scene. Returns what went wrong, or nothing.
std::string run(const options& o, const unit& u, const std::string& whole)
{
  std::vector<std::string> words = { "stratus-bench", u.part, "--csv", table_of(o, u.part), "--append" };
  words.insert(words.end(), u.words.begin(), u.words.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(&word[0]);
  }
  pointers.push_back(nullptr);
  const std::string log = o.folder + "/log.txt";
  const pid_t child = fork();
  if (child < 0) {
    return std::string("no process: ") + std::strerror(errno);
  }
  if (child == 0) {
    const int terminal = dup(STDERR_FILENO), file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    setenv("STRATUS_BENCH_TERMINAL", std::to_string(terminal).c_str(), 1);
    setenv("STRATUS_BENCH_WHOLE", whole.c_str(), 1);
    if (file >= 0) {
      dup2(file, STDOUT_FILENO);
      dup2(file, STDERR_FILENO);
    }
    execv("/proc/self/exe", pointers.data());
    _exit(127);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  const std::string name = u.part + ' ' + u.scene;
  if (WIFSIGNALED(status)) {
    return name + ": ended by signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + "), see log.txt";
  }
  if (WEXITSTATUS(status) == 0) {
    return "";
  }
  std::string failed;
  for (const row& r : read_csv(table_of(o, u.part)).rows) {
    if (r.scene == u.scene && r.metric == "failed") {
      failed += (failed.empty() ? "" : ", ") + r.method;
    }
  }
  return name + ": " + (failed.empty() ? "exit status " + std::to_string(WEXITSTATUS(status)) : failed + " cannot be measured") +
    ", see log.txt";
}

std::string progress_text(const unit& u, size_t number, size_t count, double left_ms)
{
  std::string text = u.part + ", scene " + std::to_string(number) + " of " + std::to_string(count);
  return left_ms > 0.0 ? text + ", about " + duration(left_ms) + " left" : text;
}
} // namespace

int all_main(int argc, char* argv[])
{
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  const options o = parse(argc, argv);
  make_folder(o.folder);
  for (const std::string& part : o.parts) {
    check_writable(table_of(o, part));
  }
  ensure_display(argv);
  claim(o);
  const std::vector<unit> units = units_of(o);
  std::vector<std::string> failures;
  std::vector<double> spent; // of the scenes measured
  const double start = now_ms();
  for (size_t i = 0; i < units.size(); ++i) {
    const unit& u = units[i];
    if (o.resume && is_done(o, u)) {
      std::fprintf(stderr, "%s %s: measured before\n", u.part.c_str(), u.scene.c_str());
      continue;
    }
    double sum = 0.0;
    std::for_each(spent.begin(), spent.end(), [&](double ms) { sum += ms; });
    const double left = spent.empty() ? 0.0 : sum / static_cast<double>(spent.size()) * static_cast<double>(units.size() - i);
    const double begun = now_ms();
    const std::string wrong = run(o, u, progress_text(u, i + 1, units.size(), left));
    spent.push_back(now_ms() - begun);
    std::fprintf(
      stderr, "%s; %s, %s\n", progress_text(u, i + 1, units.size(), left).c_str(), u.scene.c_str(), duration(spent.back()).c_str());
    if (!wrong.empty()) {
      failures.push_back(wrong);
      std::fprintf(stderr, "FAILED: %s\n", wrong.c_str());
    }
  }
  write_page(o.folder, failures);
  std::fprintf(stderr, "%s/index.html, after %s\n", o.folder.c_str(), duration(now_ms() - start).c_str());
  return failures.empty() ? 0 : 1;
}
} // namespace bench
