"""A learned stroke policy against compiled springs on the same arenas.

`python benchmarks/learner.py` trains policies by a plain evolution strategy and compares them, in
about half an hour of one core. It writes docs/learner.json and the table of the page
on reinforcement learning, and resumes after the last robot that is in it; with --page the table
only. --generations and --pairs are the budget of a new record. No start of the training is used in
the comparison.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import stepwell as sw
from stepwell.robot import Arena, Cylinder, Goal, Leg, Robot, Wall, other_start

ROOT = Path(__file__).parents[1]
FILE, PAGE = ROOT / "docs" / "learner.json", ROOT / "docs" / "how-to" / "reinforcement-learning.md"
# Everything farther ahead than 0.42 m is the goal.
GOAL = Goal((3.42, 0.0), 3.0)
ARENAS = {
    "no obstacle": Arena(goal=GOAL),
    "short wall": Arena(walls=(Wall((0.26, -0.03), (0.26, 0.13)),), goal=GOAL),
    "cylinder": Arena(cylinders=(Cylinder((0.26, 0.01), 0.025),), goal=GOAL),
}
LIMIT = 120.0  # of an episode [s]
INTERVAL = 0.25  # between two observations [s]
# Budget of a new record: generations, and pairs of mirrored policies in each.
GENERATIONS, PAIRS = 8, 4
STEP, RATE = 0.25, 0.5  # of the search
TRAINED_IN = "short wall", "cylinder"  # in turn, one generation each
CHECKS = 1  # random starts in each of these arenas by which the best policy is chosen
STARTS = 6  # random starts in each arena of the comparison
DEVIATION = 0.05  # of the stiffness of one band
FEATURES = ("one", "goal to the left", "sine of heading", "left antenna", "right antenna", "force")

Weights = np.ndarray  # (2, F): lower and upper end of the next stroke


def contenders() -> dict[str, tuple[Robot, bool]]:
    """Robots by name, and whether a policy for their strokes is learned."""
    record = json.loads((ROOT / "docs/compiled.json").read_text("utf-8"))
    springs = sw.files.loads(record["robot"]).robot
    legs = plain_legs(springs)
    return {
        "compiled springs, full strokes": (springs, False),
        "compiled springs, learned strokes": (springs, True),
        "unequal legs, full strokes": (legs, False),
        "unequal legs, learned strokes": (legs, True),
    }


def plain_legs(robot: Robot) -> Robot:
    """The same body with legs of unequal steps and antennas that displace no anchor.

    Full strokes turn it to the left, strokes to nine tenths to the right, so that strokes alone
    can steer it.
    """
    steps = {"left": (0.016, 0.010), "right": (0.024, 0.009)}  # step and inner q_x [m]
    legs = [replace(leg, chain=_chain(leg, *steps[leg.name])) for leg in robot.legs]
    antennas = [replace(one, connected=False) for one in robot.antennas]
    return replace(robot, legs=legs, antennas=antennas, sources={}, title="Unequal legs")


def _chain(leg: Leg, step: float, q_x: float) -> sw.Chain:
    """A chain of the same stroke [m] with this step."""
    cells = []
    for name, travel, x in (("inner", step, q_x), ("outer", leg.chain.full_stroke - step, 0.020)):
        lever = max(0.010 * math.sqrt(2), travel / math.sqrt(2))
        band, limit = sw.Band((-0.010, 0.0), (x, 0.0), 60.0, 0.010), math.asin(travel / 2 / lever)
        cells.append(sw.Cell(band, lever=lever, limit=limit, name=name))
    return sw.Chain(cells)


def plain() -> Weights:
    """Full strokes out and back, whatever is observed."""
    weights = np.zeros((2, len(FEATURES)))
    weights[1, 0] = 1.0
    return weights


def episode(robot: Robot, arena: Arena, weights: Weights) -> tuple[bool, float, float]:
    """Whether the goal was reached, the decrease of its distance over u_max, and the time [s]."""
    env = sw.make_env(robot, arena, interval=INTERVAL, limit=LIMIT).unwrapped
    seen, info = env.reset(seed=0)
    at = [env.names.index(name) for name in _read(env.names)]
    scale = np.array([0.1, 1.0, *(one.swing for one in robot.antennas)])
    toward, total, done = 1, 0.0, False
    target = float(np.clip(weights[1] @ _features(seen, at, scale), 0.0, 1.0))
    while not done:
        seen, gain, ended, late, info = env.step(np.array([2 * target - 1], np.float32))
        total, done = total + gain, ended or late
        # At the end of a stroke the policy chooses the end of the next one.
        if abs(seen[0] / robot.drive.amplitude - target) < 0.01:
            toward = 1 - toward
            target = float(np.clip(weights[toward] @ _features(seen, at, scale), 0.0, 1.0))
    return info["outcome"] == "reached the goal", total, info["time"]


def _read(names: tuple[str, ...]) -> Iterator[str]:
    wanted = ("goal to the left", "sine of", "left antenna [rad]", "right antenna [rad]")
    yield from (next(name for name in names if name.startswith(one)) for one in wanted)
    yield from (name for name in names if name.startswith("obstacle force"))


def _features(seen: np.ndarray, at: list[int], scale: np.ndarray) -> np.ndarray:
    read = np.asarray(seen, float)[at]
    force = float(read[-1] > 0.01) if len(read) > len(scale) else 0.0
    return np.array([1.0, *np.tanh(read[: len(scale)] / scale), force])


def evolved(
    score: Callable[[Weights, int], float],
    check: Callable[[Weights], float],
    budget: tuple[int, int] = (GENERATIONS, PAIRS),
) -> tuple[Weights, list[float]]:
    """A plain evolution strategy: mirrored samples, ranks, one step along their mean.

    Returns:
        The mean with the best check of all generations, the first policy included, and all checks.
    """
    generations, pairs = budget
    rng, mean = np.random.default_rng(0), plain()
    means, checks = [mean], [check(mean)]
    for generation in range(generations):
        steps = rng.standard_normal((pairs, *mean.shape))
        steps = np.concatenate([steps, -steps])
        found = np.array([score(mean + STEP * one, generation) for one in steps])
        rank = np.argsort(np.argsort(found)) / (len(found) - 1) - 0.5
        mean = mean + RATE * STEP * np.tensordot(rank, steps, 1) * 2
        means.append(mean)
        checks.append(check(mean))
        text = f"best {found.max():.1f}, mean policy {checks[-1]:.1f} u_max"
        print(f"  generation {generation + 1}: {text}", flush=True)
    return means[int(np.argmax(checks))], checks


def trained(robot: Robot, budget: tuple[int, int]) -> tuple[Weights, list[float]]:
    """The policy of a robot: in each generation one arena and one random start."""

    def of(name: str, start: int, weights: Weights) -> float:
        reached, gain, took = episode(robot, other_start(ARENAS[name], start), weights)
        # Of two that reach the goal the faster one is better.
        return gain + 10.0 * (LIMIT - took) / LIMIT * reached

    def check(weights: Weights) -> float:
        starts = range(500, 500 + CHECKS)
        return float(np.mean([of(name, seed, weights) for name in TRAINED_IN for seed in starts]))

    def score(weights: Weights, generation: int) -> float:
        return of(TRAINED_IN[generation % len(TRAINED_IN)], generation, weights)

    return evolved(score, check, budget)


def episodes(generations: int, pairs: int) -> int:
    """Number of episodes of a training, with those that choose the best policy."""
    return 2 * pairs * generations + CHECKS * len(TRAINED_IN) * (generations + 1)


def one_band_off(robot: Robot) -> Iterator[Robot]:
    """The robot with the stiffness of the bands of one cell 5 % higher or lower."""
    for number, leg in enumerate(robot.legs):
        for at, cell in enumerate(leg.chain.levers):
            for factor in (1 - DEVIATION, 1 + DEVIATION):
                bands = [replace(one, stiffness=factor * one.stiffness) for one in cell.bands]
                cells = [*leg.chain.levers]
                cells[at] = replace(cell, band=bands)
                legs = [*robot.legs]
                legs[number] = replace(leg, chain=replace(leg.chain, cells=cells))
                yield replace(robot, legs=legs)


def compared(robot: Robot, weights: Weights) -> dict[str, Any]:
    """How often the goal is reached, as designed and with one band off."""
    starts = range(1000, 1000 + STARTS)
    runs = {
        name: [episode(robot, other_start(arena, seed), weights) for seed in starts]
        for name, arena in ARENAS.items()
    }
    off = [
        episode(copy, other_start(ARENAS[TRAINED_IN[0]], 2000 + k), weights)[0]
        for k, copy in enumerate(one_band_off(robot))
    ]
    times = [took for every in runs.values() for reached, _, took in every if reached]
    return {
        "reached": {name: sum(run[0] for run in every) for name, every in runs.items()},
        "mean_time_s": math.fsum(times) / len(times) if times else None,
        "off_reached": sum(off),
        "off_runs": len(off),
    }


def measured(name: str, budget: tuple[int, int]) -> dict[str, Any]:
    """Train, if it learns, and compare one of the contenders."""
    robot, learns = contenders()[name]
    began = time.process_time()
    weights, checks = trained(robot, budget) if learns else (plain(), [])
    took = time.process_time() - began
    return {
        "name": name,
        "numbers": weights.size if learns else 0,
        "episodes": episodes(*budget) if learns else 0,
        "training_s": took if learns else 0.0,
        "checks": checks,
        "weights": weights.round(4).tolist(),
        **compared(robot, weights),
    }


def lines(record: dict[str, Any]) -> list[str]:
    """The table of the page."""
    starts = record["starts"]
    head = ["robot", "learned numbers", "episodes", *ARENAS, "mean time [s]", "one band ±5 %"]
    table = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for row in record["rows"]:
        reached = [f"{row['reached'][name]} of {starts}" for name in ARENAS]
        took = "" if row["mean_time_s"] is None else f"{row['mean_time_s']:.0f}"
        off = f"{row['off_reached']} of {row['off_runs']}"
        numbers, episodes = (str(row[key] or "none") for key in ("numbers", "episodes"))
        table.append(f"| {' | '.join([row['name'], numbers, episodes, *reached, took, off])} |")
    return table


def page(record: dict[str, Any]) -> str:
    """The page with its table as the record has it."""
    text = PAGE.read_text("utf-8")
    begin, end = "<!-- learner: written by benchmarks/learner.py -->", "<!-- end of learner -->"
    before, rest = text.split(begin)
    after = rest.split(end)[1]
    return "\n".join([f"{before}{begin}\n", *lines(record), f"\n{end}{after}"])


def main() -> None:
    """Measure what is missing, unless --page is given, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", action="store_true")
    parser.add_argument("--generations", type=int, default=GENERATIONS)
    parser.add_argument("--pairs", type=int, default=PAIRS)
    given = parser.parse_args()
    head = {"starts": STARTS, "limit_s": LIMIT, "deviation": DEVIATION, "checks": CHECKS}
    head |= {"generations": given.generations, "pairs": given.pairs}
    record = json.loads(FILE.read_text("utf-8"))
    if not given.page:
        if any(record.get(key) != value for key, value in head.items()):
            record = {**head, "rows": []}
        for name in [*contenders()][len(record["rows"]) :]:
            print(name, flush=True)
            record["rows"].append(measured(name, (given.generations, given.pairs)))
            FILE.write_text(json.dumps(record, indent=1) + "\n", "utf-8")
    PAGE.write_text(page(record), "utf-8")


if __name__ == "__main__":
    main()
