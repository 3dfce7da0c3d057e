# SPDX-License-Identifier: BSD-3-Clause
"""Meshes in layers of xarray on a plane and on a sphere: UGRID, FVCOM, MPAS and ICON."""
import ctypes

import numpy

from . import _declarations as c
from . import _earth
from ._annotation import Axis
from ._core import address, context as context_of, library
from ._faces import Faces, variables_of
from ._globe import Globe, OnGlobe, exaggeration
from ._grid import affine
from ._layers import Layers
from ._tetrahedra import Tetrahedra
from ._values import positive


class _OfLayers(Tetrahedra):
    """A variable above the faces of a mesh, whose tetrahedra are parts of prisms."""

    def _take(self, layers, points, device, threads, matrix=None):
        """points: float64 (borders, nodes, 3)."""
        vertices, prisms = layers.tetrahedra()
        self._on_nodes = layers.on_nodes
        values = layers.values.reshape(-1) if layers.on_nodes else layers.values.reshape(-1)[prisms]
        Tetrahedra.__init__(self, points.reshape(-1, 3), vertices, values, device=device, threads=threads, matrix=matrix)

    def _set_points(self, points, tetrahedra):
        super()._set_points(points, tetrahedra)
        if not self._on_nodes:  # even if there are as many points
            self.shapes = ((), self.shapes[1])

    def _depth_of_columns(self):
        """The length of a column in the world."""
        return self.bounds[5] - self.bounds[4]

    def guess(self, mode):
        """Points of opacity, points of colour and the unit distance by what the data say of their variable, or None. A column goes through all
        layers, because values are in no order. Call it with the context's lock held."""
        if self.nothing or self.power or mode == "slice":
            return None
        side = max(int(numpy.cbrt(self.values.size + 0.5)), 1)
        volume, column = self._box((side, side, side)), self._depth_of_columns() / side
        if column > 0:
            volume.spacing[0] *= volume.spacing[2] / column
            volume.spacing[2] = column
        return _earth.functions(self.context, self.about, volume, 2, unordered=True)


class GlobeLayers(_OfLayers, OnGlobe):
    """A variable of a Dataset with a mesh in layers, on a sphere of 6371 km.

    name        of the variable
    exaggerate  as of Globe
    """

    def __init__(self, data, name, exaggerate=None, device=None, threads=None):
        layers = Layers(variables_of(data), name)
        self.exaggeration = exaggeration(exaggerate, layers.heights)
        points = numpy.empty((*layers.heights.shape, 3))
        own = c.stratus_globe_points(count=points.shape[1], levels=points.shape[0], degrees=address(layers.faces.places),
                                     heights=address(layers.heights), height_stride=1, factor=self.exaggeration)
        context = context_of("host", 1)
        with context.lock:
            context.call(library.stratus_globe_place, context.pointer, ctypes.byref(own), address(points))
        self._take(layers, points, device, threads)
        self._finish(data[name], f"; {layers.faces.description}; {layers.description}")

    def _depth_of_columns(self):
        return self.depth()


class PlaneLayers(_OfLayers):
    """A variable of a Dataset with a mesh in layers, on a plane: in metres, of degrees at the middle latitude.

    name        of the variable
    exaggerate  as of Volume
    """
    earth = True

    def __init__(self, data, name, exaggerate=None, device=None, threads=None, matrix=None):
        layers = Layers(variables_of(data), name, on_sphere=False)
        faces, turned = layers.faces, matrix is not None
        points = numpy.empty((*layers.heights.shape, 3))
        points[..., :2], points[..., 2] = faces.places, layers.heights
        if exaggerate is not None:
            self.exaggeration = positive(exaggerate, "exaggerate")
        else:
            ends = [each(points[..., axis]) for axis in range(3) for each in (numpy.min, numpy.max)]
            self.exaggeration = 1.0 if turned else _earth.height_factor(ends)
        stretch = numpy.diag([1.0, 1.0, self.exaggeration, 1.0])
        matrix = affine(matrix).reshape(4, 4) @ stretch if turned else None if self.exaggeration == 1.0 else stretch
        self._take(layers, points, device, threads, matrix)
        self._name(data[name])
        self.axes = None if turned else [*faces.axes, Axis("height", "m").stretched(self.exaggeration)]
        self.description = f"on a plane; {faces.description}; {layers.description}"


def check_variable(data, name):
    """Raises unless a Dataset has the variable."""
    if name not in data.variables:
        least = 2 if Faces.are_in(variables_of(data)) else 3
        known = sorted(str(each) for each, array in data.data_vars.items() if len(array.dims) >= least)
        raise ValueError(f"the Dataset has no variable {name!r}, " + (f"it must be one of {known}" if known else "and none of three dimensions"))


def is_on_mesh(data, name):
    """Whether a variable of a Dataset is on nodes or faces of a mesh that the Dataset has."""
    return not Faces.dimensions(variables_of(data)).isdisjoint(data[name].dims)


def on_globe(data, scalars=None, exaggerate=None, device=None, threads=None):
    """What draws a DataArray, or a variable of a Dataset, on a globe."""
    is_dataset = hasattr(data, "data_vars")
    if is_dataset and Faces.are_in(variables_of(data)):
        return GlobeLayers(data, scalars, exaggerate, device, threads)
    return Globe(data[scalars] if is_dataset else data, exaggerate, device, threads)
