"""`stepwell paper`: the verdicts shown and the figures written whole or not at all."""

import json
from types import SimpleNamespace

import pytest

CLAIMS = (
    SimpleNamespace(id="a", claim="A is 1.", where="Fig. 1", paper_value=1.0, tolerance=0.1),
    SimpleNamespace(id="b", claim="B snaps.", where="Fig. 2", paper_value="yes", tolerance=None),
)
VERDICTS = (
    SimpleNamespace(claim=CLAIMS[0], ours=1.0123456, verdict="agrees", reason=""),
    SimpleNamespace(claim=CLAIMS[1], ours="no", verdict="differs", reason="because"),
)


@pytest.fixture
def room(monkeypatch):
    """A paper room of two claims and one figure; `fails` makes it stop half-way."""
    room = SimpleNamespace(fails=None)

    def run(out=None, progress=None):
        if out is not None:
            (out / "fig1.svg").write_text("<svg/>")
        if room.fails is not None:
            raise room.fails
        return VERDICTS

    monkeypatch.setattr("stepwell.paper.run", run, raising=False)
    return room


def test_every_claim_is_a_line_with_both_values_and_the_verdict(stepwell, room):
    result = stepwell("paper")
    assert result.exit_code == 0  # a difference is a result
    rows = [line.split() for line in result.stdout.splitlines()]
    assert ["a", "Fig.", "1", "1", "1.012", "agrees"] in rows
    assert ["b", "Fig.", "2", "yes", "no", "differs"] in rows
    assert "b: because" in result.stdout
    assert "1 of 2 claims agree." in result.stdout


def test_json_holds_every_claim(stepwell, room):
    record = json.loads(stepwell("paper", "--json").stdout)
    assert record["schema"] == "stepwell.paper/1"
    assert record["claims"][0]["ours"] == 1.0123456
    assert [claim["reason"] for claim in record["claims"]] == ["", "because"]
    assert record["files"] == []


def test_figures_go_into_the_folder(stepwell, room, tmp_path):
    record = json.loads(stepwell("paper", "--json", "--out", "out").stdout)
    assert [tmp_path / name for name in record["files"]] == [tmp_path / "out" / "fig1.svg"]
    assert (tmp_path / "out" / "fig1.svg").read_text() == "<svg/>"


def test_a_failure_leaves_no_figure_behind(stepwell, room, tmp_path):
    room.fails = KeyboardInterrupt()
    assert stepwell("paper", "--out", "out").exit_code == 130
    assert [file.name for file in tmp_path.iterdir()] == ["forward.toml"]
