# SPDX-License-Identifier: BSD-3-Clause
"""What test_window runs in the Python shell of ParaView's window: write_series() makes the data that the session opens, and look() keeps a
picture of the whole window and a line in looks.json with the active source's representation. The folder is STRATUS_WINDOW_FOLDER."""
import json
import os
import shutil
import subprocess
import traceback

import numpy
from paraview import simple, smtrace
from paraview.vtk import vtkIOXML
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import grids

folder = os.environ["STRATUS_WINDOW_FOLDER"]
looks = os.path.join(folder, "looks.json")


def write_series():
    """Two steps in time, the second one fainter."""
    image = grids.image()
    values = vtk_to_numpy(image.GetPointData().GetArray("hill"))
    for number, share in enumerate((1.0, 0.6)):
        array = numpy_to_vtk(numpy.ascontiguousarray(share * values), deep=True)
        array.SetName("hill")
        image.GetPointData().AddArray(array)
        grids.write(image, vtkIOXML.vtkXMLImageDataWriter(), folder, f"step{number}.vti")
    steps = "".join(f'<DataSet timestep="{number}" file="step{number}.vti"/>' for number in (0, 1))
    with open(os.path.join(folder, "steps.pvd"), "w", encoding="utf-8") as file:
        file.write(f'<VTKFile type="Collection" version="0.1"><Collection>{steps}</Collection></VTKFile>\n')


def look():
    number = 0
    if os.path.exists(looks):
        number = len(open(looks, encoding="utf-8").readlines())
    if shutil.which("import"):
        subprocess.run(["import", "-window", "root", os.path.join(folder, f"window-{number}.png")], check=False)
    view = simple.GetActiveView()
    source = simple.GetActiveSource() or next(iter(simple.GetSources().values()))  # a state that is loaded has no active one
    shown = simple.GetDisplayProperties(source, view)
    seen = {"representation": shown.Representation, "array": shown.ColorArrayName[1], "camera": list(view.CameraPosition),
            "opacity": list(shown.ScalarOpacityFunction.Points), "unit": shown.ScalarOpacityUnitDistance,
            "samples": shown.StratusSamplesTaken,
            "reason": str(shown.StratusReason), "time": simple.GetAnimationScene().AnimationTime}
    with open(looks, "a", encoding="utf-8") as file:
        file.write(json.dumps(seen, default=str) + "\n")


def start_trace():
    global tracer
    tracer = smtrace.start_trace()


def stop_trace():
    """Writes trace.py, the window's trace since start_trace()."""
    with open(os.path.join(folder, "trace.py"), "w", encoding="utf-8") as file:
        file.write(smtrace.stop_trace())


def run(name):
    """A failure here would show only in the shell's panel."""
    try:
        {"look": look, "write_series": write_series, "start_trace": start_trace, "stop_trace": stop_trace}[name]()
    except Exception:
        with open(os.path.join(folder, "errors"), "a", encoding="utf-8") as file:
            traceback.print_exc(file=file)
