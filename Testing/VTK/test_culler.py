# SPDX-License-Identifier: BSD-3-Clause
"""The culler from Python: installed, it draws what VTK's own does, follows what changes, gives its cells, and goes again."""
import sys

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


renderer, window, source = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkSphereSource()
window.SetOffScreenRendering(1)
window.SetMultiSamples(0)
window.SetSize(120, 90)
window.AddRenderer(renderer)
actors = []
for i in range(125):
    mapper, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
    mapper.SetInputConnection(source.GetOutputPort())
    actor.SetMapper(mapper)
    actor.SetPosition(2 * (i % 5), 2 * (i // 5 % 5), 2 * (i // 25))
    renderer.AddActor(actor)
    actors.append(actor)
renderer.GetActiveCamera().SetPosition(4, 4, 11)
renderer.GetActiveCamera().SetFocalPoint(5, 4, 0)
renderer.GetActiveCamera().SetClippingRange(0.1, 100)


def draw():
    window.Render()
    pixels = vtk.vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, 119, 89, 0, pixels)
    return vtk_to_numpy(pixels).copy()


reference = draw()
check(reference.max() > reference.min(), "something is drawn")
Culler = stratus.vtkStratusOctreeCuller
culler = Culler.Install(renderer)
check(culler.IsA("vtkCuller") and Culler.Install(renderer) is culler, "installed once")
check(renderer.GetCullers().GetNumberOfItems() == 1, "in the other's place")
culler.SetLeafProps(4)
check(numpy.array_equal(draw(), reference), "the same picture")
check(0 < culler.GetNumberOfVisibleProps() < 100 and culler.GetNumberOfProps() == 125, "some are left out")
draw(), draw()
check(culler.GetNumberOfPropsAsked() == 0, "nothing is asked where nothing changed")
source.SetRadius(0.8)
changed = draw()
check(culler.GetNumberOfPropsAsked() == 125 and not numpy.array_equal(changed, reference), "a change upstream is seen")
boxes = vtk.vtkPolyData()
check(culler.GetBoxes(renderer, boxes), "the cells")
check(boxes.GetNumberOfCells() == culler.GetNumberOfNodes(renderer) > 8, "one a node")
check(vtk_to_numpy(boxes.GetCellData().GetArray("Objects")).sum() == 125, "every prop in one")
check(culler.GetBytes(renderer) > 0, "bytes")
Culler.Uninstall(renderer)
check(renderer.GetCullers().GetLastItem().IsA("vtkFrustumCoverageCuller"), "VTK's own is back")
check(numpy.array_equal(draw(), changed), "and draws the same")
check("StopRule" in str(culler), "it prints itself")
sys.exit(1 if failures else 0)
