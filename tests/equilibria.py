"""All equilibria of chains whose forces are straight between points, found one by one.

Shares nothing with the engine: every choice of a straight piece for each cell is a small linear
system, its stability the least eigenvalue of a matrix, and a snap a flow in small steps.
"""

import itertools
import math
from bisect import bisect_left
from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Curve:
    """A force that is straight between points, going on straight or stopped at its ends."""

    travel: tuple[float, ...]
    force: tuple[float, ...]
    stops: tuple[bool, bool] = (False, False)

    @cached_property
    def pieces(self):
        """(low, high, force at travel 0, stiffness) of each, stops left out."""
        x, y = np.array(self.travel), np.array(self.force)
        k = np.diff(y) / np.diff(x)
        low, high = x[:-1].copy(), x[1:].copy()
        if not self.stops[0]:
            low[0] = -math.inf
        if not self.stops[1]:
            high[-1] = math.inf
        return [
            (a, b, f - s * x0, s)
            for a, b, f, s, x0 in zip(low, high, y[:-1], k, x[:-1], strict=True)
        ]

    def at(self, s: float) -> float:
        """Force at a travel."""
        k = min(max(bisect_left(self.travel, s) - 1, 0), len(self.travel) - 2)
        _, _, begin, slope = self.pieces[k]
        return begin + slope * s

    def digit(self, s: float) -> str:
        """What a state calls a travel."""
        names, first, last = self.digits()
        if self.stops[0] and s <= self.travel[0]:
            return first
        if self.stops[1] and s >= self.travel[-1]:
            return last
        return names[int(np.clip(np.searchsorted(self.travel, s) - 1, 0, len(names) - 1))]

    def digits(self):
        """What a state calls each piece, and then the low and the high stop."""
        rises = [k > 0 for *_, k in self.pieces]
        if self.stops[0] and not rises[0]:
            rises.insert(0, True)
            lead = 1
        else:
            lead = 0
        names, phase, was = [], -1, False
        for rise in rises:
            phase += rise and not was
            names.append(str(phase) if rise else "-")
            was = rise
        end = str(phase) if was else str(phase + 1)
        return names[lead:], "0", end


@dataclass
class Stretch:
    """Stable equilibria on one piece of every cell, from the least to the largest force."""

    choice: tuple[int, ...]
    state: str
    drive: tuple[float, float]
    travel: tuple[np.ndarray, np.ndarray]


def stretches(curves: list[Curve], alpha: float, beta: float) -> list[Stretch]:
    """Every stable one, for the drive α Σ s + β λ."""
    choices = []
    for curve in curves:
        names, first, last = curve.digits()
        own = [(name, *piece) for name, piece in zip(names, curve.pieces, strict=True)]
        x, y = curve.travel, curve.force
        # At a stop the travel stands while the force is anything on one side.
        own += [(first, x[0], x[0], y[0], -math.inf)] * curve.stops[0]
        own += [(last, x[-1], x[-1], y[-1], math.inf)] * curve.stops[1]
        choices.append(own)
    found = []
    for choice in itertools.product(*(range(len(own)) for own in choices)):
        own = [choices[i][k] for i, k in enumerate(choice)]
        low, high = -1e9, 1e9
        for _, a, b, begin, k in own:
            if math.isinf(k):
                low, high = (low, min(high, begin)) if k < 0 else (max(low, begin), high)
            else:
                ends = sorted(begin + k * s if math.isfinite(s) else s * k for s in (a, b))
                low, high = max(low, ends[0]), min(high, ends[1])
        if low >= high or not _stable([k for *_, k in own], alpha, beta):
            continue
        low, high = max(low, -1e3), min(high, 1e3)
        travel = [
            np.array([s if math.isinf(k) else (f - begin) / k for _, s, _, begin, k in own])
            for f in (low, high)
        ]
        drives = [alpha * float(np.sum(travel[k])) + beta * f for k, f in enumerate((low, high))]
        state = "".join(name for name, *_ in own)
        found.append(Stretch(choice, state, (drives[0], drives[1]), (travel[0], travel[1])))
    return found


def _stable(stiffness: list[float], alpha: float, beta: float) -> bool:
    free = np.array([k for k in stiffness if math.isfinite(k)])
    if not len(free):
        return True
    matrix = np.diag(free)
    if alpha and beta:
        matrix = matrix + np.ones_like(matrix) * alpha / beta
    elif alpha:
        if len(free) == 1:
            return True
        # Ways on which Σ s stays as it is.
        basis = np.linalg.svd(np.ones((1, len(free))))[2][1:]
        matrix = basis @ matrix @ basis.T
    return float(np.min(np.linalg.eigvalsh(matrix))) > 0


@dataclass(frozen=True)
class Place:
    """All equilibria of one state that are connected."""

    state: str
    low: float
    high: float


def places(curves: list[Curve], alpha: float, beta: float) -> list[Place]:
    """Every connected family of stable equilibria in one state."""
    every = stretches(curves, alpha, beta)
    group = list(range(len(every)))
    for i, j in itertools.combinations(range(len(every)), 2):
        if every[i].state == every[j].state and any(
            np.allclose(a, b, rtol=0, atol=1e-12) for a in every[i].travel for b in every[j].travel
        ):
            group = [group[i] if g == group[j] else g for g in group]
    found = []
    for g in set(group):
        own = [one for one, mine in zip(every, group, strict=True) if mine == g]
        drives = [d for one in own for d in one.drive]
        found.append(Place(own[0].state, min(drives), max(drives)))
    return found


def landed(curves: list[Curve], travel, drive: float, alpha: float, beta: float) -> np.ndarray:
    """Where overdamped flow at a fixed drive brings the cells, all of one mobility."""
    s = np.array(travel, float)
    stiff = max(abs(k) for curve in curves for *_, k in curve.pieces)
    stiff += len(curves) * (alpha / beta if beta else 0.0)
    low = np.array([c.travel[0] if c.stops[0] else -math.inf for c in curves])
    high = np.array([c.travel[-1] if c.stops[1] else math.inf for c in curves])
    step = 0.2 / stiff
    for _ in range(200_000):
        force = np.array([curve.at(x) for curve, x in zip(curves, s, strict=True)])
        if beta:
            pull = (drive - alpha * float(np.sum(s))) / beta
        else:
            pull = float(np.mean(force)) + (drive - float(np.sum(s))) / (step * len(s))
        moved = np.clip(s + step * (pull - force), low, high)
        if np.max(np.abs(moved - s)) < 1e-13:
            break
        s = moved
    return s
