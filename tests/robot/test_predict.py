"""Predicted gaits: the paper's robots, and what margin, drag limit and flip mean."""

import math
import sys
from dataclasses import FrozenInstanceError, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import stepwell as sw
from facts import says
from robot.robots import BACKWARD, FORWARD, VIA_01, cell, explorer, gaits, leg, motion, robot
from sizes import SIZE, cases, examples
from stepwell.robot import Body, Drive, Floor, Foot, Leg, Motion, PushEnd, Robot
from stepwell.robot.prediction import TURNS, changes, depths
from stepwell.statics import StaticsError

designs = st.floats(0.002, 0.025)
floors = st.builds(Floor, drag=st.floats(0.05, 0.8))
feet = st.builds(Foot, below=st.floats(0.0, 0.0012))


def with_force(one: Robot, force: float) -> Robot:
    """A constant force against the outer cell of every leg."""

    def loaded(leg: Leg) -> Leg:
        inner, outer = leg.chain.cells
        outer = replace(outer, load=sw.Load.constant(force))
        return replace(leg, chain=replace(leg.chain, cells=(inner, outer)))

    return replace(one, legs=tuple(loaded(leg) for leg in one.legs))


# Kamp et al. 2024, Fig. 3: outer anchors q_x left and right, what the robot does with them.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("left", "right", "motion", "gaits"),
    [
        (0.020, 0.020, Motion.FORWARD, (FORWARD, FORWARD)),
        (0.005, 0.005, Motion.BACKWARD, (BACKWARD, BACKWARD)),
        # The mirror image of the next.
        *[(0.020, 0.005, Motion.RIGHT, (FORWARD, BACKWARD))] * (SIZE == "full"),
        (0.005, 0.020, Motion.LEFT, (BACKWARD, FORWARD)),
        (0.015, 0.015, Motion.NONE, (VIA_01, VIA_01)),
    ],
)
def test_the_papers_robots_do_what_the_paper_says(left, right, motion, gaits):
    prediction = robot(left, right).predict()
    assert prediction.motion is motion
    assert tuple(prediction.gaits.values()) == gaits


@pytest.mark.slow
def test_the_paper_robots_advance_and_turn_about_as_far_as_measured():
    # Kamp et al. 2024: 0.71 forward, 0.96 backward, a turn of 15 deg. A snap that takes no time
    # leaves a backward leg short, and a foot that takes none to grip carries a forward one far.
    assert robot(0.020).predict().advance == pytest.approx(0.71, abs=0.12)
    assert robot(0.005).predict().advance == pytest.approx(-0.96, abs=0.25)
    turn = robot(0.005, 0.020).predict()
    assert math.degrees(turn.turn) == pytest.approx(15.0, abs=2.5)
    assert abs(turn.advance) < 0.15


@pytest.mark.slow
def test_q_out_15_is_clockwise_in_the_air_and_walks_nowhere_on_the_floor():
    # Kamp et al. 2024, Fig. 3: weight, and not the drag, changes its gait.
    hung = robot(0.015, floor=Floor(gravity=0.0)).predict()
    assert set(hung.gaits.values()) == {FORWARD}
    assert hung.legs[0].pushes == ()
    assert set(gaits(robot(0.015, floor=Floor(drag=0.0))).values()) == {VIA_01}


@pytest.mark.slow
@pytest.mark.parametrize("one", [robot(), robot(0.005, 0.020)], ids=["forward", "left"])
def test_gaits_and_displacement_are_those_that_the_other_tests_take_without_the_doubts(one):
    prediction, without = one.predict(), motion(one)
    assert prediction.gaits == without.gaits == gaits(one)
    assert (prediction.advance, prediction.sideways, prediction.turn) == without[1:]


@pytest.mark.slow
@given(designs)
@settings(max_examples=examples(2, full=100))
def test_in_the_air_a_leg_goes_round_as_its_chain_alone_and_gets_nowhere(q):
    moved = motion(robot(q, floor=Floor(gravity=0.0)))
    assert moved.gaits["left"] == str(leg("left", q).chain.cycle().sequence)
    assert (moved.advance, moved.sideways, moved.turn) == (0.0, 0.0, 0.0)


@pytest.mark.slow
@given(designs, floors, feet)
@settings(max_examples=examples(3, full=120))
def test_like_legs_go_straight(q, floor, foot):
    moved = motion(robot(q, floor=floor, foot=foot))
    assert moved.gaits["left"] == moved.gaits["right"]
    assert moved.turn == pytest.approx(0.0, abs=2e-3)
    assert moved.sideways == pytest.approx(0.0, abs=5e-3)
    assert abs(moved.advance) <= 1.0 + foot.contact_travel / 0.020


@pytest.mark.slow
@given(designs, designs, floors, feet)
@settings(max_examples=examples(2, full=80))
def test_a_mirrored_robot_turns_the_other_way(left, right, floor, foot):
    one = motion(robot(left, right, floor=floor, foot=foot))
    other = motion(robot(right, left, floor=floor, foot=foot))
    assert one.gaits["left"] == other.gaits["right"]
    assert one.advance == pytest.approx(other.advance, abs=0.01)
    assert one.turn == pytest.approx(-other.turn, abs=0.01)


@pytest.mark.slow
def test_a_robot_gets_further_where_the_floor_drags_less():
    gains = [motion(robot(floor=Floor(drag=drag))).advance for drag in (0.1, 1.6)]
    assert gains == sorted(gains, reverse=True)
    assert gains[-1] < 0.1


@pytest.mark.slow
# Those of the first two sizes are predicted by other tests too.
@pytest.mark.parametrize("q", cases([0.005, 0.020, 0.004, 0.0155, 0.023], [0.005, 0.020]))
def test_the_margin_is_the_force_on_a_cell_that_changes_the_gait(q):
    one = robot(q)
    prediction = one.predict().leg("left")
    inside = {gaits(with_force(one, s * 0.98 * prediction.margin))["left"] for s in (1, -1)}
    outside = {gaits(with_force(one, s * 1.02 * prediction.margin))["left"] for s in (1, -1)}
    assert inside == {prediction.gait}
    assert outside == {prediction.gait, prediction.nearest}


@pytest.mark.slow
def test_a_robot_close_to_another_gait_says_so():
    # At q_x = 10 mm both cells are alike; the weight alone decides.
    for q in np.linspace(0.010, 0.025, 31):
        if gaits(robot(q)) != gaits(robot(q + 0.0001)):
            prediction = robot(q).predict()
            assert prediction.near_boundary
            assert not prediction.confident
            assert "near a boundary" in repr(prediction)
            break
    else:
        pytest.fail("the gait never changed")


@pytest.mark.slow
def test_slow_drives_leave_less_unknown():
    fast, slow = (robot(drive=Drive(period=t)).predict().legs[0] for t in (2.0, 20.0))
    assert slow.uncertainty == pytest.approx(fast.uncertainty / 10)


@pytest.mark.slow
def test_a_push_slips_beyond_its_largest_drag_and_not_well_before():
    push = robot().predict().legs[0].pushes[0]
    assert push.limit is PushEnd.SLIP
    assert push.loading
    assert push.step > 0

    def gain(drag):
        return motion(robot(floor=Floor(drag=drag))).advance

    assert gain(2.0 * push.largest_drag) < 0.1
    assert gain(0.3 * push.largest_drag) > 0.7


@pytest.mark.slow
def test_the_largest_drag_is_friction_at_balance_by_hand():
    # Feet that carry N each hold 2 µ N against the drag share of the rest of the weight.
    one = robot(0.005)
    push = one.predict().legs[0].pushes[-1]
    assert not push.loading
    grip = 2 * one.floor.foot_friction * push.load
    assert push.limit is PushEnd.SLIP
    assert push.largest_drag == pytest.approx(
        grip * one.weight / (one.weight - 2 * push.load), rel=0.05
    )
    assert push.safety == push.largest_drag / one.floor.drag


@pytest.mark.slow
def test_an_antenna_flips_the_opposite_leg_where_it_says():
    one = explorer()
    prediction = one.predict()
    assert prediction.motion is Motion.FORWARD
    flips = prediction.leg("right").flips
    assert [flip.antenna for flip in flips] == ["left"] * len(flips)
    assert flips[-1].gait == BACKWARD
    assert flips[0].before == FORWARD
    for flip in flips:
        assert flip.earliest <= flip.displacement <= flip.latest
        assert flip.swing == pytest.approx(flip.displacement / one.antennas[0].gear)
    before = motion(one.pressed({"left": 0.9 * flips[0].swing}))
    after = motion(one.pressed({"left": 1.1 * flips[-1].swing}))
    assert before.gaits == prediction.gaits
    assert after.gaits == {"left": FORWARD, "right": BACKWARD}
    # The obstacle is on the left, and the robot turns away from it.
    assert after.turn < -TURNS


@pytest.mark.slow
def test_an_antenna_whose_lever_is_off_flips_nothing():
    assert explorer(connected=False).predict().flips == ()


@pytest.mark.slow
def test_a_leg_of_three_cells_is_predicted_too():
    def long(name, side):
        cells = [cell("first", 0.008), cell("second", 0.010), cell("lift", 0.022)]
        return Leg(name, sw.Chain(cells), (0.008, side * 0.0575))

    prediction = Robot(
        [long("left", 1), long("right", -1)],
        drive=Drive(amplitude=0.060),
        body=Body(supports=((-0.055, 0.0), (0.038, 0.045), (0.038, -0.045))),
    ).predict()
    states = prediction.leg("left").gait
    assert states.split(">")[0] == states.split(">")[-1] == "000"
    assert "111" in states
    assert prediction.turn == pytest.approx(0.0, abs=2e-3)


@pytest.mark.slow
def test_a_drive_that_turns_back_early_never_opens_both_cells():
    assert "11" not in gaits(robot(drive=Drive(amplitude=0.020)))["left"]


@pytest.mark.slow
def test_a_prediction_is_frozen_and_says_what_it_rests_on():
    prediction = robot().predict()
    with pytest.raises(FrozenInstanceError):
        prediction.advance = 1.0  # pyright: ignore[reportAttributeAccessIssue]
    says(repr(prediction), "Prediction(walks forward", "left 00>10>11>01>00", "right")
    assert any("inertia" in line for line in prediction.assumptions)
    assert "forward while loading" in repr(prediction.legs[0].pushes[0])
    with pytest.raises(ValueError, match="leg = 'middle'"):
        prediction.leg("middle")


@given(st.lists(st.floats(0.05, 0.95), min_size=0, max_size=4, unique=True))
def test_every_change_along_a_range_is_found_where_it_is(edges):
    edges = sorted(edges)
    if any(b - a < 0.03 for a, b in pairwise(edges)):
        return

    def answer(value):
        return str(sum(value >= edge for edge in edges))

    places = list(changes(answer, np.linspace(0.0, 1.0, 51).tolist()))
    assert [past for _, past in places] == [str(k + 1) for k in range(len(edges))]
    assert [value for value, _ in places] == pytest.approx(edges, abs=1e-4)


@pytest.mark.slow
def test_unlike_legs_on_the_floor_lift_together_or_not_at_all():
    # Alone the left leg would step; but the right one lifts, and the body leans onto the left.
    one = Robot(
        [leg("left", 0.01888), leg("right", 0.01455)],
        foot=Foot(below=0.00119, mass=0.0031),
        floor=Floor(drag=0.222),
        body=Body(mass=0.273, centre=(0.0264, -0.0021, 0.012)),
    )
    assert gaits(one) == {"left": VIA_01, "right": VIA_01}


def below(one, depth):
    return replace(one, foot=replace(one.foot, below=depth))


@pytest.mark.slow
def test_feet_stand_in_the_middle_of_the_depths_at_which_the_papers_robots_do_as_they_should():
    # q_out = 20 mm walks unless the feet are too deep, 15 mm does not unless they are too flat.
    walks, stays = robot(0.020), robot(0.015)
    assert walks.foot == stays.foot == Foot()
    (_, most), (least, _) = walks.predict().depths[0], stays.predict().depths[0]
    assert least < Foot().below < most
    assert Foot().below == pytest.approx((least + most) / 2, abs=3e-5)


@pytest.mark.slow
def test_beyond_the_depths_that_are_reported_a_gait_is_near_another_and_within_them_it_is_not():
    one = robot()
    low, high = one.predict().depths[0]
    assert low == 0.0
    assert below(one, high - 2e-5).predict().confident
    assert below(one, high + 2e-5).predict().near_boundary
    # Without room both ends are its own depth.
    deep = below(one, high + 2e-5)
    assert depths(deep) == ((deep.foot.below,) * 2,) * 2


@pytest.mark.slow
def test_depths_that_the_engine_cannot_follow_are_not_sure_and_do_not_break_the_text(monkeypatch):
    one = replace(robot(), title="Robot of this test alone")
    module = sys.modules["stepwell.robot.leg_cycles"]
    honest = module.run_leg_cycle

    def lost_when_deeper(leg, stances, *others):
        if stances[0].robot.foot.below > 0.95e-3:
            raise StaticsError("the engine could not go on")
        return honest(leg, stances, *others)

    prediction = one.predict()
    monkeypatch.setattr(module, "run_leg_cycle", lost_when_deeper)
    assert prediction.depths[0][1] == pytest.approx(0.95e-3, abs=2e-5)
    assert "preload 0.00 to 0.9" in repr(prediction)


@pytest.mark.slow
def test_the_shortest_last_cell_of_all_legs_limits_the_depth():
    left, right = leg("left", 0.020), leg("right", 0.020)
    stiff = sw.Chain([cell("inner", 0.010, k=60.0), cell("outer", 0.020, k=60.0)])
    # The same stroke of 40 mm, of which 12 mm lift the right foot.
    wide = replace(cell("inner", 0.009), lever=0.028 / math.sqrt(2))
    low = replace(cell("outer", 0.020, k=60.0), limit=math.asin(0.006 / (0.010 * math.sqrt(2))))
    one = Robot([replace(left, chain=stiff), replace(right, chain=sw.Chain([wide, low]))])
    rises = [
        float(one.foot.depth(0.0) - one.foot.depth(leg.chain.cells[-1].full_travel))
        for leg in one.legs
    ]
    assert rises[1] < rises[0]
    assert max(deep for _, deep in depths(one)) <= rises[1]


def test_the_depths_of_unlike_legs_are_reported_for_each():
    prediction = robot(0.005, 0.020).predict()
    backward, forward = prediction.depths
    assert backward[1] > 2 * forward[1]
    assert f"preload 0.00 to {forward[1] * 1e3:.2f} mm" in repr(prediction)
