"""Nodes in columns, put in an order in which few of the lines between them cross."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stepwell.base import Bools, Floats

_SWEEPS = 12
# Length counts too, but a crossing is worse than any.
_LENGTH = 0.02


def heights(
    columns: Mapping[str, float],
    fixed: Sequence[str],
    lines: Sequence[tuple[str, str, float]],
    *,
    stay: bool = False,
) -> dict[str, float]:
    """The height of every node, between 0 and 1.

    Nodes named in `fixed` share the height of their column evenly, in the order found; all
    others float between those they are joined to. The same nodes always get the same heights.

    Args:
        columns: the column of each node.
        fixed: nodes that need room for their names.
        lines: pairs of nodes that are joined, and how much their distance counts.
        stay: keep nodes in a column by their names, as they count up.
    """
    order: dict[float, list[str]] = {}
    for name in fixed:
        order.setdefault(columns[name], []).append(name)
    sheet = _Crossings(columns, fixed, lines)
    if stay:
        return sheet.all(_slots({column: sorted(names) for column, names in order.items()}))
    best, cost = _slots(order), np.inf
    for sweep in range(_SWEEPS):
        now = sheet.cost(_slots(order))
        if now < cost:
            best, cost = _slots(order), now
        for column in sorted(order, reverse=bool(sweep % 2)):
            wanted = sheet.means(_slots(order))
            order[column].sort(key=lambda name: wanted[name])
    for column in order:
        order[column].sort(key=lambda name: best[name])
    _swap(sheet, order, cost)
    return sheet.all(_slots(order))


def _slots(order: Mapping[float, Sequence[str]]) -> dict[str, float]:
    return {
        name: (k + 0.5) / len(names) for names in order.values() for k, name in enumerate(names)
    }


def _swap(sheet: _Crossings, order: dict[float, list[str]], cost: float) -> None:
    """Exchange two nodes of a column as long as that helps."""
    better = True
    while better:
        better = False
        for names in order.values():
            for i in range(len(names)):
                for j in range(i + 1, len(names)):
                    names[i], names[j] = names[j], names[i]
                    now = sheet.cost(_slots(order))
                    if now < cost - 1e-9:
                        cost, better = now, True
                    else:
                        names[i], names[j] = names[j], names[i]


class _Crossings:
    """Nodes by number, so that a trial costs little."""

    def __init__(
        self,
        columns: Mapping[str, float],
        fixed: Sequence[str],
        lines: Sequence[tuple[str, str, float]],
    ):
        self.fixed = list(fixed)
        self.floating = sorted(set(columns) - set(fixed), key=lambda n: (columns[n], n))
        self.names = self.fixed + self.floating
        number = {name: k for k, name in enumerate(self.names)}
        self.x = np.array([columns[name] for name in self.names])
        self.ends = np.array([(number[a], number[b]) for a, b, _ in lines]).reshape(-1, 2)
        self.weights = np.array([weight for *_, weight in lines])
        joined = np.zeros((len(self.names),) * 2)
        np.add.at(joined, (self.ends[:, 0], self.ends[:, 1]), self.weights)
        self.joined = joined + joined.T
        # A floating node joined to another one follows it: solve for all at once.
        n = len(self.fixed)
        share = self.joined / np.maximum(self.joined.sum(axis=1), 1e-12)[:, None]
        loose = np.eye(len(self.floating)) - share[n:, n:]
        self.follow = np.linalg.lstsq(loose, share[n:, :n], rcond=None)[0]
        self.share = share
        first, second = np.triu_indices(len(self.ends), 1)
        a, b = self.ends[first], self.ends[second]
        apart = (a[:, :, None] != b[:, None, :]).all(axis=(1, 2))
        low_a, high_a = np.sort(self.x[a], axis=1).T
        low_b, high_b = np.sort(self.x[b], axis=1).T
        # Only lines that share a stretch of the page can cross.
        near = apart & (np.minimum(high_a, high_b) > np.maximum(low_a, low_b))
        self.pairs = a[near], b[near]

    def _y(self, slots: Mapping[str, float]) -> Floats:
        own = np.array([slots[name] for name in self.fixed])
        return np.concatenate([own, self.follow @ own])

    def cost(self, slots: Mapping[str, float]) -> float:
        """Crossings of straight lines, and a little for their length."""
        xy = np.column_stack([self.x, self._y(slots)])
        (p, q), (r, s) = ((xy[ends[:, 0]], xy[ends[:, 1]]) for ends in self.pairs)
        crossing = (_side(p, q, r) != _side(p, q, s)) & (_side(r, s, p) != _side(r, s, q))
        rise = np.abs(np.diff(xy[self.ends, 1], axis=1)[:, 0])
        return float(np.count_nonzero(crossing) + _LENGTH * (self.weights @ rise))

    def means(self, slots: Mapping[str, float]) -> dict[str, float]:
        """The mean height of what each node is joined to."""
        return dict(zip(self.names, (self.share @ self._y(slots)).tolist(), strict=True))

    def all(self, slots: Mapping[str, float]) -> dict[str, float]:
        return dict(zip(self.names, self._y(slots).tolist(), strict=True))


def _side(p: Floats, q: Floats, r: Floats) -> Bools:
    """Whether r lies left of the line from p to q."""
    (ux, uy), (vx, vy) = (q - p).T, (r - p).T
    return ux * vy > uy * vx
