# SPDX-License-Identifier: BSD-3-Clause
"""Several volumes, and meshes among them, in one picture."""
import contextlib
import ctypes

from . import _declarations as c
from . import _view
from ._core import as_dict, library
from ._draw import drawn_of
from ._look import Image, Quantities
from ._tetrahedra import AskedOfCells, Tetrahedra
from ._values import pixels
from ._volume import Asked, Volume

_DATA = ("spacing", "origin", "axes", "scalars", "component", "matrix", "memory")


def _parted(item, n, device, threads):
    """What draws an item, and its look."""
    data, look = item if isinstance(item, (tuple, list)) and len(item) == 2 and isinstance(item[1], dict) else (item, {})
    if isinstance(data, (tuple, list, dict)):
        raise TypeError(f"item {n} is a {type(item).__name__}, it must be data, or a pair of data and a dict of how they look")
    place = {name: look[name] for name in _DATA if name in look}
    look = {name: value for name, value in look.items() if name not in _DATA}
    if getattr(data, "innermost", None) is not None:
        raise ValueError(f"item {n} is on a globe, which `render` draws with one data set only")
    if hasattr(data, "render") and hasattr(data, "context"):
        return drawn_of(data, **place), look
    return drawn_of(data, device=device, threads=threads, **place), look


def _asked(drawn, look, n):
    try:
        return (AskedOfCells if isinstance(drawn, Tetrahedra) else Asked)(drawn, **look)
    except TypeError as error:
        raise TypeError(f"item {n}: {error}") from None
    except ValueError as error:
        raise ValueError(f"item {n}: {error}") from None


def render_several(items, size=(640, 480), camera=None, opaque_depth=None, device=None, threads=None, progress=None,
                   quantities=None, threshold=0.5):
    """Draws volumes that may overlap as one medium, and returns a Rendering: rgba, depth, counters.

    items         1 to 8 items. Each is data that `render` accepts, or a pair of data and a dict of settings. Settings are all arguments of `render`
                  except size, camera, opaque_depth, device, threads and progress; spacing, origin and matrix place the item. A Volume or
                  Tetrahedra keeps its structures; all of them must use one device, and none may come twice
    size, camera, opaque_depth, progress, quantities, threshold  see render. The default camera sees all of the items
    device, threads  for items that are not a Volume or Tetrahedra; default: as of the first Volume or Tetrahedra, or see Volume

    Where volumes overlap, their optical depths and their light add up, in any order of the items. All items have the same mode. In maximum,
    minimum, average and additive the picture shows the best of the values that show, the mean, or the sum of all items. In isosurface, slice and
    first-hit the surfaces of all items show by depth. An item without a visible value is left out with a warning.
    counters are of the whole picture, and counters["items"] has one dict for each item, with its structure and sampling and the reasons.
    """
    size = pixels(size)
    try:
        items = list(items)
    except TypeError:
        raise TypeError(f"items is a {type(items).__name__}, it must be a list of data, or of pairs of data and a dict of how they look") from None
    most = c.CONSTANTS["STRATUS_SEVERAL_MAX"]
    if not 1 <= len(items) <= most:
        raise ValueError(f"items has {len(items)}, it must have 1 to {most}")
    if device is None and threads is None:
        given = [item[0] if isinstance(item, (tuple, list)) and item else item for item in items]
        device = next((each.context for each in given if hasattr(each, "render") and hasattr(each, "context")), None)
    parts = [_parted(item, n, device, threads) for n, item in enumerate(items)]
    context, image = parts[0][0].context, Image(size, opaque_depth)
    for n, (drawn, _) in enumerate(parts):
        if drawn.context is not context:
            raise ValueError(f"item {n} is of another device or Context than item 0: {drawn.context.device} and {context.device}")
        if any(drawn is other for other, _ in parts[:n]):
            raise ValueError(f"item {n} is the same {type(drawn).__name__} as an item before it: make another of the same data")
    numbers = Quantities(quantities, threshold, image)
    with context.lock, contextlib.ExitStack() as readings:
        for drawn, _ in parts:
            if isinstance(drawn, Volume):
                drawn.settle(progress)
                readings.enter_context(drawn.grid.reading())
        asked = [_asked(drawn, look, n) for n, (drawn, look) in enumerate(parts)]
        shown = [(drawn, each) for (drawn, _), each in zip(parts, asked) if not _nothing(drawn)]
        reports = (c.stratus_ray_cast_report * len(shown))()
        powers = {drawn.power if isinstance(drawn, Tetrahedra) else each.power for drawn, each in shown}
        if numbers.numbers and len(powers) > 1:
            raise ValueError("quantities of items whose magnitudes lie outside 1e-30..1e37 in some and inside in others: scale the values")
        if shown:
            inputs = (c.stratus_ray_cast_input * len(shown))()
            for own, (drawn, each) in zip(inputs, shown):
                own.transfer = each.functions
                if isinstance(drawn, Tetrahedra):
                    own.tetra, own.mesh, own.tetra_options = drawn._caster.pointer, ctypes.addressof(each.mesh), ctypes.addressof(each.options)
                else:
                    own.caster, own.volume, own.options = drawn._caster.pointer, ctypes.pointer(each.volume), ctypes.pointer(each.options)
            bounds = [pick(each.bounds[2 * axis + end] for _, each in shown) for axis in range(3) for end, pick in enumerate((min, max))]
            view = _view.make(context, camera, bounds, size)
            context.call(library.stratus_ray_caster_render_several, inputs, len(shown), ctypes.byref(view), ctypes.byref(image.struct), reports,
                         progress=progress)
            numbers.compute(context, inputs, len(shown), view, progress)
    drawn_reports = iter([as_dict(report) for report in reports])
    each_of = [{} if _nothing(drawn) else next(drawn_reports) for drawn, _ in parts]
    for (drawn, _), each in zip(parts, asked):
        if _nothing(drawn):
            each.explain(image.rgba)
    if shown and float(image.rgba[..., 3].max()) < 0.5 / 255:
        shown[0][1].explain(image.rgba)
    whole = dict(next((each for each in each_of if each), {}), items=each_of)
    return image.rendering(whole, numbers.result(powers.pop() if powers else 0))


def _nothing(drawn):
    return drawn.nothing if isinstance(drawn, Tetrahedra) else drawn.grid.nothing
