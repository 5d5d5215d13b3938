"""Bands measured at home: what a person reads off a scale and a ruler, with known truth."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stepwell import lab

Array = NDArray[np.float64]

GRAVITY = 9.80665


def rubber(stiffness: float) -> Callable[[Array], Array]:
    """Tension [N] over extension [m], softening first and stiffening then, as rubber does."""
    return lambda e: stiffness * (2.0 * e - 67.0 * e**2 + 1250.0 * e**3)


def spring(stiffness: float) -> Callable[[Array], Array]:
    """Tension [N] over extension [m] of a straight line."""
    return lambda e: stiffness * e


def table(rest: float, tension: Callable[[Array], Array], extension: Array) -> str:
    """Lengths to half a millimetre and weights to a gram, as a person writes them down."""
    length = np.round((rest + extension) * 2e3) / 2
    weight = np.round(tension(extension) / GRAVITY * 1e3)
    rows = zip(length, weight, strict=True)
    return "length (mm),weight (g)\n" + "".join(f"{a:g},{b:g}\n" for a, b in rows)


def extensions(rng: np.random.Generator, readings: int = 7, reach: float = 0.040) -> Array:
    """Where a person reads, from the limp band on [m]."""
    steps = np.linspace(0.0, reach, readings)
    return steps + (np.arange(readings) > 0) * rng.uniform(-0.002, 0.002, readings)


def pulled(text: str, name: str = "pull.csv") -> lab.Recording:
    """The recording in a table."""
    return lab.read_bytes(text.encode(), name)
