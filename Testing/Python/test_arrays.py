# SPDX-License-Identifier: BSD-3-Clause
"""Arrays without surprises: types, orders, masks, steps, scales, and one warning that names the reason where nothing shows."""
import warnings

from checking import ball, check, done, refuse

import numpy

import stratus_volume
from stratus_volume import NothingShown, Volume, render

warnings.simplefilter("error")


def reason(data, **options):
    """The one warning of a picture, "" where there is none."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        render(data, **{**host, **options})
    check(len(caught) <= 1, f"one warning, not {len(caught)}")
    for one in caught:
        check(one.category is NothingShown and one.filename == __file__, f"at the caller's line: {one.filename}")
    return str(caught[0].message) if caught else ""


# Sampling is fixed where pictures must be the same to the bit: a probe chooses by rays, and rounds with the values.
host = dict(device="host", size=(60, 60))
exact = dict(sampling="midpoint", sample_distance=0.5, **host)
field = ball((16, 18, 20), (8, 9, 10), 7, numpy.float64)
points = [(0, 0), (0.2, 0), (1, 0.6)]


def apart(a, b):
    return float(numpy.abs(a.rgba - b.rgba).max())


def types():
    wanted = render((100 * field).astype(numpy.float32).round(), opacity=[(0, 0), (20, 0), (100, 0.6)], **exact)
    for name in "int8 uint8 int16 uint16 int32 uint32 int64 uint64 float16 float32 float64 >f8 >f4 >f2 >i2 >u4 >i8 <f2".split():
        own = (100 * field).round().astype(name)
        picture = render(own, opacity=[(0, 0), (20, 0), (100, 0.6)], **exact)
        # Tables of whole numbers have an entry for each number, tables of floats have other entries.
        check(apart(picture, wanted) < 5e-4, f"{name} gives the same picture: {apart(picture, wanted)}")
    solid = render(field > 0.5, opacity=[(0, 0), (1, 0.6)], **exact)
    check(apart(solid, render((field > 0.5).astype(numpy.uint8), opacity=[(0, 0), (1, 0.6)], **exact)) == 0, "bool")
    for name in "complex64", "longdouble", object, "M8[s]", "V4":
        refuse(TypeError, "bool, int8", render, numpy.zeros((4, 4, 4), name))
    for shape in (8, 8), (8, 1, 8), (0, 8, 8), (2, 2, 2, 5), (1, 2, 2, 2), (2, 2, 2, 2, 2):
        refuse(ValueError, str(shape), render, numpy.zeros(shape))
    refuse(ValueError, "spacing", render, field, spacing=(1, 0, 1))
    refuse(TypeError, "spacing", render, field, spacing=2)
    refuse(ValueError, "xyy", render, field, axes="xyy")
    refuse(ValueError, "scalars", render, field, scalars="density")
    refuse(TypeError, "render() has no argument 'scalrs': did you mean scalars?", render, field, scalrs="density")
    refuse(TypeError, "show() has no argument 'backgrund': did you mean background?", stratus_volume.show, field, backgrund=None)
    refuse(TypeError, "turn() has no argument 'frame': did you mean frames?", stratus_volume.turn, field, frame=2)


def orders():
    """No copy where memory is a grid of even steps, and the same picture whatever the order."""
    single = field.astype(numpy.float32)
    wanted = render(single, opacity=points, spacing=(1, 1.5, 0.8), origin=(5, 6, 7), **exact)
    backwards = numpy.ascontiguousarray(single[::-1, ::-1, ::-1])[::-1, ::-1, ::-1]
    uneven = numpy.zeros((16, 20, 40), numpy.float32)
    uneven[:, 1:19, ::2] = single
    records = numpy.zeros(single.shape, [("pressure", "f4"), ("wind", "f4")])
    records["wind"] = single
    same = dict(c=(single, "zyx", True), fortran=(numpy.asfortranarray(single), "zyx", True),
                transposed=(single.transpose(2, 1, 0), "xyz", True), turned=(numpy.ascontiguousarray(single.transpose(1, 2, 0)), "yxz", True),
                records=(records["wind"], "zyx", True), backwards=(backwards, "zyx", False), uneven=(uneven[:, 1:19, ::2], "zyx", False))
    for name, (own, axes, shared) in same.items():
        volume = Volume(own, axes=axes, spacing=(1, 1.5, 0.8), origin=(5, 6, 7), device="host")
        options = {name: value for name, value in exact.items() if name != "device"}
        picture = volume.render(opacity=points, **options)
        # The order of a sum of products along the axes rounds otherwise.
        check(apart(picture, wanted) < 2e-3, f"{name}: {apart(picture, wanted)}")
        check(numpy.shares_memory(volume.grid.view(0) and volume.grid._scaled[1], own) == shared, f"{name}: copied or not")


def masks():
    mask = numpy.zeros(field.shape, bool)
    mask[:, :, :9] = True
    holes = numpy.where(mask, numpy.nan, field)
    wanted, whole = render(holes, opacity=points, **exact), render(field, opacity=points, **exact)
    check(0.2 < wanted.rgba[..., 3].sum() / whole.rgba[..., 3].sum() < 0.8, "NaN is transparent")
    for fill in 0, 7, 1e6, 1e30, -1e30, 1e300, numpy.nan, numpy.inf:
        own = numpy.ma.masked_array(numpy.where(mask, fill, field), mask)
        for data, name in (own, "float64"), (own.astype(numpy.float32) if abs(fill) < 1e37 else own, "float32"):
            check(apart(render(data, opacity=points, **exact), render(holes.astype(data.dtype), opacity=points, **exact)) == 0,
                  f"masked {fill} in {name} is drawn as NaN is")
            check(apart(render(data, **host), render(holes.astype(data.dtype), **host)) == 0, f"masked {fill} in {name}, functions by themselves")
        check(own.data[8, 9, 3] == fill or fill != fill, "the array stays as it was")
    for fill in 0, 100, 255:
        own = numpy.ma.masked_array(numpy.where(mask, fill, (100 * field).round()).astype(numpy.uint8), mask)
        picture = render(own, opacity=[(0, 0), (20, 0), (100, 0.6)], **exact)
        as_nan = render(numpy.where(mask, numpy.nan, (100 * field).round()).astype(numpy.float32), opacity=[(0, 0), (20, 0), (100, 0.6)], **exact)
        check(apart(picture, as_nan) < 5e-4, f"masked bytes of {fill}: {apart(picture, as_nan)}")
    turned = numpy.ma.masked_array(field, mask).transpose(2, 1, 0)
    check(apart(render(turned, axes="xyz", opacity=points, **exact), wanted) < 2e-3, "a mask in another order")
    shared = numpy.ma.masked_array((100 * field).astype(numpy.uint8), mask)
    check(numpy.shares_memory(Volume(shared).grid.values, shared.data), "masked bytes are not copied if their range is the others'")
    nothing = numpy.ma.masked_array(field)
    check(apart(render(nothing, **host), render(field, **host)) == 0, "a mask of nothing")


def steps():
    def alpha(own):
        return render(field, opacity=own, color=(1, 1, 1), unit_distance=1, **host).rgba[..., 3]
    step, ramp, near = alpha([(0, 0), (0.5, 0), (0.5, 0.8), (1, 0.8)]), alpha([(0, 0), (0.5, 0.8), (1, 0.8)]), \
        alpha([(0, 0), (0.4999999, 0), (0.5, 0.8), (1, 0.8)])
    check(numpy.abs(step - ramp).max() > 0.15, "two opacities at one value are a step, not a ramp")
    check(numpy.abs(step - near).max() <= 4 / 255, f"the step is where it is given: {numpy.abs(step - near).max()}")
    check(numpy.array_equal(step, alpha([(0, 0), (0.5, 0), (0.5, 0.1), (0.5, 0.8), (1, 0.8)])), "of three at one value the middle one says nothing")
    check(numpy.array_equal(step, alpha([(1, 0.8), (0.5, 0), (0.5, 0.8), (0, 0)])), "in any order of values")
    halves = [(0, 1, 0, 0), (0.5, 1, 0, 0), (0.5, 0, 0, 1), (1, 0, 0, 1)]
    for shown, channel in ([(0, 0), (0.05, 0.8), (0.48, 0.8), (0.49, 0)], 0), ([(0, 0), (0.51, 0), (0.52, 0.8), (1, 0.8)], 2):
        rgba = render(field, opacity=shown, color=halves, **host).rgba
        check(rgba[..., channel].max() > 0.1 and rgba[..., 2 - channel].max() == 0, "two colours at one value are a step")


def scales():
    plain, own = render(field, **host), render(field, opacity=points, **host)
    surface = render(field, mode="isosurface", contours=[0.3, 0.6], opacity=[(0, 0.5), (1, 0.5)], **host)
    fraction = render(field, mode="average", average_range=(0.25, 0.75), opacity=points, **host)
    thinned = render(field, opacity=points, gradient_opacity=[(0, 0), (0.1, 1)], **exact)
    for factor in 2.0**1023, 2.0**-1030, 2.0**500, 2.0**-500, 2.0**127, 2.0**-126, 2.0**130, 1e308, 1e-310, 1e-300, 1e100, 1e37, 1e-38:
        times = field * factor
        # Denormal numbers have fewer digits, and factors that are no powers of 2 round.
        limit = 3e-3
        check(apart(plain, render(times, **host)) < limit, f"times {factor}: {apart(plain, render(times, **host))}")
        scaled = [(value * factor, opacity) for value, opacity in points]
        check(apart(own, render(times, opacity=scaled, **host)) < limit, f"times {factor}, points of one's own")
        same = render(times, mode="isosurface", contours=[0.3 * factor, 0.6 * factor], opacity=[(0, 0.5), (factor, 0.5)], **host)
        # A surface that passes a pixel's middle by a hair is in it or not.
        check((numpy.abs(surface.rgba - same.rgba).max(axis=2) > limit).sum() <= 2, f"contours times {factor}: {apart(surface, same)}")
        same = render(times, mode="average", average_range=(0.25 * factor, 0.75 * factor), opacity=scaled, **host)
        check((numpy.abs(fraction.rgba - same.rgba).max(axis=2) > limit).sum() <= 2, f"average_range times {factor}: {apart(fraction, same)}")
        same = render(times, opacity=scaled, gradient_opacity=[(0, 0), (0.1 * factor, 1)], **exact)
        check(apart(thinned, same) < limit, f"gradient_opacity times {factor}: {apart(thinned, same)}")
    both = render((field - 0.5) * 2 * 1.7e308, **host)
    check(apart(plain, both) < 3e-3, f"from -1.7e308 to 1.7e308: {apart(plain, both)}")
    tiny = render((field * 1e-42).astype(numpy.float32), **host)
    check(tiny.rgba[..., 3].max() > 0.8 * plain.rgba[..., 3].max(), "denormal floats")
    for value in 7.0, 0.0, -3.0, 1e308, -1e308, 1e-310, 1e17:
        box = render(numpy.full((8, 8, 8), value), opacity=0.3, **host).rgba[..., 3]
        check(box[30, 30] > 0.4 and box[0, 0] == 0, f"{value} everywhere is a box: {box[30, 30]}")
    spiked = field.copy()
    spiked[0, 0, 0] = 1e300
    check(apart(own, render(spiked, opacity=points, **host)) < 3e-3, "one value of 1e300 and a function of 0..1")


def reasons():
    for data, words in (numpy.full((8, 8, 8), numpy.nan), "512 NaN or infinite"), (numpy.full((8, 8, 8), numpy.inf), "512 NaN or infinite"), \
            (numpy.ma.masked_all((8, 8, 8)), "512 masked"), \
            (numpy.ma.masked_array(numpy.full((8, 8, 8), numpy.nan), numpy.arange(512).reshape(8, 8, 8) < 12), "12 masked and 500 NaN"):
        warning = reason(data)
        check(words in warning and "none of the 512" in warning, f"'{words}' in the warning: {warning}")
        check(render_quietly(data).rgba.max() == 0 and numpy.isinf(render_quietly(data).depth).all(), "the picture is empty")
    check("all values are 7" in reason(numpy.full((8, 8, 8), 7.0), opacity=[(8, 0), (9, 1)]), "constant, outside the function")
    check("opacity is 0 for every value" in reason(numpy.full((8, 8, 8), 7.0), opacity=0), "constant and transparent")
    check("opacity is 0 for every value" in reason(field, opacity=[(0, 0), (1, 0)]), "a transparent function")
    warning = reason(field, opacity=[(0, 0), (2, 0), (3, 1), (4, 0)])
    check("0..1" in warning and "2..4" in warning, f"a function outside the values: {warning}")
    warning = reason(field * 1e300, opacity=[(0, 0), (2e300, 0), (3e300, 1), (4e300, 0)])
    check("0..1e+300" in warning and "2e+300..4e+300" in warning, f"in the values' own unit: {warning}")
    noise = numpy.random.default_rng(1).random((12, 12, 12))
    for far in 1e300, -1e300, 1e30, 1e9:
        spiked = noise.copy()
        spiked[3, 4, 5] = far
        for own in None, 0.5:
            warning = reason(spiked, opacity=own)
            check("next to nothing shows" in warning and "95 %" in warning and "Mask" in warning, f"a spike of {far}: {warning}")
    warning = reason(10 ** (300 * noise))
    check("next to nothing shows" in warning, f"from 1 to 1e300 by powers of 10: {warning}")
    warning = reason(field, opacity=[(0, 0), (1, 1e-5)])
    check("half a step" in warning and "unit_distance" in warning, f"too thin: {warning}")
    check("no contour" in reason(field, mode="isosurface", contours=[2], opacity=[(0, 1), (2, 1)]), "a contour beyond the values")
    check("no ray" in reason(field, camera=dict(position=(10, 9, 60), focal_point=(10, 9, 90), view_up=(0, 1, 0))), "a camera that looks away")
    check("no ray" in reason(field, crop=(100, 120, 0, 1, 0, 1)), "a crop outside the volume")
    check("mode minimum" in reason(field, mode="minimum"), "the smallest value of each ray is transparent")
    # Visible pictures give no warning.
    sparse = numpy.zeros((40, 40, 40))
    sparse[20:22, 20:22, 20:22] = 1
    few = numpy.zeros((12, 12, 12))
    few[4:6, 4:6, 4:6] = 1e300
    for data in field, noise, sparse, few, noise > 0.5, (noise * 5).astype(numpy.uint8), field * 1e300, field - 1e6, numpy.full((4, 4, 4), 3.0):
        check(reason(data) == "", f"no warning: {reason(data)}")
    spiked = noise.copy()
    spiked[3, 4, 5] = 1e300
    check(reason(spiked, opacity=[(0, 0), (1, 0.5)]) == "", "a function of one's own is for the others")


def render_quietly(data):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return render(data, **host)


class Coordinate:
    def __init__(self, values, **attrs):
        self.values, self.attrs = numpy.asarray(values), attrs


class Labelled:
    """What is read of an xarray.DataArray."""

    def __init__(self, values, dims, coords=None, **attrs):
        self.values, self.dims, self.coords, self.attrs, self.encoding = values, dims, coords or {}, attrs, {}


def labelled():
    wanted = render(field, opacity=points, **exact)
    for dims in ("lev", "lat", "lon"), ("z", "y", "x"), ("a", "b", "c"):
        check(apart(render(Labelled(field, dims), opacity=points, **exact), wanted) == 0, f"dimensions {dims}")
    turned = Labelled(field.transpose(2, 1, 0), ("longitude", "latitude", "height"))
    check(apart(render(turned, opacity=points, **exact), wanted) < 2e-3, "the names give the axes")
    even = {name: Coordinate(numpy.arange(n) * 2.0 + 5, units="m") for name, n in zip("zyx", field.shape)}
    view = dict(host, camera=dict(azimuth=30))
    picture = render(Labelled(field, tuple("zyx"), even), opacity=points, **view)
    check(apart(picture, render(field, spacing=(2, 2, 2), origin=(5, 5, 5), opacity=points, **view)) < 3e-3, "coordinates are places")
    rising = dict(even, z=Coordinate(numpy.arange(16) ** 1.5, units="m"))
    falling = dict(even, z=Coordinate((numpy.arange(16) ** 1.5)[::-1], units="m"))
    stretched = render(Labelled(field, tuple("zyx"), rising), opacity=points, **view)
    check(apart(stretched, picture) > 0.05, "that need not be even")
    check(apart(render(Labelled(field[::-1], tuple("zyx"), falling), opacity=points, **view), stretched) < 3e-3, "and may fall")
    mixed = dict(z=Coordinate(numpy.arange(16) * 1000.0, units="m"), y=Coordinate(numpy.arange(18) * 0.1, units="1"),
                 x=Coordinate(numpy.arange(20) * 0.1, units="1"))
    check(apart(render(Labelled(field, tuple("zyx"), mixed), opacity=points, **host), render(field, opacity=points, **host)) < 3e-3,
          "metres next to another unit: each axis by its count")
    filled = Labelled(numpy.where(field < 0.3, -999, field), tuple("zyx"), _FillValue=-999)
    check(apart(render(filled, **host), render(numpy.where(field < 0.3, numpy.nan, field), **host)) == 0, "a fill value is masked")
    refuse(ValueError, "must have three", render, Labelled(field[0], ("lat", "lon")))


def vtk():
    try:
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkRectilinearGrid
    except ImportError:
        print("without data sets of VTK: no vtkmodules here")
        return
    single = field.astype(numpy.float32)
    flat = numpy_to_vtk(single.reshape(-1))
    flat.SetName("density")
    image = vtkImageData()
    image.SetExtent(3, 22, -2, 15, 0, 15)
    image.SetSpacing(1, 1.5, 0.8), image.SetOrigin(5, 6, 7)
    image.GetPointData().SetScalars(flat)
    wanted = render(single, spacing=(1, 1.5, 0.8), origin=(8, 3, 7), opacity=points, **exact)
    check(apart(render(image, opacity=points, **exact), wanted) == 0, "vtkImageData, whose extent does not begin at 0")
    check(numpy.shares_memory(Volume(image).grid.values, single), "of VTK's own memory")
    check(apart(render(image, scalars="density", opacity=points, **exact), wanted) == 0, "by its array's name")
    refuse(ValueError, "density", render, image, scalars="wind")
    refuse(ValueError, "spacing", render, image, spacing=(1, 1, 1))
    image.SetDirectionMatrix(0, 1, 0, 1, 0, 0, 0, 0, 1)
    turned = render(image, opacity=points, **exact)
    check(apart(turned, wanted) > 0.05, "the direction matrix counts")
    image.SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1)
    flags = numpy_to_vtk(numpy.where(single.reshape(-1) > 0.5, 2, 0).astype(numpy.uint8), deep=True)
    flags.SetName("vtkGhostType")
    image.GetPointData().AddArray(flags)
    ghosts, holes = render(image, opacity=points, **exact), numpy.where(single > 0.5, numpy.float32(numpy.nan), single)
    check(apart(ghosts, render(holes, spacing=(1, 1.5, 0.8), origin=(8, 3, 7), opacity=points, **exact)) < 2e-2 and apart(ghosts, wanted) > 0.05,
          "hidden points")
    cells = vtkImageData()
    cells.SetDimensions(21, 19, 17)
    cells.GetCellData().SetScalars(flat)
    check(Volume(cells, device="host").bounds == (0, 20, 0, 18, 0, 16) and render(cells, opacity=points, **host).rgba.max() > 0, "values of cells")
    grid = vtkRectilinearGrid()
    grid.SetDimensions(20, 18, 16)
    for axis, n in zip("XYZ", (20, 18, 16)):
        getattr(grid, f"Set{axis}Coordinates")(numpy_to_vtk(numpy.arange(n, dtype=float) * 2, deep=True))
    grid.GetPointData().SetScalars(flat)
    check(apart(render(grid, opacity=points, **host), render(single, spacing=(2, 2, 2), opacity=points, **host)) < 3e-3, "vtkRectilinearGrid")
    vectors = numpy_to_vtk(numpy.stack([single.reshape(-1), 1 - single.reshape(-1)], axis=1).copy())
    image.GetPointData().RemoveArray("vtkGhostType")
    image.GetPointData().SetScalars(vectors)
    refuse(ValueError, "2 components", render, image)
    check(apart(render(image, component=0, opacity=points, **exact), wanted) == 0, "a component")
    refuse(ValueError, "0..1 or 'all'", render, image, component=2)
    look = dict(opacity=[points, [(0, 0), (1, 0.1)]], color=[(1, 0, 0), (0, 0, 1)])
    both = numpy.stack([single, 1 - single], axis=3)
    check(apart(render(image, component="all", **look, **exact), render(both, spacing=(1, 1.5, 0.8), origin=(8, 3, 7), **look, **exact)) == 0,
          "all components")
    refuse(TypeError, "vtkPolyData", render, vtkPolyData())
    refuse(ValueError, "no active scalars", render, vtkImageData())


types()
orders()
masks()
steps()
scales()
reasons()
labelled()
vtk()
check(stratus_volume.__doc__ and len(render.__doc__) > 1000, "help() describes")
done()
