"""`stepwell robot`: what a robot is made of, and what it does when that is changed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.base import require
from stepwell.cli.options import Force, Json, Out, Range, Robot, free, local, read_range, read_robot
from stepwell.cli.screen import EXIT_CODES, Progress, progress, report, styled, usable

if TYPE_CHECKING:
    import stepwell.robot as values
    from stepwell.simulation import Sweep

commands = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="rich" if styled() else None,
    help="Compute a robot's gait by statics, vary its numbers, or check its time step.",
    epilog=EXIT_CODES,
)


@commands.command(epilog=EXIT_CODES)
def show(robot: Robot, out: Out = None, force: Force = False, as_json: Json = False) -> None:
    """List a robot's numbers with their sources, and predict its gait by statics.

    The prediction needs no simulation. With --out, drawings from above and the side, the
    prediction and all numbers as JSON are written into a folder, together with the design.
    """
    from stepwell.accounts import About, account

    text, design = read_robot(robot)
    free(out, "robot show", force, robot=text)
    report(account(design.predict(), About(text, robot)), as_json, out, force)


@commands.command(epilog=EXIT_CODES)
def sweep(
    robot: Robot,
    ranges: Annotated[
        list[str],
        typer.Argument(
            metavar="KEY=FROM:TO:COUNT...",
            help="What to vary, by the keys that `stepwell robot show` lists, in their units.",
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            "-o",
            metavar="DIR",
            help="Write the results into this folder.",
            file_okay=False,
            callback=local,
        ),
    ],
    random: Annotated[
        int | None,
        typer.Option(
            "--random",
            metavar="N",
            help="Draw N robots instead of a grid; ranges are then KEY=FROM:TO.",
            min=1,
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the draws.", min=0)] = 0,
    cycles: Annotated[int, typer.Option(help="How many cycles each robot walks.", min=1)] = 4,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Simulate the walk of a robot for many values of its numbers, on all cores.

    A grid over all ranges, or seeded random draws. An interrupted sweep resumes when the same
    command is run again. Table (CSV), data (NetCDF), JSON and a figure are
    written into the folder.
    """
    from stepwell.accounts import About, account

    text, design = read_robot(robot)
    free(out, "robot sweep", force)
    values = _points(_ranges(ranges, random), random, seed)
    seeds = {"values": seed if random else None}
    keep = out / "unfinished"
    kept = "the robots that are done are kept, and the same command goes on with the others"
    with usable("--out"), progress("robots", kept=kept) as tell:
        result = _swept(design, robot, values, cycles, keep, tell)
    report(account(result, About(text, robot, seeds=seeds)), as_json, out, force)
    _forget(keep)


@commands.command(epilog=EXIT_CODES)
def converge(
    robot: Robot,
    cycles: Annotated[
        int, typer.Option("--cycles", help="How many cycles each walk lasts.", min=2)
    ] = 2,
    as_json: Json = False,
) -> None:
    """Simulate a walk at several time steps: deviations of advance, turn and floor forces.

    Ground reaction forces under feet and supports are compared with those at the smallest step.
    """
    from stepwell import simulation as physics
    from stepwell.accounts import About, account

    text, design = read_robot(robot)
    with usable(robot), progress("walking") as tell:
        found = physics.convergence(design, cycles=cycles, progress=tell)
    report(account(found, About(text, robot)), as_json)


def _ranges(texts: Sequence[str], drawn: int | None) -> list[Range]:
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


def _points(found: Sequence[Range], drawn: int | None, seed: int) -> dict[str, list[float]]:
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


def _swept(
    robot: values.Robot,
    name: str,
    values: Mapping[str, Sequence[float]],
    cycles: int,
    keep: Path,
    progress: Progress | None,
) -> Sweep:
    """Every robot walked; one that cannot exist has no numbers, and its `stopped` says why."""
    from stepwell import files, simulation

    count = len(next(iter(values.values())))
    made: dict[int, values.Robot] = {}
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


def _forget(keep: Path) -> None:
    """Remove what was kept of a sweep that is written."""
    for file in (*keep.glob("part-*.json"), keep / "sweep.json"):
        file.unlink(missing_ok=True)
    if keep.is_dir() and not any(keep.iterdir()):
        keep.rmdir()
