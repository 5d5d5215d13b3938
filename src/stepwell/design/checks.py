"""Check of a design: yield verdict, smallest critical change, and most useful measurement."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from itertools import pairwise, product
from typing import Any

import numpy as np

from stepwell import base
from stepwell.design.margins.margin import LONGEST_FOLLOWED, Change, margin
from stepwell.design.orders import checked_cycle, short
from stepwell.design.plane import Method
from stepwell.design.synthesis.region import usual_box
from stepwell.design.tolerances.draws import DEFAULT_TOLERANCES, CellTolerances, Tolerances
from stepwell.design.tolerances.survival import Survival, ends_right, survival
from stepwell.design.tolerances.yields import Yield, parts_of, with_tightened_tolerance, yields
from stepwell.mechanism import Band, Cell, Chain, Element, Table, sizes
from stepwell.sequences import Program, cycle
from stepwell.statics import Path, StaticsError

# Yield: lower bound for "robust", upper bound for "fails".
SURE, HALF = 0.95, 0.5


class Verdict(StrEnum):
    """Verdict on the yield, from the best to the worst."""

    ROBUST = "robust"
    MARGINAL = "marginal"
    FAILS = "fails"


def verdict_of(*, meets_target: bool, tied: bool, interval: tuple[float, float]) -> Verdict:
    """The verdict, as decided in docs/decisions/verdict.md.

    `FAILS` if the nominal design, which may be a tie, misses the target, or the 95 % confidence
    interval of the yield ends below one half; `ROBUST` if it reaches the target without a tie and
    the interval begins at 95 % or above; else `MARGINAL`.
    """
    low, high = interval
    if not meets_target or high < HALF:
        return Verdict.FAILS
    return Verdict.ROBUST if low >= SURE and not tied else Verdict.MARGINAL


# The largest strain of a rubber band in use: natural rubber breaks at about 6 to 7.
STRAIN = 5.0
# Force of a hobby servo of 2 kg cm on a horn of 10 mm [N], air pressure by hand [Pa], and torque of
# that servo [N m].
PULLS = {base.Measure.TRAVEL: 20.0, base.Measure.VOLUME: 1e5, base.Measure.ANGLE: 0.2}
_EDGE = 1e-9  # relative: an anchor or an extension this far outside is on the edge


def _warnings(chain: Chain, path: Path) -> Iterator[str]:
    """Warnings on unusual forces and sizes, one sentence each."""
    unit, most = chain.measure.force_unit, PULLS[chain.measure]
    pull = abs(path.peak_force)
    if pull > most:
        yield (
            f"the actuator needs {base.amount(pull, unit)}: "
            f"hobby actuators give about {base.amount(most, unit)}"
        )
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if not isinstance(cell, Cell):
            continue
        yield from (f"{name}: {slip}" for slip in sizes.slips(cell))
        for band in cell.bands:
            yield from _band_warnings(name, cell, band)


def _band_warnings(name: str, cell: Cell, band: Band) -> Iterator[str]:
    stretch = band.largest_stretch(cell.lever, cell.limit)
    if 1.0 + STRAIN < stretch < math.inf:
        yield (
            f"a band of {name} is stretched to {base.number(stretch, 3)} times "
            f"its rest length: rubber tears at about {1 + STRAIN:g} to 8 times"
        )
    if isinstance(band.law, Table):
        extension = band.lengths(cell.lever, cell.limit)[1] - band.rest_length
        tested = band.law.extension[-1]
        if extension > (1.0 + _EDGE) * tested:
            yield (
                f"a band of {name} is extended by {base.amount(extension, 'm')}, and its measured "
                f"law ends at {base.amount(tested, 'm')}: the tension beyond is extrapolated"
            )
    for which, place in (("p", band.p), ("q", band.q)):
        outside = usual_box(cell.lever, which).clamped(np.array([place])) - place
        if np.max(np.abs(outside)) > _EDGE * cell.lever:
            at = ", ".join(base.number(base.to_unit(part, "mm")) for part in place)
            yield f"anchor {which} of {name} at ({at}) mm lies outside the usual block"


# Tolerances after measurement by scale and callipers; friction to a fifth of its tolerance.
MEASURED = Tolerances(anchor=1e-4, stiffness=0.02, rest_length=0.02, lever=1e-4, travel=0.02)
_OF_FRICTION = 0.2
# Samples that rank the parts: in closed form, or simulated one by one.
_RANKED, _RANKED_ONE_BY_ONE = 4_000, 60
_GAIN = 0.005  # smallest increase of the yield that is reported


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Measurement(base.ByValue):
    """The part whose measurement raises the yield most.

    Attributes:
        cell: the cell of the part, 0 the innermost.
        what: "d" (all anchors of its bands), "stiffness", "rest_length", "lever", "friction", or
            for an element "force_scale", "travel_scale".
        tolerance: its field of `Tolerances`.
        now, then: that tolerance before and after the measurement, in SI.
        before, after: the yield before and after.
    """

    cell: int
    what: str
    tolerance: str
    now: float
    then: float
    before: float
    after: float


def measurement(counted: Yield | Survival) -> Measurement | None:
    """The part whose measurement raises a yield most; None if no gain is large enough.

    For each part in turn a few of the same samples are recounted with its tolerance after
    measurement by scale and callipers; for the best part all samples are.
    """
    parts = parts_of(counted)
    each = counted.tolerances.each(len(counted.chain))
    left = {name: _left_of(each[part.cell], part.tolerance) for name, part in parts.items()}
    measurable = [name for name in parts if left[name] < 1.0]
    if counted.successes == counted.samples or not measurable:
        return None
    quickly = isinstance(counted, Yield) and not counted.by_engine
    n = min(counted.samples, _RANKED if quickly else _RANKED_ONE_BY_ONE)
    best = max(measurable, key=lambda name: with_tightened_tolerance(counted, name, left[name], n))
    after = with_tightened_tolerance(counted, best, left[best], counted.samples) / counted.samples
    if after < counted.fraction + _GAIN:
        return None
    cell, what, tolerance, _ = parts[best]
    now = getattr(each[cell], tolerance)
    return Measurement(cell, what, tolerance, now, now * left[best], counted.fraction, after)


def _left_of(tolerances: CellTolerances, name: str) -> float:
    if name == "friction":
        return _OF_FRICTION
    return min(1.0, getattr(MEASURED.most, name) / getattr(tolerances, name))


# Sizes of changes tried, in tolerances, until one changes the outcome; halvings of bisection.
_TRIED = 0.125 * 1.5 ** np.arange(17)
_HALVINGS = 12
_AXES = (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)
_Direction = tuple[int, str, base.Vec2 | float]  # cell, part that changes, direction
# Largest changes that are tried [m], and [1]: a number reduced to nearly zero has no meaning.
_REACH = {"anchor": base.REACH, "stiffness": 0.95, "force_scale": 0.95, "travel_scale": 0.95}


class ProgramChange(Change):
    """A change after which a program ends in another state, without a sequence."""

    @cached_property
    def becomes(self) -> str:
        """Empty."""
        return ""


def critical_change_of_cycle(chain: Chain, tolerances: Tolerances) -> Change | None:
    """The smallest change of a margin in units of tolerances; None if there is none."""
    of = _tolerances_of(chain, tolerances)
    changes = [one for one in margin(chain).changes if of(one.cell, one.parameter)]
    near = min(changes, key=lambda one: one.distance / of(one.cell, one.parameter))
    return None if math.isinf(near.distance) else near


def critical_change_of_program(program: Program, tolerances: Tolerances) -> Change | None:
    """The same for a program that ends in its target state; None if no change tried breaks it.

    Anchors are moved along x and y, numbers increased and decreased, by a geometric series of
    amounts. The first amount that breaks the program is bisected.
    """
    chain = program.chain
    of = _tolerances_of(chain, tolerances)
    ways = [way for way in _changes(chain) if of(way[0], way[1])]

    def change(way: _Direction, tried: float) -> Change:
        cell, part, along = way
        size = tried * of(cell, part)
        move = (along[0] * size, along[1] * size) if isinstance(along, tuple) else along * size
        return ProgramChange(chain, cell, part, size, move, move, Method.SEARCH)

    def holds(way: _Direction, tried: float) -> bool:
        made = change(way, tried)
        if made.distance > _REACH[made.parameter]:
            return True
        try:
            assert made.design is not None
            return ends_right(made.design, program.turning_points, program.start, program.target)
        except (ValueError, StaticsError):
            return False

    for safe, tried in pairwise([0.0, *_TRIED.tolist()]):
        broken = [
            (base.bisected(lambda size, way=way: holds(way, size), safe, tried, _HALVINGS)[1], way)
            for way in ways
            if not holds(way, tried)
        ]
        if broken:
            least, way = min(broken, key=lambda one: one[0])
            return change(way, least)
    return None


def _changes(chain: Chain) -> Iterator[_Direction]:
    for cell, one in enumerate(chain.cells):
        numbers = ("force_scale", "travel_scale") if isinstance(one, Element) else ("stiffness",)
        if not isinstance(one, Element):
            yield from ((cell, "anchor", along) for along in _AXES)
        yield from product([cell], numbers, (1.0, -1.0))


def _tolerances_of(chain: Chain, tolerances: Tolerances) -> Callable[[int, str], float]:
    """The tolerance of a part of a cell [m] or [1], or the default one if it is zero for all."""
    each, most = tolerances.each(len(chain)), tolerances.most

    def of(cell: int, part: str) -> float:
        name = {"anchor": "anchor", "travel_scale": "travel"}.get(part, "stiffness")
        if getattr(most, name):
            return getattr(each[cell], name)
        usual = DEFAULT_TOLERANCES.most
        return usual.anchor if name == "anchor" else usual.stiffness

    return of


@dataclass(frozen=True, eq=False)
class Check(base.ByValue):
    """The verdict on a design, with its reasons.

    Attributes:
        chain: the design.
        verdict, reason: verdict on the yield, and its reason in a sentence.
        target: the target cycle; or the first and the target state of a program.
        does, meets_target: the sequence of the nominal design, and whether it is the target.
        path: equilibrium path of the nominal design, with forces, energy and ties.
        yield_: yield within tolerances.
        critical_change: the smallest change of one parameter, in tolerances, after which the
            nominal design does something else; None if none was found, or if the nominal design
            misses the target.
        warnings: unusual forces and sizes, one sentence each.
        measure: the measurement that raises the yield most; None if no gain is large enough.
    """

    chain: Chain = field(repr=False)
    verdict: Verdict
    reason: str
    target: str
    does: str
    meets_target: bool
    path: Path = field(repr=False)
    yield_: Yield | Survival
    critical_change: Change | None
    warnings: tuple[str, ...]
    measure: Measurement | None

    @property
    def peak_force(self) -> float:
        """Actuator force of the largest magnitude [N], with its sign."""
        return self.path.peak_force

    @property
    def dissipated(self) -> float:
        """Energy dissipated in the cycle or the program [J], by snaps and friction."""
        return self.path.dissipated

    def __repr__(self):
        return f"Check({self.verdict}: {self.reason})"


def check(
    chain: Chain,
    target: str | Program | None = None,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    *,
    samples: int | None = None,
    seed: int = 0,
    progress: base.Progress = None,
) -> Check:
    """Check a design: yield verdict, smallest critical change, and most useful measurement.

    Args:
        chain: the design.
        target: the target cycle, such as "00>10>11>01>00" or "1-2/1-2", or a program of this
            chain; the cycle of the nominal design by default.
        tolerances: manufacturing tolerances; as for `yields` by default.
        samples: number of random samples; by default as for `yields` or `survival`.
        seed: random seed.
        progress: called with (done, samples).

    Raises:
        ValueError: no such cycle, a program of another chain, or tolerances as for `yields`.
        StaticsError: the engine could not follow the nominal design; the text states where.

    Source: ours; the rule is the decision "A verdict is an interval's".
    """
    counted: dict[str, Any] = {"samples": samples, "seed": seed, "progress": progress}
    if isinstance(target, Program):
        if target.chain != chain:
            raise base.InputError("target: a program of another chain; make it with chain.program.")
        return _check_program(target, tolerances, counted)
    motion = cycle(chain)
    path, does = motion.path, str(motion.sequence)
    last, names = chain.last_state, chain.names
    sequence = does if target is None else checked_cycle(target, last, "target", names)
    yield_result = yields(chain, tolerances, target=sequence, **counted)
    critical_change = critical_change_of_cycle(chain, tolerances) if does == sequence else None
    return _checked(path, sequence, does, does == sequence, yield_result, critical_change)


def _check_program(program: Program, tolerances: Tolerances, counted: dict[str, Any]) -> Check:
    chain, points = program.chain, program.turning_points
    start, target = program.start, program.target
    result = survival(chain, points, target, tolerances, start=start, **counted)
    meets_target = ends_right(chain, points, start, target)
    critical_change = critical_change_of_program(program, tolerances) if meets_target else None
    does = f"{start} to {target if meets_target else program.arrives}"
    text = f"{start} to {target}"
    return _checked(program.path, text, does, meets_target, result, critical_change)


def _checked(
    path: Path,
    target: str,
    does: str,
    meets_target: bool,
    counted: Yield | Survival,
    critical_change: Change | None,
) -> Check:
    tied = bool(path.degenerate)
    verdict = verdict_of(meets_target=meets_target, tied=tied, interval=counted.interval)
    low, high = map(base.percent, counted.interval)
    if not meets_target:
        reason = f"the nominal design does not reach the target: it gives {short(does)}"
    elif verdict is Verdict.ROBUST:
        reason = f"the nominal design reaches the target; yield ≥ {low} (95 % confidence)"
    elif verdict is Verdict.FAILS:
        reason = f"the nominal design reaches the target, but yield ≤ {high} (95 % confidence)"
    elif tied:
        reason = "degenerate: two events of the nominal design coincide within numerical tolerance"
    elif counted.fraction >= SURE:
        reason = f"too few samples to decide: yield between {low} and {high} (95 % confidence)"
    else:
        reason = f"the nominal design reaches the target, but the yield is only {low} to {high}"
    if critical_change is not None and len(counted.chain) <= LONGEST_FOLLOWED:
        # Computed once here; reports only read it.
        _ = critical_change.becomes
    measure = measurement(counted) if meets_target and not tied else None
    # Two bands in one hole give one warning.
    warnings = tuple(dict.fromkeys(_warnings(counted.chain, path)))
    nominal = counted.chain, verdict, reason, target, does, meets_target, path
    return Check(*nominal, counted, critical_change, warnings, measure)
