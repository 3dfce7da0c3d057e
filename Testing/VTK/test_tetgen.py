# SPDX-License-Identifier: BSD-3-Clause
"""TetGen's files and, where it was built, its filter from Python: a surface goes out and in, is filled, and the mesh goes out and in."""
import os
import sys

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

failures = 0
folder = sys.argv[1] if len(sys.argv) > 1 else "."


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def read(name):
    reader = stratus.vtkStratusTetGenReader()
    reader.SetFileName(os.path.join(folder, name))
    reader.Update()
    return reader


cube = vtk.vtkCubeSource()
cube.SetXLength(2)
cube.Update()  # six sides of four points each: three in every corner
writer = stratus.vtkStratusTetGenWriter()
writer.SetInputConnection(cube.GetOutputPort())
writer.SetFileName(os.path.join(folder, "python.smesh"))
check(writer.Write() == 1, "a surface is written")
surface = read("python.smesh").GetSurface()
check(surface.GetNumberOfPolys() == 6 and surface.GetNumberOfPoints() == 24, "it is read")

if hasattr(stratus, "vtkStratusTetGenFilter"):
    fill = stratus.vtkStratusTetGenFilter()
    fill.SetInputData(surface)
    fill.SetMaximumVolume(0.05)
    fill.AddRegion(0, 0, 0, 7.5)
    fill.Update()
    mesh = fill.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData())
    corners = vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 4)
    edges = points[corners[:, 1:]] - points[corners[:, :1]]
    volumes = numpy.linalg.det(edges) / 6
    check(volumes.min() > 0 and volumes.max() <= 0.05 and abs(volumes.sum() - 2) < 1e-12, "tetrahedra fill it: %r" % volumes.sum())
    check((vtk_to_numpy(mesh.GetCellData().GetArray("Region")) == 7.5).all(), "the region's attribute")
    writer.SetInputDataObject(0, mesh)
    writer.SetInputDataObject(1, fill.GetBoundary())
    writer.SetFileName(os.path.join(folder, "python"))
    writer.SetFirstNumber(1)
    check(writer.Write() == 1, "the mesh is written")
    again = read("python.ele")
    check((vtk_to_numpy(again.GetOutput().GetPoints().GetData()) == points).all(), "points come back")
    check((vtk_to_numpy(again.GetOutput().GetCells().GetConnectivityArray()).reshape(-1, 4) == corners).all(), "tetrahedra come back")
    check(again.GetSurface().GetNumberOfPolys() == fill.GetBoundary().GetNumberOfPolys() > 0, "faces come back")
    errors = []
    fill.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    fill.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    fill.SetTimeLimit(-1)
    fill.Update()
    check(len(errors) == 1 and fill.GetOutput().GetNumberOfCells() == 0, "a bad option is one error")

errors = []
reader = stratus.vtkStratusTetGenReader()
reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
reader.SetFileName(os.path.join(folder, "nowhere.ele"))
reader.Update()
check(len(errors) == 1 and reader.GetErrorCode() != 0, "a missing file is one error")
for extension in "smesh", "node", "ele", "face":
    path = os.path.join(folder, "python." + extension)
    if os.path.exists(path):
        os.remove(path)
sys.exit(1 if failures else 0)
