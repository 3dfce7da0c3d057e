# SPDX-License-Identifier: BSD-3-Clause
"""stratus_volume in scenes of pyvista, beside the volumes that VTK's own mapper draws there. `wheel` runs it where pyvista is installed."""
import warnings

from checking import check, done, refuse

import numpy
import pyvista

import stratus_volume
from stratus_volume.pyvista import add_volume

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
        mapper.SetSampleDistance(0.1)  # its default, a voxel and a half, errs by more than what is tested here
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
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        volume.set(structure="bush")
        volume.set(structure="none")
    check(any("bush" in str(one.message) for one in told), "what fails within a frame is a warning")
    volume.remove()
    after = plotter.screenshot(return_img=True).astype(int)
    check(numpy.abs(after - empty).max() <= 1 and not plotter.scalar_bars, f"and taken away: {numpy.abs(after - empty).max()}")
    for words in dict(blending="glow"), dict(opacity=2), dict(clim=(3, 1)):
        refuse(ValueError, next(iter(words)), plotter.stratus.add_volume, grid, **words)
    refuse(ValueError, "scalars", plotter.stratus.add_volume, grid, scalars="wind")
    plotter.close()
    check(not plotter.__dict__["stratus"].volumes, "nothing is left of a closed plotter")


def data():
    for volume in field.transpose(2, 1, 0), grid.cast_to_unstructured_grid(), grid.cast_to_structured_grid(), grid.cast_to_rectilinear_grid(), \
            grid.point_data_to_cell_data(), stratus_volume.Volume(grid):
        plotter = pyvista.Plotter(off_screen=True, window_size=(100, 80))
        plotter.add_text("Annotation")
        own = add_volume(plotter, volume, show_scalar_bar=False)
        picture = plotter.screenshot(return_img=True).astype(int)
        check(numpy.abs(picture - picture[-1, -1]).max() > 50 and own.counters, f"{type(volume).__name__} shows")
        plotter.close()


beside_vtk()
composited()
lives()
data()
done()
