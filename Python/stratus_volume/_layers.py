# SPDX-License-Identifier: BSD-3-Clause
"""Variables in layers above the faces of a mesh of an xarray.Dataset. This file finds which variables heights follow from; the core makes the heights
of layers and tetrahedra of them, as it does for the readers of files."""
import ctypes

import numpy

from . import _declarations as c
from . import _earth
from ._core import address, library
from ._dimensions import axis_of, values_of
from ._faces import Faces, numbers_of, text

_BORDERS = ("zCoordinates", "zcor", "z_coordinates", "zgrid", "z_ifc", "zghalf", "HHL")
_MIDDLES = ("z_mc", "zMid")
_STANDARD_BORDERS = ("altitude", "height", "geometric_height_at_half_level_center")
_STANDARD_MIDDLE = "geometric_height_at_full_level_center"
_SURFACES, _SURFACE_NAMES, _SURFACE_ENDS = ("sea_surface_height", "water_surface_height"), ("zeta", "elevation", "elev"), ("_s1",)
_BEDS, _BED_NAMES, _BED_ENDS = ("sea_floor_depth",), ("h", "depth", "bathymetry", "dv", "bottomDepth"), ("_flowelem_bl", "_node_z")


def _length(variable):
    """Values of a length in metres; without a unit they are metres."""
    return numbers_of(variable) * _earth._LENGTHS.get(text(variable, "units"), 1.0)


class Layers:
    """A variable of a Dataset above the faces of its mesh.

    faces    Faces
    count    of layers
    heights  float64 (count + 1, nodes), ascending: of the layers' borders, in metres
    values   (count + 1, nodes) or (count, faces) from the bottom up; masked and NaN: none
    """

    def __init__(self, variables, name, on_sphere=True):
        self._variables, self._name = variables, name
        self.faces = Faces(variables, on_sphere)
        own, self.on_nodes = self._ordered(name)
        self._layer = own.dims_of_layers
        self._none, self.top_first = numpy.zeros(len(self.faces.places), numpy.uint8), False
        if not (self._by_heights() or self._by_thicknesses() or self._by_sigma() or self._by_levels() or self._by_surfaces()):
            raise ValueError(f"the layers of {name!r} have no heights: no variable is one at nodes or faces, there is no sigma coordinate with a bottom "
                             f"and a free surface, and its dimension of layers, {self._layer!r}, has no coordinate in a unit of length or pressure")
        self._hide_dry()
        own.values = self.faces.spread(own.values, self.on_nodes)
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
        self.heights = numpy.empty((self.count + 1, len(self.faces.places)))
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
                levels = self._take(self.faces.at_nodes(found.values, on_nodes) * _earth._LENGTHS.get(text(one, "units"), 1.0), borders)
                self._core(library.stratus_layers_from_heights, len(self.faces.places), self.count, int(borders), address(levels))
                self.description = f"{self.count} layers by heights {name!r}"
                return True
        return False

    def _by_thicknesses(self):
        own = [self._variables.get(name) for name in ("layerThickness", "bottomDepth", "maxLevelCell")]
        if own[0] is None or own[1] is None or self.faces.node not in own[0].dims:
            return False
        found, _ = self._ordered("layerThickness")
        thicknesses = self.faces.at_nodes(found.values, True)
        self.count, self.top_first = len(thicknesses), True
        thicknesses, bottom = numpy.ascontiguousarray(thicknesses[::-1]), -self.faces.spread(_length(own[1]), True)
        present = None if own[2] is None else self.faces.spread(numbers_of(own[2]), True)
        self._core(library.stratus_layers_from_thicknesses, len(bottom), self.count, address(thicknesses), address(bottom), address(present))
        self.description = f"{self.count} layers by thicknesses 'layerThickness'"
        return True

    def _by_levels(self):
        """Fixed levels along the variable's dimension of layers: depths of lower borders, bounds, borders, or middles."""
        if self._layer is None:
            return False
        found = [(name, one, _earth.heights_of(name, one)) for name, one in self._variables.items()
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
        self._between_surfaces(self._take(borders, True), stretched=int(name.endswith(("_layer_z", "_interface_z"))))
        self.description = f"{self.count} layers by levels {name!r}"
        return True

    def _by_sigma(self):
        """Sigma at the borders of layers, if the Dataset has it there, otherwise in the middles."""
        places, found = (self.faces.node, self.faces.face), []
        for name, one in self._variables.items():
            named = text(one, "standard_name") == "ocean_sigma_coordinate" or name in ("siglev", "siglay") or name.endswith("_sigma")
            if named and (len(one.dims) == 1 and one.dims[0] not in places or len(one.dims) == 2 and one.dims[1] == self.faces.node):
                found.append((len(one.values), name))
        if not found or self._bed()[1] is None or self._surface()[1] is None:
            return False
        found.sort()
        name = found[-1][1] if len(found) > 1 and found[-1][0] == found[0][0] + 1 else found[0][1]
        levels = numbers_of(self._variables[name])
        levels = self.faces.spread(levels, True) if levels.ndim == 2 else levels
        borders = name != found[0][1] or len(levels) > 1 and abs(numpy.ravel(levels[0] - levels[-1])[0]) > 1 - 1e-6
        levels = self._take(levels, borders)
        if not borders:
            ends = numpy.zeros_like(levels[:1])
            levels = numpy.concatenate([ends - 1, 0.5 * (levels[:-1] + levels[1:]), ends])
        if not (numpy.diff(levels, axis=0) >= 0).all():
            raise ValueError(f"layers are upside down: {name!r} must increase or decrease all along")
        self._between_surfaces(levels, of_nodes=levels.ndim - 1, sigma=1)
        self.description = f"{self.count} layers by sigma {name!r}"
        return True

    def _by_surfaces(self):
        """One layer between the bottom and the free surface."""
        if self._layer is not None or self._bed()[1] is None or self._surface()[1] is None:
            return False
        self.count = 1
        self._between_surfaces(numpy.array([-1.0, 0.0]), sigma=1)
        self.description = "1 layer"
        return True

    def _between_surfaces(self, borders, **more):
        borders = numpy.ascontiguousarray(borders)
        surface, bottom = self._surface()[1], self._bottom()
        struct = c.stratus_layer_borders(node_count=len(self.faces.places), layer_count=self.count, borders=address(borders), bottom=address(bottom),
                                         surface=address(surface), **more)
        self._core(library.stratus_layers_from_borders, ctypes.byref(struct))

    # ---- the bottom and the free surface

    def _flat(self, terms, standard, names, ends):
        """The name and the lengths in metres at nodes of a variable without layers that formula_terms, a standard_name or its name tell of, or
        (None, None)."""
        def lies_flat(name):
            one = self._variables.get(name)
            dims = () if one is None else [each for each, n in zip(one.dims, one.shape) if n != 1]
            return len(dims) == 1 and dims[0] in (self.faces.node, self.faces.face)
        for term in terms:
            for one in self._variables.values():
                words = text(one, "formula_terms").split()
                for key, name in zip(words[::2], words[1::2]):
                    if key == term + ":" and lies_flat(name):
                        return name, self._at_nodes(name)
        for name, one in self._variables.items():
            if lies_flat(name) and (text(one, "standard_name").startswith(standard) or name in names or str(name).endswith(ends)):
                return name, self._at_nodes(name)
        return None, None

    def _at_nodes(self, name):
        found, on_nodes = self._ordered(name)
        return self.faces.at_nodes(found.values, on_nodes)[0] * _earth._LENGTHS.get(text(self._variables[name], "units"), 1.0)

    def _surface(self):
        return self._flat(("eta",), _SURFACES, _SURFACE_NAMES, _SURFACE_ENDS)

    def _bed(self):
        return self._flat(("bedlevel", "depth"), _BEDS, _BED_NAMES, _BED_ENDS)

    def _bottom(self):
        """Heights of the bottom at nodes, or None."""
        name, bed = self._bed()
        if bed is None:
            return None
        one = self._variables[name]
        standard = text(one, "standard_name")
        if standard == "altitude" or text(one, "positive") == "up" or str(name).endswith(("_bl", "_node_z")):
            return bed
        surface = self._surface()[1] if standard == "sea_floor_depth_below_sea_surface" else None
        return -bed if surface is None else surface - bed

    def _hide_dry(self):
        """Marks faces that are dry by the Dataset's flags, and those on which the free surface has no value."""
        surface = self._surface()[0]
        for name, one in self._variables.items():
            own = [each for each, n in zip(one.dims, one.shape) if n != 1]
            if own != [self.faces.face]:
                continue
            if name in ("wet_cells", "wetdry_elem") or str(name).endswith("_wet_cells"):
                self.faces.absent |= self.faces.spread((numbers_of(one).reshape(-1) == 1) != (name != "wetdry_elem"), False)
            elif name == surface:
                self.faces.absent |= self.faces.spread(~numpy.isfinite(numbers_of(one).reshape(-1)), False)

    def _borders(self, name, one, middles):
        for other, own in self._variables.items():
            heights = _earth.heights_of(other, own) if len(own.dims) == 1 and own.shape[0] == len(middles) + 1 and \
                own.dims[0] not in (self.faces.node, self.faces.face) and text(own, "units") else None
            if heights is not None:
                return heights
        bounds = self._variables.get(text(one, "bounds"))
        if bounds is not None and bounds.shape == (len(middles), 2):
            heights = [_earth.heights_of(name, _Like(numbers_of(bounds)[:, end], one)) for end in range(2)]
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
        self.faces._call(library.stratus_layers_to_borders, len(self.faces.places), self.count, address(self.heights), address(values),
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
