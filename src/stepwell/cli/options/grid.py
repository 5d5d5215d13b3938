"""Reading the options of `stepwell map`."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import typer

from stepwell.base import require

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from stepwell.mechanism import Chain


def counted(text: str, count: int) -> None:
    """Refuse a count of places along one axis that no map can have."""
    if count < 2:
        raise typer.BadParameter(f"{text!r}: the count must be 2 or more.")
    try:
        require("points", count, f"{text!r}:")
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


@dataclass(frozen=True)
class Grid:
    """Equally spaced places from `start` to `stop`, both included [mm]."""

    start: float
    stop: float
    count: int

    @property
    def metres(self) -> "NDArray[np.float64]":
        """(count,) the places [m]."""
        import numpy as np

        return np.linspace(self.start / 1e3, self.stop / 1e3, self.count)

    def __str__(self):
        return f"{self.start:g}:{self.stop:g}:{self.count}"


def grid(text: str | Grid) -> Grid:
    """FROM:TO:COUNT in mm."""
    if isinstance(text, Grid):  # the default
        return text
    try:
        start, stop, count = text.split(":")
        found = Grid(float(start), float(stop), int(count))
    except ValueError:
        problem = f"{text!r}: must be FROM:TO:COUNT in mm, as in 0:20:200."
        raise typer.BadParameter(problem) from None
    if not -1e6 <= found.start < found.stop <= 1e6:
        raise typer.BadParameter(f"{text!r}: must rise, as 0:20:200 does, within -1e6 to 1e6 mm.")
    counted(text, found.count)
    return found


def cell_of(chain: "Chain", text: str) -> int:
    """The index of the cell a user means by a name, inner, outer or a number from 1."""
    names = chain.names
    if names.count(text) == 1:
        return names.index(text)
    ends = {"inner": 0, "outer": len(chain) - 1}
    if text in ends and text not in names:
        return ends[text]
    if text.isdecimal() and text.isascii() and 1 <= int(text) <= len(chain) and text not in names:
        return int(text) - 1
    known = ", ".join(f"{name} ({number})" for number, name in enumerate(names[:12], 1))
    raise typer.BadParameter(f"{text!r}: must be one of {known}.", param_hint="--cell")


def marks(chain: "Chain", cell: int) -> dict[str, tuple[float, float]]:
    """Where the design itself stands on its map [m]; nothing where its bands differ in q."""
    anchors = {band.q for band in chain.cells[cell].bands}
    return {"this design": anchors.pop()} if len(anchors) == 1 else {}
