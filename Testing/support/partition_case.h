/* SPDX-License-Identifier: BSD-3-Clause
 * Partitions of small meshes, and checks of their pieces. */
#ifndef STRATUS_TESTING_PARTITION_CASE_H
#define STRATUS_TESTING_PARTITION_CASE_H

#include "mesh.h"
#include "mesh_case.h"

static inline double volume_of(const double* points, const int32_t* v)
{
  double m[3][3];
  for (int i = 0; i < 9; ++i) {
    m[i / 3][i % 3] = points[3 * (int64_t)v[i / 3 + 1] + i % 3] - points[3 * (int64_t)v[0] + i % 3];
  }
  return (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])) /
    6.0;
}

static inline mesh_case mesh_of(const stratus_partition_result* cut)
{
  return (mesh_case){ (double*)(uintptr_t)cut->points, (int32_t*)(uintptr_t)cut->vertices, cut->point_count, cut->cell_count };
}

/* Checks that the pieces of each cell have its volume, its integral of an interpolated field, and its orientation, and that new points lie
 * where their ends and weights put them. */
static inline void assert_pieces_fill_their_cells(const mesh_case* mesh, const stratus_partition_result* cut)
{
  double* sums = calloc((size_t)mesh->cell_count * 2 + 1, sizeof(double));
  double* field = malloc((size_t)cut->point_count * sizeof(double) + 1);
  assert_true(sums && field);
  assert_int_equal(cut->old_points, mesh->point_count);
  assert_memory_equal(cut->points, mesh->points, (size_t)mesh->point_count * 3 * sizeof(double));
  for (int64_t i = 0; i < cut->point_count; ++i) {
    field[i] = i < mesh->point_count ? (double)(i * 37 % 101) : 0.0;
    if (i >= mesh->point_count) {
      const int32_t* end = cut->ends + 2 * (i - mesh->point_count);
      const double w = cut->weights[i - mesh->point_count];
      assert_true(w > 0.0 && w < 1.0 && end[0] < i && end[1] < i && end[0] != end[1]);
      field[i] = (1.0 - w) * field[end[0]] + w * field[end[1]];
      for (int a = 0; a < 3; ++a) {
        const double p = cut->points[3 * (int64_t)end[0] + a], q = cut->points[3 * (int64_t)end[1] + a];
        assert_true(fabs((1.0 - w) * p + w * q - cut->points[3 * i + a]) <= 4e-16 * fmax(fabs(p), fabs(q)));
      }
    }
  }
  for (int64_t c = 0; c < cut->cell_count; ++c) {
    const int32_t* v = cut->vertices + 4 * c;
    const int32_t origin = cut->cells[c];
    const double volume = volume_of(cut->points, v);
    const double *p = cut->points, *o = mesh->points;
    const int32_t* w = mesh->vertices + 4 * (int64_t)origin;
    assert_true(origin >= 0 && origin < mesh->cell_count);
    assert_int_equal(stratus_orientation(p + 3 * (int64_t)v[0], p + 3 * (int64_t)v[1], p + 3 * (int64_t)v[2], p + 3 * (int64_t)v[3]),
      stratus_orientation(o + 3 * (int64_t)w[0], o + 3 * (int64_t)w[1], o + 3 * (int64_t)w[2], o + 3 * (int64_t)w[3]));
    sums[2 * origin] += volume;
    sums[2 * origin + 1] += 0.25 * volume * (field[v[0]] + field[v[1]] + field[v[2]] + field[v[3]]);
  }
  for (int64_t c = 0; c < mesh->cell_count; ++c) {
    const int32_t* v = mesh->vertices + 4 * c;
    const double volume = volume_of(mesh->points, v), mean = 0.25 * (field[v[0]] + field[v[1]] + field[v[2]] + field[v[3]]);
    assert_true(fabs(sums[2 * c] - volume) <= 1e-12 * fabs(volume));
    assert_true(fabs(sums[2 * c + 1] - volume * mean) <= 1e-12 * fabs(volume) * 101.0);
  }
  free(sums);
  free(field);
}

static inline stratus_partition* make_partition(stratus_context* context, const mesh_case* mesh, const stratus_partition_options* options)
{
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_partition* partition = NULL;
  assert_int_equal(stratus_partition_create(context, &view, options, &partition), STRATUS_OK);
  return partition;
}

#endif
