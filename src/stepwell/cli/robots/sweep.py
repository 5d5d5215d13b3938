"""Running the robots of a sweep, those that cannot exist told among the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stepwell.robot import Robot
    from stepwell.simulation import Sweep

Progress = Callable[[float, float], None]


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
