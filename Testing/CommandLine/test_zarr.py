# SPDX-License-Identifier: BSD-3-Clause
"""Folders of Zarr on the command line: pictures have the bits of the same values in one file, whatever the memory, levels and channels are
chosen by name, and other folders are refused. Usage: test_zarr.py PATH-OF-STRATUS FOLDER"""
import json
import os
import shutil
import subprocess
import sys
import zlib

import numpy

STRATUS, FOLDER = os.path.realpath(sys.argv[1]), sys.argv[2]
shutil.rmtree(FOLDER, ignore_errors=True)
os.makedirs(FOLDER)
os.chdir(FOLDER)
os.environ["STRATUS_CACHE_DIR"] = ""
LOOK = ("--size", "60x50", "--device", "host", "--opacity", "100:0,4000:.4", "--color", "viridis", "--unit-distance", "4", "--quiet")
failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def run(*arguments):
    done = subprocess.run([STRATUS, *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def picture(*arguments):
    status, text = run("render", *arguments, "-o", "out.png", *LOOK)
    check(status == 0, f"{arguments} are drawn: {text}")
    with open("out.png", "rb") as file:
        return file.read()


def write(path, values, chunks):
    os.makedirs(path)
    with open(path + "/.zarray", "w") as file:
        json.dump({"zarr_format": 2, "shape": values.shape, "chunks": chunks, "dtype": values.dtype.str, "order": "C", "fill_value": 0,
            "compressor": {"id": "zlib", "level": 1}, "filters": None}, file)
    for index in numpy.ndindex(*(-(-n // c) for n, c in zip(values.shape, chunks))):
        part = numpy.zeros(chunks, values.dtype)
        box = values[tuple(slice(i * c, (i + 1) * c) for i, c in zip(index, chunks))]
        part[tuple(slice(0, n) for n in box.shape)] = box
        with open(path + "/" + ".".join(map(str, index)), "wb") as file:
            file.write(zlib.compress(part.tobytes(), 1))


def write_nrrd(name, values, spacings):
    with open(name, "wb") as file:
        file.write(("NRRD0004\ntype: uint16\ndimension: 3\nsizes: {2} {1} {0}\nspacings: {x} {y} {z}\nendian: little\nencoding: raw\n\n".format(
            *values.shape, **dict(zip("zyx", spacings)))).encode() + values.tobytes())
    return name


z, y, x = numpy.meshgrid(*(numpy.linspace(-1, 1, n) for n in (180, 220, 230)), indexing="ij")
field = (4000 * numpy.exp(-5 * (x * x + y * y + z * z))).astype("u2")  # 18 MB, more than the least that stays in its files
write("field.zarr", field, (50, 64, 64))
expected = picture(write_nrrd("field.nrrd", field, (1, 1, 1)))
for path in ("field.zarr", "field.zarr/", "field.zarr/.zarray"):
    check(picture(path) == expected, f"{path} gives the picture of the file of the same values")
check(picture("field.zarr", "--memory", "16M") == expected, "a picture in little memory has the same bits")

cells = numpy.stack([field[::4, ::4, ::4], field[::4, ::4, ::4][:, ::-1] // 2])
os.makedirs("cells")
with open("cells/.zgroup", "w") as file:
    json.dump({"zarr_format": 2}, file)
with open("cells/.zattrs", "w") as file:
    json.dump({"multiscales": [{"version": "0.4", "axes": [{"name": "c", "type": "channel"}] + [{"name": a, "type": "space", "unit": "micrometer"} for a in "zyx"],
        "datasets": [{"path": path, "coordinateTransformations": [{"type": "scale", "scale": [1, 4 * f, 2 * f, f]}]} for path, f in (("s0", 1), ("s1", 2))]}]}, file)
write("cells/s0", cells, (1, 20, 20, 20))
write("cells/s1", cells[:, ::2, ::2, ::2], (1, 20, 20, 20))
status, text = run("info", "cells")
for words in ("'s0' of 2, --variable NAME for another", "'c' at index 0 of 0..1, select c=INDEX for another", "spacing 1 x 2 x 4", "58 x 55 x 45 uint16"):
    check(status == 0 and words in text, f"stratus info says '{words}': {text}")
for options, values, spacings in ((("--select", "c=1"), cells[1], (4, 2, 1)), (("--variable", "s1"), cells[0, ::2, ::2, ::2], (8, 4, 2))):
    check(picture("cells", *options) == picture(write_nrrd("one.nrrd", numpy.ascontiguousarray(values), spacings)), f"{options} of an image")

os.makedirs("other")
for arguments, words in ((("other",), "it is a folder, and none of Zarr"), (("cells", "--variable", "s2"), "no variable 's2'"),
        (("cells", "--select", "c=2"), "'s0/c' has 2 values, the index must be 0 to 1"), (("cells", "--globe"), "no longitudes and latitudes")):
    status, text = run("render", *arguments, "-o", "no.png", *LOOK)
    check(status != 0 and words in text, f"{arguments} is refused with '{words}': {text}")
os.remove("field.zarr/1.1.1")
with open("field.zarr/2.2.2", "wb") as file:
    file.write(b"no chunk")
status, text = run("render", "field.zarr", "-o", "no.png", *LOOK)
check(status != 0 and ("missing" in text or "field.zarr/2.2.2 is damaged" in text), f"a damaged chunk is an error: {text}")
sys.exit(1 if failures else 0)
