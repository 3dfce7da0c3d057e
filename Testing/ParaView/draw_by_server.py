# SPDX-License-Identifier: BSD-3-Clause
"""pvpython draw_by_server.py PORT FOLDER: draws by itself, and then as a client of pvserver; every process has loaded the plugin by itself.
Pictures are FOLDER/NAME-client.png and FOLDER/NAME-server.png; the server's ranks may differ from the one by 1 of 255."""
import os
import sys

from paraview import simple
from paraview.vtk import vtkIOImage
from paraview.vtk.util.numpy_support import vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from showing import make_view

port, folder = sys.argv[1:3]
failures = 0


def draw(where):
    """The pictures of both scenes."""
    global failures
    view = make_view(400, 300)
    view.RemoteRenderThreshold = 0  # the server draws, where there is one
    waves = simple.Wavelet(WholeExtent=[-30, 30, -30, 30, -30, 30])
    cells = simple.Tetrahedralize(Input=simple.Wavelet(WholeExtent=[-10, 10, -10, 10, -10, 10]))
    pictures = {}
    for name, source in ("image", waves), ("cells", cells):
        shown = simple.Show(source, view)
        simple.ColorBy(shown, ("POINTS", "RTData"))
        simple.GetOpacityTransferFunction("RTData").Points = [150, 0, 0.5, 0, 277, 0.1, 0.5, 0]
        shown.SetRepresentationType("Stratus Volume")
        if shown.Representation != "Stratus Volume":
            print(f"{name}, {where}: the plugin is not loaded, it is drawn as {shown.Representation}")
            failures += 1
        simple.ResetCamera(view)
        path = os.path.join(folder, f"{name}-{where}.png")
        simple.SaveScreenshot(path, view, ImageResolution=[400, 300])
        simple.Hide(source, view)
        reader = vtkIOImage.vtkPNGReader()
        reader.SetFileName(path)
        reader.Update()
        pictures[name] = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)
    return pictures


one = draw("client")
simple.Connect("127.0.0.1", int(port))
ranks = simple.servermanager.ActiveConnection.GetNumberOfDataPartitions()
more = draw("server")
for name, picture in more.items():
    lit, difference = (picture.max(axis=1) > 8).sum(), abs(picture - one[name]).max()
    print(f"{name}: {ranks} ranks of a server differ from one by {difference} of 255; {lit} pixels are lit")
    failures += lit < 10000 or difference > 1 or ranks != 2
sys.stdout.flush()
os._exit(1 if failures else 0)
