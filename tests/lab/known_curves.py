"""Made-up recordings with known phases: how many come back right, and how many noise invents.

With src and tests on the path, `python tests/lab/known_curves.py [COUNT] [SEED]` prints the counts
for COUNT curves of each kind.
"""

import sys
from typing import NamedTuple

import numpy as np

from stepwell.base import InputError
from stepwell.mechanism import Fit, fitted

TRAVEL = 0.020
# Noise to this fraction of the smallest drop.
MOST_NOISE = 0.05


class Known(NamedTuple):
    """A curve without noise: travel [m], force [N], its turns [m], its smallest drop [N]."""

    travel: np.ndarray
    force: np.ndarray
    turns: np.ndarray
    drop: float


class Counts(NamedTuple):
    """Of a study: curves with the right phases, turns within 2 % of the travel, inside the band."""

    right: int
    placed: int
    inside: int


def rows(rng) -> int:
    return int(np.exp(rng.uniform(np.log(300), np.log(20_000))))


def snapping(rng, size: int) -> Known:
    """Two or three phases, with straight or curved stretches between turns."""
    from scipy.interpolate import PchipInterpolator

    falls = rng.integers(1, 3)
    widths = rng.uniform(1.0, 2.5, 2 * falls + 1)
    places = np.append(0.0, np.cumsum(widths)) / np.sum(widths)
    steps = rng.uniform(0.6, 1.6, 2 * falls + 1) * (-1.0) ** np.arange(2 * falls + 1)
    forces = np.append(0.0, np.cumsum(steps))
    x = np.linspace(0.0, 1.0, size)
    curved = rng.random() < 0.7
    y = PchipInterpolator(places, forces)(x) if curved else np.interp(x, places, forces)
    return Known(x * TRAVEL, y, places[1:-1] * TRAVEL, float(np.min(np.abs(steps[1:-1]))))


def monotone(rng, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Travel [m] and rising force [N]: a line, bent, saturated, with plateaus, or a step."""
    x = np.linspace(0.0, 1.0, size)
    flat = np.minimum(x, 0.4) + 3.0 * np.maximum(x - 0.7, 0.0)
    shapes = (x, x**2, 1.0 - np.exp(-4.0 * x), flat, 0.5 * (1.0 + np.tanh(8.0 * x - 4.0)))
    return x * TRAVEL, shapes[rng.integers(len(shapes))]


def correlated(rng, size: int, factor: float) -> np.ndarray:
    """Noise of unit size of which each value is `factor` of the one before, and a rest."""
    from scipy.signal import lfilter

    white = rng.standard_normal(size + 1000) * np.sqrt(1.0 - factor**2)
    return np.asarray(lfilter([1.0], [1.0, -factor], white))[1000:]


def read(travel: np.ndarray, force: np.ndarray) -> Fit | None:
    """What is read; None where it is refused."""
    try:
        return fitted(travel, force, trim=False)
    except InputError:
        return None


def of_snaps(count: int, seed: int) -> Counts:
    """How many snapping curves with white noise come back."""
    rng = np.random.default_rng(seed)
    right = placed = inside = 0
    for _ in range(count):
        known = snapping(rng, rows(rng))
        noise = rng.uniform(0.001, MOST_NOISE) * known.drop
        fit = read(known.travel, known.force + noise * rng.standard_normal(len(known.travel)))
        if fit is None or not fit.rises or len(fit.turns) != len(known.turns):
            continue
        right += 1
        placed += bool(np.all(np.abs(fit.travel[list(fit.turns)] - known.turns) < 0.02 * TRAVEL))
        off = np.abs(np.interp(known.travel, fit.travel, fit.force) - known.force)
        inside += bool(np.max(off) <= fit.band)
    return Counts(right, placed, inside)


def invented(count: int, seed: int, factor: float = 0.0) -> tuple[int, int]:
    """Monotone curves that got a phase from noise, and those that were refused."""
    rng = np.random.default_rng(seed)
    phases = refused = 0
    for _ in range(count):
        travel, force = monotone(rng, rows(rng))
        size = np.exp(rng.uniform(np.log(0.002), np.log(0.1 if factor else 0.3)))
        fit = read(travel, force + size * correlated(rng, len(travel), factor))
        refused += fit is None
        phases += fit is not None and len(fit.turns) > 0
    return phases, refused


def _main(count: int = 200, seed: int = 0) -> None:
    counts = of_snaps(count, seed)
    print(f"snaps in white noise to {MOST_NOISE:.0%} of the drop: {counts} of {count}")
    for factor in (0.0, 0.5, 0.9, 0.98, 0.995):
        phases, refused = invented(count, seed + 1, factor)
        kind = f"correlated by {factor}" if factor else "white"
        print(f"monotone, {kind}: {phases} of {count} got a phase, {refused} were refused")


if __name__ == "__main__":
    _main(*map(int, sys.argv[1:]))
