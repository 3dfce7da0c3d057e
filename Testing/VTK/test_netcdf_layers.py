# SPDX-License-Identifier: BSD-3-Clause
"""Layered meshes over fixed depths, heights and pressures, in every order of dimensions, and meshes across the date line: places and values
judged by NumPy from the arrays that netCDF4 wrote."""
import itertools

import numpy
from vtk.util.numpy_support import vtk_to_numpy

from netcdf_reading import Read, check, degree, finish, near, standard_height, write

columns, rows, layers, times = 4, 3, 5, 2
grid_x, grid_y = (array.ravel() for array in numpy.meshgrid(numpy.linspace(0, 1000, columns + 1), numpy.linspace(0, 800, rows + 1)))
faces = []
for j, i in itertools.product(range(rows), range(columns)):
    a = j * (columns + 1) + i
    square = [a, a + 1, a + columns + 2, a + columns + 1]
    faces += [square] if (i + j) % 2 else [[square[0], square[1], square[2], -1], [square[0], square[2], square[3], -1]]
faces = numpy.array(faces)
nodes = grid_x.size
random = numpy.random.default_rng(3)
down = {"units": "m", "positive": "down"}


def mesh(name, variables, x=grid_x, y=grid_y, table=faces, units="m", start=0, count=layers):
    sizes = {"node": len(x), "face": len(table), "corner": table.shape[1], "time": times, "layer": count, "border": count + 1, "two": 2}
    return write("layers " + name, sizes,
        mesh=("", numpy.int32(0), {"cf_role": "mesh_topology", "topology_dimension": 2, "node_coordinates": "nx ny",
            "face_node_connectivity": "table"}),
        nx=("node", x, {"units": units}), ny=("node", y, {"units": units}),
        table=("face corner", numpy.where(table < 0, -999, table + start).astype("i4"), {"start_index": numpy.int32(start), "fill": -999}),
        time=("time", numpy.arange(times) * 1.0, {"units": "hours since 2020-01-01"}), **variables)


def tracer(on, order=("time", "layer", "place"), places=None):
    """A variable on nodes or faces, and its values[time, layer, place]."""
    values = random.uniform(0, 1, (times, layers, places or (nodes if on == "node" else len(faces))))
    stored = values.transpose([("time", "layer", "place").index(one) for one in order])
    return (" ".join(on if one == "place" else one for one in order), stored, {"mesh": "mesh", "location": on}), values


def middles(heights):
    """Borders from the bottom up of layers with these middles, from the bottom up."""
    inner = .5 * (heights[1:] + heights[:-1])
    low, high = 2 * heights[0] - inner[0], 2 * heights[-1] - inner[-1]
    return numpy.concatenate([[max(low, 0) if heights[0] > 0 else low], inner, [min(high, 0) if heights[-1] < 0 else high]])


def everywhere(borders):
    return numpy.repeat(numpy.asarray(borders, float)[:, None], nodes, axis=1)


def at_borders(upward, z):
    """Values on nodes, of layers from the bottom up, interpolated to the borders between the layers' middles."""
    thick = z[1:] - z[:-1]
    inner = (thick[1:] * upward[:-1] + thick[:-1] * upward[1:]) / (thick[1:] + thick[:-1])
    return numpy.concatenate([upward[:1], inner, upward[-1:]])


def judge(name, path, borders, values, on, time=0.0):
    """borders[border, node] and values[layer, place] from the bottom up"""
    got = Read(path, "tracer", time, cls="vtkStratusUgridReader")
    check(not got.error, "%s: %s" % (name, got.error))
    if not got.error:
        points = vtk_to_numpy(got.data.GetPoints().GetData()).reshape(len(borders), nodes, 3)
        check(near(points[..., 2], borders), "%s: heights are %s, not %s" % (name, points[:, 0, 2], borders[:, 0]))
        check(near(points[..., 0], grid_x) and near(points[..., 1], grid_y) and got.units == "m", name + ": places")
        data = got.data.GetPointData() if on == "node" else got.data.GetCellData()
        read = vtk_to_numpy(data.GetArray("tracer")).reshape(-1, values.shape[1])
        check(near(read, values if on == "face" else at_borders(values, borders)), name + ": values")
        ghosts = got.data.GetCellData().GetArray("vtkGhostType")
        hidden = vtk_to_numpy(ghosts).reshape(-1, len(faces)) != 0 if ghosts else numpy.zeros((len(borders) - 1, len(faces)), bool)
        thin = numpy.array([[all(borders[k + 1, n] <= borders[k, n] for n in face if n >= 0) for face in faces]
            for k in range(len(borders) - 1)])
        check(numpy.array_equal(hidden, thin), name + ": cells without thickness, and no others, are hidden")
    return got


# Time, layer and place in every order, on nodes and faces, numbered from 0 and from 1.
depths = numpy.array([1.0, 4, 9, 16, 30])
for start, on, order in itertools.product((0, 1), ("face", "node"), itertools.permutations(("time", "layer", "place"))):
    variable, values = tracer(on, order)
    path = mesh("order", {"layer": ("layer", depths, down), "tracer": variable}, start=start)
    for t in range(times):
        judge("order " + variable[0], path, everywhere(middles(-depths[::-1])), values[t, ::-1], on, float(t))

# Levels of other units, ways and kinds; upward: whether the file's first layer is the lowest.
heights = numpy.array([2.0, 10, 50, 100, 400])
pressures = numpy.array([1000.0, 900, 700, 500, 300])
standard = standard_height(100 * pressures)
edges = numpy.array([0.0, 2, 6, 12, 20, 40])
bounds = numpy.stack([edges[:-1], edges[1:]], axis=1)
for name, level, extra, borders, upward in (
    ("up", (heights, {"units": "m", "positive": "up"}), {}, middles(heights), True),
    ("kilometres", (-depths / 1000, {"units": "Kilometers", "axis": "Z"}), {}, middles(-depths[::-1]), False),
    ("Down", (depths[::-1], {"units": "meter", "positive": "Down"}), {}, middles(-depths[::-1]), True),
    ("depth", (depths, {"units": "m", "standard_name": "depth"}), {}, middles(-depths[::-1]), False),
    ("pressure", (pressures, {"units": "hPa"}), {}, middles(standard), True),
    ("bounds", (depths, {**down, "bounds": "edges"}), {"edges": ("layer two", bounds, {})}, -edges[::-1], False),
    ("turned bounds", (depths[::-1], {**down, "bounds": "edges"}), {"edges": ("layer two", bounds[::-1, ::-1], {})}, -edges[::-1], True),
    ("borders", (depths, down), {"border": ("border", edges, down)}, -edges[::-1], False),
    ("other borders", (depths, {"standard_name": "depth", "units": "m"}), {"depth_2": ("border", edges, {"standard_name": "depth",
        "units": "m"})}, -edges[::-1], False)):
    for on in ("face", "node"):
        variable, values = tracer(on)
        path = mesh("levels", {"layer": ("layer",) + level, "tracer": variable, **extra})
        judge(name + " on " + on, path, everywhere(borders), values[1, ::1 if upward else -1], on, 1.0)

# Cut at the bottom, on nodes or faces, and raised to the free surface.
bottom = random.uniform(3, 60, nodes)
of_faces = random.uniform(3, 60, len(faces))
mean = numpy.array([numpy.mean([of_faces[f] for f in range(len(faces)) if n in faces[f]]) for n in range(nodes)])
surface = random.uniform(-.5, 1, (times, nodes))
for name, extra, floor, top in (
    ("nodes", {"bathymetry": ("node", bottom / 1000, {"units": "km"})}, -bottom, None),
    ("faces", {"depth": ("face", of_faces, {"units": "m", "standard_name": "sea_floor_depth_below_geoid"})}, -mean, None),
    ("altitude", {"floor": ("node", -bottom, {"units": "m", "standard_name": "sea_floor_depth_below_geoid", "positive": "up"})}, -bottom,
        None),
    ("surface", {"h": ("node", bottom, {"units": "m"}), "ssh": ("time node", 100 * surface, {"units": "cm",
        "standard_name": "sea_surface_height_above_geoid"})}, -bottom, surface)):
    variable, values = tracer("face")
    path = mesh("cut " + name, {"layer": ("layer", depths, {**down, "bounds": "edges"}), "edges": ("layer two", bounds, {}),
        "tracer": variable,
        **extra})
    for t in range(times):
        z = numpy.maximum(everywhere(-edges[::-1]), floor)
        if top is not None:
            z = numpy.minimum(z, top[t])
            z[-1] = top[t]
        judge("cut at " + name, path, z, values[t, ::-1], "face", float(t))

# Under the bottom, values on nodes are missing; those above it count.
variable, values = tracer("node")
wet = -bottom[None, :] < -edges[:-1, None]  # layers with any water, from the top
stored = numpy.where(wet, values, 1e20)
path = mesh("missing", {"layer": ("layer", depths, {**down, "bounds": "edges"}), "edges": ("layer two", bounds, {}),
    "tracer": ("time layer node", stored, {"fill": 1e20}), "h": ("node", bottom, {"units": "m"})})
got = Read(path, "tracer", 0.0, cls="vtkStratusUgridReader")
check(not got.error, "missing: " + got.error)
if not got.error:
    read = vtk_to_numpy(got.data.GetPointData().GetArray("tracer")).reshape(layers + 1, nodes)
    z = vtk_to_numpy(got.data.GetPoints().GetData()).reshape(layers + 1, nodes, 3)[..., 2]
    for n in range(nodes):
        filled = numpy.nonzero(z[1:, n] > z[:-1, n])[0]
        check(numpy.isfinite(read[filled[0]:, n]).all(), "missing: every border above the bottom has a value at node %d" % n)
        check(near(read[filled[0], n], stored[0, ::-1][filled[0], n]), "missing: the bottom has the lowest layer's value")

# A mesh across the date line becomes continuous; around the Earth, faces across the jump are cut there, and the one around the pole
# becomes quadrangles that reach to the pole.
longitude, latitude = 175 + grid_x / 100, -20 + grid_y / 100
variable, values = tracer("face")
stored = (longitude + 180) % 360 - 180
path = mesh("date line", {"layer": ("layer", depths, down), "tracer": variable}, x=stored, y=latitude, units="degrees_east")
got = Read(path, "tracer", 0.0, cls="vtkStratusUgridReader")
check(not got.error, "date line: " + got.error)
if not got.error:
    points = vtk_to_numpy(got.data.GetPoints().GetData()).reshape(layers + 1, nodes, 3)
    middle = .5 * (latitude.min() + latitude.max())
    check(near(points[0, :, 0], degree * numpy.cos(numpy.radians(middle)) * longitude), "date line: x is continuous")
around, tall = 24, 5
ring_lon, ring_lat = (array.ravel() for array in numpy.meshgrid((numpy.arange(around) * 15 + 7) % 360 - 180.0, numpy.linspace(40, 80,
    tall)))
globe = [[j * around + i, j * around + (i + 1) % around, (j + 1) * around + (i + 1) % around, (j + 1) * around + i]
    for j in range(tall - 1) for i in range(around)]
cap = [list(range((tall - 1) * around, tall * around))]
table = numpy.full((len(globe) + 1, around), -1)
for f, face in enumerate(globe + cap):
    table[f, :len(face)] = face
for on in ("face", "node"):
    variable, values = tracer(on, places=len(table) if on == "face" else len(ring_lon))
    path = mesh("globe", {"layer": ("layer", depths, down), "tracer": variable}, x=ring_lon, y=ring_lat, table=table, units="degrees_east")
    got = Read(path, "tracer", 0.0, cls="vtkStratusUgridReader")
    check(not got.error, "globe: " + got.error)
    if got.error:
        continue
    points = vtk_to_numpy(got.data.GetPoints().GetData()).reshape(layers + 1, -1, 3)
    across = degree * numpy.cos(numpy.radians(60))
    check(near(points[0, :len(ring_lon), 0], across * ring_lon) and near(points[0, :, 0].max(), 180 * across) and
          near(points[0, :, 0].min(), -180 * across), "globe: nodes, in front of those where faces are cut")
    hidden = got.data.GetCellData().GetArray("vtkGhostType")
    check(not hidden or not vtk_to_numpy(hidden).any(), "globe: no face is hidden")
    parts = (tall - 1) + around  # one more of each face across the date line, and of the cap, which has one across it
    check(got.data.GetNumberOfCells() == layers * (len(table) + parts), f"globe: {got.data.GetNumberOfCells()} cells")
    flat = points[0, :, 0] / across
    read = vtk_to_numpy((got.data.GetCellData() if on == "face" else got.data.GetPointData()).GetArray("tracer")).reshape(layers + (on == "node"), -1)
    for f in range(got.data.GetNumberOfCells() // layers):
        ids = got.data.GetCell(f).GetPointIds()
        at = [ids.GetId(i) for i in range(4)]
        check(max(flat[at]) - min(flat[at]) < 15.001, "globe: face %d spans %g degrees" % (f, max(flat[at]) - min(flat[at])))
        if f >= len(table):
            whole = [one for one in range(len(table)) if near(read[:, one], read[:, f], 1e-12)] if on == "face" else [0]
            check(len(whole) == 1, "globe: part %d has the value of one face" % f)
        elif f < len(globe) and abs(abs(flat[at]).max() - 180) > 1:
            check(sorted(numpy.round(flat[at] % 360, 6)) == sorted(numpy.round(ring_lon[globe[f]] % 360, 6)),
                "globe: face %d has its nodes" % f)
    cut = numpy.nonzero((numpy.abs(numpy.abs(flat) - 180) < 1e-6) & (points[0, :, 1] < 85 * degree))[0]
    check(len(cut) == 2 * tall, "globe: %d nodes where edges are cut, on both sides" % len(cut))
    for node in cut if on == "node" else ():
        row = numpy.nonzero(numpy.abs(ring_lat - points[0, node, 1] / degree) < 1e-6)[0]
        last = [row[numpy.abs(ring_lon[row] - side).argmin()] for side in (-173, 172)]
        check(near(read[:, node], (8 * read[:, last[0]] + 7 * read[:, last[1]]) / 15, 1e-6), "globe: a value between its neighbours, by distance")

# Contradictions are refused.
variable, values = tracer("face")
for name, level, extra, message in (
    ("unit", (depths, {"units": "K", "positive": "down"}), {}, "has the unit 'K', it must be one of length or pressure"),
    ("gap", (depths, {**down, "bounds": "edges"}), {"edges": ("layer two", bounds + numpy.arange(layers)[:, None], {})},
        "they must begin at"),
    ("nowhere", (depths, {**down, "bounds": "none"}), {}, "the bounds 'none' of 'layer' are not there"),
    ("back", (depths[[0, 2, 1, 3, 4]], down), {}, "must increase or decrease all along"),
    ("way", (depths, {"units": "m", "positive": "in"}), {}, "has positive 'in', it must be up or down")):
    got = Read(mesh("refused " + name, {"layer": ("layer",) + level, "tracer": variable, **extra}), "tracer", 0.0,
        cls="vtkStratusUgridReader")
    check(message in got.error, "%s: '%s' is not in '%s'" % (name, message, got.error))
finish()
