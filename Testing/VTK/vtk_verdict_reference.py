# SPDX-License-Identifier: BSD-3-Clause
"""A third opinion where two pictures differ: the volume integral in double precision along every fourth pixel's ray, in NumPy."""
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from vtk_verdict import BACKGROUND, SIZE, look_at, nothing, volume_of

EVERY = 4


def subset(picture):
    """The pixels of a picture that the reference has."""
    return picture[EVERY // 2 :: EVERY, EVERY // 2 :: EVERY]


def rays(bounds, camera):
    """Eyes and directions (unit length) of the subset's pixels for pair()'s pictures of data within these bounds."""
    renderer, actor, source = vtk.vtkRenderer(), vtk.vtkActor(), vtk.vtkCubeSource()
    source.SetBounds(*bounds)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor.SetMapper(mapper)
    renderer.AddActor(actor)
    renderer.SetNearClippingPlaneTolerance(0.001)  # as in a window with 24 bits of depth
    look_at(renderer, camera)
    matrix = renderer.GetActiveCamera().GetCompositeProjectionTransformMatrix(SIZE[0] / SIZE[1], -1, 1)
    inverse = numpy.linalg.inv(numpy.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)]))
    x, y = (numpy.arange(EVERY // 2, n, EVERY) for n in SIZE)
    x, y = numpy.meshgrid((2 * x + 1) / SIZE[0] - 1, (2 * y + 1) / SIZE[1] - 1)
    ends = []
    for depth in -1.0, 1.0:
        point = numpy.stack([x, y, numpy.full_like(x, depth), numpy.ones_like(x)], -1) @ inverse.T
        ends.append(point[..., :3] / point[..., 3:])
    ways = ends[1] - ends[0]
    return ends[0], ways / numpy.linalg.norm(ways, axis=-1, keepdims=True)


def trilinear(axes, field, points):
    """The field[z, y, x], of numbers or arrays, between the points of axes x, y, z."""
    result, corners = 0.0, []
    for axis, coordinate in zip(axes, numpy.moveaxis(points, -1, 0)):
        cell = numpy.clip(numpy.searchsorted(axis, coordinate, "right") - 1, 0, len(axis) - 2)
        corners.append((cell, numpy.clip((coordinate - axis[cell]) / (axis[cell + 1] - axis[cell]), 0, 1)))
    (i, u), (j, v), (k, w) = corners
    for dk in 0, 1:
        for dj in 0, 1:
            for di in 0, 1:
                weight = (u if di else 1 - u) * (v if dj else 1 - v) * (w if dk else 1 - w)
                result = result + weight.reshape(weight.shape + (1,) * (field.ndim - 3)) * field[k + dk, j + dj, i + di]
    return result


def nodes(function, columns):
    """The points of a vtkPiecewiseFunction or vtkColorTransferFunction: places, and these columns."""
    rows = []
    for i in range(function.GetSize()):
        row = [0.0] * (6 if function.IsA("vtkColorTransferFunction") else 4)
        function.GetNodeValue(i, row)
        rows.append(row)
    return numpy.array(rows)[:, [0, *columns]].T


def composite(data, look, camera=(30, 20, 1.3), step=0.04, place=nothing, field=None, inside=None):
    """RGB of 255 for an image or rectilinear grid with values at points, placed by place(volume). field(axes, values, points): values in
    place of the data's between points; inside(points): which places show something."""
    if isinstance(data, vtk.vtkRectilinearGrid):
        axes = [vtk_to_numpy(getattr(data, f"Get{n}Coordinates")()).astype(float) for n in "XYZ"]
    else:
        axes = [o + s * numpy.arange(n) for o, s, n in zip(data.GetOrigin(), data.GetSpacing(), data.GetDimensions())]
    values = vtk_to_numpy(data.GetPointData().GetScalars()).astype(float).reshape([len(a) for a in reversed(axes)])
    low, high = (numpy.array([axis[end] for axis in axes]) for end in (0, -1))
    mapper = vtk.vtkGPUVolumeRayCastMapper()
    mapper.SetInputData(data)
    volume = volume_of(mapper, look, place)
    eyes, ways = rays(volume.GetBounds(), camera)
    inverse = numpy.linalg.inv(numpy.array([[volume.GetMatrix().GetElement(i, j) for j in range(4)] for i in range(4)]))
    eyes, ways = eyes @ inverse[:3, :3].T + inverse[:3, 3], ways @ inverse[:3, :3].T  # lengths along the rays stay the world's
    with numpy.errstate(divide="ignore", invalid="ignore"):
        crossings = numpy.stack([(low - eyes) / ways, (high - eyes) / ways])
    first = numpy.maximum(numpy.nanmax(crossings.min(0), -1), 0)
    last = numpy.nanmin(crossings.max(0), -1)
    count = max(int(numpy.ceil((last - first).max() / step)), 1)
    colors, alphas = nodes(look.GetRGBTransferFunction(), (1, 2, 3)), nodes(look.GetScalarOpacity(), (1,))
    light, passed = numpy.zeros(eyes.shape), numpy.ones(eyes.shape[:2])
    for n in range(count):
        places = first + (n + 0.5) * step
        some = places < numpy.ceil((last - first) / step) * step + first
        if not some.any():
            break
        length = numpy.clip(last - (places - 0.5 * step), 0, step)
        points = eyes + (places - 0.5 * step + 0.5 * length)[..., None] * ways
        value = (field or trilinear)(axes, values, points)
        alpha = numpy.interp(value, alphas[0], alphas[1])
        if inside is not None:
            alpha = alpha * inside(points)
        shown = passed * (1 - (1 - alpha) ** (length / look.GetScalarOpacityUnitDistance())) * some
        for c in range(3):
            light[..., c] += shown * numpy.interp(value, colors[0], colors[1 + c])
        passed -= shown
    return 255 * (light + passed[..., None] * numpy.array(BACKGROUND))


def from_reference(pairs, exact):
    """The mean distance of VTK's picture and of ours from the reference, of 255."""
    vtks, ours = pairs
    return numpy.abs(subset(vtks) - exact).mean(), numpy.abs(subset(ours) - exact).mean()
