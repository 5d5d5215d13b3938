"""Time of whole commands, warm and on a fresh install: what a user waits for."""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STEPWELL = str(Path(sys.executable).parent / "stepwell")


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    with tempfile.TemporaryDirectory() as folder:
        run = [STEPWELL, "run", "preset:paper-forward", "--out", f"{folder}/out"]
        found = [
            ("import stepwell", [sys.executable, "-c", "import stepwell"], "under 0.5 s"),
            ("stepwell --help", [STEPWELL, "--help"], "under 0.7 s"),
            ("stepwell run, a preset with all figures", run, "under 4 s"),
        ]
        cycle = "import stepwell as sw; sw.preset('paper-forward').cycle()"
        first = [
            ("first leg.cycle(), nothing compiled", [sys.executable, "-c", cycle], "under 5 s"),
            ("stepwell run, nothing compiled", run[:3], "under 5 s"),
            ("stepwell map, nothing compiled", [STEPWELL, "map", run[2]], "under 20 s"),
            ("stepwell walk, nothing compiled", [STEPWELL, "walk", "robot-forward"], "under 20 s"),
        ]
        return [
            *((what, f"{timed(command):.2f} s", wanted) for what, command, wanted in found),
            *((what, f"{cold(command):.2f} s", wanted) for what, command, wanted in first),
        ]


def cold(command: list[str]) -> float:
    """Wall time of one run that finds no compiled kernels [s]; the median of three."""
    taken: list[float] = []
    for _ in range(3):
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as kept:
            fresh = {**os.environ, "NUMBA_CACHE_DIR": kept, "STEPWELL_KERNELS": "auto"}
            start = time.perf_counter()
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=fresh)
            taken.append(time.perf_counter() - start)
    return statistics.median(taken)


def timed(command: list[str]) -> float:
    """Median wall time of five runs after one that warms up [s]."""
    taken: list[float] = []
    for _ in range(6):
        start = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        taken.append(time.perf_counter() - start)
    return statistics.median(taken[1:])
