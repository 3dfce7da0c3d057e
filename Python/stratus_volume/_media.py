# SPDX-License-Identifier: BSD-3-Clause
"""What a volume may have besides one function of its value: functions of components, of labels and of two variables, and surfaces that cut it."""
import math
import typing

import numpy

from . import _declarations as c
from ._core import address, library
from ._look import Transfer, set_shading, value_interval
from ._values import dot, is_color_map, is_number, length_of, no_opacity, number, numbers, positive, warn

# Colours of independent components that are given none: far from each other, and about as bright.
_HUES = ((0.95, 0.45, 0.2), (0.25, 0.55, 0.95), (0.4, 0.8, 0.35), (0.85, 0.5, 0.85))
_LOOK = ("opacity", "color", "gradient_opacity")
_LABELS = 255


class Function(typing.NamedTuple):
    """One of the functions that a picture is drawn by: of one component, or of one label."""
    name: str
    opacity: typing.Any
    color: typing.Any
    gradient: typing.Any
    spread: typing.Any
    color_spread: typing.Any = None
    weight: float = 1.0

    def transfer(self, power, unit):
        return Transfer(self.opacity, self.color, self.spread, power, unit, self.gradient, self.color_spread, self.weight)


def _rows_of(value, width):
    """Whether it is rows of so many numbers, as the points of one function are."""
    try:
        return len(value) > 0 and all(len(row) == width and all(is_number(part) for part in row) for row in value)
    except TypeError:
        return False


def _each(value, count, is_one, name):
    """A list with one value for each component, of one for all or of as many as there are."""
    if value is None or is_one(value):
        return [value] * count
    try:
        result = list(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}, it must be one for all components, or one for each of the {count}") from None
    if len(result) != count:
        raise ValueError(f"{name} has {len(result)}, it must be one for all components, or one for each of the {count}: {name} is {value!r}")
    return result


def functions_of(grid, opacity, color, gradient_opacity, weights, dependent, looks):
    """The functions that a volume is drawn by, in the core's order."""
    count = grid.components
    if dependent and count == 1:
        raise ValueError("dependent is True, but the values have 1 component, they must have 2 or 4")
    if weights is not None and (count == 1 or dependent):
        raise ValueError(f"weights is {weights!r}, but the values have {'dependent components' if dependent else '1 component'}")
    if looks is not None and count > 1:
        raise ValueError(f"labels are of volumes of 1 component, the values have {count}")
    if dependent:
        # The last component has the opacity: of bytes that are a colour it is alpha itself where nothing is said.
        if opacity is None and count == 4:
            opacity = [(0, 0), (255, 1)]
        return [Function("the last component", opacity, color, gradient_opacity, grid.spreads[-1], grid.spreads[0])]
    if count == 1:
        result = [Function("", opacity, color, gradient_opacity, grid.spread)]
        for label in range(1, max(looks) + 1) if looks else ():
            look = dict(zip(_LOOK, (opacity, color, gradient_opacity)), **looks.get(label, {}))
            result.append(Function(f"label {label}", *(look[name] for name in _LOOK), grid.spread))
        return result
    opacities = _each(opacity, count, lambda value: is_number(value) or _rows_of(value, 2), "opacity")
    colors = _each(color, count, lambda value: is_color_map(value) or _rows_of([value], 3) or _rows_of(value, 4), "color")
    gradients = _each(gradient_opacity, count, lambda value: _rows_of(value, 2), "gradient_opacity")
    shares = _each(weights, count, is_number, "weights")
    for share in shares:
        if share is not None and not 0 <= number(share, "a weight") <= 1:
            raise ValueError(f"weights is {weights!r}, each must be in 0..1")
    return [Function(f"component {n}", opacities[n], _HUES[n] if colors[n] is None else colors[n], gradients[n], grid.spreads[n],
                     weight=1.0 if shares[n] is None else float(shares[n])) for n in range(count)]


def looks_of(labels, looks):
    """looks with whole labels, None without labels. Each look is a dict of opacity, color and gradient_opacity."""
    if (labels is None) != (looks is None):
        given, other = ("looks", "labels") if labels is None else ("labels", "looks")
        raise ValueError(f"{given} needs {other}: labels has the label of each value, looks the functions of each label")
    if looks is None:
        return None
    result = {}
    try:
        items = list(looks.items())
    except AttributeError:
        raise TypeError(f"looks is {looks!r}, it must be a dict of labels, 1..{_LABELS}, and dicts of {', '.join(_LOOK)}") from None
    for label, look in items:
        if not is_number(label) or not 1 <= label <= _LABELS or label != int(label):
            raise ValueError(f"looks has the label {label!r}, labels of a look of their own are whole numbers in 1..{_LABELS}")
        if not isinstance(look, dict) or set(look) - set(_LOOK):
            raise ValueError(f"the look of label {label} is {look!r}, it must be a dict of {', '.join(_LOOK)}")
        result[int(label)] = look
    if not result:
        raise ValueError("looks is empty, it must have a label")
    return result


class Labels:
    """The labels of a grid's values, as bytes in the order of memory."""

    def __init__(self, labels, grid):
        given = numpy.asarray(labels)
        shape = grid.as_given(grid.values).shape
        if given.shape != shape:
            raise ValueError(f"labels has the shape {given.shape}, it must be the values', {shape}")
        if given.dtype.kind not in "bui":
            raise TypeError(f"labels is of type {given.dtype}, it must be whole numbers in 0..{_LABELS}")
        if given.size and (given.min() < 0 or given.max() > _LABELS):
            raise ValueError(f"labels has the numbers {given.min()}..{given.max()}, they must be in 0..{_LABELS}")
        self.bytes = numpy.ascontiguousarray(grid.in_memory(given), numpy.uint8)
        # The core copies them where this number changes: other labels may have the place of earlier ones.
        self.revision = library.stratus_hash(address(self.bytes), self.bytes.size, 0)


class Function2D:
    """The core's function of two variables, of a dict of rgba, value_range and second_range."""

    def __init__(self, function, power, unit):
        names = ("rgba", "value_range", "second_range")
        if not isinstance(function, dict) or set(function) != set(names):
            raise ValueError(f"function_2d is {function!r}, it must be a dict of {', '.join(names)}")
        given = numpy.asarray(function["rgba"])
        if given.ndim != 3 or given.shape[2] != 4 or given.dtype.kind not in "fiu":
            raise ValueError(f"rgba of function_2d has the shape {given.shape} and type {given.dtype}, it must be (rows, columns, 4) numbers in 0..1")
        self.rgba = numpy.ascontiguousarray(given, numpy.float32)
        if not ((self.rgba >= 0) & (self.rgba <= 1)).all():
            raise ValueError(f"rgba of function_2d has numbers in {self.rgba.min():.6g}..{self.rgba.max():.6g}, they must be in 0..1")
        self.struct = c.stratus_transfer_2d(rgba=address(self.rgba), columns=given.shape[1], rows=given.shape[0], unit_distance=unit)
        for name in names[1:]:
            low, high = value_interval(numbers(function[name], 2, f"{name} of function_2d"), f"{name} of function_2d", power)
            if low == high:
                raise ValueError(f"{name} of function_2d is {function[name]!r}, the first must be below the second")
            getattr(self.struct, name)[:] = low, high
        self.struct.revision = library.stratus_hash(address(self.rgba), self.rgba.nbytes, 0)


def materials_of(options, shade, count):
    """The core's materials, which the options then point to, of a list with one shade for each component. None: one shade for all."""
    if not isinstance(shade, (list, tuple)):
        set_shading(options, shade)
        return None
    result = (c.stratus_material * count)()
    for n, own in enumerate(_each(shade, count, lambda value: False, "shade")):
        one = library.stratus_ray_cast_options_default().light
        set_shading(one, own)
        result[n].shade = one.shade
        for name in "ambient", "diffuse", "specular", "specular_power":
            setattr(result[n], name, getattr(one.shading, name))
    options.materials = result
    return result


_SURFACES = {
    ("center", "normal"): "a plane", ("center", "radius"): "a sphere", ("axis", "center", "radius"): "a cylinder",
    ("angle", "axis", "center"): "a cone", ("center", "constant", "linear", "square"): "a quadric"}


def surface_of(surface):
    """The core's surface of a dict."""
    kinds = "; ".join(f"{', '.join(names)} ({what})" for names, what in _SURFACES.items())
    if not isinstance(surface, dict) or tuple(sorted(surface)) not in _SURFACES:
        raise ValueError(f"surface is {surface!r}, mode slice needs a dict of {kinds}")
    result = c.stratus_slice()
    result.center[:] = numbers(surface["center"], 3, "surface's center")
    if "normal" in surface:
        result.linear[:] = _direction(surface["normal"], "surface's normal")
    elif "square" in surface:
        result.square[:], result.linear[:] = numbers(surface["square"], 6, "surface's square"), numbers(surface["linear"], 3, "surface's linear")
        result.constant = number(surface["constant"], "surface's constant")
    elif "axis" not in surface:
        result.square[:3], result.constant = (1, 1, 1), -positive(surface["radius"], "surface's radius") ** 2
    else:
        axis = _direction(surface["axis"], "surface's axis")
        if "radius" in surface:
            along, across, result.constant = -1.0, 1.0, -positive(surface["radius"], "surface's radius") ** 2
        else:
            angle = number(surface["angle"], "surface's angle")
            if not 0 < angle < 90:
                raise ValueError(f"surface's angle is {angle!r}, it must be above 0 and below 90 degrees")
            along, across = 1.0, -math.cos(math.radians(angle)) ** 2
        # along (a . d)^2 + across d . d
        result.square[:3] = [along * part * part + across for part in axis]
        result.square[3:] = [2 * along * axis[n] * axis[(n + 1) % 3] for n in range(3)]
    return result


def set_surface(options, mode, surface):
    """Sets the surface of mode slice."""
    if mode == "slice":
        options.slice = surface_of(surface)
    elif surface is not None:
        raise ValueError(f"surface is of mode slice, the mode is {mode}")


def opacity_of_surfaces(mode, contours):
    """The opacity of all values where none is given: 1 in mode slice and of one isosurface, a half of several, of which all then show; None in other
    modes."""
    several = mode == "isosurface" and not (contours is None or is_number(contours) or numpy.size(contours) == 1)
    return [(0, 0.5 if several else 1)] if mode in ("slice", "isosurface") else None


def _direction(vector, name):
    own = numbers(vector, 3, name)
    length = length_of(own)
    if length == 0:
        raise ValueError(f"{name} is {vector!r}, it must have a length above 0")
    return [part / length for part in own]


def slab(center, normal, thickness):
    """Returns the two clip planes of a thick slice: `render(data, mode="maximum", clip_planes=slab(...))` shows only the slab.

    center     a point in the middle of the slab: x, y, z in the world
    normal     direction across it, of any length above 0
    thickness  world length across it, above 0
    """
    middle, across, half = numbers(center, 3, "center"), _direction(normal, "normal"), positive(thickness, "thickness") / 2
    place = dot(across, middle)
    return [(*across, half - place), (*(-part for part in across), half + place)]


def explain_each(rgba, functions, transfers, power, unit):
    """Warns once where a picture of several functions shows nothing."""
    largest = float(rgba[..., 3].max())
    if largest >= 0.5 / 255:
        return
    reasons = [no_opacity(each.points, *(float(numpy.ldexp(end, -power)) for end in (of.spread.low, of.spread.high)), power)
               for of, each in zip(functions, transfers)]
    if reasons and all(reasons):
        warn(f"{reasons[0]} ({functions[0].name})" if functions[0].name else reasons[0])
    elif largest == 0:
        warn("nothing shows: no ray of the camera meets a value of an opacity above 0, within crop and clip_planes where they are given")
    else:
        warn(f"nothing shows: the largest alpha of the picture is {largest:.3g}, below half a step of 255. Raise the opacity, or lower "
             f"unit_distance, which is {unit:.6g}")
