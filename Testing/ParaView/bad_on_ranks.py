# SPDX-License-Identifier: BSD-3-Clause
"""Pieces that don't go together, on several ranks: pvbatch --sym bad_on_ranks.py PLUGIN FOLDER, by mpiexec. Rank 0 writes
FOLDER/bad-pictures, a line a case: its name and how many pixels are lit. Messages go to the output."""
import os
import sys

import numpy
from paraview import simple
from paraview.vtk import vtkCommonDataModel, vtkFiltersCore, vtkIOImage
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from showing import make_view

plugin, folder = sys.argv[1:3]
process = simple.servermanager.vtkProcessModule.GetProcessModule()
ranks, rank = process.GetNumberOfLocalPartitions(), process.GetPartitionId()
os.makedirs(folder, exist_ok=True)
simple.LoadPlugin(plugin, ns=vars(simple))
simple._DisableFirstRenderCameraReset()
SIDE = 10  # of a rank's part along x, in cells


def array(name, values):
    made = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
    made.SetName(name)
    return made


def part(name="hill", first=None, last=None, ghosts=None, height=1):
    """This rank's part of an image: cells first..last-1 along x. name: of its array. ghosts: the length of its ghost array. height: along y,
    of SIDE cells."""
    first = rank * SIDE if first is None else first
    last = (rank + 1) * SIDE if last is None else last
    image = vtkCommonDataModel.vtkImageData()
    image.SetExtent(first, last, 0, int(height * SIDE), 0, SIDE)
    image.GetPointData().AddArray(array(name, numpy.linspace(0.5, 1, image.GetNumberOfPoints())))
    if ghosts is not None:
        image.GetCellData().AddArray(array("vtkGhostType", numpy.zeros(ghosts, numpy.uint8)))
    return image


def cells(image):
    join = vtkFiltersCore.vtkAppendFilter()
    join.AddInputData(image)
    join.Update()
    return join.GetOutput()


class Scene:
    """A view of the data that each rank hands in."""

    def __init__(self, data, representation):
        self.view = make_view(300, 200)
        self.source = simple.TrivialProducer()
        self.put(data)
        self.shown = simple.Show(self.source, self.view, representation)
        self.color("hill")
        self.shown.SetRepresentationType("Stratus Volume")
        self.shown.ScalarOpacityUnitDistance = 1
        self.view.CameraPosition, self.view.CameraFocalPoint = [15, 5, 70], [15, 5, 5]

    def color(self, name):
        simple.ColorBy(self.shown, ("POINTS", name))
        look, fade = simple.GetColorTransferFunction(name), simple.GetOpacityTransferFunction(name)
        look.RGBPoints, fade.Points = [0, 1, 1, 1, 1, 1, 1, 1], [0, 0.2, 0.5, 0, 1, 0.2, 0.5, 0]

    def put(self, data):
        producer = self.source.GetClientSideObject()
        producer.SetOutput(data)
        if data.IsA("vtkImageData"):
            producer.SetWholeExtent(0, ranks * SIDE, 0, SIDE, 0, SIDE)
        self.source.MarkModified(None)

    def lit(self, name):
        path = os.path.join(folder, f"bad-{name}.png")
        simple.SaveScreenshot(path, self.view, ImageResolution=[300, 200], TransparentBackground=0)
        if rank > 0:
            return 0
        reader = vtkIOImage.vtkPNGReader()
        reader.SetFileName(path)
        reader.Update()
        return int((vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).max(axis=1) > 8).sum())


def say(words):
    if rank == 0:
        print(words, file=sys.stderr, flush=True)  # where VTK's messages go, so that their order is kept


other = "hill" if rank != 1 else "dale"  # rank 1 lacks the array
CASES = [("right", lambda: part(), "image"), ("all-lack", lambda: part("dale", height=0.5), "image"), ("lacks", lambda: part(other), "image"),
         ("cut-ghosts", lambda: part(ghosts=7 if rank == 1 else SIDE**3), "image"),
         ("overlap", lambda: part(last=(rank + 1) * SIDE + (3 if rank == 0 else 0)), "image"),
         ("gap", lambda: part(last=(rank + 1) * SIDE - (3 if rank == 1 else 0)), "image"),
         ("cells-right", lambda: cells(part()), "cells"), ("cells-all-lack", lambda: cells(part("dale", height=0.5)), "cells"), ("cells-lack", lambda: cells(part(other)), "cells"),
         ("cells-cut-ghosts", lambda: cells(part(ghosts=7 if rank == 1 else SIDE**3)), "cells")]
lines = []
for name, make, kind in CASES:
    say(f"case {name}")
    if kind == "cells" and name == "cells-right":
        scene = Scene(make(), "UnstructuredGridRepresentation")
    elif kind == "image" and name == "right":
        scene = Scene(make(), "UniformGridRepresentation")
    else:
        scene.put(make())
    lines.append(f"{name} {scene.lit(name)}")
    scene.lit(name)  # a message is not repeated
    if name.endswith("all-lack"):  # the array that they have can be chosen
        say(f"case {name}-chosen")
        scene.color("dale")
        lines.append(f"{name}-chosen {scene.lit(name + '-chosen')}")
        scene.shown.ColorArrayName = ["POINTS", "hill"]
say("case cells-maximum")
scene.put(cells(part()))
scene.shown.StratusCellsBlendMode = "Maximum Intensity"
lines.append(f"cells-maximum {scene.lit('cells-maximum')}")
say("case cells-again")
scene.shown.StratusCellsBlendMode = "Composite"
lines.append(f"cells-again {scene.lit('cells-again')}")
say("case end")

# Leaves and cells have numbers among all ranks; rank 1 has no cells.
source = simple.TrivialProducer()
source.GetClientSideObject().SetOutput(vtkCommonDataModel.vtkUnstructuredGrid() if rank == 1 else cells(part()))
parts = simple.StratusPartition(Input=source, LeafCells=100)
parts.UpdatePipeline()
data = parts.GetClientSideObject().GetOutputDataObject(0).GetCellData()
with open(os.path.join(folder, f"numbers-{rank}"), "w") as file:
    for name in "StratusGlobalLeaf", "StratusGlobalOriginalCell":
        numbers = numpy.unique(vtk_to_numpy(data.GetArray(name))) if data.HasArray(name) else []
        print(name, *([numbers[0], numbers[-1], len(numbers)] if len(numbers) else "---"), file=file)
if rank == 0:
    open(os.path.join(folder, "bad-pictures"), "w").write("\n".join(lines) + "\n")
