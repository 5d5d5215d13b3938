"""Tension tests of bands: which samples and cycles, how stiff, how much of the work is lost."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import ByValue, Drawn, Floats, need, to_unit
from stepwell.lab.bands import halves
from stepwell.lab.recordings.recording import LabError, Recording
from stepwell.mechanism import sizes

if TYPE_CHECKING:
    import xarray as xr

_Loops = Sequence[halves.Hysteresis]
# Of the largest force, a rise over the stroke that is none.
_NO_RISE = 1e-9


@dataclass(frozen=True, eq=False)
class BandTest(ByValue, Drawn):
    """Tension tests of bands of one kind, and what of them is used.

    Attributes:
        loops: every cycle of every sample that is not left out.
        window: stroke between which bands are fitted [m].
        cycles: first and last cycle that is fitted.
        notes: which files were used, which dropped and why, and what is odd.
        gauge: mean length at stroke 0 [m], where the files hold that of the bands; else None.
        apart: sample and cycle of what is of another kind than most, and not used.
        warnings: what to know before anything else.
    """

    loops: tuple[halves.Hysteresis, ...] = field(repr=False)
    window: tuple[float, float]
    cycles: tuple[int, int]
    notes: tuple[str, ...] = field(repr=False)
    gauge: float | None = field(default=None, repr=False)
    apart: frozenset[tuple[int, int]] = field(default=frozenset(), repr=False)
    warnings: tuple[str, ...] = field(default=(), repr=False)

    @property
    def samples(self) -> tuple[int, ...]:
        """The samples that are used."""
        return tuple(sorted({loop.sample for loop in self.used}))

    @property
    def used(self) -> tuple[halves.Hysteresis, ...]:
        """The cycles that are fitted."""
        first, last = self.cycles
        return tuple(
            loop
            for loop in self.loops
            if first <= loop.cycle <= last and (loop.sample, loop.cycle) not in self.apart
        )

    def curve(self, sample: int, points: int = 61) -> tuple[Floats, Floats]:
        """Mean loading curve of a sample inside the window, at so many points.

        Strokes (points,) [m] and forces (points,) [N], each the mean over a strip around it.
        """
        low, high = self.window
        stroke, force = self.samples_of(sample, self.window)
        edges = np.linspace(low, high, points + 1)
        strip = np.clip(np.searchsorted(edges, stroke, side="right") - 1, 0, points - 1)
        count = np.bincount(strip, minlength=points)
        full = count > 0
        u = np.bincount(strip, stroke, points)[full] / count[full]
        return u, np.bincount(strip, force, points)[full] / count[full]

    def samples_of(self, sample: int, window: tuple[float, float]) -> tuple[Floats, Floats]:
        """Stroke [m] and force [N] of every loading sample of a band inside a window [m]."""
        return _inside([loop for loop in self.used if loop.sample == sample], window)

    def steps_of(self, sample: int) -> tuple[float, float]:
        """In which stroke [m] and force [N] the points of `curve` are told; 0 for no step.

        A mean of many readings is told better than one of them.
        """
        loops = [loop for loop in self.used if loop.sample == sample]
        means = len(self.samples_of(sample, self.window)[0]) / len(self.curve(sample)[0])
        stroke, force = np.max([loop.steps for loop in loops], axis=0) / math.sqrt(means)
        return float(stroke), float(force)

    def __repr__(self):
        low, high = (to_unit(edge, "mm") for edge in self.window)
        return (
            f"BandTest(samples {', '.join(map(str, self.samples))}, cycles {self.cycles[0]} to "
            f"{self.cycles[1]}, {low:g} to {high:g} mm)"
        )


def band_test(
    recordings: Sequence[Recording],
    *,
    window: tuple[float, float] | None = None,
    cycles: tuple[int, int] | None = None,
    drop: Iterable[int] = (),
    cycles_per_sample: int | None = None,
) -> BandTest:
    """Sort tension tests into samples and cycles, and say what is used.

    Samples are told apart by names such as Samp2_45mm_7; where names only count through, by
    `cycles_per_sample`; else all files of one stem are one sample. Bands of another kind than most
    are not used, and warned of.

    Args:
        recordings: tension tests, each one or more cycles long.
        window: stroke between which bands are fitted [m]; the paper's 5 to 35 mm by default, or
            where a stroke does not reach over them or they hold few readings, all that is taut.
        cycles: first and last cycle that is fitted, from 1; the paper's 5 to 9 by default, or where
            a sample has none of them, all but the first.
        drop: numbers of samples to leave out.
        cycles_per_sample: how many files in a row are of one sample.

    Raises:
        LabError: nothing is left, a sample does not reach over the window, or no kind of band is
            in the majority.
    """
    if window is not None and not 0 <= window[0] < window[1]:
        raise LabError("window", f"{_mm(window)} mm: must be two strokes that rise from 0 on.")
    if cycles is not None and not 1 <= cycles[0] <= cycles[1]:
        raise LabError("cycles", f"{cycles[0]} to {cycles[1]}: must rise from 1 on.")
    loops, gauge, notes = halves.loops_of(recordings, set(drop), cycles_per_sample)
    other_cycles = other_window = ""
    if cycles is None:
        cycles, other_cycles = halves.usual_cycles(loops)
    if window is None:
        used = [loop for loop in loops if cycles[0] <= loop.cycle <= cycles[1]]
        window, other_window = halves.usual_window(used)
    test = BandTest(loops, window, cycles, notes, gauge)
    _check_reach(test)
    apart, warnings = _apart(test)
    test = replace(test, apart=apart, warnings=warnings)
    for sample, k in stiffness(test).each.items():
        if math.isnan(k):
            raise LabError(
                f"sample {sample}",
                f"holds fewer than 2 readings of a taut band between {_mm(test.window)} mm of "
                f"stroke: pass another window, or drop it.",
            )
    adapted = filter(None, (other_cycles, other_window))
    return replace(test, notes=(*adapted, *_used_lines(test), *notes))


def _apart(test: BandTest) -> tuple[frozenset[tuple[int, int]], tuple[str, ...]]:
    """Sample and cycle of runs of another kind than most, and the warning of them."""
    usual, *others = halves.kinds(_runs(test))
    if usual.stiffness <= 0:
        raise LabError(
            halves.listed([run.source for run in usual.runs]),
            f"the force changes by {usual.stiffness:.3g} N/m of stroke: it must rise as the band "
            f"gets longer. Look at the sign and at which column is which.",
        )
    slips = tuple(
        f"{slip} Check the units in the header."
        for slip in sizes.spring("The stiffness", usual.stiffness)
    )
    if not others:
        return frozenset(), slips
    differ = "; ".join(halves.differing(usual, other) for other in others)
    advice = _sorting_advice(usual, others)
    bands = usual.bands + sum(other.bands for other in others)
    if 2 * usual.bands <= bands:
        raise LabError(
            "band test",
            f"the runs are not of one kind of band, and no kind is in the majority: "
            f"{halves.listed([run.source for run in usual.runs])}: {usual.stiffness:.4g} N/m; "
            f"{differ}. {advice[0].upper()}{advice[1:]}",
        )
    apart = frozenset((run.sample, run.cycle) for other in others for run in other.runs)
    warning = (
        f"Not one kind of band: {usual.bands} of {bands} have about {usual.stiffness:.4g} N/m; "
        f"not used: {differ}. Another kind, or a broken run: {advice}"
    )
    return apart, (warning, *slips)


def _runs(test: BandTest) -> list[halves.LoadingRun]:
    """The stiffness of every loading half that is used."""
    runs: list[halves.LoadingRun] = []
    for loop in test.used:
        stroke, force = _pulling([loop], test.window)
        if len(stroke) < 2:
            stroke, force = _inside([loop], test.window)
        k = _slope(stroke, force)
        if math.isnan(k):
            raise LabError(
                loop.source,
                f"holds fewer than 2 readings between {_mm(test.window)} mm of stroke: pass "
                f"another window, or drop sample {loop.sample}.",
            )
        runs.append(halves.LoadingRun(loop.sample, loop.cycle, loop.source, k))
    return runs


def _sorting_advice(usual: halves.AlikeRuns, others: list[halves.AlikeRuns]) -> str:
    odd = {run.sample for other in others for run in other.runs}
    if whole := sorted(odd - {run.sample for run in usual.runs}):
        drop = " ".join(f"--drop {sample}" for sample in whole)
        return f"leave out {drop}, or keep each kind in a folder of its own."
    return (
        "keep each kind in a folder of its own, or tell samples apart by --cycles-per-sample and "
        "leave some out by --drop."
    )


def stiffness(test: BandTest) -> halves.Estimate:
    """Stiffness k of the line through the window, loading, for the mean of the samples [N/m].

    The interval holds the mean of all bands of this kind in 95 % of such tests, if bands scatter
    normally; it comes from the scatter between samples, which contains that of the cycles, and is
    not known for one sample.
    """
    return halves.of_samples(
        {
            sample: _slope(*_pulling([o for o in test.used if o.sample == sample], test.window))
            for sample in test.samples
        }
    )


def stiffness_by_window(test: BandTest, step: float | None = None) -> "xr.DataArray":
    """The same stiffness [N/m] over "start" and "end" of the window [m]; NaN below 2 steps.

    `step` is the distance of the edges [m]; about a ninth of the stroke by default.
    """
    need("tables")
    import xarray as xr

    edges, grid = stiffness_grid(test, step)
    return xr.DataArray(
        grid,
        {"start": edges, "end": edges},
        ("start", "end"),
        "stiffness",
        {"units": "N/m", "long_name": "stiffness of the line between start and end of stroke"},
    )


def stiffness_grid(test: BandTest, step: float | None = None) -> tuple[Floats, Floats]:
    """The edges of the windows [m], and k [N/m] from each to each, as `stiffness_by_window`."""
    reach = min(float(np.max(loop.stroke)) for loop in test.used)
    if step is None:
        step = float(f"{max(reach, halves.REACH) / 9:.0e}")
    edges = np.arange(0, max(math.floor(reach / step + 1e-9), 0) + 1) * step
    grid = np.full((len(edges), len(edges)), np.nan)
    for i, j in zip(*np.triu_indices(len(edges), 2), strict=True):
        inside = (test.samples_of(s, (edges[i], edges[j])) for s in test.samples)
        grid[i, j] = np.mean([_slope(*samples) for samples in inside])
    return np.asarray(edges, float), grid


def hysteresis(test: BandTest) -> "xr.DataArray":
    """Share of the loading work that is lost [1], used or not, over "sample" and "cycle".

    NaN where there is no such cycle.
    """
    need("tables")
    import xarray as xr

    samples = sorted({loop.sample for loop in test.loops})
    cycles = sorted({loop.cycle for loop in test.loops})
    grid = np.full((len(samples), len(cycles)), np.nan)
    for loop in test.loops:
        grid[samples.index(loop.sample), cycles.index(loop.cycle)] = loop.loss
    return xr.DataArray(
        grid,
        {"sample": samples, "cycle": cycles},
        ("sample", "cycle"),
        "loss",
        {"units": "1", "long_name": "share of the loading work that is lost"},
    )


def _check_reach(test: BandTest) -> None:
    """Refuse a test of which no cycle is used, or one does not reach over the window."""
    if not test.used:
        have = sorted({loop.cycle for loop in test.loops})
        shown = f"cycles {have[0]} to {have[-1]}" if have else "no loading half at all"
        raise LabError(
            "band test",
            f"cycles {test.cycles[0]} to {test.cycles[1]} are asked for and the recordings hold "
            f"{shown}: pass the cycles to use, and how many files are of one sample.",
        )
    for loop in test.used:
        low, high = float(np.min(loop.stroke)), float(np.max(loop.stroke))
        if low > test.window[0] + halves.REACH or high < test.window[1] - halves.REACH:
            raise LabError(
                loop.source,
                f"its stroke of {_mm((low, high))} mm does not reach over the window of "
                f"{_mm(test.window)} mm: pass another window, or drop sample {loop.sample}.",
            )


def _used_lines(test: BandTest) -> list[str]:
    """Which cycles of each sample are used, a line for each."""
    lines: list[str] = []
    used = {(loop.sample, loop.cycle) for loop in test.used}
    for sample in sorted({loop.sample for loop in test.loops}):
        every = [loop.cycle for loop in test.loops if loop.sample == sample]
        mine = [cycle for cycle in every if (sample, cycle) in used]
        apart = [cycle for cycle in every if (sample, cycle) in test.apart]
        rest = [cycle for cycle in every if cycle not in (*mine, *apart)]
        text = f"cycles {_listed(mine)} used, {_listed(rest)} not"
        if not mine:
            text = f"not used, it has cycles {_listed(rest)} only"
        if apart:
            text = f"{text}; {_listed(apart)} not" if mine else f"cycles {_listed(apart)} not used"
            text += ", of another kind"
        lines.append(f"sample {sample}: {text}")
    return lines


def _inside(loops: _Loops, window: tuple[float, float]) -> tuple[Floats, Floats]:
    """Stroke [m] and force [N] of the loading halves inside a window [m]."""
    stroke = np.concatenate([loop.stroke for loop in loops])
    force = np.concatenate([loop.force for loop in loops])
    inside = (stroke >= window[0]) & (stroke <= window[1])
    return stroke[inside], force[inside]


def _pulling(loops: _Loops, window: tuple[float, float]) -> tuple[Floats, Floats]:
    """The same where the band is taut."""
    pairs = [(loop, halves.taut(loop.force, loop.steps[1])) for loop in loops]
    return _inside([replace(o, stroke=o.stroke[p], force=o.force[p]) for o, p in pairs], window)


def _slope(stroke: Floats, force: Floats) -> float:
    if len(stroke) < 2 or np.ptp(stroke) == 0:
        return math.nan
    off = stroke - np.mean(stroke)
    slope = float(off @ (force - np.mean(force)) / (off @ off))
    # Forces that are all the same do not rise by the last bits of their mean.
    return slope if abs(slope) * np.ptp(stroke) > _NO_RISE * np.max(np.abs(force)) else 0.0


def _listed(numbers: list[int]) -> str:
    return ", ".join(map(str, sorted(numbers))) or "none"


def _mm(edges: tuple[float, float]) -> str:
    return f"{to_unit(edges[0], 'mm'):.4g} to {to_unit(edges[1], 'mm'):.4g}"
