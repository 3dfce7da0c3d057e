# SPDX-License-Identifier: BSD-3-Clause
"""vtkStratusXMLImageReader has the output of vtkXMLImageDataReader, to the bit, whatever the order of bytes, the compression and the extent, in
memory and as bricks. Damaged files are refused with the fault, and values that are lost while a file is open are an error of the mapper."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "xml-images")
os.makedirs(folder, exist_ok=True)
os.chdir(folder)
os.environ["STRATUS_CACHE_DIR"] = ""
LIMIT = 16 << 20
chance = numpy.random.default_rng(7)
COMPRESSORS = {"": None, "zlib": vtk.vtkZLibDataCompressor, "lz4": vtk.vtkLZ4DataCompressor, "lzma": vtk.vtkLZMADataCompressor}


def add(data, name, values):
    array = numpy_to_vtk(values, deep=1)
    array.SetName(name)
    data.AddArray(array)
    return array


def image_of(extent=(-2, 20, 3, 14, 7, 16)):
    image = vtk.vtkImageData()
    image.SetExtent(extent)
    image.SetOrigin(5, -6.5, 7.25), image.SetSpacing(1, 1.5, 0.75)
    image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    points, cells = image.GetNumberOfPoints(), image.GetNumberOfCells()
    add(image.GetPointData(), "wind", chance.normal(size=(points, 3)).astype("f4"))
    density = numpy.cumsum(chance.normal(size=points)).astype("f8")
    add(image.GetPointData(), "density", density).GetInformation().Set(vtk.vtkDataArray.UNITS_LABEL(), "kg/m3")
    add(image.GetPointData(), "count", chance.integers(-3000, 3000, points, dtype="i2"))
    add(image.GetPointData(), "long", chance.integers(-2 ** 62, 2 ** 62, points, dtype="i8"))
    add(image.GetCellData(), "kind", chance.integers(0, 5, cells, dtype="u1"))
    add(image.GetCellData(), "flux", chance.normal(size=cells).astype("f4"))
    image.GetPointData().SetActiveScalars("density")
    image.GetPointData().SetActiveVectors("wind")
    image.GetCellData().SetActiveScalars("flux")
    add(image.GetFieldData(), "MetresPerUnit", numpy.array([0.25]))
    return image


def write(name, image, compressor="", big=False, wide=True, encode=False, mode="Appended", block=None):
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(name), writer.SetInputData(image)
    getattr(writer, f"SetDataModeTo{mode}")()
    writer.SetEncodeAppendedData(encode)
    writer.SetCompressor(COMPRESSORS[compressor]() if compressor else None)
    writer.SetBlockSize(block) if block else None
    writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
    writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
    check(writer.Write() == 1, f"{name} is written")
    return name


def read(reader, name, maps=False, variable=None):
    """Returns the image and the reader's errors."""
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    errors = errors_of(reader)
    if not isinstance(reader, vtk.vtkXMLImageDataReader):
        reader.SetMapFile(maps), reader.SetMappedBytesLeast(0), reader.SetVariableName(variable)
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutputDataObject(0), "".join(errors)


def vtk_image(name):
    image, errors = read(vtk.vtkXMLImageDataReader(), name)
    check(not errors, f"VTK reads {name}: {errors}")
    return image


def expect(name, maps):
    """The output of our reader is VTK's. Returns our reader."""
    reader, wanted = stratus.vtkStratusXMLImageReader(), vtk_image(name)
    image, errors = read(reader, name, maps)
    kind = name + (" as bricks" if maps else "")
    check(not errors, f"{kind} is read: {errors}")
    check(image.GetExtent() == wanted.GetExtent(), f"{kind} has the extent {wanted.GetExtent()}, not {image.GetExtent()}")
    for one in ("Origin", "Spacing"):
        check(getattr(image, "Get" + one)() == getattr(wanted, "Get" + one)(), f"{kind}: {one}")
    for row in range(3):
        for column in range(3):
            check(image.GetDirectionMatrix().GetElement(row, column) == wanted.GetDirectionMatrix().GetElement(row, column), f"{kind}: direction")
    information = reader.GetOutputInformation(0)
    check([information.Get(vtk.vtkDataObject.ORIGIN(), a) for a in range(3)] == list(wanted.GetOrigin()), f"{kind}: the origin before it is read")
    for data in ("GetPointData", "GetCellData", "GetFieldData"):
        mine, its = getattr(image, data)(), getattr(wanted, data)()
        check(mine.GetNumberOfArrays() == its.GetNumberOfArrays(), f"{kind}: {data} has {its.GetNumberOfArrays()} arrays")
        for i in range(its.GetNumberOfArrays()):
            one, other = mine.GetArray(i), its.GetArray(i)
            check(one.GetName() == other.GetName() and one.GetDataType() == other.GetDataType(), f"{kind}: array {other.GetName()}")
            check(one.GetNumberOfComponents() == other.GetNumberOfComponents(), f"{kind}: components of {other.GetName()}")
            check(bytes(vtk_to_numpy(one).copy()) == bytes(vtk_to_numpy(other)), f"{kind}: values of {other.GetName()}")
            units = vtk.vtkDataArray.UNITS_LABEL()
            its_units = other.GetInformation().Get(units) if other.HasInformation() else None
            check((one.GetInformation().Get(units) if one.HasInformation() else None) == its_units, f"{kind}: units of {other.GetName()}")
        for i in range(vtk.vtkDataSetAttributes.NUM_ATTRIBUTES if data != "GetFieldData" else 0):
            names = [one.GetAbstractAttribute(i).GetName() if one.GetAbstractAttribute(i) else None for one in (mine, its)]
            check(names[0] == names[1], f"{kind}: attribute {i} of {data} is {names[1]}, not {names[0]}")
    return reader


def refuse(name, *words):
    check(stratus.vtkStratusXMLImageReader.CanReadFile(name) == 1, f"{name} is for this reader")
    image, errors = read(stratus.vtkStratusXMLImageReader(), name, True)
    for word in words:
        check(word in errors, f"{name} is refused with '{word}', not '{errors}'")
    check(image is None or image.GetNumberOfPoints() == 0, f"{name} leaves the output empty")


def test_values():
    bricks = False
    for extent in ((-2, 20, 3, 14, 7, 16), (0, 40, 0, 30, 0, 0), (5, 5, 0, 30, 2, 9), (0, 63, 0, 63, 0, 15)):
        image = image_of(extent)
        for compressor in ("", "zlib", "lz4"):
            for big, wide, block in ((False, True, None), (True, False, None), (True, True, 4096)):
                name = write("a.vti", image, compressor, big, wide, block=block)
                check(stratus.vtkStratusXMLImageReader.CanReadFile(name) == 1, f"{name} is for this reader")
                expect(name, False)
                bricks = expect(name, True).GetMapped() or bricks
    if not bricks:
        print("SKIPPED: this system offers no pages that stop their readers")


def test_others():
    """Files that VTK's own reader is for."""
    image = image_of()
    for name, options in {"text": dict(mode="Ascii"), "inline": dict(mode="Binary"), "base64": dict(encode=True), "lzma": dict(compressor="lzma")}.items():
        write(name + ".vti", image, **options)
        check(stratus.vtkStratusXMLImageReader.CanReadFile(name + ".vti") == 0, f"{name}.vti is left to VTK")
        errors = read(stratus.vtkStratusXMLImageReader(), name + ".vti")[1]
        check("vtkXMLImageDataReader may read it" in errors, f"{name}.vti: {errors}")
    for name in ("nowhere.vti", sys.argv[0]):
        check(stratus.vtkStratusXMLImageReader.CanReadFile(name) == 0, f"{name} is no image")


def test_variables():
    name = write("a.vti", image_of())
    reader = stratus.vtkStratusXMLImageReader()
    image, errors = read(reader, name, variable="count")
    check(not errors and image.GetPointData().GetScalars().GetName() == "count", "the variable is active")
    names = [reader.GetNameOfVariable(i) for i in range(reader.GetNumberOfVariables())]
    check(names == ["density", "count", "long", "flux", "kind", "wind"], f"variables are in the order in which they are drawn: {names}")
    check(reader.GetUnitsOfVariable(0) == "kg/m3", "the unit of the variable")
    image, errors = read(stratus.vtkStratusXMLImageReader(), name, variable="kind")
    check(image.GetCellData().GetScalars().GetName() == "kind", "a variable of cells is active")
    errors = read(stratus.vtkStratusXMLImageReader(), name, variable="rho")[1]
    check("there is no variable 'rho'" in errors and "density (kg/m3)" in errors, f"another variable: {errors}")


def test_parts():
    """The extent that a filter requests has the values of VTK's reader there."""
    extent = (1, 9, 4, 12, 9, 13)
    for compressor, big, maps in (("", False, True), ("", True, True), ("zlib", False, True), ("lz4", True, False)):
        name = write("a.vti", image_of(), compressor, big)
        crop = vtk.vtkExtractVOI()
        crop.SetInputData(vtk_image(name)), crop.SetVOI(*extent), crop.Update()
        reader = stratus.vtkStratusXMLImageReader()
        reader.SetFileName(name), reader.SetMapFile(maps), reader.SetMappedBytesLeast(0)
        reader.UpdateExtent(extent)
        image, wanted = reader.GetOutputDataObject(0), crop.GetOutput()
        check(image.GetExtent() == extent, f"{compressor}: the extent is {extent}, not {image.GetExtent()}")
        for data in ("GetPointData", "GetCellData"):
            for i in range(getattr(wanted, data)().GetNumberOfArrays()):
                other = getattr(wanted, data)().GetArray(i)
                one = getattr(image, data)().GetArray(other.GetName())
                check(bytes(vtk_to_numpy(one).copy()) == bytes(vtk_to_numpy(other)), f"{compressor}: the part of {other.GetName()}")


def changed(name, old, new):
    with open(name, "rb") as file:
        data = file.read()
    check(re.search(old, data) is not None, f"{name} has {old}")
    with open("damaged.vti", "wb") as file:
        file.write(re.sub(old, new, data, count=1))
    return "damaged.vti"


def test_damage():
    raw = write("raw.vti", image_of())
    zlib = write("zlib.vti", image_of((0, 63, 0, 63, 0, 15)), "zlib")
    refuse(changed(raw, rb'WholeExtent="[^"]*"', b'WholeExtent="0 4 0 4"'), "WholeExtent is '0 4 0 4'", "must be 6 integers")
    refuse(changed(raw, rb'WholeExtent="[^"]*"', b'WholeExtent="4 0 0 4 0 4"'), "WholeExtent is 4 to 0 along x, must rise")
    refuse(changed(raw, rb'WholeExtent="[^"]*"', b'WholeExtent="0 9 0 9 0 9"'), "Extent of the piece", "must be WholeExtent")
    refuse(changed(raw, rb'Spacing="[^"]*"', b'Spacing="1 0 1"'), "Spacing is 0 along y, must be above 0")
    refuse(changed(raw, rb'Origin="[^"]*"', b'Origin="1 nan 1"'), "Origin is '1 nan 1'", "must be 3 finite numbers")
    refuse(changed(raw, rb'Direction="[^"]*"', b'Direction="1 0 0 1 0 0 0 0 1"'), "in one plane")
    for attribute, wrong in ("byte_order", "MiddleEndian"), ("header_type", "UInt16"):
        name = changed(raw, attribute.encode() + rb'="[^"]*"', f'{attribute}="{wrong}"'.encode())
        check(stratus.vtkStratusXMLImageReader.CanReadFile(name) == 0, f"VTK's parser refuses {attribute}")
        check(wrong in read(stratus.vtkStratusXMLImageReader(), name)[1], f"{attribute} is in the error")
    offset = rb'(Name="wind"[^>]*offset=)"[0-9]+"'
    refuse(changed(raw, offset, rb'\1"99999999"'), "'wind' are at byte", "beyond the file's end")
    refuse(changed(raw, offset, rb'\1"-3"'), "offset of DataArray 'wind' is '-3', must be an integer from 0")
    refuse(changed(raw, offset, rb'\1"17"'), "'wind' has", "bytes of values, must have")
    refuse(changed(raw, rb'(Name="MetresPerUnit"[^>]*offset=)"[0-9]+"', rb'\1"99999999"'), "the field data cannot be read")
    refuse(changed(raw, rb'NumberOfComponents="3"', b'NumberOfComponents="4"'), "'wind' has", "must have")
    refuse(changed(raw, rb'NumberOfComponents="3"', b'NumberOfComponents="0"'), "NumberOfComponents of DataArray 'wind' is '0'")
    refuse(changed(raw, rb'WholeExtent="-2 20', b'WholeExtent="-1000000000 1000000000'), "Extent of the piece")
    length = os.path.getsize(raw)
    with open(raw, "rb") as file:
        data = file.read()
    begin = data.index(b'<AppendedData')
    for cut in (length - 200, begin + 40 + 5000, begin + 60):
        with open("short.vti", "wb") as file:
            file.write(data[:cut])
        refuse("short.vti", "file")
    with open("short.vti", "wb") as file:
        file.write(data[:begin - 100])
    check(stratus.vtkStratusXMLImageReader.CanReadFile("short.vti") == 0, "a header that is cut short is no XML")
    errors = read(stratus.vtkStratusXMLImageReader(), "short.vti")[1]
    check("its XML can't be read" in errors or "not appended" in errors, f"a header that is cut short: {errors}")
    with open(zlib, "rb") as file:
        data = bytearray(file.read())
    underscore = data.index(b"_", data.index(b"<AppendedData"))
    first = underscore + 1 + int(re.search(rb'Name="wind"[^>]*offset="([0-9]+)"', data).group(1))
    for at, word, value in ((0, 0, 2 ** 60), (8, 1, 3), (16, 2, 2 ** 40), (24, 3, 2 ** 50)):
        wrong = bytearray(data)
        wrong[first + at:first + at + 8] = value.to_bytes(8, "little")
        with open("damaged.vti", "wb") as file:
            file.write(wrong)
        refuse("damaged.vti", "'wind'", "block")
    wrong = bytearray(data)
    wrong[underscore + 1:underscore + 9] = (2 ** 60).to_bytes(8, "little")  # the first array is the field data's
    with open("damaged.vti", "wb") as file:
        file.write(wrong)
    refuse("damaged.vti", "the field data cannot be read")
    blocks = int.from_bytes(data[first:first + 8], "little")
    wrong = bytearray(data)
    wrong[first + 24 + 8 * blocks + 20:first + 24 + 8 * blocks + 60] = bytes(40)
    with open("damaged.vti", "wb") as file:
        file.write(wrong)
    errors = read(stratus.vtkStratusXMLImageReader(), "damaged.vti", False)[1]
    check("the values of the array 'wind' cannot be read: they are damaged or cut short" in errors, f"a damaged block: {errors}")


def field(n=170):
    """A ball in an image that is larger than the least limit."""
    image = vtk.vtkImageData()
    image.SetDimensions(n, n, n)
    z, y, x = numpy.meshgrid(*3 * [numpy.linspace(-1, 1, n, dtype="f4")], indexing="ij")
    add(image.GetPointData(), "rho", numpy.exp(-6 * (x * x + y * y + z * z)).astype("f4").ravel())
    image.GetPointData().SetActiveScalars("rho")
    return image


def picture(data, errors=None):
    mapper = stratus.vtkStratusVolumeMapper()
    mapper.SetInputDataObject(data)
    if errors is not None:
        errors.append(errors_of(mapper))
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    look = volume.GetProperty()
    look.SetInterpolationTypeToLinear(), look.SetScalarOpacityUnitDistance(10)
    opacity, color = look.GetScalarOpacity(), look.GetRGBTransferFunction()
    opacity.RemoveAllPoints(), opacity.AddPoint(0.5, 0), opacity.AddPoint(1, 0.8)
    color.RemoveAllPoints(), color.AddRGBPoint(0, 0.1, 0.3, 0.9), color.AddRGBPoint(1, 0.9, 0.4, 0.1)
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(150, 120)
    window.AddRenderer(renderer), renderer.AddVolume(volume), renderer.ResetCamera()
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window), grab.ReadFrontBufferOff(), grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).copy()


def test_pictures():
    """In bounded memory, the picture has the bits that it has of VTK's reader, and values that were cut off are an error."""
    image = field()
    stratus.vtkStratusVariableReader.SetMemoryLimit(LIMIT)
    for name, options in {"raw": {}, "swapped": dict(big=True), "zlib": dict(compressor="zlib"), "lz4": dict(compressor="lz4")}.items():
        name = write(f"ball-{name}.vti", image, **options)
        wanted = picture(vtk_image(name))
        reader = stratus.vtkStratusXMLImageReader()
        reader.SetFileName(name), reader.MapFileOn()
        before = reader.GetBytesRead()
        reader.Update()
        if not reader.GetMapped():
            print("SKIPPED: this system offers no pages that stop their readers")
            return
        check(reader.GetBytesRead() == before, f"{name}: nothing is read before something looks at it")
        got = picture(reader.GetOutputDataObject(0))
        check(wanted.max() > 0 and numpy.array_equal(got, wanted), f"{name}: the picture has the same bits in {LIMIT >> 20} MiB")
        check(0 < reader.GetMemoryUsed() <= LIMIT, f"{name}: {reader.GetMemoryUsed()} bytes are in memory")
        reader = stratus.vtkStratusXMLImageReader()
        reader.SetFileName(name), reader.MapFileOn()
        reader.Update()
        os.truncate(name, os.path.getsize(name) // 2)
        heard = []
        picture(reader.GetOutputDataObject(0), heard)
        check("missing" in "".join(heard[0]) or "lack" in "".join(heard[0]), f"{name}: that it was cut short is an error: {heard}")
        write(name, image, **options)  # written anew in place
        reader = stratus.vtkStratusXMLImageReader()
        reader.SetFileName(name), reader.MapFileOn()
        reader.Update()
        os.rename(write("other.vti", image_of()), name)  # the file that is open keeps its values
        check(numpy.array_equal(picture(reader.GetOutputDataObject(0)), wanted), f"{name}: a file that is replaced keeps its values")


test_values()
test_others()
test_variables()
test_parts()
test_damage()
test_pictures()
done()
