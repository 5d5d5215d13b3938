"""What the model predicts on the strokes of a measurement."""

from __future__ import annotations

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.mechanism import Chain
from stepwell.statics import Path


def path_of(chain: Chain, unloading: bool) -> Path:
    """The full stroke of a chain one way, without friction unless its cells have it."""
    full = chain.full_stroke
    if unloading:
        return chain.path([full, 0.0], start=chain.last_state)
    return chain.path([0.0, full])


def predicted_force(chain: Chain, unloading: bool, stroke: Floats) -> Floats:
    """Actuator force [N] of the model at strokes [m], going one way."""
    stroke = np.clip(stroke, 0.0, chain.full_stroke)
    if len(chain) == 1:
        cell = chain.levers[0]
        return cell.force(cell.angle(stroke))
    return on_path(path_of(chain, unloading), stroke)


def on_path(path: Path, stroke: Floats, shown: Floats | None = None) -> Floats:
    """Actuator force [N] along a one-way path at strokes [m].

    Args:
        path: one way.
        stroke: (n,) where.
        shown: of every point of the path the stroke that counts; by default its own.
    """
    u, force = _rising(path, shown), _forward(path, path.force)
    return np.interp(stroke, u, force)


def mover(path: Path, stroke: Floats, shown: Floats | None = None) -> tuple[Ints, Floats]:
    """Which cell moves at these strokes [m], and the travels (n, cells) of all [m].

    Args:
        path: one way.
        stroke: (n,) where.
        shown: of every point of the path the stroke that counts; by default its own.
    """
    u = _rising(path, shown)
    travel = _forward(path, path.travel)
    at = np.stack([np.interp(stroke, u, travel[:, i]) for i in range(travel.shape[1])], axis=1)
    step = np.abs(np.gradient(at, axis=0))
    return np.argmax(step, axis=1), at


def _rising(path: Path, shown: Floats | None) -> Floats:
    """Strokes of a path in rising order; where a rig springs back at a jump they stand still."""
    return np.maximum.accumulate(_forward(path, path.stroke if shown is None else shown))


def _forward(path: Path, values: Floats) -> Floats:
    return values if path.stroke[-1] >= path.stroke[0] else values[::-1]
