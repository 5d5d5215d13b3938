"""State machines against brute force, and chains that realise them against plain paths."""

import random
import re
from dataclasses import replace
from functools import cache
from itertools import product

import pytest

import stepwell as sw
from facts import refuses, says
from sizes import examples
from stepwell.design import Draws, machine_yield
from stepwell.sequences import Machine, exchanging_program, realisations, realise
from stepwell.sequences.responses import _exchanged

TOUCH = """
title = "The second touch does something else than the first"
inputs = ["touch", "reset"]
start = "fresh"
[states.fresh]
touch = "once"
reset = "fresh"
[states.once]
output = "bend"
touch = "twice"
reset = "fresh"
[states.twice]
output = "turn"
touch = "twice"
reset = "fresh"
"""
PARITY = "(zero* one zero* one)* zero*"


def paper_cells(*outer):
    """Cells of the paper's band and lever with these outer anchors [mm]."""
    bands = [sw.Band((-0.010, 0.0), (x / 1e3, y / 1e3), 28.5, 0.010) for x, y in outer]
    return sw.Chain([sw.Cell(band) for band in bands])


@cache
def second_touch():
    """The widest realisation of TOUCH on three cells of the paper."""
    chain = paper_cells((16.0, 2.6), (1.9, 7.4), (8.2, 6.1))
    ways = realisations(chain, Machine.parse(TOUCH), turns=2)
    return max(ways, key=lambda one: one.slack)


@pytest.mark.parametrize(
    ("language", "pattern"),
    [
        ("(short | long)* long short", "(s|l)*ls"),
        ("short+ long?", "s+l?"),
        ("(short long)* | long+", "(sl)*|l+"),
        ("(short short)*", "(ss)*"),
        ("((short? long)* short)+", "((s?l)*s)+"),
    ],
)
def test_the_machine_of_a_language_accepts_the_words_of_the_pattern(language, pattern):
    machine = Machine.of_language(language, ("short", "long"))
    for length in range(7):
        for word in product(("short", "long"), repeat=length):
            letters = "".join(name[0] for name in word)
            accepted = machine.run(word)[-1] == "yes"
            assert accepted == bool(re.fullmatch(pattern, letters)), word


def test_the_machine_of_a_language_is_the_smallest():
    # Myhill and Nerode: a state for each set of words that may follow.
    machine = Machine.of_language(PARITY)
    assert len(machine.states) == 2
    for language, names in ((PARITY, "zero one"), ("a b a", "a b"), ("(a | b)* a", "a b")):
        own = Machine.of_language(language)
        words = [w for n in range(5) for w in product(names.split(), repeat=n)]
        follows = {tuple(own.run((*w, *end))[-1] for end in words) for w in words}
        assert len(own.states) == len(follows)


def acts_otherwise(machine, longest):
    """Whether a word of at most this length does not act twice as once, from any state."""
    for length in range(1, longest + 1):
        for word in product(machine.inputs, repeat=length):
            for state in range(len(machine.states)):
                ends = []
                for _ in range(2):
                    for name in word:
                        state = machine.moves[state][machine.inputs.index(name)]
                    ends.append(state)
                if ends[0] != ends[1]:
                    return word
    return None


@pytest.mark.parametrize("seed", range(12))
def test_a_pumped_word_is_the_one_that_brute_force_finds(seed):
    rng = random.Random(seed)
    size, inputs = rng.randint(2, 4), ("a", "b")
    moves = tuple(tuple(rng.randrange(size) for _ in inputs) for _ in range(size))
    names = tuple(f"s{k}" for k in range(size))
    machine = Machine(inputs, names, moves, names).smallest
    word, pump = acts_otherwise(machine, 6), machine.pump
    assert (pump is None) == (word is None)
    if pump is not None and pump.period == 1:
        assert word is not None and len(pump.word) == len(word)


def test_a_parity_is_pumped_with_period_two():
    pump, touch = Machine.of_language(PARITY).pump, Machine.parse(TOUCH).pump
    assert pump is not None and touch is not None
    assert pump.word == ("one",) and pump.period == 2
    assert touch.period == 1


def test_a_machine_that_every_word_settles_at_once_has_no_pump():
    # The last of two inputs decides.
    last = Machine.of_language("(a | b)* a")
    assert last.pump is None and acts_otherwise(last, 6) is None


def test_ten_thousand_random_inputs_are_answered_without_a_mistake():
    way = second_touch()
    inputs = random.Random(0).choices(way.machine.inputs, k=10_000)
    assert way.follow(inputs) == way.machine.run(inputs)
    assert way.simulate(inputs) == way.machine.run(inputs)


def test_one_plain_path_passes_the_places_of_the_table():
    way = second_touch()
    inputs = random.Random(1).choices(way.machine.inputs, k=40)
    outputs, seen = way.machine.run(inputs), {}
    for k in (0, 1, 2, 5, 11, 40):
        # From all cells at 0 through the reset and all inputs in one path.
        points = [*way.reset, *way.drives(inputs[:k])[1:]]
        place = tuple(way.chain.path(points).end.round(7))
        assert seen.setdefault(place, outputs[k]) == outputs[k]


def test_every_choice_of_turning_points_within_the_intervals_behaves_the_same():
    way, rng = second_touch(), random.Random(2)
    for _ in range(10):
        base = rng.uniform(way.base.low, way.base.high)
        place = way.chain.path([*way.reset, base]).end_configuration
        known = {}
        state, word = 0, rng.choices(way.machine.inputs, k=8)
        for name in word:
            spans = way.inputs[way.machine.inputs.index(name)]
            points = [base, *(rng.uniform(span.low, span.high) for span in spans), base]
            run = way.chain.path(points, start=place)
            place = run.end_configuration
            state = way.machine.moves[state][way.machine.inputs.index(name)]
            key = tuple(run.end.round(7))
            assert known.setdefault(key, state) == state


def test_samples_within_tolerances_behave_as_the_machine():
    made = machine_yield(second_touch(), sw.Tolerances(anchor=0.001), samples=30)
    assert made.successes >= 29
    way = second_touch()
    assert not way.holds_in(paper_cells((16.0, 2.6), (1.9, -7.4), (8.2, 6.1)))


@pytest.mark.parametrize("seed", range(6))
def test_under_a_prescribed_force_a_second_touch_is_never_realised(seed):
    # Every word acts twice as it acts once (theory page, "State machines").
    rng = random.Random(seed)
    outer = [(rng.uniform(0, 20), rng.uniform(-15, 15)) for _ in range(4)]
    made = paper_cells(*outer)
    chain = sw.Chain(made.cells, actuator_stiffness=0.0)
    assert not [*realisations(chain, Machine.parse(TOUCH), by_hand=True, turns=2)]
    # A machine of which every word acts so is found: the last of two inputs decides.
    last = Machine.of_language("(up | down)* up")
    assert next(realisations(chain, last), None) is not None


def test_a_gate_that_begins_in_a_state_set_by_hand_behaves_so_in_the_engine():
    chain = paper_cells((17.8, -8.2), (2.5, -6.4), (11.7, 1.6))
    gate = Machine.of_language("(a | b)* a (a | b)* b (a | b)* | (a | b)* b (a | b)* a (a | b)*")
    ways = [*realisations(chain, gate, by_hand=True)]
    assert ways and not [*realisations(chain, gate)]
    way = max(ways, key=lambda one: one.slack)
    assert way.by_hand and "-" not in way.start
    inputs = random.Random(3).choices(way.machine.inputs, k=30)
    assert way.simulate(inputs) == way.machine.run(inputs)


def test_an_exchange_of_two_branches_is_found_where_there_is_one():
    # Three branches at three drives: 0 rises to 1, 1 falls to 2; and 2 rises to 2, 2 falls to 0.
    rises, falls = [[0, 1, 2], [0, 1, 2], [1, 1, 2]], [[2, 2, 0], [0, 1, 2], [0, 1, 2]]
    assert not _exchanged(([[0, 1]] * 3, [[0, 1]] * 3), 1, (0, 1))
    assert _exchanged(([[0, 1], [1, 0]], [[0, 1], [0, 1]]), 0, (0, 1))
    assert not _exchanged((rises, falls), 1, (0, 1))


def test_the_chain_of_the_second_touch_holds_no_parity():
    chain = second_touch().chain
    assert exchanging_program(chain) is None
    assert not [*realisations(chain, Machine.of_language(PARITY), turns=2)]


def test_realise_takes_the_widest_and_a_hand_only_where_it_must():
    way = realise(second_touch().chain, Machine.parse(TOUCH))
    assert way.slack == second_touch().slack and not way.by_hand
    leg = sw.preset("paper-forward")
    assert not realise(leg, Machine.of_language("(up | down)* up")).by_hand


def test_realise_proves_where_it_can_that_a_chain_holds_no_machine():
    leg = sw.preset("paper-forward")
    with refuses(sw.Unreachable, "'one'", "period 2", "No program exchanges") as why:
        realise(leg, Machine.of_language(PARITY))
    assert why.value.proved
    forced = sw.Chain(leg.cells, actuator_stiffness=0.0)
    with refuses(sw.Unreachable, "acts twice as", "prescribe the stroke") as why:
        realise(forced, Machine.parse(TOUCH))
    assert why.value.proved
    # With a prescribed stroke this pair has no such inputs either, but that is no proof.
    with refuses(sw.Unreachable, "is no proof") as why:
        realise(leg, Machine.parse(TOUCH))
    assert not why.value.proved


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ('inputs = ["a"]', ("`language`", "`states`")),
        ('inputs = ["a"]\nlanguage = "b"', ("'b'", "not among")),
        ('language = "(a"', ("'the end'",)),
        ('language = "a | ) b"', ("')'",)),
        ('inputs = ["a"]\nstart = "x"\n[states.y]\na = "y"', ("start", "'x'")),
        ('inputs = ["a"]\nstart = "y"\n[states.y]\na = "z"', ("states.y.a", "'z'")),
        ('inputs = ["a"]\nstart = "y"\n[states.y]', ("states.y.a", "None")),
        ('inputs = ["a"]\nstart = "y"\n[states.y]\na = "y"\nb = "y"', ("states.y.b",)),
        ('inputs = ["a", "a"]\nlanguage = "a"', ("inputs", "each once")),
        ("inputs = [", ("TOML",)),
        ('colour = 1\nlanguage = "a"', ("colour", "unknown key")),
    ],
)
def test_a_machine_that_cannot_be_read_is_refused(text, parts):
    with refuses(sw.InputError, *parts):
        Machine.parse(text)


def test_a_language_with_too_many_states_is_refused():
    with refuses(sw.InputError, "more than 64"):
        Machine.of_language("(a | b)* a" + " (a | b)" * 8)


def test_the_table_lists_what_every_input_does():
    text = str(second_touch())
    says(text.splitlines(), "chain", "state", "touch")
    assert len(second_touch().replies) == 3


# Each machine of the package, and the preset that does it.
DOES = {
    "second-touch": "second-touch",
    "forgetting": "second-touch",
    "parity-of-two": "second-touch",
    "countdown": "countdown",
    "two-point-gate": "two-point-gate",
    "lock-with-alarm": "lock-with-alarm",
}


@pytest.mark.parametrize("name", DOES)
def test_a_preset_answers_ten_thousand_random_inputs_as_the_machine_of_the_package(name):
    machine = sw.files.load_machine(name)
    way = realise(sw.preset(DOES[name]), machine)
    inputs = random.Random(4).choices(way.machine.inputs, k=10_000)
    assert way.simulate(inputs) == machine.run(inputs)
    # A lock needs sorted bands.
    stiffness = 0.01 if name == "lock-with-alarm" else 0.03
    made = machine_yield(way, sw.Tolerances(anchor=0.0003, stiffness=stiffness), samples=12)
    assert made.successes >= 11


def test_every_machine_of_the_package_is_done_or_refused():
    refused = {*sw.files.machines()} - {*DOES}
    assert refused == {"parity"}
    with refuses(sw.Unreachable, "period 2", "No program exchanges") as why:
        realise(sw.preset("second-touch"), sw.files.load_machine("parity"))
    assert why.value.proved


def sorted_as(gripper, stiffness):
    """The state in which a grip of an object of this stiffness [N/m] ends."""
    run = replace(gripper, actuator_stiffness=stiffness).path([0.0, 0.0481, 0.0437])
    # Without the object, the stroke back to 0 sets all cells to 0, from which the next grip begins.
    empty = replace(gripper, actuator_stiffness=float("inf"))
    stroke = float(run.end.sum())
    assert max(empty.path([stroke, 0.0], start=run.end_configuration).end) < 1e-9
    return "".join("01"[int(travel > 0.01)] for travel in run.end)


def test_a_gripper_sorts_random_objects_by_their_stiffness():
    gripper, rng = sw.preset("stiffness-gripper"), random.Random(5)
    for low, high, state in ((3.0, 10.0, "00"), (11.0, 40.0, "01"), (50.0, 1000.0, "11")):
        for _ in range(examples(60, full=3_334)):
            assert sorted_as(gripper, rng.uniform(low, high)) == state
    copies = Draws(gripper, sw.Tolerances(anchor=0.0003, stiffness=0.03), 6)
    for k in range(30):
        states = [sorted_as(copies.sample(k), stiffness) for stiffness in (5.0, 20.0, 200.0)]
        assert states == ["00", "01", "11"]


def test_a_machine_that_is_neither_a_name_nor_a_file_is_refused(tmp_path):
    with refuses(sw.files.DesignError, "machine parit", "mean parity"):
        sw.files.load_machine("parit")
    wrong = tmp_path / "wrong.toml"
    wrong.write_text('inputs = ["a"]')
    with refuses(sw.files.DesignError, "wrong.toml", "`language`"):
        sw.files.load_machine(wrong)
