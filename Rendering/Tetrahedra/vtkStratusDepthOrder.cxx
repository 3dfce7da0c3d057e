// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusDepthOrder.h"

#include "vtkStratusHull.h"
#include "vtkStratusLeftOut.h"
#include "vtkStratusPicture.h"
#include "vtkStratusTetrahedraMapper.h"

#include "vtkAssembly.h"
#include "vtkImageData.h"
#include "vtkLODProp3D.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkProp3DCollection.h"
#include "vtkPropCollection.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <list>
#include <new>
#include <utility>

namespace {
using Kind = vtkStratusDepthOrder::Kind;

const vtkStratusDepthOrder::Mixer* TheMixer = nullptr;

// A volume, or another prop that draws volumes.
struct Entry {
  vtkProp3D* Prop = nullptr;
  Kind Of = vtkStratusDepthOrder::OTHER;
  vtkSmartPointer<vtkMatrix4x4> Matrix; // of a part of an assembly, which VTK sets only while it draws the part
  vtkStratusHull Hull;

  bool IsOurs() const { return this->Of == vtkStratusDepthOrder::MEDIUM || this->Of == vtkStratusDepthOrder::SOLID; }
  vtkVolume* GetVolume() const { return vtkVolume::SafeDownCast(this->Prop); }
  vtkAbstractVolumeMapper* GetMapper() const { return this->GetVolume() ? this->GetVolume()->GetMapper() : nullptr; }
};

// ---------------------------------------------------------------- the volumes of a frame

// The props that a renderer draws in this frame, without those that its cullers left out. There are none outside of a frame.
class DrawnProps : public vtkRenderer
{
public:
  static std::vector<vtkProp*> Of(vtkRenderer* renderer) { return List<DrawnProps>(renderer, renderer->*(&DrawnProps::PropArray)); }

private:
  // An array and its count, and in newer VTK a vector. Only the function that is called names the count.
  template <class Drawn> static std::vector<vtkProp*> List(vtkRenderer* renderer, vtkProp** props)
  {
    return props ? std::vector<vtkProp*>(props, props + renderer->*(&Drawn::PropArrayCount)) : std::vector<vtkProp*>();
  }
  template <class Drawn> static std::vector<vtkProp*> List(vtkRenderer*, const std::vector<vtkProp*>& props) { return props; }
};

Kind FindKind(vtkVolume* volume)
{
  if (auto* mesh = vtkStratusTetrahedraMapper::SafeDownCast(volume->GetMapper())) {
    return mesh->GetRenderMode() == vtkStratusTetrahedraMapper::FIRST_HIT_MODE ? vtkStratusDepthOrder::SOLID : vtkStratusDepthOrder::MEDIUM;
  }
  const Kind kind = TheMixer ? TheMixer->GetKind(volume) : vtkStratusDepthOrder::OTHER;
  return kind == vtkStratusDepthOrder::OTHER && !volume->GetMapper() ? vtkStratusDepthOrder::NOTHING : kind;
}

// Adds a prop's volumes. parent: matrix of the assembly that the prop is a part of, nullptr if it is not.
void AddEntries(vtkProp* prop, vtkMatrix4x4* parent, std::vector<Entry>& entries)
{
  vtkProp3D* prop3D = prop->IsA("vtkActor") ? nullptr : vtkProp3D::SafeDownCast(prop); // most props are actors
  if (!prop3D || !prop3D->GetVisibility()) {
    return;
  }
  Entry entry;
  entry.Prop = prop3D;
  if (parent) {
    entry.Matrix = vtkSmartPointer<vtkMatrix4x4>::New();
    vtkMatrix4x4::Multiply4x4(parent, prop3D->GetMatrix(), entry.Matrix);
  }
  if (auto* assembly = vtkAssembly::SafeDownCast(prop)) { // the assembly's own traversal is under way
    vtkCollectionSimpleIterator iterator;
    assembly->GetParts()->InitTraversal(iterator);
    while (vtkProp3D* part = assembly->GetParts()->GetNextProp3D(iterator)) {
      AddEntries(part, parent ? entry.Matrix.Get() : assembly->GetMatrix(), entries);
    }
  } else if (auto* volume = vtkVolume::SafeDownCast(prop)) {
    entry.Of = FindKind(volume);
    if (entry.Of != vtkStratusDepthOrder::NOTHING) {
      entries.push_back(entry);
    }
  } else if (vtkLODProp3D::SafeDownCast(prop)) { // which of its props it draws is not known
    vtkNew<vtkPropCollection> volumes;
    prop->GetVolumes(volumes);
    if (volumes->GetNumberOfItems() > 0) {
      entries.push_back(entry);
    }
  }
}

std::vector<Entry> FindEntries(vtkRenderer* renderer)
{
  std::vector<Entry> entries;
  for (vtkProp* prop : DrawnProps::Of(renderer)) {
    AddEntries(prop, nullptr, entries);
  }
  return entries;
}

// Sets the part of a box of a grid's coordinates that the regions of cropping planes show. Flag 9 z + 3 y + x shows the region at x, y, z.
template <class Mapper> void Crop(Mapper* mapper, double box[6])
{
  const double* planes = mapper->GetCroppingRegionPlanes();
  for (int a = 0, step = 1; a < 3; ++a, step *= 3) {
    bool shows[3] = { false, false, false };
    for (int region = 0; region < 27; ++region) {
      shows[region / step % 3] = shows[region / step % 3] || (mapper->GetCroppingRegionFlags() >> region & 1);
    }
    const double from = shows[0] ? box[2 * a] : shows[1] ? planes[2 * a] : planes[2 * a + 1];
    const double to = shows[2] ? box[2 * a + 1] : shows[1] ? planes[2 * a + 1] : planes[2 * a];
    box[2 * a] = std::max(box[2 * a], from);
    box[2 * a + 1] = std::min(box[2 * a + 1], to);
  }
}

// Finds a box of the input along the axes of cropping planes, and moves it to the world. An image's box is turned by its direction matrix.
void FindBox(vtkAbstractVolumeMapper* mapper, double box[6], vtkMatrix4x4* toWorld)
{
  mapper->GetBounds(box);
  auto* image = vtkImageData::SafeDownCast(mapper->GetDataObjectInput());
  if (image && !image->GetDirectionMatrix()->IsIdentity()) {
    vtkNew<vtkMatrix4x4> turn, move;
    for (int a = 0; a < 3; ++a) {
      const int* extent = image->GetExtent();
      const double origin = image->GetOrigin()[a], spacing = image->GetSpacing()[a];
      const double half = extent[2 * a] == extent[2 * a + 1] ? 0.5 * spacing : 0.0; // one layer of points is drawn as a sheet
      box[2 * a] = origin + spacing * extent[2 * a] - half;
      box[2 * a + 1] = origin + spacing * extent[2 * a + 1] + half;
      move->SetElement(a, 3, -origin);
      turn->SetElement(a, 3, origin);
      for (int b = 0; b < 3; ++b) {
        turn->SetElement(a, b, image->GetDirectionMatrix()->GetElement(a, b));
      }
    }
    vtkMatrix4x4::Multiply4x4(turn, move, turn);
    vtkMatrix4x4::Multiply4x4(toWorld, turn, toWorld);
  }
  auto* images = vtkVolumeMapper::SafeDownCast(mapper);
  auto* meshes = vtkStratusTetrahedraMapper::SafeDownCast(mapper);
  if (images && images->GetCropping() && (image || vtkRectilinearGrid::SafeDownCast(mapper->GetDataObjectInput()))) {
    Crop(images, box);
  } else if (meshes && meshes->GetCropping()) {
    Crop(meshes, box);
  }
}

std::vector<vtkStratusHull::HalfSpace> FindClipping(vtkAbstractVolumeMapper* mapper)
{
  std::vector<vtkStratusHull::HalfSpace> within;
  vtkPlaneCollection* planes = mapper->GetClippingPlanes();
  for (int p = 0; planes && p < planes->GetNumberOfItems(); ++p) {
    vtkStratusHull::Vector normal, origin;
    planes->GetItem(p)->GetNormal(normal.data());
    planes->GetItem(p)->GetOrigin(origin.data());
    if (vtkMath::Normalize(normal.data()) > 0.0) {
      within.push_back({ normal, vtkMath::Dot(normal.data(), origin.data()) });
    }
  }
  return within;
}

// Finds the region in which an entry may show. A prop other than a plain volume is taken for its bounds.
void SetHull(Entry& entry, const vtkVolume* current)
{
  vtkAbstractVolumeMapper* mapper = entry.GetMapper();
  double box[6] = { 0.0, -1.0, 0.0, -1.0, 0.0, -1.0 };
  vtkNew<vtkMatrix4x4> matrix;
  std::vector<vtkStratusHull::HalfSpace> within;
  if (mapper) {
    entry.GetVolume()->Update();
  }
  if (mapper && !entry.Prop->IsA("vtkMultiVolume") && mapper->GetDataObjectInput()) {
    const bool moved = entry.Matrix && entry.Prop != current;
    matrix->DeepCopy(moved ? entry.Matrix.Get() : entry.Prop->GetMatrix());
    FindBox(mapper, box, matrix);
    within = FindClipping(mapper);
  } else if (const double* bounds = entry.Prop->GetBounds()) {
    std::copy_n(bounds, 6, box);
  }
  entry.Hull = vtkStratusHull();
  if (box[0] <= box[1] && box[2] <= box[3] && box[4] <= box[5]) {
    entry.Hull.Set(box, matrix->GetData(), within);
  }
}

// ---------------------------------------------------------------- the order

using Group = std::vector<size_t>; // numbers of entries that are drawn together

// Finds the groups of media that overlap, or that are before one another in a ring, and puts the groups in order from back to front. It
// finds the strongly connected components of "must be drawn before" by Tarjan's algorithm, which ends with those at the back.
class Sorter
{
public:
  Sorter(const std::vector<Entry>& entries, const vtkStratusHull::View& view) : Entries(entries), View(view) {}

  // media: numbers of entries in an order that does not depend on the renderer.
  std::vector<Group> Sort(const Group& media)
  {
    this->Media = media;
    this->States.assign(media.size(), State());
    for (size_t n = 0; n < media.size(); ++n) {
      if (this->States[n].Found == 0) {
        this->Visit(n);
      }
    }
    std::reverse(this->Groups.begin(), this->Groups.end());
    return this->Groups;
  }

private:
  struct State {
    size_t Found = 0, Lowest = 0; // 0: not visited
    bool Waits = false;
  };

  void Visit(size_t n)
  {
    State& state = this->States[n];
    state.Found = state.Lowest = ++this->Count;
    state.Waits = true;
    this->Waiting.push_back(n);
    const vtkStratusHull& hull = this->Entries[this->Media[n]].Hull;
    for (size_t next = 0; next < this->Media.size(); ++next) {
      const State& other = this->States[next];
      if (next == n || (other.Found != 0 && !other.Waits)) {
        continue;
      }
      const vtkStratusHull::Relation relation = hull.Compare(this->Entries[this->Media[next]].Hull, this->View);
      if (relation == vtkStratusHull::BEHIND || relation == vtkStratusHull::OVERLAP) {
        if (other.Found == 0) {
          this->Visit(next);
        }
        state.Lowest = std::min(state.Lowest, other.Lowest);
      }
    }
    if (state.Lowest == state.Found) {
      const auto first = std::find(this->Waiting.begin(), this->Waiting.end(), n);
      Group group;
      for (auto at = first; at != this->Waiting.end(); ++at) {
        this->States[*at].Waits = false;
        group.push_back(*at);
      }
      this->Waiting.erase(first, this->Waiting.end());
      std::sort(group.begin(), group.end());
      for (size_t& member : group) {
        member = this->Media[member];
      }
      this->Groups.push_back(group);
    }
  }

  const std::vector<Entry>& Entries;
  const vtkStratusHull::View& View;
  Group Media, Waiting;
  std::vector<State> States;
  std::vector<Group> Groups;
  size_t Count = 0;
};

// ---------------------------------------------------------------- a frame

// The calls of one frame, or of one pass of a frame that draws volumes several times. Pointers of an earlier frame are only compared.
class Round
{
public:
  bool Draw(vtkRenderer* renderer, vtkVolume* volume, vtkAbstractVolumeMapper* mapper);

private:
  void Begin(vtkRenderer* renderer, std::vector<Entry>& entries, vtkVolume* current);
  void Schedule();
  void DrawUpTo(size_t end);
  void DrawOne(const Entry& entry);
  void DrawMixed(const Group& group);
  void Warn(const std::string& text);

  bool IsDrawing = false;
  vtkRenderer* Renderer = nullptr;
  std::vector<Entry> Entries;
  std::vector<bool> Asked;
  vtkStratusHull::View View;
  std::vector<Group> Groups;
  std::vector<size_t> Ends; // of each entry: groups before this number are drawn when the entry's volume is to be drawn
  size_t Drawn = 0;         // groups that are drawn
  vtkVolume* Current = nullptr;
  vtkAbstractVolumeMapper* CurrentMapper = nullptr;
  std::list<std::pair<vtkWeakPointer<vtkRenderer>, vtkStratusLeftOut>> Warned;
};

thread_local Round TheRound;

// Sets a flag as long as it lives.
class Flag
{
public:
  explicit Flag(bool& flag) : Value(flag) { this->Value = true; }
  ~Flag() { this->Value = false; }
  Flag(const Flag&) = delete;
  void operator=(const Flag&) = delete;

private:
  bool& Value;
};

// Raises a warning unless the renderer has had it.
void Round::Warn(const std::string& text)
{
  this->Warned.remove_if([](const auto& warned) { return !warned.first; });
  auto found =
    std::find_if(this->Warned.begin(), this->Warned.end(), [this](const auto& warned) { return warned.first == this->Renderer; });
  if (found == this->Warned.end()) {
    this->Warned.emplace_front(this->Renderer, vtkStratusLeftOut());
    found = this->Warned.begin();
  }
  vtkObject* object = this->CurrentMapper;
  found->second.WarnOnce(object ? object : this->Current, text);
}

void Round::DrawOne(const Entry& entry)
{
  vtkVolume* volume = entry.GetVolume();
  const bool plain = std::strcmp(volume->GetClassName(), "vtkVolume") == 0;
  const bool current = volume == this->Current || (!plain && entry.GetMapper() == this->CurrentMapper);
  if (current && this->CurrentMapper) {
    this->CurrentMapper->Render(this->Renderer, this->Current);
    return;
  }
  if (entry.Matrix) {
    volume->PokeMatrix(entry.Matrix);
  }
  if (plain) {             // not by the prop, which adds the time when VTK calls it
    volume->GetProperty(); // makes one
    if (entry.GetMapper()->GetDataObjectInput()) {
      entry.GetMapper()->Render(this->Renderer, volume);
    }
  } else {
    volume->RenderVolumetricGeometry(this->Renderer);
  }
  if (entry.Matrix) {
    volume->PokeMatrix(nullptr);
  }
}

void Round::DrawMixed(const Group& group)
{
  std::vector<vtkVolume*> volumes;
  for (size_t n : group) {
    volumes.push_back(this->Entries[n].GetVolume());
    if (this->Entries[n].Matrix && volumes.back() != this->Current) {
      volumes.back()->PokeMatrix(this->Entries[n].Matrix);
    }
    volumes.back()->GetProperty();
  }
  const std::string reason =
    TheMixer ? TheMixer->Mix(this->Renderer, volumes) : "no volume has a vtkStratusVolumeMapper, at least one of them must";
  for (size_t n : group) {
    if (this->Entries[n].Matrix && this->Entries[n].Prop != this->Current) {
      this->Entries[n].Prop->PokeMatrix(nullptr);
    }
  }
  if (reason.empty()) {
    return;
  }
  this->Warn(
    "volumes overlap and are not mixed along the rays, but drawn one over the other, the one with the nearest middle last: " + reason);
  Group order = group;
  std::stable_sort(order.begin(), order.end(),
    [this](size_t a, size_t b) { return this->Entries[a].Hull.GetDistance(this->View) > this->Entries[b].Hull.GetDistance(this->View); });
  for (size_t n : order) {
    this->DrawOne(this->Entries[n]);
  }
}

void Round::DrawUpTo(size_t end)
{
  const Flag drawing(this->IsDrawing);
  for (; this->Drawn < end; ++this->Drawn) {
    const Group& group = this->Groups[this->Drawn];
    if (group.size() == 1) {
      this->DrawOne(this->Entries[group[0]]);
    } else {
      this->DrawMixed(group);
    }
  }
}

// Divides the groups among the entries of our mappers: groups that belong behind the next prop of another class come before it. Warns if
// no entry can draw them in time, or if the other volume overlaps them.
void Round::Schedule()
{
  const size_t count = this->Entries.size();
  size_t last = count; // the last of our entries
  for (size_t n = 0; n < count; ++n) {
    last = this->Entries[n].IsOurs() ? n : last;
  }
  const auto compare = [this](const Entry& other, const Group& group) {
    bool before = false, behind = false, overlap = false;
    for (size_t n : group) {
      const vtkStratusHull::Relation relation = other.Hull.Compare(this->Entries[n].Hull, this->View);
      overlap = overlap || relation == vtkStratusHull::OVERLAP;
      before = before || relation == vtkStratusHull::BEFORE;
      behind = behind || relation == vtkStratusHull::BEHIND;
    }
    const bool both = overlap || (before && behind);
    return both ? vtkStratusHull::OVERLAP : before ? vtkStratusHull::BEFORE : behind ? vtkStratusHull::BEHIND : vtkStratusHull::APART;
  };
  this->Ends.assign(count, 0);
  size_t end = 0; // groups drawn so far
  const Entry* conflict = nullptr;
  for (size_t n = 0; n < count; ++n) {
    if (this->Entries[n].IsOurs()) {
      const auto next = std::find_if(
        this->Entries.begin() + static_cast<std::ptrdiff_t>(n), this->Entries.end(), [](const Entry& entry) { return !entry.IsOurs(); });
      size_t wanted = this->Groups.size();
      while (n < last && next != this->Entries.end() && wanted > end &&
        compare(*next, this->Groups[wanted - 1]) != vtkStratusHull::BEFORE &&
        this->Entries[this->Groups[wanted - 1][0]].Of == vtkStratusDepthOrder::MEDIUM) {
        --wanted;
      }
      end = std::max(end, wanted);
      this->Ends[n] = end;
      continue;
    }
    for (size_t g = 0; g < this->Groups.size(); ++g) {
      const vtkStratusHull::Relation relation = compare(this->Entries[n], this->Groups[g]);
      const bool solid = this->Entries[this->Groups[g][0]].Of == vtkStratusDepthOrder::SOLID; // the other's rays end there
      const bool wrong = g < end ? relation == vtkStratusHull::BEHIND && !solid : relation == vtkStratusHull::BEFORE;
      if (wrong || (relation == vtkStratusHull::OVERLAP && !(g < end && solid))) {
        conflict = &this->Entries[n];
      }
    }
  }
  if (conflict) {
    const vtkObject* drawer = conflict->GetMapper() ? static_cast<vtkObject*>(conflict->GetMapper()) : conflict->Prop;
    this->Warn(std::string("a volume of a ") + drawer->GetClassName() +
      " overlaps volumes of Stratus's mappers, or is between them, so that the picture depends on the order of volumes in the renderer; " +
      "volumes of vtkStratusVolumeMapper and vtkStratusTetrahedraMapper are drawn by depth in any order");
  }
}

void Round::Begin(vtkRenderer* renderer, std::vector<Entry>& entries, vtkVolume* current)
{
  this->Renderer = renderer;
  this->Entries.swap(entries);
  this->Asked.assign(this->Entries.size(), false);
  this->Groups.clear();
  this->Drawn = 0;
  vtkStratusPicture picture;
  picture.Set(renderer, std::vector<vtkStratusPicture::Box>(), 1.0);
  this->View.Parallel = picture.Camera.parallel != 0;
  std::copy_n(this->View.Parallel ? picture.Camera.forward : picture.Camera.eye, 3, this->View.Eye.begin());
  Group media, solids;
  for (size_t n = 0; n < this->Entries.size(); ++n) {
    SetHull(this->Entries[n], current);
    if (this->Entries[n].IsOurs()) {
      (this->Entries[n].Of == vtkStratusDepthOrder::SOLID ? solids : media).push_back(n);
    }
  }
  // An order that does not depend on the renderer, so that neither do sums of floats in volumes that are mixed.
  std::sort(media.begin(), media.end(), [this](size_t a, size_t b) {
    const Entry &first = this->Entries[a], &second = this->Entries[b];
    return first.Hull < second.Hull || (!(second.Hull < first.Hull) && std::less<vtkProp3D*>()(first.Prop, second.Prop));
  });
  for (size_t n : solids) { // they write depth, at which the rays of media end
    this->Groups.push_back({ n });
  }
  for (const Group& group : Sorter(this->Entries, this->View).Sort(media)) {
    this->Groups.push_back(group);
  }
  this->Schedule();
}

bool Round::Draw(vtkRenderer* renderer, vtkVolume* volume, vtkAbstractVolumeMapper* mapper)
{
  if (this->IsDrawing || renderer->GetSelector()) { // a selector draws each prop in a colour of its own
    return false;
  }
  std::vector<Entry> entries = FindEntries(renderer);
  const auto isIt = [&](const Entry& entry) { return entry.Prop == volume; };
  auto found = std::find_if(entries.begin(), entries.end(), isIt);
  if (found == entries.end() && mapper) { // a prop with levels of detail draws by a volume of its own
    found = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.GetMapper() == mapper; });
  }
  const bool twice = std::count_if(entries.begin(), entries.end(), isIt) > 1; // by two assemblies
  if (entries.size() < 2 || found == entries.end() || !found->IsOurs() || twice) {
    return false;
  }
  const size_t at = static_cast<size_t>(found - entries.begin());
  const auto isSame = [](const Entry& a, const Entry& b) { return a.Prop == b.Prop && a.Of == b.Of; };
  const bool goesOn = renderer == this->Renderer &&
    std::equal(entries.begin(), entries.end(), this->Entries.begin(), this->Entries.end(), isSame) && !this->Asked[at];
  this->Current = volume;
  this->CurrentMapper = mapper;
  if (!goesOn) {
    this->Begin(renderer, entries, volume);
  }
  this->Asked[at] = true;
  this->DrawUpTo(this->Ends[at]);
  return true;
}
} // namespace

void vtkStratusDepthOrder::SetMixer(const Mixer* mixer)
{
  TheMixer = mixer;
}

bool vtkStratusDepthOrder::Draw(vtkRenderer* renderer, vtkVolume* volume, vtkAbstractVolumeMapper* mapper)
{
  try {
    return TheRound.Draw(renderer, volume, mapper);
  } catch (const std::bad_alloc&) { // the volume is drawn in the renderer's order
    return false;
  }
}
