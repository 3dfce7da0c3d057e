# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of volumes by ray casting."""
import ctypes
import math

import numpy

from . import _declarations as c
from . import _view
from ._core import Owned, address, as_dict, choice, context as context_of, library
from ._grid import grid_of
from ._picture import Rendering
from ._values import (explain, functions, is_number, number, numbers, own_points, pairs, pixels, positive, scaled_point,
                      unit_length, warn)

_SHADING = ("ambient", "diffuse", "specular", "specular_power")


class Transfer:
    """The core's transfer function with the arrays that it points to."""

    def __init__(self, opacity, color, spread, power, unit_distance, gradient=None):
        self.points, colors = functions(opacity, color, spread, power)
        self._opacity, self._color = numpy.array(self.points, numpy.float64), numpy.array(colors, numpy.float64)
        self.struct = library.stratus_transfer_default()
        self.struct.opacity, self.struct.opacity_count = address(self._opacity), len(self._opacity)
        self.struct.color, self.struct.color_count = address(self._color), len(self._color)
        self.struct.unit_distance = unit_distance
        if gradient is not None:
            wanted = "pairs of a gradient's magnitude and a factor in 0..1"
            self._gradient = numpy.array(sorted(pairs(gradient, 2, "gradient_opacity", wanted, power)), numpy.float64)
            self.struct.gradient, self.struct.gradient_count = address(self._gradient), len(self._gradient)


def set_shading(options, shade):
    """shade: False, True, or a dict of ambient, diffuse, specular and specular_power."""
    options.shade = int(bool(shade) or isinstance(shade, dict))
    if isinstance(shade, dict):
        unknown = set(shade) - set(_SHADING)
        if unknown:
            raise ValueError(f"shade has {sorted(unknown)}, it may have {', '.join(_SHADING)}")
        for name, value in shade.items():
            setattr(options.shading, name, number(value, f"shade's {name}"))


def set_planes(options, clip_planes, most):
    try:
        planes = [] if clip_planes is None else [numbers(plane, 4, "a clip plane") for plane in clip_planes]
    except TypeError:
        raise TypeError(f"clip_planes is {clip_planes!r}, it must be planes of a, b, c and d") from None
    if len(planes) > most:
        raise ValueError(f"clip_planes has {len(planes)}, it may have {most}")
    options.clip_plane_count = len(planes)
    for n, plane in enumerate(planes):
        options.clip_planes[n][:] = plane


def set_contours(options, contours, power, most):
    try:
        values = [] if contours is None else [contours] if is_number(contours) else list(contours)
    except TypeError:
        raise TypeError(f"contours is {contours!r}, it must be one number or several") from None
    if len(values) > most:
        raise ValueError(f"contours has {len(values)}, it may have {most}")
    options.contour_count = len(values)
    for n, value in enumerate(values):
        options.contours[n] = scaled_point(number(value, "a contour"), power)
    return [options.contours[n] for n in range(len(values))]


def crop_box(crop):
    box = numbers(crop, 6, "crop")
    if any(box[2 * axis] > box[2 * axis + 1] for axis in range(3)):
        raise ValueError(f"crop is {crop!r}, it must be (xmin, xmax, ymin, ymax, zmin, zmax) with each minimum at most its maximum")
    return box


def value_interval(values, name, power):
    try:
        first, last = (float(value) for value in values)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} is {values!r}, it must be two numbers") from None
    if not first <= last:
        raise ValueError(f"{name} is {values!r}, the first must be at most the last")
    return [scaled_point(value, power) if math.isfinite(value) else value for value in (first, last)]


class Image:
    """The core's picture with its buffers."""

    def __init__(self, size, opaque_depth=None):
        width, height = self.size = size
        self.rgba = numpy.zeros((height, width, 4), numpy.float32)
        self.depth = numpy.full((height, width), numpy.inf, numpy.float32)
        self.struct = c.stratus_image(width=width, height=height, rgba=address(self.rgba), depth=address(self.depth))
        if opaque_depth is not None:
            depth = numpy.asarray(opaque_depth)
            if depth.shape != (height, width):
                raise ValueError(f"opaque_depth's shape is {depth.shape}, it must be that of the picture, {(height, width)}")
            self._opaque = numpy.ascontiguousarray(depth[::-1], numpy.float32)
            self.struct.opaque_depth = address(self._opaque)

    def rendering(self, counters):
        return Rendering(numpy.ascontiguousarray(self.rgba[::-1]), numpy.ascontiguousarray(self.depth[::-1]), counters)


class Volume:
    """A volume that is drawn more than once: what is built of its values is kept, and a camera's move builds nothing anew.

    data          a NumPy array of three axes of at least 2 values (bool, integers, float16, float32, float64, of either byte order), masked or
                  not; an xarray.DataArray of three dimensions; a vtkImageData or vtkRectilinearGrid, pyvista's too. Memory is not copied but
                  of float16, the other byte order, masked floats, integers whose masked values lie beyond all others, magnitudes outside
                  1e-30..1e37, and arrays whose rows do not follow each other evenly. Masked, NaN and infinite values are transparent.
    spacing       world length between two values along x, y and z, each > 0; default 1, 1, 1
    origin        position of the first value: x, y, z; default 0, 0, 0
    axes          order of the array's axes: "zyx" (default) is array[z, y, x], "xyz" array[x, y, z]
    scalars       name of the array of a VTK data set; default: its active scalars
    component     which of several components of it, from 0
    device        "auto" (default), "host", an OpenCL device's index or a part of its name, or a Context
    threads       on the host, 1..1024; default: as many as OpenMP offers
    """

    def __init__(self, data, spacing=None, origin=None, axes=None, scalars=None, component=None, device=None, threads=None):
        self.grid = grid_of(data, spacing, origin, axes, scalars, component)
        self.context = context_of(device, threads)
        self._caster = Owned(self.context, library.stratus_ray_caster_destroy)
        with self.context.lock:
            self.context.call(library.stratus_ray_caster_create, self.context.pointer, ctypes.byref(self._caster.pointer))

    @property
    def bounds(self):
        """xmin, xmax, ymin, ymax, zmin, zmax in the world."""
        with self.context.lock:
            return self.grid.bounds(self.context)

    def modified(self):
        """Tells that values changed in place: the next picture reads them anew. Values of a copy stay as they were copied."""
        self.grid.revision += 1

    def render(self, opacity=None, color=None, size=(640, 480), camera=None, unit_distance=None, mode="composite", interpolation="linear",
               structure="auto", sampling="auto", sample_distance=0, tolerance=None, shade=False, gradient_opacity=None, contours=None, crop=None,
               clip_planes=None, average_range=None, jitter=False, audit=False, opaque_depth=None, progress=None):
        """Draws a picture and returns a Rendering: rgba, depth, counters. `render` tells the parameters."""
        size = pixels(size)
        options = library.stratus_ray_cast_options_default()
        options.mode = choice(mode, "stratus_mode", "STRATUS_MODE_", "mode", ("slice",))
        options.structure = choice(structure, "stratus_structure", "STRATUS_STRUCTURE_", "structure")
        options.sampling = choice(sampling, "stratus_sampling", "STRATUS_SAMPLING_", "sampling", ("local",))
        options.interpolation = choice(interpolation, "stratus_interpolation", "STRATUS_INTERPOLATION_", "interpolation")
        options.sample_distance = number(sample_distance, "sample_distance")
        if tolerance is not None:
            options.tolerance = number(tolerance, "tolerance")
        options.jitter, options.audit = int(bool(jitter)), int(bool(audit))
        set_shading(options, shade)
        set_planes(options, clip_planes, c.CONSTANTS["STRATUS_CLIP_PLANES_MAX"])
        if crop is not None:
            options.crop, options.crop_bounds[:] = 1, self.grid.crop(crop_box(crop))
        if unit_distance is not None:
            positive(unit_distance, "unit_distance")
        image = Image(size, opaque_depth)
        own = own_points(opacity)
        report = c.stratus_ray_cast_report()
        if self.grid.nothing:
            warn(self.grid.nothing)
            return image.rendering(as_dict(report))
        power = self.grid.power(own)
        values = set_contours(options, contours, power, c.CONSTANTS["STRATUS_CONTOURS_MAX"])
        if average_range is not None:
            options.average_range[:] = value_interval(average_range, "average_range", power)
        with self.context.lock:
            bounds = self.grid.bounds(self.context)
            length = math.hypot(*(bounds[2 * axis + 1] - bounds[2 * axis] for axis in range(3)))
            unit = unit_length(unit_distance, length)
            transfer = Transfer(opacity, color, self.grid.spread, power, unit, gradient_opacity)
            view = _view.make(self.context, camera, bounds, size)
            volume = self.grid.view(power)
            self.context.call(library.stratus_ray_caster_render, self._caster.pointer, ctypes.byref(volume), ctypes.byref(transfer.struct),
                              ctypes.byref(view), ctypes.byref(options), ctypes.byref(image.struct), ctypes.byref(report), progress=progress)
        explain(image.rgba, transfer.points, self.grid.spread, power, own is None, mode, unit, report.rays, values)
        return image.rendering(as_dict(report))
