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
waves = numpy_to_vtk(0.5 + 0.5 * numpy.sin(4 * numpy.arctan2(y, x) + 6 * z), deep=1)
waves.SetName("waves"), mesh.GetPointData().SetScalars(waves)
mapper, volume = vtk.vtkUnstructuredGridVolumeRayCastMapper(), vtk.vtkVolume()
mapper.SetInputData(mesh), volume.SetMapper(mapper)
opacity, color = volume.GetProperty().GetScalarOpacity(), volume.GetProperty().GetRGBTransferFunction()
opacity.RemoveAllPoints(), opacity.AddPoint(0.5, 0), opacity.AddPoint(1, 0.9)
color.RemoveAllPoints(), color.AddRGBPoint(0.5, 0.1, 0.4, 0.9), color.AddRGBPoint(1, 1, 0.6, 0.2)
volume.GetProperty().SetScalarOpacityUnitDistance(0.1), volume.GetProperty().SetInterpolationTypeToLinear()
renderer, window, hand, picture, writer = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkRenderWindowInteractor(), vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
renderer.AddVolume(volume), window.AddRenderer(renderer), window.SetSize(480, 480), hand.SetRenderWindow(window), window.Render()
if len(sys.argv) > 1: picture.SetInput(window), writer.SetInputConnection(picture.GetOutputPort()), writer.SetFileName(sys.argv[1]), writer.Write()
else: hand.Start()
