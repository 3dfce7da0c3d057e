# SPDX-License-Identifier: BSD-3-Clause
"""Clipping planes, crop regions and slices."""
import vtk

import vtk_verdict_data as made
from vtk_verdict import Different, Same, case, pair
from vtk_verdict_data import image, look
from vtk_verdict_modes import waving


def planes(*pairs):
    """Settings of clipping planes, each of an origin and a normal."""

    def settings(mapper):
        for origin, normal in pairs:
            plane = vtk.vtkPlane()
            plane.SetOrigin(origin), plane.SetNormal(normal)
            mapper.AddClippingPlane(plane)

    return settings


TWO = planes(((17.55, 0, 0), (0.8, 0, 0)), ((17.55, 13.65, 0), (0.2, -0.2, 0)))


@case("TestGPURayCastClipping")
def clipping():
    return Same(pair(image(made.waves()), waving(unit=4), TWO, step=0.05))


@case("TestGPURayCastClippingPolyData")
def clipping_with_sphere():
    def scene(renderer):
        sphere, mapper, actor = vtk.vtkSphereSource(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
        sphere.SetCenter(19, 19, 19), sphere.SetRadius(8), sphere.SetPhiResolution(40), sphere.SetThetaResolution(40)
        mapper.SetInputConnection(sphere.GetOutputPort())
        actor.SetMapper(mapper)
        renderer.AddActor(actor)

    return Same(pair(image(), look(), planes(((19, 19, 19), (1, 0, 0)), ((19, 19, 19), (0.2, -0.2, 0))), scene=scene, step=0.05))


@case("TestGPURayCastClippingUserTransform")
def clipping_with_matrix():
    def place(volume):
        turned = vtk.vtkTransform()
        turned.Translate(3, 4, 5), turned.RotateY(40), turned.Scale(1, -1, 1)
        volume.SetUserTransform(turned)

    def settings(mapper):
        mapper.SetBlendModeToMaximumIntensity()
        planes(((20, 0, -6), (0.2, 0, 1)), ((20, 0, 4), (0.1, 0, -1)))(mapper)

    return Same(pair(image(), look(alpha=((0, 0), (255, 1))), settings, place, step=0.05))


def crop(flags, box=(11.3, 26.2, 12.4, 25.7, 9.6, 28.1)):
    def settings(mapper):
        mapper.CroppingOn()
        mapper.SetCroppingRegionPlanes(*box)
        mapper.SetCroppingRegionFlags(flags)

    return settings


@case("TestGPURayCastCropping")
def crops():
    kinds = "SubVolume", "Cross", "InvertedCross", "Fence", "InvertedFence"
    mapper, pairs = vtk.vtkFixedPointVolumeRayCastMapper(), []
    for kind in kinds:
        getattr(mapper, "SetCroppingRegionFlagsTo" + kind)()
        pairs.append(pair(image(made.waves()), waving(unit=4), crop(mapper.GetCroppingRegionFlags()), step=0.05))
    return Same(*pairs, *(pair(image(made.waves()), waving(unit=4), crop(flags), step=0.05) for flags in (24600, 0o123456701)))


@case("TestGPURayCastCropping1")
def fence():
    def settings(mapper):
        crop(0)(mapper)
        mapper.SetCroppingRegionFlagsToFence()

    return Same(pair(image(made.waves()), waving(unit=4), settings, step=0.05))


@case("TestGPURayCastSlicePlane")
def slices():
    def settings(mapper):
        mapper.SetBlendModeToSlice()

    def cropped(mapper):
        mapper.SetBlendModeToSlice()
        mapper.CroppingOn()
        mapper.SetCroppingRegionPlanes(19.5, 39, 0, 39, 0, 39)

    shown = look(alpha=((40, 0.3), (270, 0.9)), tints=made.WAVE_TINTS)
    plane = vtk.vtkPlane()
    plane.SetOrigin(20, 19.5, 19.5), plane.SetNormal(0.6, 0.2, 0.7)
    shown.SetSliceFunction(plane)
    cells = image(made.waves(), cells=True)
    return Different(*([pair(data, shown, settings), pair(data, shown, cropped)] for data in (image(made.waves()), cells)))
