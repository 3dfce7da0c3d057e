# SPDX-License-Identifier: BSD-3-Clause
"""stratus_volume's tetrahedra, distance fields, trees and first hits over arrays, against brute force and against the same volume."""
import warnings

from checking import check, done, refuse
from lattice import cubes

import numpy

from stratus_volume import NothingShown, Tetrahedra, Tree, Volume, distance_field, first_hits, render, render_tetrahedra, show

warnings.simplefilter("error")


def apart(a, b):
    return float(numpy.abs(a.rgba - b.rgba).max())


def unlike(a, b):
    """The mean difference of the lit pixels: trilinear and linear cells of a coarse grid differ at its outline."""
    lit = (a.rgba[..., 3] > 0) | (b.rgba[..., 3] > 0)
    return float(numpy.abs(a.rgba - b.rgba)[lit].mean())


random = numpy.random.default_rng(19)
host = dict(device="host", size=(60, 60))


def distances():
    for shape in (7, 6, 5), (1 + 4, 9, 3):
        solid = random.random(shape) < 0.05
        solid[1, 2, 1] = True
        places = numpy.argwhere(solid)
        every = numpy.stack(numpy.indices(shape), axis=-1)[..., None, :]
        brute = numpy.sqrt(((every - places) ** 2).sum(axis=-1).min(axis=-1))
        for array, what in (solid, "C order"), (numpy.asfortranarray(solid), "Fortran order"), (solid[::-1, :, ::-1][::-1, :, ::-1], "turned twice"):
            found = distance_field(array, device="host")
            check(found.shape == shape and numpy.allclose(found, brute, atol=1e-5), f"distances in {what}")
        outside = numpy.stack(numpy.nonzero(~solid), axis=-1)
        inner = numpy.sqrt(((every - outside) ** 2).sum(axis=-1).min(axis=-1))
        check(numpy.allclose(distance_field(solid, signed=True, device="host"), brute - inner, atol=1e-5), "signed distances")
        values = numpy.where(solid, 5.0, 1.0)
        for lower, upper, scale in (4, None, 1), (4, 6, 1), (4e300, None, 1e300), (4e-308, 6e-308, 1e-308):
            found = distance_field(values * scale, lower, upper, device="host")
            check(numpy.allclose(found, brute, atol=1e-5), f"of values in {lower}..{upper}")
        masked = numpy.ma.masked_array(numpy.full(shape, 5.0), ~solid)
        check(numpy.allclose(distance_field(masked, device="host"), brute, atol=1e-5), "of values that are not masked")
        jumped = distance_field(solid, method="jfa", device="host")
        check((jumped >= brute - 1e-5).all() and (jumped <= brute + 2).all(), "a jump flooding never underestimates")
    check(numpy.isinf(distance_field(numpy.zeros((4, 4, 4), bool), device="host")).all(), "infinite where nothing is effective")
    refuse(ValueError, "euclid", distance_field, numpy.zeros((4, 4, 4)), method="euclid")
    refuse(ValueError, "lower is 3", distance_field, numpy.zeros((4, 4, 4)), 3, 2)
    refuse(TypeError, "lower", distance_field, numpy.zeros((4, 4, 4)), "x")
    refuse(TypeError, "depth", distance_field, numpy.zeros((4, 4, 4)), depth=3)


def brute_hit(solid, origin, direction, spacing):
    """The smallest t at which the ray enters a box about an effective voxel's centre."""
    best, voxel = numpy.inf, (-1, -1, -1)
    for k, j, i in numpy.argwhere(solid):
        centre = numpy.array([i, j, k]) * spacing
        with numpy.errstate(divide="ignore"):
            a, b = (centre - spacing / 2 - origin) / direction, (centre + spacing / 2 - origin) / direction
        near, far = numpy.minimum(a, b).max(), numpy.maximum(a, b).min()
        if max(near, 0) <= far and max(near, 0) < best:
            best, voxel = max(near, 0), (k, j, i)
    return best, voxel


def hits():
    shape, spacing = (6, 8, 7), numpy.array([1.0, 0.5, 2.0])
    solid = random.random(shape) < 0.04
    origins = random.uniform(-12, -6, (40, 3)) * [1, 1, 2]
    aims = random.random((40, 3)) * [7, 4, 12]
    wanted = [brute_hit(solid, origin, aim - origin, spacing) for origin, aim in zip(origins, aims)]
    check(sum(numpy.isfinite(t) for t, _ in wanted) > 5 and sum(numpy.isinf(t) for t, _ in wanted) > 5, "some rays hit, and some do not")
    for array, axes, what in (solid, "zyx", "C order"), (numpy.asfortranarray(solid), "zyx", "Fortran order"), \
            (numpy.ascontiguousarray(solid.transpose(2, 1, 0)), "xyz", "xyz"):
        for method in "auto", "hybrid", "octant", "sah", "wide":
            found = Tree(array, method=method, spacing=spacing, axes=axes, device="host").first_hits(origins, aims - origins)
            check(numpy.allclose(found.t, [t for t, _ in wanted]), f"{what}, {method}: where rays enter")
            voxels = found.voxel if axes == "zyx" else found.voxel[:, ::-1]
            check(numpy.array_equal(voxels, [voxel for _, voxel in wanted]), f"{what}, {method}: the array's own indices")
    once = first_hits(solid, origins, aims - origins, spacing=spacing, device="host")
    tree = Tree(solid, spacing=spacing, device="host")
    again = Tree.load(tree.save(), device="host").first_hits(origins, aims - origins)
    for name in once._fields:
        check(numpy.array_equal(getattr(once, name), getattr(again, name)), f"saved and loaded, {name}")
    check(tree.statistics["voxels"] == solid.sum() and tree.statistics["method"] != "auto", f"statistics: {tree.statistics}")
    one = tree.first_hits(origins[0], (aims - origins).reshape(4, 10, 3))
    check(one.t.shape == (4, 10) and one.voxel.shape == one.normal.shape == (4, 10, 3), "one origin for many, shapes of one's own")
    hit = numpy.isfinite(once.t)
    check(numpy.allclose(numpy.linalg.norm(once.normal[hit], axis=1), 1, atol=1e-6) and (once.face[~hit] == -1).all(), "normals and faces")
    check(numpy.isinf(tree.first_hits(origins, aims - origins, t_max=1e-3).t).all(), "t_max ends rays")
    refuse(ValueError, "ray", tree.first_hits, origins, origins * 0)
    refuse(ValueError, "(40, 2)", tree.first_hits, origins[:, :2], aims)
    refuse(ValueError, "method", Tree, solid, method="bush")
    refuse(ValueError, "max_depth", Tree, solid, max_depth=100)
    refuse(ValueError, "", Tree.load, b"no tree at all")


def tetrahedra():
    shape = (9, 10, 11)
    places, cells = cubes(shape)
    centre = numpy.array([5, 4.5, 4])
    values = numpy.maximum(0, 1 - ((places - centre) ** 2).sum(axis=1) / 16)
    points = [(0, 0), (0.2, 0), (1, 0.6)]
    mesh = render_tetrahedra(places, cells, values, opacity=points, **host)
    volume = render(values.reshape(shape), opacity=points, **host)
    check(unlike(mesh, volume) < 0.02 and mesh.rgba[30, 30, 3] > 0.5, f"the mesh of a volume looks as the volume does: {unlike(mesh, volume)}")
    check(mesh.counters["shown_cells"] == len(cells) and mesh.counters["method"] in ("march", "project"), f"counters: {mesh.counters}")
    lattice = render_tetrahedra(places.reshape(*shape, 3), None, values.reshape(shape), opacity=points, **host)
    check(apart(lattice, mesh) < 0.02, f"a curvilinear grid is its tetrahedra: {apart(lattice, mesh)}")
    for kind in numpy.int64, numpy.uint32, ">i4":
        check(apart(render_tetrahedra(places, cells.astype(kind), values, opacity=points, **host), mesh) == 0, f"tetrahedra of {kind}")
    kept = Tetrahedra(places, cells.astype(numpy.int32), values.astype(numpy.float32), device="host")
    check(numpy.shares_memory(kept.points, places), "points are not copied")
    kept.render(size=(60, 60))
    check(kept.render(size=(60, 60), camera=dict(azimuth=90)).counters["mesh_builds"] == 1, "a camera's move builds no mesh anew")
    check(apart(render(kept, opacity=points, size=(60, 60)), mesh) < 1e-3, "and render takes it")
    for method in "march", "project":
        check(apart(render_tetrahedra(places, cells, values, opacity=points, method=method, **host), mesh) < 0.02, method)
    for option in dict(mode="maximum"), dict(mode="isosurface", contours=[0.5]), dict(shade=True), dict(crop=(0, 5, 0, 9, 0, 8)), \
            dict(clip_planes=[(1, 0, 0, -5)]), dict(unit_distance=3):
        check(apart(render_tetrahedra(places, cells, values, opacity=points, **option, **host), mesh) > 0.01, f"{option} changes the picture")

    hidden = places[:, 0] < 4
    holes = render_tetrahedra(places, cells, numpy.where(hidden, numpy.nan, values), opacity=points, **host)
    check(apart(holes, mesh) > 0.1, "NaN hides its cells")
    for fill in 0, 1e30, 1e300:
        masked = numpy.ma.masked_array(numpy.where(hidden, fill, values), hidden)
        check(apart(render_tetrahedra(places, cells, masked, opacity=points, **host), holes) == 0, f"masked {fill} as NaN")
    bytes_points = [(0, 0), (20, 0), (100, 0.6)]
    whole = numpy.ma.masked_array(numpy.where(hidden, 255, 100 * values).astype(numpy.uint8), hidden)
    as_nan = numpy.where(hidden, numpy.nan, (100 * values).astype(numpy.uint8)).astype(numpy.float32)
    check(apart(render_tetrahedra(places, cells, whole, opacity=bytes_points, **host),
                render_tetrahedra(places, cells, as_nan, opacity=bytes_points, **host)) < 5e-3, "masked bytes")
    lattice_masked = numpy.ma.masked_array(whole.data.reshape(shape), hidden.reshape(shape))
    check(apart(render_tetrahedra(places.reshape(*shape, 3), None, lattice_masked, opacity=bytes_points, **host),
                render_tetrahedra(places.reshape(*shape, 3), None, as_nan.reshape(shape), opacity=bytes_points, **host)) < 5e-3,
          "masked points of a grid")
    for factor in 1e300, 1e-300, 2.0**-1030:
        scaled = render_tetrahedra(places, cells, values * factor, opacity=[(value * factor, part) for value, part in points], **host)
        check(apart(scaled, mesh) < 3e-3, f"values times {factor}: {apart(scaled, mesh)}")
    of_cells = render_tetrahedra(places, cells, values[cells].mean(axis=1), opacity=points, **host)
    check(apart(of_cells, mesh) < 0.3 and of_cells.rgba[30, 30, 3] > 0.5, "values of cells")
    for values_of, words in (numpy.full(len(places), numpy.nan), "none of the 990"), (values, "only in 2..3"):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            render_tetrahedra(places, cells, values_of, opacity=[(0, 0), (2, 0), (3, 1)], **host)
        check(len(caught) == 1 and caught[0].category is NothingShown and words in str(caught[0].message) and caught[0].filename == __file__,
              f"one warning: {[str(one.message) for one in caught]}")
    refuse(ValueError, "(990, 2)", render_tetrahedra, places[:, :2], cells, values)
    refuse(ValueError, "0..989", render_tetrahedra, places, cells + 1, values)
    refuse(ValueError, "(4320, 3)", render_tetrahedra, places, cells[:, :3], values)
    refuse(ValueError, "(989,)", render_tetrahedra, places, cells, values[1:])
    refuse(TypeError, "values is None", Tetrahedra, places, cells)
    refuse(ValueError, "finite", render_tetrahedra, numpy.where(places == 3, numpy.nan, places), cells, values, **host)
    refuse(ValueError, "crop", render_tetrahedra, places, cells, values, crop=(1, 0, 0, 1, 0, 1), **host)
    refuse(TypeError, "structure", render_tetrahedra, places, cells, values, structure="none")


def vtk():
    try:
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkImageData, vtkStructuredGrid
        from vtkmodules.vtkFiltersCore import vtkAppendFilter
    except ImportError:
        print("without data sets of VTK: no vtkmodules here")
        return
    shape = (9, 10, 11)
    places, cells = cubes(shape)
    values = numpy.maximum(0, 1 - ((places - [5, 4.5, 4]) ** 2).sum(axis=1) / 16)
    points = [(0, 0), (0.2, 0), (1, 0.6)]
    wanted = render_tetrahedra(places, cells, values, opacity=points, **host)
    image = vtkImageData()
    image.SetDimensions(shape[::-1])
    flat = numpy_to_vtk(values)
    flat.SetName("density")
    image.GetPointData().SetScalars(flat)
    append = vtkAppendFilter()
    append.AddInputData(image)
    append.Update()
    picture = render(append.GetOutput(), opacity=points, **host)
    check(unlike(picture, wanted) < 0.02 and picture.rgba[30, 30, 3] > 0.5, f"a grid of voxels is divided: {unlike(picture, wanted)}")
    check(show(append.GetOutput(), scalars="density", device="host", size=(40, 30)).shape == (30, 40, 4), "show, by its array's name")
    grid, own = vtkStructuredGrid(), vtkPoints()
    own.SetData(numpy_to_vtk(places))
    grid.SetDimensions(shape[::-1])
    grid.SetPoints(own)
    grid.GetPointData().SetScalars(flat)
    check(apart(render(grid, opacity=points, **host), wanted) < 0.02, "a structured grid")
    refuse(ValueError, "wind", render, grid, scalars="wind")
    refuse(ValueError, "spacing", render, grid, spacing=(1, 1, 1))
    check(Volume(image).grid is not None, "an image is a volume")


distances()
hits()
tetrahedra()
vtk()
done()
