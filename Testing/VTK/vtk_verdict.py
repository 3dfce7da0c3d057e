# SPDX-License-Identifier: BSD-3-Clause
"""One window in which a scene is drawn by VTK's mapper and by ours, and the cases of the table of VTK's tests (docs/vtk-parity.md)."""
import contextlib

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

SIZE = 96, 90  # pixels
BACKGROUND = 0.2, 0.25, 0.3
STEP = 0.1  # of VTK's mappers, in spacings, so that what stays different is meaning and no error of sampling
TOLERANCE = 2e-4  # ours, for the same reason


class Case:
    """One of VTK's tests. The function returns what its verdict needs: see Same, Different, Better and Refused."""

    def __init__(self, name, function):
        self.name, self.function = name, function


class Same:
    """Pairs of pictures, VTK's and ours, that should be equal."""

    def __init__(self, *pairs):
        self.pairs = pairs


class Different(Same):
    """Pairs that differ, and pairs in which the cause is switched off. reference: the mean distances of VTK's picture and of
    ours from one that is right."""

    def __init__(self, pairs, without=(), reference=None):
        super().__init__(*pairs)
        self.without, self.reference = without, reference


class Better:
    """Facts by their names, each with its truth: they hold of ours and fail of VTK's. ours and vtks: distances of both from the right
    picture."""

    def __init__(self, facts, ours=None, vtks=None):
        self.facts, self.ours, self.vtks = facts, ours, vtks


class Refused:
    """The sentence that our mapper says, and whether VTK draws the same scene."""

    def __init__(self, sentence, drawn):
        self.sentence, self.drawn = sentence, drawn


cases = {}


def case(*names):
    """Registers a function under names of VTK's tests."""

    def register(function):
        for name in names:
            assert name not in cases, name
            cases[name] = Case(name, function)
        return function

    return register


_window = vtk.vtkRenderWindow()
_window.SetOffScreenRendering(1)
_window.SetMultiSamples(0)
_window.SetAlphaBitPlanes(1)


def pixels(size=SIZE):
    """The window's last picture: height x width x 3 bytes, the lowest row first, as integers."""
    data = vtk.vtkUnsignedCharArray()
    _window.GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 1, data)
    return vtk_to_numpy(data).reshape(size[1], size[0], 4)[..., :3].astype(int)


@contextlib.contextmanager
def renderers(*viewports, size=SIZE):
    """Renderers of the window, one for each viewport."""
    _window.SetSize(*size)
    made = []
    for viewport in viewports or ((0, 0, 1, 1),):
        renderer = vtk.vtkRenderer()
        renderer.SetViewport(*viewport)
        renderer.SetBackground(BACKGROUND)
        _window.AddRenderer(renderer)
        made.append(renderer)
    try:
        yield made if len(made) > 1 else made[0]
    finally:
        for renderer in made:
            renderer.RemoveAllViewProps()
            _window.RemoveRenderer(renderer)


def render():
    _window.Render()


def is_ours(mapper):
    return mapper.GetClassName().startswith("vtkStratus")


def fine(mapper, step):
    """Asks either mapper for a small error."""
    if is_ours(mapper):
        if mapper.IsA("vtkStratusMultiBlockVolumeMapper"):
            mapper = mapper.GetSettings()
        mapper.SetImageErrorTolerance(TOLERANCE)
        mapper.SetDevice("host")
        return
    for name, value in ("AutoAdjustSampleDistances", 0), ("InteractiveAdjustSampleDistances", 0), ("UseJittering", 0), \
            ("ImageSampleDistance", 1), ("SampleDistance", step), ("RequestedRenderModeToGPU", None):
        setter = getattr(mapper, "Set" + name, None)
        if setter is not None:
            setter(*() if value is None else (value,))


def errors_of(one):
    """A list to which the texts of an object's errors are added, which then are not printed."""
    texts = []

    @vtk.calldata_type(vtk.VTK_STRING)
    def keep(caller, event, text):
        texts.append(text)

    one.AddObserver("ErrorEvent", keep)
    return texts


def last_error(mapper):
    return mapper.GetLastError() if hasattr(mapper, "GetLastError") else ""


def look_at(renderer, camera):
    """Turns the camera to all that is in the scene; camera: azimuth, elevation and zoom, or a function of renderer and camera."""
    view = renderer.GetActiveCamera()
    if callable(camera):
        camera(renderer, view)
    else:
        azimuth, elevation, zoom = camera
        renderer.ResetCamera()
        view.Azimuth(azimuth), view.Elevation(elevation), view.OrthogonalizeViewUp()
        view.Zoom(zoom)
    renderer.ResetCameraClippingRange()


def volume_of(mapper, look, place):
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    place(volume)
    return volume


def nothing(*_):
    pass


def picture(kind, data, look, settings=nothing, place=nothing, scene=nothing, camera=(30, 20, 1.3), step=STEP, size=SIZE, then=None):
    """Draws data by a mapper of this kind. settings(mapper), place(volume) and scene(renderer) say what else there is; then(volume), what
    changes after a first picture."""
    vtk.vtkMath.RandomSeed(1)  # VTK sorts tetrahedra around random ones, and with them changes the order of those as far away
    mapper = kind()
    mapper.SetInputDataObject(data)
    fine(mapper, step)
    settings(mapper)
    with renderers(size=size) as renderer:
        volume = volume_of(mapper, look, place)
        renderer.AddVolume(volume)
        scene(renderer)
        look_at(renderer, camera)
        render()
        if then is not None:
            then(volume)
            render()
        result = pixels(size)
        if last_error(mapper):
            raise RuntimeError(last_error(mapper))
        mapper.ReleaseGraphicsResources(_window)
    return result


INSTEAD = {
    "vtkProjectedTetrahedraMapper": stratus.vtkStratusTetrahedraMapper,
    "vtkUnstructuredGridVolumeRayCastMapper": stratus.vtkStratusTetrahedraMapper,
    "vtkMultiBlockUnstructuredGridVolumeMapper": stratus.vtkStratusTetrahedraMapper,
    "vtkMultiBlockVolumeMapper": stratus.vtkStratusMultiBlockVolumeMapper,
}
GPU, SMART, FIXED = vtk.vtkGPUVolumeRayCastMapper, vtk.vtkSmartVolumeMapper, vtk.vtkFixedPointVolumeRayCastMapper
OURS, TETRA, CAST = stratus.vtkStratusVolumeMapper, vtk.vtkProjectedTetrahedraMapper, vtk.vtkUnstructuredGridVolumeRayCastMapper


def pair(data, look, *arguments, kind=GPU, ours=None, **options):
    """The same scene by VTK's mapper and by ours, with one line changed. VTK's mappers that cast rays on the host stretch their picture,
    sometimes more, sometimes less, where the window's sides are no powers of two."""
    options.setdefault("size", (128, 128) if kind in (FIXED, CAST) else SIZE)
    ours = ours or INSTEAD.get(kind.__name__, OURS)
    return picture(kind, data, look, *arguments, **options), picture(ours, data, look, *arguments, **options)


def refusal(data, look, settings=nothing, place=nothing, scene=nothing, kind=GPU):
    """What our mapper says, and whether VTK's draws something."""
    mapper = OURS()
    mapper.SetInputDataObject(data)
    errors = errors_of(mapper)
    settings(mapper)
    with renderers() as renderer:
        renderer.AddVolume(volume_of(mapper, look, place))
        scene(renderer)
        look_at(renderer, (30, 20, 1.3))
        render()
        empty = (pixels() == pixels()[0, 0]).all()
    drawn = picture(kind, data, look, settings, place, scene)
    assert empty and len(errors) == 1, f"one error and no picture: {errors}"
    return Refused(mapper.GetLastError(), (drawn != drawn[0, 0]).any())


def differences(pairs):
    """The largest mean and the largest maximum of the pairs, of 255."""
    parts = [numpy.abs(vtks - ours) for vtks, ours in pairs]
    return max(part.mean() for part in parts), max(part.max() for part in parts)


def image_of(array, spacing=(1, 1, 1), origin=(0, 0, 0), name="values", cells=False):
    """An image of array[z, y, x], or array[z, y, x, component], of points or of cells."""
    image = vtk.vtkImageData()
    image.SetSpacing(spacing), image.SetOrigin(origin)
    shape = array.shape[:3]
    image.SetDimensions(*(n + cells for n in reversed(shape)))
    kind = vtk.VTK_SIGNED_CHAR if array.dtype == numpy.int8 else None  # not the platform's char, which VTK's mapper refuses
    values = numpy_to_vtk(numpy.ascontiguousarray(array).reshape(-1, *array.shape[3:]), True, kind)
    values.SetName(name)
    (image.GetCellData() if cells else image.GetPointData()).SetScalars(values)
    return image
