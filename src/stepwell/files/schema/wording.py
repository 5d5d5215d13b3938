"""What the schema found wrong with a design file, in words its author can use."""

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from stepwell.base import nearest_word
from stepwell.files.schema import chain as schema
from stepwell.files.schema.keys import Tables
from stepwell.files.text import MOST_LINES, DesignError, did_you_mean, key_path, value_text

_ADVISED = 1000  # unknown keys of which it is asked which one was meant


def refused(name: str, error: ValidationError, tables: Tables = schema.TABLES) -> DesignError:
    """The error that lists the problems of a file, in the order of its tables."""
    problems = error.errors(include_url=False)
    # A misspelt key is also a missing one: that is said once.
    missing = {problem["loc"] for problem in problems if problem["type"] == "missing"}
    short_of = {loc[:-1] for loc in missing}
    unknown = [p["loc"] for p in problems if p["type"] == "extra_forbidden"]
    for loc in [loc for loc in unknown if loc[:-1] in short_of][:_ADVISED]:
        near = nearest_word(str(loc[-1]), _known(list(loc), tables))
        missing.discard((*loc[:-1], near or ""))
    told = [p for p in problems if p["type"] != "missing" or p["loc"] in missing]
    # Only what will be shown is put in words: there may be many more.
    shown = [_line(problem, tables) for problem in told[:MOST_LINES]]
    return DesignError(name, shown, more=len(told) - len(shown))


def _line(problem: ErrorDetails, tables: Tables) -> str:
    keys: list[str | int] = list(problem["loc"])
    kind: str = problem["type"]
    value = value_text(problem["input"])
    if kind == "extra_forbidden":
        return f"{key_path(keys)}: unknown key. {_advice(keys, tables)}"
    if kind == "missing":
        return f"{key_path(keys)}: is missing. {_missing(keys)}".rstrip()
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


def _known(keys: list[str | int], tables: Tables) -> list[str]:
    """The keys that the table around a key may hold."""
    return tables[_plain(keys[:-1])].names()


def _advice(keys: list[str | int], tables: Tables) -> str:
    key = str(keys[-1])
    homes = [home for home, table in tables.items() if key in table.names()]
    homes = [home for home in homes if not any(home.startswith(f"{one}.") for one in homes)]
    if key in _ELSEWHERE and "drive" in tables:
        return _ELSEWHERE[key]
    if nearest_word(key, _known(keys, tables)) or not homes:
        return did_you_mean(key, _known(keys, tables))
    if key in schema.BandKeys.model_fields:
        return f"It belongs in a band, as in band = {{ {key} = ... }}."
    return f"It belongs {' or '.join(f'in [{home}]' if home else 'at the top' for home in homes)}."


def _missing(keys: list[str | int]) -> str:
    return _MISSING.get(_plain(keys), _MISSING.get(str(keys[-1]), ""))


_ELSEWHERE = {
    "actuator_stiffness_N_per_m": "A robot's legs share one actuator: stiffness_N_per_m in [drive]."
}
_MISSING = {
    "chain": "A design file has a [chain] table.",
    "cell": "A chain has one [[chain.cell]] or more, inner first.",
    "p_mm": "Two numbers in mm, as in [-10, 0].",
    "q_mm": "Two numbers in mm, as in [10, 0].",
    "leg": "A robot has two [[leg]] or more.",
    "name": 'One line of text, as in "left".',
    "at_mm": "Two numbers in mm, as in [8, 57.5].",
    "antenna.pivot_mm": "Two numbers in mm, as in [110, -25].",
    "antenna.length_mm": "A length in mm, as in 130.",
    "antenna.angle_deg": "From straight ahead, to the left, as in 63.",
    "antenna.leg": 'The name of the leg whose anchor it moves, as in "right".',
    "antenna.moves_mm": "Two numbers in mm, as in [-10, 0].",
    "from_mm": "Two numbers in mm, as in [0, -600].",
    "to_mm": "Two numbers in mm, as in [0, 600].",
}
