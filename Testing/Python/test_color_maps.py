#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Colour maps by name without matplotlib: known bytes, reversed maps, pixels of a picture. test_color_map_bytes.py compares every byte."""
import sys

from checking import check, done, refuse

import numpy
import stratus_volume
from stratus_volume import _values

# (map, row, bytes), as matplotlib, cmocean and ParaView print them.
KNOWN = (("viridis", 0, (68, 1, 84)), ("viridis", 255, (253, 231, 36)), ("magma", 128, (182, 54, 121)), ("cividis", 0, (0, 34, 77)),
         ("turbo", 0, (48, 18, 59)), ("thermal", 0, (3, 35, 51)), ("balance", 255, (60, 9, 17)), ("cool-warm", 0, (59, 76, 192)))


def rows_of(name):
    return numpy.rint(255 * numpy.array(_values.core_map(name))).astype(int)


def known():
    for name, row, expected in KNOWN:
        check(tuple(rows_of(name)[row]) == expected, f"{name} {row}: {rows_of(name)[row]}, not {expected}")
        check(tuple(rows_of(name + "_r")[255 - row]) == expected, f"{name}_r")
    names = stratus_volume.color_maps()
    check(len(names) == len(set(names)) and all(len(rows_of(name)) == 256 for name in names), f"{names}")


def without_matplotlib():
    """Names need nothing else, and a name that none of them has says so."""
    hidden = {name: sys.modules.get(name) for name in ("matplotlib", "matplotlib.colors")}
    sys.modules.update(dict.fromkeys(hidden))  # their import fails
    field = numpy.ones((8, 8, 8), numpy.float32)
    field[0, 0, 0] = 0
    for name in "viridis", "thermal_r":  # the largest value of the ray in the middle is 1
        picture = stratus_volume.show(field, opacity=[(0, 1), (1, 1)], color=name, size=(41, 31), background=None, device="host", mode="maximum")
        expected = rows_of(name)[255]
        check(tuple(picture[15, 20]) == (*expected, 255), f"{name}: {picture[15, 20]}, not {expected}")
    refuse(ValueError, "no colour map of Stratus", stratus_volume.show, field, color="mud", device="host")
    refuse(ValueError, "did you mean viridis?", stratus_volume.show, field, color="viridiss", device="host")
    for name, module in hidden.items():
        if module is None:
            del sys.modules[name]
        else:
            sys.modules[name] = module


known()
without_matplotlib()
done()
