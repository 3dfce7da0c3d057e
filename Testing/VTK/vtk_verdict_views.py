# SPDX-License-Identifier: BSD-3-Clause
"""Cameras, matrices, spacings and directions."""
import vtk

import vtk_verdict_data as made
from vtk_verdict import GPU, OURS, Better, Different, Same, case, pair, picture
from vtk_verdict_data import image, look
from vtk_verdict_reference import from_reference, composite


def inside(x, y, z, fx, fy, fz, angle=60):
    def camera(renderer, view):
        view.SetPosition(x, y, z), view.SetFocalPoint(fx, fy, fz)
        view.SetViewAngle(angle)

    return camera


def thin(**options):
    return look(alpha=((0, 0), (20, 0), (255, 0.12)), **options)


@case("TestGPURayCastCameraInside")
def camera_inside():
    return Same(pair(image(), thin(), camera=inside(20, 20, 22, 22, 18, 10)))


@case("TestGPURayCastCameraInsideSmallSpacing")
def small_spacing():
    """From within VTK's picture is another at spacings of 7e-6, but not at a thousandth."""
    errors = []
    for spacing in 7e-6, 1e-3:
        data, shown = image(spacing=(spacing, spacing, spacing)), thin(unit=spacing)
        camera = inside(*(spacing * c for c in (20, 20, 22, 22, 18, 10)))
        exact = composite(data, shown, camera, 0.05 * spacing)
        errors.append(from_reference(pair(data, shown, camera=camera, step=spacing / 10), exact))
    (vtks, ours), (vtks_larger, ours_larger) = errors
    return Better({"at a thousandth both are right": max(vtks_larger, ours_larger) < 0.6}, ours, vtks)


@case("TestGPURayCastCameraInsideClipping")
def camera_inside_clipping():
    def scene(renderer):
        sphere, outline = vtk.vtkSphereSource(), vtk.vtkOutlineFilter()
        sphere.SetCenter(20, 14, 8), sphere.SetRadius(5)
        outline.SetInputData(image())
        for source in sphere, outline:
            mapper, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
            mapper.SetInputConnection(source.GetOutputPort())
            actor.SetMapper(mapper)
            renderer.AddActor(actor)

    def camera(renderer, view):
        view.SetPosition(20, 22, 44), view.SetFocalPoint(20, 22, 10)
        view.SetViewAngle(110)

    return Same(pair(image(), thin(), scene=scene, camera=camera))


@case("TestGPURayCastCameraInsideTransformation")
def camera_inside_transformation():
    def place(volume):
        volume.SetOrigin(18, 20, 22)
        volume.RotateX(40), volume.RotateY(-25), volume.SetPosition(3, -2, 1)

    return Same(pair(image(), thin(), place=place, camera=inside(20, 18, 22, 24, 20, 0)))


@case("TestGPURayCastCameraInsideNonUniformScaleTransform")
def camera_inside_scale():
    """VTK takes lengths along rays in the volume's own coordinates. Where all axes have one scale, a unit multiplied by it is as long."""

    def place(volume):
        volume.SetScale(1.4, 0.8, 1.1)

    def evenly(volume):
        volume.SetScale(1.4, 1.4, 1.4)

    camera = inside(28, 16, 24, 30, 18, 0, 120)
    both = pair(image(), thin(), place=place, camera=camera)
    even = picture(GPU, image(), thin(), place=evenly), picture(OURS, image(), thin(unit=1.4), place=evenly)
    return Different([both], [even], from_reference(both, composite(image(), thin(), camera, place=place)))


@case("TestGPURayCastVolumeScale")
def spacing():
    return Same(pair(image(made.waves(30), spacing=(1, 2, 3), origin=(10, 20, 30)), look(made.WAVES, made.WAVE_TINTS)))


@case("TestGPURayCastVolumeRotation")
def rotation():
    def then(volume):
        volume.RotateWXYZ(35, 0.3, 1, 0.2)

    return Same(pair(image(), look(), then=then))


@case("TestGPURayCastVolumeOrientation")
def orientation():
    def place(volume):
        volume.SetOrientation(20, -30, 50), volume.SetScale(1, -1, 1)

    return Same(pair(image(), look(), place=place))


@case("TestGPURayCastOrientedVolume")
def direction():
    data = image(origin=(20, 10, 4), spacing=(1.2, 1, 0.8))
    turned = vtk.vtkTransform()
    turned.RotateZ(30), turned.RotateX(-20)
    matrix = turned.GetMatrix()
    data.SetDirectionMatrix([matrix.GetElement(i, j) for i in range(3) for j in range(3)])
    return Same(pair(data, look()))
