#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Datasets with meshes in layers on a plane: places in metres from degrees, across the date line, from projected lengths and of MPAS off the sphere;
heights, values, axes and pictures; meshes that go round the Earth, cut at a meridian."""
import os
import sys
import warnings

from checking import check, done, refuse
from datasets import Dataset

import numpy
from stratus_volume import show
from stratus_volume._draw import drawn_of

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
from geodesic import degrees_of, icosphere, mpas, rotation

DEGREE = 6371000.0 * numpy.pi / 180
borders = numpy.array([-3000.0, -1000.0, 0.0])
across, along = numpy.meshgrid(numpy.linspace(170.0, 190.0, 11), numpy.linspace(-6.0, 14.0, 9))
east, north = across.reshape(-1), along.reshape(-1)
corner = (numpy.arange(8)[:, None] * 11 + numpy.arange(10)).reshape(-1)
triangles = numpy.concatenate([numpy.stack([corner, corner + 12, corner + 1], 1), numpy.stack([corner, corner + 11, corner + 12], 1)])  # clockwise ones, too
attrs = {"cf_role": "mesh_topology", "topology_dimension": numpy.int32(2), "node_coordinates": "lon lat", "face_node_connectivity": "faces"}
q = numpy.arange(2.0 * len(triangles)).reshape(2, -1)
parts = dict(mesh=("", numpy.int32(0), attrs), lon=("node", (east + 180) % 360 - 180, {"units": "degrees_east", "standard_name": "longitude"}),
             lat=("node", north, {"units": "degrees_north", "standard_name": "latitude"}), faces=("face corner", triangles, {"start_index": numpy.int32(0)}),
             layer=("layer", [-2000.0, -500.0], {"units": "m", "positive": "up", "bounds": "ends"}),
             ends=("layer two", numpy.stack([borders[:-1], borders[1:]], 1), {}), q=("layer face", q, {"units": "K"}),
             t=("layer node", numpy.arange(2.0 * len(east)).reshape(2, -1), {}))


def drawn(data, name="q", **more):
    return drawn_of(data, scalars=name, device="host", **more)


def volume_of(mesh):
    corners = mesh.points[mesh.cells]
    sizes = numpy.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    check((sizes > 0).all(), "all tetrahedra have one orientation")
    return sizes.sum()


# Degrees across the date line
own = drawn(Dataset(**parts), exaggerate=1)
wide, high = 20 * DEGREE * numpy.cos(numpy.radians(4.0)), 20 * DEGREE
places = own.points.reshape(3, -1, 3)
check(own.points.shape == (3 * len(east), 3) and own.exaggeration == 1, f"points {own.points.shape}")
check(abs(places[..., 0] - places[0, 0, 0] - (east - 170) * DEGREE * numpy.cos(numpy.radians(4.0))).max() < 1e-3, "longitudes as metres at the middle latitude")
check(abs(places[..., 1] - north * DEGREE).max() < 1e-3 and abs(places[..., 2] - borders[:, None]).max() < 1e-9, "latitudes as metres, heights")
check(abs(volume_of(own) / (wide * high * 3000) - 1) < 1e-12, "the layers are filled once")
check((own.values.reshape(2, -1, 3) == q[..., None]).all() and own.of_cells and not drawn(Dataset(**parts), "t").of_cells, "values of faces and nodes")
check([each.kind for each in own.axes] == ["longitude", "latitude", "number"] and abs(own.axes[0].scale * wide - 20) < 1e-9, f"axes {own.axes}")
check(abs(own.points[0, 0] / wide * 20 - 170) < 1e-9 or abs(own.points[0, 0] / wide * 20 + 190) < 1e-9, "longitudes are the file's, up to whole turns")

# Heights
high_one = drawn(Dataset(**parts))
check(abs(high_one.exaggeration * 3000 / high - 0.2) < 0.05 and high_one.bounds[5] == 0, f"heights are a fifth of the width: x {high_one.exaggeration}")
check(abs(high_one.bounds[4] + 3000 * high_one.exaggeration) < 1e-6 and abs(high_one.axes[2].scale * high_one.exaggeration - 1) < 1e-12, "the axis has true heights")
turned = drawn(Dataset(**parts), matrix=numpy.diag([2.0, 1, 1, 1]))
check(turned.exaggeration == 1 and turned.axes is None and abs(turned.bounds[1] - turned.bounds[0] - 2 * wide) < 1e-3, "a matrix of the caller")

# Lengths: UGRID on a map projection, FVCOM, MPAS that is not on a sphere
length = {"units": "km", "standard_name": "projection_x_coordinate"}
flat = drawn(Dataset(**dict(parts, lon=("node", east, length), lat=("node", north, dict(length, standard_name="projection_y_coordinate")))), exaggerate=1)
check(abs(flat.points[:len(east), :2] - 1000 * numpy.stack([east, north], 1)).max() < 1e-6 and flat.axes[0].units == "m", "kilometres are metres")
fvcom = dict(nv=("three nele", triangles.T + 1, {}), x=("node", east, {"units": "meters"}), y=("node", north, {"units": "meters"}),
             siglay=("siglay node", numpy.tile([[-0.25], [-0.75]], (1, len(east))), {"standard_name": "ocean_sigma_coordinate"}),
             h=("node", numpy.full(len(east), 8.0), {"units": "m"}), zeta=("node", numpy.zeros(len(east)), {"units": "m"}),
             temp=("siglay node", q[:, :len(east)], {}))
check(abs(volume_of(drawn(Dataset(**fvcom), "temp", exaggerate=1)) - 20 * 20 * 8) < 1e-9, "FVCOM by x and y")
sphere, faces = icosphere(2)
_, mesh = mpas(sphere, faces)
near = dict(mesh, cellsOnVertex=(*mesh["cellsOnVertex"][:2], {"on_a_sphere": "NO"}), verticesOnCell=(*mesh["verticesOnCell"][:2], {"on_a_sphere": "NO"}),
            xCell=("nCells", sphere[:, 0] * 1000, {}), yCell=("nCells", sphere[:, 1] * 1000, {}))
upper = sphere[faces][..., 2].min(axis=1) > 0
table = numpy.where(upper[:, None], numpy.asarray(near["cellsOnVertex"][1]), 0)
zgrid = dict(zgrid=("nCells levels", numpy.tile([[0.0, 100]], (len(sphere), 1)), {"units": "m"}), q=("nCells layers", sphere[:, :1], {}))
hill = drawn(Dataset(**dict(near, cellsOnVertex=(near["cellsOnVertex"][0], table, {"on_a_sphere": "NO"})), **zgrid), exaggerate=1)
check(0 < volume_of(hill) < numpy.pi * 1e6 * 100, "MPAS by xCell and yCell")
refuse(ValueError, "not on a sphere", drawn, Dataset(**dict(near, **zgrid)), globe=True)

# Round the Earth: faces are once over each place, and values where edges are cut are between the values at their ends
for turned in (None, rotation(11, 23, 37)):  # with nodes at the poles, and with poles in faces
    sphere, faces = icosphere(2, turned)
    _, mesh = mpas(sphere, faces)
    count = len(sphere)
    at = degrees_of(sphere)[1]
    levels = dict(zgrid=("nCells levels", numpy.tile([[0.0, 50, 100]], (count, 1)), {"units": "m"}), t=("nCells levels", at[:, None] + numpy.zeros(3), {}),
                  part=("nCells levels", numpy.arange(3 * count).reshape(count, 3) % 9, {}), q=("nVertices layers", numpy.arange(2.0 * len(faces)).reshape(-1, 2), {}))
    round_ = drawn(Dataset(**mesh, **levels), "t", exaggerate=1)
    middle = numpy.cos(numpy.radians(0.5 * (at.min() + at.max())))
    check(abs(volume_of(round_) / (360 * DEGREE * middle * 180 * DEGREE * 100) - 1) < 1e-9, "the map of the Earth is filled once")
    north_of = round_.points[:, 1] / DEGREE
    pole = abs(north_of) > 90 - 1e-6
    check(abs(round_.points[:, 0].min()) < 1e-3 and abs(round_.points[:, 0].max() / DEGREE / middle - 360) < 1e-6, "longitudes of MPAS are 0 to 360")
    wide = numpy.ptp(round_.points[round_.cells][(abs(north_of) < 60)[round_.cells].all(axis=1)][..., 0], axis=1) / DEGREE / middle
    check(wide.max() < 50, f"no tetrahedron reaches across the map: {wide.max()} degrees")
    check(abs(round_.values - north_of)[~pole].max() < 1e-9 and abs(round_.values - north_of)[pole].max() < 20, "values at nodes, at cuts and at poles")
    small = drawn(Dataset(**mesh, **levels), "part")
    check(small.values.min() == 0 and small.values.max() == 8, "values of integers")
    cells = drawn(Dataset(**mesh, **levels))
    check(cells.of_cells and set(cells.values.tolist()) == set(numpy.arange(2.0 * len(faces))), "each face and layer has its value")
    check("faces cut at longitude 0" in round_.description, round_.description)

# Pictures: a block in the north-east quarter is right of and above the middle from above
block = numpy.where((east[triangles].mean(axis=1) > 181) & (north[triangles].mean(axis=1) > 5), 1.0, 0.0)
data = Dataset(**dict(parts, q=("layer face", numpy.tile(block, (2, 1)), {"units": "K"})))
with warnings.catch_warnings():
    warnings.simplefilter("error")
    picture = show(data, [(0.4, 0), (0.5, 1)], (1, 0, 0), (160, 160), dict(azimuth=0, elevation=89), scalars="q", device="host")
    axes = show(data, size=(320, 240), scalars="q", device="host", show_axes=True, color_bar=True, coast=True)
red = (picture[30:, :, 0] > 100) & (picture[30:, :, 0] > 3.0 * picture[30:, :, 1])
rows, columns = numpy.nonzero(red)
check(red.sum() > 300 and rows.mean() + 30 < 76 and columns.mean() > 84, f"the block is at {rows.mean() + 30}, {columns.mean()}")
check("heights x" in picture.caption and (axes[..., :3].max(axis=2) > 180).sum() > 200, "the caption, and axes with text")

# Places that are none, and options that a mesh replaces
refuse(ValueError, "spacing is (1, 1, 1), but a mesh of a Dataset has its own places", drawn, Dataset(**parts), spacing=(1, 1, 1))
refuse(ValueError, "nor x and y in a unit of length", drawn, Dataset(**dict(parts, lon=("node", east, {"units": "K"}), lat=("node", north, {"units": "K"}))))
unknown = east.copy()
unknown[3] = numpy.nan
refuse(ValueError, "have no longitude or latitude at number 3", drawn, Dataset(**dict(parts, lon=("node", unknown, parts["lon"][2]))))
refuse(ValueError, "node 3 is at ", drawn, Dataset(**dict(parts, lat=("node", numpy.where(numpy.arange(len(east)) == 3, 91.0, north), parts["lat"][2]))))
refuse(ValueError, "exaggerate is 0", drawn, Dataset(**parts), exaggerate=0)

# A variable of the same Dataset that is not on the mesh is drawn as it was
beside = dict(parts, z=("z", numpy.arange(3.0), {}), y=("y", numpy.arange(4.0), {}), x=("x", numpy.arange(5.0), {}), box=("z y x", numpy.ones((3, 4, 5)), {}))
check(type(drawn(Dataset(**beside), "box")).__name__ == "Volume", "a variable of three other dimensions")
done()
