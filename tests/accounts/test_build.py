"""What is reported of a build."""

import pytest

import stepwell as sw
from accounts.forms import forms
from accounts.schemas import violations
from build import chains
from facts import says
from stepwell.accounts import account


@pytest.fixture(scope="module")
def works():
    return sw.build(chains.pair(), samples=200)


@pytest.fixture(scope="module")
def collides():
    return sw.build(chains.steep(), samples=50)


def test_the_record_keeps_to_the_generated_schema(works, collides):
    for made in (works, collides, sw.build(chains.crossed(), samples=20)):
        assert violations(account(made).record) == []


def test_every_form_has_the_verdict_the_yield_and_the_bands(works):
    for form in forms(account(works)):
        words = " ".join(form.replace("&gt;", ">").split())
        says(words, "can be built", "14 parts", "3 mm acrylic")
        says(words, "45 pairs")
        says(words, "100 of 100 builds", "00>10>11>01>00")
        says(words, "pD3 qD5")


def test_a_collision_is_a_finding_with_its_way_out_in_every_form(collides):
    for form in forms(account(collides)):
        words = " ".join(form.split())
        says(words, "1 finding")
        says(words, "lever-1a", "lever-1b", "1.16 mm", "lever.width_mm = 6.8")


def test_numbers_of_a_finding_have_one_unit_and_null_in_the_others(collides):
    record = account(collides).record
    (one,) = record["findings"]
    assert one["check"] == "collision"
    assert one["value_mm"] == pytest.approx(1.16, abs=0.01)
    assert one["value_MPa"] is one["value_N"] is one["value_ratio"] is None
    assert record["yield"] is None
    assert record["sweep"]["collisions"][0]["cells"] == [1]


def test_the_record_counts_fasteners_and_weighs_bands(works):
    record = account(works).record
    counts = {(one["use"], one["size"]): one["count"] for one in record["fasteners"]}
    assert counts["screw", "ISO 7380-1 M3 x 12"] == counts["nut", "ISO 4032 M3"] == 8
    assert counts["pin", "ISO 8734 3 x 10"] == 9
    inner = record["bands"][0]
    assert inner["scale_0_g"] == pytest.approx(1e3 * inner["tension_0_N"] / 9.80665)
    assert inner["length_0_mm"] == pytest.approx(31.62, abs=0.01)


def test_the_account_of_a_build_computes_nothing(works, monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("an account computes nothing")

    for name in ("builds.sweep", "builds.lay", "builds.build_yield", "builds.findings"):
        monkeypatch.setattr(f"stepwell.build.{name}", refuse)
    forms(account(works))
