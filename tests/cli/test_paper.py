"""`stepwell paper`: the verdicts shown and the figures written whole or not at all."""

import json

import pytest

from claims import committed
from cli.folders import written
from stepwell import paper
from stepwell.paper.claims import Claim
from stepwell.reports import paper as figures


@pytest.fixture
def verdicts(monkeypatch):
    """The committed verdicts, in the place of those computed anew."""
    known = {verdict.claim.id: verdict for verdict in committed()}
    monkeypatch.setattr(Claim, "judge", lambda claim: known[claim.id])
    return paper.run()


def test_every_claim_is_a_line_with_both_values_and_the_verdict(stepwell, verdicts):
    result = stepwell("paper", "--full")
    assert result.exit_code == 0  # a difference is a result
    lines = result.stdout.partition("Reasons and limits")[0].splitlines()
    for verdict in verdicts:
        (line,) = (line for line in lines if line.startswith(f"{verdict.claim.id} "))
        assert f"  {verdict.verdict}  " in line
        assert f"  {verdict.claim.paper_value}  " in line
        assert f"  {verdict.ours}  " in line


def test_every_reason_is_reported_and_agreement_counted(stepwell, verdicts):
    printed = stepwell("paper", "--full").stdout
    for verdict in verdicts:
        assert not verdict.reason or f"  {verdict.reason}\n" in printed
    agreed = sum(verdict.verdict is paper.Judgement.AGREES for verdict in verdicts)
    assert f"{agreed} of {len(verdicts)} claims agree" in printed


def test_json_holds_every_claim_as_text(stepwell, verdicts):
    record = json.loads(stepwell("paper", "--json").stdout)
    assert record["schema"] == "stepwell.paper/1"
    assert [claim["ours"] for claim in record["claims"]] == [v.ours for v in verdicts]
    assert {type(value) for claim in record["claims"] for value in claim.values()} == {str}
    assert record["files"] == []


@pytest.mark.slow
def test_figures_go_into_the_folder_and_the_command_says_where(
    stepwell, tmp_path, monkeypatch, verdicts
):
    # One figure stands for all: drawing each of them is tested in its own room.
    monkeypatch.setattr(figures, "FIGURES", {"fig1": figures.unit_cells})
    monkeypatch.setattr(figures, "ROBOT_FIGURES", {})
    result = stepwell("paper", "--out", "out")
    names = ["claims.json", "fig1.png", "fig1.svg", "report.html"]
    assert f"Written into out: {', '.join(names)}" in result.stdout
    assert written(tmp_path / "out") == set(names)
    kept = json.loads((tmp_path / "out" / "claims.json").read_text("utf-8"))
    shown = json.loads(stepwell("paper", "--json").stdout)
    assert kept["claims"] == shown["claims"]


@pytest.mark.slow
@pytest.mark.parametrize(("failure", "code"), [(KeyboardInterrupt, 130), (OSError, 1)])
def test_a_failure_leaves_no_figure_behind(
    stepwell, tmp_path, monkeypatch, verdicts, failure, code
):
    def fails():
        raise failure

    monkeypatch.setattr(figures, "FIGURES", {"fig1": figures.unit_cells, "broken": fails})
    assert stepwell("paper", "--out", "out").exit_code == code
    assert [file.name for file in tmp_path.iterdir()] == ["forward.toml"]
