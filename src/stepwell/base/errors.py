"""What every error of Stepwell is."""

from typing import Any


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
