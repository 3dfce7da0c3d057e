# SPDX-License-Identifier: BSD-3-Clause
"""Shadows between volumes and opaque surfaces. An even box of matter floats above a floor, in the light of one sun from the side. By Beer's law
its shadow on the floor is where the sun's way crosses the box, whichever mapper draws it. A plate between the sun and the box, however it is
made, takes the box's light. What is not an opaque, lit surface takes none."""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

SIDE = 160
BOX = (16.0, 12.0, 8.0)  # of the box, whose lower corner is 0
FLOOR = -3.0
SUN = numpy.array([1.0, 0.5, 2.0])
OPACITY = 0.08
FOCUS, SCALE = (12.0, 4.0), 24.0  # the middle of the window, and half its height in the world


def box(low=0, high=16):
    """Values of 1 on points 1 apart, from low to high along x."""
    image = vtk.vtkImageData()
    image.SetDimensions(high - low + 1, 13, 9)
    image.SetOrigin(low, 0, 0)
    values = numpy_to_vtk(numpy.ones((high - low + 1) * 13 * 9, numpy.float32), deep=1)
    values.SetName("matter")
    image.GetPointData().SetScalars(values)
    return image


def look():
    made = vtk.vtkVolumeProperty()
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    opacity.AddPoint(0, OPACITY)
    opacity.AddPoint(2, OPACITY)
    color.AddRGBPoint(0, 1, 1, 1)
    made.SetScalarOpacity(opacity)
    made.SetColor(color)
    made.SetInterpolationTypeToLinear()
    made.ShadeOn()
    made.SetAmbient(0)
    made.SetDiffuse(1)
    return made


def volume(kind):
    """Props that draw the box."""
    if kind == "two volumes":
        props = volume("image") + volume("image")
        props[0].GetMapper().SetInputData(box(0, 9))
        props[1].GetMapper().SetInputData(box(9, 16))
        return props
    if kind == "tetrahedra":
        mapper, cut = stratus.vtkStratusTetrahedraMapper(), vtk.vtkDataSetTriangleFilter()
        cut.SetInputData(box())
        cut.Update()
        mapper.SetInputData(cut.GetOutput())
    elif kind == "blocks":
        mapper, blocks = stratus.vtkStratusMultiBlockVolumeMapper(), vtk.vtkMultiBlockDataSet()
        blocks.SetBlock(0, box(0, 9))
        blocks.SetBlock(1, box(9, 16))
        mapper.SetInputDataObject(blocks)
    else:
        mapper = stratus.vtkStratusVolumeMapper()
        mapper.SetInputData(box())
    settings = mapper.GetSettings() if kind == "blocks" else mapper
    settings.SetShadows(True)
    settings.SetVolumetricScatteringBlending(2)
    prop = vtk.vtkVolume()
    prop.SetMapper(mapper)
    prop.SetProperty(look())
    return [prop]


class Scene:
    def __init__(self, props):
        self.renderer, self.window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(SIDE, SIDE)
        self.window.AddRenderer(self.renderer)
        self.props = props
        for prop in props:
            self.renderer.AddVolume(prop)
        self.errors = []
        for prop in props:
            prop.GetMapper().AddObserver("ErrorEvent", lambda *_: self.errors.append(1))
        sun = vtk.vtkLight()
        sun.SetLightTypeToSceneLight()
        sun.SetPosition(*(100 * SUN))
        sun.SetFocalPoint(0, 0, 0)
        self.renderer.AutomaticLightCreationOff()
        self.renderer.AddLight(sun)
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetParallelScale(SCALE)
        camera.SetPosition(*FOCUS, 60)
        camera.SetFocalPoint(*FOCUS, 0)
        camera.SetViewUp(0, 1, 0)
        camera.SetClippingRange(10, 100)

    def draw(self):
        """RGB of the window, 0..1, bottom row first."""
        self.window.Render()
        pixels = vtk.vtkUnsignedCharArray()
        self.window.GetRGBACharPixelData(0, 0, SIDE - 1, SIDE - 1, 0, pixels)
        return vtk_to_numpy(pixels).reshape(SIDE, SIDE, 4)[..., :3] / 255.0


def surface(points, cells, kind="polys"):
    data, at, array = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    for point in points:
        at.InsertNextPoint(*point)
    for cell in cells:
        array.InsertNextCell(len(cell))
        for point in cell:
            array.InsertCellPoint(point)
    data.SetPoints(at)
    (data.SetPolys if kind == "polys" else data.SetStrips if kind == "strips" else data.SetLines)(array)
    return data


def actor(data, mapper=None):
    made, mapper = vtk.vtkActor(), mapper or vtk.vtkPolyDataMapper()
    mapper.SetInputDataObject(data)
    mapper.ScalarVisibilityOff()
    made.SetMapper(mapper)
    return made


def square(low, high, z):
    return [(low, low, z), (high, low, z), (high, high, z), (low, high, z)]


def chords(way, start):
    """The lengths of lines through the box."""
    near, far = numpy.zeros(start.shape[:-1]), numpy.full(start.shape[:-1], numpy.inf)
    for axis in range(3):
        low, high = -start[..., axis] / way[axis], (BOX[axis] - start[..., axis]) / way[axis]
        near, far = numpy.maximum(near, numpy.minimum(low, high)), numpy.minimum(far, numpy.maximum(low, high))
    return numpy.maximum(far - near, 0)


def check_floor(kind):
    """The floor has Beer's shadow, and nothing else is changed."""
    floor = actor(surface(square(-60, 80, FLOOR), [(0, 1, 2, 3)]))
    bare = Scene([])
    bare.renderer.AddActor(floor)
    plain = bare.draw()
    scene = Scene(volume(kind))
    scene.renderer.AddActor(floor)
    shown = scene.draw()
    across = (2 * (numpy.arange(SIDE) + 0.5) / SIDE - 1) * SCALE
    x, y = numpy.meshgrid(FOCUS[0] + across, FOCUS[1] + across)
    place = numpy.stack([x, y, numpy.full_like(x, FLOOR)], axis=-1)
    way = SUN / math.sqrt((SUN**2).sum())
    wanted = plain * ((1 - OPACITY) ** chords(way, place))[..., None]
    beside = (x < -0.5) | (x > BOX[0] + 0.5) | (y < -0.5) | (y > BOX[1] + 0.5)
    off = numpy.abs(shown - wanted)[beside].max(axis=-1)
    shadow = (wanted < 0.9 * plain).any(axis=-1) & beside
    worst = numpy.sort(off)[int(0.98 * len(off))]  # the rest are the shadow's edges
    print(f"{kind}: {shadow.sum()} pixels in the shadow, 98 % within {worst:.4f}, all within {off.max():.3f}")
    check(shadow.sum() > 500, f"{kind}: the floor has a shadow")
    check(worst < 0.02, f"{kind}: the shadow follows Beer's law")
    check(plain.min() > 0.5 and off.max() < 0.3, f"{kind}: edges are as sharp as the map")


def check_plate():
    """A plate hides the sun from the matter, if it is opaque, lit, and drawn there. It is beyond the window's depth."""
    scene = Scene(volume("image"))
    scene.renderer.GetActiveCamera().SetPosition(*FOCUS, -60)
    scene.renderer.GetActiveCamera().SetClippingRange(10, 80)
    open_sky = scene.draw()
    check(open_sky.max() > 0.3, "the matter is lit")
    corners = square(-60, 80, 30)
    shapes = {
        "a quad": actor(surface(corners, [(0, 1, 2, 3)])),
        "two triangles": actor(surface(corners, [(0, 1, 2), (0, 2, 3)])),
        "a strip": actor(surface(corners, [(0, 1, 3, 2)], "strips")),
        "a concave polygon": actor(surface([(-60, -60, 30), (10, 30, 30), (80, -60, 30), (80, 80, 30), (-60, 80, 30)], [(0, 1, 2, 3, 4)])),
    }
    blocks = vtk.vtkMultiBlockDataSet()
    blocks.SetBlock(0, surface(corners, [(0, 1, 2)]))
    blocks.SetBlock(1, surface(corners, [(0, 2, 3)]))
    shapes["blocks"] = actor(blocks, vtk.vtkCompositePolyDataMapper2())
    shapes["blocks with mappers of their own"] = actor(blocks, vtk.vtkCompositePolyDataMapper())
    grid = vtk.vtkImageData()
    grid.SetDimensions(2, 2, 1)
    grid.SetSpacing(140, 140, 1)
    grid.SetOrigin(-60, -60, 30)
    shapes["a grid"] = actor(grid, vtk.vtkDataSetMapper())
    moved = actor(surface(square(-60, 80, 0), [(0, 1, 2, 3)]))
    moved.SetPosition(0, 0, 30)
    shapes["moved by its matrix"] = moved
    group = vtk.vtkAssembly()
    group.AddPart(actor(surface(square(-60, 80, 10), [(0, 1, 2, 3)])))
    group.SetPosition(0, 0, 20)
    shapes["an assembly"] = group
    for name, shape in shapes.items():
        scene.renderer.AddActor(shape)
        dark = scene.draw()
        if name == "a concave polygon":  # its notch lets some light pass
            check(0.02 < dark.max() and dark.mean() < 0.9 * open_sky.mean(), name)
        else:
            check(dark.max() == 0, f"{name} hides the sun: {dark.max()}")
        scene.renderer.RemoveActor(shape)
    plate = shapes["a quad"]
    scene.renderer.AddActor(plate)
    mapper = plate.GetMapper()
    plane = vtk.vtkPlane()
    plane.SetNormal(1, 0, 0)
    plane.SetOrigin(200, 0, 0)
    changes = {
        "hidden": (lambda: plate.VisibilityOff(), lambda: plate.VisibilityOn()),
        "translucent": (lambda: plate.GetProperty().SetOpacity(0.5), lambda: plate.GetProperty().SetOpacity(1)),
        "not lit": (lambda: plate.GetProperty().LightingOff(), lambda: plate.GetProperty().LightingOn()),
        "drawn as lines": (lambda: plate.GetProperty().SetRepresentationToWireframe(), lambda: plate.GetProperty().SetRepresentationToSurface()),
        "clipped away": (lambda: mapper.AddClippingPlane(plane), lambda: mapper.RemoveAllClippingPlanes()),
    }
    for name, (change, back) in changes.items():
        change()
        lit = scene.draw()
        check(numpy.abs(lit - open_sky).max() < 0.01 if name != "translucent" else lit.max() > 0.1, f"a plate that is {name} hides no sun")
        back()
        check(scene.draw().max() == 0, f"the plate after it was {name}")
    check_blocks(scene, open_sky)
    check_beside(scene, open_sky)
    check_broken(scene)
    plane.SetOrigin(BOX[0] / 2 + 0.5 * (30 - BOX[2] / 2), 0, 0)  # half of the plate is left: the sun's way to the box's middle crosses its edge
    mapper.AddClippingPlane(plane)
    half = scene.draw()
    check(half.max() > 0.1 and 0.2 * open_sky.sum() < half.sum() < 0.8 * open_sky.sum(), "half of a plate hides half of the box")
    for prop in scene.props:
        prop.GetMapper().SetVolumetricScatteringBlending(0)
        prop.GetMapper().SetShadows(False)
        prop.GetProperty().ShadeOff()
    check(scene.draw().max() > 0.3, "without light there are no shadows")


def check_blocks(scene, open_sky):
    """Blocks that their mapper hides or makes translucent hide no light. A block may say otherwise than its parent."""
    plate = scene.renderer.GetActors().GetLastActor()
    plate.VisibilityOff()
    pieces = [surface(square(-60, 80, 30), [(0, 1, 2)]), surface(square(-60, 80, 30), [(0, 2, 3)])]
    inner, outer = vtk.vtkMultiBlockDataSet(), vtk.vtkMultiBlockDataSet()
    inner.SetBlock(0, pieces[0])
    inner.SetBlock(1, pieces[1])
    outer.SetBlock(0, inner)
    parts, collection = vtk.vtkPartitionedDataSet(), vtk.vtkPartitionedDataSetCollection()
    parts.SetPartition(0, pieces[0])
    parts.SetPartition(1, pieces[1])
    collection.SetPartitionedDataSet(0, parts)
    for tree, node in ((outer, inner), (collection, parts)):
        shown = actor(tree, vtk.vtkCompositePolyDataMapper2())
        said = vtk.vtkCompositeDataDisplayAttributes()
        shown.GetMapper().SetCompositeDataDisplayAttributes(said)
        scene.renderer.AddActor(shown)
        check(scene.draw().max() == 0, f"all blocks of a {tree.GetClassName()} hide the sun")
        said.SetBlockVisibility(node, False)
        check(numpy.abs(scene.draw() - open_sky).max() < 0.01, f"hidden blocks of a {tree.GetClassName()} hide no sun")
        said.SetBlockVisibility(pieces[0], True)
        some = scene.draw().sum()
        check(0.01 * open_sky.sum() < some < 0.9 * open_sky.sum(), f"one block of a {tree.GetClassName()} hides a part: {some}")
        said.SetBlockVisibility(node, True)
        said.SetBlockOpacity(pieces[0], 0.3)
        lit = scene.draw().max()
        check(lit > 0.1, f"a translucent block of a {tree.GetClassName()} hides no sun")
        scene.renderer.RemoveActor(shown)
    plate.VisibilityOn()


def check_beside(scene, open_sky):
    """A grid that is beside the view, where VTK does not draw it, takes the sun in each frame, as its present data are."""
    plate = scene.renderer.GetActors().GetLastActor()
    plate.VisibilityOff()
    sun = scene.renderer.GetLights().GetItemAsObject(0)
    place = sun.GetPosition()
    sun.SetPosition(400, 20, 15)
    lit = scene.draw()
    grid = vtk.vtkImageData()
    grid.SetDimensions(1, 3, 3)
    grid.SetSpacing(1, 11, 8)
    grid.SetOrigin(60, -2, -2)
    wall = actor(grid, vtk.vtkDataSetMapper())
    scene.renderer.AddActor(wall)
    check(lit.max() > 0.1 and scene.draw().max() == 0, "a grid beside the view hides the sun")
    grid.SetOrigin(60, 60, 60)
    grid.Modified()
    check(numpy.abs(scene.draw() - lit).max() < 0.01, "a grid that has moved away hides it no longer")
    scene.renderer.RemoveActor(wall)
    sun.SetPosition(*place)
    check(numpy.abs(scene.draw() - open_sky).max() < 0.01, "the sun is back")
    plate.VisibilityOn()


def check_broken(scene):
    """Cells whose points are missing or not finite hide nothing, and end neither the process nor the picture."""
    nan = float("nan")
    corners = square(-60, 80, 30)
    no_points = surface([], [(0, 1, 2), (0, 1, 2, 3)])
    no_points.SetPoints(None)
    for name, data in {
        "a point that is not finite": surface(corners + [(nan, 0, 30)], [(0, 1, 4), (1, 2, 3, 4)]),
        "no points": no_points,
    }.items():
        broken = actor(data)
        scene.renderer.AddActor(broken)
        check(scene.draw().max() == 0, f"the plate beside cells of {name}")
        scene.renderer.RemoveActor(broken)
    check(not scene.errors, f"errors: {scene.errors}")


def check_abort(kind):
    """A picture that is aborted while surfaces take their shadows is not shown."""
    props = volume(kind)
    scene = Scene(props)
    scene.renderer.AddActor(actor(surface(square(-60, 80, FLOOR), [(0, 1, 2, 3)])))
    mapper = props[0].GetMapper()
    mapper.SetNumberOfThreads(1)
    counts, stop = [], [0]

    def look(*_):
        counts.append(1)
        if len(counts) == stop[0]:
            scene.window.SetAbortRender(1)

    scene.draw()  # which makes all that is kept from picture to picture
    scene.draw()
    observer = mapper.AddObserver("VolumeMapperRenderProgressEvent", look)
    scene.draw()
    check(mapper.GetLastImage() is not None and len(counts) > 10, f"{kind}: {len(counts)} checks for an abort")
    stop[0] = len(counts)
    counts.clear()
    scene.draw()
    check(mapper.GetLastImage() is None, f"{kind}: an aborted picture is none")
    mapper.RemoveObserver(observer)


for name in ("image", "tetrahedra", "blocks", "two volumes"):
    check_floor(name)
check_plate()
for name in ("image", "tetrahedra"):
    check_abort(name)
done()
