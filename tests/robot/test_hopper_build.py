"""Frame, foot bar and sole of a hopper, and what impacts ask of the parts of its chain."""

import math

import pytest

import stepwell as sw
from facts import says
from hoppers import hopper
from stepwell.accounts import account, terminal
from stepwell.build import FileOptions, build_files, loads_build_file
from stepwell.build.contour import Contour

# The build file of docs/how-to/jump.md.
MATERIAL = """
base = "plywood-3mm"
title = "Plywood, 4 mm, for a hopper"
sheet.thickness_mm = 4
hook.diameter_mm = 8
grid.pitch_mm = 10
band.largest_stretch = 2.5
band.free_lengths_mm = [40]
"""


@pytest.fixture(scope="module")
def made():
    return sw.build(hopper(), loads_build_file(MATERIAL), samples=20)


def test_both_hoppers_can_be_built_with_frame_foot_bar_and_sole(made):
    forward = sw.build(hopper("hopper-forward"), made.build_file, samples=20, swept=made.sweep)
    assert made.can_be_built and forward.can_be_built
    assert made.of_hopper is not None and forward.of_hopper is not None
    straight, slanted = made.of_hopper.plates, forward.of_hopper.plates
    assert [plate.name for plate in straight] == ["frame-1", "frame-2", "foot-bar", "sole"]
    assert slanted[2].outline.bounds[2] > straight[2].outline.bounds[2]
    assert slanted[:2] == straight[:2]


def test_the_built_masses_are_those_of_the_preset_within_a_tenth(made):
    others = made.of_hopper
    actuator, springs = 0.050, hopper().springs.mass
    assert others.body_mass + actuator + springs == pytest.approx(0.190, rel=0.1)
    assert others.foot_mass == pytest.approx(hopper().foot_mass, rel=0.1)
    # Everything that is cut or screwed is in one of both.
    every = 2 * (made.mass - sum(p.mass(680.0) for p in others.plates) + made.fastener_mass)
    every += sum(plate.mass(680.0) for plate in others.plates)
    assert others.body_mass + others.foot_mass == pytest.approx(every, rel=1e-9)


def test_the_pins_of_the_foot_stay_in_the_slots_and_off_the_frame(made):
    frame, _, bar, _ = made.of_hopper.plates
    at_0 = made.layout.positions(made.layout.angles("00"))[1]
    at_1 = made.layout.positions([0.0, 0.0])[1]
    moved = abs(at_1[1] - at_0[1])
    slots = [one for one in bar.cutouts if isinstance(one, Contour)][:4]
    for slot in slots:
        x0, y0, x1, y1 = slot.bounds
        assert y1 - y0 - (x1 - x0) == pytest.approx(moved)
    # The foot is nearest to the body at 0.
    assert bar.outline.bounds[0] > frame.outline.bounds[2]
    # The mount holes of both chains are mirror images.
    assert sum(hole.centre[1] for hole in frame.holes) == pytest.approx(0.0, abs=1e-12)


def test_impacts_are_shared_by_chains_and_levers_and_the_pad_keeps_the_strength(made):
    whole = sw.robot.impacts(hopper(), sw.robot.bound_of(hopper(), sw.robot.snap_of(hopper())))
    strength = made.build_file.sheet.strength
    for load, impact in zip(made.of_hopper.impacts, whole, strict=True):
        assert load.energy == pytest.approx(impact.energy / 2)
        # Both levers at 45° carry the force along the stroke.
        assert 2 * load.lever_force * math.sin(math.pi / 4) == pytest.approx(load.force)
        assert load.bearing == pytest.approx(load.lever_force / (0.003 * 0.004))
        # With such a pad the worst stress is the strength.
        assert load.bearing * 1e-3 / load.give == pytest.approx(strength)


def test_the_account_and_the_files_have_the_plates_and_the_loads(made):
    report = account(made)
    says([line.text for line in terminal(report, full=True)], "frame", "foot bar", "sole")
    record = report.record["hopper"]
    assert [row["name"] for row in record["impacts"]] == [
        *("stop of the snap", "landing", "return snap")
    ]
    assert report.record["parts"][-1]["name"] == "sole"
    files = build_files(made, FileOptions(nest=0.0))
    assert {"parts/foot-bar.dxf", "parts/sole.stl", "template/frame-1.svg"} <= {*files}
    says(str(files["parts.csv"]), "foot-bar", "plywood")
    chain = sw.build(hopper().chain, made.build_file, samples=2, swept=made.sweep)
    assert account(chain).record["hopper"] is None


def test_a_sole_that_exceeds_the_bed_is_found(made):
    long = hopper(foot_length=0.7)
    found = sw.build(long, made.build_file, samples=2, swept=made.sweep).findings
    assert [one.check for one in found] == ["bed"]
    says(str(found[0]), "sole", "700")
