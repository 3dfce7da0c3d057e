# SPDX-License-Identifier: BSD-3-Clause
"""Arrays and functions of values as people give them, made into what the core takes. The packages stratus and stratus_volume share it."""
import difflib
import math
import os
import sys
import warnings
from numbers import Real

import numpy

TYPES = "bool, int8..int64, uint8..uint64, float16, float32, float64"
# Beyond these magnitudes values are scaled by a power of 2: the core's floats end at 3.4e38.
SMALLEST, LARGEST = 1e-30, 1e37


class NothingShown(UserWarning):
    """A picture shows nothing, or next to nothing, of its data. The message names the reason."""


class PlacesUnused(UserWarning):
    """A picture has other places than the data's longitudes, latitudes and heights. The message names the reason."""


def warn(reason, kind=NothingShown):
    """Warns at the line that called the package."""
    level, frame, folder = 2, sys._getframe(1), os.path.dirname(__file__)
    while frame.f_back and os.path.dirname(frame.f_code.co_filename) == folder:
        level, frame = level + 1, frame.f_back
    warnings.warn(reason, kind, stacklevel=level)


# ---- numbers

def is_number(value):
    return isinstance(value, Real) or isinstance(value, numpy.ndarray) and value.ndim == 0 and value.dtype.kind in "buif"


def number(value, name):
    if not is_number(value):
        raise TypeError(f"{name} is {value!r}, it must be a number")
    try:
        result = float(value)
    except OverflowError:  # an int beyond all doubles
        result = numpy.inf
    if not numpy.isfinite(result):
        raise ValueError(f"{name} is {value!r}, it must be finite")
    return result


def numbers(values, count, name):
    try:
        result = tuple(float(value) for value in values)
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {values!r}, it must be {count} numbers") from None
    except OverflowError:  # an int beyond all doubles
        raise ValueError(f"{name} is {values!r}, it must be {count} finite numbers") from None
    if len(result) != count or not all(numpy.isfinite(result)):
        raise ValueError(f"{name} is {values!r}, it must be {count} finite numbers")
    return result


def pixels(size):
    """Returns width and height as ints."""
    width, height = numbers(size, 2, "size")
    if not all(1 <= side <= 16384 and side == int(side) for side in (width, height)):
        raise ValueError(f"size is {size!r}, each must be a whole number in 1..16384")
    return int(width), int(height)


def background_color(background):
    if background is None:
        return None
    result = numbers(background, 3, "background")
    if not all(0 <= part <= 1 for part in result):
        raise ValueError(f"background is {background!r}, each must be in 0..1")
    return result


def positive(value, name):
    if number(value, name) <= 0:
        raise ValueError(f"{name} is {value!r}, it must be above 0")
    return float(value)


def dot(a, b):
    """The product of two vectors of three numbers, rounded alike by every Python: its sum() is another from 3.12 on."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length_of(vector):
    """The length of a vector of three numbers, rounded alike by every Python: its math.hypot() is another from 3.10 on."""
    power = math.frexp(max(abs(part) for part in vector))[1]
    scaled_down = [math.ldexp(part, -power) for part in vector]  # exactly, so that no square overflows
    return math.sqrt(dot(scaled_down, scaled_down)) * 2.0 * math.ldexp(1.0, power - 1)


def unit_length(unit_distance, extinction, length):
    """The world length that opacities refer to, by default a fiftieth of the data's, for which its optical depths are floats."""
    result = ((length / 50 or 1.0) if unit_distance is None else float(unit_distance)) / extinction
    if length and not 1e-30 <= result / length <= 1e30:
        raise ValueError(f"unit_distance is {unit_distance!r} and extinction {extinction!r}, the first divided by the second must be 1e-30 to 1e30 times the "
                         f"diagonal of the data, {length:.6g}")
    return result


# ---- arrays

def type_in_core(dtype, name="array"):
    """The type in which the core reads values of a type."""
    if dtype.kind not in "buif" or dtype.itemsize > 8:
        raise TypeError(f"the {name} is of type {dtype.str} ({dtype}), it must be one of {TYPES}")
    if dtype == bool:
        return numpy.dtype(numpy.uint8)
    return numpy.dtype(numpy.float32) if dtype.kind == "f" and dtype.itemsize == 2 else dtype.newbyteorder("=")


def native(array, name="array"):
    """Returns the array in one of the core's types and the machine's byte order. float16 becomes float32; bool is seen as bytes."""
    array = numpy.asarray(array)
    needed = type_in_core(array.dtype, name)
    if array.dtype == bool:
        return array.view(needed)
    return array if array.dtype == needed else array.astype(needed)


def mask_of(array):
    """Returns the mask of a masked array in the array's shape, None where it hides nothing."""
    mask = numpy.ma.getmask(array)
    return None if mask is numpy.ma.nomask or not mask.any() else mask


def power_of(largest):
    """Returns the power of 2 that brings a magnitude near 1 where the core's floats do not hold it, else 0."""
    return 0 if largest == 0 or SMALLEST < largest < LARGEST else int(numpy.frexp(largest)[1])


def scaled(values, power):
    """Returns values times 2**-power as doubles."""
    with numpy.errstate(all="ignore"):  # of values that are not finite
        return numpy.ldexp(numpy.asarray(values, numpy.float64), -power)


def visible(values, hidden=None):
    """Returns a flat array of the values that can show: neither hidden nor, in any component (the last axis of two), not finite.

    hidden: flags in the shape of the values' points, or None.
    """
    rows = values if values.ndim < 2 else values.reshape(-1, values.shape[-1])
    if values.dtype.kind == "f" and not (numpy.isfinite(values.min()) and numpy.isfinite(values.max())):
        shown = numpy.isfinite(rows) if rows.ndim == 1 else numpy.isfinite(rows).all(axis=1)
        if hidden is not None:
            shown &= ~numpy.asarray(hidden, bool).reshape(-1)
        return rows[shown]
    return rows if hidden is None else rows[~numpy.asarray(hidden, bool).reshape(-1)]


class Spread:
    """Where values lie: `low`, `high`, the most frequent (`common`), and whether a few lie so far from all others that nothing else shows.

    `center` is a value in the midst of the most frequent. `far` is below a millionth where all but a twentieth of the values that differ from
    it do so by less than that fraction of the range.
    """

    def __init__(self, values, low=None, high=None):
        """low, high: the range, of which `values` are a sample; by default the range of `values`."""
        self.low, self.high = float(values.min() if low is None else low), float(values.max() if high is None else high)
        self.common, self.center, self.far = self.low, self.low, 1.0
        if self.low < self.high:
            # Differences of the largest doubles overflow, and differences of the smallest have no digits.
            power = power_of(max(abs(self.low), abs(self.high)))
            low, high = float(scaled(self.low, power)), float(scaled(self.high, power))
            flat = values.reshape(-1)
            some = scaled(flat[:: max(1, flat.size // 2000000)], power)
            counts, edges = numpy.histogram(some, bins=256, range=(low, high))
            most = int(counts.argmax())
            center = float(numpy.median(some[(some >= edges[most]) & (some <= edges[most + 1])]))
            others = numpy.abs(some[some != center] - center)
            if others.size:
                self.far = float(numpy.quantile(others, 0.95)) / (high - low)
            self.common, self.center = float(scaled(0.5 * (edges[most] + edges[most + 1]), -power)), float(scaled(center, -power))

    def power(self, points=None):
        """The power of 2 by which floats are scaled, for a function with points of its own by these where they are much smaller."""
        largest = max(abs(self.low), abs(self.high))
        if power_of(largest) and points is not None:
            own = max(abs(point) for point in points)
            if 0 < own < 1e-6 * largest:
                return power_of(own)
        return power_of(largest)


def write(value, power):
    """A value as its owner knows it, for messages."""
    with numpy.errstate(all="ignore"):
        return f"{float(numpy.ldexp(value, power)):.6g}"


# ---- functions of values

def pairs(points, count, name, wanted, power):
    """Returns checked tuples of numbers, the first of each scaled as the values are."""
    try:
        result = [numbers(point, count, f"a point of {name}") for point in points]
    except TypeError:
        raise TypeError(f"{name} is {points!r}, it must be {wanted}") from None
    if not result or not all(0 <= part <= 1 for point in result for part in point[1:]):
        raise ValueError(f"{name} is {points!r}, it must be {wanted}")
    return [(scaled_point(point[0], power), *point[1:]) for point in result]


def scaled_point(value, power):
    """A value of a function's point or contour, scaled as the values are; at most 1e300, so that differences of two are finite."""
    return float(numpy.clip(scaled(value, power), -1e300, 1e300))


def opacity_points(opacity, low, high, common, power):
    """Returns pairs of value and opacity. A number is the top of a ramp away from the most frequent value, or the opacity of a single value."""
    if opacity is None or is_number(opacity):
        top = 0.3 if opacity is None else number(opacity, "opacity")
        if not 0 <= top <= 1:
            raise ValueError(f"opacity is {opacity!r}, it must be in 0..1")
        if low == high:
            return [(low, top)]
        far = high if high - common >= common - low else low
        near = common + 0.05 * (far - common)
        return sorted([(common, 0.0), (near, 0.0), (far, top)])
    return pairs(opacity, 2, "opacity", "a number in 0..1, or pairs of a value and an opacity in 0..1", power)


def meant(word, names):
    """The end of a message about a word that is none of the names: the nearest one, if one is near."""
    near = difflib.get_close_matches(str(word), list(names), 1)
    return f": did you mean {near[0]}?" if near else ""


def is_color_map(color):
    """Whether it is a name, or a function of 0..1, as matplotlib's colour maps are."""
    return isinstance(color, str) or callable(color)


# Return the rows (256, 3) of a colour map of the core, or None for another name, and the names. The package that this module is a part of sets them.
core_map = core_map_names = None


def _color_map(name):
    """A function of 0..1 or a single colour of a name: a colour map of the core, or a colour map or a colour of matplotlib's, if that is
    installed."""
    rows = core_map(name)
    if rows is not None:
        return lambda place: rows[min(int(256 * place), 255)]
    try:
        import matplotlib
        from matplotlib.colors import to_rgb
    except ImportError:
        raise ValueError(f"color is {name!r}, which is no colour map of Stratus"
                         f"{meant(name, core_map_names())}; more names need matplotlib, which is not installed") from None
    if name in matplotlib.colormaps:
        return matplotlib.colormaps[name]
    try:
        return to_rgb(name)
    except ValueError:
        raise ValueError(f"color is {name!r}, which is no colour map of Stratus or matplotlib, and no colour of matplotlib"
                         f"{meant(name, [*core_map_names(), *matplotlib.colormaps])}") from None


def color_points(color, low, high, power):
    """Returns tuples of value, red, green and blue. A single colour is for all values."""
    if isinstance(color, str):
        color = _color_map(color)
    if callable(color):
        # As many rows as matplotlib's colour maps have. A single value gets the middle.
        places = numpy.linspace(0, 1, 256) if low < high else [0.5]
        rows = [numbers(tuple(color(float(place)))[:3], 3, "a colour of a colour map") for place in places]
        if not all(0 <= part <= 1 for row in rows for part in row):
            raise ValueError(f"color is {color!r}, it must return red, green and blue in 0..1")
        return [(low + (high - low) * float(place), *row) for place, row in zip(places, rows)]
    if color is None:
        middle = low + 0.5 * (high - low)
        points = [(low, 0.23, 0.3, 0.75), (middle, 0.87, 0.87, 0.87), (high, 0.9, 0.45, 0.15)]
        return points if low < high else points[1:2]
    wanted = "one (r, g, b) or some (value, r, g, b), with r, g and b in 0..1, or a colour map"
    try:
        if len(color) == 3 and all(is_number(part) for part in color):
            if not all(0 <= part <= 1 for part in color):
                raise ValueError(f"color is {color!r}, it must be {wanted}")
            return [(low, *(float(part) for part in color))]
    except TypeError:
        raise TypeError(f"color is {color!r}, it must be {wanted}") from None
    return pairs(color, 4, "color", wanted, power)


def steps(points):
    """Returns the points in order. Of several points at one value the first and the last remain, the ends of a step."""
    points = sorted(points, key=lambda point: point[0])
    return [point for n, point in enumerate(points)
            if not (0 < n < len(points) - 1 and points[n - 1][0] == point[0] == points[n + 1][0])]


def own_points(opacity):
    """The values of a function that names them, None for a number."""
    if opacity is None or is_number(opacity):
        return None
    return [point[0] for point in pairs(opacity, 2, "opacity", "a number in 0..1, or pairs of a value and an opacity in 0..1", 0)]


def functions(opacity, color, spread, power):
    """Returns the points of opacity and of colour, for values times 2**-power."""
    low, high, common = (float(scaled(value, power)) for value in (spread.low, spread.high, spread.common))
    points = steps(opacity_points(opacity, low, high, common, power))
    if spread.far <= 1e-6 and points[0][0] < points[-1][0] and own_points(opacity):
        # The colours are for the values that the function is for, and not for a few that are far from them.
        low, high = max(low, points[0][0]), min(high, points[-1][0])
    return points, steps(color_points(color, low, high, power))


def opacity_at(points, values):
    """The opacity of values by ordered points. At a step it is the larger of both ends."""
    at = numpy.array([point[0] for point in points])
    opacity = numpy.array([point[1] for point in points])
    result = numpy.interp(values, at, opacity)
    for value, own in points:
        result = numpy.where(numpy.asarray(values) == value, numpy.maximum(result, own), result)
    return result


# ---- the reasons why nothing shows

def none_visible(count, masked, wrong):
    """Returns the reason why no value can show: of `count` values `masked` are masked, and `wrong` are NaN or infinite."""
    what = [text for number_of, text in ((masked, f"{masked} masked"), (wrong, f"{wrong} NaN or infinite")) if number_of]
    return f"nothing shows: none of the {count} values can, {' and '.join(what) or 'none is finite'}"


def no_opacity(points, low, high, power):
    """Returns the reason why values in low..high are transparent by these points, or None if some are not."""
    if max(opacity for _, opacity in points) == 0:
        return "nothing shows: the opacity is 0 for every value"
    within = [opacity for value, opacity in points if low <= value <= high]
    if max([*within, *opacity_at(points, [low, high])]) > 0:
        return None
    shown = [value for n, (value, opacity) in enumerate(points) if opacity > 0 or any(other[1] > 0 for other in points[max(0, n - 1):n + 2])]
    values = f"all values are {write(low, power)}" if low == high else f"the values are in {write(low, power)}..{write(high, power)}"
    return f"nothing shows: {values}, and the opacity is above 0 only in {write(min(shown), power)}..{write(max(shown), power)}"


def one_sided(spread):
    """Returns the reason if a function of the whole range hides all differences, because a few values are very far from all others."""
    if spread.far > 1e-6:
        return None
    return (f"next to nothing shows: the values reach from {spread.low:.6g} to {spread.high:.6g}, but 95 % of them are nearer to "
            f"{spread.center:.6g} than a millionth of that. Mask values that are no data, or give opacity as pairs of a value and an opacity")


def explain(rgba, points, spread, power, automatic, mode, unit_distance, rays=None, contours=None):
    """Warns once if a picture shows nothing, or nothing but a few values far from all others.

    points: the opacity's points, in order; automatic: they follow from the range of the values; rays: number of rays that met a visible
    value, None: unknown
    """
    largest, grey = float(rgba[..., 3].max()), mode in ("average", "additive")
    reason = one_sided(spread) if automatic and not grey else None
    if reason is None and largest < 0.5 / 255:
        reason = None if grey else no_opacity(points, float(scaled(spread.low, power)), float(scaled(spread.high, power)), power)
        if reason is None and contours is not None and mode == "isosurface":
            if not any(spread.low <= float(scaled(value, -power)) <= spread.high for value in contours):
                reason = f"nothing shows: no contour is within the values, {spread.low:.6g}..{spread.high:.6g}"
        if reason is None:
            reason = one_sided(spread)
        if reason is None and mode in ("maximum", "minimum") and rays != 0:
            reason = f"nothing shows: in mode {mode} each ray shows a single value, and all of these have an opacity of 0"
        if reason is None and largest == 0:
            reason = "nothing shows: no ray of the camera meets a value of an opacity above 0, within crop and clip_planes where they are given"
        if reason is None:
            reason = (f"nothing shows: the largest alpha of the picture is {largest:.3g}, below half a step of 255. Raise the opacity, or lower "
                      f"unit_distance, which is {unit_distance:.6g}")
    if reason:
        warn(reason)
