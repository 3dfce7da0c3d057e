# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: the filter Stratus Ray Quantities of a file in kilometres gives a map over the data in metres, as known in closed form,
which a view shows in its place and colours. pvbatch test_quantities.py PLUGIN STRATUS COMPARE-PICTURES FOLDER"""
import os
import sys

import numpy
from paraview import simple
from paraview.vtk.util.numpy_support import vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import netcdf
from beside import check, folder, leave, load
from showing import make_view

load()
N = 17
at = numpy.arange(N, dtype=float)
z, y, x = numpy.meshgrid(at, at, at, indexing="ij")
path = os.path.join(folder, "water.nc")
variables = {axis: ((axis,), at, {"units": "km", "axis": axis.upper()}) for axis in "zyx"}
variables["q"] = (("z", "y", "x"), x + 2 * y + 3 * z + 1, {"units": "g m-3"})
netcdf.write(path, {"z": N, "y": N, "x": N}, variables)
reader = simple.StratusCFReader(FileName=path)
reader.UpdatePipeline()
numbers = simple.StratusRayQuantities(Input=reader)
numbers.Length = numbers.Mean = numbers.Maximum = numbers.MaximumDepth = numbers.Cells = 1
numbers.UpdatePipeline()
image = simple.servermanager.Fetch(numbers)
names = [image.GetPointData().GetArrayName(n) for n in range(image.GetPointData().GetNumberOfArrays())]
check(names == "integral length mean maximum maximum_depth cells".split(), f"arrays {names}")
points = numpy.array([image.GetPoint(n) for n in range(image.GetNumberOfPoints())]) / 1000
check(len(points) == (N - 1) ** 2 and numpy.allclose(points[:, 2], N - 1), "the image is above the data, with a ray for each cell")
mean = points[:, 0] + 2 * points[:, 1] + 3 * 8 + 1
values = {name: vtk_to_numpy(image.GetPointData().GetArray(name)) for name in names}
check(numpy.allclose(values["integral"], 16000 * mean, rtol=1e-5), "the integral of a linear field")
check(numpy.allclose(values["length"], 16000, rtol=1e-5) and numpy.allclose(values["mean"], mean, rtol=1e-5), "length and mean")
check(numpy.allclose(values["maximum"], mean + 24, rtol=1e-5), "the largest value is at the top")
integral = image.GetPointData().GetArray("integral")
unit = integral.GetInformation().Get(integral.UNITS_LABEL()) if integral.HasInformation() else ""
check(unit in ("g m-2", ""), f"unit {unit!r}")

view = make_view(400, 300)
outline = simple.Show(reader, view)
outline.SetRepresentationType("Outline")
shown = simple.Show(numbers, view)
shown.SetRepresentationType("Slice")
simple.ColorBy(shown, ("POINTS", "integral"))
shown.RescaleTransferFunctionToDataRange(True)
shown.SetScalarBarVisibility(view, True)
simple.ResetCamera(view)
view.CameraPosition = [view.CameraPosition[0] + 30000, view.CameraPosition[1] - 50000, view.CameraPosition[2] + 10000]
view.CameraViewUp = [0, 0, 1]
simple.ResetCamera(view)
simple.Render(view)
simple.SaveScreenshot(os.path.join(folder, "quantities.png"), view, ImageResolution=[400, 300])

line = simple.PlotOverLine(Input=numbers)
for name, place in ("Point1", [1000, 8000, 16000]), ("Point2", [15000, 8000, 16000]):
    setattr(line if hasattr(line, name) else line.Source, name, place)
line.UpdatePipeline()
along = simple.servermanager.Fetch(line)
first = vtk_to_numpy(along.GetPointData().GetArray("integral"))
check(abs(first[0] - 16000 * (1 + 16 + 24 + 1)) < 1e-4 * first[0], f"plotted over a line: {first[0]}")

numbers.View = "Direction"
numbers.Direction = [1, 0, 0]
numbers.Resolution = [32, 32]
numbers.UpdatePipeline()
image = simple.servermanager.Fetch(numbers)
mean = vtk_to_numpy(image.GetPointData().GetArray("mean"))
at = numpy.array([image.GetPoint(n) for n in range(image.GetNumberOfPoints())]) / 1000
check(numpy.allclose(mean, 8 + 2 * at[:, 1] + 3 * at[:, 2] + 1, rtol=1e-4), "along a direction")
leave()
