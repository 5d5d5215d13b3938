"""Figures with several panels, at the width of a journal's column."""

import math
import re
import string
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from matplotlib.artist import Artist
from matplotlib.figure import Figure, SubFigure

from stepwell.base import InputError, nearest_word
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.words import literal

_MM = MappingProxyType({"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72.0})
# Limits of the page width [mm].
NARROWEST, WIDEST = 40.0, 400.0


class JournalWidth(NamedTuple):
    """A width of figures [mm], its meaning, and the publisher's guideline."""

    width: float
    what: str
    source: str


def _columns(name: str, source: str, *widths: float) -> dict[str, JournalWidth]:
    words = ("single", "double") if len(widths) == 2 else ("single", "middle", "double")
    return {
        f"{name}-{word}": JournalWidth(round(width, 1), f"{word} column", source)
        for word, width in zip(words, widths, strict=True)
    }


WIDTHS: MappingProxyType[str, JournalWidth] = MappingProxyType(
    _columns("nature", "Nature, research figure guide: figure sizing", 89.0, 183.0)
    | _columns("science", "Science, preparing figures: 5.7, 12.1, 18.4 cm", 57.0, 121.0, 184.0)
    | _columns("pnas", "PNAS, digital art guidelines: 8.7, 11.4, 17.8 cm", 87.0, 114.0, 178.0)
    | _columns("aps", "American Physical Society, Physical Review: 8.6, 17.8 cm", 86.0, 178.0)
    | _columns("acs", "American Chemical Society: 240, 504 pt", 240 * _MM["pt"], 504 * _MM["pt"])
    | _columns("elsevier", "Elsevier, artwork sizing: 90, 140, 190 mm", 90.0, 140.0, 190.0)
    | _columns("springer", "Springer, artwork: 84, 174 mm", 84.0, 174.0)
    | _columns("wiley", "Wiley, figure sizes: 80, 180 mm", 80.0, 180.0)
    | _columns("ieee", "IEEE, graphics sizing: 3.5, 7.16 in", 3.5 * 25.4, 7.16 * 25.4)
    | _columns("rsc", "Royal Society of Chemistry: 8.3, 17.1 cm", 83.0, 171.0)
)


def length(text: str) -> float:
    """Width [mm] of a text such as "88mm", "3.5 in", "18cm" or "240pt", or of a journal's name.

    Raises:
        ValueError: no length, a missing unit, an unknown name, or a length out of range.
    """
    known = text.strip().lower()
    if known in WIDTHS:
        return WIDTHS[known].width
    match = re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*([a-z]*)", known)
    if match is None:
        near = nearest_word(known, WIDTHS)
        guess = f" Did you mean {near}?" if near else ""
        names = ", ".join(WIDTHS)
        raise InputError(
            f"{text!r}: must be a length such as 88mm, 8.8cm, 3.5in or 250pt, or one of {names}."
            f"{guess}"
        )
    value, unit = float(match[1]), match[2]
    if unit not in _MM:
        was = f"unknown unit {unit!r}" if unit else "has no unit"
        raise InputError(f"{text!r}: {was}; write {value:g}mm, or use cm, in or pt.")
    result = value * _MM[unit]
    if not NARROWEST <= result <= WIDEST:
        raise InputError(f"{text!r} is {result:.4g} mm: must be {NARROWEST:g} to {WIDEST:g} mm.")
    return result


# Panels in reading order, rows of panels, or rows by name.
Panels = Sequence[sheet.Draw | Sequence[sheet.Draw]] | Mapping[str, Sequence[sheet.Draw]]

# Distance of rows and of the panels of a row, and height of a common legend [mm].
_BETWEEN, _LEGEND = 3.0, 5.0
# Approximate width of a panel, unless columns are given [mm].
_USUAL = 75.0
# Height of the name of a row [mm].
_NAME = 4.5
# Least height of a panel with curves [mm].
_LOWEST = 38.0
MOST_PANELS = 26
LETTERS: dict[str, Callable[[str], str]] = {
    "A": str.upper,
    "a": str,
    "(a)": "({})".format,
    "none": lambda _: "",
}


# Panels side by side, each with its size [mm].
_Row = list[tuple[sheet.Draw, sheet.Size]]


@style.styled
def compose(
    panels: Panels,
    *,
    width: float = style.PAGE,
    height: float | None = None,
    columns: int | None = None,
    letters: str = "A",
) -> Figure:
    """One figure with several panels, with letters and a common legend.

    Panels are drawn at their printed size and never scaled: text has 7 pt and lines keep their
    width at any page width.

    Args:
        panels: functions that draw the panels, in reading order: functions of this package with
            arguments, such as `partial(force_stroke, cycle)`. A list makes a row; the names of a
            mapping are written above its rows.
        width: of the page [mm], at least 40 for each panel of a row.
        height: of the page [mm]; by default that of the panels. Panels with a free aspect ratio
            take up the difference.
        columns: panels per row if no rows are given; by default about one per 75 mm. A figure that
            is two columns wide has its own row.
        letters: style of the panel letters: "A", "a", "(a)" or "none". A single panel has none.

    Raises:
        ValueError: no panel or too many, an impossible width or height, or other letters.
    """
    titles, given = ([*panels], [*panels.values()]) if isinstance(panels, Mapping) else ([], panels)
    count = _count(given)
    if not 0 < count <= MOST_PANELS:
        raise InputError(f"panels has {count} entries: must be 1 to {MOST_PANELS}.")
    if letters not in LETTERS:
        raise InputError(f"letters = {letters!r}: must be one of {', '.join(LETTERS)}.")
    panel = sheet.CurrentPanel(lettered=count > 1 and letters != "none")
    rows = [_laid(row, width, panel) for row in _rows(given, width, columns, panel)]
    share = sum(size.keyed for row in rows for _, size in row) > 1
    legend: list[Artist] | None = [] if share else None
    room = _LEGEND * share + _BETWEEN * (len(rows) - 1) + _NAME * len(titles)
    rows = _stretched(rows, height, room)
    tall = [max(size.height for _, size in row) for row in rows]
    top = sum(tall) + room
    figure = sheet.blank(width, top)
    names = map(LETTERS[letters], string.ascii_lowercase)
    for k, (row, high) in enumerate(zip(rows, tall, strict=True)):
        if titles:
            look = {"va": "top", "fontweight": "bold", "fontsize": 8.0}
            sheet.text_at(figure, 0.5, top - 0.5, literal(titles[k]), **look)
            top -= _NAME
        _draw_row(figure, row, top, replace(panel, shared=legend), names)
        top -= high + _BETWEEN
    if legend:
        legends.below(figure, legend, len(legend))
    return figure


def _draw_row(
    figure: Figure, row: _Row, top: float, panel: sheet.CurrentPanel, names: Iterator[str]
) -> None:
    """Draw panels side by side with their letters, below the height `top` of the page [mm]."""
    left = 0.0
    for draw, size in row:
        onto = _part(figure, left, top - size.height, size)
        own = replace(
            panel, width=size.width, height=None if size.rigid else size.height, onto=onto
        )
        with sheet.drawing(own if size.keyed else replace(own, shared=None)):
            draw()
        if panel.lettered:
            look = {"va": "top", "fontsize": 8.0, "fontweight": "bold", "gid": "letter"}
            sheet.text_at(figure, left + 0.5, top - 0.5, next(names), **look)
        left += size.width + _BETWEEN


def _count(panels: Sequence[sheet.Draw | Sequence[sheet.Draw]]) -> int:
    return sum(1 if callable(one) else len(one) for one in panels)


def _rows(
    panels: Sequence[sheet.Draw | Sequence[sheet.Draw]],
    width: float,
    columns: int | None,
    panel: sheet.CurrentPanel,
) -> list[list[sheet.Draw]]:
    if columns is not None and not 1 <= columns <= MOST_PANELS:
        raise InputError(f"columns = {columns}: must be 1 to {MOST_PANELS}.")
    if not all(map(callable, panels)):
        return [[one] if callable(one) else list(one) for one in panels if callable(one) or one]
    return _filled([one for one in panels if not isinstance(one, Sequence)], width, columns, panel)


def _filled(
    panels: Sequence[sheet.Draw], width: float, columns: int | None, panel: sheet.CurrentPanel
) -> list[list[sheet.Draw]]:
    """Rows of so many columns, or of about 75 mm with a row for each panel that is wider."""
    most = columns or max(1, round(width / _USUAL))
    each = (width - _BETWEEN * (most - 1)) / most
    rows: list[list[sheet.Draw]] = []
    free = 0
    for draw in panels:
        alone = columns is None and not _may_share(draw, each, panel)
        if alone or not free:
            rows.append([])
        rows[-1].append(draw)
        free = 0 if alone else (free or most) - 1
    return rows


def _may_share(draw: sheet.Draw, width: float, panel: sheet.CurrentPanel) -> bool:
    """Whether a panel is narrower than two columns and can have this width [mm]."""
    if sheet.measured(draw, panel).width >= style.PAGE:
        return False
    try:
        return sheet.measured(draw, replace(panel, width=width)).width <= width + 1e-6
    except InputError:
        return False


def _laid(row: list[sheet.Draw], width: float, panel: sheet.CurrentPanel) -> _Row:
    """The panels of a row, with equal widths, and equal heights if possible."""
    each = (width - _BETWEEN * (len(row) - 1)) / len(row)
    if not each >= NARROWEST:
        least = NARROWEST * len(row) + _BETWEEN * (len(row) - 1)
        raise InputError(
            f"width = {width:g} mm: {len(row)} panels side by side need {least:g} mm or more."
        )
    sizes = [sheet.measured(draw, replace(panel, width=each)) for draw in row]
    for size in sizes:
        if size.width > each + 1e-6:
            raise InputError(
                f"width: one panel has a fixed width of {size.width:g} mm, and only {each:.4g} mm "
                f"are available: give it its own row, or a wider page."
            )
    fixed = [size.height for size in sizes if size.rigid]
    high = max(_LOWEST, *(fixed or [size.height for size in sizes]))
    # A panel with a free height must not become much taller than wide.
    most = [max(1.1 * size.width, size.height) for size in sizes]
    laid = [
        size if size.rigid else size._replace(height=min(high, own))
        for size, own in zip(sizes, most, strict=True)
    ]
    return list(zip(row, laid, strict=True))


def _stretched(rows: list[_Row], height: float | None, room: float) -> list[_Row]:
    """Rows stretched to a page height with `room` between them [mm]; only rows without a rigid
    panel change.
    """
    if height is None:
        return rows
    tall = [max(size.height for _, size in row) for row in rows]
    loose = [not any(size.rigid for _, size in row) for row in rows]
    fixed = sum(high for high, may in zip(tall, loose, strict=True) if not may)
    rest = sum(tall) - fixed
    least = fixed + _LOWEST * sum(loose)
    if not rest:
        own = f"these panels have a fixed height, {fixed + room:.4g} mm in all"
        raise InputError(f"height = {height:g} mm: {own}: leave out the height.")
    if height < least + room:
        need = f"these panels need {math.ceil(least + room)} mm or more"
        raise InputError(f"height = {height:g} mm: {need}: give that, or leave out the height.")
    by = (height - room - fixed) / rest
    return [
        [(draw, size._replace(height=high * by)) for draw, size in row] if may else row
        for row, high, may in zip(rows, tall, loose, strict=True)
    ]


def _part(figure: Figure, left: float, bottom: float, size: sheet.Size) -> SubFigure:
    """A subfigure at a place given in mm."""
    wide, high = sheet.size_of(figure)
    # The middle of a 3 x 3 grid, because the position of a subfigure is a cell of a grid.
    across = left, size.width, max(wide - left - size.width, 0.0)
    down = max(high - bottom - size.height, 0.0), size.height, bottom
    grid = figure.add_gridspec(3, 3, width_ratios=across, height_ratios=down)
    part = figure.add_subfigure(grid[1, 1])
    part.set_facecolor("none")
    return part
