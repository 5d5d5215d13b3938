"""`stepwell robot`: what a robot is made of, and what it does when that is changed."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import Force, Json, Out, Robot, free, read_robot
from stepwell.cli.robots import sweep as _sweep
from stepwell.cli.screen import EXIT_CODES, finish, progress, styled, usable

commands = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="rich" if styled() else None,
    help="Say what a robot is made of, or vary it.",
    epilog=EXIT_CODES,
)


@commands.command(epilog=EXIT_CODES)
def show(robot: Robot, out: Out = None, force: Force = False, as_json: Json = False) -> None:
    """Say what a robot is made of, and what statics says it will do.

    Every number with its unit and where it comes from, and the gait predicted without
    simulation. With --out, drawings from above and the side, the prediction and all numbers
    as JSON are written into a folder, together with the design.
    """
    from stepwell import reports, results
    from stepwell.cli.text import robots as texts

    text, design = read_robot(robot)
    free(out, "robot show", force, robot=text)
    prediction = design.predict()
    record = results.robot_record(design, prediction, design=text)
    write = partial(reports.write_robot, design, prediction, design=text)
    finish(record, texts.robot, as_json, out, force, write)


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
    """Vary a robot's numbers and walk every one that comes out, on all cores.

    A grid over all ranges, or seeded random draws. A sweep that was interrupted goes on where
    it stopped when it is called again. Table (CSV), data (NetCDF), JSON and a figure are
    written into the folder.
    """
    from stepwell import reports, results
    from stepwell.cli.text import robots as texts

    text, design = read_robot(robot)
    free(out, "robot sweep", force)
    values = _sweep.points(_sweep.read_ranges(ranges, random), random, seed)
    drawn = seed if random else None
    keep = out / "unfinished"
    kept = "the robots that are done are kept, and the same command goes on with the others"
    with usable("--out"), progress("robots", kept=kept) as tell:
        result = _sweep.run(design, robot, values, cycles, keep, tell)
    record = results.sweep_record(result, design=text, seed=drawn)
    write = partial(reports.write_sweep, result, design=text, seed=drawn)
    finish(record, texts.sweep, as_json, out, force, write)
    _sweep.forget(keep)


@commands.command(epilog=EXIT_CODES)
def converge(
    robot: Robot,
    cycles: Annotated[
        int, typer.Option("--cycles", help="How many cycles each walk lasts.", min=2)
    ] = 2,
    as_json: Json = False,
) -> None:
    """Walk a robot at several time steps and say what depends on them.

    What it does in a cycle, and what the floor carries under feet and supports, against the
    finest of them.
    """
    from stepwell import results, simulation as physics
    from stepwell.cli.text import robots as texts

    text, design = read_robot(robot)
    with usable(robot), progress("walking") as tell:
        found = physics.convergence(design, cycles=cycles, progress=tell)
    finish(results.convergence_record(found, design=text), texts.convergence, as_json)
