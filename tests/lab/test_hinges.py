"""A hinge that snaps between two rows of its test gives its phases, however it was exported."""

import json
from itertools import product

import numpy as np
import pytest
from typer.testing import CliRunner

import stepwell as sw
from facts import refuses, says
from lab.machine import recording
from stepwell import figures, lab
from stepwell.accounts import account, terminal
from stepwell.base import Measure
from stepwell.cli import app, readings

# Angles as a machine steps through them: two spacings, and none near the flat state [deg].
_ANGLE = np.concatenate([np.linspace(-144, -69, 50), np.linspace(-51, 144, 51)])
_SNAP, _DROP = 90.0, 11.5
_HEAD = "Angle (deg),Torque (N mm)\n"


def _torque(angle: np.ndarray) -> np.ndarray:
    """Torque of the hinge at angles [deg], which drops between two rows [N mm]."""
    return 0.09 * angle + 0.0002 * angle**2 + 4.0 - _DROP * (angle > _SNAP)


def _rows(seed: int) -> np.ndarray:
    """Angle and torque of a test, (101, 2), with white noise of 0.04 N mm."""
    noise = 0.04 * np.random.default_rng(seed).standard_normal(len(_ANGLE))
    return np.column_stack([_ANGLE, _torque(_ANGLE) + noise])


def _written(file, rows: np.ndarray, head: str = _HEAD) -> None:
    file.write_text(head + "".join(f"{x:.6f},{y:.5f}\n" for x, y in rows), "utf-8")


def _measured(rows: np.ndarray, **reading) -> lab.MeasuredElement:
    text = _HEAD + "".join(f"{x!r},{y!r}\n" for x, y in rows.tolist())
    (one,) = lab.read_every(text.encode(), "hinge.csv", lab.Reading(**reading), tuple(Measure))
    return lab.measure_element(one)


def _turns(found: lab.MeasuredElement) -> tuple[float, float]:
    """Angles between which the torque falls [deg]."""
    (_, peak), (valley, _) = np.degrees(found.phases)
    return peak, valley


@pytest.mark.parametrize(("seed", "away", "order"), [*product(range(4), (1, -1), (1, -1))])
def test_phases_end_at_the_rows_of_the_snap_in_both_directions_and_orders(seed, away, order):
    rows = (away * _rows(seed))[::order]
    peak, valley = _turns(_measured(rows))
    # Both signs are turned where the work shows that loading is counted negative.
    snap = (-97.0, -84.0) if away == order == -1 else (84.0, 97.0)
    assert snap[0] <= peak < valley <= snap[1]


@pytest.mark.parametrize("seed", range(4))
def test_the_curve_does_not_swing_between_distant_rows_and_keeps_peak_and_valley(seed):
    rows = _rows(seed)
    found = _measured(rows)
    inside = np.linspace(-140, 80, 400)
    off = found.element.force_at(np.radians(inside)) * 1e3 - _torque(inside)
    assert np.max(np.abs(off)) < 0.6
    assert np.max(np.abs(off)) < found.error_band * 1e3
    peak, valley = found.element.phases[0].force_high * 1e3, found.element.phases[1].force_low * 1e3
    last, first = rows[rows[:, 0] < _SNAP][-1, 1], rows[rows[:, 0] > _SNAP][0, 1]
    assert (peak, valley) == pytest.approx((last, first), abs=0.4)
    assert found.error_band * 1e3 < 0.2 * _DROP


def test_a_torque_counted_negative_is_asked_and_one_option_settles_it():
    rows = _rows(0) * (1, -1)
    with refuses(lab.LabError, "--stops both", "--flip force") as asked:
        _measured(rows)
    assert asked.value.flips == ("force",)
    assert _turns(_measured(rows, flip="force")) == _turns(_measured(_rows(0)))


def test_a_last_row_that_jumps_back_over_the_travel_is_left_out_and_reported():
    rows = _rows(0)
    found = _measured(np.vstack([rows, [-143.0, 0.3]]))
    assert _turns(found) == _turns(_measured(rows))
    says(found.recording.remarks, "last row", "left out")


def test_the_command_reads_angle_and_torque_and_all_its_forms_have_their_units(tmp_path):
    _written(tmp_path / "hinge.csv", _rows(0))
    out = tmp_path / "out"
    arguments = ["lab", "element", str(tmp_path / "hinge.csv"), "--noise", "0.05"]
    shown = CliRunner().invoke(app, [*arguments, "--out", str(out)], env={"COLUMNS": "80"})
    assert shown.exit_code == 0, shown.stderr
    says(shown.stdout, "2 phases", "deg", "mN m")
    record = json.loads((out / "element.json").read_text("utf-8"))
    assert record["noise_mNm"] == pytest.approx(0.05, rel=0.2)
    assert record["phases"][0]["high_deg"] == pytest.approx(88, abs=3)
    design = sw.load(out / "design.toml")
    assert design.measure is Measure.ANGLE
    again = sw.load_element(out / "element.csv")
    assert again.force_at(0.5) == pytest.approx(design.cells[0].force_at(0.5), rel=1e-6)


def test_the_figure_has_its_points_on_the_axis_of_angles():
    found = _measured(_rows(0))
    (ax, *_) = figures.plot(found).axes
    points = next(line for line in ax.lines if "measured" in str(line.get_label()))
    assert np.ptp(points.get_xdata()) == pytest.approx(np.ptp(_ANGLE), rel=0.05)
    says("\n".join(line.text for line in terminal(account(found))), "torques at which")


def test_volume_and_pressure_are_an_element_too():
    volume = np.linspace(0, 12, 300)
    pressure = volume * (12 - volume) * 0.2 + 0.003 * volume**3
    text = "Volume (mL),Pressure (kPa)\n"
    text += "".join(f"{v:.4f},{p:.4f}\n" for v, p in zip(volume, pressure, strict=True))
    (one,) = lab.read_every(text.encode(), "balloon.csv", measures=tuple(Measure))
    found = lab.measure_element(one, stops=(False, True))
    assert found.element.measure is Measure.VOLUME
    says(str(found), "mL", "kPa")


def _open() -> lab.Recording:
    """A test whose stroke falls from zero while the force pulls: its signs are open."""
    x = np.linspace(0, 10, 200)
    force = 0.2 + x * (x - 6.2) * (x - 10.5) * 0.02
    text = "Travel (mm),Load (N)\n" + "".join(
        f"{-a:.4f},{b:.4f}\n" for a, b in zip(x, force, strict=True)
    )
    return lab.read_bytes(text.encode(), "open.csv")


def test_open_signs_of_an_element_are_refused_with_the_options_that_decide():
    one = _open()
    assert one.other_flip
    with refuses(lab.LabError, "signs", "--flip none", f"--flip {one.other_flip}"):
        lab.measure_element(one)


def test_at_a_terminal_the_signs_of_one_file_are_asked(tmp_path, monkeypatch):
    _written(
        tmp_path / "a.csv",
        np.column_stack([_open().stroke, _open().force]) * (1e3, 1),
        "Travel (mm),Load (N)\n",
    )
    monkeypatch.setattr(readings, "_asks", lambda: True)
    asked, answers = [], iter(["twice", "both"])

    def prompt(text, **_):
        asked.append(text)
        return next(answers)

    monkeypatch.setattr(readings.typer, "prompt", prompt)
    result = CliRunner().invoke(app, ["lab", "read", str(tmp_path / "a.csv")])
    assert result.exit_code == 0 and len(asked) == 2
    says(result.stderr, "'twice': must be")
    says(result.stderr, "same as options", "--flip both")
    (tmp_path / "b.csv").write_bytes((tmp_path / "a.csv").read_bytes())
    assert CliRunner().invoke(app, ["lab", "read", str(tmp_path)]).exit_code == 0
    # Several files are read as recorded: one answer need not fit all of them.
    assert len(asked) == 2


def test_without_a_terminal_open_signs_are_read_as_recorded_and_reported(tmp_path):
    one = _open()
    lab.to_csv([one], tmp_path / "a.csv")
    result = CliRunner().invoke(app, ["lab", "read", str(tmp_path / "a.csv")])
    assert result.exit_code == 0
    says(result.stderr, "as recorded", "--flip")


def test_a_recording_with_requested_signs_is_not_open():
    assert recording("a.csv", np.linspace(0, 0.01, 50), np.linspace(0, 1, 50)).other_flip == ""
