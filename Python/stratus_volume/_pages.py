# SPDX-License-Identifier: BSD-3-Clause
"""Values of lazy arrays as memory that the core reads: parts come when a ray first reads them, and leave when memory is short.

Threads of the core's pool call Python for the parts. Whoever reads a value that is not there waits for them without Python's lock: only calls of
the core may read such memory."""
import ctypes
import math
import os
import threading

import numpy

from . import _declarations as c
from ._core import Context, Owned, Unsupported, library, reading, type_of
from ._values import Spread, none_visible, scaled

# A coarse copy has about as many values, and along no axis fewer than this.
_COARSE, _ALONG_LEAST = 1 << 22, 64
_KEPT = 1 << 26
_ADDRESSES = 1 << 46  # bytes that arrays take at most in a process, whatever the memory
_Three = ctypes.c_int64 * 3


# ---- the pool of the process

class _Pool:
    """The memory of all lazy arrays. It stays until the process ends."""

    def __init__(self):
        self.context, self.pointer = Context("host", 0), ctypes.c_void_p()
        options = library.stratus_brick_pool_options_default()
        options.whole_process = 1
        with self.context.lock:
            self.context.call(library.stratus_brick_pool_create, self.context.pointer, ctypes.byref(options), ctypes.byref(self.pointer))

    @property
    def report(self):
        report = c.stratus_brick_pool_report()
        library.stratus_brick_pool_get_report(self.pointer, ctypes.byref(report))
        return report

    def limit(self, memory):
        with self.context.lock:
            self.context.call(library.stratus_brick_pool_set_memory, self.pointer, memory)


_pool, _lock, _of_parent = None, threading.Lock(), []


def _after_fork():
    global _pool, _lock
    _of_parent.append(_pool)  # not to be destroyed here
    _pool, _lock = None, threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def pool():
    global _pool
    with _lock:
        if _pool is None:
            _pool = _Pool()
        return _pool


# ---- whether an array is read as a whole

def free_memory():
    """Bytes that the machine or the process's control group has free, by the core, which gives half of them to a pool."""
    pointer, report, context = ctypes.c_void_p(), c.stratus_brick_pool_report(), pool().context
    with context.lock:
        context.call(library.stratus_brick_pool_create, context.pointer, None, ctypes.byref(pointer))
    library.stratus_brick_pool_get_report(pointer, ctypes.byref(report))
    library.stratus_brick_pool_destroy(pointer)
    return 2 * report.memory


def _size(count):
    return f"{count / 2**30:.1f} GiB" if count >= 2**30 else f"{count / 2**20:.1f} MiB"


def opened(lazy, memory=None, paged=False):
    """The values of a lazy array; or, if `paged`, the lazy array itself where its parts are to be read one by one.

    memory: bytes that parts may take, None: the array is read as a whole if it fits in half of the memory that is free
    """
    parts = paged and len(lazy.shape) == 3 and min(lazy.shape) > 1 and lazy.bytes < _ADDRESSES and pool().report.paged
    if parts and memory is not None:
        pool().limit(memory)
        return lazy
    free = free_memory()
    if parts and lazy.bytes > free // 2:
        return lazy
    if lazy.bytes > free:
        raise MemoryError(f"{lazy.what} is lazy, and its {' x '.join(map(str, lazy.shape))} values of type {lazy.dtype} need {_size(lazy.bytes)}, "
                          f"but {_size(free)} of memory are free; {lazy.hint}")
    return lazy.whole()


# ---- what is known once all values went by

class Seen:
    """The range of the values that were read, and a coarse copy: one value in so many along each axis, slow, middle, fast."""

    def __init__(self, lazy):
        count = math.prod(lazy.shape)
        step = math.ceil((count / _COARSE) ** (1 / 3)) if count > _COARSE else 1
        self.step = [max(1, min(step, n // _ALONG_LEAST)) for n in lazy.shape]
        self.count, self.low, self.high, self.masked = count, math.inf, -math.inf, 0
        self.coarse = numpy.zeros([-(-n // step) for n, step in zip(lazy.shape, self.step)], lazy.dtype)
        self._lock = threading.Lock()

    def add(self, lo, values, hidden):
        """A box that begins at `lo`: slow, middle, fast."""
        low, high = values.min(), values.max()
        if values.dtype.kind == "f" and not (numpy.isfinite(low) and numpy.isfinite(high)):
            finite = values[numpy.isfinite(values)]
            low, high = (finite.min(), finite.max()) if finite.size else (math.inf, -math.inf)
        first = [-at % step for at, step in zip(lo, self.step)]
        place = tuple(slice(-(-at // step), -(-(at + n) // step)) for at, n, step in zip(lo, values.shape, self.step))
        self.coarse[place] = values[tuple(slice(at, None, step) for at, step in zip(first, self.step))]
        with self._lock:
            self.low, self.high = min(self.low, float(low)), max(self.high, float(high))
            self.masked += 0 if hidden is None else int(hidden.sum())

    def recall(self, context, volume):
        """Takes range and coarse copy from what the core keeps of a volume with an identity. Returns whether it keeps them."""
        coarse, ranges, ends = ctypes.c_void_p(), ctypes.c_void_p(), (ctypes.c_double * 2)()
        try:
            context.call(library.stratus_coarse_recall, context.pointer, ctypes.byref(volume), ctypes.byref(coarse))
            context.call(library.stratus_value_range_create, context.pointer, ctypes.byref(volume), 0, ctypes.byref(ranges))
            one, other = (ctypes.byref(ends, 8 * n) for n in range(2))
            if library.stratus_value_range_whole(ranges, one, other) == 0:
                self.low, self.high = ends
            copy = library.stratus_coarse_volume(coarse).contents
            shape = tuple(copy.dimensions)[::-1]
            self.step = [round(many / space) for many, space in zip(tuple(copy.spacing)[::-1], tuple(volume.spacing)[::-1])]
            memory = (ctypes.c_char * (math.prod(shape) * self.coarse.itemsize)).from_address(copy.values)
            self.coarse = numpy.frombuffer(memory, self.coarse.dtype).reshape(shape).copy()
        except Unsupported:
            return False
        finally:
            library.stratus_value_range_destroy(ranges)
            library.stratus_coarse_destroy(coarse)
        return True

    @property
    def nothing(self):
        """The reason why no value shows, or None."""
        masked = min(self.masked, self.count)
        return none_visible(self.count, masked, self.count - masked) if self.low > self.high else None

    @property
    def spread(self):
        values = self.coarse.reshape(-1)
        return Spread(values[numpy.isfinite(values)] if values.dtype.kind == "f" else values, self.low, self.high)


# ---- an array of parts

class _Reader:
    """Reads boxes for the pool's threads. `failure` is the first exception of the array; it is read no more after that. `seen` is a Seen that
    notes values as they are read, or None."""

    def __init__(self, lazy, power):
        self.lazy, self.power, self.seen, self.failure = lazy, power, None, None

    def read(self, user, lo, size, values):
        if self.failure is not None:
            return 1
        try:
            reading(True)
            first, count = (tuple(_Three.from_address(each))[::-1] for each in (lo, size))
            part, hidden = self.lazy.box(tuple(slice(at, at + n) for at, n in zip(first, count)))
            _put(self.lazy.dtype, self.power, part, hidden, values, first, self.seen)
            return 0
        except BaseException as error:  # ctypes would print it and go on
            self.failure = error
            return 1
        finally:
            reading(False)


def _put(dtype, power, part, hidden, address, first, seen):
    """Writes a part to memory of the core. No exception of an array holds a frame that has this memory."""
    stored = dtype if power == 0 else numpy.dtype(numpy.float64)
    memory = (ctypes.c_char * (part.size * stored.itemsize)).from_address(address)
    values = numpy.frombuffer(memory, stored).reshape(part.shape)
    if power == 0:
        values[...] = part
    else:
        values[...] = scaled(part, power)
    if hidden is not None:
        values[hidden] = numpy.nan
    if seen is not None:
        seen.add(first, values, hidden)


class Pages(Owned):
    """The memory of a lazy array's values times 2**-power."""

    def __init__(self, lazy, power=0, forgets=False):
        """forgets: nothing is kept of the values from one process to the next."""
        own = pool()
        self.reader = _Reader(lazy, power)
        callback = c.stratus_brick_read_function(self.reader.read)
        super().__init__(own.context, library.stratus_bricks_destroy, callback)
        self.type = type_of(numpy.empty(0, lazy.dtype if power == 0 else numpy.float64))
        source = c.stratus_brick_source(read=callback, type=self.type)
        source.dimensions[:], source.brick[:], source.before[:] = lazy.shape[::-1], lazy.brick[::-1], lazy.before[::-1]
        # The core keeps a coarse copy of so large volumes, without which what pictures need to know is not known.
        self.identity = lazy.identity() if power == 0 and math.prod(lazy.shape) > _KEPT and not forgets else 0
        source.identity = self.identity
        with own.context.lock:
            own.context.call(library.stratus_bricks_create, own.context.pointer, own.pointer, ctypes.byref(source), ctypes.byref(self.pointer))
        self._process = os.getpid()

    def set(self, volume):
        """Gives a view of the core its values."""
        if self._process != os.getpid():
            raise RuntimeError("this object was made before the process was forked; make it anew in the child process")
        volume.identity = self.identity
        volume.values = library.stratus_bricks_values(self.pointer)
        volume.missing, volume.parts = (getattr(library, f"stratus_bricks_{name}")(self.pointer) for name in ("missing", "parts"))
        tiles = library.stratus_bricks_tiles(self.pointer)
        if tiles:
            volume.tiles = tiles.contents

    @property
    def reads(self):
        """How many parts were read because something waited for them."""
        return ctypes.c_uint64.from_address(library.stratus_bricks_reads(self.pointer)).value

    @property
    def report(self):
        """A dict of counts of parts and bytes."""
        report = c.stratus_bricks_report()
        library.stratus_bricks_get_report(self.pointer, ctypes.byref(report))
        return {name: getattr(report, name) for name, *_ in report._fields_}
