"""The account of a study: each number once, the same in every form."""

import pytest

import stepwell as sw
from accounts.schemas import violations
from stepwell.accounts import account, card, page, terminal
from stepwell.design import Tolerances
from stepwell.studies import Axis, How, Space, Study, Workshop, sweep

LEG = sw.preset("paper-forward")
PLANE = Axis("outer.q.x", 0.0, 0.020, 2), Axis("outer.q.y", -0.015, 0.015, 2)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    space = Space(PLANE, How.LATIN, 60, 0)
    return sweep(LEG, "cycle", space, tmp_path_factory.mktemp("s") / "a.zarr", workers=0)


def _text(found) -> str:
    return "\n".join(line.text for line in terminal(found, full=True))


@pytest.mark.parametrize(
    ("what", "given", "designs"),
    [
        ("margin", {}, Space(PLANE)),
        ("graph", {}, Workshop(Tolerances(anchor=1e-4), 2, 0)),
        ("program", {"target": "01"}, Space(PLANE)),
    ],
)
def test_the_record_of_every_kind_of_study_keeps_to_the_generated_schema(
    what, given, designs, tmp_path
):
    found = account(sweep(LEG, what, designs, tmp_path / "a.zarr", given=given, workers=0))
    assert violations(found.record) == []
    assert _text(found) and card(found) and page(found)


@pytest.mark.slow
def test_every_form_has_the_most_frequent_outcome_with_its_interval(study):
    found = account(study)
    assert violations(found.record) == []
    first = found.record["outcomes"][0]
    assert first["fraction_low"] < first["fraction"] < first["fraction_high"]
    for form in (_text(found), card(found), page(found)):
        assert f"{first['fraction'] * 100:.1f} %" in form
        assert "95 % confidence" in form


def test_ends_are_in_the_units_of_their_rows_and_what_chance_could_make_is_not_shown(study):
    found = account(study)
    x, _ = found.record["varied"]
    assert x == {"parameter": "outer.q.x", "unit": "mm", "from": 0.0, "to": 20.0}
    for one, decided in zip(found.record["decided"], study.decided, strict=True):
        sure = [each for each in one["influences"] if each["fraction"] > one["floor"]]
        assert [each["parameter"] for each in sure] == [each.name for each in decided.sure]


def test_the_account_of_a_study_reads_no_store(study, monkeypatch):
    assert account(study).record

    def refuse(*_, **__):
        raise AssertionError("an account reads the store")

    for name in ("values", "missing", "done_chunks"):
        monkeypatch.setattr(Study, name, refuse)
    found = account(study)
    assert found.record and terminal(found) and card(found) and page(found)
