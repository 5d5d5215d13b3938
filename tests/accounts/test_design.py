"""The account of a design: what to build and how surely it works, or why there is none."""

import pytest

import stepwell as sw
from accounts.schemas import violations
from stepwell.accounts import account, card, page, terminal
from stepwell.base import number, percent
from stepwell.design import Impossible
from stepwell.mechanism import LIBRARY

BACK = "00>01>11>10>00"


@pytest.fixture(scope="module")
def back():
    return sw.design(BACK, samples=40)


@pytest.fixture(scope="module")
def scaled():
    elements = [LIBRARY[kind].make(name=kind) for kind in ("trilinear", "curved-beam")]
    return sw.design("00>10>11>01>00", elements=elements, actuator_stiffness=0.0, samples=20)


def _forms(found) -> tuple[str, ...]:
    screen = "\n".join(line.text for line in terminal(found, full=True))
    made = page(found).replace(" → ", ">").replace("\N{MINUS SIGN}", "-")
    return screen, card(found).replace("&gt;", ">"), made


def test_every_form_has_the_sequence_the_anchors_the_yield_and_the_method(back):
    found = account(back)
    assert violations(found.record) == []
    low, high = map(percent, back.yield_.interval)
    for form in _forms(found):
        for text in (
            BACK,
            f"with 95 % confidence {low} to {high}",
            "outer moves before inner",
            "lattices",
        ):
            assert text in form
        for cell in back.chain.cells:
            assert number(cell.bands[0].q[1] * 1e3) in form
            assert number(cell.force_0) in form


def test_the_record_has_cells_in_file_units_and_the_cycle(back):
    record = account(back).record
    assert (record["possible"], record["largest_gap_N"]) == (True, None)
    assert (record["sequence"], record["loading_order"]) == (BACK, [1, 0])
    for one, cell in zip(record["cells"], back.chain.cells, strict=True):
        assert one["q_mm"] == pytest.approx([v * 1e3 for v in cell.bands[0].q])
        assert one["F1_N"] == cell.force_1
    assert record["robustness"]["radius_mm"] == pytest.approx(back.robustness.radius * 1e3)
    assert record["robustness"]["fraction"] is None
    assert record["yield"]["fraction"] == back.yield_.fraction
    assert record["seed"] == record["yield"]["seed"] == 0


def test_a_page_and_a_terminal_have_robustness_and_reachable_states(back):
    screen, shown, made = _forms(account(back))
    for form in (screen, made):
        assert f"deviate by {back.robustness.radius * 1e3:.4g} mm at once" in form
        assert "4 states: 00, 10, 01, 11" in form
    assert "4 states" not in shown


def test_a_card_follows_no_branch(back, monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("a card calls the engine")

    again = sw.design(BACK, samples=20)
    for name in ("reached", "robustness"):
        monkeypatch.setattr(f"stepwell.design.synthesis.designed.{name}", refuse)
    assert card(account(again))


@pytest.mark.slow
def test_elements_have_scales_and_a_share_of_their_forces(scaled):
    found = account(scaled)
    record = found.record
    assert violations(record) == []
    assert [one["force_scale"] for one in record["cells"]] == [
        cell.force_scale for cell in scaled.chain.elements
    ]
    assert record["robustness"]["fraction"] == scaled.robustness.fraction
    assert record["robustness"]["radius_mm"] is None
    assert all("curved-beam" in form and "scale" in form for form in _forms(found))
    # A column with the same in every row shows nothing.
    assert "mobility  " not in _forms(found)[0]


@pytest.mark.slow
def test_of_long_chains_states_are_counted_and_not_listed():
    found = account(sw.design(states="all", cells=13, samples=5))
    assert violations(found.record) == []
    assert (found.record["state_count"], found.record["states"]) == (2**13, None)
    assert "8192 states" in _forms(found)[0]


def test_where_there_is_none_the_record_has_the_reason_and_null():
    with pytest.raises(Impossible) as why:
        sw.design(BACK, holes=0.04)
    found = account(why.value)
    record = found.record
    assert violations(record) == []
    assert (record["possible"], record["proved"], record["cells"]) == (False, True, None)
    assert record["gap_needed_N"] == why.value.gap_needed
    assert record["design_sha256"] is None
    assert all("is needed" in " ".join(form.split()) for form in _forms(found))


def test_a_robustness_has_a_card_and_no_record(back):
    assert str(back.robustness)[:20].lower() in card(account(back.robustness)).lower()
    assert account(back.robustness).kind == ""


def test_the_account_of_a_design_computes_nothing_that_the_design_has(back, monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("an account calls the engine")

    # Computed when they are asked for, once.
    assert back.reached.whole and back.robustness is not None
    for name in ("path", "cycle", "margin", "graph", "yields", "robustness"):
        monkeypatch.setattr(sw.Chain, name, refuse)
    for name in ("reached", "robustness"):
        monkeypatch.setattr(f"stepwell.design.synthesis.designed.{name}", refuse)
    found = account(back)
    assert found.record and all(_forms(found))
