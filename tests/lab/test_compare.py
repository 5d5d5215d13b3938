"""Measured against model, where the truth is known: any direction, any names, any gaps."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from facts import refuses, says
from lab.machine import pair, recording, there, unit
from stepwell import lab
from stepwell.accounts import account
from stepwell.lab.cell_test import CLOSE
from stepwell.lab.pair_test import _strokes
from stepwell.lab.series import paper_cell
from stepwell.mechanism import Band, Cell, Chain

CELL = paper_cell()
MM, MT, MB = (CELL.with_anchors(q=q) for q in ((0.010, 0.0), (0.020, 0.0), (0.0, 0.0)))
T = CELL.with_anchors(p=(0.0, 0.0))
PAPER_Q = {"MB": (0.0, 0.0), "MT": (0.020, 0.0), "MRB": (0.0, -0.015), "MLB": (0.0, 0.015)}


def doubled(cell: Cell, factor: float = 2.0) -> Cell:
    return replace(cell, band=tuple(replace(b, stiffness=factor * b.stiffness) for b in cell.bands))


def frictions(source="1unit/friction/friction_{}.txt", count=3, **options) -> list[lab.Recording]:
    return [unit(source.format(k), None, noise=0.002, seed=k, **options) for k in range(count)]


def units(code, cell, runs=(1, 2, 3), folder="1unit", **options) -> list[lab.Recording]:
    return [
        unit(
            f"{folder}/1unit_{code}/1unit_{code}_{k}.txt", cell, noise=0.002, seed=10 + k, **options
        )
        for k in runs
    ]


def pairs(code, chain, runs=(1, 2, 3), folder="2unit_00_11", **options) -> list[lab.Recording]:
    return [
        pair(f"{folder}/2unit_{code}/2unit_{code}_{k}.txt", chain, seed=20 + k, **options)
        for k in runs
    ]


def no_bands(folder="2unit_00_11", **options) -> list[lab.Recording]:
    return [pair(f"{folder}/Friction/2unit_Friction_{k}.txt", None, **options) for k in (1, 2)]


@pytest.mark.parametrize("unloading", [False, True])
@pytest.mark.parametrize("code", PAPER_Q)
def test_a_unit_cell_that_is_the_model_agrees_both_ways(code, unloading):
    cell = CELL.with_anchors(q=PAPER_Q[code])
    data = units(code, cell, unloading=unloading) + frictions(unloading=unloading)
    (test,) = lab.compare(data).cells
    assert test.series.unloading == unloading
    assert test.rmse < 0.01
    assert test.agrees and test.right_class
    assert test.plain.is_bistable == cell.is_bistable
    assert test.plain.force_0 == pytest.approx(cell.force_0, abs=0.01)
    assert test.plain.force_1 == pytest.approx(cell.force_1, abs=0.01)
    assert test.plain.barrier == pytest.approx(cell.barrier, abs=1e-4)
    assert test.rmse_energy < 0.01
    assert test.rises == ()


def test_a_cell_of_the_wrong_class_differs_and_the_verdict_says_so():
    data = units("MB", CELL.with_anchors(q=(0.0, 0.015))) + frictions()
    (test,) = lab.compare(data).cells
    assert not test.right_class
    says(test.verdict, "differs", "monostable")


def test_a_softer_cell_differs_by_its_force_and_the_verdict_says_which_way():
    data = units("MT", doubled(MT, 0.7)) + frictions()
    (test,) = lab.compare(data).cells
    assert test.right_class and not test.agrees
    says(test.verdict, "differs", f"{test.rmse:.3f} k r", "below")
    assert test.worst > test.rmse > CLOSE


def test_a_force_that_rises_is_named_with_its_place():
    bump = units("MB", MB, runs=(1,))
    (run,) = bump
    stroke, force = run.stroke, run.force + 0.1 * np.exp(-(((run.stroke - 0.012) / 8e-4) ** 2))
    (test,) = lab.compare([recording(run.source, stroke, force), *frictions()]).cells
    ((start, end, height),) = test.rises
    assert 0.009 < start < end < 0.0125
    assert height > 0.05


def test_friction_of_the_rig_is_subtracted_and_without_a_baseline_said_to_be_there():
    data = units("MB", MB, friction=0.08) + frictions(friction=0.08)
    with_it, without = lab.compare(data).cells[0], lab.compare(data, baseline=()).cells[0]
    assert with_it.rmse < 0.01 < 0.1 < without.rmse
    says(without.series.notes, "baseline: none", "friction", "not subtracted")


def test_the_baseline_of_the_same_folder_direction_and_stroke_is_taken():
    near = frictions("1unit/friction/friction_{}.txt", friction=0.08)
    far = frictions("1unit_2/friction/friction_{}.txt", friction=0.02)
    back = frictions("1unit/back/friction_{}.txt", unloading=True)
    short = [recording("1unit/short/friction_1.txt", u := there(0.010), 9 + u)]
    (test,) = lab.compare(units("MB", MB, friction=0.08) + far + back + short + near).cells
    assert {run.source for run in test.series.baseline} == {run.source for run in near}
    assert test.rmse < 0.01
    # None in its own folder: one of another folder will do, and is named.
    (test,) = lab.compare(units("MB", MB, friction=0.02) + far).cells
    says(test.series.notes, "baseline: ", "friction_0, friction_1, friction_2")


def test_how_many_bands_were_on_is_judged_from_the_force():
    data = units("MB", MB, runs=(1, 2, 3)) + units("MB", doubled(MB, 2.4), runs=(5, 6, 7))
    one, two = lab.compare(data + frictions()).cells
    assert [one.series.bands, two.series.bands] == [1, 2]
    assert [r.name for r in two.series.recordings] == ["1unit_MB_5", "1unit_MB_6", "1unit_MB_7"]
    says(two.series.notes, "4", "missing")
    says(two.series.notes, "2 bands", "2.")
    assert two.series.scale == pytest.approx(2 * one.series.scale)


def test_names_of_other_anchors_need_no_design():
    cell = T.with_anchors(q=(0.020, 0.015))
    (test,) = lab.compare(units("TTL", cell, folder="1unit_2") + frictions()).cells
    assert test.cell.bands[0].d == pytest.approx((0.020, 0.015))
    assert test.agrees


def test_what_names_do_not_say_a_design_does():
    cell = Cell(Band((-0.012, 0.003), (0.014, -0.002), 40.0, 0.012), lever=0.016)
    data = [unit(f"mine/pull_{k}.txt", cell, seed=k, noise=0.002) for k in (1, 2)]
    with refuses(lab.LabError, "mine/pull_1", "give a design"):
        lab.compare(data)
    (test,) = lab.compare(data, [Chain([cell])], baseline=frictions_of(cell)).cells
    assert test.rmse < 0.01
    with refuses(lab.LabError, "mine/pull_1", "2 designs"):
        lab.compare(data, [Chain([cell]), Chain([cell, cell])])


def frictions_of(cell: Cell) -> list[lab.Recording]:
    way = there(cell.full_travel)
    return [recording("mine/friction_1.txt", way, 0.05 * (1 + 0.5 * way / 0.020))]


def test_a_design_gives_what_names_leave_open_or_all():
    cell = doubled(MB, 1.5)
    data = units("MB", cell) + frictions()
    stiff = Chain([doubled(CELL, 1.5)])
    assert lab.compare(data, [stiff]).cells[0].rmse < 0.01
    assert lab.compare(data, [Chain([cell])], as_designed=True).cells[0].rmse < 0.01
    with refuses(lab.LabError, "designs", "2", "1 cell"):
        lab.compare(data, [stiff, stiff])


def test_runs_that_their_name_marks_bad_are_dropped_and_reported():
    data = units("MB", MB) + units("MB_bad", MT) + frictions()
    comparison = lab.compare(data)
    assert len(comparison.cells) == 1
    assert sum("MB_bad" in line and "'bad'" in line for line in comparison.notes) == 3


def test_tension_tests_and_unknown_letters_are_reported_and_stop_nothing():
    up = there(0.04)
    others = [recording(f"b/1unit_bands_{k}.txt", up, up) for k in (1, 2)]
    others.append(recording("c/1unit_XYZ_1.txt", up, up))
    others.append(recording("d/pull_1.txt", up, up))
    told = lab.compare(units("MB", MB) + frictions() + others).notes
    says(told, "2", "tension tests", "stepwell lab band")
    says(told, "1unit_XYZ_1", "left out", "letters")
    assert any("give a design" in line for line in told)


DIRECTED = Chain([MM, MT])  # clockwise: snaps both ways
COUNTER = Chain([MM, MB])
VIA_10 = Chain([MM, CELL.with_anchors(q=(0.010, 0.015))])


@pytest.mark.parametrize("unloading", [False, True])
@pytest.mark.parametrize(
    ("code", "chain", "snaps"), [("MMT", DIRECTED, 1), ("MMB", COUNTER, 1), ("MML", VIA_10, 0)]
)
def test_order_and_snaps_of_a_pair_are_found_both_ways(code, chain, snaps, unloading):
    folder = "2unit_11_00" if unloading else "2unit_00_11"
    friction = (0.02, 0.06)
    data = pairs(code, chain, folder=folder, unloading=unloading, friction=friction)
    data += no_bands(folder, unloading=unloading, friction=friction)
    (test,) = lab.compare(data).pairs
    assert test.right_order is True
    assert test.ratio > 2
    assert test.right_snaps
    mean, spread, count = test.snap_strokes
    assert count == 3 * snaps
    if snaps:
        # Where the model with that friction snaps; the baseline tells its size.
        assert mean == pytest.approx(test.snaps_with_friction[0], abs=3e-4)
        assert spread < 2e-4
    # Up to the first snap; friction delays it, which the model without friction does not know.
    assert min(test.errors) < 0.03
    assert test.verdict.startswith("order agrees: ")


def test_the_baseline_of_a_pair_follows_the_cell_that_moves():
    # The inner cell rubs more, so without bands the outer one moves first.
    friction = (0.08, 0.02)
    data = pairs("MMT", DIRECTED, friction=friction) + no_bands(friction=friction)
    (test,) = lab.compare(data).pairs
    assert test.shown == (0, 1)
    # Subtracted as it was recorded, it would be wrong by the difference of the two.
    recorded = test.series.baseline_curve
    assert recorded is not None
    plain = test.series.curve.force - recorded.force
    early = test.inside & (test.stroke < 0.030)
    wrong, right = ((f - test.model)[early] / test.series.scale for f in (plain, test.force))
    assert float(np.sqrt(np.mean(right**2))) < 0.03
    assert float(np.sqrt(np.mean(wrong**2))) > 3 * float(np.sqrt(np.mean(right**2)))


def test_pairs_with_other_inner_cells_are_compared_too():
    inner, outer = T.with_anchors(q=(0.010, 0.0)), T.with_anchors(q=(0.020, 0.0))
    data = pairs("TMTT", Chain([inner, outer]), folder="2unit_2_00_11") + no_bands("2unit_2_00_11")
    (test,) = lab.compare(data).pairs
    assert [c.bands[0].d[0] for c in test.series.chain.levers] == [0.010, 0.020]
    assert test.right_order is not False


@pytest.mark.slow
def test_a_name_whose_anchors_make_no_sense_is_asked_about():
    """By its letters p and q of the outer cell are one point, where no band pulls."""
    cells = [T.with_anchors(q=q) for q in ((0.010, 0.0), (0.0, 0.0))]
    data = pairs("TMTBM", Chain(cells)) + no_bands()
    with refuses(lab.LabError, "p and q", "cell 2", "--as-designed"):
        lab.compare(data)
    meant = [T.with_anchors(q=q) for q in ((0.010, 0.0), (0.010, -0.015))]
    for unloading in (False, True):
        runs = pairs("TMTBM", Chain(meant), friction=(0.02, 0.02), unloading=unloading)
        with refuses(lab.LabError, "q at", "(10, -15) mm", "N", "--as-designed"):
            lab.compare(runs)
    others = pairs("MMB", COUNTER)
    told = lab.compare([*data, *others]).notes
    assert sum("TMTBM" in line and "--as-designed" in line for line in told) == 3
    (test,) = lab.compare(data, [COUNTER], as_designed=True).pairs
    assert test.series.chain == COUNTER


def test_identical_cells_are_a_tie_that_no_data_decide():
    data = pairs("MMM", Chain([MM, MM])) + no_bands()
    (test,) = lab.compare(data).pairs
    assert test.tie and test.right_order is None
    says(test.verdict, "tie", f"{test.ratio:.2f} to 1")


def test_the_wrong_order_is_found_out():
    # A force that no frictionless pair shows: the cell with the larger F0 went first.
    way = there(0.040)
    force = np.where(
        way <= 0.020,
        MM.force(MM.angle(np.minimum(way, 0.020))) + 0.02,
        MB.force(MB.angle(np.maximum(way - 0.020, 0.0))) + 0.06,
    )
    run = recording("2unit_00_11/2unit_MMB/2unit_MMB_1.txt", way, force)
    (test,) = lab.compare([run, *no_bands()]).pairs
    assert test.right_order is False
    says(test.verdict, "order differs", "inner then outer")


def test_a_snap_that_friction_holds_back_is_reported_with_both_forces():
    friction = (0.15, 0.15)
    (test,) = lab.compare(
        pairs("MMB", COUNTER, friction=friction) + no_bands(friction=friction)
    ).pairs
    assert test.snap_strokes[2] == 0 and not test.right_snaps
    assert 0 < test.pull < test.hold
    says(test.verdict, "friction", "0.30 N")


def test_jumps_that_are_no_snaps_are_not_invented():
    rng = np.random.default_rng(0)
    stroke = there(0.040)
    force = np.cos(stroke * 200) + rng.normal(0, 0.01, len(stroke))
    assert lab.find_snaps(stroke, force) == ()
    force[stroke > 0.03] += 0.2
    (snap,) = lab.find_snaps(stroke, force)
    assert snap.stroke == pytest.approx(0.03, abs=3e-4)
    assert snap.jump == pytest.approx(0.2, abs=0.05)
    assert lab.find_snaps(stroke, force, [(0.029, 0.031)]) == ()


def test_loading_and_unloading_in_one_recording_are_two_series():
    up, down = unit("m/1unit_MB_1.txt", MB), unit("m/1unit_MB_1.txt", MB, unloading=True)
    both = recording(
        "m/1unit_MB_1.txt",
        np.concatenate([up.stroke, 0.020 + down.stroke]),
        np.concatenate([up.force, down.force]),
    )
    tests = lab.compare([replace(both, remarks=("row 9",))]).cells
    assert [test.series.unloading for test in tests] == [False, True]
    # What was left out as it was read is told of both.
    for test in tests:
        assert "1unit_MB_1: row 9" in test.series.notes


def test_repeats_are_averaged_where_all_of_them_reach():
    late = units("MB", MB, runs=(1, 2))
    cut = late[1]
    keep = cut.stroke > 0.0008
    late[1] = recording(cut.source, cut.stroke[keep], cut.force[keep])
    (test,) = lab.compare(late + frictions()).cells
    assert test.series.curve.stroke[0] == pytest.approx(0.0008, abs=1e-4)
    assert test.agrees


@pytest.mark.slow
def test_results_go_to_xarray_csv_and_json(tmp_path):
    data = units("MB", MB) + frictions() + pairs("MMT", DIRECTED) + no_bands()
    comparison = lab.compare(data)
    rows = comparison.to_xarray()
    assert rows["force"].attrs["units"] == "N"
    assert set(rows["of"].values) == {0, 1}
    comparison.to_csv(tmp_path / "curves.csv")
    text = (tmp_path / "curves.csv").read_text("utf-8").splitlines()
    assert text[0] == "series,stroke_mm,measured_N,model_N,judged"
    assert len(text) == 1 + rows.sizes["row"]
    record = account(comparison).record
    assert json.loads(json.dumps(record, allow_nan=False)) == record
    says(repr(comparison), "Comparison(", "1 unit cells", "1 pairs")


@pytest.mark.slow
def test_order_of_runs_does_not_matter():
    data = units("MB", MB) + frictions() + units("MT", MT)
    forward, backward = lab.compare(data), lab.compare(data[::-1])
    found = [
        sorted((t.series.name, round(t.rmse, 12)) for t in c.cells) for c in (forward, backward)
    ]
    for (a, x), (b, y) in zip(*found, strict=True):
        assert a == b and x == pytest.approx(y, rel=1e-6)
    assert all(a.name <= b.name for a, b in pairwise(forward.cells[0].series.recordings))


def test_where_no_snap_is_predicted_no_unit_follows():
    assert _strokes((0.010, 0.0123)) == "10.00, 12.30 mm"
    assert _strokes(()) == "nowhere"
