"""Claims about pairs of hysterons: possible transition graphs, and those made by chains."""

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import accumulate, pairwise, permutations, product

import numpy as np

from stepwell.base import Floats
from stepwell.mechanism import Chain, Element
from stepwell.paper.claims import Finding, claim, finding_of
from stepwell.sequences import TransitionGraph

# A graph as a sorted tuple of arrows, such as "01+12": from 01 a rising drive flips cell 1, then 2.
Graph = tuple[str, ...]
# Rank of each switching field: by state, then by cell.
_Fields = dict[str, tuple[int, int]]

_STATES = ("00", "01", "10", "11")
_WAYS = tuple(
    (state, sign)
    for state in _STATES
    for sign, leaves in (("+", "0"), ("-", "1"))
    if leaves in state
)


@cache
def graphs() -> tuple[Graph, ...]:
    """All graphs of two hysterons, up to the numbering of the cells.

    Only the order of the eight fields matters, so all orders are tried in which each of the four
    states is stable at some drive. An avalanche that returns to an earlier state, or in which two
    hysterons are beyond their fields at once, has no graph.

    Source: the model is that of van Hecke 2021, Phys. Rev. E 104, 054608, and of Teunisse and van
    Hecke 2025, R. Soc. Open Sci. 12, 250753; the enumeration is ours.
    """
    graphs = {graph for fields in _orders() if (graph := _graph(fields)) is not None}
    return tuple(sorted({canonical(graph) for graph in graphs}))


def canonical(graph: Graph) -> Graph:
    """The first, in sorting order, of a graph and its copy with cells renumbered."""
    return min(graph, _renumbered(graph))


def reached(graph: Graph) -> Graph:
    """A graph without its Gardens of Eden, the states that no drive leads to from 00."""
    seen, waiting = {"00"}, ["00"]
    while waiting:
        state = waiting.pop()
        targets = {stations(way)[-1] for way in graph if way.startswith(state)}
        waiting += targets - seen
        seen |= targets
    return tuple(way for way in graph if way[:2] in seen)


def stations(way: str) -> tuple[str, ...]:
    """The states through which a way leads, from the first to the last."""
    return tuple(accumulate(way[3:], lambda at, cell: _flipped(at, int(cell) - 1), initial=way[:2]))


def way_to(state: str, sign: str, first: int, end: str) -> str:
    """The arrow from one state to another on which this cell flips first; 0 is the inner one.

    Two cells flip in turns, so the end state determines the number of flips.
    """
    way, cell = f"{state}{sign}", first
    for _ in range(3):
        way += str(cell + 1)
        if stations(way)[-1] == end:
            return way
        cell = 1 - cell
    raise AssertionError(f"no way from {state} to {end}")


def _orders() -> Iterator[_Fields]:
    """All orders of the fields in which each state is stable at some drive."""
    for order in permutations(range(8)):
        fields = {state: (order[2 * k], order[2 * k + 1]) for k, state in enumerate(_STATES)}
        # Only 01 and 10 have both an up and a down field.
        if fields["01"][1] < fields["01"][0] and fields["10"][0] < fields["10"][1]:
            yield fields


def _graph(fields: _Fields) -> Graph | None:
    flips = [_avalanche(fields, *way) for way in _WAYS]
    if None in flips:
        return None
    return tuple(sorted(f"{''.join(way)}{flip}" for way, flip in zip(_WAYS, flips, strict=True)))


def _avalanche(fields: _Fields, state: str, sign: str) -> str | None:
    """The cells that flip when a state ends, in order; None if the model does not decide it."""
    row = fields[state]
    leaving = [cell for cell in (0, 1) if state[cell] == ("0" if sign == "+" else "1")]
    cell = (min if sign == "+" else max)(leaving, key=row.__getitem__)
    drive, seen, flips = row[cell], {state}, ""
    while True:
        state, flips = _flipped(state, cell), flips + str(cell + 1)
        if state in seen:
            return None
        seen.add(state)
        past = [
            i for i in (0, 1) if (drive - fields[state][i]) * (1 if state[i] == "0" else -1) > 0
        ]
        if len(past) != 1:
            return None if past else flips
        (cell,) = past


def _flipped(state: str, cell: int) -> str:
    other = "1" if state[cell] == "0" else "0"
    return state[:cell] + other + state[cell + 1 :]


def _renumbered(graph: Graph) -> Graph:
    swap = str.maketrans("12", "21")
    return tuple(sorted(way[1::-1] + way[2] + way[3:].translate(swap) for way in graph))


# A linear combination of unknowns: factor by index.
_Sum = dict[int, float]
Points = tuple[tuple[float, float], ...]

# Indices of two unknowns: slack of the inequalities [mm], and least compliance [mm/N].
_ROOM, _COMPLIANCE = 0, 1
_REACH = 10.0  # largest travel [mm]
# Points on a straight piece: a curve that folds back is smooth through its points.
_DENSE = 8


def straight(corners: Sequence[tuple[float, float]], scale: float = 1.0) -> Element:
    """An element straight by arc between corners [mm], [N], which may fold back; forces scaled."""
    if all(a[0] < b[0] for a, b in pairwise(corners)):
        return Element.from_points([1e-3 * s for s, _ in corners], [scale * f for _, f in corners])
    given = np.array(corners)
    places = np.linspace(0.0, len(given) - 1.0, _DENSE * (len(given) - 1) + 1)
    travel, force = (np.interp(places, np.arange(len(given)), column) for column in given.T)
    return Element.from_curve((1e-3 * travel).tolist(), (scale * force).tolist())


# Curves are straight beyond the outermost phase ends: up to a force [N], with a compliance [mm/N].
_LAST, _SOFT = 3.0, 8.0
# Slack of other inequalities as a fraction of that between lengths.
_FOLD, _TURN, _LOSS = 0.5, 0.1, 0.3


class Inequalities:
    """Inequalities between travels [mm] of two elements in both phases at a grid of forces [N]."""

    def __init__(
        self, graph: Graph, forces: Floats, ends: tuple[int, int, int, int], *, spring: bool
    ):
        """Inequalities of a graph: order of valleys and peaks, and of lengths.

        The lower and the higher valley and peak are at the indices `ends` of the rising forces
        (n,). Behind a spring, lengths are those of the drive, including the spring's.
        """
        self.forces = forces
        up, down = (_first(graph, way) for way in ("00+", "11-"))
        # What goes up first has the lower peak, what goes down first the higher valley.
        self.ends = ({up: ends[2], 1 - up: ends[3]}, {down: ends[1], 1 - down: ends[0]})
        self.size = 2
        self.rows: list[_Sum] = []
        self.travel = {
            (cell, phase): dict(zip(places, self.numbers(len(places)), strict=True))
            for cell in (0, 1)
            for phase, places in (
                (0, range(self.ends[0][cell] + 1)),
                (1, range(self.ends[1][cell], len(forces))),
            )
        }
        # Travel rises with force in every phase, and so does the spring's length.
        for there in self.travel.values():
            for (a, x), (b, y) in pairwise(there.items()):
                step = float(forces[b] - forces[a])
                self.below({x: 1.0, _COMPLIANCE: step}, {y: 1.0}, 0.0)
        self.given = self.numbers(len(forces)) if spring else ()
        for x, y in pairwise(self.given):
            self.below({x: 1.0}, {y: 1.0}, 0.0)
        for way in graph:
            self._make(way)

    def numbers(self, count: int) -> range:
        """Indices of `count` new unknowns."""
        self.size += count
        return range(self.size - count, self.size)

    def below(self, small: _Sum, large: _Sum, room: float = 1.0) -> None:
        """Add the inequality small + room · slack <= large."""
        self.rows.append(_sum(_sum(small, large, -1.0), {_ROOM: room}))

    def fall(self, cell: int, *, alone: bool) -> None:
        """The second phase begins beyond the end of the first, with a straight fall between them.

        If `alone`, the element in series does not stabilise the fall: in both of its phases the
        other one is more compliant than the fall, from either end of the fall.
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

        Next to it both phases are less steep than the stretch, and at either fold the other phase
        has less energy. E_k(s) = max over λ of G_k(λ) + λ s, with G' = -travel; the stretch gives
        the difference in G.
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

    def _make(self, way: str) -> None:
        """Require the order of the lengths at which states end, for an arrow."""
        states, cells = stations(way), [int(cell) - 1 for cell in way[3:]]
        length = self._length(states[0], way[2])[1]
        for state, cell in zip(states[1:], cells[1:], strict=False):
            sign = "+" if state[cell] == "0" else "-"
            leaving, end = self._length(state, sign)
            if leaving != cell:
                # The other cell leaves its phase first at any length: no solution.
                self.below({}, {})
            self.below(*((end, length) if sign == "+" else (length, end)))
        for sign, leaves in (("+", "0"), ("-", "1")):
            if leaves in states[-1]:
                end = self._length(states[-1], sign)[1]
                self.below(*((length, end) if sign == "+" else (end, length)))

    def hold(self) -> bool:
        """Whether the inequalities have a solution."""
        return self._solved(_ROOM, (0.0, 1.0), (0.0, 0.0)) is not None

    def solution(self, room: float) -> Floats | None:
        """A solution with some slack [mm], with the most compliant phases."""
        return self._solved(_COMPLIANCE, (room, room), (0.0, None))

    def _solved(
        self, goal: int, room: tuple[float, float], compliance: tuple[float, float | None]
    ) -> Floats | None:
        from scipy.optimize import linprog

        matrix = np.zeros((len(self.rows), self.size))
        for k, row in enumerate(self.rows):
            matrix[k, list(row)] = list(row.values())
        bounds = [room, compliance, *[(-_REACH, _REACH)] * (self.size - 2)]
        right = np.zeros(len(self.rows))
        optimum = linprog(-np.eye(self.size)[goal], matrix, right, bounds=bounds)
        return optimum.x if optimum.status == 0 and optimum.x[goal] > _LEAST else None

    def points(self, cell: int, solution: Floats) -> Points:
        """The curve of an element in a solution, as corners along the arc [mm, N]."""
        phases = [
            [(float(solution[number]), float(self.forces[k])) for k, number in there.items()]
            for there in (self.travel[cell, 0], self.travel[cell, 1])
        ]
        (s, force), (t, high) = phases[0][0], phases[1][-1]
        begin = (s - _SOFT * (force + _LAST), -_LAST)
        end = (t + _SOFT * (_LAST - high), _LAST)
        return tuple(_corners([begin, *phases[0], *phases[1], end]))

    def _end(self, cell: int, phase: int) -> tuple[int, float]:
        """The unknown travel and the force at the end of a phase."""
        place = self.ends[phase][cell]
        return self.travel[cell, phase][place], float(self.forces[place])

    def _length(self, state: str, sign: str) -> tuple[int, _Sum]:
        """The cell that leaves its phase first in a state, and the length at which it does."""
        phase, first = (0, min) if sign == "+" else (1, max)
        cells = [cell for cell in (0, 1) if state[cell] == str(phase)]
        leaving = first(cells, key=self.ends[phase].__getitem__)
        place = self.ends[phase][leaving]
        given = {self.given[place]: 1.0} if self.given else {}
        return leaving, {self.travel[i, int(state[i])][place]: 1.0 for i in (0, 1)} | given


# Smaller slacks [mm] and compliances [mm/N] count as none.
_LEAST = 1e-6


def _first(graph: Graph, begin: str) -> int:
    """The cell that flips first on the arrow with this beginning."""
    return next(int(way[3]) - 1 for way in graph if way.startswith(begin))


def _areas(there: list[tuple[int, int]], forces: Floats, start: float) -> list[tuple[_Sum, float]]:
    """∫ travel dλ from the first of some places to each of them, and the force there."""
    area: _Sum = {}
    areas = [(area, start)]
    for (a, x), (b, y) in pairwise(there):
        step = float(forces[b] - forces[a]) / 2.0
        area = _sum(area, {x: step, y: step})
        areas.append((area, float(forces[b])))
    return areas


def _sum(one: _Sum, other: _Sum, times: float = 1.0) -> _Sum:
    total = dict(one)
    for number, by in other.items():
        total[number] = total.get(number, 0.0) + times * by
    return total


def _corners(points: list[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """Points without those inside a straight piece."""
    yield points[0]
    for (s, f), (t, g), (u, h) in zip(points, points[1:], points[2:], strict=False):
        # A reversal of travel or force is a corner too.
        flat = abs((t - s) * (h - g) - (u - t) * (g - f)) <= 1e-6
        if not (flat and (t - s) * (u - t) > 0.0):
            yield t, g
    yield points[-1]


WHERE = "Teunisse and van Hecke 2025"
OURS = f"ours, of the graphs of {WHERE}"
# Forces at the ends of the phases of a designed pair [N]: two valleys and two peaks.
ENDS = (-1.0, -0.8, 0.8, 1.0)
# Its curves: straight pieces between two of them, forces beyond the outermost ones [N], and slack
# between lengths [mm].
_STEPS, _BEYOND, _SHARE_OF_ROOM = 4, (0.25, 0.5, 0.75), 0.5
# Stiffness of the spring between drive and pair [N/m].
SPRING = 10e3


def possible(graph: Graph, *, plain: bool) -> bool:
    """Whether any pair makes a graph, under a prescribed length or behind a spring.

    Only the order of the four forces at which phases end matters, and the graph determines it.
    Travels, and the spring's length, are any that rise with the force. The force of `plain`
    elements is a function of travel, so that the second phase begins beyond the end of the first.
    """
    inequalities = Inequalities(graph, np.arange(4.0), (0, 1, 2, 3), spring=True)
    if plain:
        for cell in (0, 1):
            inequalities.fall(cell, alone=False)
    return inequalities.hold()


@cache
def design(graph: Graph) -> tuple[Points, Points] | None:
    """Curves of two elements that make a graph under a prescribed length, by corners [mm, N].

    As few curves as possible fold back; None without a design.
    """
    inner = [np.linspace(a, b, _STEPS + 1)[:-1] for a, b in pairwise(ENDS)]
    below, above = ENDS[0] - np.array(_BEYOND[::-1]), ENDS[-1] + np.array((0.0, *_BEYOND))
    forces = np.concatenate([below, *inner, above])
    low, valley, peak, high = (len(_BEYOND) + k * _STEPS for k in range(4))
    for folded in sorted(product((False, True), repeat=2), key=sum):
        inequalities = Inequalities(graph, forces, (low, valley, peak, high), spring=False)
        for cell in (0, 1):
            if folded[cell]:
                inequalities.fold(cell)
            else:
                inequalities.fall(cell, alone=True)
        solution = inequalities.solution(_SHARE_OF_ROOM)
        if solution is not None:
            return inequalities.points(0, solution), inequalities.points(1, solution)
    return None


@cache
def pairs() -> dict[Graph, Chain]:
    """The pair of every graph with a known design."""
    designs = ((graph, design(graph)) for graph in graphs())
    return {graph: Chain([straight(one) for one in curves]) for graph, curves in designs if curves}


def graph_of(chain: Chain, drive: str | float | None = None) -> Graph:
    """The graph of a pair of elements with two phases, as the engine follows it.

    The transition graph gives the end of an arrow. The forces at which phases end give the first
    cell, since both cells have the same force.
    """
    graph = chain.graph(drive)
    fields = [cell.fields[0] for cell in chain.elements]
    ways: list[str] = []
    for state, sign in _WAYS:
        phase, first = (0, min) if sign == "+" else (1, max)
        cells = [cell for cell in (0, 1) if state[cell] == str(phase)]
        leaving = first(cells, key=lambda cell, phase=phase: fields[cell][phase])
        end = next_state(graph, state, +1 if sign == "+" else -1)
        ways.append(way_to(state, sign, leaving, end))
    return tuple(sorted(ways))


def next_state(graph: TransitionGraph, state: str, direction: int) -> str:
    """The next state with all cells in a phase, by the drive in one direction."""
    while (way := graph.transition(state, direction)) is not None:
        state = way[0]
        if "-" not in state:
            return state.partition("#")[0]
    return "nowhere"


@claim(WHERE, "35", "exact")
def two_hysterons() -> Finding:
    """Two hysterons with fields that depend on the state have 35 transition graphs."""
    all_graphs = graphs()
    return finding_of(
        len(all_graphs) == 35,
        str(len(all_graphs)),
        note="All orders of the eight fields in which every state stands at some drive; graphs "
        "that differ by the numbers of the hysterons count once, and none has a loop or a race.",
    )


@claim(WHERE, "13", "exact")
def two_hysterons_reached() -> Finding:
    """Without their Gardens of Eden they are 13."""
    count = _count_reached(graphs())
    return finding_of(
        count == 13, str(count), note="States that no drive leads to from 00 left out."
    )


@claim(OURS, "not asked", "each design followed, the others excluded")
def pairs_under_force() -> Finding:
    """Under a prescribed force, two elements in series make 2 of the 35, 2 of the 13."""
    alone = {graph for graph in graphs() if all(len(way) == 4 for way in graph)}
    made = {canonical(graph_of(chain, "force")) for chain in pairs().values()}
    return finding_of(
        made == alone,
        _share(made),
        note="No element feels another, so a drive flips one at a time: of the 35 only these have "
        "no avalanche. The designs are those for a prescribed length.",
    )


@claim(OURS, "not asked", "each design followed, the others excluded")
def pairs_under_length() -> Finding:
    """Under a length, elements with one force for each travel make 8 of the 35, 5 of the 13."""
    return _whether_made(None)


@claim(OURS, "not asked", "each design followed, the others excluded")
def pairs_behind_a_spring() -> Finding:
    """Behind a spring such elements make the same 8."""
    return _whether_made(SPRING)


@claim(OURS, "not asked", "each design followed")
def pairs_that_fold() -> Finding:
    """With curves that fold back, pairs make all of the 13, under a length and behind a spring."""
    designs = pairs().items()
    made = {g for g, chain in designs if all(_makes(chain, g, drive) for drive in (None, SPRING))}
    excluded = [graph for graph in graphs() if not possible(graph, plain=False)]
    undecided = len(graphs()) - len(made) - len(excluded)
    folded = [folding(pairs()[graph]) for graph in made]
    return finding_of(
        _count_reached(made) == 13,
        _share(made),
        note=f"{folded.count(0)} with no curve that folds back, {folded.count(1)} with one, "
        f"{folded.count(2)} with two. {len(excluded)} of the 35 are impossible: what they want of "
        f"elements that jump from phase to phase contradicts itself. {undecided} are undecided: in "
        f"each an element flips to and fro in one avalanche, and no design was found.",
    )


def _whether_made(drive: float | None) -> Finding:
    """Whether plain elements make exactly the graphs that are not excluded."""
    plain = ((graph, chain) for graph, chain in pairs().items() if not folding(chain))
    made = {graph for graph, chain in plain if _makes(chain, graph, drive)}
    others = {graph for graph in graphs() if possible(graph, plain=True)}
    return finding_of(
        made == others,
        _share(made),
        note="Where an element goes on, the shared force falls, so that no other one follows it: "
        "in any avalanche the elements go opposite ways. The other graphs have one in which they "
        "do not, and their inequalities contradict each other.",
    )


def folding(chain: Chain) -> int:
    """Number of curves of a chain that fold back."""
    return sum(len(cell.laws) > 1 for cell in chain.elements)


def _makes(chain: Chain, graph: Graph, drive: float | None) -> bool:
    return canonical(graph_of(chain, drive)) == graph


def _count_reached(graphs: Iterable[Graph]) -> int:
    """Number of different graphs without their Gardens of Eden."""
    return len({canonical(reached(graph)) for graph in graphs})


def _share(made: set[Graph]) -> str:
    return f"{len(made)} of {len(graphs())}, {_count_reached(made)} of {_count_reached(graphs())}"


PAIR_CLAIMS = (
    two_hysterons,
    two_hysterons_reached,
    pairs_under_force,
    pairs_under_length,
    pairs_behind_a_spring,
    pairs_that_fold,
)
