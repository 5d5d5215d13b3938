"""The oracle is right where the answer is known on paper."""

from __future__ import annotations

import ast
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import oracle
from facts import refuses
from oracle import OracleCell, OracleSheet, follow
from sizes import examples

pytestmark = pytest.mark.slow

R = 0.010 * math.sqrt(2)
LIMIT = math.pi / 4
S = 0.020
K_BAND, REST = 28.5, 0.010


def paper_cell(qx_mm, qy_mm, *, k=K_BAND, friction=0.0, load=()):
    """The paper's unit cell with p = (-10, 0) mm."""
    band = (1e-3 * qx_mm + 0.010, 1e-3 * qy_mm, k, REST, 0.0, 0.0, False)
    return OracleCell(R, LIMIT, bands=[band], load=load, friction=friction)


def paper_force(cell, s):
    """F = k (1 - l0/l)(d_y - d_x tan θ), by angles: Kamp et al. 2024, from Eqs. 1 and 2."""
    dx, dy, k, l0 = cell.bands[0][:4]
    theta = np.arcsin(np.asarray(s) / R - math.sin(LIMIT))
    length = np.hypot(R * np.cos(theta) + dx, R * np.sin(theta) + dy)
    return k * (1 - l0 / length) * (dy - dx * np.tan(theta))


def paper_energy(cell, s):
    dx, dy, k, l0 = cell.bands[0][:4]
    theta = np.arcsin(np.asarray(s) / R - math.sin(LIMIT))
    length = np.hypot(R * np.cos(theta) + dx, R * np.sin(theta) + dy)
    return 0.5 * k * (length - l0) ** 2


def plain_cell(*knots, friction=0.0, mobility=1.0):
    """A cell with no band: its force is the polygon through the knots (s, F)."""
    return OracleCell(R, LIMIT, load=knots, friction=friction, mobility=mobility)


def travel_at_force(cell, force):
    """The travel at which a cell of falling force carries it, by bisection."""
    lo, hi = 0.0, S
    for _ in range(60):
        mid = 0.5 * (lo + hi)
        lo, hi = (mid, hi) if paper_force(cell, mid) > force else (lo, mid)
    return lo


INNER = paper_cell(10, 0)
STRONG = paper_cell(20, 0)
WEAK = paper_cell(0, 0)


def test_it_shares_no_code_with_the_package_it_judges():
    tree = ast.parse(Path(oracle.__file__).read_text(encoding="utf-8"))
    roots = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            roots |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            roots.add(str(node.module).split(".")[0])
    # A lock lets one process compile it.
    assert roots - sys.stdlib_module_names == {"filelock", "numba", "numpy"}


@pytest.mark.parametrize(
    ("q", "expected"),
    [
        ((10, 0), (0.967, -0.967)),
        ((20, 0), (1.607, -1.607)),
        ((0, 0), (0.391, -0.391)),
        ((10, -15), (0.263, -1.661)),
        ((20, 15), (2.393, -0.836)),
        ((0, -15), (-0.243, -0.910)),
    ],
)
def test_end_forces_are_the_papers(q, expected):
    cell = paper_cell(*q)
    assert cell.force([0.0, S]) / (K_BAND * R) == pytest.approx(expected, abs=6e-4)


def test_force_is_the_slope_of_energy_for_every_kind_of_band_and_load():
    h = 2e-6
    s = np.linspace(3 * h, S - 3 * h, 401)
    bands = [
        (-0.021, 0.004, 30.0, 0.012, -9.0, 900.0, False),  # slack over part of the travel
        (-0.018, -0.006, 20.0, 0.011, 5.0, 400.0, True),  # pushed together over part of it
        (0.012, 0.003, 25.0, 0.008, 0.0, 0.0, False),
    ]
    cell = OracleCell(R, LIMIT, bands=bands, load=[(0.004, 0.1), (0.009, -0.2), (0.015, 0.05)])
    e = cell.energy
    slope = (8 * (e(s + h) - e(s - h)) - (e(s + 2 * h) - e(s - 2 * h))) / (12 * h)
    # At a kink of the force the difference formula itself is only good to kappa * h.
    assert slope == pytest.approx(cell.force(s), abs=2e-4)
    assert np.median(abs(slope - cell.force(s))) < 1e-9


def test_force_of_a_taut_band_is_the_papers_formula():
    s = np.linspace(0, S, 101)
    for cell in (INNER, STRONG, WEAK, paper_cell(10, -15), paper_cell(20, 15)):
        assert cell.force(s) == pytest.approx(paper_force(cell, s), abs=1e-12)
        assert cell.energy(s) == pytest.approx(paper_energy(cell, s), abs=1e-15)


def test_single_linear_cell_follows_its_force():
    run = follow([plain_cell((0, 0.1), (S, 0.5))], [0, S, 0], steps=200)
    u = run.stroke
    assert run.drive == pytest.approx(u, abs=1e-12)
    # At the stops λ keeps the value it arrived with.
    assert run.force == pytest.approx(0.1 + 20 * u, abs=1e-6)
    assert run.energy == pytest.approx(0.1 * u + 10 * u**2, abs=1e-12)
    assert run.snaps == []
    assert run.sequence == "0>1>0"


def test_single_concave_cell_is_followed_through_its_unstable_half():
    run = follow([INNER], [0, S, 0], steps=200)
    assert run.force == pytest.approx(paper_force(INNER, run.stroke), abs=1e-6)
    assert run.snaps == []


def test_soft_cells_share_the_stroke_by_their_compliance():
    cells = [plain_cell((0, 0.0), (S, 0.2)), plain_cell((0, 0.0), (S, 0.6))]  # 10 and 30 N/m
    run = follow(cells, [0, 0.020, 0], steps=100)
    assert run.travel[:, 0] == pytest.approx(0.75 * run.stroke, abs=2e-8)
    assert run.force == pytest.approx(7.5 * run.stroke, abs=1e-6)


@pytest.mark.parametrize(
    ("cells", "sequence"),
    [
        ([INNER, STRONG], "00>10>11>01>00"),  # F0in < F0out, F1in > F1out: clockwise
        ([INNER, WEAK], "00>01>11>10>00"),  # counterclockwise
        ([paper_cell(20, 15), INNER], "00>01>11>01>00"),  # both inner larger: via 01
        ([INNER, paper_cell(20, 15)], "00>10>11>10>00"),  # both smaller: via 10
    ],
)
def test_two_concave_cells_take_the_four_pathways(cells, sequence):
    f = [cell.force([0.0, S]) for cell in cells]
    first = "10" if f[0][0] < f[1][0] else "01"
    last = "01" if f[0][1] > f[1][1] else "10"
    assert sequence == f"00>{first}>11>{last}>00"
    run = follow(cells, [0, 2 * S, 0])
    assert run.sequence == sequence
    assert len(run.snaps) == (0 if first == last else 2)


def test_snap_of_two_cells_is_where_the_loading_one_falls_to_the_full_one():
    run = follow([INNER, STRONG], [0, 2 * S, 0])
    up, down = run.snaps
    s_j = travel_at_force(STRONG, paper_force(INNER, S))
    step = 2 * S / 2000
    assert up.drive == pytest.approx(S + s_j, abs=step)
    assert up.force_before == pytest.approx(paper_force(INNER, S), abs=1e-3)
    # Inner gives back, outer completes, inner is left in transit at the same stroke.
    assert up.before == pytest.approx([S, s_j], abs=step)
    assert up.after == pytest.approx([s_j, S], abs=step)
    released = paper_energy(STRONG, s_j) - paper_energy(STRONG, S)
    released += paper_energy(INNER, S) - paper_energy(INNER, s_j)
    assert up.released == pytest.approx(released, rel=2e-3)
    # These cells are symmetric about θ = 0, so unloading is the mirror image.
    assert down.drive == pytest.approx(2 * S - up.drive, abs=1e-9)
    assert down.released == pytest.approx(up.released, rel=1e-6)


@pytest.mark.parametrize("mobility", [(1, 1, 1, 1), (0.3, 2, 0.1, 1)])
def test_the_flow_dissipates_what_the_balance_says_is_released(mobility):
    cells = [INNER, STRONG, WEAK, paper_cell(10, -15)]
    cells = [replace(c, mobility=m) for c, m in zip(cells, mobility, strict=True)]
    for control, ends in (("stroke", (0, 4 * S)), ("force", (-2, 2))):
        run = follow(cells, [ends[0], ends[1], ends[0]], control=control)
        assert len(run.snaps) >= 4
        for snap in run.snaps:
            assert snap.viscous == pytest.approx(snap.released, rel=5e-3)


def test_every_row_is_in_equilibrium():
    cells = [INNER, STRONG, WEAK, paper_cell(0, -15, friction=0.01)]
    for control, ends in (("stroke", (0, 4 * S)), (400.0, (-0.01, 0.09)), ("force", (-2, 2))):
        run = follow(cells, [ends[0], ends[1], ends[0]], control=control, steps=500)
        for cell, s in zip(cells, run.travel.T, strict=True):
            push = run.force - cell.force(s)
            assert np.where(s < cell.span, push, 0).max() <= cell.friction + 2e-6
            assert np.where(s > 0, push, 0).min() >= -cell.friction - 2e-6
        if control == "stroke":
            assert run.travel.sum(axis=1) == pytest.approx(run.drive, abs=1e-12)


def test_fold_of_a_rising_and_a_falling_cell_is_where_their_compliances_cancel():
    # κ = 30 N/m against -10, then from 8 mm on against -50 N/m: Σ 1/κ changes sign there.
    rising = plain_cell((0, 0.0), (S, 0.6))
    falling = plain_cell((0, 0.3), (0.008, 0.22), (0.014, -0.08))
    run = follow([rising, falling], [0, 2 * S], steps=4000)
    (snap,) = run.snaps
    fold = 0.22 / 30 + 0.008
    assert snap.drive == pytest.approx(fold, abs=2 * S / 4000)
    # Beyond 14 mm the falling cell carries a constant -0.08 N, below the rising one at 0 N:
    # the rising cell is emptied and the falling one is left in transit.
    assert snap.after == pytest.approx([0, fold], abs=2e-5)
    before = 0.5 * 30 * (0.22 / 30) ** 2 + 0.26 * 0.008
    after = 0.26 * 0.008 + 0.07 * 0.006 - 0.08 * (fold - 0.014)
    assert snap.released == pytest.approx(before - after, rel=1e-3)


def test_slack_cell_carries_nothing_and_moves_first():
    # d = (-20, 0) mm: anchors at most 14.2 mm apart, below the rest length throughout.
    slack = OracleCell(R, LIMIT, bands=[(-0.020, 0.0, K_BAND, 0.0145, 0.0, 0.0, False)])
    s = np.linspace(0, S, 21)
    assert (slack.force(s) == 0).all()
    assert (slack.energy(s) == 0).all()
    run = follow([INNER, slack], [0, 2 * S], steps=500)
    first = run.stroke < S - 1e-9
    assert run.force[first] == pytest.approx(0, abs=1e-6)
    assert run.sequence == "00>01>11"
    assert len(run.snaps) == 1  # at F_inner = 0 the slack cell gives back all it can
    # INNER passes 0 N at mid travel; it completes and the slack cell is half way again.
    assert run.snaps[0].before == pytest.approx([S / 2, S], abs=5e-5)
    assert run.snaps[0].after == pytest.approx([S, S / 2], abs=5e-5)


def test_a_slack_band_differs_from_a_two_sided_one_only_where_it_is_slack():
    band = (-0.020, 0.006, K_BAND, 0.012, 3.0, 200.0)
    s = np.linspace(0, S, 201)
    real = OracleCell(R, LIMIT, bands=[(*band, False)])
    spring = OracleCell(R, LIMIT, bands=[(*band, True)])
    y = s - S / 2
    length = np.hypot(np.sqrt(R**2 - y**2) - 0.020, y + 0.006)
    taut = length > 0.012
    assert 20 < taut.sum() < 180
    assert (real.force(s)[taut] == spring.force(s)[taut]).all()
    assert (real.force(s)[~taut] == 0).all()
    assert (spring.force(s)[~taut] != 0).all()


def test_friction_makes_a_loop_of_twice_the_friction_times_the_travel():
    f = 0.03
    run = follow([plain_cell((0, 0.1), (S, 0.5), friction=f)], [0, S, 0], steps=1000)
    u, lam = run.stroke, run.force
    assert lam[:1001] == pytest.approx(0.1 + 20 * u[:1001] + f, abs=1e-6)
    # The drive has no give: the first row of unloading is already fully reversed.
    assert lam[1001:] == pytest.approx(0.1 + 20 * u[1001:] - f, abs=1e-6)
    back = np.concatenate([[0.5 - f], lam[1001:]]), u[1000:]
    loop = np.trapezoid(lam[:1001], u[:1001]) + np.trapezoid(*back)
    assert loop == pytest.approx(2 * f * S, rel=1e-6)
    assert run.snaps == []


def test_friction_is_not_counted_as_released_energy():
    f = 0.02
    cell = paper_cell(10, 0, friction=f)
    run = follow([cell], [-1, 1], control="force", steps=4000)
    (snap,) = run.snaps
    assert snap.drive == pytest.approx(float(paper_force(INNER, 0)) + f, abs=1e-3)
    # The dead load λ S less the friction f S; the band's energy is the same at both ends.
    assert snap.released == pytest.approx(float(paper_force(INNER, 0)) * S, rel=1e-3)


def test_force_control_is_a_preisach_set():
    cells = [INNER, STRONG, paper_cell(10, -15), WEAK]
    run = follow(cells, [-2, 2, -2], control="force", steps=4000)
    f0 = np.array([float(paper_force(c, 0)) for c in cells])
    f1 = np.array([float(paper_force(c, S)) for c in cells])
    state = ["0"] * 4
    names = ["0000"]
    for i in np.argsort(f0):
        state[i] = "1"
        names.append("".join(state))
    for i in np.argsort(-f1):
        state[i] = "0"
        names.append("".join(state))
    assert run.sequence == ">".join(names)
    fields = [*np.sort(f0), *np.sort(f1)[::-1]]
    assert [snap.drive for snap in run.snaps] == pytest.approx(fields, abs=1e-3)
    for snap in run.snaps:
        (i,) = np.flatnonzero(abs(snap.after - snap.before) > 1e-9)
        fall = float(paper_energy(cells[i], snap.before[i]) - paper_energy(cells[i], snap.after[i]))
        work = snap.drive * float(snap.after[i] - snap.before[i])
        assert snap.released == pytest.approx(fall + work, rel=1e-3)


def test_actuator_spring_takes_its_share_of_a_linear_cell():
    run = follow([plain_cell((0, 0.0), (S, 0.4))], [0, 0.030, 0], control=40.0, steps=300)
    assert run.stroke == pytest.approx(run.drive * 40 / 60, abs=2e-8)
    assert run.force == pytest.approx(40 * (run.drive - run.stroke), abs=1e-9)
    assert run.total == pytest.approx(10 * run.stroke**2 + run.force**2 / 80, abs=1e-9)


def test_soft_actuator_snaps_a_concave_cell_at_its_first_force():
    stiffness = 5.0  # softer than |dF/ds| anywhere, so the cell goes all the way
    run = follow([INNER], [-0.1, 0.15, -0.1], control=stiffness, steps=4000)
    f0 = float(paper_force(INNER, 0))
    up, down = run.snaps
    assert up.drive == pytest.approx(f0 / stiffness, abs=1e-4)
    assert up.after == pytest.approx([S])
    spring = 0.5 * f0**2 / stiffness - 0.5 * stiffness * (f0 / stiffness - S) ** 2
    assert up.released == pytest.approx(spring, rel=2e-3)  # the band itself ends as it began
    assert down.drive == pytest.approx(S - f0 / stiffness, abs=1e-4)


def test_stiff_and_soft_actuators_tend_to_stroke_and_force_control():
    cells = [INNER, STRONG]
    stroke = follow(cells, [0, 2 * S, 0])
    stiff = follow(cells, [-1e-4, 2 * S + 1e-4, -1e-4], control=1e4)
    assert stiff.sequence == stroke.sequence
    for a, b in zip(stiff.snaps, stroke.snaps, strict=True):
        assert a.after == pytest.approx(b.after, abs=1e-4)
        assert a.released == pytest.approx(b.released, rel=1e-2)
    soft = follow(cells, [-20, 20, -20], control=0.05, steps=8000)
    dead = follow(cells, [-1, 1, -1], control="force")
    assert soft.sequence == dead.sequence
    assert [s.force_before for s in soft.snaps] == pytest.approx(
        [s.drive for s in dead.snaps], abs=1e-3
    )


def test_the_full_cell_that_starts_the_snap_need_not_be_the_one_left_in_transit():
    # Two full cells, a and c. The snap starts at the larger F1, that of c, but while λ dips a
    # gives back as well; its force rises faster than c's, so it ends up in transit. Finishing
    # it then takes a second snap, with c, where its force has fallen to F1 of c.
    def cell(dx_mm, dy_mm, k):
        return OracleCell(R, LIMIT, bands=[(1e-3 * dx_mm, 1e-3 * dy_mm, k, REST, 0, 0, False)])

    a, b, c = (
        cell(9.405, 2.068, 53.935),
        cell(18.983, -8.699, 55.823),
        cell(8.011, -10.351, 15.018),
    )
    trigger = float(paper_force(c, S))
    assert trigger > float(paper_force(a, S))
    run = follow([a, b, c], [0, 3 * S], steps=4000)
    assert run.sequence == "000>001>101>111"
    first, second = run.snaps[-2:]
    step = 3 * S / 4000
    s_b, s_a = travel_at_force(b, trigger), travel_at_force(a, trigger)
    assert first.drive == pytest.approx(2 * S + s_b, abs=step)
    assert first.after == pytest.approx([s_b, S, S], abs=step)
    assert second.drive == pytest.approx(2 * S + s_a, abs=step)
    assert second.after == pytest.approx([S, S, s_a], abs=step)


def test_order_of_cells_that_nearly_tie_is_still_that_of_their_forces():
    near = paper_cell(10, 0, k=K_BAND * (1 + 3e-4))  # F0 differ by 1e-4 N
    assert follow([INNER, near], [0, 2 * S], steps=500).sequence == "00>10>11"
    assert follow([near, INNER], [0, 2 * S], steps=500).sequence == "00>01>11"


def test_turning_back_past_the_snap_leads_to_01():
    run = follow([INNER, STRONG], [0, 2 * S, 0])
    past = run.snaps[0].drive + 1e-4
    assert follow([INNER, STRONG], [S, past, 0], start=[S, 0]).sequence == "10>01>00"
    before = run.snaps[0].drive - 1e-4
    assert follow([INNER, STRONG], [S, before, 0], start=[S, 0]).sequence.startswith("10>00")


def test_cells_of_constant_force_share_the_stroke_by_their_mobility():
    cells = [plain_cell((0, 0.1), mobility=m) for m in (1.0, 3.0, 0.5)]
    run = follow(cells, [0, 1.2 * S], steps=100)
    # The second one is full at 3 of 4.5 parts; the others share what is left, 2 to 1.
    u = run.drive
    before = u < 1.5 * S - 1e-9
    assert run.travel[before] == pytest.approx(np.outer(u[before], [1, 3, 0.5]) / 4.5, abs=1e-9)
    on = follow(cells, [0, 1.8 * S], steps=100)
    assert on.travel[-1] == pytest.approx([S / 3 + 0.2 * S, S, S / 6 + 0.1 * S], abs=1e-9)


RACES = [
    # λ is the mean of the three forces by mobility: at first 0.525 N, and the second cell gains
    # 0.15 S until the first is empty, past 0.6 S; or 0.075 N, and it loses.
    ((10.0, 1.0, 1.0), (0.0, 1.0, 0.5)),
    ((1.0, 1.0, 10.0), (0.0, 0.5, 1.0)),
    ((0.2, 0.02, 0.02), (0.0, 1.0, 0.5)),
]


@pytest.mark.parametrize(("mobility", "expected"), RACES)
def test_a_race_of_three_cells_is_won_by_mobility(mobility, expected):
    forces = [(0, 0.6)], [(0, 0.3), (0.6 * S, 0.3), (0.62 * S, -1.0)], [(0, 0.0)]
    cells = [plain_cell(*f, mobility=m) for f, m in zip(forces, mobility, strict=True)]
    run = follow(cells, [1.5 * S, 1.5 * S + 1e-9], start=[S / 2] * 3, steps=1)
    assert run.travel[0] == pytest.approx(np.array(expected) * S, abs=1e-6 * S)


def test_two_cells_under_a_stroke_and_all_under_a_force_land_alike_whatever_their_mobilities():
    def jumps(cells, ends, control):
        run = follow(cells, ends, control=control, steps=2000)
        return [snap.after for snap in run.snaps]

    for n, ends, control in ((2, [0, 2 * S, 0], "stroke"), (3, [-2, 2, -2], "force")):
        cells = [INNER, STRONG, WEAK][:n]
        slow = [replace(c, mobility=m) for c, m in zip(cells, (1.0, 0.05, 7.0), strict=False)]
        for a, b in zip(jumps(cells, ends, control), jumps(slow, ends, control), strict=True):
            assert a == pytest.approx(b, abs=1e-4)


def test_a_folded_curve_jumps_at_the_ends_of_its_sheets():
    # Two straight sheets of 100 N/m, 0.5 N apart: up to 8 mm, and from 4 mm on.
    first = OracleSheet([(0, 0.0), (0.008, 0.8)], above=1)
    second = OracleSheet([(0.004, -0.1), (S, 1.5)], energy=0.5e-3, below=0)
    folded = OracleCell(R, LIMIT, sheets=[first, second])
    run = follow([folded], [0, S, 0], steps=1000)
    up, down = np.diff(run.drive, prepend=0) >= 0, np.diff(run.drive, append=0) <= 0
    u = run.drive
    for way, at in ((up & ~down, 0.008), (down & ~up, 0.004)):
        beyond = u > at
        clear = way & (abs(u - at) > 1e-4)
        assert run.force[clear & ~beyond] == pytest.approx(100 * u[clear & ~beyond], abs=1e-6)
        assert run.force[clear & beyond] == pytest.approx(100 * u[clear & beyond] - 0.5, abs=1e-6)
        assert (run.sheet[clear, 0] == beyond[clear]).all()
    # Under a force it snaps: at 0.8 N the flow takes it on to 13 mm.
    (snap,) = follow([folded], [0, 1.2], control="force", steps=1000).snaps
    assert snap.drive == pytest.approx(0.8, abs=2e-3)
    assert snap.after == pytest.approx([0.013], abs=3e-5)
    assert snap.released == pytest.approx(0.8 * 0.005 - (3.65e-3 - 3.2e-3), rel=3e-3)


def test_result_does_not_depend_on_the_drive_step():
    rng = np.random.default_rng(7)
    for _ in range(examples(1, full=60)):
        cells = [
            OracleCell(
                R,
                LIMIT,
                bands=[
                    (dx, dy, k, 0.012, a2, 800.0, False)
                    for dx, dy, k, a2 in zip(
                        rng.uniform(-0.03, 0.03, 2),
                        rng.uniform(-0.015, 0.015, 2),
                        rng.uniform(15, 60, 2),
                        rng.uniform(-10, 10, 2),
                        strict=True,
                    )
                ],
            )
            for _ in range(3)
        ]
        coarse = follow(cells, [0, 3 * S, 0], steps=1500)
        fine = follow(cells, [0, 3 * S, 0], steps=4500)
        assert coarse.sequence == fine.sequence
        off = abs(coarse.travel - fine.travel[::3]).max(axis=1) > 1e-4
        assert off.sum() <= 8  # rows at the edge of a snap, or on the steep run-up to one


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [
        ({"turning_points": [0, 0.050]}, "stroke must stay within"),
        ({"turning_points": [0.010, 0.020]}, "start sums to"),
        ({"turning_points": [0, 0.020], "start": [0.030, 0.0]}, "within the stops"),
        ({"turning_points": [0, 0.020], "control": -1.0}, "stiffness must be finite"),
        ({"turning_points": [0.0]}, "two or more"),
    ],
)
def test_impossible_questions_are_refused(kwargs, message):
    with pytest.raises(ValueError, match=message):
        follow([INNER, STRONG], **kwargs)


@pytest.mark.parametrize("mobility", [0.0, -1.0, math.nan, math.inf])
def test_a_cell_that_cannot_move_is_refused(mobility):
    with refuses(ValueError, "mobility", "finite", "> 0"):
        follow([replace(INNER, mobility=mobility)], [0, S])
