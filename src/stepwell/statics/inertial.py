"""Landing of a snap with masses of the blocks, as a check of the overdamped landing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Measure, amount, check
from stepwell.mechanism import Chain
from stepwell.statics import integrate, outcome
from stepwell.statics.events import Event
from stepwell.statics.following.pieces import sheets_of, stand_all_on
from stepwell.statics.following.state import DrivenChain
from stepwell.statics.inertia import STILL
from stepwell.statics.landing_robustness import Place, same_place, state_of
from stepwell.statics.landings.start import Snap

# Perturbation force on the leader, as a fraction of the largest force.
_PUSH = 1e-7
# Tolerances of a step, until two agree on landing, peak speed and the balance of energy.
_TOLERANCES = 1e-6, 1e-7, 1e-8, 1e-9, 1e-10
_SPEEDS_AGREE, _ENERGIES_AGREE = 1e-2, 1e-5
# Largest distance of equal landings with friction, as a fraction of the full travel.
_NEAR = 1e-3
# Steps per call, and in total.
_ROWS, _MOST_STEPS = 1000, 300_000

# Units of mass and damping, by measure.
_UNITS = {
    Measure.TRAVEL: ("kg", "N s/m"),
    Measure.VOLUME: ("kg/m⁴", "Pa s/m³"),
    Measure.ANGLE: ("kg m²", "N m s/rad"),
}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class History(ByValue):
    """An inertial snap step by step; n steps, N cells.

    Attributes:
        time: (n,) [s], from 0.
        travel: (n, N) [m].
        speed: (n, N) of each travel [m/s].
    """

    time: Floats
    travel: Floats
    speed: Floats


@dataclass(frozen=True, slots=True, eq=False)
class InertialLanding(ByValue):
    """Landing of a snap with given masses and dampers; N cells.

    Attributes:
        event: the snap; where it passes through saddles, the first of those that follow at once.
        masses: (N,) of the block outside each cell [kg].
        damping: (N,) on the travels [N s/m].
        restitution: coefficient of restitution at a stop.
        travel, sheet: (N,) travels at rest [m], and sheets of the cells' curves.
        state: the phases there, - in transit.
        time: until less than 1e-10 of the energy remains to be dissipated [s]. Near a fold it
            depends on the size of the perturbation, as the square root or less.
        peak_speed: largest speed of any block [m/s], to one percent.
        freed: energy released by the cells and the actuator [J].
        damped, rubbed, struck, jumped: energy dissipated by dampers, friction, impacts at stops and
            jumps to other sheets [J].
        agrees: whether it equals the overdamped landing of the path.
        tie: whether a larger perturbation or a finer step changes the landing: then it depends on
            less than the precision of any real mechanism.
        steps: number of steps of the integration.
        history: travels and speeds over time, if requested.
    """

    event: Event
    masses: tuple[float, ...]
    damping: tuple[float, ...]
    restitution: float
    travel: tuple[float, ...]
    sheet: tuple[int, ...]
    state: str
    time: float
    peak_speed: float
    freed: float
    damped: float
    rubbed: float
    struck: float
    jumped: float
    agrees: bool
    tie: bool
    steps: int
    history: History | None

    @property
    def imbalance(self) -> float:
        """Certificate: error of the energy balance [J], at most 1e-5 of the released energy."""
        return self.freed - self.damped - self.rubbed - self.struck - self.jumped

    def __str__(self):
        where = "as without masses" if self.agrees else "unlike without masses"
        tie = "; a slightly larger perturbation changes the landing" if self.tie else ""
        return (
            f"lands in {self.state} after {amount(self.time, 's')}, {where}{tie}: of "
            f"{amount(self.freed, 'J')} dampers dissipate {amount(self.damped, 'J')}, impacts "
            f"{amount(self.struck, 'J')}, friction {amount(self.rubbed, 'J')}."
        )

    def __repr__(self):
        return f"InertialLanding({self.event!r}: {self})"


@dataclass(frozen=True, slots=True)
class _Run:
    motion: integrate.MotionState
    sheet: tuple[int, ...]
    history: Floats
    freed: float

    @property
    def imbalance(self) -> float:
        taken = self.motion.book[integrate.DAMPED : integrate.JUMPED + 1]
        return self.freed - float(np.sum(taken))


# Masses and dampers of all cells, and the restitution.
Inertia = tuple[Sequence[float], Sequence[float], float]


def inertial_landing(
    chain: Chain, problem: DrivenChain, snap: Snap, event: Event, inertia: Inertia, *, history: bool
) -> InertialLanding:
    """Landing of a snap with masses, as for `Path.inertial_landing`."""
    body = _body(chain, problem, snap, inertia)

    def go(tolerance: float, push: float) -> _Run:
        push *= problem.scale * snap.start.heading
        return _run(chain, problem, snap, body._replace(tolerance=tolerance, push=push))

    def alike(one: _Run, two: _Run) -> bool:
        here, there = ((r.motion.travel, np.array(r.sheet)) for r in (one, two))
        return _same(chain, problem, snap, here, there)

    fine, tie, tolerance = go(_TOLERANCES[0], _PUSH), True, 0.0
    for tolerance in _TOLERANCES[1:]:
        coarse, fine = fine, go(tolerance, _PUSH)
        speeds = coarse.motion.book[integrate.PEAK], fine.motion.book[integrate.PEAK]
        tie = not alike(coarse, fine)
        slow = abs(speeds[1] - speeds[0]) <= _SPEEDS_AGREE * speeds[1]
        if not tie and slow and abs(fine.imbalance) <= _ENERGIES_AGREE * fine.freed:
            break
    else:
        if not tie:
            raise outcome.StaticsError(
                f"the energy balance of the snap at {event.drive:.6g} with masses has an error of "
                f"{amount(fine.imbalance, 'J')}. Likely cause: masses or dampers of too different "
                f"sizes for double precision. Check their units."
            )
    tie = tie or not alike(fine, go(tolerance, 10.0 * _PUSH))
    book, rows, n = fine.motion.book, fine.history, len(chain)
    samples = np.vstack([[0.0, *snap.start.travel, *np.zeros(n)], rows[:, : 2 * n + 1]])
    travel, sheet = landed = fine.motion.travel, np.array(fine.sheet)
    return InertialLanding(
        event,
        tuple(map(float, inertia[0])),
        tuple(map(float, inertia[1])),
        body.restitution,
        tuple(travel.tolist()),
        fine.sheet,
        state_of(chain, travel, sheet),
        float(book[integrate.TIME]),
        float(book[integrate.PEAK]),
        fine.freed,
        float(book[integrate.DAMPED]),
        float(book[integrate.RUBBED]),
        float(book[integrate.STRUCK]),
        float(book[integrate.JUMPED]),
        _same(chain, problem, snap, landed, (snap.travel, snap.sheet)),
        tie,
        len(rows),
        History(samples[:, 0], samples[:, 1 : n + 1], samples[:, n + 1 :]) if history else None,
    )


def _same(chain: Chain, problem: DrivenChain, snap: Snap, here: Place, there: Place) -> bool:
    """Whether two landings are one; with friction they may differ slightly, or miss a stop."""
    near = np.array_equal(here[1], there[1]) and np.any(problem.laws.friction > 0.0)
    if near and np.all(np.abs(here[0] - there[0]) <= _NEAR * problem.laws.full):
        return True
    return same_place(chain, problem, snap, here, there)


def checked_inertia(
    chain: Chain, problem: DrivenChain, inertia: Inertia
) -> tuple[Floats, Floats, Floats, float]:
    """(N,) masses [kg], 1/mass, 0 of a block that is held, and dampers, and the restitution."""
    masses, damping, restitution = inertia
    mass_unit, damping_unit = _UNITS[chain.measure]
    n = len(chain)
    mass = check.as_many("masses", masses, mass_unit, "the chain", n)
    damper = check.as_many("damping", damping, damping_unit, "the chain", n)
    for i in range(n):
        check.positive(f"masses[{i}]", mass[i], mass_unit)
        check.not_negative(f"damping[{i}]", damper[i], damping_unit)
    restitution = check.not_negative("restitution", restitution, "1")
    if restitution >= 1.0:
        raise InputError(
            f"restitution = {restitution:g}: must be below 1, because impacts without dissipation "
            f"never end. 0 is a fully inelastic stop."
        )
    heavy = np.array(mass)
    loose = 1.0 / heavy
    if problem.beta == 0.0:
        # A rigid actuator holds the outermost block: its mass has no effect, in tolerances either.
        loose[-1], heavy[-1] = 0.0, np.min(heavy[:-1], initial=np.inf)
    return heavy, loose, np.array(damper), restitution


def _body(chain: Chain, problem: DrivenChain, snap: Snap, inertia: Inertia) -> integrate.Inertias:
    body, damper = checked_inertia(chain, problem, inertia), inertia[1]
    folds = any(len(element.laws) > 1 for element in chain.elements)
    stops = any(any(cell.stopped) for cell in chain.cells)
    if not (any(damper) or any(cell.friction for cell in chain.cells) or stops or folds):
        raise InputError(
            f"damping = {tuple(damper)!r}: there is no dissipation (no damper, no friction and no "
            f"stop), so the snap never comes to rest. Give at least one cell damping "
            f"[{_UNITS[chain.measure][1]}]."
        )
    start = snap.start
    args = start.travel.copy(), start.force, start.leader
    return integrate.Inertias(*body, *args, 0.0, 0.0, STILL)


def _run(chain: Chain, problem: DrivenChain, snap: Snap, body: integrate.Inertias) -> _Run:
    n, start, laws = len(chain), snap.start, problem.laws
    stand_all_on(laws, problem.sheets, problem.pieces, start.sheet)
    still = np.zeros(n, np.int64)
    motion = integrate.MotionState(
        start.travel.copy(), np.zeros(n), still, still.copy(), np.zeros(7)
    )
    lightest, shortest = float(np.min(body.mass)), float(np.min(laws.full))
    motion.book[integrate.STEP] = 1e-3 * math.sqrt(lightest * shortest / problem.scale)
    parts: list[Floats] = []
    status = integrate.GOES_ON
    while status == integrate.GOES_ON and len(parts) * _ROWS < _MOST_STEPS:
        rows = np.full((_ROWS, 1 + 3 * n), np.nan)
        status = integrate.integrate(problem, body, motion, rows)
        parts.append(rows[np.isfinite(rows[:, 0])])
    if status != integrate.RESTS:
        unit = _UNITS[chain.measure][1]
        raise outcome.StaticsError(
            f"with these masses the snap does not come to rest in {len(parts) * _ROWS} steps, "
            f"{amount(float(motion.book[integrate.TIME]), 's')}: too little takes its energy. Give "
            f"every cell some damping [{unit}]."
        )
    sheet, travel = tuple(sheets_of(problem.sheets).tolist()), motion.travel
    ends = zip(chain.cells, start.travel, start.sheet.tolist(), travel, sheet, strict=True)
    # Energy released by each cell, the actuator and the perturbation force.
    freed: list[float] = []
    for cell, s, on, there, to in ends:
        freed += float(cell.energy_at(s, on)), -float(cell.energy_at(there, to))
    if problem.beta > 0.0:
        way = math.fsum(travel - start.travel)
        freed.append(way * (start.force - 0.5 * problem.alpha / problem.beta * way))
    freed.append(body.push * float(travel[start.leader] - start.travel[start.leader]))
    return _Run(motion, sheet, np.concatenate(parts), math.fsum(freed))
