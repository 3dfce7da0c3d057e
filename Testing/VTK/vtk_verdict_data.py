# SPDX-License-Identifier: BSD-3-Clause
"""Fields and transfer functions of the cases that redo VTK's tests, all made here."""
import numpy
import vtk

from vtk_verdict import image_of


def grid(n, low=-1.0, high=1.0):
    """Coordinates z, y, x of n points an axis (or of a shape z, y, x) from low to high."""
    shape = (n, n, n) if isinstance(n, int) else n
    return numpy.meshgrid(*(numpy.linspace(low, high, k) for k in shape), indexing="ij")


def ball(n=40):
    """255 in the middle, 0 at the border: smooth, of one bump, as VTK's sampled spheres are."""
    z, y, x = grid(n)
    return (255 * numpy.clip(1 - (x * x + y * y + z * z) / 0.9, 0, 1) ** 1.5).astype(numpy.float32)


def blobs(n=40, shift=0.0):
    """Several bumps of different widths from 0 to 255, which end before the border."""
    z, y, x = grid(n)
    total = 0
    bumps = (-0.35, -0.2, 0.1, 0.3, 1), (0.4, 0.25, -0.25, 0.22, 0.8), (0.05, -0.4, -0.45, 0.18, 0.9), (-0.1, 0.45, 0.4, 0.2, 0.7)
    for cx, cy, cz, width, height in bumps:
        total = total + height * numpy.exp(-((x - cx - shift) ** 2 + (y - cy) ** 2 + (z - cz) ** 2) / width**2)
    edge = numpy.clip(8 * (1 - numpy.maximum(numpy.maximum(abs(x), abs(y)), abs(z))), 0, 1)
    return (255 * numpy.clip(total * edge, 0, 1)).astype(numpy.float32)


def waves(n=40):
    """Values of 40 to 270 that reach the border, as VTK's wavelet has them."""
    z, y, x = grid(n)
    bump, ripples = 60 * numpy.exp(-(x * x + y * y + z * z)), 25 * numpy.sin(5 * x) + 20 * numpy.cos(4 * y) + 15 * numpy.sin(6 * z)
    return (155 + bump + ripples).astype(numpy.float32)


def several(count, n=32):
    """count bumps, one a component, at the corners of a triangle or square, from 0 to 1."""
    z, y, x = grid(n)
    places = ((-0.3, -0.25), (0.3, -0.25), (0, 0.3), (0.1, 0.1))
    parts = [numpy.clip(1 - ((x - cx) ** 2 + (y - cy) ** 2 + z * z) / 0.25, 0, 1) for cx, cy in places[:count]]
    return numpy.stack(parts, -1).astype(numpy.float32)


def opacity(*points):
    function = vtk.vtkPiecewiseFunction()
    for point in points:
        function.AddPoint(*point)
    return function


def colors(*points):
    function = vtk.vtkColorTransferFunction()
    for point in points:
        function.AddRGBPoint(*point)
    return function


RAMP = (0, 0), (20, 0), (255, 0.25)
TINTS = (0, 0.1, 0.2, 1), (90, 0.2, 0.9, 0.4), (170, 1, 0.6, 0.1), (255, 1, 1, 0.8)
WAVES = (100, 0), (150, 0.02), (240, 0.12)
WAVE_TINTS = (100, 0.2, 0.29, 1), (157, 0.87, 0.87, 0.87), (240, 0.7, 0.015, 0.15)


def look(alpha=RAMP, tints=TINTS, shade=False, gradient=None, unit=1, linear=True, **material):
    """A property of these points; material: Ambient, Diffuse, Specular, SpecularPower and the like."""
    made = vtk.vtkVolumeProperty()
    made.SetScalarOpacity(opacity(*alpha))
    made.SetColor(colors(*tints))
    made.SetShade(shade)
    made.SetInterpolationType(vtk.VTK_LINEAR_INTERPOLATION if linear else vtk.VTK_NEAREST_INTERPOLATION)
    made.SetScalarOpacityUnitDistance(unit)
    if gradient is not None:
        made.SetGradientOpacity(opacity(*gradient))
    for name, value in material.items():
        getattr(made, "Set" + name)(value)
    return made


def image(field=None, **options):
    """The image of a field, of blobs() where none is given."""
    return image_of(blobs() if field is None else field, **options)
