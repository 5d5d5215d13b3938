"""What is called impossible and proved has no witness: every choice of holes is run anew."""

import math
import re
from collections.abc import Sequence
from itertools import combinations, permutations, product

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from sizes import examples
from stepwell.design.synthesis import placement as outline
from stepwell.design.synthesis.candidates import Kind, Rule
from stepwell.design.synthesis.designed import Design, Impossible
from stepwell.design.synthesis.inverse import design
from stepwell.design.synthesis.region import (
    PAPER_BAND,
    PAPER_BOX,
    PAPER_LEVER,
    AnchorBox,
    AnchorPolygon,
    BandType,
    HoleGrid,
    drilled,
    usual_box,
)
from stepwell.design.tolerances.draws import Tolerances
from stepwell.statics import StaticsError

ISSUE = "000>001>011>111>011>010>000"
LONG = BandType(28.5, 0.020)
TWO, NESTED = "00>10>11>01>00", "000>010>110>111>101>001>000"


def cell(band: BandType, q: tuple[float, float]) -> sw.Cell | None:
    """A cell with the band at q; None if it cannot be built, or its band is slack somewhere."""
    taut = Kind(band, PAPER_LEVER, math.pi / 4).taut(np.array([[q[0] + 0.010, q[1]]]))
    try:
        made = sw.Cell(sw.Band((-0.010, 0.0), q, band.stiffness, band.rest_length))
    except ValueError:
        return None
    return made if taut.all() else None


def sequence(cells: Sequence[sw.Cell]) -> str:
    """What a choice does; "" where the engine has no answer, or a tie."""
    try:
        cycle = sw.Chain(cells).cycle()
    except StaticsError:
        return ""
    return "" if cycle.degenerate else str(cycle.sequence)


def answer(*wanted: str, **how) -> Design | Impossible:
    """The design, or why there is none."""
    try:
        return design(*wanted, samples=1, **how)
    except Impossible as reason:
        return reason


def cycle(loading, unloading) -> str:
    state, states = ["0"] * len(loading), ["0" * len(loading)]
    for order, to in ((loading, "1"), (unloading, "0")):
        for i in order:
            state[i] = to
            states.append("".join(state))
    return ">".join(states)


def random_case(rng: np.random.Generator, cells: int):
    """A box of a few holes, anywhere, and a band that may fold back or go slack there."""
    pitch = float(rng.choice([0.004, 0.005, 0.007]))
    wide, tall = [(1, 1), (2, 1), (1, 2)][rng.integers(3)]
    lowest = rng.uniform(-0.020, 0.006), rng.uniform(-0.014, 0.008)
    left, bottom = (pitch * round(side / pitch) for side in lowest)
    box = AnchorBox(left, left + wide * pitch, bottom, bottom + tall * pitch)
    band = BandType(rng.uniform(15, 60), float(rng.choice([0.004, 0.008, 0.012])))
    orders = [rng.permutation(cells).tolist() for _ in range(2)]
    return box, pitch, band, cycle(*orders)


@pytest.mark.slow
def test_holes_where_the_band_is_not_proved_concave_are_tried_too():
    box = AnchorBox(0.0, 0.010, -0.010, 0.010)
    made = design(
        ISSUE,
        within=box,
        holes=0.005,
        bands=(LONG,),
        tolerances=Tolerances(anchor=0.001),
        samples=100,
    )
    assert str(made.chain.cycle().sequence) == ISSUE == made.sequence
    known = [(0.010, 0.010), (0.010, -0.005), (0.005, -0.010)]
    other = sw.Chain([c for q in known if (c := cell(LONG, q)) is not None])
    same = other.yields(Tolerances(anchor=0.001), samples=100, target=ISSUE)
    assert 0.6 < same.fraction <= made.yield_.fraction + 0.1
    assert not made.proved
    says(made.method, "remaining candidates")
    assert made.plot()
    says(made.assumptions, "not all cells", "concave", "simulated")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cells", "cases"), [(2, examples(10, full=400)), (3, examples(5, full=200))]
)
def test_nothing_that_is_called_impossible_and_proved_has_a_witness(cells, cases):
    rng = np.random.default_rng(cells)
    proved = designed = tried = 0
    for _ in range(cases):
        box, pitch, band, wanted = random_case(rng, cells)
        ways = [c for q in drilled(box, HoleGrid(pitch)).tolist() if (c := cell(band, tuple(q)))]
        # All choices, labels included: nothing here knows of symmetry or of end forces. Equal cells
        # are degenerate, so they do not load one after the other.
        numbers = permutations(range(len(ways)), cells)
        doing = [c for c in numbers if sequence(tuple(ways[k] for k in c)) == wanted]
        made = answer(wanted, within=box, holes=pitch, bands=(band,))
        if isinstance(made, Impossible):
            proved += made.proved
            tried += "candidates were simulated" in str(made)
            assert not (made.proved and doing), (box, pitch, band, wanted, doing)
        else:
            designed += 1
            assert doing
            assert sequence(made.chain.levers) == wanted
    assert proved > 0 and designed > 0 and tried > 0


@pytest.mark.slow
def test_sets_of_states_called_impossible_and_proved_have_no_witness():
    rng = np.random.default_rng(4)
    proved = 0
    for cells, cases in ((2, examples(4, full=120)), (3, examples(2, full=60))):
        every = ["".join(bits) for bits in product("01", repeat=cells)]
        for _ in range(cases):
            box, pitch, band, _ = random_case(rng, cells)
            ways = [
                c for q in drilled(box, HoleGrid(pitch)).tolist() if (c := cell(band, tuple(q)))
            ]
            columns, wanted = [], set()
            while len(set(columns)) < cells:  # so that equal cells are out of the question
                wanted = {every[0], *(s for s in every[1:-1] if rng.random() < 0.6), every[-1]}
                columns = list(zip(*sorted(wanted), strict=True))
            made = answer(states=wanted, within=box, holes=pitch, bands=(band,))
            if not isinstance(made, Impossible):
                assert {s for s in made.chain.graph(start="0" * cells) if "-" not in s} == wanted
                continue
            proved += made.proved
            # By symmetry equal cells are in different states only after a tie.
            choices = permutations(ways, cells)
            for choice in choices if made.proved else ():
                try:
                    graph = sw.Chain(choice).graph(start="0" * cells)
                except (StaticsError, ValueError):
                    continue
                reach = {label.partition("#")[0] for label in graph if "-" not in label}
                assert graph.ties or reach != wanted, (box, pitch, band, wanted, choice)
    assert proved > 0


def test_a_band_that_is_slack_is_no_design():
    # This band is taut at one hole, so a second cell would be slack.
    with refuses(Impossible, "taut bands", "slack", "34 of 35 holes", "33 mm"):
        design(TWO, holes=0.005, bands=(BandType(22.15, 0.04037),))


def test_what_is_left_out_is_not_called_proved(monkeypatch):
    from stepwell.design.synthesis import tries as remaining

    box = AnchorBox(0.0, 0.010, -0.010, 0.010)
    monkeypatch.setattr(remaining, "_THROUGH_A_CYCLE", 6)
    with refuses(Impossible, "2 of 371 remaining candidates") as refusal:
        design(ISSUE, within=box, holes=0.005, bands=(LONG,), samples=1)
    assert not refusal.value.proved
    says(str(refusal.value), f"{ISSUE}: not found", "anchors q", "5 mm apart")
    says(str(refusal.value), "x 0 to 10 mm", "y -10 to 10 mm")


def test_states_without_orders_are_impossible_only_where_no_cell_could_do_it():
    # No chain of concave cells goes from 000 to 111 by these, and all bands here are such.
    with pytest.raises(Impossible) as refusal:
        design(states=["000", "110", "111"])
    assert refusal.value.proved
    # Where bands may fold back other cells might.
    folded = AnchorBox(-0.02, 0.02, -0.015, 0.015)
    with pytest.raises(Impossible) as refusal:
        design(states=["000", "110", "111"], within=folded)
    assert not refusal.value.proved and "not tried" in str(refusal.value)
    # A cell that overtakes might reach what no orders tell.
    with pytest.raises(Impossible) as refusal:
        design(states=["000", "100", "001", "110", "111"])
    assert not refusal.value.proved
    # Of any cells: a cycle passes all at 1.
    with pytest.raises(Impossible) as refusal:
        design(states=["00", "10"], within=folded)
    assert refusal.value.proved


def test_cells_that_are_not_concave_do_move_together():
    # So that the state with one of them at 1 is never there: two that only pull back.
    slow = sw.Cell(sw.Band((0.0, 0.0), (-0.009, 0.012), 30.0, 0.0))
    force = slow.force(np.linspace(-slow.limit, slow.limit, 50))
    assert np.all(np.diff(force) > 0)
    pair = sw.Chain((slow, slow))
    assert str(pair.cycle().sequence) == "00>11>00"
    assert {s for s in pair.graph(start="00") if "-" not in s} == {"00", "11"}


@pytest.mark.parametrize("region", [PAPER_BOX, AnchorPolygon(((0, 0), (0.02, 0), (0, 0.01)))])
def test_a_region_is_proved_as_a_whole_only_where_every_place_is(region):
    def rule(band: BandType) -> Rule:
        kind = Kind(band, PAPER_LEVER, math.pi / 4)
        return Rule((-0.010, 0.0), (kind,), Tolerances(), math.inf, False, region.bounds)

    assert outline.all_proved(rule(PAPER_BAND), region)
    assert not outline.all_proved(rule(BandType(28.5, 0.030)), region)


def test_all_orders_of_two_cells_on_few_holes_are_found_or_refused_rightly():
    box, pitch = AnchorBox(-0.004, 0.004, 0.0, 0.008), 0.004
    ways = [c for q in drilled(box, HoleGrid(pitch)).tolist() if (c := cell(LONG, tuple(q)))]
    does = {sequence((a, b)) for a, b in combinations(ways, 2)}
    does |= {sequence((b, a)) for a, b in combinations(ways, 2)}
    for loading, unloading in product(permutations(range(2)), repeat=2):
        wanted = cycle(loading, unloading)
        made = answer(wanted, within=box, holes=pitch, bands=(LONG,))
        if isinstance(made, Impossible):
            assert wanted not in does or not made.proved
        else:
            assert sequence(made.chain.levers) == wanted


def test_a_lever_gets_a_box_of_its_own_size_unless_one_is_named():
    wide = design("00>01>11>10>00", lever=0.030, samples=10)
    ratio = 0.030 / PAPER_LEVER
    box = AnchorBox(*(ratio * side for side in (0.0, 0.020, -0.015, 0.015)))
    assert np.all(box.holds(wide.anchors)) and not np.all(PAPER_BOX.holds(wide.anchors))
    assert usual_box(PAPER_LEVER) == PAPER_BOX
    named = design("00>01>11>10>00", lever=0.030, within=PAPER_BOX, samples=10)
    assert np.all(PAPER_BOX.holds(named.anchors))
    with refuses(Impossible, "80 mm apart", "x 0 to 42.43 mm"):
        design("00>01>11>10>00", lever=0.030, holes=0.080)


_SLACK = re.compile(
    r"slack in a part of the travel at (\d+) of (\d+) holes.*"
    r": a lever of (\S+) mm or a rest length of (\S+) mm leaves a choice"
)


@pytest.mark.parametrize(
    ("wanted", "within", "free", "rest"),
    [
        (TWO, None, "q", 0.045),
        (TWO, None, "p", 0.050),
        (NESTED, AnchorBox(0.010, 0.020, -0.005, 0.005), "q", 0.0404),
    ],
)
def test_where_a_band_is_too_long_the_sizes_that_the_message_names_give_a_design(
    wanted, within, free, rest
):
    how = {"within": within, "free": free, "holes": 0.005}
    why = answer(wanted, bands=(BandType(22.15, rest),), **how)
    assert isinstance(why, Impossible)
    advice = _SLACK.search(str(why))
    assert advice, str(why)
    slack, holes = int(advice[1]), int(advice[2])
    region = within or usual_box(PAPER_LEVER, free)
    assert holes == len(drilled(region, HoleGrid(0.005)))
    assert slack == sum(
        _goes_slack(q, free, rest) for q in drilled(region, HoleGrid(0.005)).tolist()
    )
    lever, shorter = float(advice[3]) * 1e-3, float(advice[4]) * 1e-3
    assert lever > PAPER_LEVER and shorter < rest
    longer = answer(wanted, bands=(BandType(22.15, rest),), lever=lever, **how)
    other = answer(wanted, bands=(BandType(22.15, shorter),), **how)
    for made in (longer, other):
        assert isinstance(made, Design), str(made)
        assert made.sequence == wanted


def _goes_slack(place: list[float], free: str, rest: float) -> bool:
    p, q = (place, (0.010, 0.0)) if free == "p" else ((-0.010, 0.0), place)
    angle = np.linspace(-math.pi / 4, math.pi / 4, 1001)
    x = q[0] - p[0] + PAPER_LEVER * np.cos(angle)
    y = q[1] - p[1] + PAPER_LEVER * np.sin(angle)
    return bool(np.min(np.hypot(x, y)) <= rest)


def test_where_no_band_goes_slack_the_message_names_no_lengths():
    why = answer("00>01>11>10>00", holes=0.040)
    assert isinstance(why, Impossible)
    assert "slack" not in str(why) and "rest length of" not in str(why)


def test_several_bands_get_no_lengths_but_the_general_advice():
    bands = BandType(22.15, 0.045), BandType(22.15, 0.050)
    box = AnchorBox(0.0, 0.005, 0.0, 0.005)
    why = answer("00>10>11>01>00", holes=0.005, bands=bands, within=box)
    assert isinstance(why, Impossible)
    assert "slack" not in str(why) and "longer levers" in str(why)
