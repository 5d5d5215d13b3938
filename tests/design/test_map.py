"""The transition map says what the chain does, and how it knows."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import stepwell as sw
from chains import concave_cell
from oracle import OracleCell, follow
from sizes import examples
from stepwell.concave.certificate import certify, simple
from stepwell.statics.batch import follow_each

MEANINGS = {p.name.lower(): p for p in sw.Pathway}


def cell(x: float, y: float, **band) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), **band))


PAPER = sw.Chain((cell(10, 0), cell(20, 0)))


def pathway(data: xr.Dataset, row: int, column: int) -> str:
    values = data.pathway.attrs["flag_values"].tolist()
    return data.pathway.attrs["flag_meanings"].split()[values.index(int(data.pathway[row, column]))]


def test_the_papers_map_has_its_four_pathways_in_their_shares():
    # Kamp et al. 2024, Fig. 2C; shares counted on the same box by an independent study.
    x, y = np.linspace(0, 0.020, 200), np.linspace(-0.015, 0.015, 200)
    data = sw.transition_map(PAPER, cell=1, x=x, y=y)
    share = {
        name: float((data.pathway == value).mean())
        for name, value in zip(
            data.pathway.attrs["flag_meanings"].split(),
            data.pathway.attrs["flag_values"],
            strict=True,
        )
    }
    expected = {"counterclockwise": 0.261, "via_01": 0.262, "via_10": 0.262, "clockwise": 0.215}
    assert {name: round(share[name], 3) for name in expected} == expected
    assert sum(share[name] for name in expected) == pytest.approx(1.0)


def variants() -> dict[str, sw.Chain]:
    short = sw.Chain((cell(-2, 0), cell(-4, 0)))
    slack = sw.Chain((cell(10, 0, rest_length=0.022), cell(20, 0, rest_length=0.022)))
    unequal = sw.Chain((cell(10, 0), replace(cell(20, 0), limit=0.5)))
    rubbing = sw.Chain((replace(cell(10, 0), friction=0.05), cell(20, 0)))
    compliant = sw.Chain(PAPER.cells, actuator_stiffness=30.0)
    return {
        "short": short,
        "slack": slack,
        "unequal": unequal,
        "rubbing": rubbing,
        "compliant": compliant,
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", variants())
@pytest.mark.parametrize("moving", [0, 1])
def test_every_design_of_a_map_does_what_the_engine_says(name, moving):
    chain = variants()[name]
    rng = np.random.default_rng(len(name))
    x, y = np.sort(rng.uniform(-0.009, 0.02, 6)), np.sort(rng.uniform(-0.015, 0.015, 6))
    data = sw.transition_map(chain, moving, x=x, y=y)
    for row in range(6):
        for column in range(6):
            cells = list(chain.cells)
            cells[moving] = cells[moving].with_anchors(q=(x[column], y[row]))
            design = replace(chain, cells=tuple(cells))
            cycle = design.cycle()
            assert MEANINGS[pathway(data, row, column)] is cycle.pathway
            assert bool(data.monostable[row, column]) is not cells[moving].is_bistable
            for direction, field in ((1, data.snap_loading), (-1, data.snap_unloading)):
                first = [s.stroke for s in cycle.snaps if s.direction == direction][:1]
                expected = first[0] if first else math.nan
                tolerance = 1e-12 * design.full_stroke
                assert float(field[row, column]) == pytest.approx(
                    expected, abs=tolerance, nan_ok=True
                )


def test_the_closed_form_is_used_only_where_it_is_proved():
    chain = variants()["short"]
    x, y = np.linspace(-0.009, 0.006, 12), np.linspace(-0.012, 0.012, 12)
    data = sw.transition_map(chain, x=x, y=y)
    proved = np.zeros((12, 12), bool)
    for row in range(12):
        for column in range(12):
            numbers = simple(chain.levers[1].with_anchors(q=(x[column], y[row])))
            assert numbers is not None
            proved[row, column] = certify(numbers, 0.0)
    assert 0 < proved.sum() < proved.size
    assert data.attrs["closed_form_designs"] == proved.sum()
    assert data.attrs["engine_designs"] == proved.size - proved.sum()
    assert np.array_equal(np.isfinite(data.margin), proved)


def in_closed_form(chain: sw.Chain) -> xr.Dataset | None:
    """The map of one design, or None where the closed form is not proved."""
    x, y = chain.levers[-1].bands[0].q
    data = sw.transition_map(chain, len(chain) - 1, x=[x], y=[y])
    return data.isel(x=0, y=0) if data.attrs["closed_form_designs"] else None


def first_snaps(cycle: sw.Cycle) -> list[float]:
    strokes = ([s.stroke for s in cycle.snaps if s.direction == way] for way in (1, -1))
    return [way[0] if way else math.nan for way in strokes]


@pytest.mark.slow
def test_concave_cells_do_in_closed_form_what_the_engine_follows():
    rng = np.random.default_rng(6)
    met, left = set(), 0
    for n in range(examples(150)):
        cells = [concave_cell(rng) for _ in range(2 + n % 3)]
        if n % 2 and len(cells) == 2:
            unequal = {"lever": rng.uniform(0.010, 0.020), "limit": rng.uniform(0.3, 1.0)}
            cells[rng.integers(2)] = replace(cells[rng.integers(2)], **unequal)
        chain = sw.Chain(tuple(cells))
        cycle, outcome = chain.cycle(), in_closed_form(chain)
        if outcome is None:
            # The proof fails, or a cell is pushed through its whole travel in the snap.
            left += 1
            continue
        words = outcome.sequence.attrs["flag_meanings"].split()
        assert words[int(outcome.sequence)] == str(cycle.sequence)
        met.add(cycle.pathway)
        expected = first_snaps(cycle)
        tolerance = 1e-12 * chain.full_stroke
        strokes = [float(outcome.snap_loading), float(outcome.snap_unloading)]
        assert strokes == pytest.approx(expected, abs=tolerance, nan_ok=True)
        gaps = [np.diff(np.sort([getattr(c, f"force_{k}") for c in cells])) for k in (0, 1)]
        smallest = np.min(gaps) / outcome.margin.attrs["k_r_N"]
        assert float(outcome.margin) == pytest.approx(smallest, abs=1e-12)
        assert bool(outcome.monostable) is not cells[-1].is_bistable
    assert met == {None, *MEANINGS.values()} - {sw.Pathway.OTHER}
    assert left > 0


@pytest.mark.slow
def test_snap_strokes_agree_with_brute_force():
    rng = np.random.default_rng(7)
    snapped = 0
    while snapped < examples(3):
        cells = [concave_cell(rng), concave_cell(rng)]
        chain = sw.Chain(tuple(cells))
        outcomes = in_closed_form(chain)
        if outcomes is None or np.isnan(outcomes.snap_loading) or np.isnan(outcomes.snap_unloading):
            continue
        expected = [float(outcomes.snap_loading), float(outcomes.snap_unloading)]
        full, steps = chain.full_stroke, 400
        # A snap smaller than a drive step is none to a follower with steps.
        if min(full - expected[0], expected[1]) < 4 * full / steps:
            continue
        snapped += 1
        slow = [
            OracleCell(
                c.lever,
                c.limit,
                [(*c.bands[0].d, c.bands[0].stiffness, c.bands[0].rest_length, 0.0, 0.0, False)],
            )
            for c in cells
        ]
        run = follow(slow, [0.0, full, 0.0], steps=steps, snap_travel=2 * full / steps)
        words = outcomes.sequence.attrs["flag_meanings"].split()
        assert run.sequence == words[int(outcomes.sequence)]
        assert [s.drive for s in run.snaps] == pytest.approx(expected, abs=2 * full / steps)


def test_friction_on_the_moved_cell_alone_sends_every_design_to_the_engine():
    chain = sw.Chain((cell(10, 0), replace(cell(20, 0), friction=0.05)))
    data = sw.transition_map(chain, x=[0.0, 0.01], y=[0.0])
    assert data.attrs["closed_form_designs"] == 0
    assert data.attrs["engine_designs"] == 2


def test_the_margin_is_the_smaller_gap_over_k_r_of_the_cell_that_stays():
    rng = np.random.default_rng(3)
    inner = cell(10, 0, stiffness=40.0)
    chain = sw.Chain((inner, cell(20, 0)))
    x, y = np.sort(rng.uniform(0, 0.02, 5)), np.sort(rng.uniform(-0.015, 0.015, 5))
    data = sw.transition_map(chain, x=x, y=y)
    for row in range(5):
        for column in range(5):
            outer = cell(x[column] * 1e3, y[row] * 1e3)
            gaps = abs(outer.force_0 - inner.force_0), abs(outer.force_1 - inner.force_1)
            expected = min(gaps) / (40.0 * inner.lever)
            assert float(data.margin[row, column]) == pytest.approx(expected, abs=1e-12)
    assert data.margin.attrs["k_r_N"] == pytest.approx(40.0 * inner.lever)
    assert data.margin.attrs["k_r_of"] == "inner"


def test_two_equal_cells_are_degenerate_and_no_others():
    data = sw.transition_map(PAPER, x=[0.009, 0.010, 0.011], y=[0.0])
    assert data.degenerate.values.tolist() == [[False, True, False]]
    assert float(data.margin[0, 1]) == 0.0


def test_mirroring_the_anchor_swaps_loading_and_unloading():
    rng = np.random.default_rng(8)
    y = np.linspace(-0.015, 0.015, 31)
    x = np.sort(rng.uniform(0, 0.02, 20))
    data = sw.transition_map(PAPER, x=x, y=y)
    full = PAPER.full_stroke
    mirrored = data.snap_unloading.values[::-1]
    # At y = 0 a cell mirrors onto itself; elsewhere y -> -y exchanges the two ends of the cycle.
    np.testing.assert_allclose(data.snap_loading.values, full - mirrored, atol=1e-12 * full)
    np.testing.assert_allclose(data.margin.values, data.margin.values[::-1], atol=1e-12)


def test_a_place_where_the_ends_of_the_band_meet_is_marked_and_not_an_error():
    chain = sw.Chain((cell(10, 0), cell(20, 0, rest_length=1e-4, two_sided=True)))
    # d = (-10, -10) mm and a lever of 10 sqrt(2) mm: the band has no length at θ = 45°, and pushes.
    data = sw.transition_map(chain, x=[-0.020, 0.010], y=[-0.010])
    # The other place by hand, over k r: outer about 0.71 and -2.12, inner 1.61 and -1.61.
    assert [pathway(data, 0, column) for column in range(2)] == ["impossible", "via_01"]
    assert data.attrs["impossible_designs"] == 1
    assert np.isnan(data.snap_loading[0, 0])


@pytest.mark.parametrize("kernels", ["auto", "interpreted"])
def test_progress_reaches_the_number_of_designs_the_engine_had(monkeypatch, kernels):
    # Interpreted, blocks are small, and progress is reported before what is left is known.
    monkeypatch.setenv("STEPWELL_KERNELS", kernels)
    if kernels == "interpreted":
        monkeypatch.setattr(follow_each, "_machine", None)
    chain = variants()["rubbing"]
    calls: list[tuple[int, int]] = []
    sw.transition_map(
        chain, x=[0.0, 0.01], y=[0.0, 0.01], progress=lambda *done: calls.append(done)
    )
    assert calls == sorted(calls)
    assert calls[-1] == (4, 4)


def test_a_map_survives_its_file(tmp_path):
    data = sw.transition_map(PAPER, x=[0.0, 0.01], y=[0.0, 0.005, 0.01])
    data.to_netcdf(tmp_path / "map.nc")
    with xr.open_dataset(tmp_path / "map.nc") as back:
        assert back.identical(data)
        assert back.x.attrs["units"] == "m"


def test_a_cell_may_be_called_by_its_name():
    named = replace(PAPER, cells=(replace(PAPER.cells[0], name="hip"), PAPER.cells[1]))
    by_name = sw.transition_map(named, "hip", x=[0.01], y=[0.001])
    assert by_name.identical(sw.transition_map(named, 0, x=[0.01], y=[0.001]))
    assert by_name.attrs["moved_cell"] == "hip"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"chain": sw.Chain(PAPER.cells[:1])}, r"cell = 1: must be 0 or"),
        ({"cell": 2}, r"cell = 2: must be 0 or 'inner'"),
        ({"cell": "knee"}, r"cell = 'knee': must be"),
        ({"cell": -1}, r"cell = -1: must be 0 or 'inner', 1 or 'outer'\."),
        ({"x": [0.01, 0.0]}, r"outer\.q\.x must rise"),
        ({"y": [[0.0]]}, r"values of outer\.q\.y have shape \(1, 1\)"),
        ({"y": [math.nan]}, r"finite"),
    ],
)
def test_wrong_input_is_refused_with_what_is_allowed(arguments, message):
    good = {"chain": PAPER, "cell": 1, "x": [0.0], "y": [0.0]}
    with pytest.raises(ValueError, match=message):
        sw.transition_map(**(good | arguments))
