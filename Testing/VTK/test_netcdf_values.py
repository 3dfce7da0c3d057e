# SPDX-License-Identifier: BSD-3-Clause
"""Stored values of netCDF become numbers: signs, missing values, valid ranges, scale and offset, judged by netCDF4's own masks and scaling."""
import os
import sys
import warnings

import netCDF4
import numpy
from vtk.util.numpy_support import vtk_to_numpy

import stratus

failures = 0
folder = sys.argv[1] if len(sys.argv) > 1 else "."
warnings.simplefilter("ignore")  # netCDF4 warns of the attributes that it does not use
shape = 4, 5, 6


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def write(name, kind, stored, fill=None, kinds="NETCDF4", **attributes):
    """A variable 'q' of these stored values, repeated over the grid."""
    path = os.path.join(folder, "values %s.nc" % name)
    with netCDF4.Dataset(path, "w", format=kinds) as file:
        for dimension, size in zip("zyx", shape):
            file.createDimension(dimension, size)
        variable = file.createVariable("q", kind, tuple("zyx"), fill_value=fill)
        variable.set_auto_maskandscale(False)
        variable.setncatts(attributes)
        variable[:] = numpy.resize(numpy.asarray(stored).astype(kind), shape)
    return path


def read(path, cls="vtkStratusCFReader"):
    errors = []
    reader = getattr(stratus, cls)()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    array = data.GetPointData().GetArray("q") if data else None
    return reader, (None if errors or not array else vtk_to_numpy(array).reshape(shape))


def same(values, expected, tolerance=3e-7):
    """Missing at the same places, and equal elsewhere."""
    expected = numpy.ma.filled(expected.astype(float), numpy.nan)
    return values is not None and numpy.allclose(values, expected, rtol=tolerance, atol=0, equal_nan=True)


def compare(name, kind, stored, **attributes):
    """Ours against netCDF4's."""
    for kinds in ("NETCDF4", "NETCDF4_CLASSIC", "NETCDF3_CLASSIC", "NETCDF3_64BIT_DATA"):
        if numpy.dtype(kind).str[1:] in ("u1", "u2", "u4", "i8", "u8") and kinds in ("NETCDF4_CLASSIC", "NETCDF3_CLASSIC"):
            continue  # has no such type
        path = write(name, kind, stored, kinds=kinds, **attributes)
        with netCDF4.Dataset(path) as file:
            expected = file["q"][:]
        _, values = read(path)
        check(same(values, expected), "%s, %s: %r for %r" % (name, kinds, None if values is None else values[0, 0], expected[0, 0]))
        missing = numpy.ma.count_masked(expected) + numpy.isnan(numpy.ma.filled(expected.astype(float), 0)).sum()
        check(0 < missing < expected.size, name + ": the case has missing and other values")


short = numpy.array([0, 1, -1, 5, -5, 100, -100, 32767, -32768, -32766, 20000])
byte = numpy.array([0, 1, -1, 5, -5, 100, -100, 127, -128, -127])
real = numpy.array([0, 1, -1, .5, 1e20, .1, 47.9, -999, -888, 3, 4])
int16, int8 = numpy.int16, numpy.int8

# signs
compare("unsigned", "i2", short, fill=int16(-1), _Unsigned="true", scale_factor=.001, add_offset=2.)
compare("unsigned byte", "i1", byte, fill=int8(-1), _Unsigned="true")
compare("unsigned missing", "i2", short, _Unsigned="true", missing_value=int16(-5))
compare("unsigned range", "i2", short, fill=int16(-1), _Unsigned="true", valid_range=numpy.array([1, 30000], "i2"))
compare("unsigned long", "i4", short * 60000, fill=numpy.int32(-60000), _Unsigned="true")
for unsigned, bits in (("i1", "u1"), ("i2", "u2"), ("i4", "u4"), ("i8", "u8")):  # a type in the file and one by its attribute are the same
    values = (numpy.arange(120) * (2 ** (8 * int(bits[1]) - 7))).astype(bits) + numpy.arange(120).astype("u1")
    _, by_attribute = read(write("bits", unsigned, values.view(unsigned), _Unsigned="true"))
    _, by_type = read(write("type", bits, values))
    check(by_attribute is not None and by_attribute.max() > 2 ** (8 * int(bits[1]) - 1) and (by_attribute == by_type).all(), "the bits of " + bits)
    check(by_type is not None and numpy.array_equal(by_type, numpy.resize(values, shape).astype(by_type.dtype)), "values of " + bits)
_, values = read(write("signed by attribute", "u1", [0, 1, 255, 128], _Unsigned="false"))
check(values is not None and set(values.ravel()) == {0, 1, -1, -128}, "_Unsigned false takes a sign from a type without")
for kind in ("i2", "u1", "i4", "f4"):  # the guide's older rule for bytes without a sign: an upper limit above 127
    _, values = read(write("byte range " + kind, "i1", [0, 1, -1, -6], valid_range=numpy.array([0, 250], kind)))
    check(values is not None and same(values, numpy.ma.masked_equal(numpy.resize([0, 1, 255, 250], shape), 255)), "bytes in 0..250, given as " + kind)
_, values = read(write("unsigned limit", "i1", [0, 1, -1, -6], _Unsigned="true", valid_max=int16(250)))
check(values is not None and same(values, numpy.ma.masked_equal(numpy.resize([0, 1, 255, 250], shape), 255)), "a limit of a wider type")

# missing values
compare("fill", "i2", short, fill=int16(5))
compare("fill of reals", "f4", real, fill=numpy.float32(47.9))
compare("default fill of shorts", "i2", [1, -32767, 3])
compare("default fill of reals", "f4", [1, 9.969209968386869e36, 3])
compare("default fill of doubles", "f8", [1, 9.969209968386869e36, 3])
compare("default fill of integers", "i4", [1, -2147483647, 3])
for kind in ("i1", "u1"):  # the guide leaves bytes all their values; netCDF4 1.6 takes the default fill value from them
    stored = byte.astype(kind)
    check(same(read(write("bytes", kind, stored))[1], numpy.ma.array(numpy.resize(stored, shape))), "no byte is missing by default")
compare("vector", "f4", real, missing_value=numpy.array([-999, -888], "f4"))
compare("vector of shorts", "i2", short, missing_value=numpy.array([5, -100, 1], "i2"), scale_factor=.5)
compare("with a fill", "i2", short, fill=int16(-100), missing_value=numpy.array([5, 1], "i2"))
compare("not a number", "f8", numpy.where(real == 3, numpy.nan, real), missing_value=numpy.nan)
compare("long integers", "i8", numpy.array([2 ** 53 + 1, 2 ** 53, 2 ** 53 + 2]), missing_value=numpy.int64(2 ** 53 + 1))
compare("fill within the range", "i2", short, fill=int16(-100))  # no limit: -32768 stays

# valid ranges, in packed units
compare("range", "i2", short, valid_range=numpy.array([-5, 100], "i2"), scale_factor=.01, add_offset=7.)
compare("least", "i2", short, valid_min=int16(0), scale_factor=.01)
compare("largest", "i2", short, valid_max=int16(100), add_offset=-300.)
compare("both", "f4", real, valid_min=numpy.float32(-900), valid_max=numpy.float32(40))
compare("range first", "f4", real, valid_range=numpy.array([-990, 40], "f4"), valid_min=numpy.float32(0))
compare("range of doubles that pack", "i2", short, valid_range=numpy.array([-5., 100.]), scale_factor=.5)
compare("range, fill and missing", "i2", short, fill=int16(-5), missing_value=int16(1), valid_range=numpy.array([-100, 200], "i2"), scale_factor=.1)
compare("infinite", "f4", numpy.where(real == 3, numpy.inf, real), valid_max=numpy.float32(1000))

# limits and missing values of doubles in the type of a variable of floats; netCDF4 ignores these, so NumPy judges
single = numpy.resize(real.astype("f4"), shape)
for attribute, keeps in (("valid_max", single <= numpy.float32(.1)), ("valid_min", single >= numpy.float32(.1)),
                         ("missing_value", single != numpy.float32(.1))):
    _, values = read(write("double " + attribute, "f4", real, **{attribute: .1}))
    check(same(values, numpy.ma.masked_where(~keeps, single)) and 0 < keeps.sum() < keeps.size, "a double %s of floats" % attribute)
_, values = read(write("double missing", "f4", real, missing_value=numpy.array([1e20, -999.])))
check(same(values, numpy.ma.masked_where((single == numpy.float32(1e20)) | (single == -999), single)), "two doubles are missing")

# limits of unpacked values do not apply to packed ones: they are ignored, as by netCDF4, and reported
path = write("unpacked range", "i2", short, fill=int16(-1), scale_factor=.001, valid_range=numpy.array([-47.9, 47.9]))
with netCDF4.Dataset(path) as file:
    reader, values = read(path)
    check(same(values, file["q"][:]), "limits that do not pack")
    check("valid_range -47.9 is no packed value and ignored" in reader.GetDescription(), reader.GetDescription())
path = write("text", "f4", real, missing_value="-999")
with netCDF4.Dataset(path) as file:
    reader, values = read(path)
    check(same(values, file["q"][:]) and "missing_value is text and ignored" in reader.GetDescription(), reader.GetDescription())

# an offset that takes the digits of floats gives doubles
_, values = read(write("offset", "i2", short, scale_factor=.001, add_offset=1e6))
expected = numpy.resize(short.astype(float), shape) * .001 + 1e6
check(values is not None and values.dtype == numpy.float64 and numpy.abs(values - expected).max() < 1e-9, "a large offset")
check(read(write("small", "i2", short, scale_factor=.001))[1].dtype == numpy.float32, "shorts are floats")

# a scale that is no number would give wrong values without a word
for scale, what in (("0.1", "text"), (numpy.array([.1, .2]), "2 numbers"), (numpy.nan, "nan")):
    reader, values = read(write("scale", "i2", short, scale_factor=scale))
    check(values is None, "a scale_factor of %s is refused" % what)

# the mesh reader reads by the same rules, coordinates also
path = os.path.join(folder, "values mesh.nc")
with netCDF4.Dataset(path, "w") as file:
    for name, size in (("node", 4), ("face", 1), ("corner", 4), ("layer", 3)):
        file.createDimension(name, size)
    mesh = file.createVariable("mesh", "i4")
    mesh.setncatts({"cf_role": "mesh_topology", "topology_dimension": 2, "node_coordinates": "x y", "face_node_connectivity": "corners"})
    for name, at in (("x", [0, 50000, 50000, 0]), ("y", [0, 0, 50000, 50000])):
        variable = file.createVariable(name, "i2", ("node",))
        variable.set_auto_maskandscale(False)
        variable.setncatts({"_Unsigned": "true", "units": "m", "scale_factor": .1})
        variable[:] = numpy.array(at).astype("u2").view("i2")
    file.createVariable("corners", "i4", ("face", "corner"))[:] = [[0, 1, 2, 3]]
    sigma = file.createVariable("sigma", "f8", ("layer",))
    sigma.setncatts({"standard_name": "ocean_sigma_coordinate", "formula_terms": "sigma: sigma eta: eta depth: bed"})
    sigma[:] = [-.8, -.5, -.2]
    for name, value in (("eta", 0.), ("bed", 10.)):
        file.createVariable(name, "f8", ("node",))[:] = value
    variable = file.createVariable("q", "i2", ("layer", "face"))
    variable.set_auto_maskandscale(False)
    variable.setncatts({"_Unsigned": "true", "missing_value": numpy.array([-2, -3], "i2"), "scale_factor": 2.})
    variable[:] = [[40000 - 65536], [-2], [7]]
with netCDF4.Dataset(path) as file:
    expected, corners = numpy.ma.filled(file["q"][:].astype(float), numpy.nan).ravel(), file["x"][:]
reader = stratus.vtkStratusUgridReader()
reader.SetFileName(path)
reader.SetVariableName("q")
reader.Update()
grid = reader.GetOutput()
values = vtk_to_numpy(grid.GetCellData().GetArray("q"))
check(numpy.array_equal(values, expected, equal_nan=True) and expected[0] == 80000 and numpy.isnan(expected[1]), "values of a mesh: %r" % values)
check(numpy.allclose([grid.GetPoint(i)[0] for i in range(4)], corners) and corners.max() == 5000, "coordinates of a mesh")

sys.exit(1 if failures else 0)
