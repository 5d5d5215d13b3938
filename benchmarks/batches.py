"""Speed of full cycles of many designs in one call, beside one after the other."""

import time

import numpy as np

import stepwell as sw
from cycles import mixed
from stepwell.design.tolerances.draws import Draws, Tolerances
from stepwell.sequences import cycles_of

SHAPES = 20  # chains, each with tolerances
MANY = 1000  # mechanisms after each of them, in one call
SOME = 20  # of these, one after the other
GOALS = {2: 50_000, 4: 10_000}
TOLERANCES = Tolerances(anchor=0.001, stiffness=0.05)


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    found: list[tuple[str, str, str]] = []
    for cells, goal in GOALS.items():
        draws = [Draws(mixed(seed, cells), TOLERANCES, seed) for seed in range(SHAPES)]
        drawn = [next(draw.chunks(MANY)).copy() for draw in draws]
        together(draws[0], drawn[0][:2])  # compiles, or reads what was compiled
        draws[0].built(drawn[0][0]).cycle()
        pairs = [*zip(draws, drawn, strict=True)]
        start, wall = time.process_time(), time.perf_counter()
        texts = [together(draw, own) for draw, own in pairs]
        spent, wall = time.process_time() - start, time.perf_counter() - wall
        start = time.process_time()
        single = [[by_itself(draw, one) for one in own[:SOME]] for draw, own in pairs]
        alone = time.process_time() - start
        same = sum(
            a == b
            for one, many in zip(single, texts, strict=True)
            for a, b in zip(one, many, strict=False)
        )
        rate, before = SHAPES * MANY / spent, SHAPES * SOME / alone
        found.append(
            (
                f"cycles of general chains of {cells} cells in one call, drawn and followed",
                f"{rate:,.0f} a second a core ({SHAPES * MANY / wall:,.0f} of wall time)",
                f"at least {goal:,}",
            )
        )
        found.append(
            (
                "the same against one after the other",
                f"{rate / before:.1f} times {before:,.0f} a second; the same in {same} of "
                f"{SHAPES * SOME}",
                "-",
            )
        )
    return found


def together(draws: Draws, drawn: np.ndarray) -> list[str]:
    """What mechanisms do, by one call."""
    found = cycles_of(lambda i: draws.built(drawn[i]), len(drawn), draws.designs(drawn))
    texts = [*map(str, found.sequences), "no answer", "no mechanism"]
    return [texts[number] for number in found.number.tolist()]


def by_itself(draws: Draws, draw: np.ndarray) -> str:
    """What one mechanism does."""
    try:
        return str(draws.built(draw).cycle().sequence)
    except sw.StepwellError:
        return "no answer"


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row))
