# SPDX-License-Identifier: BSD-3-Clause
"""Files of netCDF's classic format, written by hand, since ParaView's Python has no netCDF: doubles and 4-byte integers, no record dimension."""
import struct

import numpy

CHAR, INT, DOUBLE = 2, 4, 6
DIMENSION, VARIABLE, ATTRIBUTE = 10, 11, 12


def _text(text):
    data = text.encode()
    return struct.pack(">i", len(data)) + data + b"\0" * (-len(data) % 4)


def _list(tag, items):
    return struct.pack(">ii", tag if items else 0, len(items)) + b"".join(items)


def _attribute(name, value):
    if isinstance(value, str):
        return _text(name) + struct.pack(">i", CHAR) + _text(value)
    return _text(name) + struct.pack(">iii", INT, 1, value)


def write(path, dimensions, variables):
    """dimensions: sizes by name. variables: by name: dimensions, values and attributes."""
    order = list(dimensions)
    heads, bodies = [], []
    for name, (of, values, attributes) in variables.items():
        values = numpy.asarray(values)
        assert list(values.shape) == [dimensions[one] for one in of], name
        kind, stored = (INT, ">i4") if values.dtype.kind == "i" else (DOUBLE, ">f8")
        bodies.append(values.astype(stored).tobytes())
        heads.append((_text(name) + struct.pack(f">{1 + len(of)}i", len(of), *map(order.index, of)) +
                      _list(ATTRIBUTE, [_attribute(*one) for one in attributes.items()]) + struct.pack(">ii", kind, len(bodies[-1]))))
    front = (b"CDF\x01" + struct.pack(">i", 0) + _list(DIMENSION, [_text(name) + struct.pack(">i", size) for name, size in dimensions.items()]) +
             _list(ATTRIBUTE, []))
    at = len(front) + 8 + sum(len(head) + 4 for head in heads)
    for i, body in enumerate(bodies):
        heads[i] += struct.pack(">i", at)
        at += len(body)
    open(path, "wb").write(front + _list(VARIABLE, heads) + b"".join(bodies))
    return path
