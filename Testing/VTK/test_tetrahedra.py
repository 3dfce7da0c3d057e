# SPDX-License-Identifier: BSD-3-Clause
"""Unstructured grids from Python: the mapper draws, each of its setters changes what it says, opaque geometry hides, the near plane cuts, values
of points and cells, the volume's matrix; the partition filter and the order that go with it."""
import sys

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

failures = 0
width, height = 96, 72


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def array(values, name):
    result = numpy_to_vtk(numpy.ascontiguousarray(values), deep=1)
    result.SetName(name)
    return result


# Hexahedra: n^3 cubes of edge 1, a slope along x on their points, numbers of layers along z on the cells.
n = 4
x, y, z = (a.ravel() for a in numpy.meshgrid(*3 * [numpy.arange(n + 1.0)], indexing="ij"))
points = vtk.vtkPoints()
points.SetData(array(numpy.stack([x, y, z], axis=1), "points"))
number = numpy.arange((n + 1) ** 3).reshape(3 * [n + 1])
corners = [number[i : i + n, j : j + n, k : k + n].ravel()
           for i, j, k in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))]
cells = vtk.vtkCellArray()
cells.SetData(8, numpy_to_vtk(numpy.stack(corners, axis=1).ravel().astype(numpy.int64), deep=1, array_type=vtk.VTK_ID_TYPE))
grid = vtk.vtkUnstructuredGrid()
grid.SetPoints(points)
grid.SetCells(vtk.VTK_HEXAHEDRON, cells)
grid.GetPointData().SetScalars(array(x / n, "slope"))
grid.GetPointData().AddArray(array(numpy.full(x.size, 0.5), "half"))
grid.GetCellData().AddArray(array(numpy.tile(numpy.arange(n) / (n - 1.0), n * n), "layer"))

mapper = stratus.vtkStratusTetrahedraMapper()
mapper.SetInputData(grid)
opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
opacity.AddPoint(0, 0)
opacity.AddPoint(1, 0.5)
color.AddRGBPoint(0, 0, 0, 1)
color.AddRGBPoint(1, 1, 0, 0)
volume = vtk.vtkVolume()
volume.SetMapper(mapper)
volume.GetProperty().SetScalarOpacity(opacity)
volume.GetProperty().SetColor(color)
renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
renderer.AddVolume(volume)
window.SetMultiSamples(0)
window.SetSize(width, height)
window.AddRenderer(renderer)
camera = renderer.GetActiveCamera()
camera.SetPosition(2, 2, 12)
camera.SetFocalPoint(2, 2, 2)
camera.ParallelProjectionOn()
camera.SetParallelScale(3)
renderer.ResetCameraClippingRange()


def picture():
    window.Render()
    last = mapper.GetLastImage()
    return vtk_to_numpy(last.GetPointData().GetArray("RGBA")).reshape(height, width, 4).copy() if last else None


def depth():
    return vtk_to_numpy(mapper.GetLastImage().GetPointData().GetArray("Depth")).reshape(height, width).copy()


def column(where):  # of the pixel whose middle is there
    return int(width / 2 + (where - 2) / 6 * height)


# ---- what is drawn: along z a ray sees four units of the value at its x
errors = []
mapper.AddObserver("ErrorEvent", lambda *_: errors.append(1))
whole = picture()
check(mapper.IsA("vtkUnstructuredGridVolumeMapper"), "a mapper of VTK's kind")
for at in 0.5, 1.7, 3.3:
    value = ((column(at) + 0.5 - width / 2) * 6 / height + 2) / n
    alpha = 1 - (1 - 0.5 * value) ** n
    seen = whole[height // 2, column(at)]
    check(abs(seen[3] - alpha) < 1e-4, "thickness at %g: %g is not %g" % (at, seen[3], alpha))
    check(abs(seen[0] - value * alpha) < 1e-4 and abs(seen[2] - (1 - value) * alpha) < 1e-4, "colour at %g" % at)
check(whole[2, 2, 3] == 0 and numpy.isinf(depth()[2, 2]), "nothing in the corner")
check(abs(depth()[height // 2, column(3)] - 8) < 1e-2, "depth is the near side's: %g" % depth()[height // 2, column(3)])
check(mapper.GetNumberOfTetrahedra() == 6 * n ** 3 or mapper.GetNumberOfTetrahedra() == 5 * n ** 3, "hexahedra are divided")
check(mapper.GetNumberOfSegments() > mapper.GetNumberOfEntries() >= 0, "segments and entries are counted")
check(mapper.GetBuildMilliseconds() > 0 and mapper.GetMarchMilliseconds() >= 0, "times")

# ---- setters
check(mapper.GetTermination() == 0 and mapper.GetImageErrorTolerance() == 0.001, "default termination and tolerance")
mapper.SetTermination(0.5)
early = picture()
lit = whole[..., 3] > 0.8
check((early[lit, 3] < whole[lit, 3] - 0.01).any() and (early[lit, 3] >= 0.5).all(), "rays end early where alpha passes .5")
mapper.SetTermination(7)
check(mapper.GetTermination() == 1, "termination is clamped")
mapper.SetTermination(0)
by_method = {}  # "auto" may choose otherwise for other threads and devices, so each method is compared with itself
for method in mapper.PROJECT_METHOD, mapper.MARCH_METHOD:
    mapper.SetMethod(method)
    mapper.SetNumberOfThreads(0)
    by_method[method] = picture()
    mapper.SetNumberOfThreads(1)
    check((picture() == by_method[method]).all(), "one thread draws the same bits, method %d" % method)
check(any((whole == one).all() for one in by_method.values()), "auto draws its method's picture")
mapper.SetNumberOfThreads(-3)
check(mapper.GetNumberOfThreads() == 0, "threads are clamped")
mapper.SetDevice("no such device")
check(len(errors) == 1 and mapper.GetDevice() == "auto", "a device that is none is an error, and changes nothing")
errors.clear()
mapper.SetDevice("0")
if errors:
    errors.clear()  # no OpenCL device on this machine
else:
    check((picture() == by_method[mapper.MARCH_METHOD]).all(), "an OpenCL device draws the same bits")
    mapper.SetDevice("host")
    mapper.SetMethodToAuto()
    check((picture() == whole).all() and mapper.GetDeviceName().startswith("host"), "and so does the host again")
mapper.SetMethodToAuto()
picture()
check(mapper.GetMethodAsString() == "auto" and mapper.GetMethodUsedAsString() in ("march", "project"), "a method is chosen")
check(len(mapper.GetMethodReason()) > 0, "and a reason given")
for method, name in (mapper.SetMethodToMarch, "march"), (mapper.SetMethodToProject, "project"):
    method()
    drawn = picture()
    check(mapper.GetMethodUsedAsString() == mapper.GetMethodAsString() == name and abs(drawn - whole).max() < 1e-4, "the same picture by " + name)
    check((mapper.GetNumberOfEntries() > 0) == (name == "march"), "rays enter where they march")
mapper.SetMethod(9)
check(mapper.GetMethod() == mapper.PROJECT_METHOD, "methods are clamped")
mapper.SetMethodToAuto()
check((picture() == whole).all(), "auto again draws the same bits")
mapper.SetBlendModeToMaximumIntensity()
largest = picture()[height // 2]
value = ((column(3.5) + 0.5 - width / 2) * 6 / height + 2) / n
check(abs(largest[column(3.5)] - 0.5 * value * numpy.array([value, 0, 1 - value, 1])).max() < 1e-4, "the maximum, at the opacity of one unit")
mapper.SetBlendMode(6)
check(picture() is None and len(errors) == 1, "another blend mode is refused by one error")
mapper.SetBlendModeToComposite()
check((picture() == whole).all() and len(errors) == 1, "composite again")

# ---- scalars
mapper.SetScalarModeToUsePointFieldData()
mapper.SelectScalarArray("half")
flat = picture()
check(abs(flat[height // 2, column(1), 3] - (1 - 0.75 ** n)) < 1e-4, "another array of points by its name")
mapper.SelectScalarArray(0)
check((picture() == whole).all(), "an array by its number")
mapper.SetScalarModeToUseCellFieldData()
mapper.SelectScalarArray("layer")
layers = picture()[height // 2, column(1)]
meant = numpy.zeros(4)
for layer in range(n)[::-1]:  # the near side is the upper one
    value = layer / (n - 1.0)
    meant += (1 - meant[3]) * 0.5 * value * numpy.array([value, 0, 1 - value, 1])
check(abs(layers - meant).max() < 1e-4, "values of cells: %r is not %r" % (layers, meant))
mapper.SelectScalarArray("none such")
check(picture() is None and len(errors) == 2, "an array that is not there is one error")
mapper.SetScalarModeToDefault()

# ---- opaque geometry, behind and before
cube = vtk.vtkCubeSource()
cube.SetBounds(-1, 5, -1, 5, 1.5, 2)
cut = vtk.vtkPolyDataMapper()
cut.SetInputConnection(cube.GetOutputPort())
wall = vtk.vtkActor()
wall.SetMapper(cut)
renderer.AddActor(wall)
middle = picture()[height // 2, column(3)]
value = ((column(3) + 0.5 - width / 2) * 6 / height + 2) / n
check(abs(middle[3] - (1 - (1 - 0.5 * value) ** 2)) < 1e-3, "only the volume before the wall: %g" % middle[3])
cube.SetBounds(-1, 5, -1, 5, 5, 6)
check(picture()[..., 3].max() == 0, "nothing before a wall that hides all")
renderer.RemoveActor(wall)

# ---- the near plane cuts cells, the far one too
camera.SetClippingRange(8.7, 9.9)
check(abs(picture()[height // 2, column(3), 3] - (1 - (1 - 0.5 * value) ** 1.2)) < 1e-3, "only the part between near and far plane")
renderer.ResetCameraClippingRange()

# ---- the volume's matrix, and opacity per world length
volume.SetScale(1, 1, 0.5)
check(abs(picture()[height // 2, column(3), 3] - (1 - (1 - 0.5 * value) ** 2)) < 1e-3, "half as thick")
volume.SetScale(-1, 1, 1)
volume.SetPosition(4, 0, 0)
mirrored = picture()
check(abs(mirrored[:, ::-1, 3] - whole[..., 3]).max() < 1e-4, "a mirror")
volume.SetPosition(0, 0, 0)
volume.SetScale(1, 1, 1)
volume.GetProperty().SetScalarOpacityUnitDistance(2)
check(abs(picture()[height // 2, column(3), 3] - (1 - (1 - 0.5 * value) ** 2)) < 1e-3, "half the opacity a length")
volume.GetProperty().SetScalarOpacityUnitDistance(1)

# ---- grids that change, are empty, or have no volume
grid.GetPointData().GetScalars().SetTuple1(62, float("nan"))
grid.GetPointData().GetScalars().Modified()
check(picture()[height // 2, column(2.1), 3] < whole[height // 2, column(2.1), 3] - 0.1, "cells with a corner that is no number are transparent")
grid.GetPointData().GetScalars().SetTuple1(62, 0.5)
grid.GetPointData().GetScalars().Modified()
check((picture() == whole).all(), "a number again")
line = grid.NewInstance()
line.SetPoints(points)
line.InsertNextCell(vtk.VTK_LINE, 2, [0, 1])
line.GetPointData().ShallowCopy(grid.GetPointData())
mapper.SetInputData(line)
check(picture() is None and len(errors) == 3, "a grid without volumes is one error")
mapper.SetInputData(vtk.vtkUnstructuredGrid())
check(picture() is None and len(errors) == 3, "an empty grid is nothing, and no error")
mapper.SetInputData(grid)
check((picture() == whole).all(), "and a grid again")
text = str(mapper)
for word in "Termination", "NumberOfThreads", "Method", "Method Used", "Device", "Tetrahedra", "Ignored Cells", "Segments", "Entries":
    check(word in text, "PrintSelf prints " + word)

# ---- the partition filter, the order, and VTK's projector
partition = stratus.vtkStratusPartitionFilter()
partition.SetInputData(grid)
partition.SetLeafCells(20)
partition.Update()
pieces = partition.GetOutput()
check(partition.GetNumberOfLeaves() == 8 and pieces.GetNumberOfCells() >= partition.GetNumberOfTetrahedra() >= 5 * n ** 3, "eight leaves")
check(vtk_to_numpy(pieces.GetCellData().GetArray("StratusLeaf")).max() == 7, "a leaf a cell")
mapper.SetInputConnection(partition.GetOutputPort())
check(abs(picture() - whole).max() < 1e-4, "cut cells give the same picture")
order = stratus.vtkStratusVisibilitySort()
projector = vtk.vtkProjectedTetrahedraMapper()
projector.SetInputConnection(partition.GetOutputPort())
projector.SetVisibilitySort(order)
volume.SetMapper(projector)
window.Render()
check(order.GetNumberOfLeaves() == 8 and order.GetNumberOfCycles() == 0, "VTK's projector sorts by our order, leaf by leaf")
sys.exit(1 if failures else 0)
