"""A unit cell on the test machine compared with its model."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, ByValue, Drawn, Floats
from stepwell.lab.recordings.curve import rms
from stepwell.lab.rig import PAPER_RIG, Rig
from stepwell.lab.series import Series
from stepwell.mechanism import Cell

# Largest RMSE in k r that counts as agreement, if the class is right. F0 of the paper's reference
# cell is 0.967 k r.
CLOSE = 0.15
_ENDS = 2.0e-3  # [m] of the window from which the force at a stop is extrapolated
_POINTS = 401
RISE = 0.005  # least rise of the force that is reported, in k r
_SMOOTH = 11  # samples of the mean curve, half a millimetre


class Rise(NamedTuple):
    """A rise of a force that should fall: range of stroke [m] and height [N]."""

    start: float
    end: float
    height: float


@dataclass(frozen=True, eq=False, repr=False)
class CellReading(ByValue):
    """Measured force on the block against the lever angle.

    Attributes:
        theta: (n,) from stop to stop [rad].
        force: (n,) F [N]; beyond the window extrapolated by a parabola.
        energy: (n,) E from state 0 on [J].
        inside: (n,) where the force was measured.
    """

    theta: Floats = field(repr=False)
    force: Floats = field(repr=False)
    energy: Floats = field(repr=False)
    inside: Bools = field(repr=False)

    @property
    def force_0(self) -> float:
        """F0 [N]."""
        return float(self.force[0])

    @property
    def force_1(self) -> float:
        """F1 [N]."""
        return float(self.force[-1])

    @property
    def barrier(self) -> float:
        """Energy barrier from state 0 [J]."""
        return float(np.max(self.energy) - self.energy[0])

    @property
    def is_bistable(self) -> bool:
        """Whether the energy has its maximum between the stops."""
        top = int(np.argmax(self.energy))
        return 0 < top < len(self.energy) - 1


@dataclass(frozen=True, eq=False)
class CellTest(ByValue, Drawn):
    """Comparison of a series of a unit cell with its model.

    Attributes:
        plain, corrected: the measured force, without and with the correction for the rig's bar.
        model: (n,) force of the model at `plain.theta` [N].
        spread: mean standard deviation between repeats [N].
        rises: ranges in which the force rises but should fall.
    """

    series: Series
    plain: CellReading
    corrected: CellReading
    model: Floats = field(repr=False)
    spread: float
    rises: tuple[Rise, ...]

    @property
    def cell(self) -> Cell:
        """The model."""
        return self.series.chain.levers[0]

    @property
    def rmse(self) -> float:
        """Root mean square of measured less model, in k r."""
        return rms(self._gap(self.plain))

    @property
    def worst(self) -> float:
        """Largest difference, in k r."""
        return float(np.max(np.abs(self._gap(self.plain))))

    @property
    def rmse_corrected(self) -> float:
        """`rmse` corrected for the rig's bar."""
        return rms(self._gap(self.corrected))

    @property
    def rmse_energy(self) -> float:
        """Root mean square of measured less model energy from state 0 on, in k r²."""
        model = self.cell.energy(self.plain.theta)
        gap = (self.plain.energy - (model - model[0]))[self.plain.inside]
        return rms(gap) / (self.series.scale * self.cell.lever)

    @property
    def right_class(self) -> bool:
        """Whether measurement and model agree on bistable or monostable."""
        return self.plain.is_bistable == self.cell.is_bistable

    @property
    def agrees(self) -> bool:
        """Whether the class is right and the force within `CLOSE` k r."""
        return self.right_class and self.rmse <= CLOSE

    @property
    def verdict(self) -> str:
        """Verdict on class and force, with the deviation."""
        kind = "bistable" if self.plain.is_bistable else "monostable"
        if not self.right_class:
            return f"differs: measured {kind}, the model is not"
        if self.agrees:
            return f"agrees: {kind}, force within {self.rmse:.3f} k r"
        size = np.abs(self.plain.force) - np.abs(self.model)
        way = "below" if float(np.sum(size[self.plain.inside])) < 0 else "above"
        return (
            f"differs: {kind} as predicted, but the force is {self.rmse:.3f} k r from the model, "
            f"mostly {way} it in size"
        )

    def _gap(self, reading: CellReading) -> Floats:
        gap = (reading.force - self.cell.force(reading.theta))[reading.inside]
        return gap / self.series.scale

    def __repr__(self):
        return f"CellTest({self.series.name}: {self.verdict})"


def cell_test(series: Series, rig: Rig = PAPER_RIG) -> CellTest:
    """Compare a series of a unit cell with its model; the rig is used for the correction.

    The baseline is subtracted and repeats are averaged. The first 0.5 mm of stroke (slack of the
    rig) and the last 0.25 mm (blocks may touch) are not judged. Forces at the stops are
    extrapolated from the adjacent 2 mm.
    """
    cell, curve, use = series.chain.levers[0], series.curve, series.judged()
    stroke, force = curve.stroke[use], series.net(curve.stroke, curve.force)[use]
    plain = _reading(cell, stroke, force, Rig())
    return CellTest(
        series,
        plain,
        _reading(cell, stroke, force, rig),
        cell.force(plain.theta),
        float(np.mean(curve.spread[use])),
        _rises(stroke, force, RISE * series.scale),
    )


def _reading(cell: Cell, stroke: Floats, force: Floats, rig: Rig) -> CellReading:
    theta = rig.angle(cell, stroke)
    travel, block = cell.travel(theta), force / rig.factor(cell, theta)
    s = np.linspace(0.0, cell.full_travel, _POINTS)
    inside = (s >= travel[0]) & (s <= travel[-1])
    full = np.interp(s, travel, block)
    for edge, beyond in ((travel[0], s < travel[0]), (travel[-1], s > travel[-1])):
        near = np.abs(travel - edge) <= _ENDS
        course = np.polyfit(travel[near] - edge, block[near], 2)
        full[beyond] = np.polyval(course, s[beyond] - edge)
    energy = np.append(0.0, np.cumsum(0.5 * (full[1:] + full[:-1]) * np.diff(s)))
    return CellReading(cell.angle(s), full, energy, inside)


def _rises(stroke: Floats, force: Floats, least: float) -> tuple[Rise, ...]:
    """Ranges in which the force exceeds its minimum so far by more than `least`."""
    force = np.convolve(force, np.ones(_SMOOTH) / _SMOOTH, mode="valid")
    stroke = stroke[_SMOOTH // 2 : -(_SMOOTH // 2)]
    rises: list[Rise] = []
    low = np.minimum.accumulate(force)
    over, start = force - low, 0
    while len(climbing := np.flatnonzero(over[start:] > least)):
        at = start + int(climbing[0])
        foot = int(np.flatnonzero(force[: at + 1] == low[at])[-1])
        back = np.flatnonzero(force[at:] <= force[foot])
        end = at + int(back[0]) if len(back) else len(force) - 1
        top = foot + int(np.argmax(force[foot : end + 1]))
        rises.append(Rise(float(stroke[foot]), float(stroke[top]), float(force[top] - force[foot])))
        start = end + 1
    return tuple(rises)
