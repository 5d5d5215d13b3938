"""The rig of a test, and predictions of the model at its strokes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import Bools, ByValue, Floats, InputError, Ints, to_unit
from stepwell.mechanism import Cell, Chain
from stepwell.statics import Path


def path_of(chain: Chain, unloading: bool) -> Path:
    """Path of a chain over its full stroke in one direction."""
    full = chain.full_stroke
    if unloading:
        return chain.path([full, 0.0], start=chain.last_state)
    return chain.path([0.0, full])


def predicted_force(
    chain: Chain, unloading: bool, stroke: Floats, path: Path | None = None
) -> Floats:
    """Actuator force [N] of the model at strokes [m] in one direction; `path` if known."""
    stroke = np.clip(stroke, 0.0, chain.full_stroke)
    if len(chain) == 1 and not chain.elements:
        cell = chain.levers[0]
        return cell.force(cell.angle(stroke))
    return on_path(path or path_of(chain, unloading), stroke)


def on_path(path: Path, stroke: Floats, shown: Floats | None = None) -> Floats:
    """Actuator force [N] of a one-way path at strokes (n,) [m], its own or those `shown`."""
    return np.interp(stroke, _rising(path, shown), _forward(path, path.force))


def mover(path: Path, stroke: Floats, shown: Floats | None = None) -> tuple[Ints, Floats]:
    """Index of the moving cell at strokes (n,) [m] of a one-way path; travels (n, cells) [m]."""
    u = _rising(path, shown)
    at = np.stack([np.interp(stroke, u, one) for one in _forward(path, path.travel).T], axis=1)
    return np.argmax(np.abs(np.gradient(at, axis=0)), axis=1), at


def _rising(path: Path, shown: Floats | None) -> Floats:
    """Strokes of a path in rising order; constant where a rig springs back at a jump."""
    return np.maximum.accumulate(_forward(path, path.stroke if shown is None else shown))


def _forward(path: Path, values: Floats) -> Floats:
    return values if path.stroke[-1] >= path.stroke[0] else values[::-1]


@dataclass(frozen=True, eq=False)
class Rig(ByValue):
    """Test rig between the machine and the outermost block, with its deviations from the ideal.

    The levers move the block sideways by r (cos θ - cos θc). The bar, upright at both stops, tilts.
    By virtual work the machine's force is F / (1 + b tan θ) for a force F on the block, where b is
    the tangent of the tilt.

    Attributes:
        bar: length of the bar [m]; infinite for a machine that moves with the block.
        stretch: stroke of the machine over the nominal stroke of the mechanism [1].
        start_loading, start_unloading: machine stroke before the mechanism moves [m].
        compliance: of the rig [m/N].
        friction: of the machine, against the motion [N].

    Raises:
        ValueError: a bar or a stretch is not above zero, a number is not finite, or a compliance or
            friction is below zero.

    Source: theory page, "The tilting bar"; the paper's rig has a bar of 70 mm.
    """

    bar: float = math.inf
    stretch: float = 1.0
    start_loading: float = 0.0
    start_unloading: float = 0.0
    compliance: float = 0.0
    friction: float = 0.0

    def __post_init__(self):
        if not self.bar > 0:
            raise InputError(f"bar = {self.bar} m: must be > 0, or math.inf for no bar.")
        if not 0 < self.stretch < math.inf:
            raise InputError(f"stretch = {self.stretch}: must be > 0 and finite; 1 is nominal.")
        for name, unit in (("start_loading", "m"), ("start_unloading", "m")):
            if not math.isfinite(value := getattr(self, name)):
                raise InputError(f"{name} = {value} {unit}: must be finite.")
        for name, unit in (("compliance", "m/N"), ("friction", "N")):
            if not 0 <= (value := getattr(self, name)) < math.inf:
                raise InputError(f"{name} = {value} {unit}: must be >= 0 and finite.")

    def at_machine(
        self, stroke: ArrayLike, force: ArrayLike, full: float, unloading: bool
    ) -> Floats:
        """Machine stroke [m] for a stroke of the mechanism [m] and its force there [N].

        Strokes and forces have one shape. `full` is the stroke with every cell at state 1 [m], the
        start of `unloading`.
        """
        stroke, way = np.asarray(stroke, float), -1.0 if unloading else 1.0
        ahead = (full - stroke if unloading else stroke) * (self.stretch - 1.0)
        ahead += self.start_unloading if unloading else self.start_loading
        ahead += self.compliance * (way * np.asarray(force, float) + self.friction)
        return stroke + way * ahead

    def tilt(self, cell: Cell, theta: ArrayLike) -> Floats:
        """b = tan φ [1] of the bar at lever angles θ [rad] of any shape."""
        theta = np.asarray(theta, float)
        sine = cell.lever * (np.cos(theta) - math.cos(cell.limit)) / self.bar
        return sine / np.sqrt(1.0 - sine**2)

    def factor(self, cell: Cell, theta: ArrayLike) -> Floats:
        """Force at the machine over force at the block [1] at angles θ [rad] of any shape."""
        return 1.0 / (1.0 + self.tilt(cell, theta) * np.tan(theta))

    def stroke(self, cell: Cell, theta: ArrayLike) -> Floats:
        """Machine stroke [m] from state 0 on, at angles θ [rad] of any shape."""
        if math.isinf(self.bar):
            return cell.travel(theta)
        # φ = 0 at the stops, so between them the height of the bar is less by L (1 - cos φ).
        return cell.travel(theta) - self.bar * (1.0 - np.cos(np.arctan(self.tilt(cell, theta))))

    def angle(self, cell: Cell, stroke: ArrayLike) -> Floats:
        """Lever angle θ [rad] at machine strokes [m] of any shape, between the stops."""
        travel = np.clip(np.asarray(stroke, float), 0.0, cell.full_travel)
        if math.isfinite(self.bar):
            theta = np.linspace(-cell.limit, cell.limit, 2001)
            travel = np.interp(travel, self.stroke(cell, theta), cell.travel(theta))
        return cell.angle(np.clip(travel, 0.0, cell.full_travel))


PAPER_RIG = Rig(bar=0.070)

# Measured on the paper's rig and reported with the results: slack ends within 0.5 mm, blocks touch
# in the last 0.25 mm, and the next cell takes over within 2 mm.
SETTLE = 0.5e-3
END = 0.25e-3
BEFORE, AFTER = 0.5e-3, 2.0e-3
NOT_JUDGED = (
    f"Not judged: the first {to_unit(SETTLE, 'mm'):g} mm of stroke, the last "
    f"{to_unit(END, 'mm'):g} mm, and in pairs from {to_unit(BEFORE, 'mm'):g} mm before to "
    f"{to_unit(AFTER, 'mm'):g} mm after the next cell takes over. Which cell moves first in a "
    "baseline of two cells is not recorded: the one that fits all series better is used."
)


def quiet_zones(
    full: float, unloading: bool, first: float | None = None
) -> list[tuple[float, float]]:
    """Ranges of stroke that are not judged because the force is that of the rig [m].

    `first` is the full travel of the cell of a pair that moves first [m].
    """
    zones = [(-math.inf, SETTLE), (full - END, math.inf)]
    if first is not None:
        zones.append((first - BEFORE, first + AFTER))
    return [(full - high, full - low) for low, high in zones] if unloading else zones


def judged(stroke: Floats, zones: Sequence[tuple[float, float]]) -> Bools:
    """Mask of the strokes (n,) [m] outside all quiet zones."""
    return ~np.any([(low <= stroke) & (stroke <= high) for low, high in zones], axis=0)
