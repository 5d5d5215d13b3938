"""The account of an atlas: each number once, the same in every form."""

import pytest

import stepwell as sw
from accounts.schemas import violations
from stepwell.accounts import account, card, page, terminal
from stepwell.studies import Axis, Study, atlas, charted, class_boundaries, find

CELL = sw.Cell(sw.Band(p=(-0.01, 0.0), q=(0.01, 0.0), stiffness=28.5, rest_length=0.01))
AXES = tuple(Axis(f"{cell}.q.{end}", 0.0, 0.02) for cell in (1, 2) for end in "xy")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("a") / "two.zarr"
    study = atlas(sw.Chain([CELL] * 2), AXES, 2000, folder, workers=0).study
    return study, charted(study, samples=20, checks=4)


def _text(found) -> str:
    return "\n".join(line.text for line in terminal(found, full=True))


def test_the_record_keeps_to_the_generated_schema_and_has_borders_where_they_are_asked_for(made):
    study, found = made
    told = account(found)
    assert violations(told.record) == [] and told.record["class_boundaries"] == []
    near = class_boundaries(study, found)
    among = account(found, class_boundaries=near).record
    assert violations(among) == [] and len(among["class_boundaries"]) == len(near) > 0
    first = among["class_boundaries"][0]
    assert first["unit"] == "mm" and first["at"] == near[0].value * 1e3
    (x, *_) = among["space"]
    assert (x["parameter"], x["unit"], x["from"], x["to"]) == ("1.q.x", "mm", 0.0, 20.0)


def test_every_form_has_the_graphs_with_their_fractions_and_yields(made):
    _, found = made
    told = account(found)
    for form in (_text(told), card(told), page(told)):
        assert f"{len(found.graph_classes)} graphs and {len(found.cycles)} cycles" in form
        for one in found.graph_classes:
            assert one.name in form and f"{one.fraction.estimate * 100:.4g}" in form


def test_the_answer_to_a_query_has_only_the_machines_that_match(made):
    _, found = made
    graph_classes = find(found, "snaps")
    told = account(found, graph_classes=graph_classes, query="snaps")
    assert [one["name"] for one in told.record["graph_classes"]] == [
        one.name for one in graph_classes
    ]
    assert told.record["graphs"] == len(found.graph_classes)
    none = account(found, graph_classes=(), query="counts to five")
    assert "none of the graphs" in _text(none) and violations(none.record) == []


def test_the_account_of_an_atlas_reads_no_store_and_follows_no_chain(made, monkeypatch):
    _, found = made

    def refuse(*_, **__):
        raise AssertionError("an account calls the engine")

    monkeypatch.setattr(Study, "values", refuse)
    for name in ("path", "cycle", "margin", "graph", "yields"):
        monkeypatch.setattr(sw.Chain, name, refuse)
    told = account(found)
    assert told.record and terminal(told) and card(told) and page(told)
