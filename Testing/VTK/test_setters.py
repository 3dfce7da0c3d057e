# SPDX-License-Identifier: BSD-3-Clause
"""Setters of the filters, the reader, the order and the culler: each changes what it says, in counts, and a value out of range becomes the nearest
within it. (Those of the mappers: TestStratusVolumeMapperSetters, test_tetrahedra.)"""
import hashlib
import os
import sys

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

failures = 0
folder = sys.argv[1] if len(sys.argv) > 1 else "."


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def clamps(thing, name, lowest, highest):
    for value, meant in (-(2**31), lowest), (2**31 - 1, highest):
        getattr(thing, "Set" + name)(value)
        got = getattr(thing, "Get" + name)()
        check(got == meant, f"{name} of {value} becomes {meant}, not {got}")


def switches(thing, name, effect):
    """effect() is another when on than when off, whichever way it was switched."""
    getattr(thing, name + "Off")()
    off = effect()
    getattr(thing, name + "On")()
    on = effect()
    check(on != off, f"{name}On changes what {name}Off gives: {off}")
    for value in 0, 1, False, True:
        getattr(thing, "Set" + name)(value)
        check(effect() == (on if value else off), f"Set{name}({value})")


def reports(thing, update, stages):
    """The device's setters, and the report's columns as Python sees them."""
    errors = []
    tag = thing.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    kept = thing.GetNumberOfThreads()
    clamps(thing, "NumberOfThreads", 0, 1024)
    thing.SetNumberOfThreads(2)
    thing.SetDevice("no such device")
    check(len(errors) == 1 and thing.GetDevice() == "auto", f"no such device is {len(errors)} errors and device {thing.GetDevice()}")
    thing.SetDevice("host")
    check(thing.GetDevice() == "host" and thing.GetDeviceName().endswith("2 threads)"), f"the host is {thing.GetDeviceName()}")
    update()
    table = thing.GetBuildReport()
    rows = [[table.GetColumnByName(name).GetValue(i) for name in ("Stage", "Where", "Kernels")] for i in range(table.GetNumberOfRows())]
    check(rows == [[stage, "host", 0] for stage in stages], f"stages {rows}")
    thing.RemoveObserver(tag)
    thing.SetNumberOfThreads(kept)
    thing.SetDevice("auto")


def voxels():
    """Two balls, of which one is twice the other, and scattered voxels between."""
    n = 48
    z, y, x = numpy.meshgrid(*3 * [numpy.arange(n)], indexing="ij")
    values = numpy.zeros((n, n, n), numpy.float32)
    values[(x - 12) ** 2 + (y - 14) ** 2 + (z - 16) ** 2 < 81] = 1
    values[(x - 36) ** 2 + (y - 30) ** 2 + (z - 33) ** 2 < 49] = 2
    values[numpy.random.RandomState(1).rand(n, n, n) < 0.0015] = 1
    image = vtk.vtkImageData()
    image.SetDimensions(n, n, n)
    array = numpy_to_vtk(values.ravel(), deep=1)
    array.SetName("values")
    image.GetPointData().SetScalars(array)
    return image, values


def trees():
    image, values = voxels()
    tree = stratus.vtkStratusHybridTreeFilter()
    tree.SetInputData(image)
    tree.SetPurposeToFirstHits()
    tree.SetLowerThreshold(0.5)

    def built():
        tree.Update()
        return hashlib.sha1(vtk_to_numpy(tree.GetOutput().GetFieldData().GetArray("StratusHybridTree")).tobytes()).hexdigest()

    built()
    check(tree.GetNumberOfVoxels() == (values > 0).sum(), "all values from the lower threshold on")
    tree.SetUpperThreshold(1.5)
    built()
    check(tree.GetNumberOfVoxels() == (values == 1).sum(), "none above the upper threshold")
    tree.SetUpperThreshold(5)
    seen = {}
    for name in "Hybrid HybridPaper Distance Octant SAH Sweep LBVH PLOC Agglomerative DensityPeaks KMeans Wide".split():
        getattr(tree, "SetMethodTo" + name)()
        seen[tree.GetMethodAsString()] = built()
        check(tree.GetMethod() == len(seen) - 1, f"SetMethodTo{name} is method {tree.GetMethod()}")
        hierarchy = tree.SAH <= tree.GetMethod() <= tree.K_MEANS
        check((tree.GetNumberOfLeaves() == tree.GetNumberOfVoxels()) == hierarchy, f"{name}: {tree.GetNumberOfLeaves()} leaves")
    check(len(seen) == 12 and len(set(seen.values())) == 12, "twelve methods, twelve trees")
    tree.SetMethodToAuto()
    built()
    check("one distance field" in tree.GetReason(), f"the reason: {tree.GetReason()}")
    before = tree.GetMethodAsString(), tree.GetBytes()
    tree.SetMethodToOctant()
    built()
    check(before == ("auto", tree.GetBytes()), f"a set this small gets one field of octants, not {before}")
    tree.SetMethodToAgglomerative()
    switches(tree, "AgglomerativeByEdges", built)
    tree.SetMethodToHybridPaper()
    switches(tree, "UncorrectedFlooding", built)
    tree.SetMethodToSAH()
    tree.SetLeafVoxels(8)
    built()
    check(tree.GetNumberOfLeaves() < 0.8 * tree.GetNumberOfVoxels(), f"leaves of 8 voxels: {tree.GetNumberOfLeaves()}")
    clamps(tree, "LeafVoxels", 1, 64)

    tree.SetMethodToHybrid()
    tree.SetFieldBricks(64)
    tree.SetFieldEmptiness(2)
    plain = built()
    check(tree.GetNumberOfLeaves() > 8, f"fields of few bricks make {tree.GetNumberOfLeaves()} leaves")
    tree.SetMaximumDepth(2)
    built()
    check(tree.GetDepth() == 2 and tree.GetNumberOfLeaves() <= 4, f"a depth of {tree.GetDepth()}")
    clamps(tree, "MaximumDepth", 1, 64)
    tree.SetMaximumDepth(32)
    leaves = []
    for bricks in 1, 4, 64:
        tree.SetLeafBricks(bricks)
        built()
        leaves.append(tree.GetNumberOfLeaves())
    check(leaves[0] > leaves[1] > leaves[2], f"more bricks a leaf, fewer leaves: {leaves}")
    clamps(tree, "LeafBricks", 1, 64)
    tree.SetLeafBricks(4)
    check(built() == plain, "the same settings, another tree")
    tree.SetUniform(0)  # nothing is even enough: the density splits
    check(built() != plain, "SetUniform changes nothing")
    tree.SetBandwidth(5)
    wide = built()
    tree.SetBandwidth(2)
    check(built() != wide, "SetBandwidth changes nothing")
    switches(tree, "ExactDensity", built)
    tree.ExactDensityOff()
    tree.SetBandwidth(0)
    switches(tree, "DensityPerNode", built)
    tree.SetMethodToHybridPaper()
    tree.SetPaperThreshold(0)
    strict = built()
    tree.SetPaperThreshold(100)
    check(built() != strict, "SetPaperThreshold changes nothing")
    tree.SetPurposeToRayCasting()
    check(built() != strict and tree.GetPurpose() == tree.RAY_CASTING, "cells and voxels make one tree")
    clamps(tree, "Purpose", tree.RAY_CASTING, tree.FIRST_HITS)
    clamps(tree, "Method", tree.HYBRID, tree.AUTO)
    tree.SetMethodToLBVH()
    reports(tree, built, ["effective voxels", "hierarchy"])


def distances():
    image, values = voxels()
    filter = stratus.vtkStratusDistanceMapFilter()
    filter.SetInputData(image)
    filter.SetLowerThreshold(0.5)

    def blocks():
        filter.Update()
        return vtk_to_numpy(filter.GetOutput().GetCellData().GetArray("Distance")).copy()

    maps = {}
    for name in "Block", "Full", "Paper", "Octant":
        getattr(filter, "SetKindTo" + name)()
        maps[name] = blocks()
        check(filter.GetKindAsString().lower() == name.lower(), f"SetKindTo{name} is {filter.GetKindAsString()}")
    check(maps["Block"].max() == 1 and maps["Full"].max() > 1, "a flag, and distances")
    check((maps["Paper"] == maps["Full"]).all(), "the paper's transform gives the same distances")
    check((maps["Octant"] >= maps["Full"]).all() and (maps["Octant"] > maps["Full"]).any(), "rays of one octant see less")
    filter.SetOctant(0)
    check((blocks() != maps["Octant"]).any(), "another property's blocks differ")
    occupied = filter.GetOccupiedBlocks()
    filter.SetUpperThreshold(1.5)  # a ball of values of 2 has borders that pass 1 between voxels
    blocks()
    check(0 < filter.GetOccupiedBlocks() < occupied, f"{filter.GetOccupiedBlocks()} of {occupied} blocks below the upper threshold")
    clamps(filter, "Kind", filter.BLOCK, filter.OCTANT)
    clamps(filter, "Octant", 0, 7)
    reports(filter, blocks, ["value ranges", "occupancy", "distance map"])


def grid(dimensions, transform):
    image = vtk.vtkImageData()
    image.SetDimensions(*dimensions)
    tetrahedra = vtk.vtkDataSetTriangleFilter()
    tetrahedra.SetInputData(image)
    turned = vtk.vtkTransformFilter()
    turned.SetInputConnection(tetrahedra.GetOutputPort())
    turned.SetTransform(transform)
    turned.Update()
    return turned.GetOutput()


def partitions():
    along = vtk.vtkTransform()  # a bar along the space's diagonal, which no axis' planes cut straight
    along.RotateZ(45)
    along.RotateY(-35.26)
    bar = grid((31, 3, 3), along)
    cut = stratus.vtkStratusPartitionFilter()
    cut.SetInputData(bar)
    cut.SetLeafCells(50)
    cut.SetRule(cut.PAPER)

    def leaves():
        cut.Update()
        return cut.GetNumberOfLeaves()

    cut.SetDepth(1)
    check(leaves() == 2, "one plane")
    cut.SetGrowth(0.2)
    check(leaves() == 1, "no plane of any axis adds so few cells")
    cut.SetRotations(2)
    check(leaves() == 2 and cut.GetOutput().GetNumberOfCells() <= 1.2 * bar.GetNumberOfCells(), "one of the bar turned does")
    clamps(cut, "Rotations", 0, 64)
    cut.SetRotations(0)
    cut.SetGrowth(10)
    cut.SetDepth(4)
    sizes = []
    for imbalance in 1.9, 0.1:
        cut.SetImbalance(imbalance)
        leaves()
        sizes.append(cut.GetLargestLeaf() / cut.GetOutput().GetNumberOfCells() * cut.GetNumberOfLeaves())
    check(sizes[0] > sizes[1] >= 1, f"the largest leaf over the mean one, by the sides' allowed difference: {sizes}")
    clamps(cut, "Rule", cut.MEDIAN, cut.PAPER)
    clamps(cut, "Depth", 0, 16)
    clamps(cut, "Planes", 1, 4096)
    errors = []
    cut.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    cut.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    cut.SetDepth(1)
    for name, good in ("Growth", 1), ("Imbalance", 0.5):
        for bad in 0, -1, float("nan"):
            errors.clear()
            getattr(cut, "Set" + name)(bad)
            cut.Update()
            check(len(errors) == 1 and cut.GetOutput().GetNumberOfCells() == 0, f"{name} of {bad} is one error")
        getattr(cut, "Set" + name)(good)
    errors.clear()
    check(leaves() == 2 and not errors, "and good values are none")
    reports(cut, leaves, ["partition"])


def orders():
    cubes = grid((6, 6, 6), vtk.vtkTransform())
    camera = vtk.vtkCamera()
    camera.SetPosition(30, 20, 50)
    sort = stratus.vtkStratusVisibilitySort()
    sort.SetInput(cubes)
    sort.SetCamera(camera)
    sort.SetModelTransform(vtk.vtkMatrix4x4())
    sort.SetMaxCellsReturned(cubes.GetNumberOfCells())

    def order():
        sort.InitTraversal()
        return vtk_to_numpy(sort.GetNextCells()).tolist()

    nearest = order()
    check(sort.GetNumberOfLayers() == 0, "no layers, by default")
    sort.SetPeeling(sort.LAYERS)
    layers = order()
    check(layers != nearest and sorted(layers) == sorted(nearest) and sort.GetNumberOfLayers() > 5, "layers are another order of the same cells")
    sort.SetNumberOfThreads(2)
    check(order() == layers, "threads change nothing")
    sort.SetPeeling(sort.NEAREST)
    check(order() == nearest, "nearest again")
    clamps(sort, "Peeling", sort.NEAREST, sort.LAYERS)
    reports(sort, order, ["visibility order", "visibility signs", "visibility peeling"])


def culled():
    renderer, window, cube = vtk.vtkRenderer(), vtk.vtkRenderWindow(), vtk.vtkCubeSource()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(120, 90)
    window.AddRenderer(renderer)
    for i in range(512):
        mapper, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
        mapper.SetInputConnection(cube.GetOutputPort())
        actor.SetMapper(mapper)
        actor.SetPosition(2 * (i % 8), 2 * (i // 8 % 8), 2 * (i // 64))
        renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(4, 4, 25)
    camera.SetFocalPoint(7, 6, 0)
    camera.SetClippingRange(0.1, 100)
    culler = stratus.vtkStratusOctreeCuller.Install(renderer)
    culler.SetLeafProps(1)

    def nodes():
        for _ in range(3):  # the first frame makes the actors' properties, so that the second asks all of them again and splits nothing
            window.Render()
        return culler.GetNumberOfNodes(renderer)

    split = nodes()
    seen = culler.GetNumberOfVisibleProps()
    check(10 < seen < 512, f"{seen} props are seen")
    culler.SetPixels(1000)
    fewer = nodes()
    check(1 < fewer < split, f"nodes below 1000 pixels stay whole: {fewer} of {split}")
    culler.SetPixels(1e9)
    check(culler.GetPixels() == 1e6 and nodes() == 1, "nodes below a million pixels are split")
    culler.SetPixels(-1)
    check(culler.GetPixels() == 1e-3, "Pixels is at least .001")
    for rule in "Manhattan", "Euclid":
        getattr(culler, "SetStopRuleTo" + rule)()
        check(culler.GetStopRuleAsString().lower() == rule.lower(), f"SetStopRuleTo{rule} is {culler.GetStopRuleAsString()}")
        counts = []
        for factor in -1, 1, 1e9:
            culler.SetDistanceFactor(factor)
            counts.append(nodes())
        check(counts[0] == 1 < counts[1] < counts[2], f"nodes by the distance factor: {counts}")
        check(culler.GetDistanceFactor() == 1e6, "DistanceFactor is at most a million")
    culler.SetStopRuleToStatic()
    every = nodes()
    check(every > split, f"all nodes are split: {every}, by pixels {split}")
    culler.SetMaximumLevel(1)
    check(nodes() == 9, "one level has eight nodes and the root")
    culler.SetMaximumLevel(21)
    culler.SetLeafProps(100)
    check(1 < nodes() < every, "leaves of more props, fewer nodes")
    clamps(culler, "MaximumLevel", 0, 21)
    clamps(culler, "LeafProps", 1, 1048576)
    clamps(culler, "StopRule", culler.STOP_PIXELS, culler.STOP_STATIC)
    clamps(culler, "SortingStyle", culler.SORT_NONE, culler.SORT_BACK_TO_FRONT)
    for name, highest in ("Margin", 1000), ("MinimumCoverage", 1), ("MaximumCoverage", 1):
        kept = getattr(culler, "Get" + name)()
        clamps(culler, name, 0, highest)
        getattr(culler, "Set" + name)(kept)
    culler.SetLeafProps(1)
    culler.SetStopRuleToPixels()
    culler.SetPixels(32)
    check(nodes() == split, "the rule of pixels again")
    for threads in 2, 0, 1:
        culler.SetNumberOfThreads(threads)
        nodes()
        check(culler.GetNumberOfVisibleProps() == seen, f"{threads} threads see {culler.GetNumberOfVisibleProps()} props of {seen}")
    clamps(culler, "NumberOfThreads", 0, 1024)
    culler.SetNumberOfThreads(1)
    for style, number in ("None", 0), ("FrontToBack", 1), ("BackToFront", 2):
        getattr(culler, "SetSortingStyleTo" + style)()
        check(culler.GetSortingStyle() == number, f"SetSortingStyleTo{style} is {culler.GetSortingStyle()}")
    # Large boxes past a narrow frustum's corners. A test of only the frustum's planes does not cull them.
    camera.SetViewAngle(4)
    for i in range(200):
        mapper, actor = vtk.vtkPolyDataMapper(), vtk.vtkActor()
        mapper.SetInputConnection(cube.GetOutputPort())
        actor.SetMapper(mapper)
        actor.SetScale(30, 30, 30)
        actor.SetPosition(4 + 25 * numpy.cos(i), 4 + 25 * numpy.sin(i), 2 * (i % 20) - 30)
        renderer.AddActor(actor)

    def visible():
        nodes()
        return culler.GetNumberOfVisibleProps()

    switches(culler, "Exact", visible)
    culler.ExactOff()
    loose = visible()
    culler.ExactOn()
    check(visible() < loose, "exact tests keep more")

    def asked():
        nodes()
        renderer.GetActors().GetLastActor().GetMapper().Modified()
        window.Render()
        return culler.GetNumberOfPropsAsked()

    switches(culler, "StaticProps", asked)


def files():
    name = os.path.join(folder, "setters")
    contents = {
        "node": "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n",
        "ele": "1 4 0\n1 1 2 3 4\n",
        "face": "2 0\n1 1 2 3\n2 1 2 4\n",
        "edge": "1 0\n1 1 2\n",
        "neigh": "1 4\n1 -1 -1 -1 -1\n",
    }
    for extension, text in contents.items():
        with open(name + "." + extension, "w") as file:
            file.write(text)
    reader = stratus.vtkStratusTetGenReader()
    reader.SetFileName(name + ".ele")

    def read():
        reader.Update()
        mesh, surface = reader.GetOutput(), reader.GetSurface()
        return surface.GetNumberOfPolys(), surface.GetNumberOfLines(), mesh.GetCellData().GetNumberOfArrays()

    whole = read()
    check(whole[:2] == (2, 1) and whole[2] > 0, f"two faces, an edge, and neighbours: {whole}")
    for name_, index in ("ReadFaces", 0), ("ReadEdges", 1), ("ReadNeighbors", 2):
        switches(reader, name_, read)
        getattr(reader, name_ + "Off")()
        less = read()
        check(less[index] < whole[index] and all(less[i] == whole[i] for i in range(3) if i != index), f"{name_}Off: {less} of {whole}")
        getattr(reader, name_ + "On")()
        check(read() == whole, f"{name_}On brings all back")
    for extension in contents:
        os.remove(name + "." + extension)


def filled():
    cube = vtk.vtkCubeSource()
    cube.SetXLength(8)
    fill = stratus.vtkStratusTetGenFilter()
    fill.SetInputConnection(cube.GetOutputPort())
    quality = vtk.vtkMeshQuality()
    quality.SetTetQualityMeasureToMinAngle()

    def cells():
        fill.Update()
        return fill.GetOutput().GetNumberOfCells()

    def angle():
        fill.Update()
        quality.SetInputData(fill.GetOutput())
        quality.Update()
        return vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality")).min()

    switches(fill, "Quality", cells)
    fill.QualityOn()
    fill.SetRadiusEdgeRatio(3)
    plain = angle()
    fill.SetMinimumDihedralAngle(15)
    check(plain < 15 <= angle() + 1e-9, f"angles from 15 degrees on: {plain}, {angle()}")
    fill.SetMinimumDihedralAngle(0)
    fill.SetMaximumVolume(0.05)
    switches(fill, "PreserveBoundary", lambda: (fill.Update(), fill.GetBoundary().GetNumberOfPoints())[1])
    fill.PreserveBoundaryOff()
    fill.AddRegion(0, 0, 0, 7.5)
    cells()
    check((vtk_to_numpy(fill.GetOutput().GetCellData().GetArray("Region")) == 7.5).all() and fill.GetNumberOfRegions() == 1, "the region's value")
    fill.RemoveAllRegions()
    cells()
    region = fill.GetOutput().GetCellData().GetArray("Region")
    check(fill.GetNumberOfRegions() == 0 and (region is None or (vtk_to_numpy(region) != 7.5).all()), "a region that is gone")


trees()
distances()
partitions()
orders()
culled()
files()
if hasattr(stratus, "vtkStratusTetGenFilter"):
    filled()
sys.exit(1 if failures else 0)
