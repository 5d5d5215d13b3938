"""`stepwell robot`, `walk`, `maze`, `jump`, `export` and `view`: statics and simulation."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

import stepwell as sw
from stepwell.base import require
from stepwell.cli import options, screen
from stepwell.cli.options import argument, flag, option
from stepwell.cli.ranges import Range, read_range
from stepwell.cli.tolerances import BUILD_FILE, Seed, materials

commands = screen.subcommands(
    "Compute the gait of a robot by statics, vary its parameters, or check its time step."
)


@options.command(commands)
def show(robot: options.Robot, output: options.Output) -> None:
    """Compute the gait of a robot by statics, and list its parameters with their sources.

    The gait is computed without a simulation. The parameters are listed with --full. With --out,
    drawings (top and side view), the gait and all parameters as JSON are written into a folder,
    together with the design.

    Example: stepwell robot show robot-forward
    """
    text, design = options.read_robot(robot)
    output.check_output_folder("robot show", robot=text)
    with screen.progress("gait"):
        prediction = design.predict()
    output.report(prediction, text, robot)


class RandomDesigns(options.Group):
    """Options of random designs."""

    random: int | None = option(
        "N independent random designs, with ranges KEY=FROM:TO, instead of a grid.",
        "--random N",
        min=1,
    )
    seed: Seed = 0

    def points(self, ranges: Sequence[str]) -> dict[str, list[float]]:
        """Values of each key for all designs: a grid, or random ones."""
        return _points(_ranges(ranges, self.random), self.random, self.seed)


@options.command(commands)
def sweep(
    robot: options.Robot,
    ranges: list[str] = argument(
        "Parameter to vary: a key of `stepwell robot show --full`, with values in its unit; or a "
        "key of an arena's file after `arena.`, such as arena.slope.angle_deg, and "
        "arena.start_seed, the random seed of the start.",
        "KEY=FROM:TO:COUNT...",
    ),
    *,
    drawn: RandomDesigns,
    cycles: int = option(options.CYCLES, "N", default=4, min=1),
    arena: options.Arena = None,
    output: options.Folder,
) -> None:
    """Simulate the walk of a robot for many values of its parameters, in parallel.

    The values are a grid over all ranges, or random. The robot walks on a bare floor, or in an
    arena, whose numbers may be varied too: slope, steps, friction and start. To resume after an
    interruption, run the same command again. Table (CSV), data (NetCDF), JSON and a figure are
    written into the folder.

    Example: stepwell robot sweep robot-forward foot.below_mm=0.6:1.0:5 --out feet
    """
    text, design = options.read_robot(robot)
    output.check_output_folder("robot sweep")
    values = drawn.points(ranges)
    place = None if arena is None else sw.files.load_arena(arena)
    if place is None and any(key.startswith(_ARENA) for key in values):
        place = sw.robot.Arena(title="open floor")
    seeds = {"values": drawn.seed if drawn.random else None}
    keep = output.out / "unfinished"
    kept = "finished robots are kept; to resume, run the same command again"
    with screen.usable("--out"), screen.progress("robots", kept=kept) as tell:
        result = _swept((design, place), robot, values, cycles, keep, tell)
    output.report(result, text, robot, seeds=seeds)
    _forget(keep)


@options.command(commands)
def converge(
    robot: options.Robot,
    cycles: int = option(options.CYCLES, "N", default=2, min=2),
    *,
    display: options.Display,
) -> None:
    """Simulate a walk at several time steps: deviations of advance, turning and forces.

    Ground reaction forces of feet and supports are compared with those at the smallest time step.

    Example: stepwell robot converge robot-forward
    """
    text, design = options.read_robot(robot)
    with screen.usable(robot), screen.progress("walking") as tell:
        result = sw.simulation.convergence(design, cycles=cycles, progress=tell)
    display.report(result, text, robot)


@options.command(commands)
def ranges(
    robot: options.Robot,
    cycles: int = option(options.CYCLES, "N", default=2, min=2),
    *,
    display: options.Display,
) -> None:
    """Search the range of every assumed number in which the gait of a robot stays.

    Each number is changed alone, and the robot walks in the simulation. Numbers from the paper,
    from measurements or from parts are not changed.

    Example: stepwell robot ranges robot-forward
    """
    text, design = options.read_robot(robot)
    with screen.usable(robot), screen.progress("ranges") as tell:
        result = sw.paper.assumed_ranges(design, cycles=cycles, progress=tell)
    display.report(result, text, robot)


def _ranges(texts: Sequence[str], drawn: int | None) -> list[Range]:
    """Ranges KEY=FROM:TO:COUNT, or KEY=FROM:TO for `drawn` random values."""
    ranges = [_range(text, drawn) for text in texts]
    for key, count in Counter(one.name for one in ranges).items():
        if count > 1:
            raise typer.BadParameter(f"{key} is given twice: give each key one range.")
    total = (drawn or 1) * math.prod(one.count or 1 for one in ranges)
    with screen.usable():
        require("robots", total, "these are")
    return ranges


def _points(ranges: Sequence[Range], drawn: int | None, seed: int) -> dict[str, list[float]]:
    import numpy as np

    if drawn is None:
        columns = np.meshgrid(*(one.values() for one in ranges), indexing="ij")
    else:
        # One row per robot: with a larger N, the first robots stay the same.
        fractions = np.random.default_rng(seed).random((drawn, len(ranges))).T
        columns = [
            one.start + (one.stop - one.start) * s for one, s in zip(ranges, fractions, strict=True)
        ]
    # Values in files are decimal: 0.1 without its rounding error.
    return {
        one.name: [float(f"{value:.12g}") for value in column.ravel()]
        for one, column in zip(ranges, columns, strict=True)
    }


def _range(text: str, drawn: int | None) -> Range:
    example = "chain.cell.outer.q_mm[0]=5:20" + ("" if drawn else ":4")
    ends = read_range(text, "KEY=FROM:TO with --random" if drawn else "KEY=FROM:TO:COUNT", example)
    if not (abs(ends.start) <= 1e9 and abs(ends.stop) <= 1e9) or ends.start == ends.stop:
        raise typer.BadParameter(f"{text!r}: must be a range of two numbers within ±1e9.")
    return ends


_ARENA = "arena."  # beginning of the keys of an arena's file

_Entry: TypeAlias = "tuple[sw.robot.Robot, sw.robot.Arena | None]"


def _swept(
    nominal: _Entry,
    name: str,
    values: Mapping[str, Sequence[float]],
    cycles: int,
    keep: Path,
    progress: screen.Shows | None,
) -> sw.simulation.Sweep:
    """Results of all robots; for an invalid robot NaN, with the reason in `stopped`."""
    made: list[_Entry | sw.files.DesignError] = []
    for numbers in zip(*values.values(), strict=True):
        try:
            made.append(_varied(nominal, dict(zip(values, numbers, strict=True))))
        except sw.files.DesignError as error:
            made.append(error)
    entries = [one for one in made if isinstance(one, tuple)]
    if not entries:
        raise sw.files.DesignError(name, made[0].problems)  # type: ignore[union-attr]
    robots, arenas = zip(*entries, strict=True)
    arenas = None if nominal[1] is None else arenas
    result = sw.simulation.sweep(robots, arenas=arenas, cycles=cycles, keep=keep, progress=progress)
    done, none, gaits = iter(result.trials), math.nan, ("",) * len(nominal[0].legs)
    trials = (
        next(done)
        if isinstance(one, tuple)
        else sw.simulation.Trial(none, none, none, gaits, none, "; ".join(one.problems))
        for one in made
    )
    return sw.simulation.Sweep(values, tuple(trials), result.arena)


def _varied(nominal: _Entry, values: Mapping[str, float]) -> _Entry:
    """Robot and arena with these values of their keys."""
    robot, arena = nominal
    of_arena = {key: value for key, value in values.items() if key.startswith(_ARENA)}
    own = {key: value for key, value in values.items() if key not in of_arena}
    if arena is not None:
        ground = {key.removeprefix(_ARENA): value for key, value in of_arena.items()}
        try:
            arena = sw.files.vary_arena(arena, ground)
        except sw.files.DesignError as error:
            problems = [f"{_ARENA}{problem}" for problem in error.problems]
            raise sw.files.DesignError(error.name, problems) from None
    return sw.files.vary(robot, own), arena


def _forget(keep: Path) -> None:
    """Remove the partial results of a finished sweep, and their folder if it is empty."""
    for file in (*keep.glob("part-*.json"), keep / "sweep.json"):
        file.unlink(missing_ok=True)
    with suppress(OSError):
        keep.rmdir()


Material = Annotated[
    str | None,
    typer.Option(
        "--material",
        metavar=BUILD_FILE,
        help="Build file (TOML), or the name of a preset, for the robot as it is cut: acrylic-3mm, "
        "plywood-3mm, pla-3mm.",
        autocompletion=materials,
    ),
]


def _cut(robot: sw.robot.Robot, material: str | None) -> sw.robot.Robot:
    """The robot as given, or as it is cut from this material, which its title names."""
    if material is None:
        return robot
    with screen.usable("--material"):
        made = sw.build(robot, material).robot
    return replace(made, title=f"{robot.title or 'Robot'}, cut from {material}")


def walk(
    robot: options.Robot,
    cycles: float = option(options.CYCLES, "N", default=8, min=0.01),
    material: Material = None,
    *,
    output: options.FilmedOutput,
) -> None:
    """Simulate a walk on a flat floor: gaits, advance, turning and cost of transport.

    The only input is the position of the actuator; gaits follow from bands, weight and contact.
    With --material the robot has the masses and shapes of the parts that `stepwell build` cuts.
    With --out, figures, samples as NetCDF, the result as JSON and a video (MP4 and GIF) are
    written into a folder, together with the design.

    Example: stepwell walk robot-forward --cycles 4
    """
    text, design = options.read_robot(robot)
    output.check_output_folder("walk", robot=text)
    with screen.usable(robot), screen.progress("walking") as tell:
        result = sw.simulation.walk(_cut(design, material), cycles, progress=tell)
    output.report(result, text, robot)
    screen.stopped(result.stopped)


def jump(
    design: options.Design,
    jumps: int = option("Number of jumps in a row.", "N", default=1, min=1, max=100),
    *,
    output: options.FilmedOutput,
) -> None:
    """Simulate jumps of a hopper: energy, take-off, height, and the bound by statics.

    The design file has a table [hopper] with masses, actuator and task: a jump, the throw of a
    ball, or a blow. A hopper that cannot do its task is refused before the simulation. With --out,
    figures, samples as CSV, the result as JSON and a video (MP4 and GIF) are written into a folder,
    together with the design.

    Example: stepwell jump hopper
    """
    text, hopper = options.read_hopper(design)
    output.check_output_folder("jump", design=text)
    with screen.usable(design), screen.progress("jumping") as tell:
        result = sw.simulation.jump(hopper, jumps, progress=tell)
    output.report(result, text, design)


def _list(wanted: bool) -> None:
    if wanted:
        rows = sw.files.arenas().items()
        screen.show_table("Arenas", ["name", "description"], rows, left=(0, 1))
        raise typer.Exit


class Course(options.Group):
    """Arena, start and time limit of a walk."""

    arena: str = argument(options.ARENA_HELP, "ARENA", autocompletion=options.arenas)
    limit: float = option(options.TIME_LIMIT, "S", default=600.0, min=1)
    start_seed: int | None = option(
        "Random seed of the start: shift it by up to 40 mm and 10°.", "N", min=0
    )
    layout_seed: int | None = option(
        "Random seed of the walls: shift them by up to 40 mm and 8°.", "N", min=0
    )

    def read(self) -> sw.robot.Arena:
        """The arena, with shifted walls and start."""
        arena = sw.files.load_arena(self.arena)
        if self.layout_seed is not None:
            with screen.usable("--layout-seed"):
                arena = sw.robot.other_layout(arena, self.layout_seed)
        if self.start_seed is not None:
            with screen.usable("--start-seed"):
                arena = sw.robot.other_start(arena, self.start_seed)
        return arena


class Control(options.Group):
    """Control experiments without the function of the antennas."""

    disconnect: bool = flag("Disconnect the antennas' levers from the anchors.", "--disconnect")
    no_antennas: bool = flag("Remove the antennas.", "--no-antennas")

    def of(self, robot: sw.robot.Robot) -> sw.robot.Robot:
        """The robot as given, or one of the two controls."""
        if not (self.disconnect or self.no_antennas):
            return robot
        option = "--no-antennas" if self.no_antennas else "--disconnect"
        if self.disconnect and self.no_antennas:
            raise screen.wrong(
                None, f"{option} leaves no lever to disconnect: give only one of the options."
            )
        if not robot.antennas:
            raise screen.wrong(option, "this robot has no antennas.")
        off = tuple(replace(one, connected=False) for one in robot.antennas)
        return replace(robot, antennas=() if self.no_antennas else off)


def maze(
    robot: options.Robot,
    course: Course,
    control: Control,
    output: options.FilmedOutput,
    material: Material = None,
    _: bool = flag("List the arenas of Stepwell.", "--list", callback=_list, is_eager=True),
) -> None:
    """Simulate a robot in an arena: time to the goal, and contacts with walls.

    The simulation ends at the goal, when the robot is stuck, or at the time limit. The robot is
    steered by its antennas only. For control experiments, --disconnect and --no-antennas simulate
    the same robot without reprogramming of its legs; with --material it has the masses and shapes
    of the parts that `stepwell build` cuts. With --out, figures, samples as NetCDF, the
    result as JSON and a video (MP4 and GIF) are written into a folder, together with both designs.

    Example: stepwell maze robot-explorer three-walls
    """
    text, given = options.read_robot(robot)
    design = control.of(given)
    seeds = {"start_seed": course.start_seed, "layout_seed": course.layout_seed}
    output.check_output_folder("maze")
    place = course.read()
    with screen.usable(robot), screen.progress("walking") as tell:
        cut = _cut(design, material)
        result = sw.simulation.maze(cut, place, limit=course.limit, progress=tell)
    output.report(result, text if design is given else design, robot, seeds=seeds)
    screen.stopped(result.walk.stopped)


NO_DISPLAY = (
    "The viewer needs a display, and none is available. `stepwell walk` and `stepwell maze` write "
    "videos without a display; `stepwell export` writes a model for another machine."
)


def export(
    robot: options.Robot,
    out: Path = option(
        "Write this file (.xml: MJCF, .sdf: SDF), or a folder with both.",
        "--out -o PATH",
        default=Path("robot.xml"),
        callback=options.local,
    ),
    arena: options.Arena = None,
    material: Material = None,
    force: options.Force = False,
) -> None:
    """Export a robot as MJCF for MuJoCo, SDF for Gazebo, or both.

    A folder contains the robot as MJCF (robot.xml) and as SDF 1.11 (robot.sdf), their meshes, and
    walk.py, a script that walks the robot in MuJoCo's viewer without Stepwell. In the keyframe
    `start` the feet are at the floor, the supports above it, and every cell is in state 0. With
    --material the robot has the masses, shapes and meshes of the parts that `stepwell build` cuts.

    Example: stepwell export robot-forward --out robot
    """
    write = {".xml": sw.simulation.mjcf, ".sdf": sw.simulation.sdf, "": sw.simulation.exchange}
    kind = out.suffix.lower()
    if kind not in write:
        how = "must end in .xml for MJCF or in .sdf for SDF, or be a folder without an ending."
        raise screen.wrong("--out", f"{out}: {how}")
    if material and kind == ".sdf":
        how = "meshes of parts are files of their own: name a folder, without an ending."
        raise screen.wrong("--out", f"{out}: {how}")
    text, design = options.read_robot(robot)
    place = sw.files.load_arena(arena) if arena is not None else None
    if kind:
        options.free_file(out, force)
    else:
        sw.files.check_folder(out, "export", force=force, texts={"robot.toml": text})
    with screen.usable(robot), screen.progress("model"):
        if material:
            design = sw.build(design, material).robot
        made = write[kind](design, place)
    if kind:
        sw.files.write_atomic(out, made)
        return screen.show_verbatim(f"Wrote {out}")
    inputs = {"robot.toml": text} | ({"arena.toml": sw.files.dumps(place)} if place else {})
    names = screen.by_folder(_written(out, made | inputs, force))
    screen.show_verbatim(f"Wrote {out}: {', '.join(names)}")


def _written(folder: Path, texts: Mapping[str, str], force: bool) -> list[str]:
    """Write texts into a folder, all of them or none, and return their names."""
    record = {"design_sha256": sw.files.digest(texts["robot.toml"])}
    with sw.files.staged_folder(folder, "export", record, names=texts, force=force) as draft:
        for name, text in texts.items():
            (draft / name).parent.mkdir(exist_ok=True)
            sw.files.write_atomic(draft / name, text)
    return sorted(texts)


def view(robot: options.Robot, arena: options.Arena = None, material: Material = None) -> None:
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
        _show(_cut(design, material), place)


def command(robot: sw.robot.Robot, settle: float) -> Callable[[Any, Any], None]:
    """A control callback of MuJoCo that prescribes the stroke, 0 while the robot settles."""

    def control(_model: Any, data: Any) -> None:
        data.ctrl[0] = robot.drive.stroke(data.time - settle)

    return control


def model(robot: sw.robot.Robot, arena: sw.robot.Arena | None) -> tuple[Any, Any]:
    """The compiled model, and its data in the start pose."""
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
