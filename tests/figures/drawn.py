"""Reading a figure back: its lines, its words, and whether the words can be read."""

from collections.abc import Callable
from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text
from numpy.typing import NDArray

from sizes import cases
from stepwell import figures, files

# One of each number of cells, actuator and shape of curve.
PRESETS = cases(
    sorted(name for name in files.presets() if not name.startswith("robot-")),
    ("paper-forward", "three-wave", "compliant-actuator", "paper-cell-0-m15", "paper-via-10",
     "four-shuffle", "metachronal-wave", "balloon"),
)  # fmt: skip

Array = NDArray[np.float64]


def lines(figure: Figure, gid: str) -> list[Line2D]:
    """The lines with this mark, in all axes."""
    return [line for ax in figure.axes for line in ax.get_lines() if line.get_gid() == gid]


def points(line: Line2D) -> Array:
    """(n, 2) where the line goes, gaps as NaN."""
    return np.asarray(line.get_xydata(), float)


def marks(figure: Figure, gid: str) -> int:
    """How many points the lines with this mark have."""
    return sum(len(points(line)) for line in lines(figure, gid))


def line_of(ax: Axes, colour: str) -> Array:
    """(n, 2) the longest line of this colour, without its gaps."""
    curves = [
        points(line)
        for line in ax.get_lines()
        if line.get_color() == colour and line.get_gid() is None
    ]
    longest = max(curves, key=len)
    return longest[np.isfinite(longest).all(axis=1)]


def words(figure: Figure | SubFigure) -> list[Text]:
    """Every text that is shown, tick labels included."""
    whole = figure
    while isinstance(whole, SubFigure):
        whole = whole.figure
    whole.draw_without_rendering()
    return _words(figure)


def _words(figure: Figure | SubFigure) -> list[Text]:
    """The same of a figure that has been drawn."""
    texts: list[Text] = list(figure.texts)
    for ax in figure.axes:
        texts += ax.texts
        for legend in legends(ax):
            texts += legend.get_texts()
        if not ax.axison:
            continue
        texts += [ax.title, ax.xaxis.label, ax.yaxis.label]
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            slip = 1e-9 * (high - low)
            for tick in axis.get_major_ticks():
                if low - slip <= tick.get_loc() <= high + slip:
                    texts += [tick.label1, tick.label2]
    unique = {id(text): text for text in texts}.values()
    return [text for text in unique if text.get_visible() and text.get_text().strip()]


def says(figure: Figure | SubFigure) -> list[str]:
    """What all the texts say."""
    return [text.get_text() for text in words(figure)]


def legends(ax: Axes) -> list[Legend]:
    """All legends of these axes, the first one included when a second was added."""
    return [artist for artist in ax.get_children() if isinstance(artist, Legend)]


def legend_of(figure: Figure) -> list[str]:
    """The entries of all legends."""
    return [
        text.get_text()
        for ax in figure.axes
        for legend in legends(ax)
        for text in legend.get_texts()
    ]


def collisions(figure: Figure) -> list[tuple[str, str]]:
    """Pairs of texts that cover each other."""
    return _covered(words(figure))


def untidy(figure: Figure | SubFigure, smallest: float = 0.0) -> list[str]:
    """What of a figure cannot be read, with one drawing for all of it.

    That is texts that cover each other, reach past the edge of the page or are set smaller than
    `smallest` [pt].
    """
    return _untidy(figure, words(figure), smallest)


def untidy_parts(figure: Figure) -> list[str]:
    """What of a figure's parts cannot be read, each taken for itself, with one drawing for all."""
    figure.draw_without_rendering()
    parts = figure.subfigs or [figure]
    return [each for part in parts for each in _untidy(part, _words(part))]


def _untidy(figure: Figure | SubFigure, shown: list[Text], smallest: float = 0.0) -> list[str]:
    small = [text.get_text() for text in shown if float(text.get_fontsize()) < smallest]
    return [
        *(f"{a} covers {b}" for a, b in _covered(shown)),
        *(f"{text} leaves the page" for text in _outside(figure, shown)),
        *(f"{text} is too small" for text in small),
    ]


def untidy_on_a_phone(draw: Callable[[], Figure], smallest: float = 7.0) -> list[str]:
    """What cannot be read of a figure as wide as a phone shows it."""
    return untidy(figures.compose([draw], width=85.0).subfigs[0], smallest)


def cut_off(figure: Figure) -> list[str]:
    """Texts that reach past the edge of the page."""
    return _outside(figure, words(figure))


def _covered(shown: list[Text]) -> list[tuple[str, str]]:
    boxes = [(text.get_text(), text.get_window_extent()) for text in shown]
    return [(a, b) for (a, p), (b, q) in combinations(boxes, 2) if p.overlaps(q)]


def _outside(figure: Figure | SubFigure, shown: list[Text]) -> list[str]:
    page = figure.bbox
    return [
        text.get_text()
        for text in shown
        if (box := text.get_window_extent()).x0 < page.x0
        or box.y0 < page.y0
        or box.x1 > page.x1
        or box.y1 > page.y1
    ]
