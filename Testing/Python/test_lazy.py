#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Lazy arrays that are larger than the memory they may take: the same bits as in memory, each chunk read about once, exceptions of the array as
errors of the picture, and no thread that waits forever."""
from checking import Chunks, ball, check, done, refuse

import faulthandler
import gc
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
import warnings

import numpy
import stratus_volume._core
import stratus_volume._lazy
from stratus_volume import NothingShown, Volume, render, render_several, show
from stratus_volume._grid import LazyGrid
from stratus_volume._lazy import bytes_of, lazy_of
from stratus_volume._pages import pool

stratus_volume._lazy._BYTES_LEAST = 1 << 12  # so that small arrays have several bricks
stratus_volume._core._PATIENCE = 1
faulthandler.dump_traceback_later(900, exit=True)  # a thread that waits forever ends the test
if not pool().report.paged:
    print("SKIPPED: this system does not let a process wait for its own pages (userfaultfd)")
    sys.exit(77)

host = dict(device="host", size=(60, 45))
points = [(0, 0), (1, 0.5)]
LEAST = 16e6


def alike(array, values, what, opacity=points, place=None, **look):
    """The pictures of a lazy array and of the same values in memory are the same to the bit."""
    volume = Volume(array, device="host", memory=LEAST, **(place or {}))
    check(isinstance(volume.grid, LazyGrid), f"{what}: it is read in parts")
    wanted = Volume(values, device="host", **(place or {}))
    for camera in None, dict(azimuth=130, elevation=-40):
        one, other = (each.render(opacity, size=host["size"], camera=camera, **look) for each in (volume, wanted))
        check(numpy.array_equal(one.rgba, other.rgba) and numpy.array_equal(one.depth, other.depth), f"{what}: the picture")
        check(one.rgba.max() > 0.05, f"{what}: something shows")
    return volume


def types():
    field = ball((24, 30, 44), (12, 15, 20), 14)
    for kind in "<f4", ">f4", "<f8", ">f8", "<f2", "|i1", "|u1", "<i2", ">i2", "<u2", ">i4", "<i8", "<u8", "?":
        values = (field > 0.4) if kind == "?" else (field * 100 - 20 * (kind[1] == "i")).astype(kind) if kind[1] in "iu" else field.astype(kind)
        function = points if kind[1:2] == "f" or kind == "?" else [(0, 0), (100, 0.5)]
        alike(Chunks(values, (7, 16, 9)), values, kind, function)
        alike(Chunks(values, (7, 16, 9)), values, f"{kind}, functions by the values", None)
    alike(Chunks(field), field, "without chunks")
    alike(Chunks(field, (24, 30, 44)), field, "one chunk")
    for scale in 1e38, 1e-36:
        alike(Chunks(field * numpy.float32(scale), (8, 8, 8)), field * numpy.float32(scale), f"times {scale}", [(0, 0), (scale, 0.5)])
    huge = field.astype(float) * 1e300
    alike(Chunks(huge, (8, 8, 8)), huge, "doubles times 1e300", [(0, 0), (1e300, 0.5)])
    holes = numpy.where(field > 0.7, numpy.nan, field)
    alike(Chunks(holes, (8, 8, 8)), holes, "with NaN")
    marks = (ball(field.shape, (12, 15, 20), 8) > 0).astype(numpy.uint8)
    alike(Chunks(field, (8, 8, 8)), field, "labels", labels=marks, looks={1: dict(opacity=[(0, 0), (1, 0.9)], color=(1, 0, 0))})
    alike(Chunks(field, (8, 8, 8)), field, "light", shade=True)
    alike(Chunks(field, (8, 8, 8)), field, "maximum", mode="maximum")
    alike(Chunks(field, (8, 8, 8)), field, "isosurface", mode="isosurface", contours=0.5)
    one, other = (render(data, points, quantities=("integral", "maximum_depth"), **host, **more).quantities for data, more in
                  ((Chunks(field, (8, 8, 8)), dict(memory=LEAST)), (field, {})))
    check(all(numpy.array_equal(one[name], other[name], equal_nan=True) for name in one), "quantities")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        nothing = render(Chunks(numpy.full((8, 8, 8), numpy.nan), (4, 4, 4)), memory=LEAST, **host)
    check(nothing.rgba.max() == 0 and [each.category for each in caught] == [NothingShown] and "512 NaN" in str(caught[0].message), "only NaN")


def axes():
    field = ball((20, 30, 44), (9, 15, 20), 14)
    for order in "zyx", "xyz", "yxz", "zxy":
        place = dict(axes=order, spacing=(1, 2, 0.5), origin=(5, -3, 1))
        volume = alike(Chunks(field, (6, 7, 8)), field, f"axes {order}", place=place)
        check(volume.bounds == Volume(field, device="host", **place).bounds, f"bounds of {order}")
    one, other = ([(data, dict(opacity=points, **more)), (field, dict(opacity=points, origin=(10, 0, 0)))] for data, more in
                  ((Chunks(field, (6, 7, 8)), dict(memory=LEAST)), (field, {})))
    check(numpy.array_equal(*(render_several(items, **host).rgba for items in (one, other))), "several volumes")
    check(numpy.array_equal(show(Chunks(field, (6, 7, 8)), points, memory=LEAST, **host), show(field, points, **host)), "show")


def large():
    """An array of twice the memory. Each chunk is read once for the ranges, and once more if a ray meets it."""
    field = ball((160, 200, 250), (80, 60, 60), 50)
    array = Chunks(field, (40, 40, 50))
    volume = Volume(array, device="host", memory=LEAST)
    look = dict(opacity=[(0.3, 0), (0.6, 0.8)], size=(120, 90))
    check(numpy.array_equal(volume.render(**look).rgba, render(field, device="host", **look).rgba), "larger than its memory")
    all_of, once = 4 * 5 * 5, sum(array.counts.values())
    check(len(array.counts) == all_of and max(array.counts.values()) <= 3 and once <= 1.5 * all_of, f"chunks are read about once: {once} of {all_of}")
    array.counts.clear()
    for azimuth in range(0, 360, 40):
        volume.render(camera=dict(azimuth=azimuth), **look)
    empty = [key for key in array.counts if field[tuple(slice(n * at, n * at + n + 1) for at, n in zip(key, array.chunks))].max() == 0]
    check(not empty, f"chunks where nothing shows are not read again: {empty}")
    check(pool().report.resident_most <= 1.3 * 2**24, f"memory of parts: {pool().report.resident_most} bytes")
    shown = volume.grid.pages.report
    check(shown["missing"] == 0 and shown["parts_here"] <= shown["parts"], f"report: {shown}")


def drafts():
    """A coarse copy is drawn while a view moves, until the values that a picture needs are in memory."""
    field = ball((160, 200, 250), (80, 80, 120), 50)
    array, turned = Chunks(field, (40, 40, 50)), numpy.diag([1, 2, 1, 1])
    volume, look = Volume(array, device="host", memory="1G", matrix=turned), dict(opacity=[(0.3, 0), (0.6, 0.8)], size=(60, 45))
    check(volume.draft() is volume, "nothing is known before the first picture")
    volume.settle()
    check(volume.draft() is not volume and volume.draft(labels=field) is volume, "then there is a draft, without labels")
    read = len(array.boxes)
    draft, drawn = volume.draft().render(**look), volume.draft().render(**look)
    check(len(array.boxes) == read and volume.draft().grid.values.size < field.size / 3, "which reads nothing")
    exact = volume.render(**look)
    check(0 < numpy.abs(draft.rgba - exact.rgba).mean() < 0.03 and numpy.array_equal(draft.rgba, drawn.rgba), "and looks alike")
    check(numpy.abs(numpy.subtract(volume.draft().bounds, volume.bounds)).max() <= 2, "in the same place")
    volume.render(**look)
    check(volume.draft() is volume, "once nothing is to be read, pictures are exact")
    small = Volume(Chunks(field[:20, :30, :40], (8, 8, 8)), device="host", memory=LEAST, spacing=(1, 2, 3))
    small.settle()
    check(small.draft().grid.values.shape == (20, 30, 40), "a small array is its own copy")


def whole():
    """A small array without `memory` is read by one slice."""
    field = ball((20, 30, 44), (9, 15, 20), 14)
    array = Chunks(field, (6, 7, 8))
    volume = Volume(array, device="host")
    check(not isinstance(volume.grid, LazyGrid) and len(array.boxes) == 1, f"read at once: {array.boxes}")
    check(numpy.array_equal(volume.render(points, size=host["size"]).rgba, render(field, points, **host).rgba), "read at once: the picture")
    for wrong, words in (("2X", "K, M, G, T"), ("G", "K, M, G, T"), ("1K", "16000000 to"), (1e16, "16000000 to"), (-1, "16000000 to"), ("nanM", "16000000 to")):
        refuse(ValueError, words, Volume, field, memory=wrong)
    for wrong in True, [1], {}:
        refuse(TypeError, "512M", Volume, field, memory=wrong)
    check(bytes_of("2G") == 2**31 and bytes_of("32.5m") == 65 << 19 and bytes_of(2e7) == 20000000 and bytes_of("2e7") == 20000000, "sizes")
    refuse(ValueError, "has its own", render, volume, memory="1G")
    refuse(ValueError, "at least 2 values", Volume, Chunks(field[:1], (1, 7, 8)), memory=LEAST)
    refuse(TypeError, "complex64", Volume, Chunks(field.astype("c8"), (6, 7, 8)), memory=LEAST)
    check(lazy_of(field) is None and lazy_of(numpy.ma.asarray(field)) is None and lazy_of([1]) is None, "arrays in memory are not lazy")


class Broken(Chunks):
    """Fails in some chunk: raises, or gives what a slice does not have."""
    how = None

    def part(self, box):
        part = super().part(box)
        if all(each.start == 0 for each in box) or self.how is None:
            return part
        return self.how(part)


class Own(BaseException):
    pass


def failures():
    field = ball((20, 30, 44), (9, 15, 20), 14)

    def raises(error):
        def raise_it(part):
            raise error
        return raise_it
    for how, words in ((raises(KeyError("chunk 7")), "KeyError: 'chunk 7'"), (raises(Own("own")), "Own: own"), (raises(MemoryError()), "MemoryError"),
                       (lambda part: part[1:], "has the shape"), (lambda part: part.astype(complex), "type complex"), (lambda part: None, "has the shape ()"),
                       (lambda part: part.astype("U3"), "type <U3")):
        array = Broken(field, (6, 7, 8))
        array.how = how
        volume = Volume(array, device="host", memory=LEAST)
        for _ in range(2):
            refuse(OSError, words, volume.render, points)
            refuse(OSError, "the array could not be read", render_several, [(volume, dict(opacity=points))])
        array.how = None
        check(numpy.array_equal(volume.render(points, size=host["size"]).rgba, render(field, points, **host).rgba), f"{words}: the next picture")
        array.how = how  # rays find what the ranges did not
        volume.modified()
        refuse(OSError, words, volume.render, points)
    counts = Broken((100 * field).astype(numpy.int16), (6, 7, 8))
    counts.how = lambda part: numpy.ma.masked_greater(part, 50)
    refuse(OSError, "no mask", render, counts, memory=LEAST, **host)


def threads():
    """Python's own threads run while a picture waits, and the collector may find old volumes in any of them."""
    field, old = ball((40, 60, 64), (20, 30, 30), 25), []
    for _ in range(16):
        old.append([Volume(Chunks(field, (20, 30, 32)), device="host", memory=LEAST)])
        old[-1][0].grid.view(0)
        old[-1].append(old[-1])  # only the collector finds that nothing has it

    class Slow(Chunks):
        def part(self, box):
            time.sleep(0.002)
            if old:
                old.pop()
                worker = threading.Thread(target=gc.collect) if len(old) % 2 else None  # as of an array that computes its chunks in threads
                if worker:
                    worker.start()
                    worker.join()
                else:
                    gc.collect()
            return super().part(box)

    class Drawing(Chunks):
        def part(self, box):
            show(super().part(box), device="host")
            return super().part(box)
    turns, stop = [], threading.Event()

    def count():
        while not stop.wait(0.001):
            turns.append(1)
    counter = threading.Thread(target=count, daemon=True)
    counter.start()
    array = Slow(field, (20, 30, 16))
    drawn = render(array, points, memory=LEAST, **host).rgba
    stop.set()
    counter.join()
    check(numpy.array_equal(drawn, render(field, points, **host).rgba), "the collector in threads that read")
    check(len(turns) > 5 and not old, f"other threads ran {len(turns)} times, {len(old)} volumes are left")
    refuse(OSError, "uses the same device", render, Drawing(field, (20, 30, 16)), points, memory=LEAST, **host)
    volumes = [Volume(Chunks(field, (20, 30, 16)), device="host", memory=LEAST) for _ in range(3)]
    results = []
    workers = [threading.Thread(target=lambda each=each: results.append(each.render(points, size=host["size"]).rgba)) for each in volumes]
    [each.start() for each in workers], [each.join() for each in workers]
    check(len(results) == 3 and all(numpy.array_equal(each, drawn) for each in results), "pictures of several threads")


def growth():
    def used():
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * resource.getpagesize()
    field = ball((100, 100, 120), (50, 50, 50), 40)
    volume, before = Volume(Chunks(field, (20, 30, 32)), device="host", memory=LEAST), 0
    for n in range(40):
        volume.render(points, size=host["size"], camera=dict(azimuth=7 * n))
        render(Chunks(field, (50, 50, 60)), points, memory=LEAST, **host)
        before = used() if n == 15 else before
    check(used() - before < 20e6, f"40 pictures of 40 arrays: {used() - before} bytes more since the 15th")
    handles = len(os.listdir("/proc/self/fd"))
    check(handles < 40, f"{handles} open files")


PROGRAM = """
import os, sys, threading, time
import numpy, stratus_volume
class Chunks:
    shape, dtype, chunks = (64, 64, 64), numpy.dtype("f4"), (16, 16, 16)
    def __getitem__(self, box):
        time.sleep(WAIT)
        return numpy.random.default_rng(box[0].start).random([each.stop - each.start for each in box], "f4")
look = dict(device="host", size=(40, 30), memory="16M")
"""


def ends():
    """The interpreter ends while a thread of its own draws, with volumes left, and in processes that are forked."""
    programs = {"a daemon draws": PROGRAM.replace("WAIT", "0.05") + """
threading.Thread(target=lambda: stratus_volume.render(Chunks(), **look), daemon=True).start()
time.sleep(0.5)
""", "volumes are left": PROGRAM.replace("WAIT", "0") + """
volume = stratus_volume.Volume(Chunks(), device="host", memory="16M")
volume.render(size=(40, 30))
volume.own = volume
""", "a fork": PROGRAM.replace("WAIT", "0") + """
volume = stratus_volume.Volume(Chunks(), device="host", memory="16M")
wanted = volume.render(size=(40, 30)).rgba
child = os.fork()
if child == 0:
    try:
        volume.render(size=(40, 30))
        os._exit(2)
    except RuntimeError as error:
        words = "before the process was forked" in str(error)
    del volume
    same = (stratus_volume.render(Chunks(), **look).rgba == wanted).all()
    os._exit(0 if words and same else 3)
_, status = os.waitpid(child, 0)
sys.exit(int(status != 0 or (volume.render(size=(40, 30)).rgba != wanted).any()))
"""}
    for what, program in programs.items():
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=240)
        check(ended.returncode == 0 and "Error" not in ended.stderr, f"{what}: {ended.returncode}\n{ended.stderr}")


def packages():
    """Arrays of packages, where they are installed."""
    field = ball((24, 30, 44), (12, 15, 20), 14)
    with tempfile.TemporaryDirectory() as folder:
        for package, make in dict(zarr=of_zarr, h5py=of_h5py, netCDF4=of_netcdf, dask=of_dask, xarray=of_xarray).items():
            try:
                __import__(package)
            except ImportError:
                print(f"without {package}: its arrays are not tested")
                continue
            for what, array, values in make(field, os.path.join(folder, package)):
                alike(array, values, f"{package}, {what}")


def of_zarr(field, path):
    import zarr
    array = zarr.open(path, mode="w", shape=field.shape, chunks=(8, 9, 10), dtype="f4")
    array[...] = field
    yield "in a folder", zarr.open(path, mode="r"), field


def kept():
    """Value ranges of a large array in a folder are kept for later processes, and found anew if any of its files has changed."""
    try:
        import zarr
    except ImportError:
        return
    with tempfile.TemporaryDirectory() as folder:
        before, os.environ["STRATUS_CACHE_DIR"] = os.environ.get("STRATUS_CACHE_DIR"), os.path.join(folder, "cache")
        array = zarr.open(os.path.join(folder, "array"), mode="w", shape=(420, 400, 404), chunks=(140, 100, 101), dtype="u1")
        array[:140] = (200 * ball((140, 400, 404), (70, 200, 200), 60)).astype("u1")
        check(lazy_of(array).identity() == 0, "a folder that has just changed has no identity")

        def age():
            for base, _, files in os.walk(folder):
                for each in files:
                    os.utime(os.path.join(base, each), ns=(1, time.time_ns() - 10**11))
        age()
        number, pictures, reads = lazy_of(array).identity(), [], []
        for n in range(3):
            volume = Volume(array, device="host", memory="256M")
            volume.settle()
            reads.append(volume.grid.pages.reads)
            pictures.append(volume.render(size=(60, 45)).rgba)
            if n == 1:
                array[0, 0, 0] = 77
                age()
        check(reads[0] > 0 and reads[1] == 0 and reads[2] > 0, f"parts that are read for ranges: {reads}")
        check(number != 0 and number != lazy_of(array).identity(), "the identity is of the files")
        check(pictures[0].max() > 0.1 and numpy.array_equal(pictures[0], pictures[1]), "the same picture")
        if before is None:
            del os.environ["STRATUS_CACHE_DIR"]
        else:
            os.environ["STRATUS_CACHE_DIR"] = before


def of_h5py(field, path):
    import h5py
    with h5py.File(path, "w") as file:
        yield "chunks", file.create_dataset("chunks", data=field, chunks=(8, 9, 10), compression="gzip"), field
        yield "contiguous", file.create_dataset("contiguous", data=field.astype(">f8")), field.astype(float)
        check(lazy_of(file["chunks"]).identity() == 0, "h5py: no identity of a file that is written")
    os.utime(path, (1, 1))
    with h5py.File(path) as file:
        numbers = [lazy_of(file[name]).identity() for name in ("chunks", "contiguous", "chunks")]
        check(0 not in numbers and numbers[0] == numbers[2] != numbers[1], "h5py: identities")


def of_netcdf(field, path):
    import netCDF4
    with netCDF4.Dataset(path, "w") as file:
        for name, n in zip("zyx", field.shape):
            file.createDimension(name, n)
        plain = file.createVariable("plain", "f4", ("z", "y", "x"), chunksizes=(8, 9, 10), zlib=True)
        plain[...] = field
        yield "floats", plain, plain[...]
        packed = file.createVariable("packed", "i2", ("z", "y", "x"), chunksizes=(8, 9, 10), fill_value=-1)
        packed.scale_factor = 0.001
        packed[...] = numpy.ma.masked_less(field, 0.1)
        yield "packed and masked", packed, packed[...]
        whole = file.createVariable("whole", "u2", ("z", "y", "x"), fill_value=9)
        whole[...] = numpy.ma.masked_less((field * 3).astype("u2"), 1)
        yield "masked whole numbers", whole, whole[...].astype("f4").filled(numpy.nan)


def of_dask(field, path):
    import dask.array
    array = dask.array.from_array(field, chunks=(8, 9, 10))
    yield "chunks", array, field
    yield "a part of chunks", array[3:, 2:, 5:], field[3:, 2:, 5:]
    yield "uneven chunks", dask.array.concatenate([array[:5], array[5:6], array[6:]]), field
    yield "masks", dask.array.ma.masked_less(array, 0.3), numpy.ma.masked_less(field, 0.3)
    yield "turned", array.transpose(1, 0, 2)[:, ::-1], numpy.ascontiguousarray(field.transpose(1, 0, 2)[:, ::-1])


def of_xarray(field, path):
    import xarray
    dims = ("z", "y", "x")
    try:
        import dask.array
        yield "dask", xarray.DataArray(dask.array.from_array(field, chunks=9), dims=dims, name="qc"), xarray.DataArray(field, dims=dims, name="qc")
        filled = numpy.where(field < 0.3, -999, 100 * field).astype("i2")
        lazy = xarray.DataArray(dask.array.from_array(filled, chunks=9), dims=dims, attrs=dict(_FillValue=-999))
        check(isinstance(Volume(lazy, memory=LEAST).grid, LazyGrid), "xarray: with fill values")
        one = render(lazy, [(0, 0), (100, 0.5)], memory=LEAST, **host).rgba
        check(numpy.array_equal(one, render(numpy.where(filled < 0, numpy.nan, filled).astype("f4"), [(0, 0), (100, 0.5)], **host).rgba), "xarray: fill values")
    except ImportError:
        pass
    data = xarray.Dataset(dict(qc=(dims, field, dict(units="kg kg-1"))),
                          dict(z=("z", numpy.arange(field.shape[0]) ** 1.5, dict(units="m")), y=("y", numpy.arange(field.shape[1], 0, -1.0), dict(units="m")),
                               x=("x", numpy.arange(field.shape[2]) * 2.0, dict(units="m"))))
    data.to_netcdf(path)
    with xarray.open_dataset(path) as opened:
        yield "a file", opened.qc, data.qc
        look = dict(size=(60, 45), device="host")
        check(numpy.abs(opened.qc.pipe(show, memory=LEAST, **look).astype(int) - data.qc.pipe(show, **look)).max() <= 8, "xarray: functions by the variable")


types()
axes()
large()
drafts()
whole()
failures()
threads()
growth()
ends()
packages()
kept()
faulthandler.cancel_dump_traceback_later()
done()
