# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: each kind of data set looks as `stratus render` draws it: rectilinear, unstructured and structured grids, vectors
by magnitude and component, projections, a crop box. pvbatch test_datasets.py PLUGIN STRATUS COMPARE-PICTURES FOLDER, in the repository's root."""
import os
import sys

import numpy
from paraview.vtk import vtkIOXML, vtkCommonCore, vtkCommonDataModel, vtkFiltersCore, vtkFiltersExtraction
from paraview.vtk.util.numpy_support import numpy_to_vtk

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, draw, folder, leave, load

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


def write(grid, writer, name):
    path = os.path.join(folder, name)
    writer.SetInputData(grid)
    writer.SetFileName(path)
    check(writer.Write() == 1, f"{name} is written")
    return path


def rectilinear():
    grid = vtkCommonDataModel.vtkRectilinearGrid()
    grid.SetDimensions(*COUNTS)
    for coordinates, set_coordinates in zip(axes(), (grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates)):
        set_coordinates(numpy_to_vtk(coordinates, deep=True))
    return fill(grid)


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


def unstructured(grid):
    join = vtkFiltersCore.vtkAppendFilter()
    join.AddInputData(grid)
    join.Update()
    return join.GetOutput()


load()
levels = write(rectilinear(), vtkIOXML.vtkXMLRectilinearGridWriter(), "levels.vtr")
hills = write(structured(), vtkIOXML.vtkXMLStructuredGridWriter(), "hills.vts")
cells = write(unstructured(structured()), vtkIOXML.vtkXMLUnstructuredGridWriter(), "cells.vtu")
parts = write(blocks(), vtkIOXML.vtkXMLMultiBlockDataWriter(), "parts.vtm")
draw(parts, "hill", OPACITY, COLORS, 1.0, 53, judge=levels, representation="UniformGridRepresentation")
for path in levels, hills, cells:
    draw(path, "hill", OPACITY, COLORS, 1.0, 55)
    draw(path, "wind", OPACITY, COLORS, 1.0, 55, component="Magnitude", judged="wind_alone")
    draw(path, "wind", OPACITY, COLORS, 1.0, 55, component="Z", judged="wind_third")
    projection = "StratusProjection" if path == levels else "StratusCellsBlendMode"
    draw(path, "hill", OPACITY, COLORS, 1.0, 55, settings={projection: "Maximum Intensity"}, options=("--mode", "maximum"))
draw(levels, "hill", OPACITY, COLORS, 1.0, 55, settings={"UseCropping": 1, "CroppingScale": [1, 1, 0.5]},
     options=("--crop", ",".join(str(edge) for axis, scale in zip(axes(), (1, 1, 0.5)) for edge in (axis[0] * scale, axis[-1] * scale))))
leave()
