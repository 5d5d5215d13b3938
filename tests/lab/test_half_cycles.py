"""Half cycles of a recording: extremes, jumps, work and stiffness, where the truth is known."""

import numpy as np
import pytest

from facts import says
from lab.machine import recording, saved, there
from sizes import examples
from stepwell import lab, reports
from stepwell.accounts import account, page, terminal

DRAWS = examples(10, 100)
LINES = 25  # of a screen


def bent(stroke):
    """A smooth force [N]: its peak is 1.221 N at 3.45 mm, its valley 0.297 N at 8.25 mm."""
    x = stroke * 1e3
    return 0.297 + 0.924 * (1 - 3 * ((x - 3.45) / 4.8) ** 2 + 2 * ((x - 3.45) / 4.8) ** 3)


def curve(noise=0.0, seed=0, rows=None):
    up = there(0.012) if rows is None else np.linspace(0.0, 0.012, rows)
    return recording(
        "clip.txt", up, bent(up) + np.random.default_rng(seed).normal(0, noise, len(up))
    )


def strip(snap=0.0, noise=0.0):
    """Loading and unloading of 30 N/m to 40 mm, 20 % lost, a snap of this drop [N] at 25 mm."""
    up = there(0.040)
    force = 30 * up - snap * (up > 0.025)
    rng = np.random.default_rng(0)
    stroke = np.concatenate([up, up[-2::-1]])
    every = np.concatenate([force, 0.8 * force[-2::-1]])
    return recording("strip.txt", stroke, every + rng.normal(0.0, noise, len(every)))


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.03])
def test_peak_and_valley_are_where_the_curve_has_them(noise):
    (half,) = lab.half_cycles(curve(noise))
    ((peak, top),), ((valley, low),) = half.peaks, half.valleys
    assert (peak, valley) == pytest.approx((3.45e-3, 8.25e-3), abs=3e-4)
    assert (top, low) == pytest.approx((1.221, 0.297), abs=1e-3 + 1.5 * noise)
    assert half.noise == pytest.approx(noise, rel=0.2, abs=1e-5)
    assert half.direction == "loading" and half.number == 1


def test_white_noise_makes_no_extreme_and_no_jump():
    for seed in range(DRAWS):
        up = there(0.040)
        rng = np.random.default_rng(seed)
        run = recording("line.txt", up, 30 * up + rng.normal(0.0, 0.06, len(up)))
        (half,) = lab.half_cycles(run)
        assert half.peaks == half.valleys == half.snaps == (), seed


@pytest.mark.parametrize("rows", [61, 121, 500, 4000])
def test_a_smooth_fall_is_no_jump_at_any_sampling(rows):
    (half,) = lab.half_cycles(curve(rows=rows))
    assert half.snaps == () and len(half.peaks) == 1


@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_a_snap_has_its_stroke_and_its_drop_in_both_halves(noise):
    out, back = lab.half_cycles(strip(0.3, noise))
    for half, drop in ((out, -0.3), (back, 0.24)):
        (snap,) = half.snaps
        assert snap.stroke == pytest.approx(0.025, abs=2e-4)
        assert snap.jump == pytest.approx(drop, abs=0.02 + 4 * noise)


def test_work_loss_and_stiffness_are_those_of_the_line():
    out, back = lab.half_cycles(strip())
    assert out.work == pytest.approx(0.024, rel=1e-3)
    assert back.work == pytest.approx(-0.8 * 0.024, rel=1e-3)
    assert out.loss == pytest.approx(0.2, abs=1e-3) and np.isnan(back.loss)
    assert (out.stiffness_0, out.stiffness_1) == pytest.approx((30, 30), rel=1e-3)
    assert back.stiffness_0 == pytest.approx(24, rel=1e-3)
    assert (out.start, out.end, back.end) == pytest.approx((0.0, 0.040, 0.0))


def test_a_half_after_which_the_chain_takes_work_again_has_no_fraction_lost():
    up = there(0.040)
    stroke, force = np.concatenate([up, up[-2::-1]]), 0.3 * np.sign(0.02 - up)
    # A snap in the middle, and friction, which takes 1 mJ either way.
    every = np.concatenate([force + 0.025, force[-2::-1] - 0.025])
    out, back = lab.half_cycles(recording("bistable.txt", stroke, every))
    assert out.work > 0 and back.work > 0 and np.isnan(out.loss)


def test_the_stiffness_begins_where_the_force_does():
    up = there(0.020)
    run = recording("approach.txt", up, 100 * np.maximum(up - 0.008, 0.0))
    (half,) = lab.half_cycles(run)
    assert half.stiffness_0 == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize("count", [1, 2, 40])
def test_a_screen_of_recordings_has_at_most_25_lines_and_the_rest_is_in_the_record(count):
    runs = [strip(0.3, 0.002)] + [curve(0.01, seed=k) for k in range(1, count)]
    named = [
        lab.Recording(f"data/a_{2 * k}.txt", one.time, one.stroke, one.force)
        for k, one in enumerate(runs)
    ]
    found = account(lab.Batch(tuple(named), ()))
    assert len(terminal(found)) <= LINES
    halves = [half for one in found.record["recordings"] for half in one["half_cycles"]]
    assert len(halves) == count + 1
    assert halves[0]["snaps"][0]["stroke_mm"] == pytest.approx(25, abs=0.2)
    assert all(len(half["peaks"]) == 1 for half in halves[2:])
    assert page(found).count("loading<") >= len(halves)


def test_notes_of_a_kind_are_one_line_with_their_count_and_all_are_on_the_page():
    up = there(0.020)
    runs = [recording(f"a_{2 * k}.txt", up, 30 * up) for k in range(30)]
    found = account(lab.Batch(tuple(runs), ()))
    lines = [line.text for line in terminal(found)]
    says(lines, "missing before it", "28 of this kind")
    assert page(found).count("is missing before it") >= 29


def test_a_folder_has_the_table_as_csv_and_parquet_the_picture_and_the_record(tmp_path):
    saved(strip(), tmp_path / "in")
    batch = lab.read_all([tmp_path / "in"])
    written = reports.write(account(batch), tmp_path / "out")
    assert {"recordings.csv", "recordings.json", "recordings.png"} <= {*written}
    parquet = pytest.importorskip("pyarrow.parquet")

    table = parquet.read_table(tmp_path / "out" / "recordings.parquet")
    head = (tmp_path / "out" / "recordings.csv").read_text("utf-8").splitlines()
    assert head[0].split(",") == table.column_names
    assert len(head) == len(table) + 1
    assert max(table["stroke_mm"].to_pylist()) == pytest.approx(40)
