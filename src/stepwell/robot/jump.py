"""The jump of a hopper by statics: energy of a snap, take-off speed, bound of the height."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stepwell.base import ByValue, Floats, InputError
from stepwell.mechanism import Cell, Chain
from stepwell.robot.hopper import Hopper, Task, loaded
from stepwell.statics import Event, EventKind, Path


@dataclass(frozen=True, slots=True, eq=False)
class Release(ByValue):
    """The snap of a loading stroke that sets free most energy for the foot.

    Attributes:
        stroke: of the rod at the snap [m].
        energy: set free by springs and load together at that stroke, E_w [J], friction included.
        foot_travel: of the foot against the body during the snap, Δ [m].
        load: constant force against that travel [N].
        before, after: (N,) travels of the cells [m].
        stored: energy of the springs just before the snap [J].
        peak_force: largest force of the actuator in a full cycle, in size [N].
        largest_force, least_force: largest and least force of the actuator in a full cycle [N].
        returned: energy set free by the strongest snap of the return stroke [J].
        ratio: ε [1], energy set free by the springs over k S², of the stiffest band and the
            longest travel of the chain.
    """

    stroke: float
    energy: float
    foot_travel: float
    load: float
    before: tuple[float, ...]
    after: tuple[float, ...]
    stored: float
    peak_force: float
    largest_force: float
    least_force: float
    returned: float
    ratio: float

    @property
    def of_springs(self) -> float:
        """Energy set free by the springs alone, ε k S² = E_w + load Δ [J]."""
        return self.energy + self.load * self.foot_travel


def release(chain: Chain, foot_after: int = 1, load: float = 0.0) -> Release | None:
    """The strongest snap of a loading stroke that moves the foot away; None for no such snap.

    Exact: a full cycle of the loaded chain is followed through its equilibria, and the snap ends
    at fixed stroke. The foot is the block after `foot_after` cells; `load` [N] acts on all cells
    before it.

    Args:
        chain: lever cells, inner first, under a rigid actuator.
        foot_after: number of cells between body and foot.
        load: constant force against the travel of the foot [N].

    Raises:
        StaticsError: the path of the chain could not be computed.
    """
    path = loaded(chain, foot_after, load).path([0.0, chain.full_stroke, 0.0])
    best: Release | None = None
    for event in path.events:
        if event.kind is EventKind.SNAP and event.direction > 0:
            one = _release_of(event, chain, path, foot_after, load)
            if one.foot_travel > 0.0 and (best is None or one.energy > best.energy):
                best = one
    return best


def _release_of(event: Event, chain: Chain, path: Path, foot: int, load: float) -> Release:
    travels = _before(path, event)
    after = travels.copy()
    after[list(event.cells)] = event.after
    moved = float((after - travels)[:foot].sum())
    stored, left = (
        math.fsum(float(cell.energy_at(s)) for cell, s in zip(chain.cells, place, strict=True))
        for place in (travels, after)
    )
    stiffest = max(band.stiffness for cell in chain.levers for band in cell.bands)
    unit = stiffest * max(chain.full_travels) ** 2
    forces = path.force
    return Release(
        stroke=event.stroke,
        energy=stored - left - load * moved,
        foot_travel=moved,
        load=load,
        before=tuple(travels.tolist()),
        after=tuple(after.tolist()),
        stored=stored,
        peak_force=float(np.abs(forces).max()),
        largest_force=float(forces.max()),
        least_force=float(forces.min()),
        returned=max((one.released for one in path.events if one.direction < 0), default=0.0),
        ratio=(stored - left) / unit,
    )


def _before(path: Path, event: Event) -> Floats:
    """(N,) travels of all cells [m] just before a snap."""
    snaps = [one for one in path.events if one.kind is EventKind.SNAP]
    samples = np.flatnonzero(path.snap_after)
    return np.array(path.travel[samples[snaps.index(event)]])


@dataclass(frozen=True, slots=True, eq=False)
class JumpBound(ByValue):
    """Upper bound of what a snap gives: no damper, no friction, an inelastic stop.

    Attributes:
        release: the snap.
        speed_at_stop: of the moved mass against the other one when the foot reaches its stop [m/s].
        speed: at take-off, of the centre of mass, of the ball, or of the hammer [m/s].
        energy: kinetic energy of the flight or of the blow [J].
        height: of the flight above take-off [m].
        distance: of a jump or throw on level ground [m].
    """

    release: Release
    speed_at_stop: float
    speed: float
    energy: float
    height: float
    distance: float

    @property
    def efficiency(self) -> float:
        """Energy that flies over the energy that the springs set free [1]."""
        return self.energy / self.release.of_springs


def bound_of(hopper: Hopper, snap: Release) -> JumpBound:
    """The bound of a hopper for one of its snaps.

    The moved mass m gets E_w = ½ m v². A jumper shares its momentum with the foot at the stop, so
    that E = (m_b / M) E_w flies and h = (m_b / M) E_w / (M g) along the tilt.
    """
    return after_stop(hopper, snap, math.sqrt(2.0 * snap.energy / hopper.moved))


def after_stop(hopper: Hopper, snap: Release, speed_at_stop: float) -> JumpBound:
    """Take-off and flight from the speed of the moved mass at the stop [m/s]."""
    energy = hopper.useful * 0.5 * hopper.moved * speed_at_stop**2
    return flight(hopper, snap, math.sqrt(2.0 * energy / hopper.flying), speed_at_stop)


def flight(
    hopper: Hopper, snap: Release, speed: float, speed_at_stop: float = math.nan
) -> JumpBound:
    """Energy, height and distance of a flight or a blow with a speed [m/s]."""
    energy = 0.5 * hopper.flying * speed**2
    height = distance = 0.0
    if hopper.task is not Task.STRIKE:
        up, along = speed * math.cos(hopper.tilt), speed * math.sin(hopper.tilt)
        height = up**2 / (2.0 * hopper.gravity) if hopper.gravity else math.inf
        distance = 2.0 * up * along / hopper.gravity if hopper.gravity else math.inf
    return JumpBound(snap, speed_at_stop, speed, energy, height, distance)


_STEPS = 2000  # of the travel of a snap
GIVE = 1e-3  # travel in which a part takes an impact, for its mean force [m]


@dataclass(frozen=True, slots=True, eq=False)
class Impact(ByValue):
    """An impact that parts have to bear.

    Attributes:
        name: of the impact.
        energy: that the parts take at most [J].
    """

    name: str
    energy: float

    @property
    def mean_force(self) -> float:
        """Mean force [N] on parts that give way by 1 mm; half the way doubles it."""
        return self.energy / GIVE


def impacts(hopper: Hopper, bound: JumpBound) -> tuple[Impact, ...]:
    """The impacts of one jump, throw or blow, from the bound without losses.

    Forces in a simulation depend on its contact time and are no design numbers; energies are.
    """
    stop = 0.5 * hopper.moved * bound.speed_at_stop**2
    if hopper.task is Task.STRIKE:
        first = [Impact("blow of the block", bound.energy)]
    else:
        first = [Impact("stop of the snap", stop - bound.energy)]
    if hopper.task is Task.JUMP:
        first.append(Impact("landing", bound.energy))
    return (*first, Impact("return snap", bound.release.returned))


def moving_force(cell: Cell, travel: Floats, loss: float, way: int) -> Floats:
    """Force of a moving cell [N] at travels [m], whose bands lose a fraction of the loading work.

    A band that contracts pulls with 1 - `loss` of its tension; `way` is +1 for rising travel. The
    loop of a band between any two lengths loses this fraction of the loading work.
    """
    theta = cell.angle(travel)
    total = cell.force(theta) - sum(band.force(theta, cell.lever) for band in cell.bands)
    for band in cell.bands:
        force = band.force(theta, cell.lever)
        total = total + np.where(force * way < 0.0, (1.0 - loss) * force, force)
    return np.asarray(total, float)


def onset(hopper: Hopper, snap: Release) -> float:
    """Travel of the foot [m] at which it snaps, for a hopper of two cells with losses.

    Until then the rod pulls the foot along: the cell behind it, whose band loses tension where it
    contracts, has to overcome the cell before it. That of the stop if there is no snap.

    Raises:
        ValueError: a chain of more than two cells, whose snaps have no single travel.
    """
    if len(hopper.chain) != 2:
        raise InputError("chain: must have two cells; the snaps of more have no single travel.")
    travel = np.linspace(snap.before[0], snap.after[0], _STEPS + 1)
    net = _net(hopper, travel, np.full(_STEPS + 1, snap.before[1]))
    there = np.flatnonzero(net >= -1e-9 * float(np.abs(net).max()))
    return float(travel[there[0]]) if len(there) else snap.after[0]


def predicted_stop(hopper: Hopper, snap: Release) -> float:
    """Speed of the moved mass at the stop [m/s], with dampers, friction and losses of the springs.

    One mass between two cells at a fixed stroke, m s̈ = F_behind - F_before - load - 2 c ṡ - f; the
    floor holds the other mass. 0 if the foot does not arrive.

    Raises:
        ValueError: a chain of more than two cells, whose snaps have no single travel.
    """
    start, end = onset(hopper, snap), snap.after[0]
    travel = np.linspace(start, end, _STEPS + 1)
    behind = np.maximum(snap.before[1] - (travel - start), 0.0)
    net = _net(hopper, travel, behind)
    return _end_speed(net, (end - start) / _STEPS, hopper.moved, 2.0 * hopper.damping)


def _net(hopper: Hopper, travel: Floats, behind: Floats) -> Floats:
    """Force on the foot [N] that moves out, at travels [m] of the cells before and behind it."""
    inner, outer = hopper.loaded.levers
    loss, friction = hopper.springs.loss, inner.friction + outer.friction
    pull = moving_force(outer, behind, loss, -1) - moving_force(inner, travel, loss, 1)
    return np.asarray(pull - friction, float)


def _end_speed(net: Floats, step: float, mass: float, damping: float) -> float:
    """Speed at the end of a travel [m/s], by Heun's method for v²/2 over the travel."""
    half = 0.0  # v²/2

    def slope(force: float, at: float) -> float:
        return (force - damping * math.sqrt(2.0 * max(at, 0.0))) / mass

    forces = net.tolist()
    for here, there in pairwise(forces):
        first = slope(here, half)
        half = max(half + step * (first + slope(there, half + step * first)) / 2.0, 0.0)
    return math.sqrt(2.0 * half)
