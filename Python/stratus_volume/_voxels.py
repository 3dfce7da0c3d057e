# SPDX-License-Identifier: BSD-3-Clause
"""Effective voxels, which are those whose values show: their distance fields, their trees, and the first of them that rays hit."""
import ctypes
import typing

import numpy

from . import _declarations as c
from ._core import Owned, address, as_dict, choice, context as context_of, library, whole
from ._grid import grid_of
from ._values import is_number, number, scaled_point

_METHODS = ("exact", "zigzag", "envelope", "jfa", "jfa-1", "jfa-2", "1-jfa", "jfa-squared", "ajfa", "ajfa-fig5")


class Hits(typing.NamedTuple):
    """What rays hit. Arrays of the rays' shape, with an axis of 3 behind it for voxel and normal.

    t       where the ray enters the voxel: the place is origin + t direction; infinite where it hits nothing
    voxel   index into the array; -1 where the ray hits nothing
    face    face through which it enters: 2 axis, plus 1 for the upper face of that axis, with axis 0 for the fastest in memory; -1: none
    normal  of that face, in the world, of length 1
    """
    t: numpy.ndarray
    voxel: numpy.ndarray
    face: numpy.ndarray
    normal: numpy.ndarray


def _between(values, lower, upper, power):
    """The core's criterion. Of a bool array True shows, of any other all values, where nothing else is said."""
    if lower is None and upper is None and numpy.asarray(getattr(values, "values", values)).dtype == bool:
        lower = 1
    result = library.stratus_criterion_default()
    if lower is not None:
        result.lower = _limit(lower, "lower", power)
    if upper is not None:
        result.upper = _limit(upper, "upper", power)
    if not result.lower <= result.upper:
        raise ValueError(f"lower is {lower!r} and upper is {upper!r}, lower must be at most upper")
    return result


def _limit(value, name, power):
    if value in (numpy.inf, -numpy.inf):
        return float(value)
    return scaled_point(number(value, name), power)


class _Voxels(Owned):
    """A set of effective voxels of a grid. Made and used with the context's lock held."""

    def __init__(self, context, grid, criterion, power):
        super().__init__(context, library.stratus_voxels_destroy)
        volume = grid.view(power)
        context.call(library.stratus_voxels_create, context.pointer, ctypes.byref(volume), ctypes.byref(criterion), ctypes.byref(self.pointer))


def _prepared(data, lower, upper, options):
    known = {name: options.pop(name, None) for name in ("spacing", "origin", "axes", "scalars", "component")}
    context = context_of(options.pop("device", None), options.pop("threads", None))
    progress = options.pop("progress", None)
    if options:
        raise TypeError(f"unknown: {', '.join(sorted(options))}")
    grid = grid_of(data, **known)
    if grid.components > 1:
        raise ValueError(f"the values have {grid.components} components, effective voxels are of 1: choose one by array[..., 0] or component=")
    power = 0 if grid.nothing else grid.power([value for value in (lower, upper) if is_number(value) and numpy.isfinite(value)] or None)
    is_vtk = hasattr(data, "GetPointData")
    return grid, context, _between(grid.values if is_vtk else data, lower, upper, power), power, progress


def distance_field(data, lower=None, upper=None, method="exact", signed=False, **options):
    """Returns the distance from each voxel's centre to the centre of the nearest effective voxel, in voxels, as float32 in the array's shape.

    data          see Volume, also for axes, scalars, component, device and threads
    lower, upper  values in lower..upper are effective, ends included; default: all that are not masked, NaN or infinite, and of a bool array True
    method        exact, zigzag, envelope, or a jump flooding, which may overestimate: jfa, jfa-1, jfa-2, 1-jfa, jfa-squared, ajfa, ajfa-fig5
    signed        True: within, it is the distance to the nearest voxel that is not effective, negated
    progress      see render

    It is infinite if there is no effective voxel, and -infinite in a signed field if all voxels are effective.
    """
    if method not in _METHODS:
        raise ValueError(f"method is {method!r}, it must be one of {', '.join(_METHODS)}")
    grid, context, criterion, power, progress = _prepared(data, lower, upper, options)
    settings = library.stratus_field_options_default()
    settings.method, settings.is_signed = _METHODS.index(method), int(bool(signed))
    with context.lock:
        voxels = _Voxels(context, grid, criterion, power)
        field = Owned(context, library.stratus_field_destroy)
        context.call(library.stratus_field_create, context.pointer, voxels.pointer, ctypes.byref(settings), ctypes.byref(field.pointer), None,
                     progress=progress)
        distances = numpy.empty(grid.values.shape, numpy.float32)
        library.stratus_field_distances(field.pointer, address(distances))
    return grid.as_given(distances)


class Tree:
    """A tree of effective voxels, by which rays find the first of them.

    data          see Volume, also for spacing, origin, axes, scalars, component, device and threads
    lower, upper  as in distance_field
    method        auto, hybrid, hybrid-paper, distance, octant, sah, sweep, lbvh, ploc, ac, dpc, kmeans or wide
    max_depth     1..64, default 32
    progress      see render
    """

    def __init__(self, data, lower=None, upper=None, method="auto", max_depth=None, **options):
        grid, context, criterion, power, progress = _prepared(data, lower, upper, options)
        settings = library.stratus_tree_options_default()
        settings.method = choice(method, "stratus_tree_method", "STRATUS_TREE_", "method")
        if max_depth is not None:
            settings.max_depth = whole(max_depth, "max_depth", 1, 64)
        self._begin(context, grid.own)
        with context.lock:
            voxels = _Voxels(context, grid, criterion, power)
            context.call(library.stratus_tree_create, context.pointer, voxels.pointer, ctypes.byref(settings), ctypes.byref(self._tree.pointer),
                         progress=progress)

    def _begin(self, context, own):
        self.context, self._own = context, own
        self._tree = Owned(context, library.stratus_tree_destroy)

    @classmethod
    def load(cls, saved, device=None, threads=None):
        """Returns the tree of what `save` returned. Its hits name voxels by the axes of memory: slow, middle, fast."""
        self = cls.__new__(cls)
        self._begin(context_of(device, threads), (2, 1, 0))
        content = numpy.frombuffer(saved, numpy.uint8)
        with self.context.lock:
            self.context.call(library.stratus_tree_load, self.context.pointer, address(content), content.size, ctypes.byref(self._tree.pointer))
        return self

    def save(self):
        """Returns the tree as bytes, which `load` reads."""
        with self.context.lock:
            result = numpy.empty(library.stratus_tree_bytes(self._tree.pointer), numpy.uint8)
            library.stratus_tree_save(self._tree.pointer, address(result))
        return result.tobytes()

    @property
    def statistics(self):
        """dict of nodes, leaves, depth, voxels, bytes, the method that was used and why."""
        result = c.stratus_tree_statistics()
        with self.context.lock:
            library.stratus_tree_get_statistics(self._tree.pointer, ctypes.byref(result))
        return as_dict(result)

    def first_hits(self, origins, directions, t_min=0.0, t_max=numpy.inf, progress=None):
        """Returns the Hits of rays: origins and directions (..., 3) in the world, t_min and t_max (...). One may stand for many."""
        shape = numpy.broadcast_shapes(_triples(origins, "origins"), _triples(directions, "directions"), numpy.shape(t_min), numpy.shape(t_max))
        rays = numpy.empty((*shape, 8), numpy.float64)
        rays[..., :3], rays[..., 3:6], rays[..., 6], rays[..., 7] = origins, directions, t_min, t_max
        hits = numpy.empty(shape, numpy.dtype(c.stratus_hit))
        with self.context.lock:
            self.context.call(library.stratus_tree_first_hit, self.context.pointer, self._tree.pointer,
                              ctypes.cast(address(rays), ctypes.POINTER(c.stratus_ray)), hits.size,
                              ctypes.cast(address(hits), ctypes.POINTER(c.stratus_hit)), progress=progress)
        voxel = numpy.empty((*shape, 3), numpy.int32)
        for fast, axis in enumerate(self._own):
            voxel[..., axis] = hits["voxel"][..., fast]
        return Hits(hits["t"].copy(), voxel, hits["face"].copy(), hits["normal"].copy())


def _triples(values, name):
    shape = numpy.shape(values)
    if not shape or shape[-1] != 3:
        raise ValueError(f"{name} has the shape {shape}, its last axis must be x, y and z")
    return shape[:-1]


def first_hits(data, origins, directions, lower=None, upper=None, t_min=0.0, t_max=numpy.inf, **options):
    """Returns the Hits of rays with the effective voxels of a volume. A Tree does so again and again without building anew.

    data                 see Volume, also for spacing, origin, axes, scalars, component, device and threads
    origins, directions  (..., 3) in the world; directions of any length above 0
    lower, upper         as in distance_field
    t_min, t_max         the part of the rays that counts, in lengths of directions
    """
    return Tree(data, lower, upper, **options).first_hits(origins, directions, t_min, t_max)
