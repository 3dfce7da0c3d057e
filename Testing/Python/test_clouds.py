# SPDX-License-Identifier: BSD-3-Clause
"""stratus_volume.cloud: extinction by Beer's law, densities of air, the sun, and pictures by several ways to the same data."""
import datetime
import math
import os
import tempfile
import warnings

from checking import check, done, refuse

import numpy

import stratus_volume
from stratus_volume import Volume, cloud
from stratus_volume._cloud import _by_height, _function, _seconds, _sun
from stratus_volume._core import context as context_of

warnings.simplefilter("error")
context = context_of("host", 1)
host = dict(device="host", size=(48, 32), camera=dict(azimuth=20, elevation=15))


def water(content=2e-4):
    """Droplets in the middle of 10 x 8 x 9 values, z first."""
    values = numpy.zeros((10, 8, 9), numpy.float32)
    values[3:7, 2:6, 2:7] = content
    return values


def same(a, b, what):
    check(numpy.array_equal(numpy.asarray(a), numpy.asarray(b)), f"{what}: the same picture")


def functions():
    """Rays through 12 m of one content show Beer's law."""
    content, length = 2e-4, 12.0
    for factor, metres, radius, ice in ((1.0, 1.0, None, False), (1e-3, 1.0, 25.0, False), (1.0, 10.0, 8.0, True)):
        opacity, unit = _function(context, factor, metres, radius, ice)
        radius = 10.0 if radius is None else radius
        density = 917.0 if ice else 1000.0
        expected = 1.5 * content / (density * radius * 1e-6) * length * metres
        values = numpy.full((5, 13, 5), content / factor)  # 12 along y
        camera = dict(position=(2, -20, 2), focal_point=(2, 0, 2), view_up=(0, 0, 1), parallel_scale=1)
        drawn = stratus_volume.render(values, opacity, (1, 1, 1), (8, 8), camera, unit_distance=unit, device="host", quantities="transmittance")
        found = -numpy.log(drawn.quantities["transmittance"].astype(float))
        check(numpy.abs(found / expected - 1).max() < 0.002, f"depth {found.min()}..{found.max()}, by Beer's law {expected}")


def air():
    """The U.S. Standard Atmosphere 1976 in closed form below 11 km."""
    spacing, origin = (1, 1, 500), (0, 0, 1000)
    found = _by_height(context, water(), 1.0, dict(spacing=spacing, origin=origin, axes=None)).ravel()
    height = 1000 + 500 * numpy.arange(10)
    expected = 1.225 * (1 - 0.0065 * (6356766 * height / (6356766 + height)) / 288.15) ** 4.2558797
    check(numpy.abs(found / expected - 1).max() < 1e-4, f"densities {found}, {expected}")
    ratio = (water() / expected[:, None, None]).astype(numpy.float32)
    place = dict(spacing=(100, 100, 500), origin=(0, 0, 1000))
    apart = numpy.abs(cloud(ratio, units="kg/kg", **place, **host).astype(int) - cloud(water(), **place, **host).astype(int))
    check(apart.max() <= 1, "mixing ratios give the picture of their contents")
    same(cloud(water() / 0.5, units="kg kg-1", density=0.5, **place, **host), cloud(water(), **place, **host), "a density of .5")
    same(cloud(1000 * water(), units="g/m3", **place, **host), cloud(water(), **place, **host), "grams")


def sun():
    """Reda & Andreas 2004, table A5.1, without refraction."""
    moment, place = "2003-10-17T12:30:30-07:00", (39.742476, -105.1786)
    azimuth, elevation = _sun(context, None, moment, place)
    check(abs(azimuth - 194.3402) < 0.02 and abs(elevation - 39.8720) < 0.02, f"the sun at {azimuth}, {elevation}")
    wanted = _seconds(context, moment)
    zone = datetime.timezone(datetime.timedelta(hours=-7))
    for time in (datetime.datetime(2003, 10, 17, 12, 30, 30, tzinfo=zone), datetime.datetime(2003, 10, 17, 19, 30, 30),
                 numpy.datetime64("2003-10-17T19:30:30"), numpy.datetime64("2003-10-17T19:30:30.000000000")):
        check(_seconds(context, time) == wanted, f"{time!r} is {_seconds(context, time)}, not {wanted}")
    same(cloud(water(), time=moment, place=place, metres=50, **host), cloud(water(), sun=(azimuth, elevation), metres=50, **host), "the sun by time")
    check(not numpy.array_equal(cloud(water(), sun=(200, 10), metres=50, **host), cloud(water(), metres=50, **host)), "the sun moves")


def pictures():
    first = cloud(water(), metres=50, **host)
    check(first.shape == (32, 48, 4) and (first[..., 3] == 255).all() and int(first[..., :3].max()) - int(first[..., :3].min()) > 50, "a picture")
    check(first[0, 0, 2] > first[0, 0, 0] and first[0, 0, 2] != first[-1, 0, 2], "a blue sky that changes with height")
    same(cloud(Volume(water(), device="host"), metres=50, size=host["size"], camera=host["camera"]), first, "a Volume")
    clear = cloud(water(), metres=50, background=None, **host)
    check(clear[0, 0, 3] == 0 and clear[..., 3].max() > 250, "a transparent background")
    flat = cloud(water(), metres=50, background=(0.2, 0.4, 0.6), **host)
    check((flat[0, 0] == (51, 102, 153, 255)).all(), f"a background is shown as it is: {flat[0, 0]}")
    for change in dict(radius=40), dict(ice=True), dict(albedo=0.5), dict(anisotropy=0), dict(metres=20), dict(background=(0, 0, 0)):
        check(not numpy.array_equal(cloud(water(), **{**dict(metres=50), **host, **change}), first), f"{change} changes the picture")


def of_xarray():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of packages that other versions of NumPy compiled
        try:
            import xarray
        except ImportError:
            print("no xarray: data of xarray are not tested")
            return
        try:
            import netCDF4  # noqa: F401
        except ImportError:
            pass
    axes = dict(z=("z", 40.0 * numpy.arange(10), dict(units="m")), y=("y", 0.05 * numpy.arange(8), dict(units="km")),
                x=("x", 0.05 * numpy.arange(9), dict(units="km")))
    array = xarray.DataArray(1000 * water(), dims=("z", "y", "x"), coords=axes, name="qc", attrs=dict(units="g m-3"))
    wanted = cloud(water(), spacing=(50, 50, 40), **host)
    apart = numpy.abs(cloud(array, **host).astype(int) - wanted.astype(int))
    check(apart.max() <= 1, f"a DataArray of kilometres and grams: {apart.max()}")
    density = xarray.DataArray(numpy.full(10, 0.5), dims=("z",), attrs=dict(standard_name="air_density", units="kg m-3"))
    ratios = array.copy(data=2000 * water())
    ratios.attrs["units"] = "g kg-1"
    file = xarray.Dataset(dict(qr=ratios * 0, qc=ratios, rho=density))
    file["qc"].attrs.update(units="g kg-1")
    apart = numpy.abs(cloud(file, **host).astype(int) - wanted.astype(int))
    check(apart.max() <= 1, f"a Dataset with a density: {apart.max()}")
    times = numpy.array(["2003-10-17T06:00", "2003-10-17T19:30:30"], "datetime64[ns]")
    film = xarray.concat([file * 0, file], dim=xarray.Variable("time", times), combine_attrs="override")
    for name, array in film.data_vars.items():
        array.attrs.update(file[name].attrs)
    film = film.transpose("time", "z", "y", "x")
    same(cloud(film, step=1, **host), cloud(file, **host), "a step of a Dataset")
    same(cloud(film["qc"].isel(z=slice(None)), step=-1, density=0.5, **host), cloud(file, **host), "a step of a DataArray")
    by_time = cloud(film, step=1, place=(39.742476, -105.1786), **host)
    same(by_time, cloud(file, time=times[1], place=(39.742476, -105.1786), **host), "the sun at the step's time")
    refuse(ValueError, "step, along 'time', is 2, it must be a whole number in -2..1", cloud, film, step=2)
    refuse(ValueError, "no variable of the Dataset is known", cloud, file[["qr"]].rename(qr="rain"))
    refuse(ValueError, "variable is 'qx', it must be one of", cloud, file, variable="qx")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "les.nc")
        try:
            file.to_netcdf(path)
        except (ValueError, ImportError, AttributeError) as error:
            print("xarray can't write netCDF:", error)
        else:
            same(cloud(path, **host), cloud(file, **host), "a file")


def refusals():
    small = dict(device="host", size=(8, 8))
    refuse(ValueError, "units is 'K', it must be a mass of water", cloud, water(), units="K", **small)
    refuse(ValueError, "effective radius 0.01 um, must be in 0.1..10000 um", cloud, water(), radius=0.01, **small)
    refuse(TypeError, "radius is 'big'", cloud, water(), radius="big", **small)
    refuse(ValueError, "metres is -1", cloud, water(), metres=-1, **small)
    refuse(ValueError, "density has the shape (3,)", cloud, water(), units="kg/kg", density=numpy.ones(3), **small)
    refuse(ValueError, "density is for values by the mass of air", cloud, water(), density=1.0, **small)
    refuse(ValueError, "time= and place=", cloud, water(), time="2024-06-01", **small)
    refuse(ValueError, "time= and place=", cloud, water(), sun=(1, 2), time="2024-06-01", place=(1, 2), **small)
    refuse(ValueError, "degrees below the horizon", cloud, water(), time="2024-06-01 00:00", place=(0, 0), **small)
    refuse(ValueError, "latitude 91 degrees", cloud, water(), time="2024-06-01 00:00", place=(91, 0), **small)
    refuse(ValueError, "is no moment like", cloud, water(), time="noon", place=(0, 0), **small)
    refuse(TypeError, "it must be a text, a datetime", cloud, water(), time=object(), place=(0, 0), **small)
    refuse(ValueError, "elevation of the sun 95 degrees", cloud, water(), sun=(0, 95), **small)
    refuse(ValueError, "must be in kg/m3", cloud, Volume(water(), device="host"), units="kg/kg")
    refuse(ValueError, "height 81000 m in the standard atmosphere", cloud, water(), units="kg/kg", origin=(0, 0, 81000), **small)


functions()
air()
sun()
pictures()
of_xarray()
refusals()
check(math.isclose(stratus_volume._declarations.STRATUS_CLOUD_ANISOTROPY, 0.85), "the anisotropy of the headers")
done()
