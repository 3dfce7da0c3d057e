#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Times and memory of first pictures of large files by the command line, against the limit of memory and against the disk.

large.py make FOLDER KIND SIZE     writes FOLDER/KIND-SIZE.raw, .nc or .zarr, layer by layer: clouds of which most blocks are empty
large.py measure FILE OPTION...    draws it by `stratus render`, and prints rows scene,method,metric,value,unit
large.py film FILE OPTION...       draws all its time steps, and prints what a step takes, and what reading and drawing one take alone
  --stratus PROGRAM   default: stratus of the path
  --memory SIZE       as of `stratus render`; default: none
  --repeats N         default 3
  --cold              drop the file's pages from memory before each picture

KIND: raw (bytes), netcdf (floats, chunks of 64 along each axis, zlib at level 1), contiguous (floats, netCDF-4 in one piece),
zarr and zstd (floats, Zarr of chunks of 64 along each axis, by zlib or zstd at level 1); ocean (24 hours of a lattice with longitudes and
latitudes, floats, netCDF-4 with levels as chunks, zlib at level 1).
SIZE: NX,NY,NZ. Methods: first@limit or @all: with an empty cache folder, with --memory or without; later: with the ranges that the first
picture kept; dd: the file is only read; whole: netCDF4 of Python reads all values into memory.
"""
import argparse
import ctypes
import ctypes.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zlib

import numpy

CLOUDS = 60
VIEW = ["--size", "512", "--tolerance", "0.005"]


def clouds(nx, ny, nz):
    """Places and radii in voxels, the same for each size of one shape."""
    chance = numpy.random.default_rng(7)
    radius = min(nx, ny, nz) * chance.uniform(0.04, 0.12, CLOUDS)
    at = chance.uniform(0.1, 0.9, (CLOUDS, 3)) * (nx, ny, nz)
    return at, radius


def layers(nx, ny, nz, at_a_time):
    """Layers of the field, 0..1, which is exactly 0 outside of all clouds."""
    at, radius = clouds(nx, ny, nz)
    for first in range(0, nz, at_a_time):
        count = min(at_a_time, nz - first)
        field = numpy.zeros((count, ny, nx), "f4")
        for (cx, cy, cz), r in zip(at, radius):
            lo = numpy.maximum(numpy.floor((cx - r, cy - r, cz - r)), (0, 0, first)).astype(int)
            hi = numpy.minimum(numpy.ceil((cx + r, cy + r, cz + r)) + 1, (nx, ny, first + count)).astype(int)
            if (hi <= lo).any():
                continue
            x, y, z = (numpy.arange(a, b, dtype="f4") for a, b in zip(lo, hi))
            d = ((x - cx)[None, None] ** 2 + (y - cy)[None, :, None] ** 2 + (z - cz)[:, None, None] ** 2) / r ** 2
            ripple = numpy.sin(0.37 * x)[None, None] * numpy.sin(0.31 * y)[None, :, None] * numpy.sin(0.41 * z)[:, None, None]
            part = field[lo[2] - first:hi[2] - first, lo[1]:hi[1], lo[0]:hi[0]]
            numpy.maximum(part, numpy.maximum(0, 1 - d) * (0.8 + 0.2 * ripple), out=part)
        yield first, field


def make(folder, kind, size):
    nx, ny, nz = size
    name = os.path.join(folder, f"{kind}-{nx}x{ny}x{nz}")
    if kind == "ocean":
        make_ocean(name + ".nc", nx, ny, nz)
        return name + ".nc"
    if kind == "raw":
        with open(name + ".raw", "wb") as file:
            for _, field in layers(nx, ny, nz, 16):
                (255 * field).astype("u1").tofile(file)
        return name + ".raw"
    if kind in ("zarr", "zstd"):
        make_zarr(name + ".zarr", kind, size)
        return name + ".zarr"
    import netCDF4
    with netCDF4.Dataset(name + ".nc", "w") as file:
        for axis, count in zip("zyx", (nz, ny, nx)):
            file.createDimension(axis, count)
            file.createVariable(axis, "f4", (axis,))[:] = numpy.arange(count)
            file[axis].units, file[axis].axis = "m", axis.upper()
        how = dict(contiguous=True) if kind == "contiguous" else dict(chunksizes=(64, 64, 64), zlib=True, complevel=1)
        variable = file.createVariable("density", "f4", ("z", "y", "x"), fill_value=False, **how)
        for first, field in layers(nx, ny, nz, 64):
            variable[first:first + len(field)] = field
    return name + ".nc"


def make_ocean(path, nx, ny, nz, steps=24):
    """A day of an ocean model: temperatures on a lattice of two poles in the north, land and sea floor missing, levels as chunks."""
    import netCDF4
    j, i = numpy.linspace(0, 1, ny)[:, None], numpy.linspace(0, 1, nx)[None, :]
    north = numpy.clip((j - 0.85) / 0.15, 0, 1)
    longitude, latitude = -180 + 360 * i + 0 * j, -77 + 137 * j ** 1.02 + 0 * i
    latitude = latitude + 18 * (north * numpy.cos(numpy.radians(2 * (longitude - 80)))) ** 2
    longitude = longitude + 25 * north ** 2 * numpy.sin(numpy.radians(2 * (longitude - 80)))
    depth = 5700 * numpy.linspace(0, 1, nz) ** 2.2 + 0.5
    land = (numpy.sin(31.4 * i + 2) * numpy.cos(12.56 * j) > 0.75) + 0 * i > 0
    bottom = 2500 + 2500 * numpy.sin(21.7 * i) * numpy.cos(9 * j) + 1500 * numpy.sin(23 * i + 11 * j)
    waves = numpy.random.default_rng(0).uniform(3, 40, (12, 3))
    with netCDF4.Dataset(path, "w") as file:
        for name, count in (("x", nx), ("y", ny), ("deptht", nz), ("time_counter", None)):
            file.createDimension(name, count)
        for name, dimensions, units, values in (("nav_lat", ("y", "x"), "degrees_north", latitude), ("nav_lon", ("y", "x"), "degrees_east", longitude),
                ("deptht", ("deptht",), "m", depth), ("time_counter", ("time_counter",), "hours since 2001-01-01", numpy.arange(steps))):
            axis = file.createVariable(name, "f4" if name != "time_counter" else "f8", dimensions)
            axis.units = units
            axis[:] = values
        file["deptht"].positive = "down"
        variable = file.createVariable("votemper", "f4", ("time_counter", "deptht", "y", "x"), fill_value=1e20, zlib=True, complevel=1,
            chunksizes=(1, 1, ny, nx))
        variable.units, variable.long_name, variable.coordinates = "degC", "temperature", "time_counter deptht nav_lat nav_lon"
        warm = 28 * numpy.cos(numpy.radians(latitude)) ** 2
        for step in range(steps):
            eddies = sum(numpy.sin(6.283 * (a * i + b * j + 0.002 * step) + p) / (1 + 0.2 * k) for k, (a, b, p) in enumerate(waves))
            for k in range(nz):
                values = warm * numpy.exp(-depth[k] / 700) + 1.5 * eddies * numpy.exp(-depth[k] / 400) + 1
                variable[step, k] = numpy.where(land | (depth[k] > bottom), 1e20, values)


def by_zstd(data, codec=ctypes.CDLL(ctypes.util.find_library("zstd") or None)):
    codec.ZSTD_compressBound.restype = codec.ZSTD_compress.restype = ctypes.c_size_t
    room = ctypes.create_string_buffer(codec.ZSTD_compressBound(ctypes.c_size_t(len(data))))
    count = codec.ZSTD_compress(room, ctypes.c_size_t(len(room)), data, ctypes.c_size_t(len(data)), 1)
    return room[:count]


def make_zarr(path, kind, size):
    nx, ny, nz = size
    os.makedirs(path)
    with open(os.path.join(path, ".zarray"), "w") as file:
        json.dump({"zarr_format": 2, "shape": (nz, ny, nx), "chunks": (64, 64, 64), "dtype": "<f4", "order": "C", "fill_value": 0, "filters": None,
            "compressor": {"id": "zlib" if kind == "zarr" else "zstd", "level": 1}}, file)
    for first, field in layers(nx, ny, nz, 64):
        for y in range(0, ny, 64):
            for x in range(0, nx, 64):
                part = numpy.zeros((64, 64, 64), "f4")
                box = field[:, y:y + 64, x:x + 64]
                part[tuple(slice(0, n) for n in box.shape)] = box
                with open(os.path.join(path, f"{first // 64}.{y // 64}.{x // 64}"), "wb") as file:
                    file.write(zlib.compress(part.tobytes(), 1) if kind == "zarr" else by_zstd(part.tobytes()))


def forget(path):
    """Drops a file's pages, or those of a folder's files, from the system's memory."""
    if os.path.isdir(path):
        for name in os.listdir(path):
            forget(os.path.join(path, name))
        return
    handle = os.open(path, os.O_RDONLY)
    os.fsync(handle)
    os.posix_fadvise(handle, 0, 0, os.POSIX_FADV_DONTNEED)
    os.close(handle)


def run(command, environment):
    """Returns seconds, processor seconds, the most resident bytes and the output of a program."""
    start = time.perf_counter()
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, env=environment, stdout=said)
        _, status, used = os.wait4(process.pid, 0)
        if status:
            sys.exit(f"failed: {' '.join(command)}")
        seconds = time.perf_counter() - start
        said.seek(0)
        return seconds, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024, said.read()


def measure(path, options):
    rows, scene = [], os.path.splitext(os.path.basename(path))[0]
    command = [options.stratus, "render", path, "-o", os.path.join(options.folder, "large.png"), "-v", *VIEW]
    if path.endswith(".raw"):
        command += ["--raw", scene.split("-")[1] + ":uint8"]
    if options.memory:
        command += ["--memory", options.memory]

    def add(method, name, values, unit):
        method += "" if method in ("dd", "whole") else "@limit" if options.memory else "@all"
        rows.append(f"{scene},{method},{name},{float(numpy.median(values)):.6g},{unit}")

    def number(text, before):
        """The number behind a word of the program's report; 0 where it is not there."""
        found = re.search(before + r"\s+([0-9,.]+)", text)
        return float(found[1].replace(",", "")) if found else 0.0

    whole = [sys.executable, "-c", f"import netCDF4; netCDF4.Dataset({path!r})['density'][:]"]
    for method in ("dd", *(("whole",) if path.endswith(".nc") else ()), "first", "later"):
        results = []
        for _ in range(options.repeats if method == "later" else 1):
            if method == "first":
                shutil.rmtree(options.cache, ignore_errors=True)
            if options.cold:
                forget(path)
            one = ["cat", *(os.path.join(path, name) for name in os.listdir(path))] if os.path.isdir(path) else ["dd", "if=" + path,
                "of=/dev/null", "bs=1M", "status=none"]
            one = one if method == "dd" else whole if method == "whole" else command
            results.append(run(one, dict(os.environ, STRATUS_CACHE_DIR=options.cache)))
        add(method, "seconds", [result[0] for result in results], "s")
        add(method, "processor_seconds", [result[1] for result in results], "s")
        if method in ("first", "later"):
            add(method, "resident_most", [result[2] for result in results], "bytes")
            add(method, "frame_seconds", [number(result[3], "frame") / 1e3 for result in results], "s")
            add(method, "bytes_read", [number(result[3], "read") * (1 << 20) for result in results], "bytes")
            blocks = re.search(r"([0-9,]+) of ([0-9,]+) occupied", results[0][3])
            add(method, "occupied", [float(blocks[1].replace(",", "")) / float(blocks[2].replace(",", ""))], "1")
    print("\n".join(rows))


def film(path, options):
    """Medians over the steps. Reading: of one step by netCDF4 of Python. Drawing: the last frame, beside which nothing is read."""
    scene = os.path.splitext(os.path.basename(path))[0]
    pattern = os.path.join(options.folder, "film-%04d.png")
    command = [options.stratus, "render", path, "--frames", pattern, "-v", *VIEW] + (["--memory", options.memory] if options.memory else [])
    _, processor, resident, said = run(command, dict(os.environ, STRATUS_CACHE_DIR=options.cache))
    frames = sorted(name for name in os.listdir(options.folder) if name.startswith("film-"))
    written = [os.stat(os.path.join(options.folder, name)).st_mtime_ns / 1e9 for name in frames]
    read = f"""import netCDF4, time
with netCDF4.Dataset({path!r}) as file:
    values = max(file.variables.values(), key=lambda variable: variable.size)
    for step in range(len(values)):
        start = time.perf_counter()
        values[step]
        print(time.perf_counter() - start)"""
    reading = numpy.median([float(line) for line in run([sys.executable, "-c", read], os.environ)[3].split()])
    drawing = float(re.search(r"frame\s+([0-9,.]+) ms", said)[1].replace(",", "")) / 1e3
    for name, value, unit in (("step_seconds", numpy.median(numpy.diff(written)), "s"), ("reading_seconds", reading, "s"), ("drawing_seconds", drawing, "s"),
            ("processor_seconds", processor / len(frames), "s"), ("resident_most", resident, "bytes")):
        print(f"{scene},film,{name},{value:.6g},{unit}")


if __name__ == "__main__":
    if len(sys.argv) == 5 and sys.argv[1] == "make":
        print(make(sys.argv[2], sys.argv[3], [int(word) for word in sys.argv[4].split(",")]))
    elif len(sys.argv) > 2 and sys.argv[1] in ("measure", "film"):
        parser = argparse.ArgumentParser()
        parser.add_argument("--stratus", default="stratus")
        parser.add_argument("--memory", default="")
        parser.add_argument("--repeats", type=int, default=3)
        parser.add_argument("--cold", action="store_true")
        options = parser.parse_args(sys.argv[3:])
        options.folder = tempfile.mkdtemp()
        options.cache = os.path.join(options.folder, "cache")
        try:
            (film if sys.argv[1] == "film" else measure)(sys.argv[2], options)
        finally:
            shutil.rmtree(options.folder, ignore_errors=True)
    else:
        sys.exit(__doc__)
