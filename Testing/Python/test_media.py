# SPDX-License-Identifier: BSD-3-Clause
"""stratus_volume's components, labels, functions of two variables, surfaces and several volumes, against sums over voxels in NumPy."""
import warnings

from checking import ball, check, done, refuse

import numpy

from stratus_volume import NothingShown, Tetrahedra, Unsupported, Volume, distance_field, render, render_several, slab

warnings.simplefilter("error")
random = numpy.random.default_rng(7)
host = dict(device="host", size=(60, 60))

# Parallel rays along +y through the voxels' middles: pixel (row, column) of a picture n pixels wide shows voxel z = n - 1 - row, x = column. Each
# voxel is four samples long, the first and the last two, so that nearest interpolation sums exactly what the loop below sums.
n, depth = 6, 5
straight = dict(device="host", size=(n, n), interpolation="nearest", sampling="midpoint", sample_distance=0.25, tolerance=0, unit_distance=2,
                camera=dict(position=(n / 2 - 0.5, -10.5, n / 2 - 0.5), focal_point=(n / 2 - 0.5, 0, n / 2 - 0.5), view_up=(0, 0, 1),
                            parallel_scale=n / 2))
inner = (slice(1, n - 1), slice(1, n - 1))  # rays at the border run along it


def apart(a, b):
    return float(numpy.abs(getattr(a, "rgba", a) - getattr(b, "rgba", b)).max())


def summed(opacities, colors):
    """Composites media front to back. opacities: (media, z, y, x) per unit distance of 2; colors: (media, z, y, x, 3)."""
    rgba = numpy.zeros((n, n, 4))
    for y in range(depth):
        length = 0.5 if y in (0, depth - 1) else 1.0
        depths = -numpy.log1p(-opacities[:, :, y]) * length / 2
        total = depths.sum(axis=0)
        emitted = (depths[..., None] * colors[:, :, y]).sum(axis=0) / numpy.maximum(total, 1e-30)[..., None]
        own = 1 - numpy.exp(-total)
        left = (1 - rgba[..., 3]) * own
        rgba[..., :3] += left[..., None] * emitted
        rgba[..., 3] += left
    return rgba[::-1]


def holds(rendering, opacities, colors, what):
    error = numpy.abs(rendering.rgba - summed(numpy.asarray(opacities), numpy.asarray(colors)))[inner].max()
    check(error < 2e-3 and rendering.rgba[inner][..., 3].max() > 0.2, f"{what}: {error} from the sums")


def whole(color, *shape):
    return numpy.broadcast_to(color, (*shape, 3))


def components():
    for kind in numpy.float32, numpy.uint8, numpy.int16, numpy.float64:
        for count in 2, 3, 4:
            values = random.integers(0, 100, (n, depth, n, count)).astype(kind)
            tops, hues = (0.6, 0.3, 0.5, 0.2)[:count], [(1, 0, 0), (0, 1, 0), (0, 0.2, 1), (1, 1, 1)][:count]
            opacity = [[(0, 0), (99, top)] for top in tops]
            media = [values[..., c] / 99 * tops[c] for c in range(count)]
            colors = [whole(hue, n, depth, n) for hue in hues]
            holds(render(values, opacity=opacity, color=hues, **straight), media, colors, f"{count} components of {kind.__name__}")
            if kind == numpy.float32:
                far = numpy.ascontiguousarray(values.transpose(2, 0, 1, 3))  # array[x, z, y, component]
                holds(render(far, opacity=opacity, color=hues, axes="xzy", **straight), media, colors, "in another order of axes")
                planar = numpy.ascontiguousarray(values.transpose(3, 0, 1, 2)).transpose(1, 2, 3, 0)
                holds(render(planar, opacity=opacity, color=hues, **straight), media, colors, "of planes one after the other")
                holds(render(values.astype(float) * 1e300, opacity=[[(0, 0), (99e300, top)] for top in tops], color=hues, **straight), media, colors, "times 1e300")
                shares = [0.5, 0, 1, 0.25][:count]
                weighed = [1 - (1 - medium) ** share for medium, share in zip(media, shares)]
                holds(render(values, opacity=opacity, color=hues, weights=shares, **straight), weighed, colors, "weights")
    values = random.integers(0, 100, (n, depth, n, 2)).astype(numpy.float32)
    plain, same = render(values[..., 0], opacity=[(0, 0), (99, 0.5)], **straight), render(values[..., :1], opacity=[(0, 0), (99, 0.5)], **straight)
    check(apart(plain, same) == 0, "one component is a volume of one")
    one = [[(0, 0), (99, 0.5)], [(0, 0), (1, 0)]]
    both, mean = (render(values, opacity=one, color=(1, 1, 1), mean_components=each, **straight) for each in (False, True))
    check(apart(both, mean) < 1e-5 and apart(both, render(values, opacity=0.5, mean_components=True, **straight)) > 0.05, "mean of one that shows is it")
    masked = numpy.ma.masked_array(values, random.random(values.shape) < 0.1)
    hidden = masked.mask.any(axis=3)
    holds(render(masked, opacity=0.5, color=[(1, 0, 0), (0, 1, 0)], **straight),
          [numpy.where(hidden, 0, medium) for medium in ramps(masked)], [whole(hue, n, depth, n) for hue in ((1, 0, 0), (0, 1, 0))], "masks")
    holes = render(numpy.where(hidden[..., None], numpy.nan, values), opacity=0.5, color=[(1, 0, 0), (0, 1, 0)], **straight)
    check(apart(render(masked, opacity=0.5, color=[(1, 0, 0), (0, 1, 0)], **straight), holes) == 0, "as NaN")
    lit = ball((20, 20, 20), (10, 10, 10), 8)
    several = numpy.stack([lit, numpy.roll(lit, 4, axis=2)], axis=3)
    look = dict(opacity=[[(0, 0), (1, 0.8)]] * 2, **host)
    dull, first, both = (render(several, shade=shade, **look) for shade in (False, [True, False], True))
    check(apart(dull, first) > 0.02 and apart(first, both) > 0.02 and apart(both, render(several, shade=[True, dict(diffuse=0.9)], **look)) < 1e-6,
          "light of each component")
    for mode in "maximum", "minimum", "average", "additive":
        check(render(several, mode=mode, opacity=[[(0, 0.5), (1, 0.5)]] * 2, **host).rgba.max() > 0.1, f"mode {mode}")
    refuse(ValueError, "opacity has 3", render, several, opacity=[0.1, 0.2, 0.3])
    refuse(ValueError, "0..1", render, several, weights=[2, 1])
    refuse(ValueError, "1 component", render, several[..., 0], weights=1)
    refuse(ValueError, "1 component", render, several[..., 0], dependent=True)
    refuse(ValueError, "5)", render, numpy.zeros((4, 4, 4, 5)))
    refuse(ValueError, "2 components", distance_field, several)
    check(render(several, mode="isosurface", contours=[0.5], **host).rgba[..., 3].max() > 0, "surfaces of components")
    for contours, opacity in (0.5, 1), ([0.5], 1), ([0.3, 0.6], 0.5):
        own, given = (render(lit, mode="isosurface", contours=contours, color=(1, 1, 1), **host, **each) for each in ({}, dict(opacity=[(0, opacity)])))
        check(numpy.array_equal(own.rgba, given.rgba) and own.rgba.max() > 0.4, f"the opacity of surfaces at {contours} is {opacity}")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        far = lit.copy()
        far[0, 0, 0] = 1e12
        render(far, mode="slice", surface=dict(center=(10, 10, 10), normal=(1, 1, 1)), **host)
    check(not caught, "a slice is opaque, and one value far from all others hides nothing of it")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        render(several, opacity=[[(0, 0), (1, 0)]] * 2, **host)
    check(len(caught) == 1 and caught[0].category is NothingShown and "component 0" in str(caught[0].message) and caught[0].filename == __file__,
          f"one warning: {[str(one.message) for one in caught]}")


def ramps(masked):
    """The opacities of a number, 0.5: a ramp away from the most frequent value of each component, as render describes it."""
    from stratus_volume._values import opacity_at, opacity_points, Spread
    shown = masked.data[~masked.mask.any(axis=3)]
    spreads = [Spread(shown[:, c]) for c in range(2)]
    return [opacity_at(opacity_points(0.5, each.low, each.high, each.common, 0), masked.data[..., c]) for c, each in enumerate(spreads)]


def dependent():
    values = random.integers(0, 100, (n, depth, n, 2)).astype(numpy.float32)
    colors = numpy.stack([values[..., 0] / 99, 1 - values[..., 0] / 99, numpy.zeros(values.shape[:3])], axis=-1)
    picture = render(values, opacity=[(0, 0), (99, 0.6)], color=[(0, 0, 1, 0), (99, 1, 0, 0)], dependent=True, **straight)
    holds(picture, [values[..., 1] / 99 * 0.6], [colors], "the colour of the first, the opacity of the second")
    wide = values * (7, 1)
    low, high = wide[..., 0].min(), wide[..., 0].max()
    named = [(low, 0.23, 0.3, 0.75), (0.5 * (low + high), 0.87, 0.87, 0.87), (high, 0.9, 0.45, 0.15)]
    own, same = (render(wide, opacity=[(0, 0), (99, 0.6)], color=color, dependent=True, **straight) for color in (None, named))
    check(apart(own, same) < 1e-6, "colours that are not given are over the range of the first")
    rgba = random.integers(0, 256, (n, depth, n, 4)).astype(numpy.uint8)
    holds(render(rgba, dependent=True, **straight), [numpy.minimum(rgba[..., 3] / 255, 1 - 1e-12)], [rgba[..., :3] / 255], "bytes that are a colour")
    holds(render(rgba, opacity=[(0, 0), (255, 0.3)], dependent=True, **straight), [rgba[..., 3] / 255 * 0.3], [rgba[..., :3] / 255], "thinned")
    refuse(Unsupported, "3 dependent", render, rgba[..., :3], dependent=True, **straight)
    holds(render(rgba.astype(numpy.float32), dependent=True, **straight), [numpy.minimum(rgba[..., 3] / 255, 1 - 1e-12)], [rgba[..., :3] / 255], "floats")
    refuse(Unsupported, "up to 16 bits or floats", render, rgba.astype(numpy.int32), dependent=True, **straight)


def labels():
    values = random.integers(0, 100, (n, depth, n)).astype(numpy.float32)
    marks = random.integers(0, 5, values.shape)
    look = dict(opacity=[(0, 0), (99, 0.5)], color=(1, 1, 1))
    looks = {1: dict(opacity=[(0, 0.4), (99, 0)], color=(1, 0, 0)), 3: dict(color=(0, 0, 1))}
    opacity = numpy.where(marks == 1, 0.4 * (1 - values / 99), 0.5 * values / 99)
    colors = numpy.where((marks == 1)[..., None], (1, 0, 0), numpy.where((marks == 3)[..., None], (0, 0, 1), (1.0, 1, 1)))
    for kind in numpy.uint8, numpy.int64, numpy.uint16:
        holds(render(values, labels=marks.astype(kind), looks=looks, **look, **straight), [opacity], [colors], f"labels of {kind.__name__}")
    turned, order = values.transpose(2, 1, 0), numpy.asfortranarray(values)
    holds(render(turned, axes="xyz", labels=marks.transpose(2, 1, 0), looks=looks, **look, **straight), [opacity], [colors], "labels in another order")
    holds(render(order, labels=marks, looks=looks, **look, **straight), [opacity], [colors], "with values in Fortran order")
    volume = Volume(values, device="host")
    kept, bytes_of = {name: value for name, value in straight.items() if name != "device"}, marks.astype(numpy.uint8)
    volume.render(labels=bytes_of, looks=looks, **look, **kept)
    bytes_of[:] = 0  # in place
    holds(volume.render(labels=bytes_of, looks=looks, **look, **kept), [values / 99 * 0.5], [whole((1, 1, 1), n, depth, n)], "labels that changed in place")
    for words, options in [("needs labels", dict(looks=looks)), ("needs looks", dict(labels=marks)), ("(6, 5)", dict(labels=marks[..., 0], looks=looks)),
                           ("0..255", dict(labels=marks * 100, looks=looks)), ("256", dict(labels=marks, looks={256: {}})),
                           ("gleam", dict(labels=marks, looks={1: dict(gleam=1)})), ("empty", dict(labels=marks, looks={}))]:
        refuse(ValueError, words, render, values, **options)
    refuse(TypeError, "float", render, values, labels=values, looks=looks)
    refuse(TypeError, "looks", render, values, labels=marks, looks=3)


def two_variables():
    table = random.random((3, 4, 4)) * 0.7
    values = random.integers(0, 4, (n, depth, n, 2)) + 0.0
    values[..., 1] = random.integers(0, 3, values.shape[:3])
    found = table[values[..., 1].astype(int), values[..., 0].astype(int)]
    function = dict(rgba=table, value_range=(-0.5, 3.5), second_range=(-0.5, 2.5))
    for scale in 1, 1e300:
        scaled = dict(function, value_range=(-0.5 * scale, 3.5 * scale), second_range=(-0.5 * scale, 2.5 * scale))
        holds(render(values * scale, function_2d=scaled, **straight), [found[..., 3]], [found[..., :3]], f"of two components, times {scale}")
    # A table that does not change with the gradient is a function of the value.
    field = ball((20, 20, 20), (10, 10, 10), 8)
    rows = numpy.broadcast_to(numpy.linspace(0, 1, 257)[None, :, None] * (0.9, 0.5, 0.2, 0.6), (4, 257, 4))
    plain = render(field, opacity=[(0, 0), (1, 0.6)], color=[(0, 0, 0, 0), (1, 0.9, 0.5, 0.2)], tolerance=0, **host)
    same = render(field, function_2d=dict(rgba=rows, value_range=(-1 / 512, 1 + 1 / 512), second_range=(0, 1)), tolerance=0, **host)
    check(apart(plain, same) < 5e-3, f"of only the value: {apart(plain, same)}")
    steep = numpy.array(rows)
    steep[:2, :, 3] = 0
    check(apart(render(field, function_2d=dict(rgba=steep, value_range=(0, 1), second_range=(0, 0.25)), **host), plain) > 0.05,
          "the gradient counts")
    for words, change in [("value_range", dict(value_range=(1, 1))), ("rows, columns", dict(rgba=table[0])), ("0..1", dict(rgba=table * 9))]:
        refuse(ValueError, words, render, values, function_2d=dict(function, **change), **straight)
    refuse(ValueError, "rgba", render, values, function_2d=dict(rgba=table), **straight)


def surfaces():
    field = random.random((9, 10, 11)).astype(numpy.float32)
    grey = dict(mode="slice", color=[(0, 0, 0, 0), (1, 1, 1, 1)], device="host", size=(37, 31), tolerance=0)
    across = dict(position=(5, -20, 4), focal_point=(5, 0, 4), view_up=(0, 0, 1), parallel_scale=4)
    # The depth gives the ray's point on a surface: it is on the surface, and has the value that is linear between the voxels there.
    for surface, on in [(dict(center=(5, 4.3, 4), normal=(0, -2, 0)), lambda p: p[..., 1] - 4.3),
                        (dict(center=(5, 4.3, 4), normal=(0.4, 1, 0.3)), lambda p: (p - (5, 4.3, 4)) @ (0.4, 1, 0.3)),
                        (dict(center=(5, 4, 4), radius=3), lambda p: numpy.linalg.norm(p - (5, 4, 4), axis=-1) - 3),
                        (dict(center=(5, 4, 4), axis=(1, 1, 2), radius=2), lambda p: from_axis(p, (1, 1, 2))[1] - 2),
                        (dict(center=(5, 4, 4), axis=(1, 1, 2), angle=40), lambda p: from_axis(p, (1, 1, 2))[1] - from_axis(p, (1, 1, 2))[0] *
                         numpy.tan(numpy.radians(40))),
                        (dict(center=(5, 4, 4), square=(1, 2, 3, 0.5, 0.25, 0), linear=(0, 1, 0), constant=-9),
                         lambda p: quadric(p - (5, 4, 4)))]:
        picture = render(field, surface=surface, camera=across, **grey)
        row, column = numpy.mgrid[0:31, 0:37]
        place = numpy.stack([5 + 4 * 37 / 31 * ((2 * column + 1) / 37 - 1), picture.depth - 20, 4 - 4 * ((2 * row + 1) / 31 - 1)], axis=-1)
        seen = numpy.isfinite(picture.depth)
        check(seen.sum() > 100, f"{surface} shows in {seen.sum()} pixels")
        check(numpy.abs(on(place[seen])).max() < 2e-3, f"{surface}: {numpy.abs(on(place[seen])).max()} from it")
        wanted = trilinear(field, place[seen])
        check(numpy.abs(picture.rgba[seen][:, 0] - wanted).max() < 6e-3, f"{surface}: values {numpy.abs(picture.rgba[seen][:, 0] - wanted).max()} off")
        check((picture.rgba[seen][:, 3] == 1).all(), "opaque where nothing is said")
    thick = slab((5, 4, 4), (0, 3, 0), 2)
    cut, box = render(field, clip_planes=thick, mode="maximum", **host), render(field, crop=(0, 10, 3, 5, 0, 8), mode="maximum", **host)
    check(apart(cut, box) < 0.02 and apart(cut, render(field, mode="maximum", **host)) > 0.05, f"a slab is a crop: {apart(cut, box)}")
    check(apart(Tetrahedra(*lattice(field), device="host").render(clip_planes=thick, size=(60, 60)),
                Tetrahedra(*lattice(field), device="host").render(size=(60, 60))) > 0.05, "and cuts cells")
    for words, surface in [("plane", None), ("plane", dict(center=(0, 0, 0))), ("90", dict(center=(0, 0, 0), axis=(1, 0, 0), angle=90)),
                           ("radius", dict(center=(0, 0, 0), radius=0)), ("normal", dict(center=(0, 0, 0), normal=(0, 0, 0)))]:
        refuse(ValueError, words, render, field, mode="slice", surface=surface)
    refuse(ValueError, "slice", render, field, surface=dict(center=(0, 0, 0), radius=1))
    for words, arguments in ("thickness", ((0, 0, 0), (1, 0, 0), 0)), ("normal", ((0, 0, 0), (0, 0, 0), 1)):
        refuse(ValueError, words, slab, *arguments)


def from_axis(places, axis):
    """Distances of places from the point (5, 4, 4), along an axis through it, without sign, and from the axis."""
    own = numpy.asarray(axis) / numpy.linalg.norm(axis)
    along = (places - (5, 4, 4)) @ own
    return numpy.abs(along), numpy.linalg.norm(places - (5, 4, 4) - along[..., None] * own, axis=-1)


def quadric(d):
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    return x * x + 2 * y * y + 3 * z * z + 0.5 * x * y + 0.25 * y * z + y - 9


def trilinear(field, places):
    result = numpy.zeros(len(places))
    low = numpy.clip(numpy.floor(places).astype(int), 0, numpy.array(field.shape[::-1]) - 2)
    for corner in numpy.ndindex(2, 2, 2):
        part = numpy.where(numpy.array(corner) == 1, places - low, 1 - (places - low)).prod(axis=1)
        at = low + corner
        result += part * field[at[:, 2], at[:, 1], at[:, 0]]
    return result


def lattice(values):
    k, j, i = numpy.indices(values.shape)
    return numpy.stack([i, j, k], axis=-1).astype(float), None, values


def several():
    first, second = ball((20, 22, 24), (10, 9, 8), 8), ball((20, 22, 24), (10, 13, 16), 7)
    look, other = dict(opacity=[(0, 0), (1, 0.5)], color=(1, 0.3, 0), unit_distance=1), dict(opacity=[(0, 0), (1, 0.3)], color=(0, 0.4, 1), unit_distance=1)
    both = render(numpy.stack([first, second], axis=3), opacity=[look["opacity"], other["opacity"]], color=[look["color"], other["color"]],
                  unit_distance=1, **host)
    mixed = render_several([(first, look), (second, other)], **host)
    check(apart(mixed, both) < 6e-3 and mixed.rgba[..., 3].max() > 0.5, f"two volumes of one grid are two components: {apart(mixed, both)}")
    check(apart(render_several([(second, other), (first, look)], **host), mixed) < 4e-3, "in any order")
    check(len(mixed.counters["items"]) == 2 and mixed.counters["samples"] > 0 and "structure" in mixed.counters["items"][1], "counters of each")
    check(apart(render_several([(first, look)], **host), render(first, **look, **host)) == 0, "a single one is render's picture")
    check(apart(render_several([(first[:, :, :14], look), (first[:, :, 13:], dict(look, origin=(13, 0, 0)))], **host), render(first, **look, **host)) < 8e-3,
          "each has a place of its own")
    mesh = Tetrahedra(*lattice(second), device="host")
    cells = render_several([(first, look), (mesh, other)], **host)
    lit = cells.rgba[..., 3] > 0
    check(numpy.abs(cells.rgba - mixed.rgba)[lit].mean() < 0.02 and apart(cells, render(first, **look, **host)) > 0.1, "a mesh among them")
    surfaces = [(field, dict(mode="isosurface", contours=[0.4], opacity=[(0, 1), (1, 1)], color=how["color"])) for field, how in ((first, look), (second, other))]
    each = [render(field, **how, **host) for field, how in surfaces]
    nearest = numpy.where((each[0].depth <= each[1].depth)[..., None], each[0].rgba, each[1].rgba)
    check(numpy.abs(render_several(surfaces, **host).rgba - nearest).max() < 1e-3 and each[1].rgba.max() > 0.5, "surfaces by depth")
    kept = [(Volume(first, device="host"), look), (Volume(second, device="host"), other)]
    check(apart(render_several(kept, size=(60, 60)), mixed) == 0, "what is kept, too")
    check(render_several(kept, size=(60, 60), camera=dict(azimuth=70)).counters["items"][1]["range_builds"] == 1, "and builds nothing anew")
    hidden = numpy.full((4, 4, 4), numpy.nan)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        left = render_several([(first, look), hidden], **host)
    check(len(caught) == 1 and "none of the 64" in str(caught[0].message) and apart(left, render(first, **look, **host)) == 0, "what can't show is left out")
    whole_depth = numpy.ones((60, 60))
    refuse(ValueError, "items has 0", render_several, [])
    refuse(ValueError, "1 to 8", render_several, [first] * 9)
    refuse(TypeError, "items", render_several, 3)
    refuse(ValueError, "same Volume", render_several, [kept[0], kept[0]])
    refuse(ValueError, "item 1: mode", render_several, [first, (second, dict(mode="glow"))], **host)
    refuse(TypeError, "item 1", render_several, [first, (second, dict(gleam=1))], **host)
    refuse(Unsupported, "does not mix with composite", render_several, [first, (second, dict(mode="maximum"))], **host)
    refuse(ValueError, "depth", render_several, [first, second], opaque_depth=whole_depth[1:], **host)


def matrices():
    field = ball((16, 18, 20), (8, 9, 10), 7)
    look = dict(opacity=[(0, 0), (1, 0.6)], **host)
    placed = render(field, spacing=(2, 1, 1), origin=(3, 4, 5), **look)
    moved = render(field, matrix=[[2, 0, 0, 3], [0, 1, 0, 4], [0, 0, 1, 5], [0, 0, 0, 1]], **look)
    check(apart(placed, moved) < 2e-3, f"a matrix that stretches and moves: {apart(placed, moved)}")
    turned = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    volume = Volume(field, matrix=turned, device="host")
    check(numpy.allclose(volume.bounds, (-17, 0, 0, 19, 0, 15)), f"its bounds: {volume.bounds}")
    cells = Tetrahedra(*lattice(field), matrix=turned, device="host")
    check(numpy.allclose(cells.bounds, volume.bounds), f"bounds of cells: {cells.bounds}")
    check(numpy.abs(cells.render(size=(60, 60), opacity=look["opacity"]).rgba - volume.render(size=(60, 60), opacity=look["opacity"]).rgba).mean() < 0.01,
          "cells turn alike")
    for words, matrix in ("(4, 4)", numpy.eye(3)), ("(4, 4)", numpy.zeros((4, 4))), ("finite", numpy.eye(4) * numpy.nan), ("last row", 2 * numpy.eye(4)):
        refuse(ValueError, words, render, field, matrix=matrix)
    refuse(TypeError, "matrix", render, field, matrix="turn")
    refuse(ValueError, "matrix", render, volume, matrix=numpy.eye(4))


def cells():
    places, none, field = lattice(ball((9, 10, 11), (4, 4, 5), 5))
    two = numpy.stack([field, numpy.roll(field, 2, axis=2)], axis=3)
    look = dict(opacity=[[(0, 0), (1, 0.7)]] * 2, color=[(1, 0, 0), (0, 0, 1)], unit_distance=1)
    mesh, volume = Tetrahedra(places, none, two, device="host").render(size=(60, 60), **look), render(two, **look, **host)
    lit = volume.rgba[..., 3] > 0
    check(mesh.rgba[..., 3].max() > 0.5 and numpy.abs(mesh.rgba - volume.rgba)[lit].mean() < 0.03, "cells of two components look as a volume's do")
    one = Tetrahedra(places, none, two, device="host").render(size=(60, 60), **dict(look, opacity=[look["opacity"][0], [(0, 0), (1, 0)]]))
    single = Tetrahedra(places, none, field, device="host").render(size=(60, 60), opacity=look["opacity"][0], color=(1, 0, 0), unit_distance=1)
    check(apart(one, single) < 4e-3, f"one that shows is a single one: {apart(one, single)}")
    bytes_of = (255 * numpy.stack([field, 1 - field, field, field], axis=3)).astype(numpy.uint8)
    check(Tetrahedra(places, none, bytes_of, device="host").render(size=(60, 60), dependent=True).rgba.max() > 0.3, "bytes that are a colour")
    refuse(ValueError, "1 to 4 components", Tetrahedra, places, none, numpy.zeros((9, 10, 11, 5)))


components()
dependent()
labels()
two_variables()
surfaces()
several()
matrices()
cells()
done()
