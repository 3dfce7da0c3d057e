# SPDX-License-Identifier: BSD-3-Clause
# A cloud, the ground and a balloon shadow one another in the light of a low sun: shadows.py [OUT.png]; without OUT.png to turn with the mouse.
import sys
import stratus, vtk
from vtk.util.numpy_support import vtk_to_numpy

shape, noise, image, cloud = vtk.vtkQuadric(), vtk.vtkPerlinNoise(), vtk.vtkSampleFunction(), vtk.vtkImageData()
shape.SetCoefficients(-0.8, -0.8, -4, 0, 0, 0, 0, 0, 0, 0.5)  # a flat cloud, denser towards the middle
image.SetImplicitFunction(shape), image.SetSampleDimensions(128, 128, 64), image.SetModelBounds(-1, 1, -1, 1, -0.5, 0.5)
image.ComputeNormalsOff(), image.Update(), cloud.DeepCopy(image.GetOutput()), image.SetImplicitFunction(noise)
for f in 1.5, 3, 6, 12:
    noise.SetFrequency(f, f, f), noise.SetAmplitude(0.9 / f), image.Update()
    vtk_to_numpy(cloud.GetPointData().GetScalars())[:] += vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())

mapper, volume, sun, weak = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume(), vtk.vtkLight(), vtk.vtkLight()
look, opacity, color = volume.GetProperty(), vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
opacity.AddPoint(0, 0), opacity.AddPoint(1, 0.6), color.AddRGBPoint(0, 1, 1, 1)
look.SetScalarOpacity(opacity), look.SetColor(color), look.SetScalarOpacityUnitDistance(0.05), look.SetInterpolationTypeToLinear()
look.ShadeOn(), look.SetAmbient(0), look.SetDiffuse(1)
mapper.SetInputData(cloud), volume.SetMapper(mapper), volume.SetPosition(0, 0, 0.7)
mapper.SetVolumetricScatteringBlending(2)  # all light is scattered, with shadows; surfaces of the scene take part by themselves
mapper.MultipleScatteringOn(), mapper.SetSkyZenith(0.1, 0.15, 0.25), mapper.SetSkyHorizon(0.12, 0.14, 0.17)
mapper.ScreenEncodingOn()  # scattered light is linear
sun.SetLightTypeToSceneLight(), sun.SetPosition(9, -5, 9), sun.SetFocalPoint(0, 0, 0), sun.SetColor(1, 0.95, 0.85)
weak.DeepCopy(sun), weak.SetColor(0.3, 0.28, 0.25), mapper.SetSun(weak)  # a light of 1 / pi lights a cloud as one of 1 does a surface in VTK

renderer, window, hand = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkRenderWindowInteractor()
ground, balloon = vtk.vtkPlaneSource(), vtk.vtkSphereSource()
ground.SetOrigin(-3, -3, 0), ground.SetPoint1(3, -3, 0), ground.SetPoint2(-3, 3, 0)
balloon.SetCenter(0.85, -0.4, 1.4), balloon.SetRadius(0.16), balloon.SetThetaResolution(48), balloon.SetPhiResolution(48)
for source, rgb in (ground, (0.6, 0.75, 0.45)), (balloon, (0.85, 0.25, 0.15)):
    surface, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
    surface.SetInputConnection(source.GetOutputPort()), actor.SetMapper(surface), actor.GetProperty().SetColor(rgb), renderer.AddActor(actor)
renderer.AutomaticLightCreationOff(), renderer.AddLight(sun), renderer.AddVolume(volume)
renderer.SetBackground(0.62, 0.74, 0.85), renderer.SetBackground2(0.3, 0.5, 0.75), renderer.GradientBackgroundOn()
camera = renderer.GetActiveCamera()
camera.SetPosition(-1.6, -4.6, 1.9), camera.SetFocalPoint(0, 0, 0.5), camera.SetViewUp(0, 0, 1), renderer.ResetCameraClippingRange()
window.AddRenderer(renderer), window.SetSize(800, 500), hand.SetRenderWindow(window), window.Render()
picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
if len(sys.argv) > 1: picture.SetInput(window), writer.SetInputConnection(picture.GetOutputPort()), writer.SetFileName(sys.argv[1]), writer.Write()
else: hand.Start()
