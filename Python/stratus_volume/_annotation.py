# SPDX-License-Identifier: BSD-3-Clause
"""Text and lines around pictures, which the core draws: a box with axes, coastlines, a colour bar, a caption."""
import ctypes
import typing

import numpy

from . import _declarations as c
from ._core import address, library
from ._values import number

_KINDS = c.ENUMS["stratus_axis_kind"]


class Axis(typing.NamedTuple):
    """The data's own numbers along an axis of the world: the place times scale, or of levels, pairs of both."""
    title: str = ""
    units: str = ""
    scale: float = 1.0
    kind: str = "number"
    levels: typing.Any = None

    def stretched(self, factor):
        """The same of a world in which places are `factor` times as far."""
        levels = None if self.levels is None else [(place * factor, level) for place, level in self.levels]
        return self._replace(scale=self.scale / factor, levels=levels)


def flag(value, name):
    if not isinstance(value, (bool, numpy.bool_)):
        raise TypeError(f"{name} is {value!r}, it must be True or False")
    return bool(value)


def _is_geometric(values):
    """Whether each of the values is as many times the one before: colours over the logarithm."""
    if len(values) < 3 or not (values > 0).all():
        return False
    steps = numpy.diff(numpy.log(values))
    return bool(steps[0] > 0 and numpy.allclose(steps, steps.mean(), rtol=1e-3))


class Annotation:
    """The core's annotation of one picture, with the memory that it points to. `is_wanted`: there is anything to draw."""

    def __init__(self, show_axes=False, color_bar=False, caption=None, coast=False, ink=0.9):
        if caption is not None and not isinstance(caption, str):
            raise TypeError(f"caption is {caption!r}, it must be a text")
        self.struct = library.stratus_annotation_default()
        self.struct.axes, self.struct.coast = int(flag(show_axes, "show_axes")), int(flag(coast, "coast"))
        self._has_bar = flag(color_bar, "color_bar")
        self.struct.ink = number(ink, "ink")
        if not 0 <= self.struct.ink <= 1:
            raise ValueError(f"ink is {ink!r}, it must be in 0..1")
        self._kept = [(caption or "").encode()]
        self.struct.caption = self._kept[0]
        self.is_wanted = bool(show_axes or coast or color_bar or caption)

    def set_box(self, bounds, axes=None):
        """bounds: of the data in the world. axes: three Axis; None: the world's own numbers."""
        if not self.is_wanted:
            return
        self.struct.bounds[:] = bounds
        own = axes or [Axis()] * 3
        if self.struct.coast and [axis.kind for axis in own[:2]] != ["longitude", "latitude"]:
            raise ValueError("coast is True, but places are no longitudes and latitudes: an xarray.DataArray needs both, of one dimension each and "
                             "in degrees, and a height, depth or pressure with its unit")
        for axis, to in zip(own, self.struct.axis):
            texts = [axis.title.encode(), axis.units.encode()]
            to.kind, to.title, to.units, to.scale = _KINDS[f"STRATUS_AXIS_{axis.kind.upper()}"], *texts, axis.scale
            if axis.levels is not None:
                texts.append(numpy.array(axis.levels, numpy.float64))
                to.levels, to.level_count = address(texts[-1]), len(axis.levels)
            self._kept.append(texts)

    def set_bar(self, transfer, spread, power, title="", units=""):
        """transfer, power: the Transfer of values times 2**-power. spread: of the values."""
        if not self._has_bar:
            return
        colors = numpy.array(transfer.colors, numpy.float64)
        colors[:, 0] = numpy.ldexp(colors[:, 0], power)
        low, high = (colors[0, 0], colors[-1, 0]) if len(colors) > 1 else (spread.low, spread.high)
        self.struct.logarithmic = int(_is_geometric(colors[:, 0]))
        self._kept.append((colors, title.encode(), units.encode()))
        self.struct.color, self.struct.color_count, self.struct.low, self.struct.high = address(colors), len(colors), float(low), float(high)
        self.struct.bar_title, self.struct.bar_units = self._kept[-1][1:]

    def room(self, context, size, fills):
        """The part of the picture that is left to the volume, or None for all of it. fills: the camera is one whose window the volume fills.
        Call it with the context's lock held."""
        if not (self.struct.axes or (fills and self._has_bar)):
            return None
        room = (ctypes.c_double * 4)()
        context.call(library.stratus_annotation_room, context.pointer, ctypes.byref(self.struct), *size, room)
        return room

    def draw(self, context, view, image):
        """Draws onto the picture of the core. Call it with the context's lock held."""
        if self.is_wanted:
            context.call(library.stratus_annotation_draw, context.pointer, ctypes.byref(self.struct), ctypes.byref(view), ctypes.byref(image.struct),
                         None, 0, None)
