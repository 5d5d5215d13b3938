"""Recordings: time and memory of a million rows, odd forms of one test, phases of known curves.

`python benchmarks/recordings.py 2500` tries 2,500 odd forms. Phases of known curves are printed by
`python tests/lab/known_curves.py 200 0`.
"""

import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from stepwell import lab

known_curves = import_module("lab.known_curves")
exports = import_module("lab.test_exports")

ROWS = 1_000_000
FORMS, SEED = 500, 0
SNAPS = 60

# What a process of its own does with the file that its arguments name.
_READ = "from stepwell import lab; lab.read(sys.argv[1])"
_ELEMENT = "from stepwell import lab; lab.measure_element(lab.read(sys.argv[1]))"
_TABLE = (
    "from stepwell.files import load_element; load_element(sys.argv[1], half='loading', noise=0.01)"
)
_TIMED = """
import resource, sys, time
start = time.process_time()
{}
taken = time.process_time() - start
print(taken, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / {})
"""


def rows(forms: int = FORMS) -> list[tuple[str, str, str]]:
    """What was timed or counted, what came out, what is wanted."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "long.csv"
        _written(file)
        timed = [
            (f"{ROWS:,} rows, {what}", _measured(code, file), "at most 3 s, 400 MB")
            for what, code in (
                ("read", _READ),
                ("into a measured element", _ELEMENT),
                ("into the table of an element", _TABLE),
            )
        ]
    counts = odd(forms)
    found = known_curves.of_snaps(SNAPS, SEED)
    made, refused = known_curves.invented(SNAPS, SEED + 1)
    return [
        *timed,
        (
            f"{forms} odd forms of one test",
            f"{counts['right']} right, {counts['refused']} refused, {counts['wrong']} wrong",
            "0 wrong",
        ),
        (
            "known snaps in white noise to 5 % of the drop",
            f"{found.right} of {SNAPS} with their phases",
            "at least 97 %",
        ),
        (
            "monotone curves in white noise",
            f"{made} of {SNAPS} with a phase, {refused} refused",
            "0 with a phase",
        ),
    ]


def odd(count: int) -> Counter[str]:
    """How many odd forms of one test are read right, refused, and read wrongly."""
    counts: Counter[str] = Counter()

    @seed(SEED)
    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
        phases=[Phase.generate],
    )
    @given(exports.odd_forms())
    def tried(content: bytes) -> None:
        try:
            found = lab.read_bytes(content, "a.csv")
        except lab.LabError:
            counts["refused"] += 1
        else:
            counts["right" if exports.is_right(found) else "wrong"] += 1

    run: Callable[[], None] = tried
    run()
    return counts


def _written(file: Path) -> None:
    """A test with loading and unloading, and two peaks."""
    x = np.concatenate([np.linspace(0, 12, ROWS // 2), np.linspace(12, 0, ROWS // 2)])
    force = np.sin(x) + 0.3 * x + 0.01 * np.random.default_rng(SEED).standard_normal(ROWS)
    columns = np.arange(ROWS) / 1000, x, force
    lines = (f"{t:.3f},{u:.6f},{f:.5f}\n" for t, u, f in zip(*columns, strict=True))
    with file.open("w", encoding="utf-8") as out:
        out.write("Time (s),Displacement (mm),Force (N)\n")
        out.writelines(lines)


def _measured(code: str, file: Path) -> str:
    """Processor time and peak memory of a process of its own, imports included."""
    # The largest resident set is in bytes on macOS, else in kilobytes.
    per_mb = 1 << (20 if sys.platform == "darwin" else 10)
    program = _TIMED.format(code, per_mb)
    done = subprocess.run(
        [sys.executable, "-c", program, str(file)], capture_output=True, text=True, check=True
    )
    taken, peak = map(float, done.stdout.split())
    return f"{taken:.1f} s of processor time, {peak:.0f} MB"


if __name__ == "__main__":
    for row in rows(int(sys.argv[1]) if sys.argv[1:] else FORMS):
        print(" | ".join(row))
