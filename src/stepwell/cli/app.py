"""The command line: all commands, in groups."""

import os
import signal
import sys
from collections.abc import Callable
from io import TextIOWrapper
from typing import Annotated, Any

import typer

from stepwell.base import __version__, described
from stepwell.cli import (
    about,
    atlas,
    behaviour,
    build,
    checks,
    design,
    lab,
    motion,
    robots,
    show,
    sweep,
)
from stepwell.cli.options import grouped
from stepwell.cli.screen import EXIT_CODES, PIPE_CLOSED, Commands, styled
from stepwell.crash import leave

# The groups of `stepwell --help`, in this order.
_GROUPS: dict[str, tuple[Callable[..., None] | typer.Typer, ...]] = {
    "Analysis": (motion.run, motion.map_, motion.graph, motion.program),
    "Design": (about.new, about.presets, design.design, design.reprogram, build.build),
    "Tolerances and measurements": (checks.check, checks.yield_, checks.margin, lab.commands),
    "Robots": (
        *(robots.commands, robots.walk, robots.maze, robots.jump, behaviour.compile_),
        *(robots.export, robots.view),
    ),
    "Parameter studies": (sweep.commands, atlas.commands),
    "Figures and pages": (show.studio, show.figure, motion.animate, show.replay, show.demo),
    "Validation and installation": (about.paper, about.validate, about.schema, about.doctor),
}
_NAMES = {
    robots.commands: "robot",
    lab.commands: "lab",
    sweep.commands: "sweep",
    atlas.commands: "atlas",
}


class _Grouped(Commands):
    def list_commands(self, ctx: Any) -> list[str]:
        """Names of the commands in the order of `--help`."""
        order = [_name(one) for commands in _GROUPS.values() for one in commands]
        return sorted(self.commands, key=order.index)


def _name(command: Callable[..., None] | typer.Typer) -> str:
    if isinstance(command, typer.Typer):
        return _NAMES[command]
    return command.__name__.rstrip("_")


app = typer.Typer(
    cls=_Grouped,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich" if styled() else None,
    epilog=EXIT_CODES,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for group, commands in _GROUPS.items():
    for one in commands:
        how: dict[str, Any] = {"name": _name(one), "epilog": EXIT_CODES, "rich_help_panel": group}
        if isinstance(one, typer.Typer):
            app.add_typer(one, **how)
        else:
            app.command(**how)(grouped(one))


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"stepwell {__version__}")
        raise typer.Exit


@app.callback()
def stepwell(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Analyse, design and simulate serial chains of bistable elements, and robots with such legs.

    Lengths in options are in mm, or have a unit: 5mm, 0.5cm, 0.2in.
    """


def _describe(commands: typer.Typer) -> None:
    """Complete the docstrings of all commands, which are their help."""
    for one in filter(None, [*commands.registered_commands, commands.registered_callback]):
        if one.callback is not None:
            described(one.callback)
    for group in filter(None, [one.typer_instance for one in commands.registered_groups]):
        _describe(group)


_describe(app)


def main() -> None:
    """Run the command line; the entry point of `stepwell`."""
    for stream in (sys.stdout, sys.stderr):
        # A letter that is not in the terminal's encoding is escaped instead of raising an error.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    # Until a command runs: Typer would end without a message, and imports may drop exceptions.
    signal.signal(signal.SIGINT, leave)
    # Drafts are removed on SIGTERM, as on Ctrl-C.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        app(prog_name="stepwell")
    except SystemExit as end:
        if isinstance(end.__context__, BrokenPipeError):
            sys.exit(PIPE_CLOSED)
        raise
    finally:
        # Signals are ignored during the exit.
        for name in ("SIGINT", "SIGALRM"):
            if hasattr(signal, name):
                signal.signal(getattr(signal, name), signal.SIG_IGN)
        _flush()


def _flush() -> None:
    """Flush standard output without an error if its reader has closed it, as `head` does."""
    if (stream := sys.stdout) is None:
        return
    try:
        stream.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
