"""The account of a verdict: each number once, the same in every form."""

import math

import pytest

import stepwell as sw
from accounts.forms import PRESETS, sealed, shown
from accounts.schemas import violations
from sizes import cases
from stepwell.accounts import About, Calibrated, account, card, page
from stepwell.design import Tolerances, check

# Of a cell and a chain, in closed form and by the engine, a tie, a program, slack and elements;
# tests/accounts/test_run.py has the other actuators.
SOME = (
    *("paper-forward", "paper-cell-0-m15", "paper-identical", "combination-lock"),
    *("force-control", "slack", "three-wave", "balloon"),
)


@pytest.fixture(scope="module")
def works():
    return check(sw.preset("paper-forward"), samples=100)


@pytest.mark.slow
@pytest.mark.parametrize("name", cases(PRESETS, SOME))
def test_the_record_of_every_preset_keeps_to_the_generated_schema(name):
    found = account(check(sw.preset(name), samples=5))
    assert violations(found.record) == []
    # Every form can be made of it.
    assert shown(found) and card(found) and page(found)


@pytest.mark.slow
def test_a_program_and_a_calibration_keep_to_the_schema_too():
    chain = sw.preset("paper-forward")
    program = chain.program("11")
    calibrated = Calibrated("rubber", {"a.csv": "0" * 64}, "linear", ["k = 28.5 N/m"], 0.02)
    found = account(check(chain, program, samples=5), About(chain, calibrated=calibrated))
    assert violations(found.record) == []
    assert (
        found.record["critical_change"] is None
        or found.record["critical_change"]["becomes"] is None
    )
    assert "k = 28.5 N/m" in shown(found) and "k = 28.5 N/m" in page(found)


def test_every_form_has_verdict_yield_critical_change_and_actuator_force(works):
    found = account(works)
    assert found.record["verdict"] == "robust"
    force = f"{found.record['peak_force_N']:.3g}".lstrip("-")
    for form in (shown(found), card(found), page(found)):
        assert "robust: the nominal design" in form.lower()
        assert f"{force} N" in form
        assert "stiffness of outer by" in form
        assert "95 % confidence" in form


def test_a_change_of_an_anchor_is_in_mm_and_one_of_a_number_in_percent(works):
    critical_change = account(works).record["critical_change"]
    percent = critical_change["parameter"] != "anchor"
    assert (critical_change["distance_percent"] is not None) == percent
    assert (critical_change["distance_mm"] is not None) == (not percent)
    assert math.isclose(
        critical_change["distance_percent" if percent else "distance_mm"],
        works.critical_change.distance * (1e2 if percent else 1e3),
    )


def test_a_measurement_has_its_tolerance_in_one_unit_and_null_in_the_others():
    loose = Tolerances(anchor=1e-3, stiffness=0.1)
    found = check(sw.preset("three-wave"), tolerances=loose, samples=400)
    assert found.measure is not None
    record = account(found).record["measure"]
    units = [key for key in record if key.startswith("now_")]
    assert sum(record[key] is not None for key in units) == 1


def test_a_tie_is_warned_of_before_the_numbers():
    found = account(check(sw.preset("paper-identical"), samples=20))
    notes = [note for warned in found.warnings for note in warned.lines]
    assert found.record["ties"] and set(found.record["ties"]) <= set(notes)
    made = page(found)
    assert made.index('class="warning"') < made.index("<main>")


def test_the_account_of_a_verdict_computes_nothing(works, monkeypatch):
    sealed(monkeypatch)
    found = account(works)
    assert found.record and shown(found) and card(found) and page(found)
