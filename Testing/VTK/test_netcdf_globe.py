# SPDX-License-Identifier: BSD-3-Clause
"""Longitudes and latitudes on a sphere: places judged by NumPy, and that lattices close it without gap or overlap by the volume of their
cells: the sum of all tetrahedra is that of the shell."""
import numpy

from vtk import vtkStreamingDemandDrivenPipeline
from vtk.util.numpy_support import vtk_to_numpy

from netcdf_reading import Read, check, finish, near, write

radius = 6371000.0
heights = numpy.array([0.0, 4000.0, 10000.0])


def place(longitude, latitude, height):
    a, b, r = numpy.radians(longitude), numpy.radians(latitude), radius + height
    return numpy.stack([r * numpy.cos(b) * numpy.cos(a), r * numpy.cos(b) * numpy.sin(a), r * numpy.sin(b)], axis=-1)


def on_sphere(path, factor=0.0, cls="vtkStratusCFReader"):
    def prepare(reader):
        reader.SetCoordinatesToSphere()
        reader.SetHeightFactor(factor)

    return Read(path, cls=cls, prepare=prepare)


def axes(name, longitudes, latitudes, values=None, levels=heights, up="up"):
    nz, ny, nx = len(levels), len(latitudes), len(longitudes)
    field = numpy.arange(nz * ny * nx, dtype="f4").reshape(nz, ny, nx) if values is None else values
    return write("globe " + name, {"z": nz, "lat": ny, "lon": nx}, z=("z", levels, {"units": "m", "positive": up}),
        lat=("lat", latitudes, {"units": "degrees_north"}), lon=("lon", longitudes, {"units": "degrees_east"}),
        q=("z lat lon", field, {"fill": numpy.float32(1e20)})), field


tetrahedra = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]


def volume(got, hidden=None):
    p = got.points
    corners = [p[k:p.shape[0] - 1 + k, j:p.shape[1] - 1 + j, i:p.shape[2] - 1 + i] for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    sizes = 0
    for t in tetrahedra:
        a, b, c, d = (corners[n] for n in t)
        sizes = sizes + numpy.einsum("...i,...i", numpy.cross(b - a, c - a), d - a) / 6
    check((sizes >= -1e-9 * abs(sizes).max()).all() or (sizes <= 1e-9 * abs(sizes).max()).all(), "all cells have the same orientation")
    return abs(sizes.sum())


def check_shell(got, name, low, high, within, part=1.0):
    shell = part * 4 / 3 * numpy.pi * ((radius + high) ** 3 - (radius + low) ** 3)
    check(abs(volume(got) / shell - 1) < within, f"{name}: cells fill {volume(got) / shell:.5f} of the shell")


# middles of cells of 3 degrees: the last column is next to the first, and rows are half a cell from the poles
east, north = 1.5 + 3.0 * numpy.arange(120), -88.5 + 3.0 * numpy.arange(60)
path, field = axes("middles", east, north)
got = on_sphere(path, 50)
check(not got.error, got.error)
check(got.shape == (3, 62, 121), f"one more column, and a row at each pole: {got.shape}")
check(near(got.points[:, 1:-1, :-1], place(*numpy.meshgrid(east, north, 50 * heights, indexing="ij")).transpose(2, 1, 0, 3), 1e-9), "places")
check((got.points[:, :, -1] == got.points[:, :, 0]).all() and (got.values[:, :, -1] == got.values[:, :, 0]).all(), "the last column is the first")
check(near(got.points[:, 0], place(0, -90, 50 * heights)[:, None], 1e-9) and near(got.points[:, -1], place(0, 90, 50 * heights)[:, None], 1e-9),
      "points at the poles")
check(near(got.values[:, 0], field[:, 0].mean(axis=-1)[:, None], 1e-6) and near(got.values[:, -1], field[:, -1].mean(axis=-1)[:, None], 1e-6),
      "poles have the mean of their rows")
check((got.values[:, 1:-1, :-1] == field).all(), "values")
check_shell(got, "middles", 0, 50 * 10000, 2e-3)
check("closed from the last column" in got.description and "both poles" in got.description, got.description)
extent = got.reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
check(tuple(extent) == got.data.GetExtent(), f"the extent is known before: {extent}")
check([got.reader.GetNameOfAxis(a) for a in range(3)] == ["x", "y", "z"] and got.reader.GetLengthUnits() == "m", "axes on the sphere")

got = on_sphere(path)
check(near(numpy.linalg.norm(got.points[-1], axis=-1), 1.1 * radius, 1e-9), "automatic heights reach over a tenth of the radius")
check(near(got.reader.GetUsedHeightFactor(), 0.1 * radius / 10000, 1e-9), f"the factor: {got.reader.GetUsedHeightFactor()}")

north_down = north[::-1]
got = on_sphere(axes("down", (east + 180) % 360 - 180, north_down)[0], 50)
check(got.shape == (3, 62, 121), f"latitudes that decrease, and a jump of longitudes: {got.shape}")
check_shell(got, "down", 0, 50 * 10000, 2e-3)

holes = field.copy()
holes[0, 0, :50] = 1e20
holes[1, 0] = 1e20
got = on_sphere(axes("missing", east, north, holes)[0], 50)
check(near(got.values[0, 0], field[0, 0, 50:].mean(), 1e-6) and numpy.isnan(got.values[1, 0]).all(), "a pole has the mean of what is there")

for name, longitudes, latitudes, shape in (
    ("poles that the file has", numpy.arange(0, 360, 4.0), numpy.linspace(-90, 90, 46), (3, 46, 91)),
    ("a column that is there twice", numpy.arange(0, 361, 4.0), numpy.linspace(-90, 90, 46), (3, 46, 91)),
    ("two columns that are there twice", numpy.arange(0, 365, 4.0), numpy.linspace(-90, 90, 46), (3, 46, 91))):
    got = on_sphere(axes(name, longitudes, latitudes)[0], 50)
    check(not got.error and got.shape == shape, f"{name}: {got.error or got.shape}")
    if not got.error:
        check_shell(got, name, 0, 50 * 10000, 4e-3)

region = on_sphere(axes("region", numpy.linspace(170, 200, 61), numpy.linspace(10, 50, 81))[0], 1)
check(region.shape == (3, 81, 61), f"a region stays as it is: {region.shape}")
part = 30 / 360 * (numpy.sin(numpy.radians(50)) - numpy.sin(numpy.radians(10))) / 2
check_shell(region, "region", 0, 10000, 1e-3, part)

for name, longitudes, latitudes in (("two columns", numpy.array([10.0, 12.0]), numpy.linspace(10, 50, 5)),
                                    ("two rows", numpy.linspace(10, 50, 5), numpy.array([10.0, 12.0]))):
    small = on_sphere(axes(name, longitudes, latitudes)[0], 1)
    check(small.shape == (3, len(latitudes), len(longitudes)), f"{name}: {small.error or small.shape}")
ring = on_sphere(axes("three columns all around", numpy.array([0.0, 120.0, 240.0]), numpy.array([-30.0, 0.0, 30.0]))[0], 1)
check(ring.shape == (3, 3, 4), f"three columns go round: {ring.error or ring.shape}")

# depths are below the radius
sea = on_sphere(axes("sea", east, north, levels=numpy.array([0.0, 2000, 5000]), up="down")[0], 100)
check(near(numpy.linalg.norm(sea.points[0], axis=-1), radius - 100 * 5000, 1e-9), "depths are below")
deep = on_sphere(axes("deep", east, north, levels=numpy.array([0.0, 2000, 5000]), up="down")[0], 2000)
check("must be less than 1274.2" in deep.error, deep.error)

# a lattice with two poles in the north: the last row repeats the last but two in reverse, and two columns repeat the first ones
columns = 72
fold = numpy.linspace(1, 0, 13)  # from a circle to the line between the poles
w0 = numpy.exp(1j * numpy.radians(5.0 * numpy.arange(columns)))
cap = []
for s in fold:  # confocal ellipses shrink to the line between both poles
    cap.append((w0 + numpy.conj(w0)) / 2 + s * (w0 - numpy.conj(w0)) / 2)
cap = numpy.array(cap) * numpy.tan(numpy.radians(35.0))  # stereographic, from latitude 20 on
lon_cap, lat_cap = numpy.degrees(numpy.angle(cap)) % 360, 90 - 2 * numpy.degrees(numpy.arctan(abs(cap)))
south = numpy.arange(-90, 20, 5.0)
lons = numpy.concatenate([numpy.tile(5.0 * numpy.arange(columns), (len(south), 1)), lon_cap])
lats = numpy.concatenate([numpy.tile(south[:, None], (1, columns)), lat_cap])
mirror = (-numpy.arange(columns)) % columns
check(abs(cap[-1] - cap[-1][mirror]).max() < 1e-12, "the last row is a line that is passed twice")
lons, lats = (numpy.concatenate([a, a[-2:-1, mirror]]) for a in (lons, lats))  # the row beyond the line
lons, lats = (numpy.concatenate([a, a[:, :2]], axis=1) for a in (lons, lats))
n, m = lons.shape
values = numpy.arange(3 * n * m, dtype="f4").reshape(3, n, m)
path = write("globe tripolar", {"y": n, "x": m, "z": 3}, z=("z", heights, {"units": "m", "positive": "up"}),
    lon=("y x", lons, {"units": "degrees_east"}), lat=("y x", lats, {"units": "degrees_north"}),
    q=("z y x", values, {"coordinates": "lon lat"}))
got = on_sphere(path, 50)
check(not got.error and got.shape == (3, n - 1, m - 1), f"a column and a row that repeat others are left out: {got.error or got.shape}")
check("without 1 columns" in got.description and "last row" in got.description, got.description)
if not got.error:
    check(near(got.points, place(lons[:-1, :-1], lats[:-1, :-1], 50 * heights[:, None, None]), 1e-9), "places of a curved lattice")
    check(not got.hidden_cells().any(), "no cell is torn on a sphere")
    check_shell(got, "tripolar", 0, 50 * 10000, 2e-2)

# F-point pivots: the line between the poles is between rows, and the last row is the one before it in reverse
fold = (1 - (numpy.arange(46) + 0.5) / 45)[:, None]
w = numpy.radians(2.0 * numpy.arange(180) + 1)
cap = numpy.tan(numpy.radians(35.0)) * (numpy.cos(w) + 1j * numpy.sin(fold * numpy.pi / 2) * numpy.sin(w))
south = numpy.arange(-89, 20, 2.0)
lons = numpy.concatenate([numpy.tile(2.0 * numpy.arange(180) + 1, (len(south), 1)), numpy.degrees(numpy.angle(cap)) % 360])
lats = numpy.concatenate([numpy.tile(south[:, None], (1, 180)), 90 - 2 * numpy.degrees(numpy.arctan(abs(cap)))])
for rows in (len(lons), len(lons) - 1):  # files have that row or not
    field = numpy.arange(3 * rows * 180, dtype="f4").reshape(3, rows, 180)
    path = write("globe F-point pivot %d" % rows, {"y": rows, "x": 180, "z": 3}, z=("z", heights, {"units": "m", "positive": "up"}),
        lon=("y x", lons[:rows], {"units": "degrees_east"}), lat=("y x", lats[:rows], {"units": "degrees_north"}),
        q=("z y x", field, {"coordinates": "lon lat"}))
    got = on_sphere(path, 50)
    check(not got.error and got.shape == (3, 102, 181), f"a pole, 100 rows and the seam: {got.error or got.shape}")
    check("closed at the seam between two poles" in got.description, got.description)
    check_shell(got, "F-point pivot", 0, 50 * 10000, 2e-3)
    check(near(got.values[:, -1, :-1], 0.5 * (field[:, 99] + field[:, 99, ::-1]), 1e-6), "the seam has the mean of both sides")

flat = write("globe flat", {"z": 3, "y": 4, "x": 5}, z=("z", heights, {"units": "m"}), y=("y", numpy.arange(4.0), {"units": "m"}),
    x=("x", numpy.arange(5.0), {"units": "m"}), q=("z y x", numpy.zeros((3, 4, 5), "f4"), {}))
check("has no longitudes and latitudes of the Earth" in on_sphere(flat).error, "metres have no place on a sphere")

# A mesh of triangles all around, an octahedron: its eight prisms are at the corners of the sphere, and none is torn at a pole.
nodes = numpy.array([[0, 0], [90, 0], [180, 0], [270, 0], [0, 90], [0, -90]], float)
faces = numpy.array([[a, (a + 1) % 4, 4] for a in range(4)] + [[(a + 1) % 4, a, 5] for a in range(4)], "i4")
path = write("globe mesh", {"node": 6, "face": 8, "corner": 3, "layer": 2, "edge": 3},
    mesh=("", numpy.int32(0), {"cf_role": "mesh_topology", "topology_dimension": numpy.int32(2), "node_coordinates": "lon lat",
                               "face_node_connectivity": "faces"}),
    lon=("node", nodes[:, 0], {"units": "degrees_east", "standard_name": "longitude"}),
    lat=("node", nodes[:, 1], {"units": "degrees_north", "standard_name": "latitude"}),
    faces=("face corner", faces, {"start_index": numpy.int32(0)}),
    layer=("layer", numpy.array([-3000.0, -1000.0]), {"units": "m", "positive": "up", "axis": "Z"}),
    q=("layer face", numpy.arange(16, dtype="f4").reshape(2, 8), {"mesh": "mesh", "location": "face"}))
got = on_sphere(path, 100, "vtkStratusUgridReader")
check(not got.error, got.error)
if not got.error:
    points = vtk_to_numpy(got.data.GetPoints().GetData())
    lengths = numpy.linalg.norm(points, axis=1)
    check(lengths.min() > radius - 100 * 4500 and lengths.max() <= radius * (1 + 1e-9), f"radii of a mesh: {lengths.min()}, {lengths.max()}")
    unit = numpy.round(points / lengths[:, None], 9)
    check({tuple(one) for one in unit} == {tuple(numpy.round(one, 9)) for one in place(nodes[:, 0], nodes[:, 1], 0) / radius}, "corners")
    ghosts = got.data.GetCellData().GetArray("vtkGhostType")
    check(got.data.GetNumberOfCells() == 16 and (not ghosts or not vtk_to_numpy(ghosts).any()), "no face around a pole is torn")
finish()
