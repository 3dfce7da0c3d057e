// SPDX-License-Identifier: BSD-3-Clause
// The culler also does the other work of the renderer's own culler: render times, their total, the order and the length of the list, and it
// respects the times of earlier cullers. vtkFrustumCoverageCuller is called on equal props; it keeps more, since it tests spheres.
#include "culler_testing.h"

#include "vtkActor2D.h"
#include "vtkFrustumCoverageCuller.h"

#include <algorithm>
#include <memory>
#include <set>

namespace {
struct Answer {
  std::vector<vtkProp*> Kept, All;
  std::vector<double> Times; // of all props, in the order that they were given in
  double Total;
  int Initialized;
};

class Scene : public CulledWindow
{
public:
  Scene()
  {
    this->LookAhead();
    unsigned state = 7;
    const auto next = [&state] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
    for (int i = 0; i < 300; ++i) {
      this->Parts.emplace_back(new Part(16 * next() - 8, 16 * next() - 8, 24 * next() - 12, 0.05 + 2 * next() * next() * next()));
      this->Props.push_back(this->Parts.back()->Actor);
    }
    this->Props.insert(this->Props.begin() + 40, this->Title);
    this->Culler->SetMargin(0);
    this->Draw(); // the window's size counts
  }

  Answer Ask(vtkCuller* culler, int initialized)
  {
    for (size_t i = 0; i < this->Props.size(); ++i) {
      this->Props[i]->SetRenderTimeMultiplier(0.25 * (i % 4));
    }
    Answer answer;
    answer.All = this->Props;
    int length = static_cast<int>(this->Props.size());
    answer.Initialized = initialized;
    answer.Total = culler->Cull(this->Renderer, answer.All.data(), length, answer.Initialized);
    answer.Kept.assign(answer.All.begin(), answer.All.begin() + length);
    for (vtkProp* prop : this->Props) {
      answer.Times.push_back(prop->GetRenderTimeMultiplier());
    }
    return answer;
  }

  std::vector<std::unique_ptr<Part>> Parts;
  std::vector<vtkProp*> Props;
  int Level = 5;
  vtkNew<vtkActor2D> Title; // has no bounds
  vtkNew<vtkFrustumCoverageCuller> Reference;
};

void Compare(Scene& s, int initialized, const char* what)
{
  s.Culler->SetMaximumLevel(++s.Level); // another octree: whatever is culled, is so for the first time
  const Answer meant = s.Ask(s.Reference, initialized), given = s.Ask(s.Culler, initialized);
  const std::set<vtkProp*> kept(given.Kept.begin(), given.Kept.end());
  CHECK(kept.size() == given.Kept.size() && kept.size() > 10 && kept.size() < s.Props.size() / 2, "%s: %zu of %zu kept", what, kept.size(),
    s.Props.size());
  CHECK(given.Initialized == 1, "%s: not initialized", what);
  // In the reference's order, and nothing else.
  std::vector<vtkProp*> order;
  std::copy_if(meant.Kept.begin(), meant.Kept.end(), std::back_inserter(order), [&](vtkProp* prop) { return kept.count(prop) > 0; });
  CHECK(order == given.Kept, "%s: another order, or props that the reference culls: %zu, %zu", what, order.size(), given.Kept.size());
  CHECK(std::set<vtkProp*>(given.All.begin(), given.All.end()) == std::set<vtkProp*>(s.Props.begin(), s.Props.end()),
    "%s: props are lost from the list", what);
  double total = 0.0;
  for (size_t i = 0; i < s.Props.size(); ++i) {
    if (kept.count(s.Props[i]) > 0) {
      // The core computes coverage in single precision, from sums of several terms.
      CHECK(std::fabs(given.Times[i] - meant.Times[i]) <= 1e-5 * meant.Times[i] + 1e-7, "%s: prop %zu has %g, not %g", what, i,
        given.Times[i], meant.Times[i]);
      total += given.Times[i];
    } else {
      CHECK(given.Times[i] == 0.0, "%s: prop %zu is culled and has %g", what, i, given.Times[i]);
    }
  }
  CHECK(std::fabs(total - given.Total) <= 1e-12 * total, "%s: a total of %g, not %g", what, given.Total, total);
}

void TestPolicies()
{
  for (int sorting = 0; sorting < 3; ++sorting) {
    for (int initialized = 0; initialized < 2; ++initialized) {
      Scene s;
      s.Reference->SetSortingStyle(sorting);
      s.Culler->SetSortingStyle(sorting);
      Compare(s, initialized, s.Culler->GetSortingStyleAsString());
      s.Reference->SetMinimumCoverage(0.002);
      s.Culler->SetMinimumCoverage(0.002);
      s.Reference->SetMaximumCoverage(0.05);
      s.Culler->SetMaximumCoverage(0.05);
      Compare(s, initialized, "coverages");
    }
  }
}

// A prop that goes out of sight has no time from then on, and has it again when it comes back; in a frame, its allotment is a share of the
// total.
void TestFrames()
{
  CulledWindow w;
  w.LookAhead();
  Part left(-1), right(1), away(30);
  for (Part* part : { &left, &right, &away }) {
    w.Renderer->AddActor(part->Actor);
  }
  w.Draw();
  CHECK(away.Actor->GetRenderTimeMultiplier() == 0.0, "never seen, and %g", away.Actor->GetRenderTimeMultiplier());
  CHECK(left.Actor->GetRenderTimeMultiplier() > 0.0, "seen, and %g", left.Actor->GetRenderTimeMultiplier());
  const double share =
    left.Actor->GetRenderTimeMultiplier() / (left.Actor->GetRenderTimeMultiplier() + right.Actor->GetRenderTimeMultiplier());
  const double allotted = left.Actor->GetAllocatedRenderTime() / w.Renderer->GetAllocatedRenderTime();
  CHECK(std::fabs(allotted - share) < 1e-9, "%g of the time, not %g", allotted, share);
  left.Actor->SetPosition(-30, 0, 0);
  w.Draw();
  CHECK(left.Actor->GetRenderTimeMultiplier() == 0.0, "gone, and %g", left.Actor->GetRenderTimeMultiplier());
  left.Actor->SetPosition(-1, 0, 0);
  w.Draw();
  CHECK(left.Actor->GetRenderTimeMultiplier() > 0.0, "back, and %g", left.Actor->GetRenderTimeMultiplier());
  // Behind another culler that has shortened the list.
  vtkNew<vtkFrustumCoverageCuller> before;
  w.Renderer->RemoveCuller(w.Culler);
  vtkNew<vtkStratusOctreeCuller> behind;
  w.Renderer->AddCuller(before);
  w.Renderer->AddCuller(behind);
  w.Culler = behind;
  w.Compare("behind another culler");
  CHECK(behind->GetNumberOfProps() == 2 && behind->GetNumberOfVisibleProps() == 2, "%d of %d", int(behind->GetNumberOfVisibleProps()),
    int(behind->GetNumberOfProps()));
}
} // namespace

int main()
{
  TestPolicies();
  TestFrames();
  std::printf(Failures == 0 ? "all as expected\n" : "%d failures\n", Failures);
  return Failures == 0 ? 0 : 1;
}
