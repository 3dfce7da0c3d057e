# SPDX-License-Identifier: BSD-3-Clause
"""Volumes of Stratus in pyvista's scenes: `plotter.stratus.add_volume(grid)`, with the words of `plotter.add_volume`.

The picture is drawn by the core and laid over the scene's opaque geometry by its depth. No class of VTK is compiled for this, so that any
VTK from 9.1 on will do. pyvista from 0.48 on finds the component by itself; before, `import stratus_volume.pyvista` adds it.
`add_volume(plotter, grid)` of this module is the same.

Volumes of one renderer are drawn together: up to eight in mode composite mix along the rays, others lie one before the other.

Each frame reads depth from the window, and gives it the picture as a texture of bytes. Translucent geometry is always behind the volume,
and picking does not see the volume.
"""
import functools
import time
import warnings
import weakref

import numpy
import pyvista
import pyvista.plotting.volume

from . import _declarations as c
from ._core import Unsupported, whole
from ._dimensions import Steps
from ._draw import drawn_of
from ._globe import OnGlobe
from ._grid import LazyGrid, of_package
from ._lazy import lazy_of
from ._picture import paint
from ._several import render_several
from ._tetrahedra import Tetrahedra
from ._trame import Sliders
from ._values import number, numbers
from ._volume import Volume

# VTK is the one that pyvista has, which need not be vtkmodules.
_package = pyvista.ImageData()
numpy_support, core, data_model = (of_package(_package, name) for name in ("util.numpy_support", "vtkCommonCore", "vtkCommonDataModel"))
pipeline, drawing = (of_package(_package, name) for name in ("vtkCommonExecutionModel", "vtkRenderingCore"))
VTKPythonAlgorithmBase = of_package(_package, "util.vtkAlgorithm").VTKPythonAlgorithmBase

# From pyvista 0.48 on, a plotter notifies its components when it closes.
_COMPONENTS = hasattr(pyvista, "register_plotter_component")
_BLENDINGS = ("composite", "maximum", "minimum", "average", "additive", "isosurface", "slice")
_MAPPERS = ("fixed_point", "gpu", "open_gl", "smart", "ugrid")
_BLOCKS = ("Reds", "Greens", "Blues", "Greys", "Oranges", "Purples")
_MOVES = 1.0  # frames in a second; a window that wants more is in the midst of an interaction
_DRAFT_TOLERANCE = 0.02
_SHADING = ("ambient", "diffuse", "specular", "specular_power")
_EARTH = dict(color=(0.16, 0.18, 0.21), smooth_shading=True, pickable=False, show_scalar_bar=False)  # of the sphere beneath data on a globe


def core_camera(camera, aspect):
    """The core's camera with the rays of a vtkCamera, whatever its window's centre, zoom or projection."""
    matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1, 1)
    inverse = numpy.linalg.inv([[matrix.GetElement(row, column) for column in range(4)] for row in range(4)])

    def place(u, v):
        """The world's point of the near plane that window coordinates in -1..1 show."""
        x = inverse @ (u, v, -1, 1)
        return x[:3] / x[3]
    near, far = camera.GetClippingRange()
    middle, right, up = place(0, 0), place(1, 0) - place(0, 0), place(0, 1) - place(0, 0)
    result = c.stratus_camera(near_k=near, far_k=far, parallel=int(bool(camera.GetParallelProjection())))
    if result.parallel:
        forward = numpy.array(camera.GetDirectionOfProjection())
        eye = middle - near * forward
    else:
        eye = numpy.array(camera.GetPosition())
        forward, right, up = (middle - eye) / near, right / near, up / near
    result.eye[:], result.forward[:], result.right[:], result.up[:] = eye, forward, right, up
    return result


class _Picture(VTKPythonAlgorithmBase):
    """Puts out the picture of a layer. VTK requests it when it draws the texture, after the scene's geometry."""

    def __init__(self, layer, renderer):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")
        self.layer, self.renderer, self.size = layer, renderer, (1, 1)

    def RequestInformation(self, request, inputs, outputs):
        self.size = tuple(max(1, side) for side in self.renderer.GetSize())
        info = outputs.GetInformationObject(0)
        info.Set(pipeline.vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), (0, self.size[0] - 1, 0, self.size[1] - 1, 0, 0), 6)
        data_model.vtkDataObject.SetPointDataActiveScalarInfo(info, core.VTK_UNSIGNED_CHAR, 4)
        return 1

    def RequestData(self, request, inputs, outputs):
        image = data_model.vtkImageData.GetData(outputs, 0)
        image.SetDimensions(*self.size, 1)
        try:
            rows = self.layer.draw(self.renderer, self.size)
        except Exception as error:  # VTK would go on with a texture that is half made
            warnings.warn(f"Stratus draws nothing: {error}", RuntimeWarning, stacklevel=2)
            rows = numpy.zeros((self.size[1], self.size[0], 4), numpy.uint8)
        scalars = numpy_support.numpy_to_vtk(rows.reshape(-1, 4), deep=True)
        scalars.SetName("picture")
        image.GetPointData().SetScalars(scalars)
        return 1


def _window(renderer, algorithm):
    """The actor that covers a renderer's view with a texture."""
    texture = drawing.vtkTexture()
    texture.SetInputConnection(algorithm.GetOutputPort())
    points, cells, places = core.vtkPoints(), data_model.vtkCellArray(), core.vtkFloatArray()
    places.SetNumberOfComponents(2)
    for x, y in (0, 0), (1, 0), (1, 1), (0, 1):
        points.InsertNextPoint(x, y, 0)
        places.InsertNextTuple2(x, y)
    cells.InsertNextCell(4, (0, 1, 2, 3))
    square, coordinate, mapper, actor = data_model.vtkPolyData(), drawing.vtkCoordinate(), drawing.vtkPolyDataMapper2D(), drawing.vtkTexturedActor2D()
    square.SetPoints(points)
    square.SetPolys(cells)
    square.GetPointData().SetTCoords(places)
    coordinate.SetCoordinateSystemToNormalizedViewport()
    mapper.SetInputData(square)
    mapper.SetTransformCoordinate(coordinate)
    actor.SetMapper(mapper)
    actor.SetTexture(texture)
    return actor


def _is_laid(renderer, actor):
    """Whether no geometry came after the actor, whose texture VTK requests in its turn among the props: depths of later ones would be missing."""
    props = list(renderer.GetViewProps())
    return actor in props and all(prop.IsA("vtkActor2D") for prop in props[props.index(actor):])


def _lay_below(renderer, actor):
    """Adds the actor so that it is drawn before all other annotations and after all geometry: VTK draws props in the order in which they came."""
    others = [prop for prop in renderer.GetViewProps() if prop.IsA("vtkActor2D") and prop is not actor]
    for prop in actor, *others:
        renderer.RemoveViewProp(prop)
    for prop in actor, *others:
        renderer.AddViewProp(prop)


class _Layer:
    """The volumes of one renderer, and the texture that has their picture."""

    def __init__(self, renderer):
        self.renderer, self.volumes, self._warned = renderer, [], False
        self.seconds = 0.0  # of the last frame at rest
        self._last = None  # the last picture, behind its key and depths
        self._algorithm = _Picture(self, renderer)
        self._actor = _window(renderer, self._algorithm)
        _lay_below(renderer, self._actor)
        layer = weakref.ref(self)
        # VTK's commands are beyond Python's garbage collector: they hold nothing that holds the renderer.
        self._observer = renderer.AddObserver("StartEvent", lambda caller, event: layer() and layer()._begin())
        self._follows, self._timed = False, None  # an exact picture follows; the interactor whose timer draws it, and the observer

    def _begin(self):
        """Called as a frame begins."""
        if not _is_laid(self.renderer, self._actor):
            _lay_below(self.renderer, self._actor)
        self._algorithm.Modified()

    @classmethod
    def of(cls, plotter):
        """The plotter's layer for its active renderer."""
        layers = plotter.__dict__.setdefault("_stratus_layers", [])
        getattr(plotter, "stratus", None)  # from now on, pyvista's plotter notifies this component when it closes
        for layer in layers:
            if layer.renderer is plotter.renderer:
                return layer
        layers.append(cls(plotter.renderer))
        return layers[-1]

    def remove(self, volume, plotter):
        self.volumes.remove(volume)
        if not self.volumes:
            self.close()
            plotter.__dict__["_stratus_layers"].remove(self)

    def close(self):
        """Parts what VTK holds from what Python holds, so that both are freed."""
        if self._timed:
            self._timed[0].RemoveObserver(self._timed[1])
            self._timed = None
        self.renderer.RemoveObserver(self._observer)
        self.renderer.RemoveViewProp(self._actor)
        self._actor.GetTexture().RemoveAllInputConnections(0)
        self._actor.SetTexture(None)
        self._actor.SetMapper(None)
        self._algorithm.layer, self._algorithm.renderer = None, None
        for volume in self.volumes:
            volume._leave()
        self.volumes.clear()

    def draw(self, renderer, size):
        """The picture in bytes, colours not multiplied by alpha, the bottom row first. VTK's texture requests it within a frame."""
        shown = [volume for volume in self.volumes if volume.visibility]
        if not shown:
            return numpy.zeros((size[1], size[0], 4), numpy.uint8)
        depths, (x, y) = core.vtkFloatArray(), renderer.GetOrigin()
        renderer.GetRenderWindow().GetZbufferData(x, y, x + size[0] - 1, y + size[1] - 1, depths)
        opaque = numpy.clip(numpy_support.vtk_to_numpy(depths).reshape(size[1], size[0]), 0, 1)[::-1]
        view = core_camera(renderer.GetActiveCamera(), renderer.GetTiledAspectRatio())
        rate = renderer.GetRenderWindow().GetDesiredUpdateRate()
        moves, start = rate >= _MOVES, time.perf_counter()
        part = 2 if moves and self.seconds > 1 / rate else 1  # a draft, if a whole frame takes longer than the window wants
        opaque = numpy.ascontiguousarray(opaque[::part, ::part])
        coarse = moves or self._begins_coarse(shown, renderer.GetRenderWindow())
        for volume in shown:
            volume.place()
            volume.shown = volume.drawn.draft(volume.look.get("labels")) if coarse and isinstance(volume.drawn, Volume) else volume.drawn
        with warnings.catch_warnings():
            if self._warned:  # once is enough: frames follow each other
                warnings.simplefilter("ignore")
            looks = [volume.asked() for volume in shown]
            if part > 1:
                looks = [dict(look, tolerance=max(_DRAFT_TOLERANCE, look.get("tolerance") or 0)) for look in looks]
            key = bytes(view), part, [(volume, volume.shown, volume.revision, volume._known.tobytes(), look) for volume, look in zip(shown, looks)]
            if self._last and self._is(key, opaque):
                return self._last[2]
            rgba = self._together(shown, looks, view, opaque) if len(shown) > 1 else None
            rgba = self._one_by_one(shown, looks, view, opaque) if rgba is None else rgba
        self._warned = True
        if not coarse:
            self.seconds = time.perf_counter() - start
        picture = paint(rgba, None) if part == 1 else paint(rgba, None).repeat(part, axis=0).repeat(part, axis=1)[:size[1], :size[0]]
        self._last = key, opaque, numpy.ascontiguousarray(picture[::-1])
        return self._last[2]

    def _is(self, key, opaque):
        """Whether the last picture is the one of this key and these depths: pages of trame draw the same scene several times."""
        try:
            return self._last[0] == key and numpy.array_equal(self._last[1], opaque)
        except ValueError:  # an array among the looks
            return False

    def _begins_coarse(self, shown, window):
        """Whether lazy arrays show their coarse copies in a picture at rest: in a volume's first one, if the window has events. A timer then draws
        the exact picture."""
        interactor, self._follows = window.GetInteractor(), False
        first = [volume for volume in shown if volume.comes_first]
        for volume in first:
            volume.comes_first = False
        waits = any(isinstance(volume.drawn, Volume) and volume.drawn.grid.waits for volume in first)
        if not waits or window.GetOffScreenRendering() or not interactor or not interactor.GetInitialized():
            return False
        if not self._timed:
            layer = weakref.ref(self)
            self._timed = interactor, interactor.AddObserver("TimerEvent", lambda caller, event: layer() and layer()._draw_what_follows())
        self._follows = True
        interactor.CreateOneShotTimer(1)
        return True

    def _draw_what_follows(self):
        if self._follows:
            self.renderer.GetRenderWindow().Render()

    @staticmethod
    def _together(shown, looks, view, opaque):
        """The picture of volumes that mix, None where one of them can't."""
        if len(shown) > c.CONSTANTS["STRATUS_SEVERAL_MAX"] or any(look["mode"] != "composite" for look in looks):
            return None
        try:
            rendering = render_several([(volume.shown, look) for volume, look in zip(shown, looks)], size=opaque.shape[::-1], camera=view,
                                       opaque_depth=opaque)
        except (Unsupported, ValueError, TypeError):  # a volume's fault is reported when it is drawn by itself
            return None
        for volume, counters in zip(shown, rendering.counters["items"]):
            volume.counters = counters
        return rendering.rgba

    @staticmethod
    def _one_by_one(shown, looks, view, opaque):
        """The pictures one before the other, the nearest middle first."""
        def distance(item):
            bounds = item[0].drawn.bounds
            middle = [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2])]
            away = numpy.subtract(middle, view.eye)
            return away @ numpy.array(view.forward) if view.parallel else numpy.linalg.norm(away)
        result = None
        for volume, look in sorted(zip(shown, looks), key=distance):
            rendering = volume.shown.render(size=opaque.shape[::-1], camera=view, opaque_depth=opaque, **look)
            volume.counters = rendering.counters
            result = rendering.rgba if result is None else result + (1 - result[..., 3:]) * rendering.rgba
        return result


class StratusVolume(pyvista.plotting.volume.Volume):
    """A volume in a scene: a Volume of pyvista's whose picture Stratus draws. Changes of its `prop`, `mapper`, `user_matrix`, position and so on
    show in the next frame, except of `mapper.dataset`. `set` sets other arguments of `Volume.render`, or for cells of `Tetrahedra.render`, which
    take precedence. `remove` removes it, `visibility` hides it, `counters` are the last frame's. Of data with steps, `steps` has their `name` and
    `labels`, and `step` is the number of the one that shows.
    """

    # pyvista's classes refuse attributes that they do not know. title: of the scalar bar; called: the name that was given; shown: what the frame
    # draws, a coarse copy of a lazy array while the camera moves; comes_first: the next picture is the first one, which may be coarse
    drawn, shown, look, counters, plotter, renderer, title, called, comes_first, _layer, _box, _base, _known, _words, _kept = (None,) * 15
    _earth = None  # the actor of the Earth beneath data on a globe
    steps, _step, _make = (None,) * 3

    def __init__(self, plotter, drawn, mapper, prop, look, user_matrix=None):
        super().__init__()
        self.drawn, self.look, self.counters, self.plotter, self.renderer = drawn, look, {}, plotter, plotter.renderer
        self._base = _matrix_of(drawn)
        self.mapper, self.prop = mapper, prop
        self._kept = mapper, prop  # with what Python knows of them
        if user_matrix is not None:
            self.user_matrix = user_matrix

    def enter(self, name=None, reset_camera=None, render=True):
        """Adds the volume to its plotter's scene."""
        self._layer = _Layer.of(self.plotter)
        self._layer.volumes.append(self)
        self.comes_first = bool(render)  # without a frame of its own the first may be a screenshot
        if isinstance(self.drawn, OnGlobe):
            sphere = pyvista.Sphere(radius=self.drawn.radius, theta_resolution=360, phi_resolution=180)
            self._earth = self.plotter.add_mesh(sphere, name=f"{name} on the Earth" if name else None, reset_camera=False, render=False, **_EARTH)
        # Its bounds count for the camera and its clipping range; it shows nothing.
        self._box = self.plotter.add_mesh(pyvista.Box(self.bounds), opacity=0.0, pickable=False, show_scalar_bar=False, reset_camera=reset_camera,
                                          render=render, name=name)

    def place(self):
        """Puts the values where the volume is."""
        matrix = pyvista.array_from_vtkmatrix(self.GetMatrix())
        if self._known is None or not numpy.array_equal(matrix, self._known):
            self._known, whole = matrix, matrix @ self._base
            self.drawn._place(None if numpy.array_equal(whole, numpy.eye(4)) else whole)
            if self._earth is not None:
                self._earth.user_matrix = matrix
            if self._box is not None:
                self._box.mapper.SetInputData(pyvista.Box(self.bounds))

    @property
    def step(self):
        return self._step

    @step.setter
    def step(self, n):
        self.choose(n)
        if self.plotter is not None:
            self.plotter.render()

    def choose(self, n):
        """Sets the step that shows in the next frame."""
        if self.steps is None:
            raise ValueError("step is set, but the data have no steps: they must be an xarray.DataArray with a time, or a list")
        whole(n, "step", 0, len(self.steps.labels) - 1)
        if n != self._step:
            drawn = self._make(self.steps[n])[0]
            self.drawn, self._step, self._base, self._known = drawn, n, _matrix_of(drawn), None

    @property
    def revision(self):
        """A number that grows when the values change."""
        return self.drawn.grid.revision if isinstance(self.drawn, Volume) else 0

    def asked(self):
        """Returns the parameters of `render` that follow from prop and mapper, and the ones given to `set`."""
        prop, mapper = self.prop, self.mapper
        parts = [prop, mapper, prop.GetScalarOpacity(), prop.GetRGBTransferFunction(), mapper.GetClippingPlanes() or prop]
        parts += [planes.GetItem(n) for planes in [mapper.GetClippingPlanes()] if planes for n in range(planes.GetNumberOfItems())]
        known = [part.GetMTime() for part in parts]
        if self._words is None or self._words[0] != known:
            self._words = known, self._asked_by(prop, mapper)
        unit = prop.GetScalarOpacityUnitDistance() * _stretch(self._known)  # VTK's mappers count lengths before the matrix
        return {**self._words[1], "unit_distance": unit, **self.look}

    def _asked_by(self, prop, mapper):
        fade, hue = prop.GetScalarOpacity(), prop.GetRGBTransferFunction()
        result = dict(opacity=[point[:2] for point in _nodes(fade, 4)], color=[point[:4] for point in _nodes(hue, 6)], shade=False,
                      mode=_BLENDINGS[mapper.GetBlendMode()])
        if prop.GetColorChannels(0) == 1:
            result["color"] = [(value, grey, grey, grey) for value, grey, *_ in _nodes(prop.GetGrayTransferFunction(0), 4)]
        if prop.HasGradientOpacity(0) and not prop.GetDisableGradientOpacity(0):
            result["gradient_opacity"] = [point[:2] for point in _nodes(prop.GetGradientOpacity(0), 4)] or None
        if prop.GetShade():
            result["shade"] = dict(zip(_SHADING, (prop.GetAmbient(), prop.GetDiffuse(), prop.GetSpecular(), prop.GetSpecularPower())))
        planes = mapper.GetClippingPlanes()
        if planes and planes.GetNumberOfItems():
            of = [(plane.GetNormal(), plane.GetOrigin()) for plane in (planes.GetItem(n) for n in range(planes.GetNumberOfItems()))]
            result["clip_planes"] = [(*normal, -float(numpy.dot(normal, origin))) for normal, origin in of]
        if isinstance(self.drawn, Volume):
            result["interpolation"] = "linear" if prop.GetInterpolationType() == 1 else "nearest"
        if (self.drawn.grid if isinstance(self.drawn, Volume) else self.drawn).components > 1 and not prop.GetIndependentComponents():
            result.update(dependent=True, color=None)
        return result

    @property
    def visibility(self):
        """Whether it shows."""
        return bool(self.GetVisibility())

    @visibility.setter
    def visibility(self, shown):
        self.SetVisibility(bool(shown))

    def set(self, **look):
        """Changes parameters that `Volume.render`, or of cells `Tetrahedra.render`, takes."""
        self.look.update(look)
        if self._layer is not None:
            self._layer._last = None  # whatever changed in an array
        if self.plotter is not None:
            self.plotter.render()

    def remove(self, render=True):
        """Takes the volume out of the scene, and its scalar bar with it."""
        if self._layer is not None:
            plotter, layer, box = self.plotter, self._layer, self._box
            layer.remove(self, plotter)
            if self.title in plotter.scalar_bars and not any(other.title == self.title for other in layer.volumes):
                plotter.remove_scalar_bar(self.title, render=False)
            if self._earth is not None:
                plotter.remove_actor(self._earth, render=False)
            plotter.remove_actor(box, render=render)
            self._leave()

    def _leave(self):
        """Forgets the scene, which would else hold the volume that holds it."""
        self.plotter, self.renderer, self._layer, self._box, self._earth = (None,) * 5


def _nodes(function, count):
    """The points of one of VTK's functions, tuples of so many numbers."""
    result, point = [], [0.0] * count
    for n in range(function.GetSize()):
        function.GetNodeValue(n, point)
        result.append(tuple(point))
    return result


def _limits(clim, low, high, log_scale):
    if clim is not None:
        low, high = numbers(clim if numpy.ndim(clim) else (-number(clim, "clim"), number(clim, "clim")), 2, "clim")
        if low > high:
            raise ValueError(f"clim is {clim!r}, the first must be at most the second")
    if log_scale and low <= 0:
        low = min(numpy.finfo(float).tiny, high)
    return low, high


def _table(cmap, n_colors, opacity, low, high, flip_scalars, log_scale, annotations):
    """pyvista's table of colours and opacities."""
    from pyvista.plotting.colors import get_cmap_safe
    if isinstance(cmap, pyvista.LookupTable):
        return cmap
    table = pyvista.LookupTable()
    colors = get_cmap_safe(cmap)
    table.apply_cmap(colors.reversed() if flip_scalars else colors, n_colors)
    if isinstance(opacity, (int, float)) and not isinstance(opacity, bool):
        if not 0 <= opacity <= 1:
            raise ValueError(f"opacity is {opacity!r}, it must be in 0..1")
        table.values[:, -1] = 255 * opacity
    else:
        table.apply_opacity(opacity)
    table.scalar_range = (low, high)
    table.log_scale = bool(log_scale)
    if annotations:
        table.annotations = annotations
    return table


def _with_scalars(volume, scalars, preference):
    """A grid that has the scalars active, and their name. scalars: a name, an array with one for each point or cell, or None: the active ones."""
    if scalars is None or isinstance(scalars, str):
        if scalars is None and volume.active_scalars is not None and not numpy.issubdtype(volume.active_scalars.dtype, numpy.number):
            raise TypeError("the grid's active scalars are no numbers")
        name = volume.active_scalars_name if scalars is None else scalars
        if name is None:
            raise ValueError("the grid has no active scalars, neither of points nor of cells; name them by scalars=")
        return volume, name
    values = numpy.asarray(scalars)
    if values.dtype.kind not in "biuf":
        raise TypeError(f"scalars is of type {values.dtype}, it must be numbers")
    sizes = dict(point=volume.n_points, cell=volume.n_cells)
    if values.ndim not in (1, 2):
        raise ValueError(f"scalars has {values.ndim} dimensions, it must have 1 or 2")
    if len(values) not in sizes.values():
        raise ValueError(f"scalars has the shape {values.shape}, it must have one for each of the {sizes['point']} points or {sizes['cell']} cells")
    if preference not in sizes:
        raise ValueError(f"preference is {preference!r}, it must be point or cell")
    of = preference if sizes[preference] == len(values) else "point" if sizes["point"] == len(values) else "cell"
    volume = volume.copy(deep=False)
    (volume.point_data if of == "point" else volume.cell_data)["Data"] = values
    return volume, "Data"


def _array_of(volume, name, preference):
    """The named array of a grid, of points or of cells."""
    data = [volume.point_data, volume.cell_data]
    for each in data[::-1] if preference == "cell" else data:
        if name in each:
            return each[name]
    raise ValueError(f"scalars is {name!r}, it must be one of {[*volume.point_data.keys(), *volume.cell_data.keys()]}")


def _grid(volume, scalars, preference, place):
    """What draws pyvista's grid, the scalars' name and its array."""
    if not isinstance(volume, pyvista.DataSet):
        volume = pyvista.wrap(volume)
    if isinstance(volume, pyvista.StructuredGrid) and min(volume.dimensions) < 2:
        raise ValueError(f"the structured grid has the dimensions {tuple(volume.dimensions)}, it must have at least 2 points along each axis")
    if not isinstance(volume, (pyvista.ImageData, pyvista.RectilinearGrid, pyvista.UnstructuredGrid, pyvista.StructuredGrid)):
        raise TypeError(f"the data set is a {type(volume).__name__}, it must be an array, or ImageData, RectilinearGrid, StructuredGrid, "
                        "UnstructuredGrid or MultiBlock of these")
    if volume.n_points == 0:
        raise ValueError("the grid has no points")
    volume, name = _with_scalars(volume, scalars, preference)
    values = _array_of(volume, name, preference)
    if values.ndim == 2 and (values.shape[1] != 4 or values.dtype != numpy.uint8):
        raise ValueError(f"scalars {name!r} has the shape {values.shape} and datatype {values.dtype}, it must be one number each, or red, green, blue and "
                         "opacity of datatype uint8")
    place = dict(place, component="all" if values.ndim == 2 else None)
    if name in volume.point_data and name in volume.cell_data and preference == "cell":
        volume = volume.copy(deep=False)
        volume.point_data.remove(name)
    kind = Tetrahedra if isinstance(volume, (pyvista.UnstructuredGrid, pyvista.StructuredGrid)) else Volume
    return kind(volume, scalars=name, **place), name, values


def _drawn(volume, scalars, resolution, preference, memory, progress, place):
    """What draws the data, the scalars' name and values where they are known, and the data as a grid of pyvista's or as they are."""
    spacing = None if resolution is None else numbers(resolution, 3, "resolution")
    labelled = hasattr(volume, "dims") and hasattr(volume, "coords")
    on_earth = {name: place.pop(name) for name in ("globe", "exaggerate")}
    if hasattr(volume, "data_vars") or labelled and any(on_earth.values()):
        drawn = drawn_of(volume, spacing=spacing, scalars=scalars, memory=memory, **place, **on_earth)
        if isinstance(drawn, OnGlobe):
            drawn.on_scene()
        return drawn, scalars or getattr(volume, "name", None), None, volume
    for name, value in on_earth.items():
        if value:
            raise ValueError(f"{name} is {value!r}, but only xarray's data have places on the Earth")
    if isinstance(volume, (Volume, Tetrahedra)):
        return volume, None, None, volume
    if isinstance(volume, numpy.ndarray) and scalars is None:
        return Volume(volume, axes="xyz", spacing=spacing, **place), None, volume, volume
    if scalars is None and lazy_of(volume) is not None:
        drawn = Volume(volume, axes=None if labelled else "xyz", spacing=spacing, memory=memory, **place)
        drawn.settle(progress)
        return drawn, volume.name if labelled else None, None if isinstance(drawn.grid, LazyGrid) else drawn.grid.values, volume
    if isinstance(volume, numpy.ndarray):  # its scalars are distinguished from it
        volume = pyvista.wrap(volume)
        volume.spacing = (1, 1, 1) if spacing is None else spacing
    return *_grid(volume, scalars, preference, place), volume


def add_volume(plotter, volume, scalars=None, clim=None, resolution=None, opacity="linear", n_colors=256, cmap=None, flip_scalars=False,
               reset_camera=None, name=None, ambient=None, categories=False, culling=False, multi_colors=False, blending="composite", mapper=None,
               scalar_bar_args=None, show_scalar_bar=None, annotations=None, pickable=True, preference="point", opacity_unit_distance=None, shade=False,
               diffuse=0.7, specular=0.2, specular_power=10.0, render=True, user_matrix=None, log_scale=False, device=None, threads=None, memory=None,
               globe=False, exaggerate=None, **options):
    """Adds a volume to a plotter's scene and returns a StratusVolume, or for a MultiBlock a list with one for each block. The arguments have the
    names of pyvista's own add_volume. Values between others are interpolated linearly by default, for which pyvista's own volumes need
    `prop.interpolation_type = "linear"`; values of cells are drawn as such. Several volumes of a renderer mix along its rays.

    volume    array (nx, ny, nz), as pyvista's own add_volume accepts it, or a lazy one; an xarray.DataArray; ImageData, RectilinearGrid,
              UnstructuredGrid, StructuredGrid, or a MultiBlock of these; an xarray.Dataset, whose variable `scalars` names, with a mesh of UGRID,
              FVCOM, MPAS or ICON or without; or a Volume or Tetrahedra. Or steps: an xarray.DataArray with a time besides three dimensions of
              space, a variable of a Dataset with one, or a list of data. The first shows; its range and scalars are those of all
    scalars   name of the array of a grid or variable of a Dataset, or an array with one for each point or cell, or (n, 4) bytes: red, green, blue and opacity; default: the
              active one. preference: "point" or "cell", where a name or a length fits both
    clim      least and greatest value of opacity and colours; one number c means (-c, c); default: the values' own
    resolution  of an array: its spacing
    opacity   a name of pyvista's such as "linear" or "sigmoid_5", one number, or opacities over clim. They end at 0.998, as pyvista's do
    n_colors, cmap, flip_scalars, categories, log_scale, annotations  of the table of colours, as pyvista's; cmap may be a LookupTable
    name      a volume of that name is replaced
    blending  composite, maximum, minimum, average, additive, isosurface or slice
    shade     whether light from the camera falls on it, by ambient, diffuse, specular and specular_power
    opacity_unit_distance   length to which opacities refer, before user_matrix as in VTK's mappers; default: the grid's length over its mean count
              of cells along an axis, and 1 of cells of unstructured and structured grids
    user_matrix  (4, 4), the last transformation into the world
    reset_camera, render, show_scalar_bar, scalar_bar_args  as pyvista's
    mapper, culling, pickable  are accepted and change nothing: the mapper is Stratus, it has no faces, and picking does not see it
    memory    of lazy arrays, as in `stratus_volume.Volume`
    globe, exaggerate  of xarray's data, as in `stratus_volume.render`. A sphere beneath data on a globe is opaque geometry of the scene
    device, threads, and all other options of `stratus_volume.render`: tolerance, crop, clip_planes, contours, progress and so on
    """
    clim, cmap = options.pop("rng", clim), options.pop("colormap", cmap)
    options.pop("backface_culling", None)
    if mapper is not None and mapper not in _MAPPERS:
        raise TypeError(f"mapper is {mapper!r}, it must be one of {', '.join(_MAPPERS)}; Stratus draws in place of any")
    if culling not in (False, True, "front", "back", "frontface", "backface", "f", "b"):
        raise ValueError(f"culling is {culling!r}, it must be False, True, front or back")
    if blending not in _BLENDINGS:
        raise ValueError(f"blending is {blending!r}, it must be one of {', '.join(_BLENDINGS)}")
    if isinstance(volume, pyvista.MultiBlock):
        name = f"MultiBlock({id(volume)})" if name is None else name
        look = dict(scalars=scalars, clim=clim, opacity=opacity, n_colors=n_colors, flip_scalars=flip_scalars, reset_camera=reset_camera, ambient=ambient,
                    categories=categories, blending=blending, scalar_bar_args=scalar_bar_args, show_scalar_bar=show_scalar_bar, annotations=annotations,
                    preference=preference, opacity_unit_distance=opacity_unit_distance, shade=shade, diffuse=diffuse, specular=specular,
                    specular_power=specular_power, render=render, user_matrix=user_matrix, log_scale=log_scale, device=device, threads=threads, globe=globe,
                    exaggerate=exaggerate, **options)
        return [add_volume(plotter, block, cmap=_BLOCKS[n % len(_BLOCKS)] if multi_colors else cmap, name=f"{name}-{n}", **look)
                for n, block in enumerate(volume) if block is not None]
    if show_scalar_bar is None:
        show_scalar_bar = plotter.theme.show_scalar_bar or bool(scalar_bar_args)
    _matrix(user_matrix)  # refuses an invalid matrix before anything changes
    place = dict(device=device, threads=threads, globe=globe, exaggerate=exaggerate)
    steps = Steps.of(volume, scalars if isinstance(scalars, str) else None)

    def make(data):
        return _drawn(data, scalars, resolution, preference, memory, options.get("progress"), dict(place))
    drawn, title, values, volume = make(volume if steps is None else steps[0])
    of = drawn.grid if isinstance(drawn, Volume) else drawn
    low, high = (0.0, 1.0) if of.spread is None else (min(each.low for each in of.spreads), max(each.high for each in of.spreads))
    low, high = _limits(clim, low, high, log_scale)
    rgba = of.components == 4 and values is not None and values.dtype == numpy.uint8
    if rgba and not (isinstance(opacity, str) and opacity == "linear"):
        warnings.warn("Ignoring custom opacity due to RGBA scalars.", UserWarning, stacklevel=2)
        opacity = "linear"
    if categories and values is not None:
        n_colors = len(numpy.unique(values)) if categories is True else int(categories)
    table = _table(plotter.theme.cmap if cmap is None else cmap, n_colors, opacity, low, high, flip_scalars, log_scale, annotations)
    if opacity_unit_distance is None:
        opacity_unit_distance = _unit(volume, drawn) * _stretch(_matrix_of(drawn))
    mapper, prop = _words(plotter, volume, drawn, table)
    prop.ambient, prop.diffuse, prop.specular, prop.specular_power = 0.1 if ambient is None else ambient, diffuse, specular, specular_power
    prop.shade, prop.interpolation_type, prop.opacity_unit_distance = bool(shade), "linear", opacity_unit_distance
    prop.independent_components = not rgba
    if blending in _BLENDINGS[:5]:
        mapper.blend_mode = blending
    else:
        options.setdefault("mode", blending)
    if name is not None:
        for layer in plotter.__dict__.get("_stratus_layers", [])[:]:
            for other in [each for each in layer.volumes if each.called == name and layer.renderer is plotter.renderer]:
                other.remove(render=False)
    result = StratusVolume(plotter, drawn, mapper, prop, options, user_matrix)
    result.steps, result._make, result._step = steps, make, None if steps is None else 0
    if name is not None:
        result.name = result.called = name
    result.enter(name, reset_camera, render)
    plotter.mapper, plotter.volume = mapper, result
    if show_scalar_bar and not rgba:
        bar = dict(scalar_bar_args or {})
        result.title = bar.setdefault("title", title or "values")
        plotter.add_scalar_bar(**bar)
    return result


def _words(plotter, volume, drawn, table):
    """Returns pyvista's mapper and property with a volume's settings. The mapper has the grid's bounds, and draws nothing."""
    from pyvista.plotting.mapper import SmartVolumeMapper, UnstructuredGridVolumeRayCastMapper
    from pyvista.plotting.volume_property import VolumeProperty
    kind = UnstructuredGridVolumeRayCastMapper if isinstance(volume, pyvista.UnstructuredGrid) else SmartVolumeMapper
    mapper = kind(theme=plotter.theme)
    if not isinstance(volume, (pyvista.ImageData, pyvista.RectilinearGrid, pyvista.UnstructuredGrid)):
        low, high = numpy.array(drawn.bounds[::2]), numpy.array(drawn.bounds[1::2])
        volume = pyvista.ImageData(dimensions=(2, 2, 2), spacing=numpy.maximum(high - low, 1e-300), origin=low)
    mapper.dataset = volume
    mapper.scalar_range = table.scalar_range
    mapper.lookup_table = table
    return mapper, VolumeProperty(lookup_table=table)


def _matrix_of(drawn):
    matrix = drawn.grid.matrix if isinstance(drawn, Volume) else drawn.matrix
    return numpy.eye(4) if matrix is None else matrix.reshape(4, 4).copy()


def _stretch(matrix):
    """The factor of lengths, in the mean of all directions."""
    return 1.0 if matrix is None else float(abs(numpy.linalg.det(numpy.asarray(matrix)[:3, :3])) ** (1 / 3))


def _unit(volume, drawn):
    """pyvista's default of the length that opacities refer to, which no matrix enters. Data on the Earth, in metres, have the length of a cell in the
    mean of the depth, which is not their box's on a globe."""
    if isinstance(drawn, Tetrahedra):
        return drawn.mean_cell() or 1.0
    if isinstance(volume, pyvista.DataSet):
        length, counts = volume.length, volume.dimensions
    else:
        matrix = _matrix_of(drawn)
        drawn._place(None)
        length, counts = numpy.linalg.norm(numpy.subtract(drawn.bounds[1::2], drawn.bounds[::2])), drawn.grid.values.shape[:3]
        drawn._place(matrix)
    return float(length / max(1, numpy.mean(counts) - 1)) or 1.0


def _matrix(transform):
    """Returns the matrix (4, 4) of a transformation as pyvista accepts it, or None."""
    if transform is None:
        return None
    try:
        import pyvista_validation as validation
    except ImportError:  # before pyvista 0.49 it is a part of it
        from pyvista.core import _validation as validation
    return validation.validate_transform4x4(transform)


class StratusComponent:
    """`plotter.stratus`."""

    def __init__(self, plotter):
        self._plotter = plotter
        if not _COMPONENTS:
            close = plotter.close

            def closing():
                self.__plotter_close__()
                close()
            plotter.close = closing

    @property
    def volumes(self):
        """The StratusVolumes of the plotter."""
        return [volume for layer in self._plotter.__dict__.get("_stratus_layers", []) for volume in layer.volumes]

    def add_volume(self, volume, *arguments, **options):
        return add_volume(self._plotter, volume, *arguments, **options)

    def sliders(self):
        """Adds sliders of opacity and of steps to the layout of trame that is being made: `plotter_ui(plotter, add_menu_items=plotter.stratus.sliders)`,
        or in a notebook `plotter.show(jupyter_backend="server", jupyter_kwargs=dict(add_menu_items=plotter.stratus.sliders))`."""
        Sliders(self._plotter)

    def __plotter_close__(self):
        for layer in self._plotter.__dict__.pop("_stratus_layers", []):
            layer.close()


StratusComponent.add_volume.__doc__ = add_volume.__doc__
if _COMPONENTS:
    pyvista.register_plotter_component("stratus")(StratusComponent)
else:
    pyvista.BasePlotter.stratus = functools.cached_property(StratusComponent)
    pyvista.BasePlotter.stratus.__set_name__(pyvista.BasePlotter, "stratus")
