"""One step from a table made at home to a band, with as much doubt as it has."""

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from typer.testing import CliRunner

from facts import refuses, says
from lab.kitchen import GRAVITY, extensions, pulled, rubber, spring, table
from sizes import examples
from stepwell import files, lab
from stepwell.accounts import About, account
from stepwell.cli import app
from stepwell.lab.bands.choice import this_band

SEVEN = "length (mm),weight (g)\n62,0\n66.5,20\n71,40\n77,60\n84.5,80\n91.5,100\n96.5,120\n"
PULLS = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0]


def read(header: str, rows: str = "60,10\n70,20\n75,30\n") -> lab.Recording:
    return pulled(f"{header}\n{rows}")


@pytest.mark.parametrize(
    ("unit", "newtons"),
    [
        *(("g", GRAVITY * 1e-3), ("gf", GRAVITY * 1e-3), ("kg", GRAVITY), ("kgf", GRAVITY)),
        *(("oz", 0.2780138509537812), ("ozf", 0.2780138509537812)),
        *(("lb", 4.4482216152605), ("lbf", 4.4482216152605)),
        *(("G", GRAVITY * 1e-3), ("KG", GRAVITY), ("Kg", GRAVITY), ("LBF", 4.4482216152605)),
        *(("mN", 1e-3), ("N", 1.0), ("kN", 1e3)),
    ],
)
def test_a_weight_pulls_with_its_force_in_every_unit_of_a_kitchen(unit, newtons):
    found = read(f"length (mm),weight ({unit})")
    assert found.force == pytest.approx(np.array([10, 20, 30]) * newtons, rel=1e-12)


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("mm", 1e-3), ("MM", 1e-3), ("cm", 1e-2), ("CM", 1e-2), ("m", 1.0)]
    + [(inch, 0.0254) for inch in ("in", "IN", "inch", "Inches", '"')],
)
def test_a_length_is_read_in_every_unit_of_a_ruler(unit, metres):
    found = read(f"Length [{unit}],mass (g)")
    assert found.gauge == pytest.approx(60 * metres)
    assert found.stroke == pytest.approx(np.array([0, 10, 15]) * metres)


@pytest.mark.parametrize(
    ("header", "problem"),
    [
        ("Displacement (mm),Force (MN)", "is in 'MN': must be one of N, mN"),
        ("Displacement (M),Force (N)", "is in 'M': must be one of mm"),
        ("length (mm),weight", "column 'weight' has no unit"),
        ("length (mm),colour (g)", "no column for the force (columns: length, colour)"),
        ("width (mm),weight (g)", "no column for the stroke"),
    ],
)
def test_capitals_that_mean_another_unit_and_columns_without_one_are_refused(header, problem):
    with pytest.raises(lab.LabError) as told:
        read(header)
    assert problem in str(told.value)


@pytest.mark.parametrize(
    "header",
    [
        *("LENGTH (MM),WEIGHT (G)", "length_mm,weight_g", "Länge [mm],Gewicht [g]"),
        *("MASS (g),LENGTH (mm)", "no,length (mm),mass (g),note (s)"),
    ],
)
def test_headers_of_a_kitchen_are_known_in_any_order_and_case(header):
    names = [name.split()[0].lower().partition("_")[0] for name in header.split(",")]
    row = {"no": "1", "note": "3", "mass": "50", "weight": "50", "gewicht": "50"}
    lines = [",".join(row.get(n, str(length)) for n in names) for length in (60, 70)]
    found = pulled("\n".join([header, *lines]))
    assert found.force == pytest.approx(0.05 * GRAVITY)
    assert found.stroke == pytest.approx([0.0, 0.010])


def test_a_force_of_the_machine_goes_before_a_weight_and_a_displacement_before_a_length():
    found = pulled("mass (g),Load (N),length (mm),Extension (mm)\n7,1,50,0\n7,2,50,4\n")
    assert found.force == pytest.approx([1, 2])
    assert found.stroke == pytest.approx([0, 0.004])
    assert found.gauge is None


def test_what_was_made_of_lengths_and_weights_is_said():
    notes = lab.band_test([pulled(SEVEN)]).notes
    says(notes, "pull.csv: ", "length", "62 mm")
    says(notes, "kg", "9.80665 N", "positive pulls")


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("62.5,10\n66,20\n71.5,30\n", (0.5, 1.0)),
        ("62.1,10\n66,20\n71.5,30\n", (0.1, 1.0)),
        ("6.25,50\n6.6,100\n7.15,150\n", (0.05, 1.0)),  # weights are set, not read to 50 g
        ("62,0.5\n66,2.25\n71,3.5\n", (1.0, 0.05)),
    ],
)
def test_the_digits_say_in_which_steps_was_read(text, step):
    found = pulled("length (mm),force (N)\n" + text)
    assert found.steps == pytest.approx((step[0] * 1e-3, step[1]))


def test_decimal_commas_are_read_as_points():
    text = SEVEN.replace(",", ";").replace(".", ",")
    assert lab.band_test([pulled(text)]).gauge == 0.062
    assert pulled(text).stroke == pytest.approx(pulled(SEVEN).stroke)


@given(st.permutations(SEVEN.splitlines()[1:]))
def test_rows_in_any_order_are_the_same_band(rows):
    test = lab.band_test([pulled("\n".join(["length (mm),weight (g)", *rows]))])
    if any("rows are sorted" in line for line in test.notes) or rows == sorted(rows):
        (loop,) = test.used
        assert loop.force == pytest.approx(np.array(PULLS) * 1e-3 * GRAVITY)
        assert lab.stiffness(test).value == pytest.approx(31.18, abs=0.01)
    else:
        # It goes up, and comes from or goes to another half.
        assert len(test.loops) == 1
        assert lab.stiffness(test).value == pytest.approx(31.18, rel=0.25)


def test_weights_put_on_and_taken_off_again_are_one_cycle():
    there = SEVEN.splitlines()
    back = [f"{float(row.split(',')[0]) + 1},{row.split(',')[1]}" for row in there[-2:0:-1]]
    test = lab.band_test([pulled("\n".join(there + back))])
    (loop,) = test.loops
    assert (len(loop.stroke), len(loop.back_stroke)) == (7, 7)
    assert lab.stiffness(test).value == pytest.approx(31.18, abs=0.01)
    assert 0 < loop.loss < 0.2


@pytest.mark.parametrize("name", ["pull.csv", "scale2.csv", "monday 7.csv", "band-12.csv"])
def test_one_table_is_one_cycle_whatever_number_its_name_ends_in(name):
    test = lab.band_test([pulled(SEVEN, name)])
    assert [loop.cycle for loop in test.loops] == [1]
    assert test.cycles == (1, 1)
    assert test.notes[0].startswith("cycle 1 is fitted")
    assert not any("is missing" in line for line in test.notes)


def test_numbers_are_cycles_only_where_those_of_a_batch_can_be():
    one = "\n".join(SEVEN.splitlines())
    twice = one + "\n" + "\n".join(SEVEN.splitlines()[1:])
    names = lab.band_test([pulled(one, f"a_{n}.csv") for n in (3, 4)], cycles=(3, 4))
    assert [loop.cycle for loop in names.loops] == [3, 4]
    counted = lab.band_test([pulled(twice, f"a_{n}.csv") for n in (1, 2)], cycles=(1, 9))
    assert [loop.cycle for loop in counted.loops] == [1, 2, 3, 4]
    samples = lab.band_test([pulled(one, f"Samp{n}.csv") for n in (2, 3)])
    assert [(loop.sample, loop.cycle) for loop in samples.loops] == [(2, 1), (3, 1)]


def test_the_window_is_the_whole_test_in_tension_unless_another_one_is_given():
    test = lab.band_test([pulled(SEVEN)])
    assert test.window == pytest.approx((0.0, 0.0345))
    limp = SEVEN.replace("62,0\n", "50,0\n56,0\n62,0\n")
    assert lab.band_test([pulled(limp)]).window == pytest.approx((0.012, 0.0465))
    with refuses(
        lab.LabError, "pull.csv", "0 to 34.5", "mm", "5 to 35", "mm", "window", "drop sample 1"
    ):
        lab.band_test([pulled(SEVEN)], window=(0.005, 0.035))
    with refuses(lab.LabError, "5 to 9", "1 to 1", "cycles"):
        lab.band_test([pulled(SEVEN)], cycles=(5, 9))


def test_all_but_the_first_of_a_few_cycles_are_used():
    up = np.linspace(0, 0.040, 200)
    stroke = np.concatenate([up, up[::-1]] * 3)
    test = lab.band_test([lab.Recording("long.txt", np.arange(1200) / 20, stroke, 30 * stroke)])
    assert test.cycles == (2, 3)
    assert test.window == pytest.approx((0.0, 0.040), abs=1e-3)
    says(test.notes[0], "2 to 3", "5 to 9")


def test_the_rest_length_follows_from_lengths_and_a_gauge_beside_them_is_refused():
    rest, k = 0.0600, 30.0
    test = lab.band_test([pulled(table(rest, spring(k), np.linspace(0.005, 0.040, 8)))])
    choice = lab.choose_law(test)
    assert choice.rest_length == pytest.approx(rest, abs=5e-4)
    with refuses(ValueError, "gauge = 0.01", "m", "length", "m"):
        lab.choose_law(test, 0.010)


@pytest.mark.slow
def test_bands_of_other_lengths_each_count_from_their_own_and_the_mean_is_reported():
    extension = np.linspace(0.002, 0.040, 9)
    bands = [
        pulled(table(rest, spring(30.0), extension), f"Samp{n}.csv")
        for n, rest in ((1, 0.060), (2, 0.062), (3, 0.064))
    ]
    test = lab.band_test(bands)
    assert test.gauge == pytest.approx(0.064)
    assert lab.stiffness(test).value == pytest.approx(30.0, rel=0.01)
    assert lab.choose_law(test).rest_length == pytest.approx(0.062, abs=5e-4)


@pytest.mark.slow
def test_three_bands_from_home_tell_their_law_and_what_the_next_one_has():
    rng = np.random.default_rng(0)
    bands = [
        pulled(table(rest, rubber(k), extensions(rng)), f"Samp{n}.csv")
        for n, (rest, k) in enumerate([(0.060, 29.0), (0.061, 30.5), (0.0605, 31.0)], 1)
    ]
    test = lab.band_test(bands)
    choice = lab.choose_law(test)
    assert test.samples == (1, 2, 3)
    assert choice.chosen.law.name == "cubic"
    assert choice.rest_length == pytest.approx(0.0605, abs=5e-4)
    found = lab.stiffness(test)
    assert found.next_low < found.low < found.value < found.high < found.next_high


def covered(draws: int, shape, readings: int = 7) -> tuple[int, int, int]:
    """In how many tests at home the intervals of k and l0 hold the truth; how often the law is."""
    rng = np.random.default_rng(0)
    k_in = rest_in = right = 0
    for _ in range(draws):
        rest, k = rng.uniform(0.050, 0.070), rng.uniform(20, 60)
        tension = shape(k)
        test = lab.band_test([pulled(table(rest, tension, extensions(rng, readings)))])
        choice = lab.choose_law(test)
        right += choice.chosen.law.name == ("linear" if shape is spring else "cubic")
        told, (loop,), gauge = this_band(test, choice), test.used, test.gauge
        assert told is not None and gauge is not None
        slope, onset = told
        u = loop.stroke[loop.force > 0.02 * np.max(loop.force)] + gauge
        true = np.polyfit(u, tension(np.maximum(u - rest, 0.0)), 1)[0]
        k_in += slope.low <= true <= slope.high
        rest_in += onset.low <= rest - gauge <= onset.high
    return k_in, rest_in, right


@pytest.mark.slow
@pytest.mark.parametrize("shape", [spring, rubber])
def test_the_intervals_of_seven_readings_hold_the_truth_and_the_law_is_the_one_that_made_them(
    shape,
):
    draws = examples(10, full=400)
    k_in, rest_in, right = covered(draws, shape)
    # 95 % of a few draws; of many, 90 to 99.
    least = 0.90 if draws > 100 else 0.80
    assert min(k_in, rest_in) >= least * draws
    assert right >= 0.95 * draws


def test_seven_readings_of_rubber_are_no_neo_hookean_where_a_cubic_leaves_little():
    choice = lab.choose_law(lab.band_test([pulled(SEVEN)]))
    assert choice.chosen.law.name == "cubic"
    assert choice.named("neo-Hookean").fitted.rmse > 10 * choice.chosen.fitted.rmse
    says(choice.reason, "Schwarz's criterion", "7 independent readings")


@pytest.mark.parametrize("readings", [2, 3, 4])
def test_with_few_readings_only_the_line_is_tried_and_no_doubt_is_made_up(readings):
    rows = SEVEN.splitlines()[: readings + 2]
    del rows[1]
    test = lab.band_test([pulled("\n".join(rows))])
    choice = lab.choose_law(test)
    if readings < 4:
        assert [one.law.name for one in choice.candidates] == ["linear"]
    told = this_band(test, choice)
    assert told is not None
    slope, _ = told
    assert np.isnan(slope.low) == (readings == 2)
    text = lab.band_table(lab.fit_bands(test, choice))
    assert ("not known" in text) == (readings == 2)


def test_the_record_and_the_table_tell_the_band_with_its_doubt():
    test = lab.band_test([pulled(SEVEN)])
    fit = lab.fit_bands(test, lab.choose_law(test))
    record = account(fit, About(source="pull.csv")).record
    text = record["table"]
    alone = record["this_band"]
    assert alone["readings"] == 7
    k, rest = alone["stiffness_N_per_m"], alone["rest_length_mm"]
    assert k["low"] < record["stiffness_N_per_m"]["value"] == k["value"] < k["high"]
    assert rest["low"] < record["rest_length_mm"] < rest["high"]
    assert f"Rest length {rest['value']:.4g} mm (95 % {rest['low']:.4g}" in text
    assert record["warnings"] == []


def said(*arguments: object) -> dict[str, Any]:
    """What a command prints with --json."""
    found = CliRunner().invoke(app, [*map(str, arguments), "--json"], prog_name="stepwell")
    assert found.exit_code == 0, found.output
    return json.loads(found.stdout)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["linear", "cubic", "neo-Hookean"])
def test_the_band_of_a_table_goes_into_a_design_for_one_and_for_two_bands_and_runs(law, tmp_path):
    csv = tmp_path / "pull.csv"
    shape = spring(30.0) if law == "linear" else rubber(30.0)
    csv.write_text(table(0.010, shape, np.linspace(0, 0.032, 9)), "utf-8")
    told = said("lab", "band", csv, "--law", law)
    anchors = "p_mm = [-10, 0]\nq_mm = [20, 0]"
    twice = "bands = [{ p_mm = [-10, 0], q_mm = [20, 0] }, { p_mm = [-10, 0], q_mm = [20, 0] }]"
    texts = [f"[chain]\n{told['table']}[[chain.cell]]\n{cell}\n" for cell in (anchors, twice)]
    one, two = (files.loads(text, "leg.toml").chain for text in texts)
    theta = np.linspace(-0.7, 0.7, 15)
    assert two.levers[0].force(theta) == pytest.approx(2 * one.levers[0].force(theta), rel=1e-12)
    (band,) = one.levers[0].bands
    extension = np.linspace(0.006, 0.030, 9)
    near = 0.02 if law != "neo-Hookean" else 0.25
    assert band.tension(0.010 + extension) == pytest.approx(shape(extension), rel=near, abs=0.02)
    for k, text in enumerate(texts):
        design = tmp_path / f"leg{k}.toml"
        design.write_text(text, "utf-8")
        ran = said("run", design)
        assert ran["sequence"] == "0>1>0"


@pytest.mark.parametrize("note", ["note", "what I saw"])
def test_a_column_of_notes_is_left_out_and_said(note):
    rows = [line.split(",") for line in SEVEN.splitlines()[1:]]
    words = ["limp", "", "windy", "", "again", "", "ok"]
    table = f"length (mm),weight (g),{note}\n" + "".join(
        f"{length},{weight},{word}\n" for (length, weight), word in zip(rows, words, strict=True)
    )
    noted, plain = pulled(table), pulled(SEVEN)
    assert noted.stroke == pytest.approx(plain.stroke) and noted.force == pytest.approx(plain.force)
    says(noted.remarks, f"column {note!r}", "not read")


def test_a_band_of_metres_is_warned_of():
    test = lab.band_test([pulled(SEVEN.replace("(mm)", "(m)"))])
    (warning,) = test.warnings
    says(warning, "Did you mean", "units", "header")
