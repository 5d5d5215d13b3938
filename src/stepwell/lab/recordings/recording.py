"""One recording of a test machine: time, stroke, force, spikes, and setup from its name."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import PurePath

import numpy as np

from stepwell.base import (
    Bools,
    ByValue,
    Drawn,
    Floats,
    InputError,
    Measure,
    Vec2,
    printable,
    to_unit,
)


class LabError(InputError):
    """Measured data that cannot be used; `str` of it is the message for the user.

    Args:
        name: the file or folder, as named by the user.
        problem: one line: the value, the allowed values, and an action.
        columns: rows of a table of the file's columns, if they do not decide how it is read:
            number, name, unit, range, and what each may be. A traceback shows them too.
        flips: values of `flip` that may be right, if the file leaves its signs open.
    """

    def __init__(
        self,
        name: str,
        problem: str,
        columns: Sequence[tuple[str, ...]] = (),
        flips: Sequence[str] = (),
    ):
        self.flips = tuple(flips)
        self.name = printable(name)
        self.problem = printable(problem)
        self.columns = tuple(tuple(map(printable, row)) for row in columns)
        super().__init__(f"{self.name}: {self.problem}")
        for number, called, unit, numbers, why in self.columns:
            unit = f"[{unit}]" if unit else "no unit"
            self.add_note(f"  {number:>3}  {called or '(no name)'}  {unit}  {numbers}  {why}")


# A spike deviates from the median of three samples by more than 5 % of the force range and 5 times
# the 98 % quantile of that deviation. The force stays at its new value after a snap, so the samples
# of a snap do not deviate.
_SHARE, _TIMES, _MOST = 0.05, 5.0, 0.98


def spikes(force: Floats) -> Bools:
    """Mask of the samples (n,) of a force [N] that are spikes."""
    middle = _median_of_three(force)
    off = np.abs(force - middle)
    usual = float(np.quantile(off, _MOST)) if len(off) else 0.0
    return off > max(_TIMES * usual, _SHARE * float(np.ptp(middle)) if len(off) else 0.0)


def without_spikes(force: Floats) -> Floats:
    """The force (n,) [N] with spikes replaced by the median of three samples."""
    is_spike = spikes(force)
    return np.where(is_spike, _median_of_three(force), force) if np.any(is_spike) else force


def _median_of_three(force: Floats) -> Floats:
    """Median of every sample and its two neighbours; the first and the last are unchanged."""
    if len(force) < 3:
        return force
    low, high = np.minimum(force[:-1], force[1:]), np.maximum(force[:-1], force[1:])
    inner = np.maximum(low[:-1], np.minimum(high[:-1], force[2:]))
    return np.concatenate([force[:1], inner, force[-1:]])


# A reversal below this fraction of the stroke is settling of the machine, not a turning point.
_TURN = 0.02


@dataclass(frozen=True, eq=False)
class Recording(ByValue, Drawn):
    """One recording of a test machine, in SI.

    Attributes:
        source: the file, as named by the user.
        time: (n,) [s]; NaN if not recorded.
        stroke, force: (n,) displacement of the machine [m], and [N], positive in tension.
        remarks: notes of the reader, such as rows left out.
        sha256: of the file; "" without a file.
        gauge: length of the band at stroke 0 [m] if the file contains its length; else None.
        steps: resolution of stroke [m] and force [N]; 0 if unknown.
        reading: how the file was read, a line each: columns, units, signs, zero, part.
        measure: quantities of stroke and force, if they are volume and pressure, or angle and
            torque.
        other_flip: the value of `flip` that may be right too, as the work does not decide the
            signs; "" if they are decided or requested.

    Raises:
        ValueError: arrays differ in length, have fewer than two samples, or contain a stroke or a
            force that is not finite.
    """

    source: str
    time: Floats = field(repr=False)
    stroke: Floats = field(repr=False)
    force: Floats = field(repr=False)
    remarks: tuple[str, ...] = ()
    sha256: str = field(default="", repr=False)
    gauge: float | None = field(default=None, repr=False)
    steps: tuple[float, float] = field(default=(0.0, 0.0), repr=False)
    reading: tuple[str, ...] = field(default=(), repr=False)
    measure: Measure = field(default=Measure.TRAVEL, repr=False)
    other_flip: str = field(default="", repr=False)

    def __post_init__(self):
        lengths = len(self.time), len(self.stroke), len(self.force)
        if len(set(lengths)) > 1 or lengths[0] < 2:
            raise InputError(
                f"time, stroke and force have {lengths} samples: must be equal, 2 or more."
            )
        for name, values in (("stroke", self.stroke), ("force", self.force)):
            if not np.all(good := np.isfinite(values)):
                k = int(np.argmin(good))
                raise InputError(
                    f"{name}[{k}] = {values[k]}: must be finite; leave out such samples."
                )

    def __len__(self) -> int:
        return len(self.stroke)

    @property
    def name(self) -> str:
        """The file's name without folder and suffix."""
        return PurePath(self.source).stem

    @property
    def group(self) -> str:
        """The folder of the file: recordings of one folder are one batch."""
        return str(PurePath(self.source).parent)

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]; NaN without time."""
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
        """Indices of the samples at turning points, without the ends."""
        return turns_of(self.stroke)

    @property
    def halves(self) -> tuple[slice, ...]:
        """Slices between turning points: loading and unloading halves in order."""
        return halves_of(self.stroke, self.turns)

    @property
    def direction(self) -> str:
        """Loading, unloading, or both in turn."""
        return " and ".join(dict.fromkeys(self.direction_of(half) for half in self.halves))

    def direction_of(self, half: slice) -> str:
        """Whether the stroke rises (loading) or falls (unloading) over these samples."""
        return direction_of(self.stroke[half])

    def __repr__(self):
        return (
            f"Recording({self.name!r}, {len(self)} samples, {to_unit(self.stroke[0], 'mm'):.4g} to "
            f"{to_unit(self.stroke[-1], 'mm'):.4g} mm, {self.direction})"
        )


def turns_of(stroke: Floats) -> tuple[int, ...]:
    """Indices of the turning points of strokes in any unit, without the ends."""
    threshold = _TURN * float(np.ptp(stroke))
    back = np.maximum.accumulate(stroke) - stroke, stroke - np.minimum.accumulate(stroke)
    if any(float(np.max(one)) <= threshold for one in back):
        return ()  # one direction only, the usual case
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


def halves_of(stroke: Floats, turns: Sequence[int] | None = None) -> tuple[slice, ...]:
    """Slices between turning points of strokes in any unit; a half ends where the next begins."""
    ends = [0, *(turns_of(stroke) if turns is None else turns), len(stroke) - 1]
    return tuple(slice(a, b + 1) for a, b in pairwise(ends))


def direction_of(stroke: Floats) -> str:
    """Whether the strokes of a half rise (loading) or fall (unloading) as a whole."""
    return "loading" if stroke[-1] >= stroke[0] else "unloading"


_RUN = re.compile(r"^(?P<stem>.*?)_?(?P<run>\d+)$")
# A number with decimals, such as 2d0 or 2p5, is a value and not the number of a run.
_VALUE = re.compile(r"\d[dp.,]\d+$")
_UNIT = re.compile(r"^(?P<cells>[12])unit_(?P<code>[BMTLR]+)(?P<mark>(?:_[A-Za-z]\w*)?)$")
_SAMPLE = re.compile(r"^samp(?:le)?_?(?P<sample>\d+)(?!\d)", re.IGNORECASE)
_BASELINE = re.compile(r"friction|baseline|no_?band", re.IGNORECASE)

_P = {"M": (-0.010, 0.0), "T": (0.0, 0.0)}
_QX = {"B": 0.0, "M": 0.010, "T": 0.020}
_QY = {"L": 0.015, "M": 0.0, "R": -0.015}
# Every q that a name can encode [m].
PLACES: tuple[Vec2, ...] = tuple((x, y) for x in _QX.values() for y in _QY.values())


@dataclass(frozen=True)
class Setup:
    """Configuration code of a name, p and q of each cell, inner first [m], and its marks."""

    code: str
    anchors: tuple[tuple[Vec2, Vec2], ...]
    marked: str


def stem_of(name: str) -> str:
    """A name without its run number."""
    match = None if _VALUE.search(name) else _RUN.match(name)
    return match["stem"] if match else name


def run_number(name: str) -> int | None:
    """The number at the end of a name, if there is one."""
    match = None if _VALUE.search(name) else _RUN.match(name)
    return int(match["run"][:18]) if match else None


def is_baseline(name: str) -> bool:
    """Whether a name is that of a run without a band: friction, baseline, no_band."""
    return _BASELINE.search(name) is not None


def sample_number(name: str) -> int | None:
    """Number of the sample in a name such as Samp2_45mm_7."""
    match = _SAMPLE.match(name)
    return int(match["sample"][:18]) if match else None


def setup_of(name: str) -> Setup | None:
    """The configuration in a name such as 1unit_MLT_3 or 2unit_TMTBM_5; None without one.

    The first letter of a cell is its p: M for (-10, 0) mm, T for (0, 0). The others are its q:
    x of B, M, T is 0, 10, 20 mm, y of L, M, R is 15, 0, -15 mm; the defaults are x = 10, y = 0.
    In a pair the inner cell has two letters. The outer one starts with its p, or has one letter
    and the same p.

    Source: file names of the recordings published with Kamp et al. 2024.
    """
    match = _UNIT.match(stem_of(name))
    if match is None:
        return None
    code = match["code"]
    parts = [code] if match["cells"] == "1" else [code[:2], code[2:]]
    if match["cells"] == "2" and not (len(parts[1]) > 1 and parts[1][0] in _P):
        parts[1] = code[0] + parts[1]
    anchors = tuple(pair for part in parts if (pair := _anchors(part)) is not None)
    if len(anchors) < len(parts):
        return None
    return Setup(code + match["mark"], anchors, match["mark"].strip("_"))


def _anchors(letters: str) -> tuple[Vec2, Vec2] | None:
    """p and q of one cell; None for ambiguous letters."""
    p, rest = _P.get(letters[:1]), letters[1:]
    if p is None or not 1 <= len(rest) <= 2:
        return None
    # M is the middle of x alone or with L or R, and the middle of y with B or T.
    x: float | None = None
    y: float | None = None
    for letter in sorted(rest, key="BTLRM".index):
        if letter in _QX and x is None:
            x = _QX[letter]
        elif letter in _QY and y is None:
            y = _QY[letter]
        else:
            return None
    return p, (0.010 if x is None else x, 0.0 if y is None else y)
