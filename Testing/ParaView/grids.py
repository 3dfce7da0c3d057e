# SPDX-License-Identifier: BSD-3-Clause
"""One smooth field on each kind of grid, for the plugin's tests: point arrays `hill`, `wind` (three components), `wind_alone` (its
magnitude) and `wind_third` (its third component)."""
import os
import sys

import numpy
from paraview.vtk import vtkIOXML, vtkCommonCore, vtkCommonDataModel, vtkFiltersCore, vtkFiltersExtraction
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

sys.path[:0] = [os.path.dirname(os.path.abspath(__file__)), os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "VTK")]
import netcdf
from refined import Refined, uneven

COUNTS = (40, 36, 30)
COLORS = [(0, 0.3, 0.4, 0.7), (0.5, 0.9, 0.9, 0.9), (1.4, 1, 0.9, 0.7)]
OPACITY = [(0.05, 0), (1.4, 0.4)]


def axes():
    """Even in x, finer towards one end in y, growing by a factor in z."""
    x = numpy.linspace(100, 139, COUNTS[0])
    y = -20 + 45 * numpy.linspace(0, 1, COUNTS[1]) ** 1.5
    z = 5 + numpy.cumsum(0.4 * 1.05 ** numpy.arange(COUNTS[2]))
    return x, y, z


def points():
    x, y, z = axes()
    return numpy.stack(numpy.meshgrid(x, y, z, indexing="ij"), axis=-1)  # [i, j, k, xyz]


def vectors(p):
    """Three smooth components, the first at least 0; their magnitude is below 1.4."""
    u = (p - [120, 0, 15]) / [18, 20, 12]
    hill = numpy.clip(1 - (u**2).sum(axis=-1), 0, None)
    return numpy.stack([hill, 0.6 * hill * numpy.sin(3 * u[..., 0]), 0.5 * hill * numpy.cos(2 * u[..., 1])], axis=-1)


def add(grid, name, values):
    tuples = values.reshape(values.shape[0] * values.shape[1] * values.shape[2], -1, order="F")
    array = numpy_to_vtk(numpy.ascontiguousarray(tuples), deep=True)
    array.SetName(name)
    grid.GetPointData().AddArray(array)


def fill(grid):
    values = vectors(points())
    add(grid, "hill", values[..., 0])
    add(grid, "wind", values)
    add(grid, "wind_alone", numpy.sqrt((values**2).sum(axis=-1)))
    add(grid, "wind_third", values[..., 2])
    return grid


def write(grid, writer, folder, name):
    path = os.path.join(folder, name)
    writer.SetInputData(grid)
    writer.SetFileName(path)
    if writer.Write() != 1:
        raise OSError(f"{path} is not written")
    return path


def rectilinear():
    grid = vtkCommonDataModel.vtkRectilinearGrid()
    grid.SetDimensions(*COUNTS)
    for coordinates, set_coordinates in zip(axes(), (grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates)):
        set_coordinates(numpy_to_vtk(coordinates, deep=True))
    return fill(grid)


def image(cells=False, ripple=9):
    """Even in all axes, with a ripple that bends within a few voxels; cells: its array is of cells; ripple: how often it turns."""
    counts = (61, 47, 33)
    grid = vtkCommonDataModel.vtkImageData()
    grid.SetDimensions(*counts)
    grid.SetOrigin(100, -20, 5)
    grid.SetSpacing(0.65, 0.97, 0.83)
    n = [count - 1 for count in counts] if cells else counts
    places = numpy.stack(numpy.meshgrid(*[o + s * (numpy.arange(m) + (0.5 if cells else 0)) for o, s, m in
                                          zip(grid.GetOrigin(), grid.GetSpacing(), n)], indexing="ij"), axis=-1)
    u = (places - [120, 2, 18]) / [18, 20, 12]
    hill = numpy.clip(1 - (u**2).sum(axis=-1) + 0.2 * numpy.sin(ripple * u[..., 0]) * numpy.cos(8 * u[..., 1]), 0, None)
    array = numpy_to_vtk(numpy.ascontiguousarray(hill.reshape(-1, order="F")), deep=True)
    array.SetName("hill")
    (grid.GetCellData() if cells else grid.GetPointData()).AddArray(array)
    return grid


def structured():
    """Layers over hills."""
    p = points()
    p[..., 2] += 3 * numpy.sin(p[..., 0] / 6) * numpy.cos(p[..., 1] / 8)
    grid = vtkCommonDataModel.vtkStructuredGrid()
    grid.SetDimensions(*COUNTS)
    places = vtkCommonCore.vtkPoints()
    places.SetData(numpy_to_vtk(numpy.ascontiguousarray(p.reshape(-1, 3, order="F")), deep=True))
    grid.SetPoints(places)
    return fill(grid)


def blocks():
    """The rectilinear grid in three uneven blocks within blocks."""
    whole = rectilinear()
    inner, outer = vtkCommonDataModel.vtkMultiBlockDataSet(), vtkCommonDataModel.vtkMultiBlockDataSet()
    nx, ny, nz = (count - 1 for count in COUNTS)
    for number, extent in enumerate(((0, 9, 0, ny, 0, nz), (9, nx, 0, 25, 0, nz), (9, nx, 25, ny, 0, nz))):
        crop = vtkFiltersExtraction.vtkExtractRectilinearGrid()
        crop.SetInputData(whole)
        crop.SetVOI(*extent)
        crop.Update()
        inner.SetBlock(number, crop.GetOutput())
    outer.SetBlock(0, inner)
    return outer


def refined():
    """AMR of three levels, whose values are of cells."""
    function = lambda x, y, z: vectors(numpy.stack([x, y, z], axis=-1))[..., 0]
    data = Refined(uneven(), spacing=(2.5, 3.75, 2.6), origin=(100, -20, 5), function=function)
    return data.data(vtkCommonDataModel, name="hill")


def refined_row():
    """The refined grid four times in a row, so that ranks have much that is far from the others' parts."""
    boxes = []
    for level, lo, hi in uneven():
        boxes += [(level, (lo[0] + shift, *lo[1:]), (hi[0] + shift, *hi[1:])) for shift in (16 * 2**level * n for n in range(4))]
    function = lambda x, y, z: vectors(numpy.stack([x, y, z], axis=-1))[..., 0]
    data = Refined(boxes, counts=(64, 12, 10), spacing=(0.625, 3.75, 2.6), origin=(100, -20, 5), function=function)
    return data.data(vtkCommonDataModel, name="hill")


def unstructured(grid):
    join = vtkFiltersCore.vtkAppendFilter()
    join.AddInputData(grid)
    join.Update()
    return join.GetOutput()


def write_netcdf(data, path):
    """Values of an image of whole layers along its axes, for readers of netCDF that leave them in the file."""
    counts, origin, spacing = data.GetDimensions(), data.GetOrigin(), data.GetSpacing()
    variables = {name: ((name,), origin[a] + spacing[a] * numpy.arange(counts[a], dtype=float), {"units": "m", "axis": name.upper()})
                 for a, name in enumerate("xyz")}
    values = vtk_to_numpy(data.GetPointData().GetArray("hill")).astype(float).reshape(counts[::-1])
    variables["hill"] = (tuple("zyx"), values, {})
    netcdf.write(path, dict(zip("xyz", counts)), variables)


def write_all(folder):
    """Returns the names of four files: levels.vtr, hills.vts, cells.vtu (the cells of hills.vts) and parts.vtm (blocks of levels.vtr).
    Also writes even.vti, even.nc of the same points, and early.vti before it in time; refined.vthb and row.vthb, which are AMR; boxes.vti, whose values are of cells; and two.vti, of
    two cells."""
    for name, made in ("even.vti", image()), ("early.vti", image(ripple=25)), ("boxes.vti", image(cells=True)):
        write(made, vtkIOXML.vtkXMLImageDataWriter(), folder, name)
    write_netcdf(image(), os.path.join(folder, "even.nc"))
    write(refined(), vtkIOXML.vtkXMLUniformGridAMRWriter(), folder, "refined.vthb")
    write(refined_row(), vtkIOXML.vtkXMLUniformGridAMRWriter(), folder, "row.vthb")
    two = vtkCommonDataModel.vtkImageData()
    two.SetDimensions(3, 2, 2)
    add(two, "hill", numpy.arange(12.0).reshape(3, 2, 2) / 10)
    write(two, vtkIOXML.vtkXMLImageDataWriter(), folder, "two.vti")
    return (write(rectilinear(), vtkIOXML.vtkXMLRectilinearGridWriter(), folder, "levels.vtr"),
            write(structured(), vtkIOXML.vtkXMLStructuredGridWriter(), folder, "hills.vts"),
            write(unstructured(structured()), vtkIOXML.vtkXMLUnstructuredGridWriter(), folder, "cells.vtu"),
            write(blocks(), vtkIOXML.vtkXMLMultiBlockDataWriter(), folder, "parts.vtm"))
