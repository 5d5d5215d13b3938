"""The account of a run: each number once, the same in every form."""

import json
import math
from dataclasses import replace

import pytest

import stepwell as sw
from accounts.forms import PRESETS, SHAPES, forms, sealed, shapes, shown
from accounts.schemas import violations
from facts import says
from stepwell.accounts import account, card, page, terminal
from stepwell.accounts.rendering.terminal import SCREEN
from stepwell.base import number
from stepwell.design import Run
from stepwell.mechanism import Cell


@pytest.fixture(scope="module")
def forward():
    return Run.of(sw.preset("paper-forward"))


def _row(count: int, **more) -> sw.Chain:
    """Cells whose bands end further and further out."""
    bands = (sw.Band((-0.010, 0.0), (0.004 + 2e-4 * i, 0.0)) for i in range(count))
    return sw.Chain([sw.Cell(band, **more) for band in bands])


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_the_record_of_every_preset_keeps_to_the_schema_and_is_finite(name):
    found = account(Run.of(sw.preset(name)))
    assert violations(found.record) == []
    json.dumps(found.record, allow_nan=False)
    # Not the page, which has to draw samples first.
    assert shown(found) and card(found)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_the_record_of_every_shape_keeps_to_the_schema(name):
    found = account(Run.of(shapes()[name]))
    assert violations(found.record) == []
    assert shown(found) and card(found)


@pytest.mark.slow
def test_a_cell_with_a_lever_has_what_elements_have_and_an_element_has_null_instead():
    lever, dome = account(Run.of(shapes()["mixed"])).record["cells"]
    assert lever["force_up_N"] == [lever["F0_N"]]
    assert lever["force_down_N"] == [lever["F1_N"]]
    assert lever["stopped"] == [True, True]
    assert {dome[key] for key in ("F0_N", "F1_over_kr", "peak_angle_deg", "barrier_mJ")} == {None}


def test_cells_of_one_name_are_reported(forward):
    chain = sw.Chain([replace(cell, name="foo") for cell in forward.chain.levers])
    says(shown(account(Run.of(chain))), "Equal names", "Cells 1, 2", "named foo")
    assert "Equal names" not in shown(account(forward))


def test_the_record_has_what_the_values_have_in_the_units_of_its_names(forward):
    record, cycle = account(forward).record, forward.cycle
    assert (record["sequence"], record["pathway"]) == (str(cycle.sequence), "clockwise")
    assert record["actuator"] == {"control": "stroke", "stiffness_N_per_m": None}
    for one, cell in zip(record["cells"], cycle.chain.cells, strict=True):
        assert isinstance(cell, Cell)
        assert one["F0_N"] == cell.force_0
        assert one["peak_angle_deg"] == math.degrees(cell.peak_angle)
        assert one["full_travel_mm"] == pytest.approx(cell.full_travel * 1e3, rel=1e-15)
        assert one["barrier_mJ"] == pytest.approx(cell.barrier * 1e3, rel=1e-15)
    for one, event in zip(record["events"], cycle.events, strict=True):
        assert one["stroke_mm"] == pytest.approx(event.stroke * 1e3, rel=1e-15, abs=1e-12)
        assert one["after_mm"] == pytest.approx([s * 1e3 for s in event.after], abs=1e-12)
    # Kamp et al. 2024: ±0.967 and ±1.607.
    assert [one["F0_over_kr"] for one in record["cells"]] == pytest.approx([0.967, 1.607], abs=1e-3)


@pytest.mark.slow
def test_every_form_has_sequence_pathway_forces_energy_margin_and_landings(forward):
    found = account(forward)
    record = found.record
    nearest = min(change.distance for change in forward.margin.changes if change.cell == 1)
    for form in forms(found):
        for text in (
            "00>10>11>01>00",
            "clockwise",
            f"{record['peak_force_N']:.4g} N",
            f"{record['dissipated_mJ']:.4g} mJ",
            f"{number(nearest * 1e3)} mm",
            f"ratios up to 10; {len(forward.cycle.snaps)} proved",
            *(number(snap.stroke * 1e3) for snap in forward.cycle.snaps),
        ):
            assert text in form


def test_changes_have_their_distance_in_one_unit_and_null_in_the_other(forward):
    for one, change in zip(
        account(forward).record["margin"]["changes"], forward.margin.changes, strict=True
    ):
        anchor = one["parameter"] == "anchor"
        unit, other, factor = ("mm", "percent", 1e3) if anchor else ("percent", "mm", 1e2)
        assert one[f"distance_{unit}"] == pytest.approx(change.distance * factor)
        assert one[f"distance_{other}"] is one[f"move_{other}"] is None
        assert one["becomes"] == change.becomes


def test_a_distance_out_of_reach_is_null_and_words():
    found = account(Run.of(sw.preset("paper-cell-10-0")))
    assert {one["distance_mm"] for one in found.record["margin"]["changes"]} == {None}
    for form in forms(found):
        assert "none within reach" in form
        assert " inf" not in form and "nan" not in form


@pytest.mark.slow
def test_force_control_has_drives_in_newtons():
    record = account(Run.of(sw.preset("force-control"))).record
    assert record["actuator"] == {"control": "force", "stiffness_N_per_m": 0.0}
    assert all("drive_N" in event and "drive_mm" not in event for event in record["events"])


def test_a_tie_is_warned_of_before_the_numbers():
    found = account(Run.of(sw.preset("paper-identical")))
    assert found.record["ties"]
    assert {note for warned in found.warnings for note in warned.lines} == set(found.record["ties"])
    made = page(found)
    assert made.index('class="warning"') < made.index("<main>")


def test_samples_are_on_the_page_alone_and_assumptions_with_full_too(forward):
    whole, small, made = forms(account(forward))
    screen = " ".join(line.text for line in terminal(account(forward)))
    assert "95 % confidence" in made and "95 % confidence" not in whole
    assert "Quasi-static" in made and "Quasi-static" in whole
    assert "Quasi-static" not in screen and "Quasi-static" not in small
    assert f"{forward.built.samples} samples" in made


@pytest.mark.parametrize("count", [12, 13])
def test_of_long_chains_no_change_is_followed_to_its_end(count, monkeypatch):
    run = Run.of(_row(count))
    asked: list[object] = []
    monkeypatch.setattr(
        type(run.margin.changes[0]), "becomes", property(lambda one: asked.append(one) or "1>0")
    )
    record = account(run).record
    followed = count == 12
    assert bool(asked) == followed
    assert {one["becomes"] for one in record["margin"]["changes"]} == {"1>0" if followed else None}
    assert (run.built is not None) == followed


@pytest.mark.slow
def test_long_chains_are_cut_in_every_form_and_whole_in_the_record(monkeypatch):
    monkeypatch.setattr(Run, "built", property(lambda run: pytest.fail("a card draws samples")))
    found = account(Run.of(_row(100)))
    record = found.record
    assert len(record["cells"]) == 100 and len(record["margin"]["changes"]) == 200
    assert record["sequence"] is record["landings"] is None
    assert len(card(found)) < 40_000
    screen = [line.text for line in terminal(found)]
    assert len(screen) <= SCREEN and len(shown(found).split("\n")) > 700
    assert "--mobility-ratio" in " ".join(screen) and "--mobility-ratio" not in card(found)


def test_the_account_of_a_run_computes_nothing(monkeypatch):
    run = Run.of(sw.preset("paper-via-10"))
    assert run.built is not None and all(change.becomes for change in run.margin.changes)
    sealed(monkeypatch)
    found = account(run)
    assert found.record and all(forms(found))
    assert account(run.cycle) and card(account(run.cycle)) and card(account(run.cycle.path))
