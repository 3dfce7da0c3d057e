# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of xarray's data: after `import stratus_volume.xarray`, `array.stratus.show()` and `dataset.stratus.show("name")`, and `render` likewise,
with the arguments of `stratus_volume.show` and `stratus_volume.render`."""
import xarray

from ._draw import render, show


@xarray.register_dataarray_accessor("stratus")
class DataArrayAccessor:
    """`array.stratus`, of a DataArray of three dimensions."""

    def __init__(self, data):
        self._data = data

    def show(self, *arguments, **options):
        """Draws the DataArray and returns a Picture. Everything is as in `stratus_volume.show`, without its `data`."""
        return show(self._data, *arguments, **options)

    def render(self, *arguments, **options):
        """Draws the DataArray and returns a Rendering: rgba, depth, counters. Everything is as in `stratus_volume.render`, without its `data`."""
        return render(self._data, *arguments, **options)


@xarray.register_dataset_accessor("stratus")
class DatasetAccessor:
    """`dataset.stratus`, whose functions first have the name of a variable."""

    def __init__(self, data):
        self._data = data

    def _variable(self, name):
        if name not in self._data.variables:
            known = sorted(str(each) for each, array in self._data.data_vars.items() if array.ndim >= 3)
            raise ValueError(f"the Dataset has no variable {name!r}, " + (f"it must be one of {known}" if known else "and none of three dimensions"))
        return self._data[name].stratus

    def show(self, name, *arguments, **options):
        """Draws a variable and returns a Picture. Everything else is as in `stratus_volume.show`."""
        return self._variable(name).show(*arguments, **options)

    def render(self, name, *arguments, **options):
        """Draws a variable and returns a Rendering: rgba, depth, counters. Everything else is as in `stratus_volume.render`."""
        return self._variable(name).render(*arguments, **options)
