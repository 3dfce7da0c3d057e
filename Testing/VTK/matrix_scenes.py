# SPDX-License-Identifier: BSD-3-Clause
"""Every grid, in every mode, with every feature: the scenes that test_matrix draws, as VTK's objects, and as plain arrays for matrix_reference."""
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import refined
import stratus

GRIDS = "image rectilinear amr blocks tetrahedra several image_and_mesh".split()
MODES = "composite maximum minimum average additive isosurface slice first_hit".split()
FEATURES = "light gradient_opacity function_2d two_components rgba mask labels clip crop".split()

POINTS = 16  # along each axis
SIZE = 48  # pixels across and up
SECOND = (5.0, 4.0, 3.0)  # the origin of the second of several volumes
CONTOUR = 0.4
CROP = (3.0, 12.0)  # the planes along each axis
CLIP = (8.1, 0.0, 0.0), (1.0, 0.0, 0.0)  # a point of the plane, between faces of cells, and the direction that shows
SLICE = (8.0, 7.0, 8.0), (1.0, 1.0, 1.0)
SPLIT = 8  # the plane at which blocks meet

OPACITY = ((0.05, 0.0), (1.0, 0.5))
COLOR = ((0.0, 0.2, 0.3, 1.0), (1.0, 1.0, 0.5, 0.1))
LABEL_OPACITY = ((0.3, 0.0), (1.0, 0.8))
LABEL_COLOR = ((0.0, 0.1, 0.9, 0.2), (1.0, 0.9, 0.9, 0.1))
RGBA_OPACITY = ((10.0, 0.0), (255.0, 0.5))
GRADIENT_OPACITY = ((0.0, 0.0), (0.1, 1.0))
TABLE = numpy.random.default_rng(0).random((16, 16, 4)).astype(numpy.float32)  # of a function of two variables: rows, columns


def bump(x, y, z):
    return (1.3 * numpy.exp(-((x - 8) ** 2 + (y - 7) ** 2 + (z - 8) ** 2) / 20)).astype(numpy.float32)


def rgba(v):
    """Red, green, blue and what opacity is of, bytes."""
    return [numpy.clip(200 * part, 0, 255).astype(numpy.uint8) for part in (0.3 + 0.5 * v, v, 1 - v, v)]


def values_of(features, v):
    """The components of values v, whose axes are z, y, x: the field itself, and another one."""
    if "two_components" in features:
        return numpy.stack([v, v[::-1]], -1)
    if "rgba" in features:
        return numpy.stack(rgba(v), -1)
    return v[..., None]


def lattice(features):
    z, y, x = numpy.mgrid[0:POINTS, 0:POINTS, 0:POINTS].astype(numpy.float32)
    return values_of(features, bump(x, y, z))


def add_values(data, values):
    array = numpy_to_vtk(numpy.ascontiguousarray(values.reshape(-1, values.shape[-1])), deep=1)
    array.SetName("values")
    data.SetScalars(array)


def image(features, origin=(0.0, 0.0, 0.0)):
    data = vtk.vtkImageData()
    data.SetDimensions(POINTS, POINTS, POINTS)
    data.SetOrigin(*origin)
    add_values(data.GetPointData(), lattice(features))
    return data


def coordinates():
    return numpy.arange(POINTS) ** 1.1


def rectilinear(features):
    data = vtk.vtkRectilinearGrid()
    data.SetDimensions(POINTS, POINTS, POINTS)
    axis = numpy_to_vtk(coordinates(), deep=1)
    data.SetXCoordinates(axis)
    data.SetYCoordinates(axis)
    data.SetZCoordinates(axis)
    add_values(data.GetPointData(), lattice(features))
    return data


def mesh(features):
    cut = vtk.vtkDataSetTriangleFilter()
    cut.SetInputData(image(features))
    cut.Update()
    return cut.GetOutput()


def blocks(features):
    data, source = vtk.vtkMultiBlockDataSet(), image(features)
    data.SetNumberOfBlocks(2)
    for i, (low, high) in enumerate(((0, SPLIT), (SPLIT, POINTS - 1))):
        cut = vtk.vtkExtractVOI()
        cut.SetInputData(source)
        cut.SetVOI(low, high, 0, POINTS - 1, 0, POINTS - 1)
        cut.Update()
        block = vtk.vtkImageData()
        block.ShallowCopy(cut.GetOutput())
        data.SetBlock(i, block)
    return data


def levels(features):
    """AMR of three levels. Each component is a field of its own."""
    fields = [refined.Refined(refined.uneven())]
    if "two_components" in features:
        fields.append(refined.Refined(refined.uneven(), function=lambda x, y, z: refined.bump(x, y, 10 - z)))
    if "rgba" in features:
        fields = [refined.Refined(refined.uneven(), function=lambda x, y, z, c=c: rgba(refined.bump(x, y, z))[c].astype(float)) for c in range(4)]
    return fields


def amr(features):
    fields = levels(features)
    data = fields[0].data(vtk, kind=numpy.uint8 if "rgba" in features else numpy.float64)
    for other in fields[1:]:
        more = other.data(vtk, kind=numpy.uint8 if "rgba" in features else numpy.float64)
        for level in range(data.GetNumberOfLevels()):
            for n in range(data.GetNumberOfDataSets(level)):
                here, there = (d.GetDataSet(level, n).GetCellData() for d in (data, more))
                both = numpy.concatenate([vtk_to_numpy(d.GetScalars()).reshape(here.GetNumberOfTuples(), -1) for d in (here, there)], -1)
                add_values(here, both)
    return data


def mask_values(features, grid):
    """A byte for each value: 1 (a label), or 255, near the field's top."""
    z, y, x = numpy.mgrid[0:POINTS, 0:POINTS, 0:POINTS]
    return (bump(x, y, z) > 0.2).astype(numpy.uint8) * (255 if "mask" in features else 1)


def property_of(features, mode):
    p = vtk.vtkVolumeProperty()
    p.SetInterpolationTypeToLinear()
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for point in RGBA_OPACITY if "rgba" in features else OPACITY:
        opacity.AddPoint(*point)
    for point in COLOR:
        color.AddRGBPoint(*point)
    for c in range(2 if "two_components" in features else 1):
        p.SetScalarOpacity(c, opacity)
        p.SetColor(c, color)
    if "rgba" in features:
        p.SetIndependentComponents(0)
    if "light" in features:
        p.ShadeOn()
        p.ShadeOn(1)
    if "gradient_opacity" in features:
        steep = vtk.vtkPiecewiseFunction()
        for point in GRADIENT_OPACITY:
            steep.AddPoint(*point)
        p.SetGradientOpacity(0, steep)
        p.SetGradientOpacity(1, steep)
    if "function_2d" in features:
        table = vtk.vtkImageData()
        table.SetDimensions(TABLE.shape[1], TABLE.shape[0], 1)
        add_values(table.GetPointData(), TABLE)
        p.SetTransferFunction2D(table)
        p.SetTransferFunctionMode(1)
    if "labels" in features:
        opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
        for point in LABEL_OPACITY:
            opacity.AddPoint(*point)
        for point in LABEL_COLOR:
            color.AddRGBPoint(*point)
        p.SetLabelScalarOpacity(1, opacity)
        p.SetLabelColor(1, color)
    if mode == "isosurface":
        p.GetIsoSurfaceValues().SetValue(0, CONTOUR * (200 if "rgba" in features else 1))
    if mode == "slice":
        plane = vtk.vtkPlane()
        plane.SetOrigin(*SLICE[0])
        plane.SetNormal(*SLICE[1])
        p.SetSliceFunction(plane)
    return p


def configure(mapper, grid, features, mode, device):
    settings = mapper.GetSettings() if hasattr(mapper, "GetSettings") else mapper  # of blocks
    if device != "host":
        settings.SetDevice(device)
    if mode == "first_hit":
        settings.SetRenderModeToFirstHit()
    else:
        mapper.SetBlendMode(MODES.index(mode))
    if "mask" in features or "labels" in features:
        mask = vtk.vtkImageData()
        mask.SetDimensions(POINTS, POINTS, POINTS)
        add_values(mask.GetPointData(), mask_values(features, grid)[..., None])
        settings.SetMaskInput(mask)
        if "mask" in features:
            settings.SetMaskTypeToBinary()
        else:
            settings.SetMaskTypeToLabelMap()
    if "clip" in features:
        plane = vtk.vtkPlane()
        plane.SetOrigin(*CLIP[0])
        plane.SetNormal(*CLIP[1])
        mapper.AddClippingPlane(plane)
    if "crop" in features:
        mapper.CroppingOn()
        mapper.SetCroppingRegionPlanes(*CROP, *CROP, *CROP)
        mapper.SetCroppingRegionFlagsToSubVolume()
    return mapper


def volume_of(mapper, p):
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(p)
    return volume


def mapper_of(grid, data):
    if grid in ("amr", "blocks"):
        mapper = stratus.vtkStratusMultiBlockVolumeMapper()
        mapper.SetInputDataObject(data)
        return mapper
    mapper = stratus.vtkStratusTetrahedraMapper() if grid == "tetrahedra" else stratus.vtkStratusVolumeMapper()
    mapper.SetInputData(data)
    return mapper


def scene(grid, mode, features, device="host"):
    """A volume, and who tells its error. Both of several volumes have the mode and the device; only the first has the features."""
    p = property_of(features, mode)
    if grid not in ("several", "image_and_mesh"):
        data = dict(image=image, rectilinear=rectilinear, amr=amr, blocks=blocks, tetrahedra=mesh)[grid](features)
        mapper = configure(mapper_of(grid, data), grid, features, mode, device)
        return volume_of(mapper, p), mapper
    first = configure(mapper_of("image", image(features)), grid, features, mode, device)
    if grid == "several":
        second = mapper_of("image", image((), SECOND))
    else:
        second = mapper_of("tetrahedra", mesh(()))
    second = configure(second, grid, (), mode, device)
    both = stratus.vtkStratusMultiVolume()
    both.SetVolume(volume_of(first, p), 0)
    both.SetVolume(volume_of(second, property_of((), mode)), 1)
    return both, both


def draw(grid, mode, features, device="host"):
    """What is seen, floats of 0..1 (y, x, rgb), or None; what is said; and the renderer."""
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1)
    window.SetSize(SIZE, SIZE)
    window.SetMultiSamples(0)
    window.AddRenderer(renderer)
    try:
        volume, teller = scene(grid, mode, features, device)
    except (AttributeError, TypeError) as error:
        return None, f"no such setter: {error}", renderer
    renderer.AddVolume(volume)
    renderer.ResetCamera()
    camera = renderer.GetActiveCamera()
    camera.Azimuth(30)
    camera.Elevation(20)
    renderer.ResetCameraClippingRange()
    window.Render()
    if teller.GetLastError():
        return None, teller.GetLastError(), renderer
    read = vtk.vtkWindowToImageFilter()
    read.SetInput(window)
    read.ReadFrontBufferOff()
    read.Update()
    pixels = vtk_to_numpy(read.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, 3) / 255
    return pixels, "", renderer
