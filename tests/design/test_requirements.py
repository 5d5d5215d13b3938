"""Requirements against all pairs of orders, followed by a model of relays that shares nothing."""

import random
import re
from itertools import combinations, permutations, product

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from stepwell.base import InputError
from stepwell.design import Requirement, Requirements

WAYS = ("loading", "unloading")


def reached(loading, unloading):
    """States by adding the first free cell of one order and removing the first of the other."""
    seen, waiting = set(), [frozenset()]
    while waiting:
        state = waiting.pop()
        if state in seen:
            continue
        seen.add(state)
        added = [cell for cell in loading if cell not in state][:1]
        removed = [cell for cell in unloading if cell in state][:1]
        waiting += [state | {*added}, state - {*removed}]
    return {"".join("01"[i in one] for i in range(len(loading))) for one in seen}


def apart(loading, unloading):
    """Whether no cell loads above the force at which a full one gives travel back, by relays."""
    # F0 by rank in loading, F1 below all F0 by rank in ascending F1.
    back = {cell: -rank for rank, cell in enumerate(unloading)}
    return all(back[i] < back[j] for k, j in enumerate(loading) for i in loading[:k])


def meets(text, loading, unloading):
    """Whether a requirement holds for two orders of cells 0, 1, ..."""
    words, states = text.split(), reached(loading, unloading)
    if words[-1] == "way":
        return apart(loading, unloading)
    if words[0] == "state":
        return words[1] in states
    if words[1] == "to":
        # From a reached state, the first free cell of the order is the one that moves.
        loading_step = words[2].count("1") > words[0].count("1")
        ordered, digit = (loading, "0") if loading_step else (unloading, "1")
        first = next(cell for cell in ordered if words[0][cell] == digit)
        return words[0] in states and words[0][first] != words[2][first]
    if words[0] == "never":
        pattern = re.compile(words[1].replace("*", "."))
        return not any(pattern.fullmatch(state) for state in states)
    if words[1] == "never":
        one, other = int(words[0]) - 1, int(words[3]) - 1
        return not any(state[one] == "1" and state[other] == "0" for state in states)
    order = (loading, unloading)[WAYS.index(words[-1])]
    if words[1] == "before":
        return order.index(int(words[0]) - 1) < order.index(int(words[2]) - 1)
    if words[0] == "order":
        return [str(cell + 1) for cell in order] == words[1].split("-")
    return order[0 if words[1] == "first" else -1] == int(words[0]) - 1


def every(n):
    """All pairs of orders of n cells."""
    return product(permutations(range(n)), permutations(range(n)))


def texts(n):
    """All requirements of n cells, with one order."""
    cells = range(1, n + 1)
    pairs = [(a, b) for a in cells for b in cells if a != b]
    yield from (f"{a} before {b} {way}" for a, b in pairs for way in WAYS)
    yield from (f"{a} {p} {way}" for a in cells for p in ("first", "last") for way in WAYS)
    yield from (f"{a} never without {b}" for a, b in pairs)
    yield "never two half way"
    states = ["".join(digits) for digits in product("01", repeat=n)]
    flipped = (
        (one, one[:k] + "10"[int(one[k])] + one[k + 1 :]) for one in states for k in range(n)
    )
    yield from (f"{one} to {other}" for one, other in flipped)
    yield f"order {'-'.join(map(str, cells))} loading"
    yield from (f"state {''.join(digits)}" for digits in product("01", repeat=n))
    yield from (f"never {''.join(digits)}" for digits in product("01*", repeat=n))


@pytest.mark.parametrize("n", [2, 3])
def test_every_single_requirement_is_met_by_the_orders_that_the_relays_say(n):
    whole = [*every(n)]
    for text in texts(n):
        parts = Requirements.parse([text], n)
        right = {pair for pair in whole if meets(text, *pair)}
        assert parts.possible() == bool(right), text
        met = {pair for pair in whole if parts.met_by(_orders(*pair))}
        assert met == right, text


def _orders(loading, unloading):
    from stepwell.design.orders import Orders

    return Orders(loading, unloading)


def _drawn(n, count, seed):
    chosen, every_text = random.Random(seed), [*texts(n)]
    return [chosen.sample(every_text, 4) for _ in range(count)]


@pytest.mark.parametrize(("n", "count"), [(3, 60), (4, 12)])
def test_mixed_requirements_agree_with_all_pairs_of_orders(n, count):
    whole, decided = [*every(n)], set()
    for given in _drawn(n, count, n):
        right = {pair for pair in whole if all(meets(text, *pair) for text in given)}
        parts = Requirements.parse(given, n)
        decided.add(parts.possible())
        assert parts.possible() == bool(right), given
        if right:
            listed = parts.orders(alike=False)
            pairs = {(one.loading, one.unloading) for one in listed.orders}
            assert pairs <= right
            assert not listed.complete or pairs == right
            continue
        # The smallest contradictory part: none with fewer requirements contradicts itself.
        conflict = [one.text for one in parts.conflict]
        assert not any(all(meets(text, *pair) for text in conflict) for pair in whole)
        for fewer in combinations(given, len(conflict) - 1):
            assert any(all(meets(text, *pair) for text in fewer) for pair in whole), fewer
    assert decided == {True, False}


def test_a_design_meets_its_requirements_in_the_engine():
    parts = "3 before 1 loading; 2 first unloading; state 101; 2 never without 3"
    made = sw.design(requirements=parts, samples=200)
    states = {one for one in made.chain.graph().reachable() if "-" not in one}
    assert made.loading.index(2) < made.loading.index(0) and made.unloading[0] == 1
    assert "101" in states and not {one for one in states if one[1] == "1" and one[2] == "0"}
    assert made.yield_.target == parts and made.yield_.fraction > 0.99


def moved_at_once(chain, rng):
    """How far the second fastest cell moves between two close samples of random strokes [m]."""
    points = [0.0, chain.full_stroke, *(rng.uniform(0, chain.full_stroke) for _ in range(12)), 0.0]
    steps = np.abs(np.diff(chain.path(points).travel, axis=0))
    return float(np.sort(steps, axis=1)[:, -2].max())


def test_two_cells_are_half_way_at_once_on_no_stroke():
    rng, seen = random.Random(0), set()
    for n in (2, 3):
        parts = f"never two half way; {n} cells; {n} before 1 loading"
        made = sw.design(requirements=parts, samples=5)
        assert made.loading == made.unloading[::-1]
        assert max(moved_at_once(made.chain, rng) for _ in range(9)) < 1e-9
    for _ in range(40):
        n = rng.choice((2, 3, 4))
        bands = [(rng.uniform(0, 0.02), rng.uniform(-0.006, 0.006)) for _ in range(n)]
        chain = sw.Chain([sw.Cell(sw.Band((-0.01, 0.0), q, 28.5, 0.01)) for q in bands])
        orders = chain.cycle().sequence.orders
        assert orders is not None
        # Brute force over strokes: two cells move at once exactly if the orders are not reversed.
        at_once = max(moved_at_once(chain, rng) for _ in range(3)) > 1e-5
        assert at_once != (orders[0] == orders[1][::-1])
        seen.add(at_once)
    assert seen == {True, False}


def test_two_cells_half_way_conflict_with_an_equal_order_of_both_directions():
    given = "never both half way; 1 before 2 loading; state 11; 1 before 2 unloading"
    with refuses(sw.Impossible, "both half way'", "'1 before 2", "contradict each other") as why:
        sw.design(requirements=given)
    assert why.value.proved and "state 11" not in str(why.value).split(": ")[-2]
    # Cells of several levers are not covered by the proof.
    with refuses(sw.Impossible, "only cells proved") as why:
        sw.design(requirements=given, lever=(0.0141, 0.02), equal_levers=False)
    assert not why.value.proved


def test_a_state_after_a_turn_is_passed_in_the_engine():
    made = sw.design(requirements="101 after 40 mm", samples=10)
    up = made.chain.path([0, 0.040])
    drive, passed = 0.040, ""
    while not passed:
        place = made.chain.path([0.040, drive], start=up.end_configuration).end
        at = [travel / full for travel, full in zip(place, made.chain.full_travels, strict=True)]
        exact = all(min(abs(x), abs(x - 1)) < 1e-6 for x in at)
        passed = "".join(str(round(x)) for x in at) if exact else ""
        drive -= 0.0005
    assert passed == "101"


def test_a_stroke_out_of_reach_is_wrong_input_and_not_called_impossible():
    with pytest.raises(InputError) as why:
        sw.design(requirements="101 after 90 mm")
    says(str(why.value), "101 after 90 mm", "at most 60 mm")


def test_the_yield_of_requirements_counts_every_cycle_that_meets_them():
    loose = sw.Tolerances(anchor=0.004, stiffness=0.2)
    made = sw.design(requirements="2 before 1 loading; 3 cells", tolerances=loose, samples=60)
    counted = made.yield_
    strict = made.chain.yields(loose, samples=60)
    met = sum(
        counted.mechanism(k).cycle().loading_order.index(1)
        < counted.mechanism(k).cycle().loading_order.index(0)
        for k in range(60)
    )
    assert counted.successes == met > strict.successes


def test_a_contradiction_names_its_smallest_part():
    given = "1 before 2 loading; 3 first loading; 2 before 3 loading; state 101"
    with pytest.raises(sw.Impossible) as why:
        sw.design(requirements=given)
    assert why.value.proved
    says(str(why.value), "'3 first loading'", "'2 before 3", "contradict each other")
    # The advice helps: one of the two left out.
    left = [one for one in given.split("; ") if not one.startswith("2 before")]
    assert sw.design(requirements=left, samples=5).loading[0] == 2


@pytest.mark.parametrize(
    ("weight", "sign"), [("peak force", -1), ("window", 1), ("snap energy", -1), ("yield", 1)]
)
def test_a_weight_moves_the_choice_its_own_way(weight, sign):
    from stepwell.design.synthesis.weighing import narrowest_window

    def amount(chain):
        if weight == "window":
            return narrowest_window(chain, None)
        if weight == "snap energy":
            return sum(event.released for event in chain.cycle().snaps)
        if weight == "yield":
            return chain.yields(loose, samples=400).fraction
        return abs(chain.cycle().peak_force)

    # One order, so that the yield of the requirement is that of the cycle.
    loose = sw.Tolerances(anchor=0.003, stiffness=0.15)
    given = {"sequence": "00>10>11>01>00", "samples": 5, "tolerances": loose}
    plain, more, less = (
        amount(sw.design(**given, weights=weights).chain)
        for weights in (None, {weight: 1.0}, {weight: -1.0})
    )
    assert sign * more >= sign * plain - 1e-12 and sign * more > sign * less


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("2 before 2 loading", "name two cells"),
        ("0 first loading", "number from 1"),
        ("1 before 2 pulling", "must be one"),
        ("state 10; state 101", "does not fit"),
        ("3 cells; 2 cells", "one number of"),
        ("order 2-2 loading", "each cell once"),
        ("0 cells", "between 1 and"),
        ("00 to 11", "differ in one"),
        ("00 to 010", "have one length"),
        ("00 to 01; 3 cells", "does not fit"),
        ("never both half way; 3 cells", "Write 'never two"),
        ("never two half way; 1 cells", "does not fit"),
    ],
)
def test_a_requirement_that_cannot_be_read_is_refused(text, part):
    with refuses(sw.InputError, part):
        sw.design(requirements=text)


def test_weights_are_checked():
    for weights in ({"speed": 1.0}, {"yield": 0.0}, {"yield": float("nan")}):
        with refuses(sw.InputError, "weights"):
            sw.design(requirements="1 before 2 loading", weights=weights)
    with refuses(sw.InputError, "elements", "`requirements`", "`weights`"):
        sw.design(requirements="1 before 2 loading", elements=[sw.elements.trilinear()])


def test_a_requirement_is_a_value():
    assert Requirement.parse("2  before 1 loading") == Requirement.parse("2 before 1 loading")
    assert str(Requirement.parse("inner before outer loading")) == "inner before outer loading"


def test_a_stroke_beyond_the_chain_is_refused_before_the_search():
    with refuses(sw.InputError, "101 after 61 mm", "60 mm"):
        sw.design(requirements="101 after 61 mm")
