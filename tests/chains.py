"""Random cells and chains for the tests, concave ones and every other kind; wrong events."""

import math
from dataclasses import replace

import numpy as np

import stepwell as sw

LEVER = 0.010 * math.sqrt(2.0)
LIMIT = math.pi / 4


def concave_cell(rng: np.random.Generator) -> sw.Cell:
    """One taut linear band whose force falls all the way, in the neighbourhood of the paper's."""
    while True:
        band = sw.Band(
            (-0.010, 0.0),
            (rng.uniform(-0.003, 0.022), rng.uniform(-0.015, 0.015)),
            stiffness=rng.uniform(15, 60),
            rest_length=rng.uniform(0.002, 0.010),
        )
        cell = sw.Cell(band)
        force = cell.force(np.linspace(-LIMIT, LIMIT, 400))
        taut = band.length(np.linspace(-LIMIT, LIMIT, 400), LEVER).min() > band.rest_length
        if taut and np.all(np.diff(force) < 0):
            return cell


def any_law(rng: np.random.Generator) -> sw.Linear | sw.Cubic:
    """Hooke's law, or rubber that softens and stiffens."""
    if rng.random() < 0.6:
        return sw.Linear()
    return sw.Cubic(rng.uniform(-30, 10), rng.uniform(300, 3000))


def any_cell(rng: np.random.Generator, friction: bool = True) -> sw.Cell:
    """Any kind of cell: slack, folded back, several bands, loads, friction, other levers."""
    lever = rng.choice([LEVER, rng.uniform(0.008, 0.02)])
    limit = rng.choice([LIMIT, rng.uniform(0.3, 1.2)])
    for _ in range(1000):
        bands = tuple(
            sw.Band(
                (0.0, 0.0),
                (rng.uniform(-0.02, 0.03), rng.uniform(-0.02, 0.02)),
                stiffness=rng.uniform(15, 60),
                rest_length=rng.uniform(0.0, 0.02),
                law=any_law(rng),
                two_sided=bool(rng.random() < 0.2),
            )
            for _ in range(rng.choice([1, 1, 1, 2, 3]))
        )
        load = None
        if rng.random() < 0.3:
            knots = np.sort(rng.uniform(0, 0.02, rng.integers(1, 4)))
            if np.all(np.diff(knots) > 1e-4):
                load = sw.Load(tuple(knots), tuple(rng.uniform(-0.2, 0.2, len(knots))))
        rub = rng.uniform(0.005, 0.1) if friction and rng.random() < 0.3 else 0.0
        try:
            cell = sw.Cell(bands, lever, limit, load=load, friction=rub, unusual=True)
        except ValueError:
            continue
        # Bands that all but fold onto themselves make forces no step size resolves: the
        # brute-force follower would need days, so they are tested elsewhere.
        theta = np.linspace(-limit, limit, 200)
        if min(float(b.length(theta, lever).min()) for b in bands) > 2e-3:
            return cell
    raise AssertionError("no admissible cell in 1000 draws")


def any_chain(rng: np.random.Generator, cells: int, friction: bool = True) -> sw.Chain:
    """A chain of any kinds of cells."""
    return sw.Chain([any_cell(rng, friction) for _ in range(cells)])


def concave_chain(rng: np.random.Generator, cells: int) -> sw.Chain:
    """A chain of concave cells with equal levers."""
    return sw.Chain([concave_cell(rng) for _ in range(cells)])


def contest(mobility: float = 1.0, friction: float = 0.0) -> sw.Chain:
    """As `large` snaps through, `left` and `right` race to give way; mobilities decide it."""

    def element(name: str, peak: tuple[float, float], valley: tuple[float, float], m: float = 1.0):
        (a, up), (b, down) = peak, valley
        travel, force = [0.0, a, b, b + 0.004], [0.0, up, down, down + 1.2]
        return sw.Element.from_points(travel, force, name, friction=friction, mobility=m)

    return sw.Chain(
        [
            element("large", (0.006, 1.3), (0.017, -0.7)),
            element("left", (0.003, 0.62), (0.011, 0.24)),
            element("right", (0.003, 0.73), (0.011, 0.15), mobility),
        ]
    )


def corrupted(rng: np.random.Generator, events: list[sw.statics.Event]) -> list[sw.statics.Event]:
    """The events with one dropped, two swapped, or one moved by more than the errors they state."""
    k, how = int(rng.integers(len(events))), int(rng.integers(3))
    if how == 0:
        return [*events[:k], *events[k + 1 :]]
    if how == 1 and len(events) > 1:
        k = min(k, len(events) - 2)
        return [*events[:k], events[k + 1], events[k], *events[k + 2 :]]
    event, cell = events[k], 0
    after = list(event.after)
    stated = 2.0 * sum(one.error for one in events[: k + 1])
    after[cell] += float(rng.choice([-1, 1]) * (10 ** rng.uniform(-10, -4) + stated))
    return [*events[:k], replace(event, after=tuple(after)), *events[k + 1 :]]
