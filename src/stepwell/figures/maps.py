"""Design maps: the sequence of a chain over two of its parameters."""

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


# Usual and largest width of a map [mm]; the legend is below the map if it is no higher than this
# fraction of the map, else at its right.
_SIDE, _WIDEST, _SHORT = 70.0, 110.0, 0.7
# Excess height over the map from which a legend at its right is split [mm].
_LONG = 30.0
# Largest number of characters in a legend row.
_ROOM = 50
# Pieces of a curve longer than this have their own number [pt], at one of these fractions.
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
# Colour and line by kind of boundary; loading and unloading have their usual colours.
_LINES: dict[str, tuple[str, LineStyleType]] = {
    "LOADING_ORDER": (style.LOADING, "-"),
    "UNLOADING_ORDER": (style.UNLOADING, (0, (3.2, 1.6))),
    "BISTABLE": (style.INK, (0, (3, 1.5))),
}
_EDGE = "limit of bistability"
# Regions without a sequence: their names on the map and in the legend.
_EMPTY = {
    "impossible": ("no mechanism", "no mechanism: the band's ends coincide"),
    "unsolved": ("no result", "no result"),
}

_PATHWAYS = {pathway.value: pathway for pathway in Pathway}
_DESIGN: dict[str, Any] = {"markersize": 4.6, "color": style.BLACK, "zorder": 8, "clip_on": False}
_DESIGN |= {"markeredgecolor": "white", "markeredgewidth": 0.7}


class _Axis(NamedTuple):
    """Values in drawn units, and the axis label."""

    values: Floats
    scale: float
    name: str
    is_log: bool

    def share(self, values: Floats) -> Floats:
        """Positions of values as fractions of the axis."""
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
    """Map of the sequences over two parameters, with boundaries as curves and a legend.

    One column wide, or two with a long legend; lengths in mm, angles in degrees. Each region has a
    letter, or the name of one of the four pathways of two cells; each curve has a number. Curves
    across which only the loading order changes are blue; only the unloading order: vermillion and
    dashed; all others black. Hatched regions, up to a thin dashed line, have a monostable cell
    among those with a varied parameter.

    Args:
        dataset: result of `design.transition_map` or `design.parameter_map`, in memory or read from
            a file.
        boundaries: result of `design.boundaries` or `design.parameter_boundaries` for the same
            parameters.
        designs: the two parameters [SI] of each design to mark, by name.

    Source: Kamp et al. 2024, Fig. 2C.
    """
    x, y = _axis(dataset, "x"), _axis(dataset, "y")
    regions = _regions(dataset)
    curves = _curves(boundaries)
    scale = x.scale, y.scale
    figure, ax, keys = _lay_out(_rows(dataset, regions, curves), _aspect(dataset, x, y))
    at = (points * scale for one in curves for points in one.points)
    walls = [np.column_stack([x.share(points[:, 0]), y.share(points[:, 1])]) for points in at]
    # Extends values at the nodes up to the boundaries.
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
    # Designs first: their names must be near their dots; names of regions can be anywhere.
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
    """The page with the map's axes, and its legends with their boxes [mm]."""
    # A long legend is at the right of the map; a short one, which would leave a gap, below it.
    long = Key(rows, style.PAGE - _SIDE - 24.0).height > _SHORT * _SIDE * aspect
    page = sheet.page_width(style.PAGE if long else style.COLUMN)
    side = min(page - 18.0, _WIDEST) if page < sheet.SIDE_BY_SIDE else _SIDE
    tall = side * aspect
    under: list[Key] = []
    at_right: list[Key] = []
    if page < sheet.SIDE_BY_SIDE:
        under = [Key(rows, page - 6.0)]
    else:
        at_right = [Key(rows, page - side - 24.0)]
        curves, others = ([row for row in rows if bool(row.line) == so] for so in (True, False))
        if curves and at_right[0].height > _LONG + tall:
            # Curves under the map: at its right their rows would leave half of the page empty.
            under, at_right = [Key(curves, side + 16.0)], [Key(others, at_right[0].width)]
    left = 15.0 + tall + sum(key.height for key in under)
    height = max([left, *(key.height + 6.0 for key in at_right)])
    keys = [(key, (22.0 + side, 0.0, key.width, height)) for key in at_right]
    keys += [(key, (4.0, height - left, key.width, key.height)) for key in under]
    figure = sheet.blank(page, height)
    return figure, sheet.place(figure, 16.0, height - 3.0 - tall, side, tall), keys


def _draw_designs(
    ax: Axes, designs: Mapping[str, sheet.Point], scale: sheet.Point, taken: Sequence[Bbox]
) -> list[Bbox]:
    """Draw dots and names of designs, clear of `taken`; returns the boxes of both."""
    point, dots = sheet.root(ax).dpi / 72, []
    marks = [legends.Label(np.multiply(at, scale), literal(name)) for name, at in designs.items()]
    for mark in marks:
        ax.plot(*mark.at, "o", gid="design", **_DESIGN)
        spot = ax.transData.transform(mark.at)
        dots.append(Bbox([spot, spot]).padded(3.0 * point))
    names = legends.place_labels(ax, marks, keep_clear=[*taken, *dots])
    for text in names:
        text.set_bbox(style.on_white(0.12, 0.8))
    return dots + [text.get_window_extent().padded(_CLEAR * point) for text in names]


class _Curves(NamedTuple):
    """Boundaries with the same change of the sequence."""

    number: str
    words: str
    line: tuple[str, LineStyleType]
    points: list[Floats]


def _axis(dataset: Dataset, name: str) -> _Axis:
    coordinate = dataset[name]
    values = coordinate.to_numpy().astype(float)
    unit, scale = display_unit(str(coordinate.attrs["units"]))
    # A dimensionless number has no unit.
    unit = f" [{Quantity('', unit).sign}]" if unit not in ("", "1") else ""
    cell, _, part = literal(str(coordinate.attrs["long_name"])).partition(".")
    what = _PARTS.get(part, part.replace("_", " ").capitalize())
    words = f"{what} of {cell}" if part else cell.replace("_", " ").capitalize()
    return _Axis(values * scale, scale, f"{words}{unit}", _is_geometric(values))


def _is_geometric(values: Floats) -> bool:
    """Whether values are a geometric sequence, as from np.geomspace."""
    if len(values) < 3 or values[0] <= 0:
        return False
    factors = values[1:] / values[:-1]
    return bool(np.ptp(factors) < 1e-6 * factors[0] and np.ptp(np.diff(values)) > 0)


def _aspect(dataset: Dataset, x: _Axis, y: _Axis) -> float:
    """Height over width: to scale if both are lengths, else square."""
    if {dataset[name].attrs["units"] for name in "xy"} != {"m"}:
        return 1.0
    return float(np.clip(np.ptp(y.values) / max(np.ptp(x.values), 1e-12), 0.6, 1.5))


def _nodes(dataset: Dataset) -> list[tuple[str, Bools]]:
    """Every sequence, or reason for a missing one, and its nodes as booleans (ny, nx)."""
    codes, notes = dataset["sequence"].to_numpy(), dataset["sequence"].attrs
    names = str(notes["flag_meanings"]).split()
    pairs = zip(names, np.atleast_1d(notes["flag_values"]).tolist(), strict=True)
    return [(name, inside) for name, value in pairs if np.any(inside := codes == value)]


def _regions(dataset: Dataset) -> list[_Region]:
    """Regions by sequence, named by pathway or letter, followed by white regions without a
    sequence, named by the reason. After Z, regions have no letter.
    """
    nodes, letters = _nodes(dataset), iter(string.ascii_uppercase)
    present = [pair for pair in nodes if pair[0] not in _EMPTY]
    present.sort(key=lambda item: -int(np.sum(item[1])))
    labels = (_PATHWAYS[v].label if v in _PATHWAYS else next(letters, "") for v, _ in present)
    named = zip(labels, present, _shades(present), strict=True)
    blank = [_Region(_EMPTY[v][0], v, inside, "white") for v, inside in nodes if v in _EMPTY]
    return [_Region(label, *pair, shade) for label, pair, shade in named] + blank


def _shades(present: Sequence[tuple[str, Bools]]) -> list[ColorType]:
    """A pale colour for each region, different between neighbours if possible."""
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
    """Boundaries grouped by the change of the sequence across them."""
    groups: dict[tuple[str, str], list[Floats]] = {}
    for boundary in boundaries:
        words = boundary.changes.partition(": ")[0]
        if boundary.kind.name == "BISTABLE":
            words = _EDGE
        groups.setdefault((words, boundary.kind.name), []).append(np.asarray(boundary.points))
    # Limits of bistability have no number.
    return [
        _Curves("" if words == _EDGE else str(k), words, _LINES.get(kind, (style.INK, "-")), points)
        for k, ((words, kind), points) in enumerate(groups.items(), 1)
    ]


def _rows(dataset: Dataset, regions: list[_Region], curves: list[_Curves]) -> list[Row]:
    """Legend rows: sequences, boundaries, monostable and empty regions."""
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
    """Points at equal steps on the page."""
    low, high = axis.values[[0, -1]]
    return (np.geomspace if axis.is_log else np.linspace)(low, high, PLACES)


def _draw_regions(
    ax: Axes,
    places: tuple[Floats, Floats],
    regions: Sequence[_Region],
    spread: Callable[[NDArray[np.intp]], NDArray[np.intp]],
) -> list[_Region]:
    """Draw the regions and return them with all points inside, not only nodes. Regions without a
    sequence stay white.
    """
    number = np.zeros(regions[0].inside.shape, int)
    for k, region in enumerate(regions):
        number[region.inside] = k
    region_at = spread(number)
    blank = np.isin(region_at, [k for k, region in enumerate(regions) if region.sequence in _EMPTY])
    ax.set_facecolor("white")
    shades = ListedColormap([region.shade for region in regions])
    look = {"vmin": -0.5, "vmax": len(regions) - 0.5, "shading": "nearest"}
    ax.pcolormesh(*places, np.ma.array(region_at, mask=blank), cmap=shades, rasterized=True, **look)
    return [region._replace(inside=region_at == k) for k, region in enumerate(regions)]


def _draw_curves(ax: Axes, curves: Sequence[_Curves], scale: sheet.Point) -> list[Bbox]:
    """Draw the curves with their numbers and return the boxes of the numbers."""
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
            # A short or crowded piece gets its number only if no other piece has it.
            if k == 0 or (along[-1] >= _NUMBERED * point and not crowded):
                text = badge(ax, x, y, curve.number, colour)
                taken.append(text.get_window_extent().padded(2.5 * point))
    return taken


def _clear(
    ax: Axes, on_page: Floats, along: Floats, half: float, taken: Sequence[Bbox]
) -> tuple[float, float, bool]:
    """Position of a curve's number, as near to its middle as others allow, and whether it overlaps.
    `half` is half the width of the number [pixels].
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
