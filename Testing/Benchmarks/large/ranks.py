# SPDX-License-Identifier: BSD-3-Clause
"""A large file of bytes on ranks of ParaView, whose values stay in it: time from opening the file to its picture, and each rank's memory.

mpiexec -n RANKS pvbatch --sym ranks.py PLUGIN FILE.nhdr MIB PICTURE.png

FILE.nhdr describes a file of large.py; MIB limits the values in memory of each rank. Prints seconds and the most resident bytes, a line for
each rank. Value ranges are kept in STRATUS_CACHE_DIR: a second run is a later picture. Pictures of any number of ranks should be the same."""
import os
import resource
import sys
import time

from paraview import simple

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "ParaView"))
from showing import make_view

plugin, path, limit, picture = sys.argv[1:5]
process = simple.servermanager.vtkProcessModule.GetProcessModule()
simple.LoadPlugin(plugin, ns=vars(simple))
begin = time.time()
view = make_view(512, 512)
source = simple.StratusImageReader(FileName=path, MemoryLimit=int(limit))
source.UpdatePipeline()
shown = simple.Show(source, view, "UniformGridRepresentation")
simple.ColorBy(shown, ("POINTS", "ImageFile"))
look, fade = simple.GetColorTransferFunction("ImageFile"), simple.GetOpacityTransferFunction("ImageFile")
look.ColorSpace, look.UseLogScale = "RGB", 0
look.RGBPoints = [0, 0.1, 0.3, 0.9, 255, 0.9, 0.4, 0.1]
fade.Points = [25, 0, 0.5, 0, 255, 0.8, 0.5, 0]
shown.SetRepresentationType("Stratus Volume")
sizes = next(line for line in open(path) if line.startswith("sizes:")).split()[1:]
shown.ScalarOpacityUnitDistance = (int(sizes[0]) - 1) / 50  # each rank knows the bounds of its own part
shown.SetScalarBarVisibility(view, False)
view.ResetCamera()
simple.SaveScreenshot(picture, view, ImageResolution=[512, 512])
most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(f"rank {process.GetPartitionId()} of {process.GetNumberOfLocalPartitions()}: {time.time() - begin:.1f} s, {most} bytes", flush=True)
