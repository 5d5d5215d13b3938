"""Signs of stroke and force: which are counted negative, decided by the work."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.lab.recordings.recording import turns_of

# Fractions of the largest force and of the recorded strokes, below which both count as zero.
_REST, _NEAR = 0.05, 0.1
# Work over that of a force of one sign: taken up, given off, and of a specimen that only springs.
_TAKEN, _GIVEN, _SPRINGS = -0.05, -0.5, 0.9
_ENOUGH = 10  # samples
_BOTH = "if loading is counted negative, give --flip both"
_FORCE = "if the force is counted negative, give --flip force"
_FAR = 3.0  # distance from zero, over the range of the strokes, of an absolute position


class Signs(NamedTuple):
    """Factors of stroke and force (1 or -1), and the reason; no reason if undecided."""

    stroke: int
    force: int
    why: str = ""


def turned(flip: str) -> Signs:
    """The signs of a reading: none, stroke, force or both turned."""
    stroke, force = (-1 if flip in ("both", one) else 1 for one in ("stroke", "force"))
    return Signs(stroke, force, f"as requested by flip = {flip}")


def decided(stroke: Floats, force: Floats) -> Signs:
    """Signs for which a recording begins with loading and its specimen takes up work.

    A recording of loading and unloading must begin at the zero of its machine, or far from it; its
    force is turned if it would give off work otherwise. A recording of one half keeps its signs,
    unless the force grows from zero to the end as that of a spring: other ones may unload.
    """
    if len(stroke) < _ENOUGH or not np.ptp(stroke) or not np.any(force):
        return Signs(1, 1, "as recorded")
    range_ = float(np.ptp(stroke))
    zero = abs(float(stroke[0])) <= _NEAR * range_
    outside = is_far(stroke)
    turns = turns_of(stroke)
    half = _first_half(stroke, turns)
    falls = bool(stroke[half][-1] < stroke[half][0]) and (zero or outside)
    at_rest = abs(float(np.median(force[:3]))) <= _REST * float(np.max(np.abs(force)))
    work = _share(stroke[half], force[half])
    if not turns:
        if falls and not outside:  # as an unloading test that is set to zero before
            return Signs(1, 1, f"as recorded: a stroke that falls is unloading; {_BOTH}")
        if not (at_rest and abs(work) >= _SPRINGS and _springs(stroke, force)):
            return _as_recorded(work)
        x = -1 if falls else 1
        return _signs(x, x if work > 0 else -x)
    closed = abs(float(stroke[-1] - stroke[0])) <= _NEAR * range_
    loop = _share(stroke, force) if closed else 0.0
    x = -1 if falls else 1
    if at_rest and work <= _GIVEN:
        return _signs(x, -x)
    if at_rest and work < _TAKEN and abs(loop) < -_TAKEN:
        return Signs(1, 1)
    if loop < (_TAKEN if at_rest and work < _TAKEN else 2 * _TAKEN):
        return _signs(x, -x)
    return _as_recorded(work) if x == 1 and loop < -_TAKEN else _signs(x, x)


def _first_half(stroke: Floats, turns: Sequence[int]) -> slice:
    """The first half that covers at least half of the recorded strokes."""
    ends = [0, *turns, len(stroke) - 1]
    halves = [slice(a, b + 1) for a, b in pairwise(ends)]
    most = float(np.ptp(stroke))
    return next((h for h in halves if 2 * np.ptp(stroke[h]) >= most), halves[0])


def _as_recorded(work: float) -> Signs:
    """The signs of the file, which the work leaves open."""
    gives = f": the specimen gives off work at first; {_FORCE}" if work <= -_SPRINGS else ""
    return Signs(1, 1, f"as recorded{gives}")


def is_far(stroke: Floats) -> bool:
    """Whether the zero is at least three ranges away from all strokes: an absolute position."""
    low, high = float(np.min(stroke)), float(np.max(stroke))
    return low * high > 0 and min(abs(low), abs(high)) > _FAR * (high - low) > 0


def _signs(stroke: int, force: int) -> Signs:
    if (stroke, force) == (1, 1):
        return Signs(1, 1, "as recorded")
    names = {(-1, -1): "stroke and force", (-1, 1): "stroke", (1, -1): "force"}
    why = "counted negative in the file, so that loading takes up work"
    return Signs(stroke, force, f"{names[stroke, force]} turned: {why}")


def _share(stroke: Floats, force: Floats) -> float:
    """Work over the work of a force of one sign."""
    steps, mean = np.diff(stroke), (force[1:] + force[:-1]) / 2
    total = float(np.sum(np.abs(mean * steps)))
    return float(np.sum(mean * steps)) / total if total else 0.0


def _springs(stroke: Floats, force: Floats) -> bool:
    """Whether the force grows from zero and is largest at the end."""
    size, way = np.abs(force), np.abs(stroke - stroke[0])
    early = size[int(np.argmax(way >= 0.1 * way[-1]))]
    most = float(np.max(size))
    return bool(np.median(size[-3:]) >= 0.8 * most and early <= 0.35 * most)
