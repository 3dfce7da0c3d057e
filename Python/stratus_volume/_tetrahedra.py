# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of meshes of tetrahedra and of curvilinear grids."""
import ctypes
import math

import numpy

from . import _declarations as c
from . import _earth, _view
from ._annotation import Annotation
from ._core import Owned, address, as_dict, choice, context as context_of, library, type_of
from ._grid import affine, chosen, of_package
from ._look import Image, Quantities, Units, crop_box, set_contours, set_planes, value_interval
from ._media import explain_each, functions_of, materials_of, opacity_of_surfaces, set_surface
from ._values import (Spread, explain, length_of, mask_of, native, none_visible, number, own_points, pixels, positive, power_of, scaled,
                      unit_length, visible, warn)

_TETRA = 10  # VTK's number of the cell


def listed(points, tetrahedra):
    """Returns points as float64 (n, 3) and tetrahedra as int32 (m, 4), checked."""
    points, cells = native(points, "points"), numpy.asarray(tetrahedra)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points has the shape {points.shape}, it must be (n, 3)")
    if cells.ndim != 2 or cells.shape[1] != 4 or cells.dtype.kind not in "iu":
        raise ValueError(f"tetrahedra has the shape {cells.shape} and type {cells.dtype}, it must be (m, 4) whole numbers")
    if cells.size and not (0 <= cells.min() and cells.max() < len(points)):
        raise ValueError(f"tetrahedra has the numbers {cells.min()}..{cells.max()}, they must be in 0..{len(points) - 1}")
    return numpy.ascontiguousarray(points, numpy.float64), numpy.ascontiguousarray(cells, numpy.int32)


class Tetrahedra:
    """A mesh of tetrahedra, or a curvilinear grid of hexahedra, that may be drawn more than once without building anew.

    points      float64 (n, 3), finite; for a curvilinear grid float64 or float32 (nk, nj, ni, 3). Or a vtkUnstructuredGrid or
                vtkStructuredGrid, pyvista's too, which also has tetrahedra and values; VTK divides other cells into tetrahedra
    tetrahedra  int32 (m, 4), indices of points, in any orientation; None for a curvilinear grid
    values      one for each point or one for each cell, of any type that Volume accepts; masked, NaN and infinite ones hide their cells. One
                more axis, the last, has 2 to 4 components of each
    scalars     name of the array of a VTK data set; default: its active scalars
    component   index of one of its components, from 0, or "all" for 2 to 4
    device, threads, matrix  see Volume

    Memory is not copied if types are the named ones and arrays are contiguous.
    """
    innermost = None  # of data on a globe: the least distance of a point from the middle of the Earth
    earth = False  # whether the data are on the Earth's plane
    axes = None  # the data's numbers along x, y and z of the world: three Axis. None: the world's own
    bar_title = ("", "")  # of the colour bar: title and unit

    def __init__(self, points, tetrahedra=None, values=None, scalars=None, device=None, threads=None, matrix=None, component=None):
        self._units = Units(points, matrix=None if matrix is None else affine(matrix).reshape(4, 4))
        if hasattr(points, "IsA") and hasattr(points, "GetPointData"):
            if tetrahedra is not None or values is not None:
                raise ValueError("a data set of VTK has its own tetrahedra and values: leave these out")
            points, tetrahedra, values = _of_vtk(points, scalars, component)
        elif scalars is not None or component is not None:
            raise ValueError("scalars and component choose among the arrays of a VTK data set; arrays have none")
        if values is None:
            raise TypeError("values is None, it must be one for each point or for each cell")
        self._set_points(points, tetrahedra)
        self._place(matrix)
        self._set_values(values)
        self.context = context_of(device, threads)
        self._caster = Owned(self.context, library.stratus_tetra_caster_destroy)
        with self.context.lock:
            self.context.call(library.stratus_tetra_caster_create, self.context.pointer, ctypes.byref(self._caster.pointer))

    def __repr__(self):
        cells = f"{int(numpy.prod(self.shapes[1]))} {'cells' if self.cells is None else 'tetrahedra'}"
        return f"<{type(self).__name__} of {self.points.size // 3} points and {cells}>"

    def _set_points(self, points, tetrahedra):
        points = native(points, "points")
        self.lattice = points.shape[:3] if tetrahedra is None else None
        if tetrahedra is None:
            if points.ndim != 4 or points.shape[3] != 3 or min(points.shape[:3]) < 2:
                raise ValueError(f"points has the shape {points.shape}, without tetrahedra it must be (nk, nj, ni, 3) with each n at least 2")
            self.points = numpy.ascontiguousarray(points, numpy.float32 if points.dtype == numpy.float32 else numpy.float64)
            self.cells, self.shapes = None, (points.shape[:3], tuple(n - 1 for n in points.shape[:3]))
        else:
            self.points, self.cells = listed(points, tetrahedra)
            self.shapes = ((len(self.points),), (len(self.cells),))

    def _place(self, matrix):
        self.matrix = affine(matrix)
        finite = self.points.reshape(-1, 3)
        finite = finite[numpy.isfinite(finite).all(axis=1)]
        if self.matrix is not None:
            rows = self.matrix.reshape(4, 4)
            finite = finite @ rows[:3, :3].T + rows[:3, 3]
        ends = (finite.min(axis=0), finite.max(axis=0)) if len(finite) else (numpy.zeros(3), numpy.zeros(3))
        self.bounds = tuple(float(end[axis]) for axis in range(3) for end in ends)

    def _set_values(self, values):
        mask, own = mask_of(values), native(values, "values")
        most = c.CONSTANTS["STRATUS_COMPONENTS_MAX"]
        several = own.shape not in self.shapes and own.ndim > 0 and own.shape[:-1] in self.shapes and 1 <= own.shape[-1] <= most
        if own.shape not in self.shapes and not several:
            raise ValueError(f"values has the shape {own.shape}, it must be the points', {self.shapes[0]}, or the cells', {self.shapes[1]}, "
                             f"and may have a last axis of 1 to {most} components")
        self.components = own.shape[-1] if several else 1
        if several and mask is not None:
            mask = mask.any(axis=-1)
        # Where there are as many cells as points, values belong to points.
        self.of_cells = own.shape[:own.ndim - several] != self.shapes[0]
        shown = visible(own.reshape(-1, self.components) if several else own.reshape(-1), None if mask is None else mask.reshape(-1))
        self.nothing, self.spreads, self.spread, self.hidden = None, [], None, None
        if shown.size == 0:
            count, masked = own.size // self.components, 0 if mask is None else int(mask.sum())
            self.nothing = none_visible(count, masked, count - masked)
            return
        self.spreads = [Spread(each) for each in (shown.T if several else [shown])]
        self.spread = self.spreads[0]
        if mask is not None:
            where = mask[..., None] if several else mask
            if own.dtype.kind == "f":
                own = numpy.where(where, own.dtype.type(numpy.nan), own)
            else:
                low = numpy.array([each.low for each in self.spreads])
                own = numpy.where(where, (low if several else low[0]).astype(own.dtype), own)
                self.hidden = numpy.ascontiguousarray(mask if self.of_cells else self._touched(mask)).reshape(-1).view(numpy.uint8)
        self.values, self.power = numpy.ascontiguousarray(own), 0
        if own.dtype.kind == "f":
            self.power = power_of(max(abs(end) for each in self.spreads for end in (each.low, each.high)))
            if self.power:
                self.values = scaled(own, self.power)

    def _touched(self, mask):
        """The cells that have a masked point."""
        if self.cells is not None:
            return mask[self.cells].any(axis=1)
        result = numpy.zeros(self.shapes[1], bool)
        for k in range(2):
            for j in range(2):
                for i in range(2):
                    result |= mask[tuple(slice(end, n - 1 + end) for end, n in zip((k, j, i), mask.shape))]
        return result

    def _mesh(self):
        mesh = library.stratus_mesh_default()
        if self.lattice:
            mesh.lattice[:] = self.lattice[::-1]
            mesh.point_count, mesh.cell_count = math.prod(self.shapes[0]), math.prod(self.shapes[1])
        else:
            mesh.point_count, mesh.cell_count, mesh.vertices = len(self.points), len(self.cells), address(self.cells)
        setattr(mesh, "float_points" if self.points.dtype == numpy.float32 else "points", address(self.points))
        mesh.values, mesh.type, mesh.cell_values = address(self.values), type_of(self.values), int(self.of_cells)
        mesh.components = mesh.value_stride = self.components
        if self.matrix is not None:
            mesh.matrix[:] = self.matrix
        mesh.hidden = address(self.hidden)
        return mesh

    def _name(self, data):
        """Sets what an xarray.DataArray says of its variable."""
        self.about = _earth.About(data)
        self.bar_title = tuple(str(text or "") for text in (getattr(data, "name", None), data.attrs.get("units")))

    def _box(self, dimensions):
        """A box about the data, of values in cells."""
        volume = library.stratus_volume_default()
        volume.values, volume.type, volume.value_stride = address(self.values), self._mesh().type, 1
        volume.dimensions[:], volume.cell_centered = dimensions, 1
        for axis in range(3):
            volume.origin[axis] = self.bounds[2 * axis]
            volume.spacing[axis] = (self.bounds[2 * axis + 1] - self.bounds[2 * axis]) / volume.dimensions[axis]
        return volume

    def _globe(self, image, opaque_depth, coast, ink):
        """The Earth in a picture, None for data that are not on a globe."""
        if self.innermost is None:
            return None
        if opaque_depth is not None:
            raise ValueError("opaque_depth is given, but on a globe the Earth ends rays: leave it out")
        from ._globe import Earth
        return Earth(self.innermost, image, coast, ink)

    def mean_cell(self):
        """The length of a cell of data on the Earth, in the mean of the depth, before the matrix as lengths in the mean of all directions; 0: the data
        are not on the Earth."""
        if not self.earth or self.nothing:
            return 0.0
        rows = numpy.eye(3) if self.matrix is None else self.matrix.reshape(4, 4)[:3, :3]
        depth = numpy.linalg.norm(rows[:, 2]) * (self.points[:, 2].max() - self.points[:, 2].min())
        return float(depth / abs(numpy.linalg.det(rows)) ** (1 / 3)) / max(1.0, numpy.cbrt(self.values.size / self.components))

    def camera_of(self, camera):
        """The camera of a picture, whose default data may define."""
        return camera

    def guess(self, mode):
        """Functions by what data say of themselves, or None."""
        return None

    def render(self, opacity=None, color=None, size=(640, 480), camera=None, unit_distance=None, mode="composite", method="auto", tolerance=None,
               shade=False, gradient_opacity=None, contours=None, crop=None, clip_planes=None, average_range=None, opaque_depth=None, progress=None,
               dependent=False, weights=None, mean_components=False, surface=None, quantities=None, threshold=0.5, show_axes=False, color_bar=False,
               caption=None, coast=False, ink=0.9, extinction=1.0):
        """Draws a picture and returns a Rendering: rgba, depth, counters. See `render` for the parameters.

        method  march from cell to cell, project sorted cells, or auto: the method of the lower expected cost
        mode    composite, maximum, minimum, average, additive, isosurface, slice or first-hit
        """
        size = pixels(size)
        image, report = Image(size, opaque_depth), c.stratus_tetra_report()
        globe, camera = self._globe(image, opaque_depth, coast, ink), self.camera_of(camera)
        numbers = Quantities(quantities, threshold, image, self._units)
        around = Annotation(show_axes, color_bar, caption, coast and not globe, ink)
        with self.context.lock:
            asked = AskedOfCells(self, opacity, color, unit_distance, mode, method, tolerance, shade, gradient_opacity, contours, crop, clip_planes,
                                 average_range, dependent, weights, mean_components, surface, extinction)
            if not self.nothing:
                around.set_box(self.bounds, self.axes)
                around.set_bar(asked.transfers[0], self.spread, self.power, *self.bar_title)
                room = None if _view.is_placed(camera) else around.room(self.context, size, self.earth and camera is None)
                view = _view.make(self.context, camera, self.bounds, size, self.earth, room)
                view = globe.end_rays(self.context, view) if globe else view
                self.context.call(library.stratus_tetra_caster_render, self._caster.pointer, ctypes.byref(asked.mesh), asked.functions,
                                  ctypes.byref(view), ctypes.byref(asked.options), ctypes.byref(image.struct), ctypes.byref(report), progress=progress)
                own = c.stratus_ray_cast_input(tetra=self._caster.pointer, mesh=ctypes.addressof(asked.mesh), transfer=asked.functions,
                                               tetra_options=ctypes.addressof(asked.options))
                numbers.compute(self.context, ctypes.byref(own), 1, view, progress)
        asked.explain(image.rgba, report.rays)
        if not self.nothing:
            with self.context.lock:
                if globe:
                    globe.draw(self.context, view, image)
                around.draw(self.context, view, image)
        return image.rendering(as_dict(report), numbers.result(0 if self.nothing else self.power))


class AskedOfCells:
    """The core's arguments for one picture of a mesh, with the memory that they point to. Made and used with the context's lock held."""

    def __init__(self, drawn, opacity=None, color=None, unit_distance=None, mode="composite", method="auto", tolerance=None, shade=False,
                 gradient_opacity=None, contours=None, crop=None, clip_planes=None, average_range=None, dependent=False, weights=None,
                 mean_components=False, surface=None, extinction=1.0):
        self.drawn, self.mode, self.options = drawn, mode, library.stratus_tetra_options_default()
        options = self.options
        options.mode = choice(mode, "stratus_tetra_mode", "STRATUS_TETRA_", "mode", ("quantities",))
        options.method = choice(method, "stratus_tetra_method", "STRATUS_TETRA_METHOD_", "method")
        if tolerance is not None:
            options.tolerance = number(tolerance, "tolerance")
        options.dependent, options.mean_components = int(bool(dependent)), int(bool(mean_components))
        self._materials = materials_of(options, True if mode == "first-hit" and shade is False else shade, drawn.components)
        set_surface(options, mode, surface)
        surfaces = opacity_of_surfaces(mode, contours) if opacity is None else None
        set_planes(options, clip_planes, c.CONSTANTS["STRATUS_TETRA_CLIP_PLANES_MAX"])
        if crop is not None:
            options.crop, options.crop_bounds[:] = 1, crop_box(crop)
        if unit_distance is not None:
            positive(unit_distance, "unit_distance")
        positive(extinction, "extinction")
        if drawn.nothing:
            if drawn.components == 1:
                own_points(opacity)
            return
        guessed = drawn.guess(mode) if opacity is None else None
        if guessed:
            opacity, color = guessed[0], guessed[1] if color is None else color
            unit_distance = guessed[2] if unit_distance is None else unit_distance
        opacity = surfaces or opacity
        self._wanted = functions_of(drawn, opacity, color, gradient_opacity, weights, dependent, None)
        for each in self._wanted:
            own_points(each.opacity)
        self._contours = set_contours(options, contours, drawn.power, c.CONSTANTS["STRATUS_TETRA_CONTOURS_MAX"])
        if average_range is not None:
            options.average_range[:] = value_interval(average_range, "average_range", drawn.power)
        self.bounds = drawn.bounds
        self.unit = unit_length(unit_distance, extinction, length_of([self.bounds[2 * axis + 1] - self.bounds[2 * axis] for axis in range(3)]))
        self.transfers = [each.transfer(drawn.power, self.unit) for each in self._wanted]
        self.functions = (c.stratus_transfer * len(self.transfers))(*(each.struct for each in self.transfers))
        self.mesh = drawn._mesh()

    def explain(self, rgba, rays=None):
        """Warns once where a picture shows nothing of the mesh."""
        drawn = self.drawn
        if drawn.nothing:
            warn(drawn.nothing)
        elif len(self.transfers) > 1 or self._wanted[0].name:
            explain_each(rgba, self._wanted, self.transfers, drawn.power, self.unit)
        else:
            explain(rgba, self.transfers[0].points, drawn.spread, drawn.power, own_points(self._wanted[0].opacity) is None, self.mode, self.unit,
                    rays, self._contours)


def _of_vtk(data, scalars, component):
    vtk_to_numpy = of_package(data, "util.numpy_support").vtk_to_numpy
    if data.IsA("vtkUnstructuredGrid"):
        # The one is not there in VTK 9.1, the other warns from 9.6 on.
        kinds = data.GetDistinctCellTypesArray() if hasattr(data, "GetDistinctCellTypesArray") else data.GetCellTypesArray()
        if data.GetNumberOfCells() and not (vtk_to_numpy(kinds) == _TETRA).all():
            divide = of_package(data, "vtkFiltersGeneral").vtkDataSetTriangleFilter()
            divide.SetInputData(data)
            divide.TetrahedraOnlyOn()
            divide.Update()
            data = divide.GetOutput()
        cells = vtk_to_numpy(data.GetCells().GetConnectivityArray()).reshape(-1, 4)
    elif not data.IsA("vtkStructuredGrid"):
        raise TypeError(f"the data set is a {data.GetClassName()}, it must be a vtkUnstructuredGrid or vtkStructuredGrid")
    points, cells_data, points_data = vtk_to_numpy(data.GetPoints().GetData()), data.GetCellData(), data.GetPointData()
    of_cells = points_data.GetScalars() is None if scalars is None else not points_data.HasArray(scalars)
    attributes = cells_data if of_cells else points_data
    array = attributes.GetScalars() if scalars is None else attributes.GetArray(scalars)
    if array is None:
        names = [each.GetArrayName(n) for each in (points_data, cells_data) for n in range(each.GetNumberOfArrays())]
        raise ValueError(f"scalars is {scalars!r}, it must be one of {names}")
    values = chosen(vtk_to_numpy(array), component, array.GetName())
    flags = cells_data.GetArray("vtkGhostType")
    if data.IsA("vtkUnstructuredGrid"):
        if flags is not None:
            cells = cells[vtk_to_numpy(flags) == 0]
            values = values[vtk_to_numpy(flags) == 0] if of_cells else values
        return points, cells, values
    extent = data.GetExtent()  # GetDimensions() takes other arguments in some versions
    shape = [extent[2 * axis + 1] - extent[2 * axis] + 1 for axis in (2, 1, 0)]
    if flags is not None and not of_cells:
        raise ValueError("the grid has blanked cells, but values of points: blank by NaN values instead")
    values = values.reshape([*(n - of_cells for n in shape), *values.shape[1:]])
    if flags is not None:
        hidden = vtk_to_numpy(flags).reshape(values.shape[:3]) != 0
        values = numpy.ma.masked_array(values, hidden if values.ndim == 3 else numpy.broadcast_to(hidden[..., None], values.shape))
    return points.reshape(*shape, 3), None, values
