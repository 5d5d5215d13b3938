"""A parameter has a name, a value and a unit, and changing it changes nothing else."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

import stepwell as sw
from chains import any_chain
from facts import refuses, says
from stepwell.design import Tolerances
from stepwell.design.parameters import Parameter, parameter, parameters
from stepwell.design.tolerances.draws import Draws


def cell(x: float, y: float, **parts) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3)), **parts)


PAIR = sw.Chain((cell(10, 0), cell(20, 0)))

# Values that every parameter can have, by its unit.
VALUES = {
    "m": st.floats(0.001, 0.030),
    "N/m": st.floats(1.0, 100.0),
    "rad": st.floats(0.3, 1.2),
    "N": st.floats(0.0, 0.2),
}


@st.composite
def changed(draw) -> tuple[sw.Chain, Parameter, float | tuple[float, float]]:
    """A chain of any kind, one of its parameters and another value for it."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    chain = any_chain(rng, draw(st.integers(1, 4)))
    one = draw(st.sampled_from(parameters(chain)))
    numbers = VALUES[one.unit]
    value = draw(st.tuples(numbers, numbers)) if one.is_anchor else draw(numbers)
    return chain, one, value


@pytest.mark.slow
@given(changed())
def test_what_is_changed_to_a_value_has_that_value_and_changes_back(case):
    chain, one, value = case
    try:
        design = one.changed(chain, value)
    except ValueError:
        # The ends of a band would meet, or there is no rest length to scale.
        assume(False)
        raise
    assert one.value(design) == value
    assert one.changed(chain, one.value(chain)) == chain
    back = one.changed(design, one.value(chain))
    assert one.value(back) == one.value(chain)


@given(changed())
def test_changing_one_parameter_leaves_all_others(case):
    chain, one, value = case
    try:
        design = one.changed(chain, value)
    except ValueError:
        assume(False)
        raise
    for other in parameters(chain):
        same_anchor = other.cell == one.cell and other.part[0] == one.part[0] in "pq"
        overlaps = same_anchor and (other.is_anchor or one.is_anchor or other.part == one.part)
        if other != one and not overlaps:
            assert other.value(design) == other.value(chain)


@given(changed())
def test_every_parameter_is_found_by_its_name_and_by_its_number(case):
    chain, one, _ = case
    assert parameter(chain, one.name) == one
    if one.cell is not None:
        assert parameter(chain, f"{one.cell + 1}.{one.part}") == one


def test_the_values_and_units_of_the_papers_pair():
    shown = {one.name: (one.value(PAIR), one.unit) for one in parameters(PAIR)}
    assert shown["outer.q"] == ((0.020, 0.0), "m")
    assert shown["outer.q.x"] == (0.020, "m")
    assert shown["inner.p.x"] == (-0.010, "m")
    assert shown["inner.stiffness"] == (28.5, "N/m")
    assert shown["inner.rest_length"] == (0.010, "m")
    assert shown["inner.lever"] == (pytest.approx(0.01414, abs=1e-5), "m")
    assert shown["inner.limit"] == (math.pi / 4, "rad")
    assert shown["inner.friction"] == (0.0, "N")
    assert shown["actuator_stiffness"] == (math.inf, "N/m")
    assert len(shown) == 2 * 11 + 1


def test_several_bands_are_shifted_alike_and_scaled_alike():
    bands = (
        sw.Band((0.0, 0.0), (0.010, 0.0), stiffness=20.0, rest_length=0.004),
        sw.Band((0.001, 0.0), (0.012, 0.003), stiffness=30.0, rest_length=0.006),
    )
    chain = sw.Chain((sw.Cell(bands),))
    moved = parameter(chain, "1.q").changed(chain, (0.011, -0.002)).levers[0].bands
    np.testing.assert_allclose([band.q for band in moved], [(0.011, -0.002), (0.013, 0.001)])
    assert [band.p for band in moved] == [band.p for band in bands]
    stiff = parameter(chain, "1.stiffness").changed(chain, 10.0).levers[0].bands
    assert [band.stiffness for band in stiff] == [10.0, 15.0]
    long = parameter(chain, "1.rest_length").changed(chain, 0.002).levers[0].bands
    assert [band.rest_length for band in long] == pytest.approx([0.002, 0.003])


def test_a_first_band_without_rest_length_cannot_scale_the_others():
    bands = (
        sw.Band((0.0, 0.0), (0.010, 0.0), rest_length=0.0),
        sw.Band((0.0, 0.0), (0.012, 0.003)),
    )
    chain = sw.Chain((sw.Cell(bands),))
    with refuses(ValueError, "1.rest_length = 0.002", "first band"):
        parameter(chain, "1.rest_length").changed(chain, 0.002)


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("iner.p", "inner.p"),
        ("outer.qx", "outer.q.x"),
        ("outer.stifness", "outer.stiffness"),
        ("actuator", "actuator_stiffness"),
        ("1.restlength", "1.rest_length"),
        ("outer.restlength", "outer.rest_length"),
    ],
)
def test_an_unknown_name_is_answered_with_the_nearest_one(name, meant):
    with pytest.raises(ValueError, match=f"{name!r}.* {meant!r}\\?") as refused:
        parameter(PAIR, name)
    says(str(refused.value), "'inner' or 1", "'outer' or 2")


@pytest.mark.parametrize("name", ["", "0.p", "3.p", "zzz", "inner", "-1.q"])
def test_what_is_near_nothing_is_refused_with_all_that_is_allowed(name):
    with refuses(ValueError, f"parameter {name!r}", "'actuator_stiffness'", "'<cell>.<what>'"):
        parameter(PAIR, name)


def test_names_with_dots_and_numbers_mean_the_cell_of_that_name_first():
    chain = sw.Chain((cell(10, 0, name="1"), cell(15, 0, name="leg.2"), cell(20, 0)))
    assert parameter(chain, "1.q").cell == 0
    assert parameter(chain, "leg.2.q.x").cell == 1
    assert parameter(chain, "cell 3.stiffness").cell == 2
    assert parameter(chain, "3.stiffness").name == "cell 3.stiffness"


def test_two_cells_of_one_name_are_distinguished_by_number():
    chain = sw.Chain((cell(10, 0, name="leg"), cell(15, 0, name="leg")))
    with refuses(ValueError, "'leg.p'", "2 cells", "'leg'", "'1.p'"):
        parameter(chain, "leg.p")
    assert [one.name for one in parameters(chain)][:2] == ["1.p", "1.q"]
    assert parameter(chain, "1.p").name == "1.p"


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("inner.stiffness", 0.0, "must be > 0"),
        ("inner.stiffness", "stiff", r"must be a number \[N/m\]"),
        ("inner.friction", math.nan, r"must be a number \[N\]"),
        ("inner.limit", 1.6, "0.01° to 89.9°"),
        ("inner.q", 0.010, r"must be a point \(x, y\)"),
        ("inner.q.x", math.inf, "must be finite"),
        ("actuator_stiffness", -1.0, "must be from 1e-6"),
    ],
)
def test_a_value_that_cannot_be_is_refused(name, value, words):
    with pytest.raises(ValueError, match=words):
        parameter(PAIR, name).changed(PAIR, value)


def test_the_actuators_stiffness_may_be_infinite():
    soft = parameter(PAIR, "actuator_stiffness").changed(PAIR, 30.0)
    assert soft.actuator_stiffness == 30.0
    assert parameter(soft, "actuator_stiffness").changed(soft, math.inf) == PAIR


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("inner.stiffness", [20.0], "2 or more finite numbers"),
        ("inner.stiffness", [[1.0, 2.0]], r"shape \(1, 2\)"),
        ("inner.stiffness", [20.0, math.inf], r"\[N/m\]"),
        ("inner.stiffness", [20.0, 20.0], "must rise"),
        ("inner.q", [0.0, 0.010], "use inner.q.x or inner.q.y"),
    ],
)
def test_values_of_an_axis_rise_and_are_finite(name, values, words):
    with pytest.raises(ValueError, match=words):
        parameter(PAIR, name).values(values, 2)


def test_a_title_and_the_other_cells_are_kept():
    chain = replace(PAIR, title="leg")
    design = parameter(chain, "outer.friction").changed(chain, 0.1)
    assert design.title == "leg"
    assert design.cells[0] is chain.cells[0]


MIXED = sw.Chain(
    [
        cell(10, 0, mobility=3.0),
        sw.Element.from_points([0, 0.004, 0.012, 0.02], [0, 0.6, -0.4, 1.5], "clip", mobility=0.2),
        cell(20, 0),
    ]
)


def mobilities(chain: sw.Chain) -> list[float]:
    return [cell.mobility for cell in chain.cells]


def test_cells_keep_their_mobilities_whatever_number_is_changed():
    for one in parameters(MIXED):
        value = one.value(MIXED)
        other = (0.003, 0.004) if isinstance(value, tuple) else min(1.01 * value + 1e-3, 1e6)
        assert mobilities(one.changed(MIXED, other)) == mobilities(MIXED), one.name


def test_mechanisms_made_at_random_keep_their_mobilities():
    tolerances = Tolerances(anchor=2e-4, stiffness=0.05, lever=1e-4, friction=0.01)
    made = [Draws(MIXED, tolerances, 1).sample(k) for k in range(5)]
    assert all(mobilities(one) == mobilities(MIXED) and one != MIXED for one in made)
