"""A path in time: the actuator at constant speed, rests at its turns, snaps slowed down."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.figures.common import snaps_of
from stepwell.figures.motion.plan.strokes import plan_of

if TYPE_CHECKING:
    from stepwell.statics import Path

# A snap takes milliseconds; shown, it has to last long enough to be seen.
_SNAP_SECONDS = 0.5
_REST_SECONDS = 0.3


class Instant(NamedTuple):
    """What a path is doing in one frame.

    Attributes:
        travels: (N,) of every cell [m].
        sheets: (N,) of the elements' curves.
        force: of the actuator [N].
        snap: whether it is in the middle of a snap.
        drive: what the actuator prescribes, in the units of its plan.
        way: that the actuator has covered, in the same.
    """

    travels: Floats
    sheets: tuple[int, ...]
    force: float
    snap: bool
    drive: float
    way: float


def instants(path: Path, seconds: float, count: int) -> list[Instant]:
    """What to show in each of `count` frames, so that snaps last long enough to be seen.

    Args:
        path: any.
        seconds: how long all frames last.
        count: of frames.
    """
    snaps = snaps_of(path)
    plan = plan_of(path)
    moving = np.diff(plan.way)
    turns = np.flatnonzero(np.diff(np.sign(path.direction)))
    # Snaps and rests never take more than half of the time.
    pauses = _SNAP_SECONDS * len(snaps) + _REST_SECONDS * (len(turns) + 1)
    shrink = min(1.0, 0.5 * seconds / pauses)
    step = moving / max(float(moving.sum()), 1e-300) * (seconds - shrink * pauses)
    jumps = {snap.before for snap in snaps}
    for snap in snaps:
        step[snap.before] += shrink * _SNAP_SECONDS
    step[turns] += shrink * _REST_SECONDS
    time = np.concatenate([[0.0], np.cumsum(step)])

    frames: list[Instant] = []
    for at in np.linspace(0.0, seconds, count, endpoint=False):
        i = min(int(np.searchsorted(time, at, side="right")) - 1, len(time) - 1)
        j = min(i + 1, len(time) - 1)
        part = (at - time[i]) / (time[j] - time[i]) if time[j] > time[i] else 0.0
        snap = i in jumps
        if snap:
            part = part * part * (3.0 - 2.0 * part)
        travels, force, u, w = (
            column[i] + part * (column[j] - column[i])
            for column in (path.travel, path.force, plan.drive, plan.way)
        )
        sheets = tuple(path.sheet[j if part > 0.5 else i].tolist())
        frames.append(Instant(travels, sheets, float(force), snap, float(u), float(w)))
    return frames
