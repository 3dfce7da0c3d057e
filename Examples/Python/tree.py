# SPDX-License-Identifier: BSD-3-Clause
# Clouds far apart, and the hybrid tree over them: boxes of its nodes, brighter the deeper. tree.py [OUT.png]
import sys, numpy, stratus, vtk
from vtk.util.numpy_support import numpy_to_vtk
shape = numpy.array((256, 128, 256))  # x, y, z
x, y, z = numpy.meshgrid(*[numpy.arange(n, dtype=numpy.float32) for n in shape], indexing="ij", sparse=True)
ripple = 0.25 * (numpy.sin(x / 5) * numpy.cos(y / 4) + numpy.sin(z / 6) * numpy.cos(x / 7) + numpy.sin(y / 3 + z / 9))
field = numpy.zeros(shape, numpy.float32)
for cx, cy, cz, r in (60, 50, 70, 34), (190, 70, 60, 22), (215, 40, 205, 26), (90, 96, 200, 14), (140, 20, 140, 7):
    field = numpy.maximum(field, 1 - ((x - cx) ** 2 + 2.5 * (y - cy) ** 2 + (z - cz) ** 2) / r**2 + ripple * (r / 60 + 0.4))
image, window = vtk.vtkImageData(), vtk.vtkRenderWindow()
image.SetDimensions(*map(int, shape))
image.GetPointData().SetScalars(numpy_to_vtk(numpy.clip(field, 0, None).ravel(order="F"), deep=True))
volume, mapper, tree, renderer = vtk.vtkVolume(), stratus.vtkStratusVolumeMapper(), stratus.vtkStratusHybridTreeFilter(), vtk.vtkRenderer()
opacity, color = volume.GetProperty().GetScalarOpacity(), volume.GetProperty().GetRGBTransferFunction()
opacity.RemoveAllPoints(), opacity.AddPoint(0.05, 0), opacity.AddPoint(1, 0.35)
color.RemoveAllPoints(), color.AddRGBPoint(0, 0.75, 0.8, 0.9), color.AddRGBPoint(1, 1, 0.97, 0.9)
volume.GetProperty().SetInterpolationTypeToLinear()
tree.SetInputData(image), tree.SetVolumeProperty(volume.GetProperty())
tree.SetMethodToHybrid()
tree.SetFieldEmptiness(3)  # the default, 512, needs no more than one leaf here: this shows how a larger scene is cut
tree.Update()
mapper.SetInputConnection(tree.GetOutputPort()), mapper.SetStructureToHybrid(), volume.SetMapper(mapper)
boxes, lines, edges = vtk.vtkPolyDataMapper(), vtk.vtkLookupTable(), vtk.vtkActor()
lines.SetHueRange(0.58, 0.08), lines.SetSaturationRange(0.7, 0.9), lines.SetValueRange(0.6, 1), lines.Build()
boxes.SetInputConnection(tree.GetOutputPort(1)), boxes.SetLookupTable(lines), boxes.SetScalarModeToUseCellFieldData(), boxes.SelectColorArray("Depth")
boxes.SetScalarRange(0, max(1, int(tree.GetOutputDataObject(1).GetCellData().GetArray("Depth").GetRange()[1])))
edges.SetMapper(boxes), edges.GetProperty().SetLineWidth(1.5)
renderer.AddVolume(volume), renderer.AddActor(edges), renderer.SetBackground(0.07, 0.1, 0.16)
window.AddRenderer(renderer), window.SetSize(900, 560), window.SetMultiSamples(8)
renderer.ResetCamera(), renderer.GetActiveCamera().Azimuth(30), renderer.GetActiveCamera().Elevation(32), renderer.GetActiveCamera().Zoom(1.2)
renderer.ResetCameraClippingRange(), window.Render()
print("nodes:", tree.GetOutputDataObject(1).GetNumberOfCells(), " the mapper walked this tree:", bool(mapper.GetCarriedTreeUsed()))
if len(sys.argv) > 1:
    picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    picture.SetInput(window), writer.SetInputConnection(picture.GetOutputPort()), writer.SetFileName(sys.argv[1]), writer.Write()
else:
    hand = vtk.vtkRenderWindowInteractor()
    hand.SetRenderWindow(window), hand.Start()
