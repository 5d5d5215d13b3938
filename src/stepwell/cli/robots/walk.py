"""`stepwell walk`: a robot simulated on a bare floor."""

from typing import Annotated

import typer

from stepwell.cli.options import Force, Json, NoVideo, Out, Robot, named, usable

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
    from stepwell import files, reports, results, simulation
    from stepwell.cli.options import free
    from stepwell.cli.robots.video import film
    from stepwell.cli.screen import progress, show_result, stopped
    from stepwell.cli.text import walk as _walk_text

    source = named(robot)
    text = files.read(source)
    design = files.loads_robot(text, source)
    free(out, "walk", force, robot=text)
    with usable(robot), progress("walking") as tell:
        result = simulation.walk(design, cycles, progress=tell)
    names: tuple[str, ...] = ()
    if out is not None:
        with progress("writing") as tell:
            names = reports.write_walk(
                result,
                out,
                design=text,
                film=None if no_video else film(result, "walk", tell),
                progress=tell,
                force=force,
            )
    record = results.walk_record(result, design=text)
    show_result(record, _walk_text.show, as_json, out, names)
    stopped(result.stopped)
