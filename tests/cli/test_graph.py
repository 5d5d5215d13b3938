"""`stepwell graph`: its reading, its files, its refusals."""

import json

import networkx as nx
import pytest

import stepwell as sw
from stepwell.accounts import account, terminal
from stepwell.sequences.exchange import from_json

# The files begin as their formats do.
DRAWN = True


def test_it_prints_the_account_of_the_graph(stepwell):
    result = stepwell("graph", "preset:three-wave")
    assert result.exit_code == 0
    shown = [line.text for line in terminal(account(sw.preset("three-wave").graph()))]
    assert result.stdout.splitlines() == shown


def test_json_has_all_of_the_reading(stepwell):
    result = stepwell("graph", "preset:used-before", "--json")
    record = json.loads(result.stdout, parse_constant=pytest.fail)
    assert record["schema"] == "stepwell.graph/2"
    assert record["actuator"] == "stroke"
    assert record["cells"] == ["seal", "lid"]
    assert (record["vertices"], record["branches"]) == (4, 2)
    assert [v for v in record["main_loop"]["up"] if "-" not in v] == ["00", "10", "11"]
    assert record["main_loop"]["high_mm"] == pytest.approx(40)
    assert record["garden_of_eden"] == record["unreachable"] == ["01"]
    memory = record["return_point_memory"]
    assert memory["holds"]
    assert memory["turning_points_mm"] is memory["first"] is memory["later"] is None
    assert {way["to"] for latch in record["latches"] for way in latch["ways"]} == {"-0", "1-"}


def test_a_failure_of_return_point_memory_comes_with_its_turning_points(stepwell):
    record = json.loads(stepwell("graph", "preset:three-wave", "--json").stdout)
    memory = record["return_point_memory"]
    turns = [point / 1e3 for point in memory["turning_points_mm"]]
    chain = sw.preset("three-wave")
    ends = [chain.path(turns[:k]).end for k in (2, 4)]
    shown = ["".join(_letter(s) for s in end) for end in ends]
    assert turns[1] == turns[3]
    assert shown == [memory["first"], memory["later"]]


def _letter(travel: float) -> str:
    return "0" if travel < 1e-9 else "1" if travel > 0.020 - 1e-9 else "-"


@pytest.mark.parametrize(
    ("drive", "unit", "actuator"),
    [("force", "N", "force"), ("stroke", "mm", "stroke"), ("53", "mm", "spring of 53 N/m")],
)
def test_another_actuator_drives_the_same_chain(stepwell, drive, unit, actuator):
    record = json.loads(stepwell("graph", "forward.toml", "--drive", drive, "--json").stdout)
    assert record["actuator"] == actuator
    assert f"high_{unit}" in record["main_loop"]


def test_from_one_state_only_what_can_be_reached_is_there(stepwell):
    record = json.loads(stepwell("graph", "preset:used-before", "--from", "00", "--json").stdout)
    assert record["vertices"] == 3
    assert record["garden_of_eden"] is None


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".svg", ".png", ".pdf", ".graphml", ".dot", ".json"])
def test_the_suffix_says_how_it_is_written(stepwell, tmp_path, suffix):
    file = tmp_path / f"wave{suffix}"
    result = stepwell("graph", "preset:three-wave", "-o", f"wave{suffix}")
    assert (result.exit_code, result.stdout.splitlines()[-1]) == (0, f"Wrote wave{suffix}")
    begins = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF", ".dot": b"digraph"}
    assert file.read_bytes().startswith(begins.get(suffix, b""))
    graph = sw.preset("three-wave").graph()
    if suffix == ".graphml":
        assert set(nx.read_graphml(file)) == set(graph)
    if suffix == ".json":
        assert set(from_json(file.read_text("utf-8")).transitions()) == set(graph.transitions())


def test_json_names_the_file_that_was_written(stepwell):
    record = json.loads(stepwell("graph", "forward.toml", "-o", "g.dot", "--json").stdout)
    assert record["files"] == ["g.dot"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("forward.toml", "-o", "g.gif"), "g.gif: must end in .svg, .png, .pdf for a figure, or"),
        (("forward.toml", "--drive", "soft"), "'soft': must be stroke, force, or the actuator's"),
        (("forward.toml", "--drive", "-3"), "'-3': must be stroke, force"),
        (("forward.toml", "--from", "0"), "must be 2 characters 0 or 1, inner cell first."),
        (("preset:friction",), "inner has friction 0.02 N"),
        (("preset:robot-forward",), "is a robot, and this needs a chain"),
    ],
)
def test_wrong_input_ends_in_code_2_and_writes_nothing(stepwell, tmp_path, arguments, message):
    result = stepwell("graph", *arguments)
    assert result.exit_code == 2
    assert message in result.output
    assert {file.name for file in tmp_path.iterdir()} == {"forward.toml"}


def test_too_many_states_for_a_figure_are_refused_with_a_way_out(stepwell, tmp_path):
    cells = "".join(f"[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [{3 * i}, 0]\n" for i in range(7))
    (tmp_path / "seven.toml").write_text(f"[chain]\nactuator_stiffness_N_per_m = 0\n{cells}")
    result = stepwell("graph", "seven.toml", "-o", "seven.svg")
    assert result.exit_code == 2
    assert "128 states" in result.output
    assert stepwell("graph", "seven.toml", "-o", "seven.dot").exit_code == 0


def long_chain(cells: int, **more) -> sw.Chain:
    """Concave cells in an order that is neither that of F0 nor that of F1."""
    bands = [
        sw.Band((0.0, 0.0), ((10 + 9.6 * (7 * k % cells) / cells) / 1e3, (5 * k % 24) / 3e3 - 3e-3))
        for k in range(cells)
    ]
    return sw.Chain([sw.Cell(band) for band in bands], title="Long", **more)


@pytest.mark.parametrize("cells", [24, 101])
def test_what_is_too_long_to_be_listed_is_counted_and_walked(stepwell, tmp_path, cells):
    chain = long_chain(cells, actuator_stiffness=0.0)
    sw.save(chain, tmp_path / "long.toml")
    implicit = chain.implicit_graph()
    result = stepwell("graph", "long.toml")
    assert result.exit_code == 0
    shown = [line.text for line in terminal(account(implicit.walked()))]
    assert result.stdout.splitlines() == shown
    record = json.loads(stepwell("graph", "long.toml", "--json").stdout)
    assert record["schema"] == "stepwell.implicit_graph/2"
    assert record["vertices"] == implicit.vertex_count
    assert record["reached"] == implicit.reached_count
    assert record["sub_loop_count"] == implicit.sub_loop_count
    assert record["garden_of_eden_count"] == implicit.garden_count
    assert record["transitions"] == 2 * implicit.vertex_count - 2
    assert record["start"] == record["walk"][0]["label"] == "0" * cells
    assert record["walk_whole"] is False
    for node, row in zip(implicit.walk(most=24), record["walk"], strict=True):
        assert (row["label"], row["low_N"], row["high_N"]) == (node.label, node.low, node.high)
        for key, way in (("up", implicit.up(node.label)), ("down", implicit.down(node.label))):
            assert (way is None) == (row[key] is None)
            if way is not None:
                assert row[key]["to"] == way[0]
                assert row[key]["drive_N"] == way[1].drive
                assert row[key]["cells"] == list(way[1].cells)
                assert row[key]["released_mJ"] == pytest.approx(way[1].released * 1e3)


def test_its_walk_begins_where_start_says(stepwell, tmp_path):
    sw.save(long_chain(24), tmp_path / "long.toml")
    record = json.loads(
        stepwell("graph", "long.toml", "--drive", "force", "--from", "1" * 24, "--json").stdout
    )
    assert record["start"] == record["walk"][0]["label"] == "1" * 24
    assert record["walk"][0]["up"] is None
    wrong = stepwell("graph", "long.toml", "--drive", "force", "--from", "111")
    assert wrong.exit_code == 2
    assert "must be 24 characters 0 or 1" in wrong.output


def test_along_a_stroke_it_walks_too_and_what_is_not_counted_is_null(stepwell, tmp_path):
    sw.save(long_chain(11), tmp_path / "long.toml")
    record = json.loads(stepwell("graph", "long.toml", "--json").stdout)
    assert (record["vertices"], record["start"], len(record["walk"])) == (2048, "0" * 11, 24)
    assert (
        record["transitions"] is record["sub_loop_count"] is record["garden_of_eden_count"] is None
    )
    assert record["walk"][1]["label"].count("-") == 1
    assert record["walk"][0]["up"]["kind"] == "switch"


def test_a_file_of_what_cannot_be_listed_is_refused_with_who_still_answers(stepwell, tmp_path):
    sw.save(long_chain(24, actuator_stiffness=0.0), tmp_path / "long.toml")
    result = stepwell("graph", "long.toml", "-o", "long.dot")
    assert result.exit_code == 2
    message = " ".join(result.output.split())
    assert "24 cells of which all 2^N states are sorted: at most 20 are taken" in message
    assert "chain.implicit_graph()" in message
    assert not (tmp_path / "long.dot").exists()
