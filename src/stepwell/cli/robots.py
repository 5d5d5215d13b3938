"""`stepwell robot`, `walk`, `maze`, `export` and `view`: robots by statics and simulated."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import typer

import stepwell as sw
from stepwell.base import require
from stepwell.cli import options, screen
from stepwell.cli.options import argument, flag, option
from stepwell.cli.ranges import Range, read_range

commands = screen.subcommands(
    "Compute a robot's gait by statics, vary its numbers, or check its time step."
)


@options.command(commands)
def show(robot: options.Robot, output: options.Output) -> None:
    """List a robot's numbers with their sources, and predict its gait by statics.

    The prediction needs no simulation. With --out, drawings from above and the side, the
    prediction and all numbers as JSON are written into a folder, together with the design.

    Example: stepwell robot show robot-forward
    """
    text, design = options.read_robot(robot)
    output.check_output_folder("robot show", robot=text)
    output.report(design.predict(), text, robot)


@options.command(commands)
def sweep(
    robot: options.Robot,
    ranges: list[str] = argument(
        "What to vary, by the keys that `stepwell robot show` lists, in their units.",
        "KEY=FROM:TO:COUNT...",
    ),
    random: int | None = option(
        "Draw N robots instead of a grid; ranges are then KEY=FROM:TO.", "--random N", min=1
    ),
    seed: int = option("Of the draws.", default=0, min=0),
    cycles: int = option("How many cycles each robot walks.", default=4, min=1),
    *,
    output: options.Folder,
) -> None:
    """Simulate the walk of a robot for many values of its numbers, on all cores.

    A grid over all ranges, or seeded random draws. An interrupted sweep resumes when the same
    command is run again. Table (CSV), data (NetCDF), JSON and a figure are
    written into the folder.

    Example: stepwell robot sweep robot-forward foot.below_mm=0.6:1.0:5 --out feet
    """
    text, design = options.read_robot(robot)
    output.check_output_folder("robot sweep")
    values = _points(_ranges(ranges, random), random, seed)
    seeds = {"values": seed if random else None}
    keep = output.out / "unfinished"
    kept = "the robots that are done are kept, and the same command goes on with the others"
    with screen.usable("--out"), screen.progress("robots", kept=kept) as tell:
        result = _swept(design, robot, values, cycles, keep, tell)
    output.report(result, text, robot, seeds=seeds)
    _forget(keep)


@options.command(commands)
def converge(
    robot: options.Robot,
    cycles: int = option("How many cycles each walk lasts.", "--cycles", default=2, min=2),
    as_json: options.Json = False,
) -> None:
    """Simulate a walk at several time steps: deviations of advance, turn and floor forces.

    Ground reaction forces under feet and supports are compared with those at the smallest step.

    Example: stepwell robot converge robot-forward
    """
    text, design = options.read_robot(robot)
    with screen.usable(robot), screen.progress("walking") as tell:
        found = sw.simulation.convergence(design, cycles=cycles, progress=tell)
    screen.report(sw.accounts.account(found, sw.accounts.About(text, robot)), as_json)


def _ranges(texts: Sequence[str], drawn: int | None) -> list[Range]:
    """KEY=FROM:TO:COUNT each, or KEY=FROM:TO where `drawn` values are drawn."""
    found = [_range(text, drawn) for text in texts]
    for key, count in Counter(one.name for one in found).items():
        if count > 1:
            raise typer.BadParameter(f"{key} is there twice: give each key one range.")
    total = (drawn or 1) * math.prod(one.count or 1 for one in found)
    with screen.usable():
        require("robots", total, "these are")
    return found


def _points(found: Sequence[Range], drawn: int | None, seed: int) -> dict[str, list[float]]:
    import numpy as np

    if drawn is None:
        columns = np.meshgrid(*(one.values() for one in found), indexing="ij")
    else:
        # A robot a row, so that asking for more robots keeps the first ones as they are.
        shares = np.random.default_rng(seed).random((drawn, len(found))).T
        columns = [
            one.start + (one.stop - one.start) * s for one, s in zip(found, shares, strict=True)
        ]
    # What a file holds is decimal: 0.1 and not 0.1 and a rounding error.
    return {
        one.name: [float(f"{value:.12g}") for value in column.ravel()]
        for one, column in zip(found, columns, strict=True)
    }


def _range(text: str, drawn: int | None) -> Range:
    example = "chain.cell.outer.q_mm[0]=5:20" + ("" if drawn else ":4")
    found = read_range(text, "KEY=FROM:TO with --random" if drawn else "KEY=FROM:TO:COUNT", example)
    if not (abs(found.start) <= 1e9 and abs(found.stop) <= 1e9) or found.start == found.stop:
        raise typer.BadParameter(f"{text!r}: must go from one number to another, within ±1e9.")
    return found


def _swept(
    robot: sw.robot.Robot,
    name: str,
    values: Mapping[str, Sequence[float]],
    cycles: int,
    keep: Path,
    progress: screen.Shows | None,
) -> sw.simulation.Sweep:
    """Every robot walked; one that cannot exist has no numbers, and its `stopped` says why."""
    made: list[sw.robot.Robot | sw.files.DesignError] = []
    for numbers in zip(*values.values(), strict=True):
        try:
            made.append(sw.files.vary(robot, dict(zip(values, numbers, strict=True))))
        except sw.files.DesignError as error:
            made.append(error)
    robots = [one for one in made if isinstance(one, sw.robot.Robot)]
    if not robots:
        raise sw.files.DesignError(name, made[0].problems)  # type: ignore[union-attr]
    done = iter(sw.simulation.sweep(robots, cycles=cycles, keep=keep, progress=progress).trials)
    none, gaits = math.nan, ("",) * len(robot.legs)
    trials = (
        next(done)
        if isinstance(one, sw.robot.Robot)
        else sw.simulation.Trial(none, none, none, gaits, none, "; ".join(one.problems))
        for one in made
    )
    return sw.simulation.Sweep(values, tuple(trials))


def _forget(keep: Path) -> None:
    """Remove what was kept of a sweep that is written, and its folder if nothing else is there."""
    for file in (*keep.glob("part-*.json"), keep / "sweep.json"):
        file.unlink(missing_ok=True)
    with suppress(OSError):
        keep.rmdir()


def walk(
    robot: options.Robot,
    cycles: float = option("How often the actuator goes out and back.", default=8, min=0.01),
    *,
    output: options.FilmedOutput,
) -> None:
    """Simulate a walk on a flat floor: gaits, advance, turn and cost of transport.

    The actuator's position is the only command; gaits emerge from bands, weight and contact.
    With --out, figures, samples as NetCDF, the result as JSON and a video (MP4 and GIF) are
    written into a folder, together with the design.

    Example: stepwell walk robot-forward --cycles 4
    """
    text, design = options.read_robot(robot)
    output.check_output_folder("walk", robot=text)
    with screen.usable(robot), screen.progress("walking") as tell:
        result = sw.simulation.walk(design, cycles, progress=tell)
    output.report(result, text, robot)
    screen.stopped(result.stopped)


def _list(wanted: bool) -> None:
    if wanted:
        rows = sw.files.arenas().items()
        screen.show_table("Arenas", ["name", "what it is"], rows, left=(0, 1))
        raise typer.Exit


class Course(options.Group):
    """Where a robot walks, from where and for how long."""

    arena: str = argument(
        "An arena's name (--list shows them), or a file of your own (.toml, .txt).",
        "ARENA",
        autocompletion=options.arenas,
    )
    limit: float = option("Time it is given [s].", default=600.0, min=1)
    start_seed: int | None = option(
        "Start up to 40 mm and 10° elsewhere, drawn from this seed.", min=0
    )
    layout_seed: int | None = option("Move walls up to 40 mm and 8°, drawn from this seed.", min=0)

    def read(self) -> sw.robot.Arena:
        """The arena, with its walls and its start moved."""
        arena = sw.files.load_arena(self.arena)
        if self.layout_seed is not None:
            with screen.usable("--layout-seed"):
                arena = sw.robot.other_layout(arena, self.layout_seed)
        if self.start_seed is not None:
            with screen.usable("--start-seed"):
                arena = sw.robot.other_start(arena, self.start_seed)
        return arena


class Control(options.Group):
    """What is taken off a robot, as a control."""

    disconnect: bool = flag("Take the antennas' levers off the anchors.", "--disconnect")
    no_antennas: bool = flag("Take the antennas off altogether.", "--no-antennas")

    def of(self, robot: sw.robot.Robot) -> sw.robot.Robot:
        """The robot as given, or one of the two controls."""
        if not (self.disconnect or self.no_antennas):
            return robot
        option = "--no-antennas" if self.no_antennas else "--disconnect"
        if self.disconnect and self.no_antennas:
            raise screen.wrong(None, f"{option} leaves no lever to take off: give one of the two.")
        if not robot.antennas:
            raise screen.wrong(option, "this robot has no antennas.")
        off = tuple(replace(one, connected=False) for one in robot.antennas)
        return replace(robot, antennas=() if self.no_antennas else off)


def maze(
    robot: options.Robot,
    course: Course,
    control: Control,
    output: options.FilmedOutput,
    _: bool = flag("List the arenas that come along.", "--list", callback=_list, is_eager=True),
) -> None:
    """Simulate a robot in an arena: whether it reaches the goal, and what it touches.

    It walks until it reaches the goal, gets nowhere any more, or runs out of time; nothing
    steers it but its antennas. --disconnect and --no-antennas are the controls: the same
    robot without what reprograms its legs. With --out, figures, samples as NetCDF, the result
    as JSON and a video (MP4 and GIF) are written into a folder, together with both designs.

    Example: stepwell maze robot-explorer three-walls
    """
    text, given = options.read_robot(robot)
    design = control.of(given)
    seeds = {"start_seed": course.start_seed, "layout_seed": course.layout_seed}
    output.check_output_folder("maze")
    place = course.read()
    with screen.usable(robot), screen.progress("walking") as tell:
        result = sw.simulation.maze(design, place, limit=course.limit, progress=tell)
    output.report(result, text if design is given else design, robot, seeds=seeds)
    screen.stopped(result.walk.stopped)


NO_DISPLAY = (
    "There is no display here, and the viewer is a window. `stepwell walk` and `stepwell maze` "
    "write videos without one; `stepwell export` writes a model to look at elsewhere."
)


def export(
    robot: options.Robot,
    out: Path = option(
        "The file to write.",
        "--out -o FILE.xml",
        default=Path("robot.xml"),
        show_default=False,
        callback=options.local,
    ),
    arena: options.Arena = None,
    force: options.ForceFile = False,
) -> None:
    """Export a robot as MJCF, the format of MuJoCo.

    MuJoCo's own viewer opens it and shows bands, levers, links and antennas. In its keyframe
    `start` the robot stands on the floor with every cell at 0.

    Example: stepwell export robot-forward --out robot.xml
    """
    options.free_file(out, force)
    _, design = options.read_robot(robot)
    place = sw.files.load_arena(arena) if arena is not None else None
    with screen.usable(robot):
        text = sw.simulation.mjcf(design, place)
    sw.files.write_atomic(out, text)
    screen.show_verbatim(f"Wrote {out}")


def view(robot: options.Robot, arena: options.Arena = None) -> None:
    """Simulate a robot in MuJoCo's viewer.

    The viewer needs a display. The actuator follows its command, and the mouse can push the robot.

    Example: stepwell view robot-forward
    """
    _, design = options.read_robot(robot)
    place = sw.files.load_arena(arena) if arena is not None else None
    if not screen.has_display():
        typer.echo(NO_DISPLAY, err=True)
        raise typer.Exit(1)
    with screen.usable(robot):
        _show(design, place)


def command(robot: sw.robot.Robot, settle: float) -> Callable[[Any, Any], None]:
    """What MuJoCo calls at every step: the stroke wanted at that time, 0 while it settles."""

    def control(_model: Any, data: Any) -> None:
        data.ctrl[0] = robot.drive.stroke(data.time - settle)

    return control


def model(robot: sw.robot.Robot, arena: sw.robot.Arena | None) -> tuple[Any, Any]:
    """The compiled model, and its data standing at the start."""
    compiled = sw.simulation.spec(robot, arena).compile()
    data = sw.simulation.mujoco.MjData(compiled)
    sw.simulation.mujoco.mj_resetDataKeyframe(compiled, data, 0)
    return compiled, data


def _show(robot: sw.robot.Robot, arena: sw.robot.Arena | None) -> None:
    viewer = import_module("mujoco.viewer")
    compiled, data = model(robot, arena)
    sw.simulation.mujoco.set_mjcb_control(command(robot, sw.simulation.Settings().settle))
    try:
        viewer.launch(compiled, data)
    finally:
        sw.simulation.mujoco.set_mjcb_control(None)
