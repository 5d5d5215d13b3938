"""Readers survive whatever they are given, say so, and drop nothing silently."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from facts import refuses, says
from lab.machine import HEADER, export, recording, there, unit
from stepwell import lab
from stepwell.lab.recordings import rows as _rows
from stepwell.lab.recordings.samples import Specimen, samples

GOOD = HEADER + "0.0 0.0 0.1\r\n0.02 0.1 0.2\r\n0.04 0.2 0.3\r\n"


def written(folder, name, content) -> str:
    file = folder / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
    return str(file)


def tried(data: bytes) -> Specimen | str:
    """What the reader makes of some bytes: numbers, or the line that says why not."""
    try:
        return samples(data)[0]
    except ValueError as error:
        return str(error)


def test_a_bluehill_export_comes_back_in_si(tmp_path):
    found = lab.read(written(tmp_path, "a_1.txt", GOOD))
    assert found.time == pytest.approx([0.0, 0.02, 0.04])
    assert found.stroke == pytest.approx([0.0, 1e-4, 2e-4])
    assert found.force == pytest.approx([0.1, 0.2, 0.3])
    assert (found.rate, found.direction, found.remarks) == (pytest.approx(50.0), "loading", ())
    assert "3 samples" in repr(found)


@pytest.mark.parametrize(
    "text",
    [
        "Time (s),Displacement (mm),Force (N)\n0,0,1\n1,1,2\n",
        "time_s;stroke_mm;force_N\n0;0;1\n1;1;2\n",
        "force [mN]\textension [cm]\n1000\t0\n2000\t0,1\n",
        '"Time","Extension","Load"\n"(s)","(m)","(kN)"\n"0","0","0.001"\n"1","0.001","0.002"\n',
        "Zeit Weg Kraft\n(s) (mm) (N)\n0,0 0,0 1,0\n1,0 1,0 2,0\n",
        "\ufeffTime Displacement Force\n(s) (mm) (N)\n0 0 1\n1 1 2\n\n",
    ],
    ids=["csv", "semicolons", "tabs", "quotes", "decimal commas", "byte order mark"],
)
def test_columns_are_known_by_name_and_unit_in_any_order(text, tmp_path):
    found = lab.read(written(tmp_path, "a.csv", text))
    assert found.stroke == pytest.approx([0.0, 1e-3])
    assert found.force == pytest.approx([1.0, 2.0])


def test_text_of_other_encodings_is_read(tmp_path):
    for k, encoding in enumerate(("utf-16", "latin-1")):
        text = "Operator: Müller\r\n" + GOOD
        found = lab.read(written(tmp_path, f"a_{k}.txt", text.encode(encoding)))
        assert len(found) == 3


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"", "is empty"),
        (b" \r\n \r\n", "is empty"),
        (b"\x00\x01\x02PK\x03", "is binary, not text"),
        ("no numbers at all\n", "holds no row of two or more numbers"),
        ("0 0 1\n1 1 2\n", "no line above the numbers names the 3 columns"),
        (GOOD.replace("(N)", "(kPa)"), "is in 'kPa': must be one of N, mN, kN, lbf, kgf"),
        (GOOD.replace("(mm)", "(furlong)"), "is in 'furlong'"),
        (GOOD.replace("(s) (mm) (N)", "() () ()"), "has no unit"),
        (GOOD.replace("Force", "Colour"), "no column for the force (columns: Time"),
        (HEADER + "0 0 0.1\r\n", "holds 1 row of numbers"),
        (HEADER + "0 0 0.1\r\n1 x 2\r\n2 y 3\r\n3 z\r\n", "'Displacement' [mm] holds no numbers"),
    ],
)
def test_a_file_that_is_no_recording_gets_one_clear_line(content, problem, tmp_path):
    name = written(tmp_path, "broken.txt", content)
    with pytest.raises(lab.LabError) as told:
        lab.read(name)
    assert problem in str(told.value)
    assert str(told.value).startswith(f"{name}: ")
    assert "\n" not in str(told.value)


def test_a_missing_file_and_a_folder_are_reported():
    with refuses(lab.LabError, "none.txt", "no such file"):
        lab.read("none.txt")
    with pytest.raises(lab.LabError, match="it is a folder"):
        lab.read(".")


def test_one_broken_file_stops_no_other_and_none_is_dropped_silently(tmp_path):
    written(tmp_path, "b_10.txt", GOOD)
    written(tmp_path, "b_2.txt", GOOD)
    written(tmp_path, "c.csv", b"\x00")
    written(tmp_path, "notes.md", "not data")
    written(tmp_path, "manifest.csv", "source,kind\na,b\n")
    batch = lab.read_all([tmp_path, tmp_path / "gone.txt"])
    assert [r.name for r in batch.recordings] == ["b_2", "b_10"]
    assert [error.name.rpartition("/")[2] for error in batch.refused] == ["c.csv", "gone.txt"]
    assert [n.rpartition("/")[2] for n in batch.ignored] == ["manifest.csv", "notes.md"]


def test_rows_that_cannot_be_read_are_reported_with_their_line(tmp_path):
    rows = "".join(f"{k} {k} {k}\r\n" for k in range(9))
    cut = lab.read(written(tmp_path, "a.txt", HEADER + rows + "9 9"))
    (remark,) = cut.remarks
    says(remark, "last row", "cut off", "line 13", "'9 9'")
    holed = lab.read(written(tmp_path, "b.txt", HEADER + rows + "nan 9 9\r\n" + rows))
    (remark,) = holed.remarks
    says(remark, "1 row", "left out", "line 13", "'nan 9 9'")
    assert len(holed) == 18


@given(st.binary(max_size=400))
def test_no_bytes_make_the_reader_crash(data):
    export = tried(data)
    if isinstance(export, str):
        assert export
    else:
        assert len(export.time) == len(export.travel) == len(export.force) >= 2


_FIELD = st.one_of(
    st.floats().map(str),
    st.sampled_from(["", "1,5", "-", "e5", "1e400", "(mm)", "٣", "1_0", '"2"', "nan"]),
)


@pytest.mark.slow
@given(
    st.sampled_from([" ", ",", ";", "\t"]),
    st.lists(st.lists(_FIELD, min_size=1, max_size=4), max_size=12),
)
def test_no_table_makes_the_reader_crash_or_lose_a_row_silently(mark, rows):
    head = mark.join(["stroke_mm", "force_N"]) + "\n"
    body = [mark.join(row) for row in rows]
    text = head + "".join(f"{line}\n" for line in ["0" + mark + "0", *body])
    found = tried(text.encode("utf-8"))
    if isinstance(found, str):
        assert found
        return
    lost = 1 + sum(bool(line.strip()) for line in body) - len(found.travel)
    assert lost == 0 or any("left out" in r or "cut off" in r for r in found.remarks)
    assert np.all(np.isfinite(found.travel)) and np.all(np.isfinite(found.force))


@given(st.integers(0, 300), st.integers(0, 255))
def test_one_changed_byte_never_makes_the_reader_crash(place, byte):
    data = bytearray(GOOD.encode("ascii") * 3)
    data[place % len(data)] = byte
    assert tried(bytes(data))


def test_cycles_are_split_at_turning_points_and_noise_is_none():
    up = there(0.010)
    stroke = np.concatenate([up, up[::-1], up, up[::-1]]) + 1e-5 * np.sin(np.arange(4 * len(up)))
    found = recording("a_1.txt", stroke, stroke)
    assert len(found.turns) == 3
    assert [found.direction_of(half) for half in found.halves] == ["loading", "unloading"] * 2
    assert found.direction == "loading and unloading"


def test_the_table_is_tidy_and_names_its_units(tmp_path):
    up = there(0.010)
    runs = [recording("a_1.txt", np.concatenate([up, up[::-1]]), np.ones(2 * len(up)))]
    runs.append(unit("b_1.txt", None))
    rows = lab.table(runs)
    assert {name: rows[name].attrs["units"] for name in ("time", "stroke", "force")} == {
        "time": "s",
        "stroke": "m",
        "force": "N",
    }
    assert rows.sizes["row"] == sum(map(len, runs))
    assert rows["direction"].values[0] == 1
    assert rows["direction"].values[2 * len(up) - 1] == -1
    lab.to_csv(runs, tmp_path / "recordings.csv")
    text = (tmp_path / "recordings.csv").read_text("utf-8").splitlines()
    assert text[0] == "recording,half,direction,time_s,stroke_mm,force_N"
    assert len(text) == 1 + rows.sizes["row"]
    assert lab.table([]).sizes["row"] == 0


def test_what_is_odd_about_a_recording_is_reported():
    up = there(0.020)
    late = recording("a_1.txt", up[50:], 0.1 * np.ones(len(up) - 50))
    says(lab.recording_warnings(late), "starts late", "stroke", f"{up[50] * 1e3:.4g}", "mm")
    bump = 0.5 - 10 * up + np.where(up > 0.0199, 0.7, 0.0)
    told = lab.recording_warnings(recording("a_1.txt", up, bump))
    assert any("end stop?" in line for line in told)
    slack = unit("a_1.txt", None)
    says(lab.recording_warnings(slack), "slack", "jam")
    still = recording("a_1.txt", np.zeros(100), np.zeros(100))
    says(lab.recording_warnings(still), "stroke", "constant")
    plain = recording("a_1.txt", up, 0.5 - 10 * up)
    assert lab.recording_warnings(plain) == ()


def test_what_is_odd_beside_the_other_runs_is_reported():
    up = there(0.020)
    runs = [recording(f"d/a_{k}.txt", up, 0.1 + up) for k in (1, 2, 3, 5)]
    runs.append(recording("d/a_6.txt", up, 0.3 + up))
    runs.append(recording("d/a_7.txt", up[:400], 0.1 + up[:400]))
    told = lab.batch_warnings(runs)
    (gap,) = told["d/a_5.txt"]
    says(gap, "4", "missing")
    (off,) = told["d/a_6.txt"]
    says(off, "mean force", "+0.2 N", "median")
    says(told["d/a_7.txt"], "mm", "20 mm")
    assert "d/a_1.txt" not in told or told["d/a_1.txt"] == ()


def test_an_export_of_the_test_machine_round_trips(tmp_path):
    one = unit("x_1.txt", None, noise=0.01)
    back = lab.read(export(tmp_path / "x_1.txt", one.time, one.stroke, one.force))
    assert back.stroke == pytest.approx(one.stroke, abs=1e-7)
    assert back.force == pytest.approx(one.force, abs=1e-4)


def test_one_bad_row_does_not_make_the_others_slow_or_different(tmp_path, monkeypatch):
    rng = np.random.default_rng(3)
    rows = [f"{x:.6f}, {y:.6f}" for x, y in rng.normal(size=(40, 2))]
    for bad in (0, 7, 19, 20, 39):
        rows[bad] = rng.choice(["", "x, y", "1, 2, 3", '"1", "2"', "nan, 1"])
    file = tmp_path / "run.csv"
    file.write_text("\n".join(["Displacement (mm), Force (N)", "0, 0", *rows, "1, 1"]), "utf-8")
    found = []
    for size in (1, 7, 10**6):
        monkeypatch.setattr(_rows, "CHUNK", size)
        found.append(lab.read(file))
    for one in found[1:]:
        assert np.array_equal(one.stroke, found[0].stroke)
        assert np.array_equal(one.force, found[0].force)
        assert one.remarks == found[0].remarks
