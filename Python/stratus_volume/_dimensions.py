# SPDX-License-Identifier: BSD-3-Clause
"""Dimensions of an xarray.DataArray: which axis of space each one is, by the attributes of CF's conventions or by its name, and its coordinate;
and its values, which may be lazy."""
import numpy

from ._lazy import Lazy, computed_whole
from ._pages import opened

_NAMES = {"z": ("z", "lev", "level", "plev", "height", "altitude", "alt", "depth", "elevation", "bottom_top", "k"),
          "y": ("y", "lat", "latitude", "north", "northing", "south_north", "j"),
          "x": ("x", "lon", "longitude", "east", "easting", "west_east", "i"),
          "t": ("t", "time", "times")}
_STANDARD = {"z": ("height", "altitude", "depth", "air_pressure", "model_level_number"),
             "y": ("latitude", "grid_latitude", "projection_y_coordinate", "projection_y_angular_coordinate"),
             "x": ("longitude", "grid_longitude", "projection_x_coordinate", "projection_x_angular_coordinate"),
             "t": ("time", "forecast_reference_time", "forecast_period")}
_UNITS = {"z": ("pa", "hpa", "mbar", "millibar", "millibars", "mb"),
          "y": ("degrees_north", "degree_north", "degrees_n", "degree_n", "degreesn", "degreen"),
          "x": ("degrees_east", "degree_east", "degrees_e", "degree_e", "degreese", "degreee")}


def axis_of(name, coordinate=None):
    """"x", "y", "z", "t" for time, or "" if neither the coordinate's attributes nor the name say which axis it is."""
    attributes = {key: str(coordinate.attrs.get(key, "")).strip().lower() for key in ("axis", "standard_name", "positive", "units")} if \
        coordinate is not None else dict.fromkeys(("axis", "standard_name", "positive", "units"), "")
    if attributes["axis"] in ("x", "y", "z", "t"):
        return attributes["axis"]
    standard = attributes["standard_name"]
    for axis, names in _STANDARD.items():
        if standard in names:
            return axis
    if attributes["positive"] in ("up", "down") or standard.startswith(("atmosphere_", "ocean_", "height_above_", "depth_below_")):
        return "z"
    for axis, units in _UNITS.items():
        if attributes["units"] in units:
            return axis
    if " since " in attributes["units"] or coordinate is not None and numpy.asarray(coordinate.values).dtype.kind == "M":
        return "t"
    return next((axis for axis, names in _NAMES.items() if str(name).lower() in names), "")


def coordinate_of(data, name):
    """The coordinate of one dimension along a dimension: the one of its name, or else the only other one that is an axis of space; or None."""
    if name in data.coords:
        return data.coords[name]
    along = [data.coords[other] for other in data.coords if tuple(getattr(data.coords[other], "dims", ())) == (name,)]
    known = [other for other in along if axis_of("", other) in ("x", "y", "z")]
    return known[0] if len(known) == 1 else None


def _chosen(names):
    return f".isel({', '.join(f'{name}=0' for name in names)})"


def space_axes_of(data):
    """The axes of the three dimensions of a DataArray, such as ["z", "y", "x"]. Dimensions of which nothing is known have the axes that are left, in
    the order z, y, x."""
    names = list(data.dims)
    axes = [axis_of(name, coordinate_of(data, name)) for name in names]
    if len(names) != 3:
        aside = sorted((name for name, axis in zip(names, axes) if axis in ("", "t")), key=lambda name: axes[names.index(name)] != "t")
        hint = f"choose one index of the others, as by {_chosen(aside[:len(names) - 3])}" if len(aside) >= len(names) - 3 > 0 else \
            "choose of others by .isel()" if len(names) > 3 else "a picture of a volume needs space's three"
        raise ValueError(f"the DataArray has the dimensions {tuple(names)}, it must have three; {hint}")
    if "t" in axes:
        name = names[axes.index("t")]
        raise ValueError(f"the dimension {name!r} is time, the DataArray must have three dimensions of space; choose a step by {_chosen([name])}, or "
                         "draw time as an axis by axes=, such as axes='zyx'")
    for axis in "xyz":
        if axes.count(axis) > 1:
            both = [name for name, own in zip(names, axes) if own == axis]
            raise ValueError(f"the dimensions {both} are both along {axis}, each axis must have one; name the axes by axes=, such as axes='zyx'")
    left = iter([axis for axis in "zyx" if axis not in axes])
    return [axis or next(left) for axis in axes]


class Steps:
    """What a slider chooses from: the steps along the time of an xarray.DataArray, or a list of data.

    name     of the dimension, or "step"
    labels   a text for each step
    """

    def __init__(self, name, labels, choose):
        self.name, self.labels, self._choose = name, labels, choose

    def __getitem__(self, n):
        return self._choose(n)

    @classmethod
    def of(cls, data, scalars=None):
        """The steps of data, or None if the data have none. A DataArray has steps if it has a dimension besides three of space, which is time or of
        which nothing is known, and a Dataset if its variable `scalars` has a time."""
        if isinstance(data, (list, tuple)) and data and all(getattr(each, "ndim", 3) == 3 and not isinstance(each, (list, tuple)) for each in data):
            return cls("step", [str(n) for n in range(len(data))], lambda n: data[n])
        is_dataset = hasattr(data, "data_vars")
        own = data[scalars] if is_dataset and scalars in data.variables else data
        if hasattr(own, "data_vars") or not (hasattr(own, "dims") and hasattr(own, "coords")) or not is_dataset and len(own.dims) != 4:
            return None
        axes = {name: axis_of(name, coordinate_of(own, name)) for name in own.dims}
        found = [name for name in own.dims if axes[name] == "t"] or [name for name in own.dims if axes[name] == "" and not is_dataset]
        if len(found) != 1:
            return None
        name, = found
        values = numpy.asarray(own.coords[name].values) if name in own.coords else numpy.arange(own.shape[own.dims.index(name)])
        labels = numpy.datetime_as_string(values, unit="auto") if values.dtype.kind == "M" else values
        return cls(name, [str(label) for label in labels], lambda n: data.isel({name: n}))


def lazy_of_data_array(data):
    """The Lazy of a DataArray, or None if its values are in memory. Its fill values are NaN."""
    chunked = getattr(data, "chunks", None) is not None
    if not chunked and getattr(getattr(data, "variable", None), "_in_memory", True):
        return None

    def read(box):
        part = data.variable[box]
        return part.data.compute() if chunked else part.values
    encoding = getattr(data, "encoding", None) or {}
    preferred = encoding.get("preferred_chunks") or {}
    chunks = data.chunks if chunked else [preferred.get(name) for name in data.dims]
    masked = chunked and isinstance(getattr(data.data, "_meta", None), numpy.ma.MaskedArray)
    return Lazy(data.shape, data.dtype, read, (lambda: computed_whole(data.data)) if chunked else (lambda: data.values), None if None in chunks else chunks,
                masked, _fills(data), f"the DataArray {data.name!r}", "choose a part by .isel() or .sel(), or a coarser one by .coarsen()")


def _fills(data):
    """The fill values of a DataArray. Those of its encoding were replaced as the file was read."""
    return [value for name in ("_FillValue", "missing_value") if name in data.attrs for value in numpy.ravel(data.attrs[name])]


def computed(data, memory=None, paged=False):
    """The values of a DataArray, or a Lazy. Of a lazy one all values are computed once, in the type that the core reads, if they fit in memory;
    memory and paged: as of `opened`."""
    lazy = lazy_of_data_array(data)
    return data.values if lazy is None else opened(lazy, memory, paged)


def values_of(data, memory=None, paged=False):
    """The values of a DataArray, with its fill values masked, or a Lazy: as `computed`."""
    values = computed(data, memory, paged)
    if isinstance(values, Lazy):
        return values
    values = numpy.ma.asarray(values)
    fills = _fills(data)
    return numpy.ma.masked_where(numpy.ma.getmaskarray(values) | numpy.isin(values.data, fills), values.data) if fills else values
