"""Cells whose numbers lie within spans: their critical forces, and whether their force falls."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

from stepwell.design import CellTolerances
from stepwell.mechanism import Band, Cell, Element
from stepwell.proof import balls
from stepwell.proof.balls import Ball, ball, hull
from stepwell.proof.laws import EnclosedBand, EnclosedCell, EnclosedCurve
from stepwell.proof.slopes import LargestValue, Span, largest, parameters_in

# Standard deviations at which the normal distributions of `Tolerances` end.
_CUT = 4.0
# Anchors as doubles differ from exact ones by rounding: a part of the lever.
_ROUNDING = 1e-15
# Narrowest box of the lever's sine, and the largest number of boxes of the numbers.
_LEAST_SINE, _MOST_BOXES = 1 / 512, 512
# Narrowest box of a number, as a fraction of its span.
_LEAST_SHARE = 1e-3
_TURN = math.nextafter(2.0 * math.pi, 7.0)
ALL = -1


class CellPart(NamedTuple):
    """A number of a cell that lies within a span.

    Attributes:
        what: "radius" and "angle", or "x" and "y", of the displacement of q - p; factors
            "stiffness", "rest_length", "force_scale"; or values "lever" [m], "friction" [N].
        band: number of the band, or ALL.
        low, high: its ends.
    """

    what: str
    band: int
    low: float
    high: float


class CriticalForce(NamedTuple):
    """What is to be largest: `sign` times a critical force, friction included."""

    switch: int  # of the cell: the phase that it leaves upwards
    end: int  # 0 for the force up, F0 + f; 1 for that down, F1 - f
    sign: int


def parts_within(cell: Cell | Element, t: CellTolerances) -> tuple[CellPart, ...]:
    """All numbers of a cell that samples within tolerances may have."""
    parts = list[CellPart]()

    def factor(what: str, band: int, deviation: float) -> None:
        if deviation > 0:
            parts.append(CellPart(what, band, 1.0 - _CUT * deviation, 1.0 + _CUT * deviation))

    if isinstance(cell, Element):
        factor("force_scale", ALL, t.stiffness)
        factor("travel_scale", ALL, t.travel)
    else:
        for band in range(len(cell.bands)):
            if t.anchor > 0:
                parts += displacements(cell, 2.0 * t.anchor, band)
            factor("stiffness", band, t.stiffness)
            factor("rest_length", band, t.rest_length)
        if t.lever > 0:
            parts.append(CellPart("lever", ALL, cell.lever - t.lever, cell.lever + t.lever))
    if t.friction > 0:
        parts.append(CellPart("friction", ALL, cell.friction, cell.friction + t.friction))
    return tuple(parts)


def displacements(cell: Cell, radius: float, band: int = ALL) -> list[CellPart]:
    """Displacements of q - p within a radius [m], of one band or of all alike."""
    within = radius * (1.0 + _ROUNDING) + _ROUNDING * cell.lever
    return [CellPart("radius", band, 0.0, within), CellPart("angle", band, 0.0, _TURN)]


@dataclass(frozen=True, eq=False)
class CellBox:
    """A cell, and the numbers of it that lie within spans."""

    cell: Cell | Element
    parts: tuple[CellPart, ...] = ()

    @property
    def spans(self) -> list[Span]:
        """The ends of the parts, exact."""
        return [(ball(part.low), ball(part.high)) for part in self.parts]

    def varies(self, what: str) -> bool:
        """Whether there is a part of this kind."""
        return any(part.what == what for part in self.parts)

    def extreme(self, force: CriticalForce, enough: float) -> LargestValue:
        """The largest value of a critical force with a sign, to `enough` [N]."""
        return largest(lambda values: self._critical(force, values), self.spans, enough)

    def force_at(self, sine: tuple[Ball, Ball], sign: int, enough: float) -> LargestValue:
        """The largest of sign F - f of a lever cell at sin θ = a + b/r."""
        a, b = sine

        def value(values: Sequence[Ball]) -> Any:
            at = self._at(values)
            return self._force(at, b / at.lever + a) * sign - at.friction

        return largest(value, self.spans, enough)

    def peak(self, end: int, enough: float) -> LargestValue:
        """The largest F + f of a lever cell over its travel, for end 1 that of f - F."""
        assert isinstance(self.cell, Cell)

        def value(values: Sequence[Ball]) -> Any:
            *own, sine = parameters_in(values)
            at = self._numbers(own)
            return self._force(at, sine) * (-1 if end else 1) + at.friction

        return largest(value, [*self.spans, (-self._sine, self._sine)], enough)

    def machine(self, values: Sequence[float]) -> Cell | Element:
        """The cell with these values of its parts; further values do not count."""
        cell: Any = self.cell
        moves: dict[int, list[float]] = {}
        for part, value in zip(self.parts, values, strict=False):
            if part.what in ("radius", "angle", "x", "y"):
                moves.setdefault(part.band, []).append(value)
            elif part.what in ("stiffness", "rest_length"):
                cell = _with_bands(
                    cell, part.band, lambda band, w=part.what, v=value: {w: v * getattr(band, w)}
                )
            elif part.what in ("force_scale", "travel_scale"):
                cell = replace(cell, **{part.what: value * getattr(cell, part.what)})
            else:
                cell = replace(cell, **{part.what: value})
        polar = self.varies("radius")
        for band, (a, b) in moves.items():
            # Half of it at either anchor.
            x, y = (0.5 * a * math.cos(b), 0.5 * a * math.sin(b)) if polar else (0.5 * a, 0.5 * b)
            cell = _with_bands(
                cell,
                band,
                lambda one, x=x, y=y: {
                    "p": (one.p[0] - x, one.p[1] - y),
                    "q": (one.q[0] + x, one.q[1] + y),
                },
            )
        return cell

    def force(self, values: Sequence[Ball], sine: Ball) -> Any:
        """F of a lever cell at sin θ, with slopes by its parts where it has any."""
        return self._force(self._at(values), sine)

    # Its numbers as balls, with slopes by its parts.

    def _at(self, values: Sequence[Ball]) -> "_Numbers":
        return self._numbers(parameters_in(values))

    def _numbers(self, values: Sequence[Any]) -> "_Numbers":
        cell = self.cell
        if isinstance(cell, Element):
            at = _Numbers([], ball(0.0), ball(cell.friction), ball(1.0))
        else:
            bands: list[_BandNumbers] = []
            for band in cell.bands:
                x, y = band.d
                bands.append(_BandNumbers(ball(x), ball(y), ball(1.0), ball(band.rest_length)))
            at = _Numbers(bands, ball(cell.lever), ball(cell.friction), ball(1.0))
        radius: Any = None
        for part, value in zip(self.parts, values, strict=True):
            for band in at.bands if part.band == ALL else [at.bands[part.band]]:
                if part.what in ("x", "y"):
                    setattr(band, part.what, value + getattr(band, part.what))
                elif part.what == "angle":
                    band.x, band.y = radius * value.cos() + band.x, radius * value.sin() + band.y
                elif part.what == "stiffness":
                    band.stiffness = value
                elif part.what == "rest_length":
                    band.rest = value * band.rest
            if part.what == "radius":
                radius = value
            elif part.what == "lever":
                at.lever = value
            elif part.what == "friction":
                at.friction = value
            elif part.what == "force_scale":
                at.scale = value
        return at

    def _critical(self, force: CriticalForce, values: Sequence[Ball]) -> Any:
        at = self._at(values)
        if isinstance(self.cell, Element):
            own = at.scale * self._element_forces[force.switch][force.end]
        else:
            own = self._force(at, ball(self.cell.sin_limit) * (1 if force.end else -1))
        return (own - at.friction if force.end else own + at.friction) * force.sign

    def _force(self, at: "_Numbers", sine: Any) -> Any:
        """F of a lever cell at sin θ."""
        cos, total = (1 - sine * sine).sqrt(), ball(0.0)
        for band, curve in zip(at.bands, self._curves, strict=True):
            enclosed = EnclosedBand((band.x, band.y), band.rest, at.lever, curve)
            total = enclosed.force(sine, cos) * band.stiffness + total
        if self._load is not None:
            total = self._load.tension((sine + self._sine) * at.lever) + total
        return total

    @cached_property
    def _sine(self) -> Ball:
        assert isinstance(self.cell, Cell)
        return ball(self.cell.sin_limit)

    @cached_property
    def _curves(self) -> list[EnclosedCurve]:
        assert isinstance(self.cell, Cell)
        laws = [(band.law.pieces(), band.stiffness, not band.two_sided) for band in self.cell.bands]
        return [EnclosedCurve(*law) for law in laws]

    @cached_property
    def _load(self) -> EnclosedCurve | None:
        load = self.cell.load if isinstance(self.cell, Cell) else None
        return None if load is None else EnclosedCurve(load.pieces(), 1.0, False)

    @cached_property
    def _element_forces(self) -> list[tuple[Ball, Ball]]:
        return element_forces(self.cell)

    # Whether the force of a lever cell falls.

    def falls(self) -> bool:
        """Whether F of a lever cell is proved to fall over its whole travel, for all its numbers.

        An element's is proved for its own curve: factors do not change the sign of a slope.
        """
        if isinstance(self.cell, Element):
            return element_falls(self.cell)
        whole = self._rectangle()
        waiting, widths = [whole], [b - a for a, b in whole]
        for _ in range(_MOST_BOXES):
            if not waiting:
                return True
            box = waiting.pop()
            if self._is_outside(box) or self._falls_in(box):
                continue
            shares = [
                float((b - a) / w) if w > 0 else 0.0 for (a, b), w in zip(box, widths, strict=True)
            ]
            k = max(range(len(box)), key=shares.__getitem__)
            a, b = box[k]
            if not shares[k] > _LEAST_SHARE or self._rises_at([_middle(one) for one in box]):
                return False
            centre = balls.middle((a + b) / 2)
            waiting += [[*box[:k], half, *box[k + 1 :]] for half in ((a, centre), (centre, b))]
        return not waiting

    def _rectangle(self) -> list[Span]:
        """Ends of dx, dy, ℓ0 and of the factor of k of each band, then of r."""
        assert isinstance(self.cell, Cell)
        box: list[list[float]] = []
        for band in self.cell.bands:
            box += [[one, one] for one in (*band.d, band.rest_length, 1.0)]
        box.append([self.cell.lever] * 2)
        for part in self.parts:
            for b in range(len(self.cell.bands)) if part.band == ALL else [part.band]:
                if part.what == "radius":
                    for one in box[4 * b : 4 * b + 2]:
                        one[:] = one[0] - part.high, one[0] + part.high
                elif part.what in ("x", "y"):
                    one = box[4 * b + (part.what == "y")]
                    one[:] = one[0] + part.low, one[0] + part.high
                elif part.what in ("stiffness", "rest_length"):
                    one = box[4 * b + (2 if part.what == "rest_length" else 3)]
                    one[:] = one[0] * part.low, one[0] * part.high
            if part.what == "lever":
                box[-1][:] = part.low, part.high
        # Sums and products of doubles are off by rounding.
        return [(ball(a) - _off(a, b), ball(b) + _off(a, b)) for a, b in box]

    def _is_outside(self, box: list[Span]) -> bool:
        """Whether q - p of some band is outside its disc everywhere in a box."""
        assert isinstance(self.cell, Cell)
        for part in self.parts:
            if part.what != "radius":
                continue
            for b in range(len(self.cell.bands)) if part.band == ALL else [part.band]:
                x, y = (
                    hull(*box[4 * b + k]) - self.cell.bands[b].d[k] for k in range(2)
                )  # fmt: skip
                if x * x + y * y > ball(part.high) * part.high:
                    return True
        return False

    def _rises_at(self, point: list[Span]) -> bool:
        """Whether a place that may be in the box has no falling force."""
        return not (self._is_outside(point) or self._falls_in(point))

    def _falls_in(self, box: list[Span]) -> bool:
        assert isinstance(self.cell, Cell)
        numbers = [hull(a, b) for a, b in box]
        bands, lever = list[tuple[EnclosedBand, Any]](), numbers[-1]
        for b, curve in enumerate(self._curves):
            dx, dy, rest, factor = numbers[4 * b : 4 * b + 4]
            # A factor of all of the force does not change its sign.
            alone = len(self._curves) == 1 and self._load is None
            bands.append((EnclosedBand((dx, dy), rest, lever, curve), 1 if alone else factor))
        waiting = [(-self._sine, self._sine)]
        while waiting:
            a, b = waiting.pop()
            if self._falls_on(bands, lever, hull(a, b)):
                continue
            if not b - a > self._sine * _LEAST_SINE:
                return False
            centre = balls.middle((a + b) / 2)
            waiting += [(centre, b), (a, centre)]
        return True

    def _falls_on(self, bands: list[tuple[EnclosedBand, Any]], lever: Ball, sine: Ball) -> bool:
        cos, total = (1 - sine * sine).sqrt(), ball(0.0)
        for band, factor in bands:
            total = total + band.law(sine, cos, 0)[1] * factor
        if self._load is not None:
            total = total + self._load.at((sine + self._sine) * lever)[1]
        return bool(total < 0)


class _BandNumbers:
    """Numbers of a band in a box: q - p, a factor of k, and ℓ0."""

    __slots__ = ("rest", "stiffness", "x", "y")

    def __init__(self, x: Any, y: Any, stiffness: Any, rest: Any):
        self.x, self.y, self.stiffness, self.rest = x, y, stiffness, rest


@dataclass
class _Numbers:
    """Numbers of a cell in a box: balls, or balls with slopes."""

    bands: list[_BandNumbers]
    lever: Any
    friction: Any
    scale: Any


def _with_bands(cell: Cell, band: int, changed: Any) -> Cell:
    bands: list[Band] = [
        replace(one, **changed(one)) if band in (ALL, k) else one
        for k, one in enumerate(cell.bands)
    ]
    return replace(cell, band=bands)


def _middle(span: Span) -> Span:
    at = balls.middle((span[0] + span[1]) / 2)
    return at, at


def _off(a: float, b: float) -> float:
    return 4.0 * _ROUNDING * max(abs(a), abs(b)) if b > a else 0.0


# Elements of one sheet: their critical forces, by proved turns of their curves.


def element_forces(element: Any) -> list[tuple[Ball, Ball]]:
    """Forces up and down of each switch of an element of one sheet, friction left out.

    Raises:
        UndecidedError: a turn of its curve, or the number of its phases, is not proved.
    """
    cell = _enclosed(element)
    phases: list[tuple[Ball | None, Ball | None]] = []
    branches = cell.branches
    if branches[0].sign < 0:
        phases.append((None, branches[0].force_left))
    for k, branch in enumerate(branches):
        if branch.sign > 0:
            last = k + 1 == len(branches)
            phases.append((branch.force_left if k else None, None if last else branch.force_right))
    if branches[-1].sign < 0:
        phases.append((branches[-1].force_right, None))
    known = all(branch.sign for branch in branches) and len(phases) == len(element.phases)
    switches = [(up, down) for (_, up), (down, _) in pairwise(phases)]
    if not known or any(up is None or down is None for up, down in switches):
        raise balls.UndecidedError("the phases of an element are not proved")
    return switches  # type: ignore[return-value]


def element_falls(element: Element) -> bool:
    """Whether the force of an element is proved to fall over its whole travel between stops."""
    branches = _enclosed(element).branches
    return len(branches) == 1 and branches[0].sign < 0 and element.stopped == (True, True)


def _enclosed(element: Element) -> EnclosedCell:
    from stepwell.mechanism import Chain
    from stepwell.statics import problem_of

    return EnclosedCell(problem_of(Chain([element])), 0)
