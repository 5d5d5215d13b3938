"""One schema a result: JSON, CSV, xarray, console and page tell the same in the same unit."""

import csv
import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

import stepwell as sw
from sizes import examples
from stepwell import results
from stepwell.accounts import account
from stepwell.base import Column, Quantity, number, plain, record, shown, told_in, write_csv
from stepwell.cli.text import chains as texts
from stepwell.design import margin
from stepwell.mechanism import Band, Cell, Chain
from stepwell.reports import report
from stepwell.simulation import TRIAL
from stepwell.simulation.sweeps import Sweep, Trial
from stepwell.simulation.walks import SAMPLES

NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+(?:\.\d+)?(?:e[-+]\d+)?")


@pytest.fixture(autouse=True)
def a_row_a_line(monkeypatch):
    monkeypatch.setenv("COLUMNS", "1000")


class Tables(HTMLParser):
    """The tables of a page as lists of rows of text."""

    def __init__(self, text: str):
        super().__init__()
        self.found: list[list[list[str]]] = []
        self.inside = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag == "table":
            self.found.append([])
        elif tag == "tr":
            self.found[-1].append([])
        elif tag in ("td", "th"):
            self.found[-1][-1].append("")
            self.inside = True

    def handle_endtag(self, tag):
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data):
        if self.inside:
            self.found[-1][-1][-1] += data.replace("\N{MINUS SIGN}", "-")


def on_screen(capsys, title: str) -> list[list[str]]:
    """The rows of a table on the console, its head first."""
    lines = capsys.readouterr().out.split("\n")
    start = next(k for k, line in enumerate(lines) if line.startswith(title))
    end = lines.index("", start)
    return [re.split(r"\s{2,}", line.strip()) for line in lines[start + 1 : end]]


def chains(seed: int):
    rng = np.random.default_rng(seed)
    for _ in range(examples(3)):
        cells = [
            Cell(
                Band((-0.010, 0.0), (rng.uniform(0.008, 0.022), rng.uniform(-0.004, 0.004))),
                name=f"c-{k} <&>",
            )
            for k in range(rng.integers(2, 4))
        ]
        yield Chain(cells, title="random")


def same(text: str, told: float | None, digits: int = 4) -> bool:
    return text == number(told, digits)


@pytest.mark.parametrize("seed", [3])
def test_console_page_and_json_tell_the_same_numbers_of_a_run(seed, capsys):
    for chain in chains(seed):
        cycle = chain.cycle()
        limits = margin(chain)
        found = results.run_record(cycle, limits)
        texts.run(found, chain)
        screen = on_screen(capsys, "Cells")
        changes, cells, events = Tables(report(cycle, limits, {})).found
        heads = [q.heading for q in shown(results.CELL)]
        assert screen[0] == heads
        assert [cells[0][0], *cells[0][2:]] == [head[:1].upper() + head[1:] for head in heads]
        for row, page, told in zip(screen[1:], cells[1:], found["cells"], strict=True):
            assert row == [page[0], *page[2:]]
            for q in results.CELL:
                if not q.heading:
                    continue
                text = row[heads.index(q.heading)]
                assert not q.unit or same(text, told[q.key])
        for page, told in zip(events[1:], found["events"], strict=True):
            told_events = dict(zip(events[0], page, strict=True))
            assert same(told_events["Stroke [mm]"], told["stroke_mm"])
            assert same(told_events["Force before [N]"], told["force_before_N"])
            assert same(told_events["Force after [N]"], told["force_after_N"])
            snaps = told["kind"] == "snap"
            assert same(told_events["Released [mJ]"], told["released_mJ"] if snaps else None)
        nearest = sorted(
            f"{number(one['distance_mm'])} mm"
            for one in found["margin"]["changes"]
            if one.get("distance_mm") is not None
        )
        assert sorted(row[2] for row in changes[1:] if row[2].endswith(" mm")) == nearest


def test_the_record_has_what_the_values_have_in_the_units_of_its_names():
    for chain in chains(5):
        cycle = chain.cycle()
        found = results.run_record(cycle, None)
        for told, cell in zip(found["cells"], chain.cells, strict=True):
            assert isinstance(cell, Cell)
            assert told["F0_N"] == cell.force_0
            assert told["peak_angle_deg"] == math.degrees(cell.peak_angle)
            assert told["full_travel_mm"] == pytest.approx(cell.full_travel / 1e-3, rel=1e-15)
            assert told["barrier_mJ"] == pytest.approx(cell.barrier / 1e-3, rel=1e-15)
        for told, event in zip(found["events"], cycle.events, strict=True):
            assert told["stroke_mm"] == pytest.approx(event.stroke / 1e-3, rel=1e-15, abs=1e-12)
            assert told["after_mm"] == pytest.approx([s / 1e-3 for s in event.after], abs=1e-12)
        assert found["margin"] is None


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


def test_a_program_is_told_alike_in_csv_json_and_on_the_console(tmp_path, capsys):
    chain = sw.preset("paper-forward")
    found = chain.program(to="01", start="10")
    found.to_csv(tmp_path / "program.csv")
    held, told = columns_of(tmp_path / "program.csv"), results.program_record(found)
    texts.program(told, chain)
    (row,) = on_screen(capsys, "Turns: anywhere")[1:]
    (turn,) = told["turns"]
    for k, name in enumerate(("drive_mm", "low_mm", "high_mm"), 1):
        assert float(held[name][1]) == pytest.approx(turn[name], rel=1e-8)
        assert same(row[k], turn[name])
    assert row[4] == ", ".join(turn["branch"])


def test_a_sweep_is_told_alike_in_csv_xarray_and_json(tmp_path):
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


def test_a_new_quantity_is_told_everywhere(tmp_path, capsys, monkeypatch):
    from stepwell.results import run

    new = Quantity("lever", "mm", "lever arm", doc="between the joints")
    monkeypatch.setattr(run, "CELL", (*run.CELL, new))
    chain = sw.preset("paper-forward")
    cycle, limits = chain.cycle(), margin(chain)
    found = results.run_record(cycle, limits)
    assert [cell["lever_mm"] for cell in found["cells"]] == [
        cell.lever * 1e3 for cell in chain.cells
    ]
    texts.run(found, chain)
    screen = on_screen(capsys, "Cells")
    _, table, _ = Tables(report(cycle, limits, {})).found
    told = number(found["cells"][0]["lever_mm"])
    assert (screen[0][-1], table[0][-1]) == ("lever arm [mm]", "Lever arm [mm]")
    assert screen[1][-1] == table[1][-1] == told


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
def test_json_can_hold_what_is_told(value, factor, told):
    found = plain(value, factor)
    assert found == told
    assert type(found) is type(told)


def test_units_are_told_as_the_table_says():
    assert told_in("m") == ("mm", 1e3)
    assert told_in("N/m") == ("N/m", 1.0)
    assert told_in("rad")[1] == math.degrees(1.0)
    for q in (*SAMPLES, *TRIAL, *results.CELL):
        if q.unit in FACTORS:
            assert q.factor == FACTORS[q.unit]
            assert told_in(q.si) == (q.unit, q.factor)


def test_a_column_in_words_of_its_own_keeps_its_place():
    columns = shown([Quantity("a"), Quantity("b", "mm", "b"), Column("both", lambda row: "x")])
    assert [column.heading for column in columns] == ["b [mm]", "both"]
    assert [column.numeric for column in columns] == [True, False]
