# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: a session with "Stratus Volume", apart from its pictures. Cells and points are picked and hovered over, and
selections shown; traces and states draw again what was drawn; comparative views and linked cameras. Where ParaView's "Volume" can do it, too,
both are compared. pvbatch test_session.py PLUGIN STRATUS COMPARE-PICTURES FOLDER, in the repository's root."""
import os
import sys

import numpy
from paraview import simple, smstate, smtrace
from paraview.servermanager import _getPyProxy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, folder, leave, load, shot
from grids import COLORS, OPACITY, write_all
from showing import make_view, show_volume

SIZE = 120, 96
EYE, FOCUS, UP = numpy.array([160.0, 50, 60]), numpy.array([120.0, 2, 17]), numpy.array([0.0, 0, 1])


def look(view):
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = EYE.tolist(), FOCUS.tolist(), UP.tolist()


def first_place(x, y):
    """Where the ray of a pixel enters the ellipsoid in which the field of `grids.py` is above .05, the least value that shows."""
    forward = (FOCUS - EYE) / numpy.linalg.norm(FOCUS - EYE)
    right = numpy.cross(forward, UP)
    right /= numpy.linalg.norm(right)
    scale = numpy.tan(numpy.radians(15))
    ray = forward + ((2 * x + 1) / SIZE[0] - 1) * scale * SIZE[0] / SIZE[1] * right
    ray += ((2 * y + 1) / SIZE[1] - 1) * scale * numpy.cross(right, forward)
    start, along = (EYE - [120, 0, 15]) / [18, 20, 12], ray / [18, 20, 12]
    a, b, c = along @ along, along @ start, start @ start - 0.95
    return EYE + (-b - (b * b - a * c) ** 0.5) / a * ray


def chosen(source, what, view, rectangle):
    """Returns the kind of the selection, its numbers, and the bounds of the extracted data; None if nothing is selected."""
    simple.ClearSelection(source)
    getattr(simple, what)(Rectangle=rectangle, View=view)
    selection = source.GetSelectionInput(0)
    if not selection:
        return None
    inner = _getPyProxy(selection).Input[0]
    extract = simple.ExtractSelection(Input=source)
    extract.UpdatePipeline()
    extracted = extract.GetDataInformation()
    answer = inner.GetXMLName(), list(getattr(inner, "IDs", [])), extracted.GetBounds(), extracted.GetNumberOfCells(), extracted.GetNumberOfPoints()
    simple.Delete(extract)
    return answer


def outside(bounds, place):
    """How far a place lies outside of bounds."""
    low, high = numpy.array(bounds[::2]), numpy.array(bounds[1::2])
    return numpy.maximum(numpy.maximum(low - place, place - high), 0).max()


def through(source, view):
    return [chosen(source, what, view, [54, 42, 66, 54]) for what in ("SelectCellsThrough", "SelectPointsThrough")]


def show(path, representation, kind):
    view = make_view(*SIZE)
    source, shown = show_volume(path, "hill", OPACITY, COLORS, 1.0, view, representation)
    shown.SetRepresentationType(kind)
    look(view)
    simple.SetActiveView(view)
    simple.SetActiveSource(source)
    simple.Render(view)
    return source, view


def end(source, view):
    simple.ClearSelection(source)
    simple.Delete(view)
    simple.Delete(source)


def beside_volume(path):
    """"Volume" reports that an image is picked, and the number of the cell where a ray ends, with an invalid process: nothing is selected.
    It reports no points. Both draw frusta alike, which use only the data."""
    source, view = show(path, None, "Volume")
    cell, frusta = chosen(source, "SelectSurfaceCells", view, [60, 48, 60, 48]), through(source, view)
    print(f'"Volume": cells {cell[1]}, of which {cell[3]} are in the data')
    end(source, view)
    source, view = show(path, None, "Stratus Volume")
    ours = chosen(source, "SelectSurfaceCells", view, [60, 48, 60, 48])
    check(ours[0] == cell[0] and ours[3] == 1, f"an image: {ours}")
    check(through(source, view) == frusta and frusta[0][3] > 100, "frusta select alike")
    end(source, view)


def picks(path, representation):
    name = os.path.basename(path)
    source, view = show(path, representation, "Stratus Volume")
    before = shot(view, f"{name}-before")
    for pixel in [(60, 48), (48, 36), (72, 57)][:3 if path == levels else 1]:
        right = first_place(*pixel)
        # The segment of the ray that shows first begins up to a cell before the place, as the field is linear in cells. They are at most
        # 2.3 wide, and the nearest of a cell's points is at most half a diagonal away.
        for what, most in ("SelectSurfaceCells", 2.3), ("SelectSurfacePoints", 4.0):
            answer = chosen(source, what, view, [*pixel, *pixel])
            check(answer and len(answer[1]) in (2, 3) and outside(answer[2], right) < most,
                  f"{name}: {what} at {pixel} reports {answer}, the ray first shows {right.round(1)}")
    check(chosen(source, "SelectSurfaceCells", view, [2, 2, 2, 2]) is None, f"{name}: nothing is selected where nothing is")
    place, normal = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
    found = view.SMProxy.ConvertDisplayToPointOnSurface([60, 48], place, normal, False)
    check(found and outside(numpy.repeat(place, 2), first_place(60, 48)) < 3.0, f"{name}: the centre of rotation is {place}")
    check(view.SMProxy.Pick(60, 48) is not None, f"{name}: the volume is picked")
    chosen(source, "SelectSurfaceCells", view, [54, 42, 66, 54])
    changed = (abs(shot(view, f"{name}-selected") - before).max(axis=1) > 0.1).reshape(SIZE[::-1])
    check(10 < changed[26:70, 38:82].sum() == changed.sum(), f"{name}: the selection shows, in {changed.sum()} pixels")
    end(source, view)


IMAGE = {"StratusRenderMode": "First Hit", "StratusNormals": "Gradient", "StratusTermination": 0.9, "StratusImageErrorTolerance": 0.002,
         "StratusUnitDistance": 2.0, "StratusDevice": "host", "StratusCloud": 1, "StratusWaterUnits": "g/m3", "StratusSunPosition": [150.0, 35.0]}
MESH = {"StratusCellsBlendMode": "Isosurface", "StratusCellsIsosurfaces": [0.5, 0.9], "StratusCellsShade": 1, "StratusCellsMethod": "March",
        "StratusUnitDistance": 3.0, "StratusCellsShadows": 1, "StratusCellsSkyUp": [0.0, 1.0, 0.0], "StratusSunTime": "2024-06-01"}


def record():
    """Draws an image and a mesh, and returns the pictures and the trace, in which a panel's changes are as ParaView's window records them."""
    config = smtrace.start_trace()
    config.SetFullyTraceSupplementalProxies(True)
    views = []
    for file, reader, changes in ("even.vti", "XMLImageDataReader", IMAGE), ("cells.vtu", "XMLUnstructuredGridReader", MESH):
        source = getattr(simple, reader)(registrationName=file, FileName=[os.path.join(folder, file)])
        view = simple.CreateView("RenderView")
        view.ViewSize = SIZE
        shown = simple.Show(source, view)
        simple.ColorBy(shown, ("POINTS", "hill"))
        shown.SetRepresentationType("Stratus Volume")
        look(view)  # which the trace has with each picture
        for proxy, values in (view, {"OrientationAxesVisibility": 0, "UseFXAA": 0}), (shown, changes):
            item = smtrace.PropertiesModified(proxy)
            for key, value in values.items():
                setattr(proxy, key, value)
            if proxy is shown:  # the panel's report of the picture changes, too
                simple.Render(view)
            item.finalize()
            del item
        views.append((file, view))
    pictures = [shot(view, f"recorded-{file}") for file, view in views]  # both have one colour map
    return pictures, smtrace.stop_trace()


def again(name, pictures):
    """Compares what a script or a state has drawn with the pictures, and ends the session."""
    check(len(simple.GetViews()) == 2, f"{name}: {len(simple.GetViews())} views")
    for file, picture, changes in zip(("even.vti", "cells.vtu"), pictures, (IMAGE, MESH)):
        source = simple.FindSource(file)
        view, shown = next((view, shown) for view in simple.GetViews() for shown in view.Representations
                           if hasattr(shown, "Input") and shown.Input == source)
        for key, value in changes.items():
            now = getattr(shown, key)
            check((list(now) if isinstance(value, list) else str(now).strip("'") if isinstance(value, str) else now) == value,
                  f"{name}: {key} is {now}, was {value}")
        view.ViewSize = SIZE
        check((shot(view, f"{name}-{file}") == picture).all(), f"{name}: {file} looks as it did")
    simple.ResetSession()


def recorded():
    pictures, trace = record()
    for key in (*IMAGE, *MESH):
        check(f".{key} = " in trace, f"the trace has {key}")
    for key in "StratusReason", "StratusSamplesTaken", "StratusCastTime", "StratusCellsReason", "StratusCellsSegments", "StratusCloudUsed":
        check(f".{key} = " not in trace, f"the trace sets {key}, which only reports on pictures")
    script = smstate.get_state()
    state = os.path.join(folder, "session.pvsm")
    simple.SaveState(state)
    for name, text in ("trace.py", trace), ("state.py", script):
        open(os.path.join(folder, name), "w", encoding="utf-8").write(text)
    simple.ResetSession()
    for name, text in ("trace", trace), ("state", script):
        exec(compile(text, name, "exec"), {})
        again(name, pictures)
    simple.LoadState(state)
    again("pvsm", pictures)


def waves(view, most):
    source = simple.Wavelet(Maximum=most)
    shown = simple.Show(source, view)
    simple.ColorBy(shown, ("POINTS", "RTData"))
    shown.SetRepresentationType("Stratus Volume")
    shown.StratusUnitDistance = 5
    simple.GetColorTransferFunction("RTData").RGBPoints = [37, 0, 0, 1, 277, 1, 0, 0]
    simple.GetOpacityTransferFunction("RTData").Points = [37, 0, 0.5, 0, 277, 0.5, 0.5, 0]
    return source


def side_by_side():
    """A comparative view of two values of a source shows what two views do, of which one is linked to the other's camera."""
    values = 255.0, 150.0
    plain = {"UseColorPaletteForBackground": 0, "Background": [0, 0, 0], "OrientationAxesVisibility": 0}
    views = [make_view(*SIZE), make_view(*SIZE)]
    for view, value in zip(views, values):
        waves(view, value)
    simple.AddCameraLink(*views, "both")
    views[0].CameraPosition, views[0].CameraFocalPoint = [30, 20, 50], [0, 0, 0]
    simple.Render(views[0])
    check(list(views[1].CameraPosition) == [30, 20, 50], f"the linked camera is at {views[1].CameraPosition}")
    singles = [shot(view, f"single-{number}").reshape(*SIZE[::-1], 3) for number, view in enumerate(views)]
    view = simple.CreateView("ComparativeRenderView")
    view.Dimensions, view.Spacing, view.ViewSize = [2, 1], [0, 0], [2 * SIZE[0], SIZE[1]]
    for key, value in plain.items():
        setattr(view, key, value)
    source = waves(view, values[0])
    root = _getPyProxy(view.SMProxy.GetRootView())
    root.CameraPosition, root.CameraFocalPoint = [30, 20, 50], [0, 0, 0]
    cue = _getPyProxy(simple.servermanager.ProxyManager().NewProxy("animation", "ComparativeAnimationCue"))
    cue.AnimatedProxy, cue.AnimatedPropertyName, cue.AnimatedElement = source, "Maximum", 0
    cue.SMProxy.UpdateXRange(0, *values)
    cue.UpdateVTKObjects()
    view.Cues = [cue]
    both = shot(view, "compared").reshape(SIZE[1], 2 * SIZE[0], 3)
    check(abs(singles[0] - singles[1]).max() > 0.05 and singles[0].max() > 0.2, "both values show, and differ")
    for half, single in (both[:, :SIZE[0]], singles[0]), (both[:, SIZE[0]:], singles[1]):
        check(abs(half - single).max() < 1.5 / 255, f"a comparative view differs from a single one by {abs(half - single).max() * 255:.0f} of 255")


load()
levels, hills, cells, parts = write_all(folder)
beside_volume(os.path.join(folder, "even.vti"))
for path, representation in (levels, None), (parts, "UniformGridRepresentation"), (cells, None):
    picks(path, representation)
recorded()
side_by_side()
leave()
