# SPDX-License-Identifier: BSD-3-Clause
"""Settings that pictures of volumes and of cells share: functions, light, planes, contours, and the picture's own buffers."""
import ctypes
import math

import numpy

from . import _declarations as c
from ._core import address, choice, library
from ._dimensions import coordinate_of
from ._picture import Rendering
from ._values import functions, is_number, number, numbers, pairs, scaled_point

_SHADING = ("ambient", "diffuse", "specular", "specular_power", "scattering", "anisotropy")


class Transfer:
    """The core's transfer function with the arrays that it points to. `color_spread`: the Spread of the component that has
    the colours, if it is another one."""

    def __init__(self, opacity, color, spread, power, unit_distance, gradient=None, color_spread=None, weight=1.0):
        self.points, colors = functions(opacity, color, spread, power)
        if color_spread is not None:
            colors = functions(None, color, color_spread, power)[1]
        self.colors = colors
        self._opacity, self._color = numpy.array(self.points, numpy.float64), numpy.array(colors, numpy.float64)
        self.struct = library.stratus_transfer_default()
        self.struct.opacity, self.struct.opacity_count = address(self._opacity), len(self._opacity)
        self.struct.color, self.struct.color_count = address(self._color), len(self._color)
        self.struct.unit_distance, self.struct.weight = unit_distance, weight
        if gradient is not None:
            wanted = "pairs of a gradient's magnitude and a factor in 0..1"
            self._gradient = numpy.array(sorted(pairs(gradient, 2, "gradient_opacity", wanted, power)), numpy.float64)
            self.struct.gradient, self.struct.gradient_count = address(self._gradient), len(self._gradient)


def set_shading(options, shade):
    """shade: False, True, or a dict of ambient, diffuse, specular, specular_power, scattering, anisotropy, shadows, suns, multiple and sky."""
    options.shade = int(bool(shade) or isinstance(shade, dict))
    if isinstance(shade, dict):
        known = _SHADING + ("shadows", "suns", "multiple", "sky")
        unknown = set(shade) - set(known)
        if unknown:
            raise ValueError(f"shade has {sorted(unknown)}, it may have {', '.join(known)}")
        for name in set(shade) & set(_SHADING):
            setattr(options.shading, name, number(shade[name], f"shade's {name}"))
        options.shading.shadows = int(bool(shade.get("shadows", False)))
        options.shading.multiple = int(bool(shade.get("multiple", False)))
        if "sky" in shade:
            sky = numbers(shade["sky"], 6 if len(shade["sky"]) == 6 else 3, "sky of shade")
            options.shading.sky_zenith[:], options.shading.sky_horizon[:] = sky[:3], sky[-3:]
        if "suns" in shade:
            _set_suns(options.shading, shade["suns"])


def _set_suns(shading, suns):
    try:
        rows = [suns] if is_number(suns[0]) else list(suns)
    except (TypeError, IndexError, KeyError):
        raise TypeError(f"shade's suns are {suns!r}, they must be one direction or several, each with a colour or without") from None
    if len(rows) > len(shading.lights):
        raise ValueError(f"shade has {len(rows)} suns, it may have {len(shading.lights)}")
    shading.light_count = len(rows)
    for n, row in enumerate(rows):
        sun = numbers(row, 6 if len(row) == 6 else 3, "a sun of shade")
        light = shading.lights[n]
        light.vector[:], light.color[:] = sun[:3], sun[3:] or [1.0, 1.0, 1.0]


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
                raise ValueError(f"opaque_depth's shape is {depth.shape}, it must be the picture's, {(height, width)}")
            self._opaque = numpy.ascontiguousarray(depth[::-1], numpy.float32)
            self.struct.opaque_depth = address(self._opaque)

    def rendering(self, counters, numbers=None):
        result = Rendering(numpy.ascontiguousarray(self.rgba[::-1]), numpy.ascontiguousarray(self.depth[::-1]), counters)
        result._quantities = numbers or {}
        return result


_METRES = {"m": 1, "meter": 1, "meters": 1, "metre": 1, "metres": 1, "km": 1000, "kilometer": 1000, "kilometers": 1000, "kilometre": 1000,
           "kilometres": 1000, "cm": 0.01, "mm": 0.001, "um": 1e-6, "ft": 0.3048, "feet": 0.3048, "foot": 0.3048, "nmi": 1852}


class Units:
    """The units of quantities. `metres`: of a unit of the world's x, y and z before `matrix`; None: unknown. `values`: the unit of the values."""

    def __init__(self, data=None, axes=None, values=None, matrix=None, metres=None):
        """data: of any kind; an xarray.DataArray or a VTK data set may know. axes: the dimensions of the first along the world's x, y and z.
        metres: of a unit of the world, if it is known."""
        self.metres, self.values, self.linear = None, values or "", None
        if metres is not None:
            self.metres = [metres] * 3
        elif axes is not None:
            self.metres = self._of_axes([each for each in (coordinate_of(data, axis) for axis in axes) if each is not None])
        elif hasattr(data, "GetFieldData"):
            array = data.GetFieldData().GetArray("MetresPerUnit")
            self.metres = [array.GetComponent(0, 0)] * 3 if array is not None and array.GetNumberOfTuples() and array.GetComponent(0, 0) > 0 else None
        if matrix is not None:
            self.linear = numpy.array(matrix, float)[:3, :3]

    @staticmethod
    def _of_axes(coordinates):
        units = [str(axis.attrs.get("units", "")) for axis in coordinates]
        metres = [_METRES.get(unit.strip()) for unit in units]
        places = [numpy.asarray(axis.values) for axis in coordinates]
        if len(metres) != 3 or None in metres or any(axis.ndim != 1 or axis.size < 2 or axis.dtype.kind not in "iuf" for axis in places):
            return None
        if len(set(units)) > 1:  # the grid then has a spacing of 1 along each axis
            metres = [metre * abs(float(axis[-1]) - float(axis[0])) / (axis.size - 1) for metre, axis in zip(metres, places)]
        return metres

    def measure(self):
        """The core's matrix: from the world, which `matrix` may have stretched, to lengths of the data."""
        result = numpy.diag(self.metres or [1.0] * 3)
        if self.linear is not None and numpy.linalg.det(self.linear):
            result = result @ numpy.linalg.inv(self.linear)
        return result.ravel()

    def of(self, number):
        text = ctypes.create_string_buffer(256)
        library.stratus_quantity_unit(number, self.values.encode(), int(self.metres is not None), text, len(text))
        return text.value.decode(errors="replace")


class Quantities:
    """The core's numbers of each pixel's ray, with their buffers."""

    # Those in units of the values, which may have been scaled.
    _OF_VALUES = ("integral", "mean", "maximum")

    def __init__(self, names, threshold, image, units=None):
        names = [names] if isinstance(names, str) else list(names or ())
        prefix, enum = "STRATUS_QUANTITY_", "stratus_quantity"
        self.numbers = {name: choice(name, enum, prefix, "a quantity", ("count",)) for name in names}
        self.struct = library.stratus_quantities_default()
        self.struct.threshold = number(threshold, "threshold")
        self.struct.width, self.struct.height, self.struct.opaque_depth = *image.size, image.struct.opaque_depth
        self.units = units or Units()
        self.struct.measure[:] = self.units.measure()
        self.buffers = {name: numpy.full(image.size[::-1], self._nothing(name), numpy.float32) for name in names}
        for name, place in self.numbers.items():
            self.struct.of[place] = address(self.buffers[name])

    @staticmethod
    def _nothing(name):
        return {"integral": 0, "length": 0, "cells": 0, "transmittance": 1}.get(name.replace("-", "_"), numpy.nan)

    def compute(self, context, inputs, count, view, progress):
        if self.numbers:
            context.call(library.stratus_ray_caster_render_quantities, inputs, count, ctypes.byref(view), ctypes.byref(self.struct), progress=progress)

    def result(self, power=0, label=None):
        """The arrays by their names, the top row first. label: a function of a name, an array and its unit, for the array in its place."""
        arrays = {}
        for name, buffer in self.buffers.items():
            array = numpy.ascontiguousarray(buffer[::-1])
            if power and name in self._OF_VALUES:
                array = numpy.ldexp(array.astype(numpy.float64), power)
            arrays[name] = label(name, array, self.units.of(self.numbers[name])) if label else array
        return arrays
