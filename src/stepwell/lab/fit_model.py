"""The fitted model, rubber with a loss on a compliant rig, and its predictions."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from stepwell import mechanism
from stepwell.base import ByValue, Floats, to_unit
from stepwell.lab.fit_samples import Sample, Weighing, rubber_name
from stepwell.lab.pair_test import fall_before, snaps_of
from stepwell.lab.rig import PAPER_RIG, Rig, mover, path_of
from stepwell.lab.series import Geometry, Series


class Number(NamedTuple):
    """A number that can be fitted: unit, start, bounds and typical size."""

    unit: str
    start: float
    low: float
    high: float
    size: float


# There is one stiffness for each kind of rubber, and one start for each direction.
_NUMBERS = {
    "stiffness": Number("N/m", 40.0, 0.1, 1e4, 10.0),
    "rest_length": Number("m", 0.010, 0.0, 0.1, 0.005),
    "quadratic": Number("1/m", 0.0, -1e3, 1e3, 20.0),
    "cubic": Number("1/m²", 0.0, -1e6, 1e6, 500.0),
    "loss": Number("1", 0.1, 0.0, 0.95, 0.1),
    "loss_length": Number("m", 0.003, 1e-4, 0.1, 0.003),
    "friction": Number("N", 0.0, -1.0, 1.0, 0.02),
    "joints": Number("1", 0.01, 0.0, 0.5, 0.02),
    "travel": Number("1", 1.0, 0.9, 1.1, 0.01),
    "start": Number("m", 0.0, -3e-3, 3e-3, 3e-4),
}
LAWS: dict[str, tuple[str, ...]] = {"linear": (), "cubic": ("quadratic", "cubic")}


def number(name: str) -> Number:
    """Bounds and unit of a number by its name, such as "stiffness_2_in_pairs"."""
    return _NUMBERS.get(name) or _NUMBERS[name.partition("_")[0]]


def numbers_of(samples: Sequence[Sample], law: str) -> list[str]:
    """Names of the identified numbers: of the rig by pairs, of joints by pairs both ways."""
    rubbers = sorted({sample.rubber for sample in samples})
    pairs = {sample.unloading for sample in samples if sample.in_pair}
    joints = ["joints"] if len(pairs) == 2 else []
    starts = [f"start_{'un' * way}loading" for way in sorted(pairs)]
    rig = ["travel", *starts] if pairs else []
    rubber = "rest_length", *LAWS.get(law, ()), "loss", "loss_length"
    return [*rubbers, *rubber, "friction", *joints, *rig]


def law_of(
    law: str, values: Mapping[str, float], tables: Mapping[str, mechanism.Table]
) -> mechanism.Law:
    """The law of a band by its name and its fitted numbers."""
    if law in tables:
        return tables[law]
    cubic = mechanism.Cubic(values.get("quadratic", 0.0), values.get("cubic", 0.0))
    return cubic if cubic.a2 or cubic.a3 else mechanism.Linear()


@dataclass(frozen=True)
class Rows:
    """Columns (n,) over all samples that do not depend on the fitted numbers."""

    way: Floats
    before: Floats
    lever: Floats
    sin_limit: Floats
    dx: Floats
    dy: Floats
    bands: Floats
    direction: Floats  # +1 loading, -1 unloading
    force: Floats
    rubber: dict[str, Floats]  # by name of the stiffness: 1 where it applies
    pairs: dict[str, Floats]  # 1 in pairs, by direction
    begins: Floats  # distance at which the cell began after another one; NaN if not detected


def rows(samples: Sequence[Sample], compliance: float = 0.0) -> Rows:
    """Concatenated samples, for a rig of this compliance [m/N]."""

    def column(value: Callable[[Sample], object]) -> Floats:
        return np.concatenate(
            [np.broadcast_to(np.asarray(value(s), float), len(s.way)) for s in samples]
        )

    direction = column(lambda s: -1.0 if s.unloading else 1.0)
    drive = column(lambda s: 0.0 if s.drive is None else s.drive)
    in_pair = column(lambda s: s.in_pair)
    begins = column(lambda s: s.begins[0] if s.begins else np.nan)
    names = {sample.rubber for sample in samples}
    return Rows(
        column(lambda s: s.way) - compliance * direction * drive * in_pair,
        column(lambda s: s.before),
        column(lambda s: s.cell.lever),
        column(lambda s: s.cell.sin_limit),
        column(lambda s: s.geometry[0]),
        column(lambda s: s.geometry[1]),
        column(lambda s: s.bands),
        direction,
        column(lambda s: s.force),
        {name: column(lambda s, name=name: s.rubber == name) for name in names},
        pairs={
            "start_loading": in_pair * (direction > 0),
            "start_unloading": in_pair * (direction < 0),
        },
        begins=begins - compliance * direction * column(lambda s: s.begins[1] if s.begins else 0.0),
    )


def way_of_cell(values: Mapping[str, float], data: Rows, way: Floats) -> Floats:
    """Distance of a cell [m] for that of the machine [m], also before and past its stops."""
    start = sum((values[name] * one for name, one in data.pairs.items() if name in values), 0.0)
    # If the stops are farther apart than designed, the whole travel is stretched.
    stretch = 1.0 + (values.get("travel", 1.0) - 1.0) * sum(data.pairs.values())
    return (way - start) / stretch - data.before


def handover_errors(values: Mapping[str, float], data: Rows) -> Floats:
    """Model distance [m] of each cell at its detected start; ideally 0."""
    return way_of_cell(values, data, data.begins)[~np.isnan(data.begins)]


def force(values: Mapping[str, float], data: Rows, law: mechanism.Law) -> Floats:
    """F of every row [N].

    Tension is that of the law while a band is longer than at any time before. When it is shorter
    than its maximum by x, tension is lower by the fraction h (1 - exp(-x/c)). Friction acts against
    the motion: a constant, and a fraction of the tension.
    """
    full = 2.0 * data.lever * data.sin_limit
    way = np.clip(way_of_cell(values, data, data.way), 0.0, full)
    travel = np.where(data.direction > 0, way, full - way)
    sine = mechanism.geometry.sine_at(travel, data.lever, data.sin_limit)
    cosine = np.sqrt(1.0 - sine**2)
    length = mechanism.geometry.band_length(sine, cosine, data.dx, data.dy, data.lever)
    slope = mechanism.geometry.length_slope(sine, cosine, length, data.dx, data.dy)
    # The band was longest where the lever was nearest to the direction of d.
    limit = np.arcsin(data.sin_limit)
    theta, along = np.arcsin(sine), np.arctan2(data.dy, data.dx)
    low = np.where(data.direction > 0, -limit, theta)
    high = np.where(data.direction > 0, theta, limit)
    nearest = np.clip(along, low, high)
    longest = mechanism.geometry.band_length(
        np.sin(nearest), np.cos(nearest), data.dx, data.dy, data.lever
    )
    remaining = 1.0 - values["loss"] * (1.0 - np.exp(-(longest - length) / values["loss_length"]))
    k = sum(values[name] * one for name, one in data.rubber.items())
    band = mechanism.Band((0.0, 0.0), (1.0, 0.0), 1.0, values["rest_length"], law)
    tension = data.bands * k * band.tension(length) * remaining
    rubbing = values["friction"] + values.get("joints", 0.0) * tension
    return mechanism.geometry.band_force(tension, slope) + data.direction * rubbing


_EARLY = 0.25  # fraction of the stroke at which the first cell moves


@dataclass(frozen=True)
class Model:
    """Fitted model of mechanisms on a rig of this `compliance` [m/N]."""

    values: Mapping[str, float]
    law: mechanism.Law
    weighing: Weighing | None
    compliance: float

    @property
    def rig(self) -> Rig:
        """The rig of the pairs; its bar is not fitted."""
        friction = 0.0 if self.weighing is None else self.weighing.friction
        return Rig(
            PAPER_RIG.bar,
            self.values.get("travel", 1.0),
            self.values.get("start_loading", 0.0),
            self.values.get("start_unloading", 0.0),
            self.compliance,
            0.0 if math.isnan(friction) else friction,
        )

    @property
    def weight(self) -> float:
        """Weight of the block between two cells [N]; 0 if it was not measured."""
        return 0.0 if self.weighing is None else self.weighing.weight

    def applied(
        self, chain: mechanism.Chain, stiffness: Callable[[mechanism.Cell], float]
    ) -> mechanism.Chain:
        """A chain with bands of this stiffness a cell [N/m], and weight and friction if known."""
        *inner, last = chain.levers
        cells = [self._cell(cell, stiffness(cell), self.weight) for cell in inner]
        return replace(chain, cells=[*cells, self._cell(last, stiffness(last), 0.0)])

    def _cell(self, cell: mechanism.Cell, stiffness: float, carries: float) -> mechanism.Cell:
        total, rest = sum(band.stiffness for band in cell.bands), self.values["rest_length"]
        bands = [
            mechanism.Band(band.p, band.q, stiffness * band.stiffness / total, rest, self.law)
            for band in cell.bands
        ]
        theta = np.linspace(-cell.limit, cell.limit, 41)
        tension = sum((band.tension(band.length(theta, cell.lever)) for band in bands), 0.0 * theta)
        joints = self.values.get("joints")
        friction = cell.friction if joints is None else joints * float(np.mean(tension))
        load = mechanism.Load.constant(carries) if carries else cell.load
        return replace(
            cell, band=bands[0] if len(bands) == 1 else bands, load=load, friction=friction
        )

    def _pair(self, series: Series) -> mechanism.Chain:
        stiffness = series.bands * self.values[rubber_name(series.bands, in_pair=True)]
        return self.applied(series.chain, lambda _: stiffness)

    def snap_of(self, series: Series, missed: Sequence[float] = ()) -> tuple[float, float]:
        """Machine stroke of the first snap of a pair [m], or NaN, and slope of the force [N/m].

        `missed` is the measured less the model force of each cell [N].
        """
        chain = self._pair(series)
        if missed:
            loads = [
                (0.0 if cell.load is None else cell.load.force[0]) + more
                for cell, more in zip(chain.levers, missed, strict=True)
            ]
            pairs = zip(chain.levers, map(mechanism.Load.constant, loads), strict=True)
            chain = replace(chain, cells=[replace(cell, load=load) for cell, load in pairs])
        path = path_of(chain, series.unloading)
        snaps = snaps_of(path, self.rig)
        return (snaps[0], fall_before(path)) if snaps else (math.nan, math.nan)

    def order_of(self, series: Series) -> tuple[str, ...]:
        """Names of the cells of a pair in the order in which the model moves them."""
        chain, share = self._pair(series), 1.0 - _EARLY if series.unloading else _EARLY
        at: Floats = np.array([share - 0.01, share, share + 0.01]) * chain.full_stroke
        first = int(mover(path_of(chain, series.unloading), at)[0][1])
        return tuple(chain.names[i] for i in (first, 1 - first))

    def force(self, sample: Sample) -> Floats:
        """Force F [N] along a sample."""
        return force(self.values, rows([sample], self.compliance), self.law)


@dataclass(frozen=True, eq=False)
class SnapPrediction(ByValue):
    """Predicted first snap and order for a series of a pair; snaps were not used in the fit.

    Attributes:
        geometry: d of the outer cell, which was left out [m].
        measured, spread: mean and standard deviation of the first snaps [m]; NaN for none.
        reached: the last stroke of the recordings, in the direction of motion [m].
        plain: predicted without a fit [m]; NaN for no snap.
        fitted: predicted with its own curves up to the snap in the fit [m]. The residual of the
            forces late in the used travel is added.
        left_out: predicted from the other geometries alone [m].
        doubt: standard deviation of `left_out` less `measured` [m].
        order_seen, order: names of the cells in order, from the forces and as predicted from the
            other geometries. `ratio` is the error of the other order over that of `order_seen`.
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
        """Error of `left_out` [m]; NaN without a prediction or a measured snap."""
        return self.left_out - self.measured

    @property
    def covered(self) -> bool | None:
        """Whether the 90 % interval of `left_out` contains the measured snap; None for no snap.

        For a predicted snap without a measured one, it must reach past the last stroke.
        """
        if math.isnan(self.left_out):
            return None if math.isnan(self.measured) else False
        wide = 1.645 * self.doubt
        if math.isnan(self.measured):
            return abs(self.left_out - self.reached) <= wide
        return abs(self.error) <= wide

    def __repr__(self):
        return (
            f"SnapPrediction({self.series}: measured {to_unit(self.measured, 'mm'):.2f} mm, "
            f"predicted {to_unit(self.left_out, 'mm'):.2f} ± {to_unit(self.doubt, 'mm'):.2f} mm)"
        )
