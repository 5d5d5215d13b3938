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
        alone = run[:3]
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
        spent, least = (processor(command) for command in (alone, [STEPWELL, "--version"]))
        return [
            *((what, f"{timed(command):.2f} s", wanted) for what, command, wanted in found),
            (
                "stepwell run, a preset, of processor time",
                f"{spent:.2f} s, {spent / least:.1f} times `--version`, {modules()} modules",
                "at most 0.5 s",
            ),
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


def processor(command: list[str]) -> float:
    """Least processor time of five runs after one that warms up [s]."""
    settings, taken = {**os.environ, "STEPWELL_KERNELS": "auto"}, []
    for _ in range(6):
        before = os.times()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=settings)
        after = os.times()
        taken.append(sum(after[2:4]) - sum(before[2:4]))
    return min(taken[1:])


def modules() -> int:
    """How many modules a run of a preset opens."""
    script = """
import sys
sys.argv[1:] = ["run", "preset:paper-forward"]
from stepwell.cli import main
try:
    main()
finally:
    print(len(sys.modules), file=sys.stderr)
"""
    settings = {**os.environ, "STEPWELL_KERNELS": "auto"}
    said = subprocess.run(
        [sys.executable, "-c", script], check=True, capture_output=True, text=True, env=settings
    )
    return int(said.stderr.split()[-1])


def timed(command: list[str]) -> float:
    """Median wall time of five runs after one that warms up [s]."""
    taken: list[float] = []
    for _ in range(6):
        start = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        taken.append(time.perf_counter() - start)
    return statistics.median(taken[1:])
