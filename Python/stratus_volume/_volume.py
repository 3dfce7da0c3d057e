# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of volumes by ray casting."""
import ctypes

import numpy

from . import _declarations as c
from . import _earth, _view
from ._annotation import Annotation
from ._core import Owned, address, as_dict, choice, context as context_of, library
from ._grid import affine, grid_of
from ._look import Image, Quantities, Units, crop_box, set_contours, set_planes, set_shading, value_interval
from ._media import Function2D, Labels, explain_each, functions_of, looks_of, materials_of, opacity_of_surfaces, set_surface
from ._values import explain, is_number, length_of, number, own_points, pixels, positive, unit_length, warn


class Volume:
    """A volume that is drawn more than once: structures of its values are built once, and a camera's move builds nothing anew.

    data          a NumPy array of three axes of at least 2 values (bool, integers, float16, float32, float64, of either byte order), masked or
                  not; an xarray.DataArray of three dimensions; a vtkImageData or vtkRectilinearGrid, pyvista's too. Memory is copied only
                  for float16, the other byte order, masked floats, integers whose masked values are beyond all others, magnitudes outside
                  1e-30..1e37, and arrays whose rows do not follow each other evenly. Masked, NaN and infinite values are transparent.
                  A fourth axis, the array's last, has 2 to 4 components of each value; a masked or not finite component hides all of them.
                  Or a lazy array: zarr's, h5py's, netCDF4's, dask's, an xarray.DataArray of any, or what else has a shape, a dtype and slices.
                  If `memory` is given, or if its three axes need more than half of the memory that is free, then each chunk is read when
                  a ray first meets it. Otherwise it is read as a whole, or refused by a MemoryError. An exception of the array is an OSError
    spacing       world length between two values along x, y and z, each > 0; default 1, 1, 1
    origin        position of the first value: x, y, z; default 0, 0, 0
    axes          order of the array's first three axes: "zyx" (default) is array[z, y, x], "xyz" array[x, y, z]
    scalars       name of the array of a VTK data set; default: its active scalars
    component     index of one of its components, from 0, or "all" for 2 to 4
    device        "auto" (default), "host", an OpenCL device's index or a part of its name, or a Context
    threads       number of threads on the host, 1..1024; default: as many as OpenMP offers
    matrix        (4, 4) affine, row by row, which may turn, stretch, mirror, shear and move the volume in the world, after spacing and
                  origin; default: none
    memory        bytes of memory, 16e6 to 1e15, or a text such as "512M" or "2G" (K, M, G, T of 1024), that the values of lazy arrays take at most,
                  with what is built of them: of all in the process together, as the last one given says. Default: half of what is free
    exaggerate    factor of heights z of an xarray.DataArray on the Earth (see below), above 0. Default: if there is no matrix, and the data are
                  lower than a tenth of their width, the factor that makes them a fifth as high as wide, otherwise 1

    A DataArray is on the Earth if its coordinates are longitude and latitude in degrees, or lengths, and a height, depth or pressure. Its
    places are metres on a sphere at the middle latitude; depths are below 0, and pressures are heights in the standard atmosphere. Lengths
    that all have one unit keep it. `exaggeration` is the factor of heights that is used.
    """

    def __init__(self, data, spacing=None, origin=None, axes=None, scalars=None, component=None, device=None, threads=None, matrix=None,
                 exaggerate=None, memory=None):
        self.grid = grid_of(data, spacing, origin, axes, scalars, component, memory, True)
        of_xarray = hasattr(data, "dims") and hasattr(data, "coords") and hasattr(data, "attrs")
        self._named = (getattr(data, "name", None), data.attrs.get("units")) if of_xarray else None
        dims = None
        if of_xarray and spacing is None and origin is None:
            dims = [data.dims[own] for _, own in sorted(zip(self.grid.world, self.grid.own))]
        self._place(matrix)
        self._turned = matrix is not None  # by the caller
        self._draft = None
        self.context = context_of(device, threads)
        self.exaggeration = self._exaggerate(exaggerate)
        if self.exaggeration != 1.0:
            stretch = numpy.diag([1.0, 1.0, self.exaggeration, 1.0])
            matrix = stretch if self.grid.matrix is None else self.grid.matrix.reshape(4, 4) @ stretch
            self._place(matrix)
        self._units = Units(data, dims, self._named[1] if of_xarray else None, None if matrix is None else self.grid.matrix.reshape(4, 4),
                            self.grid.metres)
        self._caster = Owned(self.context, library.stratus_ray_caster_destroy)
        with self.context.lock:
            self.context.call(library.stratus_ray_caster_create, self.context.pointer, ctypes.byref(self._caster.pointer))

    def __repr__(self):
        return f"<Volume of {' x '.join(map(str, self.grid.values.shape))} {self.grid.values.dtype.name} values>"

    @property
    def bounds(self):
        """xmin, xmax, ymin, ymax, zmin, zmax in the world."""
        with self.context.lock:
            return self.grid.bounds(self.context)

    def _place(self, matrix):
        self.grid.matrix = affine(matrix)

    def _exaggerate(self, factor):
        """The factor of heights, given or by the data."""
        if factor is not None:
            return positive(factor, "exaggerate")
        if not self.grid.earth or self.grid.matrix is not None or self.grid.nothing:
            return 1.0
        return _earth.height_factor(self.bounds)

    def modified(self):
        """Call it after values changed in place: the next picture reads them again. Values of a copy stay as they were copied."""
        self.grid.modified()

    def draft(self, labels=None):
        """A Volume that may be drawn while a view moves: of a lazy array whose last picture had to read values, its coarse copy; otherwise this
        one. Labels have as many values as the array, so that the copy cannot have them."""
        coarse = self.grid.coarse() if labels is None and self.grid.waits else None
        if coarse is None:
            return self
        if self._draft is None:
            self._draft = Volume(coarse, device=self.context)
            self._draft._named, self._draft.exaggeration, self._draft._turned = self._named, self.exaggeration, self._turned
        self.grid.coarse()  # which has this one's matrix
        return self._draft

    def settle(self, progress=None):
        """Finds what pictures need to know of all values, of lazy arrays by reading them."""
        with self.context.lock, self.grid.reading():
            self.grid.settle(self.context, self._caster.pointer, progress)

    def render(self, opacity=None, color=None, size=(640, 480), camera=None, unit_distance=None, mode="composite", interpolation="linear",
               structure="auto", sampling="auto", sample_distance=0, tolerance=None, shade=False, gradient_opacity=None, contours=None, crop=None,
               clip_planes=None, average_range=None, jitter=False, audit=False, opaque_depth=None, progress=None, dependent=False, weights=None,
               mean_components=False, labels=None, looks=None, function_2d=None, surface=None, quantities=None, threshold=0.5,
               show_axes=False, color_bar=False, caption=None, coast=False, ink=0.9, extinction=1.0):
        """Draws a picture and returns a Rendering: rgba, depth, counters. See `render` for the parameters."""
        size = pixels(size)
        image, report = Image(size, opaque_depth), c.stratus_ray_cast_report()
        numbers = Quantities(quantities, threshold, image, self._units)
        around = Annotation(show_axes, color_bar, caption, coast, ink)
        with self.context.lock, self.grid.reading():
            self.settle(progress)
            asked = Asked(self, opacity, color, unit_distance, mode, interpolation, structure, sampling, sample_distance, tolerance, shade,
                          gradient_opacity, contours, crop, clip_planes, average_range, jitter, audit, dependent, weights, mean_components, labels,
                          looks, function_2d, surface, extinction)
            if not self.grid.nothing:
                around.set_box(asked.bounds, self._axes)
                around.set_bar(asked.transfers[0], self.grid.spread, asked.power, *self._bar_title())
                room = None if _view.is_placed(camera) else around.room(self.context, size, self.grid.earth and camera is None)
                view = _view.make(self.context, camera, asked.bounds, size, self.grid.earth, room)
                self.context.call(library.stratus_ray_caster_render, self._caster.pointer, ctypes.byref(asked.volume), asked.functions,
                                  ctypes.byref(view), ctypes.byref(asked.options), ctypes.byref(image.struct), ctypes.byref(report), progress=progress)
                own = c.stratus_ray_cast_input(caster=self._caster.pointer, volume=ctypes.pointer(asked.volume), transfer=asked.functions,
                                               options=ctypes.pointer(asked.options))
                numbers.compute(self.context, ctypes.byref(own), 1, view, progress)
        asked.explain(image.rgba, report.rays)
        if not self.grid.nothing:
            with self.context.lock:
                around.draw(self.context, view, image)
        counters = dict(as_dict(report), exaggeration=self.exaggeration)
        return image.rendering(counters, numbers.result(0 if self.grid.nothing else asked.power, self._label))

    @property
    def _axes(self):
        """The data's numbers along x, y and z of the world, or None: the world's own."""
        axes = self.grid.axes
        if axes is None or self._turned:
            return None
        return [*axes[:2], axes[2].stretched(self.exaggeration)]

    def _bar_title(self):
        return tuple(str(text or "") for text in self._named or ("", ""))

    def _label(self, name, array, unit):
        """An array of a quantity as the data's own kind."""
        if self._named is None:
            return array
        import xarray
        own = self._named[0]
        attributes = {"long_name": name.replace("_", " ") + (f" of {own}" if own else "")}
        if unit:
            attributes["units"] = unit
        return xarray.DataArray(array, dims=("row", "column"), name=name, attrs=attributes)


class Asked:
    """The core's arguments for one picture of a volume, with the memory that they point to. Made and used with the context's lock held."""

    def __init__(self, drawn, opacity=None, color=None, unit_distance=None, mode="composite", interpolation="linear", structure="auto",
                 sampling="auto", sample_distance=0, tolerance=None, shade=False, gradient_opacity=None, contours=None, crop=None, clip_planes=None,
                 average_range=None, jitter=False, audit=False, dependent=False, weights=None, mean_components=False, labels=None, looks=None,
                 function_2d=None, surface=None, extinction=1.0):
        self.grid = grid = drawn.grid
        self.mode, self.options = mode, library.stratus_ray_cast_options_default()
        options = self.options
        options.mode = choice(mode, "stratus_mode", "STRATUS_MODE_", "mode", ("quantities",))
        options.skipping.structure = choice(structure, "stratus_structure", "STRATUS_STRUCTURE_", "structure")
        options.sampling.rule = choice(sampling, "stratus_sampling", "STRATUS_SAMPLING_", "sampling", ("local",))
        options.sampling.interpolation = choice(interpolation, "stratus_interpolation", "STRATUS_INTERPOLATION_", "interpolation")
        options.sampling.distance = number(sample_distance, "sample_distance")
        if tolerance is not None:
            options.sampling.tolerance = number(tolerance, "tolerance")
        options.sampling.jitter, options.skipping.audit = int(bool(jitter)), int(bool(audit))
        options.optics.dependent, options.optics.mean_components = int(bool(dependent)), int(bool(mean_components))
        self._materials = materials_of(options.light, shade, grid.components)
        set_planes(options.clipping, clip_planes, c.CONSTANTS["STRATUS_CLIP_PLANES_MAX"])
        if crop is not None:
            options.clipping.crop, options.clipping.crop_bounds[:] = 1, grid.crop(crop_box(crop))
        if unit_distance is not None:
            positive(unit_distance, "unit_distance")
        positive(extinction, "extinction")
        set_surface(options, mode, surface)
        surfaces = opacity_of_surfaces(mode, contours) if opacity is None else None
        looks = looks_of(labels, looks)
        self._labels = None if labels is None else Labels(labels, grid)
        if looks:
            mask = options.mask
            mask.bytes, mask.revision, mask.label_count = address(self._labels.bytes), self._labels.revision, max(looks)
        if grid.nothing:
            if grid.components == 1:
                own_points(opacity)
            return
        self._automatic = surfaces is None and opacity is None or is_number(opacity)
        if opacity is None and self._is_guessed(mode, looks, function_2d):
            opacity, colors, own_unit = _earth.functions(drawn.context, grid.about, grid.sampled(), grid.world.index(2))
            color, unit_distance = colors if color is None else color, own_unit if unit_distance is None else unit_distance
        opacity = surfaces or opacity
        wanted = self._wanted = functions_of(grid, opacity, color, gradient_opacity, weights, dependent, looks)
        own = [point for each in wanted for point in own_points(each.opacity) or ()]
        self.power = power = grid.power(own or None)
        self._contours = set_contours(options.optics, contours, power, c.CONSTANTS["STRATUS_CONTOURS_MAX"])
        if average_range is not None:
            options.optics.average_range[:] = value_interval(average_range, "average_range", power)
        self.bounds = grid.bounds(drawn.context)
        self.unit = unit = unit_length(unit_distance, extinction, length_of([self.bounds[2 * axis + 1] - self.bounds[2 * axis] for axis in range(3)]))
        self.transfers = [each.transfer(power, unit) for each in wanted]
        self.functions = (c.stratus_transfer * len(wanted))(*(each.struct for each in self.transfers))
        self._function_2d = None if function_2d is None else Function2D(function_2d, power, unit)
        if self._function_2d:
            options.optics.transfer_2d = ctypes.pointer(self._function_2d.struct)
        self.volume = grid.view(power)

    def _is_guessed(self, mode, looks, function_2d):
        """Whether the core guesses the functions, by what an xarray.DataArray says of its variable and its grid."""
        grid = self.grid
        known = grid.about is not None and (grid.earth or grid.about.is_known)
        return known and grid.components == 1 and grid.power() == 0 and mode != "slice" and not looks and function_2d is None

    def explain(self, rgba, rays=None):
        """Warns once where a picture shows nothing of the volume."""
        if self.grid.nothing:
            warn(self.grid.nothing)
        elif self._function_2d or len(self.transfers) > 1 or self._wanted[0].name:
            explain_each(rgba, () if self._function_2d else self._wanted, self.transfers, self.power, self.unit)
        else:
            explain(rgba, self.transfers[0].points, self.grid.spread, self.power, self._automatic, self.mode, self.unit, rays, self._contours)
