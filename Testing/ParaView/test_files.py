# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: File > Open and Save Data. The project's readers open its writers' files by their extension; meshes in layers,
CF's grids, Zarr, HDF5, sparse grids and scans give their variables, times, values and places.
pvbatch test_files.py PLUGIN STRATUS COMPARE-PICTURES FOLDER; sparse grids are read where the test of their reader has left them in FOLDER/.."""
import gzip
import json
import os
import subprocess
import sys

import numpy
from paraview import simple
from paraview.vtk import vtkCommonDataModel
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import netcdf
from beside import check, folder, leave, load


def values_of(source, name, of="GetPointData"):
    array = getattr(simple.servermanager.Fetch(source), of)().GetArray(name)
    return None if array is None else vtk_to_numpy(array)


def readers_of(path):
    """Returns the names of the readers that the dialog of File > Open offers."""
    factory = simple.servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
    if factory.GetNumberOfRegisteredPrototypes() == 0:
        factory.UpdateAvailableReaders()
    found = factory.GetReaders(path, simple.servermanager.ActiveConnection.Session)
    return [found.GetString(i) for i in range(1, found.GetNumberOfStrings(), 3)]


def variables_of(reader):
    return list(reader.GetProperty("VariableNames"))


def opened(path, name):
    reader = simple.OpenDataFile(path)
    check(reader is not None and reader.GetXMLName() == name, f"{path} is opened by {name}")
    reader.UpdatePipeline()
    return reader


def tetgen_files():
    base = os.path.join(folder, "two")
    open(base + ".node", "w").write("5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n")
    open(base + ".ele", "w").write("2 4 0\n0 0 1 2 3\n1 1 2 3 4\n")
    mesh = simple.servermanager.Fetch(opened(base + ".ele", "StratusTetGenReader"))
    check(mesh.GetNumberOfCells() == 2 and mesh.GetNumberOfPoints() == 5, "two tetrahedra over five points")
    cells = simple.Tetrahedralize(Input=simple.Wavelet(WholeExtent=[0, 3, 0, 3, 0, 3]))
    written = os.path.join(folder, "cells.ele")
    simple.SaveData(written, proxy=cells, FirstNumber="1")
    check(open(written).readlines()[1].split()[0] == "1", "cells are counted from 1")
    again = simple.servermanager.Fetch(opened(written, "StratusTetGenReader"))
    before = simple.servermanager.Fetch(cells)
    check(again.GetNumberOfCells() == before.GetNumberOfCells() > 100, "all tetrahedra")
    check((vtk_to_numpy(again.GetPointData().GetArray(0)) == vtk_to_numpy(before.GetPointData().GetArray(0))).all(), "all values")
    ball = simple.Sphere(PhiResolution=6, ThetaResolution=7)
    written = os.path.join(folder, "ball.smesh")
    simple.SaveData(written, proxy=ball)
    surface = simple.servermanager.Fetch(opened(written, "StratusTetGenReader"), idx=1)
    check(surface.GetNumberOfCells() == simple.servermanager.Fetch(ball).GetNumberOfCells() == 56, "all triangles")


def pictures_as_floats():
    picture = vtkCommonDataModel.vtkImageData()
    picture.SetDimensions(7, 5, 1)
    values = numpy_to_vtk(numpy.arange(140, dtype=numpy.float32).reshape(35, 4) / 139, deep=True)
    values.SetName("RGBA")
    picture.GetPointData().SetScalars(values)
    source = simple.TrivialProducer()
    source.GetClientSideObject().SetOutput(picture)
    path = os.path.join(folder, "floats.exr")
    simple.SaveData(path, proxy=source)
    data = open(path, "rb").read()
    check(data[:4] == b"\x76\x2f\x31\x01" and all(channel + b"\0\x02\0\0\0" in data for channel in (b"R", b"G", b"B", b"A")),
          "four channels of floats in an EXR file")
    again = values_of(opened(path, "StratusEXRReader"), "RGBA")
    check((again == numpy.arange(140, dtype=numpy.float32).reshape(35, 4) / 139).all(), "which come back")


def mesh_in_layers():
    """A rectangle and a triangle, two layers between -10 and the free surface, two times."""
    words = lambda **of: of
    path = netcdf.write(os.path.join(folder, "layers.nc"), {"time": 2, "node": 5, "face": 2, "corner": 4, "layer": 2, "border": 3}, {
        "mesh": ((), 0, {"cf_role": "mesh_topology", "topology_dimension": 2, "node_coordinates": "x y", "face_node_connectivity": "corners"}),
        "time": (("time",), [0.0, 600], words(units="seconds since 2020-05-01")),
        "x": (("node",), [0.0, 2, 2, 0, 3], words(units="m", standard_name="projection_x_coordinate")),
        "y": (("node",), [0.0, 0, 1, 1, 0], words(units="m", standard_name="projection_y_coordinate")),
        "corners": (("face", "corner"), [[1, 2, 3, 4], [2, 3, 5, -1]], {"start_index": 1, "_FillValue": -1}),
        "middle": (("layer",), [-0.75, -0.25], words(standard_name="ocean_sigma_coordinate", formula_terms="sigma: middle eta: level depth: bed")),
        "border": (("border",), [-1.0, -0.5, 0], words(standard_name="ocean_sigma_coordinate")),
        "level": (("time", "face"), [[0.0, 0], [2, 6]], words(mesh="mesh", location="face", standard_name="sea_surface_height")),
        "bed": (("face",), [-10.0, -10], words(mesh="mesh", location="face", standard_name="altitude")),
        "salt": (("time", "face", "layer"), [[[1.0, 2], [3, 4]], [[5, 6], [7, 8]]], words(mesh="mesh", location="face", units="psu")),
        "heat": (("time", "face", "layer"), [[[11.0, 12], [13, 14]], [[15, 16], [17, 18]]], words(mesh="mesh", location="face"))})
    check("StratusUGRIDReader" in readers_of(path), f"meshes in layers are offered, not {readers_of(path)}")
    reader = simple.StratusUGRIDReader(FileName=path)
    reader.UpdatePipeline()
    check(variables_of(reader) == ["salt", "heat", "level", "bed"], f"variables {variables_of(reader)}, layered ones first")
    check(list(reader.TimestepValues) == [0, 600], f"times {reader.TimestepValues}")
    reader.Variable = "salt"
    for time, expected in (0, [1, 3, 2, 4]), (600, [5, 7, 6, 8]):
        reader.UpdatePipeline(time)
        check(list(values_of(reader, "salt", "GetCellData")) == expected, f"salt at {time}")
    reader.Variable = "heat"
    reader.UpdatePipeline(0)
    check(list(values_of(reader, "heat", "GetCellData")) == [11, 13, 12, 14], "another variable")


def grid_of_cf():
    path = netcdf.write(os.path.join(folder, "grid.nc"), {"time": 2, "z": 3, "y": 2, "x": 4}, {
        "time": (("time",), [3.0, 4], {"units": "hours since 2001-01-01"}), "z": (("z",), [0.0, 1, 4], {"units": "m", "axis": "Z"}),
        "y": (("y",), [0.0, 2], {"units": "m", "axis": "Y"}), "x": (("x",), [10.0, 11, 12, 13], {"units": "m", "axis": "X"}),
        "qc": (("time", "z", "y", "x"), numpy.arange(48.0).reshape(2, 3, 2, 4), {"units": "g/kg"})})
    offered = readers_of(path)
    check("StratusCFReader" in offered and "StratusUGRIDReader" not in offered, f"only CF's grids are offered, not {offered}")
    reader = simple.StratusCFReader(FileName=path)
    reader.UpdatePipeline(4)
    check(list(reader.TimestepValues) == [3, 4] and variables_of(reader) == ["qc"] and "z" in reader.Description, "times and variables")
    grid = reader.GetClientSideObject().GetOutputDataObject(0)  # Fetch() of ParaView 5.11 loses any rectilinear grid's coordinates
    check((vtk_to_numpy(grid.GetPointData().GetArray("qc")) == numpy.arange(24, 48)).all(), "values of the second time")
    check(list(vtk_to_numpy(grid.GetZCoordinates())) == [0, 1, 4], "uneven levels")
    reader = simple.StratusCFReader(FileName=path, Selection="time=1")
    reader.UpdatePipeline()
    grid = reader.GetClientSideObject().GetOutputDataObject(0)
    check((vtk_to_numpy(grid.GetPointData().GetArray("qc")) == numpy.arange(24, 48)).all() and "index 1 of 0..1" in reader.Description,
          "a selected index")


def flat_grid_of_cf():
    """Heights of flat data are exaggerated unless that is switched off."""
    path = netcdf.write(os.path.join(folder, "flat.nc"), {"z": 3, "y": 2, "x": 3}, {
        "z": (("z",), [0.0, 10, 40], {"units": "m", "axis": "Z"}), "y": (("y",), [0.0, 5000], {"units": "m", "axis": "Y"}),
        "x": (("x",), [0.0, 1000, 10000], {"units": "m", "axis": "X"}), "qc": (("z", "y", "x"), numpy.arange(18.0).reshape(3, 2, 3), {"units": "g/kg"})})
    reader = simple.StratusCFReader(FileName=path)
    for on, factor in (1, 50), (0, 1):
        reader.ExaggerateHeights = on
        reader.UpdatePipeline()
        grid = reader.GetClientSideObject().GetOutputDataObject(0)
        check(list(vtk_to_numpy(grid.GetZCoordinates())) == [0, 10 * factor, 40 * factor], f"heights times {factor}: {grid.GetBounds()}")
        used = grid.GetFieldData().GetArray("HeightFactor")
        check(used.GetValue(0) == factor if on else used is None, "the factor is in the output")


def folder_of_zarr():
    values = numpy.arange(60, dtype="<f4").reshape(3, 4, 5)
    path = os.path.join(folder, "field.zarr")
    os.makedirs(os.path.join(path, "rho"), exist_ok=True)
    for name, document in ((".zgroup", {"zarr_format": 2}), ("rho/.zarray", {
            "zarr_format": 2, "shape": values.shape, "chunks": (2, 4, 3), "dtype": "<f4", "compressor": None, "fill_value": 0, "order": "C",
            "filters": None})):
        with open(os.path.join(path, name), "w") as file:
            json.dump(document, file)
    for k in range(2):
        for i in range(2):
            chunk = numpy.zeros((2, 4, 3), "<f4")
            part = values[2 * k:2 * k + 2, :, 3 * i:3 * i + 3]
            chunk[tuple(map(slice, part.shape))] = part
            chunk.tofile(os.path.join(path, "rho", f"{k}.0.{i}"))
    metadata = os.path.join(path, ".zgroup")
    check("StratusZarrReader" in readers_of(path) and "StratusZarrReader" in readers_of(metadata), f"{readers_of(path)}, {readers_of(metadata)}")
    for name in path, metadata:
        check((values_of(opened(name, "StratusZarrReader"), "rho") == values.ravel()).all(), f"values of {name}")


def files_of_hdf5():
    """Values may be left in the file."""
    subprocess.run(["/usr/bin/python3", os.path.join(os.path.dirname(os.path.abspath(__file__)), "hdf5.py"), folder], check=True)
    values = numpy.arange(210)
    plain = opened(os.path.join(folder, "plain.h5"), "StratusHDF5Reader")
    check(variables_of(plain) == ["/run/rho"] and (values_of(plain, "/run/rho") == values).all(), "a data set by its path")
    path = os.path.join(folder, "image.vtkhdf")
    check("StratusHDF5Reader" in readers_of(path), f"ours is offered, not {readers_of(path)}")
    image = simple.StratusHDF5Reader(FileName=path, Variable="salt", LeaveValuesInFile=1, MemoryLimit=64)
    image.UpdatePipeline()
    check((values_of(image, "salt") == 2 * values).all() and variables_of(image) == ["heat", "salt"], "an array of an image")
    check(simple.StratusImageReader().LeaveValuesInFile == 1 and simple.StratusCFReader().LeaveValuesInFile == 0, "only images are left in the file by default")


def images_of_scans():
    """Big-endian and compressed, turned and mirrored; ParaView's own reader leaves both out."""
    values = numpy.arange(24, dtype=">i2").reshape(4, 3, 2)
    path = os.path.join(folder, "scan.nrrd")
    with open(path, "wb") as file:
        file.write(b"NRRD0004\ntype: short\ndimension: 3\nsizes: 2 3 4\nspace: RAS\nspace directions: (0,2,0) (-1.5,0,0) (0,0,-3)\n"
                   b"space origin: (5,6,7)\nendian: big\nencoding: gzip\n\n" + gzip.compress(values.tobytes()))
    check("StratusImageReader" in readers_of(path), f"ours is offered, not {readers_of(path)}")
    reader = simple.StratusImageReader(FileName=path)
    reader.UpdatePipeline()
    image = reader.GetClientSideObject().GetOutputDataObject(0)
    check((vtk_to_numpy(image.GetPointData().GetArray("ImageFile")) == numpy.arange(24)).all(), "values")
    place = [0.0, 0.0, 0.0]
    image.TransformContinuousIndexToPhysicalPoint([1, 2, 3], place)
    check(numpy.allclose(place, (2, 8, -2)) and image.GetSpacing() == (2, 1.5, 3), f"the last sample's place, {place}")


def sparse_grids():
    path = os.path.join(folder, "..", "float.vdb")
    if not os.path.exists(path):
        print(f"SKIPPED: {path} is not here, as TestStratusVDBReader has not run; no sparse grid was read")
        return False
    reader = opened(path, "StratusVDBReader")
    name = variables_of(reader)[0]
    values = values_of(reader, name)
    check(values.min() == -2.5 and values.max() > 40, "the cloud and its background")  # of Testing/VTK/vdb_testing.h
    reader.Layout = "Blocks"
    reader.UpdatePipeline()
    check(reader.GetClientSideObject().GetOutputDataObject(0).IsA("vtkPartitionedDataSet"), "blocks if they are requested")
    return True


load()
tetgen_files()
pictures_as_floats()
mesh_in_layers()
grid_of_cf()
flat_grid_of_cf()
folder_of_zarr()
files_of_hdf5()
images_of_scans()
leave(sparse_grids())
