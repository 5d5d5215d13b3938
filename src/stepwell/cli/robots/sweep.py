"""The robots of a sweep: what is varied, and how each of them walks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from stepwell.base import require
from stepwell.cli.options import Range, read_range
from stepwell.cli.screen import Progress

if TYPE_CHECKING:
    from stepwell.robot import Robot
    from stepwell.simulation import Sweep


def read_ranges(texts: Sequence[str], drawn: int | None) -> list[Range]:
    """KEY=FROM:TO:COUNT each, or KEY=FROM:TO where `drawn` values are drawn."""
    found = [_range(text, drawn) for text in texts]
    keys = [one.name for one in found]
    for key in keys:
        if keys.count(key) > 1:
            raise typer.BadParameter(f"{key} is there twice: give each key one range.")
    total = drawn or 1
    for one in found:
        total *= one.count or 1
    try:
        require("robots", total, "these are")
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    return found


def points(found: Sequence[Range], drawn: int | None, seed: int) -> dict[str, list[float]]:
    """For each key its value in every robot."""
    import numpy as np

    if drawn is not None:
        rng = np.random.default_rng(seed)
        # A robot a row, so that asking for more robots keeps the first ones as they are.
        shares = rng.random((drawn, len(found)))
        columns = [
            one.start + (one.stop - one.start) * share
            for one, share in zip(found, shares.T, strict=True)
        ]
    else:
        axes = np.meshgrid(*(one.values() for one in found), indexing="ij")
        columns = [axis.ravel() for axis in axes]
    # What a file holds is decimal: 0.1 and not 0.1 and a rounding error.
    return {
        one.name: [float(f"{value:.12g}") for value in column]
        for one, column in zip(found, columns, strict=True)
    }


def _range(text: str, drawn: int | None) -> Range:
    example = "chain.cell.outer.q_mm[0]=5:20" + ("" if drawn else ":4")
    found = read_range(text, "KEY=FROM:TO with --random" if drawn else "KEY=FROM:TO:COUNT", example)
    if not (abs(found.start) <= 1e9 and abs(found.stop) <= 1e9) or found.start == found.stop:
        raise typer.BadParameter(f"{text!r}: must go from one number to another, within ±1e9.")
    return found


def run(
    robot: Robot,
    name: str,
    values: Mapping[str, Sequence[float]],
    cycles: int,
    keep: Path,
    progress: Progress | None,
) -> Sweep:
    """Walk the robot with each set of values.

    Args:
        robot: any robot.
        name: what its user calls it.
        values: key path to its value in each trial (n,).
        cycles: of each walk.
        keep: folder that holds finished robots until all are done.
        progress: called with (done, total) robots.

    Returns:
        The sweep; a robot that cannot exist has no numbers, and its `stopped` says why.

    Raises:
        DesignError: a key that this robot does not have, or no robot that can exist.
        ValueError: what `simulation.sweep` refuses.
    """
    from stepwell import files, simulation

    count = len(next(iter(values.values())))
    made: dict[int, Robot] = {}
    wrong: dict[int, files.DesignError] = {}
    for i in range(count):
        try:
            made[i] = files.vary(robot, {key: numbers[i] for key, numbers in values.items()})
        except files.DesignError as error:
            wrong[i] = error
    if not made:
        raise files.DesignError(name, wrong[0].problems)
    done = simulation.sweep(list(made.values()), cycles=cycles, keep=keep, progress=progress)
    trials = dict(zip(made, done.trials, strict=True))
    nothing, gaits = float("nan"), ("",) * len(robot.legs)
    for i, error in wrong.items():
        why = "; ".join(error.problems)
        trials[i] = simulation.Trial(nothing, nothing, nothing, gaits, nothing, why)
    return simulation.Sweep(values, tuple(trials[i] for i in range(count)))


def forget(keep: Path) -> None:
    """Remove what was kept of a sweep that is written."""
    for file in (*keep.glob("part-*.json"), keep / "sweep.json"):
        file.unlink(missing_ok=True)
    if keep.is_dir() and not any(keep.iterdir()):
        keep.rmdir()
