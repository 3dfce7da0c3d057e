# SPDX-License-Identifier: BSD-3-Clause
"""Draws NumPy volumes: `show` returns a picture, `as_image` hands an array's memory to VTK."""
import os
from numbers import Real

import numpy
import vtkmodules.vtkRenderingOpenGL2  # registers itself, so that a window can be made
import vtkmodules.vtkRenderingVolumeOpenGL2
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkCamera, vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume

from .StratusRenderingVolume import vtkStratusVolumeMapper

_TYPES = "bool, int8..int64, uint8..uint64, float32, float64"


class Picture(numpy.ndarray):
    """An array of shape (height, width, 4), RGBA of one byte each, the top row first, which notebooks show as a picture."""

    def _repr_png_(self):
        if self.ndim != 3 or self.shape[2] not in (3, 4) or self.dtype != numpy.uint8 or self.size == 0:
            return None  # a slice may not be a picture
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


def _number(value, name):
    if not _is_number(value):
        raise TypeError(f"{name} is {value!r}, it must be a number")
    if not numpy.isfinite(float(value)):
        raise ValueError(f"{name} is {value!r}, it must be finite")
    return float(value)


def as_image(array, spacing=(1, 1, 1), origin=(0, 0, 0), axes="zyx"):
    """Returns a vtkImageData over the array's own memory, which lives as long as the image does.

    array    three axes of at least 2 values; bool, integers, float32 or float64. Only an array that is not contiguous in memory is copied.
             Masked values of a masked array are hidden by a vtkGhostType.
    spacing  world length between two values along x, y and z, each > 0
    origin   position of the first value: x, y, z
    axes     order of the array's axes: "zyx" is array[z, y, x], "xyz" array[x, y, z]
    """
    mask = numpy.ma.getmask(array)
    array = numpy.asarray(array)
    if array.ndim != 3 or min(array.shape) < 2:
        raise ValueError(f"the array's shape is {array.shape}, it must have three axes of at least 2 values")
    if array.dtype.kind not in "buif" or array.dtype.itemsize > 8 or array.dtype == numpy.float16 or not array.dtype.isnative:
        raise TypeError(f"the array is of type {array.dtype.str} ({array.dtype}), it must be one of {_TYPES}, in the machine's byte order")
    if not isinstance(axes, (str, list, tuple)) or sorted(map(str, axes)) != ["x", "y", "z"]:
        raise ValueError(f"axes is {axes!r}, it must name x, y and z once each, as 'zyx'")
    spacing, origin = _numbers(spacing, 3, "spacing"), _numbers(origin, 3, "origin")
    if min(spacing) <= 0:
        raise ValueError(f"spacing is {spacing}, each must be above 0")
    values = numpy.ascontiguousarray(array)
    if values.dtype == bool:
        values = values.view(numpy.uint8)
    image = vtkImageData()
    fastest_first = ["xyz".index(axis) for axis in reversed(axes)]  # the world axis of each axis of the image
    image.SetDimensions(values.shape[::-1])
    image.SetSpacing([spacing[world] for world in fastest_first])
    image.SetOrigin(origin)
    image.SetDirectionMatrix([1.0 if fastest_first[own] == world else 0.0 for world in range(3) for own in range(3)])
    scalars = numpy_to_vtk(values.reshape(-1))  # keeps the array alive
    scalars.SetName("values")
    image.GetPointData().SetScalars(scalars)
    if mask is not numpy.ma.nomask:
        hidden = numpy_to_vtk((numpy.ascontiguousarray(mask).reshape(-1) * numpy.uint8(vtkDataSetAttributes.HIDDENPOINT)).astype(numpy.uint8))
        hidden.SetName(vtkDataSetAttributes.GhostArrayName())
        image.GetPointData().AddArray(hidden)
    return image


def _scalars(image):
    """Returns the values that are drawn, a flat array or one row per point, and which of them are shown: those not masked and finite."""
    points, cells = image.GetPointData(), image.GetCellData()
    data = points if points.GetScalars() else cells
    if not data.GetScalars():
        raise ValueError("the image has no scalars, neither of points nor of cells")
    values, hidden = vtk_to_numpy(data.GetScalars()), data.GetArray(vtkDataSetAttributes.GhostArrayName())
    shown = numpy.isfinite(values.reshape(len(values), -1)).all(axis=1)
    if hidden and hidden.GetNumberOfValues() == len(values):
        flag = vtkDataSetAttributes.HIDDENPOINT if data is points else vtkDataSetAttributes.HIDDENCELL
        shown &= vtk_to_numpy(hidden).astype(numpy.uint8) & flag == 0
    if not shown.any():
        raise ValueError(f"none of the {len(values)} values is to be drawn: each is masked or not finite")
    return values, shown


def _scaled(image):
    """Returns the image, 0 and its shown values, or a copy times 2**-power, because the mapper's floats end at 3.4e38."""
    values, shown = _scalars(image)
    finite = values if shown.all() else values[shown]
    largest = max(abs(float(finite.max())), abs(float(finite.min())))
    if finite.dtype.kind != "f" or largest == 0 or 1e-30 < largest < 1e37:
        return image, 0, finite
    power = int(numpy.frexp(largest)[1])
    with numpy.errstate(all="ignore"):  # of values that are not shown
        values = numpy.ldexp(values.astype(numpy.float64), -power)
    result, scalars = vtkImageData(), numpy_to_vtk(values)
    result.ShallowCopy(image)
    data = result.GetPointData() if image.GetPointData().GetScalars() else result.GetCellData()
    scalars.SetName(data.GetScalars().GetName())  # a mapper may select it by name
    data.SetScalars(scalars)  # replaces the image's scalars
    return result, power, values[shown]


def _spread(values):
    """Returns the smallest, the largest and the most frequent value."""
    low, high = float(values.min()), float(values.max())
    if low == high:
        return low, high, low
    some = values[:: max(1, len(values) // 2000000)]
    counts, edges = numpy.histogram(some.astype(numpy.float64), bins=256, range=(low, high))
    most = int(counts.argmax())
    return low, high, 0.5 * float(edges[most] + edges[most + 1])


def _is_number(value):
    return isinstance(value, Real) or isinstance(value, numpy.ndarray) and value.ndim == 0 and value.dtype.kind in "buif"


def _pairs(points, count, name, wanted, power):
    """Returns checked tuples of numbers, the first of each scaled as the image is."""
    try:
        pairs = [_numbers(point, count, f"a point of {name}") for point in points]
    except TypeError:
        raise TypeError(f"{name} is {points!r}, it must be {wanted}") from None
    if not pairs or not all(0 <= part <= 1 for pair in pairs for part in pair[1:]):
        raise ValueError(f"{name} is {points!r}, it must be {wanted}")
    with numpy.errstate(all="ignore"):
        return [(float(numpy.clip(numpy.ldexp(pair[0], -power), -1e300, 1e300)), *pair[1:]) for pair in pairs]


def _opacity_points(opacity, low, high, common, power):
    """Returns pairs of value and opacity. A number is the top of a ramp away from the most frequent value, or the opacity of a single value."""
    if opacity is None or _is_number(opacity):
        top = 0.3 if opacity is None else float(opacity)
        if not 0 <= top <= 1:
            raise ValueError(f"opacity is {opacity!r}, it must be in 0..1")
        if low == high:
            return [(low, top)]
        far = high if high - common >= common - low else low
        near = common + 0.05 * (far - common)
        return sorted([(common, 0.0), (near, 0.0), (far, top)])
    return _pairs(opacity, 2, "opacity", "a number in 0..1, or pairs of a value and an opacity in 0..1", power)


def _color_points(color, low, high, power):
    """Returns tuples of value, red, green and blue. A single colour is that of all values."""
    if color is None:
        middle = low + 0.5 * (high - low)
        points = [(low, 0.23, 0.3, 0.75), (middle, 0.87, 0.87, 0.87), (high, 0.9, 0.45, 0.15)]
        return points if low < high else points[1:2]
    wanted = "one (r, g, b) or some (value, r, g, b), with r, g and b in 0..1"
    try:
        if len(color) == 3 and all(_is_number(part) for part in color):
            if not all(0 <= part <= 1 for part in color):
                raise ValueError(f"color is {color!r}, it must be {wanted}")
            return [(low, *(float(part) for part in color))]
    except TypeError:
        raise TypeError(f"color is {color!r}, it must be {wanted}") from None
    return _pairs(color, 4, "color", wanted, power)


def _steps(points):
    """Returns the points in order. Of several points at one value the first and the last remain, the ends of a step."""
    points = sorted(points, key=lambda point: point[0])
    return [point for n, point in enumerate(points)
            if not (0 < n < len(points) - 1 and points[n - 1][0] == point[0] == points[n + 1][0])]


def _aim(renderer, camera):
    if isinstance(camera, vtkCamera):
        renderer.SetActiveCamera(camera)
        renderer.ResetCameraClippingRange()
        return
    wishes = dict(azimuth=30.0, elevation=25.0, zoom=1.15)
    if camera is not None and not isinstance(camera, dict):
        raise TypeError(f"camera is {camera!r}, it must be a dict of azimuth, elevation (degrees) and zoom, or a vtkCamera")
    unknown = set(camera or {}) - set(wishes)
    if unknown:
        raise ValueError(f"camera has {sorted(unknown)}, it may have azimuth, elevation (degrees) and zoom, or be a vtkCamera")
    wishes.update({name: _number(value, f"camera's {name}") for name, value in (camera or {}).items()})
    if wishes["zoom"] <= 0:
        raise ValueError(f"camera's zoom is {wishes['zoom']}, it must be above 0")
    active = renderer.GetActiveCamera()
    active.SetPosition(0, -1, 0)
    active.SetFocalPoint(0, 0, 0)
    active.SetViewUp(0, 0, 1)
    active.Azimuth(wishes["azimuth"])
    active.Elevation(max(-89.9, min(89.9, wishes["elevation"])))
    active.OrthogonalizeViewUp()
    renderer.ResetCamera()
    active.Zoom(wishes["zoom"])


def _check_display(window):
    """Raises if an X window has no display, because VTK before 9.4 crashes then. EGL and OSMesa have other classes and need no display."""
    if window.IsA("vtkXOpenGLRenderWindow") and not os.environ.get("DISPLAY"):
        raise RuntimeError("there is no X display to draw by (DISPLAY is not set): run this under xvfb-run")


def _paint(floats, background):
    """Converts premultiplied floats, the bottom row first, to a Picture."""
    rgb, alpha = floats[::-1, :, :3], floats[::-1, :, 3:]
    if background is None:
        rgb = numpy.divide(rgb, alpha, out=numpy.zeros_like(rgb), where=alpha > 0)
    else:
        rgb, alpha = rgb + (1 - alpha) * numpy.array(background, numpy.float32), numpy.ones_like(alpha)
    both = numpy.concatenate([rgb, alpha], axis=2)
    return numpy.rint(255 * numpy.clip(both, 0, 1)).astype(numpy.uint8).view(Picture)


def show(array, spacing=(1, 1, 1), opacity=None, color=None, size=(640, 480), camera=None, background=(0.08, 0.1, 0.14), origin=(0, 0, 0),
         axes="zyx", unit_distance=None, mapper=None, tolerance=None):
    """Draws a volume and returns the picture, an array (height, width, 4) of bytes that notebooks show.

    array          see as_image, also for spacing, origin and axes. Its memory is not copied, unless the largest magnitude is outside
                   1e-30..1e37; then a copy is scaled by a power of 2. Masked (numpy.ma), NaN and infinite values are transparent;
                   an array without other values raises a ValueError
    opacity        pairs of a value and its opacity in 0..1 per unit_distance. Two pairs at one value are a step. A number is the top of a
                   ramp away from the most frequent value, or the opacity of the whole volume where all values are equal
    color          (r, g, b) in 0..1 for all values, or several (value, r, g, b). Two at one value are a step
    size           width and height in pixels
    camera         dict of azimuth, elevation (degrees) and zoom, or a vtkCamera
    background     (r, g, b) in 0..1, or None for transparent
    unit_distance  world length to which the opacity refers (default: a fiftieth of the volume's diagonal)
    tolerance      root mean square error of RGBA in 0..1 over the lit pixels that automatic settings may cause: 0.001 is a quarter of an
                   8-bit step, 0 the finest (default: the mapper's, which is 0.001 unless it was set)
    mapper         a vtkStratusVolumeMapper to draw with: for its settings and counters, or to draw further arrays without building anew
    """
    image = array if isinstance(array, vtkImageData) else as_image(array, spacing, origin, axes)
    width, height = _numbers(size, 2, "size")
    if not all(1 <= side <= 16384 and side == int(side) for side in (width, height)):
        raise ValueError(f"size is {size!r}, each must be a whole number in 1..16384")
    width, height = int(width), int(height)
    if background is not None:
        background = _numbers(background, 3, "background")
        if not all(0 <= part <= 1 for part in background):
            raise ValueError(f"background is {background!r}, each must be in 0..1")
    if unit_distance is not None and _number(unit_distance, "unit_distance") <= 0:
        raise ValueError(f"unit_distance is {unit_distance!r}, it must be above 0")
    if tolerance is not None and _number(tolerance, "tolerance") < 0:
        raise ValueError(f"tolerance is {tolerance!r}, it must be at least 0")
    if mapper is not None and not isinstance(mapper, vtkStratusVolumeMapper):
        raise TypeError(f"mapper is {mapper!r}, it must be a vtkStratusVolumeMapper")
    window = vtkRenderWindow()
    _check_display(window)
    image, power, values = _scaled(image)
    low, high, common = _spread(values)
    volume, renderer = vtkVolume(), vtkRenderer()
    look, fade, hue = volume.GetProperty(), vtkPiecewiseFunction(), vtkColorTransferFunction()
    fade.AllowDuplicateScalarsOn()
    hue.AllowDuplicateScalarsOn()
    for point in _steps(_opacity_points(opacity, low, high, common, power)):
        fade.AddPoint(*point)
    for point in _steps(_color_points(color, low, high, power)):
        hue.AddRGBPoint(*point)
    look.SetScalarOpacity(fade)
    look.SetColor(hue)
    look.SetInterpolationTypeToLinear()
    look.SetScalarOpacityUnitDistance(image.GetLength() / 50 if unit_distance is None else float(unit_distance))
    mapper = mapper or vtkStratusVolumeMapper()
    if tolerance is not None:
        mapper.SetImageErrorTolerance(float(tolerance))
    tag = mapper.AddObserver("ErrorEvent", lambda caller, event: None)  # show() raises the error, so VTK must not print it
    mapper.SetInputData(image)
    volume.SetMapper(mapper)
    renderer.AddVolume(volume)
    window.SetOffScreenRendering(1)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    _aim(renderer, camera)
    window.Render()
    mapper.RemoveObserver(tag)
    asked = renderer.GetNumberOfPropsRendered() > 0  # otherwise the mapper holds another picture
    last, error = (mapper.GetLastImage(), mapper.GetLastError()) if asked else (None, "")
    window.Finalize()
    if last is None:
        raise RuntimeError(f"nothing was drawn: {error or 'the camera does not see the volume'}")
    return _paint(vtk_to_numpy(last.GetPointData().GetArray("RGBA")).reshape(height, width, 4), background)
