# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: AMR looks as `stratus render` draws it, cut by a slice and a crop too, and a state file brings it back.
pvbatch test_refined.py PLUGIN STRATUS COMPARE-PICTURES FOLDER, in the repository's root."""
import os
import sys

from paraview import simple
from paraview.vtk import vtkIOXML, vtkCommonDataModel

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, draw, folder, leave, load, shot
from grids import COLORS, OPACITY, refined, write

MATERIAL = {"Ambient": 0.1, "Diffuse": 0.9, "Specular": 0}  # of `stratus render`

load()
path = write(refined(), vtkIOXML.vtkXMLUniformGridAMRWriter(), folder, "refined.vthb")
_, shown, view, *_ = draw(path, "hill", OPACITY, COLORS, 1.0, 55, of="CELLS")
check(shown.StratusSamplesTaken > 1e4 and shown.StratusReason and shown.StratusDeviceUsed, f"the panel reports the picture: {shown.StratusReason}")
check({"StratusShade", "StratusProjection", "StratusNormals"} <= set(shown.ListProperties()), "light and projections are offered")
before = shot(view, "refined-before")
draw(path, "hill", OPACITY, COLORS, 1.0, 53, of="CELLS", settings={"StratusBlendMode": "Slice",
     "StratusSliceFunction": {"Origin": [121, 3, 16], "Normal": [1, 0.5, 0.3]}}, options=("--mode", "slice", "--slice", "121,3,16,1,0.5,0.3"))
draw(path, "hill", OPACITY, COLORS, 1.0, 55, of="CELLS", settings={"StratusCropping": 1, "StratusCroppingScale": [1, 1, 0.5]},
     options=("--crop", "100,140,-20,25,2.5,15.5"))
draw(path, "hill", OPACITY, COLORS, 1.0, 50, of="CELLS", settings={"StratusShade": 1, **MATERIAL}, options=("--shade",), headlight=True)
draw(path, "hill", OPACITY, COLORS, 1.0, 50, of="CELLS", settings={"StratusProjection": "Maximum Intensity"}, options=("--mode", "maximum"))

state = os.path.join(folder, "refined.pvsm")
simple.SetActiveView(view)
simple.SaveState(state)
simple.ResetSession()
simple.LoadState(state)
again = shot(simple.GetRenderViews()[0], "refined-again")
check(before.shape == again.shape and abs(before - again).max() == 0, "a state file brings the picture back")
leave()
