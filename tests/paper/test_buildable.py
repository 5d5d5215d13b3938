"""Robots as they can be cut: their numbers, and the ranges in which their gaits stay."""

from dataclasses import replace

import pytest

from docs.as_cut import PAGE, WALKS, record, written
from facts import refuses
from sizes import SIZE
from stepwell import files
from stepwell.paper import AssumedRanges, assumed_ranges, ranges, sensitivity
from stepwell.paper.buildable import DRY, VARIANTS, buildable
from stepwell.paper.walking import robot
from stepwell.simulation import walk

pytest.importorskip("shapely", reason="builds are not tested: shapely is not installed")


def numbers_of(one) -> dict[str, str]:
    return {number.path: number.source for number in files.provenance(one)}


def test_masses_of_a_cut_robot_come_from_its_parts_and_its_period_from_the_actuator():
    cut = buildable("forward", "dry")
    assert cut.made is not None
    assert cut.mass == pytest.approx(cut.made.mass)
    assert cut.blocks.rail_friction == DRY
    assert cut.drive.period == pytest.approx(cut.drive.least_period)
    assert cut.drive.period > robot("forward").drive.period
    source = numbers_of(cut)
    for key in ("body.mass_g", "blocks.mass_g", "blocks.outer_g", "blocks.carriage_g"):
        assert source[key] == "from the parts", key
    assert source["blocks.rail_friction_N"] == "assumed"
    assert source["floor.drag_N"] == "authors' notes"


def test_the_idealised_variant_is_the_shipped_robot_and_others_are_refused():
    assert buildable("left", "idealised") == robot("left")
    with refuses(ValueError, "variant = 'oiled'", *(f"'{name}'" for name in VARIANTS)):
        buildable("left", "oiled")


def test_a_change_of_a_number_leaves_the_parts_out_and_keeps_what_they_weigh():
    cut = buildable("forward")
    other = files.vary(cut, {"floor.foot_friction": 0.4})
    assert other.made is None
    assert (other.mass, other.drive) == (pytest.approx(cut.mass), cut.drive)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "variant"),
    [("forward", "dry-stiff"), ("15", "dry")]
    if SIZE == "ci"
    else [(name, variant) for name in WALKS for variant in VARIANTS],
)
def test_the_page_has_what_the_robots_do(name, variant):
    noted, one = record()["walks"][variant][name], walk(buildable(name, variant), 3)
    assert {gaits[-1] for gaits in one.gaits.values()} == set(noted["gaits"])
    assert one.advance[1:].mean() == pytest.approx(noted["advance"], abs=0.05)


def test_the_page_shows_the_record():
    page = PAGE.read_text("utf-8")
    assert written(page) == page


def test_dry_rails_stop_the_forward_robot_and_stiffer_bands_start_it_again():
    walks = record()["walks"]
    forward = {variant: walks[variant]["forward"]["advance"] for variant in VARIANTS}
    assert max(forward["dry"], forward["rollers"]) < 0.1
    assert min(forward["rollers-firm"], forward["dry-stiff"]) > 0.7
    # None is within the paper's tolerances everywhere, so the default stays the idealised robot.
    assert not any(
        all(low <= walks[variant][name]["advance"] <= high for name, (_, low, high) in _straight())
        for variant in set(VARIANTS) - {"idealised"}
    )


def _straight():
    return [(name, target) for name, target in WALKS.items() if not target[0].startswith("turn")]


@pytest.fixture
def few(monkeypatch):
    """Two numbers, of which one has an end on both sides and the other none above."""
    some = ("feet below", "rail")
    chosen = [one for one in sensitivity.VARIATIONS if any(word in one.label for word in some)]
    monkeypatch.setattr(ranges, "VARIATIONS", chosen)
    monkeypatch.setattr(ranges, "HALVINGS", 2)


@pytest.mark.slow
def test_a_range_ends_where_the_gait_changes(few):
    found: AssumedRanges = assumed_ranges(robot("forward"))
    rail, feet = sorted(found.ranges, key=lambda one: one.value)
    assert (rail.value, rail.low, rail.below) == (0.0, 0.0, "")
    assert 0.01 < rail.high < 0.06
    assert rail.above == "00>01>11>01>00"
    assert feet.low < feet.value == 0.9 <= feet.high < 1.2
    # Just outside, the robot has the other gait.
    outside = replace(robot("forward").blocks, rail_friction=1.5 * rail.high + 0.02)
    other = walk(replace(robot("forward"), blocks=outside), 2)
    assert other.gaits["left"][-1] == rail.above


def test_numbers_with_a_source_are_not_changed():
    labels = {variation.label for variation, _ in ranges.assumed(buildable("forward"))}
    assert "mass of a block [g]" not in labels
    assert "mass of a block [g]" in {v.label for v, _ in ranges.assumed(robot("forward"))}
    assert "friction of a slider's rail [N]" in labels


def test_the_rail_friction_at_which_the_cut_robot_stops_is_predicted_as_near_a_boundary():
    near = {}
    for one in (robot("forward"), buildable("forward")):
        rubbing = replace(one, blocks=replace(one.blocks, rail_friction=0.005))
        near[one.made is not None] = {leg.near_boundary for leg in rubbing.predict().legs}
    assert near == {False: {False}, True: {True}}
