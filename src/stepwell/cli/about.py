"""`stepwell new`, `presets`, `paper`, `validate`, `schema` and `doctor`."""

import json
from pathlib import Path

import typer

import stepwell as sw
from stepwell.accounts import account
from stepwell.base import installation
from stepwell.cli import options, screen
from stepwell.cli.options import argument, flag, option


def presets(as_json: bool = flag("Print JSON and nothing else.", "--json")) -> None:
    """List the designs that come with Stepwell.

    The paper's come first, then some that go further, then robots.

    Example: stepwell presets
    """
    screen.report(account(sw.files.presets()), as_json)


def new(
    file: Path = argument("The file to write.", "NAME.toml", callback=options.local),
    preset: str = option(
        "Which design; see `stepwell presets`.",
        "NAME",
        default="paper-forward",
        autocompletion=options.presets,
    ),
    force: options.ForceFile = False,
) -> None:
    """Write a design file to start from.

    It is a copy of one of the designs that come with Stepwell, with its comments.

    Example: stepwell new leg.toml --preset three-wave
    """
    if file.suffix != ".toml":
        raise screen.wrong(str(file), f"must end in .toml, as in {file.stem}.toml.")
    options.free_file(file, force)
    sw.files.write_atomic(file, sw.files.preset_text(preset))
    command = "walk" if preset.startswith("robot-") else "run"
    screen.show_lines(f"Wrote {file}. Next: stepwell {command} {file}")


def paper(
    everything: bool = flag("Also what takes many simulated runs: several minutes.", "--all"),
    data: Path | None = option("The authors' recordings, for the claims that they decide.", "PATH"),
    *,
    output: options.Output,
) -> None:
    """Check what the paper claims.

    Every claim is computed; the verdict says where we agree, where not, and why. Claims about
    measurements need the authors' recordings, which are not part of Stepwell.
    With --out, the paper's figures are drawn from the model into a folder.

    Example: stepwell paper
    """
    output.check_output_folder("paper")
    with screen.progress("claims") as tell:
        found = sw.paper.run(tell, everything=everything, data=data)
    output.report(found, how={"everything": everything})


def validate(as_json: options.Json = False) -> None:
    """Check results of others about chains of bistable elements.

    Closed forms, transition graphs and sequences that others have published are computed; the
    verdict says where we agree, where not, and why.

    Example: stepwell validate
    """
    with screen.progress("claims") as tell:
        found = sw.paper.validate(tell)
    screen.report(account(found), as_json)


def schema(
    kind: str | None = argument(
        "Which result, such as run or lab.read; a list of all by default.",
        "RESULT",
        default=None,
        autocompletion=options.results,
    ),
) -> None:
    """Print the JSON Schema of a result.

    Every JSON that a command prints or writes names its schema and the version of it, as in
    stepwell.run/2; this prints that schema, for programs that read results.

    Example: stepwell schema run
    """
    if kind is None:
        names = (sw.accounts.schema_of(one)["title"] for one in sw.accounts.schema_kinds())
        screen.show_lines("Results, each with the version of its schema", "", *names)
        return
    with screen.usable("RESULT"):
        found = sw.accounts.schema_of(kind)
    screen.show_verbatim(json.dumps(found, indent=2))


def doctor(as_json: options.Json = False) -> None:
    """List what is installed, what is kept and what is missing.

    Packages and extras with the command that adds each, compiled kernels and where they are kept,
    browser, video encoder and OpenGL, cores. What is installed and does not work is listed with the
    reason. It ends with 0 where all that Stepwell needs is installed, extras or not.

    Example: stepwell doctor
    """
    found = installation(
        {"cores": _cores, "kernels": _kernels, "OpenGL": _opengl, "display": _display}
    )
    screen.report(account(found), as_json)
    if not found.ok:
        raise typer.Exit(screen.FAILED)


# Each opens its room when it is called: what is broken there is reported, and the rest examined.
def _cores() -> int:
    return sw.kernels.cores()


def _kernels() -> object:
    return sw.kernels.kept()


def _opengl() -> str | None:
    return sw.simulation.drawing_system()


def _display() -> str | None:
    return "yes" if screen.has_display() else None
