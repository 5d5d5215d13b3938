"""One recording of a test machine: time, stroke and force."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import PurePath

import numpy as np

from stepwell.base import ByValue, Drawn, Floats, InputError

# A reversal smaller than this share of the stroke is the machine settling, not a turning point.
_TURN = 0.02


@dataclass(frozen=True, eq=False)
class Recording(ByValue, Drawn):
    """One recording of a test machine, in SI.

    Attributes:
        source: the file, as the user called it.
        time: (n,) [s]; NaN where it was not recorded.
        stroke: (n,) displacement of the machine [m].
        force: (n,) [N], positive where the machine pulls.
        remarks: what the reader had to leave out.
        sha256: of the file; "" where there is none.
        gauge: length of the band at stroke 0 [m], where the file holds its length; else None.
        steps: in which stroke [m] and force [N] are told; 0 where the digits show none.

    Raises:
        ValueError: arrays that are not as long as each other, fewer than two samples, or a stroke
            or a force that is no finite number.
    """

    source: str
    time: Floats = field(repr=False)
    stroke: Floats = field(repr=False)
    force: Floats = field(repr=False)
    remarks: tuple[str, ...] = ()
    sha256: str = field(default="", repr=False)
    gauge: float | None = field(default=None, repr=False)
    steps: tuple[float, float] = field(default=(0.0, 0.0), repr=False)

    def __post_init__(self):
        lengths = len(self.time), len(self.stroke), len(self.force)
        if len(set(lengths)) > 1 or lengths[0] < 2:
            raise InputError(
                f"time, stroke and force have {lengths} samples: must be as many each, 2 or more."
            )
        for name, values in (("stroke", self.stroke), ("force", self.force)):
            if not np.all(good := np.isfinite(values)):
                k = int(np.argmin(good))
                raise InputError(
                    f"{name}[{k}] = {values[k]}: must be finite; leave such samples out."
                )

    def __len__(self) -> int:
        return len(self.stroke)

    @property
    def name(self) -> str:
        """The file's name without folder and suffix."""
        return PurePath(self.source).stem

    @property
    def group(self) -> str:
        """The folder it lies in: recordings of one folder are one batch."""
        return str(PurePath(self.source).parent)

    @property
    def rate(self) -> float:
        """Samples a second [Hz]; NaN without time."""
        step = float(np.median(np.diff(self.time)))
        return 1.0 / step if step > 0 else math.nan

    @property
    def speed(self) -> float:
        """Median speed of the stroke [m/s]; NaN without time."""
        steps = np.diff(self.time)
        moving = steps > 0
        speeds = np.abs(np.diff(self.stroke)[moving] / steps[moving])
        return float(np.median(speeds)) if len(speeds) else math.nan

    @cached_property
    def turns(self) -> tuple[int, ...]:
        """Samples where the stroke turns back, between its first and its last."""
        return turns_of(self.stroke)

    @property
    def halves(self) -> tuple[slice, ...]:
        """The samples between turning points: loading and unloading halves, in order."""
        ends = [0, *self.turns, len(self) - 1]
        return tuple(slice(a, b + 1) for a, b in pairwise(ends))

    @property
    def direction(self) -> str:
        """What it shows: loading, unloading, or both in turn."""
        return " and ".join(dict.fromkeys(self.direction_of(half) for half in self.halves))

    def direction_of(self, half: slice) -> str:
        """Whether the stroke rises (loading) or falls (unloading) over these samples."""
        moved = self.stroke[half]
        return "loading" if moved[-1] >= moved[0] else "unloading"

    def __repr__(self):
        return (
            f"Recording({self.name!r}, {len(self)} samples, {self.stroke[0] * 1e3:.4g} to "
            f"{self.stroke[-1] * 1e3:.4g} mm, {self.direction})"
        )


def turns_of(stroke: Floats) -> tuple[int, ...]:
    """Samples where strokes of any unit turn back, between the first and the last."""
    threshold = _TURN * float(np.ptp(stroke))
    back = np.maximum.accumulate(stroke) - stroke, stroke - np.minimum.accumulate(stroke)
    if any(float(np.max(one)) <= threshold for one in back):
        return ()  # one way only, as most
    turns: list[int] = []
    low = high = 0
    bottom = top = float(stroke[0])
    rising: bool | None = None
    for i, u in enumerate(stroke.tolist()):
        if u > top:
            high, top = i, u
        if u < bottom:
            low, bottom = i, u
        if rising is not False and top - u > threshold:
            if rising:
                turns.append(high)
            rising, low, bottom = False, i, u
        elif rising is not True and u - bottom > threshold:
            if rising is False:
                turns.append(low)
            rising, high, top = True, i, u
    return tuple(turns)
