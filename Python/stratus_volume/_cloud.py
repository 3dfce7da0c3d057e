# SPDX-License-Identifier: BSD-3-Clause
"""Clouds in physical units: from water content and droplet size to a picture in sunlight."""
import ctypes
import datetime
import os

import numpy

from . import _declarations as c
from ._core import context as context_of, library, whole
from ._dimensions import computed, coordinate_of, space_axes_of
from ._draw import drawn_of
from ._look import _METRES
from ._picture import Picture
from ._tetrahedra import Tetrahedra
from ._values import background_color, is_number, number, numbers, positive
from ._volume import Volume

_USUAL_SUN = (120.0, 40.0)


def cloud(data, radius=None, ice=None, units=None, metres=None, density=None, variable=None, step=0, sun=None, time=None, place=None, size=(640, 480),
          camera=None, background="sky", albedo=c.STRATUS_CLOUD_ALBEDO, anisotropy=c.STRATUS_CLOUD_ANISOTROPY, spacing=None, origin=None, axes=None,
          scalars=None, component=None, device=None, threads=None, matrix=None, **options):
    """Draws water of clouds as a photograph shows it, and returns a Picture.

    data        the mass of water in air: an array or a data set as in `render`; an xarray.DataArray or Dataset; or a path of a file that xarray
                opens. Its lengths are widths and heights alike
    radius      effective radius of droplets or crystals in micrometres, 0.1..10000; default 10, of ice 30
    ice         whether it is ice; default: by the name or the standard_name of an xarray.DataArray, otherwise False
    units       of the values, such as "kg/m3", "g/m3", "kg/kg" or "g/kg"; default: those of an xarray.DataArray, otherwise kg/m3
    metres      length of a world unit in metres; default: by the units of an xarray.DataArray's coordinates or VTK's MetresPerUnit, otherwise 1
    density     of air in kg/m3, for values by the mass of air: a number, or an array in the values' shape; default: the Dataset's variable of
                standard_name air_density, or by those of air_pressure and air_temperature, otherwise that of the standard atmosphere at
                the height z
    variable    name of the Dataset's variable; default: the first of cloud water by standard_name or name, liquid before ice
    step        index of an xarray.DataArray of more than three dimensions along the first one, such as its time; the last three are space
    sun         azimuth, degrees clockwise from north, and elevation, degrees; x is east and y is north. Default: by time and place,
                otherwise 120 and 40
    time        moment in UTC: a text such as "2024-06-01T15:30", a datetime or a numpy.datetime64; default: that of the DataArray's step
    place       latitude and longitude in degrees, for the sun by time
    background  "sky", (r, g, b) in 0..1, or None for transparent
    albedo      single-scattering albedo, 0..1
    anisotropy  of the phase function by Henyey and Greenstein, -.99...99
    Everything else is as in `render`. The extinction of W kg/m3 is 3 W / (2 density of water or ice * radius).
    """
    context = context_of(device, threads)
    place_of = dict(spacing=spacing, origin=origin, axes=axes, scalars=scalars, component=component, matrix=matrix)
    if isinstance(data, (str, os.PathLike)):
        import xarray
        with xarray.open_dataset(data) as file:
            return cloud(file, radius, ice, units, metres, density, variable, step, sun, time, place, size, camera, background, albedo, anisotropy,
                         device=context, **{name: value for name, value in place_of.items() if value is not None}, **options)
    values, density = _chosen(data, variable, density, step)
    if _is_xarray(values):
        time = _time_of(values) if time is None and sun is None and place is not None else time
        attributes = values.attrs
        units = attributes.get("units") if units is None else units
        if ice is None:
            ice = library.stratus_cloud_phase_of(str(values.name or "").encode(), str(attributes.get("standard_name", "")).encode()) == c.STRATUS_CLOUD_ICE
        values = _in_metres(values) if metres is None and spacing is None and origin is None else values
    measure, factor = _unit("kg/m3" if units is None else units)
    if measure == c.STRATUS_CLOUD_MIXING_RATIO:
        values = _content(context, values, factor, density, 1.0 if metres is None else positive(metres, "metres"), place_of)
        factor = 1.0
    elif density is not None:
        raise ValueError(f"density is for values by the mass of air, but their unit is {units!r}")
    if isinstance(values, (Volume, Tetrahedra)):
        drawn, context = values, values.context
    else:
        own = {"exaggerate": 1.0} if _is_xarray(values) else {}  # a photograph has true heights
        drawn = drawn_of(values, device=context, **place_of, **own)
    length = positive(metres, "metres") if metres is not None else _metres_of(drawn)
    sun = _sun(context, sun, time, place)
    opacity, unit_distance = _function(context, factor, length, radius, bool(ice))
    colors = [(ctypes.c_double * 3)() for _ in range(3)]
    library.stratus_cloud_light(*colors)
    light, zenith, horizon = (numpy.array(color) for color in colors)
    direction = (ctypes.c_double * 3)()
    with context.lock:
        context.call(library.stratus_sun_direction, context.pointer, *sun, 2, direction)
    shade = dict(suns=[(*direction, *light)], ambient=0, diffuse=albedo, specular=0, shadows=True, scattering=1, anisotropy=anisotropy,
                 multiple=True, sky=(*zenith, *horizon))
    rendering = drawn.render(opacity, (1, 1, 1), size, camera, unit_distance=unit_distance, shade=shade, **options)
    return _develop(rendering.rgba, background, zenith, horizon)


def _is_xarray(data):
    return hasattr(data, "dims") and hasattr(data, "coords") and hasattr(data, "attrs")


def _indices(array, step):
    """The indices of a DataArray that leave its last three dimensions, at a step of the first one."""
    others = array.dims[:-3]
    indices = {name: 0 for name in others}
    if others:
        count = array.sizes[others[0]]
        indices[others[0]] = whole(step, f"step, along {others[0]!r},", -count, count - 1)
    return indices


def _time_of(values):
    """The moment of a DataArray of one step."""
    for coordinate in values.coords.values():
        if coordinate.ndim == 0 and coordinate.dtype.kind == "M":
            return coordinate.values
    return None


def _chosen(data, variable, density, step):
    """The variable of a Dataset at a step, and the density of its air if none is given; other data as they are."""
    if not hasattr(data, "data_vars"):
        if variable is not None:
            raise ValueError(f"variable is {variable!r}, but the data are no Dataset")
        return data.isel(_indices(data, step)) if _is_xarray(data) else data, density
    phases = {name: library.stratus_cloud_phase_of(str(name).encode(), str(array.attrs.get("standard_name", "")).encode())
              for name, array in data.data_vars.items()}
    if variable is None:
        known = sorted((phase, n) for n, phase in enumerate(phases.values()) if phase != c.STRATUS_CLOUD_NONE)
        if not known:
            raise ValueError(f"no variable of the Dataset is known as water of clouds; choose one by variable= of {sorted(map(str, phases))}")
        variable = list(phases)[known[0][1]]
    elif variable not in data.data_vars:
        raise ValueError(f"variable is {variable!r}, it must be one of {sorted(map(str, phases))}")
    data = data.isel(_indices(data[variable], step))
    values = data[variable]
    if density is None:
        air = {array.attrs.get("standard_name"): array for array in data.variables.values()}
        if "air_density" in air:
            density = air["air_density"]
        elif "air_pressure" in air and "air_temperature" in air:
            density = air["air_pressure"] / (c.STRATUS_DRY_AIR * air["air_temperature"])
        if density is not None and set(density.dims) <= set(values.dims):
            density = density.set_dims(dict(zip(values.dims, values.shape))).transpose(*values.dims).values
        elif density is not None:
            density = None  # of other places
    return values, density


def _in_metres(values):
    """A DataArray whose coordinates are in metres, where all have a unit of length."""
    factors = {}
    for name in values.dims:
        unit = str(values.coords[name].attrs.get("units", "")).strip() if name in values.coords else ""
        if unit not in _METRES:
            return values
        factors[name] = _METRES[unit]
    changed = {}
    for name, factor in factors.items():
        own = values.coords[name]
        changed[name] = own.copy(data=numpy.asarray(own.values, numpy.float64) * factor)
        changed[name].attrs["units"] = "m"
    return values.assign_coords(changed)


def _unit(units):
    factor = ctypes.c_double()
    measure = library.stratus_cloud_unit(str(units).encode(), ctypes.addressof(factor))
    if measure == c.STRATUS_CLOUD_UNKNOWN:
        raise ValueError(f"units is {units!r}, it must be a mass of water in a volume or a mass of air, such as 'kg/m3', 'g/m3', 'kg/kg' or 'g/kg'")
    return measure, factor.value


def _standard_density(context, height):
    pressure, temperature, density = ctypes.c_double(), ctypes.c_double(), ctypes.c_double()
    with context.lock:
        context.call(library.stratus_air_standard, context.pointer, float(height), ctypes.addressof(pressure), ctypes.addressof(temperature))
        context.call(library.stratus_air_density, context.pointer, pressure, temperature, ctypes.addressof(density))
    return density.value


def _content(context, values, factor, density, metres, place):
    """Values by the mass of air as kg/m3."""
    if not _is_xarray(values) and (not hasattr(values, "ndim") or hasattr(values, "GetPointData")):
        raise ValueError(f"values by the mass of air may be of an array or an xarray.DataArray; those of a {type(values).__name__} must be in kg/m3")
    if density is None:
        density = _by_height(context, values, metres, place)
    elif is_number(density):
        density = positive(density, "density")
    elif numpy.shape(density) != numpy.shape(values):
        raise ValueError(f"density has the shape {numpy.shape(density)}, it must be the values', {numpy.shape(values)}")
    else:
        density = numpy.asarray(density)
    if _is_xarray(values):
        result = values.copy(data=(computed(values) * (factor * density)).astype(numpy.float32))
        result.attrs["units"] = "kg m-3"
        return result
    return (values * (factor * density)).astype(numpy.float32)


def _by_height(context, values, metres, place):
    """The density of the standard atmosphere at each level, in a shape that goes with the values'."""
    shape = numpy.shape(values)
    if _is_xarray(values):
        level = space_axes_of(values).index("z")
        name, coordinate = values.dims[level], coordinate_of(values, values.dims[level])
        if coordinate is None or place["spacing"] is not None:
            raise ValueError(f"the dimension {name!r} has no coordinate, so that the air's density is not known: give density=")
        heights = numpy.asarray(coordinate.values, numpy.float64) * metres
    else:
        level = "zyx".index("z") if place["axes"] is None else str("".join(place["axes"])).index("z")
        spacing, origin = place["spacing"] or (1, 1, 1), place["origin"] or (0, 0, 0)
        heights = (number(origin[2], "origin") + number(spacing[2], "spacing") * numpy.arange(shape[level])) * metres
    densities = numpy.array([_standard_density(context, height) for height in heights])
    return densities.reshape([-1 if n == level else 1 for n in range(len(shape))])


def _metres_of(drawn):
    units = getattr(drawn, "_units", None)
    metres = getattr(units, "metres", None)
    if metres is None:
        return 1.0
    if len(set(metres)) > 1:
        raise ValueError(f"a world unit is {tuple(metres)} metres along x, y and z, it must be one length: give metres=")
    return float(metres[0])


def _function(context, factor, metres, radius, ice):
    """Opacity and unit distance of values that are `factor` kg/m3, in a world whose unit is `metres`."""
    usual = c.STRATUS_ICE_RADIUS if ice else c.STRATUS_WATER_RADIUS
    radius = usual if radius is None else 1e-6 * number(radius, "radius")
    extinction, points, distance = ctypes.c_double(), (ctypes.c_double * 4)(), ctypes.c_double()
    with context.lock:
        context.call(library.stratus_cloud_extinction, context.pointer, factor, radius, c.STRATUS_ICE_DENSITY if ice else c.STRATUS_WATER_DENSITY,
                     ctypes.addressof(extinction))
        context.call(library.stratus_cloud_opacity, context.pointer, extinction.value * metres, c.STRATUS_CLOUD_MOST_CONTENT / factor, points,
                     ctypes.addressof(distance))
    return [tuple(points[:2]), tuple(points[2:])], distance.value


def _sun(context, sun, time, place):
    """Azimuth and elevation in degrees."""
    if (time is None) != (place is None) or sun is not None and time is not None:
        raise ValueError("the sun has an azimuth and elevation, sun=, or a moment and a place, time= and place=")
    if time is None:
        return numbers(_USUAL_SUN if sun is None else sun, 2, "sun")
    latitude, longitude = numbers(place, 2, "place")
    azimuth, elevation = ctypes.c_double(), ctypes.c_double()
    with context.lock:
        context.call(library.stratus_sun_position, context.pointer, _seconds(context, time), latitude, longitude, ctypes.addressof(azimuth),
                     ctypes.addressof(elevation))
    if elevation.value <= 0:
        raise ValueError(f"the sun is {-elevation.value:.1f} degrees below the horizon at time={time!r}, place={place!r}")
    return azimuth.value, elevation.value


def _seconds(context, time):
    if isinstance(time, str):
        seconds = ctypes.c_double()
        with context.lock:
            context.call(library.stratus_time_parse, context.pointer, time.encode(), ctypes.addressof(seconds))
        return seconds.value
    if isinstance(time, datetime.datetime):
        return (time if time.tzinfo else time.replace(tzinfo=datetime.timezone.utc)).timestamp()
    try:
        return float((numpy.asarray(time).astype("datetime64[ms]") - numpy.datetime64(0, "ms")) / numpy.timedelta64(1, "s"))
    except (TypeError, ValueError):
        raise TypeError(f"time is {time!r}, it must be a text, a datetime or a numpy.datetime64") from None


def _to_screen(linear):
    """sRGB (IEC 61966-2-1)."""
    linear = numpy.clip(linear, 0, 1)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def _from_screen(level):
    level = numpy.asarray(level, numpy.float64)
    return numpy.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)


def _develop(rgba, background, zenith, horizon):
    """Radiances as a Picture, over a background."""
    rgb, alpha = rgba[..., :3], rgba[..., 3:]
    if background is None:
        rgb = numpy.divide(rgb, alpha, out=numpy.zeros_like(rgb), where=alpha > 0)
    else:
        if isinstance(background, str) and background == "sky":
            upward = 1 - (numpy.arange(len(rgba)) + 0.5)[:, None, None] / len(rgba)
            behind = _from_screen(_to_screen(horizon) + upward * (_to_screen(zenith) - _to_screen(horizon)))
        else:
            behind = _from_screen(background_color(background))
        rgb, alpha = rgb + (1 - alpha) * behind, numpy.ones_like(alpha)
    both = numpy.concatenate([_to_screen(rgb), numpy.clip(alpha, 0, 1)], axis=2)
    return numpy.rint(255 * both).astype(numpy.uint8).view(Picture)
