"""`stepwell check --recording`: from a design over its parts to a verdict on a built copy."""

import numpy as np
import pytest

import stepwell as sw
from facts import says
from lab.test_copy import FORWARD, HOLE, displaced, recorded
from stepwell.design import DEFAULT_TOLERANCES, Draws


@pytest.fixture
def copies(stepwell):
    """The design of a pair on the holes of a build, and recordings of two copies as files."""
    made = stepwell("design", FORWARD, "--build", "acrylic-3mm", "--samples", 50, "--out", "leg")
    assert made.exit_code == 0, made.output
    chain = sw.load("leg/design.toml")
    built = Draws(chain, DEFAULT_TOLERANCES, 1).sample(2)
    for name, copy in (("good", built), ("wrong", displaced(built, 1, -HOLE, 0.0))):
        run = recorded(copy, noise=0.003)
        table = np.column_stack([run.time, 1e3 * run.stroke, run.force])
        header = "time (s),displacement (mm),force (N)"
        np.savetxt(f"{name}.csv", table, delimiter=",", header=header, comments="")
    return chain


def test_a_good_copy_is_good_and_the_band_in_a_wrong_hole_is_named(stepwell, copies):
    good = stepwell("check", "leg/design.toml", "--recording", "good.csv", "--out", "verdict")
    assert good.exit_code == 0, good.output
    says(good.output, "Good")
    assert sw.load("verdict/copy.toml").names == copies.names
    wrong = stepwell("check", "leg/design.toml", "--recording", "wrong.csv")
    assert wrong.exit_code == 3
    says(" ".join(wrong.output.split()), "Differs", "q of outer", "move it to")


@pytest.mark.parametrize(
    ("options", "fact"),
    [
        (("preset:paper-forward", "--leg", "left"), "needs --recording"),
        (("preset:paper-forward", "--leg", "left", "--recording", "good.csv"), "is a chain"),
        (("preset:robot-forward", "--leg", "up", "--recording", "good.csv"), "be one of"),
        (("preset:paper-forward", "--recording", "gone.csv"), "does not exist"),
    ],
)
def test_options_that_do_not_fit_are_refused(stepwell, options, fact):
    with open("good.csv", "w", encoding="utf-8") as file:
        file.write("time (s),displacement (mm),force (N)\n0,0,0\n1,1,1\n")
    result = stepwell("check", *options)
    assert result.exit_code == 2
    says(" ".join(result.output.split()), fact)
