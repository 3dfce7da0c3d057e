# SPDX-License-Identifier: BSD-3-Clause
from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from . import Tetrahedra, Volume, _Device, _Memory

class StratusVolume:  # and a pyvista.plotting.volume.Volume
    drawn: Volume | Tetrahedra
    look: dict[str, Any]
    counters: dict[str, Any]
    visibility: bool
    steps: Any  # name and labels, or None
    step: int | None
    def set(self, **look: Any) -> None: ...
    def choose(self, n: int) -> None: ...
    def remove(self, render: bool = ...) -> None: ...
    def __getattr__(self, name: str) -> Any: ...
    def __setattr__(self, name: str, value: Any) -> None: ...

class StratusComponent:
    def __init__(self, plotter: Any) -> None: ...
    @property
    def volumes(self) -> list[StratusVolume]: ...
    def add_volume(self, volume: Any, *arguments: Any, **options: Any) -> Any: ...
    def sliders(self) -> None: ...

# A StratusVolume, or for a MultiBlock a list of them.
def add_volume(
    plotter: Any, volume: Any, scalars: str | ArrayLike | None = ..., clim: float | Sequence[float] | None = ...,
    resolution: Sequence[float] | None = ..., opacity: Any = ..., n_colors: int = ..., cmap: Any = ..., flip_scalars: bool = ...,
    reset_camera: bool | None = ..., name: str | None = ..., ambient: float | None = ..., categories: bool | int = ..., culling: bool | str = ...,
    multi_colors: bool = ..., blending: str = ..., mapper: str | None = ..., scalar_bar_args: dict[str, Any] | None = ...,
    show_scalar_bar: bool | None = ..., annotations: dict[float, str] | None = ..., pickable: bool = ..., preference: str = ...,
    opacity_unit_distance: float | None = ..., shade: bool = ..., diffuse: float = ..., specular: float = ..., specular_power: float = ...,
    render: bool = ..., user_matrix: Any = ..., log_scale: bool = ..., device: _Device = ..., threads: int | None = ...,
    memory: _Memory = ..., globe: bool = ..., exaggerate: float | None = ..., **options: Any) -> Any: ...
