"""What every kind of record has, generated from the quantities of its account."""

import json
from typing import Any

import pytest

import stepwell as sw
from accounts.schemas import violations
from stepwell.accounts import account
from stepwell.accounts.head import shapes
from stepwell.accounts.kinds import KINDS, schema_at
from stepwell.accounts.rendering.json_schema import schema_kinds, schema_of
from stepwell.base import Quantity
from stepwell.design import Run


@pytest.fixture(scope="module")
def record():
    found = account(Run.of(sw.preset("paper-forward"))).record | {"files": []}
    # As a program reads it.
    return json.loads(json.dumps(found))


@pytest.mark.parametrize("kind", schema_kinds())
def test_every_schema_has_an_id_a_version_and_a_title(kind):
    schema = schema_of(kind)
    name, version = schema["title"].split("/")
    assert name == f"stepwell.{kind}"
    assert schema["$id"] == f"urn:stepwell:schema:{kind}:{version}"
    assert schema["properties"]["schema"] == {"const": schema["title"]}
    assert "schema" in schema["required"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_quantity_has_one_key_and_a_unit_or_what_it_holds(kind):
    schema = schema_at(kind)
    every: list[Any] = [*map(schema, shapes())] if callable(schema) else [schema]
    for one in every:
        for quantities in _nested(one):
            keys = [quantity.key for quantity in quantities]
            assert len(keys) == len(set(keys)), (kind, keys)


def _nested(schema: tuple[Quantity, ...]):
    yield schema
    for quantity in schema:
        holds = quantity.holds[0] if isinstance(quantity.holds, list) else quantity.holds
        if isinstance(holds, tuple):
            yield from _nested(holds)


def test_a_record_of_its_schema_has_no_violations(record):
    assert violations(record) == []


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"schema": "stepwell.run/0"}, "$.schema"),
        ({"peak_force_N": "much"}, "$.peak_force_N"),
        ({"events": [{"kind": 3}]}, "$.events[0]"),
        ({"news": 1}, "$"),
        ({"ties": None}, "$.ties"),
        ({"loading_order": [0, True]}, "$.loading_order[1]"),
    ],
)
def test_a_violation_has_its_place(record, change, place):
    assert any(one.startswith(f"{place}: ") for one in violations(record | change))


def test_an_unknown_result_is_refused_with_those_there_are():
    with pytest.raises(sw.StepwellError, match=r"Did you mean run\?"):
        schema_of("rum")
    with pytest.raises(sw.StepwellError, match=r"There are .*run"):
        schema_of("xyzzy")
