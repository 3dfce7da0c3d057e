# SPDX-License-Identifier: BSD-3-Clause
"""A lattice of tetrahedra."""
import numpy


def cubes(shape):
    """Points and tetrahedra of a lattice, six for each cube."""
    k, j, i = numpy.indices(shape)
    places = numpy.stack([i, j, k], axis=-1).reshape(-1, 3).astype(float)
    number = numpy.arange(len(places)).reshape(shape)
    first = number[:-1, :-1, :-1].reshape(-1)
    steps = numpy.array([1, shape[2], shape[1] * shape[2]])
    cells = [numpy.stack([first, first + steps[a], first + steps[a] + steps[b], first + steps.sum()], axis=1)
             for a in range(3) for b in range(3) if a != b]
    return places, numpy.concatenate(cells)
