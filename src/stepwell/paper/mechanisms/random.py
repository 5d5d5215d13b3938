"""Random cells whose force is proved to fall, the same ones every time."""

import numpy as np

from stepwell.concave import certify, simple
from stepwell.mechanism import Band, Cell, Chain


def chains(count: int, shortest: int, longest: int, seed: int) -> tuple[Chain, ...]:
    """Chains of concave cells, anchors anywhere on the paper's map and 15 to 60 N/m.

    Args:
        count: how many.
        shortest, longest: fewest and most cells, both included.
        seed: of the random numbers.
    """
    rng = np.random.default_rng(seed)
    lengths = rng.integers(shortest, longest + 1, count)
    return tuple(Chain(tuple(_cell(rng) for _ in range(length))) for length in lengths)


def _cell(rng: np.random.Generator) -> Cell:
    while True:
        q = (rng.uniform(0.0, 0.020), rng.uniform(-0.015, 0.015))
        cell = Cell(Band((-0.010, 0.0), q, stiffness=rng.uniform(15.0, 60.0)))
        plain = simple(cell)
        if plain is not None and certify(plain, 0.0):
            return cell
