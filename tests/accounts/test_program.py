"""The account of a program, and of the proof that there is none."""

from dataclasses import replace

import pytest

import stepwell as sw
from accounts.forms import PRESETS, SHAPES, forms, sealed, shapes
from accounts.schemas import violations
from stepwell.accounts import account
from stepwell.base import InputError, number
from stepwell.sequences import Program, Unreachable
from stepwell.statics import EventKind


def _to_last(chain: sw.Chain) -> Program | Unreachable:
    """A program to all cells at their last phase."""
    last = "".join(str(len(cell.phases) - 1) for cell in chain.cells)
    try:
        return chain.program(last)
    except Unreachable as why:
        return why


@pytest.fixture(scope="module")
def found():
    return sw.preset("paper-forward").program("01", start="10")


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_the_record_of_every_preset_keeps_to_the_schema(name):
    try:
        value = _to_last(sw.preset(name))
    except InputError:
        pytest.skip("friction leaves no program")
    one = account(value)
    assert violations(one.record) == []
    assert all(forms(one))


@pytest.mark.parametrize("name", SHAPES)
def test_the_record_of_every_shape_keeps_to_the_schema(name):
    one = account(_to_last(shapes()[name]))
    assert violations(one.record) == []
    assert all(forms(one))


def test_the_record_has_what_the_program_has_in_the_units_of_its_names(found):
    record = account(found).record
    assert (record["from"], record["target"], record["arrives"]) == ("10", "01", "01")
    assert record["meets_target"] and record["proved"] and record["robust"] is None
    assert record["turning_points_mm"] == [point * 1e3 for point in found.turning_points]
    assert record["slack_mm"] == pytest.approx(found.slack * 1e3)
    (turn,) = record["turns"]
    assert (turn["low_mm"], turn["high_mm"]) == (
        found.turns[0].low * 1e3,
        found.turns[0].high * 1e3,
    )
    assert [event["kind"] for event in record["events"]] == ["snap", "switch"]


def test_every_form_has_states_turning_points_windows_and_slack(found):
    (turn,) = found.turns
    for form in forms(account(found)):
        for text in ("10 to 01", "20>38.62>20 mm", "10>01", f"{found.slack * 1e3:.3g} mm"):
            assert text in form
        for value in (turn.drive, turn.low, turn.high):
            assert number(value * 1e3) in form


def test_under_force_control_drives_are_forces():
    program = sw.preset("force-control").program("01")
    one = account(program)
    assert one.record["turning_points_N"] == list(program.turning_points)
    assert "turning_points_mm" not in one.record
    assert all(f"{number(program.turning_points[-1])} N" in form for form in forms(one))


def test_every_snap_on_the_way_has_its_landing():
    program = sw.preset("paper-forward").program("01")
    record = account(program).record
    snaps = [k for k, one in enumerate(program.path.events) if one.kind is EventKind.SNAP]
    assert [landing["event"] for landing in record["landings"]] == snaps != []
    assert all(landing["holds"] for landing in record["landings"])


def test_a_program_that_ends_elsewhere_does_not_do_it(found):
    other = account(replace(found, target="11"))
    assert (other.record["meets_target"], other.record["arrives"]) == (False, "01")
    assert all("ends in 01" in form for form in forms(other))


def test_where_there_is_none_the_record_has_the_proof_and_null():
    chain = sw.preset("used-before")
    with pytest.raises(Unreachable) as why:
        chain.program("01")
    one = account(why.value)
    record = one.record
    assert violations(record) == []
    assert (record["from"], record["target"], record["cells"]) == ("00", "01", ["seal", "lid"])
    assert (record["meets_target"], record["proved"]) == (False, True)
    for key in ("arrives", "turning_points_mm", "turns", "events", "landings", "slack_mm"):
        assert record[key] is None
    for form in forms(one):
        assert " ".join(record["reason"].split()).lower() in " ".join(form.split()).lower()


def test_the_account_of_a_program_computes_nothing(found, monkeypatch):
    assert found.path.checked_landings and found.sequence
    sealed(monkeypatch)
    one = account(found)
    assert one.record and all(forms(one))
