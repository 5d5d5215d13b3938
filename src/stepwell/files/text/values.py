"""Tables of a file as plain Python values, and plain Python values as tables of a file."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from typing import Any

from stepwell.base import limits
from stepwell.files.text.errors import key_path, value_text


def in_decimals(value: Any, problems: list[str], keys: Sequence[str | int] = ()) -> Any:
    """A value as a file holds it, its numbers the decimals that Python shows.

    Args:
        value: strings, numbers, booleans, and lists and dictionaries of them.
        problems: gets a line for whatever else there is.
        keys: where the value stands.
    """
    if isinstance(value, float):
        return Decimal(repr(value))
    if isinstance(value, str | int | Decimal):
        return value
    if len(keys) > limits.most("depth"):
        problems.append(f"{key_path(keys[:1])}: is nested too deeply to be a design file.")
    elif isinstance(value, dict):
        return {
            str(key): in_decimals(own, problems, (*keys, str(key))) for key, own in value.items()
        }
    elif isinstance(value, list | tuple):
        return [in_decimals(own, problems, (*keys, i)) for i, own in enumerate(value)]
    else:
        shown = "null" if value is None else value_text(value)
        problems.append(
            f"{key_path(keys)} = {shown}: must be text, a number, true, false, a list or a table; "
            f"leave the key out where nothing is meant."
        )
    return None


def in_floats(value: Any) -> Any:
    """A value of a file as JSON can hold it, its decimals as floats."""
    if isinstance(value, Decimal):
        return float(value)
    if isinstance(value, dict):
        return {key: in_floats(own) for key, own in value.items()}
    if isinstance(value, list):
        return [in_floats(own) for own in value]
    return value
