# SPDX-License-Identifier: BSD-3-Clause
"""Helpers of the plugin's tests: compares ParaView's picture of a scene with the picture of `stratus render`. Only rounding to bytes gives
58.9 dB if all levels are equally frequent. Scripts are given PLUGIN STRATUS COMPARE-PICTURES FOLDER, and run in the repository's root; pictures go to the folder."""
import os
import re
import subprocess
import sys

from paraview import simple
from paraview.vtk import vtkIOImage
from paraview.vtk.util.numpy_support import vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from showing import make_view, show_volume

plugin, stratus, compare, folder = sys.argv[1:5]
os.makedirs(folder, exist_ok=True)
failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def camera_of(output):
    """Returns the camera that `stratus render` prints."""
    number = r"([-+.e\d]+)"
    triple = " ".join(3 * [number])
    found = re.search(rf"camera +eye {triple}, forward {triple}, up {triple}, angle {number}", output)
    values = [float(group) for group in found.groups()]
    return values[0:3], values[3:6], values[6:9], values[9]


def look_like(view, output):
    eye, forward, up, angle = camera_of(output)
    view.CameraPosition = eye
    view.CameraFocalPoint = [e + 100 * f for e, f in zip(eye, forward)]
    view.CameraViewUp = up
    view.CameraViewAngle = angle
    view.CameraParallelProjection = 0


def draw(path, array, opacity, color, unit, least, width=500, height=400, component=None, judged=None, settings=None, options=(),
         judge=None, representation=None, headlight=False, of="POINTS"):
    """The same scene twice: `stratus render` in floats, ParaView in bytes. component: of a vector, by its name; `stratus render` then draws
    the array `judged`, which holds only that component, or the magnitude. settings: properties of the representation, which `options` are
    on the command line. judge: a file of the same data that `stratus render` draws. representation: where the reader's is another.
    headlight: in place of ParaView's kit of lights. of: POINTS or CELLS, which the array belongs to."""
    name = os.path.splitext(os.path.basename(path))[0] + (f"-{judged}" if judged else "")
    name += options[0][1:] + options[1][:5] if len(options) > 1 else "".join(options)[1:]
    floats, bytes_ = (os.path.join(folder, name + end) for end in (".exr", ".png"))
    command = [stratus, "render", judge or path, "--array", judged or array, "-o", floats, "--size", f"{width}x{height}", "--unit-distance", str(unit),
               "--opacity", ",".join(f"{v}:{a}" for v, a in opacity), "--color", ",".join(f"{v}:{r}:{g}:{b}" for v, r, g, b in color)]
    command += list(options)
    ran = subprocess.run(command, capture_output=True, text=True)
    check(ran.returncode == 0, ran.stderr)
    view = make_view(width, height)
    source, shown = show_volume(path, array, opacity, color, unit, view, representation, component, of)
    if headlight:
        view.UseLight = 0
        lamp = simple.AddLight(view=view)
        lamp.Coords, lamp.Type, lamp.Intensity, lamp.ConeAngle = "Camera", "Positional", 1, 180
        lamp.Position, lamp.FocalPoint = [0, 0, 1], [0, 0, 0]
    for key, value in (settings or {}).items():
        if isinstance(value, dict):  # of a proxy that is the property's value
            for inner, given in value.items():
                setattr(getattr(shown, key), inner, given)
        else:
            setattr(shown, key, value)
    look_like(view, ran.stdout)
    simple.SaveScreenshot(bytes_, view, ImageResolution=[width, height], TransparentBackground=0)
    verdict = subprocess.run([compare, bytes_, floats, str(least)], capture_output=True, text=True)
    print(f"{name}: ParaView compared with stratus render: {verdict.stdout.strip()}")
    check(verdict.returncode == 0, f"{name} looks in ParaView as it does from the command line")
    return source, shown, view, bytes_, floats


def shot(view, name):
    """What a view shows, in 0..1, rows from below."""
    path = os.path.join(folder, name + ".png")
    simple.SaveScreenshot(path, view, ImageResolution=view.ViewSize[:], TransparentBackground=0)
    reader = vtkIOImage.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, :3] / 255


def load():
    simple.LoadPlugin(plugin, ns=vars(simple))
    simple._DisableFirstRenderCameraReset()


def leave(whole=True):
    """Ends the script: pvbatch returns 0 whatever sys.exit is given. whole: no part was skipped."""
    sys.stdout.flush()
    os._exit(1 if failures else 0 if whole else 77)
