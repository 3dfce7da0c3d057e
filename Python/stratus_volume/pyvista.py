# SPDX-License-Identifier: BSD-3-Clause
"""Volumes of Stratus in pyvista's scenes: `plotter.stratus.add_volume(grid)`, with the words of `plotter.add_volume`.

The picture is drawn by the core and laid over the scene's opaque geometry by its depth. No class of VTK is compiled for this, so that any
VTK from 9.1 on will do. pyvista from 0.48 on finds the component by itself; `add_volume(plotter, grid)` of this module is the same in
pyvista before.

What it costs: depth is read from the window, and the picture is handed to it as a texture of bytes, in each frame. What cannot be right:
translucent geometry is always behind the volume, and picking does not see it.
"""
import warnings

import numpy
import pyvista
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject, vtkImageData, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkRenderingCore import vtkCoordinate, vtkPolyDataMapper2D, vtkTexture, vtkTexturedActor2D

from . import _declarations as c
from ._picture import paint
from ._tetrahedra import Tetrahedra
from ._values import number, numbers
from ._volume import Volume

_BLENDINGS = ("composite", "maximum", "minimum", "average", "additive", "isosurface")
_SHADING = ("ambient", "diffuse", "specular", "specular_power")


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
    """Puts out the picture of a renderer's view. VTK asks for it when it draws the texture, after the scene's geometry."""

    def __init__(self, view, renderer):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")
        self.view, self.renderer, self.size = view, renderer, (1, 1)

    def RequestInformation(self, request, inputs, outputs):
        self.size = tuple(max(1, side) for side in self.renderer.GetSize())
        info = outputs.GetInformationObject(0)
        info.Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), (0, self.size[0] - 1, 0, self.size[1] - 1, 0, 0), 6)
        vtkDataObject.SetPointDataActiveScalarInfo(info, VTK_UNSIGNED_CHAR, 4)
        return 1

    def RequestData(self, request, inputs, outputs):
        image = vtkImageData.GetData(outputs, 0)
        image.SetDimensions(*self.size, 1)
        try:
            rows = self.view.draw(self.renderer, self.size)
        except Exception as error:  # VTK would go on with a texture that is half made
            warnings.warn(f"Stratus draws nothing: {error}", RuntimeWarning, stacklevel=2)
            rows = numpy.zeros((self.size[1], self.size[0], 4), numpy.uint8)
        scalars = numpy_to_vtk(rows.reshape(-1, 4), deep=True)
        scalars.SetName("picture")
        image.GetPointData().SetScalars(scalars)
        return 1


def _window(renderer, algorithm):
    """The actor that covers a renderer's view with a texture."""
    texture = vtkTexture()
    texture.SetInputConnection(algorithm.GetOutputPort())
    points, cells, places = vtkPoints(), vtkCellArray(), vtkFloatArray()
    places.SetNumberOfComponents(2)
    for x, y in (0, 0), (1, 0), (1, 1), (0, 1):
        points.InsertNextPoint(x, y, 0)
        places.InsertNextTuple2(x, y)
    cells.InsertNextCell(4, (0, 1, 2, 3))
    square, coordinate, mapper, actor = vtkPolyData(), vtkCoordinate(), vtkPolyDataMapper2D(), vtkTexturedActor2D()
    square.SetPoints(points)
    square.SetPolys(cells)
    square.GetPointData().SetTCoords(places)
    coordinate.SetCoordinateSystemToNormalizedViewport()
    mapper.SetInputData(square)
    mapper.SetTransformCoordinate(coordinate)
    actor.SetMapper(mapper)
    actor.SetTexture(texture)
    return actor


def _lay_below(renderer, actor):
    """Adds the actor so that it is drawn before all other annotations: VTK draws them in the order in which they came."""
    others = [prop for prop in renderer.GetViewProps() if prop.IsA("vtkActor2D")]
    for prop in others:
        renderer.RemoveViewProp(prop)
    for prop in actor, *others:
        renderer.AddViewProp(prop)


class StratusVolume:
    """A volume in a scene. `set` changes how it looks, `remove` takes it away, `visibility` hides it, `counters` tell of the last frame."""

    def __init__(self, plotter, drawn, look):
        self.plotter, self.drawn, self.look, self.counters, self.visibility = plotter, drawn, look, {}, True
        self.renderer = plotter.renderer
        self._algorithm = _Picture(self, self.renderer)
        self._actor = _window(self.renderer, self._algorithm)
        _lay_below(self.renderer, self._actor)
        self._observer = self.renderer.AddObserver("StartEvent", lambda caller, event: self._algorithm.Modified())
        # Its bounds count for the camera and its clipping range; it shows nothing.
        self._box = plotter.add_mesh(pyvista.Box(drawn.bounds), opacity=0.0, pickable=False, show_scalar_bar=False, reset_camera=True)

    def set(self, **look):
        """Changes parameters that `Volume.render`, or of cells `Tetrahedra.render`, takes."""
        self.look.update(look)
        self.plotter.render()

    def remove(self):
        """Takes the volume out of the scene."""
        if self._actor is not None:
            self.renderer.RemoveObserver(self._observer)
            self.renderer.RemoveViewProp(self._actor)
            self.plotter.remove_actor(self._box)  # and its scalar bar
            self._actor = None

    def draw(self, renderer, size):
        """The picture in bytes, colours not multiplied by alpha, the bottom row first. VTK's texture asks for it within a frame."""
        if not self.visibility:
            return numpy.zeros((size[1], size[0], 4), numpy.uint8)
        depths, (x, y) = vtkFloatArray(), renderer.GetOrigin()
        renderer.GetRenderWindow().GetZbufferData(x, y, x + size[0] - 1, y + size[1] - 1, depths)
        opaque = numpy.clip(vtk_to_numpy(depths).reshape(size[1], size[0]), 0, 1)[::-1]
        view = core_camera(renderer.GetActiveCamera(), renderer.GetTiledAspectRatio())
        with warnings.catch_warnings():
            if self.counters:  # once is enough: frames follow each other
                warnings.simplefilter("ignore")
            rendering = self.drawn.render(size=size, camera=view, opaque_depth=opaque, **self.look)
        self.counters = rendering.counters
        return numpy.ascontiguousarray(paint(rendering.rgba, None)[::-1])


def _look(low, high, opacity, cmap, n_colors, unit, blending, shade, flip_scalars, shading):
    """The parameters of `render` that pyvista's words stand for."""
    from pyvista.plotting.colors import get_cmap_safe
    from pyvista.plotting.tools import opacity_transfer_function
    if blending not in _BLENDINGS:
        raise ValueError(f"blending is {blending!r}, it must be one of {', '.join(_BLENDINGS)}")
    places = numpy.linspace(low, high, n_colors) if low < high else numpy.array([low])
    if isinstance(opacity, (int, float)) and not isinstance(opacity, bool):
        if not 0 <= opacity <= 1:
            raise ValueError(f"opacity is {opacity!r}, it must be in 0..1")
        opacities = numpy.full(len(places), float(opacity))
    else:
        opacities = numpy.asarray(opacity_transfer_function(opacity, n_colors), float)[:len(places)] / 255
    colors = get_cmap_safe(cmap)(numpy.linspace(0, 1, len(places)))[:, :3]
    if flip_scalars:
        colors = colors[::-1]
    return dict(opacity=list(zip(places, opacities)), color=[(place, *color) for place, color in zip(places, colors)], unit_distance=unit,
                mode=blending, shade=shading if shade else False)


def add_volume(plotter, volume, scalars=None, clim=None, opacity="linear", cmap=None, n_colors=256, blending="composite", shade=False,
               opacity_unit_distance=None, flip_scalars=False, show_scalar_bar=True, scalar_bar_args=None, ambient=0.3, diffuse=0.7, specular=0.2,
               specular_power=10.0, device=None, threads=None, **options):
    """Adds a volume to a plotter's scene and returns a StratusVolume. Values between others are interpolated linearly by default, for which
    pyvista's own volumes need `prop.interpolation_type = "linear"`.

    volume    array (nx, ny, nz), as pyvista's own add_volume takes it; or ImageData, RectilinearGrid, UnstructuredGrid or StructuredGrid; or a
              Volume or Tetrahedra
    scalars   name of the array of a grid; default: the active one
    clim      least and greatest value of opacity and colours; default: those of the values
    opacity   a name of pyvista's such as "linear" or "sigmoid_5", one number, or opacities over clim
    cmap      name of a colour map; default: the theme's
    blending  composite, maximum, minimum, average, additive or isosurface
    shade     whether light from the camera falls on it, by ambient, diffuse, specular and specular_power
    opacity_unit_distance   world length to which opacities refer; default: the grid's length over its mean count of cells along an axis
    device, threads, and all other options of `stratus_volume.render`: tolerance, crop, clip_planes, contours, progress and so on
    """
    if isinstance(volume, (Volume, Tetrahedra)):
        drawn = volume
    elif isinstance(volume, numpy.ndarray):
        drawn = Volume(volume, axes="xyz", device=device, threads=threads)
    elif volume.IsA("vtkUnstructuredGrid") or volume.IsA("vtkStructuredGrid"):
        drawn = Tetrahedra(volume, scalars=scalars, device=device, threads=threads)
    else:
        drawn = Volume(volume, scalars=scalars, device=device, threads=threads)
    spread = drawn.grid.spread if isinstance(drawn, Volume) else drawn.spread
    low, high = (0.0, 1.0) if spread is None else (spread.low, spread.high)
    if clim is not None:
        low, high = numbers(clim if numpy.ndim(clim) else (-number(clim, "clim"), number(clim, "clim")), 2, "clim")
        if low > high:
            raise ValueError(f"clim is {clim!r}, the first must be at most the second")
    cmap = plotter.theme.cmap if cmap is None else cmap
    if opacity_unit_distance is None:
        lengths = numpy.subtract(drawn.bounds[1::2], drawn.bounds[::2])
        counts = drawn.grid.values.shape if isinstance(drawn, Volume) else [max(2, round(len(drawn.points.reshape(-1, 3)) ** (1 / 3)))] * 3
        opacity_unit_distance = float(numpy.linalg.norm(lengths) / max(1, numpy.mean(counts) - 1)) or 1.0
    shading = dict(zip(_SHADING, (ambient, diffuse, specular, specular_power)))
    look = _look(low, high, opacity, cmap, n_colors, opacity_unit_distance, blending, shade, flip_scalars, shading)
    result = StratusVolume(plotter, drawn, dict(look, **options))
    if show_scalar_bar:
        mapper = result._box.mapper
        mapper.lookup_table = pyvista.LookupTable(cmap, n_values=n_colors, scalar_range=(low, high), flip=flip_scalars)
        mapper.scalar_range = (low, high)
        title = getattr(volume, "active_scalars_name", None) if scalars is None else scalars
        plotter.add_scalar_bar(mapper=mapper, **{"title": title or "Data", **(scalar_bar_args or {})})
    return result


class StratusComponent:
    """`plotter.stratus`."""

    def __init__(self, plotter):
        self._plotter, self.volumes = plotter, []

    def add_volume(self, volume, *arguments, **options):
        self.volumes.append(add_volume(self._plotter, volume, *arguments, **options))
        return self.volumes[-1]

    def __plotter_close__(self):
        for volume in self.volumes:
            volume.renderer.RemoveObserver(volume._observer)
        self.volumes.clear()


StratusComponent.add_volume.__doc__ = add_volume.__doc__
if hasattr(pyvista, "register_plotter_component"):
    pyvista.register_plotter_component("stratus")(StratusComponent)
