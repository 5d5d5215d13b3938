"""Test of one built copy: its recording against the design, its tolerances and its target."""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from stepwell import base
from stepwell.base import ByValue, Floats, InputError, StepwellError
from stepwell.design import (
    DEFAULT_TOLERANCES,
    Draws,
    Parameter,
    Tolerances,
    checked_cycle,
    parameters as parameters_of,
)
from stepwell.lab import builds, first_build
from stepwell.lab.chain_test import CLOSE_SHARE
from stepwell.lab.recordings.curve import from_zero, rms
from stepwell.lab.recordings.recording import LabError, Recording, without_spikes
from stepwell.lab.rig import on_path, path_of
from stepwell.mechanism import Chain, Element
from stepwell.statics import Path

# Strips of stroke of each half, and numbers in it that count as independent.
_STRIPS, _INDEPENDENT = 60, 12
# Quantiles of the strokes of a strip at which the model is averaged: a snap may lie within it.
_WITHIN = tuple((k + 0.5) / 9 for k in range(9))
# Parts at both ends of the stroke that are left out, where rigs settle and blocks touch.
_ENDS = 0.025
# Least fraction of the stroke that each half covers.
_REACH = 0.9
# Least uncertainty of a force over its range; a fit that misses the force by more takes its error.
# Standard deviations of what a rig adds: friction and zero of the force over that range, loss of
# rubber in unloading [1], zero of the stroke [m].
_FORCE, _FRICTION, _ZERO, _LOSS, _SHIFT = 0.01, 0.05, 0.02, 0.15, 2e-4
# Standard deviations by which a number must lie outside its tolerance, and of the stiffness that a
# band within the tolerances can have.
SURE, WIDE = 2.0, 3.0
# Copies of the tolerance interval, its ends, and copies that the recording leaves possible.
_COPIES, _ENDS_OF, _LEFT = 200, (0.005, 0.995), 60
# Fraction of possible copies with the target from which on the sequence is right.
RIGHT = 0.95
# Hypotheses that are fitted in full, and the least probability of one that is named.
_FITTED, _NAMED = 3, 0.1
_STEP = 0.05  # of numerical derivatives, in standard deviations
_PARTS = ("q.x", "q.y", "stiffness", "force_scale", "travel_scale")


class CopyVerdict(StrEnum):
    """Verdict on a copy, from the best to the worst."""

    GOOD = "good"
    DIFFERS = "differs"
    UNDECIDED = "not decided"
    FAILS = "fails"


@dataclass(frozen=True, slots=True, eq=False)
class CopyNumber(ByValue):
    """A number of a copy against its tolerance.

    Attributes:
        name: such as "outer.stiffness", "inner F0" or "snap 1, loading".
        unit: SI unit.
        nominal, value, doubt: of the design and of the copy, with its standard deviation.
        low, high: ends of the tolerance.
    """

    name: str
    unit: str
    nominal: float
    value: float
    doubt: float
    low: float
    high: float

    @property
    def within(self) -> bool:
        """Whether it is not outside its tolerance by more than two standard deviations."""
        return self.low - SURE * self.doubt <= self.value <= self.high + SURE * self.doubt


@dataclass(frozen=True, eq=False)
class CopyTest(ByValue):
    """The judgement of a built copy from its own recording.

    Attributes:
        design, target: the nominal design, and the sequence that the copy shall have.
        source: name of the recording.
        tolerances: of the design.
        sequence, right: sequence of the fitted copy, and the fraction of copies left possible by
            the recording that have the target [1].
        chain: the fitted copy.
        parts: anchors and stiffness, or scales, of each cell.
        switches: critical forces of each cell and strokes of the snaps, with the intervals of
            copies within the tolerances.
        wrong: anchor in another hole, with its probability; None for none.
        others: other anchors in other holes that explain the recording too.
        error, range: RMS of measured less fitted force, and range of the force [N].
        friction, loss: fitted friction [N], and loss of the bands in unloading [1].
        covered: least fraction of the stroke that a half covers [1].
    """

    design: Chain = field(repr=False)
    target: str
    source: str
    tolerances: Tolerances
    sequence: str
    right: float
    chain: Chain = field(repr=False)
    parts: tuple[CopyNumber, ...] = field(repr=False)
    switches: tuple[CopyNumber, ...] = field(repr=False)
    wrong: builds.WrongHole | None
    others: tuple[builds.WrongHole, ...]
    error: float
    range: float
    friction: float
    loss: float
    covered: float

    @property
    def outside(self) -> tuple[CopyNumber, ...]:
        """Numbers outside their tolerances, parts first."""
        return tuple(one for one in (*self.parts, *self.switches) if not one.within)

    @property
    def verdict(self) -> CopyVerdict:
        """The verdict.

        Not decided if a half covers less than 90 % of the stroke, if the fit misses the force by
        more than 10 % of its range, or if the recording leaves the sequence open. Else the copy
        fails with another sequence, differs with an anchor in another hole or a number outside its
        tolerance, and is good otherwise.
        """
        if self.covered < _REACH or self.error > CLOSE_SHARE * self.range:
            return CopyVerdict.UNDECIDED
        if self.right < RIGHT:
            other = self.sequence != self.target and self.right <= 1.0 - RIGHT
            return CopyVerdict.FAILS if other else CopyVerdict.UNDECIDED
        return CopyVerdict.DIFFERS if self.wrong or self.outside else CopyVerdict.GOOD

    @property
    def reason(self) -> str:
        """The reason of the verdict in words."""
        if self.covered < _REACH:
            return (
                f"the recording covers {base.percent(self.covered)} of the stroke in loading or "
                f"unloading: record a whole cycle"
            )
        if self.error > CLOSE_SHARE * self.range:
            return (
                f"no copy of this design has this force: the best one misses it by "
                f"{base.percent(self.error / self.range)} of its range; check that this design was "
                f"tested, which cell is innermost, units and signs"
            )
        does = f"the copy does {self.sequence}, the target is {self.target}"
        if self.verdict is CopyVerdict.UNDECIDED:
            return f"{does}; {base.percent(self.right)} of the copies left possible reach it"
        if self.verdict is CopyVerdict.FAILS:
            return does
        if self.verdict is CopyVerdict.GOOD:
            return "the copy has the target sequence, and every switch is within its tolerance"
        return "the copy has the target sequence, but is not within the tolerances"

    @property
    def corrections(self) -> tuple[str, ...]:
        """What to change, a sentence each; empty for nothing."""
        steps: list[str] = []
        if self.wrong is not None:
            steps.append(f"{_hole(self.wrong)} (probability {self.wrong.fraction:.2f})")
            steps += [f"or instead, {_hole(one)}" for one in self.others]
        hooked = self.wrong.anchor.name.rpartition(".")[0] if self.wrong else ""
        for one in self.parts:
            cell = one.name.partition(".")[0]
            if not one.within and cell != hooked:
                steps.append(_correction(one))
        return tuple(steps)

    def __repr__(self):
        return f"CopyTest({self.verdict}: {self.reason})"


def _hole(one: builds.WrongHole) -> str:
    now, right = ((base.to_unit(x, "mm") + 0.0 for x in place) for place in (one.to, one.was))
    at, to = (f"({x:.4g}, {y:.4g}) mm" for x, y in (now, right))
    return f"{builds.named(one.anchor)} acts as at {at}: move it to {to}, or p by the opposite"


def _correction(one: CopyNumber) -> str:
    value, nominal = (base.amount(x, one.unit, 3) for x in (one.value, one.nominal))
    if one.unit == "m":
        return f"{one.name} acts as {value} and not {nominal}: move that anchor, or its p, back"
    relative = base.percent(abs(one.value / one.nominal - 1.0))
    side = "above" if one.value > one.nominal else "below"
    return f"{one.name} is {value}, {relative} {side} {nominal}: use another band or element"


class _Half(NamedTuple):
    """Mean forces (n,) [N] in strips of one direction, each with some strokes (n, m) [m] in it."""

    unloading: bool
    stroke: Floats
    force: Floats


class _Fit(NamedTuple):
    """A fitted copy: numbers over their standard deviations, covariance, cost, force error."""

    x: Floats
    covariance: Floats
    cost: float
    error: float


@dataclass(eq=False)
class _Model:
    """Copies of a design by numbers x: of its parts, then friction, zero, loss and shift."""

    design: Chain
    tolerances: Tolerances
    halves: Sequence[_Half]
    range: float
    varied: list[tuple[Parameter, float]] = field(init=False)
    _known: tuple[Any, list[Path]] = field(init=False)

    def __post_init__(self):
        self._known = None, []
        pairs = [(one, _spread(one, self.design, self.tolerances)) for one in self._parts()]
        self.varied = [(one, spread) for one, spread in pairs if spread > 0.0]

    def _parts(self) -> list[Parameter]:
        return [one for one in parameters_of(self.design) if one.part in _PARTS]

    def chain(self, x: Floats, hooked: Chain) -> Chain:
        """The copy with these numbers, of a design whose anchors may be in other holes."""
        steps = zip(self.varied, x.tolist(), strict=False)

        def changed(chain: Chain, step: tuple[tuple[Parameter, float], float]) -> Chain:
            (one, spread), by = step
            value: Any = one.value(chain)
            return one.changed(chain, value + spread * by)

        return reduce(changed, steps, hooked)

    def rig(self, x: Floats) -> Floats:
        """Friction [N], zero of the force [N], loss [1] and shift of the stroke [m]."""
        sizes = _FRICTION * self.range, _ZERO * self.range, _LOSS, _SHIFT
        friction, zero, loss, shift = x[len(self.varied) :] * np.array(sizes)
        return np.array([abs(friction), zero, min(abs(loss), 0.9), shift])

    def _paths(self, x: Floats, hooked: Chain) -> list[Path]:
        """Paths of all halves; those of the first numbers are kept for others of the rig."""
        key = hooked, x[: len(self.varied)].tobytes()
        if self._known[0] != key:
            copy = self.chain(x, hooked)
            self._known = key, [path_of(copy, half.unloading) for half in self.halves]
        return self._known[1]

    def gaps(self, x: Floats, hooked: Chain) -> Floats:
        """Model less measured force in all strips [N]."""
        friction, zero, loss, shift = self.rig(x)
        full, off = self.design.full_stroke, list[Floats]()
        for half, path in zip(self.halves, self._paths(x, hooked), strict=True):
            # All bands lose alike, so their order stays.
            force = on_path(path, np.clip(half.stroke - shift, 0.0, full))
            force = np.mean(force, axis=1)
            force = force * (1.0 - loss) - friction if half.unloading else force + friction
            off.append(force + zero - half.force)
        return np.concatenate(off)

    def fitted(self, hooked: Chain, start: Floats, sigma: float, steps: int) -> _Fit:
        """The most probable copy, with forces uncertain by sigma [N]."""
        from scipy.optimize import least_squares

        weight = math.sqrt(_INDEPENDENT * len(self.halves) / sum(len(h.force) for h in self.halves))
        far = 10.0

        def residuals(x: Floats) -> Floats:
            try:
                gaps = self.gaps(x, hooked)
            except StepwellError:
                gaps = np.full(sum(len(h.force) for h in self.halves), far * self.range)
            # A snap elsewhere in the stroke is far off in a few strips: they count less.
            off = gaps / sigma
            soft = np.sign(off) * np.sqrt(2.0 * (np.sqrt(1.0 + off**2) - 1.0))
            return np.concatenate([weight * soft, x])

        def slopes(x: Floats) -> Floats:
            # Steps far above the rounding of the engine, for a snap moves from strip to strip.
            here, steps_of = residuals(x), _STEP * np.eye(len(x))
            return np.stack([(residuals(x + step) - here) / _STEP for step in steps_of], axis=1)

        derivative: Any = slopes
        best = least_squares(residuals, start, derivative, max_nfev=steps)
        x = np.asarray(best.x, float)
        covariance = np.linalg.inv(best.jac.T @ best.jac)
        try:
            error = rms(self.gaps(x, hooked))
        except StepwellError:
            error = math.inf
        return _Fit(x, covariance, float(best.cost), error)


def _spread(one: Parameter, design: Chain, tolerances: Tolerances) -> float:
    """Standard deviation of a number of a copy, in its SI unit."""
    assert one.cell is not None
    own = tolerances.each(len(design))[one.cell]
    if one.part.startswith("q."):
        return own.anchor / math.sqrt(2.0)
    if one.part == "travel_scale":
        return own.travel
    value: Any = one.value(design)
    return own.stiffness * abs(float(value))


def _halves(recording: Recording, full: float) -> tuple[list[_Half], float]:
    """Strips of all halves, and the least fraction of the stroke that a direction covers."""
    stroke, force = from_zero(recording, full), without_spikes(recording.force)
    halves: list[_Half] = []
    covered = {"loading": 0.0, "unloading": 0.0}
    edges = np.linspace(_ENDS * full, (1.0 - _ENDS) * full, _STRIPS + 1)
    for half in recording.halves:
        way = recording.direction_of(half)
        u, f = stroke[half], force[half]
        covered[way] = max(covered[way], float(np.ptp(np.clip(u, 0.0, full))) / full)
        place = np.digitize(u, edges) - 1
        rows = [place == k for k in np.intersect1d(place, np.arange(_STRIPS))]
        if rows:
            strokes = np.array([np.quantile(u[row], _WITHIN) for row in rows])
            means = np.array([float(np.mean(f[row])) for row in rows])
            halves.append(_Half(way == "unloading", strokes, means))
    return halves, min(covered.values())


def copy_test(
    design: Chain,
    recording: Recording,
    tolerances: Tolerances = DEFAULT_TOLERANCES,
    *,
    target: str | None = None,
    hole: float = 0.005,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
) -> CopyTest:
    """Judge a built copy of a design from a recording of its loading and unloading.

    The most probable copy is fitted: anchors and stiffness of each cell within the tolerances, or
    one anchor in a neighbouring hole, together with friction, loss of the bands, and the zeros of
    the rig. Only q - p can be seen. Numbers count as outside if they are by more than two standard
    deviations.

    Args:
        design: the nominal design.
        recording: force against stroke of one copy, both ways.
        tolerances: of its parts.
        target: sequence; by default that of the design.
        hole: distance between holes [m].
        seed: random seed of the sampled copies.
        progress: called with (done, total) fits.

    Raises:
        LabError: the recording is not one of travel and force, or of another stroke.
        ValueError: an argument out of range.

    Source: ours (how-to "Test what you built").
    """
    base.check.whole("seed", seed, 0)
    if not 0 < hole < math.inf:
        raise InputError(f"hole = {hole} m: must be > 0, the distance between holes.")
    builds.pulls_of(recording, design.full_stroke)  # refuses another stroke
    nominal = design.cycle()
    wanted = str(nominal.sequence)
    if target is not None:
        wanted = checked_cycle(target, design.last_state, "target", design.names)
    halves, covered = _halves(recording, design.full_stroke)
    if not halves:
        raise LabError(recording.source, "has no force within the stroke of the design.")
    span = float(np.ptp(nominal.path.force))
    model, fits = _fits(_Model(design, tolerances, halves, span), hole, progress)
    likely = np.exp(min(fit.cost for _, fit in fits) - np.array([fit.cost for _, fit in fits]))
    likely /= np.sum(likely)
    order = np.argsort(-likely).tolist()
    hooks = [
        replace(one, fraction=float(likely[k]))
        for k in order
        if (one := fits[k][0]) is not None and likely[k] >= _NAMED
    ]
    hook, fit = fits[order[0]]
    hooked = design if hook is None else hook.of(design)
    copy = model.chain(fit.x, hooked)
    rng = np.random.default_rng(seed)
    left = [
        model.chain(x, hooked) for x in rng.multivariate_normal(fit.x, fit.covariance, size=_LEFT)
    ]
    friction, _, loss, _ = model.rig(fit.x).tolist()
    return CopyTest(
        design,
        wanted,
        recording.source,
        tolerances,
        str(copy.cycle().sequence),
        sum(first_build.does(one, wanted) for one in left) / _LEFT,
        copy,
        _parts(model, fit, copy),
        _switches(design, tolerances, copy, left, seed),
        hooks[0] if hook is not None else None,
        tuple(hooks[1:] if hook is not None else ()),
        fit.error,
        span,
        friction,
        loss,
        covered,
    )


def _fits(
    model: _Model, hole: float, progress: Callable[[float, float], None] | None
) -> tuple[_Model, list[tuple[builds.WrongHole | None, _Fit]]]:
    """Fits of all hypotheses, with the sign of the force that suits the design."""
    fits = _hypotheses(model, hole, _FORCE, progress)
    if _error(fits) > CLOSE_SHARE * model.range:
        # Readers turn signs by the work of a half, which a bistable copy may return.
        turned = [half._replace(force=-half.force) for half in model.halves]
        other = _Model(model.design, model.tolerances, turned, model.range)
        again = _hypotheses(other, hole, _FORCE, progress)
        if _error(again) < _error(fits):
            model, fits = other, again
    if _FORCE * model.range < _error(fits) <= CLOSE_SHARE * model.range:
        fits = _hypotheses(model, hole, _error(fits) / model.range, progress)
    return model, fits


def _error(fits: Sequence[tuple[builds.WrongHole | None, _Fit]]) -> float:
    """Least error of a fit [N]."""
    return min(fit.error for _, fit in fits)


def _hypotheses(
    model: _Model, hole: float, uncertainty: float, progress: Callable[[float, float], None] | None
) -> list[tuple[builds.WrongHole | None, _Fit]]:
    """Fits with all anchors in their holes, and with the likeliest ones in a neighbouring hole."""
    size = len(model.varied) + 4
    sigma, total = uncertainty * model.range, 1 + _FITTED
    start = np.zeros(size)
    # Friction and loss are not negative, so their derivative at 0 has no sign.
    start[[-4, -2]] = 0.2
    base.notify(progress, 0, total)
    first = model.fitted(model.design, start, sigma, 30)
    price = math.log(
        (1.0 - 2.0 * first_build.WRONG_HOLE) / (2.0 * first_build.WRONG_HOLE / len(builds.WAYS))
    )
    # What the rig adds may be that of the first fit, if its anchors are right; not its parts.
    starts = [start, np.concatenate([np.zeros(len(model.varied)), first.x[-4:]])]
    tried: list[tuple[float, Floats, builds.WrongHole]] = []
    for anchor in builds.outer_anchors(model.design):
        was = builds.place_of(anchor, model.design)
        for x, y in builds.WAYS:
            one = builds.WrongHole(anchor, was, (was[0] + hole * x, was[1] + hole * y), 0.0)
            with suppress(StepwellError):
                hooked = one.of(model.design)
                each = [model.gaps(at, hooked) / sigma for at in starts]
                costs = [float(np.sum(np.sqrt(1.0 + gaps**2))) for gaps in each]
                short = model.fitted(hooked, starts[int(np.argmin(costs))], sigma, 3)
                tried.append((short.cost, short.x, one))
    tried.sort(key=lambda row: row[0])
    fits: list[tuple[builds.WrongHole | None, _Fit]] = [(None, first)]
    for done, (_, best, one) in enumerate(tried[:_FITTED], 1):
        base.notify(progress, done, total)
        fit = model.fitted(one.of(model.design), best, sigma, 15)
        fits.append((one, fit._replace(cost=fit.cost + price)))
    return fits


def _parts(model: _Model, fit: _Fit, copy: Chain) -> tuple[CopyNumber, ...]:
    """Numbers of the parts; limits of anchors are those of p and q together."""
    doubt = np.sqrt(np.diag(fit.covariance))
    parts: list[CopyNumber] = []
    for (one, spread), sigma in zip(model.varied, doubt.tolist(), strict=False):
        nominal: Any = one.value(model.design)
        value: Any = one.value(copy)
        at = float(nominal)
        # The spread of an anchor is its tolerance over √2.
        wide = spread * (2.0 * math.sqrt(2.0) if one.part.startswith("q.") else WIDE)
        parts.append(
            CopyNumber(one.name, one.unit, at, float(value), spread * sigma, at - wide, at + wide)
        )
    return tuple(parts)


def _switches(
    design: Chain, tolerances: Tolerances, copy: Chain, left: Sequence[Chain], seed: int
) -> tuple[CopyNumber, ...]:
    """Critical forces and strokes of snaps, with their intervals over copies of the design."""
    drawing = Draws(design, tolerances, seed)
    made: list[dict[str, tuple[str, float]]] = []
    for number in range(_COPIES):
        with suppress(StepwellError):
            made.append(_events(drawing.sample(number)))
    possible: list[dict[str, tuple[str, float]]] = []
    for one in left:
        with suppress(StepwellError):
            possible.append(_events(one))
    nominal, now = _events(design), _events(copy)
    numbers: list[CopyNumber] = []
    for name, (unit, value) in now.items():
        if name not in nominal:
            continue
        copies, scatter = (
            np.array([each[name][1] for each in some if name in each]) for some in (made, possible)
        )
        if len(copies) < _COPIES / 2:
            continue
        low, high = np.quantile(copies, _ENDS_OF).tolist()
        doubt = float(np.std(scatter)) if len(scatter) else 0.0
        numbers.append(CopyNumber(name, unit, nominal[name][1], value, doubt, low, high))
    return tuple(numbers)


def _events(chain: Chain) -> dict[str, tuple[str, float]]:
    """Unit and value of the critical forces and of the strokes of the snaps of a chain."""
    events: dict[str, tuple[str, float]] = {}
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if not isinstance(cell, Element):
            events[f"F0 of {name}"] = ("N", cell.force_0)
            events[f"F1 of {name}"] = ("N", cell.force_1)
    count = {1: 0, -1: 0}
    for event in chain.cycle().snaps:
        count[event.direction] += 1
        way = "loading" if event.direction > 0 else "unloading"
        events[f"snap {count[event.direction]} {way}"] = ("m", event.drive)
    return events
