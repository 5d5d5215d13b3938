"""An element: a cell that is a force law over its own travel."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Drawn, Floats, InputError, Ints, Measure, check, display_unit
from stepwell.mechanism import cubics, element_curves, smoothing
from stepwell.mechanism.phase import Phase, Sheet, Stretch, a_mobility

if TYPE_CHECKING:
    from stepwell.lab import Recording
    from stepwell.mechanism.chain import Chain


Stops = bool | tuple[bool, bool]

_BLANK = np.zeros((1, cubics.COLUMNS))
# Phases that one digit of a state can number.
_MOST_PHASES = 10
# An open end continues straight; its slope is at least this fraction of the mean stiffness.
_LEAST_RISE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Element(ByValue, Drawn):
    """Bistable element: a cell that is defined by its force-travel curve.

    Create one with a method `from_...`, or use one of `stepwell.elements`. A chain takes elements
    and cells in any order.

    Args:
        sheets: the stable stretches of its curve; one unless the curve folds back in travel.
        stops: whether it is stopped at the low and at the high end of its curve; without a stop
            the curve continues straight.
        friction: Coulomb friction against travel [N], >= 0.
        name: name of the element in messages and figures.
        measure: kind of travel and force; all units below are those of travel and force.
        force_scale, travel_scale: factors of all forces and of all travels of the curve.
        error_band: largest error of the curve [N], estimated from the scatter of measured points;
            0 if it passes through them.
        mobility: speed per force relative to the other cells (inverse drag), > 0.

    Raises:
        ValueError: no curve, a number out of range, an open end on which the force does not rise,
            or a force with more turning points than states have digits.
    """

    sheets: tuple[Sheet, ...]
    stops: Stops = False
    friction: float = 0.0
    name: str = ""
    measure: Measure = Measure.TRAVEL
    force_scale: float = 1.0
    travel_scale: float = 1.0
    error_band: float = 0.0
    mobility: float = field(default=1.0, kw_only=True)
    unusual: ClassVar[bool] = False
    """Always False: an element has no lever to compare numbers with; see `from_points`."""
    # All below are in the units of the curve as it is, scales included.
    laws: tuple[Sheet, ...] = field(init=False, repr=False, compare=False)
    """Its sheets with the scales in them."""
    low: float = field(init=False, repr=False, compare=False)
    """Least travel of its curve [m]."""
    high: float = field(init=False, repr=False, compare=False)
    """Largest travel of its curve [m]."""
    phases: tuple[Phase, ...] = field(init=False, repr=False, compare=False)
    """Phases that are stable under a prescribed force, in the order of the curve."""
    stretches: tuple[Stretch, ...] = field(init=False, repr=False, compare=False)
    """Sheet and travels [m] of every phase, in their order."""
    switching_range: tuple[float, float] = field(init=False, repr=False, compare=False)
    """Least and largest switching force of its phases [N]; infinite if there is none."""
    largest_force: float = field(init=False, repr=False, compare=False)
    """Largest force of its curve in size [N]."""
    packed: tuple[tuple[float, ...], Floats] = field(init=False, repr=False, compare=False)
    """Arrays that a chain is packed from: a table of the sheets, row by row, and their curves.

    See `phase.LOW` for the columns of the table; rows and the first sheet are counted from each
    sheet. An open end is infinite there and has a row of its own in the curves, blank at the low
    end.
    """

    def __post_init__(self):
        put = object.__setattr__
        unit = self.measure.force_unit
        put(self, "friction", check.not_negative("friction", self.friction, unit))
        put(self, "mobility", a_mobility(self.mobility))
        for name in ("force_scale", "travel_scale"):
            put(self, name, check.positive(name, getattr(self, name), "1"))
        put(self, "stops", _both(self.stops))
        if not self.sheets:
            raise InputError("sheets is empty: an element has a curve; see Element.from_table.")
        own = tuple(sheet.scaled(self.force_scale, self.travel_scale) for sheet in self.sheets)
        put(self, "laws", own)
        put(self, "low", min(sheet.begin for sheet in own))
        put(self, "high", max(sheet.end for sheet in own))
        turns = [cubics.signs(sheet.rows, sheet.end) for sheet in own]
        put(self, "largest_force", max(float(np.max(np.abs(forces))) for forces, _ in turns))
        put(self, "phases", _phases_of(self, turns))
        put(self, "stretches", tuple((one.sheet, one.low, one.high) for one in self.phases))
        forces = [force for one in self.phases for force in (one.force_low, one.force_high)]
        finite = [force for force in forces if abs(force) < np.inf]
        put(self, "switching_range", (min(finite, default=np.inf), max(finite, default=-np.inf)))
        _refuse_loose_ends(self)
        put(self, "packed", _packed(self))

    @classmethod
    def from_table(
        cls,
        travel: Iterable[float],
        force: Iterable[float],
        name: str = "",
        *,
        stops: Stops = False,
        noise: float | None = None,
        friction: float = 0.0,
        mobility: float = 1.0,
        measure: Measure = Measure.TRAVEL,
        unusual: bool = False,
    ) -> Element:
        """An element through measured or computed points: monotone cubics between them.

        Args:
            travel: (n,) rising [m], n >= 3.
            force: (n,) [N].
            name, stops, friction, mobility, measure: as for Element.
            unusual: True to accept a travel above 1 m or a force above 10 kN.
            noise: standard deviation of the forces [N], at least that of the points; the curve is
                then a smooth one whose rises and falls are all larger than the noise, without a
                stretch of constant force at its low end. None goes through every point.

        Raises:
            ValueError: too few points, travels that do not rise, no rise larger than the noise,
                noise that is correlated and could make a phase, or a size that is probably in
                another unit.
        """
        if noise is not None:
            noise = check.positive("noise", noise, measure.force_unit)
        x, y = element_curves.checked(travel, force, measure, 3 if noise is None else 5)
        band = 0.0
        if noise is not None:
            fit = smoothing.fitted(x, y, noise, trim=not _both(stops)[0], measure=measure)
            x, y, band = fit.travel, fit.force, fit.band
        on = (Sheet.of(cubics.through(x, y), float(x[-1])),)
        made = cls(on, stops, friction, name, measure, error_band=band, mobility=mobility)
        return made if unusual else _without_slips(made)

    @classmethod
    def from_points(
        cls,
        travel: Iterable[float],
        force: Iterable[float],
        name: str = "",
        *,
        stops: Stops = False,
        friction: float = 0.0,
        mobility: float = 1.0,
        measure: Measure = Measure.TRAVEL,
        unusual: bool = False,
    ) -> Element:
        """An element whose force is straight between points, such as the trilinear snap.

        Args:
            travel: (n,) rising [m], n >= 2.
            force: (n,) [N].
            name, stops, friction, mobility, measure: as for Element.
            unusual: True to accept a travel above 1 m or a force above 10 kN.

        Raises:
            ValueError: too few points, travels that do not rise, or a size that is probably in
                another unit.
        """
        x, y = element_curves.checked(travel, force, measure, 2)
        on = (Sheet.of(cubics.straight(x, y), float(x[-1])),)
        made = cls(on, stops, friction, name, measure, mobility=mobility)
        return made if unusual else _without_slips(made)

    @classmethod
    def from_law(
        cls,
        force: cubics.Force,
        low: float,
        high: float,
        name: str = "",
        *,
        stops: Stops = False,
        kinks: Sequence[float] = (),
        accuracy: float = 1e-7,
        friction: float = 0.0,
        mobility: float = 1.0,
        measure: Measure = Measure.TRAVEL,
    ) -> Element:
        """An element that follows a law, in as many cubics as its accuracy needs.

        Args:
            force: [N] by an array of travels [m].
            low, high: between which travels the law is taken [m].
            name, stops, friction, mobility, measure: as for Element.
            kinks: travels at which the slope of the law jumps [m].
            accuracy: largest deviation from the law, as a fraction of the largest force.

        Raises:
            ValueError: a law without finite values, or with a kink that `kinks` does not name.
        """
        unit = measure.travel_unit
        low, high = check.finite("low", low, unit), check.finite("high", high, unit)
        if high <= low:
            raise InputError(f"high = {high!r} {unit}: must be above low = {low!r} {unit}.")
        if not 1e-13 <= accuracy <= 1e-2:
            raise InputError(f"accuracy = {accuracy!r}: must be from 1e-13 to 0.01.")
        on = (Sheet.of(cubics.along(force, low, high, accuracy, kinks), high),)
        return cls(on, stops, friction, name, measure, mobility=mobility)

    @classmethod
    def from_curve(
        cls,
        travel: Iterable[float],
        force: Iterable[float],
        name: str = "",
        *,
        stops: Stops = False,
        friction: float = 0.0,
        mobility: float = 1.0,
        measure: Measure = Measure.TRAVEL,
        unusual: bool = False,
    ) -> Element:
        """An element whose curve may fold back in travel: it has a freedom of its own inside.

        The points are in the order of the curve's arc, unstable stretches included, from a stable
        end on. At each fold the sense of rotation decides whether the next stretch is stable at a
        given travel (Maddocks 1987): a clockwise turn, with force plotted over travel, loses
        stability and a counterclockwise one gains it. Where a stable stretch ends the element jumps
        at that travel to the next stable one along the arc. Its sheets are in that order.

        Args:
            travel: (n,) by arc [m], n >= 3.
            force: (n,) [N].
            name, stops, friction, mobility, measure: as for Element.
            unusual: True to accept a travel above 1 m or a force above 10 kN.

        Raises:
            ValueError: too few points, two of them at one place, a curve that would be unstable
                from the start, a stretch from whose end there is nowhere to land, or a size that is
                probably in another unit.
        """
        sheets = element_curves.folded(travel, force, measure)
        made = cls(sheets, stops, friction, name, measure, mobility=mobility)
        return made if unusual else _without_slips(made)

    @classmethod
    def from_chain(cls, chain: Chain, name: str = "") -> Element:
        """A chain as one element: its total travel, and its resisting force.

        Its sheets are the branches that are reachable under a prescribed stroke. Its internal
        degrees of freedom move much faster than the cells outside. The actuator of the chain is
        ignored.

        Raises:
            ValueError: a chain with friction, or with too many branches.
            StaticsError: the engine cannot follow the chain.

        Source: ours (theory page, "Elements").
        """
        from stepwell.sequences import element_of

        return element_of(chain, name)

    @classmethod
    def from_recording(
        cls, recording: Recording | str | os.PathLike[str], name: str = "", **options: Any
    ) -> Element:
        """An element from a recording of a test machine: `stepwell.lab.measure_element`.

        Args:
            recording: of a test, or its file.
            name, options: as for `measure_element`, whose result has the phases, the noise and
                notes too.

        Raises:
            ValueError: the file cannot be read, or its curve is no element.
        """
        from stepwell import lab

        is_read = isinstance(recording, lab.Recording)
        given = recording if is_read else lab.read(recording, measures=tuple(Measure))
        return lab.measure_element(given, name, **options).element

    @classmethod
    def side_by_side(cls, elements: Sequence[Element], name: str = "") -> Element:
        """Elements in parallel as one element: equal travels, and forces that add up.

        Its travel is limited by the stops of all of them, and their dampers add up.

        Raises:
            ValueError: elements of different measures, or without common travels.
        """
        sheets, stops, friction = element_curves.in_parallel(elements)
        mobility = 1.0 / sum(1.0 / element.mobility for element in elements)
        return cls(sheets, stops, friction, name, elements[0].measure, mobility=mobility)

    @property
    def known(self) -> tuple[float, float]:
        """Ends of its curve [m]; infinite at a stop, and where the curve ends straight."""
        first = next(one for one in self.laws if one.begin == self.low).rows[0]
        last = next(one for one in self.laws if one.end == self.high).rows[-1]
        bends = [bool(np.any(row[3:5])) for row in (first, last)]
        low, high = (bends[k] and not self.stopped[k] for k in (0, 1))
        return self.low if low else -np.inf, self.high if high else np.inf

    @property
    def stopped(self) -> tuple[bool, bool]:
        """Whether it is stopped at the low and at the high end of its curve."""
        assert not isinstance(self.stops, bool)
        return self.stops

    @property
    def full_travel(self) -> float:
        """Travel between the ends of its curve [m]; an end without a stop can be passed."""
        return self.high - self.low

    @property
    def fields(self) -> tuple[tuple[float, float], ...]:
        """Switching fields: forces of the transitions to the next phase, and back [N].

        They determine the response to a prescribed force completely.
        """
        pairs = zip(self.phases, self.phases[1:], strict=False)
        return tuple((a.force_high, b.force_low) for a, b in pairs)

    @property
    def is_bistable(self) -> bool:
        """Whether it can stand in two phases or more without any force."""
        return sum(phase.force_low < 0.0 < phase.force_high for phase in self.phases) > 1

    def force_at(self, travel: ArrayLike, sheet: int = 0) -> Floats:
        """Force F = dE/ds [N] at travels [m] of any shape on a sheet, without friction.

        Past an open end it continues straight; past a stop or the end of the sheet ValueError.
        """
        return cubics.value(*self._checked_place(travel, sheet))

    def energy_at(self, travel: ArrayLike, sheet: int = 0) -> Floats:
        """Energy [J] at travels as of `force_at`, counted from where the curve begins."""
        return cubics.integral(*self._checked_place(travel, sheet))

    def goes_on(self, sheet: Sheet) -> tuple[bool, bool]:
        """Whether one of its sheets continues straight past its low and past its high end."""
        below, above = self.stopped
        return (
            not below and sheet.begin == self.low and sheet.below is None,
            not above and sheet.end == self.high and sheet.above is None,
        )

    def at_band(self, way: float) -> Element:
        """The element with every drop of its force larger, or smaller, by its error band.

        Args:
            way: 1 for larger drops, -1 for smaller ones: peaks are higher by `way` times
                `error_band` and valleys lower, with straight lines between them.

        Raises:
            ValueError: without the error band, a phase would be lost.
        """
        sheets: list[Sheet] = []
        for sheet in self.sheets:
            rows, x = sheet.rows.copy(), np.append(sheet.rows[:, 0], sheet.end)
            _, rises = cubics.signs(rows, sheet.end)
            turns = [k for k in range(1, len(rises)) if rises[k] != rises[k - 1]]
            if not turns:
                sheets.append(sheet)
                continue
            by = self.error_band / self.force_scale * way
            shift = np.interp(x, x[turns], [by * np.sign(rises[k - 1] - rises[k]) for k in turns])
            rows[:, 1] += shift[:-1]
            rows[:, 2] += np.diff(shift) / np.diff(x)
            rows = cubics.with_integrals(rows, float(rows[0, 5]))
            sheets.append(Sheet.of(rows, sheet.end, sheet.below, sheet.above))
        made = replace(self, sheets=tuple(sheets))
        if len(made.phases) != len(self.phases):
            raise InputError(
                f"error_band = {self.error_band:.3g} {self.measure.force_unit}: a phase is as "
                f"small as the error band. Measure with less noise."
            )
        return made

    def renamed(self, name: str) -> Element:
        """The same element with another name."""
        return replace(self, name=name)

    def _checked_place(self, travel: ArrayLike, sheet: int) -> tuple[Floats, Floats]:
        if not 0 <= sheet < len(self.laws):
            raise InputError(
                f"sheet = {sheet}: the curve has {len(self.laws)}, numbered from 0 on."
            )
        chosen, travel = self.laws[sheet], np.asarray(travel, float)
        slip = 1e-9 * self.full_travel
        opens = self.goes_on(chosen)
        far = np.isnan(travel)
        far |= (travel < chosen.begin - slip) & (not opens[0])
        far |= (travel > chosen.end + slip) & (not opens[1])
        if far.any():
            unit, factor = display_unit(self.measure.travel_unit)
            worst = float(np.ravel(travel)[np.argmax(np.ravel(far))])
            raise InputError(
                f"travel = {worst * factor:.6g} {unit}: must be between "
                f"{chosen.begin * factor:.6g} and {chosen.end * factor:.6g} {unit}, where "
                f"{'the curve' if len(self.laws) == 1 else f'sheet {sheet}'} ends."
            )
        force = -2.0 * self.largest_force - abs(float(chosen.rows[0, 1]))
        return chosen.extended(opens, force), travel

    def __repr__(self):
        unit, factor = display_unit(self.measure.travel_unit)
        name = f"{self.name!r}, " if self.name else ""
        ends = {(True, True): "stops", (False, False): "open"}.get(self.stopped, "one stop")
        folds = f", {len(self.sheets)} sheets" if len(self.sheets) > 1 else ""
        rub = f", friction={self.friction:.3g} {self.measure.force_unit}" if self.friction else ""
        return (
            f"Element({name}{self.measure.travel} {self.low * factor:.4g} to "
            f"{self.high * factor:.4g} {unit}, {ends}, {len(self.phases)} phases{folds}{rub})"
        )


def _without_slips(element: Element) -> Element:
    """The element; SlipError if its curve is probably in another unit."""
    from stepwell.mechanism import sizes

    slips = tuple(sizes.of_element(element))
    if slips:
        raise sizes.SlipError(slips, "If it is meant so, pass unusual=True.")
    return element


def _both(stops: Stops) -> tuple[bool, bool]:
    if isinstance(stops, bool):
        return stops, stops
    try:
        low, high = stops
    except (TypeError, ValueError):
        raise InputError(
            f"stops = {stops!r}: must be True, False, or two of them for the low and high end."
        ) from None
    return bool(low), bool(high)


def _packed(element: Element) -> tuple[tuple[float, ...], Floats]:
    table: list[float] = []
    curves: list[Floats] = []
    for number, sheet in enumerate(element.laws):
        low, high = element.goes_on(sheet)
        curves += [*[_BLANK] * low, sheet.rows, *[sheet.after] * high]
        rows = low + len(sheet.rows) + high
        ends = -np.inf if low else sheet.begin, np.inf if high else sheet.end
        leads = (-1 if to is None else to for to in (sheet.below, sheet.above))
        table += [*ends, sheet.begin, sheet.end, 0, rows, *leads, -number]
    return tuple(table), np.concatenate(curves)


def _refuse_loose_ends(element: Element) -> None:
    """Raise ValueError where an open end does not rise, so that the travel is unbounded."""
    slowest = _LEAST_RISE * element.largest_force / element.full_travel
    for sheet in element.laws:
        rises = sheet.rows[0, 2], sheet.after[0, 2]
        for end, goes_on, rise in zip(("low", "high"), element.goes_on(sheet), rises, strict=True):
            if goes_on and not rise > slowest:
                raise InputError(
                    f"stops: at the {end} end of the curve the force does not rise with travel, so "
                    f"the travel is unbounded without a stop. Pass stops=True if the element is "
                    f"stopped where its curve ends, or extend the curve to where it rises again."
                )


def _phases_of_sheet(element: Element, number: int, forces: Floats, rises: Ints) -> Iterator[Phase]:
    """Runs of rows of a sheet on which the force does not fall, and stops; see `signs`."""
    sheet, (below, above) = element.laws[number], element.stopped
    joints = np.append(sheet.rows[:, 0], sheet.end)
    starts, least, ends, most = joints.copy(), forces.copy(), joints.copy(), forces.copy()
    final, stopped_low, stopped_high = len(rises), False, False
    # At the ends of the element there is a stop, or a curve that continues to rise.
    if sheet.below is None and sheet.begin == element.low:
        starts[0], least[0], stopped_low = joints[0] if below else -np.inf, -np.inf, below
    if sheet.above is None and sheet.end == element.high:
        ends[final], most[final], stopped_high = joints[final] if above else np.inf, np.inf, above
    falls = np.flatnonzero(rises < 0)
    # A run between two falls is empty.
    for at, last in zip([0, *(falls + 1).tolist()], [*falls.tolist(), final], strict=True):
        held = (stopped_low and at == 0) or (stopped_high and last == final)
        if held or np.any(rises[at:last] > 0):
            phase = map(float, (starts[at], ends[last], least[at], most[last]))
            yield Phase(number, *phase)


def _phases_of(element: Element, turns: Sequence[tuple[Floats, Ints]]) -> tuple[Phase, ...]:
    """The phases of all sheets; `turns` has `signs` by sheet."""
    phases = [
        phase for i, turn in enumerate(turns) for phase in _phases_of_sheet(element, i, *turn)
    ]
    if len(phases) > _MOST_PHASES:
        raise InputError(
            f"the force curve has {len(phases)} rising stretches: at most {_MOST_PHASES} are "
            f"possible, one per digit of a state. If these are measurement noise, give "
            f"noise_{display_unit(element.measure.force_unit)[0]} (noise= in Python), the standard "
            f"deviation of the {element.measure.force}, with its table."
        )
    return tuple(phases)
