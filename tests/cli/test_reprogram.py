"""`stepwell reprogram`: displacement, force, files, refusals."""

import csv
import json

import pytest

import stepwell as sw
from cli.folders import written
from stepwell.accounts import account, terminal
from stepwell.cli.design import along
from stepwell.design import reprogram

BACK = "00>01>11>10>00"


def test_the_account_of_the_reprogramming_is_printed(stepwell):
    result = stepwell("reprogram", "forward.toml", "--by", "inner.p", "--target", BACK)
    expected = reprogram(sw.load("forward.toml"), BACK, "inner.p")
    assert result.exit_code == 0
    assert result.stdout.splitlines() == [line.text for line in terminal(account(expected))]


def test_json_alone_says_everything(stepwell):
    options = ("--by", "outer.q", "--along", "0:1", "--one-way", "--json")
    record = json.loads(stepwell("reprogram", "forward.toml", *options).stdout)
    result = reprogram(sw.load("forward.toml"), None, "outer.q", along=(0, 1), one_way=True)
    assert record["schema"] == "stepwell.reprogram/2"
    assert record["possible"]
    assert record["displacement_mm"] == [part * 1e3 for part in result.move]
    assert record["after"] == result.after
    assert record["way"][-1]["at_mm"] == pytest.approx(record["displacement_mm"])
    assert record["way"][-1]["force_at_0_N"] == result.resistance.force_0[-1]
    assert record["work_at_1_mJ"] == result.resistance.work_1 * 1e3


def test_the_folder_holds_the_design_past_the_change_and_the_way(stepwell, tmp_path):
    options = ("--by", "inner.p", "--target", BACK, "--out", "out", "--json")
    record = json.loads(stepwell("reprogram", "forward.toml", *options).stdout)
    out = tmp_path / "out"
    names = {"design.toml", "report.html", "reprogram.json", "way.csv"}
    assert written(out) == names
    assert {tmp_path / name for name in record.pop("files")} == {out / name for name in names}
    assert record == json.loads((out / "reprogram.json").read_text())
    assert str(sw.load(out / "design.toml").cycle().sequence) == BACK
    with open(out / "way.csv", newline="") as file:
        assert len(list(csv.DictReader(file))) == len(record["way"])


def test_where_nothing_in_reach_does_it_the_code_is_3(stepwell, tmp_path):
    options = ("--by", "inner.p", "--reach", 1, "--out", "out")
    result = stepwell("reprogram", "forward.toml", *options)
    assert result.exit_code == 3
    assert "No displacement of inner.p up to 1 mm gives another sequence" in result.stdout
    assert written(tmp_path / "out") == {"report.html", "reprogram.json"}
    record = json.loads(
        (tmp_path / "out" / "reprogram.json").read_text(), parse_constant=pytest.fail
    )
    assert not record["possible"]
    assert record["distance_mm"] is None
    assert record["displacement_mm"] == record["place_mm"] == [None, None]


def test_what_it_does_already_needs_no_displacement(stepwell):
    options = ("--by", "inner.p", "--target", "00>10>11>01>00")
    result = stepwell("reprogram", "forward.toml", *options)
    assert result.exit_code == 0
    assert "00>10>11>01>00 already" in result.stdout


def test_a_direction_is_reported_by_two_numbers_or_an_angle():
    assert along("-1:2") == (-1.0, 2.0)
    assert along("90") == pytest.approx((0.0, 1.0))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "Missing option '--by'"),
        (("--by", "inner.q.x"), "must be an anchor, for example 'inner.p' or 'outer.q'."),
        (("--by", "iner.p"), "Did you mean 'inner.p'?"),
        (("--by", "inner.p", "--target", "00>11"), "00>11"),
        (("--by", "inner.p", "--along", "0:0"), "'0:0': must be X:Y, as in -1:0, or degrees"),
        (("--by", "inner.p", "--along", "1:2:3"), "'1:2:3': must be X:Y"),
        (("--by", "inner.p", "--along", "nan"), "'nan': must be X:Y"),
        (("--by", "inner.p", "--one-way"), "--one-way: needs --along X:Y, the direction."),
    ],
)
def test_wrong_input_ends_in_code_2_with_what_is_allowed(stepwell, arguments, message):
    result = stepwell("reprogram", "forward.toml", *arguments)
    assert result.exit_code == 2
    assert message in result.output
