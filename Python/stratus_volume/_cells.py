# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of tetrahedra cut into the leaves of a K-D tree, and the order in which their cells hide one another."""
import ctypes
import typing

import numpy

from . import _declarations as c
from . import _view
from ._core import Owned, address, as_dict, choice, context as context_of, library, whole
from ._tetrahedra import listed
from ._values import is_number

_NODE = numpy.dtype([("axis", "i4"), ("below", "i4"), ("above", "i4"), ("reserved", "i4"), ("value", "f8")])


class Partition(typing.NamedTuple):
    """A mesh that planes have cut into the leaves of a K-D tree, which `partition` makes.

    points      float64 (n, 3): the mesh's own, then those on cut edges
    tetrahedra  int32 (m, 4), leaf by leaf, each oriented as the cell that it is a piece of
    cells       int32 (m,): the cell of the mesh that each is a piece of
    leaf        int32 (m,): its leaf
    ends        int32 (k, 2): the ends of the edge of each new point, the last k of points; an end may be a new point, too
    weights     float64 (k,): value = (1 - weight) value(ends[0]) + weight value(ends[1])
    nodes       records of the tree: axis (-1: a leaf), below and above (children; of a leaf, below is its number) and value, the plane's place
    frame       float64 (3, 3): rows are the axes along which the tree cuts
    counters    dict of leaves, cut_cells, tiny_pieces, largest_leaf and rotations
    """
    points: numpy.ndarray
    tetrahedra: numpy.ndarray
    cells: numpy.ndarray
    leaf: numpy.ndarray
    ends: numpy.ndarray
    weights: numpy.ndarray
    nodes: numpy.ndarray
    frame: numpy.ndarray
    counters: dict

    def at_points(self, values):
        """Returns values at the partition's points of values (n, ...) at the mesh's, interpolated along the cut edges."""
        given, old = numpy.asarray(values, numpy.float64), len(self.points) - len(self.ends)
        if given.ndim == 0 or len(given) != old:
            raise ValueError(f"values has the shape {given.shape}, it must have one for each of the mesh's {old} points")
        result = numpy.concatenate([given, numpy.empty((len(self.ends), *given.shape[1:]))])
        weights, done = self.weights.reshape(-1, *(1,) * (given.ndim - 1)), 0
        farthest = self.ends.max(axis=1) if len(self.ends) else self.ends
        while done < len(self.ends):
            # As many as depend only on points that are known by now.
            open_ends = numpy.nonzero(farthest[done:] >= old + done)[0]
            until = done + int(open_ends[0]) if len(open_ends) else len(self.ends)
            first, last = (result[self.ends[done:until, end]] for end in range(2))
            result[old + done:old + until] = (1 - weights[done:until]) * first + weights[done:until] * last
            done = until
        return result


def _array(place, kind, *shape):
    """Returns a copy of the memory at an address as an array."""
    count = int(numpy.prod(shape)) * numpy.dtype(kind).itemsize
    return numpy.frombuffer(ctypes.string_at(place, count) if count else b"", kind).reshape(shape).copy()


def _mesh_of(points, cells):
    mesh = library.stratus_mesh_default()
    mesh.points, mesh.point_count, mesh.vertices, mesh.cell_count = address(points), len(points), address(cells), len(cells)
    return mesh


def partition(points, tetrahedra, depth=3, rule="median", planes=64, growth=numpy.inf, imbalance=0.5, rotations=0, leaf_cells=1024, device=None,
              threads=None, progress=None):
    """Cuts a mesh conformingly by planes into the leaves of a K-D tree, and returns a Partition.

    points, tetrahedra  see Tetrahedra
    depth       0..16: at most 2**depth leaves
    rule        "median": planes through the mesh's own points, or "paper": evenly spaced ones (Li et al. 2012)
    planes      candidates along each axis of each node, 1..4096
    growth      bound on new cells for each cell of a node, above 0, may be infinite
    imbalance   bound on |l - r| / ((l + r)/2) of the cells on both sides, above 0
    rotations   how often the mesh may be turned if no plane satisfies the bounds, 0..64
    leaf_cells  a node of at most so many cells is not cut, at least 1
    """
    points, cells = listed(points, tetrahedra)
    options = library.stratus_partition_options_default()
    options.rule = choice(rule, "stratus_partition_rule", "STRATUS_PARTITION_", "rule")
    options.depth, options.planes = whole(depth, "depth", 0, 16), whole(planes, "planes", 1, 4096)
    options.rotations, options.leaf_cells = whole(rotations, "rotations", 0, 64), whole(leaf_cells, "leaf_cells", 1, 2**31 - 1)
    for name, value in dict(growth=growth, imbalance=imbalance).items():
        if not is_number(value):
            raise TypeError(f"{name} is {value!r}, it must be a number")
        if not value > 0:
            raise ValueError(f"{name} is {value!r}, it must be above 0")
        setattr(options, name, float(value))
    context = context_of(device, threads)
    made, mesh, found = Owned(context, library.stratus_partition_destroy), _mesh_of(points, cells), c.stratus_partition_result()
    with context.lock:
        context.call(library.stratus_partition_create, context.pointer, ctypes.byref(mesh), ctypes.byref(options), ctypes.byref(made.pointer),
                     progress=progress)
        library.stratus_partition_get(made.pointer, ctypes.byref(found))
        new, leaves = found.point_count - found.old_points, found.leaves
        counters = {name: getattr(found, name) for name in ("cut_cells", "tiny_pieces", "largest_leaf", "rotations")}
        return Partition(
            _array(found.points, numpy.float64, found.point_count, 3), _array(found.vertices, numpy.int32, found.cell_count, 4),
            _array(found.cells, numpy.int32, found.cell_count), _array(leaves.leaf, numpy.int32, found.cell_count),
            _array(found.ends, numpy.int32, new, 2), _array(found.weights, numpy.float64, new),
            _array(ctypes.cast(leaves.nodes, ctypes.c_void_p).value, _NODE, leaves.node_count), numpy.array(leaves.frame).reshape(3, 3),
            dict(leaves=leaves.leaf_count, **counters))


class VisibilityOrder:
    """The order in which a mesh's cells hide one another, for one view after another. Structures of the mesh are built once.

    points, tetrahedra  see Tetrahedra. Or only a Partition, whose leaves are sorted in parallel
    device, threads     see Volume
    """

    def __init__(self, points, tetrahedra=None, device=None, threads=None):
        leaves = None
        if isinstance(points, Partition):
            if tetrahedra is not None:
                raise ValueError("a Partition has its own tetrahedra: leave these out")
            self._nodes, self._leaf = numpy.ascontiguousarray(points.nodes), numpy.ascontiguousarray(points.leaf, numpy.int32)
            leaves = c.stratus_leaves(nodes=ctypes.cast(address(self._nodes), ctypes.POINTER(c.stratus_partition_node)),
                                      node_count=len(self._nodes), leaf_count=points.counters["leaves"], leaf=address(self._leaf))
            leaves.frame[:] = points.frame.reshape(-1)
            points, tetrahedra = points.points, points.tetrahedra
        self._points, self._cells = listed(points, tetrahedra)
        self.context = context_of(device, threads)
        self._order, mesh = Owned(self.context, library.stratus_visibility_order_destroy), _mesh_of(self._points, self._cells)
        self._order.borrowed = self._points, self._cells, leaves, getattr(self, "_nodes", None), getattr(self, "_leaf", None)
        with self.context.lock:
            self.context.call(library.stratus_visibility_order_create, self.context.pointer, ctypes.byref(mesh),
                              None if leaves is None else ctypes.byref(leaves), ctypes.byref(self._order.pointer))

    def sort(self, camera=None, peeling="nearest", progress=None):
        """Returns the numbers of all cells, int64 (m,), front to back, and a dict of counters: cycles, forced, overlaps, reused, times in ms.

        camera   see render; only where its eye is counts, or of parallel rays their direction
        peeling  "nearest": the nearest cell next, behind all that hide it (Williams 1992); "layers": all that none hides, then all that only
                 these hid (Li et al. 2012)
        """
        kind = choice(peeling, "stratus_peeling", "STRATUS_PEELING_", "peeling")
        found = c.stratus_visibility_result()
        ends = (self._points.min(axis=0), self._points.max(axis=0)) if len(self._points) else (numpy.zeros(3), numpy.zeros(3))
        with self.context.lock:
            view = _view.make(self.context, camera, [float(end[axis]) for axis in range(3) for end in ends], (1, 1))
            self.context.call(library.stratus_visibility_order_sort, self._order.pointer, ctypes.byref(view), None, kind, ctypes.byref(found),
                              progress=progress)
            cells = _array(found.cells, numpy.uint32, found.count).astype(numpy.int64)
        counters = as_dict(found)
        del counters["cells"]
        return cells, counters
