# SPDX-License-Identifier: BSD-3-Clause
"""Volumes with opaque and translucent surfaces, drawn into images, and hidden cells."""
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk

import vtk_verdict_data as made
from vtk_verdict import Different, Same, case, pair
from vtk_verdict_cuts import TWO
from vtk_verdict_data import image, look
from vtk_verdict_modes import four, waving
from vtk_verdict_reference import from_reference, composite, trilinear


def sphere(center=(19.5, 19.5, 19.5), radius=10, opacity=1, color=(0.5, 0.9, 0.7)):
    source, mapper, actor = vtk.vtkSphereSource(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
    source.SetCenter(center), source.SetRadius(radius), source.SetPhiResolution(40), source.SetThetaResolution(40)
    mapper.SetInputConnection(source.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(color), actor.GetProperty().SetOpacity(opacity)
    return actor


def plane(*corners):
    source, mapper, actor = vtk.vtkPlaneSource(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
    source.SetOrigin(corners[0]), source.SetPoint1(corners[1]), source.SetPoint2(corners[2])
    mapper.SetInputConnection(source.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(1), actor.GetProperty().SetDiffuse(0)
    return actor


def with_actors(*actors, peeling=False):
    def scene(renderer):
        for actor in actors:
            renderer.AddActor(actor)
        if peeling:
            renderer.SetUseDepthPeeling(1), renderer.SetUseDepthPeelingForVolumes(1)
            renderer.SetOcclusionRatio(0), renderer.SetMaximumNumberOfPeels(20)

    return scene


@case("TestGPURayCastVolumePlane")
def with_plane():
    corner = plane((-5, -5, 21.3), (45, -5, 21.3), (-5, 45, 21.3))
    return Same(pair(image(made.waves()), waving(), scene=with_actors(corner)))


@case("TestGPURayCastVolumePolyData")
def with_sphere():
    return Same(pair(image(), look(), scene=with_actors(sphere())))


@case("TestGPURayCastDepthPeeling")
def peeling():
    return Same(pair(image(), look(), scene=with_actors(sphere(opacity=0.3), sphere((26, 20, 14), 8, 0.4, (0.9, 0.4, 0.1)), peeling=True)))


@case("TestGPURayCastDepthPeelingClip")
def peeling_clipped():
    actors = sphere(opacity=0.3), sphere((26, 20, 14), 8, 0.4, (0.9, 0.4, 0.1))
    return Same(pair(image(), look(unit=4), TWO, scene=with_actors(*actors, peeling=True)))


@case("TestGPURayCastDepthPeelingBoxWidget")
def peeling_box():
    def settings(mapper):
        box = vtk.vtkPlanes()
        box.SetBounds(8, 31, 6, 30, 9, 33)
        for i in range(6):
            side = vtk.vtkPlane()
            side.SetOrigin(box.GetPlane(i).GetOrigin())
            side.SetNormal([-c for c in box.GetPlane(i).GetNormal()])
            mapper.AddClippingPlane(side)

    return Same(pair(image(), look(unit=4), settings, scene=with_actors(sphere(opacity=0.3), peeling=True)))


@case("TestGPURayCastDepthPeelingOpaque")
def peeling_opaque():
    actors = sphere(opacity=0.3), sphere((24, 22, 16), 6, 1, (0.9, 0.4, 0.1))
    return Same(pair(image(), look(), scene=with_actors(*actors, peeling=True)))


@case("TestGPURayCastDepthPeelingTransVol")
def peeling_thin():
    actors = sphere(opacity=0.3), sphere((24, 22, 16), 6, 1, (0.9, 0.4, 0.1)), sphere(radius=14, opacity=0, color=(0, 1, 0))
    return Same(pair(image(), look(alpha=((0, 0), (20, 0), (255, 0.04))), scene=with_actors(*actors, peeling=True)))


@case("TestGPURayCastDepthPeelingTransparentPolyData")
def peeling_invisible():
    return Same(pair(image(), look(alpha=((0, 0), (20, 0), (255, 0.04))), scene=with_actors(sphere(opacity=0), peeling=True)))


@case("TestGPURayCastDepthPeelingBlendModes")
def peeling_modes():
    return Different(four(scene=with_actors(sphere(opacity=0.4, color=(1, 0.9, 1)), peeling=True)), four(scene=with_actors(peeling=True)))


@case("TestGPURayCastCellData")
def cells():
    data = image(cells=True)
    return Same(pair(data, look()), pair(data, look(), scene=with_actors(sphere(opacity=0.4, color=(1, 0.9, 1)), peeling=True)))


@case("TestGPURayCastVolumeDepthPass")
def depth_pass():
    def settings(mapper):
        mapper.SetUseDepthPass(1)
        if hasattr(mapper, "GetDepthPassContourValues"):
            mapper.GetDepthPassContourValues().SetValue(0, 30)

    shown = look(alpha=((30, 0), (75, 0.3), (255, 0.3)))
    return Different([pair(image(), shown, settings)], [pair(image(), shown)])


def hide(data):
    """Hides a box of the data's cells and a box of its points by ghost arrays."""
    shape = list(reversed(data.GetDimensions()))
    cells, points = numpy.zeros([n - 1 for n in shape], numpy.uint8), numpy.zeros(shape, numpy.uint8)
    cells[:, :18, :15] = vtk.vtkDataSetAttributes.HIDDENCELL
    points[22:, 25:, 25:] = vtk.vtkDataSetAttributes.HIDDENPOINT
    for array, attributes in (cells, data.GetCellData()), (points, data.GetPointData()):
        ghosts_ = numpy_to_vtk(array.ravel(), deep=True)
        ghosts_.SetName("vtkGhostType")
        attributes.AddArray(ghosts_)
    return data


@case("TestGPURayCastVolumeGhostArrays")
def ghosts():
    return Same(pair(hide(image(made.waves())), waving(unit=2)))


@case("TestGPURayCastVolumeGhostArraysCellData")
def ghosts_of_cells():
    """A hidden point hides the cells at it. In the reference all between the centre of a hidden cell and those around it is transparent."""
    shown, values = waving(unit=2), numpy.pad(made.waves().astype(float), 1, mode="edge")
    centres = [numpy.concatenate([[0], numpy.arange(40) + 0.5, [40]])] * 3

    def field(axes, _, points):
        return trilinear(centres, values, points)

    def inside(points):
        x, y, z = numpy.moveaxis(points, -1, 0)
        return ((x >= 15.5) | (y >= 18.5)) & ((x <= 23.5) | (y <= 23.5) | (z <= 20.5))

    both = pair(hide(image(made.waves(), cells=True)), shown)
    exact = composite(image(numpy.zeros((41, 41, 41), numpy.float32)), shown, step=0.1, field=field, inside=inside)
    return Different([both], reference=from_reference(both, exact))


@case("TestGPURayCastVolumeUniformGridBlanking")
def blanking():
    source = image(made.waves())
    data = vtk.vtkUniformGrid()
    data.DeepCopy(source)
    for k in range(20, 40):
        for j in range(20, 40):
            for i in range(20, 40):
                data.BlankPoint(i + 40 * (j + 40 * k))
    return Same(pair(data, waving(unit=2)))
