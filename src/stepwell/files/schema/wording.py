"""Messages on schema errors in a design file."""

from typing import Any, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from stepwell.base import nearest_word
from stepwell.files.schema import chain as schema
from stepwell.files.schema.keys import Keys, Tables, tables_of
from stepwell.files.text import MOST_LINES, DesignError, did_you_mean, key_path, value_text

_ADVISED = 1000  # largest number of unknown keys that are compared with missing ones


T = TypeVar("T", bound=Keys)


def checked(table: type[T], values: Any, name: str) -> T:
    """Checked keys of a whole file; DesignError with its problems in the order of its tables."""
    try:
        return table.model_validate(values)
    except ValidationError as error:
        raise _refused(name, error, tables_of(table)) from None


def _refused(name: str, error: ValidationError, tables: Tables) -> DesignError:
    problems = error.errors(include_url=False)
    # A misspelt key is also a missing one: only one problem is reported.
    missing = {problem["loc"] for problem in problems if problem["type"] == "missing"}
    short_of = {loc[:-1] for loc in missing}
    unknown = [p["loc"] for p in problems if p["type"] == "extra_forbidden"]
    for loc in [loc for loc in unknown if loc[:-1] in short_of][:_ADVISED]:
        near = nearest_word(str(loc[-1]), _known(list(loc), tables))
        missing.discard((*loc[:-1], near or ""))
    reported = [p for p in problems if p["type"] != "missing" or p["loc"] in missing]
    # Only the shown problems are put into words: there may be many more.
    shown = [_line(problem, tables) for problem in reported[:MOST_LINES]]
    return DesignError(name, shown, more=len(reported) - len(shown))


def _line(problem: ErrorDetails, tables: Tables) -> str:
    keys: list[str | int] = list(problem["loc"])
    kind, given, path = problem["type"], problem["input"], key_path(keys)
    if kind == "extra_forbidden":
        return f"{path}: unknown key. {_advice(keys, tables)}"
    if kind == "missing":
        advice = _MISSING.get(_plain(keys), _MISSING.get(str(keys[-1]), ""))
        return f"{path}: is missing. {advice}".rstrip()
    if kind == "design":
        context = problem.get("ctx", {})
        bare = isinstance(given, dict)
        if key := context["key"]:
            path, given = key_path([*keys, key]), given.get(key) if bare else None
            bare = given is None
        shown = "" if bare else f" = {value_text(given)}"
        return f"{path}{shown}: {_in_cell(keys, problem['input'], context['problem'])}"
    if kind in ("tuple_type", "list_type"):
        must = f"a list of tables, each under [[{_plain(keys)}]]"
    else:
        must = f"a table, as in [{_plain(keys)}]"
    return f"{path} = {value_text(given)}: must be {must}."


def _in_cell(keys: list[str | int], table: Any, problem: str) -> str:
    """The problem; with the number from 1 and the name of a cell without a key."""
    if not problem.startswith("is missing") or keys[-2:-1] != ["cell"]:
        return problem
    name = f" ({value_text(table['name'])})" if "name" in table else ""
    return problem.replace("is missing", f"is missing in cell {int(keys[-1]) + 1}{name}", 1)


def _plain(keys: list[str | int]) -> str:
    return ".".join(key for key in keys if isinstance(key, str))


def _known(keys: list[str | int], tables: Tables) -> list[str]:
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
