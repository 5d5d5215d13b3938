"""Time of whole commands, warm: what a user waits for."""

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
        return [(what, f"{timed(command):.2f} s", wanted) for what, command, wanted in found]


def timed(command: list[str]) -> float:
    """Median wall time of five runs after one that warms up [s]."""
    taken: list[float] = []
    for _ in range(6):
        start = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        taken.append(time.perf_counter() - start)
    return statistics.median(taken[1:])
