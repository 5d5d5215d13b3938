"""What is told of elements, of whatever travel and force are: words, units, phases."""

import csv
import math
import re
from collections.abc import Iterable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import stepwell as sw
from stepwell import results
from stepwell.base import Measure, Quantity, Schema, amount, in_measure, number, record, told_in
from stepwell.cli.text import chains as texts
from stepwell.reports import report

# One shape in three measures: travels and forces by what makes SI of mm and N, mL and kPa, deg and
# mN m.
SCALES = {
    Measure.TRAVEL: (1e-3, 1.0),
    Measure.VOLUME: (1e-6, 1e3),
    Measure.ANGLE: (math.pi / 180, 1e-3),
}
KEYS = {
    Measure.TRAVEL: ("stroke_mm", "travel_{}_mm", "force_N", "stability_N_per_m"),
    Measure.VOLUME: ("volume_mL", "volume_{}_mL", "pressure_kPa", "stability_kPa_per_mL"),
    Measure.ANGLE: ("angle_deg", "angle_{}_deg", "torque_mNm", "stability_N_m_per_rad"),
}
OF_LEVERS = re.compile(r"lever|block|band|anchor|θ|F0|F1", re.IGNORECASE)


def pair(measure: Measure, stops: bool = False) -> sw.Chain:
    """A clockwise pair, of the same numbers in whatever they are told in."""
    travel, force = SCALES[measure]
    cells = [
        sw.Element.from_points(
            [at * travel for at in (0.0, 10.0, 30.0, 50.0)],
            [at * force for at in (0.0, peak, -peak, 2.0)],
            name,
            stops=stops,
            measure=measure,
        )
        for name, peak in (("soft", 1.0), ("stiff", 1.2))
    ]
    return sw.Chain(cells, title="pair")


def told(chain: sw.Chain) -> dict:
    return results.run_record(chain.cycle(), None)


def numbers_of(found: object) -> Iterable[float]:
    if isinstance(found, dict):
        found = list(found.values())
    if isinstance(found, list):
        for part in found:
            yield from numbers_of(part)
    elif isinstance(found, float):
        yield found


def test_a_schema_of_travel_and_force_is_itself():
    schema: Schema = (Quantity("peak_force", "N", "force"),)
    assert in_measure(schema, Measure.TRAVEL) is schema


def test_words_and_units_follow_the_measure_and_the_value_is_read_as_before():
    schema = (
        Quantity("peak_force", "N", "force after", doc="largest force"),
        Quantity("travel_low", "mm", read="low"),
        Quantity("stroke", "mm", "stroke", lambda value: value.u),
        Quantity("stability", "N/m"),
        Quantity("forced", "mJ", "enforced"),
    )
    value = SimpleNamespace(peak_force=2e3, low=3e-6, u=4e-6, stability=5e9, forced=6e-3)
    found = in_measure(schema, Measure.VOLUME)
    assert record(found, value) == pytest.approx(
        {
            "peak_pressure_kPa": 2.0,
            "volume_low_mL": 3.0,
            "volume_mL": 4.0,
            "stability_kPa_per_mL": 5.0,
            "forced_mJ": 6.0,
        }
    )
    assert [q.heading for q in found] == [
        "pressure after [kPa]", "", "volume [mL]", "", "enforced [mJ]",
    ]  # fmt: skip
    assert found[0].doc == "largest pressure"


@pytest.mark.parametrize(
    ("unit", "text"),
    [("m", "1500 mm"), ("N", "1.5 N"), ("m³", "1.5e+06 mL"), ("Pa", "0.0015 kPa"),
     ("N m", "1500 mN m"), ("Pa/m³", "1.5e-09 kPa/mL"), ("N m/rad", "1.5 N m/rad")],
)  # fmt: skip
def test_an_amount_has_its_unit_as_people_write_it(unit, text):
    assert amount(1.5, unit) == text


@pytest.mark.parametrize("stops", [False, True])
def test_the_same_machine_tells_the_same_numbers_in_any_measure(stops):
    usual = told(pair(Measure.TRAVEL, stops))
    for measure in (Measure.VOLUME, Measure.ANGLE):
        found = told(pair(measure, stops))
        assert (found["sequence"], found["pathway"]) == (usual["sequence"], usual["pathway"])
        for part in ("cells", "events"):
            # Energies are in mJ in all of them.
            mJ = SCALES[measure][0] * SCALES[measure][1] * 1e3
            mine = [{k: v for k, v in one.items() if k != "released_mJ"} for one in found[part]]
            theirs = [{k: v for k, v in one.items() if k != "released_mJ"} for one in usual[part]]
            assert list(numbers_of(mine)) == pytest.approx(list(numbers_of(theirs)), abs=1e-9)
            if part == "events":
                heat = [one["released_mJ"] for one in usual[part]]
                assert [one["released_mJ"] / mJ for one in found[part]] == pytest.approx(heat)


def test_every_key_names_the_unit_of_its_measure():
    for measure, (stroke, _, force, _) in KEYS.items():
        found = told(pair(measure))
        unit = stroke.partition("_")[2]
        assert f"peak_{force}" in found
        assert f"turning_points_{unit}" in found
        assert {stroke, f"before_{unit}", f"after_{unit}"} <= found["events"][0].keys()
        word, _, of = force.partition("_")
        assert {f"{word}_up_{of}", f"{word}_down_{of}"} <= found["cells"][0].keys()
        if measure is not Measure.TRAVEL:
            keys = [*found, *found["cells"][0], *found["events"][0], *found["actuator"]]
            assert not [key for key in keys if re.search("force|travel|stroke_|_N$|_mm$", key)]


@pytest.mark.parametrize("measure", Measure)
def test_samples_have_units_in_csv_and_the_names_of_the_path_in_xarray(tmp_path, measure):
    path = pair(measure).cycle().path
    path.to_csv(tmp_path / "path.csv")
    with open(tmp_path / "path.csv", newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    held = dict(zip(head, np.array(rows, float).T, strict=True))
    data = path.to_xarray()
    stroke, travel, force, stability = KEYS[measure]
    for key, name in ((stroke, "stroke"), (force, "force"), (stability, "stability")):
        factor = told_in(data[name].attrs["units"])[1]
        assert held[key] == pytest.approx(getattr(path, name) * factor, rel=1e-11, abs=1e-300)
        assert np.array_equal(data[name], getattr(path, name), equal_nan=True)
    factor = told_in(measure.travel_unit)[1]
    for k, name in enumerate(("soft", "stiff")):
        assert held[travel.format(name)] == pytest.approx(path.travel[:, k] * factor, rel=1e-11)


def test_samples_tell_the_sheet_where_a_curve_folds_back(tmp_path):
    travel = np.linspace(0.0, 5e-3, 200)
    force = np.interp(travel, [0.0, 1e-3, 3e-3, 5e-3], [0.0, 1.0, -1.0, 1.5])
    folded = sw.Element.from_curve((travel + force / 400).tolist(), force.tolist(), "folded")
    cycle = sw.Chain([folded]).cycle()
    cycle.path.to_csv(tmp_path / "path.csv")
    assert "sheet_folded" in (tmp_path / "path.csv").read_text().partition("\n")[0]
    assert set(np.ravel(cycle.path.to_xarray()["sheet"])) == {0, 1}
    found = told(cycle.chain)
    assert found["cells"][0]["sheets"] == 2
    up, down = found["events"]
    assert (up["sheets_before"], up["sheets_after"]) == ([0], [1])
    assert (down["sheets_before"], down["sheets_after"]) == ([1], [0])
    assert "sheets_before" not in told(pair(Measure.TRAVEL))["events"][0]


def test_switching_forces_are_those_at_which_the_cell_goes_on():
    law = sw.Element.from_law(lambda s: np.sin(2e3 * s) + 50 * s, 0.0, 6e-3, "three")
    (cell,) = told(sw.Chain([law]))["cells"]
    assert cell["phases"] == 3
    assert list(zip(cell["force_up_N"], cell["force_down_N"], strict=True)) == list(law.fields)
    assert cell["stable"] == [0, 1, 2]


def test_a_lever_cell_among_elements_is_told_as_both():
    lever = sw.preset("paper-forward").cells[0]
    dome = sw.Element.from_points([0, 5e-3, 13e-3, 20e-3], [0, 0.3, -0.3, 0.5], "dome")
    chain = sw.Chain([lever, dome])
    first, second = told(chain)["cells"]
    assert first["force_up_N"] == [first["F0_N"]] == [lever.force_0]
    assert first["force_down_N"] == [first["F1_N"]] == [lever.force_1]
    assert first["stopped"] == [True, True]
    assert "F0_N" not in second
    page = report(chain.cycle(), None, {})
    assert "Levers and blocks are rigid" in page
    assert "p (\N{MINUS SIGN}10, 0) mm" in page


@pytest.mark.parametrize("measure", Measure)
def test_nothing_of_levers_is_shown_of_elements(measure, capsys):
    chain = pair(measure)
    found = told(chain)
    found["margin"] = {"changes": [], "reach_mm": 20.0, "method": "search"}
    texts.run(found, chain)
    screen = capsys.readouterr().out
    page = report(chain.cycle(), None, {})
    page = re.sub(r"<style>.*?</style>|<[^>]*>", " ", page, flags=re.DOTALL)
    for shown in (screen, page):
        assert not OF_LEVERS.findall(shown)
        if measure is not Measure.TRAVEL:
            assert not re.search(r"\b(force|stroke|travel|mm|N)\b", shown)


@pytest.mark.parametrize("measure", Measure)
def test_the_screen_tells_what_the_record_holds(measure, capsys):
    chain = pair(measure)
    found = told(chain)
    texts.run(found | {"margin": {"changes": [], "reach_mm": 20.0, "method": "search"}}, chain)
    screen = capsys.readouterr().out
    force, unit = measure.force, Quantity("", told_in(measure.force_unit)[0])
    key = replace(unit, name=f"peak_{force}").key
    assert f"Peak {force}" in screen
    assert f"{number(found[key])} {unit.sign}" in screen
    arrivals = [arrival for event in found["events"] for arrival in event["arrivals"]]
    assert len(re.findall(" at [01]", screen)) == len(arrivals)


def test_the_smallest_changes_are_told_by_what_they_change():
    chain = pair(Measure.VOLUME)
    changes = [
        {"parameter": "force_scale", "distance_percent": 12.0, "move_percent": -12.0},
        {"parameter": "force_scale", "distance_percent": 3.0, "move_percent": 3.0},
        {"parameter": "travel_scale", "distance_percent": None, "move_percent": None},
        {"parameter": "friction", "distance_percent": 5.0, "move_percent": 5.0},
    ]
    assert list(results.nearest_changes(chain, changes).values()) == [
        "3 % in pressure",
        "5 % in friction",
    ]
    rows = [one | {"cell": k % 2, "becomes": ""} for k, one in enumerate(changes)]
    *_, far, way = results.change_columns(chain, rows)
    assert [(far.cell(row), way.cell(row)) for row in rows] == [
        ("12 %", "pressures by -12 %"),
        ("3 %", "pressures by +3 %"),
        ("none", ""),
        ("5 %", "by +5 % of the largest pressure"),
    ]


def test_a_map_over_scales_has_no_unit_and_one_over_friction_that_of_the_chain(capsys):
    chain = pair(Measure.VOLUME)
    axes = ("stiff.force_scale", np.array([0.5, 1.0])), ("soft.friction", np.array([0.0, 100.0]))
    found = results.map_record(sw.parameter_map(chain, *axes), [], (1.0, 0.0))
    texts.map_(found)
    screen = capsys.readouterr().out
    assert (
        "Across  stiff.force_scale 0.5 to 1, 2 values\nUp      soft.friction 0 to 0.1 kPa" in screen
    )
    assert (found["across"]["unit"], found["up"]["unit"]) == ("1", "kPa")
