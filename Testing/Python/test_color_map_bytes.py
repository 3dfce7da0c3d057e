#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every byte of the colour maps against matplotlib and cmocean, and maps that only matplotlib has."""
import sys

from checking import check, done

import numpy
import stratus_volume
from stratus_volume import _values

try:
    import cmocean
    import matplotlib
except ImportError as error:
    print(f"SKIPPED: colour maps are not compared with their owners', because {error.name} is not installed")
    sys.exit(77)


def rows_of(name):
    return numpy.rint(255 * numpy.array(_values.core_map(name))).astype(int)


def of_matplotlib(color_map):
    return color_map(numpy.arange(256), bytes=True)[:, :3]


names, compared = stratus_volume.color_maps(), 0
for name in "viridis", "magma", "inferno", "plasma", "cividis", "turbo", "coolwarm", "gray":
    for turned in (name,) if name == "gray" else (name, name + "_r"):  # matplotlib makes gray_r anew, and truncates other bytes
        check(numpy.array_equal(rows_of(turned), of_matplotlib(matplotlib.colormaps[turned])), f"{turned} differs from matplotlib's")
    compared += name in names
for name in cmocean.cm.cmapnames:
    check(numpy.array_equal(rows_of("cmo." + name), of_matplotlib(cmocean.cm.cmap_d[name])), f"cmo.{name} differs from cmocean's")
    compared += name in names or "cmo." + name in names
check(compared == 8 + len(cmocean.cm.cmapnames) and compared == len(names) - 5, f"{compared} of {names} were compared: the others are ours and ParaView's")
field = numpy.linspace(0, 1, 64, dtype=numpy.float32).reshape(4, 4, 4)
for name, same in ("PuOr", matplotlib.colormaps["PuOr"]), ("PuOr_r", matplotlib.colormaps["PuOr_r"]), ("red", (1, 0, 0)):
    pictures = [stratus_volume.show(field, color=color, device="host", size=(20, 15)) for color in (name, same)]
    check(numpy.array_equal(*pictures), f"{name} of matplotlib")
done()
