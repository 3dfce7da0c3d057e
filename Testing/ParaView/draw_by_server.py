# SPDX-License-Identifier: BSD-3-Clause
"""pvpython draw_by_server.py PORT FOLDER: a client of pvserver, of which every process has loaded the plugin by itself. Pictures are
FOLDER/NAME-RANKS.png; those of more ranks than one may differ from those of one by 1 of 255."""
import os
import sys

from paraview import simple
from paraview.vtk import vtkIOImage
from paraview.vtk.util.numpy_support import vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from showing import make_view

port, folder = sys.argv[1:3]
simple.Connect("localhost", int(port))
ranks = simple.servermanager.ActiveConnection.GetNumberOfDataPartitions()
failures = 0


def picture(name, count):
    reader = vtkIOImage.vtkPNGReader()
    reader.SetFileName(os.path.join(folder, f"{name}-{count}.png"))
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


view = make_view(400, 300)
view.RemoteRenderThreshold = 0  # the server draws
waves = simple.Wavelet(WholeExtent=[-30, 30, -30, 30, -30, 30])
cells = simple.Tetrahedralize(Input=simple.Wavelet(WholeExtent=[-10, 10, -10, 10, -10, 10]))
for name, source in ("image", waves), ("cells", cells):
    shown = simple.Show(source, view)
    simple.ColorBy(shown, ("POINTS", "RTData"))
    simple.GetOpacityTransferFunction("RTData").Points = [150, 0, 0.5, 0, 277, 0.1, 0.5, 0]
    shown.SetRepresentationType("Stratus Volume")
    if shown.Representation != "Stratus Volume":
        print(f"{name}: the plugin is not loaded, it is drawn as {shown.Representation}")
        failures += 1
    simple.ResetCamera(view)
    simple.SaveScreenshot(os.path.join(folder, f"{name}-{ranks}.png"), view, ImageResolution=[400, 300])
    simple.Hide(source, view)
    one, more = picture(name, 1), picture(name, ranks)
    lit, difference = (more.max(axis=1) > 8).sum(), abs(more - one).max()
    print(f"{name}: {ranks} ranks of a server differ from one by {difference} of 255; {lit} pixels are lit")
    failures += lit < 10000 or difference > 1
sys.stdout.flush()
os._exit(1 if failures else 0)
