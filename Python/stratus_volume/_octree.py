# SPDX-License-Identifier: BSD-3-Clause
"""An octree of boxes that is split where the border of a view runs: which of them a camera sees, and which of them touch a box, ball or ray."""
import ctypes
import typing

import numpy

from . import _declarations as c
from . import _view
from ._core import Owned, address, as_dict, choice, context as context_of, library, whole
from ._values import is_number, number, numbers, pixels as window_of


class Visible(typing.NamedTuple):
    """The boxes that a view sees.

    ids       uint32: visible boxes, each once, in no order
    coverage  float32: fraction of the window, 0..1, that the square about each box's bounding sphere covers; None without coverage=True
    depth     float32: distance of each box's centre from the near plane; None without coverage=True
    counters  dict of nodes_tested, objects_tested, objects_retested, splits, collapses and objects_handed_down
    """
    ids: numpy.ndarray
    coverage: typing.Any
    depth: typing.Any
    counters: dict


def _boxes(bounds):
    """Returns bounds (n, 6), or centres and half edges (n, 12), as float64. A single box may have one axis."""
    own = numpy.asarray(bounds)
    if own.dtype.kind not in "iuf" or own.ndim not in (1, 2) or own.shape[-1] not in (6, 12):
        raise ValueError(f"bounds has the shape {own.shape} and type {own.dtype}, it must be numbers (n, 6): xmin, xmax, ymin, ymax, zmin, zmax; "
                         "or (n, 12): a centre and three half edges")
    return numpy.ascontiguousarray(own.reshape(-1, own.shape[-1]), numpy.float64)


def _ids(ids):
    own = numpy.asarray(ids).reshape(-1)
    if own.size and (own.dtype.kind not in "iu" or own.min() < 0 or own.max() >= 2**32):
        raise ValueError(f"ids has the type {own.dtype}, it must be whole numbers in 0..{2**32 - 1}")
    return numpy.ascontiguousarray(own, numpy.uint32)


class Octree:
    """Boxes in an octree that is split where a view's border runs (Li & Huang 2024), for scenes of thousands to millions of them.

    bounds          the first boxes' bounds, see insert; their ids are 0, 1, 2 and so on. Default: none
    placement       "enclosing": each in the smallest node that encloses it; "touching": in every leaf that its sphere touches, as in the paper
    stop            a node that is partly visible is split while it is larger than `pixels` on screen ("pixels"), while L / (c S) < 1 with L and S
                    along the axes ("manhattan") or as lengths ("euclid"), or always ("static")
    levels          number of levels below the root, 0..21, default 21; 0 is a plain list
    leaf_objects    a node of at most so many boxes is not split, 1..2**20, default 256
    pixels          size on screen, in a window 1000 pixels high, above 0, default 32
    c               the factor in L / (c S), above 0, default 35
    looseness       factor by which nodes count as wider, 1..2, default 1.25
    collapse_after  calls of cull for which a node keeps children that no border has crossed, default 256; 0: without limit
    split_budget    largest number of boxes that one call hands down to children; default 0: no limit
    threads         1..1024; default: as many as OpenMP offers

    A view's visible boxes do not depend on any of these, except that "touching" may keep other boxes that are out of sight.
    """

    def __init__(self, bounds=None, placement="enclosing", stop="pixels", levels=21, leaf_objects=256, pixels=32.0, c=35.0, looseness=1.25,
                 collapse_after=256, split_budget=0, threads=None):
        options = library.stratus_octree_options_default()
        options.placement = choice(placement, "stratus_octree_placement", "STRATUS_OCTREE_", "placement")
        options.stop = choice(stop, "stratus_octree_stop", "STRATUS_OCTREE_STOP_", "stop")
        options.levels, options.leaf_objects = whole(levels, "levels", 0, 21), whole(leaf_objects, "leaf_objects", 1, 2**20)
        options.pixels, options.c, options.looseness = number(pixels, "pixels"), number(c, "c"), number(looseness, "looseness")
        options.collapse_after, options.split_budget = whole(collapse_after, "collapse_after", 0, 2**31 - 1), whole(split_budget, "split_budget", 0, 2**62)
        self.context, self._views = context_of("host", threads), {}
        views = self._views

        def destroy(tree):
            for view in views.values():
                library.stratus_octree_view_destroy(view)
            library.stratus_octree_destroy(tree)
        self._tree = Owned(self.context, destroy)
        with self.context.lock:
            self.context.call(library.stratus_octree_create, self.context.pointer, ctypes.byref(options), ctypes.byref(self._tree.pointer))
        if bounds is not None:
            self.insert(bounds)

    def __len__(self):
        return int(library.stratus_octree_count(self._tree.pointer))

    def insert(self, bounds):
        """Adds boxes, all or none, and returns their ids, uint32 (n,).

        bounds  (n, 6): xmin, xmax, ymin, ymax, zmin, zmax, each minimum at most its maximum; or (n, 12), turned boxes: a centre and three half
                edges. A box with a number that is not finite, or beyond 1e30, is seen by every view
        """
        boxes = _boxes(bounds)
        ids = numpy.empty(len(boxes), numpy.uint32)
        function = library.stratus_octree_insert if boxes.shape[1] == 6 else library.stratus_octree_insert_oriented
        self._call(function, address(boxes), len(boxes), address(ids))
        return ids

    def move(self, ids, bounds):
        """Gives boxes other bounds: ids (n,), bounds as in insert."""
        own, boxes = _ids(ids), _boxes(bounds)
        if len(own) != len(boxes):
            raise ValueError(f"ids has {len(own)} and bounds {len(boxes)}, there must be as many of both")
        function = library.stratus_octree_move if boxes.shape[1] == 6 else library.stratus_octree_move_oriented
        self._call(function, address(own), address(boxes), len(own))

    def remove(self, ids):
        """Takes boxes out: ids (n,). Boxes that come later may have these ids."""
        own = _ids(ids)
        self._call(library.stratus_octree_remove, address(own), len(own))

    def bounds(self, ids):
        """Returns the bounds of boxes, float64 (n, 6). A turned box has the bounds of the straight box around it."""
        own = _ids(ids)
        result = numpy.empty((len(own), 6))
        for one, row in zip(own, result):
            six = (ctypes.c_double * 6)()
            self._call(library.stratus_octree_bounds, int(one), six)
            row[:] = six
        return result

    def cull(self, camera=None, size=(640, 480), near=0.0, far=numpy.inf, planes=None, eye=None, exact=False, coverage=False, hold=False,
             view="main"):
        """Returns the Visible of a view, and refines the tree where its border runs.

        camera, size  see render; the default camera sees all boxes
        near, far     distances of the first and of the last plane from the eye, 0 <= near < far; far may be infinite
        planes        in place of camera, size, near and far: (6, 4) of a, b, c, d, with a x + b y + c z + d >= 0 inside: left, right, bottom, top,
                      near, far, as of vtkCamera.GetFrustumPlanes()
        eye           with planes: x, y, z of the eye, for the stops by distance; default 0, 0, 0
        exact         True: boxes beyond an edge of the frustum, which a test of only its planes keeps, are left out, too
        coverage      True: coverage and depth are filled in
        hold          True: the tree stays as it is in this call
        view          a name of the view: results of a view serve its next call
        """
        frustum, options, found = c.stratus_frustum(), c.stratus_octree_cull_options(), c.stratus_octree_visible()
        options.exact, options.coverage, options.hold = int(bool(exact)), int(bool(coverage)), int(bool(hold))
        with self.context.lock:
            if planes is not None:
                given = numpy.asarray(planes)
                if given.shape != (6, 4) and given.shape != (24,) or given.dtype.kind not in "iuf":
                    raise ValueError(f"planes has the shape {given.shape} and type {given.dtype}, it must be numbers (6, 4)")
                for own, row in zip(frustum.planes, given.reshape(6, 4)):
                    own[:] = [float(part) for part in row]
                frustum.eye[:] = (0.0, 0.0, 0.0) if eye is None else numbers(eye, 3, "eye")
            else:
                if eye is not None:
                    raise ValueError(f"eye is {eye!r}, but a camera has its own")
                seen = _view.make(self.context, camera, self._all(), window_of(size))
                if not is_number(near) or not is_number(far) or not 0 <= near < far:
                    raise ValueError(f"near is {near!r} and far is {far!r}, they must be 0 <= near < far")
                seen.near_k, seen.far_k = float(near), float(far)
                self.context.call(library.stratus_frustum_from_camera, self.context.pointer, ctypes.byref(seen), ctypes.byref(frustum))
            if view not in self._views:
                pointer = ctypes.c_void_p()
                self._call(library.stratus_octree_view_create, self._tree.pointer, ctypes.byref(pointer), tree=False)
                self._views[view] = pointer
            self._call(library.stratus_octree_cull, self._views[view], ctypes.byref(frustum), ctypes.byref(options), ctypes.byref(found), tree=False)
            columns = [None if not place else numpy.frombuffer(ctypes.string_at(place, found.count * 4), kind).copy()
                       for place, kind in ((found.ids, numpy.uint32), (found.coverage, numpy.float32), (found.depth, numpy.float32))]
        columns[0] = numpy.empty(0, numpy.uint32) if columns[0] is None else columns[0]
        counters = {name: value for name, value in as_dict(found).items() if name not in Visible._fields and name != "count"}
        return Visible(*columns, counters)

    def in_box(self, bounds):
        """Returns the ids of the boxes that touch one, in rising order: xmin, xmax, ymin, ymax, zmin, zmax, which may be infinite."""
        own = numpy.asarray(bounds, numpy.float64)
        if own.shape != (6,):
            raise ValueError(f"bounds has the shape {own.shape}, it must be 6 numbers")
        return self._query(library.stratus_octree_query_box, _six(own))

    def in_sphere(self, center, radius):
        """Returns the ids of the boxes that touch a ball, in rising order: center x, y, z, and radius, at least 0, which may be infinite."""
        if not is_number(radius) or not radius >= 0:
            raise ValueError(f"radius is {radius!r}, it must be a number of at least 0")
        return self._query(library.stratus_octree_query_sphere, _three(center, "center"), float(radius))

    def along_ray(self, origin, direction, t_max=numpy.inf):
        """Returns the ids of the boxes that origin + t direction meets, 0 <= t <= t_max, and the t at which it enters each, in rising order of t."""
        if not is_number(t_max) or not t_max >= 0:
            raise ValueError(f"t_max is {t_max!r}, it must be a number of at least 0")
        places = numpy.empty(len(self), numpy.float64)
        ids = self._query(library.stratus_octree_query_ray, _three(origin, "origin"), _three(direction, "direction"), float(t_max),
                          between=(address(places),))
        return ids, places[:len(ids)].copy()

    def nearest(self, point, k=1):
        """Returns the ids of the k nearest boxes and their distances, nearest first: 0 for boxes that hold the point."""
        count, most = ctypes.c_size_t(), min(whole(k, "k", 1, 2**31 - 1), max(1, len(self)))
        ids, distances = numpy.empty(most, numpy.uint32), numpy.empty(most, numpy.float64)
        self._call(library.stratus_octree_query_nearest, _three(point, "point"), most, address(ids), address(distances), ctypes.addressof(count))
        return ids[:count.value].copy(), distances[:count.value].copy()

    @property
    def statistics(self):
        """dict of objects, unbounded, references, nodes, split_nodes, depth, object_bytes, bytes and root."""
        result = c.stratus_octree_statistics()
        with self.context.lock:
            library.stratus_octree_get_statistics(self._tree.pointer, ctypes.byref(result))
        return as_dict(result)

    def _all(self):
        root = self.statistics["root"]
        return root if any(root) else (0.0, 1.0, 0.0, 1.0, 0.0, 1.0)

    def _call(self, function, *arguments, tree=True):
        with self.context.lock:
            self.context.call(function, *([self._tree.pointer] if tree else []), *arguments)

    def _query(self, function, *arguments, between=()):
        ids, count = numpy.empty(max(1, len(self)), numpy.uint32), ctypes.c_size_t()
        self._call(function, *arguments, address(ids), *between, len(ids) if not between else len(self), ctypes.addressof(count))
        return ids[:count.value].copy()


def _six(values):
    return (ctypes.c_double * 6)(*values)


def _three(values, name):
    return (ctypes.c_double * 3)(*numbers(values, 3, name))
