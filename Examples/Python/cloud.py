# SPDX-License-Identifier: BSD-3-Clause
# A cloud with an opaque ball in it, to turn with the mouse, or in a picture: cloud.py [OUT.png]
import sys, stratus, vtk
from vtk.util.numpy_support import vtk_to_numpy
shape, noise, image, cloud = vtk.vtkQuadric(), vtk.vtkPerlinNoise(), vtk.vtkSampleFunction(), vtk.vtkImageData()
shape.SetCoefficients(-0.9, -1.8, -0.9, 0, 0, 0, 0, 0, 0, 0.55)  # denser towards the middle
image.SetImplicitFunction(shape), image.SetSampleDimensions(128, 128, 128), image.ComputeNormalsOff(), image.Update()
cloud.DeepCopy(image.GetOutput()), image.SetImplicitFunction(noise)
for f in 1.5, 3, 6, 12, 24:
    noise.SetFrequency(f, f, f), noise.SetAmplitude(0.9 / f), image.Update()
    vtk_to_numpy(cloud.GetPointData().GetScalars())[:] += vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
mapper, volume = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume()
ball, surface, actor = vtk.vtkSphereSource(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
opacity, color = volume.GetProperty().GetScalarOpacity(), volume.GetProperty().GetRGBTransferFunction()
opacity.RemoveAllPoints(), opacity.AddPoint(0, 0), opacity.AddPoint(1, 0.5), color.RemoveAllPoints(), color.AddRGBPoint(0, 0.9, 0.9, 0.92)
volume.GetProperty().SetScalarOpacityUnitDistance(0.05), volume.GetProperty().SetInterpolationTypeToLinear()
mapper.SetInputData(cloud), volume.SetMapper(mapper)
ball.SetRadius(0.4), ball.SetThetaResolution(48), ball.SetPhiResolution(48), surface.SetInputConnection(ball.GetOutputPort())
actor.SetMapper(surface), actor.GetProperty().SetColor(0.9, 0.35, 0.1)
renderer, window, hand = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkRenderWindowInteractor()
picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
renderer.AddVolume(volume), renderer.AddActor(actor), renderer.SetBackground(0.16, 0.3, 0.5)
window.AddRenderer(renderer), window.SetSize(640, 480), hand.SetRenderWindow(window), window.Render()
if len(sys.argv) > 1: picture.SetInput(window), writer.SetInputConnection(picture.GetOutputPort()), writer.SetFileName(sys.argv[1]), writer.Write()
else: hand.Start()
