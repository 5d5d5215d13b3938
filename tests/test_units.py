"""The one table of units."""

import ast
import math
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell
from stepwell.base import UNITS, Quantity, display_unit, from_unit, in_names, to_unit

VALUES = st.floats(-1e12, 1e12).filter(lambda value: value == 0.0 or abs(value) > 1e-12)


@given(VALUES, st.sampled_from(sorted(UNITS)))
def test_every_unit_round_trips(value, unit):
    there = to_unit(value, unit)
    assert from_unit(there, unit) == pytest.approx(value, rel=4e-16, abs=0.0)
    many = from_unit(to_unit(np.array([value, -value]), unit), unit)
    assert many.tolist() == [from_unit(there, unit), -from_unit(there, unit)]


@pytest.mark.parametrize("unit", sorted(UNITS))
def test_both_factors_of_a_unit_and_its_power_of_ten_agree(unit):
    one = UNITS[unit]
    assert Fraction(one.size) * Fraction(one.per_si) == pytest.approx(1.0, rel=4e-16)
    if one.places is not None:
        exact = Fraction(10) ** one.places
        assert (one.size, one.per_si) == (float(exact), float(1 / exact))
    assert UNITS[one.sign] == one
    assert UNITS[one.si].size == 1.0


def test_factors_are_those_of_the_standards():
    # BIPM SI brochure and NIST SP 811: exact by definition, but for psi.
    assert UNITS["in"].size == 0.0254
    assert UNITS["lb"].size == 0.45359237
    assert UNITS["lbf"].size == 4.4482216152605
    assert UNITS["kgf"].size == 9.80665
    assert UNITS["psi"].size == pytest.approx(4.4482216152605 / 0.0254**2, rel=1e-12)
    assert UNITS["deg"].size == math.pi / 180.0
    assert UNITS["bar"].size == 1e5


def test_millimetres_are_the_floats_nearest_to_their_decimals():
    for mm in (0.1, 0.3, 7.0, 10.0, 12.7, 40.0):
        assert from_unit(mm, "mm") == float(Fraction(str(mm)) / 1000)


def test_a_quantity_has_the_factor_of_its_unit():
    for unit in UNITS:
        quantity = Quantity("x", unit)
        assert (quantity.si, quantity.factor) == (UNITS[unit].si, UNITS[unit].per_si)
    assert display_unit("m") == ("mm", 1e3)
    assert display_unit("N/m") == ("N/m", 1.0)
    assert display_unit("Hz") == ("Hz", 1.0)


def test_units_are_spelled_for_names_of_keys():
    assert [in_names(unit) for unit in ("mm", "mm/N", "N m s/rad", "1/mm²", "mNm")] == [
        *("mm", "mm_per_N", "N_m_s_per_rad", "per_mm2", "mNm")
    ]


def test_a_unit_that_is_none_is_no_factor_of_one():
    with pytest.raises(KeyError):
        to_unit(1.0, "furlong")


# Ratios and penalties, not units.
NO_UNITS = {
    "design/margins/nearest.py",
    "figures/common/legends.py",
    "files/program.py",
    "statics/following/flow.py",
}


# As Python writes numbers with a point or an exponent.
NUMBER = re.compile(r"(?<![\w.])(?:\d(?:_?\d)*\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def test_no_number_is_converted_by_a_factor_in_line():
    source = Path(stepwell.__file__).parent
    files = set()
    for file in source.rglob("*.py"):
        where, text = file.relative_to(source), file.read_text("utf-8")
        if not any(float(one) == 1000.0 for one in NUMBER.findall(text)):
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
                ends = (node.left, node.right)
                if any(
                    isinstance(one, ast.Constant) and repr(one.value) == "1000.0" for one in ends
                ):
                    files.add(where.as_posix())
    assert files <= NO_UNITS
