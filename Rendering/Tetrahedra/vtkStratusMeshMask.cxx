// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMeshMask.h"

#include "vtkStratusMask.h"

namespace {
// Adds a point of a mesh to a sum.
void Add(const stratus_mesh& mesh, int64_t point, double sum[3])
{
  for (int a = 0; a < 3; ++a) {
    sum[a] += mesh.points ? mesh.points[3 * point + a] : static_cast<double>(mesh.float_points[3 * point + a]);
  }
}

// Returns one byte for each cell of a part: its label, or whether it is hidden, by itself or by the mask.
std::vector<uint8_t> BytesOf(const stratus_mesh& mesh, const vtkStratusMask& mask, bool labels)
{
  std::vector<uint8_t> bytes(static_cast<size_t>(mesh.cell_count));
  const bool lattice = mesh.lattice[0] > 0;
  const int64_t row = mesh.lattice[0], layer = row * mesh.lattice[1];
  for (int64_t cell = 0; cell < mesh.cell_count; ++cell) {
    double middle[3] = { 0.0, 0.0, 0.0 };
    const int64_t i = lattice ? cell % (row - 1) : 0, j = lattice ? cell / (row - 1) % (mesh.lattice[1] - 1) : 0,
                  k = lattice ? cell / ((row - 1) * (mesh.lattice[1] - 1)) : 0;
    const int corners = lattice ? 8 : 4;
    for (int c = 0; c < corners; ++c) {
      const int64_t corner = k * layer + j * row + i + (c & 1) + (c >> 1 & 1) * row + (c >> 2) * layer;
      Add(mesh, lattice ? corner : mesh.vertices[4 * cell + c], middle);
    }
    for (double& x : middle) {
      x /= corners;
    }
    const uint8_t byte = mask.GetAt(middle);
    const bool hides = (mesh.hidden && mesh.hidden[cell]) || byte == 0;
    bytes[static_cast<size_t>(cell)] = labels ? byte : static_cast<uint8_t>(hides);
  }
  return bytes;
}
} // namespace

const stratus_mesh* vtkStratusMeshMask::Apply(const stratus_mesh& mesh, vtkImageData* mask, bool labels, std::string& error)
{
  vtkStratusMask bytes;
  if (!bytes.Set(mask, error)) {
    return nullptr;
  }
  const bool several = mesh.block_count > 0;
  const size_t parts = several ? static_cast<size_t>(mesh.block_count) : 1;
  const void* points = several ? static_cast<const void*>(mesh.blocks)
    : mesh.points              ? mesh.points
                               : static_cast<const void*>(mesh.float_points);
  if (this->Mask != mask || this->Time != bytes.GetTime() || this->Revision != mesh.revision || this->Points != points ||
    this->Labels != labels || this->Bytes.size() != parts) {
    this->Bytes.clear();
    for (size_t part = 0; part < parts; ++part) {
      this->Bytes.push_back(BytesOf(several ? mesh.blocks[part] : mesh, bytes, labels));
    }
    this->Mask = mask;
    this->Time = bytes.GetTime();
    this->Revision = mesh.revision;
    this->Points = points;
    this->Labels = labels;
  }
  this->Mesh = mesh;
  this->Blocks.assign(mesh.blocks, mesh.blocks + mesh.block_count);
  for (size_t part = 0; part < parts; ++part) {
    stratus_mesh& own = several ? this->Blocks[part] : this->Mesh;
    (labels ? own.labels : own.hidden) = this->Bytes[part].data();
  }
  this->Mesh.blocks = several ? this->Blocks.data() : nullptr;
  this->Mesh.revision ^= static_cast<uint64_t>(this->Time) * UINT64_C(0xD6E8FEB86659FD93);
  return &this->Mesh;
}
