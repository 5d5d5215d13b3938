"""Parts that can be cut: what they refuse, and the masses they give a robot."""

from dataclasses import replace

import numpy as np
import pytest

from facts import refuses
from robot.made import FACES, parts
from robot.robots import explorer, robot
from stepwell.robot import BodyMass, Robot, RobotParts, Shape, body_names, with_parts
from stepwell.robot.stance import feet_load, supports_load

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def of(one: Robot, **changes: object) -> RobotParts:
    return replace(parts(one), **changes)


def test_bodies_of_the_robot_with_antennas_are_listed_once_in_a_fixed_order():
    names = body_names(explorer())
    assert len(set(names)) == len(names) == 2 + 2 * 10 + 2 * 2
    assert names[:5] == (
        *("body", "carriage", "left.inner.block", "left.inner.lever 1", "left.inner.lever 2"),
    )
    assert names[-1] == "right.crank"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"vertices": CUBE[:, :2]}, ("vertices of 'plate'", "(8, 2)", "(n, 3)")),
        ({"vertices": CUBE * np.nan}, ("vertices of 'plate'", "finite")),
        ({"vertices": CUBE[:3]}, ("3 vertices", "4 or more")),
        ({"faces": FACES + 1}, ("1 to 8", "0 to 7")),
        ({"faces": FACES * 1.0}, ("float64", "whole numbers")),
        ({"colour": "wing"}, ("colour = 'wing'", "'outer block'")),
    ],
)
def test_a_shape_that_is_no_solid_is_refused_with_what_is_allowed(change, words):
    given = {"body": "body", "part": "plate", "vertices": CUBE, "faces": FACES, "colour": "body"}
    with refuses(ValueError, *words):
        Shape(**given | change)


@pytest.mark.parametrize(
    "inertia",
    [np.diag([1.0, 1.0, 3.0]), np.diag([1.0, 1.0, 0.0]), [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]],
    ids=["longer than a rod", "flat in no time", "not symmetric"],
)
def test_an_inertia_that_no_solid_has_is_refused(inertia):
    with refuses(ValueError, "inertia of 'body'", "symmetric", "g mm²"):
        BodyMass("body", 0.1, np.zeros(3), np.array(inertia, float))


def test_arrays_of_a_part_cannot_be_written_and_equal_parts_are_equal():
    one, other = parts(robot()), parts(robot())
    assert one == other
    assert hash(one) == hash(other)
    with pytest.raises(ValueError, match="read-only"):
        one.shapes[0].vertices[0] = 0.0
    moved = replace(one.shapes[0], vertices=one.shapes[0].vertices + 1e-6)
    assert moved != one.shapes[0]


def test_every_body_has_one_mass_and_every_shape_and_hinge_a_body():
    given = parts(robot())
    with refuses(ValueError, "'body'", "given twice"):
        replace(given, masses=[*given.masses, given.masses[0]])
    with refuses(ValueError, "shapes", "'body'", "no mass"):
        replace(given, masses=given.masses[1:])
    with refuses(ValueError, "hinges", "'tail'", "no mass"):
        replace(given, hinges={"tail": (0.0, 0.0, 0.0)})


def test_a_robot_made_of_parts_weighs_what_they_weigh_and_has_their_centre():
    one = with_parts(explorer(), given := parts(explorer()))
    assert one.mass == pytest.approx(given.mass, rel=1e-12)
    # Middle block, slider, half of four levers and of a link; outer block, and half of two levers.
    assert one.blocks.masses(2) == pytest.approx((0.010 + 0.011 + 0.0025, 0.0058 + 0.001))
    assert one.blocks.carriage == pytest.approx(0.0195 + 2 * 0.0005)
    assert one.body.mass == pytest.approx(0.160 + 2 * 0.001 + 2 * 0.001)
    assert one.foot.mass == pytest.approx(0.0035 + 0.001)
    # Statics puts each part at its pivot, and the whole has the parts' centre of mass.
    travels, lifted = [np.zeros(2), np.zeros(2)], np.zeros(2)
    held = supports_load(one, travels, lifted)
    assert held.sum() == pytest.approx(one.weight)
    at = held @ np.array(one.body.supports) / held.sum()
    assert at == pytest.approx(given.centre[:2], abs=1e-12)
    assert feet_load(one, travels).min() > 0.0


def test_parts_of_another_robot_are_refused_with_the_part():
    one = with_parts(robot(), given := parts(robot()))
    with refuses(ValueError, "parts weigh", "g", "remove the parts"):
        replace(one, body=replace(one.body, mass=0.3))
    with refuses(ValueError, "'left.crank'", "no hinge"):
        hinges = {k: v for k, v in parts(explorer()).hinges.items() if k != "left.crank"}
        with_parts(explorer(), replace(parts(explorer()), hinges=hinges))
    with refuses(ValueError, "'left.antenna'", "no mass"):
        with_parts(explorer(), given)
    with refuses(ValueError, "not of this"):
        replace(with_parts(explorer(), parts(explorer())), antennas=())


def test_parts_that_put_the_weight_outside_the_supports_are_refused():
    narrow = robot()
    shifted = [
        replace(mass, centre=mass.centre + np.array([0.1 * (mass.body == "body"), 0.0, 0.0]))
        for mass in parts(narrow).masses
    ]
    with pytest.raises(ValueError, match=r"body\.centre"):
        with_parts(narrow, of(narrow, masses=shifted))
