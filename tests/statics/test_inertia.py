"""Landings with masses: closed forms, an independent integration, the overdamped limit."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stepwell as sw
from chains import any_chain, concave_chain
from facts import refuses
from sizes import examples
from stepwell.mechanism import balloon, mobilities_of, trilinear
from stepwell.statics import EventKind, InertialLanding, StaticsError

STOPPED = sw.Element.from_points(
    (0.0, 0.002, 0.010, 0.012), (0.0, 1.0, -1.0, -0.5), "stopped", stops=True
)


def under_force(*cells: sw.Cell | sw.Element) -> sw.Path:
    """The path of a full cycle under a prescribed force."""
    return sw.Chain(cells, actuator_stiffness=0.0).cycle().path


def snaps_of(path: sw.Path) -> list[sw.Event]:
    return [event for event in path.events if event.kind is EventKind.SNAP]


def balanced(landing: InertialLanding) -> bool:
    return abs(landing.imbalance) <= 1e-5 * landing.freed


def test_without_dampers_a_blow_takes_all_that_a_snap_frees():
    # Work of λ = 1 N from the peak at 2 mm to the stop at 12 mm less the area under the curve.
    landing = under_force(STOPPED).inertial_landing(0, [0.02], [0.0])
    freed = 1.0 * 0.010 - (0.0 - 0.75 * 0.002)
    assert landing.travel == (0.012,)
    assert landing.freed == pytest.approx(freed, rel=1e-5)
    assert landing.struck == pytest.approx(freed, rel=1e-5)
    assert landing.peak_speed == pytest.approx(math.sqrt(2 * freed / 0.02), rel=1e-4)
    assert landing.damped <= 1e-12
    assert balanced(landing)


def test_blows_that_rebound_take_it_one_after_the_other():
    landing = under_force(STOPPED).inertial_landing(0, [0.02], [0.0], restitution=0.6, history=True)
    assert landing.struck == pytest.approx(1.0 * 0.010 + 0.75 * 0.002, rel=1e-5)
    assert landing.history is not None
    v = landing.history.speed[:, 0]
    first = int(np.argmax(v < 0.0))
    assert v[first] == pytest.approx(-0.6 * landing.peak_speed, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.05, 0.4, 20.0])
def test_on_a_straight_branch_it_swings_as_the_damped_oscillator_does(damping):
    element, mass, k = trilinear(), 0.02, 250.0
    landing = under_force(element).inertial_landing(0, [mass], [damping], history=True)
    assert landing.history is not None
    t, s, v = landing.history.time, landing.history.travel[:, 0], landing.history.speed[:, 0]
    rest = 0.012 + 2.0 / k
    assert landing.travel[0] == pytest.approx(rest, abs=1e-9)
    # From where it is on that branch for good.
    first = int(np.flatnonzero(s <= 0.012)[-1]) + 1
    # x'' + c/m x' + k/m x = 0 from there on; complex roots serve all dampings.
    root = np.sqrt(complex(damping**2 - 4 * mass * k))
    one, two = (-damping + root) / (2 * mass), (-damping - root) / (2 * mass)
    a = (v[first] - two * (s[first] - rest)) / (one - two)
    since = t[first:] - t[first]
    b = s[first] - rest - a
    swing = (a * np.exp(one * since) + b * np.exp(two * since)).real
    assert np.allclose(s[first:] - rest, swing, atol=2e-6 * 0.012)
    assert balanced(landing)


def test_friction_stops_a_swing_after_as_many_halves_as_it_should():
    # Each half swing on a spring of stiffness k loses 2 f/k of its width (Coulomb's own result).
    rub, k = 0.05, 250.0
    element = replace(trilinear(), friction=rub)
    landing = under_force(element).inertial_landing(0, [0.02], [0.0], history=True)
    assert landing.history is not None
    # It sets off at λ = 1 N + f, and comes down the last branch round (λ ∓ f)/k.
    level = 1.0 + rub
    freed = level * (0.012 - 0.004) - rub * 0.008
    x0 = -(2.0 + 0.0) / k
    speed = math.sqrt(2 * freed / 0.02)
    width = math.hypot(x0, speed / math.sqrt(k / 0.02))
    halves, place = 0, width
    while place > 2 * rub / k:
        place -= 2 * rub / k
        halves += 1
    centre = 0.012 + (level + 1.0) / k
    way = landing.history.speed[:, 0]
    turns = np.count_nonzero(np.diff(np.sign(way[way != 0.0])))
    assert turns in (halves - 1, halves)
    assert abs(landing.travel[0] - centre) <= rub / k
    assert landing.rubbed == pytest.approx(landing.freed, rel=1e-5)


def independent(chain: sw.Chain, landing: InertialLanding, start: np.ndarray, level: float):
    """The same snap by a high-order method for blocks in a row, with stiff, dead stops.

    It knows nothing of contacts: a cell past its stop is pushed back and damped there.
    """
    n, stiff = len(chain), 1e6
    mass, damping = np.array(landing.masses), np.array(landing.damping)
    rigid = math.isinf(chain.actuator_stiffness)
    full = np.array([cell.full_travel for cell in chain.cells])
    table = [np.linspace(0.0, f, 4001) for f in full]
    forces = [cell.force_at(x) for cell, x in zip(chain.cells, table, strict=True)]
    heavy = math.sqrt(stiff * float(np.max(mass)))
    held = 0.0 if rigid else chain.actuator_stiffness
    began = float(np.sum(start))
    curves = [
        (*both, float(f), float(c))
        for *both, f, c in zip(table, forces, full, damping, strict=True)
    ]
    masses = mass.tolist()

    def rates(_t: float, y: np.ndarray) -> list[float]:
        # Numbers one by one: for three cells NumPy takes four times as long.
        state = y.tolist()
        u, w = state[:n], state[n:]
        carried, u0, w0 = [], 0.0, 0.0
        for (at, force, most, damp), u1, w1 in zip(curves, u, w, strict=True):
            s, v = u1 - u0, w1 - w0
            u0, w0 = u1, w1
            inside = min(max(s, 0.0), most)
            past = s - inside
            one = float(np.interp(inside, at, force)) + damp * v + stiff * past
            carried.append(one + 3.0 * heavy * v if past * v > 0.0 else one)
        outer = [*carried[1:], level - held * (u0 - began)]
        gain = [(pull - own) / m for pull, own, m in zip(outer, carried, masses, strict=True)]
        if rigid:
            gain[-1] = 0.0
        return w + gain

    u0 = np.cumsum(start)
    y0 = np.concatenate([u0, np.zeros(n)])
    done = solve_ivp(rates, (0.0, 2.0 * landing.time), y0, "LSODA", rtol=1e-7, atol=1e-10)
    travel = np.diff(done.y[:n], axis=0, prepend=0.0)
    return travel[:, -1], float(np.max(np.abs(done.y[n:])))


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [math.inf, 0.0, 60.0])
def test_an_integration_that_knows_no_contacts_lands_in_the_same_place(stiffness):
    # Behind the spring this chain landed elsewhere as long as these stops had 30 N/mm.
    # The quick run takes a short chain, since this other integration is slow.
    rng, compared = np.random.default_rng(examples(5, full=4)), 0
    while compared < examples(1, full=60):
        cells = int(rng.integers(2, examples(4, full=5)))
        chain = replace(concave_chain(rng, cells), actuator_stiffness=stiffness)
        path, n = chain.cycle().path, len(chain)
        # One of a hundredth of a millimetre is lost in how far those stops give way.
        if not snaps_of(path) or snaps_of(path)[0].released < 1e-4:
            continue
        masses, damping = rng.uniform(0.01, 0.03, n), rng.uniform(0.2, 0.6, n)
        landing = path.inertial_landing(0, masses, damping, history=True)
        assert landing.history is not None
        event, start = landing.event, landing.history.travel[0].copy()
        assert balanced(landing)
        # Off its equilibrium by a thousandth of a travel, in the sense in which it goes.
        moved = np.array(landing.history.travel)
        off = int(np.argmax(np.max(np.abs(moved - start), axis=1) > 1e-3 * chain.cells[0].high))
        there, peak = independent(
            chain,
            landing,
            moved[off],
            event.force_before
            - (
                0.0
                if stiffness in (0.0, math.inf)
                else stiffness * float(np.sum(moved[off] - start))
            ),
        )
        if landing.tie:
            continue
        # A stop gives way by a force over its stiffness, some thousandths of a millimetre.
        assert there == pytest.approx(np.array(landing.travel), abs=1e-4), event
        assert peak == pytest.approx(landing.peak_speed, rel=0.05)
        compared += 1


@pytest.mark.slow
def test_with_next_to_no_mass_it_lands_where_the_flow_does():
    rng, tried = np.random.default_rng(11), 0
    while tried < examples(12, 400):
        n = int(rng.integers(2, 6))
        chain = any_chain(rng, n) if rng.random() < 0.6 else concave_chain(rng, n)
        chain = replace(
            chain,
            actuator_stiffness=rng.choice([math.inf, 0.0, rng.uniform(5, 500)]),
            cells=[replace(c, mobility=10 ** rng.uniform(-0.5, 0.5)) for c in chain.cells],
        )
        path = chain.cycle().path
        for number, event in enumerate(snaps_of(path)[:2]):
            landing = path.inertial_landing(number, [1e-6] * n, 1.0 / mobilities_of(chain.cells))
            assert event.tie or landing.agrees, (event, landing)
            assert balanced(landing)
            tried += 1


def test_momentum_carries_a_second_cell_over_where_dampers_would_not():
    inner = sw.Cell(sw.Band((-0.010, 0.0), (0.010, 0.0)))
    path = under_force(inner, inner.with_anchors(q=(0.020, 0.0)))
    heavy = path.inertial_landing(0, [0.01, 0.01], [0.02, 0.02])
    assert not heavy.agrees
    assert heavy.state == "11"
    slow = path.inertial_landing(0, [0.01, 0.01], [5.0, 5.0])
    assert slow.agrees
    assert slow.state == "10"


def test_a_sheet_that_ends_lets_the_element_jump_and_the_jump_has_its_share():
    folded = sw.Element.from_curve((0.0, 0.006, 0.003, 0.010), (0.0, 1.0, -0.6, 1.2), "folded")
    spring = sw.Element.from_points((0.0, 0.02), (0.0, 4.0), "spring")
    path = sw.Chain([folded, spring]).path([0.0, 0.014])
    (snap,) = snaps_of(path)
    landing = path.inertial_landing(snap, [0.01, 0.01], [0.5, 0.5])
    assert landing.sheet == (*snap.sheets_after[:1], 0)
    assert landing.agrees
    assert landing.jumped > 0.0
    assert landing.freed == pytest.approx(snap.released, rel=1e-4)
    assert balanced(landing)


def test_a_leader_at_the_end_of_its_sheet_jumps_whatever_friction_holds_the_others():
    curve = (0.0, 0.006, 0.003, 0.010), (0.0, 1.0, -0.6, 1.2)
    one, two = (sw.Element.from_curve(*curve, friction=rub) for rub in (0.0, 0.03))
    path = sw.Chain([one, replace(two, force_scale=1.2)]).cycle().path
    for number, event in enumerate(snaps_of(path)):
        landing = path.inertial_landing(number, [1e-6, 1e-6], [5.0, 5.0])
        assert landing.agrees, event
        assert landing.jumped > 0.0


@pytest.mark.slow
def test_a_rigid_actuator_holds_the_outermost_block_whatever_its_mass():
    path = sw.preset("paper-forward").cycle().path
    light, heavy = (path.inertial_landing(0, [0.01, m], [0.3, 0.3]) for m in (1e-3, 10.0))
    assert light.travel == heavy.travel
    assert light.peak_speed == heavy.peak_speed
    assert light.steps == heavy.steps


@pytest.mark.slow
def test_volumes_and_angles_move_as_travels_do():
    # A litre is a cubic metre here, a pascal a newton: the same numbers, the same motion.
    chain = [trilinear(), trilinear(peak=(0.003, 0.8))]
    as_volume = [
        sw.Element(e.sheets, e.stops, name=e.name, measure=sw.Measure.VOLUME) for e in chain
    ]
    here, there = (
        sw.Chain(cells, actuator_stiffness=0.0)
        .cycle()
        .path.inertial_landing(0, [0.01, 0.02], [0.3, 0.2])
        for cells in (chain, as_volume)
    )
    assert here.travel == there.travel
    assert here.time == there.time
    two = sw.Chain([balloon(), replace(balloon(), force_scale=1.05)])
    path = two.cycle().path
    inertance, drag = [1e7, 1e7], [1e8, 1e8]
    assert balanced(path.inertial_landing(0, inertance, drag))


def test_the_same_call_gives_the_same_value_and_a_history_from_start_to_rest():
    path = sw.preset("paper-forward").cycle().path
    (event, _) = snaps_of(path)
    one = path.inertial_landing(0, [0.01, 0.01], [0.1, 0.1], history=True)
    assert one == path.inertial_landing(event, [0.01, 0.01], [0.1, 0.1], history=True)
    assert one.history is not None
    assert one.history.travel[0].tolist() == list(event.before)
    assert np.allclose(one.history.travel[-1], one.travel, atol=1e-6)
    assert np.all(np.diff(one.history.time) > 0.0)
    assert np.allclose(np.sum(one.history.travel, axis=1), event.stroke, atol=1e-12)
    assert "lands in" in str(one)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"snap": 2}, "snap = 2: must be a snap of this path, which has 2"),
        ({"masses": [0.01]}, "masses has 1 values, the chain 2"),
        ({"masses": [0.01, 0.0]}, r"masses\[1\] = 0.0 kg: must be > 0"),
        ({"damping": [0.1, -1.0]}, r"damping\[1\] = -1.0 N s/m: must be >= 0"),
        ({"restitution": 1.0}, "restitution = 1: must be below 1"),
    ],
)
def test_what_makes_no_sense_is_refused_with_a_sentence(change, complaint):
    given = {"snap": 0, "masses": [0.01, 0.01], "damping": [0.1, 0.1], **change}
    path = sw.preset("paper-forward").cycle().path
    with pytest.raises(ValueError, match=complaint):
        path.inertial_landing(given.pop("snap"), **given)


def test_what_nothing_brings_to_rest_is_refused():
    with pytest.raises(ValueError, match="no dissipation"):
        under_force(trilinear()).inertial_landing(0, [0.01], [0.0])


def test_what_does_not_come_to_rest_says_so(monkeypatch):
    # The spring swings on behind stops that are never struck.
    monkeypatch.setattr("stepwell.statics.inertial._MOST_STEPS", 2000)
    stopped = replace(STOPPED, stops=(True, False))
    with refuses(StaticsError, "rest", "2000 steps"):
        under_force(stopped).inertial_landing(0, [0.01], [0.0])
