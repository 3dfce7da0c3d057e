# SPDX-License-Identifier: BSD-3-Clause
"""Heights that readers multiply on demand: the factor of flat data of the Earth, the same at all steps, on images, rectilinear and curved grids and
meshes; and data that keep their heights."""
import numpy
from vtk.util.numpy_support import vtk_to_numpy

from netcdf_reading import Read, check, degree, finish, near, write

UP = {"units": "m", "positive": "up"}


def on(factor=0.0):
    def prepare(reader):
        reader.ExaggerateHeightsOn()
        reader.SetHeightFactor(factor)

    return prepare


def grid(name, heights, wide=100e3, units="m", surface=None):
    x, y = numpy.linspace(0, wide, 6), numpy.linspace(0, 0.6 * wide, 5)
    if units != "m":
        x, y = x / degree - 20, y / degree + 50
    east, north = ({"units": "degrees_east"}, {"units": "degrees_north"}) if units != "m" else ({"units": "m"}, {"units": "m"})
    n = len(heights)
    return write("exaggerated " + name, {"time": 2, "z": n, "y": 5, "x": 6}, time=("time", numpy.array([0.0, 1.0]), {"units": "hours since 2020-01-01"}),
        z=("z", numpy.asarray(heights, float), UP), y=("y", y, north), x=("x", x, east), q=("time z y x", numpy.arange(60.0 * n).reshape(2, n, 5, 6), {}))


def bounds(got):
    return numpy.array(got.data.GetBounds())


for name, heights in (("image", [0, 500, 1000]), ("rectilinear", [-900, -100, 0])):
    for units in ("m", "degrees"):
        path = grid(f"{name} {units}", heights, units=units)
        plain, high, by_hand = Read(path), Read(path, prepare=on()), Read(path, prepare=on(7))
        factor = high.reader.GetUsedHeightFactor()
        box = bounds(plain)
        width = max(box[1] - box[0], box[3] - box[2])
        check(plain.reader.GetUsedHeightFactor() == 0 and near(box[4:], [min(heights), max(heights)]), f"{name}: heights are true by default")
        check(abs(factor * (box[5] - box[4]) / width - 0.2) < 0.01, f"{name}: a fifth as high as wide, by {factor}")
        check(near(bounds(high), box * [1, 1, 1, 1, factor, factor]), f"{name}: only heights change: {bounds(high)}")
        check(near(bounds(by_hand), box * [1, 1, 1, 1, 7, 7]) and by_hand.reader.GetUsedHeightFactor() == 7, f"{name}: by a factor of one's own")
        check(high.data.GetClassName() == plain.data.GetClassName() and near(high.values, plain.values), f"{name}: the grid and its values")
        fields = high.data.GetFieldData()
        check(fields.GetArray("HeightFactor").GetValue(0) == factor, f"{name}: the output says by how much")
        check(not plain.data.GetFieldData().GetArray("HeightFactor"), "true heights have no factor")
        # ParaView's axes: coordinates are the matrix times the file's own numbers.
        for got, times in (plain, 1), (high, factor):
            own = got.data.GetFieldData()
            matrix = vtk_to_numpy(own.GetArray("ChangeOfBasisMatrix")).reshape(4, 4)
            numbers = vtk_to_numpy(own.GetArray("BoundingBoxInModelCoordinates")).reshape(3, 2)
            check(near(numpy.repeat(numpy.diag(matrix)[:3], 2) * numbers.ravel(), bounds(got)), f"{name} in {units}: {matrix} makes places of {numbers}")
            check(near(matrix, numpy.diag(numpy.diag(matrix))) and matrix[2, 2] == times, f"{name} in {units}: heights are multiplied by {matrix[2, 2]}")
            first = [0, 0] if units == "m" else [-20, 50]
            check(near(numbers[:2, 0], first) and near(numbers[2], [min(heights), max(heights)]), f"{name} in {units}: the file's numbers are {numbers}")
            titles = [own.GetAbstractArray(f"AxisTitleFor{axis}").GetComponentName(0) for axis in "XYZ"]
            check(titles == (["x (m)", "y (m)", "height (m)"] if units == "m" else ["longitude (\u00b0)", "latitude (\u00b0)", "height (m)"]), f"titles {titles}")
        high.reader.ExaggerateHeightsOff()
        high.reader.Update()
        check(near(bounds(high), box) and not high.data.GetFieldData().GetArray("HeightFactor"), f"{name}: off again")

# What is not flat, or not the Earth's, stays
for name, path in (("high", grid("high", [0, 20e3, 50e3])), ("numbers", write("exaggerated numbers", {"z": 3, "y": 4, "x": 50},
        q=("z y x", numpy.zeros((3, 4, 50)), {})))):
    got, plain = Read(path, prepare=on()), Read(path)
    check(near(bounds(got), bounds(plain)) and got.reader.GetUsedHeightFactor() in (0, 1), f"{name} stays as it is: {bounds(got)}")

# A surface that rises: each step has its own heights, times the factor of the first step
depth = numpy.full((5, 6), 40.0)
eta = numpy.stack([numpy.zeros((5, 6)), numpy.full((5, 6), 8.0)])
path = write("exaggerated sigma", {"time": 2, "s": 4, "y": 5, "x": 6}, time=("time", numpy.array([0.0, 1.0]), {"units": "hours since 2020-01-01"}),
    s=("s", numpy.array([-0.875, -0.625, -0.375, -0.125]), {"standard_name": "ocean_sigma_coordinate", "positive": "up",
       "formula_terms": "sigma: s eta: eta depth: depth"}), depth=("y x", depth, {"units": "m"}), eta=("time y x", eta, {"units": "m"}),
    y=("y", numpy.linspace(0, 30e3, 5), {"units": "m"}), x=("x", numpy.linspace(0, 40e3, 6), {"units": "m"}), q=("time s y x", numpy.zeros((2, 4, 5, 6)), {}))
plain, high = Read(path, time=0), Read(path, time=0, prepare=on())
factor = high.reader.GetUsedHeightFactor()
check(factor > 100 and near(high.points, plain.points * [1, 1, factor]), f"a curved grid by {factor}: {high.error}")
for reader in (plain.reader, high.reader):
    reader.UpdateTimeStep(3600 if reader.GetTimeUnits().startswith("sec") else 1)
points = [vtk_to_numpy(one.reader.GetOutput().GetPoints().GetData()) for one in (plain, high)]
check(near(points[1], points[0] * [1, 1, factor]) and not near(points[0], plain.points.reshape(-1, 3)), "the next step by the same factor")
check(high.reader.GetUsedHeightFactor() == factor, "the factor stays")

# A curved grid that does not move: all steps share its points
lon, lat = numpy.meshgrid(numpy.linspace(0, 3, 6), numpy.linspace(40, 42, 5))
path = write("exaggerated curved", {"time": 2, "z": 3, "y": 5, "x": 6}, time=("time", numpy.array([0.0, 1.0]), {"units": "hours since 2020-01-01"}),
    z=("z", numpy.array([0.0, 300, 900]), UP), lon=("y x", lon + 0.1 * lat, {"units": "degrees_east"}), lat=("y x", lat, {"units": "degrees_north"}),
    q=("time z y x", numpy.arange(180.0).reshape(2, 3, 5, 6), {"coordinates": "lon lat"}))
plain, high = Read(path, time=0), Read(path, time=0, prepare=on())
factor = high.reader.GetUsedHeightFactor()
check(factor > 10 and near(high.points, plain.points * [1, 1, factor]), f"two-dimensional coordinates by {factor}")
before = high.reader.GetOutput().GetPoints()
high.reader.UpdateTimeStep(1)
check(high.reader.GetOutput().GetPoints() is before and near(vtk_to_numpy(before.GetData()), plain.points.reshape(-1, 3) * [1, 1, factor]), "once for all steps")

# A mesh
path = write("exaggerated mesh", {"node": 4, "face": 2, "corner": 3, "layer": 4},
    mesh=("", numpy.int32(0), {"cf_role": "mesh_topology", "topology_dimension": numpy.int32(2), "node_coordinates": "x y", "face_node_connectivity": "faces"}),
    x=("node", numpy.array([0.0, 9000, 0, 9000]), {"units": "m"}), y=("node", numpy.array([0.0, 0, 8000, 8000]), {"units": "m"}),
    faces=("face corner", numpy.array([[0, 1, 2], [1, 3, 2]], "i4"), {}), layer=("layer", numpy.array([5.0, 15, 25, 35]), dict(UP, axis="Z")),
    q=("layer face", numpy.zeros((4, 2)), {}))
plain, high = Read(path, cls="vtkStratusUgridReader"), Read(path, cls="vtkStratusUgridReader", prepare=on())
factor = high.reader.GetUsedHeightFactor()
check(factor == 45 and near(bounds(high), bounds(plain) * [1, 1, 1, 1, 45, 45]), f"a mesh by {factor}")
finish()
