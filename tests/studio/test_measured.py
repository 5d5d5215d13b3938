"""Recordings beside the design in the page: what is told is what the lab says."""

import base64
import gzip
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stepwell as sw
from lab.machine import export, pair, unit
from stepwell import lab
from stepwell.files import dumps, loads_tables, tables_in
from stepwell.mechanism import Band, Cell, Chain
from studio.test_panels import ask, tables

CELL = """
[chain]
lever_mm = 14.142135623730951
limit_deg = 45
band = { stiffness_N_per_m = 28.5, rest_length_mm = 10 }
[[chain.cell]]
p_mm = [-10, 0]
q_mm = [20, 0]
"""
HEADER = b"Time (s),Displacement (mm),Force (N)\n"


def packed(name: str, content: bytes) -> dict[str, str]:
    return {"name": name, "gzip_base64": base64.b64encode(gzip.compress(content, mtime=0)).decode()}


@pytest.fixture
def runs(tmp_path: Path) -> list[Path]:
    """A pair that is a little stiffer than its design, both ways, with its baseline."""
    chain = sw.preset("paper-forward")
    stiff = Chain([_with(cell, 38.0, 0.010) for cell in chain.levers])
    both = [
        *(pair(f"mine_{k}.txt", stiff, seed=k) for k in (1, 2)),
        *(pair(f"back_{k}.txt", stiff, seed=k, unloading=True) for k in (1, 2)),
        pair("friction_1.txt", None),
        pair("back_friction_1.txt", None, unloading=True),
    ]
    return [export(tmp_path / one.source, one.time, one.stroke, one.force) for one in both]


def _with(cell: Cell, stiffness: float, rest_length: float) -> Cell:
    (band,) = cell.bands
    return replace(cell, band=(replace(band, stiffness=stiffness, rest_length=rest_length),))


@pytest.mark.slow
def test_the_page_shows_the_results_of_the_lab_for_a_pair(runs: list[Path]):
    header, blocks = ask(
        "measured",
        tables("paper-forward"),
        files=[packed(run.name, run.read_bytes()) for run in runs],
    )
    chain = sw.preset("paper-forward")
    recordings = [lab.read_bytes(run.read_bytes(), run.name) for run in runs]
    comparison = lab.compare(recordings, [chain], as_designed=True)
    assert [one["verdict"] for one in header["series"]] == [t.verdict for t in comparison.tests]
    for shown, test in zip(header["series"], comparison.pairs, strict=True):
        assert shown["rms_N"] == test.rmse * test.series.scale
        assert shown["baseline"] == [run.source for run in test.series.baseline]
        (predicted,) = test.snaps_predicted
        assert [one["run"] for one in shown["snaps"]] == shown["runs"]
        for one, (measured,) in zip(shown["snaps"], test.snaps, strict=True):
            assert one["predicted_mm"] == predicted * 1e3
            assert one["measured_mm"] == measured * 1e3
            assert one["difference_mm"] == (measured - predicted) * 1e3
    odd = lab.Batch(tuple(recordings), ()).odd
    assert [one["odd"] for one in header["files"]] == [list(lines) for lines in odd]
    fit = lab.refit(comparison)
    assert header["fit"]["stiffness_N_per_m"] == fit.stiffness
    assert header["fit"]["rms_before_N"] == fit.before > 2 * fit.after
    assert fit.stiffness == pytest.approx(38, rel=0.1)
    taken = header["fit"]["design"]
    # JSON holds millimetres as floats, so that metres may differ in their last digit.
    made, meant = loads_tables(taken).chain, replace(fit.chain, title=chain.title)
    assert repr(made) == repr(meant)
    for one, other in zip(made.levers, meant.levers, strict=True):
        (band,), (fitted,) = one.bands, other.bands
        assert (band.p, band.q, band.law) == (fitted.p, fitted.q, fitted.law)
        assert band.stiffness == pytest.approx(fitted.stiffness, rel=1e-15)
        assert band.rest_length == pytest.approx(fitted.rest_length, rel=1e-15)
    assert taken["chain"]["cell"] == tables("paper-forward")["chain"]["cell"]
    assert np.all(np.diff(blocks["stroke 0"])[np.diff(blocks["segment 0"]) == 0] >= 0)


def test_the_bands_of_a_cell_are_found_again():
    truth = Cell(Band((-0.010, 0.0), (0.020, 0.0), 40.0, 0.008))
    design = sw.Chain([_with(truth, 28.5, 0.010)])
    both = [unit(f"mine_{way}.txt", truth, unloading=way, friction=0.0) for way in (False, True)]
    fit = lab.refit(lab.compare(both, [design], as_designed=True))
    assert fit.stiffness == pytest.approx(40, rel=1e-2)
    assert fit.rest_length == pytest.approx(0.008, rel=2e-2)
    assert fit.after < 1e-3 < fit.before


def test_a_fit_that_no_recording_can_tell_says_why(tmp_path: Path):
    run = unit("mine_1.txt", Cell(Band((-0.010, 0.0), (0.020, 0.0))))
    written = export(tmp_path / run.source, run.time, run.stroke, run.force).read_bytes()
    text = CELL.replace("rest_length_mm = 10", "cubic_per_mm2 = 0.0003")
    header = ask("open", toml=text).header
    answer = ask("measured", header["design"], files=[packed("mine_1.txt", written)]).header
    assert answer["fit"] is None
    assert "linear law" in answer["why_no_fit"]
    assert answer["series"][0]["verdict"]


def test_longer_chains_and_the_legs_of_robots_have_their_curves(runs: list[Path]):
    files = [packed(run.name, run.read_bytes()) for run in runs[:1]]
    header = ask("measured", tables("three-wave"), files=files).header
    assert header["series"][0]["verdict"] == ""
    assert "3 cells" in header["notes"][0]
    robot = tables("robot-forward")
    leg = ask("measured", robot, leg=1, files=files).header
    assert leg["series"][0]["verdict"].startswith("order agrees")
    fitted = loads_tables(leg["fit"]["design"]).robot.legs[1].chain.levers[0].bands[0]
    assert fitted.stiffness == leg["fit"]["stiffness_N_per_m"]


def test_no_line_is_drawn_across_a_gap():
    rows = [(k / 50, k / 100, 1.0) for k in range(4000) if not 1000 < k < 2000]
    text = HEADER + b"".join(b"%f,%f,%f\n" % row for row in rows)
    header, blocks = ask("measured", tables("paper-forward"), files=[packed("gap.csv", text)])
    stroke, segment = blocks["stroke 0"], blocks["segment 0"]
    assert set(segment) == {0, 1}
    assert stroke[segment == 0].max() <= 10 < 20 <= stroke[segment == 1].min()
    assert any("gap" in line for line in header["files"][0]["odd"])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" * 9, "is binary"),
        (b"a,b,c\n1,2,3\n4,5,6\n", "no column for the stroke"),
        (b"Time (s),Displacement (ft),Force (N)\n0,0,0\n1,1,1\n", "is in 'ft'"),
        (HEADER + b"0,nan,0\n1,nan,1\n", "holds no numbers"),
        (HEADER + b"0,0,0\n" * 3_000_000, "is too long"),
    ],
)
def test_what_is_no_recording_gets_a_line_and_stops_no_other(content: bytes, words: str, runs):
    files = [packed("../../bad.csv", content), packed(runs[0].name, runs[0].read_bytes())]
    header = ask("measured", tables("paper-forward"), files=files).header
    assert words in " ".join([*header["refused"], header["tables"][0]["problem"]])
    assert not header["refused"] or header["refused"][0].startswith("bad.csv: ")
    assert [one["name"] for one in header["files"]] == ["mine_1.txt"]
    assert header["series"][0]["verdict"]


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_a_stroke_in_another_unit_is_reported(factor: float, runs: list[Path]):
    one = lab.read(runs[0])
    rows = zip(one.time, one.stroke * 1e3 * factor, one.force, strict=True)
    text = HEADER + b"".join(b"%f,%f,%f\n" % row for row in rows)
    header = ask("measured", tables("paper-forward"), files=[packed("m.csv", text)]).header
    assert "check the unit in the header" in header["notes"][0]
    assert header["series"] == []
    with pytest.raises(lab.LabError, match="check the unit"):
        lab.compare([lab.read_bytes(text, "m.csv")], [sw.preset("paper-forward")])


def test_time_that_runs_back_is_reported():
    rows = [((2000 - k) / 50, k / 50, 1.0) for k in range(2000)]
    text = HEADER + b"".join(b"%f,%f,%f\n" % row for row in rows)
    header = ask("measured", tables("paper-forward"), files=[packed("back.csv", text)]).header
    assert any("decreases" in line for line in header["files"][0]["odd"])


@pytest.mark.parametrize(
    "files",
    [
        None,
        [],
        ["/etc/passwd"],
        [{"name": "a"}],
        [{"name": 1, "gzip_base64": ""}],
        [{"name": "a", "gzip_base64": "", "path": "/etc/passwd"}],
        [{}] * 33,
    ],
)
def test_files_are_asked_for_within_bounds(files: Any):
    assert not ask("measured", tables("paper-forward"), files=files).header["ok"]


@pytest.mark.parametrize("data", ["?", "", "aGFsbG8=", packed("a", b"x" * 999)["gzip_base64"][:16]])
def test_what_does_not_arrive_whole_is_reported(data: str):
    files = [{"name": "a.csv", "gzip_base64": data}]
    (line,) = ask("measured", tables("paper-forward"), files=files).header["refused"]
    assert line == "a.csv: did not arrive whole: choose it again."


def test_chains_of_volumes_and_of_forces_are_refused_in_words():
    for name in ("balloon", "force-control"):
        files = [packed("a.csv", HEADER + b"0,0,0\n1,1,1\n")]
        header = ask("measured", tables(name), files=files).header
        assert "stroke in mm" in header["notes"][0] and not header["series"]


def test_a_recording_is_read_from_its_bytes(runs: list[Path]):
    assert lab.read_bytes(runs[0].read_bytes(), str(runs[0])) == lab.read(runs[0])


def test_a_recording_toml_among_the_files_says_how_they_are_read_as_in_the_lab(tmp_path: Path):
    rows = b"".join(b"%f,%f\n" % (k / 50, k / 100) for k in range(200))
    table, how = tmp_path / "log.csv", tmp_path / lab.READING_FILE
    table.write_bytes(b"a,b\n" + rows)
    how.write_text('stroke = 1\nforce = 2\nunit = "mm,N"\n', "utf-8")
    design = tables("paper-forward")
    header = ask("measured", design, files=[packed("log.csv", table.read_bytes())]).header
    assert header["files"] == []
    assert [row[:2] for row in header["tables"][0]["columns"]] == [["1", "a"], ["2", "b"]]
    files = [packed(one.name, one.read_bytes()) for one in (table, how)]
    (found,) = ask("measured", design, files=files).header["files"]
    assert found["reading"] == "; ".join(lab.read(table).reading)
    how.write_text("force = 0\n", "utf-8")
    files = [packed(one.name, one.read_bytes()) for one in (table, how)]
    refused = ask("measured", design, files=files).header["refused"]
    assert refused[0].startswith("recording.toml: force = 0")


def test_a_reading_of_the_page_is_that_of_the_lab(tmp_path: Path):
    rows = b"".join(b"%f,%f,%f\n" % (k / 50, k / 80, k / 100) for k in range(200))
    table = tmp_path / "log.csv"
    table.write_bytes(b"A (mm),B (mm),C (N)\n" + rows)
    keys = {"stroke": 2, "force": 3, "unit": "mm,N", "flip": "none", "half": "loading", "skip": 0}
    design, files = tables("paper-forward"), [packed("log.csv", table.read_bytes())]
    unclear = ask("measured", design, files=files).header["tables"][0]
    with pytest.raises(lab.LabError) as refused:
        lab.read(table)
    assert refused.value.problem.startswith(f"{unclear['problem']}; or give --stroke")
    assert [tuple(row) for row in unclear["columns"]] == list(refused.value.columns)
    header = ask("measured", design, files=files, reading=keys).header
    reading = lab.Reading.of(keys)
    assert header["files"][0]["reading"] == "; ".join(lab.read(table, reading).reading)
    assert header["toml"] == lab.save_reading(reading, tmp_path).read_text("utf-8")
    assert [row[4] for row in header["tables"][0]["columns"]] == ["", "the stroke", "the force"]
    wrong = ask("measured", design, files=files, reading={"force": 0}).header
    assert "force = 0" in wrong["refused"][0] and wrong["tables"][0]["columns"]


def test_an_element_of_the_page_is_that_of_the_lab():
    x = np.linspace(0, 20, 300)
    rows = zip(x, 0.5 * np.sin(x / 20 * 2 * np.pi) + 0.05 * x, strict=True)
    text = b"Displacement (mm),Force (N)\n" + b"".join(b"%f,%f\n" % row for row in rows)
    header = ask("element", None, **packed("clip.csv", text)).header
    measured = lab.measure_element(lab.read_bytes(text, "clip.csv"))
    assert (
        loads_tables(header["design"]).subject
        == loads_tables(tables_in(dumps(measured.chain))).subject
    )
    assert header["text"] == str(measured)


def test_every_specimen_of_a_file_is_a_recording_of_its_own():
    rows = b"".join(b"%f,%f,%f\n" % (k / 50, k / 100, k / 900) for k in range(200))
    text = HEADER + rows + HEADER + rows
    files = ask("measured", tables("paper-forward"), files=[packed("two.csv", text)]).header[
        "files"
    ]
    assert [one["name"] for one in files] == ["two (1).csv", "two (2).csv"]
