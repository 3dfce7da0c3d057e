# SPDX-License-Identifier: BSD-3-Clause
"""Data on the Earth: places in metres from the coordinates of an xarray.DataArray, heights that are exaggerated, and functions by what the
variable is."""
import ctypes

import numpy

from . import _declarations as c
from ._annotation import Axis
from ._core import address, library
from ._look import _METRES

_RADIUS = 6371000.0
_PRESSURES = {"Pa": 1.0, "hPa": 100.0, "mbar": 100.0, "millibar": 100.0, "millibars": 100.0, "mb": 100.0}
_DOWN = ("depth", "deptht", "depthu", "depthv", "depthw")
_LENGTHS = {unit: metres for unit, metres in _METRES.items() if metres > 0.1}  # smaller ones are of microscopes and workshops
_COLORS = c.CONSTANTS["STRATUS_COLOR_MAP_COLORS"]


def _units(coordinate):
    return str(coordinate.attrs.get("units", "")).strip()


def is_degrees(coordinate):
    return coordinate is not None and _units(coordinate).lower().startswith("degree")


def is_down(name, coordinate):
    """Whether a vertical coordinate of a length counts downwards."""
    positive = str(coordinate.attrs.get("positive", "")).lower()
    return positive == "down" if positive else str(coordinate.attrs.get("standard_name", name)).lower() in _DOWN


def _heights_of_pressures(pressures):
    """Heights in metres of pressures in Pa, in the standard atmosphere."""
    pressures = numpy.ascontiguousarray(pressures)
    heights = numpy.empty(pressures.shape)
    library.stratus_air_heights(pressures.size, address(pressures), address(heights), None)
    return heights


def heights_of(name, coordinate):
    """Heights in metres of a vertical coordinate, a length or a pressure; None for another. Depths are below 0."""
    values, units = numpy.asarray(coordinate.values, numpy.float64), _units(coordinate)
    if units in _PRESSURES:
        return _heights_of_pressures(values * _PRESSURES[units])
    if units in _LENGTHS:
        return values * _LENGTHS[units] * (-1.0 if is_down(name, coordinate) else 1.0)
    return None


def places_of(names, coordinates):
    """Places along x, y and z, and the metres of their unit; or None if the coordinates are not on the Earth: degrees of longitude and latitude,
    or lengths; and a height, a depth or a pressure. Places are in metres, but lengths that all have one unit keep it.

    names, coordinates: of x, y and z
    """
    x, y = (numpy.asarray(each.values, numpy.float64) for each in coordinates[:2])
    units = [_units(each) for each in coordinates]
    one = _LENGTHS.get(units[0]) if len(set(units)) == 1 else None
    if all(is_degrees(each) for each in coordinates[:2]):
        north = numpy.radians(y)
        east = numpy.radians(numpy.unwrap(x, period=360.0)) * numpy.cos(0.5 * (north.min() + north.max()))
        x, y = _RADIUS * east, _RADIUS * north
    elif one is None and all(unit in _LENGTHS for unit in units[:2]):
        x, y = _LENGTHS[units[0]] * x, _LENGTHS[units[1]] * y
    elif one is None:
        return None
    z = heights_of(names[2], coordinates[2])
    return None if z is None else ((x, y, z / (one or 1.0)), one or 1.0)


_TITLE = 32  # letters of a long_name that is no sentence


def _title(coordinate, usual):
    name = str(coordinate.attrs.get("long_name", ""))
    if not name or len(name) > _TITLE:
        name = str(coordinate.attrs.get("standard_name", "")).replace("_", " ")
    return {"projection x coordinate": "x", "projection y coordinate": "y"}.get(name, name or usual)


def axes_of(names, coordinates, places, earth):
    """The coordinates' own numbers along x, y and z, for labels.

    names, coordinates, places: of x, y and z; places are along the axes, ascending or descending
    """
    units = [_units(each) for each in coordinates]
    numbers = [numpy.asarray(each.values, numpy.float64) for each in coordinates]
    result = []
    for axis in range(3):
        coordinate, unit, kind = coordinates[axis], units[axis], "number"
        if earth and axis < 2 and is_degrees(coordinate):
            north = numpy.radians(numbers[1])
            metres = numpy.radians(_RADIUS) * (numpy.cos(0.5 * (north.min() + north.max())) if axis == 0 else 1.0)
            kind = ("longitude", "latitude")[axis]
            if str(coordinate.attrs.get("standard_name", "")).startswith("grid_"):  # about another pole
                kind = "number"
            result.append(Axis(_title(coordinate, ("longitude", "latitude")[axis]), "degrees", 1 / metres, kind))
        elif earth and unit in _LENGTHS:
            down = axis == 2 and is_down(names[2], coordinate)
            kept = len(set(units)) == 1  # lengths that all have one unit keep it
            result.append(Axis(_title(coordinate, names[axis]), unit if kept else "m", -1.0 if down else 1.0))
        elif earth and unit in _PRESSURES:
            levels = numbers[axis] * _PRESSURES[unit] / 100
            result.append(Axis(_title(coordinate, names[axis]), "hPa", kind="levels", levels=list(zip(places[axis], levels))))
        elif numpy.array_equal(places[axis], numbers[axis]):
            result.append(Axis(_title(coordinate, names[axis]), unit))
        else:  # places are in another unit, from another origin
            result.append(Axis(_title(coordinate, names[axis]), unit, kind="levels", levels=list(zip(places[axis], numbers[axis]))))
    return result


def height_factor(bounds):
    """The factor by which heights of flat data are exaggerated, 1 of others."""
    return float(library.stratus_look_height_factor((ctypes.c_double * 6)(*bounds), 2))


class About:
    """What a DataArray says of its variable."""

    def __init__(self, data):
        self.name, self.standard_name, self.units = (
            str(text or "").encode() for text in (getattr(data, "name", None), data.attrs.get("standard_name"), data.attrs.get("units")))

    @property
    def is_known(self):
        return self.kind()[0] != c.ENUMS["stratus_look_kind"]["STRATUS_LOOK_UNKNOWN"]

    def kind(self):
        """The core's kind, and the name of a colour map for a dark background or None."""
        name = ctypes.c_void_p()
        kind = library.stratus_look_kind_of(self.name, self.standard_name, self.units, 0, ctypes.byref(name))
        return kind, ctypes.string_at(name.value).decode() if name.value else None


def functions(context, about, volume, column_axis, thickness=None, unordered=False):
    """Returns points of opacity, points of colour and the unit distance, guessed by the core. Call it with the context's lock held.

    thickness  the length along the column of each value; None: as of the volume
    unordered  True: values are in no order of space
    """
    options, look = library.stratus_look_options_default(), c.stratus_look()
    options.kind, name = about.kind()
    options.column_axis, options.thickness, options.unordered = column_axis, address(thickness), int(unordered)
    context.call(library.stratus_look_guess, context.pointer, ctypes.byref(volume), 1, ctypes.byref(options), ctypes.byref(look))
    if name is None:
        name = "cool-warm" if look.kind == c.ENUMS["stratus_look_kind"]["STRATUS_LOOK_SIGNED"] else "viridis"
    colors = numpy.empty((_COLORS, 4))
    ends = (0, 1) if look.logarithmic else (look.low, look.high)
    context.call(library.stratus_color_map_points, context.pointer, name.encode(), *ends, address(colors))
    if look.logarithmic:
        colors[:, 0] = look.low * (look.high / look.low) ** colors[:, 0]
    points = numpy.array(look.opacity[:2 * look.opacity_count]).reshape(-1, 2)
    return points.tolist(), colors.tolist() if look.low < look.high else colors[:1].tolist(), look.unit_distance
