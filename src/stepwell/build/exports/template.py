"""Drilling templates: parts at full size on paper, with hole lists, for work by hand."""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from stepwell.base import Vec2, grouped
from stepwell.build.contour import MM, Contour
from stepwell.build.exports.page import PAPERS, Page, Pen
from stepwell.build.part import Hole, Part

# Edge that printers leave white, title above and bar below the drawing, overlap of tiles [mm].
_EDGE, _HEAD, _FOOT, _OVERLAP = 10.0, 19.0, 17.0, 10.0
# Room around a part for its dimensions [mm].
_ROOM = 12.0
_FINE, _THIN, _GREY = Pen(width=0.12), Pen(width=0.2), "#707070"
Box = tuple[float, float, float, float]  # left, low, right, high [mm]
_ROWS = 3.9  # distance of the rows of a hole list [mm]
_BAR = 100.0  # [mm]


class Alike(NamedTuple):
    """Parts of one shape: one of them, and the names of all."""

    part: Part
    names: tuple[str, ...]

    @property
    def title(self) -> str:
        """Their number and names."""
        count = f"{len(self.names)} pieces: " if len(self.names) > 1 else ""
        return count + ", ".join(self.names)


def alike(parts: Iterable[Part]) -> list[Alike]:
    """Parts of equal shape and material, in the order of their first ones."""
    shapes = grouped(
        ((part.outline, part.openings, part.material, part.thickness), part) for part in parts
    )
    return [Alike(same[0], tuple(part.name for part in same)) for same in shapes.values()]


def template_pages(parts: Iterable[Part], paper: str = "A4") -> list[Page]:
    """Pages with every shape at full size, in tiles if it is larger than the paper.

    Args:
        parts: parts of equal shape share a drawing.
        paper: "A4" or "letter".
    """
    pages: list[Page] = []
    for one in alike(parts):
        tiles = _tiles(one, PAPERS[paper])
        listed = _hole_list(one.part)
        if len(tiles) == 1 and listed:
            listed = _list_below(tiles[0], one.part, listed)
        while listed:
            page = _blank(PAPERS[paper], f"{one.title}: hole list", one.part)
            listed = _table(page, listed, PAPERS[paper][1] - _EDGE - _HEAD - 4.0)
            tiles.append(page)
        pages += tiles
    for number, page in enumerate(pages, 1):
        page.text(
            (page.width - _EDGE, page.height - _EDGE - 3.0),
            f"page {number} of {len(pages)}",
            2.6,
            anchor="end",
        )
    return pages


def template_page(part: Part) -> Page:
    """One page with a part at full size, as large as the part needs, for SVG."""
    x0, y0, x1, y1 = (MM * one for one in part.outline.bounds)
    width = max(x1 - x0, _BAR) + 2.0 * (_ROOM + _EDGE)
    page = Page(width, y1 - y0 + 2.0 * (_ROOM + _EDGE) + _FOOT + _HEAD)
    _title(page, part.name, part)
    _bar(page)
    _drawing(page, part, (_EDGE + _ROOM - x0, _EDGE + _FOOT + _ROOM - y0))
    return page


def _blank(paper: Vec2, title: str, part: Part) -> Page:
    page = Page(*paper)
    _title(page, title, part)
    _bar(page)
    return page


def _title(page: Page, title: str, part: Part) -> None:
    x, y = _EDGE, page.height - _EDGE - 4.0
    y = page.paragraph((x, y), title, page.width - 2.0 * _EDGE - 30.0, 3.6, bold=True)
    x0, y0, x1, y1 = (MM * one for one in part.outline.bounds)
    size = f"{x1 - x0:.2f} x {y1 - y0:.2f} mm, {part.material}, {MM * part.thickness:g} mm thick"
    about = f"{size}. Print at 100 % (actual size)."
    page.text((x, y - 0.5), about, 2.8, colour=_GREY)


def _bar(page: Page) -> None:
    """A bar of 100 mm, with a tick each 10 mm."""
    x, y = _EDGE + 2.0, _EDGE + 5.0
    page.line([(x, y), (x + _BAR, y)], _THIN)
    for tick in range(11):
        high = 3.0 if tick % 5 == 0 else 1.8
        page.line([(x + 10.0 * tick, y), (x + 10.0 * tick, y + high)], _THIN)
    text = "This bar must measure 100.0 mm. If it does not, the printer has scaled the page."
    page.text((x, y - 3.6), text, 2.6)


def _tiles(one: Alike, paper: Vec2) -> list[Page]:
    """Pages that together show a part; neighbours overlap and have common crosses."""
    x0, y0, x1, y1 = (MM * edge for edge in one.part.outline.bounds)
    room = paper[0] - 2.0 * _EDGE, paper[1] - 2.0 * _EDGE - _HEAD - _FOOT
    size = x1 - x0 + 2.0 * _ROOM, y1 - y0 + 2.0 * _ROOM
    counts = [
        1 if want <= have else 1 + math.ceil((want - have) / (have - _OVERLAP))
        for want, have in zip(size, room, strict=True)
    ]
    pages = []
    for row in range(counts[1]):
        for column in range(counts[0]):
            tile = ""
            if counts != [1, 1]:
                tile = (
                    f": tile {column + 1} of {counts[0]} along x, {row + 1} of {counts[1]} along y"
                )
            page = _blank(paper, one.title + tile, one.part)
            steps = column * (room[0] - _OVERLAP), row * (room[1] - _OVERLAP)
            # The part starts at the upper left if it is on one page.
            up = room[1] - size[1] if counts[1] == 1 else 0.0
            at = _EDGE + _ROOM - x0 - steps[0], _EDGE + _FOOT + _ROOM - y0 - steps[1] + up
            window = (_EDGE, _EDGE + _FOOT, _EDGE + room[0], _EDGE + _FOOT + room[1])
            _drawing(page, one.part, at, None if counts == [1, 1] else window)
            if counts != [1, 1]:
                _crosses(page, window, (column, row), (counts[0], counts[1]))
            pages.append(page)
    return pages


def _crosses(page: Page, window: Box, place: tuple[int, int], counts: tuple[int, int]) -> None:
    """Marks on which neighbouring tiles are laid, in the middle of the overlap, and the edge."""
    left, low, right, high = window
    frame = [(left, low), (right, low), (right, high), (left, high)]
    page.line(frame, Pen(_GREY, None, 0.1), closed=True)
    half = _OVERLAP / 2.0
    (column, row), (columns, rows) = place, counts
    xs = [left + half] * (column > 0) + [right - half] * (column < columns - 1)
    ys = [low + half] * (row > 0) + [high - half] * (row < rows - 1)
    # Marks are shared by neighbours: they are a quarter from the ends of each common edge.
    spots = {(x, low + share * (high - low)) for x in xs for share in (0.25, 0.75)}
    spots |= {(left + share * (right - left), y) for y in ys for share in (0.25, 0.75)}
    for x, y in sorted(spots):
        page.circle((x, y), 2.0, _FINE)
        page.line([(x - 4.0, y), (x + 4.0, y)], _FINE)
        page.line([(x, y - 4.0), (x, y + 4.0)], _FINE)
    text = "Cut along the grey frame. Lay the circled crosses of two tiles on each other."
    page.text((left + 1.0, high + 1.2), text, 2.4, colour=_GREY)


def _drawing(page: Page, part: Part, at: Vec2, window: Box | None = None) -> None:
    """The part at full size with centres, names and overall dimensions."""
    inside = [hole for hole in part.holes if window is None or _inside(hole, at, window)]
    outline = Pen(width=0.25)
    if window is None:
        page.contours([part.outline, *part.cutouts], at, outline)
    else:
        for contour in (part.outline, *part.cutouts):
            _clipped(page, contour, at, window)
    for hole in inside:
        _hole(page, hole, at)
    if window is None:
        _dimensions(page, part, at)


def _inside(hole: Hole, at: Vec2, window: Box) -> bool:
    x, y = at[0] + MM * hole.centre[0], at[1] + MM * hole.centre[1]
    edge = 500.0 * hole.diameter + 1.0
    left, low, right, high = window
    return left + edge <= x <= right - edge and low + edge <= y <= high - edge


def _clipped(page: Page, contour: Contour, at: Vec2, window: Box) -> None:
    """The stretches of a contour within a window [mm]."""
    import shapely

    ring = MM * contour.ring() + at
    line = shapely.LinearRing(ring).intersection(shapely.box(*window))
    for piece in shapely.get_parts(line):
        if piece.geom_type == "LineString":
            page.line(shapely.get_coordinates(piece), Pen(width=0.25))


def _hole(page: Page, hole: Hole, at: Vec2) -> None:
    x, y = at[0] + MM * hole.centre[0], at[1] + MM * hole.centre[1]
    radius = 500.0 * hole.diameter
    page.circle((x, y), radius, _FINE)
    # Short crosses and small names: grids have 2 mm between their holes.
    reach = radius + 0.3
    page.line([(x - reach, y), (x + reach, y)], Pen(width=0.08))
    page.line([(x, y - reach), (x, y + reach)], Pen(width=0.08))
    page.text((x, y + radius + 0.5), hole.name, 1.4, anchor="middle")


def _dimensions(page: Page, part: Part, at: Vec2) -> None:
    """Overall width below the part, height at its right."""
    x0, y0, x1, y1 = (MM * one for one in part.outline.bounds)
    left, right, low, high = at[0] + x0, at[0] + x1, at[1] + y0, at[1] + y1
    pen, gap = Pen(_GREY, None, 0.12), 6.0
    _dimension(page, ((left, low - gap), (right, low - gap)), f"{x1 - x0:.2f}", pen)
    _dimension(page, ((right + gap, low), (right + gap, high)), f"{y1 - y0:.2f}", pen)
    for x in (left, right):
        page.line([(x, low - 1.0), (x, low - gap - 1.0)], pen)
    for y in (low, high):
        page.line([(right + 1.0, y), (right + gap + 1.0, y)], pen)
    # The corner from which the hole list measures.
    page.line([(left - 4.0, low), (left, low), (left, low - 4.0)], Pen(width=0.12))
    page.text((left - 4.5, low - 3.8), "0, 0", 2.0, anchor="middle", colour=_GREY)


def _dimension(page: Page, ends: tuple[Vec2, Vec2], text: str, pen: Pen) -> None:
    (x0, y0), (x1, y1) = ends
    page.line(ends, pen)
    way = math.atan2(y1 - y0, x1 - x0)
    for (x, y), turn in ((ends[0], way), (ends[1], way + math.pi)):
        wings = [
            (x + 1.6 * math.cos(turn + side), y + 1.6 * math.sin(turn + side))
            for side in (0.2, -0.2)
        ]
        page.line([(x, y), *wings], Pen(None, pen.line), closed=True)
    middle = (x0 + x1) / 2.0 - 1.0 * math.sin(way), (y0 + y1) / 2.0 + 1.0 * math.cos(way)
    page.text(middle, text, 2.6, anchor="middle", angle=math.degrees(way))


Row = tuple[str, str, str, str, str]
_HEADS: Row = ("hole", "x [mm]", "y [mm]", "Ø [mm]", "for")
_COLUMNS = (0.0, 20.0, 33.0, 45.0, 48.0)  # right edges of numbers, left edges of words [mm]
_LIST = 62.0  # width of a column of the list [mm]


def _hole_list(part: Part) -> list[Row]:
    """Places of the holes from the lower left corner of the part, and diameters."""
    x0, y0, *_ = part.outline.bounds
    return [
        (
            hole.name,
            f"{MM * (hole.centre[0] - x0):.2f}",
            f"{MM * (hole.centre[1] - y0):.2f}",
            f"{MM * hole.diameter:.2f}",
            hole.use,
        )
        for hole in part.holes
    ]


def _list_below(page: Page, part: Part, rows: Sequence[Row]) -> list[Row]:
    """The hole list under a drawing, if all of it has room there; what is left."""
    _, y0, _, y1 = (MM * one for one in part.outline.bounds)
    top = page.height - _EDGE - _HEAD - (y1 - y0) - 2.0 * _ROOM - 2.0
    columns = int((page.width - 2.0 * _EDGE) // _LIST)
    high = math.ceil(len(rows) / columns) + 1
    if top - high * _ROWS < _EDGE + _FOOT:
        return list(rows)
    return _table(page, rows, top)


def _table(page: Page, rows: Sequence[Row], top: float) -> list[Row]:
    """Rows in columns from `top` [mm] down; returns rows that have no room."""
    columns = int((page.width - 2.0 * _EDGE) // _LIST)
    most = int((top - _EDGE - _FOOT) / _ROWS) - 1
    each = min(most, math.ceil(len(rows) / columns))
    for column in range(columns):
        part = rows[column * each : (column + 1) * each]
        if not part:
            break
        left = _EDGE + column * _LIST
        for i, row in enumerate((_HEADS, *part)):
            y = top - i * _ROWS
            for j, (word, x) in enumerate(zip(row, _COLUMNS, strict=True)):
                anchor = "end" if 0 < j < 4 else "start"
                page.text((left + x, y), word, 2.4, anchor=anchor, bold=i == 0)
        page.line([(left, top - 1.2), (left + _LIST - 4.0, top - 1.2)], Pen(width=0.1))
    return list(rows[columns * each :])
