# SPDX-License-Identifier: BSD-3-Clause
"""NumPy volumes as pictures: `show` draws one, `as_image` hands its memory to VTK."""
import os
import sys
from numbers import Real

import numpy
import vtkmodules.vtkRenderingOpenGL2  # registers itself, so that there is a window to draw in
import vtkmodules.vtkRenderingVolumeOpenGL2
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkCamera, vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume

from .StratusRenderingVolume import vtkStratusVolumeMapper

_TYPES = "bool, int8..int64, uint8..uint64, float32, float64"


class Picture(numpy.ndarray):
    """RGBA, one byte each, the top row first: an ordinary array of shape (height, width, 4) that notebooks show as a picture."""

    def _repr_png_(self):
        if self.ndim != 3 or self.shape[2] not in (3, 4) or self.dtype != numpy.uint8 or self.size == 0:
            return None  # a slice that is no picture any more
        image = vtkImageData()
        image.SetDimensions(self.shape[1], self.shape[0], 1)
        rows = numpy.ascontiguousarray(self[::-1]).reshape(-1, self.shape[2])
        image.GetPointData().SetScalars(numpy_to_vtk(rows))
        writer = vtkPNGWriter()
        writer.SetInputData(image)
        writer.WriteToMemoryOn()
        writer.Write()
        return vtk_to_numpy(writer.GetResult()).tobytes()

    def save(self, path):
        """Writes the picture as PNG."""
        with open(path, "wb") as file:
            file.write(self._repr_png_())


def _numbers(values, count, name):
    try:
        result = tuple(float(value) for value in values)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {values!r}, it must be {count} numbers") from None
    if len(result) != count or not all(numpy.isfinite(result)):
        raise ValueError(f"{name} is {values!r}, it must be {count} finite numbers")
    return result


def as_image(array, spacing=(1, 1, 1), origin=(0, 0, 0), axes="zyx"):
    """A vtkImageData over the array's own memory, which lives as long as the image does.

    array    three axes of at least 2 values; bool, integers, float32 or float64. One that is not contiguous in memory is copied, no other.
    spacing  world length between two values along x, y and z, each > 0
    origin   where the first value lies: x, y, z
    axes     which of the array's axes is which: "zyx" is array[z, y, x], "xyz" array[x, y, z]
    """
    array = numpy.asarray(array)
    if array.ndim != 3 or min(array.shape) < 2:
        raise ValueError(f"the array's shape is {array.shape}, it must have three axes of at least 2 values")
    if array.dtype.kind not in "buif" or array.dtype.itemsize > 8 or array.dtype == numpy.float16 or not array.dtype.isnative:
        raise TypeError(f"the array is of type {array.dtype.str} ({array.dtype}), it must be one of {_TYPES}, in the machine's byte order")
    if sorted(axes) != ["x", "y", "z"]:
        raise ValueError(f"axes is {axes!r}, it must name x, y and z once each, as 'zyx'")
    spacing, origin = _numbers(spacing, 3, "spacing"), _numbers(origin, 3, "origin")
    if min(spacing) <= 0:
        raise ValueError(f"spacing is {spacing}, each must be above 0")
    values = numpy.ascontiguousarray(array)
    if values.dtype == bool:
        values = values.view(numpy.uint8)
    image = vtkImageData()
    fastest_first = ["xyz".index(axis) for axis in reversed(axes)]  # world axis of each of the image's own
    image.SetDimensions(values.shape[::-1])
    image.SetSpacing([spacing[world] for world in fastest_first])
    image.SetOrigin(origin)
    image.SetDirectionMatrix([1.0 if fastest_first[own] == world else 0.0 for world in range(3) for own in range(3)])
    scalars = numpy_to_vtk(values.reshape(-1))  # holds on to the array
    scalars.SetName("values")
    image.GetPointData().SetScalars(scalars)
    return image


def _spread(image):
    """Least, most and most frequent of the finite values."""
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    values = values[:: max(1, values.size // 2000000)]
    values = values[numpy.isfinite(values)]
    if values.size == 0:
        return 0.0, 1.0, 0.0
    low, high = float(values.min()), float(values.max())
    if low == high:
        return low, low + 1.0, low
    counts, edges = numpy.histogram(values.astype(numpy.float64), bins=256, range=(low, high))
    most = int(counts.argmax())
    return low, high, 0.5 * float(edges[most] + edges[most + 1])


def _opacity_points(opacity, low, high, common):
    """Pairs of value and opacity: a number is the top of a ramp away from the most frequent value."""
    if opacity is None or isinstance(opacity, Real):
        top = 0.3 if opacity is None else float(opacity)
        if not 0 <= top <= 1:
            raise ValueError(f"opacity is {opacity!r}, it must be in 0..1")
        far = high if high - common >= common - low else low
        near = common + 0.05 * (far - common)
        return sorted([(common, 0.0), (near, 0.0), (far, top)])
    points = [_numbers(point, 2, "a point of opacity") for point in opacity]
    if not points or not all(0 <= alpha <= 1 for _, alpha in points):
        raise ValueError(f"opacity is {opacity!r}, it must be pairs of a value and an opacity in 0..1")
    return points


def _color_points(color, low, high):
    """Value, red, green and blue: one colour is that of all values."""
    if color is None:
        middle = 0.5 * (low + high)
        return [(low, 0.23, 0.3, 0.75), (middle, 0.87, 0.87, 0.87), (high, 0.9, 0.45, 0.15)]
    if len(color) == 3 and all(isinstance(part, Real) for part in color):
        points = [(low, *_numbers(color, 3, "color"))]
    else:
        points = [_numbers(point, 4, "a point of color") for point in color]
    if not points or not all(0 <= part <= 1 for point in points for part in point[1:]):
        raise ValueError(f"color is {color!r}, it must be one (r, g, b) or some (value, r, g, b), with r, g and b in 0..1")
    return points


def _aim(renderer, camera):
    if isinstance(camera, vtkCamera):
        renderer.SetActiveCamera(camera)
        renderer.ResetCameraClippingRange()
        return
    wishes = dict(azimuth=30.0, elevation=25.0, zoom=1.15)
    unknown = set(camera or {}) - set(wishes)
    if unknown:
        raise ValueError(f"camera has {sorted(unknown)}, it may have azimuth, elevation (degrees) and zoom, or be a vtkCamera")
    wishes.update(camera or {})
    active = renderer.GetActiveCamera()
    active.SetPosition(0, -1, 0)
    active.SetFocalPoint(0, 0, 0)
    active.SetViewUp(0, 0, 1)
    active.Azimuth(wishes["azimuth"])
    active.Elevation(max(-89.9, min(89.9, wishes["elevation"])))
    renderer.ResetCamera()
    active.Zoom(wishes["zoom"])


def _paint(floats, background):
    """Premultiplied floats, the bottom row first -> a Picture."""
    rgb, alpha = floats[::-1, :, :3], floats[::-1, :, 3:]
    if background is None:
        rgb = numpy.divide(rgb, alpha, out=numpy.zeros_like(rgb), where=alpha > 0)
    else:
        rgb, alpha = rgb + (1 - alpha) * numpy.array(background, numpy.float32), numpy.ones_like(alpha)
    both = numpy.concatenate([rgb, alpha], axis=2)
    return numpy.rint(255 * numpy.clip(both, 0, 1)).astype(numpy.uint8).view(Picture)


def show(array, spacing=(1, 1, 1), opacity=None, color=None, size=(640, 480), camera=None, background=(0.08, 0.1, 0.14), origin=(0, 0, 0),
         axes="zyx", unit_distance=None, mapper=None):
    """Draws a volume and returns the picture, as an array (height, width, 4) of bytes that notebooks show.

    array          see as_image, also for spacing, origin and axes; its memory is drawn from, not copied
    opacity        pairs of a value and its opacity in 0..1 per unit_distance; a number: the top of a ramp away from the most frequent value
    color          (r, g, b) in 0..1 for all values, or some (value, r, g, b)
    size           width and height in pixels
    camera         dict of azimuth, elevation (degrees) and zoom, or a vtkCamera
    background     (r, g, b) in 0..1, or None for transparent
    unit_distance  world length that opacity is per (default: a fiftieth of the volume's diagonal)
    mapper         a vtkStratusVolumeMapper of yours: with its settings, to ask for its counters, or to draw the next array without building anew
    """
    image = array if isinstance(array, vtkImageData) else as_image(array, spacing, origin, axes)
    width, height = (int(side) for side in _numbers(size, 2, "size"))
    if not (1 <= width <= 16384 and 1 <= height <= 16384):
        raise ValueError(f"size is {size!r}, each must be in 1..16384")
    if background is not None:
        background = _numbers(background, 3, "background")
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        raise RuntimeError("there is no X display to draw by (DISPLAY is not set): run this under xvfb-run")
    low, high, common = _spread(image)
    volume, renderer, window = vtkVolume(), vtkRenderer(), vtkRenderWindow()
    look, fade, hue = volume.GetProperty(), vtkPiecewiseFunction(), vtkColorTransferFunction()
    for point in _opacity_points(opacity, low, high, common):
        fade.AddPoint(*point)
    for point in _color_points(color, low, high):
        hue.AddRGBPoint(*point)
    look.SetScalarOpacity(fade)
    look.SetColor(hue)
    look.SetInterpolationTypeToLinear()
    look.SetScalarOpacityUnitDistance(image.GetLength() / 50 if unit_distance is None else _numbers([unit_distance], 1, "unit_distance")[0])
    mapper = mapper or vtkStratusVolumeMapper()
    tag = mapper.AddObserver("ErrorEvent", lambda caller, event: None)  # what would be printed is raised
    mapper.SetInputData(image)
    volume.SetMapper(mapper)
    renderer.AddVolume(volume)
    window.SetOffScreenRendering(1)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    _aim(renderer, camera)
    window.Render()
    mapper.RemoveObserver(tag)
    asked = renderer.GetNumberOfPropsRendered() > 0  # or what the mapper has is of another picture
    last, error = (mapper.GetLastImage(), mapper.GetLastError()) if asked else (None, "")
    window.Finalize()
    if last is None:
        raise RuntimeError(f"nothing was drawn: {error or 'the camera does not see the volume'}")
    return _paint(vtk_to_numpy(last.GetPointData().GetArray("RGBA")).reshape(height, width, 4), background)
