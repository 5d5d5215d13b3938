"""What every error of Stepwell is, and words in errors that come with advice."""

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
    """Base of every error of Stepwell: the text says what came, what is allowed, what to do.

    An error comes out of a pickle, as from another process, with all that it holds.
    """

    def __reduce__(self):
        return _unpickled, (type(self), self.args, self.__dict__)


class InputError(StepwellError, ValueError):
    """An argument, or what a file or a command says, that cannot be taken."""


class SettingError(InputError):
    """A setting of the environment that cannot be understood."""


class ExtraError(StepwellError, ModuleNotFoundError):
    """A package that one of the extras brings is not there; the text says how to get it."""


def _unpickled(
    kind: type[StepwellError], args: tuple[Any, ...], held: dict[str, Any]
) -> StepwellError:
    error = kind.__new__(kind, *args)
    error.__dict__.update(held)
    return error


def printable(text: str) -> str:
    """`text` on one line, with whatever a terminal cannot show, or obeys, escaped."""
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def described(function: Callable[..., object]) -> str:
    """The docstring of a function, from its source where PYTHONOPTIMIZE=2 removed it."""
    if function.__doc__ is None and sys.flags.optimize > 1:
        with suppress(OSError, SyntaxError):  # there is no source
            node = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
            function.__doc__ = ast.get_docstring(cast("ast.FunctionDef", node), clean=False)
    return function.__doc__ or ""


def nearest_word(word: str, known: Iterable[str]) -> str | None:
    """The known word that was probably meant, if any is near."""
    folded = {name.lower(): name for name in known}
    near = difflib.get_close_matches(word.lower()[:80], folded, n=1)
    return folded[near[0]] if near else None


class Advised(StrEnum):
    """A word, as JSON and comparisons have it, and what it means and what to do about it."""

    advice: str

    def __new__(cls, word: str, advice: str) -> Self:
        """Of a word and its advice."""
        member = str.__new__(cls, word)
        member._value_, member.advice = word, advice
        return member

    def __repr__(self):
        return f"{type(self).__name__}.{self.name}"
