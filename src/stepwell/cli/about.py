"""`stepwell new`, `presets`, `paper`, `validate`, `schema` and `doctor`."""

import json
from pathlib import Path

import typer

import stepwell as sw
from stepwell.accounts import account
from stepwell.base import installation
from stepwell.cli import options, screen
from stepwell.cli.options import argument, flag, option


def presets(as_json: options.Json = False) -> None:
    """List the designs that come with Stepwell.

    The designs of the paper come first, then further chains, then robots.

    Example: stepwell presets
    """
    screen.report(account(sw.files.presets()), as_json, full=True)


def new(
    file: Path = argument("The file to write.", "NAME.toml", callback=options.local),
    preset: str = option(
        "Preset to copy; see `stepwell presets`.",
        "NAME",
        default="paper-forward",
        autocompletion=options.presets,
        callback=lambda name: name.removeprefix("preset:"),
    ),
    force: options.Force = False,
) -> None:
    """Write a copy of a preset as a design file.

    The file contains the comments of the preset and can be edited.

    Example: stepwell new leg.toml --preset three-wave
    """
    if file.suffix != ".toml":
        raise screen.wrong(str(file), f"must end in .toml, as in {file.stem}.toml.")
    options.free_file(file, force)
    sw.files.write_atomic(file, sw.files.preset_text(preset))
    command = "walk" if preset.startswith("robot-") else "run"
    screen.show_lines(f"Wrote {file}. Next: stepwell {command} {file}")


def paper(
    everything: bool = flag(
        "Also check claims that need many simulations; this takes minutes.", "--all"
    ),
    data: Path | None = option(
        "Recordings (file or folder) of the authors, for claims about measurements.", "PATH"
    ),
    *,
    output: options.Output,
) -> None:
    """Check the claims of the paper against the model.

    Every claim is computed; the verdict is agreement or disagreement, with the reason. Claims about
    measurements need the authors' recordings, which are not part of Stepwell.
    With --out, the figures of the paper are computed and written into a folder.

    Example: stepwell paper
    """
    output.check_output_folder("paper")
    with screen.progress("claims") as tell:
        verdicts = sw.paper.run(tell, everything=everything, data=data)
    output.report(verdicts, how={"everything": everything})


def validate(display: options.Display) -> None:
    """Check published results for chains of bistable elements.

    Published closed forms, transition graphs and sequences are computed; the verdict is agreement
    or disagreement, with the reason.

    Example: stepwell validate
    """
    with screen.progress("claims") as tell:
        verdicts = sw.paper.validate(tell)
    display.report(verdicts)


def schema(
    kind: str | None = argument(
        "Kind of result, such as run or lab.read; without it, all kinds are listed.",
        "RESULT",
        default=None,
        autocompletion=options.results,
    ),
) -> None:
    """Print the JSON Schema of a result.

    Every JSON result contains the name and version of its schema, such as stepwell.run/2.

    Example: stepwell schema run
    """
    if kind is None:
        names = (sw.accounts.schema_of(one)["title"] for one in sw.accounts.schema_kinds())
        screen.show_lines("Results, each with the version of its schema", "", *names)
        return
    with screen.usable("RESULT"):
        content = sw.accounts.schema_of(kind)
    screen.show_verbatim(json.dumps(content, indent=2))


def doctor(display: options.Display) -> None:
    """List installed and missing packages, caches and devices.

    The list contains packages and extras with the command that installs each, compiled kernels
    and their folder, browser, video encoder, OpenGL and cores. Packages that fail to import are
    listed with the reason. The exit code is 0 if all required packages work.

    Example: stepwell doctor
    """
    probes = {"cores": _cores, "kernels": _kernels, "OpenGL": _opengl, "display": _display}
    with screen.progress("packages"):
        installed = installation(probes)
    display.report(installed)
    if not installed.ok:
        raise typer.Exit(screen.FAILED)


# Each imports its package when it is called: a broken package is reported, the others are examined.
def _cores() -> int:
    from stepwell.kernels import cores

    return cores()


def _kernels() -> object:
    from stepwell.kernels import kept

    return kept()


def _opengl() -> str | None:
    return sw.simulation.drawing_system()


def _display() -> str | None:
    return "yes" if screen.has_display() else None
