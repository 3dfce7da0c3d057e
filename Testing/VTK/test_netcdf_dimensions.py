# SPDX-License-Identifier: BSD-3-Clause
"""Which dimensions of a netCDF variable are space and time: groups, dimensions without coordinates, ensembles, times of months and texts, and
and selections of them. netCDF4 reads the same values at the same indices."""
import os
import sys

import netCDF4
import numpy
from vtk.util.numpy_support import vtk_to_numpy

import stratus

failures = 0
folder = sys.argv[1] if len(sys.argv) > 1 else "."


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


class File:
    """A netCDF file under construction. Every number in it is another one."""

    def __init__(self, name, **options):
        self.path = os.path.join(folder, "dimensions %s.nc" % name)
        self.file = netCDF4.Dataset(self.path, "w", **options)
        self.count = 0

    def dimensions(self, group=None, **sizes):
        for name, size in sizes.items():
            (group or self.file).createDimension(name, None if size < 0 else size)
        return self

    def variable(self, name, dimensions, values=None, kind="f8", group=None, **attributes):
        place = group or self.file
        variable = place.createVariable(name, kind, tuple(dimensions.split()))
        variable.setncatts(attributes)
        if values is None:
            shape = [self.sizes[one] for one in dimensions.split()]
            values = self.count + numpy.arange(numpy.prod(shape)).reshape(shape)
            self.count += values.size
        if kind is str:
            variable[:] = numpy.array(values, dtype=object)
        else:
            variable[:] = values
        return self

    def write(self, sizes, *arguments, **more):
        self.sizes = sizes
        return self.variable(*arguments, **more)

    def close(self):
        self.file.close()
        return self.path


class Reading:
    def __init__(self, path, variable=None, selection=None, cls="vtkStratusCFReader"):
        self.errors = []
        self.reader = getattr(stratus, cls)()
        self.reader.AddObserver("ErrorEvent", self.hear)
        self.reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        self.reader.SetFileName(path)
        self.reader.SetVariableName(variable)
        self.reader.SetSelection(selection)
        self.reader.UpdateInformation()
        self.error = "".join(self.errors)
        self.description = self.reader.GetDescription()
        self.names = [self.reader.GetNameOfVariable(i) for i in range(self.reader.GetNumberOfVariables())]
        information = self.reader.GetOutputInformation(0)
        key = self.reader.GetExecutive().TIME_STEPS()
        self.times = [information.Get(key, i) for i in range(information.Length(key))] if information.Has(key) else []
        self.units = self.reader.GetTimeUnits()

    def hear(self, caller, event, text=None):
        self.errors.append(text or "")

    hear.CallDataType = "string0"

    def at(self, time=None):
        """The values at a time, z first."""
        if time is None:
            self.reader.Update()
        else:
            self.reader.UpdateTimeStep(time)
        data = self.reader.GetOutput()
        array = data.GetPointData().GetScalars() if data else None
        size = data.GetDimensions() if array else None
        return vtk_to_numpy(array).reshape(size[::-1]) if array else numpy.empty(0)

    def is_same(self, expected, time=None):
        return not self.errors and numpy.array_equal(self.at(time), expected)


def stored(path, name):
    with netCDF4.Dataset(path) as file:
        return numpy.ma.filled(file[name][:])


space = {"z": 3, "y": 4, "x": 5}

# groups, and dimensions and coordinates in groups above
file = File("groups").dimensions(**space)
file.write(space, "x", "x", [0, 10, 20, 30, 40], units="m")
run, deep = file.file.createGroup("run1"), file.file.createGroup("run2/deep")
file.dimensions(deep, z=6)
file.variable("z", "z", [0, 1, 2, 3, 5, 9], group=deep, units="km")
file.variable("rho", "z y x", group=run)
file.sizes = {"z": 6, "y": 4, "x": 5}
file.variable("rho", "z y x", group=deep)
path = file.close()
read = Reading(path)
check(read.names == ["run1/rho", "run2/deep/rho"], "variables of groups: %r" % read.names)
check(read.is_same(stored(path, "run1/rho")) and read.reader.GetOutput().IsA("vtkImageData") and
      read.reader.GetOutput().GetSpacing() == (10, 1, 1), "a coordinate of the group above: " + read.description + read.error)
read = Reading(path, "run2/deep/rho")
check(read.is_same(stored(path, "run2/deep/rho")), "a group in a group: " + read.error)
check(list(vtk_to_numpy(read.reader.GetOutput().GetZCoordinates())) == [0, 1000, 2000, 3000, 5000, 9000], "its own coordinate of the same name")
check("there is no variable 'run3/rho'" in Reading(path, "run3/rho").error, "a group that is not there")
file = File("nearest").dimensions(**space)  # terms of a formula are looked up from the group of the variable
for group, height in ((None, 7.), (file.file.createGroup("run1"), 100.)):
    file.write({}, "s", "z", [-1, -.5, 0], group=group, standard_name="ocean_sigma_coordinate", formula_terms="sigma: s eta: eta depth: h")
    file.variable("h", "y x", numpy.full((4, 5), height), group=group).variable("eta", "y x", numpy.zeros((4, 5)), group=group)
file.sizes = space
file.variable("q", "z y x", group=file.file["run1"], coordinates="s")
read = Reading(file.close(), "run1/q")
read.at()
check(not read.errors and read.reader.GetOutput() and read.reader.GetOutput().GetBounds()[4:] == (-100, 0), "the nearest term: " + read.error)

# dimensions without coordinates
for name, dimensions, steps in (("four", {"a": 3, "b": 4, "c": 5, "d": 6}, 3), ("unlimited", {"t0": -1, "b": 4, "c": 5, "d": 6}, 3),
                                ("named", {"Time": 3, "k": 4, "j": 5, "i": 6}, 3), ("five", {"a": 3, "n": 2, "b": 4, "c": 5, "d": 6}, 3)):
    sizes = {one: 3 if size < 0 else size for one, size in dimensions.items()}
    path = File(name).dimensions(**dimensions).write(sizes, "q", " ".join(dimensions)).close()
    read, all_values = Reading(path), stored(path, "q")
    all_values = all_values[:, 0] if name == "five" else all_values
    check(read.times == [0, 1, 2] and "are counted from 0" in read.description, "%s: the outermost is time: %r %s" % (name, read.times, read.error))
    check(all(read.is_same(all_values[step], step) for step in range(3)), name + ": its steps")
    check(("'n' at index 0 of 0..1, select n=INDEX for another" in read.description) == (name == "five"), name + ": " + read.description)
path = File("three").dimensions(t0=-1, b=4, c=5).write({"t0": 3, "b": 4, "c": 5}, "q", "t0 b c").close()
read = Reading(path)
check(read.is_same(stored(path, "q")) and read.times == [], "three dimensions are a volume, though the outermost is unlimited")
path = File("flat in time").dimensions(time=3, b=4, c=5).write({"time": 3, "b": 4, "c": 5}, "q", "time b c").close()
read = Reading(path)
check("'q' has the dimensions time (3), b (4), c (5)" in read.error, "two dimensions and time are no volume: " + read.error)
read = Reading(path, "q")
check("variable 'q' has 2 dimensions in space" in read.error and "time (3), b (4), c (5)" in read.error, "nor if it is named: " + read.error)

# an ensemble, with and without time, wherever its dimension is
for order in ("number time z y x", "time number z y x", "number z y x", "z number y x", "number lev lat lon", "lev lat lon pool"):
    sizes = {"number": 4, "pool": 4, "time": 2, "lev": 3, "lat": 4, "lon": 5, **space}
    file = File("ensemble").dimensions(**{one: sizes[one] for one in order.split()})
    file.write(sizes, "q", order)
    for one in order.split():
        if one == "time":
            file.variable("time", "time", [0, 6], units="hours since 2001-01-01")
        elif one == "number":
            file.variable("number", "number", numpy.arange(4), kind="i4", standard_name="realization")
        elif one == "pool":
            file.variable("pool", "pool", numpy.arange(4), kind="i4")
        elif one in ("lat", "lon"):
            file.variable(one, one, numpy.arange(sizes[one]) * 2., units="degrees_" + {"lat": "north", "lon": "east"}[one])
        elif one == "lev":
            file.variable(one, one, numpy.arange(3.), units="m", positive="up")
    path = file.close()
    other = "pool" if "pool" in order else "number"
    for index in (None, 0, 2, 3):
        read = Reading(path, None, None if index is None else "%s=%d" % (other, index))
        expected = numpy.take(stored(path, "q"), index or 0, order.split().index(other))
        for step, time in enumerate(read.times or [None]):
            check(read.is_same(expected[step] if read.times else expected, time), "%s: member %s: %s" % (order, index, read.error))
        check(read.times == ([0, 6] if "time" in order else []), order + ": the times")
        check("'%s' at index %d of 0..3" % (other, index or 0) in read.description and ("=INDEX" in read.description) == (index is None), order + ": " + read.description)

# any dimension may be selected: an axis, so that another takes its place, and the time
sizes = {"time": 2, "a": 3, "b": 4, "c": 5, "d": 6}
path = File("any").dimensions(**sizes).write(sizes, "q", "time a b c d").variable("time", "time", [3, 4], units="h").close()
values = stored(path, "q")
for selection, expected, times in (("d=2", values[..., 2], [3, 4]), ("b=1", values[:, :, 1], [3, 4]), ("time=1,c=4", values[1, :, :, 4], []),
                                   ("time=1,a=2", values[1, 2], []), (None, values[:, 0], [3, 4])):
    read = Reading(path, None, selection)
    check(read.times == times and read.is_same(expected[-1] if times else expected, times[-1] if times else None), "%s: %s" % (selection, read.error))
for selection, why in (("number=1", "there is no dimension 'number' to select; those that are: time (2), a (3), b (4), c (5), d (6)"),
                       ("a=3", "'a' has 3 values, the index must be 0 to 2"), ("a=-1", "'a=-1' is not NAME=INDEX"), ("a", "is not NAME=INDEX"),
                       ("a=1.5", "is not NAME=INDEX"), ("=1", "is not NAME=INDEX"), ("a=99999999999999999999", "is not NAME=INDEX"),
                       ("a=0,b=0,c=0", "there is no variable on a grid of three dimensions")):
    read = Reading(path, None, selection)
    check(why in read.error, "%s must be refused with %r, not %r" % (selection, why, read.error))

# coordinates that depend on the ensemble follow the selection
sizes = {"number": 2, **space}
file = File("terms").dimensions(**sizes)
file.write(sizes, "s", "z", [-1, -.5, 0], standard_name="ocean_sigma_coordinate", formula_terms="sigma: s eta: eta depth: h")
file.variable("eta", "y x", numpy.zeros((4, 5))).variable("h", "number y x", numpy.repeat([10., 20.], 20).reshape(2, 4, 5))
path = file.variable("q", "number z y x", coordinates="s").close()
for index, depth in ((0, -10), (1, -20)):
    read = Reading(path, "q", "number=%d" % index)
    read.at()
    check(not read.errors and read.reader.GetOutput().GetBounds()[4] == depth, "a term of the height of member %d: %s" % (index, read.error))

# times: months, texts, and texts in characters
times = {
    "month": ("i4", [1, 2, 3], {}, [1, 2, 3], ""),
    "season": (str, ["DJF", "MAM", "JJA"], {}, [0, 1, 2], ""),
    "time": (str, ["2020-02-28", "2020-02-29", "2020-03-01"], {}, [0, 86400, 172800], "seconds since 2020-02-28"),
    "valid_time": (str, ["2019-12-31T23:00:00", "2020-01-01T00:00:00", "2020-01-01T00:00:30.5Z"], {}, [0, 3600, 3630.5], "seconds since 2019-12-31T23:00:00"),
    "months": ("i4", [11, 12, 1], {"units": "month"}, [0, 1, 2], ""),
    "T": ("f8", [.5, 1.5, 2.5], {"units": "months since 1990-01-01"}, [.5, 1.5, 2.5], "months since 1990-01-01"),
}
for name, (kind, at, attributes, expected, units) in times.items():
    sizes = {name: 3, **space}
    path = File("time " + name).dimensions(**sizes).write(sizes, "q", name + " z y x").variable(name, name, at, kind=kind, **attributes).close()
    read = Reading(path)
    check(read.times == expected and read.units == units, "%s: %r %r %s" % (name, read.times, read.units, read.error))
    check(all(read.is_same(stored(path, "q")[step], expected[step]) for step in range(3)), name + ": its steps")
    check(("counted from 0" in read.description) == (expected == [0, 1, 2]), name + ": " + read.description)
for kinds in ("NETCDF4", "NETCDF3_CLASSIC"):  # WRF's Times
    sizes = {"Time": 3, "DateStrLen": 19, **space}
    file = File("characters", format=kinds).dimensions(**{**sizes, "Time": -1}).write(sizes, "q", "Time z y x")
    moments = ["1999-12-31_23:00:00", "2000-01-01_00:00:00", "2000-02-29_00:00:00"]
    read = Reading(file.variable("Times", "Time DateStrLen", numpy.array([list(one) for one in moments], "S1"), kind="S1").close())
    check(read.times == [0, 3600, 3600 + 59 * 86400.] and read.units == "seconds since 1999-12-31 23:00:00", "characters: %r %s" % (read.times, read.error))
    check(all(read.is_same(stored(read.reader.GetFileName(), "q")[step], read.times[step]) for step in range(3)), "steps of texts")

# meshes: in a group, with an ensemble, and a time without coordinates
file = File("mesh")
group = file.file.createGroup("model")
sizes = {"number": 3, "record": 2, "layer": 2, "node": 4, "face": 1, "corner": 4, "free": 3}
file.dimensions(group, **{**sizes, "free": -1}).sizes = sizes
file.variable("mesh", "", 0, kind="i4", group=group, cf_role="mesh_topology", topology_dimension=2, node_coordinates="x y",
              face_node_connectivity="corners")
file.variable("x", "node", [0, 1, 1, 0], group=group, units="m").variable("y", "node", [0, 0, 1, 1], group=group, units="m")
file.variable("corners", "face corner", [[0, 1, 2, 3]], kind="i4", group=group)
file.variable("sigma", "layer", [-.75, -.25], group=group, standard_name="ocean_sigma_coordinate", formula_terms="sigma: sigma eta: eta depth: bed")
file.variable("eta", "node", numpy.zeros(4), group=group).variable("bed", "node", numpy.full(4, 10.), group=group)
for name, dimensions in (("q", "number record layer face"), ("r", "face layer number"), ("s", "free layer face"), ("t", "number face")):
    file.variable(name, dimensions, group=group)
path = file.close()
for name, selection, index, times in (("q", None, (0,), 2), ("q", "number=2", (2,), 2), ("q", "number=1,record=1", (1, 1), 0),
                                      ("r", "number=1", (slice(None), slice(None), 1), 0), ("s", None, (), 3)):
    read = Reading(path, "model/" + name, selection, "vtkStratusUgridReader")
    check(read.times == list(range(times)), "%s of the mesh at %s: %r %s" % (name, selection, read.times, read.error))
    expected = stored(path, "model/" + name)[index]
    for step in range(max(times, 1)):
        read.reader.UpdateTimeStep(step)
        array = read.reader.GetOutput().GetCellData().GetArray("model/" + name)
        check(array and numpy.array_equal(vtk_to_numpy(array), (expected[step] if times else expected).ravel()),
              "values of %s at %s: %s" % (name, selection, read.error))
    check(("'number' at index" in read.description) == (name != "s"), read.description)
check("cannot be selected" in Reading(path, "model/q", "node=1", "vtkStratusUgridReader").error, "nodes are no choice")

sys.exit(1 if failures else 0)
