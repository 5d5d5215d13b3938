"""`stepwell walk`: a robot simulated on a bare floor."""

from functools import partial
from typing import Annotated

import typer

from stepwell.cli.options import Force, Json, NoVideo, Out, Robot, free, read_robot
from stepwell.cli.robots.video import with_video
from stepwell.cli.screen import finish, progress, stopped, usable

_Cycles = Annotated[float, typer.Option(help="How often the actuator goes out and back.", min=0.01)]


def walk(
    robot: Robot,
    cycles: _Cycles = 8,
    out: Out = None,
    no_video: NoVideo = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Let a robot walk, and say how.

    The actuator's position is the only command; gaits emerge from bands, weight and contact.
    With --out, figures, samples as NetCDF, the result as JSON and a video (MP4 and GIF) are
    written into a folder, together with the design.
    """
    from stepwell import reports, results, simulation
    from stepwell.cli.text import robots as texts

    text, design = read_robot(robot)
    free(out, "walk", force, robot=text)
    with usable(robot), progress("walking") as tell:
        result = simulation.walk(design, cycles, progress=tell)
    record = results.walk_record(result, design=text)
    write = partial(reports.write_walk, design=text)
    write = partial(write, result) if no_video else with_video(write, result, "walk")
    finish(record, texts.walk, as_json, out, force, write)
    stopped(result.stopped)
