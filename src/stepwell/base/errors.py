"""Exceptions of Stepwell, and helpers for their messages."""

import ast
import difflib
import inspect
import sys
import textwrap
from collections.abc import Callable, Iterable
from contextlib import suppress
from enum import StrEnum
from typing import Any, Self, cast


class StepwellError(Exception):
    """Base of every error of Stepwell: the text has the input, the allowed values and an action.

    Pickling, as between processes, keeps all attributes of an error.
    """

    def __reduce__(self):
        return _unpickled, (type(self), self.args, self.__dict__)


class InputError(StepwellError, ValueError):
    """An invalid argument, or invalid content of a file or a command."""


class SettingError(InputError):
    """An invalid environment variable."""


class ExtraError(StepwellError, ModuleNotFoundError):
    """A package of an optional extra is not installed; the text has the command to install it."""


def _unpickled(
    kind: type[StepwellError], args: tuple[Any, ...], held: dict[str, Any]
) -> StepwellError:
    error = kind.__new__(kind, *args)
    error.__dict__.update(held)
    return error


def printable(text: str) -> str:
    """`text` on one line, with unprintable and control characters escaped."""
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def described(function: Callable[..., object]) -> str:
    """The docstring of a function, read from its source if PYTHONOPTIMIZE=2 removed it."""
    if function.__doc__ is None and sys.flags.optimize > 1:
        with suppress(OSError, SyntaxError):  # there is no source
            node = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
            function.__doc__ = ast.get_docstring(cast("ast.FunctionDef", node), clean=False)
    return function.__doc__ or ""


def nearest_word(word: str, known: Iterable[str]) -> str | None:
    """The known word closest to `word`; None if none is close."""
    folded = {name.lower(): name for name in known}
    near = difflib.get_close_matches(word.lower()[:80], folded, n=1)
    return folded[near[0]] if near else None


class Advised(StrEnum):
    """A word, as in JSON and comparisons, with its meaning and an action as `advice`."""

    advice: str

    def __new__(cls, word: str, advice: str) -> Self:
        """A member from its word and its advice."""
        member = str.__new__(cls, word)
        member._value_, member.advice = word, advice
        return member

    def __repr__(self):
        return f"{type(self).__name__}.{self.name}"
