"""What is wrong with a recording, in one line."""

from __future__ import annotations

from stepwell.base import InputError, printable


class LabError(InputError):
    """Measured data that cannot be used; `str` of it is what to show the user.

    Args:
        name: the file or folder, as the user called it.
        problem: one line: what came, what is allowed, what to do.
    """

    def __init__(self, name: str, problem: str):
        self.name = printable(name)
        self.problem = printable(problem)
        super().__init__(f"{self.name}: {self.problem}")
