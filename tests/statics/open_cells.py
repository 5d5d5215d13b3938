"""Random cells of which some have open ends, and what happens on a path."""

import numpy as np

import stepwell as sw


def any_open(rng: np.random.Generator) -> sw.Element | sw.Cell:
    """A curve of straight lines with open or stopped ends, some of it below 0; or a lever cell."""
    if rng.random() < 0.3:
        q = tuple(rng.uniform([-0.002, -0.015], [0.020, 0.015]))
        return sw.Cell(sw.Band((-0.010, 0.0), q))
    n = int(rng.integers(4, 8))
    travel = np.append(0.0, np.cumsum(rng.uniform(0.5e-3, 4e-3, n - 1)))
    rises = rng.random(n - 1) < 0.4
    rises[[0, -1]] = True
    steps = np.where(rises, 1.0, -1.0) * rng.uniform(0.2, 1.5, n - 1)
    force = rng.uniform(-0.5, 0.5) + np.append(0.0, np.cumsum(steps))
    stops = bool(rng.integers(2)), bool(rng.integers(2))
    return sw.Element.from_points(tuple(travel), tuple(force), stops=stops)


def happened(path: sw.Path) -> list[tuple[object, ...]]:
    return [(e.kind, e.direction, e.cells, e.arrivals) for e in path.events]
