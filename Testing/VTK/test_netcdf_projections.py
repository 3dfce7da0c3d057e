# SPDX-License-Identifier: BSD-3-Clause
"""Grids on map projections and about another pole: published points of each projection land at their longitudes and latitudes on the sphere, and
longitudes and latitudes at their places on the plane; columns of rotated grids are judged by NumPy. Mappings that are unknown or incomplete are
refused with a reason. The same places by coordinate reference systems as text (WKT), and of the nodes of meshes."""
import os

import numpy
from vtk.util.numpy_support import vtk_to_numpy

from netcdf_reading import Read, check, finish, near, write

radius = 6371000.0
heights = numpy.array([0.0, 1000.0])
has_proj = os.environ.get("STRATUS_PROJ", "1") == "1"  # whether the readers were built with PROJ


def place(longitude, latitude, height=0.0):
    a, b, r = numpy.radians(longitude), numpy.radians(latitude), radius + height
    return numpy.stack([r * numpy.cos(b) * numpy.cos(a), r * numpy.cos(b) * numpy.sin(a), r * numpy.sin(b)], axis=-1)


def projected(name, mapping, x, y, units="m", standard=("projection_x_coordinate", "projection_y_coordinate"), more=None, **attributes):
    of = {"grid_mapping": "crs", **attributes}
    return write("projected " + name, {"z": 2, "y": len(y), "x": len(x)}, z=("z", heights, {"units": "m", "positive": "up"}),
        y=("y", y, {"units": units, "standard_name": standard[1]}), x=("x", x, {"units": units, "standard_name": standard[0]}),
        crs=("", numpy.int32(0), mapping), q=("z y x", numpy.arange(2.0 * len(y) * len(x)).reshape(2, len(y), len(x)), of), **(more or {}))


def on_sphere(path):
    def prepare(reader):
        reader.SetCoordinatesToSphere()
        reader.SetHeightFactor(1)

    return Read(path, prepare=prepare)


def degrees(d, m=0, s=0.0):
    return d + m / 60 + s / 3600


def mapping(name, **attributes):
    return {"grid_mapping_name": name, **attributes}


airy = dict(semi_major_axis=6377563.396, inverse_flattening=299.32496)
clarke = dict(reference_ellipsoid_name="Clarke 1866")
wgs = dict(reference_ellipsoid_name="WGS 84")
foot = 12 / 39.37  # of the US survey, in metres
# The examples of EPSG's Guidance Note 7-2, of Snyder's Map Projections (USGS Professional Paper 1395), and of the GOES-R Product User's Guide:
# longitude, latitude, x, y in metres, and half of the last published digit of x and y
known = {
    "lambert_conformal_conic, 2 parallels": (mapping("lambert_conformal_conic", standard_parallel=[degrees(28, 23), degrees(30, 17)],
        longitude_of_central_meridian=-99.0, latitude_of_projection_origin=degrees(27, 50), false_easting=2000000.0 * foot, **clarke),
        -96.0, 28.5, 2963503.91 * foot, 254759.80 * foot, 0.01),
    "lambert_conformal_conic, 1 parallel": (mapping("lambert_conformal_conic", standard_parallel=18.0, longitude_of_central_meridian=-77.0,
        latitude_of_projection_origin=18.0, false_easting=250000.0, false_northing=150000.0, **clarke),
        -degrees(76, 56, 37.26), degrees(17, 55, 55.80), 255966.58, 142493.51, 0.2),  # a hundredth of a second is .3 m
    "transverse_mercator": (mapping("transverse_mercator", scale_factor_at_central_meridian=0.9996012717, longitude_of_central_meridian=-2.0,
        latitude_of_projection_origin=49.0, false_easting=400000.0, false_northing=-100000.0, **airy), 0.5, 50.5, 577274.99, 69740.50, 0.02),
    "mercator, factor": (mapping("mercator", scale_factor_at_projection_origin=0.997, longitude_of_projection_origin=110.0, false_easting=3900000.0,
        false_northing=900000.0, semi_major_axis=6377397.155, inverse_flattening=299.15281), 120.0, -3.0, 5009726.58, 569150.82, 0.01),
    "mercator, parallel": (mapping("mercator", standard_parallel=42.0, longitude_of_projection_origin=51.0, semi_major_axis=6378245.0,
        inverse_flattening=298.3), 53.0, 53.0, 165704.29, 5171848.07, 0.01),
    "polar_stereographic, factor": (mapping("polar_stereographic", scale_factor_at_projection_origin=0.994, straight_vertical_longitude_from_pole=0.0,
        latitude_of_projection_origin=90.0, false_easting=2000000.0, false_northing=2000000.0, **wgs), 44.0, 73.0, 3320416.75, 632668.43, 0.01),
    "polar_stereographic, parallel": (mapping("polar_stereographic", standard_parallel=-71.0, straight_vertical_longitude_from_pole=70.0,
        latitude_of_projection_origin=-90.0, false_easting=6000000.0, false_northing=6000000.0, **wgs), 120.0, -75.0, 7255380.79, 7053389.56, 0.01),
    "lambert_azimuthal_equal_area": (mapping("lambert_azimuthal_equal_area", longitude_of_projection_origin=10.0, latitude_of_projection_origin=52.0,
        false_easting=4321000.0, false_northing=3210000.0, reference_ellipsoid_name="GRS 1980"), 5.0, 50.0, 3962799.45, 2999718.85, 0.01),
    "albers_conical_equal_area": (mapping("albers_conical_equal_area", standard_parallel=[29.5, 45.5], longitude_of_central_meridian=-96.0,
        latitude_of_projection_origin=23.0, **clarke), -75.0, 35.0, 1885472.7, 1535925.0, 0.1),
    # of a sphere of 1000 km; Snyder's numbers and formulas
    "sinusoidal": (mapping("sinusoidal", longitude_of_central_meridian=-90.0, earth_radius=1e6), -75.0, -50.0, 1e6 * numpy.radians(15) *
        numpy.cos(numpy.radians(50)), 1e6 * numpy.radians(-50), 0.01),
    "orthographic": (mapping("orthographic", longitude_of_projection_origin=-100.0, latitude_of_projection_origin=40.0, earth_radius=1e6),
        -110.0, 30.0, -150383.7, -165191.1, 0.2),
    "lambert_cylindrical_equal_area": (mapping("lambert_cylindrical_equal_area", standard_parallel=30.0, longitude_of_central_meridian=-75.0,
        earth_radius=1e6), 80.0, 35.0, 1e6 * numpy.radians(155) * numpy.cos(numpy.radians(30)), 1e6 * numpy.sin(numpy.radians(35)) /
        numpy.cos(numpy.radians(30)), 0.01),
}
for name, (attributes, longitude, latitude, x, y, within) in known.items():
    xs, ys = x + numpy.array([0.0, 9000, 20000]), y + numpy.array([-7000.0, 0, 3000, 9000])
    path = projected(name, attributes, xs, ys)
    got = on_sphere(path)
    if not has_proj:
        check("need PROJ, which this build lacks" in got.error and "libproj-dev" in got.error, f"{name}: {got.error}")
        continue
    check(not got.error, f"{name}: {got.error}")
    if got.error:
        continue
    check(numpy.linalg.norm(got.points[0, 1, 0] - place(longitude, latitude)) < 1.5 * within + 0.01,
          f"{name}: {numpy.linalg.norm(got.points[0, 1, 0] - place(longitude, latitude))} m from its place on the sphere")
    check(near(numpy.linalg.norm(got.points[1], axis=-1), radius + 1000, 1e-9), f"{name}: heights")
    check("'crs' (" in got.description, f"{name}: {got.description}")
    flat = Read(path)
    there = [0.0, 0.0]
    check(flat.reader.HasPlaces() and flat.reader.FindPlace(longitude, latitude, there), f"{name} has places on its plane")
    check(abs(there[0] - x) < within and abs(there[1] - y) < within, f"{name}: {there} instead of {x}, {y}")
    check(near(flat.points[0, :, :, 0], xs[None, :], 1e-9), f"{name}: the plane is the file's own")

if has_proj:
    # in kilometres, in which the false easting is, too
    attributes, longitude, latitude, x, y, within = known["lambert_azimuthal_equal_area"]
    path = projected("kilometres", {**attributes, "false_easting": 4321.0, "false_northing": 3210.0}, (x + numpy.array([0.0, 5000])) / 1000,
        (y + numpy.array([0.0, 5000])) / 1000, "km")
    got, flat, there = on_sphere(path), Read(path), [0.0, 0.0]
    check(numpy.linalg.norm(got.points[0, 0, 0] - place(longitude, latitude)) < 0.05, "kilometres on the sphere")
    check(flat.reader.FindPlace(longitude, latitude, there) and abs(there[0] - x) < within, f"kilometres on the plane: {there}")

    # GOES-R: angles of the instrument in radians, downwards; corners of the view are off the Earth
    goes = mapping("geostationary", longitude_of_projection_origin=-75.0, perspective_point_height=35786023.0, sweep_angle_axis="x",
        semi_major_axis=6378137.0, semi_minor_axis=6356752.31414)
    angular = ("projection_x_angular_coordinate", "projection_y_angular_coordinate")
    for names in (angular, ("projection_x_coordinate", "projection_y_coordinate")):
        path = projected("goes", goes, numpy.array([-0.15, -0.1, -0.024052, 0.05]), numpy.array([0.15, 0.095340, 0.0, -0.1]), "rad", names)
        got = on_sphere(path)
        check(not got.error and numpy.linalg.norm(got.points[0, 1, 2] - place(-84.690932, 33.846162)) < 0.2, f"the view of a satellite {got.error}")
        ghosts = got.data.GetPointData().GetArray("vtkGhostType")
        hidden = numpy.array([[ghosts.GetValue(4 * j + i) for i in range(4)] for j in range(4)]) != 0 if ghosts else numpy.zeros((4, 4), bool)
        check(hidden[0, 0] and not hidden[1, 2] and not hidden[2, 1], f"places off the Earth are hidden: {hidden}")
        flat = Read(path)
        check(flat.units == "m" and near(flat.points[0, 0, :, 0], 35786023.0 * numpy.array([-0.15, -0.1, -0.024052, 0.05]), 1e-9),
              f"angles of an instrument are no longitudes: {flat.points[0, 0, :, 0]}")

    # The grids of CORDEX' Europe have their pole at 162 W, 39.25 N. (0, 0) is at 18 E, 50.75 N.
    def turned(rlon, rlat, pole_longitude, pole_latitude):
        """Longitudes and latitudes by a rotation of vectors: about y by which the pole moves, then about z."""
        p, tilt, turn = place(rlon, rlat) / radius, numpy.radians(90 - pole_latitude), numpy.radians(pole_longitude)
        # (0, 0) is on the meridian beyond the pole
        x, y, z = -p[..., 0], -p[..., 1], p[..., 2]
        x, z = numpy.cos(tilt) * x + numpy.sin(tilt) * z, -numpy.sin(tilt) * x + numpy.cos(tilt) * z
        x, y = numpy.cos(turn) * x - numpy.sin(turn) * y, numpy.sin(turn) * x + numpy.cos(turn) * y
        return numpy.degrees(numpy.arctan2(y, x)), numpy.degrees(numpy.arcsin(z))

    europe = mapping("rotated_latitude_longitude", grid_north_pole_longitude=-162.0, grid_north_pole_latitude=39.25)
    grid = ("grid_longitude", "grid_latitude")
    check(numpy.allclose(turned(0.0, 0.0, -162, 39.25), (18, 50.75)), "the judge")
    for name, rlon in (("degrees", numpy.linspace(-28, 18, 24)), ("degrees of another turn", numpy.linspace(332, 378, 24))):
        rlat = numpy.linspace(-23, 21, 23)
        path = projected("rotated " + name, europe, rlon, rlat, "degrees", grid)
        got = on_sphere(path)
        lon, lat = turned(*numpy.meshgrid(rlon, rlat), -162, 39.25)
        check(not got.error and near(got.points, place(lon, lat, heights[:, None, None]), 1e-9), f"{name} about another pole {got.error}")
        check((got.values.ravel() == numpy.arange(got.values.size)).all(), "values")
        flat, there = Read(path), [0.0, 0.0]
        for i, j in ((0, 0), (5, 20), (23, 22)):
            check(flat.reader.FindPlace(lon[j, i], lat[j, i], there) and near(numpy.array(there), flat.points[0, j, i, :2], 1e-6),
                  f"{name}: {there} on the plane, instead of {flat.points[0, j, i]}")
    path = projected("rotated further", dict(europe, north_pole_grid_longitude=30.0), numpy.linspace(2, 58, 8), numpy.linspace(-23, 21, 6), "degrees", grid)
    lon, lat = turned(*numpy.meshgrid(numpy.linspace(-28, 28, 8), numpy.linspace(-23, 21, 6)), -162, 39.25)
    check(near(on_sphere(path).points[0], place(lon, lat), 1e-9), "the pole's own longitude in the grid")

    # a mapping of several, as CF-1.7 writes them
    path = projected("several", europe, numpy.linspace(0, 5, 6), numpy.linspace(0, 5, 6), "degrees", grid, grid_mapping="crs: x y")
    check(not on_sphere(path).error, "crs: x y")

# Coordinate reference systems as text: the places above again, in WKT 1 and 2, in feet, bound to another datum, and about another pole.
def wkt1(name, spheroid, projection, unit='"metre",1', meridian='"Greenwich",0', **parameters):
    listed = "".join(f',PARAMETER["{key}",{value!r}]' for key, value in parameters.items())
    return (f'PROJCS["{name}",GEOGCS["of {name}",DATUM["of {name}",SPHEROID[{spheroid}]],PRIMEM[{meridian}],UNIT["degree",0.0174532925199433]],'
            f'PROJECTION["{projection}"]{listed},UNIT[{unit}]]')


texas = wkt1("Texas", '"Clarke 1866",6378206.4,294.9786982138982', "Lambert_Conformal_Conic_2SP", '"US survey foot",0.3048006096012192',
    standard_parallel_1=degrees(28, 23), standard_parallel_2=degrees(30, 17), latitude_of_origin=degrees(27, 50), central_meridian=-99,
    false_easting=2000000, false_northing=0)
grid_1936 = wkt1("British", '"Airy 1830",6377563.396,299.32496', "Transverse_Mercator", latitude_of_origin=49, central_meridian=-2,
    scale_factor=0.9996012717, false_easting=400000, false_northing=-100000)
europe_2 = """PROJCRS["LAEA Europe",BASEGEOGCRS["ETRS89",DATUM["European Terrestrial Reference System 1989",ELLIPSOID["GRS 1980",6378137,298.257222101]]],
CONVERSION["Europe",METHOD["Lambert Azimuthal Equal Area"],PARAMETER["Latitude of natural origin",52,ANGLEUNIT["degree",0.0174532925199433]],
PARAMETER["Longitude of natural origin",10,ANGLEUNIT["degree",0.0174532925199433]],PARAMETER["False easting",4321000,LENGTHUNIT["metre",1]],
PARAMETER["False northing",3210000,LENGTHUNIT["metre",1]]],CS[Cartesian,2],AXIS["northing (Y)",north],AXIS["easting (X)",east],LENGTHUNIT["metre",1]]"""
rotated_2 = """GEOGCRS["CORDEX",BASEGEOGCRS["sphere",DATUM["sphere",ELLIPSOID["sphere",6371000,0]]],DERIVINGCONVERSION["pole",METHOD["PROJ ob_tran o_proj=longlat"],
PARAMETER["o_lat_p",39.25,ANGLEUNIT["degree",0.0174532925199433]],PARAMETER["o_lon_p",0,ANGLEUNIT["degree",0.0174532925199433]],
PARAMETER["lon_0",18,ANGLEUNIT["degree",0.0174532925199433]]],CS[ellipsoidal,2],AXIS["longitude",east,ANGLEUNIT["degree",0.0174532925199433]],
AXIS["latitude",north,ANGLEUNIT["degree",0.0174532925199433]]]"""
vertical = '"height",VERT_DATUM["sea",2005],UNIT["metre",1]'
texts = {"feet": (dict(crs_wkt=texas), "lambert_conformal_conic, 2 parallels"), "British": (dict(crs_wkt=grid_1936), "transverse_mercator"),
    "Europe, northings first": (dict(crs_wkt=europe_2), "lambert_azimuthal_equal_area"),
    "bound": (dict(crs_wkt=grid_1936.replace("]],PRIMEM", "],TOWGS84[446,-125,542,0.15,0.25,0.84,-20.5]],PRIMEM")), "transverse_mercator"),
    "with heights": (dict(crs_wkt=f'COMPD_CS["both",{grid_1936},VERT_CS[{vertical}]]'), "transverse_mercator"),
    "from Paris": (dict(crs_wkt=grid_1936.replace('"Greenwich",0', '"Paris",2.5').replace('"central_meridian",-2', '"central_meridian",-4.5')),
                   "transverse_mercator"),
    "GDAL's attribute": (dict(spatial_ref=europe_2), "lambert_azimuthal_equal_area"),
    "Delft3D FM's attribute": (dict(wkt="", EPSG_code="EPSG:3035", grid_mapping_name="Unknown projected"), "lambert_azimuthal_equal_area"),
    "PROJ's own text": (dict(crs_wkt="+proj=sinu +lon_0=-90 +R=1000000 +type=crs"), "sinusoidal"),
    "beside an unknown name": (mapping("peirce_quincuncial", crs_wkt=grid_1936), "transverse_mercator"),
    "behind parameters": (dict(known["sinusoidal"][0], crs_wkt=grid_1936), "sinusoidal")}
for name, (attributes, same) in texts.items() if has_proj else ():
    _, longitude, latitude, x, y, within = known[same]
    path = projected("text " + name, attributes, x + numpy.array([0.0, 9000, 20000]), y + numpy.array([-7000.0, 0, 3000, 9000]))
    got, flat, there = on_sphere(path), Read(path), [0.0, 0.0]
    check(not got.error, f"{name}: {got.error}")
    if not got.error:
        off = numpy.linalg.norm(got.points[0, 1, 0] - place(longitude, latitude))
        check(off < 1.5 * within + 0.01, f"{name}: {off} m from its place on the sphere")
        check(flat.reader.FindPlace(longitude, latitude, there) and abs(there[0] - x) < within and abs(there[1] - y) < within,
              f"{name}: {there} instead of {x}, {y}")
if has_proj:
    check("'crs' (LAEA Europe)" in on_sphere(projected("named", dict(crs_wkt=europe_2), numpy.arange(3.0), numpy.arange(3.0))).description, "its name")
    path = projected("text rotated", dict(crs_wkt=rotated_2), numpy.linspace(-28, 18, 8), numpy.linspace(-23, 21, 6), "degrees", grid)
    lon, lat = turned(*numpy.meshgrid(numpy.linspace(-28, 18, 8), numpy.linspace(-23, 21, 6)), -162, 39.25)
    got = on_sphere(path)
    check(not got.error and near(got.points[0], place(lon, lat), 1e-9), f"a pole by WKT {got.error}")
    for name, text, words in (("no text", "nonsense", "'nonsense': "), ("no map", europe_2[europe_2.index("BASEGEOGCRS"):europe_2.index(",\nCONV")].replace(
            "BASEGEOGCRS", "GEOGCRS").replace("298.257222101]]]", '298.257222101]],CS[ellipsoidal,2],AXIS["lat",north],AXIS["lon",east],'
            'ANGLEUNIT["degree",0.0174532925199433]]'), "...': it is no map projection of the Earth")):
        path = projected(name, dict(crs_wkt=text), numpy.arange(3.0), numpy.arange(3.0))
        got, flat = on_sphere(path), Read(path)
        check("PROJ finds no projection in the text of the grid mapping 'crs'" in got.error and words in got.error, f"{name}: {got.error}")
        check(not flat.error and words in flat.reader.GetReasonWithoutPlaces(), f"{name}: the plane is read")

# Meshes of UGRID whose nodes are on a plane: the mapping is named by the variable, by the mesh, or by the coordinates of nodes.
attributes, longitude, latitude, x, y, within = known["lambert_azimuthal_equal_area"]
for name, owner, crs, units in (("by the variable", "q", attributes, "m"), ("by the mesh", "mesh", attributes, "m"), ("by coordinates", "x", attributes, "m"),
    ("by WKT", "q", dict(crs_wkt=europe_2), "m"), ("in kilometres", "q", {**attributes, "false_easting": 4321.0, "false_northing": 3210.0}, "km"),
    ("none", "", attributes, "m")):
    scale = 1000.0 if units == "km" else 1.0
    of = {one: {"grid_mapping": "crs"} if one == owner else {} for one in ("q", "mesh", "x")}
    path = write("mesh " + name, {"node": 4, "face": 2, "corner": 3, "layer": 2},
        mesh=("", numpy.int32(0), {"cf_role": "mesh_topology", "topology_dimension": numpy.int32(2), "node_coordinates": "x y",
                                   "face_node_connectivity": "faces", **of["mesh"]}),
        x=("node", (x + numpy.array([0.0, 9000, 0, 9000])) / scale, {"units": units, "standard_name": "projection_x_coordinate", **of["x"]}),
        y=("node", (y + numpy.array([0.0, 0, 8000, 8000])) / scale, {"units": units, "standard_name": "projection_y_coordinate"}),
        faces=("face corner", numpy.array([[0, 1, 2], [1, 3, 2]], "i4"), {"start_index": numpy.int32(0)}), crs=("", numpy.int32(0), crs),
        layer=("layer", numpy.array([500.0, 1500.0]), {"units": "m", "positive": "up", "axis": "Z"}),
        q=("layer face", numpy.arange(4, dtype="f4").reshape(2, 2), {"mesh": "mesh", "location": "face", **of["q"]}))
    flat, there = Read(path, cls="vtkStratusUgridReader"), [0.0, 0.0]
    check(flat.reader.GetNumberOfVariables() == 1, f"corners of faces are no values on the borders of layers: {flat.reader.GetNumberOfVariables()}")
    check(not flat.error and near(vtk_to_numpy(flat.data.GetPoints().GetData())[0], [x, y, 0], 1e-9), f"mesh {name}: the plane is the file's own")

    def prepare(reader):
        reader.SetCoordinatesToSphere()
        reader.SetHeightFactor(1)

    got = Read(path, cls="vtkStratusUgridReader", prepare=prepare)
    if not owner:
        check("no longitudes and latitudes, and no grid mapping that gives them" in got.error and not flat.reader.HasPlaces(), f"mesh: {got.error}")
    elif not has_proj:
        check("need PROJ, which this build lacks" in got.error and "need PROJ" in flat.reader.GetReasonWithoutPlaces(), f"mesh {name}: {got.error}")
    else:
        check(not got.error, f"mesh {name}: {got.error}")
        off = numpy.linalg.norm(vtk_to_numpy(got.data.GetPoints().GetData())[0] - place(longitude, latitude))
        check(off < 0.05 and "by the grid mapping 'crs' (" in got.description, f"mesh {name}: {off} m from its place, {got.description}")
        check(flat.reader.FindPlace(longitude, latitude, there) and abs(there[0] - x) < within and abs(there[1] - y) < within,
              f"mesh {name}: {there} on the plane")

# Longitudes and latitudes of two dimensions serve without PROJ, whatever the axes are, and whether or not there is a mapping.
rlon, rlat = numpy.linspace(-5, 5, 6), numpy.linspace(0, 4, 5)
lon, lat = numpy.meshgrid(rlon * 2 + 18, rlat + 50.75)
two = dict(lon=("y x", lon, {"units": "degrees_east"}), lat=("y x", lat, {"units": "degrees_north"}))
for name, attributes, units, standard in (
    ("about another pole", mapping("rotated_latitude_longitude", grid_north_pole_longitude=-162.0, grid_north_pole_latitude=39.25), "degrees",
     ("grid_longitude", "grid_latitude")), ("on an unknown plane", mapping("peirce"), "m", ("projection_x_coordinate", "projection_y_coordinate"))):
    path = projected("two dimensions " + name, attributes, rlon, rlat, units, standard, two, coordinates="lat lon")
    got = on_sphere(path)
    check(not got.error and near(got.points[0], place(lon, lat), 1e-9), f"longitudes and latitudes of the file {name} {got.error}")
    check(near(Read(path).points[0, 0, :, 0].ptp(), 10 if units == "m" else 10 * radius * numpy.pi / 180 * numpy.cos(numpy.radians(2)), 1e-6),
          f"the plane {name} stays the file's own")

# Refusals: what is wrong, and what is allowed.
lcc = known["lambert_conformal_conic, 2 parallels"][0]
without = {name: value for name, value in lcc.items() if name != "standard_parallel"}
for name, attributes, units, words in (
    ("unknown", mapping("peirce_quincuncial"), "m", ("'crs' (peirce_quincuncial) is none of the known ones: albers_conical_equal_area", "geostationary",
        "rotated_latitude_longitude", "transverse_mercator")),
    ("incomplete", without, "m", ("(lambert_conformal_conic) has 0 numbers in the attribute standard_parallel, must be 1 or 2",)),
    ("without a meridian", mapping("lambert_conformal_conic", standard_parallel=30.0, latitude_of_projection_origin=1.0), "m",
     ("has no attribute longitude_of_central_meridian or longitude_of_projection_origin",)),
    ("of another planet", dict(lcc, reference_ellipsoid_name="Mars"), "m", ("'mars'", "airy 1830", "wgs 84"))):
    path = projected(name, attributes, numpy.arange(3.0), numpy.arange(3.0), units)
    got, flat = on_sphere(path), Read(path)
    check(all(word in got.error for word in words), f"{name}: {got.error}")
    check(not flat.error and not flat.reader.HasPlaces() and words[0] in flat.reader.GetReasonWithoutPlaces(), f"{name}: the plane is read")
if has_proj:
    path = projected("refused by PROJ", dict(lcc, standard_parallel=[30.0, -30.0]), numpy.arange(3.0), numpy.arange(3.0))
    check("PROJ refuses the grid mapping 'crs' (lambert_conformal_conic)" in on_sphere(path).error, on_sphere(path).error)
    path = projected("in degrees", lcc, numpy.arange(3.0), numpy.arange(3.0), "degrees", ("grid_longitude", "grid_latitude"))
    check("(lambert_conformal_conic) needs lengths" in on_sphere(path).error, on_sphere(path).error)
finish()
