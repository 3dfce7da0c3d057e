# SPDX-License-Identifier: BSD-3-Clause
"""Chunks of HDF5 that several threads read: whatever their filters, sizes and types, values are those that libhdf5 reads, of netCDF-4, of
images of VTKHDF and of plain HDF5. A damaged chunk is missing, and wrong files are refused."""
import os
import sys
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import warnings

import netCDF4
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "hdf5")
os.makedirs(folder, exist_ok=True)
os.chdir(folder)
os.environ["STRATUS_CACHE_DIR"] = ""
warnings.simplefilter("ignore", UserWarning)  # of the other order of bytes
NZ, NY, NX = SIZE = 40, 51, 61
chance = numpy.random.default_rng(5)
FIELD = numpy.cumsum(chance.normal(size=SIZE), axis=2).astype("f4")
NOISE = chance.integers(0, 2 ** 32, SIZE, dtype="u4").view("f4")  # bytes that do not deflate
NOISE[~numpy.isfinite(NOISE)] = 1
Reader = stratus.vtkStratusVariableReader


def values_of(reader, cells=False):
    data = reader.GetOutputDataObject(0)
    attributes = data.GetCellData() if cells else data.GetPointData()
    return vtk_to_numpy(attributes.GetScalars() or attributes.GetVectors())


def same(one, other):
    return one.dtype == other.dtype and one.tobytes() == other.tobytes()


def in_two_threads(values):
    """A copy whose halves two threads make, so that parts of one array are read at once."""
    copy = numpy.empty_like(values)
    half = len(values) // 2

    def work(part):
        copy[part] = values[part]
    threads = [threading.Thread(target=work, args=(part,)) for part in (slice(half), slice(half, None))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return copy


# ---- netCDF-4
def write(name, field, dimensions="zyx", path="run/rho", **options):
    with netCDF4.Dataset(name, "w") as file:
        for axis, count in zip(dimensions, SIZE):
            file.createDimension(axis, count)
        variable = file.createVariable(path, field.dtype, tuple(dimensions), **options)
        variable[:] = field
    return name


def reader_of(name, bricks):
    reader = stratus.vtkStratusCFReader()
    reader.SetFileName(name), reader.SetMapFile(bricks), reader.SetMappedBytesLeast(0)
    reader.Update()
    return reader


paged = reader_of(write("deflated.nc", FIELD, chunksizes=(7, 16, 20), zlib=True), True)
if not paged.GetMapped():
    print("SKIPPED: this system offers no pages that stop their readers")
    sys.exit(77)
everything = dict(zlib=True, shuffle=True, fletcher32=True)
files = {
    "deflated.nc": None, "all.nc": dict(field=FIELD, chunksizes=(7, 16, 20), **everything),
    "noise.nc": dict(field=NOISE, chunksizes=(7, 16, 20), zlib=True, shuffle=False),  # deflate is left out where it does not help
    "noise_all.nc": dict(field=NOISE, chunksizes=(9, 51, 61), **everything), "chunks.nc": dict(field=FIELD, chunksizes=(40, 5, 61)),
    "checked.nc": dict(field=FIELD[:, :, ::-1], chunksizes=(3, 17, 61), fletcher32=True),
    "i1.nc": dict(field=(FIELD * 3).astype("i1"), chunksizes=(7, 16, 20), **everything),
    "u2.nc": dict(field=numpy.abs(FIELD * 99).astype("u2"), chunksizes=(7, 16, 20), **everything),
    "i8.nc": dict(field=(FIELD * 1e9).astype("i8"), chunksizes=(7, 16, 21), **everything),
    "f8.nc": dict(field=FIELD.astype("f8"), chunksizes=(39, 50, 60), **everything),
    "big.nc": dict(field=FIELD, chunksizes=(7, 16, 20), endian="big", **everything),  # read by libnetcdf
    "named.nc": dict(field=FIELD, dimensions=("z", "y", "rho"), path="rho", chunksizes=(7, 16, 20), zlib=True),  # HDF5 has another name
    "szip.nc": dict(field=FIELD, chunksizes=(8, 16, 20), compression="szip")}
for name, options in files.items():
    try:
        options is None or write(name, **options)
    except RuntimeError as error:  # a library without szip
        print(f"{name} is left out: {error}")
        continue
    bricks, whole = reader_of(name, True), reader_of(name, False)
    check(bool(bricks.GetMapped()) and not whole.GetMapped(), f"{name} is in bricks")
    check(same(in_two_threads(values_of(bricks)), values_of(whole)), f"{name} has its values")

# Chunks that were never written, and values behind the end of a data set.
with netCDF4.Dataset("partly.nc", "w") as file:
    file.createDimension("time", None), file.createDimension("z", 20), file.createDimension("y", 30), file.createDimension("x", 40)
    for name, fill in (("filled", -5.0), ("usual", None)):
        file.createVariable(name, "f4", ("time", "z", "y", "x"), chunksizes=(1, 8, 8, 8), zlib=True, fill_value=fill)
        file[name][0, :9, 8:16] = 7
    file["usual"][1] = 8  # the first variable has one time in the file, and two by its dimension
for name in ("filled", "usual"):
    for step in range(2):
        got = []
        for bricks in (True, False):
            reader = stratus.vtkStratusCFReader()
            reader.SetFileName("partly.nc"), reader.SetVariableName(name), reader.SetMapFile(bricks), reader.SetMappedBytesLeast(0)
            reader.UpdateTimeStep(float(step))
            got.append(values_of(reader).copy())
        check(numpy.array_equal(*got, equal_nan=True), f"'{name}' at {step} is filled")
        check(numpy.isfinite(got[0]).sum() == {("filled", 1): 0, ("usual", 1): 24000}.get((name, step), 9 * 8 * 40),
              f"'{name}' at {step} has {('some', 'no', 'some', 'all')[2 * (name == 'usual') + step]} values")


# ---- images of VTKHDF
def write_image(name, arrays, extent=(0, NX - 1, 0, NY - 1, 0, NZ - 1), kind="ImageData", version=(1, 0), steps=(), **options):
    """arrays: {"PointData/rho": values}. Files of netCDF-4 are HDF5 in which groups have attributes."""
    with netCDF4.Dataset(name, "w") as file:
        root = file.createGroup("VTKHDF")
        root.Version, root.Type = numpy.array(version, "i8"), kind
        root.WholeExtent = numpy.array(extent, "i8")
        root.Origin, root.Spacing = numpy.array((1.0, 2, 3)), numpy.array((0.5, 1, 2))
        root.Direction = numpy.array((0.0, 1, 0, -1, 0, 0, 0, 0, 1))
        root.createGroup("PointData"), root.createGroup("CellData")
        if steps:
            group = root.createGroup("Steps")
            group.NSteps = numpy.int64(len(steps))
            arrays = {**arrays, "Steps/Values": numpy.array(steps)}
        for path, values in arrays.items():
            dimensions = []
            for size in values.shape:
                dimensions.append(f"n{size}")
                if dimensions[-1] not in file.dimensions:
                    file.createDimension(dimensions[-1], size)
            how = options if values.ndim > 2 else {}
            root.createVariable(path, values.dtype, dimensions, fill_value=False, **how)[:] = values
    return name


def image_of(name, variable=None, map_file=False, step=None):
    reader = stratus.vtkStratusHDF5Reader()
    reader.SetFileName(name), reader.SetVariableName(variable), reader.SetMapFile(map_file), reader.SetMappedBytesLeast(0)
    heard = errors_of(reader)
    reader.Update() if step is None else reader.UpdateTimeStep(step)
    reader.heard = heard
    return reader


def by_vtk(name):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(name), reader.UpdateInformation()
    reader.GetCellDataArraySelection().DisableAllArrays()  # VTK 9.1 reads cells by the sizes of points
    reader.Update()
    return reader.GetOutputDataObject(0)


def frame_of(image):
    matrix = image.GetDirectionMatrix()
    return image.GetExtent(), image.GetOrigin(), image.GetSpacing(), [matrix.GetElement(i, j) for i in range(3) for j in range(3)]


CELLS = (chance.random((NZ - 1, NY - 1, NX - 1)) * 999).astype("i2")
WIND = chance.random((*SIZE, 3))
arrays = {"PointData/rho": FIELD, "PointData/wind": WIND, "CellData/mass": CELLS}
for name, options in {"pieces.vtkhdf": {}, "chunks.vtkhdf": dict(zlib=True, fletcher32=True), "big.hdf": dict(endian="big")}.items():
    expected = by_vtk(write_image(name, arrays, **options))
    check(stratus.vtkStratusHDF5Reader.CanReadFile(name) == 1, f"{name} can be read")
    for limit in (0, 16 << 20):
        Reader.SetMemoryLimit(limit)
        for map_file in (False, True):
            for variable in ("rho", "wind", "mass"):
                reader = image_of(name, variable, map_file)
                output, cells = reader.GetOutputDataObject(0), variable == "mass"
                check(bool(reader.GetMapped()) == map_file, f"{variable} of {name} is {'left in the file' if map_file else 'read'}")
                check(frame_of(output) == frame_of(expected), f"{variable} of {name} has its frame")
                reference = CELLS.ravel() if cells else vtk_to_numpy(expected.GetPointData().GetArray(variable))
                check(same(in_two_threads(values_of(reader, cells)), reference), f"{variable} of {name} has its values")
    check([reader.GetNameOfVariable(i) for i in range(3)] == ["rho", "wind", "mass"], f"variables of {name}")

large = write_image("large.hdf", {"PointData/rho": numpy.tile(FIELD, (40, 1, 1))}, (0, NX - 1, 0, NY - 1, 0, 40 * NZ - 1))
used = Reader.GetBytesRead()
reader = image_of(large, map_file=True)
check(same(values_of(reader), numpy.tile(FIELD, (40, 1, 1)).ravel()), "values in one piece that are larger than the limit")
check(reader.GetMapped() and Reader.GetBytesRead() >= used + 40 * FIELD.nbytes and Reader.GetMemoryUsed() <= 16 << 20, "are in bricks")
Reader.SetMemoryLimit(0)

# Time, blanks, a flat image, arrays that do not fit.
ghosts = numpy.zeros(SIZE, "u1")
ghosts[3, 4, 5] = 2
write_image("steps.vtkhdf", {
    "PointData/rho": numpy.stack([FIELD, 2 * FIELD]), "PointData/still": FIELD, "PointData/short": FIELD[1:], "PointData/vtkGhostType": ghosts,
    "CellData/mass": numpy.stack([CELLS, CELLS + 1, CELLS + 2]), "CellData/still": CELLS,
    "Steps/PointDataOffsets/rho": numpy.array((1, 0, 1))}, version=(2, 0), steps=(0.5, 1.0, 4.0), zlib=True)
for map_file in (False, True):
    for step, (time, factor) in enumerate(((0.5, 2), (1.0, 1), (4.0, 2))):
        for variable, expected in (("rho", factor * FIELD), ("mass", CELLS + step), ("still", FIELD)):
            reader = image_of("steps.vtkhdf", variable, map_file, time)
            check(same(values_of(reader, variable == "mass"), expected.astype(expected.dtype).ravel()), f"{variable} at {time}")
            blank = reader.GetOutputDataObject(0).GetPointData().GetArray("vtkGhostType")
            check(blank is not None and same(vtk_to_numpy(blank), ghosts.ravel()), "blanked points")
for words in ("'short' of the size 39 x 51 x 61", "'still' of cells"):
    check(words in reader.GetDescription(), "an array that is left out")
flat = image_of(write_image("flat.vtkhdf", {"PointData/rho": FIELD[0]}, (0, NX - 1, 0, NY - 1, 3, 3)))
check(same(values_of(flat), FIELD[0].ravel()), "a flat image")
many = image_of(write_image("negative.vtkhdf", arrays, (-7, NX - 8, -1, NY - 2, 4, NZ + 3)))
check(many.GetOutputDataObject(0).GetExtent() == (-7, NX - 8, -1, NY - 2, 4, NZ + 3), "an extent that does not begin at 0")
check(same(values_of(many), FIELD.ravel()), "has its values")

# ---- any HDF5
write("plain.h5", FIELD, chunksizes=(7, 16, 20), zlib=True)
plain = image_of("plain.h5", "/run/rho", True)
check(same(values_of(plain), FIELD.ravel()) and plain.GetMapped(), "a data set by its path")
check(frame_of(plain.GetOutputDataObject(0))[:3] == ((0, NX - 1, 0, NY - 1, 0, NZ - 1), (0, 0, 0), (1, 1, 1)), "has a plain frame")
check(plain.GetNameOfVariable(0) == "/run/rho" and plain.GetNumberOfVariables() == 1, "is the first")

# ---- files that are wrong
for name, words, options in (
        ("later", "version of the VTKHDF file is 3", dict(version=(3, 0))), ("table", "'UnstructuredGrid'", dict(kind="UnstructuredGrid")),
        ("small", "no array of numbers of its size", dict(extent=(0, 9, 0, 9, 0, 9))),
        ("falls", "must rise", dict(extent=(9, 0, 0, 9, 0, 9)))):
    reader = image_of(write_image(f"{name}.hdf", {"PointData/rho": FIELD}, **options))
    check(any(words in text for text in reader.heard), f"an image that is {name}")
write_image("astray.hdf", {"PointData/rho": FIELD[None], "Steps/PointDataOffsets/rho": numpy.array((0, 1))}, version=(2, 0), steps=(0.0, 1.0))
check(any("index 1, must be from 0 to below 1" in text for text in image_of("astray.hdf", step=1.0).heard), "a step behind the end")
check(stratus.vtkStratusHDF5Reader.CanReadFile("table.hdf") == 0, "another type is VTK's")
check(any("those that are: rho, wind, mass" in text for text in image_of("pieces.vtkhdf", "none").heard), "another name is refused")
with open("no.h5", "w") as file:
    file.write("no HDF5 at all")
check(any("no HDF5 file" in text for text in image_of("no.h5").heard), "another format is refused")
check(stratus.vtkStratusHDF5Reader.CanReadFile("no.h5") == 0, "and is not ours")

# A damaged chunk.
size = os.path.getsize(write_image("damaged.hdf", {"PointData/rho": FIELD}, zlib=True, fletcher32=True, chunksizes=(5, 51, 61)))
with open("damaged.hdf", "r+b") as file:
    file.seek(size // 2), file.write(bytes(64))
check(any("cannot be read" in text for text in image_of("damaged.hdf").heard), "a damaged image is refused")
damaged = image_of("damaged.hdf", map_file=True)
missing = numpy.isnan(values_of(damaged))
check(missing.sum() == 5 * NY * NX, "only a damaged chunk is missing")
check(same(values_of(damaged)[~missing], FIELD.ravel()[~missing]), "others have their values")
mapper, volume = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume()
mapper.SetInputDataObject(damaged.GetOutputDataObject(0)), volume.SetMapper(mapper)
heard = errors_of(mapper)
window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
window.SetOffScreenRendering(1), window.AddRenderer(renderer), renderer.AddVolume(volume), renderer.ResetCamera(), window.Render()
check(any("missing" in text for text in heard), "the mapper reports it")
del missing, damaged, mapper, volume, renderer, window

done()
