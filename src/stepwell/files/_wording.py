"""What the schema found wrong with a design file, in words its author can use."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from stepwell.files import _schema as schema
from stepwell.files._errors import did_you_mean, key_path, nearest, value_text


def worded(error: ValidationError) -> list[str]:
    """One line for every problem, in the order of the file's tables."""
    problems = error.errors(include_url=False)
    unknown = [list(p["loc"]) for p in problems if p["type"] == "extra_forbidden"]
    # A misspelt key is also a missing one: that is said once.
    meant = [[*keys[:-1], nearest(str(keys[-1]), _known(keys))] for keys in unknown]
    return [
        _line(problem)
        for problem in problems
        if not (problem["type"] == "missing" and list(problem["loc"]) in meant)
    ]


def _line(problem: ErrorDetails) -> str:
    keys: list[str | int] = list(problem["loc"])
    kind: str = problem["type"]
    value = value_text(problem["input"])
    if kind == "extra_forbidden":
        return f"{key_path(keys)}: unknown key. {_advice(keys)}"
    if kind == "missing":
        return f"{key_path(keys)}: is missing. {_MISSING.get(str(keys[-1]), '')}".rstrip()
    if kind == "design":
        context = problem.get("ctx", {})
        key, text = context["key"], context["problem"]
        if not key and isinstance(problem["input"], dict):
            return f"{key_path(keys)}: {text}"
        if not key:
            return f"{key_path(keys)} = {value}: {text}"
        inside = problem["input"].get(key) if isinstance(problem["input"], dict) else None
        shown = "" if inside is None else f" = {value_text(inside)}"
        return f"{key_path([*keys, key])}{shown}: {text}"
    if kind in ("tuple_type", "list_type"):
        return (
            f"{key_path(keys)} = {value}: must be a list of tables, each under [[{_plain(keys)}]]."
        )
    return f"{key_path(keys)} = {value}: must be a table, as in [{_plain(keys)}]."


def _plain(keys: list[str | int]) -> str:
    return ".".join(key for key in keys if isinstance(key, str))


def _known(keys: list[str | int]) -> Iterable[str]:
    """The keys that the table around a key may hold."""
    return schema.TABLES[_plain(keys[:-1])].model_fields


def _advice(keys: list[str | int]) -> str:
    key = str(keys[-1])
    homes = [home for home, table in schema.TABLES.items() if key in table.model_fields]
    if nearest(key, _known(keys)) or not homes:
        return did_you_mean(key, _known(keys))
    if key in schema.BandKeys.model_fields:
        return f"It belongs in a band, as in band = {{ {key} = ... }}."
    return f"It belongs {' or '.join(f'in [{home}]' if home else 'at the top' for home in homes)}."


_MISSING = {
    "chain": "A design file has a [chain] table.",
    "cell": "A chain has one [[chain.cell]] or more, inner first.",
    "p_mm": "Two numbers in mm, as in [-10, 0].",
    "q_mm": "Two numbers in mm, as in [10, 0].",
}
