# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of MPAS and ICON: heights and values as NumPy has them, areas and volumes of the whole Earth without gap or overlap, at poles and the
date line, too, on the plane and on the sphere, whether a pole is a node or within a face; and what is refused."""
import os
import sys

import numpy
from vtk.util.numpy_support import vtk_to_numpy

from netcdf_reading import Read, check, degree, finish, near, write

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
from geodesic import degrees_of, dual, icon, icosphere, middles, mpas, rotation

radius = 6371000.0
random = numpy.random.default_rng(3)
turns = {"poles at nodes": None, "poles in faces": rotation(11, 23, 37)}


def read(path, variable=None, factor=0.0, time=None):
    def prepare(reader):
        if factor:
            reader.SetCoordinatesToSphere()
            reader.SetHeightFactor(factor)

    return Read(path, variable, time, "vtkStratusUgridReader", prepare)


def values_of(got, name):
    data = got.data.GetPointData().GetArray(name) or got.data.GetCellData().GetArray(name)
    return vtk_to_numpy(data)


def faces_of(got, layers):
    """Points (levels, nodes, 3), and the corners of the faces of the lowest layer that are not hidden, counted in nodes, with their numbers."""
    points = vtk_to_numpy(got.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)
    ghosts = got.data.GetCellData().GetArray("vtkGhostType")
    faces, numbers = [], []
    for f in range(got.data.GetNumberOfCells() // layers):
        if not ghosts or not ghosts.GetValue(f):
            ids = got.data.GetCell(f).GetPointIds()
            below = [ids.GetId(i) for i in range(ids.GetNumberOfIds()) if ids.GetId(i) < points.shape[1]]
            if got.data.GetCellType(f) == 42:  # a polyhedron lists corners in its own order
                stream = got.data.GetCell(f).GetFace(0).GetPointIds()
                below = [stream.GetId(i) for i in range(stream.GetNumberOfIds())]
            faces.append(below)
            numbers.append(f)
    return points, faces, numbers


def check_plane(name, got, layers):
    """The faces are once over each place of the Earth."""
    points, faces, _ = faces_of(got, layers)
    middle = 0.5 * (points[0, :, 1].min() + points[0, :, 1].max()) / degree
    at = points[0, :, :2] / degree / [numpy.cos(numpy.radians(middle)), 1]
    area = 0.0
    places = numpy.stack([random.uniform(-180, 180, 300), numpy.degrees(numpy.arcsin(random.uniform(-1, 1, 300)))], axis=1)
    places[:20, 1], places[20:40, 1], places[40:60, 0] = random.uniform(84, 89.9, 20), random.uniform(-89.9, -84, 20), random.uniform(179, 181, 20)
    met = numpy.zeros(len(places), int)
    for face in faces:
        corners = at[face]
        a, b = corners, numpy.roll(corners, -1, axis=0)
        signed = 0.5 * (a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]).sum()
        check(abs(signed) > 0, f"{name}: a face of no area")
        area += abs(signed)
        for turn in (-360, 0, 360):
            p = places + [turn, 0]
            side = numpy.sign((b[:, 0] - a[:, 0]) * (p[:, None, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (p[:, None, 0] - a[:, 0]))
            met += (side == numpy.sign(signed)).all(axis=1)
    check(abs(area - 360 * 180) < 1e-4, f"{name}: the faces' area on the plane is {area} square degrees")
    check((met == 1).all(), f"{name}: places of {numpy.unique(met)} faces, as at {places[met != 1][:3]}")


def check_sphere(name, got, layers, solid, heights):
    """Each edge has two faces, and the layers' volumes are those of the polyhedra. solid: the sum of determinants of the faces."""
    points, faces, _ = faces_of(got, layers)
    edges = numpy.sort(numpy.array([(f[i], f[i - 1]) for f in faces for i in range(len(f))]), axis=1)
    _, counts = numpy.unique(edges, axis=0, return_counts=True)
    check((counts == 2).all(), f"{name}: edges of {numpy.unique(counts)} faces on the sphere")
    for level in range(layers + 1):
        r = numpy.linalg.norm(points[level], axis=1)
        check(near(r, radius + heights[level], 1e-9), f"{name}: level {level} is at {r.min() - radius:.3f} .. {r.max() - radius:.3f}")
    volume = sum(numpy.linalg.det(points[-1][[f[0], f[i], f[i + 1]]]) - numpy.linalg.det(points[0][[f[0], f[i], f[i + 1]]])
                 for f in faces for i in range(1, len(f) - 1)) / 6
    wanted = solid * ((radius + heights[-1]) ** 3 - (radius + heights[0]) ** 3) / 6
    check(abs(abs(volume) - wanted) < 1e-6 * wanted, f"{name}: a volume of {volume}, instead of {wanted}")


def solid_of(points, triangles):
    return numpy.abs(numpy.linalg.det(points[triangles])).sum()


borders = numpy.array([0.0, 300, 1000, 2500, 6000])
layers = len(borders) - 1
thickness = numpy.diff(borders)
for name, turn in turns.items():
    points, triangles = icosphere(3, turn)
    cells = len(points)
    solid = solid_of(points, triangles)

    # MPAS' atmosphere: radians without a unit, heights of borders on cells, times as text
    dimensions, mesh = mpas(points, triangles)
    theta = (280 + degrees_of(points)[1][:, None] + 10 * numpy.arange(layers) + 100 * numpy.arange(2.0)[:, None, None]).astype("f4")
    vorticity = numpy.arange(2.0 * len(triangles) * layers, dtype="f4").reshape(2, len(triangles), layers)
    texts = numpy.array([list("2010-10-23_0%d:00:00" % hour) for hour in (0, 6)], "S1")
    parts = dict(mesh, zgrid=("nCells nVertLevelsP1", numpy.tile(borders, (cells, 1)), {"units": "m"}),
        xtime=("Time StrLen", texts, {}), areaCell=("nCells", numpy.ones(cells), {}), theta=("Time nCells nVertLevels", theta, {"units": "K"}),
        vorticity=("Time nVertices nVertLevels", vorticity, {"units": "s-1"}))
    sizes = dict(dimensions, nVertLevels=layers, nVertLevelsP1=layers + 1, Time=2, StrLen=19)
    path = write("mpas " + name, sizes, **parts)
    flat, globe = read(path, "theta", time=21600), read(path, "theta", 10, 21600)
    check(not flat.error and not globe.error, f"mpas {name}: {flat.error}{globe.error}")
    if not flat.error and not globe.error:
        check(list(flat.reader.GetNameOfVariable(i) for i in range(flat.reader.GetNumberOfVariables())) == ["theta", "vorticity"], f"{name}: variables")
        check(flat.reader.GetTimeUnits() == "seconds since 2010-10-23 00:00:00", flat.reader.GetTimeUnits())
        check_plane("mpas " + name, flat, layers)
        check_sphere("mpas " + name, globe, layers, solid, 10 * borders)
        at = vtk_to_numpy(globe.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)
        check(at.shape[1] == cells and near(at[0] / radius, points, 1e-9), f"mpas {name}: middles of cells")
        got, stored = values_of(globe, "theta").reshape(layers + 1, -1), theta[1].T
        check(near(got[0], stored[0]) and near(got[-1], stored[-1]), f"mpas {name}: the outermost layers' values")
        weight = thickness[1:] / (thickness[1:] + thickness[:-1])
        check(near(got[1:-1], weight[:, None] * stored[:-1] + (1 - weight[:, None]) * stored[1:], 1e-6), f"mpas {name}: between layers by distance")
        on_plane = values_of(flat, "theta").reshape(layers + 1, -1)
        check(near(on_plane[:, :cells], got), f"mpas {name}: the same values on the plane")
        places = vtk_to_numpy(flat.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)[0] / degree
        extra = places[cells:]
        pole = numpy.abs(extra[:, 1]) > 90 - 1e-6
        check(near(on_plane[0, cells:][~pole], 380 + extra[~pole, 1], 1e-6), f"mpas {name}: where edges are cut, values are between their ends")
        check((numpy.abs(on_plane[0, cells:] - 380 - extra[:, 1])[pole] < 8).all() and pole.sum() > 8, f"mpas {name}: the pole has its value or a near one")
        east = places[:, 0] / numpy.cos(numpy.radians(0.5 * (places[:, 1].min() + places[:, 1].max())))
        check(abs(east.min()) < 1e-9 and abs(east.max() - 360) < 1e-9, f"mpas {name}: the plane is from {east.min()} to {east.max()} degrees")
        faces = read(path, "vorticity", 10)
        check(near(values_of(faces, "vorticity").reshape(layers, -1), vorticity[0].T), f"mpas {name}: values of corners are on faces")
    for table, needed in (("cellsOnVertex", "nEdgesOnCell"), ("verticesOnCell", "")):  # either table serves
        less = {key: value for key, value in parts.items() if key not in (table, "vorticity")}
        got = read(write(f"mpas {name} without {table}", sizes, **less), "theta", 10, 21600)
        check(not got.error, f"mpas without {table}: {got.error}")
        if not got.error and not globe.error:
            check(near(values_of(got, "theta"), values_of(globe, "theta")), "the same values")
            check_sphere(f"mpas {name} without {table}", got, layers, solid, 10 * borders)

    # MPAS' ocean: only wet cells, thicknesses from the top over a bottom, of which some layers are not there
    wet = points @ numpy.array([0.6, 0.0, 0.8]) < 0.5
    dimensions, mesh = mpas(points, triangles, wet)
    count = int(wet.sum())
    lowest = 2 + numpy.arange(count) % (layers - 1)
    deep = numpy.where(numpy.arange(layers)[None, :] < lowest[:, None], thickness[::-1], 0.0)
    deep[:, 0] += numpy.linspace(0, 50, count)  # the free surface
    junk = numpy.where(deep > 0, deep, -1e34)
    bottom = deep.sum(axis=1) - numpy.linspace(0, 50, count)
    salt = 30 + numpy.arange(1.0 * count * layers).reshape(1, count, layers) / 1000
    path = write("mpas ocean " + name, dict(dimensions, nVertLevels=layers, Time=1), **mesh, layerThickness=("Time nCells nVertLevels", junk[None], {"units": "m"}),
        bottomDepth=("nCells", bottom, {"units": "m"}), maxLevelCell=("nCells", lowest.astype("i4"), {}), salinity=("Time nCells nVertLevels", salt, {}))
    got = read(path, "salinity", 100)
    check(not got.error, f"mpas ocean: {got.error}")
    if not got.error:
        at = vtk_to_numpy(got.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)
        heights = (numpy.linalg.norm(at, axis=2) - radius) / 100
        check(near(heights[0], -bottom, 1e-6) and near(heights[-1], numpy.linspace(0, 50, count), 1e-4), "the bottom and the free surface")
        check(near(heights[1:] - heights[:-1], deep[:, ::-1].T, 1e-5), "layers' thicknesses")
        ghosts = got.data.GetCellData().GetArray("vtkGhostType")
        shown = (vtk_to_numpy(ghosts).reshape(layers, -1)[-1] == 0).sum() if ghosts else dimensions["nVertices"]
        check(shown == wet[triangles].all(axis=1).sum() < dimensions["nVertices"], f"the top layer has {shown} triangles, of three wet cells each")
        check(near(values_of(got, "salinity").reshape(layers + 1, -1)[-1], salt[0, :, 0]), "values at the surface")

    # ICON: triangles by their corners, heights on cells from the top
    dimensions, mesh = icon(points, triangles)
    n = len(triangles)
    q = numpy.arange(1.0 * layers * n).reshape(1, layers, n)
    sizes = dict(dimensions, time=1, height=layers, height_2=layers + 1, bnds=2)
    common = dict(time=("time", numpy.array([0.0]), {"units": "hours since 2020-06-01", "standard_name": "time"}),
        height=("height", numpy.arange(1.0, layers + 1), {"standard_name": "height", "long_name": "generalized_height", "axis": "Z", "bounds": "height_bnds"}),
        height_bnds=("height bnds", numpy.stack([numpy.arange(1.0, layers + 1), numpy.arange(2.0, layers + 2)], axis=1), {}),
        height_2=("height_2", numpy.arange(1.0, layers + 2), {"standard_name": "height", "long_name": "generalized_height", "axis": "Z"}),
        qc=("time height ncells", q, {"units": "kg kg-1", "coordinates": "clat clon", "CDI_grid_type": "unstructured"}))
    half = dict(z_ifc=("height_2 ncells", numpy.tile(borders[::-1, None], (1, n)), {"units": "m", "standard_name": "geometric_height_at_half_level_center"}))
    full = dict(z_mc=("height ncells", numpy.tile((0.5 * (borders[1:] + borders[:-1]))[::-1, None], (1, n)), {"units": "m",
        "standard_name": "geometric_height_at_full_level_center"}))
    for what, heights, at_levels in (("z_ifc", half, borders), ("z_mc", full, None), ("both", {**full, **half}, borders), ("numbers", {}, None)):
        path = write(f"icon {name} {what}", sizes, **mesh, **common, **heights)
        flat, globe = read(path, "qc"), read(path, "qc", 10)
        check(not flat.error and not globe.error, f"icon {what}: {flat.error}{globe.error}")
        if flat.error or globe.error:
            continue
        z = vtk_to_numpy(flat.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)[:, 0, 2]
        if what == "numbers":
            check(near(z, [-5, -4, -3, -2, -1]) and flat.units == "", f"numbers from the top: {z} {flat.units}")
        elif what == "z_mc":
            inner = 0.25 * (borders[:-2] + 2 * borders[1:-1] + borders[2:])
            check(near(z[1:-1], inner) and near(z[0] + z[1], 300), f"borders between middles: {z}")
        else:
            check(near(z, borders) and flat.units == "m", f"icon {what}: {z}")
        check(near(values_of(globe, "qc").reshape(layers, -1), q[0, ::-1]), f"icon {what}: values of cells, from the bottom")
        if at_levels is not None:
            check_plane(f"icon {name}", flat, layers)
            check_sphere(f"icon {name}", globe, layers, solid, 10 * at_levels)
            at = vtk_to_numpy(globe.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)
            check(at.shape[1] == cells, f"icon {name}: {at.shape[1]} corners, each once, instead of {cells}")
            read_values = values_of(flat, "qc").reshape(layers, -1)
            _, faces, numbers = faces_of(flat, layers)
            plane = vtk_to_numpy(flat.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)[0]
            middle = 0.5 * (plane[:, 1].min() + plane[:, 1].max()) / degree
            lon, lat = degrees_of(middles(points, triangles))
            for face, number in list(zip(faces, numbers))[::7]:
                centre = plane[face, :2].mean(axis=0) / degree / [numpy.cos(numpy.radians(middle)), 1]
                of = int(q[0, -1].tolist().index(read_values[0, number]))
                off = abs((centre[0] - lon[of] + 180) % 360 - 180) * numpy.cos(numpy.radians(lat[of])) + abs(centre[1] - lat[of])
                check(off < 20, f"icon {name}: the value of cell {of} is {off} degrees away")

    # Cells of five and six corners, of which the last is repeated, on levels of pressure
    table, counts = dual(points, triangles)
    corner = table[numpy.arange(cells)[:, None], numpy.minimum(numpy.arange(6), counts[:, None] - 1)]
    lon, lat = degrees_of(middles(points, triangles))
    at_lon, at_lat = degrees_of(points)
    path = write("hexagons " + name, {"cell": cells, "nv": 6, "plev": 3},
        lon=("cell", at_lon, {"units": "degrees_east", "bounds": "lon_bounds"}), lon_bounds=("cell nv", lon[corner] % 360, {}),
        lat=("cell", at_lat, {"units": "degrees_north", "bounds": "lat_bounds"}), lat_bounds=("cell nv", lat[corner], {}),
        plev=("plev", numpy.array([85000.0, 50000, 25000]), {"units": "Pa", "axis": "Z", "positive": "down"}),
        t=("plev cell", numpy.arange(3.0 * cells).reshape(3, cells), {"units": "K", "coordinates": "lat lon"}))
    flat, globe = read(path), read(path, factor=10)
    check(not flat.error and not globe.error, f"hexagons: {flat.error}{globe.error}")
    if not flat.error and not globe.error:
        check_plane("hexagons " + name, flat, 3)
        _, faces, _ = faces_of(globe, 3)
        check(sorted({len(face) for face in faces}) == [5, 6] and near(values_of(globe, "t").reshape(3, -1), numpy.arange(3.0 * cells).reshape(3, -1)), "values")

# Refusals
points, triangles = icosphere(1)
dimensions, mesh = mpas(points, triangles)
zgrid = ("nCells nVertLevelsP1", numpy.tile(borders, (len(points), 1)), {"units": "m"})
theta = ("nCells nVertLevels", numpy.zeros((len(points), layers), "f4"), {})
sizes = dict(dimensions, nVertLevels=layers, nVertLevelsP1=layers + 1)
bad = mesh["cellsOnVertex"][1].copy()
bad[3, 1] = 99
for name, change, words in (
    ("a number", dict(cellsOnVertex=("nVertices vertexDegree", bad, {})), "'cellsOnVertex': face 3 has the node 99, must be 1 to 42"),
    ("no middles", dict(lonCell=None), "there is no variable 'lonCell'"),
    ("no heights", dict(zgrid=None), "there is no free surface"),
    ("upside down", dict(zgrid=(zgrid[0], zgrid[1][:, [0, 2, 1, 3, 4]], {"units": "m"})), "layers are upside down")):
    parts = {key: value for key, value in {**mesh, "zgrid": zgrid, "theta": theta, **change}.items() if value}
    got = read(write("refused " + name, sizes, **parts))
    check(words in got.error, f"{name}: {got.error}")
finish()
