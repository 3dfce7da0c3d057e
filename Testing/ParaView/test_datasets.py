# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: each kind of data set looks as `stratus render` draws it: rectilinear, unstructured and structured grids, blocks
of composite data, vectors by magnitude and component, projections, light, a crop box, a solid colour; and the panel reports the last picture.
pvbatch test_datasets.py PLUGIN STRATUS COMPARE-PICTURES FOLDER, in the repository's root."""
import os
import sys

import numpy
from paraview import simple

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, draw, folder, leave, load, shot
from grids import COLORS, OPACITY, axes, write_all
from showing import make_view, show_volume

MATERIAL = {"Ambient": 0.1, "Diffuse": 0.9, "Specular": 0}  # of `stratus render`


def alike(a, b):
    """Each keeps the default tolerance, a root mean square of .001, and is rounded to bytes."""
    lit = numpy.maximum(a, b).max(axis=1) > 0
    return lit.sum() > 5000 and ((a - b)[lit] ** 2).mean() ** 0.5 < 2 * 0.001 + 2 * 0.5 / 255


def solid(path):
    """Without an array, the colour of surfaces at the opacity of the array that was chosen last; by a ramp where none ever was."""
    red, name = [0.9, 0.2, 0.1], os.path.splitext(os.path.basename(path))[0] + "-solid"
    view = make_view(300, 240)
    source, shown = show_volume(path, "hill", OPACITY, [(value, *red) for value in (0, 1.4)], 1.0, view)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [160, 50, 60], [120, 2, 17], [0, 0, 1]
    fade = simple.GetOpacityTransferFunction("hill")
    points = fade.Points[:]
    by_function = shot(view, name + "-function")
    shown.DiffuseColor = red
    simple.ColorBy(shown, None)
    without = shot(view, name)
    check(without.max() > 0.2 and alike(without, by_function), f"{name}: the opacity of the last array in one colour")
    shown.DiffuseColor = [0.1, 0.2, 0.9]
    check(shot(view, name + "-blue")[:, 0].max() < 0.2, f"{name}: another colour")
    simple.ColorBy(shown, ("POINTS", "hill"))
    fade.Points = points  # which ParaView fits to the data
    check(alike(shot(view, name + "-again"), by_function), f"{name}: the array's colours again")
    fade.Points = [0, 0, 0.5, 0, source.PointData["hill"].GetRange()[1], 1, 0.5, 0]
    ramp = shot(view, name + "-ramp")
    simple.Delete(shown)
    fresh = simple.Show(source, view)
    if fresh.ColorArrayName[1]:
        simple.ColorBy(fresh, None)
    fresh.SetRepresentationType("Stratus Volume")
    check(not fresh.ColorArrayName[1], f"{name}: no array is chosen")
    fresh.ScalarOpacityUnitDistance, fresh.DiffuseColor = 1, red
    never = shot(view, name + "-never")
    check(never.max() > 0.2 and alike(never, ramp), f"{name}: a ramp where no array was chosen yet")
    simple.Delete(view)


def statistics(shown, view):
    for method in "March", "Project":
        shown.StratusCellsMethod = method
        simple.Render(view)
        check(shown.StratusCellsMethodUsed == method.lower() and shown.StratusCellsReason and shown.StratusCellsDeviceUsed,
              f"method, reason and device of {method}: {shown.StratusCellsMethodUsed}, {shown.StratusCellsReason}, {shown.StratusCellsDeviceUsed}")
        check(shown.StratusCellsTetrahedra >= 5 * 39 * 35 * 29 and shown.StratusCellsLeftOut == 0, f"{shown.StratusCellsTetrahedra} tetrahedra")
        check(shown.StratusCellsSegments > 1e5 and shown.StratusCellsCastTime > 0, f"segments and time of {method}")


load()
levels, hills, cells, parts = write_all(folder)
draw(parts, "hill", OPACITY, COLORS, 1.0, 53, judge=levels, representation="UniformGridRepresentation")
for path in levels, hills, cells:
    _, shown, view, *_ = draw(path, "hill", OPACITY, COLORS, 1.0, 55)
    if path != levels:
        statistics(shown, view)
    solid(path)
    draw(path, "wind", OPACITY, COLORS, 1.0, 55, component="Magnitude", judged="wind_alone")
    draw(path, "wind", OPACITY, COLORS, 1.0, 55, component="Z", judged="wind_third")
    projection = "StratusProjection" if path == levels else "StratusCellsBlendMode"
    draw(path, "hill", OPACITY, COLORS, 1.0, 55, settings={projection: "Maximum Intensity"}, options=("--mode", "maximum"))
for path, shade in (levels, "StratusShade"), (hills, "StratusCellsShade"), (cells, "StratusCellsShade"):
    draw(path, "hill", OPACITY, COLORS, 1.0, 55, settings={shade: 1, **MATERIAL}, options=("--shade",), headlight=True)
for path in levels, parts:
    draw(path, "hill", OPACITY, COLORS, 1.0, 53, judge=levels, representation="UniformGridRepresentation",
         settings={"BlendMode": "Slice", "StratusSliceFunction": {"Origin": [121, 3, 16], "Normal": [1, 0.5, 0.3]}},
         options=("--mode", "slice", "--slice", "121,3,16,1,0.5,0.3"))
draw(levels, "hill", OPACITY, COLORS, 1.0, 55, settings={"UseCropping": 1, "CroppingScale": [1, 1, 0.5]},
     options=("--crop", ",".join(str(edge) for axis, scale in zip(axes(), (1, 1, 0.5)) for edge in (axis[0] * scale, axis[-1] * scale))))
leave()
