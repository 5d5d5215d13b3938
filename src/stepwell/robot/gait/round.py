"""One round of a leg: out and back through its equilibria, stance by stance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepwell.mechanism import Chain, Load, curves
from stepwell.robot.gait.stance import POINTS, Stance, leaning, stance, touch
from stepwell.robot.gait.standing import HANDOVER
from stepwell.robot.gait.states import TOLERANCE, gait
from stepwell.robot.parts import Leg, Robot

Array = NDArray[np.float64]

MOST_PHASES = 16  # a foot that lands and lifts more often in one way is chattering
PASSES = 3
SAMPLES = 12  # on each smooth branch
SETTLED = 1e-4  # weights that differ by less [N] are the same


@dataclass(frozen=True, eq=False)
class Phase:
    """A part of a way in which the foot stands, or is in the air.

    Attributes:
        foot: how it stands, where it does.
        way: +1 out, -1 back.
        stands: whether it does.
        weighed: step at which the weight was taken that the last cell feels [m].
        begin: (cells,) travels at its start [m].
        travel: (n, cells) [m].
    """

    foot: Stance
    way: int
    stands: bool
    weighed: float
    begin: Array
    travel: Array

    def load(self) -> Array:
        """(n,) force of the floor on the foot [N]."""
        foot, edge = self.foot, touch(self.foot.robot)
        last, step = self.travel[:, -1], self.travel[:, :-1].sum(axis=1)
        most = np.interp(step, foot.step, foot.load)
        load = np.where(last >= edge - HANDOVER, 0.0, most)
        load[last == 0.0] = most[last == 0.0]
        between = np.flatnonzero((last < edge) & (last > edge - HANDOVER) & (last > 0.0))
        if not len(between):
            return load
        # There the balance says how much: what the last cell needs to stay where it is.
        at, carried = _handing_over(foot, self.weighed, 2 * edge)
        need = foot.push(np.interp(last[between], at, carried), edge, self.weighed, self.way)
        if self.stands:
            start = float(self.begin[:-1].sum())
            need = need + np.interp(step[between], foot.step, foot.change(start, self.way))
        part = np.linspace(0.0, 1.0, 65)
        grid = part * most[between, None]
        pushed = foot.push(grid, edge, step[between, None], self.way)
        load[between] = [np.interp(n, p, g) for n, p, g in zip(need, pushed, grid, strict=True)]
        return load


@dataclass(frozen=True, eq=False)
class HalfRound:
    """A leg's way out or back, in phases."""

    phases: tuple[Phase, ...]

    @cached_property
    def travel(self) -> Array:
        """(n, cells) travels [m]."""
        return np.concatenate([phase.travel for phase in self.phases])

    @cached_property
    def load(self) -> Array:
        """(n,) force of the floor on the foot [N]."""
        return np.concatenate([phase.load() for phase in self.phases])

    @cached_property
    def stroke(self) -> Array:
        """(n,) of the actuator [m]."""
        return self.travel.sum(axis=1)

    def at(self, stroke: Array) -> tuple[Array, Array]:
        """(m, cells) travels [m] and (m,) loads [N] at strokes (m,) [m]."""
        order = slice(None) if self.stroke[-1] >= self.stroke[0] else slice(None, None, -1)
        axis = np.maximum.accumulate(self.stroke[order])
        columns = (*self.travel.T, self.load)
        found = [np.interp(stroke, axis, column[order]) for column in columns]
        return np.stack(found[:-1], axis=1), found[-1]


@dataclass(frozen=True, eq=False)
class Round:
    """A leg's way out and back."""

    leg: Leg
    out: HalfRound
    back: HalfRound
    stances: tuple[Stance, Stance]

    @property
    def ways(self) -> tuple[HalfRound, HalfRound]:
        """Out, back."""
        return self.out, self.back

    def gait(self, tolerance: float = TOLERANCE) -> str:
        """The states visited, as "00>10>11>01>00"."""
        full = np.array([cell.full_travel for cell in self.leg.chain.cells])
        share = np.concatenate([self.out.travel, self.back.travel]) / full
        return gait(share, tolerance)


def rounds(robot: Robot) -> list[Round]:
    """The round of every leg, each with the others where they are at the same stroke."""
    grid = [_together(robot.legs)] * len(robot.legs)
    setting_out = leaning(robot)
    found: list[Round] = []
    for turn in range(PASSES):
        if turn:
            grid = [_beside(leg, found) for leg in robot.legs]
        found = [
            go_round(robot, leg, (stance(robot, i, out, load), stance(robot, i, back)))
            for i, (leg, load, (out, back)) in enumerate(
                zip(robot.legs, setting_out, grid, strict=True)
            )
        ]
    return found


def stances_beside(robot: Robot, index: int, found: Sequence[Round]) -> tuple[Stance, Stance]:
    """How the foot of one leg stands, out and back, while the other legs go as found.

    Args:
        robot: the one that was found, or with another foot or floor.
        index: of the leg.
        found: the round of each leg.
    """
    out, back = _beside(robot.legs[index], found)
    setting_out = leaning(robot)[index]
    return stance(robot, index, out, setting_out), stance(robot, index, back)


def _together(legs: Sequence[Leg]) -> tuple[list[Array], list[Array]]:
    """All legs stepping alike."""
    share = np.linspace(0.0, 1.0, POINTS)[:, None]
    alike = [
        share * np.array([*(c.full_travel for c in one.chain.cells[:-1]), 0.0]) for one in legs
    ]
    return alike, alike


def _beside(leg: Leg, found: Sequence[Round]) -> tuple[list[Array], list[Array]]:
    """Where the legs are at the strokes at which this one has stepped and its foot stands."""
    stroke = np.linspace(0.0, leg.stroke, POINTS)
    ways = [one.out.at(stroke)[0] for one in found], [one.back.at(stroke)[0] for one in found]
    together, _ = _together([one.leg for one in found])
    for i, (one, alike) in enumerate(zip(found, together, strict=True)):
        # Like legs step together, whatever either would do at that stroke alone.
        if one.leg.chain == leg.chain:
            ways[0][i], ways[1][i] = alike, alike
    return ways


def go_round(
    robot: Robot, leg: Leg, stances: tuple[Stance, Stance], extra: Array | None = None
) -> Round:
    """Follow a leg from all cells at 0 to the drive's amplitude and back.

    Args:
        robot: whose weight and floor.
        leg: of this robot, or with anchors moved.
        stances: how its foot stands on the way out and back.
        extra: (cells,) constant force against travel to add [N].

    Raises:
        StaticsError: the engine could not go on; its text says what to do.
    """
    extra = np.zeros(len(leg.chain)) if extra is None else extra
    reach = min(robot.drive.amplitude, leg.chain.full_stroke)
    begin = np.zeros(len(leg.chain))
    out = _way(leg, stances[0], 1, begin, reach, extra)
    if out.travel[-1, -1] <= touch(robot):
        # The foot still stands where the drive turns, and the drag cannot change over from one
        # way to the other in no time; without it both ways have one law.
        quiet = replace(stances[0], drags=False)
        stances = (quiet, quiet)
        out = _way(leg, quiet, 1, begin, reach, extra)
    back = _way(leg, stances[1], -1, out.travel[-1], 0.0, extra)
    return Round(leg, out, back, stances)


def _way(leg: Leg, foot: Stance, way: int, begin: Array, until: float, extra: Array) -> HalfRound:
    """Follow one way in phases, in each of which the foot stands or is in the air."""
    edge = touch(foot.robot)
    stands = bool(begin[-1] <= edge)
    at, ahead = begin, begin[:0]
    weighed = float(at[:-1].sum())
    phases: list[Phase] = []
    for _ in range(MOST_PHASES):
        try:
            taken, end, weighed = _phase(leg, foot, way, at, until, stands, weighed, extra)
        except ValueError:
            if not phases:
                raise
            # It turns in the middle of a jump, where it cannot rest: it goes on as it did.
            phases.append(replace(phases[-1], travel=ahead))
            break
        phases.append(Phase(foot, way, stands, weighed, at, taken[: end + 1]))
        if end == len(taken) - 1:
            break
        at, ahead, stands = taken[end], taken[end + 1 :], not stands
    else:
        # It chatters: the rest of the way as it was last seen.
        phases.append(replace(phases[-1], travel=ahead))
    return HalfRound(tuple(phases))


def _phase(
    leg: Leg,
    foot: Stance,
    way: int,
    at: Array,
    until: float,
    stands: bool,
    weighed: float,
    extra: Array,
) -> tuple[Array, int, float]:
    """Follow until the foot lifts or lands.

    Returns:
        (n, cells) travels [m]; the number of the sample at which the phase ends; the step at
        which the weight was taken that the last cell feels [m].
    """
    # Half a handover either side tells a foot that stands from one that does not.
    margin = HANDOVER / 2 if stands else -HANDOVER / 2
    taken, end = at[None], 0
    for _ in range(PASSES):
        chain = loaded(leg, foot, way, at, stands, weighed, extra)
        followed = chain.path([float(at.sum()), until], start=tuple(at.tolist()))
        taken = followed.resampled(SAMPLES).travel
        beyond = taken[:, -1] - touch(foot.robot) - margin
        over = beyond > 0 if stands else beyond < 0
        end = int(np.argmax(over)) if over.any() else len(taken) - 1
        lands = float(taken[end, :-1].sum())
        if stands or abs(foot.load_at(lands) - foot.load_at(weighed)) < SETTLED:
            break
        # It comes down elsewhere, under another weight.
        weighed = lands
    return taken, end, weighed


def loaded(
    leg: Leg, foot: Stance, way: int, at: Array, stands: bool, weighed: float, extra: Array
) -> Chain:
    """The leg's chain with all that the floor does to it, as loads of its cells.

    The last cell feels the weight that the foot carries at the step `weighed` [m]. While it
    stands, the change of that from where it is, `at`, is a load on the cells that step: at a
    given stroke the same force against those moves the chain as much as it would for the last.
    """
    robot = foot.robot
    speed = 2.0 * robot.drive.amplitude / robot.drive.period
    # Damping holds back what moves and not what rests. Half of it as friction on every cell
    # makes that difference: one half on the cell that moves, one on the cell that would start.
    lag = robot.blocks.damping * speed / 2
    cells = [replace(cell, friction=cell.friction + lag) for cell in leg.chain.cells]
    travel, load = _handing_over(foot, weighed, cells[-1].full_travel)
    force = -foot.push(load, travel, weighed, way)
    cells[-1] = replace(cells[-1], load=_sum(cells[-1].load, travel, force))
    if stands:
        more = foot.change(float(at[:-1].sum()), way)
        for i, cell in enumerate(cells[:-1]):
            full = cell.full_travel
            share, change = foot.step, more
            if len(cells) > 2:
                # Of several stepping cells each takes its part of a straight line.
                slope = (more[-1] - more[0]) / foot.step[-1]
                share, change = np.array([0.0, full]), slope * (np.array([0.0, full]) - at[i])
            if way > 0:
                # More weight never lifts a foot: as a foot of which the weight is passing over
                # is lifted where the stepping cell alone needs more force than at first.
                here = cell.force(cell.angle(np.append(share, at[i])))
                change = np.minimum(change, np.maximum(here[-1] - here[:-1], 0.0))
            cells[i] = replace(cell, load=_sum(cell.load, share, change))
    for i in np.flatnonzero(extra).tolist():
        constant = _sum(cells[i].load, np.zeros(1), extra[i : i + 1])
        cells[i] = replace(cells[i], load=constant)
    return replace(leg.chain, cells=tuple(cells))


def _handing_over(foot: Stance, step: float, full: float) -> tuple[Array, Array]:
    """Travels [m] of the last cell and what the foot carries there [N]."""
    edge, load = touch(foot.robot), foot.load_at(step)
    low = edge - HANDOVER
    stood = np.linspace(0.0, low, 4) if low > 0 else np.zeros(1)
    lifted = np.linspace(edge, full, 6)[1:]
    # As the weight passes over, the drag is straight in it up to where the foot begins to slip.
    slips = foot.slips_below(step) / load if load > 0.0 else 0.0
    passing = np.array([slips, 0.0] if 0.0 < slips < 1.0 else [0.0])
    at = np.concatenate([stood, edge - HANDOVER * passing, lifted])
    carried = np.concatenate([np.full(stood.size, load), load * passing, np.zeros(lifted.size)])
    return at, carried


def _sum(first: Load | None, travel: Array, force: Array) -> Load:
    if first is not None:
        both = np.unique(np.concatenate([first.travel, travel]))
        force = curves.value(first.pieces(), both) + np.interp(both, travel, force)
        travel = both
    return Load(tuple(travel.tolist()), tuple(force.tolist()))
