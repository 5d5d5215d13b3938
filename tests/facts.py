"""The facts of a message: places, numbers, units, names, keys, commands, in order, not its wording.

A test of a message gives what makes it useful and leaves the sentence around it free.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import pytest

_E = TypeVar("_E", bound=Exception)
_WORD = re.compile(r"(?<!\S)\S*[^\W\d_]{2}\S*")


def _holds(text: str, facts: tuple[str, ...]) -> bool:
    at = 0
    for fact in facts:
        found = text.find(fact, at)
        if found < 0:
            return False
        at = found + len(fact)
    return True


def says(text: str | Iterable[str], *facts: str) -> None:
    """Fail unless a text, or one line of several, has all facts in this order."""
    # Four words or more, apart from numbers, would be a sentence.
    assert facts and all(fact and len(_WORD.findall(fact)) < 4 for fact in facts), facts
    lines = [text] if isinstance(text, str) else list(text)
    assert any(_holds(line, facts) for line in lines), f"not all of {facts} in {lines}"


@contextmanager
def refuses(kind: type[_E], *facts: str) -> Iterator[pytest.ExceptionInfo[_E]]:
    """Fail unless the block raises such an error, whose text has all facts in this order."""
    with pytest.raises(kind) as refused:
        yield refused
    says(str(refused.value), *facts)
