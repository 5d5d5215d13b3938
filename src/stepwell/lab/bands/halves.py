"""Loading halves of tension tests: kinds of bands, selection for the fit, means."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate, chain, pairwise
from typing import NamedTuple, TypeVar

import numpy as np

from stepwell.base import Bools, ByValue, Floats, grouped, join_first
from stepwell.lab.recordings import recording as recorded, signs
from stepwell.lab.recordings.read import natural
from stepwell.lab.recordings.recording import Recording
from stepwell.lab.recordings.recording_warnings import batch_warnings

CONFIDENCE = 0.95
T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Estimate(ByValue):
    """A mean over samples.

    Attributes:
        low, high: 95 % interval of the mean of all such samples; NaN for one sample.
        next_low, next_high: 95 % interval for one more sample.
        spread: standard deviation between samples; NaN for one sample.
        each: value of each sample.
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
            f"{len(self.each)} samples, standard deviation {self.spread:.3g})"
        )


def of_samples(each: Mapping[int, float]) -> Estimate:
    """Mean of samples with Student intervals, from the values by sample.

    Source: Student 1908; the interval for one more sample is the usual prediction interval.
    """
    values = np.array(list(each.values()))
    n, mean = len(values), float(np.mean(values))
    spread = float(np.std(values, ddof=1)) if n > 1 else math.nan
    wide = student(n - 1) * spread
    near, far = wide / math.sqrt(n), wide * math.sqrt(1 + 1 / n)
    return Estimate(mean, mean - near, mean + near, mean - far, mean + far, spread, dict(each))


def student(freedom: float) -> float:
    """Half-width of a two-sided 95 % interval in standard errors."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + CONFIDENCE / 2))


# Least number of rows of a loading half, and of all halves on average, in an ordered table.
_ROWS = 4


@dataclass(frozen=True, eq=False, repr=False)
class Hysteresis(ByValue):
    """One cycle of one sample, both counted from 1.

    Attributes:
        source: its file.
        stroke, force: (n,) of the loading half [m], [N].
        back_stroke, back_force: (m,) of the unloading half; empty without one.
        steps: resolution of stroke [m] and force [N]; 0 if unknown.
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
        """Fraction of that work not recovered in unloading; NaN without unloading."""
        if len(self.back_stroke) < 2 or self.work <= 0:
            return math.nan
        return 1.0 + float(np.trapezoid(self.back_force, self.back_stroke)) / self.work


def loops_of(
    recordings: Sequence[Recording], left_out: set[int], per_sample: int | None
) -> tuple[tuple[Hysteresis, ...], float | None, tuple[str, ...]]:
    """Cycles of all samples that are not left out, mean length at stroke 0 [m], and notes.

    Samples are identified by names such as Samp2_45mm_7. If names are only numbered, they are
    identified by `per_sample`, else all files of one stem are one sample. Cycles have the numbers
    in the names if these agree with the cycles in the files; else they are counted.
    """
    notes: list[str] = []
    by_sample: dict[int, list[Recording]] = defaultdict(list)
    numbers: dict[str, int | None] = {}
    odd = batch_warnings(recordings)
    for recording, sample, number in _sorted(map(_positive, recordings), per_sample):
        if recorded.is_baseline(recording.name):
            notes.append(f"{recording.source}: left out, a run without a band by its name")
        elif sample in left_out:
            notes.append(f"{recording.source}: left out, sample {sample} as requested")
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


def _positive(recording: Recording) -> Recording:
    """The recording with tension and its stroke positive, where both are counted negative."""
    x, f, why, _ = signs.pulled(recording.stroke, recording.force, REACH)
    if not why:
        return recording
    remarks = (*recording.remarks, why)
    return replace(
        recording, stroke=x * recording.stroke, force=f * recording.force, remarks=remarks
    )


def _gauge(gauges: Sequence[float | None], notes: list[str]) -> float | None:
    """Mean length of the band [m] if all files contain one; adds a note if only some do."""
    known = [gauge for gauge in gauges if gauge is not None]
    if known and len(known) == len(gauges):
        return sum(known) / len(known)
    if known:
        notes.append("only some files contain the length of the band: it is not used")
    return None


def _sorted(
    recordings: Iterable[Recording], per_sample: int | None
) -> Iterator[tuple[Recording, int, int | None]]:
    """Recordings in the natural order of their names, with sample and number from the names."""
    ordered = sorted(recordings, key=lambda r: natural(r.source))
    stems: dict[str, int] = {}
    for recording in ordered:
        run, named = recorded.run_number(recording.name), recorded.sample_number(recording.name)
        if per_sample is not None and run is not None:
            yield recording, (run - 1) // per_sample + 1, (run - 1) % per_sample + 1
        elif named is not None:
            # The number at the end of Samp3 is that of the sample, not of a run.
            is_run = recorded.stem_of(recording.name).rstrip("_").lower() not in ("samp", "sample")
            yield recording, named, run if is_run else None
        else:
            stem = recording.group + recorded.stem_of(recording.name)
            alone = sum(recording.group + recorded.stem_of(r.name) == stem for r in ordered) == 1
            yield recording, stems.setdefault(stem, len(stems) + 1), None if alone else run


def _named(numbers: list[int | None], counts: list[int]) -> list[int | None]:
    """Numbers of the files of a sample if they are consistent as cycles, else None for each."""
    ends = [-1 if n is None else n + count for n, count in zip(numbers, counts, strict=True)]
    rises = all(n is not None and end <= n for end, n in zip(ends, numbers[1:], strict=False))
    return numbers if rises and None not in numbers and 0 not in numbers else [None] * len(numbers)


def _cycles(recording: Recording) -> Iterator[tuple[Floats, Floats, Floats, Floats]]:
    """Stroke and force of every loading half and of the unloading half after it."""
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
    """Note for a table without time and with unordered rows, which are then sorted."""
    halves = recording.halves
    rows = [h.stop - h.start for h in halves if recording.direction_of(h) == "loading"]
    mixed = len(halves) > 2 and len(recording) < _ROWS * len(halves)
    if np.all(np.isnan(recording.time)) and (
        not rows or mixed or (len(halves) > 1 and max(rows) < _ROWS)
    ):
        return ("its rows are sorted by stroke and used as one loading half",)
    return ()


CYCLES = (5, 9)  # of the paper's stiffness
REACH = 1e-4  # tolerance of a stroke at the end of a window [m]
_SLACK = 0.02  # fraction of the largest force, below which a band counts as slack


def usual_cycles(loops: Sequence[Hysteresis]) -> tuple[tuple[int, int], str]:
    """The paper's cycles, or all but the first, in which rubber softens most; the reason."""
    samples = {loop.sample for loop in loops}
    first, last = CYCLES
    if not loops or {o.sample for o in loops if first <= o.cycle <= last} == samples:
        return CYCLES, ""
    top = max(loop.cycle for loop in loops)
    begin = 2 if {o.sample for o in loops if o.cycle > 1} == samples else 1
    why = f"cycles {first} to {last}, the usual ones, were not measured of every sample"
    shown = f"cycle {top} is" if begin == top else f"cycles {begin} to {top} are"
    return (begin, top), f"{shown} fitted: {why}"


def whole_window(used: Sequence[Hysteresis]) -> tuple[float, float]:
    """All strokes that every loading half covers with the band in tension [m]."""
    return max(map(_taut_from, used)), min(float(np.max(loop.stroke)) for loop in used)


def taut(force: Floats, step: float) -> Bools:
    """Mask of the forces (n,) [N] of a loading half, of this resolution [N], in tension."""
    return force > max(_SLACK * float(np.max(force)), 0.5 * step)


def _taut_from(loop: Hysteresis) -> float:
    """Stroke of the last slack reading before the largest force, or of the first reading [m]."""
    top = int(np.argmax(loop.force))
    slack = np.flatnonzero(~taut(loop.force, loop.steps[1])[:top])
    return float(loop.stroke[slack[-1] if len(slack) else 0])


# Bands of a kind differ by 10 %, seldom by 15 %. If two differ by more than this factor, with none
# between them, they are of two kinds, or one of the runs is damaged.
_APART = 1.4
# Rubber softens from cycle to cycle and never stiffens: by half in its first cycles, then by a few
# percent. Beyond these factors the next cycle is that of another band.
_SOFTER_AT_FIRST, _SOFTER, _STIFFER = 4.0, 1.5, 1.3
_EARLY = 2
_ABOUT = 0.12  # tolerance between a factor and a whole number of bands


class LoadingRun(NamedTuple):
    """A loading half and its stiffness in the window [N/m]."""

    sample: int
    cycle: int
    source: str
    stiffness: float


class AlikeRuns(NamedTuple):
    """Runs of similar bands, their median stiffness [N/m] and number of bands."""

    runs: tuple[LoadingRun, ...]
    stiffness: float
    bands: int


def kinds(runs: Iterable[LoadingRun]) -> tuple[AlikeRuns, ...]:
    """Runs sorted into kinds of bands, the most frequent kind first.

    Runs of a sample are those of one band while its stiffness changes little between cycles.
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
    """The list, cut where an item is apart from the previous one."""
    cuts = [k for k, pair in enumerate(pairwise(items), 1) if apart(*pair)]
    return [items[begin:end] for begin, end in pairwise([0, *cuts, len(items)])]


def differing(usual: AlikeRuns, other: AlikeRuns) -> str:
    """Text on the difference of a kind of band from the usual one, with its files."""
    ratio = other.stiffness / usual.stiffness
    files = listed([run.source for run in other.runs])
    if ratio <= 0:
        return f"{files}: {other.stiffness:.3g} N/m, no tension at all"
    factor = ratio if ratio > 1 else 1 / ratio
    times = f"{factor:.3g} times as {'stiff' if ratio > 1 else 'soft'}"
    whole = round(factor)
    hint = ""
    if 2 <= whole <= 4 and abs(factor / whole - 1) < _ABOUT:
        swapped = f"{whole} bands in place of 1" if ratio > 1 else f"1 band in place of {whole}"
        hint = f" ({swapped}?)"
    return f"{files}: {other.stiffness:.4g} N/m, {times}{hint}"


def listed(names: Sequence[str]) -> str:
    """Some file names, and the number of further ones."""
    return join_first([name.replace("\\", "/").rpartition("/")[2] for name in names], 3)


def _one_band_each(runs: list[LoadingRun]) -> list[list[LoadingRun]]:
    """Runs of a sample, cut where the next cycle cannot be that of the same band."""

    def other(before: LoadingRun, run: LoadingRun) -> bool:
        softer = _SOFTER_AT_FIRST if before.cycle < _EARLY else _SOFTER
        allowed = _STIFFER if run.stiffness > before.stiffness else softer
        return _ratio(*sorted((before.stiffness, run.stiffness))) > allowed

    return _parted(sorted(runs, key=lambda run: run.cycle), other)


def _typical(runs: list[LoadingRun]) -> float:
    """Median stiffness of a band, without its first cycle if it has others."""
    later = [run.stiffness for run in runs if run.cycle > 1]
    return float(np.median(later or [run.stiffness for run in runs]))


def _ratio(low: float, high: float) -> float:
    return high / low if low > 0 else (1.0 if high <= 0 else math.inf)
