"""The account of a map: axes, shares and boundaries, the same in every form."""

import numpy as np
import pytest

import stepwell as sw
from accounts.forms import forms, pair, refuse
from accounts.schemas import violations
from stepwell.accounts import account
from stepwell.base import Measure, percent
from stepwell.design import MapView

X, Y = np.linspace(0.0, 0.020, 11), np.linspace(-0.015, 0.015, 11)


def _over_anchor(chain: sw.Chain, cell: int) -> MapView:
    curves = sw.boundaries(chain, cell, x=X, y=Y)
    own = chain.levers[cell].bands[0].q
    return MapView(sw.transition_map(chain, cell, x=X, y=Y), curves, {"this design": own})


@pytest.fixture(scope="module")
def forward():
    return _over_anchor(sw.preset("paper-forward"), 1)


def test_the_record_has_axes_in_file_units_and_shares_that_add_up(forward):
    record = account(forward).record
    assert violations(record) == []
    assert record["across"] == {
        "parameter": "outer.q.x",
        "unit": "mm",
        "from": 0.0,
        "to": pytest.approx(20.0),
        "count": 11,
        "design": pytest.approx(20.0),
    }
    assert sum(record["fractions"].values()) == pytest.approx(1.0)
    assert sum(record["pathway_fractions"].values()) == pytest.approx(1.0)
    assert record["closed_form_designs"] == 121 and record["engine_designs"] == 0
    assert len(record["boundaries"]) == len(forward.boundaries) > 0
    assert [one["points"] for one in record["boundaries"]] == [
        len(one.points) for one in forward.boundaries
    ]


def test_every_form_has_axes_and_shares_and_the_terminal_the_boundaries(forward):
    found = account(forward)
    screen, small, made = forms(found)
    for form in (screen, small, made):
        assert "0 to 20 mm, 11 values" in form and "-15 to 15 mm, 11 values" in form
        for name, share in found.record["fractions"].items():
            if share:
                assert name in form and percent(share) in form
    for boundary in forward.boundaries:
        changed = boundary.changes.split(":")[0]
        assert changed in " ".join(screen.split()) and changed in made and changed not in small
    for form in (screen, made):
        assert percent(found.record["monostable_fraction"]) in form


@pytest.mark.slow
def test_of_three_cells_there_are_no_pathways():
    record = account(_over_anchor(sw.preset("three-wave"), 1)).record
    assert violations(record) == []
    assert record["pathway_fractions"] is None


def test_scales_have_no_unit_and_frictions_that_of_the_chain():
    axes = ("stiff.force_scale", np.array([0.5, 1.0])), ("soft.friction", np.array([0.0, 100.0]))
    data = sw.parameter_map(pair(Measure.VOLUME), *axes)
    found = account(MapView(data, [], {"this design": (1.0, 0.0)}))
    record = found.record
    assert violations(record) == []
    assert (record["across"]["unit"], record["up"]["unit"]) == ("1", "kPa")
    assert (record["across"]["design"], record["up"]["design"]) == (1.0, 0.0)
    for form in forms(found):
        assert "stiff.force_scale 0.5 to 1, 2 values" in form
        assert "soft.friction 0 to 0.1 kPa, 2 values" in form


def test_a_map_without_its_design_has_null_for_its_place(forward):
    record = account(MapView(forward.dataset, forward.boundaries, {})).record
    assert record["across"]["design"] is record["up"]["design"] is None
    assert violations(record) == []


def test_the_account_of_a_map_computes_nothing(forward, monkeypatch):
    for name in ("transition_map", "parameter_map", "boundaries", "parameter_boundaries"):
        monkeypatch.setattr(f"stepwell.design.{name}", refuse)
    found = account(forward)
    assert found.record and all(forms(found))
