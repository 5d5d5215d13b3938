"""One reading stands out, or the file is refused with its columns: never silently wrong."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, strategies as st

from facts import refuses, says
from lab.exports import ASKED, BESIDE, FORCE, PLAIN, READ, STANDARD, TIME, WAY, comma, table
from stepwell import lab
from stepwell.files import load_element
from stepwell.mechanism import Element


def read(content: str | bytes, **reading) -> lab.Recording:
    data = content if isinstance(content, bytes) else content.encode()
    return lab.read_bytes(data, "a.csv", lab.Reading(**reading))


def is_right(found: lab.Recording) -> bool:
    """Whether a recording has the strokes and the forces of the made-up test."""
    return (
        len(found) == len(WAY)
        and np.allclose(found.stroke * 1e3, WAY, atol=2e-3)
        and np.allclose(found.force, FORCE, atol=2e-4)
    )


@pytest.mark.parametrize("form", READ)
def test_one_reading_stands_out_and_is_printed(form):
    found = read(READ[form])
    assert is_right(found), found.reading
    says("; ".join(found.reading), "stroke: column", "force: column", "signs: ")


@pytest.mark.parametrize("form", ASKED)
def test_a_choice_is_refused_with_numbered_columns_and_the_command(form):
    content, problem = ASKED[form]
    with pytest.raises(lab.LabError) as told:
        read(content)
    assert problem in told.value.problem and "--" in told.value.problem
    if problem != "may have a decimal comma":
        assert [row[0] for row in told.value.columns] == [
            f"{k}" for k in range(1, len(told.value.columns) + 1)
        ]


@pytest.mark.parametrize(
    ("form", "reading"),
    [
        ("two forces", {"force": 2}),
        ("two forces", {"force": "Force A"}),
        ("no header", {"stroke": 2, "force": 3, "unit": "mm,N"}),
        ("no units", {"unit": "mm,N"}),
    ],
)
def test_what_the_command_says_settles_it(form, reading):
    assert is_right(read(ASKED[form][0], **reading))


def test_a_requested_column_in_a_unit_of_another_kind_is_refused():
    with refuses(lab.LabError, "column 3 'Force' [N]", "as the stroke"):
        read(READ["plain"], stroke=3, force=2, unit="mm,N")
    assert read(READ["plain"], unit="mm,N", stroke=2, force=3) == read(READ["plain"])
    assert read(READ["plain"], unit="cm,N", stroke=2, force=3).stroke[60] == pytest.approx(0.2)


def test_an_element_has_the_curve_of_the_same_reader(tmp_path):
    for k, content in enumerate(READ.values()):
        file = tmp_path / f"a_{k}.xlsx"
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
        found = lab.read_curve(file)
        assert found.travel == pytest.approx(lab.read(file).stroke, abs=1e-12)
        assert found.force == pytest.approx(lab.read(file).force, rel=1e-12)


def test_volume_pressure_and_angle_torque_are_read_as_elements_in_any_spelling(tmp_path):
    for head, measure in (
        ("state,Volume (mL),Pressure (Bar)", "volume"),
        ("Total Time (s),Rotation (deg),Torque (N·m)", "angle"),
    ):
        first = ["up"] * 9 if head.startswith("state") else range(9)
        rows = "".join(f"{a},{k},{k * (12 - k)}\n" for k, a in enumerate(first))
        file = tmp_path / "a.csv"
        file.write_text(f"{head}\n{rows}", "utf-8")
        assert lab.read_curve(file).measure.travel == measure
        with refuses(lab.LabError, "not stroke and", "lab element"):
            lab.read(file)


@pytest.mark.parametrize(
    ("content", "names"),
    [
        (PLAIN + PLAIN, ["a (1).csv", "a (2).csv"]),
        (PLAIN + "\nSpecimen 2\n" + PLAIN, ["a (1).csv", "a (Specimen 2).csv"]),
        (
            f"{STANDARD}\nSample 1\n"
            + PLAIN.split("\n", 1)[1]
            + "Sample 2\n"
            + PLAIN.split("\n", 1)[1],
            ["a (Sample 1).csv", "a (Sample 2).csv"],
        ),
        (table(BESIDE, (WAY, FORCE) * 2), ["a (1).csv", "a (2).csv"]),
        (
            table('"steel",,"brass",\n' + BESIDE, (WAY, FORCE) * 2),
            ["a (steel).csv", "a (brass).csv"],
        ),
    ],
    ids=["headers", "a name between", "names among the rows", "beside", "named above"],
)
def test_every_specimen_of_a_file_is_a_sample_with_its_own_name(content, names, tmp_path):
    found = lab.read_every(content.encode(), "a.csv")
    assert [one.source for one in found] == names
    assert all(map(is_right, found))
    with refuses(lab.LabError, "holds 2 specimens", "--sample 1"):
        read(content)
    assert read(content, sample=2) == lab.read_every(content.encode(), "a.csv")[1] or is_right(
        read(content, sample=2)
    )


def test_signs_that_the_work_leaves_open_are_as_recorded_and_said():
    way = np.linspace(0, 20, 60)
    falls = read(table(STANDARD, (TIME[:60], -way, -way / 20)))
    says(falls.reading, "falls is unloading", "--flip both")
    gives = read(table(STANDARD, (TIME[:60], way, way / 20 - 2)))
    says(gives.reading, "gives off work", "--flip force")
    turned = read(table(STANDARD, (TIME[:60], way, way / 20 - 2)), flip="force")
    assert turned.force == pytest.approx(2 - way / 20)


def test_a_tiny_turn_at_the_start_does_not_decide_the_signs():
    way = np.concatenate([np.linspace(1.4, 0.2, 8), np.linspace(0.3, 15, 60), [9.0, 4.0]])
    time = np.arange(len(way)) / 10
    assert read(table(STANDARD, (time, way, 5 + way))).stroke * 1e3 == pytest.approx(way)


def test_a_part_is_a_half_or_a_cycle():
    two = table(
        STANDARD, [np.concatenate([c, c + k]) for c, k in ((TIME, 13), (WAY, 0), (FORCE, 0))]
    )
    assert len(read(two, half="loading")) == 61
    second = read(two, half="unloading", cycle=2)
    assert second.stroke[0] == pytest.approx(0.02) and second.force[-1] == pytest.approx(0)
    assert is_right(read(two, cycle=2)) or len(read(two, cycle=2)) == 122
    with refuses(lab.LabError, "cycle = 3", "no such half"):
        read(two, cycle=3)


def test_the_reading_kept_in_a_folder_is_used_for_all_its_files_and_can_be_overruled(tmp_path):
    reading = lab.Reading(2, 3, "mm,N", "none", skip=1)
    assert reading.options == "--stroke 2 --force 3 --unit mm,N --flip none --skip 1"
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("# mine\n" + table("", (TIME, WAY, FORCE)).lstrip(), "utf-8")
    assert len(lab.read_all([tmp_path]).refused) == 2
    lab.save_reading(reading, tmp_path)
    batch = lab.read_all([tmp_path])
    assert all(map(is_right, batch.recordings)) and len(batch.recordings) == 2
    turned = lab.read(tmp_path / "a.csv", lab.Reading(flip="force"))
    assert turned.force == pytest.approx(-FORCE)
    (tmp_path / lab.READING_FILE).write_text("stroke = 2\nforces = 3\n", "utf-8")
    with refuses(lab.LabError, "recording.toml", "forces", "mean force?"):
        lab.read(tmp_path / "a.csv")


_NAMES = {
    "stroke": ("Displacement", "Extension", "Weg", "Déplacement", "Travel", "u"),
    "force": ("Force", "Load", "Kraft", "Standard force", "F"),
    "time": ("Time", "Zeit", "t", "Elapsed time"),
}
_UNITS = {"stroke": {"mm": 1, "cm": 0.1, "um": 1000, "m": 1e-3}, "force": {"N": 1, "mN": 1e3}}
_OTHERS = {
    "Temperature (°C)": 21 + TIME / 90,
    "Force setpoint (N)": 0 * TIME + 3,
    "Displacement command (mm)": np.where(TIME < 6, 20.0, 0.0),
    "Max force (N)": np.maximum.accumulate(FORCE),
    "Raw counts": 8000 + 100 * FORCE,
    "Cycle": np.ones(121),
    "Stress (MPa)": 2 * FORCE,
    "Speed (mm/s)": np.gradient(WAY),
    "Force (N)": 1.1 * FORCE + 0.01,
    "Width (mm)": 5 - WAY / 90,
}


@st.composite
def odd_forms(draw) -> bytes:
    """The made-up test in an odd form: names, units, marks, other columns, signs, encodings."""
    mark = draw(st.sampled_from([",", ";", "\t"]))
    form = draw(st.sampled_from([str, comma] if mark != "," else [str]))
    style = draw(st.sampled_from(["{} ({})", "{} [{}]", "{}/{}", "{}_{}", "{}, {}", "{} in {}"]))
    style = style if mark != "," else style.replace(", ", " ")
    sign = draw(st.sampled_from([(1, 1), (1, 1), (-1, -1), (1, -1)]))
    columns = []
    for kind, values in (("time", TIME), ("stroke", sign[0] * WAY), ("force", sign[1] * FORCE)):
        name = draw(st.sampled_from(_NAMES[kind]))
        unit = draw(st.sampled_from([*_UNITS.get(kind, {"s": 1})]))
        columns.append((name, unit, values * _UNITS.get(kind, {"s": 1})[unit]))
    below = draw(st.booleans())
    others = draw(st.lists(st.sampled_from([*_OTHERS]), max_size=3, unique=True))
    heads = [(n, f"({u})") if below else (style.format(n, u), "") for n, u, _ in columns]
    heads += [(one, "") for one in others]
    every = [values for *_, values in columns] + [_OTHERS[one] for one in others]
    order = draw(st.permutations(range(len(every))))
    lines = [mark.join(heads[k][0] for k in order)]
    lines += [mark.join(heads[k][1] for k in order)] if below else []
    lines[:0] = draw(st.lists(st.sampled_from(["Operator: A", "Specimen 4", "", "Date,2.3"])))
    text = table("\n".join(lines), [every[k] for k in order], mark, form)
    end = draw(st.sampled_from(["\n", "\r\n"]))
    encoding = draw(st.sampled_from(["utf-8", "utf-8-sig", "cp1252", "utf-16"]))
    return text.replace("\n", end).encode(encoding)


@pytest.mark.slow
@given(odd_forms())
def test_no_odd_form_of_one_recording_is_silently_wrong(data):
    try:
        found = lab.read_bytes(data, "a.csv")
    except lab.LabError:
        return
    assert is_right(found), (data[:300], found.reading)


@pytest.mark.slow
def test_a_long_file_is_read_into_an_element_in_little_memory(tmp_path):
    x = np.linspace(0, 12, 150_000)
    rows = np.char.add(np.char.mod("%.6f,", x), np.char.mod("%.5f\n", np.sin(x) + 0.3 * x))
    file = tmp_path / "long.csv"
    file.write_text("Displacement (mm),Force (N)\n" + "".join(rows), "utf-8")
    del rows
    tracemalloc.start()
    try:
        made = load_element(file, stops=True)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 45e6
    assert isinstance(made, Element) and made.high == pytest.approx(0.012)
    assert 0 < made.error_band < 1e-3
