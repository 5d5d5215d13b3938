"""CSV curves: whatever machines and people write above and between the numbers."""

import os
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import stepwell as sw
from facts import refuses, says
from stepwell.base import Measure
from stepwell.files import DesignError, load, load_element, loads, text_of
from stepwell.files.curves import WORDS
from stepwell.lab import LabError, MeasuredCurve, Reading, read_curve

TRAVEL, FORCE = (0.0, 1e-3, 3e-3, 5e-3), (0.0, 1.0, -1.0, 1.5)
CSV = "travel_mm,force_N\n0,0\n1,1\n3,-1\n5,1.5\n"
# Time, stroke, force: up and down again.
ROUND = [(0, 0, 0), (1, 2, 1), (2, 4, 0.5), (3, 6, 2), (4, 4, 0.4), (5, 2, 0.8), (6, 0, -0.1)]
CELL = '[chain]\n[[chain.cell]]\nname = "dome"  # mine\n{} = "dome.csv" # measured\nstops = true\n'


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Writes dome.csv into an empty folder, which is then the current one."""
    monkeypatch.chdir(tmp_path)

    def write(text: str | bytes, name: str = "dome.csv") -> str:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        data = text if isinstance(text, bytes) else text.encode()
        (tmp_path / name).write_bytes(data)
        return name

    return write


def refusal(name: str, **options) -> str:
    with pytest.raises(LabError) as caught:
        load_element(name, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        CSV,
        CSV.replace("\n", "\r\n"),
        "\ufeff" + CSV,
        "x [mm];F [N]\n0;0\n1;1\n3;-1\n5;1,5\n",
        "Dome 3, pressed slowly\n\nForce (N)\tDisplacement (mm)\n0\t0\n1\t1\n-1\t3\n1.5\t5\n",
        "Time,Displacement,Load\n(s),(mm),(mN)\n0,0,0\n1,1,1000\n2,3,-1000\n3,5,1500\n",
        "displacement_m,force_kN\n0,0\n1e-3,1e-3\n3e-3,-1e-3\n5e-3,1.5e-3\n",
        "n,travel_mm,width_mm,force_N\n1,0,9,0\n2,1,9,1\n3,3,9,-1\n4,5,9,1.5\n",
    ],
)
def test_columns_are_found_by_their_units_and_names(written, text):
    element = load_element(written(text), stops=True)
    assert element == sw.Element.from_table(TRAVEL, FORCE, "dome", stops=True)


@pytest.mark.parametrize(
    ("head", "measure", "high", "largest"),
    [
        ("volume_ml,pressure_kPa", Measure.VOLUME, 5e-6, 1500.0),
        ("Volume (mL),Pressure (mbar)", Measure.VOLUME, 5e-6, 150.0),
        ("angle_deg,torque_Nmm", Measure.ANGLE, np.radians(5), 0.0015),
        ("Rotation [°],Torque [N m]", Measure.ANGLE, np.radians(5), 1.5),
    ],
)
def test_the_units_say_what_is_measured(written, head, measure, high, largest):
    element = load_element(written(CSV.replace("travel_mm,force_N", head)), stops=True)
    assert element.measure is measure
    assert (element.high, element.largest_force) == pytest.approx((high, largest), rel=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty: export it again."),
        ("travel_mm,force_N\n", "holds no row of two or more numbers: a recording is rows of"),
        (CSV.replace("travel_mm,", "travel,"), "column 'travel' has no unit: must be one of mm,"),
        (
            CSV.replace("travel_mm", "travel_furlong"),
            "column 'travel_furlong' has no unit: must be one of mm, cm, m",
        ),
        (
            CSV.replace("travel_mm,force_N", "a,b"),
            "no column for the travel or volume or angle (columns: a, b): name the columns",
        ),
        (
            CSV.replace("force_N", "pressure_kPa"),
            "columns 'travel_mm' in mm and 'pressure_kPa' in kPa do not belong together: must be "
            "travel and force (mm, N), volume and pressure (mL, kPa) or angle and torque",
        ),
        (
            "a_mm,b_mm,force_N\n0,0,0\n1,4,1\n",
            "columns 'a_mm', 'b_mm' could both be the travel or volume or angle: leave",
        ),
        ("0,0\n1,1\n", "no line above the numbers names the 2 columns: add one, as"),
        (CSV + "6,about 2\n", "line 6 is no row of numbers ('6,about 2'): correct it or take"),
        (CSV + "6,nan\n", "line 6 is no row of numbers ('6 nan')"),
        (
            "travel_mm,force_N\n0,0,\n1,1\n2,1.5\n",
            "2 of 3 rows are no 3 numbers (line 3: '1,1'): export",
        ),
        ("travel_mm,force_N\n0,nan\n1,1\n", "holds 1 row of numbers"),
        (
            CSV + "3,1\n1,0.2\n0,0\n",
            "row 4: the travel turns back at 5 mm, so the file has loading and unloading: give",
        ),
        ("travel_mm,force_N\n0,0\n1,1\n", "the table has 2 points: must have 3 or more"),
        (b"travel_mm,force_N\n\0\1,\2", "is binary, not text"),
    ],
)
def test_a_wrong_file_is_answered_in_one_line(written, text, message):
    assert refusal(written(text)).startswith(f"dome.csv: {message}")


def test_a_file_that_is_not_there_and_a_folder_are_reported(written, tmp_path):
    says(refusal("none.csv"), "none.csv: ", "no such file")
    says(refusal(tmp_path), f"{tmp_path}: ", "a folder")


def test_half_of_a_recording_can_be_taken(written):
    name = written("travel_mm,force_N\n0,0\n2,1\n4,0.5\n6,2\n4,0.4\n2,0.8\n0,-0.1\n")
    up, down = (load_element(name, half=half) for half in ("loading", "unloading"))
    assert up == sw.Element.from_table([0, 2e-3, 4e-3, 6e-3], [0, 1, 0.5, 2], "dome")
    assert down == sw.Element.from_table([0, 2e-3, 4e-3, 6e-3], [-0.1, 0.8, 0.4, 2], "dome")
    says(refusal(written(CSV), half="unloading"), "dome.csv: ", "unloading", "no such half")


def test_rows_that_step_back_a_little_are_sorted_and_rows_at_one_travel_averaged(written):
    name = written("travel_mm,force_N\n0,0\n1,1\n1,1.2\n2.0,3\n1.99,2.9\n3,5\n")
    assert load_element(name, stops=True) == sw.Element.from_table(
        [0, 1e-3, 1.99e-3, 2e-3, 3e-3], [0, (1 + 1.2) / 2, 2.9, 3, 5], "dome", stops=True
    )


def test_noise_larger_than_the_curve_is_refused(written):
    x = np.linspace(0, 6, 80)
    scatter = np.random.default_rng(0).normal(0, 0.3, 80)
    rows = zip(x, np.sin(x) * 0.4 + 0.25 * x + scatter, strict=True)
    name = written("travel_mm,force_N\n" + "".join(f"{a:.6g},{b:.6g}\n" for a, b in rows))
    says(refusal(name, noise=5.0), "dome.csv: ", "from its noise", "5 N")
    says(refusal(name, stops=True), "dome.csv: ", "stretches")


def test_a_file_of_too_many_rows_is_reduced_with_its_error_and_the_limit_can_be_raised(
    written, monkeypatch
):
    x = np.linspace(0, 12, 400)
    force = np.sin(x) + 0.3 * x
    rows = "".join(f"{a:.6f},{b:.6f}\n" for a, b in zip(x, force, strict=True))
    name = written(f"travel_mm,force_N\n{rows}")
    written(CELL.format("table_csv"), "chain.toml")
    monkeypatch.setenv("STEPWELL_LIMITS", "rows=100")
    short = load_element(name, stops=True)
    (sheet,) = short.sheets
    far = np.max(np.abs(short.force_at(x * 1e-3) - force))
    assert len(sheet.rows) <= 150 and (short.low, short.high) == pytest.approx((0, 0.012))
    assert 0 < far <= 1.01 * short.error_band < 0.02
    assert "error_band_N" in text_of("chain.toml")
    assert load("chain.toml").chain.elements[0].error_band == pytest.approx(short.error_band)
    monkeypatch.setenv("STEPWELL_LIMITS", "rows=400")
    assert load_element(name, stops=True).error_band == 0.0


@pytest.mark.parametrize("place", ["[[chain.cell]]\n{}\n", "[chain]\ncell = [{{ {} }}]\n"])
def test_the_keys_of_a_reading_stand_beside_the_name_of_the_file(written, place):
    written("a,b,c\n" + "".join(f"{t},{u},{f}\n" for t, u, f in ROUND))
    keys = ["stroke = 2", 'half = "unloading"', 'table_csv = "dome.csv"', "force = 3"]
    joint = "\n" if place.startswith("[[") else ", "
    keys += ['unit = "cm,mN"', "stops = true", 'flip = "none"']
    written(place.format(joint.join(keys)), "chain.toml")
    (element,) = load("chain.toml").chain.elements
    reading = Reading(2, 3, "cm,mN", "none", "unloading")
    assert element == load_element("dome.csv", "", reading=reading, stops=True)
    assert element.high == pytest.approx(0.06) and element.largest_force == pytest.approx(2e-3)
    assert set(WORDS) == {one.name for one in fields(Reading)}
    assert not any(f"{word} =" in text_of("chain.toml") for word in WORDS)


def test_a_wrong_key_of_a_reading_is_reported_with_its_place(written):
    written(CSV)
    written(CELL.format("table_csv") + 'half = "upper"\n', "chain.toml")
    with refuses(DesignError, "chain.cell[0].table_csv", "half = 'upper'", "loading, unloading"):
        load("chain.toml")


def test_options_that_do_not_go_together_are_refused(written):
    written(CSV)
    with refuses(ValueError, "form = 'spline'", "'table'", "'points'"):
        load_element("dome.csv", form="spline")
    with refuses(ValueError, "half = 'up'", "'loading'", "'unloading'"):
        load_element("dome.csv", half="up")
    with refuses(ValueError, "noise", "form='table'"):
        load_element("dome.csv", form="points", noise=0.1)


@pytest.mark.parametrize("form", ["table", "points"])
def test_a_design_may_name_a_csv_file_beside_it(written, form):
    written(CSV)
    written(CELL.format(f"{form}_csv"), "chain.toml")
    chain = load("chain.toml").chain
    assert chain.cells == (load_element("dome.csv", form=form, stops=True),)


def test_the_text_of_a_design_holds_the_numbers_and_all_else_as_it_was(written):
    written(CSV)
    written(CELL.format("points_csv"), "chain.toml")
    numbers = "points = { travel_mm = [0, 1, 3, 5], force_N = [0, 1, -1, 1.5] }"
    assert text_of("chain.toml") == CELL.format("x").replace('x = "dome.csv"', numbers)
    assert loads(text_of("chain.toml")).subject == load("chain.toml").subject


def test_a_name_in_other_text_or_in_a_comment_names_no_file(written):
    written(CSV)
    said = "'# table_csv = \"none.csv\"'"
    written(f'title = {said} # points_csv = "none.csv"\n{CELL.format("table_csv")}', "chain.toml")
    assert load("chain.toml").subject.title == said.strip("'")


def test_a_curve_that_folds_back_may_come_from_a_file(written):
    written("travel_mm,force_N\n0,0\n4,1\n2,-1\n6,2\n")
    written(CELL.format("curve_csv"), "chain.toml")
    (element,) = load("chain.toml").chain.elements
    assert element == load_element("dome.csv", form="curve", stops=True)
    assert len(element.sheets) == 2


def test_bands_have_laws_from_files_too(written):
    written("extension_mm,tension_N\n0,0\n10,0.31\n20,0.55\n40,1.2\n", "soft.csv")
    written("Extension (mm);Load (N)\n0;0\n10;0,5\n30;1,6\n", "stiff.csv")
    anchors = "p_mm = [-10, 0], q_mm = [20, 0]"
    written(
        '[chain]\nband = { table_csv = "soft.csv", rest_length_mm = 8 }\n[[chain.cell]]\n'
        f"bands = [ {{ {anchors} }}, {{ p_mm = [-10, 4], q_mm = [18, -3], "
        'table_csv = "stiff.csv" } ]',
        "chain.toml",
    )
    soft, stiff = load("chain.toml").chain.levers[0].bands
    wanted = [0, 0.010, 0.020, 0.040], [0, 0.31, 0.55, 1.2]
    assert soft == sw.Band.from_table((-0.010, 0), (0.020, 0), 0.008, *wanted)
    wanted = [0, 0.010, 0.030], [0, 0.5, 1.6]
    assert stiff == sw.Band.from_table((-0.010, 0.004), (0.018, -0.003), 0.008, *wanted)


def told(text: str) -> str:
    (place := os.path.join(os.getcwd(), "chain.toml"))
    with open(place, "w", encoding="utf-8") as file:
        file.write(text)
    with pytest.raises(DesignError) as caught:
        load("chain.toml")
    return str(caught.value)


@pytest.mark.parametrize(
    "name", ["/etc/passwd", "../dome.csv", "below/../../dome.csv", "link.csv", "", "a\\u0000b"]
)
def test_a_design_reads_no_file_outside_its_folder(written, tmp_path, name):
    outside = tmp_path.parent / f"{tmp_path.name}-outside.csv"
    outside.write_text(CSV)
    os.symlink(outside, tmp_path / "link.csv")
    text = CELL.format("table_csv").replace("dome.csv", name)
    says(told(text), f'table_csv = "{name}"', "folder", "design")


def test_a_file_in_a_folder_below_is_read(written):
    written(CSV, "below/dome.csv")
    written(CELL.format("table_csv").replace("dome.csv", "below/dome.csv"), "chain.toml")
    assert load("chain.toml").chain.cells[0].high == 5e-3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            CELL.format("table_csv").replace("dome", "doom"),
            'chain.cell[0].table_csv = "doom.csv": no such file.',
        ),
        (
            '[chain]\ntable_csv = "dome.csv"\n',
            'chain.table_csv = "dome.csv": belongs in the table of a cell, or table_csv in that',
        ),
        (
            '[chain]\nband = { points_csv = "dome.csv" }\n',
            'chain.band.points_csv = "dome.csv": belongs in the table of a cell, or table_csv in',
        ),
        (
            '[chain]\n[[chain.cell]]\nband = { table_csv = "balloon.csv" }\n',
            'chain.cell[0].band.table_csv = "balloon.csv": has volume and pressure: a band has',
        ),
        (
            CELL.format("table_csv") + "table = {}",
            'chain.cell[0].table_csv = "dome.csv": cannot be combined with table: keep one of',
        ),
        ('[chain]\ncell = [{ table_csv\\u0020 = "dome.csv" }]', "line 2, column 20: "),
        (
            '[chain]\ncell = [{ "table_csv" = "dome.csv" }]',
            "names CSV files in an unsupported way: write each such key once",
        ),
        (
            '[chain]\ncell = [{ table_csv = """dome.csv""" }]',
            "names CSV files in an unsupported way",
        ),
        (
            f'{CELL.format("table_csv")}x = """\ntable_csv = "dome.csv"\n"""',
            "names CSV files in an unsupported way",
        ),
    ],
)
def test_a_wrong_name_in_a_design_is_reported_with_its_place(written, text, message):
    written(CSV)
    written("volume_mL,pressure_kPa\n0,0\n1,1\n2,2\n", "balloon.csv")
    assert told(text).startswith(f"chain.toml: {message}")


def test_curves_that_make_a_design_too_long_are_refused(written, monkeypatch):
    written(CSV)
    monkeypatch.setenv("STEPWELL_LIMITS", "design_bytes=200")
    cells = '[[chain.cell]]\ntable_csv = "dome.csv"\n' * 4
    says(told(f"[chain]\n{cells}"), "curves", "bytes", "at most 200")


def made(make: Callable[[], Any]) -> Any:
    """What comes out, or the message, which is one line."""
    try:
        return make()
    except LabError as error:
        message = str(error)
    assert message.isprintable()
    return message


words = st.sampled_from(
    [
        *("travel_mm", "force_N", "Force (N)", "volume_mL", "pressure", "[", ")", '"', "=", "é"),
        *("0", "1", "-2.5", "3", "1e400", "nan", ",", ";", "\t", "\n", "\r\n", "\0", " "),
    ]
)


@given(st.lists(words, max_size=40).map("".join) | st.text(max_size=60))
def test_any_text_is_a_curve_or_a_clean_message(tmp_path_factory, text):
    for content in (text, f"travel_mm,force_N\n{text}", f"{CSV}{text}"):
        file = tmp_path_factory.getbasetemp() / "fuzz.csv"
        file.write_bytes(content.encode("utf-8", "surrogatepass"))
        found = made(partial(load_element, file, stops=True))
        assert isinstance(found, sw.Element) or len(found) < 700 + len(str(file))


@given(st.binary(max_size=200))
def test_any_bytes_are_a_curve_or_a_clean_message(tmp_path_factory, content):
    file = tmp_path_factory.getbasetemp() / "fuzz.csv"
    file.write_bytes(content)
    assert isinstance(made(partial(read_curve, file)), MeasuredCurve | str)
