# SPDX-License-Identifier: BSD-3-Clause
"""Stratus: uneven volumes drawn fast and exactly, from NumPy arrays, without VTK.

show(data)                a picture that notebooks show
render(data)              RGBA and depth as floats, and counters
render_tetrahedra(points, tetrahedra, values)
turn(data)                a film of the data as it turns
view(data)                a picture in a notebook that the mouse turns
cloud(data)               water of clouds as a photograph shows it
render_several(items)     volumes and meshes that overlap, as one medium
slab(center, normal, thickness)  the clip planes of a thick slice
Volume, Tetrahedra        the same again and again, from other sides, without building anew
distance_field(data)      distances to the voxels whose values show
Tree, first_hits          the first of these voxels along rays
partition, VisibilityOrder  meshes cut into leaves, and the order in which cells hide one another
Octree                    which of many boxes a camera sees
color_maps()              names of colour maps
"""
from ._cells import Partition, VisibilityOrder, partition
from ._cloud import cloud
from ._core import Cancelled, Context, DeviceError, Unsupported, color_maps, devices
from ._core import version as __version__
from ._draw import render, render_tetrahedra, show, turn
from ._media import slab
from ._notebook import View, view
from ._octree import Octree, Visible
from ._picture import Film, Picture, Rendering
from ._several import render_several
from ._tetrahedra import Tetrahedra
from ._values import NothingShown, PlacesUnused
from ._volume import Volume
from ._voxels import Hits, Tree, distance_field, first_hits

__all__ = ["Cancelled", "Context", "DeviceError", "Film", "Hits", "NothingShown", "Octree", "Partition", "Picture", "PlacesUnused", "Rendering", "Tetrahedra",
           "Tree", "Unsupported", "View", "VisibilityOrder", "Visible", "Volume", "cloud", "color_maps", "devices", "distance_field", "first_hits", "partition", "render",
           "render_several", "render_tetrahedra", "show", "slab", "turn", "view"]
