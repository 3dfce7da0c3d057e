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
from showing import make_view, show_volume

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
    view = make_view(500, 400)
    show_volume(os.path.join(folder, name), "hill", OPACITY, COLORS, 1, view)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [160, 50, 60], [120, 2, 17], [0, 0, 1]
    simple.SaveScreenshot(os.path.join(folder, f"{name}-{ranks}.png"), view, ImageResolution=[500, 400], TransparentBackground=0)
    if rank == 0 and ranks > 1:
        one = picture(name, 1)
        if (one.max(axis=1) > 30).sum() < 20000:
            raise SystemExit(f"{name} does not show on one rank")
        differences.append(f"{name} {abs(picture(name, ranks) - one).max()}")
if rank == 0 and ranks > 1:
    open(os.path.join(folder, f"differences-{ranks}"), "w").write("\n".join(differences) + "\n")
