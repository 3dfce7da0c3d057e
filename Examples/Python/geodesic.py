# SPDX-License-Identifier: BSD-3-Clause
"""Meshes around the Earth for examples and tests: a divided icosahedron with a node at each pole, turned or not, and its dual of hexagons."""
import numpy


def icosphere(divisions, turned=None):
    """points (n, 3) on the unit sphere, triangles (m, 3) counterclockwise from outside. turned: a rotation matrix."""
    ring = numpy.radians(36.0 * numpy.arange(10))
    low = numpy.arctan(0.5)
    points = [(0.0, 0.0, 1.0)] + [(numpy.cos(a) * numpy.cos(low), numpy.sin(a) * numpy.cos(low), numpy.sin(low) * (-1) ** i) for i, a in enumerate(ring)]
    points.append((0.0, 0.0, -1.0))
    upper, lower = [1 + 2 * i for i in range(5)], [2 + 2 * i for i in range(5)]
    triangles = [(0, upper[i], upper[(i + 1) % 5]) for i in range(5)] + [(11, lower[(i + 1) % 5], lower[i]) for i in range(5)]
    for i in range(5):
        triangles += [(upper[i], lower[i], upper[(i + 1) % 5]), (upper[(i + 1) % 5], lower[i], lower[(i + 1) % 5])]
    points, triangles = numpy.array(points), numpy.array(triangles)
    for _ in range(divisions):
        edges = numpy.sort(numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        unique, number = numpy.unique(edges, axis=0, return_inverse=True)
        middles = points[unique].sum(axis=1)
        a, b, c = (number.ravel().reshape(3, -1) + len(points))
        points = numpy.concatenate([points, middles / numpy.linalg.norm(middles, axis=1)[:, None]])
        i, j, k = triangles.T
        triangles = numpy.concatenate([numpy.stack(one, axis=1) for one in ((i, a, c), (j, b, a), (k, c, b), (a, b, c))])
    return (points if turned is None else points @ numpy.asarray(turned).T), triangles


def rotation(x, y, z):
    """The matrix of turns about the axes x, y and z, by degrees."""
    (a, b, c), (s, t, u) = numpy.cos(numpy.radians((x, y, z))), numpy.sin(numpy.radians((x, y, z)))
    return (numpy.array([[c, -u, 0], [u, c, 0], [0, 0, 1]]) @ numpy.array([[b, 0, t], [0, 1, 0], [-t, 0, b]]) @
            numpy.array([[1, 0, 0], [0, a, -s], [0, s, a]]))


def middles(points, triangles):
    """The centres of the triangles' circles on the sphere."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    centre = numpy.cross(b - a, c - a)
    return centre / numpy.linalg.norm(centre, axis=1)[:, None]


def degrees_of(points):
    """Longitudes in -180..180 and latitudes."""
    return numpy.degrees(numpy.arctan2(points[:, 1], points[:, 0])), numpy.degrees(numpy.arcsin(numpy.clip(points[:, 2], -1, 1)))


def dual(points, triangles):
    """For each point the triangles around it, in order, as a table with -1 behind, and their number."""
    behind = [{} for _ in points]  # the triangle after another one, around a point
    for t, corners in enumerate(triangles):
        for i in range(3):
            behind[corners[i]][corners[(i + 1) % 3]] = (t, corners[(i + 2) % 3])
    table, counts = numpy.full((len(points), 6), -1), numpy.zeros(len(points), int)
    for p, steps in enumerate(behind):
        at = next(iter(steps))
        for _ in range(len(steps)):
            table[p, counts[p]], at = steps[at]
            counts[p] += 1
    return table, counts


def mpas(points, triangles, wet=None):
    """dimensions and variables, as netcdf_reading.write needs them, of MPAS' mesh whose cells are around the points. wet: cells that are there."""
    table, counts = dual(points, triangles)
    corners = middles(points, triangles)
    keep = numpy.ones(len(points), bool) if wet is None else wet
    used = keep[triangles].any(axis=1)  # corners of a cell that is there
    cell, vertex = numpy.cumsum(keep) * keep, numpy.cumsum(used) * used  # numbers from 1; 0: none
    table = numpy.where(table >= 0, vertex[table], 0)[keep]
    lon, lat = (numpy.radians(one) for one in degrees_of(points[keep]))
    lon_vertex, lat_vertex = (numpy.radians(one) for one in degrees_of(corners[used]))
    turn = 2 * numpy.pi
    return dict(nCells=int(keep.sum()), nVertices=int(used.sum()), maxEdges=6, vertexDegree=3), dict(
        latCell=("nCells", lat, {}), lonCell=("nCells", lon % turn, {}), latVertex=("nVertices", lat_vertex, {}),
        lonVertex=("nVertices", lon_vertex % turn, {}), verticesOnCell=("nCells maxEdges", table.astype("i4"), {}),
        cellsOnVertex=("nVertices vertexDegree", cell[triangles[used]].astype("i4"), {}), nEdgesOnCell=("nCells", counts[keep].astype("i4"), {}))


def icon(points, triangles):
    """dimensions and variables of ICON's triangles, as CDO writes them."""
    lon, lat = (numpy.radians(one) for one in degrees_of(points))
    at_lon, at_lat = (numpy.radians(one) for one in degrees_of(middles(points, triangles)))
    return dict(ncells=len(triangles), vertices=3), dict(
        clon=("ncells", at_lon, {"standard_name": "longitude", "long_name": "center longitude", "units": "radian", "bounds": "clon_bnds"}),
        clon_bnds=("ncells vertices", lon[triangles], {}),
        clat=("ncells", at_lat, {"standard_name": "latitude", "long_name": "center latitude", "units": "radian", "bounds": "clat_bnds"}),
        clat_bnds=("ncells vertices", lat[triangles], {}))
