# SPDX-License-Identifier: BSD-3-Clause
"""Longitudes and latitudes of xarray's data on a sphere, as the command line's --globe shows them. The core closes the lattice, places its
points and draws the Earth."""
import ctypes
import math

import numpy

from . import _declarations as c
from . import _earth
from ._core import address, context as context_of, library
from ._dimensions import space_axes_of, values_of
from ._tetrahedra import Tetrahedra
from ._values import number, positive
from ._view import _AROUND, is_placed

_NAMES = (("longitude", ("lon", "longitude", "nav_lon")), ("latitude", ("lat", "latitude", "nav_lat")))
_UNITS = (("degrees_east", "degree_east", "degrees_e", "degree_e", "degreese", "degreee"),
          ("degrees_north", "degree_north", "degrees_n", "degree_n", "degreesn", "degreen"))
_ALL_ROUND = 1.45  # the corners of the box about a sphere are far from it
_ASIDE = 0.1  # of the box' mean width: data do not go round if their middle is farther from the Earth's middle


def _kind(name, coordinate):
    """0 for a longitude of the Earth, 1 for a latitude, None for other coordinates."""
    units, standard = (str(coordinate.attrs.get(key, "")).strip().lower() for key in ("units", "standard_name"))
    for kind, (own, names) in enumerate(_NAMES):
        if standard:
            if standard == own:
                return kind
        elif units in _UNITS[kind] or (units.startswith("degree") or not units) and str(name).lower() in names:
            return kind
    return None


def _dims(name, coordinate, data):
    """The dimensions of a coordinate."""
    return tuple(getattr(coordinate, "dims", (name,) if name in data.dims else ()))


def _horizontal(data):
    """Longitudes and latitudes (rows, columns) in degrees, and the dimensions of rows and columns."""
    found = [{}, {}]
    for name in data.coords:
        coordinate = data.coords[name]
        kind, dims = _kind(name, coordinate), _dims(name, coordinate, data)
        if kind is not None and 1 <= len(dims) <= 2 and set(dims) <= set(data.dims):
            found[kind].setdefault(len(dims), (dims, numpy.asarray(coordinate.values, numpy.float64)))
    if all(2 in each for each in found):
        (dims, east), (other, north) = found[0][2], found[1][2]
        rows, columns = (name for name in data.dims if name in dims)
        if set(dims) == set(other):
            return [values if own == (rows, columns) else values.T for own, values in ((dims, east), (other, north))], (rows, columns)
    if all(1 in each for each in found) and found[0][1][0] != found[1][1][0]:
        (dims, east), (other, north) = found[0][1], found[1][1]
        return numpy.meshgrid(east, north), (*other, *dims)
    raise ValueError("globe is True, but the data have no longitudes and latitudes in degrees, of one dimension each or both of two")


class Earth:
    """The Earth in one picture of an Image: a sphere that ends rays, and is drawn behind the picture."""

    def __init__(self, innermost, image, coast, ink):
        self.struct = library.stratus_globe_default()
        self.struct.innermost, self.struct.coast, self.struct.ink = innermost, int(coast), ink
        shape = image.size[::-1]
        self.size, self._depth, self._light = image.size, numpy.ones(shape, numpy.float32), numpy.zeros(shape, numpy.float32)
        image.struct.opaque_depth = address(self._depth)

    def end_rays(self, context, view):
        """The camera with ends for this picture. Call it with the context's lock held, as `draw`."""
        view = c.stratus_camera.from_buffer_copy(view)
        context.call(library.stratus_globe_end_rays, context.pointer, ctypes.byref(self.struct), *self.size, ctypes.byref(view), address(self._depth),
                     address(self._light))
        return view

    def draw(self, context, view, image):
        context.call(library.stratus_globe_draw, context.pointer, ctypes.byref(self.struct), ctypes.byref(view), address(self._light),
                     ctypes.byref(image.struct))


class OnGlobe(Tetrahedra):
    """Data on a sphere of 6371 km, whose base is the core's.

    radius  of the sphere beneath the data
    """

    def on_scene(self):
        """The scene has the Earth's sphere, so that pictures need none."""
        self.innermost = None

    def depth(self):
        """The length of the shell that the data fill, from the inside to the outside."""
        radii = numpy.sqrt((self.points ** 2).sum(axis=-1))
        return float(radii.max() - radii.min())

    def mean_cell(self):
        return self.depth() / max(1.0, numpy.cbrt(self.values.size / self.components))

    def _finish(self, data, description):
        """Sets what a picture needs besides the mesh. data: the DataArray."""
        self._name(data)
        self.radius = self.innermost = float(numpy.sqrt((self.points ** 2).sum(axis=-1).min()))
        self.description = "on a sphere of 6371 km" + description

    def camera_of(self, camera):
        """The default camera, and the ones about the data, look from above the middle of the data, unless they go round."""
        if is_placed(camera):
            return camera
        middle = [0.5 * (self.bounds[2 * axis] + self.bounds[2 * axis + 1]) for axis in range(3)]
        width = sum(self.bounds[2 * axis + 1] - self.bounds[2 * axis] for axis in range(3)) / 3
        across = math.hypot(middle[0], middle[1])
        wishes = dict(_AROUND)
        aside = math.hypot(across, middle[2]) > _ASIDE * width
        if aside:
            wishes["azimuth"] = math.degrees(math.atan2(middle[1], middle[0])) + 90
            wishes["elevation"] = max(-75.0, min(75.0, math.degrees(math.atan2(middle[2], across))))
        wishes.update(camera or {})
        return wishes if aside else dict(wishes, zoom=number(wishes["zoom"], "camera's zoom") * _ALL_ROUND)


class Globe(OnGlobe):
    """A DataArray of longitudes and latitudes, of one or two dimensions, and a height, depth or pressure, on a sphere of 6371 km.

    exaggerate  factor of heights, above 0; default: as much as makes them reach over a tenth of the radius

    `exaggeration` is the factor that is used.
    """

    def __init__(self, data, exaggerate=None, device=None, threads=None):
        if not (hasattr(data, "dims") and hasattr(data, "coords") and hasattr(data, "attrs")):
            raise ValueError(f"globe is True, but the data are of the type {type(data).__name__}, only xarray's have longitudes and latitudes")
        space_axes_of(data)  # refuses other dimensions than three of space
        places, horizontal = _horizontal(data)
        vertical, = set(data.dims) - set(horizontal)
        context = context_of("host", 1)
        heights = None if vertical not in data.coords else _earth.heights_of(vertical, data.coords[vertical])
        if heights is None:
            raise ValueError(f"globe is True, but the dimension {vertical!r} has no coordinate in a unit of length or pressure")
        values = values_of(data).transpose([data.dims.index(name) for name in (vertical, *horizontal)])
        degrees = numpy.ascontiguousarray(numpy.stack(places, axis=-1), numpy.float64)
        self.exaggeration = exaggeration(exaggerate, heights)
        unknown = ~numpy.isfinite(degrees).all(axis=-1)
        if unknown.any():
            values = numpy.ma.masked_where(numpy.ma.getmaskarray(values) | unknown, values)
        with context.lock:
            lattice = c.stratus_globe_lattice()
            context.call(library.stratus_globe_find_lattice, context.pointer, degrees.shape[1], degrees.shape[0], address(degrees),
                         ctypes.byref(lattice))
            points = self._points(context, lattice, degrees, heights)
        super().__init__(points, None, _spread(lattice, values), device=device, threads=threads)
        text = ctypes.create_string_buffer(256)
        library.stratus_globe_describe(ctypes.byref(lattice), text, len(text))
        self._finish(data, text.value.decode())

    def _points(self, context, lattice, degrees, heights):
        every = numpy.ascontiguousarray(numpy.broadcast_to(heights[:, None, None], (len(heights), *degrees.shape[:2])))
        points = numpy.empty((len(heights), library.stratus_globe_rows(ctypes.byref(lattice)), library.stratus_globe_columns(ctypes.byref(lattice)), 3))
        own = c.stratus_globe_points(lattice=ctypes.pointer(lattice), count=degrees.shape[0] * degrees.shape[1], levels=len(heights),
                                     degrees=address(degrees), heights=address(every), height_stride=1, factor=self.exaggeration)
        context.call(library.stratus_globe_place, context.pointer, ctypes.byref(own), address(points))
        return points

    def guess(self, mode):
        """Points of opacity, points of colour and the unit distance by what the data say of their variable and by the depth of their columns, or
        None. Call it with the context's lock held."""
        if self.power or mode == "slice":
            return None
        radii = numpy.sqrt((self.points ** 2).sum(axis=-1))
        ends = numpy.concatenate([radii[:1], radii, radii[-1:]])
        thickness = numpy.ascontiguousarray(0.5 * abs(ends[2:] - ends[:-2]))
        return _earth.functions(self.context, self.about, self._box(self.lattice[::-1]), 2, thickness)


def exaggeration(factor, heights):
    """The factor of heights, of which None is as much as makes them reach over a tenth of the radius."""
    return float(library.stratus_globe_height_factor(heights.min(), heights.max())) if factor is None else positive(factor, "exaggerate")


def _mean(values):
    """The means along the last axis of the values that are known."""
    known = numpy.ma.masked_invalid(values) if values.dtype.kind == "f" else values
    mean = known.mean(axis=-1)
    return mean if values.dtype.kind == "f" else numpy.ma.around(mean)


def _spread(lattice, values):
    """Values (levels, rows, columns) on the lattice: points that close it have the mean of the data's points that the core names."""
    levels, rows, columns = values.shape
    flat = values.reshape(levels, rows * columns)
    wide, high = (getattr(library, f"stratus_globe_{name}")(ctypes.byref(lattice)) for name in ("columns", "rows"))
    own = numpy.ma.concatenate([values[:, :lattice.rows, :lattice.columns], values[:, :lattice.rows, :wide - lattice.columns]], axis=2)
    result = numpy.ma.empty((levels, high, wide), values.dtype)
    result[:, lattice.pole_before:lattice.pole_before + lattice.rows] = own
    first, stride = ctypes.c_int64(), ctypes.c_int64()
    for row in [*range(lattice.pole_before), *range(lattice.pole_before + lattice.rows, high)]:
        for column in range(wide):
            count = library.stratus_globe_source(ctypes.byref(lattice), column, row, ctypes.byref(first), ctypes.byref(stride))
            result[:, row, column] = _mean(flat[:, [first.value + n * stride.value for n in range(count)]])
    return result
