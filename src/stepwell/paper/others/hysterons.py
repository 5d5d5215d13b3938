"""Every transition graph that two hysterons can have whose switching fields depend on the state."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import permutations

# A graph as a sorted tuple of ways, such as "01+12": from 01 a rising drive flips cell 1, then 2.
Graph = tuple[str, ...]
# Where which field is: row of a state, place of a cell.
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
    """Every graph of two hysterons, of those that differ by the numbers of the cells one.

    Only the order of the eight fields counts, so all orders are tried in which each of the four
    states stands at some drive. An avalanche that comes back to a state where it was, or in which
    two hysterons are past their fields at once, has no graph.

    Source: the model is that of van Hecke 2021, Phys. Rev. E 104, 054608, and of Teunisse and van
    Hecke 2025, R. Soc. Open Sci. 12, 250753; the enumeration is ours.
    """
    found = {graph for fields in _orders() if (graph := _graph(fields)) is not None}
    return tuple(sorted({canonical(graph) for graph in found}))


def canonical(graph: Graph) -> Graph:
    """The one of a graph and the same with its cells renumbered that comes first."""
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
    found = [way[:2]]
    for cell in way[3:]:
        found.append(_flipped(found[-1], int(cell) - 1))
    return tuple(found)


def way_to(state: str, sign: str, first: int, end: str) -> str:
    """The way from one state to another on which this cell flips first; 0 is the inner one.

    Two cells take turns, so where an avalanche ends tells how often they did.
    """
    way, cell = f"{state}{sign}", first
    for _ in range(3):
        way += str(cell + 1)
        if stations(way)[-1] == end:
            return way
        cell = 1 - cell
    raise AssertionError(f"no way from {state} to {end}")


def _orders() -> Iterator[_Fields]:
    """Fields in every order in which each state stands at some drive."""
    for order in permutations(range(8)):
        fields = {state: (order[2 * k], order[2 * k + 1]) for k, state in enumerate(_STATES)}
        # Only 01 and 10 have both an up and a down field.
        if fields["01"][1] < fields["01"][0] and fields["10"][0] < fields["10"][1]:
            yield fields


def _graph(fields: _Fields) -> Graph | None:
    ways: list[str] = []
    for state, sign in _WAYS:
        flips = _avalanche(fields, state, sign)
        if flips is None:
            return None
        ways.append(f"{state}{sign}{flips}")
    return tuple(sorted(ways))


def _avalanche(fields: _Fields, state: str, sign: str) -> str | None:
    """The cells that flip when a state ends, in their order; None where the model is silent."""
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
            i
            for i in (0, 1)
            if (drive > fields[state][i] if state[i] == "0" else drive < fields[state][i])
        ]
        if not past:
            return flips
        if len(past) > 1:
            return None
        (cell,) = past


def _flipped(state: str, cell: int) -> str:
    other = "1" if state[cell] == "0" else "0"
    return state[:cell] + other + state[cell + 1 :]


def _renumbered(graph: Graph) -> Graph:
    swap = str.maketrans("12", "21")
    return tuple(sorted(way[1::-1] + way[2] + way[3:].translate(swap) for way in graph))
