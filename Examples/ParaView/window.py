# SPDX-License-Identifier: BSD-3-Clause
# ParaView's window with the hurricane drawn by the plugin: paraview --script=window.py, where STRATUS_PLUGIN and STRATUS_DATA name
# Stratus.so and a .vti. If STRATUS_READY names a file, it is written when everything is drawn.
import os
from paraview import simple

simple.LoadPlugin(os.environ["STRATUS_PLUGIN"], ns=vars(simple))
data = simple.XMLImageDataReader(registrationName=os.path.basename(os.environ["STRATUS_DATA"]), FileName=[os.environ["STRATUS_DATA"]])
data.UpdatePipeline()
name = data.PointData[0].GetName()
low, high = data.PointData[0].GetRange()
view = simple.GetActiveViewOrCreate("RenderView")
shown = simple.Show(data, view, "UniformGridRepresentation")
simple.ColorBy(shown, ("POINTS", name))
shown.SetRepresentationType("Stratus Volume")
fade, look = simple.GetOpacityTransferFunction(name), simple.GetColorTransferFunction(name)
at = lambda t: low + t * (high - low)
fade.Points = [at(0.2), 0, 0.5, 0, at(0.4), 0.07, 0.5, 0, at(1), 0.6, 0.5, 0]
look.ColorSpace = "RGB"
look.RGBPoints = [at(0), 0.1, 0.2, 0.5, at(0.35), 0.3, 0.7, 0.8, at(0.6), 0.95, 0.9, 0.6, at(1), 0.85, 0.2, 0.1]
shown.ScalarOpacityUnitDistance = 4
shown.SetScalarBarVisibility(view, True)
simple.SetActiveSource(data)
simple.ResetCamera()
camera = simple.GetActiveCamera()
camera.SetFocalPoint(248, 248, 40), camera.SetPosition(380, -350, 800), camera.SetViewUp(0, 0, 1)
simple.ResetCamera()
camera.Zoom(1.35)
simple.Render()
if "STRATUS_READY" in os.environ:
    open(os.environ["STRATUS_READY"], "w").close()
