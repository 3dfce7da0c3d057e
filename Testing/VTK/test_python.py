# SPDX-License-Identifier: BSD-3-Clause
"""Every class is there from Python in addition to Debian's vtk, draws, refuses, and gives its picture as an array."""
import sys

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


n = 24
x, y, z = numpy.meshgrid(*3 * [numpy.linspace(-1, 1, n)], indexing="ij")
image = vtk.vtkImageData()
image.SetDimensions(n, n, n)
array = numpy_to_vtk(numpy.maximum(0, 1 - x * x - y * y - z * z).astype(numpy.float32).ravel(), deep=1)
array.SetName("ball")
image.GetPointData().SetScalars(array)

opacity = vtk.vtkPiecewiseFunction()
opacity.AddPoint(0, 0)
opacity.AddPoint(1, 0.5)
color = vtk.vtkColorTransferFunction()
color.AddRGBPoint(0, 1, 0.5, 0)

mapper = stratus.vtkStratusVolumeMapper()
mapper.SetInputData(image)
mapper.SetStructureToDistance()
mapper.AuditOn()
volume = vtk.vtkVolume()
volume.SetMapper(mapper)
volume.GetProperty().SetScalarOpacity(opacity)
volume.GetProperty().SetColor(color)
volume.GetProperty().SetInterpolationTypeToLinear()
renderer = vtk.vtkRenderer()
renderer.AddVolume(volume)
window = vtk.vtkRenderWindow()
window.SetSize(120, 90)
window.AddRenderer(renderer)
renderer.ResetCamera()
window.Render()

check(mapper.IsA("vtkVolumeMapper"), "a mapper of VTK's kind")
check(mapper.GetDifferingPixels() == 0, "the audit finds no differing pixel")
check(mapper.GetSamplesTaken() > 0, "samples taken")
check("distance" in mapper.GetStructureUsedAsString(), "the requested structure: " + mapper.GetStructureUsedAsString())
last = mapper.GetLastImage()
rgba = vtk_to_numpy(last.GetPointData().GetArray("RGBA")).reshape(90, 120, 4)
check(rgba[45, 60, 3] > 0.5 and rgba[2, 2, 3] == 0, "opaque in the middle, nothing in the corner")
check(numpy.allclose(rgba[..., 1], 0.5 * rgba[..., 0], atol=1e-5), "the requested colour, premultiplied")
check(numpy.isfinite(vtk_to_numpy(last.GetPointData().GetArray("Depth")).reshape(90, 120)[45, 60]), "depth in the middle")

errors = []
mapper.AddObserver("ErrorEvent", lambda *_: errors.append(1))
mapper.SetBlendModeToSlice()  # without a SliceFunction
window.Render()
check(len(errors) == 1, "what is not supported is refused by one error")

distances = stratus.vtkStratusDistanceMapFilter()
distances.SetInputData(image)
distances.ThresholdBetween(0.5, 1)
distances.Update()
values = vtk_to_numpy(distances.GetOutput().GetCellData().GetArray("Distance"))
check(values.min() == 0 and values.max() >= 1, "distances of 0 and more")
check(len(values) == 6 ** 3, "a value a block: %d" % len(values))

tree = stratus.vtkStratusHybridTreeFilter()
tree.SetInputData(image)
tree.ThresholdBetween(0.5, 1)
tree.SetPurposeToFirstHits()
tree.SetMethodToOctant()
tree.Update()
fields = tree.GetOutput().GetFieldData()
check(fields.GetArray("StratusHybridTree").GetNumberOfValues() > 100, "the image carries its tree")
check(len(fields.GetAbstractArray("StratusHybridTreeHash").GetValue(0)) == 16, "what the tree is of")
check(image.GetFieldData().GetNumberOfArrays() == 0, "the input stays as it was")
inside = int((vtk_to_numpy(array) >= 0.5).sum())
check(tree.GetNumberOfVoxels() == inside, "%d voxels, %d counted" % (inside, tree.GetNumberOfVoxels()))
counts = vtk_to_numpy(tree.GetOutputDataObject(1).GetCellData().GetArray("Count"))
check(counts[0] == inside and len(counts) == tree.GetNumberOfNodes(), "boxes with counts")
check(tree.GetMethodAsString() == "octant", "the method: " + tree.GetMethodAsString())
check(stratus.__version__.count(".") == 2, "a version")
sys.exit(1 if failures else 0)
