"""Proofs of margins, of all machines within tolerances, and of refusals, tried by the engine."""

import json
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest

import chains
import stepwell as sw
from accounts.schemas import violations
from facts import says
from golden.running import invoke
from sizes import cases
from stepwell.accounts import account
from stepwell.base import InputError
from stepwell.design import AnchorBox, BandType, Draws, Impossible, Requirement, Tolerances
from stepwell.design.targets import reachable_states
from stepwell.proof import BoxOutcome, ToleranceProof, box_prover, prove_tolerances
from stepwell.proof.exclusions import _meets
from stepwell.proof.order_boxes import becomes

CAREFUL, USUAL = Tolerances(0.0001, 0.01), Tolerances(0.0003, 0.05)
# Presets that careful workshop practice always builds right, by theorem.
SURE = "paper-forward", "paper-counterclockwise", "paper-via-01", "rubber", "friction"
OTHERS = "force-control", "compliant-actuator", "paper-forward-double", "three-stack", "dome"


def extreme_machine(draws: Draws, rng: np.random.Generator) -> sw.Chain:
    """A machine at a corner of a box: anchors at the rims of their discs, numbers at their ends."""
    row = rng.random(draws.columns)
    b, n = draws.bands, len(draws.chain)
    row[: 4 * b : 2] = 1.0
    row[4 * b : 6 * b] = rng.choice([-4.0, 4.0], 2 * b)
    row[6 * b : 6 * b + 2 * n] = rng.choice([0.0, 1.0], 2 * n)
    row[draws.scales : draws.mobilities] = rng.choice([-4.0, 4.0], draws.mobilities - draws.scales)
    row[draws.mobilities :] = 0.5
    return draws.built(row)


def attacked(proof: ToleranceProof, rng: np.random.Generator, count: int) -> None:
    """Machines of a proved box, half of them at its corners, all have the sequence."""
    draws = Draws(proof.chain, proof.tolerances, int(rng.integers(1000)))
    for k in range(count):
        machine = draws.sample(k) if k % 2 else extreme_machine(draws, rng)
        assert becomes(machine, proof.sequence) == "", machine


@pytest.mark.parametrize("name", [*SURE, *OTHERS])
def test_every_machine_of_a_proved_box_has_the_sequence(name):
    proof = prove_tolerances(sw.preset(name), USUAL)
    assert proof.outcome is BoxOutcome.PROVED and proof.undecided == 0.0
    attacked(proof, np.random.default_rng(0), 8)


@pytest.mark.parametrize("name", ["paper-backward", "three-wave", "paper-identical"])
def test_a_box_is_refuted_by_a_machine_within_the_tolerances(name):
    proof = prove_tolerances(sw.preset(name), USUAL)
    assert proof.outcome is BoxOutcome.REFUTED and proof.counterexample is not None
    assert str(proof.counterexample.cycle().sequence) == proof.becomes != proof.sequence
    for own, made in zip(proof.chain.levers, proof.counterexample.levers, strict=True):
        for a, b in zip(own.bands, made.bands, strict=True):
            # Each of two anchors in its disc, and the stiffness within four deviations.
            assert all(
                np.hypot(*np.subtract(getattr(a, e), getattr(b, e))) < 3.001e-4 for e in "pq"
            )
            assert abs(b.stiffness / a.stiffness - 1.0) <= 0.2 + 1e-12


def test_random_chains_within_random_tolerances_are_decided():
    rng, outcomes = np.random.default_rng(7), []
    for k in range(9):
        t = Tolerances(*(rng.random(5) * [0.0003, 0.01, 0.01, 0.0003, 0.01]))
        proof = prove_tolerances(chains.concave_chain(rng, 2 + k % 3), t)
        outcomes.append(proof.outcome)
        if proof.proved:
            attacked(proof, rng, 4)
    assert BoxOutcome.UNDECIDED not in outcomes and BoxOutcome.PROVED in outcomes


def test_two_hundred_machines_with_a_slack_band_do_what_is_proved():
    proof = prove_tolerances(sw.preset("slack"), Tolerances(0.001, 0.05))
    assert proof.proved and proof.boxes == 1
    attacked(proof, np.random.default_rng(3), 200)


def any_equal_levers(seed: int) -> sw.Chain:
    """Two to four cells of any kind with one lever and one limit."""
    rng, cells = np.random.default_rng([7, seed]), list[sw.Cell]()
    number = int(rng.integers(2, 5))
    while len(cells) < number:
        cell = chains.any_cell(rng)
        with suppress(ValueError):
            cells.append(replace(cell, lever=chains.LEVER, limit=chains.LIMIT))
    return sw.Chain(cells)


@pytest.mark.parametrize("seed", cases([5, 13, 17, 19, 27], [13, 17, 19]))
def test_forces_that_rise_on_the_way_do_not_change_a_proved_order(seed):
    chain = any_equal_levers(seed)
    proof = prove_tolerances(chain, Tolerances(0.0001, 0.005, 0.005, 0.0, 0.001))
    assert proof.proved
    attacked(proof, np.random.default_rng(seed), 10)


@pytest.mark.parametrize("seed", cases([10, 12, 15, 21], [10, 15]))
def test_a_box_with_a_machine_that_fails_is_never_proved(seed, monkeypatch):
    chain, wide = any_equal_levers(seed), Tolerances(0.001, 0.05, 0.02)
    monkeypatch.setattr(box_prover, "_SAMPLES", 0)
    proof = prove_tolerances(chain, wide, boxes=20)
    draws = Draws(chain, wide, 1)
    rng = np.random.default_rng(seed)
    made = [draws.sample(k) if k % 2 else extreme_machine(draws, rng) for k in range(20)]
    assert any(becomes(one, proof.sequence) for one in made) and not proof.proved


def test_a_box_that_is_decided_in_part_has_a_share_that_shrinks_with_the_boxes():
    chain, within = any_equal_levers(18), Tolerances(0.0001, 0.005, 0.0095, 0.0, 0.0013)
    shares: list[float] = []
    for boxes in (3, 31):
        proof = prove_tolerances(chain, within, boxes=boxes)
        assert proof.outcome is BoxOutcome.UNDECIDED and proof.boxes <= boxes
        shares.append(proof.undecided or 0.0)
        says(proof.cause, "order", "while")
    assert 1.0 > shares[0] > shares[1] > 0.0


def test_what_no_theorem_covers_is_not_decided():
    proof = prove_tolerances(sw.preset("slack"), Tolerances(0.0003, lever=0.0002), boxes=9)
    assert proof.outcome is BoxOutcome.UNDECIDED and proof.undecided == 1.0 and proof.boxes == 9
    says(proof.cause, "outer", "not proved")


def test_a_yield_of_100_percent_becomes_a_theorem_or_falls():
    paper = sw.preset("paper-forward")
    assert paper.yields(USUAL, samples=100).prove().proved
    # All of 20,000 samples do it, and yet one machine within the tolerances does not.
    sampled = sw.preset("three-wave").yields(USUAL, samples=20_000)
    assert sampled.fraction == 1.0 and sampled.prove().outcome is BoxOutcome.REFUTED


def test_a_yield_of_states_has_no_proof():
    counted = sw.preset("paper-forward").yields(USUAL, samples=10, target=["00", "10", "11"])
    with pytest.raises(InputError, match="states"):
        counted.prove()
    with pytest.raises(InputError, match="mobility"):
        prove_tolerances(sw.preset("paper-forward"), Tolerances(mobility=2.0))


@pytest.mark.parametrize("name", ["paper-forward", "three-wave", "hopper"])
def test_no_change_below_a_proved_margin_alters_the_sequence(name):
    chain = sw.preset(name)
    proof = chain.margin().prove()
    for one in proof.changes:
        change = one.change
        assert one.proved == (not one.cause)
        if not one.proved or not np.isfinite(change.distance):
            continue
        assert change.distance * 0.999 < one.up_to < change.distance
        assert becomes(change.design, str(chain.cycle().sequence))
    assert proof.proved == (name != "hopper")


def test_a_margin_that_a_search_overestimates_is_refuted():
    proof = sw.preset("foot-weight").margin().prove(CAREFUL)
    wrong = [one for one in proof.changes if one.outcome is BoxOutcome.REFUTED]
    assert [one.change.method.value for one in wrong] == ["search"]
    assert wrong[0].up_to < wrong[0].refuted_from <= wrong[0].change.distance
    assert proof.within is not None and proof.within.proved


def test_designs_next_to_a_tie_have_no_proved_box():
    cell = sw.preset("paper-forward").cells[0]
    for gap in (0.0, 1e-14, 1e-11):
        band = replace(cell.band, stiffness=cell.band.stiffness * (1.0 + gap))
        assert not prove_tolerances(sw.Chain([cell, replace(cell, band=band)]), Tolerances()).proved


def refusal(*given: str, **options) -> Impossible:
    with pytest.raises(Impossible) as caught:
        sw.design(*given, samples=20, **options)
    return caught.value


THREE = "000>100>110>111>011>001>000"
PLACE = AnchorBox(-0.001, 0.011, -0.001, 0.011)
STRIP, WHERE = (AnchorBox(x, y, -0.006, 0.006) for x, y in ((0.009, 0.021), (0.006, 0.020)))
FIVE = "000", "100", "010", "110", "111"
CIRCLE = "2 before 1 loading; 1 before 2 loading"
TWO = "state 10; 2 before 1 loading; 1 before 2 unloading"
SAME = "1 before 2 loading; 1 before 2 unloading; 3 cells"


@pytest.mark.parametrize(
    ("why", "word"),
    [
        (lambda: refusal("00>10>11>01>00", holes=0.040), "all 1 choice"),
        (lambda: refusal(THREE, holes=0.010, within=AnchorBox(0.009, 0.021, -0.006, 0.006)), "8"),
        # Some of these cells are not concave: their cycles are proved one by one.
        (lambda: refusal(THREE, holes=0.010, within=PLACE, bands=[BandType(28.5, 0.022)]), "6"),
        (lambda: refusal(states=["00", "10", "01"]), "every chain"),
        (lambda: _unreachable(), "36 pairs of orders"),
        (lambda: _of_one_shape("dome", "00>10>11>01>00"), "scales from 0.5 to 2"),
        (lambda: refusal(states=["00", "10", "11"], holes=0.040), "all 1 choice"),
        (lambda: refusal(states=FIVE, holes=0.010, within=STRIP), "all 8 choices"),
        (lambda: refusal(requirements=f"{CIRCLE}; 3 first unloading"), "chain of 3"),
        (lambda: refusal(requirements=TWO, within=WHERE), "4 pairs of orders"),
        (lambda: refusal(requirements=f"never two half way; {SAME}", within=WHERE), "36 pairs"),
    ],
)
def test_a_refusal_is_proved_for_a_named_set(why, word):
    proved = why().prove()
    assert proved.outcome is BoxOutcome.PROVED, proved.cause
    says(proved.proof, "proved for", word)


def _of_one_shape(name: str, target: str) -> Impossible:
    element = sw.mechanism.LIBRARY[name].make(name=name)
    return refusal(target, elements=[element], actuator_stiffness=0.0)


def _unreachable() -> Impossible:
    return refusal(states=["000", "110", "111"], within=AnchorBox(0.006, 0.020, -0.006, 0.006))


def test_a_refusal_without_a_proof_of_the_search_is_not_decided():
    target = ["000", "100", "110", "011", "111"]
    why = refusal(states=target, within=AnchorBox(0.006, 0.020, -0.006, 0.006))
    proved = why.prove()
    assert not why.proved and proved.outcome is BoxOutcome.UNDECIDED and proved.cause
    assert str(proved) == str(why)


def test_the_smallest_contradictory_part_is_named_and_no_other_requirement():
    proof = refusal(requirements=f"{CIRCLE}; 3 first unloading").prove().proof
    says(proof, "2 before 1 loading", "1 before 2 loading", "none of them")
    assert "3 first unloading" not in proof


def test_states_that_a_stroke_may_reach_besides_those_of_two_orders_are_not_decided():
    why = refusal(
        requirements="state 100; 2 before 1 loading; 1 before 2 unloading; 3 cells", within=WHERE
    )
    proved = why.prove()
    assert why.proved and proved.outcome is BoxOutcome.UNDECIDED
    says(proved.cause, "more states")


def test_requirements_that_a_chain_meets_are_met_by_its_orders():
    rng = np.random.default_rng(2)
    kinds = "{0} before {1} {2}", "{0} first {2}", "{0} last {2}", "{0} never without {1}"
    for k in range(12):
        chain = chains.concave_chain(rng, 2 + k % 2)
        orders, reached = chain.cycle().sequence.orders, reachable_states(chain)[0]
        assert orders is not None
        for a, b in permutations(range(1, len(chain) + 1), 2):
            for way, order in zip(("loading", "unloading"), orders, strict=True):
                seen = order.index(a - 1), order.index(b - 1)
                last = len(order) - 1
                without = any(one[a - 1] == "1" and one[b - 1] == "0" for one in reached)
                truth = seen[0] < seen[1], seen[0] == 0, seen[0] == last, not without
                for kind, holds in zip(kinds, truth, strict=True):
                    one = Requirement.parse(kind.format(a, b, way))
                    # A chain that meets a requirement has orders that meet it.
                    assert _meets(one, *orders) or not holds, (one, orders)


def test_multipliers_of_a_refusal_add_up_to_a_contradiction_in_fractions():
    # Forces up 1 and down 1/2 of both, one scale each: 0 before 1 going up, 0 before 1 going down.
    up, down = Fraction(1), Fraction(1, 2)
    # c1 up - c0 up > 0 and c0 down - c1 down > 0, with weights 1 and 2: their sum is 0.
    assert [-up + 2 * down, up - 2 * down] == [0, 0]
    proved = _of_one_shape("dome", "00>10>11>01>00").prove()
    says(proved.theorem, "non-negative multipliers")


def test_the_command_margin_reports_its_proof():
    shown = invoke("margin", "paper-forward", "--prove", "--json")
    record = json.loads(shown.stdout)
    assert (shown.exit_code, violations(record)) == (0, [])
    assert record["proof"]["proved"]
    assert record["proof"]["within_tolerances"]["outcome"] == "proved"
    says(invoke("margin", "three-wave", "--prove").stdout, "refuted", "machine within")


def test_the_command_design_reports_its_proof():
    shown = invoke("design", "00>10>11>01>00", "--samples", "20", "--prove", "--json")
    record = json.loads(shown.stdout)
    assert violations(record) == []
    assert record["proof"]["path"]["proved"] and record["proof"]["outcome"] is None
    shown = invoke("design", "00>10>11>01>00", "--holes", "40", "--prove", "--json")
    record = json.loads(shown.stdout)
    assert (shown.exit_code, violations(record)) == (3, [])
    assert record["proof"]["outcome"] == "proved" and record["proof"]["margin"] is None


def test_a_proof_within_tolerances_has_a_record_of_its_own():
    proof = prove_tolerances(sw.preset("paper-forward"), CAREFUL)
    says(account(proof).answer, "proved for", "every machine")
