"""TOML in, its numbers still the decimals of the file; and out, as a person would write it."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Mapping
from decimal import Decimal, InvalidOperation
from typing import Any

from stepwell.base import limits
from stepwell.files.text.errors import DesignError

# The keys of a table, each with its value as it stands in the file.
Written = dict[str, str]

# Where a key can begin; the reader below takes the square of its depth. Nothing is tried twice.
_KEY = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_BEGIN = r"(?:^|[\[{,])[ \t]*+"


def parsed(text: str, name: str, empty: str) -> dict[str, Any]:
    """The tables of a file; DesignError where it is no TOML, or `empty` where it is empty."""
    if not text.strip():
        raise DesignError(name, [empty])
    _refuse_deep(text, name)
    # Counted before they are read, which takes far longer: every key has its sign.
    if (keys := text.count("=")) > limits.most("keys"):
        raise DesignError(name, [f"has {limits.problem('keys', keys)}"])
    try:
        return tomllib.loads(text.replace("\r\n", "\n"), parse_float=_decimal)
    except RecursionError:
        raise DesignError(name, ["is nested too deeply to be a design file."]) from None
    except ValueError as error:
        place = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", str(error))
        if not isinstance(error, tomllib.TOMLDecodeError):
            raise DesignError(name, ["holds an integer of thousands of digits."]) from None
        if place is None:
            raise DesignError(name, [f"{error}."]) from None
        last = text.count("\n") + 1
        where = f"line {place[1]}, column {place[2]}" if place[1] else f"line {last}, at the end"
        raise DesignError(name, [f"{where}: {str(error)[: place.start()]}."]) from None


def _decimal(text: str) -> Decimal:
    try:
        return Decimal(text)
    except InvalidOperation:  # an exponent past a billion billion
        return Decimal(float(text))


def _refuse_deep(text: str, name: str) -> None:
    """DesignError where a key is of more names than any design has."""
    most = limits.most("depth")
    if text.count(".") <= most:
        return
    deep = re.search(rf"{_BEGIN}{_KEY}(?:[ \t]*+\.[ \t]*+{_KEY}){{{most},}}+", text, re.MULTILINE)
    if deep:
        line = text.count("\n", 0, deep.start()) + 1
        names = len(re.findall(_KEY, deep[0]))
        raise DesignError(name, [f"line {line}: has {limits.problem('depth', names)}"])


def array(items: Iterable[str]) -> str:
    """A list of what is written already."""
    return f"[{', '.join(items)}]"


def inline(keys: Mapping[str, str]) -> str:
    """A table on one line."""
    return "{ " + ", ".join(lines(keys)) + " }"


def lines(keys: Mapping[str, str]) -> list[str]:
    """A line for each key."""
    return [f"{key} = {value}" for key, value in keys.items()]


def quoted(text: str) -> str:
    """Text in quotes."""
    # JSON's escapes are TOML's, but TOML also wants the delete character escaped.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
