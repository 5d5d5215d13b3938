"""Tension tests of bands: which samples and cycles, how stiff, how much of the work is lost."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import ByValue, Drawn, Floats, brief, need
from stepwell.lab.bands.spread import Estimate, of_samples
from stepwell.lab.recordings import (
    LabError,
    Recording,
    batch_oddities,
    is_baseline,
    natural,
    run_number,
    sample_number,
    stem_of,
)

if TYPE_CHECKING:
    import xarray as xr


# What the paper's stiffness was read from: 5 to 35 mm of cycles 5 to 9.
WINDOW = (0.005, 0.035)
CYCLES = (5, 9)


@dataclass(frozen=True, eq=False)
class Hysteresis(ByValue):
    """One cycle of one sample.

    Attributes:
        sample, cycle: counted from 1.
        source: the file it comes from.
        stroke, force: (n,) of the loading half [m], [N].
        back_stroke, back_force: (m,) of the unloading half; empty where there is none.
    """

    sample: int
    cycle: int
    source: str
    stroke: Floats = field(repr=False)
    force: Floats = field(repr=False)
    back_stroke: Floats = field(repr=False)
    back_force: Floats = field(repr=False)

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

    def __repr__(self):
        return brief(self)


@dataclass(frozen=True, eq=False)
class BandTest(ByValue, Drawn):
    """Tension tests of bands of one kind, and what of them is used.

    Attributes:
        loops: every cycle of every sample that is not left out.
        window: stroke between which bands are fitted [m].
        cycles: first and last cycle that is fitted.
        told: which files were used, which dropped and why, and what is odd.
    """

    loops: tuple[Hysteresis, ...] = field(repr=False)
    window: tuple[float, float]
    cycles: tuple[int, int]
    told: tuple[str, ...] = field(repr=False)

    @property
    def samples(self) -> tuple[int, ...]:
        """The samples that are used."""
        return tuple(sorted({loop.sample for loop in self.used}))

    @property
    def used(self) -> tuple[Hysteresis, ...]:
        """The cycles that are fitted."""
        first, last = self.cycles
        return tuple(loop for loop in self.loops if first <= loop.cycle <= last)

    def curve(self, sample: int, points: int = 61) -> tuple[Floats, Floats]:
        """Mean loading curve of a sample inside the window.

        Args:
            sample: its number.
            points: how many places.

        Returns:
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
        loops = [loop for loop in self.used if loop.sample == sample]
        stroke = np.concatenate([loop.stroke for loop in loops])
        force = np.concatenate([loop.force for loop in loops])
        inside = (stroke >= window[0]) & (stroke <= window[1])
        return stroke[inside], force[inside]

    def __repr__(self):
        low, high = (1e3 * edge for edge in self.window)
        return (
            f"BandTest(samples {', '.join(map(str, self.samples))}, cycles {self.cycles[0]} to "
            f"{self.cycles[1]}, {low:g} to {high:g} mm)"
        )


def band_test(
    recordings: Sequence[Recording],
    *,
    window: tuple[float, float] = WINDOW,
    cycles: tuple[int, int] = CYCLES,
    drop: Iterable[int] = (),
    cycles_per_sample: int | None = None,
) -> BandTest:
    """Sort tension tests into samples and cycles, and say what is used.

    Samples are told apart by names such as Samp2_45mm_7; where names only count through, by
    `cycles_per_sample`; else all files of one stem are one sample.

    Args:
        recordings: tension tests, each one or more cycles long.
        window: stroke between which bands are fitted [m]; the default is the paper's.
        cycles: first and last cycle that is fitted, from 1; the default is the paper's.
        drop: numbers of samples to leave out.
        cycles_per_sample: how many files in a row are of one sample.

    Returns:
        The test.

    Raises:
        LabError: nothing is left, or a sample does not reach over the window.
    """
    if not 0 <= window[0] < window[1]:
        raise LabError("window", f"{_mm(window)} mm: must be two strokes that rise from 0 on.")
    if not 1 <= cycles[0] <= cycles[1]:
        raise LabError("cycles", f"{cycles[0]} to {cycles[1]}: must rise from 1 on.")
    left_out = set(drop)
    told: list[str] = []
    loops: list[Hysteresis] = []
    stems: dict[str, int] = {}
    cycle_of: dict[int, int] = {}
    odd = batch_oddities(recordings)
    for recording in sorted(recordings, key=lambda r: natural(r.source)):
        if is_baseline(recording.name):
            told.append(f"{recording.source}: left out, its name says that no band was on")
            continue
        sample, first = _sample_and_cycle(recording, stems, cycles_per_sample)
        if sample in left_out:
            told.append(f"{recording.source}: left out, sample {sample} as asked")
            continue
        found = _loops(recording, sample, first or cycle_of.get(sample, 0) + 1)
        if not found:
            told.append(f"{recording.source}: left out, it has no loading half")
            continue
        cycle_of[sample] = found[-1].cycle
        loops += found
        told += [f"{recording.source}: {line}" for line in odd.get(recording.source, ())]
    test = BandTest(tuple(loops), window, cycles, tuple(told))
    return replace(test, told=(*_used_lines(test), *told))


def stiffness(test: BandTest) -> Estimate:
    """Stiffness k of the line through the window, loading, for the mean of the samples [N/m].

    The interval holds the mean of all bands of this kind in 95 % of such tests, if bands scatter
    normally; it comes from the scatter between samples, which contains that of the cycles.

    Args:
        test: one or more samples.

    Returns:
        The estimate; without an interval where there is one sample only.
    """
    return of_samples({s: _slope(*test.samples_of(s, test.window)) for s in test.samples})


def stiffness_by_window(test: BandTest, step: float | None = None) -> xr.DataArray:
    """The same stiffness for other windows.

    Args:
        test: one or more samples.
        step: distance of the edges [m]; about a ninth of the stroke by default.

    Returns:
        k [N/m] over "start" and "end" of the window [m]; NaN where end - start < 2 steps.
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
        step = float(f"{reach / 9:.0e}")
    edges = np.arange(0, math.floor(reach / step + 1e-9) + 1) * step
    grid = np.full((len(edges), len(edges)), np.nan)
    for i, low in enumerate(edges):
        for j, high in enumerate(edges):
            if j >= i + 2:
                inside = (test.samples_of(s, (low, high)) for s in test.samples)
                grid[i, j] = np.mean([_slope(*samples) for samples in inside])
    return np.asarray(edges, float), grid


def hysteresis(test: BandTest) -> xr.DataArray:
    """Share of the loading work that is lost in each cycle of each sample, used or not.

    Args:
        test: one or more samples.

    Returns:
        Loss [1] over "sample" and "cycle"; NaN where there is no such cycle.
    """
    need("tables")
    import xarray as xr

    samples, cycles, grid = loss_grid(test)
    return xr.DataArray(
        grid,
        {"sample": samples, "cycle": cycles},
        ("sample", "cycle"),
        "loss",
        {"units": "1", "long_name": "share of the loading work that is lost"},
    )


def loss_grid(test: BandTest) -> tuple[list[int], list[int], Floats]:
    """The samples, their cycles, and the share lost in each, as `hysteresis`."""
    samples = sorted({loop.sample for loop in test.loops})
    cycles = sorted({loop.cycle for loop in test.loops})
    grid = np.full((len(samples), len(cycles)), np.nan)
    for loop in test.loops:
        grid[samples.index(loop.sample), cycles.index(loop.cycle)] = loop.loss
    return samples, cycles, grid


def _sample_and_cycle(
    recording: Recording, stems: dict[str, int], per_sample: int | None
) -> tuple[int, int | None]:
    """Sample and first cycle of a recording; the cycle None where it follows from the order."""
    run = run_number(recording.name)
    if per_sample is not None and run is not None:
        return (run - 1) // per_sample + 1, (run - 1) % per_sample + 1
    named = sample_number(recording.name)
    if named is not None:
        return named, run
    stem = recording.group + stem_of(recording.name)
    return stems.setdefault(stem, len(stems) + 1), run


def _loops(recording: Recording, sample: int, first: int) -> list[Hysteresis]:
    u, force = recording.stroke, recording.force
    found: list[Hysteresis] = []
    for half, back in pairwise([*recording.halves, slice(0, 0)]):
        if recording.direction_of(half) == "loading":
            parts = u[half], force[half], u[back], force[back]
            found.append(Hysteresis(sample, first + len(found), recording.source, *parts))
    return found


def _used_lines(test: BandTest) -> list[str]:
    """Which cycles of each sample are used, a line for each.

    Raises:
        LabError: none is, or one does not reach over the window.
    """
    loops, used = test.loops, test.used
    if not used:
        have = sorted({loop.cycle for loop in loops})
        shown = f"cycles {have[0]} to {have[-1]}" if have else "no loading half at all"
        raise LabError(
            "band test",
            f"cycles {test.cycles[0]} to {test.cycles[1]} are asked for and the recordings hold "
            f"{shown}: pass the cycles to use, and how many files are of one sample.",
        )
    for loop in used:
        low, high = float(np.min(loop.stroke)), float(np.max(loop.stroke))
        if low > test.window[0] + 1e-4 or high < test.window[1] - 1e-4:
            raise LabError(
                loop.source,
                f"its stroke of {_mm((low, high))} mm does not reach over the window of "
                f"{_mm(test.window)} mm: pass another window, or drop sample {loop.sample}.",
            )
    lines: list[str] = []
    for sample in sorted({loop.sample for loop in loops}):
        mine = [loop.cycle for loop in used if loop.sample == sample]
        rest = [loop.cycle for loop in loops if loop.sample == sample and loop.cycle not in mine]
        told = f"cycles {_listed(mine)} used, {_listed(rest)} not"
        only = f"not used, it has cycles {_listed(rest)} only"
        lines.append(f"sample {sample}: {told if mine else only}")
    return lines


def _slope(stroke: Floats, force: Floats) -> float:
    if len(stroke) < 2:
        return math.nan
    off = stroke - np.mean(stroke)
    return float(off @ force / (off @ off))


def _listed(numbers: list[int]) -> str:
    return ", ".join(map(str, sorted(numbers))) or "none"


def _mm(edges: tuple[float, float]) -> str:
    return f"{edges[0] * 1e3:.4g} to {edges[1] * 1e3:.4g}"
