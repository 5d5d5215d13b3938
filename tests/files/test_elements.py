"""Elements in design files: every form of a curve, in every measure, there and back."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, strategies as st

from facts import refuses, says
from stepwell.base import InputError, Measure
from stepwell.files import DesignError, dumps, load, loads, preset, save
from stepwell.files.schema.chain import TABLES
from stepwell.files.schema.keys import field_of, written
from stepwell.mechanism import LIBRARY, Band, Cell, Chain, Element
from stepwell.robot import Leg

TRAVEL, FORCE = [0, 1e-3, 3e-3, 5e-3], [0, 1, -1, 1.5]
POINTS = "points = { travel_mm = [0, 1, 3, 5], force_N = [0, 1, -1, 1.5] }"


def folded() -> Element:
    s = np.linspace(0, 5e-3, 60)
    force = np.interp(s, TRAVEL, FORCE)
    return Element.from_curve((s + force / 400).tolist(), force.tolist(), "folded")


def noisy() -> Element:
    s = np.linspace(0, 6e-3, 60)
    scatter = np.random.default_rng(1).normal(0, 0.01, 60)
    force = np.sin(s * 1e3) + 100 * s + scatter
    return Element.from_table(s.tolist(), force.tolist(), "noisy", noise=0.01)


@cache
def of(measure: Measure) -> Element:
    return Element.from_law(
        lambda s: 1e3 * (np.sin(s * 2e3) + 500 * s), 0, 6e-3, "law", measure=measure
    )


ELEMENTS = {
    "points": Element.from_points(TRAVEL, FORCE, "tri"),
    "stopped": Element.from_points(TRAVEL, FORCE, stops=True, friction=0.01),
    "table": Element.from_table([*TRAVEL, 6.1e-3], [*FORCE, 3.0], stops=(True, False)),
    "scaled": replace(Element.from_points(TRAVEL, FORCE), force_scale=1.3, travel_scale=0.7),
    "slow": Element.from_points(TRAVEL, FORCE, mobility=0.01),
    "law": of(Measure.TRAVEL),
    "folded": folded(),
    "noisy": noisy(),
    "fast and folded": replace(folded(), mobility=1e2),
    "beside": Element.side_by_side([Element.from_points(TRAVEL, FORCE), of(Measure.TRAVEL)]),
}


def answer(cell: str, rest: str = "") -> str:
    with pytest.raises(DesignError) as caught:
        loads(f"[chain]\n[[chain.cell]]\n{cell}\n{rest}", "dome.toml")
    return str(caught.value)


def cell(text: str):
    return loads(f"[chain]\n[[chain.cell]]\n{text}\n").chain.cells[0]


@pytest.mark.slow
@pytest.mark.parametrize("name", ELEMENTS)
def test_a_chain_with_an_element_comes_back_as_it_was_written(name, tmp_path):
    lever = Cell(Band((-0.010, 0.0), (0.020, 0.0)))
    chain = Chain([ELEMENTS[name], lever], title=name)
    save(chain, tmp_path / "chain.toml")
    found = load(tmp_path / "chain.toml").subject
    assert found == chain
    assert dumps(found) == (tmp_path / "chain.toml").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("measure", Measure)
@pytest.mark.parametrize("stiffness", [float("inf"), 0.0, 1e6])
def test_every_measure_and_every_actuator_comes_back(measure, stiffness):
    table = Element.from_table(TRAVEL, FORCE, measure=measure, friction=0.02)
    chain = Chain([table, of(measure)], stiffness)
    assert loads(dumps(chain)).subject == chain


rising = st.lists(st.integers(1, 4000), min_size=3, max_size=9, unique=True).map(sorted)


@pytest.mark.slow
@given(rising, st.data())
def test_any_table_that_is_an_element_comes_back_as_a_table(steps, data):
    measure = data.draw(st.sampled_from(list(Measure)))
    forces = data.draw(st.lists(st.integers(-99, 99), min_size=len(steps), max_size=len(steps)))
    try:
        element = Element.from_table(
            [step * 1e-6 for step in steps], forces, stops=True, measure=measure
        )
    except InputError:
        return
    text = dumps(Chain([element]))
    assert loads(text).chain.cells[0] == element


def test_round_numbers_are_written_round():
    text = dumps(Chain([ELEMENTS["points"], ELEMENTS["table"]]))
    assert POINTS in text
    assert "table = { travel_mm = [0, 1, 3, 5, 6.1], force_N = [0, 1, -1, 1.5, 3] }" in text


def test_every_form_is_the_element_that_its_function_makes():
    columns = "{ travel_mm = [0, 1, 3, 5], force_N = [0, 1, -1, 1.5] }"
    made = {form: getattr(Element, f"from_{form}") for form in ("table", "points")}
    for form, make in made.items():
        assert cell(f"{form} = {columns}\nname = 'x'") == make(TRAVEL, FORCE, "x")
    fold = "travel_mm = [0, 4, 2, 6], force_N = [0, 1, -1, 2]"
    assert cell(f"curve = {{ {fold} }}") == Element.from_curve([0, 4e-3, 2e-3, 6e-3], [0, 1, -1, 2])
    pair = cell(f"beside = [{{ {POINTS} }}, {{ {POINTS}, friction_N = 0.1 }}]")
    plain = Element.from_points(TRAVEL, FORCE)
    assert pair == Element.side_by_side([plain, replace(plain, friction=0.1)])


def test_elements_side_by_side_have_a_mobility_each_and_may_be_given_one_together():
    quick = replace(Element.from_points(TRAVEL, FORCE), mobility=3.0)
    pair = f"beside = [{{ {POINTS} }}, {{ {POINTS}, mobility = 3 }}]"
    assert cell(pair).mobility == Element.side_by_side([ELEMENTS["points"], quick]).mobility == 0.75
    assert cell(f"{pair}\nmobility = 2").mobility == 2.0


def test_an_element_may_stand_for_a_chain_and_have_a_mobility_of_its_own():
    assert cell(f"{INSIDE}\nmobility = 5").mobility == 5.0


INSIDE = "inside = [{ p_mm = [-10, 0], q_mm = [10, 0] }, { p_mm = [-10, 0], q_mm = [20, 0] }]"


@pytest.mark.slow
def test_a_chain_may_stand_inside_a_cell():
    inner, outer = preset("paper-forward").cells
    made = cell(f"{INSIDE}\nname = 'pair'")
    wanted = Element.from_chain(Chain([inner, outer]), "pair")
    assert made == wanted
    chain = Chain([Element.from_chain(Chain([ELEMENTS["points"], outer])), inner])
    assert loads(dumps(chain)).subject == chain


@pytest.mark.slow
@pytest.mark.parametrize("name", LIBRARY)
def test_every_element_of_the_library_has_its_keys(name):
    entry, key = LIBRARY[name], name.replace("-", "_")
    table = TABLES[f"chain.cell.{key}"]
    assert [field_of(one) for one in table.model_fields] == [*entry.defaults]
    assert cell(f"{key} = {{}}") == entry.make(name="")
    # Each argument goes where it belongs, in its unit.
    given = {
        one: tuple(1.01 * x for x in value) if isinstance(value, tuple) else value * 1.01
        for one, value in entry.defaults.items()
        if not isinstance(value, int)
    }
    keys = ", ".join(
        f"{one} = {written(one, given[field_of(one)])}"
        for one in table.model_fields
        if field_of(one) in given
    )
    element = entry.make(**given, name="mine")
    assert cell(f"{key} = {{ {keys} }}\nname = 'mine'") == element
    chain = Chain([element, replace(element, force_scale=2.0)])
    assert loads(dumps(chain)).subject == chain


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ballon = {}", "chain.cell[0].ballon: unknown key. Did you mean balloon?"),
        ("balloon = 3", "chain.cell[0].balloon = 3: must be a table"),
        (
            "balloon = { radius_m = 0.02 }",
            "chain.cell[0].balloon.radius_m: unknown key. Did you mean radius_mm?",
        ),
        (
            "balloon = { radius_mm = 1, thickness_mm = 2 }",
            "chain.cell[0]: thickness = 2 mm: must be at most 0.1 mm, a tenth of the radius",
        ),
        ("kresling = { sides = 6.5 }", "chain.cell[0].kresling.sides = 6.5: must be a whole"),
    ],
)
def test_wrong_arguments_of_the_library_are_reported(text, message):
    assert answer(text).startswith(f"dome.toml: {message}")


def test_units_are_those_of_the_keys():
    balloon = cell("points = { volume_mL = [0, 10, 30, 60], pressure_kPa = [0, 2, 1, 3] }")
    assert balloon.measure is Measure.VOLUME
    assert (balloon.high, balloon.largest_force) == (60e-6, 3000.0)
    hinge = cell("points = { angle_deg = [0, 45, 90, 135], torque_mNm = [0, 2, 1, 3] }")
    assert hinge.measure is Measure.ANGLE
    assert (hinge.high, hinge.largest_force) == (3 * np.pi / 4, 0.003)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("points = 3", "chain.cell[0].points = 3: must be a table"),
        ("points = {}", "chain.cell[0].points: has no columns: must hold travel_mm and force_N"),
        (
            "points = { travel_mm = [0, 1], pressure_kPa = [0, 1] }",
            "chain.cell[0].points: has travel_mm and pressure_kPa: must hold travel_mm and",
        ),
        (
            "points = { travel_mm = [0, 1, 2], force_N = [0, 1] }",
            "chain.cell[0].points.travel_mm = [0, 1, 2]: has 3 numbers, force_N 2: must be equal",
        ),
        (
            "table = { travel_mm = [0, 2, 1], force_N = [0, 1, 2] }",
            "chain.cell[0].table.travel_mm = [0, 2, 1]: number 3, 1, must be at least "
            "0.000001 above the one before, 2. Sort the rows",
        ),
        (
            "table = { travel_mm = [0, 'x'], force_N = [0, 1] }",
            'chain.cell[0].table.travel_mm = [0, "x"]: number 2 must be from -1e9 to 1e9',
        ),
        (
            "table = { travel_mm = [0, 1], force_N = [0, 1] }",
            "chain.cell[0]: the table has 2 points: must have 3 or more",
        ),
        (
            "points = { travel_mm = [0, 1, 2], force_N = [0, 0, 0] }",
            "chain.cell[0].points.force_N = [0, 0, 0]: must hold a force of 1E-9 or more in size.",
        ),
        (
            "points = { travel_mm = [0, 1, 2], force_N = [0, 2, 1] }",
            "chain.cell[0]: stops: at the high end of the curve the force does not rise",
        ),
        (f"{POINTS}\ntable = {{}}", "chain.cell[0].table: has no columns"),
        (
            f"{POINTS}\ntable = {{ travel_mm = [0, 1, 2], force_N = [0, 1, 2] }}",
            "chain.cell[0]: gives points and table: an element has one curve, keep one.",
        ),
        (
            f"{POINTS}\np_mm = [0, 0]",
            "chain.cell[0].p_mm = [0, 0]: cannot be combined with points: an element has no levers",
        ),
        (
            f"{POINTS}\nload_N = 1",
            "chain.cell[0].load_N = 1: cannot be combined with points: an element has no levers",
        ),
        (
            "p_mm = [-10, 0]\nq_mm = [10, 0]\nstops = true",
            "chain.cell[0].stops = true: needs the curve of an element: table, points, curve",
        ),
        (f"{POINTS}\nstops = 1", "chain.cell[0].stops = 1: must be true or false, or two of them"),
        (
            f"{POINTS}\nnoise_N = 0.1",
            "chain.cell[0].noise_N = 0.1: is for table only; leave it out.",
        ),
        (
            f"{POINTS}\nfriction_kPa = 0.1",
            "chain.cell[0]: friction_kPa: this curve is of travel and force, so it must be "
            "friction_N.",
        ),
        (f"{POINTS}\nmobility = 0", "chain.cell[0].mobility = 0: must be from 0.01 to 100."),
        (
            'table_csv = "dome.csv"',
            'chain.cell[0].table_csv = "dome.csv": names a file, which is only read for a design',
        ),
        (f"{POINTS}\nstop = true", "chain.cell[0].stop: unknown key. Did you mean stops?"),
        (
            f"beside = [{{ {POINTS} }}]",
            "chain.cell[0]: elements: 1 given: must be two or more in parallel.",
        ),
        (
            f"beside = [{{ {POINTS} }}, {{ name = 'x' }}]",
            "chain.cell[0].beside[1]: is no element: add one of table, points, curve",
        ),
        (
            INSIDE.replace("20", "1e7"),
            "chain.cell[0].inside[1].q_mm = [1E+7, 0]: must be two numbers from -1e6 to 1e6",
        ),
        (INSIDE.replace("20", "2000"), "chain.cell[0].inside[1].q_mm = [2000, 0]: "),
        (f"inside = [{{ {POINTS}, friction_N = 1 }}]", "chain.cell[0]: "),
        ("inside = []", "chain.cell[0]: cells is empty: a chain has one cell or more"),
        (
            f"inside = [{{ inside = [{{ {POINTS} }}] }}]",
            "chain.cell[0].inside[0].inside: unknown key.",
        ),
        (
            "sheets = [{ travel_m = [0, 1], cubics_SI = [[0, 1, 0]] }]",
            "chain.cell[0].sheets[0].cubics_SI = [[0, 1, 0]]: row 1 must be five numbers",
        ),
        (
            "sheets = [{ travel_m = [0, 1, 2], cubics_SI = [[0, 1, 0, 0, 0], [5, 1, 0, 0, 0.5]] }]",
            "chain.cell[0]: sheets[0].cubics_SI: row 2 begins with the force 5, where row 1 ends "
            "with 1: both must be equal.",
        ),
        (
            "sheets = [{ travel_m = [0, 1], cubics_SI = [[0, 1, 0, 0, 0]], above = 2 }]",
            "chain.cell[0]: sheets[0].above = 2: must be the number of a sheet of less energy at "
            "1000 mm",
        ),
        (
            "sheets = [{ travel_m = [0, 1, 2], cubics_SI = [[0, 1, 0, 0, 0], [1, 1, 0, 0, 0]] }]",
            "chain.cell[0]: sheets[0].cubics_SI: row 2 begins with the energy 0, where row 1 ends",
        ),
        (
            "sheets = [{ travel_m = [0, 3], cubics_SI = [[0, 1, -0.5, 0, 0]] }]\nstops = true",
            "chain.cell[0]: sheets[0].cubics_SI: force or stiffness have an extremum at 1, within",
        ),
    ],
)
def test_a_wrong_element_is_answered_with_place_value_and_what_is_allowed(text, message):
    assert answer(text).startswith(f"dome.toml: {message}")


def test_a_chain_of_unlike_measures_is_refused():
    other = "[[chain.cell]]\npoints = { volume_mL = [0, 1], pressure_kPa = [0, 1] }"
    says(
        answer(POINTS, other),
        "dome.toml: chain: ",
        "cells[1]",
        "volume and pressure",
        "travel and force",
    )


def test_an_actuator_in_other_units_is_refused():
    text = f"[chain]\nactuator_stiffness_kPa_per_mL = 0\n[[chain.cell]]\n{POINTS}"
    with pytest.raises(DesignError) as caught:
        loads(text, "dome.toml")
    says(
        str(caught.value),
        "dome.toml: chain: ",
        "actuator_stiffness_kPa_per_mL = 0",
        "travel and force",
        "actuator_stiffness_N_per_m",
    )


def test_a_leg_of_a_robot_is_made_of_levers_and_bands():
    with refuses(ValueError, "leg 'left'", "elements", "levers"):
        Leg("left", Chain([ELEMENTS["points"]] * 2), (0.0, 0.05))


PROGRAM = f"[chain]\n[[chain.cell]]\n{POINTS}\n[[chain.cell]]\n{POINTS}\nstops = true\n[program]\n"


def test_a_program_of_elements_may_begin_anywhere_in_its_first_state():
    program = loads(f'{PROGRAM}start = "01"\nturning_points_mm = [4.5, -2]\nends = "00"').program
    assert program is not None
    assert program.turning_points == (0.0045, -0.002)
    with refuses(DesignError, "turning_points_mm", "6.5", "-inf to 6 mm"):
        loads(f'{PROGRAM}start = "01"\nturning_points_mm = [6.5]')


def test_a_state_has_a_digit_up_to_the_last_phase_of_its_cell():
    three = "points = { travel_mm = [0, 1, 2, 3, 4, 5], force_N = [0, 2, 1, 3, 2, 4] }"
    text = f"[chain]\n[[chain.cell]]\n{three}\n[program]\nturning_points_mm = [0, 5]\n"
    program = loads(f'{text}ends = "2"').program
    assert program is not None
    assert program.ends == "2"
    with pytest.raises(DesignError) as caught:
        loads(f'{text}ends = "3"', "three.toml")
    says(str(caught.value), 'three.toml: program.ends = "3"', "one digit", "inner first", "2")


def test_a_program_of_volumes_is_in_millilitres_and_is_written_so():
    cells = "[[chain.cell]]\npoints = { volume_mL = [0, 9, 20, 50], pressure_kPa = [0, 2, 1, 4] }"
    text = f"[chain]\n{cells}\n[program]\nturning_points_mL = [0, 30]\n"
    program = loads(text).program
    assert program is not None
    assert program.turning_points == (0.0, 30e-6)
    assert "turning_points_mL = [0, 30]" in program.text(loads(text).chain)
    with refuses(DesignError, "turning_points_mm", "turning_points_mL"):
        loads(text.replace("points_mL", "points_mm"))


LONG = "points = { travel_mm = [0, 1000, 2000, 3000], force_N = [0, 1, -1, 2] }\n"


def test_a_curve_of_metres_needs_to_be_unusual_and_is_written_so():
    text = f"[chain]\n[[chain.cell]]\n{LONG}"
    with pytest.raises(ValueError, match="unusual = true") as refused:
        loads(text)
    assert "chain.cell[0].travel_mm = 3000" in str(refused.value)
    assert "Did you mean 3 mm?" in str(refused.value)
    assert loads(text.replace("3000", "3").replace("1000, 2000", "1, 2")).chain
    own, shared = loads(f"{text}unusual = true\n"), loads(text.replace("]", "]\nunusual = true", 1))
    assert own.chain == shared.chain
    again = dumps(own.chain)
    assert again.count("unusual = true") == 1
    assert loads(again).chain == own.chain
    beside = "[chain]\n[[chain.cell]]\nbeside = [{ %s }, { %s, unusual = true }]\n"
    part = LONG.strip()
    with pytest.raises(ValueError, match="unusual = true"):
        loads(beside % (part, part))
    assert (
        loads(beside % (f"{part}, unusual = true", part)).chain
        == loads((beside % (part, part)).replace("]\n", "]\nunusual = true\n", 1)).chain
    )
