# SPDX-License-Identifier: BSD-3-Clause
"""Folders of Zarr, versions 2 and 3, that NumPy, zlib and the libraries of codecs write here: their values, whole and in bricks, are the
arrays' bits, whatever the type, order, codec and chunks; grids are netCDF's; images of OME-Zarr are where they say; chunks and metadata that
are wrong are errors that name them."""
import ctypes
import ctypes.util
import gzip
import itertools
import json
import os
import shutil
import struct
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "zarr")
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)
os.chdir(folder)
os.environ["STRATUS_CACHE_DIR"] = ""
LIMIT = 16 << 20
Reader = stratus.vtkStratusVariableReader
Reader.SetMemoryLimit(LIMIT)
chance = numpy.random.default_rng(44)


# ---- codecs, as they write
def library(name):
    """The library that the reader decodes by; none if the reader is built without it."""
    built = {"zstd": "STRATUS_ZSTD", "blosc": "STRATUS_BLOSC"}.get(name)
    if built and os.environ.get(built, "1") != "1":
        return None
    path = ctypes.util.find_library(name)
    return ctypes.CDLL(path) if path else None


def by_zstd(data):
    codec = library("zstd")
    codec.ZSTD_compressBound.restype = codec.ZSTD_compress.restype = ctypes.c_size_t
    room = ctypes.create_string_buffer(codec.ZSTD_compressBound(ctypes.c_size_t(len(data))))
    count = codec.ZSTD_compress(room, ctypes.c_size_t(len(room)), data, ctypes.c_size_t(len(data)), 1)
    return room.raw[:count]


def by_blosc(data, size=4, shuffle=1, name=b"lz4"):
    room = ctypes.create_string_buffer(len(data) + 16)
    count = library("blosc").blosc_compress_ctx(5, shuffle, ctypes.c_size_t(size), ctypes.c_size_t(len(data)), data, room,
        ctypes.c_size_t(len(room)), name, ctypes.c_size_t(0), 1)
    assert count > 0
    return room.raw[:count]


def by_lz4(data):
    room = ctypes.create_string_buffer(len(data) + len(data) // 200 + 64)
    count = library("lz4").LZ4_compress_default(data, room, len(data), len(room))
    return struct.pack("<I", len(data)) + room.raw[:count]


def by_shuffle(data, size):
    return numpy.frombuffer(data, "u1").reshape(-1, size).T.tobytes()


def crc32c(data):
    table = []
    for number in range(256):
        for _ in range(8):
            number = number >> 1 ^ (0x82F63B78 if number & 1 else 0)
        table.append(number)
    total = 0xFFFFFFFF
    for byte in data:
        total = total >> 8 ^ table[(total ^ byte) & 255]
    return struct.pack("<I", total ^ 0xFFFFFFFF)


check(crc32c(b"123456789") == struct.pack("<I", 0xE3069283), "the checksum of nine digits")


# ---- stores
def put(path, data):
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "wb") as file:
        file.write(data if isinstance(data, bytes) else json.dumps(data).encode())


def boxes(shape, chunks):
    """Indices of chunks, and what they cover."""
    for index in itertools.product(*(range(-(-n // c)) for n, c in zip(shape, chunks))):
        yield index, tuple(slice(i * c, (i + 1) * c) for i, c in zip(index, chunks))


def whole(part, chunks, fill):
    """A chunk at an edge has all values, those beyond the array are anything."""
    return numpy.pad(part, [(0, c - n) for n, c in zip(part.shape, chunks)], constant_values=fill)


def write2(path, values, chunks, dtype=None, order="C", separator=".", compressor=None, encode=lambda data: data, filters=None, fill=0,
        leave=(), attributes=None):
    """Version 2. leave: chunks without a file."""
    dtype = dtype or values.dtype.str
    put(path + "/.zarray", {"zarr_format": 2, "shape": values.shape, "chunks": chunks, "dtype": dtype, "order": order, "fill_value": fill,
        "dimension_separator": separator, "compressor": compressor, "filters": filters})
    if attributes is not None:
        put(path + "/.zattrs", attributes)
    for index, box in boxes(values.shape, chunks):
        if index not in leave:
            data = whole(values[box], chunks, 7).astype(dtype).tobytes(order)
            put(path + "/" + (separator.join(map(str, index)) or "0"), encode(data))
    return path


def write3(path, values, chunks, codecs, encode, kind=None, key=("default", "/"), fill=0, leave=(), attributes=None, names=None, shape=None,
        **more):
    """Version 3. encode: bytes of an array."""
    kind = kind or values.dtype.name
    put(path + "/zarr.json", {"zarr_format": 3, "node_type": "array", "shape": shape or values.shape, "data_type": kind, "fill_value": fill,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunks}},
        "chunk_key_encoding": {"name": key[0], "configuration": {"separator": key[1]}}, "codecs": codecs,
        "attributes": attributes or {}, **({"dimension_names": names} if names else {}), **more})
    for index, box in boxes(values.shape, chunks):
        if index not in leave:
            name = key[1].join((["c"] if key[0] == "default" else []) + [str(i) for i in index])
            put(path + "/" + name, encode(whole(values[box], chunks, 7)))
    return path


def group(path, version, attributes=None):
    if version == 3:
        put(path + "/zarr.json", {"zarr_format": 3, "node_type": "group", "attributes": attributes or {}})
    else:
        put(path + "/.zgroup", {"zarr_format": 2})
        put(path + "/.zattrs", attributes or {})
    return path


def codec3(name, **configuration):
    return {"name": name, "configuration": configuration}


LITTLE = codec3("bytes", endian="little")


# ---- readers
class Read:
    """What the reader makes of a folder: error, reader, data, and values in the array's order."""

    def __init__(self, path, variable=None, bricks=False, prepare=None, step=None, kind="vtkStratusZarrReader"):
        self.reader = getattr(stratus, kind)()
        self.errors = errors_of(self.reader)
        self.reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        self.reader.SetFileName(path)
        self.reader.SetMapFile(bricks), self.reader.SetMappedBytesLeast(0)
        if variable:
            self.reader.SetVariableName(variable)
        if prepare:
            prepare(self.reader)
        self.reader.UpdateInformation()
        if not self.errors:
            self.reader.Update() if step is None else self.reader.UpdateTimeStep(step)
        self.error = " ".join(self.errors)
        self.data = self.reader.GetOutputDataObject(0)
        scalars = None if self.error else self.data.GetPointData().GetScalars()
        if scalars:
            self.values = vtk_to_numpy(scalars).reshape(self.data.GetDimensions()[::-1])


def same(a, b):
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def both(path, expected, **options):
    """Checks the values, read whole and in bricks."""
    for bricks in (False, True):
        read = Read(path, bricks=bricks, **options)
        check(not read.error and same(read.values, expected), f"{path} {'in bricks' if bricks else 'whole'}: the array's values {read.error}")
        check(read.error or not bricks or read.reader.GetMapped() or not paged, f"{path} stays in its files")


SHAPE, CHUNKS = (21, 34, 50), (8, 16, 20)  # all edges have smaller parts
FIELD = chance.normal(100, 40, SHAPE).astype("f4")
paged = True
probe = Read(write2("probe", FIELD, CHUNKS), bricks=True)
paged = bool(probe.reader.GetMapped())
del probe
both("probe", FIELD)
both("probe/.zarray", FIELD)

# ---- types, orders of bytes and of values
for kind in ("|b1", "|i1", "|u1", "<i2", ">i2", "<u2", ">u4", "<i4", "<i8", ">u8", "<f2", ">f2", "<f4", ">f4", "<f8", ">f8"):
    values = (FIELD > 100) if kind == "|b1" else numpy.clip(FIELD, 0, 127).astype(kind)
    expected = values.astype("u1" if kind == "|b1" else "f4" if kind[1:] == "f2" else kind[1:])
    both(write2("kind" + kind[1:] + str(ord(kind[0])), values, CHUNKS, order="F" if kind[0] == ">" else "C",
        separator="/" if kind[0] == ">" else ".", fill=None, compressor={"id": "zlib", "level": 1}, encode=zlib.compress), expected)
for kind in ("bool", "int8", "uint16", "int64", "float16", "float32", "float64"):
    values = (FIELD > 100) if kind == "bool" else numpy.clip(FIELD, 0, 127).astype(kind)
    both(write3("three-" + kind, values, CHUNKS, [codec3("bytes", endian="big")], lambda part: part.astype(part.dtype.newbyteorder(">")).tobytes(),
        fill=False if kind == "bool" else 0), values.astype({"bool": "u1", "float16": "f4"}.get(kind, kind)))
halves = numpy.arange(65536, dtype="u2").view("f2").reshape(4, 64, 256)
halves = numpy.where(numpy.isnan(halves), numpy.float16("nan"), halves)
read = Read(write2("halves", halves, (4, 64, 256), dtype="<f2"))
check(numpy.array_equal(read.values, halves.astype("f4"), equal_nan=True), "all halves")

# ---- codecs
both(write2("gzip", FIELD, CHUNKS, compressor={"id": "gzip", "level": 1}, encode=gzip.compress), FIELD)
both(write2("shuffled", FIELD, CHUNKS, compressor={"id": "zlib", "level": 1}, filters=[{"id": "bitround", "keepbits": 23}, {"id": "shuffle", "elementsize": 4}],
    encode=lambda data: zlib.compress(by_shuffle(data, 4))), FIELD)
if library("lz4"):
    both(write2("lz4", FIELD, CHUNKS, compressor={"id": "lz4", "acceleration": 1}, encode=by_lz4), FIELD)
for name, encode, more in (("zstd", by_zstd, {}), ("blosc", by_blosc, {"cname": "lz4", "shuffle": 1})):
    write2(name, FIELD, CHUNKS, compressor={"id": name, **more}, encode=encode if library(name) else lambda data: data)
    if library(name):
        both(name, FIELD)
        both(write3(name + "3", FIELD, CHUNKS, [LITTLE, codec3(name, **more)], lambda part: encode(part.tobytes())), FIELD)
    else:
        check(f"the codec '{name}' is not built in" in Read(name).error, f"a build without {name} says so")
if library("blosc"):
    for shuffle, inner in ((0, b"blosclz"), (2, b"lz4hc"), (1, b"zlib"), (1, b"zstd")):
        both(write2("blosc-" + inner.decode(), FIELD, CHUNKS, compressor={"id": "blosc", "cname": inner.decode(), "shuffle": shuffle},
            encode=lambda data: by_blosc(data, 4, shuffle, inner)), FIELD)
    write2("snappy", FIELD, CHUNKS, compressor={"id": "blosc", "cname": "no-such"})
    check("'no-such' of the codec 'blosc' is not in libblosc" in Read("snappy").error, "a compressor that libblosc does not have")
both(write3("summed", FIELD, CHUNKS, [LITTLE, codec3("gzip", level=1), codec3("crc32c")],
    lambda part: (lambda data: data + crc32c(data))(gzip.compress(part.tobytes(), 1))), FIELD)
both(write3("rounded", FIELD, CHUNKS, [codec3("numcodecs.bitround", keepbits=23), LITTLE, codec3("numcodecs.zlib", level=1)],
    lambda part: zlib.compress(part.tobytes())), FIELD)
both(write3("turned", FIELD, CHUNKS, [codec3("transpose", order=[2, 0, 1]), codec3("transpose", order=[1, 0, 2]), LITTLE],
    lambda part: part.transpose(2, 0, 1).transpose(1, 0, 2).tobytes()), FIELD)
for number, key in enumerate((("default", "."), ("v2", "."), ("v2", "/"))):
    both(write3(f"key{number}", FIELD, CHUNKS, [LITTLE], lambda part: part.tobytes(), key=key), FIELD)


def shard(part, inner, first, summed, leave=()):
    """A shard of chunks compressed by gzip."""
    data, pairs = [], []
    at = (16 * numpy.prod([n // c for n, c in zip(part.shape, inner)]) + 4 * summed) if first else 0
    for index, box in boxes(part.shape, inner):
        if index in leave:
            pairs.append((2**64 - 1, 2**64 - 1))
            continue
        data.append(gzip.compress(part[box].tobytes(), 1))
        pairs.append((int(at), len(data[-1])))
        at += len(data[-1])
    index = b"".join(struct.pack("<QQ", *pair) for pair in pairs)
    index += crc32c(index) if summed else b""
    return (index if first else b"") + b"".join(data) + (b"" if first else index)


INNER = (4, 8, 10)
for first, summed in ((False, True), (True, True), (False, False)):
    sharding = codec3("sharding_indexed", chunk_shape=INNER, codecs=[LITTLE, codec3("gzip", level=1)], index_location="start" if first else "end",
        index_codecs=[LITTLE] + [codec3("crc32c")] * summed)
    path = write3(f"sharded{first}{summed}", FIELD, CHUNKS, [sharding], lambda part: shard(part, INNER, first, summed, {(0, 1, 1)}), fill=5,
        leave={(1, 1, 1)})
    expected = FIELD.copy()
    for _, (z, y, x) in boxes(SHAPE, CHUNKS):
        expected[z, y, x][0:4, 8:16, 10:20] = 5
    expected[8:16, 16:32, 20:40] = 5
    both(path, expected)

# ---- missing chunks are the fill value
for fill, number in ((-3.5, -3.5), ("NaN", numpy.nan), ("-Infinity", -numpy.inf), (None, 0)):
    expected = FIELD.copy()
    expected[0:8, 16:32, 20:40] = expected[16:, 32:, 40:] = number
    both(write2(f"filled{fill}", FIELD, CHUNKS, fill=fill, leave={(0, 1, 1), (2, 2, 2)}), expected)
    both(write3(f"filled3{fill}", FIELD, CHUNKS, [LITTLE], lambda part: part.tobytes(), fill=fill or "0x00000000", leave={(0, 1, 1), (2, 2, 2)}), expected)

# ---- damaged chunks: an error if the array is read whole, missing values in bricks
def damage(path, change):
    with open(path, "rb") as file:
        data = file.read()
    put(path, change(data))


for name, words in (("gzip", "deflated bytes"), ("probe", "bytes of values, its chunk has"), ("summed", "checksum"), ("shardedFalseTrue", "checksum"),
        ("lz4", "lz4"), ("zstd", "zstd"), ("blosc", "blosc"), ("shardedFalseFalse", "index of the shard")):
    if not os.path.exists(name) or name in ("lz4", "zstd", "blosc") and not library(name):
        continue
    change = lambda data: data[:-7] if name in ("gzip", "probe", "lz4", "zstd") else data[:-40] + b"\x11" * 20 + data[-20:]
    for key in ("1.1.1", "c/1/1/0", "c/1/1/1"):
        if os.path.exists(f"{name}/{key}"):
            damage(f"{name}/{key}", change)
            break
    error = Read(name).error
    check(words in error and f"{name}/{key}" in error, f"the error of {name} names the chunk and '{words}': {error}")
    if not paged:
        continue
    read = Read(name, bricks=True)
    missing = numpy.isnan(read.values)
    check(missing[8:16, 16:32].any() and not missing[16:].any(), f"values of {name} are missing around the chunk")
    mapper, window, renderer, volume = stratus.vtkStratusVolumeMapper(), vtk.vtkRenderWindow(), vtk.vtkRenderer(), vtk.vtkVolume()
    heard = errors_of(mapper)
    mapper.SetInputDataObject(read.data), volume.SetMapper(mapper), renderer.AddVolume(volume), window.AddRenderer(renderer)
    window.SetOffScreenRendering(1), window.SetSize(32, 32), window.Render()
    check(any("missing" in text for text in heard), f"the mapper reports the values of {name} that are missing")
    del read, mapper, window, renderer, volume

# ---- what cannot be read, and metadata that are wrong
def refused(path, words, **options):
    error = Read(path, **options).error
    check(words in error and path.split("/")[0] in error, f"{path} is refused with '{words}': {error}")


metadata = {"zarr_format": 2, "shape": [4, 4, 4], "chunks": [2, 2, 2], "dtype": "<f4", "order": "C", "fill_value": 0, "compressor": None, "filters": None}
for number, (change, words) in enumerate((
        ({"compressor": {"id": "lzma"}}, "the codec 'lzma' is not read"), ({"filters": [{"id": "delta", "dtype": "<f4"}]}, "the codec 'delta'"),
        ({"dtype": "<c8"}, 'dtype is "<c8"'), ({"dtype": [["a", "<f4"]]}, "dtype is"), ({"dtype": "|O"}, "dtype is"),
        ({"chunks": [0, 2, 2]}, "chunks is [0,2,2]"), ({"chunks": [2, 2]}, "chunks have 2 dimensions, the array has 3"),
        ({"chunks": [2048, 2048, 2048]}, "a chunk has"), ({"shape": [2**40, 2**40, 2**40]}, "longer than VTK's grids"),
        ({"shape": [-1, 4, 4]}, "there is no variable"), ({"order": "G"}, "order is"), ({"fill_value": "rubbish"}, "fill_value is"),
        ({"shape": [2**31, 4, 4]}, "longer than VTK's grids"), ({"dimension_separator": "../"}, "dimension_separator is"),
        ({"zarr_format": 4}, "zarr_format"), ({"shape": [4, 4]}, "2 dimensions in space"))):
    path = f"wrong{number}"
    put(path + "/.zarray", {**metadata, **change})
    refused(path, words, variable="wrong15" if number == 15 else None)
put("huge/.zarray", {**metadata, "shape": [2**30, 2**20, 4], "chunks": [64, 64, 4]})
refused("huge", "values, at most")
put("nested/.zarray", b"[" * 5000)
refused("nested", "no object of JSON")
put("text/.zarray", b"not JSON")
refused("text", "no object of JSON")
os.makedirs("empty")
refused("empty", "no folder of Zarr")
refused("none.zarr", "there is no such folder")
group("loop", 2)
os.symlink(".", "loop/again")
refused("loop", "nested more than 32 deep")
os.makedirs("linked")
put("linked/.zarray", {**metadata, "chunks": [4, 4, 4]})
os.symlink("not-fetched", "linked/0.0.0")
refused("linked", "a link to a file that is not there")
os.remove("linked/0.0.0")
os.mkfifo("linked/0.0.0")
refused("linked", "it is no file")
three = {"zarr_format": 3, "node_type": "array", "shape": [4, 4, 4], "data_type": "float32", "fill_value": 0, "codecs": [LITTLE],
    "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [2, 2, 2]}}, "chunk_key_encoding": {"name": "default"}}
for number, (change, words) in enumerate((
        ({"codecs": [LITTLE, codec3("pcodec")]}, "the codec 'pcodec' is not read"), ({"codecs": []}, "with 'bytes' in it"),
        ({"codecs": [codec3("transpose", order=[0, 0, 1]), LITTLE]}, "each dimension once"), ({"codecs": [codec3("transpose", order=[0, 5, 1]), LITTLE]}, "each"),
        ({"data_type": "complex64"}, "data_type is"), ({"chunk_grid": {"name": "rectilinear"}}, "chunk_grid is"), ({"chunk_key_encoding": "x"}, "as the format says"),
        ({"codecs": [codec3("sharding_indexed", chunk_shape=[3, 1, 1], codecs=[LITTLE], index_codecs=[LITTLE])]}, "divisors"),
        ({"new_thing": 1}, "the extension 'new_thing'"), ({"storage_transformers": [{"name": "x"}]}, "storage transformers"))):
    put(f"bad{number}/zarr.json", {**three, **change})
    refused(f"bad{number}", words)
put("inside/secret/.zarray", metadata)
put("inside/store/.zgroup", {"zarr_format": 2})
put("inside/store/.zmetadata", {"zarr_consolidated_format": 1, "metadata": {".zgroup": {"zarr_format": 2}, "../secret/.zarray": metadata,
    "/etc/.zarray": metadata, "a//.zarray": metadata}})
refused("inside/store", "it has none")
put("inside/store/.zmetadata", {"zarr_consolidated_format": 1, "metadata": {".zgroup": {"zarr_format": 2}, "a/.zarray": metadata}})
check(not Read("inside/store").error, "an array that only the consolidated metadata name is all fill values")
shutil.rmtree("inside/store/a", ignore_errors=True)

# ---- grids: the same as of a netCDF file of the same contents, by xarray's conventions
try:
    import netCDF4
except ImportError:
    netCDF4 = None
    print("left out, because there is no netCDF4: grids against those of netCDF")
NT, NZ, NY, NX = 3, 7, 12, 15
GRID = {"time": (("time",), numpy.array([0, 6, 12], "i8"), {"units": "hours since 2020-06-01", "calendar": "standard"}),
    "level": (("level",), numpy.array([1000, 900, 800, 650, 500, 300, 100], "f8"), {"units": "hPa", "positive": "down", "standard_name": "air_pressure"}),
    "lat": (("lat",), numpy.linspace(60, 40, NY), {"units": "degrees_north", "standard_name": "latitude"}),
    "lon": (("lon",), numpy.linspace(-5, 25, NX).astype("f4"), {"units": "degrees_east", "standard_name": "longitude"}),
    "t": (("time", "level", "lat", "lon"), chance.integers(-30000, 30000, (NT, NZ, NY, NX)).astype("i2"),
        {"units": "K", "long_name": "temperature", "scale_factor": 0.002, "add_offset": 250.0, "_FillValue": -32768}),
    "q": (("time", "level", "lat", "lon"), chance.random((NT, NZ, NY, NX)).astype("f4"), {"units": "kg kg-1", "_FillValue": numpy.nan})}
GRID["t"][1][1, 2, 3:5, 4] = -32768
if netCDF4:
    with netCDF4.Dataset("grid.nc", "w") as file:
        for name, count in (("time", NT), ("level", NZ), ("lat", NY), ("lon", NX)):
            file.createDimension(name, count)
        for name, (dimensions, values, attributes) in GRID.items():
            rest = {key: value for key, value in attributes.items() if key != "_FillValue"}
            made = file.createVariable(name, values.dtype, dimensions, fill_value=attributes.get("_FillValue", False))
            made.set_auto_maskandscale(False)
            made.setncatts(rest)
            made[...] = values
for version in (2, 3):
    store = group(f"grid{version}.zarr", version)
    nodes = {}
    for name, (dimensions, values, attributes) in GRID.items():
        chunks = (2, 4, 5, 6)[:values.ndim] if values.ndim > 1 else values.shape
        rest = {key: value for key, value in attributes.items() if key != "_FillValue"}
        fill = attributes.get("_FillValue")
        if version == 2:
            fill = 0 if name == "time" else fill  # which is the first hour nevertheless
            write2(f"{store}/{name}", values, chunks, fill="NaN" if fill is not None and fill != fill else fill, compressor={"id": "zlib", "level": 1},
                encode=zlib.compress, attributes={**rest, "_ARRAY_DIMENSIONS": dimensions})
        else:
            if fill is not None:
                import base64
                rest["_FillValue"] = fill if values.dtype.kind == "i" else base64.standard_b64encode(struct.pack("<d", fill)).decode()
            write3(f"{store}/{name}", values, chunks, [LITTLE], lambda part: part.tobytes(), attributes=rest, names=dimensions)
    for consolidated in (False, True):
        if consolidated and version == 2:
            names = [".zgroup", ".zattrs"] + [f"{name}/{part}" for name in GRID for part in (".zarray", ".zattrs")]
            put(store + "/.zmetadata", {"zarr_consolidated_format": 1, "metadata": {name: json.load(open(f"{store}/{name}")) for name in names}})
        elif consolidated:
            root = json.load(open(store + "/zarr.json"))
            root["consolidated_metadata"] = {"kind": "inline", "must_understand": False,
                "metadata": {name: json.load(open(f"{store}/{name}/zarr.json")) for name in GRID}}
            put(store + "/zarr.json", root)
        for name, step, bricks in itertools.product(("t", "q"), (0, 6), (False, True)) if netCDF4 else ():
            expected = Read("grid.nc", variable=name, step=step, kind="vtkStratusCFReader")
            got = Read(store, variable=name, step=step, bricks=bricks)
            what = f"{store} {name} at {step}{' in bricks' * bricks}"
            check(not got.error and same(got.values, expected.values), f"{what}: values as of netCDF {got.error}")
            check(got.data.GetClassName() == expected.data.GetClassName() and got.data.GetBounds() == expected.data.GetBounds(), f"{what}: the grid")
            check(all(numpy.array_equal(vtk_to_numpy(getattr(got.data, f"Get{a}Coordinates")()), vtk_to_numpy(getattr(expected.data, f"Get{a}Coordinates")()))
                for a in "XYZ"), f"{what}: coordinates")
            for call in ("GetTimeUnits", "GetTimeCalendar", "GetLengthUnits", "GetDescription", "GetNumberOfVariables"):
                check(getattr(got.reader, call)() == getattr(expected.reader, call)(), f"{what}: {call}")
        refused(store, "there is no variable 'lost'", variable="lost")
    selected = Read(store, variable="q", prepare=lambda reader: reader.SetSelection("time=2"))
    check(not selected.error and selected.reader.GetTimeUnits() == "", f"{store}: a time that is selected {selected.error}")
    inner = group(f"{store}/below", version)
    if version == 3:  # coordinates of the group above
        write3(f"{inner}/w", GRID["q"][1][0], (7, 12, 15), [LITTLE], lambda part: part.tobytes(), names=("level", "lat", "lon"))
        os.rename(store, "plain.zarr")
        root = json.load(open("plain.zarr/zarr.json"))
        del root["consolidated_metadata"]
        put("plain.zarr/zarr.json", root)
        below = Read("plain.zarr", variable="below/w")
        check(not below.error and "'lon' (degrees_east)" in below.reader.GetDescription(), f"coordinates of the group above: {below.error}")

# ---- images of OME-Zarr
image = chance.integers(0, 60000, (2, 3, 12, 20, 24)).astype("u2")  # t, c, z, y, x
AXES = [{"name": "t", "type": "time", "unit": "second"}, {"name": "c", "type": "channel"}] + [{"name": a, "type": "space", "unit": "micrometer"} for a in "zyx"]


def datasets(levels):
    return [{"path": str(level), "coordinateTransformations": [{"type": "scale", "scale": [0.5, 1, 2, 0.25 * 2**level, 0.25 * 2**level]},
        {"type": "translation", "translation": [0, 0, 10, 0.125 * (2**level - 1), -1]}]} for level in range(levels)]


for version in (2, 3):
    levels = {"axes": AXES, "datasets": datasets(2), "name": "cells", "version": "0.4"}
    store = group(f"ome{version}", version, {"ome": {"version": "0.5", "multiscales": [levels]}} if version == 3 else {"multiscales": [levels]})
    for level in range(2):
        part = image[..., ::2**level, ::2**level]
        if version == 2:
            write2(f"{store}/{level}", part, (1, 1, 5, 8, 10), separator="/", compressor={"id": "zlib", "level": 1}, encode=zlib.compress,
                attributes={"_ARRAY_DIMENSIONS": list("tczyx")})  # 0 is a value nevertheless
        else:
            write3(f"{store}/{level}", part, (1, 1, 5, 8, 10), [LITTLE], lambda one: one.tobytes(), names=list("tczyx"))
    for step, channel, level, bricks in itertools.product((0, 1), (0, 2), (0, 1), (False, True)):
        read = Read(store, variable=str(level) if level else None, bricks=bricks, step=0.5 * step,
            prepare=lambda reader: reader.SetSelection(f"c={channel}") if channel else None)
        what = f"{store} level {level}, channel {channel}, step {step}"
        check(not read.error and same(read.values, image[step, channel, :, ::2**level, ::2**level]), f"{what}: values of their type {read.error}")
        check(read.data.IsA("vtkImageData") and numpy.allclose(read.data.GetSpacing(), (0.25 * 2**level, 0.25 * 2**level, 2), rtol=1e-14), f"{what}: spacing")
        check(numpy.allclose(read.data.GetOrigin(), (-1, 0.125 * (2**level - 1), 10), rtol=1e-14), f"{what}: origin")
        check(read.reader.GetLengthUnits() == "micrometer" and read.reader.GetUnitsOfAxis(2) == "micrometer", f"{what}: units")
        check(read.reader.GetNumberOfVariables() == 2 and read.reader.GetNameOfVariable(0) == "0" and read.reader.GetTimeUnits() == "second", f"{what}: variables")
    read.reader.SetVariableName("1" if read.reader.GetVariableName() is None else None), read.reader.Update()
    check(read.reader.GetOutput().GetPointData().GetNumberOfArrays() == 1, "the values of another level go")
    check("'c' at index 0 of 0..2" in Read(store).reader.GetDescription(), "the channel that is read is named")
levels["coordinateTransformations"] = [{"type": "affine"}]
put("ome3/zarr.json", {"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"multiscales": [levels]}}})
refused("ome3", "'affine' is not read")
plane = group("planes", 2, {"multiscales": [{"axes": ["c", "y", "x"], "datasets": [{"path": "0"}]}]})
write2("planes/0", image[0, :, 0], (1, 20, 24))
refused("planes", "no variable on a grid of three dimensions")

# ---- in little memory, and after a change of the files
del got, selected, below, read  # with their bricks
z, y, x = numpy.meshgrid(*(numpy.linspace(-1, 1, n) for n in (140, 151, 201)), indexing="ij")
LARGE = (numpy.exp(-4 * (x * x + y * y + z * z)) + 0.05 * chance.random(x.shape)).astype("f4")


def picture(data):
    mapper, volume = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume()
    mapper.SetInputDataObject(data), volume.SetMapper(mapper)
    look = volume.GetProperty()
    look.SetInterpolationTypeToLinear(), look.SetScalarOpacityUnitDistance(10)
    look.GetScalarOpacity().RemoveAllPoints(), look.GetScalarOpacity().AddPoint(0.3, 0), look.GetScalarOpacity().AddPoint(1, 0.8)
    look.GetRGBTransferFunction().AddRGBPoint(0, 0.1, 0.3, 0.9), look.GetRGBTransferFunction().AddRGBPoint(1, 0.9, 0.4, 0.1)
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(200, 150)
    window.AddRenderer(renderer), renderer.AddVolume(volume), renderer.ResetCamera(), window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window), grab.ReadFrontBufferOff(), grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).copy()


os.environ["STRATUS_CACHE_DIR"] = os.path.join(os.getcwd(), "cache")
write2("large", LARGE, (32, 32, 32), compressor={"id": "zlib", "level": 1}, encode=lambda data: zlib.compress(data, 1))
for step in range(2):
    reference = picture(Read("large").data)
    check(reference.max() > 50, "something shows")
    for again in range(2):
        read = Read("large", bricks=True)
        check((picture(read.data) == reference).all(), f"a picture in little memory has the same bits ({step}, {again})")
        check(Reader.GetMemoryUsed() <= LIMIT, "memory is within the limit")
        del read
    put("large/2.2.3", zlib.compress(numpy.full(32**3, 0.9, "f4").tobytes(), 1))
check(Reader.GetMemoryUsed() == 0, "bricks end with their arrays")

if not paged:
    print("SKIPPED: this system offers no pages that stop their readers")
    sys.exit(77)
done()
