# SPDX-License-Identifier: BSD-3-Clause
"""Small files in the layouts of models and instruments, each with a subject that a first picture should show. Needs netCDF4."""
import os

import netCDF4
import numpy

from geodesic import degrees_of, icon, icosphere, middles, mpas, rotation


def noise(shape, seed, steepness=2.0):
    """A random field of mean 0 and deviation 1 whose amplitudes fall with the wave number."""
    spectrum = numpy.fft.rfftn(numpy.random.default_rng(seed).standard_normal(shape))
    waves = [numpy.fft.fftfreq(n) * n for n in shape[:-1]] + [numpy.fft.rfftfreq(shape[-1]) * shape[-1]]
    length = numpy.sqrt(sum(wave**2 for wave in numpy.meshgrid(*waves, indexing="ij")))
    length.flat[0] = numpy.inf
    field = numpy.fft.irfftn(spectrum * length**-steepness, shape)
    return field / field.std()


def netcdf(folder, name, dimensions, variables, **attributes):
    """variables: name=(dimensions, values, attributes, or fill among them)."""
    path = os.path.join(folder, name + ".nc")
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(attributes)
        for dimension, size in dimensions.items():
            file.createDimension(dimension, size)
        for variable, (of, values, own) in variables.items():
            own, values = dict(own), numpy.asarray(values)
            made = file.createVariable(variable, values.dtype, of.split(), fill_value=own.pop("fill", None))
            made.setncatts(own)
            made[...] = values
    return path


def roms(folder):
    """ROMS: a front on a curved shelf, s-coordinates with formula_terms, curvilinear longitudes and latitudes."""
    n, ny, nx = 20, 50, 70
    eta, xi = numpy.meshgrid(numpy.arange(ny), numpy.arange(nx), indexing="ij")
    lon, lat = -74 + 0.05 * xi + 0.02 * eta, 36 + 0.05 * eta - 0.015 * xi
    h = 40 + 2500 / (1 + numpy.exp(-(xi - 38 - 4 * numpy.sin(eta / 7)) / 4))
    s = (numpy.arange(n) - n + 0.5) / n
    curve = (1 - numpy.cosh(5 * s)) / (numpy.cosh(5) - 1)
    z = h * (10 * s[:, None, None] + curve[:, None, None] * h) / (10 + h)
    front = xi - 30 - 7 * numpy.sin(eta / 9)
    temperature = 8 + 8 / (1 + numpy.exp(-front / 4)) * numpy.exp(z / 500) + 3 * numpy.exp(z / 60) + 0.4 * noise(z.shape, 2)
    terms = dict(standard_name="ocean_s_coordinate_g2", formula_terms="s: s_rho C: Cs_r eta: zeta depth: h depth_c: hc", positive="up")
    return netcdf(folder, "roms", dict(ocean_time=1, s_rho=n, eta_rho=ny, xi_rho=nx), dict(
        ocean_time=("ocean_time", [0.0], dict(units="seconds since 2020-01-01")), s_rho=("s_rho", s, terms), Cs_r=("s_rho", curve, {}), hc=("", 10.0, {}),
        h=("eta_rho xi_rho", h, dict(units="meter")), zeta=("ocean_time eta_rho xi_rho", 0 * h[None], dict(units="meter")),
        lon_rho=("eta_rho xi_rho", lon, dict(units="degree_east", standard_name="longitude")),
        lat_rho=("eta_rho xi_rho", lat, dict(units="degree_north", standard_name="latitude")),
        temp=("ocean_time s_rho eta_rho xi_rho", temperature[None].astype("f4"), dict(long_name="potential temperature", units="Celsius",
            coordinates="lon_rho lat_rho s_rho ocean_time"))))


def wrf(folder):
    """WRF: a squall line's cloud water on staggered geopotential over hills."""
    nz, ny, nx = 24, 60, 60
    y, x = numpy.meshgrid(numpy.arange(ny), numpy.arange(nx), indexing="ij")
    hills = 900 * numpy.exp(-((x - 12) / 7.0) ** 2)
    edge = numpy.linspace(0, 1, nz + 1)[:, None, None] ** 1.4
    stagger = hills + edge * (16000 - hills)
    z = 0.5 * (stagger[1:] + stagger[:-1])
    line = x - 33 - 5 * numpy.sin(y / 9)
    water = 2e-3 * numpy.exp(-((line + (z - 2000) / 3000) / 4) ** 2 - ((z - 4500) / 2500) ** 2) * (1 + 0.7 * noise(z.shape, 4, 1.7)).clip(0)
    water[water < 2e-6] = 0
    lon, lat = -98 + x * 0.04, 36 + y * 0.03
    return netcdf(folder, "wrf", dict(Time=1, bottom_top=nz, bottom_top_stag=nz + 1, south_north=ny, west_east=nx, DateStrLen=19), dict(
        Times=("Time DateStrLen", numpy.array([list("2020-06-01_12:00:00")], "S1"), {}),
        XLAT=("Time south_north west_east", lat[None].astype("f4"), dict(units="degree_north", description="LATITUDE, SOUTH IS NEGATIVE")),
        XLONG=("Time south_north west_east", lon[None].astype("f4"), dict(units="degree_east", description="LONGITUDE, WEST IS NEGATIVE")),
        PH=("Time bottom_top_stag south_north west_east", 0 * stagger[None].astype("f4"), dict(units="m2 s-2", stagger="Z")),
        PHB=("Time bottom_top_stag south_north west_east", 9.81 * stagger[None].astype("f4"), dict(units="m2 s-2", stagger="Z")),
        QCLOUD=("Time bottom_top south_north west_east", water[None].astype("f4"), dict(description="Cloud water mixing ratio", units="kg kg-1",
            coordinates="XLONG XLAT"))), TITLE=" OUTPUT FROM WRF V4.2 MODEL", DX=4000.0, DY=4000.0)


def mitgcm(folder):
    """MITgcm: a current along the equator, on cells' faces."""
    z, y, x = -numpy.array([5, 15, 30, 50, 75, 105, 140, 180, 230, 290, 360, 440.]), numpy.linspace(-12, 12, 48), numpy.linspace(180, 270, 90)
    d, n, e = z[:, None, None], y[None, :, None], x[None, None, :]
    under = 1.0 * numpy.exp(-(n / 1.6) ** 2 - ((d + 160 - (e - 180)) / 55) ** 2)
    south = -0.6 * numpy.exp(-((abs(n - 0.5 * numpy.sin(e / 6)) - 3.5) / 2.2) ** 2 + d / 40)
    return netcdf(folder, "mitgcm", dict(T=1, Z=len(z), YC=len(y), XG=len(x)), dict(
        T=("T", [0.0], dict(units="s", long_name="model_time")), Z=("Z", z, dict(units="meters", positive="up", long_name="vertical coordinate of cell center")),
        YC=("YC", y, dict(units="degrees_north", standard_name="latitude")), XG=("XG", x, dict(units="degrees_east", standard_name="longitude")),
        UVEL=("T Z YC XG", (under + south + 0.05 * noise(under.shape, 8))[None].astype("f4"), dict(units="m s-1", standard_name="eastward_sea_water_velocity"))))


def nemo(folder):
    """NEMO: salinity of a basin with an outflow in depth, on levels downwards, with land."""
    depth = numpy.geomspace(5, 3000, 28)
    lat, lon = numpy.meshgrid(numpy.linspace(32, 44, 50), numpy.linspace(-14, 2, 70), indexing="ij")
    d, e, n = depth[:, None, None], lon[None], lat[None]
    outflow = 1.3 * numpy.exp(-((d - 1000) / 350) ** 2 - ((n - 36.5 - 0.2 * (-6 - e)) / (0.8 + 0.15 * (-6 - e).clip(0))) ** 2 - (-6 - e).clip(0) / 8) * (e < -5.5)
    salt = 35.4 + 2.4 / (1 + numpy.exp(-(e + 5) * 3)) + outflow - 0.2 * d / 3000 + 0.03 * noise(outflow.shape, 9)
    land = (n > 37 + 0.8 * numpy.sin(e)) & (e > -9 + 0.2 * n - 8) | (n < 35.6) & (e > -6.5) | (d > 3200 - 250 * abs(e + 10)) | ((e > -6.5) & (e < -5) & (d > 300))
    return netcdf(folder, "nemo", dict(time_counter=1, deptht=28, y=50, x=70), dict(
        time_counter=("time_counter", [0.0], dict(units="seconds since 1950-01-01", standard_name="time")),
        deptht=("deptht", depth, dict(units="m", positive="down", long_name="Vertical T levels")),
        nav_lon=("y x", lon.astype("f4"), dict(units="degrees_east", standard_name="longitude")),
        nav_lat=("y x", lat.astype("f4"), dict(units="degrees_north", standard_name="latitude")),
        vosaline=("time_counter deptht y x", numpy.where(land, 1e20, salt)[None].astype("f4"), dict(fill=numpy.float32(1e20), units="PSU",
            long_name="salinity", coordinates="time_counter deptht nav_lat nav_lon"))))


def cm1(folder):
    """CM1: rain and hail of a storm, as radars see it: dBZ in kilometres, -35 without any."""
    z, y, x = numpy.meshgrid(numpy.linspace(0.1, 15, 40), numpy.linspace(0, 60, 60), numpy.linspace(0, 60, 60), indexing="ij")
    hook = (x - 30 - 6 * numpy.sin(y / 9) - 0.6 * z) / (3.5 + 0.4 * z)
    rain = 1e5 * numpy.exp(-(hook**2 + ((y - 30) / 13) ** 2 + ((z - 3) / 5) ** 2) ** 1.5 + 0.9 * noise(z.shape, 11, 1.8))
    dbz = numpy.maximum(10 * numpy.log10(rain + 10**-3.5), -35)
    return netcdf(folder, "cm1-radar", dict(time=1, zh=40, yh=60, xh=60), dict(time=("time", [3600.0], dict(units="s")),
        zh=("zh", z[:, 0, 0], dict(units="km")), yh=("yh", y[0, :, 0], dict(units="km")), xh=("xh", x[0, 0], dict(units="km")),
        dbz=("time zh yh xh", dbz[None].astype("f4"), dict(units="dBZ", long_name="reflectivity"))))


def sky(longitude, latitude, height):
    """Cloud water around the Earth: fronts and the tropics."""
    fronts = sum(numpy.exp(-((numpy.sin(latitude) - side * (0.65 + 0.2 * numpy.sin(waves * longitude + 1))) / 0.07) ** 2) for side, waves in ((1, 3), (-1, 4)))
    tropics = numpy.exp(-((latitude - 0.12 * numpy.sin(2 * longitude)) / 0.09) ** 2) * (1 + numpy.sin(5 * longitude) * numpy.sin(3 * longitude + 1)).clip(0)
    return 6e-4 * (fronts + tropics) * numpy.exp(-((height - 3500) / 1800) ** 2)


BORDERS = numpy.array([0, 400, 900, 1500, 2300, 3300, 4500, 6000, 8000, 11000.])
HEIGHTS = 0.5 * (BORDERS[1:] + BORDERS[:-1])


def mpas_atmosphere(folder):
    """MPAS: cloud water on hexagons around the Earth."""
    points, triangles = icosphere(4, rotation(11, 23, 37))
    dimensions, mesh = mpas(points, triangles)
    lon, lat = numpy.radians(degrees_of(points))
    water = sky(lon[:, None], lat[:, None], HEIGHTS)
    return netcdf(folder, "mpas", dict(dimensions, Time=1, nVertLevels=9, nVertLevelsP1=10), dict(mesh,
        zgrid=("nCells nVertLevelsP1", numpy.tile(BORDERS, (len(points), 1)), dict(units="m")),
        qc=("Time nCells nVertLevels", water[None].astype("f4"), dict(units="kg kg^{-1}", long_name="Cloud water mixing ratio"))), on_a_sphere="YES")


def icon_atmosphere(folder):
    """ICON: temperature on triangles around the Earth."""
    points, triangles = icosphere(4, rotation(3, 5, 7))
    dimensions, mesh = icon(points, triangles)
    lon, lat = numpy.radians(degrees_of(middles(points, triangles)))
    height = HEIGHTS[::-1, None]
    temperature = 300 - 45 * numpy.sin(lat) ** 2 - 6.5e-3 * height + 4 * numpy.sin(3 * lon) * numpy.cos(lat)
    return netcdf(folder, "icon", dict(dimensions, time=1, height=9, height_2=10), dict(mesh,
        time=("time", [0.0], dict(units="hours since 2020-06-01", standard_name="time")),
        height=("height", numpy.arange(1.0, 10), dict(standard_name="height", long_name="generalized_height", axis="Z")),
        z_ifc=("height_2 ncells", numpy.tile(BORDERS[::-1, None], (1, len(triangles))), dict(units="m", standard_name="geometric_height_at_half_level_center")),
        temp=("time height ncells", temperature[None].astype("f4"), dict(units="K", standard_name="air_temperature", coordinates="clat clon"))))


def lake(folder):
    """UGRID: a pollutant in a lake of triangles in sigma layers, spilt at one shore, on the plane of UTM zone 32."""
    rings, spokes, layers = 22, 60, 8
    radius, angle = numpy.meshgrid(numpy.linspace(0.02, 1, rings), 2 * numpy.pi * numpy.arange(spokes) / spokes, indexing="ij")
    shape = 1 + 0.25 * numpy.sin(2 * angle) + 0.1 * numpy.cos(5 * angle)
    x, y = (500e3 + 9000 * radius * shape * numpy.cos(angle)).ravel(), (5270e3 + 4000 * radius * shape * numpy.sin(angle)).ravel()
    faces = []
    for i in range(rings - 1):
        for j in range(spokes):
            a, b, c, d = i * spokes + j, (i + 1) * spokes + j, (i + 1) * spokes + (j + 1) % spokes, i * spokes + (j + 1) % spokes
            faces += [(a, b, c), (a, c, d)]
    depth = 8 + 110 * (1 - radius.ravel() ** 2)
    sigma = -(numpy.arange(layers) + 0.5) / layers
    away = numpy.hypot(x - 505e3, 1.5 * (y - 5271.5e3)) / 1000
    spill = 3e-3 * numpy.exp(-(away / 2.2) ** 2 + 3 * sigma[:, None]) + 2e-4 * numpy.exp(-(numpy.hypot(x - 501e3, y - 5270e3) / 2500) ** 2 + 2 * sigma[:, None])
    utm = dict(grid_mapping_name="transverse_mercator", longitude_of_central_meridian=9.0, latitude_of_projection_origin=0.0,
        scale_factor_at_central_meridian=0.9996, false_easting=500e3, false_northing=0.0, reference_ellipsoid_name="WGS 84")
    return netcdf(folder, "lake", dict(node=len(x), face=len(faces), corner=3, layer=layers), dict(
        mesh=("", numpy.int32(0), dict(cf_role="mesh_topology", topology_dimension=numpy.int32(2), node_coordinates="x y", face_node_connectivity="faces")),
        x=("node", x, dict(units="m", standard_name="projection_x_coordinate")), y=("node", y, dict(units="m", standard_name="projection_y_coordinate")),
        faces=("face corner", numpy.array(faces, "i4"), dict(start_index=numpy.int32(0))), utm=("", numpy.int32(0), utm),
        sigma=("layer", sigma, dict(standard_name="ocean_sigma_coordinate", formula_terms="sigma: sigma eta: eta depth: depth", positive="up")),
        eta=("node", 0 * x, dict(units="m", standard_name="sea_surface_height_above_geoid")),
        depth=("node", depth, dict(units="m", standard_name="sea_floor_depth_below_geoid")),
        nitrate=("layer node", spill.astype("f4"), dict(units="kg m-3", standard_name="mass_concentration_of_nitrate_in_water", mesh="mesh", location="node",
            grid_mapping="utm"))))


def dispersion(folder):
    """A particle model's plume, as HYSPLIT has it: zeros but for some per cent, over many decades."""
    z, y, x = numpy.meshgrid(numpy.linspace(50, 5000, 20), numpy.linspace(40, 52, 70), numpy.linspace(-5, 20, 90), indexing="ij")
    age = (x + 3).clip(1e-3)
    middle = 43.5 + 2.2 * numpy.log1p(age) + 0.8 * numpy.sin(age / 3)
    plume = 1e-11 / age**1.5 * numpy.exp(-((y - middle) / (0.15 + 0.13 * age)) ** 2 - ((z - 600 - 90 * age) / (300 + 80 * age)) ** 2 + 0.8 * noise(z.shape, 13))
    plume[(plume < 3e-15) | (x < -3)] = 0
    return netcdf(folder, "dispersion", dict(time=1, levels=20, latitude=70, longitude=90), dict(
        time=("time", [0.0], dict(units="hours since 2020-03-01", standard_name="time")), levels=("levels", z[:, 0, 0], dict(units="m", positive="up")),
        latitude=("latitude", y[0, :, 0], dict(units="degrees_north")), longitude=("longitude", x[0, 0], dict(units="degrees_east")),
        C137=("time levels latitude longitude", plume[None].astype("f4"), dict(units="kg m-3", long_name="caesium 137"))))


def aerosol(folder):
    """Sulphate of an air quality model: lognormal, as mixing makes it, on a Lambert conformal plane."""
    shape = (20, 60, 80)
    z, y, x = numpy.linspace(50, 9000, 20), numpy.linspace(-1.2e6, 1.2e6, 60), numpy.linspace(-1.6e6, 1.6e6, 80)
    values = 3e-9 * numpy.exp(1.4 * noise(shape, 21, 2.3) - z[:, None, None] / 3500)
    crs = dict(grid_mapping_name="lambert_conformal_conic", standard_parallel=[30.0, 60.0], longitude_of_central_meridian=10.0,
        latitude_of_projection_origin=50.0)
    return netcdf(folder, "aerosol", dict(z=20, y=60, x=80), dict(z=("z", z, dict(units="m", positive="up", standard_name="height")), crs=("", numpy.int32(0), crs),
        y=("y", y, dict(units="m", standard_name="projection_y_coordinate")), x=("x", x, dict(units="m", standard_name="projection_x_coordinate")),
        so4=("z y x", values.astype("f4"), dict(units="kg kg-1", grid_mapping="crs", standard_name="mass_fraction_of_sulfate_dry_aerosol_particles_in_air"))))


def seismic(folder):
    """Reflections of layers that a fault breaks, in milliseconds downwards."""
    t, y, x = numpy.meshgrid(numpy.arange(0, 800, 8.0), numpy.arange(60) * 25.0, numpy.arange(80) * 25.0, indexing="ij")
    moved = t + 60 * (x > 900 + 0.3 * y) + 40 * numpy.sin(x / 500) * numpy.cos(y / 600)
    trace = sum(strength * (1 - 2 * ((moved - at) / 14) ** 2) * numpy.exp(-((moved - at) / 14) ** 2)
                for at, strength in ((180, 1), (300, -0.6), (390, 0.8), (520, -1), (660, 0.7)))
    return netcdf(folder, "seismic", dict(twt=100, iline=60, xline=80), dict(twt=("twt", t[:, 0, 0], dict(units="ms", positive="down")),
        iline=("iline", y[0, :, 0], dict(units="m")), xline=("xline", x[0, 0], dict(units="m")),
        amplitude=("twt iline xline", (trace + 0.08 * noise(t.shape, 15, 0.5)).astype("f4"), dict(long_name="amplitude"))))


def ct(folder):
    """A scan in Hounsfield units: air, skin, tissue and bones."""
    z, y, x = numpy.meshgrid(*(numpy.linspace(-1, 1, n) for n in (64, 72, 72)), indexing="ij")
    body, skull = numpy.sqrt((x / 0.75) ** 2 + (y / 0.9) ** 2 + (z / 0.95) ** 2), numpy.sqrt((x / 0.62) ** 2 + (y / 0.76) ** 2 + ((z - 0.08) / 0.78) ** 2)
    values = numpy.where(body < 1, 40.0, -1000.0) + 12 * noise(z.shape, 17, 1.0)
    eyes = numpy.minimum(numpy.hypot(numpy.hypot(x - 0.26, y + 0.72), z - 0.1), numpy.hypot(numpy.hypot(x + 0.26, y + 0.72), z - 0.1))
    values[(abs(skull - 0.95) < 0.06) & (eyes > 0.17) & (z > -0.5)] = 1100
    path = os.path.join(folder, "ct.nrrd")
    with open(path, "wb") as file:
        file.write(b"NRRD0004\ntype: short\ndimension: 3\nsizes: 72 72 64\nspacings: 2.5 2.5 3\nencoding: raw\nendian: little\n\n")
        file.write(values.clip(-1024, 3000).astype("<i2").tobytes())
    return path


ALL = (roms, wrf, mitgcm, nemo, cm1, mpas_atmosphere, icon_atmosphere, lake, dispersion, aerosol, seismic, ct)


def write_all(folder):
    """Writes the files, and returns their paths."""
    return [write(folder) for write in ALL]
