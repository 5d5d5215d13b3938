"""Within the radius no displacement of all anchors at once does anything; just past it one does."""

import math
from itertools import pairwise

import numpy as np
import pytest

import stepwell as sw
from chains import concave_chain
from facts import says
from sizes import examples
from stepwell.concave import Simple, concave_disc
from stepwell.design.margins.robustness import AnchorProof, Robustness, farthest, robustness
from stepwell.design.parameters import of_cell
from stepwell.design.plane import Box
from stepwell.design.synthesis.candidates import Kind
from stepwell.design.synthesis.region import BandType

R, LIMIT = 0.010 * math.sqrt(2.0), math.pi / 4


def row(*x: float) -> sw.Chain:
    """Cells with d_y = 0 and these q_x [mm]."""
    bands = (sw.Band((-0.010, 0.0), (mm * 1e-3, 0.0)) for mm in x)
    return sw.Chain([sw.Cell(band, unusual=True) for band in bands])  # an anchor at 0.01 mm


def by_brute_force(x: tuple[float, ...]) -> float:
    """The radius by formula and dense sampling, written independently [mm]."""
    angle = np.linspace(0, 2 * np.pi, 2881)
    disc = np.column_stack([np.cos(angle), np.sin(angle)])

    def force(side: int, d: np.ndarray) -> np.ndarray:
        length = np.hypot(10 + d[..., 0], side * 10 + d[..., 1])
        return (1 - 10 / length) * (d[..., 1] - side * d[..., 0])

    def stays(radius: float) -> bool:
        places = np.array([(10 + mm, 0.0) for mm in x])[:, None] + radius * disc
        for side in (-1, 1):
            f = force(side, places)
            order = np.argsort(force(side, np.array([(10 + mm, 0.0) for mm in x])))
            if any(f[a].max() >= f[b].min() for a, b in pairwise(order)):
                return False
        return True

    low, high = 0.0, 10.0
    while high - low > 1e-7:
        middle = (low + high) / 2
        low, high = (middle, high) if stays(middle) else (low, middle)
    return low


@pytest.mark.parametrize(
    ("x", "known"),
    [((0.01, 9.82, 19.97), 4.071), ((0.0, 20 / 3, 40 / 3, 20.0), 2.664), ((0.0, 12.0), 4.960)],
)
def test_the_radius_is_that_of_dense_sampling(x, known):
    result = robustness(row(*x))
    assert result.limit == "order"
    assert result.radius * 1e3 == pytest.approx(by_brute_force(x), abs=2e-5)
    assert result.radius * 1e3 == pytest.approx(known, abs=6e-4)


def moved(chain: sw.Chain, moves: np.ndarray) -> sw.Chain:
    for i, (x, y) in enumerate(moves.tolist()):
        chain = of_cell(chain, i, "q").displaced(chain, (x, y))
    return chain


@pytest.mark.slow
def test_no_displacement_of_all_anchors_within_the_radius_changes_the_sequence():
    rng = np.random.default_rng(0)
    for _ in range(examples(5)):
        chain = concave_chain(rng, int(rng.integers(2, 5)))
        result = robustness(chain)
        now = chain.cycle().sequence
        for _ in range(30):
            angle = rng.uniform(0, 2 * np.pi, len(chain))
            out = 0.999 * result.radius * np.column_stack([np.cos(angle), np.sin(angle)])
            assert moved(chain, out).cycle().sequence == now


@pytest.mark.slow
def test_past_the_radius_the_two_that_meet_change_places():
    rng = np.random.default_rng(1)
    met = 0
    for _ in range(examples(12)):
        chain = concave_chain(rng, int(rng.integers(2, 5)))
        result = robustness(chain)
        if result.meeting is None:
            continue
        met += 1
        meeting = result.meeting
        moves = np.zeros((len(chain), 2))
        moves[[meeting.first, meeting.second]] = meeting.moves
        np.testing.assert_allclose(np.linalg.norm(moves, axis=1).max(), result.radius, rtol=1e-9)
        before, after = (moved(chain, k * moves).cycle() for k in (0.9999, 1.0001))
        assert before.sequence == chain.cycle().sequence != after.sequence
        orders = [getattr(c, f"{meeting.way}_order") for c in (before, after)]
        place = orders[0].index(meeting.first)
        assert orders[0][place + 1] == meeting.second
        swapped = list(orders[0])
        swapped[place : place + 2] = meeting.second, meeting.first
        assert list(orders[1]) == swapped
    assert met > 5


@pytest.mark.slow
def test_all_at_once_is_less_than_one_at_a_time():
    rng = np.random.default_rng(2)
    for _ in range(examples(5)):
        chain = concave_chain(rng, 3)
        assert robustness(chain).radius < np.min(sw.margin(chain).anchors)


def test_where_the_proof_of_a_cell_ends_the_radius_does_and_says_so():
    wide = sw.Chain([sw.Cell(sw.Band((-0.010, 0.0), (x, y))) for x, y in ((0, 0.0148), (0.02, 0))])
    result = robustness(wide)
    assert (result.limit, result.cell, result.meeting) == ("proof", 0, None)
    d = 0.010, 0.0148
    cell = Simple(*d, 28.5, 0.010, R, math.sin(LIMIT))
    assert concave_disc(cell, result.radius)
    assert not concave_disc(cell, 1.01 * result.radius)
    says(str(result), "with more", "inner", "slack")


def test_a_single_cell_has_no_order_to_lose():
    result = robustness(row(20.0))
    assert result.meeting is None
    assert result.limit in ("proof", "none")


def test_two_equal_cells_may_be_off_by_nothing():
    result = robustness(row(5.0, 5.0))
    assert result.radius == 0.0
    assert result.limit == "order"


@pytest.mark.parametrize(
    "chain",
    [
        sw.Chain(row(0.0, 10.0).cells, actuator_stiffness=30.0),
        sw.Chain((row(0.0).levers[0], sw.Cell(row(10.0).levers[0].band, limit=0.6))),
        sw.Chain((row(0.0).levers[0], sw.Cell(row(10.0).levers[0].band, friction=0.01))),
    ],
    ids=["compliant", "unequal limits", "friction"],
)
def test_without_a_closed_form_it_is_refused_with_what_to_ask_instead(chain):
    with pytest.raises(ValueError, match=r"chain\.margin\(\)"):
        robustness(chain)


def test_end_forces_on_a_disc_are_extreme_where_they_were_followed_to():
    rng = np.random.default_rng(3)
    angle = np.linspace(0, 2 * np.pi, 721)
    area = np.sqrt(np.linspace(0, 1, 15))[:, None, None]
    for _ in range(examples(30)):
        d = np.array([[rng.uniform(0.008, 0.03), rng.uniform(-0.015, 0.015)]])
        cell = Simple(float(d[0, 0]), float(d[0, 1]), 28.5, 0.010, R, math.sin(LIMIT))
        radius = rng.uniform(0.0001, 0.006)
        if not concave_disc(cell, radius):
            continue
        disc = d + radius * area * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        for side, sign in ((-1, 1), (-1, -1), (1, 1), (1, -1)):
            t, c = side * math.sin(LIMIT), math.cos(LIMIT)
            length = np.hypot(R * c + disc[..., 0], R * t + disc[..., 1])
            force = 28.5 * (1 - 0.010 / length) * (disc[..., 1] - disc[..., 0] * t / c)
            extreme, x, y = farthest(cell, side, d, radius, sign)[0].tolist()
            assert math.hypot(x, y) == pytest.approx(radius, rel=1e-12)
            assert sign * extreme >= np.max(sign * force) - 1e-12
            assert sign * extreme <= np.max(sign * force) + 1e-5


def test_the_room_of_a_proof_is_the_radius_of_its_disc():
    box = Box(0.005, 0.030, -0.015, 0.015)
    cell = Kind(BandType(), R, LIMIT).cell
    proof = AnchorProof(cell, box)
    rng = np.random.default_rng(4)
    checked = 0
    for dx, dy in rng.uniform((0.006, -0.015), (0.016, 0.015), (examples(20), 2)).tolist():
        here = cell._replace(dx=dx, dy=dy)
        if not concave_disc(here, 0.0002):
            continue
        radius = float(proof.radius(np.array([[dx, dy]]))[0])
        assert radius <= 2 * R + 1e-12
        assert radius > 0.99 * 2 * R or not concave_disc(here, 1.01 * radius + 1e-5)
        # The proof of a large disc stops short of its edge.
        if radius < 0.008:
            checked += 1
            assert concave_disc(here, 0.96 * radius - 1e-5)
    assert checked > 3


def test_a_printed_robustness_names_the_cells_that_meet():
    result = robustness(row(0.0, 9.0, 19.0))
    assert isinstance(result, Robustness)
    text = str(result)
    says(text, "all anchors", f"{result.radius * 1e3:.4g} mm", "cell ", " and cell ")
    assert repr(result) == f"Robustness({text})"
