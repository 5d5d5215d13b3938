"""Promises about a robot's sweep and its limits: proved freedom, overlaps, ways out."""

import io
import math
import re
from dataclasses import replace

import ezdxf.filemanagement
import numpy as np
import pytest
import shapely
from shapely import affinity

import stepwell as sw
from build.test_robot_layout import made, random_poses
from facts import refuses, says
from stepwell.base import InputError
from stepwell.build import (
    FileOptions,
    MotionSweep,
    build_files,
    draft_comment,
    load_build_file,
    robot_layout,
)
from stepwell.build.exports.robot_steps import robot_steps
from stepwell.build.robots.robot_limits import head_on, robot_webs
from stepwell.build.sweeps import TOUCH

ACRYLIC = load_build_file("acrylic-3mm")
FREE = MotionSweep(True, (), (), (), 0, 0)


def preset(name):
    return sw.preset(f"robot-{name}")


def unswept(robot, build_file=ACRYLIC):
    """A build without its sweep, which takes seconds."""
    return sw.build(robot, build_file, swept=FREE)


def placed(shape, frame):
    c, s = math.cos(frame.angle), math.sin(frame.angle)
    return affinity.affine_transform(shape, (c, -s, s, c, frame.x, frame.y))


def solids(layout, pose, *, upright):
    """Name, body, area in one plane, and its heights, of parts and fasteners at a pose."""
    frames = layout.frames(pose)
    for part in layout.parts:
        frame = frames[part.name]
        if frame.upright is upright:
            shape = placed(part.polygon(1e-5), frame)
            yield part.name, layout.body[part.name], shape, part.base, part.top
    for one in layout.fasteners:
        if one.upright is upright and one.use != "shim":
            moved = layout.moved(str(one.block), pose)
            (x, y), (hx, hy) = one.centre, moved.hinge
            spot = affinity.rotate(
                shapely.Point(x, y).buffer(one.diameter / 2), moved.turn[0], (hx, hy), True
            )
            spot = affinity.translate(spot, *moved.shift[0])
            yield f"{one.use} {one.name}", str(one.block), spot, one.low, one.high


def overlaps(layout, pose, *, upright):
    """Pairs of names of solids of two bodies that overlap at a pose, by areas alone."""
    every = list(solids(layout, pose, upright=upright))
    shapes = [one[2] for one in every]
    for i, j in shapely.STRtree(shapes).query(shapes, "intersects").T:
        (a, of_a, one, low_a, high_a), (b, of_b, other, low_b, high_b) = every[i], every[j]
        apart = of_a == of_b or min(high_a, high_b) - max(low_a, low_b) < 1e-6
        if i < j and not apart and not one.intersection(other).buffer(-TOUCH).is_empty:
            yield {a, b}


@pytest.mark.parametrize("name", ["forward", "antennas"])
def test_a_reference_robot_is_free_at_all_states_and_antenna_positions(name):
    one = made(f"robot-{name}")
    assert one.sweep.free
    assert one.sweep.collisions == one.sweep.undecided == ()
    assert one.findings == ()


@pytest.mark.parametrize("upright", [False, True])
def test_no_areas_overlap_at_random_poses(upright):
    layout = made("robot-antennas").layout
    poses = list(random_poses(layout, 12))
    corners = [low for _, (low, _) in layout.motions.ranges().items()]
    poses += [dict(zip(layout.motions.ranges(), corners, strict=True))]
    poses += [{k: high for k, (_, high) in layout.motions.ranges().items()}]
    for pose in poses:
        # Strokes of both legs are equal, as one carriage has one place.
        pose |= {("right", i): pose["left", i] for i in (0, 1)}
        assert list(overlaps(layout, pose, upright=upright)) == []


def test_least_clearances_are_those_of_the_fits_and_of_the_swept_study():
    least = {
        tuple(sorted(c.parts)): c.distance
        for c in reversed(made("robot-antennas").sweep.clearances)
    }
    rail = ACRYLIC.robot.rail_fit
    assert least["body", "carriage"] == pytest.approx(rail, abs=1e-5)
    assert least["carriage", "left.outer.block"] == pytest.approx(ACRYLIC.robot.slot_fit, abs=1e-5)
    assert least["left.inner.block", "left.inner.lever 1"] == pytest.approx(0.8e-3, abs=1e-5)
    # Stops of cells and cranks touch.
    assert least["body", "left.inner.block"] < TOUCH
    assert least["body", "left.crank"] < TOUCH
    assert least["body", "cord of left"] == pytest.approx(1.1e-3, abs=2e-4)


def test_a_band_that_hits_another_part_is_found_at_a_pose_where_the_areas_overlap():
    robot = preset("forward").with_anchors("left", "outer", q=(0.060, 0.0))
    one = sw.build(robot)
    hit = next(c for c in one.sweep.collisions if c.parts == ("left-outer-top", "rod"))
    assert not one.can_be_built and not one.sweep.free
    top = one.layout.part("left-outer-top")
    area = placed(top.polygon(1e-5), one.layout.frames(dict(hit.pose))["left-outer-top"])
    assert area.bounds[1] < ACRYLIC.linear_actuator.rod / 2.0  # over the rod on the midline
    first = one.findings[0]
    assert first.check == "collision"
    says(str(first), "left-outer-top", "overlap by", "mm", "Use p = (", "left outer")
    # The advice frees the two parts that meet most, and changes no motion.
    (p, q) = re.findall(r"[pq] = \((-?[\d.]+), 0\)", first.advice)
    assert float(q) - float(p) == pytest.approx(70.0)
    moved = robot.with_anchors("left", "outer", (1e-3 * float(p), 0.0), (1e-3 * float(q), 0.0))
    assert not any(c.parts == first.parts for c in sw.build(moved).sweep.collisions)


BAD = {
    "weak": (preset("forward"), {"linear_actuator__force": 1.0}, "actuator", "force_N"),
    "short": (preset("forward"), {"linear_actuator__travel": 0.03}, "actuator", "travel_mm = 40"),
    "posts": (preset("forward"), {"robot__standoff": 0.038}, "post", "standoff_mm = 36"),
    "feet": (preset("forward"), {"robot__link_width": 0.0125}, "post", "foot_radius_mm = 8"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_limit_is_found_with_numbers_and_its_advice_removes_it(name):
    robot, change, check, fact = BAD[name]
    build_file = ACRYLIC.with_lengths(**change)
    (found,) = unswept(robot, build_file).findings
    assert found.check == check
    says(found.advice, fact)
    assert found.value != found.allowed
    mended = build_file.with_lengths(**found.change)
    assert unswept(robot, mended).findings == ()


def test_a_foot_deeper_than_its_rail_allows_is_found_and_longer_links_keep_the_depth():
    robot = preset("forward")
    deep = replace(robot, foot=replace(robot.foot, span=0.030))
    (found,) = (one for one in unswept(deep).findings if one.check == "rail")
    says(found.problem, "31.62 mm below", "foot.span_mm = 30", "34.05 mm")
    says(found.advice, "foot.span_mm = 34.1", "foot.link_mm = 36")
    mended = replace(robot, foot=replace(robot.foot, span=0.0341, link=0.036))
    assert unswept(mended).findings == ()
    assert float(mended.foot.depth(0.0)) == pytest.approx(0.03162, abs=2e-4)


def test_antennas_whose_hubs_meet_are_found_with_the_place_for_their_hubs():
    robot = preset("antennas")
    near = replace(
        robot,
        antennas=[
            replace(one, pivot=(one.pivot[0], math.copysign(0.002, one.pivot[1])))
            for one in robot.antennas
        ],
    )
    found = next(one for one in unswept(near).findings if one.check == "antenna")
    says(str(found), "meet at rest", "4 mm apart", "y = 24.72 and -24.72 mm")
    moved = replace(
        robot,
        antennas=[
            replace(one, pivot=(one.pivot[0], math.copysign(0.02472, one.pivot[1])))
            for one in robot.antennas
        ],
    )
    assert sw.build(moved).can_be_built


def test_a_nose_too_long_for_the_antennas_is_found():
    long = ACRYLIC.with_lengths(linear_actuator__closed=0.135)
    found = [one for one in unswept(preset("antennas"), long).findings if one.check == "nose"]
    says(str(found[0]), "x = 130 mm", "by 2.79", "3.465 mm", "x = 119.4 mm")
    # The study: at x = 115 a wall ahead presses enough, at 118 hardly.
    (plan, _) = robot_layout(preset("antennas"), ACRYLIC).plan.antennas
    assert head_on(plan, 0.115) > 3.5e-3
    assert head_on(plan, 0.110 + 0.130) == pytest.approx(0.0, abs=1e-4)
    assert np.all(np.diff([head_on(plan, x) for x in np.linspace(0.112, 0.17, 20)]) <= 1e-12)


def test_an_actuator_of_118_mm_fits_in_front_of_a_pressed_antenna():
    longer = {"linear_actuator__closed": 0.118, "linear_actuator__length": 0.109}
    assert sw.build(preset("antennas"), ACRYLIC.with_lengths(**longer)).can_be_built


@pytest.mark.parametrize(
    ("change", "facts"),
    [
        ({"cell": 1}, ["inner cell only", "cell = 'inner'"]),
        ({"moves": (0.004, 0.0)}, ["moves = (4, 0) mm", "(-4, 0) mm"]),
        ({"angle": -1.1}, ["antenna 'left'", "other side"]),
    ],
)
def test_an_antenna_without_a_layout_is_refused_with_what_to_change(change, facts):
    robot = preset("antennas")
    left, right = robot.antennas
    with refuses(InputError, *facts):
        robot_layout(replace(robot, antennas=[replace(left, **change), right]), ACRYLIC)


def test_a_slow_actuator_means_a_longer_period_which_a_note_states():
    slow = ACRYLIC.with_lengths(linear_actuator__speed=0.0062)
    one = unswept(preset("forward"), slow)
    # The study: 13 s with a 210:1 gear.
    assert one.least_period == pytest.approx(13, abs=0.1)
    assert one.robot.drive.period == one.least_period
    says(" ".join(one.notes), "period of 2 s", "12.9 s")


def test_legs_and_antennas_of_any_name_have_parts_with_names_for_files():
    robot = preset("antennas")
    legs = [replace(leg, name=f"{leg.name}.a/b") for leg in robot.legs]
    antennas = [replace(one, name=f"{one.name} /", leg=f"{one.leg}.a/b") for one in robot.antennas]
    one = sw.build(replace(robot, legs=legs, antennas=antennas))
    assert one.can_be_built
    names = [part.name for part in one.layout.parts]
    assert {"leg1-middle-top", "leg2-slider-core", "antenna2-crank"} <= {*names}
    assert one.mass == pytest.approx(made("robot-antennas").mass)


def test_every_part_fastener_and_band_is_in_one_step_of_the_guide():
    one = made("robot-antennas")
    steps = robot_steps(one)
    shown = [item for step in steps for item in (*step.new, *step.hidden)]
    layout = one.layout
    every = [*layout.parts, *layout.fasteners, *layout.bands, *layout.boxes]
    assert len(shown) == len(every)
    assert {id(item) for item in shown} == {id(item) for item in every}
    titles = [step.title for step in steps]
    assert titles.index("Bands") < titles.index("Caps")
    assert titles[0] == "T-foot"


@pytest.mark.slow
def test_the_files_of_a_robot_are_those_of_a_chain():
    one = made("robot-forward")
    files = build_files(one, FileOptions(nest=0))
    for part in one.layout.parts:
        assert {f"parts/{part.name}.{kind}" for kind in ("dxf", "svg", "stl")} <= {*files}
    assert {"coupon.dxf", "guide.pdf", "template-A4.pdf", "parts.csv", "bands.csv"} <= {*files}
    bands = [row.split(",")[:4] for row in str(files["bands.csv"]).splitlines()[1:]]
    assert bands[0] == ["left inner", "1", "left-inner-p", "left-inner-q"]
    assert len(bands) == 4
    says(str(files["parts.csv"]), "bought,actuator", "L12", "36.00")
    says(str(files["guide.html"]), "Before you pull", "rail_friction_N")
    drawing = ezdxf.filemanagement.read(io.StringIO(str(files["parts/body-plate.dxf"])))
    assert not drawing.audit().errors
    # Two rails, four windows, two mortises, the outline; and round holes.
    lines = drawing.modelspace().query("LWPOLYLINE")
    assert len(lines) == 9


def test_drafts_of_a_robot_say_why():
    short = ACRYLIC.with_lengths(linear_actuator__travel=0.03)
    one = unswept(preset("forward"), short)
    says(draft_comment(one), "# DRAFT", "travel_mm = 40")
    with refuses(InputError, "1 checks failed", "--draft"):
        build_files(one)


def test_a_crank_whose_stops_do_not_fit_is_found_with_the_displacement_that_fits():
    robot = preset("explorer")
    layout = robot_layout(robot, ACRYLIC)
    found = {one.parts[0]: one for one in robot_webs(layout)}
    says(str(found["right-body-top"]), "left-stop-2", "not on the", "antenna.moves_mm")
    most = {
        name: float(re.findall(r"of ([\d.]+) mm", one.advice)[0]) for name, one in found.items()
    }
    antennas = [
        replace(one, moves=(-1e-3 * most[f"{one.leg}-body-top"], 0.0)) for one in robot.antennas
    ]
    assert list(robot_webs(robot_layout(replace(robot, antennas=antennas), ACRYLIC))) == []
