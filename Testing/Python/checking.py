# SPDX-License-Identifier: BSD-3-Clause
"""What tests of the Python packages check by. Imported first, it skips a script where NumPy is missing. A script ends by done(), with status 1
if anything did not hold."""
import itertools
import sys
import threading

try:
    import numpy
except ImportError:
    print("SKIPPED: no NumPy")
    sys.exit(77)

failures = 0


def check(condition, what):
    global failures
    if isinstance(condition, str):
        raise TypeError(f"'{condition}' is no condition")
    if not condition:
        failures += 1
        print("does not hold:", what)


def refuse(kind, words, call, *arguments, **options):
    try:
        call(*arguments, **options)
    except kind as error:
        check(words in str(error), f"'{words}' in the error: {error}")
    else:
        check(False, f"{words}: {options} is refused")


def ball(shape, center, radius, dtype=numpy.float32):
    """1 in the middle, 0 at the radius and beyond; shape and center along z, y, x."""
    z, y, x = numpy.ogrid[tuple(slice(0, n) for n in shape)]
    square = (z - center[0]) ** 2 + (y - center[1]) ** 2 + (x - center[2]) ** 2
    return numpy.maximum(0, 1 - square / radius**2).astype(dtype)


class Chunks:
    """A lazy array, which counts the chunks that its slices touch."""

    def __init__(self, values, chunks=None):
        self.values, self.shape, self.dtype = values, values.shape, values.dtype
        if chunks is not None:
            self.chunks = chunks
        self.boxes, self.counts, self.lock = [], {}, threading.Lock()

    def __getitem__(self, box):
        if box is Ellipsis:
            box = tuple(slice(0, n) for n in self.shape)
        chunks = getattr(self, "chunks", None)
        with self.lock:
            self.boxes.append(box)
            if chunks:
                touched = [range(each.start // chunk, (each.stop - 1) // chunk + 1) for each, chunk in zip(box, chunks)]
                for key in itertools.product(*touched):
                    self.counts[key] = self.counts.get(key, 0) + 1
        return self.part(box)

    def part(self, box):
        return self.values[box]


def errors_of(thing):
    """The list to which the texts of a VTK object's errors are added from now on."""
    errors = []

    def keep(caller, event, text):
        errors.append(text)
    keep.CallDataType = "string0"
    thing.AddObserver("ErrorEvent", keep)
    return errors


def done():
    sys.exit(1 if failures else 0)
