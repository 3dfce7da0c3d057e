# SPDX-License-Identifier: BSD-3-Clause
# The whole pipeline, each part on a device: a source, the builder of the tree, the mapper that walks it, and reports of who built what.
# pipeline.py [DEVICE [OUT.png]]. DEVICE is auto (the default), host, an OpenCL device's number or a part of its name.
import sys, stratus, vtk
device = sys.argv[1] if len(sys.argv) > 1 else "auto"
source, volume, builder, mapper = vtk.vtkRTAnalyticSource(), vtk.vtkVolume(), stratus.vtkStratusHybridTreeFilter(), stratus.vtkStratusVolumeMapper()
source.SetWholeExtent(-48, 48, -48, 48, -48, 48)
opacity, color = volume.GetProperty().GetScalarOpacity(), volume.GetProperty().GetRGBTransferFunction()
opacity.RemoveAllPoints(), opacity.AddPoint(180, 0), opacity.AddPoint(270, 0.4)
color.RemoveAllPoints(), color.AddRGBPoint(180, 0.2, 0.4, 0.8), color.AddRGBPoint(270, 1, 0.8, 0.4)
volume.GetProperty().SetInterpolationTypeToLinear()
builder.SetInputConnection(source.GetOutputPort()), builder.SetVolumeProperty(volume.GetProperty()), builder.SetDevice(device)
mapper.SetInputConnection(builder.GetOutputPort()), mapper.SetDevice(device), mapper.SetStructureToHybrid(), volume.SetMapper(mapper)
if builder.GetDevice() != device: sys.exit(1)  # the error listed the devices
renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
renderer.AddVolume(volume), window.AddRenderer(renderer), window.SetSize(480, 480)
renderer.GetActiveCamera().SetPosition(2, 1.5, 3), renderer.ResetCamera(), window.Render()
for who, part in ("builder", builder), ("mapper", mapper):
    table, columns = part.GetBuildReport(), ("Stage", "Where", "Milliseconds", "Bytes", "Kernels")
    print(f"{who}, {part.GetDeviceName()}\n  {'stage':20} {'where':40} {'ms':>8} {'bytes':>12} {'kernels':>8}")
    for row in range(table.GetNumberOfRows()):
        stage, where, ms, size, kernels = [table.GetColumnByName(name).GetValue(row) for name in columns]
        print(f"  {stage:20} {where:40} {ms:8.2f} {size:12} {kernels:8}")
print("the mapper walked the builder's tree:", "yes" if mapper.GetCarriedTreeUsed() else "no")
if len(sys.argv) > 2:
    picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    picture.SetInput(window), picture.ReadFrontBufferOff(), writer.SetInputConnection(picture.GetOutputPort())
    writer.SetFileName(sys.argv[2]), writer.Write(), sys.exit(0 if mapper.GetCarriedTreeUsed() else 1)
hand = vtk.vtkRenderWindowInteractor()
hand.SetRenderWindow(window), hand.Start()
