"""Tension tests of bands: samples and cycles, stiffness, hysteresis loss."""

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
# Larger stiffness [N/m] or force [N] than that of usual rubber bands.
_STIFF, _STRONG = 2000.0, 100.0
# Fraction of the largest force below which a rise over the stroke counts as zero.
_NO_RISE = 1e-9


@dataclass(frozen=True, eq=False)
class BandTest(ByValue, Drawn):
    """Tension tests of bands of one kind, with the samples and cycles in use.

    Attributes:
        loops: every cycle of every sample that is not left out.
        window: range of stroke for the fit [m].
        cycles: first and last cycle for the fit.
        notes: files that were used or dropped, with reasons, and irregularities.
        gauge: mean length at stroke 0 [m] if the files contain the length of the bands, else None.
        apart: sample and cycle of runs of another kind than most, which are not used.
        warnings: of bands of several kinds and of probable unit errors.
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
        """Numbers of the samples in use."""
        return tuple(sorted({loop.sample for loop in self.used}))

    @property
    def used(self) -> tuple[halves.Hysteresis, ...]:
        """Cycles in the fit."""
        first, last = self.cycles
        return tuple(
            loop
            for loop in self.loops
            if first <= loop.cycle <= last and (loop.sample, loop.cycle) not in self.apart
        )

    def curve(self, sample: int, points: int = 61) -> tuple[Floats, Floats]:
        """Mean loading curve of a sample inside the window, with this number of points.

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
        """Resolution of stroke [m] and force [N] of the points of `curve`; 0 if unknown.

        A mean of many readings has a finer resolution than one reading.
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
    """Sort tension tests into samples and cycles, and select those for the fit.

    Samples are identified by names such as Samp2_45mm_7. If names are only numbered, they are
    identified by `cycles_per_sample`, else all files of one stem are one sample. Bands of another
    kind than most are not used, with a warning.

    Args:
        recordings: tension tests, each one or more cycles long.
        window: range of stroke for the fit [m], where the band is used; by default the whole test,
            from the onset of tension on.
        cycles: first and last cycle for the fit, from 1; by default the paper's 5 to 9, or all but
            the first if a sample has none of these.
        drop: numbers of samples to leave out.
        cycles_per_sample: number of consecutive files of one sample.

    Raises:
        LabError: no cycle is left, a sample does not cover the window, or no kind of band is in the
            majority.
    """
    if window is not None and not 0 <= window[0] < window[1]:
        raise LabError("window", f"{_mm(window)} mm: must be two rising strokes >= 0.")
    if cycles is not None and not 1 <= cycles[0] <= cycles[1]:
        raise LabError("cycles", f"{cycles[0]} to {cycles[1]}: must be two rising numbers >= 1.")
    loops, gauge, notes = halves.loops_of(recordings, set(drop), cycles_per_sample)
    other_cycles = ""
    if cycles is None:
        cycles, other_cycles = halves.usual_cycles(loops)
    if window is None:
        used = [loop for loop in loops if cycles[0] <= loop.cycle <= cycles[1]]
        window = halves.whole_window(used or loops) if loops else (0.0, 0.0)
    test = BandTest(loops, window, cycles, notes, gauge)
    _check_reach(test)
    apart, warnings = _apart(test)
    test = replace(test, apart=apart, warnings=warnings)
    for sample, k in stiffness(test).each.items():
        if math.isnan(k):
            raise LabError(
                f"sample {sample}",
                f"has fewer than 2 readings of a band in tension between {_mm(test.window)} mm of "
                f"stroke: add readings, widen the window, or drop it.",
            )
    adapted = filter(None, [other_cycles])
    return replace(test, notes=(*adapted, *_used_lines(test), *notes))


def _apart(test: BandTest) -> tuple[frozenset[tuple[int, int]], tuple[str, ...]]:
    """Sample and cycle of runs of another kind than most, and warnings."""
    usual, *others = halves.kinds(_runs(test))
    if usual.stiffness <= 0:
        raise LabError(
            halves.listed([run.source for run in usual.runs]),
            f"the force changes by {usual.stiffness:.3g} N/m of stroke: it must rise as the "
            f"band gets longer. Check the sign of the force and the names of the columns.",
        )
    slips = tuple(
        f"{slip} Check the units in the header."
        for slip in sizes.spring("The stiffness", usual.stiffness)
    )
    largest = max(float(np.max(loop.force)) for loop in test.used)
    if not slips and (usual.stiffness > _STIFF or largest > _STRONG):
        slips = (
            f"{usual.stiffness:.4g} N/m and up to {largest:.4g} N are unusual for a rubber band. "
            f"Check the units in the header: are these cm and kg, not mm and g?",
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
        f"not used: {differ}. Another kind, or a damaged run: {advice}"
    )
    return apart, (warning, *slips)


def _runs(test: BandTest) -> list[halves.LoadingRun]:
    """Stiffness of every loading half in use."""
    runs: list[halves.LoadingRun] = []
    for loop in test.used:
        stroke, force = _pulling([loop], test.window)
        if len(stroke) < 2:
            stroke, force = _inside([loop], test.window)
        k = _slope(stroke, force)
        if math.isnan(k):
            raise LabError(
                loop.source,
                f"has fewer than 2 readings between {_mm(test.window)} mm of stroke: add "
                f"readings, widen the window, or drop sample {loop.sample}.",
            )
        runs.append(halves.LoadingRun(loop.sample, loop.cycle, loop.source, k))
    return runs


def _sorting_advice(usual: halves.AlikeRuns, others: list[halves.AlikeRuns]) -> str:
    odd = {run.sample for other in others for run in other.runs}
    if whole := sorted(odd - {run.sample for run in usual.runs}):
        drop = " ".join(f"--drop {sample}" for sample in whole)
        return f"leave out {drop}, or put each kind into a separate folder."
    return (
        "put each kind into a separate folder, or separate the samples by --cycles-per-sample and "
        "leave some out by --drop."
    )


def stiffness(test: BandTest) -> halves.Estimate:
    """Stiffness k of the line through the window in loading, for the mean of the samples [N/m].

    The 95 % interval is that of the mean of all bands of this kind, if they are normally
    distributed. It follows from the scatter between samples, so it is unknown for one sample.
    """
    return halves.of_samples(
        {
            sample: _slope(*_pulling([o for o in test.used if o.sample == sample], test.window))
            for sample in test.samples
        }
    )


def stiffness_by_window(test: BandTest, step: float | None = None) -> "xr.DataArray":
    """Stiffness [N/m] over "start" and "end" of the window [m]; NaN below 2 steps.

    `step` is the distance of the edges [m], by default about a ninth of the stroke.
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
    """Edges of the windows [m], and k [N/m] between each two, as in `stiffness_by_window`."""
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
    """Lost fraction of the loading work [1] of all cycles over "sample" and "cycle".

    NaN for missing cycles.
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
        {"units": "1", "long_name": "lost fraction of the loading work"},
    )


def _check_reach(test: BandTest) -> None:
    """Raise LabError if no cycle is in use, or one does not cover the window."""
    if not test.used:
        have = sorted({loop.cycle for loop in test.loops})
        shown = f"cycles {have[0]} to {have[-1]}" if have else "no loading half at all"
        raise LabError(
            "band test",
            f"cycles {test.cycles[0]} to {test.cycles[1]} are requested and the recordings contain "
            f"{shown}: pass the cycles to use, and the number of files per sample.",
        )
    for loop in test.used:
        low, high = float(np.min(loop.stroke)), float(np.max(loop.stroke))
        if low > test.window[0] + halves.REACH or high < test.window[1] - halves.REACH:
            raise LabError(
                loop.source,
                f"its stroke of {_mm((low, high))} mm does not cover the window of "
                f"{_mm(test.window)} mm: pass another window, or drop sample {loop.sample}.",
            )


def _used_lines(test: BandTest) -> list[str]:
    """Cycles in use of each sample, a line each."""
    lines: list[str] = []
    used = {(loop.sample, loop.cycle) for loop in test.used}
    for sample in sorted({loop.sample for loop in test.loops}):
        every = [loop.cycle for loop in test.loops if loop.sample == sample]
        mine = [cycle for cycle in every if (sample, cycle) in used]
        apart = [cycle for cycle in every if (sample, cycle) in test.apart]
        rest = [cycle for cycle in every if cycle not in (*mine, *apart)]
        text = f"cycle{'s' * (len(mine) > 1)} {_listed(mine)} used"
        text += f", {_listed(rest)} not" * bool(rest)
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
    """Stroke [m] and force [N] inside a window where the band is in tension."""
    pairs = [(loop, halves.taut(loop.force, loop.steps[1])) for loop in loops]
    return _inside([replace(o, stroke=o.stroke[p], force=o.force[p]) for o, p in pairs], window)


def _slope(stroke: Floats, force: Floats) -> float:
    if len(stroke) < 2 or np.ptp(stroke) == 0:
        return math.nan
    off = stroke - np.mean(stroke)
    slope = float(off @ (force - np.mean(force)) / (off @ off))
    # Rounding errors of a constant force are no slope.
    return slope if abs(slope) * np.ptp(stroke) > _NO_RISE * np.max(np.abs(force)) else 0.0


def _listed(numbers: list[int]) -> str:
    return ", ".join(map(str, sorted(numbers))) or "none"


def _mm(edges: tuple[float, float]) -> str:
    return f"{to_unit(edges[0], 'mm'):.4g} to {to_unit(edges[1], 'mm'):.4g}"
