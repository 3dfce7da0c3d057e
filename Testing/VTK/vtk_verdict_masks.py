# SPDX-License-Identifier: BSD-3-Clause
"""Masks, label maps, and functions of two variables."""
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk

import vtk_verdict_data as made
from vtk_verdict import Different, Same, case, nothing, pair, refusal
from vtk_verdict_data import colors, image, look, opacity
from vtk_verdict_light import SHINY
from vtk_verdict_modes import mode


def mask(array, label=False, blend=1.0, then=None):
    def settings(mapper):
        mapper.SetMaskInput(image(array.astype(numpy.uint8)))
        mapper.SetMaskTypeToLabelMap() if label else mapper.SetMaskTypeToBinary()
        mapper.SetMaskBlendFactor(blend)
        if then is not None:
            then(mapper)

    return settings


def half():
    z, y, x = made.grid(40)
    return 255 * (x + 0.3 * y < 0.1)


def labels():
    z, y, x = made.grid(40)
    return numpy.where(x * x + y * y + (z - 0.1) ** 2 < 0.3, 1, 0) + numpy.where(x > 0.55, 2, 0)


def checks():
    z, y, x = numpy.indices((40, 40, 40))
    return numpy.where((x // 8 + y // 8 + z // 8) % 2, (x % 5 == 0) | (y % 5 == 0), 2 * ((x % 6 == 0) | (z % 6 == 0)))


@case("TestGPURayCastCompositeBinaryMask")
def binary():
    return Same(pair(image(), look(), mask(half())))


@case("TestGPURayCastCompositeBinaryMask1")
def binary_then_colours():
    def then(volume):
        volume.GetProperty().GetRGBTransferFunction(0).SetNodeValue(0, [0, 1, 0, 0.5, 0.5, 0])

    return Same(*(pair(image(), look(tints=((0, 0.2, 0.5, 0.2), (255, 0.1, 0.2, 0.9))), mask(half()), then=then),))


@case("TestGPURayCastMIPBinaryMask")
def binary_maximum():
    return Same(pair(image(), look(alpha=((0, 0), (255, 1))), mask(half(), then=mode("MaximumIntensity"))))


def labelled(count=2, unit=1, **options):
    """A look with functions of labels, whose opacities are per `unit`."""
    shown = look(alpha=((0, 0), (20, 0), (255, 0.25 * unit)), unit=unit, **options)
    functions = ((0, 0), (40, 0), (255, 0.2 * unit)), ((0, 0), (20, 0), (255, 0.15 * unit))
    tints = ((0, 1, 1, 0), (255, 1, 0, 0)), ((0, 0, 1, 1), (255, 0, 0, 1))
    for label in range(count):
        shown.SetLabelColor(label + 1, colors(*tints[label]))
        shown.SetLabelScalarOpacity(label + 1, opacity(*functions[label]))
    return shown


def by_labels(array, count=2, **options):
    """VTK takes the opacity of labels per sample; where a sample is a unit of opacity, that is no difference."""
    settings = mask(array, True)
    return Different([pair(image(), labelled(count, **options), settings, step=0.25)],
                     [pair(image(), labelled(count, 0.25, **options), settings, step=0.25)])


@case("TestGPURayCastCompositeMask")
def label_map():
    return by_labels(checks())


@case("TestGPURayCastCompositeMaskBlend", "TestGPURayCastTextureStreamingMask")
def label_map_blended():
    return refusal(image(), labelled(), mask(checks(), True, 0.1))


@case("TestGPURayCastLabelMap")
def label_map_lit():
    return by_labels(labels(), shade=True, **SHINY)


@case("TestGPURayCastLabelMap1Label")
def one_label():
    return by_labels(labels() == 1, 1, shade=True, **SHINY)


def table(unit=1, bins=128):
    """RGBA over value and gradient: more colour with the value, more opacity with the gradient."""
    values, gradients = numpy.meshgrid(numpy.linspace(0, 1, bins), numpy.linspace(0, 1, bins))
    rgba = numpy.stack([values, 1 - values, 0.5 + 0 * values, 0.3 * unit * values * (0.3 + 0.7 * gradients)], -1)
    made_table = vtk.vtkImageData()
    made_table.SetDimensions(bins, bins, 1)
    made_table.GetPointData().SetScalars(numpy_to_vtk(rgba.reshape(-1, 4).astype(numpy.float32), deep=True))
    return made_table


def two_dimensional(unit=1):
    shown = look(alpha=((0, 0), (255, 0.3)), unit=unit)
    shown.SetTransferFunctionMode(shown.TF_2D)
    shown.SetTransferFunction2D(table(unit))
    return shown


def by_table(data, settings=nothing):
    """VTK takes these opacities per sample, too."""
    return Different([pair(data, two_dimensional(), settings, step=0.25)], [pair(data, two_dimensional(0.25), settings, step=0.25)])


@case("TestGPURayCastTransfer2D")
def by_gradient():
    return by_table(image())


@case("TestGPURayCastTransfer2DYScalars")
def by_second_array():
    data = image()
    second = numpy_to_vtk(numpy.ascontiguousarray(made.waves()).ravel(), deep=True)
    second.SetName("second")
    data.GetPointData().AddArray(second)
    return by_table(data, lambda mapper: mapper.SetTransfer2DYAxisArray("second"))
