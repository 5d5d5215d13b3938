"""Boundaries are where the chain changes what it does, and nowhere else."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stepwell as sw
from facts import says
from sizes import examples
from stepwell.design import Boundary, BoundaryKind, boundaries
from stepwell.design.plane import trace

X, Y = (0.0, 0.020), (-0.015, 0.015)


def cell(x: float, y: float, **band) -> sw.Cell:
    return sw.Cell(sw.Band((-0.010, 0.0), (x * 1e-3, y * 1e-3), **band))


PAPER = sw.Chain((cell(10, 0), cell(20, 0)))
SHORT = sw.Chain((cell(-2, 0), cell(-4, 0)))
SHORT_X, SHORT_Y = (-0.009, 0.006), (-0.012, 0.012)


def design(chain: sw.Chain, moving: int, q: np.ndarray) -> sw.Chain:
    cells = list(chain.levers)
    cells[moving] = cells[moving].with_anchors(q=(float(q[0]), float(q[1])))
    return replace(chain, cells=tuple(cells))


def sequences_around(chain: sw.Chain, moving: int, q: np.ndarray, away: float) -> set[str]:
    angles = np.linspace(0, 2 * np.pi, 8, endpoint=False) + 0.1
    around = [q + away * np.array([math.cos(a), math.sin(a)]) for a in angles]
    return {str(design(chain, moving, place).cycle().sequence) for place in around}


def some(boundary: Boundary, count: int) -> np.ndarray:
    inside = boundary.points[1:-1]
    return inside[np.linspace(0, len(inside) - 1, min(count, len(inside))).astype(int)]


@cache
def of_paper(*moving: int) -> tuple[Boundary, ...]:
    """The boundaries of the paper's map, at which several tests look."""
    return boundaries(PAPER, *moving, x=X, y=Y)


def orders(curves: tuple[Boundary, ...]) -> list[Boundary]:
    return [b for b in curves if b.kind is not BoundaryKind.BISTABLE]


def kinds(curves: tuple[Boundary, ...]) -> list[BoundaryKind]:
    return [b.kind for b in curves]


def test_the_papers_map_has_two_order_curves_and_two_limits_of_bistability():
    curves = of_paper()
    # The two order curves cross where both cells are alike, and part four regions there.
    assert kinds(curves) == [
        *2 * [BoundaryKind.LOADING_ORDER],
        *2 * [BoundaryKind.UNLOADING_ORDER],
        *2 * [BoundaryKind.BISTABLE],
    ]
    assert {b.method for b in curves} == {"exact"}
    assert len({frozenset(b.sequences) for b in curves[:4]}) == 4
    for boundary in curves[:4]:
        assert np.min(np.linalg.norm(boundary.points - (0.010, 0.0), axis=1)) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("moving", [0, 1])
def test_on_an_exact_boundary_the_forces_are_equal_to_rounding(moving):
    stays = PAPER.cells[1 - moving]
    scale = stays.bands[0].stiffness * stays.lever
    for boundary in orders(of_paper(moving)):
        for q in boundary.points:
            moved = design(PAPER, moving, q).cells[moving]
            gap = (
                moved.force_0 - stays.force_0
                if boundary.kind is BoundaryKind.LOADING_ORDER
                else moved.force_1 - stays.force_1
            )
            assert abs(gap) <= 1e-12 * scale
        assert boundary.error < 1e-14


@pytest.mark.slow
def test_across_an_exact_boundary_the_sequence_changes_within_a_nanometre():
    for boundary in orders(of_paper()):
        for q in some(boundary, 6):
            assert len(sequences_around(PAPER, 1, q, 1e-9)) == 2


@pytest.mark.slow
def test_exact_boundaries_run_from_rim_to_crossing_and_stay_in_the_box():
    for boundary in of_paper():
        x, y = boundary.points.T
        assert x.min() >= X[0] - 1e-15
        assert x.max() <= X[1] + 1e-15
        assert y.min() >= Y[0] - 1e-15
        assert y.max() <= Y[1] + 1e-15
        for end in boundary.points[[0, -1]]:
            to_rim = min(*np.abs(end[0] - np.array(X)), *np.abs(end[1] - np.array(Y)))
            assert to_rim < 1e-15 or np.linalg.norm(end - (0.010, 0.0)) < 1e-9


@pytest.mark.slow
def test_chords_of_an_exact_boundary_stay_close_to_the_curve():
    diagonal = math.hypot(0.020, 0.030)
    stays = PAPER.levers[0]
    for boundary in orders(of_paper()):
        middle = (boundary.points[1:] + boundary.points[:-1]) / 2
        for q in middle[::10]:
            moved = design(PAPER, 1, q).levers[1]
            gap = (
                moved.force_0 - stays.force_0
                if boundary.kind is BoundaryKind.LOADING_ORDER
                else moved.force_1 - stays.force_1
            )
            # |∂F/∂d| is at least k (1 - ℓ0/ℓ) > k/2 in this box.
            assert abs(gap) / (28.5 / 2) < 1e-4 * diagonal


@pytest.mark.parametrize(
    "chain",
    [
        pytest.param(PAPER, id="concave"),
        pytest.param(SHORT, id="partly concave", marks=pytest.mark.slow),
    ],
)
def test_wherever_neighbours_on_a_map_differ_a_boundary_passes_between(chain):
    box_x, box_y = (X, Y) if chain is PAPER else (SHORT_X, SHORT_Y)
    x, y = np.linspace(*box_x, 31), np.linspace(*box_y, 31)
    pathway = sw.transition_map(chain, x=x, y=y).pathway.values
    curves = boundaries(chain, x=box_x, y=box_y, search=31)
    points = np.concatenate([b.points for b in orders(curves)])
    step = max(x[1] - x[0], y[1] - y[0])
    for row, column in np.argwhere(pathway[:, 1:] != pathway[:, :-1]):
        middle = np.array([(x[column] + x[column + 1]) / 2, y[row]])
        assert np.min(np.linalg.norm(points - middle, axis=1)) < step
    for row, column in np.argwhere(pathway[1:] != pathway[:-1]):
        middle = np.array([x[column], (y[row] + y[row + 1]) / 2])
        assert np.min(np.linalg.norm(points - middle, axis=1)) < step


@pytest.mark.slow
def test_past_the_proof_the_engine_is_asked_and_the_boundary_says_so():
    curves = boundaries(SHORT, x=SHORT_X, y=SHORT_Y, search=25)
    searched = [b for b in curves if b.method == "search"]
    assert searched
    for boundary in searched:
        assert boundary.error <= 1e-8
        for q in some(boundary, 3):
            assert len(sequences_around(SHORT, 1, q, 3e-9)) >= 2
    # What the search finds is not what F0 and F1 would have said.
    gaps = [
        min(abs(c.force_0 - SHORT.levers[0].force_0), abs(c.force_1 - SHORT.levers[0].force_1))
        for b in searched
        for c in [design(SHORT, 1, q).levers[1] for q in some(b, 3)]
    ]
    assert max(gaps) > 1e-6


@pytest.mark.slow
def test_no_curve_is_drawn_twice():
    # Unequal limits: some designs need the engine though both cells are concave, and the
    # order curves run through them.
    chain = sw.Chain((cell(10, 0), replace(cell(20, 0), limit=0.5)))
    curves = boundaries(chain, x=X, y=Y, search=31)
    searched = [b for b in curves if b.method == "search"]
    assert [b.kind for b in curves[:2]] == [
        BoundaryKind.LOADING_ORDER,
        BoundaryKind.UNLOADING_ORDER,
    ]
    assert searched
    exact = np.concatenate([b.points for b in curves[:2]])
    for boundary in searched:
        distance = np.linalg.norm(boundary.points[:, None] - exact[None], axis=2).min(axis=1)
        assert np.median(distance) > 1e-4


@pytest.mark.slow
@pytest.mark.parametrize(
    "moved",
    [
        cell(20, 0),
        cell(20, 0, rest_length=0.022),
        cell(20, 0, two_sided=True),
        replace(cell(20, 0), load=sw.Load.constant(0.1)),
    ],
    ids=["taut", "slack", "two-sided", "loaded"],
)
def test_a_limit_of_bistability_has_a_bistable_side(moved):
    chain = sw.Chain((cell(10, 0), moved))
    limits = [
        b
        for b in boundaries(chain, x=(-0.010, 0.020), y=Y, search=examples(9, full=15))
        if b.kind is BoundaryKind.BISTABLE
    ]
    assert limits
    for boundary in limits:
        away = 1e-6 if boundary.method == "exact" else 3e-9
        straight = len(boundary.points) == 2
        for q in (
            [boundary.points.mean(axis=0)] if straight else some(boundary, examples(2, full=4))
        ):
            angles = np.linspace(0, 2 * np.pi, 8, endpoint=False) + 0.1
            around = [
                moved.with_anchors(q=(q[0] + away * math.cos(a), q[1] + away * math.sin(a)))
                for a in angles
            ]
            assert {c.is_bistable for c in around} == {True, False}


@pytest.mark.slow
def test_on_the_limits_of_bistability_an_end_force_is_zero():
    for state, boundary in enumerate(of_paper()[4:]):
        assert f"F{state} = 0" in boundary.changes
        for q in boundary.points:
            moved = design(PAPER, 1, q).levers[1]
            force = moved.force_1 if state else moved.force_0
            assert abs(force) < 1e-12 * 28.5 * moved.lever


@pytest.mark.slow
def test_chains_without_closed_form_have_searched_boundaries_only():
    chain = sw.Chain((replace(cell(10, 0), friction=0.05), cell(20, 0)))
    curves = boundaries(chain, x=X, y=Y, search=9)
    assert {b.method for b in orders(curves)} == {"search"}
    assert any(b.kind is BoundaryKind.LOADING_ORDER for b in curves)
    assert any("00>10>11>01>00" in b.sequences for b in curves)


def test_a_boundary_prints_what_changes_and_how_it_was_found():
    text = repr(of_paper()[0])
    says(text, "inner and outer", "loading", "exact")


@pytest.mark.slow
def test_of_any_chain_each_point_parts_the_two_sequences_that_it_says():
    chain = sw.Chain((cell(10, 0), cell(15, 10), cell(12, -5)))
    curves = orders(boundaries(chain, 1, x=X, y=Y))
    assert len(curves) >= 4
    for boundary in curves:
        q = boundary.points[len(boundary.points) // 2]
        assert sequences_around(chain, 1, q, 1e-9) == set(boundary.sequences)


def test_curves_between_labels_are_closed_or_end_on_the_rim_or_at_a_third_label():
    rng = np.random.default_rng(0)
    for labels in (2, 3):
        label = rng.integers(0, labels, (12, 15))

        def centre(row: int, column: int, label: np.ndarray = label) -> int:
            return int(label[row, column])

        lines = [(np.stack(a, 1), np.stack(b, 1)) for a, b in trace(label, centre)]
        crossed = sum(
            len(low)
            - (len(low) > 1 and bool((low[0] == low[-1]).all() * (high[0] == high[-1]).all()))
            for low, high in lines
        )
        assert crossed == np.sum(label[1:] != label[:-1]) + np.sum(label[:, 1:] != label[:, :-1])
        for low, high in lines:
            sides = [{*ends} for ends in np.stack([label[*low.T], label[*high.T]], 1).tolist()]
            assert all(len(ends) == 2 and ends == sides[0] for ends in sides)
            closed = (low[0] == low[-1]).all() and (high[0] == high[-1]).all()
            if labels == 2 and not closed:
                for a, b in ((low[0], high[0]), (low[-1], high[-1])):
                    across = a[0] == b[0]
                    rim = a[0] in (0, 11) if across else a[1] in (0, 14)
                    assert rim
