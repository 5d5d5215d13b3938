"""Behaviours in files: what is read, and what is refused with its place."""

import pytest

import stepwell as sw
from facts import refuses
from stepwell.files import DesignError, behaviour_text, behaviours, load_behaviour, loads_behaviour
from stepwell.robot import RobotChoice

ROWS = """
row = [
    { contact = "free", motion = "forward" },
    { contact = "left", motion = "turn right" },
    { contact = "right", motion = "turn left" },
    { contact = "both", motion = "any" },
]
"""


def test_every_behaviour_of_the_package_is_read():
    assert "turn-away" in behaviours()
    for name, title in behaviours().items():
        assert load_behaviour(name).title == title
    assert loads_behaviour(behaviour_text("turn-away")).choice == RobotChoice()


def test_lengths_are_in_mm_and_bands_in_a_pack(tmp_path):
    sw.save(sw.preset("robot-antennas"), tmp_path / "mine.toml")
    text = f"""robot = "mine.toml"{ROWS}
[choice]
pitch_mm = 2.5
x_mm = [0, 10]
moves_mm = [4]
band = [{{ stiffness_N_per_m = 47, rest_length_mm = 22 }}]
"""
    (tmp_path / "table.toml").write_text(text, "utf-8")
    table = load_behaviour(tmp_path / "table.toml")
    assert table.choice.pitch == 0.0025 and table.choice.moves == (0.004,)
    assert (table.choice.left, table.choice.right) == (0.0, 0.010)
    assert table.choice.bands[0].stiffness == 47 and table.choice.bands[0].rest_length == 0.022
    assert table.robot == sw.preset("robot-antennas")
    assert len(table.choice.holes) == 5 * 13


@pytest.mark.parametrize(
    ("text", "facts"),
    [
        ("", ("is empty",)),
        (ROWS.replace("forward", "forwrd"), ("row[0].motion", "forward")),
        (ROWS.replace('"left"', '"rear"'), ("'rear'", "no such antenna")),
        (ROWS.replace('"left"', '"free"'), ("'free' has 2 rows",)),
        (ROWS + "[choice]\npitch = 5", ("choice.pitch", "pitch_mm")),
        (ROWS + "[choice]\nmoves_mm = 4", ("choice.moves_mm", "list")),
        (ROWS + "[choice]\nmoves_mm = []", ("choice.moves_mm", "20 lengths")),
        (ROWS + "[choice]\ninner_bands = [0]", ("choice.inner_bands", "9 bands")),
        (ROWS + "[choice]\ninner_bands = [1.5]", ("choice.inner_bands", "whole numbers")),
        (ROWS + "[choice]\ndirections = 0", ("choice.directions", "360")),
        (f'robot = "robot-forward"{ROWS}', ("0 antennas",)),
        (f'robot = "robot-nowhere"{ROWS}', ("robot-nowhere",)),
    ],
)
def test_a_wrong_file_is_refused_with_its_place(text, facts):
    with refuses(DesignError, *facts):
        loads_behaviour(text)


def test_a_name_that_is_none_is_refused_with_the_nearest():
    with refuses(DesignError, "no such behaviour", "turn-away"):
        load_behaviour("turn-awy")
