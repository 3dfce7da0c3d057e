# SPDX-License-Identifier: BSD-3-Clause
"""Measures one scene for `stratus-bench paraview`, which explains the rows:
mpiexec -n RANKS pvbatch --sym measure.py PLUGIN|- SCENE.json ROWS PICTURES SIZE REPEATS CUTS. CUTS: 0, or one rank draws the pieces of an
image that is cut into so many along each axis, one after the other, in place of everything else."""
import json
import math
import os
import statistics
import sys
import time

import numpy
from paraview import simple
from paraview.vtk import vtkCommonCore, vtkIOImage, vtkParallelCore
from paraview.vtk.util.numpy_support import vtk_to_numpy

plugin, path, rows_path, pictures, size, repeats, cuts = sys.argv[1:5] + [int(word) for word in sys.argv[5:8]]
scene = json.load(open(path, encoding="utf-8"))
name = os.path.splitext(os.path.basename(path))[0]
controller = vtkParallelCore.vtkMultiProcessController.GetGlobalController()
ranks, rank = controller.GetNumberOfProcesses(), controller.GetLocalProcessId()
cells = scene["path"].endswith(".vtu")
VIEWS = 8
rows = []


def add(method, metric, value, unit):
    rows.append(f"{method}@{ranks},{metric},{value:.9g},{unit}")


def of_all_ranks(value):
    """A number of each rank, the same list on all of them."""
    mine, all_ = vtkCommonCore.vtkDoubleArray(), vtkCommonCore.vtkDoubleArray()
    mine.InsertNextValue(value)
    all_.SetNumberOfTuples(ranks)
    controller.AllGather(mine, all_)
    return list(vtk_to_numpy(all_))


def timed(what):
    """Wall time on this rank, and processor time of each rank, in ms. All ranks start together; rank 0 ends with the picture."""
    controller.Barrier()
    spent, start = time.process_time(), time.perf_counter()
    what()
    view.GetRenderWindow().WaitForCompletion()
    wall = 1000 * (time.perf_counter() - start)
    controller.Barrier()
    return wall, of_all_ranks(1000 * (time.process_time() - spent))


def draw():
    simple.Render(view)


def place_camera(number):
    """A view of record (README of the scenes): `stratus_scene_camera`."""
    up, bounds = scene["up"], scene["bounds"]
    focal = [(bounds[2 * a] + bounds[2 * a + 1]) / 2 for a in range(3)]
    radius = math.sqrt(sum((bounds[2 * a + 1] - bounds[2 * a]) ** 2 for a in range(3))) / 2
    elevation, azimuth = math.radians(25), math.radians(30 + 45 * number)
    direction = [0, 0, 0]
    direction[up] = math.sin(elevation)
    direction[(up + 1) % 3] = math.cos(elevation) * math.cos(azimuth)
    direction[(up + 2) % 3] = math.cos(elevation) * math.sin(azimuth)
    view.CameraFocalPoint = focal
    view.CameraPosition = [focal[a] + radius / math.sin(math.radians(15)) * direction[a] for a in range(3)]
    view.CameraViewUp = [1 if a == up else 0 for a in range(3)]
    view.CameraViewAngle = 21.6


def pixels(file):
    reader = vtkIOImage.vtkPNGReader()
    reader.SetFileName(file)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


def samples_taken(shown):
    """Of this rank, in the last picture."""
    shown.SMProxy.UpdatePropertyInformation()
    return shown.StratusCellsSegments if cells else shown.StratusSamplesTaken


def orbit(method, shown=None):
    """Times of all views; pictures and samples, too, where something is shown."""
    frames, spent, of_ranks, samples, differences = [], [], [], [], []
    for number in range(VIEWS):
        place_camera(number)
        draw()  # changes by the camera itself (clipping range, peeling) are in each repeat anyway
        several = [timed(draw) for _ in range(repeats)]
        frames.append(statistics.median(wall for wall, _ in several))
        spent.append(statistics.median(sum(cpu) for _, cpu in several))
        of_ranks.append([statistics.median(cpu[r] for _, cpu in several) for r in range(ranks)])
        if not shown:
            continue
        if method == "stratus":
            samples.append(of_all_ranks(samples_taken(shown)))
        file = os.path.join(pictures, f"{name}-{method.split(':')[-1]}-%d-{number}.png")
        simple.SaveScreenshot(file % ranks, view, ImageResolution=[size, size], TransparentBackground=0)
        if rank == 0 and ranks > 1 and os.path.exists(file % 1):
            differences.append(abs(pixels(file % ranks) - pixels(file % 1)).max())
    add(method, "frame_ms", statistics.median(frames), "ms")
    for number, ms in enumerate(frames):
        add(method, f"frame_ms/{number}", ms, "ms")
    add(method, "frame_cpu_ms", statistics.median(spent), "ms")
    add(method, "most_rank_cpu_ms", statistics.median(max(view_) for view_ in of_ranks), "ms")
    for r in range(ranks):
        add(method, f"rank_cpu_ms/{r}", statistics.median(view_[r] for view_ in of_ranks), "ms")
    if samples:
        add(method, "samples", statistics.median(sum(view_) for view_ in samples), "1")
        add(method, "most_rank_samples", statistics.median(max(view_) for view_ in samples), "1")
        for r in range(ranks):
            add(method, f"rank_samples/{r}", statistics.median(view_[r] for view_ in samples), "1")
    if differences:
        add(method, "rank_difference255", max(differences), "1")


def edit(method, fade):
    """From a change of the opacity to the next picture."""
    walls, spent = [], []
    for number in range(VIEWS):
        place_camera(number)
        draw()

        def change():
            fade.Points = points_of(scene["edited"] if number % 2 == 0 else scene["opacity"])
            draw()

        wall, cpu = timed(change)
        walls.append(wall)
        spent.append(sum(cpu))
    add(method, "edit_ms", statistics.median(walls), "ms")
    add(method, "edit_cpu_ms", statistics.median(spent), "ms")


def points_of(pairs):
    return [number for value, alpha in zip(pairs[::2], pairs[1::2]) for number in (value, alpha, 0.5, 0.0)]


def run(method, representation):
    reader = simple.XMLUnstructuredGridReader(FileName=[scene["path"]]) if cells else simple.XMLImageDataReader(FileName=[scene["path"]])
    reader.UpdatePipeline()
    shown = simple.Show(reader, view, "UnstructuredGridRepresentation" if cells else "UniformGridRepresentation")
    shown.SetRepresentationType("Outline")  # so that the view's own first work counts for no method
    simple.ColorBy(shown, ("POINTS", scene["array"]))
    look, fade = simple.GetColorTransferFunction(scene["array"]), simple.GetOpacityTransferFunction(scene["array"])
    look.ColorSpace, look.UseLogScale = "RGB", 0
    look.RGBPoints = scene["color"]
    fade.Points = points_of(scene["opacity"])
    shown.SetScalarBarVisibility(view, False)
    shown.ScalarOpacityUnitDistance = scene["unit"][0]
    place_camera(0)
    draw()

    def choose():
        shown.SetRepresentationType(representation)
        draw()

    wall, cpu = timed(choose)
    if shown.Representation != representation:
        raise SystemExit(f"'{representation}' is not there: is the plugin loaded?")
    add(method, "first_ms", wall, "ms")
    add(method, "first_cpu_ms", sum(cpu), "ms")
    orbit(method, shown)
    edit(method, fade)
    shown.Visibility = 0
    if method == "stratus":
        orbit("paraview:empty")
    simple.Delete(shown)
    simple.Delete(reader)


def rectangle():
    """Returns the number of pixels of the smallest rectangle with all visible pixels, which a rank sends."""
    file = os.path.join(pictures, f"{name}-piece.png")
    simple.SaveScreenshot(file, view, ImageResolution=[size, size], TransparentBackground=0)
    lit = pixels(file).max(axis=1).reshape(size, size) > 0
    rows_, columns = lit.any(axis=1).nonzero()[0], lit.any(axis=0).nonzero()[0]
    return 0 if not len(rows_) else int((rows_[-1] - rows_[0] + 1) * (columns[-1] - columns[0] + 1))


def run_pieces():
    """Draws each piece by itself, by a step of one voxel, so that samples can be added up."""
    reader = simple.XMLImageDataReader(FileName=[scene["path"]])
    reader.UpdatePipeline()
    last = [reader.GetDataInformation().GetExtent()[2 * a + 1] for a in range(3)]
    taken, sent, spent = [], [], []  # of the whole and then of each piece, by view
    places = [(i, j, k) for i in range(cuts) for j in range(cuts) for k in range(cuts)]
    for place in [None] + places:
        piece = reader
        if place:
            edges = [last[a] * (place[a] + end) // cuts for a in range(3) for end in (0, 1)]
            piece = simple.ExtractSubset(Input=reader, VOI=edges)
        shown = simple.Show(piece, view, "UniformGridRepresentation")
        simple.ColorBy(shown, ("POINTS", scene["array"]))
        simple.GetColorTransferFunction(scene["array"]).RGBPoints = scene["color"]
        simple.GetOpacityTransferFunction(scene["array"]).Points = points_of(scene["opacity"])
        shown.SetScalarBarVisibility(view, False)
        shown.SetRepresentationType("Stratus Volume")
        shown.ScalarOpacityUnitDistance = scene["unit"][0]
        shown.StratusSampling, shown.StratusSampleDistance = "Midpoint", scene["step"][0]
        views = []
        for number in range(VIEWS):
            place_camera(number)
            draw()
            _, cpu = timed(draw)
            views.append((samples_taken(shown), rectangle(), cpu[0]))
        for values, column in (taken, 0), (sent, 1), (spent, 2):
            values.append([view_[column] for view_ in views])
        simple.Delete(shown)
        if place:
            simple.Delete(piece)
    method = f"stratus:pieces-{len(places)}"
    for what, values, unit in ("samples", taken, "1"), ("pixels_sent", sent, "1"), ("cpu_ms", spent, "ms"):
        whole, pieces = numpy.array(values[0]), numpy.array(values[1:])
        rows.append(f"{method},whole_{what},{numpy.median(whole):.9g},{unit}")
        rows.append(f"{method},sum_{what},{numpy.median(pieces.sum(axis=0)):.9g},{unit}")
        rows.append(f"{method},most_{what},{numpy.median(pieces.max(axis=0)):.9g},{unit}")
    rows.append(f"{method},pieces_that_show,{numpy.median((numpy.array(sent[1:]) > 0).sum(axis=0)):.9g},1")


if plugin != "-":
    simple.LoadPlugin(plugin, ns=vars(simple))
simple._DisableFirstRenderCameraReset()
view = simple.CreateView("RenderView")
view.ViewSize = [size, size]
view.UseColorPaletteForBackground, view.Background = 0, [0, 0, 0]
view.OrientationAxesVisibility = view.UseFXAA = 0
if cuts:
    run_pieces()
else:
    run("stratus", "Stratus Volume")
    run("paraview:volume", "Volume")
if rank == 0:
    with open(rows_path, "w", encoding="utf-8") as out:
        out.write("\n".join(rows + ["end"]) + "\n")
