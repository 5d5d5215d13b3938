"""What a design file says the actuator is to do, and what it is for."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING

from stepwell.base import ByValue
from stepwell.files.schema import chain as schema, si, written
from stepwell.files.text import array, quoted, units, value_text
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.sequences import Program

# Of the chain's stroke: what the engine takes for the same place, and a tenth of it.
_SAME, _EXACT = 1e-9, 1e-10
# Of the chain's stroke: a program that reaches no farther does nothing.
NOTHING = 1 / 200
# How far off the middle of its window a turning point may be written, over half the window.
_ROUND = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class WrittenProgram(ByValue):
    """Turning points of the actuator as the table [program] of a design file holds them.

    Attributes:
        start: the state at the beginning, such as "000".
        turning_points: drives from the beginning to the end [m], or [N] under force control.
        ends: the state in which it is to end; None where the file does not say.
    """

    start: str
    turning_points: tuple[float, ...]
    ends: str | None = None

    @classmethod
    def of(cls, program: Program) -> WrittenProgram:
        """A program that was found, with no more digits than its windows ask for."""
        points = program.turning_points
        slacks = [0.0, *(turn.slack for turn in program.turns), (program.high - program.low) / 2]
        least = _EXACT * max(program.chain.full_stroke, *map(abs, points))
        tidy = (
            _tidy(point, max(_ROUND * slack, least), _places(program.chain))
            for point, slack in zip(points, slacks, strict=False)
        )
        return cls(program.start, tuple(tidy), program.to)

    def on(self, chain: Chain) -> Program:
        """The program on the chain of the same file, with the window of every turn.

        Without `ends`, it is there for the state in which it ends. With friction, no turn has
        a window.

        Raises:
            ValueError: the chain cannot stand at the start.
            StaticsError: the engine could not go on; its text says what to do.
        """
        from stepwell.sequences import Program

        return Program.given(chain, self.turning_points, start=self.start, to=self.ends)

    def text(self, chain: Chain) -> str:
        """The table [program] in the design file of the chain."""
        key = _KEYS[chain.actuator_stiffness == 0]
        points = written(key, self.turning_points)
        ends = "" if self.ends is None else f"ends = {quoted(self.ends)}\n"
        unusual = "unusual = true\n" if _near_nothing(self.turning_points, chain) else ""
        return f"[program]\nstart = {quoted(self.start)}\n{key} = {points}\n{ends}{unusual}"


def program_of(keys: schema.ProgramKeys, chain: Chain, problems: list[str]) -> WrittenProgram:
    """The program of a file; `problems` gets a line for everything the chain cannot do."""
    for key, state in (("start", keys.start), ("ends", keys.ends)):
        if state is not None and len(state) != len(chain):
            problems.append(
                f"program.{key} = {value_text(state)}: must be {len(chain)} characters 0 or 1, one "
                f"for each cell, inner first."
            )
    start = keys.start or "0" * len(chain)
    key, other = _KEYS if chain.actuator_stiffness else _KEYS[::-1]
    drives: tuple[Decimal, ...] | None = getattr(keys, key)
    if drives is None:
        given = value_text(getattr(keys, other))
        control = "prescribes the force" if key.endswith("N") else "moves"
        problems.append(f"program.{other} = {given}: the actuator {control}, so it must be {key}.")
        return WrittenProgram(start, (), keys.ends)
    points: tuple[float, ...] = si(key, drives)
    if math.isinf(chain.actuator_stiffness) and not problems:
        problems += _out_of_reach(points, start, chain)
        if _near_nothing(points, chain) and not keys.unusual:
            meant = array(units.toml(point * 1000) for point in drives)
            fits = max(points) * 1e3 <= (1 + _SAME) * chain.full_stroke
            problems.append(
                f"program.{key} = {value_text(drives)}: stays within "
                f"{max(map(abs, points)) / chain.full_stroke:.2g} of the chain's stroke, "
                f"{chain.full_stroke * 1e3:.12g} mm.{f' Did you mean {meant}?' * fits} If it is "
                f"meant so, set unusual = true in [program]."
            )
    return WrittenProgram(start, points, keys.ends)


_KEYS = ("turning_points_mm", "turning_points_N")


def _places(chain: Chain) -> int:
    """Decimal places between SI and the unit of the file."""
    return 0 if chain.actuator_stiffness == 0 else 3


def _near_nothing(points: tuple[float, ...], chain: Chain) -> bool:
    """Whether a rigid actuator hardly moves, as it would for strokes in m under a key in mm."""
    farthest = max(map(abs, points), default=0.0)
    return math.isinf(chain.actuator_stiffness) and 0 < farthest < NOTHING * chain.full_stroke


def _out_of_reach(points: tuple[float, ...], start: str, chain: Chain) -> list[str]:
    """Strokes that no rigid actuator can take this chain to."""
    most = chain.full_stroke
    begin = sum(cell.full_travel for cell, s in zip(chain.cells, start, strict=True) if s == "1")
    found: list[str] = []
    for i, point in enumerate(points):
        place = f"program.{_KEYS[0]}[{i}] = {point * 1e3:.12g}"
        if i == 0 and abs(point - begin) > _SAME * most:
            found.append(f"{place}: must be {begin * 1e3:.12g}, the stroke where {start} stands.")
        elif not -_SAME * most <= point <= (1 + _SAME) * most:
            meant = f" Did you mean {point:.12g}?" if 10 * most < point <= 1e3 * most else ""
            found.append(
                f"{place}: must be from 0 to {most * 1e3:.12g}, the sum of all travels.{meant}"
            )
    return found


def _tidy(value: float, within: float, places: int) -> float:
    """The number of fewest digits near enough to `value`, counted in the unit of the file."""
    exact = units.shortest(value, places)
    for digits in range(13):
        rounded = round(exact, digits)
        if abs(units.moved(rounded, -places) - value) <= within:
            return units.moved(rounded, -places)
    return value
