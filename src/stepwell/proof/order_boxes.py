"""Chains whose numbers lie in a box: their sequence by the order of critical forces.

The sorting theorem (theory page, "Sorting") needs falling forces and a condition on travels; under
a prescribed force elements are relays. Critical forces of different cells are independent, so an
order holds in the whole box exactly if the ranges of the forces do not overlap. A cell whose force
does not fall everywhere needs more room: up to the largest force of its travel.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np

from stepwell.mechanism import Cell, Chain, Element
from stepwell.proof.balls import Ball, UndecidedError, ball, high, low
from stepwell.proof.cell_boxes import CellBox, CellPart, CriticalForce
from stepwell.proof.slopes import LargestValue
from stepwell.proof.walk import TIE
from stepwell.sequences import Cycle, Sequence as States, cycle
from stepwell.statics import StaticsError

# Errors of the extremes of a force, as fractions of the largest force, one after the other.
_ENOUGH = 1e-2, 1e-4, 1e-6, 1e-9
# Angles at which the largest force of a nominal cell is looked for.
_LOOKS = 65


class Decision(NamedTuple):
    """Whether all chains of a box have one sequence.

    Attributes:
        proved: whether they are proved to.
        cause: what is not proved; "" if all is.
        machine: a chain in the box with another sequence, as simulated; None if none is known.
        becomes: its sequence, or what is reported in place of one.
        cells: numbers of the cells whose spans are too wide.
    """

    proved: bool
    cause: str = ""
    machine: Chain | None = None
    becomes: str = ""
    cells: tuple[int, ...] = ()


class Switch(NamedTuple):
    """A step of a cycle: a cell leaves a phase upwards (end 0) or enters it downwards (end 1)."""

    cell: int
    phase: int
    end: int


def becomes(chain: Chain, sequence: str) -> str:
    """What a simulated chain does in place of a sequence; "" if it has it, without a tie."""
    try:
        result = cycle(chain)
    except (StaticsError, ValueError) as failure:
        return f"no answer: {failure}"
    if str(result.sequence) != sequence:
        return str(result.sequence)
    return "a tie" if result.degenerate else ""


class OrderedBox:
    """A chain and, for each cell, the numbers of it that lie within spans."""

    def __init__(self, nominal: Cycle, parts: Sequence[Sequence[CellPart]]):
        self.nominal, self.chain = nominal, nominal.chain
        pairs = zip(self.chain.cells, parts, strict=True)
        self.boxes = [CellBox(cell, tuple(own)) for cell, own in pairs]
        largest = [cell.largest_force for cell in self.chain.cells]
        self.scale = max(largest)
        self._known: dict[tuple[int, CriticalForce], tuple[float, LargestValue]] = {}

    def decide(self) -> Decision:
        """Whether all chains of the box are proved to have the nominal sequence."""
        steps = switches_of(self.nominal.sequence)
        if self.nominal.degenerate or steps is None:
            return Decision(False, "the nominal design has ties, or moves several cells at once")
        try:
            self._check_phases(steps)
            open_pair: Decision | None = None
            for order in steps:
                for first, second in combinations(order, 2):
                    if first.cell != second.cell and (found := self._pair(first, second)):
                        if found.machine is not None:
                            return found
                        open_pair = open_pair or found
            if open_pair is not None:
                return open_pair
            return self._conditions(steps)
        except UndecidedError as why:
            return Decision(False, why.cause)

    def _extreme(self, switch: Switch, sign: int, enough: float) -> LargestValue:
        force = CriticalForce(switch.phase, switch.end, sign)
        known = self._known.get((switch.cell, force))
        if known is None or known[0] > enough:
            known = enough, self.boxes[switch.cell].extreme(force, enough)
            self._known[switch.cell, force] = known
        return known[1]

    def _pair(self, first: Switch, second: Switch) -> Decision | None:
        """None if a first switch is proved to come before a second one; else what is known."""
        sign = -1 if first.end else 1
        met = self._meet(lambda error: self._extreme(first, sign, error), second, _ENOUGH)
        if met is None:
            return None
        names = f"{self.chain.names[first.cell]} and {self.chain.names[second.cell]}"
        cause = f"the order of {names} while {'unloading' if first.end else 'loading'}"
        return self._failed(cause, (first, second), met)

    def _meet(
        self, largest: Callable[[float], LargestValue], second: Switch, shares: Iterable[float]
    ) -> list[list[float]] | None:
        """Values of parts where forces that stay below a second critical one may reach it.

        None if they are proved to stay below it; `largest` has the largest of them for an error.
        """
        sign, tie = (-1 if second.end else 1), TIE * self.scale
        one = two = None
        for share in shares:
            one = largest(share * self.scale)
            two = self._extreme(second, -sign, share * self.scale)
            if -two.bound - one.bound > tie:
                return None
            if -two.attained - one.attained < -tie:
                break
        assert one is not None and two is not None
        return [one.at, two.at]

    def _nominal(self, switch: Switch) -> float:
        """The critical force of the nominal design, as a double."""
        cell = self.chain.cells[switch.cell]
        if switch.end:
            return cell.phases[switch.phase + 1].force_low - cell.friction
        return cell.phases[switch.phase].force_high + cell.friction

    def _failed(
        self, cause: str, pair: tuple[Switch, Switch], values: list[list[float]]
    ) -> Decision:
        """What is known where cells with these values of their parts may change places."""
        first, second = pair
        machine = self.machine({first.cell: values[0], second.cell: values[1]})
        sign = -1 if first.end else 1
        narrower = sign * (self._nominal(second) - self._nominal(first)) > 0.0
        cells = (first.cell, second.cell) if narrower else ()
        if machine is not None and (other := becomes(machine, str(self.nominal.sequence))):
            return Decision(False, cause, machine, other, cells)
        return Decision(False, cause, cells=cells)

    def machine(self, values: dict[int, list[float]]) -> Chain | None:
        """The chain with these values of the parts of some cells, those of others nominal."""
        from dataclasses import replace

        cells = list(self.chain.cells)
        try:
            for i, own in values.items():
                cells[i] = self.boxes[i].machine(own)
            return replace(self.chain, cells=tuple(cells))
        except ValueError:
            return None

    def _check_phases(self, steps: tuple[list[Switch], list[Switch]]) -> None:
        """Prove of each element which phases it stands in: by the order of its own forces.

        All its forces have one factor, and one friction, so their order is that of its curve.
        """
        taken = {(s.cell, s.phase) for s in steps[0]}, {(s.cell, s.phase) for s in steps[1]}
        for i, box in enumerate(self.boxes):
            if not isinstance(box.cell, Element):
                continue
            forces = box._element_forces
            for end, order in enumerate((range(len(forces)), reversed(range(len(forces))))):
                sign, most = (1, -1)[end], None
                for phase in order:
                    own = sign * forces[phase][end]
                    goes = most is None or own > most
                    if not goes and not own < most:
                        raise UndecidedError("the order of an element's own forces")
                    if goes != ((i, phase) in taken[end]):
                        raise UndecidedError("an element skips a phase")
                    most = own if goes else most

    # Conditions of the theorem.

    def _conditions(self, steps: tuple[list[Switch], list[Switch]]) -> Decision:
        chain = self.chain
        prescribed = chain.actuator_stiffness == 0.0
        folded = [one.name for one in chain.elements if len(one.sheets) > 1]
        if prescribed and folded:
            return Decision(False, f"the curve of {folded[0]} folds back")
        rising = self._rising(prescribed)
        if len(chain) > 1 and rising:
            return self._apart(steps, rising)
        if prescribed or len(chain) == 1 or self._one_travel():
            return Decision(True)
        if np.isfinite(chain.actuator_stiffness) or chain.elements:
            return Decision(False, "unequal travels behind a spring, or of elements")
        return self._travels([[s.cell for s in order] for order in steps])

    def _rising(self, prescribed: bool) -> list[int]:
        """Cells whose force is not proved to fall; under a prescribed force elements are relays."""
        relays = self.chain.elements if prescribed else ()
        return [i for i, box in enumerate(self.boxes) if box.cell not in relays and not box.falls()]

    def _apart(self, steps: tuple[list[Switch], list[Switch]], rising: list[int]) -> Decision:
        """Whether all forces of a cell are below the critical one of the next, though some rise.

        Theory page, "Proofs within tolerances": of lever cells with one travel, or under a force.
        """
        chain, name = self.chain, self.chain.names[rising[0]]
        prescribed = chain.actuator_stiffness == 0.0
        rigid = not prescribed and not np.isfinite(chain.actuator_stiffness) and self._one_travel()
        if not (prescribed or rigid) or any(isinstance(chain.cells[i], Element) for i in rising):
            cause = f"the force of {name} is not proved to fall everywhere"
            return Decision(False, cause, cells=tuple(rising))
        for order in steps:
            for first, second in combinations(order, 2):
                if first.cell in rising and first.cell != second.cell:
                    failed = self._passes(first, second)
                    if failed is not None:
                        return failed
        return Decision(True)

    def _passes(self, first: Switch, second: Switch) -> Decision | None:
        """None if the forces of a first cell on its way stay below the critical one of another."""
        sign, box = (-1 if first.end else 1), self.boxes[first.cell]
        names, cell = self.chain.names, box.cell
        cause = f"the force of {names[first.cell]} may pass the critical force of "
        cause += f"{names[second.cell]} on its way while {'unloading' if first.end else 'loading'}"
        assert isinstance(cell, Cell)
        most = float(np.max(sign * cell.force(np.linspace(-cell.limit, cell.limit, _LOOKS))))
        if most + cell.friction >= sign * self._nominal(second):
            # That of the nominal design does, so narrower spans do not help.
            return Decision(False, cause)
        met = self._meet(
            lambda error: _peak(box.cell, box.parts, first.end, error), second, _ENOUGH[:3]
        )
        return None if met is None else self._failed(cause, (first, second), met)

    def _one_travel(self) -> bool:
        varies = any(box.varies("lever") or box.varies("travel_scale") for box in self.boxes)
        return not varies and len(set(self.chain.full_travels)) == 1

    def _travels(self, orders: Sequence[Sequence[int]]) -> Decision:
        """Whether no cell that gives travel back is emptied (theory page, "Sorting")."""
        names = self.chain.names
        for end, order in enumerate(orders):
            for place, j in enumerate(order[1:], 1):
                shortest = min((low(self._travel(k)) for k in order[:place]), key=float)
                if not high(self._travel(j)) > shortest:
                    continue
                box = self.boxes[j]
                assert isinstance(box.cell, Cell)
                sine, sign = ball(box.cell.sin_limit), 1 if end else -1
                enough = 1e-3 * self.scale
                most = box.force_at((-sign * sine, sign * shortest), sign, enough).bound
                for k in order[:place]:
                    held = self._extreme(Switch(k, 0, 1 - end), -sign, enough).bound
                    if not most < -held:
                        cause = f"a snap of {names[j]} may empty {names[k]}"
                        return Decision(False, cause, cells=(j, k))
        return Decision(True)

    def _travel(self, i: int) -> Ball:
        """S of a lever cell, a ball."""
        cell, parts = self.boxes[i].cell, self.boxes[i].parts
        assert isinstance(cell, Cell)
        levers = [(part.low, part.high) for part in parts if part.what == "lever"]
        least, most = levers[0] if levers else (cell.lever, cell.lever)
        return 2 * ball(cell.sin_limit) * ball(least).union(ball(most))


@lru_cache(maxsize=64)
def _peak(
    cell: Cell | Element, parts: tuple[CellPart, ...], end: int, enough: float
) -> LargestValue:
    """`CellBox.peak`, once for boxes that have the same numbers, as most cells of a margin."""
    return CellBox(cell, parts).peak(end, enough)


def switches_of(sequence: States) -> tuple[list[Switch], list[Switch]] | None:
    """Switches of a full cycle in order while loading and unloading; None if it is no such one."""
    state = [int(digit) for digit in sequence.first]
    if any(state):
        return None
    orders: tuple[list[Switch], list[Switch]] = [], []
    for cell, phase in _single(sequence):
        if cell < 0 or phase == state[cell] or (phase > state[cell] and orders[1]):
            return None
        end = int(phase < state[cell])
        # Of phases that it skips, the first one's force decides.
        orders[end].append(Switch(cell, state[cell] - 1 if end else state[cell], end))
        state[cell] = phase
    return None if any(state) else orders


def _single(sequence: States) -> Iterator[tuple[int, int]]:
    """The cell and its new phase of each change; (-1, 0) where several cells change."""
    for change in sequence.changes:
        if len(change) == 1:
            yield change[0][0], int(change[0][1])
        else:
            yield -1, 0
