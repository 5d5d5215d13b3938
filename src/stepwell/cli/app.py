"""The subcommands put together."""

import os
import signal
import sys
from io import TextIOWrapper
from typing import Annotated

import typer

from stepwell.base import __version__, described
from stepwell.cli import demo, doctor, figure, lab, paper, presets, replay, schema, studio
from stepwell.cli.chains import check, design, map, motion
from stepwell.cli.robots import robot, viewer, walk
from stepwell.cli.screen import EXIT_CODES, PIPE_CLOSED, Commands, styled
from stepwell.cli.studies import atlas, sweep

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich" if styled() else None,
    epilog=EXIT_CODES,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (
    demo.demo,
    motion.run,
    map.map_,
    motion.graph,
    motion.program,
    design.design,
    design.yield_,
    check.check,
    design.reprogram,
    presets.new,
    presets.presets,
    motion.animate,
    replay.replay,
    figure.figure,
    paper.paper,
    paper.validate,
):
    app.command(name=command.__name__.rstrip("_"), epilog=EXIT_CODES)(command)
app.add_typer(robot.commands, name="robot", epilog=EXIT_CODES)
for command in (walk.walk, walk.maze, viewer.export, viewer.view):
    app.command(name=command.__name__, epilog=EXIT_CODES)(command)
app.add_typer(sweep.commands, name="sweep", epilog=EXIT_CODES)
app.add_typer(atlas.commands, name="atlas", epilog=EXIT_CODES)
app.command(epilog=EXIT_CODES)(studio.studio)
app.add_typer(lab.commands, name="lab", epilog=EXIT_CODES)
for command in (schema.schema, doctor.doctor):
    app.command(name=command.__name__, epilog=EXIT_CODES)(command)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"stepwell {__version__}")
        raise typer.Exit


@app.callback()
def stepwell(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version.", callback=_version, is_eager=True),
    ] = False,
) -> None:
    """Design, check and understand machines whose motion is programmed into their springs."""


def _describe(commands: typer.Typer) -> None:
    """Have the help of every command ready."""
    callback = commands.registered_callback
    for one in (*commands.registered_commands, *filter(None, [callback])):
        if one.callback is not None:
            described(one.callback)
    for group in commands.registered_groups:
        if group.typer_instance is not None:
            _describe(group.typer_instance)


_describe(app)


def main() -> None:
    """Run the command line; what `stepwell` starts."""
    for stream in (sys.stdout, sys.stderr):
        # A letter that the terminal's encoding lacks is escaped, instead of ending the program.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    # Drafts are removed when the program is told to stop, as they are on Ctrl-C.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        app(prog_name="stepwell")
    except SystemExit as end:
        if isinstance(end.__context__, BrokenPipeError):
            sys.exit(PIPE_CLOSED)
        raise
    finally:
        # What is left to do is to leave.
        for name in ("SIGINT", "SIGALRM"):
            if hasattr(signal, name):
                signal.signal(getattr(signal, name), signal.SIG_IGN)
        _flush()


def _flush() -> None:
    """Say nothing where the reader has left, as `head` does after its lines."""
    stream = sys.stdout
    if stream is None:
        return
    try:
        stream.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
