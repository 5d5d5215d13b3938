"""What is reported of elements, of whatever travel and force are: words, units, phases."""

import csv
import re
from collections.abc import Iterable
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import stepwell as sw
from accounts.forms import SCALES, folded, forms, mixed, pair, shown
from stepwell.accounts import Account, account
from stepwell.accounts.changes import margin_section, margin_words
from stepwell.accounts.head import DesignShape
from stepwell.accounts.parts import RecordTable
from stepwell.accounts.yields import tolerance_schema
from stepwell.base import (
    Measure,
    Quantity,
    Schema,
    amount,
    display_unit,
    in_measure,
    number,
    record,
)
from stepwell.design import Run

KEYS = {
    Measure.TRAVEL: ("stroke_mm", "travel_{}_mm", "force_N", "stability_N_per_m"),
    Measure.VOLUME: ("volume_mL", "volume_{}_mL", "pressure_kPa", "stability_kPa_per_mL"),
    Measure.ANGLE: ("angle_deg", "angle_{}_deg", "torque_mNm", "stability_N_m_per_rad"),
}
OF_LEVERS = re.compile(r"lever|block|band|anchor|θ|F0|F1", re.IGNORECASE)


def told(chain: sw.Chain) -> dict:
    return account(Run.of(chain)).record


@cache
def run_of(measure: Measure, stops: bool = False) -> Account:
    """The account of a run of the pair, which nothing changes."""
    return account(Run.of(pair(measure, stops)))


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


@pytest.mark.slow
@pytest.mark.parametrize("stops", [False, True])
def test_the_same_machine_tells_the_same_numbers_in_any_measure(stops):
    usual = run_of(Measure.TRAVEL, stops).record
    for measure in (Measure.VOLUME, Measure.ANGLE):
        found = run_of(measure, stops).record
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


@pytest.mark.slow
def test_every_key_names_the_unit_of_its_measure():
    for measure, (stroke, _, force, _) in KEYS.items():
        found = run_of(measure).record
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
        factor = display_unit(data[name].attrs["units"])[1]
        assert held[key] == pytest.approx(getattr(path, name) * factor, rel=1e-11, abs=1e-300)
        assert np.array_equal(data[name], getattr(path, name), equal_nan=True)
    factor = display_unit(measure.travel_unit)[1]
    for k, name in enumerate(("soft", "stiff")):
        assert held[travel.format(name)] == pytest.approx(path.travel[:, k] * factor, rel=1e-11)


@pytest.mark.slow
def test_samples_and_events_have_the_sheet_where_a_curve_folds_back(tmp_path):
    cycle = folded().cycle()
    cycle.path.to_csv(tmp_path / "path.csv")
    assert "sheet_folded" in (tmp_path / "path.csv").read_text().partition("\n")[0]
    assert set(np.ravel(cycle.path.to_xarray()["sheet"])) == {0, 1}
    found = told(cycle.chain)
    assert found["cells"][0]["sheets"] == 2
    up, down = found["events"]
    assert (up["sheets_before"], up["sheets_after"]) == ([0], [1])
    assert (down["sheets_before"], down["sheets_after"]) == ([1], [0])
    assert "sheets_before" not in run_of(Measure.TRAVEL).record["events"][0]


@pytest.mark.slow
def test_switching_forces_are_those_at_which_the_cell_goes_on():
    law = sw.Element.from_law(lambda s: np.sin(2e3 * s) + 50 * s, 0.0, 6e-3, "three")
    (cell,) = told(sw.Chain([law]))["cells"]
    assert cell["phases"] == 3
    assert list(zip(cell["force_up_N"], cell["force_down_N"], strict=True)) == list(law.fields)
    assert cell["stable"] == [0, 1, 2]


@pytest.mark.slow
def test_the_page_of_a_mixed_chain_has_bands_and_the_assumptions_of_levers():
    page = forms(account(Run.of(mixed())))[2]
    assert "Levers and blocks are rigid" in page
    assert "-10, 0" in page


@pytest.mark.slow
@pytest.mark.parametrize("measure", Measure)
def test_nothing_of_levers_is_shown_of_elements(measure):
    screen, _, page = forms(run_of(measure))
    for form in (screen, page):
        assert not OF_LEVERS.findall(form)
        if measure is not Measure.TRAVEL:
            assert not re.search(r"\b(force|stroke|travel|mm|N)\b", form)


@pytest.mark.slow
@pytest.mark.parametrize("measure", Measure)
def test_every_form_has_what_the_record_holds(measure, monkeypatch):
    monkeypatch.setenv("COLUMNS", "1000")
    account_ = run_of(measure)
    found = account_.record
    unit = Quantity(f"peak_{measure.force}", display_unit(measure.force_unit)[0])
    arrivals = [arrival for event in found["events"] for arrival in event["arrivals"]]
    assert len(re.findall(r" at [01]\b", shown(account_))) == len(arrivals)
    for form in forms(account_):
        assert f"Peak {measure.force}" in form
        assert f"{number(found[unit.key])} {unit.sign}" in form


def test_tolerances_are_those_that_the_cells_have():
    lever = sw.preset("paper-forward").cells[0]
    levers, both = sw.Chain([lever, lever]), sw.Chain([lever, pair(Measure.TRAVEL).cells[0]])
    names = {
        "levers": [q.name for q in tolerance_schema(DesignShape.of(levers))],
        "mixed": [q.name for q in tolerance_schema(DesignShape.of(both))],
        "volumes": [q.key for q in tolerance_schema(DesignShape.of(pair(Measure.VOLUME)))],
    }
    plain = ["anchor", "stiffness", "rest_length", "lever", "friction"]
    assert names == {
        "levers": [*plain, "mobility", "by_cell"],
        "mixed": [*plain, "travel", "mobility", "by_cell"],
        "volumes": ["stiffness_percent", "friction_kPa", "volume_percent", "mobility", "by_cell"],
    }


@pytest.mark.slow
def test_the_smallest_changes_are_reported_by_what_they_change():
    margin = pair(Measure.VOLUME).margin()
    words = margin_words(margin)
    for kind, label in (
        ("force_scale", "% in pressures"),
        ("friction", "% of the largest pressure in friction"),
    ):
        least = min(one.distance for one in margin.changes if one.parameter == kind)
        assert f"{number(least * 100)} {label}" in words
    ((table,),) = margin_section(margin).values()
    assert isinstance(table, RecordTable) and callable(table.rows)
    columns, rows = [*table.columns], table.rows()
    changed = [columns[1].cell(row) for row in rows]
    assert any(re.match(r"pressures by [-+][\d.]+ %$", way) for way in changed)
    assert any(re.match(r"friction by \+[\d.]+ % of the largest pressure$", way) for way in changed)


def test_what_was_set_of_an_element_is_in_every_form():
    reprogramming = pair(Measure.VOLUME).reprogram(None, "stiff.force_scale")
    found = account(reprogramming)
    place = number(found.record["place"])
    assert found.record["distance"] == reprogramming.distance
    for form in forms(found):
        assert f"stiff.force_scale to {place}" in form or f"changed to {place}" in form
        assert "state 0" not in form
