"""What is wrong with a recording, in one line."""

from __future__ import annotations

from stepwell.base import InputError


class LabError(InputError):
    """Measured data that cannot be used; `str` of it is what to show the user.

    Args:
        name: the file or folder, as the user called it.
        problem: one line: what came, what is allowed, what to do.
    """

    def __init__(self, name: str, problem: str):
        self.name = _printable(name)
        self.problem = _printable(problem)
        super().__init__(f"{self.name}: {self.problem}")


def _printable(text: str) -> str:
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )
