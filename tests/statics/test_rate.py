"""Motion at a rate with masses, and the safe rate, against each other and other integrations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stepwell as sw
from chains import concave_chain
from critical_rates import safe_ones
from facts import refuses
from sizes import examples
from stepwell.statics.inertial_path import keeps_order, without_excursions

INNER = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
PAIR = sw.Chain([INNER, INNER.with_anchors(q=(0.020, 0.0))])
BLOCKS, DRY = [0.010, 0.010], [0.0, 0.0]


@pytest.fixture(scope="module")
def pair() -> sw.Path:
    return PAIR.cycle().path


def test_a_slow_motion_snaps_where_the_quasi_static_one_does(pair):
    slow = pair.at_rate(0.01, BLOCKS, DRY)
    snaps = [event.drive for event in pair.events if event.released > 0.0]
    assert slow.keeps_order
    assert slow.snap_drives == pytest.approx(snaps, abs=5e-5)
    assert slow.changes == ((0, 1), (1, 1), (0, 0), (1, 0))


def test_the_pair_of_the_paper_keeps_its_order_far_above_its_safe_rate(pair):
    safe = pair.safe_rate()
    assert safe.proved
    assert safe.rate == pytest.approx(1.67, abs=0.01)
    assert pair.at_rate(safe.rate, BLOCKS, DRY).keeps_order
    assert pair.at_rate(7.7, BLOCKS, DRY).keeps_order
    assert not pair.at_rate(8.0, BLOCKS, DRY).keeps_order


def test_the_safe_rate_balances_forces(pair):
    mass, damping = 0.030, 0.2
    safe = pair.safe_rate([mass, mass], [damping, damping])
    way = PAIR.full_stroke
    speed, gain = math.pi * safe.rate * way, 2.0 * (math.pi * safe.rate) ** 2 * way
    forces = speed * (math.sqrt(mass * safe.stiffness) + damping) + mass * gain
    assert forces == pytest.approx(safe.gap, rel=1e-9)


def other_motion(rate: float, mass: float, until: float) -> tuple[np.ndarray, np.ndarray]:
    """Travel of the inner cell of the pair by a high-order method, with stiff, dead stops."""
    full, stiff = INNER.full_travel, 2e6
    at = np.linspace(0.0, full, 4001)
    forces = [cell.force_at(at) for cell in PAIR.cells]

    def across(s: float, v: float, k: int) -> float:
        past = s - min(max(s, 0.0), full)
        stop = stiff * past + (2.0 * math.sqrt(stiff * mass) * v if past * v > 0.0 else 0.0)
        return float(np.interp(s, at, forces[k])) + stop

    def rates(t: float, y: np.ndarray) -> list[float]:
        u = full * (1.0 - math.cos(2.0 * math.pi * rate * t))
        w = 2.0 * math.pi * rate * full * math.sin(2.0 * math.pi * rate * t)
        pull = across(u - y[0], w - y[1], 1) - across(y[0], y[1], 0)
        return [y[1], pull / mass]

    done = solve_ivp(rates, (0.0, until), [0.0, 0.0], "LSODA", rtol=1e-8, atol=1e-10, max_step=1e-3)
    return done.t, done.y[0]


@pytest.mark.slow
@pytest.mark.parametrize("rate", [1.0, 6.0])
def test_an_integration_that_knows_no_contacts_moves_alike(pair, rate):
    motion = pair.at_rate(rate, BLOCKS, DRY)
    until = 0.49 / rate
    time, travel = other_motion(rate, BLOCKS[0], until)
    ours = np.interp(time, motion.history.time, motion.history.travel[:, 0])
    assert np.max(np.abs(ours - travel)) <= 0.05 * INNER.full_travel
    assert np.mean(np.abs(ours - travel)) <= 0.002 * INNER.full_travel


@pytest.mark.slow
def test_no_random_chain_changes_its_order_at_a_rate_called_safe():
    count = examples(4, full=100)
    cells = (2, 3) if count < 100 else (2, 3, 4)
    chains = safe_ones(np.random.default_rng(39), cells, count)
    assert all(one.keeps(1.0) for one in chains)
    assert all(one.keeps(0.5) is not False for one in chains)


def test_one_cell_moves_with_its_actuator_at_any_rate():
    safe = sw.Chain([INNER]).cycle().path.safe_rate()
    assert safe.rate is not None and math.isinf(safe.rate)
    assert "moves with the actuator" in str(safe)


def test_no_rate_is_safe_where_the_order_hangs_on_masses():
    tied = sw.Chain([INNER, INNER]).cycle().path.safe_rate()
    forced = replace(PAIR, actuator_stiffness=0.0).cycle().path.safe_rate()
    ringing = sw.load("preset:trilinear").cycle().path.safe_rate()
    for one, reason in ((tied, "tie"), (forced, "prescribed force"), (ringing, "damping")):
        assert one.rate is None
        assert reason in one.reason


def test_a_rate_is_a_number_above_zero(pair):
    with refuses(ValueError, "rate"):
        pair.at_rate(0.0, BLOCKS, DRY)
    with refuses(ValueError, "masses"):
        pair.at_rate(1.0, [0.01], DRY)


def test_the_gap_of_sorted_cells_is_between_neighbours():
    chain = concave_chain(np.random.default_rng(3), 3)
    up = np.diff(sorted(cell.force_0 for cell in chain.levers))
    down = np.diff(sorted(cell.force_1 for cell in chain.levers))
    assert chain.cycle().path.safe_rate().gap >= min(*up, *down) * (1.0 - 1e-9)


def test_a_cell_that_strikes_a_stop_and_returns_changes_no_order():
    begin, expected = [0, 0], [[(0, 1)], [(1, 1)]]
    rung = [(0, 1), (0, 0), (0, 1), (1, 1)]
    assert keeps_order(begin, expected, without_excursions(begin, rung))
    crossed = [(0, 1), (1, 1), (0, 0), (0, 1)]
    assert keeps_order(begin, expected, without_excursions(begin, crossed))
    assert not keeps_order(begin, expected, without_excursions(begin, [(1, 1), (0, 1)]))
