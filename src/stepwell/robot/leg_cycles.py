"""Cycles of the legs: loading and unloading through equilibria, contact phase by phase."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import groupby
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Quantity, Schema
from stepwell.mechanism import Cell, Chain, Load, value
from stepwell.robot.parts import Leg
from stepwell.robot.robot import Robot
from stepwell.robot.stance import HANDOVER, POINTS, Spring, Stance, leaning, stance, touch

# A cell within this fraction of its full travel from a stop counts as at the stop: the ground
# reaction force holds the cell of a foot a little open, and a compliant drive stops short.
TOLERANCE = 0.2

# Results of one robot of many in a cycle, see `stepwell.simulation.Trial`.
TRIAL: Schema = (
    Quantity("advance", "over_u_max", "d/u_max", form=".3f"),
    Quantity("sideways", "over_u_max"),
    Quantity("turn", "deg", "turn", form="z.1f"),
    Quantity("work", "mJ"),
    Quantity(
        "gaits",
        head="states of the last cycle",
        holds=[str],
        form=lambda gaits: " | ".join(dict.fromkeys(gait or "none" for gait in gaits)),
    ),
    Quantity("stopped"),
)


def states(share: Floats, tolerance: float = TOLERANCE) -> list[str | None]:
    """States as "01", None for samples with a cell in transit.

    `share` (n, cells) is the travel of each cell over its full travel [1]. A cell counts as at its
    stop within `tolerance`, a fraction of its travel.
    """
    at_0, at_1 = np.asarray(share < tolerance), np.asarray(share > 1.0 - tolerance)
    resting = np.asarray((at_0 | at_1).all(axis=1))
    return [
        "".join("1" if at_stop else "0" for at_stop in row) if rests else None
        for row, rests in zip(at_1, resting, strict=True)
    ]


def gait(share: Floats, tolerance: float = TOLERANCE) -> str:
    """The sequence of states in a cycle, as "00>10>11>01>00"; "" without any."""
    visited = filter(None, states(share, tolerance))
    return ">".join(state for state, _ in groupby(visited))


Extra = Mapping[int, float]
Stances = tuple[Stance, Stance]

MOST_PHASES = 16  # a foot that lands and lifts more often in one half cycle is chattering
PASSES = 3
SAMPLES = 12  # on each smooth branch
SETTLED = 1e-4  # ground reaction forces that differ by less [N] count as equal
MOST_CYCLES = 4  # the last one is used even if it does not end where it began
CLOSES = 0.02  # a cycle is closed if every cell ends within this fraction of its travel
ROUNDING = 1e-9  # strokes that differ by less [m] count as equal


class Turns(NamedTuple):
    """Begin and turning points of a cycle of a leg."""

    begin: tuple[float, ...]  # (cells,) travels [m]
    loading_end: float  # stroke at which it turns [m]
    unloading_end: float  # stroke at which it ends [m]


@dataclass(frozen=True, eq=False)
class FootPhase:
    """A part of a half cycle: stance, or flight of the foot."""

    foot: Stance
    way: int  # +1 loading, -1 unloading
    stands: bool
    weighed: float  # step at which the load on the last cell was evaluated [m]
    begin: Floats  # (cells,) travels at its start [m]
    travel: Floats  # (n, cells) [m]
    shared: Floats  # (n,) force that all cells share as they are followed [N], see `_loaded`
    added: Floats  # (k,) load of the stepping cell for the last one's, at the stance's steps [N]

    def force(self) -> Floats:
        """(n,) force of the drive on this leg's outermost block, positive outwards [N]."""
        # The same force on every cell changes no travel at a given stroke, and the cells are
        # followed without it. The drive bears it: the force along the floor on the foot, less the
        # load put on the stepping cell for the last one, and the other half of the lag.
        foot, step = self.foot, self.travel[:, :-1].sum(axis=1)
        along = foot.hold(self.load(), step) + _lag(foot.robot)
        return self.shared + self.way * along - np.interp(step, foot.step, self.added)

    def load(self) -> Floats:
        """(n,) ground reaction force of the foot [N]."""
        foot, edge = self.foot, touch(self.foot.robot)
        last, step = self.travel[:, -1], self.travel[:, :-1].sum(axis=1)
        most = np.interp(step, foot.step, foot.load)
        load = np.where(last >= edge - HANDOVER, 0.0, most)
        load[last == 0.0] = most[last == 0.0]
        between = np.flatnonzero((last < edge) & (last > edge - HANDOVER) & (last > 0.0))
        if not len(between):
            return load
        # There the balance gives the load: the one that the last cell needs to stay in place.
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
class HalfLegCycle:
    """Loading or unloading of a leg, in contact phases."""

    phases: tuple[FootPhase, ...]

    @cached_property
    def travel(self) -> Floats:
        """(n, cells) travels [m]."""
        return np.concatenate([phase.travel for phase in self.phases])

    @cached_property
    def load(self) -> Floats:
        """(n,) ground reaction force of the foot [N]."""
        return np.concatenate([phase.load() for phase in self.phases])

    @cached_property
    def force(self) -> Floats:
        """(n,) force of the drive on the outermost block, positive outwards [N]."""
        return np.concatenate([phase.force() for phase in self.phases])

    @cached_property
    def stroke(self) -> Floats:
        """(n,) of the outermost block [m]."""
        return self.travel.sum(axis=1)

    def at(self, stroke: Floats) -> tuple[Floats, Floats]:
        """(m, cells) travels [m] and (m,) loads [N] at strokes (m,) [m]."""
        order = slice(None) if self.stroke[-1] >= self.stroke[0] else slice(None, None, -1)
        axis = np.maximum.accumulate(self.stroke[order])
        columns = (*self.travel.T, self.load)
        columns_at = [np.interp(stroke, axis, column[order]) for column in columns]
        return np.stack(columns_at[:-1], axis=1), columns_at[-1]


@dataclass(frozen=True, eq=False)
class LegCycle:
    """A cycle of a leg: loading and unloading, with the stances of its foot."""

    leg: Leg
    halves: tuple[HalfLegCycle, HalfLegCycle]  # loading and unloading, as the stances of the foot
    stances: Stances
    turns: Turns
    before: "LegCycle | None" = None  # the cycle before, None for the first, from all cells at 0

    @property
    def first(self) -> "LegCycle":
        """The first cycle, which begins with every cell at 0."""
        return self if self.before is None else self.before.first

    def gait(self, tolerance: float = TOLERANCE) -> str:
        """The sequence of states, as "00>10>11>01>00"."""
        full = np.array(self.leg.chain.full_travels)
        return gait(np.concatenate([half.travel for half in self.halves]) / full, tolerance)

    def alike(self, leg: Leg, stances: Stances) -> bool:
        """Whether another leg has the same cycle: an equal leg, or its mirror image."""
        pairs = zip(self.stances, stances, strict=True)
        return self.leg.chain == leg.chain and all(own.alike(other) for own, other in pairs)


@lru_cache(maxsize=32)
def leg_cycles(robot: Robot, stiffness: float | None = None) -> tuple[LegCycle, ...]:
    """The cycle of every leg, with the other legs at the same stroke.

    `stiffness` [N/m] replaces that of the drive, if given.
    """
    setting_out = leaning(robot)
    cycles: tuple[LegCycle, ...] = ()
    for _ in range(PASSES):
        stances = [footing(robot, i, cycles, setting_out) for i in range(len(robot.legs))]
        cycles = run_leg_cycles(robot, stances, stiffness or robot.drive.stiffness)
    return cycles


def run_leg_cycles(
    robot: Robot, stances: Sequence[Stances], stiffness: float, added_force: float = 0.0
) -> tuple[LegCycle, ...]:
    """Follow all legs from all cells at 0, cycle after cycle, until a cycle ends where it began.

    The legs' outermost blocks are one carriage. The drive pushes it through a spring, against
    `added_force` [N]. At every stroke the legs are separate chains. The carriage rests where the
    spring force equals the sum of their forces, jumps where that sum falls faster than the spring
    force, and turns at the end of the command.
    """
    spring = Spring(robot.drive.amplitude, stiffness, added_force)
    begins: list[tuple[float, ...]] = [(0.0,) * len(leg.chain) for leg in robot.legs]
    cycles = _cycle(robot, stances, spring, begins)
    for _ in range(MOST_CYCLES - 1):
        ends = [tuple(cycle.halves[1].travel[-1].tolist()) for cycle in cycles]
        if all(_closes(cycle, end) for cycle, end in zip(cycles, ends, strict=True)):
            break
        try:
            after = _cycle(robot, stances, spring, ends)
        except ValueError:
            # It would begin in the middle of a jump: the next cycle is not determined.
            break
        cycles = [replace(cycle, before=past) for past, cycle in zip(cycles, after, strict=True)]
    return tuple(cycles)


def _closes(cycle: LegCycle, end: Sequence[float]) -> bool:
    """Whether a cycle ends where it began."""
    off = np.abs(np.subtract(cycle.turns.begin, end)) / np.array(cycle.leg.chain.full_travels)
    return bool(np.all(off < CLOSES))


def _cycle(
    robot: Robot, stances: Sequence[Stances], spring: Spring, begins: Sequence[tuple[float, ...]]
) -> list[LegCycle]:
    """Loading and unloading of all legs, up to the strokes that the spring reaches."""

    def run(loading_end: float, unloading_end: float) -> list[LegCycle]:
        done: list[LegCycle] = []
        for leg, feet, begin in zip(robot.legs, stances, begins, strict=True):
            turns = Turns(begin, loading_end, unloading_end)
            # Equal legs have equal cycles.
            twins = (cycle for cycle in done if cycle.turns == turns and cycle.alike(leg, feet))
            twin = next(twins, None) or run_leg_cycle(leg, feet, turns)
            done.append(replace(twin, leg=leg))
        return done

    reach = min(robot.drive.amplitude, *(leg.chain.full_stroke for leg in robot.legs))
    cycles = run(max(reach, math.fsum(begins[0])), 0.0)
    out = spring.stops(forces(cycles, 0), 1)
    if out < reach - ROUNDING:
        cycles = run(out, 0.0)
    back = spring.stops(forces(cycles, 1), -1)
    return cycles if back < ROUNDING else run(out, back)


def forces(cycles: Sequence[LegCycle], half: int) -> list[tuple[Floats, Floats]]:
    """Strokes [m] and forces [N] of every leg for a `Spring`, loading (0) or unloading (1)."""
    return [(cycle.halves[half].stroke, cycle.halves[half].force) for cycle in cycles]


def footing(robot: Robot, index: int, cycles: Sequence[LegCycle], setting_out: Floats) -> Stances:
    """Stances of the foot of one leg, loading and unloading, for given cycles of the other legs.

    Without cycles, all legs are assumed to step alike. `setting_out` (legs,) [N] is the ground
    reaction force of each foot before it has stepped.
    """
    share, leg = np.linspace(0.0, 1.0, POINTS)[:, None], robot.legs[index]
    stroke = np.linspace(0.0, leg.stroke, POINTS)
    out, back = (
        [
            # Equal legs step together, also where one alone would do otherwise at that stroke.
            share * np.append(other.chain.full_travels[:-1], 0.0)
            if not cycles or other.chain == leg.chain
            else cycles[k].first.halves[half].at(stroke)[0]
            for k, other in enumerate(robot.legs)
        ]
        for half in (0, 1)
    )
    return stance(robot, index, out, setting_out[index]), stance(robot, index, back)


def run_leg_cycle(
    leg: Leg, stances: Stances, turns: Turns, extra: Extra = MappingProxyType({})
) -> LegCycle:
    """Follow one cycle of a leg; `extra` has constant forces against the travel of cells [N]."""
    begin = np.array(turns.begin)
    out = _half(leg, stances[0], 1, begin, turns.loading_end, extra)
    try:
        back = _half(leg, stances[1], -1, out.travel[-1], turns.unloading_end, extra)
    except ValueError:
        # The foot is in stance where the drive turns: a sudden reversal of drag has no solution.
        # Without drag, loading and unloading have the same law.
        quiet = replace(stances[0], drags=False)
        stances = (quiet, quiet)
        out = _half(leg, quiet, 1, begin, turns.loading_end, extra)
        back = _half(leg, quiet, -1, out.travel[-1], turns.unloading_end, extra)
    return LegCycle(leg, (out, back), stances, turns)


def _half(
    leg: Leg, foot: Stance, way: int, begin: Floats, end: float, extra: Extra
) -> HalfLegCycle:
    """Follow one half cycle in phases, each with the foot in stance or in flight."""
    stands, weighed = bool(begin[-1] <= touch(foot.robot)), float(begin[:-1].sum())
    nothing = np.zeros_like(foot.step)
    phase = FootPhase(foot, way, stands, weighed, begin, begin[None], np.zeros(1), nothing)
    if abs(end - float(begin.sum())) < ROUNDING:
        return HalfLegCycle((phase,))
    ahead, phases = phase, list[FootPhase]()
    for _ in range(MOST_PHASES):
        try:
            phase, ahead = _phase(leg, phase, end, extra)
        except ValueError:
            if not phases:
                raise
            # It would turn in the middle of a jump, where no rest is possible: the phase goes on.
            break
        phases.append(phase)
        if not len(ahead.travel):
            return HalfLegCycle(tuple(phases))
        phase = replace(phase, stands=not phase.stands, begin=phase.travel[-1])
    # After that, or if the foot chatters: the rest of the way as in the last phase.
    return HalfLegCycle((*phases, ahead))


def _phase(leg: Leg, phase: FootPhase, until: float, extra: Extra) -> tuple[FootPhase, FootPhase]:
    """Follow until the foot lifts or lands: the phase, and its continuation past the end."""
    foot, at = phase.foot, phase.begin
    # Half a handover on either side separates stance from flight.
    margin = HANDOVER / 2 if phase.stands else -HANDOVER / 2
    taken, shared, end = at[None], np.zeros(1), 0
    for _ in range(PASSES):
        chain, added = _loaded(leg, phase, extra)
        phase = replace(phase, added=added)
        followed = chain.path([float(at.sum()), until], start=tuple(at.tolist()))
        samples = followed.resampled(SAMPLES)
        taken, shared = samples.travel, samples.force
        beyond = taken[:, -1] - touch(foot.robot) - margin
        over = beyond > 0 if phase.stands else beyond < 0
        end = int(np.argmax(over)) if over.any() else len(taken) - 1
        lands = float(taken[end, :-1].sum())
        if phase.stands or abs(foot.load_at(lands) - foot.load_at(phase.weighed)) < SETTLED:
            break
        # The foot lands at another step, under another load.
        phase = replace(phase, weighed=lands)
    end += 1
    return (
        replace(phase, travel=taken[:end], shared=shared[:end]),
        replace(phase, travel=taken[end:], shared=shared[end:]),
    )


def _lag(robot: Robot) -> float:
    """Half of the damping of a cell at the drive's mean speed [N]."""
    return robot.blocks.damping * robot.drive.amplitude / robot.drive.period


def _loaded(leg: Leg, phase: FootPhase, extra: Extra) -> tuple[Chain, Floats]:
    """The leg's chain with all forces of the floor as loads of its cells, and `added`.

    During stance, the change of the load on the last cell is put on the stepping cells with the
    opposite sign: at a given stroke both move the chain alike.
    """
    foot, way, at = phase.foot, phase.way, phase.begin
    # Damping acts on moving cells only. Half of it as friction on every cell has the same effect:
    # one half on the moving cell, one half on the cell that would start.
    lag, rails = _lag(foot.robot), foot.robot.blocks.rails(len(leg.chain))
    cells = [
        replace(cell, friction=cell.friction + lag + rail)
        for cell, rail in zip(leg.chain.levers, rails, strict=True)
    ]
    travel, load = _handing_over(foot, phase.weighed, cells[-1].full_travel)
    force = -foot.push(load, travel, phase.weighed, way)
    cells[-1] = _with_load(cells[-1], travel, force)
    added = np.zeros_like(foot.step)
    if phase.stands:
        more = foot.change(float(at[:-1].sum()), way)
        for i, cell in enumerate(cells[:-1]):
            full = cell.full_travel
            share, change = foot.step, more
            if len(cells) > 2:
                # Each of several stepping cells takes its part of a straight line.
                slope = (more[-1] - more[0]) / foot.step[-1]
                share, change = np.array([0.0, full]), slope * (np.array([0.0, full]) - at[i])
            if way > 0:
                # More weight never lifts a foot: a foot during the handover of weight lifts
                # where the stepping cell alone needs more force than at first.
                here = cell.force(cell.angle(np.append(share, at[i])))
                change = np.minimum(change, np.maximum(here[-1] - here[:-1], 0.0))
            cells[i] = _with_load(cell, share, change)
            added = change if len(cells) == 2 else more
    for i, constant in extra.items():
        if constant:
            cells[i] = _with_load(cells[i], np.zeros(1), np.array([constant]))
    return replace(leg.chain, cells=tuple(cells)), added


def _handing_over(foot: Stance, step: float, full: float) -> tuple[Floats, Floats]:
    """Travels [m] of the last cell and the load of the foot there [N]."""
    edge, load = touch(foot.robot), foot.load_at(step)
    low = edge - HANDOVER
    stood = np.linspace(0.0, low, 4) if low > 0 else np.zeros(1)
    lifted = np.linspace(edge, full, 6)[1:]
    # During the handover the drag is linear in the load, until the foot begins to slip.
    slips = foot.slips_below(step) / load if load > 0.0 else 0.0
    passing = np.array([slips, 0.0] if 0.0 < slips < 1.0 else [0.0])
    at = np.concatenate([stood, edge - HANDOVER * passing, lifted])
    carried = np.concatenate([np.full(stood.size, load), load * passing, np.zeros(lifted.size)])
    return at, carried


def _with_load(cell: Cell, travel: Floats, force: Floats) -> Cell:
    """The cell with one more load [N] against its travel, given at some travels [m]."""
    if cell.load is not None:
        both = np.unique(np.concatenate([cell.load.travel, travel]))
        force = value(cell.load.pieces(), both) + np.interp(both, travel, force)
        travel = both
    return replace(cell, load=Load(tuple(travel.tolist()), tuple(force.tolist())))
