# SPDX-License-Identifier: BSD-3-Clause
"""NumPy volumes for people: stratus.show draws from the array's own memory, says what it can't, and help() tells every method."""
import os
import subprocess
import sys
import tempfile

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def refuse(kind, words, call, *arguments, **options):
    try:
        call(*arguments, **options)
    except kind as error:
        check(words in str(error), f"'{words}' in the error: {error}")
    else:
        check(False, f"{words}: {options} is refused")


def ball(shape, center, radius):
    """1 in the middle, 0 at the radius and beyond; shape and center along z, y, x."""
    z, y, x = numpy.ogrid[tuple(slice(0, n) for n in shape)]
    square = (z - center[0]) ** 2 + (y - center[1]) ** 2 + (x - center[2]) ** 2
    return numpy.maximum(0, 1 - square / radius**2).astype(numpy.float32)


def shares_memory():
    for dtype in numpy.float32, numpy.float64, numpy.int16, numpy.uint8, numpy.int64, bool:
        array = (100 * ball((8, 10, 12), (4, 5, 6), 4)).astype(dtype)
        image = stratus.as_image(array, spacing=(1, 2, 3), origin=(-1, 0, 1))
        values = vtk_to_numpy(image.GetPointData().GetScalars())
        check(numpy.shares_memory(values, array), f"{array.dtype}: not copied")
        check(image.GetDimensions() == (12, 10, 8) and image.GetSpacing() == (1, 2, 3) and image.GetOrigin() == (-1, 0, 1), "the grid")
        array[2, 3, 4] = 1
        check(image.GetScalarComponentAsDouble(4, 3, 2, 0) == 1, f"{array.dtype}: array[z, y, x] is what the image holds at x, y, z")
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
    check(numpy.allclose(point, (5 + 7 * 1, 6 + 9 * 2, 7 + 11 * 3)), f"xyz: the last value lies at {point}")
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
    camera = vtk.vtkCamera()
    camera.SetPosition(10, 10, 60), camera.SetFocalPoint(10, 10, 10)
    check(stratus.show(field, camera=camera, size=(90, 60), background=None)[30, 45, 3] > 0, "a camera of one's own")
    constant = stratus.show(numpy.full((4, 4, 4), 7.0), size=(20, 20))
    check(constant.shape == (20, 20, 4), "one value everywhere")
    holes = field.copy()
    holes[:10] = numpy.nan
    check(not numpy.array_equal(stratus.show(holes, size=(90, 60)), stratus.show(field, size=(90, 60))), "what is no number shows nothing")


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
    refuse(TypeError, "float16", show, field.astype(numpy.float16))
    refuse(TypeError, ">f4", show, field.astype(">f4"))
    refuse(TypeError, "<U1", show, numpy.full((3, 3, 3), "x"))
    refuse(ValueError, "spacing", show, field, spacing=(1, 0, 1))
    refuse(ValueError, "spacing", show, field, spacing=(1, 1))
    refuse(TypeError, "spacing", show, field, spacing=2)
    refuse(ValueError, "axes", show, field, axes="xyy")
    refuse(ValueError, "opacity", show, field, opacity=2)
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
    refuse(RuntimeError, "block", show, field, mapper=mapper)  # which the mapper itself tells only once
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
    alone = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    code = "import numpy, stratus\nstratus.show(numpy.zeros((4, 4, 4)))"
    ended = subprocess.run([sys.executable, "-c", code], env=alone, capture_output=True, text=True)
    check(ended.returncode == 1 and "xvfb-run" in ended.stderr, "without a display there is an error, not a crash: " + ended.stderr)


def told(function, name):
    """Text besides the signature."""
    return [line for line in (function.__doc__ or "").splitlines() if line.strip() and not line.startswith(("C++:", name + "("))]


def helps():
    by_vtk = set(vars(vtk.vtkObjectBase)) | {"SafeDownCast", "NewInstance", "GetNumberOfGenerationsFromBase", "GetNumberOfGenerationsFromBaseType"}
    for name in (name for name in dir(stratus) if name.startswith("vtkStratus")):
        one = getattr(stratus, name)
        check(len(one.__doc__ or "") > 200, name + " is told")
        for method, function in vars(one).items():
            if callable(function) and not isinstance(function, type) and not method.startswith("__") and method not in by_vtk:
                overridden = [getattr(base, method) for base in one.__mro__[1:] if hasattr(base, method)]  # VTK tells what it is for
                check(any(told(candidate, method) for candidate in [function, *overridden]), f"{name}.{method} is told")
    for function in stratus.show, stratus.as_image, stratus.Picture:
        check(len(function.__doc__ or "") > 50, f"{function} is told")


shares_memory()
axes()
pictures()
mappers()
png()
refusals()
helps()
sys.exit(1 if failures else 0)
