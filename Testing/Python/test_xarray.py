#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""xarray's accessors `.stratus`: axes by attributes and names, coordinates and units as in `show`, lazy arrays that are computed once, and errors."""
from checking import ball, check, done, refuse

import os
import subprocess
import sys
import tempfile

import numpy
from stratus_volume import Volume, render, show
from stratus_volume import _pages
from stratus_volume._dimensions import computed, space_axes_of

try:
    import xarray
except ImportError:
    print("SKIPPED: no xarray")
    sys.exit(77)
import stratus_volume.xarray  # noqa: F401  registers the accessors

host = dict(device="host", size=(60, 45))
points = [(0, 0), (1, 0.5)]
field = ball((12, 20, 24), (6, 8, 15), 6)


def along(dim, values, **attrs):
    return (dim,), numpy.asarray(values, float), attrs


def array_of(values=field, dims=("z", "y", "x"), name="qc", **attrs):
    return xarray.DataArray(values, dims=dims, name=name, attrs=attrs)


def accessors():
    array = array_of(units="kg kg-1").assign_coords(z=along("z", numpy.arange(12) ** 1.5, units="m"), y=along("y", numpy.arange(20), units="m"),
                                                    x=along("x", numpy.arange(24), units="m"))
    check(numpy.array_equal(array.stratus.show(**host), show(array, **host)), "show")
    own, wanted = array.stratus.render(points, quantities="integral", **host), render(array, points, quantities="integral", **host)
    check(numpy.array_equal(own.rgba, wanted.rgba) and own.rgba.max() > 0.1, "render")
    check(own.quantities["integral"].attrs["units"] == wanted.quantities["integral"].attrs["units"] != "", "units are those of the data")
    data = xarray.Dataset(dict(qc=array, flat=array[0], t=array + 1))
    check(numpy.array_equal(data.stratus.show("qc", **host), show(array, **host)), "show of a Dataset")
    check(numpy.array_equal(data.qc.stratus.render(**host).rgba, data.stratus.render("qc", **host).rgba), "render of a Dataset")
    refuse(ValueError, "no variable 'qv', it must be one of ['qc', 't']", data.stratus.show, "qv")
    refuse(ValueError, "three", data.stratus.show, "flat")
    for kind in xarray.DataArray.stratus, xarray.Dataset.stratus:
        for function in kind.show, kind.render:
            check(len(function.__doc__) > 50, f"{function} is described")
    program = "import sys, stratus_volume; sys.exit('xarray' in sys.modules)"
    check(subprocess.run([sys.executable, "-c", program]).returncode == 0, "the package itself does not import xarray")


def meshes():
    """Datasets with a mesh and with a lattice on a globe."""
    sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
    from geodesic import icon, icosphere
    points, triangles = icosphere(2)
    count = len(triangles)
    parts = dict(icon(points, triangles)[1], z_ifc=("height_2 ncells", numpy.tile([[9000.0], [4000], [0]], (1, count)), {"units": "m"}),
                 q=("time height ncells", numpy.arange(2.0 * count).reshape(1, 2, count), {"units": "K"}))
    data = xarray.Dataset({name: (dims.split(), values, attrs) for name, (dims, values, attrs) in parts.items()})
    wanted = show(data, scalars="q", globe=True, **host)
    check(wanted.std() > 10 and wanted.caption == "heights x 70.79", f"a picture of a mesh: {wanted.caption}")
    check(numpy.array_equal(data.stratus.show("q", globe=True, **host), wanted), "show of a Dataset with a mesh")
    check(numpy.array_equal(data.stratus.render("q", globe=True, **host).rgba, render(data, scalars="q", globe=True, **host).rgba), "render")
    refuse(ValueError, "no variable 'p', it must be one of ['clat_bnds', 'clon_bnds', 'q', 'z_ifc']", data.stratus.show, "p", globe=True)
    flat = data.stratus.show("q", **host)  # on a plane, cut at a meridian
    check(flat.std() > 10 and not numpy.array_equal(flat, wanted), "a mesh round the Earth on a plane")
    lattice = xarray.Dataset(dict(t=array_of(dims=("z", "lat", "lon"))), dict(z=along("z", numpy.arange(12.0), units="m"),
        lat=along("lat", numpy.arange(20.0), units="degrees_north"), lon=along("lon", numpy.arange(24.0), units="degrees_east")))
    check(numpy.array_equal(lattice.stratus.show("t", globe=True, **host), show(lattice.t, globe=True, **host)), "a Dataset of a lattice")


def axes():
    """Shuffled dimensions whose names say nothing are drawn as the same data in the usual order."""
    usual = render(array_of(), points, **host).rgba
    attributes = {"axis": (dict(axis="Z"), dict(axis="Y"), dict(axis="X")),
                  "standard_name": (dict(standard_name="height"), dict(standard_name="projection_y_coordinate"), dict(standard_name="projection_x_coordinate")),
                  "positive": (dict(positive="up"), dict(standard_name="grid_latitude"), dict(axis="x"))}
    for what, own in attributes.items():
        coordinates = {name: along(name, numpy.arange(n), **attrs) for name, n, attrs in zip(("a", "b", "c"), field.shape, own)}
        array = array_of(dims=("a", "b", "c")).assign_coords(coordinates).transpose("b", "c", "a")
        check(space_axes_of(array) == ["y", "x", "z"], f"axes by {what}: {space_axes_of(array)}")
        check(numpy.abs(array.stratus.render(points, **host).rgba - usual).max() < 3e-3, f"drawn by {what}")
    units = array_of(dims=("a", "b", "c")).assign_coords(a=along("a", numpy.arange(12) * 50 + 100, units="hPa"), b=along("b", numpy.arange(20), units="degrees_north"),
                                                         c=along("c", numpy.arange(24), units="degrees_east"))
    check(space_axes_of(units.transpose("c", "a", "b")) == ["x", "z", "y"], "axes by units")
    check(space_axes_of(array_of(dims=("member", "lon", "lat"))) == ["z", "x", "y"], "one that is unknown is the axis that is left")
    check(space_axes_of(array_of(dims=("a", "b", "c"))) == ["z", "y", "x"], "nothing is known")
    beside = array_of(dims=("k", "j", "i")).assign_coords(altitude=along("k", numpy.arange(12) * 3, units="m", axis="Z"),
                                                          north=along("j", numpy.arange(20), units="m", axis="Y"),
                                                          east=along("i", numpy.arange(24), units="m", axis="X"))
    check(Volume(beside, device="host").bounds == (0, 23, 0, 19, 0, 33), f"coordinates of other names than the dimensions: {Volume(beside).bounds}")
    curved = array_of(dims=("k", "j", "i")).assign_coords(lon=(("j", "i"), numpy.ones((20, 24))), lat=(("j", "i"), numpy.ones((20, 24))))
    check(Volume(curved, device="host").bounds == (0, 23, 0, 19, 0, 11), "without coordinates of one dimension points are at their indices")


def wrong():
    film = xarray.DataArray(numpy.stack([field, field]), dims=("time", "z", "y", "x"))
    refuse(ValueError, ".isel(time=0)", film.stratus.show)
    refuse(ValueError, ".isel(time=0, member=0)", film.expand_dims("member").stratus.render)
    for times in numpy.arange(12).astype("datetime64[h]"), numpy.arange(12.0):
        step = dict(step=("step", times, dict(axis="T") if times.dtype.kind == "f" else {}))
        array = array_of(dims=("step", "lat", "lon")).assign_coords(step)
        refuse(ValueError, "'step' is time", array.stratus.show)
        check(array.stratus.render(points, axes="zyx", **host).rgba.max() > 0.1, "time as an axis")
    refuse(ValueError, "['z', 'height'] are both along z", array_of(dims=("z", "height", "x")).stratus.show)
    refuse(ValueError, "must have three", array_of(field[0], ("lat", "lon")).stratus.show)
    refuse(TypeError, "complex128", array_of(field.astype(complex)).stratus.show)


def lazy():
    try:
        import dask.array
    except ImportError:
        print("without dask: lazy arrays are not tested")
        return
    counted = []

    def chunk(block):
        counted.append(block.shape)
        return block
    for kind, needed in ("<f8", "<f8"), (">f4", "<f4"), ("<f2", "<f4"), ("?", "u1"), (">i2", "<i2"):
        values = (100 * field if kind == ">i2" else field).astype(kind)
        counted.clear()
        array = array_of(dask.array.from_array(values, chunks=(6, 20, 12)).map_blocks(chunk, dtype=values.dtype, meta=numpy.empty((0, 0, 0), values.dtype)))
        drawn = Volume(array, device="host")
        check(len(counted) == 4, f"{kind}: each of 4 chunks is computed once: {counted}")
        check(drawn.grid.values.dtype == numpy.dtype(needed), f"{kind} is computed as {drawn.grid.values.dtype}")
        check(numpy.array_equal(drawn.render(points, size=host["size"]).rgba, render(values, points, **host).rgba), f"{kind}: the picture")
    filled = array_of(dask.array.from_array(numpy.where(field < 0.3, -999, field), chunks=6), _FillValue=-999)
    check(numpy.array_equal(filled.stratus.render(points, **host).rgba, render(numpy.where(field < 0.3, numpy.nan, field), points, **host).rgba), "fill values")
    masked = array_of(dask.array.ma.masked_less(dask.array.from_array(field, chunks=6), 0.3))
    check(numpy.array_equal(masked.stratus.render(points, **host).rgba, render(numpy.ma.masked_less(field, 0.3), points, **host).rgba), "masks")
    counted.clear()
    large = array_of(dask.array.zeros((200000,) * 3, dtype="f4", chunks=20000).map_blocks(chunk, dtype="f4", meta=numpy.empty((0, 0, 0), "f4")))
    refuse(MemoryError, "'qc' is lazy, and its 200000 x 200000 x 200000 values of type float32 need 29802322.4 GiB, but", large.stratus.show)
    refuse(TypeError, "complex64", large.astype("c8").stratus.show)
    check(not counted, "nothing of it is computed")


def of_file():
    """Values that xarray reads from a file when they are first needed are read in parts if they do not fit in memory."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "field.nc")
        try:
            array_of(units="kg kg-1").to_dataset().to_netcdf(path)
        except (ImportError, ValueError) as error:
            print("xarray can't write netCDF:", error)
            return
        free = _pages.free_memory
        check(free() > 2**24, f"{free()} bytes of memory are free")
        with xarray.open_dataset(path) as data:
            wanted = array_of(units="kg kg-1").stratus.show(**host)
            _pages.free_memory = lambda: 2**14
            refuse(MemoryError, "but 0.0 MiB of memory are free", computed, data.qc)
            if _pages.pool().report.paged:
                check(numpy.array_equal(data.stratus.show("qc", **host), wanted), "a file that does not fit in memory")
            _pages.free_memory = free
            check(numpy.array_equal(data.stratus.show("qc", **host), wanted), "a file")


accessors()
meshes()
axes()
wrong()
lazy()
of_file()
done()
