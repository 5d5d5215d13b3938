"""A map over two parameters says what the chain does there, and its curves part what differs."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given, strategies as st

import stepwell as sw
from chains import any_chain, concave_chain
from facts import refuses, says
from sizes import examples
from stepwell.design import Boundary, BoundaryKind, parameter_boundaries, parameter_map
from stepwell.design.parameters import parameter, parameters
from stepwell.sequences.cycles import snapping_steps


def cell(x: float, y: float, **band) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), **band))


PAPER = sw.Chain((cell(10, 0), cell(20, 0)))
TILTED = sw.Chain((cell(10, 0), cell(15, 10)))
THREE = sw.Chain((cell(10, 0), cell(15, 10), cell(12, -5)))

# A range of values that most chains can have, by the unit of the parameter.
RANGES = {"m": (0.006, 0.018), "N/m": (15.0, 60.0), "rad": (0.6, 0.9), "N": (0.0, 0.1)}


def meaning(data: xr.Dataset, row: int, column: int) -> str:
    codes = data.sequence.attrs["flag_values"].tolist()
    code = int(data.sequence[row, column])
    return data.sequence.attrs["flag_meanings"].split()[codes.index(code)]


def design(chain: sw.Chain, names: tuple[str, str], values: tuple[float, float]) -> sw.Chain:
    for name, value in zip(names, values, strict=True):
        chain = parameter(chain, name).changed(chain, value)
    return chain


def some(curve: Boundary, count: int) -> list[int]:
    """Numbers of a few points, none at an end."""
    inside = np.arange(1, len(curve.points) - 1)
    return inside[np.linspace(0, len(inside) - 1, min(count, len(inside))).astype(int)].tolist()


def orders(curves: tuple[Boundary, ...]) -> tuple[Boundary, ...]:
    """Without the limits of bistability."""
    return tuple(b for b in curves if b.kind is not BoundaryKind.BISTABLE)


def beside(curve: Boundary, i: int, spans: np.ndarray, away: float) -> list[np.ndarray]:
    """Places on both sides of a point of the curve, `away` of the axes from it."""
    tangent = (curve.points[i + 1] - curve.points[i - 1]) / spans
    normal = np.array([-tangent[1], tangent[0]]) / np.linalg.norm(tangent)
    return [curve.points[i] + sign * away * normal * spans for sign in (1, -1)]


@pytest.mark.parametrize("moving", [0, 1])
@pytest.mark.parametrize(
    "chain",
    [
        PAPER,
        sw.Chain((cell(-2, 0), cell(-4, 0))),
        sw.Chain((cell(10, 0), replace(cell(20, 0), limit=0.5))),
        sw.Chain(PAPER.cells, actuator_stiffness=30.0),
    ],
    ids=["concave", "partly concave", "unequal", "compliant"],
)
def test_over_an_anchor_of_a_pair_it_is_the_transition_map(chain, moving):
    x, y = np.linspace(-0.008, 0.020, 9), np.linspace(-0.015, 0.015, 9)
    name = chain.names[moving]
    data = parameter_map(chain, (f"{name}.q.x", x), (f"{name}.q.y", y))
    known = sw.transition_map(chain, moving, x=x, y=y)
    words = known.pathway.attrs["flag_meanings"].split()
    codes = known.pathway.attrs["flag_values"].tolist()
    four = {p.name.lower(): p.value for p in sw.Pathway if p is not sw.Pathway.OTHER}
    for row in range(9):
        for column in range(9):
            word = words[codes.index(int(known.pathway[row, column]))]
            sequence = meaning(data, row, column)
            assert sequence == four[word] if word in four else sequence not in four.values()
    for way in ("loading", "unloading"):
        snaps = np.isfinite(known[f"snap_{way}"])
        assert np.array_equal(data[f"snaps_{way}"] > 0, snaps)
    assert np.array_equal(data.degenerate, known.degenerate)
    assert data.attrs["closed_form_designs"] <= known.attrs["closed_form_designs"]


@st.composite
def maps(draw) -> tuple[sw.Chain, tuple[str, str]]:
    """A chain, concave ones more often than others, and two of its parameters."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    kind = draw(st.sampled_from([concave_chain, concave_chain, any_chain]))
    chain = kind(rng, draw(st.integers(1, 4)))
    names = [one.name for one in parameters(chain) if not one.is_anchor]
    return chain, tuple(draw(st.lists(st.sampled_from(names), min_size=2, max_size=2, unique=True)))


@pytest.mark.slow
@given(maps())
def test_every_node_does_what_the_engine_says(case):
    chain, names = case
    ranges = [RANGES[parameter(chain, name).unit] for name in names]
    x, y = (np.linspace(*one, 3) for one in ranges)
    try:
        data = parameter_map(chain, (names[0], x), (names[1], y))
    except ValueError as refused:
        # The first of several bands has no rest length to scale the others with.
        assume("scaled" not in str(refused))
        raise
    for row in range(3):
        for column in range(3):
            sequence = meaning(data, row, column)
            if sequence in ("impossible", "unsolved"):
                continue
            result = design(chain, names, (float(x[column]), float(y[row]))).cycle()
            assert sequence == str(result.sequence)
            snaps = int(data.snaps_loading[row, column]), int(data.snaps_unloading[row, column])
            assert snaps == snapping_steps(result)
            assert bool(data.degenerate[row, column]) == bool(result.degenerate)


@pytest.mark.parametrize(
    ("x", "closed"),
    [
        ("outer.stiffness", 16),
        ("inner.friction", 4),  # where it is zero
        ("outer.lever", 16),  # of two cells, travels may differ
        ("actuator_stiffness", 0),
    ],
)
def test_the_closed_form_serves_where_it_is_proved_and_nowhere_else(x, closed):
    line = np.linspace(0.0 if x == "inner.friction" else 0.010, 0.020, 4)
    data = parameter_map(PAPER, (x, line), ("outer.q.x", np.linspace(0.010, 0.020, 4)))
    assert data.attrs["closed_form_designs"] == closed
    assert data.attrs["engine_designs"] == 16 - closed


def test_equal_travels_of_other_levers_are_sorted_in_closed_form():
    # S = 2 r sin θc: at sin θc = 0.5 and r = 20 mm as at 45° and 10√2 mm.
    chain = sw.Chain((cell(10, 0), cell(12, -5), replace(cell(20, 0), lever=0.020)))
    angles = [0.4, math.pi / 6, 0.6]
    data = parameter_map(chain, ("3.limit", angles), ("3.stiffness", [20.0, 30.0]))
    assert data.attrs["closed_form_designs"] == 2


def test_a_chain_of_many_cells_is_mapped_and_its_sequences_reported_by_their_moves():
    rng = np.random.default_rng(7)
    chain = concave_chain(rng, 15)
    line = np.linspace(20.0, 40.0, 5)
    data = parameter_map(chain, ("4.stiffness", line), ("9.stiffness", line))
    assert data.attrs["closed_form_designs"] == 25
    words = meaning(data, 2, 3)
    assert words.startswith("moves:")
    result = design(chain, ("4.stiffness", "9.stiffness"), (line[3], line[2])).cycle()
    assert words == "moves:" + ",".join(str(flip[0]) for flip in result.sequence.flips)


def test_nodes_that_cannot_be_made_are_reported_and_have_no_snaps():
    # q - p = (-14.14, 0) mm folds the band onto itself where the lever is straight, and it pushes.
    chain = sw.Chain((cell(10, 0, rest_length=1e-4, two_sided=True), cell(20, 0)))
    x = [-0.010 - 0.010 * math.sqrt(2), 0.0]
    data = parameter_map(chain, ("inner.q.x", x), ("inner.q.y", [0.0]))
    assert meaning(data, 0, 0) == "impossible"
    assert data.attrs["impossible_designs"] == 1
    assert data.snaps_loading.values.tolist()[0][0] == -1


def test_two_equal_cells_are_degenerate_and_no_others():
    data = parameter_map(
        PAPER, ("outer.q.x", [0.009, 0.010, 0.011]), ("outer.stiffness", [20.0, 28.5])
    )
    assert data.degenerate.values.tolist() == [[False, False, False], [False, True, False]]


def test_the_map_names_its_axes_with_their_units():
    data = parameter_map(PAPER, ("inner.stiffness", [20, 30]), ("2.q.x", [0.01, 0.02]))
    assert data.x.attrs == {"long_name": "inner.stiffness", "units": "N/m"}
    assert data.y.attrs == {"long_name": "outer.q.x", "units": "m"}
    assert data.sizes == {"y": 2, "x": 2}


@pytest.mark.slow
@pytest.mark.parametrize("chain", [PAPER, TILTED, THREE], ids=["pair", "tilted", "three"])
def test_on_the_two_sides_of_a_curve_the_chain_does_the_two_sequences(chain):
    names = (f"{chain.names[-1]}.q.x", f"{chain.names[0]}.stiffness")
    x, y = (0.0, 0.020), (15.0, 60.0)
    spans = np.array([np.ptp(x), np.ptp(y)])
    curves = orders(parameter_boundaries(chain, (names[0], x), (names[1], y), search=31))
    assert curves
    for curve in curves:
        assert curve.method == "exact"
        for i in some(curve, examples(4)):
            sides = {
                str(design(chain, names, tuple(place)).cycle().sequence)
                for place in beside(curve, i, spans, 1e-7)
            }
            assert sides == set(curve.sequences)


@pytest.mark.slow
def test_an_exact_curve_is_where_two_forces_are_equal_to_rounding():
    names = ("inner.stiffness", "outer.q.x")
    curves = orders(
        parameter_boundaries(TILTED, (names[0], (15.0, 60.0)), (names[1], (0.0, 0.020)), search=31)
    )
    kinds = {curve.kind for curve in curves}
    assert kinds == {BoundaryKind.LOADING_ORDER, BoundaryKind.UNLOADING_ORDER}
    for curve in curves:
        end = "force_0" if curve.kind is BoundaryKind.LOADING_ORDER else "force_1"
        for point in curve.points:
            inner, outer = design(TILTED, names, tuple(point)).levers
            scale = inner.bands[0].stiffness * inner.lever
            assert abs(getattr(inner, end) - getattr(outer, end)) < 1e-12 * scale


def test_without_tilt_both_orders_change_on_one_straight_line_of_stiffnesses():
    # F = k × (a length): the sequence depends on the ratio of the two k.
    inner, outer = PAPER.levers
    ratio = outer.force_0 / inner.force_0
    curves = parameter_boundaries(
        PAPER, ("inner.stiffness", (20.0, 80.0)), ("outer.stiffness", (10.0, 40.0)), search=21
    )
    (curve,) = curves
    assert curve.kind is BoundaryKind.PATHWAY
    says(curve.changes, "inner and outer", "loading and unloading")
    assert set(curve.sequences) == {"00>10>11>01>00", "00>01>11>10>00"}
    np.testing.assert_allclose(curve.points[:, 0] / curve.points[:, 1], ratio, rtol=1e-12)


@pytest.mark.slow
def test_friction_moves_the_curves_by_its_force_exactly():
    # A cell leaves 0 at F0 + f and leaves 1 at F1 - f.
    names = ("outer.q.x", "inner.friction")
    curves = orders(
        parameter_boundaries(TILTED, (names[0], (0.0, 0.020)), (names[1], (0.01, 0.15)), search=15)
    )
    kinds = {curve.kind: curve for curve in curves}
    assert set(kinds) == {BoundaryKind.LOADING_ORDER, BoundaryKind.UNLOADING_ORDER}
    for kind, curve in kinds.items():
        assert curve.method == "search"
        for point in curve.points:
            inner, outer = design(TILTED, names, tuple(point)).levers
            gap = (
                outer.force_0 - inner.force_0 - inner.friction
                if kind is BoundaryKind.LOADING_ORDER
                else inner.force_1 - inner.friction - outer.force_1
            )
            assert abs(gap) < 1e-7


@pytest.mark.slow
def test_a_softer_actuator_keeps_the_sequence_and_snaps_more():
    stiffness = np.geomspace(3.0, 3000.0, 6)
    data = parameter_map(
        TILTED, ("outer.q.x", np.linspace(0.001, 0.020, 6)), ("actuator_stiffness", stiffness)
    )
    for column in range(6):
        assert len({meaning(data, row, column) for row in range(6)}) == 1
    # Every cell snaps by itself where the actuator gives way more than the cell does.
    assert np.all(data.snaps_loading[0] == 2)
    assert np.all(data.snaps_loading[-1] < 2)
    nodes = np.geomspace(3.0, 3000.0, 9)
    curves = parameter_boundaries(
        TILTED, ("outer.q.x", (0.001, 0.020)), ("actuator_stiffness", nodes), search=9
    )
    assert [curve.kind for curve in curves] == [
        BoundaryKind.LOADING_ORDER,
        BoundaryKind.UNLOADING_ORDER,
    ]
    for curve in curves:
        assert curve.method == "search"
        assert np.ptp(curve.points[:, 0]) < 1e-9
        # The grid keeps the spacing of the values.
        np.testing.assert_allclose(curve.points[:, 1], nodes)


def test_wherever_neighbours_on_a_map_differ_a_curve_passes_between():
    x, y = np.linspace(0.002, 0.012, 21), np.linspace(0.0, 0.020, 21)
    data = parameter_map(THREE, ("1.rest_length", x), ("3.q.x", y))
    curves = parameter_boundaries(THREE, ("1.rest_length", x), ("3.q.x", y), search=21)
    assert {curve.parameters for curve in curves} == {("cell 1.rest_length", "cell 3.q.x")}
    points = np.concatenate([curve.points for curve in curves])
    step = np.array([x[1] - x[0], y[1] - y[0]])
    code = data.sequence.values
    for row, column in np.argwhere(code[:, 1:] != code[:, :-1]):
        middle = np.array([(x[column] + x[column + 1]) / 2, y[row]])
        assert np.min(np.max(np.abs(points - middle) / step, axis=1)) < 1
    for row, column in np.argwhere(code[1:] != code[:-1]):
        middle = np.array([x[column], (y[row] + y[row + 1]) / 2])
        assert np.min(np.max(np.abs(points - middle) / step, axis=1)) < 1


@pytest.mark.slow
def test_a_long_chain_names_the_cells_that_change_places():
    chain = concave_chain(np.random.default_rng(8), 6)
    curves = parameter_boundaries(
        chain, ("3.q.x", (0.0, 0.020)), ("3.q.y", (-0.010, 0.010)), search=31
    )
    named = [curve.changes for curve in curves]
    assert any("cell 3" in text and "change order while" in text for text in named)
    assert all(">" not in text for text in named)
    assert all(">" in side for curve in curves for side in curve.sequences)


def test_progress_counts_the_designs_of_the_engine():
    calls: list[tuple[int, int]] = []
    x, y = ("inner.friction", [0.0, 0.1]), ("outer.q.x", [0.010, 0.015, 0.020])
    parameter_map(PAPER, x, y, progress=lambda *done: calls.append(done))
    assert calls == sorted(calls)
    assert calls[-1] == (3, 3)
    calls.clear()
    parameter_boundaries(PAPER, x, y, search=3, progress=lambda *done: calls.append(done))
    assert calls[-1] == (6, 6)


def test_a_curve_prints_what_changes_and_how_it_was_found():
    curves = parameter_boundaries(
        PAPER, ("outer.q.x", (0.005, 0.015)), ("outer.stiffness", (20.0, 40.0)), search=9
    )
    assert curves[0].error < 1e-14
    assert f"exact, within {curves[0].error:.1g} of the axes" in repr(curves[0])
    assert "change order" in repr(curves[0])


@pytest.mark.parametrize(
    ("x", "y", "words"),
    [
        (("inner.q.x", [0.0, 0.1]), ("1.q.x", [0.0, 0.1]), "are both 'inner.q.x'"),
        (("inner.q", [0.0, 1.0]), ("outer.q.x", [0.0, 1.0]), "is a point, not a number"),
        (("inner.stiffness", [-1.0, 1.0]), ("outer.q.x", [0.0, 1.0]), "must be > 0"),
        (("inner.limit", [0.5, 2.0]), ("outer.q.x", [0.0, 1.0]), "0.01° to 89.9°"),
        (("inner.stifness", [1.0, 2.0]), ("outer.q.x", [0.0, 1.0]), "Did you mean"),
        (("inner.stiffness", [2.0, 1.0]), ("outer.q.x", [0.0, 1.0]), "must rise"),
        ("inner.stiffness", ("outer.q.x", [0.0, 1.0]), "the name of a parameter and its values"),
    ],
)
def test_axes_that_are_none_are_refused(x, y, words):
    with pytest.raises(ValueError, match=words):
        parameter_map(PAPER, x, y)


def test_one_value_is_a_map_and_no_boundary():
    x, y = ("inner.stiffness", [20.0]), ("outer.q.x", [0.0, 0.020])
    assert parameter_map(PAPER, x, y).sizes == {"y": 2, "x": 1}
    with refuses(ValueError, "inner.stiffness", "2 or more"):
        parameter_boundaries(PAPER, x, y)
    with pytest.raises(ValueError, match="2 or more nodes"):
        parameter_boundaries(PAPER, ("inner.stiffness", [20.0, 30.0]), y, search=1)
