"""Snaps and orders of pairs as a calibrated model predicts them, beside those measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.lab.calibration.samples import Weighing
from stepwell.lab.mechanisms import PAPER_RIG, Geometry, PairTest, Rig, mover, path_of
from stepwell.mechanism import Band, Cell, Chain, Law, Load
from stepwell.statics import EventKind

# The force is read before a snap over this stroke [m]; it falls no slower than so [N/m].
_BEFORE, _FLATTEST = 1e-3, 20.0
_EARLY = 0.25  # of the stroke, where the first cell moves


@dataclass(frozen=True)
class Model:
    """What a fit says of mechanisms and of the rig.

    Attributes:
        values: fitted numbers by name.
        law: of all bands.
        weighing: weight and friction of the machine; None where they are not known.
        given: by which the rig gives way [m/N].
    """

    values: Mapping[str, float]
    law: Law
    weighing: Weighing | None
    given: float

    @property
    def rig(self) -> Rig:
        """The rig of the pairs; its bar is not in the fit."""
        friction = 0.0 if self.weighing is None else self.weighing.friction
        return Rig(
            PAPER_RIG.bar,
            self.values.get("travel", 1.0),
            self.values.get("start_loading", 0.0),
            self.values.get("start_unloading", 0.0),
            self.given,
            0.0 if math.isnan(friction) else friction,
        )

    @property
    def weight(self) -> float:
        """Of the block between two cells [N]; 0 where nothing tells it."""
        return 0.0 if self.weighing is None else self.weighing.weight

    def applied(self, chain: Chain, stiffness: Callable[[Cell], float]) -> Chain:
        """A chain with these bands, and with this weight and friction where they are known.

        Args:
            chain: of cells; the bands of each share the stiffness as they do now.
            stiffness: of all bands of a cell together [N/m].

        Returns:
            The chain, its anchors, levers and stops as they were.
        """
        cells = chain.levers
        return replace(
            chain,
            cells=[self._cell(cell, stiffness(cell), cell is not cells[-1]) for cell in cells],
        )

    def _cell(self, cell: Cell, stiffness: float, inner: bool) -> Cell:
        total = sum(band.stiffness for band in cell.bands)
        bands = [
            Band(
                band.p,
                band.q,
                stiffness * band.stiffness / total,
                self.values["rest_length"],
                self.law,
            )
            for band in cell.bands
        ]
        theta = np.linspace(-cell.limit, cell.limit, 41)
        tension = sum((band.tension(band.length(theta, cell.lever)) for band in bands), 0.0 * theta)
        joints = self.values.get("joints")
        friction = cell.friction if joints is None else joints * float(np.mean(tension))
        load = Load.constant(self.weight) if inner and self.weight else cell.load
        return replace(
            cell, band=bands[0] if len(bands) == 1 else bands, load=load, friction=friction
        )


@dataclass(frozen=True, eq=False)
class SnapPrediction(ByValue):
    """What a fit says of a series of a pair whose snaps had no part in it.

    Attributes:
        series: its name.
        geometry: d of the outer cell, which was left out [m].
        measured, spread: mean and standard deviation of the first snaps [m]; NaN for none.
        reached: the last stroke of the recordings, in the direction of motion [m].
        plain: predicted without a fit [m]; NaN for no snap.
        fitted: predicted with its own curves, up to the snap [m]: they are in the fit, and what it
            misses of the forces of its cells, at the ends of what was used, is added.
        left_out: predicted from the other geometries alone [m].
        doubt: standard deviation of `left_out` less `measured` [m].
        order_seen, order: names of the cells, as the forces show them and as predicted from the
            other geometries; of `order_seen` how many times the other order fits worse is `ratio`.
    """

    series: str
    geometry: Geometry
    measured: float
    spread: float
    reached: float
    plain: float
    fitted: float
    left_out: float
    doubt: float
    order_seen: tuple[str, ...]
    order: tuple[str, ...]
    ratio: float = field(default=math.nan)

    @property
    def error(self) -> float:
        """Of `left_out` [m]; NaN where there is none or no snap was seen."""
        return self.left_out - self.measured

    @property
    def covered(self) -> bool | None:
        """Whether the 90 % interval of `left_out` holds what was measured; None for no snap.

        Where a snap is predicted and none was seen, it holds if it reaches past the last stroke.
        """
        if math.isnan(self.left_out):
            return None if math.isnan(self.measured) else False
        wide = 1.645 * self.doubt
        if math.isnan(self.measured):
            return abs(self.left_out - self.reached) <= wide
        return abs(self.error) <= wide

    def __repr__(self):
        return (
            f"SnapPrediction({self.series}: measured {self.measured * 1e3:.2f} mm, predicted "
            f"{self.left_out * 1e3:.2f} ± {self.doubt * 1e3:.2f} mm)"
        )


def snap_of(
    model: Model, test: PairTest, stiffness: float, missed: Sequence[float] = ()
) -> tuple[float, float]:
    """Where a pair snaps first.

    Args:
        model: of its cells and of the rig.
        test: the pair.
        stiffness: of all bands of a cell together [N/m].
        missed: by how much the forces of the cells are larger than the model's [N].

    Returns:
        Stroke of the machine [m], NaN for no snap, and how steeply the force falls there [N/m].
    """
    chain = model.applied(test.series.chain, lambda _: stiffness)
    for i, more in enumerate(missed):
        cell = chain.levers[i]
        load = (0.0 if cell.load is None else cell.load.force[0]) + more
        chain = replace(
            chain,
            cells=[
                replace(one, load=Load.constant(load)) if k == i else one
                for k, one in enumerate(chain.levers)
            ],
        )
    unloading = test.series.unloading
    path = path_of(chain, unloading)
    events = [event for event in path.events if event.kind is EventKind.SNAP]
    if not events:
        return math.nan, math.nan
    event, way = events[0], -1.0 if unloading else 1.0
    at = model.rig.at_machine(event.stroke, event.force_before, chain.full_stroke, unloading)
    order = np.argsort(path.stroke, kind="stable")
    ends = event.stroke - way * np.array([_BEFORE, 1e-6])
    rise = np.diff(np.interp(ends, path.stroke[order], path.force[order]))[0] / _BEFORE
    return float(at), max(abs(float(rise)), _FLATTEST)


def order_of(model: Model, test: PairTest, stiffness: float) -> tuple[str, ...]:
    """Names of the cells in the order in which the model moves them."""
    chain = model.applied(test.series.chain, lambda _: stiffness)
    share = 1.0 - _EARLY if test.series.unloading else _EARLY
    path = path_of(chain, test.series.unloading)
    at: Floats = np.array([share - 0.01, share, share + 0.01]) * chain.full_stroke
    first = int(mover(path, at)[0][1])
    return tuple(chain.names[i] for i in (first, 1 - first))
