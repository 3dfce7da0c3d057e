# SPDX-License-Identifier: BSD-3-Clause
"""Pictures from files of OpenEXR, made here byte by byte, and how they differ, against NumPy: bits, errors, structural similarity. Damaged
files and other files are refused with a message."""
import os
import random
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "pictures")
os.makedirs(folder, exist_ok=True)
if not hasattr(stratus, "vtkStratusEXRReader"):
    print("SKIPPED: built without OpenEXR")
    sys.exit(77)


KINDS = {numpy.dtype("u4"): 0, numpy.dtype("f2"): 1, numpy.dtype("f4"): 2}


def exr(channels, low=(0, 0), flags=0, sampling=(1, 1), size=None):
    """The bytes of a file without compression: {name: rows from the top}. low: the first column and row."""
    height, width = next(iter(channels.values())).shape
    columns, rows = size or (width, height)
    names = sorted(channels)
    chlist = b"".join(name.encode() + b"\0" + struct.pack("<iBxxxii", KINDS[channels[name].dtype], 0, *sampling) for name in names) + b"\0"
    box = struct.pack("<iiii", low[0], low[1], low[0] + columns - 1, low[1] + rows - 1)
    attributes = [("channels", "chlist", chlist), ("compression", "compression", b"\0"), ("dataWindow", "box2i", box),
                  ("displayWindow", "box2i", box), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                  ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))]
    if flags & 0x200:
        attributes.append(("tiles", "tiledesc", struct.pack("<IIB", 16, 16, 0)))
    head = struct.pack("<II", 20000630, 2 | flags)
    for name, kind, value in attributes:
        head += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    head += b"\0"
    lines = []
    for y in range(height):
        data = b"".join(channels[name][y].tobytes() for name in names)
        lines.append(struct.pack("<ii", low[1] + y, len(data)) + data)
    table, at = b"", len(head) + 8 * height
    for line in lines:
        table += struct.pack("<Q", at)
        at += len(line)
    return head + table + b"".join(lines)


def read(data, name="made.exr"):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(data)
    reader = stratus.vtkStratusEXRReader()
    errors = errors_of(reader)
    reader.SetFileName(path)
    reader.Update()
    return reader, errors


def refused(data, words):
    reader, errors = read(data, "refused.exr")
    check(len(errors) >= 1 and words in errors[0], f"'{words}' in {errors}")
    check(reader.GetOutput().GetNumberOfPoints() == 0 and reader.GetErrorCode() != 0, f"{words}: no output")


generator = numpy.random.default_rng(5)


def any_bits(height, width):
    return generator.integers(0, 2**32, (height, width), dtype=numpy.uint64).astype(numpy.uint32).view(numpy.float32)


def reads():
    plain = any_bits(5, 7)
    plain = numpy.where(numpy.isnan(plain), numpy.float32(2), plain)  # a NaN's bits need not survive a test by ==
    half = numpy.linspace(-3, 70000, 35).reshape(5, 7).astype(numpy.float16)  # the last are infinite
    channels = {"R": plain, "G": plain * 2, "B": plain[::-1].copy(), "A": half, "Z": plain + 1, "v.0": plain, "v.1": half, "w.1": plain, "odd": half}
    reader, errors = read(exr(channels, low=(-3, 11)))
    picture = reader.GetOutput()
    check(not errors and picture.GetDimensions() == (7, 5, 1), f"{errors}, {picture.GetDimensions()}")
    data = picture.GetPointData()
    names = {data.GetArrayName(i): data.GetArray(i).GetNumberOfComponents() for i in range(data.GetNumberOfArrays())}
    check(names == {"RGBA": 4, "Depth": 1, "v": 2, "w.1": 1, "odd": 1}, f"arrays {names}")
    check(data.GetScalars().GetName() == "RGBA", "colours are the scalars")
    for name, component, of in ("RGBA", 0, "R"), ("RGBA", 1, "G"), ("RGBA", 2, "B"), ("RGBA", 3, "A"), ("Depth", 0, "Z"), ("v", 0, "v.0"), ("v", 1, "v.1"), (
            "w.1", 0, "w.1"), ("odd", 0, "odd"):
        values = vtk_to_numpy(data.GetArray(name)).reshape(5, 7, -1)[::-1, :, component]
        check((values.view(numpy.uint32) == channels[of].astype(numpy.float32).view(numpy.uint32)).all(), f"{of} comes as it was")
    check(reader.CanReadFile(reader.GetFileName()) == 1 and reader.CanReadFile(__file__) == 0 and reader.CanReadFile("nowhere") == 0, "CanReadFile")
    # The reverse: read the writer's file.
    writer = stratus.vtkStratusEXRWriter()
    writer.SetInputData(picture)
    writer.SetFileName(os.path.join(folder, "again.exr"))
    writer.Write()
    test = stratus.vtkStratusImageTest()
    test.SetImage(picture)
    test.SetBaselineFileName(writer.GetFileName())
    check(test.Compare(), test.GetReason())
    grey = {"Y": plain}
    check(read(exr(grey))[0].GetOutput().GetPointData().GetScalars().GetName() == "Y", "grey")


def refuses():
    plain = {"Y": any_bits(5, 7)}
    refused(b"", "")
    refused(b"no picture", "")
    refused(exr(plain, flags=0x200), "tiles")
    refused(exr({"id": numpy.ones((5, 7), "u4")}), "'id' is of integers")
    refused(exr({"Y": any_bits(6, 8)}, sampling=(2, 2)), "2 x 2 pixels")
    refused(exr(plain, size=(100000, 100000)), "not in it")
    refused(exr(plain)[:-9], "")
    missing = stratus.vtkStratusEXRReader()
    errors = errors_of(missing)
    missing.Update()
    check(errors and "FileName is not set" in errors[0], errors)
    errors.clear()
    missing.SetFileName(os.path.join(folder, "nowhere.exr"))
    missing.Update()
    check(errors and "there is no file" in errors[0], errors)
    # Damage: an error and nothing, or a picture.
    dice = random.Random(3)
    whole, errors = 0, 0
    sample = exr({"R": any_bits(9, 6), "A": numpy.ones((9, 6), "f2")})
    compressed = open(os.path.join(folder, "again.exr"), "rb").read()
    for source in sample, compressed:
        for _ in range(200):
            data = bytearray(source)
            for _ in range(dice.choice([1, 1, 3])):
                data[dice.randrange(len(data))] = dice.choice([0, 1, 127, 255, dice.randrange(256)])
            reader, messages = read(bytes(data[:dice.choice([len(data), dice.randrange(len(data))])]), "damaged.exr")
            check((reader.GetOutput().GetNumberOfPoints() == 0) == bool(messages), f"an error or a picture: {messages}")
            whole, errors = whole + (not messages), errors + bool(messages)
    check(whole > 20 and errors > 100, f"{whole} damaged files are read, {errors} refused")


def image_of(values, name="RGBA"):
    """rows from the bottom, columns, components"""
    image = vtk.vtkImageData()
    image.SetDimensions(values.shape[1], values.shape[0], 1)
    array = numpy_to_vtk(values.reshape(-1, values.shape[2]), deep=True)
    array.SetName(name)
    image.GetPointData().SetScalars(array)
    return image


def test_of(a, b, **limits):
    test = stratus.vtkStratusImageTest()
    errors_of(test)
    test.SetImage(image_of(a) if isinstance(a, numpy.ndarray) else a)
    test.SetBaseline(image_of(b) if isinstance(b, numpy.ndarray) else b)
    for name, value in limits.items():
        getattr(test, "Set" + name)(value)
    return test


def similarity(a, b):
    """Wang et al. 2004 by the definition, window by window, in double."""
    at = numpy.arange(11) - 5
    weights = numpy.exp(-0.5 * (at / 1.5) ** 2)
    weights = numpy.outer(weights, weights) / weights.sum() ** 2
    values = []
    for y in range(a.shape[0] - 10):
        for x in range(a.shape[1] - 10):
            p, q = a[y:y + 11, x:x + 11], b[y:y + 11, x:x + 11]
            mp, mq = (weights * p).sum(), (weights * q).sum()
            vp, vq, cov = (weights * (p - mp) ** 2).sum(), (weights * (q - mq) ** 2).sum(), (weights * (p - mp) * (q - mq)).sum()
            values.append((2 * mp * mq + 1e-4) * (2 * cov + 9e-4) / ((mp**2 + mq**2 + 1e-4) * (vp + vq + 9e-4)))
    return numpy.mean(values)


def measures():
    a = generator.random((23, 31, 4)).astype(numpy.float32)
    a[:9] = 0  # not lit
    b = a.copy()
    b[12:, 7, 1] += generator.normal(0, 0.05, 11).astype(numpy.float32)
    b[20, 30, 2] -= numpy.float32(0.25)
    difference = a.astype(float) - b
    test = test_of(a, b, LeastSSIM=-1.0)
    check(test.Compare() and test.GetReason() == "", test.GetReason())
    check(test.GetNumberOfDifferentPixels() == 12 and test.GetNumberOfLitPixels() == 14 * 31, "counts")
    check(abs(test.GetRootMeanSquare() - numpy.sqrt((difference**2).sum() / (4 * 14 * 31))) < 1e-12, "root mean square over lit pixels")
    check(abs(test.GetLargestDifference() - abs(difference).max()) < 1e-12 and test.GetLargestDifferencePixel() == (30, 20), "largest")
    expected = numpy.mean([similarity(a[..., c].astype(float), b[..., c].astype(float)) for c in range(4)])
    check(abs(test.GetSSIM() - expected) < 1e-9, f"structural similarity {test.GetSSIM()}, not {expected}")
    for limit, least in ("Tolerance", test.GetRootMeanSquare()), ("MaximumDifference", test.GetLargestDifference()):
        check(test_of(a, b, **{limit: least}).Compare() and not test_of(a, b, **{limit: 0.999 * least}).Compare(), f"{limit} decides at {least}")
    check(test_of(a, b, LeastSSIM=expected - 1e-8).Compare() and not test_of(a, b, LeastSSIM=expected + 1e-8).Compare(), "LeastSSIM decides")
    check(not test_of(a, b, Tolerance=1.0, MaximumDifference=0.1).Compare(), "each limit counts")
    check(not test_of(a, b).Compare() and test_of(a, a.copy()).Compare(), "bits by default")
    check(not test_of(a, b, Tolerance=1.0, Exact=True).Compare(), "Exact with other limits")
    # One bit, one NaN, one zero's sign.
    c = a.copy()
    c[3, 4, 0] = -0.0
    test = test_of(a, c)
    check(not test.Compare() and test.GetNumberOfDifferentPixels() == 1 and test.GetLargestDifference() == 0, "the sign of zero is a bit")
    check(test_of(a, c, MaximumDifference=0.0).Compare(), "and no difference")
    c[3, 4, 0] = numpy.nan
    test = test_of(a, c, Tolerance=1e30)
    check(not test.Compare() and numpy.isinf(test.GetLargestDifference()), f"a NaN is no colour: {test.GetReason()}")
    check(test_of(c, c.copy()).Compare(), "the same NaN is")
    # Depth counts only in the comparison of bits.
    one, other = image_of(a), image_of(a)
    for image, value in (one, 1), (other, 2):
        depth = numpy_to_vtk(numpy.full(23 * 31, value, numpy.float32), deep=True)
        depth.SetName("Depth")
        image.GetPointData().AddArray(depth)
    test = test_of(one, other)
    check(not test.Compare() and "713 of 713 pixels differ in Depth, no colour" in test.GetReason(), test.GetReason())
    check(test_of(one, other, Tolerance=0.0).Compare(), "colours are the same")
    check(not test_of(one, a).Compare(), "an array that only one has")


def files():
    a = generator.integers(0, 256, (16, 13, 3), dtype=numpy.uint8)
    b = a.copy()
    b[2, 5, 0] ^= 16
    b[3, 6, 1] ^= 4
    test = test_of(a, b)
    path = os.path.join(folder, "a.png")
    check(test.WriteImage(path), "PNG")
    again = test_of(a, None)
    again.SetBaselineFileName(path)
    check(again.Compare(), again.GetReason())
    check(not test.Compare() and abs(test.GetLargestDifference() - 16 / 255) < 1e-12, test.GetReason())
    check(test.WriteDifference(os.path.join(folder, "d.png")) and test.WriteDifference(os.path.join(folder, "d.exr")), "differences")
    reader = vtk.vtkPNGReader()
    reader.SetFileName(os.path.join(folder, "d.png"))
    reader.Update()
    shown = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(16, 13, 3)
    check(shown[2, 5].tolist() == [255, 0, 0] and shown[3, 6].tolist() == [0, 64, 0] and (shown > 0).sum() == 2, "stretched to white")
    exact = stratus.vtkStratusEXRReader()
    exact.SetFileName(os.path.join(folder, "d.exr"))
    exact.Update()
    values = vtk_to_numpy(exact.GetOutput().GetPointData().GetScalars()).reshape(16, 13, 3)
    check((values == (a / 255.0 - b / 255.0).astype(numpy.float32)).all(), "signed as they are")
    # Floats and bytes: alpha where both have it, colours by value.
    floats = numpy.concatenate([a / 255.0, numpy.full((16, 13, 1), 0.5)], axis=2).astype(numpy.float32)
    check(test_of(floats, a, MaximumDifference=1e-7).Compare(), "bytes and floats by value")
    check(not test_of(floats, a).Compare(), "but not by bits")
    check(test_of(image_of(floats), None).WriteImage(os.path.join(folder, "f.exr")), "EXR")


def refuses_pictures():
    a = numpy.zeros((4, 5, 4), numpy.float32)
    for test, words in ((test_of(a, numpy.zeros((4, 6, 4), numpy.float32)), "5 x 4 pixels, the baseline 6 x 4"),
                        (test_of(a, numpy.zeros((4, 5, 1), numpy.float32)), "4 components, the baseline 1"),
                        (test_of(a, a, LeastSSIM=0.5), "needs 11 x 11"), (test_of(a, a, Tolerance=-0.5), "Tolerance is -0.5"),
                        (test_of(a, a, MaximumDifference=float("nan")), "MaximumDifference is nan"), (test_of(a, a, LeastSSIM=1.5), "LeastSSIM is 1.5"),
                        (test_of(None, a), "there is no image"), (test_of(a, None), "there is no baseline"),
                        (test_of(a, numpy.zeros((4, 5, 5), numpy.float32)), "5 components"), (test_of(a, numpy.zeros((4, 5, 3), numpy.int32)), "int"),
                        (test_of(a, vtk.vtkImageData()), "0 x 0 x 0 points")):
        check(not test.Compare() and test.GetFailed() and words in test.GetReason(), f"'{words}' in '{test.GetReason()}'")
        check(not test.WriteDifference(os.path.join(folder, "none.png")) and not os.path.exists(os.path.join(folder, "none.png")), "nothing to write")
    test = test_of(a, a)
    for name in "nowhere.png", os.path.join(folder, "text.png"), os.path.join(folder, "text.what"):
        if os.path.isabs(name) or "text" in name:
            open(name, "w").write("text")
        test.SetBaseline(None)
        test.SetBaselineFileName(name)
        check(not test.Compare() and test.GetFailed() and name in test.GetReason(), f"{name}: {test.GetReason()}")
    check(not test.WriteImage(os.path.join(folder, "no.bmp")) and not test.WriteImage(os.path.join(folder, "no/where.exr")), "names that cannot be written")


reads()
refuses()
measures()
files()
refuses_pictures()
done()
