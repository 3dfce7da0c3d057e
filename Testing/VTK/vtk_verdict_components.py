# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of two to four components."""
import numpy
import vtk

import vtk_verdict_data as made
from vtk_verdict import FIXED, GPU, SMART, Better, Different, Same, case, differences, nothing, pair, picture
from vtk_verdict_cuts import crop
from vtk_verdict_data import colors, image, look, opacity
from vtk_verdict_light import SHINY
from vtk_verdict_modes import mode

SOME = (1, 0.2, 0.1), (0.1, 0.9, 0.2), (0.2, 0.3, 1), (0.9, 0.8, 0.1)


def independent(count, most=0.2, scale=1, **options):
    shown = look(alpha=((0, 0), (scale, most)), tints=((0, 0, 0, 0), (scale, 1, 1, 1)), **options)
    for i in range(count):
        shown.SetScalarOpacity(i, opacity((0, 0), (scale, most)))
        shown.SetColor(i, colors((0, *(0.3 * c for c in SOME[i])), (scale, *SOME[i])))
        shown.SetShade(i, bool(options.get("shade")))
    return shown


def rgba(n=32):
    z, y, x = made.grid(n)
    value = made.blobs(n) / 255
    parts = [0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.5 + 0.5 * z, value]
    return (255 * numpy.stack(parts, -1)).round().astype(numpy.uint8)


def dependent(**options):
    return look(IndependentComponents=0, **options)


def mean(mapper):
    if hasattr(mapper, "SetComponentMixingToMean"):
        mapper.SetComponentMixingToMean()


def mixed(data, shown):
    """By default optical depths add up, which VTK does not do."""
    return Different([pair(data, shown, step=0.25)], [pair(data, shown, mean, step=0.25)])


@case("TestGPURayCastTwoComponentsIndependent")
def two():
    return mixed(image(made.several(2)), independent(2))


@case("TestGPURayCastThreeComponentsIndependent")
def three():
    return mixed(image(made.several(3)), independent(3))


@case("TestGPURayCastThreeComponentsAdditive")
def three_additive():
    return Same(pair(image(made.several(3)), independent(3, 0.02), mode("Additive")))


@case("TestGPURayCastIndependentComponent")
def four():
    return mixed(image(255 * made.several(4)), independent(4, scale=255))


@case("TestGPURayCastIndependentComponentMIP")
def four_maximum():
    return Same(pair(image(255 * made.several(4)), independent(4, 0.9, 255), mode("MaximumIntensity")))


@case("TestGPURayCastIndependentComponentMinIP")
def four_minimum():
    """A single one of four components, the others clear, compared with VTK's own picture of an array that has only this one."""
    field = 255 - 255 * made.several(4)
    distances = []
    for i in range(4):
        shown, single = (independent(count, scale=255) for count in (4, 1))
        for k in range(4):
            shown.SetScalarOpacity(k, opacity((0, 0.9 * (k == i)), (255, 0)))
        single.SetScalarOpacity(opacity((0, 0.9), (255, 0)))
        single.SetColor(shown.GetRGBTransferFunction(i))
        right = picture(GPU, image(field[..., i]), single, mode("MinimumIntensity"))
        distances.append([differences([(one, right)])[0] for one in pair(image(field), shown, mode("MinimumIntensity"))])
    vtks, ours = numpy.max(distances, 0)
    return Better({}, ours, vtks)


@case("TestGPURayCastTwoComponentsGradient")
def two_gradient():
    shown = independent(2)
    for i in range(2):
        shown.SetGradientOpacity(i, opacity((0, 0), (0.06, 1)))
    return mixed(image(made.several(2)), shown)


@case("TestGPURayCastIndependentComponentsLightParameters")
def three_lit():
    shown = independent(3, shade=True)
    for i, (ambient, diffuse, specular, power) in enumerate(((0.2, 0.5, 0.3, 10), (0, 0.1, 0.9, 4), (0.5, 0.5, 0, 1))):
        shown.SetAmbient(i, ambient), shown.SetDiffuse(i, diffuse), shown.SetSpecular(i, specular), shown.SetSpecularPower(i, power)
    return mixed(image(made.several(3, 24)), shown)


@case("TestGPURayCastIndependentVectorMode")
def vectors():
    z, y, x = made.grid(32)
    field = image(numpy.stack([20 * x, 60 * y, 40 * z], -1).astype(numpy.float32))
    shown = look(alpha=((-60, 0), (0, 0.05), (60, 0.2)), tints=((-60, 1, 0, 0), (60, 0, 0.5, 1)))

    def choose(vector):
        def settings(mapper):
            mapper.SetVectorMode(vector), mapper.SetVectorComponent(1)

        return settings

    return Same(*(pair(field, shown, choose(vector), kind=SMART, step=0.05) for vector in (0, 1)))


@case("TestGPURayCastTwoComponentsDependent")
def two_dependent():
    return Same(pair(image(255 * made.several(2)), dependent()))


def by_last(field, shown):
    """VTK's mapper takes gradients of the first of dependent components, and ours of the last, whose opacity it is: here all are equal."""
    equal = numpy.repeat(field[..., -1:], field.shape[-1], -1)
    return Different([pair(image(field), shown, step=0.2)], [pair(image(equal), shown, step=0.2)])


@case("TestGPURayCastTwoComponentsDependentGradient")
def two_dependent_gradient():
    return by_last(255 * made.several(2), dependent(gradient=((0, 0.2), (12, 1))))


@case("TestGPURayCastFourComponentsComposite")
def four_dependent():
    return Same(pair(image(rgba()), dependent()))


@case("TestGPURayCastFourComponentsCompositeStreaming")
def four_dependent_wide():
    magnified = vtk.vtkImageMagnify()
    magnified.SetInputData(image(rgba(20)))
    magnified.SetMagnificationFactors(5, 1, 1), magnified.InterpolateOn(), magnified.Update()
    return Same(pair(magnified.GetOutput(), dependent()))


@case("TestGPURayCastFourComponentsDependentGradient")
def four_dependent_gradient():
    return by_last(rgba(), dependent(gradient=((0, 0.1), (15, 1))))


@case("TestGPURayCastDependentComponentsLightParameters")
def four_dependent_lit():
    return by_last(rgba(), dependent(shade=True, **SHINY))


@case("TestGPURayCastFourComponentsAdditive")
def four_dependent_additive():
    return Same(pair(image(rgba()), dependent(alpha=((0, 0), (255, 0.1))), mode("Additive")))


@case("TestGPURayCastFourComponentsAverage")
def four_dependent_average():
    return Same(pair(image(rgba()), dependent(), mode("AverageIntensity")))


@case("TestGPURayCastFourComponentsMIP")
def four_dependent_maximum():
    return Same(pair(image(rgba()), dependent(), mode("MaximumIntensity")))


@case("TestGPURayCastFourComponentsMinIP")
def four_dependent_minimum():
    return Same(pair(image(rgba()), dependent(alpha=((0, 1), (255, 0))), mode("MinimumIntensity")))


def raycaster(chosen, linear, settings=nothing, unit=1):
    """Cells of FixedPoint's test, which draws one to four components, independent and dependent ones, and light; and cells
    of one component and of four dependent ones, drawn by the GPU's mapper."""
    two, four_ = ((255 * made.several(count, 31)).astype(numpy.uint8) for count in (2, 4))
    cells = (made.blobs(31), look(linear=linear, unit=unit)), (rgba(31), dependent(linear=linear)), \
        (made.blobs(31), look(linear=linear, shade=True, **SHINY)), (two, independent(2, 0.2, 255, linear=linear)), \
        (two, dependent(linear=linear)), (four_, independent(4, 0.2, 255, linear=linear))

    def both(mapper):
        mean(mapper)
        settings(mapper)

    def drawn(count, kind, step):
        return [pair(image(field), shown, both, kind=kind, step=step) for field, shown in cells[:count]]

    return Different(drawn(chosen, FIXED, 0.2), drawn(min(chosen, 2), GPU, 0.2 if settings is nothing else 0.03))


@case("TestFixedPointRayCasterLinear")
def raycaster_linear():
    return raycaster(6, True)


@case("TestFixedPointRayCasterNearest")
def raycaster_nearest():
    return raycaster(3, False)


BOX = 10, 20, 10, 20, 10, 20


@case("TestFixedPointRayCasterLinearCropped")
def raycaster_linear_cropped():
    return raycaster(2, True, crop(253440, BOX), 3)


@case("TestFixedPointRayCasterNearestCropped")
def raycaster_nearest_cropped():
    return raycaster(1, False, crop(253440, BOX), 3)
