# SPDX-License-Identifier: BSD-3-Clause
"""Values that readers leave in their files as bricks: whatever the file's chunks, order and packing, they are the values that are read into
memory, pictures have the same bits in little memory, and chunks that cannot be read are an error of the mapper."""
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import netCDF4
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "bricks")
os.makedirs(folder, exist_ok=True)
os.chdir(folder)
os.environ["STRATUS_CACHE_DIR"] = ""
LIMIT = 16 << 20
NZ, NY, NX = 140, 151, 201  # 17 MB of floats, above the least that stays in a file
chance = numpy.random.default_rng(44)
z, y, x = numpy.meshgrid(numpy.linspace(-1, 1, NZ), numpy.linspace(-1, 1, NY), numpy.linspace(-1, 1, NX), indexing="ij")
FIELD = (numpy.exp(-4 * (x * x + y * y + z * z)) + 0.05 * chance.random(x.shape)).astype("f4")


def write(name, order="zyx", kind="f4", file_format="NETCDF4", falling="", **options):
    """A file of FIELD and half of it, at two times, with its dimensions in an order; axes in `falling` fall."""
    with netCDF4.Dataset(name, "w", format=file_format) as file:
        file.createDimension("time", 2)
        file.createVariable("time", "f8", ("time",))[:] = (0, 1)
        file["time"].units = "hours since 2001-01-01"
        for axis, count in zip("zyx", (NZ, NY, NX)):
            file.createDimension(axis, count)
            at = file.createVariable(axis, "f8", (axis,))
            at.units, at.axis = "m", axis.upper()
            at[:] = numpy.arange(count)[::-1 if axis in falling else 1]
        variable = file.createVariable("rho", kind, ("time", *order), **options)
        if kind == "i2":
            variable.scale_factor, variable.add_offset = 1e-3, 0.25
        for step in range(2):
            variable[step] = numpy.transpose(FIELD * (1 - 0.5 * step), ["zyx".index(axis) for axis in order])
    return name


def reader_of(name, bricks, step=0):
    reader = stratus.vtkStratusCFReader()
    reader.SetFileName(name)
    reader.SetMapFile(bricks)
    reader.UpdateTimeStep(float(step))
    return reader


def values_of(reader):
    return vtk_to_numpy(reader.GetOutputDataObject(0).GetPointData().GetScalars())


def picture(data, errors=None, least=0.3):
    mapper = stratus.vtkStratusVolumeMapper()
    mapper.SetInputDataObject(data)
    if errors is not None:
        errors.append(errors_of(mapper))
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    look = volume.GetProperty()
    look.SetInterpolationTypeToLinear()
    look.SetScalarOpacityUnitDistance(10)
    opacity, color = look.GetScalarOpacity(), look.GetRGBTransferFunction()
    opacity.RemoveAllPoints(), opacity.AddPoint(least, 0), opacity.AddPoint(1, 0.8)
    color.RemoveAllPoints(), color.AddRGBPoint(0, 0.1, 0.3, 0.9), color.AddRGBPoint(1, 0.9, 0.4, 0.1)
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(200, 150)
    window.AddRenderer(renderer), renderer.AddVolume(volume), renderer.ResetCamera()
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window), grab.ReadFrontBufferOff(), grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).copy()


Reader = stratus.vtkStratusVariableReader
Reader.SetMemoryLimit(LIMIT)
check(Reader.GetMemoryLimit() == LIMIT, "the limit")
Reader.SetMemoryLimit(1)
check(Reader.GetMemoryLimit() == LIMIT, "the least limit")
stratus.vtkStratusCFReader().SetMemoryLimitInMiB(64)
stratus.vtkStratusImageReader().SetMemoryLimitInMiB(0)
check(Reader.GetMemoryLimit() == 64 << 20, "the limit is all readers', and 0 leaves it")
Reader.SetMemoryLimit(LIMIT)

paged = reader_of(write("plain.nc", chunksizes=(1, 8, 32, 32), zlib=True, complevel=1), True)
if not paged.GetMapped():
    print("SKIPPED: this system offers no pages that stop their readers")
    sys.exit(77)
check(Reader.GetMemoryUsed() == 0, "nothing is read before something looks")
one = values_of(paged)[(80 * NY + 100) * NX + 50]
check(one == FIELD[80, 100, 50], "a value")
check(0 < Reader.GetMemoryUsed() <= 16 * NY * NX * 4 + (1 << 20), "one value needs a row of chunks, and its neighbour that shares a page")
plain = reader_of("plain.nc", False)
check(not plain.GetMapped(), "plain values are in memory")
reference = picture(plain.GetOutputDataObject(0))
check(reference.max() > 50, "something shows")
check((picture(paged.GetOutputDataObject(0)) == reference).all(), "a picture in little memory has the same bits")
check(Reader.GetMemoryUsed() <= LIMIT, "memory is within the limit")

# VTK wants the range of an array. Each value is read once for it, and none again for the range of finite values.
ranged, begin = reader_of("plain.nc", True), Reader.GetBytesRead()
scalars = ranged.GetOutputDataObject(0).GetPointData().GetScalars()
check(scalars.IsA("vtkFloatArray") and scalars.GetRange() == (FIELD.min(), FIELD.max()), f"the range {scalars.GetRange()}")
check(Reader.GetBytesRead() - begin == FIELD.nbytes, f"{Reader.GetBytesRead() - begin} bytes are read for the range")
check(scalars.NewInstance().GetClassName() == "vtkFloatArray", "copies are plain arrays")
with netCDF4.Dataset(write("gaps.nc", chunksizes=(1, 8, 32, 32)), "a") as file:
    file["rho"][0, 3, 4, 5], file["rho"][0, 13, 14, 15] = numpy.nan, numpy.inf
for bricks in False, True:
    scalars = reader_of("gaps.nc", bricks).GetOutputDataObject(0).GetPointData().GetScalars()
    check(scalars.GetRange() == (FIELD.min(), numpy.inf) and scalars.GetFiniteRange() == (FIELD.min(), FIELD.max()),
          f"ranges with gaps: {scalars.GetRange()}, {scalars.GetFiniteRange()}, {bricks}")
del ranged, scalars

# Value ranges read all values once, by threads that share pages, in memory that another array fills. Rays then read only chunks that they
# meet.
fresh, begin = reader_of("plain.nc", True), Reader.GetBytesRead()
check(picture(fresh.GetOutputDataObject(0), least=0.9).max() > 20, "something shows of the middle")
check(Reader.GetBytesRead() - begin < 1.2 * FIELD.nbytes, "only chunks of the middle are read twice")
del fresh

for name, options in {
        "falling.nc": dict(chunksizes=(1, 40, 33, 17), zlib=True, complevel=1, falling="zx"), "turned.nc": dict(order="xzy", chunksizes=(2, 30, 50, 64)),
        "whole.nc": dict(contiguous=True, falling="y"), "classic.nc": dict(file_format="NETCDF3_64BIT_OFFSET"),
        "packed.nc": dict(kind="i2", chunksizes=(1, 1, NY, NX), zlib=True, complevel=1), "double.nc": dict(kind="f8", chunksizes=(1, 10, 16, 64)),
        "checked.nc": dict(chunksizes=(1, 10, NY, NX), fletcher32=True)}.items():
    write(name, **options)
    for step in range(2):
        bricks, whole = reader_of(name, True, step), reader_of(name, False, step)
        check(bool(bricks.GetMapped()) and not whole.GetMapped(), f"{name} is in bricks")
        got, expected = values_of(bricks), values_of(whole)
        check(got.dtype == expected.dtype and numpy.array_equal(got, expected), f"{name} at {step} has its values")
        check(bricks.GetOutputDataObject(0).GetBounds() == whole.GetOutputDataObject(0).GetBounds(), f"{name} at {step} is on its grid")
    check(Reader.GetMemoryUsed() <= LIMIT, f"{name} stays within the limit")

# Bricks outlive their reader, and end with their array.
data = vtk.vtkImageData()
data.ShallowCopy(paged.GetOutputDataObject(0))
del paged, bricks, got
used = Reader.GetMemoryUsed()
check(vtk_to_numpy(data.GetPointData().GetScalars())[7] == FIELD.ravel()[7], "values outlive their reader")
check(used <= LIMIT, "bricks of another array went")
del data
check(Reader.GetMemoryUsed() == 0, "bricks end with their arrays")

# Once the time changes, parts of the next step are read before something looks at them; steps that were shown are not read again.
with netCDF4.Dataset("steps.nc", "w") as file:
    for axis, count in (("time", 3), ("z", 64), ("y", 64), ("x", 64)):
        file.createDimension(axis, count)
    file.createVariable("time", "f8", ("time",))[:] = (0, 1, 2)
    file["time"].units = "hours since 2001-01-01"
    steps = file.createVariable("rho", "f4", ("time", "z", "y", "x"), chunksizes=(1, 16, 64, 64))
    steps[:] = numpy.arange(3 * 64 ** 3).reshape(3, 64, 64, 64)
playing = stratus.vtkStratusCFReader()
playing.SetFileName("steps.nc"), playing.MapFileOn(), playing.SetMappedBytesLeast(1)


def first_value(step):
    playing.UpdateTimeStep(float(step))
    return values_of(playing)[5]


begin = Reader.GetBytesRead()
check(first_value(0) == 5, "the first step")
one_step = Reader.GetBytesRead() - begin
time.sleep(0.3)
check(one_step > 0 and Reader.GetBytesRead() - begin == one_step, "no step is read ahead before the time changes")
check(first_value(1) == 64 ** 3 + 5, "the second step")
for _ in range(500):
    if Reader.GetBytesRead() - begin >= 3 * one_step:
        break
    time.sleep(0.02)
check(Reader.GetBytesRead() - begin == 3 * one_step, "the next step is read ahead where this one was")
check(first_value(2) == 2 * 64 ** 3 + 5 and Reader.GetBytesRead() - begin == 3 * one_step, "the third step")
check(first_value(0) == 5 and Reader.GetBytesRead() - begin == 3 * one_step, "a step that was shown is not read again")
del playing

# Arrays of few values are read at once.
small = stratus.vtkStratusCFReader()
small.SetFileName("plain.nc"), small.MapFileOn(), small.SetMappedBytesLeast(1 << 30), small.Update()
check(not small.GetMapped(), "less than the least is in memory")

# A chunk whose bytes are wrong: its values are NaN, and the mapper says so.
with open("checked.nc", "r+b") as file:
    size = os.path.getsize("checked.nc")
    file.seek(size // 4)
    file.write(bytes(range(256)))
damaged = reader_of("checked.nc", True)
values = values_of(damaged)
check(0 < numpy.isnan(values).sum() <= 10 * NY * NX, "only values of the damaged chunk are missing")
heard = []
picture(damaged.GetOutputDataObject(0), heard)
check(any("missing" in text for text in heard[0]), "the mapper reports values that are missing")
del values, damaged

# A raw file of more than the limit is in bricks, a smaller one is mapped.
for count, bricks in ((NZ, True), (60, False)):
    FIELD[:count].tofile("field.raw")
    raw = stratus.vtkStratusImageReader()
    raw.SetFileName("field.raw"), raw.SetRawLayout((NX, NY, count), vtk.VTK_FLOAT, False, (1, 1, 1), 0)
    raw.SetMappedBytesLeast(1), raw.Update()
    check(bool(raw.GetMapped()), f"{count} layers stay in the file")
    check(numpy.array_equal(values_of(raw), FIELD[:count].ravel()), f"{count} layers of a raw file")
    check((Reader.GetMemoryUsed() > 0) == bricks, f"{count} layers are {'bricks' if bricks else 'mapped'}")
    check(Reader.GetMemoryUsed() <= LIMIT, "a raw file stays within the limit")
    with open("field.raw", "r+b") as file:
        file.truncate(1000)
    heard = []
    picture(raw.GetOutputDataObject(0), heard)
    check(any("missing" in text for text in heard[0]), "a file that is cut short is an error")
    del raw
# A large file that was drawn before: while a camera moves, and before the exact picture if someone waits for it, a coarse copy is shown.
os.environ["STRATUS_CACHE_DIR"] = os.path.join(os.getcwd(), "cache")
size = (420, 410, 400)  # more than 2^26 values, of which a copy is kept
place = numpy.linspace(-1, 1, size[0])[None, None], numpy.linspace(-1, 1, size[1])[None, :, None], numpy.linspace(-1, 1, size[2])[:, None, None]
large = numpy.maximum(0, 255 * (1 - 2 * (place[0] ** 2 + place[1] ** 2 + place[2] ** 2))).astype("u1")
large.tofile("large.raw")


class Scene:
    def __init__(self):
        self.raw = stratus.vtkStratusImageReader()
        self.raw.SetFileName("large.raw"), self.raw.SetRawLayout(size, vtk.VTK_UNSIGNED_CHAR, False, (1, 1, 1), 0)
        self.mapper = stratus.vtkStratusVolumeMapper()
        self.mapper.SetInputConnection(self.raw.GetOutputPort())
        volume = vtk.vtkVolume()
        volume.SetMapper(self.mapper)
        look = volume.GetProperty()
        look.SetInterpolationTypeToLinear(), look.SetScalarOpacityUnitDistance(20)
        look.GetScalarOpacity().RemoveAllPoints(), look.GetScalarOpacity().AddPoint(60, 0), look.GetScalarOpacity().AddPoint(250, 0.9)
        self.window, self.renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
        self.window.SetOffScreenRendering(1), self.window.SetMultiSamples(0), self.window.SetSize(160, 120)
        self.window.AddRenderer(self.renderer), self.renderer.AddVolume(volume)
        self.window.SetDesiredUpdateRate(0.0001)
        self.raw.Update(), self.renderer.ResetCamera()

    def draw(self):
        self.window.Render()
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(self.window), grab.ReadFrontBufferOff(), grab.ShouldRerenderOff(), grab.Update()
        return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(int)


scene = Scene()
exact = scene.draw()
check(exact.max() > 30 and not scene.mapper.GetLastPictureIsCoarse(), "a picture that is drawn once is exact")
del scene
scene = Scene()
asked = []
scene.mapper.AddObserver("UpdateEvent", lambda *_: asked.append(1))
first = scene.draw()
check(scene.mapper.GetLastPictureIsCoarse() and len(asked) == 1, "the first picture is coarse")
error = numpy.sqrt(numpy.mean((first - exact) ** 2.0))
check(0 < error < 6, f"it looks like the exact one ({error:.2f} of 255)")
check(Reader.GetMemoryUsed() < 1 << 20, "nothing was read for it")
second = scene.draw()
check(not scene.mapper.GetLastPictureIsCoarse() and (second == exact).all() and len(asked) == 1, "the next one is exact, to the bit")
scene.window.SetDesiredUpdateRate(30)
scene.renderer.GetActiveCamera().Azimuth(40)
scene.draw()
check(scene.mapper.GetLastPictureIsCoarse(), "a moving camera does not wait")
scene.window.SetDesiredUpdateRate(0.0001)
while True:
    scene.draw()
    if not scene.mapper.GetLastPictureIsCoarse():
        break
check(0 < Reader.GetMemoryUsed() <= LIMIT, "memory is within the limit")
del scene
check(Reader.GetMemoryUsed() == 0, "the sum of errors is the mapper's")

done()
