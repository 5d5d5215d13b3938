"""Promises about layouts: anchors, joints, stops and drive where the mechanics puts them."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from build import chains
from facts import refuses
from stepwell.build import layout, load_build_file
from stepwell.build.drive import slot_reach

ACRYLIC = load_build_file("acrylic-3mm")
MADE = {
    name: layout(getattr(chains, name)(), ACRYLIC)
    for name in ("pair", "mixed", "slotted", "crossed", "eight")
}
made = pytest.mark.parametrize("made", MADE.values(), ids=MADE)


def random_angles(made, seed=0, count=20):
    limits = np.array([one.cell.limit for one in made.cells])
    return np.random.default_rng(seed).uniform(-limits, limits, (count, len(limits)))


def in_plan(made, angles, name, point):
    """A point of a part in plan."""
    x, y, turn = made.frames(angles)[name]
    c, s = math.cos(turn), math.sin(turn)
    return np.array([x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]])


@made
def test_the_distance_of_anchors_is_the_length_of_the_band_by_the_engine(made):
    for angles in random_angles(made):
        at = made.positions(angles)
        for path in made.bands:
            cell = made.cells[path.cell].cell
            ends = at[path.cell] + path.p, at[path.cell + 1] + path.q
            length = cell.bands[path.number].length(angles[path.cell], cell.lever)
            assert math.dist(*ends) == pytest.approx(float(length), abs=1e-12)


@made
def test_blocks_travel_along_the_stroke_as_the_cells_do_and_swing_across_it(made):
    start = made.positions([-one.cell.limit for one in made.cells])
    for angles in random_angles(made):
        steps = np.diff(made.positions(angles), axis=0) - np.diff(start, axis=0)
        for i, one in enumerate(made.cells):
            travel = float(one.cell.travel(angles[i]))
            swing = one.cell.lever * (math.cos(angles[i]) - math.cos(one.cell.limit))
            assert steps[i] == pytest.approx([travel, one.side * swing], abs=1e-12)


@made
def test_both_ends_of_every_lever_are_on_the_joints_of_both_blocks(made):
    for angles in random_angles(made, count=5):
        for i, one in enumerate(made.cells):
            for letter in "ab":
                name = f"lever-{i + 1}{letter}"
                inner = in_plan(made, angles, name, (0.0, 0.0))
                outer = in_plan(made, angles, name, (one.cell.lever, 0.0))
                for block, end in ((i, inner), (i + 1, outer)):
                    part = f"block-{block}-bottom"
                    hole = made.part(part).hole(f"{i + 1}{letter}")
                    joint = in_plan(made, angles, part, hole.centre)
                    assert end == pytest.approx(joint, abs=1e-12)


@made
def test_hooks_stand_in_holes_of_the_top_plates_at_the_anchors(made):
    for path in made.bands:
        for block, name, anchor in (
            (path.cell, path.holes[0], path.p),
            (path.cell + 1, path.holes[1], path.q),
        ):
            hole = made.part(f"block-{block}-top").hole(name)
            assert hole.centre == pytest.approx(anchor, abs=1e-12)
            pins = [f for f in made.fasteners if f.block == block and f.name == name]
            hooks = [f for f in pins if f.use in ("hook", "pin")]
            assert any(f.high > path.high and f.low <= made.stack.top for f in hooks)


@made
def test_faces_touch_at_the_stops_of_cells_without_a_slot(made):
    for one in made.cells:
        gap = one.cell.lever * math.cos(one.cell.limit) - 2.0 * one.front
        assert gap == pytest.approx(ACRYLIC.stop.gap if one.slotted else 0.0, abs=1e-12) or (
            one.slotted and gap > ACRYLIC.stop.gap
        )
        assert one.slotted == (not 35.0 <= math.degrees(one.cell.limit) <= 55.0)


@made
def test_the_pin_of_the_last_block_stays_in_the_transverse_slot_of_the_bar(made):
    pin = next(f for f in made.fasteners if f.name == "drive")
    reach = slot_reach(made.cells) / 2.0
    reached = []
    for angles in random_angles(made, count=200):
        at = made.positions(angles)[-1] + pin.centre
        x, y, _ = made.frames(angles)["drive-bar"]
        assert at[0] == pytest.approx(x, abs=1e-12)
        reached.append(at[1] - y)
    assert max(map(abs, reached)) <= reach
    # The paper's pair swings by r (1 - cos θc) = 4.14 mm per cell.
    if made is MADE["pair"]:
        assert reach == pytest.approx(4.142e-3, abs=1e-6)


def test_the_reference_pair_has_the_sizes_of_the_swept_study():
    made = MADE["pair"]
    assert made.blocks[1].seats[1][2] == pytest.approx(0.061)  # from one joint pair to the other
    assert [round(1e3 * z, 6) for z in (made.stack.bottom, made.stack.middle, made.stack.top)] == [
        0.0,
        3.3,
        6.6,
    ]
    assert made.stack.bands == pytest.approx(12.6e-3)
    assert {part.layer for part in made.parts} == {0, 1, 2}
    assert len(made.parts) == 14


@given(dx=st.floats(-5.0, 5.0), dy=st.floats(-5.0, 5.0), px=st.floats(-15.0, 5.0))
def test_anchors_that_pins_or_edges_forbid_are_shifted_together(dx, dy, px):
    chain = sw.Chain([chains.cell((px, 0.0), (px + 15.0 + dx, dy))])
    made = layout(chain, ACRYLIC)
    (path,) = made.bands
    band = chain.levers[0].bands[0]
    across, along = path.shift
    assert path.p == pytest.approx((band.p[1] + along, band.p[0] + across), abs=1e-12)
    pins = [f for f in made.fasteners if f.use == "pin" and f.joint]
    for block, at in ((0, path.p), (1, path.q)):
        for pin in pins:
            gap = math.dist(pin.centre, at)
            if pin.block == block:
                assert gap < 1e-9 or gap >= 3e-3 + ACRYLIC.sheet.bridge - 1e-8


def test_grid_holes_have_names_and_keep_the_least_web():
    top = MADE["pair"].part("block-1-top")
    assert top.hole("qD3").use == "hook"
    assert top.hole("qA1").use == top.hole("pG5").use == "grid"
    for one in top.holes:
        for other in top.holes:
            if one is not other:
                web = math.dist(one.centre, other.centre) - (one.diameter + other.diameter) / 2
                assert web >= ACRYLIC.sheet.bridge - 1e-9


def test_elements_and_long_chains_are_refused():
    with refuses(ValueError, "cells[0]", "Cell"):
        layout(sw.load("preset:balloon"), ACRYLIC)
    with refuses(ValueError, "9 cells", "8"):
        layout(sw.Chain([chains.cell((-10, 0), (i + 1, 0)) for i in range(9)]), ACRYLIC)


def test_a_limit_that_leaves_no_plate_between_joints_is_refused():
    chain = sw.Chain([chains.cell((-10, 0), (10, 0), 10.0, 89.0)])
    with refuses(ValueError, "cell 1", "10 mm", "89", "stop.gap_mm"):
        layout(chain, ACRYLIC)
