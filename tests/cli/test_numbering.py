"""One numbering: what people type and read counts from 1, indices and paths from 0."""

import json

import pytest

import stepwell as sw
from stepwell.design import parameter, parameters
from stepwell.files import DesignError, dumps, loads, preset_text
from stepwell.sequences.memory import Scrambling


@pytest.mark.parametrize(("number", "name"), [("1", "inner"), ("2", "outer")])
def test_a_cell_typed_as_a_number_counts_from_1(stepwell, number, name):
    of = ("forward.toml", "--json")
    over = (f"{number}.q.x=0:20:3", f"{3 - int(number)}.q.x=0:10:3")
    record = json.loads(
        stepwell("map", *of, "--x", "0:20:3", "--y", "0:9:3", "--cell", number).stdout
    )
    assert record["moved_cell"] == name
    across = stepwell("map", *of, "--across", over[0], "--up", over[1])
    assert f'"{name}.q.x"' in across.stdout
    result = stepwell("reprogram", *of, "--by", f"{number}.p")
    assert json.loads(result.stdout)["by"] == f"{name}.p"


@pytest.mark.parametrize("number", ["0", "3"])
def test_a_number_that_no_cell_has_is_answered_with_those_there_are(stepwell, number):
    map_ = stepwell("map", "forward.toml", "--cell", number)
    assert map_.exit_code == 2
    assert "inner (1), outer (2)" in " ".join(map_.output.replace("│", " ").split())
    by = stepwell("reprogram", "forward.toml", "--by", f"{number}.p")
    assert by.exit_code == 2
    assert "'inner' or 1, 'outer' or 2" in " ".join(by.output.replace("│", " ").split())


def test_the_number_of_a_cell_without_a_name_is_the_number_that_means_it():
    chain = sw.Chain(sw.preset("paper-forward").cells[:1] * 3)
    for place, name in enumerate(sw.Chain([sw.Cell(c.band) for c in chain.levers]).names):
        assert name == f"cell {place + 1}"
    for one in parameters(chain)[:-1]:
        assert one.cell is not None
        assert parameter(chain, f"{one.cell + 1}.{one.part}") == one


def test_an_antennas_cell_counts_from_1_in_a_file_and_from_0_in_python():
    text = preset_text("robot-antennas")
    robot = loads(text.replace('cell = "inner"', "cell = 1")).robot
    assert [antenna.cell for antenna in robot.antennas] == [0, 0]
    assert loads(text).subject == sw.preset("robot-antennas")
    assert "cell = 1\n" in dumps(robot)
    assert loads(dumps(robot)).subject == robot
    with pytest.raises(DesignError, match="or its number, 1 for the innermost"):
        loads(text.replace('cell = "inner"', "cell = 0"))


def test_two_antennas_on_one_cell_are_noticed_however_it_is_called():
    text = preset_text("robot-antennas").replace('leg = "left"', 'leg = "right"')
    with pytest.raises(DesignError, match="two move the anchor of inner of leg 'right'"):
        loads(text.replace('cell = "inner"', "cell = 1", 1))


def test_what_is_printed_counts_cells_from_1():
    assert "cell 1 before 3" in repr(Scrambling((0, 2), 1, "010", "000", True))
    with pytest.raises(ValueError, match=r"no cell 3 \(index 2 in Python\)"):
        sw.preset("robot-forward").legs[0].cell_index(2)


def test_paths_of_keys_count_from_0_as_their_page_says():
    with pytest.raises(DesignError, match=r"chain\.cell\[0\]\.q_mm"):
        loads("[chain]\n[[chain.cell]]\np_mm = [1, 2]")
