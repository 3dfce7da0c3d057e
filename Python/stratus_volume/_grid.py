# SPDX-License-Identifier: BSD-3-Clause
"""Volumes from NumPy, xarray, VTK and pyvista, as views of their own memory where type and order allow, and from lazy arrays."""
import contextlib
import ctypes
import importlib

import numpy

from . import _declarations as c
from . import _earth
from ._core import address, context as context_of, library, type_of
from ._dimensions import axis_of, coordinate_of, space_axes_of, values_of
from ._lazy import Lazy, bytes_of, lazy_of
from ._pages import Pages, Seen, opened
from ._values import PlacesUnused, Spread, mask_of, native, none_visible, numbers, power_of, scaled, visible, warn

_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
_POINT_HIDDEN = c.CONSTANTS["STRATUS_GHOST_HIDDEN_POINT"]
_CELL_HIDDEN = c.CONSTANTS["STRATUS_GHOST_HIDDEN_CELL"]


class Grid:
    """Values on a grid. `values` has the axes slow, middle, fast and, if there are several components, component. `world` contains the world
    axis of each index, fast first, and `own` its axis in the caller's array. `spreads` has one Spread for each component."""

    def __init__(self, values, mask, spacing, origin, world=(0, 1, 2), direction=None, coordinates=(None, None, None), cell_centered=False,
                 flags=None, own=(2, 1, 0)):
        self._place(spacing, origin, world, direction, coordinates, cell_centered, own)
        self.waits = False
        self.components = values.shape[3] if values.ndim == 4 else 1
        self.mask, self.flags, self.ghosts = mask, flags, None
        hidden = mask
        if flags is not None:
            self.ghosts = flags
            by_flags = flags & (_CELL_HIDDEN if cell_centered else _POINT_HIDDEN) != 0
            hidden = by_flags if hidden is None else hidden | by_flags
        rows = values.reshape(-1) if values.ndim == 3 else values.reshape(-1, self.components)
        shown = visible(rows, None if hidden is None else hidden.reshape(-1))
        self.nothing, self.spreads, self.spread = None, [], None
        if shown.size == 0:
            masked = 0 if hidden is None else int(hidden.sum())
            self.nothing = none_visible(len(rows), masked, len(rows) - masked)
        else:
            self.spreads = [Spread(each) for each in ([shown] if shown.ndim == 1 else shown.T)]
            self.spread = self.spreads[0]
        self.values = values if mask is None or self.nothing else self._without_hidden(values)
        self._scaled = (0, self.values)
        self.revision = 0

    def _place(self, spacing, origin, world, direction, coordinates, cell_centered, own):
        self.own, self.matrix = own, None
        # Of an xarray.DataArray: the attributes of its variable, whether its places are on the Earth, and the metres of their unit.
        self.about, self.earth, self.metres = None, False, None
        self.axes = None  # three Axis; None: places are the numbers
        self.world, self.cell_centered = world, cell_centered
        self.spacing, self.origin, self.coordinates = spacing, origin, coordinates
        self.direction = direction or [1.0 if world[own] == axis else 0.0 for axis in range(3) for own in range(3)]

    def _without_hidden(self, values):
        """What is masked has no say in ranges and tables: floats become NaN; integers a value of the others, hidden by a flag."""
        mask = self.mask if values.ndim == 3 else self.mask[..., None]
        if values.dtype.kind == "f":
            return numpy.where(mask, values.dtype.type(numpy.nan), values)
        flag = _CELL_HIDDEN if self.cell_centered else _POINT_HIDDEN
        own = self.mask.astype(numpy.uint8) * numpy.uint8(flag)
        self.ghosts = numpy.ascontiguousarray(own if self.ghosts is None else own | self.ghosts)
        low, high = (numpy.array([getattr(each, end) for each in self.spreads]) for end in ("low", "high"))
        of_each = values.reshape(-1, self.components)
        if (of_each.min(axis=0) < low).any() or (of_each.max(axis=0) > high).any():
            return numpy.where(mask, (low if values.ndim == 4 else low[0]).astype(values.dtype), values)
        return values

    def power(self, points=None):
        """The power of 2 by which values are scaled, for a function with points of its own by these where they are much smaller."""
        largest = max(self.spreads, key=lambda each: max(abs(each.low), abs(each.high)))
        return largest.power(points) if self.values.dtype.kind == "f" else 0

    def view(self, power):
        """The core's view of the values times 2**-power. It is valid as long as this object, and until the next call."""
        if self._scaled[0] != power:
            self._scaled = (power, scaled(self.values, power))
            self.revision += 1
        values, stride = _strided(self._scaled[1])
        if values is not self._scaled[1]:
            self._scaled = (power, values)
        volume = self._view_of(values.shape, type_of(values))
        volume.values, volume.value_stride, volume.components = address(values), stride, self.components
        if self.ghosts is not None:
            setattr(volume, "cell_ghosts" if self.cell_centered else "point_ghosts", address(self.ghosts))
        return volume

    def _view_of(self, shape, number):
        """A view without values, of a shape and the core's number of a type."""
        volume = library.stratus_volume_default()
        volume.type, volume.dimensions[:], volume.revision = number, shape[2::-1], self.revision
        volume.origin[:], volume.direction[:], volume.spacing[:] = self.origin, self.direction, self.spacing
        volume.cell_centered = int(self.cell_centered)
        if self.matrix is not None:
            volume.matrix[:] = self.matrix
        for own in range(3):
            volume.coordinates[own] = address(self.coordinates[own])
        return volume

    def sampled(self):
        """A view of all values, or of some of them, for guesses. It is valid until the next call."""
        return self.view(0)

    def coarse(self):
        return None

    def modified(self):
        self.revision += 1

    def settle(self, context, caster, progress=None):
        """Sees that spreads are known, before the caster's picture."""

    def reading(self):
        """A context for calls of the core that read values: an exception of a lazy array is raised as it ends."""
        return contextlib.nullcontext()

    def bounds(self, context):
        result, volume = (ctypes.c_double * 6)(), self.view(self._scaled[0])
        context.call(library.stratus_volume_bounds, context.pointer, ctypes.byref(volume), result)
        return tuple(result)

    def as_given(self, values):
        """An array of the grid's shape with its axes in the order of the caller's array."""
        return values.transpose([2 - self.own.index(axis) for axis in range(3)])

    def in_memory(self, given):
        """An array of the caller's axes with the axes slow, middle, fast: as_given backwards."""
        return given.transpose(self.own[::-1])

    def crop(self, box):
        """Bounds along the grid's axes of bounds along the world's."""
        result = [0.0] * 6
        for own, world in enumerate(self.world):
            for end in range(2):
                place = box[2 * world + end]
                # The core counts from origin[own], the world's axis from origin[world].
                result[2 * own + end] = place if self.coordinates[own] is not None else self.origin[own] + place - self.origin[world]
        return result


class LazyGrid(Grid):
    """A grid of a lazy array's values, whose parts are read when the core reads them. `values` has their shape and type, and is no memory of them.
    Spreads are known once it is settled."""

    def __init__(self, lazy, spacing, origin, world, coordinates):
        self._place(spacing, origin, world, None, coordinates, False, (2, 1, 0))
        self.lazy, self.components, self.mask, self.flags, self.ghosts = lazy, 1, None, None, None
        self.values = numpy.broadcast_to(numpy.zeros((), lazy.dtype), lazy.shape)
        self.nothing, self.spreads, self.spread, self.revision = None, [], None, 0
        self.pages, self._seen, self._scaled, self._sample, self._coarse = None, None, (0, None), None, None
        self.waits, self._forgets = True, False  # whether the last call had to read values; whether nothing is kept of them

    def view(self, power):
        if self.pages is None or self._scaled[0] != power:
            self.pages, self._scaled = Pages(self.lazy, power, self._forgets), (power, None)
            self.revision += 1  # memory may come back at the same address
        volume = self._view_of(self.lazy.shape, self.pages.type)
        self.pages.set(volume)
        return volume

    def sampled(self):
        volume, seen = self.view(0), self._seen
        volume.values, volume.parts, volume.missing = address(seen.coarse), None, None
        volume.tiles.values = None
        volume.dimensions[:] = seen.coarse.shape[::-1]
        volume.spacing[:], self._sample = self._coarse_places()
        for own in range(3):
            volume.coordinates[own] = address(self._sample[own])
        return volume

    def _coarse_places(self):
        """Spacing and coordinates of the coarse copy."""
        steps = self._seen.step[::-1]
        places = [None if places is None else numpy.ascontiguousarray(places[::step]) for places, step in zip(self.coordinates, steps)]
        return [step * space for step, space in zip(steps, self.spacing)], places

    def coarse(self):
        """The Grid of the coarse copy, or None if it is not known yet or shows nothing."""
        if self._coarse is None and self.spread is not None:
            spacing, places = self._coarse_places()
            made = Grid(self._seen.coarse, None, spacing, self.origin, self.world, self.direction, places)
            made.about, made.earth, made.metres, made.axes = self.about, self.earth, self.metres, self.axes
            self._coarse = made
        if self._coarse is not None:
            self._coarse.matrix, self._coarse.spread, self._coarse.spreads, self._coarse.nothing = self.matrix, self.spread, self.spreads, None
        return self._coarse

    def modified(self):
        self.pages = None

    def settle(self, context, caster, progress=None):
        if self._seen is not None:
            return
        try:
            with self.reading():
                seen = self._read_all(context, caster, progress)
        except BaseException:
            self.pages = self._seen = None
            raise
        self.nothing = seen.nothing
        if not self.nothing:
            self.spread = seen.spread
            self.spreads = [self.spread]

    def _read_all(self, context, caster, progress):
        """Lets the core read all values once, and notes what pictures need to know of them. The core may know their ranges from another process."""
        seen = self._seen = Seen(self.lazy)
        volume = self.view(0)
        self.pages.reader.seen = seen
        try:
            context.call(library.stratus_ray_caster_find_ranges, caster, ctypes.byref(volume), progress=progress)
        except ValueError:  # the core refuses values whose floats are all the same, but values of such magnitudes are scaled later
            if self.pages.reader.failure is not None or not (seen.low <= seen.high and power_of(max(abs(seen.low), abs(seen.high)))):
                raise
        self.pages.reader.seen = None
        if self.pages.identity and not seen.recall(context, volume) and not self.pages.reads:
            self._forgets, self.pages = True, None
            return self._read_all(context, caster, progress)
        return seen

    @contextlib.contextmanager
    def reading(self):
        before = self.pages and self.pages.reads
        try:
            yield
            self.waits = not before or self.pages.reads != before
        except Exception as error:
            failure = self.pages and self.pages.reader.failure
            if not failure:
                raise
            self.pages = None  # the next picture tries again
            raise OSError(f"{self.lazy.what} could not be read: {type(failure).__name__}: {failure}") from failure


def _strided(values):
    """Returns values and the distance of two along the fastest axis, in values, of a copy where rows do not follow each other evenly."""
    step, count, size = values.strides[2], values.shape, values.itemsize
    components = count[3] if values.ndim == 4 else 1
    even = step > 0 and step % size == 0 and values.strides[1] == step * count[2] and values.strides[0] == step * count[2] * count[1]
    if even and (components == 1 or values.strides[3] == size and step >= components * size):
        return values, step // size
    return numpy.ascontiguousarray(values), components


def _axes(axes):
    if not isinstance(axes, (str, list, tuple)) or sorted(map(str, axes)) != ["x", "y", "z"]:
        raise ValueError(f"axes is {axes!r}, it must name x, y and z once each, as 'zyx'")
    return ["xyz".index(axis) for axis in axes]


def _of_array(array, spacing, origin, axes, coordinates=None):
    """The Grid of an array, or of a Lazy one."""
    lazy = isinstance(array, Lazy)
    mask = None if lazy else mask_of(array)
    values = numpy.broadcast_to(numpy.zeros((), array.dtype), array.shape) if lazy else native(array)
    most = c.CONSTANTS["STRATUS_COMPONENTS_MAX"]
    if values.ndim not in (3, 4) or min(values.shape[:3]) < 2 or values.ndim == 4 and not 1 <= values.shape[3] <= most:
        raise ValueError(f"the array's shape is {values.shape}, it must have three axes of at least 2 values, and may have a last one of 1 to {most} "
                         "components")
    if values.ndim == 4:
        mask = None if mask is None else mask.any(axis=3)
        values = values[..., 0] if values.shape[3] == 1 else values
    worlds = _axes(axes)
    spacing = numbers((1, 1, 1) if spacing is None else spacing, 3, "spacing")
    origin = numbers((0, 0, 0) if origin is None else origin, 3, "origin")
    if min(spacing) <= 0:
        raise ValueError(f"spacing is {spacing}, each must be above 0")
    if lazy:
        places = (None, None, None) if coordinates is None else tuple(coordinates[::-1])
        world = tuple(worlds[::-1])
        return LazyGrid(array, [spacing[axis] for axis in world], origin, world, places)
    # The axis along which memory runs fastest is the core's first, whatever the array calls it.
    order = sorted(range(3), key=lambda axis: -values.strides[axis]) if min(values.strides[:3]) > 0 else [0, 1, 2]
    values = values.transpose([*order, 3][:values.ndim])
    mask = None if mask is None else mask.transpose(order)
    world = tuple(worlds[axis] for axis in reversed(order))
    own = tuple(reversed(order))
    places = (None, None, None) if coordinates is None else tuple(coordinates[axis] for axis in own)
    return Grid(values, mask, [spacing[axis] for axis in world], origin, world, coordinates=places, own=own)


def _of_xarray(data, spacing, origin, axes, memory, paged):
    """Returns the Grid of a DataArray: attributes and names of its dimensions give the axes, its coordinates the places, and its fill values are
    masked."""
    if axes is None or len(data.dims) != 3:
        axes = space_axes_of(data)
    values = values_of(data, memory, paged)
    coordinates, earth, labels = None, None, None
    own = [coordinate_of(data, name) for name in data.dims]
    if spacing is None and origin is None and all(each is not None for each in own):
        places = [numpy.asarray(each.values) for each in own]
        units = {str(each.attrs.get("units", "")) for each in own}
        if all(place.ndim == 1 and place.size > 1 and place.dtype.kind in "iuf" for place in places):
            places = [numpy.ascontiguousarray(place, numpy.float64) for place in places]
            ordered = ["".join(axes).index(axis) for axis in "xyz"]
            named = [str(data.dims[at]) for at in ordered], [own[at] for at in ordered]
            earth = _earth.places_of(*named)
            if earth is not None:
                for at, place in zip(ordered, earth[0]):
                    places[at] = numpy.ascontiguousarray(place)
            elif len(units) > 1:
                # If units differ and are not known, each axis gets the length of its number of values with a spacing of 1.
                places = [(place - place[0]) * ((place.size - 1) / abs(place[-1] - place[0])) for place in places]
            coordinates = places
            labels = _earth.axes_of(*named, [places[at] for at in ordered], earth is not None)
    if spacing is None and origin is None and earth is None:
        _warn_of_unused(data, dict(zip(data.dims, axes)), coordinates is None)
    grid = _of_array(values, spacing, origin, axes, coordinates)
    grid.about, grid.earth, grid.metres, grid.axes = _earth.About(data), earth is not None, earth[1] if earth else None, labels
    return grid


def _warn_of_unused(data, axes, by_index):
    """Warns of longitudes, latitudes and heights of a DataArray whose places are others.

    axes      the axis of each dimension
    by_index  True: places are indices
    """
    wide = [str(name) for name, own in data.coords.items() if len(getattr(own, "dims", ())) > 1 and set(own.dims) <= set(data.dims) and
            axis_of(name, own) in ("x", "y", "z")]
    if wide and by_index:
        warn(f"places are indices, because coordinates have more than one dimension: {', '.join(wide)}. globe=True uses longitudes and latitudes of two; "
             "the command stratus and the readers for VTK and ParaView use all of them", PlacesUnused)
        return
    own = {axis: coordinate_of(data, name) for name, axis in axes.items()}
    if not (_earth.is_degrees(own.get("x")) and _earth.is_degrees(own.get("y"))):
        return
    level = next((name for name, axis in axes.items() if axis == "z"), "")
    reason = "has no coordinate" if own.get("z") is None else f"is in {own['z'].attrs.get('units', '')!r}, neither a length nor a pressure"
    if own.get("z") is None or _earth.heights_of(level, own["z"]) is None:
        warn(f"places are no longitudes and latitudes, because {level!r} {reason}. The command stratus and the readers for VTK and ParaView know the heights "
             "of sigma and hybrid levels", PlacesUnused)


def chosen(values, component, name):
    """Returns a VTK array's values: of several components the requested one, or rows of all."""
    if values.ndim == 1:
        if component not in (None, 0, "all"):
            raise ValueError(f"component is {component!r}, but {name!r} has 1")
        return values
    count, most = values.shape[1], c.CONSTANTS["STRATUS_COMPONENTS_MAX"]
    choices = f"0..{count - 1}" + (" or 'all'" if count <= most else "")
    if component is None:
        raise ValueError(f"{name!r} has {count} components; choose by component=, {choices}")
    if isinstance(component, str) and component == "all" and count <= most:
        return values
    if isinstance(component, str) or component != int(component) or not 0 <= component < count:
        raise ValueError(f"component is {component!r}, it must be in {choices}")
    return values[:, int(component)]


def _shaped(values, shape):
    """A VTK array's values, or rows of components, along the grid's axes."""
    return native(values).reshape([*shape, *values.shape[1:]])


def of_package(data, module):
    """A module of the VTK that a data set is of. It need not be vtkmodules, and another VTK would not know the data set."""
    package = next((kind.__module__ for kind in type(data).__mro__ if kind.__name__ == "vtkDataSet"), "vtkmodules").split(".")[0]
    return importlib.import_module(f"{package}.{module}")


def _of_vtk(data, scalars, component):
    vtk_to_numpy = of_package(data, "util.numpy_support").vtk_to_numpy
    points, cells = data.GetPointData(), data.GetCellData()
    if scalars is not None:
        cell_centered = not points.HasArray(scalars)
        array = (cells if cell_centered else points).GetArray(scalars)
        if array is None:
            names = [each.GetArrayName(n) for each in (points, cells) for n in range(each.GetNumberOfArrays())]
            raise ValueError(f"scalars is {scalars!r}, it must be one of {names}")
    else:
        cell_centered = points.GetScalars() is None
        array = cells.GetScalars() if cell_centered else points.GetScalars()
        if array is None:
            raise ValueError("the grid has no active scalars, neither of points nor of cells; name them by scalars=")
    values = chosen(vtk_to_numpy(array), component, array.GetName())
    shape = [max(1, n - 1) if cell_centered else n for n in data.GetDimensions()][::-1]
    attributes = cells if cell_centered else points
    flags = attributes.GetArray("vtkGhostType")
    flags = None if flags is None else numpy.ascontiguousarray(vtk_to_numpy(flags)).view(numpy.uint8).reshape(shape)
    if data.IsA("vtkRectilinearGrid"):
        places = [numpy.ascontiguousarray(vtk_to_numpy(each), numpy.float64) for each in
                  (data.GetXCoordinates(), data.GetYCoordinates(), data.GetZCoordinates())]
        return Grid(_shaped(values, shape), None, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), coordinates=places, cell_centered=cell_centered, flags=flags)
    extent, origin = data.GetExtent(), [0.0, 0.0, 0.0]
    data.TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], origin)
    matrix = data.GetDirectionMatrix()
    direction = [matrix.GetElement(row, column) for row in range(3) for column in range(3)]
    return Grid(_shaped(values, shape), None, list(data.GetSpacing()), tuple(origin), direction=direction, cell_centered=cell_centered,
                flags=flags)


def affine(matrix):
    """The 16 numbers, row by row, of an affine matrix (4, 4), which may be VTK's; None stands for none."""
    if matrix is None:
        return None
    wanted = "it must be (4, 4) finite numbers, the last row 0, 0, 0, 1, that leave a volume its thickness"
    rows = [[matrix.GetElement(row, column) for column in range(4)] for row in range(4)] if hasattr(matrix, "GetElement") else matrix
    try:
        own = numpy.asarray(rows, numpy.float64)
    except (TypeError, ValueError):
        raise TypeError(f"matrix is {matrix!r}, {wanted}") from None
    if own.shape != (4, 4) or not numpy.isfinite(own).all() or list(own[3]) != [0, 0, 0, 1] or numpy.linalg.det(own[:3, :3]) == 0:
        raise ValueError(f"matrix is {matrix!r}, {wanted}")
    return own.reshape(-1)


def grid_of(data, spacing=None, origin=None, axes=None, scalars=None, component=None, memory=None, paged=False):
    """The Grid of data. paged: it may be a LazyGrid, whose parts take `memory` bytes."""
    memory = bytes_of(memory)
    if isinstance(data, Grid):
        return data
    if hasattr(data, "IsA") and hasattr(data, "GetPointData"):
        if not data.IsA("vtkImageData") and not data.IsA("vtkRectilinearGrid"):
            raise TypeError(f"the data set is a {data.GetClassName()}, it must be a vtkImageData or vtkRectilinearGrid")
        if spacing is not None or origin is not None or axes is not None:
            raise ValueError("a data set of VTK has its own spacing, origin and axes: leave these out")
        return _of_vtk(data, scalars, component)
    if scalars is not None or component is not None:
        raise ValueError("scalars and component choose among the arrays of a VTK data set; an array has none")
    if hasattr(data, "dims") and hasattr(data, "coords") and hasattr(data, "attrs"):
        return _of_xarray(data, spacing, origin, axes, memory, paged)
    lazy = lazy_of(data)
    data = data if lazy is None else opened(lazy, memory, paged)
    return _of_array(data, spacing, origin, "zyx" if axes is None else axes)
