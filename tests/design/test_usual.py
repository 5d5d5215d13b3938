"""One default for tolerances and samples, and slips of unit where numbers meet a chain."""

import math

import numpy as np
import pytest

import stepwell as sw
from facts import refuses
from stepwell.design import (
    DEFAULT_TOLERANCES,
    AnchorBox,
    BandType,
    design,
    parameter_map,
    reprogram,
    survival,
    transition_map,
    yields,
)
from stepwell.design.synthesis.region import PAPER_LEVER
from stepwell.files import dumps, loads
from stepwell.mechanism import SlipError

LEG = sw.preset("paper-forward")
ODD = sw.Chain([sw.Cell(cell.band, unusual=True) for cell in LEG.cells])


def test_a_yield_without_tolerances_takes_the_usual_ones_everywhere():
    results = [
        LEG.yields(samples=300),
        yields(LEG, samples=300),
        yields(LEG, DEFAULT_TOLERANCES, samples=300),
    ]
    assert {one.tolerances for one in results} == {sw.Tolerances(anchor=0.0003, stiffness=0.05)}
    assert len({one.fraction for one in results}) == 1
    assert survival(LEG, (0.0, 0.04), "11", samples=3).tolerances == DEFAULT_TOLERANCES
    assert (
        design("00>10>11>01>00", samples=10).yield_.tolerances.anchor == DEFAULT_TOLERANCES.anchor
    )


def test_what_a_tolerance_does_not_name_is_exact():
    assert sw.Tolerances() == sw.Tolerances(0.0, 0.0, 0.0, 0.0, 0.0)
    assert LEG.yields(sw.Tolerances(), samples=10).fraction == 1.0


@pytest.mark.slow
def test_few_are_made_where_the_engine_follows_each():
    two_bands = sw.Chain([sw.Cell([b, b]) for b in (c.bands[0] for c in LEG.cells)])
    states = ["00", "10", "01", "11"]
    assert LEG.yields().samples == 100_000
    assert survival(LEG, (0.0, 0.04), "11").samples == LEG.yields(target=states).samples == 500
    assert two_bands.yields(sw.Tolerances(), samples=3).by_engine == 3


def test_a_yield_without_friction_says_so():
    f = min(abs(force) for cell in LEG.cells for force in (cell.force_0, cell.force_1))
    note = f"no friction (smallest critical force {f * 1e3:.3g} mN"
    assert note in LEG.yields(samples=10).assumptions
    assert note in survival(LEG, (0.0, 0.04), "11", samples=1).assumptions
    rubbing = sw.Tolerances(friction=0.01)
    assert "no friction" not in LEG.yields(rubbing, samples=10).assumptions
    assert "no friction" not in survival(LEG, (0.0, 0.04), "11", rubbing, samples=1).assumptions


def across(chain: sw.Chain) -> object:
    return transition_map(chain, x=np.linspace(0, 20, 3), y=np.linspace(0, 0.015, 3))


@pytest.mark.parametrize(
    ("ask", "name", "meant"),
    [
        (lambda c: c.yields(sw.Tolerances(anchor=0.3), samples=1), "anchor", 0.0003),
        (lambda c: c.yields(sw.Tolerances(friction=30), samples=1), "friction", 0.03),
        (
            lambda c: survival(c, (0, 0.04), "11", sw.Tolerances(anchor=0.3), samples=1),
            "anchor",
            0.0003,
        ),
        (lambda c: c.margin(reach=20), "reach", 0.020),
        (lambda c: reprogram(c, None, "inner.p", reach=20), "reach", 0.020),
        (across, "outer.q.x", 0.020),
        (
            lambda c: parameter_map(c, ("inner.q.x", [0, 20]), ("outer.q.y", [0, 0.01])),
            "inner.q.x",
            0.020,
        ),
        (
            lambda c: parameter_map(c, ("inner.friction", [0, 30]), ("outer.q.y", [0, 0.01])),
            "inner.friction",
            0.030,
        ),
    ],
)
def test_a_number_far_off_the_chain_is_refused_and_a_chain_that_is_unusual_takes_it(
    ask, name, meant
):
    with pytest.raises(SlipError) as refused:
        ask(LEG)
    (slip,) = refused.value.slips
    assert slip.name == name
    assert slip.meant == pytest.approx(meant)
    ask(ODD)


def test_a_program_in_millimetres_does_not_pass_for_one_that_none_survives():
    with refuses(SlipError, "turning_points[1] = 40 m", "0.04 m?"):
        survival(LEG, (0.0, 40.0, 0.0), "00", samples=1)


@pytest.mark.parametrize(
    ("arguments", "name", "meant"),
    [
        ({"lever": 14.142}, "lever", 0.014142),
        ({"p": (-10, 0)}, "p", (-0.010, 0.0)),
        ({"within": AnchorBox(0, 20, -0.015, 0.015)}, "within, x", 0.020),
        ({"within": AnchorBox(0, 2e-5, -1e-5, 1e-5)}, "within", (0.020, 0.010)),
        ({"holes": 5.0}, "holes", 0.005),
        ({"holes": 0.005, "origin": (-10.0, 0.0)}, "origin", (-0.010, 0.0)),
        ({"bands": [BandType(28.5, 10.0)]}, "rest_length", 0.010),
        ({"bands": [BandType(0.0285, 0.010)]}, "stiffness", 28.5),
        ({"tolerances": sw.Tolerances(anchor=0.3)}, "anchor", 0.0003),
    ],
)
def test_a_wish_in_another_unit_is_refused_with_what_was_meant(arguments, name, meant):
    with pytest.raises(SlipError) as refused:
        design("00>10>11>01>00", samples=1, **arguments)
    (slip,) = refused.value.slips
    assert slip.name == name
    assert slip.meant == pytest.approx(meant)


def test_a_wish_that_is_unusual_is_followed_and_its_cells_say_so():
    far = AnchorBox(0.8, 0.82, -0.015, 0.015)
    with pytest.raises(SlipError):
        design("00>10>11>01>00", within=far, samples=1)
    made = design("00>10>11>01>00", within=far, samples=1, unusual=True)
    assert made.chain.unusual
    assert not design("00>10>11>01>00", samples=1).chain.unusual


def test_a_search_is_never_asked_wherever_it_goes():
    # A box round the place where q is zero: anchors nobody would type.
    near = AnchorBox(-1e-5, 0.015, -1e-5, 0.015)
    made = design("00>10>11>01>00", within=near, samples=20)
    assert math.isfinite(made.yield_.fraction)
    LEG.yields(sw.Tolerances(anchor=0.004, stiffness=0.2), samples=200, sensitivity=True)


@pytest.mark.parametrize("scale", [0.03, 30.0])
def test_a_mechanism_of_any_ordinary_size_is_asked_all_questions_without_a_word(scale):
    bands = [
        sw.Band((-0.010 * scale, 0.0), (q * scale, 0.0), rest_length=0.010 * scale)
        for q in (0.010, 0.020)
    ]
    chain = sw.Chain([sw.Cell(band, lever=PAPER_LEVER * scale) for band in bands])
    axis = np.linspace(-0.02, 0.02, 3) * scale
    loose = sw.Tolerances(anchor=0.003 * scale, stiffness=0.2, friction=0.01)
    result = chain.yields(loose, samples=50)
    transition_map(chain, x=axis, y=axis)
    parameter_map(chain, ("1.stiffness", [0.1, 1e4]), ("2.rest_length", [0.0, 0.02 * scale]))
    assert chain.margin().reach == reprogram(chain, None, "1.p").reach == 0.020
    assert str(chain.cycle().sequence) == "00>10>11>01>00"
    for number in range(10):
        made = result.mechanism(number)
        assert loads(dumps(made)).subject == made
