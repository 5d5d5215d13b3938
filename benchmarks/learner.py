"""A learned stroke policy against compiled springs on the same arenas.

`python benchmarks/learner.py` trains the policy by a plain evolution strategy and compares it, in
about a quarter of an hour of one core. It writes docs/learner.json and the table of the page on
reinforcement learning; with --page the table only. No start of the training is used in the
comparison.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import stepwell as sw
from stepwell.robot import Arena, Cylinder, Goal, Robot, Wall, other_start

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
# Budget: generations, pairs of mirrored policies in each, and the step of the search.
GENERATIONS, PAIRS, STEP, RATE = 6, 4, 0.25, 0.5
TRAINED_IN = "short wall", "cylinder"  # in turn, one generation each
STARTS = 4  # random starts in each arena of the comparison
DEVIATION = 0.05  # of the stiffness of one band
FEATURES = ("one", "goal to the left", "sine of heading", "left antenna", "right antenna", "force")

Weights = np.ndarray  # (2, F): lower and upper end of the next stroke


def contenders() -> dict[str, tuple[Robot, bool]]:
    """Robots by name, and whether a policy for their strokes is learned."""
    springs = sw.files.loads(json.loads((ROOT / "docs/compiled.json").read_text("utf-8"))["robot"])
    robot = springs.robot
    return {
        "compiled springs, full strokes": (robot, False),
        "compiled springs, learned strokes": (robot, True),
    }


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


def evolved(score: Callable[[Weights, int], float], seed: int = 0) -> tuple[Weights, list[float]]:
    """A plain evolution strategy: mirrored samples, ranks, one step along their mean."""
    rng, mean, scores = np.random.default_rng(seed), plain(), list[float]()
    for generation in range(GENERATIONS):
        steps = rng.standard_normal((PAIRS, *mean.shape))
        steps = np.concatenate([steps, -steps])
        found = np.array([score(mean + STEP * one, generation) for one in steps])
        rank = np.argsort(np.argsort(found)) / (len(found) - 1) - 0.5
        mean = mean + RATE * STEP * np.tensordot(rank, steps, 1) * 2
        scores.append(float(found.max()))
        print(f"  generation {generation + 1}: best {scores[-1]:.1f} u_max", flush=True)
    return mean, scores


def trained(robot: Robot) -> tuple[Weights, list[float]]:
    """The policy of a robot: in each generation one arena and one random start."""

    def score(weights: Weights, generation: int) -> float:
        arena = ARENAS[TRAINED_IN[generation % len(TRAINED_IN)]]
        reached, gain, took = episode(robot, other_start(arena, generation), weights)
        # Of two that reach the goal the faster one is better.
        return gain + 10.0 * (LIMIT - took) / LIMIT * reached

    return evolved(score)


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


def measured() -> dict[str, Any]:
    """Train and compare all contenders."""
    rows: list[dict[str, Any]] = []
    for name, (robot, learns) in contenders().items():
        print(name, flush=True)
        began = time.process_time()
        weights, scores = trained(robot) if learns else (plain(), [])
        took = time.process_time() - began
        rows.append(
            {
                "name": name,
                "numbers": weights.size if learns else 0,
                "episodes": 2 * PAIRS * len(scores),
                "training_s": took if learns else 0.0,
                "best": scores,
                "weights": weights.round(4).tolist(),
                **compared(robot, weights),
            }
        )
        print(rows[-1], flush=True)
    return {"starts": STARTS, "limit_s": LIMIT, "deviation": DEVIATION, "rows": rows}


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
    """Measure, unless --page is given, and write the page."""
    if "--page" not in sys.argv[1:]:
        FILE.write_text(json.dumps(measured(), indent=1) + "\n", "utf-8")
    PAGE.write_text(page(json.loads(FILE.read_text("utf-8"))), "utf-8")


if __name__ == "__main__":
    main()
