"""Races of snapping cells, integrated by SciPy from event to event: slow, tight, independent.

It shares no code with the package it judges. A cell slides outwards, slides inwards, goes either
way (inside, without friction) or rests. While none of that changes the flow

    ds_i/dt = m_i (λ - F_i -+ f_i),    λ with Σ ds_i/dt = dU/dt, or λ = K (U - Σ s_i)

is smooth; it is integrated with a tolerance of 1e-11, and the next change is a root of SciPy's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.integrate import LSODA

import oracle

UP, DOWN, EITHER, REST = 1, -1, 2, 0
MAX_EVENTS = 400


class NoRest(RuntimeError):
    """The race does not come to rest in the time there is."""


class Race:
    """Cells as the oracle takes them, and an actuator of stiffness K [N/m], inf for a stroke."""

    def __init__(self, cells: Sequence[oracle.OracleCell], stiffness: float = math.inf):
        self.stiffness = stiffness
        self.packed = oracle._pack(cells)
        self.span = self.packed[0][: len(cells), oracle.SPAN]
        self.rubs = np.array([cell.friction for cell in cells])
        self.mobility = self.packed[0][: len(cells), oracle.MOBILITY]
        force = np.array([cell.force(np.linspace(0, cell.span, 400)) for cell in cells])
        self.scale = float(np.max(np.abs(force)))
        self.stiffest = float(np.max(np.abs(np.diff(force)) / self.span[:, None] * 399))

    def forces(self, travel: np.ndarray) -> np.ndarray:
        place = np.clip(travel, 0.0, self.span)
        return np.array([oracle._cell_force(i, s, *self.packed) for i, s in enumerate(place)])

    def land(
        self, start: np.ndarray, direction: int, drive: float, push: float = 1e-8
    ) -> np.ndarray:
        """(N,) travels where a chain comes to rest that stands where it is about to snap.

        The drive goes on by `push` times the shortest travel, at the pace of the stiffest cell,
        and then stays.
        """
        s = start.copy()
        push *= direction * float(np.min(self.span))
        lasts = 1.0 / self.stiffest
        s = self._until_rest(s, drive, push / lasts, lasts)
        return self._until_rest(s, drive + push, 0.0, 2e6 / self.stiffest)

    def _level(self, s: np.ndarray, drive: float, pace: float, near: float | None) -> float:
        if math.isfinite(self.stiffness):
            return self.stiffness * (drive - float(np.sum(s)))
        force = self.forces(s)
        up, down = force + self.rubs, force - self.rubs

        def excess(level: float) -> float:
            rises = np.where(s < self.span, np.maximum(level - up, 0.0), 0.0)
            falls = np.where(s > 0.0, np.maximum(down - level, 0.0), 0.0)
            return float(np.sum(self.mobility * (rises - falls))) - pace

        kinks = np.sort(np.concatenate([up[s < self.span], down[s > 0.0]]))
        kinks = np.concatenate([[kinks[0] - 10 * self.scale], kinks, [kinks[-1] + 10 * self.scale]])
        over = np.array([excess(k) for k in kinks])
        flat = kinks[over == 0.0]
        if len(flat):
            near = flat[0] if near is None else near
            return min(max(near, flat[0]), flat[-1])
        k = int(np.flatnonzero(over < 0.0)[-1])
        return float(kinks[k] - over[k] * (kinks[k + 1] - kinks[k]) / (over[k + 1] - over[k]))

    def _until_rest(self, s: np.ndarray, drive: float, pace: float, lasts: float) -> np.ndarray:
        at, level = 0.0, None
        for _ in range(MAX_EVENTS):
            force = self.forces(s)
            level = self._level(s, drive + pace * at, pace, level)
            up, down = level - force - self.rubs, level - force + self.rubs
            slip = 1e-13 * self.scale
            sense = np.where((up > slip) & (s < self.span), UP, REST)
            sense = np.where((down < -slip) & (s > 0.0), DOWN, sense)
            inside = (s > 0.0) & (s < self.span)
            sense = np.where(inside & (self.rubs == 0.0), EITHER, sense)
            driven = np.where(sense == UP, up, np.where(sense == DOWN, down, 0.0))
            driven = np.where(sense == EITHER, level - force, driven)
            if pace == 0.0 and np.max(np.abs(driven)) < 1e-11 * self.scale:
                return s
            s, at, settled = self._smooth(s, sense, drive, pace, at, lasts)
            if settled or at >= lasts:
                if pace == 0.0 and not settled:
                    raise NoRest("the race does not come to rest")
                return s
        raise NoRest(f"more than {MAX_EVENTS} events")

    def _smooth(self, s, sense, drive, pace, at, lasts):
        n, moves = len(s), sense != REST
        rub = np.where(sense == EITHER, 0, sense) * self.rubs
        mobility = np.where(moves, self.mobility, 0.0)

        def level_at(t, y, force):
            if math.isfinite(self.stiffness):
                return self.stiffness * (drive + pace * t - np.sum(y))
            return (np.sum(mobility * (force + rub)) + pace) / np.sum(mobility)

        def rates(t, y):
            force = self.forces(y)
            return mobility * (level_at(t, y, force) - force - rub)

        watched = []
        for i in range(n):
            if sense[i] in (UP, EITHER):
                watched.append(lambda y, force, level, i=i: self.span[i] - y[i])
            if sense[i] in (DOWN, EITHER):
                watched.append(lambda y, force, level, i=i: y[i])
            if sense[i] in (UP, DOWN):
                watched.append(lambda y, force, level, i=i: (level - force[i] - rub[i]) * sense[i])
            if sense[i] == REST and s[i] < self.span[i]:
                watched.append(lambda y, force, level, i=i: force[i] + self.rubs[i] - level + slip)
            if sense[i] == REST and s[i] > 0.0:
                watched.append(lambda y, force, level, i=i: level - force[i] + self.rubs[i] + slip)

        def least(t, y):
            force = self.forces(y)
            level = level_at(t, y, force)
            return min((gap(y, force, level) for gap in watched), default=math.inf)

        slip, first = 2e-13 * self.scale, 1e-3 / self.stiffest
        first = first if at + first < lasts else None
        run = LSODA(rates, at, s, lasts, first, rtol=1e-11, atol=1e-14 * float(self.span.min()))
        at_rest = False
        while run.status == "running" and not at_rest:
            message = run.step()
            if run.status == "failed":
                raise NoRest(message)
            if least(run.t, run.y) < 0.0:
                early, late, between = run.t_old, run.t, run.dense_output()
                while True:
                    middle = 0.5 * (early + late)
                    if not early < middle < late:
                        break
                    if least(middle, between(middle)) < 0.0:
                        late = middle
                    else:
                        early = middle
                at, s = late, between(late)
                break
            at, s = run.t, run.y
            driven = rates(at, s) / self.mobility
            at_rest = pace == 0.0 and float(np.max(np.abs(driven))) < 1e-11 * self.scale
        near = 1e-11 * self.span
        s = np.where((s >= self.span - near) & (sense != REST), self.span, s)
        s = np.where((s <= near) & (sense != REST), 0.0, s)
        return s, at, at_rest
