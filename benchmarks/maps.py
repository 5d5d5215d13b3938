"""Speed of the transition map, beside the published way of making one."""

import math
import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

import stepwell as sw
from stepwell.kernels import cores, threads

NODES = 200
DESIGNS = 300  # for the published method
STROKES = 50
R, LIMIT, K, REST = 0.010 * math.sqrt(2.0), math.pi / 4, 28.5, 0.010


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    cell = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
    chain = sw.Chain((cell, cell))
    x, y = np.linspace(0, 0.020, NODES), np.linspace(-0.015, 0.015, NODES)
    data = sw.transition_map(chain, cell=1, x=x, y=y)  # compiles, or reads what was compiled
    times = []
    for _ in range(25):
        start = time.perf_counter()
        sw.transition_map(chain, cell=1, x=x, y=y)
        times.append(time.perf_counter() - start)
    ours = statistics.median(times) / NODES**2
    blocks = in_turns(lambda: sw.transition_map(chain, cell=1, x=x, y=y))

    random = np.random.default_rng(0)
    picks = random.integers(0, NODES, (DESIGNS, 2))
    meanings = data.pathway.attrs["flag_meanings"].split()
    names = dict(zip(data.pathway.attrs["flag_values"].tolist(), meanings, strict=True))
    outer_first = ("counterclockwise", "via_01")
    agreed = 0
    start = time.perf_counter()
    halfway = [published((0.020, 0.0), (float(x[c]) + 0.010, float(y[r]))) for r, c in picks]
    theirs = (time.perf_counter() - start) / DESIGNS
    for (r, c), moved in zip(picks, halfway, strict=True):
        agreed += (names[int(data.pathway[r, c])] in outer_first) == moved
    ratio = theirs / ours
    return [
        (
            f"{NODES} x {NODES} map, both directions, {cores()} threads",
            f"{statistics.median(times) * 1e3:.1f} ms (best {min(times) * 1e3:.1f})",
            "at most 40 ms",
        ),
        (
            "the same in blocks of 20,000 against blocks for every core, best of each in turns",
            f"{blocks[0] * 1e3:.1f} against {blocks[1] * 1e3:.1f} ms: "
            f"{blocks[0] / blocks[1]:.2f} times",
            f"at most {cores()} times",
        ),
        (
            f"published method, one design: {STROKES} minimisations, loading only",
            f"{theirs * 1e3:.0f} ms, same cell first in {agreed} of {DESIGNS}",
            "-",
        ),
        ("map against published method, per design", f"{ratio:,.0f} times", "at least 20,000"),
    ]


def in_turns(make: Callable[[], object]) -> tuple[float, float]:
    """Best times [s] with blocks as long as they may be, and with several for each core."""
    usual, best = threads._SHARES, [math.inf, math.inf]
    try:
        for _ in range(100):
            for k, shares in enumerate((1, usual)):
                threads._SHARES = shares
                start = time.perf_counter()
                make()
                best[k] = min(best[k], time.perf_counter() - start)
    finally:
        threads._SHARES = usual
    return best[0], best[1]


def published(inner: tuple[float, float], outer: tuple[float, float]) -> bool:
    """Minimise the energy anew at every stroke of a loading; True if the outer cell moved first.

    The way of the paper's notebooks: the angles of both cells, bounded by their stops, with the
    stroke as a constraint. Plain floats, so that NumPy's small-array costs are not held against it.
    """

    def energy(theta):
        total = 0.0
        for angle, (dx, dy) in zip(theta.tolist(), (inner, outer), strict=True):
            length = math.hypot(R * math.cos(angle) + dx, R * math.sin(angle) + dy)
            total += K / 2 * (length - REST) ** 2
        return total * 1e3  # mJ: SLSQP's tolerance is absolute

    top = 2 * R * math.sin(LIMIT)
    bounds = [(-LIMIT, LIMIT)] * 2
    first = None
    for stroke in np.linspace(0, 2 * top, STROKES).tolist():

        def gap(theta, stroke=stroke):
            a, b = theta.tolist()
            return 1e3 * (R * (math.sin(a) + math.sin(b)) + top - stroke)

        found = minimize(
            energy,
            np.array([-LIMIT, -LIMIT]),
            method="SLSQP",
            bounds=bounds,
            constraints={"type": "eq", "fun": gap},
        )
        if first is None and stroke > top / 2:
            first = bool(found.x[1] > found.x[0])
    return bool(first)


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row))
