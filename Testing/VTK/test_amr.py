# SPDX-License-Identifier: BSD-3-Clause
"""AMR: the mapper's grids hold the field and the gradients that brute force finds, side by side; the picture equals the picture of one fine grid of this field,
and is near the function's own; light has no seams; unsupported data is refused."""
import os
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [here, os.path.join(here, os.pardir, "Python")]
from checking import check, done

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus
from refined import Refined, bump, uneven

FEW = os.environ.get("STRATUS_FEW", "0") != "0"
SPACING, ORIGIN = (1.0, 0.9, 1.1), (0.3, -0.2, 0.1)


class Scene:
    def __init__(self, mapper, data, nearest=False):
        self.mapper, self.errors = mapper, []
        mapper.SetInputDataObject(data)
        settings = mapper.GetSettings() if hasattr(mapper, "GetSettings") else mapper
        settings.SetDevice("host")
        settings.SetImageErrorTolerance(2e-4)
        mapper.AddObserver("ErrorEvent", self.note)
        mapper.AddObserver("WarningEvent", self.note)
        self.volume = vtk.vtkVolume()
        self.volume.SetMapper(mapper)
        self.property = self.volume.GetProperty()
        self.property.SetInterpolationType(vtk.VTK_NEAREST_INTERPOLATION if nearest else vtk.VTK_LINEAR_INTERPOLATION)
        colors, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
        for value, *rgb in (0, 0.1, 0.2, 0.9), (0.5, 0.9, 0.9, 0.8), (1.2, 1, 0.5, 0.1):
            colors.AddRGBPoint(value, *rgb)
        for value, alpha in (0.08, 0), (0.3, 0.02), (0.9, 0.6):
            opacity.AddPoint(value, alpha)
        self.property.SetColor(colors)
        self.property.SetScalarOpacity(opacity)
        self.renderer, self.window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetSize(220, 180)
        self.window.AddRenderer(self.renderer)
        self.renderer.AddVolume(self.volume)

    @vtk.calldata_type(vtk.VTK_STRING)
    def note(self, _, __, text):
        self.errors.append(text)

    def picture(self, azimuth, elevation=20, parallel=False, inside=False):
        """RGBA in floats."""
        camera = self.renderer.GetActiveCamera()
        center = numpy.array(ORIGIN) + 0.5 * numpy.array(SPACING) * (16, 12, 10)
        camera.SetFocalPoint(*center)
        camera.SetPosition(*(center + (0, 0, 5 if inside else 30)))
        camera.SetViewUp(0, 1, 0)
        camera.SetParallelProjection(parallel)
        camera.SetParallelScale(9)
        camera.Azimuth(azimuth)
        camera.Elevation(elevation)
        self.renderer.ResetCameraClippingRange()
        self.window.Render()
        image = self.mapper.GetLastImage()
        return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(-1, 4) if image else None


def blocks():
    return stratus.vtkStratusMultiBlockVolumeMapper()


def planes(grid):
    if grid.IsA("vtkImageData"):
        return [o + h * numpy.arange(n) for o, h, n in zip(grid.GetOrigin(), grid.GetSpacing(), grid.GetDimensions())]
    return [vtk_to_numpy(axis) for axis in (grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates())]


def along(values, places, axis):
    """Values at all whole places from the first to the last one, linear between those that are given along an axis."""
    values, all_places = numpy.moveaxis(values, axis, 0), numpy.arange(places[0], places[-1] + 1)
    cell = numpy.clip(numpy.searchsorted(places, all_places, "right") - 1, 0, len(places) - 2)
    share = ((all_places - places[cell]) / (places[cell + 1] - places[cell])).reshape(-1, 1, 1)
    return numpy.moveaxis(values[cell] * (1 - share) + values[cell + 1] * share, 0, axis)


def grids_of(scene):
    settings = scene.mapper.GetSettings()
    settings.SetImageErrorTolerance(0.05)  # on which the grids do not depend
    scene.picture(30)
    settings.SetImageErrorTolerance(2e-4)
    check(not scene.errors, f"no complaint: {scene.errors}")
    return [scene.mapper.GetBlockMapper(i).GetInputDataObject(0, 0) for i in range(scene.mapper.GetNumberOfBlocks())]


def gradients_of(grid):
    """The derivatives along each axis, behind the values in one array."""
    array = vtk_to_numpy(grid.GetFieldData().GetArray("StratusGradients"))
    return [part.reshape(grid.GetDimensions(), order="F") for part in numpy.split(array[-3 * grid.GetNumberOfPoints() :], 3)]


def judge_field(ratios, cells, counts=(16, 12, 10), boxes=None):
    """Each drawn value equals brute force's; the grids fill the space once, and hold kinks only at their planes."""
    data = Refined(boxes or uneven(ratios), ratios, counts, SPACING, cells, origin=ORIGIN)
    meant = data.field()
    check(numpy.isfinite(meant).all(), "brute force leaves no hole")
    unit = data.spacing / data.scales[-1] / 2
    slopes = data.gradient()
    volume, levels = 0.0, set()
    scene = Scene(blocks(), data.data(vtk))
    scene.property.ShadeOn()
    for grid in grids_of(scene):
        places = [numpy.rint((axis - o) / h).astype(int) for axis, o, h in zip(planes(grid), data.origin, unit)]
        drawn = vtk_to_numpy(grid.GetPointData().GetScalars()).reshape(grid.GetDimensions(), order="F")
        error = abs(drawn - meant[numpy.ix_(*places)]).max()  # floats
        check(error < 1e-7, f"ratios {ratios}, cells {cells}: values differ by {error}")
        for axis, own in enumerate(gradients_of(grid)):
            error = abs(own - slopes[numpy.ix_(*places)][..., axis]).max()
            check(error < 1e-5, f"ratios {ratios}, cells {cells}: derivatives along {axis} differ by {error}")
        fine = drawn.astype(float)
        for axis, at in enumerate(places):  # the grid's own interpolation
            fine = along(fine, at, axis)
        part = meant[tuple(slice(at[0], at[-1] + 1) for at in places)]
        check(abs(fine - part).max() < 1e-7, f"ratios {ratios}, cells {cells}: between values {abs(fine - part).max()}")
        volume += numpy.prod([at[-1] - at[0] for at in places])
        levels.add(max(numpy.diff(places[0])))
    check(volume == numpy.prod(2 * data.scales[-1] * data.counts), f"ratios {ratios}, cells {cells}: the grids fill {volume} units")
    return levels


def fields():
    for ratios, cells in (((3, 2), True), ((2, 3), False), ((2, 2), True), ((2, 2), False), ((4, 1), True))[: 2 if FEW else None]:
        judge_field(ratios, cells)
    # A large box of one level, so that its core is taken apart from its border, and coarse cells stay coarse.
    wide = [(0, (0, 0, 0), (60, 40, 40)), (1, (30, 4, 4), (120, 76, 76))]
    levels = judge_field((2,), True, (60, 40, 40), wide)
    check(levels == {1, 2, 4}, f"parts of the finer level, cores of it and coarse cells: {levels}")


def pieces():
    """Boxes that share the space: each has its part of the field."""
    data = Refined(uneven(), spacing=SPACING, origin=ORIGIN)
    meant, amr = data.field(), data.data(vtk)
    for count in 2, 3:
        volume = 0.0
        for piece in range(count):
            scene = Scene(blocks(), amr)
            scene.mapper.SetNumberOfPieces(count)
            scene.mapper.SetPiece(piece)
            box = numpy.array([numpy.inf, -numpy.inf] * 3)
            for grid in grids_of(scene):
                places = [numpy.rint((axis - o) / h * 8).astype(int) for axis, o, h in zip(planes(grid), ORIGIN, SPACING)]
                drawn = vtk_to_numpy(grid.GetPointData().GetScalars()).reshape(grid.GetDimensions(), order="F")
                check(abs(drawn - meant[numpy.ix_(*places)]).max() < 1e-7, f"piece {piece} of {count}: its part of the field")
                volume += numpy.prod([at[-1] - at[0] for at in places])
                box[::2], box[1::2] = numpy.minimum(box[::2], grid.GetBounds()[::2]), numpy.maximum(box[1::2], grid.GetBounds()[1::2])
            check(numpy.allclose(scene.mapper.GetBounds(), box), f"piece {piece} of {count}: bounds {scene.mapper.GetBounds()}, {box}")
        check(volume == meant[1:, 1:, 1:].size, f"{count} pieces fill the space: {volume}")
    scene = Scene(blocks(), amr)
    scene.mapper.SetNumberOfPieces(400)
    scene.mapper.SetPiece(399)
    scene.picture(0)
    check(not scene.errors, "a piece of nothing")


def constant():
    """Nearest interpolation: each place has its finest cell's value, whatever its type."""
    data = Refined(uneven(), function=lambda x, y, z: numpy.floor(50 * bump(x, y, z)), spacing=SPACING, origin=ORIGIN)
    finest = numpy.full(data.counts * 4, -1.0)
    for values, shown, scale in zip(data.values, data.shown, data.scales):
        finest[numpy.kron(shown, numpy.ones(3 * (4 // scale,))).astype(bool)] = numpy.kron(values, numpy.ones(3 * (4 // scale,)))[
            numpy.kron(shown, numpy.ones(3 * (4 // scale,))).astype(bool)]
    filled = 0
    for grid in grids_of(Scene(blocks(), data.data(vtk, kind=numpy.uint8), nearest=True)):
        at = [numpy.rint((axis - o) / (h / 4)).astype(int) for axis, o, h in zip(planes(grid), ORIGIN, SPACING)]
        array = grid.GetCellData().GetScalars()
        drawn = vtk_to_numpy(array).reshape([len(axis) - 1 for axis in at], order="F")
        check(array.GetDataType() == vtk.VTK_UNSIGNED_CHAR, "the data's type")
        for axis, ends in enumerate(at):
            drawn = numpy.repeat(drawn, numpy.diff(ends), axis)
        check((drawn == finest[tuple(slice(a[0], a[-1]) for a in at)]).all(), "nearest: the finest cell's value")
        filled += drawn.size
    check(filled == finest.size, "nearest: the grids fill the space")


def vectors():
    """The magnitude of vectors of one direction is lit as the scalar is that they are multiples of, and so is one component."""
    pictures = []
    for parts, mode in ((1.0,), -1), ((0.6, 0.8), 0), ((0.0, 1.0), 1):
        amr = Refined(uneven()).data(vtk)
        for level in range(3):
            for box in range(2):
                data = amr.GetDataSet(level, box).GetCellData()
                array = numpy_to_vtk(numpy.outer(vtk_to_numpy(data.GetScalars()), parts), deep=True)
                array.SetName("values")
                data.SetScalars(array)
        scene = Scene(blocks(), amr)
        scene.property.ShadeOn()
        scene.mapper.GetSettings().SetVectorMode(mode)
        scene.mapper.GetSettings().SetVectorComponent(1)
        scene.mapper.GetSettings().SetImageErrorTolerance(1e-3)
        pictures.append(scene.picture(20).copy())
        check(not scene.errors, f"no complaint: {scene.errors}")
    for name, other in zip(("magnitude", "component"), pictures[1:]):
        difference = abs(pictures[0] - other).max()
        check(difference < 1e-3 and other.max() > 0.3, f"{name}: lit otherwise than the scalar, by {difference}")


def cuts():
    """First hits behind a plane on faces of cells show the cells behind it, as behind a plane a hair farther."""
    pictures = []
    for x in 8.0, 8.0 + 1e-7:
        scene = Scene(blocks(), Refined(uneven()).data(vtk))
        scene.mapper.GetSettings().SetRenderModeToFirstHit()
        plane = vtk.vtkPlane()
        plane.SetOrigin(x, 0, 0)
        plane.SetNormal(1, 0, 0)
        scene.mapper.AddClippingPlane(plane)
        pictures.append([scene.picture(azimuth, 20).copy() for azimuth in (-60, 60, -100, 100)])
        check(not scene.errors, f"no complaint: {scene.errors}")
    differing = [int((abs(a - b).max(-1) > 1e-3).sum()) for a, b in zip(*pictures)]
    check(min(a.any(-1).sum() for a in pictures[0]) > 1000 and max(differing) < 5, f"pixels that show cells beyond the plane: {differing}")


def image_of(values, halves):
    image = vtk.vtkImageData()
    image.SetDimensions(*values.shape)
    image.SetOrigin(*ORIGIN)
    image.SetSpacing(*[h / halves for h in SPACING])
    image.GetPointData().SetScalars(numpy_to_vtk(numpy.ascontiguousarray(values.reshape(-1, order="F")), deep=True))
    return image


def pictures():
    """Errors in 1/255, root mean square over pixels where something shows, and the largest."""
    data = Refined(uneven(), spacing=SPACING, origin=ORIGIN)
    fine = numpy.meshgrid(*[o + h / 8 * numpy.arange(8 * n + 1) for o, h, n in zip(ORIGIN, SPACING, data.counts)], indexing="ij")
    refined = Scene(blocks(), data.data(vtk))
    points = Scene(blocks(), Refined(uneven(), spacing=SPACING, origin=ORIGIN, cells=False).data(vtk))
    meant = Scene(stratus.vtkStratusVolumeMapper(), image_of(data.field(), 8))
    exact = Scene(stratus.vtkStratusVolumeMapper(), image_of(bump(*fine), 8))
    coarse = Scene(stratus.vtkStratusVolumeMapper(), image_of(bump(*[axis[::8, ::8, ::8] for axis in fine]), 1))
    for view in (20, 10, False), (115, -35, True), (75, 5, False, True):
        parts = [scene.picture(*view) for scene in (refined, meant, exact, points, coarse)]
        check(not refined.errors + points.errors, f"no complaint: {refined.errors}")
        shown = parts[2][:, 3] > 0.004
        check(shown.sum() > 3000, "something shows")
        error = {name: 255 * abs(parts[a] - parts[b])[shown] for name, a, b in
                 (("itself", 0, 1), ("function", 0, 2), ("of points", 3, 2), ("only level 0", 4, 2))}
        print(view, {name: f"{(e**2).mean() ** 0.5:.3f}, {e.max():.2f}" for name, e in error.items()})
        check((error["itself"] ** 2).mean() ** 0.5 < 2 * 2e-4 * 255 and error["itself"].max() < 1.0, f"{view}: the field's own picture")
        rms = {name: (e**2).mean() ** 0.5 for name, e in error.items()}
        check(rms["function"] < 2 and rms["of points"] < 2, f"{view}: near the function's picture")
        check(rms["function"] < 0.15 * rms["only level 0"], f"{view}: finer levels count")


def seams():
    """Light across borders of levels: grids that meet have the same gradients there, wherever between their values, and a smooth lit surface shows no border.
    The same grids with gradients of their own differences show them."""
    wave = lambda x, y, z: z - 0.12 * numpy.cos(2.6 * x) - 0.1 * numpy.sin(2.4 * y)
    spacing = numpy.array(SPACING) * (16 / 60, 12 / 40, 10 / 40)
    data = Refined([(0, (0, 0, 0), (60, 40, 40)), (1, (30, 4, 4), (120, 76, 76))], (2,), (60, 40, 40), spacing, origin=ORIGIN, function=wave)
    scene = Scene(blocks(), data.data(vtk))
    scene.mapper.SetBlendModeToIsoSurface()
    scene.property.ShadeOn()
    scene.property.SetAmbient(0)
    scene.property.SetDiffuse(1)
    scene.property.SetSpecular(0)
    scene.property.GetIsoSurfaceValues().SetValue(0, 5.0)
    white, solid = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    white.AddRGBPoint(0, 1, 1, 1)
    solid.AddPoint(0, 1)
    scene.property.SetColor(white)
    scene.property.SetScalarOpacity(solid)
    grids, worst, met = grids_of(scene), 0.0, 0
    parts = []
    for grid in grids:
        places = [numpy.rint((axis - o) / (h / 4)).astype(int) for axis, o, h in zip(planes(grid), ORIGIN, spacing)]
        fine = []
        for own in gradients_of(grid):
            for axis, at in enumerate(places):
                own = along(own, at, axis)
            fine.append(own)
        parts.append(([(at[0], at[-1]) for at in places], numpy.stack(fine, -1)))
    for n, (box, fine) in enumerate(parts):
        for other, theirs in parts[:n]:
            shared = [(max(a[0], b[0]), min(a[1], b[1])) for a, b in zip(box, other)]
            if all(lo <= hi for lo, hi in shared):
                cuts = [tuple(slice(lo - b[0], hi + 1 - b[0]) for (lo, hi), b in zip(shared, which)) for which in (box, other)]
                worst = max(worst, abs(fine[cuts[0]] - theirs[cuts[1]]).max())
                met += 1
    check(met > 3 and worst < 1e-6, f"gradients of {met} pairs of grids that meet differ by {worst}")
    plain = vtk.vtkMultiBlockDataSet()
    for n, grid in enumerate(grids):
        copy = grid.NewInstance()
        copy.ShallowCopy(grid)
        copy.GetFieldData().Initialize()
        plain.SetBlock(n, copy)
    apart = Scene(blocks(), plain)
    apart.mapper.SetBlendModeToIsoSurface()
    apart.volume.SetProperty(scene.property)
    steps = []
    for one in scene, apart:
        picture = one.picture(0, 40)[:, 0].reshape(180, 220)
        steps.append(255 * abs(numpy.diff(picture[60:120, 45:175], 2, axis=1)).max())  # across the border that is seen from above
    print(f"lit surface: second differences of pixels at most {steps[0]:.2f} of 255; with the grids' own gradients {steps[1]:.2f}")
    check(not scene.errors, f"no complaint: {scene.errors}")
    check(steps[0] < 0.5 * steps[1], f"seams: {steps}")


def refusals():
    def refuses(words, scene):
        scene.picture(0)
        scene.picture(10)
        shown = vtk_to_numpy(scene.mapper.GetLastImage().GetPointData().GetScalars()).any() if scene.mapper.GetLastImage() else False
        check(len(scene.errors) == 1 and words in scene.errors[0] and not shown, f"'{words}' once, and no picture: {scene.errors}")

    def of(boxes, change=None, **more):
        amr = Refined(boxes, **more).data(vtk)
        if change:
            change(amr)
        return Scene(blocks(), amr)

    def without(amr):
        amr.GetDataSet(1, 0).GetCellData().GetScalars().SetName("other")
        amr.GetDataSet(1, 0).GetCellData().SetActiveScalars("")

    def other(amr):
        amr.GetDataSet(1, 0).SetSpacing(0.4, 0.5, 0.5)

    def shorter(amr):
        amr.GetDataSet(0, 0).GetCellData().GetScalars().Resize(7)

    base = [(0, (0, 0, 0), (16, 12, 10))]
    refuses("no whole cells of level 0", of(base + [(1, (3, 4, 4), (10, 10, 10))]))
    refuses("overlaps another box", of(base + [(1, (4, 4, 4), (10, 10, 10)), (1, (8, 4, 4), (12, 10, 10))]))
    refuses("where level 1 has no cells", of(base + [(1, (4, 4, 4), (10, 10, 10)), (2, (4, 4, 4), (12, 12, 12))]))
    refuses("lacks the array", of(uneven(), without))
    refuses("its spacing is 0.4", of(uneven(), other))
    refuses("values for", of(uneven(), shorter))
    refuses("nearest interpolation of AMR's values of points", Scene(blocks(), Refined(uneven(), cells=False).data(vtk), nearest=True))
    apart = vtk.vtkNonOverlappingAMR()
    apart.Initialize(1, [1])
    apart.SetDataSet(0, 0, Refined(base).data(vtk).GetDataSet(0, 0))
    refuses("vtkNonOverlappingAMR", Scene(blocks(), apart))
    single = stratus.vtkStratusVolumeMapper()
    single.GetExecutive().AddObserver("ErrorEvent", lambda *_: errors.append(1))
    errors = []
    Scene(single, Refined(uneven()).data(vtk)).picture(0)
    check(errors, "the mapper of one grid complains")


def follows():
    """Another array, other values and other interpolation are taken; a hidden cell shows nothing; an empty AMR is an empty picture."""
    data = Refined(uneven())
    amr = data.data(vtk)
    scene = Scene(blocks(), amr)
    first = scene.picture(0).copy()
    values = amr.GetDataSet(2, 0).GetCellData().GetScalars()
    kept = vtk_to_numpy(values).copy()
    vtk_to_numpy(values)[:] = 0
    values.Modified()
    check(abs(scene.picture(0) - first).max() > 0.05, "other values are seen")
    vtk_to_numpy(values)[:] = kept
    values.Modified()
    check((scene.picture(0) == first).all(), "and the first ones again")
    grid = amr.GetDataSet(2, 0)
    for cell in range(0, grid.GetNumberOfCells()):
        grid.BlankCell(cell)
    grid.Modified()
    hidden = scene.picture(0)
    check(scene.errors == [] and abs(hidden - first).max() > 0.05 and numpy.isfinite(hidden).all(), "hidden cells show nothing")
    digits = Refined(uneven(), function=lambda x, y, z: 1e6 + 1e-3 * bump(x, y, z)).data(vtk)
    for level in range(2):  # covered cells may hold anything
        for box in range(2):
            covered = vtk_to_numpy(digits.GetDataSet(level, box).GetCellData().GetScalars())
            covered[covered == 77] = 1e36
    drawn = [vtk_to_numpy(grid.GetPointData().GetScalars()) for grid in grids_of(Scene(blocks(), digits))]
    check(all(values.dtype == numpy.float64 and abs(values - 1e6).max() < 2e-3 for values in drawn), "digits of values far from 0 are kept")
    empty = vtk.vtkOverlappingAMR()
    empty.Initialize(1, [0])
    scene = Scene(blocks(), empty)
    scene.picture(0)
    check(scene.errors == [], f"empty: {scene.errors}")


for test in fields, pieces, constant, vectors, cuts, pictures, seams, refusals, follows:
    test()
done()
