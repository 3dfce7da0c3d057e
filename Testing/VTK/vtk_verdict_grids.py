# SPDX-License-Identifier: BSD-3-Clause
"""Rectilinear grids, blocks, and meshes of cells."""
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import vtk_verdict_data as made
from vtk_verdict import SIZE, TETRA, Better, Different, Same, case, nothing, pair
from vtk_verdict_data import image, look
from vtk_verdict_modes import waving
from vtk_verdict_reference import from_reference, composite, subset, trilinear


def stretched(power=1.5, n=32):
    """The wave field on axes whose spacings grow, as a rectilinear grid."""
    axis = 32 * numpy.linspace(0, 1, n) ** power
    data = vtk.vtkRectilinearGrid()
    data.SetDimensions(n, n, n)
    for name in "XYZ":
        getattr(data, f"Set{name}Coordinates")(numpy_to_vtk(axis, deep=True))
    values = numpy_to_vtk(made.waves(n).ravel(), deep=True)
    values.SetName("values")
    data.GetPointData().SetScalars(values)
    return data


def as_vtk_reads(axes, values, points):
    """Values of a rectilinear grid at the places that VTK 9.1 takes: the box shrinks by a part of its size, and the field shifts by half a
    voxel."""
    places = []
    for axis, place in zip(axes, numpy.moveaxis(points, -1, 0)):
        count, length = len(axis), axis[-1] - axis[0]
        place = axis[0] + (0.5 * length + (place - axis[0]) * (count - 1)) / count
        cell = numpy.clip(numpy.searchsorted(axis, place, "right") - 1, 0, count - 2)
        places.append(numpy.clip(cell + (place - axis[cell]) / (axis[cell + 1] - axis[cell]) - 0.5, 0, count - 1))
    return trilinear([numpy.arange(len(axis)) for axis in axes], values, numpy.stack(places, -1))


@case("TestGPURayCastMapperRectilinearGrid")
def rectilinear():
    data, shown = stretched(), waving()
    both = pair(data, shown)
    same_places = subset(both[0]), composite(data, shown, step=0.1, field=as_vtk_reads)
    return Different([both], [same_places], from_reference(both, composite(data, shown, step=0.1)))


def blocks(field, cuts):
    """The image of a field cut into boxes at these indices of each axis; neighbours share a layer of points."""
    whole = image(field)
    set_ = vtk.vtkMultiBlockDataSet()
    number = 0
    for k in range(len(cuts) - 1):
        for j in range(len(cuts) - 1):
            for i in range(len(cuts) - 1):
                part = vtk.vtkExtractVOI()
                part.SetInputData(whole)
                part.SetVOI(cuts[i], cuts[i + 1], cuts[j], cuts[j + 1], cuts[k], cuts[k + 1])
                part.Update()
                set_.SetBlock(number, part.GetOutput())
                number += 1
    return set_


@case("TestMultiBlockMapper")
def image_blocks():
    return Same(pair(blocks(made.blobs(), (0, 19, 39)), look(), kind=vtk.vtkMultiBlockVolumeMapper))


@case("TestMultiBlockMapperRectilinearGrid")
def rectilinear_blocks():
    set_ = vtk.vtkMultiBlockDataSet()
    for number, (low, high) in enumerate(((0, 15), (15, 31))):
        part = vtk.vtkExtractRectilinearGrid()
        part.SetInputData(stretched())
        part.SetVOI(low, high, 0, 31, 0, 31)
        part.Update()
        set_.SetBlock(number, part.GetOutput())
    vtks, ours = from_reference(pair(set_, waving(), kind=vtk.vtkMultiBlockVolumeMapper), composite(stretched(), waving(), step=0.1))
    return Better({}, ours, vtks)


def slope():
    """An image of a linear field, which tetrahedra of any division interpolate exactly."""
    z, y, x = made.grid(16)
    return image((127.5 + 50 * x + 40 * y + 37.5 * z).astype(numpy.float32), spacing=(2, 2, 2))


def tetrahedra(data):
    divided = vtk.vtkDataSetTriangleFilter()
    divided.SetInputData(data)
    divided.Update()
    return divided.GetOutput()


def bunyk(mapper):
    if hasattr(mapper, "SetRayCastFunction"):
        mapper.SetRayIntegrator(vtk.vtkUnstructuredGridPartialPreIntegration())


THIN = (0, 0), (80, 0), (255, 0.1)


def against_reference(kind=TETRA, settings=nothing, grid=None, **options):
    data, shown = slope(), look(alpha=THIN)
    both = pair(grid or tetrahedra(data), shown, settings, kind=kind, size=SIZE, **options)
    return Different([both], reference=from_reference(both, composite(data, shown, step=0.1, **options)))


@case("TestProjectedTetrahedra")
def projected():
    return against_reference()


@case("ProjectedTetrahedraZoomIn")
def projected_inside():
    def camera(renderer, view):
        view.SetPosition(16, 15, 22), view.SetFocalPoint(13, 14, 8), view.SetViewAngle(50)

    return against_reference(camera=camera)


def transformed(volume):
    turned = vtk.vtkTransform()
    turned.Translate(10, 0, 3), turned.RotateX(30), turned.Scale(1, 0.7, 1.2)
    volume.SetUserTransform(turned)


@case("TestProjectedTetrahedraTransform", "TestProjectedTetrahedraOffscreen")
def projected_transformed():
    return against_reference(place=transformed)


@case("TestProjectedTetrahedraVectorComponent")
def projected_component():
    """The second of three components, which the first function of colour chooses."""
    values = vtk_to_numpy(slope().GetPointData().GetScalars()).reshape(16, 16, 16)
    grid = tetrahedra(image(numpy.stack([0 * values, values, 255 - values], -1), spacing=(2, 2, 2)))
    data, shown = slope(), look(alpha=THIN)
    shown.GetRGBTransferFunction().SetVectorModeToComponent()
    shown.GetRGBTransferFunction().SetVectorComponent(1)
    both = pair(grid, shown, kind=TETRA)
    return Different([both], reference=from_reference(both, composite(data, shown, step=0.1)))


@case("TestMultiBlockUnstructuredGridVolumeMapper")
def mesh_blocks():
    set_ = vtk.vtkMultiBlockDataSet()
    for number, bounds in enumerate(((0, 7), (7, 15))):
        part = vtk.vtkExtractVOI()
        part.SetInputData(slope())
        part.SetVOI(*bounds, 0, 15, 0, 15)
        part.Update()
        set_.SetBlock(number, tetrahedra(part.GetOutput()))
    return against_reference(vtk.vtkMultiBlockUnstructuredGridVolumeMapper, grid=set_)
