"""The accounts of graphs: those that are listed, and walks through those that are too long."""

import pytest

import stepwell as sw
from accounts.forms import PRESETS, SHAPES, forms, sealed, shapes
from accounts.schemas import violations
from stepwell.accounts import account, card, terminal
from stepwell.base import InputError


def _concave(cells: int, **more) -> sw.Chain:
    """Concave cells in an order that is neither that of F0 nor that of F1."""
    bands = [
        sw.Band((0.0, 0.0), ((10 + 9.6 * (7 * k % cells) / cells) / 1e3, (5 * k % 24) / 3e3 - 3e-3))
        for k in range(cells)
    ]
    return sw.Chain([sw.Cell(band) for band in bands], title="Long", **more)


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_the_record_of_every_preset_keeps_to_the_schema(name):
    try:
        graph = sw.preset(name).graph()
    except InputError:
        pytest.skip("friction leaves no finite graph")
    found = account(graph)
    assert violations(found.record) == []
    assert all(graph.reading.summary in " ".join(form.split()) for form in forms(found))


@pytest.mark.parametrize("name", SHAPES)
def test_the_record_of_every_shape_keeps_to_the_schema(name):
    found = account(shapes()[name].graph())
    assert violations(found.record) == []
    assert all(forms(found))


def test_the_record_has_what_the_reading_has():
    graph = sw.preset("three-wave").graph()
    record, reading = account(graph).record, graph.reading
    assert (record["vertices"], record["nodes"]) == (8, len(graph))
    assert record["branches"] == reading.branches
    assert record["main_loop"]["high_mm"] == pytest.approx(reading.main_loop.high * 1e3)
    assert len(record["sub_loops"]) == record["sub_loop_count"] == 2
    memory = record["return_point_memory"]
    assert not memory["holds"]
    assert memory["turning_points_mm"] == [
        v * 1e3 for v in reading.return_point_memory.witness.turns
    ]
    screen, small, made = forms(account(graph))
    for label, text in reading.facts.items():
        found = text.replace(" → ", ">")
        assert found.split(">")[0] in screen
        assert found in " ".join(small.split()) and found in " ".join(made.split()), label


def test_a_memory_that_holds_has_null_for_turning_points():
    memory = account(sw.preset("used-before").graph()).record["return_point_memory"]
    assert memory == {"holds": True, "turning_points_mm": None, "first": None, "later": None}


def test_another_actuator_has_its_own_unit():
    chain = sw.preset("paper-forward")
    assert "high_N" in account(chain.graph("force")).record["main_loop"]
    assert "high_mm" in account(chain.graph(53.0)).record["main_loop"]


@pytest.mark.parametrize("cells", [24, 101])
def test_a_graph_that_is_not_listed_is_counted_and_walked(cells, monkeypatch):
    monkeypatch.setenv("COLUMNS", "1000")
    graph = _concave(cells, actuator_stiffness=0.0).implicit_graph()
    found = account(graph.walked())
    record = found.record
    assert violations(record) == []
    assert record["vertices"] == graph.vertex_count == 2**cells
    assert (record["reached"], record["sub_loop_count"]) == (
        graph.reached_count,
        graph.sub_loop_count,
    )
    rows = [line.text for line in terminal(found, full=True)][-24:]
    assert [int(row.split()[0]) for row in rows] == list(range(1, 25))
    # Of long chains the cells that have moved are shown, not the whole state.
    assert "nothing" in rows[0] and "0" * cells not in "\n".join(rows)


def test_along_a_stroke_states_in_transit_are_walked_and_what_is_not_counted_is_null():
    found = account(_concave(11).implicit_graph().walked())
    record = found.record
    assert violations(record) == []
    assert (
        record["transitions"] is record["sub_loop_count"] is record["garden_of_eden_count"] is None
    )
    assert record["walk"][1]["label"] in "\n".join(line.text for line in terminal(found, full=True))


def test_the_account_of_a_graph_computes_nothing(monkeypatch):
    graph = sw.preset("three-wave").graph()
    walked = _concave(11).implicit_graph().walked()
    assert graph.reading and account(walked).record
    sealed(monkeypatch)
    for value in (graph, graph.reading, walked, walked.graph):
        found = account(value)
        assert card(found) and all(forms(found))
    assert account(graph).record and account(walked).record
