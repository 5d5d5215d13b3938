"""The account of a reprogramming: the change, its force and the way, the same in every form."""

import csv
import math

import pytest

import stepwell as sw
from accounts.schemas import violations
from stepwell.accounts import account, card, page, terminal
from stepwell.base import number, signed

BACK = "00>01>11>10>00"


@pytest.fixture(scope="module")
def moved():
    return sw.preset("paper-forward").reprogram(BACK, "inner.q")


def _forms(found) -> tuple[str, ...]:
    screen = "\n".join(line.text for line in terminal(found, full=True))
    made = page(found).replace(" → ", ">").replace("\N{MINUS SIGN}", "-")
    return screen, card(found).replace("&gt;", ">"), made


def test_every_form_has_the_change_both_sequences_force_and_work(moved):
    found = account(moved)
    assert violations(found.record) == []
    for form in _forms(found):
        for text in (
            moved.before,
            moved.after,
            f"({', '.join(signed(part * 1e3) for part in moved.move)}) mm",
            f"{number(moved.distance * 1e3)} mm",
            f"({', '.join(number(part * 1e3) for part in moved.anchor_at)}) mm",
            f"{number(moved.resistance.largest)} N",
            f"{number(moved.resistance.work_0 * 1e3)} mJ",
            "exact",
        ):
            assert text in form


def test_the_way_is_the_same_in_csv_xarray_json_and_tables(moved, tmp_path):
    moved.to_csv(tmp_path / "way.csv")
    with open(tmp_path / "way.csv", newline="", encoding="utf-8") as file:
        held = [*csv.DictReader(file)]
    record, data = account(moved).record, moved.to_xarray()
    way = record["way"]
    names = {"force_0_N": "force_at_0_N", "force_1_N": "force_at_1_N", "peak_N": "largest_force_N"}
    for key, name in names.items():
        column = [one[name] for one in way]
        assert [float(row[key]) for row in held] == pytest.approx(column, rel=1e-10, abs=1e-15)
        assert data[key.removesuffix("_N")].values == pytest.approx(column)
        assert data[key.removesuffix("_N")].attrs["units"] == "N"
    assert data["x"].values * 1e3 == pytest.approx([one["at_mm"][0] for one in way])
    assert data["x"].attrs["units"] == "m"
    screen, _, made = _forms(account(moved))
    for one in way[::5]:
        numbers = [one["fraction"] * record["distance_mm"], *one["at_mm"]]
        row = [number(value) for value in [*numbers, *(one[name] for name in names.values())]]
        assert any(line.split() == row for line in screen.split("\n"))
        assert all(f">{text}</td>" in made for text in row)


def test_what_is_not_within_reach_has_null_and_says_what_was_tried():
    found = account(sw.preset("paper-forward").reprogram(BACK, "inner.p", reach=1e-4))
    record = found.record
    assert violations(record) == []
    assert (record["possible"], record["after"], record["way"]) == (False, None, [])
    assert (record["distance_mm"], record["place_mm"]) == (None, [None, None])
    assert all(f"inner.p up to 0.1 mm gives {BACK}" in form for form in _forms(found))


def test_a_design_that_has_the_target_sequence_already_needs_no_change():
    chain = sw.preset("paper-forward")
    found = account(chain.reprogram(str(chain.cycle().sequence), "inner.q"))
    assert found.record["distance_mm"] == 0.0
    assert all("already" in form and "state 0" not in form for form in _forms(found))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["balloon", "kresling", "dome", "trilinear"])
def test_a_number_of_an_element_is_in_its_own_unit_and_nothing_resists_it(name):
    chain = sw.preset(name)
    by = f"{chain.names[0]}.force_scale"
    value = chain.reprogram(None, by)
    found = account(value)
    assert violations(found.record) == []
    assert math.isclose(found.record["distance"], value.distance)
    assert found.record["largest_force_N"] is None
    others = [key for key in found.record if key.startswith(("distance_", "place_"))]
    assert others and all(found.record[key] is None for key in others)
    assert all(f"{by} to {number(found.record['place'])} (" in form for form in _forms(found))
    assert not any("state 0" in form for form in _forms(found))


@pytest.mark.slow
def test_friction_of_an_element_is_in_the_unit_of_its_force():
    chain = sw.preset("balloon")
    value = chain.reprogram(None, f"{chain.names[0]}.friction")
    record = account(value).record
    assert violations(record) == []
    assert record["distance"] is None
    told = record["distance_kPa"]
    assert told is None if math.isinf(value.distance) else math.isclose(told, value.distance / 1e3)


def test_the_account_of_a_reprogramming_computes_nothing(moved, monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("an account calls the engine")

    for name in ("path", "cycle", "margin", "reprogram"):
        monkeypatch.setattr(sw.Chain, name, refuse)
    monkeypatch.setattr("stepwell.design.margins.reprogramming.cycle", refuse)
    found = account(moved)
    assert found.record and all(_forms(found))
