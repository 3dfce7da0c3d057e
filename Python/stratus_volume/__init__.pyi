# SPDX-License-Identifier: BSD-3-Clause
from collections.abc import Sequence
from os import PathLike
from typing import Any, Callable, Literal, NamedTuple, Union

import numpy
from numpy.typing import ArrayLike, NDArray

__version__: str
_Function = Union[float, Sequence[Sequence[float]], None]
_Points = Union[_Function, Sequence[_Function]]
_OneColor = Union[Sequence[float], Sequence[Sequence[float]], str, Callable[[float], Sequence[float]], None]
_Colors = Union[_OneColor, Sequence[_OneColor]]
_Device = Union[str, int, "Context", None]
_Camera = Any  # a dict, three points, a vtkCamera, or None
_Progress = Any  # a function of a stage and a fraction, a bar of tqdm's protocol, or None
_Background = Union[Sequence[float], None]
_Quantity = Literal["integral", "length", "mean", "maximum", "maximum_depth", "cells", "transmittance", "transmittance_depth"]
_Quantities = Union[_Quantity, Sequence[_Quantity], None]
_Mode = Literal["composite", "first-hit", "maximum", "minimum", "average", "additive", "isosurface", "slice"]
_Matrix = Union[ArrayLike, Any, None]
_Memory = Union[float, str, None]  # bytes, or a text such as "2G"
_Component = Union[int, Literal["all"], None]
_Shade = Union[bool, dict[str, float], Sequence[Union[bool, dict[str, float]]]]
_Structure = Literal["auto", "none", "block", "distance", "octant", "hybrid"]
_Sampling = Literal["auto", "midpoint", "preintegrated", "cells"]
_Field = Literal["exact", "zigzag", "envelope", "jfa", "jfa-1", "jfa-2", "1-jfa", "jfa-squared", "ajfa", "ajfa-fig5"]
_TreeMethod = Literal["auto", "hybrid", "hybrid-paper", "distance", "octant", "sah", "sweep", "lbvh", "ploc", "ac", "dpc", "kmeans", "wide"]

class NothingShown(UserWarning): ...
class PlacesUnused(UserWarning): ...
class Cancelled(RuntimeError): ...
class DeviceError(RuntimeError): ...
class Unsupported(NotImplementedError): ...

class Context:
    def __init__(self, device: str | int = ..., threads: int = ...) -> None: ...
    @property
    def device(self) -> str: ...

class Picture(numpy.ndarray[Any, numpy.dtype[numpy.uint8]]):
    caption: str
    def save(self, path: str | PathLike[str]) -> None: ...

class Film(list[Picture]):
    seconds: float
    def __init__(self, pictures: Sequence[Picture] = ..., seconds: float = ...) -> None: ...
    def save(self, path: str | PathLike[str]) -> None: ...

class Rendering(NamedTuple):
    rgba: NDArray[numpy.float32]
    depth: NDArray[numpy.float32]
    counters: dict[str, Any]
    @property
    def quantities(self) -> dict[str, Any]: ...
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
        scalars: str | None = ..., component: _Component = ..., device: _Device = ..., threads: int | None = ..., matrix: _Matrix = ...,
        exaggerate: float | None = ..., memory: _Memory = ...) -> None: ...
    exaggeration: float
    @property
    def bounds(self) -> tuple[float, float, float, float, float, float]: ...
    def modified(self) -> None: ...
    def render(
        self, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ..., unit_distance: float | None = ...,
        mode: _Mode = ..., interpolation: Literal["linear", "nearest"] = ..., structure: _Structure = ..., sampling: _Sampling = ...,
        sample_distance: float = ..., tolerance: float | None = ..., shade: _Shade = ..., gradient_opacity: _Points = ...,
        contours: float | Sequence[float] | None = ..., crop: Sequence[float] | None = ..., clip_planes: Sequence[Sequence[float]] | None = ...,
        average_range: Sequence[float] | None = ..., jitter: bool = ..., audit: bool = ..., opaque_depth: ArrayLike | None = ...,
        progress: _Progress = ..., dependent: bool = ..., weights: float | Sequence[float] | None = ..., mean_components: bool = ...,
        labels: ArrayLike | None = ..., looks: dict[int, dict[str, Any]] | None = ..., function_2d: dict[str, Any] | None = ...,
        surface: dict[str, Any] | None = ..., quantities: _Quantities = ..., threshold: float = ..., show_axes: bool = ...,
        color_bar: bool = ..., caption: str | None = ..., coast: bool = ..., ink: float = ..., extinction: float = ...) -> Rendering: ...

class Tetrahedra:
    context: Context
    bounds: tuple[float, float, float, float, float, float]
    def __init__(
        self, points: Any, tetrahedra: ArrayLike | None = ..., values: ArrayLike | None = ..., scalars: str | None = ..., device: _Device = ...,
        threads: int | None = ..., matrix: _Matrix = ..., component: _Component = ...) -> None: ...
    def render(
        self, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ..., unit_distance: float | None = ...,
        mode: _Mode = ..., method: Literal["auto", "march", "project"] = ...,
        tolerance: float | None = ..., shade: _Shade = ..., gradient_opacity: _Points = ...,
        contours: float | Sequence[float] | None = ..., crop: Sequence[float] | None = ..., clip_planes: Sequence[Sequence[float]] | None = ...,
        average_range: Sequence[float] | None = ..., opaque_depth: ArrayLike | None = ..., progress: _Progress = ..., dependent: bool = ...,
        weights: float | Sequence[float] | None = ..., mean_components: bool = ...,
        surface: dict[str, Any] | None = ..., quantities: _Quantities = ..., threshold: float = ..., show_axes: bool = ...,
        color_bar: bool = ..., caption: str | None = ..., coast: bool = ..., ink: float = ..., extinction: float = ...) -> Rendering: ...

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

class View:
    drawn: Volume | Tetrahedra
    look: dict[str, Any]
    rendering: Rendering
    widget: Any
    image: Any
    azimuth: Any
    elevation: Any
    zoom: Any
    extinction: Any
    step: Any
    message: Any
    @property
    def camera(self) -> dict[str, float]: ...
    @property
    def state(self) -> dict[str, Any]: ...
    def set(self, **look: Any) -> None: ...
    def draw(self, draft: bool = ...) -> None: ...

class Partition(NamedTuple):
    points: NDArray[numpy.float64]
    tetrahedra: NDArray[numpy.int32]
    cells: NDArray[numpy.int32]
    leaf: NDArray[numpy.int32]
    ends: NDArray[numpy.int32]
    weights: NDArray[numpy.float64]
    nodes: NDArray[numpy.void]
    frame: NDArray[numpy.float64]
    counters: dict[str, int]
    def at_points(self, values: ArrayLike) -> NDArray[numpy.float64]: ...

class VisibilityOrder:
    context: Context
    def __init__(
        self, points: ArrayLike | Partition, tetrahedra: ArrayLike | None = ..., device: _Device = ..., threads: int | None = ...) -> None: ...
    def sort(
        self, camera: _Camera = ..., peeling: Literal["nearest", "layers"] = ...,
        progress: _Progress = ...) -> tuple[NDArray[numpy.int64], dict[str, Any]]: ...

class Visible(NamedTuple):
    ids: NDArray[numpy.uint32]
    coverage: NDArray[numpy.float32] | None
    depth: NDArray[numpy.float32] | None
    counters: dict[str, int]

class Octree:
    context: Context
    def __init__(
        self, bounds: ArrayLike | None = ..., placement: Literal["enclosing", "touching"] = ...,
        stop: Literal["pixels", "manhattan", "euclid", "static"] = ..., levels: int = ..., leaf_objects: int = ..., pixels: float = ...,
        c: float = ..., looseness: float = ..., collapse_after: int = ..., split_budget: int = ..., threads: int | None = ...) -> None: ...
    def __len__(self) -> int: ...
    def insert(self, bounds: ArrayLike) -> NDArray[numpy.uint32]: ...
    def move(self, ids: ArrayLike, bounds: ArrayLike) -> None: ...
    def remove(self, ids: ArrayLike) -> None: ...
    def bounds(self, ids: ArrayLike) -> NDArray[numpy.float64]: ...
    def cull(
        self, camera: _Camera = ..., size: Sequence[int] = ..., near: float = ..., far: float = ..., planes: ArrayLike | None = ...,
        eye: Sequence[float] | None = ..., exact: bool = ..., coverage: bool = ..., hold: bool = ..., view: str = ...) -> Visible: ...
    def in_box(self, bounds: ArrayLike) -> NDArray[numpy.uint32]: ...
    def in_sphere(self, center: Sequence[float], radius: float) -> NDArray[numpy.uint32]: ...
    def along_ray(
        self, origin: Sequence[float], direction: Sequence[float],
        t_max: float = ...) -> tuple[NDArray[numpy.uint32], NDArray[numpy.float64]]: ...
    def nearest(self, point: Sequence[float], k: int = ...) -> tuple[NDArray[numpy.uint32], NDArray[numpy.float64]]: ...
    @property
    def statistics(self) -> dict[str, Any]: ...

def color_maps() -> list[str]: ...
def devices() -> list[str]: ...
def partition(
    points: ArrayLike, tetrahedra: ArrayLike, depth: int = ..., rule: Literal["median", "paper"] = ..., planes: int = ..., growth: float = ...,
    imbalance: float = ..., rotations: int = ..., leaf_cells: int = ..., device: _Device = ..., threads: int | None = ...,
    progress: _Progress = ...) -> Partition: ...
def render(
    data: Any, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ..., spacing: Sequence[float] | None = ...,
    origin: Sequence[float] | None = ..., axes: str | Sequence[str] | None = ..., scalars: str | None = ..., component: _Component = ...,
    device: _Device = ..., threads: int | None = ..., matrix: _Matrix = ..., exaggerate: float | None = ...,
    globe: bool = ..., memory: _Memory = ..., **options: Any) -> Rendering: ...
def show(
    data: Any, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: _Camera = ..., background: _Background = ...,
    **options: Any) -> Picture: ...
def turn(
    data: Any, frames: int = ..., opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., elevation: float = ..., zoom: float = ...,
    background: _Background = ..., seconds: float = ..., progress: _Progress = ..., spacing: Sequence[float] | None = ...,
    origin: Sequence[float] | None = ..., axes: str | Sequence[str] | None = ..., scalars: str | None = ..., component: _Component = ...,
    device: _Device = ..., threads: int | None = ..., matrix: _Matrix = ..., exaggerate: float | None = ...,
    globe: bool = ..., memory: _Memory = ..., **options: Any) -> Film: ...
def cloud(
    data: Any, radius: float | None = ..., ice: bool | None = ..., units: str | None = ..., metres: float | None = ...,
    density: ArrayLike | None = ..., variable: str | None = ..., step: int = ..., sun: Sequence[float] | None = ..., time: Any = ...,
    place: Sequence[float] | None = ..., size: Sequence[int] = ..., camera: _Camera = ..., background: Literal["sky"] | _Background = ...,
    albedo: float = ..., anisotropy: float = ..., spacing: Sequence[float] | None = ..., origin: Sequence[float] | None = ...,
    axes: str | Sequence[str] | None = ..., scalars: str | None = ..., component: _Component = ..., device: _Device = ...,
    threads: int | None = ..., matrix: _Matrix = ..., **options: Any) -> Picture: ...
def view(
    data: Any, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ..., camera: dict[str, float] | None = ...,
    background: _Background = ..., draft: float = ..., draft_tolerance: float = ..., spacing: Sequence[float] | None = ...,
    origin: Sequence[float] | None = ..., axes: str | Sequence[str] | None = ..., scalars: str | None = ..., component: _Component = ...,
    device: _Device = ..., threads: int | None = ..., matrix: _Matrix = ..., memory: _Memory = ..., globe: bool = ...,
    exaggerate: float | None = ..., **options: Any) -> View: ...
def render_several(
    items: Sequence[Any], size: Sequence[int] = ..., camera: _Camera = ..., opaque_depth: ArrayLike | None = ..., device: _Device = ...,
    threads: int | None = ..., progress: _Progress = ..., quantities: _Quantities = ..., threshold: float = ...) -> Rendering: ...
def slab(center: Sequence[float], normal: Sequence[float], thickness: float) -> list[tuple[float, float, float, float]]: ...
def render_tetrahedra(
    points: ArrayLike, tetrahedra: ArrayLike | None, values: ArrayLike, opacity: _Points = ..., color: _Colors = ..., size: Sequence[int] = ...,
    camera: _Camera = ..., device: _Device = ..., threads: int | None = ..., **options: Any) -> Rendering: ...
def distance_field(
    data: Any, lower: float | None = ..., upper: float | None = ..., method: _Field = ..., signed: bool = ...,
    **options: Any) -> NDArray[numpy.float32]: ...
def first_hits(
    data: Any, origins: ArrayLike, directions: ArrayLike, lower: float | None = ..., upper: float | None = ..., t_min: ArrayLike = ...,
    t_max: ArrayLike = ..., **options: Any) -> Hits: ...
