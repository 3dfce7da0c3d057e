# SPDX-License-Identifier: BSD-3-Clause
"""Meshes in layers of an xarray.Dataset: UGRID, MPAS, and cells with bounds as ICON has them. This file finds which variables are nodes, faces
and heights; the core makes faces, heights of layers and tetrahedra of them, as it does for the readers of files."""
import ctypes

import numpy

from . import _declarations as c
from . import _earth
from ._core import address, context as context_of, library
from ._dimensions import axis_of, values_of

_BORDERS = ("zCoordinates", "zcor", "z_coordinates", "zgrid", "z_ifc", "zghalf", "HHL")
_MIDDLES = ("z_mc", "zMid")
_STANDARD_BORDERS = ("altitude", "height", "geometric_height_at_half_level_center")
_STANDARD_MIDDLE = "geometric_height_at_full_level_center"
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


def _length(variable):
    """Values of a length in metres; without a unit they are metres."""
    return numbers_of(variable) * _earth._LENGTHS.get(text(variable, "units"), 1.0)


def _is(variable, kind):
    east = kind == "longitude"
    named = axis_of("", variable) == ("x" if east else "y") and text(variable, "units").lower().startswith("degree")
    return named or text(variable, "standard_name") == kind


def variables_of(data):
    """The variables of a Dataset by name. A DataArray does not have the mesh: xarray gives it no coordinate of other dimensions."""
    return {name: data[name] for name in data.variables}


class Faces:
    """Nodes and faces of a Dataset.

    degrees      float64 (nodes, 2): longitude and latitude
    node, face   names of the dimensions of nodes and of faces; None: there is none
    description  where nodes and faces are from
    """

    def __init__(self, variables):
        self._variables, self.context = variables, context_of("host", 1)
        of = self._find()
        if of is None:
            raise ValueError("there is no mesh: no variable of cf_role mesh_topology and topology_dimension 2, no 'cellsOnVertex' or 'verticesOnCell' "
                             "of MPAS, and no longitudes and latitudes with bounds of three or more corners")
        of()
        unknown = numpy.nonzero(~numpy.isfinite(self.degrees))[0]
        if len(unknown):
            raise ValueError(f"the {self.description} have no longitude or latitude at number {unknown[0]}")
        self._call(library.stratus_faces_turn, ctypes.byref(self.struct), address(self.degrees), 1)

    @classmethod
    def are_in(cls, variables):
        """Whether the variables describe a mesh, whatever else is wrong with it."""
        own = cls.__new__(cls)
        own._variables = variables
        return own._find() is not None

    def _find(self):
        """The function that makes faces of the variables, or None."""
        for name, one in self._variables.items():
            if text(one, "cf_role") == "mesh_topology" and text(one, "topology_dimension") in ("", "2"):
                return lambda: self._of_topology(name, one)
        for name in ("cellsOnVertex", "verticesOnCell"):
            if name in self._variables and len(self._variables[name].dims) == 2:
                return lambda: self._of_mpas(name)
        found = [self._bounds(kind) for kind in ("longitude", "latitude")]
        for own in found[0]:
            for other in found[1]:
                if own[1].dims == other[1].dims:
                    return lambda: self._of_bounds(own, other)
        return None

    def _bounds(self, kind):
        """Longitudes or latitudes of cells whose bounds are corners: lists of the coordinate and its bounds."""
        result = []
        for one in self._variables.values():
            bounds = self._variables.get(text(one, "bounds"))
            if len(one.dims) == 1 and bounds is not None and _is(one, kind) and len(bounds.dims) == 2 and bounds.dims[0] == one.dims[0] and \
                    3 <= bounds.shape[1] <= _MOST:
                result.append((one, bounds))
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
        degrees = [_degrees(each) for each in at]
        if any(each is None or each.ndim != 1 for each in degrees) or degrees[0].shape != degrees[1].shape:
            raise ValueError(f"the mesh {name!r} has no longitudes and latitudes of nodes in degrees, so that it has no place on a sphere")
        self.degrees, self.node = numpy.stack(degrees, axis=1), at[0].dims[0]
        connectivity = text(topology, "face_node_connectivity")
        table = self._named(connectivity, "face_node_connectivity")
        if len(table.dims) != 2:
            raise ValueError(f"the faces' nodes {connectivity!r} have the dimensions {tuple(table.dims)}, they must have two")
        turned = table.shape[1] > _MOST >= table.shape[0]
        numbers = numbers_of(table).T if turned else numbers_of(table)
        self.face = table.dims[1 if turned else 0]
        self._make(numbers, float(text(table, "start_index") or 0), len(self.degrees), len(numbers), connectivity)
        self.description = f"nodes of the mesh {name!r}"

    def _of_mpas(self, name):
        if text(self._variables[name], "on_a_sphere").lower() == "no":
            raise ValueError("the mesh of MPAS is not on a sphere")
        lon, lat = (self._named(each, "middles of cells") for each in ("lonCell", "latCell"))
        self.degrees, self.node = numpy.stack([_degrees(lon, "radian"), _degrees(lat, "radian")], axis=1), lon.dims[0]
        table = self._variables[name]
        numbers, by_vertex = numbers_of(table), name == "cellsOnVertex"
        numbers[numbers == 0] = numpy.nan
        faces, self.face = len(numbers), table.dims[0]
        if not by_vertex:
            corners = self._named("lonVertex", "corners of cells")
            faces, self.face = corners.shape[0], corners.dims[0]
            if "nEdgesOnCell" in self._variables:
                numbers[numpy.arange(numbers.shape[1]) >= numbers_of(self._variables["nEdgesOnCell"])[:, None]] = numpy.nan
        fewest = numbers.shape[1] if by_vertex else 3  # a corner at the border of a region has fewer cells
        self._make(numbers, 1, len(self.degrees), faces, name, not by_vertex, fewest)
        self.description = "middles of the cells of MPAS"

    def _of_bounds(self, *both):
        usual = "degree"
        at = [_degrees(bounds, text(bounds, "units") or text(one, "units") or usual) for one, bounds in both]
        corners = numpy.ascontiguousarray(numpy.stack([each.reshape(-1) for each in at], axis=1))
        numbers, first, count = numpy.zeros(len(corners), numpy.int32), numpy.zeros(len(corners), numpy.int64), ctypes.c_int64()
        self._call(library.stratus_faces_join_corners, len(corners), address(corners), address(numbers), address(first), ctypes.byref(count))
        self.degrees = numpy.ascontiguousarray(corners[first[:count.value]])
        self.node, self.face = None, both[0][0].dims[0]
        self._make(numbers.reshape(at[0].shape), 0, count.value, len(at[0]), "bounds", fewest=3)
        self.description = "corners of cells"

    def to_nodes(self, of_faces):
        """Values (n, faces) at nodes: means over the faces around each that have one."""
        faces = numpy.repeat(numpy.arange(len(self.absent)), numpy.diff(self.offsets))
        nodes, count = self.nodes[:self.offsets[-1]], len(self.degrees)
        result = numpy.full((len(of_faces), count), numpy.nan)
        for level, values in zip(result, of_faces):
            known = numpy.isfinite(values) & (self.absent == 0)
            around = numpy.bincount(nodes, known[faces], count)
            total = numpy.bincount(nodes, numpy.where(known, values, 0.0)[faces], count)
            level[around > 0] = total[around > 0] / around[around > 0]
        return result


class Layers:
    """A variable of a Dataset above the faces of its mesh.

    faces    Faces
    count    of layers
    heights  float64 (count + 1, nodes), ascending: of the layers' borders, in metres
    values   (count + 1, nodes) or (count, faces) from the bottom up; masked and NaN: none
    """

    def __init__(self, variables, name):
        self._variables, self._name = variables, name
        self.faces = Faces(variables)
        own, self.on_nodes = self._ordered(name)
        self._layer = own.dims_of_layers
        self._none, self.top_first = numpy.zeros(len(self.faces.degrees), numpy.uint8), False
        if not (self._by_heights() or self._by_thicknesses() or self._by_levels()):
            raise ValueError(f"the layers of {name!r} have no heights: no variable is one at nodes or faces, and its dimension of layers, "
                             f"{self._layer!r}, has no coordinate in a unit of length or pressure")
        self.values = self._at(own)

    def _ordered(self, name):
        """The values (layers, places) of a variable on nodes or faces, whose dimensions of one value are left out, and whether it is on nodes."""
        variable = self._variables[name]
        places = [each for each in variable.dims if each in (self.faces.node, self.faces.face)]
        others = [each for each in variable.dims if each not in places and variable.shape[variable.dims.index(each)] != 1]
        if len(places) != 1:
            raise ValueError(f"{name!r} has the dimensions {tuple(variable.dims)}, one of them must be the mesh's, "
                             f"{' or '.join(repr(each) for each in (self.faces.node, self.faces.face) if each)}")
        if len(others) > 1:
            aside = sorted(others, key=lambda each: axis_of(each, self._variables.get(each)) != "t")[:len(others) - 1]
            chosen = ", ".join(f"{each}=0" for each in aside)
            raise ValueError(f"{name!r} has the dimensions {tuple(variable.dims)}, it must have one of layers besides {places[0]!r}; choose one index of "
                             f"the others, as by .isel({chosen})")
        values = values_of(variable)
        kept = [*others, *places]
        values = values.reshape([n for n, each in zip(values.shape, variable.dims) if each in kept])
        order = [each for each in variable.dims if each in kept]
        values = values.transpose([order.index(each) for each in kept])
        return _Ordered(values if others else values[None], others[0] if others else None), places[0] == self.faces.node

    def _core(self, function, *arguments):
        self.heights = numpy.empty((self.count + 1, len(self.faces.degrees)))
        self.faces._call(function, *arguments, address(self.heights), address(self._none))

    def _take(self, levels, borders):
        """The count of layers, and levels (n, ...) from the bottom up."""
        self.count = len(levels) - borders
        if self.count < 1:
            raise ValueError(f"there are {len(levels)} heights of layers' borders, at least 2 are needed")
        first, last = levels[0], levels[-1]
        differences = numpy.ravel(numpy.asarray(first - last))
        known = differences[numpy.isfinite(differences) & (differences != 0)]
        self.top_first = bool(len(known)) and known[0] > 0
        return numpy.ascontiguousarray(levels[::-1] if self.top_first else levels)

    def _by_heights(self):
        for borders in (True, False):
            for name, one in self._variables.items():
                standard = text(one, "standard_name")
                middles = standard == _STANDARD_MIDDLE or name in _MIDDLES
                if borders == middles or not (middles or name in _BORDERS or standard in _STANDARD_BORDERS):
                    continue
                if sum(each in (self.faces.node, self.faces.face) for each in one.dims) != 1:
                    continue
                found, on_nodes = self._ordered(name)
                if found.dims_of_layers is None:
                    continue
                levels = numpy.ma.filled(numpy.ma.asarray(found.values, numpy.float64), numpy.nan)
                levels *= _earth._LENGTHS.get(text(one, "units"), 1.0)
                levels = self._take(levels if on_nodes else self.faces.to_nodes(levels), borders)
                self._core(library.stratus_layers_from_heights, len(self.faces.degrees), self.count, int(borders), address(levels))
                self.description = f"{self.count} layers by heights {name!r}"
                return True
        return False

    def _by_thicknesses(self):
        own = [self._variables.get(name) for name in ("layerThickness", "bottomDepth", "maxLevelCell")]
        if own[0] is None or own[1] is None or self.faces.node not in own[0].dims:
            return False
        found, _ = self._ordered("layerThickness")
        thicknesses = numpy.ma.filled(numpy.ma.asarray(found.values, numpy.float64), numpy.nan)
        self.count, self.top_first = len(thicknesses), True
        thicknesses, bottom = numpy.ascontiguousarray(thicknesses[::-1]), -_length(own[1])
        present = None if own[2] is None else numbers_of(own[2])
        self._core(library.stratus_layers_from_thicknesses, len(bottom), self.count, address(thicknesses), address(bottom), address(present))
        self.description = f"{self.count} layers by thicknesses 'layerThickness'"
        return True

    def _by_levels(self):
        """Fixed levels along the variable's dimension of layers: depths of lower borders, bounds, borders, or middles."""
        if self._layer is None:
            return False
        found = [(name, one, _earth.heights_of(self.faces.context, name, one)) for name, one in self._variables.items()
                 if tuple(one.dims) == (self._layer,) and text(one, "units") and name != "refBottomDepth"]
        found = [each for each in found if each[2] is not None]
        deep = self._variables.get("refBottomDepth")
        if deep is not None and tuple(deep.dims) == (self._layer,):
            name, borders = "refBottomDepth", numpy.concatenate([[0.0], -_length(deep)])
        elif found:
            name, one, middles = found[0]
            borders = self._borders(name, one, middles)
        else:
            return False
        borders = self._take(borders, True)
        from_borders = c.stratus_layer_borders(node_count=len(self.faces.degrees), layer_count=self.count, borders=address(borders))
        self._core(library.stratus_layers_from_borders, ctypes.byref(from_borders))
        self.description = f"{self.count} layers by levels {name!r}"
        return True

    def _borders(self, name, one, middles):
        for other, own in self._variables.items():
            heights = _earth.heights_of(self.faces.context, other, own) if len(own.dims) == 1 and own.shape[0] == len(middles) + 1 and \
                own.dims[0] not in (self.faces.node, self.faces.face) and text(own, "units") else None
            if heights is not None:
                return heights
        bounds = self._variables.get(text(one, "bounds"))
        if bounds is not None and bounds.shape == (len(middles), 2):
            heights = [_earth.heights_of(self.faces.context, name, _Like(numbers_of(bounds)[:, end], one)) for end in range(2)]
            if len(middles) > 1 and (heights[0][0] < heights[1][0]) != (heights[0][0] < heights[0][1]):
                heights.reverse()
            if not numpy.allclose(heights[1][:-1], heights[0][1:], rtol=1e-5):
                raise ValueError(f"the bounds of {name!r} must meet: one layer must begin where the one before it ends")
            return numpy.concatenate([heights[0], heights[1][-1:]])
        down = len(middles) > 1 and middles[0] > middles[-1]
        middles, borders = numpy.ascontiguousarray(middles[::-1] if down else middles), numpy.empty(len(middles) + 1)
        self.faces._call(library.stratus_layers_between, len(middles), address(middles), address(borders))
        return borders[::-1] if down else borders

    def _at(self, own):
        """The variable's values on nodes at borders, or on faces in layers."""
        values = own.values[::-1] if self.top_first else own.values
        if own.dims_of_layers is None:
            return numpy.ma.concatenate([values] * (self.count + self.on_nodes))
        if len(values) not in (self.count, self.count + 1):
            raise ValueError(f"{self._name!r} has {len(values)} values along {own.dims_of_layers!r}, for {self.count} layers they must be {self.count}, "
                             f"or {self.count + 1} at borders")
        if len(values) == self.count + self.on_nodes:
            return values
        values = numpy.ascontiguousarray(numpy.ma.filled(numpy.ma.asarray(values, numpy.float64), numpy.nan))
        if not self.on_nodes:
            return 0.5 * (values[:-1] + values[1:])
        result = numpy.empty(self.heights.shape)
        self.faces._call(library.stratus_layers_to_borders, len(self.faces.degrees), self.count, address(self.heights), address(values),
                         address(result))
        return result.astype(own.values.dtype) if own.values.dtype.kind == "f" else result

    def tetrahedra(self):
        """int32 (n, 4) point numbers, border * nodes + node, and int32 (n,) the prism of each, layer * faces + face."""
        struct, count = ctypes.byref(self.faces.struct), ctypes.c_int64()
        hidden = numpy.empty(self.count * len(self.faces.absent), numpy.uint8)
        self.faces._call(library.stratus_prisms_hide, struct, self.count, address(self.heights), address(self._none), address(hidden))
        self.faces._call(library.stratus_prisms_divide, struct, self.count, address(hidden), ctypes.byref(count), None, None)
        vertices, prisms = numpy.empty((count.value, 4), numpy.int32), numpy.empty(count.value, numpy.int32)
        self.faces._call(library.stratus_prisms_divide, struct, self.count, address(hidden), ctypes.byref(count), address(vertices), address(prisms))
        return vertices, prisms


class _Ordered:
    """Values (layers, places), and the name of the dimension of layers, None if there is none."""

    def __init__(self, values, dims_of_layers):
        self.values, self.dims_of_layers = values, dims_of_layers


class _Like:
    """Other values of a coordinate."""

    def __init__(self, values, coordinate):
        self.values, self.attrs = values, dict(coordinate.attrs)
