"""Paths proved in ball arithmetic, against the engine and against wrong answers."""

import json
import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import chains
import stepwell as sw
from accounts.schemas import violations
from races import NoRest, Race
from sizes import cases
from statics.test_against_oracle import as_oracle
from statics.test_races import races, rubbing
from stepwell.accounts import account
from stepwell.design import Run
from stepwell.proof import PathProof, ProvedEvent, ProvedRun, Theorem, prove
from stepwell.proof.balls import ball, hull, number
from stepwell.proof.motion import FlowMotion, parting_rate
from stepwell.proof.tube import Tube, _marks
from stepwell.proof.walk import EnclosedWalk
from stepwell.statics import Configuration, problem_of

# Presets with a cycle that is proved from beginning to end.
PROVED = (
    *("paper-forward", "paper-backward", "paper-counterclockwise", "paper-via-01"),
    *("paper-via-10", "paper-outer-15", "paper-cell-10-0", "compliant-actuator"),
    *("force-control", "friction", "rubber", "slack"),
    *("three-wave", "four-shuffle", "countdown", "metachronal-wave"),
)


def proof_of(name: str) -> PathProof:
    return sw.preset(name).cycle().path.prove()


@pytest.mark.parametrize("name", PROVED)
def test_every_event_of_a_preset_is_enclosed_and_every_stretch_covered(name):
    proof = proof_of(name)
    assert proof.proved and proof.outcome == "proved"
    assert len(proof.events) == len(proof.path.events)
    # A millionth of a nanometre, far below any part.
    assert proof.worst_error < 1e-13


def test_a_snap_of_the_papers_pair_lands_along_a_line():
    snaps = [event for event in proof_of("paper-forward").events if event.theorem]
    assert [event.theorem for event in snaps] == [Theorem.LINE] * 2
    assert all((event.released_error or 1.0) < 1e-14 for event in snaps)


def test_equal_cells_are_not_decided():
    proof = proof_of("paper-identical")
    assert not proof.proved and "order of cells 1 and 2" in proof.outcome
    assert not any(gap.contradicted for gap in proof.gaps)


@pytest.mark.parametrize("gap", [0.0, 1e-14, 1e-11])
def test_designs_next_to_a_tie_are_not_decided(gap):
    cell = sw.preset("paper-forward").cells[0]
    band = replace(cell.band, stiffness=cell.band.stiffness * (1.0 + gap))
    proof = sw.Chain([cell, replace(cell, band=band)]).cycle().path.prove()
    assert not proof.proved
    assert {one.cause for one in proof.gaps} == {"the order of cells 1 and 2"}


def rubbing_pair(gap: float) -> sw.Chain:
    """Two cells whose forces with friction differ by a fraction when they leave their stops."""
    less, more = sorted(sw.preset("paper-forward").cells, key=lambda cell: cell.force_0)
    friction = 0.01 + more.force_0 - less.force_0 + gap * more.force_0
    return sw.Chain([replace(more, friction=0.01), replace(less, friction=friction)])


@pytest.mark.parametrize("gap", [0.0, 1e-14, -1e-11, 5e-10])
def test_designs_with_friction_next_to_a_tie_are_not_decided(gap):
    proof = rubbing_pair(gap).cycle().path.prove()
    assert not proof.proved and not any(one.contradicted for one in proof.gaps)
    assert {one.cause for one in proof.gaps} == {"the order of cells 1 and 2"}


def test_a_design_with_friction_at_a_distance_from_a_tie_is_decided():
    assert all(rubbing_pair(gap).cycle().path.prove().proved for gap in (-1e-7, 1e-7))


# The first cell is held by friction between its stops while the other two snap.
HELD_MIDWAY = """
[[chain.cell]]
p_mm = [0, 0]
q_mm = [-16.2, -6.1]
band = { stiffness_N_per_m = 32, rest_length_mm = 0.4 }
friction_N = 0.012
unusual = true

[[chain.cell]]
p_mm = [0, 0]
q_mm = [3.77, -3.85]
band = { stiffness_N_per_m = 24.8, rest_length_mm = 19.3 }
limit_deg = 66
unusual = true

[[chain.cell]]
p_mm = [0, 0]
q_mm = [-18.4, -10.8]
band = { stiffness_N_per_m = 48.8, rest_length_mm = 8.1, two_sided = true }
unusual = true
"""


def test_a_cell_that_friction_holds_is_not_one_of_those_that_snap():
    chain = sw.files.loads(HELD_MIDWAY).subject
    assert isinstance(chain, sw.Chain)
    proof = chain.cycle().path.prove()
    assert {gap.cause for gap in proof.gaps} == {"cell 2 has a constant force"}


def test_random_chains_are_proved_or_their_gaps_named():
    rng, proved, causes = np.random.default_rng(5), 0, Counter()
    made = [chains.concave_chain(rng, 2 + k % 4) for k in range(12)]
    made += [chains.any_chain(rng, 2, friction=False) for _ in range(6)]
    for chain in made:
        proof = chain.cycle().path.prove()
        proved += proof.proved
        causes.update(gap.cause for gap in proof.gaps)
        assert not any(gap.contradicted for gap in proof.gaps), chain
    assert proved >= 15, causes


def test_a_snap_of_three_cells_with_friction_is_followed():
    chain = chains.any_chain(np.random.default_rng(1), 3)
    proof = chain.cycle().path.prove()
    flows = [one for one in proof.events if one.theorem is Theorem.FLOW]
    assert proof.proved and len(flows[0].event.cells) == 3 and chain.cells[2].friction > 0


# Cells that rest or slide as a flow begins, come to rest in it, let go, or reverse at a stop; two
# that rest as soon as the third one is at its stop (35), and one λ of many (263).
@pytest.mark.parametrize(
    "number", cases([35, 38, 92, 110, 125, 146, 173, 260, 263, 281, 299], [125, 146, 281])
)
def test_landings_with_friction_are_proved_where_brute_force_lands(number):
    rng = np.random.default_rng([41, number])
    chain = chains.any_chain(rng, int(rng.integers(2, 7)))
    proof = chain.cycle().path.prove()
    # In the first chain a cell has a constant force in a later event: a tie.
    ties = {"cell 5 has a constant force"} if number == 38 else set()
    assert {gap.cause for gap in proof.gaps} == ties
    assert any(cell.friction > 0.0 for cell in chain.cells)
    race = Race([as_oracle(cell) for cell in chain.cells])
    flows = {one.event.drive: one for one in proof.events if one.theorem is Theorem.FLOW}
    for before, segment, landing in races(chain):
        if one := flows.get(segment.drive[0]):
            there = race.land(before, segment.direction, segment.drive[0])
            known = 1e-7 * race.span + one.travel_error
            assert np.all(np.abs(there - landing) <= known)
    wrong = chains.corrupted(rng, list(proof.path.events))
    assert not prove(proof.path, claims=wrong).proved


# In 2025 the windows of all cells meet where two of them stop.
@pytest.mark.parametrize("seed", cases([*range(1000, 1040), 2025], [1002, 2025]))
def test_random_flows_with_friction_end_where_brute_force_does(seed):
    chain = rubbing(seed, 3)
    proof = chain.cycle().path.prove()
    assert not any(gap.contradicted for gap in proof.gaps) and (seed != 2025 or proof.proved)
    race = Race([as_oracle(cell) for cell in chain.cells])
    flows = {one.event.drive: one for one in proof.events if one.theorem is Theorem.FLOW}
    for before, segment, landing in races(chain):
        if one := flows.get(segment.drive[0]):
            try:
                there = race.land(before, segment.direction, segment.drive[0])
            except NoRest:
                continue
            known = 1e-7 * race.span + one.travel_error
            assert np.all(np.abs(there - landing) <= known)


# All forces of a flow are constant; a snap begins at a kink whose place is a ball.
@pytest.mark.parametrize("number", [182, 269])
def test_slack_bands_in_a_snap_are_proved(number):
    rng = np.random.default_rng([41, number])
    path = chains.any_chain(rng, int(rng.integers(2, 7))).cycle().path
    assert path.prove().proved
    assert not prove(path, claims=chains.corrupted(rng, list(path.events))).proved


def test_wrong_answers_are_caught():
    rng = np.random.default_rng(0)
    paths = [sw.preset(name).cycle().path for name in ("paper-forward", "three-wave", "slack")]
    for k in range(60):
        path = paths[k % len(paths)]
        proof = prove(path, claims=chains.corrupted(rng, list(path.events)))
        assert not proof.proved and any(gap.contradicted for gap in proof.gaps)


def test_a_path_with_turns_is_proved_too():
    path = sw.preset("paper-forward").path([0.0, 0.038, 0.0, 0.01])
    assert path.prove().proved


def test_a_ratio_of_mobilities_below_one_is_refused():
    with pytest.raises(ValueError, match="mobility_ratio"):
        sw.preset("paper-forward").cycle().path.prove(mobility_ratio=0.5)


def test_a_run_reports_its_proof():
    chain = sw.preset("paper-forward")
    run = Run.of(chain)
    record = account(ProvedRun.proved(run, run.cycle.path.prove())).record
    assert violations(record) == []
    assert record["proof"]["proved"] and record["sequence"] == "00>10>11>01>00"
    assert len(json.dumps(record["proof"]["events"])) > 100


def test_a_kink_behind_the_start_of_a_snap_is_seen():
    # The load's last kink is 0.3 mm behind the fold: there the pull falls, and the snap lands.
    first = sw.Band((0.0, 0.0), (-0.0018657565, -0.01121597), 47.202877, 0.0129425715)
    bent = sw.mechanism.Cubic(3.31373028, 2364.774905)
    second = sw.Band((0.0, 0.0), (-0.0087753425, -0.0052548789), 57.343771, 0.0090655358, bent)
    load = sw.Load(
        (0.0018747132, 0.0049221012, 0.0111280879), (-0.0134036642, 0.1280757, -0.0768899)
    )
    inner = sw.Cell(first, chains.LEVER, 0.50702845, unusual=True)
    outer = sw.Cell(second, 0.0193103885, 0.67730528, load=load, unusual=True)
    proof = sw.Chain([inner, outer]).cycle().path.prove()
    assert proof.proved and any(event.theorem for event in proof.events)


def test_a_snap_from_a_kink_whose_leader_is_next_to_its_stop_is_proved():
    # The leader has 1.4 µm to go: behind the kink all boxes have to be clear of its ball.
    rng = np.random.default_rng([41, 182])
    proof = chains.any_chain(rng, int(rng.integers(2, 7))).cycle().path.prove()
    assert proof.proved
    wrong = chains.corrupted(rng, list(proof.path.events))
    assert not prove(proof.path, claims=wrong).proved


def flows_of(seed: int) -> tuple[PathProof, list[ProvedEvent]]:
    rng = np.random.default_rng([41, seed])
    proof = chains.any_chain(rng, int(rng.integers(2, 7)), friction=False).cycle().path.prove()
    return proof, [one for one in proof.events if one.theorem is Theorem.FLOW]


# Three falling cells, a beginning with two rising cells, one that comes back, and a fold; a fold of
# three cells, and others with a slow flow behind it.
@pytest.mark.parametrize("seed", cases([23, 51, 52, 54, 250, 28, 40, 61], [23, 52, 250]))
def test_landings_of_flows_of_several_cells_are_enclosed(seed):
    proof, flows = flows_of(seed)
    assert proof.proved and flows and proof.worst_error < 1e-12
    if seed == 23:
        claims = list(proof.path.events)
        claims[flows[0].number] = _moved(flows[0].event, 1e-9)
        assert not prove(proof.path, claims=claims).proved


def test_a_branch_next_to_a_kink_of_a_cell_that_follows_is_proved():
    chain = chains.any_chain(np.random.default_rng([43, 60]), 2, friction=False)
    assert chain.cycle().path.prove().proved


def test_a_released_cell_that_another_one_pushes_back_rests_at_its_stop_again():
    # Two cells are pulled from their stops at once; the force of the second one presses the first.
    rng = np.random.default_rng([4242, 28])
    chain = chains.any_chain(rng, int(rng.integers(2, 7)), friction=False)
    assert chain.cycle().path.prove().proved


def test_a_polynomial_that_leaves_its_stops_is_no_middle_of_a_tube():
    chain = sw.preset("three-wave")
    cells, at = EnclosedWalk(chain, problem_of(chain)).cells, {}
    for i, cell in enumerate(cells[:2]):
        at[i] = number(cell.low) + 0.1 * i * cell.size
    motion = FlowMotion(cells, [1.0] * 3, at, dict.fromkeys(at, ball(0.0)))
    out = motion.travel[0][1] < 0.0
    for h in (1e-6, 1e-4):
        assert motion.stays_within(motion.spans(h), h) is not out
    motion.travel[0] = [-c for c in motion.travel[0]]
    assert motion.stays_within(motion.spans(1e-6), 1e-6) is out


def test_flows_of_slack_bands_do_not_part():
    assert parting_rate([ball(0.0)] * 3, [1.0, 2.0, 1.0]) == 0


def test_a_box_next_to_the_joint_of_a_band_has_the_slope_of_its_side():
    found = 0
    for seed in range(40):
        chain = chains.any_chain(np.random.default_rng([44, seed]), 2, friction=False)
        walk = EnclosedWalk(chain, problem_of(chain))
        for cell in walk.cells:
            for joint in _marks(walk, cell.cell):
                for side in (-1, 1):
                    box = hull(ball(joint + side * 1e-9), ball(joint + side * 3e-9))
                    slope, thin = cell.law(box)[1], cell.law(ball(joint + side * 2e-9))[1]
                    assert slope.contains(thin) and slope.rad() < 1e-3 * abs(thin) + 1e-3
                    found += 1
    assert found >= 20


def _moved(event: sw.statics.Event, by: float) -> sw.statics.Event:
    return replace(event, after=(event.after[0] + by, *event.after[1:]))


def test_a_tube_of_unknown_radius_covers_the_whole_travel():
    chain = sw.preset("three-wave")
    walk = EnclosedWalk(chain, problem_of(chain))
    walk.stand_at(Configuration((0.0,) * 3, (0,) * 3), 0.0)
    tube = Tube(walk, {0: ball(0.001), 1: ball(0.002)})
    around = tube.around({0: ball(0.001)}, ball(math.nan))
    assert around[0].contains(walk.cells[0].low) and around[0].contains(walk.cells[0].high)


def test_a_span_in_which_a_band_may_have_no_length_has_no_polynomial():
    cell = EnclosedWalk(sw.preset("three-wave"), problem_of(sw.preset("three-wave"))).cells[0]
    assert cell.taylor(ball(0.005, 1e-6), 3) is not None
    assert cell.taylor(ball(0.005, 1.0), 3) is None


def test_wide_spans_of_random_cells_have_a_polynomial_or_none_and_never_an_error():
    chain = chains.any_chain(np.random.default_rng([5, 29]), 3, friction=False)
    widths, found = np.geomspace(1e-6, 3e-2, 20), []
    for cell in EnclosedWalk(chain, problem_of(chain)).cells:
        places = np.linspace(0.0, cell.size, 7).tolist()
        found += [cell.taylor(ball(s, w), 3) is None for s in places for w in widths.tolist()]
    assert any(found) and not all(found)


def test_power_series_of_a_force_have_all_terms_that_are_asked_for():
    cell = EnclosedWalk(sw.preset("three-wave"), problem_of(sw.preset("three-wave"))).cells[0]
    at, way, degree = 0.4 * cell.size, 0.02 * cell.size, 14
    terms = cell.taylor(ball(at), degree)
    assert terms is not None and all(not term.is_zero() for term in terms)
    total = sum((term * ball(way) ** k for k, term in enumerate(terms)), ball(0.0))
    miss = abs(total - cell.law(ball(at) + ball(way))[0])
    assert float(miss.upper()) < 4.0 * abs(float(terms[-1].mid())) * way**degree + 1e-25
