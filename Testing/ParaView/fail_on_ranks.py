# SPDX-License-Identifier: BSD-3-Clause
"""Rank 1 fails: pvbatch --sym fail_on_ranks.py PLUGIN FOLDER HOW [REPRESENTATION], by mpiexec. HOW: device (the rank sees no OpenCL
device), memory (it may take next to none), between (it is killed between two frames), during (within one), leave (it ends its script with
an error)."""
import os
import resource
import signal
import sys

from paraview import simple
from paraview.vtk import vtkIOImage
from paraview.vtk.util.numpy_support import vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from showing import make_view

plugin, folder, how = sys.argv[1:4]
representation = sys.argv[4] if len(sys.argv) > 4 else "Stratus Volume"
process = simple.servermanager.vtkProcessModule.GetProcessModule()
ranks, rank = process.GetNumberOfLocalPartitions(), process.GetPartitionId()
os.makedirs(folder, exist_ok=True)
simple.LoadPlugin(plugin, ns=vars(simple))
simple._DisableFirstRenderCameraReset()
view = make_view(400, 300)
waves = simple.Wavelet(WholeExtent=[-60, 60, -60, 60, -60, 60])
shown = simple.Show(waves, view, "UniformGridRepresentation")
simple.ColorBy(shown, ("POINTS", "RTData"))
# Ranks of a script would take the range of their own pieces each.
simple.GetColorTransferFunction("RTData").RGBPoints = [100, 0.2, 0.3, 0.8, 190, 0.9, 0.9, 0.9, 277, 0.7, 0, 0.2]
simple.GetOpacityTransferFunction("RTData").Points = [100, 0, 0.5, 0, 277, 0.1, 0.5, 0]
view.CameraPosition, view.CameraFocalPoint = [200, 150, 250], [0, 0, 0]
shown.SetRepresentationType("Outline" if how == "memory" else representation)


def picture(path):
    reader = vtkIOImage.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


def frame(name):
    simple.SaveScreenshot(os.path.join(folder, f"fail-{name}.png"), view, ImageResolution=[400, 300])
    if rank == 0:
        print(f"frame {name} is drawn", flush=True)


frame("first")
if how == "memory" and rank == 1:
    pages = int(open("/proc/self/statm").read().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + (int(os.environ.get('MORE_MB', 4)) << 20),) * 2)
elif how == "between" and rank == 1:
    os.kill(os.getpid(), signal.SIGKILL)
elif how == "during" and rank == 1:
    signal.setitimer(signal.ITIMER_REAL, 0.02)
elif how == "leave" and rank == 1:
    raise SystemExit("rank 1 leaves")
if how == "memory":
    shown.SetRepresentationType(representation)
elif how == "device":
    shown.StratusDevice = "0"
else:
    simple.GetOpacityTransferFunction("RTData").Points = [100, 0, 0.5, 0, 277, 0.3, 0.5, 0]
    waves.WholeExtent = [-100, 100, -100, 100, -100, 100]
frame("second")
if how == "device" and rank == 0:  # ranks of several devices draw what one draws
    first, second = (picture(os.path.join(folder, f"fail-{name}.png")) for name in ("first", "second"))
    print(f"differs by {abs(first - second).max()} of 255 in {(first.max(axis=1) > 8).sum()} lit pixels", flush=True)
