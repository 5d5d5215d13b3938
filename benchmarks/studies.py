"""What a study costs beside its designs: on one core, on two, of few designs and of many.

The work is a function of one's own that burns a second of a processor. Times of few tasks are taken
off those of many, so that what is left is the cost of a task, without that of beginning.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

import stepwell as sw
from stepwell.concave import STROKE
from stepwell.studies import (
    Axis,
    Space,
    atlas_blocks as blocks,
    begun,
    function_of,
    mapped_on,
    packed,
    planned_study,
    sweep,
)
from stepwell.studies.blocks import block_row
from stepwell.studies.fill import columns_of

_BURN = """
import time
def burn(chain, seed):
    end = time.process_time() + 1.0
    x = 0.5
    while time.process_time() < end:
        for _ in range(10_000):
            x = 3.7 * x * (1.0 - x)
    return {"x": x}
"""
_BARE = """
import sys
sys.path.insert(0, {home!r})
import burning
for _ in range({n}):
    burning.burn(None, 0)
"""
_FEW, _MANY = 2, 8
_RUNS = 5
_CHUNK = 64
_SIZES = 10**3, 10**5, 10**7
_TIMED = 3 * 10**5
_PAPER = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))


class _Task(NamedTuple):
    """What a task takes [s]: of the clock, and of processors in all."""

    clock: float
    cores: float


def rows(sizes: Sequence[int] = _SIZES) -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        (home / "burning.py").write_text(_BURN, encoding="utf-8")
        # Each beside its like, again and again, so that whatever else is at work here meets both.
        runs = [
            [
                _each(way, home, workers)
                for way, workers in ((_bare, 1), (_swept, 1), (_bare, 2), (_swept, 2))
            ]
            for _ in range(_RUNS)
        ]
    more = [one.cores / bare.cores - 1 for bare, one, _, _ in runs]
    later = [one.clock / bare.clock - 1 for bare, one, _, _ in runs]
    share = [bare.clock / two.clock for _, _, bare, two in runs]
    rates = [(designs, _rate(2, designs)) for designs in sizes]
    three = _rate(3, 10**5)
    return [
        (
            "a task of 1 s in a study, beside the same in a bare process",
            f"{_told(more, 100, '.1f')} % more of a core, {_told(later, 100, '.1f')} % later",
            "at most 5 %",
        ),
        (
            "two workers of a study, beside two bare processes",
            f"{_told(share, 1, '.3f')} of their work",
            "at least 0.95",
        ),
        *(
            (
                f"two cells in closed form, {designs:.0e} designs, one core",
                f"{rate / 1e6:.2f} million a second",
                "at least 1 million",
            )
            for designs, rate in rates
        ),
        ("three cells by stroke, one core", f"{three / 1e3:.0f} thousand a second", "-"),
        *constants(),
    ]


def _told(values: Sequence[float], factor: float, digits: str) -> str:
    """The median of what repeated runs gave, and the least and the largest."""
    middle, *ends = (f(values) * factor for f in (statistics.median, min, max))
    return f"{middle:{digits}} ({ends[0]:{digits}} to {ends[1]:{digits}} in {len(values)} runs)"


def constants() -> list[tuple[str, str, str]]:
    """What the growth of a cluster hangs on: docs/decisions/studies.md reckons with it."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        axes = (Axis("1.q.x", 0.005, 0.015, 10 * _CHUNK),)
        study = begun(
            planned_study(sw.Chain([_PAPER]), "cycle", Space(axes), home / "s.zarr", chunk=_CHUNK)
        )
        columns = [columns_of(study, chunk) for chunk in range(study.chunks)]
        start = time.perf_counter()
        for chunk, found in enumerate(columns):
            study.write(chunk, found)
        each = (time.perf_counter() - start) / study.chunks
        size = sum(file.stat().st_size for file in (home / "s.zarr").rglob("c/*"))
        calls = _calls(home, 2000)
    return [
        ("calls that do nothing, through a scheduler", f"{calls:.0f} a second", "-"),
        (
            f"a chunk of {_CHUNK} cycles written and synced, {len(study.columns)} files",
            f"{each * 1e3:.1f} ms, {size / study.chunks / 1e3:.1f} kB",
            "-",
        ),
    ]


def _calls(home: Path, count: int) -> float:
    """Calls that do nothing that one worker with two threads ends in a second."""
    file = home / "scheduler.json"
    options = ["--no-dashboard", "--scheduler-file", str(file)]
    going = [
        subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{what}", *options, *more],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for what, more in (
            ("scheduler", ["--host", "127.0.0.1", "--port", "0"]),
            ("worker", ["--nthreads", "2", "--no-nanny", "--local-directory", str(home)]),
        )
    ]
    try:
        while not file.exists():
            time.sleep(0.05)
        address = json.loads(file.read_text("utf-8"))["address"]
        ended = mapped_on(address, abs, ((-1,) for _ in range(count)))
        next(ended)
        start = time.perf_counter()
        assert all(raised is None for _, raised in ended)
        return count / (time.perf_counter() - start)
    finally:
        for one in going:
            one.kill()
            one.wait()


def _each(way, home: Path, workers: int) -> _Task:
    """What a task takes, a worker."""
    taken = []
    for tasks in (_FEW, _MANY):
        start, spent = time.perf_counter(), sum(os.times()[:4])
        way(home, tasks * workers, workers)
        taken.append((time.perf_counter() - start, sum(os.times()[:4]) - spent))
    clock, cores = np.subtract(taken[1], taken[0]) / (_MANY - _FEW)
    return _Task(clock, cores / workers)


def _swept(home: Path, tasks: int, workers: int) -> None:
    chain = sw.Chain([_PAPER])
    given = function_of(f"{home / 'burning.py'}:burn", chain)
    space = Space((Axis("1.q.x", 0.005, 0.015, tasks),))
    with tempfile.TemporaryDirectory(dir=home) as store:
        sweep(chain, "call", space, Path(store) / "s", given=given, chunk=1, workers=workers)


def _bare(home: Path, tasks: int, workers: int) -> None:
    code = _BARE.format(home=str(home), n=tasks // workers)
    going = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(workers)]
    assert all(one.wait() == 0 for one in going)


def _rate(cells: int, designs: int) -> float:
    """Designs of chains that one core classifies in a second, drawn and counted."""
    chain = sw.Chain([_PAPER] * cells)
    axes = tuple(
        Axis(f"{cell}.{part}", *ends)
        for cell in range(1, cells + 1)
        for part, ends in {
            "q.x": (0.0, 0.020),
            "q.y": (-0.015, 0.015),
            "stiffness": (28.5, 57.0),
        }.items()
    )
    numbers = packed(chain, [axis.name for axis in axes])
    made = [block for _, block in _blocks(cells, axes, designs).made(chain, 0, 1)]
    count = _blocks(cells, axes, designs).count
    block_row(made[0]._replace(size=1000), numbers, STROKE)
    # Few designs again and again: a millisecond is no measure.
    again = max(1, _TIMED // designs)
    start = time.process_time()
    for _ in range(again):
        for _, block in _blocks(cells, axes, designs).made(chain, 0, count):
            block_row(block, numbers, STROKE)
    return again * designs / (time.process_time() - start)


def _blocks(cells: int, axes: tuple[Axis, ...], designs: int):
    return blocks(cells, axes, designs, 0)


if __name__ == "__main__":
    # Other numbers of designs than these may be named.
    for row in rows([int(float(word)) for word in sys.argv[1:]] or _SIZES):
        print(": ".join(row))
