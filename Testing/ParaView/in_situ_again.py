# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch in_situ_again.py PICTURE: draws the last output of plume-in-situ (STRATUS_RAW, float32 on 97 x 49 x 49 points) on one rank as its own
script does, and compares it with the PICTURE of the same step on several ranks: each pixel may differ by 1 of 255."""
import os
import sys

from paraview import simple
from paraview.vtk import vtkIOImage
from paraview.vtk.util.numpy_support import vtk_to_numpy

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(root, "Examples", "in-situ"))
import plume

picture = sys.argv[1]


def pixels(path):
    reader = vtkIOImage.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


simple._DisableFirstRenderCameraReset()
source = simple.ImageReader(FileNames=[os.environ["STRATUS_RAW"]], DataScalarType="float", DataByteOrder="LittleEndian",
                            FileDimensionality="3", DataExtent=[0, 96, 0, 48, 0, 48], ScalarArrayName="concentration")
source.UpdatePipeline()
view = plume.show(source)
again = os.path.splitext(picture)[0] + "-again.png"
simple.SaveScreenshot(again, view, ImageResolution=[400, 300], TransparentBackground=0)
drawn, wanted = pixels(picture), pixels(again)
lit = (abs(wanted - wanted[0]).max(axis=1) > 20).reshape(300, 400)
halves = lit[:, :200].sum(), lit[:, 200:].sum()  # about each of two ranks' share
difference = abs(drawn - wanted).max()
print(f"in situ compared with its data drawn on one rank: differs by {difference} of 255, {halves[0]} and {halves[1]} pixels are lit on the sides")
sys.stdout.flush()
os._exit(0 if difference <= 1 and min(halves) > 2000 else 1)
