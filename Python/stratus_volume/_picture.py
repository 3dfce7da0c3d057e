# SPDX-License-Identifier: BSD-3-Clause
"""Pictures as arrays, which notebooks show and which save themselves as PNG."""
import struct
import typing
import zlib

import numpy


def _chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def _rows(picture):
    """The compressed rows of a picture, each with its filter, none, before it."""
    height, width, channels = picture.shape
    rows = numpy.zeros((height, 1 + width * channels), numpy.uint8)
    rows[:, 1:] = picture.reshape(height, width * channels)
    return zlib.compress(rows.tobytes(), 6)


def _header(picture):
    height, width, channels = picture.shape
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0))


class Picture(numpy.ndarray):
    """An array of shape (height, width, 4), RGBA of one byte each, the top row first, which notebooks show as a picture. `caption` is what a
    text under it should say ("heights x 1400"), or ""."""
    caption = ""

    @property
    def _whole(self):
        """Whether it is a picture. A slice may be none."""
        return self.ndim == 3 and self.shape[2] in (3, 4) and self.dtype == numpy.uint8 and self.size > 0

    def __repr__(self):
        return f"<Picture of {self.shape[1]} x {self.shape[0]} pixels, which save(path) writes as PNG>" if self._whole else super().__repr__()

    def _repr_png_(self):
        if not self._whole:
            return None
        return _header(self) + _chunk(b"IDAT", _rows(self)) + _chunk(b"IEND", b"")

    def save(self, path):
        """Writes the picture as PNG."""
        encoded = self._repr_png_()
        if encoded is None:
            raise ValueError(f"an array of shape {self.shape} and type {self.dtype} is no picture: it must be (height, width, 3 or 4), uint8")
        with open(path, "wb") as file:
            file.write(encoded)


class Film(list):
    """A list of Pictures of one size, which notebooks show as a film that repeats (an animated PNG); `seconds` is the time of all of them."""

    def __init__(self, pictures=(), seconds=4.0):
        super().__init__(pictures)
        self.seconds = seconds

    def _repr_png_(self):
        if not self or any(picture.shape != self[0].shape for picture in self):
            return None
        height, width = self[0].shape[:2]
        delay = min(65535, max(1, round(1000 * self.seconds / len(self))))
        parts, number = [_header(self[0]), _chunk(b"acTL", struct.pack(">II", len(self), 0))], 0
        for n, picture in enumerate(self):
            parts.append(_chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, width, height, 0, 0, delay, 1000, 0, 0)))
            # A reader that knows no films shows the first picture.
            parts.append(_chunk(b"IDAT", _rows(picture)) if n == 0 else _chunk(b"fdAT", struct.pack(">I", number + 1) + _rows(picture)))
            number += 1 if n == 0 else 2
        return b"".join([*parts, _chunk(b"IEND", b"")])

    def save(self, path):
        """Writes the film as an animated PNG."""
        encoded = self._repr_png_()
        if encoded is None:
            raise ValueError(f"a film of {len(self)} pictures can't be written: it must have one or more, of one size")
        with open(path, "wb") as file:
            file.write(encoded)


def paint(rgba, background):
    """Converts premultiplied floats to a Picture, over a background of (r, g, b) or, for None, transparent."""
    rgb, alpha = rgba[..., :3], rgba[..., 3:]
    if background is None:
        rgb = numpy.divide(rgb, alpha, out=numpy.zeros_like(rgb), where=alpha > 0)
    else:
        rgb, alpha = rgb + (1 - alpha) * numpy.array(background, numpy.float32), numpy.ones_like(alpha)
    both = numpy.concatenate([rgb, alpha], axis=2)
    return numpy.rint(255 * numpy.clip(both, 0, 1)).astype(numpy.uint8).view(Picture)


class _Rendering(typing.NamedTuple):
    rgba: numpy.ndarray
    depth: numpy.ndarray
    counters: dict


class Rendering(_Rendering):
    """A picture, as `render` returns it: three items, and the quantities that were asked for.

    rgba      float32 (height, width, 4), premultiplied by alpha, the top row first; 0 where nothing shows
    depth     float32 (height, width): world distance along the ray from the eye (parallel cameras: from its plane) to the first visible point;
              infinite where nothing shows
    counters  dict of rays, samples, skipped segments, times in ms, the used structure and sampling, and the reasons for them
    quantities  dict of arrays (height, width), the top row first, by the names that `quantities` of `render` gave; else empty
    """
    _quantities = {}

    @property
    def quantities(self):
        return self._quantities

    def picture(self, background=None):
        """Returns a Picture of bytes, over a background of (r, g, b) in 0..1 or, for None, transparent."""
        from ._values import background_color
        return paint(self.rgba, background_color(background))
