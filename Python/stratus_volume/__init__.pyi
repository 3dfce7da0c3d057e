# SPDX-License-Identifier: BSD-3-Clause
from collections.abc import Sequence
from os import PathLike
from typing import Any, Literal, NamedTuple, Union

import numpy
from numpy.typing import ArrayLike, NDArray

__version__: str
_Points = Union[float, Sequence[Sequence[float]], None]
_Colors = Union[Sequence[float], Sequence[Sequence[float]], None]
_Device = Union[str, int, "Context", None]
_Progress = Any  # a function of a stage and a fraction, a bar of tqdm's protocol, or None
_Background = Union[Sequence[float], None]
_Mode = Literal["composite", "first-hit", "maximum", "minimum", "average", "additive", "isosurface"]
_Structure = Literal["auto", "none", "block", "distance", "octant", "hybrid"]
_Sampling = Literal["auto", "midpoint", "preintegrated", "cells"]
_Field = Literal["exact", "zigzag", "envelope", "jfa", "jfa-1", "jfa-2", "1-jfa", "jfa-squared", "ajfa", "ajfa-fig5"]
_TreeMethod = Literal["auto", "hybrid", "hybrid-paper", "distance", "octant", "sah", "sweep", "lbvh", "ploc", "ac", "dpc", "kmeans", "wide"]

class NothingShown(UserWarning): ...
class Cancelled(RuntimeError): ...
class DeviceError(RuntimeError): ...
class Unsupported(NotImplementedError): ...

class Context:
    def __init__(self, device: str | int = ..., threads: int = ...) -> None: ...
    @property
    def device(self) -> str: ...

class Picture(numpy.ndarray):
    def save(self, path: str | PathLike[str]) -> None: ...

class Film(list[Picture]):
    seconds: float
    def __init__(self, pictures: Sequence[Picture] = ..., seconds: float = ...) -> None: ...
    def save(self, path: str | PathLike[str]) -> None: ...

class Rendering(NamedTuple):
    rgba: NDArray[numpy.float32]
    depth: NDArray[numpy.float32]
    counters: dict[str, Any]
    def picture(self, background: _Background = ...) -> Picture: ...

class Hits(NamedTuple):
    t: NDArray[numpy.float64]
    voxel: NDArray[numpy.int32]
    face: NDArray[numpy.int32]
    normal: NDArray[numpy.float32]

class Volume:
    context: Context
    def __init__(
        self, data: Any, spacing: Sequence[float] | None = ..., origin: Sequence[float] | None = ..., axes: str | Sequence[str] | None = ...,
        scalars: str | None = ..., component: int | None = ..., device: _Device = ..., threads: int | None = ...) -> None: ...
    @property
    def bounds(self) -> tuple[float, float, float, float, float, float]: ...
    def modified(self) -> None: ...
    def render(
        self, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: Any = ..., unit_distance: float | None = ...,
        mode: _Mode = ..., interpolation: Literal["linear", "nearest"] = ..., structure: _Structure = ..., sampling: _Sampling = ...,
        sample_distance: float = ..., tolerance: float | None = ..., shade: bool | dict[str, float] = ..., gradient_opacity: _Points = ...,
        contours: float | Sequence[float] | None = ..., crop: Sequence[float] | None = ..., clip_planes: Sequence[Sequence[float]] | None = ...,
        average_range: Sequence[float] | None = ..., jitter: bool = ..., audit: bool = ..., opaque_depth: ArrayLike | None = ...,
        progress: _Progress = ...) -> Rendering: ...

class Tetrahedra:
    context: Context
    bounds: tuple[float, float, float, float, float, float]
    def __init__(
        self, points: Any, tetrahedra: ArrayLike | None = ..., values: ArrayLike | None = ..., scalars: str | None = ..., device: _Device = ...,
        threads: int | None = ...) -> None: ...
    def render(
        self, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: Any = ..., unit_distance: float | None = ...,
        mode: Literal["composite", "maximum", "minimum", "average", "additive", "isosurface"] = ..., method: Literal["auto", "march", "project"] = ...,
        tolerance: float | None = ..., shade: bool | dict[str, float] = ..., gradient_opacity: _Points = ...,
        contours: float | Sequence[float] | None = ..., crop: Sequence[float] | None = ..., clip_planes: Sequence[Sequence[float]] | None = ...,
        average_range: Sequence[float] | None = ..., opaque_depth: ArrayLike | None = ..., progress: _Progress = ...) -> Rendering: ...

class Tree:
    context: Context
    def __init__(
        self, data: Any, lower: float | None = ..., upper: float | None = ..., method: _TreeMethod = ..., max_depth: int | None = ...,
        **options: Any) -> None: ...
    @classmethod
    def load(cls, saved: bytes, device: _Device = ..., threads: int | None = ...) -> Tree: ...
    def save(self) -> bytes: ...
    @property
    def statistics(self) -> dict[str, Any]: ...
    def first_hits(
        self, origins: ArrayLike, directions: ArrayLike, t_min: ArrayLike = ..., t_max: ArrayLike = ..., progress: _Progress = ...) -> Hits: ...

def devices() -> list[str]: ...
def render(
    data: Any, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: Any = ..., spacing: Sequence[float] | None = ...,
    origin: Sequence[float] | None = ..., axes: str | Sequence[str] | None = ..., scalars: str | None = ..., component: int | None = ...,
    device: _Device = ..., threads: int | None = ..., **options: Any) -> Rendering: ...
def show(
    data: Any, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: Any = ..., background: _Background = ...,
    **options: Any) -> Picture: ...
def turn(
    data: Any, frames: int = ..., opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., elevation: float = ..., zoom: float = ...,
    background: _Background = ..., seconds: float = ..., progress: _Progress = ..., spacing: Sequence[float] | None = ...,
    origin: Sequence[float] | None = ..., axes: str | Sequence[str] | None = ..., scalars: str | None = ..., component: int | None = ...,
    device: _Device = ..., threads: int | None = ..., **options: Any) -> Film: ...
def render_tetrahedra(
    points: ArrayLike, tetrahedra: ArrayLike | None, values: ArrayLike, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ...,
    camera: Any = ..., device: _Device = ..., threads: int | None = ..., **options: Any) -> Rendering: ...
def distance_field(
    data: Any, lower: float | None = ..., upper: float | None = ..., method: _Field = ..., signed: bool = ...,
    **options: Any) -> NDArray[numpy.float32]: ...
def first_hits(
    data: Any, origins: ArrayLike, directions: ArrayLike, lower: float | None = ..., upper: float | None = ..., t_min: ArrayLike = ...,
    t_max: ArrayLike = ..., **options: Any) -> Hits: ...
