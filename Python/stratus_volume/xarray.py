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

    def show(self, name, *arguments, **options):
        """Draws a variable and returns a Picture. Everything else is as in `stratus_volume.show`."""
        return show(self._data, *arguments, scalars=name, **options)

    def render(self, name, *arguments, **options):
        """Draws a variable and returns a Rendering: rgba, depth, counters. Everything else is as in `stratus_volume.render`."""
        return render(self._data, *arguments, scalars=name, **options)
