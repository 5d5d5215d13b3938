"""`stepwell compile`: from a table of contacts and motions to a robot and its parts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import stepwell as sw
from stepwell.base import need
from stepwell.cli import options
from stepwell.cli.options import Group, argument, option
from stepwell.cli.screen import answered, progress, usable, warn
from stepwell.cli.tolerances import BUILD_FILE, SAMPLES, BandTolerances, Seed, materials


class CompileEffort(Group):
    """Numbers of evaluated, sampled and simulated designs."""

    most: int | None = option(
        "Maximum number of designs evaluated in closed form.",
        "--most N",
        min=1,
        show_default="20000000",
    )
    samples: int | None = option(SAMPLES, "N", min=1, max=100_000, show_default="500")
    seed: Seed = 0
    walks: int = option(
        "Maximum number of designs that walk through the table in the simulation; 0 for none.",
        "N",
        default=5,
        min=0,
        max=5,
    )

    @property
    def given(self) -> dict[str, int]:
        """Numbers of designs and samples that differ from those of the function."""
        numbers = {"most": self.most, "samples": self.samples}
        return {name: number for name, number in numbers.items() if number is not None}


class FurtherTrials(Group):
    """Arenas, and the robot as it is cut."""

    arena: list[str] | None = option(
        "Arena, for a run of the robot: a name of `stepwell maze --list`, or a file (.toml, .txt). "
        "May be repeated.",
        "--arena ARENA",
        autocompletion=options.arenas,
    )
    limit: float = option(options.TIME_LIMIT, "S", default=600.0, min=1)
    build: str | None = option(
        "Build file (TOML) or its preset, such as acrylic-3mm: the table is computed for the robot "
        "as it is cut too, and --out contains its parts and the assembly guide.",
        f"--build {BUILD_FILE}",
        autocompletion=materials,
    )


def compile_(
    behaviour: str = argument(
        "Behaviour file (TOML), or its name, such as turn-away.",
        "BEHAVIOUR",
        autocompletion=options.behaviours,
    ),
    *,
    effort: CompileEffort,
    trials: FurtherTrials,
    within: BandTolerances,
    output: options.Output,
) -> None:
    """Search a robot with a given behaviour: anchors, bands, antennas, margins and yield.

    The behaviour is a table: the motion of the robot without contact, and with each antenna
    pressed. The result contains the margin of every row, walks with the antennas pressed, and the
    yield; or the smallest set of rows that no design has together, with exit code 3. With --out,
    the robot as a design file, figures and the result as JSON are written into a folder.

    Example: stepwell compile turn-away --out robot
    """
    text = sw.files.behaviour_text(behaviour)
    table = sw.files.loads_behaviour(text, behaviour, str(Path(behaviour).parent))
    places = [sw.files.load_arena(one) for one in trials.arena or ()]
    output.check_output_folder("compile", behaviour=text)
    spread = within.tolerances()
    with usable(behaviour), progress("designs") as tell:
        compiled = sw.robot.compile_behaviour(
            table, tolerances=spread, seed=effort.seed, progress=tell, **effort.given
        )
    with usable(behaviour), progress("walking") as tell:
        result = sw.simulation.verified(compiled, most=effort.walks, progress=tell)
    how: dict[str, Any] = {}
    if result.design is not None:
        if places:
            with usable(behaviour), progress("arenas") as tell:
                result = result.in_arenas(places, limit=trials.limit, progress=tell)
        if trials.build is not None:
            result, how = _built(result, trials.build, output)
    else:
        output = replace(output, out=None)
    output.report(result, text, behaviour, how=how)
    answered(result.design is not None and (result.verified or not effort.walks))


def _built(
    result: sw.simulation.CompiledRobot, material: str, output: options.Output
) -> tuple[sw.simulation.CompiledRobot, dict[str, Any]]:
    """The result with the robot as it is cut, and the files of its parts for --out."""
    from stepwell.build import build, build_files, load_build_file

    with usable("--build"):
        build_file = load_build_file(material)
    with usable("--build"), progress("sweep") as tell:
        made = build(result.robot, build_file, progress=tell)
    with usable("--build"), progress("walking"):
        result = result.with_parts(made.robot)
    if not made.can_be_built:
        reasons = "; ".join(map(str, made.findings))
        warn(f"--build {material}: this robot cannot be built, so no parts are written: {reasons}")
        return result, {}
    if output.out is None:
        return result, {}
    need("build")
    with usable("--build"), progress("nesting") as tell:
        files = build_files(made, progress=tell)
    return result, {"parts": {f"build/{name}": content for name, content in files.items()}}
