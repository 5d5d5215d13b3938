"""The accounts of yields and survivals: counts, intervals and other outcomes in every form."""

import pytest

import stepwell as sw
from accounts.schemas import violations
from stepwell.accounts import About, Calibrated, account, card, page, terminal
from stepwell.base import percent
from stepwell.design import Tolerances

# Of levers in closed form and by the engine, a tie, elements of every measure.
_CHAINS = [
    name
    for name in sw.presets()
    if isinstance(sw.preset(name), sw.Chain) and len(sw.preset(name)) <= 4
]
_LOOSE = Tolerances(anchor=2e-3, stiffness=0.1)


@pytest.fixture(scope="module")
def loose():
    return sw.preset("paper-forward").yields(_LOOSE, samples=1000, sensitivity=True)


def _forms(found) -> tuple[str, ...]:
    screen = "\n".join(line.text for line in terminal(found, full=True))
    return (
        screen,
        card(found).replace("&gt;", ">"),
        page(found).replace(" → ", ">").replace("&gt;", ">"),
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", _CHAINS)
def test_the_record_of_every_preset_keeps_to_the_generated_schema(name):
    found = account(sw.preset(name).yields(samples=5))
    assert violations(found.record) == []
    assert all(_forms(found))


def test_states_a_ratio_of_mobilities_and_a_calibration_keep_to_the_schema_too():
    chain = sw.preset("paper-forward")
    given = Calibrated("rubber", {"a.csv": "0" * 64}, "linear", ["k = 28.5 N/m"], 0.02)
    of_states = account(chain.yields(samples=5, target=["00", "10", "11", "01"]))
    robust = account(chain.yields(samples=5, robust=2.0), About(chain, calibrated=given))
    for found in (of_states, robust):
        assert violations(found.record) == []
    assert of_states.record["target_states"] == ["00", "10", "01", "11"]
    assert (robust.record["robust"], robust.record["proved"]) == (2.0, 5)
    assert all("k = 28.5 N/m" in form for form in (_forms(robust)[0], _forms(robust)[2]))


def test_every_form_has_target_yield_tolerances_critical_order_and_other_outcomes(loose):
    low, high = map(percent, loose.interval)
    (other, count), *_ = loose.outcomes.items()
    for form in _forms(account(loose)):
        for text in (
            loose.target,
            f"{percent(loose.fraction)}, with 95 % confidence {low} to {high}",
            "anchors ±2 mm, stiffness ±10 %",
            str(loose.critical),
            other,
            percent(count / loose.samples),
        ):
            assert text in " ".join(form.split())


def test_the_record_has_counts_and_what_each_part_makes_of_the_variance(loose):
    record = account(loose).record
    assert record["successes"] + sum(one["count"] for one in record["outcomes"]) == 1000
    assert record["critical"]["names"] == [*loose.critical.names]
    assert record["gap_deviation_N"] == loose.sensitivities.deviation
    assert [one["part"] for one in record["sensitivities"]] == [*loose.sensitivities.parameters]
    # Tables have the most sensitive part first.
    rows = [line for line in _forms(account(loose))[0].split("\n") if line.startswith("outer.")]
    most = max(record["sensitivities"], key=lambda one: one["total"])
    assert rows[0].startswith(most["part"])


@pytest.mark.slow
def test_forces_of_a_chain_of_pressures_are_in_its_units():
    record = account(sw.preset("balloon").yields(samples=5)).record
    assert "gap_deviation_kPa" in record
    assert {"friction_kPa", "volume_percent"} <= record["tolerances"].keys()


def test_it_is_warned_of_where_no_sample_reproduces_the_target():
    found = account(sw.preset("paper-forward").yields(samples=5, target="00>01>11>10>00"))
    assert found.record["fraction"] == 0.0
    assert [*found.warnings[0].lines] == [found.record["advice"]] != [""]


def test_a_survival_has_its_program_and_its_share():
    chain = sw.preset("force-control")
    program = chain.program("01")
    found = account(chain.survival(program.turning_points, "01", samples=20))
    assert violations(found.record) == []
    record = found.record
    assert record["schema"] == "stepwell.survival/2"
    assert record["turning_points_N"] == [*program.turning_points]
    assert (record["from"], record["target"]) == (program.start, "01")
    screen, shown, made = _forms(found)
    assert all(f"{record['target']} by the program" in form for form in (screen, shown, made))
    assert f"{record['successes']} of 20" in made


def test_the_account_of_a_yield_computes_nothing(loose, monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("an account calls the engine")

    for name in ("path", "cycle", "margin", "program", "graph", "yields"):
        monkeypatch.setattr(sw.Chain, name, refuse)
    monkeypatch.setattr("stepwell.design.tolerances.tally.OutcomeCounter.count", refuse)
    monkeypatch.setattr("stepwell.design.tolerances.draws.Draws.sample", refuse)
    found = account(loose)
    assert found.record and all(_forms(found))
