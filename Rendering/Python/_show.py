# SPDX-License-Identifier: BSD-3-Clause
"""Draws NumPy volumes: `show` returns a picture, `as_image` hands an array's memory to VTK."""
import os

import numpy
import vtkmodules.vtkRenderingOpenGL2  # registers itself, so that a window can be made
import vtkmodules.vtkRenderingVolumeOpenGL2
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkCamera, vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume

from ._picture import paint
from ._values import (Spread, background_color, explain, functions, native, none_visible, number, numbers, own_points, pixels, positive, scaled,
                      unit_length, visible, warn)
from .StratusRenderingVolume import vtkStratusVolumeMapper

_MODES = ("composite", "maximum", "minimum", "average", "additive", "isosurface", "slice")  # vtkVolumeMapper's numbers


def as_image(array, spacing=(1, 1, 1), origin=(0, 0, 0), axes="zyx"):
    """Returns a vtkImageData over the array's own memory, which lives as long as the image does.

    array    three axes of at least 2 values; bool, integers, float16, float32 or float64, of either byte order. Only float16, the other
             byte order, and an array that is not contiguous in memory are copied. Masked values of a masked array are hidden by a
             vtkGhostType.
    spacing  world length between two values along x, y and z, each > 0
    origin   position of the first value: x, y, z
    axes     order of the array's axes: "zyx" is array[z, y, x], "xyz" array[x, y, z]
    """
    mask = numpy.ma.getmask(array)
    values = native(array)
    if values.ndim != 3 or min(values.shape) < 2:
        raise ValueError(f"the array's shape is {values.shape}, it must have three axes of at least 2 values")
    if not isinstance(axes, (str, list, tuple)) or sorted(map(str, axes)) != ["x", "y", "z"]:
        raise ValueError(f"axes is {axes!r}, it must name x, y and z once each, as 'zyx'")
    spacing, origin = numbers(spacing, 3, "spacing"), numbers(origin, 3, "origin")
    if min(spacing) <= 0:
        raise ValueError(f"spacing is {spacing}, each must be above 0")
    values = numpy.ascontiguousarray(values)
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
    """Returns the values that are drawn, a flat array or one row per point, and flags of those that a vtkGhostType hides, None: none."""
    points, cells = image.GetPointData(), image.GetCellData()
    data = points if points.GetScalars() else cells
    if not data.GetScalars():
        raise ValueError("the image has no scalars, neither of points nor of cells")
    values, ghosts = vtk_to_numpy(data.GetScalars()), data.GetArray(vtkDataSetAttributes.GhostArrayName())
    if not ghosts or ghosts.GetNumberOfValues() != len(values):
        return values, None
    flag = vtkDataSetAttributes.HIDDENPOINT if data is points else vtkDataSetAttributes.HIDDENCELL
    hidden = vtk_to_numpy(ghosts).astype(numpy.uint8) & flag != 0
    return values, hidden if hidden.any() else None


def _replaced(image, values):
    """Returns an image like this one with other values."""
    result, scalars = vtkImageData(), numpy_to_vtk(values)
    result.ShallowCopy(image)
    data = result.GetPointData() if image.GetPointData().GetScalars() else result.GetCellData()
    scalars.SetName(data.GetScalars().GetName())  # a mapper may select it by name
    data.SetScalars(scalars)  # replaces the image's scalars
    return result


def _without_surprises(image, values, hidden, spread, power):
    """Returns the image, or a copy of other values: times 2**-power, and without hidden values that would widen the mapper's tables."""
    beyond = hidden is not None and not (values.min() >= spread.low and values.max() <= spread.high)  # NaN is beyond, too
    if not power and not beyond:
        return image
    with numpy.errstate(all="ignore"):  # of values that are not finite
        other = scaled(values, power) if power else values.copy()
    if beyond:
        other[hidden] = numpy.nan if other.dtype.kind == "f" else other.dtype.type(spread.low)
    return _replaced(image, other)


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
    wishes.update({name: number(value, f"camera's {name}") for name, value in (camera or {}).items()})
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


def show(array, spacing=(1, 1, 1), opacity=None, color=None, size=(640, 480), camera=None, background=(0.08, 0.1, 0.14), origin=(0, 0, 0),
         axes="zyx", unit_distance=None, mapper=None, tolerance=None):
    """Draws a volume and returns the picture, an array (height, width, 4) of bytes that notebooks show.

    array          see as_image, also for spacing, origin and axes. Its memory is not copied, unless the largest magnitude is outside
                   1e-30..1e37, where a copy is scaled by a power of 2, or masked values lie beyond all others, which a copy leaves out.
                   Masked (numpy.ma), NaN and infinite values are transparent
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

    A picture that shows nothing gives one warning, NothingShown, that names the reason.
    """
    image = array if isinstance(array, vtkImageData) else as_image(array, spacing, origin, axes)
    width, height = pixels(size)
    background = background_color(background)
    if unit_distance is not None:
        positive(unit_distance, "unit_distance")
    if tolerance is not None and number(tolerance, "tolerance") < 0:
        raise ValueError(f"tolerance is {tolerance!r}, it must be at least 0")
    if mapper is not None and not isinstance(mapper, vtkStratusVolumeMapper):
        raise TypeError(f"mapper is {mapper!r}, it must be a vtkStratusVolumeMapper")
    window = vtkRenderWindow()
    _check_display(window)
    values, hidden = _scalars(image)
    own, shown = own_points(opacity), visible(values, hidden)
    if shown.size == 0:
        masked = 0 if hidden is None else int(hidden.sum())
        warn(none_visible(len(values), masked, len(values) - masked))
        return paint(numpy.zeros((height, width, 4), numpy.float32), background)
    spread = Spread(shown)
    power = spread.power(own) if values.dtype.kind == "f" else 0
    image = _without_surprises(image, values, hidden, spread, power)
    volume, renderer = vtkVolume(), vtkRenderer()
    look, fade, hue = volume.GetProperty(), vtkPiecewiseFunction(), vtkColorTransferFunction()
    fade.AllowDuplicateScalarsOn()
    hue.AllowDuplicateScalarsOn()
    opacities, colors = functions(opacity, color, spread, power)
    for point in opacities:
        fade.AddPoint(*point)
    for point in colors:
        hue.AddRGBPoint(*point)
    look.SetScalarOpacity(fade)
    look.SetColor(hue)
    look.SetInterpolationTypeToLinear()
    unit = unit_length(unit_distance, image.GetLength())
    look.SetScalarOpacityUnitDistance(unit)
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
    rgba = vtk_to_numpy(last.GetPointData().GetArray("RGBA")).reshape(height, width, 4)[::-1]
    explain(rgba, opacities, spread, power, own is None, _MODES[mapper.GetBlendMode()], unit)
    return paint(rgba, background)
