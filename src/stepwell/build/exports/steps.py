"""Steps of an assembly in the order of the layers, from below, and their instructions."""

from collections.abc import Iterable
from typing import NamedTuple

from stepwell.base import counted, grouped
from stepwell.build.contour import MM
from stepwell.build.layouts import BandPath, Layout
from stepwell.build.part import Part
from stepwell.build.plates import Fastener
from stepwell.build.robots.making import Bought
from stepwell.build.robots.robot_layout import RobotBand

Item = Part | Fastener | BandPath | RobotBand | Bought

# Order of items whose lower faces have one height.
_RANKS = {"shim": 0, "block": 1, "lever": 2, "bar": 3, "pin": 4, "screw": 5, "hook": 6, "nut": 7}
# Instructions by kind; {what} are the new items.
_TEXTS = {
    "block": "Put in place, marks up: {what}.",
    "lever": "Put on the pins, marks up: {what}. Each lever must turn without force.",
    "bar": "Lay in place, the slot over the drive pin: {what}.",
    "pin": "Press into the holes from above, flush with the lower face: {what}.",
    "screw": "Put through the holes from below: {what}. The plates stand on the heads.",
    "shim": "Put on the pins and screws: {what}.",
    "hook": "Press into the named holes of the top plates: {what}.",
    "nut": "Turn on the screws until the plates do not move, no tighter: {what}.",
    "band": "Hook over two hooks each: {what}.",
    "cap": "Push on the hooks, above the bands: {what}.",
}
_TITLES = {
    "lever": "Levers",
    "bar": "Drive bar",
    "pin": "Pins",
    "screw": "Screws",
    "shim": "Shims",
    "hook": "Hooks",
    "nut": "Nuts",
    "band": "Bands",
    "cap": "Caps",
}
# Plates by a word of their names.
_PLATES = {
    "stop": "stop plates",
    "foot": "feet",
    "bottom": "bottom plates",
    "spacer": "spacers",
    "top": "top plates",
}


class AssemblyStep(NamedTuple):
    """One step of the assembly.

    Attributes:
        title: such as "Levers".
        kind: "block", "lever", "bar", "band", or the use of its fasteners.
        text: the instruction.
        details: sizes and places of the new items, a line each.
        new: what is added.
        hidden: what comes along and is drawn with it, such as the heads of screws.
    """

    title: str
    kind: str
    text: str
    details: tuple[str, ...]
    new: tuple[Item, ...]
    hidden: tuple[Item, ...] = ()


def steps_of(layout: Layout) -> list[AssemblyStep]:
    """All steps: of each layer shims, plates and levers, then what stands in its holes."""
    items: list[tuple[float, int, str, Item]] = []
    for part in layout.parts:
        kind = str(layout.body[part.name][0])
        items.append((round(part.base, 6), _RANKS[kind], kind, part))
    heads = [one for one in layout.fasteners if one.use == "head"]
    for one in layout.fasteners:
        if one.use != "head":
            items.append((round(one.low, 6), _RANKS.get(one.use, 8), one.use, one))
    for band in layout.bands:
        items.append((round(band.low, 6), 8, "band", band))
    made = []
    for key, rows in grouped((row[:3], row[3]) for row in sorted(items, key=_order)).items():
        kind = key[2]
        made.append(_step(layout, kind, tuple(rows), tuple(heads) if kind == "screw" else ()))
    return made


def _order(row: tuple[float, int, str, Item]) -> tuple[float, int, str]:
    return row[:3]


def _step(
    layout: Layout, kind: str, new: tuple[Item, ...], hidden: tuple[Item, ...]
) -> AssemblyStep:
    parts = [one for one in new if isinstance(one, Part)]
    fasteners = [one for one in new if isinstance(one, Fastener)]
    bands = [one for one in new if isinstance(one, BandPath)]
    details: list[str] = []
    if parts:
        what = _listed([f"{one.name} ({one.mark})" if one.mark else one.name for one in parts])
        title = _TITLES.get(kind, _plates(parts))
    elif fasteners:
        what = counted(len(fasteners), kind)
        title = _TITLES.get(kind, kind.capitalize())
        details = [*_fastener_lines(fasteners)]
    else:
        what, title = counted(len(bands), "band"), _TITLES["band"]
        details = [*_band_lines(layout, bands)]
    text = _TEXTS.get(kind, "Add: {what}.").format(what=what)
    return AssemblyStep(title, kind, text, tuple(details), new, hidden)


def _plates(parts: Iterable[Part]) -> str:
    """Title of a step with plates, such as "Spacer plates"."""
    words = {word for one in parts for word in one.name.split("-")}
    plates = _listed([text for word, text in _PLATES.items() if word in words] or ["parts"])
    return plates[0].upper() + plates[1:]


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _fastener_lines(fasteners: Iterable[Fastener]) -> Iterable[str]:
    """A line for each size: how many, and the holes by block."""
    for size, same in grouped((one.size, one) for one in fasteners).items():
        blocks = grouped((one.block, one.name) for one in same)
        where = "; ".join(
            f"block {block}: {', '.join(dict.fromkeys(names))}" for block, names in blocks.items()
        )
        yield f"{len(same)} x {size} ({where})"


def _band_lines(layout: Layout, bands: Iterable[BandPath]) -> Iterable[str]:
    """A line for each band: cell, free length and hooks."""
    for one in bands:
        rest = layout.cells[one.cell].cell.bands[one.number].rest_length
        yield (
            f"Band {one.number + 1} of cell {one.cell + 1}: {MM * rest:.4g} mm long when slack, "
            f"from {one.holes[0]} of block {one.cell} to {one.holes[1]} of block {one.cell + 1}"
        )
