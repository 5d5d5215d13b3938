"""What is odd in a recording, by itself and beside its neighbours."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from stepwell.lab._names import run_number, stem_of
from stepwell.lab.recording import Recording

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
    families: dict[tuple[str, str], list[Recording]] = defaultdict(list)
    for recording in recordings:
        families[recording.group, stem_of(recording.name)].append(recording)
    for family in families.values():
        _missing(family, told)
        _unlike(family, told)
        _jumps(family, told)
    return {source: tuple(lines) for source, lines in told.items()}


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
    return [
        f"the force goes from {force[0]:.2g} to {level:.2g} N in the first {SETTLE * 1e3:g} mm: "
        f"slack or a jam"
    ]


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


def _missing(family: list[Recording], told: dict[str, list[str]]) -> None:
    numbered = sorted((n, r) for r in family if (n := run_number(r.name)) is not None)
    expected = 1
    for number, recording in numbered:
        if number > expected:
            gone = f"{expected}" if number == expected + 1 else f"{expected} to {number - 1}"
            told[recording.source].append(f"number {gone} is missing before it")
        expected = number + 1


def _unlike(family: list[Recording], told: dict[str, list[str]]) -> None:
    if len(family) < 3:
        return
    longest = float(np.median([np.ptp(r.stroke) for r in family]))
    samples = float(np.median([len(r) * r.speed / r.rate for r in family]))
    for recording in family:
        span = float(np.ptp(recording.stroke))
        if span < SHORT * longest:
            told[recording.source].append(
                f"stroke of {span * 1e3:.4g} mm where the others have {longest * 1e3:.4g} mm"
            )
        elif len(recording) * recording.speed / recording.rate < SHORT * samples:
            told[recording.source].append(f"{len(recording)} samples, fewer than the others")
    means = np.array([float(np.mean(r.force)) for r in family])
    apart = means - np.median(means)
    spread = 1.4826 * float(np.median(np.abs(apart)))
    for recording, off in zip(family, apart, strict=True):
        if abs(off) > max(4 * spread, 0.1 * float(np.ptp(recording.force))):
            told[recording.source].append(f"mean force {off:+.2g} N beside the median run")
    speeds = [r.speed for r in family]
    for recording, speed in zip(family, speeds, strict=True):
        usual = float(np.median(speeds))
        if abs(speed - usual) > 0.05 * usual:
            told[recording.source].append(
                f"{speed * 1e3:.3g} mm/s where the others have {usual * 1e3:.3g} mm/s"
            )


def _jumps(family: list[Recording], told: dict[str, list[str]]) -> None:
    """A load-and-unload cycle with a higher peak than the one before: another sample, probably."""
    cycles = sorted(
        ((n, r) for r in family if r.turns and (n := run_number(r.name)) is not None),
        key=lambda pair: pair[0],
    )
    for (_, before), (_, recording) in zip(cycles, cycles[1:], strict=False):
        ratio = float(np.max(recording.force) / np.max(before.force))
        if ratio > 1.1:
            told[recording.source].append(
                f"peak force {ratio:.2f} times that of the number before: another sample?"
            )
