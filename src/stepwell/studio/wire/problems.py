"""What is wrong with a design or a question: the sentence, and the key that it is about."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from stepwell.base import StepwellError
from stepwell.files import DesignError, slips_text
from stepwell.mechanism import SlipError

# A key path as messages begin with it, and what stands behind it.
_NAME = r'(?:[A-Za-z0-9_-]+|"(?:[^"\\]|\\.)*")'
_AT = re.compile(rf"(?P<at>[A-Za-z_][A-Za-z0-9_-]*(?:\[\d+\]|\.{_NAME})*)(?: = |: |, )")


class Problem(NamedTuple):
    """One problem; `at` is the key path, "" where the sentence names none."""

    at: str
    text: str

    @classmethod
    def of(cls, text: str) -> Problem:
        """The problem that a sentence tells."""
        found = _AT.match(text)
        return cls(found["at"] if found else "", text)

    def record(self) -> dict[str, Any]:
        """As JSON has it."""
        return self._asdict()


def problems_of(error: StepwellError) -> list[Problem]:
    """Every problem that an error tells, in the words that a command would print."""
    if isinstance(error, DesignError):
        return [Problem.of(line) for line in error.problems]
    if isinstance(error, SlipError):
        return [Problem.of(slips_text(error))]
    return [Problem.of(str(error))]
