# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of rays through NumPy's arrays, against fields whose numbers are known."""
from checking import check, done, refuse
from lattice import cubes

import numpy

from stratus_volume import Volume, render, render_several, render_tetrahedra

z, y, x = numpy.mgrid[0:20, 0:24, 0:28].astype(float)
field = 0.5 * x + 0.2 * y - 0.1 * z + 3
all_names = ["integral", "length", "mean", "maximum", "maximum_depth", "cells", "transmittance", "transmittance_depth"]
view = dict(azimuth=20, elevation=35)


def linear():
    """The mean of a linear field on a ray is the mean of its ends, and its largest value is at one of them."""
    drawn = render(field, 0.5, size=(120, 90), camera=view, quantities=all_names)
    rgba, depth, _ = drawn
    q = drawn.quantities
    check(list(q) == all_names and all(a.shape == (90, 120) and a.dtype == numpy.float32 for a in q.values()), "arrays by their names")
    met = q["length"] > 1
    check(met.sum() > 1000, "rays meet the volume")
    check(numpy.allclose(q["integral"], numpy.where(met, q["mean"] * q["length"], q["integral"]), rtol=1e-5, atol=1e-3), "integral, mean and length")
    check(numpy.allclose(q["transmittance"], 1 - rgba[..., 3], atol=2e-3), "transmittance and alpha")
    check((q["maximum"] >= q["mean"])[met].all() and q["maximum"][met].max() <= field.max() + 1e-4, "maximum")
    check((q["maximum_depth"] - depth)[met & numpy.isfinite(depth)].min() > -0.5, "depths are from the eye")
    none = q["length"] == 0
    check(none.any() and numpy.isnan(q["mean"][none]).all() and (q["integral"][none] == 0).all() and (q["transmittance"][none] == 1).all(), "rays that miss")
    half = numpy.isfinite(q["transmittance_depth"])
    check((half == (q["transmittance"] <= 0.5)).mean() > 0.99, "the depth of half the light")
    low = render(field, 0.5, size=(120, 90), camera=view, quantities="transmittance_depth", threshold=0.9).quantities["transmittance_depth"]
    check((low < q["transmittance_depth"])[half].all(), "less light is lost at a smaller depth")
    check(render(field, size=(8, 6)).quantities == {}, "none are computed unasked")


def scaled():
    """Values beyond the core's floats, and integers."""
    one = render(field, 0.5, size=(60, 45), camera=view, quantities=["integral", "maximum", "cells"]).quantities
    huge = render(field * 1e60, 0.5, size=(60, 45), camera=view, quantities=["integral", "maximum", "cells"]).quantities
    check(numpy.allclose(huge["integral"] / 1e60, one["integral"], rtol=1e-5) and (huge["cells"] == one["cells"]).all(), "values of 1e60")
    whole = numpy.round(field).astype(numpy.int64) + 10**12
    large = render(whole, 0.5, size=(60, 45), camera=view, quantities=["mean", "maximum"]).quantities
    met = numpy.isfinite(large["mean"])
    check(met.any() and numpy.allclose(large["mean"][met], 1e12, rtol=1e-6), "integers of 1e12")
    masked = numpy.ma.masked_where(x > 13.5, field)
    check(render(masked, 0.5, size=(60, 45), camera=view, quantities="cells").quantities["cells"].sum() < one["cells"].sum(), "masked values")


def of_grids():
    points, cells = cubes((6, 6, 6))
    values = points[:, 0] + 2 * points[:, 1]
    q = render_tetrahedra(points, cells, values, 0.5, size=(60, 45), quantities=["integral", "length", "cells"]).quantities
    met = q["length"] > 2
    check(met.any() and (q["cells"][met] >= 2).all(), "tetrahedra")
    both = render_several([field, (field, dict(origin=(60, 0, 0)))], size=(120, 90), quantities="integral").quantities["integral"]
    check(both.max() > 0.9 * render(field, size=(120, 90), quantities="integral").quantities["integral"].max(), "several")
    try:
        import xarray
    except ImportError:
        return
    data = xarray.DataArray(field, dims=("z", "y", "x"), name="qc", attrs={"units": "kg kg-1"})
    mean = render(data, size=(20, 15), quantities="mean").quantities["mean"]
    units_of_axes(xarray)
    check(isinstance(mean, xarray.DataArray) and mean.attrs["units"] == "kg kg-1" and "qc" in mean.attrs["long_name"], "xarray's own arrays")


def units_of_axes(xarray):
    """Lengths are in metres where the axes have units of length, and do not depend on a matrix that stretches the volume."""
    for units, metres, unit, of_integral in (("km km km", 1000, "m", "kg m-2"), ("km km m", 1, "m", "kg m-2"), ("1 1 m", None, "grid units", "kg m-3 grid units")):
        places = {axis: (axis, 10.0 + 2 * numpy.arange(8.0), {"units": each}) for axis, each in zip("xyz", units.split())}
        data = xarray.DataArray(numpy.full((8, 8, 8), 3.0), dims=("z", "y", "x"), coords=places, attrs={"units": "kg m-3"})
        for stretch in 1, 10:
            drawn = Volume(data, matrix=numpy.diag([1, 1, stretch, 1]).tolist())
            x0, x1, y0, y1, z0, z1 = drawn.bounds
            middle = ((x0 + x1) / 2, (y0 + y1) / 2)
            down = dict(position=(*middle, z1 + 100), focal_point=(*middle, z0), view_up=(0, 1, 0), parallel_scale=2)
            q = drawn.render(0.1, size=(9, 9), camera=down, quantities=["length", "integral"]).quantities
            want = 7 if metres is None else 14 * metres
            check(numpy.allclose(q["length"], want) and numpy.allclose(q["integral"], 3 * want), f"{units}, heights times {stretch}: {q['length'].values[4, 4]}")
            check((q["length"].attrs["units"], q["integral"].attrs["units"]) == (unit, of_integral), f"{units}: {q['length'].attrs}, {q['integral'].attrs}")


def refusals():
    drawn = Volume(field)
    refuse(ValueError, "it must be one of integral, length", drawn.render, quantities="density")
    refuse(ValueError, "threshold 1.5 of the transmittance", drawn.render, quantities="integral", threshold=1.5)
    refuse(ValueError, "mode is 'quantities'", drawn.render, mode="quantities")


linear()
scaled()
of_grids()
refusals()
done()
