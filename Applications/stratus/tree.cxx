// SPDX-License-Identifier: BSD-3-Clause
#include "tree.h"
#include "input.h"
#include "output.h"
#include "support.h"
#include "transfer.h"

#include "vtkStratusTreeBoxes.h"

#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <memory>

namespace {

using voxels_pointer = std::unique_ptr<stratus_voxels, decltype(&stratus_voxels_destroy)>;
using tree_pointer = std::unique_ptr<stratus_tree, decltype(&stratus_tree_destroy)>;

tree_pointer build(const cli::context& core, const cli::options& o, const cli::input& in, std::string& what)
{
  cli::transfer transfer;
  stratus_transfer view;
  stratus_criterion criterion = stratus_criterion_default();
  if (o.has_range) {
    criterion.lower = o.lower;
    criterion.upper = o.upper;
    what = cli::format("values in %g .. %g", o.lower, o.upper);
  } else {
    transfer = cli::make_transfer(core, { { in.volume }, {}, {}, false }, in.scene, o);
    view = transfer.view();
    core.check(stratus_transfer_check(core, &view), "transfer function");
    criterion.transfer = &view;
    what = "what the opacity shows, " + transfer.origin;
  }
  const bool hits = o.mode == STRATUS_MODE_FIRST_HIT;
  what += hits ? ", as voxels for first hits" : ", as blocks of cells for ray casting";
  stratus_voxels* voxels = nullptr;
  core.check((hits ? stratus_voxels_create : stratus_voxels_create_cells)(core, &in.volume, &criterion, &voxels), "voxels");
  const voxels_pointer owner(voxels, &stratus_voxels_destroy);
  stratus_tree_options options = stratus_tree_options_default();
  options.method = o.method;
  options.agglomerative_by_edges = o.agglomerative_by_edges ? 1 : 0;
  options.uncorrected_flooding = o.uncorrected_flooding ? 1 : 0;
  stratus_tree* tree = nullptr;
  core.check(stratus_tree_create(core, voxels, &options, &tree), "tree");
  return tree_pointer(tree, &stratus_tree_destroy);
}

std::string count(int64_t number)
{
  return cli::grouped(static_cast<unsigned long long>(number));
}

void print(const stratus_tree_statistics& s)
{
  cli::row("method", stratus_tree_method_name(s.method));
  cli::row("voxels", count(s.voxels) + " in " + count(s.bricks) + " bricks of 4^3");
  cli::row("nodes",
    count(s.nodes) + ", " + count(s.leaves) + " leaves, " + count(s.field_leaves) + " of them distance fields over " +
      count(s.field_bricks) + " bricks");
  if (s.wide_nodes > 0) {
    cli::row("hierarchy", count(s.wide_nodes) + " nodes of up to 16 children over the bricks");
  }
  cli::row("depth", std::to_string(s.depth));
  cli::row("size", cli::format("%s KiB", count(static_cast<int64_t>(s.bytes + 1023) / 1024).c_str()));
  cli::row("cost", cli::format("%.4g by the surface area heuristic", s.sah));
  cli::row("splits",
    cli::format("%d by clusters, %d by density, %d by surface area, %d at the median", s.dbscan_splits, s.density_splits, s.sah_splits,
      s.median_splits));
  if (s.bandwidth > 0.0) {
    cli::row("bandwidth", cli::format("%.4g voxels", s.bandwidth));
  }
  cli::row("build", cli::format("%.2f ms", s.build_ms));
  cli::row("why", s.why);
  if (s.uncorrected) {
    cli::row("hits", "not exact: the leaves keep flooded distances as they come out, and rays may step past voxels");
  }
}

std::vector<uint8_t> encode(const stratus_tree* tree, const stratus_volume& volume, bool cells)
{
  vtkNew<vtkPolyData> boxes;
  vtkStratusTreeBoxes(tree, volume, cells, boxes);
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(boxes);
  writer->WriteToOutputStringOn();
  if (writer->Write() != 1) {
    throw cli::failure("the boxes could not be encoded");
  }
  const std::string text = writer->GetOutputString();
  return std::vector<uint8_t>(text.begin(), text.end());
}
} // namespace

namespace cli {

void print_tree(const options& o)
{
  context core(o.device, o.threads);
  input in(core, o.source, o.reading());
  std::unique_ptr<output_file> out(
    o.output.empty() ? nullptr : new output_file(o.output)); // before the work, so that a path that cannot be written is reported at once
  std::string what;
  const tree_pointer tree = build(core, o, in, what);
  stratus_tree_statistics statistics;
  stratus_tree_get_statistics(tree.get(), &statistics);
  std::printf("%s\n", o.source.c_str());
  row("volume", describe(in.volume) + ", array '" + in.array_name + "'");
  row("of", what);
  row("device", stratus_context_device(core));
  print(statistics);
  if (o.report) {
    core.print_build_report();
  }
  if (out) {
    out->write(encode(tree.get(), in.volume, o.mode == STRATUS_MODE_COMPOSITE));
    row("boxes", o.output);
  }
}
} // namespace cli
