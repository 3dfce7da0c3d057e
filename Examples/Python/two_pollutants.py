# SPDX-License-Identifier: BSD-3-Clause
# One plume, two pollutants: soot falls out as the plume drifts, ozone forms in it. An array of two components, each with its own functions:
# two_pollutants.py [OUT.png]
import sys, numpy, stratus, vtk
from vtk.util.numpy_support import numpy_to_vtk

z, y, x = numpy.meshgrid(*[numpy.linspace(0, 1, n, dtype=numpy.float32) for n in (64, 64, 160)], indexing="ij", sparse=True)
ripple = numpy.sin(23 * x + 5 * z) * numpy.cos(31 * y) + numpy.sin(37 * z - 17 * x) * numpy.cos(19 * y - 11 * x)
away = ((y - 0.5) ** 2 + (z - 0.3 - 0.35 * numpy.sqrt(x)) ** 2) / (0.04 + 0.22 * x) ** 2 + 0.25 * ripple * numpy.sqrt(x)
plume = numpy.maximum(0, 1 - away) * numpy.minimum(1, 30 * x)
soot = plume * numpy.exp(-4 * x)
ozone = plume * (1 - numpy.exp(-3 * x)) * numpy.minimum(1, 2.5 * (1 - x))
values = numpy.stack([soot, ozone], axis=-1)

image, volume = vtk.vtkImageData(), vtk.vtkVolume()
image.SetDimensions(160, 64, 64)
image.GetPointData().SetScalars(numpy_to_vtk(values.reshape(-1, 2)))  # over NumPy's memory
mapper, look = stratus.vtkStratusVolumeMapper(), volume.GetProperty()
mapper.SetInputData(image), volume.SetMapper(mapper)
look.IndependentComponentsOn(), look.SetInterpolationTypeToLinear()
for component, (low, top, dense, rgb) in enumerate([(0.03, 0.5, 0.6, (0.2, 0.13, 0.1)), (0.05, 0.7, 0.3, (0.8, 0.62, 0.1))]):
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    opacity.AddPoint(low, 0), opacity.AddPoint(top, dense), color.AddRGBPoint(0, *rgb)
    look.SetScalarOpacity(component, opacity), look.SetColor(component, color), look.SetComponentWeight(component, 1)
    look.SetScalarOpacityUnitDistance(component, 3)
renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
renderer.AddVolume(volume), renderer.SetBackground(0.85, 0.9, 0.95), renderer.SetBackground2(0.55, 0.68, 0.82), renderer.GradientBackgroundOn()
window.AddRenderer(renderer), window.SetSize(900, 420)
camera = renderer.GetActiveCamera()
camera.SetPosition(0, -1, 0.2), camera.SetFocalPoint(0, 0, 0), camera.SetViewUp(0, 0, 1), camera.Azimuth(-18)
renderer.ResetCamera(), camera.Zoom(1.75), window.Render()
if len(sys.argv) > 1:
    picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    picture.SetInput(window), writer.SetInputConnection(picture.GetOutputPort()), writer.SetFileName(sys.argv[1]), writer.Write()
else:
    hand = vtk.vtkRenderWindowInteractor()
    hand.SetRenderWindow(window), hand.Start()
