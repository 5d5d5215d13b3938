"""What the letters and the numbers on a map mean, in a column beside it or below."""

from __future__ import annotations

from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from matplotlib.typing import ColorType, LineStyleType

from stepwell.figures.common import FAINT, INK, literal, plain, sheet_of, size_of, wrapped

# Distance of two lines of text, and what a row has in addition [mm].
_LINE, _GAP = 3.1, 1.5
# Width of the sample before the text, and of a character [mm].
_SAMPLE, _CHARACTER = 9.0, 1.5
_EDGE = 3.0


class Row(NamedTuple):
    """One line of a key: a box with a letter, or a line with a number, and what it means."""

    mark: str
    text: str
    shade: ColorType | None = None
    line: tuple[str, LineStyleType] | None = None
    hatched: bool = False


class Key:
    """Rows of a key, broken to a width [mm].

    Attributes:
        width, height: of all rows [mm].
    """

    def __init__(self, rows: list[Row], width: float):
        most = int((width - _SAMPLE - 1.0) / _CHARACTER)
        self._rows = [(row, wrapped(row.text, most)) for row in rows]
        lines = sum(len(text) for _, text in self._rows)
        self.width = width
        self.height = 2 * _EDGE + _LINE * lines + _GAP * len(rows)

    def draw(self, ax: Axes) -> None:
        """Write the rows into axes, from the top."""
        box, (wide, high) = ax.get_position(), size_of(sheet_of(ax))
        wide, high = wide * box.width, high * box.height
        plain(ax, (0.0, wide, 0.0, high))
        y = high - _EDGE
        for row, lines in self._rows:
            middle = y - _LINE / 2
            if row.line is not None:
                colour, style = row.line
                wide = 1.5 if row.mark else 0.8
                ends = [0.0, _SAMPLE - 1.5]
                ax.plot(ends, [middle] * 2, color=colour, linestyle=style, linewidth=wide)
                if row.mark:
                    badge(ax, sum(ends) / 2, middle, row.mark, colour)
            else:
                look = {"facecolor": row.shade or "white", "edgecolor": FAINT, "linewidth": 0.5}
                hatch = "/////" if row.hatched else None
                ax.add_patch(Rectangle((1.5, middle - 1.7), 4.4, 3.4, **look, hatch=hatch))
                ax.text(3.7, middle, row.mark, ha="center", va="center_baseline", weight="bold")
            for line in lines:
                ax.text(_SAMPLE, y - _LINE / 2, literal(line), va="center_baseline", color=INK)
                y -= _LINE
            y -= _GAP


def badge(ax: Axes, x: float, y: float, text: str, colour: str) -> Text:
    """A number on a curve."""
    box = {"boxstyle": "circle,pad=0.12", "facecolor": "white", "edgecolor": colour}
    return ax.text(
        x,
        y,
        text,
        ha="center",
        va="center_baseline",
        color=colour,
        fontweight="bold",
        bbox=box | {"linewidth": 0.8},
        zorder=8,
        gid="number",
    )
