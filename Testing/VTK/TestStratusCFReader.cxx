// SPDX-License-Identifier: BSD-3-Clause
// CF's grids: coordinates become the grid type that they describe, values lose packing and fills, and wrong files are refused.
#include "netcdf_testing.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkStratusCFReader.h"
#include "vtkStructuredGrid.h"

#include <functional>

namespace {

constexpr int nx = 3, ny = 2, nz = 4, nt = 2;

double value(int t, int k, int j, int i)
{
  return 1000 * t + 100 * k + 10 * j + i;
}

// A packed variable on stretched levels, of which y decreases, at two times; value 0, 1, 2 at the second time is missing.
netcdf_content cloud()
{
  netcdf_content c;
  c.dimensions = { { "time", nt }, { "z", nz }, { "y", ny }, { "x", nx } };
  c.variables = { { "time", NC_DOUBLE, { "time" }, { 0, 6 }, { { "units", "hours since 2001-01-01" } }, {} },
    { "z", NC_FLOAT, { "z" }, { 0, 1, 3, 7 }, { { "units", "km" }, { "axis", "Z" } }, {} },
    { "y", NC_DOUBLE, { "y" }, { 500, 0 }, { { "units", "m" } }, {} },
    { "x", NC_DOUBLE, { "x" }, { 0, 250, 500 }, { { "units", "m" } }, {} },
    { "qc", NC_SHORT, { "time", "z", "y", "x" }, {}, { { "units", "g/kg" }, { "long_name", "cloud water" } },
      { { "scale_factor", .5 }, { "add_offset", 3 }, { "_FillValue", -9 } } } };
  for (int t = 0; t < nt; ++t) {
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
          c.of("qc").values.push_back(t == 1 && k == 0 && j == 1 && i == 2 ? -9 : value(t, k, j, i));
        }
      }
    }
  }
  return c;
}

// The value of the first array at a point of the grid.
double at(vtkDataSet* data, int i, int j, int k)
{
  return data->GetPointData()->GetArray(0)->GetComponent(i + nx * (j + ny * k), 0);
}

void check_values(vtkDataSet* data, int t, bool turned, const std::string& what)
{
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const int from = turned ? ny - 1 - j : j;
        const bool missing = t == 1 && k == 0 && from == 1 && i == 2;
        const double got = at(data, i, j, k);
        check(missing ? std::isnan(got) : near(got, 3 + .5 * value(t, k, from, i)), what + ": a value is wrong");
      }
    }
  }
}

void test_stretched(const std::string& folder)
{
  variable_reader<vtkStratusCFReader> r(write_netcdf(folder + "/stretched.nc", cloud()), nullptr);
  for (int t = 0; t < nt; ++t) {
    vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(r.read(6.0 * t));
    check(grid && grid->GetNumberOfPoints() == nx * ny * nz && r.errors->heard.empty(),
      "stretched levels are a rectilinear grid: " + r.errors->heard);
    if (grid) {
      check(grid->GetZCoordinates()->GetComponent(3, 0) == 7000 && grid->GetYCoordinates()->GetComponent(0, 0) == 0 &&
          grid->GetYCoordinates()->GetComponent(1, 0) == 500,
        "levels are metres, and ascend");
      check_values(grid, t, true, "stretched");
    }
  }
  check(r.reader->GetNumberOfVariables() == 1 && std::string(r.reader->GetNameOfVariable(0)) == "qc" &&
      std::string(r.reader->GetUnitsOfVariable(0)) == "g/kg" && std::string(r.reader->GetLongNameOfVariable(0)) == "cloud water" &&
      std::string(r.reader->GetNameOfVariable(1)).empty() && std::string(r.reader->GetTimeUnits()) == "hours since 2001-01-01",
    "names, units and long names of variables");
}

void test_uniform(const std::string& folder)
{
  netcdf_content c = cloud();
  c.of("z").values = { 1, 2, 3, 4 };
  variable_reader<vtkStratusCFReader> r(write_netcdf(folder + "/uniform.nc", c), "qc");
  vtkImageData* image = vtkImageData::SafeDownCast(r.read(6.0));
  check(image, "even levels are an image");
  if (image) {
    check(
      near(image->GetSpacing()[2], 1000) && near(image->GetOrigin()[2], 1000) && near(image->GetSpacing()[1], 500), "spacing and origin");
    check_values(image, 1, true, "uniform");
  }
}

// Dimensions in another order: the coordinates' attributes name the axes. A depth becomes a negative height.
void test_order(const std::string& folder)
{
  netcdf_content c;
  c.dimensions = { { "a", nx }, { "b", nz }, { "c", ny } };
  c.variables = { { "a", NC_DOUBLE, { "a" }, { 0, 1, 4 }, { { "axis", "X" } }, {} },
    { "b", NC_DOUBLE, { "b" }, { 0, 10, 30, 70 }, { { "positive", "down" }, { "units", "m" } }, {} },
    { "c", NC_DOUBLE, { "c" }, { 5, 6 }, { { "axis", "Y" } }, {} }, { "v", NC_DOUBLE, { "a", "b", "c" }, {}, {}, {} } };
  for (int i = 0; i < nx; ++i) {
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        c.of("v").values.push_back(value(0, k, j, i));
      }
    }
  }
  variable_reader<vtkStratusCFReader> r(write_netcdf(folder + "/order.nc", c), "v");
  vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(r.read());
  check(grid && grid->GetZCoordinates()->GetComponent(0, 0) == -70, "depth goes down: " + r.errors->heard);
  for (int k = 0; grid && k < nz; ++k) {
    check(at(grid, 2, 1, k) == value(0, nz - 1 - k, 1, 2), "dimensions in another order");
  }
}

netcdf_content sigma()
{
  netcdf_content c = cloud();
  c.of("z") = { "z", NC_DOUBLE, { "z" }, { -1, -.75, -.5, 0 },
    { { "standard_name", "ocean_sigma_coordinate" }, { "formula_terms", "sigma: z eta: zeta depth: h" } }, {} };
  c.variables.push_back({ "zeta", NC_DOUBLE, { "time", "y", "x" }, { 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2 }, {}, {} });
  c.variables.push_back({ "h", NC_DOUBLE, { "y", "x" }, { 10, 20, 30, 10, 20, 30 }, {}, {} });
  return c;
}

void test_sigma(const std::string& folder)
{
  variable_reader<vtkStratusCFReader> r(write_netcdf(folder + "/sigma.nc", sigma()), "qc");
  for (int t = 0; t < nt; ++t) {
    vtkStructuredGrid* grid = vtkStructuredGrid::SafeDownCast(r.read(6.0 * t));
    check(grid, "levels that follow the bottom are a curvilinear grid: " + r.errors->heard);
    for (int k = 0; grid && k < nz; ++k) {
      const double s[] = { -1, -.75, -.5, 0 };
      double p[3];
      grid->GetPoint(2 + nx * (1 + ny * k), p); // depth 30; free surface at 0, then at 2
      check(near(p[0], 500) && near(p[1], 0) && near(p[2], 2 * t + s[k] * (30 + 2 * t)), "a height by the formula");
    }
    if (grid) {
      check_values(grid, t, false, "sigma");
    }
  }
}

void test_turned(const std::string& folder)
{
  netcdf_content c = cloud();
  c.of("x").name = "other_x";
  c.of("y").name = "other_y";
  c.of("other_x").dimensions = { "time" };
  c.of("other_x").values = { 0, 0 };
  c.of("other_y").dimensions = { "time" };
  c.of("other_y").values = { 0, 0 };
  c.variables.push_back({ "lon", NC_DOUBLE, { "y", "x" }, { 0, 1, 2, .5, 1.5, 2.5 }, { { "units", "degrees_east" } }, {} });
  c.variables.push_back({ "lat", NC_DOUBLE, { "y", "x" }, { 50, 50.5, 51, 51, 51.5, 52 }, { { "units", "degrees_north" } }, {} });
  c.of("qc").texts["coordinates"] = "lat lon";
  variable_reader<vtkStratusCFReader> r(write_netcdf(folder + "/turned.nc", c), "qc");
  vtkStructuredGrid* grid = vtkStructuredGrid::SafeDownCast(r.read());
  check(grid, "two-dimensional latitudes are a curvilinear grid: " + r.errors->heard);
  if (grid) {
    double p[3];
    const double degree = std::acos(-1.0) / 180.0;
    grid->GetPoint(1 + nx * (1 + ny * 2), p);
    check(near(p[0], 6371000 * degree * 1.5 * std::cos(51 * degree)) && near(p[1], 6371000 * degree * 51.5) && near(p[2], 3000),
      "degrees become metres");
  }
}

void test_bad(const std::string& folder)
{
  const auto with = [&folder](const char* name, netcdf_content c, const std::function<void(netcdf_content&)>& change) {
    change(c);
    return write_netcdf(folder + "/" + name + ".nc", c);
  };
  using reader = vtkStratusCFReader;
  refuse<reader>(with("back", cloud(),
                   [](auto& c) {
                     c.of("z").values = { 0, 2, 1, 3 };
                   }),
    "qc", "coordinate 'z' must increase or decrease all along: number 2 is 1, after 2");
  refuse<reader>(with("twice", cloud(), [](auto& c) { c.of("x").values = { 0, 0, 1 }; }), "qc", "number 1 is 0, after 0");
  refuse<reader>(with("nan", cloud(), [](auto& c) { c.of("y").values = { 0, NAN }; }), "qc", "coordinate 'y' has no value");
  refuse<reader>(with("fill", cloud(),
                   [](auto& c) {
                     c.of("x").numbers["_FillValue"] = -1;
                     c.of("x").values = { 0, -1, 2 };
                   }),
    "qc", "coordinate 'x' has no value (a fill value, or not finite) at number 1");
  refuse<reader>(with("time", cloud(),
                   [](auto& c) {
                     c.of("time").values = { 6, 5 };
                   }),
    "qc", "time 'time' must increase: step 1 is at 5, after 6");
  refuse<reader>(with("height", sigma(), [](auto& c) { c.of("h").values[3] = INFINITY; }), "qc", "term of the height 'h' has no value");
  refuse<reader>(with("terms", sigma(), [](auto& c) { c.of("z").texts["formula_terms"] = "sigma: z eta: zeta depth: hh"; }), "qc",
    "name 'hh' for 'depth', which is not there");
  refuse<reader>(
    with("flat", cloud(),
      [](auto& c) {
        c.of("qc").dimensions = { "z", "y", "x" }, c.dimensions[2].second = 1, c.of("y").values = { 0 }, c.of("qc").values.clear();
      }),
    nullptr, "no variable on a grid of three dimensions");
  const std::string whole = write_netcdf(folder + "/whole.nc", cloud());
  refuse<reader>(whole, "qx", "there is no variable 'qx' on the grid; those that are: qc (g/kg)");
  for (double part : { 0.0, .001, .3, .7 }) {
    refuse<reader>(cut(whole, folder + "/cut.nc", part), "qc", "cut.nc");
  }
  for (int format : { 0, NC_64BIT_OFFSET }) { // of which libnetcdf itself reads zeros behind the end
    const std::string classic = write_netcdf(folder + "/classic.nc", cloud(), format);
    variable_reader<reader> r(classic, "qc");
    vtkDataSet* data = r.read(6.0);
    check(data && r.errors->heard.empty(), "a classic file: " + r.errors->heard);
    if (data && data->GetNumberOfPoints() > 0) {
      check_values(data, 1, true, "classic");
    }
    refuse<reader>(cut(classic, folder + "/cut.nc", .995), "qc", "the file is cut short");
    refuse<reader>(cut(classic, folder + "/cut.nc", .4), "qc", "cut.nc");
  }
  refuse<reader>(folder + "/nowhere.nc", "qc", "no netCDF file that can be read: No such file");
  variable_reader<reader> r("", nullptr);
  r.read();
  check(r.errors->heard.find("FileName is not set") != std::string::npos, "no name");
  // a reader that failed reads the next file
  r.reader->SetFileName(whole.c_str());
  check(r.read() && r.reader->GetOutput()->GetNumberOfPoints() == nx * ny * nz && r.errors->heard.empty(), "a reader reads after an error");
}
} // namespace

int main(int, char* argv[])
{
  const std::string folder = argv[1];
  test_stretched(folder);
  test_uniform(folder);
  test_order(folder);
  test_sigma(folder);
  test_turned(folder);
  test_bad(folder);
  return failures ? 1 : 0;
}
