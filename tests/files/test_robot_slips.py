"""Slips of unit in the files of robots and arenas, and in their values."""

import itertools
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from facts import says
from stepwell.files import DesignError, dumps, loads, loads_arena
from stepwell.mechanism import SlipError
from stepwell.robot import Antenna, Body, Foot, Goal, Wall

ARENA = "[goal]\nat_mm = [2000, 0]\n[[wall]]\nfrom_mm = [500, -600]\nto_mm = [500, 600]\n"


def with_line(key: str, line: str) -> str:
    """The robot's whole file with another line for the first key of that name."""
    lines = dumps(sw.preset("robot-antennas")).splitlines()
    place = next(i for i, one in enumerate(lines) if one.startswith(f"{key} ="))
    lines[place] = line
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("key", "value", "place", "meant"),
    [
        ("length_mm", "0.1", "body.length_mm", "100 mm"),
        ("width_mm", "70000", "body.width_mm", "70 mm"),
        ("mass_g", "0.26", "body.mass_g", "260 g"),
        ("drag_N", "390", "floor.drag_N", "0.39 N"),
        ("stroke_mm", "0.04", "drive.stroke_mm", "40 mm"),
        ("at_mm", "[0.008, 0.0575]", "leg[0].at_mm", "[8, 57.5] mm"),
        ("pivot_mm", "[0.11, -0.025]", "antenna[0].pivot_mm", "[110, -25] mm"),
        ("swing_deg", "1.2", "antenna[0].swing_deg", "68.7549 deg"),
        ("angle_deg", "1.1", "antenna[0].angle_deg", "63.0254 deg"),
    ],
)
def test_a_slip_in_a_robots_file_is_answered_with_its_key(key, value, place, meant):
    text = with_line(key, f"{key} = {value}")
    with pytest.raises(DesignError) as refused:
        loads(text, "robot.toml")
    told = next(line for line in str(refused.value).splitlines() if f": {place} = " in line)
    assert f"Did you mean {meant}?" in told
    says(told, "unusual = true", "top")


def test_a_robot_that_is_unusual_says_so_in_its_file():
    text = with_line("mass_g", "mass_g = 9000")
    odd = loads(f"unusual = true\n{text}").subject
    assert odd.unusual
    assert dumps(odd).startswith(("unusual = true", "title = ")) and "unusual = true" in dumps(odd)
    assert loads(dumps(odd)).subject == odd


def test_what_the_program_makes_of_a_robot_is_never_asked():
    robot = sw.preset("robot-antennas")
    heavy = replace(robot, body=replace(robot.body, mass=9.0))
    assert not heavy.unusual
    assert loads(dumps(heavy)).subject == heavy
    assert "unusual" not in dumps(robot)


@pytest.mark.parametrize(
    ("change", "name", "meant"),
    [
        ({"foot": Foot(mass=6.6)}, "foot.mass", 0.0066),
        ({"body": Body(mass=260.0)}, "body.mass", 0.260),
        ({"antennas": [Antenna("a", (110, -25), 0.13, 1.1, "right", (-0.01, 0))]},
         "antenna[0].pivot", (0.110, -0.025)),
    ],
)  # fmt: skip
def test_a_slip_in_a_robot_is_refused_with_what_was_meant(change, name, meant):
    robot = sw.preset("robot-antennas")
    with pytest.raises(SlipError) as refused:
        sw.Robot(robot.legs, **change)
    (slip,) = (one for one in refused.value.slips if one.name == name)
    assert slip.meant == pytest.approx(meant)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            ARENA.replace("[2000, 0]", "[2, 0]").replace("500", "0.5").replace("600", "0.6")
            + "thickness_mm = 0.5",
            "the farthest point = [2, 0]: arenas reach from 10 mm to 100 m. "
            "Did you mean [2000, 0] mm?",
        ),
        (f"{ARENA}thickness_mm = 0.02", "wall[0].thickness_mm = 0.02: "),
        (f"{ARENA}[[cylinder]]\nat_mm = [900, 0]\nradius_mm = 0.05", "cylinder[0].radius_mm = "),
    ],
)
def test_a_slip_in_an_arenas_file_is_answered_with_what_was_meant(text, told):
    with pytest.raises(DesignError) as refused:
        loads_arena(text, "room.toml")
    assert str(refused.value).startswith(f"room.toml: {told}")
    assert loads_arena(f"unusual = true\n{text}").unusual


def test_an_arena_in_millimetres_is_refused_in_python():
    with pytest.raises(SlipError, match=r"Did you mean \(2, 0\) m\?"):
        sw.Arena([Wall((500, -600), (500, 600))], goal=Goal((2000, 0)))


def test_an_arena_with_one_far_goal_or_wall_is_no_slip():
    near = Wall((0.5, -0.6), (0.5, 0.6))
    assert not sw.Arena([near], goal=Goal((200.0, 0.0))).unusual
    assert not sw.Arena([near, Wall((150.0, -1.0), (150.0, 1.0))], goal=Goal((2.0, 0.0))).unusual


_PLACE = st.tuples(st.floats(100.0, 5000.0), st.floats(-5000.0, 5000.0))


@given(ends=st.lists(_PLACE, min_size=2, max_size=8, unique=True), goal=_PLACE)
def test_every_arena_in_another_unit_is_refused(ends, goal):
    """Thickness and radius are left in metres, so that the places alone decide."""

    def arena(scale):
        places = [tuple(scale * x for x in point) for point in ends]
        walls = [Wall(*pair, thickness=1e-3) for pair in itertools.pairwise(places)]
        return sw.Arena(walls, goal=Goal(tuple(scale * x for x in goal)))

    assert not arena(1e-3).unusual
    for scale in (1.0, 1e-6):
        with pytest.raises(SlipError):
            arena(scale)


def test_a_drawn_arena_of_small_letters_is_no_slip():
    assert not loads_arena("cell 1 mm\n#.S.#").unusual
