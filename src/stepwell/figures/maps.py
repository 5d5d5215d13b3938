"""What a chain does for every value of two of its parameters."""

from __future__ import annotations

import string
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from matplotlib.typing import ColorType, LineStyleType
from numpy.typing import NDArray

from stepwell.base import Bools, Floats, Quantity, display_unit
from stepwell.design import Boundary
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.words import literal, sequence_words
from stepwell.figures.map_parts import PLACES, Key, Row, badge, between, name_regions
from stepwell.sequences import Pathway

if TYPE_CHECKING:
    from xarray import Dataset


# Of a map, as wide as it may be, and from which width of the page on the key stands beside it
# [mm]; below it, if it is no higher than this share of the map.
_SIDE, _WIDEST, _SHORT = 70.0, 110.0, 0.7
# A key beside the map that is so much higher than the map is parted [mm].
_LONG = 30.0
# Characters that a row of the key has room for.
_ROOM = 50
# Pieces of a curve longer than this have their own number [pt], at one of these shares of it.
_NUMBERED = 25.0
_ALONG = np.array([0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82, 0.1, 0.9])
# Between the names of a design and of a region [pt].
_CLEAR = 5.0
_SHADES = (
    *(style.ORANGE, style.SKY, style.YELLOW, style.GREEN, style.PURPLE),
    *("#8F8F8F", style.BLUE, style.VERMILLION),
)
_PARTS = {f"{anchor}.{way}": f"${anchor}_{way}$" for anchor in "pq" for way in "xy"} | {
    "limit": "Angle limit",
    "force_scale": "Scale of force",
    "travel_scale": "Scale of travel",
}
# By the kind of boundary: colour and line, as loading and unloading have them everywhere.
_LINES: dict[str, tuple[str, LineStyleType]] = {
    "LOADING_ORDER": (style.LOADING, "-"),
    "UNLOADING_ORDER": (style.UNLOADING, (0, (3.2, 1.6))),
    "BISTABLE": (style.INK, (0, (3, 1.5))),
}
_EDGE = "bistable up to here"
# What has no sequence: its name on the map and in the key.
_EMPTY = {
    "impossible": ("no mechanism", "no mechanism: the band's ends meet"),
    "unsolved": ("no answer", "no answer"),
}

_PATHWAYS = {pathway.value: pathway for pathway in Pathway}
_DESIGN: dict[str, Any] = {"markersize": 4.6, "color": style.BLACK, "zorder": 8, "clip_on": False}
_DESIGN |= {"markeredgecolor": "white", "markeredgewidth": 0.7}


class _Axis(NamedTuple):
    """Values in drawn units, and what to write beside them."""

    values: Floats
    scale: float
    name: str
    is_log: bool

    def share(self, values: Floats) -> Floats:
        """Where values are on the page, 0 at one end of the axis and 1 at the other."""
        low, high = self.values[[0, -1]]
        if self.is_log:
            values, low, high = np.log(np.maximum(values, low / 2)), np.log(low), np.log(high)
        return (values - low) / ((high - low) or 1.0)


class _Region(NamedTuple):
    """All nodes with one sequence."""

    name: str
    sequence: str
    inside: Bools
    shade: ColorType


@style.styled
def transition_map(
    dataset: Dataset,
    boundaries: Iterable[Boundary] = (),
    designs: Mapping[str, sheet.Point] | None = None,
) -> Figure:
    """Sequences over two parameters, boundaries as curves, and beside or below what they mean.

    One column wide, or two where the key is long; lengths in mm, angles in degrees. Each region has
    a letter, or its name where it is one of the four pathways of two cells, and each curve a
    number. Curves across which only the loading order changes are blue, only the unloading order
    vermillion and dashed, all others black. It is hatched where a cell whose parameter varies is
    stable in one state only, up to a thin dashed line.

    Args:
        dataset: what `design.transition_map` or `design.parameter_map` returns, in memory or read
            back from a file.
        boundaries: what `design.boundaries` or `design.parameter_boundaries` returns for the same.
        designs: the two parameters in SI of each design to be marked, by the name to write.

    Source: Kamp et al. 2024, Fig. 2C.
    """
    x, y = _axis(dataset, "x"), _axis(dataset, "y")
    regions = _regions(dataset)
    curves = _curves(boundaries)
    scale = x.scale, y.scale
    figure, ax, keys = _lay_out(_rows(dataset, regions, curves), _aspect(dataset, x, y))
    at = (points * scale for one in curves for points in one.points)
    walls = [np.column_stack([x.share(points[:, 0]), y.share(points[:, 1])]) for points in at]
    # What is at the nodes, and up to the boundaries between them.
    spread = partial(between, x=x.share(x.values), y=y.share(y.values), curves=walls)
    places = _places(x), _places(y)
    shown = _draw_regions(ax, places, regions, spread)
    for axis, values in (("x", x), ("y", y)):
        kind = "log" if values.is_log else "linear"
        ax.set(**{f"{axis}scale": kind, f"{axis}lim": values.values[[0, -1]]})
    monostable = spread(dataset["monostable"].to_numpy().astype(int))
    if np.any(monostable):
        look = {"colors": "none", "hatches": ["////"]}
        hatches = ax.contourf(*places, monostable.astype(float), [0.5, 1.5], **look)
        hatches.set(edgecolor=style.FAINT, linewidth=0.0)
    ax.set(xlabel=x.name, ylabel=y.name)
    sheet.keep_inside(ax)
    taken = _draw_curves(ax, curves, scale)
    # Designs first: their names belong beside their dots, those of regions fit elsewhere too.
    taken += _draw_designs(ax, designs or {}, scale, taken)
    free = _free(ax, *places, taken)
    for region in shown:
        if region.name:
            in_two = region.name.replace("no ", "no\n").replace("counterc", "counter-\nc")
            name_regions(ax, *places, region.inside & free, [region.name, in_two], region.shade)
    for key, box in keys:
        key.draw(sheet.place(figure, *box))
    return figure


def _lay_out(
    rows: Sequence[Row], aspect: float
) -> tuple[Figure, Axes, list[tuple[Key, sheet.Box]]]:
    """The page with the map's axes, and its keys with their places: left, bottom, sides [mm]."""
    # A long key stands beside the map; a short one, which would leave the page empty, below it.
    long = Key(rows, style.PAGE - _SIDE - 24.0).height > _SHORT * _SIDE * aspect
    page = sheet.page_width(style.PAGE if long else style.COLUMN)
    side = min(page - 18.0, _WIDEST) if page < sheet.BESIDE else _SIDE
    tall = side * aspect
    under: list[Key] = []
    beside: list[Key] = []
    if page < sheet.BESIDE:
        under = [Key(rows, page - 6.0)]
    else:
        beside = [Key(rows, page - side - 24.0)]
        curves, others = ([row for row in rows if bool(row.line) == so] for so in (True, False))
        if curves and beside[0].height > _LONG + tall:
            # Curves under the map: beside it their rows would leave half of the page empty.
            under, beside = [Key(curves, side + 16.0)], [Key(others, beside[0].width)]
    left = 15.0 + tall + sum(key.height for key in under)
    height = max([left, *(key.height + 6.0 for key in beside)])
    keys = [(key, (22.0 + side, 0.0, key.width, height)) for key in beside]
    keys += [(key, (4.0, height - left, key.width, key.height)) for key in under]
    figure = sheet.blank(page, height)
    return figure, sheet.place(figure, 16.0, height - 3.0 - tall, side, tall), keys


def _draw_designs(
    ax: Axes, designs: Mapping[str, sheet.Point], scale: sheet.Point, taken: Sequence[Bbox]
) -> list[Bbox]:
    """Dots and names of designs, clear of what is taken; the boxes that they take."""
    point, dots = sheet.root(ax).dpi / 72, []
    marks = [legends.Label(np.multiply(at, scale), literal(name)) for name, at in designs.items()]
    for mark in marks:
        ax.plot(*mark.at, "o", gid="design", **_DESIGN)
        spot = ax.transData.transform(mark.at)
        dots.append(Bbox([spot, spot]).padded(3.0 * point))
    names = legends.beside(ax, marks, keep_clear=[*taken, *dots])
    for text in names:
        text.set_bbox(style.on_white(0.12, 0.8))
    return dots + [text.get_window_extent().padded(_CLEAR * point) for text in names]


class _Curves(NamedTuple):
    """Boundaries across which the same changes."""

    number: str
    words: str
    line: tuple[str, LineStyleType]
    points: list[Floats]


def _axis(dataset: Dataset, name: str) -> _Axis:
    coordinate = dataset[name]
    values = coordinate.to_numpy().astype(float)
    unit, scale = display_unit(str(coordinate.attrs["units"]))
    # A bare number has no unit to be told.
    unit = f" [{Quantity('', unit).sign}]" if unit not in ("", "1") else ""
    cell, _, part = literal(str(coordinate.attrs["long_name"])).partition(".")
    what = _PARTS.get(part, part.replace("_", " ").capitalize())
    words = f"{what} of {cell}" if part else cell.replace("_", " ").capitalize()
    return _Axis(values * scale, scale, f"{words}{unit}", _is_geometric(values))


def _is_geometric(values: Floats) -> bool:
    """Whether values grow by one factor from each to the next, as those of np.geomspace."""
    if len(values) < 3 or values[0] <= 0:
        return False
    factors = values[1:] / values[:-1]
    return bool(np.ptp(factors) < 1e-6 * factors[0] and np.ptp(np.diff(values)) > 0)


def _aspect(dataset: Dataset, x: _Axis, y: _Axis) -> float:
    """Height over width: true to scale where both are lengths, else square."""
    if {dataset[name].attrs["units"] for name in "xy"} != {"m"}:
        return 1.0
    return float(np.clip(np.ptp(y.values) / max(np.ptp(x.values), 1e-12), 0.6, 1.5))


def _nodes(dataset: Dataset) -> list[tuple[str, Bools]]:
    """Every sequence, or lack of one, that occurs, and (ny, nx) at which nodes."""
    codes, notes = dataset["sequence"].to_numpy(), dataset["sequence"].attrs
    names = str(notes["flag_meanings"]).split()
    pairs = zip(names, np.atleast_1d(notes["flag_values"]).tolist(), strict=True)
    return [(name, inside) for name, value in pairs if np.any(inside := codes == value)]


def _regions(dataset: Dataset) -> list[_Region]:
    """Every sequence that occurs, by its pathway or a letter, as long as there are letters; then
    what has none, white and named by why.
    """
    nodes, letters = _nodes(dataset), iter(string.ascii_uppercase)
    present = [pair for pair in nodes if pair[0] not in _EMPTY]
    present.sort(key=lambda item: -int(np.sum(item[1])))
    labels = (_PATHWAYS[v].label if v in _PATHWAYS else next(letters, "") for v, _ in present)
    named = zip(labels, present, _shades(present), strict=True)
    blank = [_Region(_EMPTY[v][0], v, inside, "white") for v, inside in nodes if v in _EMPTY]
    return [_Region(label, *pair, shade) for label, pair, shade in named] + blank


def _shades(present: Sequence[tuple[str, Bools]]) -> list[ColorType]:
    """A pale colour for each region, no two neighbours with the same one if that can be."""
    from scipy import ndimage

    if all(name in style.PATHWAY for name, _ in present):
        return [style.pale(style.PATHWAY[name]) for name, _ in present]
    chosen: list[int] = []
    for i, (_, part) in enumerate(present):
        wide = np.asarray(ndimage.binary_dilation(part), bool)
        near = [chosen[j] for j in range(i) if np.any(wide & present[j][1])]
        counts = [(k in near, chosen.count(k), k) for k in range(len(_SHADES))]
        chosen.append(min(counts)[2])
    return [style.pale(_SHADES[k]) for k in chosen]


def _curves(boundaries: Iterable[Boundary]) -> list[_Curves]:
    """Boundaries by what changes across them; sequences on both sides are left to the regions."""
    found: dict[tuple[str, str], list[Floats]] = {}
    for boundary in boundaries:
        words = boundary.changes.partition(": ")[0]
        if boundary.kind.name == "BISTABLE":
            words = _EDGE
        found.setdefault((words, boundary.kind.name), []).append(np.asarray(boundary.points))
    # Limits of bistability come last, and need no number.
    return [
        _Curves("" if words == _EDGE else str(k), words, _LINES.get(kind, (style.INK, "-")), points)
        for k, ((words, kind), points) in enumerate(found.items(), 1)
    ]


def _rows(dataset: Dataset, regions: list[_Region], curves: list[_Curves]) -> list[Row]:
    """The key: sequences, what changes between them, what is missing."""
    known = [one for one in regions if one.sequence not in _EMPTY]
    rows = [
        Row(one.name, sequence_words(one.sequence, _ROOM), one.shade)
        if one.sequence not in _PATHWAYS
        else Row("", f"{one.name}: {one.sequence}", one.shade)
        for one in known
        if one.name
    ]
    if small := len(known) - len(rows):
        rows.append(Row("", f"{small} smaller regions"))
    rows += [Row(curve.number, curve.words, line=curve.line) for curve in curves]
    if np.any(dataset["monostable"]):
        rows.append(Row("", f"{dataset.attrs['moved_cell']} monostable", hatched=True))
    return rows + [Row("", _EMPTY[v.sequence][1]) for v in regions if v.sequence in _EMPTY]


def _places(axis: _Axis) -> Floats:
    """At equal steps on the page."""
    low, high = axis.values[[0, -1]]
    return (np.geomspace if axis.is_log else np.linspace)(low, high, PLACES)


def _draw_regions(
    ax: Axes,
    places: tuple[Floats, Floats],
    regions: Sequence[_Region],
    spread: Callable[[NDArray[np.intp]], NDArray[np.intp]],
) -> list[_Region]:
    """The regions with all places inside, not only nodes; what has no sequence stays white."""
    number = np.zeros(regions[0].inside.shape, int)
    for k, region in enumerate(regions):
        number[region.inside] = k
    found = spread(number)
    blank = np.isin(found, [k for k, region in enumerate(regions) if region.sequence in _EMPTY])
    ax.set_facecolor("white")
    shades = ListedColormap([region.shade for region in regions])
    look = {"vmin": -0.5, "vmax": len(regions) - 0.5, "shading": "nearest"}
    ax.pcolormesh(*places, np.ma.array(found, mask=blank), cmap=shades, rasterized=True, **look)
    return [region._replace(inside=found == k) for k, region in enumerate(regions)]


def _draw_curves(ax: Axes, curves: Sequence[_Curves], scale: sheet.Point) -> list[Bbox]:
    """The curves with their numbers; returns what the numbers cover."""
    point = sheet.root(ax).dpi / 72.0
    taken: list[Bbox] = []
    for curve in curves:
        colour, dashes = curve.line
        width, gid = (1.5, "boundary") if curve.number else (0.8, "stability edge")
        pieces = [points * scale for points in curve.points]
        for drawn in pieces:
            ax.plot(*drawn.T, color=colour, linestyle=dashes, linewidth=width, gid=gid)
        on_page = [ax.transData.transform(drawn) for drawn in pieces if curve.number]
        alongs = [np.cumsum(np.hypot(*np.diff(xy, axis=0, prepend=xy[:1]).T)) for xy in on_page]
        longest = sorted(zip(on_page, alongs, strict=True), key=lambda one: -one[1][-1])
        for k, (xy, along) in enumerate(longest):
            half = (3.5 + 2.0 * len(curve.number)) * point
            x, y, crowded = _clear(ax, xy, along, half, taken)
            # A short piece, or one without room, gets its number only where no other has it.
            if k == 0 or (along[-1] >= _NUMBERED * point and not crowded):
                text = badge(ax, x, y, curve.number, colour)
                taken.append(text.get_window_extent().padded(2.5 * point))
    return taken


def _clear(
    ax: Axes, on_page: Floats, along: Floats, half: float, taken: Sequence[Bbox]
) -> tuple[float, float, bool]:
    """Half-way along a curve, or as near to it as others leave room for its number of half this
    width [pixels], and whether it covers another there.
    """
    places = np.column_stack([np.interp(along[-1] * _ALONG, along, on_page[:, k]) for k in (0, 1)])
    boxes = [Bbox([place - half, place + half]) for place in places]
    crowd = [sum(box.overlaps(other) for other in taken) for box in boxes]
    best = int(np.argmin(crowd))
    x, y = ax.transData.inverted().transform(places[best])
    return float(x), float(y), crowd[best] > 0


def _free(ax: Axes, x: Floats, y: Floats, taken: Sequence[Bbox]) -> Bools:
    """(ny, nx) which nodes lie outside these boxes."""
    nodes = np.stack(np.meshgrid(x, y), axis=-1)
    at = ax.transData.transform(nodes.reshape(-1, 2)).reshape(nodes.shape)
    free = np.ones(nodes.shape[:2], bool)
    for box in taken:
        free &= ~np.all((at > box.min) & (at < box.max), axis=-1)
    return free
