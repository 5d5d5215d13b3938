"""Promises about limits: every exceeded one is named with numbers and a way out that works."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from build import chains
from facts import says
from stepwell.build import layout, load_build_file
from stepwell.build.limits import findings
from stepwell.build.loads import hook_loads, lever_forces

ACRYLIC = load_build_file("acrylic-3mm")


def found(chain, check, **lengths):
    """Findings of one kind."""
    made = layout(chain, ACRYLIC.with_lengths(**lengths))
    return [one for one in findings(made, chain.cycle().path) if one.check == check]


def with_bands(chain, **changes):
    """The chain with other bands."""
    cells = [
        replace(c, band=tuple(replace(b, **changes) for b in c.bands), unusual=True)
        for c in chain.cells
    ]
    return replace(chain, cells=tuple(cells))


@pytest.mark.parametrize("name", [n for n in sw.presets() if "paper" in n])
def test_the_papers_mechanisms_exceed_no_limit(name):
    chain = sw.load(f"preset:{name}")
    assert findings(layout(chain, ACRYLIC), chain.cycle().path) == ()


def test_bands_beyond_their_stretch_are_named_with_the_rest_length_that_is_enough():
    (one,) = found(chains.pair(), "stretch", band__largest_stretch=4.0)
    # 30 mm of anchors and 14.14 mm of lever, over 10 mm.
    assert one.value == pytest.approx((30.0 + 14.142) / 10.0, abs=1e-3)
    says(str(one), "band 1 of cell 2", "44.14 mm", "10 mm", "band.largest_stretch", "4")
    says(one.advice, "11.1 mm")
    assert not found(
        with_bands(chains.pair(), rest_length=0.0111), "stretch", band__largest_stretch=4.0
    )


def test_bands_that_push_or_have_no_rest_length_are_no_rubber_bands():
    pushing = with_bands(chains.pair(), two_sided=True, rest_length=0.032)
    (one, *_) = found(pushing, "stretch")
    says(str(one), "band 1 of cell 1", "32 mm", "two_sided = false")
    assert not found(with_bands(pushing, two_sided=False), "stretch")
    says(str(found(with_bands(chains.pair(), rest_length=0.0), "stretch")[0]), "rest length is 0")


def test_a_band_whose_hooks_lie_off_both_blocks_gets_the_least_distance_that_fits():
    off = sw.Chain([chains.cell((5, 0), (0, 0), 13.0, 45.0)])
    one = found(off, "anchor")[0]
    # Both hooks reach the faces less half a hook and a web: r cos θc - 3 - 3 mm.
    says(str(one), "band 1 of cell 1", "-5 mm", "q_x - p_x", "-3.1 mm")
    assert not found(sw.Chain([chains.cell((3.1, 0), (0, 0), 13.0, 45.0)]), "anchor")


def test_a_band_that_is_slack_at_all_angles_is_named_with_its_reach():
    (one,) = found(sw.Chain([sw.Cell(chains.band((-10, 0), (10, 0), rest_length=0.06))]), "slack")
    assert one.parts == ("band 1 of cell 1",)
    says(str(one), "slack", "34.14", "60", "below 34.14")


@pytest.mark.parametrize(("p", "q"), [(-80, -60), (60, 90)])
def test_hooks_beside_their_plates_are_shifted_onto_them(p, q):
    made = sw.Chain([sw.Cell(chains.band((p, 0), (q, 0)))])
    assert not found(made, "anchor") and not found(made, "web")


def test_a_kerf_as_wide_as_a_hole_names_the_hole_and_both_sizes():
    (one,) = found(chains.pair(), "kerf", sheet__kerf_y=0.003)
    assert one.value == one.allowed == 0.003
    says(str(one), "hole", "3 mm", "sheet.kerf_y_mm")
    assert not found(chains.pair(), "kerf", sheet__kerf_y=0.0029)


def test_a_web_between_joint_and_face_that_is_too_thin_asks_for_longer_levers():
    short = sw.Chain([chains.cell((-10, 0), (10, 0), 8.0, 45.0)])
    one = found(short, "web")[0]
    # r cos θc / 2 less half a hole of 3 mm.
    assert one.value == pytest.approx(8e-3 * math.cos(math.pi / 4) / 2 - 1.5e-3, abs=1e-6)
    says(str(one), "block-0-bottom", "hole 1a", "the edge", "sheet.bridge_mm", "1.5")
    says(one.advice, "levers of 8.5 mm", "cell 1")
    assert not found(sw.Chain([chains.cell((-10, 0), (10, 0), 8.5, 45.0)]), "web")


def test_a_part_larger_than_the_bed_is_named_with_both_sizes():
    chain = chains.pair()
    made = layout(chain, ACRYLIC)
    small = replace(ACRYLIC.sheet, bed=(0.090, 0.200))
    assert not findings(made, None)
    assert not list(findings(layout(chain, replace(ACRYLIC, sheet=small)), None))
    small = replace(ACRYLIC.sheet, bed=(0.090, 0.060))
    (one, *_) = findings(layout(chain, replace(ACRYLIC, sheet=small)), None)
    assert one.check == "bed"
    says(str(one), "block-1-", "101 x 35 mm", "sheet.bed_mm", "90 x 60", "101 x 35")


def test_an_actuator_with_too_little_travel_or_force_gets_the_number_it_needs():
    (one,) = found(chains.pair(), "travel", actuator__travel=0.030)
    says(str(one), "40 mm", "actuator.travel_mm", "30")
    assert not found(chains.pair(), "travel", **one.change)
    (one,) = found(chains.pair(), "force", actuator__force=0.5)
    assert one.value == pytest.approx(abs(chains.pair().cycle().peak_force))
    assert not found(chains.pair(), "force", **one.change)


@pytest.mark.parametrize("check", ["bearing", "lever", "pin", "hook"])
def test_stiff_bands_overload_material_pins_and_hooks_and_the_advised_ones_do_not(check):
    stiff = with_bands(chains.pair(), stiffness=28.5 * 4000)
    one = found(stiff, check)[0]
    assert one.value > one.allowed
    says(str(one), "MPa", "strength_MPa")
    most = max(f.value / f.allowed for f in found(stiff, check))
    softer = with_bands(stiff, stiffness=28.5 * 4000 / most * 0.999)
    assert not found(softer, check)


def test_lever_forces_hold_every_block_in_equilibrium_along_the_free_motion():
    # Where cells move freely no stop acts: the force across their levers has to vanish.
    chain = sw.load("preset:paper-forward")
    made, path = layout(chain, ACRYLIC), chain.cycle().path
    theta = np.column_stack([c.angle(s) for c, s in zip(chain.levers, path.travel.T, strict=True)])
    force = lever_forces(made, path)
    for i, plan in enumerate(made.cells):
        free = np.abs(theta[:, i]) < plan.cell.limit - 1e-6
        lever = np.column_stack([np.sin(theta[:, i]), plan.side * np.cos(theta[:, i])])
        at = made.positions(theta)
        band = plan.cell.bands[0]
        path_ = made.bands[i]
        way = at[:, i] + path_.p - at[:, i + 1] - path_.q
        length = np.hypot(*way.T)
        total = band.tension(length)[:, None] * way / length[:, None]
        total = total + np.column_stack([path.force, 0 * path.force])
        left = total + force[:, i].sum(axis=1)[:, None] * lever
        assert np.abs(left[free]).max() < 1e-9


def test_hook_loads_add_the_bands_on_one_hook():
    chain = chains.crossed()
    loads = hook_loads(layout(chain, ACRYLIC))
    both = loads[1, "pD3"]
    assert len(both) == 2
    assert sum(pull for _, pull in both) == pytest.approx(2 * 28.5 * (0.044142 - 0.010), abs=1e-3)
