# SPDX-License-Identifier: BSD-3-Clause
# A cloud with an opaque ball in it, to turn with the mouse: PYTHONPATH=build/lib/python3/dist-packages python3 Examples/Python/cloud.py
import stratus, vtk
from vtk.util.numpy_support import vtk_to_numpy

shape, noise, image = vtk.vtkQuadric(), vtk.vtkPerlinNoise(), vtk.vtkSampleFunction()
shape.SetCoefficients(-0.9, -1.8, -0.9, 0, 0, 0, 0, 0, 0, 0.55)  # denser towards the middle
image.SetImplicitFunction(shape), image.SetSampleDimensions(128, 128, 128), image.ComputeNormalsOff(), image.Update()
cloud = vtk.vtkImageData()
cloud.DeepCopy(image.GetOutput())
density = vtk_to_numpy(cloud.GetPointData().GetScalars())
image.SetImplicitFunction(noise)
for f in 1.5, 3, 6, 12, 24:
    noise.SetFrequency(f, f, f), noise.SetAmplitude(0.9 / f), image.Update()
    density += vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
mapper, volume, ball, surface, actor = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume(), vtk.vtkSphereSource(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
opacity, color = volume.GetProperty().GetScalarOpacity(), volume.GetProperty().GetRGBTransferFunction()
opacity.RemoveAllPoints(), opacity.AddPoint(0, 0), opacity.AddPoint(1, 0.5), color.RemoveAllPoints(), color.AddRGBPoint(0, 0.9, 0.9, 0.92)
volume.GetProperty().SetScalarOpacityUnitDistance(0.05), volume.GetProperty().SetInterpolationTypeToLinear()
mapper.SetInputData(cloud), volume.SetMapper(mapper)
ball.SetRadius(0.4), ball.SetThetaResolution(48), ball.SetPhiResolution(48), surface.SetInputConnection(ball.GetOutputPort()), actor.SetMapper(surface), actor.GetProperty().SetColor(0.9, 0.35, 0.1)
renderer, window, hand = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkRenderWindowInteractor()
renderer.AddVolume(volume), renderer.AddActor(actor), renderer.SetBackground(0.16, 0.3, 0.5)
window.AddRenderer(renderer), window.SetSize(640, 480), hand.SetRenderWindow(window), window.Render(), hand.Start()
