"""Speed of the tolerance analysis, beside the general engine on the same mechanisms."""

import statistics
import time
from collections.abc import Callable

import stepwell as sw
from stepwell.design.tolerances.draws import Tolerances
from stepwell.design.tolerances.yields import yields
from stepwell.kernels import cores

MANY = 1_000_000
LONG = 100_000
FOLLOWED = 1000  # for the general engine


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    cell = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
    pair = sw.Chain((cell, cell.with_anchors(q=(0.012, 0.0))))
    twelve = sw.Chain([cell.with_anchors(q=(0.002 * i, 0.0)) for i in range(12)])
    some = Tolerances(anchor=0.001, stiffness=0.05)
    every = Tolerances(0.001, 0.05, 0.05, lever=0.0002, friction=0.02)

    rate = MANY / timed(lambda: yields(pair, some, samples=MANY))
    with_all = MANY / timed(lambda: yields(pair, every, samples=MANY))
    long = LONG / timed(lambda: yields(twelve, some, samples=LONG))
    indices = timed(lambda: yields(pair, every, samples=1, sensitivity=True))

    made = yields(pair, some, samples=FOLLOWED)
    start = time.perf_counter()
    done = [str(made.mechanism(i).cycle().sequence) for i in range(FOLLOWED)]
    ratio = rate * (time.perf_counter() - start) / FOLLOWED
    same = "the same" if done.count(made.target) == made.successes else "ANOTHER"
    threads = cores()
    return [
        (
            f"yield of two cells, anchors and stiffness, drawn and judged, {threads} threads",
            f"{rate / 1e6:.1f} million mechanisms a second",
            "at least 1 million",
        ),
        ("the same, all five tolerances", f"{with_all / 1e6:.1f} million a second", "-"),
        ("yield of twelve cells", f"{long / 1e6:.2f} million mechanisms a second", "-"),
        ("sensitivities of two cells, ten parts", f"{indices * 1e3:.0f} ms", "-"),
        (
            "yield against the general engine, per mechanism",
            f"{ratio:,.0f} times, {same} number of successes in {FOLLOWED}",
            "-",
        ),
    ]


def timed(work: Callable[[], object]) -> float:
    """Median wall time of seven runs after one that warms up [s]."""
    taken: list[float] = []
    for _ in range(8):
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    return statistics.median(taken[1:])


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row))
