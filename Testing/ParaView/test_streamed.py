# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: a large file whose values stay in it, drawn where ParaView streams: a coarse picture at once, and the exact one
when the client asks for the next part. pvbatch test_streamed.py PLUGIN STRATUS COMPARE-PICTURES FOLDER"""
import os
import sys

import numpy
from paraview import simple
from paraview.modules.vtkRemotingViews import vtkPVView
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, folder, leave, load
from showing import make_view

SIZE = 420, 410, 400  # more than 2^26 values, of which a coarse copy is kept
PATH = os.path.join(folder, "large.nhdr")


def write():
    x, y, z = (numpy.linspace(-1, 1, count) ** 2 for count in SIZE)
    ball = numpy.maximum(0, 255 * (1 - 2 * (x[None, None] + y[None, :, None] + z[:, None, None]))).astype("u1")
    ball.tofile(PATH.replace(".nhdr", ".raw"))
    with open(PATH, "w") as header:
        header.write(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {' '.join(map(str, SIZE))}\nencoding: raw\ndata file: large.raw\n")


class Scene:
    def __init__(self):
        self.view = make_view(160, 120)
        self.source = simple.StratusImageReader(FileName=PATH, MemoryLimit=32)
        self.shown = simple.Show(self.source, self.view, "UniformGridRepresentation")
        simple.ColorBy(self.shown, ("POINTS", "ImageFile"))
        look, fade = simple.GetColorTransferFunction("ImageFile"), simple.GetOpacityTransferFunction("ImageFile")
        look.RGBPoints = [0, 0.1, 0.3, 0.9, 255, 0.9, 0.4, 0.1]
        fade.Points = [60, 0, 0.5, 0, 250, 0.9, 0.5, 0]
        self.shown.SetRepresentationType("Stratus Volume")
        self.shown.ScalarOpacityUnitDistance = 20
        self.shown.SetScalarBarVisibility(self.view, False)
        self.view.CameraFocalPoint, self.view.CameraPosition = [210, 205, 200], [1000, 700, 1100]

    def look(self):
        """What the view shows now."""
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.view.GetRenderWindow()), grab.ReadFrontBufferOff(), grab.ShouldRerenderOff(), grab.Update()
        return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(int)

    def draw(self):
        simple.Render(self.view)
        return self.look()

    def ask(self):
        """What ParaView's window does from time to time. Returns whether there may be more."""
        return self.view.SMProxy.StreamingUpdate(True)

    def close(self):
        simple.Delete(self.shown), simple.Delete(self.source), simple.Delete(self.view)


def error(picture, exact):
    return numpy.sqrt(numpy.mean((picture - exact) ** 2.0))


os.environ["STRATUS_CACHE_DIR"] = os.path.join(os.path.abspath(folder), "cache")
load()
write()
scene = Scene()
exact = scene.draw()
check(exact.max() > 30, "the ball shows")
check(not scene.ask(), "a picture that nobody asks for again is exact")
scene.close()
vtkPVView.SetEnableStreaming(True)
scene = Scene()
first = scene.draw()
check(0 < error(first, exact) < 6, f"the first picture is a coarse one ({error(first, exact):.2f} of 255)")
check(scene.ask(), "ParaView is told to draw again")
check((scene.look() == exact).all(), f"then the picture is exact, to the bit ({error(scene.look(), exact):.2f} of 255)")
check(not scene.ask() and (scene.look() == exact).all(), "and is the last")
scene.view.CameraPosition = [-1000, 700, 1100]
for _ in range(3):
    turned = scene.draw()
    while scene.ask():
        turned = scene.look()
vtkPVView.SetEnableStreaming(False)
scene.source.UpdatePipeline(), scene.shown.UpdatePipeline()
check((scene.draw() == turned).all(), "after a turn the last picture is exact, too")
leave()
