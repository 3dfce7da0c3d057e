# SPDX-License-Identifier: BSD-3-Clause
"""Parts of images and grids that filters and ranks request of the readers of netCDF, Zarr, HDF5 and uncompressed images: values are those of
the whole, to the bit, wherever a part begins, and flags of ghosts are VTK's; ranks together read little more than one; pieces draw what one
draws."""
import json
import os
import shutil
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import netCDF4
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "parts")
os.makedirs(folder, exist_ok=True)
os.chdir(folder)
os.environ["STRATUS_CACHE_DIR"] = ""
NZ, NY, NX = SIZE = 90, 101, 121
CHUNKS = 16, 25, 30
z, y, x = numpy.meshgrid(*(numpy.linspace(-1, 1, n) for n in SIZE), indexing="ij")
FIELD = (numpy.exp(-2 * (x * x + y * y + z * z)) + 0.02 * numpy.random.default_rng(4).random(SIZE)).astype("f4")
WHOLE = 0, NX - 1, 0, NY - 1, 0, NZ - 1
Reader = stratus.vtkStratusVariableReader
Reader.SetMemoryLimit(1 << 30)


# ---- files
def write_netcdf(name, at=numpy.arange, falling="", order="zyx", **options):
    with netCDF4.Dataset(name, "w") as file:
        for axis, count in zip("zyx", SIZE):
            file.createDimension(axis, count)
            place = file.createVariable(axis, "f8", (axis,))
            place.units, place.axis = "m", axis.upper()
            place[:] = at(count)[::-1 if axis in falling else 1]
        file.createVariable("rho", "f4", tuple(order), **options)[:] = numpy.transpose(FIELD, ["zyx".index(axis) for axis in order])
    return name


def write_zarr(path):
    for name, document in ((".zgroup", {"zarr_format": 2}), ("rho/.zarray", {
            "zarr_format": 2, "shape": SIZE, "chunks": CHUNKS, "dtype": "<f4", "compressor": None, "fill_value": 0, "order": "C",
            "filters": None})):
        os.makedirs(os.path.dirname(os.path.join(path, name)), exist_ok=True)
        with open(os.path.join(path, name), "w") as file:
            json.dump(document, file)
    counts = [-(-n // c) for n, c in zip(SIZE, CHUNKS)]
    padded = numpy.pad(FIELD, [(0, n * c - s) for n, c, s in zip(counts, CHUNKS, SIZE)])
    for k, j, i in numpy.ndindex(*counts):
        box = tuple(slice(n * c, (n + 1) * c) for n, c in zip((k, j, i), CHUNKS))
        padded[box].tofile(os.path.join(path, "rho", f"{k}.{j}.{i}"))
    return path


def write_image(name, **options):
    """A VTKHDF file, whose extent does not begin at 0, with points and cells."""
    with netCDF4.Dataset(name, "w") as file:
        root = file.createGroup("VTKHDF")
        root.Version, root.Type = numpy.array((1, 0), "i8"), "ImageData"
        root.WholeExtent = numpy.array((-7, NX - 8, 3, NY + 2, 0, NZ - 1), "i8")
        root.Origin, root.Spacing = numpy.array((1.0, 2, 3)), numpy.array((0.5, 1, 2))
        for axis, count in zip("zyx", SIZE):
            root.createDimension(axis, count)
            root.createDimension("c" + axis, count - 1)
        root.createVariable("PointData/rho", "f4", ("z", "y", "x"), fill_value=False, **options)[:] = FIELD
        root.createVariable("CellData/mass", "f4", ("cz", "cy", "cx"), fill_value=False, **options)[:] = FIELD[:-1, 1:, :-1]
    return name


def reader_of(kind, name, map_file, **more):
    reader = getattr(stratus, kind)()
    reader.SetFileName(name), reader.SetMapFile(map_file), reader.SetMappedBytesLeast(0)
    for setter, value in more.items():
        getattr(reader, setter)(*value)
    return reader


raw = {"SetRawLayout": ((NX, NY, NZ), vtk.VTK_FLOAT, False, (1, 1, 1), 0)}
FIELD.tofile("field.raw")
stretched = lambda count: numpy.arange(count) ** 1.1
files = {
    "chunks.nc": ("vtkStratusCFReader", write_netcdf("chunks.nc", chunksizes=CHUNKS, zlib=True, complevel=1), {}),
    "falling.nc": ("vtkStratusCFReader", write_netcdf("falling.nc", falling="zx", chunksizes=CHUNKS), {}),
    "turned.nc": ("vtkStratusCFReader", write_netcdf("turned.nc", order="xzy", chunksizes=CHUNKS), {}),
    "stretched.nc": ("vtkStratusCFReader", write_netcdf("stretched.nc", at=stretched, chunksizes=CHUNKS), {}),
    "piece.nc": ("vtkStratusCFReader", write_netcdf("piece.nc", contiguous=True), {}),
    "field.zarr": ("vtkStratusZarrReader", write_zarr("field.zarr"), {}),
    "chunks.vtkhdf": ("vtkStratusHDF5Reader", write_image("chunks.vtkhdf", chunksizes=CHUNKS, zlib=True, complevel=1), {}),
    "cells of chunks.vtkhdf": ("vtkStratusHDF5Reader", "chunks.vtkhdf", {"SetVariableName": ("mass",)}),
    "one piece": ("vtkStratusHDF5Reader", write_image("piece.vtkhdf"), {}),
    "field.raw": ("vtkStratusImageReader", "field.raw", raw)}


# ---- what is in a part
def active(data):
    points, cells = data.GetPointData().GetScalars(), data.GetCellData().GetScalars()
    return (points, False) if points else (cells, True)


def box_of(data, whole):
    """The values of a data set's extent, out of the whole data set's."""
    array, cells = active(whole)
    all_of, part = whole.GetExtent(), data.GetExtent()
    values = vtk_to_numpy(array).reshape([all_of[2 * a + 1] - all_of[2 * a] + 1 - cells for a in (2, 1, 0)])
    return values[tuple(slice(part[2 * a] - all_of[2 * a], part[2 * a + 1] - all_of[2 * a] + 1 - cells) for a in (2, 1, 0))].ravel()


def same(one, other):
    return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()


def ghosts_of(data):
    arrays = (data.GetPointData().GetArray("vtkGhostType"), data.GetCellData().GetArray("vtkGhostType"))
    return [vtk_to_numpy(array) if array else None for array in arrays]


def pieces_of_vtk(extent, piece, pieces, ghosts):
    """A source of VTK's own, whose parts and flags the pipeline makes."""
    source = vtk.vtkRTAnalyticSource()
    source.SetWholeExtent(*extent)
    source.UpdatePiece(piece, pieces, ghosts)
    return source.GetOutput()


paged = reader_of("vtkStratusCFReader", "chunks.nc", True)
paged.Update()
if not paged.GetMapped():
    print("SKIPPED: this system offers no pages that stop their readers")
    sys.exit(77)
for name, (kind, path, more) in files.items():
    whole = reader_of(kind, path, False, **more)
    whole.Update()
    whole = whole.GetOutputDataObject(0)
    first = whole.GetExtent()
    shifted = lambda part: [part[i] + first[i // 2 * 2] for i in range(6)]
    for map_file in (True, False):  # what is read as a whole and cut is tried less often
        for part in ((7, 77, 40, 99, 33, 70), (0, NX - 1, 0, NY - 1, 17, 50), (31, 44, 26, 40, 17, 30), (NX - 2, NX - 1, 0, 1, 5, 6))[:4 if map_file else 1]:
            reader = reader_of(kind, path, map_file, **more)
            reader.UpdateExtent(shifted(part))
            output = reader.GetOutputDataObject(0)
            check(output.GetExtent() == tuple(shifted(part)), f"{name} has the extent {part}")
            check(bool(reader.GetMapped()) == map_file, f"{name} is {'left in the file' if map_file else 'read'}")
            check(same(vtk_to_numpy(active(output)[0]), box_of(output, whole)), f"{name} has the values of {part}")
            place = output.GetPoint(0)
            check(numpy.allclose(place, whole.GetPoint(whole.FindPoint(place)), 0, 1e-12), f"{name} has the places of {part}")
        for pieces, ghosts in ((4, 2), (3, 0)):
            for piece in range(0 if map_file else pieces - 1, pieces):
                reader = reader_of(kind, path, map_file, **more)
                reader.UpdatePiece(piece, pieces, ghosts)
                output, expected = reader.GetOutputDataObject(0), pieces_of_vtk(first, piece, pieces, ghosts)
                check(output.GetExtent() == expected.GetExtent(), f"{name}: piece {piece} of {pieces}")
                check(same(vtk_to_numpy(active(output)[0]), box_of(output, whole)), "has its values")
                for got, wanted in zip(ghosts_of(output), ghosts_of(expected)):
                    check(got is None and wanted is None or same(got, wanted), "has VTK's flags of ghosts")

# A reader whose part, file or limit changes gives what is requested then.
reader = reader_of("vtkStratusCFReader", "chunks.nc", True)
for part in ((0, 50, 0, 50, 0, 50), (50, 100, 0, 50, 0, 50)):
    reader.UpdateExtent(part)
    check(same(vtk_to_numpy(active(reader.GetOutputDataObject(0))[0]), FIELD[0:51, 0:51, part[0]:part[1] + 1].ravel()), f"then {part}")
reader.UpdateWholeExtent()
check(same(vtk_to_numpy(active(reader.GetOutputDataObject(0))[0]), FIELD.ravel()), "then all")
small = stratus.vtkStratusImageReader()
FIELD[:9, :9, :9].tofile("small.raw")
for name, size in (("small.raw", (9, 9, 9)), ("field.raw", (NX, NY, NZ))):
    small.SetFileName(name), small.SetRawLayout(size, vtk.VTK_FLOAT, False, (1, 1, 1), 0), small.Update()
    check(small.GetOutput().GetDimensions() == size, f"all of {name}")
most = reader_of("vtkStratusCFReader", "chunks.nc", True)
most.UpdatePiece(300, 100000, 0)
check(most.GetOutputDataObject(0).GetNumberOfPoints() >= 0, "a piece of too many is empty or valid")

# Bytes: of chunks that two pieces share, each piece reads its values only, and those of its ghosts.
for name in ("chunks.nc", "field.zarr", "chunks.vtkhdf", "field.raw"):
    kind, path, more = files[name]
    begin, readers = Reader.GetBytesRead(), []
    for piece in range(4):
        reader = reader_of(kind, path, True, **more)
        reader.UpdatePiece(piece, 4, 2)
        check(Reader.GetBytesRead() == begin or piece > 0, "nothing is read before something looks")
        vtk_to_numpy(active(reader.GetOutputDataObject(0))[0]).sum()
        readers.append(reader)
    share = (Reader.GetBytesRead() - begin) / FIELD.nbytes
    check(share <= 1.2, f"four pieces of {name} read {share:.2f} of the values")
del readers, reader

# ---- pictures
def look_of(volume, least):
    look = volume.GetProperty()
    look.SetInterpolationTypeToLinear(), look.SetScalarOpacityUnitDistance(8)
    opacity, color = look.GetScalarOpacity(), look.GetRGBTransferFunction()
    opacity.RemoveAllPoints(), opacity.AddPoint(least, 0), opacity.AddPoint(least + 0.7, 0.6)
    color.RemoveAllPoints(), color.AddRGBPoint(0, 0.1, 0.3, 0.9), color.AddRGBPoint(1, 0.9, 0.4, 0.1)


def picture(data, least=0.3):
    mapper = stratus.vtkStratusMultiBlockVolumeMapper() if data.IsA("vtkMultiBlockDataSet") else stratus.vtkStratusVolumeMapper()
    mapper.SetInputDataObject(data)
    heard = errors_of(mapper)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper), look_of(volume, least)
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(220, 180)
    window.AddRenderer(renderer), renderer.AddVolume(volume)
    renderer.ResetCamera(0, NX - 1, 0, NY - 1, 0, NZ - 1)
    renderer.GetActiveCamera().Azimuth(30), renderer.GetActiveCamera().Elevation(20)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window), grab.ReadFrontBufferOff(), grab.Update()
    check(not list(heard), f"nothing is wrong: {list(heard)}")
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(int)


def piece_of(path, piece, map_file=True):
    reader = reader_of("vtkStratusCFReader", path, map_file)
    reader.UpdatePiece(piece, 4, 2)
    data = reader.GetOutputDataObject(0).NewInstance()
    data.ShallowCopy(reader.GetOutputDataObject(0))
    return data


whole = reader_of("vtkStratusCFReader", "chunks.nc", False)
whole.Update()
reference = picture(whole.GetOutputDataObject(0))
check(reference.max() > 50, "something shows")
blocks = vtk.vtkMultiBlockDataSet()
for piece in range(4):
    blocks.SetBlock(piece, piece_of("chunks.nc", piece))
difference = abs(picture(blocks) - reference).max()
check(difference <= 1, f"four pieces draw what one draws, to {difference} of 255")
del blocks

# Value ranges are kept of each part, and of no other part of its size.
shutil.rmtree("cache", ignore_errors=True)
os.environ["STRATUS_CACHE_DIR"] = os.path.join(os.getcwd(), "cache")


def part_of(part, map_file):
    reader = reader_of("vtkStratusCFReader", "chunks.nc", map_file)
    reader.UpdateExtent(part)
    return reader.GetOutputDataObject(0)


parts = (5, 60, 10, 90, 0, 40), (60, 115, 10, 90, 45, 85)
for part in parts:
    before = Reader.GetBytesRead()
    picture(part_of(part, True), 2)
    read = Reader.GetBytesRead() - before
    check(read == active(part_of(part, True))[0].GetDataSize() * 4, f"nothing is known of {part} before: {read} bytes are read")
    picture(part_of(part, True), 2)
    check(Reader.GetBytesRead() - before == read, "where ranges are kept, nothing is read if nothing shows")
    same_bits = (picture(part_of(part, True)) == picture(part_of(part, False))).all()
    check(same_bits, f"a picture of {part} has the bits of one in memory")
done()
