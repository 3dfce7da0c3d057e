# SPDX-License-Identifier: BSD-3-Clause
"""Stratus: uneven volumes drawn fast and exactly, from NumPy arrays, without VTK.

show(array)    a picture that notebooks show
render(array)  RGBA and depth as floats, and counters
Volume(array)  the same again and again, from other sides, without building anew
"""
from ._core import Cancelled, Context, DeviceError, Unsupported, devices
from ._core import version as __version__
from ._picture import Picture, Rendering
from ._values import NothingShown
from ._volume import Volume, render, show

__all__ = ["Cancelled", "Context", "DeviceError", "NothingShown", "Picture", "Rendering", "Unsupported", "Volume", "devices", "render", "show"]
