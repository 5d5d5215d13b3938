"""Cost of proofs: `python benchmarks/proofs.py`; random chains are tried by random_proofs.py."""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import chains  # pyright: ignore[reportMissingImports]  the one of the tests
import stepwell as sw

# Chains of concave cells, and what is wanted of a cycle.
COSTS = (2, "at most 50 ms"), (4, "at most 0.5 s"), (32, "at most 30 s")


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    found: list[tuple[str, str, str]] = []
    for cells, wanted in COSTS:
        rng = np.random.default_rng(cells)
        paths = [
            chains.concave_chain(rng, cells).cycle().path for _ in range(9 if cells < 9 else 1)
        ]
        times: list[float] = []
        for path in paths:
            begin = time.perf_counter()
            path.prove()
            times.append(time.perf_counter() - begin)
        without = timed(paths[0].chain.cycle)
        proof = statistics.median(times)
        text = f"{1e3 * proof:.3g} ms, {proof / without:.2g} times the cycle without a proof"
        found.append((f"proof of a cycle of {cells} concave cells", text, wanted))
    for name in ("paper-forward", "three-wave", "finger-selector"):
        chain = sw.preset(name)
        counted = chain.yields(samples=1)
        sampled, boxed = timed(chain.yields, 3), timed(counted.prove, 3)
        text = f"{1e3 * boxed:.3g} ms, {boxed / sampled:.2g} times a yield of 100,000 samples"
        found.append((f"all machines of {name} within its tolerances", text, "no number"))
    return found


def timed(run: Callable[[], object], count: int = 9) -> float:
    """Seconds of a call, the median of several."""
    times: list[float] = []
    for _ in range(count):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


if __name__ == "__main__":
    for one in rows():
        print(*one, sep="; ")
