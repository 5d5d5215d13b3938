"""Writing design files: what is written reads back as it was, to the last bit."""

import math
from dataclasses import astuple, replace
from decimal import Decimal

import pytest
from hypothesis import assume, given, strategies as st

from stepwell.files import DesignError, DesignFile, dumps, load, loads, save
from stepwell.files.text import exact_si, shortest, toml
from stepwell.mechanism import MOBILITIES, Band, Cell, Chain, Cubic, Linear, Load, Table


def within(least: float, most: float) -> st.SearchStrategy[float]:
    return st.floats(least, most)


def signed(least: float, most: float) -> st.SearchStrategy[float]:
    return st.just(0.0) | within(least, most) | within(-most, -least)


points = st.tuples(signed(1e-9, 0.5), signed(1e-9, 0.5))


@st.composite
def rows(draw, least: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    steps = draw(st.lists(within(1e-4, 0.02), min_size=least, max_size=5))
    x = tuple(math.fsum(steps[: i + 1]) for i in range(len(steps)))
    y = draw(st.lists(within(1e-3, 3.0), min_size=len(x), max_size=len(x)))
    return x, tuple(y)


@st.composite
def bands(draw) -> Band:
    kind = draw(st.sampled_from(["linear", "cubic", "newtons", "shape"]))
    p, q, rest = draw(points), draw(points), draw(within(0, 0.1))
    two_sided = draw(st.booleans())
    if kind == "newtons":
        extension, tension = draw(rows(1))
        band = Band.from_table(p, q, rest, (0.0, *extension), (0.0, *tension))
        return replace(band, two_sided=two_sided)
    law = Linear()
    if kind == "cubic":
        law = Cubic(draw(signed(1e-9, 900.0)), draw(signed(1e-9, 1e5)))
    if kind == "shape":
        extension, shape = draw(rows(1))
        law = Table((0.0, *extension), (0.0, *shape))
    return Band(p, q, draw(within(0.01, 1e4)), rest, law, two_sided)


@st.composite
def cells(draw) -> Cell:
    load = draw(st.none() | signed(1e-9, 5.0).map(Load.constant) | rows(1).map(lambda r: Load(*r)))
    try:
        return Cell(
            tuple(draw(st.lists(bands(), min_size=1, max_size=3))),
            draw(within(1e-4, 0.5)),
            draw(within(0.001, 1.55)),
            load,
            draw(st.just(0.0) | within(1e-6, 1.0)),
            draw(st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"]), max_size=9)),
            unusual=True,
            mobility=draw(st.just(1.0) | within(*MOBILITIES)),
        )
    except ValueError:  # a band whose two ends meet
        assume(False)
        raise


@st.composite
def chains(draw) -> Chain:
    members = draw(st.lists(cells(), min_size=1, max_size=3))
    if draw(st.booleans()):  # cells that share what a file can share
        first = members[0]
        members = [
            replace(c, lever=first.lever, limit=first.limit, band=first.band) for c in members
        ]
    actuator = draw(st.sampled_from([0.0, math.inf]) | within(0.1, 1e6))
    return Chain(tuple(members), actuator, draw(st.sampled_from(["", "A leg", 'Quo"ted \\ θ'])))


@pytest.mark.slow
@given(chains())
def test_a_chain_survives_its_file_to_the_last_bit_and_is_written_the_same_again(chain):
    text = dumps(chain)
    again = loads(text).subject
    assert again == chain
    assert repr(astuple(again)) == repr(astuple(chain))  # also the sign of zeros
    assert dumps(again) == text


@given(
    st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(["1/mm²", "1/mm", "mm", "mL"])
)
def test_moving_the_decimal_point_loses_nothing(value, unit):
    text = toml(shortest(value, unit))
    again = exact_si(Decimal(text), unit)
    assert (again, math.copysign(1, again)) == (value, math.copysign(1, value))


@given(within(1e-4, 1.57))
def test_an_angle_survives_degrees(angle):
    assert exact_si(shortest(angle, "deg"), "deg") == angle


def test_the_papers_angle_is_written_as_45():
    assert toml(shortest(math.pi / 4, "deg")) == "45"


def test_a_design_is_written_as_a_person_would_write_it():
    inner = Cell(Band((-0.01, 0), (0.01, 0)), lever=0.014, name="inner")
    outer = replace(
        inner, band=Band((-0.01, 0), (0.02, 0)), name="outer", friction=0.02, mobility=3.0
    )
    assert dumps(Chain((inner, outer), title="Forward-walking leg")) == (
        """\
title = "Forward-walking leg"

[chain]
lever_mm = 14
limit_deg = 45
band = { stiffness_N_per_m = 28.5, rest_length_mm = 10 }

[[chain.cell]]
name = "inner"
p_mm = [-10, 0]
q_mm = [10, 0]

[[chain.cell]]
name = "outer"
p_mm = [-10, 0]
q_mm = [20, 0]
friction_N = 0.02
mobility = 3
"""
    )


def test_the_newtons_of_a_table_are_written_as_they_were_given():
    table = "table_mm_N = [[0, 0], [7, 0.3], [13.1, 0.7]]"
    text = f"[chain]\nband = {{ {table} }}\n[[chain.cell]]\np_mm = [-10, 0]\nq_mm = [10, 0]"
    assert table in dumps(loads(text).subject)


def test_a_law_that_only_some_bands_have_is_not_shared():
    soft = Band((-0.01, 0), (0.01, 0), law=Cubic(0.0, 0.0))
    chain = Chain((Cell(soft), Cell(replace(soft, law=Linear()))))
    assert loads(dumps(chain)).subject == chain


def test_a_law_that_ends_without_tension_is_written_as_a_shape():
    band = Band((-0.01, 0), (0.01, 0), law=Table((0.0, 0.01, 0.02), (0.0, 0.01, 0.0)))
    text = dumps(Chain((Cell(band),)))
    assert "shape_mm = [[0, 0], [10, 10], [20, 0]]" in text
    assert loads(text).chain.levers[0].band == band


def test_a_file_that_would_read_back_otherwise_is_never_written(tmp_path, monkeypatch):
    chain = Chain((Cell(Band((-0.01, 0), (0.01, 0))),))
    monkeypatch.setattr(
        "stepwell.files.write.loads", lambda *_: DesignFile("", "", replace(chain, title="other"))
    )
    with pytest.raises(ValueError, match="did not survive"):
        save(chain, tmp_path / "leg.toml")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"title": "two\nlines"}, "title"),
        ({"title": "\ud800"}, "title"),
        ({"cells": (Cell(Band((0, 0), (2e3, 0)), unusual=True),)}, r"chain.cell\[0\].q_mm"),
    ],
)
def test_what_no_file_may_hold_is_refused_before_anything_is_written(tmp_path, change, key):
    chain = replace(Chain((Cell(Band((-0.01, 0), (0.01, 0))),)), **change)
    with pytest.raises(DesignError, match=key):
        save(chain, tmp_path / "leg.toml")
    assert list(tmp_path.iterdir()) == []


def test_save_writes_what_load_reads(tmp_path):
    chain = Chain((Cell(Band((-0.01, 0), (0.01, 0))),), title="Größe θ")
    save(chain, tmp_path / "leg.toml")
    assert load(tmp_path / "leg.toml").subject == chain
