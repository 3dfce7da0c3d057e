# SPDX-License-Identifier: BSD-3-Clause
"""vtkStratusImageReader's values and places. NIfTI is judged by nibabel, which also writes the files; NRRD and MetaImage by files that are written
here byte by byte, from arrays and affine maps that are known. Unsupported files must be refused by name."""
import gzip
import itertools
import os
import struct
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

try:
    import nibabel
except ImportError:
    nibabel = None

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "image-files")
os.makedirs(folder, exist_ok=True)
os.chdir(folder)
chance = numpy.random.default_rng(40)
SIZE = (5, 4, 3)  # x, y, z
mapped = []  # of each file, whether its values stayed there
NAMES = {"i1": ("signed char", "MET_CHAR"), "u1": ("uint8", "MET_UCHAR"), "i2": ("short", "MET_SHORT"), "u2": ("unsigned short int", "MET_USHORT"),
         "i4": ("int32_t", "MET_INT"), "u4": ("uint", "MET_UINT"), "i8": ("long long", "MET_LONG_LONG"), "u8": ("uint64", "MET_ULONG_LONG"),
         "f4": ("float", "MET_FLOAT"), "f8": ("double", "MET_DOUBLE")}
# Columns: the vectors from a sample to the next one along x, y and z. Mirrored, turned, in another order, sheared, left-handed.
FRAMES = {"plain": numpy.diag((1.0, 1.5, 2.0)), "mirrored": numpy.diag((-1.0, -1.5, 2.0)), "left": numpy.diag((1.0, -1.5, 2.0)),
          "swapped": numpy.array([[0, -1.5, 0], [1, 0, 0], [0, 0, 2.0]]),
          "turned": numpy.linalg.qr(chance.normal(size=(3, 3)))[0] * (0.5, 1.25, 3.0),
          "sheared": numpy.array([[1, 0.3, -0.2], [0, 1.5, 0.4], [0.1, 0, 2.0]])}
ORIGIN = numpy.array((5.0, -6.5, 7.25))


def write(name, *parts):
    with open(name, "wb") as file:
        for part in parts:
            file.write(part if isinstance(part, bytes) else part.encode())
    return name


def all_errors_of(algorithm):
    """The algorithm's errors, and none of its executive's on the terminal."""
    algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    return errors_of(algorithm)


def read(name, time=None, maps=True):
    """Returns the image and the reader's errors. maps: values stay in the file, however few they are."""
    reader = stratus.vtkStratusImageReader()
    errors = all_errors_of(reader)
    reader.SetMapFile(maps)
    reader.SetMappedBytesLeast(1)
    reader.SetFileName(name)
    reader.UpdateInformation()
    if not errors:
        reader.Update() if time is None else reader.UpdateTimeStep(time)
    return reader, reader.GetOutputDataObject(0), "".join(errors)


def refuse(name, *words):
    reader, image, errors = read(name)
    for word in words:
        check(word in errors, f"{name} is refused with '{word}', not '{errors}'")
    check(image is None or image.GetNumberOfPoints() == 0, f"{name} leaves the output empty")


def expect(name, values, steps, origin, time=None, tolerance=0.0):
    """values: by x, y, z and, if there are several, component. steps: the vectors as columns."""
    reader, image, errors = read(name, time)
    if errors:
        check(False, f"{name} is read: {errors}")
        return reader
    components = values.shape[3] if values.ndim > 3 else 1
    check(image.GetDimensions() == values.shape[:3], f"{name} has {values.shape[:3]} samples, not {image.GetDimensions()}")
    array = image.GetPointData().GetArray(0)
    got = vtk_to_numpy(array).reshape(*values.shape[2::-1], components).transpose(2, 1, 0, 3)
    check(array.GetNumberOfComponents() == components, f"{name} has {components} components")
    worst = numpy.abs(got.astype("f8") - values.reshape(got.shape).astype("f8")).max()
    check(worst <= tolerance * max(1.0, numpy.abs(values.astype("f8")).max()), f"{name}: values differ by {worst}")
    if not tolerance:
        check(got.dtype == values.dtype.newbyteorder("="), f"{name} has {values.dtype}, not {got.dtype}")
        check(numpy.array_equal(got, values.reshape(got.shape)), f"{name}: the same bits")
    mapped.append(reader.GetMapped())
    in_memory = vtk_to_numpy(read(name, time, maps=False)[1].GetPointData().GetArray(0)).reshape(*values.shape[2::-1], components)
    check(in_memory.tobytes() == got.transpose(2, 1, 0, 3).tobytes(), f"{name}: the same values where they are read into memory")
    lengths = numpy.linalg.norm(steps, axis=0)
    check(numpy.allclose(image.GetSpacing(), lengths, rtol=1e-6), f"{name} has the spacing {lengths}, not {image.GetSpacing()}")
    for index in itertools.product(*((0, n - 1) for n in values.shape[:3])):
        place, back = [0.0] * 3, [0.0] * 3
        image.TransformContinuousIndexToPhysicalPoint([float(i) for i in index], place)
        wanted = origin + steps @ index
        check(numpy.allclose(place, wanted, rtol=1e-6, atol=1e-5), f"{name}: sample {index} is at {wanted}, not {place}")
        image.TransformPhysicalPointToContinuousIndex(wanted, back)
        check(numpy.allclose(back, index, atol=1e-4), f"{name}: {wanted} is sample {index}, not {back}")
    info = reader.GetOutputInformation(0)
    check(numpy.allclose([info.Get(vtk.vtkDataObject.ORIGIN(), i) for i in range(3)], origin, atol=1e-5), f"{name} has its origin before it is read")
    check(numpy.allclose([info.Get(vtk.vtkDataObject.DIRECTION(), i) for i in range(9)], (steps / lengths).ravel(), atol=1e-5),
          f"{name} has its direction before it is read")
    return reader


def values_of(kind, shape=SIZE):
    """Random values by x, y, z, component: all bits of integers."""
    kind = numpy.dtype(kind)
    if kind.kind == "f":
        return (chance.normal(size=shape) * 1000).astype(kind)
    limits = numpy.iinfo(kind)
    return chance.integers(limits.min, limits.max, size=shape, dtype=kind.newbyteorder("="), endpoint=True).astype(kind)


def stored(values, order=None):
    """Bytes with the first index the fastest."""
    return values.tobytes(order="F")


def text(values):
    return " ".join(repr(one) for one in values.ravel(order="F").tolist())


# ---- NRRD

def vector(numbers):
    return "(" + ",".join(repr(float(one)) for one in numbers) + ")"


def nrrd(kind, sizes=SIZE, more="", encoding="raw", endian=None, frame=FRAMES["plain"], space="space: left-posterior-superior\n"):
    endian = f"endian: {endian}\n" if endian else ""
    place = f"{space}space directions: {' '.join(vector(frame[:, i]) for i in range(3))}\nspace origin: {vector(ORIGIN)}\n" if space else ""
    return (f"NRRD0004\n# a comment\ntype: {NAMES[kind][0]}\ndimension: {len(sizes)}\nsizes: {' '.join(map(str, sizes))}\n{place}{endian}"
            f"encoding: {encoding}\nkey:=value: with a colon\n{more}")


def test_nrrd_encodings():
    for kind, order, encoding in itertools.product(NAMES, "<>", ("raw", "gzip", "ascii")):
        values, endian = values_of(order + kind), "big" if order == ">" else "little"
        data = {"raw": stored(values), "gzip": gzip.compress(stored(values)), "ascii": text(values).encode()}[encoding]
        head = nrrd(kind, encoding=encoding, endian=endian)
        expect(write("a.nrrd", head, "\n", data), values, FRAMES["plain"], ORIGIN)
        write("values", data)
        expect(write("a.nhdr", head.replace("\n", "\r\n"), "data file: values\r\n"), values, FRAMES["plain"], ORIGIN)


def test_nrrd_places():
    values = values_of("<i2")
    for name, frame in FRAMES.items():
        for space in ("left-posterior-superior", "RAS", "left-anterior-superior", "scanner-xyz", "3D-left-handed", 3):
            line = f"space dimension: {space}\n" if space == 3 else f"space: {space}\n"
            reader = expect(write(f"{name}.nrrd", nrrd("i2", endian="little", frame=frame, space=line), "\n", stored(values)), values, frame, ORIGIN)
            check(("left-handed frame" in reader.GetDescription()) == (numpy.linalg.det(frame) < 0), f"{name}: {reader.GetDescription()}")
            check(("sheared" in reader.GetDescription()) == (name == "sheared"), f"{name}: {reader.GetDescription()}")
    plain = nrrd("i2", endian="little", space="")
    for more, spacing, first in (("spacings: 1 1.5 2\n", (1, 1.5, 2), (0, 0, 0)), ("spacings: nan nan nan\n", (1, 1, 1), (0, 0, 0)), ("", (1, 1, 1), (0, 0, 0)),
                                 ("spacings: 1 -1.5 2\nunits: \"mm\" \"mm\" \"mm\"\n", (1, -1.5, 2), (0, 0, 0)),
                                 ("axis mins: 10 20 30\naxis maxs: 15 24 36\ncenters: node cell ???\n", (5 / 4, 1, 2), (10, 20.5, 31)),
                                 ("axismins: 10 nan 30\nspacings: 1 2 3\ncenterings: cell node cell\n", (1, 2, 3), (10.5, 0, 31.5))):
        reader = expect(write("s.nrrd", plain, more, "\n", stored(values)), values, numpy.diag(spacing), numpy.array(first, float))
        check(reader.GetLengthUnits() == ("mm" if "mm" in more else ""), f"{more} has the unit '{reader.GetLengthUnits()}'")
    flat = values_of("<f4", (5, 4, 1))
    head = "NRRD0001\ntype: float\ndimension: 2\nsizes: 5 4\nencoding: raw\nendian: little\n"
    expect(write("f.nrrd", head, "spacings: 2 3\n\n", stored(flat)), flat, numpy.diag((2.0, 3, 1)), numpy.zeros(3))
    frame = numpy.array([[0, 0, 1], [-2, 0, 0], [0, 3.0, 0]])
    expect(write("f.nrrd", head, "space: RAS\nspace directions: (0,-2,0) (0,0,3)\nspace origin: (1,2,3)\n\n", stored(flat)), flat, frame,
           numpy.array((1.0, 2, 3)))


def test_nrrd_skips_and_files():
    values = values_of(">i2")
    data, junk = stored(values), b"one\ntwo\n" + bytes(range(100, 120))
    head = nrrd("i2", endian="big")
    write("raw", junk, data)
    expect(write("a.nhdr", head, "line skip: 2\nbyte skip: 20\ndata file: raw\n"), values, FRAMES["plain"], ORIGIN)
    expect(write("a.nhdr", head, "byteskip: -1\ndatafile: raw\n"), values, FRAMES["plain"], ORIGIN)
    expect(write("a.nrrd", head, "line skip: 2\nbyte skip: 20\n\n", junk, data), values, FRAMES["plain"], ORIGIN)
    # Compressed: lines before the stream, bytes at the begin of the inflated ones.
    write("raw", b"one\ntwo\n", gzip.compress(junk[:20] + data))
    expect(write("a.nhdr", head.replace("raw", "gz"), "line skip: 2\nbyte skip: 20\ndata file: raw\n"), values, FRAMES["plain"], ORIGIN)
    write("raw", gzip.compress(data[:50]), gzip.compress(data[50:]))  # two members are one stream
    expect(write("a.nhdr", head.replace("raw", "gzip"), "data file: raw\n"), values, FRAMES["plain"], ORIGIN)
    write("LISTED.raw", data)
    head = nrrd("i2", endian="big").replace("endian: big\n", "")
    expect(write("a.nhdr", head, "data file: LISTED.raw\nendian: big\n"), values, FRAMES["plain"], ORIGIN)
    os.makedirs("sub", exist_ok=True)
    for encoding, pack in (("raw", bytes), ("gzip", gzip.compress)):
        for k in range(3):
            write(f"sub/slice_{7 - 2 * k:03d}", pack(b"x" * 5 + stored(values[:, :, k])))
        for j, k in itertools.product(range(4), range(3)):
            write(f"row{4 * k + j}", pack(b"x" * 5 + stored(values[:, j, k])))
        head = nrrd("i2", endian="big", encoding=encoding) + "byte skip: 5\n"
        expect(write("a.nhdr", head, "data file: sub/slice_%03d 7 3 -2\n"), values, FRAMES["plain"], ORIGIN)
        expect(write("a.nhdr", head, "data file: row%d 0 11 1 1\n"), values, FRAMES["plain"], ORIGIN)
        expect(write("a.nhdr", head, "data file: LIST\n", "\n".join(f"sub/slice_{n:03d}" for n in (7, 5, 3))), values, FRAMES["plain"], ORIGIN)
        expect(write("a.nhdr", head, f"data file: LIST 1\n", "".join(f"{os.path.abspath('.')}/row{n}\n" for n in range(12))), values, FRAMES["plain"],
               ORIGIN)
        expect(write("sub/b.nhdr", head, "data file: LIST 3\n", "slice_007\nslice_005\nslice_003\n"), values, FRAMES["plain"], ORIGIN)


def test_nrrd_components_and_time():
    colors = values_of("<u1", (*SIZE, 3))
    directions = " ".join(vector(FRAMES["turned"][:, i]) for i in range(3))
    for place in range(4):
        order = [0, 1, 2]
        order.insert(place, 3)
        data = stored(colors.transpose(order))
        sizes, kinds, ways = list(SIZE), ["domain"] * 3, directions.split()
        sizes.insert(place, 3)
        kinds.insert(place, "RGB-color")
        ways.insert(place, "none")
        head = nrrd("u1", sizes=sizes, space="") + f"kinds: {' '.join(kinds)}\n"
        expect(write("c.nrrd", head, "\n", data), colors, numpy.eye(3), numpy.zeros(3))
        expect(write("c.nrrd", nrrd("u1", sizes=sizes, space=""), f"space: LPS\nspace directions: {' '.join(ways)}\nspace origin: {vector(ORIGIN)}\n\n", data),
               colors, FRAMES["turned"], ORIGIN)
    vectors = values_of(">f4", (*SIZE, 3))
    reader = expect(write("v.nrrd", nrrd("f4", sizes=(3, *SIZE), space="", endian="big"), "kinds: vector domain domain domain\n\n",
                          stored(vectors.transpose(3, 0, 1, 2))), vectors, numpy.eye(3), numpy.zeros(3))
    check(reader.GetOutput().GetPointData().GetVectors() is not None, "vectors are the active vectors")
    tensors = values_of("<f8", (*SIZE, 7))
    expect(write("t.nrrd", nrrd("f8", sizes=(7, *SIZE), space="", endian="little"), "kinds: 3D-masked-symmetric-matrix space space space\n\n",
                 stored(tensors.transpose(3, 0, 1, 2))), tensors, numpy.eye(3), numpy.zeros(3))
    # Two components over four steps, time at any place.
    film = values_of(">i4", (*SIZE, 2, 4))
    for order, encoding in itertools.product(((3, 0, 1, 2, 4), (4, 3, 0, 1, 2), (0, 1, 4, 2, 3), (3, 0, 4, 1, 2)), ("raw", "gzip", "ascii")):
        kinds = [("domain", "domain", "domain", "list", "time")[i] for i in order]
        spacings = [("1", "1.5", "2", "nan", "0.25")[i] for i in order]
        units = [('"mm"', '"mm"', '"mm"', '""', '"s"')[i] for i in order]
        moved = film.transpose(order)
        data = {"raw": stored(moved), "gzip": gzip.compress(stored(moved)), "ascii": text(moved).encode()}[encoding]
        write("film.nrrd", nrrd("i4", sizes=moved.shape, space="", endian="big", encoding=encoding), f"kinds: {' '.join(kinds)}\n"
              f"spacings: {' '.join(spacings)}\nunits: {' '.join(units)}\n\n", data)
        for step in range(4):
            reader = expect("film.nrrd", film[..., step], FRAMES["plain"], numpy.zeros(3), time=0.25 * step)
            check(reader.GetTimeUnits() == "s" and reader.GetLengthUnits() == "mm", "time and lengths have their units")
    # A space of four dimensions has time as its last dimension.
    ways = " ".join([*(vector((*FRAMES["left"][:, i], 0)) for i in range(3)), "(0,0,0,0.5)"])
    film = values_of("<u2", (*SIZE, 3))
    write("four.nrrd", nrrd("u2", sizes=film.shape, space="", endian="little"), f"space: left-posterior-superior-time\nspace directions: {ways}\n"
          f"space origin: {vector((*ORIGIN, 10))}\n\n", stored(film))
    for step in range(3):
        reader = expect("four.nrrd", film[..., step], FRAMES["left"], ORIGIN, time=10 + 0.5 * step)
        check(reader.GetOutput().GetInformation().Get(vtk.vtkDataObject.DATA_TIME_STEP()) == 10 + 0.5 * step, f"step {step} is at {10 + 0.5 * step}")


def test_nrrd_refusals():
    data = bytes(120)
    good = nrrd("i2", endian="little", more="kinds: domain domain domain\n")
    expect(write("good.nrrd", good, "\n", data), numpy.zeros(SIZE, "<i2"), FRAMES["plain"], ORIGIN)
    for old, new, *words in (
            ("endian: little\n", "", "'endian' is missing"), ("little", "middle", "'middle'", "little or big"), ("encoding: raw", "encoding: bzip2", "'bzip2'"),
            ("encoding: raw", "encoding: hex", "'hex'"), ("encoding: raw\n", "", "'encoding' is missing"), ("type: short", "type: block", "'block'"),
            ("type: short", "type: half", "'half'"), ("type: short\n", "", "'type' is missing"), ("sizes: 5 4 3\n", "", "'sizes' is missing"),
            ("sizes: 5 4 3", "sizes: 5 4", "must have 3 entries"), ("sizes: 5 4 3", "sizes: 5 0 3", "at least 1"), ("NRRD0004", "NRRD0006", "version"),
            ("dimension: 3", "dimension: 0", "1 to 16"), ("dimension: 3", "dimension: 17", "1 to 16"), ("left-posterior", "upside-down", "'space'"),
            ("space: left-posterior-superior\n", "", "'space directions' need"), ("(1.0,0.0,0.0)", "(1.0,0.0)", "vectors of 3 numbers"),
            ("(1.0,0.0,0.0)", "none", "none for an axis of the kind domain"), ("(1.0,0.0,0.0)", "(nan,0,0)", "finite"), ("(1.0,0.0,0.0)", "(0,1,0)", "one plane"),
            ("(1.0,0.0,0.0)", "(0,0,0)", "longer than 0"), ("key:=value", "nonsense: 5\nkey:=value", "line 11", "'nonsense'"),
            ("key:=value", "type: int\nkey:=value", "twice"), ("key:=value", "neither\nkey:=value", "'neither'"), ("sizes: 5 4 3", "sizes: 5 4 4", "bytes"),
            ("sizes: 5 4 3", "sizes: 2147483647 2147483647 2147483647", "more than any memory"),
            ("sizes: 5 4 3", "sizes: 2147483647 2 2", "bytes"), ("domain domain domain", "domain domain colour", "'colour'")):
        check(old in good, f"{old} is in the header")
        refuse(write("bad.nrrd", good.replace(old, new), "\n", data), "bad.nrrd", *words)
    refuse(write("bad.nrrd", nrrd("i2", sizes=(2, *SIZE), endian="little", space=""), "\n", data), "4 are of space")
    refuse(write("bad.nhdr", good), "'data file' is missing")
    refuse(write("bad.nhdr", good, "data file: absent\n"), "absent: there is no such file", "bad.nhdr")
    refuse(write("bad.nhdr", good, "data file: sub\n"), "sub: is no regular file")
    refuse(write("bad.nhdr", good, "data file: LIST\nsub/slice_003\n"), "1 files, must have 3")
    for files, word in (("s%d 1 10 0", "step"), ("s%d 1 1000000000 1", "1000000000"), ("s%d 3 1 1", "step"), ("s%d%d 1 3 1", "%03d"), ("s%s 1 3 1", "%03d"),
                        ("s%n 1 3 1", "%03d"), ("s%999d 1 3 1", "%03d"), ("s%d 1 3 1 9", "number of axes"), ("s%d 1 3 x", "integer")):
        refuse(write("bad.nhdr", good, f"data file: {files}\n"), "bad.nhdr", word)
    write("v.nrrd", nrrd("f4", sizes=(3, *SIZE), space="", endian="little"), "kinds: vector domain domain domain\nmeasurement frame: (0,1,0) (1,0,0) (0,0,1)\n\n",
          bytes(720))
    refuse("v.nrrd", "'measurement frame'")
    refuse(write("bad.nrrd", nrrd("i2", encoding="ascii"), "\n", "11 " * 59), "ends after 59 values")
    refuse(write("bad.nrrd", nrrd("i2", encoding="ascii"), "\n", "1 " * 40, "1.5 " * 20), "value 41 is '1.5'")
    refuse(write("bad.nrrd", nrrd("i2", encoding="ascii"), "\n", "1 " * 40, "40000 " * 20), "value 41 is '40000', out of the range")
    packed = gzip.compress(bytes(chance.integers(256, size=120, dtype="u1")))
    refuse(write("bad.nrrd", nrrd("i2", encoding="gzip", endian="little"), "\n", packed[:60]), "cut short")
    refuse(write("bad.nrrd", nrrd("i2", encoding="gzip", endian="little"), "\n", gzip.compress(data[:100])), "fewer values")
    refuse(write("bad.nrrd", nrrd("i2", encoding="gzip", endian="little"), "\n", b"no gzip at all"), "damaged")


# ---- MetaImage

def meta(kind, more="", frame=FRAMES["plain"], sizes=SIZE, order="<", matrix="TransformMatrix", offset="Offset"):
    lengths = numpy.linalg.norm(frame, axis=0)
    rows = " ".join(repr(float(one)) for one in (frame / lengths).T.ravel())  # a row is an axis
    return (f"ObjectType = Image\nNDims = {len(sizes)}\nBinaryData = True\nBinaryDataByteOrderMSB = {order == '>'}\n{matrix} = {rows}\n"
            f"{offset} = {' '.join(map(repr, ORIGIN.tolist()))}\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = RAI\n"
            f"ElementSpacing = {' '.join(map(repr, lengths.tolist()))}\nDimSize = {' '.join(map(str, sizes))}\n{more}ElementType = {NAMES[kind][1]}\n")


def test_meta_encodings():
    for kind, order, packed in itertools.product(NAMES, "<>", (False, True)):
        values = values_of(order + kind)
        data = zlib.compress(stored(values)) if packed else stored(values)
        head = meta(kind, order=order, more="CompressedData = True\nCompressedDataSize = %d\n" % len(data) if packed else "")
        expect(write("a.mha", head, "ElementDataFile = LOCAL\n", data), values, FRAMES["plain"], ORIGIN)
        write("values", data)
        expect(write("a.mhd", head, "ElementDataFile = values\n"), values, FRAMES["plain"], ORIGIN)
    values = values_of("<f8")
    expect(write("a.mha", meta("f8").replace("BinaryData = True", "BinaryData = False"), "ElementDataFile = LOCAL\n", text(values)), values, FRAMES["plain"],
           ORIGIN)
    expect(write("a.mha", meta("i4").replace("MET_INT", "MET_LONG"), "ElementDataFile = LOCAL\n", stored(values.astype("<i4"))), values.astype("<i4"),
           FRAMES["plain"], ORIGIN)  # of 4 bytes, by MetaIO


def test_meta_places():
    values = values_of("<i2")
    for name, frame in FRAMES.items():
        for matrix, offset in (("TransformMatrix", "Offset"), ("Orientation", "Position"), ("Rotation", "Origin")):
            expect(write(f"{name}.mha", meta("i2", frame=frame, matrix=matrix, offset=offset), "ElementDataFile = LOCAL\n", stored(values)), values, frame,
                   ORIGIN)
    head = meta("i2").replace("ElementSpacing", "ElementSize")
    expect(write("a.mha", head, "ElementDataFile = LOCAL\n", stored(values)), values, FRAMES["plain"], ORIGIN)
    bare = "ObjectType = Image\nNDims = 2\nDimSize = 5 4\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
    flat = values_of("<i2", (5, 4, 1))
    expect(write("a.mha", bare, stored(flat)), flat, numpy.eye(3), numpy.zeros(3))


def test_meta_files():
    values = values_of(">i2")
    junk = bytes(33)
    head = meta("i2", order=">")
    write("raw", junk, stored(values))
    for size in (33, -1):
        expect(write("a.mhd", head, f"HeaderSize = {size}\nElementDataFile = raw\n"), values, FRAMES["plain"], ORIGIN)
    write("packed", junk, zlib.compress(stored(values)))
    expect(write("a.mhd", head, "HeaderSize = 33\nCompressedData = True\nElementDataFile = packed\n"), values, FRAMES["plain"], ORIGIN)
    for more, pack in (("", bytes), ("CompressedData = True\n", zlib.compress), ("HeaderSize = 7\n", lambda data: bytes(7) + data)):
        for k in range(3):
            write(f"sub/part_{k:02d}", pack(stored(values[:, :, k])))
        for j, k in itertools.product(range(4), range(3)):
            write(f"line{4 * k + j + 1}", pack(stored(values[:, j, k])))
        for files in ("sub/part_%02d 0 2 1", "LIST\nsub/part_00\nsub/part_01\nsub/part_02", "LIST 2D\nsub/part_00\nsub/part_01\nsub/part_02",
                      "LIST 1\n" + "\n".join(f"line{n}" for n in range(1, 13))):
            expect(write("a.mhd", head, f"{more}ElementDataFile = {files}\n"), values, FRAMES["plain"], ORIGIN)


def test_meta_channels_scale_and_time():
    colors = values_of("<u2", (*SIZE, 3))
    data = stored(colors.transpose(3, 0, 1, 2))
    for kind in ("MET_USHORT", "MET_USHORT_ARRAY"):
        head = meta("u2", more="ElementNumberOfChannels = 3\n").replace("MET_USHORT", kind)
        expect(write("a.mha", head, "ElementDataFile = LOCAL\n", data), colors, FRAMES["plain"], ORIGIN)
    values = values_of("<i2")
    scale = "ElementToIntensityFunctionSlope = 0.5\nElementToIntensityFunctionOffset = -100\n"
    expect(write("a.mha", meta("i2", more=scale), "ElementDataFile = LOCAL\n", stored(values)), values * 0.5 - 100, FRAMES["plain"], ORIGIN, tolerance=1e-7)
    film = values_of(">f4", (*SIZE, 3))
    head = ("ObjectType = Image\nNDims = 4\nBinaryDataByteOrderMSB = True\nDimSize = 5 4 3 3\nElementSpacing = 1 1.5 2 0.5\nOffset = 5 -6.5 7.25 10\n"
            "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n")
    for step in range(3):
        expect(write("film.mha", head, stored(film)), film[..., step], FRAMES["plain"], ORIGIN, time=10 + 0.5 * step)
    # What VTK writes.
    image = vtk.vtkImageData()
    image.SetDimensions(SIZE)
    image.SetOrigin(ORIGIN)
    image.SetSpacing(1, 1.5, 2)
    image.AllocateScalars(vtk.VTK_DOUBLE, 1)
    vtk_to_numpy(image.GetPointData().GetScalars())[:] = values.astype("f8").ravel(order="F")
    writer = vtk.vtkMetaImageWriter()
    writer.SetInputData(image)
    for compressed in (True, False):
        writer.SetFileName("vtk.mha")
        writer.SetCompression(compressed)
        writer.Write()
        expect("vtk.mha", values.astype("f8"), FRAMES["plain"], ORIGIN)


def test_meta_refusals():
    good, data = meta("i2"), bytes(120)
    end = "ElementDataFile = LOCAL\n"
    expect(write("good.mha", good, end, data), numpy.zeros(SIZE, "i2"), FRAMES["plain"], ORIGIN)
    for old, new, *words in (
            ("= Image", "= Tube", "'Tube'"), ("NDims = 3", "NDims = 0", "1 to 4"), ("NDims = 3", "NDims = 5", "1 to 4"), ("NDims = 3", "NDims = -1", "1 to 4"),
            ("DimSize = 5 4 3", "DimSize = -5 4 3", "at least 1"), ("DimSize = 5 4 3", "DimSize = 5 4", "3 integers"), ("DimSize = 5 4 3\n", "", "'DimSize'"),
            ("MET_SHORT", "MET_STRING", "'MET_STRING'"), ("ElementType = MET_SHORT\n", "", "'ElementType' is missing"),
            ("BinaryData = True", "BinaryData = maybe", "True or False"), ("Offset = 5.0", "Offset = x", "finite numbers"),
            ("TransformMatrix = 1.0 0.0", "TransformMatrix = 0.0", "9 numbers"), ("TransformMatrix = 1.0 0.0", "TransformMatrix = 0.0 1.0", "one plane"),
            ("DimSize = 5 4 3", "DimSize = 5 4 4", "bytes"), ("DimSize = 5 4 3", "DimSize = 2147483647 2147483647 2147483647", "more than any memory"),
            ("ElementSpacing = 1.0", "ElementSpacing = 0", "other than 0"), ("CenterOf", "HeaderSize = -2\nCenterOf", "-1"),
            ("CenterOf", "HeaderSize = -1\nCompressedData = True\nCenterOf", "'HeaderSize'"), ("CenterOf", "DimSize = 5 4 2\nCenterOf", "'DimSize' was"),
            ("CenterOf", "neither\nCenterOf", "'neither'"), ("CenterOf", "ElementToIntensityFunctionSlope = 0\nCenterOf", "Slope")):
        check(old in good, f"{old} is in the header")
        refuse(write("bad.mha", good.replace(old, new), end, data), "bad.mha", *words)
    refuse(write("bad.mhd", good), "'ElementDataFile' is missing")
    refuse(write("bad.mhd", good, "ElementDataFile = absent\n"), "absent: there is no such file")
    refuse(write("bad.mhd", good, "ElementDataFile = LIST\nsub/part_00\n"), "1 files, must have 3")
    refuse(write("bad.mhd", good, "ElementDataFile = LIST 3D\nsub/part_00\n"), "such as 2D")
    for files, word in (("s%d 1 10 0", "step"), ("s%d 1 1000000000 1", "1000000000"), ("s%d 1 4 1", "must be 3"), ("s%x 1 3 1", "%03d")):
        refuse(write("bad.mhd", good, f"ElementDataFile = {files}\n"), word)
    refuse(write("bad.txt", "hello\n"), "begins with 'hello?'")
    refuse("nowhere.nrrd", "no such file")
    check(stratus.vtkStratusImageReader.CanReadFile("bad.txt") == 0 and stratus.vtkStratusImageReader.CanReadFile("nowhere") == 0, "no image can't be read")
    for name in ("good.mha", "good.nrrd"):
        check(stratus.vtkStratusImageReader.CanReadFile(name) == 1, f"{name} can be read")


# ---- NIfTI

def like_nibabel(name, tolerance=1e-6):
    """Compares with nibabel's values, scaled, and its affine map."""
    image = nibabel.load(name)
    values = numpy.asanyarray(image.dataobj)
    affine = image.affine
    if values.dtype.names:  # colours
        values = numpy.stack([values[one] for one in values.dtype.names], -1)
    slope = (image.dataobj.slope, image.dataobj.inter) != (1, 0)
    if values.ndim == 5:  # components behind time
        check(values.shape[3] == 1, "one step")
        values = values[:, :, :, 0]
    times = values.shape[3] if values.ndim == 4 and not image.get_data_dtype().names and len(image.shape) == 4 else 1
    for step in range(times):
        part = values[..., step] if times > 1 else values
        reader = expect(name, part.reshape(*part.shape, *(1,) * (3 - part.ndim)), affine[:3, :3], affine[:3, 3], time=step * 0.5 if times > 1 else None,
                        tolerance=tolerance if slope else 0.0)
    return reader


def test_nifti():
    if not nibabel:
        print("no nibabel: NIfTI is not judged")
        return
    kinds = {"i1": 256, "u1": 2, "i2": 4, "u2": 512, "i4": 8, "u4": 768, "i8": 1024, "u8": 1280, "f4": 16, "f8": 64}
    forms = {"1": (nibabel.Nifti1Image, nibabel.Nifti1Header, ".nii"), "2": (nibabel.Nifti2Image, nibabel.Nifti2Header, ".nii"),
             "pair": (nibabel.Nifti1Pair, nibabel.nifti1.Nifti1PairHeader, ".hdr")}
    names = list(FRAMES)
    for i, (kind, order, form, end) in enumerate(itertools.product(kinds, "<>", forms, ("", ".gz"))):
        image, header, extension = forms[form]
        head = header(endianness=order)
        head.set_data_dtype(kind)
        frame = FRAMES[names[i % len(names)]]
        affine = numpy.eye(4)
        affine[:3, :3], affine[:3, 3] = frame, ORIGIN
        made = image(values_of(kind), affine, head)
        made.set_sform(affine, code=2 if i % 3 else 0)
        sheared = names[i % len(names)] == "sheared"
        made.set_qform(affine, code=0 if sheared else 1, strip_shears=True)
        if sheared:
            made.set_sform(affine, code=1)
        if i % 2 and kind in ("i2", "u1", "i4", "f4", "f8"):
            made.header.set_slope_inter(0.5, -100)
        name = f"n{form}{extension}{end}"
        made.to_filename(name)
        saved = nibabel.load(name)
        check(saved.header.endianness == order and saved.get_data_dtype() == numpy.dtype(order + kind), f"{name} is of {order}{kind}")
        like_nibabel(name)
        if form == "pair":
            like_nibabel("npair.hdr" + end)
            _, image, errors = read("npair.img" + end)
            check(not errors and image.GetNumberOfPoints() == 60, f"the values' name stands for both: {errors}")
            os.remove("npair.img" + end)
    # Floats stored as integers, with the slope that nibabel finds.
    head = nibabel.Nifti1Header(endianness=">")
    head.set_data_dtype("i2")
    affine = numpy.eye(4)
    nibabel.Nifti1Image(chance.normal(size=SIZE), affine, head).to_filename("scaled.nii.gz")
    saved = nibabel.load("scaled.nii.gz")
    check(saved.dataobj.slope != 1, "the file has a slope")
    reader = like_nibabel("scaled.nii.gz")
    check("* stored" in reader.GetDescription() and reader.GetLengthUnits() == "", f"its scale is described: {reader.GetDescription()}")
    # Time, vectors, colours.
    film = nibabel.Nifti1Image(values_of("<i2", (*SIZE, 3)), affine)
    film.header.set_xyzt_units("mm", "msec")
    film.header["pixdim"][4] = 0.5
    film.header.set_slope_inter(2, 1)
    film.to_filename("film.nii")
    reader = like_nibabel("film.nii")
    check(reader.GetTimeUnits() == "ms" and reader.GetLengthUnits() == "mm", "time and lengths have their units")
    vectors = nibabel.Nifti1Image(values_of("<f4", (*SIZE, 1, 3)), affine)
    vectors.header.set_intent("vector")
    vectors.to_filename("vectors.nii")
    reader = like_nibabel("vectors.nii")
    check(reader.GetOutput().GetPointData().GetVectors() is not None, "vectors are the active vectors")
    both = values_of("<f4", (*SIZE, 2, 3))
    nibabel.Nifti1Image(both, affine).to_filename("both.nii")
    for step in range(2):
        expect("both.nii", both[:, :, :, step], numpy.eye(3), numpy.zeros(3), time=step)
    colors = numpy.empty(SIZE, [("R", "u1"), ("G", "u1"), ("B", "u1")])
    for name in colors.dtype.names:
        colors[name] = values_of("u1")
    nibabel.Nifti1Image(colors, affine).to_filename("colors.nii")
    like_nibabel("colors.nii")


def nifti(slope=1.0, inter=0.0, order="<", pixdim=(1, 1, 1.5, 2), qform=0, sform=0, quaternion=(0, 0, 0), rows=None, **changes):
    """A header by the standard's offsets."""
    head = bytearray(348)
    fields = {0: ("i", 348), 40: ("8h", 3, *SIZE, 1, 1, 1, 1), 70: ("h", 4), 72: ("h", 16), 76: ("8f", *pixdim, 0, 0, 0, 0), 108: ("f", 352),
              112: ("2f", slope, inter), 252: ("2h", qform, sform), 256: ("3f", *quaternion), 268: ("3f", *ORIGIN)}
    if rows is not None:
        fields[280] = ("12f", *numpy.ravel(rows))
    fields.update({int(key[1:]): value for key, value in changes.items()})
    for at, (form, *numbers) in fields.items():
        struct.pack_into(order + form, head, at, *numbers)
    head[344:348] = b"n+1\0"
    return bytes(head) + bytes(4)


def test_nifti_headers():
    """The three ways to a place, and scales that count as none, without nibabel."""
    values = values_of("<i2")
    data = stored(values)
    rows = numpy.column_stack((FRAMES["sheared"], ORIGIN))
    expect(write("a.nii", nifti(sform=1, qform=1, quaternion=(1, 0, 0), rows=rows), data), values, FRAMES["sheared"], ORIGIN)
    half = numpy.sqrt(0.5)  # a quarter turn about z; the third axis is mirrored by qfac
    quarter = numpy.array([[0, -1.5, 0], [1, 0, 0], [0, 0, -2.0]])
    expect(write("a.nii", nifti(qform=1, quaternion=(0, 0, half), pixdim=(-1, 1, 1.5, 2)), data), values, quarter, ORIGIN)
    expect(write("a.nii", nifti(qform=1, quaternion=(0, 0, half), pixdim=(0, 1, 1.5, 2)), data), values, numpy.abs(quarter) * numpy.sign(quarter + 4 * (quarter > 0)) *
           (1, 1, -1), ORIGIN)
    expect(write("a.nii", nifti(), data), values, FRAMES["plain"], numpy.zeros(3))
    for slope, inter in ((0, 5), (float("nan"), 0), (1, 0)):
        expect(write("a.nii", nifti(slope, inter), data), values, FRAMES["plain"], numpy.zeros(3))
    expect(write("a.nii", nifti(0.5, -100), data), values * 0.5 - 100, FRAMES["plain"], numpy.zeros(3), tolerance=1e-7)
    for name, head, word in (
            ("inter", nifti(1, float("nan")), "scl_inter"), ("rank", nifti(_40=("8h", 0, *SIZE, 1, 1, 1, 1)), "dim[0] is 0"),
            ("sizes", nifti(_40=("8h", 3, 5, -4, 3, 1, 1, 1, 1)), "dim[2] is -4"), ("six", nifti(_40=("8h", 6, *SIZE, 1, 1, 2, 1)), "dim[6]"),
            ("bits", nifti(_70=("h", 1)), "single bits"), ("complex", nifti(_70=("h", 32)), "complex"), ("type", nifti(_70=("h", 7)), "unknown"),
            ("long", nifti(_70=("h", 1536)), "128 bits"), ("offset", nifti(_108=("f", 20)), "at least 352"), ("half", nifti(_108=("f", 352.5)), "vox_offset"),
            ("spacing", nifti(pixdim=(1, 1, 0, 2)), "longer than 0"), ("turn", nifti(qform=1, quaternion=(1, 1, 0)), "no rotation"),
            ("flat", nifti(sform=1, rows=numpy.ones((3, 4))), "one plane"), ("nan", nifti(sform=1, rows=numpy.full((3, 4), numpy.nan)), "finite"),
            ("more", nifti(_40=("8h", 3, 5, 4, 4, 1, 1, 1, 1)), "bytes"), ("analyze", nifti()[:344] + bytes(8), "ANALYZE 7.5"),
            ("magic", nifti()[:344] + b"n+7\0" + bytes(4), "'n+7?'"), ("pair", nifti()[:344] + b"ni1\0" + bytes(4), "must end in .hdr")):
        refuse(write(name + ".nii", head, data), name + ".nii", word)
    refuse(write("short.nii", nifti()[:200]), "short.nii")


# ---- values that stay in their file

def test_mapping():
    """Values are mapped where they are in the file as they are needed."""
    values = values_of("<f4", (64, 48, 8))
    reader = expect(write("mapped.nrrd", nrrd("f4", values.shape, endian="little"), "\n", stored(values)), values, FRAMES["plain"], ORIGIN)
    aligned = len(nrrd("f4", values.shape, endian="little")) % 4 == 3
    check(reader.GetMapped() == aligned, f"values behind a header of {'whole' if aligned else 'no whole'} values: mapped {reader.GetMapped()}")
    write("mapped.raw", stored(values))
    header = nrrd("f4", values.shape, endian="little") + "data file: mapped.raw\n"
    reader = expect(write("mapped.nhdr", header), values, FRAMES["plain"], ORIGIN)
    check(reader.GetMapped() == 1, "values in a file of their own are mapped")
    array = vtk_to_numpy(reader.GetOutput().GetPointData().GetArray(0))
    array[0] = 12345.0
    with open("mapped.raw", "rb") as file:
        check(file.read() == stored(values), "what the program writes into the array does not reach the file")
    write("big.raw", stored(values.astype(">f4")))
    header = nrrd("f4", values.shape, endian="big") + "data file: big.raw\n"
    check(expect(write("big.nhdr", header), values.astype(">f4"), FRAMES["plain"], ORIGIN).GetMapped() == 0, "values of the other order are read")
    small = stratus.vtkStratusImageReader()
    small.SetFileName("mapped.nhdr")
    small.Update()
    check(small.GetMapped() == 0, "by default a small file is read")
    check(any(mapped) and not all(mapped), f"{sum(mapped)} of {len(mapped)} files are mapped")


def ranges_of(image):
    """The errors of a filter that reads all values."""
    values = stratus.vtkStratusDistanceMapFilter()
    errors = all_errors_of(values)
    values.SetInputData(image)
    values.Update()
    return "".join(errors)


def test_files_that_change():
    """A file that is cut short while it is open is an error and no crash; one that is renamed or removed keeps its values."""
    values = values_of("u1", (64, 64, 64))
    header = nrrd("u1", values.shape) + "data file: changes.raw\n"
    for change in "nothing", "removed", "replaced", "cut":
        write("changes.raw", stored(values))
        image = read(write("changes.nhdr", header))[1]
        if change == "removed":
            os.remove("changes.raw")
        elif change == "replaced":
            os.replace(write("other.raw", bytes(values.size)), "changes.raw")
        elif change == "cut":
            os.truncate("changes.raw", 5000)
        errors = ranges_of(image)
        if change == "cut":
            check("missing" in errors and "cut short" in errors, f"a file that was cut short is an error: {errors}")
            continue
        check(not errors, f"a file with {change} changed: {errors}")
        got = vtk_to_numpy(image.GetPointData().GetArray(0)).reshape(64, 64, 64).transpose(2, 1, 0)
        check(numpy.array_equal(got, values), f"a file with {change} changed has its values")


# ---- what comes of a place

def test_pictures():
    """A direction is drawn where a prop's matrix would put the image: mirrored and sheared frames, too."""
    z, y, x = numpy.mgrid[0:12, 0:14, 0:16]
    blob = (1000 * numpy.exp(-((x - 10) ** 2 + 0.7 * (y - 5) ** 2 + (z - 6) ** 2) / 14)).astype("<f4")
    for name in ("left", "sheared"):
        frame = FRAMES[name]
        write("picture.nrrd", nrrd("f4", sizes=(16, 14, 12), endian="little", frame=frame), "\n", blob.tobytes())
        pictures = []
        for by_matrix in (False, True):
            image = read("picture.nrrd")[1]
            volume = vtk.vtkVolume()
            if by_matrix:
                plain = vtk.vtkImageData()
                plain.SetDimensions(image.GetDimensions())
                plain.GetPointData().SetScalars(image.GetPointData().GetScalars())
                matrix = vtk.vtkMatrix4x4()
                for r, c in itertools.product(range(3), range(3)):
                    matrix.SetElement(r, c, frame[r, c])
                for r in range(3):
                    matrix.SetElement(r, 3, ORIGIN[r])
                volume.SetUserMatrix(matrix)
                image = plain
            mapper = stratus.vtkStratusVolumeMapper()
            mapper.SetInputData(image)
            opacity = vtk.vtkPiecewiseFunction()
            opacity.AddPoint(0, 0)
            opacity.AddPoint(1000, 0.5)
            volume.GetProperty().SetScalarOpacity(opacity)
            volume.GetProperty().SetInterpolationTypeToLinear()
            volume.SetMapper(mapper)
            renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
            window.SetOffScreenRendering(1)
            window.SetSize(90, 80)
            window.AddRenderer(renderer)
            renderer.AddVolume(volume)
            camera = renderer.GetActiveCamera()
            center = ORIGIN + frame @ (7.5, 6.5, 5.5)
            camera.SetFocalPoint(center)
            camera.SetPosition(center + numpy.array((20.0, -60, 25)))
            camera.SetViewUp(0, 0, 1)
            renderer.ResetCameraClippingRange()
            window.Render()
            grab = vtk.vtkWindowToImageFilter()
            grab.SetInput(window)
            grab.ReadFrontBufferOff()
            grab.Update()
            pictures.append(vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(int))
        check(pictures[0].max() > 60, f"{name}: something is drawn")
        check(numpy.abs(pictures[0] - pictures[1]).max() <= 2, f"{name}: as by the prop's matrix, {numpy.abs(pictures[0] - pictures[1]).max()} of 255 apart")


for name, test in list(globals().items()):
    if name.startswith("test_"):
        test()
done()
