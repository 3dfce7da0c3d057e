# SPDX-License-Identifier: BSD-3-Clause
"""Random paths in a window. Each picture of an unchanged scene adds paths to the last one, until the standard error is at most the tolerance.
What they show is what the composite mode computes of single scattering."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import ball, check, done

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

SIDE = 48


def make_image():
    image = vtk.vtkImageData()
    image.SetDimensions(24, 24, 24)
    values = numpy_to_vtk(ball((24, 24, 24), (11.5, 11.5, 11.5), 11).ravel(), deep=1)
    image.GetPointData().SetScalars(values)
    return image


class Scene:
    def __init__(self, mapper, settings):
        self.mapper, self.settings = mapper, settings
        self.refined = []
        settings.AddObserver("UpdateEvent", lambda *_: self.refined.append(settings.GetPathSamples()))
        self.errors = []
        mapper.AddObserver("ErrorEvent", lambda *_: self.errors.append(1))
        self.property = vtk.vtkVolumeProperty()
        opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
        opacity.AddPoint(0, 0)
        opacity.AddPoint(1, 0.3)
        color.AddRGBPoint(0, 1, 0.8, 0.6)
        self.property.SetScalarOpacity(opacity)
        self.property.SetColor(color)
        self.property.SetInterpolationTypeToLinear()
        self.property.ShadeOn()
        self.property.SetAmbient(0)
        self.property.SetDiffuse(0.9)
        volume = vtk.vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(self.property)
        self.renderer, self.window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
        self.renderer.AddVolume(volume)
        sun = vtk.vtkLight()
        sun.SetLightTypeToSceneLight()
        sun.SetPosition(300, -100, 200)
        sun.SetFocalPoint(0, 0, 0)
        sun.SetColor(1, 0.9, 0.7)
        self.renderer.AutomaticLightCreationOff()
        self.renderer.AddLight(sun)
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(SIDE, SIDE)
        self.window.AddRenderer(self.renderer)
        self.renderer.ResetCamera()

    def draw(self):
        """RGBA of the mapper's picture, and RGB of the window in 0..1."""
        self.window.Render()
        image = self.mapper.GetLastImage()
        rgba = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(SIDE, SIDE, 4).astype(float) if image else None
        pixels = vtk.vtkUnsignedCharArray()
        self.window.GetRGBACharPixelData(0, 0, SIDE - 1, SIDE - 1, 0, pixels)
        return rgba, vtk_to_numpy(pixels).reshape(SIDE, SIDE, 4)[..., :3] / 255.0


mapper = stratus.vtkStratusVolumeMapper()
mapper.SetInputData(make_image())
mapper.SetVolumetricScatteringBlending(2)
mapper.SetScatteringAnisotropy(0.4)
scene = Scene(mapper, mapper)
single, _ = scene.draw()
check(numpy.isnan(mapper.GetPathError()) and mapper.GetPathSamples() == 0, "no paths before the first")

mapper.SetRenderModeToPath()
check(mapper.GetRenderModeAsString() == "path", mapper.GetRenderModeAsString())
mapper.SetPathSeconds(0)
mapper.SetPathTolerance(0.02)
samples, errors, pictures = [], [], 0
while not samples or not mapper.GetPathFinished():
    paths, window = scene.draw()
    pictures += 1
    samples.append(mapper.GetPathSamples())
    errors.append(mapper.GetPathError())
    check(pictures < 10000, "the tolerance is reached")
check(samples[0] == 2 and all(b == a + 1 for a, b in zip(samples, samples[1:])), f"a picture without time adds one path: {samples[:5]}")
check(scene.refined == samples[:-1], f"an unfinished picture asks for another: {len(scene.refined)} of {len(samples)}")
check(errors[-1] <= 0.02 < errors[len(errors) // 4] and errors[0] > errors[-1], f"the error falls: {errors[0]}, {errors[-1]}")
lit = (paths[..., 3] > 0) | (single[..., 3] > 0)
off = numpy.sqrt(((paths - single) ** 2)[lit].mean())
print(f"{samples[-1]} paths a pixel, standard error {errors[-1]:.4f}, {off:.4f} from composite")
check(off < 1.2 * errors[-1] + 0.002, "paths of one scattering show what composite does")
check(numpy.abs(window - numpy.clip(paths[..., :3], 0, 1)).max() < 0.003, "the window shows the picture")

before = samples[-1]
again, _ = scene.draw()
same = mapper.GetPathSamples() == before and len(scene.refined) == len(samples) - 1 and (again == paths).all()
check(same, "a finished picture stays as it is")
scene.renderer.GetActiveCamera().Azimuth(20)
scene.draw()
check(mapper.GetPathSamples() == 2, "another camera begins anew")
mapper.SetPathSeconds(1e6)
more, _ = scene.draw()
check(mapper.GetPathFinished() and mapper.GetPathError() <= 0.02, "with enough time one picture is finished")
once = mapper.GetPathSamples()
mapper.MultipleScatteringOn()
many, _ = scene.draw()
check(many[..., :3].sum() > 1.05 * more[..., :3].sum() and mapper.GetPathSamples() != 0, "any number of scatterings is brighter than one")
plane = vtk.vtkPlane()
plane.SetOrigin(12, 12, 12)
mapper.AddClippingPlane(plane)
cut, _ = scene.draw()
check(0.1 * many[..., 3].sum() < cut[..., 3].sum() < 0.95 * many[..., 3].sum(), "clip planes cut what paths see")
check(not scene.errors, "no error so far")
mapper.RemoveAllClippingPlanes()
mapper.SetVolumetricScatteringBlending(0)
alone, _ = scene.draw()
check(abs(alone[..., :3].sum() / many[..., :3].sum() - 1) < 0.02, "the number of scatterings depends on no blending")

scene.renderer.GetCullers().RemoveAllItems()  # which allot times
scene.window.SetDesiredUpdateRate(1)
mapper.SetPathTolerance(0)
mapper.SetPathSeconds(2)
for turn in range(2):
    scene.renderer.GetActiveCamera().Azimuth(5)
    scene.draw()
    check(mapper.GetUsedImageSampleDistance() == 1, "paths that fill their time make no picture coarser")
scene.window.SetDesiredUpdateRate(1e-4)
mapper.SetPathSeconds(0)

table = vtk.vtkImageData()
table.SetDimensions(2, 2, 1)
table.AllocateScalars(vtk.VTK_FLOAT, 4)
scene.property.SetTransferFunction2D(table)
scene.property.SetTransferFunctionMode(vtk.vtkVolumeProperty.TF_2D)
scene.draw()
check(len(scene.errors) == 1 and mapper.GetLastImage() is None, "paths are of functions of one variable alone")
scene.property.SetTransferFunctionMode(vtk.vtkVolumeProperty.TF_1D)
scene.draw()
check(len(scene.errors) == 1 and mapper.GetLastImage() is not None, "of which there is one again")
scene.errors.clear()

mapper.SetBlendModeToMaximumIntensity()
scene.draw()
check(len(scene.errors) == 1 and mapper.GetLastImage() is None, "paths are of the composite blend mode alone")

blocks, pieces = stratus.vtkStratusMultiBlockVolumeMapper(), vtk.vtkMultiBlockDataSet()
pieces.SetBlock(0, make_image())
moved = make_image()
moved.SetOrigin(23, 0, 0)
pieces.SetBlock(1, moved)
blocks.SetInputDataObject(pieces)
blocks.GetSettings().SetRenderModeToPath()
scene = Scene(blocks, blocks.GetSettings())
scene.window.Render()
check(scene.errors == [1], "paths do not go through blocks")
done()
