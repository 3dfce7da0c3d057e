# SPDX-License-Identifier: BSD-3-Clause
# A plant of 9454 parts to walk through, or as an image: plant.py [OUT.png]. Key c switches the culler; the corner shows frames a second.
import sys
import stratus, vtk

cube, cylinder, sphere = vtk.vtkCubeSource(), vtk.vtkCylinderSource(), vtk.vtkSphereSource()
renderer, window, hand, label = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkRenderWindowInteractor(), vtk.vtkTextActor()
names, mode, parts = ("octree", "octree, static props", "VTK's own culler"), 0, 0


def add(shape, position, scale, turn, color):
    global parts
    if parts < 9454:
        mapper, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
        mapper.SetInputConnection(shape.GetOutputPort())
        actor.SetMapper(mapper), actor.SetPosition(position), actor.SetScale(scale), actor.GetProperty().SetColor(color)
        actor.RotateWXYZ(90 if turn else 0, turn == "z", 0, turn == "x")  # vtkCylinderSource's axis is y
        renderer.AddActor(actor)
        parts += 1


def add_unit(x, y):
    for i in range(9):
        add(cube, (x + 4 * (i % 3), y + 4 * (i // 3), 3), (0.25, 0.25, 6), "", (0.45, 0.5, 0.55))
    add(cylinder, (x + 2, y + 2, 2), (2.4, 3.6, 2.4), "z", (0.85, 0.82, 0.75))
    for i in range(14):
        at, z = 0.6 * i, 0.6 + 0.35 * i
        add(cylinder, (x + 4, y + at, z), (0.25, 11, 0.25), "x", (0.3, 0.55, 0.75))
        add(cylinder, (x + at, y + 4, z + 0.2), (0.2, 11, 0.2), "", (0.3, 0.55, 0.75))
        add(sphere, (x + at, y + at, z), (0.45, 0.45, 0.45), "", (0.85, 0.3, 0.15))


def set_mode(new):
    global mode
    mode = new % 3
    if mode == 2:
        stratus.vtkStratusOctreeCuller.Uninstall(renderer)
    else:
        stratus.vtkStratusOctreeCuller.Install(renderer).SetStaticProps(mode == 1)


def show_statistics(*_):
    rate = 1 / max(renderer.GetLastRenderTimeInSeconds(), 1e-9)
    label.SetInput(f"{names[mode]}: {renderer.GetNumberOfPropsRendered()} of {parts} parts, {rate:.1f} frames/s")


def on_key(*_):
    if hand.GetKeyCode() == "c":
        set_mode(mode + 1), hand.Render()


unit = 0
while parts < 9454:
    add_unit(14 * (unit % 14), 14 * (unit // 14))
    unit += 1
label.SetInput(" "), label.SetPosition(10, 10), label.GetTextProperty().SetFontSize(18), label.GetTextProperty().SetColor(0, 0, 0)
renderer.AddViewProp(label), renderer.SetBackground(0.75, 0.82, 0.88), renderer.AddObserver("EndEvent", show_statistics)
camera = renderer.GetActiveCamera()
camera.SetPosition(52, 40.5, 8.5), camera.SetFocalPoint(90, 66, 1), camera.SetViewUp(0, 0, 1), camera.SetClippingRange(0.3, 80)
window.SetSize(900, 560), window.AddRenderer(renderer), set_mode(0)
if len(sys.argv) > 1:
    for mode in 0, 1, 2:
        set_mode(mode), window.Render(), window.Render()
        print(label.GetInput())
    picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    picture.SetInput(window), picture.ReadFrontBufferOff()
    writer.SetInputConnection(picture.GetOutputPort()), writer.SetFileName(sys.argv[1]), writer.Write()
else:
    style = vtk.vtkInteractorStyleTrackballCamera()
    style.AutoAdjustCameraClippingRangeOff()  # else each move of the mouse asks all parts for their bounds
    hand.SetRenderWindow(window), hand.SetInteractorStyle(style), hand.AddObserver("CharEvent", on_key)
    window.Render(), hand.Start()
