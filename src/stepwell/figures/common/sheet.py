"""The sheet that a figure is drawn on, in millimetres: all of a page, or one panel of it."""

import base64
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from html import escape
from typing import Any, NamedTuple, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure
from matplotlib.text import Text

from stepwell.base import InputError
from stepwell.figures.common.style import STYLE
from stepwell.figures.common.write import figure_bytes

# Pixels of a screen in an inch of paper at which the type of figures, 7 points, is as large as
# that of the text round them; and pixels drawn for each, so that sharp screens show it sharp.
_SCREEN, _SHARP = 144.0, 2.0
# Bytes of the longest drawing that is kept as lines; a longer one becomes an image.
_MOST = 400_000


class PageFigure(Figure):
    """A figure that notebooks display on white and at one scale. One column of a page is 480 pixels
    wide, and no figure is wider than the notebook.
    """

    def _repr_html_(self) -> str:
        # Notebooks prefer HTML to the picture of an inline backend, which would be cropped to its
        # contents and so have another scale in each figure.
        kind, drawn = "svg+xml", figure_bytes(self, ".svg", _SCREEN * _SHARP)
        if len(drawn) > _MOST:
            kind, drawn = "png", figure_bytes(self, ".png", _SCREEN * _SHARP)
        data = base64.b64encode(drawn).decode()
        width, height = (round(_SCREEN * inches) for inches in self.get_size_inches())
        return (
            f'<img src="data:image/{kind};base64,{data}" alt="{escape(self._words())}" '
            f'width="{width}" height="{height}" '
            'style="max-width:100%;height:auto;background:white;border-radius:4px">'
        )

    def _words(self) -> str:
        # Alternative text for screen readers.
        axes = ((ax.get_ylabel(), ax.get_xlabel()) for ax in self.axes)
        labels = dict.fromkeys(f"{y} against {x}" for y, x in axes if x and y)
        return "; ".join(" ".join(one.split()) for one in labels) or "A drawing"


# Draws a panel: any function of this package with its arguments bound.
Draw = Callable[[], Figure]
# x and y; left, right, bottom and top, or left, bottom, width and height.
Point = tuple[float, float]
Box = tuple[float, float, float, float]

# Limits of height over width of a panel whose axes may have any shape, and least height of its
# axes [mm].
_SHAPES, _LOWEST = (0.55, 1.1), 30.0
# Least width of a page with panels side by side [mm].
SIDE_BY_SIDE = 150.0
# Width of a panel's letter at the left of its top row [mm].
_LETTER = 5.0


@dataclass
class CurrentPanel:
    """The panel of a page that is being drawn, or a figure on its own."""

    # Of the panel [mm]; None while its natural width is measured.
    width: float | None = None
    # Of a panel with a free height [mm]; its own choice if None.
    height: float | None = None
    # None while the panel is only measured.
    onto: SubFigure | None = None
    # Whether the upper left corner is taken by a letter.
    lettered: bool = False
    # Collects the entries of a legend shared by several panels; None if each has its own.
    shared: list[Artist] | None = None

    @property
    def alone(self) -> bool:
        """Whether it is a figure on its own."""
        return self is _ALONE

    @property
    def indent(self) -> float:
        """Free width at the left of the top row for the letter [mm]."""
        return _LETTER * self.lettered


class Size(NamedTuple):
    """Size of a panel [mm]; whether its height is fixed, and whether its legend can be shared."""

    width: float
    height: float
    rigid: bool
    keyed: bool


class _MeasuredError(Exception):
    """Ends the drawing of a panel that is only measured, once its size is known."""


_ALONE = CurrentPanel()
_panel: ContextVar[CurrentPanel] = ContextVar("panel", default=_ALONE)


@contextmanager
def drawing(panel: CurrentPanel) -> Iterator[None]:
    """Use this panel for every sheet drawn within the context."""
    token = _panel.set(panel)
    try:
        yield
    finally:
        _panel.reset(token)


def measured(draw: Draw, panel: CurrentPanel) -> Size:
    """Size of a figure as a panel, without drawing it."""
    try:
        with drawing(panel):
            draw()
    except _MeasuredError as result:
        return result.args[0]
    raise InputError(
        "a panel must be a function of stepwell.figures, such as force_stroke with its cycle."
    )


def page_width(usual: float) -> float:
    """Width of the figure [mm]: that of the current panel, or the usual one."""
    return _panel.get().width or usual


def current() -> CurrentPanel:
    """The panel that is being drawn."""
    return _panel.get()


def blank(width: float, height: float, *, rigid: bool = True, keyed: bool = False) -> Figure:
    """An empty figure of this size [mm] that can measure its text, or the current panel."""
    panel = _panel.get()
    if not panel.alone:
        if panel.onto is None:
            raise _MeasuredError(Size(width, height, rigid, keyed))
        # A SubFigure has all methods of a Figure that are used here.
        return cast("Figure", panel.onto)
    figure = PageFigure(figsize=(width / 25.4, height / 25.4))
    FigureCanvasAgg(figure)
    return figure


def place(
    figure: Figure | SubFigure, left: float, bottom: float, width: float, height: float
) -> Axes:
    """Axes at a place given in mm, so that added text does not change the layout."""
    w, h = size_of(figure)
    ax = figure.add_axes((left / w, bottom / h, width / w, height / h))
    # Set explicitly, because the number of ticks is decided later, outside this style.
    ax.tick_params(labelsize=STYLE["xtick.labelsize"])
    return ax


def size_of(figure: Figure | SubFigure) -> tuple[float, float]:
    """Width and height of a figure or of a panel [mm]."""
    box, per_mm = figure.bbox, figure.dpi / 25.4
    return float(box.width) / per_mm, float(box.height) / per_mm


def text_at(figure: Figure, x: float, y: float, text: str, **look: Any) -> Text:
    """Text at a place of the figure given in mm, bottom-aligned by default."""
    width, height = size_of(figure)
    look.setdefault("va", "bottom")
    return figure.text(x / width, y / height, text, **look)


def keep_inside(ax: Axes, least: float = 1.0) -> None:
    """Narrow the axes if labels are closer than `least` mm to the left edge, or if their last
    number would leave the page at the right.
    """
    sheet = sheet_of(ax)
    page, per_mm = sheet.bbox, sheet.dpi / 25.4
    # Twice, because narrower axes may have other numbers.
    for _ in range(2):
        place, box, below = ax.get_position(), ax.yaxis.get_tightbbox(), ax.xaxis.get_tightbbox()
        missing = least * per_mm - (box.x0 - page.x0 if box is not None else np.inf)
        over = (below.x1 if below is not None else 0.0) - page.x1
        if missing > 0 or over > 0:
            # One more pixel at the right, because rounding could put the number outside.
            left = max(missing, 0.0) / page.width
            right = (over + 1.0) / page.width if over > 0 else 0.0
            ax.set_position((place.x0 + left, place.y0, place.width - left - right, place.height))


def stack(
    figure: Figure, corner: Point, width: float, tall: Sequence[float], gap: float
) -> list[Axes]:
    """Stacked axes of these heights, the first on top, from the lower left corner [mm]."""
    left, bottom = corner
    under = [bottom + sum(tall[k + 1 :]) + gap * (len(tall) - 1 - k) for k in range(len(tall))]
    return [place(figure, left, y, width, high) for y, high in zip(under, tall, strict=True)]


def keep_both_inside(upper: Axes, lower: Axes) -> None:
    """Narrow two stacked axes to the width left by the longer labels."""
    for one, other in ((upper, lower), (lower, upper)):
        keep_inside(one)
        box, beneath = one.get_position(), other.get_position()
        other.set_position((box.x0, beneath.y0, box.width, beneath.height))


def grid(count: int, columns: int, pitch: Point, first: Point) -> list[Point]:
    """Lower left corners of panels in rows from the top, `pitch` apart, the lowest left one at
    `first` [mm].
    """
    rows = -(-count // columns)
    places = (divmod(k, columns) for k in range(count))
    return [(first[0] + k * pitch[0], first[1] + (rows - 1 - row) * pitch[1]) for row, k in places]


def canvas(
    ax: Axes | None,
    size: Point,
    margins: Box,
    *,
    rigid: bool = False,
    keyed: bool = False,
    least: float = _LOWEST,
) -> tuple[Figure, Axes]:
    """The given axes with their figure, or new axes of this size with margins left, bottom, right,
    top [mm]; axes of a panel that is not `rigid` suit its width and are at least `least` mm high.
    """
    if ax is not None:
        return root(ax), ax
    left, bottom, right, top = margins
    width, height = page_width(size[0]), size[1]
    panel = _panel.get()
    if panel.width is not None and not rigid:
        inner = width - left - right
        natural = inner * (size[1] - bottom - top) / (size[0] - left - right)
        natural = max(least, float(np.clip(natural, _SHAPES[0] * inner, _SHAPES[1] * inner)))
        height = panel.height or natural + bottom + top
    figure = blank(width, height, rigid=rigid, keyed=keyed)
    return figure, place(figure, left, bottom, width - left - right, height - bottom - top)


def sheet_of(ax: Axes) -> Figure | SubFigure:
    """The figure that these axes belong to, or the part of it."""
    parent = ax.get_figure()
    if parent is None:
        raise InputError("ax belongs to no figure: make it with figure.add_subplot().")
    return parent


def root(ax: Axes) -> Figure:
    """The whole figure that these axes belong to."""
    parent = sheet_of(ax)
    while isinstance(parent, SubFigure):
        parent = parent.figure
    return parent


def name_panel(ax: Axes, name: str, gap: float = 1.5, note: str = "") -> None:
    """Write a panel's name `gap` mm above its axes, and a note at the right."""
    sheet = sheet_of(ax)
    box = ax.get_position()
    y = box.y1 + gap / size_of(sheet)[1]
    sheet.text(box.x0, y, name, fontweight="bold", va="bottom")
    if note:
        sheet.text(box.x1, y, note, ha="right", va="bottom")
