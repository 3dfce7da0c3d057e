# SPDX-License-Identifier: BSD-3-Clause
"""hdf5.py FOLDER, by the system's Python: HDF5 files for ParaView's readers. They are written by libnetcdf, whose files are HDF5, as ParaView's
Python has no library of HDF5. FOLDER/plain.h5 has a data set /run/rho of chunks; FOLDER/image.vtkhdf an image of two arrays."""
import os
import sys

import netCDF4
import numpy


def write(folder):
    values = numpy.arange(5 * 6 * 7, dtype="f4").reshape(5, 6, 7)
    with netCDF4.Dataset(os.path.join(folder, "plain.h5"), "w") as file:
        for name, size in zip("zyx", values.shape):
            file.createDimension(name, size)
        file.createVariable("run/rho", "f4", tuple("zyx"), chunksizes=(2, 3, 4), zlib=True)[:] = values
    with netCDF4.Dataset(os.path.join(folder, "image.vtkhdf"), "w") as file:
        image = file.createGroup("VTKHDF")
        image.Version, image.Type, image.WholeExtent = numpy.array((1, 0), "i8"), "ImageData", numpy.array((0, 6, 0, 5, 0, 4), "i8")
        image.Origin, image.Spacing = numpy.array((1.0, 2, 3)), numpy.array((0.5, 1, 2))
        for name, size in zip("zyx", values.shape):
            image.createDimension(name, size)
        for name, factor in ("heat", 1), ("salt", 2):
            image.createVariable(f"PointData/{name}", "f4", tuple("zyx"), fill_value=False)[:] = factor * values


write(sys.argv[1])
