"""Curves between the differently labelled nodes of a grid, as polylines."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, Ints


@dataclass(frozen=True)
class Crossings:
    """The grid edges that one curve crosses, in order.

    `low` and `high` are (m, 2) int, the (row, column) of both ends of each edge; the label is
    `labels[0]` at one of them and `labels[1]` at the other. A closed curve repeats its start.
    """

    labels: tuple[int, int]
    low: Ints
    high: Ints


def trace(
    label: Ints, centre: Callable[[int, int], int], ignore: int | None = None
) -> list[Crossings]:
    """All curves between unlike nodes, one for every pair of labels that meet along it.

    Args:
        label: (ny, nx) int.
        centre: label in the middle of the square whose lower corner is node (row, column);
            asked only where two curves enter one square and could be joined both ways.
        ignore: a label around which no curve is drawn.

    Returns:
        Curves in no particular order. Where three labels meet, curves end within that square.
    """
    rows, columns = label.shape
    across = _unlike(label[:, :-1], label[:, 1:], ignore)  # edge (row, column)-(row, column + 1)
    upward = _unlike(label[:-1], label[1:], ignore)  # edge (row, column)-(row + 1, column)
    # Edges by number: first all that go across, then all that go up.
    shift = rows * (columns - 1)

    def pair(edge: int) -> tuple[int, int]:
        (r0, c0), (r1, c1) = ends(edge)
        a, b = int(label[r0, c0]), int(label[r1, c1])
        return min(a, b), max(a, b)

    def ends(edge: int) -> tuple[tuple[int, int], tuple[int, int]]:
        if edge < shift:
            r, c = divmod(edge, columns - 1)
            return (r, c), (r, c + 1)
        r, c = divmod(edge - shift, columns)
        return (r, c), (r + 1, c)

    crossed = {int(r) * (columns - 1) + int(c) for r, c in np.argwhere(across)}
    crossed |= {shift + int(r) * columns + int(c) for r, c in np.argwhere(upward)}
    links: dict[int, list[int]] = {edge: [] for edge in crossed}

    def link(a: int, b: int) -> None:
        links[a].append(b)
        links[b].append(a)

    touched = across[:-1] | across[1:] | upward[:, :-1] | upward[:, 1:]
    for r, c in np.argwhere(touched).tolist():
        bottom, top = r * (columns - 1) + c, (r + 1) * (columns - 1) + c
        left, right = shift + r * columns + c, shift + r * columns + c + 1
        around = [edge for edge in (bottom, right, top, left) if edge in links]
        if len(around) == 4 and len({pair(edge) for edge in around}) == 1:
            if centre(r, c) == label[r, c]:
                link(bottom, right)
                link(top, left)
            else:
                link(bottom, left)
                link(top, right)
            continue
        by_pair: dict[tuple[int, int], list[int]] = {}
        for edge in around:
            by_pair.setdefault(pair(edge), []).append(edge)
        for same in by_pair.values():
            if len(same) == 2:
                link(*same)

    return [
        Crossings(pair(chain[0]), *(np.array([ends(e)[k] for e in chain]) for k in (0, 1)))
        for chain in _chains(links)
    ]


def _unlike(a: Ints, b: Ints, ignore: int | None) -> Bools:
    unlike = a != b
    return unlike if ignore is None else unlike & (a != ignore) & (b != ignore)


def _chains(links: dict[int, list[int]]) -> list[list[int]]:
    # Open curves first, from an end; what is left then are closed ones.
    chains: list[list[int]] = []
    seen: set[int] = set()
    starts = sorted(e for e in links if len(links[e]) < 2) + sorted(links)
    for start in starts:
        if start in seen:
            continue
        chain = [start]
        seen.add(start)
        following = links[start][0] if links[start] else None
        while following is not None and following not in seen:
            chain.append(following)
            seen.add(following)
            following = next((e for e in links[following] if e not in seen), None)
        if len(chain) > 2 and len(links[start]) == 2:
            chain.append(start)
        chains.append(chain)
    return chains
