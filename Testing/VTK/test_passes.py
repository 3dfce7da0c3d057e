# SPDX-License-Identifier: BSD-3-Clause
"""Render passes, which draw the scene into frame buffers of their own. A volume with opaque balls before, inside and behind it shows under each
pass, covers no ball that is in front, and looks as vtkFixedPointVolumeRayCastMapper's volume does. (FixedPoint covers balls under passes, which
is a small part of these pictures.)"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

SIDE = 128  # a power of two, beyond which FixedPoint stretches its picture


def field():
    """A smooth volume of 40 x 30 x 20 points."""
    z, y, x = numpy.mgrid[0:20, 0:30, 0:40].astype(float)
    values = (numpy.sin(7 * x / 39) * numpy.sin(9 * y / 29 + 1) * numpy.sin(8 * z / 19 + 2) + 1) * 100
    image = vtk.vtkImageData()
    image.SetDimensions(40, 30, 20)
    image.SetSpacing(1, 1.3, 2)
    image.GetPointData().SetScalars(numpy_to_vtk(values.astype(numpy.float32).ravel(), deep=1))
    return image


def look():
    """What the volume looks like."""
    made = vtk.vtkVolumeProperty()
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for point in ((0, 0), (110, 0), (200, .15)):
        opacity.AddPoint(*point)
    for point in ((0, .1, .2, .9), (110, .2, .9, .3), (200, 1, .4, .1)):
        color.AddRGBPoint(*point)
    made.SetScalarOpacity(opacity)
    made.SetColor(color)
    made.SetInterpolationTypeToLinear()
    return made


def ball(place, radius, color, opacity=1):
    """An actor."""
    source, mapper, actor = vtk.vtkSphereSource(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
    source.SetCenter(*place)
    source.SetRadius(radius)
    source.SetThetaResolution(24)
    source.SetPhiResolution(24)
    mapper.SetInputConnection(source.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*color)
    actor.GetProperty().SetOpacity(opacity)
    return actor


class Scene:
    """A window in which either mapper or none draws the volume, under one pass after the other."""

    def __init__(self, samples=0, peels=False, viewport=None):
        self.window, self.renderer, self.volume = vtk.vtkRenderWindow(), vtk.vtkRenderer(), vtk.vtkVolume()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(samples)
        self.window.SetSize(SIDE, SIDE)
        if viewport:
            self.window.SetSize(2 * SIDE, 2 * SIDE)
            self.renderer.SetViewport(*viewport)
        self.window.AddRenderer(self.renderer)
        self.renderer.SetBackground(.1, .2, .1)
        self.ours, self.fixed = stratus.vtkStratusVolumeMapper(), vtk.vtkFixedPointVolumeRayCastMapper()
        self.ours.SetDevice("host")
        self.fixed.SetAutoAdjustSampleDistances(0)
        self.fixed.SetSampleDistance(.25)
        self.fixed.SetImageSampleDistance(1)
        self.said = []

        def keep(_caller, _event, text):
            self.said.append(text)
        keep.CallDataType = "string0"
        for event in ("ErrorEvent", "WarningEvent"):
            self.ours.AddObserver(event, keep)
        self.volume.SetProperty(look())
        for mapper in (self.ours, self.fixed):
            mapper.SetInputData(field())
        self.volume.SetMapper(self.ours)
        self.renderer.AddVolume(self.volume)
        for actor in (ball((25, 3, 45), 6, (1, 1, 1)), ball((19, 19, 18), 8, (.9, .9, .2)), ball((10, 33, -7), 6, (.2, .9, .9))):
            self.renderer.AddActor(actor)
        if peels:
            self.renderer.AddActor(ball((15, 13, 33), 7, (1, .2, .8), .4))
            self.renderer.SetUseDepthPeeling(1)
            self.renderer.SetUseDepthPeelingForVolumes(1)
        self.renderer.ResetCamera()
        camera = self.renderer.GetActiveCamera()
        camera.Azimuth(30)
        camera.Elevation(20)
        self.renderer.ResetCameraClippingRange()

    def draw(self, mapper, render_pass):
        """The window's bytes; mapper None: without the volume."""
        self.volume.SetVisibility(mapper is not None)
        if mapper:
            self.volume.SetMapper(mapper)
        self.renderer.SetPass(render_pass)
        self.window.Render()
        self.window.Render()
        pixels = vtk.vtkUnsignedCharArray()
        width, height = self.window.GetSize()
        self.window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, pixels)
        self.renderer.SetPass(None)
        return vtk_to_numpy(pixels).reshape(height, width, 4)[..., :3].astype(int)

    def compare(self, render_pass):
        """Returns mean distances, of 255: of our picture from FixedPoint's, and from the picture without a volume, in all pixels and in the pixels
        of a ball in front, without its border."""
        ours, fixed, none = (self.draw(mapper, render_pass) for mapper in (self.ours, self.fixed, None))
        if render_pass is None:  # the first call marks the pixels that a ball in front covers
            self.front = (numpy.abs(ours - none).max(2) == 0) & (numpy.abs(none - none[2, -2]).max(2) > 8)
            for _ in range(3):
                self.front[1:-1, 1:-1] &= self.front[:-2, 1:-1] & self.front[2:, 1:-1] & self.front[1:-1, :-2] & self.front[1:-1, 2:]
            check(self.front.sum() > 20, f"a ball is in front, {self.front.sum()} pixels")
        return numpy.abs(ours - fixed).mean(), numpy.abs(ours - none).mean(), numpy.abs(ours - none)[self.front].mean()


def over(name, inner=None):
    """A pass by its name over another one; None where this VTK has it not."""
    kind = getattr(vtk, name, None)
    if kind is None:
        return None
    made = kind()
    made.SetDelegatePass(inner or vtk.vtkRenderStepsPass())
    if name == "vtkSSAOPass":
        made.SetRadius(5)
    return made


NAMES = ("vtkCameraPass", "vtkSSAAPass", "vtkGaussianBlurPass", "vtkEDLShading", "vtkToneMappingPass", "vtkDepthOfFieldPass", "vtkSSAOPass",
         "vtkOpenGLFXAAPass")


def every_pass(scene, names, where):
    """Each of the passes, compared with pictures without a pass."""
    plain, shown, _ = scene.compare(None)
    check(shown > 0.3, f"{where}: the volume shows without a pass, {shown:.1f}")
    for name in names:
        render_pass = over(name) if isinstance(name, str) else over(name[0], over(name[1]))
        if render_pass is None:
            continue
        apart, shows, covers = scene.compare(render_pass)
        render_pass.ReleaseGraphicsResources(scene.window)
        print(f"{where} {name}: {apart:.2f} from FixedPoint, {shows:.1f} from nothing, {covers:.2f} in front; without {plain:.2f}, {shown:.1f}")
        if name != "vtkSSAOPass":  # under which FixedPoint of VTK 9.1 draws a black window
            check(apart < plain + 1.0, f"{where}, {name}: {apart:.2f} of 255 from FixedPoint, {plain:.2f} without the pass")
        if name != "vtkEDLShading":  # which shades by the size of the scene, volume included
            check(covers < 1.0, f"{where}, {name}: the volume covers a ball in front by {covers:.2f} of 255")
        check(shows > 0.5 * shown, f"{where}, {name}: the volume shows by {shows:.1f}, {shown:.1f} without the pass")
    check(not scene.said, f"{where}: {scene.said[:2]}")


every_pass(Scene(), NAMES + (("vtkSSAAPass", "vtkGaussianBlurPass"),), "one sample a pixel")
every_pass(Scene(samples=8), ("vtkSSAAPass", "vtkEDLShading"), "eight samples a pixel")
every_pass(Scene(peels=True), ("vtkSSAAPass",), "peels")
every_pass(Scene(viewport=(.5, .25, 1, .75)), ("vtkGaussianBlurPass", "vtkSSAAPass"), "a part of the window")
done()
