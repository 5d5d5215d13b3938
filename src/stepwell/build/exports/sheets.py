"""Parts nested on sheets of a machine's bed, grouped by material and thickness."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from stepwell.base import InputError, Shows, Vec2, check, need, notify
from stepwell.build.contour import MM
from stepwell.build.exports import nester
from stepwell.build.exports.cutting import NO_KERF, Cutting, cutting, joined
from stepwell.build.exports.marks import Line, stroked
from stepwell.build.part import Part

# x and y [m], and the angle [rad] by which a part is turned before it is shifted.
Place = tuple[float, float, float]
# Edge of a sheet that is left free, gap between parts, length of the bar [m].
MARGIN, GAP, BAR = 0.005, 0.002, 0.100
# Distance of arcs from chords in nesting [m].
_SAGITTA = 5e-5


@dataclass(frozen=True, slots=True)
class CutSheet:
    """Parts on one sheet.

    Args:
        name: such as "acrylic-3mm-1"; file names contain it.
        bed: width and height of the sheet [m].
        parts: as drawn, each in its own frame.
        places: of each part on the sheet, its lower left corner is (0, 0).
    """

    name: str
    bed: Vec2
    parts: tuple[Part, ...]
    places: tuple[Place, ...]

    def cutting(self, kerf: Vec2 = NO_KERF) -> Cutting:
        """All paths of the sheet: marks, openings, outlines; guides are the edge and a bar.

        Args:
            kerf: width of the cut along x and y [m], as for `cutting.cutting`.
        """
        paths = [
            cutting(part, kerf, place, marked=True)
            for part, place in zip(self.parts, self.places, strict=True)
        ]
        return joined([*paths, Cutting(guides=tuple(self._guides()))])

    def _guides(self) -> list[Line]:
        """The edge of the sheet; below it a bar of 100 mm and its length as text."""
        width, height = self.bed
        edge = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0))
        y, tick = -0.008, 0.002
        bar = (
            ((0.0, y - tick), (0.0, y + tick)),
            ((0.0, y), (BAR, y)),
            ((BAR, y - tick), (BAR, y + tick)),
        )
        text = [
            tuple((x + BAR / 2, dy + y - 0.005) for x, dy in line)
            for line in stroked(f"{MM * BAR:.0f} MM", 0.004)
        ]
        return [edge, *bar, *text]

    def place(self, name: str) -> Place | None:
        """The place of the part of this name; None if it is on another sheet."""
        for part, place in zip(self.parts, self.places, strict=True):
            if part.name == name:
                return place
        return None


def sheets(
    parts: Iterable[Part],
    bed: Vec2,
    *,
    seconds: float = 10.0,
    seed: int = 0,
    progress: Shows | None = None,
) -> tuple[CutSheet, ...]:
    """Parts on as many sheets as they need; sheets of one material and thickness follow each other.

    Args:
        parts: with finished sizes.
        bed: width and height of the machine's bed [m].
        seconds: time limit of the nesting of each material, rounded up; 0 sets parts in rows
            instead, which is quick and the same every time. Nesting improves until its time ends,
            so two runs may differ.
        seed: of the nesting.
        progress: called with the time spent and the limit [s].

    Raises:
        ValueError: a part is larger than the bed; the text names the part and both sizes.
    """
    need("build")
    parts = list(parts)
    for part in parts:
        _require_room(part, bed)
    seconds = check.not_negative("seconds", seconds, "s")
    made: list[CutSheet] = []

    def kind(part: Part) -> tuple[str, float]:
        return part.material, part.thickness

    for (material, thickness), group in groupby(sorted(parts, key=kind), kind):
        left = list(group)
        number = 0
        while left:
            number += 1
            places = _nested(left, bed, (seconds, seed), progress) if seconds else None
            places = places or _in_rows(left, bed)
            fits = [_within(*one, bed) for one in zip(left, places, strict=True)]
            made.append(
                CutSheet(
                    f"{material}-{MM * thickness:g}mm-{number}",
                    bed,
                    tuple(part for part, fit in zip(left, fits, strict=True) if fit),
                    tuple(place for place, fit in zip(places, fits, strict=True) if fit),
                )
            )
            # The strip of the nester is cut at the end of the bed; the rest is nested again.
            left = [part for part, fit in zip(left, fits, strict=True) if not fit]
    return tuple(made)


def _require_room(part: Part, bed: Vec2) -> None:
    x0, y0, x1, y1 = part.outline.bounds
    room = sorted(side - 2.0 * MARGIN for side in bed)
    if any(have < want - 1e-9 for have, want in zip(room, sorted((x1 - x0, y1 - y0)), strict=True)):
        raise InputError(
            f"part {part.name} of {MM * (x1 - x0):.4g} x {MM * (y1 - y0):.4g} mm does not fit on "
            f"the bed of {MM * bed[0]:.4g} x {MM * bed[1]:.4g} mm with a margin of "
            f"{MM * MARGIN:.3g} mm: name a larger bed_mm, or design smaller parts."
        )


def _nested(
    parts: Sequence[Part], bed: Vec2, limit: tuple[float, int], progress: Shows | None
) -> list[Place] | None:
    """Places by the nester, on a strip that may be longer than the bed; None if it failed."""
    seconds, seed = limit
    # Rounding of the solver, in single precision, takes some micrometres of the gap.
    asked = {
        "height": MM * (bed[1] - 2.0 * MARGIN),
        "gap": MM * GAP,
        "seconds": math.ceil(seconds),
        "seed": seed,
        "shapes": [(MM * part.outline.ring(_SAGITTA)).tolist() for part in parts],
    }
    found = nester.places(asked, lambda spent: notify(progress, min(spent, seconds), seconds))
    notify(progress, seconds, seconds)
    if found is None:
        return None
    turned = [(x / MM, y / MM, math.radians(angle)) for x, y, angle in found]
    boxes = [part.outline.moved(*at).bounds for part, at in zip(parts, turned, strict=True)]
    left, low = min(box[0] for box in boxes), min(box[1] for box in boxes)
    places = [(x - left + MARGIN, y - low + MARGIN, angle) for x, y, angle in turned]
    return places if _apart(parts, places) else None


def _apart(parts: Sequence[Part], places: Sequence[Place]) -> bool:
    """Whether no two outlines come closer than half the gap."""
    import shapely

    areas = [
        shapely.Polygon(part.outline.moved(*at).ring(_SAGITTA))
        for part, at in zip(parts, places, strict=True)
    ]
    tree = shapely.STRtree(areas)
    one, two = tree.query(areas, predicate="dwithin", distance=GAP / 2.0)
    return all(i == j for i, j in zip(one, two, strict=True))


def _in_rows(parts: Sequence[Part], bed: Vec2) -> list[Place]:
    """Places in rows from the lower left corner, long parts turned along x, tall parts first.

    A part that has no room on this sheet is placed beyond its end.
    """
    turns = {}
    for i, part in enumerate(parts):
        x0, y0, x1, y1 = part.outline.bounds
        upright = y1 - y0 > x1 - x0
        fits = y1 - y0 <= bed[0] - 2.0 * MARGIN and x1 - x0 <= bed[1] - 2.0 * MARGIN
        tight = x1 - x0 > bed[0] - 2.0 * MARGIN or y1 - y0 > bed[1] - 2.0 * MARGIN
        turns[i] = math.pi / 2 if tight or (upright and fits) else 0.0
    boxes = {i: part.outline.moved(angle=turns[i]).bounds for i, part in enumerate(parts)}
    sizes = {i: (box[2] - box[0], box[3] - box[1]) for i, box in boxes.items()}
    places: dict[int, Place] = {}
    x = y = MARGIN
    tall = 0.0
    for i in sorted(sizes, key=lambda i: (-sizes[i][1], -sizes[i][0], i)):
        width, height = sizes[i]
        if x > MARGIN and x + width > bed[0] - MARGIN:
            x, y, tall = MARGIN, y + tall + GAP, 0.0
        if y + height > bed[1] - MARGIN + 1e-9:
            places[i] = (2.0 * bed[0], 0.0, turns[i])
            continue
        places[i] = (x - boxes[i][0], y - boxes[i][1], turns[i])
        x, tall = x + width + GAP, max(tall, height)
    return [places[i] for i in range(len(parts))]


def _within(part: Part, place: Place, bed: Vec2) -> bool:
    """Whether a part at its place is inside the sheet's margins."""
    x0, y0, x1, y1 = part.outline.moved(*place).bounds
    slack = 1e-6
    return (
        min(x0, y0) >= MARGIN - slack
        and x1 <= bed[0] - MARGIN + slack
        and y1 <= bed[1] - MARGIN + slack
    )
