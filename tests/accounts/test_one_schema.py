"""JSON, CSV, xarray, terminal, card and page have the same numbers in the same units."""

import csv
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from accounts.forms import Tables, forms, pair, shown
from stepwell.accounts import account, card, chain as chain_account, page
from stepwell.accounts.chain import cell_schema
from stepwell.accounts.head import DesignShape, Row
from stepwell.accounts.parts import Level, RecordTable
from stepwell.base import (
    Column,
    Measure,
    Quantity,
    display_unit,
    headed,
    number,
    plain,
    record,
    shown as shown_columns,
    write_csv,
)
from stepwell.design import MapView, Run
from stepwell.robot import TRIAL
from stepwell.simulation.sweeps import Sweep, Trial
from stepwell.simulation.walks import SAMPLES


@pytest.fixture(autouse=True)
def a_row_a_line(monkeypatch):
    monkeypatch.setenv("COLUMNS", "1000")


def _map(chain: sw.Chain) -> MapView:
    x = np.linspace(0.0, 0.020, 5)
    return MapView(sw.transition_map(chain, 1, x=x, y=x), sw.boundaries(chain, 1, x=x, y=x), {})


MADE: dict[str, Callable[[sw.Chain], Any]] = {
    "chain": lambda chain: chain,
    "check": lambda chain: sw.check(chain, samples=20),
    "cycle": lambda chain: chain.cycle(),
    "map": _map,
    "margin": lambda chain: chain.margin(),
    "program": lambda chain: chain.program("01"),
    "run": Run.of,
    "walk": lambda chain: chain.implicit_graph().walked(),
}
CHAINS = {"levers": sw.preset("paper-forward"), "volumes": pair(Measure.VOLUME)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "of"),
    [(kind, of) for kind in MADE for of in CHAINS if (kind, of) != ("map", "volumes")],
)
def test_json_terminal_card_and_page_have_the_same_numbers_in_the_same_units(kind, of):
    found = account(MADE[kind](CHAINS[of]))
    screen = shown(found)
    small, made = Tables(card(found)).found, Tables(page(found)).found
    _, words_of_card, words_of_page = forms(found)
    for fact in found.facts:
        value = fact.text() if callable(fact.text) else fact.text
        text = " ".join(value.replace(" → ", ">").split())
        assert text in " ".join(words_of_page.split())
        assert fact.level > Level.FULL or text in " ".join(screen.replace(" → ", ">").split())
        assert fact.level > Level.CARD or text[:900] in " ".join(words_of_card.split())
    for _, parts in found.within(Level.FULL):
        for table in parts:
            if isinstance(table, RecordTable) and (rows := found.rows(table)):
                _same(table, rows, screen, made, small if table.level is Level.CARD else None)


def _same(
    table: RecordTable, rows: Sequence[Row], screen: str, made: list, small: list | None
) -> None:
    """Each number of a table is in every form, below its heading with the unit."""
    columns = shown_columns(table.columns)
    heads = [column.heading for column in columns]
    cells = [[column.cell(row) for column in columns] for row in rows]
    for column in columns:
        if not isinstance(column, Quantity) or not isinstance(column.form, int):
            continue
        for row in rows:
            value = row[column.key]
            if isinstance(value, float):
                assert column.cell(row) == number(value, column.form)
    lines = [re.split(r"\s{2,}", line.strip()) for line in screen.split("\n")]
    wide = shown_columns(table.wide)
    assert [*heads, *(column.heading for column in wide)] in lines
    for row, one in zip(cells, rows, strict=True):
        every = [*row, *(column.cell(one) for column in wide)]
        assert [text for text in every if text] in lines
    on_page = next(one for one in made if _heads(one, heads))
    assert [row[: len(heads)] for row in on_page[1:]] == cells[:200]
    if small is not None:
        assert next(one for one in small if one and _heads(one, heads))[1:] == cells[:8]


def _heads(rows: list[list[str]], heads: list[str]) -> bool:
    return rows[0][: len(heads)] == [headed(head) for head in heads]


def columns_of(file) -> dict[str, np.ndarray]:
    with open(file, newline="", encoding="utf-8") as text:
        head, *rows = csv.reader(text)
    return {
        name: np.array(column) for name, column in zip(head, zip(*rows, strict=True), strict=True)
    }


FACTORS = {"mm": 1e3, "mJ": 1e3, "deg": 180 / math.pi, "N": 1.0, "N_per_m": 1.0}


@pytest.mark.parametrize("stiffness", [math.inf, 200.0, 0.0])
def test_csv_and_xarray_hold_the_same_path(tmp_path, stiffness):
    chain = replace(sw.preset("paper-forward"), actuator_stiffness=stiffness)
    path = chain.path([0.0, 0.5 if stiffness == 0 else 0.03])
    path.to_csv(tmp_path / "path.csv")
    held, data = columns_of(tmp_path / "path.csv"), path.to_xarray()
    units = {"mm": "m", "mJ": "J", "N_per_m": "N/m"}
    seen = set()
    for key, column in held.items():
        name = next((n for n in data if key == n or key.startswith(f"{n}_")), "")
        unit = key.removeprefix(str(name)).strip("_")
        values = data[name]
        if name == "travel":
            cell, _, unit = unit.rpartition("_")
            values = values.sel(cell=cell)
        assert values.attrs["units"] == (units.get(unit, unit) or "1")
        assert values.attrs["long_name"]
        given = values.values * FACTORS.get(unit, 1.0)
        assert column.astype(float) == pytest.approx(given, rel=1e-11, abs=1e-300)
        seen.add(name)
    assert seen == set(data.data_vars)


def test_csv_xarray_and_record_of_a_program_and_a_reprogramming_have_the_same(tmp_path):
    chain = sw.preset("paper-forward")
    program = chain.program(target="01", start="10")
    program.to_csv(tmp_path / "program.csv")
    (turn,) = account(program).record["turns"]
    held = columns_of(tmp_path / "program.csv")
    for name in ("drive_mm", "low_mm", "high_mm"):
        assert float(held[name][1]) == pytest.approx(turn[name], rel=1e-8)

    found = chain.reprogram("00>01>11>10>00", "inner.q")
    found.to_csv(tmp_path / "way.csv")
    held, data = columns_of(tmp_path / "way.csv"), found.to_xarray()
    way = account(found).record["way"]
    names = {"force_0_N": "force_at_0_N", "force_1_N": "force_at_1_N", "peak_N": "largest_force_N"}
    for key, name in names.items():
        column = [one[name] for one in way]
        assert held[key].astype(float) == pytest.approx(column, rel=1e-10, abs=1e-15)
        assert data[key.removesuffix("_N")].values == pytest.approx(column)
        assert data[key.removesuffix("_N")].attrs["units"] == "N"
    assert data["x"].values * 1e3 == pytest.approx([one["at_mm"][0] for one in way])
    assert data["x"].attrs["units"] == "m"


def test_csv_xarray_and_record_of_a_sweep_have_the_same(tmp_path):
    trials = (
        Trial(0.7, -0.1, 0.3, ("00", ""), 0.0021, ""),
        Trial(math.nan, math.nan, math.nan, ("", ""), math.nan, "early"),
    )
    found = Sweep({"q_mm": [5.0, 15.0]}, trials)
    found.to_csv(tmp_path / "sweep.csv")
    held, data = columns_of(tmp_path / "sweep.csv"), found.to_xarray()
    told = account(found).record["trials"]
    assert [one["values"] for one in told] == [[5.0], [15.0]]
    for q in TRIAL[:4]:
        values = data[q.name]
        assert values.attrs["units"] == q.si
        assert float(held[q.key][0]) == pytest.approx(told[0][q.key], rel=1e-5)
        assert float(values[0]) * q.factor == pytest.approx(told[0][q.key])
        assert held[q.key][1] == "nan"
        assert told[1][q.key] is None


def test_a_new_quantity_of_an_account_is_in_its_record_and_in_every_form(monkeypatch):
    new = Quantity("lever", "mm", "lever arm", doc="between the joints")
    monkeypatch.setattr(chain_account, "_LEVER", (*chain_account._LEVER, new))
    found = account(Run.of(sw.preset("paper-forward")))
    value = found.record["cells"][0]["lever_mm"]
    assert value == found.value.chain.cells[0].lever * 1e3
    for form in forms(found):
        assert "lever arm [mm]" in form.lower()
        assert number(value) in form


def test_a_quantity_is_one_line_from_which_every_form_comes(tmp_path):
    q = Quantity("slope", "N/m", "slope", doc="of the force", read=lambda v: v["s"])
    assert record([q], {"s": 3.5}) == {"slope_N_per_m": 3.5}
    assert (q.heading, q.cell({"slope_N_per_m": 3.5}), q.si) == ("slope [N/m]", "3.5", "N/m")
    write_csv(tmp_path / "a.csv", [(q, np.array([1.0, 2.0]))])
    assert (tmp_path / "a.csv").read_text() == "slope_N_per_m\n1\n2\n"
    from stepwell.base import variables

    assert variables([q], {"s": [1.0]}, "row") == {
        "slope": (("row",), [1.0], {"units": "N/m", "long_name": "of the force"})
    }


@pytest.mark.parametrize(
    ("value", "factor", "told"),
    [
        (math.inf, 1.0, None),
        (math.nan, 1e3, None),
        (1e308, 1e3, None),
        (np.float64(0.002), 1e3, 2.0),
        (np.int64(3), 1.0, 3),
        (np.bool_(True), 1.0, True),
        ((0.001, math.inf), 1e3, [1.0, None]),
        (np.array([[0.001], [0.002]]), 1e3, [[1.0], [2.0]]),
        ({"a": 0.001, "b": None}, 1e3, {"a": 1.0, "b": None}),
        ("−0", 1e3, "−0"),
        ((), 1e3, []),
    ],
)
def test_json_can_hold_what_is_reported(value, factor, told):
    found = plain(value, factor)
    assert found == told
    assert type(found) is type(told)


def test_units_are_those_of_the_table():
    assert display_unit("m") == ("mm", 1e3)
    assert display_unit("N/m") == ("N/m", 1.0)
    assert display_unit("rad")[1] == math.degrees(1.0)
    for q in (*SAMPLES, *TRIAL, *cell_schema(DesignShape())):
        if q.unit in FACTORS:
            assert q.factor == FACTORS[q.unit]
            assert display_unit(q.si) == (q.unit, q.factor)


def test_a_column_in_words_of_its_own_keeps_its_place():
    columns = shown_columns(
        [Quantity("a"), Quantity("b", "mm", "b"), Column("both", lambda row: "x")]
    )
    assert [column.heading for column in columns] == ["b [mm]", "both"]
    assert [column.numeric for column in columns] == [True, False]
