// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench: runs the part that its first argument names.
#include "bench.h"
#include "distance.h"
#include "light_bench.h"
#include "octree_bench.h"
#include "paraview_bench.h"
#include "tetra_bench.h"
#include "tree_methods.h"

#include <vtkNew.h>
#include <vtkRenderWindow.h>

#include <cstdio>
#include <cstdlib>
#include <unistd.h>

// VTK's X windows end the process if there is no display, so restart with one. EGL and OSMesa need none.
void bench::ensure_display(char* argv[])
{
  if (std::getenv("DISPLAY") || !vtkNew<vtkRenderWindow>()->IsA("vtkXOpenGLRenderWindow")) {
    return;
  }
  std::vector<std::string> words = { "xvfb-run", "-a", "-s", "-screen 0 1280x1024x24 -noreset" };
  for (char** word = argv; *word; ++word) {
    words.push_back(*word);
  }
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(&word[0]);
  }
  pointers.push_back(nullptr);
  execvp(pointers[0], pointers.data());
  throw bench::failure("no display, and xvfb-run cannot be started (Debian: xvfb)");
}

int main(int argc, char* argv[])
{
  const std::string part = argc > 1 ? argv[1] : "";
  try {
    if (part == "distance") {
      return bench::distance_main(argc, argv);
    }
    if (part == "light") {
      return bench::light_main(argc, argv);
    }
    if (part == "octree") {
      return bench::octree_main(argc, argv);
    }
    if (part == "tree") {
      return bench::tree_main(argc, argv);
    }
    if (part == "tetra") {
      return bench::tetra_main(argc, argv);
    }
    if (part == "paraview") {
      return bench::paraview_main(argc, argv);
    }
    if (part == "all") {
      return bench::all_main(argc, argv);
    }
    if (part == "compare") {
      return bench::compare_main(argc, argv);
    }
    return bench::volume_main(argc, argv); // it also prints the help of all parts
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stratus-bench: %s\n", error.what());
    return 1;
  }
}
