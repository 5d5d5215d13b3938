"""Cost of proofs, and proofs tried against random chains and wrong answers.

`python benchmarks/proofs.py 1000` prints, for random chains, the fraction that is proved, how many
of the others have a tie, the causes of all gaps, and how many wrong answers are caught.
"""

import re
import statistics
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import chains  # pyright: ignore[reportMissingImports]  the one of the tests
import stepwell as sw
from stepwell.proof import prove

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


# Ties: of cells whose forces are equal, or constant, the model picks none; forces closer than 1e-9
# of the largest one count as equal.
_TIES = re.compile("the order of cells|constant force")


def tried(count: int, kind: str) -> None:
    """Print how many of random chains are proved, and why the others are not.

    Chain k is the one of seed [41, k], so a part of a run can be repeated.
    """
    paths, proved, ties, causes = 0, 0, 0, Counter[str]()
    caught, wrong = 0, 0
    for k in range(count):
        rng = np.random.default_rng([41, k])
        cells = int(rng.integers(2, 7))
        make = {"concave": chains.concave_chain, "without friction": plain}.get(kind)
        chain = make(rng, cells) if make else chains.any_chain(rng, cells)
        try:
            path = chain.cycle().path
        except sw.StepwellError:
            continue
        proof = path.prove()
        paths, proved = paths + 1, proved + proof.proved
        # What follows a gap begins at the engine's answer, so the first one counts.
        ties += bool(proof.gaps and _TIES.search(proof.gaps[0].cause))
        for gap in proof.gaps:
            name = re.sub(r"\d+", "…", gap.cause)
            causes[f"contradicted: {name}" if gap.contradicted else name] += 1
        if proof.proved and path.events:
            claims = chains.corrupted(rng, list(path.events))
            wrong += 1
            caught += not prove(path, claims=claims).proved
    print(f"{kind}: {proved} of {paths} proved, {ties} others begin with a tie")
    print(f"  {caught} of {wrong} wrong answers caught")
    for name, times in causes.most_common():
        print(f"  {times:5d} gaps: {name}")


def plain(rng: np.random.Generator, cells: int) -> sw.Chain:
    """Any kinds of cells without friction."""
    return chains.any_chain(rng, cells, friction=False)


if __name__ == "__main__":
    for one in rows():
        print(*one, sep="; ")
    for name in ("concave", "without friction", "of any kind"):
        tried(int(sys.argv[1]) if len(sys.argv) > 1 else 100, name)
