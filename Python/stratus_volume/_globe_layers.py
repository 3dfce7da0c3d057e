# SPDX-License-Identifier: BSD-3-Clause
"""Meshes in layers of xarray on a sphere: UGRID, FVCOM, MPAS and ICON."""
import ctypes

import numpy

from . import _declarations as c
from . import _earth
from ._core import address, context as context_of, library
from ._faces import Faces, variables_of
from ._globe import Globe, OnGlobe, exaggeration
from ._layers import Layers


class GlobeLayers(OnGlobe):
    """A variable of a Dataset with a mesh in layers, on a sphere of 6371 km.

    name        of the variable
    exaggerate  as of Globe
    """

    def __init__(self, data, name, exaggerate=None, device=None, threads=None):
        layers = Layers(variables_of(data), name)
        self.exaggeration = exaggeration(exaggerate, layers.heights)
        points = numpy.empty((*layers.heights.shape, 3))
        own = c.stratus_globe_points(count=points.shape[1], levels=points.shape[0], degrees=address(layers.faces.degrees),
                                     heights=address(layers.heights), height_stride=1, factor=self.exaggeration)
        context = context_of("host", 1)
        with context.lock:
            context.call(library.stratus_globe_place, context.pointer, ctypes.byref(own), address(points))
        vertices, prisms = layers.tetrahedra()
        self._on_nodes = layers.on_nodes
        values = layers.values.reshape(-1) if layers.on_nodes else layers.values.reshape(-1)[prisms]
        super().__init__(points.reshape(-1, 3), vertices, values, device=device, threads=threads)
        self._finish(data[name], f"; {layers.faces.description}; {layers.description}")

    def _set_points(self, points, tetrahedra):
        super()._set_points(points, tetrahedra)
        if not self._on_nodes:  # even if there are as many points
            self.shapes = ((), self.shapes[1])

    def guess(self, mode):
        """As of Globe. A column is the shell between the innermost and the outermost point, because values are in no order."""
        if self.nothing or self.power or mode == "slice":
            return None
        radii = numpy.sqrt((self.points ** 2).sum(axis=-1))
        side = max(int(numpy.cbrt(self.values.size + 0.5)), 1)
        volume, shell = self._box((side, side, side)), (radii.max() - radii.min()) / side
        if shell > 0:
            volume.spacing[0] *= volume.spacing[2] / shell
            volume.spacing[2] = shell
        return _earth.functions(self.context, self.about, volume, 2, unordered=True)


def check_variable(data, name):
    """Raises unless a Dataset has the variable."""
    if name not in data.variables:
        least = 2 if Faces.are_in(variables_of(data)) else 3
        known = sorted(str(each) for each, array in data.data_vars.items() if len(array.dims) >= least)
        raise ValueError(f"the Dataset has no variable {name!r}, " + (f"it must be one of {known}" if known else "and none of three dimensions"))


def on_globe(data, scalars=None, exaggerate=None, device=None, threads=None):
    """What draws a DataArray, or a variable of a Dataset, on a globe."""
    is_dataset = hasattr(data, "data_vars")
    if is_dataset and Faces.are_in(variables_of(data)):
        return GlobeLayers(data, scalars, exaggerate, device, threads)
    return Globe(data[scalars] if is_dataset else data, exaggerate, device, threads)
