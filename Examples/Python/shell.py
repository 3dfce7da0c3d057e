# SPDX-License-Identifier: BSD-3-Clause
# A surface, filled by TetGen, a field on the tetrahedra, and its picture, to turn with the mouse, or in a file: shell.py [OUT.png]
import sys, numpy, stratus, vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
spheres, tetgen = vtk.vtkAppendPolyData(), stratus.vtkStratusTetGenFilter()
for radius in 1, 0.5:
    sphere = vtk.vtkSphereSource()
    sphere.SetRadius(radius), sphere.SetThetaResolution(32), sphere.SetPhiResolution(24), spheres.AddInputConnection(sphere.GetOutputPort())
tetgen.SetInputConnection(spheres.GetOutputPort()), tetgen.AddHole(0, 0, 0), tetgen.SetMaximumVolume(2e-4), tetgen.Update()
mesh = tetgen.GetOutput()
if mesh.GetNumberOfCells() == 0: sys.exit(1)
x, y, z = vtk_to_numpy(mesh.GetPoints().GetData()).T
waves = numpy_to_vtk(numpy.sin(5 * x) * numpy.cos(5 * y) + numpy.sin(5 * y) * numpy.cos(5 * z) + numpy.sin(5 * z) * numpy.cos(5 * x), deep=1)
waves.SetName("waves"), mesh.GetPointData().SetScalars(waves)
mapper, volume = stratus.vtkStratusTetrahedraMapper(), vtk.vtkVolume()
mapper.SetInputData(mesh), volume.SetMapper(mapper)
opacity, color = volume.GetProperty().GetScalarOpacity(), volume.GetProperty().GetRGBTransferFunction()
opacity.RemoveAllPoints(), opacity.AddPoint(0.3, 0), opacity.AddPoint(1, 0.6)
color.RemoveAllPoints(), color.AddRGBPoint(0.3, 0.1, 0.4, 0.9), color.AddRGBPoint(1, 1, 0.6, 0.2)
volume.GetProperty().SetScalarOpacityUnitDistance(0.1), volume.GetProperty().SetInterpolationTypeToLinear()
renderer, window, hand = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkRenderWindowInteractor()
picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
renderer.AddVolume(volume), window.AddRenderer(renderer), window.SetSize(480, 480), hand.SetRenderWindow(window)
renderer.GetActiveCamera().SetPosition(2, 1.5, 3), renderer.ResetCamera(), renderer.GetActiveCamera().Zoom(1.5), window.Render()
if len(sys.argv) > 1: picture.SetInput(window), writer.SetInputConnection(picture.GetOutputPort()), writer.SetFileName(sys.argv[1]), writer.Write()
else: hand.Start()
