# SPDX-License-Identifier: BSD-3-Clause
"""stratus_volume in scenes of pyvista, compared with the volumes that VTK's own mapper draws there. `wheel` runs it where pyvista is installed."""
import gc
import os
import sys
import time
import warnings
import weakref

from checking import Chunks, check, done, refuse
from datasets import Dataset

import numpy
import pyvista
from vtkmodules.vtkCommonDataModel import vtkPlane

import stratus_volume
from stratus_volume.pyvista import add_volume

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
from geodesic import icosphere, mpas

grid = pyvista.Wavelet(extent=(-12, 12, -12, 12, -12, 12))
field = numpy.asarray(grid["RTData"]).reshape(25, 25, 25)


def scene(volume, size=(160, 120), solid=True, parallel=False, shape=(1, 1), **look):
    """The picture of a scene with a ball that is half within the volume, by "stratus", "vtk" or without a volume."""
    plotter = pyvista.Plotter(off_screen=True, window_size=size, shape=shape)
    if shape != (1, 1):
        plotter.subplot(0, 1)
    if solid:
        plotter.add_mesh(pyvista.Sphere(radius=6, center=(8, -8, 8)), color="red", lighting=False)
    if volume == "stratus":
        plotter.stratus.add_volume(grid, show_scalar_bar=False, **look)
    elif volume == "vtk":
        actor = plotter.add_volume(grid, show_scalar_bar=False, mapper="fixed_point", **look)
        actor.prop.interpolation_type = "linear"
        mapper = actor.mapper
        mapper.SetAutoAdjustSampleDistances(0)
        mapper.SetImageSampleDistance(1)
        mapper.SetSampleDistance(0.1)  # its default, a voxel and a half, errs by more than this test's limits
    plotter.camera_position = [(70, -60, 55), (0, 0, 0), (0, 0, 1)]
    if parallel:
        plotter.enable_parallel_projection()
    plotter.renderer.reset_camera_clipping_range()
    picture = plotter.screenshot(return_img=True)[..., :3].astype(int)
    plotter.close()
    return picture


def beside_vtk():
    for words in {}, dict(opacity="sigmoid_5", cmap="viridis"), dict(clim=(100, 250)), dict(opacity=[0, 0.2, 0.9], cmap="plasma"), \
            dict(blending="maximum"), dict(opacity_unit_distance=5), dict(size=(121, 163)), dict(solid=False), dict(parallel=True), \
            dict(opacity=0.05), dict(flip_scalars=True, opacity="linear"), dict(shape=(1, 2)):
        stratus, vtk, without = (scene(each, **words) for each in ("stratus", "vtk", None))
        # VTK's mapper adds light up in 15 bits, and has no part of a pixel at the ball's outline. A shift by a pixel is 9 of 255.
        lit = numpy.abs(vtk - without).max(axis=2) > 8
        apart = numpy.abs(stratus - vtk).mean(axis=2)
        check(lit.sum() > 500, f"{words}: VTK's volume shows in {lit.sum()} pixels")
        check(apart[lit].mean() < 6 and apart[~lit].mean() < 1.5, f"{words}: {apart[lit].mean():.2f} where it shows, {apart[~lit].mean():.2f} elsewhere")


def composited():
    plain = scene(None)
    ball = plain[..., 0] - plain[..., 1] > 3  # the others are white
    without, behind = scene("stratus", opacity="linear"), scene("stratus", opacity="linear", solid=False)
    front = ball & (numpy.abs(without - plain).max(axis=2) < 3)
    check(front.sum() > 20, f"the ball's half before the volume stays as it is: {front.sum()} pixels")
    check((ball & ~front).sum() > 20, "its other half is seen through the volume")
    check(numpy.abs(without - behind)[~ball].max() < 40, "and the rest does not change")


def lives():
    plotter = pyvista.Plotter(off_screen=True, window_size=(100, 80))
    empty = plotter.screenshot(return_img=True).astype(int)
    volume = plotter.stratus.add_volume(grid)
    check("RTData" in plotter.scalar_bars, "a scalar bar with the array's name")
    check(numpy.allclose(plotter.bounds, grid.bounds), f"its bounds count: {plotter.bounds}")
    first = plotter.screenshot(return_img=True).astype(int)
    check(numpy.abs(first - empty).max() > 50 and volume.counters["samples"] > 0, "it shows, and counts")
    check(volume.counters["range_builds"] == 1, "ranges are built once")
    plotter.camera.azimuth += 50
    plotter.render()
    check(volume.counters["range_builds"] == 1 and not numpy.array_equal(plotter.screenshot(return_img=True), first), "a camera's move builds nothing")
    volume.set(mode="maximum")
    check(volume.look["mode"] == "maximum", "a parameter is changed")
    volume.visibility = False
    plotter.render()
    plain = plotter.screenshot(return_img=True).astype(int)
    volume.visibility = True
    plotter.render()
    check(not numpy.array_equal(plain, plotter.screenshot(return_img=True)), "it can be hidden")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        volume.set(structure="bush")
        volume.set(structure="none")
    check(any("bush" in str(one.message) for one in caught), "a failure within a frame is a warning")
    shear = numpy.eye(4)
    shear[0, 1] = 1
    volume.user_matrix = shear
    plotter.render()
    check(numpy.array_equal(volume.user_matrix, shear) and volume.bounds[1] == 24 and numpy.allclose(plotter.bounds[:2], (-24, 24)), "it can be moved")
    volume.remove()
    after = plotter.screenshot(return_img=True).astype(int)
    check(numpy.abs(after - empty).max() <= 1 and not plotter.scalar_bars, f"and taken away: {numpy.abs(after - empty).max()}")
    for words in dict(blending="glow"), dict(opacity=2), dict(clim=(3, 1)), dict(culling="sides"), dict(preference="edge", scalars=numpy.arange(15625)), \
            dict(scalars=numpy.arange(7)), dict(scalars=numpy.zeros((15625, 3))):
        refuse(ValueError, next(iter(words)), plotter.stratus.add_volume, grid, **words)
    refuse(ValueError, "scalars", plotter.stratus.add_volume, grid, scalars="wind")
    refuse(TypeError, "mapper", plotter.stratus.add_volume, grid, mapper="ray")
    refuse(TypeError, "PolyData", plotter.stratus.add_volume, pyvista.Sphere())
    refuse(ValueError, "3), (4, 4)", plotter.stratus.add_volume, grid, user_matrix=numpy.eye(5))
    check(len(plotter.stratus.volumes) == 0, "what is refused leaves nothing")
    plotter.close()
    check(not plotter.__dict__["stratus"].volumes, "nothing is left of a closed plotter")


def named():
    plotter = pyvista.Plotter(off_screen=True, window_size=(100, 80))
    first = plotter.stratus.add_volume(grid, name="one", show_scalar_bar=False)
    plotter.camera.azimuth = 30
    seen = plotter.camera_position
    second = plotter.stratus.add_volume(grid.copy(), name="one", cmap="gray", show_scalar_bar=False, reset_camera=False)
    check(plotter.stratus.volumes == [second] and first._layer is None, "a volume replaces the one of its name")
    check(plotter.camera_position == seen, "and the camera stays")
    plotter.close()


def words():
    """Words of pyvista's that change the functions: the same picture as by VTK's mapper."""
    plain = scene(None)
    alpha = numpy.linspace(0, 200, grid.n_points)
    rgba = numpy.stack([field.ravel() / 277 * 255, 255 - field.ravel() / 277 * 255, numpy.full(grid.n_points, 90), alpha], axis=1).astype(numpy.uint8)
    turned = numpy.array([[1.2, -0.9, 0, 2], [0.9, 1.2, 0, 0], [0, 0, 1.5, -3], [0, 0, 0, 1]])
    for more in dict(log_scale=True), dict(n_colors=5), dict(scalars=rgba), dict(user_matrix=turned), dict(clim=200.0), dict(categories=7), \
            dict(cmap=pyvista.LookupTable("magma", alpha_range=(0, 0.9), scalar_range=(50, 250))), dict(scalars=field.ravel()[::-1]), dict(opacity="foreground"), \
            dict(cmap=["red", "white", "blue"]):
        stratus, vtk = scene("stratus", **more), scene("vtk", **more)
        lit = numpy.abs(vtk - plain).max(axis=2) > 8
        # Without the outline, which is a part of a pixel elsewhere by VTK's mapper: opaque and dark parts end sharply there.
        inside = lit & numpy.roll(lit, 1, 0) & numpy.roll(lit, -1, 0) & numpy.roll(lit, 1, 1) & numpy.roll(lit, -1, 1)
        apart = numpy.abs(stratus - vtk).mean(axis=2)
        check(inside.sum() > 500 and apart[inside].mean() < 6 and apart[~lit].mean() < 1.5,
              f"{list(more)}: {apart[inside].mean():.2f} where it shows in {inside.sum()} pixels, {apart[~lit].mean():.2f} elsewhere")


def reacts():
    """Changes of pyvista's table, property and mapper show in the next frame, and the last frame has no trace of them."""
    def picture(change=None, **look):
        plotter = pyvista.Plotter(off_screen=True, window_size=(120, 90))
        # A table whose colours differ for the smallest differences.
        volume = plotter.stratus.add_volume(grid, show_scalar_bar=False, **{**dict(opacity="foreground", cmap="flag"), **look})
        plotter.camera_position = [(70, -60, 55), (0, 0, 0), (0, 0, 1)]
        plotter.renderer.reset_camera_clipping_range()
        plotter.render()
        if change is not None:
            change(volume)
        result = plotter.screenshot(return_img=True).astype(int)
        plotter.close()
        left.append(weakref.ref(volume))
        return result

    def table(volume):
        volume.mapper.lookup_table.apply_cmap("plasma", 256)
        volume.mapper.lookup_table.apply_opacity("sigmoid_5")
        volume.mapper.lookup_table.scalar_range = (100, 250)

    def cut(volume):
        plane = vtkPlane()
        plane.SetNormal(1, 0, 0), plane.SetOrigin(2, 0, 0)
        volume.mapper.AddClippingPlane(plane)
    left = []
    before = picture()
    for change, same in (table, dict(cmap="plasma", opacity="sigmoid_5", clim=(100, 250))), (cut, dict(clip_planes=[(1, 0, 0, -2)])), \
            (lambda volume: setattr(volume.prop, "interpolation_type", "nearest"), dict(interpolation="nearest")), \
            (lambda volume: setattr(volume.mapper, "blend_mode", "maximum"), dict(blending="maximum")), \
            (lambda volume: setattr(volume.prop, "opacity_unit_distance", 9.0), dict(opacity_unit_distance=9)), \
            (lambda volume: volume.rotate_z(30), dict(user_matrix=pyvista.Transform().rotate_z(30).matrix)):
        changed = picture(change)
        check(numpy.abs(changed - before).max() > 5, f"{same} changes the picture")
        check(numpy.abs(changed - picture(**same)).max() <= 2, f"as {same} does")
    plotter = pyvista.Plotter(off_screen=True)
    volume = plotter.stratus.add_volume(grid)
    plotter.add_volume_clip_plane(volume)
    check(len(volume.asked()["clip_planes"]) == 1 and volume.mapper.dataset.n_points == grid.n_points, "pyvista's widgets take it")
    plotter.close()
    del volume
    gc.collect()
    check(all(each() is None for each in left), f"closed plotters leave {sum(each() is not None for each in left)} volumes")


def several():
    """Blocks of a volume, and volumes that overlap, are one medium."""
    def picture(*volumes, **look):
        plotter = pyvista.Plotter(off_screen=True, window_size=(120, 90))
        for volume in volumes:
            plotter.stratus.add_volume(volume, show_scalar_bar=False, clim=(37, 277), opacity_unit_distance=2, tolerance=0, **look)
        plotter.camera_position = [(70, -60, 55), (0, 0, 0), (0, 0, 1)]
        plotter.renderer.reset_camera_clipping_range()
        result = plotter.screenshot(return_img=True).astype(int)
        made = plotter.stratus.volumes
        counters = [volume.counters for volume in made]
        plotter.close()
        return result, counters
    whole, _ = picture(grid)
    halves = [grid.extract_subset((*ends, -12, 12, -12, 12)) for ends in ((-12, 0), (0, 12))]
    blocks, counters = picture(pyvista.MultiBlock(halves))
    check(len(counters) == 2 and all(each["samples"] > 0 for each in counters), "each block counts")
    check(numpy.abs(blocks - whole).mean() < 0.5, f"two blocks look as the whole does: {numpy.abs(blocks - whole).mean():.2f}")
    backwards, _ = picture(*halves[::-1])
    check(numpy.abs(backwards - blocks).max() <= 2, "in any order")
    cells, _ = picture(halves[0], halves[1].cast_to_unstructured_grid())
    check(numpy.abs(cells - whole).mean() < 2, f"cells among them: {numpy.abs(cells - whole).mean():.2f}")
    largest, _ = picture(*halves, blending="maximum")
    check(numpy.abs(largest - picture(grid, blending="maximum")[0]).max() > 0 and largest.max() > 200, "what does not mix lies one before the other")
    colored, _ = picture(pyvista.MultiBlock(halves), multi_colors=True)
    check(numpy.abs(colored - blocks).max() > 50, "a colour for each block")


def named_colors():
    import matplotlib
    host = dict(size=(80, 60), device="host")
    for name, same in ("PuOr", matplotlib.colormaps["PuOr"]), ("red", (1, 0, 0)):  # viridis is in the core, in bytes
        check(numpy.array_equal(stratus_volume.render(field, color=name, **host).rgba, stratus_volume.render(field, color=same, **host).rgba), name)


def data():
    structured = grid.cast_to_structured_grid()
    structured.set_active_scalars("RTData")  # as pyvista before 0.48 makes none active there
    for volume in field.transpose(2, 1, 0), grid.cast_to_unstructured_grid(), structured, grid.cast_to_rectilinear_grid(), \
            grid.point_data_to_cell_data(), stratus_volume.Volume(grid):
        plotter = pyvista.Plotter(off_screen=True, window_size=(100, 80))
        plotter.add_text("Annotation")
        own = add_volume(plotter, volume, show_scalar_bar=False)
        picture = plotter.screenshot(return_img=True).astype(int)
        check(numpy.abs(picture - picture[-1, -1]).max() > 50 and own.counters, f"{type(volume).__name__} shows")
        plotter.close()


def drafts():
    """While the camera moves, frames that take longer than the window wants are drafts. A frame whose scene has not changed is not drawn again."""
    plotter = pyvista.Plotter(off_screen=True, window_size=(121, 91))
    volume = plotter.stratus.add_volume(grid, show_scalar_bar=False, opacity="sigmoid_5")
    window, layer = plotter.render_window, plotter.__dict__["_stratus_layers"][0]
    whole, rays = plotter.screenshot(return_img=True).astype(int), volume.counters["rays"]
    volume.counters = None
    plotter.render()
    check(volume.counters is None and numpy.array_equal(plotter.screenshot(return_img=True), whole), "the same scene again")
    window.SetDesiredUpdateRate(15)
    for seconds, part in (0.0, 1), (10.0, 4):
        layer.seconds, layer._last = seconds, None
        plotter.render()
        check(0.8 * rays < part * volume.counters["rays"] < 1.2 * rays, f"{volume.counters['rays']} of {rays} rays after a frame of {seconds} s")
    draft = numpy.abs(plotter.screenshot(return_img=True).astype(int) - whole)
    check(draft.max() > 0 and draft.mean() < 8, f"a draft looks alike: {draft.mean():.1f} of 255")
    window.SetDesiredUpdateRate(0.0001)
    plotter.render()
    check(numpy.array_equal(plotter.screenshot(return_img=True), whole) and layer.seconds < 10, "the last frame is whole")
    plotter.close()


def steps():
    def picture(data, step=None, **look):
        plotter = pyvista.Plotter(off_screen=True, window_size=(120, 90))
        volume = plotter.stratus.add_volume(data, show_scalar_bar=False, **look)
        if step is not None:
            volume.step = step
            check(volume.step == step and volume.steps.labels == ["0", "1"], "a step is chosen")
        result = plotter.screenshot(return_img=True)
        plotter.close()
        return result
    other = grid.copy()
    other["RTData"] = other["RTData"][::-1] ** 0.98
    clim = (float(field.min()), float(field.max()))
    check(numpy.array_equal(picture([grid, other], 0), picture(grid)), "the first step")
    check(numpy.array_equal(picture([grid, other], 1), picture(other, clim=clim)), "another one, with the first one's range")
    plotter = pyvista.Plotter(off_screen=True)
    volume = plotter.stratus.add_volume([grid, other])
    refuse(ValueError, "0..1", volume.choose, 2)
    refuse(ValueError, "no steps", plotter.stratus.add_volume(grid).choose, 0)
    plotter.close()


def lazily():
    """A lazy array, which moves as a coarse copy, and an xarray.DataArray's kind of array as the array in memory."""
    values, pictures = numpy.ascontiguousarray(field), []
    for data, more in (values, {}), (Chunks(values, (8, 9, 10)), dict(memory="16M")):
        plotter = pyvista.Plotter(off_screen=True, window_size=(120, 90))
        volume = plotter.stratus.add_volume(data, show_scalar_bar=False, opacity="sigmoid_5", **more)
        pictures.append(plotter.screenshot(return_img=True))
        check(volume.shown is volume.drawn, "a still picture is exact")
        volume.drawn.grid.waits = bool(more)
        plotter.render_window.SetDesiredUpdateRate(15)
        plotter.render()
        check((volume.shown is not volume.drawn) == bool(more), "a moving one is of a coarse copy if values would have to be read")
        plotter.render_window.SetDesiredUpdateRate(0.0001)
        plotter.render()
        check(volume.shown is volume.drawn, "which is exact once it rests")
        plotter.close()
    check(numpy.array_equal(*pictures), "a lazy array")


def earth():
    """A mesh of a Dataset on the globe, whose Earth is geometry of the scene and hides what is behind it, and a part of the mesh on a plane."""
    points, triangles = icosphere(3)
    place = numpy.array([0.6, 0.48, 0.64])
    near = points @ place > 0.9
    spot = numpy.where(points @ place > 0.98, 1.0, 0.0)[:, None]
    for globe in True, False:
        _, mesh = mpas(points, triangles, None if globe else near)
        own = slice(None) if globe else near
        data = Dataset(**mesh, zgrid=("nCells levels", numpy.tile([[0.0, 5000]], (len(spot[own]), 1)), {"units": "m"}), q=("nCells layers", spot[own], {}))
        plotter = pyvista.Plotter(off_screen=True, window_size=(120, 120))
        plotter.background_color = "black"
        before = set(plotter.actors)
        volume = plotter.stratus.add_volume(data, "q", opacity=[0, 0, 1], cmap="Reds", show_scalar_bar=False, globe=globe)
        middle = numpy.array(volume.bounds[::2]) / 2 + numpy.array(volume.bounds[1::2]) / 2
        for side in 1, -1:
            if globe:
                plotter.camera_position = [tuple(3e7 * side * place), (0, 0, 0), (0, 0, 1)]
            else:
                plotter.camera_position = [(middle[0], middle[1], side * 1e7), tuple(middle), (0, 1, 0)]
            plotter.renderer.reset_camera_clipping_range()
            plotter.render()
            picture = plotter.screenshot(return_img=True)[..., :3].astype(int)
            red = (picture[..., 0] > 60) & (picture[..., 0] > 2 * picture[..., 1])
            check(red[40:80, 40:80].any() == (side > 0 or not globe), f"globe {globe}, side {side}: {red.sum()} pixels")
        volume.remove()
        check(set(plotter.actors) == before, f"globe {globe}: nothing stays: {set(plotter.actors) - before}")
        refuse(ValueError, "no variable 'p'", plotter.stratus.add_volume, data, "p", globe=globe)
        plotter.close()
    refuse(ValueError, "only xarray's data have places on the Earth", add_volume, pyvista.Plotter(off_screen=True), grid, globe=True)


def refines():
    """In a window that takes events a still picture that has to read is coarse first, and exact as soon as the window has time."""
    plotter = pyvista.Plotter(off_screen=False, window_size=(120, 90))
    volume = plotter.stratus.add_volume(Chunks(numpy.ascontiguousarray(field), (8, 9, 10)), show_scalar_bar=False, opacity="sigmoid_5", memory="16M")
    drawn = []
    plotter.renderer.AddObserver("EndEvent", lambda *_: drawn.append(volume.shown is volume.drawn))
    plotter.show(interactive_update=True, auto_close=False)
    for _ in range(100):
        if drawn[-1]:
            break
        time.sleep(0.02)
        plotter.update(1)
    check(drawn[-1] and not all(drawn), f"a coarse picture, and the exact one: {drawn}")
    exact = plotter.screenshot(return_img=True)
    volume.drawn.grid.waits = True
    check(numpy.array_equal(plotter.screenshot(return_img=True), exact) and drawn[-1], "later pictures, as of a screenshot, are exact")
    volume.remove()
    volume = plotter.stratus.add_volume(volume.drawn, show_scalar_bar=False, opacity="sigmoid_5", render=False)
    drawn.clear()
    plotter.reset_camera()
    check(all(drawn), "the first one is if it may be a screenshot")
    plotter.close()
    gc.collect()


beside_vtk()
composited()
lives()
named()
words()
reacts()
several()
named_colors()
data()
drafts()
steps()
lazily()
earth()
refines()
done()
