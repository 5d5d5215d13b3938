"""Chains with two actuators: walks that one actuator cannot follow, against plain paths."""

import random
from dataclasses import replace
from itertools import pairwise, product
from typing import Any

import pytest

import stepwell as sw
from facts import refuses, says
from stepwell.design import BandType, Tolerances, design_tapped


def one_way_on(chain, state, direction):
    """The next state of a chain with every cell at a stop, by small steps of one actuator."""
    full = chain.full_travels
    stroke = sum(s for s, digit in zip(full, state, strict=True) if digit == "1")
    place = chain.path([stroke, stroke], start=state).end_configuration
    for _ in range(round(chain.full_stroke / 5e-4)):
        now, stroke = stroke, min(max(stroke + direction * 5e-4, 0.0), chain.full_stroke)
        if now == stroke:
            break
        place = chain.path([now, stroke], start=place).end_configuration
        at = [travel / one for travel, one in zip(place.travel, full, strict=True)]
        if all(min(abs(x), abs(x - 1)) < 1e-6 for x in at):
            return "".join(str(round(x)) for x in at)
    return None


def follows(chain, walk):
    """Whether single steps of one actuator lead a chain from each state of a walk to the next."""
    ways = ((one, other, 1 if other > one else -1) for one, other in pairwise(walk))
    return all(one_way_on(chain, one, way) == other for one, other, way in ways)


def test_two_actuators_follow_a_walk_that_is_proved_impossible_for_one():
    made = design_tapped("000>100>000>001>011>001>000", samples=50)
    assert made.simulate() == made.walk and made.fraction > 0.99
    says(made.single, "000 leads", "100", "001")
    assert made.proved and made.tap == 1
    # By small steps, each side follows its own part of the walk.
    for side, chain in ((slice(0, 1), made.inner.chain), (slice(1, 3), made.outer.chain)):
        states = [state[side] for state in made.walk]
        moving = [one for k, one in enumerate(states) if k == 0 or states[k - 1] != one]
        assert follows(chain, moving)
    # One actuator follows it on no chain: not on this one, nor on any that is drawn at random.
    rng = random.Random(0)
    places = [
        [(rng.uniform(0, 0.02), rng.uniform(-0.015, 0.015)) for _ in range(3)] for _ in "abcdef"
    ]
    bands = [[sw.Band((-0.01, 0.0), q, 28.5, 0.01) for q in one] for one in places]
    drawn = [sw.Chain([sw.Cell(band) for band in one]) for one in bands]
    assert not any(follows(chain, made.walk) for chain in (made.chain, *drawn))


def test_positions_are_those_of_the_tap_and_of_the_end():
    made = design_tapped("000>100>000>001>011>001>000", samples=20)
    tap, end = (made.positions * 1e3).round(6).T.tolist()
    assert tap == [0, 20, 0, 0, 0, 0, 0] and end == [0, 20, 0, 20, 40, 20, 0]
    assert (made.strokes >= 0).all()


def test_a_walk_that_one_actuator_can_follow_is_named_so():
    made = design_tapped("00>10>11>10>00", samples=20)
    assert made.single == "" and not made.proved
    alone = sw.design(requirements="00 to 10; 10 to 11; 11 to 10; 10 to 00", samples=20)
    assert follows(alone.chain, made.walk)


def test_a_walk_that_no_tap_allows_is_impossible_with_the_steps_on_each_side():
    walk = "000>100>000>010>000>001>000"
    with refuses(sw.Impossible, "after cell 1", "'00 to 10'", "after cell 2", "'00 to 01'") as why:
        design_tapped(walk, samples=20)
    assert why.value.proved


PAPER, WIDE = BandType(28.5, 0.010), BandType(47.0, 0.022)
WALK = "000>100>000>001>011>001>000"


def shared(packs, most=1):
    """The largest yield of both sides, tap after cell 1, if packs are divided by hand."""
    found = []
    for first in product(*[range(pack + 1) for pack in packs]):
        sides = first, tuple(pack - one for pack, one in zip(packs, first, strict=True))
        steps = "0 to 1; 1 to 0", "00 to 01; 01 to 11; 11 to 01; 01 to 00"
        fraction = 1.0
        for counts, wanted in zip(sides, steps, strict=True):
            kinds = zip((PAPER, WIDE), counts, strict=True)
            bands = [replace(band, pack=count) for band, count in kinds if count]
            try:
                made = sw.design(requirements=wanted, bands=bands, most_bands=most, **ROUGH)
            except (sw.Impossible, sw.InputError):
                break
            fraction *= made.yield_.fraction
        else:
            found.append(fraction)
    return max(found, default=None)


ROUGH: dict[str, Any] = {
    "holes": 0.010,
    "samples": 60,
    "tolerances": Tolerances(anchor=0.004, stiffness=0.15),
}


@pytest.mark.parametrize(
    ("packs", "most"), [((3, 1), 1), ((1, 2), 1), ((2, 1), 1), ((2, 3), 2), ((4, 1), 2)]
)
def test_both_sides_share_the_packs_as_divided_by_hand(packs, most):
    bands = [replace(PAPER, pack=packs[0]), replace(WIDE, pack=packs[1])]
    made = design_tapped(WALK, bands=bands, most_bands=most, **ROUGH)
    assert made.tap == 1 and made.simulate() == made.walk
    taken = (*made.inner.bands, *made.outer.bands)
    for band, pack in zip((PAPER, WIDE), packs, strict=True):
        assert sum(n for one, n in taken if one.stiffness == band.stiffness) <= pack
    assert made.fraction == pytest.approx(shared(packs, most))


def test_packs_that_hold_too_few_bands_for_both_sides_are_impossible():
    with refuses(sw.Impossible, "2 cells", "hold 1") as why:
        design_tapped(WALK, bands=[replace(PAPER, pack=2)], samples=20)
    assert why.value.proved


def test_packs_of_one_band_add_up():
    one = replace(PAPER, pack=1)
    made = design_tapped(WALK, bands=[one, one, one], samples=20)
    assert len(made.inner.bands) + len(made.outer.bands) == 3


def test_each_side_has_the_levers_and_tolerances_of_its_cells():
    levers, anchors = (0.012, 0.014, 0.016), (0.0001, 0.0002, 0.0)
    how: dict[str, Any] = {
        "lever": [levers],
        "tolerances": Tolerances(anchor=anchors),
        "samples": 20,
    }
    made = design_tapped(WALK, **how)
    assert tuple(cell.lever for cell in made.chain.levers) == levers
    sides = made.inner.yield_, made.outer.yield_
    assert (made.tap, *(one.tolerances.anchor for one in sides)) == (1, anchors[:1], anchors[1:])
    wrongs: list[dict[str, Any]] = [
        {"lever": [levers[:2]]},
        {"tolerances": Tolerances(anchor=anchors[:2])},
    ]
    for wrong in wrongs:
        with refuses(sw.InputError, "for 3 cells"):
            design_tapped(WALK, **(how | wrong))


@pytest.mark.parametrize(
    ("walk", "part"),
    [
        ("00>11", "moves 2 cells"),
        ("00>00>10", "moves 0 cells"),
        ("10>00", "all cells at"),
        ("0>1", "two cells or"),
        ("00", "two states or"),
        ("00>1a", "digits 0"),
        ("00>010", "of one length"),
    ],
)
def test_a_walk_that_cannot_be_read_is_refused(walk, part):
    with refuses(sw.InputError, part):
        design_tapped(walk)
