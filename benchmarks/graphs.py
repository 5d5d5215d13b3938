"""Size and speed of force-controlled transition graphs, beside the peer that makes them too."""

import gc
import importlib.util
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import stepwell as sw

# Prints processor time [s], memory [MB] and nodes of a graph, made in a process of its own.
CHILD = """
import resource, sys, time
from graphs import nested, scattered
cells, what = int(sys.argv[1]), sys.argv[2]
chain = scattered(cells) if what == "reached" else nested(cells)
chain.implicit_graph("force").vertex_count  # opens what a graph needs
begun = time.process_time()
found = chain.graph("force", start="0" * cells if what == "reached" else None)
if what == "networkx":
    found.networkx
taken = time.process_time() - begun
print(taken, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, len(found))
"""
LARGEST = 16  # cells of the longest chain whose graph is made whole
SECONDS = 5.0  # what the peer may take


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    chain = nested(14)
    found = chain.graph("force")
    ours = {14: timed(lambda: chain.graph("force"), 5)}
    told = [
        (
            "force-controlled graph of 14 concave cells",
            f"{ours[14]:.2f} s, {len(found):,} states, {found.transition_count:,} transitions",
            "-",
        ),
        ("and its reading: loops, memory, latches", f"{timed(lambda: fresh(chain), 3):.2f} s", "-"),
        *sizes(),
    ]
    if importlib.util.find_spec("hysteron_tgraphs") is None:
        return [
            *told,
            (
                "against hysteron-tgraphs at equal n",
                "not installed: pip install hysteron_tgraphs (Python 3.12 or newer)",
                "as a ratio",
            ),
        ]
    n, theirs, agreed = peer(LARGEST)
    if n not in ours:
        ours[n] = timed(lambda: nested(n).graph("force"), 3)
    return [
        *told,
        (
            f"hysteron-tgraphs, {n} cells, the most it does in {SECONDS:.0f} s",
            f"{theirs:.2f} s, {agreed:.0%} of its transitions are ours",
            "-",
        ),
        (
            f"ours against it at {n} cells",
            f"{ours[n]:.2f} s, {theirs / ours[n]:.1f} times",
            "as a ratio",
        ),
    ]


def sizes() -> list[tuple[str, str, str]]:
    """Processor time and memory of whole graphs: as arrays, and as the graph of networkx."""
    told: list[tuple[str, str, str]] = []
    for cells in (14, 16):
        (before, large, _), (after, small, _) = (child(cells, w) for w in ("networkx", "arrays"))
        told.append(
            (
                f"graph of {cells} cells under a force: networkx against arrays",
                f"{before:.2f} s, {large:.0f} MB against {after:.2f} s, {small:.0f} MB: "
                f"{before / after:.0f} times",
                "-",
            )
        )
    for cells, what, wanted in (
        (20, "whole", "at most 5 s and 1000 MB"),
        (24, "reached", "listed, of 16,777,216"),
    ):
        taken, memory, nodes = child(cells, what)
        told.append(
            (
                f"graph of {cells} cells under a force, {what}",
                f"{taken:.2f} s, {memory:.0f} MB, {nodes:,.0f} states",
                wanted,
            )
        )
    return told


def child(cells: int, what: str) -> tuple[float, ...]:
    """Processor time [s], peak memory [MB] and nodes of a graph in a process of its own."""
    settings = {**os.environ, "STEPWELL_LIMITS": "relays=24", "STEPWELL_KERNELS": "auto"}
    command = [sys.executable, "-c", CHILD, str(cells), what]
    folder = os.path.dirname(__file__)
    said = subprocess.run(
        command, check=True, stdout=subprocess.PIPE, text=True, env=settings, cwd=folder
    )
    return tuple(map(float, said.stdout.split()))


def peer(largest: int) -> tuple[int, float, float]:
    """The largest number of cells it does in time, its seconds, and the share we agree on."""
    for n in range(8, largest + 1):
        fields = given(nested(n))
        start = time.perf_counter()
        found = graph_of(fields)
        taken = time.perf_counter() - start
        if taken * 2.2 > SECONDS or n == largest:
            return n, taken, share(found, nested(n).graph("force"))
    raise AssertionError("not reached")


def given(chain: sw.Chain) -> Any:
    """The chain as that package wants it."""
    from hysteron_tgraphs.model import SwitchingFields  # pyright: ignore[reportMissingImports]

    fields = SwitchingFields(len(chain))
    forces = np.array([(cell.force_0, cell.force_1) for cell in chain.levers])
    for state in fields:
        fields[state] = np.where(np.array(state) == 1, forces[:, 1], forces[:, 0])
    return fields


def graph_of(fields: Any) -> Any:
    from hysteron_tgraphs.model import make_graph  # pyright: ignore[reportMissingImports]

    return make_graph(fields)


def share(theirs: Any, ours: Any) -> float:
    """How many of its transitions lead where ours do."""
    agreed: list[bool] = []
    for state, direction in theirs:
        way = ours.transition("".join(map(str, state)), direction)
        target = "".join(str(int(s)) for s in theirs[state, direction].final_state)
        agreed.append(way is not None and way[0] == target)
    return float(np.mean(agreed))


def fresh(chain: sw.Chain) -> Any:
    """A reading of a graph that was not read before, the graph's own time included."""
    return chain.graph("force").reading


def timed(work: Callable[[], object], times: int) -> float:
    """Median time [s]; what an earlier run left behind is cleared away first."""
    taken: list[float] = []
    for _ in range(times):
        gc.collect()
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    return statistics.median(taken)


def nested(cells: int) -> sw.Chain:
    """d_x evenly over 10..30 mm in random order: every pair of loops is nested."""
    x = np.random.default_rng(0).permutation(np.linspace(0.010, 0.030, cells))
    return sw.Chain([sw.Cell(sw.Band((0.0, 0.0), (float(v), 0.0))) for v in x])


def scattered(cells: int) -> sw.Chain:
    """Anchors at random: all states stand at some force, few are reached from all cells at 0."""
    rng = np.random.default_rng(0)
    x, y = rng.uniform(0.010, 0.030, cells), rng.uniform(-0.005, 0.005, cells)
    anchors = zip(x.tolist(), y.tolist(), strict=True)
    return sw.Chain([sw.Cell(sw.Band((0.0, 0.0), anchor)) for anchor in anchors])


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row))
