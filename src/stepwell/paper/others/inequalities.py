"""A pair of elements in series that makes a graph of two hysterons, as linear inequalities.

Elements in series share one force. In a phase an element is as long as a rising function of that
force says, up to the force at which the phase ends; then it goes over to its other phase. So every
length at which a state of the pair ends is a sum of two travels, and a graph is made where these
lengths are in the order that it wants.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise, product

import numpy as np

from stepwell.base import Floats
from stepwell.paper.others.hysterons import Graph, stations

# A sum of unknown numbers: which, and how often.
_Sum = dict[int, float]
Points = tuple[tuple[float, float], ...]

# Numbers of all: how much room the inequalities leave [mm], and the least compliance [mm/N].
_ROOM, _COMPLIANCE = 0, 1
_REACH = 10.0  # largest travel [mm]
# Beyond the outermost forces at which phases end, curves go straight on [N], soft [mm/N].
_LAST, _SOFT = 3.0, 8.0
# Room of other inequalities as a part of that between lengths.
_FOLD, _TURN, _LOSS = 0.5, 0.1, 0.3


class Inequalities:
    """Between the travels [mm] of two elements in both phases at a grid of forces [N]."""

    def __init__(self, graph: Graph, forces: Floats, ends: tuple[int, int, int, int]):
        """What a graph says of the order of valleys and peaks, and of travels nothing.

        Args:
            graph: of two hysterons.
            forces: (n,) rising.
            ends: where in `forces` the lower and the higher valley and peak are.
        """
        self.graph, self.forces = graph, forces
        up, down = (_first(graph, way) for way in ("00+", "11-"))
        # What goes up first has the lower peak, what goes down first the higher valley.
        self.ends = (
            {up: ends[2], 1 - up: ends[3]},
            {down: ends[1], 1 - down: ends[0]},
        )
        self.size = 2
        self.rows: list[tuple[_Sum, float]] = []
        self.travel = {
            (cell, phase): dict(zip(places, self.numbers(len(places)), strict=True))
            for cell in (0, 1)
            for phase, places in (
                (0, range(self.ends[0][cell] + 1)),
                (1, range(self.ends[1][cell], len(forces))),
            )
        }

    def numbers(self, count: int) -> range:
        """So many more unknown numbers."""
        self.size += count
        return range(self.size - count, self.size)

    def below(self, small: _Sum, large: _Sum, room: float = 1.0, by: float = 0.0) -> None:
        """Require of two sums: small + so much of the room + by <= large."""
        self.rows.append((_sum(_sum(small, large, -1.0), {_ROOM: room}), -by))

    def rise(self) -> None:
        """Travel rises with force in every phase."""
        for there in self.travel.values():
            for (a, x), (b, y) in pairwise(there.items()):
                step = float(self.forces[b] - self.forces[a])
                self.below({x: 1.0, _COMPLIANCE: step}, {y: 1.0}, 0.0)

    def fall(self, cell: int, *, alone: bool) -> None:
        """The second phase begins beyond the end of the first, with a straight fall between them.

        Args:
            cell: which.
            alone: nothing in series holds the element in its fall: in both of its phases the other
                one gives way faster, from where the fall begins at either end.
        """
        (p, up), (q, down) = self._end(cell, 0), self._end(cell, 1)
        self.below({p: 1.0}, {q: 1.0}, _FOLD if alone else 0.0)
        other = 1 - cell
        for phase, place in product((0, 1), (self.ends[0][cell], self.ends[1][cell])):
            there = self.travel[other, phase]
            for k, number in there.items() if alone and place in there else ():
                force, begin = float(self.forces[k]), float(self.forces[place])
                if down <= force <= up and k != place:
                    part = (force - begin) / (up - down)
                    gives = _sum({number: 1.0}, {there[place]: 1.0}, -1.0)
                    fallen = {q: part, p: -part}
                    self.below(*((fallen, gives) if part > 0.0 else (gives, fallen)), _TURN)

    def fold(self, cell: int) -> None:
        """The curve folds back, by a straight unstable stretch between its phases.

        Next to it both phases are less steep than it is, and at either fold less energy is on the
        other phase. E_k(s) = max over λ of G_k(λ) + λ s, with G' = -travel; the stretch tells by
        how much G differs.
        """
        (p, up), (q, down) = self._end(cell, 0), self._end(cell, 1)
        self.below({q: 1.0}, {p: 1.0}, _FOLD)
        first, second = (list(self.travel[cell, phase].items()) for phase in (0, 1))
        for (a, x), (b, y), other, sign in ((*first[-2:], q, 1.0), (*second[:2], p, -1.0)):
            slope = float(self.forces[b] - self.forces[a]) / (up - down)
            near, edge = (x, y) if sign > 0 else (y, x)
            # slope · (p - q) <= the travel of the phase's last piece.
            self.below({edge: sign * (slope - 1.0), other: -sign * slope, near: sign}, {}, _TURN)
        half = (up - down) / 2.0
        for area, force in _areas(second, self.forces, self._end(cell, 1)[1]):
            self.below(_sum({p: force - up + half, q: half}, area, -1.0), {}, _LOSS)
        for area, force in _areas(first[::-1], self.forces, up):
            self.below(_sum({q: force - down - half, p: -half}, area, -1.0), {}, _LOSS)

    def make(self, *, spring: bool) -> None:
        """The lengths at which states end are in the order that the graph wants.

        Args:
            spring: lengths are those of a drive behind a spring, with whatever it gives.
        """
        given = self.numbers(len(self.forces)) if spring else ()
        for x, y in pairwise(given):
            self.below({x: 1.0}, {y: 1.0}, 0.0)
        for way in self.graph:
            states, cells = stations(way), [int(cell) - 1 for cell in way[3:]]
            length = self._length(states[0], way[2], given)[1]
            for state, cell in zip(states[1:], cells[1:], strict=False):
                sign = "+" if state[cell] == "0" else "-"
                leaving, end = self._length(state, sign, given)
                if leaving != cell:
                    # The other one leaves its phase first at any length.
                    self.below({}, {})
                self.below(*((end, length) if sign == "+" else (length, end)))
            for sign, leaves in (("+", "0"), ("-", "1")):
                if leaves in states[-1]:
                    end = self._length(states[-1], sign, given)[1]
                    self.below(*((length, end) if sign == "+" else (end, length)))

    def hold(self) -> bool:
        """Whether there are travels for which all hold."""
        return self._solved(_ROOM, (0.0, 1.0), (0.0, 0.0)) is not None

    def solution(self, room: float) -> Floats | None:
        """Travels for which all hold with some room [mm], in phases as compliant as can be."""
        return self._solved(_COMPLIANCE, (room, room), (0.0, None))

    def _solved(
        self, goal: int, room: tuple[float, float], compliance: tuple[float, float | None]
    ) -> Floats | None:
        from scipy.optimize import linprog

        matrix, right = np.zeros((len(self.rows), self.size)), np.zeros(len(self.rows))
        for k, (row, bound) in enumerate(self.rows):
            matrix[k, list(row)] = list(row.values())
            right[k] = bound
        bounds = [room, compliance, *[(-_REACH, _REACH)] * (self.size - 2)]
        found = linprog(-np.eye(self.size)[goal], matrix, right, bounds=bounds)
        return found.x if found.status == 0 and found.x[goal] > _LEAST else None

    def points(self, cell: int, found: Floats) -> Points:
        """The curve of an element of a solution, straight between points by arc [mm, N]."""
        phases = [
            [(float(found[number]), float(self.forces[k])) for k, number in there.items()]
            for there in (self.travel[cell, 0], self.travel[cell, 1])
        ]
        (s, force), (t, high) = phases[0][0], phases[1][-1]
        begin = (s - _SOFT * (force + _LAST), -_LAST)
        end = (t + _SOFT * (_LAST - high), _LAST)
        return tuple(_corners([begin, *phases[0], *phases[1], end]))

    def _end(self, cell: int, phase: int) -> tuple[int, float]:
        """The travel where a phase ends, and the force."""
        place = self.ends[phase][cell]
        return self.travel[cell, phase][place], float(self.forces[place])

    def _length(self, state: str, sign: str, spring: range | tuple[()]) -> tuple[int, _Sum]:
        """Which cell leaves its phase first in a state, and the length at which it does."""
        phase, first = (0, min) if sign == "+" else (1, max)
        cells = [cell for cell in (0, 1) if state[cell] == str(phase)]
        leaving = first(cells, key=self.ends[phase].__getitem__)
        place = self.ends[phase][leaving]
        given = {spring[place]: 1.0} if spring else {}
        return leaving, {self.travel[i, int(state[i])][place]: 1.0 for i in (0, 1)} | given


# What is below this is none: of rooms [mm], and of compliances [mm/N].
_LEAST = 1e-6


def _first(graph: Graph, begin: str) -> int:
    """The cell that flips first on the way that begins like this."""
    return next(int(way[3]) - 1 for way in graph if way.startswith(begin))


def _areas(there: list[tuple[int, int]], forces: Floats, start: float) -> list[tuple[_Sum, float]]:
    """∫ travel dλ from the first of some places to each of them, and the force there."""
    area: _Sum = {}
    found = [(area, start)]
    for (a, x), (b, y) in pairwise(there):
        step = float(forces[b] - forces[a]) / 2.0
        area = _sum(area, {x: step, y: step})
        found.append((area, float(forces[b])))
    return found


def _sum(one: _Sum, other: _Sum, times: float = 1.0) -> _Sum:
    total = dict(one)
    for number, by in other.items():
        total[number] = total.get(number, 0.0) + times * by
    return total


def _corners(points: list[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """Points without those in the middle of a straight piece."""
    yield points[0]
    for (s, f), (t, g), (u, h) in zip(points, points[1:], points[2:], strict=False):
        # Where travel or force turns there is a corner too.
        flat = abs((t - s) * (h - g) - (u - t) * (g - f)) <= 1e-6
        if not (flat and (t - s) * (u - t) > 0.0):
            yield t, g
    yield points[-1]
