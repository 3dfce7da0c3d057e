# SPDX-License-Identifier: BSD-3-Clause
"""stratus_volume's octree of boxes, partition and visibility order of tetrahedra, against brute force in NumPy."""
from checking import check, done, refuse
from lattice import cubes

import numpy

from stratus_volume import Octree, Partition, VisibilityOrder, partition

random = numpy.random.default_rng(11)


def boxes_of(count):
    middle, half = random.uniform(-50, 50, (count, 3)), random.uniform(0.1, 3, (count, 3))
    return numpy.stack([middle - half, middle + half], axis=2).reshape(count, 6)


def seen_by(planes, bounds):
    """Boxes that reach into each of the half-spaces: by their farthest corner."""
    result = numpy.ones(len(bounds), bool)
    low, high = bounds[:, ::2], bounds[:, 1::2]
    for plane in numpy.asarray(planes, float):
        result &= (numpy.where(plane[:3] >= 0, high, low) @ plane[:3] + plane[3]) >= 0
    return numpy.nonzero(result)[0]


def culled():
    bounds = boxes_of(4000)
    # A camera at the origin that looks along +y, 40 degrees high and as wide.
    slope = numpy.tan(numpy.radians(20))
    planes = [(1, slope, 0, 0), (-1, slope, 0, 0), (0, slope, 1, 0), (0, slope, -1, 0), (0, 1, 0, -2), (0, -1, 0, 45)]
    wanted = seen_by(planes, bounds)
    camera = dict(position=(0, 0, 0), focal_point=(0, 1, 0), view_up=(0, 0, 1), view_angle=40)
    check(100 < len(wanted) < 2000, f"some are seen, not all: {len(wanted)}")
    for options in {}, dict(levels=0), dict(stop="static", levels=4), dict(stop="manhattan"), dict(stop="euclid", looseness=1), dict(leaf_objects=8):
        tree = Octree(bounds, **options)
        for view in range(3):  # the tree is finer each time
            found = tree.cull(planes=planes)
            check(numpy.array_equal(numpy.sort(found.ids), wanted), f"{options}: {len(found.ids)} of {len(wanted)} are seen by planes")
        found = tree.cull(camera, size=(100, 100), near=2, far=45, coverage=True, view="other")
        check(numpy.array_equal(numpy.sort(found.ids), wanted), f"{options}: {len(found.ids)} of {len(wanted)} are seen by a camera")
        check(len(found.coverage) == len(found.depth) == len(wanted) and (found.coverage > 0).all() and found.coverage.max() <= 1, "coverage")
        middle = bounds[found.ids].reshape(-1, 3, 2).mean(axis=2)
        check(numpy.allclose(found.depth, middle[:, 1] - 2, atol=1e-3), "depth is from the near plane")
        check(found.counters["objects_tested"] > 0 and len(tree) == 4000 and tree.statistics["objects"] == 4000, f"counters: {found.counters}")
    exact = tree.cull(planes=planes, exact=True).ids
    check(set(exact) < set(wanted) and len(exact) > 80, "exact leaves out boxes that the planes keep")
    moved = bounds.copy()
    moved[:500] += 7
    tree.move(numpy.arange(500), moved[:500])
    check(numpy.array_equal(numpy.sort(tree.cull(planes=planes).ids), seen_by(planes, moved)), "boxes that move")
    tree.remove(numpy.arange(1000, 4000))
    check(numpy.array_equal(numpy.sort(tree.cull(planes=planes).ids), seen_by(planes, moved[:1000])), "boxes that are gone")
    check(numpy.array_equal(tree.bounds([3, 700]), moved[[3, 700]]), "bounds as they were given")
    turned = Octree([[0, 10, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]])
    check(list(turned.cull(planes=planes).ids) == [0] and numpy.allclose(turned.bounds(0), [[-1, 1, 9, 11, -1, 1]]), "a turned box")
    check(len(Octree().cull(planes=planes).ids) == 0, "no boxes")
    for words, options in ("placement", dict(placement="beside")), ("stop", dict(stop="never")), ("0..21", dict(levels=22)), ("looseness", dict(looseness=3)):
        refuse(ValueError, words, Octree, bounds, **options)
    refuse(ValueError, "(3,)", Octree, [1, 2, 3])
    refuse(ValueError, "0", Octree, [[1, 0, 0, 1, 0, 1]])
    refuse(ValueError, "(6, 4)", tree.cull, planes=planes[:5])
    refuse(ValueError, "near", tree.cull, near=5, far=2)
    refuse(ValueError, "", tree.move, [2000], [[0, 1, 0, 1, 0, 1]])
    refuse(ValueError, "as many", tree.move, [1, 2], [[0, 1, 0, 1, 0, 1]])
    refuse(ValueError, "ids", tree.remove, [-1])


def asked():
    bounds = boxes_of(1500)
    low, high = bounds[:, ::2], bounds[:, 1::2]
    tree = Octree(bounds, leaf_objects=16)
    for _ in range(20):
        box = numpy.sort(random.uniform(-50, 50, (3, 2)), axis=1).reshape(6)
        touch = ((low <= box[1::2]) & (high >= box[::2])).all(axis=1)
        check(numpy.array_equal(tree.in_box(box), numpy.nonzero(touch)[0]), "boxes that touch a box")
        point, radius = random.uniform(-50, 50, 3), random.uniform(0, 15)
        far = numpy.linalg.norm(numpy.maximum(0, numpy.maximum(low - point, point - high)), axis=1)
        check(numpy.array_equal(tree.in_sphere(point, radius), numpy.nonzero(far <= radius)[0]), "that touch a ball")
        ids, distances = tree.nearest(point, 7)
        check(numpy.allclose(distances, numpy.sort(far)[:7]) and numpy.allclose(far[ids], distances), "the nearest")
        direction = random.normal(size=3)
        a, b = (low - point) / direction, (high - point) / direction
        enter, leave = numpy.maximum(numpy.minimum(a, b).max(axis=1), 0), numpy.maximum(a, b).min(axis=1)
        hit = numpy.nonzero((enter <= leave) & (enter <= 60))[0]
        ids, t = tree.along_ray(point, direction, 60)
        check(numpy.array_equal(numpy.sort(ids), hit) and numpy.allclose(t, enter[ids]) and (numpy.diff(t) >= 0).all(), "along a ray")
    check(len(tree.nearest((0, 0, 0), 9999)[0]) == 1500 and len(tree.in_sphere((0, 0, 0), numpy.inf)) == 1500, "all of them")
    refuse(ValueError, "radius", tree.in_sphere, (0, 0, 0), -1)
    refuse(ValueError, "k", tree.nearest, (0, 0, 0), 0)
    refuse(ValueError, "", tree.along_ray, (0, 0, 0), (0, 0, 0))


def moved_cubes(shape):
    """Points and tetrahedra of a lattice, moved a little so that no plane holds many faces."""
    places, cells = cubes(shape)
    return places + random.uniform(-0.15, 0.15, places.shape), cells


def volumes(places, cells):
    edges = places[cells[:, 1:]] - places[cells[:, :1]]
    return numpy.abs(numpy.linalg.det(edges)) / 6


def faces(cells):
    """Pairs of cells that share a face: their numbers, and the face's points."""
    corners = numpy.array([(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)])
    every = numpy.sort(cells[:, corners].reshape(-1, 3), axis=1)
    order = numpy.lexsort(every.T)
    same = (every[order[1:]] == every[order[:-1]]).all(axis=1)
    return order[:-1][same] // 4, order[1:][same] // 4, every[order[:-1][same]]


def in_order(places, cells, order, eye):
    """Counts the pairs of neighbours of which the one on the eye's side of their common face comes later."""
    rank = numpy.empty(len(cells), int)
    rank[order] = numpy.arange(len(cells))
    one, other, shared = faces(cells)
    corner = places[shared]
    normal = numpy.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])

    def side(points):
        return numpy.sign(((points - corner[:, 0]) * normal).sum(axis=1))
    of_eye, of_one = side(eye), side(places[cells[one]].mean(axis=1))
    nearer_one = of_eye == of_one
    wrong = numpy.where(nearer_one, rank[one] > rank[other], rank[other] > rank[one])
    return int(wrong[of_eye != 0].sum()), len(one)


def partitioned():
    places, cells = moved_cubes((6, 7, 8))
    whole = volumes(places, cells)
    for options in dict(depth=3, leaf_cells=1), dict(depth=2, rule="paper", leaf_cells=1), dict(depth=0):
        cut = partition(places, cells, device="host", **options)
        check(isinstance(cut, Partition) and cut.counters["leaves"] == (1 if options["depth"] == 0 else 2 ** options["depth"]), f"{options}: {cut.counters}")
        pieces = volumes(cut.points, cut.tetrahedra)
        check(numpy.allclose(numpy.bincount(cut.cells, pieces, len(cells)), whole), "pieces fill their cells")
        check(numpy.array_equal(cut.points[:len(places)], places) and len(cut.ends) == len(cut.weights) == len(cut.points) - len(places), "points are kept")
        linear = places @ (3, -2, 0.5) + 1
        check(numpy.allclose(cut.at_points(linear), cut.points @ (3, -2, 0.5) + 1), "values on cut edges")
        check(numpy.allclose(cut.at_points(places), cut.points), "of several components")
        # Each leaf is on its side of the planes above it.
        stack = [(0, numpy.ones(len(cut.leaf), bool))]
        while stack:
            at, within = stack.pop()
            node = cut.nodes[at]
            if node["axis"] < 0:
                check((cut.leaf[within] == node["below"]).all() and (cut.leaf == node["below"]).sum() == within.sum(), "leaves are the tree's")
                continue
            heights = (cut.points @ cut.frame[node["axis"]])[cut.tetrahedra]
            below = within & (heights.max(axis=1) <= node["value"] + 1e-9)
            above = within & (heights.min(axis=1) >= node["value"] - 1e-9)
            check((below ^ above)[within].all(), "no cell crosses its planes")
            stack += [(node["below"], below), (node["above"], above)]
    refuse(ValueError, "0..16", partition, places, cells, depth=17)
    refuse(ValueError, "growth", partition, places, cells, growth=0)
    refuse(TypeError, "imbalance", partition, places, cells, imbalance="x")
    refuse(ValueError, "rule", partition, places, cells, rule="half")
    refuse(ValueError, "(990, 2)", partition, numpy.zeros((990, 2)), cells)
    refuse(ValueError, "336", cut.at_points, linear[1:])


def ordered():
    places, cells = moved_cubes((6, 7, 8))
    cut = partition(places, cells, depth=2, leaf_cells=1, device="host")
    for order, points, own in (VisibilityOrder(places, cells, device="host"), places, cells), (VisibilityOrder(cut), cut.points, cut.tetrahedra):
        for eye in (20, -30, 12), (3.5, 3, 2.5), (-9, 4, 2):
            for peeling in "nearest", "layers":
                found, counters = order.sort(dict(position=eye, focal_point=(3.4, 3.1, 2.6)), peeling)
                check(numpy.array_equal(numpy.sort(found), numpy.arange(len(own))), "each cell once")
                wrong, pairs = in_order(points, own, found, numpy.array(eye, float))
                check(wrong <= counters["cycles"] and pairs > 2000, f"{peeling} from {eye}: {wrong} of {pairs} pairs are in the wrong order")
    backwards = in_order(places, cells, VisibilityOrder(places, cells, device="host").sort(dict(position=(20, -30, 12), focal_point=(3, 3, 2)))[0][::-1],
                         numpy.array([20.0, -30, 12]))
    check(backwards[0] > 0.9 * backwards[1], "the check finds a wrong order")
    again = order.sort(dict(position=eye, focal_point=(3.4, 3.1, 2.6)), "layers")[1]
    check(again["reused"] == 1, "the same view is not sorted anew")
    refuse(ValueError, "peeling", order.sort, None, "random")
    refuse(ValueError, "Partition", VisibilityOrder, cut, cells)


culled()
asked()
partitioned()
ordered()
done()
