"""Slips of unit in Python: what is refused, with what was meant, and what never is."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

import stepwell as sw
from chains import any_chain
from facts import refuses
from stepwell.mechanism import SlipError, slips

P, Q = (-0.010, 0.0), (0.010, 0.0)
PAPER = sw.Cell(sw.Band(P, Q))
LEG = sw.Chain([PAPER, PAPER.with_anchors(q=(0.020, 0.0))])


@pytest.mark.parametrize(
    ("slipped", "name", "meant"),
    [
        (lambda: sw.Cell(sw.Band((-10, 0), Q)), "p", (-0.010, 0.0)),
        (lambda: sw.Cell(sw.Band(P, (0, -15))), "q", (0.0, -0.015)),
        (lambda: sw.Cell(sw.Band((-1e-5, 0), (1e-5, 0))), "p", (-0.010, 0.0)),
        (lambda: sw.Cell(sw.Band((0, 0), (1e-5, 0))), "q", (0.010, 0.0)),
        (lambda: sw.Cell(sw.Band(P, Q), lever=14.142), "lever", 0.014142),
        (lambda: sw.Cell(sw.Band(P, Q), lever=1.4142e-5), "lever", 0.014142),
        (lambda: sw.Cell(sw.Band(P, Q, rest_length=10)), "rest_length", 0.010),
        (lambda: sw.Cell(sw.Band(P, Q, rest_length=1e-5)), "rest_length", 0.010),
        (lambda: sw.Cell(sw.Band(P, Q, stiffness=0.0285)), "stiffness", 28.5),
        (lambda: sw.Cell(sw.Band(P, Q, stiffness=28.5e3)), "stiffness", 28.5),
        (lambda: sw.Cell(sw.Band(P, Q, stiffness=5e-324)), "stiffness", None),
        (lambda: sw.Cell(sw.Band(P, Q), limit=math.radians(0.785)), "limit", 0.785),
        (lambda: sw.Cell(sw.Band(P, Q), friction=50.0), "friction", 0.050),
        (lambda: sw.Cell(sw.Band(P, Q), load=sw.Load.constant(65.0)), "load.force", 0.065),
        (lambda: sw.Cell(sw.Band(P, Q), load=sw.Load((0, 20), (0, 0.1))), "load.travel", 0.020),
        (lambda: sw.Cell(sw.Band(P, Q, law=sw.Cubic(-3e4, 0))), "a2", -30.0),
        (lambda: sw.Cell(sw.Band(P, Q, law=sw.Cubic(0, 1e9))), "a3", 1000.0),
        (
            lambda: sw.Cell(sw.Band.from_table(P, Q, 0.01, (0, 0.01, 0.03), (0, 300, 800))),
            "tension",
            0.8,
        ),
        (
            lambda: sw.Cell(sw.Band.from_table(P, Q, 0.01, (0, 10, 30), (0, 0.3, 0.8))),
            "extension",
            0.030,
        ),
        (lambda: PAPER.with_anchors(q=(20, 0)), "q", (0.020, 0.0)),
        (lambda: PAPER.with_anchors(p=(0, -10)), "p", (0.0, -0.010)),
        (lambda: LEG.path([0, 40.0, 0]), "turning_points[1]", 0.040),
        (lambda: replace(LEG, actuator_stiffness=0.0).path([-100, 700]), "turning_points[1]", 0.7),
        (lambda: replace(LEG, actuator_stiffness=1e3).path([0, 45.0]), "turning_points[1]", 0.045),
    ],
)
def test_a_size_far_off_the_mechanism_is_refused_with_what_was_meant(slipped, name, meant):
    with pytest.raises(SlipError) as refused:
        slipped()
    (slip,) = (one for one in refused.value.slips if one.name == name)
    assert slip.meant == (None if meant is None else pytest.approx(meant))
    assert "Did you mean" in str(refused.value) or meant is None


@pytest.mark.parametrize(
    "ordinary",
    [
        lambda: sw.Cell(sw.Band(P, (-1.45e-5, 1.3e-5))),
        lambda: sw.Cell(sw.Band((1e-12, -3e-9), Q)),
        lambda: replace(PAPER, load=sw.Load((0.99e-6,), (0.1,))),
        lambda: sw.Cell(sw.Band(P, Q), load=sw.Load((0.99e-6,), (0.1,))),
        lambda: sw.Cell(sw.Band(P, Q), load=sw.Load((0.0, 0.99e-6, 0.01), (0.1, 0.2, 0.1))),
    ],
)
def test_a_small_part_of_an_ordinary_geometry_is_no_slip(ordinary):
    assert not slips(ordinary())


def _band(p, q, scale):
    return sw.Band((p[0] * scale, p[1] * scale), (q[0] * scale, q[1] * scale))


_MM = st.floats(0.5, 20.0) | st.floats(-20.0, -0.5)


@given(p=st.tuples(_MM, _MM), q=st.tuples(_MM, _MM), scale=st.sampled_from([1e3, 1e-3]))
def test_anchors_in_another_unit_are_refused_for_every_geometry(p, q, scale):
    """A d below 1 mm is that of no band: the anchors then coincide."""
    ordinary = _band(p, q, 1e-3)
    assume(math.hypot(*ordinary.d) > 1e-3)
    assert not slips(sw.Cell(ordinary))
    with pytest.raises(SlipError):
        sw.Cell(_band(p, q, 1e-3 * scale))


@given(st.lists(st.tuples(st.floats(1.0, 40.0), st.floats(-1.0, 1.0)), min_size=2, max_size=9))
def test_a_load_in_another_unit_is_refused_for_every_table(points):
    table = dict(points)
    assume(len(table) > 1)
    travel = np.array(sorted(table))
    assume(np.all(np.diff(travel) > 1e-6))
    force = tuple(table[x] for x in travel)
    sw.Cell(sw.Band(P, Q), load=sw.Load(tuple(1e-3 * travel), force))
    for scale in (1.0, 1e-6):
        with pytest.raises(SlipError):
            sw.Cell(sw.Band(P, Q), load=sw.Load(tuple(scale * travel), force))


def test_a_mechanism_all_in_millimetres_is_reported_every_slip_once():
    with pytest.raises(SlipError) as refused:
        sw.Cell(sw.Band((-10, 0), (10, 0), rest_length=10), lever=14.1)
    meant = {slip.name: slip.meant for slip in refused.value.slips}
    assert meant == {
        "lever": pytest.approx(0.0141),
        "p": (-0.010, 0.0),
        "q": (0.010, 0.0),
        "rest_length": 0.010,
    }


def test_degrees_for_radians_are_distinguished_from_a_limit_that_no_cell_has():
    with refuses(ValueError, "limit = 45", "0.785398 rad (45°)?"):
        sw.Cell(sw.Band(P, Q), limit=45)
    with pytest.raises(ValueError, match=r"unbounded\.$"):
        sw.Cell(sw.Band(P, Q), limit=1.6)


def test_a_band_that_pushes_in_a_table_is_refused():
    with refuses(ValueError, "tension[1] = -0.3 N", "0.3 N?"):
        sw.Band.from_table(P, Q, 0.01, (0, 0.01, 0.03), (0, -0.3, 0.8))
    with refuses(ValueError, "shape[1] = -0.01 m", "0.01 m?"):
        sw.Table((0, 0.01, 0.03), (0, -0.01, 0.02))


@pytest.mark.parametrize(
    "make",
    [
        lambda: sw.Cell(sw.Band((-10, 0), (10, 0)), unusual=True),
        lambda: sw.Cell(sw.Band(P, Q), limit=math.radians(0.01), unusual=True),
        lambda: sw.Cell(sw.Band(P, Q), lever=14.0, unusual=True),
        lambda: replace(PAPER, unusual=True).with_anchors(q=(20, 0)),
    ],
)
def test_the_odd_true_case_has_a_way_through(make):
    cell = make()
    assert cell.unusual
    assert slips(cell)
    assert sw.Chain([cell]).unusual
    assert not sw.Chain([PAPER]).unusual


def test_that_a_size_is_meant_is_no_part_of_the_mechanism():
    said = sw.Cell(sw.Band(P, Q), unusual=True)
    assert said == PAPER
    assert hash(said) == hash(PAPER)


# Searches, samples, sensitivities and limits change cells by `replace`, and go where they must.
@pytest.mark.parametrize(
    "derived",
    [
        lambda c: replace(c, band=replace(c.band, q=(1e-9, 0.0))),
        lambda c: replace(c, band=replace(c.band, q=(10.0, 0.0))),
        lambda c: replace(c, band=replace(c.band, stiffness=1e-9)),
        lambda c: replace(c, limit=math.radians(0.01)),
        lambda c: replace(c, friction=1e3),
        lambda c: c.with_anchors(q=(1e-19, 1e-7)),
        lambda c: replace(c, band=replace(c.band, q=(10.0, 0.0))).with_anchors(q=(10.1, 0.0)),
    ],
)
def test_what_the_program_makes_of_a_cell_is_never_asked(derived):
    assert not derived(PAPER).unusual


def test_a_mechanism_of_any_ordinary_size_is_usual():
    rng = np.random.default_rng(5)
    for size in (2e-4, 0.014, 1.0):
        for _ in range(50):
            d = rng.uniform(0.05, 3.0, 4) * size
            sw.Cell(sw.Band((-d[0], d[1]), (d[2], -d[3]), rest_length=size / 3), lever=size)


def test_a_limit_of_stiffness_and_a_soft_spring_are_followed_unasked():
    soft = replace(LEG, actuator_stiffness=1e-3)
    assert str(soft.cycle().sequence) == str(replace(LEG, actuator_stiffness=0.0).cycle().sequence)
    soft.path([0.0, 2 * soft.levers[1].force_0 / 1e-3])


def test_any_chain_of_the_tests_is_followed_without_a_word():
    rng = np.random.default_rng(1)
    for _ in range(5):
        chain = any_chain(rng, 2)
        chain.path([0.0, chain.full_stroke])


FAR, LARGE = (0, 1, 2, 3), (0, 1, -1, 2)


@pytest.mark.parametrize(
    "make", [sw.Element.from_points, sw.Element.from_table, sw.Element.from_curve]
)
def test_a_curve_in_millimetres_or_millinewtons_is_refused_unless_it_is_meant(make):
    with pytest.raises(SlipError) as refused:
        make(FAR, LARGE)
    (slip,) = refused.value.slips
    assert (slip.name, slip.value, slip.meant) == ("travel", 3.0, pytest.approx(0.003))
    assert "unusual=True" in str(refused.value)
    assert isinstance(slip.value, float) and isinstance(slip.meant, float)
    made = make([x * slip.meant / slip.value for x in FAR], LARGE)
    assert made.full_travel == pytest.approx(0.003)
    assert make(FAR, LARGE, unusual=True).full_travel == 3.0
    strong = [20e3 * force for force in LARGE]
    with pytest.raises(SlipError) as refused:
        make([1e-3 * x for x in FAR], strong)
    (slip,) = refused.value.slips
    assert (slip.name, slip.unit) == ("force", "N")
    assert isinstance(slip.value, float) and slip.meant == pytest.approx(slip.value / 1000)
    assert make([1e-3 * x for x in FAR], strong, unusual=True).largest_force >= 40e3


def test_other_measures_and_the_library_have_no_slips_of_a_curve():
    turning = sw.Element.from_points(FAR, LARGE, measure=sw.Measure.ANGLE)
    assert turning.full_travel == 3.0
    assert sw.Element.from_points([0, 0.5, 0.8, 1], LARGE).full_travel == 1.0
    assert replace(sw.Element.from_points([0, 0.1, 0.2, 0.3], LARGE), travel_scale=100).high == 30
