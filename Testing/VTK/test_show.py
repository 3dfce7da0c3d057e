# SPDX-License-Identifier: BSD-3-Clause
"""NumPy volumes for people: stratus.show draws from the array's own memory, refuses by name, and help() describes every method."""
import os
import subprocess
import sys
import tempfile
import warnings

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import ball, check, done, refuse

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus
import stratus_volume

warnings.simplefilter("error")


def color_maps():
    function = vtk.vtkColorTransferFunction()
    function.SetColorSpaceToHSV()
    check(stratus.vtkStratusColorMap.SetColors(function, "viridis_r", -2, 3) and function.GetSize() == 256 and list(function.GetRange()) == [-2, 3],
          "the points of a map")
    for value, expected in (-2, (253, 231, 36)), (3, (68, 1, 84)):
        check(tuple(round(255 * part) for part in function.GetColor(value)) == expected, f"viridis_r at {value}: {function.GetColor(value)}")
    for name, low, high in ("viridi", 0, 1), (None, 0, 1), ("viridis", 1, 0):
        check(not stratus.vtkStratusColorMap.SetColors(function, name, low, high) and function.GetSize() == 256, f"{name} {low} {high} changes nothing")
    names = []
    while stratus.vtkStratusColorMap.GetName(len(names)):
        names.append(stratus.vtkStratusColorMap.GetName(len(names)))
    check(names == stratus_volume.color_maps() and stratus.vtkStratusColorMap.GetName(-1) is None, f"names {names}")
    field = ball((8, 10, 12), (4, 5, 6), 4)
    pictures = [package.show(field, color="magma", size=(40, 30)) for package in (stratus, stratus_volume)]
    check(numpy.abs(numpy.subtract(*pictures, dtype=int)).max() <= 1, "both packages draw one map")


def shares_memory():
    for dtype in numpy.float32, numpy.float64, numpy.int16, numpy.uint8, numpy.int64, bool:
        array = (100 * ball((8, 10, 12), (4, 5, 6), 4)).astype(dtype)
        image = stratus.as_image(array, spacing=(1, 2, 3), origin=(-1, 0, 1))
        values = vtk_to_numpy(image.GetPointData().GetScalars())
        check(numpy.shares_memory(values, array), f"{array.dtype}: not copied")
        check(image.GetDimensions() == (12, 10, 8) and image.GetSpacing() == (1, 2, 3) and image.GetOrigin() == (-1, 0, 1), "the grid")
        array[2, 3, 4] = 1
        check(image.GetScalarComponentAsDouble(4, 3, 2, 0) == 1, f"{array.dtype}: array[z, y, x] is the image's value at x, y, z")
    image = stratus.as_image(ball((8, 10, 12), (4, 5, 6), 4))  # nobody else holds this array
    check(vtk_to_numpy(image.GetPointData().GetScalars()).max() == 1, "the image keeps the array alive")
    sliced = ball((8, 10, 24), (4, 5, 6), 4)[:, :, ::2]
    values = vtk_to_numpy(stratus.as_image(sliced).GetPointData().GetScalars())
    check(numpy.array_equal(values.reshape(sliced.shape), sliced), "a slice that is not contiguous is copied as it stands")


def axes():
    array = numpy.arange(8 * 10 * 12, dtype=numpy.float32).reshape(8, 10, 12)
    image = stratus.as_image(array, spacing=(1, 2, 3), origin=(5, 6, 7), axes="xyz")
    check(numpy.shares_memory(vtk_to_numpy(image.GetPointData().GetScalars()), array), "xyz: not copied")
    point = [0, 0, 0]
    image.TransformIndexToPhysicalPoint(11, 9, 7, point)  # the last value of all
    check(numpy.allclose(point, (5 + 7 * 1, 6 + 9 * 2, 7 + 11 * 3)), f"xyz: the last value is at {point}")
    along_z = ball((24, 30, 36), (12, 15, 9), 8)
    same = numpy.ascontiguousarray(along_z.transpose(2, 1, 0))  # the same field as array[x, y, z]
    options = dict(opacity=[(0, 0), (1, 0.5)], size=(120, 90), spacing=(1, 1.5, 0.8), unit_distance=1)
    difference = numpy.abs(stratus.show(along_z, **options).astype(int) - stratus.show(same, axes="xyz", **options).astype(int))
    check(difference.max() <= 1, f"array[x, y, z] with its axes named gives the same picture: {difference.max()}")
    check(numpy.abs(stratus.show(along_z, **options).astype(int) - stratus.show(same, **options)).max() > 40, "and another without")


def pictures():
    field = ball((20, 20, 20), (10, 10, 10), 8)
    picture = stratus.show(field, opacity=[(0, 0), (0.5, 0.9)], color=(1, 0.5, 0), size=(90, 60), background=None)
    check(isinstance(picture, numpy.ndarray) and picture.shape == (60, 90, 4) and picture.dtype == numpy.uint8, "an array of RGBA")
    check(picture[30, 45, 3] > 200 and picture[2, 2].max() == 0, "opaque in the middle, nothing in the corner")
    check(abs(int(picture[30, 45, 0]) - 255) < 3 and abs(int(picture[30, 45, 1]) - 128) < 3, f"the colour, not premultiplied: {picture[30, 45]}")
    high = ball((20, 20, 20), (16, 10, 10), 3)  # near the top
    up = stratus.show(high, opacity=[(0, 0), (0.5, 0.9)], size=(60, 60), background=None, camera=dict(elevation=0, zoom=1))[..., 3].astype(float)
    check((up.sum(1) * numpy.arange(60)).sum() / up.sum() < 25, "z points up, and the picture's first row is the top one")
    ground = stratus.show(field, size=(90, 60), background=(0, 0, 1))
    check(tuple(ground[0, 0]) == (0, 0, 255, 255), f"the background: {ground[0, 0]}")
    dense, thin = (stratus.show(field, opacity=most, size=(90, 60)).astype(int) for most in (0.9, 0.1))
    check(numpy.abs(dense - thin).max() > 20, "one number")
    bright = dict(size=(60, 60), color=numpy.array([1, 0.5, 0], numpy.float32))
    numpys, pythons = (stratus.show(field, opacity=most, **bright) for most in (numpy.float32(0.25), 0.25))
    check(numpy.array_equal(numpys, pythons), "NumPy's numbers")
    for options in dict(camera=dict(azimuth=70)), dict(camera=dict(elevation=80)), dict(camera=dict(zoom=2)), dict(spacing=(1, 1, 2)), \
            dict(unit_distance=20), dict(color=[(0, 1, 0, 0), (1, 0, 1, 0)]), dict(opacity=[(0.5, 0), (1, 1)]):
        uneven = ball((20, 20, 20), (14, 7, 9), 8) + ball((20, 20, 20), (4, 15, 15), 4)
        plain, changed = stratus.show(uneven, size=(90, 60)), stratus.show(uneven, size=(90, 60), **options)
        check(not numpy.array_equal(plain, changed), f"{options} changes the picture")
    twice, short = (stratus.show(field, size=(90, 60), **options) for options in (dict(unit_distance=2, extinction=2), dict(unit_distance=1)))
    check(numpy.array_equal(twice, short), "twice the extinction is half the unit distance")
    check(not numpy.array_equal(twice, stratus.show(field, size=(90, 60), unit_distance=2)), "and no other picture")
    camera = vtk.vtkCamera()
    camera.SetPosition(10, 10, 60), camera.SetFocalPoint(10, 10, 10)
    check(stratus.show(field, camera=camera, size=(90, 60), background=None)[30, 45, 3] > 0, "a camera of one's own")
    constant = stratus.show(numpy.full((4, 4, 4), 7.0), size=(20, 20))
    check(constant.shape == (20, 20, 4), "one value everywhere")
    holes = field.copy()
    holes[:10] = numpy.nan
    check(not numpy.array_equal(stratus.show(holes, size=(90, 60)), stratus.show(field, size=(90, 60))), "what is no number shows nothing")


def masks():
    field = 0.2 + 0.6 * ball((20, 20, 20), (10, 10, 10), 8)
    mask = numpy.zeros(field.shape, bool)
    mask[:, :, :10] = True
    options = dict(size=(60, 60), background=None, opacity=[(0, 0.5), (1, 0.9)], unit_distance=1)
    holes = field.copy()
    holes[mask] = numpy.nan
    for dtype in numpy.float32, numpy.float64, numpy.int16, bool:
        values = field if numpy.dtype(dtype).kind == "f" else 100 * (field > 0.3)
        hidden = numpy.ma.masked_array(values.astype(dtype), mask)
        image = stratus.as_image(hidden)
        check(numpy.shares_memory(vtk_to_numpy(image.GetPointData().GetScalars()), hidden.data), f"{hidden.dtype}: masked, not copied")
        picture, whole = (stratus.show(one, **options)[..., 3] for one in (hidden, hidden.data))
        check(0 < (picture > 0).sum() < 0.8 * (whole > 0).sum(), f"{hidden.dtype}: masked values are transparent")
    mapper = stratus.vtkStratusVolumeMapper()  # one step for both: a probe sees the values that are masked, and not the NaN
    mapper.SetSamplingToMidpoint(), mapper.SetSampleDistance(0.5)
    options["mapper"] = mapper
    masked = stratus.show(numpy.ma.masked_array(field, mask), **options)
    check(numpy.array_equal(masked, stratus.show(holes, **options)), "masked is drawn as NaN is")
    turned = numpy.ma.masked_array(field, mask)[::-1, :, ::-1]
    check(numpy.array_equal(stratus.show(turned, **options), stratus.show(holes[::-1, :, ::-1], **options)), "a mask that is not contiguous")
    plain = dict(size=(60, 60))
    for fill in 1e6, 1e30, -1e30, numpy.nan, numpy.inf:  # as fill values are
        for dtype in numpy.float32, numpy.float64:
            wild = numpy.ma.masked_array(numpy.where(mask, fill, field).astype(dtype), mask)
            check(numpy.array_equal(stratus.show(wild, **options), stratus.show(holes.astype(dtype), **options)), f"masked {fill} as NaN")
            check(numpy.array_equal(stratus.show(wild, **plain), stratus.show(holes.astype(dtype), **plain)), f"masked {fill} is in no range")
            check(numpy.isclose(wild.data[0, 0, 0], fill, rtol=1e-6, equal_nan=True), "the array stays")
    wild = numpy.ma.masked_array(numpy.where(mask, 1e300, field.astype(float)), mask)
    check(numpy.array_equal(stratus.show(wild, **plain), stratus.show(holes.astype(float), **plain)), "masked 1e300")
    whole = numpy.ma.masked_array(numpy.where(mask, 30000, (100 * field)).astype(numpy.int16), mask)
    few = numpy.ma.masked_array((100 * field).astype(numpy.int16), mask)
    check(numpy.array_equal(stratus.show(whole, **plain), stratus.show(few, **plain)), "masked integers are in no range")
    unmasked = numpy.ma.masked_array(field)
    check(numpy.array_equal(stratus.show(unmasked, **plain), stratus.show(field, **plain)), "a mask of nothing")


def steps():
    field = ball((20, 20, 20), (10, 10, 10), 8)
    options = dict(size=(60, 60), background=None, unit_distance=1)

    def alpha(points):
        return stratus.show(field, opacity=points, color=(1, 1, 1), **options)[..., 3].astype(int)

    step, ramp, near = alpha([(0, 0), (0.5, 0), (0.5, 0.8), (1, 0.8)]), alpha([(0, 0), (0.5, 0.8), (1, 0.8)]), \
        alpha([(0, 0), (0.4999999, 0), (0.5, 0.8), (1, 0.8)])
    check(numpy.abs(step - ramp).max() > 40, "two opacities at one value are a step, not a ramp")
    # The narrow ramp is between two entries of the mapper's tables, the step is on one of them.
    check(numpy.abs(step - near).max() <= 4, f"the step is where it is given: {numpy.abs(step - near).max()}")
    check(numpy.array_equal(step, alpha([(0, 0), (0.5, 0), (0.5, 0.1), (0.5, 0.8), (1, 0.8)])), "of three at one value the middle one says nothing")
    check(numpy.array_equal(step, alpha([(1, 0.8), (0.5, 0), (0.5, 0.8), (0, 0)])), "in any order of values")
    halves = [(0, 1, 0, 0), (0.5, 1, 0, 0), (0.5, 0, 0, 1), (1, 0, 0, 1)]
    for shown, channel in ([(0, 0), (0.05, 0.8), (0.48, 0.8), (0.49, 0)], 0), ([(0, 0), (0.51, 0), (0.52, 0.8), (1, 0.8)], 2):
        picture = stratus.show(field, opacity=shown, color=halves, **options)
        check(picture[..., channel].max() == 255 and picture[..., 2 - channel].max() == 0, "two colours at one value are a step")


def ranges():
    field = ball((20, 20, 20), (10, 10, 10), 8).astype(numpy.float64)
    options = dict(size=(60, 60), background=None)
    plain = stratus.show(field, **options).astype(int)
    for factor in 2.0**1023, 2.0**-1030, 2.0**500, 2.0**-500, 2.0**127, 2.0**-126, 2.0**130:
        scaled = stratus.show(field * factor, **options).astype(int)
        check(numpy.abs(plain - scaled).max() <= 2, f"times {factor}: {numpy.abs(plain - scaled).max()} of 255")
        points = [(0.25 * factor, 0), (0.75 * factor, 0.5)]
        few = stratus.show(field, opacity=[(0.25, 0), (0.75, 0.5)], **options).astype(int)
        check(numpy.abs(few - stratus.show(field * factor, opacity=points, **options)).max() <= 2, f"times {factor}: points of one's own")
    both = stratus.show((field - 0.5) * 2 * 1.7e308, **options).astype(int)
    check(numpy.abs(plain - both).max() <= 3, f"from -1.7e308 to 1.7e308: {numpy.abs(plain - both).max()}")
    tiny = stratus.show((field * 1e-42).astype(numpy.float32), **options)
    check(tiny[..., 3].max() > 0.8 * plain[..., 3].max(), "denormal floats")
    for value in 7.0, 0.0, -3.0, 1e308, -1e308, 1e-310, 1e17:
        box = stratus.show(numpy.full((8, 8, 8), value), opacity=0.3, **options)
        check(box[30, 30, 3] > 100 and box[0, 0, 3] == 0, f"{value} everywhere is a box: {box[30, 30]}")
    warning, none = reason(numpy.full((8, 8, 8), 7.0), opacity=0, **options)
    check(none.max() == 0 and "opacity is 0" in warning, f"about the given opacity: {warning}")
    check(stratus.show(numpy.full((8, 8, 8), 7, numpy.uint8), **options)[30, 30, 3] > 100, "one integer everywhere is a box")
    image = stratus.as_image(field * 2.0**500)
    image.GetPointData().GetScalars().SetName("density")
    mapper = stratus.vtkStratusVolumeMapper()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectScalarArray("density")
    selected = stratus.show(image, mapper=mapper, **options).astype(int)
    check(numpy.abs(plain - selected).max() <= 2, "an array that the mapper selects by its name")
    check(mapper.GetInput().GetPointData().GetNumberOfArrays() == 1, "scaled values have no other array")
    check(image.GetPointData().GetScalars().GetRange()[1] > 1e100, "the image itself stays")


def types():
    field = (100 * ball((20, 20, 20), (10, 10, 10), 8)).round()
    options = dict(size=(60, 60), background=None, opacity=[(0, 0), (20, 0), (100, 0.6)])
    wanted = stratus.show(field, **options).astype(int)
    for name in "float16 >f8 >f4 >f2 >i2 >u4 >i8".split():
        check(numpy.abs(wanted - stratus.show(field.astype(name), **options)).max() <= 1, f"{name} gives the same picture")


def reason(array, **options):
    """The one warning of a picture, "" where there is none, and the picture."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        picture = stratus.show(array, **{"size": (60, 60), **options})
    check(len(caught) <= 1, f"one warning: {[str(one.message) for one in caught]}")
    for one in caught:
        check(one.category is stratus.NothingShown and one.filename == __file__, f"at the caller's line: {one.filename}")
    return str(caught[0].message) if caught else "", picture


def reasons():
    # All sentences, which both packages share, are tested in Testing/Python/test_arrays.py.
    field = ball((20, 20, 20), (10, 10, 10), 8)
    for array, words in (numpy.full((8, 8, 8), numpy.nan), "512 NaN or infinite"), (numpy.full((8, 8, 8), numpy.inf), "512 NaN or infinite"), \
            (numpy.ma.masked_all((8, 8, 8)), "512 masked"):
        warning, picture = reason(array)
        check(words in warning and (picture == picture[0, 0]).all(), f"'{words}' and the background: {warning}")
    check("all values are 7" in reason(numpy.full((8, 8, 8), 7.0), opacity=[(8, 0), (9, 1)])[0], "constant, outside the function")
    warning = reason(field, opacity=[(0, 0), (2, 0), (3, 1), (4, 0)])[0]
    check("0..1" in warning and "2..4" in warning, f"a function outside the values: {warning}")
    noise = numpy.random.default_rng(1).random((12, 12, 12))
    spiked = noise.copy()
    spiked[3, 4, 5] = 1e300
    for options in {}, dict(opacity=0.5):
        warning = reason(spiked, **options)[0]
        check("next to nothing shows" in warning and "95 %" in warning, f"a spike of 1e300: {warning}")
    check(reason(spiked, opacity=[(0, 0), (1, 0.5)])[0] == "", "a function of one's own is for the others")
    warning = reason(field, opacity=[(0, 0), (1, 1e-5)])[0]
    check("half a step" in warning and "unit_distance" in warning, f"too thin: {warning}")
    mapper = stratus.vtkStratusVolumeMapper()
    mapper.SetBlendModeToMinimumIntensity()
    check("mode minimum" in reason(field, mapper=mapper)[0], "the smallest value of each ray is transparent")


def without_vtk():
    """stratus_volume, which calls the core itself, draws what the mapper draws."""
    field = ball((20, 22, 24), (10, 12, 9), 8)
    own = dict(opacity=[(0, 0), (0.3, 0), (0.3, 0.2), (1, 0.6)], color=[(0, 0, 0, 1), (1, 1, 0.5, 0)])
    for options in own, {}, dict(own, axes="xyz", spacing=(1, 1.5, 0.8), origin=(5, 6, 7)), dict(own, camera=dict(azimuth=100, elevation=-40, zoom=2)), \
            dict(own, size=(60, 90), background=None):
        options = {"size": (90, 60), **options}
        by_vtk, by_core = (package.show(field, **options).astype(int) for package in (stratus, stratus_volume))
        # VTK's matrices round the camera otherwise; a pixel of 255 steps may be the next one.
        check(numpy.abs(by_vtk - by_core).max() <= 1 and by_vtk.std() > 5, f"{options}: {numpy.abs(by_vtk - by_core).max()}")


def mappers():
    field = ball((40, 40, 40), (20, 20, 20), 15)
    mapper = stratus.vtkStratusVolumeMapper()
    first = stratus.show(field, mapper=mapper, size=(90, 60))
    check(mapper.GetSamplesTaken() > 0 and mapper.GetCastTime() > 0, "its counters can be asked")
    mapper.SetRenderModeToFirstHit()
    check(not numpy.array_equal(stratus.show(field, mapper=mapper, size=(90, 60)), first), "its settings count")
    mapper.SetRenderModeToComposite()
    check(numpy.array_equal(stratus.show(field, mapper=mapper, size=(90, 60)), first), "and draws again what it drew")


def png():
    picture = stratus.show(ball((20, 20, 20), (10, 10, 10), 8), size=(50, 40), background=None)
    encoded = picture._repr_png_()
    check(isinstance(encoded, bytes) and encoded[:8] == b"\x89PNG\r\n\x1a\n", "notebooks get PNG")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "ball.png")
        picture.save(path)
        reader = vtk.vtkPNGReader()
        reader.SetFileName(path)
        reader.Update()
        back = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(40, 50, 4)[::-1]
        check(numpy.array_equal(back, picture), "what is saved is the picture")
    check(picture[0]._repr_png_() is None, "a row is no picture")


def refusals():
    field = ball((8, 8, 8), (4, 4, 4), 3)
    show = stratus.show
    refuse(ValueError, "(8, 8)", show, field[0])
    refuse(ValueError, "(8, 1, 8)", show, field[:, :1])
    refuse(ValueError, "(0, 8, 8)", show, field[:0])
    refuse(TypeError, "complex64", show, field.astype(numpy.complex64))
    refuse(TypeError, "<U1", show, numpy.full((3, 3, 3), "x"))
    refuse(ValueError, "spacing", show, field, spacing=(1, 0, 1))
    refuse(ValueError, "spacing", show, field, spacing=(1, 1))
    refuse(TypeError, "spacing", show, field, spacing=2)
    refuse(ValueError, "axes", show, field, axes="xyy")
    refuse(ValueError, "opacity", show, field, opacity=2)
    refuse(ValueError, "did you mean viridis?", show, field, color="viridiss")
    refuse(ValueError, "opacity", show, field, opacity=[(0, 0), (1, 1.5)])
    refuse(ValueError, "opacity", show, field, opacity=[])
    refuse(ValueError, "color", show, field, color=[(0, 2, 0, 0)])
    refuse(ValueError, "(255, 0, 0)", show, field, color=(255, 0, 0))
    refuse(ValueError, "color", show, field, color=numpy.array([0.5, -0.5, 0]))
    refuse(ValueError, "size", show, field, size=(0, 10))
    refuse(ValueError, "['roll']", show, field, camera=dict(roll=3))
    mapper = stratus.vtkStratusVolumeMapper()
    mapper.SetBlockSize(3)
    refuse(RuntimeError, "block", show, field, mapper=mapper)
    refuse(RuntimeError, "block", show, field, mapper=mapper)  # the mapper itself reports this only once
    mapper.SetBlockSize(0)
    check(show(field, mapper=mapper, size=(30, 20)).max() > 0 and mapper.GetLastError() == "", "mended, it draws")
    mapper.SetBlockSize(3)
    refuse(RuntimeError, "block", show, field, mapper=mapper)  # not the picture that it drew before
    away = vtk.vtkCamera()
    away.SetPosition(4, 4, 60), away.SetFocalPoint(4, 4, 90)
    refuse(RuntimeError, "camera", show, field, mapper=mapper, camera=away)
    mapper.SetBlockSize(0)
    show(field, mapper=mapper)
    refuse(RuntimeError, "camera", show, field, mapper=mapper, camera=away)
    show(field, mapper=mapper, tolerance=0.01)
    check(mapper.GetImageErrorTolerance() == 0.01, "the tolerance is the mapper's")
    show(field, mapper=mapper)
    check(mapper.GetImageErrorTolerance() == 0.01, "the mapper's tolerance stays")
    image = vtk.vtkImageData()
    image.SetDimensions(4, 4, 4)
    refuse(ValueError, "no scalars", show, image)
    for options in dict(opacity=1j), dict(opacity="x"), dict(color=3), dict(camera=3), dict(camera=dict(zoom="x")), \
            dict(unit_distance="x"), dict(tolerance="x"), dict(mapper=3), dict(background=3), dict(size=5), dict(origin=None):
        refuse(TypeError, next(iter(options)), show, field, **options)
    for options in dict(size=(10.5, 9)), dict(background=(2, 0, 0)), dict(unit_distance=0), dict(unit_distance=numpy.nan), dict(extinction=0), dict(axes=3), \
            dict(tolerance=-1), dict(tolerance=numpy.nan), \
            dict(camera=dict(zoom=0)), dict(camera=dict(azimuth=numpy.inf)), dict(opacity=numpy.nan), dict(origin=(1, 2)), \
            dict(color="no such colour"):
        refuse(ValueError, next(iter(options)), show, field, **options)
    for dtype in numpy.longdouble, object, "M8[s]", "V4":
        refuse(TypeError, "bool, int8", show, numpy.zeros((4, 4, 4), dtype))
    headless = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    code = "import numpy, stratus\nstratus.show(numpy.zeros((4, 4, 4)))"
    ended = subprocess.run([sys.executable, "-c", code], env=headless, capture_output=True, text=True)
    needs_one = vtk.vtkRenderWindow().IsA("vtkXOpenGLRenderWindow")
    check(ended.returncode == needs_one and ("xvfb-run" in ended.stderr) == needs_one,
          "without a display a window of X is an error, not a crash, and any other draws: " + ended.stderr)
    code = "import stratus._show as s\nclass other:\n  def IsA(self, name): return 0\ns._check_display(other())"
    ended = subprocess.run([sys.executable, "-c", code], env=headless, capture_output=True, text=True)
    check(ended.returncode == 0, "a window that is not X's needs no display: " + ended.stderr)


def described(function, name):
    """Text besides the signature."""
    return [line for line in (function.__doc__ or "").splitlines() if line.strip() and not line.startswith(("C++:", name + "("))]


def helps():
    by_vtk = set(vars(vtk.vtkObjectBase)) | {"SafeDownCast", "NewInstance", "GetNumberOfGenerationsFromBase", "GetNumberOfGenerationsFromBaseType"}
    for name in (name for name in dir(stratus) if name.startswith("vtkStratus")):
        one = getattr(stratus, name)
        check(len(one.__doc__ or "") > 200, name + " is described")
        for method, function in vars(one).items():
            if callable(function) and not isinstance(function, type) and not method.startswith("__") and method not in by_vtk:
                overridden = [getattr(base, method) for base in one.__mro__[1:] if hasattr(base, method)]  # or VTK describes the method
                check(any(described(candidate, method) for candidate in [function, *overridden]), f"{name}.{method} is described")
    for function in stratus.show, stratus.as_image, stratus.Picture:
        check(len(function.__doc__ or "") > 50, f"{function} is described")


color_maps()
shares_memory()
axes()
pictures()
masks()
steps()
ranges()
types()
reasons()
without_vtk()
mappers()
png()
refusals()
helps()
done()
