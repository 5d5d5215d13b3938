"""Speed of the inverse design: cycles and programmable chains in the paper's box, and on holes."""

import statistics
import time
from itertools import permutations

import numpy as np

from stepwell.design.synthesis.inverse import design

SAMPLE = 5


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    three = [
        cycle(a, b) for a in permutations(range(3)) for b in permutations(range(3))
    ]  # 36 of them
    design(three[0], samples=100)  # compiles, or reads what was compiled
    found = [
        _row("36 cycles of three cells, yield of 100,000 included", three, "each under 2 s"),
        _row("the same on a 5 mm hole grid, best choice proved", three, "-", holes=0.005),
        _row("the same for all anchors off at once", three, "-", objective="worst"),
    ]
    random = np.random.default_rng(0)
    for cells in (4, 6, 8):
        some = [
            cycle(random.permutation(cells).tolist(), random.permutation(cells).tolist())
            for _ in range(SAMPLE)
        ]
        found.append(_row(f"{SAMPLE} random cycles of {cells} cells", some, "-"))
    for cells, wanted in ((3, "at least 4.0 mm"), (4, "at least 2.7 mm")):
        start = time.perf_counter()
        made = design(states="all", cells=cells, objective="worst")
        took = time.perf_counter() - start
        assert made.robustness is not None
        radius = made.robustness.radius * 1e3
        text = f"all anchors may be off by {radius:.3f} mm, found in {took:.2f} s"
        found.append((f"all states of {cells} cells", text, wanted))
    return found


def cycle(loading, unloading) -> str:
    """The cycle in which cells load and unload in these orders."""
    state = ["0"] * len(loading)
    states = ["".join(state)]
    for order, to in ((loading, "1"), (unloading, "0")):
        for cell in order:
            state[cell] = to
            states.append("".join(state))
    return ">".join(states)


def _row(what: str, cycles: list[str], wanted: str, **how) -> tuple[str, str, str]:
    times, shares = [], []
    for sequence in cycles:
        start = time.perf_counter()
        made = design(sequence, **how)
        times.append(time.perf_counter() - start)
        shares.append(made.yield_.fraction)
    return (
        what,
        f"{statistics.median(times):.2f} s each (longest {max(times):.2f}), yields "
        f"{min(shares) * 100:.2f} % and more",
        wanted,
    )


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row))
