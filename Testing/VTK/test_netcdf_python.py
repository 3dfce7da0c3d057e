# SPDX-License-Identifier: BSD-3-Clause
"""Meshes in layers of files, as the reader and as the Python package place them on a sphere and on a plane: the same points, cells and values, also
where faces that go round the Earth are cut at a meridian, and around poles."""
import os
import sys

import numpy
from vtk.util.numpy_support import vtk_to_numpy

from netcdf_reading import Read, check, finish, folder, write

here = os.path.dirname(os.path.abspath(__file__))
sys.path[1:1] = [os.path.join(here, "..", "Python"), os.path.join(here, "..", "..", "Examples", "Python")]
import datasets
import model_files
from geodesic import degrees_of, dual, icosphere, middles, mpas, rotation

from stratus_volume._draw import drawn_of

VOLUME_CELLS = {13: 3, 12: 4, 15: 5, 16: 6}  # VTK's prisms, and their corners below; more corners make a polyhedron


def prisms_of(grid):
    """The number of tetrahedra of each cell that is not hidden, and the numbers of these cells."""
    ghosts = grid.GetCellData().GetArray("vtkGhostType")
    shown = numpy.arange(grid.GetNumberOfCells()) if not ghosts else numpy.nonzero(vtk_to_numpy(ghosts) == 0)[0]
    corners = numpy.array([VOLUME_CELLS.get(grid.GetCellType(int(cell)), grid.GetCell(int(cell)).GetNumberOfPoints() // 2) for cell in shown])
    return shown, 3 * (corners - 2)


def compare(path, name, factor=0.0, on_sphere=True):
    def prepare(reader):
        if on_sphere:
            reader.SetCoordinatesToSphere()
        reader.SetExaggerateHeights(not on_sphere)
        reader.SetHeightFactor(factor)

    got = Read(path, name, cls="vtkStratusUgridReader", prepare=prepare)
    check(not got.error, f"{path}: {got.error}")
    if got.error:
        return
    own = drawn_of(datasets.of_file(path), scalars=name, globe=on_sphere, exaggerate=factor or None, device="host")
    points = vtk_to_numpy(got.data.GetPoints().GetData())
    placed = own.points if own.matrix is None else own.points * own.matrix.reshape(4, 4).diagonal()[:3]
    check(own.points.shape == points.shape and abs(placed - points).max() < 1e-3, f"{path}: points {own.points.shape}, the reader's {points.shape}")
    check(abs(own.exaggeration / got.reader.GetUsedHeightFactor() - 1) < 1e-12, f"{path}: heights x {own.exaggeration}")
    shown, pieces = prisms_of(got.data)
    check(len(own.cells) == pieces.sum(), f"{path}: {len(own.cells)} tetrahedra, of the reader's cells {pieces.sum()}")
    of_points = got.data.GetPointData().GetArray(name) is not None
    wanted = vtk_to_numpy(got.data.GetPointData().GetArray(name) if of_points else got.data.GetCellData().GetArray(name))
    wanted = wanted if of_points else numpy.repeat(wanted[shown], pieces)
    check(own.of_cells != of_points and own.values.shape == wanted.shape and numpy.allclose(own.values, wanted, rtol=1e-6, atol=0, equal_nan=True),
          f"{path}: values of {name}")
    if not of_points:  # each tetrahedron is in the cell whose value it has
        cells = numpy.repeat(shown, pieces)
        for n in range(0, len(cells), 97):
            ids = got.data.GetCell(int(cells[n])).GetPointIds()
            check(set(own.cells[n]) <= {ids.GetId(i) for i in range(ids.GetNumberOfIds())}, f"{path}: tetrahedron {n} is in cell {cells[n]}")


def compare_both(path, name, factor=0.0, cut=True):
    """Compares a mesh on a sphere and on a plane. cut: it goes round the Earth, and is cut on the plane."""
    compare(path, name, factor)
    compare(path, name, factor, on_sphere=False)
    own = {globe: drawn_of(datasets.of_file(path), scalars=name, globe=globe, exaggerate=1, device="host") for globe in (True, False)}
    check(("faces cut at longitude" in own[False].description) == cut, f"{path}: {own[False].description}")
    check((len(own[False].points) > len(own[True].points)) == cut, f"{path}: nodes of cuts and poles")


for make, name in ((model_files.mpas_atmosphere, "qc"), (model_files.icon_atmosphere, "temp")):
    path = make(folder)
    compare_both(path, name)
    compare_both(path, name, 3.5)

points, triangles = icosphere(3, rotation(11, 23, 37))
borders = numpy.array([0.0, 300, 1000, 2500, 6000])
layers, thickness = 4, numpy.diff(borders)

# MPAS' ocean with coasts and a bottom
wet = points @ numpy.array([0.6, 0.0, 0.8]) < 0.5
count = int(wet.sum())
dimensions, mesh = mpas(points, triangles, wet)
deep = numpy.where(numpy.arange(layers)[None, :] < 1 + (numpy.arange(count) % layers)[:, None], thickness[::-1], -1e34)
compare_both(write("python ocean", dict(dimensions, nVertLevels=layers), **mesh, layerThickness=("nCells nVertLevels", deep, {"units": "m"}),
    maxLevelCell=("nCells", (1 + numpy.arange(count) % layers).astype("i4"), {}),
    bottomDepth=("nCells", numpy.where(deep > 0, deep, 0).sum(axis=1), {"units": "m"}),
    salinity=("nCells nVertLevels", 30 + numpy.arange(1.0 * count * layers).reshape(count, layers) / 1000, {})), "salinity", 100)

# cells of five and six corners on levels with bounds
table, counts = dual(points, triangles)
corner = table[numpy.arange(len(points))[:, None], numpy.minimum(numpy.arange(6), counts[:, None] - 1)]
(lon, lat), (at_lon, at_lat) = degrees_of(middles(points, triangles)), degrees_of(points)
compare_both(write("python hexagons", {"cell": len(points), "nv": 6, "lev": 3, "bnds": 2},
    lon=("cell", at_lon, {"units": "degrees_east", "bounds": "lon_bounds"}), lon_bounds=("cell nv", lon[corner] % 360, {}),
    lat=("cell", at_lat, {"units": "degrees_north", "bounds": "lat_bounds"}), lat_bounds=("cell nv", lat[corner], {}),
    lev=("lev", numpy.array([10.0, 300, 2000]), {"units": "m", "positive": "down", "bounds": "lev_bnds"}),
    lev_bnds=("lev bnds", numpy.array([[0.0, 20], [20, 1000], [1000, 5000]]), {}),
    t=("lev cell", numpy.arange(3.0 * len(points)).reshape(3, -1), {"units": "K", "coordinates": "lat lon"})), "t", 50)

# UGRID of triangles and quadrangles
faces = numpy.concatenate([triangles, numpy.full((len(triangles), 1), -1)], axis=1)
faces[::2] = faces[::2, [2, 1, 0, 3]]  # in any orientation
for name, place in (("node", len(points)), ("face", len(triangles))):
    values = numpy.arange(2.0 * place, dtype="f4").reshape(2, -1)
    compare_both(write("python ugrid " + name, {"node": len(points), "face": len(triangles), "corner": 4, "layer": 2},
        mesh=("", numpy.int32(0), {"cf_role": "mesh_topology", "topology_dimension": numpy.int32(2), "node_coordinates": "lon lat",
                                   "face_node_connectivity": "faces"}),
        lon=("node", at_lon, {"units": "degrees_east", "standard_name": "longitude"}),
        lat=("node", at_lat, {"units": "degrees_north", "standard_name": "latitude"}),
        faces=("face corner", faces.astype("i4"), {"start_index": numpy.int32(0), "fill": numpy.int32(-1)}),
        layer=("layer", numpy.array([-3000.0, -1000.0]), {"units": "m", "positive": "up", "axis": "Z"}),
        q=(f"layer {name}", values, {"mesh": "mesh", "location": name})), "q", 100)

# Layers between a bottom and a free surface: FVCOM's sigma, sigma in UGRID with a dry face, levels that are cut off, and one layer
wet = points[:, 2] > 0.3
near = wet[triangles].all(axis=1)
number = numpy.cumsum(wet) - 1
nodes, faces = int(wet.sum()), number[triangles[near]]
east, north = at_lon[wet], at_lat[wet]
depth, surface = 50 + 40 * numpy.sin(numpy.radians(3 * east)), 2 * numpy.cos(numpy.radians(2 * east))
sigma = -numpy.linspace(0, 1, 5)[:, None] ** (1 + 0.5 * (north[None] > 40))
values = numpy.arange(4.0 * nodes, dtype="f4").reshape(4, nodes)
lonlat = dict(lon=("node", east, {"units": "degrees_east", "standard_name": "longitude"}), lat=("node", north, {"units": "degrees_north", "standard_name": "latitude"}))
zeta, bed = ("node", surface, {"units": "m", "standard_name": "sea_surface_height_above_geoid"}), ("node", depth, {"units": "m", "standard_name": "sea_floor_depth"})
compare_both(write("python fvcom", {"node": nodes, "nele": len(faces), "three": 3, "siglev": 5, "siglay": 4}, **lonlat,
    nv=("three nele", (faces + 1).T.astype("i4"), {}), siglev=("siglev node", sigma, {"standard_name": "ocean_sigma_coordinate"}),
    siglay=("siglay node", 0.5 * (sigma[1:] + sigma[:-1]), {"standard_name": "ocean_sigma_coordinate"}), zeta=zeta, h=bed,
    wet_cells=("nele", (numpy.arange(len(faces)) % 5 > 0).astype("i4"), {}), temp=("siglay node", values, {})), "temp", 1000)
mesh = dict(mesh=("", numpy.int32(0), {"cf_role": "mesh_topology", "topology_dimension": numpy.int32(2), "node_coordinates": "lon lat",
    "face_node_connectivity": "faces"}), faces=("face corner", faces.astype("i4"), {"start_index": numpy.int32(0)}), **lonlat)
of_faces = surface[faces].mean(axis=1)
of_faces[7] = -999
terms = {"standard_name": "ocean_sigma_coordinate", "formula_terms": "sigma: lev eta: eta depth: deep", "positive": "up"}
sizes = {"node": nodes, "face": len(faces), "corner": 3, "lev": 4}
compare_both(write("python sigma", sizes, **mesh, lev=("lev", numpy.array([-0.875, -0.625, -0.375, -0.125]), terms), deep=bed,
    eta=("face", of_faces, {"units": "m", "fill": -999.0}), q=("lev node", values, {})), "q", 1000)
compare_both(write("python levels", sizes, **mesh, lev=("lev", numpy.array([5.0, 20, 40, 80]), {"units": "m", "positive": "down", "axis": "Z"}),
    elev=zeta, depth=bed, q=("lev node", values, {})), "q", 1000)
compare_both(write("python one layer", {key: sizes[key] for key in ("node", "face", "corner")}, **mesh, elev=zeta, depth=bed, q=("node", values[0], {})), "q", 1000)

# A region on the plane
near = (points @ numpy.array([0.36, 0.48, 0.8]) > 0.8)[triangles].all(axis=1)
wet = numpy.zeros(len(points), bool)
wet[triangles[near]] = True
number = numpy.cumsum(wet) - 1
nodes, faces = int(wet.sum()), number[triangles[near]]
sizes = {"node": nodes, "face": len(faces), "corner": 3, "lev": 4}
lonlat = dict(lon=("node", at_lon[wet], {"units": "degrees_east", "standard_name": "longitude"}),
    lat=("node", at_lat[wet], {"units": "degrees_north", "standard_name": "latitude"}))
mesh = dict(mesh=mesh["mesh"], faces=("face corner", faces.astype("i4"), {"start_index": numpy.int32(0)}), **lonlat)
level = ("lev", numpy.array([5.0, 20, 40, 80]), {"units": "m", "positive": "down", "axis": "Z"})
for place, count in (("node", nodes), ("face", len(faces))):
    for factor in (0.0, 1000.0):
        compare(write(f"python plane {place} {factor}", sizes, **mesh, lev=level, q=(f"lev {place}", numpy.arange(4.0 * count).reshape(4, count), {})), "q",
            factor, on_sphere=False)
finish()
