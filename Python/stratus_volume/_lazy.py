# SPDX-License-Identifier: BSD-3-Clause
"""Lazy arrays: values that are read from a file, or computed, when something slices the array. Arrays of zarr, h5py, netCDF4 and dask, and
anything else that has a shape, a dtype and slices."""
import threading

import numpy

from ._identity import of_hdf5, of_zarr
from ._values import is_number, type_in_core

# Chunks of fewer bytes are read several at once, and so is an array without chunks.
_BYTES_LEAST, _SIDE = 1 << 18, 64
_UNITS = {unit: 1024**power for power, unit in enumerate("KMGT", 1)}
_MEMORY = (16e6, 1e15)  # bytes
_netcdf = threading.Lock()  # its library reads for one thread at a time


def bytes_of(memory):
    """The bytes of the argument `memory`: a number, or a text such as "2G"; None stands for none."""
    if memory is None:
        return None
    number, unit = memory, 1
    if isinstance(memory, str):
        number, unit = (memory[:-1], _UNITS[memory[-1].upper()]) if memory[-1:].upper() in _UNITS else (memory, 1)
        try:
            number = float(number)
        except ValueError:
            raise ValueError(f"memory is {memory!r}, it must be a size such as '512M' or '2G' (K, M, G, T), or a number of bytes") from None
    elif isinstance(memory, bool) or not is_number(memory):
        raise TypeError(f"memory is {memory!r}, it must be a size such as '512M' or '2G' (K, M, G, T), or a number of bytes")
    least, most = _MEMORY
    if not least <= number * unit <= most:
        raise ValueError(f"memory is {memory!r}, it must be {least:.0f} to {most:.0f} bytes")
    return int(number * unit)


class Lazy:
    """A lazy array. Its values are not in memory.

    shape, dtype  of the values; the dtype is the core's. Values that may be masked are floats, NaN where they are
    brick, before  of three axes: values along each in which it is read best, and how many values of the first brick precede the array
    what          the array, for messages
    identity      a function of a number that these values have in every process, or 0
    """

    def __init__(self, shape, dtype, read, whole, chunks=None, masked=False, fills=(), what="the array", hint="choose a part of it", identity=int):
        self.shape, self.what, self.hint = tuple(int(n) for n in shape), what, hint
        self.whole, self.identity = whole, identity
        self._read, self._fills = read, fills
        self.given = numpy.dtype(dtype)
        self.dtype = type_in_core(self.given)
        self._masked = masked or len(fills) > 0
        if self._masked and self.dtype.kind != "f":
            self.dtype = numpy.dtype(numpy.float32 if self.dtype.itemsize <= 2 else numpy.float64)
        self.brick, self.before = _bricks(self.shape, *_regular(chunks, self.shape), self.dtype.itemsize)

    @property
    def bytes(self):
        """Of all values in the core's type."""
        count = self.dtype.itemsize
        for n in self.shape:
            count *= n
        return count

    def box(self, box):
        """The values of a box of three slices, and flags of the masked ones or None."""
        part = self._read(box)
        mask = numpy.ma.getmask(part)
        values = numpy.ma.getdata(part) if isinstance(part, numpy.ma.MaskedArray) else numpy.asarray(part)
        wanted = tuple(each.stop - each.start for each in box)
        if values.shape != wanted:
            raise ValueError(f"its slice has the shape {values.shape}, it must be {wanted}")
        if values.dtype.kind not in "buif" or not numpy.can_cast(values.dtype, self.given if self._masked else self.dtype, "same_kind"):
            raise TypeError(f"its slice is of type {values.dtype}, it must be {self.given}")
        hidden = None if mask is numpy.ma.nomask or not mask.any() else mask
        if self._fills:
            filled = numpy.isin(values, self._fills)
            hidden = filled if hidden is None else filled | hidden
        if hidden is not None and self.dtype.kind != "f":
            raise TypeError("its slice has masked values, but the array has no mask")
        return values, hidden


def _regular(chunks, shape):
    """Chunks as one length for each axis, and how much of the first one precedes the array. chunks: a length for each axis or, as dask has
    them, the lengths of all chunks along it; or None."""
    if chunks is None or len(chunks) != len(shape):
        return None, [0] * len(shape)
    lengths, before = [], []
    for each, n in zip(chunks, shape):
        parts = tuple(each) if numpy.ndim(each) else (each,)
        longest = max(1, *parts) if parts else 1
        even = all(part == longest for part in parts[1:-1])  # others have bricks that no chunks begin with
        lengths.append(int(min(longest, max(n, 1))))
        before.append(int(longest - parts[0]) if even and len(parts) > 1 and longest == lengths[-1] else 0)
    return lengths, before


def _bricks(shape, chunk, before, size):
    """Bricks of whole chunks that are no less than some bytes, if the array is."""
    if chunk is None:
        return [min(n, _SIDE) for n in shape], before
    brick = list(chunk)
    while size * numpy.prod(brick, dtype=float) < _BYTES_LEAST:
        short = [axis for axis, n in enumerate(shape) if brick[axis] < n]
        if not short:
            break
        axis = min(short, key=lambda axis: brick[axis])
        brick[axis] *= 2
    return brick, before


def _is_of(data, package):
    return type(data).__module__.split(".")[0] == package


def _computed(part):
    """A part of a lazy array that may be lazy, too, as dask's are."""
    part = part.compute() if hasattr(part, "compute") else part
    return part if isinstance(part, numpy.ndarray) else numpy.asarray(part)


def lazy_of(data, what="the array"):
    """The Lazy of an array that is not in memory, or None."""
    if isinstance(data, (numpy.ndarray, numpy.generic)) or not all(hasattr(data, name) for name in ("shape", "dtype", "__getitem__")):
        return None
    try:
        dtype, shape = numpy.dtype(data.dtype), tuple(int(n) for n in data.shape)
    except TypeError:
        return None  # an array of a package of its own
    chunks = getattr(data, "chunks", None) or getattr(data, "chunk_shape", None)
    if _is_of(data, "netCDF4"):
        return _of_netcdf(data, shape, what)
    if hasattr(data, "compute"):
        masked = isinstance(getattr(data, "_meta", None), numpy.ma.MaskedArray)
        return Lazy(shape, dtype, lambda box: _computed(data[box]), lambda: computed_whole(data), chunks, masked, what=what)
    identity = (lambda: of_zarr(data)) if _is_of(data, "zarr") else (lambda: of_hdf5(data)) if _is_of(data, "h5py") else int
    return Lazy(shape, dtype, lambda box: _computed(data[box]), lambda: numpy.asarray(data if hasattr(data, "__array__") else data[...]), chunks,
                what=what, identity=identity)


def computed_whole(data):
    """All values of an array of dask, in the core's type."""
    needed = type_in_core(data.dtype)
    return (data if data.dtype == needed else data.astype(needed)).compute()


def _of_netcdf(data, shape, what):
    """Its slices are scaled and masked, and only they have the type of that."""
    def read(box):
        with _netcdf:
            return data[box]
    one = read(tuple(slice(0, min(n, 1)) for n in shape))
    chunks = data.chunking()
    return Lazy(shape, one.dtype, read, lambda: read(...), None if isinstance(chunks, str) else chunks, isinstance(one, numpy.ma.MaskedArray), what=what)
