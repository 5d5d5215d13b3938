"""What the letters and the numbers on a map mean, in a column beside it."""

from __future__ import annotations

from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from matplotlib.typing import ColorType, LineStyleType

from stepwell.figures.common import FAINT, INK, literal, root, wrapped

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
        height: of all rows [mm].
    """

    def __init__(self, rows: list[Row], width: float):
        most = int((width - _SAMPLE - 1.0) / _CHARACTER)
        self._rows = [(row, wrapped(row.text, most)) for row in rows]
        lines = sum(len(text) for _, text in self._rows)
        self.height = 2 * _EDGE + _LINE * lines + _GAP * len(rows)

    def draw(self, ax: Axes) -> None:
        """Write the rows into axes, from the top."""
        box = ax.get_position()
        wide, high = 25.4 * root(ax).get_size_inches() * (box.width, box.height)
        ax.set_axis_off()
        ax.set_xlim(0.0, wide)
        ax.set_ylim(0.0, high)
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
                ax.add_patch(
                    Rectangle(
                        (1.5, middle - 1.7), 4.4, 3.4, facecolor=row.shade or "white",
                        edgecolor=FAINT, linewidth=0.5, hatch="/////" if row.hatched else None,
                    )
                )  # fmt: skip
                ax.text(3.7, middle, row.mark, ha="center", va="center_baseline", weight="bold")
            for line in lines:
                ax.text(_SAMPLE, y - _LINE / 2, literal(line), va="center_baseline", color=INK)
                y -= _LINE
            y -= _GAP


def badge(ax: Axes, x: float, y: float, text: str, colour: str) -> Text:
    """A number on a curve."""
    return ax.text(
        x,
        y,
        text,
        ha="center",
        va="center_baseline",
        color=colour,
        fontweight="bold",
        bbox={
            "boxstyle": "circle,pad=0.12",
            "facecolor": "white",
            "edgecolor": colour,
            "linewidth": 0.8,
        },
        zorder=8,
        gid="number",
    )
