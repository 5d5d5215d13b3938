"""Parts of a robot: the foot's geometry, the drive's command, what each part refuses."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from facts import refuses
from stepwell.robot import Antenna, Blocks, Body, Drive, Floor, Foot, Leg, Profile

CELL = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0), 30.0))
CHAIN = sw.Chain([CELL, CELL.with_anchors(q=(0.020, 0.0))])

feet = st.builds(
    Foot, link=st.floats(0.031, 0.060), span=st.floats(0.010, 0.040), below=st.floats(0.0, 0.003)
)


def test_the_paper_foot_hangs_28_7_mm_deep_and_rises_to_18_0_mm():
    # Kamp et al. 2024, Fig. 3: two 35 mm links, 40 mm apart in state 0 and 60 mm in state 1.
    foot = Foot()
    assert foot.depth([0.0, 0.020]) == pytest.approx([28.7e-3, 18.0e-3], abs=5e-5)


@given(feet, st.floats(0.0, 0.018))
def test_the_lever_of_a_foot_is_minus_the_slope_of_its_depth(foot, travel):
    h = 1e-7
    slope = float(foot.depth(travel + h) - foot.depth(travel - h)) / (2 * h)
    assert float(foot.lever(travel)) == pytest.approx(-slope, rel=1e-6)


@given(feet)
def test_a_foot_has_risen_by_its_height_below_the_supports_where_it_stops_carrying(foot):
    rise = float(foot.depth(0.0) - foot.depth(foot.contact_travel))
    assert rise == pytest.approx(foot.below, abs=1e-12)


@given(feet, st.floats(0.0, 0.019))
def test_a_foot_rises_all_the_way_as_its_cell_opens(foot, travel):
    assert foot.depth(travel + 1e-4) < foot.depth(travel)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Foot(below=-1e-3), "never touch the floor"),
        (lambda: Foot(span=0.070), "use longer links"),
        (lambda: Foot(mass=0.0), "mass = 0"),
        (lambda: Body(supports=((0.0, 0.0), (0.1, 0.0))), "3 or more"),
        (lambda: Body(centre=(math.nan, 0.0, 0.0)), "centre"),
        (lambda: Blocks(damping=0.0), "damping"),
        (lambda: Floor(drag=-0.1), "drag = -0.1"),
        (lambda: Floor(foot_friction=0.0), "foot_friction"),
        (lambda: Drive(amplitude=0.0), "amplitude"),
        (
            lambda: Drive(profile="square"),  # pyright: ignore[reportArgumentType]
            "must be one of 'triangle', 'sine', 'trapezoid'",
        ),
        (lambda: Leg("left", sw.Chain([CELL]), (0.0, 0.05)), "2 or more"),
        (
            lambda: Leg("left", sw.Chain([CELL, CELL], actuator_stiffness=100.0), (0.0, 0.05)),
            "robot's drive",
        ),
        (lambda: Antenna("a", (0.1, 0.0), 0.1, 0.0, "left", (0.01, 0.0)), "between 0 and 180"),
        (lambda: Antenna("a", (0.1, 0.0), 0.1, 1.0, "left", (0.0, 0.0)), "connected = False"),
        (lambda: Antenna("a", (0.1, 0.0), 0.1, 1.0, "left", (0.01, 0.0), swing=0.0), "swing"),
    ],
)
def test_a_part_out_of_range_says_which_number_and_what_is_allowed(make, says):
    with pytest.raises(ValueError, match=says):
        make()


@pytest.mark.parametrize("profile", Profile)
@given(time=st.floats(-10.0, 1000.0))
def test_the_command_stays_between_0_and_the_amplitude_and_repeats(profile, time):
    drive = Drive(period=1.7, profile=profile)
    stroke = float(drive.stroke(time))
    assert 0.0 <= stroke <= drive.amplitude
    if time > 0:
        assert float(drive.stroke(time + drive.period)) == pytest.approx(stroke, abs=1e-9)
    else:
        assert stroke == 0.0


@pytest.mark.parametrize("profile", Profile)
def test_the_command_is_out_halfway_through_the_period(profile):
    drive = Drive(profile=profile)
    assert drive.stroke([0.0, 1.0, 2.0]) == pytest.approx([0.0, 0.040, 0.0], abs=1e-15)


def test_a_trapezoid_rests_an_eighth_of_the_period_at_both_ends():
    drive = Drive(profile=Profile.TRAPEZOID, period=8.0)
    time = np.array([0.49, 3.51, 4.49, 7.51])
    assert drive.stroke(time) == pytest.approx([0.0, 0.040, 0.040, 0.0], abs=1e-15)


def test_a_legs_stroke_is_the_travel_of_all_cells_but_the_one_that_lifts():
    leg = Leg("left", sw.Chain([CELL, CELL, CELL]), (0.0, 0.05))
    assert leg.stroke == pytest.approx(0.040)


def test_a_cell_of_a_leg_is_found_by_number_and_by_name():
    leg = Leg("left", CHAIN, (0.0, 0.05))
    assert leg.cell_index("outer") == leg.cell_index(1) == 1
    moved = leg.with_anchors("inner", p=(-0.011, 0.0))
    assert moved.chain.levers[0].bands[0].p == (-0.011, 0.0)
    assert moved.chain.cells[1] == leg.chain.cells[1]


def test_a_cell_that_a_leg_has_not_is_answered_with_those_it_has():
    with refuses(ValueError, "leg 'left'", "'middle'", "'inner', 'outer'", "up to 2"):
        Leg("left", CHAIN, (0.0, 0.05)).cell_index("middle")


@given(st.floats(-0.03, 0.03), st.floats(0.001, 0.03), st.floats(0.1, 3.0))
def test_an_antenna_moves_its_anchor_all_the_way_in_a_full_swing(x, y, swing):
    antenna = Antenna("a", (0.1, 0.0), 0.1, -1.0, "left", (x, y), swing=swing)
    assert antenna.gear * antenna.swing == pytest.approx(math.hypot(x, y))
    assert antenna.side == -1
