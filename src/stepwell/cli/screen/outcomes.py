"""What an error means to whoever called the command: a line of advice and an exit code."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, cast

import typer
from typer.core import TyperGroup

from stepwell.base import ExtraError, SettingError
from stepwell.cli.screen.progress import Interrupted
from stepwell.cli.screen.show import escaped, warn

OK, FAILED, WRONG_INPUT, NO, INTERRUPTED = 0, 1, 2, 3, 130
# The reader of the output has left, as `head` does: 128 and the number of SIGPIPE, as in a shell.
PIPE_CLOSED = 141
# Wrong usage of any kind, which Typer does not export.
_USAGE = cast("type[Exception]", typer.BadParameter.__base__)
_LOOK_AGAIN = 0.005  # s
EXIT_CODES = (
    "Exit codes: 0 all is well, 1 the work failed and the message says what to do, 2 wrong usage "
    "or a wrong input file, 3 what you asked for cannot be had and the output says why, 130 "
    "interrupted."
)


class Commands(TyperGroup):
    """All subcommands; a known error of any of them ends in its advice, not in a traceback."""

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
        """Run what was asked for."""
        try:
            # From here on there is something to tidy up, and to tell, after Ctrl-C.
            if threading.current_thread() is threading.main_thread():
                signal.signal(signal.SIGINT, _interrupt)
            return super().invoke(ctx)
        except (typer.Exit, typer.Abort):
            raise
        except KeyboardInterrupt as error:
            # Python itself gives one that breaks into a decoder other words.
            told = str(error) if isinstance(error, Interrupted) else ""
            warn(told or "Interrupted; nothing was written.")
            raise typer.Exit(INTERRUPTED) from None
        except _USAGE as error:
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


def _interrupt(number: int, frame: FrameType | None) -> None:
    """What Ctrl-C does while a command runs: a KeyboardInterrupt, where it would not be lost.

    Modules that open and the compiler call Python out of C, which drops any exception.
    """
    if _is_lost(frame) and hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _interrupt)
        signal.setitimer(signal.ITIMER_REAL, _LOOK_AGAIN)
    else:
        raise KeyboardInterrupt


def _is_lost(frame: FrameType | None) -> bool:
    """Whether an exception raised here could be dropped before it reaches the command.

    The command may itself run while a module opens.
    """
    while frame is not None and frame.f_code is not Commands.invoke.__code__:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        if "llvmlite" in Path(frame.f_code.co_filename).parts:
            return True
        frame = frame.f_back
    return False


def outcome(error: ImportError | OSError | RuntimeError | ValueError) -> tuple[int, str] | None:
    """Exit code and message of an error that the user can do something about, else None."""
    # Before the rooms are opened, which ask for the settings too.
    if isinstance(error, SettingError):
        return WRONG_INPUT, str(error)
    from stepwell.files import DesignError, OverwriteError, slips_text
    from stepwell.lab import LabError
    from stepwell.mechanism import SlipError
    from stepwell.sequences import Unreachable
    from stepwell.statics import StaticsError
    from stepwell.studies import GapError, StudyError, SweepError, WorkerError

    if isinstance(error, DesignError | LabError | OverwriteError | StudyError):
        return WRONG_INPUT, str(error)
    if isinstance(error, SlipError):
        return WRONG_INPUT, slips_text(error)
    if isinstance(error, Unreachable):
        return NO, str(error)
    # Any other missing module is a bug of ours.
    if isinstance(error, StaticsError | ExtraError | GapError | SweepError | WorkerError):
        return FAILED, str(error)
    if isinstance(error, OSError) and not isinstance(error, BrokenPipeError):
        place = f"{error.filename}: " if error.filename else ""
        return FAILED, f"{place}{error.strerror or error}"
    return None


def stopped(why: str) -> None:
    """End with a message where a simulation ended early; what it has is written and shown."""
    if why:
        warn(why)
        raise typer.Exit(FAILED)


@contextmanager
def usable(what: str, *answers: type[ValueError]) -> Iterator[None]:
    """Turn what the work cannot do with an argument into wrong usage, but not its answers."""
    try:
        yield
    except ValueError as error:
        if isinstance(error, answers) or outcome(error) is not None:
            raise
        raise typer.BadParameter(str(error), param_hint=what) from None


def answered(yes: bool) -> None:
    """End with an exit code of its own where what was asked for cannot be had."""
    if not yes:
        raise typer.Exit(NO)
