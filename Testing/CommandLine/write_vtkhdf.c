/* SPDX-License-Identifier: BSD-3-Clause
 * Writes into the folder that is named the grids that test_files.py has as image.vti and stretched.vtu: image.hdf and stretched.vtkhdf, and
 * plain.h5, in which a data set has the values of image.hdf. */
#include <hdf5.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 5, NY = 4, NZ = 6, POINTS = NX * NY * NZ, CELLS = (NX - 1) * (NY - 1) * (NZ - 1) };

static hid_t must(hid_t id)
{
  if (id < 0) {
    fprintf(stderr, "write-vtkhdf: HDF5 failed\n");
    exit(1);
  }
  return id;
}

static void put_attribute(hid_t at, const char* name, hid_t type, hsize_t count, const void* values)
{
  const hid_t space = must(count ? H5Screate_simple(1, &count, NULL) : H5Screate(H5S_SCALAR));
  const hid_t attribute = must(H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
  must(H5Awrite(attribute, type, values));
  H5Aclose(attribute);
  H5Sclose(space);
}

static void put_values(hid_t at, const char* name, hid_t type, int rank, const hsize_t* size, const void* values)
{
  const hid_t space = must(H5Screate_simple(rank, size, NULL));
  const hid_t data = must(H5Dcreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  must(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  H5Dclose(data);
  H5Sclose(space);
}

static hid_t make_group(hid_t at, const char* name)
{
  return must(H5Gcreate2(at, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

/* Opens a file of a type, and its root group. */
static hid_t open_file(const char* folder, const char* name, const char* type, hid_t* root)
{
  char path[4096];
  const int64_t version[2] = { 1, 0 };
  snprintf(path, sizeof path, "%s/%s", folder, name);
  const hid_t file = must(H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  const hid_t string = must(H5Tcopy(H5T_C_S1));
  *root = make_group(file, "VTKHDF");
  put_attribute(*root, "Version", H5T_NATIVE_INT64, 2, version);
  must(H5Tset_size(string, strlen(type)));
  must(H5Tset_strpad(string, H5T_STR_NULLPAD));
  put_attribute(*root, "Type", string, 0, type);
  H5Tclose(string);
  return file;
}

static void close_file(hid_t file, hid_t root)
{
  H5Gclose(root);
  must(H5Fclose(file));
}

static void put_points(hid_t root, const float* qc, int rank, const hsize_t* size)
{
  const hid_t group = make_group(root, "PointData");
  put_values(group, "qc", H5T_NATIVE_FLOAT, rank, size, qc);
  H5Gclose(group);
}

static void write_image(const char* folder, const float* qc)
{
  const int64_t extent[6] = { 0, NX - 1, 0, NY - 1, 0, NZ - 1 };
  const double origin[3] = { 0, 0, 0 }, spacing[3] = { 1, 1, 1 }, direction[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  const hsize_t size[3] = { NZ, NY, NX };
  hid_t root;
  const hid_t file = open_file(folder, "image.hdf", "ImageData", &root);
  put_attribute(root, "WholeExtent", H5T_NATIVE_INT64, 6, extent);
  put_attribute(root, "Origin", H5T_NATIVE_DOUBLE, 3, origin);
  put_attribute(root, "Spacing", H5T_NATIVE_DOUBLE, 3, spacing);
  put_attribute(root, "Direction", H5T_NATIVE_DOUBLE, 9, direction);
  put_points(root, qc, 3, size);
  close_file(file, root);
}

static void write_data_set(const char* folder, const float* qc)
{
  char path[4096];
  const hsize_t size[3] = { NZ, NY, NX };
  snprintf(path, sizeof path, "%s/plain.h5", folder);
  const hid_t file = must(H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)), group = make_group(file, "run");
  put_values(group, "qc", H5T_NATIVE_FLOAT, 3, size, qc);
  close_file(file, group);
}

/* Hexahedra on levels that stretch. */
static void write_cells(const char* folder, const float* qc)
{
  static const float levels[NZ] = { 0, 1, 2, 4, 7, 11 };
  static float points[POINTS][3];
  static int64_t connectivity[CELLS][8], offsets[CELLS + 1];
  static uint8_t types[CELLS];
  const int64_t counts[3] = { POINTS, CELLS, 8 * CELLS };
  const hsize_t one = 1, cells = CELLS, borders = CELLS + 1, ids = 8 * CELLS, values = POINTS, places[2] = { POINTS, 3 };
  for (int p = 0; p < POINTS; ++p) {
    points[p][0] = (float)(p % NX);
    points[p][1] = (float)(p / NX % NY);
    points[p][2] = levels[p / (NX * NY)];
  }
  for (int c = 0; c < CELLS; ++c) {
    const int64_t first = c % (NX - 1) + NX * (c / (NX - 1) % (NY - 1) + (int64_t)NY * (c / ((NX - 1) * (NY - 1))));
    const int64_t corners[4] = { 0, 1, NX + 1, NX };
    for (int i = 0; i < 8; ++i) {
      connectivity[c][i] = first + corners[i % 4] + (i / 4) * NX * NY;
    }
    offsets[c + 1] = 8 * (c + 1);
    types[c] = 12;
  }
  hid_t root;
  const hid_t file = open_file(folder, "stretched.vtkhdf", "UnstructuredGrid", &root);
  put_values(root, "NumberOfPoints", H5T_NATIVE_INT64, 1, &one, &counts[0]);
  put_values(root, "NumberOfCells", H5T_NATIVE_INT64, 1, &one, &counts[1]);
  put_values(root, "NumberOfConnectivityIds", H5T_NATIVE_INT64, 1, &one, &counts[2]);
  put_values(root, "Points", H5T_NATIVE_FLOAT, 2, places, points);
  put_values(root, "Connectivity", H5T_NATIVE_INT64, 1, &ids, connectivity);
  put_values(root, "Offsets", H5T_NATIVE_INT64, 1, &borders, offsets);
  put_values(root, "Types", H5T_NATIVE_UINT8, 1, &cells, types);
  put_points(root, qc, 1, &values);
  close_file(file, root);
}

int main(int argc, char* argv[])
{
  const char* folder = argc > 1 ? argv[1] : ".";
  static float qc[POINTS];
  for (int p = 0; p < POINTS; ++p) {
    qc[p] = (float)(p % NX + 2 * (p / NX % NY) + 4 * (p / (NX * NY)));
  }
  write_image(folder, qc);
  write_cells(folder, qc);
  write_data_set(folder, qc);
  return 0;
}
