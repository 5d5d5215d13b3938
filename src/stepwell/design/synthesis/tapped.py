"""Chains with two actuators: one at the end, and one that holds a block between two cells."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise, product
from typing import Any

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Progress, notify, to_unit
from stepwell.design.requirements import Requirements
from stepwell.design.synthesis.designed import Design, Impossible
from stepwell.design.synthesis.inverse import design, lever_choices, of_each_cell
from stepwell.design.synthesis.region import PAPER_BAND, BandType, pooled
from stepwell.mechanism import Chain
from stepwell.sequences import Program


@dataclass(frozen=True, eq=False)
class TappedDesign(ByValue):
    """A chain that two actuators lead through a walk of states.

    Both actuators prescribe positions: the tap that of the block behind `tap` cells, the end that
    of the outermost block. So the cells on both sides of the tap are two chains that do not act on
    each other. Two actuators at both ends would add a translation only: the forces of all cells
    depend on the distance of the ends.

    Attributes:
        walk: states of all cells, inner cell first; from each to the next one cell moves.
        tap: number of cells within the tap.
        inner, outer: designs of the cells within and beyond the tap.
        single: why one actuator cannot follow the walk; "" if it can.
        proved: whether `single` is proved.
    """

    walk: tuple[str, ...]
    tap: int
    inner: Design = field(repr=False)
    outer: Design = field(repr=False)
    single: str = field(repr=False)
    proved: bool

    @cached_property
    def chain(self) -> Chain:
        """All cells in series, inner first."""
        sides = (*self.inner.chain.cells, *self.outer.chain.cells)
        cells = [replace(cell, name=f"cell {k}") for k, cell in enumerate(sides, 1)]
        return Chain(cells, title=f"Two actuators for {'>'.join(self.walk)}")

    @property
    def fraction(self) -> float:
        """Fraction of samples that follow the walk: both sides are independent [1]."""
        return _fraction((self.inner, self.outer))

    @property
    def positions(self) -> Floats:
        """(n, 2) positions of the tap and of the end at each state of the walk [m]."""
        full = np.array(self.chain.full_travels)
        stood = np.array([[int(digit) for digit in state] for state in self.walk]) * full
        return np.column_stack([stood[:, : self.tap].sum(axis=1), stood.sum(axis=1)])

    @property
    def strokes(self) -> Floats:
        """(n, 2) strokes of the cells within and beyond the tap at each state of the walk [m]."""
        tap, end = self.positions.T
        return np.column_stack([tap, end - tap])

    def simulate(self) -> tuple[str, ...]:
        """The states by the engine: both sides follow their strokes from step to step."""
        sides = (
            (self.inner.chain, self.walk[0][: self.tap]),
            (self.outer.chain, self.walk[0][self.tap :]),
        )
        shown: list[list[str]] = []
        for (chain, state), strokes in zip(sides, self.strokes.T, strict=True):
            states = [state]
            for drives in pairwise(strokes.tolist()):
                if drives[0] != drives[1]:
                    passed = Program.given(chain, drives, start=states[-1]).sequence
                    states.append(str(passed).rpartition(">")[2])
                else:
                    states.append(states[-1])
            shown.append(states)
        return tuple(map("".join, zip(*shown, strict=True)))

    def __str__(self):
        rows = [
            f"{state}: tap {to_unit(tap, 'mm'):.4g} mm, end {to_unit(end, 'mm'):.4g} mm"
            for state, (tap, end) in zip(self.walk, self.positions, strict=True)
        ]
        return "\n".join([f"tap after cell {self.tap}", *rows])


def design_tapped(
    walk: str | Sequence[str], *, progress: Progress = None, **how: Any
) -> TappedDesign:
    """Find a chain that two actuators, one at the end and one at a tap, lead through a walk.

    Every place of the tap is tried, and the largest yield chosen.

    Args:
        walk: states from all cells at 0 on, such as "00>10>00>01>00"; each step moves one cell.
        progress: called with (done, total) places of the tap.
        how: further arguments of `design`, for both sides: bands, levers, regions, tolerances.
            What is given cell by cell is for all cells. Both sides share packs of bands.

    Raises:
        Impossible: no place of the tap allows the walk, with the contradictory steps of each.
        InputError: steps that move no cell or several, or states that do not fit.

    Source: ours (theory page, "Two actuators").
    """
    states = _checked(walk)
    single, proved = _single(states)
    found: list[TappedDesign] = []
    failed: list[Impossible] = []
    taps = range(1, len(states[0]))
    for done, tap in enumerate(taps):
        notify(progress, done, len(taps))
        sides = [_Side.of(states, part, how) for part in (slice(0, tap), slice(tap, None))]
        pair = _best_pair(sides[0], sides[1])
        if isinstance(pair, Impossible):
            failed.append(pair)
            continue
        made = TappedDesign(states, tap, *pair, single, proved)
        if made.simulate() == states:
            found.append(made)
    notify(progress, len(taps), len(taps))
    if not found:
        reasons = "; ".join(f"tap after cell {k}: {one.why}" for k, one in enumerate(failed, 1))
        sure = len(failed) == len(taps) and all(why.proved for why in failed)
        raise Impossible(">".join(states), f"no place of a tap allows it; {reasons}", proved=sure)
    return max(found, key=lambda one: one.fraction)


_Room = tuple[int | None, ...]
"""Number of bands of each type that a side may take; None for any."""


@dataclass
class _Side:
    """The designs of the cells within or beyond a tap, by the bands that they may take."""

    steps: tuple[str, ...]
    cells: int
    how: dict[str, Any]
    bands: tuple[BandType, ...]  # without packs
    packs: _Room
    designs: dict[_Room, Design | Impossible] = field(default_factory=dict)

    @classmethod
    def of(cls, states: Sequence[str], part: slice, how: dict[str, Any]) -> "_Side":
        """The cells of a part of a walk, with what is given for them."""
        bands = pooled(how.get("bands", (PAPER_BAND,)))
        own = dict(how)
        if "tolerances" in how:
            how["tolerances"].each(len(states[0]))  # refuses another number of cells
            own["tolerances"] = how["tolerances"].of_cells(part)
        if "lever" in how:
            choices = of_each_cell(lever_choices(how["lever"]), len(states[0]))
            own["lever"] = [one[part] for one in choices]
        if isinstance(how.get("within"), list | tuple):
            own["within"] = how["within"][part] if len(how["within"]) > 1 else how["within"]
        steps = _steps([state[part] for state in states])
        cells = len(states[0][part])
        kinds = tuple(replace(band, pack=None) for band in bands)
        return cls(steps, cells, own, kinds, tuple(band.pack for band in bands))

    def room(self, left: _Room) -> _Room:
        """Of the bands that are left, no more than all cells can take."""
        most = self.cells * self.how.get("most_bands", 1)
        return tuple(None if one is None else min(one, most) for one in left)

    def design(self, room: _Room) -> Design | Impossible:
        """The best design with these bands, or why there is none."""
        for larger, known in self.designs.items():
            if not _fits(room, larger):
                continue
            if isinstance(known, Impossible):
                if known.proved:
                    return known
            elif _fits(self.used(known), room):
                return known
        self.designs[room] = self._searched(room)
        return self.designs[room]

    def used(self, made: Design) -> _Room:
        """Number of bands of each type in a design."""
        return tuple(
            sum(count for own, count in made.bands if replace(own, pack=None) == band)
            for band in self.bands
        )

    def _searched(self, room: _Room) -> Design | Impossible:
        bands = [
            replace(band, pack=held)
            for band, held in zip(self.bands, room, strict=True)
            if held != 0
        ]
        text = "; ".join(self.steps)
        if not bands:
            return Impossible(text, "no band is left for these cells", proved=True)
        try:
            how: dict[str, Any] = self.how | {"bands": bands}
            return design(requirements=self.steps, **how)
        except Impossible as why:
            conflict = _conflict(self.steps)
            return Impossible(text, conflict, proved=why.proved) if conflict else why


def _fits(used: _Room, room: _Room) -> bool:
    """Whether a room holds no more than another."""
    return all(
        held is None or (one is not None and one <= held)
        for one, held in zip(used, room, strict=True)
    )


_Pair = tuple[Design, Design]


def _best_pair(inner: _Side, outer: _Side) -> _Pair | Impossible:
    """Designs of both sides that share the packs, with the largest yield, or why there are none.

    With all bands for each, the packs may hold what both take. Otherwise they are divided in every
    way: what one side does not get, the other one may take.
    """
    why, proved = "", True
    best: _Pair | None = None
    for rooms in _divided(inner, outer):
        first, second = inner.design(rooms[0]), outer.design(rooms[1])
        if isinstance(first, Impossible) or isinstance(second, Impossible):
            failed = first if isinstance(first, Impossible) else second
            assert isinstance(failed, Impossible)
            why, proved = failed.why, proved and failed.proved
            continue
        if best is None or _fraction((first, second)) > _fraction(best):
            best = first, second
    if best is not None:
        return best
    text = "; ".join((*inner.steps, *outer.steps))
    return Impossible(text, why, proved=proved)


def _divided(inner: _Side, outer: _Side) -> Iterator[tuple[_Room, _Room]]:
    """Numbers of bands for each side: all for both if this decides, else every division."""
    packs = inner.packs
    whole = inner.room(packs), outer.room(packs)
    alone = inner.design(whole[0]), outer.design(whole[1])
    if any(isinstance(one, Impossible) for one in alone):
        yield whole
        return
    for first in product(*([None] if one is None else range(one + 1) for one in whole[0])):
        left = zip(packs, first, strict=True)
        rest = tuple(None if held is None else held - (one or 0) for held, one in left)
        yield first, outer.room(rest)


def _fraction(pair: _Pair) -> float:
    """Fraction of samples of which both sides are right [1]."""
    return pair[0].yield_.fraction * pair[1].yield_.fraction


def _checked(walk: str | Sequence[str]) -> tuple[str, ...]:
    """The states of a walk; InputError unless it begins at 0 and moves one cell a step."""
    states = tuple(walk.replace(" ", "").split(">") if isinstance(walk, str) else walk)
    cells = len(states[0]) if states else 0
    right = cells > 1 and all(len(one) == cells and not {*one} - {"0", "1"} for one in states)
    if not right or len(states) < 2 or states[0] != "0" * cells:
        raise InputError(
            f"walk = {'>'.join(states)!r}: must be two states or more of one length, of digits 0 "
            f"and 1 for two cells or more, with > between them, as in 00>10>00>01>00; the first "
            f"one has all cells at 0."
        )
    for one, other in pairwise(states):
        moved = sum(a != b for a, b in zip(one, other, strict=True))
        if moved != 1:
            raise InputError(
                f"walk: {one}>{other} moves {moved} cells: give a state for the motion of each."
            )
    return states


def _steps(states: Sequence[str]) -> tuple[str, ...]:
    """The steps of a walk as requirements, without those that move no cell."""
    steps = (f"{one} to {other}" for one, other in pairwise(states) if one != other)
    return tuple(dict.fromkeys(steps)) or (f"state {states[0]}",)


def _single(states: Sequence[str]) -> tuple[str, bool]:
    """Why one actuator cannot follow a walk, and whether this is proved; "" if it can.

    With every cell at a stop the chain has one configuration. So an increase of the stroke leads
    to one next state, and a decrease to one.
    """
    leads: dict[tuple[str, bool], str] = {}
    for one, other in pairwise(states):
        loading = other.count("1") > one.count("1")
        before = leads.setdefault((one, loading), other)
        if before != other:
            way = "loading" if loading else "unloading"
            return (
                f"{way} from {one} leads to {before} and to {other}, but with every cell at a stop "
                f"the chain has one configuration, from which one stroke leads to one state",
                True,
            )
    conflict = _conflict(_steps(states))
    return conflict, bool(conflict)


def _conflict(steps: Sequence[str]) -> str:
    """The contradictory steps of one actuator in words; "" for none."""
    conflict = Requirements.parse(steps).conflict
    shown = "; ".join(f"'{one}'" for one in conflict)
    return f"{shown}: no two orders of cells with falling force have all these steps" * bool(shown)
