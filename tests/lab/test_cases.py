"""Exports that were read wrongly once, made again by formula, with their right answers."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import stepwell as sw
from facts import says
from lab.exports import PLAIN, STANDARD, comma, grouped, quoted, table
from stepwell import lab
from stepwell.cli import app

# A band of 30 N/m that is pulled and let go over 40 mm, in 400 rows with noise of 1 mN.
_WAY = np.concatenate([np.linspace(0, 40, 200), np.linspace(40, 0, 200)])
_TIME = np.arange(400) / 10
_NOISE = 0.001 * np.random.default_rng(3).standard_normal(400)
_FORCE = 0.03 * _WAY + _NOISE
_HEAD = "Displacement (mm),Force (N)"
_BOTH = (_TIME, _WAY, _FORCE)
# A band whose stiffness falls with the stroke, with a loss of a tenth while unloading.
_SOFT = 0.69 * (1 - np.exp(-_WAY / 12)) * np.where(np.arange(400) < 200, 1.0, 0.9) + _NOISE


def _run(*arguments) -> tuple[str, str]:
    """What a command prints, and what it warns of."""
    result = CliRunner().invoke(app, [str(one) for one in arguments], env={"COLUMNS": "80"})
    assert result.exit_code == 0, result.stderr
    return result.stdout, result.stderr


def _stiffness(folder, text: str, *options: str, name: str = "band.csv") -> float:
    """Stiffness [N/m] that the command reports of a file."""
    (folder / name).write_text(text, "utf-8")
    shown, _ = _run("lab", "band", folder / name, *options, "--json")
    return json.loads(shown)["stiffness_N_per_m"]["value"]


def test_a_stroke_that_begins_at_100_mm_gives_the_stiffness_of_the_band(tmp_path):
    x = np.linspace(100, 104, 60)
    text = table(_HEAD, (x, 0.03 * (x - 100)))
    assert _stiffness(tmp_path, text) == pytest.approx(30.0, rel=2e-3)


def test_travel_beside_an_absolute_crosshead_gives_the_stiffness(tmp_path):
    x = np.linspace(0, 10, 60)
    text = table(
        "Time,Crosshead absolute,Standard travel,Standard force\ns,mm,mm,N",
        (x, x - 755, x, 0.1 * x),
    )
    assert _stiffness(tmp_path, text) == pytest.approx(100.0, rel=1e-3)


@pytest.mark.parametrize("options", [(), ("--window", "5:35")])
def test_tension_and_stroke_counted_negative_give_the_same_stiffness(tmp_path, options):
    for force in (_FORCE, _SOFT):
        plain, turned = (
            _stiffness(tmp_path, table(STANDARD, (_TIME, s * _WAY, s * force)), *options)
            for s in (1, -1)
        )
        assert turned == pytest.approx(plain, rel=1e-9)
        if options:
            inside = (_WAY[:200] >= 5) & (_WAY[:200] <= 35)
            slope = np.polyfit(_WAY[:200][inside], force[:200][inside], 1)[0]
            assert turned == pytest.approx(1e3 * slope, rel=5e-3)


def test_commas_between_thousands_are_no_decimals(tmp_path):
    columns = (_TIME, np.round(_WAY * 1000), np.round(_FORCE * 1000))
    text = table("Time (s)\tDisplacement (um)\tForce (mN)", columns, "\t", grouped)
    found = lab.read_bytes(text.encode(), "a.txt")
    assert np.ptp(found.stroke) == pytest.approx(0.040, rel=1e-3)
    assert np.max(found.force) == pytest.approx(1.2, rel=5e-3)


def test_a_spreadsheet_with_quoted_decimal_commas_of_four_rows_is_read():
    rows = [(0, 0), (5, 0.6), (10, -0.4), (20, 1.5)]
    text = table(_HEAD, [*np.transpose(rows).astype(float)], ",", quoted)
    assert lab.read_bytes(text.encode(), "a.csv").force == pytest.approx([0, 0.6, -0.4, 1.5])


def test_approach_and_a_snap_in_noise_give_two_phases_at_their_places(tmp_path):
    x = np.linspace(-4, 12, 800)
    # Peak 1.228 N at 3.5 mm, valley 0.295 N at 8.3 mm.
    inner = np.interp(x, [0, 12], [0, 1]) * 12
    bent = 0.0169 * inner * (inner**2 - 17.7 * inner + 87.15)
    noise = 0.02 * np.random.default_rng(5).standard_normal(800)
    text = table(_HEAD, (x, np.where(x > 0, bent, 0) + noise))
    (tmp_path / "clip.csv").write_text(text, "utf-8")
    shown, _ = _run("lab", "element", tmp_path / "clip.csv", "--json")
    first, second = json.loads(shown)["phases"]
    assert first["high_mm"] == pytest.approx(3.5, abs=0.2)
    assert second["low_mm"] == pytest.approx(8.3, abs=0.2)


@pytest.mark.parametrize("beside", [False, True])
def test_two_specimens_of_a_file_are_two_bands(tmp_path, beside):
    if beside:
        text = table(f"{_HEAD},{_HEAD}", (_WAY, _FORCE, _WAY, 2 * _FORCE))
    else:
        text = table(STANDARD, _BOTH) + "\nSpecimen 2\n"
        text += table(STANDARD, (_TIME, _WAY, 2 * _FORCE))
    each = [_stiffness(tmp_path, text, "--sample", f"{k}") for k in (1, 2)]
    assert each == pytest.approx([30.0, 60.0], rel=2e-3)


def test_values_in_file_names_are_samples_of_their_own(tmp_path):
    folder = tmp_path / "strips"
    folder.mkdir()
    for name, stiffness in (("strip_1d5", 20), ("strip_2d0", 30), ("strip_2d5", 40)):
        force = stiffness * 1e-3 * _WAY + _NOISE
        (folder / f"{name}.csv").write_text(table(_HEAD, (_WAY, force)), "utf-8")
    shown, _ = _run("lab", "band", folder, "--json")
    record = json.loads(shown)
    says(record["warnings"], "one kind", "strip_1d5", "--drop 1")
    assert record["stiffness_N_per_m"]["each"] == pytest.approx({"2": 30, "3": 40}, rel=2e-3)


def test_words_beside_the_numbers_and_a_capital_bar_are_elements_of_a_volume(tmp_path):
    v = np.linspace(0, 12, 600)
    p = 1 + 0.0169 * v * (v**2 - 17.7 * v + 87.15)
    words = "time_s,state,volume_mL,pressure_kPa\n"
    words += "".join(
        f"{k / 50},RAMP,{a:.4f},{b:.5f}\n" for k, (a, b) in enumerate(zip(v, p, strict=True))
    )
    for name, text in (
        ("words.csv", words),
        ("bar.csv", table("Volume (mL),Pressure (Bar)", (v, p / 100))),
    ):
        (tmp_path / name).write_text(text, "utf-8")
        shown, _ = _run("lab", "element", tmp_path / name, "--json")
        first, second = json.loads(shown)["phases"]
        assert (first["high_mL"], second["low_mL"]) == pytest.approx((3.5, 8.3), abs=0.2)


def test_a_design_names_the_half_of_a_recording_with_both(tmp_path):
    x = np.linspace(0, 12, 600)
    force = 0.0169 * x * (x**2 - 17.7 * x + 87.15)
    rows = (np.concatenate([x, x[::-1]]), np.concatenate([force, force[::-1] - 0.1]))
    (tmp_path / "both.csv").write_text(table(_HEAD, rows), "utf-8")
    for half, highest in (("loading", force), ("unloading", force - 0.1)):
        design = tmp_path / "one.toml"
        design.write_text(f'[[chain.cell]]\ntable_csv = "both.csv"\nhalf = "{half}"\n', "utf-8")
        (element,) = sw.load(design).cells
        assert element.phases[0].force_high == pytest.approx(np.max(highest[:300]), abs=1e-3)


def test_two_clips_from_a_table_are_compared_with_their_recording(tmp_path):
    x = np.linspace(0, 12, 121)
    one = table(_HEAD, (x, 0.0169 * x * (x**2 - 17.7 * x + 87.15)))
    (tmp_path / "plain.csv").write_text(one, "utf-8")
    cell = '[[chain.cell]]\ntable_csv = "plain.csv"\n'
    (tmp_path / "two.toml").write_text(f"{cell}{cell}force_scale = 1.25\n", "utf-8")
    path = sw.load(tmp_path / "two.toml").path([0.0, 0.024]).resampled(400)
    text = table(_HEAD, (path.stroke * 1e3, path.force))
    (tmp_path / "two_clips_1.csv").write_text(text, "utf-8")
    shown, _ = _run("lab", "compare", tmp_path / "two_clips_1.csv", tmp_path / "two.toml")
    says(shown, "1 of 1", "as predicted")


def test_the_strokes_of_a_recording_that_returns_are_reported_with_its_turn(tmp_path):
    way = np.concatenate([np.linspace(0, 19.9, 50), np.linspace(19.9, 0.4, 50)])
    (tmp_path / "pull.csv").write_text(table(_HEAD, (way, np.sin(way / 5))), "utf-8")
    shown, _ = _run("lab", "read", tmp_path / "pull.csv")
    says(shown, "0 to 19.9", "19.9 to 0.4")


def test_decimal_commas_without_quotes_need_another_separator():
    text = table("Weg [mm];Kraft [N]", (_WAY, _FORCE), ";", comma)
    assert lab.read_bytes(text.encode(), "a.csv").force == pytest.approx(_FORCE, abs=1e-7)
    assert lab.read_bytes(PLAIN.encode(), "a.csv").stroke[60] == pytest.approx(0.020)
