# SPDX-License-Identifier: BSD-3-Clause
from collections.abc import Hashable, Sequence
from typing import Any

from . import Picture, Rendering, _Background, _Camera, _Colors, _Points

class DataArrayAccessor:
    def __init__(self, data: Any) -> None: ...
    def show(
        self, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ..., background: _Background = ...,
        **options: Any) -> Picture: ...
    def render(
        self, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ..., **options: Any) -> Rendering: ...

class DatasetAccessor:
    def __init__(self, data: Any) -> None: ...
    def show(
        self, name: Hashable, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ...,
        background: _Background = ..., **options: Any) -> Picture: ...
    def render(
        self, name: Hashable, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ...,
        **options: Any) -> Rendering: ...
