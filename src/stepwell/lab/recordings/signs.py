"""Signs of stroke and force: which are counted negative, decided by the work."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, InputError
from stepwell.lab.recordings.reading import FLIPS
from stepwell.lab.recordings.recording import halves_of, turns_of

# Fractions of the largest force and of the recorded strokes, below which both count as zero.
_REST, _NEAR = 0.05, 0.1
# Work over that of a force of one sign: taken up, given off, and of a specimen that only springs.
_TAKEN, _GIVEN, _SPRINGS = -0.05, -0.5, 0.9
_ENOUGH = 10  # samples
_OPEN = {
    "both": "if loading is counted negative, give --flip both",
    "stroke": "if the stroke is counted negative, give --flip stroke",
    "force": "if the force is counted negative, give --flip force",
}
_FAR = 3.0  # distance from zero, over the range of the strokes, of an absolute position


class Signs(NamedTuple):
    """Factors of stroke and force (1 or -1), and the reason; no reason if undecided.

    `other` is the value of `flip` that may be right too, with the reason for the one used.
    """

    stroke: int
    force: int
    why: str = ""
    other: str = ""

    @property
    def reason(self) -> str:
        """The reason, and the option for the signs that may be right too."""
        return f"{self.why}; {_OPEN[self.other]}" if self.other else self.why


class UnclearSigns(InputError):
    """Signs that the work does not decide; `flips` are the values of `flip` that may be right."""

    def __init__(self, problem: str, flips: tuple[str, ...] = FLIPS):
        self.flips = flips
        super().__init__(problem)


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
    turns = turns_of(stroke)
    zero = abs(float(stroke[0])) <= _NEAR * float(np.ptp(stroke))
    # The first half that covers at least half of the recorded strokes.
    halves = halves_of(stroke, turns)
    half = next((h for h in halves if 2 * np.ptp(stroke[h]) >= np.ptp(stroke)), halves[0])
    begin = _Beginning(
        bool(stroke[half][-1] < stroke[half][0]) and (zero or is_far(stroke)),
        abs(float(np.median(force[:3]))) <= _REST * float(np.max(np.abs(force))),
        _share(stroke[half], force[half]),
    )
    return (_of_cycles if turns else _of_one_half)(stroke, force, begin)


class _Beginning(NamedTuple):
    """The first half: whether it loads to falling strokes, starts at no force; its work."""

    falls: bool
    at_rest: bool
    work: float

    @property
    def loading(self) -> int:
        """Factor of the stroke for which the half loads."""
        return -1 if self.falls else 1


def _of_one_half(stroke: Floats, force: Floats, begin: _Beginning) -> Signs:
    if begin.falls and not is_far(stroke):  # as an unloading test that is set to zero before
        gives = begin.at_rest and begin.work <= -_SPRINGS
        why = "as recorded: a stroke that falls is unloading"
        return Signs(1, 1, why, "stroke" if gives else "both")
    if not (begin.at_rest and abs(begin.work) >= _SPRINGS and _springs(stroke, force)):
        return _as_recorded(begin.work)
    return _signs(begin.loading, begin.loading if begin.work > 0 else -begin.loading)


def _of_cycles(stroke: Floats, force: Floats, begin: _Beginning) -> Signs:
    closed = abs(float(stroke[-1] - stroke[0])) <= _NEAR * float(np.ptp(stroke))
    loop = _share(stroke, force) if closed else 0.0
    gives = begin.at_rest and begin.work < _TAKEN
    if gives and begin.work > _GIVEN and abs(loop) < -_TAKEN:
        return Signs(1, 1)
    if (gives and begin.work <= _GIVEN) or loop < (_TAKEN if gives else 2 * _TAKEN):
        return _signs(begin.loading, -begin.loading)
    if loop < -_TAKEN and not begin.falls:
        return _as_recorded(begin.work)
    return _signs(begin.loading, begin.loading)


def _as_recorded(work: float) -> Signs:
    """The signs of the file, which the work leaves open."""
    if work > -_SPRINGS:
        return Signs(1, 1, "as recorded")
    return Signs(1, 1, "as recorded: the specimen gives off work at first", "force")


def pulled(stroke: Floats, force: Floats, near: float) -> Signs:
    """Signs of a specimen that only pulls: both turned if its strokes and forces are negative.

    Strokes of at most `near` above zero may be of its slack; no reason if nothing is turned.
    """
    low, high = float(np.min(stroke)), float(np.max(stroke))
    if -low <= high or high > near or np.mean(force[stroke < 0.5 * low]) >= 0:
        return Signs(1, 1)
    return Signs(-1, -1, "stroke and tension are counted negative: both signs are changed")


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
