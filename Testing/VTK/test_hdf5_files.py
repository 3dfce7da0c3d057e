# SPDX-License-Identifier: BSD-3-Clause
"""Chunks of HDF5 that several threads read: whatever their filters, sizes and types, values are those that libnetcdf reads."""
import os
import sys
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done

import warnings

import netCDF4
import numpy
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
    check(f"{name} is in bricks", bool(bricks.GetMapped()) and not whole.GetMapped())
    check(f"{name} has its values", same(in_two_threads(values_of(bricks)), values_of(whole)))

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
        check(f"'{name}' at {step} is filled", numpy.array_equal(*got, equal_nan=True))
        check(f"'{name}' at {step} has {('some', 'no', 'some', 'all')[2 * (name == 'usual') + step]} values",
              numpy.isfinite(got[0]).sum() == {("filled", 1): 0, ("usual", 1): 24000}.get((name, step), 9 * 8 * 40))

done()
