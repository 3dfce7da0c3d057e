/* SPDX-License-Identifier: BSD-3-Clause
 * make-river OUT.nc [FINENESS]: writes a river's plume on a shelf over a tide of 12 h 25 min, as a water model would: a mesh of triangles
 * at the mouth and quadrilaterals elsewhere, ten layers of sigma, flats that fall dry, every 25 minutes. FINENESS (default 3) divides each
 * kilometre along the coast. The plume is a formula, not a simulation. */
#include "netcdf_writing.h"
#include "noise.h"

enum { layers = 10, steps = 31, corners = 4 };
static const double pi = 3.14159265358979323846;
static const double mouth = 700.0; /* half the river's width, metres */

struct mesh {
  size_t columns, rows, nodes, faces; /* nodes are columns x rows, y fastest; those on land are in no face */
  double *x, *y, *bed;                /* metres, z of the bottom upwards */
  int* face;                          /* four nodes each, -1 for the last of a triangle */
};

/* The river comes from the west, x < 0; the coast is x = 0. */
static int is_land(double x, double y)
{
  return x < -1.0 && fabs(y) > mouth * (1.0 + 0.00002 * x) + 1.0;
}

static double bottom(double x, double y)
{
  const double wavy = 1.0 + 0.25 * noise(x / 2500.0 + 7.0, y / 2500.0, 3.0);
  if (x < 0.0) {
    return -6.0 + 4.5 * pow(fmin(fabs(y) / mouth, 1.15), 4.0);
  }
  const double channel = 6.0 * exp(-pow(y / (1.3 * mouth), 2.0)) * exp(-x / 9000.0);
  return 1.0 - wavy * (0.3 + x / 420.0) - channel; /* flats along the coast lie above low water */
}

static void add_face(struct mesh* m, int a, int b, int c, int d)
{
  const int all[corners] = { a, b, c, d };
  memcpy(&m->face[corners * m->faces], all, sizeof all);
  ++m->faces;
}

static void make_mesh(struct mesh* m, int fineness)
{
  m->columns = (size_t)(22 * fineness + 1);
  m->rows = (size_t)(24 * fineness + 1);
  m->nodes = m->columns * m->rows;
  m->x = memory(m->nodes, sizeof(double));
  m->y = memory(m->nodes, sizeof(double));
  m->bed = memory(m->nodes, sizeof(double));
  m->face = memory(2 * corners * m->nodes, sizeof(int));
  for (size_t i = 0; i < m->nodes; ++i) {
    const double u = (double)(i / m->rows) / (double)fineness - 6.0, v = (double)(i % m->rows) / (double)fineness - 12.0;
    m->x[i] = 1000.0 * (u > 8.0 ? u + 0.10 * (u - 8.0) * (u - 8.0) : u);        /* wider out at sea */
    m->y[i] = 1000.0 * (fabs(v) < 2.0 ? 0.35 * v : v + (v < 0.0 ? 1.3 : -1.3)); /* finer at the river */
    m->bed[i] = bottom(m->x[i], m->y[i]);
  }
  for (size_t c = 0; c + 1 < m->columns; ++c) {
    for (size_t r = 0; r + 1 < m->rows; ++r) {
      const size_t a = c * m->rows + r, b = a + m->rows;
      const double x = 0.5 * (m->x[a] + m->x[b]), y = 0.5 * (m->y[a] + m->y[a + 1]);
      if (is_land(x, y)) {
        continue;
      }
      if (hypot(x, y) < 5000.0) {
        add_face(m, (int)a, (int)b, (int)b + 1, -1);
        add_face(m, (int)a, (int)b + 1, (int)a + 1, -1);
      } else {
        add_face(m, (int)a, (int)b, (int)b + 1, (int)a + 1);
      }
    }
  }
}

/* The tide comes in from the sea; `phase` is 0 at high water at the coast. */
static double surface(double x, double phase)
{
  return 1.3 * cos(phase + 0.35 * x / 20000.0) + (x < 0.0 ? -x * 2e-5 : 0.0);
}

/* The part of river water, 0..1, at a depth below the surface: a bulge that ebb pushes out, and the coast turns to the right. */
static double dye(double x, double y, double depth, double phase)
{
  if (x < 0.0) {
    const double salt = 1.0 / (1.0 + exp((x + 2500.0 - 2200.0 * sin(phase)) / 600.0 + depth - 2.0)); /* a wedge creeps in with the flood */
    return fmin(1.0, fmax(salt, exp(-depth / 2.0)));
  }
  double most = 0.0;
  for (int ebb = 0; ebb < 2; ++ebb) { /* this ebb's water, and the one before's */
    const double age = fmod(phase + 2.0 * pi, 2.0 * pi) / (2.0 * pi) + ebb;
    const double radius = 1800.0 + 5200.0 * sqrt(age), away = 900.0 + 3000.0 * age;
    const double wind = 420.0 * turbulence(x / 2600.0, y / 2600.0, age, 3);
    const double dx = (x - away + wind) / radius, dy = (y + 2600.0 * age * age + wind) / (1.25 * radius);
    const double thick = 0.6 + 2.2 * exp(-2.0 * (dx * dx + dy * dy)) / (1.0 + age);
    const double strength = exp(-1.1 * age) * (0.85 + 0.35 * turbulence(x / 1500.0, y / 1500.0, 5.0 + age, 4));
    const double value = strength / (1.0 + exp((sqrt(dx * dx + dy * dy) - 0.75) / 0.09)) / (1.0 + exp((depth - thick) / 0.35));
    most = fmax(most, value);
  }
  return fmin(fmax(most, 0.0), 1.0);
}

static void define(int file, const struct mesh* m, int ids[12])
{
  const int time = dimension(file, "time", NC_UNLIMITED), node = dimension(file, "mesh2d_nNodes", m->nodes);
  const int face = dimension(file, "mesh2d_nFaces", m->faces), most = dimension(file, "mesh2d_nMax_face_nodes", corners);
  const int layer = dimension(file, "mesh2d_nLayers", layers), border = dimension(file, "mesh2d_nInterfaces", layers + 1);
  const int two = 2, one = 1, none = -1;
  ids[0] = variable(file, "mesh2d", NC_INT, 0, NULL, "1", "Topology data of a 2-D mesh");
  text(file, ids[0], "cf_role", "mesh_topology");
  must(nc_put_att_int(file, ids[0], "topology_dimension", NC_INT, 1, &two));
  text(file, ids[0], "node_coordinates", "mesh2d_node_x mesh2d_node_y");
  text(file, ids[0], "face_node_connectivity", "mesh2d_face_nodes");
  text(file, ids[0], "face_dimension", "mesh2d_nFaces");
  ids[1] = variable(file, "time", NC_DOUBLE, 1, &time, "minutes since 2024-06-01 00:00", NULL);
  ids[2] = variable(file, "mesh2d_node_x", NC_DOUBLE, 1, &node, "m", NULL);
  text(file, ids[2], "standard_name", "projection_x_coordinate");
  ids[3] = variable(file, "mesh2d_node_y", NC_DOUBLE, 1, &node, "m", NULL);
  text(file, ids[3], "standard_name", "projection_y_coordinate");
  const int of_faces[2] = { face, most };
  ids[4] = variable(file, "mesh2d_face_nodes", NC_INT, 2, of_faces, "1", NULL);
  must(nc_put_att_int(file, ids[4], "start_index", NC_INT, 1, &one));
  must(nc_put_att_int(file, ids[4], "_FillValue", NC_INT, 1, &none));
  ids[5] = variable(file, "mesh2d_interface_sigma", NC_DOUBLE, 1, &border, "1", NULL);
  text(file, ids[5], "standard_name", "ocean_sigma_coordinate");
  text(file, ids[5], "formula_terms", "sigma: mesh2d_interface_sigma eta: mesh2d_s1 bedlevel: mesh2d_node_z");
  ids[6] = variable(file, "mesh2d_layer_sigma", NC_DOUBLE, 1, &layer, "1", NULL);
  text(file, ids[6], "standard_name", "ocean_sigma_coordinate");
  ids[7] = variable(file, "mesh2d_node_z", NC_DOUBLE, 1, &node, "m", "height of the bottom");
  text(file, ids[7], "standard_name", "altitude");
  const int of_surface[2] = { time, node }, of_layers[3] = { time, node, layer }, of_cells[3] = { time, face, layer };
  ids[8] = variable(file, "mesh2d_s1", NC_DOUBLE, 2, of_surface, "m", "water level");
  text(file, ids[8], "standard_name", "sea_surface_height");
  ids[9] = variable(file, "dye", NC_FLOAT, 3, of_layers, "1", "part of river water");
  ids[10] = variable(file, "salinity", NC_FLOAT, 3, of_cells, "psu", "salinity of the layers of faces");
  text(file, NC_GLOBAL, "Conventions", "CF-1.8 UGRID-1.0");
  must(nc_enddef(file));
}

static void write_mesh(int file, const struct mesh* m, const int ids[12])
{
  double sigma[layers + 1], middle[layers];
  int* names = memory(corners * m->faces, sizeof(int));
  for (size_t i = 0; i < corners * m->faces; ++i) {
    names[i] = m->face[i] < 0 ? -1 : m->face[i] + 1;
  }
  for (int i = 0; i <= layers; ++i) { /* thin layers at the surface, where the plume is */
    const double t = (double)i / layers;
    sigma[i] = -pow(1.0 - t, 1.8);
    if (i > 0) {
      middle[i - 1] = 0.5 * (sigma[i - 1] + sigma[i]);
    }
  }
  must(nc_put_var_double(file, ids[2], m->x));
  must(nc_put_var_double(file, ids[3], m->y));
  must(nc_put_var_int(file, ids[4], names));
  must(nc_put_var_double(file, ids[5], sigma));
  must(nc_put_var_double(file, ids[6], middle));
  must(nc_put_var_double(file, ids[7], m->bed));
  free(names);
}

static void write_step(int file, const struct mesh* m, const int ids[12], size_t step, double* level, float* of_nodes, float* of_faces)
{
  const double minutes = 25.0 * (double)step, phase = 2.0 * pi * minutes / 745.0;
  for (size_t node = 0; node < m->nodes; ++node) {
    level[node] = surface(m->x[node], phase);
    for (int l = 0; l < layers; ++l) {
      const double above = 0.5 * (pow(1.0 - (double)l / layers, 1.8) + pow(1.0 - (l + 1.0) / layers, 1.8));
      const double depth = above * fmax(level[node] - m->bed[node], 0.0);
      of_nodes[layers * node + (size_t)l] = (float)dye(m->x[node], m->y[node], depth, phase);
    }
  }
  for (size_t face = 0; face < m->faces; ++face) {
    const int* of = &m->face[corners * face];
    for (size_t l = 0; l < layers; ++l) {
      float sum = 0.0f;
      for (int c = 0; c < 3; ++c) {
        sum += of_nodes[layers * (size_t)of[c] + l] / 3.0f;
      }
      of_faces[layers * face + l] = 33.0f * (1.0f - sum);
    }
  }
  const size_t start[3] = { step, 0, 0 }, nodes[3] = { 1, m->nodes, layers }, faces[3] = { 1, m->faces, layers };
  must(nc_put_vara_double(file, ids[1], start, nodes, &minutes));
  must(nc_put_vara_double(file, ids[8], start, nodes, level));
  must(nc_put_vara_float(file, ids[9], start, nodes, of_nodes));
  must(nc_put_vara_float(file, ids[10], start, faces, of_faces));
}

int main(int count, char** words)
{
  const int fineness = count > 2 ? atoi(words[2]) : 3;
  if (count < 2 || fineness < 1 || fineness > 50) {
    fprintf(stderr, "make-river OUT.nc [FINENESS, 1..50]\n");
    return 2;
  }
  struct mesh m = { 0 };
  make_mesh(&m, fineness);
  int file = -1, ids[12];
  must(nc_create(words[1], NC_CLOBBER | NC_64BIT_OFFSET, &file));
  define(file, &m, ids);
  write_mesh(file, &m, ids);
  double* level = memory(m.nodes, sizeof *level);
  float* of_nodes = memory(layers * m.nodes, sizeof *of_nodes);
  float* of_faces = memory(layers * m.faces, sizeof *of_faces);
  for (size_t step = 0; step < steps; ++step) {
    write_step(file, &m, ids, step, level, of_nodes, of_faces);
  }
  must(nc_close(file));
  free(level);
  free(of_nodes);
  free(of_faces);
  free(m.x);
  free(m.y);
  free(m.bed);
  free(m.face);
  return 0;
}
