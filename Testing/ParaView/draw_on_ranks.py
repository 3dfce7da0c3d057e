# SPDX-License-Identifier: BSD-3-Clause
"""Draws each kind of data set on so many ranks: pvbatch --sym draw_on_ranks.py PLUGIN FOLDER, by mpiexec. Pictures are FOLDER/NAME-RANKS.png.
One rank writes the data; more find it there. The largest differences to one rank's pictures are in FOLDER/differences-RANKS."""
import os
import sys

from paraview import simple
from paraview.vtk import vtkIOImage
from paraview.vtk.util.numpy_support import vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from grids import COLORS, OPACITY, write_all

READERS = {".vtr": ("XMLRectilinearGridReader", "UniformGridRepresentation"), ".vts": ("XMLStructuredGridReader", "StructuredGridRepresentation"),
           ".vtu": ("XMLUnstructuredGridReader", "UnstructuredGridRepresentation")}
plugin, folder = sys.argv[1:3]
process = simple.servermanager.vtkProcessModule.GetProcessModule()
ranks, rank = process.GetNumberOfLocalPartitions(), process.GetPartitionId()
os.makedirs(folder, exist_ok=True)
if ranks == 1:
    write_all(folder)


def picture(name, count):
    reader = vtkIOImage.vtkPNGReader()
    reader.SetFileName(os.path.join(folder, f"{name}-{count}.png"))
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


simple.LoadPlugin(plugin, ns=vars(simple))
simple._DisableFirstRenderCameraReset()
differences = []
for name in "levels.vtr", "hills.vts", "cells.vtu":
    reader, representation = READERS[os.path.splitext(name)[1]]
    source = getattr(simple, reader)(FileName=[os.path.join(folder, name)])
    source.UpdatePipeline()
    view = simple.CreateView("RenderView")
    view.ViewSize, view.UseFXAA, view.OrientationAxesVisibility = [500, 400], 0, 0
    view.UseColorPaletteForBackground, view.Background = 0, [0, 0, 0]
    shown = simple.Show(source, view, representation)
    simple.ColorBy(shown, ("POINTS", "hill"))
    look, fade = simple.GetColorTransferFunction("hill"), simple.GetOpacityTransferFunction("hill")
    look.ColorSpace, look.RGBPoints = "RGB", [number for point in COLORS for number in point]
    fade.Points = [number for value, alpha in OPACITY for number in (value, alpha, 0.5, 0.0)]
    shown.SetRepresentationType("Stratus Volume")
    shown.ScalarOpacityUnitDistance = 1
    shown.SetScalarBarVisibility(view, False)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [160, 50, 60], [120, 2, 17], [0, 0, 1]
    simple.SaveScreenshot(os.path.join(folder, f"{name}-{ranks}.png"), view, ImageResolution=[500, 400], TransparentBackground=0)
    if rank == 0 and ranks > 1:
        one = picture(name, 1)
        if (one.max(axis=1) > 30).sum() < 20000:
            raise SystemExit(f"{name} does not show on one rank")
        differences.append(f"{name} {abs(picture(name, ranks) - one).max()}")
if rank == 0 and ranks > 1:
    open(os.path.join(folder, f"differences-{ranks}"), "w").write("\n".join(differences) + "\n")
