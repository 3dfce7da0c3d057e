# SPDX-License-Identifier: BSD-3-Clause
"""Catalyst's script of plume-in-situ: each EVERY-th step becomes a picture, FOLDER/plume-NNNN.png. The environment has STRATUS_PLUGIN
(unless ParaView loads it by itself), STRATUS_FOLDER (default: where the program runs) and STRATUS_EVERY (default 1)."""
import os

from paraview import catalyst, simple

folder, every = os.environ.get("STRATUS_FOLDER", "."), int(os.environ.get("STRATUS_EVERY", "1"))
if "STRATUS_PLUGIN" in os.environ:
    simple.LoadPlugin(os.environ["STRATUS_PLUGIN"], ns=vars(simple))


def show(source):
    """A view of the source, the same for each number of ranks."""
    view = simple.CreateView("RenderView")
    view.ViewSize, view.UseFXAA, view.OrientationAxesVisibility = [400, 300], 0, 0
    view.UseColorPaletteForBackground, view.Background = 0, [0, 0, 0]
    shown = simple.Show(source, view, "UniformGridRepresentation")
    simple.ColorBy(shown, ("POINTS", "concentration"))
    look, fade = simple.GetColorTransferFunction("concentration"), simple.GetOpacityTransferFunction("concentration")
    look.ColorSpace, look.RGBPoints = "RGB", [0, 0.5, 0.5, 0.6, 1, 1, 0.95, 0.85]
    fade.Points = [0.01, 0, 0.5, 0, 1, 0.5, 0.5, 0]
    shown.SetScalarBarVisibility(view, False)
    shown.ScalarOpacityUnitDistance = 1
    shown.SetRepresentationType("Stratus Volume")
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [40, -90, 45], [48, 24, 22], [0, 0, 1]
    return view


if "STRATUS_RAW" not in os.environ:  # otherwise another script imports only show()
    options = catalyst.Options()
    plume = simple.TrivialProducer(registrationName="plume")
    simple._DisableFirstRenderCameraReset()
    view = show(plume)


def catalyst_execute(info):
    if info.cycle % every == 0:
        plume.UpdatePipeline(info.time)
        view.ViewTime = info.time
        picture = os.path.join(folder, f"plume-{info.cycle:04d}.png")
        simple.SaveScreenshot(picture, view, ImageResolution=[400, 300], TransparentBackground=0)
