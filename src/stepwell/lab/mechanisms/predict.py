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


def on_path(path: Path, stroke: Floats) -> Floats:
    """Actuator force [N] along a one-way path at strokes [m]."""
    u, force = _forward(path, path.stroke), _forward(path, path.force)
    return np.interp(stroke, u, force)


def mover(path: Path, stroke: Floats) -> tuple[Ints, Floats]:
    """Which cell moves at these strokes [m], and the travels (n, cells) of all [m]."""
    u = _forward(path, path.stroke)
    travel = _forward(path, path.travel)
    at = np.stack([np.interp(stroke, u, travel[:, i]) for i in range(travel.shape[1])], axis=1)
    step = np.abs(np.gradient(at, axis=0))
    return np.argmax(step, axis=1), at


def _forward(path: Path, values: Floats) -> Floats:
    return values if path.stroke[-1] >= path.stroke[0] else values[::-1]
