#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Datasets with meshes in layers on a globe: UGRID, MPAS and ICON. Tetrahedra fill the shell once, points and values are where NumPy has them,
pictures of one field on all meshes are alike, and wrong data are refused."""
import math
import os
import sys
import warnings

from checking import check, done, refuse
from datasets import Dataset

import numpy
from stratus_volume import show
from stratus_volume._draw import drawn_of

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
from geodesic import degrees_of, dual, icon, icosphere, middles, mpas, rotation

RADIUS = 6371000.0
borders = numpy.array([0.0, 300, 1000, 2500, 6000])
layers, thickness = len(borders) - 1, numpy.diff(borders)
host = dict(device="host", globe=True)


def drawn(data, name="q", factor=10, **more):
    return drawn_of(data, scalars=name, exaggerate=factor, **host, **more)


def filled(mesh):
    """The volume of all tetrahedra, which have one orientation."""
    corners = mesh.points[mesh.cells]
    sizes = numpy.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    check((sizes > 0).all(), "all tetrahedra have one orientation")
    return sizes.sum()


def solid(points, triangles, low, high):
    return abs(numpy.linalg.det(points[triangles])).sum() * ((RADIUS + high) ** 3 - (RADIUS + low) ** 3) / 6


def alone(mesh):
    """The number of faces of tetrahedra that no other has."""
    faces = numpy.sort(numpy.concatenate([mesh.cells[:, numpy.delete(numpy.arange(4), n)] for n in range(4)]), axis=1)
    counts = numpy.unique(faces, axis=0, return_counts=True)[1]
    check(counts.max() == 2, "a face has at most two tetrahedra")
    return (counts == 1).sum()


def atmosphere(name, points, triangles):
    """MPAS: values of cells are on nodes, borders between layers have means by distance."""
    _, mesh = mpas(points, triangles)
    theta = (280 + degrees_of(points)[1][:, None] + 10 * numpy.arange(layers)).astype("f4")
    parts = dict(mesh, zgrid=("nCells nVertLevelsP1", numpy.tile(borders, (len(points), 1)), {"units": "m"}), q=("nCells nVertLevels", theta, {"units": "K"}),
                 of_time=("Time nCells nVertLevels", theta[None], {}), of_two=("Time nCells nVertLevels", numpy.stack([theta, theta]), {}),
                 w=("nCells nVertLevelsP1", numpy.tile(borders, (len(points), 1)), {}), flat=("nCells", theta[:, 0], {}),
                 vorticity=("nVertices nVertLevels", numpy.arange(len(triangles) * layers, dtype="f4").reshape(-1, layers), {}))
    data = Dataset(**parts)
    own = drawn(data)
    check(own.points.shape == ((layers + 1) * len(points), 3) and len(own.cells) == 3 * layers * len(triangles), f"{name}: {own.points.shape}")
    wanted = points * (RADIUS + 10 * borders)[:, None, None]
    check(abs(own.points.reshape(layers + 1, -1, 3) - wanted).max() < 1e-2, f"{name}: middles of cells")
    check(abs(filled(own) / solid(points, triangles, 0, 60000) - 1) < 1e-9 and alone(own) == 2 * len(triangles), f"{name}: the shell is filled")
    weight = (thickness[1:] / (thickness[1:] + thickness[:-1]))[:, None]
    got = own.values.reshape(layers + 1, -1)
    check((got[0] == theta[:, 0]).all() and (got[-1] == theta[:, -1]).all() and got.dtype == theta.dtype, f"{name}: values of the outermost layers")
    check(abs(got[1:-1] - weight * theta.T[:-1] - (1 - weight) * theta.T[1:]).max() < 1e-4, f"{name}: values between layers by distance")
    for table in "cellsOnVertex", "verticesOnCell":  # either serves
        less = drawn(Dataset(**{key: value for key, value in parts.items() if key not in (table, "vorticity")}))
        check((less.values == own.values).all() and abs(filled(less) / filled(own) - 1) < 1e-12, f"{name} without {table}")
    check((drawn(data, "of_time").values == own.values).all(), f"{name}: a dimension of one value is left out")
    refuse(ValueError, "as by .isel(Time=0)", drawn, data, "of_two")
    check((drawn(data, "w").values.reshape(layers + 1, -1) == borders[:, None]).all(), f"{name}: values at borders")
    check((drawn(data, "flat").values.reshape(layers + 1, -1) == theta[:, 0]).all(), f"{name}: values without layers are in each")
    faces = drawn(data, "vorticity")
    check(faces.of_cells and faces.values[0] == parts["vorticity"][1][0, 0] and (numpy.bincount(faces.values.astype(int)) == 3).all(), "values of faces")
    check(abs(drawn(data, factor=None).exaggeration - 0.1 * RADIUS / 6000) < 1e-9, "heights reach over a tenth of the radius")
    masked = Dataset(**dict(parts, q=("nCells nVertLevels", numpy.where(theta < 250, numpy.nan, theta), {})))
    check(numpy.isnan(drawn(masked).values).any(), "missing values stay")


def ocean(name, points, triangles):
    """MPAS: thicknesses over a bottom in a part of the Earth, whose corners at its border are absent."""
    wet = points @ numpy.array([0.6, 0.0, 0.8]) < 0.5
    count = int(wet.sum())
    _, mesh = mpas(points, triangles, wet)
    lowest = 2 + numpy.arange(count) % (layers - 1)
    deep = numpy.where(numpy.arange(layers)[None, :] < lowest[:, None], thickness[::-1], -1e34)
    bottom = numpy.where(deep > 0, deep, 0).sum(axis=1)
    salt = 30 + numpy.arange(1.0 * count * layers).reshape(count, layers) / 1000
    own = drawn(Dataset(**mesh, layerThickness=("nCells nVertLevels", deep, {"units": "m"}), bottomDepth=("nCells", bottom, {"units": "m"}),
                        maxLevelCell=("nCells", lowest, {}), q=("nCells nVertLevels", salt, {})), factor=100)
    heights = (numpy.linalg.norm(own.points.reshape(layers + 1, -1, 3), axis=2) - RADIUS) / 100
    check(abs(heights[0] + bottom).max() < 1e-3 and abs(heights[-1]).max() < 1e-3, f"{name}: the bottom and the surface")
    check(abs(numpy.diff(heights, axis=0) - numpy.where(deep > 0, deep, 0)[:, ::-1].T).max() < 1e-3, f"{name}: thicknesses")
    top = (own.cells.max(axis=1) >= layers * count).sum()
    check(top == 3 * wet[triangles].all(axis=1).sum(), f"{name}: {top} tetrahedra in the uppermost layer")
    check((own.values.reshape(layers + 1, -1)[-1] == salt[:, 0]).all(), f"{name}: values at the surface")


def cells(name, points, triangles):
    """ICON, and hexagons with bounds: values of cells, corners that cells share."""
    _, mesh = icon(points, triangles)
    n = len(triangles)
    q = numpy.arange(1.0 * layers * n).reshape(layers, n)
    full = 0.5 * (borders[1:] + borders[:-1])
    heights = dict(z_ifc=("height_2 ncells", numpy.tile(borders[::-1, None], (1, n)), {"units": "m"}))
    numbers = dict(height=("height", numpy.arange(1.0, layers + 1), {"standard_name": "height", "long_name": "generalized_height", "axis": "Z"}))
    own = drawn(Dataset(**mesh, **heights, **numbers, q=("height ncells", q, {})))
    check(own.points.shape == ((layers + 1) * len(points), 3), f"{name}: each corner once, {own.points.shape}")
    check(abs(filled(own) / solid(points, triangles, 0, 60000) - 1) < 1e-9 and alone(own) == 2 * n, f"{name}: the shell is filled")
    at = own.points[own.cells].mean(axis=1).reshape(layers, n, 3, 3).mean(axis=2)
    check(abs(at / numpy.linalg.norm(at, axis=2)[..., None] - middles(points, triangles)).max() < 0.1, f"{name}: cells are where they were")
    check((own.values.reshape(layers, n, 3) == q[::-1, :, None]).all(), f"{name}: values from the bottom up")
    moved = {key: (dims, values, {k: v for k, v in attrs.items() if k != "bounds"}, {k: v for k, v in attrs.items() if k == "bounds"})
             for key, (dims, values, attrs) in mesh.items()}
    check((drawn(Dataset(**moved, **heights, q=("height ncells", q, {}))).points == own.points).all(), "bounds that xarray moved to the encoding")
    middle = dict(z_mc=("height ncells", numpy.tile(full[::-1, None], (1, n)), {"units": "m"}))
    r = numpy.linalg.norm(drawn(Dataset(**mesh, **middle, **numbers, q=("height ncells", q, {}))).points.reshape(layers + 1, -1, 3)[:, 0], axis=1) - RADIUS
    check(abs(r[1:-1] - 5 * (full[1:] + full[:-1])).max() < 1e-3, f"{name}: borders between the middles of layers")
    refuse(ValueError, "the layers of 'q' have no heights", drawn, Dataset(**mesh, **numbers, q=("height ncells", q, {})))
    whole = drawn(Dataset(**mesh, **heights, q=("height ncells", numpy.ma.masked_less(q.astype("i4"), 7), {})))
    check(whole.hidden.sum() == 21 and whole.values.dtype == "i4", f"{name}: masked cells are hidden")

    table, counts = dual(points, triangles)
    corner = table[numpy.arange(len(points))[:, None], numpy.minimum(numpy.arange(6), counts[:, None] - 1)]
    (lon, lat), (at_lon, at_lat) = degrees_of(middles(points, triangles)), degrees_of(points)
    hexagons = dict(lon=("cell", at_lon, {"units": "degrees_east", "bounds": "lon_bounds"}), lon_bounds=("cell nv", lon[corner] % 360, {}),
                    lat=("cell", at_lat, {"units": "degrees_north", "bounds": "lat_bounds"}), lat_bounds=("cell nv", lat[corner], {}),
                    q=("lev cell", numpy.arange(3.0 * len(points)).reshape(3, -1), {}))
    sides = 3 * (counts - 2).sum()
    for what, levels, wanted in (
        ("middles", dict(lev=("lev", [1000.0, 3000, 4000], {"units": "m", "positive": "up"})), [0, 2000, 3500, 4500]),
        ("depths", dict(lev=("lev", [0.1, 0.3, 0.4], {"units": "km", "positive": "down"})), [-450, -350, -200, 0]),
        ("bounds", dict(lev=("lev", [1.0, 3, 4], {"units": "m", "bounds": "lev_bnds", "positive": "down"}),
                        lev_bnds=("lev bnds", [[0.0, 2], [2, 3.5], [3.5, 9]], {})), [-9, -3.5, -2, 0]),
        ("borders", dict(lev=("lev", [1.0, 3, 4], {"units": "m"}), edge=("edge", [1.0, 2, 5, 9], {"units": "m"})), [1, 2, 5, 9])):
        own = drawn(Dataset(**hexagons, **levels))
        r = (numpy.linalg.norm(own.points.reshape(4, -1, 3)[:, 5], axis=1) - RADIUS) / 10
        check(abs(r - wanted).max() < 1e-3, f"{name}, {what}: {r}")
        down = what in ("depths", "bounds")
        check(len(own.cells) == 3 * sides and own.values[0] == (2 * len(points) if down else 0), f"{name}, {what}: {len(own.cells)} of {3 * sides}")
    gap = dict(hexagons, lev=("lev", [1.0, 3, 4], {"units": "m", "bounds": "lev_bnds"}), lev_bnds=("lev bnds", [[0.0, 2], [2.5, 3.5], [3.5, 9]], {}))
    refuse(ValueError, "the bounds of 'lev' must meet", drawn, Dataset(**gap))


def topology(name, points, triangles):
    """UGRID: faces of different size, in any orientation, values of nodes and of faces."""
    lon, lat = degrees_of(points)
    faces = numpy.concatenate([triangles[:, ::-1], numpy.full((len(triangles), 1), -1)], axis=1) + 1
    attrs = {"cf_role": "mesh_topology", "topology_dimension": numpy.int32(2), "node_coordinates": "lat lon", "face_node_connectivity": "faces"}
    parts = dict(mesh=("", numpy.int32(0), attrs), lon=("node", lon, {"units": "degrees_east", "standard_name": "longitude"}),
                 lat=("node", lat, {"units": "degrees_north", "standard_name": "latitude"}),
                 faces=("face corner", numpy.where(faces > 0, faces, numpy.nan), {"start_index": numpy.int32(1)}),
                 layer=("layer", [-3000.0, -1000.0], {"units": "m", "positive": "up", "axis": "Z"}),
                 q=("layer face", numpy.arange(2.0 * len(triangles)).reshape(2, -1), {"mesh": "mesh", "location": "face"}),
                 t=("layer node", numpy.arange(2.0 * len(points)).reshape(2, -1), {"mesh": "mesh", "location": "node"}))
    own = drawn(Dataset(**parts), factor=100)
    check(abs(filled(own) / solid(points, triangles, -400000, 0) - 1) < 1e-9, f"{name}: the shell is filled")
    check((own.values.reshape(2, -1, 3) == parts["q"][1][..., None]).all(), f"{name}: values of faces")
    on_nodes = drawn(Dataset(**parts), "t").values.reshape(3, -1)
    check((on_nodes[[0, 2]] == parts["t"][1]).all() and (on_nodes[1] == parts["t"][1].mean(axis=0)).all(), f"{name}: values of nodes")
    turned = dict(parts, faces=("corner face", parts["faces"][1].T, {"start_index": numpy.int32(1)}))
    check((drawn(Dataset(**turned), factor=100).points == own.points).all(), f"{name}: corners first")
    refuse(ValueError, "no longitudes and latitudes of nodes in degrees", drawn,
           Dataset(**dict(parts, lon=("node", lon, {"units": "m", "standard_name": "projection_x_coordinate"}))))
    refuse(ValueError, "there is no variable 'faces'", drawn, Dataset(**{key: value for key, value in parts.items() if key != "faces"}))
    bad = parts["faces"][1].copy()
    bad[2, 1] = 1e6
    refuse(ValueError, "'faces': face 2 has the node 1000000, must be 1 to", drawn, Dataset(**dict(parts, faces=("face corner", bad, {"start_index": 1}))))
    refuse(ValueError, "one of them must be the mesh's, 'node' or 'face'", drawn, Dataset(**dict(parts, q=("layer edge", numpy.zeros((2, 5)), {}))))
    unknown = lon.copy()
    unknown[3] = numpy.nan
    refuse(ValueError, "have no longitude or latitude at number 3", drawn, Dataset(**dict(parts, lon=("node", unknown, parts["lon"][2]))))


def pictures(points, triangles):
    """A spot on MPAS' and on ICON's mesh: at the same place in the picture, and hidden behind the Earth."""
    place = numpy.array([math.cos(math.radians(20)) * math.cos(math.radians(40)), math.cos(math.radians(20)) * math.sin(math.radians(40)),
                         math.sin(math.radians(20))])
    found = []
    for mesh, at, dims in ((mpas(points, triangles)[1], points, "nCells"), (icon(points, triangles)[1], middles(points, triangles), "ncells")):
        spot = (at @ place > math.cos(math.radians(12))).astype("f4")
        borders_of = dict(zgrid=(f"levels {dims}", numpy.tile([[0.0], [5000], [10000]], (1, len(at))), {"units": "m"}))
        data = Dataset(**mesh, **borders_of, q=(f"layer {dims}", numpy.tile(spot, (2, 1)), {}))
        for azimuth, elevation, seen in ((40, 20, True), (220, -20, False)):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                picture = show(data, [(0, 0), (0.5, 0), (0.6, 1)], (1, 0, 0), (160, 160), dict(azimuth=azimuth + 90, elevation=elevation), scalars="q", **host)
            red = (picture[..., 0] > 80) & (picture[..., 0] > 3.0 * picture[..., 1])
            check(red.any() == seen, f"{dims}: the Earth hides what is behind it: {red.sum()} pixels")
            if seen:
                rows, columns = numpy.nonzero(red[20:])
                found.append((rows.mean() + 20, columns.mean(), red.sum()))
    check(max(abs(a - 79.5) for a in (*found[0][:2], *found[1][:2])) < 4 and 0.6 < found[0][2] / found[1][2] < 1.6, f"spots: {found}")


def refusals(points, triangles):
    _, mesh = mpas(points, triangles)
    zgrid = ("nCells nVertLevelsP1", numpy.tile(borders, (len(points), 1)), {"units": "m"})
    parts = dict(mesh, zgrid=zgrid, q=("nCells nVertLevels", numpy.zeros((len(points), layers), "f4"), {}))
    bad = mesh["cellsOnVertex"][1].copy()
    bad[3, 1] = 99
    refuse(ValueError, "'cellsOnVertex': face 3 has the node 99, must be 1 to 42", drawn,
           Dataset(**dict(parts, cellsOnVertex=("nVertices vertexDegree", bad, {}))))
    refuse(ValueError, "there is no variable 'lonCell'", drawn, Dataset(**{key: value for key, value in parts.items() if key != "lonCell"}))
    refuse(ValueError, "layers are upside down", drawn, Dataset(**dict(parts, zgrid=(zgrid[0], zgrid[1][:, [0, 2, 1, 3, 4]], {}))))
    refuse(ValueError, "no heights", drawn, Dataset(**{key: value for key, value in parts.items() if key != "zgrid"}))
    refuse(ValueError, "'q' has 3 values along 'nVertLevels', for 4 layers they must be 4, or 5", drawn,
           Dataset(**dict(parts, q=("nCells nVertLevels", numpy.zeros((len(points), 3)), {}))))
    data = Dataset(**parts)
    refuse(ValueError, "the Dataset has no variable 'p', it must be one of ['cellsOnVertex', 'q', 'verticesOnCell', 'zgrid']", drawn, data, "p")
    refuse(ValueError, "no variable None", show, data, globe=True)
    refuse(ValueError, "spacing is", show, data, scalars="q", globe=True, spacing=(1, 1, 1))
    refuse(ValueError, "exaggerate is -1", drawn, data, "q", -1)


for name, turn in (("poles at nodes", None), ("poles in faces", rotation(11, 23, 37))):
    points, triangles = icosphere(2, turn)
    for one in atmosphere, ocean, cells, topology:
        one(f"{one.__name__}, {name}", points, triangles)
pictures(*icosphere(3))
refusals(*icosphere(1))
done()
