# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: the representation draws the picture of `stratus render`, and filters give the expected outputs.
pvbatch test_pictures.py PLUGIN STRATUS COMPARE-PICTURES FOLDER, in the repository's root; pictures go to the folder."""
import os
import sys

import numpy
from paraview import simple
from paraview.vtk import vtkIOXML, vtkCommonDataModel
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, draw, folder, leave, load, shot


def write_cloud(path):
    """Heaps of density on an uneven grid, far from the origin."""
    n = (72, 60, 48)
    x, y, z = numpy.meshgrid(*[numpy.arange(m, dtype=numpy.float32) for m in n], indexing="ij", sparse=True)
    field = numpy.zeros(n, numpy.float32)
    for cx, cy, cz, r in (20, 22, 18, 14), (48, 34, 26, 18), (60, 12, 36, 7):
        ripple = 0.2 * (numpy.sin(x / 3) * numpy.cos(y / 4) + numpy.sin(z / 5))
        field = numpy.maximum(field, 1 - ((x - cx) ** 2 + (y - cy) ** 2 + 2 * (z - cz) ** 2) / r**2 + ripple)
    image = vtkCommonDataModel.vtkImageData()
    image.SetDimensions(*n)
    image.SetSpacing(1, 1.2, 0.9)
    image.SetOrigin(100, -20, 5)
    array = numpy_to_vtk(numpy.clip(field, 0, None).ravel(order="F"), deep=True)
    array.SetName("density")
    image.GetPointData().SetScalars(array)
    writer = vtkIOXML.vtkXMLImageDataWriter()
    writer.SetInputData(image)
    writer.SetFileName(path)
    writer.SetDataModeToBinary()
    check(writer.Write() == 1, "the cloud is written")
    return array.GetRange()[1]


def pixels(path):
    return open(path, "rb").read()


def translucent(shown, view):
    """A sheet across the view before, within and behind the volume: ParaView peels volumes. Opaque sheets in the place of the sheet within
    show the part of the volume before it."""
    plain = shot(view, "cloud-on-black")
    view.Background = [1, 1, 1]
    clear = shot(view, "cloud-on-white") - plain  # the part of the background that the volume lets through
    view.Background = [0, 0, 0]
    eye, focus = numpy.array(view.CameraPosition), numpy.array(view.CameraFocalPoint)
    forward = (focus - eye) / numpy.linalg.norm(focus - eye)
    right = numpy.cross(forward, view.CameraViewUp)
    right, up = right / numpy.linalg.norm(right), numpy.cross(right / numpy.linalg.norm(right), forward)
    low, high = numpy.array([100.0, -20, 5]), numpy.array([100 + 71, -20 + 59 * 1.2, 5 + 47 * 0.9])
    depths = [numpy.dot([x, y, z] - eye, forward) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    color, opacity = numpy.array([0.2, 0.4, 1.0]), 0.5
    lit = clear.mean(axis=1) < 0.8
    check(lit.sum() > 5000, "the volume covers a part of the view")
    for name, depth in ("before", min(depths) - 5), ("within", (min(depths) + max(depths)) / 2), ("behind", max(depths) + 5):
        corner = eye + depth * (forward - right - up)
        sheet = simple.Plane(Origin=list(corner), Point1=list(corner + 2 * depth * right), Point2=list(corner + 2 * depth * up))
        surface = simple.Show(sheet, view)
        surface.Ambient, surface.Diffuse, surface.Specular, surface.Opacity = 1, 0, 0, opacity
        surface.AmbientColor = surface.DiffuseColor = list(color)
        seen = shot(view, "cloud-and-sheet-" + name)
        surface.Opacity, near = 1, []
        for shade in 0, 1:
            surface.AmbientColor = surface.DiffuseColor = 3 * [shade]
            near.append(shot(view, f"cloud-and-sheet-{name}-{shade}"))
        simple.Delete(surface)
        simple.Delete(sheet)
        front, through = near[0], near[1] - near[0]
        meant = front + through * opacity * color + (1 - opacity) * (plain - front)
        error = numpy.abs(seen - meant).max(axis=1) * 255
        # Three pictures that were rounded to bytes go into what is expected, and layers of bytes into what is seen.
        print(f"a translucent sheet {name} the volume: {error.max():.2f} of 255")
        check(error.max() <= 2.5, f"a translucent sheet {name} the volume: {error.max():.2f} of 255")
        if name == "within":
            whole = numpy.minimum(abs(seen - opacity * color - (1 - opacity) * plain), abs(seen - plain - clear * opacity * color))
            check((whole.max(axis=1)[lit] * 255 > 6).sum() > 1000, "a sheet within the volume has some of it before and some behind it")


def filters(cloud, shown, view, before):
    tree = simple.StratusHybridTree(Input=cloud, Scalars=["POINTS", "density"], Range=[0.1, 2])
    tree.UpdatePipeline()
    fields = simple.servermanager.Fetch(tree).GetFieldData()
    check(fields.GetArray("StratusHybridTree") is not None, "the image carries its tree")
    before_settings = vtk_to_numpy(fields.GetArray("StratusHybridTree"))
    tree.Device, tree.Threads = "host", 1
    tree.UpdatePipeline()
    on_host = vtk_to_numpy(simple.servermanager.Fetch(tree).GetFieldData().GetArray("StratusHybridTree"))
    check((on_host == before_settings).all(), "device and threads do not change the tree")
    bytes_of = []
    for edges in (0, 1):
        tree.Method, tree.Purpose, tree.AgglomerativeByEdges, tree.Range = "Agglomerative", "First Hits", edges, [0.9, 2]
        tree.UpdatePipeline()
        array = simple.servermanager.Fetch(tree).GetFieldData().GetArray("StratusHybridTree")
        bytes_of.append(vtk_to_numpy(array).tobytes())
    check(bytes_of[0] != bytes_of[1], "agglomeration by edges makes another tree")
    tree.Method, tree.Purpose, tree.AgglomerativeByEdges, tree.Range = "Hybrid", "Ray Casting", 0, [0.1, 2]
    tree.UpdatePipeline()
    boxes = simple.servermanager.Fetch(tree, idx=1)
    check(boxes.GetNumberOfCells() > 0 and boxes.GetCellData().GetArray("Depth") is not None, "the boxes of its nodes")
    shown.StratusStructure = "Hybrid Tree"
    again = before.replace(".png", "-tree.png")
    simple.SaveScreenshot(again, view, ImageResolution=view.ViewSize[:], TransparentBackground=0)
    check(pixels(again) == pixels(before), "through the tree the same picture")
    shown.StratusRenderMode = "First Hit"
    simple.SaveScreenshot(again, view, ImageResolution=view.ViewSize[:], TransparentBackground=0)
    check(pixels(again) != pixels(before), "first hits are another picture")
    shown.StratusRenderMode = "Composite"
    shown.StratusSampleDistance = 5
    simple.SaveScreenshot(again, view, ImageResolution=view.ViewSize[:], TransparentBackground=0)
    check(pixels(again) != pixels(before), "long steps are another picture")

    distances = simple.StratusDistanceMap(Input=cloud, Scalars=["POINTS", "density"], Range=[0.1, 2], BlockSize="4")
    distances.UpdatePipeline()
    values = vtk_to_numpy(simple.servermanager.Fetch(distances).GetCellData().GetArray("Distance"))
    check(len(values) == 18 * 15 * 12 and values.min() == 0 and values.max() > 1, "distances of all blocks")

    cells = simple.Tetrahedralize(Input=simple.Wavelet(WholeExtent=[0, 8, 0, 8, 0, 8]))
    parts = simple.StratusPartition(Input=cells, Depth=2, LeafCells=1)
    parts.UpdatePipeline()
    leaves = vtk_to_numpy(simple.servermanager.Fetch(parts).GetCellData().GetArray("StratusLeaf"))
    check(sorted(set(leaves)) == [0, 1, 2, 3] and (numpy.diff(leaves) >= 0).all(), "four leaves, one after the other")


def statistics(shown):
    """The panel reports the last picture, whose step was set to 5."""
    simple.Render()
    check(shown.StratusSamplesTaken > 0 and shown.StratusCastTime > 0 and shown.StratusDeviceUsed, "samples, time and device are reported")
    by_cells = shown.StratusSamplingUsed == "cells"
    check(shown.StratusUsedSampleDistance == (0 if by_cells else 5), f"a step of {shown.StratusUsedSampleDistance} by {shown.StratusSamplingUsed}")
    check(("cell error" if by_cells else "sample distance 5") in shown.StratusReason, f"the reason: {shown.StratusReason}")
    shown.StratusSampling = "Midpoint"
    simple.Render()
    check(shown.StratusUsedSampleDistance == 5, "the step is reported")
    check(shown.StratusStructureUsed == "hybrid" and shown.StratusSamplingUsed == "midpoint" and shown.StratusReason, "the choices are reported")


load()
cloud_path = os.path.join(folder, "cloud.vti")
most = write_cloud(cloud_path)
colors = [(0, 0.3, 0.4, 0.7), (0.5, 0.9, 0.9, 0.9), (most, 1, 0.9, 0.7)]
cloud, shown, view, png, _ = draw(cloud_path, "density", [(0.05, 0), (most, 0.4)], colors, 1.0, 55)
translucent(shown, view)
filters(cloud, shown, view, png)
statistics(shown)
isabel = os.path.realpath("../shared/data/isabel_02.vti")
whole = os.path.exists(isabel)
if whole:
    draw(isabel, "velocityMag", [(10, 0), (70, 0.3)], [(0, 0.1, 0.2, 0.7), (35, 0.9, 0.9, 0.4), (75, 0.9, 0.1, 0.1)], 1.0, 55)
else:
    print("SKIPPED: ../shared/data/isabel_02.vti is not here; the hurricane was not drawn")
leave(whole)
