// SPDX-License-Identifier: BSD-3-Clause
// Water models' meshes in layers: a square and a triangle, in the conventions of three models, against heights computed by hand.
#include "netcdf_testing.h"

#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkStratusUgridReader.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

#include <filesystem>
#include <functional>

namespace {

using reader = vtkStratusUgridReader;

// Nodes 0 1 2 3 are a rectangle of 2 x 1, nodes 1 4 2 a triangle next to it, whose corners the file has clockwise. Two layers of sigma, two
// times. Bottom -10; the free surface is at 0, then at 2 on the rectangle and 6 on the triangle.
netcdf_content delft()
{
  netcdf_content c;
  c.dimensions = { { "time", 2 }, { "node", 5 }, { "face", 2 }, { "corner", 4 }, { "layer", 2 }, { "border", 3 } };
  c.variables = { { "mesh2d", NC_INT, {}, { 0 },
                    { { "cf_role", "mesh_topology" }, { "node_coordinates", "mesh2d_node_x mesh2d_node_y" },
                      { "face_node_connectivity", "mesh2d_face_nodes" } },
                    { { "topology_dimension", 2 } } },
    { "time", NC_DOUBLE, { "time" }, { 0, 600 }, { { "units", "seconds since 2020-05-01" } }, {} },
    { "mesh2d_node_x", NC_DOUBLE, { "node" }, { 0, 2, 2, 0, 3 }, { { "units", "m" }, { "standard_name", "projection_x_coordinate" } }, {} },
    { "mesh2d_node_y", NC_DOUBLE, { "node" }, { 0, 0, 1, 1, 0 }, { { "units", "m" }, { "standard_name", "projection_y_coordinate" } }, {} },
    { "mesh2d_face_nodes", NC_INT, { "face", "corner" }, { 1, 2, 3, 4, 2, 3, 5, -1 }, {}, { { "start_index", 1 }, { "_FillValue", -1 } } },
    { "mesh2d_layer_sigma", NC_DOUBLE, { "layer" }, { -.75, -.25 },
      { { "standard_name", "ocean_sigma_coordinate" },
        { "formula_terms", "sigma: mesh2d_layer_sigma eta: mesh2d_s1 bedlevel: mesh2d_flowelem_bl" } },
      {} },
    { "mesh2d_interface_sigma", NC_DOUBLE, { "border" }, { -1, -.5, 0 }, { { "standard_name", "ocean_sigma_coordinate" } }, {} },
    { "mesh2d_s1", NC_DOUBLE, { "time", "face" }, { 0, 0, 2, 6 }, {}, { { "_FillValue", -999 } } },
    { "mesh2d_flowelem_bl", NC_DOUBLE, { "face" }, { -10, -10 }, { { "standard_name", "altitude" } }, {} },
    { "mesh2d_sa1", NC_DOUBLE, { "time", "face", "layer" }, { 1, 2, 3, 4, 5, 6, 7, 8 }, { { "units", "psu" } },
      { { "_FillValue", -999 } } },
    { "mesh2d_ww1", NC_DOUBLE, { "time", "face", "border" }, { 0, 1, 3, 0, 1, 3, 0, 1, 3, 0, 1, 3 }, {}, {} },
    { "mesh2d_taus", NC_DOUBLE, { "time", "face" }, { 11, 12, 13, 14 }, {}, {} } };
  return c;
}

vtkUnstructuredGrid* grid_of(variable_reader<reader>& r, double time)
{
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(r.read(time));
  check(grid && r.errors->heard.empty(), "the file is read: " + r.errors->heard);
  return grid;
}

double height(vtkUnstructuredGrid* grid, int node, int border, int nodes = 5)
{
  return grid->GetPoint(border * nodes + node)[2];
}

bool hidden(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkDataArray* ghosts = grid->GetCellData()->GetArray("vtkGhostType");
  return ghosts && ghosts->GetComponent(cell, 0) == vtkDataSetAttributes::HIDDENCELL;
}

std::vector<double> values(vtkDataArray* array)
{
  std::vector<double> all;
  for (vtkIdType i = 0; array && i < array->GetNumberOfTuples(); ++i) {
    all.push_back(array->GetComponent(i, 0));
  }
  return all;
}

void check_cells(vtkUnstructuredGrid* grid)
{
  check(grid->GetNumberOfCells() == 4 && grid->GetNumberOfPoints() == 15, "two layers of two faces over five nodes");
  const int types[] = { VTK_HEXAHEDRON, VTK_WEDGE, VTK_HEXAHEDRON, VTK_WEDGE };
  const std::vector<std::vector<vtkIdType>> points = { { 0, 1, 2, 3, 5, 6, 7, 8 }, { 1, 2, 4, 6, 7, 9 }, { 5, 6, 7, 8, 10, 11, 12, 13 },
    { 6, 7, 9, 11, 12, 14 } };
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    const auto i = static_cast<size_t>(cell);
    check(grid->GetCellType(cell) == types[i], "squares are hexahedra, triangles wedges");
    vtkIdList* ids = grid->GetCell(cell)->GetPointIds();
    check(std::vector<vtkIdType>(ids->begin(), ids->end()) == points[i], "corners in the order that VTK wants, the bottom first");
  }
}

void test_delft(const std::string& folder)
{
  const std::string path = write_netcdf(folder + "/delft.nc", delft());
  check(reader::CanReadFile(path.c_str()), "the mesh is seen");
  variable_reader<reader> r(path, nullptr);
  vtkUnstructuredGrid* grid = grid_of(r, 0);
  check_cells(grid);
  check(
    r.reader->GetNumberOfVariables() == 5 && std::string(r.reader->GetNameOfVariable(0)) == "mesh2d_sa1", "variables, layered ones first");
  vtkStringArray* names = r.reader->GetNamesOfVariables();
  check(names->GetNumberOfValues() == 5 && names->GetValue(0) == "mesh2d_sa1", "all names in one array");
  for (int node = 0; node < 5; ++node) {
    check(near(height(grid, node, 0), -10) && near(height(grid, node, 1), -5) && near(height(grid, node, 2), 0), "sigma at rest");
  }
  check(values(grid->GetCellData()->GetArray("mesh2d_sa1")) == std::vector<double>{ 1, 3, 2, 4 }, "values of layers");
  grid = grid_of(r, 600);
  const double surface[] = { 2, 4, 4, 2, 6 }; // nodes 1 and 2 are between both faces
  for (int node = 0; node < 5; ++node) {
    check(near(height(grid, node, 2), surface[node]) && near(height(grid, node, 1), .5 * (surface[node] - 10)), "sigma at high water");
  }
  check(values(grid->GetCellData()->GetArray("mesh2d_sa1")) == std::vector<double>{ 5, 7, 6, 8 }, "values at the second time");
  check(!grid->GetCellData()->GetArray("vtkGhostType"), "nothing is dry");
  r.reader->SetVariableName("mesh2d_ww1");
  check(values(grid_of(r, 0)->GetCellData()->GetArray("mesh2d_ww1")) == std::vector<double>{ .5, .5, 2, 2 }, "borders' values, averaged");
  r.reader->SetVariableName("mesh2d_taus");
  check(values(grid_of(r, 600)->GetCellData()->GetArray("mesh2d_taus")) == std::vector<double>{ 13, 14, 13, 14 }, "values without layers");
}

void test_dry(const std::string& folder)
{
  netcdf_content c = delft();
  c.of("mesh2d_s1").values = { -11, 0, 2, -999 }; // below the bottom; without a value
  variable_reader<reader> r(write_netcdf(folder + "/dry.nc", c), nullptr);
  vtkUnstructuredGrid* grid = grid_of(r, 0);
  check(hidden(grid, 0) && hidden(grid, 2) && !hidden(grid, 1) && !hidden(grid, 3), "a face below the bottom is dry");
  grid = grid_of(r, 600);
  check(!hidden(grid, 0) && hidden(grid, 1) && hidden(grid, 3), "a face without a value is dry");
}

// Levels in place of sigma: at -8, -4 and 0, over a bottom of -10 under the rectangle and -3 under the triangle.
void test_levels(const std::string& folder)
{
  netcdf_content c = delft();
  c.of("mesh2d_layer_sigma") = { "mesh2d_layer_z", NC_DOUBLE, { "layer" }, { -6, -2 }, { { "standard_name", "altitude" } }, {} };
  c.of(
    "mesh2d_interface_sigma") = { "mesh2d_interface_z", NC_DOUBLE, { "border" }, { -8, -4, 0 }, { { "standard_name", "altitude" } }, {} };
  c.of("mesh2d_flowelem_bl").values = { -10, -3 };
  variable_reader<reader> r(write_netcdf(folder + "/levels.nc", c), nullptr);
  vtkUnstructuredGrid* grid = grid_of(r, 0);
  check(near(height(grid, 0, 0), -10) && near(height(grid, 0, 1), -4) && near(height(grid, 0, 2), 0), "levels end at the bottom");
  check(near(height(grid, 4, 0), -3) && near(height(grid, 4, 1), -3) && near(height(grid, 4, 2), 0), "levels are cut off by the bottom");
  check(near(height(grid, 1, 0), -6.5) && !hidden(grid, 0) && !hidden(grid, 1), "a shared node has the mean bottom");
  grid = grid_of(r, 600);
  check(near(height(grid, 0, 2), 2) && near(height(grid, 4, 2), 6), "levels end at the free surface");
}

// FVCOM: node numbers turned and from 1, sigma from the top down and by node, values on nodes at centres of layers.
netcdf_content fvcom()
{
  netcdf_content c;
  c.dimensions = { { "time", 1 }, { "three", 3 }, { "nele", 2 }, { "node", 4 }, { "siglay", 2 }, { "siglev", 3 } };
  c.variables = { { "time", NC_DOUBLE, { "time" }, { 5 }, { { "units", "days since 1858-11-17" } }, {} },
    { "x", NC_DOUBLE, { "node" }, { 0, 1, 1, 0 }, {}, {} }, { "y", NC_DOUBLE, { "node" }, { 0, 0, 1, 1 }, {}, {} },
    { "nv", NC_INT, { "three", "nele" }, { 1, 1, 2, 3, 3, 4 }, {}, {} },
    { "siglev", NC_DOUBLE, { "siglev", "node" }, { 0, 0, 0, 0, -.25, -.25, -.5, -.5, -1, -1, -1, -1 }, {}, {} },
    { "siglay", NC_DOUBLE, { "siglay", "node" }, { -.125, -.125, -.25, -.25, -.625, -.625, -.75, -.75 }, {}, {} },
    { "h", NC_DOUBLE, { "node" }, { 8, 8, 8, 18 }, {}, {} }, { "zeta", NC_DOUBLE, { "time", "node" }, { 0, 0, 0, 2 }, {}, {} },
    { "wet_cells", NC_INT, { "time", "nele" }, { 1, 0 }, {}, {} },
    { "temp", NC_DOUBLE, { "time", "siglay", "node" }, { 20, 21, 22, 23, 10, 11, 12, 13 }, {}, {} },
    { "u", NC_DOUBLE, { "time", "siglay", "nele" }, { 1, 2, 3, 4 }, {}, {} } };
  return c;
}

void test_fvcom(const std::string& folder)
{
  variable_reader<reader> r(write_netcdf(folder + "/fvcom.nc", fvcom()), "temp");
  vtkUnstructuredGrid* grid = grid_of(r, 5);
  check(grid->GetNumberOfCells() == 4 && grid->GetCellType(0) == VTK_WEDGE, "two triangles, two layers");
  check(near(height(grid, 0, 0, 4), -8) && near(height(grid, 0, 1, 4), -2) && near(height(grid, 0, 2, 4), 0), "sigma from the top");
  check(near(height(grid, 3, 0, 4), -18) && near(height(grid, 3, 1, 4), -8) && near(height(grid, 3, 2, 4), 2), "sigma by node");
  const std::vector<double> temp = values(grid->GetPointData()->GetArray("temp"));
  // At node 0 the layers are 6 and 2 thick: at their border .25 of 10 and .75 of 20.
  check(temp.size() == 12 && near(temp[0], 10) && near(temp[4], .25 * 10 + .75 * 20) && near(temp[7], 18) && near(temp[8], 20),
    "centres to borders");
  check(!hidden(grid, 0) && hidden(grid, 1) && !hidden(grid, 2) && hidden(grid, 3), "wet_cells");
  r.reader->SetVariableName("u");
  check(values(grid_of(r, 5)->GetCellData()->GetArray("u")) == std::vector<double>{ 3, 4, 1, 2 }, "layers from the top");
}

// SCHISM: heights of borders at nodes, missing below the lowest layer of a node.
void test_schism(const std::string& folder)
{
  netcdf_content c = fvcom();
  c.variables.erase(c.variables.begin() + 3, c.variables.begin() + 9); // nv to wet_cells
  c.variables.push_back({ "SCHISM_hgrid", NC_INT, {}, { 0 },
    { { "cf_role", "mesh_topology" }, { "node_coordinates", "x y" }, { "face_node_connectivity", "tri" } },
    { { "topology_dimension", 2 } } });
  c.variables.push_back({ "tri", NC_INT, { "nele", "three" }, { 0, 1, 2, 0, 2, 3 }, {}, {} });
  c.variables.push_back(
    { "zcor", NC_FLOAT, { "time", "node", "siglev" }, { -9, -4, 0, -8, -3, 1, -99, -2, 0, -99, -99, -99 }, {}, { { "_FillValue", -99 } } });
  c.variables.push_back({ "salt", NC_DOUBLE, { "time", "node", "siglev" }, { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 }, {}, {} });
  const std::string path = write_netcdf(folder + "/schism.nc", c);
  variable_reader<reader> r(path, "salt");
  vtkUnstructuredGrid* grid = grid_of(r, 5);
  check(near(height(grid, 1, 0, 4), -8) && near(height(grid, 1, 1, 4), -3) && near(height(grid, 1, 2, 4), 1), "heights as given");
  check(near(height(grid, 2, 0, 4), -2) && near(height(grid, 2, 1, 4), -2) && near(height(grid, 2, 2, 4), 0), "below the lowest layer");
  check(values(grid->GetPointData()->GetArray("salt")) == std::vector<double>{ 1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12 }, "values of nodes");
  check(!hidden(grid, 0) && hidden(grid, 1) && hidden(grid, 3), "a face at a node without heights is blanked");
  c.of("zcor").values[1] = -10;
  refuse<reader>(write_netcdf(folder + "/inverted.nc", c), "salt", "'zcor': layers are upside down: -9 is below -10 at node 0");
}

// One layer, faces of five, six and seven corners.
void test_polygons(const std::string& folder)
{
  for (size_t corners = 5; corners <= 7; ++corners) {
    netcdf_content c;
    c.dimensions = { { "node", corners }, { "face", 1 }, { "corner", corners } };
    c.variables = { { "m", NC_INT, {}, { 0 },
                      { { "cf_role", "mesh_topology" }, { "node_coordinates", "x y" }, { "face_node_connectivity", "f" } }, {} },
      { "x", NC_DOUBLE, { "node" }, {}, {}, {} }, { "y", NC_DOUBLE, { "node" }, {}, {}, {} },
      { "f", NC_INT, { "face", "corner" }, {}, {}, {} }, { "zeta", NC_DOUBLE, { "node" }, {}, {}, {} },
      { "h", NC_DOUBLE, { "node" }, {}, {}, {} }, { "q", NC_DOUBLE, { "face" }, { 7 }, {}, {} } };
    for (size_t i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::acos(-1.0) * static_cast<double>(i) / static_cast<double>(corners);
      c.of("x").values.push_back(std::cos(angle));
      c.of("y").values.push_back(std::sin(angle));
      c.of("f").values.push_back(static_cast<double>(i));
      c.of("zeta").values.push_back(1);
      c.of("h").values.push_back(2);
    }
    variable_reader<reader> r(write_netcdf(folder + "/polygon.nc", c), "q");
    vtkUnstructuredGrid* grid = grid_of(r, 0);
    const int types[] = { VTK_PENTAGONAL_PRISM, VTK_HEXAGONAL_PRISM, VTK_POLYHEDRON };
    check(grid->GetNumberOfCells() == 1 && grid->GetCellType(0) == types[corners - 5] &&
        grid->GetNumberOfPoints() == static_cast<vtkIdType>(2 * corners),
      "a prism of many sides");
    check(grid->GetCell(0)->GetNumberOfFaces() == static_cast<int>(corners) + 2, "faces of a prism");
  }
}

void test_bad(const std::string& folder)
{
  const auto with = [&folder](const char* name, netcdf_content c, const std::function<void(netcdf_content&)>& change) {
    change(c);
    return write_netcdf(folder + "/" + name + ".nc", c);
  };
  const std::string bare = with("bare", delft(), [](auto& c) { c.of("mesh2d").texts.erase("cf_role"); });
  refuse<reader>(bare, nullptr, "there is no mesh");
  check(!reader::CanReadFile(bare.c_str()), "a file without a mesh is seen");
  refuse<reader>(
    with("nodes", delft(), [](auto& c) { c.of("mesh2d").texts["node_coordinates"] = "a b"; }), nullptr, "there is no variable 'a'");
  refuse<reader>(with("high", delft(), [](auto& c) { c.of("mesh2d_face_nodes").values[6] = 6; }), nullptr,
    "'mesh2d_face_nodes': face 1 has the node 6, must be 1 to 5");
  refuse<reader>(with("low", delft(), [](auto& c) { c.of("mesh2d_face_nodes").values[0] = 0; }), nullptr,
    "'mesh2d_face_nodes': face 0 has the node 0, must be 1 to 5");
  refuse<reader>(with("two", delft(), [](auto& c) { c.of("mesh2d_face_nodes").values[6] = -1; }), nullptr, "face 1 has 2 nodes");
  refuse<reader>(with("back", delft(),
                   [](auto& c) {
                     c.of("time").values = { 600, 0 };
                   }),
    nullptr, "time 'time' must increase: step 1 is at 0, after 600");
  refuse<reader>(with("fill", delft(), [](auto& c) { c.of("mesh2d_node_x").values[2] = NC_FILL_DOUBLE; }), nullptr,
    "coordinate of nodes 'mesh2d_node_x' has no value (a fill value, or not finite) at number 2");
  refuse<reader>(with("sigma", delft(),
                   [](auto& c) {
                     c.of("mesh2d_interface_sigma").values = { -1, 0, -.5 };
                   }),
    nullptr, "layers are upside down: 'mesh2d_interface_sigma'");
  refuse<reader>(with("zero", delft(),
                   [](auto& c) {
                     c.variables.erase(c.variables.begin() + 6);
                     c.dimensions[4].second = 0; // netCDF's unlimited dimension, of which nothing was written
                     c.of("mesh2d_layer_sigma").values.clear();
                     c.of("mesh2d_sa1").values.clear();
                   }),
    nullptr, "'mesh2d_layer_sigma' has 0 layers, at least 1 are needed");
  refuse<reader>(with("surface", delft(),
                   [](auto& c) {
                     c.of("mesh2d_s1").name = "other";
                     c.of("mesh2d_layer_sigma").texts.erase("formula_terms");
                   }),
    nullptr, "there is no free surface to stand layers on");
  const std::string whole = write_netcdf(folder + "/whole.nc", delft());
  refuse<reader>(whole, "salt", "there is no variable 'salt' on the grid; those that are: mesh2d_sa1 (psu), ");
  for (double part : { .001, .5, .9 }) {
    refuse<reader>(cut(whole, folder + "/cut.nc", part), nullptr, "cut.nc");
  }
}
} // namespace

int main(int, char* argv[])
{
  const std::string folder = std::string(argv[1]) + "/ugrid"; // the test of CF's reader has files of the same names
  std::filesystem::create_directories(folder);
  test_delft(folder);
  test_dry(folder);
  test_levels(folder);
  test_fvcom(folder);
  test_schism(folder);
  test_polygons(folder);
  test_bad(folder);
  return failures ? 1 : 0;
}
