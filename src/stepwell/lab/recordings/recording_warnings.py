"""Warnings about a recording, by itself and compared with others."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, pairwise

import numpy as np

from stepwell.base import grouped, to_unit
from stepwell.lab.recordings.recording import Recording, run_number, spikes, stem_of

LATE = 0.02e-3  # largest stroke at the first sample [m]
SETTLE = 0.5e-3  # [m] of stroke in which a rig takes up its slack
END = 0.1e-3  # [m] before the end of a stroke, where blocks may touch
SHORT = 0.99  # least stroke over that of other repeats
TIME_GAP = 3.0  # time steps
FEWEST = 30  # rows
BACK = 0.01  # fraction of the time steps that may be negative
LEAP = 0.15  # fraction of the stroke in one step


def recording_warnings(recording: Recording) -> tuple[str, ...]:
    """Warnings about one recording, a line each."""
    checks = (_start, _clock, _spikes, _ends)
    return (*recording.remarks, *chain.from_iterable(look(recording) for look in checks))


def unusable(recording: Recording) -> str:
    """Reason why a recording is no run of a test; "" if it may be one."""
    if len(recording) < FEWEST:
        return f"it has {len(recording)} rows, too few for a motion"
    steps, moved = np.diff(recording.time), np.abs(np.diff(recording.stroke))
    reach = float(np.ptp(recording.stroke))
    if reach == 0.0:
        return "its stroke is constant"
    if np.all(np.isfinite(steps)) and float(np.mean(steps < 0)) > BACK:
        return "its time decreases: its rows are not in the order of the measurement"
    # If rows are missing, the time jumps too, and the rest is a run with a gap.
    usual = float(np.median(steps)) if np.all(np.isfinite(steps)) else 0.0
    at_once = moved[steps < TIME_GAP * usual] if usual > 0 else moved
    farthest = float(np.max(at_once, initial=0.0))
    if len(recording) >= 100 and farthest > LEAP * reach:
        return (
            f"its stroke jumps by {to_unit(farthest, 'mm'):.4g} mm between two rows: two runs in "
            f"one file, or rows that are missing or not in order"
        )
    return ""


def batch_warnings(recordings: Iterable[Recording]) -> dict[str, tuple[str, ...]]:
    """Warnings about recordings compared with others of the same folder and name, by source.

    Run numbers are the digits at the end of a name. A missing number is reported for the recording
    after the gap. Sources without a warning are left out.
    """
    compared = ((*unlike(family), *_jumps(family)) for family in _families(recordings))
    warnings = grouped((*missing(recordings).items(), *chain.from_iterable(compared)))
    return {source: tuple(lines) for source, lines in warnings.items()}


def missing(recordings: Iterable[Recording]) -> dict[str, str]:
    """Gaps in the run numbers of each folder and name, by the source after the gap."""
    warnings: dict[str, str] = {}
    for family in _families(recordings):
        if len(family) == 1:
            continue  # the 2 of a single scale2.csv is no run number
        expected = 1
        for number, recording in _numbered(family):
            if number > expected:
                numbers = f"{expected}" if number == expected + 1 else f"{expected} to {number - 1}"
                warnings[recording.source] = f"number {numbers} is missing before it"
            expected = number + 1
    return warnings


def unlike(repeats: Sequence[Recording]) -> Iterator[tuple[str, str]]:
    """Warnings about repeats, three or more, that differ in stroke, speed or force."""
    if len(repeats) < 3:
        return
    spans = np.array([float(np.ptp(r.stroke)) for r in repeats])
    speeds = np.array([r.speed for r in repeats])
    means = np.array([float(np.mean(r.force)) for r in repeats])
    off = means - np.median(means)
    spread = 1.4826 * float(np.median(np.abs(off)))
    usual_span, usual_speed = float(np.median(spans)), float(np.median(speeds))
    for recording, span, speed, force in zip(repeats, spans, speeds, off, strict=True):
        source, others = recording.source, "where the others have"
        if span < SHORT * usual_span:
            own, usual = (f"{to_unit(one, 'mm'):.4g} mm" for one in (span, usual_span))
            yield source, f"stroke of {own} {others} {usual}"
        if abs(speed - usual_speed) > 0.05 * usual_speed:
            own, usual = (f"{to_unit(one, 'mm/s'):.3g} mm/s" for one in (speed, usual_speed))
            yield source, f"{own} {others} {usual}"
        if abs(force) > max(4 * spread, 0.05 * float(np.ptp(recording.force))):
            yield source, f"mean force {force:+.2g} N from that of the median run"


def _families(recordings: Iterable[Recording]) -> list[list[Recording]]:
    return list(grouped(((r.group, stem_of(r.name)), r) for r in recordings).values())


def _numbered(family: list[Recording]) -> list[tuple[int, Recording]]:
    numbered = [(n, r) for r in family if (n := run_number(r.name)) is not None]
    return sorted(numbered, key=lambda pair: pair[0])


def _start(recording: Recording) -> Iterator[str]:
    first = float(recording.stroke[0])
    if abs(first) > LATE:
        yield f"starts late, at a stroke of {to_unit(first, 'mm'):.4g} mm"
    if np.ptp(recording.stroke) == 0:
        yield "the stroke is constant"


def _clock(recording: Recording) -> Iterator[str]:
    steps = np.diff(recording.time)
    if not np.all(np.isfinite(steps)):
        return
    back = int(np.sum(steps <= 0))
    if back:
        yield f"time is constant or decreases at {back} samples"
    elif (widest := float(np.max(steps)) * recording.rate) > TIME_GAP:
        yield f"a gap of {widest:.0f} time steps"


def _spikes(recording: Recording) -> Iterator[str]:
    at = np.flatnonzero(spikes(recording.force))
    if len(at):
        first = f"{to_unit(recording.stroke[at[0]], 'mm'):.4g} mm"
        several = f"{len(at)} samples, from {first}, are"
        samples = f"1 sample, at {first}, is" if len(at) == 1 else several
        yield f"{samples} far from their neighbours: spikes, which are ignored"


def _ends(recording: Recording) -> Iterator[str]:
    """Warnings about a force that settles at the start, or deviates at the end."""
    u, force = recording.stroke, recording.force
    moved, left = np.abs(u - u[0]), np.abs(u - u[-1])
    if recording.turns:
        return
    settled = (moved > SETTLE) & (moved < 2 * SETTLE)
    if np.sum(settled) >= 10 and np.ptp(moved) >= 10 * SETTLE:
        level = float(np.median(force[settled]))
        if abs(force[0] - level) > 0.15 * float(np.ptp(force)):
            settles = f"{to_unit(SETTLE, 'mm'):g} mm"
            yield f"the force settles over about {settles}: slack in the rig, or a jam"
    last, before = left < END, (left >= END) & (left < 6 * END)
    if len(recording) >= 100 and np.sum(last) >= 4 and np.sum(before) >= 10:
        course = np.polyfit(u[before], force[before], 1)
        noise = float(np.std(force[before] - np.polyval(course, u[before])))
        off = float(force[-1] - np.polyval(course, u[-1]))
        if abs(off) > max(8 * noise, 0.05 * float(np.ptp(force))):
            end = f"{to_unit(END, 'mm'):g} mm: end stop?"
            yield f"the force deviates by {off:+.2g} N in the last {end}"


def _jumps(family: list[Recording]) -> Iterator[tuple[str, str]]:
    """Warnings about cycles with a higher peak than the one before: probably another sample."""
    cycles = [recording for _, recording in _numbered(family) if recording.turns]
    for before, recording in pairwise(cycles):
        peak, last = float(np.max(recording.force)), float(np.max(before.force))
        if peak > 1.1 * last > 0:
            times = f"{peak / last:.2f} times that of the number before"
            yield recording.source, f"peak force {times}: another sample?"
