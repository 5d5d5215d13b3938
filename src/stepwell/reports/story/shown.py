"""What is seen of a step: a motion that plays, or a picture, as a piece of a page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from stepwell.mechanism import Chain
from stepwell.reports.write import image_of
from stepwell.sequences import Program
from stepwell.studio.replay import embedded, replay

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

    from stepwell.design import Boundary
    from stepwell.simulation import Maze, Walk


@dataclass(frozen=True, slots=True)
class Shown:
    """A piece of the page.

    Attributes:
        html: an element.
        caption: what it shows.
        sequence: of the states it goes through, as "00>10>11>01>00"; "" where it has none.
        moves: whether it plays.
    """

    html: str
    caption: str
    sequence: str
    moves: bool

    def __repr__(self):
        return f"Shown({self.caption!r}, {self.sequence!r}, moves={self.moves})"


def moving(
    result: Chain | Program | Walk | Maze,
    caption: str,
    sequence: str,
    progress: Callable[[float, float], None] | None = None,
) -> Shown:
    """A chain, a program or a robot that plays."""
    page = replay(result, title=caption, progress=progress)
    return Shown(embedded(page, caption, plays=True), caption, sequence, moves=True)


def map_of(
    dataset: Dataset,
    borders: Iterable[Boundary],
    marks: Mapping[str, tuple[float, float]],
) -> Shown:
    """A map, with the places [m] of some designs on it."""
    from stepwell import figures

    caption = "The order for every place of the outer cell's anchor"
    drawn = figures.transition_map(dataset, borders, marks)
    return Shown(_picture(drawn, caption), caption, "", moves=False)


def _picture(figure: Figure, caption: str) -> str:
    source, width, height = image_of(figure)
    name = escape(caption)
    return (
        f'<div tabindex="0" role="group" aria-label="{name}"><img alt="{name}" '
        f'width="{width}" height="{height}" src="{source}"></div>'
    )
