"""Speed of stroke programs and transition graphs by the engine."""

import contextlib
import itertools
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import stepwell as sw

SEEDS = 5


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    straight(3).program("001")  # compiles, or reads what was compiled
    four = [any_kind(seed) for seed in range(SEEDS)]
    states = ["".join(bits) for bits in itertools.product("01", repeat=4)]
    found: list[float] = []
    for chain in four:
        found += [timed(lambda c=chain, s=state: attempt(c, s)) for state in states]
    twelve = straight(12)
    hardest = timed(lambda: twelve.program("01" * 6), 5)
    rng = np.random.default_rng(0)
    random = ["".join(rng.choice(["0", "1"], 12)) for _ in range(20)]
    times = [timed(lambda s=state: twelve.program(s)) for state in random]
    return [
        (
            f"program to each state of {SEEDS} chains of four cells that are not concave",
            f"{ms(statistics.median(found))}, worst {ms(max(found))}",
            "under 1 s",
        ),
        ("program of twelve strokes for twelve nested cells", ms(hardest), "under 0.1 s"),
        (
            "program to a random state of twelve nested cells",
            f"{ms(statistics.median(times))}, worst {ms(max(times))}",
            "under 0.1 s",
        ),
        *(
            (
                f"whole transition graph of {cells} nested cells under a stroke",
                ms(timed(lambda n=cells: straight(n).graph())),
                "-",
            )
            for cells in (4, 6, 8)
        ),
    ]


def attempt(chain: sw.Chain, to: str) -> None:
    with contextlib.suppress(sw.Unreachable):  # an answer too, after looking everywhere
        chain.program(to)


def straight(cells: int) -> sw.Chain:
    """d_x evenly over 10..30 mm: every two loops nested."""
    x = np.linspace(0.010, 0.030, cells)
    return sw.Chain([sw.Cell(sw.Band((0.0, 0.0), (float(v), 0.0))) for v in x])


def any_kind(seed: int) -> sw.Chain:
    """Two bands a cell, slack, stiffening rubber, loads."""
    rng = np.random.default_rng(seed)
    cells: list[sw.Cell] = []
    while len(cells) < 4:
        bands = [
            sw.Band(
                (0.0, 0.0),
                (float(rng.uniform(0.0, 0.03)), float(rng.uniform(-0.015, 0.015))),
                stiffness=float(rng.uniform(15, 60)),
                rest_length=float(rng.uniform(0.004, 0.02)),
                law=sw.Cubic(-20.0, 800.0) if rng.random() < 0.4 else sw.Linear(),
            )
            for _ in range(int(rng.integers(1, 3)))
        ]
        load = sw.Load.constant(float(rng.uniform(-0.05, 0.05))) if rng.random() < 0.3 else None
        cells.append(sw.Cell(bands, load=load))
    return sw.Chain(cells)


def ms(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def timed(run: Callable[[], Any], times: int = 1) -> float:
    """Median time [s]."""
    taken: list[float] = []
    for _ in range(times):
        start = time.perf_counter()
        run()
        taken.append(time.perf_counter() - start)
    return statistics.median(taken)


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row))
