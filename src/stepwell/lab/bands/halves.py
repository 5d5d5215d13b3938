"""Loading halves of tension tests: of which kind of band, which are fitted, and their means."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, chain, pairwise
from typing import NamedTuple, TypeVar

import numpy as np

from stepwell.base import Bools, ByValue, Floats, grouped, join_first, to_unit
from stepwell.lab.recordings import recording as recorded
from stepwell.lab.recordings.read import natural
from stepwell.lab.recordings.recording import Recording
from stepwell.lab.recordings.recording_warnings import batch_warnings

CONFIDENCE = 0.95
T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Estimate(ByValue):
    """A mean over samples.

    Attributes:
        low, high: 95 % interval of the mean of all such samples; NaN for one sample, which
            shows no scatter.
        next_low, next_high: 95 % interval for one more sample.
        spread: standard deviation between samples; NaN for one sample.
        each: the samples' own values.
    """

    value: float
    low: float
    high: float
    next_low: float
    next_high: float
    spread: float
    each: Mapping[int, float] = field(repr=False)

    def __repr__(self):
        if math.isnan(self.spread):
            return f"Estimate({self.value:.5g}, one sample: its uncertainty is not known)"
        return (
            f"Estimate({self.value:.5g}, 95 % {self.low:.5g} to {self.high:.5g}, "
            f"{len(self.each)} samples that scatter by {self.spread:.3g})"
        )


def of_samples(each: Mapping[int, float]) -> Estimate:
    """The mean of samples and its Student interval, from a value by sample.

    Source: Student 1908; the interval for one more sample is the usual prediction interval.
    """
    values = np.array(list(each.values()))
    n, mean = len(values), float(np.mean(values))
    spread = float(np.std(values, ddof=1)) if n > 1 else math.nan
    wide = student(n - 1) * spread
    near, far = wide / math.sqrt(n), wide * math.sqrt(1 + 1 / n)
    return Estimate(mean, mean - near, mean + near, mean - far, mean + far, spread, dict(each))


def student(freedom: float) -> float:
    """How many standard errors a two-sided 95 % interval reaches."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + CONFIDENCE / 2))


# Rows that a loading half has at least, and all halves on average, where a table is in an order.
_ROWS = 4


@dataclass(frozen=True, eq=False, repr=False)
class Hysteresis(ByValue):
    """One cycle of one sample, both counted from 1.

    Attributes:
        source: the file it comes from.
        stroke, force: (n,) of the loading half [m], [N].
        back_stroke, back_force: (m,) of the unloading half; empty where there is none.
        steps: in which stroke [m] and force [N] were told; 0 where the digits show none.
    """

    sample: int
    cycle: int
    source: str
    stroke: Floats = field(repr=False)
    force: Floats = field(repr=False)
    back_stroke: Floats = field(repr=False)
    back_force: Floats = field(repr=False)
    steps: tuple[float, float] = field(default=(0.0, 0.0), repr=False)

    @property
    def work(self) -> float:
        """Work of loading [J]."""
        return float(np.trapezoid(self.force, self.stroke))

    @property
    def loss(self) -> float:
        """Share of that work which unloading does not give back; NaN without unloading."""
        if len(self.back_stroke) < 2 or self.work <= 0:
            return math.nan
        return 1.0 + float(np.trapezoid(self.back_force, self.back_stroke)) / self.work


def loops_of(
    recordings: Sequence[Recording], left_out: set[int], per_sample: int | None
) -> tuple[tuple[Hysteresis, ...], float | None, tuple[str, ...]]:
    """Every cycle of every sample that is not left out; the mean length at stroke 0 [m]; notes.

    Samples are told apart by names such as Samp2_45mm_7; where names only count through, by
    `per_sample`; else all files of one stem are one sample. Cycles are numbered as the names do
    where those of a sample agree with the cycles in the files; else they are counted.
    """
    notes: list[str] = []
    by_sample: dict[int, list[Recording]] = defaultdict(list)
    numbers: dict[str, int | None] = {}
    odd = batch_warnings(recordings)
    for recording, sample, number in _sorted(recordings, per_sample):
        if recorded.is_baseline(recording.name):
            notes.append(f"{recording.source}: left out, its name says that no band was on")
        elif sample in left_out:
            notes.append(f"{recording.source}: left out, sample {sample} as asked")
        else:
            by_sample[sample].append(recording)
            numbers[recording.source] = number
    gauge = _gauge([recording.gauge for files in by_sample.values() for recording in files], notes)
    loops: list[Hysteresis] = []
    for sample, files in sorted(by_sample.items()):
        cycles = [list(_cycles(recording)) for recording in files]
        named = _named([numbers[r.source] for r in files], [len(halves) for halves in cycles])
        counted = accumulate(map(len, cycles), initial=1)
        for recording, halves, number, first in zip(files, cycles, named, counted, strict=False):
            if not halves:
                notes.append(f"{recording.source}: left out, it has no loading half")
            loops += [
                Hysteresis(sample, cycle, recording.source, *parts, recording.steps)
                for cycle, parts in enumerate(halves, first if number is None else number)
            ]
            lines = (*recording.remarks, *_order(recording), *odd.get(recording.source, ()))
            notes += [f"{recording.source}: {line}" for line in lines]
    return tuple(loops), gauge, tuple(notes)


def _gauge(gauges: Sequence[float | None], notes: list[str]) -> float | None:
    """The mean length of the band [m], where all files hold one; a note where only some do."""
    known = [gauge for gauge in gauges if gauge is not None]
    if known and len(known) == len(gauges):
        return sum(known) / len(known)
    if known:
        notes.append("some files hold the length of the band and some do not: it is not used")
    return None


def _sorted(
    recordings: Iterable[Recording], per_sample: int | None
) -> Iterator[tuple[Recording, int, int | None]]:
    """Recordings in the natural order of their names, with sample and number by their names."""
    ordered = sorted(recordings, key=lambda r: natural(r.source))
    stems: dict[str, int] = {}
    for recording in ordered:
        run, named = recorded.run_number(recording.name), recorded.sample_number(recording.name)
        if per_sample is not None and run is not None:
            yield recording, (run - 1) // per_sample + 1, (run - 1) % per_sample + 1
        elif named is not None:
            # The number at the end of Samp3 is the sample's own.
            is_run = recorded.stem_of(recording.name).rstrip("_").lower() not in ("samp", "sample")
            yield recording, named, run if is_run else None
        else:
            stem = recording.group + recorded.stem_of(recording.name)
            alone = sum(recording.group + recorded.stem_of(r.name) == stem for r in ordered) == 1
            yield recording, stems.setdefault(stem, len(stems) + 1), None if alone else run


def _named(numbers: list[int | None], counts: list[int]) -> list[int | None]:
    """The numbers of the files of a sample where they can be cycles, else none of them."""
    ends = [-1 if n is None else n + count for n, count in zip(numbers, counts, strict=True)]
    rises = all(n is not None and end <= n for end, n in zip(ends, numbers[1:], strict=False))
    return numbers if rises and None not in numbers and 0 not in numbers else [None] * len(numbers)


def _cycles(recording: Recording) -> Iterator[tuple[Floats, Floats, Floats, Floats]]:
    """Stroke and force of every loading half and of the unloading half behind it."""
    u, force = recording.stroke, recording.force
    if np.ptp(u) == 0:
        return
    if _order(recording):
        rising = np.argsort(u, kind="stable")
        yield u[rising], force[rising], u[:0], force[:0]
        return
    for half, back in pairwise([*recording.halves, slice(0, 0)]):
        if recording.direction_of(half) == "loading":
            yield u[half], force[half], u[back], force[back]


def _order(recording: Recording) -> tuple[str, ...]:
    """What is told of a table without time whose rows are in no order: they are sorted."""
    halves = recording.halves
    rows = [h.stop - h.start for h in halves if recording.direction_of(h) == "loading"]
    mixed = len(halves) > 2 and len(recording) < _ROWS * len(halves)
    if np.all(np.isnan(recording.time)) and (
        not rows or mixed or (len(halves) > 1 and max(rows) < _ROWS)
    ):
        return ("its rows are sorted by stroke and taken as one loading",)
    return ()


# What the paper's stiffness was read from: 5 to 35 mm of cycles 5 to 9.
WINDOW = (0.005, 0.035)
CYCLES = (5, 9)
REACH = 1e-4  # [m] by which a stroke may miss the end of a window
_FEW = 20  # readings of a loading half, of which none is given away
_SLACK = 0.02  # of the largest force, below which a band is not said to be taut


def usual_cycles(loops: Sequence[Hysteresis]) -> tuple[tuple[int, int], str]:
    """The paper's cycles, or all but the first, in which rubber softens most; and why."""
    samples = {loop.sample for loop in loops}
    first, last = CYCLES
    if not loops or {o.sample for o in loops if first <= o.cycle <= last} == samples:
        return CYCLES, ""
    top = max(loop.cycle for loop in loops)
    begin = 2 if {o.sample for o in loops if o.cycle > 1} == samples else 1
    why = f"not every sample has one of the usual {first} to {last}"
    shown = f"cycle {top} is" if begin == top else f"cycles {begin} to {top} are"
    return (begin, top), f"{shown} fitted: {why}"


def usual_window(used: Sequence[Hysteresis]) -> tuple[tuple[float, float], str]:
    """The paper's window [m], or all strokes of a taut band; and why."""
    low, high = WINDOW
    inside = [np.sum((loop.stroke >= low) & (loop.stroke <= high)) for loop in used]
    over = all(np.min(o.stroke) <= low + REACH and np.max(o.stroke) >= high - REACH for o in used)
    few = bool(inside) and min(inside) < _FEW
    if not used or (over and not few):
        return WINDOW, ""
    usual = f"the usual {to_unit(low, 'mm'):g} to {to_unit(high, 'mm'):g} mm"
    why = f"{usual} hold few readings" if over else f"the stroke does not reach over {usual}"
    window = max(map(_taut_from, used)), min(float(np.max(loop.stroke)) for loop in used)
    shown = " to ".join(f"{to_unit(edge, 'mm'):.4g}" for edge in window)
    return window, f"{shown} mm of stroke are fitted, from where it is taut on: {why}"


def taut(force: Floats, step: float) -> Bools:
    """Whether the band pulls, at each force (n,) [N] of a loading half told in such steps [N]."""
    return force > max(_SLACK * float(np.max(force)), 0.5 * step)


def _taut_from(loop: Hysteresis) -> float:
    """The stroke of the last slack reading before the band pulls, or of the first one [m]."""
    pulls = np.flatnonzero(taut(loop.force, loop.steps[1]))
    first = int(pulls[0]) if len(pulls) else 0
    return float(loop.stroke[max(first - 1, 0)])


# Bands of a kind scatter by 10 %, seldom by 15; two that lie further apart than this factor, with
# none between them, are of two kinds, or one of the runs is broken.
_APART = 1.4
# Rubber softens from cycle to cycle and never stiffens: by half in its first cycles, then by a few
# percent. Past these factors the next cycle is of another band.
_SOFTER_AT_FIRST, _SOFTER, _STIFFER = 4.0, 1.5, 1.3
_EARLY = 2
_ABOUT = 0.12  # between a factor and the count of bands that may explain it


class LoadingRun(NamedTuple):
    """A loading half and its stiffness in the window [N/m]."""

    sample: int
    cycle: int
    source: str
    stiffness: float


class AlikeRuns(NamedTuple):
    """Runs of bands that are alike: their median stiffness [N/m], and how many bands they are."""

    runs: tuple[LoadingRun, ...]
    stiffness: float
    bands: int


def kinds(runs: Iterable[LoadingRun]) -> tuple[AlikeRuns, ...]:
    """Runs sorted into kinds of bands, the kind of most bands first.

    The runs of a sample are one band as long as its stiffness only drifts from cycle to cycle.
    """
    by_sample = grouped((run.sample, run) for run in runs)
    bands = [band for sample in by_sample.values() for band in _one_band_each(sample)]
    bands.sort(key=_typical)
    groups = _parted(bands, lambda one, next_: _ratio(_typical(one), _typical(next_)) > _APART)
    alike = [
        AlikeRuns(tuple(chain.from_iterable(g)), float(np.median(list(map(_typical, g)))), len(g))
        for g in groups
    ]
    return tuple(sorted(alike, key=lambda kind: -kind.bands))


def _parted(items: list[T], apart: Callable[[T, T], bool]) -> list[list[T]]:
    """A list cut where an item is apart from the one before it."""
    cuts = [k for k, pair in enumerate(pairwise(items), 1) if apart(*pair)]
    return [items[begin:end] for begin, end in pairwise([0, *cuts, len(items)])]


def differing(usual: AlikeRuns, other: AlikeRuns) -> str:
    """How the runs of a kind differ from the usual one, with their files."""
    ratio = other.stiffness / usual.stiffness
    files = listed([run.source for run in other.runs])
    if ratio <= 0:
        return f"{files}: {other.stiffness:.3g} N/m, which does not pull at all"
    factor = ratio if ratio > 1 else 1 / ratio
    times = f"{factor:.3g} times as {'stiff' if ratio > 1 else 'soft'}"
    whole = round(factor)
    hint = ""
    if 2 <= whole <= 4 and abs(factor / whole - 1) < _ABOUT:
        swapped = f"{whole} bands in place of 1" if ratio > 1 else f"1 band in place of {whole}"
        hint = f" ({swapped}?)"
    return f"{files}: {other.stiffness:.4g} N/m, {times}{hint}"


def listed(names: Sequence[str]) -> str:
    """A few names, and how many more there are."""
    return join_first([name.replace("\\", "/").rpartition("/")[2] for name in names], 3)


def _one_band_each(runs: list[LoadingRun]) -> list[list[LoadingRun]]:
    """The runs of a sample, parted where the next cycle cannot be of the same band."""

    def other(before: LoadingRun, run: LoadingRun) -> bool:
        softer = _SOFTER_AT_FIRST if before.cycle < _EARLY else _SOFTER
        allowed = _STIFFER if run.stiffness > before.stiffness else softer
        return _ratio(*sorted((before.stiffness, run.stiffness))) > allowed

    return _parted(sorted(runs, key=lambda run: run.cycle), other)


def _typical(runs: list[LoadingRun]) -> float:
    """Median stiffness of a band, without its first cycle where it has others."""
    later = [run.stiffness for run in runs if run.cycle > 1]
    return float(np.median(later or [run.stiffness for run in runs]))


def _ratio(low: float, high: float) -> float:
    return high / low if low > 0 else (1.0 if high <= 0 else math.inf)
