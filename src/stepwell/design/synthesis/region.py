"""Regions for the anchors of a band, and the available bands."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stepwell.base import Bools, ByValue, Floats, InputError, Vec2, check, to_unit
from stepwell.design.plane import Box
from stepwell.mechanism import Band, Law, Linear

_HOOKE = Linear()


@dataclass(frozen=True, slots=True, eq=False)
class BandType(ByValue):
    """A kind of band from a catalogue; ValueError for a value out of its range.

    Args:
        stiffness: k [N/m], > 0.
        rest_length: ℓ0 [m], >= 0.
        spread: standard deviation of k over its mean [1]; None for that of the tolerances.
        name: name in the catalogue.
        law: tension is `stiffness` times this shape of the extension, such as a measured Table.
        pack: number of such bands that are available, >= 1; None for as many as needed.

    Source: the defaults are the paper's band, Kamp et al. 2024.
    """

    stiffness: float = 28.5
    rest_length: float = 0.010
    spread: float | None = None
    name: str = ""
    law: Law = _HOOKE
    pack: int | None = None

    @classmethod
    def of(cls, band: Band, spread: float | None = None, name: str = "") -> "BandType":
        """The type of an existing band, measured or of another design, without its anchors."""
        return cls(band.stiffness, band.rest_length, spread, name, band.law)

    def between(self, p: Vec2, q: Vec2, count: int = 1) -> Band:
        """`count` equal bands of this type between two anchors [m], as one."""
        return Band(p, q, count * self.stiffness, self.rest_length, self.law)

    def __post_init__(self):
        if not 0 < self.stiffness < math.inf:
            raise InputError(f"stiffness = {self.stiffness} N/m: must be > 0 and finite.")
        if not 0 <= self.rest_length < math.inf:
            raise InputError(f"rest_length = {self.rest_length} m: must be >= 0 and finite.")
        if self.spread is not None and not 0 <= self.spread < 0.25:
            raise InputError(
                f"spread = {self.spread}: must be at least 0 and below 0.25; it is a fraction, so "
                f"5 % is 0.05."
            )
        if self.pack is not None:
            check.whole("pack", self.pack, 1)

    def __repr__(self):
        name = f"{self.name!r}, " if self.name else ""
        spread = "" if self.spread is None else f", ±{self.spread * 100:.3g} %"
        law = "" if isinstance(self.law, Linear) else f", {type(self.law).__name__}"
        pack = "" if self.pack is None else f", pack of {self.pack}"
        return (
            f"BandType({name}k={self.stiffness:.4g} N/m, "
            f"ℓ0={to_unit(self.rest_length, 'mm'):.4g} mm{spread}{law}{pack})"
        )


PAPER_BAND = BandType()


# Half a micrometre: a hole this far outside is on the edge, displaced by rounding.
_EDGE = 0.5e-6
_MOST_PLACES = 1_000_000


@dataclass(frozen=True, eq=False)
class AnchorBox(Box):
    """A rectangle for the anchor q on a cell's outer block [m].

    Args:
        left, right: least and largest x [m], finite and in this order, or ValueError.
        bottom, top: least and largest y [m].
    """

    def __post_init__(self):
        for lo, hi in ("left", "right"), ("bottom", "top"):
            a, b = getattr(self, lo), getattr(self, hi)
            if not (math.isfinite(a) and math.isfinite(b) and a < b):
                raise InputError(f"{lo} = {a} m, {hi} = {b} m: must be finite, and {lo} < {hi}.")

    @property
    def bounds(self) -> Box:
        """The rectangle itself."""
        return self

    def clamped(self, q: Floats) -> Floats:
        """The nearest allowed places to (m, 2) places."""
        return np.clip(q, (self.left, self.bottom), (self.right, self.top))

    def __repr__(self):
        return (
            f"AnchorBox(x {to_unit(self.left, 'mm'):.4g}..{to_unit(self.right, 'mm'):.4g}, "
            f"y {to_unit(self.bottom, 'mm'):.4g}..{to_unit(self.top, 'mm'):.4g} mm)"
        )


@dataclass(frozen=True, eq=False)
class AnchorPolygon(ByValue):
    """A polygon for the anchor q on a cell's outer block.

    Args:
        corners: (m, 2) in order around it [m]; the last is joined to the first. If it crosses
            itself, areas enclosed twice are outside. ValueError for fewer than three, or a line.
    """

    corners: Sequence[tuple[float, float]]

    def __post_init__(self):
        try:
            corners = tuple((float(x), float(y)) for x, y in self.corners)
        except (TypeError, ValueError):
            raise InputError(
                f"corners = {self.corners!r}: must be pairs of numbers (x, y) [m]."
            ) from None
        if len(corners) < 3 or not np.all(np.isfinite(corners)):
            raise InputError(f"corners = {corners}: must be three or more, all finite [m].")
        out = np.array(corners) - corners[0]
        if np.linalg.matrix_rank(out, 1e-9) < 2:
            raise InputError(f"corners = {corners} m: lie on a line; must enclose an area.")
        if any(a == b for a, b in zip(corners, corners[1:] + corners[:1], strict=True)):
            raise InputError(
                f"corners = {corners} m: neighbours must differ: leave out the repeated one."
            )
        object.__setattr__(self, "corners", corners)

    @property
    def bounds(self) -> Box:
        """The smallest rectangle around it."""
        (left, bottom), (right, top) = np.min(self.corners, 0), np.max(self.corners, 0)
        return Box(float(left), float(right), float(bottom), float(top))

    def holds(self, q: Floats) -> Bools:
        """Which of the (m, 2) places lie inside."""
        x, y = q[:, 0, None], q[:, 1, None]
        (x0, y0), (x1, y1) = (end.T for end in self._sides())
        crosses = (y0 > y) != (y1 > y)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            right = x < x0 + (y - y0) * (x1 - x0) / (y1 - y0)
        return np.sum(crosses & right, axis=1) % 2 == 1

    def clamped(self, q: Floats) -> Floats:
        """The nearest allowed places to (m, 2) places."""
        a, b = self._sides()
        along = b - a
        # Sides so short that their square is zero count as their first corner.
        length = np.sum(along * along, axis=-1)
        reach = np.sum((q[:, None] - a) * along, axis=-1) / np.where(length > 0, length, np.inf)
        foot = a + np.clip(reach, 0.0, 1.0)[..., None] * along
        near = np.argmin(np.sum((foot - q[:, None]) ** 2, axis=-1), axis=1)
        return np.where(self.holds(q)[:, None], q, foot[np.arange(len(q)), near])

    def _sides(self) -> tuple[Floats, Floats]:
        first = np.array(self.corners)
        return first, np.roll(first, -1, axis=0)

    def __repr__(self):
        corners = ", ".join(
            f"({to_unit(x, 'mm'):.4g}, {to_unit(y, 'mm'):.4g})" for x, y in self.corners
        )
        return f"AnchorPolygon({corners} mm)"


Region = AnchorBox | AnchorPolygon

PAPER_BOX = AnchorBox(0.0, 0.020, -0.015, 0.015)
"""Where Kamp et al. (2024, Fig. 2C) moved the outer anchor of the outer cell."""
PAPER_LEVER = 0.010 * math.sqrt(2.0)


@dataclass(frozen=True, slots=True)
class HoleGrid:
    """A square grid of drilled holes in the frame of a block; ValueError unless it is finite.

    Args:
        pitch: distance of the holes [m], > 0.
        origin: a point (x, y) of the grid [m]; by default the middle of the lever joints.
    """

    pitch: float
    origin: Vec2 = (0.0, 0.0)

    def __post_init__(self):
        if not 0 < self.pitch < math.inf:
            raise InputError(f"pitch = {self.pitch} m: must be > 0 and finite.")
        if len(self.origin) != 2 or not all(map(math.isfinite, self.origin)):
            raise InputError(f"origin = {self.origin!r}: must be two finite numbers (x, y) [m].")

    @property
    def mirrored(self) -> bool:
        """Whether -q is a hole for every hole q."""
        return fits_grid((-self.origin[0], -self.origin[1]), self)

    @property
    def shifted(self) -> str:
        """The origin in words; "" for the middle of the joints."""
        return f"through {shown_mm(self.origin)} mm" if any(self.origin) else ""


def shown_mm(place: Vec2) -> str:
    """A place [m] as "(x, y)" in millimetres."""
    x, y = (to_unit(one, "mm") + 0.0 for one in place)
    return f"({x:.4g}, {y:.4g})"


def usual_box(lever: float, free: str = "q") -> AnchorBox:
    """The paper's box scaled with the lever [m]; for p its mirror image."""
    ratio, box = lever / PAPER_LEVER, PAPER_BOX
    sides = [ratio * side for side in (box.left, box.right, box.bottom, box.top)]
    if free == "p":
        sides = [0.0 - sides[k] for k in (1, 0, 3, 2)]
    return AnchorBox(*sides)


_FREE = {"q": "anchors q", "p": "anchors p", "both": "anchors q, and p = -q,"}


def allowed_text(regions: Sequence[Region], holes: HoleGrid | None, free: str = "q") -> str:
    """Text for the allowed anchors, with units."""
    places: list[str] = []
    for region in regions:
        box = region.bounds
        kind = "" if isinstance(region, AnchorBox) else f"a polygon of {len(region.corners)} in "
        places.append(
            f"{kind}x {to_unit(box.left, 'mm'):.4g} to {to_unit(box.right, 'mm'):.4g} mm, "
            f"y {to_unit(box.bottom, 'mm'):.4g} to {to_unit(box.top, 'mm'):.4g} mm"
        )
    drilled = "anywhere"
    if holes is not None:
        through = f" {holes.shifted}," * bool(holes.shifted)
        drilled = f"in holes {to_unit(holes.pitch, 'mm'):.4g} mm apart{through}"
    return f"{_FREE[free]} {drilled} at {' or '.join(dict.fromkeys(places))}"


def pooled(bands: Iterable[BandType]) -> list[BandType]:
    """The different types of band, each with the bands of all its packs together."""
    packs: dict[BandType, int | None] = {}
    for band in bands:
        kind = replace(band, pack=None)
        held = packs.get(kind, 0)
        packs[kind] = None if held is None or band.pack is None else held + band.pack
    return [replace(kind, pack=pack) for kind, pack in packs.items()]


def packs_text(bands: Sequence[BandType]) -> str:
    """Text for the packs of bands, with units; "" without a limit."""
    shown = [
        f"{one.pack} of {one.name or f'{one.stiffness:.4g} N/m'}"
        for one in bands
        if one.pack is not None
    ]
    return f" and packs of bands ({', '.join(shown)})" if shown else ""


def lattice(region: Region, pitch: float) -> Floats:
    """(m, 2) places [m] inside the region, `pitch` [m] apart both ways, from its lower left on."""
    box = region.bounds
    return _grid(region, pitch, (box.left, box.bottom))


def drilled(region: Region, grid: HoleGrid) -> Floats:
    """(m, 2) holes [m] of the grid inside the region.

    One less than half a micrometre outside is on the edge, and moved onto it.
    """
    return region.clamped(_grid(region, grid.pitch, grid.origin))


def fits_grid(place: Vec2, grid: HoleGrid) -> bool:
    """Whether a place [m] is a hole of the grid."""
    off = [x - at for x, at in zip(place, grid.origin, strict=True)]
    return all(abs(x - grid.pitch * round(x / grid.pitch)) <= _EDGE for x in off)


def _grid(region: Region, pitch: float, through: Vec2) -> Floats:
    box = region.bounds
    sides = (box.left, box.right), (box.bottom, box.top)
    ends = [
        (math.ceil((low - at - _EDGE) / pitch), math.floor((high - at + _EDGE) / pitch))
        for (low, high), at in zip(sides, through, strict=True)
    ]
    nx, ny = (max(last - first + 1, 0) for first, last in ends)
    if nx * ny > _MOST_PLACES:
        raise InputError(
            f"pitch = {to_unit(pitch, 'mm'):.4g} mm makes {nx} x {ny} places: must make at most "
            f"{_MOST_PLACES:,}."
        )
    x, y = (
        at + pitch * np.arange(first, last + 1)
        for (first, last), at in zip(ends, through, strict=True)
    )
    # Picometres are rounding: a hole at 10 mm is written as 10 mm.
    places = np.asarray(np.stack(np.meshgrid(x, y), axis=-1), float).round(12).reshape(-1, 2)
    near = region.clamped(places)
    return near[np.hypot(*(places - near).T) <= _EDGE]
