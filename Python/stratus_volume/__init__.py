# SPDX-License-Identifier: BSD-3-Clause
"""Stratus: uneven volumes drawn fast and exactly, from NumPy arrays, without VTK.

show(data)                a picture that notebooks show
render(data)              RGBA and depth as floats, and counters
render_tetrahedra(points, tetrahedra, values)
turn(data)                a film of the data as it turns
Volume, Tetrahedra        the same again and again, from other sides, without building anew
distance_field(data)      distances to the voxels whose values show
Tree, first_hits          the first of these voxels along rays
"""
from ._core import Cancelled, Context, DeviceError, Unsupported, devices
from ._core import version as __version__
from ._draw import render, render_tetrahedra, show, turn
from ._picture import Film, Picture, Rendering
from ._tetrahedra import Tetrahedra
from ._values import NothingShown
from ._volume import Volume
from ._voxels import Hits, Tree, distance_field, first_hits

__all__ = ["Cancelled", "Context", "DeviceError", "Film", "Hits", "NothingShown", "Picture", "Rendering", "Tetrahedra", "Tree", "Unsupported", "Volume",
           "devices", "distance_field", "first_hits", "render", "render_tetrahedra", "show", "turn"]
