# SPDX-License-Identifier: BSD-3-Clause
"""The picture of any grid in any mode with any features, in double precision, in NumPy. It is cut in four parts, which know nothing of one
another: rays, fields (values and gradients at places), optics (what a place shows), and modes (what a ray keeps). It shares no code with
the modules; the definitions are those of Core/stratus/ray_cast.h and docs/vtk-parity.md."""
import numpy
from vtk.util.numpy_support import vtk_to_numpy

import matrix_scenes as scenes
from vtk_verdict_reference import trilinear

STEP = 1 / 24  # of the world, where rays are sampled
OPAQUE = 1e6  # optical depth of opacity 1


# ---- rays


def rays_of(renderer):
    """Eyes and directions of length 1, (rays, 3), in the order of pixels, from the camera that the renderer has."""
    n = scenes.SIZE
    matrix = renderer.GetActiveCamera().GetCompositeProjectionTransformMatrix(1, -1, 1)
    inverse = numpy.linalg.inv(numpy.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)]))
    centers = (2 * numpy.arange(n) + 1) / n - 1
    x, y = numpy.meshgrid(centers, centers)
    ends = []
    for depth in -1.0, 1.0:
        point = numpy.stack([x, y, numpy.full_like(x, depth), numpy.ones_like(x)], -1).reshape(-1, 4) @ inverse.T
        ends.append(point[:, :3] / point[:, 3:])
    ways = ends[1] - ends[0]
    return ends[0], ways / numpy.linalg.norm(ways, axis=-1, keepdims=True)


def through(low, high, eyes, ways):
    """Where rays enter and leave a box; leave < enter: they miss it."""
    with numpy.errstate(divide="ignore", invalid="ignore"):
        crossings = numpy.stack([(low - eyes) / ways, (high - eyes) / ways])
    return numpy.maximum(numpy.nanmax(crossings.min(0), -1), 0), numpy.nanmin(crossings.max(0), -1)


# ---- fields


class Lattice:
    """Values at the crossings of planes, [z, y, x, component], linear between them."""

    def __init__(self, axes, values):
        self.axes, self.values = axes, values.astype(float)
        self.low, self.high = (numpy.array([axis[end] for axis in axes]) for end in (0, -1))
        self.spacing = numpy.mean([(axis[-1] - axis[0]) / (len(axis) - 1) for axis in axes])
        self.range = self.values.min((0, 1, 2)), self.values.max((0, 1, 2))
        self.slopes = None

    def mix(self, table, points):
        return trilinear(self.axes, table, points)

    def at(self, points):
        """Values, (places, components); NaN: there is none."""
        return numpy.where(self.holds(points)[:, None], self.mix(self.values, points), numpy.nan)

    def holds(self, points):
        return ((points >= self.low) & (points <= self.high)).all(-1)

    def gradient(self, points, component):
        if self.slopes is None:
            axes = [self.axes[2], self.axes[1], self.axes[0]]
            self.slopes = numpy.stack([numpy.stack(numpy.gradient(self.values[..., c], *axes)[::-1], -1) for c in range(self.values.shape[-1])], -1)
        return self.mix(self.slopes[..., component], points)

    def label(self, points, mask):
        """That of the nearest value."""
        return mask[self.nearest(points)]

    def nearest(self, points):
        """The numbers of the nearest value along z, y, x."""
        return tuple(numpy.clip(numpy.searchsorted((axis[1:] + axis[:-1]) / 2, x, "right"), 0, len(axis) - 1) for axis, x in zip(self.axes, points.T))[::-1]


class Mesh:
    """Tetrahedra within cubes of side 1, linear in each; a point's gradient is the mean of its cells, by volume."""

    def __init__(self, data, values, mask, labels=False):
        points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
        cells = vtk_to_numpy(data.GetCells().GetConnectivityArray()).reshape(-1, 4)
        self.low, self.high = points.min(0), points.max(0)
        self.values, self.cells = values.astype(float), cells
        p = points[cells]
        # A cell has the byte of the mask's point nearest to its middle. It is hidden where that is 0, unless bytes are labels.
        at = numpy.floor(p.mean(1) + 0.5).astype(int)
        self.bytes = numpy.ones(len(cells), int) if mask is None else mask[at[:, 2], at[:, 1], at[:, 0]]
        self.shown = (self.bytes > 0) | labels
        used = self.values[cells[self.shown]]
        self.range = used.min((0, 1)), used.max((0, 1))
        edges = p[:, 1:] - p[:, :1]
        volume = abs(numpy.linalg.det(edges)) / 6
        self.origin, self.inverse = p[:, 0], numpy.linalg.inv(edges)  # (x - origin) @ inverse: the last three weights
        cube = numpy.floor(p.mean(1)).astype(int)
        number = (cube[:, 2] * (scenes.POINTS - 1) + cube[:, 1]) * (scenes.POINTS - 1) + cube[:, 0]
        order = numpy.argsort(number, kind="stable")
        first = numpy.searchsorted(number[order], numpy.arange((scenes.POINTS - 1) ** 3 + 1))
        self.most = int(numpy.diff(first).max())
        self.of = numpy.full(((scenes.POINTS - 1) ** 3, self.most), -1)
        for i in range(self.most):
            some = first[:-1] + i < first[1:]
            self.of[some, i] = order[first[:-1][some] + i]
        self.spacing = (6 * volume[self.shown].mean()) ** (1 / 3)
        v = self.values[cells]
        slopes = numpy.einsum("cij,cjk->cik", self.inverse, v[:, 1:] - v[:, :1])  # cell, axis, component
        sums, weights, share = numpy.zeros((len(points), 3, values.shape[1])), numpy.zeros(len(points)), volume * self.shown
        for corner in range(4):
            numpy.add.at(sums, cells[:, corner], slopes * share[:, None, None])
            numpy.add.at(weights, cells[:, corner], share)
        self.slopes, self.own_slopes = sums / numpy.maximum(weights, 1e-300)[:, None, None], slopes

    def find(self, points):
        """The cell of each point, and the weights of its corners."""
        cube = numpy.clip(numpy.floor(points).astype(int), 0, scenes.POINTS - 2)
        choices = self.of[(cube[:, 2] * (scenes.POINTS - 1) + cube[:, 1]) * (scenes.POINTS - 1) + cube[:, 0]]
        best, kept, weights = numpy.full(len(points), -numpy.inf), numpy.zeros(len(points), int), numpy.zeros((len(points), 4))
        for i in range(self.most):
            cell = choices[:, i]
            last = numpy.einsum("pi,pij->pj", points - self.origin[cell], self.inverse[cell])
            w = numpy.concatenate([1 - last.sum(-1, keepdims=True), last], -1)
            better = (cell >= 0) & (w.min(-1) > best)
            best, kept, weights = numpy.where(better, w.min(-1), best), numpy.where(better, cell, kept), numpy.where(better[:, None], w, weights)
        return kept, weights

    def mix(self, table, points):
        cell, weights = self.find(points)
        return numpy.einsum("pc,pc...->p...", weights, table[self.cells[cell]])

    def slope(self, points, component):
        return self.own_slopes[self.find(points)[0], :, component]

    holds = Lattice.holds

    def label(self, points, mask):
        return self.bytes[self.find(points)[0]]

    def at(self, points):
        cell, weights = self.find(points)
        there = self.holds(points) & self.shown[cell]
        return numpy.where(there[:, None], numpy.einsum("pc,pc...->p...", weights, self.values[self.cells[cell]]), numpy.nan)

    def gradient(self, points, component):
        return self.mix(self.slopes[..., component], points)

    def face(self, points):
        """The normal of the face nearest to each point: the gradient of the least weight."""
        cell, weights = self.find(points)
        inverse = self.inverse[cell]
        slopes = numpy.concatenate([-inverse.sum(-1, keepdims=True), inverse], -1)
        return numpy.take_along_axis(slopes, weights.argmin(-1)[:, None, None], -1)[..., 0]


def field_of(grid, features):
    if grid in ("image", "blocks"):
        return Lattice([numpy.arange(scenes.POINTS, dtype=float)] * 3, scenes.lattice(features))
    if grid == "second":
        return Lattice([o + numpy.arange(scenes.POINTS) for o in scenes.SECOND], scenes.lattice(()))
    if grid == "rectilinear":
        return Lattice([scenes.coordinates()] * 3, scenes.lattice(features))
    if grid == "tetrahedra":
        data = scenes.mesh(features)
        values = vtk_to_numpy(data.GetPointData().GetScalars())
        mask = scenes.mask_values(features, grid) if {"mask", "labels"} & set(features) else None
        return Mesh(data, values.reshape(len(values), -1), mask, "labels" in features)
    fields = scenes.levels(features)
    values = numpy.stack([f.field() for f in fields], -1).transpose(2, 1, 0, 3)
    half = fields[0].spacing / fields[0].scales[-1] / 2
    field = Lattice([o + h * numpy.arange(n) for o, h, n in zip(fields[0].origin, half, values.shape[2::-1])], values)
    # Ranges are of the cells that are given, and gradient magnitudes in values per mean spacing of the coarsest level.
    field.spacing = fields[0].spacing.mean()
    field.slopes = numpy.stack([f.gradient() for f in fields], -1).transpose(2, 1, 0, 3, 4)
    field.finest = finest(fields)
    shown = [numpy.concatenate([v[s] for v, s in zip(f.values, f.shown)]) for f in fields]
    field.range = numpy.array([s.min() for s in shown]), numpy.array([s.max() for s in shown])
    return field


def finest(fields):
    """The cells that are seen, as the finest level has them: its planes, and values [z, y, x, component]."""
    scale = fields[0].scales[-1]
    cells = numpy.zeros(tuple(fields[0].counts * scale) + (len(fields),))
    for c, f in enumerate(fields):
        for values, shown, own in zip(f.values, f.shown, f.scales):
            more = numpy.ones([scale // own] * 3)
            there = numpy.kron(shown, more) > 0
            cells[there, c] = numpy.kron(values, more)[there]
    planes = [o + h / scale * numpy.arange(n * scale + 1) for o, h, n in zip(fields[0].origin, fields[0].spacing, fields[0].counts)]
    return planes, cells.transpose(2, 1, 0, 3)


# ---- optics


def between(points, x):
    points = numpy.array(points)
    return numpy.stack([numpy.interp(x, points[:, 0], points[:, c]) for c in range(1, points.shape[1])], -1)


def depth_of(opacity):
    with numpy.errstate(divide="ignore"):
        return numpy.minimum(-numpy.log1p(-opacity), OPAQUE)


class Layer:
    """A field with what a volume's property and mapper say of it."""

    def __init__(self, grid, features, mode, camera):
        self.grid, self.mode, self.camera = grid, mode, camera
        self.features = tuple(f for f in features if not (grid == "tetrahedra" and f == "function_2d"))  # VTK's mappers of meshes have none
        self.field = field_of(grid, features)
        self.components = self.field.range[0].size
        if "mask" in features or "labels" in features:
            self.mask, self.mask_field = scenes.mask_values(features, grid), self.field
            if grid == "amr":  # each value has the byte of the mask's nearest point
                at = [numpy.floor(axis + 0.5).astype(int) for axis in self.field.axes]
                inside = [(i >= 0) & (i < scenes.POINTS) for i in at]
                x, y, z = (numpy.clip(i, 0, scenes.POINTS - 1) for i in at)
                self.mask = self.mask[z[:, None, None], y[None, :, None], x[None, None, :]]
                self.mask = self.mask * (inside[2][:, None, None] & inside[1][None, :, None] & inside[0][None, None, :])

    def keeps(self, points):
        kept = numpy.ones(len(points), bool)
        if "clip" in self.features:
            kept &= (points - scenes.CLIP[0]) @ numpy.array(scenes.CLIP[1]) >= 0
        if "crop" in self.features:
            kept &= ((points >= scenes.CROP[0]) & (points <= scenes.CROP[1])).all(-1)
        if "mask" in self.features and not isinstance(self.field, Mesh):  # whose own cells are hidden
            kept &= self.mask[self.mask_field.nearest(points)] > 0
        return kept

    def value_at(self, points):
        return numpy.where(self.keeps(points)[:, None], self.field.at(points), numpy.nan)

    def media(self):
        """Independent media: which component gives the colour and opacity of each."""
        return [self.components - 1] if "rgba" in self.features else range(self.components)

    def look(self, value, medium):
        """Colour and opacity of values (places, components), not lit."""
        v = value[:, medium]
        if "rgba" in self.features:
            return value[:, :3] / 255, between(scenes.RGBA_OPACITY, v)[:, 0]
        return between(scenes.COLOR, v), between(scenes.OPACITY, v)[:, 0]

    def lit(self, points, ways, rgb, gradient):
        """VTK's light: a headlight from the eye's plane, ambient .1, diffuse .7, specular .2, power 10, both sides."""
        def unit(v):
            length = numpy.linalg.norm(v, axis=-1, keepdims=True)
            return numpy.divide(v, length, out=numpy.zeros_like(v), where=length > 0)

        normal = unit(-gradient)
        normal = numpy.where((normal * ways).sum(-1, keepdims=True) > 0, -normal, normal)
        to_light = -unit(self.camera[None, :])
        cosine = numpy.maximum((normal * to_light).sum(-1), 0)
        gloss = numpy.maximum((normal * unit(to_light - ways)).sum(-1), 0)
        shine = numpy.where(cosine > 0, 0.2 * gloss**10, 0)
        return rgb * (0.1 + 0.7 * cosine)[:, None] + shine[:, None]

    def lit_solid(self, ways, rgb, normal):
        """Phong's light of first hits, with the reflected ray."""
        normal = numpy.where((normal * ways).sum(-1, keepdims=True) > 0, -normal, normal)
        to_light = -self.camera / numpy.linalg.norm(self.camera)
        cosine = numpy.maximum(normal @ to_light, 0)
        mirrored = 2 * (normal @ to_light)[:, None] * normal - to_light
        shine = numpy.where(cosine > 0, 0.2 * numpy.maximum((mirrored * -ways).sum(-1), 0) ** 10, 0)
        return rgb * (0.1 + 0.7 * cosine)[:, None] + shine[:, None]

    def shade(self, points, ways, value):
        """Optical depth and light that is emitted, each per length, of composite."""
        tau, glow = numpy.zeros(len(points)), numpy.zeros((len(points), 3))
        for m in self.media():
            rgb, opacity = self.look(value, m)
            if "labels" in self.features:
                label = self.field.label(points, self.mask) > 0
                rgb = numpy.where(label[:, None], between(scenes.LABEL_COLOR, value[:, m]), rgb)
                opacity = numpy.where(label, between(scenes.LABEL_OPACITY, value[:, m])[:, 0], opacity)
            gradient = None
            if {"light", "gradient_opacity", "function_2d"} & set(self.features):
                gradient = self.field.gradient(points, m)
            steepness = None if gradient is None else numpy.linalg.norm(gradient, axis=-1) * self.field.spacing
            if "function_2d" in self.features:
                rgb, opacity = self.look_2d(value[:, m], steepness, m)
            depth = depth_of(opacity)
            if "gradient_opacity" in self.features and "function_2d" not in self.features:
                depth = depth * between(scenes.GRADIENT_OPACITY, steepness)[:, 0]
            if "light" in self.features:
                rgb = self.lit(points, ways, rgb, gradient)
            tau += depth
            glow += depth[:, None] * rgb
        return tau, glow

    def look_2d(self, value, steepness, m):
        low, high = self.field.range[0][m], self.field.range[1][m]
        rows, columns, _ = scenes.TABLE.shape
        result = 0.0
        spots = []
        for number, first, last, entries in (value, low, high, columns), (steepness, 0.0, 0.25 * (high - low), rows):
            place = numpy.clip((number - first) / (last - first) * entries - 0.5, 0, entries - 1)
            entry = numpy.minimum(place.astype(int), entries - 2)
            spots.append((entry, place - entry))
        (i, u), (j, v) = spots
        for dj in 0, 1:
            for di in 0, 1:
                result = result + ((u if di else 1 - u) * (v if dj else 1 - v))[:, None] * scenes.TABLE[j + dj, i + di]
        return result[:, :3], result[:, 3]


# ---- modes


def samples(layers, eyes, ways):
    """The middles of steps along rays, front to back: distances (rays, steps)."""
    spans = [through(l.field.low, l.field.high, eyes, ways) for l in layers]
    meets = numpy.stack([b > a for a, b in spans])
    first = numpy.where(meets, [a for a, b in spans], numpy.inf).min(0)
    last = numpy.where(meets, [b for a, b in spans], -numpy.inf).max(0)
    some = last > first
    steps = int(numpy.ceil((last - first)[some].max() / STEP))
    return numpy.flatnonzero(some), numpy.where(some, first, 0), numpy.where(some, last, 0), steps


def composite(layers, eyes, ways):
    some, first, last, steps = samples(layers, eyes, ways)
    light, passed = numpy.zeros((len(eyes), 3)), numpy.ones(len(eyes))
    for n in range(steps):
        s = first + (n + 0.5) * STEP
        at = some[s[some] - 0.5 * STEP < last[some]]
        if not at.size:
            break
        points = eyes[at] + s[at, None] * ways[at]
        tau, glow = numpy.zeros(len(at)), numpy.zeros((len(at), 3))
        for layer in layers:
            value = layer.value_at(points)
            for m in [None] if "rgba" in layer.features or layer.components == 1 else [None]:
                there = numpy.isfinite(value).all(-1)
                if there.any():
                    t, g = layer.shade(points[there], ways[at][there], value[there])
                    tau[there] += t
                    glow[there] += g
        alpha = -numpy.expm1(-tau * STEP)
        light[at] += (passed[at] * alpha / numpy.maximum(tau, 1e-300))[:, None] * glow
        passed[at] *= 1 - alpha
    return light


def along(layers, eyes, ways, cut=True):
    """All samples of each layer: ray numbers, values (samples, components), in the order of distance a ray. What clip planes, crop regions and
    masks hide is NaN, unless cut is false."""
    some, first, last, steps = samples(layers, eyes, ways)
    s = first[some, None] + (numpy.arange(steps) + 0.5) * STEP
    inside = s < last[some, None]
    ray = numpy.broadcast_to(some[:, None], s.shape)[inside]
    s = s[inside]
    points = eyes[ray] + s[:, None] * ways[ray]
    return ray, s, [layer.value_at(points) if cut else layer.field.at(points) for layer in layers]


def extremes(layers, eyes, ways, sign):
    """Each independent component by itself, added; of several volumes, the best of the values that show."""
    ray, _, values = along(layers, eyes, ways)
    total = numpy.zeros((len(eyes), 3))
    for turn in range(max(len(layer.media()) for layer in layers)):
        shown, kept = numpy.zeros((len(eyes), 3)), numpy.full(len(eyes), -numpy.inf)
        for layer, value in zip(layers, values):
            if turn >= len(layer.media()):
                continue
            m = layer.media()[turn]
            best = numpy.full(len(eyes), -numpy.inf)
            v = numpy.where(numpy.isfinite(value[:, m]), sign * value[:, m], -numpy.inf)
            numpy.maximum.at(best, ray, v)
            found = numpy.isfinite(best)
            rows = numpy.zeros((len(eyes), layer.components))
            rows[:, m] = numpy.where(found, sign * best, 0)
            if "rgba" in layer.features:  # the colour of the first sample with the best opacity
                at = numpy.flatnonzero(found[ray] & (v == best[ray]))
                rows[ray[at][::-1]] = value[at][::-1]
            rgb, opacity = layer.look(rows, m)
            better = found & (best > kept) & ((opacity > 0) | (len(layers) == 1))
            shown[better], kept[better] = (rgb * opacity[:, None])[better], best[better]
        total += shown
    return numpy.minimum(total, 1)


def sums(layers, eyes, ways, mean):
    """Opacity times value as a part of the volume's range: its integral, or its mean over all volumes; components are added. Of dependent
    components, the last one's opacity times the first one's value."""
    ray, _, values = along(layers, eyes, ways)
    shown = numpy.zeros(len(eyes))
    for turn in range(max(len(layer.media()) for layer in layers)):
        total, counted = numpy.zeros(len(eyes)), numpy.zeros(len(eyes))
        for layer, value in zip(layers, values):
            if turn >= len(layer.media()):
                continue
            m = layer.media()[turn]
            grey = 0 if "rgba" in layer.features else m
            low, high = layer.field.range[0][grey], layer.field.range[1][grey]
            there = numpy.isfinite(value).all(-1)
            _, opacity = layer.look(numpy.where(there[:, None], value, 0), m)
            numpy.add.at(total, ray, numpy.where(there, opacity * (value[:, grey] - low) / (high - low), 0) * STEP)
            numpy.add.at(counted, ray, there * STEP)
        shown += numpy.minimum(total / numpy.maximum(counted, 1e-300) if mean else total, 1)
    return numpy.minimum(shown, 1)[:, None] * numpy.ones(3)


def blend(count, ray, s, rgb, alpha):
    """Layers behind one another, by distance."""
    order = numpy.lexsort((s, ray))
    light, passed = numpy.zeros((count, 3)), numpy.ones(count)
    ray, rgb, alpha = ray[order], rgb[order], alpha[order]
    turn = numpy.arange(len(ray)) - numpy.searchsorted(ray, ray)
    for n in range(turn.max() + 1 if len(turn) else 0):
        at = turn == n
        light[ray[at]] += (passed[ray[at]] * alpha[at])[:, None] * rgb[at]
        passed[ray[at]] *= 1 - alpha[at]
    return light


def isosurface(layers, eyes, ways):
    """Crossings are found in the whole field: a step that a plane cuts may cross on the side that is seen."""
    ray, s, values = along(layers, eyes, ways, cut=False)
    found = []
    for layer, value, m in [(layer, value, m) for layer, value in zip(layers, values) for m in layer.media()]:
        contour = scenes.CONTOUR * (200 if "rgba" in layer.features else 1)
        v = value[:, m] - contour
        with numpy.errstate(invalid="ignore"):
            cross = numpy.flatnonzero((ray[1:] == ray[:-1]) & ((v[1:] < 0) != (v[:-1] < 0)) & numpy.isfinite(v[1:]) & numpy.isfinite(v[:-1]))
        low, high, rises = s[cross].copy(), s[cross + 1].copy(), v[cross] < 0
        for _ in range(40):
            middle = (low + high) / 2
            below = layer.field.at(eyes[ray[cross]] + middle[:, None] * ways[ray[cross]])[:, m] < contour
            low, high = numpy.where(below == rises, middle, low), numpy.where(below == rises, high, middle)
        points = eyes[ray[cross]] + low[:, None] * ways[ray[cross]]
        seen = layer.keeps(points)
        cross, low, points = cross[seen], low[seen], points[seen]
        rgb, opacity = layer.look(numpy.where(numpy.arange(layer.components) == m, contour, layer.field.at(points)), m)
        if "light" in layer.features:
            rgb = layer.lit(points, ways[ray[cross]], rgb, layer.field.gradient(points, m))
        found.append((ray[cross], low, rgb, opacity))
    return blend(len(eyes), *[numpy.concatenate(f) for f in zip(*found)])


def slices(layers, eyes, ways):
    point, normal = (numpy.array(p) for p in scenes.SLICE)
    s = ((point - eyes) @ normal) / (ways @ normal)
    points = eyes + s[:, None] * ways
    found = []
    for layer in layers:
        value = layer.value_at(points)
        there = numpy.isfinite(value).all(-1) & (s > 0)
        depth, light = numpy.zeros(there.sum()), numpy.zeros((there.sum(), 3))  # components mix as in composite
        for m in layer.media():
            rgb, opacity = layer.look(value[there], m)
            depth += depth_of(opacity)
            light += depth_of(opacity)[:, None] * rgb
        found.append((numpy.flatnonzero(there), s[there], light / numpy.maximum(depth, 1e-300)[:, None], -numpy.expm1(-depth)))
    return blend(len(eyes), *[numpy.concatenate(f) for f in zip(*found)])


def solid_mesh(layer, m, eyes, ways):
    """For each ray the first place where a mesh's field shows, and its colour: between the planes on which the faces of cells are, the field
    is linear, and shows nowhere if it does at neither end. Bisection finds the place. There the normal is the cell's gradient or, where the
    ray enters a cell or its seen part begins, that of the face or the plane."""
    cuts = []
    for x, y, z in (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 1, 1):
        way = numpy.array([x, y, z], float)
        last = scenes.POINTS - 1
        cuts.append((numpy.arange(last * numpy.minimum(way, 0).sum(), last * numpy.maximum(way, 0).sum() + 1) - eyes @ way[:, None]) / (ways @ way)[:, None])
    if "crop" in layer.features:
        cuts += [(numpy.array(scenes.CROP) - eyes[:, a : a + 1]) / ways[:, a : a + 1] for a in range(3)]
    if "clip" in layer.features:
        point, way = numpy.array(scenes.CLIP)
        cuts.append((((point - eyes) @ way) / (ways @ way))[:, None])
    first, last = through(layer.field.low, layer.field.high, eyes, ways)
    s = numpy.sort(numpy.concatenate(cuts, -1), -1)
    s = numpy.stack([s - 1e-7, s + 1e-7], -1).reshape(len(eyes), -1)
    ray, at = numpy.nonzero((s > first[:, None]) & (s < last[:, None]))
    before, s = s[ray, numpy.maximum(at - 1, 0)], s[ray, at]
    value = layer.value_at(eyes[ray] + s[:, None] * ways[ray])
    at = numpy.flatnonzero(numpy.isfinite(value[:, m]) & (layer.look(value, m)[1] > 0))
    at = at[numpy.unique(ray[at], return_index=True)[1]]
    ray, low, high = ray[at], before[at], s[at].copy()
    eyes, ways = eyes[ray], ways[ray]

    def shows(s):
        value = layer.value_at(eyes + s[:, None] * ways)
        return numpy.isfinite(value[:, m]) & (layer.look(value, m)[1] > 0)

    for _ in range(40):
        middle = (low + high) / 2
        seen = shows(middle)
        low, high = numpy.where(seen, low, middle), numpy.where(seen, middle, high)
    points = eyes + high[:, None] * ways
    rgb = layer.look(layer.field.at(points), m)[0]
    if "light" in layer.features:
        enters = ~numpy.isfinite(layer.value_at(points - 1e-6 * ways)[:, m])
        normal = numpy.where(enters[:, None], layer.field.face(points + 1e-6 * ways), layer.field.slope(points + 1e-6 * ways, m))
        planes = [(abs(points[:, a] - c), numpy.eye(3)[a]) for c in scenes.CROP if "crop" in layer.features for a in range(3)]
        if "clip" in layer.features:
            planes.append((abs((points - scenes.CLIP[0]) @ scenes.CLIP[1]), scenes.CLIP[1]))
        for distance, plane in planes:
            normal[distance < 1e-6] = plane
        rgb = layer.lit_solid(ways, rgb, normal / numpy.linalg.norm(normal, axis=-1, keepdims=True))
    return ray, high, numpy.ones(len(ray), bool), rgb


def first_hits(layers, eyes, ways):
    """The box about the first value of opacity above 0, or of tetrahedra the first place of such a value; of components, the nearest."""
    light, nearest = numpy.zeros((len(eyes), 3)), numpy.full(len(eyes), numpy.inf)
    for layer, m in [(layer, m) for layer in layers for m in layer.media()]:
        field = layer.field
        if isinstance(field, Mesh):
            ray, s, shows, rgb = solid_mesh(layer, m, eyes, ways)
        else:
            borders = [numpy.concatenate([[a[0] - (a[1] - a[0]) / 2], (a[1:] + a[:-1]) / 2, [a[-1] + (a[-1] - a[-2]) / 2]]) for a in field.axes]
            if layer.grid == "amr":
                borders, cells = field.finest
            cuts = [((b - eyes[:, a : a + 1]) / ways[:, a : a + 1]) for a, b in enumerate(borders)]
            axis_of = numpy.repeat([0, 1, 2], [len(b) for b in borders])
            if "crop" in layer.features:
                cuts += [(numpy.array(scenes.CROP) - eyes[:, a : a + 1]) / ways[:, a : a + 1] for a in range(3)]
                axis_of = numpy.concatenate([axis_of, numpy.repeat([0, 1, 2], 2)])
            if "clip" in layer.features:
                point, way = numpy.array(scenes.CLIP)
                cuts.append((((point - eyes) @ way) / (ways @ way))[:, None])
                axis_of = numpy.append(axis_of, int(numpy.argmax(way)))
            t = numpy.concatenate(cuts, -1)
            order = numpy.argsort(t, -1)
            t, axis_of = numpy.take_along_axis(t, order, -1), axis_of[order][:, :-1].reshape(-1)
            s = numpy.maximum((t[:, 1:] + t[:, :-1]) / 2, 0)
            ray = numpy.repeat(numpy.arange(len(eyes)), s.shape[1])
            points = eyes[ray] + s.reshape(-1, 1) * ways[ray]
            entry = t[:, :-1].reshape(-1)
            low, high = (numpy.array([b[end] for b in borders]) for end in (0, -1))
            inside = ((points > low) & (points < high)).all(-1) & layer.keeps(points)
            if layer.grid == "amr":
                at = tuple(numpy.clip(numpy.searchsorted(b, x, "right") - 1, 0, len(b) - 2) for b, x in zip(borders, points.T))[::-1]
                value = cells[at]
            else:
                value = field.values[field.nearest(points)]
            shows = inside & (layer.look(value, m)[1] > 0)
            rgb, s = layer.look(value, m)[0], entry
            if "light" in layer.features:
                normal = numpy.zeros_like(points)
                numpy.put_along_axis(normal, axis_of[:, None], 1, -1)
                rgb = layer.lit_solid(ways[ray], rgb, normal)
        at = numpy.flatnonzero(shows)
        at = at[numpy.lexsort((s[at], ray[at]))]
        _, first = numpy.unique(ray[at], return_index=True)
        at = at[first]
        color = rgb[at]
        better = s[at] < nearest[ray[at]]
        light[ray[at][better]], nearest[ray[at][better]] = color[better], s[at][better]
    return light


MODES = {
    "composite": composite,
    "maximum": lambda *a: extremes(*a, 1),
    "minimum": lambda *a: extremes(*a, -1),
    "average": lambda *a: sums(*a, True),
    "additive": lambda *a: sums(*a, False),
    "isosurface": isosurface,
    "slice": slices,
    "first_hit": first_hits,
}


def picture(grid, mode, features, renderer):
    """Floats of 0..1, (y, x, rgb), on black."""
    camera = numpy.array(renderer.GetActiveCamera().GetDirectionOfProjection())
    parts = {"several": ("image", "second"), "image_and_mesh": ("image", "tetrahedra")}.get(grid, (grid,))
    layers = [Layer(part, features if n == 0 else (), mode, camera) for n, part in enumerate(parts)]
    light = MODES[mode](layers, *rays_of(renderer))
    return numpy.clip(light, 0, 1).reshape(scenes.SIZE, scenes.SIZE, 3)
