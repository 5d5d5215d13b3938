"""Designs as plain Python values: the same chains and the same words as from a file."""

import json
import math
from typing import Any

import pytest

from facts import refuses
from stepwell.files import DesignError, loads, loads_tables, preset_text, presets, tables_in

FORWARD = tables_in(preset_text("paper-forward"))


@pytest.mark.parametrize("name", presets())
def test_every_design_survives_json(name: str):
    text = preset_text(name)
    file = loads_tables(json.loads(json.dumps(tables_in(text), allow_nan=False)), name)
    design, program = file.subject, file.program
    assert design == loads(text, name).subject
    if not name.startswith("robot-"):
        assert program == loads(text, name).program


def changed(**keys: Any) -> dict[str, Any]:
    """The forward leg with other keys in its outer cell."""
    tables = json.loads(json.dumps(FORWARD))
    tables["chain"]["cell"][1] |= keys
    return tables


@pytest.mark.parametrize(
    ("key", "value", "in_file"),
    [
        ("q_mm", [20], "[20]"),
        ("q_mm", [math.nan, 0], "[nan, 0]"),
        ("q_mm", "here", '"here"'),
        ("q_mm", True, "true"),
        ("friction_N", -3, "-3"),
        ("friction_N", 10**9, "1000000000"),
        ("friction_N", math.inf, "inf"),
        ("q_mmm", [20, 0], "[20, 0]"),
        ("name", 7, "7"),
        ("table_csv", "secret.csv", '"secret.csv"'),
        ("friction_N", -1.5, "-1.5"),
    ],
)
def test_what_is_wrong_is_reported_as_in_a_file(key: str, value: Any, in_file: str):
    with pytest.raises(DesignError) as by_value:
        loads_tables(changed(**{key: value}), "design")
    text = preset_text("paper-forward")
    if f"\n{key} = " in text:
        head, _, tail = text.rpartition(f"\n{key} = ")
        text = f"{head}\n{key} = {in_file}\n{tail.partition(chr(10))[2]}"
    else:
        text += f"\n{key} = {in_file}\n"
    with pytest.raises(DesignError) as by_text:
        loads(text)
    assert by_value.value.problems == by_text.value.problems


@pytest.mark.parametrize("value", [None, {1, 2}, object()])
def test_what_no_file_can_hold_is_refused_with_its_key(value: Any):
    with refuses(DesignError, "chain.cell[1].friction_N = ", "text", "number"):
        loads_tables(changed(friction_N=value))


@pytest.mark.parametrize("tables", [None, [], {}, "chain", 3])
def test_what_is_no_table_is_refused(tables: Any):
    with refuses(DesignError, "[chain]"):
        loads_tables(tables)


def test_deep_nesting_is_refused():
    deep: Any = 1
    for _ in range(900):
        deep = [deep]
    with pytest.raises(DesignError, match="nested too deeply"):
        loads_tables({"chain": deep})
