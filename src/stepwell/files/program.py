"""The program of the actuator in a design file: turning points and target."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from operator import lt
from typing import TYPE_CHECKING

from stepwell.base import ByValue, display_unit, to_unit
from stepwell.files.schema import chain as schema
from stepwell.files.schema.keys import si, written
from stepwell.files.text import array, quoted, toml, value_text
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.sequences import Program

# Fractions of the chain's stroke: tolerance of equal strokes in the engine, a tenth of it, and the
# largest stroke of a program that is probably a unit error.
_SAME, _EXACT, NOTHING = 1e-9, 1e-10, 1 / 200
# Tolerance for rounding a turning point, over half its window.
_ROUND = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class WrittenProgram(ByValue):
    """Turning points of the actuator in the table [program] of a design file.

    Attributes:
        start: the state at the beginning, such as "000".
        turning_points: drives from the beginning to the end [m], or [N] under force control.
        ends: the target state; None if the file has none.
    """

    start: str
    turning_points: tuple[float, ...]
    ends: str | None = None

    @classmethod
    def of(cls, program: "Program") -> "WrittenProgram":
        """A computed program, rounded within its windows."""
        points = program.turning_points
        slacks = [0.0, *(turn.slack for turn in program.turns), (program.high - program.low) / 2]
        least = _EXACT * max(program.chain.full_stroke, *map(abs, points))
        tidy = (
            _tidy(point, max(_ROUND * slack, least), _key(program.chain))
            for point, slack in zip(points, slacks, strict=False)
        )
        return cls(program.start, tuple(tidy), program.target)

    def on(self, chain: Chain) -> "Program":
        """The program on the chain of the same file, with the window of every turning point.

        Without `ends`, its target is its last state. With friction, no turning point has a
        window.

        Raises:
            ValueError: the chain has no equilibrium at the start.
            StaticsError: the path could not be computed; the message has advice.
        """
        from stepwell.sequences import Program

        return Program.given(chain, self.turning_points, start=self.start, target=self.ends)

    def text(self, chain: Chain) -> str:
        """Text of the table [program] in the design file of the chain."""
        key = _key(chain)
        points = written(key, self.turning_points)
        ends = "" if self.ends is None else f"ends = {quoted(self.ends)}\n"
        unusual = "unusual = true\n" if _near_nothing(self.turning_points, chain) else ""
        return f"[program]\nstart = {quoted(self.start)}\n{key} = {points}\n{ends}{unusual}"


def program_of(keys: schema.ProgramKeys, chain: Chain, problems: list[str]) -> WrittenProgram:
    """The program of a file; a line is added to `problems` for each impossible value."""
    for key, state in (("start", keys.start), ("ends", keys.ends)):
        problems += [] if state is None else _wrong_state(key, state, chain)
    start = keys.start or chain.first_state
    key = _key(chain)
    (given,) = keys.given_points
    drives: tuple[Decimal, ...] = getattr(keys, given)
    if given != key:
        soft = chain.actuator_stiffness == 0
        control = f"the actuator {f'prescribes the {chain.measure.force}' if soft else 'moves'}"
        problems.append(f"program.{given} = {value_text(drives)}: {control}, so it must be {key}.")
        return WrittenProgram(start, (), keys.ends)
    points: tuple[float, ...] = si(key, drives)
    if math.isinf(chain.actuator_stiffness) and not problems:
        problems += _out_of_reach(points, start, chain)
        if _near_nothing(points, chain) and not keys.unusual:
            meant = array(toml(point * 1000) for point in drives)
            fits = to_unit(max(points), "mm") <= (1 + _SAME) * chain.full_stroke
            unit, factor = display_unit(chain.measure.travel_unit)
            share = max(map(abs, points)) / chain.full_stroke
            problems.append(
                f"program.{key} = {value_text(drives)}: stays within {share:.2g} of the chain's "
                f"{chain.measure.stroke}, {chain.full_stroke * factor:.12g} {unit}."
                f"{f' Did you mean {meant}?' * fits} If the value is intended, set unusual = "
                f"true in [program]."
            )
    return WrittenProgram(start, points, keys.ends)


def _key(chain: Chain) -> str:
    return schema.TURNING_POINTS[chain.measure][chain.actuator_stiffness == 0]


def _wrong_state(key: str, state: str, chain: Chain) -> list[str]:
    digits = map(int, state)
    if len(state) == len(chain) and all(map(lt, digits, map(len, chain.phases))):
        return []
    must = f"{len(chain)} characters 0 or 1, one for each cell, inner first."
    if chain.elements:
        must = f"one digit for each cell, inner first, none above its own in {chain.last_state}."
    return [f"program.{key} = {value_text(state)}: must be {must}"]


def _near_nothing(points: tuple[float, ...], chain: Chain) -> bool:
    """Whether a rigid actuator hardly moves, as for strokes in m under a key in mm."""
    farthest = max(map(abs, points), default=0.0)
    return math.isinf(chain.actuator_stiffness) and 0 < farthest < NOTHING * chain.full_stroke


def _out_of_reach(points: tuple[float, ...], start: str, chain: Chain) -> list[str]:
    """Problems with strokes that a rigid actuator cannot reach with this chain."""
    full, near = chain.full_stroke, _SAME * chain.full_stroke
    phases = [phases[int(digit)] for phases, digit in zip(chain.phases, start, strict=True)]
    begins = sum(phase.low for phase in phases), sum(phase.high for phase in phases)
    ends = [
        sum(cell.low if cell.stopped[0] else -math.inf for cell in chain.cells),
        sum(cell.high if cell.stopped[1] else math.inf for cell in chain.cells),
    ]
    unit, factor = display_unit(chain.measure.travel_unit)
    problems: list[str] = []
    for i, point in enumerate(points):
        place = f"program.{_key(chain)}[{i}] = {point * factor:.12g}"
        if i == 0 and not begins[0] - near <= point <= begins[1] + near:
            at, to = (f"{end * factor:.12g}" for end in begins)
            at = f"from {at} to {to} {unit}" if begins[0] < begins[1] else at
            problems.append(f"{place}: must be {at}, the {chain.measure.stroke} at state {start}.")
        elif not ends[0] - near <= point <= ends[1] + near:
            meant = f" Did you mean {point:.12g}?" if 10 * full < point <= 1e3 * full else ""
            problems.append(
                f"{place}: must be from {ends[0] * factor:.12g} to {ends[1] * factor:.12g}, the "
                f"sum of all travels.{meant}"
            )
    return problems


def _tidy(value: float, within: float, key: str) -> float:
    """The number with the fewest digits in the unit of the file, `within` of `value`."""
    exact = Decimal(written(key, value))
    tried: Iterator[float] = (si(key, round(exact, digits)) for digits in range(13))
    # A zero has no sign.
    return next((one + 0.0 for one in tried if abs(one - value) <= within), value)
