"""Terminal output of all commands: text, progress, errors and exit codes."""

import errno
import json
import os
import signal
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar
from itertools import groupby
from pathlib import Path
from types import FrameType
from typing import Any, cast

import typer
from typer.core import TyperGroup

import stepwell as sw
from stepwell.accounts import Account, Line, escaped, folded, heading, paragraph, table, terminal
from stepwell.base import ExtraError, SettingError, Shows, in_lines, on_terminal

WRITING = "writing"
# Whether the command prints JSON, and thus no progress.
_SILENT = ContextVar("silent", default=False)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, with a line about the work that was finished."""


@contextmanager
def progress(label: str, *, kept: str = "", note: Callable[[], str] = str) -> Iterator[Shows]:
    """A function of (done, total) that shows a bar on standard error, or lines without a terminal.

    With --json it shows nothing.

    `note` is a text after the label, updated with the bar. `kept` is the text after an interruption
    about the results that are kept.

    Raises:
        Interrupted: in place of a KeyboardInterrupt, with one line about the progress.
    """
    reached = ""
    try:
        silent = _SILENT.get()
        with nullcontext() if silent else on_terminal(lambda: label + note()) as bar:
            shown = None if silent else bar or in_lines(lambda: label + note())

            def update(done: float, total: float) -> None:
                nonlocal reached
                reached = f", {done:.0f} of {total:.0f} done" if total > 2 else ""
                if shown is not None:
                    shown(done, total)

            yield update
    except Interrupted:
        raise
    except KeyboardInterrupt:
        left = kept or "nothing was written"
        if label == WRITING:
            left = "the folder is unchanged, or marked as incomplete"
        raise Interrupted(f"Interrupted ({label}{reached}); {left}.") from None


def silence(as_json: bool) -> bool:
    """The callback of --json: this command shows no progress."""
    _SILENT.set(as_json)
    return as_json


def styled() -> bool:
    """Whether output has boxes and colours: at a terminal, unless NO_COLOR is set."""
    return at_terminal() and not os.environ.get("NO_COLOR")


def at_terminal() -> bool:
    """Whether standard output is a terminal."""
    return sys.stdout is not None and sys.stdout.isatty()


def has_display() -> bool:
    """Whether a display is available; assumed on systems other than Linux."""
    screens = ("DISPLAY", "WAYLAND_DISPLAY")
    return sys.platform != "linux" or any(os.environ.get(name) for name in screens)


def write_out(text: str) -> None:
    """Write to standard output; an OSError (closed, disk full) names it as the file."""
    # Closed by its caller with >&-; Python then has no stream at all.
    if sys.stdout is None:
        why = f"is closed, so there is no output: redirect it to a file, or to {os.devnull}"
        raise OSError(errno.EBADF, why, "standard output")
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has closed the pipe, as `head` does
        raise
    except OSError as error:
        # Python would try to write the rest again at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise type(error)(error.errno, error.strerror, "standard output") from None


def warn(text: str) -> None:
    """Write to standard error: one line per message for logs, folded at a terminal."""
    looked_at = sys.stderr is not None and sys.stderr.isatty()
    for line in escaped(text).split("\n"):
        typer.echo("\n".join(folded(line)) if looked_at else line, err=True)


def show_json(record: dict[str, Any], *files: Path) -> None:
    """Print a record as JSON, with the files that were written."""
    shown = record | {"files": [str(file) for file in files]}
    write_out(json.dumps(shown, indent=2, allow_nan=False) + "\n")


def report(
    account: Account,
    as_json: bool = False,
    full: bool = False,
    out: Path | None = None,
    **options: Any,
) -> None:
    """Write a result into a folder, and print it as JSON, a screen of text or all of its lines.

    `options` are those of `reports.write`, for the kind of result.
    """
    names: Sequence[str] = ()
    if out is not None:
        with progress(WRITING) as tell:
            names = sw.reports.write(account, out, progress=tell, **options)
    if as_json:
        show_json(account.record, *((out or Path()) / name for name in names))
        return
    _print_folded(terminal(account, full=full))
    if names:
        show_lines("", f"Written into {out}: {', '.join(by_folder(names))}")


def by_folder(names: Sequence[str]) -> list[str]:
    """Names of files, those in inner folders as the folder and their number."""
    inner = Counter(name.partition("/")[0] for name in names if "/" in name)
    folders = [f"{name}/ ({count} files)" for name, count in inner.items()]
    return [*(name for name in names if "/" not in name), *folders]


def show_lines(*lines: str) -> None:
    """Print lines, folded to the width of the terminal."""
    rows = (row for line in lines for row in escaped(line).split("\n"))
    write_out("".join(f"{part}\n" for row in rows for part in folded(row)))


def show_verbatim(text: str) -> None:
    """Print text to be copied, such as TOML, an address or a path, without folding."""
    write_out(f"{escaped(text)}\n")


def show_text(*paragraphs: str) -> None:
    """Print long sentences as paragraphs, each after an empty line."""
    for text in paragraphs:
        show_lines("", *(line.text for line in paragraph(text)))


def show_title(text: str) -> None:
    """Print a heading after an empty line."""
    _print_folded([Line(""), *heading(text)])


def show_table(
    title: str, head: Sequence[str], rows: Iterable[Sequence[str]], *, left: Sequence[int] = (0,)
) -> None:
    """Print a table, folded to the width of the terminal."""
    _print_folded(table(title, head, rows, left))


def _print_folded(lines: Iterable[Line]) -> None:
    """Print folded lines; headings in bold if colours are shown."""
    plain = not styled()
    for bold, some in groupby(lines, lambda line: line.bold and not plain):
        text = "".join(f"{line.text}\n" for line in some)
        if bold:
            from rich.console import Console
            from rich.text import Text

            Console(highlight=False, soft_wrap=True).print(Text(text, style="bold"), end="")
        else:
            write_out(text)


OK, FAILED, WRONG_INPUT, NO, INTERRUPTED = 0, 1, 2, 3, 130
# The reader has closed the output, as `head` does: 128 and the number of SIGPIPE, as in a shell.
PIPE_CLOSED = 141
# Wrong usage of any kind, which Typer does not export.
_USAGE = cast("type[Exception]", typer.BadParameter.__base__)
_LOOK_AGAIN = 0.005  # s
EXIT_CODES = (
    "Exit codes: 0 success, 1 computation failed (see the message), 2 wrong usage or invalid input "
    "file, 3 no solution or target not reached (see the output), 130 interrupted."
)


# Present names of commands and of options, with former names and names that users try.
_COMMAND_NAMES = {
    "--help": "help",
    "--install-completion": "completion",
    "--version": "version",
    "animate": "gif video",
    "check": "robustness tolerance tolerances",
    "design": "inverse optimise optimize search synthesise synthesize",
    "export": "mujoco",
    "figure": "draw plot",
    "lab as-built": "as-built",
    "lab calibrate": "calibrate fit",
    "lab compare": "compare",
    "map": "phase",
    "new": "init",
    "paper": "reproduce",
    "presets": "examples list",
    "program": "plan",
    "replay": "html",
    "reprogram": "tune",
    "run": "analyse analyze cycle solve",
    "studio": "gui ui",
    "sweep": "study",
    "walk": "simulate",
    "yield": "monte-carlo sensitivity",
}
_OPTION_NAMES = {
    "--anchor": "--anchor-tolerance --tolerance",
    "--bar": "--bar-mm",
    "--fit-cycles": "--cycles",
    "--from": "--start",
    "--gauge": "--gauge-mm",
    "--holes": "--hole --hole-mm",
    "--lever-tolerance": "--lever",
    "--monte-carlo": "--built --mc --samples",
    "--out": "--dest --file --output",
    "--preset": "--copy --from --template",
    "--rank-by": "--by",
    "--rest-length-tolerance": "--rest-length --rest-length-spread",
    "--samples": "--mc --monte-carlo --n --number",
    "--seed": "--random-seed",
    "--snaps-loading": "--snaps-out",
    "--snaps-unloading": "--snaps-back",
    "--stiffness-tolerance": "--stiffness --stiffness-spread",
    "--target": "--goal --sequence --to --want --wanted",
    "--travel-tolerance": "--travel --travel-spread",
    "--window": "--window-mm",
    "--workers": "--jobs --processes",
}
SYNONYMS = {name: present for present, names in _COMMAND_NAMES.items() for name in names.split()}
# An option of a former name, and the present ones, of which a command has one.
FORMER_OPTIONS: dict[str, list[str]] = {}
for _present, _names in _OPTION_NAMES.items():
    for _name in _names.split():
        FORMER_OPTIONS.setdefault(_name, []).append(_present)


def subcommands(help: str) -> typer.Typer:
    """A command with subcommands, such as `stepwell sweep`, with its help."""
    return typer.Typer(
        no_args_is_help=True,
        rich_markup_mode="rich" if styled() else None,
        help=help,
        epilog=EXIT_CODES,
    )


class Commands(TyperGroup):
    """All commands; a known error ends with its message instead of a traceback."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command of a name; for a synonym, an error that names the command."""
        meant = SYNONYMS.get(args[0]) if args and args[0] not in self.commands else None
        if meant:
            ctx.fail(f"No such command {args[0]!r}. Did you mean 'stepwell {meant}'?")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """List the commands under the headings of their groups, as the boxes of a terminal do."""
        groups: dict[str, list[tuple[str, str]]] = {}
        width = formatter.width - 6 - max(map(len, self.commands))
        for name in self.list_commands(ctx):
            command = self.commands[name]
            if not command.hidden:
                heading = getattr(command, "rich_help_panel", None)
                heading = heading if isinstance(heading, str) else "Commands"
                groups.setdefault(heading, []).append((name, command.get_short_help_str(width)))
        for heading, rows in groups.items():
            with formatter.section(heading):
                formatter.write_dl(rows)

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            # From here on Ctrl-C leaves results to report.
            if threading.current_thread() is threading.main_thread():
                signal.signal(signal.SIGINT, _interrupt)
            return super().invoke(ctx)
        except (typer.Exit, typer.Abort):
            raise
        except KeyboardInterrupt as error:
            # Python gives a KeyboardInterrupt inside a decoder another text.
            message = str(error) if isinstance(error, Interrupted) else ""
            warn(message or "Interrupted; nothing was written.")
            raise typer.Exit(INTERRUPTED) from None
        except _USAGE as error:
            _suggest_option(error)
            for part in ("message", "param_hint"):
                text = getattr(error, part, None)
                if isinstance(text, str):
                    setattr(error, part, escaped(text))
            raise
        except (ImportError, OSError, RuntimeError, ValueError) as error:
            known = outcome(error)
            if known is None:
                raise
            code, message = known
            warn(message)
            raise typer.Exit(code) from None
        finally:
            # The next command in this process has a --json of its own.
            silence(False)


def _suggest_option(error: Any) -> None:
    """Name the option for a former or usual name of it, if the command has that option."""
    given = getattr(error, "option_name", None)
    if error.ctx and error.ctx.info_name == "presets" and error.message.endswith(")"):
        error.message += ". To compute a preset: stepwell run preset:NAME. To copy a preset: "
        error.message += "stepwell new my.toml --preset NAME."
    if given is None or error.ctx is None:
        return
    names = {name for one in error.ctx.command.params for name in one.opts}
    meant = [name for name in FORMER_OPTIONS.get(given, ()) if name in names]
    if meant:
        error.possibilities = meant


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, or later: C drops it while modules open and the compiler runs."""
    if _would_be_lost(frame) and hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _interrupt)
        signal.setitimer(signal.ITIMER_REAL, _LOOK_AGAIN)
    else:
        raise KeyboardInterrupt


def _would_be_lost(frame: FrameType | None) -> bool:
    # The command may itself run during an import.
    while frame is not None and frame.f_code is not Commands.invoke.__code__:
        file = frame.f_code.co_filename
        if file.startswith("<frozen importlib") or "llvmlite" in Path(file).parts:
            return True
        frame = frame.f_back
    return False


def outcome(error: ImportError | OSError | RuntimeError | ValueError) -> tuple[int, str] | None:
    """Exit code and message of an error that the user can correct, else None."""
    # Before other packages are imported, for they read the settings too.
    if isinstance(error, SettingError):
        return WRONG_INPUT, str(error)
    files, studies = sw.files, sw.studies
    if isinstance(error, sw.mechanism.SlipError):
        return WRONG_INPUT, files.slips_text(error)
    for code, kinds in (
        (
            WRONG_INPUT,
            files.DesignError | sw.lab.LabError | files.OverwriteError | studies.StudyError,
        ),
        (NO, sw.Unreachable),
        # Any other missing module is a bug of ours.
        (FAILED, ExtraError | sw.statics.StaticsError | studies.GapError),
        (FAILED, studies.SweepError | studies.WorkerError),
    ):
        if isinstance(error, kinds):
            return code, str(error)
    if isinstance(error, OSError) and not isinstance(error, BrokenPipeError):
        place = f"{error.filename}: " if error.filename else ""
        return FAILED, f"{place}{error.strerror or error}"
    return None


def stopped(why: str) -> None:
    """Exit with a message if a simulation ended early; its results are written and shown."""
    if why:
        warn(why)
        raise typer.Exit(FAILED)


def wrong(what: str | None, problem: str) -> typer.BadParameter:
    """The error of an invalid option or argument; None for the one that is being parsed."""
    return typer.BadParameter(problem, param_hint=what)


@contextmanager
def usable(what: str | None = None, *answers: type[ValueError]) -> Iterator[None]:
    """Turn a ValueError about an argument into a usage error, except `answers`."""
    try:
        yield
    except ValueError as error:
        if isinstance(error, answers) or outcome(error) is not None:
            raise
        raise wrong(what, str(error)) from None


def answered(yes: bool) -> None:
    """Exit with code 3 if there is no solution or the target is not reached."""
    if not yes:
        raise typer.Exit(NO)
