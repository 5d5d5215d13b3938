"""Every result keeps to the JSON Schema that is published of it.

The golden cases hold each JSON that a command prints or writes against it (tests/golden).
"""

import json
from pathlib import Path

import pytest

import stepwell as sw
from stepwell.design import margin
from stepwell.results import run_record, schema_kinds, schema_of
from stepwell.results.json_schema import kind_of, violations, widened

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.fixture(scope="module")
def record():
    cycle = sw.preset("paper-forward").cycle()
    # As a program reads it.
    return json.loads(json.dumps(run_record(cycle, margin(cycle.chain)) | {"files": []}))


def test_the_pages_have_the_schemas_that_the_command_prints():
    pages = {file.stem for file in (DOCS / "schema").glob("*.json")}
    assert pages == set(schema_kinds())
    for kind in schema_kinds():
        text = (DOCS / "schema" / f"{kind}.json").read_text("utf-8")
        assert text == json.dumps(schema_of(kind), indent=2) + "\n", kind


def test_every_schema_has_an_id_a_version_and_a_title():
    for kind in schema_kinds():
        schema = schema_of(kind)
        name, version = schema["title"].split("/")
        assert name == f"stepwell.{kind}"
        assert schema["$id"] == f"urn:stepwell:schema:{kind}:{version}"
        assert schema["properties"]["schema"] == {"const": schema["title"]}
        assert "schema" in schema["required"]


def test_a_record_that_keeps_to_its_schema_has_no_violations(record):
    assert violations(record) == []


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema": "stepwell.run/0"}, "must be 'stepwell.run/1'"),
        ({"peak_force_N": "much"}, "record.peak_force_N = much: must be number or null"),
        ({"events": [{"kind": 3}]}, "record.events[0] lacks cause."),
        ({"news": 1}, "record.news: is not in the published schema"),
        ({"ties": None}, "record.ties = None: must be array"),
        ({"loading_order": [0, True]}, "record.loading_order[1] = True: must be integer"),
    ],
)
def test_a_violation_says_where_what_came_and_what_is_allowed(record, change, said):
    assert any(said in one for one in violations(record | change))


def test_a_schema_is_widened_and_never_narrowed_but_by_a_new_version(record):
    old = schema_of("run")
    assert widened(old, record) == old
    more = record | {"peak_force_N": "none", "new": 1}
    less = {name: part for name, part in more.items() if name != "sequence"}
    new = widened(old, less)
    assert new["properties"]["peak_force_N"] == {"type": ["string", "number", "null"]}
    assert "sequence" not in new["required"] and "sequence" in new["properties"]
    assert "new" not in new["required"] and "new" in new["properties"]
    next_one = widened(old, {"schema": "stepwell.run/2", "new": 1})
    assert next_one["$id"] == "urn:stepwell:schema:run:2"
    assert next_one["properties"].keys() == {"schema", "new"}


@pytest.mark.parametrize("name", [None, "run/1", "stepwell.run"])
def test_a_record_without_a_schema_is_refused(name):
    with pytest.raises(sw.StepwellError, match=r"must be as in stepwell\.run/1"):
        kind_of({"schema": name})


def test_an_unknown_result_is_refused_with_the_ones_there_are():
    with pytest.raises(sw.StepwellError, match=r"Did you mean run\?"):
        schema_of("rum")
    with pytest.raises(sw.StepwellError, match=r"There are .*walk"):
        schema_of("xyzzy")
