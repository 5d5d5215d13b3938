"""Loading halves of tension tests: of which sample and which cycle each is."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from stepwell.base import ByValue, Floats, brief
from stepwell.lab.recordings import (
    Recording,
    batch_oddities,
    is_baseline,
    natural,
    run_number,
    sample_number,
    stem_of,
)

# Rows that a loading half has at least, and all halves on average, where a table is in an order.
_ROWS = 4


@dataclass(frozen=True, eq=False)
class Hysteresis(ByValue):
    """One cycle of one sample.

    Attributes:
        sample, cycle: counted from 1.
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

    def __repr__(self):
        return brief(self)


def loops_of(
    recordings: Sequence[Recording], left_out: set[int], per_sample: int | None
) -> tuple[tuple[Hysteresis, ...], float | None, tuple[str, ...]]:
    """Every cycle of every sample that is not left out.

    Samples are told apart by names such as Samp2_45mm_7; where names only count through, by
    `per_sample`; else all files of one stem are one sample. Cycles are numbered as the names do
    where those of a sample agree with the cycles in the files; else they are counted.

    Returns:
        The cycles; the mean length at stroke 0 [m], where every file holds the length of its band;
        and what is to be told.
    """
    told: list[str] = []
    by_sample: dict[int, list[Recording]] = defaultdict(list)
    numbers: dict[str, int | None] = {}
    odd = batch_oddities(recordings)
    for recording, sample, number in _sorted(recordings, per_sample):
        if is_baseline(recording.name):
            told.append(f"{recording.source}: left out, its name says that no band was on")
        elif sample in left_out:
            told.append(f"{recording.source}: left out, sample {sample} as asked")
        else:
            by_sample[sample].append(recording)
            numbers[recording.source] = number
    kept = [recording for files in by_sample.values() for recording in files]
    gauges = [recording.gauge for recording in kept if recording.gauge is not None]
    gauge = sum(gauges) / len(gauges) if gauges and len(gauges) == len(kept) else None
    if gauges and gauge is None:
        told.append("some files hold the length of the band and some do not: it is not used")
    loops: list[Hysteresis] = []
    for sample, files in sorted(by_sample.items()):
        cycles = [list(_cycles(recording)) for recording in files]
        named = _named([numbers[r.source] for r in files], [len(found) for found in cycles])
        cycle = 0
        for recording, found, number in zip(files, cycles, named, strict=True):
            if not found:
                told.append(f"{recording.source}: left out, it has no loading half")
            cycle = cycle if number is None else number - 1
            for parts in found:
                cycle += 1
                loops.append(Hysteresis(sample, cycle, recording.source, *parts, recording.steps))
            lines = (*recording.remarks, *_order(recording), *odd.get(recording.source, ()))
            told += [f"{recording.source}: {line}" for line in lines]
    return tuple(loops), gauge, tuple(told)


def _sorted(
    recordings: Iterable[Recording], per_sample: int | None
) -> Iterator[tuple[Recording, int, int | None]]:
    """Recordings in the natural order of their names, with sample and number by their names."""
    ordered = sorted(recordings, key=lambda r: natural(r.source))
    stems: dict[str, int] = {}
    for recording in ordered:
        run, named = run_number(recording.name), sample_number(recording.name)
        if per_sample is not None and run is not None:
            yield recording, (run - 1) // per_sample + 1, (run - 1) % per_sample + 1
        elif named is not None:
            # The number at the end of Samp3 is the sample's own.
            is_run = stem_of(recording.name).rstrip("_").lower() not in ("samp", "sample")
            yield recording, named, run if is_run else None
        else:
            stem = recording.group + stem_of(recording.name)
            alone = sum(recording.group + stem_of(r.name) == stem for r in ordered) == 1
            yield recording, stems.setdefault(stem, len(stems) + 1), None if alone else run


def _named(numbers: list[int | None], found: list[int]) -> list[int | None]:
    """The numbers of the files of a sample where they can be cycles, else none of them."""
    ends = [-1 if n is None else n + count for n, count in zip(numbers, found, strict=True)]
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
