"""Promises about tolerances, margins, maps and designs of chains with elements."""

import itertools
import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import stepwell as sw
from facts import refuses, says
from stepwell.design import Impossible, parameter, parameter_boundaries, parameters
from stepwell.design.margins.margin import Change
from stepwell.design.switches import relay_cycle, switching_forces
from stepwell.design.tolerances.draws import Draws
from stepwell.statics import StaticsError, batch
from stepwell.statics.batch import Followed

SNAP = sw.Element.from_points([0.0, 1e-3, 3e-3, 5e-3], [0.0, 1.0, -1.0, 1.5], "snap")
SOFT = sw.Element.from_points([0.0, 1e-3, 3e-3, 5e-3], [0.0, 1.0, 0.3, 1.5], "soft")
# The first snap needs more force than the second, and the same on the way back: it leaps.
LEAPS = sw.Element.from_points(
    [0.0, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3], [0.0, 1.0, -0.2, 0.6, -0.6, 2.0], "leaps"
)
STEPS = sw.Element.from_law(lambda s: np.sin(2e3 * s) + 50.0 * s, 0.0, 6e-3, "steps")
LEVERS = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)), name="levers")
FORCE, STROKE = 0.0, math.inf


def strong(element: sw.Element, scale: float, name: str, friction: float = 0.0) -> sw.Element:
    return replace(element, force_scale=scale, name=name, friction=friction)


def pair(drive: float) -> sw.Chain:
    return sw.Chain([strong(SNAP, 1.0, "a"), strong(SNAP, 1.3, "b")], drive)


def any_element(rng: np.random.Generator, name: str) -> sw.Element:
    """Snaps of two or three phases, some with stops, friction, or a leap."""
    shape = (SNAP, SOFT, LEAPS, STEPS)[rng.integers(4)]
    ends = (False, True, (True, False))[rng.integers(3)]
    friction = float(rng.choice([0.0, 0.05]))
    stops = ends if shape is not LEAPS else False
    return replace(
        shape, stops=stops, friction=friction, force_scale=rng.uniform(0.5, 2.0), name=name
    )


@pytest.mark.parametrize("seed", range(20))
def test_switching_forces_tell_the_cycle_that_the_engine_finds_under_a_prescribed_force(seed):
    rng = np.random.default_rng(seed)
    chain = sw.Chain([any_element(rng, name) for name in "abc"], FORCE)
    cycle = chain.cycle()
    assert cycle.degenerate or relay_cycle(chain) == cycle.sequence


def pieces(rng: np.random.Generator, name: str) -> sw.Element:
    """Straight lines between points at random, with as many phases as they happen to make."""
    while True:
        count = int(rng.integers(3, 9))
        travel = np.sort(rng.uniform(0.0, 6e-3, count))
        ends = (True, False, (True, False), (False, True))[rng.integers(4)]
        friction = float(rng.choice([0.0, 0.05]))
        force = rng.uniform(-1.5, 2.0, count)
        try:
            return sw.Element.from_points(
                travel.tolist(), force.tolist(), name, stops=ends, friction=friction
            )
        except ValueError:  # an open end on which the force falls
            continue


@pytest.mark.parametrize("seed", range(25))
def test_switching_forces_tell_the_cycle_of_any_curves(seed):
    rng = np.random.default_rng(seed)
    chain = sw.Chain([pieces(rng, name) for name in "abc"[: 1 + seed % 3]], FORCE)
    cycle = chain.cycle()
    assert cycle.degenerate or relay_cycle(chain) == cycle.sequence


@pytest.mark.slow
@pytest.mark.parametrize("drive", [FORCE, STROKE])
def test_an_element_of_one_phase_has_nothing_to_switch(drive):
    rises = sw.Element.from_points([0.0, 1e-3, 2e-3], [0.0, 1.0, 2.5], "rises")
    alone = sw.Chain([rises], drive)
    assert alone.cycle().sequence == "0"
    result = alone.yields(samples=5, sensitivity=True)
    assert result.fraction == 1.0
    assert result.sensitivities is not None
    assert not result.sensitivities.parameters
    assert alone.margin().changes[0].distance == math.inf
    beside = sw.Chain([rises, SNAP], drive)
    assert beside.yields(samples=5).target == beside.cycle().sequence == "00>01>00"


def test_switching_forces_of_lever_cells_and_elements_are_reported_together():
    levers = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0), stiffness=200.0), friction=0.01)
    chain = sw.Chain([levers, LEAPS], FORCE)
    assert relay_cycle(chain) == chain.cycle().sequence
    assert switching_forces(chain)[0] == pytest.approx(
        [levers.force_0 + 0.01, levers.force_1 - 0.01]
    )


def test_switching_forces_decide_nothing_under_a_stroke_and_nothing_where_a_curve_folds_back():
    assert relay_cycle(pair(STROKE)) is None
    s = np.linspace(0.0, 5e-3, 200)
    force = np.interp(s, [0.0, 1e-3, 3e-3, 5e-3], [0.0, 1.0, -1.0, 1.5])
    folded = sw.Element.from_curve((s + force / 400.0).tolist(), force.tolist())
    assert len(folded.sheets) == 2
    assert relay_cycle(sw.Chain([folded, SOFT], FORCE)) is None


def test_an_element_has_scales_and_friction_as_parameters_and_no_anchors():
    chain = sw.Chain([LEVERS, SNAP])
    names = [one.name for one in parameters(chain)]
    assert [name for name in names if name.startswith("snap")] == [
        "snap.force_scale",
        "snap.travel_scale",
        "snap.friction",
    ]
    scale = parameter(chain, "2.force_scale")
    assert scale.value(chain) == 1.0
    assert scale.unit == "1"
    assert scale.changed(chain, 2.0).elements[0].force_scale == 2.0
    with refuses(ValueError, "'snap.q'", "an element", "force_scale, travel_scale"):
        parameter(chain, "snap.q")
    with refuses(ValueError, "levers", "no element", "p, q"):
        parameter(chain, "levers.force_scale")


def test_parameters_of_a_chain_of_volumes_are_in_its_units():
    balloon = replace(SNAP, measure=sw.Measure.VOLUME)
    chain = sw.Chain([balloon, strong(balloon, 2.0, "large")])
    units = {one.part: one.unit for one in parameters(chain)}
    assert units["friction"] == "Pa"
    assert units["actuator_stiffness"] == "Pa/m³"


TOLERANCES = sw.Tolerances(stiffness=0.12, friction=0.02, travel=0.03)


def test_the_forces_of_drawn_elements_are_those_of_the_elements_that_are_built():
    chain = sw.Chain([LEAPS, strong(STEPS, 1.3, "b", 0.05), SNAP], FORCE)
    draws = Draws(chain, TOLERANCES, 3)
    rows = next(draws.chunks(40))
    built = np.array([switching_forces(draws.built(row)) for row in rows])
    np.testing.assert_allclose(draws.switching_forces(rows), built, rtol=1e-12)
    assert draws.sample(7) == draws.built(rows[7])
    assert draws.sample(7).elements[1].travel_scale != 1.0


@pytest.mark.slow
@pytest.mark.parametrize("drive", [FORCE, STROKE, 2000.0])
def test_yields_count_what_the_engine_finds_of_each_mechanism(drive):
    chain = sw.Chain([strong(SNAP, 1.0, "a"), strong(SOFT, 1.1, "b")], drive)
    wanted = "00>10>11>01>00"
    result = chain.yields(TOLERANCES, samples=40, seed=5, target=wanted)
    draws = Draws(chain, TOLERANCES, 5)
    does = Counter(str(draws.sample(k).cycle().sequence) for k in range(40))
    assert result.successes == does.pop(wanted, 0)
    assert dict(result.outcomes) == dict(does)
    assert result.by_engine == (0 if drive == FORCE else 40)


@pytest.mark.slow
def test_relays_of_several_phases_are_judged_as_the_engine_does():
    chain = sw.Chain([LEAPS, strong(STEPS, 0.9, "b")], FORCE)
    result = chain.yields(TOLERANCES, samples=30, seed=1)
    draws = Draws(chain, TOLERANCES, 1)
    does = Counter(str(draws.sample(k).cycle().sequence) for k in range(30))
    assert result.target == chain.cycle().sequence
    assert result.successes == does.pop(result.target, 0)
    assert dict(result.outcomes) == dict(does)


@pytest.mark.slow
def test_yields_of_elements_name_the_critical_switches_and_the_parts_that_count():
    chain = sw.Chain([SNAP, strong(STEPS, 1.05, "steps")], FORCE)
    result = chain.yields(TOLERANCES, samples=2000, sensitivity=True)
    assert result.critical is not None
    assert set(result.critical.names) <= {"snap", "steps 0-1", "steps 1-2"}
    assert result.sensitivities is not None
    most = np.argmax(result.sensitivities.total)
    assert result.sensitivities.parameters[most] in ("snap.force_scale", "steps.force_scale")
    # Travels change nothing there.
    table = dict(zip(result.sensitivities.parameters, result.sensitivities.total, strict=True))
    assert table["snap.travel_scale"] == pytest.approx(0.0, abs=1e-9)
    assert result.end_forces(5).shape == (5, 3, 2)


def test_states_of_elements_can_be_wanted():
    chain = pair(FORCE)
    every = chain.yields(sw.Tolerances(stiffness=0.01), samples=5, target=["00", "10", "01", "11"])
    assert every.successes == 5
    assert (
        chain.yields(sw.Tolerances(stiffness=0.01), samples=5, target=["00", "10", "11"]).fraction
        == 0
    )
    with pytest.raises(ValueError, match="digits up to 11"):
        chain.yields(samples=5, target=["00", "20"])


def test_a_program_survives_where_elements_end_in_their_phases():
    chain = pair(FORCE)
    program = chain.program("01")
    exact = chain.survival(program.turning_points, "01", sw.Tolerances(), samples=2)
    assert exact.fraction == 1.0
    loose = chain.survival(program.turning_points, "01", sw.Tolerances(stiffness=0.2), samples=40)
    assert 0.0 < loose.fraction < 1.0
    says(loose.assumptions, "normal", "all forces", "element")


def just_short(change: Change, by: float) -> sw.Chain:
    """The chain just before a change of a number."""
    assert isinstance(change.move, float)
    made = replace(change, past=change.move * (1.0 - by)).design
    assert made is not None
    return made


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_margins_of_relays_are_exact(friction):
    chain = sw.Chain(
        [strong(SNAP, 1.0, "a"), strong(SOFT, 1.2, "b", friction), strong(STEPS, 1.3, "c")], FORCE
    )
    now = chain.cycle().sequence
    margin = chain.margin()
    assert margin.method == "exact"
    assert [change.parameter for change in margin.changes[:3]] == [
        "force_scale",
        "travel_scale",
        "friction",
    ]
    for change in margin.changes:
        if change.parameter == "travel_scale":
            assert change.distance == math.inf
            continue
        if change.distance == math.inf:
            continue
        assert change.becomes != now
        assert just_short(change, 1e-6).cycle().sequence == now
    assert str(margin)
    assert "force scale" in repr(margin)


@pytest.mark.slow
def test_the_margins_of_elements_under_a_stroke_are_searched_on_both_sides():
    chain = pair(STROKE)
    now = chain.cycle().sequence
    margin = chain.margin()
    assert margin.method == "search"
    finite = [change for change in margin.changes if change.distance < math.inf]
    assert finite
    for change in finite:
        assert change.becomes not in ("", now)
        assert just_short(change, 1e-4).cycle().sequence == now


@pytest.mark.slow
def test_a_mixed_chain_has_margins_of_anchors_and_of_scales():
    strip = sw.Element.from_points([0.0, 5e-3, 15e-3, 20e-3], [0.0, 0.3, -0.3, 0.5], "strip")
    margin = sw.Chain([LEVERS, strip]).margin()
    kinds = [(change.cell, change.parameter) for change in margin.changes]
    assert kinds == [
        (0, "anchor"),
        (0, "stiffness"),
        (1, "force_scale"),
        (1, "travel_scale"),
        (1, "friction"),
    ]
    assert len(margin.anchors) == len(margin.stiffness) == 1


@pytest.mark.slow
@pytest.mark.parametrize("drive", [FORCE, STROKE])
def test_the_nearest_scale_that_reprograms_is_found(drive):
    chain = pair(drive)
    target = "00>01>11>10>00"
    change = chain.reprogram(target, "a.force_scale")
    assert change.after == target
    assert change.place == pytest.approx(1.3, abs=2e-6)
    assert change.displacement == pytest.approx(0.3, abs=2e-6)
    assert (change.method == "exact") == (drive == FORCE)
    assert "a.force_scale" in str(change)
    # A number is no place in the plane.
    assert np.all(np.isnan([change.move, change.anchor_at]))
    # Nothing nearer does it.
    for scale in np.linspace(0.72, 1.28, 15):
        made = parameter(chain, "a.force_scale").changed(chain, float(scale))
        assert made.cycle().sequence != target


def test_an_element_is_reprogrammed_by_friction_or_reported_as_impossible():
    chain = pair(FORCE)
    change = chain.reprogram("00>01>11>10>00", "a.friction")
    assert change.place == pytest.approx(0.3)
    nowhere = chain.reprogram("00>01>11>10>00", "a.travel_scale")
    assert nowhere.distance == math.inf
    says(str(nowhere), "no value", "a.travel_scale", "00>01>11>10>00")
    with refuses(ValueError, "'a.force_scale'", "number", "`along`"):
        chain.reprogram(None, "a.force_scale", along=(1.0, 0.0))


@pytest.mark.parametrize("seed", range(6))
def test_all_forces_may_deviate_by_the_reported_fraction_and_no_more(seed):
    rng = np.random.default_rng(seed)
    chain = sw.Chain([any_element(rng, name) for name in "abc"], FORCE)
    result = chain.robustness()
    now = relay_cycle(chain)

    def cycles(share: float) -> set[str | None]:
        corners = itertools.product((1.0 - share, 1.0 + share), repeat=3)
        return {
            relay_cycle(
                replace(
                    chain,
                    cells=[
                        replace(cell, force_scale=cell.force_scale * by)
                        for cell, by in zip(chain.elements, corner, strict=True)
                    ],
                )
            )
            for corner in corners
        }

    assert 0.0 < result.fraction < 1.0
    assert cycles(result.fraction * (1.0 - 1e-6)) == {now}
    assert cycles(min(result.fraction * (1.0 + 1e-6), 0.999)) != {now}
    says(str(result), "all forces", f"{result.fraction * 100:.4g} %")


def test_a_map_over_scales_tells_what_each_chain_does():
    chain = pair(STROKE)
    scales = np.array([0.8, 1.0, 1.25])
    data = sw.parameter_map(chain, ("a.force_scale", scales), ("b.travel_scale", scales + 0.05))
    words = data.sequence.attrs["flag_meanings"].split()
    for j, i in itertools.product(range(3), repeat=2):
        a = parameter(chain, "a.force_scale").changed(chain, float(scales[i]))
        made = parameter(a, "b.travel_scale").changed(a, float(scales[j] + 0.05))
        assert words[int(data.sequence[j, i])] == made.cycle().sequence
    assert np.all(np.isnan(data.margin))


@pytest.mark.slow
def test_boundaries_over_scales_are_where_forces_meet():
    chain = pair(FORCE)
    axes = ("a.force_scale", [0.8, 2.0]), ("b.force_scale", [0.8, 2.0])
    boundaries_ = parameter_boundaries(chain, *axes, search=7)
    curves = [one for one in boundaries_ if one.kind.name != "BISTABLE"]
    assert curves
    for one in curves:
        assert np.allclose(one.points[:, 0], one.points[:, 1], atol=1e-6)


def test_a_map_over_an_anchor_works_beside_an_element_and_is_refused_of_one():
    strip = sw.Element.from_points([0.0, 5e-3, 15e-3, 20e-3], [0.0, 0.3, -0.3, 0.5], "strip")
    chain = sw.Chain([LEVERS, strip])
    data = sw.transition_map(chain, 0, x=[0.008, 0.012], y=[0.0, 0.005])
    words = data.sequence.attrs["flag_meanings"].split()
    for j, i in itertools.product(range(2), repeat=2):
        place = float(data.x[i]), float(data.y[j])
        made = sw.Chain([LEVERS.with_anchors(q=place), strip])
        assert words[int(data.sequence[j, i])] == made.cycle().sequence
    with refuses(ValueError, "'strip'", "without anchors", "parameter_map", "'strip.force_scale'"):
        sw.transition_map(chain, "strip", x=[0.0, 0.01], y=[0.0, 0.01])


def random_scales(rng: np.random.Generator, kinds: list[sw.Element], cells: int) -> sw.Chain:
    made = [
        strong(kinds[rng.integers(len(kinds))], float(np.exp(rng.uniform(-0.69, 0.69))), name)
        for name in "abcdef"[:cells]
    ]
    return sw.Chain(made, FORCE)


CYCLES = [
    "00>10>11>01>00",
    "00>10>11>10>00",
    "000>100>110>111>011>001>000",
    "000>010>110>111>011>010>000",
]


@pytest.mark.slow
@pytest.mark.parametrize("kinds", [[SNAP], [SOFT], [SNAP, SOFT]])
@pytest.mark.parametrize("cycle", CYCLES)
def test_elements_are_scaled_for_a_cycle_as_surely_as_can_be_or_it_is_proved_impossible(
    cycle, kinds
):
    rng = np.random.default_rng(7)
    tried = [random_scales(rng, kinds, cycle.index(">")) for _ in range(300)]
    doing = [chain for chain in tried if relay_cycle(chain) == cycle]
    if not doing:
        with pytest.raises(Impossible) as why:
            sw.design(cycle, elements=kinds, actuator_stiffness=FORCE, samples=20)
        assert why.value.proved
        return
    designed = sw.design(cycle, elements=kinds, actuator_stiffness=FORCE, samples=20)
    assert designed.proved
    assert designed.chain.cycle().sequence == designed.sequence == cycle
    assert designed.robustness is not None
    surest = max((chain.robustness().fraction for chain in doing), default=0.0)
    assert designed.robustness.fraction >= surest - 1e-6
    for cell in designed.chain.elements:
        assert 0.5 - 1e-9 <= cell.force_scale <= 2.0 + 1e-9
    assert "force scale" in str(designed)


@pytest.mark.slow
def test_elements_are_designed_for_states_in_reach():
    designed = sw.design(
        states=["00", "10", "11"], elements=[SNAP, SOFT], actuator_stiffness=FORCE, samples=10
    )
    assert set(designed.reached.states) == {"00", "10", "11"}
    assert designed.yield_.states == ("00", "10", "11")
    with pytest.raises(Impossible) as why:
        sw.design(states=["00", "10", "11"], elements=[SNAP], actuator_stiffness=FORCE)
    assert why.value.proved


def test_elements_of_several_phases_are_designed_phase_by_phase():
    cycle = "00>10>11>12>11>10>00"
    designed = sw.design(cycle, elements=[SNAP, STEPS], actuator_stiffness=FORCE, samples=10)
    assert designed.chain.cycle().sequence == cycle
    assert designed.chain.names == ("snap", "steps")
    with refuses(ValueError, "00>10>11>12>11>10>00", "cell 2", "3 phases", "2"):
        sw.design(cycle, elements=[SNAP], actuator_stiffness=FORCE)


def test_elements_under_a_stroke_do_what_is_wanted_by_the_engine_and_nothing_is_called_proved():
    designed = sw.design("00>10>11>01>00", elements=[SNAP], samples=10)
    assert designed.chain.cycle().sequence == "00>10>11>01>00"
    assert not designed.proved
    assert designed.yield_.by_engine == 10


def test_what_makes_no_sense_for_elements_is_refused():
    with refuses(ValueError, "no anchors", "`within`", "`holes`"):
        sw.design("00>10>11>01>00", elements=[SNAP], holes=0.005)
    with refuses(ValueError, "force_scale = (2.0, 1.0)", "(least, largest)"):
        sw.design("00>10>11>01>00", elements=[SNAP], force_scale=(2.0, 1.0))
    with refuses(ValueError, "sequence", "states", "design(", "order="):
        sw.design(elements=[SNAP])
    with pytest.raises(ValueError, match="its next phase"):
        sw.design("00>11>01>00", elements=[SNAP])


def test_designs_that_cannot_be_followed_are_counted_and_not_raised(monkeypatch):
    def fails(chain, **_):
        raise StaticsError("no answer")

    def leaves_all(designs, *_):
        m = len(designs.cells)
        return Followed(np.full((m, 1), -1), np.full((m, batch.FOUND), np.nan))

    monkeypatch.setattr("stepwell.statics.full_cycles", leaves_all)
    monkeypatch.setattr("stepwell.sequences.cycles.cycle", fails)
    result = pair(STROKE).yields(samples=3, target="00>10>11>01>00")
    assert result.outcomes == {"no answer": 3}
