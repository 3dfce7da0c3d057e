# SPDX-License-Identifier: BSD-3-Clause
"""Nodes and faces of meshes of an xarray.Dataset: UGRID, FVCOM, MPAS, and cells with bounds as ICON has them. This file finds the variables; the
core makes faces of their tables, as it does for the readers of files."""
import ctypes

import numpy

from . import _declarations as c
from . import _earth
from ._annotation import Axis
from ._core import address, context as context_of, library
from ._dimensions import axis_of, values_of

_MOST = c.CONSTANTS["STRATUS_FACE_NODES_MAX"]


def text(variable, key):
    """An attribute of a variable, which xarray may have moved to its encoding."""
    found = variable.attrs.get(key)
    return str((getattr(variable, "encoding", None) or {}).get(key, "") if found is None else found).strip()


def numbers_of(variable):
    """Values as float64, NaN where there is none."""
    return numpy.ma.filled(numpy.ma.asarray(values_of(variable), numpy.float64), numpy.nan)


def _degrees(variable, usual=""):
    """Values of a coordinate in degrees, or None if it is no angle. usual: the unit of a coordinate that has none."""
    unit = (text(variable, "units") or usual).lower()
    if unit in ("rad", "radian", "radians"):
        return numpy.degrees(numbers_of(variable))
    return numbers_of(variable) if unit.startswith("degree") else None


def _is(variable, kind):
    east = kind == "longitude"
    named = axis_of("", variable) == ("x" if east else "y") and text(variable, "units").lower().startswith("degree")
    return named or text(variable, "standard_name") == kind


def variables_of(data):
    """The variables of a Dataset by name. A DataArray does not have the mesh: xarray gives it no coordinate of other dimensions."""
    return {name: data[name] for name in data.variables}


def _copy(where, kind, count):
    """An array of numbers of the core, which may release its own."""
    return numpy.array((kind * int(count)).from_address(where))


class _Own:
    """Faces as the Dataset has them, and the arrays that the struct points to."""

    def __init__(self, faces):
        self.struct, self._arrays = faces.struct, (faces.offsets, faces.nodes, faces.absent)


class Faces:
    """Nodes and faces of a Dataset. On a plane around the Earth there are nodes and parts of faces behind these, where the core cuts faces at a meridian.

    places       float64 (nodes, 2): longitude and latitude in degrees on a sphere, x and y in metres on a plane
    axes         on a plane: two Axis, the data's own numbers along x and y
    node, face   names of the dimensions of nodes and of faces; None: there is none
    description  where nodes and faces are from
    """

    def __init__(self, variables, on_sphere=True):
        self._variables, self._on_sphere, self.context = variables, on_sphere, context_of("host", 1)
        found = self._find()
        if found is None:
            raise ValueError("there is no mesh: no variable of cf_role mesh_topology and topology_dimension 2, no 'nv' of FVCOM, no 'cellsOnVertex' or "
                             "'verticesOnCell' of MPAS, and no longitudes and latitudes with bounds of three or more corners")
        self.axes = [Axis("x", "m"), Axis("y", "m")]
        found[0]()
        unknown = numpy.nonzero(~numpy.isfinite(self.places))[0]
        if len(unknown):
            what = "longitude or latitude" if self._in_degrees else "x or y"
            raise ValueError(f"the {self.description} have no {what} at number {unknown[0]}")
        self._own, self._node_of = _Own(self), None
        if not on_sphere and self._in_degrees:
            self._flatten()
        self._call(library.stratus_faces_turn, ctypes.byref(self.struct), address(self.places), int(on_sphere))

    @classmethod
    def _found_in(cls, variables):
        own = cls.__new__(cls)
        own._variables = variables
        return own._find()

    @classmethod
    def dimensions(cls, variables):
        """Names of dimensions that the variables of a mesh have, none if there is no mesh."""
        found = cls._found_in(variables)
        return set() if found is None else {dimension for name in found[1] if name in variables for dimension in variables[name].dims}

    @classmethod
    def are_in(cls, variables):
        """Whether the variables describe a mesh, whatever else is wrong with it."""
        return cls._found_in(variables) is not None

    def _find(self):
        """The function that makes faces of the variables, and names of variables that have the dimensions of the mesh; or None."""
        for name, one in self._variables.items():
            if text(one, "cf_role") == "mesh_topology" and text(one, "topology_dimension") in ("", "2"):
                names = (*text(one, "node_coordinates").split(), text(one, "face_node_connectivity"))
                return lambda: self._of_topology(name, one), names
        if "nv" in self._variables and len(self._variables["nv"].dims) == 2:
            return self._of_fvcom, ("nv", "lon", "x")
        for name in ("cellsOnVertex", "verticesOnCell"):
            if name in self._variables and len(self._variables[name].dims) == 2:
                return lambda: self._of_mpas(name), (name, "lonCell", "lonVertex", "xCell", "xVertex")
        found = [self._bounds(kind) for kind in ("longitude", "latitude")]
        for own in found[0]:
            for other in found[1]:
                if own[1].dims == other[1].dims:
                    return lambda: self._of_bounds(own, other), (own[2],)
        return None

    def _bounds(self, kind):
        """Longitudes or latitudes of cells whose bounds are corners: lists of the coordinate, its bounds and its name."""
        result = []
        for name, one in self._variables.items():
            bounds = self._variables.get(text(one, "bounds"))
            if len(one.dims) == 1 and bounds is not None and _is(one, kind) and len(bounds.dims) == 2 and bounds.dims[0] == one.dims[0] and \
                    3 <= bounds.shape[1] <= _MOST:
                result.append((one, bounds, name))
        return result

    def _named(self, name, what):
        if name not in self._variables:
            raise ValueError(f"the mesh has no {what}: there is no variable {name!r}")
        return self._variables[name]

    def _call(self, function, *arguments):
        with self.context.lock:
            self.context.call(function, self.context.pointer, *arguments)

    def _make(self, numbers, first, nodes, faces, what, rows_are_nodes=False, fewest=0):
        numbers = numpy.ascontiguousarray(numbers, numpy.float64)
        self.offsets, self.absent = numpy.zeros(faces + 1, numpy.int64), numpy.zeros(faces, numpy.uint8)
        self.nodes = numpy.zeros(numbers.size + 3 * faces, numpy.int32)
        self.struct = c.stratus_faces(node_count=nodes, face_count=faces, offsets=address(self.offsets), nodes=address(self.nodes),
                                      absent=address(self.absent))
        table = c.stratus_face_table(numbers=address(numbers), rows=numbers.shape[0], columns=numbers.shape[1], first=first,
                                     rows_are_nodes=int(rows_are_nodes), fewest=fewest)
        try:
            self._call(library.stratus_faces_from_table, ctypes.byref(table), ctypes.byref(self.struct))
        except ValueError as error:
            raise ValueError(f"{what!r}: {error}") from None

    def _of_topology(self, name, topology):
        at = [self._named(each, f"node_coordinates of two variables, its own are {text(topology, 'node_coordinates')!r}")
              for each in (*text(topology, "node_coordinates").split(), "", "")[:2]]
        if _is(at[0], "latitude"):
            at.reverse()
        self._place(name, *at)
        connectivity = text(topology, "face_node_connectivity")
        table = self._named(connectivity, "face_node_connectivity")
        if len(table.dims) != 2:
            raise ValueError(f"the faces' nodes {connectivity!r} have the dimensions {tuple(table.dims)}, they must have two")
        turned = table.shape[1] > _MOST >= table.shape[0]
        numbers = numbers_of(table).T if turned else numbers_of(table)
        self.face = table.dims[1 if turned else 0]
        self._make(numbers, float(text(table, "start_index") or 0), len(self.places), len(numbers), connectivity)
        self.description = f"nodes of the mesh {name!r}"

    def _place(self, name, *at, usual=""):
        """usual: the unit of coordinates that have none."""
        places, self._in_degrees = [_degrees(each, usual) for each in at], True
        if not self._on_sphere and all(each is None for each in places):
            units = [text(each, "units") or usual for each in at]
            if all(unit in _earth._LENGTHS for unit in units):
                places, self._in_degrees = [numbers_of(each) * _earth._LENGTHS[unit] for each, unit in zip(at, units)], False
        if any(each is None or each.ndim != 1 for each in places) or places[0].shape != places[1].shape:
            what = "in degrees, so that it has no place on a sphere" if self._on_sphere else "in degrees, nor x and y in a unit of length"
            raise ValueError(f"the mesh {name!r} has no longitudes and latitudes of nodes {what}")
        self.places, self.node = numpy.stack(places, axis=1), at[0].dims[0]

    def _flatten(self):
        """Makes places of degrees metres at the middle latitude. The core makes longitudes continuous, or cuts faces at a meridian."""
        flat, north = c.stratus_flat_faces(), self.places[:, 1]
        self._call(library.stratus_faces_flatten, ctypes.byref(self.struct), address(self.places), ctypes.byref(flat))
        try:
            nodes, faces = flat.faces.node_count, flat.faces.face_count
            self.offsets = _copy(flat.faces.offsets, ctypes.c_int64, faces + 1)
            self.nodes, self.absent = _copy(flat.faces.nodes, ctypes.c_int32, self.offsets[-1]), _copy(flat.faces.absent, ctypes.c_uint8, faces)
            degrees = _copy(flat.degrees, ctypes.c_double, 2 * nodes).reshape(-1, 2)
            self._node_of, self._weights = _copy(flat.node_of, ctypes.c_int32, 2 * nodes).reshape(-1, 2), _copy(flat.weights, ctypes.c_double, nodes)
            self._face_of = _copy(flat.face_of, ctypes.c_int32, faces)
            self.description += f", faces cut at longitude {flat.meridian:g}" if flat.cut else ""
        finally:
            with self.context.lock:
                library.stratus_flat_faces_destroy(self.context.pointer, ctypes.byref(flat))
        self.struct = c.stratus_faces(node_count=nodes, face_count=faces, offsets=address(self.offsets), nodes=address(self.nodes),
                                      absent=address(self.absent))
        degree = numpy.radians(_earth._RADIUS)
        metres = degree * numpy.cos(numpy.radians(0.5 * (north.min() + north.max()))), degree
        self.places = numpy.ascontiguousarray(degrees * metres)
        self.axes = [Axis(kind, "degrees", 1 / scale, kind) for kind, scale in zip(("longitude", "latitude"), metres)]

    def _of_fvcom(self):
        flat = not self._on_sphere and "lon" not in self._variables
        self._place("nv", *(self._named(*each) for each in ((("x", "x"), ("y", "y")) if flat else (("lon", "longitudes"), ("lat", "latitudes")))),
                    usual="m" if flat else "degrees")
        table = self._variables["nv"]
        turned = table.shape[0] <= 4
        numbers = numbers_of(table).T if turned else numbers_of(table)
        self.face = table.dims[1 if turned else 0]
        self._make(numbers, float(text(table, "start_index") or 1), len(self.places), len(numbers), "nv")
        self.description = "nodes of FVCOM"

    def _of_mpas(self, name):
        flat = text(self._variables[name], "on_a_sphere").lower() == "no"
        if flat and self._on_sphere:
            raise ValueError("the mesh of MPAS is not on a sphere")
        self._place(name, *(self._named(each, "middles of cells") for each in (("xCell", "yCell") if flat else ("lonCell", "latCell"))),
                    usual="m" if flat else "radian")
        table = self._variables[name]
        numbers, by_vertex = numbers_of(table), name == "cellsOnVertex"
        numbers[numbers == 0] = numpy.nan
        faces, self.face = len(numbers), table.dims[0]
        if not by_vertex:
            corners = self._named("xVertex" if flat else "lonVertex", "corners of cells")
            faces, self.face = corners.shape[0], corners.dims[0]
            if "nEdgesOnCell" in self._variables:
                numbers[numpy.arange(numbers.shape[1]) >= numbers_of(self._variables["nEdgesOnCell"])[:, None]] = numpy.nan
        fewest = numbers.shape[1] if by_vertex else 3  # a corner at the border of a region has fewer cells
        self._make(numbers, 1, len(self.places), faces, name, not by_vertex, fewest)
        self.description = "middles of the cells of MPAS"

    def _of_bounds(self, *both):
        usual = "degree"
        at = [_degrees(bounds, text(bounds, "units") or text(one, "units") or usual) for one, bounds, _ in both]
        corners = numpy.ascontiguousarray(numpy.stack([each.reshape(-1) for each in at], axis=1))
        numbers, first, count = numpy.zeros(len(corners), numpy.int32), numpy.zeros(len(corners), numpy.int64), ctypes.c_int64()
        self._call(library.stratus_faces_join_corners, len(corners), address(corners), address(numbers), address(first), ctypes.byref(count))
        self.places, self._in_degrees = numpy.ascontiguousarray(corners[first[:count.value]]), True
        self.node, self.face = None, both[0][0].dims[0]
        self._make(numbers.reshape(at[0].shape), 0, count.value, len(at[0]), "bounds", fewest=3)
        self.description = "corners of cells"

    def spread(self, values, on_nodes):
        """Values (..., nodes or faces of the Dataset) at all nodes or faces: those of a cut edge are between the values at its ends."""
        if self._node_of is None:
            return values
        if not on_nodes:
            return values[..., self._face_of]
        between = self._node_of[:, 0] != self._node_of[:, 1]
        result = values[..., self._node_of[:, 0]]
        ends, weights = self._node_of[between], self._weights[between]
        result[..., between] = weights * values[..., ends[:, 0]] + (1 - weights) * values[..., ends[:, 1]]
        return result

    def at_nodes(self, values, on_nodes):
        """Values (levels, nodes or faces of the Dataset) at all nodes, those of faces as means over the faces around each that have one; NaN: none."""
        values = numpy.ascontiguousarray(numpy.ma.filled(numpy.ma.asarray(values, numpy.float64), numpy.nan))
        if not on_nodes:
            of_faces, values = values, numpy.empty((len(values), self._own.struct.node_count))
            for level, own in zip(values, of_faces):
                self._call(library.stratus_faces_to_nodes, ctypes.byref(self._own.struct), address(own), address(level))
        return self.spread(values, True)
