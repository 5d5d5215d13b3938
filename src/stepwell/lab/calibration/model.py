"""The model that is fitted: rubber with a loss, friction, and a rig that gives way."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Bools, Floats
from stepwell.lab.calibration.samples import Sample
from stepwell.mechanism import (
    Band,
    Cubic,
    Law,
    Linear,
    Table,
    band_force,
    band_length,
    length_slope,
    sine_at,
)


class Number(NamedTuple):
    """A number that can be fitted: its unit, where the search starts and ends, a typical size."""

    unit: str
    start: float
    low: float
    high: float
    size: float


# Stiffness and start have one for each kind of rubber and each direction.
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
    return next(found for stem, found in _NUMBERS.items() if _is(name, stem))


def _is(name: str, stem: str) -> bool:
    return name == stem or (stem in ("stiffness", "start") and name.startswith(f"{stem}_"))


def numbers_of(samples: Sequence[Sample], law: str) -> list[str]:
    """Names of what is fitted to these samples with a law.

    What no sample shows is not fitted: the rig's terms are those of pairs, and friction in the
    joints, which grows with the load, is told from the loss of the rubber by loading and unloading.
    """
    rubbers = sorted({sample.rubber for sample in samples})
    pairs = {sample.unloading for sample in samples if sample.in_pair}
    joints = ["joints"] if len(pairs) == 2 else []
    starts = [f"start_{'un' * way}loading" for way in sorted(pairs)]
    rig = ["travel", *starts] if pairs else []
    return [
        *rubbers,
        "rest_length",
        *LAWS.get(law, ()),
        "loss",
        "loss_length",
        "friction",
        *joints,
        *rig,
    ]


def law_of(law: str, values: Mapping[str, float], tables: Mapping[str, Table]) -> Law:
    """The law of a band by its name and its fitted numbers."""
    if law in tables:
        return tables[law]
    found = Cubic(values.get("quadratic", 0.0), values.get("cubic", 0.0))
    return found if found.a2 or found.a3 else Linear()


@dataclass(frozen=True)
class Rows:
    """What does not depend on the numbers that are fitted, all samples in a row (n,)."""

    way: Floats
    drive: Floats
    before: Floats
    lever: Floats
    sin_limit: Floats
    dx: Floats
    dy: Floats
    bands: Floats
    direction: Floats  # +1 loading, -1 unloading
    force: Floats
    rubber: dict[str, Floats]  # 1 where the stiffness is that of the name
    pairs: dict[str, Floats]  # 1 in pairs, by direction
    begins: Floats  # way at which the cell began to move after another one; NaN where not seen

    def where(self, use: Bools) -> Rows:
        """Some of the rows."""
        cut: dict[str, Any] = {}
        for one in fields(self):
            held = getattr(self, one.name)
            many = isinstance(held, dict)
            cut[one.name] = {k: v[use] for k, v in held.items()} if many else held[use]
        return Rows(**cut)


def rows(samples: Sequence[Sample], given: float = 0.0) -> Rows:
    """Samples in a row, their rig giving way by so much [m/N]."""

    def column(value: Callable[[Sample], object]) -> Floats:
        return np.concatenate(
            [np.broadcast_to(np.asarray(value(s), float), len(s.way)) for s in samples]
        )

    direction = column(lambda s: -1.0 if s.unloading else 1.0)
    drive = column(lambda s: 0.0 if s.drive is None else s.drive)
    in_pair = column(lambda s: s.in_pair)
    names = {sample.rubber for sample in samples}
    return Rows(
        column(lambda s: s.way) - given * direction * drive * in_pair,
        drive,
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
        begins=column(lambda s: _begins(s, given)),
    )


def _begins(sample: Sample, given: float) -> float:
    if sample.begins is None:
        return math.nan
    way, push = sample.begins
    return way - given * (-push if sample.unloading else push)


def way_of_cell(values: Mapping[str, float], data: Rows, way: Floats) -> Floats:
    """Way that a cell has gone [m] for the machine's [m], before and past its stops too."""
    start = sum((values[name] * one for name, one in data.pairs.items() if name in values), 0.0)
    # Where the stops are farther apart than designed, all of the travel is stretched.
    stretch = 1.0 + (values.get("travel", 1.0) - 1.0) * sum(data.pairs.values())
    return (way - start) / stretch - data.before


def late(values: Mapping[str, float], data: Rows) -> Floats:
    """How far on each cell is [m] where it is seen to begin; none for those that are not seen."""
    return way_of_cell(values, data, data.begins)[~np.isnan(data.begins)]


def force(values: Mapping[str, float], data: Rows, law: Law) -> Floats:
    """F of every row [N].

    While a band gets longer than ever before in the motion its tension is that of the law; once it
    is shorter by x than it has been, it is less by the share h (1 - exp(-x/c)). Friction is against
    the motion: a constant, and a share of the tension.
    """
    full = 2.0 * data.lever * data.sin_limit
    way = np.clip(way_of_cell(values, data, data.way), 0.0, full)
    travel = np.where(data.direction > 0, way, full - way)
    sine = sine_at(travel, data.lever, data.sin_limit)
    cosine = np.sqrt(1.0 - sine**2)
    length = band_length(sine, cosine, data.dx, data.dy, data.lever)
    slope = length_slope(sine, cosine, length, data.dx, data.dy)
    # The band is longest where the lever points along d, or where it has come nearest to that.
    limit = np.arcsin(data.sin_limit)
    theta, along = np.arcsin(sine), np.arctan2(data.dy, data.dx)
    low = np.where(data.direction > 0, -limit, theta)
    high = np.where(data.direction > 0, theta, limit)
    nearest = np.clip(along, low, high)
    longest = band_length(np.sin(nearest), np.cos(nearest), data.dx, data.dy, data.lever)
    kept = 1.0 - values["loss"] * (1.0 - np.exp(-(longest - length) / values["loss_length"]))
    k = sum(values[name] * one for name, one in data.rubber.items())
    band = Band((0.0, 0.0), (1.0, 0.0), 1.0, values["rest_length"], law)
    tension = data.bands * k * band.tension(length) * kept
    rubbing = values["friction"] + values.get("joints", 0.0) * tension
    return band_force(tension, slope) + data.direction * rubbing
