"""The steps of writing a folder of results, counted for a progress bar."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepwell.base import write_atomic

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Progress = Callable[[int, int], None]


class Steps:
    """Counts what is done and says so."""

    def __init__(self, progress: Progress | None, total: int):
        self.progress, self.total, self.done = progress, total, 0

    def next(self) -> None:
        """One more is done."""
        self.done += 1
        if self.progress is not None:
            self.progress(self.done, self.total)


def save_figures(drawn: Mapping[str, Figure], folder: Path, steps: Steps) -> None:
    """Write every figure as .png and as .svg."""
    from stepwell import figures

    for name, figure in drawn.items():
        for suffix in (".png", ".svg"):
            figures.save(figure, folder / f"{name}{suffix}")
            steps.next()


def write_json(file: Path, record: dict[str, Any]) -> None:
    """Write a record, finite numbers only."""
    write_atomic(file, json.dumps(record, indent=2, allow_nan=False) + "\n")


def write_netcdf(file: Path, data: xarray.Dataset) -> None:
    """Write data as NetCDF."""
    write_atomic(file, bytes(data.to_netcdf(engine="scipy")))


def names(folder: Path) -> tuple[str, ...]:
    """What a draft will have put into its folder, by name."""
    return tuple(sorted(file.name for file in folder.iterdir()))
