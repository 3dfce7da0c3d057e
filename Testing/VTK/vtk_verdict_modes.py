# SPDX-License-Identifier: BSD-3-Clause
"""Blend modes, types of values, sampling, windows of colour, and changes from picture to picture."""
import numpy
import vtk

import vtk_verdict_data as made
from vtk_verdict import FIXED, GPU, SMART, Different, Same, case, pair
from vtk_verdict_data import image, look

INTENSITIES = dict(alpha=((0, 0), (255, 1)))
THIN = dict(alpha=((0, 0), (20, 0), (255, 0.04)))


def mode(name):
    def settings(mapper):
        getattr(mapper, "SetBlendModeTo" + name)()

    return settings


def waving(**options):
    return look(made.WAVES, made.WAVE_TINTS, **options)


@case("TestGPURayCastAdditive")
def additive():
    return Same(pair(image(made.ball()), look(**THIN), mode("Additive")))


@case("TestGPURayCastAverageIP")
def averages():
    def settings(mapper):
        mapper.SetBlendModeToAverageIntensity()
        mapper.SetAverageIPScalarRange(60, 220)

    return Same(pair(image(), look(**INTENSITIES), settings, step=0.05))


def four(**options):
    """The four modes of intensity. Opacity is 0 at the box's border, of which one pixel more or less is a matter of rounding."""
    fields = image(), image(255 - made.blobs())
    properties = look(**INTENSITIES), look(alpha=((0, 1), (254.9, 0)))
    pairs = []
    for name in "MaximumIntensity", "MinimumIntensity", "AverageIntensity":
        least = name == "MinimumIntensity"
        pairs.append(pair(fields[least], properties[least], mode(name), **options))
    return [*pairs, pair(fields[0], look(**THIN), mode("Additive"), **options)]


@case("TestGPURayCastBlendModes")
def four_modes():
    return Same(*four(step=0.05))


@case("TestGPURayCastCompositeToMIP")
def composite_to_maximum():
    return Same(pair(image(made.ball()), look(shade=True), mode("MaximumIntensity")))


@case("TestGPURayCastMIPToComposite")
def maximum_to_composite():
    def then(volume):
        volume.GetMapper().SetBlendModeToComposite()

    return Same(pair(image(made.ball()), look(), mode("MaximumIntensity"), then=then))


@case("TestMinIntensityRendering")
def minimum():
    clip = vtk.vtkImageClip()
    clip.SetInputData(image(255 - made.blobs()))
    clip.SetOutputWholeExtent(0, 39, 0, 39, 14, 22)
    clip.ClipDataOn(), clip.Update()
    shown = look(alpha=((0, 1), (250, 0)))
    return Same(pair(clip.GetOutput(), shown, mode("MinimumIntensity"), kind=FIXED))


DTYPES = numpy.uint8, numpy.int8, numpy.uint16, numpy.int16, numpy.uint32, numpy.int32, numpy.float32, numpy.float64


def types(blend, linear=True, dtypes=DTYPES):
    """Pairs of the ball over the whole range of each type; of the types with a point, from -3 to 5."""
    pairs = []
    base = made.ball(24).astype(float) / 255
    for dtype in dtypes:
        whole = numpy.issubdtype(dtype, numpy.integer)
        low, high = (float(numpy.iinfo(dtype).min), float(numpy.iinfo(dtype).max)) if whole else (-3.0, 5.0)
        values = low + (high - low) * (1 - base if blend == "MinimumIntensity" else base)
        ends = (0.9, 0) if blend == "MinimumIntensity" else (0, 0.9)
        shown = look(alpha=((low, ends[0]), (high, ends[1])), tints=((low, 0, 0, 1), (high, 1, 0.8, 0)), linear=linear)
        pairs.append(pair(image((values.round() if whole else values).astype(dtype)), shown, mode(blend)))
    return pairs


@case("TestGPURayCastDataTypesMIP")
def types_by_maximum():
    return Same(*types("MaximumIntensity"))


@case("TestGPURayCastDataTypesMinIP")
def types_by_minimum():
    return Same(*types("MinimumIntensity"))


@case("TestGPURayCastNearestDataTypesMIP")
def types_by_nearest():
    return Different(types("MaximumIntensity", False), types("MaximumIntensity", dtypes=DTYPES[2:4]))


@case("TestGPURayCastPerspectiveParallel")
def projections():
    def parallel(renderer, camera):
        renderer.ResetCamera()
        camera.Azimuth(25), camera.Elevation(15)
        camera.ParallelProjectionOn()
        camera.SetParallelScale(18)

    return Same(pair(image(made.ball()), look()), pair(image(made.ball()), look(), camera=parallel))


@case("TestGPURayCastMapperSampleDistance")
def long_steps():
    def coarse(mapper):
        mapper.SetSampleDistance(3)

    return Different([pair(image(made.waves()), waving(), coarse)], [pair(image(made.waves()), waving())])


@case("TestGPURayCastMapperBenchmark")
def benchmark():
    def outside(renderer, camera):
        renderer.ResetCamera()
        camera.SetViewUp(0, 1, 0)

    return Same(pair(image(made.waves()), waving(), camera=outside))


@case("TestGPUVolumeRayCastMapper")
def wavelet():
    return Same(pair(image(made.waves(21)), waving(unit=1.732)))


@case("TestSmartVolumeMapper")
def smart():
    switched = pair(image(made.ball()), look(), kind=SMART, then=lambda volume: volume.GetMapper().SetBlendModeToMaximumIntensity())
    return Same(pair(image(made.ball()), look(), kind=SMART), switched)


@case("TestSmartVolumeMapperWindowLevel")
def smart_window():
    def window(mapper):
        mapper.SetBlendModeToMaximumIntensity()
        mapper.SetFinalColorWindow(0.2)
        mapper.SetFinalColorLevel(0.75)

    bright = look(alpha=((0, 0), (255, 1)), tints=((0, 0.6, 0.65, 0.7), (255, 0.9, 0.75, 0.8)))
    return Same(pair(image(), bright, mode("MaximumIntensity"), kind=SMART), pair(image(), bright, window, kind=SMART))


@case("TestFinalColorWindowLevel")
def window():
    def settings(mapper):
        mapper.SetFinalColorWindow(0.5)
        mapper.SetFinalColorLevel(0.75)

    return Same(pair(image(), look(unit=2), settings, kind=FIXED, step=0.2))


def another_input(kind):
    def then(volume):
        volume.GetMapper().SetInputData(image(made.blobs(20, 0.1), spacing=(2, 2, 2)))

    return Same(pair(image(), look(), kind=kind, then=then))


@case("TestGPURayCastVolumeUpdate")
def input_of_gpu():
    return another_input(GPU)


@case("TestSmartVolumeMapperVolumeUpdate")
def input_of_smart():
    return another_input(SMART)


@case("TestGPURayCastChangedArray")
def another_array():
    data = image()
    other = vtk.vtkFloatArray()
    other.DeepCopy(data.GetPointData().GetScalars())
    for i in range(0, other.GetNumberOfValues()):
        other.SetValue(i, 255 - other.GetValue(i))
    other.SetName("other")
    data.GetPointData().AddArray(other)

    def settings(mapper):
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectScalarArray("values")

    return Same(pair(data, look(unit=4), settings, then=lambda volume: volume.GetMapper().SelectScalarArray("other")))


@case("TestGPURayCastReleaseResources")
def released():
    def then(volume):
        window = vtk.vtkRenderWindow()
        volume.GetMapper().ReleaseGraphicsResources(window)

    return Same(pair(image(made.waves()), waving(), then=then))


@case("TestGPURayCastJittering", "TestGPURayCastToggleJittering")
def jitter():
    def settings(mapper):
        mapper.SetUseJittering(1)
        mapper.SetSampleDistance(2)

    def toggled(volume):
        volume.GetMapper().SetUseJittering(0)
        volume.GetMapper().SetSampleDistance(0.1)

    return Different([pair(image(), look(), settings)], [pair(image(), look(), settings, then=toggled)])


@case("TestGPURayCastIsosurface")
def contours():
    shown = look(alpha=((60, 0.2), (120, 0.5), (200, 1)), tints=made.TINTS, shade=True)
    shown.GetIsoSurfaceValues().SetValue(0, 120)

    def then(volume):
        values = volume.GetProperty().GetIsoSurfaceValues()
        values.SetNumberOfContours(0)
        for i, value in enumerate((60, 120, 200)):
            values.SetValue(i, value)

    both = []
    for change in None, then:
        shown.GetIsoSurfaceValues().SetNumberOfContours(0)
        shown.GetIsoSurfaceValues().SetValue(0, 120)
        both.append(pair(image(made.ball()), shown, mode("IsoSurface"), then=change, step=0.05))
    return Same(*both)


@case("TestGPURayCastLargeColorTransferFunction")
def large_colours():
    count = 1100
    palette = numpy.random.default_rng(3).uniform(0, 1, (count, 3))
    tints, alpha = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for i in range(count):
        tints.AddRGBPoint(i, *palette[i])
        alpha.AddPoint(i, 0.1 if i % 7 else 0)
    z, y, x = made.grid(40)
    shown = look()
    shown.SetColor(tints), shown.SetScalarOpacity(alpha)
    return Same(pair(image((4 + 20 * (x + y + 2)).astype(numpy.float32)), shown, step=0.05))


@case("cursor3D")
def cursor():
    source = vtk.vtkImageCursor3D()
    source.SetInputData(image())
    source.SetCursorPosition(18, 16, 20), source.SetCursorValue(255), source.SetCursorRadius(16)
    source.Update()
    return Same(pair(source.GetOutput(), look(alpha=((20, 0), (255, 0.2))), kind=FIXED, step=0.5))


@case("gaussian")
def orbitals():
    def parallel(renderer, camera):
        renderer.ResetCamera()
        camera.Azimuth(-70), camera.Elevation(10)
        camera.ParallelProjectionOn()
        camera.SetParallelScale(18)

    shown = look(alpha=((0, 0.01), (255, 0.35)))
    shown.GetScalarOpacity().ClampingOn()
    return Same(pair(image(), shown, kind=GPU, camera=parallel))
