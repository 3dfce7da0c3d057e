# SPDX-License-Identifier: BSD-3-Clause
"""AMR of any levels for tests, and the field that is meant by it: by brute force in double, on the whole lattice of half the finest cells,
level by level. It shares nothing with the modules but the definition in Filters/Common/vtkStratusAMRField.h."""
import numpy


def bump(x, y, z):
    """Smooth, in 0..1.3: a shell within the finest boxes of `uneven`, and a wide hill beyond them."""
    r = numpy.sqrt((x - 8.4) ** 2 + (y - 5.6) ** 2 + (z - 5.9) ** 2)
    return numpy.exp(-(((r - 1.3) / 0.6) ** 2)) + 0.3 * numpy.exp(-((x - 6) ** 2 + (y - 5) ** 2 + (z - 5) ** 2) / 14)


def uneven(ratios=(2, 2)):
    """Boxes (level, lo, hi in the level's cells): three levels, of which the finest covers an L that touches the border of its level."""
    r, s = ratios
    first = [((5, 3, 2), (13, 10, 8)), ((2, 5, 4), (5, 8, 8))]
    second = [((6, 4, 3), (11, 8, 8)), ((6, 8, 3), (9, 10, 8))]  # in cells of level 0
    boxes = [(0, (0, 0, 0), (16, 6, 10)), (0, (0, 6, 0), (16, 12, 10))]
    boxes += [(1, tuple(r * i for i in lo), tuple(r * i for i in hi)) for lo, hi in first]
    return boxes + [(2, tuple(r * s * i for i in lo), tuple(r * s * i for i in hi)) for lo, hi in second]


class Refined:
    """Values on boxes: of cells, or of points. values[l] and there[l] are of all the space in level l's cells or points."""

    def __init__(self, boxes, ratios=(2, 2), counts=(16, 12, 10), spacing=(1.0, 1.0, 1.0), cells=True, function=bump, origin=(0.0, 0.0, 0.0)):
        self.boxes, self.cells, self.origin = boxes, cells, numpy.array(origin)
        self.scales = [numpy.prod(ratios[:level], dtype=int) for level in range(len(ratios) + 1)]
        self.ratios, self.counts, self.spacing = ratios, numpy.array(counts), numpy.array(spacing)
        self.values, self.there = [], []
        for level, scale in enumerate(self.scales):
            n = self.counts * scale
            axes = [o + h / scale * (numpy.arange(m + (0 if cells else 1)) + (0.5 if cells else 0)) for o, h, m in zip(origin, spacing, n)]
            self.values.append(function(*numpy.meshgrid(*axes, indexing="ij")))
            there = numpy.zeros(n, bool)
            for own, lo, hi in boxes:
                if own == level:
                    there[tuple(slice(a, b) for a, b in zip(lo, hi))] = True
            self.there.append(there)
        self.shown = []  # cells that no finer one covers
        for level, there in enumerate(self.there):
            shown = there.copy()
            if level + 1 < len(self.there):
                r = ratios[level]
                shown &= ~self.there[level + 1][::r, ::r, ::r]
            self.shown.append(shown)

    def data(self, make, name="values", kind=numpy.float64):
        """As vtkOverlappingAMR. make: the module that has VTK's classes, vtk or paraview.vtk. Covered values are made useless."""
        from vtkmodules.util.numpy_support import numpy_to_vtk

        amr = make.vtkOverlappingAMR()
        levels = len(self.scales)
        amr.Initialize(levels, [sum(level == own for own, *_ in self.boxes) for level in range(levels)])
        amr.SetOrigin(self.origin)
        amr.SetGridDescription(8)  # VTK_XYZ_GRID
        for level, scale in enumerate(self.scales):
            amr.SetSpacing(level, self.spacing / scale)
            if level + 1 < levels:
                amr.SetRefinementRatio(level, self.ratios[level])
            for number, (_, lo, hi) in enumerate([box for box in self.boxes if box[0] == level]):
                grid = make.vtkUniformGrid()
                grid.SetOrigin(self.origin + self.spacing / scale * lo)
                grid.SetSpacing(self.spacing / scale)
                grid.SetDimensions(*[b - a + 1 for a, b in zip(lo, hi)])
                more = 0 if self.cells else 1
                part = tuple(slice(a, b + more) for a, b in zip(lo, hi))
                values = self.values[level][part].copy()
                if self.cells:
                    values[~self.shown[level][part]] = 77
                array = numpy_to_vtk(numpy.ascontiguousarray(values.reshape(-1, order="F").astype(kind)), deep=True)
                array.SetName(name)
                (grid.GetCellData() if self.cells else grid.GetPointData()).SetScalars(array)
                amr.SetAMRBox(level, number, make.vtkAMRBox(lo, [b - 1 for b in hi]))
                amr.SetDataSet(level, number, grid)
        return amr

    def finer(self):
        """Values in which a covered cell has the mean of the finer cells around its centre."""
        values = [v.copy() for v in self.values]
        for level in range(len(values) - 2, -1, -1):
            r = self.ratios[level]
            inner = [r // 2] if r % 2 else [r // 2 - 1, r // 2]
            parts = [values[level + 1][i::r, j::r, k::r] for i in inner for j in inner for k in inner]
            covered = self.there[level] & ~self.shown[level]
            values[level][covered] = (sum(parts) / len(parts))[covered]
        return values

    def gradient(self):
        """The field's derivatives along the axes at the corners of half the finest cells: differences over the width of a cell of each level, about
        the centres of all its cells (at its points), and between these as values are."""
        field, unit, result = self.field(), self.spacing / self.scales[-1] / 2, []
        for axis in range(3):
            slopes = []
            for scale in self.scales:
                cell = 2 * self.scales[-1] // scale
                places = [numpy.arange(cell // 2 if self.cells else 0, n, cell) for n in field.shape]
                sides, here = [], field[numpy.ix_(*places)]
                for way in -cell, cell:
                    there = (places[axis] + way >= 0) & (places[axis] + way < field.shape[axis])
                    moved = [numpy.where(there, p + way, p) if a == axis else p for a, p in enumerate(places)]
                    shape = [-1 if a == axis else 1 for a in range(3)]
                    sides.append(numpy.where(there.reshape(shape) & numpy.isfinite(field[numpy.ix_(*moved)]), field[numpy.ix_(*moved)], numpy.nan))
                both, one = (sides[1] - sides[0]) / (2 * cell), numpy.where(numpy.isfinite(sides[0]), here - sides[0], sides[1] - here) / cell
                slopes.append(numpy.nan_to_num(numpy.where(numpy.isfinite(both), both, one)) / unit[axis])
            result.append(self.field(slopes))
        return numpy.stack(result, -1)

    def field(self, values=None):
        """The field at the corners of half the finest cells; of other values at the cells (points) of each level, if there are any."""
        if values is None:
            values = self.finer() if self.cells else self.values
        n = self.counts * self.scales[-1] * 2 + 1
        result, done = numpy.full(n, numpy.nan), numpy.zeros(n, bool)
        for level, scale in enumerate(self.scales):
            step = self.scales[-1] // scale * (1 if self.cells else 2)  # between corners, in halves of the finest cells
            nodes = corner_means(values[level], self.there[level]) if self.cells else values[level].copy()
            here = tuple(slice(None, None, step) for _ in range(3))
            nodes[done[here]] = result[here][done[here]]
            fine = nodes
            for axis in range(3):
                fine = between(fine, step, axis)
            touched = touching(self.shown[level], self.scales[-1] // scale * 2) & ~done
            result[touched] = fine[touched]
            done |= touched
        return result


def between(values, step, axis):
    """`step` parts between two values along an axis, linear."""
    values = numpy.moveaxis(values, axis, 0)
    out = numpy.empty(((len(values) - 1) * step + 1,) + values.shape[1:])
    for part in range(step):
        out[part:-1:step] = values[:-1] * (1 - part / step) + values[1:] * (part / step)
    out[-1] = values[-1]
    return numpy.moveaxis(out, 0, axis)


def corner_means(values, there):
    """At the corners of half cells: the mean of the cells around that are there; NaN: there is none."""
    sums, counts = numpy.where(there, values, 0.0), there.astype(float)
    for axis in range(3):
        sums, counts = spread(sums, axis), spread(counts, axis)
    with numpy.errstate(invalid="ignore"):
        return sums / counts


def spread(values, axis):
    values = numpy.moveaxis(values, axis, 0)
    out = numpy.zeros((2 * len(values) + 1,) + values.shape[1:])
    out[1::2] = values
    out[2::2] += values
    out[0:-1:2] += values
    return numpy.moveaxis(out, 0, axis)


def touching(cells, step):
    """Returns which places of a lattice with `step` places a cell are in or on one of the cells."""
    out = cells
    for axis in range(3):
        out = numpy.moveaxis(out, axis, 0)
        wide = numpy.zeros((len(out) * step + 1,) + out.shape[1:], bool)
        for part in range(step + 1):
            wide[part : len(out) * step + part : step][: len(out)] |= out
        out = numpy.moveaxis(wide, 0, axis)
    return out
