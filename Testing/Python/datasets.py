# SPDX-License-Identifier: BSD-3-Clause
"""What the package reads of an xarray.Dataset, for tests where xarray is missing."""
import numpy


class Variable:
    def __init__(self, name, dims, values, attrs, encoding=()):
        self.name, self.dims, self.values, self.attrs, self.encoding = name, tuple(dims.split()), numpy.asanyarray(values), dict(attrs), dict(encoding)
        self.shape, self.coords = self.values.shape, {}


class Dataset:
    """variables: name=(dimensions, values, attributes, and what xarray moved to the encoding)."""

    def __init__(self, **variables):
        self.variables = {name: Variable(name, *own) for name, own in variables.items()}
        self.data_vars, self.attrs = self.variables, {}

    def __getitem__(self, name):
        return self.variables[name]


def of_file(path, step=0):
    """The Dataset of a netCDF file, at a step of the dimension of time."""
    import netCDF4
    variables = {}
    with netCDF4.Dataset(path) as file:
        for name, one in file.variables.items():
            times = [each.lower() == "time" for each in one.dimensions]
            variables[name] = (" ".join(each for each, time in zip(one.dimensions, times) if not time),
                               one[tuple(step if time else slice(None) for time in times)], {key: one.getncattr(key) for key in one.ncattrs()})
    return Dataset(**variables)
