"""Every example runs and comes to its number."""

import re
import runpy
from pathlib import Path

import pytest
from PIL import Image

from docs.example_pictures import DRAWN, PICTURES
from sizes import SIZE
from stepwell.robot import Robot
from stepwell.simulation import Outcome, maze

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

# What a name in the example is in the end, and how near; the sources are theirs or the model's.
NUMBERS = {
    # F_outer falls to F1 of the inner cell here: the root of Eqs. 1 and 2 by bisection.
    "01_sequence_of_a_leg": ("snap_mm", 37.230942, 1e-6),
    # The area between the two curves of the map, 0.215, on a grid of 200 by 200.
    "02_transition_map": ("clockwise_share", 0.215, 1e-3),
    "03_turning_back_early": ("end_state", "01", None),
    # (F0 - F1) S of both cells, with the paper's F/(k r) of 0.967 and 1.607.
    "04_between_stroke_and_force": ("relays_mJ", 2 * (0.967 + 1.607) * 28.5 * 0.2828427, 0.01),
    # 2 f times the full stroke of 40 mm.
    "05_friction_and_weight": ("friction_mJ", 2 * 0.2 * 40.0, 1e-9),
    "06_ten_cells": ("heat_mJ", 28.0519, 1e-3),
    # Also what the brute-force follower finds: tests/test_oracle.py.
    "07_when_order_does_not_say_it_all": ("second_mm", 57.6407, 1e-3),
    # Kamp et al. 2024, Figs. 3C and 3E, within what the paper leaves open.
    "08_walk": ("advance", 0.71, 0.08),
    "09_turn_by_one_anchor": ("turn_deg", 15.0, 2.5),
    # Fig. 4D: past all three walls.
    "10_antennas_in_the_three_wall_arena": ("reached_and_touched", ("reached the goal", 3), None),
    # The rubber that the example's own test machine was given.
    "11_calibrate_a_rubber": ("stiffness", 24.0, 0.3),
    # N strokes reach whatever N cells can reach: theory page, "Stroke programs".
    "12_turning_points": ("most", 3, None),
    "13_countdown": ("counts", 3, None),
    # The best of all 35^3 choices of holes, by complete search.
    "14_design_a_cycle": ("holes_mm", [[20.0, 15.0], [0.0, 0.0], [20.0, -10.0]], None),
    # d_x of 20 mm has to become the outer cell's 30 mm.
    "15_what_an_antenna_must_deliver": ("distance_mm", 10.0, 1e-9),
    # Of 80 mm a cycle: the travels of the first and the inner cell, then 5 mm of the outer cell, by
    # which a V of two 35 mm links raises its foot by 0.9 mm of depth and 1 mm of air.
    "16_six_legs_on_one_actuator": ("wave", [23 / 80, 28 / 80, 33 / 80], 0.02),
    # By Eqs. 1 and 2: k (1 - ℓ0/ℓ) d_x tan θ, with sin θ = 5 mm over r.
    "17_two_finger_gripper": ("simulated", 0.3185, 0.001),
}


# Scripts that draw; tests/docs looks at what they draw.
DRAWING = ("figures_of_the_pages", "moving_picture", "pictures_of_the_front_page")

SLOW = (
    "16_six_legs_on_one_actuator",
    "10_antennas_in_the_three_wall_arena",
    "09_turn_by_one_anchor",
    "08_walk",
)
# In the quick run it goes a part of its way, and tests/robot past two of the walls.
LONG = "10_antennas_in_the_three_wall_arena"


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in NUMBERS]
)
def test_the_example_comes_to_its_number(name, capsys, monkeypatch):
    part = name == LONG and SIZE == "ci"
    if part:
        monkeypatch.setattr(
            Robot, "maze", lambda robot, arena, limit=0: maze(robot, arena, limit=40)
        )
    found = runpy.run_path(str(EXAMPLES / f"{name}.py"))
    key, number, near = NUMBERS[name]
    assert part or found[key] == (number if near is None else pytest.approx(number, abs=near))
    assert capsys.readouterr().out
    if name == LONG and not part:
        # What steers is the antennas' levers and not the shape of their rods.
        control = found["control"]
        assert control.outcome is Outcome.TIMED_OUT and control.touched["wall 3"] is None
        gaits = {gait for gaits in control.walk.gaits.values() for gait in gaits}
        assert "00>01>11>10>00" not in gaits
        assert {one.antenna for one in found["way"].contacts} == {"left", "right"}


def test_relays_lose_what_the_chain_under_force_control_loses(capsys):
    found = runpy.run_path(str(EXAMPLES / "04_between_stroke_and_force.py"))
    capsys.readouterr()
    assert found["heat_mJ"][0.0] == pytest.approx(found["relays_mJ"], rel=1e-12)


def test_every_example_has_its_number_and_opens_with_its_idea():
    names = sorted(file.stem for file in EXAMPLES.glob("*.py"))
    pictures = [name for name in names if name.startswith("00")]
    assert pictures == [f"00_{what}" for what in DRAWING]
    assert names == [*pictures, *NUMBERS]
    for name in names:
        first = (EXAMPLES / f"{name}.py").read_text("utf-8").splitlines()[0]
        assert first.startswith('"""')
        assert first.endswith('."""') or name.startswith("00")


def test_the_index_shows_every_example_with_its_picture_its_time_and_what_it_needs():
    text = (EXAMPLES / "README.md").read_text("utf-8")
    told = re.findall(
        r"^### (.+)\n\n\[(\w+)\.py\]\(\2\.py\): (.+?) Takes (.+?)(?:; needs `(\w+)`)?\.\n\n"
        r'<img src="\.\./docs/img/examples/\2\.png" alt="\1" width="\d+">$',
        text,
        re.M,
    )
    assert sorted(name for _, name, *_ in told) == [*NUMBERS] == [*DRAWN]
    assert len(told) == text.count("### ") == text.count("<img ")
    assert {picture.stem for picture in PICTURES.iterdir()} == {*NUMBERS}
    for _, name, _, _, extra in told:
        source = (EXAMPLES / f"{name}.py").read_text("utf-8")
        walks = re.search(r"\.(walk|maze)\(|^import mujoco\b", source, re.M)
        labels = "transition_map(" in source
        assert extra == ("robot" if walks else "tables" if labels else ""), name


@pytest.mark.parametrize("name", DRAWN)
def test_pictures_are_small_and_not_empty(name):
    file = PICTURES / f"{name}.png"
    assert file.stat().st_size < 200_000
    with Image.open(file) as picture:
        assert 300 <= picture.width <= 1200
        assert len(picture.convert("L").getcolors() or []) > 20
