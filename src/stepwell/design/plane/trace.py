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
    columns = label.shape[1]
    across = _unlike(label[:, :-1], label[:, 1:], ignore)  # edge (row, column)-(row, column + 1)
    upward = _unlike(label[:-1], label[1:], ignore)  # edge (row, column)-(row + 1, column)
    # Edges by number: first all that go across, then all that go up.
    shift = across.size
    crossed = np.flatnonzero(np.concatenate([across.ravel(), upward.ravel()])).tolist()
    links: dict[int, list[int]] = {edge: [] for edge in crossed}

    def link(a: int, b: int) -> None:
        links[a].append(b)
        links[b].append(a)

    r, c = np.nonzero(across[:-1] | across[1:] | upward[:, :-1] | upward[:, 1:])
    bottom, left = r * (columns - 1) + c, shift + r * columns + c
    edges = np.stack([bottom, left + 1, bottom + columns - 1, left], axis=1)
    corners = np.stack([label[r, c], label[r, c + 1], label[r + 1, c + 1], label[r + 1, c]], axis=1)
    codes = _codes(corners, np.roll(corners, -1, axis=1), ignore)
    squares = zip(edges.tolist(), codes.tolist(), r.tolist(), c.tolist(), strict=True)
    for around, code, row, column in squares:
        if code[0] and len(set(code)) == 1:
            bottom, right, top, left = around
            if centre(row, column) == label[row, column]:
                link(bottom, right)
                link(top, left)
            else:
                link(bottom, left)
                link(top, right)
            continue
        for one in dict.fromkeys(code):
            if one and code.count(one) == 2:
                link(*(edge for edge, own in zip(around, code, strict=True) if own == one))

    lines: list[Crossings] = []
    for chain in _chains(links):
        edge = np.array(chain)
        goes_up = edge >= shift
        width = np.where(goes_up, columns, columns - 1)
        low = np.stack(np.divmod(edge - shift * goes_up, width), axis=1)
        high = low + np.stack([goes_up, ~goes_up], axis=1)
        a, b = sorted((int(label[tuple(low[0])]), int(label[tuple(high[0])])))
        lines.append(Crossings((a, b), low, high))
    return lines


def _unlike(a: Ints, b: Ints, ignore: int | None) -> Bools:
    unlike = a != b
    return unlike if ignore is None else unlike & (a != ignore) & (b != ignore)


def _codes(a: Ints, b: Ints, ignore: int | None) -> Ints:
    """A positive number for every pair of unlike labels, whichever comes first; 0 for others."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    least, most = np.min(low, initial=0), np.max(high, initial=0)
    code = 1 + (low - least) * (most - least + 1) + high - least
    return np.where(_unlike(a, b, ignore), code, 0)


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
