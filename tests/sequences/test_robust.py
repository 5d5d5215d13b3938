"""Programs that shall work for all mobilities within a ratio do, or say what is in the way."""

import math
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from chains import any_chain, concave_chain
from facts import says
from sizes import examples
from stepwell.sequences import ProgramMethod, Unreachable
from stepwell.sequences.branches import Branches

RATIO = 10.0


def taut(dx: float, dy: float, stiffness: float, rest: float) -> sw.Cell:
    """A concave cell of the paper's lever [mm, N/m]."""
    return sw.Cell(sw.Band((0.0, 0.0), (dx / 1e3, dy / 1e3), stiffness, rest / 1e3))


# Concave, behind a spring: on the way back from the top a snap hangs on the mobilities.
BEHIND = sw.Chain(
    [
        taut(27.40, -4.67, 17.02, 6.57),
        taut(10.66, 6.56, 30.54, 5.66),
        taut(31.40, 8.44, 52.97, 6.44),
        taut(30.54, -14.45, 55.01, 5.12),
    ],
    actuator_stiffness=100.0,
)
# Three elements under a prescribed stroke: from 010 on the way up one of two others may go on.
RACE = sw.Chain(
    [
        sw.elements.trilinear((0.003, 1.3), (0.010, 0.8), 100.0, 800.0, "first"),
        sw.elements.trilinear((0.005, 0.3), (0.008, 0.0), 200.0, 300.0, "second"),
        sw.elements.trilinear((0.004, 1.1), (0.015, -0.3), 400.0, 100.0, "third"),
    ]
)


def with_mobilities(chain: sw.Chain, factors) -> sw.Chain:
    pairs = zip(chain.cells, np.asarray(factors).tolist(), strict=True)
    return replace(chain, cells=tuple(replace(c, mobility=c.mobility * own) for c, own in pairs))


def arrivals(program: sw.Program, tries: int, seed: int = 0) -> set[str]:
    """Where a program ends with other mobilities, some of them at the ends of the ratio."""
    rng, ends = np.random.default_rng(seed), set[str]()
    for k in range(tries):
        share = rng.random(len(program.chain))
        chain = with_mobilities(program.chain, RATIO ** (np.round(share) if k % 2 else share))
        ends.add(replace(program, chain=chain, robust=None).arrives)
    return ends


@pytest.mark.slow
def test_a_robust_program_turns_back_early_where_a_snap_on_the_way_hangs_on_the_mobilities():
    plain = BEHIND.program("0001")
    landing = replace(plain, robust=RATIO).mobility_dependent_landing
    assert landing is not None and landing.elsewhere
    program = BEHIND.program("0001", robust=RATIO)
    assert (
        program.robust == RATIO and program.mobility_dependent_landing is None and program.landings
    )
    assert program.turns[0].drive < plain.turns[0].low
    assert arrivals(program, 10) == {"0001"}
    says(program.reason, "mobility ratios", "10")


def test_where_a_landing_stands_in_the_way_of_every_program_it_is_named():
    plain = RACE.program("111")
    landing = replace(plain, robust=RATIO).mobility_dependent_landing
    assert landing is not None
    with pytest.raises(Unreachable) as refused:
        RACE.program("111", robust=RATIO)
    text = str(refused.value)
    assert refused.value.proved
    says(text, "snap", f"{landing.event.drive * 1e3:.4g} mm", "loading")
    assert "first, second, third" in text and f"lands in {landing.elsewhere[0].state}" in text
    says(text, "mobility ratios", "10")
    # Nearer to each other, they land where they should.
    assert RACE.program("111", robust=1.5).turning_points == plain.turning_points


def test_a_program_whose_landings_hold_is_the_same_when_robust():
    leg = sw.preset("paper-forward")
    for to in ("01", "10", "11"):
        plain, robust = leg.program(to), leg.program(to, robust=RATIO)
        assert robust.turning_points == plain.turning_points
        assert (plain.robust, plain.landings) == (None, ())


def test_a_state_out_of_reach_is_refused_as_ever():
    leg = sw.preset("used-before")
    with pytest.raises(Unreachable) as plain:
        leg.program("01")
    with pytest.raises(Unreachable) as robust:
        leg.program("01", robust=RATIO)
    assert str(robust.value) == str(plain.value)


@pytest.mark.slow
def test_concave_cells_are_turned_past_vertices_where_a_landing_hangs():
    # Theory page, "Stroke programs", (a): vertices do not hang on mobilities, landings do.
    rng = np.random.default_rng(1)
    turned = 0
    for _ in range(examples(6)):
        chain = concave_chain(rng, 4)
        for state in sorted(set(chain.graph(start="0000").vertices)):
            try:
                program = chain.program(state, robust=RATIO)
            except Unreachable:
                continue
            turned += program.method is ProgramMethod.VERTICES
            assert arrivals(program, 4) == {state}
    assert turned


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [math.inf, 100.0])
@pytest.mark.parametrize("friction", [False, True])
def test_robust_programs_arrive_with_any_mobilities_within_the_ratio(stiffness, friction):
    rng = np.random.default_rng(3)
    count = 0
    for _ in range(examples(4)):
        chain = replace(any_chain(rng, 3, friction=friction), actuator_stiffness=stiffness)
        try:
            program = chain.program("010", robust=RATIO)
        except (Unreachable, ValueError):
            continue
        count += 1
        assert all(landing.holds for landing in program.landings)
        assert arrivals(program, 8) == {"010"}
    assert count


def test_branches_know_of_each_exit_what_the_path_through_it_says():
    branches = Branches(RACE)
    place = branches.vertex("000")
    assert place is not None
    known = {}
    for number in sorted(branches.all_from([branches.at(*place)])):
        for direction in (+1, -1):
            if branches.exit(number, direction) is not None:
                landing = branches.landing(number, direction, RATIO)
                known[round(landing.event.drive, 9), direction] = landing.holds
                assert branches.landing(number, direction, RATIO) is landing
    for landing in RACE.cycle().path.landings(RATIO):
        event = landing.event
        assert known[round(event.drive, 9), event.direction] == landing.holds


@pytest.mark.parametrize("ratio", [0.5, 0.0, -1.0, math.nan, math.inf, 1e7])
def test_a_ratio_that_is_none_is_refused(ratio):
    with pytest.raises(ValueError, match="robust"):
        RACE.program("111", robust=ratio)
    with pytest.raises(ValueError, match="robust"):
        RACE.yields(samples=1, robust=ratio)
