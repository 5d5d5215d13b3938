"""Speed of full cycles: long concave chains, and short chains of any cells."""

import math
import os
import statistics
import time
from collections import Counter
from dataclasses import replace

import numpy as np
from scipy.interpolate import PchipInterpolator

import stepwell as sw
from stepwell.mechanism.law import packed
from stepwell.statics import SegmentKind

# How many tables, points in each, and what is wanted of a cycle.
TABLES = (
    (64, 5, "-"),
    (256, 5, "-"),
    (1000, 5, "at most 20 ms"),
    (100_000, 5, "at most 2 s"),
    (256, 200, "at most 50 ms"),
    (1000, 200, "at most 300 ms, 150 MB"),
)
# How many general cells, and what is wanted of a cycle.
GENERAL = (
    (2, "-"),
    (4, "under 5 ms"),
    (8, "-"),
    (16, "-"),
    (64, "at most 60 ms"),
    (256, "at most 600 ms"),
    (1000, "at most 150 ms"),
)


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    os.environ["STEPWELL_LIMITS"] = "cells=100000"  # more than the usual 10,000, on purpose
    nested(1000).cycle()  # compiles, or reads what was compiled
    found: list[tuple[str, str, str]] = []
    short = timed(nested(1000), 9)
    long = timed(nested(100_000), 2)
    many = nested(100_000)
    gathered = min(gathering(many) for _ in range(3))
    law = 100_000 * math.log(100_000) / (1000 * math.log(1000))
    found.append(("cycle of 1,000 nested concave cells", ms(short), "at most 20 ms"))
    found.append(
        (
            "100,000 of them, beside N log N of that",
            f"{long:.2f} s, {long / short / law:.2f} times N log N",
            "at most 1.5 times",
        )
    )
    found.append(
        (
            "gathering what 100,000 cells hold, of processor time",
            f"{gathered:.2f} s, {gathered / 100_000 * 1e6:.1f} µs a cell",
            "at most 0.15 s; 0.3 s with the sort",
        )
    )
    for cells in (4, 16, 64):
        chains = [scattered(seed, cells) for seed in range(5 if cells < 64 else 2)]
        found.append(
            (
                f"cycle of {cells} concave cells at random anchors (landings integrated)",
                ms(statistics.median(timed(chain, 2) for chain in chains)),
                "-",
            )
        )
    for cells, wanted in GENERAL:
        chains = [mixed(seed, cells) for seed in range(11 if cells < 64 else 1)]
        times = [timed(chain, 2 if cells < 1000 else 1) for chain in chains]
        found.append(
            (
                f"cycle of {cells:,} general cells (slack, stiffening, loads)",
                f"{ms(statistics.median(times))}, worst {ms(max(times))}",
                wanted,
            )
        )
    for cells, points, wanted in TABLES:
        chain = tables(0, cells, points)
        spent, path = min((spent_on(chain) for _ in range(3)), key=lambda one: one[0])
        found.append(
            (
                f"cycle of {cells:,} open tables of {points} points, of processor time",
                f"{ms(spent)}, {spent / cells * 1e6:.0f} µs a cell, {held(path):.3g} MB",
                wanted,
            )
        )
    for cells in (256, 1000):
        _, path = spent_on(mixed(0, cells))
        snaps = [e.decided for e in path.segments() if e.kind is SegmentKind.SNAP]
        share = Counter(how.name.lower() for how in snaps if how is not None)
        text = ", ".join(f"{count} by {how}" for how, count in share.most_common())
        found.append((f"landings of {cells:,} general cells", text, "-"))
    for cells, wanted in GENERAL[4:]:
        rubbing = mixed(0, cells)
        rubbing = sw.Chain([replace(cell, friction=0.01) for cell in rubbing.cells])
        sprung = replace(mixed(0, cells), actuator_stiffness=200.0)
        for name, chain in (("with friction", rubbing), ("behind a spring", sprung)):
            found.append((f"the same, {cells:,} of them {name}", ms(timed(chain, 1)), wanted))
    return found


def spent_on(chain: sw.Chain) -> tuple[float, sw.Path]:
    """Processor time of a cycle [s], and its path."""
    start = time.process_time()
    path = chain.cycle().path
    return time.process_time() - start, path


def held(path: sw.Path) -> float:
    """What the arrays of a path take, its chain's included [MB]."""
    problem = path._problem
    arrays = [*path._log, *problem.laws, *problem.sheets, *problem.pieces]
    return sum(array.nbytes for array in arrays) / 1e6


def tables(seed: int, cells: int, points: int) -> sw.Chain:
    """Open tables that rise, fall and rise, straight between 5 points or smooth between many."""
    rng = np.random.default_rng(seed)
    made: list[sw.Element] = []
    for _ in range(cells):
        peak, top = rng.uniform(1.5, 3.5), rng.uniform(1.0, 3.0)
        valley, bottom = peak + rng.uniform(0.4, 1.2), top - rng.uniform(0.5, 2.5)
        travel = np.array([0.0, peak, valley, valley + 2.5, valley + 4.5])
        force = np.array([0.0, top, bottom, bottom + 2.5, bottom + 5.0])
        if points > 5:
            smooth = PchipInterpolator(travel, force)
            travel = np.linspace(0.0, travel[-1], points)
            force = smooth(travel)
        made.append(sw.Element.from_points(1e-3 * travel, force))
    return sw.Chain(made)


def ms(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def timed(chain: sw.Chain, times: int) -> float:
    """Median time of a cycle [s]."""
    taken: list[float] = []
    for _ in range(times):
        start = time.perf_counter()
        chain.cycle()
        taken.append(time.perf_counter() - start)
    return statistics.median(taken)


def gathering(chain: sw.Chain) -> float:
    """Processor time of reading all numbers of the cells into arrays [s]."""
    start = time.process_time()
    packed(chain.cells)
    return time.process_time() - start


def nested(cells: int) -> sw.Chain:
    """d_x evenly over 10..30 mm in random order: every cell snaps with the first."""
    x = np.random.default_rng(0).permutation(np.linspace(0.010, 0.030, cells))
    return sw.Chain([sw.Cell(sw.Band((0.0, 0.0), (float(v), 0.0))) for v in x])


def scattered(seed: int, cells: int) -> sw.Chain:
    """Anchors at random in the paper's box."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0.010, 0.030, cells), rng.uniform(-0.015, 0.015, cells)
    return sw.Chain(
        [sw.Cell(sw.Band((0, 0), (float(a), float(b)))) for a, b in zip(x, y, strict=True)]
    )


def mixed(seed: int, cells: int) -> sw.Chain:
    """Cells that are not concave: short and folded-back bands, stiffening rubber, loads."""
    rng = np.random.default_rng(seed)
    made: list[sw.Cell] = []
    for _ in range(cells):
        band = sw.Band(
            (0.0, 0.0),
            (float(rng.uniform(-0.01, 0.03)), float(rng.uniform(-0.02, 0.02))),
            stiffness=float(rng.uniform(15, 60)),
            rest_length=float(rng.uniform(0.0, 0.02)),
            law=sw.Cubic(-20.0, 800.0) if rng.random() < 0.4 else sw.Linear(),
        )
        load = sw.Load.constant(float(rng.uniform(-0.1, 0.1))) if rng.random() < 0.3 else None
        made.append(sw.Cell(band, load=load, unusual=True))
    return sw.Chain(made)
