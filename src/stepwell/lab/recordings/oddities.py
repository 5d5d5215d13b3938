"""What is odd in a recording, by itself and beside its neighbours."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stepwell.lab.recordings.names import run_number, stem_of
from stepwell.lab.recordings.recording import Recording

Array = NDArray[np.float64]

LATE = 0.02e-3  # [m] of stroke at the first sample
SETTLE = 0.5e-3  # [m] of stroke in which a rig takes up its slack
END = 0.1e-3  # [m] before the end of a stroke, where blocks may touch
SHORT = 0.99  # of the samples that the neighbours have
TIME_GAP = 3.0  # steps


def oddities(recording: Recording) -> tuple[str, ...]:
    """What is odd in one recording, a line for each thing; empty where nothing is.

    Args:
        recording: any.
    """
    told = list(recording.remarks)
    first = float(recording.stroke[0])
    if abs(first) > LATE:
        told.append(f"starts late, at a stroke of {first * 1e3:.4g} mm")
    if np.ptp(recording.stroke) == 0:
        told.append("the stroke never changes")
    told += _clock(recording)
    told += _start(recording)
    told += _end(recording)
    return tuple(told)


def batch_oddities(recordings: Iterable[Recording]) -> dict[str, tuple[str, ...]]:
    """What is odd in recordings beside others of the same folder and name.

    Args:
        recordings: any; run numbers are the digits at the end of a name.

    Returns:
        For each source that stands out a line for each thing; missing numbers are told of the
        recording that follows the gap.
    """
    told: dict[str, list[str]] = defaultdict(list)
    for source, line in missing(recordings).items():
        told[source].append(line)
    for family in _families(recordings):
        for source, lines in unlike(family).items():
            told[source] += lines
        for source, line in _jumps(family).items():
            told[source].append(line)
    return {source: tuple(lines) for source, lines in told.items()}


def missing(recordings: Iterable[Recording]) -> dict[str, str]:
    """Gaps in the numbers of each folder and name, told of the recording that follows the gap."""
    told: dict[str, str] = {}
    for family in _families(recordings):
        numbered = [(n, r) for r in family if (n := run_number(r.name)) is not None]
        expected = 1
        for number, recording in sorted(numbered, key=lambda pair: pair[0]):
            if number > expected:
                gone = f"{expected}" if number == expected + 1 else f"{expected} to {number - 1}"
                told[recording.source] = f"number {gone} is missing before it"
            expected = number + 1
    return told


def unlike(repeats: Sequence[Recording]) -> dict[str, list[str]]:
    """Repeats that are shorter, slower, stronger or weaker than the others, three or more."""
    told: dict[str, list[str]] = defaultdict(list)
    if len(repeats) < 3:
        return told
    spans = np.array([float(np.ptp(r.stroke)) for r in repeats])
    speeds = np.array([r.speed for r in repeats])
    means = np.array([float(np.mean(r.force)) for r in repeats])
    off = means - np.median(means)
    spread = 1.4826 * float(np.median(np.abs(off)))
    usual_span, usual_speed = float(np.median(spans)), float(np.median(speeds))
    for recording, span, speed, force in zip(repeats, spans, speeds, off, strict=True):
        lines = told[recording.source]
        if span < SHORT * usual_span:
            lines.append(
                f"stroke of {span * 1e3:.4g} mm where the others have {usual_span * 1e3:.4g} mm"
            )
        if abs(speed - usual_speed) > 0.05 * usual_speed:
            lines.append(
                f"{speed * 1e3:.3g} mm/s where the others have {usual_speed * 1e3:.3g} mm/s"
            )
        if abs(force) > max(4 * spread, 0.05 * float(np.ptp(recording.force))):
            lines.append(f"mean force {force:+.2g} N beside the median run")
    return told


def _families(recordings: Iterable[Recording]) -> list[list[Recording]]:
    families: dict[tuple[str, str], list[Recording]] = defaultdict(list)
    for recording in recordings:
        families[recording.group, stem_of(recording.name)].append(recording)
    return list(families.values())


def _clock(recording: Recording) -> list[str]:
    steps = np.diff(recording.time)
    if not np.all(np.isfinite(steps)):
        return []
    back = int(np.sum(steps <= 0))
    if back:
        return [f"time stands still or runs back at {back} samples"]
    widest = float(np.max(steps)) * recording.rate
    return [f"a gap of {widest:.0f} time steps"] if widest > TIME_GAP else []


def _start(recording: Recording) -> list[str]:
    """A force that climbs in the first half millimetre: slack in the rig, or a jam."""
    u, force = np.abs(recording.stroke - recording.stroke[0]), recording.force
    settled = (u > SETTLE) & (u < 2 * SETTLE)
    if recording.turns or np.sum(settled) < 10 or np.ptp(u) < 10 * SETTLE:
        return []
    level = float(np.median(force[settled]))
    if abs(force[0] - level) <= 0.15 * float(np.ptp(force)):
        return []
    return [f"the force takes {SETTLE * 1e3:g} mm or so to settle: slack in the rig, or a jam"]


def _end(recording: Recording) -> list[str]:
    """A force that leaves its course in the last tenth of a millimetre: blocks that touch."""
    u, force = recording.stroke, recording.force
    if recording.turns or len(recording) < 100:
        return []
    away = np.abs(u - u[-1])
    last, before = away < END, (away >= END) & (away < 6 * END)
    if np.sum(last) < 4 or np.sum(before) < 10:
        return []
    course = np.polyfit(u[before], force[before], 1)
    noise = float(np.std(force[before] - np.polyval(course, u[before])))
    off = float(force[-1] - np.polyval(course, u[-1]))
    if abs(off) <= max(8 * noise, 0.05 * float(np.ptp(force))):
        return []
    return [f"the force leaves its course by {off:+.2g} N in the last {END * 1e3:g} mm: end stop?"]


def _jumps(family: list[Recording]) -> dict[str, str]:
    """A load-and-unload cycle with a higher peak than the one before: another sample, probably."""
    cycles = sorted(
        ((n, r) for r in family if r.turns and (n := run_number(r.name)) is not None),
        key=lambda pair: pair[0],
    )
    told: dict[str, str] = {}
    for (_, before), (_, recording) in pairwise(cycles):
        peak, last = float(np.max(recording.force)), float(np.max(before.force))
        if peak > 1.1 * last > 0:
            told[recording.source] = (
                f"peak force {peak / last:.2f} times that of the number before: another sample?"
            )
    return told
